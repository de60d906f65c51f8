"""Rotation matrices from and to what files hold: quaternions, real part first, and roll, pitch and yaw."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float


def quaternion_of(rotation: Float) -> list[float]:
    """Return the unit quaternion (w, x, y, z), w ≥ 0, of a rotation matrix (3, 3).

    The row with the largest diagonal of 4 q qᵀ is taken, so that nothing cancels (Shepperd's method, J. Guidance and
    Control 1 (1978) 223).

    >>> quaternion_of(np.diag([1.0, -1.0, -1.0]))
    [0.0, 1.0, 0.0, 0.0]
    """
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    rows = (
        (1 + a + e + i, h - f, c - g, d - b),
        (h - f, 1 + a - e - i, b + d, c + g),
        (c - g, b + d, 1 - a + e - i, f + h),
        (d - b, c + g, f + h, 1 - a - e + i),
    )
    row = rows[max(range(4), key=lambda k: rows[k][k])]
    size = math.copysign(math.hypot(*row), row[0] or 1.0)
    return [k / size + 0.0 for k in row]


def rotation_of_quaternion(quaternion: Sequence[float]) -> Float:
    """Return the rotation matrix (3, 3) of a quaternion (w, x, y, z), which need not be of unit length.

    >>> rotation_of_quaternion([2, 0, 0, 2]).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    least = -math.frexp(max(map(abs, quaternion)))[1]  # a power of two, so that no square is zero or infinite
    w, x, y, z = (math.ldexp(k, least) for k in quaternion)
    size = w * w + x * x + y * y + z * z
    return (
        np.array(
            [
                [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
            ]
        )
        / size
    )


def rotation_of_rpy(roll: float, pitch: float, yaw: float) -> Float:
    """Return Rz(yaw) Ry(pitch) Rx(roll), (3, 3): turns about the fixed x, then y, then z, in rad.

    >>> (rotation_of_rpy(0.0, 0.0, math.pi / 2) @ [1.0, 0.0, 0.0]).round(15).tolist()
    [0.0, 1.0, 0.0]
    """
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle), math.cos(angle)) for angle in (roll, pitch, yaw))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
