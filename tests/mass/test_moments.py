"""Moments of a closed surface against rational integration of its stored coordinates: bounds hold and are of use."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import BOX_FACES, Mesh, box, cube, facets, inside_out, joined, ring, sphere

from inertia.mass.moments import (
    PAIRS,
    Moments,
    Vector,
    inertia_bound,
    inertia_tensor,
    root_above,
    simplex_moments,
    total,
)
from inertia.mass.triangles import moments_from_sums
from inertia.mass.triangles.sums import in_float64, sum_triangles
from inertia.mesh.surface import Surface, Triangles
from inertia_meshes import rational

F = Fraction
ORIGIN = (F(0), F(0), F(0))
OUTWARD = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]


def moments_of(triangles: Triangles, surface: bool = False) -> Moments:
    sums = in_float64(sum_triangles(triangles, surface=surface), triangles)
    return moments_from_sums.moments_of(sums, surface=surface)


def exact_of(triangles: Triangles, about: Vector) -> rational.Moments:
    """Return the oracle's moments, from exact arithmetic on the stored coordinates, about a point."""
    return rational.moments(triangles.corners()).moved(*(-k for k in about))


def frobenius_squared(tensor: list[list[Fraction]], other: rational.Matrix) -> Fraction:
    return sum(((a - b) ** 2 for u, v in zip(tensor, other, strict=True) for a, b in zip(u, v, strict=True)), F(0))


def assert_bounded(moments: Moments, triangles: Triangles) -> None:
    """Every number is within its bound of the exact one, about its origin and about the centroid."""
    exact = exact_of(triangles, moments.origin)
    assert abs(moments.zeroth - exact.volume) <= moments.zeroth_bound
    for value, true, bound in zip(moments.first, exact.first, moments.first_bound, strict=True):
        assert abs(value - true) <= bound
    for value, true, bound in zip(moments.second, exact.second, moments.second_bound, strict=True):
        assert abs(value - true) <= bound
    if abs(moments.zeroth) <= moments.zeroth_bound:
        return
    shifted = exact_of(triangles, moments.centroid)
    assert sum(k * k for k in shifted.center_of_mass) <= moments.centroid_bound**2
    central = moments.central()
    for value, true, bound in zip(central.second, exact.central, central.second_bound, strict=True):
        assert abs(value - true) <= bound
    error = frobenius_squared(inertia_tensor(central.second), exact.inertia)
    assert error <= inertia_bound(central.second_bound) ** 2


def tetrahedra(corners: np.ndarray) -> Surface:
    """Return tetrahedra (n, 4, 3), each turned outward, as one closed surface."""
    a, b, c, d = corners.transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    corners = np.where(inward[:, None, None], corners[:, [1, 0, 2, 3]], corners)
    faces = np.array(OUTWARD)[None] + 4 * np.arange(len(corners))[:, None, None]
    return Surface(corners.reshape(-1, 3), faces.reshape(-1, 3))


def star(seed: int, splits: int = 1, roughness: float = 0.5) -> Mesh:
    """Return a polyhedron that is star-shaped about its middle."""
    vertices, faces = sphere(splits=splits)
    return vertices * np.random.default_rng(seed).uniform(1 - roughness, 1, (len(vertices), 1)), faces


seeds = st.integers(0, 2**32 - 1)
sizes = st.one_of(st.floats(-30, 60), st.just(0.0)).map(lambda power: 10.0**power)
offsets = st.one_of(st.just(0.0), st.floats(-2, 8).map(lambda power: 10.0**power))
flattenings = st.one_of(st.just(1.0), st.floats(-12, 0).map(lambda power: 10.0**power))


