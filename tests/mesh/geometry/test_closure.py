"""Pairing the edges: both paths against a dictionary of queues, on soups of every kind of defect."""

import subprocess
import sys
from collections import deque
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import cube, facets, joined, part, ring, sphere

from inertia import mass_properties
from inertia.errors import GeometryError
from inertia.mesh.geometry.closure import (
    Closure,
    closure,
    compiled_closure,
    components,
    merge_equal_vertices,
    vectorised_closure,
)
from inertia.mesh.part import Facets, Surface, Triangles
from inertia.native import LOAD_ABOVE

PATHS = {"compiled": compiled_closure, "vectorised": vectorised_closure}


def paired_by_queues(corners: list) -> tuple[int, list[int], int]:
    """Return (open edges, labels, repeated): each directed edge meets the first opposite that waits."""
    waiting: dict[tuple, deque[int]] = {}
    label, repeated = list(range(len(corners))), 0

    def root(face: int) -> int:
        while label[face] != face:
            face = label[face]
        return face

    for face, triangle in enumerate(corners):
        a, b, c = (tuple(corner) for corner in triangle)
        if len({a, b, c}) < 3:
            label[face] = -1
            repeated += 1
            continue
        for start, end in ((a, b), (b, c), (c, a)):
            opposite = waiting.get((end, start))
            if opposite:
                one, other = sorted((root(face), root(opposite.popleft())))
                label[other] = one
            else:
                waiting.setdefault((start, end), deque()).append(face)
    roots = [-1 if label[face] < 0 else root(face) for face in range(len(corners))]
    order = {first: number for number, first in enumerate(sorted(set(roots) - {-1}))}
    return sum(map(len, waiting.values())), [order.get(first, -1) for first in roots], repeated


def assert_is(pairing: Closure, expected: tuple[int, list[int], int]) -> None:
    open_edges, labels, repeated = expected
    assert pairing.open_edges == open_edges
    assert pairing.labels.tolist() == labels
    assert pairing.components == max(labels, default=-1) + 1
    assert pairing.repeated == repeated


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
def test_soups_are_paired_first_come_first_served(path: str, soup: Surface) -> None:
    expected = paired_by_queues(soup.corners().tolist())
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
    assert_is(PATHS[path](triangles), paired_by_queues(triangles.corners().tolist()))


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


def scrambled(word: int) -> int:
    """Return the finalizer of SplitMix64."""
    word = (word ^ word >> 29) * 0xBF58476D1CE4E5B9 & MASK
    word = (word ^ word >> 32) * 0x94D049BB133111EB & MASK
    return word ^ word >> 31


def unscrambled(word: int) -> int:
    """Return the inverse of `scrambled`."""
    word = (word ^ word >> 31 ^ word >> 62) * pow(0x94D049BB133111EB, -1, 2**64) & MASK
    word = (word ^ word >> 32) * pow(0xBF58476D1CE4E5B9, -1, 2**64) & MASK
    return word ^ word >> 29 ^ word >> 58


def same_in_double(point: np.ndarray, count: int) -> list[np.ndarray]:
    """Return points near `point` whose coordinates hash alike without salt, word by word: h ← mix(h K + word)."""
    odd, points = 0x9E3779B97F4A7C15, []
    x, y, z = point.view(np.uint64).tolist()
    key = scrambled((scrambled((scrambled(x) * odd + y) & MASK) * odd + z) & MASK)
    for step in range(1, 10**6):
        head = scrambled((scrambled(x + step % 1000) * odd + y + step // 1000) & MASK)
        last = (unscrambled(key) - head * odd) & MASK
        if last >> 48 == z >> 48:
            points.append(np.array([x + step % 1000, y + step // 1000, last], np.uint64).view(float))
        if len(points) == count:
            break
    return points


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
    vertices, faces = ring(200, 100)
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
        salt = np.random.default_rng(seed).integers(0, 2**64, 24, np.uint64)
        assert compiled_closure(triangles, salt=salt).open_edges == 12


@settings(deadline=None)
@given(soup=soups(), seed=st.integers(0, 2**32))
def test_the_salt_changes_nothing(soup: Surface, seed: int) -> None:
    salt = np.random.default_rng(seed).integers(0, 2**64, 24, np.uint64)
    for triangles in (soup, facets(soup)):
        assert_is(compiled_closure(triangles, salt=salt), paired_by_queues(soup.corners().tolist()))


def test_each_process_has_its_own_salt() -> None:
    code = "from inertia.mesh.geometry.closure import process_salt; print(process_salt().tolist())"
    drawn = {subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout for _ in range(2)}
    assert len(drawn) == 2


def test_progress_rises_to_the_end() -> None:
    fractions: list[float] = []
    compiled_closure(joined(ring(400, 200)), fractions.append)
    assert fractions == sorted(fractions)
    assert 0 < fractions[0] < fractions[-1] <= 1


@settings(deadline=None)
@given(soup=soups())
def test_merging_numbers_equal_points_in_the_order_of_their_use(soup: Surface) -> None:
    number: dict[tuple, int] = {}
    faces = [[number.setdefault(tuple(corner), len(number)) for corner in face] for face in soup.corners().tolist()]
    vertices, merged = merge_equal_vertices(soup)
    assert merged.tolist() == faces
    assert [tuple(vertex) for vertex in vertices.tolist()] == list(number)


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
