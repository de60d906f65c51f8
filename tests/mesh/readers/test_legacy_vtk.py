"""Attributes of legacy VTK, as VTK writes them before the regions of two bricks, and as text by hand."""

import itertools
from pathlib import Path

import pytest
from tests.mesh.readers.samples import VTK_TEXT, names_of, read_text

from inertia import mass_properties
from inertia.errors import ReadError
from inertia.mesh.read import read

KINDS = (
    *("Bit", "Char", "SignedChar", "UnsignedChar", "Short", "UnsignedShort", "Int", "UnsignedInt", "LongLong"),
    *("UnsignedLongLong", "IdType", "Float", "Double", "String", "Variant"),
)
ROLES = (
    *(("Double", role) for role in ("Scalars", "Normals", "TCoords", "GlobalIds", "PedigreeIds", "Tensors")),
    *(("UnsignedChar", "Scalars"), ("Bit", "Scalars"), ("IdType", "GlobalIds"), ("String", "PedigreeIds")),
)


def by_vtk(path: Path, version: int, binary: bool, kind: str, role: str | None = None) -> None:
    """Two bricks of 2 × 3 × 4, of regions 7 and 8, whose cells and points have an array of a kind."""
    core, model = (pytest.importorskip(f"vtkmodules.vtkCommon{name}") for name in ("Core", "DataModel"))
    legacy = pytest.importorskip("vtkmodules.vtkIOLegacy")
    grid, points, regions = model.vtkUnstructuredGrid(), core.vtkPoints(), core.vtkIntArray()
    for x, z, (a, b) in itertools.product((0, 10), (0, 4), ((0, 0), (2, 0), (2, 3), (0, 3))):
        points.InsertNextPoint(x + a, b, z)
    grid.SetPoints(points)
    if kind == "Double":
        points.GetData().SetComponentName(1, "y")
        points.GetData().GetRange(-1)  # which is written, too
    for k in (0, 8):
        grid.InsertNextCell(12, 8, [*range(k, k + 8)])
    regions.SetName("region")
    for k, data in enumerate((grid.GetCellData(), grid.GetPointData())):
        array = getattr(core, f"vtk{kind}Array")()
        array.SetName("extra one")
        array.SetNumberOfComponents(
            {"Normals": 3, "TCoords": 2, "Tensors": 6, "Scalars": 1 if kind == "Bit" else 9}.get(role or "", 1)
        )
        array.SetNumberOfTuples(16 if k else 2)
        for i in range(array.GetNumberOfValues()):
            array.SetValue(i, {"String": "é b" * 40 * i, "Char": "1", "Variant": core.vtkVariant(i)}.get(kind, i % 2))
        getattr(data, f"Set{role}")(array) if role else data.AddArray(array)
    for k in (7, 8):
        regions.InsertNextValue(k)
    grid.GetCellData().AddArray(regions)
    writer = legacy.vtkUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileVersion(version)
    (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
    writer.SetFileName(str(path))
    writer.Write()


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize(("kind", "role"), [*((kind, None) for kind in KINDS), *ROLES])
def test_regions_behind_other_data_are_read(
    kind: str, role: str | None, binary: bool, version: int, tmp_path: Path
) -> None:
    by_vtk(tmp_path / "a.vtk", version, binary, kind, role)
    part = read(tmp_path / "a.vtk", unit="m")
    assert names_of(part) == ["7", "8"]
    properties = mass_properties(part, 1.0)
    assert properties.mass == pytest.approx(48, rel=1e-15)
    assert properties.center_of_mass == pytest.approx([6, 1.5, 2], rel=1e-15)


OF_CELLS = "CELL_DATA 2\n{}SCALARS material int 1\nLOOKUP_TABLE default\n7 8\n"


@pytest.mark.parametrize(
    "data",
    [
        "NORMALS n float\n0 0 1 0 0 1\n",
        "TEXTURE_COORDINATES t 2 float\n0 0 1 1\n",
        "COLOR_SCALARS c 3\n0.5 0 1 0.25 0 1\n",
        "LOOKUP_TABLE t 3\n0 0 0 1 0.5 0.5 0.5 1 1 1 1 1\n",
        "EDGE_FLAGS e int\n0 1\n",
        "SCALARS s int 5\nLOOKUP_TABLE default\n1 2 3 4 5\n6 7 8 9 0\n",
        "FIELD f 2\nu 3 2 int\n1 2 3 4 5 6\nMETADATA\nCOMPONENT_NAMES\n\nv\n\n\nother 1 2 int\n1 2\n",
        "FIELD f 2\nnames 1 2 string\none%20two\n\nother 2 2 int\n1 2 3 4\n",
    ],
)
def test_data_before_the_regions_are_passed_over(data: str, tmp_path: Path) -> None:
    text = VTK_TEXT[: VTK_TEXT.index("CELL_DATA")] + OF_CELLS.format(data)
    assert names_of(read_text(tmp_path, "a.vtk", text)) == ["7", "8"]


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ("NORMALS n float\n0 0 1 0\n", "fewer numbers than it"),
        ("NORMALS n decimal\n0 0 1 0 0 1\n", "of the type 'decimal', which is not read"),
        (f"LOOKUP_TABLE t {10**17}\n", "ends within one of its attributes"),
        (f"FIELD f 1\nnames 1 {10**17} string\n", "ends within one of its attributes"),
    ],
)
def test_data_that_are_not_whole_are_refused(data: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=reason):
        read_text(tmp_path, "a.vtk", VTK_TEXT[: VTK_TEXT.index("CELL_DATA")] + OF_CELLS.format(data))
