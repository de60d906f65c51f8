"""The screen of a body that tumbles: inertial view, body view, plots, flips and text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from inertia.recording import paths
from inertia.recording.layout import eye, plot, time_panel, trail

if TYPE_CHECKING:
    import rerun.blueprint as rrb


@dataclass(frozen=True)
class Layout:
    """What the screen depends on.

    Attributes
    ----------
    radius : of what must be in sight in the inertial view, in display units
    duration : s
    trail : s, of the herpolhode behind ω
    speed : seconds of the run in a second of playback
    drift_unit : of the plot of drifts; None without one
    energy, flips : whether there are a plot of the energy and a timeline of flips
    """

    radius: float
    duration: float
    trail: float
    speed: float
    drift_unit: float | None
    energy: bool
    flips: bool


def blueprint(layout: Layout) -> rrb.Blueprint:
    """Return the screen."""
    import rerun.blueprint as rrb

    inertial = rrb.Spatial3DView(
        origin=f"/{paths.CENTER}",
        contents=f"/{paths.WORLD}/**",
        name="Inertial view",
        eye_controls=eye(layout.radius),
        overrides={f"/{paths.HERPOLHODE}": trail(layout.trail)},
        line_grid=False,
    )
    body = rrb.Spatial3DView(
        origin=f"/{paths.MOMENTUM_SPACE}", name="Body view: L / |L|", eye_controls=eye(1.25), line_grid=False
    )
    plots: list[Any] = [
        plot(paths.PLOT_ANGULAR_VELOCITY, "Angular velocity along the principal axes, rad/s", layout.duration),
        plot(paths.PLOT_EULER_ANGLES, "Euler angles z-x-z, rad", layout.duration),
    ]
    if layout.drift_unit is not None:
        name = f"Drift of what is kept, in units of {layout.drift_unit:.0e} of itself"
        plots.append(plot(paths.PLOT_DRIFT, name, layout.duration))
    if layout.energy:
        plots.append(plot(paths.PLOT_ENERGY, "Energy, J", layout.duration))
    left: list[Any] = [rrb.Horizontal(inertial, body, column_shares=[1, 1])]
    shares = [3.0]
    if layout.flips:
        left.append(rrb.StateTimelineView(origin=f"/{paths.FLIPS}", name="Flips: sense of the spin about axis 2"))
        shares.append(0.6)
    left.append(rrb.TextDocumentView(origin=f"/{paths.SUMMARY}", name="What is shown"))
    shares.append(2.2)
    return rrb.Blueprint(
        rrb.Horizontal(rrb.Vertical(*left, row_shares=shares), rrb.Vertical(*plots), column_shares=[3, 2]),
        time_panel(layout.speed),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
    )
