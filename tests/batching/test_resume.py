"""What an earlier run has answered counts only where nothing that it rests on has changed."""

import errno
import gzip
import hashlib
import json
import os
import re
import shutil
import zipfile
from contextlib import closing
from pathlib import Path
from typing import IO, Any

import pytest

import inertia
from inertia.batching.answer import Answer, Setup, answer
from inertia.batching.sources import Task
from inertia.batching.table import Parts
from inertia.mesh import version
from inertia_meshes import path

CUBE, BOX, CUT = path("cube.stl"), path("box.stl"), path("broken/truncated.stl")


def kept(task: Task, setup: Setup, folder: Path) -> Answer:
    """Keep the answer of a run."""
    first = answer(task, setup)
    with closing(Parts(folder, setup)) as parts:
        parts.add(task, first)
    return first


def test_a_file_that_was_refused_for_memory_is_asked_for_with_more(tmp_path: Path) -> None:
    task, folder = Task(str(CUBE)), tmp_path / "a.csv.parts"
    less, more = Setup("analyse", memory=1 << 20), Setup("analyse", memory=1 << 33)
    with closing(Parts(folder, less)) as parts:
        parts.add(task, Answer(less.empty(task) | {"state": "refused"}, ()))
    assert Parts(folder, less).answer(task) is not None
    assert Parts(folder, more).answer(task) is None


@pytest.mark.parametrize("name", ["cut.stl", "none.stl"])
def test_a_file_that_could_not_be_read_is_read_again(name: str, tmp_path: Path) -> None:
    file, setup, folder = tmp_path / name, Setup("analyse"), tmp_path / "a.csv.parts"
    if name == "cut.stl":
        shutil.copy(CUT, file)
    assert kept(Task(str(file)), setup, folder).row["state"] == "unreadable"
    assert Parts(folder, setup).answer(Task(str(file))) is None


def packed(folder: Path) -> Task:
    zipped(folder / "x.zip", CUBE)
    return Task(f"{folder}/x.zip/a.stl", {}, f"{folder}/x.zip", "a.stl")


def test_what_found_no_folder_for_temporary_files_is_asked_for_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    task, setup, folder = packed(tmp_path), Setup("analyse"), tmp_path / "a.csv.parts"
    monkeypatch.setenv("TMPDIR", str(tmp_path / "none"))
    row = kept(task, setup, folder).row
    assert (row["state"], row["exit_code"]) == ("unreadable", inertia.WriteError.exit_code)
    assert f"TMPDIR is {tmp_path}/none" in row["message"]
    assert Parts(folder, setup).answer(task) is None


@pytest.mark.parametrize("kind", ["member", "url", "gzip"])
def test_a_full_disk_of_temporary_files_is_not_put_down_to_the_file(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("fsspec")

    opened = Path.open

    def full(file: Path, mode: str = "r", *others: object, **more: object) -> IO[Any]:
        if isinstance(file, Path) and "x" not in mode:
            return opened(file, mode, *others, **more)  # type: ignore[call-overload]
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "open", full)
    monkeypatch.setattr("fsspec.implementations.local.LocalFileSystem.get_file", full)
    (tmp_path / "b.stl.gz").write_bytes(gzip.compress(CUBE.read_bytes()))
    task = {"member": packed(tmp_path), "url": Task(CUBE.as_uri()), "gzip": Task(f"{tmp_path}/b.stl.gz")}[kind]
    row = answer(task, Setup("analyse")).row
    assert (row["state"], row["exit_code"]) == ("unreadable", 3)
    assert re.fullmatch(r"cannot read .*: there is no room for temporary files: .*TMPDIR.*", row["message"])


