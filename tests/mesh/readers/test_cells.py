"""Finite-element meshes: points, kinds, node order and regions."""

import contextlib
import importlib
import io
import struct
from pathlib import Path

import meshio
import numpy as np
import pytest
from tests.mesh.readers.samples import (
    ABAQUS,
    CORNERS,
    GMSH_22,
    GMSH_41,
    MIDDLES,
    NASTRAN,
    QUADS,
    TETRA,
    TETRA_POINTS,
    TRIANGLES,
    VTK_TEXT,
    names_of,
    read_text,
    volumes,
    words,
)

from inertia import mass_properties
from inertia.errors import ReadError
from inertia.mesh.part import Cells, Part
from inertia.mesh.read import read

SU2 = "NDIME= 3\nNPOIN= 5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\nNELEM= 2\n10 0 1 2 3\n10 1 2 3 4\n"
MEDIT = (
    "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n"
    "Tetrahedra\n1\n1 2 3 4 1\nEnd\n"
)
UNNAMED = ["default", "default"]
STEEL = ["steel", "default"]
REGIONS = {
    "gmsh 2.2": STEEL,
    "gmsh 4.1": STEEL,
    "gmsh 2.2 binary": None,
    "gmsh 4.1 binary": None,
    "nastran": ["7", "8"],
    "abaqus": ["all", "steel"],
    "vtk text": ["7", "8"],
    "vtk binary": ["7", "8"],
    "vtk 5.1": ["7", "8"],
    "vtu": ["7", "8"],
    "vtu text": ["7", "8"],
    "med": None,
    "xdmf": ["7", "8"],
    "medit": ["1", "1"],
    "netgen": ["1", "1"],
    "su2": None,
    "avsucd": None,
}

GMSH_NODES = {
    "tetra10": (11, [(0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)]),
    "hexahedron20": (
        17,
        [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)],
    ),
    "wedge15": (18, [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)]),
    "pyramid13": (19, [(0, 1), (0, 3), (0, 4), (1, 2), (1, 4), (2, 3), (2, 4), (3, 4)]),
}
GMSH_NODES["hexahedron27"] = (
    12,
    [
        *GMSH_NODES["hexahedron20"][1],
        *(
            (0, 3, 2, 1),
            (0, 1, 5, 4),
            (0, 4, 7, 3),
            (1, 2, 6, 5),
            (2, 3, 7, 6),
            (4, 5, 6, 7),
            tuple(range(8)),
        ),
    ],
)
GMSH_NODES["wedge18"] = (13, [*GMSH_NODES["wedge15"][1], (0, 1, 4, 3), (0, 3, 5, 2), (1, 2, 5, 4)])
GMSH_NODES["pyramid14"] = (14, [*GMSH_NODES["pyramid13"][1], (0, 3, 2, 1)])
"""Gmsh's order, from the figures of its manual: number of the type, and as above."""

