"""Signs and crossings against rational arithmetic, overlap against separating planes and cells."""

import itertools
from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from inertia import native
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.hubs import hubs, near_around
from inertia.mesh.geometry.intersect import compiled_crossings, crossings, overlap, vectorised_crossings
from inertia.mesh.geometry.triangle_pairs import UNSURE, orient3d, orient3d_filter
from inertia.mesh.surface import FACET, Facets, Surface
from inertia_meshes.shapes import Corners, band, box, flipped, moved, revolved, sphere

# A rotation with no axis, plane or diagonal of the coordinates left in place.
TILT = np.linalg.qr(np.array([[2.0, 1, -1], [1, 3, 1], [-1, 1, 4]]))[0]
TILT *= np.linalg.det(TILT)

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])

small = st.integers(-3, 3)
triangle = st.lists(st.tuples(small, small, small), min_size=3, max_size=3)
anything = st.floats(allow_nan=False, allow_infinity=False)


def surface(*pieces: Corners) -> Surface:
    corners = np.concatenate(pieces).reshape(-1, 3)
    return Surface(corners, np.arange(len(corners)).reshape(-1, 3))


def cube(x: float = 0, y: float = 0, z: float = 0, size: float = 1) -> Corners:
    return moved(size * (box(1, 1, 1) + 0.5), x, y, z)


def minus(a, b):
    return [p - q for p, q in zip(a, b, strict=True)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b, strict=True))


def rational_sign(a, b, c, d) -> int:
    a, b, c, d = ([Fraction(value) for value in point] for point in (a, b, c, d))
    volume = dot(cross(minus(b, a), minus(c, a)), minus(d, a))
    return (volume > 0) - (volume < 0)


def whole(triangles):
    """Return triangles in whole numbers: times a power of two, exactly."""
    ratios = [[[Fraction(x) for x in point] for point in triangle] for triangle in triangles]
    scale = max(x.denominator for triangle in ratios for point in triangle for x in point)
    return [[tuple(int(x * scale) for x in point) for point in triangle] for triangle in ratios]


def interiors_cross(one, other) -> bool:
    """Clip the line that the planes have in common by both open triangles, of whole numbers."""
    if any(
        max(a) <= min(b) or max(b) <= min(a)
        for a, b in zip(zip(*one, strict=True), zip(*other, strict=True), strict=True)
    ):
        return False
    normals = [cross(minus(t[1], t[0]), minus(t[2], t[0])) for t in (one, other)]
    along = cross(*normals)
    if not any(along):
        return False
    offsets = dot(normals[0], one[0]), dot(normals[1], other[0])
    sums = [offsets[0] * q - offsets[1] * p for p, q in zip(*normals, strict=True)]
    point, size = cross(sums, along), dot(along, along)  # the point times the size
    start, stop = [], []
    for corners, normal in zip((one, other), normals, strict=True):
        for k in range(3):
            inwards = cross(normal, minus(corners[(k + 1) % 3], corners[k]))
            here, rise = dot(minus(point, [size * x for x in corners[k]]), inwards), dot(along, inwards)
            if rise == 0 and here <= 0:
                return False
            if rise:
                (start if rise > 0 else stop).append(Fraction(-here, rise))
    return max(start) < min(stop)


@pytest.fixture(scope="class", params=["compiled", "integers"])
def exactly(request: pytest.FixtureRequest) -> Iterator[None]:
    """Decide what floating point does not by the compiled kernel, and without it."""
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "integers":
            patch.setenv("INERTIA_NATIVE", "0")
        else:
            for limit in ("SHIPPED_ABOVE", "LOAD_ABOVE", "COMPILE_ABOVE"):
                patch.setattr(native, limit, 0)
        yield


