"""Pieces of screens that several kinds of run share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inertia.recording.paths import TIMELINE

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_FROM = np.array([0.62, -0.66, 0.42])
_DISTANCE = 2.4  # radii: as near as a sphere still fits the view


def eye(radius: float) -> rrb.EyeControls3D:
    """Return a camera that sees a sphere about the origin, from the front right and above."""
    import rerun.blueprint as rrb

    position = _DISTANCE * radius * _FROM / np.linalg.norm(_FROM)
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=position, look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0)
    )


def trail(seconds: float) -> rrb.VisibleTimeRanges:
    """Return the override that shows what was written in the last seconds."""
    import rerun.blueprint as rrb

    start = rrb.TimeRangeBoundary.cursor_relative(seconds=-seconds)
    return rrb.VisibleTimeRanges(
        rrb.VisibleTimeRange(TIMELINE, start=start, end=rrb.TimeRangeBoundary.cursor_relative())
    )


def plot(path: str, name: str, duration: float) -> rrb.TimeSeriesView:
    """Return a plot of the whole run, its legend inside."""
    import rerun as rr
    import rerun.blueprint as rrb

    ends = [rrb.TimeRangeBoundary.absolute(seconds=seconds) for seconds in (0.0, duration)]
    return rrb.TimeSeriesView(
        origin=f"/{path}",
        name=name,
        axis_x=rrb.TimeAxis(view_range=rr.TimeRange(*ends)),
        plot_legend=rrb.PlotLegend(visible=True),
    )


def time_panel(speed: float) -> rrb.TimePanel:
    """Return the panel that plays in a loop, at so many seconds of the run in a second."""
    import rerun.blueprint as rrb

    return rrb.TimePanel(
        timeline=TIMELINE,
        playback_speed=speed,
        play_state=rrb.components.PlayState.Playing,
        loop_mode=rrb.components.LoopMode.All,
        state="collapsed",
    )
