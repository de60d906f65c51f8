"""§ 13.25: a rotor runs quietly if its axis goes through the centre of mass and is a principal axis.

A symmetric rotor tilted by φ to its axle needs a torque ω² (I3 − I1) sinφ cosφ, across the axle and turning with it.
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import follow, free

import inertia

I1, I3, TILT, SPIN = 0.3, 0.5, 0.02, 100.0
TURN = np.array([[math.cos(TILT), 0, math.sin(TILT)], [0, 1, 0], [-math.sin(TILT), 0, math.cos(TILT)]])


def test_the_torque_of_a_tilted_wheel():
    """1e4 · 0.2 · sin 0.02 cos 0.02 = 39.989 N m, which the two bearings of an axle hold, turning with it."""
    wheel = {"inertia": inertia.reexpress(np.diag([I1, I1, I3]), TURN.T).tolist(), "mass": 1.0}
    axle = {"kind": "hinge", "axis": [0, 0, 1], "drive": "constant_speed", "bearings": [-0.5, 0.5]}
    run = follow(wheel, [0, 0, SPIN], 0.1, frame="part", constraint=axle)
    torque, force = run.quantities["reaction torque"], run.quantities["force on bearing B"]
    expected = SPIN**2 * (I3 - I1) * math.sin(TILT) * math.cos(TILT)
    assert expected == pytest.approx(39.989, abs=1e-3)
    np.testing.assert_allclose(torque[:, 2], 0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(torque, axis=1), expected, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), expected / 1.0, rtol=1e-12)  # 1 m between the bearings


def test_statically_balanced_is_not_enough():
    """Two equal weights opposite each other, one at each end: the centre of mass is on the axle, Ixz is not zero.

    m = 1 kg at ±(0.1, 0, 0.2) m: Ixz = −2 · 1 · 0.02 kg m², a couple of 0.04 ω².
    """
    rotor = inertia.point_masses([[0.1, 0, 0.2], [-0.1, 0, -0.2]], [1, 1])
    np.testing.assert_array_equal(rotor.center_of_mass, 0)
    assert rotor.inertia[0, 2] == pytest.approx(-0.04)
    balanced = rotor + inertia.point_masses([[-0.1, 0, 0.2], [0.1, 0, -0.2]], [1, 1])
    assert balanced.inertia[0, 2] == 0


def test_without_bearings_it_wobbles():
    """Let go, the tilted wheel keeps L in space: its axis goes round L at φ̇ = L/I1, by the angle between them."""
    start = SPIN * np.array([math.sin(TILT), 0, math.cos(TILT)])
    run = free([I1, I1, I3], start, 1.0)
    momentum = run.angular_momentum[0]
    assert run.quantities["precession of the body"] == pytest.approx(np.linalg.norm(momentum) / I1, rel=1e-14)
    lean = math.atan2(np.linalg.norm(np.cross(momentum, start)), momentum @ start)
    assert lean == pytest.approx(TILT - math.atan(I1 / I3 * math.tan(TILT)), rel=1e-12)
