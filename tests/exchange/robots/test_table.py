"""Lists of parts as CSV and TOML."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.exchange import solid

import inertia
from inertia.exchange.robots.links import Figures
from inertia.exchange.robots.read import read_robot

CSV = """name, mass, com_x, com_y, com_z, ixx, iyy, izz, ixy, ixz, iyz, mesh, unit, products, #remark
arm, 1.25, 0.1, -0.02, 0.3, 0.010, 0.02, 0.025, 0.001, -2e-3, 0.003, arm.stl, mm, , first
"hand, left", 0.5, , , , 1, 2, 2.5, 0.1, 0.2, 0.3, , , integrals, second
"""
TOML = """
[[part]]
name = "arm"
mass = 1.25
center_of_mass = [0.1, -0.02, 0.3]
inertia = [[0.01, 0.001, -0.002], [0.001, 0.02, 0.003], [-0.002, 0.003, 0.025]]
mesh = "arm.stl"
unit = "mm"

[[part]]
name = "hand, left"
mass = 0.5
inertia = [[1, 0.1, 0.2], [0.1, 2, 0.3], [0.2, 0.3, 2.5]]
products = "integrals"
"""


@pytest.mark.parametrize(("name", "content"), [("parts.csv", CSV), ("parts.toml", TOML)])
def test_both_say_the_same(tmp_path: Path, name: str, content: str) -> None:
    file = tmp_path / name
    file.write_text(content)
    arm, hand = read_robot(file).links
    assert (arm.name, hand.name) == ("arm", "hand, left")
    assert arm.inertial is not None
    assert hand.inertial is not None
    assert arm.inertial.mass == 1.25
    assert arm.inertial.placement.origin.tolist() == [0.1, -0.02, 0.3]
    assert arm.inertial.inertia.tolist() == [[0.01, 0.001, -0.002], [0.001, 0.02, 0.003], [-0.002, 0.003, 0.025]]
    assert arm.inertial.figures == (Figures(2, 1), Figures(3, 2))
    assert hand.inertial.placement.origin.tolist() == [0, 0, 0]
    assert hand.inertial.inertia.tolist() == [[1, -0.1, -0.2], [-0.1, 2, -0.3], [-0.2, -0.3, 2.5]]
    (mesh,) = arm.geometries
    assert (mesh.shape, mesh.scale) == (tmp_path / "arm.stl", (Fraction(1, 1000),) * 3)
    assert hand.geometries == ()


def test_what_is_written_is_read_to_the_bit(tmp_path: Path) -> None:
    body = solid.properties(tmp_path)
    file = tmp_path / "parts.csv"
    file.write_text(inertia.export({"arm": body, "hand": body.with_mass(0.1)}, "csv"))
    arm, hand = read_robot(file).links
    assert arm.inertial is not None
    assert hand.inertial is not None
    assert (arm.inertial.mass, hand.inertial.mass) == (body.mass, 0.1)
    assert arm.inertial.placement.origin.tolist() == body.center_of_mass.tolist()
    assert np.array_equal(arm.inertial.inertia, body.inertia)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.csv", "", "it is empty: export the robot again"),
        ("a.csv", "a,b\n", "names no column name"),
        ("a.csv", "name,mass\n", "names no column ixx"),
        ("a.csv", CSV.replace("\n", ",Mass\n", 1), "names the column `mass` twice: leave one out"),
        ("a.csv", CSV.replace(" unit", " units"), "units is unknown: did you mean unit?"),
        ("a.csv", CSV.replace(" mesh", " msh"), "msh is unknown: did you mean mesh?"),
        ("a.csv", CSV.replace(" products", " prodcts"), "prodcts is unknown: did you mean products?"),
        ("a.csv", CSV.replace(" com_x", " comx"), "comx is unknown: did you mean com_x?"),
        (
            "a.csv",
            CSV.replace(" unit", ""),
            "line 2 has 'mm' in a column that the first line does not name: name that column, or leave it out",
        ),
        (
            "a.csv",
            f",{CSV}".replace("\narm", "\n7,arm"),
            "line 2 has '7' in a column that the first line does not name",
        ),
        ("a.csv", CSV.replace("1.25", "1_25"), "line 2.mass is '1_25': it must be a number"),
        ("a.csv", CSV.partition("\n")[0] + "\n", "it holds no part: give each a row"),
        ("a.csv", CSV.replace("1.25", "x"), "line 2.mass is 'x': it must be a number"),
        ("a.csv", CSV.replace("1.25", "nan"), "line 2.mass is nan: it must be finite"),
        ("a.csv", CSV.replace("0.1, -0.02,", ",-0.02,"), "line 2.com_x is ''"),
        ("a.csv", CSV.replace(" mm", " furlong"), "line 2.unit is not usable"),
        ("a.csv", CSV.replace("integrals", "positive"), "line 3.products is 'positive': use one of"),
        ("a.csv", CSV.replace('"hand, left"', "arm"), "line 3.name is 'arm', as that of another part"),
        ("a.csv", 'name,mass,ixx,iyy,izz,ixy,ixz,iyz\n"a\n', "line 2"),
        ("a.toml", "x = ", "it is not TOML"),
        ("a.toml", "part = 3", "give each as [[part]]"),
        ("a.toml", TOML.replace("mass = 1.25", ""), "part[0].mass is missing"),
        ("a.toml", TOML.replace("mass = 1.25", "mas = 1.25"), "part[0].mas is unknown: did you mean mass?"),
        ("a.toml", 'unit = "mm"\n' + TOML, "unit is unknown: use part"),
        ("a.toml", "part = [1]", "part[0] is 1: it must be a table"),
        (
            "a.toml",
            "part = [{name='a', mass=1, inertia=[[1, 0.02, 0], [-0.02, 1, 0], [0, 0, 1]]}]",
            "part[0].inertia is not usable: inertia is not symmetric: 0.02 at [0][1] and -0.02 at [1][0]",
        ),
        ("a.toml", "part = [{name='a', mass=1, inertia=[1, 2]}]", "part[0].inertia has 2 entries"),
    ],
)
def test_faults(tmp_path: Path, name: str, content: str, says: str) -> None:
    file = tmp_path / name
    file.write_text(content)
    with pytest.raises((inertia.ReadError, inertia.UsageError), match=f"cannot read {file}") as fault:
        read_robot(file)
    assert says in str(fault.value)


def test_columns_of_remarks_may_be_called_the_same_and_an_index_has_no_name(tmp_path: Path) -> None:
    file = tmp_path / "parts.csv"
    lines = CSV.splitlines()
    file.write_text(f",{lines[0]},#,#\n0,{lines[1]},a,b\n1,{lines[2]}\n")  # as `DataFrame.to_csv` writes it
    assert [link.name for link in read_robot(file).links] == ["arm", "hand, left"]


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ("name,mass\na,1\n", 2),
        (CSV.replace(" unit", " units"), 2),
        ("part = [{name='a'}]", 2),
        (CSV.replace("\n", ",Mass\n", 1), 3),
        ("part = [{name='a', name='b'}]", 3),
    ],
)
def test_a_field_that_is_not_usable_has_the_code_of_fields(tmp_path: Path, content: str, code: int) -> None:
    file = tmp_path / ("a.toml" if content.startswith("part") else "a.csv")
    file.write_text(content)
    with pytest.raises(inertia.InertiaError) as fault:
        read_robot(file)
    assert fault.value.exit_code == code


def test_a_line_that_tells_spreadsheets_the_separator_is_passed_over(tmp_path: Path) -> None:
    file = tmp_path / "parts.csv"
    file.write_text("sep=;\nname;mass;ixx;iyy;izz;ixy;ixz;iyz\narm;1.5;1;2;2.5;0;0;0\n")
    assert [link.name for link in read_robot(file).links] == ["arm"]


def test_text_of_another_encoding_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_bytes("näme".encode("latin-1"))
    with pytest.raises(inertia.ReadError, match="no text in UTF-8"):
        read_robot(file)


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_other_separators_and_capitals(tmp_path: Path, delimiter: str) -> None:
    file = tmp_path / "parts.csv"
    file.write_text("Name,Mass,Ixx,Iyy,Izz,Ixy,Ixz,Iyz\narm,1.5,1,2,2.5,0,0,0.1\n".replace(",", delimiter))
    (arm,) = read_robot(file).links
    assert arm.inertial is not None
    assert arm.inertial.inertia.tolist() == [[1, 0, 0], [0, 2, 0.1], [0, 0.1, 2.5]]


def test_cells_without_a_name_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "parts.csv"
    file.write_text("name,mass,ixx,iyy,izz,ixy,ixz,iyz\narm,1,5,1,2,2,0,0,0\n")  # 1,5 is one and a half
    with pytest.raises(inertia.ReadError, match=r"line 2 has 9 cells, and the first line 8 names: .* decimal point"):
        read_robot(file)
