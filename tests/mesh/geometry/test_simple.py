"""A surface that is called simple is closed, in one piece and free of crossings, by the passes that sort and search."""

from __future__ import annotations

import numpy as np
import pytest
from tests.benchmarks.extremes.cases import ball
from tests.benchmarks.meshes import wavy_torus

import inertia
from inertia.mesh.geometry import simple as module
from inertia.mesh.geometry.closure import vectorised_closure
from inertia.mesh.geometry.intersect import vectorised_crossings
from inertia.mesh.geometry.simple import MOST, at_hand, not_simple, simple
from inertia.mesh.surface import Surface

from ..self_crossing import pentagram

pytestmark = pytest.mark.skipif(not at_hand(), reason="the pass is a compiled one")


def sound(surface: Surface) -> bool:
    topology = vectorised_closure(surface)
    closed = (topology.open_edges, topology.components, topology.crowded, topology.repeated) == (0, 1, 0, 0)
    return closed and not any(len(pairs) for pairs, _, _ in vectorised_crossings(surface))


def alone(vertices: np.ndarray, faces: np.ndarray, pieces: bool = False) -> bool:
    return bool(simple(vertices, faces, np.array([[0, len(vertices), 0, len(faces)]]), pieces=pieces)[0])


def hostile(seed: int) -> Surface:
    """Return a ball, torus or octahedron with noise of any size, on a grid or not, stretched and moved off."""
    rng = np.random.default_rng(seed)
    vertices, faces = (ball(0), ball(1), wavy_torus(60))[seed % 3]
    if seed % 5 == 0:
        vertices = rng.integers(-2, 3, vertices.shape).astype(float)
    vertices = vertices + rng.normal(size=vertices.shape) * 10.0 ** rng.uniform(-18, 0)
    vertices = vertices * rng.choice([1.0, 1e-3, 1e4], size=3) + rng.normal(size=3) * rng.choice([0.0, 1e6])
    if rng.random() < 0.3:
        vertices[rng.integers(len(vertices))] = vertices[rng.integers(len(vertices))]
    return Surface(vertices, faces)


def bipyramid(sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Return two points on the z axis, and the triangles between each of them and a ring."""
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(sides)])
    here = np.arange(2, sides + 2)
    after, top = np.roll(here, -1), np.zeros(sides, int)
    faces = np.concatenate([np.column_stack([top, here, after]), np.column_stack([after, here, top + 1])])
    return np.concatenate([[[0, 0, 1], [0, 0, -1]], ring]), np.roll(faces, 1, axis=1)


def test_simple_is_sound_and_sound_is_simple() -> None:
    answers = []
    for seed in range(150):
        surface = hostile(seed)
        answers.append(alone(surface.vertices, surface.faces))
        assert answers[-1] == sound(surface), seed
    assert 20 < sum(answers) < 130


def test_bodies_that_nearly_touch_aslant_cross_or_not() -> None:
    """Two tetrahedra on a grid as fine as the cells of boxes, the tip of one within two steps of a face of another."""
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    both = np.concatenate([faces, faces + 4])
    answers = []
    for seed in range(400):
        rng = np.random.default_rng(seed)
        corners = rng.integers(0, 16_001, (4, 3))
        corners[0], corners[1] = (
            rng.permutation([0, rng.integers(16_001), 16_000]),
            rng.permutation([0, 16_000, 16_000]),
        )
        apex = np.round(rng.dirichlet([1, 1, 1]) @ corners[:3]) + rng.integers(-2, 3, 3)
        away = np.sign(apex - corners.mean(axis=0)) * rng.integers(100, 4_000, (3, 3))
        vertices = np.concatenate([corners, [apex], apex + away]).astype(float)
        apart = not any(len(pairs) for pairs, _, _ in vectorised_crossings(Surface(vertices, both)))
        answers.append(alone(vertices, both, pieces=True))
        assert answers[-1] == apart, seed
    assert 50 < sum(answers) < 350


def numbered_anew(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a mesh with its vertices in the order in which the faces name them."""
    used, first, which = np.unique(faces, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return vertices[used[order]], np.argsort(order)[which].reshape(-1, 3)


def test_corners_with_numbers_beyond_16_bits_are_told_apart() -> None:
    """A needle pricks one triangle, whose corner has the number of the needle's point but for a multiple of 65,536."""
    vertices, faces = numbered_anew(*wavy_torus(150_000))
    count = len(vertices)
    needle = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])[:, [0, 2, 1]]
    for beyond, depth, order in ((2**16, 0.1, 0), (2**16, -0.1, 0), (2**16, 0.1, 1), (2**16 - 1, 0.1, 0)):
        face = faces[np.flatnonzero((faces == count - beyond).any(axis=1))[0]]
        a, b, c = vertices[face]
        normal = np.cross(b - a, c - a)
        step = normal / np.linalg.norm(normal) * np.linalg.norm(b - a)
        middle = (a + b + c) / 3
        back = middle + step + 0.1 * np.array([(b - a), (c - b), (a - c)])
        points = np.concatenate([vertices, [middle - depth * step], back])
        both = np.concatenate([faces, needle + count])
        if order:
            both = np.random.default_rng(order).permutation(both)
        assert alone(points, both, pieces=True) == (depth < 0)


