"""Of many bodies, those that may meet are checked by themselves: the answers are those of a check of them all."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mesh.solids import Mesh, box, cube, inside_out, joined, ring, sphere

import inertia
from inertia.mass import integration
from inertia.mesh import check
from inertia.mesh.checks.findings import Report
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.geometry import intersect
from inertia.mesh.part import Part

TURN = Rotation.from_euler("xyz", [0.3, 0.5, 0.7])
APART = [(np.add(TURN.apply(own), [4.0 * x, 4.0 * y, 0]), faces) for x, y in product(range(8), range(6))
         for own, faces in [ring(16, 7, 1.0, 0.25)]]  # fmt: skip
HOUSING = [box((-9, -9, -9), (-3, -3, -3)), inside_out(box((-8, -8, -8), (-4, -4, -4)))]


def blocks(gap: float) -> list[Mesh]:
    """Return two blocks, turned, one before the other."""
    two = box((0, 0, 0), (1, 1, 1)), box((0.2, 0.1, 1 + gap), (0.9, 0.7, 2 + gap))
    return [(TURN.apply(own) - [6, 6, 6], faces) for own, faces in two]


PAIR = joined(cube((-6, -6, -6)), cube((-5, -5, -6)))
PAIR = TURN.apply(PAIR.vertices).astype(np.float32).astype(float), PAIR.faces


def part(*meshes: Mesh) -> Part:
    surface = joined(*meshes)
    return Part.from_arrays(surface.vertices, surface.faces, "mm")


@pytest.fixture
def checked(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return the triangles of each check, as they come."""
    counts: list[int] = []
    original = check.check_surface

    def noted(part: Part, surface: SurfaceTopology, intersections: bool | None) -> Report:
        counts.append(surface.count)
        return original(part, surface, intersections)

    monkeypatch.setattr(check, "check_surface", noted)
    return counts


@pytest.mark.parametrize(
    ("near", "together", "doubts"),
    [
        (blocks(1e-17), 24, 1),  # it is nothing beside 1
        (blocks(-1e-8), 24, 1),
        ([*HOUSING, *blocks(1e-17)], 48, 1),
        ([*HOUSING, box((-8, -7, -7), (-7, -6, -6))], 36, 0),
        ([cube((-6, -6, -6)), cube((-5, -6, -6))], 0, 0),
        ([cube((-6, -6, -6)), cube((-5, -5, -6))], 0, 0),
        ([PAIR], 24, 0),
    ],
    ids=[
        "two blocks",
        "blocks with a common slice",
        "two blocks in a housing",
        "a block at the wall of its housing",
        "cubes with a common side",
        "cubes with a common edge",
        "cubes with a common edge, turned, of float32",
    ],
)
def test_those_that_touch_are_checked_by_themselves(
    near: list[Mesh], together: int, doubts: int, checked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = part(*APART, *near)
    found = inertia.analyse(whole, density=1000.0)
    assert checked == [together] * (together > 0)
    monkeypatch.setattr(integration, "nesting_of", lambda *_: None)
    again = inertia.analyse(whole, density=1000.0)
    assert checked[together > 0 :] == [whole.triangles.count]
    assert found.bodies == again.bodies == len(APART) + (2 if together in (0, 24) else len(near) - 1)
    assert (again.properties.inertia == found.properties.inertia).all()
    assert again.properties.error.inertia == found.properties.error.inertia
    assert len(found.doubts) == doubts
    assert [str(doubt.message) for doubt in found.doubts] == [str(doubt.message) for doubt in again.doubts]


@pytest.mark.parametrize(
    "near",
    [
        blocks(-0.01),
        [*HOUSING, sphere((-4, -6, -6), 0.5)],
        [cube((-6, -6, -6)), box((-6, -6, -6), (-5, -5.5, -4))],
        [cube((-6, -6, -6)), inside_out(cube((-5, -6, -6)))],
        [cube((-6, -6, -6)), cube((-6, -6, -6))],
        [inside_out(PAIR)],
    ],
)
def test_faults_are_those_of_the_whole(near: list[Mesh], monkeypatch: pytest.MonkeyPatch) -> None:
    whole = part(*APART, *near)
    with pytest.raises(inertia.GeometryError) as by_themselves:
        inertia.analyse(whole, density=1000.0)
    monkeypatch.setattr(integration, "nesting_of", lambda *_: None)
    with pytest.raises(inertia.GeometryError) as together:
        inertia.analyse(whole, density=1000.0)
    assert str(by_themselves.value) == str(together.value)


def test_triangles_of_one_body_that_cross_are_found_beside_bodies_that_touch() -> None:
    vertices, faces = sphere((-5, 0, 0), splits=2)
    vertices[0] = [-6.5, 0, 0]  # through the other side
    with pytest.raises(inertia.GeometryError, match="self-intersection"):
        inertia.analyse(part(*APART, *blocks(1e-17), (vertices, faces)), density=1000.0)


def test_of_a_large_part_the_shells_with_common_edges_are_looked_through(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(intersect, "EXAMINED", 100)
    side_by_side = cube((-6, -6, -6)), cube((-5, -6, -6))
    found = inertia.analyse(part(*APART, *side_by_side), density=1000.0)
    assert (found.bodies, found.crossings_examined) == (len(APART) + 2, False)
    assert inertia.analyse(part(*APART, *side_by_side), density=1000.0, intersections=True).crossings_examined
    vertices, faces = side_by_side[1]
    vertices = vertices.copy()
    vertices[vertices.sum(axis=1).argmax()] -= [0.2, 0.2, 1.2]  # through the bottom
    crossing = part(*APART, side_by_side[0], (vertices, faces))
    with pytest.raises(inertia.GeometryError, match="self-intersection"):
        inertia.analyse(crossing, density=1000.0)
