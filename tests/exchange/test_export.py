"""What stands in the files of other programs: signs and order by their manuals, names, comments, digits."""

import csv
import importlib.util
import io
import re
from fractions import Fraction
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.exchange import solid

import inertia
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.export import WRITERS
from inertia_cli.main import build_parser, main
from inertia_meshes import path

NUMBER = r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?"
X, Y, Z = 0, 1, 2
XX, YY, ZZ = map(float, solid.MOMENTS)
XY, XZ, YZ = (float(solid.INTEGRALS[i][j]) for i, j in ((X, Y), (X, Z), (Y, Z)))  # positive integrals
NASTY = 'a "b" & <c> --> */ \n*END\n$\x07 ü'


@pytest.fixture
def body(tmp_path: Path) -> inertia.MassProperties:
    return solid.properties(tmp_path)


def near(*values: float) -> list:
    return [pytest.approx(value, rel=2e-14) for value in values]


def statements(text: str, comment: str) -> str:
    """Return a text without its lines of comments."""
    return "\n".join(line for line in text.splitlines() if not line.startswith(comment))


def test_adams_takes_positive_integrals(body: inertia.MassProperties) -> None:
    text = re.sub(r"\n,", ",", statements(inertia.export(body, "adams", name="arm"), "!"))
    units, part, marker = text.splitlines()
    assert units == "UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND"
    said = re.fullmatch(r"PART/2, MASS=(\S+), CM=201, IP=(.*)", part)
    assert said
    assert float(said[1]) == body.mass
    assert [float(k) for k in said[2].split(",")] == near(XX, YY, ZZ, XY, XZ, YZ)
    assert [float(k) for k in marker.removeprefix("MARKER/201, PART=2, QP=").split(",")] == body.center_of_mass.tolist()


def test_statements_of_adams_stay_within_eighty_columns(body: inertia.MassProperties) -> None:
    lines = statements(inertia.export(body.with_mass(1.2345678901234567e-105), "adams"), "!").splitlines()
    assert max(map(len, lines)) <= 80


def test_nastran_takes_positive_integrals_in_fields_of_sixteen_columns(body: inertia.MassProperties) -> None:
    lines = statements(inertia.export(body, "nastran", name="arm"), "$").splitlines()
    fields = [line[k : k + 16].strip() for line in lines for k in range(8, 72, 16)]
    assert [line[:8].strip() for line in lines] == ["GRID*", "*", "CONM2*", "*", "*", "*"]
    assert fields[:5] == ["1", "", "0.", "0.", "0."]
    assert fields[8:11] == ["1", "1", "0"]
    values = [float(re.sub(r"(?<=.)([-+])", r"e\1", k)) for k in (*fields[11:15], *fields[16:22])]
    exact = [float(solid.MASS), *map(float, solid.CENTRE), XX, XY, YY, XZ, YZ, ZZ]
    assert values == [pytest.approx(k, rel=1e-11) for k in exact]


def test_abaqus_takes_elements_at_a_node_at_the_centre_of_mass(body: inertia.MassProperties) -> None:
    lines = statements(inertia.export(body, "abaqus", name="upper arm"), "**").splitlines()
    assert [line for line in lines if line.startswith("*")] == [
        "*NODE",
        "*ELEMENT, TYPE=MASS, ELSET=upper_arm_MASS",
        "*MASS, ELSET=upper_arm_MASS",
        "*ELEMENT, TYPE=ROTARYI, ELSET=upper_arm_INERTIA",
        "*ROTARY INERTIA, ELSET=upper_arm_INERTIA",
    ]
    data = [[float(k) for k in line.split(",")] for line in lines if not line.startswith("*")]
    node, mass_element, mass, rotary_element, rotary = data
    assert node == near(1, *map(float, solid.CENTRE))
    assert (mass_element, rotary_element) == ([1, 1], [2, 1])
    assert mass == near(float(solid.MASS))
    assert rotary == near(XX, YY, ZZ, -XY, -XZ, -YZ)
    assert max(len(k.strip()) for line in lines if line[0] != "*" for k in line.split(",")) <= 20


