"""Attitude quaternions: scalar last, (…, 4) as (x, y, z, w), taking body components to space components.

Pure functions on arrays; leading axes broadcast. `multiply(p, q)` is the attitude that turns by q first, then by p.
Quaternions are expected to have unit length; none of these functions normalises behind the caller's back. A `Rotation`
of scipy stands for its quaternions, and `Rotation.from_quat` takes them back, in the same order.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, cross, of_rotation

IDENTITY = (0.0, 0.0, 0.0, 1.0)


def _array(q: ArrayLike) -> Float:
    return np.asarray(of_rotation(q, 4), dtype=np.float64)


def multiply(p: ArrayLike, q: ArrayLike) -> Float:
    """Return the product p q, (…, 4).

    >>> multiply([1, 0, 0, 0], [0, 1, 0, 0]).tolist()
    [0.0, 0.0, 1.0, 0.0]
    """
    p, q = _array(p), _array(q)
    px, py, pz, pw = np.moveaxis(p, -1, 0)
    qx, qy, qz, qw = np.moveaxis(q, -1, 0)
    return np.stack(
        [
            pw * qx + px * qw + (py * qz - pz * qy),
            pw * qy + py * qw + (pz * qx - px * qz),
            pw * qz + pz * qw + (px * qy - py * qx),
            pw * qw - (px * qx + py * qy + pz * qz),
        ],
        axis=-1,
    )


def conjugate(q: ArrayLike) -> Float:
    """Return the inverse of a unit quaternion, (…, 4)."""
    return np.multiply(_array(q), (-1.0, -1.0, -1.0, 1.0))


def normalise(q: ArrayLike) -> Float:
    """Return q divided by its length, (…, 4)."""
    q = _array(q)
    length: Float = np.sqrt(np.add.reduce(q * q, -1, keepdims=True))  # as numpy.linalg.norm, which takes longer
    return q / length


def continuous(attitude: Float) -> Float:
    """Choose the sign of each quaternion (n, 4) so that neighbours are near each other, for plots and interpolation."""
    turns = np.einsum("ij,ij->i", attitude[1:], attitude[:-1]) < 0
    sign = np.concatenate([[1.0], np.where(np.cumsum(turns) % 2, -1.0, 1.0)])
    signed: Float = attitude * sign[:, None]
    return signed


def to_space(q: ArrayLike, vector: ArrayLike) -> Float:
    """Take body components (…, 3) to space components: v + 2 u × (u × v + w v), with u the vector part."""
    q, v = _array(q), np.asarray(vector, dtype=np.float64)
    u, w = q[..., :3], q[..., 3:]
    return v + 2.0 * cross(u, cross(u, v) + w * v)


def to_body(q: ArrayLike, vector: ArrayLike) -> Float:
    """Take space components (…, 3) to body components."""
    return to_space(conjugate(q), vector)


def matrix(q: ArrayLike) -> Float:
    """Return the rotation matrix (…, 3, 3) whose columns are the body axes in space components."""
    x, y, z, w = np.moveaxis(_array(q), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def from_matrix(rotation: ArrayLike) -> Float:
    """Return the quaternion (…, 4) of a rotation matrix, with w ≥ 0.

    The row with the largest diagonal of 4 q qᵀ is taken, so that nothing cancels (Shepperd's method, J. Guidance and
    Control 1 (1978) 223).
    """
    r = np.asarray(rotation, dtype=np.float64)
    trace = np.trace(r, axis1=-2, axis2=-1)
    outer = np.empty((*r.shape[:-2], 4, 4))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        outer[..., i, i] = 1.0 + 2.0 * r[..., i, i] - trace
        outer[..., j, k] = outer[..., k, j] = r[..., j, k] + r[..., k, j]
        outer[..., i, 3] = outer[..., 3, i] = r[..., k, j] - r[..., j, k]
    outer[..., 3, 3] = 1.0 + trace
    best = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    q = normalise(np.take_along_axis(outer, best[..., None, None], axis=-2)[..., 0, :])
    return np.where(q[..., 3:] < 0, -q, q)


def from_rotation_vector(vector: ArrayLike) -> Float:
    """Return the quaternion (…, 4) of the turn by |vector| rad about vector (…, 3)."""
    vector = np.asarray(vector, dtype=np.float64)
    half = 0.5 * np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.concatenate([0.5 * np.sinc(half / np.pi) * vector, np.cos(half)], axis=-1)


def angle_between(p: ArrayLike, q: ArrayLike) -> Float:
    """Return the angle in rad, 0 … π, of the turn from attitude q to attitude p, (…): accurate for small ones."""
    turn = multiply(p, conjugate(q))
    half: Float = np.arctan2(np.linalg.norm(turn[..., :3], axis=-1), np.abs(turn[..., 3]))
    return 2.0 * half
