"""Names from outside (files, regions, fields, ids) steer no terminal, forge no line, and are no formula."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import inertia
from inertia.errors import visible
from inertia_cli.main import main
from inertia_meshes import path

NASTY = "\x1b]0;title\x07\x1b[31mred\rback\nMass  0 kg\x9b1m\u202egnp\u2028\udc80<script>"
FILE = NASTY  # no slash and no zero byte: a name that a file can have
UNSAFE = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
SHOWN = r"\u001b]0;title\u0007\u001b[31mred\u000dback\u000aMass  0 kg\u009b1m\u202egnp\u2028\udc80<script>"  # one line


def run(capsys: pytest.CaptureFixture[str], code: int, *arguments: object) -> str:
    """Run a command in this process; return what it printed, known to steer nothing."""
    try:
        status = main([str(word) for word in arguments])
    except SystemExit as leaving:
        status = leaving.code
    out, errors = capsys.readouterr()
    assert status == code, errors
    assert not UNSAFE.search(out + errors)
    assert not re.search("^Mass  0 kg", out + errors, re.MULTILINE)
    assert errors.count("\n") == (1 if code else 0)
    return errors if code else out


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A cube in a file whose name is nasty."""
    file = tmp_path / f"{FILE}.stl"
    shutil.copy(path("cube.stl"), file)
    return file


