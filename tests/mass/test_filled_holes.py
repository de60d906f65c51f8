"""What filling a hole may be off by, against parts that are known whole: a piece is cut out, and the rest repaired."""

from collections import defaultdict
from contextlib import suppress

import numpy as np
import pytest
from tests.mesh.solids import Mesh, box, cube, inside_out, joined, ring, sphere

import inertia
from inertia import Part
from inertia.errors import GeometryError
from inertia.report.analysis.document import analysis_document
from inertia.report.analysis.text import analysis_text


def moments(mesh: Mesh) -> tuple[float, np.ndarray, np.ndarray]:
    """Return volume, centroid and tensor about it, by a sum of tetrahedra about the mean of the vertices."""
    middle = mesh[0].mean(axis=0)
    corners = (mesh[0] - middle)[mesh[1]]
    volumes = np.linalg.det(corners) / 6
    volume, sums = volumes.sum(), corners.sum(axis=1)
    center = (volumes[:, None] * sums).sum(axis=0) / 4 / volume
    squares = np.einsum("ti,tj->tij", sums, sums) + np.einsum("tki,tkj->tij", corners, corners)
    second = np.einsum("t,tij->ij", volumes, squares) / 20 - volume * np.outer(center, center)
    return float(volume), center + middle, np.trace(second) * np.eye(3) - second


def assert_admits(mesh: Mesh, missing: np.ndarray | list[int]) -> float:
    """Repair a mesh without some of its faces, and compare with the whole; return the width over the volume."""
    repaired = inertia.repair(Part.from_arrays(mesh[0], np.delete(mesh[1], missing, axis=0)))
    volume, center, tensor = moments(mesh)
    assert repaired.volume_between is not None
    least, most = repaired.volume_between
    assert least <= volume * (1 + 1e-12)
    assert volume <= most * (1 + 1e-12)
    filled, error = inertia.mass_properties(repaired.part, 1.0), repaired.error
    assert abs(filled.volume - volume) <= (error.volume + 1e-12) * filled.volume
    assert np.linalg.norm(filled.center_of_mass - center) <= error.center_of_mass + 1e-12
    assert np.linalg.norm(filled.inertia - tensor) <= (error.inertia + 1e-12) * np.linalg.norm(filled.inertia)
    return (most - least) / volume


def fan(mesh: Mesh, vertex: int) -> np.ndarray:
    """Return the numbers of the faces around a vertex."""
    return np.flatnonzero((mesh[1] == vertex).any(axis=1))


def patch(mesh: Mesh, start: int, count: int) -> list[int]:
    """Return the numbers of `count` faces that hang together, breadth first."""
    users = defaultdict(list)
    for face, corners in enumerate(mesh[1].tolist()):
        for edge in zip(corners, (*corners[1:], corners[0]), strict=True):
            users[frozenset(edge)].append(face)
    faces = dict.fromkeys([start])
    for face in (queue := [start]):
        a, b, c = mesh[1][face].tolist()
        fresh = {other for edge in ((a, b), (b, c), (c, a)) for other in users[frozenset(edge)]} - faces.keys()
        queue += sorted(fresh)
        faces |= dict.fromkeys(sorted(fresh))
    return list(faces)[:count]


def cone(sides: int, height: float, rows: int) -> Mesh:
    """Return a cone of radius 1 whose slope is cut in rows of equal height."""
    turn = 2 * np.pi * np.arange(sides) / sides
    share = 1 - np.repeat(np.arange(rows), sides)[:, None] / rows
    rim = np.column_stack([np.cos(turn), np.sin(turn)])
    rings = np.column_stack([share * np.tile(rim, (rows, 1)), height * (1 - share)])
    here = np.arange(sides * (rows - 1))
    beside = here // sides * sides + (here + 1) % sides
    last = np.arange(sides)
    after, top, bottom = (last + 1) % sides, sides * rows, sides * rows + 1
    faces = [
        np.column_stack([here, beside, beside + sides]),
        np.column_stack([here, beside + sides, here + sides]),
        np.column_stack([last + sides * (rows - 1), after + sides * (rows - 1), np.full(sides, top)]),
        np.column_stack([after, last, np.full(sides, bottom)]),
    ]
    return np.vstack([rings, [[0, 0, height], [0, 0, 0]]]), np.vstack(faces)


def drum(sides: int, height: float) -> Mesh:
    """Return a cylinder of radius 1; its lid is the first faces."""
    turn = 2 * np.pi * np.arange(sides) / sides
    rim = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(sides)])
    here = np.arange(sides)
    after, middle = (here + 1) % sides, np.full(sides, 2 * sides)
    faces = [
        np.column_stack([here + sides, after + sides, middle + 1]),
        np.column_stack([after, here, middle]),
        np.column_stack([here, after, after + sides]),
        np.column_stack([here, after + sides, here + sides]),
    ]
    return np.vstack([rim, np.add(rim, [0, 0, height]), [[0, 0, 0], [0, 0, height]]]), np.vstack(faces)


