"""A closed surface of triangles from convex polygons and whole triangles that fit together along their edges, exactly.

Neighbours may have different points on a common line. So edges that no neighbour has alike are divided at the ends of
all such edges on their line; after that every edge has its partner.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import cmp_to_key
from math import gcd

import numpy as np

from inertia.arrays import Bool, Int
from inertia.mesh.arrangement.integers import Place, Triangles, Vector, cross, minus
from inertia.records import dataclass

_Name = tuple[int, int]


@dataclass(frozen=True)
class Polygon:
    """A convex polygon over numbered vertices, counter-clockwise seen from outside; `names` are of its edges' lines."""

    vertices: list[int]
    names: list[_Name]
    origin: int


class Vertices:
    """Places by number: those of the triangles, and more."""

    def __init__(self, triangles: Triangles) -> None:
        self.triangles = triangles
        self.first = len(triangles.vertices)
        self.places: list[Place] = []
        self._numbers: dict[Place, int] = {}

    def number(self, place: Place) -> int:
        """Return the number of a place."""
        number = self._numbers.get(place)
        if number is None:
            number = self.triangles.vertex(place)
            if number is None:
                number = self.first + len(self.places)
                self.places.append(place)
            self._numbers[place] = number
        return number

    def place(self, number: int) -> Place:
        """Return where a vertex is."""
        return (*self.triangles.point(number), 1) if number < self.first else self.places[number - self.first]


def closed_surface(vertices: Vertices, faces: Int, origins: Int, polygons: list[Polygon]) -> tuple[Int, Int]:
    """Return triangles (m, 3) that are a closed surface, and which triangle each comes from.

    Parameters
    ----------
    faces, origins : (k, 3) and (k,), whole triangles
    polygons : the rest
    """
    unpaired = _unpaired(faces, polygons)
    divided = _divided(vertices, unpaired)
    touched = np.array([], np.int64)
    if len(faces) and unpaired:
        tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        low, high = np.minimum(tail, head), np.maximum(tail, head)
        keys = np.array([low * (1 << 32) + high for low, high in divided], np.int64)
        touched = np.unique(np.flatnonzero(np.isin(low * (1 << 32) + high, keys)) // 3)
    whole = np.ones(len(faces), bool)
    whole[touched] = False
    loops = [(face, int(origin)) for face, origin in zip(faces[touched].tolist(), origins[touched], strict=True)]
    loops += [(polygon.vertices, polygon.origin) for polygon in polygons]
    triangles: list[tuple[int, int, int]] = []
    sources: list[int] = []
    for loop, origin in loops:
        pieces = _triangulated(*_with_points(loop, divided))
        triangles += pieces
        sources += [origin] * len(pieces)
    result = np.concatenate([faces[whole], np.array(triangles, np.int64).reshape(-1, 3)])
    return result, np.concatenate([origins[whole], np.array(sources, np.int64)])


def _unpaired(faces: Int, polygons: list[Polygon]) -> dict[_Name, _Name]:
    """Return the edges (lower vertex first) that are used more often one way than the other, and their lines' names."""
    loops = [(polygon.vertices, polygon.names) for polygon in polygons]
    tails = np.array([vertex for loop, _ in loops for vertex in loop], np.int64)
    heads = np.array([vertex for loop, _ in loops for vertex in loop[1:] + loop[:1]], np.int64)
    names = [name for _, each in loops for name in each]
    tail = np.concatenate([tails, faces.ravel()])
    head = np.concatenate([heads, np.roll(faces, -1, axis=1).ravel()])
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    _, first, edge = np.unique(low * (1 << 32) + high, return_index=True, return_inverse=True)
    surplus = np.bincount(edge, np.where(tail < head, 1.0, -1.0))
    result = {}
    for k in first[surplus != 0].tolist():
        pair = int(low[k]), int(high[k])
        result[pair] = names[k] if k < len(names) else (-1 - pair[0], -1 - pair[1])
    return result


def _divided(vertices: Vertices, unpaired: dict[_Name, _Name]) -> dict[_Name, list[int]]:
    """Return the vertices to be put on edges, from their lower end to the higher."""
    lines: dict[tuple[int, ...], list[_Name]] = defaultdict(list)
    known: dict[_Name, tuple[int, ...]] = {}
    for edge, name in unpaired.items():
        if name not in known:
            known[name] = _line(vertices.triangles, name)
        lines[known[name]].append(edge)
    divided: dict[_Name, list[int]] = {}
    for line, edges in lines.items():
        axis = max(range(3), key=lambda k: abs(line[k]))
        ends = sorted({end for edge in edges for end in edge})
        places = {end: (vertices.place(end)[axis], vertices.place(end)[3]) for end in ends}

        def compared(a: int, b: int, places: dict[int, tuple[int, int]] = places) -> int:
            (x, w), (y, v) = places[a], places[b]
            return (x * v > y * w) - (x * v < y * w)

        ends.sort(key=cmp_to_key(compared))
        rank = {end: k for k, end in enumerate(ends)}
        for low, high in edges:
            start, stop = rank[low], rank[high]
            between = ends[start + 1 : stop] if start < stop else ends[stop + 1 : start][::-1]
            if between:
                divided[low, high] = between
    return divided


def _line(triangles: Triangles, name: _Name) -> tuple[int, ...]:
    """Return Plücker's coordinates of a line, in lowest terms: the same for the same line."""
    one, other = name
    direction: Vector
    if one < 0:
        a, b = triangles.point(-1 - one), triangles.point(-1 - other)
        direction, moment = minus(b, a), cross(a, b)
    else:
        (n, d, _), (m, e, _) = triangles.plane(one), triangles.plane(other)
        direction = cross(n, m)
        x, y, z = (e * i - d * j for i, j in zip(n, m, strict=True))
        moment = x, y, z
    divisor = gcd(*direction, *moment)
    if next(k for k in direction if k) < 0:
        divisor = -divisor
    return tuple(k // divisor for k in (*direction, *moment))


def _with_points(loop: Sequence[int], divided: dict[_Name, list[int]]) -> tuple[list[int], list[bool]]:
    """Put points on the edges of a polygon; say which of its vertices are corners."""
    vertices: list[int] = []
    corner: list[bool] = []
    for tail, head in zip(loop, [*loop[1:], loop[0]], strict=True):
        more = divided.get((tail, head)) or divided.get((head, tail), [])[::-1]
        vertices += [tail, *more]
        corner += [True] + [False] * len(more)
    return vertices, corner


def _triangulated(loop: list[int], corner: list[bool]) -> list[tuple[int, int, int]]:
    """Cut corners off a convex polygon until a triangle is left; none of the triangles is flat."""
    triangles = []
    at = 0
    while len(loop) > 3:
        count = len(loop)
        strict = sum(corner)
        while True:
            at %= count
            before, after = at - 1, (at + 1) % count
            # Of three corners, one may only go if what is left is not all on the line of the other two.
            if corner[at] and (strict > 3 or not (corner[before] and corner[after])):
                break
            at += 1
        triangles.append((loop[before], loop[at], loop[after]))
        corner[before] = corner[after] = True
        del loop[at], corner[at]
        at += 1
    triangles.append((loop[0], loop[1], loop[2]))
    return triangles


def is_closed(faces: Int) -> Bool | bool:
    """Say whether every edge is used both ways equally often."""
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    _, edge = np.unique(low * (1 << 32) + high, return_inverse=True)
    return not np.bincount(edge, np.where(tail < head, 1.0, -1.0)).any()
