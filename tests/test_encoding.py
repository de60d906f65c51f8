"""Tables and documents in another encoding than UTF-8 are called so, by every command that reads them."""

from pathlib import Path

import pytest

import inertia_meshes
from inertia_cli.main import main

SAMPLES = Path(inertia_meshes.__file__).parent
ROBOT = "name,mass,ixx,iyy,izz,ixy,ixz,iyz\na,1,1,1,1,0,0,0\n"
FILES = {  # the command, the file that it reads, itself or by another one's naming it, and what is in that
    "bill": ("budget bill.csv", "bill.csv", "name,mass\nbolt,0.1\n"),
    "manifest": ("batch man.csv", "man.csv", "path\na.stl\n"),
    "robot": ("audit robot.csv", "robot.csv", ROBOT),
    "robot, TOML": ("audit links.toml", "links.toml", '[[part]]\nname = "a"\n'),
    "torque": ("simulate manoeuvre.toml", "manoeuvre.csv", (SAMPLES / "scenes" / "manoeuvre.csv").read_text()),
    "readings": ("balance measure fan.toml", "fan.csv", (SAMPLES / "jobs" / "fan.csv").read_text()),
    "scene": ("simulate cube.toml", "cube.toml", (SAMPLES / "scenes" / "cube.toml").read_text(encoding="utf-8")),
    "rotor": ("balance disc.toml", "disc.toml", (SAMPLES / "rotors" / "disc.toml").read_text(encoding="utf-8")),
    "document": ("cite answer.json", "answer.json", '{"schema": "inertia/run/1"}'),
}


def said(folder: Path, kind: str, data: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> str:
    line, name, _ = FILES[kind]
    monkeypatch.chdir(folder)
    for sample in (SAMPLES / "scenes" / "manoeuvre.toml", SAMPLES / "jobs" / "fan.toml"):
        (folder / sample.name).write_bytes(sample.read_bytes())
    (folder / name).write_bytes(data)
    assert main(line.split()) == 3
    (sentence,) = capsys.readouterr().err.splitlines()
    assert name in sentence
    return sentence


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("kind", FILES)
def test_utf_16_is_called_so(
    kind: str, encoding: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    sentence = said(tmp_path, kind, FILES[kind][2].encode(encoding), monkeypatch, capsys)
    assert "it is text in UTF-16" in sentence
    assert sentence.endswith("save it as UTF-8")


@pytest.mark.parametrize("kind", [kind for kind in FILES if kind != "scene"])
def test_the_line_that_is_not_in_utf_8_is_named(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    sentence = said(tmp_path, kind, FILES[kind][2].encode() + b"\nM\xfcller\n", monkeypatch, capsys)
    line = FILES[kind][2].count("\n") + 2
    assert kind == "manifest" or f"no text in UTF-8, from line {line} on: " in sentence
    assert "codec" not in sentence
    assert ("TOML" in sentence) == (kind == "rotor")
