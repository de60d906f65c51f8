"""Tolerant welding, against small cases that can be read off and against distances measured one by one."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist
from tests.mesh import solids
from tests.mesh.solids import Mesh, part, ring

from inertia import check, mass_properties, weld
from inertia.errors import GeometryError, UsageError
from inertia.mesh.repairs.weld import weld_within
from inertia.mesh.surface import FACET, Facets, Surface
from inertia_meshes.shapes import box, sphere


def soup(corners) -> Surface:
    points = np.asarray(corners, float).reshape(-1, 3)
    return Surface(points, np.arange(len(points)).reshape(-1, 3))


def test_vertices_that_are_apart_keep_their_bits():
    corners = sphere(1, 24) / 3
    welded = weld_within(soup(corners), 1e-9)
    assert (welded.merged, welded.largest_move, welded.collapsed) == (0, 0.0, 0)
    assert welded.surface.corners().tobytes() == (corners + 0.0).tobytes()  # −0 is read as 0
    assert welded.remaining.tolist() == list(range(len(corners)))


def test_the_first_vertex_of_a_group_keeps_its_bits():
    corners = box(1, 1, 1)
    first = corners[0, 0].copy()
    rng = np.random.default_rng(1)
    shaken = corners + np.where((corners == first).all(axis=2)[..., None], rng.uniform(-1e-6, 1e-6, (3,)), 0)
    shaken[0, 0] = first
    welded = weld_within(soup(shaken), 1e-5)
    assert welded.surface.corners().tobytes() == corners.tobytes()
    assert len(welded.surface.vertices) == 8
    assert welded.merged == 1
    assert welded.largest_move == pytest.approx(np.linalg.norm(shaken - corners, axis=2).max())


def test_what_is_left_is_farther_apart_than_the_tolerance():
    corners = np.random.default_rng(2).normal(size=(300, 3, 3)) / 2
    welded = weld_within(soup(corners), 0.1)
    assert welded.merged == 900 - len(np.unique(welded.surface.faces)) > 50
    assert pdist(welded.surface.vertices).min() > 0.1


def test_closeness_chains():
    line = np.column_stack([np.arange(9) * 0.1, np.zeros(9), np.zeros(9)])
    far = np.array([[5.0, 0, 0], [0, 5, 0], [0, 0, 5]])
    surface = Surface(np.vstack([line, far]), [[k, 9 + k % 3, 9 + (k + 1) % 3] for k in range(9)])
    welded = weld_within(surface, 0.11)
    assert welded.merged == 8
    assert welded.largest_move == pytest.approx(0.8)
    assert weld_within(surface, 0.09).merged == 0


def test_triangles_that_collapse_are_dropped_and_counted():
    surface = Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1e-4, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 0], [3, 4, 2]])
    welded = weld_within(surface, 1e-3)
    assert welded.collapsed == 1
    assert welded.remaining.tolist() == [0, 2]
    assert welded.surface.faces.tolist() == [[0, 1, 2], [1, 3, 2]]


def test_binary_stl_records_are_taken():
    records = np.zeros(12, FACET)
    corners = box(1, 2, 3).astype(np.float32).reshape(12, 9)
    for k, name in enumerate(("x0", "y0", "z0", "x1", "y1", "z1", "x2", "y2", "z2")):
        records[name] = corners[:, k]
    welded = weld_within(Facets(records), 1e-6)
    assert len(welded.surface.vertices) == 8
    assert welded.merged == 0


@pytest.mark.parametrize("tolerance", [0, -1, float("nan"), float("inf"), 0.18])
def test_unusable_tolerances_are_refused(tolerance):
    with pytest.raises(UsageError, match=r"above 0 and at most a tenth .* 0\.1732"):
        weld_within(soup(box(1, 1, 1)), tolerance)


def test_the_largest_tolerance_is_taken():
    assert weld_within(soup(box(1, 1, 1)), 0.17).merged == 0


def test_a_tolerance_that_melts_the_part_is_refused():
    corners = np.random.default_rng(3).uniform(size=(4000, 3, 3)) / 10
    corners[0, 0] = 1
    with pytest.raises(UsageError, match=r"pairs of vertices lie within the weld tolerance 0\.17"):
        weld_within(soup(corners), 0.17)


def test_coordinates_must_be_finite():
    with pytest.raises(GeometryError, match="triangle 1 has at corner 2 a coordinate that is no usable number"):
        weld_within(soup([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [1, 0, 0], [0, np.inf, 0]]]), 0.1)


def cracked(mesh: Mesh, width: float, seed: int) -> Surface:
    """Cut a mesh in two at x = 0 and move the vertices of one side by random ways of up to `width`."""
    vertices, faces = mesh[0].copy(), mesh[1].copy()
    right = vertices[faces].mean(axis=1)[:, 0] > 0
    shared = np.intersect1d(faces[right], faces[~right])
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(len(shared), 3))
    way *= (width * rng.uniform(0.1, 1, len(shared)) / np.linalg.norm(way, axis=1))[:, None]
    number = np.arange(len(vertices))
    number[shared] = len(vertices) + np.arange(len(shared))
    faces[right] = number[faces[right]]
    return Surface(np.vstack([vertices, vertices[shared] + way]), faces)


@pytest.mark.parametrize(
    "mesh", [ring(), solids.sphere(), solids.cube(), solids.sphere(radius=1e-3), solids.cube((0, 0.5, 0.5), 1e6)]
)
@pytest.mark.parametrize("width", [1e-14, 1e-9, 1e-6, 1e-4])
@pytest.mark.parametrize("seed", range(3))
def test_an_open_part_names_the_smallest_distance_that_closes_it(mesh: Mesh, width: float, seed: int) -> None:
    size = float(np.ptp(mesh[0]))
    broken = part(cracked(mesh, width * size, seed))
    (opening,) = (finding for finding in check(broken).findings if finding.code == "open")
    remedy = opening.remedies[0]
    assert (remedy.verb, remedy.argument) == ("weld", "tolerance")
    distance = float(remedy.value)
    assert distance <= 1.01 * width * size
    assert f"inertia.weld(part, {distance})" in opening.message
    assert check(weld(broken, distance).part).closed
    for less in (0.5, 0.98):
        assert not check(weld(broken, less * distance).part).closed


def test_cracks_of_a_few_denormals_have_a_distance_too() -> None:
    """Six attometres, seen where sine and cosine of a whole turn meet those of none."""
    vertices, faces = ring(60, 30)
    vertices = np.vstack([vertices * 1e-3, vertices[:30] * 1e-3 + [0, 6e-18, 0]])
    moved = (faces // 30 == 0) & (faces.max(axis=1, keepdims=True) // 30 == 59)
    faces[moved] += 60 * 30
    broken = part(Surface(vertices, faces), unit="m")
    remedy = check(broken).findings[0].remedies[0]
    assert 6e-18 <= remedy.value < 6.1e-18
    assert mass_properties(weld(broken, remedy.value).part).error.volume < 1e-13
    with pytest.raises(GeometryError, match=r"use inertia\.weld\(part, 6.*e-18\) \(the least distance, in m, that"):
        mass_properties(broken)


@pytest.mark.parametrize("mesh", [ring(), solids.sphere(), solids.cube(), solids.sphere(splits=7)])
def test_no_distance_is_named_for_a_hole(mesh: Mesh) -> None:
    vertices, faces = mesh
    assert all(remedy.verb != "weld" for remedy in check(part((vertices, faces[1:]))).findings[0].remedies)
    both = cracked((vertices, faces[1:]), 1e-9, 0)
    assert all(remedy.verb != "weld" for remedy in check(part(both)).findings[0].remedies)


def test_no_distance_is_named_for_two_sheets() -> None:
    """Welding them makes a part without thickness."""
    sheet, faces = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), np.array([[0, 2, 1], [0, 3, 2]])
    sheets = Surface(np.vstack([sheet, np.add(sheet, [0, 0, 1e-6])]), np.vstack([faces, faces[:, ::-1] + 4]))
    assert all(remedy.verb != "weld" for remedy in check(part(sheets)).findings[0].remedies)


def test_no_distance_is_named_that_takes_a_fine_body_along() -> None:
    """The crack is wider than the edges of the sphere beside it, of which a weld would leave nothing."""
    (vertices, faces), crack = solids.sphere((9, 9, 9), 0.01), cracked(solids.cube((0, 0.5, 0.5), 10), 0.02, 0)
    both = Surface(np.vstack([crack.vertices, vertices]), np.vstack([crack.faces, faces + len(crack.vertices)]))
    assert all(remedy.verb != "weld" for remedy in check(part(both)).findings[0].remedies)
    assert check(part(crack)).findings[0].remedies[0].verb == "weld"
