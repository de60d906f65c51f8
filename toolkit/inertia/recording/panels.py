"""Further pieces of screens: cameras that look anywhere, the frame around the views, and what is drawn for good."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.recording import paths
from inertia.recording.layout import plot, time_panel
from inertia.recording.playback import largest
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

Color = tuple[int, int, int] | tuple[int, int, int, int]

GROUND = (110, 115, 125)
_ROUND = 97  # points of a circle


def camera(offset: ArrayLike, target: ArrayLike, up: ArrayLike) -> rrb.EyeControls3D:
    """Return a camera that looks at `target` (3,) from `offset` (3,) away."""
    import rerun.blueprint as rrb

    look = np.asarray(target, dtype=np.float64)
    position = look + np.asarray(offset)
    return rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=look, eye_up=up)


def finished(left: Any, right: Any, speed: float, shares: Sequence[float] = (3.0, 2.0)) -> rrb.Blueprint:
    """Return a screen of two columns that plays at so many seconds of the run in a second."""
    import rerun.blueprint as rrb

    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=list(shares)),
        time_panel(speed),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
    )


def drift_plot(unit: float, duration: float) -> rrb.TimeSeriesView:
    """Return the plot of how far what is kept drifts."""
    return plot(paths.PLOT_DRIFT, f"Drift of what is kept, in units of {unit:.0e} of itself", duration)


def text_view() -> rrb.TextDocumentView:
    """Return the view of the text."""
    import rerun.blueprint as rrb

    return rrb.TextDocumentView(origin=f"/{paths.SUMMARY}", name="What is shown")


def write_text(recording: Recording, text: str) -> None:
    """Write the text, in Markdown."""
    import rerun as rr

    recording.static(paths.SUMMARY, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))


def write_lines(recording: Recording, path: str, strips: Sequence[Float], color: Color, radius: float) -> None:
    """Write lines (k, 3) that stay."""
    import rerun as rr

    recording.static(path, rr.LineStrips3D([np.float32(k) for k in strips], colors=[color], radii=[radius]))


def longest_as(length: float, vectors: Float) -> Float:
    """Return vectors (m, 3) scaled so that the longest has this length; all zero where they are."""
    size = largest(vectors)
    return length / size * vectors if size else vectors


def write_point(recording: Recording, path: str, time: Float, points: Float, color: Color, radius: float) -> None:
    """Write a point (m, 3) that moves."""
    import rerun as rr

    recording.static(path, rr.Points3D.from_fields(colors=[color], radii=[radius]))
    places = points.astype(np.float32)
    recording.columns(path, time, lambda rows: rr.Points3D.columns(positions=places[rows]))


def write_place(recording: Recording, path: str, time: Float, places: Float) -> None:
    """Write where an entity is, (m, 3): what hangs below it goes along."""
    import rerun as rr

    moved = places.astype(np.float32)
    recording.columns(path, time, lambda rows: rr.Transform3D.columns(translation=moved[rows]))


def basis(axis: Float) -> Float:
    """Return a right-handed rotation (3, 3) whose last column is the unit vector `axis`; the identity for z.

    >>> basis(np.array([0.0, 0.0, 1.0])).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    beside = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = beside - axis * (axis @ beside)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


def circle(radius: float, height: float, axes: Float) -> Float:
    """Return the points (k, 3) of a circle about the last column of `axes`, so far up along it."""
    turn = np.linspace(0.0, 2.0 * np.pi, _ROUND)
    points: Float = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(_ROUND, height)], axis=1) @ axes.T
    return points
