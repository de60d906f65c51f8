"""A body of revolution rolling without slipping on its rim: a disc, a hoop, a coin, a wheel, a cup on its edge."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models import neighbours
from inertia.dynamics.models.neighbours import ROUNDED, instants_of
from inertia.dynamics.models.rolling.constants import appell_korteweg
from inertia.dynamics.models.rolling.equations import RollingBody, angular_acceleration, energy, reaction
from inertia.dynamics.models.rolling.integration import FINEST, FLAT, Path, clearance, follow, pace
from inertia.dynamics.models.rolling.steady import nutation_squared
from inertia.dynamics.motion import Event, Motion
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import array_of

METHODS = {"nutation": 8, "DOP853": 8}
"""The methods by name, with their orders; the first is the default."""

_LOOSEST = 1e-8
"""A loose integrator can step over the instant at which a nearly flat disc turns back."""

_STEADY = 1e-6
"""|ω₁| and |ω̇₁| below this part of what the pace of the motion makes of them count as steady."""

_UNLIKE = 0.1  # what a lack of symmetry does to what a change of the start by as much does
_EPSILON = 2.0**-52
_FINISH = 12.0  # roundings between the states and the attitude


def solve_rolling(
    mass: float,
    moments: tuple[float, float],
    radius: float,
    offset: float,
    gravity: float,
    attitude: ArrayLike,
    angular_velocity: ArrayLike,
    time: ArrayLike,
    accuracy: float,
    method: str | None = None,
    unlike: float = 0.0,
) -> Motion:
    """Return how a body of revolution rolls without slipping on its rim, on the horizontal plane z = 0 of space.

    The equations of `inertia.dynamics.models.rolling.equations` (textbook eq. 13.199; any offset) are integrated by
    DOP853 over one nutation, which then repeats, turned and moved along: the cost does not grow with the duration. The
    tolerance is tightened until two runs, one at a tenth of the other's, agree to `accuracy`; where float64 ends
    before that, `reached` is larger.

    Parameters
    ----------
    mass : kg
    moments : kg m², about the centre of mass: the transverse I₁ = I₂, and I₃ about the symmetry axis, which is axis 3
    radius : m, of the rim
    offset : m, from the centre of mass along axis 3 to the plane of the rim
    gravity : m/s², along −z
    attitude : (4,) at t = 0; the lowest point of the rim is then at the origin of space
    angular_velocity : (3,) rad/s at t = 0, along the body's axes; the velocity follows from it
    time : (n,) s, ascending from 0 or later
    accuracy : rad
    unlike : how far the body is from one of revolution, relative to its smallest moment
    method : "nutation", as above (default), or "DOP853" over the whole time

    Returns
    -------
    A `Motion` with the centre of mass as `position`; the invariants "energy" (J), "Appell–Korteweg 1" and
    "Appell–Korteweg 2" (rad/s, `inertia.dynamics.models.rolling.constants`); and the quantities "theta", "phi", "psi"
    (rad, z-x-z), "theta rate", "phi rate", "psi rate" (rad/s), "contact" (n, 3) m and "contact force" (n, 3) N, of
    the plane on the body. The plane holds the body down where it has to: an event "lift-off" and a warning say when
    that begins.

    Raises `GeometryError` where the body is not physical, lies flat at the start, or falls flat within the time asked
    for, since an impact follows; `UsageError` for an argument that cannot be used.

    >>> upright = [0.5**0.5, 0.0, 0.0, 0.5**0.5]
    >>> motion = solve_rolling(1.0, (0.25, 0.5), 1.0, 0.0, 9.81, upright, [0, 0, -2], [0.0, 1.0], 1e-9)
    >>> motion.quantities["contact"][1].round(9).tolist()
    [2.0, 0.0, 0.0]
    """
    if method not in (None, *METHODS):
        raise UsageError(f"method {method!r} does not follow a rolling body: use {' or '.join(METHODS)}")
    if not 0 < accuracy < np.inf:
        raise UsageError(f"the accuracy is {accuracy} rad: it must be positive and finite")
    transverse, axial = array_of(moments, (2,), "moments").tolist()
    body = RollingBody(mass, transverse, axial, radius, offset, gravity)
    start = state_of(body, array_of(attitude, (4,), "attitude"), array_of(angular_velocity, (3,), "angular_velocity"))
    instants = array_of(time, (np.size(time),), "time")
    if not instants.size or instants[0] < 0 or (np.diff(instants) < 0).any():
        raise UsageError("the times of a rolling body must ascend from 0 or later")

    repeat = method != "DOP853"
    between = np.union1d(instants, instants_of(float(instants[-1]) or 1e-3 / pace(body, start)))
    noise = float(left_open(body, start, between, repeat, max(_UNLIKE * unlike, ROUNDED))[-1])
    path, states, reached = _refined(body, start, instants, accuracy, repeat, noise)
    unstable = _instability(body, start)
    events, warnings = _lift_off(body, path, instants[-1])
    theta, w1, w2, w3, sigma, delta, x, y = states
    s, c, phi, psi = np.sin(theta), np.cos(theta), 0.5 * (sigma + delta), 0.5 * (sigma - delta)
    turn = np.stack([np.cos(phi), np.sin(phi)])
    along, across, up = reaction(body, s, c, w1, w2, w3)
    first, second = appell_korteweg(body, theta, w2, w3)
    scale = float(max(pace(body, start), abs(first[0]), abs(second[0])))
    position = np.stack([x * radius, y * radius, radius * s - offset * c], axis=-1)
    reach = offset * s + radius * c
    contact = np.stack([position[:, 0] + reach * turn[1], position[:, 1] - reach * turn[0], np.zeros_like(x)], axis=-1)
    repeated = "" if path.nutation is None else f" over one nutation of {path.nutation.period:.6g} s, which repeats"
    return Motion(
        attitude=attitude_of(states),
        angular_velocity=np.stack(
            [w1 * np.cos(psi) + w2 * np.sin(psi), w2 * np.cos(psi) - w1 * np.sin(psi), w3], axis=-1
        ),
        method=f"DOP853 (order 8){repeated}",
        reached=min(np.pi, reached),
        position=position,
        invariants={
            "energy": energy(body, s, c, w1, w2, w3),
            "Appell–Korteweg 1": first,
            "Appell–Korteweg 2": second,
        },
        scales={"Appell–Korteweg 1": scale, "Appell–Korteweg 2": scale},
        quantities={
            "theta": theta,
            "phi": phi,
            "psi": psi,
            "theta rate": w1,
            "phi rate": w2 / s,
            "psi rate": w3 - w2 * c / s,
            "contact": contact,
            "contact force": np.stack(
                [along * turn[0] - across * turn[1], along * turn[1] + across * turn[0], up], axis=-1
            ),
        },
        events=events,
        warnings=unstable + warnings,
        steps=len(path.times) - 1,
    )


def left_open(body: RollingBody, start: Float, instants: Float, repeat: bool, relative: float) -> Float:
    """Return (n,) how far what is left open of the figures of a start (8,) may move the attitude, rad."""
    rate, end = pace(body, start), float(instants[-1]) or 1e-3 / pace(body, start)

    def attitudes(change: Float, tolerance: float) -> Float:
        there = start + np.concatenate([change * [1.0, rate, rate, rate], np.zeros(4)])
        path = follow(body, there, end, repeat, max(tolerance, FINEST))
        return attitude_of(path(instants if path.flat is None else np.minimum(instants, path.flat)))

    return neighbours.left_open(attitudes, 4, relative)


def state_of(body: RollingBody, attitude: Float, angular_velocity: Float) -> Float:
    """Return the state (8,) that `follow` starts from."""
    if not attitude.any():
        raise UsageError("the attitude is zero: give a quaternion (x, y, z, w)")
    x, y, z, w = attitude / np.linalg.norm(attitude)
    theta = 2.0 * np.arctan2(np.hypot(x, y), np.hypot(z, w))
    sigma, delta = 2.0 * np.arctan2(z, w), 2.0 * np.arctan2(y, x)
    phi, psi = 0.5 * (sigma + delta), 0.5 * (sigma - delta)
    p, q, r = angular_velocity
    reach = body.reduced[2] * np.sin(theta) + np.cos(theta)
    state = np.array(
        [
            theta,
            p * np.cos(psi) - q * np.sin(psi),
            p * np.sin(psi) + q * np.cos(psi),
            r,
            sigma,
            delta,
            -reach * np.sin(phi),
            reach * np.cos(phi),
        ]
    )
    if clearance(body, state) <= FLAT:
        raise GeometryError(
            f"at the start axis 3 is {theta:.6g} rad from the vertical and the centre of mass "
            f"{body.radius * np.sin(theta) - body.offset * np.cos(theta):.6g} m above the plane: the body lies flat; "
            "tilt it to roll on its rim"
        )
    return state


def attitude_of(states: Float) -> Float:
    """Return the quaternions (n, 4) of states (8, n)."""
    half, sigma, delta = 0.5 * states[0], 0.5 * states[4], 0.5 * states[5]
    s, c = np.sin(half), np.cos(half)
    return np.stack([s * np.cos(delta), s * np.sin(delta), c * np.sin(sigma), c * np.cos(sigma)], axis=-1)


def _refined(
    body: RollingBody, start: Float, time: Float, accuracy: float, repeat: bool, noise: float
) -> tuple[Path, Float, float]:
    """Return the path, its states (8, n) at `time`, and twice the angle in rad by which the run before was off, with
    the noise, rad, of the start.

    Twice, since two runs that differ by rounding alone may agree by chance.
    """
    end = float(time[-1]) or 1e-3 / pace(body, start)
    before: tuple[Float, Float] | None = None
    reached = np.inf
    for tolerance, share in _rungs(accuracy):
        path = follow(body, start, end, repeat, tolerance, share)
        if path.flat is not None:
            continue
        states = path(time)
        attitude = attitude_of(states)
        least = _EPSILON * (_FINISH + float(np.abs(states[4:6]).max())) + noise
        if before is not None and not np.array_equal(before[0], path.times):  # the same steps say nothing
            reached = 2.0 * float(quaternion.angle_between(attitude, before[1]).max()) + least
            if reached <= accuracy:
                break
        before = path.times, attitude
    if path.flat is None and reached == np.inf:  # in a step or two, whatever the tolerance
        reached = _FINISH * FINEST + least
    if path.flat is not None:
        raise GeometryError(
            f"the body falls flat at t = {path.flat:.9g} s, which an impact follows: end the run before"
        )
    return path, states, reached


def _rungs(accuracy: float) -> Iterator[tuple[float, float]]:
    """Yield tolerances and shares of their steps for `follow`, each with an error a tenth of the one before or less."""
    coarsest = math.floor(math.log10(max(min(accuracy / 30, _LOOSEST) / FINEST, 1.0)))
    yield from ((FINEST * 10.0**power, 1.0) for power in range(coarsest, -1, -1))
    yield from ((FINEST, 0.6), (FINEST, 0.45))


def _instability(body: RollingBody, start: Float) -> tuple[str, ...]:
    """Return a warning where the start is next to an unstable steady motion."""
    rate = pace(body, start)
    theta, w1, w2, w3 = start[:4].tolist()
    push = angular_acceleration(body, np.sin(theta), np.cos(theta), w1, w2, w3)[0]
    apart = max(abs(w1) / rate, abs(push) / rate**2)
    squared = nutation_squared(body, theta, w2, w3)
    if apart > _STEADY or squared >= 0:
        return ()
    return (
        f"the start is within {apart:.1e} of an unstable steady motion: a change of it grows by e every "
        f"{1 / np.sqrt(-squared):.3g} s",
    )


def _lift_off(body: RollingBody, path: Path, end: float) -> tuple[tuple[Event, ...], tuple[str, ...]]:
    """Return the event, and the warning, of the first instant up to `end` s at which the plane would have to pull."""
    from scipy.optimize import brentq

    def normal(t: Float) -> Float:
        theta, w1, w2, w3 = path(t)[:4]
        up: Float = reaction(body, np.sin(theta), np.cos(theta), w1, w2, w3)[2]
        return up

    steps = path.times
    grid = np.append((steps[:-1, None] + np.diff(steps)[:, None] * np.arange(8) / 8).ravel(), steps[-1])
    grid = np.append(grid[grid < end], end)
    pulls = np.flatnonzero(normal(grid) < 0)
    if not pulls.size:
        return (), ()
    first = int(pulls[0])
    instant = 0.0
    if first:
        instant = float(brentq(lambda t: float(normal(np.array([t]))[0]), grid[first - 1], grid[first]))
    what = f"the normal force falls to zero at t = {instant:.9g} s and the body leaves the plane"
    return (Event("lift-off", instant, what),), (f"{what}: what follows is held down by a plane that pulls",)
