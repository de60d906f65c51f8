"""Double-double numbers hold thirty digits, as floats and as arrays."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.dynamics.special import double_double

EPSILON = Fraction(1, 2**102)
highs = st.floats(1e-20, 1e20)
lows = st.floats(-(2.0**-54), 2.0**-54)
pairs = st.builds(lambda high, low: double_double.two_sum(high, high * low), highs, lows)
signed = st.builds(lambda pair, sign: (sign * pair[0], sign * pair[1]), pairs, st.sampled_from([1.0, -1.0]))


def exact(pair: double_double.Pair) -> Fraction:
    return Fraction(float(pair[0])) + Fraction(float(pair[1]))


@settings(deadline=None)
@given(signed, signed)
def test_sum_is_off_by_a_part_of_its_terms(x: double_double.Pair, y: double_double.Pair) -> None:
    assert abs(exact(double_double.add(x, y)) - exact(x) - exact(y)) <= EPSILON * (abs(exact(x)) + abs(exact(y)))


@settings(deadline=None)
@given(signed, signed)
def test_product_and_quotient_are_off_by_a_part_of_themselves(x: double_double.Pair, y: double_double.Pair) -> None:
    product, quotient = exact(x) * exact(y), exact(x) / exact(y)
    assert abs(exact(double_double.multiply(x, y)) - product) <= EPSILON * abs(product)
    assert abs(exact(double_double.divide(x, y)) - quotient) <= EPSILON * abs(quotient)
    plain = exact(x) * Fraction(y[0])
    assert abs(exact(double_double.times(x, y[0])) - plain) <= EPSILON * abs(plain)


@settings(deadline=None)
@given(pairs)
def test_root_squares_to_its_argument(x: double_double.Pair) -> None:
    assert abs(exact(double_double.square_root(x)) ** 2 - exact(x)) <= 4 * EPSILON * exact(x)


@settings(deadline=None)
@given(st.floats(-1e9, 1e9), st.floats(-1e9, 1e9))
def test_sums_and_products_of_floats_are_exact(x: float, y: float) -> None:
    assert exact(double_double.two_sum(x, y)) == Fraction(x) + Fraction(y)
    if abs(x * y) > 1e-280:
        assert exact(double_double.two_product(x, y)) == Fraction(x) * Fraction(y)


@settings(deadline=None)
@given(st.lists(st.tuples(pairs, pairs), min_size=1, max_size=4))
def test_arrays_give_the_bits_of_floats(numbers: list[tuple[double_double.Pair, double_double.Pair]]) -> None:
    x, y = ((np.array([n[k][0] for n in numbers]), np.array([n[k][1] for n in numbers])) for k in (0, 1))
    for operation in (double_double.add, double_double.multiply, double_double.divide):
        answer = operation(x, y)
        for k, (p, q) in enumerate(numbers):
            assert operation(p, q) == (answer[0][k], answer[1][k])


@pytest.mark.parametrize("turns", [0, 1, 10**9, -(10**12), 2**54 + 3, -(10**18) - 1])
def test_reduction_leaves_a_phase_its_digits_after_any_number_of_turns(turns: int) -> None:
    with mp.workdps(60):
        phase = 2 * mp.pi * turns + mp.mpf(0.25)
        pair = float(phase), float(phase - mp.mpf(float(phase)))
        period = 2.0 * double_double.PI[0], 2.0 * double_double.PI[1]
        count, left = double_double.reduce((np.array(pair[0]), np.array(pair[1])), period)
    assert int(count[0]) + int(count[1]) == turns
    assert float(double_double.modulo(count, 4.0)) == turns % 4
    assert float(left[0]) == pytest.approx(0.25, abs=1e-18 + 1e-31 * abs(turns))


@settings(deadline=None)
@given(st.floats(-1e6, 1e6), st.floats(-(2.0**-54), 2.0**-54))
def test_sine_and_cosine_have_thirty_digits(high: float, low: float) -> None:
    pair = double_double.two_sum(high, high * low)
    with mp.workdps(60):
        angle = mp.mpf(pair[0]) + mp.mpf(pair[1])
        for found, true in zip(double_double.sine_and_cosine(pair), (mp.sin(angle), mp.cos(angle)), strict=True):
            assert abs(mp.mpf(found[0]) + mp.mpf(found[1]) - true) <= mp.mpf(2) ** -100 * (abs(true) + abs(angle) / 64)
    arrays = double_double.sine_and_cosine((np.array([pair[0]]), np.array([pair[1]])))
    assert [(float(x[0]), float(y[0])) for x, y in arrays] == list(double_double.sine_and_cosine(pair))


def test_a_fraction_is_rounded_to_thirty_digits() -> None:
    third = Fraction(1, 3)
    assert abs(exact(double_double.of_fraction(third)) - third) < EPSILON * third
