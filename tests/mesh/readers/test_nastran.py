"""Nastran: fields, continuations, elements of second order with and without midside nodes, and what is left aside."""

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import MIDDLES, NASTRAN, names_of, read_text

from inertia import mass_properties
from inertia.errors import ReadError
from inertia.mesh.part import Cells


@pytest.mark.parametrize("comment", ["  $ the last one", "\t$", " $ of two, 1.5 $ and more"])
def test_comments_behind_the_fields_of_nastran_are_left_aside(comment: str, tmp_path: Path) -> None:
    lines = NASTRAN.splitlines()
    behind = [line + comment if line.startswith(("GRID", "*", "CTETRA")) else line for line in lines]
    plain = read_text(tmp_path, "plain.bdf", NASTRAN)
    part = read_text(tmp_path, "a.bdf", "\n".join(behind) + "\n")
    assert isinstance(part.geometry, Cells)
    assert isinstance(plain.geometry, Cells)
    assert np.array_equal(part.geometry.points, plain.geometry.points)
    assert [block.nodes.tolist() for block in part.geometry.blocks] == [
        block.nodes.tolist() for block in plain.geometry.blocks
    ]


HEXAHEDRON = np.array([[x, y, z] for z in (0, 3) for x, y in ((0, 0), (1, 0), (1, 2), (0, 2))], float)
NASTRAN_MIDDLES = {
    "CTETRA": ("tetra10", [0, 1, 2, 3, 4, 5]),
    "CPYRAM": ("pyramid13", [*range(8)]),
    "CPENTA": ("wedge15", [0, 1, 2, 6, 7, 8, 3, 4, 5]),
    "CHEXA": ("hexahedron20", [0, 1, 2, 3, 8, 9, 10, 11, 4, 5, 6, 7]),
}
"""Nastran's midside nodes, from the figures of its Quick Reference Guide, as places in VTK's order of them."""


def bulk(*cards: str) -> str:
    return "\n".join(["BEGIN BULK", *cards, "ENDDATA", ""])


def grid(points: np.ndarray) -> list[str]:
    return [f"GRID,{k},,{','.join(map(str, map(float, point)))}" for k, point in enumerate(points, 1)]


@pytest.mark.parametrize("head", ["", "$ Created by Gmsh 4.13.1\n", "$\r\n\n  $ x\n", "PARAM,POST,-1\n", "MAT1    1\n"])
def test_cards_alone_need_no_begin_bulk(head: str, tmp_path: Path) -> None:
    cards = [*grid(HEXAHEDRON), "CHEXA,1,1,1,2,3,4,5,6", ",7,8"]
    part = read_text(tmp_path, "a.bdf", head + "\n".join([*cards, "ENDDATA", ""]))
    assert mass_properties(part, 1.0).mass == pytest.approx(6e-9, rel=1e-14)
    elements_first = "\n".join([*cards[8:], *cards[:8], "ENDDATA", ""]).replace(
        "GRID,1,", "GRID,1,,0.,0.,0. $ x\nGRID,1,"
    )
    assert mass_properties(read_text(tmp_path, "b.bdf", elements_first), 1.0).mass == pytest.approx(6e-9, rel=1e-14)
    with pytest.raises(ReadError, match="it has no ENDDATA line"):
        read_text(tmp_path, "c.bdf", head + "\n".join(cards))
    for line in ("SOL 101", "CEND $", "TITLE = x", "SUBCASE 1"):
        with pytest.raises(ReadError, match="it has no BEGIN BULK line"):
            read_text(tmp_path, "d.bdf", f"{line}\n" + head + "\n".join([*cards, "ENDDATA", ""]))


CORNERS_OF_8 = "".join(f"{k:<8}" for k in (1, 1, 1, 2, 3, 4, 5, 6))