CORNERS_OF = {"tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5}


def written(folder: Path, name: str, mesh: meshio.Mesh, **options: str) -> Part:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        mesh.write(folder / name, **options)
    return read(folder / name)


@pytest.mark.parametrize("sample", REGIONS)
def test_points_cells_and_regions_are_those_of_the_file(sample: str, tmp_path: Path) -> None:
    name, data = volumes(tmp_path)[sample]
    part = read_text(tmp_path, name, data)
    cells = part.geometry
    assert isinstance(cells, Cells)
    assert np.array_equal(cells.points, TETRA_POINTS)
    assert [block.kind for block in cells.blocks] == ["tetra"] * len(cells.blocks)
    assert np.array_equal(np.concatenate([block.nodes for block in cells.blocks]), TETRA)
    assert names_of(part) == REGIONS[sample]
    assert part.source.format == sample.split()[0]
    assert (part.unit.name, part.unit_from) == ("mm", "assumed")


def test_every_volume_sample_is_tried(tmp_path: Path) -> None:
    assert set(volumes(tmp_path)) == set(REGIONS)


@pytest.mark.parametrize("kind", GMSH_NODES)
@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_second_order_nodes_of_gmsh_are_put_in_the_order_of_vtk(kind: str, version: str, tmp_path: Path) -> None:
    number, middles = GMSH_NODES[kind]
    corners = np.random.default_rng(3).normal(size=(CORNERS_OF[kind.rstrip("0123456789")], 3))
    points = [*corners, *(corners[list(around)].mean(axis=0) for around in middles)]
    tags = " ".join(str(i + 1) for i in range(len(points)))
    places = "\n".join(" ".join(map(repr, p.tolist())) for p in points)
    numbered = "\n".join(f"{i + 1} {' '.join(map(repr, p.tolist()))}" for i, p in enumerate(points))
    text = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n"
    if version == "2.2":
        text += f"$Nodes\n{len(points)}\n{numbered}\n$EndNodes\n$Elements\n1\n1 {number} 0 {tags}\n$EndElements\n"
    else:
        text += (
            f"$Nodes\n1 {len(points)} 1 {len(points)}\n3 1 0 {len(points)}\n{tags}\n{places}\n$EndNodes\n"
            f"$Elements\n1 1 1 1\n3 1 {number} 1\n1 {tags}\n$EndElements\n"
        )
    (block,) = read_text(tmp_path, "one.msh", text).geometry.blocks
    assert block.kind == kind
    result = np.array(points)[block.nodes[0]]
    assert np.array_equal(result[: len(corners)], corners)
    expected = [corners[list(around)].mean(axis=0) for around in MIDDLES[kind]]
    assert np.allclose(result[len(corners) :], expected, rtol=1e-12)


@pytest.mark.parametrize("kind", ["hexahedron20", "wedge15", "tetra10"])
@pytest.mark.parametrize("name", ["one.bdf", "one.vtu", "one.inp"])
def test_second_order_nodes_through_meshio_are_in_the_order_of_vtk(kind: str, name: str, tmp_path: Path) -> None:
    corners = np.round(np.random.default_rng(4).normal(size=(CORNERS_OF[kind.rstrip("0123456789")], 3)), 2)
    points = np.array([*corners, *(corners[list(around)].mean(axis=0) for around in MIDDLES[kind])])
    if name == "one.bdf":  # the quick reference guide puts the edges between the two ends before those of the top
        orders = {
            "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15],
            "wedge15": [*range(9), 12, 13, 14, 9, 10, 11],
            "tetra10": [*range(10)],
        }
        grid = "".join(f"GRID,{i + 1},,{','.join(map(repr, p.tolist()))}\n" for i, p in enumerate(points))
        card = {"hexahedron20": "CHEXA", "wedge15": "CPENTA", "tetra10": "CTETRA"}[kind]
        nodes = [str(i + 1) for i in orders[kind]]
        lines = [nodes[:6], *(nodes[i : i + 8] for i in range(6, len(nodes), 8))]
        text = f"{card},1,1," + "\n+,".join(",".join(line) for line in lines)
        part = read_text(tmp_path, name, f"BEGIN BULK\n{grid}{text}\nENDDATA\n")
    elif name == "one.inp":
        grid = "".join(f"{i + 1}, {', '.join(map(repr, p.tolist()))}\n" for i, p in enumerate(points))
        element = {"hexahedron20": "C3D20", "wedge15": "C3D15", "tetra10": "C3D10"}[kind]
        nodes = ", ".join(str(i) for i in range(1, len(points) + 1))
        part = read_text(tmp_path, name, f"*NODE\n{grid}*ELEMENT, TYPE={element}\n1, {nodes}\n")
    else:
        part = written(tmp_path, name, meshio.Mesh(points, [(kind, np.arange(len(points))[None])]))
    (block,) = part.geometry.blocks
    assert block.kind == kind
    assert np.array_equal(part.geometry.points[block.nodes[0]], points)


def test_binary_gmsh_of_the_other_byte_order(tmp_path: Path) -> None:
    nodes = b"".join(struct.pack(">i3d", i + 1, *p) for i, p in enumerate(TETRA_POINTS))
    elements = struct.pack(">3i", 4, 2, 2) + b"".join(
        struct.pack(">7i", i + 1, 7, 1, *(cell + 1)) for i, cell in enumerate(TETRA)
    )
    data = b"$MeshFormat\n2.2 1 8\n\0\0\0\1\n$EndMeshFormat\n"
    data += b"$Nodes\n5\n%b\n$EndNodes\n$Elements\n2\n%b\n$EndElements\n"
    part = read_text(tmp_path, "two.msh", data % (nodes, elements))
    assert np.array_equal(part.geometry.points, TETRA_POINTS)
    assert names_of(part) == ["7", "7"]


def test_boundary_cells_beside_volume_cells_are_left_out(tmp_path: Path) -> None:
    part = read_text(tmp_path, "two.msh", GMSH_22)
    assert [block.kind for block in part.geometry.blocks] == ["tetra"]
    assert part.notes == ("1 cell of lower dimension beside the volume cells was left out",)


def test_shells_are_a_surface(tmp_path: Path) -> None:
    mesh = meshio.Mesh(
        CORNERS,
        [("triangle", TRIANGLES[:8]), ("quad", QUADS[4:]), ("line", [[0, 1]])],
        cell_data={"region": [np.arange(8), np.array([8, 9]), np.array([10])]},
    )
    part = written(tmp_path, "box.vtu", mesh)
    quads = QUADS[4:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    assert np.array_equal(part.triangles.corners(), CORNERS[np.concatenate([TRIANGLES[:8], quads])])
    assert names_of(part) == ["default", *map(str, [*range(1, 8), 8, 8, 9, 9])]
    assert part.notes == (
        "1 cell of lower dimension beside the surface cells was left out",
        "2 faces with more than three corners were split from the first corner",
    )


@pytest.mark.parametrize(
    ("kind", "around"),
    [
        ("triangle6", [(0,), (1,), (2,), (0, 1), (1, 2), (2, 0)]),
        ("quad8", [(0,), (1,), (2,), (3,), (0, 1), (1, 2), (2, 3), (3, 0)]),
        ("quad9", [(0,), (1,), (2,), (3,), (0, 1), (1, 2), (2, 3), (3, 0), (0, 1, 2, 3)]),
    ],
)
def test_second_order_shells_become_flat_triangles(kind: str, around: list, tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [4, 0, 0], [4, 2, 0], [0, 2, 0]], float)[: 3 if kind == "triangle6" else 4]
    points = np.array([corners[list(nodes)].mean(axis=0) for nodes in around])
    part = written(tmp_path, "one.vtu", meshio.Mesh(points, [(kind, np.arange(len(points))[None])]))
    a, b, c = np.moveaxis(part.triangles.corners(), 1, 0)
    normals = np.cross(b - a, c - a)
    assert (normals[:, 2] > 0).all()
    assert normals[:, 2].sum() / 2 == (4.0 if kind == "triangle6" else 8.0)
    assert set(part.triangles.faces.ravel()) == set(range(len(points)))
    assert "1 second-order cell was split" in part.notes[0]


def test_polygons_are_split_into_fans(tmp_path: Path) -> None:
    text = VTK_TEXT.partition("CELLS")[0] + "CELLS 2 10\n5 0 1 2 3 4\n3 0 1 2\nCELL_TYPES 2\n7 5\n"
    part = read_text(tmp_path, "five.vtk", text)
    assert part.triangles.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2]]


