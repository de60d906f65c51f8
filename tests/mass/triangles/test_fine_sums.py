"""Sums with the digits that float64 loses: within their bounds of rational arithmetic, in any place and order."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
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
    true_moments,
    values_of,
)
from tests.mesh.solids import cube, facets

from inertia import native
from inertia.mass.triangles import arithmetic, sums
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mass.triangles.fine_sums import Sample
from inertia.mass.triangles.kernels import BLOCK
from inertia.mass.triangles.moments_from_sums import fine_values, moments_of
from inertia.mass.triangles.sums import (
    Frame,
    PlainSums,
    SumsOnGrid,
    block_rows,
    frame_of,
    in_float64,
    local_frame,
    sum_in,
    sum_triangles,
    sums_of,
)
from inertia.mesh.surface import Surface, Triangles

F = Fraction
Storage = Callable[[Surface], Triangles]
STORAGES = pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])


@pytest.fixture(scope="module", autouse=True)
def of_any_size() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("INERTIA_NATIVE", raising=False)
        for limit in ("SHIPPED_ABOVE", "LOAD_ABOVE", "COMPILE_ABOVE"):
            patch.setattr(native, limit, 0)
        patch.setattr(sums, "MANY", 0)
        yield


def assert_fine(triangles: Triangles) -> None:
    """Check the fine sums themselves, and the moments whose bounds they are compared for."""
    own = sum_triangles(triangles)
    moments = solid_moments(triangles, "float64", own)
    assert_within_bounds(triangles, moments)
    answer = fine_values(own)
    if answer is None:
        return
    factors = [6, 24, 24, 24, 60, 60, 60, 120, 120, 120]
    twice = [1, 1, 1, 1, 2, 2, 2, 1, 1, 1]
    reach = max(1.0, float(np.maximum(own.high - own.origin, own.origin - own.low).max()))
    underflow = F(100 * triangles.count, 2**1022) * F(reach) ** 4
    (numbers, d), bounds = answer
    true = true_moments(triangles, moments)
    for number, expected, bound, factor, times in zip(numbers, true, bounds, factors, twice, strict=True):
        assert times * abs(F(number, d) - factor * expected) <= F(bound) + underflow


def assert_near(triangles: Triangles) -> None:
    moments = solid_moments(triangles, "float64")
    errors = assert_within_bounds(triangles, moments)
    ratios = sorted(
        bound / max(error, abs(value) / 2**53)  # the figure is rounded to float64
        for error, value, bound in zip(errors, values_of(moments), bounds_of(moments), strict=True)
        if value
    )
    assert ratios[len(ratios) // 2] < 64


@settings(deadline=None, max_examples=60)
@given(seeds, st.integers(1, 40), powers(25), offsets(12), flattenings)
def test_bounds_hold_for_unions_of_tetrahedra(
    seed: int, count: int, power: float, offset: float, thickness: float
) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (count, 4, 3)) * 10.0 ** rng.uniform(-4, 0, (count, 1, 1))
    assert_fine(Surface(placed(points.reshape(-1, 3), seed, power, offset, thickness), tetrahedra(count)))


@settings(deadline=None, max_examples=30)
@given(seeds, powers(25), offsets(12), flattenings, st.booleans())
def test_bounds_hold_for_polyhedra(seed: int, power: float, offset: float, thickness: float, single: bool) -> None:
    vertices, faces = ball(2)
    vertices = vertices * np.random.default_rng(seed).uniform(0.9, 1, (len(vertices), 1))
    if single:
        assert_fine(facets(Surface(placed(vertices, seed, 0.0, min(offset, 1e4), thickness), faces)))
    else:
        assert_fine(Surface(placed(vertices, seed, power, offset, thickness), faces))


@settings(deadline=None, max_examples=60)
@given(seeds, powers(25), offsets(12), flattenings, flattenings, st.booleans())
def test_bounds_hold_for_needles_and_foils_that_lie_askew(
    seed: int, power: float, offset: float, thickness: float, width: float, single: bool
) -> None:
    vertices, faces = ball(2)
    rng = np.random.default_rng(seed)
    stretched = vertices * rng.uniform(0.9, 1, (len(vertices), 1)) @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    own = placed(stretched, seed // 2 * 2, power, offset, thickness, width)
    assert_fine(Surface(own.astype(np.float32).astype(np.float64) if single else own, faces))


@settings(deadline=None, max_examples=100)
@given(st.lists(st.integers(-3, 3), min_size=12, max_size=12), st.integers(-90, 90), st.integers(0, 52))
def test_bounds_hold_where_products_cancel(numbers: list[int], power: int, offset: int) -> None:
    corners = np.ldexp(np.array(numbers, float).reshape(4, 3) + (2.0**offset if offset else 0.0), power)
    assert_fine(Surface(corners, OUTWARD))


@settings(deadline=None, max_examples=100)
@given(st.lists(st.floats(-1e30, 1e30), min_size=12, max_size=12))
def test_bounds_hold_for_a_tetrahedron_of_any_coordinates(numbers: list[float]) -> None:
    assert_fine(Surface(np.array(numbers).reshape(4, 3), OUTWARD))


@STORAGES
@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 1, 1e-3), (1, 1e-2, 1), (1, 1e-3, 1e-3), (1, 1, 1e-6)], ids=str)
@pytest.mark.parametrize("offset", [0.0, 30.0])
def test_bounds_are_near_the_error_in_any_shape(shape: tuple[float, ...], offset: float, stored: Storage) -> None:
    vertices, faces = wavy_torus(1500)
    triangles = stored(Surface(placed(vertices * shape, 2, 0.0, offset, 1.0), faces))
    assert_near(triangles)


NEEDLES = [(1, 1e-2, 1e-2), (1, 1e-3, 1e-3), (1, 1e-4, 1e-4), (1e-6, 1e-6, 1), (1e-5, 1, 1e-3)]
FOILS = [(1, 1, 1e-3), (1, 1e-4, 1), (1e-6, 1, 1)]


@STORAGES
@pytest.mark.parametrize("shape", NEEDLES + FOILS, ids=str)
@pytest.mark.parametrize("turn", range(2, 12, 2))
def test_the_bounds_of_needles_and_foils_askew_are_those_of_compact_parts(
    shape: tuple[float, ...], turn: int, stored: Storage
) -> None:
    """They are some roundings of the result: no second step of more digits is needed."""
    vertices, faces = wavy_torus(6000)
    fine = fine_values(sum_triangles(stored(Surface(placed(vertices * shape, turn, 0.0, 1.0, 1.0), faces))))
    assert fine is not None
    (values, d), bounds = fine
    spread = sum(2 * abs(value / d) for value in values[4:7])
    assert bounds[0] < 4 * 2.0**-53 * abs(values[0] / d)
    assert max(bounds[4:]) < 4 * 2.0**-53 * spread


def assert_area_and_extents(triangles: Triangles, axes: tuple[int, ...] | None) -> None:
    """Check that they are those of float64 sums, where coordinates are sheared along so ordered axes."""
    frame = frame_of(triangles)
    assert frame.grid is not None
    assert (frame.grid.shear and frame.grid.shear.axes) == axes
    plain = sum_in(Frame(frame.origin, 0, False, None), triangles)
    fine = sum_in(frame, triangles)
    assert isinstance(fine, SumsOnGrid)
    assert isinstance(plain, PlainSums)
    assert fine.area == pytest.approx(plain.area, rel=1e-14 if frame.grid.shear else 1e-15)
    assert in_float64(fine, triangles).sums.tobytes() == plain.sums.tobytes()
    assert fine.low.tobytes() + fine.high.tobytes() == plain.low.tobytes() + plain.high.tobytes()


@STORAGES
@pytest.mark.parametrize("axes", [None, *permutations(range(3))], ids=str)
def test_sums_area_and_extents_are_right_along_axes_in_any_order(axes: tuple[int, ...] | None, stored: Storage) -> None:
    vertices, faces = wavy_torus(3000)
    sizes = np.ones(3)
    sizes[list(axes or ())] = (1.0, 0.2, 1e-7) if axes else ()
    turned = (vertices * sizes) @ Rotation.from_rotvec([0.2, -0.1, 0.15]).as_matrix().T + [3.0, -1.0, 7.0]
    triangles = stored(Surface(turned, faces))
    assert_area_and_extents(triangles, axes)
    assert_fine(triangles)


@STORAGES
@pytest.mark.parametrize(("shape", "count"), [((1, 1, 1e-3), 20_000), ((1, 1e-2, 1e-2), 5_000)], ids=str)
def test_thin_parts_askew_are_not_sheared_where_bounds_are_near_without(
    shape: tuple[float, ...], count: int, stored: Storage
) -> None:
    vertices, faces = wavy_torus(count)
    triangles = stored(Surface(placed(vertices * shape, 2, 0.0, 1.0, 1.0), faces))
    assert_area_and_extents(triangles, None)
    assert_near(triangles)


@STORAGES
def test_the_fine_sums_have_the_same_bits_however_the_blocks_are_shared_out(stored: Storage) -> None:
    whole = stored(Surface(*wavy_torus(9 * BLOCK)))
    frame = frame_of(whole)
    expected = sum_triangles(whole)
    rows = []
    for start, stop in ((0, 2 * BLOCK), (2 * BLOCK, 7 * BLOCK), (7 * BLOCK, whole.count)):
        block = whole.block(start, stop)
        part = Surface(whole.vertices, block) if isinstance(whole, Surface) else type(whole)(block)
        rows += [each for _, each in block_rows(part, frame)]
    shared = sums_of(whole, frame, rows)
    assert isinstance(shared, SumsOnGrid)
    assert isinstance(expected, SumsOnGrid)
    for name in ("high", "low", "edges"):
        assert getattr(shared.fine, name) == getattr(expected.fine, name)
    assert solid_moments(whole, "float64", shared) == solid_moments(whole, "float64", expected)


@pytest.mark.parametrize("side", [8, 16, 20])
def test_a_regular_order_of_equal_bodies_does_not_mislead_the_sample(side: int) -> None:
    places = np.stack(np.unravel_index(np.arange(side**3), (side,) * 3), axis=-1) * 2.0
    vertices, faces = cube()
    corners = (vertices + places[:, None]).reshape(-1, 3)
    lattice = Surface(corners, (faces + 8 * np.arange(side**3)[:, None, None]).reshape(-1, 3))
    assert fine_values(sum_triangles(lattice)) is not None


@STORAGES
@pytest.mark.parametrize(("large", "misleads"), [(40.0, False), (400.0, True), (1e5, True)])
def test_where_the_sample_misleads_the_triangles_are_summed_again(
    large: float, misleads: bool, stored: Storage
) -> None:
    """A block of twelve triangles that hides among many small ones, between those that the sample takes."""
    vertices, faces = wavy_torus(2000)
    corners, block = cube()
    faces = np.concatenate([faces[:11], block + len(vertices), faces[11:]])
    for thickness in (1.0, 1e-3, 1e-5):
        own = placed(np.concatenate([vertices, large * corners + 4.0]), 2, 0.0, 0.0, thickness)
        triangles = stored(Surface(own, faces))
        assert (fine_values(sum_triangles(triangles)) is None) == misleads
        assert_fine(triangles)
        assert_near(triangles)


@STORAGES
@pytest.mark.parametrize("shape", [(1, 1, 1), *NEEDLES[1:3], *FOILS[1:]], ids=str)
def test_errors_of_float64_sums_are_measured(
    shape: tuple[float, ...], stored: Storage, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By double-double sums: the bounds are the errors, and the sums those of float64."""
    monkeypatch.setattr(sums, "MANY", 10**6)
    vertices, faces = wavy_torus(1500)
    triangles = stored(Surface(placed(vertices * shape, 2, 0.0, 30.0, 1.0), faces))
    moments = solid_moments(triangles, "float64")
    assert values_of(moments) == values_of(moments_of(sum_triangles(triangles)))
    errors = assert_within_bounds(triangles, moments)
    assert moments.zeroth_bound - errors[0] < F(4, 2**53) * abs(moments.zeroth)


