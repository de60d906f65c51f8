"""Free rotation in closed form: attitude and angular velocity of bodies with no torque on them, at any time.

Attitude and ω are those of the principal axes, in the order in which the moments are given; the attitude is the
identity at time 0. Moments, spin and time are taken as the exact numbers that they are in float64.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float, Progress
from inertia.dynamics.arguments import vectors
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.stability import growth_rate
from inertia.dynamics.models.free import asymmetric, symmetric
from inertia.dynamics.models.free.flips import flip_period, flip_times, tumbles
from inertia.dynamics.models.free.initial_conditions import InitialConditions, Rest, initial_conditions
from inertia.dynamics.motion import Event, Motion
from inertia.errors import UsageError
from inertia.mass.tensor import array_of

MOST_EVENTS = 1000
"""How many flips `solve_free` lists as events."""

_METHODS = {
    3: "closed form: steady rotation",
    2: "closed form: two uniform turns",
    1: "closed form: Jacobi elliptic functions",
}
_ULP = 2.0**-52
_BLOCK = 16384
"""Samples that are worked on at once: their intermediate results stay in the cache."""

ENSEMBLE_BLOCK = 8192
"""Bodies of an ensemble that are worked on at once, for the same reason."""


def free_motion(
    moments: ArrayLike, angular_velocity: ArrayLike, time: ArrayLike, rest: Rest | None = None
) -> tuple[Float, Float]:
    """Return attitude (…, n, 4) and ω (…, n, 3) rad/s of free bodies at any times, by the closed form of each.

    Bodies with two equal moments turn by sines (`inertia.dynamics.models.free.symmetric`), others by Jacobi's functions
    (`inertia.dynamics.models.free.asymmetric`). The error is a few roundings whatever the time: see `rounding`.

    Parameters
    ----------
    moments : (…, 3) kg m², in any order; zero for the axis of a rod
    angular_velocity : (…, 3) rad/s at time 0, along the principal axes
    time : (n,) or (…, n) s, of either sign
    rest : (…, 3) kg m² and (…, 3) rad/s, what float64 leaves out of moments and ω

    Raises `UsageError` where a number is not finite or the shapes differ, `GeometryError` where no body has these
    moments.

    >>> attitude, omega = free_motion([1, 2, 3], [0.001, 10, 0], [0.0, 3.6707819, 1e6])
    >>> omega[1].round(4).tolist()                     # turned over
    [0.001, -10.0, -0.0]
    """
    start = initial_conditions(moments, angular_velocity, rest)
    scaled = start.scaled_time(time)
    attitude, omega = np.empty((*scaled.shape, 4)), np.empty((*scaled.shape, 3))
    for rows, motion in _motions(start):
        width = max(1, _BLOCK // len(start.moments[rows]))
        for first in range(0, scaled.shape[1], width):
            some = slice(first, first + width)
            attitude[rows, some], omega[rows, some] = motion(scaled[rows, some])
    bodies, begun = (scaled == 0.0).nonzero()  # as they were at first
    attitude[bodies, begun], omega[bodies, begun] = quaternion.IDENTITY, start.angular_velocity[bodies]
    omega = np.ldexp(omega, start.exponent[:, None, None])
    shape = (*start.shape, scaled.shape[1])
    return attitude.reshape(*shape, 4), omega.reshape(*shape, 3)


def free_ensemble(
    moments: ArrayLike,
    angular_velocity: ArrayLike,
    time: ArrayLike,
    progress: Progress | None = None,
) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of N free bodies at n instants, for Monte Carlo and maps.

    The closed form of `free_motion`, as accurate as for one body, block by block: some 4e5 bodies a second on one core
    and nearly 2e6 further samples a second.
    `inertia.dynamics.models.free.flips.flip_period` maps the period of their flips.

    Parameters
    ----------
    moments : (3,) or (N, 3) kg m², in any order
    angular_velocity : (N, 3) rad/s, along the principal axes
    time : (n,) s
    progress : told the share that is done

    Raises what `free_motion` does, `UsageError` where the shapes differ.

    >>> spins = np.random.default_rng(1).normal(size=(1000, 3))
    >>> attitude, omega = free_ensemble([1, 2, 3], spins, [10.0])
    >>> attitude.shape, omega.shape
    ((1000, 1, 4), (1000, 1, 3))
    """
    moments, spins = vectors(moments, "moments"), vectors(angular_velocity, "angular_velocity")
    instants = np.asarray(time, dtype=np.float64)
    if spins.ndim != 2 or moments.shape not in ((3,), spins.shape) or instants.ndim != 1:
        raise UsageError(
            f"moments {moments.shape}, angular_velocity {spins.shape} and time {instants.shape}: "
            "an ensemble takes (3,) or (N, 3), (N, 3) and (n,)"
        )
    moments = np.broadcast_to(moments, spins.shape)
    attitude, omega = np.empty((len(spins), len(instants), 4)), np.empty((len(spins), len(instants), 3))
    for first in range(0, len(spins), ENSEMBLE_BLOCK):
        rows = slice(first, first + ENSEMBLE_BLOCK)
        attitude[rows], omega[rows] = free_motion(moments[rows], spins[rows], instants)
        if progress is not None:
            progress(min(1.0, (first + ENSEMBLE_BLOCK) / len(spins)))
    return attitude, omega