def test_wires_and_points_stay_cells(tmp_path: Path) -> None:
    mesh = meshio.Mesh(TETRA_POINTS, [("line", [[0, 1]]), ("line3", [[0, 2, 1]]), ("vertex", [[3]])])
    part = written(tmp_path, "wire.vtu", mesh)
    assert [(block.kind, block.nodes.tolist()) for block in part.geometry.blocks] == [
        ("line", [[0, 1]]),
        ("line3", [[0, 2, 1]]),
        ("vertex", [[3]]),
    ]


def test_points_in_a_plane_have_z_zero(tmp_path: Path) -> None:
    part = written(
        tmp_path,
        "flat.xdmf",
        meshio.Mesh(TETRA_POINTS[:3, :2], [("triangle", [[0, 1, 2]])]),
        data_format="XML",
    )
    assert part.triangles.vertices[:, 2].tolist() == [0, 0, 0]
    assert np.array_equal(part.triangles.vertices[:, :2], TETRA_POINTS[:3, :2])


@pytest.mark.parametrize(
    ("number", "nodes", "kind"),
    [(42, 4, "polyhedron"), (71, 20, "VTK_LAGRANGE_TETRAHEDRON"), (15, 10, "penta_prism")],
)
def test_cells_that_are_not_understood_are_refused_by_name(number: int, nodes: int, kind: str, tmp_path: Path) -> None:
    points = " ".join(["0 0 0"] * nodes)
    text = (
        "# vtk DataFile Version 5.1\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        f"POINTS {nodes} double\n{points}\nCELLS 2 {nodes}\nOFFSETS vtktypeint64\n0 {nodes}\n"
        f"CONNECTIVITY vtktypeint64\n{' '.join(map(str, range(nodes)))}\nCELL_TYPES 1\n{number}\n"
    )
    with pytest.raises(ReadError, match=f"{kind}.* not read|'{kind}'"):
        read_text(tmp_path, "odd.vtk", text)


def test_cells_that_meshio_passes_over_are_refused_by_number(tmp_path: Path) -> None:
    text = volumes(tmp_path)["vtu text"][1].decode()
    assert text.count("10\n10\n") == 1
    with pytest.raises(ReadError, match="cells of the kind 37 of VTK are not read: use cells of first"):
        read_text(tmp_path, "odd.vtu", text.replace("10\n10\n", "10\n37\n"))


def test_third_order_elements_of_gmsh_are_refused_by_number(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="Gmsh's type 29"):
        read_text(tmp_path, "two.msh", GMSH_22.replace("2 4 2 7", "2 29 2 7"))


# Regions


NOTE_OF_GROUPS = "cells in several groups at once are regions of their own, which need a density of their own: "


def test_gmsh_physical_groups_are_regions_where_only_some_are_named(tmp_path: Path) -> None:
    text = GMSH_41.replace("1 1 1 0 0\n$EndEntities", "1 1 1 2 9 7 0\n$EndEntities")
    part = read_text(tmp_path, "two.msh", text)
    assert names_of(part) == ["steel", "steel+9"]
    assert part.notes == (NOTE_OF_GROUPS + "'steel+9'",)
    both = text.replace("1 1 1 1 7 0\n", "1 1 1 2 -7 9 0\n")
    assert names_of(read_text(tmp_path, "two.msh", both)) == ["steel+9", "steel+9"]


def test_gmsh_2_stores_an_element_once_for_each_of_its_groups(tmp_path: Path) -> None:
    copies = [
        "1 4 2 7 1 1 2 3 4",
        "2 4 2 -9 1 1 2 3 4",
        "3 4 2 9 2 2 3 4 15",
        "4 4 2 7 2 2 3 4 15",
        "5 4 2 5 2 2 3 4 15",
    ]
    head = GMSH_22.partition("$Elements")[0]
    part = read_text(tmp_path, "two.msh", head + "\n".join(["$Elements", "5", *copies, "$EndElements", ""]))
    assert names_of(part) == ["steel+9", "5+steel+9"]
    assert part.notes == (f"{NOTE_OF_GROUPS}'5+steel+9' and 1 more",)
    rows = b"".join(
        np.array([4, 1, 2, *np.array(copy.split(), int)[[0, 3, 4, *range(5, 9)]]], "<i4").tobytes() for copy in copies
    )
    nodes = [line.split() for line in head.partition("$Nodes\n5\n")[2].splitlines()[:5]]
    points = b"".join(struct.pack("<i3d", int(tag), *map(float, at)) for tag, *at in nodes)
    named = head[head.index("$PhysicalNames") : head.index("$Nodes")].encode()
    (tmp_path / "three.msh").write_bytes(
        b"$MeshFormat\n2.2 1 8\n\1\0\0\0\n$EndMeshFormat\n" + named
        + b"$Nodes\n5\n" + points + b"\n$EndNodes\n$Elements\n5\n" + rows + b"\n$EndElements\n"
    )  # fmt: skip
    assert names_of(read(tmp_path / "three.msh")) == ["steel+9", "5+steel+9"]