@pytest.mark.usefixtures("exactly")
class TestOrientation:
    @given(st.lists(st.tuples(anything, anything, anything), min_size=4, max_size=4))
    @settings(deadline=None)
    def test_sign_is_that_of_rational_arithmetic_over_the_whole_range(self, points):
        assert orient3d(*np.array(points)) == rational_sign(*points)

    @given(
        st.lists(st.tuples(small, small, small), min_size=3, max_size=3),
        st.integers(0, 40),
        st.integers(-4, 4),
    )
    @settings(deadline=None)
    def test_points_a_last_digit_off_a_plane_are_on_the_right_side(self, corners, exponent, ulps):
        plane = np.array(corners, float) + 2.0**exponent
        point = plane.mean(axis=0)
        point[2] += ulps * np.spacing(point[2])
        assert orient3d(*plane, point) == rational_sign(*plane.tolist(), point.tolist())

    @given(seed=st.integers(0, 2**32 - 1), exponent=st.integers(-300, 300), bits=st.integers(1, 52))
    @settings(deadline=None, max_examples=30)
    def test_rows_of_points_near_a_plane_are_decided_together(self, seed, exponent, bits):
        rng = np.random.default_rng(seed)
        a, b, c = np.round(np.ldexp(rng.uniform(-1, 1, (3, 20, 3)), bits))
        weights = rng.integers(-2, 3, (2, 20, 1))
        d = a + weights[0] * (b - a) + weights[1] * (c - a)
        points = np.ldexp([a, b, c, d * (1 + rng.integers(-1, 2, d.shape) * 2.0**-52)], exponent)
        expected = [rational_sign(*four.tolist()) for four in points.transpose(1, 0, 2)]
        assert orient3d(*points).tolist() == expected

    def test_products_that_underflow_do_not_mislead(self):
        points = np.random.default_rng(5).integers(-1000, 1001, (3000, 4, 3))
        tiny = np.ldexp(points.astype(float), -368)
        expected = [rational_sign(*four.tolist()) for four in points]
        assert orient3d(*tiny.transpose(1, 0, 2)).tolist() == expected

    def test_floating_point_leaves_points_in_the_plane_undecided(self):
        rng = np.random.default_rng(3)
        a, b, c = rng.normal(size=(3, 500, 3))
        assert (orient3d_filter(a, b, c, (a + b + c) / 3) == UNSURE).mean() > 0.9
        assert (orient3d_filter(a, b, c, a + np.cross(b - a, c - a)) == 1).all()

    def test_arguments_are_broadcast(self):
        a, b, c = np.eye(3)
        points = np.array([[[1.0, 1, 1], [0, 0, 0]], [[1, 0, 0], [0.25, 0.25, 0.5]]])
        assert orient3d(a, b, c, points).tolist() == [[1, -1], [0, 0]]


class TestBoxes:
    @pytest.mark.parametrize("touching", [False, True])
    @pytest.mark.parametrize(("count", "others"), [(1, 1), (1, 40), (57, 3), (200, 130)])
    def test_pairs_are_those_of_all_against_all(self, count, others, touching):
        rng = np.random.default_rng(count)
        below = np.less_equal if touching else np.less
        # A coarse grid of coordinates makes boxes touch and be flat.
        low, low_b = rng.integers(0, 12, (count, 3)) / 8, rng.integers(0, 12, (others, 3)) / 8
        high, high_b = low + rng.integers(0, 4, (count, 3)) / 8, low_b + rng.integers(0, 4, (others, 3)) / 8

        def expected(low_b, high_b):
            return np.argwhere((below(low[:, None], high_b) & below(low_b, high[:, None])).all(axis=2)).tolist()

        def pairs_of(*trees):
            return sorted(
                [i, j] for a, b, _ in overlapping(*trees, touching=touching) for i, j in zip(a, b, strict=True)
            )

        assert pairs_of(BoxTree(low, high), BoxTree(low_b, high_b)) == expected(low_b, high_b)
        assert pairs_of(BoxTree(low, high)) == [[i, j] for i, j in expected(low, high) if i < j]


