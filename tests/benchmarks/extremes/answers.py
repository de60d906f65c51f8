"""What other programs answer for a closed mesh: volume, centre of mass and tensor for unit density.

A program that is not installed or raises, or whose answer is no number, is quoted by a word.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import peers
from ..meshes import Faces, Vertices

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Answer:
    """Volume, centre of mass (3,), tensor (3, 3) about it; principal moments (3,) ascending and axes (columns)."""

    volume: float
    center: Array | None = None
    inertia: Array | None = None
    moments: Array | None = None
    axes: Array | None = None


def answered(program: Callable[[Vertices, Faces], Answer], vertices: Vertices, faces: Faces) -> Answer | str:
    """Return a program's answer, or the word for why there is none."""
    with warnings.catch_warnings(), np.errstate(all="ignore"), redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        with redirect_stderr(io.StringIO()):
            try:
                result = program(vertices, faces)
            except ImportError:
                return "–"
            except (ArithmeticError, RuntimeError, ValueError, np.linalg.LinAlgError):
                return "throws"
    numbers = [result.volume, *(x for k in (result.center, result.inertia) if k is not None for x in k.flat)]
    return result if np.isfinite(numbers).all() else "not finite"


def trimesh(vertices: Vertices, faces: Faces) -> Answer:
    """A `Trimesh` object as it comes, without merging vertices."""
    from trimesh import Trimesh

    mesh = Trimesh(vertices, faces, process=False)
    return _diagonalised(float(mesh.volume), mesh.center_mass, mesh.moment_inertia)


def libigl(vertices: Vertices, faces: Faces) -> Answer:
    """`igl.moments`, which gives the first moments and the tensor about the centre."""
    import igl

    volume, first, tensor = igl.moments(vertices, faces)
    return _diagonalised(float(volume), first / volume, tensor)


def drake(vertices: Vertices, faces: Faces) -> Answer:
    """`CalcSpatialInertia` of a `TriangleSurfaceMesh`, which refuses what is not physical."""
    from pydrake.geometry import SurfaceTriangle, TriangleSurfaceMesh
    from pydrake.multibody.tree import CalcSpatialInertia

    mesh = TriangleSurfaceMesh([SurfaceTriangle(*face) for face in faces.tolist()], list(vertices))
    result = CalcSpatialInertia(mesh=mesh, density=1.0)
    center = result.get_com()
    return _diagonalised(result.get_mass(), center, result.Shift(center).CalcRotationalInertia().CopyToFullMatrix3())


def mujoco(vertices: Vertices, faces: Faces) -> Answer:
    """A free body compiled with ``inertia="exact"``; MuJoCo keeps coordinates in float32."""
    import mujoco

    spec = mujoco.MjSpec()
    mesh = spec.add_mesh(name="part", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_EXACT)
    mesh.uservert, mesh.userface = vertices.ravel(), faces.ravel()
    body = spec.worldbody.add_body()
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="part", density=1.0, contype=0, conaffinity=0)
    model = spec.compile()
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.body_iquat[1])
    axes, moments = rotation.reshape(3, 3), model.body_inertia[1]
    order = np.argsort(moments)
    tensor = axes @ np.diag(moments) @ axes.T
    return Answer(float(model.body_mass[1]), model.body_ipos[1], tensor, moments[order], axes[:, order])


def vtk(vertices: Vertices, faces: Faces) -> Answer:
    """`vtkMassProperties`, which gives no more than the volume."""
    from vtkmodules.vtkCommonCore import vtkObject

    vtkObject.GlobalWarningDisplayOff()
    return Answer(peers.vtk(vertices, faces)())


def _diagonalised(volume: float, center: Array, inertia: Array) -> Answer:
    """Add what a user of the program would get from `numpy.linalg.eigh`."""
    if not np.isfinite(inertia).all():
        return Answer(volume, center, inertia)
    moments, axes = np.linalg.eigh(inertia)
    return Answer(volume, center, inertia, moments, axes)


PROGRAMS: dict[str, Callable[[Vertices, Faces], Answer]] = {
    "trimesh": trimesh,
    "libigl": libigl,
    "Drake": drake,
    "MuJoCo": mujoco,
    "VTK": vtk,
}