def test_what_is_behind_a_url_is_asked_for_again(tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    file, setup, folder = tmp_path / "x.stl", Setup("analyse"), tmp_path / "a.csv.parts"
    shutil.copy(CUBE, file)
    task = Task(file.as_uri())
    assert kept(task, setup, folder).row["state"] == "answered"
    assert Parts(folder, setup).answer(task) is None


@pytest.mark.parametrize("there", [True, False])
def test_a_mesh_of_a_robot_that_comes_or_changes_is_noticed(there: bool, tmp_path: Path) -> None:
    robot, mesh = tmp_path / "robot.urdf", tmp_path / "part.stl"
    robot.write_text(
        '<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"'
        ' iyz="0"/></inertial><collision><geometry><mesh filename="part.stl"/></geometry></collision></link></robot>'
    )
    if there:
        shutil.copy(CUBE, mesh)
    setup, folder, task = Setup("audit"), tmp_path / "a.csv.parts", Task(str(robot))
    first = kept(task, setup, folder)
    assert Parts(folder, setup).answer(task) is not None or first.row["state"] == "unreadable"
    shutil.copy(BOX, mesh)
    os.utime(mesh, (1, 1))
    assert Parts(folder, setup).answer(task) is None


@pytest.mark.parametrize("arc", ["(subLayers = [@b.usda@])", 'def "x" (references = @b.usda@) {}', "packed"])
def test_a_layer_of_a_stage_that_changes_is_noticed(arc: str, tmp_path: Path) -> None:
    """One that lies beside it, or within one in a package."""
    pytest.importorskip("pxr")
    from pxr import UsdUtils

    inner, stage, setup, folder = tmp_path / "b.usda", tmp_path / "a.usda", Setup("audit"), tmp_path / "a.csv.parts"
    inner.write_text(
        '#usda 1.0\n(defaultPrim = "b")\ndef "b" (prepend apiSchemas = ["PhysicsMassAPI"]) {\nfloat physics:mass = 1\n}'
    )
    if arc == "packed":
        UsdUtils.CreateNewUsdzPackage(str(inner), str(inner := tmp_path / "b.usdz"))
        arc = "(subLayers = [@b.usdz@])"
    stage.write_text(f"#usda 1.0\n{arc}")
    task = Task(str(stage))
    first = kept(task, setup, folder)
    assert {each.path for each in first.files} == {str(stage), str(inner)}
    assert Parts(folder, setup).answer(task) is not None
    inner.write_bytes(inner.read_bytes().replace(b"mass = 1", b"mass = 2"))
    os.utime(inner, (1, 1))
    assert Parts(folder, setup).answer(task) is None


def test_a_file_that_changes_while_it_is_answered_for_is_asked_for_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, setup, folder = tmp_path / "x.stl", Setup("analyse"), tmp_path / "a.csv.parts"
    shutil.copy(CUBE, file)
    verbs = vars(__import__("inertia.batching.answer", fromlist=["_VERBS"]))["_VERBS"]
    plain = verbs["analyse"]

    def changed(*given: object) -> None:
        plain(*given)
        shutil.copy(BOX, file)
        os.utime(file, (2, 2))

    monkeypatch.setitem(verbs, "analyse", changed)
    assert kept(Task(str(file)), setup, folder).row["state"] == "answered"
    assert Parts(folder, setup).answer(Task(str(file))) is None


def zipped(file: Path, part: Path) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        for name in ("a.stl", "b.stl"):
            archive.write(part, name)


@pytest.mark.parametrize("verb", ["analyse", "audit", "balance"])
def test_what_changes_beside_while_it_is_answered_for_is_asked_for_again(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An archive, a mesh that was not there, and the file of a verb that is hashed when all is done."""
    disc = tmp_path / "rotor/disc.toml"
    task, change = {
        "analyse": (
            Task(f"{tmp_path}/x.zip/a.stl", {}, f"{tmp_path}/x.zip", "a.stl"),
            lambda: zipped(tmp_path / "x.zip", BOX),
        ),
        "audit": (Task(f"{tmp_path}/robot/arm.urdf"), lambda: shutil.copy(path("t_handle.stl"), tmp_path)),
        "balance": (Task(str(disc)), lambda: disc.write_text(disc.read_text().swapcase())),
    }[verb]
    zipped(tmp_path / "x.zip", CUBE)
    for name, place in (("robots/arm.urdf", "robot"), ("rotors/disc.toml", "rotor"), ("disc.stl", ".")):
        (tmp_path / place).mkdir(exist_ok=True)
        shutil.copy(path(name), tmp_path / place)
    verbs = vars(__import__("inertia.batching.answer", fromlist=["_VERBS"]))["_VERBS"]
    plain, setup = verbs[verb], Setup(verb)
    assert kept(task, setup, tmp_path / "before").row["state"] == "answered"
    assert Parts(tmp_path / "before", setup).answer(task) is not None

    def changed(*given: object) -> None:
        plain(*given)
        change()

    monkeypatch.setitem(verbs, verb, changed)
    assert kept(task, setup, tmp_path / "meanwhile").row["state"] == "answered"
    assert Parts(tmp_path / "meanwhile", setup).answer(task) is None


def test_a_file_that_changes_while_it_takes_too_long_is_asked_for_again(tmp_path: Path) -> None:
    file, setup, folder = tmp_path / "x.stl", Setup("analyse", timeout=9.0), tmp_path / "a.csv.parts"
    shutil.copy(CUBE, file)
    task, before = Task(str(file)), file.stat()
    with closing(Parts(folder, setup)) as parts:
        parts.add(task, setup.failed(task, "timed_out", "it took longer", 9.0, before))
    assert Parts(folder, setup).answer(task) is not None
    shutil.copy(BOX, file)
    assert Parts(folder, setup).answer(task) is None


def test_an_archive_is_hashed_once_for_all_of_its_members(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hashed, sha256_of = [], version.sha256_of
    monkeypatch.setattr("inertia.batching.answer.sha256_of", lambda *of: hashed.append(of[0]) or sha256_of(*of))
    archive = tmp_path / "x.zip"
    zipped(archive, CUBE)
    first, second = (
        answer(Task(f"{archive}/{name}", {}, str(archive), name), Setup("analyse")) for name in ("a.stl", "b.stl")
    )
    assert first.files == second.files
    assert first.files[0].sha256 == hashlib.sha256(archive.read_bytes()).hexdigest()
    assert hashed == [archive]


@pytest.mark.skipif(not os.access("/dev/shm", os.W_OK), reason="there is no /dev/shm")
def test_files_in_shared_memory_are_files() -> None:
    folder = Path("/dev/shm") / f"inertia-test-{os.getpid()}"
    folder.mkdir()
    try:
        shutil.copy(CUBE, folder / "x.stl")
        files = answer(Task(str(folder / "x.stl")), Setup("analyse")).files
        assert [file.path for file in files] == [str(folder / "x.stl")]
        robot = folder / "robot.urdf"
        robot.write_text(
            '<robot name="r"><link name="a"><collision><geometry><mesh filename="x.stl"/></geometry></collision>'
            "</link></robot>"
        )
        files = answer(Task(str(robot)), Setup("audit")).files
        assert str(folder / "x.stl") in [file.path for file in files]
    finally:
        shutil.rmtree(folder)


def test_a_kept_row_is_one_line_of_json(tmp_path: Path) -> None:
    folder = tmp_path / "a.csv.parts"
    kept(Task(str(CUBE)), Setup("analyse"), folder)
    (part,) = folder.iterdir()
    (line,) = part.read_text().splitlines()
    assert json.loads(line)["row"]["path"] == str(CUBE)
