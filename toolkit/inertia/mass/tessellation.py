"""Tessellation error of a curved surface: a bound from a chord tolerance, or an estimate by Richardson extrapolation.

This error is apart from the arithmetic one, and for curved parts usually larger by many orders of magnitude.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from inertia.arrays import Float
from inertia.errors import GeometryError, UsageError, require_kind
from inertia.estimate import is_number
from inertia.mass.moments import PAIRS, ZERO, Moments, Vector, vector
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.mesh.part import Part
from inertia.mesh.surface import Triangles

_CHUNK = 1 << 16
_ROUNDED_UP = Fraction(1) + Fraction(1, 10**9)  # more than float64 sums of positive terms can lose


def chord_bound(triangles: Triangles, chord: float | Float, origin: Vector) -> Moments:
    """Bound the moments of all that lies between a mesh and the surface that it stands for.

    Assumed is what CAD systems mean by a chord (sag) tolerance h: no point of the true surface is farther than h from
    the mesh, and it projects on it one to one. Between them then lie at most, for each triangle of area A and perimeter
    P: a prism h A, half cylinders along the edges, shared with the neighbours, π/4 h² P, and spheres at the corners,
    4/3 π h³. All of it is within h of the triangle, which bounds the coordinates under the integrals.

    Parameters
    ----------
    triangles : the mesh
    chord : h, or (m,) for each triangle its own, in the file's unit
    origin : the point about which the moments are bounded, in the file's unit

    Returns moments that are zero, with these bounds, in the file's unit; raises `GeometryError` where they leave
    float64.
    """
    if isinstance(chord, float) and not 0 < chord < math.inf:
        raise UsageError(f"the chord tolerance is {chord!r}: it must be positive and finite")
    sums = np.zeros(10)
    center = np.array([float(k) for k in origin])
    for start in range(0, triangles.count, _CHUNK):
        stop = min(start + _CHUNK, triangles.count)
        corners = triangles.corners(start, stop) - center
        with np.errstate(over="ignore"):
            sums += _between(corners, np.broadcast_to(chord, triangles.count)[start:stop])
    if not np.isfinite(sums).all():
        raise GeometryError("what a chord tolerance of that size leaves out is beyond 1.8e308: give a smaller one")
    volume, x, y, z, *second = (Fraction(k) * _ROUNDED_UP for k in sums.tolist())
    xx, yy, zz, yz, zx, xy = second
    return Moments(origin, ZERO, (ZERO,) * 3, (ZERO,) * 6, volume, (x, y, z), (xx, yy, zz, yz, zx, xy))


def _between(corners: Float, chord: Float) -> Float:
    edges = np.roll(corners, -1, axis=1) - corners
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    perimeter = np.linalg.norm(edges, axis=2).sum(axis=1)
    volume = chord * area + 0.25 * math.pi * chord**2 * perimeter + 4.0 / 3.0 * math.pi * chord**3
    reach = np.abs(corners).max(axis=1) + chord[:, None]
    first = [(volume * reach[:, axis]).sum() for axis in range(3)]
    second = [(volume * reach[:, i] * reach[:, j]).sum() for i, j in PAIRS]
    return np.array([volume.sum(), *first, *second])


def chord_error(
    part: Part,
    chord: float | Float,
    moments: Moments,
    volume: Fraction,
    density: Fraction,
    mass: Fraction | None = None,
) -> ErrorBound:
    """Return the relative bounds that a chord tolerance gives.

    Parameters
    ----------
    part : a surface
    chord : the tolerance, or (m,) that of each triangle, in the part's unit
    moments : of mass, kg and m
    volume : m³
    density : kg/m³, the largest of any body
    mass : kg, where it was weighed: then it has no error of this kind
    """
    f = part.unit.metres
    if moments.zeroth:
        moments = moments.about(moments.centroid)  # where the bounds on centre and tensor are near their least
    origin = vector(k / f for k in moments.origin)
    tolerance = f"{chord:g} {part.unit.name}" if isinstance(chord, float) else f"{chord.max():.3g} {part.unit.name}"
    source = "" if isinstance(chord, float) else " that reading chose"
    method = f"bounds from the chord tolerance {tolerance}{source}"
    try:
        between = chord_bound(part.triangles, chord, origin).in_unit(f).scaled(f**3 * density)
        return error_within(moments, volume, between, density, mass, method)
    except GeometryError:
        raise GeometryError(
            f"{part.name}: a chord tolerance of {tolerance} leaves nothing certain of the volume, as that "
            "much may lie between the mesh and the true surface: give the tolerance that the mesh was made with"
        ) from None


def error_within(
    moments: Moments, volume: Fraction, between: Moments, density: Fraction, mass: Fraction | None, method: str
) -> ErrorBound:
    """Return the relative bounds where the moments may be off by the bounds of `between`, about the same origin.

    Raises `GeometryError` where that leaves nothing certain of the volume; see `chord_error` for the rest.
    """
    bounded = replace(
        moments,
        zeroth_bound=between.zeroth_bound,
        first_bound=between.first_bound,
        second_bound=between.second_bound,
        norms=between.norms,
    )
    if mass is not None and bounded.zeroth > bounded.zeroth_bound:
        bounded = bounded.weighed(mass)
    return MassProperties.from_moments(bounded, volume, between.zeroth_bound / density, method).error


def richardson(coarse: MassProperties, fine: MassProperties, ratio: float = 2.0, order: float = 2.0) -> ErrorBound:
    """Estimate the tessellation error of the finer of two meshes of one part (Richardson extrapolation).

    For a mesh width h the results are off by C h^order: so the finer one is off by |fine − coarse| / (ratio^order − 1).
    An estimate, not a bound: it holds where both meshes are fine enough for that law.

    Parameters
    ----------
    coarse, fine : the part with mesh width ratio·h and h
    ratio : of the mesh widths, above 1
    order : of convergence; 2 for flat triangles with corners on the surface

    >>> from inertia.mass.properties import MassProperties
    >>> coarse = MassProperties(0.96, 0.96, [0, 0, 0], 0.96 * np.eye(3))
    >>> fine = MassProperties(0.99, 0.99, [0, 0, 0], 0.99 * np.eye(3))
    >>> round(richardson(coarse, fine).volume * 0.99, 6)
    0.01
    """
    for name, properties in (("coarse", coarse), ("fine", fine)):
        require_kind(properties, MassProperties, name, "inertia.mass_properties(part)")
    if not (is_number(ratio) and is_number(order) and 1 < ratio < math.inf and 0 < order < math.inf):
        raise UsageError(f"ratio is {ratio!r} and order {order!r}: the ratio must be above 1, the order above 0")
    divisor = ratio**order - 1.0
    return ErrorBound(
        f"Richardson estimate from mesh widths in the ratio {ratio:g}",
        abs(fine.volume - coarse.volume) / fine.volume / divisor if fine.volume else 0.0,
        abs(fine.mass - coarse.mass) / fine.mass / divisor,
        float(np.linalg.norm(fine.center_of_mass - coarse.center_of_mass)) / divisor,
        float(np.linalg.norm(fine.inertia - coarse.inertia) / np.linalg.norm(fine.inertia)) / divisor,
    )
