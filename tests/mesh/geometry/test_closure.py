"""Pairing the edges: both paths against fractions, on soups of every kind of defect."""

import os
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Callable
from fractions import Fraction
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import cube, facets, joined, part, ring, sphere

from inertia import mass_properties, native
from inertia.errors import GeometryError
from inertia.mesh.geometry.closure import Closure, closure, compiled_closure, paired_by_keys, vectorised_closure
from inertia.mesh.geometry.faces import components, merge_equal_vertices
from inertia.mesh.geometry.leaves import BY_PLACE
from inertia.mesh.geometry.pairing import Doubtful, paired_edges
from inertia.mesh.surface import Facets, Surface, Triangles
from inertia.native import LOAD_ABOVE

PATHS = {"compiled": compiled_closure, "vectorised": vectorised_closure}


def paired_by_angle(corners: list) -> tuple[int, list[int], int, int]:
    """Return (open edges, labels, repeated, crowded), in fractions; see `inertia.mesh.geometry.edge_fans`."""
    triangles = [[tuple(map(Fraction, corner)) for corner in triangle] for triangle in corners]
    whole = [face for face, triangle in enumerate(triangles) if len(set(triangle)) == 3]
    label = list(range(len(triangles)))

    def root(face: int) -> int:
        while label[face] != face:
            face = label[face]
        return face

    def link(members: list[int]) -> None:
        for face in members:
            one, other = sorted((root(face), root(members[0])))
            label[other] = one

    users = defaultdict(list)
    for face in whole:
        for k in range(3):
            tail, head, apex = (triangles[face][(k + step) % 3] for step in range(3))
            users[min(tail, head), max(tail, head)].append((face, 1 if tail < head else -1, apex))
    for at in users.values():
        if len(at) == 2 and sum(way for _, way, _ in at) == 0:
            link([face for face, *_ in at])
    pieces = {face: root(face) for face in whole}
    ties = []
    for edge, at in sorted(users.items()):
        if len(at) > 2:
            balance = Counter()
            for face, way, _ in at:
                balance[pieces[face]] += way
            groups, slots = linked([use for use in at if balance[pieces[use[0]]]], edge)
            groups.append(sheets(at, pieces, edge))
            for members in groups:
                link(members)
            ties += slots
    for opening, closing in ties:
        pairs = [(one, other) for one in opening for other in closing]
        one, other = next((pair for pair in pairs if root(pair[0]) == root(pair[1])), pairs[0])
        opening.remove(one)
        closing.remove(other)
        link([one, other])
    roots = [root(face) if face in pieces else -1 for face in range(len(triangles))]
    order = {first: number for number, first in enumerate(sorted(set(roots) - {-1}))}
    surplus = sum(abs(sum(way for _, way, _ in at)) for at in users.values())
    crowded = sum(len(at) > 2 for at in users.values())
    return surplus, [order.get(first, -1) for first in roots], len(triangles) - len(whole), crowded


def sheets(uses: list, pieces: dict[int, int], edge: tuple) -> list[int]:
    """Return the faces of pieces whose two sides cancel in every half-plane at an edge."""
    net: Counter = Counter()
    for face, way, apex in uses:
        plane = around(edge, apex, uses)
        net[pieces[face], plane] += way if plane else 0
    return [face for face, *_ in uses if not any(net[key] for key in net if key[0] == pieces[face])]


def linked(uses: list, edge: tuple) -> tuple[list[list[int]], list[tuple[list[int], list[int]]]]:
    """Return the groups of faces that belong together at an edge, and pairs of sets that have one pair each."""
    uses = sorted(uses, key=lambda use: (use[2], use[0]))
    directions = [(*use, around(edge, use[2], uses)) for use in uses]
    flat = [face for face, _, _, angle in directions if angle is None]
    solid = [use for use in directions if use[3] is not None]
    if sum(way for _, way, _, _ in solid):
        return [[face for face, *_ in uses]], []
    planes = defaultdict(list)
    for face, way, _, angle in solid:
        planes[angle, way < 0].append(face)
    ring = [(key, number) for key, faces in sorted(planes.items()) for number in range(len(faces))]
    slots = []
    while ring:
        k = next(k for k in range(len(ring)) if ring[k - 1][0][1] and not ring[k][0][1])
        slots.append((ring[k - 1], ring[k]))
        ring = [use for use in ring if use not in slots[-1]]
    slots = [(planes[one], planes[other]) for (one, _), (other, _) in sorted(slots)]
    simple = [one + other for one, other in slots if len(one) == len(other) == 1]
    return [flat, *simple] if flat else simple, [(a, b) for a, b in slots if len(a) > 1 or len(b) > 1]


