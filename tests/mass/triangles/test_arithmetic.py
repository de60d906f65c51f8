"""Bounds from sums of more digits hold whatever the sums come from, and are the error where that is float64's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.benchmarks.extremes.cases import ball
from tests.benchmarks.meshes import wavy_torus
from tests.mass.triangles.cases import (
    OUTWARD,
    assert_within_bounds,
    bounds_of,
    flattenings,
    offsets,
    placed,
    powers,
    seeds,
    tetrahedra,
    values_of,
)
from tests.mesh.solids import facets

from inertia.mass.triangles import arithmetic
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mass.triangles.double_double import ROUNDINGS, sum_in_double_double
from inertia.mass.triangles.moments_from_sums import distances, moments_of, roughest
from inertia.mass.triangles.sums import MANY, PlainSums, in_float64, sum_triangles
from inertia.mesh.surface import Surface, Triangles
from inertia_meshes import rational

F = Fraction
ROUNDED = 1 + F(1, 10**9)  # the bounds are sums in float64 themselves


def errors(triangles: Triangles, sums: PlainSums) -> list[Fraction]:
    """Return how far the ten sums of a closed surface are from the exact ones, twice that on the diagonal."""
    size = F(2) ** sums.exponent
    exact = rational.moments(triangles.corners()).moved(*(-F(k) for k in sums.origin.tolist()))
    exact = exact.scaled(size, size, size)
    true = [6 * exact.volume, *(24 * k for k in exact.first), *(120 * k for k in exact.second)]
    computed = [F(k) for k in sums.sums[:10].tolist()]
    computed[4:7] = [2 * k for k in computed[4:7]]
    return [abs(a - b) for a, b in zip(computed, true, strict=True)]


def measured(triangles: Triangles, sums: PlainSums) -> list[float]:
    """Return what double-double sums say of the errors of the sums."""
    high, low = sum_in_double_double(triangles, sums)
    return distances(sums, high, low, roughest(sums, ROUNDINGS.most(sums.count)))


def assert_bounded(triangles: Triangles) -> None:
    assert_within_bounds(
        triangles, solid_moments(triangles, "float64", in_float64(sum_triangles(triangles), triangles))
    )


@settings(deadline=None, max_examples=100)
@given(seeds, st.integers(1, 20), powers(60), offsets(8), flattenings)
def test_bounds_hold_for_unions_of_tetrahedra(
    seed: int, count: int, power: float, offset: float, thickness: float
) -> None:
    points = np.random.default_rng(seed).uniform(-1, 1, (4 * count, 3))
    assert_bounded(Surface(placed(points, seed, power, offset, thickness), tetrahedra(count)))


@settings(deadline=None, max_examples=60)
@given(seeds, powers(60), offsets(8), flattenings, st.booleans())
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
    before, after = measured(triangles, sums), measured(triangles, replace(sums, sums=wrong))
    off = errors(triangles, replace(sums, sums=wrong))
    assert all(error <= F(bound) * ROUNDED for error, bound in zip(off, after, strict=True))
    assert after[row] <= (1 + 1e-15) * float(off[row]) + 2 * before[row]
    assert np.delete(after, row).tolist() == np.delete(before, row).tolist()


BELOW, ABOVE = ball(3), wavy_torus(900)


def test_the_meshes_are_summed_in_float64() -> None:
    assert len(BELOW[1]) < len(ABOVE[1]) <= MANY


@pytest.mark.parametrize("mesh", [BELOW, ABOVE], ids=["below", "above"])
@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
def test_sums_of_more_digits_say_how_far_off_they_are(
    mesh: tuple[np.ndarray, np.ndarray], stored: Callable[[Surface], Triangles]
) -> None:
    triangles = stored(Surface(*mesh))
    moments, plain = solid_moments(triangles, "float64"), moments_of(sum_triangles(triangles))
    assert values_of(moments) == values_of(plain)
    assert all(10 * near < far for near, far in zip(bounds_of(moments), bounds_of(plain), strict=True))


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 1, 1e-3), (1, 1e-2, 1), (1, 1e-3, 1e-3)])
def test_bounds_of_more_triangles_are_near_the_error_in_any_shape(
    shape: tuple[float, float, float], compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not compiled:
        monkeypatch.setenv("INERTIA_NATIVE", "0")
    vertices, faces = wavy_torus(900)
    for seed, offset in ((1, 0.0), (2, 30.0)):
        triangles = Surface(placed(vertices * shape, seed, 0.0, offset, 1.0), faces)
        moments = solid_moments(triangles, "float64")
        for error, bound in zip(assert_within_bounds(triangles, moments), bounds_of(moments), strict=True):
            assert bound <= 1.001 * error + F(1, 10**25)


@pytest.mark.parametrize("kind", ["overflow", "not a number"])
def test_where_more_digits_leave_float64_the_plain_bound_counts(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def off(*_: object) -> None:
        raise OverflowError if kind == "overflow" else ValueError

    monkeypatch.setattr(arithmetic.double_double, "sum_in_double_double", off)
    triangles = Surface(*ABOVE)
    assert solid_moments(triangles, "float64") == moments_of(sum_triangles(triangles))


@pytest.mark.parametrize("mesh", [BELOW, ABOVE], ids=["below", "above"])
@settings(deadline=None, max_examples=12)
@given(seed=seeds, power=powers(60), offset=offsets(8), thickness=flattenings)
def test_moments_are_within_their_bounds_on_either_side_of_the_limit(
    mesh: tuple[np.ndarray, np.ndarray], seed: int, power: float, offset: float, thickness: float
) -> None:
    vertices, faces = mesh
    triangles = Surface(placed(vertices, seed, power, offset, thickness), faces)
    assert_within_bounds(triangles, solid_moments(triangles, "float64"))


@pytest.mark.parametrize("far", [1e30, 1e70])
def test_bounds_hold_where_the_sample_that_sets_the_scale_misses_the_farthest_corner(far: float) -> None:
    vertices, faces = BELOW
    missed = np.setdiff1d(faces, faces[:: len(faces) // 64])
    vertices = np.where(np.arange(len(vertices))[:, None] == missed[0], far * vertices, vertices)
    triangles = Surface(vertices, faces)
    assert sum_triangles(triangles).exponent == 0
    assert_bounded(triangles)


def test_of_small_meshes_the_bound_is_the_error() -> None:
    for seed in range(60):
        vertices, faces = ball(1)
        vertices = vertices * np.random.default_rng(seed).uniform(0.5, 1, (len(vertices), 1))
        triangles = Surface(placed(vertices, seed, 0.0, 0.3, 1.0), faces)
        sums = sum_triangles(triangles)
        size = float(sums.sums[12])
        for error, bound in zip(errors(triangles, sums), measured(triangles, sums), strict=True):
            assert error <= F(bound) <= error * ROUNDED + F(1e-28 * size)
