"""The screen of a body that changes its shape: its parts, its tensor, its flight, plots and text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.recording import paths, places
from inertia.recording.layout import eye, plot
from inertia.recording.panels import camera, drift_plot, finished, text_view

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_ROOM = 1.25  # around the body, for the arrows
_SIDE = np.array([0.25, -0.93, 0.2])


@dataclass(frozen=True, eq=False)
class Layout:
    """What the screen depends on.

    Attributes
    ----------
    reach : of the body from its centre of mass, in display units
    path : corners of the box around the path of the centre of mass, in display units; None where it stays
    duration : s
    speed : seconds of the run in a second of playback
    drift_unit : of the plot of drifts
    hinges, slides : whether there are joints that turn, and joints that slide
    """

    reach: float
    path: tuple[Float, Float] | None
    duration: float
    speed: float
    drift_unit: float
    hinges: bool
    slides: bool


def blueprint(layout: Layout) -> rrb.Blueprint:
    """Return the screen."""
    import rerun.blueprint as rrb

    parts = rrb.Spatial3DView(
        origin=f"/{paths.CENTER}",
        contents=f"/{paths.WORLD}/**",
        name="About the centre of mass",
        eye_controls=eye(_ROOM * layout.reach),
        line_grid=False,
    )
    tensor = rrb.Spatial3DView(
        origin=f"/{places.TENSOR}",
        name="Ellipsoid of the same moments",
        eye_controls=eye(_ROOM * layout.reach),
        line_grid=False,
    )
    beside = tensor if layout.path is None else rrb.Vertical(tensor, _flight(layout, *layout.path))
    plots: list[Any] = []
    if layout.hinges:
        plots.append(plot(places.PLOT_JOINTS, "Angles of the joints, rad", layout.duration))
    if layout.slides:
        plots.append(plot(places.PLOT_SLIDES, "Displacements of the joints, m", layout.duration))
    plots += [
        plot(places.PLOT_MOMENTS, "Principal moments of the whole body, kg m²", layout.duration),
        plot(paths.PLOT_ANGULAR_VELOCITY, "Angular velocity of the root part, part axes, rad/s", layout.duration),
        plot(places.PLOT_WORK, "Kinetic energy and work of the joints, J", layout.duration),
        drift_plot(layout.drift_unit, layout.duration),
    ]
    left = rrb.Vertical(rrb.Horizontal(parts, beside), text_view(), row_shares=[3, 2])
    return finished(left, rrb.Vertical(*plots), layout.speed)


def _flight(layout: Layout, low: Float, high: Float) -> rrb.Spatial3DView:
    """Look at the whole path from the side."""
    import rerun.blueprint as rrb

    radius = 0.5 * float(np.linalg.norm(high - low)) + layout.reach
    offset = 2.3 * radius * _SIDE / np.linalg.norm(_SIDE)
    return rrb.Spatial3DView(
        origin=f"/{paths.WORLD}",
        name="Where it is",
        eye_controls=camera(offset, 0.5 * (low + high), (0.0, 0.0, 1.0)),
        line_grid=False,
    )