@pytest.mark.parametrize(
    "lines",
    [
        ["CHEXA,1,1,1,2,3,4,5,6", ",7,8"],
        ["CHEXA,1,1,1,2,3,4,5,6,", ",7,8"],
        ["CHEXA,1,1,1,2,3,4,5,6,+a", "+b,7,8"],
        ["CHEXA,1,1,1,2,3,4,5,6", "       ,7,8"],
        ["CHEXA   " + CORNERS_OF_8, "        7       8"],
        ["CHEXA   " + CORNERS_OF_8.rstrip(), "        7       8       "],
        ["CHEXA   " + CORNERS_OF_8 + "        ", "        7       8"],
        ["CHEXA   " + CORNERS_OF_8 + "+A", "+A      7       8"],
        ["CHEXA   " + CORNERS_OF_8, ",7,8"],
        ["CHEXA\t" + CORNERS_OF_8.replace("       ", "\t"), "\t7\t8"],
        ["CHEXA   " + CORNERS_OF_8, "$ between", "", "        7       8"],
    ],
)
def test_nastran_s_continuations_need_no_name(lines: list[str], tmp_path: Path) -> None:
    part = read_text(tmp_path, "a.bdf", bulk(*grid(HEXAHEDRON), *lines))
    assert isinstance(part.geometry, Cells)
    ((kind, nodes),) = [(block.kind, block.nodes.tolist()) for block in part.geometry.blocks]
    assert (kind, nodes) == ("hexahedron", [[*range(8)]])
    assert mass_properties(part, 1.0).mass == pytest.approx(6e-9, rel=1e-14)


def test_a_continued_card_that_is_left_aside_takes_its_lines_along(tmp_path: Path) -> None:
    text = bulk(*grid(HEXAHEDRON[[0, 1, 3, 4]]), "MAT9,1,1.,2.,3.,4.,5.,6.,7.", ",8.,9.", "CTETRA,1,1,1,2,3,4")
    assert mass_properties(read_text(tmp_path, "a.bdf", text), 1.0).mass == pytest.approx(1e-9, rel=1e-15)


TEN = np.array(
    [
        *([0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]),
        *([2, -0.3, -0.3], [2, 2, 0], [-0.3, 2, -0.3], [-0.3, -0.3, 2], [2, 0, 2], [0, 2, 2]),
    ]
)
FIRST, SECOND = "CTETRA,1,1,1,2,3,4,5,6,+A1", "+A1,7,8,9,10"


@pytest.mark.parametrize(
    "lines",
    [
        [FIRST, SECOND],
        [FIRST, "PSOLID,1,1", SECOND],
        [FIRST, "GRID,11,,9.,9.,9.", SECOND],
        [FIRST, "MAT9,1,1.,2.,3.,4.,5.,6.,7.,+B1", "+B1,8.,9.", SECOND],
        [FIRST, "MAT9,1,1.,2.,3.,4.,5.,6.,7.,+B1", SECOND, "+B1,8.,9."],
        [SECOND, FIRST],
        [SECOND, "PSOLID,1,1", FIRST.lower()],
        ["CTETRA,1,1,1,2,3,4,5,6,*A1", "PSOLID,1,1", SECOND],
        ["CTETRA  " + CORNERS_OF_8 + "+A1", "PSOLID,1,1", SECOND],
        ["CTETRA  " + CORNERS_OF_8 + "XA1", "PSOLID,1,1", SECOND],
        ["CTETRA  " + CORNERS_OF_8 + "A1", "PSOLID,1,1", "+A1     7       8       9       10"],
        [FIRST, "PSOLID,1,1", f"*A1     {7:<16}{8:<16}{9:<16}{10:<16}"],
    ],
)
def test_nastran_s_continuations_go_by_their_names(lines: list[str], tmp_path: Path) -> None:
    """The volume is the integral of the quadratic tetrahedron's determinant, by a quadrature apart."""
    part = read_text(tmp_path, "a.bdf", bulk(*grid(TEN), *lines))
    assert isinstance(part.geometry, Cells)
    assert [(block.kind, block.nodes.tolist()) for block in part.geometry.blocks] == [("tetra10", [[*range(10)]])]
    assert mass_properties(part, 1.0).volume == pytest.approx(15.754666666666667e-9, rel=1e-14)


@pytest.mark.parametrize("last", ["       1", "G1", "+1", "1"])
def test_what_points_have_in_their_last_columns_takes_no_line_from_a_card_above(last: str, tmp_path: Path) -> None:
    points = [f"GRID    {n:<8}{'':8}{x:<8}{y:<8}{z:<8}".ljust(72) + last for n, (x, y, z) in enumerate(TEN, 1)]
    lines = ["CTETRA  " + CORNERS_OF_8, "+1      7       8       9       10"]
    part = read_text(tmp_path, "a.bdf", bulk(*points, *lines))
    assert isinstance(part.geometry, Cells)
    assert [block.nodes.tolist() for block in part.geometry.blocks] == [[[*range(10)]]]


