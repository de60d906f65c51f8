"""The command `simulate`, and how a scene is followed."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import UsageError, visible
from inertia.estimate import UNDECODED
from inertia_cli.options import count, names_recording, record, tell_of_viewer
from inertia_cli.printing import show, write_and_show
from inertia_cli.progress import Progress
from inertia_cli.wording import with_options

if TYPE_CHECKING:
    from inertia.dynamics.run import Run
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

_OF_VARY = ("draws", "seed", "quantity", "reaches", "jobs", "dask")
_RECORDING = ".rrd"

_EXAMPLES = """examples:
  inertia simulate scene.toml
  inertia simulate scene.toml --explain
  inertia simulate scene.toml --for 3600 --samples 5 --json
  inertia simulate scene.toml -o run.rrd && inertia play run.rrd
  inertia simulate scene.toml -o run.parquet -o run.csv --plot run.svg
  inertia simulate run.rrd                                    # again, by its own scene
  inertia simulate scene.toml --vary body.mass=1±0.01 --vary 'start.angular_velocity[2]=±1%' --draws 2000
  inertia simulate scene.toml --vary 'load[0].coefficient=0:0.1:11' --quantity tilt -o sweep.csv
"""


def add(parsers: Any) -> None:
    """Add ``inertia simulate``."""
    parser = parsers.add_parser(
        "simulate",
        help="follow the motion that a scene file describes",
        description="Follow a body through a scene, by the smallest model that the scene needs.",
        epilog=_EXAMPLES,
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
    parser.add_argument(
        "--compare",
        metavar="SCENE",
        help="record the run of this scene, or recording, over that one; the options above hold for both",
    )
    vary = parser.add_argument_group("many runs, with numbers of the scene drawn or swept")
    vary.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="FIELD=LAW",
        help="1±0.01 or ±1%% (normal, standard deviation), 0.9..1.1 (uniform), 0:1:11 or 1,2,5 (a sweep); repeat it",
    )
    vary.add_argument("--draws", type=count, metavar="N", help="draws, at every point of a grid of sweeps (1000)")
    vary.add_argument("--seed", type=int, metavar="S", help="of the random numbers (0)")
    vary.add_argument(
        "--quantity",
        action="append",
        default=[],
        metavar="NAME",
        help="state percentiles of this: deviation, tilt, spin, energy, position[2], ...; repeat it (the first three)",
    )
    vary.add_argument(
        "--reaches",
        action="append",
        default=[],
        metavar="NAME=LEVEL",
        help="count the draws in which a quantity reaches a level, as tilt=1.57, and when first; repeat it for others",
    )
    vary.add_argument("--jobs", type=int, metavar="N", help="processes to share the draws among (as it pays)")
    vary.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="send the draws to the workers of that Dask scheduler, as tcp://host:8786; local for one in this process",
    )
    add_result(parser)


def add_settings(group: argparse._ArgumentGroup) -> None:
    """Add how a motion is followed."""
    group.add_argument("--samples", type=count, metavar="N", help="instants, evenly spaced, both ends included")
    group.add_argument("--accuracy", type=float, metavar="RAD", help="of the attitude at every instant")
    group.add_argument("--model", metavar="NAME", help="use this model, not the smallest one")
    group.add_argument("--method", metavar="NAME", help="integrate step by step, by this method")
    group.add_argument("--time-limit", type=float, metavar="SECONDS", help="of computing, for the whole run (60)")


def add_result(parser: argparse.ArgumentParser) -> None:
    """Add what is made of a run."""
    result = parser.add_argument_group("result")
    result.add_argument("--explain", action="store_true", help="say which model would run and why, and do not run it")
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/run/1)")
    result.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        action="append",
        default=[],
        help="write the run to FILE.rrd, for `inertia play`, or its series to FILE.csv, .npz or .parquet (repeat it)",
    )
    result.add_argument("--plot", metavar="FILE", help="draw what suits the model, to FILE.svg or FILE.png")
    result.add_argument("--plot-kind", metavar="KIND", help="draw this alone: polhode, nutation, angular velocity, ...")
    result.add_argument("--force", action="store_true", help="write over FILE where it exists")
    result.add_argument("--live", action="store_true", help="stream to the Rerun viewer that is open on this machine")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia simulate``."""
    from inertia.mesh.readers.formats import format_of_name

    if format_of_name(Path(options.part)) is not None and Path(options.part).exists():
        raise UsageError(f"{options.part} is a mesh and no scene: name a scene file, or use `inertia tumble`")
    scene = _scene(options.part)
    if options.vary:
        return _spread(scene, options)
    for name in _OF_VARY:
        if getattr(options, name) not in (None, []):
            raise UsageError(f"--{name} goes with many runs: say by --vary what varies")
    return follow(scene, options)


