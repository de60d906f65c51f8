"""Input files of Abaqus: comments, tables in several blocks, names of types, sets, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import ABAQUS, TETRA, TETRA_POINTS

import inertia
from inertia import mass_properties, read
from inertia.errors import ReadError
from inertia.mesh.part import Cells, Part

NODES = "*NODE\n" + "".join(f"{k}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(TETRA_POINTS.tolist(), 1))
BRICK = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,2,0\n4,0,2,0\n5,0,0,3\n6,1,0,3\n7,1,2,3\n8,0,2,3\n"
MOVED = "*Instance, name=a, part=b\n{}1., 0., 0.\n*End Instance\n"


def read_text(folder: Path, text: str) -> Part:
    (folder / "a.inp").write_text(text)
    return read(folder / "a.inp", unit="m")


def cells_of(part: Part) -> Cells:
    assert isinstance(part.geometry, Cells)
    return part.geometry


def regions_of(part: Part) -> list[str]:
    assert part.regions is not None
    return [part.regions.names[k] for k in part.regions.index]


@pytest.mark.parametrize("between", ["** a comment\n", "\n", "  ** one more\n\n** and one\n"])
def test_comments_and_blank_lines_end_no_table(between: str, tmp_path: Path) -> None:
    cells = cells_of(read_text(tmp_path, between.join(ABAQUS.splitlines(keepends=True))))
    assert np.array_equal(cells.points, TETRA_POINTS)
    assert np.array_equal(cells.blocks[0].nodes, TETRA)
    with pytest.raises(ReadError, match="moves the part"):
        read_text(tmp_path, ABAQUS + MOVED.format(between))


def test_a_set_holds_the_elements_of_its_own_tables(tmp_path: Path) -> None:
    tables = "*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n*ELEMENT, TYPE=C3D4, ELSET=A\n2,2,3,4,5\n"
    assert regions_of(read_text(tmp_path, NODES + tables)) == ["default", "A"]
    more = "*ELEMENT, TYPE=C3D4, ELSET=B\n3,1,2,3,5\n*ELEMENT, TYPE=C3D4,\nELSET=A\n4,1,2,4,5\n5,1,3,4,5\n"
    assert regions_of(read_text(tmp_path, NODES + tables + more)) == ["default", "A", "B", "A", "A"]


@pytest.mark.parametrize(
    ("rows", "regions"),
    [
        ("1, 5, 4", ["x", "default", "x"]),
        ("1, 3", ["x", "x", "default"]),
        ("1, 1, 1\n5, 5", ["x", "default", "x"]),
        ("2, 2,", ["default"] * 3),
    ],
)
def test_sets_may_be_ranges(rows: str, regions: list[str], tmp_path: Path) -> None:
    text = NODES + "*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n3,2,3,4,5\n5,1,2,3,5\n*Elset, elset=x, generate\n" + rows
    if "x" in regions:
        assert regions_of(read_text(tmp_path, text)) == regions
    else:
        assert read_text(tmp_path, text).regions is None


TWO_TABLES = "*ELEMENT, TYPE=C3D4, ELSET=One\n1,1,2,3,4\n2,2,3,4,5\n*ELEMENT, TYPE=C3D4, ELSET=Two\n3,1,2,3,5\n"


@pytest.mark.parametrize(
    ("sets", "regions", "left"),
    [
        ("*ELSET, ELSET=Both\nOne, Two\n", ["One", "One", "Two"], "'Both'"),
        ("*ELSET, ELSET=Both\nOne\nTWO\n", ["One", "One", "Two"], "'Both'"),
        ("*ELSET, ELSET=Steel\nOne\n", ["Steel", "Steel", "Two"], "'One'"),
        ("*ELSET, ELSET=Most\n2, Two\n*ELSET, ELSET=Few\nMost\n", ["One", "Few", "Two"], "'Most'"),
        ("*ELSET, ELSET=Few\nMost\n*ELSET, ELSET=Most\n2, Two, Few\n", ["One", "Most", "Two"], "'Few'"),
    ],
)
def test_a_set_holds_elements_and_other_sets(sets: str, regions: list[str], left: str, tmp_path: Path) -> None:
    part = read_text(tmp_path, NODES + TWO_TABLES + sets)
    assert regions_of(part) == regions
    assert part.notes[-1].endswith(f"counted to the smallest, which leaves none to {left}")


def test_a_set_of_what_is_no_set_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="its set 'BOTH' lists 'Three', which is no set"):
        read_text(tmp_path, NODES + TWO_TABLES + "*ELSET, ELSET=Both\nOne, Three\n")


@pytest.mark.parametrize(("name", "second"), [("STEEL", "Steel"), ("s teel", "Steel"), ('"steel"', '"steel"')])
def test_case_and_blanks_count_in_quoted_labels_alone(name: str, second: str, tmp_path: Path) -> None:
    tables = f"*ELEMENT, TYPE=C3D4, ELSET=Steel\n1,1,2,3,4\n*ELEMENT, TYPE=C3D4, ELSET={name}\n2,2,3,4,5\n"
    assert regions_of(read_text(tmp_path, NODES + tables)) == ["Steel", second]


@pytest.mark.parametrize(
    ("kind", "nodes", "text", "volume"),
    [
        *((kind, "1,2,3,4", NODES, 1 / 6) for kind in ("c3d4", "C3D4H", "C3D4T", "DC3D4")),
        *((kind, "1,2,3,4,5,6,7,8", BRICK, 6) for kind in ("c3d8r", "C3D8T", "C3D8RPH", "SC8R", "SC8RT")),
        *((kind, "1,2,3,\n4,5,6,7,8,", BRICK, 6) for kind in ("C3D8", "C3D8IH")),
        *((kind, "1,2,3,5,6,7", BRICK, 3) for kind in ("C3D6H", "C3D6T", "SC6R")),
    ],
)
def test_types_of_one_layout_are_one_kind(kind: str, nodes: str, text: str, volume: float, tmp_path: Path) -> None:
    part = read_text(tmp_path, f"{text}*ELEMENT, TYPE={kind}\n1,{nodes}\n")
    assert mass_properties(part, 1).volume == pytest.approx(volume, rel=1e-14)


@pytest.mark.parametrize("kind", ["S4T", "s4r", "CPS4I", "M3D4R", "R3D4"])
def test_shells_of_one_layout_are_one_kind(kind: str, tmp_path: Path) -> None:
    part = read_text(tmp_path, f"{BRICK}*ELEMENT, TYPE={kind}\n1,1,2,3,4\n")
    assert mass_properties(part, 1, shell=1).volume == pytest.approx(2, rel=1e-14)


@pytest.mark.parametrize("kind", ["MASS", "C3D15V", "C3D27", "CAX4", "SPRINGA", "U1", ""])
def test_other_types_are_refused_by_name(kind: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=f"its elements of the type '{kind}' are not read"):
        read_text(tmp_path, f"{ABAQUS}*ELEMENT, TYPE={kind}\n9,1\n")


def test_a_type_has_its_number_of_nodes(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="as element '1', which needs 4"):
        read_text(tmp_path, BRICK + "*ELEMENT, TYPE=S4\n" + "".join(f"{k},1,2,3\n" for k in range(1, 6)))


def test_numbers_are_those_of_fortran(tmp_path: Path) -> None:
    for behind in ("", ",", ", 0., 0., 1.,"):
        part = read_text(tmp_path, ABAQUS.replace("1, 0.1, 0.1, 0.1", f"1, 1.D-1, .1d0, 1.e-1{behind}"))
        assert np.array_equal(cells_of(part).points, TETRA_POINTS)
    for text, says in (
        ("1_0", "node 4 holds '1_0', which is not a number"),
        ("0,0,0,0", "node '4' has 7 numbers, but"),
    ):
        with pytest.raises(ReadError, match=says):
            read_text(tmp_path, ABAQUS.replace("4, 0.1, 0.1, 1.1", f"4, 0.1, {text}, 0.1, 1.1"))
    with pytest.raises(ReadError, match="element '2' holds '0_5', which is not a whole number"):
        read_text(tmp_path, ABAQUS.replace("2,3,4,5", "2,3,4,0_5"))


def test_a_coordinate_that_is_left_out_is_zero(tmp_path: Path) -> None:
    short = "*NODE\n1\n2,1\n3,1,2,\n4,,2,\n5,,,3\n6,1, ,3\n7,1,2,3\n8,,2,3\n*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n"
    full = read_text(tmp_path, BRICK + "*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n")
    assert np.array_equal(cells_of(read_text(tmp_path, short)).points, cells_of(full).points)
    flat = read_text(tmp_path, "*NODE\n1,0,0\n2,1,0\n3,1,2\n*ELEMENT, TYPE=CPS3\n1,1,2,3\n")
    assert mass_properties(flat, 1, shell=1).volume == pytest.approx(1, rel=1e-14)


def test_an_instance_that_is_moved_by_nothing_is_read(tmp_path: Path) -> None:
    for nothing in ("0., 0., 0.\n", "0.,0.E0,\n", "0\n"):
        instance = f"*Instance, name=P-1, part=P\n{nothing}*End Instance\n"
        part = read_text(tmp_path, IN_PARTS.format(NODES, instance))
        assert np.array_equal(cells_of(part).points, TETRA_POINTS)
    for moves in ("0., 0., 1e-300\n", "0.,0.,0.\n0.,0.,0.,1.,0.,0.,90.\n"):
        with pytest.raises(ReadError, match="INSTANCE moves the part"):
            read_text(tmp_path, IN_PARTS.format(NODES, f"*Instance, name=P-1, part=P\n{moves}*End Instance\n"))
    with pytest.raises(ReadError, match=r"its \*INSTANCE holds 'x', which is not a number"):
        read_text(tmp_path, IN_PARTS.format(NODES, "*Instance, name=P-1, part=P\nx\n*End Instance\n"))


def test_a_node_is_in_one_place(tmp_path: Path) -> None:
    again = "5, 1.1, 1.1, 1.1\n"
    assert len(cells_of(read_text(tmp_path, ABAQUS.replace(again, again + "5, 1.10, 11e-1, 1.1\n"))).points) == 5
    with pytest.raises(ReadError, match="defines node 5 twice, in two places"):
        read_text(tmp_path, ABAQUS.replace(again, again + "5, 1.1, 1.1, 1.2\n"))


def test_nodes_may_be_in_several_blocks(tmp_path: Path) -> None:
    head, *nodes = NODES.splitlines(keepends=True)
    table = "*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n2,2,3,4,5\n"
    for blocks in ([*nodes[:2], "*NODE, NSET=x\n", *nodes[1:], table], [*nodes[:2], table, "*NODE\n", *nodes[2:]]):
        cells = cells_of(read_text(tmp_path, head + "".join(blocks)))
        assert np.array_equal(cells.points, TETRA_POINTS)
        assert np.array_equal(cells.blocks[0].nodes, TETRA)


IN_PARTS = "*Part, name=P\n{}*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n*End Part\n*Assembly, name=A\n{}*End Assembly\n"
ONE = "*Instance, name=P-1, part=P\n*End Instance\n"


@pytest.mark.parametrize(
    "of_assembly", [ONE + "*Node\n1, 100., 0., 0.\n*Nset, nset=RP\n1,\n", "*Node\n9,1,1,1\n" + ONE]
)
def test_reference_points_of_an_assembly_are_left_out(of_assembly: str, tmp_path: Path) -> None:
    part = read_text(tmp_path, IN_PARTS.format(NODES, of_assembly))
    assert np.array_equal(cells_of(part).points, TETRA_POINTS)
    assert mass_properties(part, 1).volume == pytest.approx(1 / 6, rel=1e-14)


def test_a_reference_point_of_a_part_is_no_part_of_it(tmp_path: Path) -> None:
    part = read_text(tmp_path, IN_PARTS.format(NODES + "*NODE\n9, 100., 0., 0.\n", ONE))
    assert inertia.analyse(part, 1).extents[1].tolist() == TETRA_POINTS[:4].max(axis=0).tolist()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (IN_PARTS.format(NODES, ONE + ONE), "has 2 instances, and nodes in .*, but one part is read"),
        (
            IN_PARTS.format(NODES, ONE).replace("*Assembly", f"*Part, name=Q\n{NODES}*End Part\n*Assembly"),
            "nodes in .PART P and .PART Q, but one part",
        ),
        (IN_PARTS.format(NODES, ONE + "*Element, type=T3D2\n9,1,2\n"), "its .ASSEMBLY has elements of its own"),
    ],
)
def test_one_part_is_read(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=says) as refusal:
        read_text(tmp_path, text)
    assert refusal.value.code == "not_read"


ROD = "*NODE\n1,0,0,0\n2,5,0,0\n3,10,0,0\n4,3,4,0\n5,2,0,0\n"


@pytest.mark.parametrize("kind", ["T3D3", "t3d3h", "T2D3", "B32", "B22H"])
def test_the_second_of_three_nodes_of_a_rod_is_in_the_middle(kind: str, tmp_path: Path) -> None:
    """As Gmsh, FreeCAD and CalculiX write them."""
    part = read_text(tmp_path, f"{ROD}*ELEMENT, TYPE={kind}\n1, 1, 2, 3\n")
    properties = mass_properties(part, 1, wire=1)
    assert properties.mass == pytest.approx(10, rel=1e-13)
    assert properties.center_of_mass == pytest.approx([5, 0, 0], abs=1e-13)
    assert cells_of(part).blocks[0].nodes.tolist() == [[0, 2, 1]]
    assert cells_of(read_text(tmp_path, f"{ROD}*ELEMENT, TYPE={kind}\n1, 1, 4, 3\n")).count == 1


@pytest.mark.parametrize("nodes", ["1, 3, 2", "2, 1, 3", "1, 5, 3"])
def test_a_rod_whose_middle_is_elsewhere_is_refused(nodes: str, tmp_path: Path) -> None:
    with pytest.raises(
        ReadError, match=r"second of the three nodes of its element 7 is not .*: give the nodes as end, mid"
    ):
        read_text(tmp_path, f"{ROD}*ELEMENT, TYPE=B32\n7, {nodes}\n")


@pytest.mark.parametrize(
    "keyword", ["Imperfection, file=a, step=1", "Symmetric  Model Generation, revolve", "IMPORT, STATE=NO"]
)
def test_what_moves_or_makes_nodes_is_refused(keyword: str, tmp_path: Path) -> None:
    name = " ".join(keyword.partition(",")[0].upper().split())
    with pytest.raises(ReadError, match=f"its keyword '.{name}' is not read: write nodes and elements out in full"):
        read_text(tmp_path, f"{ABAQUS}*{keyword}\n1, 0.1\n")
