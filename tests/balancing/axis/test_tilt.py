"""Tilt of the principal axis, swash discs, and the textbook's bent wheel (§ 13.25)."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.balancing.rotors import on_z

import inertia
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.axis.tilt import principal_tilt, swash_couple
from inertia.balancing.forces import axle_torque
from inertia.balancing.unbalance import Unbalance
from inertia_meshes import catalogue, path

ANGLE = st.floats(-math.pi, math.pi)


def wheel(polar, transverse, tilt, direction):
    """Return a body of revolution whose axis leans to `direction`."""
    axis = np.array([math.sin(tilt) * math.cos(direction), math.sin(tilt) * math.sin(direction), math.cos(tilt)])
    tensor = transverse * np.eye(3) + (polar - transverse) * np.outer(axis, axis)
    return inertia.MassProperties(3.0, 0.0, [0, 0, 0.5], tensor)


@settings(deadline=None, max_examples=60)
@given(st.floats(1e-3, 0.7), ANGLE, st.sampled_from([(2.0, 1.2), (0.3, 1.0)]))
def test_the_tilt_and_the_couple_are_those_that_the_wheel_was_built_with(tilt, direction, moments):
    body = wheel(*moments, tilt, direction)
    lean = principal_tilt(body, on_z())
    assert lean.angle == pytest.approx(tilt, rel=1e-9)
    assert math.cos(lean.direction - direction) == pytest.approx(1.0, abs=1e-12)
    assert lean.certain
    couple = Unbalance.of(body, on_z()).couple
    assert swash_couple(*moments, tilt, direction) == pytest.approx(couple, rel=1e-9)


@settings(deadline=None, max_examples=40)
@given(st.floats(-0.7, 0.7), st.floats(1.5, 1.9))
def test_in_one_plane_the_tilt_is_half_an_arctangent(product, polar):
    tensor = np.array([[1.0, 0, product * 0.1], [0, 1.0, 0], [product * 0.1, 0, polar]])
    tilt = principal_tilt(inertia.MassProperties(1.0, 0.0, [0, 0, 0], tensor), on_z())
    expected = 0.5 * math.atan2(2 * product * 0.1, polar - 1.0)
    assert tilt.angle * math.cos(tilt.direction) == pytest.approx(expected, abs=1e-12)


def test_the_tilt_is_that_from_the_shaft_and_not_from_the_parts_z_axis():
    body = wheel(2.0, 1.2, 0.3, 0.0)
    along = np.array([math.sin(0.3), 0, math.cos(0.3)])
    assert principal_tilt(body, Shaft([0, 0, 0], along, [0, 1, 0])).angle == pytest.approx(0, abs=1e-12)
    assert principal_tilt(body, Shaft([0, 0, 0], -along, [0, 1, 0])).angle == pytest.approx(0, abs=1e-12)


def test_a_small_couple_moves_the_axis_by_the_sensitivity():
    tensor, couple = np.diag([1.0, 1.0, 1.05]), 1e-6
    still = principal_tilt(inertia.MassProperties(1.0, 0.0, [0, 0, 0], tensor), on_z())
    tensor[0, 2] = tensor[2, 0] = -couple
    bent = principal_tilt(inertia.MassProperties(1.0, 0.0, [0, 0, 0], tensor), on_z())
    assert still.angle == 0
    assert bent.angle == pytest.approx(couple * still.sensitivity, rel=1e-6)
    assert still.sensitivity == pytest.approx(20.0)


def test_equal_moments_leave_the_axis_open():
    tilt = principal_tilt(inertia.MassProperties(1.0, 0.0, [0, 0, 0], np.eye(3)), on_z())
    assert not tilt.certain
    assert tilt.sensitivity == math.inf


@pytest.mark.parametrize("tilt", [0.02, math.asin(40 / 401), 0.6])
def test_the_axle_of_the_textbooks_wheel_gives_the_torque_of_section_13_25(tilt):
    """ω × I ω of a symmetric rotor at the angle φ to its axle: ω² (I_p − I_t) sin φ cos φ, across the plane of both."""
    polar, transverse, speed = 0.9, 0.5, 40.0
    body = wheel(polar, transverse, tilt, 0.0)
    torque = complex(axle_torque(Unbalance.of(body, on_z()).couple, speed))
    vector = np.cross([0, 0, speed], body.inertia @ [0, 0, speed])
    assert torque == pytest.approx(complex(vector[0], vector[1]), rel=1e-12)
    assert abs(torque) == pytest.approx(speed**2 * (polar - transverse) * math.sin(tilt) * math.cos(tilt), rel=1e-12)


def test_the_bent_wheel_of_the_samples_is_balanced_statically_and_not_dynamically():
    props = inertia.mass_properties(inertia.read(path("bent_wheel.stl"), unit="mm"), 1.0)
    lean = Unbalance.of(props, on_z(-0.03, 0.03), radial_uncertainty=1e-9)
    known = np.array(catalogue()["bent_wheel.stl"]["closed_form"]["inertia"])
    assert lean.kind == "couple"
    assert lean.couple == pytest.approx(-known[0, 2], rel=3e-3)  # the mesh is inside the true wheel
    assert abs(complex(axle_torque(lean.couple, 100.0))) == pytest.approx(1e4 * known[0, 2], rel=3e-3)
    tilt = principal_tilt(props, on_z(-0.03, 0.03))
    assert tilt.angle == pytest.approx(math.asin(40 / 401), rel=0.03)
    assert tilt.direction == pytest.approx(0, abs=1e-9)
