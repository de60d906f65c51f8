"""One formula serves floats and arrays."""

import math

import numpy as np
import pytest

from inertia.dynamics.special import elementary


@pytest.mark.parametrize("name", ["sqrt", "sin", "cos", "exp", "tanh", "arctan", "rint"])
def test_floats_give_floats_and_arrays_the_same_in_arrays(name: str) -> None:
    function = getattr(elementary, name)
    values = [0.0, 0.5, 1.5, 2.5, 40.25]
    alone = [function(x) for x in values]
    assert all(type(x) is float for x in alone)
    assert function(np.array(values)) == pytest.approx(alone, rel=4e-16, abs=0)
    assert alone == pytest.approx([float(getattr(np, name)(x)) for x in values], rel=4e-16, abs=0)


def test_exponents_come_off_and_go_back_on() -> None:
    for value in (3.0, np.array([3.0, -1e-300])):
        part, exponent = elementary.frexp(value)
        assert np.all(elementary.ldexp(part, exponent) == value)
        assert np.all((abs(part) >= 0.5) & (abs(part) < 1.0))


def test_number_makes_any_float_a_python_float_and_the_rest_arrays() -> None:
    assert type(elementary.number(np.float64(2.5))) is float
    assert elementary.number([1, 2]).dtype == np.float64
    assert elementary.number(3).shape == ()


def test_larger_one_of_floats_and_of_arrays() -> None:
    assert elementary.maximum(1.0, 2.0) == 2.0
    assert elementary.maximum(1.0, np.array([0.0, 2.0])).tolist() == [1.0, 2.0]
    assert elementary.maximum(np.array([0.0, 2.0]), 1.0).tolist() == [1.0, 2.0]


@pytest.mark.parametrize("holds", [True, False])
def test_choice_between_floats_tuples_and_arrays(holds: bool) -> None:
    chosen = 1.0 if holds else 2.0
    assert elementary.where(holds, 1.0, 2.0) == chosen
    assert elementary.where(np.array([holds, True]), 1.0, 2.0).tolist() == [chosen, 1.0]
    assert elementary.select(holds, (1.0, 1.0), (2.0, 2.0)) == (chosen, chosen)
    first, _ = elementary.select(np.array([holds, True]), (1.0, 1.0), (2.0, 2.0))
    assert first.tolist() == [chosen, 1.0]
    assert elementary.anywhere(holds) is holds
    assert elementary.anywhere(np.array([False, holds])) is holds


def test_columns_of_one_row_are_floats() -> None:
    assert elementary.columns(np.array([1.0, 2.0])) == (1.0, 2.0)
    assert [type(x) for x in elementary.columns(np.ones((1, 1, 3)))] == [float] * 3
    assert [x.tolist() for x in elementary.columns(np.arange(4.0).reshape(2, 2))] == [[0.0, 2.0], [1.0, 3.0]]
    assert math.prod(elementary.columns(np.empty((0, 2)))[0].shape) == 0


def test_packing_undoes_columns_and_broadcasts() -> None:
    rows = np.arange(6.0).reshape(2, 3)
    assert elementary.packed(elementary.columns(rows), (2,)).tolist() == rows.tolist()
    assert elementary.packed((1.0, 2.0), (1, 1)).tolist() == [[[1.0, 2.0]]]
    assert elementary.packed((True, np.array([False, True])), (2,), bool).tolist() == [[True, False], [True, True]]
