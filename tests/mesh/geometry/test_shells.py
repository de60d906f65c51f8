"""Shells, what contains what, and bodies: against solid angles, exact volumes and nested solids."""

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from tests.mesh.solids import Mesh, box, cube, facets, inside_out, joined, ring, sphere

from inertia import native
from inertia.mesh.geometry import shells as module
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.enclosed import FEW, NOISE, RUN, STORED, measured
from inertia.mesh.geometry.shells import Shell, absolute_orientation, bodies, members, shells
from inertia.mesh.geometry.sound_shells import sound_bodies
from inertia.mesh.geometry.winding import windings, windings_under
from inertia.mesh.surface import Surface, Triangles


def shells_of(surface: Surface) -> tuple[Shell, ...]:
    return shells(surface, closure(surface))


def nesting(surface: Surface) -> list[tuple[str, int, int, int | None]]:
    return [(s.kind, s.winding_outside, s.depth, s.parent) for s in shells_of(surface)]


def grouped(surface: Surface) -> list[tuple[int, ...]]:
    return [body.shells for body in bodies(shells_of(surface))]


def solid_angles(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the winding number as the solid angle over 4π (van Oosterom and Strackee, 1983, eq. 8)."""
    a, b, c = (corners[None, :, k] - points[:, None] for k in range(3))
    x, y, z = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    triple = (a * np.cross(b, c)).sum(axis=2)
    rest = x * y * z + (a * b).sum(axis=2) * z + (b * c).sum(axis=2) * x + (c * a).sum(axis=2) * y
    return np.arctan2(triple, rest).sum(axis=1) / (2 * np.pi)


def exact_volume(surface: Surface) -> Fraction:
    total = Fraction(0)
    for a, b, c in surface.corners().tolist():
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([Fraction(x) for x in corner] for corner in (a, b, c))
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total / 6


@pytest.mark.parametrize("solid", [cube(size=2), sphere(), ring(24, 12, radius=1), inside_out(sphere(splits=2))])
def test_winding_numbers_are_those_of_the_solid_angle(solid: tuple) -> None:
    corners = joined(solid).corners()
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (400, 3))
    winding, _ = windings(points, corners, 0.0)
    expected = solid_angles(points, corners)
    assert np.abs(expected - winding).max() < 1e-9
    assert set(np.abs(winding).tolist()) == {0, 1}


def test_a_ray_through_vertices_along_edges_and_in_faces_counts_once() -> None:
    corners = joined(cube(size=4), cube((0, 0, 0), 2)).corners()
    across, along = [-3, -2, -1, -0.5, 0, 0.5, 1, 2, 3], [-2.5, -1.5, -0.5, 0, 0.5, 1.5, 2.5]
    points = np.stack(np.meshgrid(across, across, along), axis=-1).reshape(-1, 3).astype(float)
    distance = np.abs(points).max(axis=1)
    points = points[(distance != 1) & (distance != 2)]
    expected = (np.abs(points) < 2).all(axis=1).astype(int) + (np.abs(points) < 1).all(axis=1)
    winding, _ = windings(points, corners, 0.0)
    assert np.array_equal(winding, expected)


def test_winding_adds_up_over_pieces_and_many_points() -> None:
    corners = joined(ring(200, 60)).corners()
    points = np.random.default_rng(1).uniform((-4, -4, -1), (4, 4, 1), (3000, 3))
    whole, clearance = windings(points, corners, 0.1)
    pieces = [windings(points, corners[k::3], 0.1) for k in range(3)]
    assert np.array_equal(whole, sum(winding for winding, _ in pieces))
    assert np.array_equal(clearance, np.min([distance for _, distance in pieces], axis=0))
    inside = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 3, points[:, 2])
    assert (whole[inside < 0.99] == 1).all()
    assert (whole[inside > 1] == 0).all()


def test_clearance_is_the_distance_to_the_face_beside() -> None:
    points = np.array([[0.0, 0.2, 0.499], [0.45, 0.1, 0.2], [0, 0, 0]])
    _, clearance = windings(points, joined(cube()).corners(), 0.06)
    assert clearance == pytest.approx([0.001, 0.05, np.inf], rel=1e-12)


def test_a_triangle_without_area_is_in_nobodys_way() -> None:
    line = np.array([[[-1, -1, -1], [1, 1, 1], [0, 0, 0]]], float)
    winding, clearance = windings(np.array([[0.5, 0.5, 0.5], [0.2, 0.3, 0.1]]), line, 0.1)
    assert (winding.tolist(), clearance.tolist()) == ([0, 0], [np.inf, np.inf])


def test_a_shell_is_measured() -> None:
    surface = joined(cube((7, 0, 0)), inside_out(sphere((1, 2, 3), 2)))
    first, second = shells_of(surface)
    assert (first.number, first.kind, first.triangles, first.first) == (0, "outward", 12, 0)
    assert (second.number, second.kind, second.triangles, second.first) == (1, "inward", 512, 12)
    assert first.signed_volume == 1
    assert second.signed_volume == pytest.approx(float(exact_volume(joined(inside_out(sphere((1, 2, 3), 2))))))
    assert first.box.tolist() == [[6.5, -0.5, -0.5], [7.5, 0.5, 0.5]]
    assert second.box.tolist() == [[-1, 0, 1], [3, 4, 5]]


@pytest.mark.parametrize("stored", [False, True])
@pytest.mark.parametrize("few", [False, True])
@pytest.mark.parametrize("size", [1, 4, 7, 8, 9, 63, 64, 65, 200, 1_000])
def test_pieces_of_any_length_are_measured_wherever_their_triangles_lie(size: int, few: bool, stored: bool) -> None:
    rng = np.random.default_rng(size)
    count = 5_003
    corners = (rng.standard_normal(3) + rng.standard_normal((count, 3, 3)) / 8).astype(np.float32).astype(float)
    labels = (np.arange(count) // size % 5 - 1).astype(np.int32)
    soup = Surface(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    pieces = measured(facets(soup) if stored else soup, labels, 4, few=few)
    for piece, (*extent, volume, squares, x, y, z, number) in enumerate(pieces.table.tolist()):
        own = corners[labels == piece]
        assert (number, extent) == (len(own), [*own.min(axis=(0, 1)), *own.max(axis=(0, 1))])
        origin = [Fraction(value) for value in (x, y, z)]
        exact = sum(determinant(triangle, origin) for triangle in own.tolist())
        assert abs(float(Fraction(volume) - exact)) <= (NOISE + number * STORED) * math.sqrt(number * squares)
    starts = np.arange(0, count, RUN)
    alone = np.minimum.reduceat(labels, starts) == np.maximum.reduceat(labels, starts)
    assert pieces.shell.tolist() == np.where(alone, labels[starts], -2).tolist()
    within = np.flatnonzero(alone & (labels[starts] >= 0))
    low, high = np.minimum.reduceat(corners.min(axis=1), starts), np.maximum.reduceat(corners.max(axis=1), starts)
    assert (pieces.boxes[within] == np.hstack([low, high])[within]).all()
    if few:
        starts = np.arange(0, count, FEW)
        low, high = np.minimum.reduceat(corners.min(axis=1), starts), np.maximum.reduceat(corners.max(axis=1), starts)
        assert (pieces.few[:, :3] <= low).all()
        assert (pieces.few[:, 3:] >= high).all()
        assert np.allclose(pieces.few, np.hstack([low, high]), rtol=2.0**-22, atol=0)


def determinant(triangle: list[list[float]], origin: list[Fraction]) -> Fraction:
    a, b, c = ([Fraction(x) - y for x, y in zip(corner, origin, strict=True)] for corner in triangle)
    cross = b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]
    return sum((x * y for x, y in zip(a, cross, strict=True)), Fraction(0))


@pytest.mark.parametrize("offset", [0.0, 1e6, -(2.0**40)])
@pytest.mark.parametrize("scale", [2.0**-200, 1.0, 2.0**200])
def test_volume_and_nesting_keep_their_digits_at_any_offset_and_scale(offset: float, scale: float) -> None:
    surface = joined(sphere(splits=2), inside_out(sphere((0.25, 0, 0), 0.5, splits=1)))
    moved = Surface((np.round(surface.vertices * 2**10) / 2**10 + offset) * scale, surface.faces)
    outer, inner = shells_of(moved)
    assert (outer.depth, inner.depth, inner.parent) == (0, 1, 0)
    pieces = [moved.select(index) for index in members(closure(moved))]
    for shell, piece in zip((outer, inner), pieces, strict=True):
        assert shell.signed_volume == pytest.approx(float(exact_volume(piece)), rel=1e-14)


def test_a_shell_over_many_chunks_has_its_volume_and_box() -> None:
    rings = joined(ring(500, 100), ring(300, 100, radius=20, tube=2))
    mixed = rings.select(np.random.default_rng(4).permutation(rings.count))
    stored = facets(mixed)
    for several in (shells_of(mixed), shells(stored, closure(stored))):
        assert len(several) == 2
        for shell in several:
            piece = rings.select(np.arange(100_000) if shell.triangles == 100_000 else np.arange(100_000, rings.count))
            assert shell.triangles == piece.count
            assert shell.signed_volume == pytest.approx(math.fsum(np.linalg.det(piece.corners())) / 6, rel=1e-6)
            corners = piece.corners().reshape(-1, 3)
            assert shell.box == pytest.approx(np.array([corners.min(axis=0), corners.max(axis=0)]), rel=1e-6)


def test_a_doll_in_a_doll_has_its_depth() -> None:
    dolls = [sphere(radius=r, splits=2) for r in (5, 4, 3, 2, 1)]
    surface = joined(*(inside_out(doll) if k % 2 else doll for k, doll in enumerate(dolls)))
    assert nesting(surface) == [
        ("outward", 0, 0, None),
        ("inward", 1, 1, 0),
        ("outward", 0, 2, 1),
        ("inward", 1, 3, 2),
        ("outward", 0, 4, 3),
    ]
    assert grouped(surface) == [(0, 1), (2, 3), (4,)]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_an_insert_that_fills_a_cavity_is_a_body_inside_it(order: tuple[int, ...]) -> None:
    solids = [cube(size=4), inside_out(sphere()), sphere()]
    surface = joined(*(solids[k] for k in order))
    housing, cavity, insert = (order.index(k) for k in range(3))
    depths = nesting(surface)
    assert depths[housing] == ("outward", 0, 0, None)
    assert depths[cavity] == ("inward", 1, 1, housing)
    assert depths[insert] == ("outward", 0, 2, cavity)
    assert sorted(grouped(surface)) == sorted([(housing, cavity), (insert,)])


def test_boxes_that_nest_do_not_make_a_container() -> None:
    surface = joined(ring(), sphere(radius=1), sphere((3, 0, 0), 0.5))
    assert nesting(surface) == [("outward", 0, 0, None), ("outward", 0, 0, None), ("outward", 1, 1, 0)]


@pytest.mark.parametrize("side", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_shell_that_touches_the_wall_around_it_is_inside(side: int, sign: int) -> None:
    middle = [0.0, 0.0, 0.0]
    middle[side] = sign * 1.5
    assert nesting(joined(cube(size=4), cube(tuple(middle))))[1] == ("outward", 1, 1, 0)
    assert nesting(joined(cube(size=4), inside_out(cube(tuple(middle)))))[1] == ("inward", 1, 1, 0)


def test_a_wall_of_a_billionth_is_a_wall() -> None:
    hollow = joined(sphere(), inside_out(sphere(radius=1 - 1e-9)))
    assert nesting(hollow) == [("outward", 0, 0, None), ("inward", 1, 1, 0)]


def test_of_two_copies_one_is_inside_the_other() -> None:
    assert nesting(joined(cube(), cube())) == [("outward", 0, 0, None), ("outward", 1, 1, 0)]


def test_an_inverted_shell_and_what_is_in_it() -> None:
    surface = joined(inside_out(cube(size=4)), cube(), cube((9, 0, 0)))
    assert nesting(surface) == [("inward", 0, 0, None), ("outward", -1, 1, 0), ("outward", 0, 0, None)]
    assert grouped(surface) == [(0, 1), (2,)]


def test_faces_that_cancel_are_a_sheet_and_no_body() -> None:
    plate = np.array([[0, 0, 0], [3, 0, 0], [3, 2, 1], [0, 2, 1]]) / 7
    sheet = (plate, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 2], [0, 2, 1]]))
    fold = (plate + 1, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))  # the other diagonal, same plane
    surface = joined(cube(size=4), sheet, fold)
    shells = shells_of(surface)
    assert len(shells) > 2
    assert {shell.kind for shell in shells[1:]} == {"sheet"}
    assert [shell.depth for shell in shells] == [0, *(1 for _ in shells[1:])]
    assert grouped(surface) == [(0,)]
    assert absolute_orientation(shells).tolist() == []


def test_two_ways_to_fill_the_same_flat_rim_are_a_sheet_however_it_is_rounded() -> None:
    turn = 2 * np.pi * np.arange(30) / 30
    rim = np.outer(np.cos(turn), [0.6, 0.0, 0.8]) + np.outer(np.sin(turn), [0.48, 0.8, -0.36]) + 1 / 3
    fans = [[[start, (start + k) % 30, (start + k + 1) % 30] for k in range(1, 29)] for start in (0, 11)]
    shells = shells_of(Surface(rim, np.vstack([fans[0], np.array(fans[1])[:, ::-1]])))
    assert exact_volume(Surface(rim, np.vstack([fans[0], np.array(fans[1])[:, ::-1]]))) != 0
    assert {shell.kind for shell in shells} == {"sheet"}


def test_a_thin_plate_is_no_sheet() -> None:
    thin = joined(cube())
    thin = Surface(thin.vertices * [1, 1, 1e-9], thin.faces)
    (shell,) = shells_of(thin)
    assert (shell.kind, shell.signed_volume) == ("outward", pytest.approx(1e-9, rel=1e-14))


@settings(deadline=None, max_examples=40)
@given(st.lists(st.booleans(), min_size=4, max_size=4))
def test_absolute_orientation_mends_any_set_of_turned_shells(turned: list[bool]) -> None:
    solids = [
        sphere(radius=4, splits=1),
        inside_out(sphere(radius=3, splits=1)),
        sphere(splits=1),
        cube((9, 0, 0)),
    ]
    surface = joined(*(inside_out(s) if turn else s for s, turn in zip(solids, turned, strict=True)))
    inverted = absolute_orientation(shells_of(surface))
    assert inverted.tolist() == [number for number, turn in enumerate(turned) if turn]


SIDE = st.tuples(st.integers(0, 6), st.integers(1, 6)).map(lambda side: (side[0], side[0] + side[1]))


@settings(deadline=None, max_examples=100)
@given(st.lists(st.tuples(SIDE, SIDE, SIDE, st.booleans()), min_size=1, max_size=8))
def test_every_shell_is_in_one_body_however_boxes_overlap_and_touch(boxes: list) -> None:
    solids = [box(*zip(*sides, strict=True)) for *sides, _ in boxes]
    turned = [inside_out(s) if turn else s for s, (*_, turn) in zip(solids, boxes, strict=True)]
    shells = shells_of(joined(*turned))
    assert sorted(number for body in bodies(shells) for number in body.shells) == list(range(len(shells)))
    for shell in shells:
        assert (shell.parent is None) == (shell.depth == 0)


def test_a_thousand_pores_are_found_in_one_body() -> None:
    places = np.stack(np.meshgrid(*[np.arange(10.0)] * 3), axis=-1).reshape(-1, 3)
    pores = [inside_out(cube(tuple(place), 0.5)) for place in places]
    shells = shells_of(joined(cube((4.5, 4.5, 4.5), 12), *pores))
    assert {(shell.kind, shell.depth, shell.parent) for shell in shells[1:]} == {("inward", 1, 0)}
    assert [len(body.shells) for body in bodies(shells)] == [1001]


@pytest.mark.parametrize("seed", range(20))
def test_what_is_in_what_is_the_same_found_at_once_and_pair_by_pair(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(seed)
    meshes = []
    for place in np.stack(np.unravel_index(np.arange(8), (2, 2, 2)), axis=-1) * 6.0:
        for depth in range(random.integers(1, 9)):
            across = 4.0 * 0.5**depth
            mesh = cube(tuple(place), across) if random.random() < 0.5 else sphere(tuple(place), across / 2)
            meshes.append(inside_out(mesh) if depth % 2 else mesh)
    order = random.permutation(len(meshes))
    surface = joined(*(meshes[k] for k in order))
    assert any(shell.depth > 2 for shell in shells_of(surface))
    asked: list[int] = []
    between = module.windings_each
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    monkeypatch.setattr(module, "windings_each", lambda *rest: asked.append(1) or between(*rest))
    monkeypatch.setattr(module, "FEW", 0)
    at_once = nesting(surface)
    assert not asked
    monkeypatch.setattr(module, "FEW", 1_000_000)
    assert nesting(surface) == at_once
    assert asked


def test_members_leave_out_triangles_with_a_repeated_corner() -> None:
    surface = joined(cube(), cube((3, 0, 0)))
    faces = np.insert(surface.faces, 3, [[2, 2, 5]], axis=0)
    broken = Surface(surface.vertices, faces)
    one, other = members(closure(broken))
    assert one.tolist() == [0, 1, 2, *range(4, 13)]
    assert other.tolist() == list(range(13, 25))
    assert [shell.triangles for shell in shells_of(broken)] == [12, 12]


@pytest.mark.parametrize("wall", [1e-10, 1e-12, 1e-13, 1e-15])
@pytest.mark.parametrize("turn", [None, [0.4, -0.3, 0.8]])
@pytest.mark.parametrize("solid", [cube, sphere])
def test_a_wall_as_thin_as_the_last_digits_is_a_wall(wall: float, turn: list[float] | None, solid: type) -> None:
    vertices, faces = solid()
    if turn is not None:
        vertices = vertices @ Rotation.from_rotvec(turn).as_matrix().T
        wall = max(wall, 1e-14)  # below that the turned faces cross
    hollow = joined((vertices, faces), inside_out((vertices * (1 - wall), faces)))
    assert nesting(hollow) == [("outward", 0, 0, None), ("inward", 1, 1, 0)]


def test_a_body_and_one_that_lies_a_last_digit_beside_it_do_not_nest() -> None:
    one, other = cube(), cube(size=0.5)
    beside = other[0] + [0.75 + 2.0**-50, 0, 0], other[1]
    assert nesting(joined(one, beside)) == [("outward", 0, 0, None)] * 2


def test_winding_numbers_just_under_a_surface_are_those_of_its_inside() -> None:
    points, faces = sphere()
    corners = points[faces]
    winding, decided = windings_under(corners, corners)
    assert decided.all()
    assert (winding == 1).all()
    for shift, inside in ((2.0**-52, 1), (-(2.0**-52), 0)):
        outer = corners * (1 + shift)
        winding, decided = windings_under(corners, outer)
        assert (winding[decided] == inside).all()
    turned = corners[:, ::-1]
    assert (windings_under(turned, corners)[0] == 0).all()


def at(x: float) -> Mesh:
    return box((x, 0.0, 0.0), (x + 2.0, 2.0, 2.0))


@pytest.mark.parametrize("store", [facets, lambda surface: surface], ids=["facets", "surface"])
@pytest.mark.parametrize(
    ("others", "apart"),
    [
        ([at(3.0)], True),
        ([box((0.5, 0.5, 0.5), (1.5, 1.5, 1.5))], False),
        ([at(2.0)], True),  # they have a side in common, and share no space
        ([inside_out(at(3.0))], False),
        ([at(3.0), at(3.0)], False),
        ([at(3.0), at(6.0)], True),
    ],
)
def test_bodies_whose_boxes_share_no_space_are_apart(
    others: list[Mesh], apart: bool, store: Callable[[Surface], Triangles], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    triangles = store(joined(at(0.0), *others))
    assert sound_bodies(triangles, closure(triangles)) == (1 + len(others) if apart else None)
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    assert sound_bodies(triangles, closure(triangles)) is None


@pytest.mark.parametrize("turned", [False, True])
def test_a_shell_without_certain_volume_is_not_apart(turned: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    plate = box((9.0, 9.0, 9.0), (10.0, 10.0, 9.0 + 2e-15))
    triangles = joined(at(0.0), inside_out(plate) if turned else plate)
    assert sound_bodies(triangles, closure(triangles)) is None