@pytest.mark.parametrize(("again", "count"), [("7 1", 3), ("0 1", 3), ("9 2", 3), ("9 1", 2)])
def test_what_gmsh_2_stores_twice_otherwise_stays(again: str, count: int, tmp_path: Path) -> None:
    text = GMSH_22.replace("$Elements\n3\n", "$Elements\n4\n").replace("3 4 2 0 2", f"4 4 2 {again} 1 2 3 4\n3 4 2 0 2")
    assert names_of(read_text(tmp_path, "two.msh", text)) == [
        *(["steel"] if count == 3 else []), {"7 1": "steel", "0 1": "default", "9 2": "9", "9 1": "steel+9"}[again],
        "default",
    ]  # fmt: skip


def test_families_of_med_are_regions(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    mesh = meshio.Mesh(TETRA_POINTS, [("tetra", TETRA)], cell_data={"cell_tags": [np.array([-6, -7])]})
    mesh.point_tags = {}
    mesh.cell_tags = {-6: ["steel"], -7: ["brass", "outer"]}
    part = written(tmp_path, "two.med", mesh)
    assert names_of(part) == ["steel", "brass+outer"]
    assert part.notes == (NOTE_OF_GROUPS + "'brass+outer'",)
    mesh.cell_tags = {-6: ["steel"], -7: ["steel"]}
    part = written(tmp_path, "two.med", mesh)
    assert part.regions is not None
    assert part.regions.names == ("steel",)
    assert names_of(part) == ["steel", "steel"]


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        ("MaterialIds", [3, 0], ["3", "default"]),
        ("medit:ref", [2.0, 5.0], ["2", "5"]),
        ("material", [2.5, 1.0], None),
        ("temperature", [1, 2], None),
    ],
)
def test_whole_numbers_of_a_known_name_are_regions(name: str, values: list, expected, tmp_path: Path) -> None:
    mesh = meshio.Mesh(TETRA_POINTS, [("tetra", TETRA)], cell_data={name: [np.array(values)]})
    assert names_of(written(tmp_path, "two.vtu", mesh)) == expected


def test_the_smallest_abaqus_set_that_holds_a_cell_names_it(tmp_path: Path) -> None:
    part = read_text(tmp_path, "two.inp", ABAQUS)
    assert part.notes == ("1 cell in more than one set was counted to the smallest",)
    assert names_of(part) == ["all", "steel"]


