"""VTU: two bricks of regions 7 and 8 whose data are appended as raw bytes, by hand and by VTK, among other arrays."""

import itertools
import zlib
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import names_of

from inertia import mass_properties
from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.mesh.read import read

TYPES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt8": "u1", "Bit": "u1", "String": "i1"}
Arrays = dict[str, list[tuple[str, str, int, np.ndarray]]]
BRICK = ((0, 0), (2, 0), (2, 3), (0, 3))
POINTS = [(x + a, b, z) for x, z, (a, b) in itertools.product((0, 10), (0, 4), BRICK)]


def require_bricks(part: Part) -> None:
    """Require two bricks of 2 × 3 × 4, 10 apart, of which one is three times as dense."""
    assert names_of(part) == ["7", "8"]
    properties = mass_properties(part, {"7": 1.0, "8": 3.0})
    assert properties.mass == pytest.approx(96, rel=1e-15)
    assert properties.center_of_mass == pytest.approx([8.5, 1.5, 2], rel=1e-15)


def bricks(places: str = "Float64", whole: str = "Int64") -> Arrays:
    """Return the arrays of the bricks: element → name, type, width and numbers of each in it."""
    return {
        "FieldData": [],
        "PointData": [],
        "CellData": [("region", "Int32", 1, np.array([7, 8]))],
        "Points": [("Points", places, 3, np.array(POINTS))],
        "Cells": [
            ("connectivity", whole, 1, np.arange(16)),
            ("offsets", whole, 1, np.array([8, 16])),
            ("types", "UInt8", 1, np.array([12, 12])),
        ],
    }


def among_others(rng: np.random.Generator) -> Arrays:
    """Return the arrays of the bricks, and some of any type, width and length."""
    arrays = bricks(str(rng.choice(["Float64", "Float32"])), str(rng.choice(["Int64", "Int32"])))
    for name, count in (("FieldData", None), ("PointData", 16), ("CellData", 2)):
        for k in range(rng.integers(0, 4)):
            width = int(rng.integers(1, 10))
            size = width * int(rng.integers(0, 40) if count is None else count)
            other = (f"other{k}", str(rng.choice([*TYPES])), width, rng.integers(0, 2, size))
            arrays[name].insert(rng.integers(len(arrays[name]) + 1), other)
    return arrays


def raw_vtu(
    arrays: Arrays, header: str, order: str, packed: bool, quote: str, end: str, rng: np.random.Generator | None = None
) -> bytes:
    """Return arrays as VTU: their blocks, of any size where they are packed, are in any order, as `rng` draws them."""
    head = np.dtype(order + {"UInt32": "u4", "UInt64": "u8"}[header])
    blocks = dict[tuple[str, int], tuple[int, bytes]]()
    appended = b""
    keys = [(name, k) for name in arrays for k in range(len(arrays[name]))]
    for name, k in keys if rng is None else [keys[i] for i in rng.permutation(len(keys))]:
        data = arrays[name][k][3].astype(order + TYPES[arrays[name][k][1]]).tobytes()
        if packed:
            size = 8 * (5 if rng is None else int(rng.integers(1, 12)))
            parts = [zlib.compress(data[i : i + size]) for i in range(0, len(data), size)]
            words = [len(parts), size, len(data) % size, *map(len, parts)]
            block = np.array(words, head).tobytes() + b"".join(parts)
        else:
            block = np.array([len(data)], head).tobytes() + data
        blocks[name, k] = len(appended), block
        appended += block

    def element(name: str) -> str:
        rows = "".join(
            f"<{'Array' if kind == 'String' else 'DataArray'} type='{kind}' Name='{label}' "
            f"NumberOfComponents='{width}' format='appended' offset='{blocks[name, k][0]}'/>\n"
            for k, (label, kind, width, _) in enumerate(arrays[name])
        )
        return f"<{name}>\n{rows}</{name}>\n"

    compressor = " compressor='vtkZLibDataCompressor'" if packed else ""
    text = (
        f"<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid' version='1.0' header_type='{header}'{compressor} "
        f"byte_order='{'Little' if order == '<' else 'Big'}Endian'>\n<UnstructuredGrid>\n{element('FieldData')}"
        f"<Piece NumberOfPoints='16' NumberOfCells='2'>\n"
        f"{''.join(map(element, ('PointData', 'CellData', 'Points', 'Cells')))}"
        "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding='raw'>\n _"
    )
    return text.replace("'", quote).encode() + appended + f"{end}</AppendedData>\n</VTKFile>\n".encode()


