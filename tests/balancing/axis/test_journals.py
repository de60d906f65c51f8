"""Axes from cylinders fitted to vertices: the sample rotor in any frame, with noise, and shapes that mislead."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from inertia import GeometryError, UsageError
from inertia.balancing.axis.cylinder_fit import fit_axis
from inertia.balancing.axis.journals import axis_candidates
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.read import read
from inertia.mesh.surface import Surface
from inertia_meshes import path

TWO_DISCS = [(15, 80), (100, 20), (15, 100), (80, 30), (15, 70)]


@pytest.fixture(scope="module")
def rotor():
    return merge_equal_vertices(read(path("two_disc_rotor.stl")).triangles)


def wall(radius, low, high, *, center=(0.0, 0.0), angles=(0.0, 2 * math.pi), count=96, rings=2, inward=False):
    """Return the triangles (m, 3, 3) of a cylinder's wall along z, whose corners lie on the cylinder."""
    angle = np.linspace(*angles, count + 1)
    if angles[1] - angles[0] > 6.28:
        angle[-1] = angle[0]
    line = np.stack([center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)], axis=1)
    triangles = []
    for a, b in itertools.pairwise(np.linspace(low, high, rings)):
        foot, head = (np.column_stack([line, np.full(count + 1, z)]) for z in (a, b))
        triangles += [np.stack([foot[:-1], foot[1:], head[1:]], 1), np.stack([foot[:-1], head[1:], head[:-1]], 1)]
    corners = np.concatenate(triangles)
    return corners[:, ::-1] if inward else corners


def surface(*walls):
    corners = np.concatenate(walls)
    return Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def off_axis(candidate, point, direction, places):
    """Return the largest distance of points along the true axis from the one that was found."""
    true = np.asarray(point) + np.outer(places, direction)
    return np.linalg.norm(np.cross(true - candidate.point, candidate.direction), axis=1).max()


def test_the_sample_rotors_shaft_leads_and_its_holes_follow(rotor):
    candidates = axis_candidates(Surface(*rotor))
    assert [(round(k.radius, 4), round(k.length, 4)) for k in candidates[0].journals] == TWO_DISCS
    assert not any(k.bore for k in candidates[0].journals)
    assert [k.coverage for k in candidates[0].journals] == pytest.approx([1.0] * 5)
    assert candidates[0].direction == pytest.approx([0, 0, 1], abs=1e-9)
    assert off_axis(candidates[0], [0, 0, 0], [0, 0, 1], [0, 300]) < 1e-5
    holes = [(round(k.journals[0].radius, 4), k.journals[0].bore) for k in candidates[1:]]
    assert holes == [(6.0, True), (5.0, True)]
    center = candidates[1].journals[0].center
    assert np.hypot(*center[:2]) == pytest.approx(60, abs=1e-4)
    assert math.degrees(math.atan2(center[1], center[0])) % 360 == pytest.approx(200, abs=1e-4)


@settings(deadline=None, max_examples=8)
@given(st.integers(0, 10**6))
def test_turning_and_moving_the_part_moves_the_axis_and_nothing_else(seed):
    vertices, faces = merge_equal_vertices(read(path("two_disc_rotor.stl")).triangles)
    random = np.random.default_rng(seed)
    turned, moved = Rotation.random(random_state=seed).as_matrix(), random.uniform(-500, 500, 3)
    candidates = axis_candidates(Surface(vertices @ turned.T + moved, faces))
    assert len(candidates) == 3
    assert off_axis(candidates[0], moved, turned[:, 2], [0, 300]) < 1e-5
    assert sorted((round(k.radius, 4), round(k.length, 4)) for k in candidates[0].journals) == sorted(TWO_DISCS)
    assert candidates[0].direction[np.argmax(np.abs(candidates[0].direction))] > 0


@pytest.mark.parametrize("noise", [1e-3, 5e-3, 2e-2])
def test_noise_on_the_vertices_is_averaged_and_its_uncertainty_stated(rotor, noise):
    vertices, faces = rotor
    turned, moved = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix(), [500.0, -300.0, 200.0]
    random = np.random.default_rng(4)
    shaken = vertices @ turned.T + moved + noise * random.normal(size=vertices.shape)
    best = axis_candidates(Surface(shaken, faces))[0]
    assert len(best.journals) == 5
    assert best.rms == pytest.approx(noise, rel=0.05)
    off = off_axis(best, moved, turned[:, 2], [0, 300])
    assert off < 4 * best.uncertainty < 0.6 * noise


def test_the_uncertainty_is_the_scatter_of_repeated_fits():
    random = np.random.default_rng(0)
    points = wall(10, 0, 50).reshape(-1, 3)
    member, end = np.zeros(len(points), int), np.array([0, 0, 50.0])
    fits = [
        fit_axis(points + 0.01 * random.normal(size=points.shape), member, np.array([0, 0, 1.0]), points.mean(0))
        for _ in range(200)
    ]
    scatter = np.sqrt(np.mean([fit.offset(end) ** 2 for fit in fits]))
    assert np.mean([fit.uncertainty(end) for fit in fits]) == pytest.approx(scatter, rel=0.15)


