"""What reading rounded, in the moments: a bound for vertices moved by at most δ, or the change and a bound.

While the vertices of a closed surface move along d (linear over each triangle, |d| ≤ δ), the moments change by
d/dt ∫ f dV = ∮ f d·n dA: with |n| dA for each triangle and all that f reaches, by δ A at most, and by the areas that
grow with the edges on the way. With N twice the vector area, sums S over the corners and g = d·N there, on the way

    dV = Σ S_g/6,   d∫x = Σ (S_x S_g + Σ x g)/24,
    d∫x y = Σ (S_x S_y S_g + S_g Σ x y + S_x Σ y g + S_y Σ x g + 2 Σ x y g)/120.

These are polynomials in t of degree 4 at most, so that Gauss's rule with three points gives the whole change.
"""

from __future__ import annotations

from fractions import Fraction
from math import isfinite

import numpy as np

from inertia.arrays import Float
from inertia.mass.moments import PAIRS, ZERO, Moments, six, vector
from inertia.mass.triangles.sums import Sums
from inertia.mesh.part import Rounding
from inertia.mesh.surface import Surface, Triangles

_CHUNK = 1 << 16
_INFLATED = 1.0 + 1e-9  # more than the float64 sums of positive terms can lose
_GAUSS = ((0.5 - 0.15**0.5, 5 / 18), (0.5, 8 / 18), (0.5 + 0.15**0.5, 5 / 18))
_RELATIVE = 1e-13  # more than float64 loses of a sum of a chunk's terms, relative to their magnitudes


def as_written(moments: Moments, triangles: Triangles, sums: Sums, rounding: Rounding, *, exactly: bool) -> Moments:
    """Return the moments of the surface that the file writes: corrected, where that can be, or with a wider bound.

    Parameters
    ----------
    moments : of the triangles as they are, in the file's unit
    sums : of the same triangles
    exactly : whether to correct them by the remainders, where these are at hand
    """
    if exactly and rounding.remainder is not None and isinstance(triangles, Surface):
        return moments + _change(triangles, rounding.remainder(), sums, rounding.distance)
    longest = 4.0 * float(_reach(sums).max())  # no edge is longer than 2 √3 times the reach
    area = float(np.ldexp(sums.area, -2 * sums.exponent)) / 2 * _INFLATED
    area += _RELATIVE * sums.count * longest * longest  # of a needle, |n| is the difference of larger numbers
    return moments + _within(sums, rounding.distance, area, 3.0 * longest * sums.count, share=1.0)


def shell_as_written(moments: Moments, triangles: Triangles, sums: Sums, rounding: Rounding) -> Moments:
    """Return the moments of a surface that carries the mass, with a bound for the surface that the file writes."""
    area = edges = 0.0
    for start in range(0, triangles.count, _CHUNK):
        corners = triangles.corners(start, min(start + _CHUNK, triangles.count))
        lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        area += 0.5 * float(lengths[:, 0] @ lengths[:, 1])
        edges += float(lengths.sum())
    growth = rounding.distance * (0.5 * edges + 3.0 * rounding.distance * sums.count)
    return moments + _bounds(sums, rounding.distance, growth, rounding.distance * (area + growth))


def _reach(sums: Sums) -> Float:
    reach: Float = np.maximum(np.abs(sums.high - sums.origin), np.abs(sums.low - sums.origin)) * _INFLATED
    return reach


def _within(sums: Sums, distance: float, area: float, edges: float, share: float) -> Moments:
    """Return zero moments with the bounds for vertices moved by `distance`, times `share`.

    The area grows by at most ½ δ for each unit of edge, and by 3 δ² for each triangle.
    """
    growth = distance * (0.5 * edges + 3.0 * distance * sums.count)
    return _bounds(sums, distance, share * distance * (area + growth), 0.0)


def _bounds(sums: Sums, distance: float, zeroth: float, turn: float) -> Moments:
    """Return zero moments with a bound on the zeroth; on the others it is what that and the arms (`turn`) make."""
    zeroth, turn = zeroth * _INFLATED, turn * _INFLATED
    reach = _reach(sums) + distance
    return Moments(
        vector(Fraction(float(k)) for k in sums.origin),
        ZERO,
        (ZERO, ZERO, ZERO),
        (ZERO,) * 6,
        Fraction(zeroth),
        vector(Fraction(float(x * zeroth + turn)) for x in reach),
        six(_second(float(reach[i]), float(reach[j]), zeroth, turn) for i, j in PAIRS),
    )


def _second(a: float, b: float, zeroth: float, turn: float) -> Fraction:
    bound = a * b * zeroth + (a + b) * turn
    if isfinite(bound):
        return Fraction(bound)
    return Fraction(a) * Fraction(b) * Fraction(zeroth) + (Fraction(a) + Fraction(b)) * Fraction(turn)


def _change(surface: Surface, remainder: Float, sums: Sums, distance: float) -> Moments:
    totals = np.zeros(10)
    area = edges = 0.0
    for start in range(0, surface.count, _CHUNK):
        faces = surface.faces[start : start + _CHUNK]
        corners = surface.vertices[faces]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        lengths = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1), np.linalg.norm(v - u, axis=1)
        area += 0.5 * float(lengths[0] @ lengths[1])  # at least that, and the measure of what its own rounding does
        edges += float(sum(map(np.sum, lengths)))
        d, local = remainder[faces], corners - sums.origin
        du, dv = d[:, 1] - d[:, 0], d[:, 2] - d[:, 0]
        for t, weight in _GAUSS:
            g = np.einsum("kij,kj->ki", d, np.cross(u + t * du, v + t * dv))
            with np.errstate(over="ignore", invalid="ignore"):
                totals += weight * _rates(local + t * d, g)
    share = _RELATIVE
    if not np.isfinite(totals).all():  # coordinates so large that the second moments leave float64
        totals, share = np.zeros(10), 1.0
    bound = _within(sums, distance, area * _INFLATED, edges * _INFLATED, share)
    volume, *others = map(Fraction, totals.tolist())
    return Moments(
        bound.origin,
        volume,
        vector(others[:3]),
        six(others[3:]),
        bound.zeroth_bound,
        bound.first_bound,
        bound.second_bound,
    )


def _rates(corners: Float, g: Float) -> Float:
    """Return the ten sums over triangles with these corners (k, 3, 3) and values g (k, 3) there."""
    sg, s = g.sum(axis=1), corners.sum(axis=1)
    xg = np.einsum("kai,ka->ki", corners, g)
    first = (s * sg[:, None] + xg).sum(axis=0) / 24.0
    second = []
    for i, j in PAIRS:
        x, y = corners[:, :, i], corners[:, :, j]
        product = x * y
        terms = s[:, i] * s[:, j] * sg + sg * product.sum(axis=1) + s[:, i] * xg[:, j] + s[:, j] * xg[:, i]
        second.append((terms + 2.0 * (product * g).sum(axis=1)).sum() / 120.0)
    return np.array([sg.sum() / 6.0, *first, *second])