def placed(vertices: np.ndarray, seed: int, size: float, offset: float, thickness: float) -> np.ndarray:
    """Return the vertices flattened, turned, moved off by `offset` times their size, and scaled."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    direction = rng.normal(size=3)
    moved = (vertices * [1.0, 1.0, thickness]) @ turn + offset * direction / np.linalg.norm(direction)
    placed: np.ndarray = size * moved
    return placed


@settings(deadline=None, max_examples=100)
@given(seeds, st.integers(1, 6), sizes, offsets, flattenings)
def test_bounds_hold_for_unions_of_tetrahedra(
    seed: int, count: int, size: float, offset: float, thickness: float
) -> None:
    corners = np.random.default_rng(seed).uniform(-1, 1, (4 * count, 3))
    triangles = tetrahedra(placed(corners, seed, size, offset, thickness).reshape(-1, 4, 3))
    assert_bounded(moments_of(triangles), triangles)


@settings(deadline=None, max_examples=60)
@given(seeds, sizes, offsets, flattenings)
def test_bounds_hold_for_polyhedra(seed: int, size: float, offset: float, thickness: float) -> None:
    vertices, faces = star(seed)
    triangles = Surface(placed(vertices, seed, size, offset, thickness), faces)
    assert_bounded(moments_of(triangles), triangles)


@settings(deadline=None, max_examples=100)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=12, max_size=12))
def test_bounds_hold_for_a_tetrahedron_of_any_coordinates(numbers: list[float]) -> None:
    triangles = Surface(np.array(numbers).reshape(4, 3), OUTWARD)
    assert_bounded(moments_of(triangles), triangles)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.integers(-3, 3), min_size=12, max_size=12), st.integers(-1060, 980), st.integers(0, 40))
def test_bounds_hold_where_products_cancel(numbers: list[int], power: int, offset: int) -> None:
    corners = np.ldexp(np.array(numbers, float).reshape(4, 3) + (2.0**offset if offset else 0.0), power)
    triangles = Surface(corners[np.random.default_rng(0).permutation(4)], OUTWARD)
    assert_bounded(moments_of(triangles), triangles)


@pytest.mark.parametrize("splits", [2, 5])
def test_bounds_hold_over_many_triangles(splits: int) -> None:
    vertices, faces = star(11, splits)
    triangles = Surface(placed(vertices, 11, 1e-3, 50.0, 1e-2), faces)
    assert_bounded(moments_of(triangles), triangles)


def test_bounds_are_of_use() -> None:
    """Of compact bodies the bounds are small, and within a few hundred times of the error there is."""
    ratios = []
    for seed in range(60):
        vertices, faces = star(seed)
        triangles = Surface(placed(vertices, seed, 1.0, 0.3, 1.0), faces)
        moments = moments_of(triangles)
        exact = exact_of(triangles, moments.origin)
        assert moments.zeroth_bound <= F(1e-13) * moments.zeroth
        assert moments.centroid_bound <= F(1e-13)
        central = moments.central()
        size = root_above(frobenius_squared(inertia_tensor(central.second), ((ORIGIN,) * 3)))
        assert inertia_bound(central.second_bound) <= F(1e-12) * size
        ratios.append(float(moments.zeroth_bound / max(abs(moments.zeroth - exact.volume), F(1, 2**60))))
    assert np.median(ratios) < 3000


def test_the_bounds_of_the_unit_cube() -> None:
    moments = moments_of(joined(cube()))
    assert 0 < moments.zeroth_bound <= 1e-13
    assert inertia_bound(moments.central().second_bound) <= 1e-13
    assert moments.central().second == (F(1, 12), F(1, 12), F(1, 12), 0, 0, 0)


def test_a_volume_too_thin_for_float64_is_within_its_bound_of_zero() -> None:
    vertices, faces = box((0.1, 0.1, 0.1), (1.1, 1.1, 0.1 + 2e-16))
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    triangles = Surface(vertices @ turn, faces)
    moments = moments_of(triangles)
    assert abs(moments.zeroth) <= moments.zeroth_bound
    assert_bounded(moments, triangles)
    for question in (lambda: moments.centroid_bound, moments.central):
        with pytest.raises(ZeroDivisionError):
            question()


# Shells


def shell_oracle(corners: np.ndarray) -> tuple[Fraction, list[Fraction], list[Fraction]]:
    """Return ∫1, ∫x and ∫x xᵀ over triangles: areas to 60 digits, and the mean over a triangle of each product."""
    zeroth, first, second = F(0), [F(0)] * 3, [F(0)] * 6
    for triangle in corners.tolist():
        a, b, c = ([F(x) for x in corner] for corner in triangle)
        u, v = ([q - p for p, q in zip(a, corner, strict=True)] for corner in (b, c))
        square = sum((u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2]) ** 2 for i in range(3))
        shift = 10**800
        area = F(math.isqrt(square.numerator * shift**2 // square.denominator), 2 * shift)
        zeroth += area
        for i in range(3):
            first[i] += area * (a[i] + b[i] + c[i]) / 3
        for k, (i, j) in enumerate(rational.PAIRS):
            mean = sum(p[i] * p[j] for p in (a, b, c)) + sum(p[i] for p in (a, b, c)) * sum(p[j] for p in (a, b, c))
            second[k] += area * mean / 12
    return zeroth, first, second


def assert_shell_bounded(triangles: Triangles) -> None:
    moments = moments_of(triangles, surface=True)
    about = moments.about(ORIGIN)
    zeroth, first, second = shell_oracle(triangles.corners())
    digits = F(1, 10**700)  # what the oracle's square root may be off by
    assert abs(about.zeroth - zeroth) <= about.zeroth_bound + digits
    assert all(abs(x - y) <= b + digits for x, y, b in zip(about.first, first, about.first_bound, strict=True))
    assert all(abs(x - y) <= b + digits for x, y, b in zip(about.second, second, about.second_bound, strict=True))


@settings(deadline=None, max_examples=60)
@given(seeds, st.floats(-30, 30), offsets, flattenings)
def test_bounds_hold_for_shells(seed: int, power: float, offset: float, thickness: float) -> None:
    points = np.random.default_rng(seed).uniform(-1, 1, (18, 3))
    assert_shell_bounded(Surface(placed(points, seed, 10.0**power, offset, thickness), np.arange(18).reshape(-1, 3)))


@pytest.mark.parametrize("width", [1e-80, 1e-120, 1e-160, 1e-200, 1e-300])
def test_bounds_hold_for_a_shell_whose_squared_areas_underflow(width: float) -> None:
    assert_shell_bounded(Surface([[0, 0, 0], [1e-5, 0, 0], [0, width, 0]], [[0, 1, 2]]))


def test_a_spherical_shell_is_between_its_inscribed_and_circumscribed_spheres() -> None:
    """Of convex surfaces the inner one has the smaller area; ∫x² is a third of ∫r² by the octahedron's symmetry."""
    surface = joined(sphere(radius=3.0, splits=5))
    corners = surface.corners()
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inner = float((np.einsum("ij,ij->i", normals, corners[:, 0]) / np.linalg.norm(normals, axis=1)).min())
    assert inner > 2.997
    moments = moments_of(surface, surface=True)
    assert 4 * math.pi * inner**2 < moments.zeroth < 4 * math.pi * 9
    assert all(inner**2 / 3 < k / moments.zeroth < 3 for k in moments.central().second[:3])