class TestCrossings:
    @given(triangle, triangle)
    @settings(deadline=None, max_examples=300)
    def test_two_triangles_cross_where_rational_clipping_says_so(self, one, other):
        expected = interiors_cross(*whole([one, other]))
        assert crossings(Surface(one, [[0, 1, 2]]), Surface(other, [[0, 1, 2]])).total == expected
        assert crossings(Surface(one + other, [[0, 1, 2], [3, 4, 5]])).total == expected

    @given(triangle, st.tuples(small, small, small), st.tuples(small, small, small))
    @settings(deadline=None, max_examples=200)
    def test_triangles_that_share_a_vertex_can_still_cross(self, one, u, v):
        contacts = crossings(Surface([*one, u, v], [[0, 1, 2], [3, 0, 4]]))
        assert contacts.total == interiors_cross(*whole([one, [u, one[0], v]]))

    def test_every_crossing_among_many_triangles_is_found(self):
        rng = np.random.default_rng(8)
        corners = rng.integers(-6, 7, (70, 3, 3))
        exact = whole(corners.tolist())
        expected = [[i, j] for i, j in itertools.combinations(range(70), 2) if interiors_cross(exact[i], exact[j])]
        contacts = crossings(surface(corners), limit=10_000)
        assert contacts.pairs.tolist() == expected
        assert len(expected) > 100
        halves = crossings(surface(corners[:30]), surface(corners[30:]), limit=10_000)
        assert np.add(halves.pairs, [0, 30]).tolist() == [[i, j] for i, j in expected if i < 30 <= j]

    def test_places_lie_in_both_triangles(self):
        rng = np.random.default_rng(9)
        corners = rng.normal(size=(40, 3, 3)) + 1000
        contacts = crossings(surface(corners), limit=1000)
        assert contacts.total > 50
        for k in range(2):
            a, b, c = corners[contacts.pairs[:, k]].transpose(1, 0, 2)
            weights = np.linalg.solve(
                np.stack([b - a, c - a, np.cross(b - a, c - a)], axis=2), (contacts.points - a)[..., None]
            )[..., 0]
            assert (weights[:, :2] > -1e-9).all()
            assert (weights[:, :2].sum(axis=1) < 1 + 1e-9).all()
            assert (np.abs(weights[:, 2]) < 1e-9).all()

    def test_limit_keeps_the_first_pairs_and_the_count(self):
        corners = np.random.default_rng(8).normal(size=(60, 3, 3))
        everything, some = crossings(surface(corners), limit=10_000), crossings(surface(corners), limit=7)
        assert (everything.truncated, some.truncated) == (False, True)
        assert some.total == everything.total == len(everything.pairs)
        assert some.pairs.tolist() == everything.pairs[:7].tolist()
        assert some.points.tolist() == everything.points[:7].tolist()

    def test_closed_bodies_do_not_cross_themselves(self):
        tilted = sphere(1, 60) @ TILT
        for piece in (sphere(1, 60), tilted, cube(), cube() @ TILT + 1000):
            assert crossings(surface(piece)).total == 0

    def test_a_huge_triangle_crosses_what_reaches_to_both_sides_of_it(self):
        small_ones = sphere(1, 120) @ TILT
        height = 0.1
        huge = np.array([[[-1e6, -1e6, height], [1e6, -1e6, height], [0, 1e6, height]]])
        straddling = (small_ones[:, :, 2].min(axis=1) < height) & (small_ones[:, :, 2].max(axis=1) > height)
        contacts = crossings(surface(huge), surface(small_ones), limit=100_000)
        assert contacts.pairs[:, 1].tolist() == np.flatnonzero(straddling).tolist()
        both = crossings(surface(small_ones, huge), limit=100_000)
        assert both.pairs[:, 0].tolist() == np.flatnonzero(straddling).tolist()

    def test_binary_stl_records_are_taken(self):
        records = np.zeros(2, FACET)
        for k, name in enumerate(("x0", "y0", "z0", "x1", "y1", "z1", "x2", "y2", "z2")):
            records[name] = [[0, 0, 0, 4, 0, 0, 0, 4, 0][k], [1, 1, -1, 1, 1, 1, 9, 9, 1][k]]
        assert crossings(Facets(records)).points.tolist() == [[1.5, 1.5, 0]]

    def test_no_triangles_cross_nothing(self):
        nothing = surface(np.empty((0, 3, 3)))
        assert crossings(nothing).total == 0
        assert crossings(nothing, surface(cube())).total == 0
        assert list(compiled_crossings(nothing)) == []  # taken where the kernel is loaded

    def test_progress_rises_to_one(self):
        fractions: list[float] = []
        crossings(surface(sphere(1, 60)), progress=fractions.append)
        assert fractions == sorted(fractions)
        assert fractions[-1] == pytest.approx(1)


Places = tuple[list[list[int]], list[list[float]]]


