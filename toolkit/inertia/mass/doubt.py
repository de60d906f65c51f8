"""Bounds on moments, and on mass properties, from volume that may be there or not: overlaps, slivers, filled holes."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from inertia.errors import GeometryError
from inertia.mass.moments import PAIRS, ZERO, Moments, Vector, six, vector
from inertia.mass.properties import TOO_LARGE, ErrorBound
from inertia.mass.tessellation import error_within
from inertia.mesh.doubt import Doubt
from inertia.units import Unit

FILLED = "bounds over the closures that the rims of the filled holes admit"
_ROUNDED_UP = Fraction(1) + Fraction(1, 10**9)  # more than float64 sums of positive terms can lose


def doubt_bounds(doubt: Doubt, origin: Vector) -> Moments:
    """Return moments of zero about a point, with what the volume in doubt adds to the bounds; in file units.

    The tensor of a mass m at a distance r has the norm √2 m r².
    """
    way = doubt.places - [float(k) for k in origin]
    away = abs(way) + doubt.reach[:, None]
    far = np.linalg.norm(way, axis=1) + doubt.reach
    with np.errstate(over="ignore", invalid="ignore"):
        norms = _up(float(doubt.either @ far)), _up(math.sqrt(2) * float(doubt.either @ far**2))
        first = [_up(float(doubt.either @ away[:, axis])) for axis in range(3)]
        second = [_up(float((doubt.either * away[:, i]) @ away[:, j])) for i, j in PAIRS]
    return Moments(origin, ZERO, (ZERO,) * 3, (ZERO,) * 6, _up(doubt.volume), vector(first), six(second), norms)


def doubt_error(
    doubt: Doubt,
    unit: Unit,
    moments: Moments,
    volume: Fraction,
    density: Fraction,
    method: str,
    mass: Fraction | None = None,
) -> ErrorBound:
    """Return the relative bounds that a doubt leaves, infinite where nothing is certain.

    Parameters
    ----------
    doubt : in units of `unit`
    moments : of mass, kg and m
    volume : m³
    density : kg/m³, the largest of any body
    method : what the bounds are
    mass : kg, where it was weighed: then it has no error of this kind
    """
    if not moments.zeroth:  # it has no centre
        return ErrorBound(method, math.inf, math.inf if mass is None else 0.0, math.inf, math.inf)
    f = unit.metres
    central = moments.about(moments.centroid)
    between = doubt_bounds(doubt, vector(k / f for k in central.origin)).in_unit(f).scaled(f**3 * density)
    try:
        return error_within(central, volume, between, density, mass, method)
    except GeometryError:
        share = float(between.zeroth_bound / density / volume) if volume > 0 else math.inf
        return ErrorBound(method, share, share if mass is None else 0.0, math.inf, math.inf)


def _up(value: float) -> Fraction:
    if not math.isfinite(value):
        raise GeometryError(*TOO_LARGE)
    return Fraction(value) * _ROUNDED_UP
