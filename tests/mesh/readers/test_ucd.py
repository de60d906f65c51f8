"""AVS UCD: a box of 2 × 3 × 4, of six tetrahedra around a diagonal, and what is wrong about it."""

from pathlib import Path

import pytest

from inertia import mass_properties
from inertia.errors import ReadError
from inertia.mesh.read import read

NODES = "".join(f"{k + 1} {2 * (k & 1)} {3 * (k >> 1 & 1)} {4 * (k >> 2)}\n" for k in range(8))
CELLS = "".join(
    f"{k} 1 tet 1 {nodes} 8\n" for k, nodes in enumerate(("2 4", "4 3", "3 7", "7 5", "5 6", "6 2"), start=1)
)
BOX = "8 6 0 0 0\n" + NODES + CELLS
HEX = "8 1 0 0 0\n" + NODES + "1 1 hex 5 6 8 7 1 2 4 3\n"
OF_NODES = "2 1 1\ns, none\n#t, none\n" + "".join(f"{k + 1} 0.5 1\n" for k in range(8))
OF_CELLS = "1 1\nm, none\n" + "".join(f"{k + 1} 2\n" for k in range(6))


@pytest.mark.parametrize(
    "text",
    [
        BOX,
        HEX,
        "# made\n" + BOX.replace("1 1 tet", "\n1 1 tet", 1),
        BOX.replace("tet", "TET"),
        BOX.replace("6 0 0 0", "6 2 1 0") + OF_NODES + OF_CELLS,
        BOX.replace("6 0 0 0", "6 0 0 1") + "1 m 0.5\n",
        BOX.replace("6 0 0 0", "6 2 1 0") + OF_NODES.replace("0.5", "0.5\n") + OF_CELLS.replace("2\n", "2 "),
    ],
)
@pytest.mark.parametrize("name", ["a.avs", "a.inp", "a"])
def test_the_box_is_read(text: str, name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    part = read(tmp_path / name, unit="m")
    assert part.notes == ()
    properties = mass_properties(part, 1.0)
    assert properties.mass == pytest.approx(24, rel=1e-15)
    assert properties.center_of_mass == pytest.approx([1, 1.5, 2], rel=1e-15)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (BOX.replace("8 6 0", "8 4 0"), "'5 1 tet 1 5 6 8' stands behind the 4 cells"),
        (BOX.replace("8 6 0", "8 7 0"), "counts 8 nodes and 7 cells, but it holds 8 and 6"),
        (BOX.replace("8 6 0", "8 4 1"), "its data are not as many as its header counts"),
        (BOX.replace("6 0 0 0", "6 1 0 0") + OF_NODES[:-9], "its data are not as many as its header counts"),
        (BOX.replace("6 0 0 0", "6 1 0 0") + OF_NODES.replace("2 1 1", "2 1"), "its data are not as many"),
        (BOX.replace("6 0 0 0", "6 1 0 0") + OF_NODES + "9 0.5 1\n", "stands behind the 6 cells and the data"),
        (BOX.replace("6 0 0 0", "6 0 0"), "its header is '8 6 0 0', not five counts"),
        (BOX.replace("8 6", "9 6").replace("2 2 0", "1 0.5 0.5 0.5\n2 2 0"), "defines node 1 twice"),
        (BOX.replace("2 2 0 0", "2.7 2 0 0"), "'2.7', which is not a whole number"),
        (BOX.replace("2 2 0 0", "2 2 0,0 0"), "'0,0', which is not a number"),
        (BOX.replace("2 2 0 0", "2 2 0 0 0"), "three coordinates"),
        (BOX.replace("tet 1 2 4 8", "tet 1 2 4 8 1"), "has 5 nodes, not 4"),
        (HEX.replace("4 3\n", "4 3 1\n"), "has 9 nodes, not 8"),
        (BOX[:-2], "has 3 nodes, not 4"),
        (BOX[: BOX.rindex("tet")], "'6 1' has no kind that is read"),
        (BOX.replace("1 1 tet", "1 1 tet10"), "has no kind that is read"),
        (BOX.replace("tet 1 2 4 8", "tet 1 2 4 9"), "name node 9, which it does not define"),
    ],
)
def test_rows_that_do_not_agree_with_the_header_are_refused(text: str, reason: str, tmp_path: Path) -> None:
    (tmp_path / "a.avs").write_text(text)
    with pytest.raises(ReadError, match=reason):
        read(tmp_path / "a.avs")
