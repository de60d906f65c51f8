"""Eigenvalues and vectors within bounds, against matrices made of rational rotations and against 80 digits."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mass.spectra import Rows, angle, eigenvalues, frame, plus, turned

from inertia.mass.eigen import Spectrum, frame_near, spectrum

F = Fraction
NONE = [[F(0)] * 3] * 3
seeds = st.integers(0, 2**32 - 1)
TINY = F(1, 10**70)


def assert_bounded(decomposition: Spectrum, values: list[Fraction], axes: Rows | None = None) -> None:
    slack = TINY * max(abs(k) for k in values)  # of the oracle
    for value, bound, true in zip(decomposition.values, decomposition.value_bounds, values, strict=True):
        assert abs(value - true) <= bound + slack
    if axes is not None:
        for k, sine in enumerate(decomposition.sines):
            if sine < 1:
                assert angle(decomposition.vectors[:, k], [row[k] for row in axes]) <= np.arcsin(float(sine)) + 2.0**-52


@settings(deadline=None, max_examples=150)
@given(
    seeds,
    st.lists(st.fractions(0, 1, max_denominator=1000), min_size=3, max_size=3),
    st.sampled_from([F(1, 10**30), F(1), F(10**30), F(1, 2**1000), F(2) ** 1000]),
)
def test_exact_matrices_are_diagonalised_to_sixty_digits(seed: int, moments: list[Fraction], scale: Fraction) -> None:
    values = sorted(scale * k for k in moments)
    axes = frame(seed)
    decomposition = spectrum(turned(values, axes), NONE, F(0))
    assert_bounded(decomposition, values, axes)
    assert max(decomposition.value_bounds) <= values[2] / 2**100 + F(1, 2**300)
    # The elements of 10⁻⁶ and more that these moments have are told apart.
    for k in range(3):
        gap = min(abs(values[k] - values[j]) for j in range(3) if j != k)
        assert (decomposition.sines[k] < F(1, 10**15)) == (gap > 0)


@settings(deadline=None, max_examples=150)
@given(
    seeds,
    st.tuples(st.floats(-12, 0), st.floats(-12, 0)),
    st.floats(-20, 0),
    st.sampled_from([1e-30, 1.0, 1e30]),
)
def test_a_matrix_that_is_off_has_its_true_values_within_the_bounds(
    seed: int, gaps: tuple[float, float], power: float, scale: float
) -> None:
    """The true matrix is known exactly; the one given is off by all that its bound allows, in a random direction."""
    first = F(scale)
    values = [first, first * (1 + F(10.0 ** gaps[0]))]
    values.append(values[1] + first * F(10.0 ** gaps[1]))
    axes = frame(seed)
    twist = np.random.default_rng(seed).normal(size=(3, 3))
    twist *= scale * 10.0**power / np.linalg.norm(twist + twist.T)
    bound = F(scale) * F(10.0**power) * F(1 + 1e-12)
    given_matrix = plus(turned(values, axes), twist + twist.T)
    assert_bounded(spectrum(given_matrix, [[bound] * 3] * 3, bound), values, axes)


@settings(deadline=None, max_examples=150)
@given(seeds, st.floats(1, 12), st.floats(-16, -1), st.booleans())
def test_bounds_of_single_elements_hold_for_graded_matrices(
    seed: int, aspect: float, power: float, askew: bool
) -> None:
    """Element ij is off by up to a part of w_i w_j, as the sums of a needle are, whose smallest value stays certain."""
    rng = np.random.default_rng(seed)
    widths = [F(1), F(1) / int(10.0**aspect), F(1) / int(10.0**aspect)]
    base = frame(seed) if askew else turned([1, 1, 1], frame(seed))
    values = [F(2) * widths[1] ** 2, 1 + widths[1] ** 2, F(3, 2)]
    true = turned(values, base)
    limits = [[F(10.0**power) * widths[i] * widths[j] for j in range(3)] for i in range(3)]
    if not askew:  # the long axis of the body is the first, where the moment is smallest
        limits = [
            [limits[i][j] if i != j else limits[1][1] if i == 0 else limits[0][0] for j in range(3)] for i in range(3)
        ]
    signs = np.triu(rng.uniform(-1, 1, (3, 3)))
    signs = signs + np.triu(signs, 1).T
    matrix = [[true[i][j] + limits[i][j] * F(signs[i, j]) for j in range(3)] for i in range(3)]
    norm = sum((k for row in limits for k in row), F(0))
    decomposition = spectrum(matrix, limits, norm)
    assert_bounded(decomposition, values, base)
    if not askew and power < -3:
        assert decomposition.value_bounds[0] <= 10 * F(10.0**power) * values[0]


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_any_matrix_agrees_with_eighty_digits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(3, 3)) * 10.0 ** rng.uniform(-12, 0, (3, 3))
    rows = [[F(k) for k in row] for row in (a + a.T).tolist()]
    decomposition = spectrum(rows, NONE, F(0))
    assert_bounded(decomposition, eigenvalues(rows))
    assert max(decomposition.value_bounds) <= F(1, 2**55) * max(abs(k) for k in decomposition.values)


@pytest.mark.parametrize("gap", [10.0**-k for k in range(3, 31, 3)])
def test_values_as_near_as_can_be_are_told_apart_where_nothing_is_uncertain(gap: float) -> None:
    values = [F(1), F(1) + F(gap), F(3)]
    axes = frame(7)
    decomposition = spectrum(turned(values, axes), NONE, F(0))
    assert_bounded(decomposition, values, axes)
    assert max(decomposition.sines) < F(1, 10**15)


def test_equal_values_have_no_vectors_of_their_own() -> None:
    axes = frame(3)
    for values, own in (([1, 1, 1], ()), ([1, 1, 2], (2,)), ([1, 2, 2], (0,))):
        decomposition = spectrum(turned(values, axes), NONE, F(0))
        assert [k for k in range(3) if decomposition.sines[k] < 1] == list(own)
        assert_bounded(decomposition, [F(k) for k in values], axes)


def test_a_matrix_of_zeros_has_any_vectors() -> None:
    decomposition = spectrum(NONE, [[F(1, 10)] * 3] * 3, F(1, 10))
    assert decomposition.values == (0, 0, 0)
    assert decomposition.sines == (1, 1, 1)
    assert all(F(1, 10) <= bound < F(101, 1000) for bound in decomposition.value_bounds)


@pytest.mark.parametrize("seed", range(6))
def test_a_rational_frame_is_far_finer_than_the_figures_that_are_rounded_from_it(seed: int) -> None:
    """A spin along an axis but for 1e-16 of itself keeps sixteen digits of that, and more where it grows."""
    rng = np.random.default_rng(seed)
    free = rng.normal(size=(3, 3))
    tensor = free @ free.T + np.eye(3)
    rows = [[Fraction(x) for x in row] for row in ((tensor + tensor.T) / 2).tolist()]
    fine = frame_near(rows, np.linalg.eigh(tensor)[1])
    along = list(zip(*fine.rows, strict=True))  # the axes, in those of the matrix
    for i, j in ((0, 1), (1, 2), (2, 0)):
        image = [sum((rows[m][n] * along[j][n] for n in range(3)), Fraction(0)) for m in range(3)]
        off = sum((x * y for x, y in zip(along[i], image, strict=True)), Fraction(0))
        assert abs(off) < abs(fine.values[i] - fine.values[j]) / 2**200
