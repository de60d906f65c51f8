"""Euler's equations from right to left: the torque that a motion takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.arguments import vectors


def inverse_dynamics(inertia: ArrayLike, angular_velocity: ArrayLike, angular_acceleration: ArrayLike) -> Float:
    """Return the torque (…, 3) N m that turns a body as it does, N = I ω̇ + ω × I ω (textbook § 13.17).

    Parameters
    ----------
    inertia : (3, 3) kg m² about the centre of mass or a fixed point, or (3,) principal moments
    angular_velocity : (…, 3) rad/s, along the axes of the tensor
    angular_acceleration : (…, 3) rad/s², its rate of change along these axes

    A thin disc on an axle through its centre, 45° off its own axis, turns steadily: the axle holds it with ½ ω² of the
    difference of its moments.

    >>> inverse_dynamics([1.0, 1.0, 2.0], [3.0 * 0.5**0.5, 0.0, 3.0 * 0.5**0.5], [0, 0, 0]).round(12).tolist()
    [0.0, -4.5, 0.0]
    """
    tensor = np.asarray(vectors(inertia, "inertia"))
    tensor = np.diag(tensor) if tensor.ndim == 1 else tensor
    omega, rate = vectors(angular_velocity, "angular_velocity"), vectors(angular_acceleration, "angular_acceleration")
    torque: Float = rate @ tensor.T + np.cross(omega, omega @ tensor.T)
    return torque
