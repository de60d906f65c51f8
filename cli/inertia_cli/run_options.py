"""The options of `simulate` and `tumble`."""

from __future__ import annotations

import argparse
from typing import Any

from inertia_cli import play_commands, run_commands
from inertia_cli.shared_options import add_density, add_input, triple

_SIMULATE = """examples:
  inertia simulate scene.toml
  inertia simulate scene.toml --explain
  inertia simulate scene.toml --for 3600 --samples 5 --json
  inertia simulate scene.toml -o run.rrd && inertia play run.rrd
  inertia simulate run.rrd                                    # again, by its own scene
"""

_TUMBLE = """examples:
  inertia tumble t_handle.stl --spin 0.001,10,0 --for 60
  inertia tumble part.stl --unit in --spin 0,0,25 --for 2 --json
  inertia tumble part.stl --spin 0,3,1 --for 20 -o run.rrd && inertia play run.rrd
"""


def add_run_commands(parsers: Any) -> None:
    """Add ``inertia simulate``, ``inertia tumble`` and ``inertia play``."""
    scene = parsers.add_parser(
        "simulate",
        help="follow the motion that a scene file describes",
        description="Follow a body through a scene, by the smallest model that the scene needs.",
        epilog=_SIMULATE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    scene.set_defaults(run=run_commands.simulate)
    scene.add_argument(
        "part", metavar="SCENE", help="a TOML file of body, start, constraint, load and run; or a recording"
    )
    changed = scene.add_argument_group("in place of what the scene says")
    changed.add_argument("--for", dest="duration", type=float, metavar="SECONDS", help="how long to follow the body")
    _add_settings(changed)
    _add_result(scene)

    part = parsers.add_parser(
        "tumble",
        help="let a part spin freely, and follow it",
        description="Let a part spin with no torque on it, and follow its attitude.",
        epilog=_TUMBLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    part.set_defaults(run=run_commands.tumble)
    add_input(part)
    add_density(part)
    run = part.add_argument_group("run")
    run.add_argument(
        "--spin", type=triple, required=True, metavar="X,Y,Z", help="rad/s along the principal axes, moments ascending"
    )
    run.add_argument(
        "--for", dest="duration", type=float, required=True, metavar="SECONDS", help="how long to follow the part"
    )
    _add_settings(run)
    _add_result(part)

    recording = parsers.add_parser(
        "play",
        help="open a recording in Rerun's viewer",
        description="Open a recording in Rerun's viewer, which listens on this machine only.",
    )
    recording.set_defaults(run=play_commands.play)
    recording.add_argument("part", metavar="RUN", help="a recording, as `inertia simulate -o run.rrd` writes it")
    recording.add_argument("--web", action="store_true", help="in a browser of this machine; Ctrl-C ends it")


def _add_settings(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--samples", type=int, metavar="N", help="instants, evenly spaced, both ends included")
    group.add_argument("--accuracy", type=float, metavar="RAD", help="of the attitude at every instant")
    group.add_argument("--model", metavar="NAME", help="use this model, not the smallest one")
    group.add_argument("--method", metavar="NAME", help="integrate step by step, by this method")


def _add_result(parser: argparse.ArgumentParser) -> None:
    result = parser.add_argument_group("result")
    result.add_argument("--explain", action="store_true", help="say which model would run and why, and do not run it")
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/run/1)")
    result.add_argument("-o", "--output", metavar="FILE", help="record to FILE.rrd, for `inertia play`")
    result.add_argument("--force", action="store_true", help="write over FILE where it exists")
    result.add_argument("--live", action="store_true", help="stream to the Rerun viewer that is open on this machine")