def listed(runs) -> Places:
    """Return the pairs that cross, ascending, and the places where."""
    entries = sorted(
        (pair, place) for pairs, places, _ in runs for pair, place in zip(pairs.tolist(), places.tolist(), strict=True)
    )
    return [pair for pair, _ in entries], [place for _, place in entries]


def soups() -> dict[str, Corners]:
    """Triangles that cross, touch, share corners and lie in common planes, exactly and but for rounding."""
    rng = np.random.default_rng(12)
    grid, normal = rng.integers(-3, 4, (60, 3, 3)).astype(float), rng.normal(size=(60, 3, 3))
    shared = rng.normal(size=(9, 3))[rng.integers(0, 9, (60, 3))]
    tiny = np.where(rng.random(grid.shape) < 0.1, grid * 1e-250, grid)
    return {
        "grid": grid,
        "turned grid": grid @ TILT,
        "grid a last digit off": grid + rng.integers(-1, 2, grid.shape) * 2.0**-52,
        "turned grid far off": grid @ TILT + 1e9,
        "normal": normal,
        "corners in common": shared,
        "fine grid": (grid / 7).astype(np.float32).astype(float) + 0.1,
        "numbers 1e250 apart": tiny,
        "flat": grid * [1, 1, 0] @ TILT,
    }


class TestEngines:
    @pytest.mark.parametrize("scale", [1e-310, 1e-30, 1.0, 1e30])
    @pytest.mark.parametrize("name", soups())
    def test_both_find_what_rational_clipping_finds(self, name, scale):
        corners = soups()[name] * scale
        exact = whole(corners.tolist())
        expected = [
            [i, j]
            for i, j in itertools.combinations(range(len(corners)), 2)
            if len({*exact[i]} & {*exact[j]}) < 2 and interiors_cross(exact[i], exact[j])
        ]
        by_kernel, by_numpy = (
            listed(compiled_crossings(surface(corners))),
            listed(vectorised_crossings(surface(corners))),
        )
        assert by_kernel[0] == expected
        assert by_kernel == by_numpy

    @pytest.mark.parametrize("seed", range(30))
    def test_both_agree_to_the_last_bit(self, seed):
        rng = np.random.default_rng(seed)
        count = int(rng.integers(2, 400))
        corners = rng.normal(size=(count, 1, 3)) + rng.normal(size=(count, 3, 3)) * 10.0 ** rng.uniform(-3, 0.5)
        corners = corners.round(int(rng.integers(0, 5))) * 10.0 ** rng.uniform(-60, 60)
        faces = np.arange(3 * count).reshape(-1, 3)
        records = np.zeros(count, FACET)
        both = Surface(corners.reshape(-1, 3), faces), Facets(records)
        both[1].corners_f4()[:] = corners / np.abs(corners).max()
        for triangles in both:
            assert listed(compiled_crossings(triangles)) == listed(vectorised_crossings(triangles))

    @pytest.mark.parametrize("seed", range(4))
    def test_of_labelled_triangles_those_of_one_label_are_compared(self, seed):
        rng = np.random.default_rng(seed)
        corners = rng.integers(-3, 4, (150, 3, 3)).astype(float)
        corners = np.concatenate([corners, corners[:40], corners[:20]])  # copies of one label, and of others
        triangles, labels = surface(corners), rng.integers(0, 3, len(corners)).astype(np.int32)
        every, among = crossings(triangles, limit=10**6), crossings(triangles, limit=10**6, labels=labels)
        same = labels[every.pairs[:, 0]] == labels[every.pairs[:, 1]]
        assert 0 < same.sum() < len(same)
        assert np.array_equal(among.pairs, every.pairs[same])
        np.testing.assert_allclose(among.points, every.points[same], rtol=0, atol=1e-13)  # copies stand in for others
        assert among.total == same.sum()
        whole = labels.astype(np.int64)
        assert listed(compiled_crossings(triangles, whole)) == listed(vectorised_crossings(triangles, whole))

    def test_a_fine_flat_surface_turned_in_space_does_not_cross_itself(self):
        x, y = np.meshgrid(np.arange(40.0), np.arange(40.0), indexing="ij")
        plane = np.stack([x, y, 0 * x], axis=-1)
        low, right, across, up = plane[:-1, :-1], plane[1:, :-1], plane[1:, 1:], plane[:-1, 1:]
        corners = np.stack([low, right, across, low, across, up], axis=2).reshape(-1, 3, 3) / 7 @ TILT + 3.3
        assert (
            listed(compiled_crossings(surface(corners)))[0] == listed(vectorised_crossings(surface(corners)))[0] == []
        )