def lumpy(seed: int) -> Mesh:
    """Return a sphere with waves of random direction and phase on it."""
    points, faces = sphere(splits=4)
    rng = np.random.default_rng(seed)
    waves = [0.1 * np.sin(points @ rng.normal(0, 3, 3) + rng.uniform(0, 6)) for _ in range(4)]
    return points * (1 + sum(waves))[:, None], faces


def rough(amplitude: float) -> Mesh:
    """Return a sphere whose vertices are moved in and out at random."""
    points, faces = sphere(splits=4)
    return points * (1 + amplitude * np.random.default_rng(7).normal(size=(len(points), 1))), faces


def fine_box() -> Mesh:
    """Return a box of 1 × 2 × 3 with 768 triangles."""
    points, faces = box((0, 0, 0), (1, 2, 3))
    for _ in range(3):
        corners = points[faces]
        halves = (corners + np.roll(corners, -1, axis=1)) / 2
        a, b, c = corners.transpose(1, 0, 2)
        ab, bc, ca = halves.transpose(1, 0, 2)
        split = np.stack([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]).transpose(0, 2, 1, 3).reshape(-1, 3)
        points, faces = np.unique(split, axis=0, return_inverse=True)
        faces = faces.reshape(-1, 3)
    return points, faces


@pytest.mark.parametrize("face", range(6))
def test_a_cube_without_a_face(face):
    assert_admits(cube(), [2 * face, 2 * face + 1])


@pytest.mark.parametrize("triangle", range(12))
def test_a_cube_without_a_triangle(triangle):
    assert assert_admits(cube(), [triangle]) < 0.2


@pytest.mark.parametrize("corner", range(8))
def test_a_cube_without_a_corner(corner):
    assert_admits(cube(), fan(cube(), corner))


@pytest.mark.parametrize("splits", [2, 3, 4])
@pytest.mark.parametrize("vertex", [0, 7, 30])
def test_a_sphere_without_the_triangles_around_a_vertex(splits, vertex):
    mesh = sphere(splits=splits)
    assert assert_admits(mesh, fan(mesh, vertex)) < 0.5 * 4.0 ** (1 - splits)


@pytest.mark.parametrize("splits", [2, 3, 4])
@pytest.mark.parametrize("height", np.linspace(-0.3, 0.95, 8))
@pytest.mark.parametrize("axis", [(0, 0, 1), (0.1, 0.2, 0.97)])
def test_a_sphere_without_a_cap_of_any_size(splits, height, axis):
    """The rim of a cut across is plane, that of one askew has teeth."""
    points, faces = sphere(splits=splits)
    along = points[faces].mean(axis=1) @ axis
    assert_admits((points, faces), np.flatnonzero(along >= min(height, along.max())))  # a triangle at least


@pytest.mark.parametrize(("sides", "height"), [(6, 1), (32, 1), (64, 0.5), (16, 10), (400, 2)])
def test_a_cylinder_without_its_lid(sides, height):
    assert_admits(drum(sides, height), np.arange(sides))


@pytest.mark.parametrize("height", [0.1, 0.5, 1, 3, 10, 50])
@pytest.mark.parametrize("sides", [3, 6, 32])
@pytest.mark.parametrize("share", [0.95, 0.8, 0.6, 0.55])
def test_a_cone_without_its_tip(height, sides, share):
    """The planes of its slope meet at the tip, and the room is hardly larger than the tip."""
    mesh = cone(sides, height, 20)
    missing = np.flatnonzero(mesh[0][mesh[1]].mean(axis=1)[:, 2] > share * height)
    assert_admits(mesh, missing)


@pytest.mark.parametrize("mesh", [ring(), ring(64, 24)], ids=["coarse", "fine"])
@pytest.mark.parametrize("count", [1, 2, 6, 20, 60, 150, 200])
def test_a_torus_without_a_patch(mesh, count):
    for start in np.random.default_rng(count).integers(0, len(mesh[1]), 2).tolist():
        assert_admits(mesh, patch(mesh, start, count))


@pytest.mark.parametrize(
    "mesh",
    [lumpy(0), lumpy(1), lumpy(2), rough(0.005), rough(0.02), rough(0.05), fine_box()],
    ids=["lumpy 0", "lumpy 1", "lumpy 2", "rough 0.005", "rough 0.02", "rough 0.05", "box"],
)
@pytest.mark.parametrize("count", [1, 2, 6, 20, 60, 150, 200])
def test_random_holes(mesh, count):
    answers = 0
    for start in np.random.default_rng(count).integers(0, len(mesh[1]), 2).tolist():
        with suppress(GeometryError):  # a hole nearly as large as what is left of the part
            assert_admits(mesh, patch(mesh, start, count))
            answers += 1
    assert answers > 0