def test_a_line_that_two_cards_may_mean_is_refused(tmp_path: Path) -> None:
    lines = ["CTETRA  " + CORNERS_OF_8, "+1      7       8       9       10", "MAT1,1,2.,,.3,,,,,+1"]
    with pytest.raises(ReadError, match=r"may continue 'CTETRA .*', below which it stands, or 'MAT1,1.*: write names"):
        read_text(tmp_path, "a.bdf", bulk(*grid(TEN), *lines))


def test_cards_with_names_stand_beside_cards_without(tmp_path: Path) -> None:
    unnamed = "CTETRA  " + CORNERS_OF_8.replace("1       ", "2       ", 1)
    lines = [unnamed, "+A1     7       8       9       10", FIRST, SECOND]
    part = read_text(tmp_path, "a.bdf", bulk(*grid(TEN), *lines))
    assert isinstance(part.geometry, Cells)
    assert [block.nodes.tolist() for block in part.geometry.blocks] == [[[*range(10)], [*range(10)]]]


def test_continuations_of_a_sorted_deck_find_their_cards(tmp_path: Path) -> None:
    second = [f"CTETRA,2,1,{','.join(map(str, range(11, 17)))},+A2", "+A2,17,18,19,20"]
    text = bulk(*grid(np.concatenate([TEN, TEN + 10])), FIRST, second[0], SECOND, second[1])
    part = read_text(tmp_path, "a.bdf", text)
    assert isinstance(part.geometry, Cells)
    assert [block.nodes.tolist() for block in part.geometry.blocks] == [[[*range(10)], [*range(10, 20)]]]


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ([FIRST, ",7,8,9,10", "PSOLID,1,1", SECOND], "its lines ',7,8,9,10' and '.A1,7,8,9,10' both continue 'CTETRA"),
        ([FIRST, "PSOLID,1,1", SECOND, SECOND], "both continue"),
        (["+A1,7,8,9,10,,,,,+A2", "+A2,1,,,,,,,,+A1", FIRST.replace("A1", "A3")], "continues no card"),
        ([FIRST, FIRST.replace(",1", ",2", 1), "PSOLID,1,1", SECOND], "its name, which 2 lines have as their last"),
    ],
)
def test_continuations_that_could_go_to_several_lines_are_refused(lines: list[str], says: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=says):
        read_text(tmp_path, "a.bdf", bulk(*lines, *grid(TEN)))


@pytest.mark.parametrize(
    "seven", ["7.0", "7.", ".7E1", "0.7+1", ".70+1", "7.E+0", "70.-1", ".7D1", "7.D+0", "70.d-1", "+.7e+01", "7"]
)
@pytest.mark.parametrize("large", [False, True])
def test_reals_of_nastran(seven: str, large: bool, tmp_path: Path) -> None:
    """The Quick Reference Guide's ways of writing 7, those in double precision too; a blank coordinate is 0."""
    point = (
        f"GRID*   {4:<16}{'':<16}{'':<16}{'':<16}\n*       {seven:<16}" if large else f"GRID    {4:<24}{'':<8}{seven}"
    )
    corners = ["GRID,1,,0.,0.,0.", "GRID,2,0,1.,,", "GRID,3,,0.,1.,0.", point]
    part = read_text(tmp_path, "a.bdf", bulk(*corners, "CTETRA,1,1,1,2,3,4"))
    assert isinstance(part.geometry, Cells)
    assert part.geometry.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 7]]
    assert part.rounding is None


@pytest.mark.parametrize("card", NASTRAN_MIDDLES)
@pytest.mark.parametrize("which", ["none", "first", "some", "all but one"])
def test_blank_midside_nodes_are_in_the_middles_of_their_edges(card: str, which: str, tmp_path: Path) -> None:
    """The element's volume is that of the same corners without any; one node that is off its edge counts."""
    kind, order = NASTRAN_MIDDLES[card]
    count = len(MIDDLES[kind])
    corners = HEXAHEDRON[
        {"CTETRA": [0, 1, 3, 4], "CPYRAM": [0, 1, 2, 3, 4], "CPENTA": [0, 1, 3, 4, 5, 7]}.get(card, slice(8))
    ]
    middles = np.array([corners[[*edge]].mean(axis=0) for edge in MIDDLES[kind]])[order]
    given = {"none": [], "first": [0], "some": [1, count - 1], "all but one": [*range(count - 1)]}[which]
    points = np.concatenate([corners, middles[given]])
    names = iter(range(len(corners) + 1, len(points) + 1))
    nodes = [*map(str, range(1, len(corners) + 1)), *(str(next(names)) if k in given else "" for k in range(count))]
    fields = ["1", "1", *nodes]
    lines = [",".join(["" if k else card, *fields[k : k + 8]]) for k in range(0, len(fields), 8)]
    part = read_text(tmp_path, "a.bdf", bulk(*grid(points), *lines))
    assert isinstance(part.geometry, Cells)
    (block,) = part.geometry.blocks
    places = part.geometry.points[block.nodes[0]]
    assert np.array_equal(places[: len(corners)], corners)
    if which == "none":
        assert len(places) == len(corners)
    else:
        assert block.kind == kind
        assert np.array_equal(places[len(corners) :], middles[np.argsort(order)])
    volume = {"CTETRA": 1, "CPYRAM": 2, "CPENTA": 3, "CHEXA": 6}[card]
    assert mass_properties(part, 1.0).mass == pytest.approx(volume * 1e-9, rel=1e-14)


