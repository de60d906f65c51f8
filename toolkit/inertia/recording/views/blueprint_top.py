"""The screen of a heavy top: in space, on the unit sphere, in the effective potential, plots and text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.recording import paths, places
from inertia.recording.chart import Chart
from inertia.recording.layout import plot, trail
from inertia.recording.panels import basis, camera, drift_plot, finished, text_view

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_FROM = np.array([0.62, -0.66, 0.42])
_ABOVE = np.array([0.45, -0.55, 0.75])


@dataclass(frozen=True, eq=False)
class Layout:
    """What the screen depends on.

    Attributes
    ----------
    radius : of the sphere in space that the axis points at, in display units
    up : (3,) in space
    tilts : rad, the least and the greatest
    duration : s
    cap : radius of what is seen of the unit sphere
    trail : s, of the path of the axis
    speed : seconds of the run in a second of playback
    drift_unit : of the plot of drifts
    potential : the chart of the effective potential; None without one
    """

    radius: float
    up: Float
    tilts: tuple[float, float]
    duration: float
    cap: float
    trail: float
    speed: float
    drift_unit: float
    potential: Chart | None


def blueprint(layout: Layout) -> rrb.Blueprint:
    """Return the screen."""
    import rerun.blueprint as rrb

    space = rrb.Spatial3DView(
        origin=f"/{paths.WORLD}",
        name="In space",
        eye_controls=_eye(layout, layout.radius),
        overrides={f"/{places.LOCUS}": trail(layout.trail)},
        line_grid=False,
    )
    sphere = rrb.Spatial3DView(
        origin=f"/{places.UNIT_SPHERE}",
        name="Locus of the axis on the unit sphere",
        eye_controls=_eye_on_sphere(layout),
        overrides={f"/{places.UNIT_SPHERE}/trail": trail(layout.trail)},
        line_grid=False,
    )
    below: list[Any] = [text_view()]
    if layout.potential is not None:
        below.insert(0, layout.potential.view("Effective potential"))
    left = rrb.Vertical(rrb.Horizontal(space, sphere), rrb.Horizontal(*below), row_shares=[3, 2])
    right = rrb.Vertical(
        plot(places.PLOT_TILT, "Tilt θ of the axis from the vertical, rad", layout.duration),
        plot(paths.PLOT_EULER_ANGLES, "Precession φ and spin ψ, rad", layout.duration),
        drift_plot(layout.drift_unit, layout.duration),
    )
    return finished(left, right, layout.speed)


def _eye(layout: Layout, radius: float) -> rrb.EyeControls3D:
    """Look at the upper half of the sphere, or at all of it where the axis sinks below the horizontal."""
    sunk = layout.tilts[1] > 0.5 * np.pi
    target = (0.0 if sunk else 0.45) * radius * layout.up
    offset = basis(layout.up) @ _FROM / np.linalg.norm(_FROM)
    return camera((2.7 if sunk else 2.1) * radius * offset, target, layout.up)


def _eye_on_sphere(layout: Layout) -> rrb.EyeControls3D:
    """Look at the cap that holds the path."""
    low, high = np.cos(layout.tilts[::-1])
    target = 0.5 * (low + high) * layout.up
    offset = basis(layout.up) @ _ABOVE / np.linalg.norm(_ABOVE)
    return camera(2.6 * layout.cap * offset, target, layout.up)