SHIFTED = [
    ("apart", cube(3), False),
    ("at a corner", cube(1, 1, 1), False),
    ("at an edge", cube(1, 1), False),
    ("at a face", cube(1), False),
    ("at a part of a face", cube(1, 0.5, 0.25), False),
    ("at the inside of a face", cube(1, 0.25, 0.25, 0.5), False),
    ("the same", cube(), True),
    ("half along x", cube(0.5), True),
    ("half along x and y", cube(0.5, 0.5), True),
    ("half along x, y and z", cube(0.5, 0.5, 0.5), True),
    ("flush in a corner", cube(size=0.25), True),
    ("flush in a face", cube(0.3, 0.3, 0, 0.25), True),
    ("inside", cube(0.3, 0.3, 0.3, 0.25), True),
    ("pressed in by a ten-thousandth", cube(0.9999, 0.1, 0.1), True),
]


def bore(outer: float, inner: float, n: int) -> Corners:
    return revolved([(inner, 1), (inner, -1), (outer, -1), (outer, 1), (inner, 1)], n)


def shaft(radius: float, half: float, n: int) -> Corners:
    return revolved([(0, -half), (radius, -half), (radius, half), (0, half)], n)


class TestOverlap:
    @pytest.mark.parametrize("place", [0.0, 1000.0])
    @pytest.mark.parametrize("turn", [np.eye(3), TILT], ids=["straight", "tilted"])
    @pytest.mark.parametrize(("other", "expected"), [case[1:] for case in SHIFTED], ids=[case[0] for case in SHIFTED])
    def test_cubes(self, other, expected, turn, place):
        a, b = (surface(piece @ turn.T + place) for piece in (cube(), other))
        for common in (overlap(a, b), overlap(b, a)):
            assert (common is not None) == expected
            if common is not None:
                inside = (np.array(common) - place) @ turn
                for piece in (cube(), other):
                    assert (inside > piece.min(axis=(0, 1)) - 1e-9).all()
                    assert (inside < piece.max(axis=(0, 1)) + 1e-9).all()

    @pytest.mark.parametrize("scale", [1e-90, 1e-30, 1e30, 1e90])
    def test_size_does_not_matter(self, scale):
        assert overlap(surface(scale * cube()), surface(scale * cube(0.5))) is not None
        assert overlap(surface(scale * cube()), surface(scale * cube(1, 0.5))) is None

    @pytest.mark.parametrize("turn", [np.eye(3), TILT], ids=["straight", "tilted"])
    @pytest.mark.parametrize(
        ("radius", "half", "expected"),
        [
            (1, 1, False),
            (1, 2, False),
            (1, 0.5, False),
            (0.99, 1, False),
            (1.001, 1, True),
            (1.001, 0.5, True),
        ],
    )
    def test_shaft_in_a_bore(self, radius, half, expected, turn):
        hub, fit = bore(2, 1, 48) @ turn, shaft(radius, half, 48) @ turn
        assert (overlap(surface(hub), surface(fit)) is not None) == expected

    def test_a_body_in_a_cavity_is_apart_and_one_in_the_wall_is_not(self):
        hollow = surface(sphere(2, 24), flipped(sphere(1, 24)))
        assert overlap(hollow, surface(sphere(1, 24))) is None
        assert overlap(hollow, surface(sphere(0.9, 24) @ TILT)) is None
        assert overlap(hollow, surface(moved(sphere(0.3, 24), 1.5, 0, 0))) is not None

    def test_bodies_that_cross_at_edges_only(self):
        one = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
        faces = TETRAHEDRON if rational_sign(*one) > 0 else TETRAHEDRON[:, ::-1]
        assert overlap(Surface(one, faces), Surface(-one, faces[:, ::-1])) is not None

    def test_a_column_that_passes_a_face_at_a_ring_of_its_own_edges(self):
        square = np.array([[0.5, 0], [0, 0.5], [-0.5, 0], [0, -0.5]])
        rings = [np.column_stack([square, np.full(4, z)]) for z in (-1.0, 0.5, 2.0)]
        tip = [np.tile([0, 0, z], (4, 1)) for z in (-1.0, 2.0)]
        column = np.concatenate([band(tip[0], rings[0]), *map(band, rings, rings[1:]), band(rings[2], tip[1])])
        block = moved(box(4, 4, 1), 0, 0, 0)
        assert overlap(surface(block), surface(column)) is not None
        assert overlap(surface(block), surface(moved(column, 0, 0, 1.5))) is None

    def test_walls_that_end_on_one_another_like_a_pinwheel(self):
        # They share a square column; no wall crosses another, and no triangle has its middle in the column.
        outline = np.array([[0.0, 0], [10, 0], [6, 6], [1, 1], [-10, 1], [-5, -5]])
        turned = np.column_stack([1 - outline[:, 1], outline[:, 0]])
        lids = np.array([[0, 1, 3], [0, 3, 4], [1, 2, 3], [4, 5, 0]])
        one, other = (
            np.concatenate([band(low, high), high[lids], low[lids[:, ::-1]]])
            for low, high in (
                [np.column_stack([line, np.full(6, z)]) for z in (0.0, 1.0)] for line in (outline, turned)
            )
        )
        assert crossings(surface(one), surface(other)).total == 0
        place = overlap(surface(one), surface(other))
        assert place is not None
        assert all(0 < value < 1 for value in place)

    @given(st.lists(st.tuples(small, small, small), min_size=8, max_size=8))
    @settings(deadline=None, max_examples=150)
    def test_tetrahedra_overlap_unless_a_plane_separates_them(self, points):
        one, other = (np.array(part) for part in (points[:4], points[4:]))
        signs = [rational_sign(*body.tolist()) for body in (one, other)]
        assume(0 not in signs)
        a, b = (
            Surface(body, TETRAHEDRON if sign > 0 else TETRAHEDRON[:, ::-1])
            for body, sign in zip((one, other), signs, strict=True)
        )
        edges = [[body[i] - body[j] for i, j in itertools.combinations(range(4), 2)] for body in (one, other)]
        axes = [np.cross(u, v) for u, v in itertools.product(*edges)]
        axes += [np.cross(u, v) for own in edges for u, v in itertools.combinations(own, 2)]
        apart = any(
            axis.any() and ((one @ axis).max() <= (other @ axis).min() or (other @ axis).max() <= (one @ axis).min())
            for axis in axes
        )
        assert (overlap(a, b) is None) == apart

    @pytest.mark.parametrize("seed", range(40))
    def test_heaps_of_cubes_overlap_where_two_of_their_cubes_do(self, seed):
        rng = np.random.default_rng(seed)
        sizes = rng.permutation([1, 2]) if seed % 2 else (2, 3)
        shift = rng.integers(-4, 5, 3)
        cells = [heap(rng, 4), heap(rng, 4)]
        expected = any(
            all(
                max(p * sizes[0], q * sizes[1] + s) < min((p + 1) * sizes[0], (q + 1) * sizes[1] + s)
                for p, q, s in axes
            )
            for axes in ([*zip(a, b, shift, strict=True)] for a, b in itertools.product(*cells))
        )
        for turn in (np.eye(3), TILT):
            a, b = (
                surface((size * wall(own) + offset) @ turn)
                for size, own, offset in zip(sizes, cells, (0 * shift, shift), strict=True)
            )
            assert (overlap(a, b) is not None) == expected


