"""The commands that move a body: `simulate` and `tumble`."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import GeometryError, UsageError
from inertia_cli.commands import by_name
from inertia_cli.documents import print_document
from inertia_cli.wording import with_options

if TYPE_CHECKING:
    from inertia.dynamics.scene.document import Scene

_OPTIONS = {
    "duration": "--for",
    "samples": "--samples",
    "accuracy": "--accuracy",
    "model": "--model",
    "method": "--method",
}
_FIELDS = {f"run.{name}": option for name, option in _OPTIONS.items()} | {"start.angular_velocity": "--spin"}


def simulate(options: argparse.Namespace) -> int:
    """Run ``inertia simulate``."""
    from inertia.dynamics.scene.document import Scene
    from inertia.mesh.readers.formats import format_of_name

    if format_of_name(Path(options.part)) is not None:
        raise UsageError(f"{options.part} is a mesh and no scene: name a scene file, or use `inertia tumble`")
    if Path(options.part).suffix.lower() == ".rrd":
        from inertia.recording.provenance import scene_of

        return _follow(scene_of(options.part), options)
    return _follow(Scene.load(options.part), options)


def tumble(options: argparse.Namespace) -> int:
    """Run ``inertia tumble``."""
    from inertia.dynamics.scene.body import SceneBody
    from inertia.dynamics.scene.document import Scene
    from inertia.dynamics.scene.sections import Settings, Start
    from inertia.mass.analysis import analyse, sound_solids_only
    from inertia.mesh.read import read

    part = read(options.part, options.unit, format=options.format)
    density, material = by_name("density", options.density), by_name("material", options.material)
    with sound_solids_only("tumbling takes a sound solid only"):
        found = analyse(part, density, material=material, mass=options.mass)
    try:
        body, start, run = SceneBody.of_analysis(found), Start(options.spin), Settings(options.duration)
        return _follow(Scene(body, start, run, text=_text(options), name=options.part), options)
    except (UsageError, GeometryError) as error:
        raise with_options(error, _FIELDS) from None


def _follow(scene: Scene, options: argparse.Namespace) -> int:
    from inertia.documents import FieldError
    from inertia.dynamics.plan import plan
    from inertia.dynamics.simulate import simulate as simulate_scene
    from inertia.report.run.document import plan_document, run_document
    from inertia.report.run.text import plan_text, run_text

    if options.explain and (options.output is not None or options.live):
        raise UsageError("--explain runs nothing that could be recorded: leave out --output and --live")
    require_recordable(options)
    changed: dict[str, Any] = {name: value for name in _OPTIONS if (value := getattr(options, name)) is not None}
    try:
        scene = replace(scene, run=replace(scene.run, **changed))
    except FieldError as error:
        raise with_options(error, _FIELDS) from None
    if options.explain:
        chosen = plan(scene)
        if options.json:
            print_document(plan_document(scene, chosen))
        else:
            print(plan_text(scene, chosen))
        return 0
    run = simulate_scene(scene)
    try:
        if options.output is not None or options.live:
            from inertia.recording.record import record

            record(run, options.output, force=options.force, live=options.live)
    finally:  # what was computed is told even where it cannot be recorded
        if options.json:
            print_document(run_document(run))
        else:
            print(run_text(run))
    return 0


def require_recordable(options: argparse.Namespace) -> None:
    """Ask what a recording needs before the work, which may take a while."""
    if options.output is None and not options.live:
        return
    from inertia.recording.writer import require_viewer, require_writable

    if options.output is not None:
        require_writable(options.output, force=options.force)
    if options.live:
        require_viewer()


def _text(options: argparse.Namespace) -> str | None:
    """Return the scene file that says the same as the options; None where no scene file can."""
    from inertia.documents import toml_text

    density, material = dict(options.density), dict(options.material)
    if options.format is not None or any(name for name in (*density, *material)):
        return None
    body = {
        "part": Path(options.part).name,
        "unit": options.unit,
        "density": density.get(""),
        "material": material.get(""),
        "mass": options.mass,
    }
    start = {"angular_velocity": options.spin, "frame": "principal"}
    return toml_text({"schema": 1, "body": body, "start": start, "run": {"duration": options.duration}})