def test_elements_share_the_middle_of_an_edge_and_it_is_in_the_bounds(tmp_path: Path) -> None:
    points = grid(np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.7, 0], [0, 0, 0.3], [0, 0, -0.3], [0.05, 0, 0]]))
    text = bulk(*points, "CTETRA,1,1,1,2,3,4,6", "CTETRA,2,1,1,3,2,5,,", ",6")
    part = read_text(tmp_path, "a.bdf", text)
    assert isinstance(part.geometry, Cells)
    assert len(part.geometry.points) == 6 + 5 + 3
    assert [block.nodes.shape for block in part.geometry.blocks] == [(2, 10)]
    assert part.rounding is not None
    properties = mass_properties(part, 1.0)
    exact = Fraction(2 * 7 * 3, 6 * 1000 * 10**9)
    assert abs(Fraction(properties.mass) - exact) <= exact * Fraction(properties.error.mass)


@pytest.mark.parametrize(("card", "corners"), [("CTRIA6", [0, 1, 2]), ("CQUAD8", [0, 1, 2, 3])])
def test_shells_of_second_order_may_do_without_midside_nodes(card: str, corners: list[int], tmp_path: Path) -> None:
    part = read_text(
        tmp_path, "a.bdf", bulk(*grid(HEXAHEDRON[:4]), f"{card},1,1,{','.join(str(k + 1) for k in corners)}")
    )
    assert part.triangles.count == len(corners) - 2


SHELL_OPTIONS = {
    "CQUAD4": ["3", "45.", ",.0", "3,0.", ",,\n,,,.1,.2,.1,.1"],
    "CQUADR": ["3", "45."],
    "CTRIA3": ["3", "30.,.0", ",,\n,,,.1,.1,.1"],
    "CTRIAR": ["3", "30."],
    "CQUAD8": [",,\n,,,.1,.1,.1,.1,30.", ",,\n,,,,,,,3", ",,\n,,,,,,,3,0."],
    "CTRIA6": [",,\n,3", ",,\n,30.,0.,.1,.1,.1"],
}


@pytest.mark.parametrize(("card", "more"), [(card, more) for card, rest in SHELL_OPTIONS.items() for more in rest])
def test_what_stands_behind_the_nodes_of_a_shell_is_left_aside(card: str, more: str, tmp_path: Path) -> None:
    text = bulk(*grid(HEXAHEDRON), *(f"{card},{k},7,{nodes},{more}" for k, nodes in ((1, "1,2,3,4"), (2, "5,6,7,8"))))
    if card.startswith("CTRI"):
        text = text.replace("1,2,3,4", "1,2,3").replace("5,6,7,8", "5,6,7")
    part = read_text(tmp_path, "a.bdf", text, unit="m")
    assert mass_properties(part, 1, shell=1e-3).volume == pytest.approx(2e-3 if card.startswith("CTRI") else 4e-3)
    assert all("split" in note for note in part.notes)


@pytest.mark.parametrize(
    ("card", "rest"), [("CQUAD4", "1,2,3,4,,.1"), ("CTRIA3", "1,2,3,,-.1"), ("CQUAD8", "1,2,3,4,,,\n,,,,,,,,1.-1")]
)
def test_the_offset_of_a_shell_is_noted(card: str, rest: str, tmp_path: Path) -> None:
    part = read_text(tmp_path, "a.bdf", bulk(*grid(HEXAHEDRON), f"{card},1,7,{rest}"))
    assert "the offset of 1 shell from its nodes was left out" in part.notes


