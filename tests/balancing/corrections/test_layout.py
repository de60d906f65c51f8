"""Where holes go: what they make up, and that nothing forbidden is done."""

import cmath
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.balancing.corrections.workpieces import STEEL, drilled

from inertia.balancing.corrections.correction_plane import CorrectionPlane, Sector, evenly
from inertia.balancing.corrections.drilling import AxialDrill, RadialDrill
from inertia.balancing.corrections.layout import arrange
from inertia.balancing.corrections.masses import MassTool

SECTOR = Sector(math.radians(350), math.radians(40))
FREE = drilled("I", 90, 100, 8, 10, 12, max_depth=20)


def tools(plane):
    return [RadialDrill(plane, STEEL, diameter=k) for k in plane.diameters]


def total(arrangement):
    """Return what the places make up, added up one by one."""
    return sum(cmath.rect(arrangement.tool.unbalance(setting), angle) for angle, setting in arrangement.places)


def apart(arrangement):
    """Return the least angle between two places."""
    angles = sorted(angle for angle, _ in arrangement.places)
    return min((b - a for a, b in itertools.pairwise([*angles, angles[0] + 2 * math.pi])), default=2 * math.pi)


def keeps_to_its_plane(arrangement):
    plane = arrangement.tool.plane
    assert all(-1e-12 <= setting <= plane.max_depth + 1e-12 for _, setting in arrangement.places)
    assert not any(plane.forbids(angle, arrangement.tool.half_angle - 1e-9) for angle, _ in arrangement.places)
    if plane.angles != "free":
        assert all(min(abs(angle - k) for k in plane.angles) < 1e-12 for angle, _ in arrangement.places)
    if len(arrangement.places) > 1:
        assert apart(arrangement) >= arrangement.tool.apart - 1e-9


@given(st.floats(1e-6, 4e-3), st.floats(0, 2 * math.pi))
@settings(deadline=None)
def test_free_holes_make_up_any_vector_in_reach(size, angle):
    vector = cmath.rect(size, angle)
    arrangement = arrange(tools(FREE), vector)
    assert total(arrangement) == pytest.approx(vector, abs=1e-12 * size + 1e-18)
    keeps_to_its_plane(arrangement)


def test_one_hole_of_the_smallest_drill_that_reaches():
    for size, diameter in ((5e-4, 0.008), (8e-4, 0.010), (1.2e-3, 0.012)):
        arrangement = arrange(tools(FREE), size)
        assert (arrangement.tool.diameter, len(arrangement.places)) == (diameter, 1)


def test_holes_side_by_side_where_one_is_too_deep():
    arrangement = arrange(tools(FREE), 3e-3j)
    most = arrangement.tool.unbalance(arrangement.tool.greatest)
    assert arrangement.tool.diameter == 0.012
    assert most < 3e-3 <= len(arrangement.places) * most
    assert cmath.phase(total(arrangement)) == pytest.approx(math.pi / 2)


def test_two_shallow_holes_that_partly_cancel_where_one_is_too_much_already():
    smallest = tools(FREE)[0]
    size = 0.3 * smallest.unbalance(0.0)
    arrangement = arrange([smallest], size)
    assert [setting for _, setting in arrangement.places] == [0.0, 0.0]
    assert total(arrangement) == pytest.approx(size)


def test_a_vector_out_of_reach_is_approached_and_the_rest_stated():
    arrangement = arrange(tools(FREE), 1.0)
    keeps_to_its_plane(arrangement)
    assert arrangement.short == pytest.approx(1.0 - total(arrangement))
    assert total(arrangement).real == pytest.approx(abs(total(arrangement)))
    assert {setting for _, setting in arrangement.places} == {arrangement.tool.greatest}


@given(st.floats(2e-4, 2e-3), st.floats(0, 2 * math.pi))
@settings(deadline=None, max_examples=25)
def test_a_forbidden_sector_is_left_alone_and_made_up_for_from_beside_it(size, angle):
    plane = drilled("I", 90, 100, 12, max_depth=20, forbidden=(SECTOR,))
    vector = cmath.rect(size, angle)
    arrangement = arrange(tools(plane), vector)
    keeps_to_its_plane(arrangement)
    assert total(arrangement) == pytest.approx(vector, rel=1e-6)


@given(st.floats(2e-4, 1.5e-3), st.floats(0, 2 * math.pi))
@settings(deadline=None, max_examples=25)
def test_listed_angles_make_up_a_vector_from_both_sides(size, angle):
    plane = drilled("I", 90, 100, 12, max_depth=25, angles=evenly(12, 0.1))
    vector = cmath.rect(size, angle)
    arrangement = arrange(tools(plane), vector)
    keeps_to_its_plane(arrangement)
    # Two small holes side by side take at least what their points take: that much may be left.
    assert abs(vector - total(arrangement)) <= tools(plane)[0].unbalance(0.0)


def test_listed_angles_leave_no_more_than_the_best_of_all_subsets():
    plane = drilled("I", 90, 100, 12, max_depth=10, angles=tuple(np.radians([20, 75, 110, 200])))
    tool = tools(plane)[0]
    least, most = tool.unbalance(0.0), tool.unbalance(tool.greatest)
    vector = cmath.rect(3e-3, 1.0)
    turns = np.exp(1j * np.array(plane.angles))
    amounts = [0.0, *np.linspace(least, most, 25)]
    best = min(abs(vector - np.dot(k, turns)) for k in itertools.product(amounts, repeat=4))
    arrangement = arrange([tool], vector)
    assert abs(vector - total(arrangement)) <= best * (1 + 1e-9)


def test_holes_through_are_moved_apart_until_they_make_up_the_vector():
    plane = CorrectionPlane("I", 0.1, "drill_axial", 0.085, diameters=(0.01,), face="b", through=True, max_depth=0.02)
    tool = AxialDrill(plane, STEEL, diameter=0.01)
    each = tool.unbalance(0.02)
    for factor in (0.2, 0.99, 1.5, 2.4):
        arrangement = arrange([tool], factor * each * 1j)
        assert total(arrangement) == pytest.approx(factor * each * 1j, rel=1e-9)
        assert {setting for _, setting in arrangement.places} == {0.02}
        assert apart(arrangement) >= tool.apart


def test_listed_masses_are_split_onto_the_angles_beside():
    plane = CorrectionPlane("I", 0.1, "add", 1.0, angles=tuple(np.radians([30, 45, 60, 75])))
    arrangement = arrange([MassTool(plane, 0.0)], cmath.rect(37.3, math.radians(52)))
    masses = {round(math.degrees(angle)): setting for angle, setting in arrangement.places}
    assert masses == {45: pytest.approx(20.06, abs=0.005), 60: pytest.approx(17.56, abs=0.005)}


def test_a_kept_arrangement_keeps_its_tool_and_number_while_it_reaches():
    first = arrange(tools(FREE), 5.4e-4)
    again = arrange(tools(FREE), 5.3e-4 + 1e-6j, first)
    assert (again.tool, len(again.places)) == (first.tool, len(first.places))
    beyond = arrange(tools(FREE), 3e-3, first)
    assert total(beyond) == pytest.approx(3e-3)
