"""Recording of a body that torques, damping or losses drive: L, the energy and the attitude as they change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.plots.subject import ascending
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.display import Display, display_of
from inertia.recording.drawing import COLORS, MOMENTUM, OMEGA, write_arrow, write_axes, write_text, write_trail
from inertia.recording.playback import Frames, frames_of, largest, never_short
from inertia.recording.screen import Screen, drift_plot, eye, finished, plot, space_view, text_view, trail
from inertia.recording.series import (
    drift_unit,
    write_angular_velocity,
    write_drift,
    write_energy,
    write_euler_angles,
)
from inertia.recording.spin_marks import spin_axes, write_marks
from inertia.recording.summary import summary, title
from inertia.recording.views.loads import (
    is_turned,
    reaction_plot,
    reactions,
    write_primary,
    write_reactions,
    write_torque,
)
from inertia.recording.views.momentum_space import write_moving_momentum_space
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_OMEGA, _MOMENTUM, _AXES, _LEAST = 1.3, 1.55, 1.15, 1.1  # lengths of arrows, over the radius of the body
_THICK = 0.012
_TRAIL = 8.0  # seconds of playback that the trail of L lasts


def screen(run: Run) -> Screen:
    """Return the recording of a body that is driven."""
    body, frames = display_of(run.scene.body), frames_of(run)

    def write(recording: Recording) -> None:
        notes = [*frames.play.notes, *body.notes, f"in the inertial view 1 unit is {body.unit:g} m"]
        notes += _write_world(recording, run, body, frames)
        notes.append(write_moving_momentum_space(recording, run, frames))
        _write_momentum(recording, run)
        write_reactions(recording, run)
        if "energy" not in run.invariants:
            write_energy(recording, run)
        write_angular_velocity(recording, run, ascending(run.plan)[1])
        write_euler_angles(recording, run)
        if run.invariants:
            write_drift(recording, run)
        write_text(recording, summary(run, [*notes, frames.note]))

    return Screen("inertia-driven", title(run), _blueprint(run, body, frames), write, frames.play.second)


def _blueprint(run: Run, body: Display, frames: Frames) -> rrb.Blueprint:
    """Arrange inertial view, body view, plots and text."""
    import rerun.blueprint as rrb

    duration = frames.play.end
    behind = trail(min(_TRAIL * frames.play.pace, duration))
    inertial = space_view(
        entities.CENTER,
        name="Inertial view",
        eye_controls=eye(_MOMENTUM * body.radius),
        overrides={f"/{entities.MOMENTUM_TRAIL}": behind},
    )
    along_axes = space_view(
        entities.MOMENTUM_SPACE,
        name="Body view: L over its largest",
        eye_controls=eye(1.25),
        overrides={f"/{entities.TRAIL_OF_MOMENTUM}": behind},
    )
    plots: list[Any] = [plot(entities.PLOT_MOMENTUM, "Angular momentum in space, kg m²/s", duration)]
    if "energy" not in run.invariants:
        plots.append(plot(entities.PLOT_ENERGY, "Energy, J", duration))
    plots.append(plot(entities.PLOT_ANGULAR_VELOCITY, "Angular velocity along the principal axes, rad/s", duration))
    if reactions(run):
        plots.append(reaction_plot(run, duration))
    if is_turned(run):
        plots.append(plot(entities.PLOT_TORQUE, "Torque in space, N m", duration))
    angles = plot(entities.PLOT_EULER_ANGLES, "Euler angles z-x-z, rad", duration)
    plots.append(rrb.Tabs(angles, drift_plot(drift_unit(run), duration)) if run.invariants else angles)
    left = rrb.Vertical(rrb.Horizontal(inertial, along_axes), text_view(), row_shares=[3, 2])
    return finished(left, rrb.Vertical(*plots), frames.play.pace, loop=frames.play.loop)


def _write_world(recording: Recording, run: Run, body: Display, frames: Frames) -> Iterator[str]:
    """Write the body about its centre of mass, ω, and L with the way that its tip has come."""
    import rerun as rr

    size, thick = body.radius, _THICK * body.radius
    recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    recording.static(entities.MESH, body.archetype())
    axes = ascending(run.plan)[1]
    yield from write_marks(recording, body, spin_axes(axes, run.angular_velocity[0]))
    write_axes(recording, entities.BODY_AXES, _AXES * size * axes, thick)
    frames.write_attitude(recording)
    fastest, most = largest(frames.angular_velocity), largest(frames.angular_momentum)
    omega, omega_note = never_short(_OMEGA * size, _LEAST * size, frames.angular_velocity)
    momentum, momentum_note = never_short(_MOMENTUM * size, _LEAST * size, frames.angular_momentum)
    yield from (f"{name}: {note}" for name, note in (("ω", omega_note), ("L", momentum_note)) if note)
    write_arrow(recording, entities.ANGULAR_VELOCITY, frames.time, omega, "ω", OMEGA, 1.5 * thick)
    write_arrow(recording, entities.ANGULAR_MOMENTUM, frames.time, momentum, "L", MOMENTUM, 1.5 * thick)
    if frames.play.near:
        near, path = frames.near, entities.MOMENTUM_TRAIL
        write_trail(recording, path, frames.time[near], momentum[near], MOMENTUM, 0.6 * thick)
    yield from write_torque(recording, run, frames, size, 1.5 * thick)
    yield from write_primary(recording, run, frames, size, thick)
    yield (f"the arrow of ω (orange) is {fastest:.4g} rad/s where it is longest, that of L (blue) {most:.4g} kg m²/s")


def _write_momentum(recording: Recording, run: Run) -> None:
    """Write L along space axes, and its magnitude, at every sample."""

    def momenta(rows: slice) -> Float:
        some = run.angular_momentum[rows]
        return np.column_stack([some, np.linalg.norm(some, axis=1)])

    names = [f"{name}, kg m²/s" for name in ("Lx", "Ly", "Lz", "|L|")]
    recording.scalars(entities.PLOT_MOMENTUM, run.time, momenta, names, COLORS[:4])
