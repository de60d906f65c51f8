"""Equations of bodies on an axle, of bodies that roll on a rim and of balls that slide, with exact figures.

The attitude P is that of the principal axes to where they are at t = 0, as for rigid bodies. The plane's normal is n.

A body that rolls touches the plane at ρ = d − R u from its centre of mass, u being the direction of n across the axis e
of the rim, and d = h e; with v = ρ × ω and the force eliminated,

    (I + M (ρ² − ρρᵀ)) ω̇ = I ω × ω + M ρ × (ρ̇ × ω + ω × (ρ × ω) + g n).

A ball that slides touches it at a = b − R n, with F = N (n − μ u/√(u² + u₀²)), u = v + ω × a: see
`inertia.dynamics.models.sliding.equations`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.models.hinged.model import figures_of
from inertia.dynamics.models.model import Candidate, Problem
from inertia.dynamics.models.rational import dot as inner
from inertia.dynamics.models.rational import rationals, root
from inertia.dynamics.reference import long
from inertia.dynamics.reference.collocation import Equations, Maker, Rates
from inertia.dynamics.reference.long import Long, Number, exactly
from inertia.dynamics.reference.rigid import IDENTITY, at_start
from inertia.dynamics.scene.sections import SLIP_SPEED

_ZERO = Fraction(0)


def hinged_equations(problem: Problem) -> Equations:
    """Return the equations of sine and cosine of half the angle, the angle in rad, and its rate."""
    figures = figures_of(problem)
    axis = exactly(_unit(problem.scene.constraint.typed_axis))
    first = exactly(problem.exact.attitude)

    def rates(number: Maker, begin: float) -> Rates:
        at = {name: number(value / figures["inertia"]) for name, value in figures.items()}

        def of(time: Number, state: Sequence[Number]) -> Sequence[Number]:
            sine, cosine, angle, rate = state
            pull = at["cosine"] * (cosine * cosine - sine * sine) + at["sine"] * (2.0 * sine * cosine)
            spring = at["torque"] - at["stiffness"] * angle - at["damping"] * rate
            return [0.5 * rate * cosine, -0.5 * rate * sine, rate, spring + pull]

        return of

    pace = max(problem.pace, 1.0 / problem.duration)
    return Equations(
        exactly([_ZERO, Fraction(1), _ZERO, figures["spin"]]),
        np.array([1.0, 1.0, 1.0, pace]),
        rates,
        lambda state: long.product(first, [*(k * state[0] for k in axis), state[1]]),
        np.empty(0),
    )


def rolling_equations(candidate: Candidate) -> Equations:
    """Return the equations of P (4,) and ω (3,) of a body on its rim, of any tensor."""
    problem = candidate.problem
    frame, mass = problem.exact.frame, problem.exact.mass
    held, scene = problem.scene.constraint, problem.scene
    if held.axis is not None:
        rim = frame.along(_unit(held.typed_axis))
    else:
        nearest = int(np.argmax(np.abs(problem.axes.T @ candidate.axes[:, 2])))
        rim = [Fraction(int(k == nearest)) for k in range(3)]
    radius, offset = Fraction(held.radius or 0.0), Fraction(held.offset or 0.0)
    gravity = rationals(scene.gravity)
    weight = root(inner(gravity, gravity))
    up = at_start(problem, [_ZERO, _ZERO, Fraction(1)])

    def rates(number: Maker, begin: float) -> Rates:
        e, d, n = ([number(k) for k in row] for row in (rim, [offset * k for k in rim], up))
        r, g, one = number(radius), number(weight), number(Fraction(1))
        moments = [number(value / mass) for value in frame.values]

        def of(time: Number, state: Sequence[Number]) -> Sequence[Number]:
            turn, omega = state[:4], state[4:]
            k = long.rotated(long.back(turn), n)
            tipping = long.cross(k, omega)
            lean, leaning = long.dot(k, e), long.dot(tipping, e)
            across = [x - lean * y for x, y in zip(k, e, strict=True)]
            size = long.root(long.dot(across, across))
            u = [x / size for x in across]
            side = [x - leaning * y for x, y in zip(tipping, e, strict=True)]
            along = long.dot(side, u)
            moving = [-r * (x - along * y) / size for x, y in zip(side, u, strict=True)]
            rho = [x - r * y for x, y in zip(d, u, strict=True)]
            pushed = long.cross(omega, long.cross(rho, omega))
            pushed = [x + y + g * z for x, y, z in zip(long.cross(moving, omega), pushed, k, strict=True)]
            carried = long.cross([i * o for i, o in zip(moments, omega, strict=True)], omega)
            torque = [x + y for x, y in zip(carried, long.cross(rho, pushed), strict=True)]
            tensor = long.shifted(one, rho)
            for j in range(3):
                tensor[j][j] = tensor[j][j] + moments[j]
            return [*long.spun(turn, omega), *long.solution(tensor, torque)]

        return of

    return _on_plane(problem, [], [], rates)


def sliding_equations(problem: Problem) -> Equations:
    """Return the equations of P (4,), ω (3,) and the velocity (3,) of the centre of mass, body axes, of a ball."""
    exact, held, start = problem.exact, problem.scene.constraint, problem.scene.start
    frame = exact.frame
    normal = at_start(problem, _unit(held.typed_normal))
    point = rationals(held.fixed_point)
    if problem.scene.body.properties is None:
        center = rationals(problem.scene.body.center_of_mass)
    else:
        here = problem.scene.body.properties.moments_about([0.0, 0.0, 0.0])
        center = [k / here.zeroth for k in here.first]
    arm = frame.along([p - c for p, c in zip(point, center, strict=True)])
    pull = at_start(problem, rationals(problem.scene.gravity))
    spin = frame.along(exact.spin)
    velocity = at_start(problem, rationals(np.zeros(3) if start.velocity is None else start.velocity))
    # The velocity along the normal is what keeps the ball on the plane: n · (v + ω × b) = 0.
    swing = [spin[k - 2] * arm[k - 1] - spin[k - 1] * arm[k - 2] for k in range(3)]
    excess = inner(normal, velocity) + inner(normal, swing)
    velocity = [v - excess * n for v, n in zip(velocity, normal, strict=True)]
    slow = Fraction(SLIP_SPEED if held.slip_speed is None else held.slip_speed)
    radius, friction = Fraction(held.radius or 0.0), Fraction(held.friction or 0.0)

    def rates(number: Maker, begin: float) -> Rates:
        n, b, weight = ([number(k) for k in row] for row in (normal, arm, pull))
        r, mu, square = number(radius), number(friction), number(slow * slow)
        moments = [number(value / exact.mass) for value in frame.values]

        def of(time: Number, state: Sequence[Number]) -> Sequence[Number]:
            turn, omega, v = state[:4], state[4:7], state[7:]
            k, g = (long.rotated(long.back(turn), each) for each in (n, weight))
            a = [x - r * y for x, y in zip(b, k, strict=True)]
            slip = [x + y for x, y in zip(v, long.cross(omega, a), strict=True)]
            lever = [x / i for x, i in zip(long.cross(b, k), moments, strict=True)]
            carried = long.cross([i * o for i, o in zip(moments, omega, strict=True)], omega)
            pressed = -long.dot(g, k) - long.dot(lever, carried)
            pressed = pressed - long.dot(k, long.cross(omega, long.cross(omega, b)))
            drag = mu / long.root(long.dot(slip, slip) + square)
            drag = long.where(long.plain(pressed) >= 0, drag, 0.0)  # a plane that pulls does so without friction
            push = [x - drag * y for x, y in zip(k, slip, strict=True)]
            turned = long.cross(a, push)
            force = pressed / (1.0 + long.dot(lever, turned))
            spun = [(x + force * y) / i for x, y, i in zip(carried, turned, moments, strict=True)]
            fall = [force * x + y - z for x, y, z in zip(push, g, long.cross(omega, v), strict=True)]
            return [*long.spun(turn, omega), *spun, *fall]

        return of

    size = float(held.radius or 0.0) * problem.pace
    return _on_plane(problem, exactly(velocity), [size] * 3, rates)


def _on_plane(
    problem: Problem, velocity: list[Long], sizes: list[float], rates: Callable[[Maker, float], Rates]
) -> Equations:
    first, axes = exactly(problem.exact.attitude), [exactly(row) for row in problem.exact.frame.rows]
    return Equations(
        [*IDENTITY, *exactly(problem.exact.frame.along(problem.exact.spin)), *velocity],
        np.array([1.0] * 4 + [problem.pace] * 3 + sizes),
        rates,
        lambda state: long.product(first, [*long.times(axes, state[:3]), state[3]]),
        np.empty(0),
    )


def _unit(vector: Float) -> list[Fraction]:
    typed = rationals(vector)
    size = root(inner(typed, typed))
    return [k / size for k in typed]