def test_the_figures_are_right_to_the_last_digit() -> None:
    triangles = Surface(*wavy_torus(3000))
    moments = solid_moments(triangles, "float64")
    volume, *rest = assert_within_bounds(triangles, moments)
    spread = sum(moments.second[:3])
    assert volume < F(1, 10**20) * moments.zeroth
    assert all(k**2 < F(1, 10**40) * moments.zeroth * spread for k in rest[:3])
    assert max(rest[3:]) < F(1, 10**20) * spread


def test_without_the_kernel_the_bound_is_the_plain_one(monkeypatch: pytest.MonkeyPatch) -> None:
    triangles = Surface(*wavy_torus(1500))
    fine = solid_moments(triangles, "float64")
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    monkeypatch.setattr(arithmetic, "COSTLY", 0)
    plain = solid_moments(triangles, "float64")
    assert plain == moments_of(sum_triangles(triangles))
    assert abs(plain.zeroth - fine.zeroth) <= plain.zeroth_bound


def test_a_worker_without_the_kernel_takes_the_digits_from_all() -> None:
    triangles = Surface(*wavy_torus(3 * BLOCK))
    frame = frame_of(triangles)
    whole = in_float64(sum_triangles(triangles), triangles)
    rows = [each for _, each in block_rows(triangles, frame)]
    plain = [each for _, each in block_rows(triangles, Frame(frame.origin, 0, False, None))]
    mixed = sums_of(triangles, frame, [rows[0][:2], plain[0][2:]])
    assert isinstance(mixed, PlainSums)
    assert mixed.sums.tobytes() == whole.sums.tobytes()
    assert solid_moments(triangles, "float64", mixed) == solid_moments(triangles, "float64", whole)