def test_a_box_as_a_shell_has_its_area_and_second_moments() -> None:
    """A box a × b × c: area 2(ab + bc + ca), ∫x² = a²/4 · 2bc + a²/12 · 2a(b + c)."""
    moments = moments_of(joined(box((1.0, 1.0, 1.0), (2.0, 4.0, 6.0))), surface=True)
    assert moments.zeroth == 46
    assert moments.centroid == (F(3, 2), F(5, 2), F(7, 2))
    sides = (1, 3, 5)
    for i, a in enumerate(sides):
        b, c = (k for j, k in enumerate(sides) if j != i)
        assert moments.central().second[i] == F(a * a * 2 * b * c, 4) + F(a**3 * 2 * (b + c), 12)
    assert moments.central().second[3:] == (0, 0, 0)


# Where the part lies, how large it is, which way it faces


@pytest.mark.parametrize("middle", [(1e6, -1e6, 1e6), (2.0**40, 0.0, -(2.0**41))], ids=["1e6 m", "2^40 m"])
def test_a_part_far_away_keeps_the_digits_its_coordinates_carry(middle: tuple[float, float, float]) -> None:
    vertices, faces = star(5, splits=2)
    triangles = Surface(vertices + middle, faces)
    moments, exact = moments_of(triangles), rational.moments(triangles.corners())
    ulp = F(1, 2**52)
    assert abs(moments.zeroth - exact.volume) <= 4 * ulp * exact.volume
    assert all(abs(x - y) <= 4 * ulp for x, y in zip(moments.centroid, exact.center_of_mass, strict=True))
    central = moments.central().second
    assert all(abs(x - y) <= 4 * ulp * sum(exact.central[:3]) for x, y in zip(central, exact.central, strict=True))


