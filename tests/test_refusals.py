"""Refusals have codes that stay, a page with each of them, and an example file that produces it."""

import ast
import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import inertia
from inertia.documents import FieldError
from inertia.errors import GeometryError, ReadError, UsageError, placed
from inertia.mesh.checks.kinds import KINDS
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
    verb = "simulate" if file.suffix == ".toml" else "analyse"
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
    classes = {kind.code for kind in _CLASSES}
    assert rows == written | faults | classes


def test_a_code_survives_places_and_processes() -> None:
    error = placed(ReadError("it is empty", code="empty_file"), "a.stl")
    assert (error.code, pickle.loads(pickle.dumps(error)).code) == ("empty_file", "empty_file")
    assert GeometryError("no").code == "no_answer"


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
