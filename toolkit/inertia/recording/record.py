"""`record`: a run or a balanced rotor becomes a Rerun recording, in a file, on an open viewer or in a notebook."""

from __future__ import annotations

import os
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.assembly.budget import Budget
from inertia.balancing.balance import Balance
from inertia.dynamics.run import Run
from inertia.errors import GeometryError, UsageError, require_kind
from inertia.output import require_writable
from inertia.recording.live import to_viewer
from inertia.recording.provenance import properties_of
from inertia.recording.screen import Screen
from inertia.recording.writer import Recording, blocks, prepare, to_file

VIEWS = ("tumbling", "top", "driven", "disc", "deforming")
"""The views of a run, by the names that models give: modules of `views`, each with a function `screen`."""

_ROTOR, _BUDGET = "rotor", "budget"


def record(
    subject: Run | Balance | Budget,
    path: str | os.PathLike[str] | None = None,
    *,
    other: Run | None = None,
    force: bool = False,
    live: bool = False,
) -> None:
    """Write a run, two over each other, a rotor, or the budget of an assembly to a Rerun recording or an open viewer.

    The file holds the screen too, and what is needed to run it again: ``inertia simulate run.rrd``. It appears under
    its name when it is whole, and not at all where writing fails.

    Parameters
    ----------
    subject : what `inertia.simulate`, `inertia.balance` or `inertia.Assembly.budget` returned
    path : of the file, ending in .rrd; None for none
    other : a run to be shown over the first, of a rigid body
    force : write over a file that is there
    live : stream to the viewer that listens on port 9876 of this machine

    Raises
    ------
    UsageError : neither a path nor `live`, a path that is not usable, or a file that is there; `other` for a rotor, or
        a body that changes its shape in either run
    GeometryError : the run has fewer than two samples, some that are not finite, or none in the order of time
    InertiaError : the place cannot be written to, the disk is full, or no viewer listens; `live.ViewerError` where it
        ends, or falls silent, before it has all: the file is whole then
    """
    if path is None and not live:
        raise UsageError("there is nowhere to record to: give a path, or live=True with an open viewer")
    _require_recordable(subject, other)
    file = None if path is None else require_writable(path, ".rrd", force=force)
    screen = _screen(subject, other)

    def write(recording: Recording) -> None:
        _write(recording, screen, subject, other)

    if file is not None:
        with to_file(file, screen.application, screen.blueprint, screen.second) as recording:
            write(recording)
    if live:
        with to_viewer(screen.application, screen.blueprint, screen.second) as recording:
            write(recording)


def show(subject: Run | Balance | Budget, *, other: Run | None = None) -> Any:
    """Return Rerun's viewer with the recording that `record` makes in it; a notebook shows it below the cell.

    Parameters
    ----------
    subject, other : as of `record`

    Raises `UsageError` where rerun-notebook is not installed, else as `record`.
    """
    if find_spec("rerun_notebook") is None:
        raise UsageError(
            "Rerun's viewer for notebooks is not installed: install it by pip install "
            f"rerun-notebook=={version('rerun-sdk')}, or record to a file and open that by `rerun`",
            code="needs_package",
        )
    import rerun as rr
    from rerun.notebook import Viewer

    _require_recordable(subject, other)
    screen = _screen(subject, other)
    stream = rr.RecordingStream(screen.application)
    prepare(stream)
    viewer = Viewer(recording=stream, blueprint=screen.blueprint, use_global_recording=False)
    recording = Recording(stream, screen.second)
    _write(recording, screen, subject, other)
    recording.flush()
    return viewer


def _write(recording: Recording, screen: Screen, subject: Run | Balance | Budget, other: Run | None) -> None:
    recording.name(screen.name)
    for name, values in properties_of(subject).items():
        recording.properties(name, values)
    if other is not None:
        for name, values in properties_of(other).items():
            recording.properties(f"other_{name}", values)
    recording.properties("timeline", {"second_s": screen.second})
    screen.write(recording)


def _require_recordable(subject: object, other: object) -> None:
    if not isinstance(subject, Run | Balance | Budget):
        raise UsageError(
            f"subject is a {type(subject).__name__}: give what inertia.simulate, inertia.balance or "
            "inertia.Assembly.budget returns"
        )
    if other is not None:
        require_kind(other, Run, "other", "inertia.simulate(scene)")
    for run in (subject, other):
        if isinstance(run, Run):
            _require_finite(run)


def _screen(subject: Run | Balance | Budget, other: Run | None) -> Screen:
    if other is not None:
        if not isinstance(subject, Run):
            what = "a rotor" if isinstance(subject, Balance) else "an assembly"
            raise UsageError(f"{what} is not recorded with a run over it: record each by itself")
        from inertia.recording.views import overlay

        return overlay.screen(subject, other)
    name = _ROTOR if isinstance(subject, Balance) else _BUDGET if isinstance(subject, Budget) else subject.plan.view
    screen: Screen = import_module(f"inertia.recording.views.{name}").screen(subject)
    return screen


def _require_finite(run: Run) -> None:
    if len(run.time) < 2:
        raise GeometryError(f"{run.scene.name}: the run has {len(run.time)} samples: a recording needs 2 or more")
    if (np.diff(run.time) <= 0).any():
        raise GeometryError(f"{run.scene.name}: the samples do not ascend, as a recording needs: ask for them in order")
    columns = {
        "time": run.time,
        "attitude": run.attitude,
        "angular_velocity": run.angular_velocity,
        "angular_momentum": run.angular_momentum,
        "energy": run.energy,
    }
    if run.position is not None:
        columns["position"] = run.position
    for name, values in columns.items():
        if (sample := _first_not_finite(values)) is not None:
            raise GeometryError(
                f"{run.scene.name}: {name} is not finite at sample {sample} of the run, t = {run.time[sample]:.6g} s: "
                "nothing is recorded, ask for a shorter run or a finer accuracy"
            )


def _first_not_finite(values: Float) -> int | None:
    for rows in blocks(len(values)):
        wrong = ~np.isfinite(values[rows]).reshape(rows.stop - rows.start, -1).all(axis=1)
        if wrong.any():
            return int(rows.start + np.argmax(wrong))
    return None