# What meshio would misread


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        (
            "a.inp",
            ABAQUS + "*Part, name=a\n*NODE\n9, 0, 0, 0\n*End Part\n",
            "nodes in no part and .PART a, but",
        ),
        ("a.inp", ABAQUS + "*INCLUDE, INPUT=a.inp\n", "INCLUDE"),
        ("a.inp", ABAQUS + "*Instance, name=a, part=b\n1., 0., 0.\n*End Instance\n", "moves the part"),
        ("a.inp", ABAQUS + "*ELSET, ELSET=x, GENERATE\n1, 2000000000, 1\n", "2000000000"),
        ("a.inp", ABAQUS.replace("*NODE\n", "*NODE, INPUT=nodes.txt\n"), "INPUT"),
        ("a.inp", ABAQUS.replace("C3D4", "C3D9"), "C3D9"),
        ("a.bdf", NASTRAN.replace("CTETRA  1 ", "CTETRA* 1 "), r"CTETRA\*"),
        ("a.bdf", NASTRAN.replace("GRID,4,,", "GRID,4,3,"), "coordinate system"),
        ("a.bdf", NASTRAN.replace("ENDDATA\n", ""), "no ENDDATA"),
        ("a.bdf", NASTRAN.replace("PSOLID,7,1", "INCLUDE 'b.bdf'"), "INCLUDE"),
        ("a.vtk", VTK_TEXT.replace("UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), "STRUCTURED_POINTS"),
        ("a.vtk", VTK_TEXT.replace("10 10", "10 37"), "cannot read|not read"),
        ("a.vtk", VTK_TEXT.replace("CELLS 2 10", "CELLS 3 10"), "do not agree with its CELL_TYPES"),
        (
            "a.vtk",
            VTK_TEXT.replace("CELL_DATA 2", "CELL_TYPES 2\n9 9\nCELL_DATA 2"),
            "do not agree with its CELL_TYPES",
        ),
        ("a.inp", ABAQUS.replace("*NODE", " *NODE") + " *NODE\n5, 0, 0, 0\n", "node 5 twice, in two places"),
        ("a.inp", ABAQUS.replace("2, 2,3,4,5", "2, 2,,3,4,5"), "elements lack nodes"),
        ("a.inp", ABAQUS.replace("2, 2,3,4,5", "2, 2,3\n4,5"), "different numbers of them"),
        ("a.inp", ABAQUS.replace("2, 2,3,4,5", "2, 2,3,\x1f4,5"), "control character"),
        ("a.bdf", NASTRAN.replace("\n*       0.1", "\n*1.1\n*       0.1"), "has no fields"),
        ("a.bdf", NASTRAN.replace("1.1\n*", "1.\n1\n*"), "has no fields"),
        ("a.bdf", NASTRAN.replace("*       0.1", "* $     0.1"), "has no fields"),
        ("a.bdf", NASTRAN.replace("1.1,1.1,1.1", "1.1,1.1,1.$1"), "a comment begins within a field"),
        (
            "a.bdf",
            NASTRAN.replace("CTETRA,2,8,2,3,4,5", ",8,1"),
            "CTETRA '1' names grid point 8, which it does not have",
        ),
        (
            "a.bdf",
            NASTRAN.replace("CTETRA,2,8,2,3,4,5", "CTETRA,2,8,2,3,,5"),
            "CTETRA '2' has 3 nodes: it needs 4 corners",
        ),
        ("a.bdf", NASTRAN.replace("CTETRA,2,8,2,3,4,5", "CTETRA,2,8,2,3,4,5,1,1,\n,1,1,1,1,1"), "'2' has 11 nodes"),
        ("a.bdf", NASTRAN.replace("CTETRA,2,8,2,3,4,5", "CTETRA,2,8,2,3,4,x"), "'x', which is not a whole number"),
        ("a.bdf", NASTRAN.replace("1.1,1.1,1.1", "1.1,1.1,1.F1"), "GRID 5 holds '1.F1', which is not a number"),
        ("a.bdf", NASTRAN.replace("CTETRA,2,8,2,3,4,5", "CTETRA,2,8,2,3,4," + 5000 * "5"), "not a whole number"),
        ("a.bdf", NASTRAN.replace("1.1,1.1,1.1", "1.1,1.1,1.+999999999"), "not finite"),
        (
            "a.bdf",
            NASTRAN.replace("1.1,1.1,1.1", "1.1,1.1,1.+999999999").replace(",2,3,4,5", ",2,3,4,5,,1"),
            "not finite",
        ),
        ("a.bdf", NASTRAN.replace("\n*       0.1", ""), "GRID 3 has two coordinates"),
        ("a.bdf", NASTRAN.replace("CTETRA,2", "  CTETRA,2"), "begins with blanks"),
        ("a.bdf", NASTRAN.replace("$ a comment", ",7,8"), "',7,8' continues no card"),
        ("a.su2", SU2.replace("0 0 0\n", "0 0\n"), "rows of its NPOIN are not alike"),
        ("a.su2", SU2.replace("10 0 1 2 3", "10 0 1 2"), "rows of its NELEM are not alike"),
        ("a.su2", SU2.replace("NELEM= 2", "NELEM= 1"), "stands outside its tables"),
        ("a.su2", SU2.replace("1 1 1", "1 1 1e"), "'1e', which is not a number"),
        ("a.su2", SU2.replace("NPOIN= 5", "NPOIN= five"), "not a count"),
        ("a.su2", "NZONE= 2\nIZONE= 1\n" + SU2, "its NZONE says that it has several zones"),
        ("a.su2", SU2 + "NMARK= 1\nMARKER_TAG= a\n0 0 0\n", "'0 0 0' stands outside its tables"),
        (
            "a.su2",
            SU2 + "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 1\nSEND_RECV= 2\n1 0 0\n",
            "SEND_RECEIVE says that it is",
        ),
        ("a.su2", SU2 + SU2, "its NDIME says that it has several zones"),
        ("a.su2", SU2 + SU2.partition("\n")[2], "its NPOIN says that it has several zones"),
        ("a.su2", SU2[: SU2.index("NPOIN")] + SU2[SU2.index("NELEM") :], "it has no NPOIN"),
        ("a.mesh", MEDIT + "Tetrahedra\n1\n1 2 3 4 1\nEnd\n", "text follows its End"),
        ("a.mesh", MEDIT.replace("\nEnd\n", ""), "has no End"),
        ("a.mesh", MEDIT.replace("Tetrahedra\n1", "Ridges\n1\n1"), "its table 'Ridges' is not as long as it says"),
        ("a.mesh", MEDIT.replace("Tetrahedra", "BoundingBox\n0 1 0 1"), "its table 'BoundingBox' is not as long"),
        ("a.mesh", MEDIT.replace("End\n", "Tetrahedra\n1\n1 2 3 4 1\nEnd\n"), "a table twice"),
    ],
)
def test_what_would_be_misread_is_refused(name: str, text: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=reason):
        read_text(tmp_path, name, text)


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("a.mesh", MEDIT.replace("1 2 3 4 1\n", "1 2 3 4 1\n1 2 3 4 1\n"), "as medit: it is damaged"),
        ("a.mesh", MEDIT.replace("Vertices\n4", "Vertices\n5"), r"as medit \(it holds more or fewer numbers"),
        ("a.mesh", MEDIT.replace("Tetrahedra\n1", "Tetrahedra\nx"), r"as medit \('x' stands where a number should\)"),
        ("a.su2", "MARKER_TAG= wall\n" + SU2.replace("NDIME= 3", "NDIME= 4"), r"as su2 \('Invalid dimension value"),
        ("a.vtk", VTK_TEXT.replace("double", "decimal"), r"as vtk \('decimal' is missing or not known\)"),
        ("a.vtk", VTK_TEXT.replace("CELL_DATA 2", "CELL_DATA"), r"as vtk \(something in it is missing or too short\)"),
        (
            "a.vol",
            "mesh3d\nvolumeelements\n1\n1 4 1\nendmesh\n",
            r"as netgen \(something in it is missing or too short\)",
        ),
    ],
)
def test_what_meshio_raises_is_said_in_words(name: str, text: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=f"meshio cannot read it {reason}"):
        read_text(tmp_path, name, text)


@pytest.mark.parametrize(
    "text",
    [
        SU2.replace("=", " ="),
        "NZONE= 1 % one\nIZONE= 1\n" + SU2,
        SU2.replace("NDIME= 3", "NDIME= 3 % of space"),
        SU2.replace("NELEM= 2\n", "NELEM= 2 % cells\n% kind, nodes\n\n").replace("1 1 1\n", "1 1 1 % last\n"),
        SU2
        + "FFD_NBOX= 1\nFFD_TAG= WING\nFFD_CORNER_POINTS= 2\n0 0 0\n1 0 0\nFFD_SURFACE_POINTS= 1\nwall 0 .5 .5 .5\n",
        SU2 + "NPERIODIC= 1\nPERIODIC_INDEX= 0\n" + 3 * "0 0 0\n",
        SU2 + "NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 0\n",
    ],
)
def test_what_su2_writes_beside_points_and_cells_is_passed_over(text: str, tmp_path: Path) -> None:
    """Two tetrahedra on the same base, of volumes 1/6 and 1/3."""
    assert mass_properties(read_text(tmp_path, "a.su2", text), 1.0).mass == pytest.approx(0.5e-9, rel=1e-15)