def test_float32_facets_far_away_keep_the_digits_they_carry() -> None:
    triangles = facets(joined(sphere((1e6, 1e6, -1e6), radius=1000.0, splits=2)))
    moments, exact = moments_of(triangles), rational.moments(triangles.corners())
    assert float(moments.zeroth) == pytest.approx(float(exact.volume), rel=1e-15)
    assert float(moments.central().second[0]) == pytest.approx(float(exact.central[0]), rel=1e-15)


@pytest.mark.parametrize("power", [-320, -77, -1, 1, 50, 180])
def test_a_power_of_two_in_size_scales_every_number_exactly(power: int) -> None:
    vertices, faces = ring(12, 7)
    plain, scaled = moments_of(Surface(vertices, faces)), moments_of(Surface(np.ldexp(vertices, power), faces))
    s = F(2) ** power
    assert scaled.zeroth == s**3 * plain.zeroth
    assert scaled.origin == tuple(s * k for k in plain.origin)
    assert scaled.first == tuple(s**4 * k for k in plain.first)
    assert scaled.second == tuple(s**5 * k for k in plain.second)


def test_a_translation_that_rounds_nothing_moves_the_centroid_only() -> None:
    vertices, faces = star(3)
    vertices = np.round(vertices * 2**20) / 2**20
    here = moments_of(Surface(vertices, faces))
    there = moments_of(Surface(vertices + np.array([2.0**20, 7, -3]), faces))
    assert there.zeroth == here.zeroth
    assert there.central().second == here.central().second
    assert there.centroid == tuple(a + b for a, b in zip(here.centroid, (2**20, 7, -3), strict=True))


def test_a_rotation_that_rounds_nothing_turns_the_moments() -> None:
    """(3, 4)/5 turned: on multiples of 25 the new coordinates are whole, and ∫x xᵀ becomes R ∫x xᵀ Rᵀ."""
    vertices, faces = box((-25.0, -50.0, -100.0), (75.0, 150.0, 25.0))
    turn = np.array([[3, -4, 0], [4, 3, 0], [0, 0, 5]])
    moments = moments_of(Surface((vertices / 5) @ turn.T, faces)).about(ORIGIN)
    ratios = [[F(int(k), 5) for k in row] for row in turn]
    exact = rational.moments(vertices[faces]).mapped(ratios)
    assert moments.zeroth == exact.volume
    assert moments.second == exact.second


def test_an_inverted_surface_has_the_moments_negated() -> None:
    mesh = star(8, splits=2)
    outward, inward = moments_of(joined(mesh)), moments_of(joined(inside_out(mesh)))
    assert outward.zeroth > 0
    assert abs(outward.zeroth + inward.zeroth) <= outward.zeroth_bound + inward.zeroth_bound
    for a, b, bound in zip(outward.second, inward.second, outward.second_bound, strict=True):
        assert abs(a + b) <= 2 * bound
    box_out, box_in = (moments_of(joined(m)) for m in (cube((3, 2, 1)), inside_out(cube((3, 2, 1)))))
    assert box_in.about(ORIGIN).second == tuple(-k for k in box_out.about(ORIGIN).second)


def test_a_body_is_the_sum_of_its_pieces() -> None:
    """A box cut at a plane between representable numbers, and the same box whole."""
    whole = moments_of(joined(box((0, 0, 0), (3, 2, 1)))).about(ORIGIN)
    pieces = [moments_of(joined(box((a, 0, 0), (b, 2, 1)))) for a, b in ((0, 0.125), (0.125, 2.5), (2.5, 3))]
    summed = total(pieces).about(ORIGIN)
    assert (summed.zeroth, summed.first, summed.second) == (whole.zeroth, whole.first, whole.second)


# The algebra


def point(mass: int, x: int, y: int, z: int) -> Moments:
    m, x, y, z = F(mass), F(x), F(y), F(z)
    return Moments(ORIGIN, m, (m * x, m * y, m * z), (m * x * x, m * y * y, m * z * z, m * y * z, m * z * x, m * x * y))


whole_numbers = st.integers(-9, 9)
points = st.tuples(st.integers(1, 9), whole_numbers, whole_numbers, whole_numbers)


