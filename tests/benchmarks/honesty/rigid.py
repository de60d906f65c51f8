"""The true motion of a rigid body under the loads of a scene, which is taken at its word: every float64 as exact.

Tensors are turned to their axes, shifted by Steiner's theorem and attitudes brought to unit length with 50 digits. Then

    I ω̇ = (I ω) × Ω + N(t) + N_s(t) + m c × γ g + (3 μ/r³) r̂ × I r̂ − d ω + f(t, q, ω),   Ω = ω + κ I⁻² (I ω × ω),

with vectors that are fixed in space carried along, v̇ = v × Ω, and q̇ = ½ q Ω, is followed along the principal axes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import heyoka
import mpmath
import numpy as np
from mpmath import mp, mpf
from tests.dynamics.models.free.free_oracle import free_top

from .quad import DIGITS, Answer, Flow, Quad, Span, quad

Table = Mapping[str, Any]
Vector = list[Any]


@dataclass(frozen=True)
class Body:
    """What moves, with 50 digits: mass or None, centre of mass, tensor about it (3, 3), part axes.

    `axes` are the columns that the frame "principal" stands for.
    """

    mass: Any
    center: Vector
    inertia: Any
    axes: Any


@dataclass(frozen=True)
class Truth:
    """Attitudes (n, 4) of the part axes in quadruple precision, and how well (n,) they are known, rad."""

    attitude: np.ndarray
    error: np.ndarray

    def off(self, attitude: np.ndarray) -> np.ndarray:
        """Return the angles (n,) in rad from float64 attitudes (n, 4)."""
        return np.array([_angle(p, q) for p, q in zip(attitude, self.attitude, strict=True)])


def body_of(table: Table, axes: np.ndarray) -> Body:
    """Take the section [body] of a scene; `axes` (3, 3) are the package's principal axes, for their signs only."""
    center = vector(table.get("center_of_mass", (0, 0, 0)))
    mass = None if table.get("mass") is None else mpf(table["mass"])
    if "principal_moments" in table:
        return Body(mass, center, mp.diag(vector(table["principal_moments"])), mp.eye(3))
    inertia = mp.matrix([vector(row) for row in table["inertia"]])
    return Body(mass, center, inertia, principal(inertia, axes)[1])


def principal(inertia: Any, signs: np.ndarray | None = None) -> tuple[Vector, Any]:
    """Return principal moments, ascending, and right-handed axes in columns, with the signs of (3, 3) where given."""
    off = [inertia[i, j] for i, j in ((0, 1), (0, 2), (1, 2))]
    if not any(off) and signs is None:
        return [inertia[k, k] for k in range(3)], mp.eye(3)
    values, columns = mp.eigsy(inertia)
    if signs is not None:
        for k in range(3):
            if sum(columns[i, k] * mpf(float(signs[i, k])) for i in range(3)) < 0:
                columns[:, k] = -columns[:, k]
    elif mp.det(columns) < 0:
        columns[:, 2] = -columns[:, 2]
    return list(values), columns


def follow(scene: Table, body: Body, times: np.ndarray, function: Table | None = None) -> Truth:
    """Return the true motion of a scene at `times` (n,); `function` describes a torque that a Python function gives."""
    with mpmath.workdps(DIGITS):
        return _follow(scene, body, times, function or {})


def _follow(scene: Table, body: Body, times: np.ndarray, function: Table) -> Truth:
    held = scene.get("constraint", {})
    arm = [mpf(0)] * 3
    if held.get("kind") == "fixed_point":
        arm = [c - p for c, p in zip(body.center, vector(held.get("point", (0, 0, 0))), strict=True)]
    moments, axes = principal(steiner(body, arm))
    turn = quaternion_of(axes)
    attitude = unit(vector(scene["start"].get("attitude", (0, 0, 0, 1))))
    omega = axes.T * in_part(
        scene["start"]["angular_velocity"], scene["start"].get("frame", "principal"), body, attitude
    )
    start = product(attitude, turn)
    loads = _Loads(scene.get("load", []), function, body, axes, [*(axes.T * mp.matrix(arm))])
    end = mpf(float(times[-1]))
    pace = mpf(2) ** mp.ceil(mp.log(loads.pace(moments, omega, end), 2))
    state = [*(x / pace for x in omega), *start, *loads.orbit(pace)]
    cuts = loads.cuts(end)
    spans = [Span(t * pace, loads.parameters(moments, pace, t0, t)) for t0, t in pairwise(cuts)]
    answer = flow(loads.kinds).follow(state, spans, np.asarray(times).astype(Quad) * quad(pace))
    return in_part_axes(answer, slice(3, 7), turn)


