"""Weights from kits against all combinations tried."""

import itertools
import math

import numpy as np
import pytest

from inertia.balancing.corrections.correction_plane import CorrectionPlane, KitWeight
from inertia.balancing.corrections.search import Search
from inertia.balancing.corrections.standard_weights import WeightTool, weight_operation
from inertia.balancing.corrections.steps import steps_of


def chosen(plane, start, limit=1.0):
    """Return the plan for a vector that a plane's kit has to take away, and the weights' (angle, mass)."""
    steps = [steps_of(0, WeightTool(plane, 0.0, weight=weight), abs(start)) for weight in plane.kit]
    plan = Search(steps, np.ones((len(steps), 1), complex) / limit, np.array([start]) / limit).plan()
    return plan, sorted((steps[k].angles[a], steps[k].tool.weight.mass) for k, a, _ in plan.spots)


def test_case_9_the_smallest_error_over_sixteen_holes():
    angles = np.radians(30 + 7.5 * np.arange(16))
    expected = 178.484 + 614.491j
    counts = np.array(list(itertools.product((0, 1), repeat=16)))
    smallest = np.abs(142 * counts @ np.exp(1j * angles) - expected).min()
    plane = CorrectionPlane("I", 0.0, "kit", 1.0, angles=tuple(angles.tolist()), kit=(KitWeight("142", 142.0),))
    plan, _ = chosen(plane, -expected)
    assert plan.worst == pytest.approx(smallest, rel=1e-9)
    assert smallest == pytest.approx(2.10035, abs=5e-4)  # the note's, from a vector with more digits


def test_caps_on_positions_and_stocks_hold():
    kit = (KitWeight("one", 1.0), KitWeight("two", 2.0, stock=1))
    plane = CorrectionPlane("I", 0.0, "kit", 1.0, angles=(0.0, 0.5 * math.pi), kit=kit)
    plan, weights = chosen(plane, -2 - 2j, 0.5)
    assert plan.worst == pytest.approx(2.0)
    assert sorted(mass for _, mass in weights) == [1.0, 2.0]


def test_no_weight_is_used_where_there_is_no_need():
    plane = CorrectionPlane("I", 0.0, "kit", 1.0, angles=(0.0, 0.5 * math.pi), kit=(KitWeight("one", 1.0),))
    assert chosen(plane, 0.3 + 0.2j, 0.5)[0].spots == ()


def test_a_kit_operation_states_pieces_and_total_mass():
    plane = CorrectionPlane("II", 0.2, "kit", 0.05, angles=(1.0,), kit=(KitWeight("M6", 0.004),))
    operation = weight_operation(plane, "II-1", 1.0, plane.kit[0], 3)
    assert (operation.item, operation.pieces, operation.method, operation.kind) == ("M6", 3, "add", "weight")
    assert operation.mass == pytest.approx(0.012)
    assert abs(operation.unbalance) == pytest.approx(0.0006)
    assert math.isclose(np.angle(operation.unbalance), 1.0)