def test_modelica_takes_elements(body: inertia.MassProperties) -> None:
    text = inertia.export(body, "modelica", name="upper arm")
    assert re.search(r"^model upper_arm\n  extends Modelica.Mechanics.MultiBody.Parts.Body\(\n", text, re.MULTILINE)
    assert text.endswith(");\nend upper_arm;\n")
    values = {name: float(value) for name, value in re.findall(rf"(I_\d\d|m) = ({NUMBER})", text)}
    assert values.pop("m") == body.mass
    assert values == dict(
        zip(("I_11", "I_22", "I_33", "I_21", "I_31", "I_32"), near(XX, YY, ZZ, -XY, -XZ, -YZ), strict=True)
    )
    centre = re.search(r"r_CM = \{(.*)\}", text)
    assert centre
    assert [float(k) for k in centre[1].split(",")] == body.center_of_mass.tolist()


def test_simscape_takes_elements_in_an_order_of_its_own(body: inertia.MassProperties) -> None:
    text = inertia.export(body, "simscape", name="upper arm")
    rows = {name: [float(k) for k in row.split()] for name, row in re.findall(r"upper_arm\.(\w+) = \[?([^;\]]*)", text)}
    assert rows == {
        "Mass": [body.mass],
        "CenterOfMass": body.center_of_mass.tolist(),
        "MomentsOfInertia": near(XX, YY, ZZ),
        "ProductsOfInertia": near(-YZ, -XZ, -XY),
    }