def heap(rng: np.random.Generator, count: int) -> set[tuple[int, int, int]]:
    """Grow a heap of unit cells from the origin, each at a face of an earlier one."""
    cells = [(0, 0, 0)]
    while len(cells) < count:
        step = np.zeros(3, int)
        step[rng.integers(3)] = rng.choice([-1, 1])
        cells.append(tuple((np.array(cells[rng.integers(len(cells))]) + step).tolist()))
    return set(cells)


def wall(cells: set[tuple[int, int, int]]) -> Corners:
    """Return the outer faces of a heap of unit cells."""
    pieces = []
    for cell in cells:
        faces = cube(*cell)
        normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]).astype(int)
        pieces.append(faces[[tuple(np.add(cell, n).tolist()) not in cells for n in normal]])
    return np.concatenate(pieces)


@pytest.mark.parametrize("limit", [1, 7, 40, 10_000])
def test_copies_cross_what_the_first_of_them_crosses(limit: int) -> None:
    """Copies with their corners in any order: the pairs listed are the first of all those that there are."""
    rng = np.random.default_rng(limit)
    vertices = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [1, 1, -1], [2, 1, 1], [1, 2, 1], [3, 3, -1], [4, 3, 1], [3, 4, 1]]
    kind = rng.permutation(np.repeat([0, 1, 2, 3], [5, 9, 1, 3]))
    faces = np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8], [0, 0, 1]])[kind]
    turned = rng.permuted(faces, axis=1)
    contacts = crossings(Surface(vertices, turned), limit=limit)
    every = [(i, j) for i in range(18) for j in range(i + 1, 18) if {kind[i], kind[j]} in ({0, 1}, {0, 2})]
    assert contacts.total == len(every) == 50
    assert [tuple(pair) for pair in contacts.pairs.tolist()] == every[:limit]
    assert contacts.truncated == (limit < 50)
    for (i, j), (x, y, z) in zip(contacts.pairs, contacts.points, strict=True):
        near = 1.0 if 1 in kind[[i, j]] else 3.0
        assert near < x < near + 1
        assert near < y < near + 1
        assert z == 0


