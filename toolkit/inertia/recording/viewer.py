"""Rerun's viewer as a program that is run for its answers: it listens on this machine only, and reports to nobody."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from inertia.errors import InertiaError

_NOWHERE = "http://127.0.0.1:9"
"""What is given as proxy to a viewer that would look for a newer release."""
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
            "pip install --force-reinstall 'rerun-sdk>=0.41,<0.42'"
        )
    return file


@contextmanager
def listening(
    home: Path, address: re.Pattern[str], *options: str
) -> Iterator[tuple[str, subprocess.Popen[str], Callable[[], str]]]:
    """Run the program with a home folder of its own until the context is left.

    Yield where it listens, as the first line of its log says that holds an `address`, or "" where it ends before; its
    process; and what returns the rest of its log.
    """
    environment = {
        **({"WGPU_BACKEND": "vulkan"} if sys.platform == "linux" else {}),  # without a window it ends with another
        **os.environ,
        **dict.fromkeys(("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"), str(home)),
        **dict.fromkeys(("ALL_PROXY", "HTTPS_PROXY", "HTTP_PROXY"), _NOWHERE),
        "NO_PROXY": "127.0.0.1",
        "CI": "1",  # no statistics
        "NO_COLOR": "1",
        "RUST_LOG": "info",
    }
    command = [str(program()), "--bind", "127.0.0.1", *options]
    if sys.platform == "linux":
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
    rest = threading.Thread(target=lambda: log.extend(process.stdout or ()), daemon=True)  # else it would wait
    try:
        match = next((match for line in process.stdout or () if (match := address.search(line))), None)
        rest.start()
        yield match[1] if match else "", process, lambda: _all(rest, log)
    finally:
        process.kill()
        process.wait()
        if rest.is_alive():
            rest.join()
        if process.stdout is not None:
            process.stdout.close()


def _all(rest: threading.Thread, log: list[str]) -> str:
    """Return a log of a program that has ended."""
    rest.join()
    return "".join(log)
