"""Stability and the distance from the separatrix, against eigenvalues in mpmath and exact fractions."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from inertia.dynamics.kinematics.stability import (
    energy_bounds,
    growth_rate,
    separatrix_distance,
    stable_axes,
    wobble_frequencies,
)
from inertia.errors import GeometryError, UsageError

moment = st.floats(0.5, 1)  # any three of them obey the triangle rule
three_moments = st.tuples(moment, moment, moment)
component = st.floats(-1, 1)


def eigenvalues_about(axis: int, moments: tuple[float, ...], speed: float) -> list[mp.mpc]:
    """Return the eigenvalues of Euler's equations linearised about a spin, in 30 digits."""
    with mp.workdps(30):
        i, j, k = ((axis + n) % 3 for n in range(3))
        a = mp.mpf(moments[k]) - moments[i]
        b = mp.mpf(moments[i]) - moments[j]
        return list(mp.eig(mp.matrix([[0, a / moments[j] * speed], [b / moments[k] * speed, 0]]), right=False))


@settings(deadline=None, max_examples=50)
@given(three_moments, st.floats(0.1, 100))
def test_wobble_and_growth_are_the_eigenvalues_of_eulers_equations(moments: tuple[float, ...], speed: float) -> None:
    i1, i2, i3 = sorted(moments)
    assume(i1 < i2 - 1e-3 < i3 - 2e-3)
    values = [eigenvalues_about(axis, moments, speed) for axis in range(3)]
    frequencies = [max(float(value.imag) for value in pair) for pair in values]
    growth = max(float(value.real) for pair in values for value in pair)
    assert wobble_frequencies(moments, speed) == pytest.approx(frequencies, rel=1e-13)
    assert growth_rate(moments, speed) == pytest.approx(growth, rel=1e-13)
    assert (wobble_frequencies(moments, speed) > 0).tolist() == stable_axes(moments, tolerance=1e-4).tolist()


def test_formulas_of_the_chapter() -> None:
    """Textbook eq. 13.171–173: Ω1 = ω √(1.5·1/5), Ω3 = ω √(0.5·1.5/2), |Ω2| = ω √(1·0.5/2.5) at ω = 3."""
    assert wobble_frequencies([1, 2, 2.5], 3.0) == pytest.approx([3 * 0.3**0.5, 0.0, 3 * 0.375**0.5], rel=1e-15)
    assert growth_rate([1, 2, 2.5], 3.0) == pytest.approx(3 * 0.2**0.5, rel=1e-15)


def test_equal_moments_neither_wobble_nor_grow() -> None:
    assert wobble_frequencies([2, 2, 3], 3.0).tolist() == [0.0, 0.0, 1.5]
    assert growth_rate([[2, 2, 3], [1, 2, 2], [2, 2, 2]], 3.0).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("moments", "free", "dissipating"),
    [
        ([1, 2, 2.5], [True, False, True], [False, False, True]),
        ([2.5, 1, 2], [True, True, False], [True, False, False]),
        ([2, 2, 3], [False, False, True], [False, False, True]),
        ([1, 2, 2], [True, False, False], [False, False, False]),
        ([2, 2, 2], [True, True, True], [True, True, True]),
        ([2, 2 + 1e-9, 3], [False, False, True], [False, False, True]),
    ],
)
def test_stable_axes(moments: list[float], free: list[bool], dissipating: list[bool]) -> None:
    """The fourth is Explorer 1: a pencil that spins about its length ends about an axis across it."""
    assert stable_axes(moments).tolist() == free
    assert stable_axes(moments, dissipation=True).tolist() == dissipating


@settings(deadline=None)
@given(three_moments, st.tuples(component, component, component))
def test_energy_lies_between_its_bounds_and_reaches_them_on_the_axes(
    moments: tuple[float, ...], omega: tuple[float, ...]
) -> None:
    energy = 0.5 * np.dot(moments, np.square(omega))
    low, high = energy_bounds(moments, np.linalg.norm(np.multiply(moments, omega)))
    assert low * (1 - 1e-14) <= energy <= high * (1 + 1e-14)
    least, greatest = np.argmax(moments), np.argmin(moments)
    assert energy_bounds(moments, moments[least] * 3)[0] == pytest.approx(4.5 * moments[least], rel=1e-15)
    assert energy_bounds(moments, moments[greatest] * 3)[1] == pytest.approx(4.5 * moments[greatest], rel=1e-15)


