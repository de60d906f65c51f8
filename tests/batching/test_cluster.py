"""Under Dask a batch has the same rows: from a scheduler of its own, and from one that is there."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import inertia
from inertia_meshes import path

distributed = pytest.importorskip("distributed")

FILES = [path(name) for name in ("cube.stl", "broken/truncated.stl", "t_handle.stl", "broken/nan.stl")]


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    names = []
    for number in range(40):
        names.append(tmp_path / f"{number:02}.stl")
        names[-1].write_bytes(FILES[number % len(FILES)].read_bytes())
    return names


def rows(files: list[Path], **options: Any) -> list[dict[str, Any]]:
    result = list(inertia.batch(files, **options))
    for row in result:
        assert row.pop("seconds") is not None
    return result


def test_a_scheduler_of_its_own_gives_the_rows_of_processes(files: list[Path]) -> None:
    assert rows(files, dask="local", jobs=2) == rows(files, jobs=2)


def test_a_scheduler_that_is_there_gives_the_rows_of_processes(files: list[Path]) -> None:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=None
    ) as cluster:
        assert rows(files, dask=cluster.scheduler_address) == rows(files, jobs=1)


@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
def test_a_file_that_hangs_does_not_outlive_the_run(tmp_path: Path) -> None:
    hangs, started = tmp_path / "hangs.stl", tmp_path / "started"
    hangs.write_bytes(FILES[0].read_bytes())
    (tmp_path / "sitecustomize.py").write_text(
        "import os, pathlib, sys, time\n"
        "def hook(event, arguments):\n"
        f"    if event == 'open' and str(arguments[0]) == {str(hangs)!r}:\n"
        f"        pathlib.Path({str(started)!r}).write_text(str(os.getpid()))\n"
        "        time.sleep(600)\n"
        "sys.addaudithook(hook)\n"
    )
    command = [sys.executable, "-c", "from inertia_cli.__main__ import run; run()", "batch", str(hangs)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
    with subprocess.Popen([*command, "--dask", "local"], stderr=subprocess.DEVNULL, env=environment) as run:
        until = time.monotonic() + 60
        while not (started.exists() and started.read_text()) and time.monotonic() < until:
            time.sleep(0.05)
        run.send_signal(signal.SIGTERM)
        assert run.wait(20) == 128 + signal.SIGTERM
    assert not Path("/proc", started.read_text()).exists()


def test_a_scheduler_that_is_not_there_is_refused() -> None:
    with pytest.raises(inertia.UsageError, match="no Dask scheduler answers at tcp://"):
        list(inertia.batch(FILES, dask="tcp://127.0.0.1:1"))
