"""The command `play`: open a recording in Rerun's viewer or in a browser, or make a page or pictures of it."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path
from typing import Any

from inertia.errors import InertiaError, UsageError, visible
from inertia.standard_input import file_of
from inertia_cli.interruption import interruption
from inertia_cli.progress import Progress

_MOVING = "frames", "fps"
_PICTURE = "at", "view", "size", *_MOVING

_EXAMPLES = """examples:
  inertia play run.rrd
  inertia play run.rrd --html run.html
  inertia play run.rrd --gif run.gif --frames 120 --size 640x400
"""


def add(parsers: Any) -> None:
    """Add ``inertia play``."""
    parser = parsers.add_parser(
        "play",
        help="open a recording in Rerun's viewer, or make a page or pictures of it",
        description="Open a recording in Rerun's viewer, which listens on this machine only, or make a page or "
        "pictures of it.",
        epilog=_EXAMPLES,
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
    where.add_argument("--png", metavar="FILE", help="draw one instant, without a screen")
    where.add_argument("--gif", metavar="FILE", help="draw as many frames as --frames says, as fast as it plays")
    picture = parser.add_argument_group("pictures")
    picture.add_argument("--at", type=float, metavar="SECONDS", help="of the run, where the picture is or begins (0)")
    picture.add_argument("--view", metavar="NAME", help="draw this view alone; the beginning of its name will do")
    picture.add_argument("--size", type=_size, metavar="WxH", help="of the picture, in pixels (1280x800)")
    picture.add_argument("--frames", type=int, metavar="N", help="of a GIF (60)")
    picture.add_argument("--fps", type=float, metavar="RATE", help="frames of a GIF in a second (15)")
    parser.add_argument("--force", action="store_true", help="write over FILE where it exists")


def _size(text: str) -> tuple[int, int]:
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"{text!r} is no size: give one as 1280x800")
    return int(width), int(height)


def run(options: argparse.Namespace) -> int:
    """Run ``inertia play``."""
    from inertia.recording.provenance import properties

    recording = file_of(options.part)
    wanted = {name: getattr(options, name) for name in _PICTURE if getattr(options, name) is not None}
    file = options.gif if options.png is None else options.png
    for name in wanted:
        if file is None or (options.png is not None and name in _MOVING):
            kind = "moving pictures: add" if name in _MOVING else "pictures: add --png FILE or"
            raise UsageError(f"--{name} is of {kind} --gif FILE")
    if file is not None:
        from inertia.output import require_writable
        from inertia.recording.pictures import export_picture

        require_writable(file, ".gif" if options.png is None else ".png", force=options.force)
        with Progress("drawing") as progress:
            export_picture(recording, file, **wanted, force=options.force, progress=progress)
        return 0
    if options.html is not None:
        from inertia.recording.web import export_html

        export_html(recording, options.html, force=options.force)
        return 0
    properties(recording)
    if options.web:
        return _serve(recording, options.part)
    if not _has_screen():
        raise InertiaError(
            "there is no screen to open the viewer on: play the recording in a browser of this machine by --web, make "
            "a page of it by --html FILE, or copy it to a machine with a screen"
        )
    return _open(recording)


def _open(recording: Path) -> int:
    """Open the viewer, and wait until it is closed."""
    import subprocess

    from inertia.recording.viewer import program, require_name

    require_name(recording)
    code = subprocess.run([str(program()), str(recording), "--bind", "127.0.0.1"], check=False).returncode
    if code:
        raise InertiaError(f"Rerun's viewer ended with code {code}: see what it printed above, or try --web")
    return 0


def _serve(recording: Path, name: str) -> int:
    """Answer browsers of this machine until a signal ends it; the name is the one that was given."""
    from inertia.recording.web import served

    with served(recording) as (address, server):
        print(f"{address} plays {visible(Path(name).name)} until Ctrl-C ends it", flush=True)
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
