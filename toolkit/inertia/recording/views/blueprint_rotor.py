"""The screen of a rotor: as modelled and as corrected, its tolerance planes as targets, forces and text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inertia.recording import places
from inertia.recording.layout import plot
from inertia.recording.panels import camera, finished, text_view
from inertia.recording.target import FARTHEST

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_FROM = np.array([0.4, 1.0, 0.25])  # shaft axes: z′ goes to the right, the zero mark starts on top
_DISTANCE = 1.9


@dataclass(frozen=True)
class Layout:
    """What the screen depends on.

    Attributes
    ----------
    reach : of the rotor from its middle, in display units
    rooms : the entity and the title of each state of the rotor
    targets : the titles of the tolerance planes A and B
    duration : s
    speed : seconds of the run in a second of playback
    """

    reach: float
    rooms: tuple[tuple[str, str], ...]
    targets: tuple[str, ...]
    duration: float
    speed: float


def blueprint(layout: Layout) -> rrb.Blueprint:
    """Return the screen."""
    import rerun.blueprint as rrb

    offset = _DISTANCE * layout.reach * _FROM / np.linalg.norm(_FROM)
    views = [
        rrb.Spatial3DView(
            origin=f"/{room}",
            name=title,
            eye_controls=camera(offset, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
            line_grid=False,
        )
        for room, title in layout.rooms
    ]
    targets = [_target(*each) for each in zip((places.POLAR_A, places.POLAR_B), layout.targets, strict=True)]
    right = rrb.Vertical(
        rrb.Horizontal(*targets),
        plot(places.PLOT_BEARING_A, "Force on bearing A, as a sensor at rest feels it, N", layout.duration),
        plot(places.PLOT_BEARING_B, "Force on bearing B, as a sensor at rest feels it, N", layout.duration),
        text_view(),
        row_shares=[3, 2.2, 2.2, 3.4],
    )
    return finished(rrb.Vertical(*views), right, layout.speed, (1.0, 1.0))


def _target(path: str, name: str) -> rrb.Spatial2DView:
    import rerun.blueprint as rrb

    span = (-1.5 * FARTHEST, 1.5 * FARTHEST)
    return rrb.Spatial2DView(
        origin=f"/{path}",
        name=name,
        visual_bounds=rrb.VisualBounds2D(x_range=span, y_range=span),
    )
