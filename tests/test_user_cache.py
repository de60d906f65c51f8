"""What is run from the cache is what this user stored there: not a bit of it changed, and by nobody else."""

import os
import pwd
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from inertia.native import COMPILE_ABOVE
from inertia.user_cache import CacheError, cache_folder, load, store

CONTENT = bytes(range(160, 224))
POSIX = pytest.mark.skipif(os.name != "posix", reason="files have no owners here")
STRANGER = 12345


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("INERTIA_CACHE", str(tmp_path / "a" / "cache"))
    return tmp_path / "a" / "cache"


@pytest.fixture
def stored(folder: Path) -> Path:
    store("kernel", CONTENT)
    return folder / "kernel"


def test_what_is_stored_is_loaded(folder: Path) -> None:
    assert load("kernel") is None
    assert not folder.exists()
    store("kernel", CONTENT)
    assert load("kernel") == CONTENT
    store("kernel", CONTENT[::-1])
    assert load("kernel") == CONTENT[::-1]
    assert load("another") is None
    assert sorted(path.name for path in folder.iterdir()) == ["kernel", "key"]


@POSIX
def test_folders_and_files_are_private(stored: Path) -> None:
    old = os.umask(0)
    try:
        shutil.rmtree(stored.parents[1])
        store("kernel", CONTENT)
    finally:
        os.umask(old)
    modes = [path.stat().st_mode & 0o777 for path in (stored.parents[1], stored.parent, stored, stored.parent / "key")]
    assert modes == [0o700, 0o700, 0o600, 0o600]


