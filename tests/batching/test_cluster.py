"""Under Dask a batch has the same rows: from a scheduler of its own, and from one that is there."""

import os
import re
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


def local(**options: Any) -> Any:
    """Return a scheduler that listens, without a worker unless asked for."""
    return distributed.LocalCluster(
        **{"n_workers": 0, "threads_per_worker": 1, "processes": False, "protocol": "tcp", **options},
        dashboard_address=":0",
        silence_logs=50,
    )


def asked(verb: str, file: Path, dask: str) -> Any:
    """Ask the workers for a file."""
    return list(inertia.batch(file, dask=dask)) if verb == "batch" else inertia.analyse(inertia.read(file), dask=dask)


BOTH = pytest.mark.parametrize("verb", ["batch", "analyse"])


def test_paths_are_relative_to_the_folder_of_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder, part in (("here", "cube.stl"), ("there", "t_handle.stl")):
        (tmp_path / folder / "in").mkdir(parents=True)
        (tmp_path / folder / "in/part.stl").write_bytes(path(part).read_bytes())
    manifest = tmp_path / "here/in/parts.csv"
    manifest.write_text("path,density\npart.stl,7850\nnone.stl,1\n")
    monkeypatch.chdir(tmp_path / "there")
    with local(n_workers=1, processes=True) as cluster:
        monkeypatch.chdir(tmp_path / "here")
        names = [Path("in/part.stl"), Path("in/parts.csv")]
        assert rows(names, dask=cluster.scheduler_address) == rows(names, jobs=1)


def test_a_folder_that_a_worker_has_not_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia.batching.cluster.Path.cwd", lambda: Path("/nowhere"))
    with local(n_workers=1) as cluster:
        with pytest.raises(
            inertia.InertiaError, match=r"worker at tcp://.* has no folder /nowhere, which a.stl is rel"
        ):
            asked("batch", Path("a.stl"), cluster.scheduler_address)
        (row,) = asked("batch", FILES[0], cluster.scheduler_address)
        assert row["state"] == "answered"


@BOTH
def test_a_worker_of_another_version_is_refused(verb: str, monkeypatch: pytest.MonkeyPatch) -> None:
    says = rf"worker at tcp://.* has version 0\.0\.9 of inertia, and this is {re.escape(inertia.__version__)}: install"
    monkeypatch.setitem(vars(inertia), "__version__", "0.0.9")
    with local(n_workers=1) as cluster, pytest.raises(inertia.InertiaError, match=says) as refusal:
        asked(verb, FILES[0], cluster.scheduler_address)
    assert refusal.value.code == "workers"


@BOTH
def test_a_worker_without_the_program_is_refused(verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "inertia.py").write_text("raise ImportError('not in here')\n")
    with monkeypatch.context() as elsewhere:
        elsewhere.setattr("sys.path", [str(tmp_path), *sys.path])
        cluster = local(n_workers=1, processes=True)
    says = r"worker at tcp://.* cannot import inertia \(not in here\): install version"
    with cluster, pytest.raises(inertia.InertiaError, match=says):
        asked(verb, FILES[0], cluster.scheduler_address)


@BOTH
def test_where_there_is_no_worker_that_is_said_and_waited_for_a_while(
    verb: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("inertia.scheduler.LOOK", 0.05)
    monkeypatch.setattr("inertia.scheduler.SOON", 0.1)
    monkeypatch.setattr("inertia.scheduler.LONG", 1)
    with (
        local() as cluster,
        pytest.warns(inertia.errors.WaitingWarning, match="the Dask scheduler has no worker: waiting for one"),
        pytest.raises(inertia.InertiaError, match="has had no worker for 1 s: start workers, and run again"),
    ):
        asked(verb, FILES[0], cluster.scheduler_address)


def test_a_scheduler_that_ends_is_said(files: list[Path]) -> None:
    with local(n_workers=1) as cluster:
        answers = inertia.batch(files, dask=cluster.scheduler_address)
        assert next(answers)["state"] == "answered"
        cluster.close()
        with pytest.raises(inertia.InertiaError, match="the Dask scheduler does not answer any more: start it again"):
            list(answers)


def test_a_scheduler_that_is_not_there_is_refused() -> None:
    with pytest.raises(inertia.UsageError, match="no Dask scheduler answers at tcp://"):
        list(inertia.batch(FILES, dask="tcp://127.0.0.1:1"))
