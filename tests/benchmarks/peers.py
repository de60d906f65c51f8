"""One function a library: take a mesh in memory, return a call that integrates it and gives its volume.

What a library needs to have before it can begin (its own arrays, its own mesh object) is made outside the call.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mass.triangles.moments_from_sums import moments_of
from inertia.mass.triangles.sums import frame_of, sum_in
from inertia.mesh.surface import Facets, Surface, Triangles

from .meshes import Faces, Vertices, facets

Integrate = Callable[[], float]


def _ours(triangles: Triangles) -> Integrate:
    return lambda: float(solid_moments(triangles, "float64").zeroth)


def inertia_faces(vertices: Vertices, faces: Faces) -> Integrate:
    """Shared vertices, compiled kernel."""
    return _ours(Surface(vertices, faces))


def inertia_sums(vertices: Vertices, faces: Faces) -> Integrate:
    """Shared vertices, compiled kernel; without the digits that make the bounds of large meshes narrow."""
    triangles = Surface(vertices, faces)
    return lambda: float(moments_of(sum_in(replace(frame_of(triangles), grid=None), triangles)).zeroth)


def inertia_facets(vertices: Vertices, faces: Faces) -> Integrate:
    """Binary STL records, compiled kernel."""
    return _ours(Facets(facets(vertices, faces)))


def inertia_numpy(vertices: Vertices, faces: Faces) -> Integrate:
    """Shared vertices, without compiled kernels."""
    integrate = _ours(Surface(vertices, faces))

    def call() -> float:
        os.environ["INERTIA_NATIVE"] = "0"
        try:
            return integrate()
        finally:
            del os.environ["INERTIA_NATIVE"]

    return call


def libigl(vertices: Vertices, faces: Faces) -> Integrate:
    """`igl.moments`: volume, first and second moments."""
    import igl

    return lambda: float(igl.moments(vertices, faces)[0])


def trimesh(vertices: Vertices, faces: Faces) -> Integrate:
    """`trimesh.triangles.mass_properties`: volume, centre of mass, tensor."""
    from trimesh.triangles import mass_properties

    corners = vertices[faces]
    return lambda: float(mass_properties(corners).volume)


def vtk(vertices: Vertices, faces: Faces) -> Integrate:
    """`vtkMassProperties`: volume and area."""
    from vtkmodules.vtkFiltersCore import vtkMassProperties

    measure = vtkMassProperties()
    measure.SetInputData(_poly_data(vertices, faces))

    def call() -> float:
        measure.Modified()
        measure.Update()
        return float(measure.GetVolume())

    return call


def vtk_objects(vertices: Vertices, faces: Faces) -> Integrate:
    """`vtkMultiObjectMassProperties`: volume, area and centroid of each body, and whether it is closed."""
    from vtkmodules.vtkFiltersCore import vtkMultiObjectMassProperties

    measure = vtkMultiObjectMassProperties()
    measure.SetInputData(_poly_data(vertices, faces))

    def call() -> float:
        measure.Modified()
        measure.Update()
        return float(measure.GetTotalVolume())

    return call


def mujoco(vertices: Vertices, faces: Faces) -> Integrate:
    """Compile a model of one free body: volume, centre of mass and tensor, and what drawing the mesh needs."""
    import mujoco

    spec = mujoco.MjSpec()
    mesh = spec.add_mesh(name="part", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_EXACT)
    mesh.uservert, mesh.userface = vertices.ravel(), faces.ravel()
    body = spec.worldbody.add_body()
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="part", density=1.0, contype=0, conaffinity=0)
    return lambda: float(spec.compile().body_mass[1])


def _poly_data(vertices: Vertices, faces: Faces) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    points, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(vertices))
    cells.SetData(3, numpy_to_vtkIdTypeArray(faces.ravel()))
    data.SetPoints(points)
    data.SetPolys(cells)
    return data