@pytest.mark.parametrize("card", ["CBUSH,3,7,2,3", "CGAP,3,7,2,3,0.,0.,1.", "CELAS1,3,7,2,1,3,1", "CDAMP2*,3,1.,2,1"])
def test_springs_and_gaps_weigh_nothing(card: str, tmp_path: Path) -> None:
    part = read_text(tmp_path, "a.bdf", bulk(*grid(HEXAHEDRON), "CROD,1,7,1,2", card), unit="m")
    assert part.notes == ("1 element without material (spring, damper or gap) was left out",)
    assert mass_properties(part, 1, wire=1e-4).mass == pytest.approx(1e-4)


def test_point_masses_of_nastran_are_noted(tmp_path: Path) -> None:
    masses = ("CONM2,10,1,,100.", "CMASS2,11,5.,2,1")
    part = read_text(tmp_path, "a.bdf", NASTRAN.replace("ENDDATA", "\n".join([*masses, "ENDDATA"])))
    assert part.notes == ("2 elements of concentrated mass were left out",)


def test_nastran_may_be_written_in_lower_case(tmp_path: Path) -> None:
    plain, lower = (read_text(tmp_path, name, text) for name, text in (("a.bdf", NASTRAN), ("b.bdf", NASTRAN.lower())))
    assert isinstance(plain.geometry, Cells)
    assert isinstance(lower.geometry, Cells)
    assert np.array_equal(plain.geometry.points, lower.geometry.points)
    assert np.array_equal(plain.geometry.blocks[0].nodes, lower.geometry.blocks[0].nodes)


def test_a_grid_point_is_in_one_place(tmp_path: Path) -> None:
    again = NASTRAN.replace("CTETRA,2", "GRID,5,,1.1,11.-1,1.10\nCTETRA,2")
    assert names_of(read_text(tmp_path, "a.bdf", again)) == ["7", "8"]
    with pytest.raises(ReadError, match="defines GRID 5 twice, in two places"):
        read_text(tmp_path, "b.bdf", again.replace("11.-1", "1.2"))


def refused(folder: Path, card: str, match: str) -> None:
    with pytest.raises(ReadError, match=match):
        read_text(folder, "a.bdf", NASTRAN.replace("ENDDATA", f"{card}\nENDDATA"))


@pytest.mark.parametrize("card", ["CONROD,3,1,2,7,1.", "CTUBE,3,7,1,2", "CBEND,3,7,1,2", "CQUAD4,3,7,1,2,3"])
def test_other_elements_of_nastran_are_refused(card: str, tmp_path: Path) -> None:
    refused(tmp_path, card, r"is not read: write|it needs 4 corners; export")


@pytest.mark.parametrize(
    "name",
    [
        *("CIHEX1", "CIHEX2", "cihex3", "CWEDGE", "CHEXA1", "CIFHEX", "CTRMEM", "CTRPLT1", "CQDMEM2", "CPLSTS4"),
        *("CTRIAX6", "CTRAX6", "CTRIAX", "CQUADX8"),  # sections of bodies of revolution
    ],
)
def test_elements_of_other_versions_of_nastran_are_refused(name: str, tmp_path: Path) -> None:
    refused(tmp_path, f"{name},3,1,1,2,3,4", f"its card '{name}' is not read: write solids as CTETRA")


def test_large_fields_and_meshio_s_slips_have_remedies_of_their_own(tmp_path: Path) -> None:
    refused(tmp_path, "CTETRA* 3", r"'CTETRA\*' is not read: write elements in small or free field")
    refused(tmp_path, "CTETRA_ 3       1", "'CTETRA_' is not read: Nastran has no such name.* save the mesh as VTU")
    refused(tmp_path, "CHEXA_* 3", r"'CHEXA_\*' is not read: Nastran has no such name")


@pytest.mark.parametrize("line", ["=,*1,=,1,3,2,5", "=,*(1),==", "=3", "=(3)", "=       *1      =       1       3"])
def test_cards_that_repeat_others_are_refused(line: str, tmp_path: Path) -> None:
    refused(tmp_path, line, f"its card '{re.escape(line)}', which repeats the card before it, is not read")


@pytest.mark.parametrize("card", ["BEGIN SUPER=1", "BEGIN BULK SUPER=2", "CSUPER,1,2", "SELOC,1,2", "CGEN,TET,1"])
def test_cards_that_make_or_move_grid_points_are_refused(card: str, tmp_path: Path) -> None:
    refused(tmp_path, card, "its card '(BEGIN|CSUPER|SELOC|CGEN)' is not read: write the bulk data out in full")
