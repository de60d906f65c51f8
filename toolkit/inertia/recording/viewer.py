"""Rerun's viewer as a program that is run for its answers: it listens on this machine only, and reports to nobody."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from inertia.errors import InertiaError, ReadError

_NOWHERE = "http://127.0.0.1:9"
"""What is given as proxy to a viewer that would look for a newer release."""
_PATIENCE = 60.0  # s, until it listens
# It ends with the process that started it, however that ends.
_TIED = (
    "import ctypes, os, sys; ctypes.CDLL(None).prctl(1, 9); "  # PR_SET_PDEATHSIG, SIGKILL
    "os.getppid() == int(sys.argv[1]) or os._exit(1); os.execv(sys.argv[2], sys.argv[2:])"
)


def program() -> Path:
    """Return the path of Rerun's program, which comes with rerun-sdk."""
    spec = find_spec("rerun_cli")
    file = Path(spec.origin if spec and spec.origin else "").with_name(
        "rerun.exe" if sys.platform == "win32" else "rerun"
    )
    if not file.is_file():
        raise InertiaError(
            f"the viewer is missing from the installed rerun-sdk {version('rerun-sdk')}: install one with it by "
            "pip install --force-reinstall 'rerun-sdk>=0.41,<0.42'",
            code="needs_package",
        )
    return file


def require_name(recording: Path) -> None:
    """Raise `ReadError` where the name of a recording is not one by which the viewer knows it for one."""
    if recording.suffix.lower() != ".rrd":
        raise ReadError(
            f"cannot read {recording}: Rerun's viewer opens recordings by names in .rrd: call it "
            f"{recording.with_suffix('.rrd').name}"
        )


@contextmanager
def listening(home: Path, *options: str) -> Iterator[tuple[str, subprocess.Popen[str], Callable[[], str]]]:
    """Run the program with a home folder of its own until the context is left.

    Yield where it listens, as "127.0.0.1:9876", or "" where it does not; its process; and what returns its log when it
    has ended.
    """
    environment = {
        **({"WGPU_BACKEND": "vulkan"} if sys.platform == "linux" else {}),  # without a window it ends with another
        **os.environ,
        **dict.fromkeys(("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"), str(home)),
        **dict.fromkeys(("ALL_PROXY", "HTTPS_PROXY", "HTTP_PROXY", "all_proxy", "https_proxy", "http_proxy"), _NOWHERE),
        **dict.fromkeys(("NO_PROXY", "no_proxy"), "127.0.0.1"),
        "CI": "1",  # no statistics
        "NO_COLOR": "1",
        "RUST_LOG": "error",
    }
    command = [str(program()), "--bind", "127.0.0.1", *options]
    if sys.platform == "linux" and sys.executable:
        command = [sys.executable, "-ISc", _TIED, str(os.getpid()), *command]
    process = subprocess.Popen(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    log: list[str] = []
    lines = threading.Thread(target=lambda: log.extend(process.stdout or ()), daemon=True)
    lines.start()
    try:
        yield _address(process), process, lambda: _all(lines, log)
    finally:
        process.kill()
        process.wait()
        lines.join()
        if process.stdout is not None:
            process.stdout.close()


def _address(process: subprocess.Popen[str]) -> str:
    """Return where a process listens as soon as it does; "" where it ends before, or never does."""
    import psutil

    end = time.monotonic() + _PATIENCE
    while process.poll() is None and time.monotonic() < end:
        with suppress(psutil.Error):
            for each in psutil.Process(process.pid).net_connections("tcp4"):
                if each.status == psutil.CONN_LISTEN:
                    return f"{each.laddr.ip}:{each.laddr.port}"
        time.sleep(0.02)
    return ""


def _all(lines: threading.Thread, log: list[str]) -> str:
    """Return the log of a program that has ended."""
    lines.join()
    return "".join(log)
