"""How deep bodies that touch reach into each other, against linear programmes; triangles that touch, against fractions.

A ball in what two convex bodies share fits between the planes that bound either; the largest one is found by a linear
programme. Where a plane shows that they reach no deeper than δ into each other, its diameter is δ at most.
"""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from inertia.arrays import Float, Int
from inertia.mesh.check import check
from inertia.mesh.cut import block
from inertia.mesh.geometry.contact_planes import touching_depths
from inertia.mesh.geometry.intersect import crossings
from inertia.mesh.geometry.near_triangles import COMPARED, crossing_triangles, touching_triangles
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface

CUBE = block([0, 0, 0], np.eye(3)).corners()


def hull(points: Float) -> Float:
    """Return the triangles (n, 3, 3) of a convex hull, outward."""
    corners = points[ConvexHull(points).simplices]
    inwards = points.mean(axis=0) - corners[:, 0]
    turned = np.einsum("ni,ni->n", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), inwards) > 0
    corners[turned] = corners[turned][:, ::-1]
    return corners


def largest_ball(*bodies: Float) -> float:
    """Return the radius of the largest ball in what convex bodies (n, 3, 3) share, about 0 where that is nothing."""
    planes = [ConvexHull(corners.reshape(-1, 3)).equations for corners in bodies]
    equations = np.concatenate(planes)
    rows = np.column_stack([equations[:, :3], np.ones(len(equations))])
    result = linprog([0, 0, 0, -1], rows, -equations[:, 3], bounds=[(None, None)] * 4, options={"presolve": True})
    return float(result.x[3])


def numbered(*bodies: Float) -> tuple[Float, list[Int]]:
    """Return the triangles of bodies together, and the numbers of each."""
    ends = np.cumsum([len(body) for body in bodies])
    return np.concatenate(bodies), [np.arange(end - len(body), end) for body, end in zip(bodies, ends, strict=True)]


def depth_of(one: Float, other: Float, most: float) -> float:
    corners, (a, b) = numbered(one, other)
    return float(touching_depths(corners, [(a, b)], np.array([most]))[0])


def turned(corners: Float, seed: int, single: bool = False) -> Float:
    """Return triangles turned and moved somewhere, rounded to float32 where it is asked for."""
    rng = np.random.default_rng(seed)
    moved = corners @ Rotation.random(random_state=rng).as_matrix().T + rng.uniform(-5, 5, 3)
    return moved.astype(np.float32).astype(float) if single else moved


@pytest.mark.parametrize("seed", range(40))
def test_no_place_that_two_bodies_share_is_deeper_than_is_said(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one = hull(rng.normal(size=(rng.integers(4, 20), 3)))
    face = one[rng.integers(len(one))]
    out = np.cross(face[1] - face[0], face[2] - face[0])
    # The other has a face in the plane of one of the first's, or a corner, a little within.
    base = np.concatenate([face * rng.uniform(0.1, 2.0), face.mean(axis=0) + out * rng.uniform(0.5, 2, (6, 1))])
    base[3:] += rng.normal(size=(6, 3)) * 0.3
    low = ((base - face[0]) @ out).min() / np.linalg.norm(out)
    deep = 10.0 ** rng.uniform(-12, -1) * rng.choice([-1, 1])
    other = hull(base - (low + deep) * out / np.linalg.norm(out))
    both = turned(np.concatenate([one, other]), seed)
    one, other = both[: len(one)], both[len(one) :]
    radius = largest_ball(one, other)
    most = 10.0 ** rng.uniform(-8, 0)
    said = depth_of(one, other, most), depth_of(other, one, most)
    for depth in said:
        assert depth <= most or depth == np.inf
        assert 2 * radius <= depth * (1 + 1e-9) + 1e-12
    if 1e-11 < deep < most / 2 or -deep > 1e-11:
        assert max(said) < np.inf  # the plane that the other was put at shows it


@pytest.mark.parametrize("digits", [0, 53, 20])
def test_what_is_in_a_plane_shares_nothing_and_a_last_digit_counts(digits: int) -> None:
    depth = 2.0**-digits if digits else 0.0
    for axis in range(3):
        moved = np.where(np.arange(3) == axis, 1 - depth, 2.0**-30)
        said = depth_of(CUBE, CUBE + moved, 1e-6)
        assert said == 0 if depth == 0 else depth <= said <= depth + 1e-13


def test_bodies_that_rounding_makes_cross_are_not_said_to_share_nothing() -> None:
    crossing = 0
    for seed in range(60):
        both = turned(np.concatenate([CUBE, np.add(CUBE, [1, 0.25, 0.5])]), seed)
        surface = Surface(both.reshape(-1, 3), np.arange(72).reshape(-1, 3))
        if crossings(surface.select(np.arange(12)), surface.select(np.arange(12, 24))).total:
            crossing += 1
            assert 0 < depth_of(both[:12], both[12:], 1e-6) < 1e-12
    assert crossing > 10


@pytest.mark.parametrize("single", [False, True])
def test_bricks_in_a_bond_touch_only(single: bool) -> None:
    places = np.array([[2 * x + z % 2, y, z] for x, y, z in product(range(3), repeat=3)], float)
    corners = turned((CUBE * [2, 1, 1] + places[:, None, None]).reshape(-1, 3, 3), 3, single)
    near = [(k, m) for k in range(27) for m in range(k) if (np.abs(places[k] - places[m]) <= [2, 1, 1]).all()]
    numbers = np.arange(27 * 12).reshape(27, 12)
    depths = touching_depths(corners, [(numbers[k], numbers[m]) for k, m in near], np.full(len(near), 2e-6))
    assert depths.max() < (2e-6 if single else 1e-13)


def test_several_pairs_are_told_apart() -> None:
    corners, (a, b, c, d) = numbered(
        CUBE, np.add(CUBE, [1, 0.5, 0.5]), np.add(CUBE, [0.5, 1 - 1e-7, 0]), np.add(CUBE, [0.5, 0.5, 0.5])
    )
    nothing = np.empty(0, np.int64)
    depths = touching_depths(corners, [(a, b), (a, c), (a, d), (a, nothing), (b, a)], np.full(5, 1e-6))
    assert depths == pytest.approx([0, 1e-7, np.inf, 0, 0], rel=1e-6, abs=0)
    assert len(touching_depths(corners, [], np.empty(0))) == 0


def test_triangles_without_area_hold_nothing_apart() -> None:
    flat = np.repeat(CUBE[:1, :1], 3, axis=1)
    assert depth_of(np.concatenate([flat, CUBE]), np.add(CUBE, [1, 0, 0]), 1e-6) == 0
    assert depth_of(flat + 0.5, CUBE, 1e-6) == np.inf


def bricks(count: int) -> Float:
    """Return bricks (n, 12, 3, 3) that stand side by side, turned, as float32."""
    places = np.array(list(product(range(count), repeat=3)), float)
    return turned((CUBE + places[:, None, None]).reshape(-1, 3, 3), 8, single=True).reshape(-1, 12, 3, 3)


def part_of(corners: Float) -> Part:
    return Part(Surface(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3)))


