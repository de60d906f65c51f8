"""Many free bodies stepped at once, for peers of the closed form and for Monte Carlo by brute force."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError, UsageError
from inertia.native import Kernel

_KERNEL = Kernel("inertia.dynamics.integrators.ensemble_kernel", "step_bodies", "piidp")

LANES = 16
"""Bodies in a block of the kernel."""

CHUNK = 4096
"""Bodies that the numpy path takes together; they stay in the cache."""


def step_ensemble(moments: ArrayLike, angular_velocity: ArrayLike, duration: float, steps: int) -> tuple[Float, Float]:
    """Step m free bodies from the identity attitude by the classical Runge–Kutta method.

    Parameters
    ----------
    moments : (m, 3) or (3,) kg m², principal; angular_velocity : (m, 3) rad/s, along the principal axes
    duration : s; steps : how many equal steps

    Returns
    -------
    attitude (m, 4), scalar-last, and angular velocity (m, 3) at the end.

    Raises `GeometryError` for moments that are not positive, `UsageError` for shapes or numbers that cannot be used.

    >>> attitude, _ = step_ensemble([1.0, 1.0, 1.0], [[0.0, 0.0, np.pi]], duration=1.0, steps=100)
    >>> attitude.round(6).tolist()
    [[0.0, 0.0, 1.0, 0.0]]
    """
    spins = np.asarray(angular_velocity, dtype=np.float64)
    if spins.ndim != 2 or spins.shape[1] != 3 or not np.isfinite(spins).all():
        raise UsageError(f"angular_velocity must be finite and of shape (m, 3), not {spins.shape}")
    try:
        inertia = np.broadcast_to(np.asarray(moments, dtype=np.float64), spins.shape)
    except ValueError:
        raise UsageError(f"moments have shape {np.shape(moments)}: give (3,) or {spins.shape}") from None
    bad = np.flatnonzero(~((inertia > 0) & np.isfinite(inertia)).all(axis=1))
    if bad.size:
        raise GeometryError(f"moments[{bad[0]}] is {inertia[bad[0]].tolist()} kg m²: all three must be positive")
    if not np.isfinite(duration) or steps < 1:
        raise UsageError(f"duration is {duration} s in {steps} steps: give a finite time and at least one step")
    bodies = np.zeros((10, -(-len(spins) // LANES) * LANES))
    bodies[3] = 1.0
    bodies[4:7, : len(spins)] = spins.T
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        bodies[7 + k, : len(spins)] = (inertia[:, i] - inertia[:, j]) / inertia[:, k]
    step = duration / steps
    if _KERNEL.worthwhile(len(spins) * steps // 10):
        block = np.empty((10, LANES))
        _KERNEL.function(bodies.ctypes.data, bodies.shape[1], steps, step, block.ctypes.data)
    else:
        for begin in range(0, len(spins), CHUNK):
            _step_numpy(bodies[:, begin : begin + CHUNK], steps, step)
    state = bodies[:7, : len(spins)].T
    return quaternion.normalise(state[:, :4]), state[:, 4:].copy()


def _step_numpy(bodies: Float, steps: int, step: float) -> None:
    state, euler = bodies[:7], bodies[7:]

    def rate(at: Float) -> Float:
        x, y, z, w, p, q, r = at
        return np.stack(
            [
                0.5 * (w * p + y * r - z * q),
                0.5 * (w * q + z * p - x * r),
                0.5 * (w * r + x * q - y * p),
                -0.5 * (x * p + y * q + z * r),
                euler[0] * q * r,
                euler[1] * r * p,
                euler[2] * p * q,
            ]
        )

    for _ in range(steps):
        a = rate(state)
        b = rate(state + 0.5 * step * a)
        c = rate(state + 0.5 * step * b)
        state += step / 6.0 * (a + 2.0 * (b + c) + rate(state + step * c))
        state[:4] *= 1.5 - 0.5 * (state[:4] ** 2).sum(axis=0)