def _scene(file: str) -> Scene:
    """Return the scene of a file, or of a recording."""
    from inertia.dynamics.scene.document import Scene

    if not names_recording(file):
        return Scene.load(file)
    from inertia.recording.provenance import scene_of

    return scene_of(file)


def _spread(scene: Scene, options: argparse.Namespace) -> int:
    """Follow many draws of a scene."""
    from inertia.dynamics.spread.ensemble import ensemble
    from inertia.output import require_writable, together
    from inertia.report.spread.document import ensemble_document
    from inertia.report.spread.table import SUFFIXES, write_table
    from inertia.report.spread.text import ensemble_text

    for name in ("explain", "live", "plot", "compare"):
        if getattr(options, name):
            raise UsageError(f"--{name} is of one run, and --vary makes many: leave one of them out")
    outputs = _distinct([require_writable(file, *SUFFIXES, force=options.force) for file in options.output])
    scene = _overridden(scene, options)
    with Progress("simulating") as progress:
        result = ensemble(
            scene,
            _laws(options.vary),
            options.draws,
            quantities=options.quantity,
            reaches=_levels(options.reaches),
            jobs=options.jobs,
            dask=options.dask,
            progress=progress,
            **{name: value for name in ("seed", "samples") if (value := getattr(options, name)) is not None},
        )

    def write() -> None:
        with together():
            for file in outputs:
                write_table(result, file)

    write_and_show(
        write,
        options.json,
        lambda: ensemble_document(result),
        lambda: ensemble_text(result),
    )
    return 0


def _laws(words: list[str]) -> dict[str, str]:
    """Return the laws by the fields that vary."""
    laws: dict[str, str] = {}
    for word in words:
        field, equals, law = word.partition("=")
        if not equals or not law:
            raise UsageError(f"--vary {word} says no law: write it as body.mass=1±0.01")
        if field.strip() in laws:
            raise UsageError(f"--vary is given twice for {field.strip()}: give it once")
        laws[field.strip()] = law.replace(UNDECODED, "±")
    return laws


def _levels(words: list[str]) -> dict[str, float]:
    """Return the levels by the quantities that may reach them."""
    levels: dict[str, float] = {}
    for word in words:
        name, _, level = word.rpartition("=")
        try:
            levels[name.strip()] = float(level)
        except ValueError:
            raise UsageError(f"--reaches {word} names no level: write it as tilt=1.57") from None
    if len(levels) < len(words):
        names = [word.rpartition("=")[0].strip() for word in words]
        twice = next(name for name in names if names.count(name) > 1)
        raise UsageError(f"--reaches is given twice for {twice}: give one level of a quantity")
    return levels


def _overridden(scene: Scene, options: argparse.Namespace) -> Scene:
    """Return the scene with what the options say in place of its own settings."""
    from dataclasses import replace

    from inertia.documents import FieldError

    overrides: dict[str, Any] = {name: value for name in _OPTIONS if (value := getattr(options, name)) is not None}
    try:
        return replace(scene, run=replace(scene.run, **overrides))
    except FieldError as error:
        raise with_options(error, FIELDS) from None


