"""The rungs of accuracy for the volume inside a surface, from the cheapest to the dearest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from inertia.mass.moments import Moments
from inertia.mass.triangles import double_double, exact
from inertia.mass.triangles.moments_from_sums import assembled, moments_of
from inertia.mass.triangles.running_error import FEW, running_bounds
from inertia.mass.triangles.sums import Sums, sum_triangles
from inertia.mesh.part import Triangles

Rung = Literal["float64", "double-double", "exact"]

METHODS: dict[Rung, str] = {
    "float64": "float64, certified bound",
    "double-double": double_double.METHOD,
    "exact": exact.METHOD,
}

FINEST = 1.2e-16
"""Smallest relative accuracy that results in float64 can have: their rounding is up to 1.1e-16."""


def rungs(accuracy: float | str | None) -> tuple[Rung, ...]:
    """Return the rungs to try, in their order, for an accuracy asked for (None: what float64 gives, if it will do)."""
    return ("exact",) if accuracy == "exact" else ("float64", "double-double", "exact")


def solid_moments(
    triangles: Triangles,
    rung: Rung,
    sums: Sums | None = None,
    progress: Callable[[float], None] | None = None,
) -> Moments:
    """Return the moments of the solid inside a closed surface, in the file's unit, by one method.

    Parameters
    ----------
    sums : the float64 sums of the same triangles, where they are at hand
    progress : called with the fraction done
    """
    if rung == "exact":
        return exact.exact_moments(triangles, progress)
    if sums is None:
        sums = sum_triangles(triangles)
    if rung == "float64":
        return moments_of(sums, watched=running_bounds(triangles, sums) if triangles.count <= FEW else None)
    values = double_double.sum_in_double_double(triangles, sums, progress)
    return assembled(values, sums, double_double.ROUNDINGS)