@pytest.mark.parametrize(
    "tables",
    [
        "RequiredVertices\n2\n1\n2\nRidges\n1\n1\nTangents\n1\n0 0 1\nTangentAtVertices\n1\n1 1\n",
        "RequiredTriangles\n1\n1\nRequiredEdges\n1\n1\n\nRequiredTetrahedra\n1\n1\nRequiredQuadrilaterals\n0\n",
        "AngleOfCornerBound\n1e+1\nSubDomainFromGeom\n1\n2 1 1 0\nTangentAtEdges\n1\n1 1 1\n",
        "# made\nBoundingBox\n0 1 0 1 0 1\nNormals 1\n0 0 1 # up\nNormalAtTriangleVertices\n1\n1 1 1\n",
        "EdgesOnGeometricEdge\r\n1\r\n1 1\r\n",
    ],
)
def test_tables_of_medit_that_change_no_body_are_left_out(tables: str, tmp_path: Path) -> None:
    for text in (MEDIT.replace("End\n", tables + "End\n"), MEDIT.replace("Tetrahedra\n", tables + "Tetrahedra\n")):
        part = read_text(tmp_path, "a.mesh", text)
        assert mass_properties(part, 1.0).mass == pytest.approx(1e-9 / 6, rel=1e-15)
        assert names_of(part) == ["1"]
    with pytest.raises(ReadError, match=r"as medit \(\"Unknown keyword 'Other'"):
        read_text(tmp_path, "a.mesh", MEDIT.replace("End\n", tables + "Other\n1\n1\nEnd\n"))


@pytest.mark.parametrize(
    "text",
    [
        MEDIT.replace(" 2\n", "\n2\n", 1).replace("Dimension 3", "Dimension\n3"),
        MEDIT.replace("Vertices\n4", "Vertices 4").replace("Tetrahedra\n1", "Tetrahedra # one\n\t1"),
        MEDIT.replace("\n", " ").strip() + "\n",
        MEDIT.replace("\n", "\r\n").replace("Vertices\r\n4", "Vertices  4"),
        MEDIT.replace("Formatted 2", "Formatted 3"),
        MEDIT.replace("Formatted 2", "Formatted\n4"),
    ],
)
def test_any_white_space_parts_the_words_of_medit(text: str, tmp_path: Path) -> None:
    part = read_text(tmp_path, "a.mesh", text)
    assert mass_properties(part, 1.0).mass == pytest.approx(1e-9 / 6, rel=1e-15)
    assert not part.notes


def test_tables_of_medit_are_there_once_wherever_they_begin(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="a table twice"):
        read_text(tmp_path, "a.mesh", MEDIT.replace("1\nEnd", "1 Tetrahedra 1 1 2 3 4 1\nEnd"))


def test_a_node_0_that_counts_from_1_is_none(tmp_path: Path) -> None:
    _, data = volumes(tmp_path)["netgen"]
    with pytest.raises(ReadError, match="names vertex -1, but the vertices are 0 to 4"):
        read_text(tmp_path, "a.vol", data.replace(b" 4 2 4 3 5", b" 4 2 4 3 0"))


@pytest.mark.parametrize("name", ["two.vtu", "two.vtk"])
def test_a_cell_has_as_many_corners_as_its_type(name: str, tmp_path: Path) -> None:
    _, data = volumes(tmp_path)["vtu text" if name == "two.vtu" else "vtk 5.1"]
    assert read_text(tmp_path, name, data).geometry.count == 2
    types = (b"10\n10\n", b"10\n14\n") if name == "two.vtu" else (b"\0\0\0\x0a" * 2, b"\0\0\0\x0a\0\0\0\x0e")
    with pytest.raises(ReadError, match="a cell of the kind pyramid has 4 nodes, not 5"):
        read_text(tmp_path, name, data.replace(*types))


def test_a_vtu_file_of_two_pieces_is_refused(tmp_path: Path) -> None:
    _, data = volumes(tmp_path)["vtu text"]
    start, stop = data.index(b"<Piece"), data.index(b"</Piece>") + 8
    with pytest.raises(ReadError, match="2 pieces"):
        read_text(tmp_path, "a.vtu", data[:stop] + data[start:stop] + data[stop:])


@pytest.mark.parametrize("name", ["two.vtu", "two.vtk"])
def test_cells_of_vtk_that_another_piece_has_too_are_left_out(name: str, tmp_path: Path) -> None:
    data = {"vtkGhostType": [np.array([1, 32, 2, 0], np.uint8)], "material": [np.array([5, 6, 7, 8])]}
    part = written(tmp_path, name, meshio.Mesh(TETRA_POINTS, [("tetra", TETRA[[0, 0, 0, 1]])], cell_data=data))
    assert isinstance(part.geometry, Cells)
    assert np.array_equal(part.geometry.blocks[0].nodes, TETRA)
    assert names_of(part) == ["7", "8"]
    assert part.notes == ("2 cells that vtkGhostType calls duplicate or hidden were left out",)


