"""The wobble and the spin of a free symmetric top, counted in turns on a dial: two to one for Feynman's plate.

The wobble is the way of the axis of symmetry round L, at |L|/I₁; the spin is ω along that axis, so that their ratio is
I₃/(I₁ cosθ) at a tilt θ.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.drawing import STRIPS, TRAIL, Color, basis
from inertia.recording.playback import Frames
from inertia.recording.screen import DARK_GROUND
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

WOBBLE, SPIN = TRAIL, (235, 235, 240)

_RING, _INK = (110, 115, 125), palette.rgb(palette.WHITE)
_NARROWEST = 1e-3  # rad: a wobble that cannot be seen is not counted
_MARKS = 12
_TURN = 2.0 * np.pi


def wobbles(run: Run) -> bool:
    """Say whether a run is that of a symmetric top whose axis is off L."""
    return "body cone" in run.quantities and float(run.quantities["body cone"]) > _NARROWEST


def turns(run: Run, frames: Frames) -> tuple[Float, Float]:
    """Return how many turns (m,) the axis of symmetry has gone round L, and the body about that axis, at the poses."""
    near, along = frames.near, run.plan.axes[:, 2]
    axis = quaternion.to_space(frames.attitude[near], np.broadcast_to(along, (frames.play.near, 3)))
    momentum = run.angular_momentum[0] / np.linalg.norm(run.angular_momentum[0])
    across = axis @ basis(momentum)
    round_momentum = np.unwrap(np.arctan2(across[:, 1], across[:, 0]))
    rate, time = (frames.angular_velocity[near] * axis).sum(axis=1), frames.time[near]
    about_axis = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    return (round_momentum - round_momentum[0]) / _TURN, np.abs(about_axis) / _TURN


def dial_view() -> rrb.Spatial2DView:
    """Return the view of the dial."""
    import rerun.blueprint as rrb

    return rrb.Spatial2DView(
        origin=f"/{entities.DIAL}",
        name="Wobble and spin, counted",
        visual_bounds=rrb.VisualBounds2D(x_range=(-2.0, 2.0), y_range=(-1.3, 2.0)),
        background=DARK_GROUND,
    )


def write_dial(recording: Recording, run: Run, frames: Frames) -> str:
    """Write a hand for the wobble and one for the spin, and how many turns each has made; return what is shown."""
    import rerun as rr

    wobble, spin = turns(run, frames)
    time = frames.time[frames.near]
    angle = np.linspace(0.0, _TURN, 97)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ring = [circle, *(np.stack([0.93 * mark, mark]) for mark in circle[: -1 : len(angle) // _MARKS])]
    recording.static(f"{entities.DIAL}/ring", rr.LineStrips2D(ring, colors=[_RING], radii=[0.008]))
    _write_hand(recording, "wobble", time, wobble, 0.95, WOBBLE)
    _write_hand(recording, "spin", time, spin, 0.6, SPIN)
    texts = [_count(float(a), float(b)) for a, b in zip(wobble, spin, strict=True)]
    path = f"{entities.DIAL}/count"
    recording.static(path, rr.Points2D.from_fields(colors=[_INK], radii=[0.005], show_labels=True))
    places = np.broadcast_to(np.array([0.0, 1.4], np.float32), (len(time), 2))
    recording.columns(path, time, lambda rows: rr.Points2D.columns(positions=places[rows], labels=texts[rows]))
    ratio = wobble[-1] / spin[-1]
    return (
        f"on the dial the axis goes round L (yellow, the wobble) {ratio:.6g} times while the body turns once about its "
        "axis (white, the spin)"
    )


def _count(wobble: float, spin: float) -> str:
    """Return so many turns in words, with their ratio from a hundredth of a turn on."""
    return f"wobble {wobble:.2f} turns, spin {spin:.2f}" + (f": {wobble / spin:.3f} to 1" if spin > 0.01 else "")


def _write_hand(recording: Recording, name: str, time: Float, turned: Float, length: float, color: Color) -> None:
    """Write a hand that has turned (m,) counter-clockwise from the right, with its name."""
    import rerun as rr

    path, angle = f"{entities.DIAL}/{name}", _TURN * turned
    tips = length * np.stack([np.cos(angle), -np.sin(angle)], axis=1).astype(np.float32)
    strips = np.stack([np.zeros_like(tips), tips], axis=1)
    recording.static(path, rr.LineStrips2D.from_fields(colors=[color], radii=[0.025]))
    recording.columns(path, time, lambda rows: rr.LineStrips2D.columns(strips=strips[rows]), block=STRIPS)
    label = rr.Points2D.from_fields(colors=[color], radii=[0.04], labels=[name], show_labels=True)
    recording.static(f"{path}/tip", label)
    recording.columns(f"{path}/tip", time, lambda rows: rr.Points2D.columns(positions=tips[rows]))
