"""§ 13.5 and 13.11: L = I·ω, in the body and in space, and the angle between the two vectors.

L and ω are parallel along a principal axis only. Elsewhere cos∠(L, ω) = ω·L/(|ω| |L|) = 2T/(|ω| |L|), and no torque
keeps L, not ω, fixed in space.
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import follow, free

import inertia
from inertia.dynamics.kinematics.geometry import momentum_angle


def test_the_tensor_takes_one_vector_to_the_other():
    """Two masses of 1 kg at ±(1, 0, 1) m, spun about z at 3 rad/s: L = 2 × (−1·1, 0, 1) × 3 = (−6, 0, 6)."""
    pair = inertia.point_masses([[1, 0, 1], [-1, 0, -1]], [1, 1])
    np.testing.assert_allclose(pair.inertia @ [0, 0, 3], [-6, 0, 6], atol=1e-14)


def test_the_angle_between_them():
    """Moments 1, 2, 3 and ω = (1, 1, 1): L = (1, 2, 3), cos = 6/√(3·14)."""
    assert momentum_angle([1, 2, 3], [1, 1, 1]) == pytest.approx(math.acos(6 / math.sqrt(42)), rel=1e-14)
    np.testing.assert_array_equal(momentum_angle([1, 2, 3], np.eye(3)), 0)


def test_along_an_axis_of_a_body_seen_askew():
    """A tensor R diag(1, 2, 3) Rᵀ and a spin along its second column: L = 2 ω, which stays."""
    c, s = math.cos(0.3), math.sin(0.3)
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    tensor = axes @ np.diag([1.0, 2.0, 3.0]) @ axes.T
    run = follow({"inertia": (0.5 * (tensor + tensor.T)).tolist()}, 5 * axes[:, 1], 10.0, frame="part", accuracy=1e-8)
    np.testing.assert_allclose(run.angular_momentum, np.broadcast_to(10 * axes[:, 1], (101, 3)), atol=1e-8)


def test_momentum_stays_in_space_while_the_spin_does_not():
    """Moments 1, 2, 3 and ω = (1, 1, 1): L = (1, 2, 3) in space for ever, and along the body Iω of the same length."""
    run = free([1, 2, 3], [1, 1, 1], 20.0)
    np.testing.assert_allclose(run.angular_momentum, np.broadcast_to([1, 2, 3], (101, 3)), atol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(run.angular_velocity * [1, 2, 3], axis=1), math.sqrt(14), rtol=1e-14)
    assert np.ptp(run.angular_velocity, axis=0).min() > 0.3
