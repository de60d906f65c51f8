"""Instants at which a function of the motion passes through zero, between the samples."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.errors import UsageError

State = TypeVar("State")


def find_events(
    function: Callable[[State], float],
    time: ArrayLike,
    values: ArrayLike,
    refine: Callable[[float], State],
    *,
    direction: int = 0,
) -> Float:
    """Return the instants (k,) in s, ascending, at which `function` of the state changes its sign.

    Each change of sign between two samples is brought to rounding by Brent's method on states between them. Two
    changes between neighbouring samples are not seen: sample densely enough, or look for a zero of the derivative.

    Parameters
    ----------
    function : takes a state to a number: an angle's rate for a turning point, a height for the crossing of a plane, the
        normal force for lift-off
    time : (n,) s, ascending; values : (n,) the function at these times
    refine : takes an instant between two samples to the state then (dense output, closed form or a short new run)
    direction : 1 for rising values only, −1 for falling ones, 0 for both

    Raises `UsageError` for samples that are not finite or not of one length.

    >>> find_events(lambda x: x - 0.25, [0.0, 1.0, 2.0], [-0.25, 0.75, 3.75], lambda t: t * t).tolist()
    [0.5]
    """
    from scipy.optimize import brentq

    instants, samples = np.asarray(time, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if instants.ndim != 1 or instants.shape != samples.shape or not np.isfinite(samples).all():
        raise UsageError(
            f"events need finite values at every time: {instants.shape} times, {samples.shape} values, "
            f"{int((~np.isfinite(samples)).sum())} of them not finite"
        )
    signs = np.sign(samples)
    nonzero = np.flatnonzero(signs)
    zeros = []
    for before, after in zip(nonzero[:-1].tolist(), nonzero[1:].tolist(), strict=True):
        if signs[before] == signs[after] or signs[after] == -direction:
            continue
        if after > before + 1:
            zeros.append(float(instants[before + 1]))  # a sample on the zero itself
            continue
        low, high = float(instants[before]), float(instants[after])

        def between(at: float, ends: tuple[int, int] = (before, after)) -> float:
            for end in ends:
                if at == instants[end]:
                    return float(samples[end])
            return float(function(refine(at)))

        eps = float(np.finfo(np.float64).eps)
        zeros.append(float(brentq(between, low, high, xtol=4.0 * eps * max(abs(low), abs(high)), rtol=4.0 * eps)))
    return np.array(zeros)
