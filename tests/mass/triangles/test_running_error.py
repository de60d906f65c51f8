"""Bounds from a second evaluation hold whatever the sums come from, are near the error, and are used up to a size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from statistics import median

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.benchmarks.extremes.cases import ball
from tests.benchmarks.meshes import wavy_torus
from tests.mesh.solids import facets

from inertia.mass.moments import Moments
from inertia.mass.triangles import arithmetic, running_error
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mass.triangles.moments_from_sums import moments_of
from inertia.mass.triangles.running_error import FEW, running_bounds
from inertia.mass.triangles.sums import Sums, in_float64, sum_triangles
from inertia.mesh.surface import Surface, Triangles
from inertia_meshes import rational

F = Fraction
OUTWARD = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
ROUNDED = 1 + F(1, 10**9)  # the bounds are sums in float64 themselves


def errors(triangles: Triangles, sums: Sums) -> list[Fraction]:
    """Return how far the ten sums of a closed surface are from the exact ones, twice that on the diagonal."""
    size = F(2) ** sums.exponent
    exact = rational.moments(triangles.corners()).moved(*(-F(k) for k in sums.origin.tolist()))
    exact = exact.scaled(size, size, size)
    true = [6 * exact.volume, *(24 * k for k in exact.first), *(120 * k for k in exact.second)]
    computed = [F(k) for k in sums.sums[:10].tolist()]
    computed[4:7] = [2 * k for k in computed[4:7]]
    return [abs(a - b) for a, b in zip(computed, true, strict=True)]


def assert_bounded(triangles: Triangles) -> None:
    sums = in_float64(sum_triangles(triangles), triangles)
    reach = max(1.0, float(np.ldexp(np.maximum(sums.high - sums.origin, sums.origin - sums.low), sums.exponent).max()))
    underflow = F(100 * triangles.count, 2**1022) * F(reach) ** 4
    for error, bound in zip(errors(triangles, sums), running_bounds(triangles, sums).tolist(), strict=True):
        assert not np.isfinite(bound) or error <= F(bound) * ROUNDED + underflow


def bounds_of(moments: Moments) -> list[Fraction]:
    return [moments.zeroth_bound, *moments.first_bound, *moments.second_bound]


def placed(vertices: np.ndarray, seed: int, power: float, offset: float, thickness: float) -> np.ndarray:
    """Return the vertices flattened, turned, moved off and scaled."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moved: np.ndarray = 10.0**power * ((vertices * [1.0, 1.0, thickness]) @ turn + offset * rng.normal(size=3))
    return moved


seeds = st.integers(0, 2**32 - 1)
powers = st.one_of(st.just(0.0), st.floats(-60, 60))
offsets = st.one_of(st.just(0.0), st.floats(-2, 8).map(lambda power: 10.0**power))
flattenings = st.one_of(st.just(1.0), st.floats(-12, 0).map(lambda power: 10.0**power))


@settings(deadline=None, max_examples=100)
@given(seeds, st.integers(1, 20), powers, offsets, flattenings)
def test_bounds_hold_for_unions_of_tetrahedra(
    seed: int, count: int, power: float, offset: float, thickness: float
) -> None:
    points = np.random.default_rng(seed).uniform(-1, 1, (4 * count, 3))
    faces = (np.array(OUTWARD) + 4 * np.arange(count)[:, None, None]).reshape(-1, 3)
    assert_bounded(Surface(placed(points, seed, power, offset, thickness), faces))


@settings(deadline=None, max_examples=60)
@given(seeds, powers, offsets, flattenings, st.booleans())
def test_bounds_hold_for_polyhedra(seed: int, power: float, offset: float, thickness: float, single: bool) -> None:
    vertices, faces = ball(1)
    vertices = vertices * np.random.default_rng(seed).uniform(0.5, 1, (len(vertices), 1))
    if single:
        assert_bounded(facets(Surface(placed(vertices, seed, 0.0, min(offset, 1e4), thickness), faces)))
    else:
        assert_bounded(Surface(placed(vertices, seed, power, offset, thickness), faces))


@settings(deadline=None, max_examples=200)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=12, max_size=12))
@example([0.0] * 12)
@example([5e-324, *[0.0] * 10, 1.0])
def test_bounds_hold_for_a_tetrahedron_of_any_coordinates(numbers: list[float]) -> None:
    assert_bounded(Surface(np.array(numbers).reshape(4, 3), OUTWARD))


