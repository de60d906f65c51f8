"""The converter of STEP files: its limits of time and memory, and its end."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.mesh.readers.step_sample import step_sphere

from inertia.errors import ReadError, UsageError
from inertia.mesh.read import read

pytest.importorskip("OCP")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of a process, and its death with its parent")


@pytest.fixture
def sphere(tmp_path: Path) -> Path:
    path = tmp_path / "ball.step"
    path.write_text(step_sphere(10.0))
    return path


def convert_by(work: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the converter do something else."""
    (folder / "OCP.py").write_text(work)
    monkeypatch.setenv("PYTHONPATH", str(folder))


@pytest.mark.parametrize(("work", "seconds"), [("while True: pass", 1), ("import time; time.sleep(60)", 0.1)])
def test_a_conversion_that_does_not_end_is_ended(
    work: str, seconds: float, sphere: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    convert_by(work, tmp_path, monkeypatch)
    monkeypatch.setenv("INERTIA_STEP_SECONDS", str(seconds))
    begin = time.monotonic()
    with pytest.raises(ReadError, match=r"OpenCASCADE took longer than . s .*set INERTIA_STEP_SECONDS to more"):
        read(sphere)
    assert time.monotonic() - begin < 60


@pytest.mark.parametrize("work", ["bytes(2**40)", "import os; os.kill(os.getpid(), 9)"])
def test_a_conversion_that_fills_the_memory_is_ended(
    work: str, sphere: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    convert_by(work, tmp_path, monkeypatch)
    monkeypatch.setenv("INERTIA_STEP_GIB", "1.5")
    with pytest.raises(ReadError, match=r"OpenCASCADE needs more than 1.5 GiB of memory.*set INERTIA_STEP_GIB to more"):
        read(sphere)


def test_a_conversion_that_crashes_is_a_sentence(sphere: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    convert_by("import os; os.kill(os.getpid(), 11)", tmp_path, monkeypatch)
    with pytest.raises(ReadError, match=r"OpenCASCADE cannot convert it \(status -11\): export the part again"):
        read(sphere)


def test_a_full_disk_of_temporary_files_is_not_put_down_to_the_file(
    sphere: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    convert_by(f"raise OSError({errno.ENOSPC}, 'full')", tmp_path, monkeypatch)
    with pytest.raises(ReadError, match=r"ball.step: there is no room for temporary files: .*TMPDIR"):
        read(sphere)


def test_it_converts_within_the_usual_limits(sphere: Path) -> None:
    assert read(sphere).triangles.count > 1000


@pytest.mark.parametrize("value", ["none", "-1", "inf", "nan"])
def test_a_limit_that_is_none_is_refused(value: str, sphere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INERTIA_STEP_SECONDS", value)
    with pytest.raises(UsageError, match=r"INERTIA_STEP_SECONDS is .*: it must be a positive number"):
        read(sphere)


def test_the_converter_ends_with_whoever_started_it_and_what_it_left_is_removed(
    sphere: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tmp").mkdir()
    convert_by(
        f"import os, time; from pathlib import Path; Path({str(tmp_path / 'new')!r}).write_text(str(os.getpid())); "
        f"os.rename({str(tmp_path / 'new')!r}, {str(tmp_path / 'pid')!r}); time.sleep(600)",
        tmp_path,
        monkeypatch,
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path / "tmp")}
    code = "import sys; from inertia.mesh.read import read; read(sys.argv[1])"
    parent = subprocess.Popen([sys.executable, "-c", code, str(sphere)], env=environment)
    while not (tmp_path / "pid").exists():
        time.sleep(0.05)
    number = int((tmp_path / "pid").read_text())
    parent.kill()
    parent.wait()
    for _ in range(100):
        if not Path(f"/proc/{number}").exists() or "State:\tZ" in Path(f"/proc/{number}/status").read_text():
            break
        time.sleep(0.05)
    else:
        pytest.fail("the converter is still there")
    assert len(list((tmp_path / "tmp").iterdir())) == 1
    monkeypatch.setenv("INERTIA_STEP_SECONDS", "1")
    (tmp_path / "OCP.py").write_text("raise ValueError")
    subprocess.run([sys.executable, "-c", code, str(sphere)], env=environment, check=False, stderr=subprocess.DEVNULL)
    assert list((tmp_path / "tmp").iterdir()) == []
