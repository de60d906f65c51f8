"""XAML: meshes and the matrices of their visuals, whose corners are known from the numbers that were written."""

from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import CORNERS, TRIANGLES, visual_xaml, words, xaml

from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.mesh.read import read

BOX = CORNERS[TRIANGLES]
TURNED = "0 1 0 0 -1 0 0 0 0 0 1 0 7 8 9 1"
"""Rows: x becomes y, y becomes −x; then 7, 8, 9."""
TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def read_xaml(folder: Path, text: str) -> Part:
    path = folder / "box.xaml"
    path.write_text(text)
    return read(path)


def test_visuals_are_placed_one_within_the_other(tmp_path: Path) -> None:
    inner = visual_xaml(matrix=TURNED.replace(" ", ","))
    outer = inner.replace("<ModelVisual3D>", f"<ModelVisual3D>{visual_xaml(CORNERS + 20)}", 1)
    part = read_xaml(tmp_path, xaml(outer + visual_xaml(CORNERS + 40)))
    boxes = [(CORNERS + 20) @ TURN.T + [7, 8, 9], CORNERS @ TURN.T + [7, 8, 9], CORNERS + 40]
    assert np.array_equal(part.triangles.corners(), np.concatenate([box[TRIANGLES] for box in boxes]))
    assert (part.unit.name, part.unit_from) == ("mm", "assumed")


def test_normals_and_materials_are_left_aside(tmp_path: Path) -> None:
    material = (
        '<GeometryModel3D.Material><DiffuseMaterial Brush="{StaticResource none}"/></GeometryModel3D.Material>'
        "</GeometryModel3D>"
    )
    text = xaml().replace(' Normals=""', "").replace("</GeometryModel3D>", material)
    assert np.array_equal(read_xaml(tmp_path, text).triangles.corners(), BOX)


def test_points_without_indices_are_corners_in_turn(tmp_path: Path) -> None:
    text = visual_xaml(BOX.reshape(-1, 3), np.arange(36)).replace(f'TriangleIndices="{words(np.arange(36))}"', "")
    assert np.array_equal(read_xaml(tmp_path, xaml(text)).triangles.corners(), BOX)


def test_a_dictionary_that_holds_one_model_is_that_model(tmp_path: Path) -> None:
    text = xaml(MODEL).replace("Viewport3D", "ResourceDictionary")
    assert np.array_equal(read_xaml(tmp_path, text).triangles.corners(), BOX)


def test_what_visibility_hides_counts_with_a_note(tmp_path: Path) -> None:
    part = read_xaml(tmp_path, xaml(MESH + MESH).replace("<Viewport3D ", '<Viewport3D Visibility="Collapsed" '))
    assert part.notes == ("2 models that Visibility hides were counted",)
    assert part.triangles.count == 24


MESH = visual_xaml()
PLACED = visual_xaml(matrix=TURNED)
ROTATION = """<GeometryModel3D><GeometryModel3D.Transform><RotateTransform3D><RotateTransform3D.Rotation>
<AxisAngleRotation3D Axis="0,3,0" Angle="40"/></RotateTransform3D.Rotation></RotateTransform3D>
</GeometryModel3D.Transform>"""
MODEL = MESH.removeprefix("<ModelVisual3D><ModelVisual3D.Content>").removesuffix(
    "</ModelVisual3D.Content></ModelVisual3D>"
)
KEPT = f"<Viewport3D.Resources>{MODEL}</Viewport3D.Resources>"
REFERENCE = '<ModelVisual3D.Content><StaticResource ResourceKey="box"/></ModelVisual3D.Content>'
BAD = {
    "a model that nothing shows": (KEPT, "keeps a mesh as a resource"),
    "a mesh in a dictionary": (f"<ResourceDictionary>{MODEL}</ResourceDictionary>" + MESH, "keeps a mesh as a res"),
    "a model in a template": (f"<Control.Template>{MODEL}</Control.Template>" + MESH, "keeps a mesh as a resource"),
    "a model by its key": ('<ModelVisual3D Content="{StaticResource box}"/>' + MESH, "its ModelVisual3D refers to a"),
    "an element by its key": (f"<ModelVisual3D>{REFERENCE}</ModelVisual3D>" + MESH, "its ModelVisual3D.Content refers"),
    "a binding of a group": ('<ModelVisual3D.Content><Model3DGroup Children="{Binding a}"/></ModelVisual3D.Content>'
        + MESH, "its Model3DGroup refers to a resource"),
    "a shape of a toolkit": (f'<BoxVisual3D Width="2"/>{MESH}', "its BoxVisual3D is not read"),
    "points of their own": (MESH.replace("/></GeometryModel3D.Geo", "><MeshGeometry3D.Positions/></MeshGeometry3D>"
        "</GeometryModel3D.Geo"), "its MeshGeometry3D.Positions is not read"),
    "a rotation of the model": (MESH.replace("<GeometryModel3D>", ROTATION), "GeometryModel3D.Transform is not read"),
    "a scale": (PLACED.replace(f'<MatrixTransform3D Matrix="{TURNED}"/>', '<ScaleTransform3D ScaleX="2"/>'),
        "ModelVisual3D.Transform is not read"),
    "two matrices": (PLACED.replace("<MatrixT", f'<MatrixTransform3D Matrix="{TURNED}"/><MatrixT'), "is not read"),
    "a resource": (MESH.replace("<ModelVisual3D>", '<ModelVisual3D Transform="{Binding a}">'), "Transform of its"),
    "a mesh elsewhere": (MESH.replace("GeometryModel3D>", "Visual>"), "no GeometryModel3D shows"),
    "no mesh": ('<GeometryModel3D Geometry="{StaticResource a}"/>' + MESH, "no mesh of its own"),
    "a mirror": (PLACED.replace(TURNED, "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), "mirrors"),
    "a projection": (PLACED.replace(TURNED, "1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1"), "not sixteen numbers"),
    "fifteen numbers": (PLACED.replace(TURNED, TURNED[:-2]), "not sixteen numbers"),
    "half a point": (MESH.replace('Positions="0.1,', 'Positions="'), "23 numbers"),
    "half a triangle": (MESH.replace('Indices="0 1 3', 'Indices="0 1'), "35 numbers"),
    "no indices": (MESH.replace("TriangleIndices", "Indices"), "8 points without TriangleIndices"),
    "beyond": (MESH.replace('Indices="0 1 3', 'Indices="0 1 8'), "names vertex 8"),
    "not a number": (MESH.replace('Positions="0.1', 'Positions="nan'), "not finite"),
    "nothing": ("", "no triangle mesh"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_would_be_misread_is_refused(case: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    visuals, reason = BAD[case]
    with pytest.raises(ReadError, match=reason):
        read_xaml(tmp_path, xaml(visuals))
    assert capfd.readouterr() == ("", "")