def test_where_the_digits_are_too_few_for_a_near_bound_there_are_double_double_sums() -> None:
    """Slivers in two planes, on integers: float64 makes no error in a volume that the grid knows to a millionth."""
    corners = np.array([[0, 0, 0], [2.0**16, 1, 0], [2.0**16 + 1, 1, 0], [2.0**16 + 1, 2.0**16, 1]]) + 2.0**16
    triangles = Surface(np.concatenate([corners, corners[:, [1, 2, 0]]]), tetrahedra(2)[:, ::-1])
    own = sum_triangles(triangles)
    fine = fine_values(own)
    moments = solid_moments(triangles, "float64", own)
    assert_within_bounds(triangles, moments)
    assert fine is not None
    assert 6 * moments.zeroth_bound < F(fine[1][0]) / 1000


@pytest.mark.parametrize("turn", [3, 5, 2000])
@pytest.mark.parametrize("count", [1100, 2000, 4000])
def test_bounds_of_few_triangles_are_no_more_than_rounding_whatever_the_shape(count: int, turn: int) -> None:
    vertices, faces = wavy_torus(count)
    triangles = Surface(placed(vertices * (1, 1, 1e-6), turn, 0.0, 1.0, 1.0), faces)
    moments = solid_moments(triangles, "float64")
    assert_within_bounds(triangles, moments)
    assert moments.zeroth_bound <= abs(F(moments.zeroth)) / 2**53
    assert max(moments.second_bound) <= sum(map(abs, moments.second[:3])) / 2**52


def test_the_grid_that_is_chosen_in_compiled_code_is_the_same() -> None:
    rng, plain = np.random.default_rng(4), 0
    for case in range(400):
        corners = rng.normal(size=(128, 3, 3)) * 10 ** rng.uniform(-3, 3, 3) * 10 ** rng.uniform(-8, 8)
        corners += (case % 3) * 10 ** rng.uniform(-3, 9) * np.abs(corners).max()
        if case % 7 == 0:  # powers of two, on which steps begin
            corners = np.exp2(np.round(np.log2(np.abs(corners))))
        if case % 11 == 0:
            corners[..., case % 3] = 1.5
        sample = Sample.of(corners, 10 ** (3 + case % 6))
        plain += sample.plain is not None
        assert sample.plain in (None, sample.grid(local_frame(sample.low, sample.high)[0]))
    assert plain > 300
