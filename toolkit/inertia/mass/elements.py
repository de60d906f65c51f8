"""Bodies without a mesh: point masses, wires and flat laminae, by the second-moment algebra of simplices."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float, reals
from inertia.errors import GeometryError, UsageError
from inertia.mass.density import positive
from inertia.mass.moments import ZERO, Moments, root_above, simplex_moments
from inertia.mass.outline import require_simple
from inertia.mass.properties import TOO_LARGE, TOO_SMALL, MassProperties

_FLAT = 1e-9
"""A polygon counts as flat when its corners lie within this part of its size from its plane."""

_OF_ROOT = Fraction(1, 2**60)
"""How far `root_above` may be from the root, as a part of it."""


def point_masses(positions: ArrayLike, masses: ArrayLike) -> MassProperties:
    """Return the mass properties of point masses: I = Σ m (r² δ − r rᵀ) (textbook eq. 13.12).

    Parameters
    ----------
    positions : (n, 3) m
    masses : (n,) kg, all positive

    >>> point_masses([[1, 0, 0], [-1, 0, 0]], [0.5, 0.5]).inertia.diagonal().tolist()
    [0.0, 1.0, 1.0]
    """
    points = _points(positions, 1)
    weights = _numbers(masses, "masses")
    if weights.shape != (len(points),):
        raise UsageError(f"masses must have shape ({len(points)},), one for each position, not {weights.shape}")
    if not (np.isfinite(weights) & (weights > 0)).all():
        worst = int(np.flatnonzero(~(np.isfinite(weights) & (weights > 0)))[0])
        raise GeometryError(f"masses[{worst}] is {weights[worst]}: a mass must be positive and finite")
    return _properties(simplex_moments(points[:, None, :], weights), "points")


def wire(points: ArrayLike, linear_density: float) -> MassProperties:
    """Return the mass properties of a thin wire along a polyline.

    The second moments of a segment of mass m between a and b are m/6 (s sᵀ + a aᵀ + b bᵀ), s = a + b.

    Parameters
    ----------
    points : (n, 3) m, n ≥ 2, the polyline's corners in order; repeat the first to close it
    linear_density : kg/m

    >>> rod = wire([[0, 0, 0], [2, 0, 0]], 1.5)
    >>> rod.mass, float(rod.inertia[2, 2])
    (3.0, 1.0)
    """
    corners = _points(points, 2)
    segments = np.stack([corners[:-1], corners[1:]], axis=1)
    weight = Fraction(positive(linear_density, "linear_density", "kg/m"))
    lengths = [root_above(edge @ edge) for edge in _rational(segments[:, 1]) - _rational(segments[:, 0])]
    if not any(lengths):
        raise GeometryError("the wire has no length: its points are all in one place")
    return _properties(simplex_moments(segments, [weight * length for length in lengths], _OF_ROOT), "segments")


def lamina(outline: ArrayLike, areal_density: float) -> MassProperties:
    """Return the mass properties of a flat plate of negligible thickness with a polygonal outline.

    The polygon is split into triangles with its first corner, whose signed areas add up also where it is not convex;
    I1 + I2 = I3 for any lamina (textbook § 13.9).

    Parameters
    ----------
    outline : (n, 2) or (n, 3) m, n ≥ 3, corners in order, in one plane, once around: edges may touch and run to and fro
        (to a hole), but an outline that crosses itself or goes round twice is refused
    areal_density : kg/m²

    >>> lamina([[0, 0], [1, 0], [1, 1], [0, 1]], 12.0).inertia.diagonal().tolist()
    [1.0, 1.0, 2.0]
    """
    corners = _points(outline, 3)
    triangles = np.stack([np.broadcast_to(corners[0], (len(corners) - 2, 3)), corners[1:-1], corners[2:]], axis=1)
    with np.errstate(over="ignore"):
        size = float(np.ptp(corners, axis=0).max())
    if size == np.inf:
        raise _beyond_float64("above 1.8e308")
    # Outlines of any size are judged at that of about one: their squares may be beyond float64. A power of two rounds
    # nothing.
    power = int(np.frexp(size)[1])
    shape, (p, q, r) = np.ldexp(corners, -power), np.ldexp(triangles, -power).transpose(1, 0, 2)
    normals = 0.5 * np.cross(q - p, r - p)
    normal = normals.sum(axis=0)
    area = float(np.linalg.norm(normal))
    if area <= 1e-15 * np.ldexp(size, -power) ** 2:
        raise GeometryError("the outline encloses no area: give its corners in order around it")
    off = np.ldexp(np.abs((shape - shape.mean(axis=0)) @ (normal / area)), power)
    if off.max() > _FLAT * size:
        worst = int(off.argmax())
        raise GeometryError(
            f"outline[{worst}] is {off[worst]:.3g} m off the plane of the outline, the limit is {_FLAT * size:.3g} m: "
            "a lamina is flat; use a mesh with shell=THICKNESS"
        )
    require_simple(np.delete(shape, np.abs(normal).argmax(), axis=1))
    weight = positive(areal_density, "areal_density", "kg/m²")
    a, b, c = _rational(triangles).transpose(1, 0, 2)
    doubled = np.cross(b - a, c - a)
    total = doubled.sum(axis=0)
    factor = Fraction(weight) / (2 * root_above(total @ total))
    return _properties(simplex_moments(triangles, factor * (doubled @ total), _OF_ROOT), "triangles")


def _points(value: ArrayLike, least: int) -> Float:
    points = _numbers(value, "points")
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < least:
        raise UsageError(f"points must have shape (n, 3) with n at least {least}, not {points.shape}")
    if not np.isfinite(points).all():
        row = int(np.argwhere(~np.isfinite(points))[0, 0])
        says = f"point {row} has the coordinates {points[row].tolist()}, which are not all finite"
        raise GeometryError(says, code="non_finite")
    return points


def _numbers(value: ArrayLike, name: str) -> Float:
    try:
        return reals(value)
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be an array of numbers") from None


def _rational(array: Float) -> NDArray[np.object_]:
    """Return the same numbers as `Fraction`s."""
    return np.array([Fraction(k) for k in array.flat], dtype=object).reshape(array.shape)


def _properties(moments: Moments, elements: str) -> MassProperties:
    """Return the mass properties of exact sums; no unit of coordinates can be named to those of bodies in SI."""
    try:
        return MassProperties.from_moments(moments, ZERO, ZERO, f"exact sums over {elements}")
    except GeometryError as error:
        if error.words in (TOO_LARGE, TOO_SMALL):
            raise _beyond_float64("above 1.8e308" if error.words == TOO_LARGE else "below 5e-324") from None
        raise


def _beyond_float64(where: str) -> GeometryError:
    return GeometryError(
        f"the mass or the tensor is {where} and leaves float64: check the coordinates, which are in m, and the masses "
        "or densities"
    )
