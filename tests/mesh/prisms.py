"""Unions of upright prisms in rational arithmetic, by a sweep: an oracle that shares nothing with the library."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

import numpy as np

from inertia.mesh.part import Part

Point = tuple[Fraction, Fraction]
Prism = tuple[Sequence[tuple[float, float]], float, float]
"""An outline, counter-clockwise (or one that crosses itself), and the heights of bottom and top."""


def mesh(prisms: Sequence[Prism]) -> Part:
    """Return prisms as triangles, each capped by a fan from its first corner."""
    triangles = []
    for outline, low, high in prisms:
        bottom, top = ([(*map(float, p), float(z)) for p in outline] for z in (low, high))
        for k in range(len(outline)):
            j = (k + 1) % len(outline)
            triangles += [[bottom[k], bottom[j], top[j]], [bottom[k], top[j], top[k]]]
        for k in range(1, len(outline) - 1):
            triangles += [[bottom[0], bottom[k + 1], bottom[k]], [top[0], top[k], top[k + 1]]]
    corners = np.array(triangles)
    return Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def moments(prisms: Sequence[Prism]) -> dict[str, Fraction]:
    """Return ∫ f dV over all places of winding number 1 or more, for f = 1, x, y, z, xx, yy, zz, yz, zx, xy."""
    heights = sorted({Fraction(z) for _, low, high in prisms for z in (low, high)})
    total = dict.fromkeys(("1", "x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"), Fraction(0))
    for low, high in pairwise(heights):
        flat = _flat([outline for outline, bottom, top in prisms if bottom <= low and high <= top])
        d1, d2, d3 = high - low, (high**2 - low**2) / 2, (high**3 - low**3) / 3
        for name, factor in (("1", d1), ("x", d1), ("y", d1), ("xx", d1), ("yy", d1), ("xy", d1)):
            total[name] += factor * flat[name]
        total["z"] += d2 * flat["1"]
        total["zz"] += d3 * flat["1"]
        total["zx"] += d2 * flat["x"]
        total["yz"] += d2 * flat["y"]
    return total


def _flat(outlines: Sequence[Sequence[tuple[float, float]]]) -> dict[str, Fraction]:
    edges = []
    for outline in outlines:
        points = [(Fraction(x), Fraction(y)) for x, y in outline]
        edges += [(p, q) for p, q in zip(points, points[1:] + points[:1], strict=True) if p[0] != q[0]]
    stops = {p[0] for edge in edges for p in edge}
    for k, one in enumerate(edges):
        stops |= {x for other in edges[:k] if (x := _meeting(one, other)) is not None}
    result = dict.fromkeys(("1", "x", "y", "xx", "yy", "xy"), Fraction(0))
    for a, b in pairwise(sorted(stops)):
        middle = (a + b) / 2
        across = [edge for edge in edges if min(edge[0][0], edge[1][0]) <= a and b <= max(edge[0][0], edge[1][0])]
        across.sort(key=lambda edge: _at(edge, middle))
        winding, bottom = 0, None
        for edge in across:
            before = winding
            winding += 1 if edge[0][0] < edge[1][0] else -1
            if before < 1 <= winding:
                bottom = edge
            elif winding < 1 <= before:
                for name, part in _trapezium(bottom, edge, a, b).items():
                    result[name] += part
    return result


def _at(edge: tuple[Point, Point], x: Fraction) -> Fraction:
    (a, b), (c, d) = edge
    return b + (d - b) * (x - a) / (c - a)


def _meeting(one: tuple[Point, Point], other: tuple[Point, Point]) -> Fraction | None:
    slope, rise = ((edge[1][1] - edge[0][1]) / (edge[1][0] - edge[0][0]) for edge in (one, other))
    return None if slope == rise else (_at(other, Fraction(0)) - _at(one, Fraction(0))) / (slope - rise)


def _trapezium(low: tuple[Point, Point], high: tuple[Point, Point], a: Fraction, b: Fraction) -> dict[str, Fraction]:
    result = dict.fromkeys(("1", "x", "y", "xx", "yy", "xy"), Fraction(0))
    for x, weight in ((a, 1), ((a + b) / 2, 4), (b, 1)):  # Simpson's rule, exact for cubics
        bottom, top = _at(low, x), _at(high, x)
        w = (b - a) * weight / 6
        d1, d2, d3 = top - bottom, (top**2 - bottom**2) / 2, (top**3 - bottom**3) / 3
        parts = {"1": d1, "x": x * d1, "y": d2, "xx": x * x * d1, "yy": d3, "xy": x * d2}
        for name, part in parts.items():
            result[name] += w * part
    return result
