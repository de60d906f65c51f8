"""Triangulated surfaces for the samples, as corners (n, 3, 3), counter-clockwise seen from outside.

Round shapes take a resolution n, the number of segments in a full circle; their error falls as 1/n².
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inertia_meshes.circle import cosine, sine

Corners = NDArray[np.float64]
Loop = NDArray[np.float64]
"""Points (n, 3) along a line; of a closed line the first point is not repeated."""

_TIE = 1e-9


def circle(radius: float, z: float, n: int) -> Loop:
    """Points of a circle about the z axis, counter-clockwise seen from +z."""
    turns = [Fraction(k, n) for k in range(n)]
    return np.array([(radius * float(cosine(turn)), radius * float(sine(turn)), z) for turn in turns])


def flipped(corners: Corners) -> Corners:
    """The same triangles seen from the other side."""
    return corners[:, ::-1]


def moved(points: NDArray[np.float64], x: float, y: float, z: float) -> NDArray[np.float64]:
    """Points (..., 3) translated by (x, y, z)."""
    return points + np.array((x, y, z), np.float64)


def mapped(points: NDArray[np.float64], matrix: Sequence[Sequence[float]]) -> NDArray[np.float64]:
    """Points (..., 3) under x → matrix·x, element by element, so that equal points stay equal."""
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in matrix], axis=-1)


def band(lower: Loop, upper: Loop) -> Corners:
    """Wall between two closed lines of equally many points; it faces outwards where they turn about +z."""
    a, b = lower, np.roll(lower, -1, axis=0)
    c, d = np.roll(upper, -1, axis=0), upper
    triangles = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1).reshape(-1, 3, 3)
    following = np.roll(triangles, -1, axis=1)
    proper: NDArray[np.bool_] = (triangles != following).any(axis=2).all(axis=1)
    return triangles[proper]


def revolved(profile: Sequence[tuple[float, float]], n: int) -> Corners:
    """Surface swept by turning an open line of (radius, z), with the inside on its left, about the z axis."""
    loops = [circle(radius, z, n) for radius, z in profile]
    return np.concatenate([band(lower, upper) for lower, upper in pairwise(loops)])


def box(a: float, b: float, c: float) -> Corners:
    """Box with edges a, b, c along x, y, z, centred at the origin."""
    x, y, z = a / 2, b / 2, c / 2
    square = np.array([(x, y, 0), (-x, y, 0), (-x, -y, 0), (x, -y, 0)], np.float64)
    lower, upper = moved(square, 0, 0, -z), moved(square, 0, 0, z)
    floor, ceiling = lower[[[0, 2, 1], [0, 3, 2]]], upper[[[0, 1, 2], [0, 2, 3]]]
    return np.concatenate([floor, band(lower, upper), ceiling])


def corner_tetrahedron(a: float, b: float, c: float) -> Corners:
    """Tetrahedron with the corners (0,0,0), (a,0,0), (0,b,0), (0,0,c)."""
    points = np.array([(0, 0, 0), (a, 0, 0), (0, b, 0), (0, 0, c)])
    return points[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]


def sphere(radius: float, n: int) -> Corners:
    """Sphere of n meridians and n/2 − 1 parallels."""
    turns = [Fraction(k, n) for k in range(n // 2 + 1)]
    return revolved([(radius * float(sine(turn)), -radius * float(cosine(turn))) for turn in turns], n)


def torus(ring: float, tube: float, n: int) -> Corners:
    """Torus about z with n segments around the ring and n/2 around the tube."""
    turns = [Fraction(2 * k, n) for k in range(n // 2)]
    profile = [(ring + tube * float(cosine(turn)), tube * float(sine(turn))) for turn in turns]
    return revolved([*profile, profile[0]], n)


def bridge(outer: Loop, inner: Loop, a: Sequence[float], b: Sequence[float]) -> Corners:
    """Strip of triangles between two lines whose points stand at the growing parameters a and b.

    The line whose next segment has its middle earlier goes on first.
    """
    triangles = []
    i = j = 0
    while i + 1 < len(a) or j + 1 < len(b):
        if j + 1 == len(b) or (i + 1 < len(a) and a[i] + a[i + 1] <= b[j] + b[j + 1] + _TIE):
            triangles.append((outer[i], outer[i + 1], inner[j]))
            i += 1
        else:
            triangles.append((inner[j], outer[i], inner[j + 1]))
            j += 1
    return np.array(triangles)


def ring(outer: Loop, inner: Loop) -> Corners:
    """Flat face, towards +z, between two closed lines that are star-shaped about the middle of `inner`."""
    middle = inner.mean(axis=0)

    def opened(loop: Loop) -> tuple[Loop, list[float]]:
        angles = np.arctan2(loop[:, 1] - middle[1], loop[:, 0] - middle[0])
        angles[angles > np.pi - _TIE] -= 2 * np.pi  # a point on the cut comes first, however it is rounded
        first = int(np.argmin(angles))
        order = np.arange(first, first + len(loop) + 1) % len(loop)
        return loop[order], [*angles[order[:-1]].tolist(), float(angles[first]) + 2 * np.pi]

    (far, a), (near, b) = opened(outer), opened(inner)
    return bridge(far, near, a, b)


def pierced_ring(outer: Loop, inner: Loop, windows: Sequence[tuple[int, int, Loop]]) -> Corners:
    """Flat face between two concentric circles with further holes; it faces +z.

    Parameters
    ----------
    outer, inner : equally spaced points of the circles; `outer` has a whole multiple of the points of `inner`
    windows : for each hole, counter-clockwise, the points of `inner` between which it lies, and its line
    """
    step = len(outer) // len(inner)

    def arcs(start: int, stop: int) -> tuple[Loop, Loop]:
        far = outer.take(range(step * start, step * stop + 1), axis=0, mode="wrap")
        return far, inner.take(range(start, stop + 1), axis=0, mode="wrap")

    pieces = []
    for (start, stop, hole), after in zip(windows, (*windows[1:], windows[0]), strict=True):
        far, near = arcs(start, stop)
        pieces.append(ring(np.concatenate([far, near[::-1]]), hole))
        gap = (after[0] - stop) % len(inner)
        if gap:
            far, near = arcs(stop, stop + gap)
            pieces.append(bridge(far, near, [k / step for k in range(len(far))], list(range(len(near)))))
    return np.concatenate(pieces)
