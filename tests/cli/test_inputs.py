"""A command writes over nothing that it reads, by whatever name."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import inertia_meshes
from inertia_cli.main import main

links = pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege")


@pytest.fixture
def samples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder of our own with all samples in it, which is the working one."""
    folder = tmp_path / "samples"
    shutil.copytree(Path(inertia_meshes.__file__).parent, folder, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    monkeypatch.chdir(folder)
    return folder


def refused(folder: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one sentence on standard error of a command that must leave all files as they are."""
    before = {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()} == before
    return line


@pytest.mark.parametrize(
    ("line", "output"),
    [
        ("analyse cube.stl --density 1 --as urdf -o cube.stl", "cube.stl"),
        ("analyse cube.stl --density 1 --as urdf -o scenes/../cube.stl", "scenes/../cube.stl"),
        ("audit robots/arm.urdf --fix robots/arm.urdf", "robots/arm.urdf"),
        ("assembly assemblies/pump_rotor.toml --to-toml assemblies/pump_rotor.toml", "assemblies/pump_rotor.toml"),
        ("batch manifest.csv -o manifest.csv", "manifest.csv"),
        ("batch cube.stl --manifest manifest.csv -o manifest.csv", "manifest.csv"),
        ("batch --merge shard1.csv shard2.csv -o shard2.csv", "shard2.csv"),
        ("batch *.csv --verb audit -o manifest.csv", "manifest.csv"),
        ("budget bill.csv --csv bill.csv", "bill.csv"),
        ("balance rotors/disc.stl --rpm 3000 --grade 6.3 --bearings=-20,20 --axis z --cut-part rotors/disc.stl",
         "rotors/disc.stl"),
        # files that a file names
        ("balance measure jobs/fan.toml --log jobs/fan.csv", "jobs/fan.csv"),
        ("balance measure jobs/fan.toml --coefficients jobs/fan.toml", "jobs/fan.toml"),
        ("balance measure jobs/two_disc_rotor.toml --cut-part two_disc_rotor.stl", "two_disc_rotor.stl"),
        ("balance rotors/two_disc_rotor.toml --cut-part two_disc_rotor.stl", "two_disc_rotor.stl"),
        ("simulate scenes/manoeuvre.toml -o scenes/manoeuvre.csv", "scenes/manoeuvre.csv"),
        ("budget bill.csv --csv bolts.csv", "bolts.csv"),
        ("audit model.xml --report included.html", "included.html"),
    ],
)  # fmt: skip
def test_an_input_is_not_written_over(
    line: str, output: str, samples: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (samples / "manifest.csv").write_text("path\ncube.stl\n")
    (samples / "bill.csv").write_text("name,assembly\nbolts,bolts.csv\n")
    (samples / "bolts.csv").write_text("name,mass\nbolt,0.1\n")
    (samples / "model.xml").write_text('<mujoco><include file="included.html"/></mujoco>')
    (samples / "included.html").write_text("<mujocoinclude><worldbody><body/></worldbody></mujocoinclude>")
    shutil.copy(samples / "disc.stl", samples / "rotors")
    for shard in (1, 2) if "shard" in line else ():
        table = f"shard{shard}.csv"
        assert main(["batch", "cube.stl", "disc.stl", "--jobs", "1", "--shard", f"{shard}/2", "-o", table]) == 0
    capsys.readouterr()
    said = refused(samples, [*line.split(), "--force"], capsys)
    assert said.startswith(f"inertia: cannot write {output}: it is an input, ")
    assert said.endswith(": give the output another name")


@links
@pytest.mark.parametrize("link", [os.link, os.symlink])
@pytest.mark.parametrize("turned", [False, True])
def test_links_do_not_hide_an_input(
    link: Callable[[Path, Path], None], turned: bool, samples: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    link(samples / "cube.stl", samples / "other.stl")
    part, output = ("other.stl", "cube.stl") if turned else ("cube.stl", "other.stl")
    said = refused(samples, ["analyse", part, "--density", "1", "--as", "urdf", "-o", output, "--force"], capsys)
    assert said == f"inertia: cannot write {output}: it is an input, {part}: give the output another name"


@links
def test_a_mesh_of_a_robot_is_not_written_over_by_a_link(samples: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (samples / "report.html").symlink_to("cone.stl")
    said = refused(samples, ["audit", "robots/arm.urdf", "--report", "report.html", "--force"], capsys)
    assert "cannot write report.html: it is an input, robots/../cone.stl" in said


def test_the_file_on_standard_input_is_not_written_over(samples: Path) -> None:
    line = [sys.executable, "-m", "inertia_cli", "analyse", "-", "--density", "1", "--as", "urdf"]
    before = (samples / "cube.stl").read_bytes()
    with (samples / "cube.stl").open("rb") as file:
        end = subprocess.run([*line, "-o", "cube.stl", "--force"], stdin=file, capture_output=True, text=True)
    says = "cannot write cube.stl: it is what standard input is read from: give the output another name"
    assert (end.returncode, end.stderr) == (2, f"inertia: {says}\n")
    assert (samples / "cube.stl").read_bytes() == before


def test_the_refusal_comes_before_that_of_a_file_that_is_there(
    samples: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "--force" not in refused(samples, ["audit", "robots/arm.urdf", "--fix", "robots/arm.urdf"], capsys)
    assert main(["audit", "robots/arm.urdf", "--fix", "robots/arm.urdf", "--force", "--json"]) == 2
    document = json.loads(capsys.readouterr().out)
    assert document["code"] == "is_input"


def test_two_results_do_not_go_to_one_file(samples: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["balance", "measure", "jobs/two_disc_rotor.toml", "--certificate", "both.html", "--report", "both.html"]
    assert "cannot write both.html twice" in refused(samples, line, capsys)


def test_the_library_writes_over_what_it_has_read_where_it_is_forced(samples: Path) -> None:
    import inertia
    from inertia.mesh.write import write_stl

    part = inertia.read("cube.stl")
    write_stl([part], "cube.stl", part.unit, force=True)
    assert inertia.read("cube.stl").triangles.count == part.triangles.count
