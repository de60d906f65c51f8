"""Bearing forces against Newton's law for the single masses; axle torques against the rate of angular momentum."""

import cmath
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.balancing.rotors import lumped, on_z, weight

import inertia
from inertia import UsageError
from inertia.balancing.forces import amplification, axle_torque, bearing_forces, carried_masses, rigid_limit
from inertia.balancing.unbalance import Unbalance

MASSES = (weight(0.4, 60, 20, 70), weight(1.1, 25, 250, 190), weight(0.3, 80, 130, 420))


def newton(masses, z_a, z_b, speed, acceleration):
    """Return the force on each bearing from the acceleration of every mass: −m r̈ at its place, by the lever rule."""
    a = b = 0j
    for k in masses:
        force = -k.mass * cmath.rect(k.radius, k.angle) * (1j * acceleration - speed**2)
        share = (k.z - z_a) / (z_b - z_a)
        a, b = a + (1 - share) * force, b + share * force
    return [a, b]


@pytest.mark.parametrize(("z_a", "z_b"), [(0.0, 0.5), (0.02, 0.2)], ids=["inboard", "overhung"])
@pytest.mark.parametrize("acceleration", [0.0, 3e4, -3e4])
def test_forces_are_those_of_the_masses(z_a, z_b, acceleration):
    speeds = np.array([0.0, 50.0, 314.0])
    forces = bearing_forces(lumped(MASSES), z_a, z_b, speeds, acceleration)
    expected = [newton(MASSES, z_a, z_b, w, acceleration) for w in speeds]
    np.testing.assert_allclose(forces, expected, rtol=1e-12, atol=1e-9)


def test_starting_from_rest_the_force_lags_the_heavy_spot_by_90_degrees():
    force = bearing_forces(Unbalance(1.0, 0.1, 1e-3, 0.0), 0.0, 0.2, 0.0, 100.0)[0]
    assert math.degrees(cmath.phase(force)) == pytest.approx(-90)


def test_a_speed_that_is_not_finite_is_refused():
    with pytest.raises(UsageError, match="not finite"):
        bearing_forces(lumped(MASSES), 0.0, 1.0, [1.0, math.inf])


@pytest.mark.parametrize("acceleration", [0.0, 700.0])
def test_axle_torque_is_the_rate_of_angular_momentum(acceleration):
    """L = R I Rᵀ ω in space axes, differentiated by central differences."""
    root = np.array([[1.0, 0.2, -0.3], [0.1, 1.3, 0.25], [-0.2, 0.05, 1.1]])
    tensor = root @ root.T
    speed, step = 20.0, 1e-5

    def momentum(t):
        turn = Rotation.from_rotvec([0, 0, speed * t + acceleration * t * t / 2]).as_matrix()
        return turn @ tensor @ [0, 0, speed + acceleration * t]

    rate = (momentum(step) - momentum(-step)) / (2 * step)
    body = inertia.MassProperties(1.0, 0.0, [0, 0, 0.5], tensor)
    forces = complex(axle_torque(Unbalance.of(body, on_z()).couple, speed, acceleration))
    assert forces == pytest.approx(complex(rate[0], rate[1]), rel=1e-6)


def test_bearing_forces_give_the_axle_torque():
    rotor = lumped(MASSES)
    couple_only = Unbalance(rotor.mass, rotor.z, 0.0, rotor.couple)
    a, b = bearing_forces(couple_only, 0.1, 0.4, 100.0, 50.0)
    # The bearings answer with −F at z: torque z × (−F) is −i z F in complex form.
    assert -1j * (0.1 * a + 0.4 * b) == pytest.approx(complex(axle_torque(rotor.couple, 100.0, 50.0)), rel=1e-12)


def test_bearings_carry_the_weight_by_the_lever_rule():
    assert carried_masses(10.0, 0.3, 0.1, 0.5) == pytest.approx((5.0, 5.0))
    assert carried_masses(10.0, 0.6, 0.1, 0.5) == pytest.approx((-2.5, 12.5))
    with pytest.raises(UsageError, match=r"both bearings lie at z = 0.1 m"):
        carried_masses(10.0, 0.6, 0.1, 0.1)


@pytest.mark.parametrize(("ratio", "figure"), [(0.1, 1.01), (0.2, 1.04), (0.3, 1.10), (0.5, 1.33)])
def test_amplification_is_that_of_a_finite_element_rotor_far_below_the_critical_speed(ratio, figure):
    assert amplification(ratio) == pytest.approx(figure, abs=6e-3)


@pytest.mark.parametrize(("ratio", "figure"), [(0.7, 1.93), (0.9, 4.94)])
def test_amplification_is_above_that_of_a_finite_element_rotor_near_the_critical_speed(ratio, figure):
    assert figure < amplification(ratio) < 1.07 * figure


@pytest.mark.parametrize("ratio", [0.4, 0.8, 1.6])
def test_amplification_is_that_of_a_disc_on_an_elastic_shaft(ratio):
    """The whirl of an undamped disc: k r = m ω² (r + e); the bearings feel k r."""
    k, m, e = 4e6, 25.0, 1e-5
    speed = ratio * math.sqrt(k / m)
    r = m * speed**2 * e / (k - m * speed**2)
    assert amplification(ratio) == pytest.approx(abs(k * r) / (m * e * speed**2), rel=1e-12)


@pytest.mark.parametrize(
    ("ratio", "level"),
    [
        (0.299, "rigid"),
        (0.3, "note"),
        (0.499, "note"),
        (0.5, "warn"),
        (0.699, "warn"),
        (0.7, "flexible"),
        (1, "flexible"),
    ],
)
def test_the_rigid_limit_notes_warns_and_refuses(ratio, level):
    forces = rigid_limit(1000 * ratio, 1000)
    assert forces.level == level
    assert f"{ratio:.3g} of the critical one" in forces.text


@pytest.mark.parametrize("critical", [0.0, -5.0, math.nan, math.inf])
def test_a_critical_speed_that_is_none_is_refused(critical):
    with pytest.raises(UsageError, match="critical speed is"):
        rigid_limit(100.0, critical)


def test_a_ratio_that_is_none_is_refused():
    with pytest.raises(UsageError, match="of the critical one"):
        amplification(-0.1)