def test_several_holes_add_up():
    mesh = joined(sphere(), sphere((5, 0, 0)), cube((0, 5, 0)))
    mesh = mesh.vertices, mesh.faces
    widths = [assert_admits(mesh, fan(mesh, vertex)) for vertex in (7, 300)]
    assert assert_admits(mesh, np.concatenate([fan(mesh, 7), fan(mesh, 300)])) == pytest.approx(sum(widths), rel=1e-6)


def test_an_inverted_part_with_a_hole():
    """It is filled first and turned then: what was outward is inward."""
    vertices, faces = inside_out(cone(32, 1, 20))
    missing = np.flatnonzero(vertices[faces].mean(axis=1)[:, 2] > 0.7)
    repaired = inertia.repair(Part.from_arrays(vertices, np.delete(faces, missing, axis=0)))
    least, most = repaired.volume_between
    assert least < moments(cone(32, 1, 20))[0] < most


def test_what_is_whole_or_only_welded_has_no_such_bound():
    for mesh in (cube(), inside_out(cube())):
        repaired = inertia.repair(Part.from_arrays(*mesh))
        assert repaired.volume_between is None
        assert repaired.error is None
        assert inertia.analyse(repaired.part).repair is None


def test_the_analysis_states_it_in_the_unit_and_density_of_the_part():
    vertices, faces = lumpy(0)
    part = Part.from_arrays(vertices, np.delete(faces, fan((vertices, faces), 7), axis=0), "mm")
    repaired = inertia.repair(part)
    analysis = inertia.analyse(repaired.part, 7850.0)
    assert analysis.repair.volume == pytest.approx(repaired.error.volume, rel=1e-6)
    assert analysis.repair.mass == pytest.approx(repaired.error.volume, rel=1e-6)
    assert analysis.repair.center_of_mass == pytest.approx(repaired.error.center_of_mass, rel=1e-6)
    assert analysis.repair.inertia == pytest.approx(repaired.error.inertia, rel=1e-6)
    least, most = repaired.volume_between
    assert max(most - analysis.properties.volume, analysis.properties.volume - least) == pytest.approx(
        analysis.repair.volume * analysis.properties.volume, rel=1e-6
    )
    weighed = inertia.analyse(repaired.part, mass=1.0)
    assert weighed.repair.mass < 1e-15
    assert weighed.repair.volume == pytest.approx(repaired.error.volume, rel=1e-6)
    document = analysis_document(analysis, repaired)
    assert document["error"]["repair"]["volume"] == analysis.repair.volume
    assert document["error"]["volume"] < 1e-13  # of the mesh as it is now
    assert document["repair"]["volume_between"] == [least, most]
    text = analysis_text(analysis, repaired)
    assert f"Filled holes      volume {analysis.repair.volume:.2g}, mass" in text
    assert "the filling is a guess: the rims admit volumes from" in text


def test_nothing_is_certain_of_half_a_cube():
    part = inertia.repair(Part.from_arrays(cube()[0], cube()[1][2:])).part
    analysis = inertia.analyse(part)
    assert analysis.repair.volume > 1
    assert analysis.repair.center_of_mass == analysis.repair.inertia == np.inf
    assert analysis_document(analysis)["error"]["repair"]["inertia"] is None
    assert "tensor any (relative),\n                  centre of mass anywhere" in analysis_text(analysis)


def test_what_is_repaired_twice_keeps_the_bound():
    vertices, faces = sphere()
    once = inertia.repair(Part.from_arrays(vertices, faces[1:])).part
    again = inertia.repair(inertia.weld(once, 1e-9).part).part
    assert inertia.analyse(again).repair == inertia.analyse(once).repair


@pytest.mark.parametrize(("mesh", "count", "start"), [(rough(0.1), 250, 1111), (lumpy(2), 400, 777)])
def test_a_filling_that_crosses_the_part_has_an_answer(mesh: Mesh, count: int, start: int) -> None:
    open_part = Part.from_arrays(mesh[0], np.delete(mesh[1], patch(mesh, start, count), axis=0))
    analysis = inertia.analyse(inertia.repair(open_part).part)
    (crossing,) = analysis.doubts
    assert crossing.code == "self_intersection"
    assert "is less than the fillings of the holes leave open" in crossing.message
    volume = moments(mesh)[0]
    answer = analysis.properties
    assert abs(answer.volume - volume) <= (analysis.repair.volume + answer.error.volume) * answer.volume
    assert answer.error.volume < analysis.repair.volume