def rounding(moments: ArrayLike, angular_velocity: ArrayLike, time: ArrayLike, rest: Rest | None = None) -> Float:
    """Return an estimate (…, n) in rad of the error of `free_motion`, at least twice the largest that was seen.

    Some 4e-15 rad at any time and up to 6e-14 near the separatrix; closer to it than 1e-12 a share that grows with the
    number of flips (`inertia.dynamics.models.free.asymmetric.rounding`).

    >>> rounding([1, 2, 3], [1, 2, 3], [1e9]).item() < 5e-15
    True
    """
    start = initial_conditions(moments, angular_velocity, rest)
    scaled = start.scaled_time(time)
    error = _ULP * (8.0 + 16.0 * _ULP * np.abs(scaled))
    if start.asymmetric.any():
        rows = start.asymmetric
        form = asymmetric.closed_form(start.moments[rows], start.angular_velocity[rows], start.rest_of(rows))
        error[start.asymmetric] += asymmetric.rounding(form, scaled[start.asymmetric])
    return error.reshape(*start.shape, scaled.shape[1])


def input_rounding(moments: ArrayLike, angular_velocity: ArrayLike, time: ArrayLike) -> Float:
    """Return (…, n) in rad how far the attitude moves if moments and spin are off by one rounding.

    The root of the sum of squares of what 2⁻⁵² of each moment does, and about each axis 2⁻⁵² of the largest component
    of ω: the condition of the motion itself, which no method can better. About |ω| t 2⁻⁵² far from the separatrix; near
    it anything up to π after a few flips, a deviation from rotation about the intermediate axis growing as exp(rate t)
    (`inertia.dynamics.kinematics.stability.growth_rate`).

    >>> calm, close = input_rounding([1, 2, 3], [[1, 0, 1], [1e-9, 1, 0]], [100.0])[:, 0]
    >>> bool(calm < 1e-13 and close > 1e-10)
    True
    """
    i, w = np.broadcast_arrays(vectors(moments, "moments"), vectors(angular_velocity, "angular_velocity"))
    largest = np.abs(w).max(axis=-1, keepdims=True)
    nudges = _ULP * np.eye(6).reshape(6, *(1,) * (i.ndim - 1), 6)
    moved, _ = free_motion(i * (1.0 + nudges[..., :3]), w + largest * nudges[..., 3:], time)
    reference, _ = free_motion(i, w, time)
    return np.asarray(np.linalg.norm(quaternion.angle_between(moved, reference), axis=0))


def solve_free(
    moments: ArrayLike, angular_velocity: ArrayLike, time: ArrayLike, equal: int = 1, rest: Rest | None = None
) -> Motion:
    """Return the motion of one body's principal axes, from the identity at time 0.

    A model that is simpler than the body takes some of its moments as equal. `reached` is the rounding of the closed
    form plus the largest angle to the motion of the body as it is. Energy and L are the body's own, so that they drift
    where the model does not fit. The events are the flips of a body that tumbles, unless they are more than a thousand.

    Parameters
    ----------
    moments : (3,) kg m², in any order
    angular_velocity : (3,) rad/s at time 0, along the principal axes
    time : (n,) s
    equal : how many moments are taken as equal: 3 for a spherical top and for rotation about a steady axis, the nearest
        2 for a symmetric top, 1 for the body as it is
    rest : (3,) kg m² and (3,) rad/s, what float64 leaves out of moments and ω

    Raises `UsageError` for another `equal`, and what `free_motion` raises.

    >>> motion = solve_free([1, 2, 3], [0.001, 10, 0], np.linspace(0, 1000, 5))
    >>> motion.reached < 2e-14, [round(event.time, 3) for event in motion.events][:2]
    (True, [1.835, 5.506])
    """
    if equal not in _METHODS:
        raise UsageError(f"equal is {equal!r}: take 1, 2 or 3 moments as equal")
    i, w = array_of(moments, (3,), "moments"), array_of(angular_velocity, (3,), "angular_velocity")
    t = np.asarray(time, dtype=np.float64)
    attitude, omega = free_motion(i, w, t, rest)
    reached = float(np.max(rounding(i, w, t, rest), initial=0.0))
    idealised = _idealised(i, equal)
    if (idealised != i).any():
        true = attitude
        attitude, omega = free_motion(idealised, w, t, rest and (np.zeros(3), rest[1]))
        reached += float(np.max(quaternion.angle_between(attitude, true), initial=0.0))
    return Motion(
        attitude=attitude,
        angular_velocity=omega,
        method=_METHODS[equal],
        reached=reached,
        invariants={
            "energy": 0.5 * np.sum(i * omega * omega, axis=-1),
            "angular momentum": quaternion.to_space(attitude, i * omega),
        },
        events=_flips(idealised, w, t),
        warnings=_warnings(i, w, t),
    )


