"""The exact account of edges and faces: counted against dictionaries, and placed against known solids."""

import itertools
import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import Mesh, cube, joined, moebius, ring

from inertia.mesh.geometry.edges import (
    Edges,
    Loop,
    boundary_loops,
    duplicates,
    first_equal,
    flat,
    pair_edges,
    pieces,
)
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners

CUBE = cube((5, 5, 5), size=10)
NODE = st.integers(0, 6)
SOUPS = st.lists(st.tuples(NODE, NODE, NODE), max_size=40).map(lambda faces: np.array(faces, int).reshape(-1, 3))


def loops_of(mesh: Mesh) -> tuple[Loop, ...]:
    vertices, faces = merge_equal_vertices(joined(mesh))
    return boundary_loops(vertices, pair_edges(faces))


def without(mesh: Mesh, *faces: int) -> Mesh:
    return mesh[0], np.delete(mesh[1], faces, axis=0)


def directed(faces: np.ndarray) -> list[tuple[int, int, int]]:
    """Return (tail, head, face) of the edges of all faces with three different corners."""
    return [
        (face[k], face[(k + 1) % 3], number)
        for number, face in enumerate(faces.tolist())
        if len(set(face)) == 3
        for k in range(3)
    ]


@settings(deadline=None)
@given(SOUPS)
def test_every_use_of_every_edge_is_counted(faces: np.ndarray) -> None:
    uses = Counter((tail, head) for tail, head, _ in directed(faces))
    edges = pair_edges(faces)
    ends = [tuple(row) for row in edges.ends.tolist()]
    assert ends == sorted({tuple(sorted(edge)) for edge in uses})
    assert edges.forward.tolist() == [uses[low, high] for low, high in ends]
    assert edges.backward.tolist() == [uses[high, low] for low, high in ends]
    users = [number for low, high in ends for a, b, number in directed(faces) if {a, b} == {low, high}]
    assert edges.users.tolist() == users


@settings(deadline=None)
@given(SOUPS)
def test_every_boundary_edge_is_in_one_loop(faces: np.ndarray) -> None:
    vertices = np.random.default_rng(0).random((7, 3))
    edges = pair_edges(faces)
    loops = boundary_loops(vertices, edges)
    assert sum(loop.edges for loop in loops) == edges.boundary.sum()
    ends = vertices[edges.ends[edges.boundary]]
    assert math.isclose(
        sum(loop.length for loop in loops),
        np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum(),
        abs_tol=1e-12,
    )
    assert [loop.length for loop in loops] == sorted((loop.length for loop in loops), reverse=True)
    odd = Counter(vertex for edge in edges.ends[edges.boundary].tolist() for vertex in edge)
    assert sum(not loop.closed for loop in loops) == sum(count % 2 for count in odd.values()) / 2


@settings(deadline=None)
@given(SOUPS)
def test_pieces_hang_together_by_edges_whatever_the_winding(faces: np.ndarray) -> None:
    groups: list[set[int]] = []
    for _, same in itertools.groupby(
        sorted(directed(faces), key=lambda use: sorted(use[:2])), key=lambda use: sorted(use[:2])
    ):
        users = {number for _, _, number in same}
        groups = [g for g in groups if not g & users] + [users.union(*(g for g in groups if g & users))]
    assert pieces(pair_edges(faces)) == len(groups)


@settings(deadline=None)
@given(st.lists(st.tuples(NODE, NODE), min_size=1, max_size=40))
def test_first_equal_is_the_first_row_that_is_equal(rows: list[tuple[int, int]]) -> None:
    assert first_equal(np.array(rows)).tolist() == [rows.index(row) for row in rows]


@settings(deadline=None)
@given(SOUPS)
def test_duplicates_are_told_by_corners_and_sense(faces: np.ndarray) -> None:
    def turned(face: tuple[int, ...]) -> tuple[int, ...]:
        return min(face[k:] + face[:k] for k in range(3))

    known: set[tuple[int, ...]] = set()
    same, opposite = [], []
    for number, face in enumerate(map(tuple, faces.tolist())):
        if len(set(face)) < 3:
            continue
        if turned(face) in known:
            same.append(number)
        elif turned(face[::-1]) in known:
            opposite.append(number)
        known.add(turned(face))
    assert [numbers.tolist() for numbers in duplicates(faces)] == [same, opposite]


def classes(edges: Edges) -> tuple[int, int, int, int]:
    masks = (edges.boundary, edges.inconsistent, edges.non_manifold, ~edges.balanced)
    return tuple(int(mask.sum()) for mask in masks)


@pytest.mark.parametrize(
    ("faces", "expected"),
    [
        (CUBE[1], (0, 0, 0, 0)),
        (CUBE[1][1:], (3, 0, 0, 3)),
        (np.vstack([CUBE[1][:4], CUBE[1][4:5, ::-1], CUBE[1][5:]]), (0, 3, 0, 3)),
        (np.vstack([CUBE[1], [[0, 1, 8]]]), (2, 0, 1, 3)),
        (np.vstack([CUBE[1], CUBE[1]]), (0, 0, 18, 0)),
        (np.vstack([CUBE[1], CUBE[1][2:3]]), (0, 0, 3, 3)),
        (np.vstack([CUBE[1], [[4, 4, 7], [3, 3, 3]]]), (0, 0, 0, 0)),
    ],
    ids=["closed", "hole", "turned", "fin", "double", "copy", "degenerate"],
)
def test_edges_are_classified(faces: np.ndarray, expected: tuple[int, int, int, int]) -> None:
    assert classes(pair_edges(faces)) == expected


