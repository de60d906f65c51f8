"""The command as a user meets it: what it prints, where, and the exit code."""

import io
import json
import os
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.self_crossing import CROSSING

import inertia
from inertia_cli.main import main
from inertia_cli.progress import Progress
from inertia_meshes import catalogue, path

MM = 1e-3


def stl(tmp_path: Path, corners: np.ndarray, name: str = "part.stl") -> str:
    """Write triangles (n, 3, 3) as binary STL."""
    records = np.zeros(len(corners), np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]))
    records["v"] = corners
    file = tmp_path / name
    file.write_bytes(bytes(80) + np.uint32(len(corners)).tobytes() + records.tobytes())
    return str(file)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["batch", "a.stl", "--memory", "-5MB"], "memory is -5000000: it must be positive and finite, in bytes"),
        (["batch", "a.stl", "--timeout", "-1e3"], "timeout is -1000.0: it must be positive and finite"),
        (["analyse", str(path("cube.stl")), "--density", "-1e3"], "density is -1000 kg/m³: it must be positive"),
        (["analyse", str(path("cube.stl")), "--mass", "-inf"], "mass is -inf kg: it must be"),
        (["analyse", str(path("cube.stl")), "--accuracy", "-1e-5"], "accuracy is -1e-05: give a positive"),
        (["analyse", str(path("cube.stl")), "--unit", "-mm"], "unknown unit '-mm': use one of m"),
    ],
)
def test_a_value_with_a_minus_sign_is_judged_as_a_value(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert says in capsys.readouterr().err


@pytest.mark.parametrize("value", ["-q", "1e", "-inf,0,0"])
def test_a_value_with_a_minus_sign_that_cannot_be_read_is_named(value: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["analyse", "a.stl", "--about", value])
    assert f"argument --about: '{value}' is no point" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["analyse", "a.stl", "--mass", "1", "--mass", "2"],
        ["analyse", "a.stl", "--unit", "m", "--unit=mm"],
        ["audit", "a.urdf", "--tolerance", "0.1", "--tolerance", "0.2"],
        ["simulate", "a.toml", "--method", "rk4", "--method", "rk4"],
        ["balance", "a.stl", "-o", "a.rrd", "--output", "b.rrd"],
    ],
)
def test_an_option_of_one_value_is_given_once(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        main(arguments)
    assert refused.value.code == 2
    assert "it is given twice: give it once" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["analyse", "cube.stl", "--js"], "inertia analyse: --js is unknown: did you mean --json?; see `inertia ana"),
        (["analyse", "--den", "7850", "cube.stl"], "analyse: --den is unknown: did you mean --density?; see"),
        (["analyse", "cube.stl", "--den=7850"], "analyse: --den is unknown: did you mean --density?; see"),
        (["balance", "measure", "--certifcate", "a.html"], "balance measure: --certifcate is unknown: did you mean"),
        (["audit", "--frob", "0.1", "gone.urdf"], "inertia audit: --frob is unknown; see `inertia audit --help`"),
        (["--frob", "cite"], "inertia: --frob is unknown; see `inertia --help`"),
        (["check", "a.stl", "--", "-b.stl"], "inertia: unrecognized arguments: -b.stl; one file is taken here, a.stl"),
    ],
)
def test_of_an_option_that_is_none_only_that_is_said(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as refused:
        main(arguments)
    assert refused.value.code == 2
    assert says in (error := capsys.readouterr().err)
    assert error.count("inertia batch") == ("-b.stl" in arguments)


@pytest.mark.parametrize(
    "arguments",
    [
        ["analyse", "cube.stl", "--as", "urdf", "-o", ""],
        ["batch", "cube.stl", "-o", ""],
        ["audit", "robots/arm.urdf", "--fix", ""],
        ["audit", "robots/arm.urdf", "--report", ""],
        ["simulate", "scenes/cube.toml", "-o", ""],
        ["trade", "cube.stl", "--plot", ""],
        ["balance", "rotors/disc.toml", "--csv", ""],
        ["budget", "assemblies/fan.toml", "--csv", ""],
        ["play", "run.rrd", "--png", ""],
        ["play", "run.rrd", "--html", ""],
    ],
)
def test_an_empty_name_of_an_output_is_called_so(
    arguments: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(path("cube.stl").parent)
    assert main(arguments) == 2
    assert capsys.readouterr().err == "inertia: the name of a file to be written is empty: name one\n"


def test_an_option_without_its_value_is_not_given_the_next_one() -> None:
    for following in (["-o", "a.csv"], ["--json"], []):
        with pytest.raises(SystemExit) as end:
            main(["simulate", "a.toml", "--accuracy", *following])
        assert end.value.code == 2


def document(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    assert main([*arguments, "--json"]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    return json.loads(captured.out)


def sentence(capsys: pytest.CaptureFixture[str], code: int, *arguments: str) -> str:
    """Run a command that must fail, and return the one line that it says."""
    try:
        status = main(arguments)
    except SystemExit as leaving:
        status = leaving.code
    assert status == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
    return captured.err


def test_the_document_holds_the_contract(capsys: pytest.CaptureFixture[str]) -> None:
    file = str(path("two_disc_rotor.stl"))
    result = document(capsys, "analyse", file, "--density", "7850", "--about", "0,0,150")
    fields = (
        "schema source unit unit_from density density_from mesh volume area mass center_of_mass inertia "
        "principal_moments principal_axes class error inertia_about"
    )
    assert set(fields.split()) <= set(result)
    assert result["schema"] == "inertia/analysis/1"
    assert set(result["source"]) == {"path", "sha256", "format"}
    assert (result["source"]["path"], result["source"]["format"]) == (file, "stl")
    assert (result["unit"], result["unit_from"]) == ("mm", "assumed")
    assert (result["density"], result["density_from"]) == (7850.0, "option")
    assert result["mesh"] == {"triangles": 5640, "closed": True, "bodies": 1, "crossings_examined": True}
    assert result["class"] == "asymmetric"
    bounds = {"volume", "mass", "center_of_mass", "inertia", "principal_moments", "principal_axes"}
    assert set(result["error"]) == {"method", *bounds}
    assert result["inertia_about"]["point"] == [0.0, 0.0, 150.0]


def test_the_numbers_are_those_of_the_mesh(capsys: pytest.CaptureFixture[str]) -> None:
    known = catalogue()["two_disc_rotor.stl"]["mesh"]
    result = document(capsys, "analyse", str(path("two_disc_rotor.stl")), "--density", "2", "--about", "1,-2,3")
    assert result["volume"] == pytest.approx(known["volume"] * MM**3, rel=1e-14)
    assert result["mass"] == pytest.approx(2 * known["volume"] * MM**3, rel=1e-14)
    com, tensor = np.array(known["center_of_mass"]) * MM, 2 * np.array(known["inertia"]) * MM**5
    np.testing.assert_allclose(result["center_of_mass"], com, rtol=0, atol=2e-16)
    np.testing.assert_allclose(result["inertia"], tensor, rtol=0, atol=1e-14 * np.linalg.norm(tensor))
    d = com - np.array([1, -2, 3]) * MM
    shifted = tensor + result["mass"] * (d @ d * np.eye(3) - np.outer(d, d))
    np.testing.assert_allclose(result["inertia_about"]["inertia"], shifted, rtol=1e-12)


def test_the_axes_are_written_row_by_row(capsys: pytest.CaptureFixture[str]) -> None:
    result = document(capsys, "analyse", str(path("tetrahedron.stl")))
    axes, tensor = np.array(result["principal_axes"]), np.array(result["inertia"])
    moments = np.array(result["principal_moments"])
    np.testing.assert_allclose(tensor @ axes, axes * moments, atol=1e-14 * moments[2])
    assert np.linalg.det(axes) == pytest.approx(1)
    assert (np.diff(moments) > 0).all()


def test_numbers_read_back_as_the_same_floats(capsys: pytest.CaptureFixture[str]) -> None:
    file = path("ellipsoid.stl")
    properties = inertia.analyse(inertia.read(file), material="titanium").properties
    result = document(capsys, "analyze", str(file), "--material", "titanium")
    assert result["mass"] == properties.mass
    assert result["inertia"] == properties.inertia.tolist()
    assert result["density_from"] == "material"


@pytest.mark.parametrize(
    ("options", "density", "source"),
    [([], 1000.0, "assumed"), (["--mass", "3"], 3e6, "mass"), (["--material", "Steel"], 7850.0, "material")],
)
def test_says_where_the_density_came_from(
    capsys: pytest.CaptureFixture[str], options: list[str], density: float, source: str
) -> None:
    result = document(capsys, "analyse", str(path("cube.stl")), *options)
    assert (result["density"], result["density_from"]) == (pytest.approx(density), source)


def test_a_body_each_with_its_density(capsys: pytest.CaptureFixture[str]) -> None:
    known = catalogue()["shaft_impeller.obj"]
    arguments = [part for name, of in known["parts"].items() for part in ("--density", f"{name}={of['density']}")]
    result = document(capsys, "analyse", str(path("shaft_impeller.obj")), *arguments)
    assert {share["name"] for share in result["shares"]} == set(known["parts"])
    for share in result["shares"]:
        assert share["volume"] == pytest.approx(known["parts"][share["name"]]["mesh"]["volume"] * MM**3, rel=1e-13)
    assert result["mass"] == pytest.approx(sum(share["mass"] for share in result["shares"]), rel=1e-15)


def test_a_point_is_taken_as_written_with_the_bound_of_its_tensor(capsys: pytest.CaptureFixture[str]) -> None:
    """0.1 mm is a float64 neither in mm nor in metres; beside it the cube of 10 mm and 1 g has exact moments."""
    arguments = "--accuracy", "exact", "--about", "0.1,1e-999999999,0"
    about = document(capsys, "analyse", str(path("cube.stl")), *arguments)["inertia_about"]
    along = Fraction(1, 6 * 10**7)
    across = along + Fraction(1, 1000) * Fraction(1, 10_000) ** 2
    assert about["point"] == [0.1, 0.0, 0.0]
    assert about["inertia"] == np.diag([float(along), float(across), float(across)]).tolist()
    assert about["error"] == 2.0**-53


def test_a_point_may_begin_with_a_minus(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["--about", "-1,2,3"], ["--about=-1,2,3"]):
        result = document(capsys, "analyse", str(path("cube.stl")), *arguments)
        assert result["inertia_about"]["point"] == [-1.0, 2.0, 3.0]


def test_the_text_states_what_a_report_needs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", str(path("cube.stl")), "--material", "steel", "--about", "5,0,0"]) == 0
    text = capsys.readouterr().out
    for stated in (
        "cube.stl (stl)",
        "mm (assumed",
        "7850 kg/m³ (of the material given)",
        "12 triangles, closed, 1 body",
        "1e-06 m³   = 1000 mm³",
        "0.0006 m²   = 600 mm²",
        "0.00785 kg",
        "1.308333333e-07",
        "spherical",
        "4.082482905e-03",
        "0.006454972244, 0.006454972244, 0.006454972244 m",
        "Error bound",
        "about (5, 0, 0) mm",
        "3.270833333e-07",
    ):
        assert stated in text
    assert "e-2" not in text.partition("Error bound")[0]  # nothing but noise is that small on this part


def test_a_repair_is_listed_with_its_effect(capsys: pytest.CaptureFixture[str]) -> None:
    file = str(path("broken/missing_face.stl"))
    result = document(capsys, "analyse", file, "--repair")
    (change,) = result["repair"]["changes"]
    assert (change["what"], change["count"]) == ("holes filled", 1)
    assert result["repair"]["volume_before"] == pytest.approx(11 / 12 * 1e-6)
    assert result["repair"]["volume_after"] == result["volume"] == pytest.approx(1e-6)
    assert main(["analyse", file, "--repair"]) == 0
    assert "holes filled: 1 (of 3 edges" in capsys.readouterr().out


def test_welding_is_listed_too(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    corners = inertia.read(path("cube.stl")).triangles.corners()
    corners[0] += 1e-4
    file = stl(tmp_path, corners)
    assert "open" in sentence(capsys, 4, "analyse", file)
    result = document(capsys, "analyse", file, "--weld", "1e-3")
    assert result["repair"]["changes"][0]["largest_move"] == pytest.approx(np.sqrt(3) * 1e-7, rel=0.05)
    assert main(["analyse", str(path("cube.stl")), "--weld", "1e-3"]) == 0
    assert "nothing to repair" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("code", "arguments", "words"),
    [
        (2, ["analyse"], "required: PART"),
        (2, ["analyse", "cube.stl", "--frobnicate"], "--frobnicate"),
        (2, ["analyse", "cube.stl", "--about", "1,2"], "X,Y,Z"),
        (2, ["analyse", "cube.stl", "--about", "1,2,nan"], "X,Y,Z"),
        (2, ["analyse", "cube.stl", "--density", "heavy"], "kg/m³"),
        (2, ["analyse", "cube.stl", "--density", "rim="], "equals sign"),
        (2, ["analyse", "cube.stl", "--density", "=5"], "'=5' has no name before the equals sign"),
        (2, ["analyse", "cube.stl", "--material", " =steel"], "give steel alone for the rest"),
        (2, ["analyse", "cube.stl", "--density", ""], "it is empty"),
        (2, ["analyse", "cube.stl", "ring.stl"], "cube.stl, and several by `inertia batch`; see `inertia --help`"),
        (2, ["play", "a.rrd", "b.rrd"], "unrecognized arguments: b.rrd; one file is taken here, a.rrd; see"),
        (2, ["analyse", "cube.stl", "--density", "-1"], "must be positive"),
        (2, ["analyse", "cube.stl", "--density", "1", "--density", "2"], "twice"),
        (2, ["analyse", "cube.stl", "--density", "rim=1"], "'rim'"),
        (2, ["analyse", "cube.stl", "--material", "stel"], "did you mean steel"),
        (2, ["analyse", "cube.stl", "--mass", "1", "--density", "1"], "both"),
        (2, ["analyse", "cube.stl", "--unit", "furlong"], "furlong"),
        (2, ["analyse", "cube.stl", "--format", "dwg"], "dwg"),
        (2, ["analyse", "cube.stl", "--accuracy", "0"], "positive"),
        (2, ["analyse", "cube.stl", "--accuracy", "very"], "exact"),
        (2, ["analyse", "cube.stl", "--weld", "5"], "tolerance"),
        (2, ["analyse", "cube.stl", "--shell", "0"], "thickness"),
        (2, ["analyse", "cube.stl", "--class-tolerance", "2"], "below 1"),
        (3, ["analyse", "no-such-file.stl"], "no such file"),
        (3, ["check", "broken/truncated.stl"], "cut short"),
        (4, ["analyse", "broken/missing_face.stl"], "1 boundary loop, 34.14 mm"),
        (4, ["analyse", "broken/flipped_face.stl"], "winding"),
        (4, ["analyse", "broken/inside_out.stl"], "--orientation absolute"),
        (4, ["analyse", "broken/nan.stl"], "triangle 4, corner 1"),
        (4, ["analyse", "broken/zero_volume.stl"], "no volume"),
        (4, ["analyse", "broken/overlapping_cubes.stl"], "overlapping"),
        (4, ["analyse", "cube.stl", "--wire", "1"], "no lines"),
    ],
)
def test_a_fault_is_one_sentence_and_a_code(
    capsys: pytest.CaptureFixture[str], code: int, arguments: list[str], words: str
) -> None:
    command, *rest = arguments
    located = [str(path("cube.stl").parent / part) if part.endswith(".stl") else part for part in rest]
    message = sentence(capsys, code, command, *located)
    assert message.startswith("inertia")
    assert words in message
    if code > 2:
        assert located[0] in message


@pytest.mark.parametrize("command", ["analyse", "check", "cite", "simulate", "balance", "audit", "play", "batch"])
def test_an_empty_name_is_no_folder(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, ""]) == 2
    assert capsys.readouterr().err.startswith("inertia: the path of a file is empty: name a file, or - for standard")


def test_a_file_whose_name_begins_as_an_option_is_written_with_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("-x.stl").write_bytes(path("cube.stl").read_bytes())
    assert "write ./-x.stl for that file" in sentence(capsys, 2, "analyse", "-x.stl")
    assert main(["analyse", "./-x.stl"]) == main(["analyse", "--", "-x.stl"]) == 0


def test_the_distance_that_a_crack_names_is_one_to_give(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "cracked.obj"
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [6e-18, 0, 0]]
    lines = [f"v {x} {y} {z}\n" for x, y, z in corners] + ["f 1 3 2\n", "f 1 2 4\n", "f 2 3 4\n", "f 5 4 3\n"]
    file.write_text("".join(lines))
    assert main(["analyse", str(file), "--unit", "m"]) == 4
    message = capsys.readouterr().err
    assert "use --weld 6.01e-18 (the least distance, in m, that closes it), close the mesh, or use --shell" in message
    assert main(["analyse", str(file), "--unit", "m", "--weld", "6.01e-18"]) == 0


def test_check_judges_by_its_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(path("cube.stl"))]) == 0
    assert "fit for integration" in capsys.readouterr().out
    assert main(["check", str(path("broken/missing_face.stl"))]) == 4
    captured = capsys.readouterr()
    assert "1 boundary loop" in captured.out
    assert captured.err == ""


def test_check_forgives_orientation_when_asked(capsys: pytest.CaptureFixture[str]) -> None:
    file = str(path("broken/inside_out.stl"))
    assert main(["check", file]) == 4
    capsys.readouterr()
    assert document(capsys, "check", file, "--orientation", "absolute")["fit"] is True
    assert document(capsys, "analyse", file, "--orientation", "absolute")["volume"] == pytest.approx(1e-6)


def test_the_document_of_a_check_says_where(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(path("broken/missing_face.stl")), "--json"]) == 4
    result = json.loads(capsys.readouterr().out)
    assert (result["schema"], result["fit"], result["closed"], result["consistent"]) == (
        "inertia/check/1",
        False,
        False,
        True,
    )
    (loop,) = result["loops"]
    assert loop["edges"] == 3
    assert loop["length"] == pytest.approx(20 + 200**0.5)
    assert result["findings"][0]["faces"] == [0]


