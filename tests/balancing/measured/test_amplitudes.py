"""Balancing without phase: machines whose unbalance is known, and what the runs leave open."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia import GeometryError, UsageError
from inertia.balancing.measured.amplitudes import amplitude_balance

THIRDS = np.exp(2j * np.pi * np.arange(3) / 3)


@given(st.floats(0.05, 20.0), st.floats(0.0, 6.28), st.floats(0.01, 100.0))
@settings(max_examples=100, deadline=None)
def test_four_runs_tell_where_the_unbalance_is(size, angle, sensitivity):
    unbalance, weights = cmath.rect(size, angle), np.array([0.0, *THIRDS])
    best, *others = amplitude_balance(sensitivity * np.abs(unbalance + weights), weights)
    assert best.unbalance == pytest.approx(unbalance, rel=1e-6)
    assert best.sensitivity == pytest.approx(sensitivity, rel=1e-6)
    assert best.misfit < 1e-9
    assert all(other.misfit > 1e-7 for other in others)


def test_three_runs_leave_two_places_and_one_of_them_is_it():
    unbalance, weights = 1.7 - 0.6j, np.array([0.0, 1.0, 1.0j])
    fits = amplitude_balance(2.0 * np.abs(unbalance + weights), weights)
    assert len(fits) == 2
    assert max(fit.misfit for fit in fits) < 1e-9
    assert min(abs(fit.unbalance - unbalance) for fit in fits) < 1e-9


def test_weights_on_one_line_leave_the_two_sides_of_it():
    unbalance, weights = cmath.rect(1.2, 0.4), np.array([0.0, 1.0, -1.0, 2.0])
    fits = amplitude_balance(np.abs(unbalance + weights), weights)
    assert sorted(round(cmath.phase(fit.unbalance), 9) for fit in fits) == [-0.4, 0.4]


@pytest.mark.parametrize("unit", [1e-6, 1e-4, 1.0, 1e3])
@pytest.mark.parametrize("sensitivity", [1e-3, 1.0, 1e7])
def test_places_are_the_same_in_all_units(unit, sensitivity):
    # Three weights at different angles leave one place, however small weights are beside amplitudes.
    unbalance, weights = cmath.rect(6.0, math.radians(130)) * unit, np.array([0.0, *(5.0 * THIRDS)]) * unit
    (only,) = amplitude_balance(sensitivity * np.abs(unbalance + weights), weights)
    assert only.unbalance == pytest.approx(unbalance, rel=1e-9)
    assert only.sensitivity == pytest.approx(sensitivity, rel=1e-9)


def test_a_drawing_with_circles_agrees():
    # 8 g at 60° with 10 g at 0°, 120° and 240°, by the law of cosines: |8∠60° + 10∠0°|² = 64 + 100 + 80.
    sizes = [8.0, math.sqrt(64 + 100 + 80), math.sqrt(64 + 100 + 80), 2.0]
    best = amplitude_balance(sizes, [0.0, *(10 * THIRDS)])[0]
    assert abs(best.unbalance) == pytest.approx(8.0, rel=1e-9)
    assert math.degrees(cmath.phase(best.unbalance)) == pytest.approx(60.0, abs=1e-7)


def test_noise_of_one_percent_costs_a_few_percent():
    random = np.random.default_rng(3)
    unbalance, weights = 1.0 + 0.5j, np.array([0.0, *THIRDS])
    errors = [
        abs(amplitude_balance(np.abs(unbalance + weights) * (1 + 0.01 * random.normal(size=4)), weights)[0].unbalance
            - unbalance)
        for _ in range(50)
    ]  # fmt: skip
    assert np.sqrt(np.mean(np.square(errors))) < 0.05


@pytest.mark.parametrize(
    ("amplitudes", "weights", "error", "words"),
    [
        ([1.0, 2.0], [0, 1], UsageError, "it takes a run without weight and two or more"),
        ([1.0, 2.0, 2.0], [1, 1j, -1], UsageError, "it takes a run without weight"),
        ([1.0, 2.0, 2.0], [0, 1], UsageError, "give one of each a run"),
        (
            [3.0, 4.0, 7.0],
            [0, 4, 4 * cmath.exp(2j * math.pi)],
            UsageError,
            "2 different weights are given, one of them",
        ),
        ([3.0, 4.0, 7.0], [0, 4, -4 * cmath.exp(1j * math.pi)], UsageError, "2 different weights are given, one of"),
        ([0.0, 0.0, 0.0], [0, 1, 1j], GeometryError, "all amplitudes are zero"),
        ([1.0, 1.0, 1.0], [0, 1, 2], GeometryError, "no unbalance explains the amplitudes"),
    ],
)
def test_what_cannot_be_answered_is_refused(amplitudes, weights, error, words):
    with pytest.raises(error, match=words):
        amplitude_balance(amplitudes, weights)


def test_a_weight_that_is_logged_twice_beside_others_counts_as_one():
    unbalance, weights = 1.7 - 0.6j, np.array([0.0, 1.0, cmath.exp(2j * math.pi), 1.0j])
    fits = amplitude_balance(2.0 * np.abs(unbalance + weights), weights)
    assert min(abs(fit.unbalance - unbalance) for fit in fits) < 1e-9
    assert max(fit.misfit for fit in fits) < 1e-9
