"""Min-max balancing: a published case, other solvers, and certificates that hold by themselves."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from inertia import UsageError, influence_correction
from inertia.balancing.measured.min_max import min_max_in_discs


def polar(text):
    size, angle = text.split("@")
    return cmath.rect(float(size), math.radians(float(angle)))


# Foiles, Allaire and Gunter (2000), Min-max optimum flexible rotor balancing compared to weighted least squares,
# C576/097/2000; as the test cases of hsbalance 0.5.5 (test/config.yaml) have it.
FOILES = np.array(
    [
        [polar(one) for one in row.split()]
        for row in """9.8@117 17@124 7.2@114 38.5@77
        2.7@43 14.3@317 4.5@213 14.3@270
        12.5@323 25@261 15.2@158 30@238
        22.4@92 32.6@45 23.3@315 27.8@210
        26@94 40.3@9 25@330 34@213
        40.3@355 43@144 29.6@61 65.4@322
        20.6@339 32.3@152 36.7@41 61.8@322
        12.6@226 37.6@52 18.8@153 26@176
        13.4@209 26.9@76 47.5@98 71.7@312
        13.4@154 22.4@307 52@299 102@165
        5.4@24 7.2@199 22.4@2 27.8@99""".splitlines()
    ]
)
FOILES_INITIAL = np.array(
    [
        polar(one)
        for one in [
            "55@259",
            "45@118",
            "124@21",
            "138@349",
            "107@349",
            "90@280",
            "58@354",
            "108@201",
            "88@190",
            "56@48",
            "73@158",
        ]
    ]
)


def by_polygons(matrix, target, limits, sides):
    """Return a bound below the least largest residual: discs replaced by the polygons around them, by HiGHS."""
    rows, planes = matrix.shape
    turns = np.exp(-2j * np.pi * np.arange(sides) / sides)
    blocks, right = [], []
    for k in range(rows):
        turned = turns[:, None] * matrix[k]
        blocks.append(np.column_stack([turned.real, -turned.imag, -np.ones(sides)]))
        right.append(-(turns * target[k]).real)
    for j in np.flatnonzero(np.isfinite(limits)):
        block = np.zeros((sides, 2 * planes + 1))
        block[:, j], block[:, planes + j] = turns.real, -turns.imag
        blocks.append(block)
        right.append(np.full(sides, limits[j]))
    solution = linprog(
        np.eye(2 * planes + 1)[-1],
        np.concatenate(blocks),
        np.concatenate(right),
        bounds=[(None, None)] * (2 * planes + 1),
    )
    return solution.fun


def test_the_published_case_is_met():
    found = influence_correction(FOILES_INITIAL, FOILES, criterion="min-max")
    assert np.abs(found.residual).max() == pytest.approx(69.9, abs=0.05)
    published = [polar(one) for one in ("4.42@88", "2.92@352", "1.588@322", "1.928@304")]
    assert np.abs(found.unbalance - published).max() < 0.09
    assert np.abs(found.residual).max() <= np.abs(FOILES_INITIAL + FOILES @ published).max()
    assert found.gap < 2e-7
    squares = influence_correction(FOILES_INITIAL, FOILES)
    assert np.linalg.norm(squares.residual) < np.linalg.norm(found.residual)
    assert np.abs(squares.residual).max() > np.abs(found.residual).max()


def test_the_published_case_with_limited_weights_is_met():
    found = influence_correction(FOILES_INITIAL, FOILES, limits=3.402, criterion="min-max")
    published = np.array([polar(one) for one in ("3.402@91", "2.325@354", "1.361@318", "1.786@305")])
    assert found.unbalance == pytest.approx(published, abs=0.15)
    assert np.abs(found.unbalance).max() <= 3.402
    assert np.abs(found.residual).max() <= np.abs(FOILES_INITIAL + FOILES @ published).max()
    assert found.limited == (0,)


@pytest.mark.parametrize("limits", [np.full(4, np.inf), np.full(4, 3.402), np.array([1.0, np.inf, 0.5, np.inf])])
def test_polygons_and_linear_programming_say_the_same(limits):
    x, least = min_max_in_discs(FOILES, FOILES_INITIAL, limits)
    top = np.abs(FOILES_INITIAL + FOILES @ x).max()
    sides = 720
    below = by_polygons(FOILES, FOILES_INITIAL, limits, sides)
    assert below <= top * (1 + 1e-9)
    assert below == pytest.approx(top, rel=3 * (1 - math.cos(math.pi / sides)) + 1e-7)
    assert least <= top <= least * (1 + 2e-7)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_no_weights_within_the_limits_do_better_than_the_bound(seed):
    random = np.random.default_rng(seed)
    planes = int(random.integers(1, 5))
    rows = int(random.integers(planes, 4 * planes + 3))
    matrix = random.normal(size=(rows, planes)) + 1j * random.normal(size=(rows, planes))
    target = random.normal(size=rows) + 1j * random.normal(size=rows)
    limits = np.where(random.random(planes) < 0.4, np.inf, random.random(planes))
    x, least = min_max_in_discs(matrix, target, limits)
    top = np.abs(target + matrix @ x).max()
    assert (np.abs(x) <= limits).all()
    assert least <= top
    if top > 1e-9:
        assert top <= least * (1 + 2e-7)
    tries = x + 0.3 * random.normal(size=(2000, planes)) * np.exp(2j * np.pi * random.random((2000, planes)))
    tries *= np.minimum(1.0, limits / np.abs(tries))
    assert np.abs(target + tries @ matrix.T).max(axis=1).min() >= least


def test_one_plane_is_a_smallest_circle():
    # One weight that acts alike on all sensors moves the centre of the circle about their readings: of an equilateral
    # triangle of side 2 the radius is 2/√3.
    readings = np.array([1.0, -1.0, 1j * math.sqrt(3.0)])
    found = influence_correction(readings, np.ones((3, 1)), criterion="min-max")
    assert found.unbalance[0] == pytest.approx(-1j / math.sqrt(3.0), abs=1e-6)
    assert np.abs(found.residual) == pytest.approx(np.full(3, 2.0 / math.sqrt(3.0)), abs=1e-6)


def test_readings_that_can_all_be_met_are():
    found = influence_correction([1.0, 2.0j], [[1.0, 2.0], [1.0j, -1.0]], criterion="min-max")
    assert np.abs(found.residual).max() < 1e-12
    assert found.gap == 0.0


def test_an_unknown_criterion_is_refused():
    with pytest.raises(UsageError, match="criterion is 'minmax': use one of 'least squares', 'min-max'"):
        influence_correction([1.0], [[1.0]], criterion="minmax")