def _motions(
    start: InitialConditions,
) -> Iterator[tuple[NDArray[np.intp] | slice, Callable[[Float], tuple[Float, Float]]]]:
    """Yield the bodies that one closed form serves, and what takes their times to attitude and ω."""
    if (rows := _rows(start.steady)) is not None:
        rest = start.rest_of(rows)
        yield rows, partial(symmetric.steady, start.angular_velocity[rows], rest and rest[1])
    if (rows := _rows(start.symmetric)) is not None:
        yield rows, partial(symmetric.symmetric, start.moments[rows], start.angular_velocity[rows], start.rest_of(rows))
    if (rows := _rows(start.asymmetric)) is not None:
        constants = asymmetric.closed_form(start.moments[rows], start.angular_velocity[rows], start.rest_of(rows))
        yield rows, partial(asymmetric.evaluate, constants)


def _rows(kind: NDArray[np.bool_]) -> NDArray[np.intp] | slice | None:
    """Return where `kind` holds, which is simpler as a slice where it holds of all; None where it does not."""
    (rows,) = kind.nonzero()
    if rows.size == kind.size > 0:
        return slice(None)
    return rows if rows.size else None


def _idealised(moments: Float, equal: int) -> Float:
    idealised = moments.copy()
    if equal == 2:
        closest = min(([0, 1], [1, 2], [2, 0]), key=lambda pair: float(np.ptp(moments[pair])))
        idealised[closest] = np.mean(moments[closest])
    elif equal == 3 and np.ptp(moments):
        idealised[:] = np.mean(moments)
    return idealised


def _flips(moments: Float, angular_velocity: Float, time: Float) -> tuple[Event, ...]:
    if not time.size or not tumbles(moments, angular_velocity):
        return ()
    end = float(time.max())
    if end > MOST_EVENTS * flip_period(moments, angular_velocity):
        return ()
    instants = flip_times(moments, angular_velocity, end).tolist()
    return tuple(Event("flip", t, "the spin about the intermediate axis changes sign") for t in instants)


def _warnings(moments: Float, angular_velocity: Float, time: Float) -> tuple[str, ...]:
    if not time.size:
        return ()
    start, farthest = initial_conditions(moments, angular_velocity), float(time[np.argmax(np.abs(time))])
    if start.steady:
        return unstable(moments, angular_velocity, abs(farthest))
    if not start.asymmetric:
        return ()
    cycle = min(float(flip_period(moments, angular_velocity)), abs(farthest))
    last = farthest - np.copysign(cycle * np.linspace(0.0, 1.0, 33), farthest)
    moved = float(input_rounding(moments, angular_velocity, last).max())
    turned = float(np.linalg.norm(angular_velocity)) * abs(farthest)
    if moved < max(1e-9, 100.0 * _ULP * (1.0 + turned)):
        return ()
    rate = float(growth_rate(moments, np.sqrt(np.sum(moments * angular_velocity**2) / np.median(moments))))
    return (
        f"one rounding of the moments or the spin alone moves the attitude by up to {moved:.2g} rad: deviations from "
        f"rotation about the intermediate axis grow at {rate:.3g} 1/s",
    )


def unstable(moments: Float, angular_velocity: Float, duration: float, fastest: float = 1.0) -> tuple[str, ...]:
    """Say so where a steady spin is about the intermediate axis, and long enough for a disturbance to grow.

    Parameters
    ----------
    duration : s, at the given ω (3,) rad/s throughout
    fastest : what ω comes to, over the given one, where something drives or brakes it
    """
    along = int(np.argmax(np.abs(angular_velocity)))
    rate = float(growth_rate(moments, abs(angular_velocity[along])))
    if along != np.argsort(moments, kind="stable")[1] or rate * duration <= 1.0:
        return ()
    where = "" if fastest == 1.0 else " where the spin is fastest"
    return (
        "the spin about the axis of the intermediate moment is unstable: it stays there if nothing disturbs it, and a "
        f"disturbance grows by a factor e in {1.0 / (rate * fastest):.3g} s{where}",
    )