def test_crossings_are_looked_for_unless_that_is_declined(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    cube = inertia.read(path("cube.stl")).triangles.corners()
    spike = np.where((cube == cube.max(axis=(0, 1))).all(axis=2, keepdims=True), cube - 30.0, cube)
    file = stl(tmp_path, spike)
    assert document(capsys, "check", str(path("cube.stl")), "--intersections")["findings"] == []
    codes = []
    for options in (["--no-intersections"], []):
        main(["check", file, "--json", *options])
        report = json.loads(capsys.readouterr().out)
        assert report["crossings_examined"] == (not options)
        codes.append({finding["code"] for finding in report["findings"]})
    assert codes[1] - codes[0] == {"self_intersection"}


def test_analyse_refuses_a_solid_that_crosses_itself(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    vertices, faces = CROSSING["pentagram"]
    file = stl(tmp_path, vertices[faces])
    assert "about 0.35 mm³ (24 % of the stored volume)" in sentence(capsys, 4, "analyse", file)
    assert not document(capsys, "analyse", file, "--no-intersections")["mesh"]["crossings_examined"]
    for state, *arguments in (("not examined", file, "--no-intersections"), ("examined", str(path("cube.stl")))):
        assert main(["analyse", *arguments]) == 0
        assert f"closed, 1 body, crossings {state}\n" in capsys.readouterr().out


def test_an_interrupt_is_no_traceback(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("inertia.mass.analyse.analyse", interrupted)
    assert sentence(capsys, 130, "analyse", str(path("cube.stl"))) == "inertia: interrupted\n"


def test_a_fault_of_ours_is_a_sentence_with_code_1(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("inertia.mass.analyse.analyse", broken)
    assert "ZeroDivisionError" in sentence(capsys, 1, "analyse", str(path("cube.stl")))
    monkeypatch.setenv("INERTIA_TRACEBACK", "1")
    with pytest.raises(ZeroDivisionError):
        main(["analyse", str(path("cube.stl"))])


def console(*arguments: str, **options: object) -> subprocess.CompletedProcess[bytes]:
    """Run the command in a process of its own."""
    code = "from inertia_cli.main import run; run()"
    return subprocess.run([sys.executable, "-c", code, *arguments], check=False, capture_output=True, **options)


def test_a_reader_that_leaves_early_is_no_fault() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    code = "from inertia_cli.main import run; run()"
    done = subprocess.run(
        [sys.executable, "-c", code, "analyse", str(path("cube.stl"))],
        check=False,
        stdout=writing,
        stderr=subprocess.PIPE,
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
def test_a_full_disk_is_said() -> None:
    with Path("/dev/full").open("wb") as full:
        code = "from inertia_cli.main import run; run()"
        arguments = [sys.executable, "-c", code, "analyse", str(path("cube.stl"))]
        done = subprocess.run(arguments, check=False, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 1
    assert done.stderr.startswith(b"inertia: cannot write the result: No space left")


@pytest.mark.skipif(os.name != "posix", reason="closes a stream by the shell")
def test_a_closed_output_is_said() -> None:
    code = "from inertia_cli.main import run; run()"
    command = shlex.join([sys.executable, "-c", code, "analyse", str(path("cube.stl"))])
    done = subprocess.run(["sh", "-c", f"{command} >&-"], check=False, capture_output=True)
    assert (done.returncode, done.stderr) == (1, b"inertia: cannot write the result: standard output is closed\n")


def test_an_old_terminal_gets_signs_in_ascii() -> None:
    done = console("analyse", str(path("cube.stl")), env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0
    assert b"kg/m^3" in done.stdout


@pytest.mark.parametrize(
    "command",
    [
        ["analyse"], ["check"], ["trade"], ["simulate"], ["tumble"], ["play"], ["balance"], ["balance", "measure"],
        ["audit"], ["assembly"], ["budget"], ["batch"], ["cite"], ["completion"],
    ],
    ids=" ".join,
)  # fmt: skip
def test_help_fits_80_columns_and_ends_with_examples(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: list[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit):
        main([*command, "--help"])
    text, _, examples = capsys.readouterr().out.partition("\nexamples:\n")
    usage, _, said = text.partition("\n\n")  # argparse breaks the lines of the usage, not always in time
    assert usage.startswith("usage: inertia ")
    assert max(map(len, said.splitlines())) <= 80
    assert examples.startswith("  inertia ")


def test_help_of_the_program_fits_80_columns(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit):
        main(["--help"])
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80


def test_the_version_and_the_help() -> None:
    assert console("--version").stdout.decode().strip() == f"inertia {inertia.__version__}"
    done = console("analyse", "--help")
    assert done.returncode == 0
    assert b"--material" in done.stdout


class Terminal(io.StringIO):
    """A stream that takes itself for a terminal."""

    def isatty(self) -> bool:
        return True


def test_progress_is_drawn_on_a_terminal_and_wiped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia_cli.progress.PATIENCE", 0.0)
    terminal = Terminal()
    with Progress("integrating", terminal) as progress:
        progress(0.5)
    drawn = terminal.getvalue()
    assert re.search(r"integrating .* 50%", drawn)
    assert drawn.endswith("\r\x1b[1A\x1b[2K")


def test_text_is_coloured_on_a_terminal_and_the_same_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    def printed(stream: io.StringIO) -> str:
        with monkeypatch.context() as patch:
            patch.setattr(sys, "stdout", stream)
            assert main(["check", str(path("broken/missing_face.stl"))]) == 4
        return stream.getvalue()

    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    plain, coloured = printed(io.StringIO()), printed(Terminal())
    assert "\x1b[1;31merror\x1b[0m" in coloured
    assert re.sub(r"\x1b\[[\d;]*m", "", coloured) == plain
    monkeypatch.setenv("NO_COLOR", "1")
    assert printed(Terminal()) == plain


def test_progress_draws_nothing_elsewhere_or_where_work_is_short() -> None:
    for stream in (io.StringIO(), Terminal()):
        with Progress("integrating", stream) as progress:
            progress(0.5)
        assert stream.getvalue() == ""


@pytest.mark.parametrize("options", [["--repair"], ["--weld", "1e-9"], []])
@pytest.mark.parametrize("size", [1e76, 1e150, 1e160, 1e307])
def test_coordinates_beyond_what_is_computed_with_are_refused(
    size: float, options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    file = tmp_path / "part.obj"
    lines = [f"v {' '.join(repr(size * k) for k in corner)}" for corner in corners]
    lines += [f"f {' '.join(str(k + 1) for k in face)}" for face in faces]
    file.write_text("\n".join(lines))
    assert "no usable number" in sentence(capsys, 4, "analyse", str(file), *options)


def test_signalling_nans_are_refused_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = bytearray(path("cube.stl").read_bytes())
    data[96:100] = b"\x01\x00\x80\x7f"
    file = tmp_path / "part.stl"
    file.write_bytes(data)
    assert "not all finite" in sentence(capsys, 4, "analyse", str(file))
    assert "no usable number" in sentence(capsys, 4, "analyse", str(file), "--repair")


@pytest.mark.parametrize("chord", ["1e100", "1e300"])
def test_a_chord_beyond_float64_leaves_nothing_certain(chord: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "leaves nothing certain" in sentence(capsys, 4, "analyse", str(path("cube.stl")), "--chord", chord)


def test_options_that_leave_float64_are_refused_or_answered(capsys: pytest.CaptureFixture[str]) -> None:
    t_handle = str(path("t_handle.stl"))
    assert main(["analyse", t_handle, "--density", "1e308"]) == 0
    assert main(["analyse", t_handle, "--shell", "1e308"]) == 0
    assert "more than 1.8e308 mm³" in capsys.readouterr().out
    assert "--for is 1e+160" in sentence(capsys, 2, "tumble", t_handle, "--spin", "1,2,3", "--for", "1e160")


def test_what_leaves_float64_is_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("inertia_cli.analyse.read_part", lambda *_: np.float64(1e300) * np.float64(1e300))
    assert "its figures lead beyond what float64 holds (overflow" in sentence(capsys, 4, "analyse", "part.stl")


@pytest.mark.parametrize("option", ["--mass", "--density", "--unit", "--about"])
def test_two_dashes_are_no_value(option: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "expected one argument" in sentence(capsys, 2, "analyse", str(path("cube.stl")), f"{option}=--")


def test_a_mesh_that_is_not_there_is_not_taken_for_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert "cannot read nothing.vtu: " in sentence(capsys, 3, "simulate", "nothing.vtu")


def test_a_repair_that_was_asked_for_is_not_advised(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = str(path("broken/missing_face.stl"))
    assert "or --repair" in sentence(capsys, 4, "analyse", missing)
    left = inertia.repair(inertia.read(path("cube.stl")))
    monkeypatch.setattr(
        "inertia.mass.repair.repair", lambda part, *_, **_named: replace(left, part=part)
    )  # the hole stays
    said = sentence(capsys, 4, "analyse", missing, "--repair")
    assert "--repair" not in said
    assert said.endswith("or use --shell THICKNESS; the repair that was asked for leaves this\n")


def test_what_needs_more_memory_is_no_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def large(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("inertia_cli.analyse.read_part", large)
    assert "part.stl needs more memory than there is" in sentence(capsys, 4, "analyse", "part.stl")


def test_counts_that_ask_for_more_memory_than_there_is_are_damage(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def large(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("inertia.mesh.readers.stl.read_stl", large)
    said = sentence(capsys, 3, "analyse", str(path("cube.stl")))
    assert "its counts ask for more memory than there is, though it has 684 bytes only: it is damaged" in said