@pytest.mark.parametrize("name", ["kernel", "key"])
def test_not_a_bit_may_change(stored: Path, name: str) -> None:
    file = stored.parent / name
    content = file.read_bytes()
    flipped = bytearray(content)
    for bit in range(8 * len(content)):
        flipped[bit // 8] ^= 1 << bit % 8
        file.write_bytes(flipped)
        flipped[bit // 8] ^= 1 << bit % 8
        assert load("kernel") == b""
    for length in range(len(content)):
        file.write_bytes(content[:length])
        assert load("kernel") == b""
    file.write_bytes(content)
    assert load("kernel") == CONTENT


def test_a_file_under_another_name_or_by_another_key_is_not_it(
    stored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(stored, stored.parent / "another")
    assert load("another") == b""
    monkeypatch.setenv("INERTIA_CACHE", str(tmp_path / "b"))
    store("kernel", CONTENT)
    shutil.copy(stored, tmp_path / "b" / "kernel")
    assert load("kernel") == b""
    store("kernel", CONTENT)
    assert load("kernel") == CONTENT


@POSIX
@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777, 0o1777])
def test_a_folder_that_others_may_write_to_is_refused(stored: Path, mode: int) -> None:
    stored.parent.chmod(mode)
    says = rf"others may write to {stored.parent} \(its mode is {mode:04o}\)"
    with pytest.raises(CacheError, match=says):
        load("kernel")
    with pytest.raises(CacheError, match=says):
        store("kernel", CONTENT)


@POSIX
def test_a_folder_above_that_others_may_write_to_is_refused_unless_it_is_sticky(stored: Path) -> None:
    stored.parents[1].chmod(0o777)
    with pytest.raises(CacheError, match=f"others may write to {stored.parents[1]} "):
        load("kernel")
    stored.parents[1].chmod(0o1777)
    assert load("kernel") == CONTENT


@POSIX
@pytest.mark.parametrize("mode", [0o644, 0o640, 0o660, 0o606])
def test_a_key_that_others_may_read_is_made_again(stored: Path, mode: int) -> None:
    key = stored.parent / "key"
    key.chmod(mode)
    before = key.read_bytes()
    assert load("kernel") == b""
    store("kernel", CONTENT)
    assert key.stat().st_mode & 0o777 == 0o600
    assert key.read_bytes() != before
    assert load("kernel") == CONTENT


@POSIX
@pytest.mark.parametrize("name", ["kernel", "key"])
def test_a_link_a_pipe_or_a_folder_in_place_of_a_file_is_none(stored: Path, name: str) -> None:
    file = stored.parent / name
    file.rename(stored.parent / "elsewhere")
    file.symlink_to("elsewhere")
    assert load("kernel") == b""
    file.unlink()
    os.mkfifo(file, 0o600)
    assert load("kernel") == b""
    store("kernel", CONTENT)
    assert load("kernel") == CONTENT
    file.unlink()
    file.mkdir()
    assert load("kernel") == b""
    with pytest.raises(CacheError, match="cannot be written to"):
        store("kernel", CONTENT)


@POSIX
def test_what_belongs_to_another_user_is_not_loaded(stored: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    owner = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: STRANGER)
    with pytest.raises(CacheError, match=f"{stored.parent} belongs to user {owner}, not to user {STRANGER}"):
        load("kernel")
    with pytest.raises(CacheError, match=f"{stored.parent} belongs to user {owner}, not to user {STRANGER}"):
        store("kernel", CONTENT)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root can give files away")
def test_a_file_a_key_or_a_folder_above_that_somebody_else_owns(stored: Path) -> None:
    for file in (stored, stored.parent / "key"):
        os.chown(file, STRANGER, STRANGER)
        assert load("kernel") == b""
        store("kernel", CONTENT)
        assert load("kernel") == CONTENT
    os.chown(stored.parents[1], STRANGER, STRANGER)
    with pytest.raises(CacheError, match=f"{stored.parents[1]} belongs to user {STRANGER}"):
        load("kernel")


@POSIX
def test_a_user_without_a_home_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def unknown(user: int) -> None:
        raise KeyError(user)

    for name in ("INERTIA_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pwd, "getpwuid", unknown)
    with pytest.raises(CacheError, match="there is no home folder"):
        cache_folder()
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "inertia"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache_folder() == tmp_path / ".cache" / "inertia"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder() == tmp_path / "xdg" / "inertia"


def test_what_dead_processes_left_is_removed(stored: Path) -> None:
    for name, age in (("old.1.2.part", 2 * 3600), ("young.1.2.part", 60)):
        (stored.parent / name).write_bytes(b"half")
        then = stored.stat().st_mtime - age
        os.utime(stored.parent / name, (then, then))
    store("kernel", CONTENT)
    assert sorted(path.name for path in stored.parent.iterdir()) == ["kernel", "key", "young.1.2.part"]


@pytest.mark.skipif(sys.platform != "linux", reason="the limit on the size of a file is set as on Linux")
def test_a_full_disk_leaves_nothing_behind(folder: Path) -> None:
    program = f"""if True:
        import resource, signal
        from inertia.user_cache import CacheError, store
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (70, 70))
        for _ in range(3):
            try:
                store("kernel", {CONTENT!r})
            except CacheError as error:
                print(error)
    """
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == 3 * f"{folder} cannot be written to (File too large)\n"
    assert [path.name for path in folder.iterdir()] == ["key"]


@pytest.fixture
def hasty_threads() -> Iterator[None]:
    """Let threads take turns as often as they can."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(interval)


@pytest.mark.usefixtures("hasty_threads")
def test_several_at_once_agree_on_a_key(folder: Path) -> None:
    names = [f"kernel {k}" for k in range(8)]
    for _ in range(25):
        together = threading.Barrier(len(names))

        def begin(name: str, together: threading.Barrier = together) -> None:
            together.wait()
            store(name, CONTENT)

        threads = [threading.Thread(target=begin, args=(name,)) for name in names]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert [load(name) for name in names] == [CONTENT] * len(names)
        for file in folder.iterdir():
            file.unlink()


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A part of enough triangles that machine code at hand is loaded for it."""
    corners = 160
    u, v = np.meshgrid(np.arange(corners), np.arange(corners), indexing="ij")
    a, b = 2 * np.pi * u / corners, 2 * np.pi * v / corners
    points = np.stack([(3 + np.cos(b)) * np.cos(a), (3 + np.cos(b)) * np.sin(a), np.sin(b)], axis=-1).reshape(-1, 3)
    here, beside = u * corners + v, (u + 1) % corners * corners + v
    above, across = u * corners + (v + 1) % corners, (u + 1) % corners * corners + (v + 1) % corners
    faces = np.stack([here, beside, across, here, across, above], axis=-1).reshape(-1, 3)
    records = np.zeros(len(faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    records["corners"] = points[faces]
    file = tmp_path_factory.mktemp("ball") / "ball.stl"
    file.write_bytes(b" " * 80 + len(faces).to_bytes(4, "little") + records.tobytes())
    return file


def test_the_command_answers_the_same_whatever_is_in_the_cache(ball: Path, folder: Path) -> None:
    def analyse(compile_above: int = 50_000) -> tuple[str, str]:
        program = f"from inertia import native; native.COMPILE_ABOVE = {compile_above}; native.SHIPPED /= 'none'; "
        program += "from inertia_cli.main import run; run()"
        command = [sys.executable, "-c", program, "analyse", str(ball), "--no-intersections"]
        run = subprocess.run(command, capture_output=True, text=True, check=True)
        return run.stdout, run.stderr

    answer, errors = analyse()
    assert errors == ""
    file = min(folder.glob("sum_facets-*"))
    content = bytearray(file.read_bytes())
    content[40] ^= 4  # in the head of the machine code: its first bytes are the hash
    file.write_bytes(content)
    again = "inertia: a compiled kernel in the cache was damaged, or is not from here: it is compiled again\n"
    assert analyse() == (answer, again)
    assert analyse() == (answer, "")
    file.write_bytes(content)
    folder.chmod(0o777)
    says = (
        f"inertia: compiled kernels are not kept: others may write to {folder} (its mode is 0777): "
        "set INERTIA_CACHE to a folder of your own that can be written to\n"
    )
    assert analyse(COMPILE_ABOVE) == (answer, says)