@pytest.mark.parametrize("quote", ["'", '"'])
@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("header", ["UInt32", "UInt64"])
def test_raw_appended_arrays_are_those_of_their_offsets(
    header: str, order: str, packed: bool, quote: str, tmp_path: Path
) -> None:
    rng = np.random.default_rng([*header.encode(), ord(order), packed, ord(quote)])
    for k in range(6):
        end = ("", "\n", "\n  ")[k % 3]
        (tmp_path / "a.vtu").write_bytes(raw_vtu(among_others(rng), header, order, packed, quote, end, rng))
        require_bricks(read(tmp_path / "a.vtu", unit="m"))


def test_an_array_at_the_offset_that_another_has_in_base64_is_itself(tmp_path: Path) -> None:
    """The field's 48 bytes are 64 characters of base64, and the array behind the regions begins at byte 64."""
    arrays = bricks()
    arrays["FieldData"] = [("field", "Float64", 1, np.zeros(5))]
    arrays["CellData"] = [arrays["CellData"][0], ("other", "Int32", 1, np.array([1, 1]))]
    order = ("FieldData", "CellData", "PointData", "Points", "Cells")
    data = raw_vtu({name: arrays[name] for name in order}, "UInt64", "<", False, '"', "\n")
    assert b'Name="other" NumberOfComponents="1" format="appended" offset="64"' in data
    (tmp_path / "a.vtu").write_bytes(data)
    require_bricks(read(tmp_path / "a.vtu", unit="m"))


@pytest.mark.parametrize("compressor", ["None", "ZLib"])
@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended", "raw"])
@pytest.mark.parametrize("kind", ["Bit", "String", "Variant", "Double"])
def test_arrays_without_numbers_are_passed_over(kind: str, mode: str, compressor: str, tmp_path: Path) -> None:
    core, model = (pytest.importorskip(f"vtkmodules.vtkCommon{name}") for name in ("Core", "DataModel"))
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    grid, points, regions = model.vtkUnstructuredGrid(), core.vtkPoints(), core.vtkIntArray()
    for point in POINTS:
        points.InsertNextPoint(*point)
    grid.SetPoints(points)
    for k in (0, 8):
        grid.InsertNextCell(12, 8, [*range(k, k + 8)])
        regions.InsertNextValue(7 + k // 8)
    regions.SetName("region")
    for data, size in ((grid.GetCellData(), 2), (grid.GetPointData(), 16), (grid.GetFieldData(), 3)):
        array = getattr(core, f"vtk{kind}Array")()
        array.SetName("extra")
        array.SetNumberOfTuples(size)
        for i in range(size):
            array.SetValue(i, {"String": "é" * i, "Variant": core.vtkVariant(i)}.get(kind, i % 2))
        data.AddArray(array)
    grid.GetCellData().AddArray(regions)
    writer = xml.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    getattr(writer, f"SetDataModeTo{mode.replace('raw', 'Appended')}")()
    writer.SetEncodeAppendedData(mode != "raw")
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.SetFileName(str(tmp_path / "a.vtu"))
    writer.Write()
    require_bricks(read(tmp_path / "a.vtu", unit="m"))


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (b"</AppendedData>", b"", "its appended data have no end"),
        (b"\n _", b"\n", "do not begin with _"),
        (b"UInt64", b"Int8", "its header_type is 'Int8', which is not read"),
        (b"offset='0'", b"offset='here'", "the offset 'here', not a number"),
        (b"offset='0'", b"offset='99999'", "longer than its appended data"),
    ],
)
@pytest.mark.parametrize("packed", [False, True])
def test_raw_data_that_do_not_hold_their_arrays_are_refused(
    packed: bool, old: bytes, new: bytes, reason: str, tmp_path: Path
) -> None:
    data = raw_vtu(bricks(), "UInt64", "<", packed, "'", "\n")
    assert old in data
    (tmp_path / "a.vtu").write_bytes(data.replace(old, new))
    with pytest.raises(ReadError, match=reason):
        read(tmp_path / "a.vtu")


@pytest.mark.parametrize("packed", [False, True])
def test_raw_data_cut_short_are_refused(packed: bool, tmp_path: Path) -> None:
    data = raw_vtu(bricks(), "UInt32", "<", packed, "'", "")
    end = data.index(b"</AppendedData>")
    (tmp_path / "a.vtu").write_bytes(data[: end - 1] + data[end:])
    with pytest.raises(ReadError, match="longer than its appended data"):
        read(tmp_path / "a.vtu")


@pytest.mark.parametrize("packed", [False, True])
def test_raw_arrays_that_lap_over_each_other_are_refused(packed: bool, tmp_path: Path) -> None:
    data = bytearray(raw_vtu(bricks(), "UInt32", "<", packed, "'", ""))
    size = data.index(b"\n _") + 3 + (12 if packed else 0)  # of the first block
    data[size] += 1
    (tmp_path / "a.vtu").write_bytes(data)
    with pytest.raises(ReadError, match="the offsets of its arrays do not agree with their sizes"):
        read(tmp_path / "a.vtu")