def boxes(*names: str) -> bytes:
    """Return unit cubes side by side as OBJ, an object each."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    quads = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x + 3 * k} {y} {z}" for k in range(len(names)) for x, y, z in corners]
    for k, name in enumerate(names):
        lines += [f"o {name}", *("f " + " ".join(str(corner + 8 * k) for corner in quad) for quad in quads)]
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def test_what_is_shown_of_a_name_is_one_line() -> None:
    assert visible(NASTY) == SHOWN
    for name in ("plain", "größe 魚 \u0641\u200c", "a b", "back\\slash", "\U0001f600"):
        assert visible(name) == name
    assert visible("\U000e0041\t") == r"\U000e0041\u0009"


@pytest.mark.parametrize("verb", ["analyse", "check"])
def test_text_shows_the_name_of_a_file(verb: str, part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert f"{SHOWN}.stl (stl)" in run(capsys, 0, verb, part)


@pytest.mark.parametrize("verb", ["analyse", "check"])
def test_json_holds_the_name_itself(verb: str, part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert json.loads(run(capsys, 0, verb, part, "--json"))["source"]["path"] == str(part)


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_json_is_json_in_every_encoding(encoding: str, tmp_path: Path) -> None:
    file = tmp_path / "größe\U0001f600\x9b\udc80.stl"
    shutil.copy(path("cube.stl"), file)
    printed = subprocess.run(
        [sys.executable, "-c", "from inertia_cli.main import run; run()", "analyse", str(file), "--json"],
        env={**os.environ, "PYTHONIOENCODING": encoding}, capture_output=True, check=True,
    ).stdout.decode(encoding)  # fmt: skip
    assert json.loads(printed)["source"]["path"] == str(file)
    assert ("ö" in printed) == (encoding == "utf-8")
    assert not UNSAFE.search(printed)


def test_sentences_show_names_and_values(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    missing = part.with_name(f"no{FILE}")
    said = run(capsys, 3, "analyse", missing)
    assert said == f"inertia: cannot read {missing.parent}/no{SHOWN}: there is no such file: check the path\n"
    part.write_bytes(b"solid")
    assert SHOWN in run(capsys, 3, "analyse", part)
    shutil.copy(path("cube.stl"), part)
    for option in ("--unit", "--material", "--density", "--about", "--accuracy", "--weld", "-o"):
        run(capsys, 2, "analyse", part, option, NASTY)
    for words in ((NASTY,), ("analyse", part, NASTY), ("analyse", part, f"--{NASTY}"), ("play", part, "--as", NASTY)):
        run(capsys, 2, *words)
    run(capsys, 3, "play", part.with_suffix(".rrd"))


def test_regions_are_named_as_they_may_be_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nasty = re.sub("[\r\n\u2028\udc80]", "", NASTY)
    file = tmp_path / "boxes.obj"
    file.write_bytes(boxes(nasty, "=b"))
    names = (visible(nasty), "=b")
    assert inertia.read(file).regions.names == names
    assert ", ".join(names) in run(capsys, 0, "analyse", file)
    document = json.loads(
        run(capsys, 0, "analyse", file, "--density", f"{names[0]}=2000", "--density", "=b=1000", "--json")
    )
    assert names[0] in json.dumps(document, ensure_ascii=False).replace("\\\\", "\\")
    run(capsys, 0, "check", file)
    mesh = inertia.read(file).to_trimesh()
    mesh.face_attributes["region"] = [NASTY] * len(mesh.faces)
    assert inertia.Part.from_trimesh(mesh).regions.names == (SHOWN,)


@pytest.mark.parametrize(
    "target", ["urdf", "sdf", "mjcf", "usd", "modelica", "nastran", "adams", "abaqus", "drake", "csv"]
)
def test_exports_hold_no_control_character(target: str, part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(capsys, 0, "analyse", part, "--as", target)


@pytest.mark.parametrize("name", ["=1+1", "+A1", "-A1", "@SUM(1)", "=cmd|' /C calc'!A0", "＝1", "  =1", "-", '="a",b'])
def test_a_name_in_csv_is_no_formula(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    table = run(capsys, 0, "analyse", path("cube.stl"), "--as", "csv", f"--name={name}")
    _, row = csv.reader(table.splitlines())
    assert row[0] == f"'{name}"
    assert all(float(cell) is not None for cell in row[1:14])


def test_the_csv_of_a_balance_holds_no_formula(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = shutil.copytree(path("rotors/two_disc_rotor.toml").parents[1], tmp_path / "samples")
    rotor = folder / "rotors" / "two_disc_rotor.toml"
    text = rotor.read_text(encoding="utf-8")
    ids = re.findall(r'(?m)^id = "(.*)"$', text)
    assert ids
    for name in ids:
        text = text.replace(f'"{name}"', f"\"=cmd|' /C calc'!{name}<script>\"")
    rotor.write_text(text, encoding="utf-8")
    out, report = tmp_path / "b.csv", tmp_path / "b.html"
    main(["balance", str(rotor), "--csv", str(out), "--report", str(report)])
    capsys.readouterr()
    cells = [cell for row in csv.reader(out.read_text(encoding="utf-8").splitlines()) for cell in row]
    assert f"'=cmd|' /C calc'!{ids[0]}<script>" in cells
    for cell in cells:
        assert cell[:1] not in {*"=+@"}
        assert cell[:1] != "-" or float(cell) < 0
    page = report.read_text(encoding="utf-8")
    assert "<script" not in page
    assert "calc&#39;!" in page


@pytest.mark.parametrize("verb", ["simulate", "balance"])
@pytest.mark.parametrize(
    "text",
    [
        "[body]\n{} = 1\n",
        "[{}]\npart = 1\n",
        "[body]\npart = {}\n",
        "[report]\ncustomer = {}\n",
        "[[body]]\npart = [{}]\n",
    ],
)
def test_names_and_values_of_toml_hold_no_control_character(
    verb: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nasty = NASTY.replace("\udc80", "")
    file = tmp_path / "file.toml"
    file.write_text("schema = 1\n" + text.format(json.dumps(nasty)), encoding="utf-8")
    said = run(capsys, 2, verb, file)
    assert "leave out the control character U+001B" in said
    assert visible(nasty) in said


def test_a_scene_and_a_rotor_may_have_nasty_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = shutil.copytree(path("rotors/disc.toml").parents[1], tmp_path / "samples")
    scene, rotor = (folder / kind / f"{FILE}.toml" for kind in ("scenes", "rotors"))
    (folder / "scenes" / "cube.toml").rename(scene)
    (folder / "rotors" / "disc.toml").rename(rotor)
    report, recording = tmp_path / "report.html", tmp_path / "run.rrd"
    assert SHOWN in run(capsys, 0, "simulate", scene, "-o", recording)
    assert json.loads(run(capsys, 0, "simulate", scene, "--json"))["scene"] == str(scene)
    assert recording.exists()
    run(capsys, 0, "balance", rotor, "--report", report)
    assert not UNSAFE.search(report.read_text(encoding="utf-8"))
    assert "<script" not in report.read_text(encoding="utf-8")
    run(capsys, 0, "balance", rotor, "--to-toml")


def test_links_of_a_robot_are_named_as_they_may_be_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = "a&#10;Mass  0 kg&#155;31m&#x202e;&lt;script&gt;"
    (tmp_path / "robot.urdf").write_text(
        f'<robot name="{name}"><link name="{name}"><inertial><mass value="1"/><origin xyz="0 0 0"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<visual name="{name}"><geometry><box size="1 1 1"/></geometry></visual></link></robot>'
    )
    report = tmp_path / "audit.html"
    shown = r"a\u000aMass  0 kg\u009b31m\u202e<script>"
    for options in ([], ["--json"], ["--report", report], ["--fix", tmp_path / "mended.urdf"]):
        main(["audit", str(tmp_path / "robot.urdf"), *map(str, options)])
        out, errors = capsys.readouterr()
        assert errors == ""
        assert not UNSAFE.search(out)
        assert shown in out.replace("\\\\", "\\")
    page = report.read_text(encoding="utf-8")
    assert not UNSAFE.search(page)
    assert "<script" not in page
