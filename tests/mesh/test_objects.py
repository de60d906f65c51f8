"""Meshes of other libraries become parts, and come back, with the same coordinates and volume."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import trimesh
from manifold3d import Manifold

import inertia
from inertia_meshes import path

BOX = 24.0


def objects() -> dict[str, Any]:
    box = trimesh.creation.box((2, 3, 4))
    return {
        "trimesh": box,
        "scene": trimesh.Scene([box]),
        "meshio": meshio.Mesh(box.vertices, [("triangle", box.faces)]),
        "quads": meshio.Mesh(
            [[x, y, z] for z in (0, 4) for y in (0, 3) for x in (0, 2)],
            [("quad", [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])],
        ),
        "cells": meshio.Mesh(
            [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [0, 0, 4], [2, 0, 4], [2, 3, 4], [0, 3, 4]],
            [("hexahedron", [range(8)])],
        ),
        "manifold3d": Manifold.cube((2, 3, 4)),
    }


@pytest.mark.parametrize("name", objects())
def test_a_mesh_in_memory_is_read(name: str) -> None:
    part = inertia.read(objects()[name], unit="m")
    properties = inertia.mass_properties(part, 1.0)
    assert properties.volume == pytest.approx(BOX, rel=1e-15)
    assert sorted(properties.principal.moments) == pytest.approx([2.0 * 13, 2.0 * 20, 2.0 * 25], rel=1e-14)
    assert (part.unit.name, part.unit_from) == ("m", "option")
    assert inertia.read(objects()[name]).unit_from == "assumed"


def test_a_part_comes_back() -> None:
    part = inertia.read(path("t_handle.stl"))
    volume = inertia.mass_properties(part).volume
    for there in (part.to_trimesh(), part.to_meshio(), part.to_manifold()):
        again = inertia.read(there, unit="mm")
        assert inertia.mass_properties(again).volume == pytest.approx(volume, rel=1e-14)
    assert np.array_equal(inertia.read(part.to_meshio()).triangles.corners(), part.triangles.corners())


def test_cells_come_back(tmp_path: Path) -> None:
    part = inertia.read(path("two_region_bar.vtk"))
    again = inertia.read(part.to_meshio())
    assert again.geometry.count == part.geometry.count
    assert inertia.mass_properties(again).volume == inertia.mass_properties(part).volume
    with pytest.raises(inertia.GeometryError, match="mesh of cells"):
        part.to_manifold()


def test_an_open_surface_is_no_manifold() -> None:
    with pytest.raises(inertia.GeometryError, match="manifold3d does not take it"):
        inertia.read(path("broken/missing_face.stl")).to_manifold()


def test_pyvista_there_and_back() -> None:
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    part = inertia.read(pyvista.Cube(x_length=2, y_length=3, z_length=4), unit="m")
    assert inertia.mass_properties(part).volume == pytest.approx(BOX, rel=1e-6)  # its coordinates are float32
    assert inertia.mass_properties(inertia.read(part.to_pyvista(), unit="m")).volume == pytest.approx(BOX, rel=1e-6)
    with pytest.raises(inertia.UsageError, match="is no surface"):
        inertia.read(pyvista.ImageData(dimensions=(2, 2, 2)))


def test_anything_else_is_refused_in_a_sentence() -> None:
    with pytest.raises(
        inertia.UsageError, match=r"^ndarray is neither file, mesh nor solid: give a path, or an object of trim"
    ):
        inertia.read(np.zeros((3, 3)))
    with pytest.raises(inertia.UsageError, match="a CellBlock is no mesh"):
        inertia.read(meshio.CellBlock("triangle", np.array([[0, 1, 2]])))