def around(edge: tuple, apex: tuple, uses: list) -> tuple | None:
    """Return what is larger, the larger the angle of `apex` around the edge from the first use that has one."""

    def dot(a: list, b: list) -> Fraction:
        return sum(x * y for x, y in zip(a, b, strict=True))

    def arm(point: tuple) -> list:
        along = [b - a for a, b in zip(*edge, strict=True)]
        off = [w - a for a, w in zip(edge[0], point, strict=True)]
        share = dot(off, along) / dot(along, along)
        return [x - share * y for x, y in zip(off, along, strict=True)]

    if not any(arm(apex)):
        return None
    (x0, x1, x2), (e0, e1, e2) = (
        next(filter(any, (arm(use[2]) for use in uses))),
        (b - a for a, b in zip(*edge, strict=True)),
    )
    right = dot(arm(apex), [x0, x1, x2])
    up = dot(arm(apex), [e1 * x2 - e2 * x1, e2 * x0 - e0 * x2, e0 * x1 - e1 * x0])
    if up == 0:
        return (0, 0) if right > 0 else (2, 0)
    return (1 if up > 0 else 3, -right / up)


def assert_is(pairing: Closure, expected: tuple[int, list[int], int, int]) -> None:
    open_edges, labels, repeated, crowded = expected
    assert pairing.open_edges == open_edges
    assert pairing.labels.tolist() == labels
    assert pairing.components == max(labels, default=-1) + 1
    assert pairing.repeated == repeated
    assert pairing.crowded == crowded


@st.composite
def soups(draw: st.DrawFn) -> Surface:
    """Triangles over few points: open, inconsistent, non-manifold, repeated, with copies of points and −0."""
    coordinate = st.sampled_from([-1.0, -0.0, 0.0, 1.0])
    points = draw(st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=1, max_size=7))
    corner = st.integers(0, len(points) - 1)
    return Surface(
        points,
        np.array(draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=60))).reshape(-1, 3),
    )


@pytest.mark.parametrize("path", PATHS)
@settings(deadline=None, max_examples=200)
@given(soup=soups())
def test_soups_are_paired_by_the_angles_around_their_edges(path: str, soup: Surface) -> None:
    expected = paired_by_angle(soup.corners().tolist())
    assert_is(PATHS[path](soup), expected)
    assert_is(PATHS[path](facets(soup)), expected)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("kind", [Surface, Facets])
def test_a_shuffled_surface_with_a_defect_of_each_kind(path: str, kind: type[Triangles]) -> None:
    surface = joined(sphere(splits=4), sphere((3, 0, 0), splits=3), cube((0, 0, 3)), cube((1, 1, 3)))
    faces = surface.faces
    faces = np.vstack([np.delete(faces, [7, 100], axis=0), faces[:3], faces[50:52, ::-1], [[5, 5, 9]]])
    faces[300] = faces[300, ::-1]
    faces = np.random.default_rng(1).permutation(faces)
    broken = Surface(surface.vertices, faces)
    triangles = broken if kind is Surface else facets(broken)
    assert_is(PATHS[path](triangles), paired_by_angle(triangles.corners().tolist()))


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("kind", [Surface, Facets])
def test_a_large_shuffled_surface_grows_the_table_and_stays_closed(path: str, kind: type[Triangles]) -> None:
    rings = joined(ring(300, 200), ring(150, 100, radius=20, tube=2))
    number = np.repeat([0, 1], [300 * 200 * 2, 150 * 100 * 2])
    order = np.random.default_rng(2).permutation(rings.count)
    shuffled = rings.select(order)
    pairing = PATHS[path](shuffled if kind is Surface else facets(shuffled))
    assert (pairing.open_edges, pairing.components, pairing.repeated) == (0, 2, 0)
    first = number[order[0]]
    assert np.array_equal(pairing.labels, np.where(number[order] == first, 0, 1))


@pytest.mark.parametrize("path", PATHS)
def test_minus_zero_is_zero_and_the_next_float_is_not(path: str) -> None:
    low = joined(cube((0.5, 0.5, 0.5)))
    vertices = np.vstack([low.vertices, np.where(low.vertices == 0, -0.0, low.vertices)])
    faces = np.where(np.arange(12)[:, None] % 2, low.faces, low.faces + 8)
    signed = Surface(vertices, faces)
    assert np.signbit(signed.corners()).any()
    assert (PATHS[path](signed).open_edges, PATHS[path](facets(signed)).open_edges) == (0, 0)
    vertices[vertices == 0] = np.where(np.signbit(vertices[vertices == 0]), 5e-324, 0.0)
    assert PATHS[path](Surface(vertices, faces)).open_edges > 0


