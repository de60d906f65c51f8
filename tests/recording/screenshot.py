"""What a user sees of a recording, without a screen: the viewer runs headless, on loopback only.

    python tests/recording/screenshot.py FILE.rrd OUT.png [SECONDS]

Leaves with an error where a view or the viewer reports one. Needs a Vulkan driver; one in software will do (Debian:
mesa-vulkan-drivers).
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

SIZE = "1600x1000"
DRIVERS = [Path(folder) / "vulkan/icd.d" for folder in ("/usr/share", "/usr/local/share", "/etc")]
_PATIENCE = 600.0


def has_driver() -> bool:
    """Say whether a Vulkan driver is installed."""
    return any(list(folder.glob("*.json")) for folder in DRIVERS)


def screenshot(recording: Path, picture: Path, seconds: float | None = None) -> tuple[list[str], list[str]]:
    """Write what is shown at a time; return the names of the views that are seen, and all errors."""
    with tempfile.TemporaryDirectory() as home, open_viewer(Path(home)) as (client, _):
        client.open(str(recording))
        _wait(lambda: not client.get_state().loading and client.get_state().recordings)
        if seconds is None:
            client.set_time(play_state="paused")
        else:
            client.set_time("time", duration=seconds, play_state="paused")
        picture.write_bytes(_settled(client))
        views = [view for view in client.get_state().views if view.visible]
        errors = [
            f"{view.name}: {report.summary}" for view in views for report in view.reports if report.severity == "error"
        ]
        errors += [f"{log.target}: {log.message}" for log in client.get_logs() if log.level == "ERROR"]
        return [view.name for view in views], errors


@contextmanager
def open_viewer(home: Path) -> Iterator[tuple[Any, int]]:
    """Open a viewer that has no window; yield what asks it, and the port that it listens on."""
    from rerun.experimental import ViewerClient
    from tests.recording.reading import viewer

    environment = {**os.environ, "HOME": str(home), "XDG_RUNTIME_DIR": str(home), "WGPU_BACKEND": "vulkan"}
    quiet = {"env": environment, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run([viewer(), "analytics", "disable"], check=True, **quiet)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    options = ["--headless", "--bind", "127.0.0.1", "--port", str(port), "--window-size", SIZE, "-j", "2"]
    process = subprocess.Popen([viewer(), *options, "--hide-welcome-screen"], **quiet)
    try:
        yield _wait(lambda: _connected(ViewerClient, process, f"rerun+http://127.0.0.1:{port}/proxy")), port
    finally:
        process.terminate()
        process.wait(120)


def _connected(kind: Any, process: subprocess.Popen[bytes], address: str) -> Any:
    if process.poll() is not None:
        raise RuntimeError(f"the viewer ended with {process.returncode}: is there a Vulkan driver?")
    try:
        client = kind.connect(address)
        client.get_state()
    except Exception:
        return None
    return client


def _settled(client: Any) -> bytes:
    """Return a picture that is the same as the one before: plots find their range late."""
    last = b""

    def same() -> bytes | None:
        nonlocal last
        time.sleep(0.3)
        last, before = client.take_screenshot(), last
        return last if last == before else None

    picture: bytes = _wait(same)
    return picture


def _wait(ready: Any) -> Any:
    end = time.monotonic() + _PATIENCE
    while not (answer := ready()):
        if time.monotonic() > end:
            raise TimeoutError("the viewer is not ready")
        time.sleep(0.1)
    return answer


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    names, faults = screenshot(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3]) if sys.argv[3:] else None)
    print(*names, *faults, sep="\n")
    sys.exit(1 if faults else 0)
