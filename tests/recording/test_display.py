"""What is shown of a body: its triangles about the centre of mass, fewer where they are many, or an ellipsoid."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mesh.solids import box, facets, joined, ring

from inertia import Part, read
from inertia.dynamics.scene.body import SceneBody
from inertia.mass.analyse import analyse
from inertia.mesh.part import CellBlock, Cells
from inertia.mesh.surface import Surface
from inertia.recording.display import (
    display_of,
    equivalent_ellipsoid,
    facet_normals,
    outside,
    shown_triangles,
)
from inertia_meshes import path


def body(part: Part) -> SceneBody:
    return SceneBody.of_analysis(analyse(part, 1000.0))


def volume(corners: np.ndarray) -> float:
    return float(np.linalg.det(corners).sum() / 6)


def test_a_part_is_shown_about_its_centre_of_mass() -> None:
    part = read(path("t_handle.stl"), "mm")
    shown = display_of(body(part))
    assert (shown.unit, shown.notes, shown.semi_axes) == (0.01, (), None)
    center = body(part).center_of_mass
    stored = part.triangles.corners() * 1e-3
    np.testing.assert_allclose(shown.triangles * 0.01 + center, stored, atol=1e-17)
    assert shown.radius == pytest.approx(np.linalg.norm(stored - center, axis=2).max() / 0.01)
    assert np.abs(shown.triangles).max() <= shown.radius


@pytest.mark.parametrize("size", [1e-6, 1e6])
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_size_and_place_do_not_matter(size: float, offset: float) -> None:
    low = tuple(size * offset + size * x for x in (0.0, 0.0, 0.0))
    high = tuple(size * offset + size * x for x in (3.0, 2.0, 1.0))
    shown = display_of(body(Part.from_arrays(*box(low, high))))
    assert 1 <= shown.radius < 10
    np.testing.assert_allclose(np.ptp(shown.triangles.reshape(-1, 3), axis=0) * shown.unit / size, [3, 2, 1], rtol=1e-9)
    np.testing.assert_allclose(shown.triangles.reshape(-1, 3).astype(np.float32).mean(axis=0), 0, atol=1e-6)


def test_normals_point_outwards() -> None:
    corners = joined(box((0, 0, 0), (1, 2, 3))).corners()
    normals = facet_normals(corners - [0.5, 1, 1.5])
    assert np.einsum("ij,ij->i", normals, corners.mean(axis=1) - [0.5, 1, 1.5]).min() > 0
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    assert facet_normals(np.zeros((1, 3, 3))).tolist() == [[0, 0, 0]]


@pytest.mark.parametrize("offset", [0.0, 1e5])
@pytest.mark.parametrize("packed", [False, True])
def test_a_big_mesh_keeps_its_shape_with_fewer_triangles(packed: bool, offset: float) -> None:
    surface = joined(ring(600, 200))
    surface = Surface(surface.vertices + offset, surface.faces)
    part = Part(facets(surface) if packed else surface, read(path("cube.stl"), "m").unit)
    corners, count = shown_triangles(part, np.full(3, offset), most=20_000)
    assert count == 240_000
    assert 8_000 < len(corners) < 30_000
    tolerance = 0.06 if packed and offset else 0.02  # float32 at the offset
    assert volume(corners) == pytest.approx(2 * np.pi**2 * 3, rel=tolerance)
    from_circle = np.linalg.norm(corners[..., :2], axis=2) - 3
    assert np.abs(np.hypot(from_circle, corners[..., 2]) - 1).max() < 0.1


def test_the_reduction_is_said() -> None:
    shown = display_of(body(Part.from_arrays(*ring(600, 200))))
    assert shown.triangles is not None
    assert shown.notes == (
        f"shown with {len(shown.triangles)} of its 240000 triangles: near corners are merged, for display only",
    )


def test_parts_far_apart_can_be_reduced() -> None:
    vertices, faces = ring(100, 50)
    far = joined((vertices, faces), (vertices + np.array([1e5, 0, 0]), faces))
    corners, count = shown_triangles(Part(far, read(path("cube.stl"), "m").unit), np.zeros(3), most=100)
    assert 8 <= len(corners) < count == 20_000


def test_a_mesh_of_cells_shows_its_outside() -> None:
    points = np.array([[x, y, z] for z in (0, 1, 2) for y in (0, 1) for x in (0, 1)], float)
    lower = np.array([[0, 1, 3, 2, 4, 5, 7, 6]])
    faces = outside(Cells(points, (CellBlock("hexahedron", np.concatenate([lower, lower + 4])),)))
    assert faces.count == 20
    assert volume(faces.corners() - [0.5, 0.5, 1]) == pytest.approx(2)
    tetrahedra = np.array([[0, 1, 2, 4], [3, 2, 1, 7], [1, 2, 4, 7], [5, 4, 7, 1], [6, 7, 4, 2]])
    assert outside(Cells(points, (CellBlock("tetra", tetrahedra),))).count == 12
    assert outside(Cells(points, (CellBlock("line", lower[:, :2]),))).count == 0
    assert display_of(body(read(path("two_region_bar.vtk"), "mm"))).triangles is not None


def test_moments_alone_are_shown_as_an_ellipsoid() -> None:
    semi_axes = np.array([0.5, 0.3, 0.2])
    moments = 2.0 / 5 * (np.sum(semi_axes**2) - semi_axes**2)
    np.testing.assert_allclose(equivalent_ellipsoid(moments, 2.0), semi_axes, rtol=1e-14)
    turn = Rotation.from_rotvec([0.3, 0.2, 0.1]).as_matrix()
    shown = display_of(SceneBody(turn @ np.diag(moments) @ turn.T, 2.0))
    assert shown.triangles is None
    assert shown.notes == ("shown as the solid ellipsoid of the same moments",)
    np.testing.assert_allclose(shown.unit * shown.semi_axes, semi_axes, rtol=1e-9)
    axes = Rotation.from_quat(shown.attitude).as_matrix()
    np.testing.assert_allclose(np.abs(np.diag(axes.T @ turn)), 1, atol=1e-9)


def test_a_flat_body_can_be_seen_from_its_edge() -> None:
    assert equivalent_ellipsoid(np.array([1.0, 1.0, 2.0]), 1.0).min() == pytest.approx(0.01 * np.sqrt(5))
    shown = display_of(SceneBody(np.diag([1.0, 1.0, 2.0])))
    assert shown.notes == ("shown as the solid ellipsoid of the same moments, of 1 kg as no mass is given",)


def test_a_point_mass_is_shown_as_a_sphere() -> None:
    body = display_of(SceneBody(np.zeros((3, 3)), 1.0, np.array([0.0, 0.0, -2.0])))
    assert body.semi_axes is not None
    np.testing.assert_allclose(body.unit * body.semi_axes, [0.1] * 3)
    assert body.notes == ("its mass is in a point, shown as a sphere",)


def test_wires_are_shown_as_an_ellipsoid() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0]], float)
    wire = Part(Cells(points, (CellBlock("line", np.array([[0, 1], [1, 2]])),)))
    assert display_of(SceneBody.of_analysis(analyse(wire, 1000.0, wire=1.0))).triangles is None