@pytest.mark.parametrize("kind", ["vtkLZ4DataCompressor", "vtkLZMADataCompressor"])
def test_a_vtu_file_that_is_packed_otherwise_is_refused_by_name(kind: str, tmp_path: Path) -> None:
    _, data = volumes(tmp_path)["vtu"]
    with pytest.raises(ReadError, match=f"packed by '{kind}', which is not read: save it by vtkZLib"):
        read_text(tmp_path, "a.vtu", data.replace(b"vtkZLibDataCompressor", kind.encode()))


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("<Grid ", '<Grid GridType="Collection"/><Grid ', r"it has 2 grids \(Collection, Uniform\), but one"),
        ('GridType="Uniform"', 'GridType="Tree"', r"it has 1 grid \(Tree\), but one"),
    ],
)
def test_grids_of_xdmf_that_are_not_read_are_called_by_name(old: str, new: str, reason: str, tmp_path: Path) -> None:
    text = volumes(tmp_path)["xdmf"][1].decode()
    if old not in text:
        old, new = "<Grid ", f"<Grid {new} "
    with pytest.raises(ReadError, match=reason):
        read_text(tmp_path, "a.xdmf", text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("sample", "old", "new"),
    [
        ("netgen", b" 4 2 4 3 5", b" 4 2 4 3 0_5"),
        ("avsucd", b"0.1", b"0_0.1"),
        ("nastran", b"CTETRA,2,8", b"CTETRA,2,0_8"),
    ],
)
def test_numbers_of_python_are_none_of_the_file(sample: str, old: bytes, new: bytes, tmp_path: Path) -> None:
    name, data = volumes(tmp_path)[sample]
    assert old in data
    with pytest.raises(ReadError, match=r"_.*, which is not a (whole )?number"):
        read_text(tmp_path, name, data.replace(old, new, 1))


@pytest.mark.parametrize("table", ["TetrahedraP2", "HexahedraQ2", "TrianglesP3"])
def test_curved_cells_of_medit_are_refused_by_name(table: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=f"its table '{table}' is not read: use cells of first order"):
        read_text(tmp_path, "a.mesh", MEDIT.replace("Tetrahedra\n", f"{table}\n1\n1 2 3 4 1\nTetrahedra\n"))


def test_a_vtu_file_of_a_surface_kind_is_refused(tmp_path: Path) -> None:
    _, data = volumes(tmp_path)["vtu text"]
    with pytest.raises(ReadError, match="'PolyData'"):
        read_text(tmp_path, "a.vtu", data.replace(b"UnstructuredGrid", b"PolyData"))


@pytest.mark.parametrize("name", ["two.med", "two.xdmf"])
def test_without_h5py_the_remedy_is_named(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / name).write_bytes(volumes(tmp_path)[name[4:]][1])
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ReadError, match=r"pip install 'inertia\[med\]'"):
        read(tmp_path / name)


def test_xdmf_does_not_follow_references_to_raw_files(tmp_path: Path) -> None:
    text = volumes(tmp_path)["xdmf"][1].decode()
    with pytest.raises(ReadError, match="raw binary"):
        read_text(tmp_path, "a.xdmf", text.replace('Format="XML"', 'Format="Binary"'))
    with pytest.raises(ReadError, match=r"needs the file 'gone\.h5'"):
        read_text(
            tmp_path,
            "a.xdmf",
            text.replace('Format="XML" Precision="8">', 'Format="HDF" Precision="8">gone.h5:/a', 1),
        )


ALIGNED = np.array([[x, y, z] for z in (0, 3) for y in (0, 2) for x in (0, 1)])


def vtk_text(number: int, nodes: int, version: str) -> str:
    points = "\n".join(" ".join(map(str, point)) for point in ALIGNED[:nodes])
    head = f"# vtk DataFile Version {version}\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {nodes} double\n{points}\n"
    each = " ".join(map(str, range(nodes)))
    if version == "5.1":
        cells = f"CELLS 2 {nodes}\nOFFSETS vtktypeint64\n0 {nodes}\nCONNECTIVITY vtktypeint64\n{each}\n"
    else:
        cells = f"CELLS 1 {nodes + 1}\n{nodes} {each}\n"
    return f"{head}{cells}CELL_TYPES 1\n{number}\n"


@pytest.mark.parametrize("version", ["3.0", "5.1"])
def test_voxels_and_pixels_are_read(version: str, tmp_path: Path) -> None:
    """A brick of 1 × 2 × 3, and its floor."""
    part = read_text(tmp_path, "a.vtk", vtk_text(11, 8, version), unit="m")
    assert isinstance(part.geometry, Cells)
    properties = mass_properties(part, 12.0)
    assert properties.mass == pytest.approx(72, rel=1e-15)
    np.testing.assert_allclose(properties.inertia, np.diag([78, 60, 30]), atol=1e-12)
    floor = read_text(tmp_path, "b.vtk", vtk_text(8, 4, version), unit="m")
    assert floor.triangles.count == 2
    assert mass_properties(floor, 1.0, shell=1.0).mass == pytest.approx(2, rel=1e-15)
    np.testing.assert_allclose(mass_properties(floor, 1.0, shell=1.0).center_of_mass, [0.5, 1, 0], atol=1e-15)


@pytest.mark.parametrize("version", ["3.0", "5.1"])
@pytest.mark.parametrize("number", [8, 11])
def test_a_voxel_has_as_many_corners_as_it_should(number: int, version: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"has 5 nodes, not \d|do not agree with its CELL_TYPES"):
        read_text(tmp_path, "a.vtk", vtk_text(number, 5, version))