@settings(deadline=None)
@given(st.lists(points, min_size=1, max_size=5), st.tuples(whole_numbers, whole_numbers, whole_numbers))
def test_shifting_a_sum_of_points_is_summing_shifted_points(
    masses: list[tuple[int, int, int, int]], to: tuple[int, int, int]
) -> None:
    shifted = total(point(*each) for each in masses).about([F(k) for k in to])
    direct = total(point(m, *(a - b for a, b in zip(place, to, strict=True))) for m, *place in masses)
    assert (shifted.zeroth, shifted.first, shifted.second) == (direct.zeroth, direct.first, direct.second)
    assert shifted.origin == to


@settings(deadline=None, max_examples=30)
@given(st.lists(points, min_size=2, max_size=4), st.tuples(whole_numbers, whole_numbers, whole_numbers))
def test_adding_does_not_depend_on_the_origins(
    masses: list[tuple[int, int, int, int]], to: tuple[int, int, int]
) -> None:
    first, *others = (point(*each) for each in masses)
    moved = total([first, *(other.about([F(k) for k in to]) for other in others)])
    assert moved == total([first, *others])


def test_shifting_back_restores_every_number_and_loosens_no_bound_that_is_zero() -> None:
    here = point(3, 1, -2, 5)
    assert here.about([F(1, 3), F(7), F(-5, 11)]).about(ORIGIN) == here


def test_the_central_moments_of_points_are_sums_over_offsets_from_their_mean() -> None:
    places = [(2, (1, 2, 3)), (3, (-1, 0, 4)), (5, (2, 2, -6))]
    moments = total(point(m, *p) for m, p in places).central()
    mean = [F(sum(m * p[i] for m, p in places), 10) for i in range(3)]
    assert list(moments.centroid) == mean == list(moments.origin)
    for value, (i, j) in zip(moments.second, PAIRS, strict=True):
        assert value == sum(m * (p[i] - mean[i]) * (p[j] - mean[j]) for m, p in places)
    assert moments.first == ORIGIN


def bounded(moments: Moments, zeroth: Fraction, first: Fraction, second: Fraction) -> Moments:
    return Moments(moments.origin, moments.zeroth, moments.first, moments.second, zeroth, (first,) * 3, (second,) * 6)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(points, min_size=2, max_size=4),
    st.tuples(*[st.fractions(-1, 1, max_denominator=50)] * 10),
    st.tuples(whole_numbers, whole_numbers, whole_numbers),
)
def test_bounds_hold_through_every_operation(
    masses: list[tuple[int, int, int, int]], off: tuple[Fraction, ...], to: tuple[int, int, int]
) -> None:
    """Figures off by all that their bounds allow stay within the bounds after shifting, adding and centring."""
    true = total(point(*each) for each in masses)
    limit = F(1, 3)
    zeroth, first, second = limit * off[0], [limit * k for k in off[1:4]], [limit * k for k in off[4:]]
    wrong = bounded(
        Moments(
            ORIGIN,
            true.zeroth + zeroth,
            tuple(a + b for a, b in zip(true.first, first, strict=True)),
            tuple(a + b for a, b in zip(true.second, second, strict=True)),
        ),
        limit, limit, limit,
    )  # fmt: skip

    def within(moments: Moments, expected: Moments) -> None:
        assert abs(moments.zeroth - expected.zeroth) <= moments.zeroth_bound
        for name in ("first", "second"):
            rows = zip(getattr(moments, name), getattr(expected, name), getattr(moments, f"{name}_bound"), strict=True)
            assert all(abs(a - b) <= bound for a, b, bound in rows)

    within(wrong.about([F(k) for k in to]), true.about([F(k) for k in to]))
    within(wrong + wrong.about([F(k) for k in to]), true + true)
    within(wrong.scaled(F(-3, 7)), true.scaled(F(-3, 7)))
    within(wrong.in_unit(F(254, 10)), true.in_unit(F(254, 10)))
    central = wrong.central()
    assert sum((a - b) ** 2 for a, b in zip(wrong.centroid, true.centroid, strict=True)) <= wrong.centroid_bound**2
    for moments, expected, bound in zip(central.second, true.central().second, central.second_bound, strict=True):
        assert abs(moments - expected) <= bound


fractions = st.fractions(-9, 9, max_denominator=60)
sizes = st.fractions(0, 1, max_denominator=60)


