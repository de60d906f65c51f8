"""The screen of a body that is driven: inertial view, body view, plots and text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from inertia.recording import paths, places
from inertia.recording.layout import eye, plot, trail
from inertia.recording.panels import drift_plot, finished, text_view

if TYPE_CHECKING:
    import rerun.blueprint as rrb


@dataclass(frozen=True)
class Layout:
    """What the screen depends on.

    Attributes
    ----------
    radius : of what must be in sight in the inertial view, in display units
    duration : s
    trail : s, behind L
    speed : seconds of the run in a second of playback
    drift_unit : of the plot of drifts; None where nothing is kept
    energy : whether there is a plot of the energy
    """

    radius: float
    duration: float
    trail: float
    speed: float
    drift_unit: float | None
    energy: bool


def blueprint(layout: Layout) -> rrb.Blueprint:
    """Return the screen."""
    import rerun.blueprint as rrb

    inertial = rrb.Spatial3DView(
        origin=f"/{paths.CENTER}",
        name="Inertial view",
        eye_controls=eye(layout.radius),
        overrides={f"/{places.MOMENTUM_TRAIL}": trail(layout.trail)},
        line_grid=False,
    )
    body = rrb.Spatial3DView(
        origin=f"/{paths.MOMENTUM_SPACE}",
        name="Body view: L over its largest",
        eye_controls=eye(1.25),
        overrides={f"/{places.TRAIL_OF_MOMENTUM}": trail(layout.trail)},
        line_grid=False,
    )
    plots: list[Any] = [
        plot(places.PLOT_MOMENTUM, "Angular momentum in space, kg m²/s", layout.duration),
        plot(paths.PLOT_ANGULAR_VELOCITY, "Angular velocity along the principal axes, rad/s", layout.duration),
        plot(paths.PLOT_EULER_ANGLES, "Euler angles z-x-z, rad", layout.duration),
    ]
    if layout.energy:
        plots.insert(1, plot(paths.PLOT_ENERGY, "Energy, J", layout.duration))
    if layout.drift_unit is not None:
        plots.append(drift_plot(layout.drift_unit, layout.duration))
    left = rrb.Vertical(rrb.Horizontal(inertial, body), text_view(), row_shares=[3, 2])
    return finished(left, rrb.Vertical(*plots), layout.speed)
