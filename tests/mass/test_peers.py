"""Agreement with other programs, as far as their own error allows.

Their errors, measured against rational arithmetic near the origin: some 1e-14 of the tensor for trimesh and
libigl, and of the volume for VTK; some 1e-7 for MuJoCo, which stores float32.
"""

import numpy as np
import pytest

import inertia
from inertia_meshes import path

SAMPLES = ["t_handle.stl", "tetrahedron.stl", "sphere_cavity.stl", "bent_wheel.stl"]


def welded(name):
    """Return a sample's vertices and faces in millimetres, with equal corners as one vertex."""
    corners = inertia.read(path(name)).triangles.corners()
    vertices, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return vertices, faces.reshape(-1, 3)


def ours(name):
    """Return the answer in powers of millimetres for unit density: volume, centre of mass, tensor."""
    properties = inertia.mass_properties(inertia.read(path(name), unit="m"), 1.0)
    return properties.volume, properties.center_of_mass, properties.inertia


def assert_near(value, name, tolerance):
    volume, com, tensor = ours(name)
    size = np.cbrt(volume)
    assert value[0] == pytest.approx(volume, rel=tolerance)
    assert np.linalg.norm(value[1] - com) <= tolerance * max(size, np.linalg.norm(com))
    assert np.linalg.norm(value[2] - tensor) <= tolerance * np.linalg.norm(tensor)


@pytest.mark.parametrize("name", SAMPLES)
def test_trimesh(name):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = welded(name)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight
    assert_near((mesh.volume, mesh.center_mass, mesh.moment_inertia), name, 1e-13)
    assert inertia.analyse(inertia.read(path(name), unit="m")).area == pytest.approx(mesh.area, rel=1e-13)


@pytest.mark.parametrize("name", SAMPLES)
def test_trimesh_finds_the_same_principal_moments(name):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(*welded(name), process=False)
    properties = inertia.mass_properties(inertia.read(path(name), unit="m"), 1.0)
    np.testing.assert_allclose(
        np.sort(mesh.principal_inertia_components),
        properties.principal_moments,
        atol=1e-13 * properties.principal_moments[2],
    )


def test_trimesh_loses_far_from_the_origin_what_is_kept_here():
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = welded("t_handle.stl")
    vertices = np.round(vertices * 2**8) / 2**8 + [2.0**17, 0, 0]
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    near = inertia.mass_properties(inertia.Part.from_arrays(vertices - [2.0**17, 0, 0], faces), 1.0)
    far = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces), 1.0)
    np.testing.assert_allclose(far.inertia, near.inertia, atol=1e-14 * np.linalg.norm(near.inertia))
    off = np.linalg.norm(mesh.moment_inertia - near.inertia) / np.linalg.norm(near.inertia)
    assert 1e-9 < off < 1


@pytest.mark.parametrize("name", SAMPLES)
def test_vtk(name):
    pytest.importorskip("vtk")
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkMassProperties

    vertices, faces = welded(name)
    points, polygons, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(vertices, deep=True))
    polygons.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces.ravel()), deep=True))
    data.SetPoints(points)
    data.SetPolys(polygons)
    peer = vtkMassProperties()
    peer.SetInputData(data)
    peer.Update()
    result = inertia.analyse(inertia.read(path(name), unit="m"))
    assert peer.GetVolume() == pytest.approx(result.properties.volume, rel=1e-13)
    assert peer.GetSurfaceArea() == pytest.approx(result.area, rel=1e-13)


@pytest.mark.parametrize("name", ["t_handle.stl", "tetrahedron.stl", "bent_wheel.stl"])
def test_mujoco(name):
    mujoco = pytest.importorskip("mujoco")
    vertices, faces = welded(name)
    spec = mujoco.MjSpec()
    spec.compiler.balanceinertia = False
    mesh = spec.add_mesh(name="part", uservert=vertices.ravel() / 10, userface=faces.ravel())
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_EXACT
    body = spec.worldbody.add_body()
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="part", density=1.0)
    model = spec.compile()
    volume, com, tensor = ours(name)
    assert model.body_mass[1] == pytest.approx(volume / 1e3, rel=5e-7)
    np.testing.assert_allclose(model.body_ipos[1], com / 10, atol=1e-6)
    np.testing.assert_allclose(np.sort(model.body_inertia[1]), np.linalg.eigvalsh(tensor) / 1e5, rtol=1e-6)


@pytest.mark.parametrize("name", SAMPLES)
def test_libigl(name):
    igl = pytest.importorskip("igl")
    vertices, faces = welded(name)
    volume, first, second = igl.moments(vertices, faces)
    assert_near((volume, first / volume, second), name, 1e-13)
