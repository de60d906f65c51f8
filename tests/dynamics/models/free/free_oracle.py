"""The free top by mpmath, from textbook formulas that take no care of rounding: digits stand in for it.

The frame axis is the one whose momentum keeps its sign, whatever its angle to L; ω follows from `ellipfun`, the third
angle from Legendre's incomplete integral of the third kind; matrices, no quaternions. Inputs are taken as exact. It
shares neither code nor the formula of the third angle with the package; `oracle.rotate`, a Taylor integrator, agrees
with it to 30 digits (`test_free_oracle.py`).
"""

from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np

State = tuple[Any, list[Any]]


def free_top(
    moments: Sequence[float], angular_velocity: Sequence[float], times: Sequence[float], digits: int = 60
) -> list[State]:
    """Return, at each time, the rotation matrix (body to space, the identity at 0) and ω."""
    with mp.workdps(digits):
        return [_at(moments, angular_velocity, t) for t in times]


def matrix(attitude: Sequence[Any]) -> Any:
    """Return the rotation matrix of a quaternion, scalar last, of any length."""
    x, y, z, w = (mp.mpf(k) for k in attitude)
    n = x * x + y * y + z * z + w * w
    rows = [
        [n - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), n - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), n - 2 * (x * x + y * y)],
    ]
    return mp.matrix(rows) / n


def angle(one: Any, other: Any) -> float:
    """Return the angle in rad of the turn between two rotation matrices."""
    return float(2 * mp.asin(min(1, mp.mnorm(one - other, "f") / (2 * mp.sqrt(2)))))


def errors(
    moments: Sequence[float],
    angular_velocity: Sequence[float],
    times: Sequence[float],
    motion: tuple[np.ndarray, np.ndarray],
    digits: int = 60,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors (n,) of a float64 motion: of its attitude in rad, and of ω relative to |ω|."""
    truth = free_top(moments, angular_velocity, times, digits)
    with mp.workdps(digits):
        speed = mp.norm([mp.mpf(float(x)) for x in angular_velocity])
        turned = [angle(matrix(q), true) for q, (true, _) in zip(motion[0].tolist(), truth, strict=True)]
        off = [
            float(mp.norm([mp.mpf(x) - y for x, y in zip(answer, true, strict=True)]) / speed)
            for answer, (_, true) in zip(motion[1].tolist(), truth, strict=True)
        ]
    return np.array(turned), np.array(off)


def _at(moments: Sequence[float], angular_velocity: Sequence[float], time: float) -> State:
    order = sorted(range(3), key=lambda k: moments[k])
    i, w = ([mp.mpf(x) for x in row] for row in (moments, angular_velocity))
    t = mp.mpf(float(time))
    twice_energy = mp.fsum(i[k] * w[k] ** 2 for k in range(3))
    square = mp.fsum((i[k] * w[k]) ** 2 for k in range(3))
    if square < twice_energy * i[order[1]]:
        order.reverse()
    parity = 1 if (order[1] - order[0]) % 3 == 1 else -1
    axes = mp.matrix(3, 3)  # columns: a right-handed frame of the body axes
    for column, (k, sign) in enumerate(zip(order, (1, 1, parity), strict=True)):
        axes[k, column] = sign
    a, b, c = (i[k] for k in order)
    w1, w2, w3 = axes.T * mp.matrix(w)
    sense, keeps = mp.sign(c - b), mp.sign(w3)
    momentum, p, q = mp.sqrt(square), (twice_energy * c - square) / (c - a), (square - twice_energy * a) / (c - a)
    m, n = (b - a) * p / ((c - b) * q), c * (b - a) / (a * (c - b))
    rate = mp.sqrt((c - b) * (c - a) * q / (a * b * c))
    of_cn, of_sn = mp.sqrt(p / a), keeps * sense * mp.sqrt(p * (c - a) / (b * (c - b)))
    sn, cn, dn, third = _functions(mp.atan2(w2 / of_sn, w1 / of_cn), rate * t, m, n)
    omega = [of_cn * cn, of_sn * sn, keeps * mp.sqrt(q / c) * dn]
    turn = momentum * t / c + momentum * (1 / a - 1 / c) / rate * third
    start, end = _frame(a * w1, b * w2, c * w3), _frame(a * omega[0], b * omega[1], c * omega[2])
    return axes * (start.T * _about_axis_3(turn) * end) * axes.T, list(axes * mp.matrix(omega))


def _functions(amplitude: Any, elapsed: Any, m: Any, n: Any) -> tuple[Any, Any, Any, Any]:
    """Return sn, cn, dn and what the integral of 1/(1 + n sn²) grows by."""
    if m == 1:
        s = mp.tanh(mp.atanh(mp.sin(amplitude)) + elapsed)
        arcs = mp.atan(mp.sqrt(n) * s) - mp.atan(mp.sqrt(n) * mp.sin(amplitude))
        c = mp.sqrt((1 - s) * (1 + s)) if abs(s) < 1 else mp.mpf(0)
        return s, c, c, (elapsed + mp.sqrt(n) * arcs) / (1 + n)
    u = mp.ellipf(amplitude, m) + elapsed
    half_period = 2 * mp.ellipk(m)
    count = mp.nint(u / half_period)
    sn, cn, dn = (mp.ellipfun(kind, u - count * half_period, m=m) for kind in ("sn", "cn", "dn"))
    grown = mp.ellippi(-n, mp.pi * count + mp.atan2(sn, cn), m) - mp.ellippi(-n, amplitude, m)
    sign = -1 if int(count) % 2 else 1
    return sign * sn, sign * cn, dn, grown


def _frame(x: Any, y: Any, z: Any) -> Any:
    """Return the rotation that takes a vector to axis 3, and axis 3 of the body into the plane of axes 1 and 3."""
    length, across = mp.sqrt(x * x + y * y + z * z), mp.sqrt(x * x + y * y)
    sine, cosine = across / length, z / length
    return mp.matrix(
        [
            [cosine * x / across, cosine * y / across, -sine],
            [-y / across, x / across, 0],
            [x / length, y / length, cosine],
        ]
    )


def _about_axis_3(turn: Any) -> Any:
    c, s = mp.cos(turn), mp.sin(turn)
    return mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
