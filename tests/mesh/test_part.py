"""Parts to and from trimesh: the same numbers, unit and regions both ways."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.mesh.readers.samples import CORNERS, TRIANGLES, binary_stl, dae, text_stl

from inertia.errors import GeometryError, UsageError
from inertia.mesh.part import Part
from inertia.mesh.read import read
from inertia_meshes import path

OFFSET = CORNERS / 3 + 10_000


@pytest.mark.parametrize(
    "unit",
    ["m", "dm", "cm", "mm", "um", "nm", "km", "in", "mil", "ft", "yd"],
)
def test_a_part_survives_the_way_through_trimesh(unit: str) -> None:
    part = Part.from_arrays(OFFSET, TRIANGLES, unit)
    mesh = part.to_trimesh()
    assert trimesh.units.to_inch(mesh.units) == pytest.approx(float(part.unit.metres) / 0.0254, rel=1e-15)
    back = Part.from_trimesh(mesh)
    assert np.array_equal(back.geometry.vertices, OFFSET)
    assert np.array_equal(back.geometry.faces, TRIANGLES)
    assert (back.unit, back.unit_from, back.source.format) == (part.unit, "file", "trimesh")


def test_the_unit_that_is_given_counts_before_the_meshs_own() -> None:
    mesh = trimesh.Trimesh(CORNERS, TRIANGLES, process=False)
    assert (Part.from_trimesh(mesh).unit.name, Part.from_trimesh(mesh).unit_from) == ("mm", "assumed")
    mesh.units = "inches"
    assert (Part.from_trimesh(mesh).unit.name, Part.from_trimesh(mesh).unit_from) == ("in", "file")
    assert (Part.from_trimesh(mesh, "m").unit.name, Part.from_trimesh(mesh, "m").unit_from) == ("m", "option")
    mesh.units = "0.3 * meters"
    assert Part.from_trimesh(mesh).unit.metres == Fraction(3, 10)
    mesh.units = "parsecs"
    with pytest.raises(UsageError, match="unknown unit 'parsecs'"):
        Part.from_trimesh(mesh)


def test_an_assumed_unit_is_not_stated_and_one_without_a_name_is(tmp_path: Path) -> None:
    (tmp_path / "box.stl").write_bytes(binary_stl())
    mesh = read(tmp_path / "box.stl").to_trimesh()
    assert mesh.units is None
    assert np.array_equal(mesh.triangles, CORNERS.astype(np.float32)[TRIANGLES])
    (tmp_path / "box.dae").write_text(dae(unit='<unit meter="0.3"/>'))
    part = read(tmp_path / "box.dae")
    assert part.to_trimesh().units == "0.3 * m"
    assert Part.from_trimesh(part.to_trimesh()).unit.metres == Fraction(3, 10)


def test_regions_are_attributes_of_the_faces(tmp_path: Path) -> None:
    (tmp_path / "two.stl").write_text(text_stl("right") + text_stl("left"))
    mesh = read(tmp_path / "two.stl").to_trimesh()
    assert mesh.face_attributes["region"].tolist() == ["right"] * 12 + ["left"] * 12
    back = Part.from_trimesh(mesh).regions
    assert back is not None
    assert [back.names[i] for i in back.index] == ["right"] * 12 + ["left"] * 12


def test_neither_side_sees_what_the_other_changes_later() -> None:
    corners, triangles = np.array(CORNERS, float), np.array(TRIANGLES, np.int64)
    part = Part.from_arrays(corners, triangles)
    corners *= 2
    triangles[:] = triangles[:, ::-1]
    assert np.array_equal(part.geometry.faces, TRIANGLES)
    mesh = part.to_trimesh()
    back = Part.from_trimesh(mesh)
    mesh.apply_scale(2.0)
    assert np.array_equal(part.geometry.vertices, CORNERS)
    assert np.array_equal(back.geometry.vertices, CORNERS)


def test_what_has_no_surface_is_refused() -> None:
    with pytest.raises(UsageError, match=r"a Scene is no trimesh\.Trimesh: of a scene, give scene\.to_mesh\(\)"):
        Part.from_trimesh(trimesh.Scene())
    with pytest.raises(GeometryError, match="is a mesh of cells"):
        read(path("two_region_bar.vtk")).to_trimesh()


@pytest.mark.parametrize(
    ("vertices", "faces", "said"),
    [
        (CORNERS, TRIANGLES + 0.5, "faces hold 0.5, which is no number of a vertex: give whole numbers"),
        (CORNERS, np.where(TRIANGLES == 3, np.nan, TRIANGLES), "faces hold nan, which is no number"),
        (CORNERS + 1j, TRIANGLES, "vertices must be an array of real numbers"),
        (CORNERS, None, "faces must be an array of whole numbers"),
        ([[0, 0, 0], [1]], TRIANGLES, "vertices must be an array of real numbers"),
        ("none", TRIANGLES, "vertices must be an array of real numbers"),
    ],
)
def test_what_are_no_vertices_or_faces_is_refused(vertices: object, faces: object, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        Part.from_arrays(vertices, faces)  # type: ignore[arg-type]


def test_whole_numbers_are_faces_whatever_their_type() -> None:
    for kind in (np.int8, np.uint64, np.float32, object):
        faces = TRIANGLES.astype(kind) if kind is not object else TRIANGLES.tolist()
        assert np.array_equal(Part.from_arrays(CORNERS, faces).triangles.faces, TRIANGLES)  # type: ignore[union-attr]
    with pytest.raises(GeometryError, match="names vertex 9223372036854775807, but the vertices are 0 to"):
        Part.from_arrays(CORNERS, TRIANGLES.astype(np.uint64) + np.uint64(2**63))


def test_masked_numbers_are_no_coordinates() -> None:
    """Whose values numpy keeps beneath the mask."""
    vertices, faces = np.ma.array(np.eye(4)[:, :3], mask=np.arange(12).reshape(4, 3) == 7), [[0, 2, 1]]
    with pytest.raises(UsageError, match=r"vertices: row 2 has masked numbers: leave out what is masked"):
        Part.from_arrays(vertices, faces)
    with pytest.raises(UsageError, match="faces: row 0 has masked numbers"):
        Part.from_arrays(np.eye(3), np.ma.array(faces, mask=[[False, True, False]]))
    assert Part.from_arrays(np.ma.array(np.eye(3)), faces).triangles.count == 1


@pytest.mark.parametrize(
    ("vertices", "words"), [(1.0, r"not \(\)"), (np.empty((0, 3)), "vertex 0, but there are none")]
)
def test_a_number_or_nothing_for_vertices_is_named_as_it_is(vertices: object, words: str) -> None:
    with pytest.raises((UsageError, GeometryError), match=words):
        Part.from_arrays(vertices, [[0, 2, 1]])  # type: ignore[arg-type]
