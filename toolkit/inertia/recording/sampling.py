"""Samples between which a body turns so far that no line goes through them: plots have points, and the text says so."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.plots.subject import is_coarse
from inertia.dynamics.run import Run
from inertia.recording.summary import figure
from inertia.recording.writer import Recording

POINTS = 4000
"""Instants that a plot has points at, at most: a viewer draws each by itself, for seconds where there are many."""


def write_series(
    recording: Recording,
    path: str,
    run: Run,
    values: Callable[[slice], Float],
    names: Sequence[str],
    colors: Sequence[Sequence[int]],
    *,
    time: Float | None = None,
    step: int = 1,
) -> None:
    """Write series of numbers of a run as lines, or as points where it turns too far between them (`is_coarse`).

    Parameters
    ----------
    values : returns (k, len(names)) for a block of them, as `Recording.scalars` asks for it; each name ends in its unit
    time : (n,) s, the instants that they are of; the samples without it
    step : one in how many is written, at least
    """
    time = run.time if time is None else time
    joined = not is_coarse(time[::step], run.angular_velocity)
    every = step if joined else max(step, _thinning(time))

    def some(rows: slice) -> Float:
        stop = None if rows.stop is None else every * rows.stop
        return values(slice(every * (rows.start or 0), stop, every * (rows.step or 1)))

    recording.scalars(path, time[::every], some, names, colors, joined=joined)


def points_note(run: Run) -> str:
    """Say that samples are too far apart for lines, where they are; "" where they are not."""
    if not is_coarse(run.time, run.angular_velocity):
        return ""
    apart, fastest = float(np.diff(run.time).max()), float(np.linalg.norm(run.angular_velocity, axis=1).max())
    every = _thinning(run.time)
    return (
        f"samples are {apart:.4g} s apart, in which the body may turn by {figure(apart * fastest)} rad: plots have "
        f"{'each' if every == 1 else f'one in {every}'} of them as a point, as a line might show a motion that is not "
        "there"
    )


def _thinning(time: Float) -> int:
    """Return one in how many instants (n,) is a point."""
    return -(-len(time) // POINTS)
