"""§ 13.24: a disc that rolls on a plane without slipping, by eq. 13.199.

The case: M = 2 kg, R = 0.5 m, thin: I3 = ½ M R² = 0.25, I1 = 0.125 kg m².
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import G, follow, tilted

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.rolling.equations import RollingBody
from inertia.dynamics.models.rolling.steady import steady_rolling, straight_rolling_threshold

M, R, I1, I3 = 2.0, 0.5, 0.125, 0.25
BODY = {"principal_moments": [I1, I1, I3], "mass": M}


def rolled(omega, theta, duration, **rest):
    constraint = {"kind": "rolling", "radius": R}
    return follow(
        BODY,
        omega,
        duration,
        attitude=tilted(theta),
        frame="part",
        constraint=constraint,
        load=[{"kind": "gravity"}],
        **{"accuracy": 1e-9, **rest},
    )


def test_straight_on():
    """θ = 90°: v = R ψ̇, here 0.5 m at 8 rad/s: the contact is 4 m/s · t along the plane, the force M g upwards."""
    run = rolled([0, 0, -8.0], math.pi / 2, 3.0)
    contact, force = run.quantities["contact"], run.quantities["contact force"]
    np.testing.assert_allclose(np.linalg.norm(contact - contact[0], axis=1), 4 * run.time, atol=1e-8)
    np.testing.assert_allclose(force, np.broadcast_to([0, 0, M * G], force.shape), atol=1e-8)
    np.testing.assert_allclose(run.energy, 0.5 * I3 * 64 + 0.5 * M * 16 + M * G * R, rtol=1e-12)


def test_a_steady_circle():
    """θ = 60°, φ̇ = 3 rad/s, θ̈ = 0: (I3 + M R²) φ̇ sinθ ω3 − I1 φ̇² sinθ cosθ = −M g R cosθ gives ω3.

    The contact goes round a circle of R |ψ̇|/φ̇ and the centre, R cosθ nearer to the middle or farther, feels the
    centripetal force M φ̇² times its own radius.
    """
    theta, rate = math.radians(60), 3.0
    s, c = math.sin(theta), math.cos(theta)
    omega3 = (I1 * rate**2 * s * c - M * G * R * c) / ((I3 + M * R * R) * rate * s)
    run = rolled([0, rate * s, omega3], theta, 10.0)
    np.testing.assert_allclose(run.quantities["theta"], theta, atol=1e-8)
    np.testing.assert_allclose(run.quantities["phi"] - run.quantities["phi"][0], rate * run.time, atol=1e-7)
    radius = -R * (omega3 - rate * c) / rate
    middle = run.position - run.position.mean(axis=0)
    force = run.quantities["contact force"]
    np.testing.assert_allclose(force[:, 2], M * G, rtol=1e-8)
    np.testing.assert_allclose(np.hypot(*force[:, :2].T), M * rate**2 * abs(radius - R * c), rtol=1e-7)
    result = steady_rolling(RollingBody(M, I1, I3, R), theta, rate)
    assert result.contact_radius == pytest.approx(radius, rel=1e-12)
    assert np.ptp(middle[:, 2]) < 1e-8


def test_the_three_equations_along_a_wobbly_run():
    """θ̈, φ̈ and ψ̈ by differences of the rates at every ms, put into eq. 13.199, leave what differences leave."""
    run = rolled([0.4, 1.0, -9.0], 1.2, 0.5, samples=501)
    theta, phi1, theta1, psi1 = (run.quantities[name] for name in ("theta", "phi rate", "theta rate", "psi rate"))
    phi2, theta2, psi2 = (np.gradient(rate, run.time, edge_order=2) for rate in (phi1, theta1, psi1))
    s, c, omega3, rim = np.sin(theta), np.cos(theta), phi1 * np.cos(theta) + psi1, M * R * R
    first = (I1 + rim) * theta2 + (I3 + rim) * phi1 * s * omega3 - I1 * phi1**2 * s * c + M * G * R * c
    second = I1 * phi2 * s + 2 * I1 * phi1 * theta1 * c - I3 * theta1 * omega3
    third = (I3 + rim) * (phi2 * c - phi1 * theta1 * s + psi2) - rim * theta1 * phi1 * s
    for left in (first, second, third):
        np.testing.assert_allclose(left, 0, atol=2e-4)
    assert np.abs(theta2).max() > 5


def test_there_is_no_slip():
    """The point of the rim that touches is at rest: v + ω × (contact − centre) = 0, v by differences."""
    run = rolled([0.4, 1.0, -9.0], 1.2, 0.5, samples=501)
    speed = np.gradient(run.position, run.time, axis=0, edge_order=2)
    spin = quaternion.to_space(run.attitude, run.angular_velocity)
    slip = speed + np.cross(spin, run.quantities["contact"] - run.position)
    np.testing.assert_allclose(slip, 0, atol=1e-4)


@pytest.mark.parametrize(("factor", "stays"), [(1.1, True), (0.5, False)])
def test_a_wheel_stays_up_if_it_is_fast_enough(factor, stays):
    """A small lean swings for v² > g R/3 and grows below: the least spin is √(g/3R) = 2.557 rad/s."""
    least = math.sqrt(G / (3 * R))
    assert straight_rolling_threshold(RollingBody(M, I1, I3, R)) == pytest.approx(least, rel=1e-12)
    lean = rolled([0, 0, factor * least], math.pi / 2 - 1e-4, 3.0).quantities["theta"] - math.pi / 2
    assert (np.abs(lean).max() < 2e-3) == stays