@pytest.mark.parametrize("path", PATHS)
def test_nothing_is_closed_and_has_no_component(path: str) -> None:
    for faces in (np.empty((0, 3), int), [[0, 0, 1]]):
        pairing = PATHS[path](Surface(np.eye(3), faces))
        assert (pairing.open_edges, pairing.components) == (0, 0)
        assert (pairing.labels == -1).all()


def test_both_paths_give_the_same_through_the_front_door(monkeypatch: pytest.MonkeyPatch) -> None:
    surface = joined(ring(200, 120), sphere((9, 0, 0)))
    assert surface.count > LOAD_ABOVE
    compiled_closure(surface)  # machine code at hand is used from here on
    compiled = closure(surface)
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    vectorised = closure(surface)
    assert (compiled.open_edges, compiled.components) == (vectorised.open_edges, vectorised.components) == (0, 2)
    assert np.array_equal(compiled.labels, vectorised.labels)


MASK = 2**64 - 1


def scrambled(word: Any) -> Any:
    """Return the finalizer of SplitMix64 of an integer, or of an array of uint64."""
    word = (word ^ word >> 29) * 0xBF58476D1CE4E5B9 & MASK
    word = (word ^ word >> 32) * 0x94D049BB133111EB & MASK
    return word ^ word >> 31


def unscrambled(word: Any) -> Any:
    """Return the inverse of `scrambled`."""
    word = (word ^ word >> 31 ^ word >> 62) * pow(0x94D049BB133111EB, -1, 2**64) & MASK
    word = (word ^ word >> 32) * pow(0xBF58476D1CE4E5B9, -1, 2**64) & MASK
    return word ^ word >> 29 ^ word >> 58


def same_in_double(point: np.ndarray, count: int) -> list[np.ndarray]:
    """Return points near `point` whose coordinates hash alike without salt, word by word: h ← mix(h K + word)."""
    odd = 0x9E3779B97F4A7C15
    x, y, z = point.view(np.uint64).tolist()
    key = scrambled((scrambled((scrambled(x) * odd + y) & MASK) * odd + z) & MASK)
    step = np.arange(1, 10**6, dtype=np.uint64)
    x, y = x + step % 1000, y + step // 1000
    last = unscrambled(key) - scrambled(scrambled(x) * odd + y) * odd
    same = np.flatnonzero(last >> 48 == z >> 48)[:count]
    return list(np.column_stack([x, y, last])[same].view(float))


def same_in_single(point: np.ndarray, count: int) -> list[np.ndarray]:
    """Return points whose coordinates hash alike without salt: mix(mix(x | y << 32) K + z)."""
    odd, points = 0x9E3779B97F4A7C15, []
    x, y, z = np.float32(point).view(np.uint32).tolist()
    inner = (scrambled(x | y << 32) * odd + z) & MASK
    for step in range(1, 10**6):
        both = unscrambled((inner - (z + step)) * pow(odd, -1, 2**64) & MASK)
        other = np.array([both & 0xFFFFFFFF, both >> 32, z + step], np.uint32).view(np.float32)
        if (np.abs(other) < 100).all():
            points.append(other.astype(float))
        if len(points) == count:
            break
    return points


@pytest.mark.parametrize(("kind", "same"), [(Surface, same_in_double), (Facets, same_in_single)])
def test_a_fan_cut_out_along_a_forged_hash_is_open(kind: type[Triangles], same: Callable) -> None:
    """Six triangles meet in six different points, which a hash without salt takes for one."""
    vertices, faces = ring(60, 40)
    if kind is Facets:
        vertices = vertices.astype(np.float32).astype(float)
    fan = np.argwhere(faces == 33)
    others = same(vertices[33], len(fan) - 1)
    assert len(others) == len(fan) - 1 == 5
    for (face, corner), number in zip(fan[1:], range(len(vertices), len(vertices) + 5), strict=True):
        faces[face, corner] = number
    forged = Surface(np.vstack([vertices, *others]), faces)
    triangles = forged if kind is Surface else facets(forged)
    assert vectorised_closure(triangles).open_edges == 12
    assert compiled_closure(triangles).open_edges == 12
    assert closure(triangles).open_edges == 12
    with pytest.raises(GeometryError, match="open"):
        mass_properties(part(triangles))
    for seed in range(50):
        salt = np.random.default_rng(seed).integers(0, 2**64, 15, np.uint64)
        assert compiled_closure(triangles, salt=salt).open_edges == 12