@pytest.mark.parametrize("shuffled", [False, True])
def test_one_of_many_corners_that_is_pulled_through_the_other_side_is_seen(shuffled: bool) -> None:
    vertices, faces = wavy_torus(150_000)
    faces = np.random.default_rng(5).permutation(faces) if shuffled else faces
    assert alone(vertices, faces)
    for vertex in (10, 40_000, 70_000):
        moved = vertices.copy()
        moved[vertex] *= -2.0
        assert not alone(moved, faces)


def test_planar_faces_with_many_triangles_are_simple() -> None:
    grid = np.linspace(0.0, 1.0, 6)
    faces, points = [], []
    for axis in range(3):
        for end in (0.0, 1.0):
            for k in range(5):
                for l in range(5):
                    corners = [(grid[k + a], grid[l + b]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    square = [np.insert(corner, axis, end) for corner in corners]
                    # inserting the coordinate in the middle mirrors the square
                    square = square if (end == 1.0) != (axis == 1) else square[::-1]
                    points += [square[0], square[1], square[2], square[0], square[2], square[3]]
    vertices = np.array(points)
    faces = np.arange(len(points)).reshape(-1, 3)
    assert sound(Surface(vertices, faces))
    assert alone(vertices, faces)


def test_a_bad_surface_does_not_touch_its_neighbours() -> None:
    vertices, faces = ball(1)
    wrong = faces.copy()
    wrong[3, 2] = len(vertices)
    below = faces.copy()
    below[3, 2] = -1
    blocks = [faces, wrong, faces[1:], below, np.concatenate([faces, faces]), faces]
    starts = np.cumsum([0, *map(len, blocks)])[:-1]
    table = np.array([[0, len(vertices), start, len(block)] for start, block in zip(starts, blocks, strict=True)])
    assert simple(vertices, np.concatenate(blocks), table).tolist() == [True, False, False, False, False, True]


def test_what_is_too_large_for_the_pass_is_not_shown_to_be_simple() -> None:
    vertices, faces = wavy_torus(4 * MOST)
    assert len(faces) > MOST
    assert not alone(vertices, faces)


def test_meshes_that_share_their_faces_are_looked_at_one_by_one() -> None:
    vertices, faces = ball(1)
    rng = np.random.default_rng(7)
    several = [vertices * rng.uniform(0.5, 2.0) for _ in range(12)]
    several[2] = vertices.copy()
    several[2][5] = vertices[6]  # two corners in one place
    several[4] = vertices.copy()
    several[4][9] = np.nan
    several[6] = vertices.copy()
    several[6][3] *= -3.0  # through the other side
    several[8] = hostile(5).vertices[: len(vertices)]
    several[8] = np.resize(several[8], vertices.shape)
    table = np.array([[k * len(vertices), len(vertices), 0, len(faces)] for k in range(12)])
    answers = simple(np.concatenate(several), faces, table).tolist()
    assert answers == [alone(each, faces) for each in several]
    assert [k for k, answer in enumerate(answers) if not answer] == [2, 4, 6, 8]


def test_flat_faces_on_any_level_are_simple() -> None:
    """Prisms of 3 to 90 sides, whose caps are fans of slivers, on levels that no binary fraction is."""
    for sides in (3, 7, 40, 90):
        angles = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
        ring = np.column_stack([np.cos(angles), np.sin(angles)])
        vertices = np.concatenate([np.insert(ring, 2, 0.1, axis=1), np.insert(ring, 2, 0.7, axis=1)])
        k, after = np.arange(sides), (np.arange(sides) + 1) % sides
        walls = np.concatenate(
            [np.column_stack([k, after, after + sides]), np.column_stack([k, after + sides, k + sides])]
        )
        caps = np.column_stack([np.zeros(sides - 2, int), k[1:-1], k[2:]])
        faces = np.concatenate([walls, caps[:, ::-1], caps + sides])
        assert sound(Surface(vertices, faces))
        assert alone(vertices, faces), sides


@pytest.mark.parametrize("fault", ["none", "turned", "missing", "twice", "the other way too"])
def test_edges_of_a_vertex_that_has_hundreds_are_paired(fault: str) -> None:
    vertices, faces = bipyramid(150)
    rng = np.random.default_rng(3)
    for k in (0, 31, 32, 33, 34, 100, 149, 150, 299):
        wrong = {
            "none": faces,
            "turned": np.concatenate([faces[:k], faces[k : k + 1, ::-1], faces[k + 1 :]]),
            "missing": np.delete(faces, k, axis=0),
            "twice": np.insert(faces, k, faces[k], axis=0),
            "the other way too": np.concatenate([faces, faces[k : k + 1, ::-1], faces[k : k + 1]]),
        }[fault]
        for some in (wrong, wrong[rng.permutation(len(wrong))]):
            assert alone(vertices, some) == (fault == "none")


def test_what_lies_around_one_place_is_left_to_who_looks_for_crossings() -> None:
    """Half of all pairs of boxes touch at the ring: to look at each would take a minute at 100,000 triangles."""
    sides = 3000
    vertices, faces = bipyramid(sides)
    assert not alone(vertices, faces)
    part = inertia.Part.from_arrays(vertices, faces)
    analysis = inertia.analyse(part)
    assert analysis.crossings_examined
    volume = sides * np.sin(2 * np.pi / sides) / 3
    assert analysis.properties.volume == pytest.approx(volume, rel=1e-13)
    assert inertia.mass_properties(part).volume == analysis.properties.volume


@pytest.mark.parametrize("most", [MOST, 20, 5])
def test_only_shells_that_cross_themselves_are_left(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    shells = [ball(1), pentagram(), ball(1), ball(0), pentagram()]
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in shells)])
    vertices = np.concatenate([points + np.array([0, 0, 3.0 * k]) for k, (points, _) in enumerate(shells)])
    faces = np.concatenate([own + start for (_, own), start in zip(shells, starts, strict=False)])
    order = np.random.default_rng(0).permutation(len(faces))
    labels = np.repeat(np.arange(5), [len(own) for _, own in shells])[order].astype(np.int32)
    monkeypatch.setattr(module, "MOST", most)
    left = not_simple(Surface(vertices, faces[order]), labels, np.flatnonzero(labels != 4))
    large = np.array([len(own) > most for _, own in shells])
    assert left.tolist() == np.flatnonzero(((labels == 1) | large[labels]) & (labels != 4)).tolist()