def test_voxels_stand_beside_other_cells(tmp_path: Path) -> None:
    text = (
        vtk_text(11, 8, "3.0")
        .replace("CELLS 1 9", "CELLS 3 23\n4 0 2 1 4")
        .replace("CELL_TYPES 1\n11", "CELL_TYPES 3\n10 11 12")
    )
    text = text.replace("8 0 1 2 3 4 5 6 7\n", "8 0 1 2 3 4 5 6 7\n8 0 1 3 2 4 5 7 6\n")
    part = read_text(tmp_path, "a.vtk", text)
    assert isinstance(part.geometry, Cells)
    assert [block.kind for block in part.geometry.blocks] == ["tetra", "hexahedron"]
    assert part.geometry.blocks[1].nodes.tolist() == [[0, 1, 3, 2, 4, 5, 7, 6]] * 2


@pytest.mark.parametrize(
    ("number", "kind"), [(2, "poly-vertex"), (4, "poly-line"), (6, "triangle strip"), (42, "polyhedron")]
)
def test_cells_in_lists_that_are_not_read_are_called_by_name(number: int, kind: str, tmp_path: Path) -> None:
    for version in ("3.0", "5.1"):
        with pytest.raises(ReadError, match=f"cells of the kind '?{kind}'? are not read") as refusal:
            read_text(tmp_path, "a.vtk", vtk_text(number, 4, version))
        assert refusal.value.code == "not_read"


@pytest.mark.parametrize("name", ["a.vtu", "2.vtu", "a.vtk", "5.vtk"])
def test_poly_lines_and_their_like_beside_a_solid_are_left_out(name: str, tmp_path: Path) -> None:
    """They stand before, between and behind the cells of the solid, which keep their regions."""
    cells = [
        (4, [0, 1, 2]),
        (12, [*range(8)]),
        (2, [3, 4, 5, 6]),
        (6, [0, 1, 2, 3]),
        (4, [5, 1, 2, 0]),
        (10, [8, 1, 2, 5]),
    ]
    points = "0 0 0 1 0 0 1 2 0 0 2 0 0 0 3 1 0 3 1 2 3 0 2 3 3 0 0"
    corners = " ".join(str(node) for _, nodes in cells for node in nodes)
    ends = np.cumsum([len(nodes) for _, nodes in cells]).tolist()
    types, regions = " ".join(str(number) for number, _ in cells), "1 7 2 3 4 8"
    if name.endswith("vtu"):
        arrays = {"connectivity": corners, "offsets": words(ends), "types": types}
        data = "".join(
            f'<DataArray type="Int64" Name="{key}" format="ascii">{text}</DataArray>' for key, text in arrays.items()
        )
        text = (
            f'<VTKFile type="UnstructuredGrid" version="{"2.3" if name[0] == "2" else "0.1"}" '
            'byte_order="LittleEndian"><UnstructuredGrid><Piece NumberOfPoints="9" NumberOfCells="6"><Points>'
            '<DataArray type="Float64" '
            f'NumberOfComponents="3" format="ascii">{points}</DataArray></Points><Cells>{data}</Cells><CellData>'
            f'<DataArray type="Int32" Name="region" format="ascii">{regions}</DataArray></CellData></Piece>'
            "</UnstructuredGrid></VTKFile>"
        )
    else:
        lists = "\n".join(words([len(nodes), *nodes]) for _, nodes in cells)
        table = f"CELLS 6 {6 + ends[-1]}\n{lists}"
        if name[0] == "5":
            table = (
                f"CELLS 7 {ends[-1]}\nOFFSETS vtktypeint64\n{words([0, *ends])}\nCONNECTIVITY vtktypeint64\n{corners}"
            )
        text = (
            f"# vtk DataFile Version {'5.1' if name[0] == '5' else '3.0'}\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
            f"POINTS 9 double\n{points}\n{table}\nCELL_TYPES 6\n{types}\nCELL_DATA 6\nSCALARS region int 1\n"
            f"LOOKUP_TABLE default\n{regions}\n"
        )
    part = read_text(tmp_path, name, text)
    assert isinstance(part.geometry, Cells)
    assert [(block.kind, block.nodes.tolist()) for block in part.geometry.blocks] == [
        ("hexahedron", [[*range(8)]]), ("tetra", [[8, 1, 2, 5]]),
    ]  # fmt: skip
    assert names_of(part) == ["7", "8"]
    assert part.notes == ("4 cells of lower dimension beside the volume cells were left out",)


def test_regions_of_polygons_in_lists_are_kept(tmp_path: Path) -> None:
    text = (
        vtk_text(7, 4, "3.0").replace("CELLS 1 5", "CELLS 2 9\n3 0 1 2").replace("CELL_TYPES 1\n7", "CELL_TYPES 2\n7 7")
    )
    part = read_text(tmp_path, "a.vtk", text + "\nCELL_DATA 2\nSCALARS region int 1\nLOOKUP_TABLE default\n4 5\n")
    assert names_of(part) == ["4", "5", "5"]


def test_medit_may_do_without_its_end(tmp_path: Path) -> None:
    plain = read_text(tmp_path, "plain.mesh", MEDIT)
    part = read_text(tmp_path, "a.mesh", MEDIT.replace("End\n", ""))
    assert isinstance(part.geometry, Cells)
    assert isinstance(plain.geometry, Cells)
    assert np.array_equal(part.geometry.points, plain.geometry.points)
    assert any("no End" in note for note in part.notes)
    assert not plain.notes