@settings(deadline=None)
@given(soup=soups(), seed=st.integers(0, 2**32))
def test_the_salt_changes_nothing(soup: Surface, seed: int) -> None:
    salt = np.random.default_rng(seed).integers(0, 2**64, 15, np.uint64)
    for triangles in (soup, facets(soup)):
        assert_is(compiled_closure(triangles, salt=salt), paired_by_angle(soup.corners().tolist()))


@pytest.mark.parametrize("kind", [Surface, Facets])
def test_one_edge_of_four_is_seen_wherever_its_triangles_are(kind: type[Triangles]) -> None:
    everything = joined(cube((9, 0, 3)), ring(400, 200), cube((10, 1, 3)))
    for order in (np.arange(everything.count), np.random.default_rng(5).permutation(everything.count)):
        ordered = everything.select(order)
        triangles = ordered if kind is Surface else facets(ordered)
        pairing = compiled_closure(triangles)
        assert (pairing.open_edges, pairing.components, pairing.crowded) == (0, 3, 1)


@pytest.mark.parametrize("kind", [Surface, Facets])
@pytest.mark.parametrize("seed", range(5))
def test_only_components_with_edges_of_more_than_two_are_paired_anew(kind: type[Triangles], seed: int) -> None:
    """Two cubes share an edge, two a side, one of them inside out; one of the rings has a hole or points off."""
    rng = np.random.default_rng(seed)
    vertices, faces = ring(120, 80)
    rings = [(vertices + np.array([0, 0, 5.0 * k]), faces) for k in range(3)]
    cubes = [cube(place) for place in ((9, 0, 3), (10, 1, 3), (20, 0, 0), (21, 0, 0))]
    if seed == 1:
        cubes[3] = cubes[3][0], cubes[3][1][:, ::-1]
    everything = joined(*rings[:2], *cubes[:2], rings[2], *cubes[2:])
    faces = everything.faces
    if seed >= 2:
        faces = np.delete(faces, rng.integers(1000, size=seed - 1), axis=0)
    if seed == 4:
        faces = np.insert(faces, [50, 20_000], [[1, 1, 2], [7, 8, 7]], axis=0)
    surface = Surface(everything.vertices, faces)
    triangles = surface if kind is Surface else facets(surface)
    salt = rng.integers(0, 2**64, 15, np.uint64)
    doubtful = paired_edges(triangles, salt)
    assert isinstance(doubtful, Doubtful)
    one, other = (paired_by_keys(triangles, salt, known) for known in (doubtful, None))
    assert one is not None
    assert other is not None
    expected = vectorised_closure(triangles)
    for found in (one[0], other[0], compiled_closure(triangles, salt=salt)):
        for name in ("open_edges", "components", "repeated", "crowded"):
            assert getattr(found, name) == getattr(expected, name)
        assert np.array_equal(found.labels, expected.labels)
        assert np.array_equal(found.at_crowded, expected.at_crowded)
    for name in ("vertices", "faces", "numbers"):
        assert np.array_equal(getattr(one[1], name), getattr(other[1], name))
    for name in ("ends", "forward", "backward", "users"):
        assert np.array_equal(getattr(one[1].edges, name), getattr(other[1].edges, name))


def bipyramid(sides: int, height: float) -> tuple[np.ndarray, np.ndarray]:
    """All of its triangles meet at two vertices, and go from one side of it to the middle."""
    around = 2 * np.pi * np.arange(sides) / sides
    rim = np.column_stack([np.cos(around), np.sin(around), 0 * around])
    a, b = np.arange(sides), np.roll(np.arange(sides), -1)
    up, down = np.full(sides, sides), np.full(sides, sides + 1)
    faces = np.vstack([np.column_stack([a, b, up]), np.column_stack([b, a, down])])
    return np.vstack([rim, [[0, 0, height], [0, 0, -height]]]), faces


