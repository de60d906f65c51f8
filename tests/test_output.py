"""Files that are whole or not there."""

import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import pytest

from inertia.errors import InertiaError, UsageError
from inertia.output import remove_left_behind, require_writable, temporary_folder, together, whole, write_whole


def test_a_file_that_is_there_is_kept_unless_forced(tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    path.touch()
    with pytest.raises(UsageError, match="exists: give another name, or force=True"):
        require_writable(path, ".rrd")
    assert require_writable(path, ".rrd", force=True) == path


@pytest.mark.parametrize(
    ("name", "kind", "message"),
    [
        ("run.txt", UsageError, "must end in .svg or .rrd"),
        ("folder.rrd", UsageError, "it is a directory: name a file in it"),
        ("none/run.rrd", InertiaError, "No such file or directory: name a folder that is there"),
        ("long" * 64 + ".rrd", InertiaError, "File name too long: give a shorter name"),
    ],
)
def test_an_unusable_place_is_refused(tmp_path: Path, name: str, kind: type[Exception], message: str) -> None:
    (tmp_path / "folder.rrd").mkdir()
    with pytest.raises(kind, match=message):
        require_writable(tmp_path / name, ".svg", ".rrd")


@pytest.mark.skipif(sys.platform != "linux", reason="a folder that even root cannot write to")
def test_an_unwritable_folder_is_refused() -> None:
    with pytest.raises(InertiaError, match=r"cannot write /proc/run.rrd: .*: name a"):
        require_writable("/proc/run.rrd", ".rrd")


def test_asking_leaves_nothing_behind(tmp_path: Path) -> None:
    require_writable(tmp_path / "part.stl", ".stl")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffixes", [(), (".rrd",)])
def test_a_name_that_is_empty_is_called_so(suffixes: tuple[str, ...]) -> None:
    with pytest.raises(UsageError, match=r"^the name of a file to be written is empty: name one$"):
        require_writable("", *suffixes)


@pytest.mark.skipif(sys.platform == "win32", reason="no such permissions")
@pytest.mark.parametrize("rights", [0o600, 0o660, 0o755, 0o444, 0o000])
def test_a_file_that_is_replaced_hands_on_its_permissions(tmp_path: Path, rights: int) -> None:
    file = tmp_path / "table.csv"
    file.write_bytes(b"old")
    file.chmod(rights)
    link = tmp_path / "link.csv"
    link.symlink_to(file)
    with whole(link) as beside:
        assert beside.stat().st_mode & 0o077 == 0
        beside.write_bytes(b"new")
    status = file.stat()
    assert status.st_mode & 0o777 == rights
    file.chmod(0o600)
    assert file.read_bytes() == b"new"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away")
def test_a_file_that_is_replaced_hands_on_its_owner_and_group(tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    file.write_bytes(b"old")
    os.chown(file, 1234, 4321)
    write_whole(file, b"new")
    assert (file.stat().st_uid, file.stat().st_gid) == (1234, 4321)


@pytest.mark.skipif(sys.platform == "win32", reason="no such permissions")
def test_a_group_that_cannot_be_handed_on_leaves_none_with_rights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*arguments: object) -> None:
        raise PermissionError

    file = tmp_path / "table.csv"
    file.write_bytes(b"old")
    file.chmod(0o660)
    monkeypatch.setattr(os, "chown", refuse)
    write_whole(file, b"new")
    assert file.stat().st_mode & 0o777 == 0o600


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege")
def test_a_link_stays_and_what_it_leads_to_is_written(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    link, file = tmp_path / "link.html", tmp_path / "there" / "file.html"
    file.touch()
    link.symlink_to(file)
    write_whole(link, b"new")
    assert link.is_symlink()
    assert file.read_bytes() == b"new"
    assert list(file.parent.iterdir()) == [file]


def test_a_fault_while_writing_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(InertiaError, match=r"cannot write .*folder: .*: name a place"):
        write_whole(tmp_path / "folder", b"new")
    assert list(tmp_path.iterdir()) == [tmp_path / "folder"]


def test_files_that_belong_together_appear_together_or_not_at_all(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_bytes(b"old")
    with together():
        write_whole(one, b"new")
        write_whole(other, b"new")
        assert one.read_bytes() == b"old"
        assert not other.exists()
    assert one.read_bytes() == other.read_bytes() == b"new"
    with suppress(ZeroDivisionError), together():
        write_whole(one, b"newer")
        assert 1 / 0
    assert one.read_bytes() == b"new"
    assert sorted(tmp_path.iterdir()) == [one, other]


def test_where_one_cannot_be_put_in_place_none_is(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()

    def write() -> None:
        with together():
            write_whole(tmp_path / "one", b"new")
            write_whole(tmp_path / "other", b"new")

    with pytest.raises(InertiaError, match=r"cannot write .*other: Is a directory"):
        write()
    assert list(tmp_path.iterdir()) == [tmp_path / "other"]


@pytest.mark.skipif(sys.platform == "win32", reason="no locks of whole files")
def test_files_of_a_run_that_died_are_removed_and_those_of_a_live_one_are_not(tmp_path: Path) -> None:
    code = (
        "import os, sys, time; from pathlib import Path; from inertia.output import whole\n"
        "with whole(Path(sys.argv[1])) as beside:\n"
        "    print(beside, flush=True); time.sleep(60)"
    )
    runs = [
        subprocess.Popen([sys.executable, "-c", code, str(tmp_path / name)], stdout=subprocess.PIPE, text=True)
        for name in ("dead.html", "live" * 60 + ".html")
    ]
    assert runs[0].stdout
    assert runs[1].stdout
    dead, live = (Path(run.stdout.readline().strip()) for run in runs if run.stdout)
    runs[0].kill()
    runs[0].wait()
    mine = [tmp_path / name for name in (".notes.inertia", ".x.0123.inertia", "x.0123456789ab.inertia")]
    for file in mine:
        file.touch()
    assert dead.exists()
    write_whole(tmp_path / "new.html", b"new")
    assert sorted(tmp_path.iterdir()) == sorted([*mine, live, tmp_path / "new.html"])
    for run in runs:
        run.kill()
        run.communicate()


@pytest.mark.skipif(sys.platform == "win32", reason="which has no locks of this kind")
@pytest.mark.parametrize("made", ["folder", "file"])
def test_what_another_run_takes_for_dead_before_it_is_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made: str
) -> None:
    import fcntl

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    lock, removed = fcntl.flock, []

    def after_another(file: int, how: int) -> None:
        if not how & fcntl.LOCK_NB and not removed:
            removed.extend(tmp_path.glob(".*.inertia"))
            remove_left_behind(tmp_path)
        lock(file, how)

    monkeypatch.setattr(fcntl, "flock", after_another)
    if made == "folder":
        with temporary_folder() as folder:
            assert [*tmp_path.iterdir()] == [folder]
    else:
        write_whole(tmp_path / "table.csv", b"1, 2")
        assert [*tmp_path.iterdir()] == [tmp_path / "table.csv"]
    assert len(removed) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege")
def test_a_link_to_nothing_is_followed_and_one_to_itself_refused(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("file")
    (tmp_path / "loop").symlink_to("loop")
    write_whole(require_writable(tmp_path / "link"), b"new")
    assert (tmp_path / "file").read_bytes() == b"new"
    with pytest.raises(InertiaError, match=r"cannot write .*loop: Too many levels of symbolic links"):
        require_writable(tmp_path / "loop", force=True)


@pytest.mark.skipif(not Path("/dev/null").exists(), reason="no devices")
def test_a_device_is_not_replaced() -> None:
    with pytest.raises(UsageError, match="cannot write /dev/null: it is not a regular file"):
        require_writable("/dev/null", force=True)


def test_that_no_folder_takes_temporary_files_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    says = "no folder for temporary files can be written to .*: set TMPDIR to one"
    with pytest.raises(InertiaError, match=says), temporary_folder():
        pass


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="root lists every folder")
def test_a_folder_that_cannot_be_listed_can_be_written_to(tmp_path: Path) -> None:
    tmp_path.chmod(0o300)
    write_whole(tmp_path / "new", b"new")
    tmp_path.chmod(0o700)
    assert (tmp_path / "new").read_bytes() == b"new"


def test_an_interruption_waits_until_all_are_in_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    replace, done = Path.replace, []

    def interrupted(self: Path, target: Path) -> Path:
        done.append(target)
        result = replace(self, target)
        if len(done) == 1:
            raise KeyboardInterrupt
        return result

    monkeypatch.setattr(Path, "replace", interrupted)

    def write() -> None:
        with together():
            for name in "abc":
                write_whole(tmp_path / name, b"new")

    with pytest.raises(KeyboardInterrupt):
        write()
    assert [file.name for file in done] == ["a", "b", "c"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a", "b", "c"]