@settings(deadline=None, max_examples=60)
@given(
    st.tuples(*[fractions] * 12),
    st.tuples(*[sizes] * 10),
    st.sampled_from([F(3), F(-5, 7), F(2, 9), F(-40)]),
    st.none() | st.tuples(sizes, sizes),
)
def test_central_moments_are_those_of_the_formulas_whatever_the_denominators(
    values: tuple[Fraction, ...],
    bounds: tuple[Fraction, ...],
    zeroth: Fraction,
    norms: tuple[Fraction, Fraction] | None,
) -> None:
    """Of a body and of a hole; s − f fᵀ/v, and the bound that `central` states, element by element."""
    origin, first, second = values[:3], values[3:6], values[6:]
    vb, fb, sb = abs(zeroth) * bounds[0] * F(9, 10), bounds[1:4], bounds[4:]
    given = Moments(origin, zeroth, first, second, vb, fb, sb, norms)
    metres, density = F(254, 10_000), F(-7850, 3)
    central = given.in_unit(metres).scaled(density).central()  # which no number was read of before
    size, least = abs(zeroth), abs(zeroth) - vb
    c = [k / zeroth for k in first]
    off = [(b + abs(k) * vb) / least for k, b in zip(c, fb, strict=True)]
    assert central.centroid == central.origin == tuple(metres * (o + k) for o, k in zip(origin, c, strict=True))
    assert (central.zeroth, central.zeroth_bound) == (density * zeroth, -density * vb)
    assert central.first == central.first_bound == ORIGIN
    scale = density * metres**2
    for k, (i, j) in enumerate(PAIRS):
        assert central.second[k] == scale * (second[k] - first[i] * first[j] / zeroth)
        shift = abs(c[i]) * fb[j] + abs(c[j]) * off[i] * least + off[i] * off[j] * (size + vb)
        assert central.second_bound[k] == -scale * (sb[k] + shift)
    assert central.tensor == inertia_tensor(central.second)
    assert central == replace(central)
    far = sum((k * k for k in c), F(0))
    limit = root_above(sum((k * k for k in off), F(0)))
    if norms is not None:
        lever = min(norms[0], root_above(sum((k * k for k in fb), F(0))))
        limit = min(limit, (lever + root_above(far) * vb) / least)
    assert limit / (1 + F(1, 2**50)) <= given.centroid_bound <= limit * (1 + F(1, 2**50))


def test_a_first_moment_that_may_be_off_loosens_the_central_moments_about_it() -> None:
    """Seen as 0 though it is 1, of a mass of 1: ∫x² about the true centre is less by 1."""
    moments = bounded(point(1, 0, 0, 0), F(0), F(1), F(0)).central()
    assert (moments.second, moments.second_bound) == ((0,) * 6, (1,) * 6)


def test_scaling_multiplies_every_moment_and_the_size_of_every_bound() -> None:
    moments = bounded(point(2, 1, 2, 3), F(1, 2), F(1, 3), F(1, 5)).scaled(F(-4))
    assert (moments.zeroth, moments.first) == (-8, (-8, -16, -24))
    assert moments.second == (-8, -32, -72, -48, -24, -16)
    assert (moments.zeroth_bound, moments.first_bound, moments.second_bound) == (2, (F(4, 3),) * 3, (F(4, 5),) * 6)


def test_a_unit_multiplies_lengths_and_leaves_the_zeroth_moment() -> None:
    inch = F(254, 10_000)
    moments = bounded(point(2, 1, 2, 3), F(1, 2), F(1, 3), F(1, 5)).about([F(1)] * 3).in_unit(inch)
    same = bounded(point(2, 1, 2, 3), F(1, 2), F(1, 3), F(1, 5)).about([F(1)] * 3)
    assert (moments.zeroth, moments.zeroth_bound) == (2, F(1, 2))
    assert moments.origin == (inch,) * 3
    assert moments.first == tuple(inch * k for k in same.first)
    assert moments.second == tuple(inch**2 * k for k in same.second)
    assert moments.first_bound == tuple(inch * k for k in same.first_bound)
    assert moments.second_bound == tuple(inch**2 * k for k in same.second_bound)
    assert moments.centroid == (inch, 2 * inch, 3 * inch)


def test_total_of_nothing_is_an_error() -> None:
    with pytest.raises(ValueError):
        total([])