@pytest.mark.parametrize("kind", [Surface, Facets])
@pytest.mark.parametrize("seed", range(6))
def test_triangles_in_no_order_are_paired_wherever_their_corners_are(kind: type[Triangles], seed: int) -> None:
    """Some reach across everything, some are missing, turned, or there twice: as sorting all edges says."""
    rng = np.random.default_rng(seed)
    whole = joined(ring(160, 100), bipyramid(4000, 3.0), cube((9, 0, 3)), bipyramid(30, 40.0))
    faces = whole.faces[rng.permutation(whole.count)]
    faces = faces[10 * seed :]
    if seed > 2:
        faces[:seed] = faces[:seed, ::-1]
    if seed > 4:
        faces = np.vstack([faces, rng.integers(0, len(whole.vertices), (50, 3))])
    ordered = Surface(whole.vertices, faces)
    triangles = ordered if kind is Surface else facets(ordered)
    one, other = compiled_closure(triangles), vectorised_closure(triangles)
    assert (one.open_edges > 0) == (seed > 0)
    assert (one.open_edges, one.components, one.repeated, one.crowded) == (
        other.open_edges, other.components, other.repeated, other.crowded
    )  # fmt: skip
    assert np.array_equal(one.labels, other.labels)


@pytest.mark.parametrize("kind", [Surface, Facets])
def test_triangles_that_are_stored_over_and_over_are_paired_as_sorting_says(kind: type[Triangles]) -> None:
    same = Surface(np.eye(3), np.tile([0, 1, 2], (20_000, 1)))
    triangles = same if kind is Surface else facets(same)
    one, other = compiled_closure(triangles), vectorised_closure(triangles)
    assert (one.open_edges, one.components, one.crowded) == (60_000, other.components, 3)
    assert np.array_equal(one.labels, other.labels)