@pytest.mark.parametrize("bad", [np.nan, np.inf, "fast", None, np.ma.masked_all(2), 1j], ids=str)
def test_speeds_and_momenta_are_finite_numbers(bad: object) -> None:
    for call in (growth_rate, wobble_frequencies, energy_bounds):
        with pytest.raises(UsageError, match=r"^(speed|momentum) (must be a number|holds a value that is not finite)"):
            call([1, 2, 3], bad)


def test_a_momentum_is_a_size() -> None:
    with pytest.raises(UsageError, match=r"momentum is -1 kg m²/s: it is a size, \|L\|, and not negative"):
        energy_bounds([1, 2, 3], [1.0, -1.0])


def exact_distance(moments: list[float], omega: list[float]) -> Fraction:
    i, w = [Fraction(m) for m in moments], [Fraction(x) for x in omega]
    square = sum(m * m * x * x for m, x in zip(i, w, strict=True))
    return (sum(m * x * x for m, x in zip(i, w, strict=True)) * sorted(i)[1] - square) / square


@settings(deadline=None)
@given(three_moments, st.tuples(component, component, component), st.floats(-14, -1))
def test_distance_has_all_digits_however_close_to_the_separatrix(
    moments: tuple[float, ...], omega: tuple[float, ...], exponent: float
) -> None:
    i1, i2, i3 = sorted(moments)
    assume(i1 < i2 < i3 and abs(omega[0]) > 1e-3)
    on_it = omega[0] * (i1 * (i2 - i1) / (i3 * (i3 - i2))) ** 0.5
    assume(0 < on_it < 1e3)
    spin = [omega[0], omega[1], on_it * (1 + 10**exponent)]
    distance, expected = float(separatrix_distance([i1, i2, i3], spin)), exact_distance([i1, i2, i3], spin)
    assert abs(Fraction(distance) - expected) <= Fraction(2e-15) * abs(expected)


@pytest.mark.parametrize("scale", [1e-150, 1.0, 1e150])
def test_distance_depends_on_neither_size_nor_speed_nor_order(scale: float) -> None:
    expected = float(exact_distance([1.0, 1.5, 2.0], [0.3, 0.4, 0.5]))
    moments, omega = scale * np.array([1.5, 1.0, 2.0]), np.array([0.4, 0.3, 0.5]) / scale
    assert separatrix_distance(moments, omega) == pytest.approx(expected, rel=1e-14)


def test_distance_says_which_axis_the_polhode_goes_round() -> None:
    spins = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert separatrix_distance([1.0, 1.5, 2.0], spins) == pytest.approx([1.5 / 1 - 1, 0.0, 1.5 / 2 - 1], abs=1e-15)


def test_a_rotor_is_on_its_separatrix_and_stable_about_its_axis_as_prolate_bodies_are() -> None:
    assert separatrix_distance([1, 0, 1], [[0.3, 2.0, -1.0], [0, 0, 1]]).tolist() == [0.0, 0.0]
    assert stable_axes([1, 0, 1]).tolist() == stable_axes([1, 1e-3, 1]).tolist() == [False, True, False]


def test_unusable_arguments_are_named() -> None:
    with pytest.raises(
        GeometryError,
        match=r"angular_velocity\[1\] is \[0.0, 0.0, 0.0\] rad/s: a body that has no angular momentum has",
    ):
        separatrix_distance([1, 2, 3], [[1, 0, 0], [0, 0, 0]])
    with pytest.raises(GeometryError, match=r"is \[2.0, 0.0, 0.0\] rad/s: a body that has no angular momentum"):
        separatrix_distance([0, 1, 1], [2, 0, 0])
    with pytest.raises(GeometryError, match="none may be negative, and one of them 0 at most"):
        stable_axes([0, 0, 1])
    with pytest.raises(GeometryError, match=r"moments are .* all three must be positive, as divisors"):
        energy_bounds([0, 1, 1], 1.0)
    with pytest.raises(GeometryError, match=r"moments are \[0.0, 1.0, 1.0\] kg m²: all three must be positive"):
        wobble_frequencies([0, 1, 1])
    with pytest.raises(UsageError, match="speed holds a value that is not finite"):
        growth_rate([1, 2, 3], float("nan"))
