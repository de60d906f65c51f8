"""`-` in place of a file: every command reads standard input."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import pytest
from tests.recording.screenshot import has_driver

from inertia_cli.main import main
from inertia_meshes import path

_RUN = [sys.executable, "-c", "from inertia_cli.__main__ import run; run()"]
_SCENE = """
[body]
mass = 1.0
inertia = [[1.0, 0, 0], [0, 2.0, 0], [0, 0, 3.0]]
[start]
angular_velocity = [0.1, 2, 0.1]
[run]
duration = 1.0
"""


def run(*arguments: str, data: bytes = b"", folder: Path | None = None) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([*_RUN, *arguments], input=data, capture_output=True, cwd=folder)


@pytest.mark.parametrize("name", ["cube.stl", "cube_ascii.stl", "shaft_impeller.obj", "two_region_bar.vtk"])
def test_a_part_is_told_by_its_contents(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    data = path(name).read_bytes()
    main(["analyse", str(path(name)), "--json"])
    piped = run("analyse", "-", "--json", data=data)
    assert piped.stderr == b""
    expected, result = json.loads(capsys.readouterr().out), json.loads(piped.stdout)
    assert result["source"] == {**expected["source"], "path": "-", "sha256": hashlib.sha256(data).hexdigest()}
    result.pop("source")
    expected.pop("source")
    assert result == expected


_TUMBLE = ("--spin", "1,2,3", "--for", "1")
_BALANCE = ("--axis", "z", "--bearings", "20,280", "--planes", "90,215", "--rpm", "3000", "--grade", "6.3")


@pytest.mark.parametrize(
    ("arguments", "name", "code"),
    [
        (("check", "-"), "cube.stl", 0),
        (("check", "-"), "broken/missing_face.stl", 4),
        (("analyse", "-", "--accuracy", "exact"), "cube_ascii.stl", 0),
        (("analyse", "-", "--repair"), "cube.stl", 0),
        (("analyse", "-", "--format", "stl"), "cube.stl", 0),
        (("trade", "-", "--repeats", "1", "--budget", "0.1"), "cube.stl", 0),
        (("tumble", "-", *_TUMBLE), "box.stl", 0),
        (("balance", "-", *_BALANCE), "two_disc_rotor.stl", 5),
        (("balance", "-", "--to-toml"), "rotors/disc.toml", 0),
    ],
)
def test_every_command_reads_it(arguments: tuple[str, ...], name: str, code: int, tmp_path: Path) -> None:
    result = run(*arguments, data=path(name).read_bytes(), folder=path(name).parent)
    assert (result.returncode, result.stderr) == (code, b"")
    assert result.stdout


def test_a_scene_may_come_in() -> None:
    result = run("simulate", "-", data=_SCENE.encode())
    assert (result.returncode, result.stderr) == (0, b"")


def test_a_recording_of_what_came_in(tmp_path: Path) -> None:
    data = path("box.stl").read_bytes()
    result = run("tumble", "-", *_TUMBLE, "-o", "run.rrd", data=data, folder=tmp_path)
    assert (result.returncode, result.stderr) == (0, b"")
    assert [file.name for file in tmp_path.iterdir()] == ["run.rrd"]


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_what_is_played_is_called_as_it_was_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "s.toml").write_text(_SCENE)
    assert run("simulate", "s.toml", "-o", "run.rrd", folder=tmp_path).returncode == 0
    with (tmp_path / "run.rrd").open("rb") as data:
        server = subprocess.Popen([*_RUN, "play", "-", "--web"], stdin=data, stdout=subprocess.PIPE)
    with server:
        assert server.stdout is not None
        line = server.stdout.readline()
        server.terminate()
    assert line.endswith(b" plays - until Ctrl-C ends it\n")


@pytest.mark.skipif(not has_driver(), reason="no Vulkan driver is installed")
def test_a_picture_of_what_came_in(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(_SCENE)
    assert run("simulate", "s.toml", "-o", "run.rrd", folder=tmp_path).returncode == 0
    data = (tmp_path / "run.rrd").read_bytes()
    arguments = ("--png", "run.png", "--size", "320x240")
    result = subprocess.run([*_RUN, "play", "-", *arguments], input=data, stderr=-1, cwd=tmp_path, timeout=120)
    assert (result.returncode, result.stderr) == (0, b"")
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "data", "code", "says"),
    [
        (("analyse", "-"), b"", 3, "cannot read -: it is empty: export the part again"),
        (("analyse", "-"), b"nothing", 3, "cannot read -: neither its contents nor its name tell what it is"),
        (("balance", "-"), b"\xff", 3, "cannot read -: it is no text in UTF-8"),
        (("trade", "-"), b"start = ", 3, "cannot read -: it is not TOML"),
        (("simulate", "-"), b"x", 3, "cannot read -: it is not TOML"),
        (("play", "-"), b"x", 3, "it is no Rerun recording"),
        (("budget", "-"), b"# bill\n\nname,mass,mass\nx,1,2\n", 3, "its first line names the column `mass` twice"),
        (("assembly", "-"), b"  # bill\r\nName;Mass\r\nx;1;2\r\n", 3, "line 3 has 3 cells, and the first line 2"),
        (("assembly", "-"), b'name = "a, name"\n', 2, "part is missing"),
    ],
)
def test_what_cannot_be_read(arguments: tuple[str, ...], data: bytes, code: int, says: str) -> None:
    result = run(*arguments, data=data)
    assert result.returncode == code
    assert says in result.stderr.decode()
    assert result.stderr.count(b"\n") == 1


def test_what_is_written_for_another_program_has_a_name() -> None:
    result = run("analyse", "-", "--as", "urdf", data=path("cube.stl").read_bytes())
    assert result.stderr == b""
    assert b'<link name="part">' in result.stdout


@pytest.mark.skipif(sys.platform == "win32", reason="descriptors")
def test_it_is_closed() -> None:
    import os

    result = subprocess.run([*_RUN, "check", "-"], preexec_fn=lambda: os.close(0), capture_output=True)
    assert (result.returncode, result.stderr) == (
        3,
        b"inertia: cannot read -: standard input is closed: name a file\n",
    )


def test_a_robot_is_told_by_its_contents(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arm = path("robots/arm.urdf")
    there = main(["audit", str(arm), "--json"])
    piped = run("audit", "-", "--json", "--fix", str(tmp_path / "fixed"), data=arm.read_bytes(), folder=arm.parent)
    assert (there, piped.returncode) == (5, 5)
    assert piped.stderr.endswith(
        b"not found from there: write it into the folder one stands in, from where they are named\n"
    )
    expected, result = json.loads(capsys.readouterr().out), json.loads(piped.stdout)
    assert result["source"] == {**expected["source"], "path": "-"}
    assert result["links"] == expected["links"]
    assert (tmp_path / "fixed").read_bytes().count(b"<!-- mended: ") == 4


@pytest.mark.parametrize(
    "data",
    [
        b"name,mass,ixx,iyy,izz,ixy,ixz,iyz,mesh,unit\ncube,1,1,1,1,0,0,0,cube.stl,mm\n",
        b"\xef\xbb\xbfName;Mass;Ixx;Iyy;Izz;Ixy;Ixz;Iyz;Mesh;Unit\r\ncube;1;1;1;1;0;0;0;cube.stl;mm\r\n",
        b"# parts\n\nmass\tixx\tiyy\tizz\tixy\tixz\tiyz\tNAME\n1\t1\t1\t1\t0\t0\t0\tcube\n",
        b"sep=,\n,name,mass,ixx,iyy,izz,ixy,ixz,iyz\n0,cube,1,1,1,1,0,0,0\n",
        b"part = [{name = 'cube', mass = 1, inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]\n",
        b'# parts\n[[part]]\nname = "cube"\nmass = 1\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nmesh = "cube.stl"\n',
    ],
)
def test_a_list_of_parts_is_told_by_its_contents(data: bytes) -> None:
    result = run("audit", "-", "--json", data=data, folder=path("cube.stl").parent)
    assert [link["name"] for link in json.loads(result.stdout)["links"]] == ["cube"]
    assert run("audit", "-", data=b"nothing").returncode == 3


_BILL = b'name,shape,size,mass\n1,box,"[3, 2, 1]",0.5\n'
_OBJ = b"v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.mark.parametrize("command", ["assembly", "budget"])
@pytest.mark.parametrize(
    ("data", "mass"),
    [
        (_BILL, 0.5),
        (b'name = "a, b"\n[[part]]\nname = "b"\nshape = "point"\nmass = 0.25\n', 0.25),
        (_OBJ, 1e-6 * 1000 / 6),
        (b'<robot name="r"><link name="l"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
         b'ixz="0" iyz="0"/></inertial></link></robot>', 2),
    ],
)  # fmt: skip
def test_a_tree_is_told_by_its_contents(command: str, data: bytes, mass: float, tmp_path: Path) -> None:
    result = run(command, "-", "--json", data=data, folder=tmp_path)
    document = json.loads(result.stdout)
    assert document.get("total", document)["mass"] == pytest.approx(mass)


def test_a_file_that_is_called_as_standard_input_is(tmp_path: Path) -> None:
    (tmp_path / "-").write_bytes(b'[[part]]\nname = "b"\nshape = "point"\nmass = 0.25\n')
    assert json.loads(run("assembly", "./-", "--json", data=_BILL, folder=tmp_path).stdout)["mass"] == 0.25


def test_what_came_in_is_no_file_that_an_assembly_could_name(tmp_path: Path) -> None:
    result = run("assembly", "-", "--to-toml", data=_OBJ, folder=tmp_path)
    assert (result.returncode, b"standard input has no name" in result.stderr) == (2, True)


def test_what_cannot_be_judged_is_called_as_it_was_named() -> None:
    result = run("balance", "-", "--json", data=path("two_disc_rotor.stl").read_bytes())
    assert result.returncode == 4
    assert result.stderr.startswith(b"inertia: -: nothing says what is permissible")
