"""§ 13.20: the free symmetric rotor.

ω goes round axis 3 in the body at Ω = (I3 − I1) ω3/I1. In space axis 3 goes round L at φ̇ = L/I1 =
ω √(1 + ((I3/I1)² − 1) cos²α), where α is between ω and axis 3, and θ with tanθ = (I1/I3) tanα between L and axis 3.
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import free, tilted

from inertia.dynamics.kinematics.geometry import cones


def upright(moments, alpha, spin, duration):
    """Follow a symmetric rotor whose L is along z: ω in the plane of axes 2 and 3, which starts upright in space."""
    theta = math.atan2(moments[0] * math.sin(alpha), moments[2] * math.cos(alpha))
    start = [0, spin * math.sin(alpha), spin * math.cos(alpha)]
    return theta, free(moments, start, duration, attitude=tilted(theta))


@pytest.mark.parametrize("moments", [(1.0, 1.0, 2.0), (1.0, 1.0, 0.25)])
def test_precession_in_the_body_and_in_space(moments):
    """α = 0.6 rad, ω = 2 rad/s, oblate and prolate: z-x-z angles along L grow as φ̇ t, θ stays, ψ̇ = −Ω."""
    alpha, spin = 0.6, 2.0
    theta, run = upright(moments, alpha, spin, 10.0)
    ratio = moments[2] / moments[0]
    precession = spin * math.sqrt(1 + (ratio**2 - 1) * math.cos(alpha) ** 2)
    around = (ratio - 1) * spin * math.cos(alpha)
    phi, tilt, psi = run.euler_angles().T
    np.testing.assert_allclose(tilt, theta, atol=1e-13)
    np.testing.assert_allclose(phi - phi[0], precession * run.time, atol=1e-12)
    np.testing.assert_allclose(psi - psi[0], -around * run.time, atol=1e-12)
    round_axis = np.unwrap(np.arctan2(run.angular_velocity[:, 1], run.angular_velocity[:, 0]))
    np.testing.assert_allclose(round_axis - round_axis[0], around * run.time, atol=1e-12)
    assert (precession > spin) == (ratio > 1)


def test_feynmans_plate():
    """I3 = 2 I1: for a slight tilt the plate wobbles at φ̇ = 2 ω3 while it turns at φ̇ + ψ̇ = ω3: 2 to 1."""
    theta, run = upright((1e-3, 1e-3, 2e-3), 1e-4, 20.0, 1.0)
    phi, _, psi = run.euler_angles().T
    assert theta == pytest.approx(5e-5, rel=1e-7)
    wobble, turn = phi[-1] - phi[0], phi[-1] - phi[0] + psi[-1] - psi[0]
    assert wobble / turn == pytest.approx(2, rel=1e-7)
    assert wobble == pytest.approx(40, rel=1e-7)


def test_the_cones():
    """I1 = 1, I3 = ¼, tanα = ¾: tanθ = 3, the body cone rolls outside a space cone of θ − α; I3 = 2: inside."""
    alpha = math.atan(0.75)
    needle, plate = (cones([1, 1, i3], [0, 3.0, 4.0]) for i3 in (0.25, 2.0))
    assert (needle.rolling, plate.rolling) == ("outside", "inside")
    assert needle.theta == pytest.approx(math.atan(3), rel=1e-15)
    assert needle.space_half_angle == pytest.approx(math.atan(3) - alpha, rel=1e-14)
    assert plate.space_half_angle == pytest.approx(alpha - math.atan(0.375), rel=1e-14)
    assert (needle.body_precession, plate.body_precession) == (-3, 4)
    assert plate.precession == pytest.approx(math.hypot(3, 8), rel=1e-15)


def test_the_three_vectors_stay_in_one_plane():
    """L·(ω × e₃) = 0 for I1 = I2."""
    _, run = upright((1.0, 1.0, 0.25), 0.6, 2.0, 10.0)
    momentum = run.angular_velocity * [1, 1, 0.25]
    np.testing.assert_allclose(
        np.cross(run.angular_velocity, [0, 0, 1])[:, :2].ravel() @ momentum[:, :2].ravel(), 0, atol=1e-12
    )


def test_momenta_of_lagrange():
    """I1 = 1, I3 = 2, L along z: p_φ = L, p_ψ = L cosθ, φ̇ = (p_φ − p_ψ cosθ)/(I1 sin²θ) = L/I1."""
    theta, run = upright((1.0, 1.0, 2.0), 0.6, 2.0, 5.0)
    size = math.hypot(2 * math.sin(0.6), 4 * math.cos(0.6))
    np.testing.assert_allclose(
        run.canonical_momenta(), np.broadcast_to([size, 0, size * math.cos(theta)], (101, 3)), atol=1e-12
    )
