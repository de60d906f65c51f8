"""§ 13.17 and 13.18: Euler's equations N1 = I1 ω̇1 − (I2 − I3) ω2 ω3, and the same from Lagrange's.

Solved cases: a torque along an axis of symmetry speeds the spin up in proportion to time; a torque fixed across it
turns the spin as a driven oscillator; one that is fixed in space adds to L what it has given, N t.
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import follow

from inertia.dynamics.kinematics import quaternion


def torque(vector, frame):
    return [{"kind": "torque", "torque": list(vector), "frame": frame}]


def test_spinning_up_a_symmetric_body():
    """I1 = I2: N along axis 3 gives ω3 = ω0 + N t/I3; ω1 + i ω2 = A exp(iη) with η = (I3 − I1)/I1 ∫ω3 dt.

    Moments 1, 1, 2, N = 1 N m, ω0 = 2 rad/s: ω3 = 2 + t/2 and η = 2 t + t²/4.
    """
    body = {"principal_moments": [1, 1, 2]}
    run = follow(body, [0.3, 0, 2], 6.0, load=torque([0, 0, 1], "part"))
    t = run.time
    eta = 2 * t + t**2 / 4
    expected = np.column_stack([0.3 * np.cos(eta), 0.3 * np.sin(eta), 2 + t / 2])
    np.testing.assert_allclose(run.angular_velocity, expected, atol=1e-9)


def test_a_torque_across_the_axis_of_symmetry():
    """Moments 1, 1, 2, ω3 = 3: ω̇1 = N − 3 ω2, ω̇2 = 3 ω1: ω1 = (N/3) sin 3t, ω2 = (N/3)(1 − cos 3t); N = 0.6."""
    run = follow({"principal_moments": [1, 1, 2]}, [0, 0, 3], 6.0, load=torque([0.6, 0, 0], "part"))
    t = run.time
    expected = np.column_stack([0.2 * np.sin(3 * t), 0.2 * (1 - np.cos(3 * t)), 3 + 0 * t])
    np.testing.assert_allclose(run.angular_velocity, expected, atol=1e-9)


def test_a_torque_fixed_in_space_adds_up():
    """dL/dt = N in space, whatever the body: L = L0 + N t."""
    run = follow({"principal_moments": [1, 2, 3]}, [1, 1, 1], 5.0, load=torque([0.1, 0.2, -0.3], "space"))
    expected = [1, 2, 3] + run.time[:, None] * [0.1, 0.2, -0.3]
    np.testing.assert_allclose(run.angular_momentum, expected, atol=1e-8)


def test_a_pendulum_of_lagrange():
    """A body hung by a point off its middle, let go at rest: I θ̈ = −M g a sinθ about the hinge.

    ½ I θ̇² = M g a (cosθ − cosθ0) at every sample; small swings have the period 2π √(I/M g a), which is 2 s for
    I = 1 kg m² and M g a = π² N m.
    """
    mass, arm = 2.0, math.pi**2 / (2.0 * 9.80665)
    moments = [1 - mass * arm**2, 1.5, 1.5]
    run = follow(
        {"principal_moments": moments, "mass": mass, "center_of_mass": [0, 0, -arm]},
        [0, 0, 0],
        2.0,
        attitude=[math.sin(0.005), 0, 0, math.cos(0.005)],
        constraint={"kind": "fixed_point"},
        load=[{"kind": "gravity"}],
    )
    down = quaternion.to_space(run.attitude, [0, 0, 1])[:, 2]
    np.testing.assert_allclose(0.5 * run.angular_velocity[:, 0] ** 2, math.pi**2 * (down - math.cos(0.01)), atol=1e-12)
    # After one period of a swing by 0.01 rad, longer than 2 s by 0.01²/16, it is back.
    assert 2 * math.atan2(run.attitude[-1, 0], run.attitude[-1, 3]) == pytest.approx(0.01, rel=1e-9)
