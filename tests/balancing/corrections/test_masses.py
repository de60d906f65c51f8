import cmath
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.masses import MassTool, equal_pair, split
from inertia.errors import UsageError


def test_case_10_a_correction_is_split_onto_the_allowed_angles_beside_it():
    vector = cmath.rect(37.3, math.radians(52))
    first, second = split(vector, math.radians(45), math.radians(60))
    assert first == pytest.approx(20.06, abs=0.005)
    assert second == pytest.approx(17.56, abs=0.005)


def test_case_10_two_equal_weights_are_spread_about_it():
    low, high = equal_pair(cmath.rect(37.3, math.radians(52)), 25.0)
    assert math.degrees(low) == pytest.approx(52 - 41.75, abs=0.005)
    assert math.degrees(high) == pytest.approx(52 + 41.75, abs=0.005)


@given(st.floats(0, 2 * math.pi), st.floats(0.05, 3), st.floats(0, 1), st.floats(1e-6, 1e6))
def test_the_two_parts_are_together_the_vector(first, between, share, size):
    vector = cmath.rect(size, first + share * between)
    a, b = split(vector, first, first + between)
    assert cmath.rect(a, first) + cmath.rect(b, first + between) == pytest.approx(vector, abs=1e-8 * size)


@given(st.floats(0, 2 * math.pi), st.floats(0, 2))
def test_the_two_equal_weights_are_together_the_vector(angle, size):
    vector = cmath.rect(size, angle)
    low, high = equal_pair(vector, 1.0)
    assert cmath.rect(1, low) + cmath.rect(1, high) == pytest.approx(vector, abs=1e-7)


def test_split_refuses_angles_that_the_vector_is_not_between():
    with pytest.raises(UsageError, match="at 70° does not lie between 45° and 60°: name the allowed angles"):
        split(cmath.rect(1, math.radians(70)), math.radians(45), math.radians(60))


def test_split_refuses_opposite_angles():
    with pytest.raises(UsageError, match="lie on one line"):
        split(1.0, 0.0, math.pi)


def test_equal_pair_refuses_weights_that_are_too_small():
    with pytest.raises(UsageError, match="make up 20 at most, not 21: take larger ones"):
        equal_pair(21.0, 10.0)


@pytest.mark.parametrize(("method", "sign"), [("add", 1), ("remove", -1)])
def test_a_mass_acts_where_it_is_added_and_opposite_where_it_is_removed(method, sign):
    tool = MassTool(CorrectionPlane("I", 0.09, method, 0.05), 0.0)
    operation = tool.operation("I-1", math.radians(-30), tool.setting(2e-4))
    assert operation.method == method
    assert operation.mass == pytest.approx(4e-3)
    assert operation.unbalance == pytest.approx(sign * cmath.rect(2e-4, math.radians(330)))
    assert math.degrees(operation.angle) == pytest.approx(330)
