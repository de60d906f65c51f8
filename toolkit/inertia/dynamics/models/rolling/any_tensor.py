"""A body that rolls without slipping on a round rim, of any tensor and with its centre of mass anywhere.

Along the part axes, with ρ from the centre of mass to the contact, e the axis of the rim, k the vertical, and u the
direction of k across e, ρ = d − R u; the velocity of the centre of mass is ρ × ω, and without the contact force

    (I + M (ρ² − ρρᵀ)) ω̇ = −ω × I ω + M ρ × (ρ̇ × ω + ω × (ρ × ω) + g k),    ρ̇ = −R u̇,    k̇ = k × ω.

For a body of revolution about e these are the equations of `inertia.dynamics.models.rolling.equations`.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.computing_time import Watch
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError

_TOLERANCE = 1e-13


def roll_any(
    inertia: Float,
    mass: float,
    middle: Float,
    axis: Float,
    radius: float,
    gravity: float,
    attitude: Float,
    angular_velocity: Float,
    duration: float,
) -> Float:
    """Return the attitude (4,) after `duration` s, by DOP853.

    Parameters
    ----------
    inertia : (3, 3) kg m² about the centre of mass
    mass : kg
    middle : (3,) m, d, from the centre of mass to the middle of the rim
    axis : (3,) of the rim, a unit vector; radius : m
    gravity : m/s², along −z of space
    attitude : (4,), and angular_velocity : (3,) rad/s along the part axes, at t = 0

    Raises `GeometryError` where it lies down.
    """
    from scipy.integrate import DOP853

    watch = Watch()
    pace = float(np.sqrt(gravity / radius + angular_velocity @ angular_velocity))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia.tolist()
    (d1, d2, d3), (e1, e2, e3) = middle.tolist(), axis.tolist()

    def rates(_: float, state: Float) -> list[float]:
        x, y, z, w, p, q, r = state.tolist()
        scale = 2.0 / (x * x + y * y + z * z + w * w)
        k1, k2, k3 = scale * (x * z - y * w), scale * (y * z + x * w), 1.0 - scale * (x * x + y * y)
        t1, t2, t3 = k2 * r - k3 * q, k3 * p - k1 * r, k1 * q - k2 * p
        lean, tilting = k1 * e1 + k2 * e2 + k3 * e3, t1 * e1 + t2 * e2 + t3 * e3
        u1, u2, u3 = k1 - lean * e1, k2 - lean * e2, k3 - lean * e3
        size = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
        u1, u2, u3 = u1 / size, u2 / size, u3 / size
        s1, s2, s3 = t1 - tilting * e1, t2 - tilting * e2, t3 - tilting * e3
        along, factor = s1 * u1 + s2 * u2 + s3 * u3, -radius / size
        v1, v2, v3 = factor * (s1 - along * u1), factor * (s2 - along * u2), factor * (s3 - along * u3)
        a1, a2, a3 = d1 - radius * u1, d2 - radius * u2, d3 - radius * u3
        # ρ̇ × ω + ω × (ρ × ω) + g k, with ω × (ρ × ω) = ρ ω² − ω (ω·ρ)
        square, inward = p * p + q * q + r * r, p * a1 + q * a2 + r * a3
        f1 = v2 * r - v3 * q + a1 * square - p * inward + gravity * k1
        f2 = v3 * p - v1 * r + a2 * square - q * inward + gravity * k2
        f3 = v1 * q - v2 * p + a3 * square - r * inward + gravity * k3
        l1, l2, l3 = xx * p + xy * q + xz * r, xy * p + yy * q + yz * r, xz * p + yz * q + zz * r
        n1 = mass * (a2 * f3 - a3 * f2) - q * l3 + r * l2
        n2 = mass * (a3 * f1 - a1 * f3) - r * l1 + p * l3
        n3 = mass * (a1 * f2 - a2 * f1) - p * l2 + q * l1
        aa, bb, cc = xx + mass * (a2 * a2 + a3 * a3), yy + mass * (a1 * a1 + a3 * a3), zz + mass * (a1 * a1 + a2 * a2)
        ab, ac, bc = xy - mass * a1 * a2, xz - mass * a1 * a3, yz - mass * a2 * a3
        m11, m12, m13 = bb * cc - bc * bc, ac * bc - ab * cc, ab * bc - ac * bb
        m22, m23, m33 = aa * cc - ac * ac, ab * ac - aa * bc, aa * bb - ab * ab
        volume = aa * m11 + ab * m12 + ac * m13
        return [
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
            -0.5 * (x * p + y * q + z * r),
            (m11 * n1 + m12 * n2 + m13 * n3) / volume,
            (m12 * n1 + m22 * n2 + m23 * n3) / volume,
            (m13 * n1 + m23 * n2 + m33 * n3) / volume,
        ]

    scale = _TOLERANCE * np.array([1.0] * 4 + [pace] * 3)
    start = np.concatenate([attitude, angular_velocity])
    solver = DOP853(rates, 0.0, start, duration, rtol=_TOLERANCE, atol=scale)
    while solver.status == "running":
        if message := solver.step():
            raise GeometryError(f"the rolling body cannot be followed beyond t = {solver.t:.6g} s: {message.lower()}")
        watch.require(solver.t / duration)
    return quaternion.normalise(solver.y[:4])
