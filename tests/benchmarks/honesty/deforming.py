"""The true motion of a body that changes its shape, in 80-bit floats: q̇ = ½ q I⁻¹(t) (Rᵀ L − h(t)), L fixed in space.

Poses follow from products of exponentials, the tensor and the internal momentum from sums over the parts, and the
attitude from Gauss collocation between all keyframes and samples, with steps of one length and of half of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np

from .quad import Quad, TooLongError
from .rigid import Table, Truth

Long = np.longdouble
STAGES = 12
PHASE = 0.35  # rad in the longer steps
LEAST = 4  # of these between keyframes: joints may be quick where little turns
ROUNDING = 1e-18
MOST_STEPS = 1500


def follow(scene: Table, times: np.ndarray) -> Truth:
    """Return the true motion of the root of the parts of a scene."""
    parts = scene["part"]
    start = np.array(scene["start"].get("attitude", (0, 0, 0, 1)), dtype=Long)
    start /= np.sqrt(start @ start)
    inertia, inside = shape(parts, np.zeros(1, dtype=Long))
    momentum = _to_space(start[None], inertia @ np.array(scene["start"]["angular_velocity"], dtype=Long) + inside)[0]
    fine, coarse = (_integrated(parts, momentum, start, times, halves) for halves in (2, 1))
    apart = np.abs(fine - coarse).max(axis=1).astype(float)
    attitude = np.array([[_quad(x) for x in row] for row in fine])
    return Truth(attitude, 4.0 * apart + ROUNDING * (1.0 + len(times)))


def _quad(x: Any) -> Any:
    high = float(x)
    return Quad(high) + Quad(float(x - Long(high)))


def shape(parts: Sequence[Table], time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the tensor (n, 3, 3) about the common centre of mass and the internal momentum (n, 3), root axes."""
    n = len(time)
    poses: dict[str, tuple[np.ndarray, ...]] = {}
    masses, places, speeds, tensors, momenta = [], [], [], [], []
    for part in parts:
        turn, shift = np.broadcast_to(np.eye(3, dtype=Long), (n, 3, 3)), np.zeros((n, 3), dtype=Long)
        spin, speed = np.zeros((n, 3), dtype=Long), np.zeros((n, 3), dtype=Long)
        if part.get("parent"):
            turn, shift, spin, speed = poses[part["parent"]]
        for joint in part.get("joint", []):
            turn, shift, spin, speed = _hung(joint, time, turn, shift, spin, speed)
        poses[part["name"]] = turn, shift, spin, speed
        tensor = np.array(part["inertia"] if "inertia" in part else np.diag(part["principal_moments"]), dtype=Long)
        tensor = np.einsum("nij,jk,nlk->nil", turn, tensor, turn)
        place = _times(turn, np.array(part.get("center_of_mass", (0, 0, 0)), dtype=Long)) + shift
        masses.append(Long(part["mass"]))
        places.append(place)
        speeds.append(speed + _cross(spin, place))
        tensors.append(tensor)
        momenta.append(_times(tensor, spin))
    total = sum(masses)
    center = sum(m * x for m, x in zip(masses, places, strict=True)) / total
    drift = sum(m * v for m, v in zip(masses, speeds, strict=True)) / total
    inertia, inside = sum(tensors), sum(momenta)
    for m, x, v in zip(masses, places, speeds, strict=True):
        r = x - center
        square = (r * r).sum(axis=1)[:, None, None] * np.eye(3, dtype=Long)
        inertia = inertia + m * (square - r[:, :, None] * r[:, None, :])
        inside = inside + m * _cross(r, v - drift)
    return inertia, inside


def _hung(joint: Table, time: np.ndarray, turn: Any, shift: Any, spin: Any, speed: Any) -> tuple[np.ndarray, ...]:
    """Return rotation, shift, spin and velocity at the origin (v(x) = speed + spin × x) of what hangs on a joint."""
    value, rate = _driven(joint, time)
    axis = np.array(joint["axis"], dtype=Long)
    axis = axis / np.sqrt(axis @ axis)
    along = _times(turn, axis)
    if "displacements" in joint:
        return turn, shift + along * value[:, None], spin, speed + along * rate[:, None]
    point = np.array(joint.get("point", (0, 0, 0)), dtype=Long)
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=Long)
    s, v = np.sin(value)[:, None, None], 2 * np.sin(value / 2)[:, None, None] ** 2
    rotation = np.eye(3, dtype=Long) + s * skew + v * (skew @ skew)
    through = _times(turn, point) + shift
    turned = np.einsum("nij,njk->nik", turn, rotation)
    own = along * rate[:, None]
    return turned, through - _times(turned, point), spin + own, speed - _cross(own, through)