def test_a_table_says_its_convention(body: inertia.MassProperties) -> None:
    (row,) = csv.DictReader(io.StringIO(inertia.export(body, "csv", name='a, "b"')))
    assert row["name"] == 'a, "b"'
    assert [float(row[k]) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")] == near(XX, YY, ZZ, -XY, -XZ, -YZ)
    assert [float(row[f"com_{k}"]) for k in "xyz"] == body.center_of_mass.tolist()
    assert float(row["error_inertia"]) == body.error.inertia
    assert "-integral" in row["convention"]


@pytest.mark.parametrize("target", ["urdf", "sdf", "modelica", "simscape", "adams", "abaqus", "drake", "csv", "mjcf"])
def test_numbers_read_back_as_the_same_float64(body: inertia.MassProperties, target: str) -> None:
    text = inertia.export(body, target)
    there = {abs(float(word)) for word in re.findall(NUMBER, text)}
    elements = body.principal_moments if target == "mjcf" else body.inertia
    values = {abs(value) for value in (body.mass, *body.center_of_mass.tolist(), *elements.ravel().tolist())}
    if target == "abaqus":  # as many digits as 20 characters hold
        there, values = ({float(f"{value:.14g}") for value in numbers} for numbers in (there, values))
    assert values <= there


@pytest.mark.parametrize("target", WRITERS)
@pytest.mark.parametrize("name", ["world", "__model__", "end", "2nd", "ü", " x ", NASTY])
def test_a_name_of_any_kind_stays_a_name(body: inertia.MassProperties, target: str, name: str) -> None:
    text = inertia.export(body, target, name=name, comments=[NASTY])
    plain = inertia.export(body, target, name="plain", comments=["plain"])
    if target in ("urdf", "sdf", "mjcf"):
        root = ElementTree.fromstring(text)
        assert [each.tag for each in root.iter()] == [each.tag for each in ElementTree.fromstring(plain).iter()]
    elif target == "csv":
        assert len(list(csv.reader(io.StringIO(text)))) == 2
    else:
        assert len(text.splitlines()) == len(plain.splitlines())
        assert text.isascii()


def test_names_that_become_one_are_told_apart(body: inertia.MassProperties) -> None:
    text = inertia.export({"arm a": body, "arm-a": body, "ARM_A": body}, "usd")
    assert re.findall(r'def Xform "(\w+)"', text) == ["arm_a", "arm_a_2", "ARM_A_3"]


@pytest.mark.parametrize(
    ("target", "names", "written"),
    [
        ("urdf", ["world", "arm"], ["world_", "arm"]),  # Drake takes a link of that name for the world
        ("urdf", ["world", "world_"], ["world__", "world_"]),
        ("mjcf", ["world", "world_"], ["world__", "world_"]),
        ("mjcf", ["a\ufffe", "a_"], ["a__", "a_"]),  # no character of XML
        ("sdf", ["a::b", "a_b"], ["a_b_", "a_b"]),
        ("sdf", ["a::b", "a_::b", "a__b"], ["a_b", "a__b_", "a__b"]),
        ("sdf", ["__model__", "____"], ["part__model__", "part____"]),  # SDFormat reserves them
    ],
)
def test_names_in_xml_are_free_and_told_apart(
    body: inertia.MassProperties, target: str, names: list[str], written: list[str]
) -> None:
    root = ElementTree.fromstring(inertia.export(dict.fromkeys(names, body), target))
    links = root.iter("body" if target == "mjcf" else "link")
    assert [each.get("name") for each in links if each.get("name") != "root"] == written
    if target == "urdf":
        assert [each.get("link") for each in root.iter("child")] == written


@pytest.mark.parametrize("target", WRITERS)
def test_several_bodies_stand_in_one_file(body: inertia.MassProperties, target: str) -> None:
    light = body.with_mass(0.3125)
    text = inertia.export({"upper": body, "lower": light}, target)
    assert {"upper", "lower"} <= set(re.findall(r"[a-z]+", text))
    assert "0.3125" in text


@pytest.mark.parametrize("target", [target for target in WRITERS if target != "csv"])
def test_letters_beyond_ascii_stand_in_comments_as_escapes(body: inertia.MassProperties, target: str) -> None:
    text = inertia.export(body, target, name="größe 腕", comments=["größer"])
    assert r"Bounds of gr\xf6\xdfe \u8155: mass" in text
    assert r"gr\xf6\xdfer" in text


@pytest.mark.parametrize("target", [target for target in WRITERS if target != "csv"])
def test_convention_and_bounds_stand_beside_the_numbers(body: inertia.MassProperties, target: str) -> None:
    text = inertia.export(body, target, name="arm", comments=["Density 2700 kg/m³"])
    assert "Density 2700 kg/m^3" in text
    assert body.error.method in text
    stated = re.search(
        r"Bounds of arm: mass (\S+), tensor (\S+) \(relative, Frobenius norm\), centre of mass (\S+) m", text
    )
    assert stated
    assert float(stated[1]) >= body.error.mass
    assert body.error.inertia <= float(stated[2]) <= 1.1 * body.error.inertia
    assert float(stated[3]) >= body.error.center_of_mass
    sign = {"elements": "-integral of", "integrals": "+integral of", "none": "principal moments"}
    assert sign[CONVENTIONS[target].products] in text


def test_what_a_format_loses_is_said(body: inertia.MassProperties) -> None:
    assert "float32" in inertia.export(body, "usd")
    said = re.search(r"no number is rounded by more than (\S+) of itself", inertia.export(body, "nastran"))
    assert said
    assert 1e-13 < float(said[1]) < 1e-11


def test_a_mass_that_counts_as_not_given_is_refused() -> None:
    dust = inertia.point_masses([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [1e-50] * 4)
    with pytest.raises(inertia.UsageError, match=r"of dust, 1\.25e-50, is beyond float32"):
        inertia.export(dust, "usd", name="dust")


def test_every_row_says_what_it_has_to() -> None:
    for name, row in CONVENTIONS.items():
        assert row.source
        assert row.fields
        assert (row.products == "none") == (row.order == ())
        if row.order:
            axes = [frozenset(pair.translate(str.maketrans("123", "xyz"))) for pair in row.order]
            assert len(set(axes)) == 6, name
    assert list(CONVENTIONS)[: len(WRITERS)] == list(WRITERS)


@pytest.mark.parametrize("name", [name for name, row in CONVENTIONS.items() if row.order])
def test_elements_and_tensor_are_inverse(name: str) -> None:
    tensor = np.array([[7.0, -1.0, 2.0], [-1.0, 8.0, -3.0], [2.0, -3.0, 9.0]])
    row = CONVENTIONS[name]
    assert row.tensor(row.elements(tensor)).tolist() == tensor.tolist()


@pytest.mark.parametrize(
    ("target", "says"),
    [("udrf", "did you mean 'urdf'"), ("unreal", "nothing is written for unreal"), ("", "choose one of urdf, sdf")],
)
def test_an_unknown_format_is_refused(body: inertia.MassProperties, target: str, says: str) -> None:
    with pytest.raises(inertia.UsageError, match=says):
        inertia.export(body, target)


@pytest.mark.parametrize(
    ("what", "name", "says"),
    [("part.stl", "a", "is a str"), ({}, "a", "nothing to write"), (None, "a", "NoneType"), ("body", " ", "name is")],
)
def test_what_is_no_body_is_refused(body: inertia.MassProperties, what: object, name: str, says: str) -> None:
    with pytest.raises(inertia.UsageError, match=says):
        inertia.export(body if what == "body" else what, "urdf", name=name)  # type: ignore[arg-type]


def test_the_page_has_the_table_of_conventions() -> None:
    docs = Path(inertia.__file__).resolve().parents[2] / "docs"
    spec = importlib.util.spec_from_file_location("list_conventions", docs / "list_conventions.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    written = (docs / "exchange.md").read_text(encoding="utf-8")
    assert written == module.page(), "run python docs/list_conventions.py"


def test_the_help_names_every_format() -> None:
    analyse = next(a for a in build_parser()._actions if a.dest == "run" or a.choices).choices["analyse"]
    says = next(action.help for action in analyse._actions if "--as" in action.option_strings)
    assert set(WRITERS) <= set(re.findall(r"\w+", says))


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(["analyse", str(path("t_handle.stl")), *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_the_command_prints_and_writes_the_same(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "handle.urdf"
    code, printed, errors = said(capsys, "--as", "urdf", "--material", "steel")
    assert (code, errors) == (0, "")
    assert said(capsys, "--as", "urdf", "--material", "steel", "-o", str(file)) == (0, "", "")
    assert file.read_text() == printed
    assert '<link name="t_handle">' in printed
    assert "7850 kg/m^3 (of the material given)" in printed
    assert "mm (assumed" in printed


def test_a_dash_is_standard_output_and_a_file_with_its_folder_alone(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    printed = said(capsys, "--as", "csv")
    assert said(capsys, "--as", "csv", "-o", "-") == printed
    assert list(tmp_path.iterdir()) == []
    assert said(capsys, "--as", "csv", "-o", "./-") == (0, "", "")
    assert Path("-").read_text() == printed[1]


def test_the_command_writes_over_no_file_unasked(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "handle.urdf"
    file.write_text("mine")
    code, _, errors = said(capsys, "--as", "urdf", "-o", str(file))
    assert code == 2
    assert "exists: give another name, or --force" in errors
    assert file.read_text() == "mine"
    assert said(capsys, "--as", "urdf", "-o", str(file), "--force")[0] == 0
    assert file.read_text() != "mine"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--as", "urfd"], "did you mean 'urdf'"),
        (["--as", "urdf", "--json"], "--as has no room for --json"),
        (["--as", "urdf", "--about", "0,0,0"], "--as has no room for --about"),
        (["-o", "x.urdf"], "name that with --as"),
        (["--name", "x"], "name that with --as"),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    capsys: pytest.CaptureFixture[str], arguments: list[str], says: str
) -> None:
    code, out, errors = said(capsys, *arguments)
    assert (code, bool(out)) == (2, "--json" in arguments)  # which prints the refusal as a document
    assert says in errors


def test_the_tessellation_stands_in_the_comments(capsys: pytest.CaptureFixture[str]) -> None:
    _, printed, _ = said(capsys, "--as", "sdf", "--chord", "0.05")
    assert "Tessellation      volume" in printed


def test_exact_oracle_is_exact() -> None:
    assert all(isinstance(value, Fraction) for row in solid.INTEGRALS for value in row)