def closed_form(scene: Table, body: Body, times: np.ndarray) -> Truth:
    """Return the true motion of a free body over any time, by the closed form in Legendre's integrals at 60 digits."""
    with mpmath.workdps(60):
        moments, axes = principal(body.inertia)
        start = unit(vector(scene["start"].get("attitude", (0, 0, 0, 1))))
        omega = axes.T * in_part(
            scene["start"]["angular_velocity"], scene["start"].get("frame", "principal"), body, start
        )
        frame = product(start, quaternion_of(axes))
        if len(set(moments)) < 3 or sum(1 for x in omega if x) < 2:
            turned = [_precession(moments, list(omega), t) for t in times]
        else:
            turned = [quaternion_of(each) for each, _ in free_top(moments, list(omega), times)]
        back = [-x for x in quaternion_of(axes)[:3]] + [quaternion_of(axes)[3]]
        rows = [[quad(x) for x in product(product(frame, each), back)] for each in turned]
    return Truth(np.array(rows), np.full(len(times), 1e-30))


def _precession(moments: Vector, omega: Vector, time: float) -> Vector:
    """Return the turn of a free body with two equal moments, or about a principal axis, after a time."""
    pair = (
        next(((k + 1) % 3, (k + 2) % 3) for k in (2, 0, 1) if moments[(k + 1) % 3] == moments[(k + 2) % 3])
        if (len(set(moments)) < 3)
        else (0, 1)
    )
    third = 3 - sum(pair)
    if len(set(moments)) == 3:
        return _about(omega, mpf(float(time)))
    across, along = moments[pair[0]], moments[third]
    precession = [moments[k] * omega[k] / across for k in range(3)]
    own = [mpf(0)] * 3
    own[third] = omega[third] * (1 - along / across)
    return product(_about(precession, mpf(float(time))), _about(own, mpf(float(time))))


def _about(rate: Vector, time: Any) -> Vector:
    """Return the turn by rate × time."""
    size = mp.norm(rate)
    if not size:
        return [mpf(0)] * 3 + [mpf(1)]
    half = size * time / 2
    return [mp.sin(half) * x / size for x in rate] + [mp.cos(half)]


def in_part_axes(answer: Answer, columns: slice, turn: Vector) -> Truth:
    """Turn quaternions of other axes to those of the part; `turn` takes those axes to the part's."""
    q = answer.states[:, columns]
    x, y, z, w = (quad(a) for a in turn)
    back = np.array([-x, -y, -z, w])
    return Truth(quad_product(q, back), 4.0 * answer.apart)