def test_triangles_at_edges_are_listed_once_in_order_and_up_to_a_limit() -> None:
    edges = pair_edges(CUBE[1])
    diagonal = int(np.flatnonzero((edges.ends == [1, 2]).all(axis=1))[0])
    assert edges.triangles(np.array([diagonal])) == (0, 1)
    listed = edges.triangles(np.arange(len(edges.ends)))
    assert len(listed) == len(set(listed)) == 10


def centroid(*corners: tuple[float, float, float]) -> tuple[float, ...]:
    """Return the centroid of the closed line through the corners."""
    sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
    middles = [np.add(a, b) / 2 for a, b in sides]
    return tuple(np.average(middles, axis=0, weights=[math.dist(a, b) for a, b in sides]))


def test_the_rim_of_a_missing_triangle() -> None:
    (loop,) = loops_of(without(CUBE, 3))
    corners = (10, 0, 10), (10, 10, 10), (0, 10, 10)
    assert (loop.edges, loop.closed) == (3, True)
    assert loop.length == pytest.approx(20 + math.hypot(10, 10), rel=1e-15)
    assert loop.place == pytest.approx(centroid(*corners), rel=1e-15)
    assert loop.start in corners
    assert loop.triangle in {2, 6, 10}  # its neighbours, numbered without it


def test_the_rims_of_an_open_tube() -> None:
    around, along = 40, 8
    vertices, faces = ring(around, along, radius=3, tube=1)
    faces = faces.reshape(around, along, 2, 3)[:, 2:].reshape(-1, 3)
    loops = loops_of((vertices, faces))
    chord = 2 * math.sin(math.pi / around)
    radii = [3 + math.cos(2 * math.pi * v / along) for v in (0, 2)]
    heights = [math.sin(2 * math.pi * v / along) for v in (0, 2)]
    assert [(loop.edges, loop.closed) for loop in loops] == [(around, True)] * 2
    assert [loop.length for loop in loops] == pytest.approx([around * chord * r for r in radii], rel=1e-13)
    for loop, height in zip(loops, heights, strict=True):
        assert loop.place == pytest.approx((0, 0, height), abs=1e-14)


def test_a_crack_at_a_t_junction_is_a_loop_without_area() -> None:
    vertices = np.vstack([CUBE[0], [10, 5, 10]])  # in the middle of edge 5, 7, but only on one side of it
    faces = np.vstack([without(CUBE, 3)[1], [[5, 8, 6], [8, 7, 6]]])
    (loop,) = loops_of((vertices, faces))
    assert (loop.edges, loop.length, loop.place, loop.closed) == (3, 20, (10, 5, 10), True)


def test_holes_that_share_a_vertex_are_taken_apart() -> None:
    loops = loops_of(without(CUBE, 0, 10))  # both at vertex 1, at (10, 0, 0)
    assert [(loop.edges, loop.closed) for loop in loops] == [(3, True)] * 2
    expected = [
        centroid((0, 0, 0), (0, 10, 0), (10, 0, 0)),
        centroid((10, 0, 0), (10, 10, 0), (10, 0, 10)),
    ]
    assert sorted(loop.place for loop in loops) == [pytest.approx(place) for place in sorted(expected)]


def test_three_holes_around_one_vertex_are_three_loops() -> None:
    vertices, faces = ring()
    at = np.flatnonzero((faces == 100).any(axis=1))
    middles = vertices[faces[at]].mean(axis=1) - vertices[100]
    east, north = np.linalg.svd(middles)[2][:2]
    turn = np.argsort(np.arctan2(middles @ north, middles @ east))
    loops = loops_of(without((vertices, faces), *at[turn][::2]))
    assert [(loop.edges, loop.closed) for loop in loops] == [(3, True)] * 3


def test_a_rim_is_one_loop_across_a_seam_of_inconsistent_winding() -> None:
    vertices, faces = moebius(12)
    edges = pair_edges(faces)
    (loop,) = boundary_loops(vertices, edges)
    assert (loop.edges, loop.closed) == (24, True)
    assert edges.inconsistent.sum() == 1
    assert not edges.non_manifold.any()


def test_the_rim_of_a_fin_ends_where_the_fin_stands() -> None:
    vertices = np.vstack([CUBE[0], [5, -3, -4]])
    (loop,) = loops_of((vertices, np.vstack([CUBE[1], [[0, 1, 8]]])))
    assert (loop.edges, loop.closed) == (2, False)
    assert loop.length == pytest.approx(2 * math.hypot(5, 3, 4), rel=1e-15)
    assert loop.place == pytest.approx((5, -1.5, -2), rel=1e-15)


@pytest.mark.parametrize("scale", [2.0**-300, 1.0, 2.0**300])
def test_flat_is_judged_relative_to_size(scale: float) -> None:
    heights = [0.0, 1e-14, 1.9e-14, 2.1e-14, 1e-13, 1.0]
    vertices = [[0, 0, 0], [1, 0, 0], *([0.25, height, 0] for height in heights)]
    faces = np.array([[0, 1, 2 + k] for k in range(len(heights))])
    assert flat(np.array(vertices) * scale, faces).tolist() == [True, True, True, False, False, False]


def test_a_repeated_corner_is_not_a_flat_triangle() -> None:
    faces = np.array([[0, 0, 1], [2, 1, 2], [1, 2, 2], [1, 1, 1], [0, 1, 3], [0, 1, 2]])
    line = np.array([[0, 0, 0], [1, 1, 1], [1, 0, 0], [3, 3, 3]], float)
    assert repeated_corners(faces).tolist() == [True] * 4 + [False] * 2
    assert flat(line, faces).tolist() == [False] * 4 + [True, False]
