"""Weights from vibration readings: worked cases, machines whose answer is known, and certified least squares."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia import GeometryError, UsageError
from inertia.balancing.measured.bounded_least_squares import least_squares_in_discs
from inertia.balancing.measured.influence import influence_coefficients, influence_correction
from inertia.balancing.measured.readings import readings


def polar(vectors):
    return np.abs(vectors), np.degrees(np.angle(vectors)) % 360


def machine(seed, readings_shape, planes):
    random = np.random.default_rng(seed)
    shape = (*readings_shape, planes)
    coefficients = random.normal(size=shape) + 1j * random.normal(size=shape)
    unbalance = random.normal(size=planes) + 1j * random.normal(size=planes)
    return random, coefficients, unbalance


def above_the_least(matrix, target, limits, x):
    """Return how far |target + matrix x|² can at most be above its least within the limits.

    The function is convex: what its tangent at x leaves to gain within the discs, it cannot exceed.
    """
    slope = 2 * matrix.conj().T @ (target + matrix @ x)
    return float((slope.conj() @ x).real + limits @ np.abs(slope))


def test_case_7_influence_coefficients_of_two_planes():
    initial = readings([170, 53], [112, 78])
    trials = [readings([235, 58], [94, 68]), readings([185, 77], [115, 104])]
    correction = influence_correction(initial, influence_coefficients(initial, trials, [1.15, 1.15]))
    size, angle = polar(correction.unbalance)
    assert size == pytest.approx([1.979, 1.071], abs=5e-4)
    assert angle == pytest.approx([236.2, 121.8], abs=0.05)
    assert np.abs(correction.residual).max() < 1e-12 * 170
    assert correction.notes == ()


def test_case_8_two_planes_with_trial_weights_at_angles():
    initial = readings([8.5, 6.5], [60, 205])
    trials = [readings([6, 4.5], [125, 230]), readings([6, 10.5], [35, 160])]
    coefficients = influence_coefficients(initial, trials, readings([10, 12], [270, 180]))
    correction = influence_correction(initial, coefficients)
    size, angle = polar(-correction.unbalance)
    assert size == pytest.approx([10.0561, 5.8774], abs=5e-5)
    assert angle == pytest.approx([145.555, 248.256], abs=5e-4)


@pytest.mark.parametrize(("shape", "planes"), [((1,), 1), ((2,), 2), ((3, 4), 3), ((2, 5), 6)])
def test_a_linear_machine_is_balanced_at_all_its_speeds_and_sensors(shape, planes):
    random, coefficients, unbalance = machine(1, shape, planes)
    weights = random.normal(size=planes) + 1j
    initial = coefficients @ unbalance
    trials = [initial + coefficients[..., k] * weights[k] for k in range(planes)]
    correction = influence_correction(initial, influence_coefficients(initial, trials, weights))
    assert correction.unbalance == pytest.approx(-unbalance, abs=1e-11)
    assert np.abs(correction.residual).max() < 1e-11


def test_trial_weights_may_stay_on_and_runs_be_repeated():
    _, coefficients, unbalance = machine(2, (4,), 2)
    mounted = np.array([[1.0, 0.0], [1.0, 0.5j], [0.0, 0.5j]])
    initial = coefficients @ unbalance
    trials = [coefficients @ (unbalance + row) for row in mounted]
    assert influence_coefficients(initial, trials, mounted) == pytest.approx(coefficients, abs=1e-12)


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("phase", ["lead", "lag"])
def test_the_sense_of_phase_and_rotation_is_honoured(rotation, phase):
    """Signals in time are the oracle: a rotor turned by its own angles, and phases read off the motion."""
    turns = np.arange(512) / 512
    sign = 1 if rotation == "ccw" else -1
    responses = [0.8 * cmath.exp(-0.4j), 1.3 * cmath.exp(-2.2j)]

    def shown(unbalance):
        heavy_spot = abs(unbalance) * np.cos(2 * np.pi * sign * turns + cmath.phase(unbalance))
        sideways = abs(unbalance) * np.sin(2 * np.pi * sign * turns + cmath.phase(unbalance))
        assert np.allclose(heavy_spot + 1j * sideways, unbalance * np.exp(2j * np.pi * sign * turns))
        amplitudes, phases = [], []
        for response in responses:
            spectrum = np.fft.fft(heavy_spot)[1] / 256 * response
            amplitudes.append(abs(spectrum))
            phases.append(math.degrees(cmath.phase(spectrum)) * (1 if phase == "lead" else -1))
        return readings(amplitudes, phases, phase=phase, rotation=rotation)

    unbalance, trial = 2.0 * cmath.exp(0.7j), 1.0 * cmath.exp(2.0j)
    coefficients = influence_coefficients(shown(unbalance), [shown(unbalance + trial)], [trial])
    correction = influence_correction(shown(unbalance), coefficients)
    assert correction.unbalance[0] == pytest.approx(-unbalance, abs=1e-9)


def test_the_importance_of_readings_draws_the_compromise():
    """Two readings that one weight cannot both cancel: the weighted mean of what each asks for."""
    correction = influence_correction([1.0, 3.0], [[1.0], [1.0]], importance=[1.0, 3.0])
    assert correction.unbalance[0] == pytest.approx(-2.5)
    assert correction.residual == pytest.approx([-1.5, 0.5])


def test_a_limit_on_one_plane_shortens_its_weight_and_turns_nothing():
    correction = influence_correction([3.0 + 4.0j], [[1.0]], limits=2.0)
    assert correction.unbalance[0] == pytest.approx(-2.0 * (0.6 + 0.8j), rel=1e-6)
    assert correction.limited == (0,)
    assert abs(correction.residual[0]) == pytest.approx(3.0, rel=1e-6)
    assert "limit of 2" in correction.notes[0]


def test_a_plane_without_room_gets_no_weight():
    correction = influence_correction([1.0, 1.0j], [[2.0, 0.1], [0.1, 4.0]], limits=[0.0, np.inf])
    assert correction.unbalance[0] == 0
    assert correction.unbalance[1] == pytest.approx(-(0.1 + 4.0j) / 16.01)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.integers(1, 5), st.integers(0, 4), st.sampled_from([0.0, 1e-3]))
def test_least_squares_within_limits_is_the_least_there_is(seed, planes, more, alike):
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(planes + more, planes)) + 1j * random.normal(size=(planes + more, planes))
    if alike and planes > 1:
        matrix[:, -1] = matrix[:, 0] + alike * matrix[:, -1]
    target = random.normal(size=planes + more) + 1j * random.normal(size=planes + more)
    limits = np.exp(random.normal(-1, 2, planes))
    x = least_squares_in_discs(matrix, target, limits)
    assert (np.abs(x) <= limits * (1 + 1e-12)).all()
    assert above_the_least(matrix, target, limits, x) <= 1e-9 * np.linalg.norm(target) ** 2


def test_sensors_that_hardly_tell_the_planes_apart_are_named_in_a_note():
    correction = influence_correction([1.0, 1.0], [[1.0, 1.0], [1.0, 1.1]])
    lengths = np.array([math.sqrt(2.0), math.sqrt(2.21)])
    cosine = 2.1 / lengths.prod()
    assert correction.condition == pytest.approx(math.sqrt((1 + cosine) / (1 - cosine)))
    assert "condition 42" in correction.notes[-1]


def test_condition_does_not_depend_on_the_units_of_a_plane():
    _, coefficients, unbalance = machine(3, (4,), 3)
    there = influence_correction(coefficients @ unbalance, coefficients).condition
    assert influence_correction(coefficients @ unbalance, coefficients * [1.0, 1e6, 1e-3]).condition == pytest.approx(
        there
    )


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda: influence_coefficients([1.0], [[2.0]], [0.0]), UsageError, "mount a weight in every plane"),
        (lambda: influence_coefficients([1.0], [[2.0], [3.0]], [1.0]), UsageError, "one trial run for each row"),
        (lambda: influence_correction([1.0], [[1.0, 2.0]]), UsageError, "1 readings count for 2 planes"),
        (
            lambda: influence_correction([1.0, 1.0], [[1.0, 2.0], [0.0, 1.0]], importance=[1.0, 0.0]),
            UsageError,
            "1 readings count for 2 planes",
        ),
        (lambda: influence_correction([1.0, 1.0], [[1.0, 2.0], [2.0, 4.0]]), GeometryError, "planes apart"),
        (lambda: influence_correction([1.0], [1.0, 2.0]), UsageError, "one axis more"),
        (lambda: influence_correction([np.nan], [[1.0]]), UsageError, "not finite"),
        (lambda: influence_correction([1.0], [[1.0]], limits=-1.0), UsageError, "limits are"),
        (lambda: readings(-1.0, 0.0), UsageError, "not negative"),
        (lambda: readings(1.0, 0.0, phase="behind"), UsageError, "'lead' or 'lag'"),
    ],
)
def test_what_cannot_be_answered_is_refused_in_one_sentence(call, error, text):
    with pytest.raises(error, match=text):
        call()
