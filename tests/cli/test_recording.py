"""`-o`, `--live`, `inertia play`, and running a recording again, as a user sees them."""

import json
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from tests.recording.reading import verified

from inertia.arrays import Float
from inertia.dynamics import observer
from inertia.recording import live
from inertia.recording.preview import Preview
from inertia.recording.provenance import properties
from inertia.recording.viewer import listening
from inertia_cli.main import main
from inertia_meshes import path

HANDLE = str(path("t_handle.stl"))
SCENE = str(path("scenes/t_handle.toml"))
SPIN = ("--spin", "0.001,10,0", "--for", "2", "--samples", "101")


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_scene_is_recorded_and_run_again(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = str(tmp_path / "run.rrd")
    code, out, err = run(capsys, "simulate", SCENE, "--for", "2", "--samples", "11", "-o", file, "--json")
    assert (code, err) == (0, "")
    assert verified(Path(file), tmp_path)
    first = json.loads(out)
    code, out, err = run(capsys, "simulate", file, "--json")
    assert (code, err) == (0, "")
    again = json.loads(out)
    assert again["attitude"] == first["attitude"]
    assert again["scene"] == file


@pytest.mark.parametrize(
    ("made", "again", "named"),
    [
        (("simulate", SCENE, "--for", "2", "--samples", "11"), "simulate", "t_handle.stl"),
        (("balance", str(path("rotors/disc.toml"))), "balance", "disc.stl"),
    ],
)
def test_what_comes_of_a_recording_names_its_parts_in_it_and_is_the_same_each_time(
    made: tuple[str, ...], again: str, named: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = str(tmp_path / "it.rrd")
    run(capsys, *made, "-o", file)
    command = [sys.executable, "-c", "from inertia_cli.__main__ import run; run()", again]
    first, second = (subprocess.run([*command, file, "--json"], capture_output=True).stdout for _ in range(2))
    assert first == second
    assert f"{file}/{named}".encode() in first
    with Path(file).open("rb") as data:
        piped = subprocess.run([*command, "-", "--json"], stdin=data, capture_output=True)
    assert piped.stderr == b""
    assert piped.stdout.replace(f"-/{named}".encode(), f"{file}/{named}".encode()) in (
        first,
        first.replace(f'"scene": "{file}"'.encode(), b'"scene": "-"'),
        first.replace(f'"rotor": "{file}"'.encode(), b'"rotor": "-"'),
    )


def test_a_tumbling_part_is_recorded_and_run_again(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = str(tmp_path / "run.rrd")
    arguments = ("--material", "steel", "--unit", "mm")
    code, out, err = run(capsys, "tumble", HANDLE, *SPIN, *arguments, "--output", file, "--json")
    assert (code, err) == (0, "")
    again = json.loads(run(capsys, "simulate", file, "--json")[1])
    assert again["attitude"] == json.loads(out)["attitude"]
    assert again["body"]["mass"] == json.loads(out)["body"]["mass"]
    assert again["body"]["part"].endswith("t_handle.stl")


def test_a_part_with_several_densities_comes_back_as_its_tensor(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = str(tmp_path / "run.rrd")
    bar = str(path("two_region_bar.vtk"))
    regions = json.loads(run(capsys, "check", bar, "--json")[1])
    assert regions["schema"] == "inertia/check/1"
    arguments = ("--density", "1=1000", "--density", "2=3000", "--unit", "mm")
    code, out, _ = run(capsys, "tumble", bar, *SPIN, *arguments, "-o", file, "--json")
    assert code == 0
    again = json.loads(run(capsys, "simulate", file, "--json")[1])
    assert again["body"]["part"] is None
    assert again["attitude"][-1] == pytest.approx(json.loads(out)["attitude"][-1], abs=1e-12)


def test_overwriting_asks_for_force(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "run.rrd"
    file.write_bytes(b"old")
    code, out, err = run(capsys, "simulate", SCENE, "--samples", "11", "--for", "1", "-o", str(file))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "--force" in err
    assert file.read_bytes() == b"old"
    assert run(capsys, "simulate", SCENE, "--samples", "11", "--for", "1", "-o", str(file), "--force")[0] == 0
    assert verified(file, tmp_path)


@pytest.mark.parametrize(
    ("code", "arguments", "message"),
    [
        (2, ["simulate", SCENE, "-o", "run.txt"], "its name must end in .rrd"),
        (2, ["simulate", SCENE, "-o", "run.rrd", "--explain"], "--explain runs nothing that could be recorded"),
        (1, ["simulate", SCENE, "-o", "none/run.rrd"], "name a folder that is there"),
        (3, ["simulate", "none.rrd"], "cannot read none.rrd: there is no such file"),
        (3, ["play", "none.rrd"], "cannot read none.rrd: there is no such file"),
        (3, ["play", HANDLE], "it is no Rerun recording"),
        (3, ["play", HANDLE, "--png", "a.png"], "it is no Rerun recording"),
        (2, ["play", HANDLE, "--at", "1"], "--at is of pictures: add --png FILE or --gif FILE"),
        (2, ["play", HANDLE, "--png", "a.png", "--fps", "9"], "--fps is of moving pictures: add --gif FILE"),
        (2, ["play", HANDLE, "--gif", "a.png"], "cannot write a.png: its name must end in .gif"),
    ],
)
def test_a_fault_is_one_sentence_and_a_code(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    code: int,
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, *arguments)
    assert (status, out, err.count("\n")) == (code, "", 1)
    assert message in err
    assert list(tmp_path.iterdir()) == []


def test_live_needs_a_viewer(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "VIEWER", ("127.0.0.1", 1))
    code, out, err = run(capsys, "simulate", SCENE, "--live")
    assert (code, out) == (1, "")
    assert "no viewer listens on 127.0.0.1:1" in err


@pytest.fixture
def recording(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> str:
    file = str(tmp_path / "run.rrd")
    assert run(capsys, "tumble", HANDLE, *SPIN, "-o", file)[0] == 0
    return file


def test_the_viewer_listens_on_this_machine_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, recording: str
) -> None:
    commands = []

    def fake(command: list[str], check: bool) -> "subprocess.CompletedProcess[str]":
        commands.append(command)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr("subprocess.run", fake)
    monkeypatch.setenv("DISPLAY", ":0")
    assert run(capsys, "play", recording) == (0, "", "")
    (command,) = commands
    assert Path(command[0]).stem == "rerun"
    assert command[1] == recording
    assert command[command.index("--bind") + 1] == "127.0.0.1"


def test_a_page_is_written_once(capsys: pytest.CaptureFixture[str], recording: str, tmp_path: Path) -> None:
    file = tmp_path / "run.html"
    file.write_text("old")
    code, out, err = run(capsys, "play", recording, "--html", str(file))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "--force" in err
    assert run(capsys, "play", recording, "--html", str(file), "--force") == (0, "", "")
    assert file.read_text(encoding="utf-8").startswith("<!doctype html>")


@pytest.mark.skipif("sys.platform != 'linux'", reason="how a screen is known")
def test_without_a_screen_it_says_what_to_do(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, recording: str
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    code, out, err = run(capsys, "play", recording)
    assert (code, out, err.count("\n")) == (1, "", 1)
    assert "there is no screen" in err
    assert "--web" in err
    assert "--html FILE" in err


def test_a_viewer_that_fails_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, recording: str
) -> None:
    monkeypatch.setattr("subprocess.run", lambda command, check: subprocess.CompletedProcess(command, 7))
    monkeypatch.setenv("DISPLAY", ":0")
    code, _, err = run(capsys, "play", recording)
    assert (code, err.count("\n")) == (1, 1)
    assert "ended with code 7" in err


def test_a_rotor_needs_a_viewer_too(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "VIEWER", ("127.0.0.1", 1))
    code, out, err = run(capsys, "balance", str(path("rotors/disc.toml")), "--live")
    assert (code, out) == (1, "")
    assert "no viewer listens on 127.0.0.1:1" in err


def test_a_balanced_rotor_is_recorded(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = run(capsys, "balance", str(path("rotors/disc.toml")), "-o", str(tmp_path / "rotor.rrd"))
    assert (code, err) == (0, "")
    assert properties(tmp_path / "rotor.rrd")["verdict"] == {"outcome": "pass"}


@pytest.mark.parametrize("name", ["rotors/disc.toml", "assemblies/weighed_fan.toml"])
def test_a_recorded_rotor_is_balanced_again(capsys: pytest.CaptureFixture[str], name: str, tmp_path: Path) -> None:
    file = str(tmp_path / "rotor.rrd")
    code, out, _ = run(capsys, "balance", str(path(name)), "-o", file, "--json")
    again = run(capsys, "balance", file, "--json")
    assert (again[0], again[2]) == (code, "")
    first, second = json.loads(out), json.loads(again[1])
    assert first["tolerance_planes"] == second["tolerance_planes"]
    assert first["corrections"] == second["corrections"]


def test_a_viewer_that_never_answers_takes_no_result_along(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, table = tmp_path / "run.rrd", tmp_path / "run.csv"
    outputs = ("-o", str(file), "-o", str(table))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        monkeypatch.setattr(live, "VIEWER", listener.getsockname())
        monkeypatch.setattr(live, "PATIENCE", 0.2)
        code, out, err = run(capsys, "simulate", SCENE, "--for", "2", "--samples", "11", *outputs, "--live", "--json")
    assert (code, err.count("\n")) == (0, 1), err
    assert "took nothing for 0.2 s before it had all; the result and its files are whole" in err
    assert len(json.loads(out)["time"]) == 11
    assert verified(file, tmp_path)
    assert table.read_text().count("\n") == 13


def test_an_interrupted_live_run_leaves_what_it_has(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    take, blocks = Preview.take, []

    def interrupted(preview: Preview, *samples: Float) -> None:
        take(preview, *samples)
        blocks.append(samples)
        if len(blocks) == 30:
            raise KeyboardInterrupt

    monkeypatch.setattr(Preview, "take", interrupted)
    monkeypatch.setattr(observer, "INTERVAL", 0.0)
    file = tmp_path / "run.rrd"
    stepped = ("--for", "5", "--samples", "501", "--method", "DOP853", "--accuracy", "1e-6")
    with listening(tmp_path / "home", "--serve-grpc", "--port", "0") as (address, _, _):
        monkeypatch.setattr(live, "VIEWER", (address.split(":")[0], int(address.split(":")[1])))
        code, out, err = run(capsys, "simulate", SCENE, *stepped, "--live", "-o", str(file), "-o", f"{file}.csv")
    assert (code, out) == (130, "")
    first, second = err.splitlines()
    assert f"{file} has the first" in first
    assert "of 5 s, as far as they were computed: their accuracy is not judged" in first
    assert second == "inertia: interrupted"
    assert not Path(f"{file}.csv").exists()
    assert verified(file, tmp_path)
    assert run(capsys, "simulate", str(file), "--json")[0] == 0


def test_two_scenes_are_recorded_over_each_other(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    first, both = str(tmp_path / "first.rrd"), str(tmp_path / "both.rrd")
    settings = ("--for", "2", "--samples", "21")
    assert run(capsys, "simulate", SCENE, *settings, "-o", first)[0] == 0
    code, _, err = run(capsys, "simulate", first, "--compare", str(path("scenes/thrown_box.toml")), "-o", both)
    assert (code, err) == (0, "")
    assert properties(Path(both))["other_scene"]["name"] == "thrown_box.toml"
    code, out, err = run(capsys, "simulate", SCENE, "--compare", first)
    assert (code, out) == (2, "")
    assert "--compare is seen in a recording: add --output FILE.rrd, or --live" in err
