"""Periods of free bodies, and when a tumbling one turns over."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.dynamics.models.free import asymmetric, symmetric
from inertia.dynamics.models.free.initial_conditions import initial_conditions
from inertia.dynamics.special.double_double import add, divide, times
from inertia.errors import UsageError

MOST_FLIPS = 1_000_000
"""How many instants `flip_times` lists."""

_BLOCK = 16384
"""Bodies that are worked on at once: their intermediate results stay in the cache."""


def polhode_period(moments: ArrayLike, angular_velocity: ArrayLike) -> Float:
    """Return the period (…) in s after which ω recurs in the body: 4 K(mc)/λ, or 2π/|Ω| of a symmetric top.

    Infinite where ω is kept, and on the separatrix, where it never comes back. Vectorised over bodies and spins.

    Parameters
    ----------
    moments : (…, 3) kg m², in any order
    angular_velocity : (…, 3) rad/s, along the principal axes

    >>> polhode_period([[1, 2, 3], [2, 2, 1]], [0.001, 10, 0]).round(6).tolist()
    [7.341564, inf]
    """
    start = initial_conditions(moments, angular_velocity)
    period = np.full(len(start.moments), np.inf)
    for kind, of_rows in ((start.symmetric, symmetric.period), (start.asymmetric, asymmetric.period)):
        rows = np.flatnonzero(kind)
        for first in range(0, rows.size, _BLOCK):
            some = rows[first : first + _BLOCK]
            period[some] = of_rows(start.moments[some], start.angular_velocity[some])
    seconds: Float = np.ldexp(period, -start.exponent).reshape(start.shape)
    return seconds


def flip_period(moments: ArrayLike, angular_velocity: ArrayLike) -> Float:
    """Return the time (…) in s from one flip to the next: half of `polhode_period`.

    >>> flip_period([1, 2, 3], [0.001, 10, 0]).round(6).item()
    3.670782
    """
    half: Float = 0.5 * polhode_period(moments, angular_velocity)
    return half


def flip_times(moments: ArrayLike, angular_velocity: ArrayLike, duration: float) -> Float:
    """Return the instants (k,) in s, 0 < t ≤ duration, at which one body's ω about the intermediate axis changes sign.

    sn u = 0: t = (2 K N − u₀)/λ. None where two moments are equal, or ω is kept.

    Raises `UsageError` for more than a million flips.

    >>> flip_times([1, 2, 3], [0.001, 10, 0], 10.0).round(6).tolist()
    [1.835391, 5.506173, 9.176955]
    """
    start = initial_conditions(moments, angular_velocity)
    if start.shape:
        raise UsageError(f"flip_times follows one body, not {start.shape} of them")
    end = start.scaled_time([duration])[0, 0]
    if not start.asymmetric[0] or end <= 0:
        return np.empty(0)
    form = asymmetric.closed_form(start.moments, start.angular_velocity)
    half, rate, u0 = form.half_period, form.rate, float(form.start[0])
    first, last = sorted((u0 / half[0], (u0 + rate[0] * end) / half[0]))
    if last - first > MOST_FLIPS:
        raise UsageError(
            f"a body flips {last - first:.3g} times in {duration:g} s: ask for a duration of fewer than {MOST_FLIPS}"
        )
    numbers = np.arange(np.floor(first), np.ceil(last) + 1.0)
    instants = np.sort(divide(add(times(half, numbers), (-u0, 0.0)), rate)[0])
    inside: Float = np.ldexp(instants[(instants > 0) & (instants <= end)], -start.exponent)
    return inside


def first_flip(moments: ArrayLike, angular_velocity: ArrayLike, duration: float) -> Float:
    """Return the first of `flip_times` (…) in s of bodies that tumble; not a number where none is within `duration`.

    >>> first_flip([1, 2, 3], [[0.001, 10, 0], [1, 0, 10]], 10.0).round(6).tolist()
    [1.835391, nan]
    """
    start = initial_conditions(moments, angular_velocity)
    first = np.full(len(start.moments), np.nan)
    rows = np.flatnonzero(tumbles(moments, angular_velocity))
    for begin in range(0, rows.size, _BLOCK):
        some = rows[begin : begin + _BLOCK]
        form = asymmetric.closed_form(start.moments[some], start.angular_velocity[some])
        half, rate, u0 = (np.reshape(each, -1) for each in (form.half_period[0], form.rate[0], form.start[0]))
        number = np.where(rate > 0, np.floor(u0 / half) + 1.0, np.ceil(u0 / half) - 1.0)
        instant = np.ldexp((half * number - u0) / rate, -start.exponent[some])
        first[some] = np.where(instant <= duration, instant, np.nan)
    return first.reshape(start.shape)


def tumbles(moments: ArrayLike, angular_velocity: ArrayLike) -> NDArray[np.bool_]:
    """Say (…) which bodies turn over: L comes within 45° of the intermediate axis, in turn from either side.

    >>> tumbles([1, 2, 3], [[0.001, 10, 0], [0.001, 0, 10]]).tolist()
    [True, False]
    """
    start = initial_conditions(moments, angular_velocity)
    answer = np.zeros(len(start.moments), dtype=np.bool_)
    rows = np.flatnonzero(start.asymmetric)
    for first in range(0, rows.size, _BLOCK):
        some = rows[first : first + _BLOCK]
        form = asymmetric.closed_form(start.moments[some], start.angular_velocity[some])
        answer[some] = np.reshape((form.mc > 0) & (form.reach[1] ** 2 >= 0.5), -1)
    return answer.reshape(start.shape)
