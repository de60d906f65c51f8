"""The command `play`: open a recording in Rerun's viewer."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from inertia.errors import InertiaError
from inertia.standard_input import file_of
from inertia_cli.interruption import interruption

_LOCAL = ["--bind", "127.0.0.1"]
_WEB = ["--web-viewer", "--web-viewer-port", "0", "--port", "auto"]


def add(parsers: Any) -> None:
    """Add ``inertia play``."""
    parser = parsers.add_parser(
        "play",
        help="open a recording in Rerun's viewer",
        description="Open a recording in Rerun's viewer, which listens on this machine only.",
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part", metavar="RUN", help="a recording, as `inertia simulate -o run.rrd` writes it; - for standard input"
    )
    parser.add_argument("--web", action="store_true", help="in a browser of this machine; Ctrl-C ends it")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia play``."""
    import subprocess

    from inertia.recording.provenance import properties

    recording = str(file_of(options.part))
    properties(recording)
    if not options.web and not _has_screen():
        raise InertiaError(
            "there is no screen to open the viewer on: play the recording in a browser of this machine by --web, or "
            "copy it to a machine with a screen"
        )
    command = [_viewer(), recording, *_LOCAL, *(_WEB if options.web else [])]
    try:
        code = subprocess.run(command, check=False).returncode
    except KeyboardInterrupt:  # the way to end a server
        if interruption.code != 128 + signal.SIGINT:
            raise
        return 0
    if code:
        remedy = "see what it printed above" if options.web else "see what it printed above, or try --web"
        raise InertiaError(f"Rerun's viewer ended with code {code}: {remedy}")
    return 0


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _viewer() -> str:
    package = find_spec("rerun_cli")  # comes with rerun-sdk
    assert package is not None
    assert package.origin is not None
    return str(Path(package.origin).with_name("rerun.exe" if sys.platform == "win32" else "rerun"))
