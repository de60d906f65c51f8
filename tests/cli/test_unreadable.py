"""Folders, empty files and files that are not there, in the same sentences by every command that reads one."""

from pathlib import Path

import pytest

from inertia_cli.main import main

COMMANDS = {
    "analyse part.stl": "export the part again",
    "trade part.stl": "export the part again",
    "simulate scene.toml": "write a scene into it",
    "trade scene.toml": "write a scene into it",
    "balance rotor.toml": "write a rotor into it",
    "balance measure job.toml": "write a job into it",
    "assembly pump.toml": "write an assembly into it",
    "budget bill.csv": "write an assembly into it",
    "assembly robot.urdf": "export the robot again",
    "audit robot.urdf": "export the robot again",
    "audit robot.xml": "export the robot again",
    "audit robot.sdf": "export the robot again",
    "audit robot.usda": "export the robot again",
    "audit robot.csv": "export the robot again",
    "audit robot.toml": "export the robot again",
    "audit folder": "export the robot again",
}
TABLES = ("batch man.csv", "batch --manifest man.csv", "batch -o all.csv --merge table.csv", "cite answer.json")


def said(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    monkeypatch.chdir(folder)
    assert main(line.split()) == 3
    (sentence,) = capsys.readouterr().err.splitlines()
    return sentence.removeprefix("inertia: ").removeprefix("the batch: ")


@pytest.mark.parametrize("line", [*COMMANDS, *TABLES])
def test_a_folder_is_called_so(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name = line.split()[-1]
    (tmp_path / name).mkdir()
    assert said(line, tmp_path, monkeypatch, capsys) == f"cannot read {name}: it is a directory: give a file in it"


@pytest.mark.parametrize("line", [*COMMANDS, *TABLES])
def test_a_file_that_is_not_there_is_called_so(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name = line.split()[-1]
    assert said(line, tmp_path, monkeypatch, capsys) == f"cannot read {name}: there is no such file: check the path"


@pytest.mark.parametrize("content", [b"", b" \n\n", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("line", COMMANDS)
def test_an_empty_file_is_called_so(
    line: str, content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name = line.split()[-1]
    if content and name.endswith(".stl"):
        pytest.skip("the sentences of meshes")
    (tmp_path / name).write_bytes(content)
    assert said(line, tmp_path, monkeypatch, capsys) == f"cannot read {name}: it is empty: {COMMANDS[line]}"


def test_the_words_beside_a_table_are_missed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "table.csv").write_text("path\n")
    sentence = said("batch -o all.csv --merge table.csv", tmp_path, monkeypatch, capsys)
    assert sentence == (
        "cannot read table.csv: there is no table.csv.meta.json beside it, which says what it holds: keep them together"
    )


@pytest.mark.parametrize(
    "line",
    [
        *("simulate a.toml", "balance a.toml", "balance measure a.toml", "assembly a.toml", "budget a.toml"),
        *("trade a.toml", "audit a.toml", "budget --diff a.toml a.toml", "cite a.json"),
    ],
)
def test_lists_within_lists_within_lists_are_no_fault_of_the_program(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name = line.split()[-1]
    (tmp_path / name).write_text(("a = " if name.endswith(".toml") else "") + "[" * 100_000)
    sentence = said(line, tmp_path, monkeypatch, capsys)
    assert sentence.startswith(f"cannot read {name}: its lists or ")
    assert "are nested too deeply: " in sentence


def test_documents_that_are_cited_may_be_as_deep_as_json_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    deep = 800
    Path("a.json").write_text(f'{{"schema": "inertia/run/1", "a": {"[" * deep}{{"model": "Euler"}}{"]" * deep}}}')
    assert main(["cite", "a.json"]) == 0
    assert capsys.readouterr().out.startswith("@software{inertia")
