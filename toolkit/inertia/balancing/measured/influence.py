"""Balancing from vibration readings: influence coefficients for one plane, two or more, at any speeds and sensors.

The vibration of a linear machine at a given speed is V = V₀ + A w, with w the unbalance added in each correction
plane. Trial runs give A; the weights to mount are those that make Σ pₖ |Vₖ|² least (least squares), or the largest of
√pₖ |Vₖ| (min-max), each within the limit of its plane.

Readings and weights are complex, and their angles must run in the same sense (`inertia.balancing.measured.readings`).
Weights are in kg·m, or in any other unit, as long as it is the same in the trial runs and the limits.

Goodman, T. P. (1964), A least-squares method for computing balance corrections, J. Eng. Ind. 86(3), 273-277.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.measured.bounded_least_squares import least_squares_in_discs
from inertia.balancing.measured.min_max import min_max_in_discs
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex
from inertia.errors import GeometryError, UsageError
from inertia.records import dataclass

Criterion = Literal["least squares", "min-max"]
"""What the weights make least: the sum of the squares of the readings, or the largest of them."""

CONDITION_WARNING = 10.0
"""Condition above which readings good to 2 % leave the weights uncertain by a fifth."""

_SINGULAR = 1e10
_AT_LIMIT = 1e-6  # relative


@dataclass(frozen=True, eq=False)
class InfluenceCorrection:
    """The weights to mount, and what vibration they should leave.

    Attributes
    ----------
    unbalance : (n,) to add in each plane, in the unit of the trial weights
    residual : vibration predicted, in the shape and unit of the readings
    condition : of the coefficients with each plane's column scaled to unit length: relative errors of the readings may
        show in the weights up to this many times larger
    limited : planes whose weight is at its limit
    gap : by how much the largest reading may at most be above the least possible, relative; of min-max, else 0
    notes : what the shop should know, in sentences
    """

    unbalance: Complex
    residual: Complex
    condition: float
    limited: tuple[int, ...]
    gap: float
    notes: tuple[str, ...]


def influence_coefficients(initial: ArrayLike, trials: ArrayLike, weights: ArrayLike) -> Complex:
    """Return the change of each reading per unit of unbalance in each plane.

    With one trial a plane, Aₖⱼ = (Vₖⱼ − Vₖ₀)/wⱼ; with more, or weights in several planes at once, least squares.

    Parameters
    ----------
    initial : (...) readings of the run without trial weights, one for each speed and sensor, in any shape
    trials : (r, ...) readings of each trial run, in the same shape
    weights : (n,) the trial weight of each plane where each run has its own plane (r = n); else (r, n), what was
        mounted in every plane in each run

    Returns (..., n), in units of vibration per unit of weight. Raises `UsageError` where the runs do not tell the
    planes apart.

    >>> influence_coefficients(1.0, [3.0], [0.5]).real.tolist()
    [4.0]
    """
    before = complex_of(initial, "initial")
    after = complex_of(trials, "trials")
    mounted = complex_of(weights, "weights")
    if mounted.ndim == 1:
        mounted = np.diag(mounted)
    if mounted.ndim != 2 or after.shape != (len(mounted), *before.shape):
        raise UsageError(
            f"trials have shape {after.shape} and weights {mounted.shape}: give one trial run for each row of weights, "
            f"with readings of shape {before.shape} as in the initial run"
        )
    if len(mounted) == 0 or _condition(mounted) > _SINGULAR:
        raise UsageError(
            f"{len(mounted)} trial runs do not tell {mounted.shape[1]} planes apart: mount a weight in every plane, "
            "in runs that are not multiples of each other"
        )
    change = (after - before).reshape(len(mounted), -1)
    coefficients = np.linalg.lstsq(mounted, change, rcond=None)[0].T
    return complex_of(coefficients.reshape(*before.shape, mounted.shape[1]), "coefficients")


def influence_correction(
    initial: ArrayLike,
    coefficients: ArrayLike,
    *,
    importance: ArrayLike | None = None,
    limits: ArrayLike | None = None,
    criterion: Criterion = "least squares",
) -> InfluenceCorrection:
    """Return the weights that leave the least vibration, min Σ pₖ |V₀ₖ + Σⱼ Aₖⱼ wⱼ|² with |wⱼ| ≤ limitⱼ.

    By min-max it is min maxₖ √pₖ |V₀ₖ + Σⱼ Aₖⱼ wⱼ|: no reading is left above the others where weights can lower it.

    Parameters
    ----------
    initial : (...) readings to be balanced out, one for each speed and sensor
    coefficients : (..., n), see `influence_coefficients`; they may come from an earlier job
    importance : (...) pₖ of each reading, not negative; 1 where it is not given
    limits : (n,) or one number: the largest weight for each plane; none where it is not given
    criterion : "least squares" or "min-max"

    Raises `UsageError` where there are fewer readings than planes, `GeometryError` where the readings do not tell the
    planes apart.

    >>> correction = influence_correction([1.0, 3.0], [[2.0, 0.0], [0.0, 4.0]], limits=0.6)
    >>> correction.unbalance.real.round(9).tolist(), correction.residual.real.round(9).tolist(), correction.limited
    ([-0.5, -0.6], [0.0, 0.6], (1,))
    >>> even = influence_correction([1.0, 3.0], [[1.0], [1.0]], criterion="min-max")
    >>> even.unbalance.real.round(6).tolist(), even.residual.real.round(6).tolist()
    ([-2.0], [-1.0, 1.0])
    """
    if criterion not in get_args(Criterion):
        raise UsageError(f"criterion is {criterion!r}: use one of {', '.join(map(repr, get_args(Criterion)))}")
    before = complex_of(initial, "initial")
    matrix = complex_of(coefficients, "coefficients")
    if matrix.shape[:-1] != before.shape or matrix.shape[-1] == 0:
        raise UsageError(
            f"coefficients have shape {matrix.shape}: the readings of shape {before.shape} need that shape and one "
            "axis more, the planes"
        )
    planes = matrix.shape[-1]
    root = np.sqrt(_numbers(1.0 if importance is None else importance, before.shape, "importance")).ravel()
    largest = _numbers(np.inf if limits is None else limits, (planes,), "limits")
    used = int(np.count_nonzero(root))
    if used < planes:
        raise UsageError(
            f"{used} readings count for {planes} planes: measure at as many speeds and sensors as there are planes, or "
            "use fewer planes"
        )
    weighted = root[:, None] * matrix.reshape(-1, planes)
    condition = _condition(weighted)
    if condition > _SINGULAR:
        raise GeometryError(
            f"the coefficients of {planes} planes have condition {condition:.3g}, above {_SINGULAR:g}: the readings do "
            "not tell the planes apart; add a speed or a sensor, or leave a plane out"
        )
    target, gap = root * before.ravel(), 0.0
    if criterion == "min-max":
        weights, least = min_max_in_discs(weighted, target, largest)
        top = float(np.abs(target + weighted @ weights).max())
        gap = (top - least) / top if least else 0.0
    else:
        weights = least_squares_in_discs(weighted, target, largest)
    limited = tuple(np.flatnonzero(np.abs(weights) >= largest * (1.0 - _AT_LIMIT)).tolist())
    residual = before + matrix @ weights
    return InfluenceCorrection(weights, residual, condition, limited, gap, _notes(condition, limited, largest))


def _notes(condition: float, limited: tuple[int, ...], largest: Float) -> tuple[str, ...]:
    notes = [f"plane {plane + 1} is at its limit of {largest[plane]:.6g}" for plane in limited]
    if condition > CONDITION_WARNING:
        notes.append(
            f"the coefficients have condition {condition:.3g}, above {CONDITION_WARNING:g}: an error of 1 % in the "
            f"readings may change the weights by up to {condition:.3g} %; move a plane or a sensor, or add a speed"
        )
    return tuple(notes)


def _condition(matrix: Complex) -> float:
    length = np.linalg.norm(matrix, axis=0)
    if not length.all():
        return float("inf")
    singular = np.linalg.svd(matrix / length, compute_uv=False)
    if len(singular) < matrix.shape[1] or singular[-1] == 0:
        return float("inf")
    return float(singular[0] / singular[-1])


def _numbers(value: ArrayLike, shape: tuple[int, ...], name: str) -> Float:
    try:
        figures = np.broadcast_to(np.asarray(value, dtype=np.float64), shape)
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be numbers of shape {shape}") from None
    if not (figures >= 0).all():
        raise UsageError(f"{name} are {figures.tolist()}: they must be numbers that are not negative")
    return figures