@settings(deadline=None, max_examples=100)
@given(st.lists(st.integers(-3, 3), min_size=12, max_size=12), st.integers(-1060, 980), st.integers(0, 52))
def test_bounds_hold_where_products_cancel(numbers: list[int], power: int, offset: int) -> None:
    corners = np.ldexp(np.array(numbers, float).reshape(4, 3) + (2.0**offset if offset else 0.0), power)
    assert_bounded(Surface(corners, OUTWARD))


@pytest.mark.parametrize("splits", [3, 5])
def test_bounds_hold_for_more_triangles_than_they_are_used_for(splits: int) -> None:
    vertices, faces = ball(splits)
    assert_bounded(Surface(placed(vertices, 11, -3.0, 50.0, 1e-2), faces))


@settings(deadline=None, max_examples=60)
@given(seeds, st.integers(0, 9), st.floats(-1, 1))
def test_an_error_put_into_a_sum_is_found_whatever_the_bound_was_before(seed: int, row: int, size: float) -> None:
    """It is the sums at hand that are bounded, in whatever order and with whatever roundings they were formed."""
    vertices, faces = ball(1)
    triangles = Surface(placed(vertices, seed, 0.0, 1.0, 0.5), faces)
    sums = sum_triangles(triangles)
    wrong = sums.sums.copy()
    wrong[row] += size * wrong[12]
    before, after = running_bounds(triangles, sums), running_bounds(triangles, replace(sums, sums=wrong))
    off = errors(triangles, replace(sums, sums=wrong))
    assert all(error <= F(bound) * ROUNDED for error, bound in zip(off, after.tolist(), strict=True))
    assert after[row] <= float(off[row]) + 2 * before[row]
    assert np.delete(after, row).tolist() == np.delete(before, row).tolist()


# The parts of the bound, one by one: in the sum of them an error too many would not show.


def triangles_of_all_kinds() -> np.ndarray:
    """Return corners (n, 3, 3): compact, askew, flat, far off, and with coordinates of very different sizes."""
    rng = np.random.default_rng(21)
    plain = rng.uniform(-1, 1, (1200, 3, 3))
    flat = plain[:300] * [1.0, 1.0, 1e-3]
    far = plain[300:600] + 1e3 * rng.normal(size=(300, 1, 3))
    near = plain[600:900, :1] + 1e-3 * plain[600:900]
    uneven = plain[900:] * 10.0 ** rng.uniform(-6, 6, (300, 3, 3))
    return np.concatenate([plain, flat, far, near, uneven])


def test_each_factor_is_within_its_bound_and_some_come_near_it() -> None:
    corners, origin = triangles_of_all_kinds(), np.array([0.1, -0.7, 0.3])
    d, d_error, w, w_error = running_error.factors(corners, origin)
    nearest = {"d": 0.0, "corner": 0.0, "s": 0.0}
    for k, triangle in enumerate(corners.tolist()):
        exact = [[F(x) - F(o) for x, o in zip(point, origin.tolist(), strict=True)] for point in triangle]
        exact.append([sum(column, F(0)) for column in zip(*exact, strict=True)])
        a, b, c, _ = exact
        volume = sum((a[i - 2] * (b[i - 1] * c[i] - b[i] * c[i - 1]) for i in range(3)), F(0))
        parts = [("d", d[k], volume, d_error[k])]
        for i, vector in enumerate(exact):
            name = "s" if i == 3 else "corner"
            parts += [(name, w[j, i, k], vector[j], w_error[j, i, k]) for j in range(3)]
        for name, value, true, bound in parts:
            error = abs(F(value) - true)
            assert error <= F(bound) * ROUNDED
            nearest[name] = max(nearest[name], float(error) / bound if error else 0.0)
    assert w[3].tolist() == [[0.0] * len(corners)] * 3 + [[1.0] * len(corners)]
    assert not w_error[3].any()
    assert nearest["d"] > 0.6
    assert nearest["corner"] == 1
    assert nearest["s"] > 0.9


