"""What is printed where the terminal, or the stream, has ASCII or Latin-1 only."""

import json
import os
import re
import subprocess
import sys
import tomllib
from contextlib import suppress
from pathlib import Path

import pytest

from inertia.tables import Column, table_writer
from inertia_cli.main import main
from inertia_meshes import path

_ESCAPED = re.compile(r"\\(x[0-9a-f]{2}|u[0-9a-f]{4}|U[0-9a-f]{8})")
_NAMES = "analyse check trade simulate tumble play balance measure audit assembly budget batch cite completion"
_RUN = [sys.executable, "-c", "from inertia_cli.main import run; run()"]


def spoken(encoding: str, *arguments: str) -> bytes:
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    return subprocess.run([*_RUN, *arguments], env=environment, capture_output=True, check=True).stdout


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("7850 kg/m³ ± 50", "7850 kg/m^3 +/- 50"),
        ("10⁻¹²·Σ 5 µm", "10^-12*\\u03a3 5 um"),
        ("1e5 kg m²/s ≥ 0", "1e5 kg m^2/s >= 0"),
        ("m²", "m^2"),
        ("größe", "gr\\xf6\\xdfe"),
    ],
)
def test_signs_in_ascii(text: str, plain: str) -> None:
    assert text.encode("ascii", "inertia.ascii").decode() == plain


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "cp437", "cp850"])
def test_an_exponent_goes_whole_where_its_sign_is_missing(encoding: str) -> None:
    assert "10⁻¹²".encode(encoding, "inertia.ascii") == b"10^-12"


@pytest.mark.parametrize("sign", "°±·×−–…≤≥→∠′½√∞∫Øµμπθφψωρ§₁₂₃⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
def test_every_sign_has_a_word_in_ascii(sign: str) -> None:
    plain = sign.encode("ascii", "inertia.ascii").decode()
    assert plain.isprintable()
    assert not _ESCAPED.search(plain)


def samples() -> list[list[str]]:
    parts = path("cube.stl").parent
    scenes = [
        ["simulate", str(scene), *(["--for", "0.1"] if scene.stem == "tippe_top" else [])]  # which takes long
        for scene in sorted(parts.glob("scenes/*.toml"))
    ]
    rotors = [["balance", str(rotor), "--time", "0.5"] for rotor in sorted(parts.glob("rotors/*.toml"))]
    part = str(parts / "shaft_impeller.obj")
    return [
        *scenes,
        *rotors,
        *([command, "--help"] for command in _NAMES.split()),
        ["--help"],
        ["analyse", part, "--density", "7850±50", "--scale", "1±0.001"],
        ["analyse", str(parts / "cube.stl"), "--material", "steel", "--about", "1,2,3"],
        ["check", str(parts / "broken/missing_face.stl")],
        ["check", part],
        ["trade", str(parts / "cube.stl"), "--repeats", "1"],
        ["trade", str(parts / "scenes/t_handle.toml"), "--repeats", "1", "--budget", "1"],
        ["tumble", str(parts / "t_handle.stl"), "--spin", "0.001,10,0", "--for", "1"],
        ["simulate", str(parts / "scenes/t_handle.toml"), "--explain"],
        ["simulate", str(parts / "scenes/heavy_top.toml"), "--vary", "body.mass=1±0.01", "--draws", "20"],
        ["balance", str(parts / "two_disc_rotor.stl"), "--rpm", "3000", "--grade", "6.3"],
        ["balance", "measure", str(parts / "jobs/fan.toml")],
        ["balance", "measure", str(parts / "jobs/two_disc_rotor.toml")],
        ["audit", str(parts / "robots/arm.urdf")],
        *(["assembly", str(file)] for file in sorted(parts.glob("assemblies/*.toml"))),
        *(["budget", str(file)] for file in sorted(parts.glob("assemblies/*.toml"))),
        ["analyse", "missing.stl"],
        ["analyse", str(parts / "cube.stl"), "--density", "-1"],
    ]


@pytest.mark.parametrize("arguments", samples(), ids=lambda words: " ".join(Path(word).name for word in words))
def test_reports_help_and_sentences_have_no_escapes(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    with suppress(SystemExit):
        main(["balance measure", *arguments[1:]] if arguments[0] == "measure" else arguments)
    printed = "".join(capsys.readouterr())
    assert printed
    assert not re.search(r"\bnan\b", printed)
    plain = printed.encode("ascii", "inertia.ascii").decode()
    assert [line for line in plain.splitlines() if _ESCAPED.search(line)] == []


def test_a_file_on_standard_output_is_utf_8_whatever_the_terminal_has(tmp_path: Path) -> None:
    rotor = tmp_path / "größe.toml"
    mesh = os.path.relpath(path("two_disc_rotor.stl"), tmp_path)
    rotor.write_text(
        path("rotors/two_disc_rotor.toml").read_text(encoding="utf-8").replace("../two_disc_rotor.stl", mesh),
        encoding="utf-8",
    )
    part = tmp_path / "größe.stl"
    part.write_bytes(path("cube.stl").read_bytes())
    encodings = ("ascii", "latin-1", "utf-8")
    assert len({spoken(k, "analyse", str(part), "--density", "1000", "--as", "urdf") for k in encodings}) == 1
    for encoding in encodings:
        assert tomllib.loads(spoken(encoding, "balance", str(rotor), "--to-toml").decode())
        document = spoken(encoding, "analyse", str(part), "--json").decode()
        assert json.loads(document)["source"]["path"] == str(part)


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_rows_on_standard_output_are_json_in_every_encoding(
    encoding: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with (tmp_path / "rows").open("w", encoding=encoding, errors="inertia.ascii") as file:
        monkeypatch.setattr(sys, "stdout", file)
        with table_writer(None, [Column("file", "text", "", "its name")], {}) as add:
            add({"file": "größe.stl"})
    assert json.loads((tmp_path / "rows").read_bytes()) == {"file": "größe.stl"}