def test_the_tensor_has_negative_products_off_its_diagonal() -> None:
    xx, yy, zz, yz, zx, xy = (F(k) for k in (2, 3, 5, 7, 11, 13))
    assert inertia_tensor((xx, yy, zz, yz, zx, xy)) == [[8, -13, -11], [-13, 7, -7], [-11, -7, 5]]


def test_a_bound_on_the_tensor_is_its_frobenius_norm() -> None:
    # Diagonal 5, 4, 3 and products 0: √50; with products 1, 2, 3 besides: √(50 + 2·14).
    assert inertia_bound((F(1), F(2), F(3), F(0), F(0), F(0))) ** 2 >= 50
    bound = inertia_bound((F(1), F(2), F(3), F(1), F(2), F(3)))
    assert bound**2 >= 78
    assert float(bound) == pytest.approx(math.sqrt(78), rel=1e-15)


@settings(deadline=None)
@given(st.fractions(min_value=0), st.integers(-3000, 3000))
def test_a_root_is_above_the_true_one_by_a_part_in_2_to_60(square: Fraction, power: int) -> None:
    square *= F(2) ** power
    root = root_above(square)
    assert square <= root**2 <= square * (1 + F(1, 2**60)) ** 2


def test_a_root_of_less_than_nothing_is_zero() -> None:
    assert root_above(F(-1, 3)) == root_above(F(0)) == 0


# Simplices


def test_points_are_points() -> None:
    assert simplex_moments(np.array([[[1.0, -2.0, 3.0]]]), np.array([2.0])) == point(2, 1, -2, 3)


def test_a_segment_has_a_twelfth_of_its_squared_length() -> None:
    moments = simplex_moments(np.array([[[1.0, 5.0, 5.0], [7.0, 5.0, 5.0]]]), np.array([6.0]))
    assert moments.centroid == (4, 5, 5)
    assert moments.central().second == (18, 0, 0, 0, 0, 0)


def test_a_triangle_splits_into_triangles() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 1.0], [0.0, 8.0, 2.0]])
    a, b, c = corners
    middles = (a + b) / 2, (b + c) / 2, (c + a) / 2
    quarters = np.array(
        [[a, middles[0], middles[2]], [middles[0], b, middles[1]], [middles[2], middles[1], c], middles]
    )
    assert simplex_moments(corners[None], [F(4)]) == simplex_moments(quarters, [F(1)] * 4)


@pytest.mark.parametrize("sign", [-1, 1])
def test_measures_off_by_what_is_said_stay_within_the_bounds(sign: int) -> None:
    corners = np.random.default_rng(2).integers(-5, 6, (7, 2, 3)).astype(float)
    measures, off = [F(k) for k in (3, -1, 4, 1, -5, 9, 2)], F(1, 100)
    moments = simplex_moments(corners, measures, off)
    true = simplex_moments(corners, [m * (1 + sign * off * (-1) ** i) for i, m in enumerate(measures)])
    assert 0 < abs(moments.zeroth - true.zeroth) <= moments.zeroth_bound == F(25, 100)
    assert all(abs(a - b) <= c for a, b, c in zip(moments.first, true.first, moments.first_bound, strict=True))
    assert all(abs(a - b) <= c for a, b, c in zip(moments.second, true.second, moments.second_bound, strict=True))


def test_box_faces_are_outward() -> None:
    """The oracle itself gives a unit box a positive volume: no sign is taken over from the code under test."""
    vertices, _ = box((0, 0, 0), (1, 1, 1))
    assert rational.moments(vertices[np.array(BOX_FACES)]).volume == 1


def test_a_weighed_total_is_exact_and_its_uncertainty_goes_over():
    true = Moments(ORIGIN, F(10), (F(3), F(-2), F(1)), (F(9), F(8), F(7), F(1), F(2), F(-1)))
    error = F(1, 100)
    for sign in (-1, 1):
        original = replace(true, zeroth=true.zeroth + sign * error, zeroth_bound=error)
        weighed, expected = original.weighed(F(5)), true.scaled(F(1, 2))
        assert (weighed.zeroth, weighed.zeroth_bound) == (5, 0)
        for got, bound, value in zip(weighed.first, weighed.first_bound, expected.first, strict=True):
            assert 0 < abs(got - value) <= bound
        for got, bound, value in zip(weighed.second, weighed.second_bound, expected.second, strict=True):
            assert 0 < abs(got - value) <= bound
