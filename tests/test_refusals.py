"""Refusals have codes that stay, a page with each of them, and an example file that produces it."""

import ast
import json
import pickle
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import inertia
from inertia.documents import FieldError
from inertia.errors import GeometryError, ReadError, UsageError, placed
from inertia.mesh.checks.kinds import KINDS
from inertia.recording.live import ViewerError
from inertia_cli import analyse
from inertia_cli.main import main
from inertia_meshes import path

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGE = (DOCS / "errors.md").read_text(encoding="utf-8")
EXAMPLES = sorted((DOCS / "errors").iterdir())
ROOT = Path(inertia.__file__).parent
_CLASSES = (inertia.InertiaError, inertia.WriteError, ReadError, UsageError, GeometryError, FieldError)


def refusal(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    """Run a command that must refuse; return its document, which says what standard error says."""
    code = main([*arguments, "--json"])
    out, errors = capsys.readouterr()
    document = json.loads(out)
    assert document["exit_code"] == code
    assert errors == f"inertia: {document['message']}\n"
    return document


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_an_example_is_refused_by_its_code(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    verb = {".toml": "simulate", ".urdf": "audit", ".xml": "audit", ".csv": "assembly"}.get(file.suffix, "analyse")
    assert refusal(capsys, verb, str(file))["code"] == file.stem
    assert f"[{file.stem}](errors/{file.name}) |" in PAGE


def test_the_page_has_every_code() -> None:
    rows = set(re.findall(r"^\| `(\w+)`", PAGE, re.MULTILINE))
    written = {
        keyword.value.value
        for file in ROOT.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "").endswith("Error")
        for keyword in node.keywords
        if keyword.arg == "code" and isinstance(keyword.value, ast.Constant)
    }
    faults = {kind.code for kind in KINDS if kind.severity == "error"}
    classes = {kind.code for kind in (*_CLASSES, ViewerError)}
    assert rows == written | faults | classes


def test_a_code_survives_places_and_processes() -> None:
    error = placed(ReadError("it is empty", code="empty_file"), "a.stl")
    assert (error.code, pickle.loads(pickle.dumps(error)).code) == ("empty_file", "empty_file")
    assert GeometryError("no").code == "no_answer"


@pytest.mark.parametrize(
    "call",
    [
        lambda: inertia.gradient(None),
        lambda: inertia.repair(None),
        lambda: inertia.weld(None, 1.0),
        lambda: inertia.weld(inertia.read(path("cube.stl")), "x"),
        lambda: inertia.repair(inertia.read(path("cube.stl")), "x"),
        lambda: inertia.richardson(*[inertia.read(path("cube.stl"))] * 2),
        lambda: inertia.analyse(inertia.read(path("cube.stl")), class_tolerance="x"),
        lambda: inertia.analyse(inertia.read(path("cube.stl")), coverage="95%"),
        lambda: inertia.analyse(inertia.read(path("cube.stl")), chord="x"),
        lambda: inertia.analyse(inertia.read(path("cube.stl")), chord=True),
        lambda: inertia.stable_axes([1, 2, 3], tolerance="x"),
        lambda: inertia.plan(None),
        lambda: inertia.Job.load(None),
        lambda: inertia.readings("a", 1),
        lambda: inertia.readings(np.ma.masked_all(2), [1, 2]),
        lambda: inertia.readings(np.array([1j]), [1]),
        lambda: inertia.flip_period(np.array([1, 2, 3]) + 1j, [1, 2, 3]),
        lambda: inertia.flip_period(np.ma.array([1.0, 2, 3], mask=[0, 0, 1]), [1, 2, 3]),
    ],
)
def test_an_argument_of_another_kind_is_refused_in_a_sentence(call: Callable[[], object]) -> None:
    with pytest.raises(UsageError):
        call()


def test_a_part_in_memory_is_refused_by_the_same_codes() -> None:
    sheet = inertia.Part.from_arrays(np.eye(3), [[0, 1, 2]], unit="mm")
    with pytest.raises(GeometryError) as refused:
        inertia.mass_properties(sheet)
    assert refused.value.code == "open"


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["analyse", "nothing.stl"], "no_file"),
        (["analyse", str(path("cube.stl")), "--density", "-1"], "usage"),
        (["analyse", str(path("broken/nan.stl"))], "non_finite"),
        (["audit", "nothing.urdf"], "no_file"),
        (["simulate", "nothing.toml"], "no_file"),
        (["analyse", str(path("cube.stl")), "--unit", "cubit"], "unknown_unit"),
        (["analyse", str(path("cube.stl")), "--material", "unobtainium"], "unknown_material"),
        (["analyse", str(path("cube.stl")), "--density", "lid=1000"], "unknown_region"),
        (["simulate", str(path("scenes/cube.toml")), "-o", "no/such/folder/a.csv"], "unwritable"),
        (["simulate", str(path("scenes/cube.toml")), "-o", str(path("cube.stl"))], "usage"),
    ],
)
def test_other_refusals(arguments: list[str], code: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert refusal(capsys, *arguments)["code"] == code


@pytest.mark.parametrize(
    "arguments",
    [
        ["analyse", "nothing.stl"],
        ["analyse", str(path("broken/truncated.stl"))],
        ["analyse", str(path("broken/nan.stl"))],
        ["simulate", "nothing.toml"],
        ["audit", "nothing.urdf"],
    ],
)
def test_places_are_files_and_fields(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert refusal(capsys, *arguments)["places"] == [arguments[-1]]


@pytest.mark.parametrize(
    "arguments", [["analyse"], ["analyse", "a.stl", "--density", "abc"], ["analyse", "a.stl", "--mass=--"], ["cite"]]
)
def test_a_command_line_that_cannot_be_parsed_is_refused_as_any_other(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main([*arguments, "--json"])
    out, errors = capsys.readouterr()
    document = json.loads(out)
    assert (document["code"], document["exit_code"], end.value.code) == ("usage", 2, 2)
    assert errors.endswith(f": {document['message']}\n")


def test_a_run_without_an_end_has_a_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "long.toml"
    text = path("scenes/tippe_top.toml").read_text(encoding="utf-8")
    scene.write_text(re.sub(r"duration *=.*", "duration = 1e7\ntime_limit = 0.01", text), encoding="utf-8")
    assert refusal(capsys, "simulate", str(scene))["code"] == "time_limit"


def test_a_file_that_exists_is_refused_before_the_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    there = tmp_path / "a.rrd"
    there.touch()
    assert refusal(capsys, "simulate", str(path("scenes/cube.toml")), "-o", str(there))["code"] == "exists"


def test_an_answer_whose_files_cannot_be_written_stays_the_one_document(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise inertia.WriteError("cannot write a.csv: No space left on device: make room")

    monkeypatch.setattr(inertia.Run, "to_csv", full)
    code = main(["simulate", str(path("scenes/cube.toml")), "-o", str(tmp_path / "a.csv"), "--json"])
    out, errors = capsys.readouterr()
    assert json.loads(out)["schema"] == "inertia/run/1"
    assert (code, errors) == (1, "inertia: cannot write a.csv: No space left on device: make room\n")


def test_a_file_that_grows_while_it_is_read_has_a_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file, read_bytes = tmp_path / "cube.off", Path.read_bytes
    file.write_bytes((DOCS / "errors/inward.off").read_bytes())

    def growing(self: Path) -> bytes:
        data = read_bytes(self)
        if self == file:
            with self.open("ab") as stream:
                stream.write(b"# more\n")
        return data

    monkeypatch.setattr(Path, "read_bytes", growing)
    document = refusal(capsys, "analyse", str(file))
    assert (document["code"], document["exit_code"]) == ("changed", 3)


@pytest.mark.skipif(shutil.which("false") is None, reason="no program that fails at once")
def test_workers_that_cannot_be_started_have_a_code(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("sys.executable", shutil.which("false"))
    document = refusal(capsys, "batch", str(path("cube.stl")), "-o", str(tmp_path / "a.csv"), "--jobs", "1")
    assert (document["code"], document["exit_code"]) == ("workers", 1)
    assert list(tmp_path.iterdir()) == []


def test_a_viewer_that_is_not_open_has_a_code(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object, **__: object) -> None:
        raise ConnectionRefusedError

    monkeypatch.setattr("socket.create_connection", refused)
    document = refusal(capsys, "simulate", str(path("scenes/cube.toml")), "--live")
    assert (document["code"], document["exit_code"]) == ("no_viewer", 1)


def test_a_fault_of_the_program_is_a_document_too(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(_: object) -> int:
        raise ZeroDivisionError("here")

    monkeypatch.setattr(analyse, "run", run)
    monkeypatch.delenv("INERTIA_TRACEBACK", raising=False)
    document = refusal(capsys, "analyse", "a.stl")
    assert (document["code"], document["exit_code"], document["places"]) == ("fault", 1, ["a.stl"])


@pytest.mark.parametrize("beyond", [OverflowError("too large"), RuntimeWarning("overflow"), MemoryError()])
def test_what_leaves_float64_or_memory_is_refused_as_any_other(
    beyond: Exception, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(_: object) -> int:
        raise beyond

    monkeypatch.setattr(analyse, "run", run)
    document = refusal(capsys, "analyse", "a.stl")
    assert (document["code"], document["exit_code"]) == ("no_answer", 4)


def test_a_refusal_that_nobody_reads_stands_on_standard_error(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(_: object) -> None:
        raise BrokenPipeError

    monkeypatch.setattr("inertia_cli.main.print_document", broken)
    monkeypatch.setattr("inertia_cli.main.abandon_output", lambda: None)
    assert main(["analyse", "nothing.stl", "--json"]) == 3
    assert capsys.readouterr().err.startswith("inertia: cannot read nothing.stl: ")


def test_points_of_volume_meshes_that_are_not_finite_have_the_code_of_those_of_surfaces(tmp_path: Path) -> None:
    file = tmp_path / "a.vtk"
    file.write_text(
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        "0 0 0 1 0 0 0 1 0 0 0 nan\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
    )
    with pytest.raises(ReadError) as refused:
        inertia.read(file)
    assert refused.value.code == "non_finite"
    with pytest.raises(GeometryError) as refused:
        inertia.lamina([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], 1)
    assert refused.value.code == "non_finite"


@pytest.mark.parametrize(
    "arguments", [["balance", str(path("rotors/disc.toml"))], ["assembly", str(path("robots/arm.urdf"))]]
)
def test_a_file_of_toml_is_no_document(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    document = refusal(capsys, *arguments, "--to-toml")
    assert document["message"] == "--to-toml has no room for --json: leave one of them out"


def test_an_assembly_file_is_not_written_as_one_again(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assembly", str(path("assemblies/fan.toml")), "--to-toml"]) == 2
    assert "--to-toml" in capsys.readouterr().err


def test_a_file_that_another_option_names_is_a_place(capsys: pytest.CaptureFixture[str]) -> None:
    scene = str(path("scenes/t_handle.toml"))
    document = refusal(capsys, "simulate", scene, "--compare", "nothing.toml", "-o", "never.rrd")
    assert document["places"] == [scene, "nothing.toml"]


def test_without_json_a_refusal_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", "nothing.stl"]) == 3
    assert capsys.readouterr().out == ""
