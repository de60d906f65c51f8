"""Files that are whole or not there."""

import sys
from pathlib import Path

import pytest

from inertia.errors import InertiaError, UsageError
from inertia.output import require_writable, write_whole


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
        ("folder.rrd", UsageError, "it is a directory"),
        ("none/run.rrd", InertiaError, "No such file or directory: name a folder that is there"),
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
