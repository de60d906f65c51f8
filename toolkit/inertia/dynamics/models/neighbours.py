"""How neighbouring motions part: what a small change of the input does to the attitude, by solving again with it.

Where neighbours part linearly in time a relative change δ moves the attitude by about δ |ω| T; near an unstable motion
by δ exp(λ T). The same solver that gives the motion gives its neighbours, at some instants, to the two or three digits
that a bound needs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.records import dataclass

INSTANTS = 33
"""Instants at which neighbours are compared, evenly spaced, and as many more towards the start."""

_FIRST = 1e-9  # of the duration
_FAR = 0.1  # rad, up to which a difference is taken as proportional to the change
_BEYOND = 0.1  # of that, where the accuracy is reached
ROUNDED = 4 * 2.0**-52
"""Of every figure of a start, relative: what is lost on its way into equations and through their first steps."""

_LOOSELY, _CLOSELY = (1e-6, 1e-9), 1e-13  # a change of a start and a tolerance with which it shows; the finest of them
_NEAR = 1e-3  # rad, up to which that effect is taken as proportional to the change
_PATTERNS = 4
_CHANCE = 3.0  # by which noise may do more than a few patterns of it
_LEAST, _MOST = 1e-14, 1e-7  # of a change, relative


@dataclass(frozen=True, eq=False)
class InputBound:
    """How far what is not known of the mass properties may move the attitude.

    Attributes
    ----------
    time : (n,) s, ascending
    angle : (n,) rad, at most up to each; infinite from where it is no longer proportional to what is not known
    """

    time: Float
    angle: Float

    @classmethod
    def none(cls, duration: float) -> InputBound:
        """Return the bound of what is known exactly."""
        return cls(np.array([0.0, duration]), np.zeros(2))

    def until(self, accuracy: float) -> float:
        """Return the time in s up to which the attitude is moved by no more than `accuracy`."""
        return crossing(self.time, self.angle, accuracy)


def crossing(time: Float, growing: Float, limit: float) -> float:
    """Return the time at which a growing function (n,), linear in between, passes a limit; the last if it does not.

    >>> crossing(np.array([0.0, 1.0, 2.0]), np.array([0.0, 2.0, np.inf]), 1.0)
    0.5
    """
    beyond = np.flatnonzero(~(growing <= limit))
    if not beyond.size:
        return float(time[-1])
    k = int(beyond[0])
    if k == 0:
        return float(time[0])
    share = (limit - growing[k - 1]) / (growing[k] - growing[k - 1])
    return float(time[k - 1] + share * (time[k] - time[k - 1]))


def value_at(time: Float, growing: Float, instant: float) -> float:
    """Return a growing function (n,) at an instant; it may become infinite."""
    k = int(np.searchsorted(time, instant))
    if time[k] == instant or not np.isfinite(growing[k]):
        return float(growing[k])
    return float(np.interp(instant, time, growing))


def instants_of(duration: float) -> Float:
    """Return the instants (n,) at which neighbours are compared."""
    shares = np.union1d(np.linspace(0.0, 1.0, INSTANTS), np.geomspace(_FIRST, 1.0, INSTANTS))
    return np.asarray(duration * shares)


def nudge_of(unknown: float, accuracy: float) -> float:
    """Return a relative change that shows how far what is relatively `unknown` counts, up to where it matters.

    Where `unknown` reaches the accuracy, the change neither drowns in rounding nor leaves proportionality.
    """
    return min(max(_BEYOND * _FAR * unknown / accuracy, _LEAST), _MOST)


def parted(moved: Float, attitude: Float, nudge: float) -> Float:
    """Return (n,) how many rad the attitude moves for a relative change of one, at most up to each instant.

    Parameters
    ----------
    moved : (k, n, 4), attitudes after k changes that are independent of each other
    attitude : (n, 4), without
    nudge : how large each change is
    """
    apart = quaternion.angle_between(moved, attitude)
    largest = np.sqrt((apart**2).sum(axis=0))
    return np.asarray(np.maximum.accumulate(np.where(apart.max(axis=0) > _FAR, np.inf, largest / nudge)))


def growth(
    follow: Callable[[Float, Float], tuple[Float, Float]],
    attitude: Float,
    angular_velocity: Float,
    rate: float,
    nudge: float,
) -> Float:
    """Return (n,) how far the attitude moves for a change of the start of one: of ω by `rate`, of the axis by a radian.

    Parameters
    ----------
    follow : takes attitude (4,) and ω (3,) at t = 0 to attitudes (n, 4) and ω (n, 3)
    """
    steps = nudge * np.eye(3)
    starts = [(attitude, angular_velocity + rate * step) for step in steps]
    starts += [(quaternion.multiply(quaternion.from_rotation_vector(s), attitude), angular_velocity) for s in steps[:2]]
    return parted(np.stack([follow(*start)[0] for start in starts]), follow(attitude, angular_velocity)[0], nudge)


def left_open(follow: Callable[[Float, float], Float], figures: int, relative: float) -> Float:
    """Return (n,) how far what is left open of a start may move the attitude, at most up to each instant, in rad.

    A start next to an unstable motion may be off that by no more than is left open: only changes of that size show
    what becomes of it, and so they are what is compared where larger ones do too much.

    Parameters
    ----------
    follow : takes a relative change (k,) of the figures of the start, and a tolerance, to attitudes (n, 4), at instants
        that show how far neighbours part meanwhile
    figures : k
    relative : how far each figure may be off
    """
    signs = np.random.default_rng(figures).choice([-1.0, 1.0], (_PATTERNS, figures))
    chance = 1.0
    for change, tolerance in (_LOOSELY, (relative, _CLOSELY)):
        if change < relative:
            continue
        path = follow(np.zeros(figures), tolerance)
        apart = np.stack([quaternion.angle_between(follow(change * each, tolerance), path) for each in signs])
        if apart.max() <= _NEAR:
            break
        chance = _CHANCE
    moved = chance * relative / change * np.linalg.norm(apart, axis=0)
    return np.asarray(np.minimum(np.maximum.accumulate(moved), np.pi))
