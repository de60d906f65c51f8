"""How a screen is arranged: cameras, plots, the panel of time, and what a view hands to the writer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from inertia import palette
from inertia.arrays import Float
from inertia.recording import entities
from inertia.recording.summary import figure
from inertia.recording.writer import Recording
from inertia.records import dataclass

if TYPE_CHECKING:
    import rerun.blueprint as rrb

DARK_GROUND = palette.rgb(palette.DARK)

_ROOM = 1.35  # over the run: an axis of time that leaves the right of a plot to its legend
_FROM = np.array([0.62, -0.66, 0.42])
_SIDE, _FARTHER = np.array([0.25, -0.93, 0.2]), 2.0
_DISTANCE = 2.4  # radii: as near as a sphere still fits the view


@dataclass(frozen=True, eq=False)
class Screen:
    """A recording to be written.

    Attributes
    ----------
    application : the id that the viewer keeps blueprints by: one for each kind of run
    name : what the viewer calls the recording
    blueprint : the views, with which the file opens
    write : fills a recording
    second : s of the run that a second on the timeline stands for
    """

    application: str
    name: str
    blueprint: rrb.Blueprint
    write: Callable[[Recording], None]
    second: float = 1.0


def finished(
    left: Any,
    right: Any,
    speed: float,
    shares: Sequence[float] = (3.0, 2.0),
    loop: tuple[float, float] | None = None,
) -> rrb.Blueprint:
    """Return a screen of two columns that plays at so many seconds of the timeline in a second.

    `loop` says from when to when, in s of the timeline; None for all of it.
    """
    import rerun.blueprint as rrb

    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=list(shares)),
        _time_panel(speed, loop),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
    )


def following(left: Any, right: Any) -> rrb.Blueprint:
    """Return a screen of two columns that shows the last of what has come."""
    import rerun.blueprint as rrb

    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[3, 2]),
        rrb.TimePanel(timeline=entities.TIMELINE, play_state=rrb.components.PlayState.Following, state="collapsed"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
    )


def _time_panel(speed: float, loop: tuple[float, float] | None) -> rrb.TimePanel:
    """Return the panel that plays in a loop, at so many seconds of the timeline in a second."""
    import rerun as rr
    import rerun.blueprint as rrb

    selection = None if loop is None else rr.encodings.AbsoluteTimeRange(*(round(1e9 * end) for end in loop))
    return rrb.TimePanel(
        timeline=entities.TIMELINE,
        playback_speed=speed,
        play_state=rrb.components.PlayState.Playing,
        loop_mode=rrb.components.LoopMode.All if loop is None else rrb.components.LoopMode.Selection,
        time_selection=selection,
        state="collapsed",
    )


def eye(radius: float) -> rrb.EyeControls3D:
    """Return a camera that sees a sphere about the origin, from the front right and above."""
    return camera(_DISTANCE * radius * _FROM / np.linalg.norm(_FROM), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def camera(offset: ArrayLike, target: ArrayLike, up: ArrayLike) -> rrb.EyeControls3D:
    """Return a camera that looks at `target` (3,) from `offset` (3,) away."""
    import rerun.blueprint as rrb

    look = np.asarray(target, dtype=np.float64)
    position = look + np.asarray(offset)
    return rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=look, eye_up=up)


def whole_path(path: Float, reach: float) -> rrb.EyeControls3D:
    """Return a camera that sees from the side all of a path (m, 3) of a body that reaches so far from it."""
    low, high = path.min(axis=0), path.max(axis=0)
    radius = 0.5 * float(np.linalg.norm(high - low)) + reach
    offset = _FARTHER * radius * _SIDE / np.linalg.norm(_SIDE)
    return camera(offset, 0.5 * (low + high), (0.0, 0.0, 1.0))


def space_view(origin: str, name: str, eye_controls: rrb.EyeControls3D, **more: Any) -> rrb.Spatial3DView:
    """Return a view in space, on dark ground whatever the theme; `more` goes to Rerun."""
    import rerun.blueprint as rrb

    return rrb.Spatial3DView(
        origin=f"/{origin}", name=name, eye_controls=eye_controls, background=DARK_GROUND, line_grid=False, **more
    )


def trail(seconds: float) -> rrb.VisibleTimeRanges:
    """Return the override that shows what was written in the last seconds."""
    import rerun.blueprint as rrb

    start = rrb.TimeRangeBoundary.cursor_relative(seconds=-seconds)
    return rrb.VisibleTimeRanges(
        rrb.VisibleTimeRange(entities.TIMELINE, start=start, end=rrb.TimeRangeBoundary.cursor_relative())
    )


def plot(
    path: str, name: str, duration: float, *, legend: bool = True, values: tuple[float, float] | None = None
) -> rrb.TimeSeriesView:
    """Return a plot of the whole run, with room for the legend beside the curves; `values` that it shows, or all."""
    import rerun.blueprint as rrb

    return rrb.TimeSeriesView(
        origin=f"/{path}",
        name=name,
        axis_x=_until(_ROOM * duration if legend else duration),
        axis_y=None if values is None else rrb.ScalarAxis(range=values),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend),
    )


def state_timeline(path: str, name: str, duration: float) -> rrb.StateTimelineView:
    """Return the view of what holds when, for the whole run."""
    import rerun.blueprint as rrb

    return rrb.StateTimelineView(origin=f"/{path}", name=name, time_view=_until(duration))


def _until(end: float) -> rrb.TimeAxis:
    """Return an axis of time from the start to `end` (s of the timeline)."""
    import rerun as rr
    import rerun.blueprint as rrb

    ends = [rrb.TimeRangeBoundary.absolute(seconds=seconds) for seconds in (0.0, end)]
    return rrb.TimeAxis(view_range=rr.TimeRange(*ends))


def drift_plot(unit: float, duration: float) -> rrb.TimeSeriesView:
    """Return the plot of how far what is kept drifts."""
    return plot(entities.PLOT_DRIFT, f"Drift of what is kept, {figure(unit)} of its size", duration)


def text_view() -> rrb.TextDocumentView:
    """Return the view of the text."""
    import rerun.blueprint as rrb

    return rrb.TextDocumentView(origin=f"/{entities.SUMMARY}", name="What is shown")