def follow(scene: Scene, options: argparse.Namespace) -> int:
    """Follow a scene, or say by which model it would be followed."""
    from inertia.dynamics.plan import plan
    from inertia.dynamics.simulate import simulate as simulate_scene
    from inertia.report.run.document import plan_document, run_document
    from inertia.report.run.text import plan_text, run_text

    if options.explain and (options.output or options.live or options.plot):
        raise UsageError("--explain runs nothing that could be recorded: leave out --output, --plot and --live")
    _require_writable(options)
    scene = _overridden(scene, options)
    if options.explain:
        selection = plan(scene)
        show(options.json, lambda: plan_document(scene, selection), lambda: plan_text(scene, selection))
        return 0
    other = None
    if (file := getattr(options, "compare", None)) is not None:
        other = simulate_scene(_overridden(_scene(file), options))
    motion = simulate_scene(scene) if not options.live else _shown(scene, options)
    write_and_show(
        lambda: _write(motion, other, options), options.json, lambda: run_document(motion), lambda: run_text(motion)
    )
    tell_of_viewer(options)
    return 0


def _shown(scene: Scene, options: argparse.Namespace) -> Run:
    """Follow a scene on the viewer; what there is of it when it is interrupted goes to the recording."""
    from inertia.dynamics.simulate import simulate as simulate_scene
    from inertia.recording.preview import Preview

    try:
        with Preview(scene) as preview:
            motion = simulate_scene(scene, observer=preview.take)
    except KeyboardInterrupt:
        for file in filter(_is_recording, options.output):
            if preview.save(Path(file)):
                print(
                    f"inertia: {visible(file)} has the first {preview.reached:.4g} of {scene.run.duration:g} s, as far "
                    "as they were computed: their accuracy is not judged",
                    file=sys.stderr,
                )
        raise
    options.lost = preview.lost
    return motion


def _is_recording(file: str) -> bool:
    return Path(file).suffix.lower() == _RECORDING


def _require_writable(options: argparse.Namespace) -> None:
    """Ask what the files and the viewer need before the work, which may take a while."""
    from inertia.dynamics.columns import FORMATS
    from inertia.output import require_writable
    from inertia.tables import load_pyarrow

    files = [require_writable(file, _RECORDING, *FORMATS, force=options.force) for file in options.output]
    if any(file.suffix.lower() == ".parquet" for file in _distinct(files)):
        load_pyarrow()
    if options.plot is not None:
        from inertia.dynamics.plots.kinds import require_kind
        from inertia.plotting import require_plottable

        require_plottable(options.plot, force=options.force)
        require_kind(options.plot_kind)
    elif options.plot_kind is not None:
        raise UsageError("--plot-kind goes with a plot: name its file by --plot")
    if getattr(options, "compare", None) is not None and not (options.live or any(map(_is_recording, options.output))):
        raise UsageError("--compare is seen in a recording: add --output FILE.rrd, or --live")
    if options.live:
        from inertia.recording.live import require_viewer

        require_viewer()


def _distinct(files: list[Path]) -> list[Path]:
    """Return the files that results go to; refuse two in one."""
    for k, file in enumerate(files):
        if file.resolve() in [other.resolve() for other in files[:k]]:
            raise UsageError(f"{file} is named twice: every result needs a file of its own")
    return files


def _write(motion: Run, other: Run | None, options: argparse.Namespace) -> None:
    """Write all files that were asked for, or none, and stream to the viewer."""
    from inertia.output import together

    recordings = list(filter(_is_recording, options.output))
    live = options.live and options.lost is None
    with together():
        for file in options.output:
            if file not in recordings:
                getattr(motion, f"to_{Path(file).suffix.lower()[1:]}")(file, force=options.force)
        if options.plot is not None:
            from inertia.plotting import write_figure

            write_figure(lambda: motion.plot(options.plot_kind), options.plot, force=options.force)
        for k, file in enumerate(recordings or ([None] if live else [])):
            record(motion, file, options, live=live and k == 0, other=other)
