"""The screen of a body that rolls: the whole path, a view that goes along, plots and text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.recording import paths, places
from inertia.recording.layout import plot, trail
from inertia.recording.panels import camera, drift_plot, finished, text_view

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_FROM = np.array([0.55, -0.7, 0.45])
_DISTANCE = 2.3


@dataclass(frozen=True)
class Layout:
    """What the screen depends on.

    Attributes
    ----------
    duration : s
    radius : of the rim, in display units
    reach : of the path from its middle, in display units
    trail : s, behind the point of contact
    speed : seconds of the run in a second of playback
    drift_unit : of the plot of drifts
    lifts_off : whether there is a timeline of the contact
    """

    duration: float
    radius: float
    reach: float
    trail: float
    speed: float
    drift_unit: float
    lifts_off: bool


def blueprint(layout: Layout) -> rrb.Blueprint:
    """Return the screen."""
    import rerun.blueprint as rrb

    far = 1.25 * _DISTANCE * (layout.reach + 1.5 * layout.radius)
    near = 1.9 * _DISTANCE * layout.radius
    views = [
        _view(layout, paths.WORLD, "The path on the plane", far),
        _view(layout, paths.CENTER, "Going along with the body", near),
    ]
    left: list[Any] = [rrb.Horizontal(*views)]
    shares = [3.0]
    if layout.lifts_off:
        left.append(rrb.StateTimelineView(origin=f"/{places.CONTACT_STATE}", name="Contact"))
        shares.append(0.6)
    left.append(text_view())
    shares.append(1.6)
    right = rrb.Vertical(
        plot(places.PLOT_FORCE, "Force of the plane on the body, N", layout.duration),
        plot(places.PLOT_TILT, "Tilt θ of the axis from the vertical, rad", layout.duration),
        plot(places.PLOT_RATES, "Rates of precession φ, tilt θ and spin ψ, rad/s", layout.duration),
        drift_plot(layout.drift_unit, layout.duration),
    )
    return finished(rrb.Vertical(*left, row_shares=shares), right, layout.speed)


def _view(layout: Layout, origin: str, name: str, distance: float) -> rrb.Spatial3DView:
    import rerun.blueprint as rrb

    return rrb.Spatial3DView(
        origin=f"/{origin}",
        contents=f"/{paths.WORLD}/**",
        name=name,
        eye_controls=camera(distance * _FROM / np.linalg.norm(_FROM), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        overrides={f"/{places.CONTACT_TRAIL}": trail(layout.trail)},
        line_grid=False,
    )
