"""§ 13.14: ω from the rates of the Euler angles, along the body and in space, and where they stop to be defined."""

import math

import numpy as np
import pytest
from tests.textbook.worked import free

import inertia
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import angular_velocity, from_angles, is_singular, rates

ROOT = math.sqrt(3)


def test_along_the_body_and_in_space():
    """φ = 30°, θ = 60°, ψ = 90°; φ̇, θ̇, ψ̇ = 4, 2, 6 rad/s.

    Eq. 13.86–88: ω1 = 4 · √3/2 · 1 + 0 = 2√3, ω2 = 0 − 2 = −2, ω3 = 4 · ½ + 6 = 8.
    Eq. 13.89–91: ωx = 2 · √3/2 + 6 · √3/2 · ½ = 5√3/2, ωy = 2 · ½ − 6 · √3/2 · √3/2 = −7/2, ωz = 4 + 6 · ½ = 7.
    Both have ω² = 80 = 18.75 + 12.25 + 49.
    """
    angles, given = np.radians([30, 60, 90]), [4, 2, 6]
    body, space = (angular_velocity(angles, given, frame=frame) for frame in ("body", "space"))
    np.testing.assert_allclose(body, [2 * ROOT, -2, 8], atol=1e-14)
    np.testing.assert_allclose(space, [5 * ROOT / 2, -7 / 2, 7], atol=1e-14)
    np.testing.assert_allclose(quaternion.to_space(from_angles(angles), body), space, atol=1e-14)
    np.testing.assert_allclose(rates(angles, body), given, atol=1e-14)
    np.testing.assert_allclose(rates(angles, space, frame="space"), given, atol=1e-14)


@pytest.mark.parametrize(("theta", "sign"), [(0.0, 1), (math.pi, -1)])
def test_at_the_poles_the_sum_or_the_difference_alone_is_defined(theta, sign):
    """θ = 0: ω3 = φ̇ + ψ̇; θ = π: ω_z = φ̇ − ψ̇ = −ω3."""
    body = [0, 0, 7.0]
    assert is_singular([0.3, theta, 0.2])
    with pytest.raises(inertia.GeometryError, match="only φ̇ ± ψ̇ is defined"):
        rates([0.3, theta, 0.2], body)
    np.testing.assert_allclose(rates([0.3, theta, 0.2], body, merge=True), [sign * 7, 0, 0], atol=1e-14)


def test_the_angles_of_a_run_change_at_these_rates():
    """Differences of the angles of a tumbling body, to second order in 1 ms, against the rates that its ω gives."""
    run = free([1, 2, 3], [0.5, 1.0, 0.7], 0.2, samples=201, attitude=from_angles([0.1, 0.8, 0.3]).tolist())
    angles = run.euler_angles()
    slopes = np.gradient(angles, run.time, axis=0, edge_order=2)
    np.testing.assert_allclose(rates(angles, run.angular_velocity), slopes, atol=1e-5)
