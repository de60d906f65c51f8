"""The true motion of bodies on an axle, that roll on their rim, and of balls that slide, in quadruple precision.

On an axle, with a the axle and r from it to the centre of mass, turned by θ,

    I θ̈ = N − c θ̇ − k (θ − θᵣ) + a·(r(θ) × m g).

A rolling body touches the plane at ρ from its centre of mass, along body axes whose third is that of the rim:
ρ = h e₃ − R u, u being the direction of the vertical across e₃. With v = ρ × ω and the contact force eliminated,

    (I + M (ρ² − ρρᵀ)) ω̇ = −ω × I ω + M ρ × (ρ̇ × ω + ω × (ρ × ω) + g k),

for any tensor I: a body that is not quite one of revolution rolls too. A ball of radius R that slides touches it at
a = b − R k, b leading to the ball's centre; with u = v + ω × a and F = N (k − μ u/√(u² + u₀²)),

    m v̇ = F + m g,    I ω̇ = I ω × ω + a × F,

all along the principal axes, and N from k · d/dt (v + ω × b) = 0.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import heyoka
import mpmath
import numpy as np
from mpmath import mp, mpf

from . import rigid
from .quad import DIGITS, Flow, Quad, Span, quad
from .rigid import Body, Table, Truth, cross, in_part, product, steiner, to_body, unit, vector


def hinge(scene: Table, body: Body, times: np.ndarray) -> Truth:
    """Return the true motion on an axle."""
    with mpmath.workdps(DIGITS):
        held = scene["constraint"]
        axis = unit(vector(held["axis"]))
        arm = [c - p for c, p in zip(body.center, vector(held.get("point", (0, 0, 0))), strict=True)]
        a = mp.matrix(axis)
        inertia = (a.T * steiner(body, arm) * a)[0]
        start = unit(vector(scene["start"].get("attitude", (0, 0, 0, 1))))
        spin = (
            a.T * in_part(scene["start"]["angular_velocity"], scene["start"].get("frame", "principal"), body, start)
        )[0]
        torque, damping, gravity = mpf(0), mpf(0), [mpf(0)] * 3
        for load in scene.get("load", []):
            if load["kind"] == "gravity":
                each = vector(load.get("acceleration", (0, 0, -9.80665)))
                gravity = [x + y for x, y in zip(gravity, each, strict=True)]
            elif load["kind"] == "damping":
                damping += mpf(load["coefficient"])
            else:
                torque += (a.T * in_part(load["torque"], load.get("frame", "part"), body, start))[0]
        pull = [mpf(0) if body.mass is None else body.mass * x for x in to_body(start, gravity)]
        across = cross(axis, arm)
        # a·(r⊥ × F) and a·((a × r) × F)
        cosine, sine = (sum(x * y for x, y in zip(cross(lever, pull), axis, strict=True)) for lever in (arm, across))
        stiffness, rest = mpf(held.get("stiffness", 0.0)), mpf(held.get("rest_angle", 0.0))
        end = mpf(float(times[-1]))
        if held.get("drive") == "constant_speed":
            inertia, torque, damping, stiffness, cosine, sine = mpf(1), *[mpf(0)] * 5
        sizes = [abs(x) / inertia for x in (torque, stiffness, stiffness * rest, cosine, sine)]
        pace = max([abs(spin), damping / inertia, 1 / end, *map(mp.sqrt, sizes)])
        pace = mpf(2) ** mp.ceil(mp.log(pace, 2))
        constant = torque + stiffness * rest
        figures = [x / inertia / pace**2 for x in (constant, stiffness, cosine, sine)] + [damping / inertia / pace]
        answer = _axle().follow([mpf(0), spin / pace], [Span(end * pace, figures)], times.astype(Quad) * quad(pace))
    half = answer.states[:, 0] / Quad(2)
    turn = np.stack([*(np.sin(half) * quad(x) for x in axis), np.cos(half)], axis=-1)
    q = np.array([_multiply(np.array([quad(x) for x in start]), each) for each in turn])
    return Truth(q, 2.0 * answer.apart)


def _multiply(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    return rigid.quad_product(p[None], q)[0]


@cache
def _axle() -> Flow:
    def equations(par: Any) -> list[tuple[Any, Any]]:
        angle, rate = heyoka.make_vars("angle", "rate")
        pull = par[2] * heyoka.cos(angle) + par[3] * heyoka.sin(angle)
        return [(angle, rate), (rate, par[0] - par[1] * angle + pull - par[4] * rate)]

    return Flow(equations)


def roll(scene: Table, body: Body, times: np.ndarray) -> Truth:
    """Return the true motion of a body that rolls; `axis` of its constraint is that of the rim."""
    with mpmath.workdps(DIGITS):
        held = scene["constraint"]
        third = unit(vector(held["axis"]))
        helper = [mpf(0)] * 3
        helper[min(range(3), key=lambda k: abs(third[k]))] = mpf(1)
        first = unit(cross(helper, third))
        axes = mp.matrix([first, cross(third, first), third]).T
        tensor = axes.T * body.inertia * axes
        start = unit(vector(scene["start"].get("attitude", (0, 0, 0, 1))))
        turn = rigid.quaternion_of(axes)
        omega = axes.T * in_part(
            scene["start"]["angular_velocity"], scene["start"].get("frame", "principal"), body, start
        )
        radius, offset = mpf(held["radius"]), mpf(held.get("offset") or 0.0)
        weight = -mp.fsum(vector(load.get("acceleration", (0, 0, -9.80665)))[2] for load in scene["load"])
        pace = max(mp.norm(omega), mp.sqrt(weight / radius))
        pace = mpf(2) ** mp.ceil(mp.log(pace, 2))
        scale = body.mass * radius**2
        figures = [tensor[i, j] / scale for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))]
        figures += [offset / radius, weight / radius / pace**2]
        state = [*(x / pace for x in omega), *product(start, turn)]
        span = Span(mpf(float(times[-1])) * pace, figures)
        answer = _rim().follow(state, [span], times.astype(Quad) * quad(pace))
        return rigid.in_part_axes(answer, slice(3, 7), turn)


@cache
def _rim() -> Flow:
    def equations(par: Any) -> list[tuple[Any, Any]]:
        w = heyoka.make_vars("x", "y", "z")
        q = heyoka.make_vars("qx", "qy", "qz", "qw")
        k = rigid.expressed_in_body(q, [0.0, 0.0, 1.0])
        moments, products, h, g = [par[0], par[1], par[2]], [par[3], par[4], par[5]], par[6], par[7]
        size = heyoka.sqrt(k[0] * k[0] + k[1] * k[1])
        u = [k[0] / size, k[1] / size]
        fall = cross(k, w)
        stretch = u[0] * fall[0] + u[1] * fall[1]
        rho = [-u[0], -u[1], h]
        change = [-(fall[i] - u[i] * stretch) / size for i in range(2)]
        slide = [change[0], change[1]]
        spun = cross(rho, w)
        turned = cross(w, spun)
        moved = [slide[1] * w[2], -slide[0] * w[2], slide[0] * w[1] - slide[1] * w[0]]  # ρ̇ × ω, ρ̇₃ = 0
        push = cross(rho, [a + b + g * c for a, b, c in zip(moved, turned, k, strict=True)])
        momentum = [moments[i] * w[i] + products[i - 1] * w[i - 2] + products[i - 2] * w[i - 1] for i in range(3)]
        right = [a + b for a, b in zip(push, cross(momentum, w), strict=True)]
        square = u[0] * u[0] + u[1] * u[1] + h * h
        diagonal = [moments[i] + square - rho[i] * rho[i] for i in range(3)]
        mixed = [products[i] - rho[i - 2] * rho[i - 1] for i in range(3)]
        (a, b, c), (d, e, f) = diagonal, mixed  # [[a, f, e], [f, b, d], [e, d, c]]
        adjugate = [
            [b * c - d * d, e * d - f * c, f * d - e * b],
            [e * d - f * c, a * c - e * e, e * f - a * d],
            [f * d - e * b, e * f - a * d, a * b - f * f],
        ]
        determinant = a * adjugate[0][0] + f * adjugate[0][1] + e * adjugate[0][2]
        rate = [
            sum((x * y for x, y in zip(row[1:], right[1:], strict=True)), row[0] * right[0]) / determinant
            for row in adjugate
        ]
        return [*zip(w, rate, strict=True), *rigid.attitude_rates(q, w)]

    return Flow(equations)


def slide(scene: Table, body: Body, times: np.ndarray) -> Truth:
    """Return the true motion of a ball that slides on the plane z = 0."""
    with mpmath.workdps(DIGITS):
        held = scene["constraint"]
        moments, axes = rigid.principal(body.inertia)
        start = unit(vector(scene["start"].get("attitude", (0, 0, 0, 1))))
        turn = rigid.quaternion_of(axes)
        attitude = product(start, turn)
        omega = axes.T * in_part(
            scene["start"]["angular_velocity"], scene["start"].get("frame", "principal"), body, start
        )
        radius, slip = mpf(held["radius"]), mpf(held.get("slip_speed", 0.01))
        center = [p - c for p, c in zip(vector(held.get("point", (0, 0, 0))), body.center, strict=True)]
        arm = [x / radius for x in axes.T * mp.matrix(center)]
        gravity = [mpf(0)] * 3
        for load in scene["load"]:
            each = vector(load.get("acceleration", (0, 0, -9.80665)))
            gravity = [x + y for x, y in zip(gravity, each, strict=True)]
        pace = max(mp.norm(omega), mp.sqrt(mp.norm(gravity) / radius))
        pace = mpf(2) ** mp.ceil(mp.log(pace, 2))
        spin, up = [x / pace for x in omega], to_body(attitude, [mpf(0), mpf(0), mpf(1)])
        speed = [x / radius / pace for x in vector(scene["start"].get("velocity", (0, 0, 0)))]
        speed[2] = -sum(x * y for x, y in zip(up, cross(spin, arm), strict=True))
        figures = [i / body.mass / radius**2 for i in moments] + arm
        figures += [x / radius / pace**2 for x in gravity] + [mpf(held["friction"]), slip / radius / pace]
        state = [*spin, *attitude, *to_body(attitude, speed)]
        span = Span(mpf(float(times[-1])) * pace, figures)
        answer = _ball().follow(state, [span], times.astype(Quad) * quad(pace))
        return rigid.in_part_axes(answer, slice(3, 7), turn)


@cache
def _ball() -> Flow:
    def equations(par: Any) -> list[tuple[Any, Any]]:
        w, q = heyoka.make_vars("x", "y", "z"), heyoka.make_vars("qx", "qy", "qz", "qw")
        v = heyoka.make_vars("vx", "vy", "vz")
        k = rigid.expressed_in_body(q, [0.0, 0.0, 1.0])
        moments, b, friction, slip = [par[0], par[1], par[2]], [par[3], par[4], par[5]], par[9], par[10]
        pull = rigid.expressed_in_body(q, [par[6], par[7], par[8]])
        a = [x - y for x, y in zip(b, k, strict=True)]
        u = [x + y for x, y in zip(v, cross(w, a), strict=True)]
        drag = friction / heyoka.sqrt(_dot(u, u) + slip * slip)
        push = [x - drag * y for x, y in zip(k, u, strict=True)]  # F/N
        gyroscopic = cross([i * x for i, x in zip(moments, w, strict=True)], w)
        lever, turned = cross(b, k), [x / i for x, i in zip(cross(a, push), moments, strict=True)]
        steady = [x / i for x, i in zip(gyroscopic, moments, strict=True)]
        inward = _dot(k, cross(w, cross(w, b)))
        normal = (-par[8] - _dot(lever, steady) - inward) / (1.0 + _dot(lever, turned))
        rate = [x + normal * y for x, y in zip(steady, turned, strict=True)]
        fall = [normal * x + y - z for x, y, z in zip(push, pull, cross(w, v), strict=True)]
        return [*zip(w, rate, strict=True), *rigid.attitude_rates(q, w), *zip(v, fall, strict=True)]

    return Flow(equations)


def _dot(a: Any, b: Any) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
