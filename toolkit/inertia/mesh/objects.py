"""Meshes and solids of other libraries, in memory, as parts.

Meshes are those of trimesh, meshio, manifold3d and PyVista, solids those of cadquery and build123d.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from inertia.errors import UsageError
from inertia.mesh.part import Cells, Part, Source
from inertia.mesh.surface import Facets, Surface
from inertia.units import DEFAULT_UNIT, length_unit


def part_of(mesh: Any, unit: str | None = None) -> Part:
    """Return a mesh or solid of another library as a part: the same coordinates, faces or cells, or the true shape.

    Parameters
    ----------
    mesh : a `trimesh.Trimesh` or its scene, a `meshio.Mesh`, a `manifold3d.Manifold`, a `pyvista.PolyData`; a shape,
        workplane, builder or assembly of cadquery or build123d, or a `TopoDS_Shape` of OCP, which both are made of
    unit : of its coordinates; without it, what a trimesh states, else millimetres are assumed

    Raises `UsageError` for anything else.
    """
    library = next((kind.__module__.partition(".")[0] for kind in type(mesh).__mro__ if _known(kind)), "")
    if not library:
        raise UsageError(
            f"{type(mesh).__name__} is neither file, mesh nor solid: give a path, or an object of {', '.join(_READERS)}"
        )
    return _READERS[library](mesh, unit)


def _known(kind: type) -> bool:
    return kind.__module__.partition(".")[0] in _READERS


def _from_trimesh(mesh: Any, unit: str | None) -> Part:
    return Part.from_trimesh(mesh.to_mesh() if hasattr(mesh, "to_mesh") else mesh, unit)


def _from_meshio(mesh: Any, unit: str | None) -> Part:
    if not hasattr(mesh, "cells") or not hasattr(mesh, "points"):
        raise UsageError(f"a {type(mesh).__name__} is no mesh: give the meshio.Mesh that it belongs to")
    from inertia.mesh.readers.meshio import contents_of

    contents = contents_of(mesh)
    return _part(contents.geometry, unit, "meshio", regions=contents.regions, notes=contents.notes)


def _from_manifold(mesh: Any, unit: str | None) -> Part:
    if not hasattr(mesh, "to_mesh64"):
        raise UsageError(f"a {type(mesh).__name__} is no solid: give a manifold3d.Manifold")
    of = mesh.to_mesh64()
    vertices = np.array(of.vert_properties[:, :3], np.float64)
    return _part(Surface(vertices, np.array(of.tri_verts, np.int64)), unit, "manifold3d")


def _from_pyvista(mesh: Any, unit: str | None) -> Part:
    if not hasattr(mesh, "triangulate") or not hasattr(mesh, "strips"):
        raise UsageError(f"a {type(mesh).__name__} is no surface: give its extract_surface(), or save it and read that")
    faces = np.asarray(mesh.triangulate().faces).reshape(-1, 4)[:, 1:]
    return _part(Surface(np.array(mesh.points, np.float64), faces.astype(np.int64)), unit, "pyvista")


def _from_model(model: Any, unit: str | None) -> Part:
    from inertia.mesh.readers.step import model_contents

    library = type(model).__module__.partition(".")[0]
    of = model_contents(model, DEFAULT_UNIT.name if unit is None else length_unit(unit).name)
    return _part(of.geometry, unit, library, regions=of.regions, notes=of.notes, chord=of.chord, shape=of.shape)


def _part(geometry: Facets | Surface | Cells, unit: str | None, library: str, **more: Any) -> Part:
    size = DEFAULT_UNIT if unit is None else length_unit(unit)
    return Part(geometry, size, "assumed" if unit is None else "option", Source(None, library), **more)


_READERS: dict[str, Callable[[Any, str | None], Part]] = {
    "trimesh": _from_trimesh,
    "meshio": _from_meshio,
    "manifold3d": _from_manifold,
    "pyvista": _from_pyvista,
    "cadquery": _from_model,
    "build123d": _from_model,
    "OCP": _from_model,
}