def quad_product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the product of quaternions (n, 4) and (4,) in quadruple precision."""
    a, b, c, d = p.T
    x, y, z, w = q
    rows = [d * x + a * w + b * z - c * y, d * y - a * z + b * w + c * x, d * z + a * y - b * x + c * w]
    return np.stack([*rows, d * w - a * x - b * y - c * z], axis=-1)


def _angle(p: np.ndarray, q: np.ndarray) -> float:
    p = p.astype(Quad)
    p = p / np.sqrt(p @ p)
    q = q / np.sqrt(q @ q)
    apart = q - p if p @ q > 0 else q + p
    half = min(float(np.sqrt(apart @ apart)) / 2.0, 1.0)
    return 4.0 * float(np.arcsin(half))


@cache
def flow(kinds: tuple[str, ...]) -> Flow:
    """Compile the equations of a body under loads of some kinds."""
    return Flow(lambda par: _equations(kinds, par))


def _equations(kinds: tuple[str, ...], par: Any) -> list[tuple[Any, Any]]:
    w = heyoka.make_vars("x", "y", "z")
    q = heyoka.make_vars("qx", "qy", "qz", "qw")
    at, t = _Counter(), heyoka.time
    if "dissipation" in kinds:
        moments, inverse, kappa = ([par[at()] for _ in range(3)] for _ in range(3))
        gyro = cross([i * o for i, o in zip(moments, w, strict=True)], w)
        turn = [o + k * g for o, k, g in zip(w, kappa, gyro, strict=True)]
        rate = [
            i * n for i, n in zip(inverse, cross([i * o for i, o in zip(moments, w, strict=True)], turn), strict=True)
        ]
    else:
        turn = w
        rate = [par[at()] * w[(k + 1) % 3] * w[(k + 2) % 3] for k in range(3)]
    if kinds:
        rate = [r + par[at()] + par[at()] * t - par[at()] * o for r, o in zip(rate, w, strict=True)]
    if "gravity" in kinds:
        g = expressed_in_body(q, [par[at()] for _ in range(3)])
        rate = [r + par[at()] * g[k - 1] - par[at()] * g[k - 2] for k, r in enumerate(rate)]
    if "gradient" in kinds:
        g = expressed_in_body(q, [par[at()] for _ in range(3)])
        rate = [r + par[at()] * (g[k - 2] * g[k - 1]) for k, r in enumerate(rate)]
    orbit = []
    if "orbit" in kinds:
        place, speed = heyoka.make_vars("px", "py", "pz"), heyoka.make_vars("vx", "vy", "vz")
        square = place[0] * place[0] + place[1] * place[1] + place[2] * place[2]
        pull = par[at()] * square**-1.5
        g = expressed_in_body(q, place)
        rate = [r + par[at()] * pull / square * (g[k - 2] * g[k - 1]) for k, r in enumerate(rate)]
        orbit = [*zip(place, speed, strict=True), *((v, -pull * x) for v, x in zip(speed, place, strict=True))]
    if "space" in kinds:
        values, slopes = ([par[at()] for _ in range(3)] for _ in range(2))
        n = expressed_in_body(q, [v + s * t for v, s in zip(values, slopes, strict=True)])
        rate = [r + par[at()] * x for r, x in zip(rate, n, strict=True)]
    if "sine" in kinds:
        wave = heyoka.sin(par[at()] * t + par[at()])
        rate = [r + par[at()] * wave for r in rate]
    if "gauss" in kinds:
        z = (t - par[at()]) * par[at()]
        bell = heyoka.exp(-z * z)
        rate = [r + par[at()] * bell for r in rate]
    if "drag" in kinds:
        speed = heyoka.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
        rate = [r - par[at()] * speed * o for r, o in zip(rate, w, strict=True)]
    if "servo" in kinds:
        rate = [r - par[at()] * x * q[3] for r, x in zip(rate, q[:3], strict=True)]
    return [*zip(w, rate, strict=True), *attitude_rates(q, turn), *orbit]


def attitude_rates(q: Sequence[Any], turn: Sequence[Any]) -> list[tuple[Any, Any]]:
    """Return q̇ = ½ q Ω, as equations."""
    (a, b, c, d), (x, y, z) = q, turn
    turned = [d * x + b * z - c * y, d * y + c * x - a * z, d * z + a * y - b * x, -(a * x + b * y + c * z)]
    return [(u, 0.5 * v) for u, v in zip(q, turned, strict=True)]


def expressed_in_body(q: Sequence[Any], v: Sequence[Any]) -> list[Any]:
    """Return Rᵀ v of a unit quaternion, as expressions."""
    a, b, c, d = q
    rows = [
        [1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b + c * d), 2.0 * (a * c - b * d)],
        [2.0 * (a * b - c * d), 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c + a * d)],
        [2.0 * (a * c + b * d), 2.0 * (b * c - a * d), 1.0 - 2.0 * (a * a + b * b)],
    ]
    return [sum((x * y for x, y in zip(row[1:], v[1:], strict=True)), row[0] * v[0]) for row in rows]


class _Counter:
    """Numbers the parameters in the order in which they are asked for."""

    def __init__(self) -> None:
        self.next = 0

    def __call__(self) -> int:
        self.next += 1
        return self.next - 1


class _Loads:
    """The loads of a scene along the principal axes about the reference point."""

    def __init__(self, loads: Sequence[Table], function: Table, body: Body, axes: Any, arm: Vector) -> None:
        self.function, self.first_moment = function, [mpf(0) if body.mass is None else body.mass * x for x in arm]
        self.gravity, self.damping, self.kappa = [mpf(0)] * 3, mpf(0), mpf(0)
        self.gradient: tuple[Any, Vector] = mpf(0), [mpf(0)] * 3
        self.kepler: tuple[Any, Vector, Vector] | None = None  # μ, place, velocity
        self.tables: list[tuple[bool, list[tuple[Any, Vector]]]] = []  # in space?, rows of time and torque
        kinds = {name for name in ("sine", "gauss", "drag", "servo") if name in function}

        def turned(torque: Any, frame: str) -> Vector:
            if frame == "space":
                return vector(torque)
            return [*(axes.T * (body.axes if frame == "principal" else mp.eye(3)) * mp.matrix(vector(torque)))]

        for load in loads:
            if load["kind"] == "gravity":
                each = vector(load.get("acceleration", (0, 0, -9.80665)))
                self.gravity = [a + b for a, b in zip(self.gravity, each, strict=True)]
            elif load["kind"] == "damping":
                self.damping += mpf(load["coefficient"])
            elif load["kind"] == "dissipation":
                self.kappa += mpf(load["rate"])
                kinds.add("dissipation")
            elif load["kind"] == "gravity_gradient":
                place = vector(load["position"])
                size = mp.norm(place)
                self.gradient = 3 * mpf(load["mu"]) / size**3, [x / size for x in place]
                kinds.add("gradient")
            elif load["kind"] == "orbit":
                self.kepler = kepler(load)
                kinds.add("orbit")
            else:
                frame = load.get("frame", "part")
                rows = load["table"] if "table" in load else [[0.0, *load["torque"]]]
                self.tables.append((frame == "space", [(mpf(row[0]), turned(row[1:], frame)) for row in rows]))
        if any(self.gravity) and any(self.first_moment):
            kinds.add("gravity")
        if "pulse" in function:
            (t0, t1), torque = (mpf(t) for t in function["pulse"]["times"]), turned(function["pulse"]["torque"], "part")
            none = [mpf(0)] * 3
            self.tables.append((False, [(mpf(0), none), (t0, none), (t0, torque), (t1, torque), (t1, none)]))
        self.along = {n: turned(function[n]["torque"], "part") for n in ("sine", "gauss") if n in function}
        if any(in_space for in_space, _ in self.tables):
            kinds.add("space")
        if kinds or self.damping or self.tables:
            kinds.add("bodily")
        self.kinds = tuple(sorted(kinds))

    def pace(self, moments: Vector, omega: Any, end: Any) -> Any:
        """Return a rate in rad/s at which things go."""
        least = min(moments)
        sizes = [mp.norm(v) for _, rows in self.tables for _, v in rows]
        sizes += [mp.norm(v) for v in self.along.values()]
        sizes += [mp.norm(self.gravity) * mp.norm(self.first_moment), self.gradient[0] * max(moments)]
        sizes += [sum(map(mpf, self.function.get("servo", {}).get("gains", [])))]
        if self.kepler is not None:
            sizes.append(self.kepler[0] / mp.norm(self.kepler[1]) ** 3 * least)
        return max([mp.norm(omega), self.damping / least, 1 / end, *(mp.sqrt(s / least) for s in sizes)])

    def orbit(self, pace: Any) -> Vector:
        """Return place and velocity on the orbit, in units of the place at the start."""
        if self.kepler is None:
            return []
        _, place, speed = self.kepler
        size = mp.norm(place)
        return [*(x / size for x in place), *(v / size / pace for v in speed)]

    def cuts(self, end: Any) -> Vector:
        """Return the instants, 0 and `end` among them, between which every table is a line."""
        inner = {t for _, rows in self.tables for t, _ in rows if 0 < t < end}
        if "gauss" in self.function:  # so that no step passes over the bell
            middle, width = mpf(self.function["gauss"]["time"]), mpf(self.function["gauss"]["width"])
            inner |= {t for k in (-12, -6, -3, -1, 0, 1, 3, 6, 12) if 0 < (t := middle + k * width) < end}
        return [mpf(0), *sorted(inner), end]

    def parameters(self, moments: Vector, pace: Any, begin: Any, end: Any) -> Vector:
        """Return the parameters of `_equations` in the span from `begin` to `end`, with time in units of 1/pace."""
        inverse, square = [1 / i for i in moments], pace**2
        if "dissipation" in self.kinds:
            largest = max(moments)
            out = [*(i / largest for i in moments), *(largest * i for i in inverse)]
            out += [self.kappa * i**2 * largest * pace for i in inverse]
        else:
            out = [(moments[(k + 1) % 3] - moments[(k + 2) % 3]) * inverse[k] for k in range(3)]
        if not self.kinds:
            return out
        bodily, spatial = (self._line(in_space, (begin + end) / 2) for in_space in (False, True))
        for value, slope, i in zip(*bodily, inverse, strict=True):
            out += [value * i / square, slope * i / (square * pace), self.damping * i / pace]
        if "gravity" in self.kinds:
            out += self.gravity
            for k in range(3):
                out += [self.first_moment[(k + d) % 3] * inverse[k] / square for d in (1, 2)]
        if "gradient" in self.kinds:
            strength, place = self.gradient
            out += place
            for k in range(3):
                out += [strength * (moments[(k + 2) % 3] - moments[(k + 1) % 3]) * inverse[k] / square]
        if self.kepler is not None:
            out.append(self.kepler[0] / mp.norm(self.kepler[1]) ** 3 / square)
            out += [3 * (moments[(k + 2) % 3] - moments[(k + 1) % 3]) * inverse[k] for k in range(3)]
        if "space" in self.kinds:
            out += [*spatial[0], *(x / pace for x in spatial[1]), *(i / square for i in inverse)]
        if "sine" in self.kinds:
            out += [mpf(self.function["sine"]["rate"]) / pace, mpf(self.function["sine"]["phase"])]
            out += [n * i / square for n, i in zip(self.along["sine"], inverse, strict=True)]
        if "gauss" in self.kinds:
            out += [mpf(self.function["gauss"]["time"]) * pace, 1 / (mpf(self.function["gauss"]["width"]) * pace)]
            out += [n * i / square for n, i in zip(self.along["gauss"], inverse, strict=True)]
        if "drag" in self.kinds:
            out += [mpf(self.function["drag"]["factor"]) * i for i in inverse]
        if "servo" in self.kinds:
            gains = vector(self.function["servo"]["gains"])
            out += [n * i / square for n, i in zip(gains, inverse, strict=True)]
        return out

    def _line(self, in_space: bool, middle: Any) -> tuple[Vector, Vector]:
        """Return value at t = 0 and slope of the sum of all tables along the body, or in space, around an instant."""
        value, slope = [mpf(0)] * 3, [mpf(0)] * 3
        for kind, rows in self.tables:
            if kind != in_space:
                continue
            row = max(k for k, (t, _) in enumerate(rows) if t <= middle)
            t, here = rows[row]
            rise = [mpf(0)] * 3
            if row + 1 < len(rows):
                rise = [(b - a) / (rows[row + 1][0] - t) for a, b in zip(here, rows[row + 1][1], strict=True)]
            slope = [a + b for a, b in zip(slope, rise, strict=True)]
            value = [v + a - b * t for v, a, b in zip(value, here, rise, strict=True)]
        return value, slope


def kepler(load: Table) -> tuple[Any, Vector, Vector]:
    """Return μ, place and velocity at t = 0 of an orbit of elements, or as they are."""
    mu = mpf(load["mu"])
    if "position" in load:
        return mu, vector(load["position"]), vector(load["velocity"])
    names = ("eccentricity", "inclination", "node", "argument", "anomaly")
    e, inclination, node, argument, anomaly = (mpf(load.get(name, 0.0)) for name in names)
    parameter = mpf(load["semi_major_axis"]) * (1 - e * e)
    angle, distance, pace = argument + anomaly, parameter / (1 + e * mp.cos(anomaly)), mp.sqrt(mu / parameter)
    along = [mp.cos(node), mp.sin(node), mpf(0)]
    across = [-mp.sin(node) * mp.cos(inclination), mp.cos(node) * mp.cos(inclination), mp.sin(inclination)]

    def turned(x: Any, y: Any) -> Vector:
        return [x * a + y * b for a, b in zip(along, across, strict=True)]

    place = turned(distance * mp.cos(angle), distance * mp.sin(angle))
    return (
        mu,
        place,
        turned(-pace * (mp.sin(angle) + e * mp.sin(argument)), pace * (mp.cos(angle) + e * mp.cos(argument))),
    )


def steiner(body: Body, arm: Vector) -> Any:
    """Return the tensor about the point from which the centre of mass is at `arm`."""
    if not any(arm):
        return body.inertia
    square = mp.fsum(x * x for x in arm)
    shift = mp.matrix(3, 3)
    for i in range(3):
        for j in range(3):
            shift[i, j] = body.mass * ((square if i == j else 0) - arm[i] * arm[j])
    return body.inertia + shift


def in_part(components: Any, frame: str, body: Body, attitude: Vector) -> Any:
    """Return a vector that is given in one of the frames of a scene along the part axes, as a column."""
    v = vector(components)
    if frame == "space":
        return mp.matrix(to_body(attitude, v))
    return (body.axes if frame == "principal" else mp.eye(3)) * mp.matrix(v)


def vector(values: Any) -> Vector:
    """Return numbers as mpf, exactly."""
    return [x if isinstance(x, mpf) else mpf(float(x)) for x in values]


def unit(q: Vector) -> Vector:
    """Return a quaternion of unit length."""
    size = mp.norm(q)
    return [x / size for x in q]


def product(p: Vector, q: Vector) -> Vector:
    """Return the product of two quaternions, scalar last."""
    a, b, c, d = p
    x, y, z, w = q
    return [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]


def to_body(q: Vector, v: Vector) -> Vector:
    """Return Rᵀ v of a unit quaternion."""
    back = [-q[0], -q[1], -q[2], q[3]]
    return product(product(back, [*v, mpf(0)]), q)[:3]


def cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """Return a × b."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def quaternion_of(matrix: Any) -> Vector:
    """Return the quaternion of a rotation matrix, by its largest component (Shepperd)."""
    trace = matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
    sizes = [1 + 2 * matrix[k, k] - trace for k in range(3)] + [1 + trace]
    big = max(range(4), key=lambda k: sizes[k])
    if big == 3:
        q = [matrix[(k + 2) % 3, (k + 1) % 3] - matrix[(k + 1) % 3, (k + 2) % 3] for k in range(3)] + [sizes[3]]
    else:
        i, j, k = big, (big + 1) % 3, (big + 2) % 3
        q = [mpf(0)] * 4
        q[i], q[j], q[k] = sizes[i], matrix[i, j] + matrix[j, i], matrix[i, k] + matrix[k, i]
        q[3] = matrix[k, j] - matrix[j, k]
    return unit(q)
