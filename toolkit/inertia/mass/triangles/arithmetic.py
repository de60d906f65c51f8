"""Moments of a solid in float64, double-double or exact arithmetic, and which of them an accuracy asks for."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from math import isfinite, sqrt
from typing import Literal

import numpy as np

from inertia.arrays import Progress
from inertia.mass.moments import Moments, Over
from inertia.mass.rounding import as_written, shell_as_written
from inertia.mass.triangles import double_double, exact, fine_sums
from inertia.mass.triangles.moments_from_sums import (
    ROUNDOFF,
    a_priori,
    distances,
    fine_values,
    in_two_parts,
    moments_of,
    moments_with_bounds,
    roughest,
)
from inertia.mass.triangles.sums import (
    CAME_ALONG,
    Frame,
    PlainSums,
    Sums,
    SumsOnGrid,
    in_float64,
    sum_in,
    sum_triangles,
)
from inertia.mesh.part import Rounding
from inertia.mesh.surface import Triangles

Arithmetic = Literal["float64", "double-double", "exact"]

METHODS: dict[Arithmetic, str] = {
    "float64": "float64, certified bound",
    "double-double": double_double.METHOD,
    "exact": exact.METHOD,
}

COSTLY = 200_000
"""Triangles above which double-double sums that are not compiled cost too much to measure errors by them."""

_NEAR, _FEW = 64.0, 8_192

FINEST = 1.2e-16
"""Smallest relative accuracy that results in float64 can have: their rounding is up to 1.1e-16."""


def arithmetics(accuracy: float | str | None) -> tuple[Arithmetic, ...]:
    """Return what to try for an accuracy, the cheapest first (None: what float64 gives, if it will do)."""
    return ("exact",) if accuracy == "exact" else ("float64", "double-double", "exact")


def solid_moments(
    triangles: Triangles,
    arithmetic: Arithmetic,
    sums: Sums | None = None,
    progress: Progress | None = None,
    rounding: Rounding | None = None,
) -> Moments:
    """Return the moments of the solid inside a closed surface, in the file's unit, by one method.

    Parameters
    ----------
    sums : the float64 sums of the same triangles, where they are at hand
    progress : called with the fraction done
    rounding : of the coordinates, when they were read
    """
    if rounding is not None:
        sums = sums or sum_triangles(triangles)
        moments = solid_moments(triangles, arithmetic, sums, progress)
        return as_written(moments, triangles, sums, rounding, exactly=arithmetic != "float64")
    if arithmetic == "exact":
        return exact.exact_moments(triangles, progress)
    if sums is None:
        sums = sum_triangles(triangles)
    if arithmetic == "float64" and isinstance(sums, SumsOnGrid):
        sums, fine = _on_a_grid_that_suits(triangles, sums, progress)
        if fine is not None and _near(*fine, triangles.count):
            return moments_with_bounds(*fine, sums)
        arithmetic = "double-double"
    plain = in_float64(sums, triangles, progress)
    if arithmetic == "float64":
        return moments_of(plain, bounds=_measured(triangles, plain, progress))
    return _of_more_digits(triangles, plain, progress, surface=False)


def _of_more_digits(triangles: Triangles, sums: PlainSums, progress: Progress | None, *, surface: bool) -> Moments:
    """Return the moments of double-double sums."""
    high, low = double_double.sum_in_double_double(triangles, sums, progress, surface=surface)
    bounds = a_priori(high, sums, double_double.ROUNDINGS)
    return moments_with_bounds(in_two_parts(high, low), bounds, sums, surface=surface)


def _measured(triangles: Triangles, sums: PlainSums, progress: Progress | None) -> list[float] | None:
    """Return bounds on the errors of float64 sums that are near them; None where they would cost too much."""
    if triangles.count > COSTLY and not double_double.compiled(triangles, sums):
        return None
    if sums.finer is not None:
        return distances(sums, *sums.finer, roughest(sums, CAME_ALONG))
    with np.errstate(over="ignore", invalid="ignore"), suppress(OverflowError, ValueError):  # beyond float64
        high, low = double_double.sum_in_double_double(triangles, sums, progress)
        bounds = distances(sums, high, low, roughest(sums, double_double.ROUNDINGS.most(sums.count)))
        return bounds if all(map(isfinite, bounds)) else None
    return None


def _on_a_grid_that_suits(
    triangles: Triangles, sums: SumsOnGrid, progress: Progress | None
) -> tuple[Sums, tuple[Over, list[float]] | None]:
    """Return the sums, formed again where the sample misled that the grid was chosen from, and their values."""
    if (values := fine_values(sums)) is not None:
        return sums, values
    grid = fine_sums.grid_again(sums.low, sums.high, sums.fine)
    again = sum_in(Frame(sums.origin, 0, False, None) if grid is None else Frame.on(grid), triangles, progress)
    return again, fine_values(again)


def _near(values: Over, bounds: Sequence[float], count: int) -> bool:
    """Say whether bounds are at most tens of times what rounding volume, centre and tensor to float64 may do.

    Of few triangles, where more digits take little time, they are to be no more than that. Σd s is compared with that
    of a body whose centre lies off by its radius of gyration, 4 Σd times that.
    """
    numbers, d = values
    volume, spread = abs(numbers[0] / d), sum(abs(n / d) for n in numbers[4:7])
    sizes = volume, 4.0 * sqrt(volume * spread / 10.0), spread
    largest = bounds[0], max(bounds[1:4]), max(bounds[4:7])
    within = (_NEAR if count > _FEW else 1.0) * ROUNDOFF
    return all(bound <= within * size for bound, size in zip(largest, sizes, strict=True))


def shell_moments(
    triangles: Triangles,
    arithmetic: Arithmetic,
    sums: Sums | None = None,
    progress: Progress | None = None,
    rounding: Rounding | None = None,
) -> Moments:
    """Return the moments of the surface itself, whose zeroth is its area, as `solid_moments` does those of a solid."""
    if sums is None:
        sums = sum_triangles(triangles, surface=True)
    if rounding is not None:
        return shell_as_written(shell_moments(triangles, arithmetic, sums, progress), triangles, sums, rounding)
    plain = in_float64(sums, triangles)
    if arithmetic == "float64":
        return moments_of(plain, surface=True)
    return _of_more_digits(triangles, plain, progress, surface=True)
