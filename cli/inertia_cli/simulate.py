"""The command `simulate`, and how a scene is followed."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import UsageError
from inertia_cli.options import record, require_recordable
from inertia_cli.printing import show, write_and_show
from inertia_cli.wording import with_options

if TYPE_CHECKING:
    from inertia.dynamics.scene.document import Scene

_OPTIONS = {
    "duration": "--for",
    "samples": "--samples",
    "accuracy": "--accuracy",
    "model": "--model",
    "method": "--method",
    "time_limit": "--time-limit",
}
FIELDS = {f"run.{name}": option for name, option in _OPTIONS.items()} | {"start.angular_velocity": "--spin"}
"""The options that stand for fields of a scene."""

_EXAMPLES = """examples:
  inertia simulate scene.toml
  inertia simulate scene.toml --explain
  inertia simulate scene.toml --for 3600 --samples 5 --json
  inertia simulate scene.toml -o run.rrd && inertia play run.rrd
  inertia simulate run.rrd                                    # again, by its own scene
"""


def add(parsers: Any) -> None:
    """Add ``inertia simulate``."""
    parser = parsers.add_parser(
        "simulate",
        help="follow the motion that a scene file describes",
        description="Follow a body through a scene, by the smallest model that the scene needs.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part",
        metavar="SCENE",
        help="a TOML file of body, start, constraint, load and run (- for standard input); or a recording",
    )
    overrides = parser.add_argument_group("in place of what the scene says")
    overrides.add_argument("--for", dest="duration", type=float, metavar="SECONDS", help="how long to follow the body")
    add_settings(overrides)
    add_result(parser)


def add_settings(group: argparse._ArgumentGroup) -> None:
    """Add how a motion is followed."""
    group.add_argument("--samples", type=int, metavar="N", help="instants, evenly spaced, both ends included")
    group.add_argument("--accuracy", type=float, metavar="RAD", help="of the attitude at every instant")
    group.add_argument("--model", metavar="NAME", help="use this model, not the smallest one")
    group.add_argument("--method", metavar="NAME", help="integrate step by step, by this method")
    group.add_argument("--time-limit", type=float, metavar="SECONDS", help="of computing, for the whole run (60)")


def add_result(parser: argparse.ArgumentParser) -> None:
    """Add what is made of a run."""
    result = parser.add_argument_group("result")
    result.add_argument("--explain", action="store_true", help="say which model would run and why, and do not run it")
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/run/1)")
    result.add_argument("-o", "--output", metavar="FILE", help="record to FILE.rrd, for `inertia play`")
    result.add_argument("--force", action="store_true", help="write over FILE where it exists")
    result.add_argument("--live", action="store_true", help="stream to the Rerun viewer that is open on this machine")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia simulate``."""
    from inertia.dynamics.scene.document import Scene
    from inertia.mesh.readers.formats import format_of_name

    if format_of_name(Path(options.part)) is not None and Path(options.part).exists():
        raise UsageError(f"{options.part} is a mesh and no scene: name a scene file, or use `inertia tumble`")
    if Path(options.part).suffix.lower() == ".rrd":
        from inertia.recording.provenance import scene_of

        return follow(scene_of(options.part), options)
    return follow(Scene.load(options.part), options)


def follow(scene: Scene, options: argparse.Namespace) -> int:
    """Follow a scene, or say by which model it would be followed."""
    from dataclasses import replace

    from inertia.documents import FieldError
    from inertia.dynamics.plan import plan
    from inertia.dynamics.simulate import simulate as simulate_scene
    from inertia.report.run.document import plan_document, run_document
    from inertia.report.run.text import plan_text, run_text

    if options.explain and (options.output is not None or options.live):
        raise UsageError("--explain runs nothing that could be recorded: leave out --output and --live")
    require_recordable(options)
    overrides: dict[str, Any] = {name: value for name in _OPTIONS if (value := getattr(options, name)) is not None}
    try:
        scene = replace(scene, run=replace(scene.run, **overrides))
    except FieldError as error:
        raise with_options(error, FIELDS) from None
    if options.explain:
        selection = plan(scene)
        show(options.json, lambda: plan_document(scene, selection), lambda: plan_text(scene, selection))
        return 0
    motion = simulate_scene(scene)
    write_and_show(
        lambda: record(motion, options), options.json, lambda: run_document(motion), lambda: run_text(motion)
    )
    return 0