def _driven(joint: Table, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the value of a joint and its rate: quintics between keyframes, without acceleration there."""
    at = np.array(joint["times"], dtype=Long)
    values = np.array(joint.get("angles", joint.get("displacements")), dtype=Long)
    rates = np.array(joint.get("rates", np.zeros(len(at))), dtype=Long)
    value, rate = np.empty(len(time), dtype=Long), np.empty(len(time), dtype=Long)
    for n, t in enumerate(time):
        k = int(np.searchsorted(at, t, side="right")) - 1
        if k < 0 or k == len(at) - 1:
            k = max(k, 0)
            value[n], rate[n] = values[k] + rates[k] * (t - at[k]), rates[k]
            continue
        length = at[k + 1] - at[k]
        s, rise, a, b = (t - at[k]) / length, values[k + 1] - values[k], rates[k] * length, rates[k + 1] * length
        c, d, e = 10 * rise - 6 * a - 4 * b, -15 * rise + 8 * a + 7 * b, 6 * rise - 3 * a - 3 * b
        value[n] = values[k] + s * (a + s * s * (c + s * (d + s * e)))
        rate[n] = (a + s * s * (3 * c + s * (4 * d + s * 5 * e))) / length
    return value, rate


def _integrated(parts: Sequence[Table], momentum: Any, start: Any, times: np.ndarray, halves: int) -> np.ndarray:
    marks = {float(t) for part in parts for joint in part.get("joint", []) for t in joint["times"]}
    stops = sorted({0.0, *times.tolist(), *(t for t in marks if 0 < t < times[-1])})
    edges = [Long(0)]
    for a, b in pairwise(stops):
        count = halves * max(int(np.ceil(_turned(parts, momentum, Long(a), Long(b)) / PHASE)), LEAST)
        edges += [Long(a) + (Long(b) - Long(a)) * k / count for k in range(1, count)] + [Long(b)]
        if len(edges) > MOST_STEPS:
            raise TooLongError(f"{len(edges)} steps")
    matrix, weights, nodes = _gauss()
    begins, lengths = np.array(edges[:-1]), np.diff(np.array(edges))
    inertia, inside = shape(parts, (begins[:, None] + lengths[:, None] * nodes).ravel())
    inverse = _inverse(inertia).reshape(len(lengths), STAGES, 3, 3)
    inside = inside.reshape(len(lengths), STAGES, 3)
    q, at = start, {0.0: start}
    for k, h in enumerate(lengths):
        stages = np.broadcast_to(q, (STAGES, 4))
        for _ in range(60):
            rates = _rates(stages, inverse[k], inside[k], momentum)
            better = q + h * (matrix @ rates)
            change = np.abs(better - stages).max()
            stages = better
            if change < 1e-19:
                break
        q = q + h * (weights @ _rates(stages, inverse[k], inside[k], momentum))
        q = q / np.sqrt(q @ q)
        at[float(edges[k + 1])] = q
    return np.array([at[float(t)] for t in times])


def _rates(q: np.ndarray, inverse: np.ndarray, inside: np.ndarray, momentum: np.ndarray) -> np.ndarray:
    back = q * np.array([-1, -1, -1, 1], dtype=Long)
    w = _times(inverse, _to_space(back, np.broadcast_to(momentum, (len(q), 3))) - inside)
    v, s = q[:, :3], q[:, 3:]
    return 0.5 * np.concatenate([s * w + _cross(v, w), -(v * w).sum(axis=1, keepdims=True)], axis=1)


def _turned(parts: Sequence[Table], momentum: Any, a: Any, b: Any) -> float:
    """Return by how many rad things turn between two instants, roughly."""
    time = a + (b - a) * np.linspace(0, 1, 17).astype(Long)
    inertia, inside = shape(parts, time)
    moments = np.linalg.eigvalsh(inertia.astype(float))
    size = np.sqrt(float(momentum @ momentum)) + np.sqrt((inside * inside).sum(axis=1).astype(float))
    rates = size / np.sqrt(moments[:, 0] * moments[:, 2])
    for part in parts:
        for joint in part.get("joint", []):
            speed = np.abs(_driven(joint, time)[1].astype(float))
            rates = rates + (speed if "angles" in joint else 0.0)
    return float(rates.max() * float(b - a))


@cache
def _gauss() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return matrix, weights and nodes of Gauss collocation on 0 … 1."""
    with mpmath.workdps(40):
        about = np.polynomial.legendre.leggauss(STAGES)[0].tolist()
        nodes = [(1 + mpmath.findroot(lambda x: mpmath.legendre(STAGES, x), x)) / 2 for x in about]
        powers = mpmath.matrix([[x**k for k in range(STAGES)] for x in nodes])
        inverse = powers**-1
        rows = mpmath.matrix([[x ** (k + 1) / (k + 1) for k in range(STAGES)] for x in [*nodes, mpmath.mpf(1)]])
        full = rows * inverse
        table = np.array([[_long(full[i, j]) for j in range(STAGES)] for i in range(STAGES + 1)])
        return table[:-1], table[-1], np.array([_long(x) for x in nodes])


def _long(x: Any) -> Any:
    high = float(x)
    return Long(high) + Long(float(x - high))


def _times(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    return np.asarray((matrices * (vectors[:, None, :] if vectors.ndim == 2 else vectors)).sum(axis=-1))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    (p, q, r), (x, y, z) = a.T, b.T
    return np.stack([q * z - r * y, r * x - p * z, p * y - q * x], axis=-1)


def _to_space(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    u, s = q[:, :3], q[:, 3:]
    return v + 2 * _cross(u, s * v + _cross(u, v)) / (q * q).sum(axis=1, keepdims=True)


def _inverse(m: np.ndarray) -> np.ndarray:
    columns = [_cross(m[:, :, (k + 1) % 3], m[:, :, (k + 2) % 3]) for k in range(3)]
    determinant = (m[:, :, 0] * columns[0]).sum(axis=1)
    return np.stack(columns, axis=1) / determinant[:, None, None]
