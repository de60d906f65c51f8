"""Trial weights: their size, where they go, and whether the machine answered."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia import UsageError
from inertia.balancing.measured.trial_weights import (
    trial_response,
    trial_weight,
    unbalance_for_change,
    unbalance_for_force,
    unbalance_for_weight,
)


def test_a_tenth_of_the_weight_as_centrifugal_force():
    speed = 3000 * math.pi / 30
    unbalance = unbalance_for_weight(100.0, speed)
    assert unbalance * speed**2 == pytest.approx(98.0665)
    assert trial_weight(unbalance, 0.2, speed).force == pytest.approx(98.0665)
    assert trial_weight(unbalance, 0.2, speed).mass == pytest.approx(unbalance / 0.2)


def test_sizes_from_a_force_and_from_a_change_of_vibration():
    assert unbalance_for_force(50.0, 10.0) == 0.5
    assert unbalance_for_change(6.0, 3.0 - 4.0j) == pytest.approx(1.2)


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("lag", [0.1, 1.5, 3.0])
def test_a_weight_placed_by_the_lag_lowers_the_vibration_most(rotation, lag):
    """The rotor's heavy spot is at 1 rad: behind it, in the sense of rotation, comes the vibration."""
    turn = 1 if rotation == "ccw" else -1
    coefficient = cmath.exp(-1j * turn * lag)
    unbalance = cmath.rect(3e-3, 1.0)
    weight = trial_weight(1e-3, 0.1, 100.0, reading=coefficient * unbalance, lag=lag, rotation=rotation)
    assert weight.angle == pytest.approx(1.0 + math.pi)
    assert abs(coefficient * (unbalance + cmath.rect(1e-3, weight.angle))) == pytest.approx(2e-3)


def test_without_a_lag_no_place_is_named():
    assert trial_weight(1e-3, 0.1, 100.0, reading=1.0).angle is None


@pytest.mark.parametrize(
    ("after", "enough"),
    [
        (129.0, False),
        (131.0, True),
        (71.0, False),
        (69.0, True),
        (cmath.rect(100, math.radians(29)), False),
        (cmath.rect(100, math.radians(-31)), True),
    ],
)
def test_thirty_per_cent_or_thirty_degrees(after, enough):
    assert trial_response([100.0], [after]).enough is enough


def test_one_sensor_that_answers_is_enough_and_changes_are_stated():
    trial = trial_response([1.0, 1.0j], [1.05, -1.5])
    assert trial.enough
    assert trial.amplitude_change == pytest.approx([0.05, 0.5])
    assert trial.phase_change == pytest.approx([0.0, math.pi / 2])
    assert trial.note.endswith("enough")


@settings(deadline=None)
@given(st.floats(1e-3, 0.29), st.floats(-math.pi, math.pi))
def test_the_factor_is_certain_to_be_enough_and_not_wasteful(size, angle):
    change = cmath.rect(size, angle)
    trial = trial_response([1.0], [1.0 + change])
    assert not trial.enough
    assert trial_response([1.0], [1.0 + 1.0001 * trial.factor * change]).enough
    assert trial.factor * size < 0.67


def test_no_change_at_all_points_to_the_sensors():
    trial = trial_response([1.0], [1.0])
    assert math.isinf(trial.factor)
    assert "check the sensors" in trial.note


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: unbalance_for_force(0.0, 1.0), "force is 0.0"),
        (lambda: unbalance_for_weight(1.0, 0.0), "speed is 0.0"),
        (lambda: unbalance_for_weight(-1.0, 1.0), "mass is -1.0"),
        (lambda: unbalance_for_change(1.0, 0.0), "coefficient is 0.0"),
        (lambda: trial_weight(1.0, np.inf, 1.0), "radius is inf"),
        (lambda: trial_weight(1.0, 1.0, 1.0, rotation="left"), "'ccw' or 'cw'"),
        (lambda: trial_response([1.0], [1.0, 2.0]), "the same readings"),
        (lambda: trial_response([0.0], [1.0]), "leave that sensor out"),
    ],
)
def test_bad_input_is_refused_by_name(call, text):
    with pytest.raises(UsageError, match=text):
        call()