def test_very_many_copies_are_not_compared_with_one_another() -> None:
    """Of 300,000 copies there are 45 billion pairs."""
    faces = np.vstack([np.tile([[0, 1, 2]], (150_000, 1)), np.tile([[1, 2, 0]], (150_000, 1)), [[3, 4, 5], [0, 0, 0]]])
    contacts = crossings(Surface([[0, 0, 0], [9, 0, 0], [0, 9, 0], [1, 1, -1], [2, 1, 1], [1, 2, 1]], faces), limit=3)
    assert contacts.total == 300_000
    assert contacts.pairs.tolist() == [[0, 300_000], [1, 300_000], [2, 300_000]]


def cone(turns: int, sides: int, seed: int) -> Surface:
    """A cone over a rim that goes around it so many times, up and down, turned somehow; its triangles in no order."""
    rng = np.random.default_rng(seed)
    around = 2 * np.pi * np.arange(sides) / sides
    rim = np.column_stack([np.cos(turns * around), np.sin(turns * around), 2 + 0.3 * np.cos(5 * around)])
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    own = 1 + np.arange(sides)
    faces = np.column_stack([0 * own, own, np.roll(own, -1)])
    faces = np.take_along_axis(faces, (rng.integers(0, 3, (sides, 1)) + np.arange(3)) % 3, axis=1)
    return Surface(np.vstack([[0, 0, 0], rim]) @ turn * 10.0 ** rng.integers(-100, 60), rng.permutation(faces))


@pytest.mark.parametrize(("turns", "seed"), [(1, 0), (2, 1), (3, 2), (7, 3)])
def test_triangles_around_one_vertex_cross_as_all_their_pairs_say(turns: int, seed: int) -> None:
    fan = cone(turns, 1500, seed)
    needle = fan.corners().mean(axis=(0, 1)) * [[0.9], [1.1], [1.1]] + 1e-3 * np.eye(3) * np.abs(fan.vertices).max()
    both = Surface(np.vstack([fan.vertices, needle]), np.vstack([fan.faces, [[1501, 1502, 1503]]]))
    crossed = crossings(both, limit=10**6)
    expected = np.concatenate([pairs for pairs, *_ in vectorised_crossings(both)])
    assert (expected < 1500).all(axis=1).any() == (turns > 1)
    expected = expected[np.lexsort(expected.T[::-1])]
    assert np.array_equal(crossed.pairs, expected)
    assert crossed.total == len(expected)
    labels = np.arange(both.count) % 2
    among = crossings(both, limit=10**6, labels=labels)
    assert np.array_equal(among.pairs, expected[labels[expected[:, 0]] == labels[expected[:, 1]]])


def test_of_triangles_around_one_vertex_few_pairs_are_compared() -> None:
    fan = cone(1, 4000, 0)
    fans = hubs(fan)
    assert fans is not None
    vertices, faces, hub = fans
    assert (hub == hub[0]).all()
    assert sum(len(i) for i, *_ in near_around(vertices, faces, int(hub[0]))) < 4 * 4000
