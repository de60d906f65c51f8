"""Triangles in integers: their planes, the lines in which planes meet, and points on these, without any rounding.

Float64 coordinates are integers times a power of two. A point of a triangle is kept as the two coordinates in which the
triangle is seen along its steepest axis k, (x_u, x_v) with u, v = k + 1, k + 2 modulo 3, homogeneous: (X, Y, W) with
W > 0 is the point (X/W, Y/W). Whatever is computed has a bounded number of digits, as all points are where two lines
meet that the input gives.
"""

from __future__ import annotations

from functools import cache
from math import gcd
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float, Int

Vector = tuple[int, int, int]
Point = tuple[int, int, int]
"""Homogeneous, in the plane of a triangle: (X, Y, W), W > 0."""
Line = tuple[int, int, int]
"""(α, β, γ) for α x + β y = γ in the plane of a triangle."""
Place = tuple[int, int, int, int]
"""Homogeneous, in space, in lowest terms: (X, Y, Z, W), W > 0."""


class Plane(NamedTuple):
    """n·x = d, n without a common divisor, and the axis along which |n| is largest."""

    normal: Vector
    offset: int
    axis: int


class Triangles:
    """Triangles (m, 3) over different vertices (n, 3) in lexicographic order, and what follows from them in integers.

    Attributes
    ----------
    exponent : coordinates are the integers times 2**exponent, from `origin` on
    origin : (3,), integers
    """

    def __init__(self, vertices: Float, faces: Int) -> None:
        self.vertices, self.faces = vertices, faces
        mantissa, exponent = np.frexp(vertices)
        whole = np.ldexp(mantissa, 53).astype(np.int64)
        trailing = np.frexp((whole & -whole).astype(np.float64))[1] - 1
        lowest = np.where(whole != 0, exponent - 53 + trailing, np.iinfo(np.int64).max)
        self.exponent = int(lowest.min()) if (whole != 0).any() else 0
        self.origin: Vector = (0, 0, 0)
        x, y, z = map(self.integer, vertices.min(axis=0).tolist())
        self.origin = (x, y, z)
        self.point = cache(self._point)
        self.corners = cache(self._corners)
        self.plane = cache(self._plane)

    def integer(self, value: float) -> int:
        """Return a coordinate, a multiple of 2**exponent, as its integer."""
        numerator, denominator = value.as_integer_ratio()
        if self.exponent > 0:
            return numerator >> self.exponent
        return (numerator << -self.exponent) // denominator

    def _point(self, vertex: int) -> Vector:
        x, y, z = (
            self.integer(value) - o for value, o in zip(self.vertices[vertex].tolist(), self.origin, strict=True)
        )
        return x, y, z

    def _corners(self, triangle: int) -> tuple[Vector, Vector, Vector]:
        a, b, c = map(self.point, self.faces[triangle].tolist())
        return a, b, c

    def _plane(self, triangle: int) -> Plane:
        a, b, c = self.corners(triangle)
        normal = cross(minus(b, a), minus(c, a))
        divisor = gcd(*normal) or 1
        x, y, z = (k // divisor for k in normal)
        axis = max(range(3), key=lambda k: abs((x, y, z)[k]))
        return Plane((x, y, z), x * a[0] + y * a[1] + z * a[2], axis)

    def seen(self, triangle: int) -> tuple[Point, Point, Point]:
        """Return the corners of a triangle in its plane."""
        axis = self.plane(triangle).axis
        a, b, c = ((p[axis - 2], p[axis - 1], 1) for p in self.corners(triangle))
        return a, b, c

    def heights(self, triangle: int, plane: Plane) -> tuple[int, int, int]:
        """Return n·x − d of the corners of a triangle."""
        (x, y, z), d, _ = plane
        a, b, c = (x * p[0] + y * p[1] + z * p[2] - d for p in self.corners(triangle))
        return a, b, c

    def cut(self, triangle: int, by: Plane) -> Line:
        """Return the line in which another plane cuts the plane of a triangle; α x + β y − γ rises with n·x − d."""
        normal, d, k = self.plane(triangle)
        u, v = k - 2, k - 1
        n, away = normal[k], by.normal[k]
        if n < 0:
            n, away = -n, -away
        divided = (
            by.normal[u] * n - away * normal[u],
            by.normal[v] * n - away * normal[v],
            by.offset * n - away * d,
        )
        divisor = gcd(*divided) or 1
        return divided[0] // divisor, divided[1] // divisor, divided[2] // divisor

    def place(self, triangle: int, point: Point) -> Place:
        """Return where in space a point of a triangle's plane is."""
        (normal, d, k), (x, y, w) = self.plane(triangle), point
        u, v = (k + 1) % 3, (k + 2) % 3
        n = normal[k]
        values = [0, 0, 0]
        values[u], values[v], values[k] = x * n, y * n, d * w - normal[u] * x - normal[v] * y
        w *= n
        divisor = gcd(w, *values)
        if w < 0:
            divisor = -divisor
        return values[0] // divisor, values[1] // divisor, values[2] // divisor, w // divisor

    def vertex(self, place: Place) -> int | None:
        """Return the number of the vertex at a place, if there is one."""
        coordinates, rests = self.rounded(place)
        if place[3] != 1 or any(rests):
            return None
        start, stop = 0, len(self.vertices)
        for axis, value in enumerate(coordinates):
            column = self.vertices[start:stop, axis]
            start, stop = (start + int(np.searchsorted(column, value, end)) for end in ("left", "right"))
        return start if start < stop else None

    def rounded(self, place: Place) -> tuple[list[float], list[float]]:
        """Return the nearest float64 coordinates of a place, and what the rounding took from them."""
        *numerators, w = place
        values, rests = [], []
        for x, o in zip(numerators, self.origin, strict=True):
            value = scaled(x + o * w, w, self.exponent)
            numerator, denominator = value.as_integer_ratio()
            rest, below = (x + o * w) * denominator, w * denominator
            if self.exponent > 0:
                rest <<= self.exponent
                rest -= numerator * w
            else:
                rest -= (numerator * w) << -self.exponent
                below <<= -self.exponent
            values.append(value)
            rests.append(rest / below)
        return values, rests


def scaled(numerator: int, denominator: int, exponent: int) -> float:
    """Return the float64 nearest to a quotient times a power of two."""
    if exponent >= 0:
        return (numerator << exponent) / denominator
    return numerator / (denominator << -exponent)


def minus(a: Vector, b: Vector) -> Vector:
    """Return a − b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def side(line: Line, point: Point) -> int:
    """Return a number with the sign of α x + β y − γ."""
    return line[0] * point[0] + line[1] * point[1] - line[2] * point[2]


def through(a: Point, b: Point) -> Line:
    """Return the line through two points; what is to the left of a→b is on its positive side."""
    x, y, w = cross(a, b)
    divisor = gcd(x, y, w) or 1
    return x // divisor, y // divisor, -w // divisor


def meet(one: Line, other: Line) -> Point:
    """Return the point in which two lines meet that are not parallel."""
    (a, b, c), (d, e, f) = one, other
    x, y, w = c * e - f * b, a * f - d * c, a * e - d * b
    return (x, y, w) if w > 0 else (-x, -y, -w)