def test_both_axes_of_the_bent_wheel_are_offered():
    candidates = axis_candidates(read(path("bent_wheel.stl")).triangles)
    assert [round(k.journals[0].radius, 4) for k in candidates] == [10.0, 5.0]
    assert candidates[0].direction == pytest.approx([40 / 401, 0, 399 / 401], abs=1e-7)
    assert candidates[1].direction == pytest.approx([0, 0, 1], abs=1e-7)


@pytest.mark.parametrize("name", ["box", "sphere", "torus", "cone"])
def test_parts_without_a_cylinder_give_no_axis(name):
    assert axis_candidates(read(path(f"{name}.stl")).triangles) == ()


def test_a_crank_pin_is_an_axis_of_its_own():
    part = surface(
        wall(20, 0, 60), wall(18, 100, 160), wall(15, 65, 95, center=(3.0, 0.0)), wall(9, 160, 180, inward=True)
    )
    main, pin = axis_candidates(part)
    assert [(round(k.radius, 6), k.bore) for k in main.journals] == [(20.0, False), (18.0, False), (9.0, True)]
    assert pin.point[:2] == pytest.approx([3, 0], abs=1e-9)
    assert [k.center[2] for k in main.journals] == pytest.approx([30, 130, 170])


def test_candidates_are_ranked_by_area_times_coverage():
    whole = wall(10, 0, 20)
    third = wall(30, 0, 20, center=(100, 0), angles=(0, 2 * math.pi / 3), count=32)
    candidates = axis_candidates(surface(whole, third))
    assert [round(k.journals[0].radius, 6) for k in candidates] == [10.0, 30.0]
    assert candidates[1].journals[0].coverage == pytest.approx(1 / 3)
    area = 32 * 20 * 2 * 30 * math.sin(math.pi / 96)
    assert candidates[1].score == pytest.approx(area / 3)


def test_what_a_keyway_leaves_of_a_cylinder_is_one_journal():
    halves = [wall(10, 0, 40, angles=(start, start + 2.9), count=40) for start in (-1.45, 1.69)]
    (candidate,) = axis_candidates(surface(*halves))
    (journal,) = candidate.journals
    assert journal.coverage == pytest.approx(5.8 / (2 * math.pi))
    assert off_axis(candidate, [0, 0, 0], [0, 0, 1], [0, 40]) < 1e-9


def test_the_foot_of_a_fillet_does_not_shift_the_axis():
    angle = np.radians(np.linspace(0, 90, 31))
    profile = [(10 + 5 * (1 - math.cos(k)), 40 + 5 * math.sin(k)) for k in angle]
    turns = 2 * np.pi * (np.arange(73) % 72) / 72
    rings = [np.column_stack([r * np.cos(turns), r * np.sin(turns), np.full(73, z)]) for r, z in [(10, 0), *profile]]
    fillet = [
        np.concatenate([np.stack([a[:-1], a[1:], b[1:]], 1), np.stack([a[:-1], b[1:], b[:-1]], 1)])
        for a, b in itertools.pairwise(rings)
    ]
    best = axis_candidates(surface(*fillet, wall(6, -30, 0)))[0]
    assert off_axis(best, [0, 0, 0], [0, 0, 1], [-30, 40]) < 1e-9
    assert max(k.radius for k in best.journals) == pytest.approx(10, abs=5 * (1 - math.cos(math.radians(3))))


def test_a_direction_that_is_given_is_the_only_one_tried():
    part = surface(wall(20, 0, 60), wall(15, 0, 90, center=(50, 0))[:, :, [2, 0, 1]])
    assert len(axis_candidates(part)) == 2
    (candidate,) = axis_candidates(part, along=[0, 0.005, -1])
    assert candidate.direction == pytest.approx([0, 0, 1])


@pytest.mark.parametrize(
    ("options", "text"),
    [({"along": [0, 0, 0]}, "no length"), ({"tolerance": 0.0}, "tolerance is 0.0"), ({"along": [1, 2]}, "shape")],
)
def test_bad_options_are_refused(options, text):
    with pytest.raises(UsageError, match=text):
        axis_candidates(surface(wall(10, 0, 20)), **options)


def test_a_mesh_without_area_has_no_axis():
    assert axis_candidates(Surface(np.empty((0, 3)), np.empty((0, 3), int))) == ()
    assert axis_candidates(Surface(np.outer(np.arange(3.0), [1, 2, 3]), [[0, 1, 1]])) == ()


def test_a_coordinate_that_is_not_finite_is_named():
    corners = wall(10, 0, 20)
    corners[5, 2, 0] = np.nan
    with pytest.raises(GeometryError, match="triangle 5 has at corner 2"):
        axis_candidates(surface(corners))
