"""The command in a process of its own, to be killed, starved or misled, and what its files look like afterwards."""

from __future__ import annotations

import os
import select
import signal
import sys
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from inertia_cli.main import run

LIMIT = 60.0
"""s, after which a process is killed: a hang."""

OLD = b"what was there before"


@dataclass(frozen=True)
class End:
    """How a process ended: its exit code, or the negative number of a signal, and what it printed."""

    code: int
    out: str
    err: str
    seconds: float


def run_process(
    arguments: Sequence[str],
    folder: Path,
    *,
    meanwhile: Callable[[int], None] = lambda _: None,
    environment: Mapping[str, str] | None = None,
    fork: bool = True,
) -> End:
    """Run a command line in a process of its own; `meanwhile(pid)` runs beside it.

    It is a fork of this process, whose modules are loaded, or a new one with another environment.
    """
    out, err = folder.parent / "stdout", folder.parent / "stderr"
    began = time.monotonic()
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    if fork:
        pid = os.fork()
        if pid == 0:
            _become(arguments, out, err, flags)
    else:
        command = [sys.executable, "-c", "from inertia_cli.main import run; run()", *arguments]
        streams = [(os.POSIX_SPAWN_OPEN, stream, str(file), flags, 0o600) for stream, file in ((1, out), (2, err))]
        pid = os.posix_spawn(sys.executable, command, {**os.environ, **(environment or {})}, file_actions=streams)
    handle = os.pidfd_open(pid)
    try:
        meanwhile(pid)
        if not select.select([handle], [], [], LIMIT)[0]:
            os.kill(pid, signal.SIGKILL)
    finally:
        os.close(handle)
        status = os.waitpid(pid, 0)[1]
    text = (file.read_text(encoding="utf-8", errors="replace") for file in (out, err))
    return End(os.waitstatus_to_exitcode(status), *text, time.monotonic() - began)


def _become(arguments: Sequence[str], out: Path, err: Path, flags: int) -> None:
    """Run the command in the child of a fork; does not return."""
    try:
        for stream, file in ((1, out), (2, err)):
            os.dup2(os.open(file, flags, 0o600), stream)
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115
        sys.argv = ["inertia", *arguments]
        run()
    except SystemExit as leaving:
        code = leaving.code if isinstance(leaving.code, int) else 1
    except BaseException:
        traceback.print_exc()
        code = 99
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def outputs(number: int, folder: Path, parts: Path) -> tuple[list[str], list[Path]]:
    """Return one of several command lines, and the files that it writes into a folder."""
    rotor = ["balance", str(parts / "rotors" / "two_disc_rotor.toml")]
    part = str(parts / "cube.stl")
    match number % 4:
        case 0:
            files = [folder / name for name in ("report.html", "planes.csv", "cut.stl")]
            line = [*rotor, "--report", str(files[0]), "--csv", str(files[1]), "--cut-part", str(files[2])]
        case 1:
            files = [folder / "planes.csv"]
            line = [*rotor, "--csv", str(files[0]), "--json"]
        case 2:
            files = [folder / "run.rrd"]
            line = ["tumble", part, "--spin", "1,2,3", "--for", "1", "-o", str(files[0])]
        case _:
            files = [folder / "trade.svg"]
            line = ["trade", part, "--budget", "0.05", "--repeats", "1", "--plot", str(files[0])]
    return line, files


def whole(file: Path) -> bool:
    """Return whether an output is complete."""
    data = file.read_bytes()
    match file.suffix:
        case ".html":
            return data.rstrip().endswith(b"</html>")
        case ".svg":
            return data.rstrip().endswith(b"</svg>")
        case ".csv":
            return data.endswith(b"\n") and data.count(b"\n") > 2
        case ".stl":
            return len(data) == 84 + 50 * int.from_bytes(data[80:84], "little")
        case _:
            return data[:4] == b"RRF2" and len(data) > 1000


def fault_in_files(folder: Path, files: Sequence[Path], before: bool) -> str:
    """Return what is wrong with outputs that should be all there or none, where `before` says that others were."""
    there = [file for file in files if file.exists()]
    new = [file for file in there if file.read_bytes() != OLD]
    if before and len(there) < len(files):
        return f"{sorted(file.name for file in {*files} - {*there})} vanished"
    if new and len(new) < len(files):
        return f"a mixture: {[file.name for file in new]} of {[file.name for file in files]}"
    if damaged := [file.name for file in new if not whole(file)]:
        return f"half-written: {damaged}"
    return ""


def stray(folder: Path, files: Sequence[Path]) -> list[str]:
    """Return the names of what else is in the folder."""
    return sorted(file.name for file in folder.iterdir() if file not in files)
