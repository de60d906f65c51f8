"""The command `play`: open a recording in Rerun's viewer, in a browser, or as a page that needs neither."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path
from typing import Any

from inertia.errors import InertiaError, visible
from inertia.standard_input import file_of
from inertia_cli.interruption import interruption


def add(parsers: Any) -> None:
    """Add ``inertia play``."""
    parser = parsers.add_parser(
        "play",
        help="open a recording in Rerun's viewer, or make a page of it",
        description="Open a recording in Rerun's viewer, which listens on this machine only, or make a page of it.",
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part", metavar="RUN", help="a recording, as `inertia simulate -o run.rrd` writes it; - for standard input"
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--web", action="store_true", help="in a browser of this machine; Ctrl-C ends it")
    where.add_argument(
        "--html", metavar="FILE", help="write one page that plays in any browser, from the disk, without a network"
    )
    parser.add_argument("--force", action="store_true", help="write over FILE where it exists")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia play``."""
    from inertia.recording.provenance import properties

    recording = file_of(options.part)
    if options.html is not None:
        from inertia.recording.web import export_html

        export_html(recording, options.html, force=options.force)
        return 0
    properties(recording)
    if options.web:
        return _serve(recording)
    if not _has_screen():
        raise InertiaError(
            "there is no screen to open the viewer on: play the recording in a browser of this machine by --web, make "
            "a page of it by --html FILE, or copy it to a machine with a screen"
        )
    return _open(recording)


def _open(recording: Path) -> int:
    """Open the viewer, and wait until it is closed."""
    import subprocess

    from inertia.recording.viewer import program

    code = subprocess.run([str(program()), str(recording), "--bind", "127.0.0.1"], check=False).returncode
    if code:
        raise InertiaError(f"Rerun's viewer ended with code {code}: see what it printed above, or try --web")
    return 0


def _serve(recording: Path) -> int:
    """Answer browsers of this machine until a signal ends it."""
    from inertia.recording.web import served

    with served(recording) as (address, server):
        print(f"{address} plays {visible(recording.name)} until Ctrl-C ends it", flush=True)
        if _has_screen():
            import webbrowser

            webbrowser.open(address)
        try:
            server.serve_forever()
        except KeyboardInterrupt:  # the way to end a server
            if interruption.code != 128 + signal.SIGINT:
                raise
    return 0


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
