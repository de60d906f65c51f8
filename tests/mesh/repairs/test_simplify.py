"""Simplified meshes: closed, with the triangles that they say, of the vertices that there were."""

import itertools
import math

import numpy as np
import pytest
from tests.mesh.solids import cube, facets, inside_out, joined, ring, sphere

from inertia.errors import GeometryError
from inertia.mesh.geometry.closure import closure
from inertia.mesh.repairs.simplify import Simplified, halvings
from inertia.mesh.surface import Surface
from inertia_meshes import rational

CLOSE = 0.05
"""How near to the triangles asked for the search comes on a smooth surface, where the tolerance decides the number."""


def volume(surface: Surface) -> float:
    return float(rational.moments(surface.corners()).volume)


def largest_inscribed(triangles: int) -> float:
    """Return the largest volume of a polyhedron of so many triangles in the unit sphere.

    V ≤ (n − 2)/6 cot ω (3 − cot² ω), ω = n/(n − 2) π/6, n vertices (L. Fejes Tóth, *Regular Figures*, 1964, § 35).
    """
    vertices = triangles // 2 + 2
    cotangent = 1 / math.tan(vertices / (vertices - 2) * math.pi / 6)
    return (vertices - 2) / 6 * cotangent * (3 - cotangent**2)


def assert_volume_of_a_ball(surface: Surface, radius: float = 1.0) -> None:
    """See that a polyhedron in a sphere has a volume that so many triangles can have.

    At most the largest; and what it lacks of the ball is at most twice what the evenly divided octahedron that it was
    made from would lack at that number of triangles, as its chords leave out a share that falls as one over the number.
    """
    fine = joined(sphere(splits=4))
    ball = 4 / 3 * math.pi
    lacking = 1 - volume(fine) / ball
    size = abs(volume(surface)) / radius**3
    assert ball * (1 - 2 * lacking * fine.count / surface.count) <= size <= largest_inscribed(surface.count)


def pieces(surface: Surface) -> list[Surface]:
    labels = closure(surface).labels
    return [surface.select(np.flatnonzero(labels == label)) for label in range(labels.max() + 1)]


@pytest.fixture(scope="module")
def balls() -> list[Simplified]:
    return list(halvings(joined(sphere(splits=4))))


def test_every_mesh_is_closed_and_wound_alike(balls: list[Simplified]) -> None:
    assert len(balls) >= 6
    assert [closure(ball.surface).open_edges for ball in balls] == [0] * len(balls)
    assert [closure(ball.surface).components for ball in balls] == [1] * len(balls)


def test_the_share_is_the_nearest_power_of_two(balls: list[Simplified]) -> None:
    for ball in balls:
        assert abs(math.log2(8 * 4**4 / ball.surface.count) - math.log2(ball.share)) <= 0.5
        if ball.share <= 32:  # with some 32 triangles or fewer there is no number within 5 % of every target
            assert ball.surface.count * ball.share == pytest.approx(8 * 4**4, rel=CLOSE)
    shares = [ball.share for ball in balls]
    assert shares[:3] == [2, 4, 8]
    assert shares == sorted(set(shares))


def test_the_vertices_are_some_of_the_given_ones_to_the_last_bit(balls: list[Simplified]) -> None:
    vertices = set(map(tuple, sphere(splits=4)[0].tolist()))
    for ball in balls:
        assert set(map(tuple, ball.surface.vertices.tolist())) <= vertices


def test_a_convex_solid_loses_volume_with_every_halving(balls: list[Simplified]) -> None:
    volumes = [volume(joined(sphere(splits=4))), *(volume(ball.surface) for ball in balls)]
    assert volumes == sorted(volumes, reverse=True)
    assert volumes[-1] > 0
    for ball in balls:
        assert_volume_of_a_ball(ball.surface)


def test_the_bound_on_inscribed_volume_is_reached_by_the_regular_solids() -> None:
    assert largest_inscribed(4) == pytest.approx(8 / (9 * math.sqrt(3)), rel=1e-14)
    assert largest_inscribed(8) == pytest.approx(4 / 3, rel=1e-14)
    assert largest_inscribed(20) == pytest.approx(math.sqrt(40 + 8 * math.sqrt(5)) / 3, rel=1e-14)


def test_the_tolerance_is_that_of_all_halvings_together(balls: list[Simplified]) -> None:
    tolerances = [ball.tolerance for ball in balls]
    assert tolerances == sorted(set(tolerances))
    for ball in balls[:3]:  # still small beside the ball: its vertices are on the sphere, its faces within
        corners = ball.surface.corners()
        depth = 1.0 - np.linalg.norm(corners.mean(axis=1), axis=1).min()
        assert 0 < depth < 2 * ball.tolerance


@pytest.mark.parametrize("scale", [1e-30, 1e60])
def test_size_changes_nothing_but_the_size(scale: float) -> None:
    vertices, faces = sphere(splits=3)
    power = 2.0 ** round(np.log2(scale))
    here, there = (list(itertools.islice(halvings(Surface(k * vertices, faces)), 3)) for k in (1.0, power))
    assert [mesh.surface.count for mesh in here] == [mesh.surface.count for mesh in there]
    for one, other in zip(here, there, strict=True):
        np.testing.assert_array_equal(one.surface.vertices * power, other.surface.vertices)
        assert one.tolerance * power == other.tolerance


def test_a_flat_subdivision_is_undone_without_loss() -> None:
    steps = np.linspace(0.0, 1.0, 9)
    square = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    i = (9 * np.arange(8)[:, None] + np.arange(8)).ravel()
    faces = np.concatenate([np.stack([i, i + 9, i + 10], axis=1), np.stack([i, i + 10, i + 1], axis=1)])
    sides = []
    for axis in range(3):
        for level in (0.0, 1.0):
            outward = (level == 1.0) != (axis == 1)
            sides.append((np.insert(square, axis, level, axis=1), faces if outward else faces[:, ::-1]))
    box = joined(*sides)
    assert (box.count, closure(box).open_edges, volume(box)) == (768, 0, 1.0)
    first = next(halvings(box))
    assert (first.surface.count, first.share, volume(first.surface)) == (12, 64, 1.0)


def test_cavities_stay_cavities() -> None:
    hollow = joined(sphere(radius=3.0), inside_out(sphere(radius=2.0)))
    outer, inner = pieces(next(halvings(hollow)).surface)
    assert volume(inner) < 0
    assert_volume_of_a_ball(outer, 3.0)
    assert_volume_of_a_ball(inner, 2.0)


def test_records_of_an_stl_file_do_as_well() -> None:
    surface = joined(ring())
    half = next(halvings(facets(surface))).surface
    assert half.count == pytest.approx(surface.count / 2, rel=CLOSE)
    assert half.count == 2 * len(np.unique(half.faces))  # Euler: a torus stays one


def test_a_cube_has_nothing_to_spare() -> None:
    assert list(halvings(joined(cube()))) == []


def test_an_edge_of_four_triangles_is_no_hindrance() -> None:
    beside = joined(sphere(), cube((1, 1, 0)), cube((2, 2, 0)))
    first = next(halvings(beside))
    assert closure(first.surface).open_edges == 0
    ball, *cubes = pieces(first.surface)
    assert sum(map(volume, cubes)) == pytest.approx(2, rel=1e-14)
    assert_volume_of_a_ball(ball)


def test_an_open_surface_is_refused() -> None:
    vertices, faces = sphere()
    with pytest.raises(GeometryError, match="cannot simplify"):
        next(halvings(Surface(vertices, faces[1:])))