def test_one_brick_of_many_that_is_pushed_into_its_neighbours_is_found() -> None:
    corners = bricks(4)
    assert check(part_of(corners)).fit
    for deep, fit in ((2e-7, True), (1e-4, False)):
        pushed = corners.copy()
        pushed[21] -= deep * (corners[42].mean(axis=(0, 1)) - corners[0].mean(axis=(0, 1)))
        report = check(part_of(pushed))
        assert report.fit == fit
        if not fit:
            [error] = [finding for finding in report.findings if finding.severity == "error"]
            assert error.code == "overlapping_bodies"
            assert 21 in {face // 12 for face in error.faces}


def test_a_body_within_a_body_is_not_taken_for_one_that_touches() -> None:
    # Where bodies are taken by themselves the inner one shares all of its volume, and a face with the outer.
    inner = CUBE * 0.5 + [0.25, 0.25, 0]
    for moved in (0, 1e-7, -1e-7):
        report = check(part_of(np.concatenate([CUBE, np.add(inner, [0, 0, moved])])), parts="separate")
        [shared] = [finding for finding in report.findings if finding.code == "shared_space"]
        assert shared.doubt is not None
        assert shared.doubt.volume == pytest.approx(0.125, rel=1e-6)


def side_of(plane: Float, point: Float) -> int:
    """Return on which side of a triangle's plane a point lies, by fractions."""
    a, *rest = [[Fraction(x) for x in corner] for corner in (*plane.tolist(), point.tolist())]
    u, v, w = ([x - y for x, y in zip(one, a, strict=True)] for one in rest)
    across = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    value = sum(x * y for x, y in zip(across, w, strict=True))
    return (value > 0) - (value < 0)


def held_apart(one: Float, other: Float) -> bool:
    return any(
        {side_of(plane, point) for point in points} in ({1}, {-1}) for plane, points in ((one, other), (other, one))
    )


@pytest.mark.parametrize("seed", range(3))
def test_triangles_that_touch_are_those_that_no_plane_of_theirs_holds_apart(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.integers(0, 6, (90, 3, 3)) / 2.0
    some = [np.sort(own) for own in np.split(rng.permutation(90), [20, 40, 65])]
    sides = [(some[0], some[1]), (some[2], some[3]), (some[1], some[2])]
    low, high = corners.min(axis=1), corners.max(axis=1)
    expected = {
        (pair, i, j)
        for pair, (one, other) in enumerate(sides)
        for i, j in product(one.tolist(), other.tolist())
        if (low[i] <= high[j]).all() and (low[j] <= high[i]).all() and not held_apart(corners[i], corners[j])
    }
    found = touching_triangles(corners, sides)
    assert set(zip(*(column.tolist() for column in found), strict=True)) == expected
    crossed = crossing_triangles(corners, *found[1:])
    listed = set(zip(*(column[crossed].tolist() for column in found), strict=True))
    surface = Surface(corners.reshape(-1, 3), np.arange(270).reshape(-1, 3))
    assert listed == {
        (pair, int(one[i]), int(other[j]))
        for pair, (one, other) in enumerate(sides)
        for i, j in crossings(surface.select(one), surface.select(other), limit=10_000).pairs.tolist()
    }


def test_bodies_of_many_triangles_are_compared_as_those_of_few(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    balls = rng.normal(size=(2, 90, 3))
    balls /= np.linalg.norm(balls, axis=2, keepdims=True)
    corners = np.concatenate([hull(balls[0]), hull(np.add(balls[1], [1.5, 0, 0]))])
    sides = [(np.arange(len(corners) // 2), np.arange(len(corners) // 2, len(corners)))]
    assert len(sides[0][0]) * len(sides[0][1]) > COMPARED
    with_tree = touching_triangles(corners, sides)
    monkeypatch.setattr("inertia.mesh.geometry.near_triangles.COMPARED", 10**6)
    without = touching_triangles(corners, sides)
    assert len(without[0]) > 0
    assert set(zip(*map(list, with_tree), strict=True)) == set(zip(*map(list, without), strict=True))
