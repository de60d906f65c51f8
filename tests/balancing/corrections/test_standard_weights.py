"""Weights from kits against all combinations tried."""

import itertools
import math

import numpy as np
import pytest

from inertia.balancing.corrections.correction_plane import CorrectionPlane, KitWeight
from inertia.balancing.corrections.standard_weights import choose_weights, weight_operation


def combinations(effects, start, limits, most):
    """Return all counts (k, n) and their largest residual over the limit (k,)."""
    counts = np.array(list(itertools.product(*(range(k + 1) for k in most))))
    return counts, (np.abs(start + counts @ effects.T) / limits).max(axis=1)


def test_case_9_the_smallest_error_over_sixteen_holes():
    turns = np.exp(1j * np.radians(30 + 7.5 * np.arange(16)))
    expected = 178.484 + 614.491j
    counts = np.array(list(itertools.product((0, 1), repeat=16)))
    smallest = np.abs(142 * counts @ turns - expected).min()
    choice = choose_weights([142 * turns], [-expected], [1.0], [1] * 16, aim="smallest")
    assert abs(choice.residual[0]) == pytest.approx(smallest, rel=1e-12)
    assert smallest == pytest.approx(2.10035, abs=5e-4)  # the note's, from a vector with more digits
    assert not choice.within


@pytest.mark.parametrize("seed", range(8))
def test_fewest_within_the_tolerance_and_of_those_the_smallest_residual(seed):
    draw = np.random.default_rng(seed)
    planes, places = 1 + seed % 2, 5
    effects, start = (draw.normal(size=k) + 1j * draw.normal(size=k) for k in ((planes, places), (planes,)))
    limits, most = draw.uniform(0.5, 1.5, planes), np.array([2, 1, 2, 3, 1])
    counts, worst = combinations(effects, start, limits, most)
    choice = choose_weights(effects, start, limits, most)
    reached = (np.abs(choice.residual) / limits).max()
    assert choice.residual == pytest.approx(start + effects @ choice.counts)
    if (worst <= 1).any():
        fewest = counts[worst <= 1].sum(axis=1).min()
        assert choice.within
        assert choice.counts.sum() == fewest
        assert reached == pytest.approx(worst[counts.sum(axis=1) == fewest].min(), abs=1e-5)
    else:
        assert not choice.within
        assert reached == pytest.approx(worst.min(), abs=1e-5)


def test_caps_on_positions_and_stocks_hold():
    turns = np.exp(1j * np.radians([0, 0, 90, 90]))
    effects = [np.array([1, 2, 1, 2]) * turns]
    groups = [((0, 1), 1), ((2, 3), 1), ((1, 3), 1)]  # one weight at each position, one large one in all
    choice = choose_weights(effects, [-2 - 2j], [10.0], [5] * 4, groups, aim="smallest")
    assert abs(choice.residual[0]) == pytest.approx(1.0)
    assert choice.counts.sum() == 2
    assert choice.counts[[1, 3]].sum() == 1


def test_no_weight_is_used_where_there_is_no_need():
    choice = choose_weights([[1.0, 1j]], [0.3 + 0.2j], [0.5], [3, 3])
    assert choice.counts.tolist() == [0, 0]
    assert choice.within


def test_planes_without_steps_make_up_for_what_weights_leave():
    effects, free = np.array([[1.0, 1j], [0.5, 0.5j]]), np.array([[0.0], [1.0]])
    choice = choose_weights(effects, [-2.4 - 1j, -9.0], [0.5, 0.5], [5, 5], free=free)
    assert choice.counts.tolist() == [2, 1]
    assert choice.residual[0] == pytest.approx(-0.4)
    assert abs(-9 + effects[1] @ choice.counts + choice.free[0]) <= 0.4 + 1e-5


def test_a_kit_operation_states_pieces_and_total_mass():
    plane = CorrectionPlane("II", 0.2, "kit", 0.05, angles=(1.0,), kit=(KitWeight("M6", 0.004),))
    operation = weight_operation(plane, "II-1", 1.0, plane.kit[0], 3)
    assert (operation.item, operation.pieces, operation.method, operation.kind) == ("M6", 3, "add", "weight")
    assert operation.mass == pytest.approx(0.012)
    assert abs(operation.unbalance) == pytest.approx(0.0006)
    assert math.isclose(np.angle(operation.unbalance), 1.0)
