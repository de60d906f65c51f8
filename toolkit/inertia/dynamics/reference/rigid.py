"""Equations of a rigid body about its centre of mass or a fixed point, with every figure as exact as the scene has it.

The attitude P is that of the principal axes to where they are at t = 0, so that vectors of space are turned into those
axes once. Loads act as `inertia.dynamics.loads` says.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity, GravityGradient
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.losses import Damping, Dissipation
from inertia.dynamics.loads.orbit import Orbit
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.model import Problem
from inertia.dynamics.models.rational import dot as inner
from inertia.dynamics.models.rational import principal_rows, rationals, root, rotated
from inertia.dynamics.reference import long
from inertia.dynamics.reference.collocation import Equations, Maker, Rates
from inertia.dynamics.reference.long import Long, Number, exactly, plain

Action = Callable[[Number, Sequence[Number], Sequence[Number], Sequence[Number]], Sequence[Number]]
"""Takes time, P, ω and the place on an orbit to a torque along the principal axes."""

IDENTITY = exactly([Fraction(k) for k in (0, 0, 0, 1)])


def rigid_equations(problem: Problem) -> Equations | None:
    """Return the equations of P (4,), ω (3,) and, on an orbit, of place and velocity; None for a load unknown here."""
    exact = problem.exact
    frame = exact.frame
    makers = [_ACTIONS.get(type(load)) for load in problem.acting]
    orbits = [load for load in problem.acting if isinstance(load, Orbit)]
    if None in makers or len(orbits) > 1 or min(frame.values) <= 0:
        return None
    axes = [exactly(row) for row in frame.rows]
    first = exactly(exact.attitude)
    passage: list[Long] = []
    for place in _passage(orbits[0]) if orbits else ():
        passage += long.times(list(zip(*axes, strict=True)), long.rotated(long.back(first), place))
    kappa = sum((Fraction(load.dissipation) for load in problem.acting), Fraction(0))

    def rates(number: Maker, begin: float) -> Rates:
        moments = [number(value) for value in frame.values]
        gaps = [number(frame.values[k - 2] - frame.values[k - 1]) for k in range(3)]
        acting = zip(makers, problem.acting, strict=True)
        actions = [make(load, problem, number, begin) for make, load in acting if make]
        loss = number(kappa)
        field = number(_field(orbits[0])) if orbits else 0.0

        def of(time: Number, state: Sequence[Number]) -> Sequence[Number]:
            turn, omega, place = state[:4], state[4:7], state[7:10]
            torque = [gaps[k] * omega[k - 2] * omega[k - 1] for k in range(3)]
            ahead = omega
            if kappa:
                slip = [loss * n / (i * i) for n, i in zip(torque, moments, strict=True)]
                ahead = [o + u for o, u in zip(omega, slip, strict=True)]
                carried = long.cross([i * o for i, o in zip(moments, omega, strict=True)], slip)
                torque = [n + u for n, u in zip(torque, carried, strict=True)]
            for action in actions:
                torque = [n + u for n, u in zip(torque, action(time, turn, omega, place), strict=True)]
            out = [*long.spun(turn, ahead), *(n / i for n, i in zip(torque, moments, strict=True))]
            if orbits:
                square = long.dot(place, place)
                pull = field / (square * long.root(square))
                out += [*state[10:13], *(-pull * x for x in place)]
            return out

        return of

    pace = max(problem.pace, 1.0 / problem.duration)
    sizes = [1.0] * 4 + [pace] * 3 + ([1.0] * 3 + [orbits[0].ellipse.motion] * 3 if orbits else [])
    return Equations(
        [*IDENTITY, *exactly(frame.along(exact.spin)), *passage],
        np.array(sizes),
        rates,
        lambda state: long.product(first, [*long.times(axes, state[:3]), state[3]]),
        np.unique(np.concatenate([np.empty(0), *(load.breaks for load in problem.acting)])),
        min((load.longest_step or np.inf for load in problem.acting), default=np.inf),
    )


def at_start(problem: Problem, vector: Sequence[Fraction]) -> list[Fraction]:
    """Return a vector of space along the principal axes at t = 0."""
    x, y, z, w = problem.exact.attitude
    return problem.exact.frame.along(rotated((-x, -y, -z, w), vector))


def _gravity(load: Gravity, problem: Problem, number: Maker, begin: float) -> Action:
    exact = problem.exact
    lever = [number(exact.mass * k) for k in exact.frame.along(exact.arm)]
    pull = [number(k) for k in at_start(problem, rationals(load.acceleration))]
    return lambda time, turn, omega, place: long.cross(lever, long.rotated(long.back(turn), pull))


def _gradient(load: GravityGradient, problem: Problem, number: Maker, begin: float) -> Action:
    position, moments = rationals(load.position), problem.exact.frame.values
    size = root(inner(position, position))
    toward = [number(k / size) for k in at_start(problem, position)]
    factors = [number(3 * Fraction(load.mu) / size**3 * (moments[k - 1] - moments[k - 2])) for k in range(3)]

    def action(time: Number, turn: Sequence[Number], omega: Sequence[Number], place: Sequence[Number]) -> list[Number]:
        there = long.rotated(long.back(turn), toward)
        return [factors[k] * there[k - 2] * there[k - 1] for k in range(3)]

    return action


def _damping(load: Damping, problem: Problem, number: Maker, begin: float) -> Action:
    coefficient = number(Fraction(-load.coefficient))
    return lambda time, turn, omega, place: [coefficient * o for o in omega]


def _dissipation(load: Dissipation, problem: Problem, number: Maker, begin: float) -> Action:
    return lambda time, turn, omega, place: (0.0, 0.0, 0.0)  # which turns the axes, not the body


def _torque(load: Torque, problem: Problem, number: Maker, begin: float) -> Action:
    if callable(load.torque):
        return _function(load, problem, number)

    def turned(torque: list[Fraction]) -> list[Fraction]:
        if load.frame == "space":
            return at_start(problem, torque)
        if load.frame == "principal":
            torque = [inner(row, torque) for row in principal_rows(problem.scene.body)]
        return problem.exact.frame.along(torque)

    slope, since = None, number(Fraction(0))
    if load.table is None:
        row = turned(rationals(np.asarray(load.torque)))
    else:
        times, torques = load.table.times, load.table.torques
        k = min(int(np.searchsorted(times, begin, side="right")), len(times) - 1) - 1
        row, following = (turned(rationals(torques[j])) for j in (k, k + 1))
        span = Fraction(float(times[k + 1])) - Fraction(float(times[k]))
        slope = [number((b - a) / span) for a, b in zip(row, following, strict=True)]
        since = number(Fraction(float(times[k])))
    value = [number(k) for k in row]

    def action(time: Number, turn: Sequence[Number], omega: Sequence[Number], place: Sequence[Number]) -> list[Number]:
        now = value if slope is None else [v + (time - since) * s for v, s in zip(value, slope, strict=True)]
        return long.rotated(long.back(turn), now) if load.frame == "space" else now

    return action


def _function(load: Torque, problem: Problem, number: Maker) -> Action:
    """Return what a Python function gives, which knows float64 only, as it is at the nearest float64 state."""
    exact, body = problem.exact, problem.scene.body
    first = np.array([float(k) for k in exact.attitude])
    first /= np.linalg.norm(first)
    axes = np.array([[float(k) for k in row] for row in exact.frame.rows])
    along = axes.T @ (body.axes if load.frame == "principal" else np.eye(3))

    def action(time: Number, turn: Sequence[Number], omega: Sequence[Number], place: Sequence[Number]) -> list[Number]:
        rows = np.stack(np.broadcast_arrays(*(plain(each) for each in (time, *turn, *omega))), axis=-1)
        torques = np.empty((*rows.shape[:-1], 3))
        for at in np.ndindex(rows.shape[:-1]):
            t, q, w = float(rows[at][0]), rows[at][1:5], rows[at][5:]
            attitude = quaternion.normalise(quaternion.multiply(first, np.append(axes @ q[:3], q[3])))
            value = load.of_function(t, attitude, axes @ w)
            torques[at] = axes.T @ quaternion.to_body(attitude, value) if load.frame == "space" else along @ value
        return [torques[..., k] for k in range(3)]

    return action


def _field(load: Orbit) -> Fraction:
    """Return μ in 1/s², in units of the length of `_passage`."""
    return Fraction(load.strength) / Fraction(load.ellipse.semi_major_axis) ** 3


def _passage(load: Orbit) -> tuple[list[Long], ...]:
    """Return place (3,) and velocity (3,) at t = 0 in space, in units of the semi-major axis as rounded to float64."""
    unit = Fraction(load.ellipse.semi_major_axis)
    if load.position is not None and load.velocity is not None:
        return tuple(exactly([k / unit for k in rationals(each)]) for each in (load.position, load.velocity))
    e = Fraction(load.eccentricity)
    size = load.size / unit
    (s, c), (sn, cn), (si, ci), (sa, ca) = (
        long.turn_of(Long(angle)) for angle in (load.anomaly, load.node, load.inclination, load.argument)
    )
    shape = Long.of(e)
    distance = Long.of(size * (1 - e * e)) / (1.0 + shape * c)
    pace = long.root(Long.of(_field(load) / (size * (1 - e * e))))
    toward = [cn * ca - sn * sa * ci, sn * ca + cn * sa * ci, sa * si]
    across = [-cn * sa - sn * ca * ci, cn * ca * ci - sn * sa, ca * si]
    place = [distance * (c * x + s * y) for x, y in zip(toward, across, strict=True)]
    return place, [pace * ((shape + c) * y - s * x) for x, y in zip(toward, across, strict=True)]


def _orbit(load: Orbit, problem: Problem, number: Maker, begin: float) -> Action:
    moments = problem.exact.frame.values
    factors = [number(3 * _field(load) * (moments[k - 1] - moments[k - 2])) for k in range(3)]

    def action(time: Number, turn: Sequence[Number], omega: Sequence[Number], place: Sequence[Number]) -> list[Number]:
        there = long.rotated(long.back(turn), place)
        square = long.dot(there, there)
        strength = 1.0 / (square * square * long.root(square))
        return [factors[k] * strength * there[k - 2] * there[k - 1] for k in range(3)]

    return action


_ACTIONS: dict[type[Load], Callable[..., Action]] = {
    Gravity: _gravity,
    GravityGradient: _gradient,
    Damping: _damping,
    Dissipation: _dissipation,
    Torque: _torque,
    Orbit: _orbit,
}