def test_a_sound_surface_is_never_sorted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many keys agree in the few bits of them that are compared first, and none of them is repeated."""
    monkeypatch.setattr("inertia.mesh.geometry.closure.vectorised_closure", None)
    surface = joined(ring(400, 200))
    shuffled = surface.select(np.random.default_rng(1).permutation(surface.count))
    for seed in range(20):
        salt = np.random.default_rng(seed).integers(0, 2**64, 15, np.uint64)
        pairing = compiled_closure(surface if seed % 2 else shuffled, salt=salt)
        assert (pairing.open_edges, pairing.components, pairing.crowded) == (0, 1, 0)


def test_each_process_has_its_own_salt() -> None:
    code = "from inertia.mesh.geometry.closure import process_salt; print(process_salt().tolist())"
    drawn = {subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout for _ in range(2)}
    assert len(drawn) == 2


def test_progress_rises_to_the_end() -> None:
    fractions: list[float] = []
    compiled_closure(joined(ring(400, 200)), fractions.append)
    assert fractions == sorted(fractions)
    assert 0 < fractions[0] < fractions[-1] <= 1


@pytest.mark.parametrize("compiled", ["0", "1"])
@settings(deadline=None)
@given(soup=soups())
def test_merging_numbers_equal_points_in_the_order_of_their_use(compiled: str, soup: Surface) -> None:
    number: dict[tuple, int] = {}
    faces = [[number.setdefault(tuple(corner), len(number)) for corner in face] for face in soup.corners().tolist()]
    own = soup.corners().reshape(-1, 3)
    table = np.concatenate([own, [[7.0, 7.0, 7.0]], own])  # twice, and a vertex that no triangle uses
    order = np.random.default_rng(len(own)).permutation(len(table))
    places = np.argsort(order)
    either = np.where(np.arange(len(own)) % 2, places[: len(own)], places[len(own) + 1 :]).reshape(-1, 3)
    shared = np.array([*number, (7.0, 7.0, 7.0), *[*number][:1]])[::-1]  # fewer than corners, in most soups
    few = Surface(shared, len(shared) - 1 - np.array(faces).reshape(-1, 3))
    for surface in (soup, Surface(table[order], either), few):
        with patch.dict(os.environ, INERTIA_NATIVE=compiled), patch.object(native, "SHIPPED_ABOVE", 0):
            vertices, merged = merge_equal_vertices(surface)
        assert merged.tolist() == faces
        assert [tuple(vertex) for vertex in vertices.tolist()] == list(number)


def test_points_that_are_not_finite_are_merged_where_they_are_equal() -> None:
    nan, inf = np.nan, np.inf
    points = np.array([[0, nan, 0], [0, nan, 0], [0, -0.0, 0], [-0.0, 0, 0], [inf, 0, 0], [inf, 0, 0]])
    with patch.object(native, "SHIPPED_ABOVE", 0):
        vertices, faces = merge_equal_vertices(Surface(points, [[0, 1, 2], [3, 4, 5]]))
    assert faces.tolist() == [[0, 1, 2], [2, 3, 3]]  # no NaN equals another
    assert np.array_equal(vertices, points[[0, 1, 2, 4]], equal_nan=True)


@settings(deadline=None)
@given(st.integers(1, 40), st.data())
def test_components_are_named_by_their_smallest_node(count: int, data: st.DataObject) -> None:
    node = st.integers(0, count - 1)
    pairs = data.draw(st.lists(st.tuples(node, node), max_size=60))
    names = list(range(count))
    for _ in range(count):
        for a, b in pairs:
            names[a] = names[b] = min(names[a], names[b])
    assert components(np.array(pairs, int).reshape(-1, 2), count).tolist() == names


def test_components_of_a_long_chain_in_random_order() -> None:
    count = 100_000
    chain = np.random.default_rng(3).permutation(count)
    assert not components(np.column_stack([chain[1:], chain[:-1]]), count).any()


ORDERS: dict[str, Callable[[int], np.ndarray]] = {
    "as made": np.arange,
    "in two sweeps": lambda count: np.concatenate([np.arange(0, count, 2), np.arange(1, count, 2)]),
    "shuffled": lambda count: np.random.default_rng(3).permutation(count),
    "half of it shuffled": lambda count: np.concatenate(
        [np.arange(count // 2), count // 2 + np.random.default_rng(3).permutation(count - count // 2)]
    ),
}


@pytest.mark.parametrize("number", [1, 3])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("kind", [Surface, Facets])
def test_neither_the_order_nor_the_threads_change_anything(
    kind: type[Triangles], order: str, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("inertia.mesh.geometry.pairing.threads", lambda: number)
    monkeypatch.setattr("inertia.mesh.geometry.closure.vectorised_closure", None)
    for kernel in BY_PLACE:
        assert kernel.function  # machine code at hand is used from here on
    rings = joined(ring(500, 300), ring(60, 40, radius=20, tube=2), cube((99, 0, 0)))
    body = np.repeat([0, 1, 2], [500 * 300 * 2, 60 * 40 * 2, 12])
    faces = rings.faces.copy()
    faces[[7, 200_000], 1] = faces[[7, 200_000], 0]  # two triangles fewer: a hole of three edges each
    which = ORDERS[order](len(faces))
    ordered = Surface(rings.vertices, faces[which])
    pairing = compiled_closure(ordered if kind is Surface else facets(ordered))
    assert (pairing.open_edges, pairing.components, pairing.repeated, pairing.crowded) == (6, 3, 2, 0)
    body[[7, 200_000]] = -1
    expected = body[which]
    _, first = np.unique(expected, return_index=True)
    rank = np.argsort(np.argsort(first[1:]))
    assert np.array_equal(pairing.labels, np.where(expected < 0, -1, rank[expected]))


@pytest.mark.parametrize("triangles", [60_000, 120_000, 240_000])
def test_places_beyond_float32_are_beyond_no_plane_that_is_not_there(triangles: int) -> None:
    """Of triangles in no order a tree of planes in float32 is made, of which the last nodes may have one plane only."""
    surface = joined(ring(300, triangles // 600))
    large = Surface(1e60 * surface.vertices, surface.faces)
    pairing = compiled_closure(large.select(np.random.default_rng(5).permutation(large.count)))
    assert (pairing.open_edges, pairing.components, pairing.crowded) == (0, 1, 0)


@pytest.mark.parametrize("kind", [Surface, Facets])
def test_bodies_far_apart_and_triangles_at_one_place(kind: type[Triangles]) -> None:
    """What halves a sample of the triangles need not halve them all: nearly all lie in one leaf, or all begin there."""
    vertices, faces = cube((0, 0, 0))
    heap = joined(ring(300, 200), (1e30 * vertices, faces))
    around = np.arange(30_000)
    rim = np.column_stack([np.cos(around / 4775), np.sin(around / 4775), np.zeros(len(around))])
    beside = np.roll(around, -1)
    cones = np.vstack([[[0, 0, 1]], rim, [[0, 0, -1]]])
    upper = np.column_stack([np.zeros_like(around), around + 1, beside + 1])
    lower = np.column_stack([np.full_like(around, len(around) + 1), beside + 1, around + 1])
    for surface, pieces in ((heap, 2), (Surface(cones, np.vstack([upper, lower])), 1)):
        shuffled = surface.select(np.random.default_rng(4).permutation(surface.count))
        pairing = compiled_closure(shuffled if kind is Surface else facets(shuffled))
        assert (pairing.open_edges, pairing.components, pairing.crowded) == (0, pieces, 0)