def test_what_the_differences_are_off_by_is_in_the_bound_of_d(monkeypatch: pytest.MonkeyPatch) -> None:
    """With differences that are off by a millionth, either way, all other roundings are nothing."""

    def off(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        difference = x - y
        sign = np.where(difference.view(np.int64) >> 20 & 1, 1.0, -1.0)
        return difference * (1 + 1e-6 * sign), 1e-6 * abs(difference)

    monkeypatch.setattr(running_error, "two_difference", off)
    corners = np.random.default_rng(24).uniform(-1, 1, (3000, 3, 3))
    d, d_error, _, _ = running_error.factors(corners, np.zeros(3))
    used = abs(d - np.linalg.det(corners)) / d_error
    assert 0.9 < used.max() <= 1


ROWS, COLUMNS = [3, 0, 1, 2, 0, 1, 2, 1, 2, 0], [3, 3, 3, 3, 0, 1, 2, 2, 0, 1]
"""Where the ten sums stand in the product of the matrices."""

Factors = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def bounds_from(factors: Factors, product: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    """Return the bounds on the errors of a product (4, 4) of factors with their bounds."""
    triangles = Surface(*ball(0))
    halves = np.array([1, 1, 1, 1, 2, 2, 2, 1, 1, 1])
    sums = np.concatenate([product[ROWS, COLUMNS] / halves, np.ones(3)])
    monkeypatch.setattr(running_error, "factors", lambda *_: [factor.copy() for factor in factors])
    return running_bounds(triangles, replace(sum_triangles(triangles), sums=sums))


@pytest.mark.parametrize("sign", [-1, 1])
def test_factors_that_are_off_as_far_as_they_may_be_use_up_the_bound(
    sign: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(22)
    d, d_error = rng.uniform(1, 2, 8), rng.uniform(0, 1e-6, 8)
    w, w_error = rng.uniform(1, 2, (4, 4, 8)), rng.uniform(0, 1e-6, (4, 4, 8))
    true_d, true_w = d + sign * d_error, w + sign * w_error
    product, true = np.einsum("n,ivn,jvn->ij", d, w, w), np.einsum("n,ivn,jvn->ij", true_d, true_w, true_w)
    bounds = bounds_from((d, d_error, w, w_error), product, monkeypatch)
    assert abs(true - product)[ROWS, COLUMNS] == pytest.approx(bounds, rel=1e-5)


@pytest.mark.parametrize("seed", range(10))
def test_the_rounding_of_the_product_of_two_factors_is_in_the_bound(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The sums bounded are those of the rounded products, so that nothing but their rounding is the error."""
    rng = np.random.default_rng(seed)
    d, w = rng.uniform(1, 1.01, 1), np.full((4, 4, 1), rng.uniform(1, 1.01))
    rounded, exact = F(float(d[0] * w[0, 0, 0])), F(float(d[0])) * F(float(w[0, 0, 0]))
    product, true = 4 * rounded * F(float(w[0, 0, 0])), 4 * exact * F(float(w[0, 0, 0]))
    bounds = bounds_from((d, 0 * d, w, 0 * w), np.full((4, 4), float(product)), monkeypatch)
    assert abs(F(float(product)) - true) <= F(bounds.min()) * ROUNDED


@pytest.mark.parametrize("columns", [1, 3, 4, 127, 128, 1000, 2047])
def test_a_product_of_matrices_is_known_beyond_float64(columns: int) -> None:
    """Rows of numbers of one size, of very different sizes, of zeros, and of both signs."""
    rng = np.random.default_rng(columns)
    y, w = rng.uniform(0.9, 1, (2, 4, columns))
    y[1] *= 10.0 ** rng.uniform(-20, 20, columns)
    y[2] *= 1e-3 * rng.choice([-1, 1], columns)
    w[1], w[2] = -1e30 * w[1], 0.0
    high, low, bound = running_error.split_product(y, w, abs(y).max(axis=1), abs(w).max(axis=1))
    for i in range(4):
        for j in range(4):
            true = sum((F(a) * F(b) for a, b in zip(y[i].tolist(), w[j].tolist(), strict=True)), F(0))
            assert abs(F(high[i, j]) + F(low[i, j]) - true) <= F(bound[i, j])
            most = F(abs(y[i]).max()) * F(abs(w[j]).max()) * columns
            assert F(bound[i, j]) <= most / 2**60


# What it is used for

BELOW, ABOVE = ball(3), wavy_torus(FEW + 1)


def test_the_two_meshes_lie_on_either_side_of_the_limit() -> None:
    assert len(BELOW[1]) == FEW < len(ABOVE[1]) < 1.1 * FEW


@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
def test_up_to_the_limit_the_nearer_bound_counts(stored: Callable[[Surface], Triangles]) -> None:
    triangles = stored(Surface(*BELOW))
    moments, plain = solid_moments(triangles, "float64"), moments_of(sum_triangles(triangles))
    assert (moments.zeroth, moments.first, moments.second) == (plain.zeroth, plain.first, plain.second)
    assert all(3 * near < far for near, far in zip(bounds_of(moments), bounds_of(plain), strict=True))


@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
def test_beyond_the_limit_sums_of_more_digits_say_how_far_off_they_are(stored: Callable[[Surface], Triangles]) -> None:
    triangles = stored(Surface(*ABOVE))
    moments, plain = solid_moments(triangles, "float64"), moments_of(sum_triangles(triangles))
    assert (moments.zeroth, moments.first, moments.second) == (plain.zeroth, plain.first, plain.second)
    assert all(30 * near < far for near, far in zip(bounds_of(moments), bounds_of(plain), strict=True))


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 1, 1e-3), (1, 1e-2, 1), (1, 1e-3, 1e-3)])
def test_bounds_of_more_triangles_are_near_the_error_in_any_shape(
    shape: tuple[float, float, float], compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not compiled:
        monkeypatch.setenv("INERTIA_NATIVE", "0")
    vertices, faces = wavy_torus(1500)
    for seed, offset in ((1, 0.0), (2, 30.0)):
        triangles = Surface(placed(vertices * shape, seed, 0.0, offset, 1.0), faces)
        moments = solid_moments(triangles, "float64")
        exact = rational.moments(triangles.corners()).moved(*(-k for k in moments.origin))
        true = [exact.volume, *exact.first, *exact.second]
        values = [moments.zeroth, *moments.first, *moments.second]
        for value, expected, bound in zip(values, true, bounds_of(moments), strict=True):
            assert abs(value - expected) <= bound <= 1.001 * abs(value - expected) + F(1, 10**25)


@pytest.mark.parametrize("kind", ["overflow", "not a number"])
def test_where_more_digits_leave_float64_the_plain_bound_counts(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def off(*_: object) -> None:
        raise OverflowError if kind == "overflow" else ValueError

    monkeypatch.setattr(arithmetic.double_double, "sum_in_double_double", off)
    triangles = Surface(*ABOVE)
    assert solid_moments(triangles, "float64") == moments_of(sum_triangles(triangles))


@pytest.mark.parametrize("mesh", [BELOW, ABOVE], ids=["below", "above"])
@settings(deadline=None, max_examples=12)
@given(seed=seeds, power=powers, offset=offsets, thickness=flattenings)
def test_moments_are_within_their_bounds_on_either_side_of_the_limit(
    mesh: tuple[np.ndarray, np.ndarray], seed: int, power: float, offset: float, thickness: float
) -> None:
    vertices, faces = mesh
    triangles = Surface(placed(vertices, seed, power, offset, thickness), faces)
    moments = solid_moments(triangles, "float64")
    exact = rational.moments(triangles.corners()).moved(*(-k for k in moments.origin))
    values = [moments.zeroth, *moments.first, *moments.second]
    true = [exact.volume, *exact.first, *exact.second]
    for value, expected, bound in zip(values, true, bounds_of(moments), strict=True):
        assert abs(value - expected) <= bound


@pytest.mark.parametrize("overflown", [np.inf, np.nan], ids=str)
def test_where_the_analysis_leaves_float64_the_other_bound_counts(overflown: float) -> None:
    sums = sum_triangles(Surface(*BELOW))
    assert moments_of(sums, running=np.full(10, overflown)) == moments_of(sums)


@pytest.mark.parametrize("far", [1e30, 1e70])
def test_bounds_hold_where_the_sample_that_sets_the_scale_misses_the_farthest_corner(far: float) -> None:
    vertices, faces = BELOW
    missed = np.setdiff1d(faces, faces[:: FEW // 64])
    vertices = np.where(np.arange(len(vertices))[:, None] == missed[0], far * vertices, vertices)
    triangles = Surface(vertices, faces)
    assert sum_triangles(triangles).exponent == 0
    assert_bounded(triangles)


def test_of_small_meshes_the_bound_is_within_a_hundred_times_of_the_error() -> None:
    ratios: list[list[float]] = [[] for _ in range(10)]
    for seed in range(60):
        vertices, faces = ball(1)
        vertices = vertices * np.random.default_rng(seed).uniform(0.5, 1, (len(vertices), 1))
        triangles = Surface(placed(vertices, seed, 0.0, 0.3, 1.0), faces)
        sums = sum_triangles(triangles)
        off = errors(triangles, sums)
        for row, (error, bound) in enumerate(zip(off, running_bounds(triangles, sums).tolist(), strict=True)):
            ratios[row].append(bound / float(error) if error else np.inf)
    assert all(1 <= median(of_row) < 100 for of_row in ratios)
