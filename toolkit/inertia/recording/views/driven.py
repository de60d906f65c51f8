"""Recording of a body that torques, damping or losses drive: L, the energy and the attitude as they change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.plots.subject import numbered
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.display import Display, display_of
from inertia.recording.drawing import (
    COLORS,
    MOMENTUM,
    OMEGA,
    TRAIL,
    write_arrow,
    write_axes,
    write_lines,
    write_place,
    write_text,
    write_trail,
)
from inertia.recording.playback import Frames, frames_of, largest, never_short
from inertia.recording.sampling import write_series
from inertia.recording.screen import Screen, drift_plot, eye, finished, plot, space_view, text_view, trail
from inertia.recording.series import (
    drift_unit,
    write_angles_from_momentum,
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
    write_weight,
)
from inertia.recording.views.momentum_space import trail_of_momentum, write_moving_momentum_space
from inertia.recording.views.phase_portrait import PhasePortrait, phase_portrait
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

AXLE, FORCE = (235, 235, 240), TRAIL

_OMEGA, _MOMENTUM, _AXES, _LEAST = 1.3, 1.55, 1.15, 1.1  # lengths of arrows, over the radius of the body
_THICK, _AXLE, _FORCE = 0.012, 0.6, 0.7
_TRAIL = 8.0  # seconds of playback that the trail of L lasts


def screen(run: Run) -> Screen:
    """Return the recording of a body that is driven."""
    body, frames = display_of(run.scene.body), frames_of(run)
    portrait = phase_portrait(run, frames)

    def write(recording: Recording) -> None:
        notes = [*frames.play.notes, *body.notes, f"in the inertial view 1 unit is {body.unit:g} m"]
        notes += _write_world(recording, run, body, frames)
        if portrait is not None:
            notes.append(portrait.write(recording, frames))
        else:
            notes.append(write_moving_momentum_space(recording, run, frames))
        _write_momentum(recording, run)
        write_reactions(recording, run)
        if "energy" not in run.invariants:
            write_energy(recording, run)
        write_angular_velocity(recording, run, numbered(run.plan)[1])
        if run.angular_momentum.any() and "angle" not in run.quantities:
            write_angles_from_momentum(recording, run, numbered(run.plan)[1])
        write_euler_angles(recording, run)
        if "angle" in run.quantities:
            _write_angle(recording, run)
        if run.invariants:
            write_drift(recording, run)
        write_text(recording, summary(run, [*notes, frames.note]))

    return Screen("inertia-driven", title(run), _blueprint(run, body, frames, portrait), write, frames.play.second)


def _blueprint(run: Run, body: Display, frames: Frames, portrait: PhasePortrait | None) -> rrb.Blueprint:
    """Arrange inertial view, body view, plots and text."""
    import rerun.blueprint as rrb

    duration = frames.play.end
    behind = min(_TRAIL * frames.play.pace, duration) * frames.play.second
    inertial = space_view(
        entities.WORLD if "angle" in run.quantities else entities.CENTER,
        name="Inertial view",
        eye_controls=eye(max(_pivot(run, body) + _AXES * body.radius, _MOMENTUM * body.radius)),
        overrides={f"/{entities.MOMENTUM_TRAIL}": trail(behind / frames.play.second)},
    )
    along_axes: Any = space_view(
        entities.MOMENTUM_SPACE,
        name="Body view: L over its largest",
        eye_controls=eye(1.4),
        overrides={f"/{entities.TRAIL_OF_MOMENTUM}": trail(trail_of_momentum(frames, behind) / frames.play.second)},
    )
    if portrait is not None:
        along_axes = portrait.view
    momentum = plot(entities.PLOT_MOMENTUM, "Angular momentum in space, kg m²/s", duration)
    loads: list[Any] = [reaction_plot(run, duration)] if reactions(run) else []
    if is_turned(run):
        loads.append(plot(entities.PLOT_TORQUE, "Torque in space, N m", duration))
    others: list[Any] = [] if "energy" in run.invariants else [plot(entities.PLOT_ENERGY, "Energy, J", duration)]
    if run.invariants:
        others.append(drift_plot(drift_unit(run), duration))
    first = momentum
    rates = plot(entities.PLOT_ANGULAR_VELOCITY, "Angular velocity along the principal axes, rad/s", duration)
    if "angle" in run.quantities:
        first = plot(entities.PLOT_ANGLE, "Angle of the axle and its rate", duration)
        loads.append(momentum)
        others += [rates]
    elif run.angular_momentum.any():
        angles = plot(entities.PLOT_FROM_MOMENTUM, "Angles between L and the principal axes, rad", duration)
        if "angular momentum" in run.invariants:
            first, angles = angles, momentum  # which stays
        others.append(angles)
    others.append(plot(entities.PLOT_EULER_ANGLES, "Euler angles z-x-z, rad", duration))
    rows: list[Any] = [first] if "angle" in run.quantities else [first, rates]
    rows += [rrb.Tabs(*each) for each in (loads, others) if each]
    left = rrb.Vertical(rrb.Horizontal(inertial, along_axes), text_view(), row_shares=[3, 2])
    return finished(left, rrb.Vertical(*rows), frames.play.pace, loop=frames.play.loop)


def _swings(run: Run, frames: Frames) -> bool:
    """Say whether the centre of mass goes round an axle."""
    return "angle" in run.quantities and frames.position is not None and bool(_arm(run).any())


def _arm(run: Run) -> Float:
    """Return where the centre of mass is from the fixed point (3,) m, part axes."""
    arm: Float = run.scene.body.center_of_mass - run.scene.constraint.fixed_point
    return arm


def _pivot(run: Run, body: Display) -> float:
    """Return how far from the axle the centre of mass goes, in the view's unit."""
    return float(np.linalg.norm(_arm(run))) / body.unit if "angle" in run.quantities else 0.0


def _write_world(recording: Recording, run: Run, body: Display, frames: Frames) -> Iterator[str]:
    """Write the body about its centre of mass, ω, and L with the way that its tip has come."""
    import rerun as rr

    size, thick = body.radius, _THICK * body.radius
    recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    recording.static(entities.MESH, body.archetype())
    axes = numbered(run.plan)[1]
    yield from write_marks(recording, body, spin_axes(axes, run.angular_velocity[0]))
    write_axes(recording, entities.BODY_AXES, _AXES * size * axes, thick)
    frames.write_attitude(recording)
    if "angle" in run.quantities:
        yield from _write_axle(recording, run, body, frames)
    fastest, most = largest(frames.angular_velocity), largest(frames.angular_momentum)
    omega, omega_note = never_short(_OMEGA * size, _LEAST * size, frames.angular_velocity)
    momentum, momentum_note = never_short(_MOMENTUM * size, _LEAST * size, frames.angular_momentum)
    yield from (f"{name} {note}" for name, note in (("ω", omega_note), ("L", momentum_note)) if note)
    write_arrow(recording, entities.ANGULAR_VELOCITY, frames.time, omega, "ω", OMEGA, 1.5 * thick)
    write_arrow(recording, entities.ANGULAR_MOMENTUM, frames.time, momentum, "L", MOMENTUM, 1.5 * thick)
    if frames.play.near:
        near, path = frames.near, entities.MOMENTUM_TRAIL
        write_trail(recording, path, frames.time[near], momentum[near], MOMENTUM, 0.6 * thick)
    yield from write_torque(recording, run, frames, size, 1.5 * thick)
    yield from write_primary(recording, run, frames, size, thick)
    yield (f"the arrow of ω (orange) is {fastest:.4g} rad/s where it is longest, that of L (blue) {most:.4g} kg m²/s")


def _write_axle(recording: Recording, run: Run, body: Display, frames: Frames) -> Iterator[str]:
    """Write the axle through the fixed point, the weight, and the centre of mass as it goes round."""
    size = body.radius
    axis = quaternion.to_space(frames.attitude[0], run.plan.axes @ (run.plan.axes.T @ run.plan.problem.axle))
    held = run.scene.constraint.bearings
    half = max(_AXLE * size, 0.0 if held is None else 1.2 * float(np.abs(held).max()) / body.unit) * axis
    write_lines(recording, entities.AXLE, [np.stack([-half, half])], AXLE, 1.2 * _THICK * size)
    if _swings(run, frames):
        arm = quaternion.to_space(frames.attitude, _arm(run) / body.unit)
        write_place(recording, entities.CENTER, frames.time, arm)
        yield "the axle (white) is the origin of the inertial view"
    else:
        yield "the axle is white"
    yield from write_weight(recording, run, 0.6 * size, _THICK * size)
    yield from _write_bearings(recording, run, body, frames, axis)


def _write_bearings(recording: Recording, run: Run, body: Display, frames: Frames, axis: Float) -> Iterator[str]:
    """Write the forces that two bearings take, where they are on the axle, to one scale."""
    import rerun as rr

    places = run.scene.constraint.bearings
    forces = {name: frames.series[f"force on bearing {name}"] for name in "AB" if places is not None}
    most = max(map(largest, forces.values()), default=0.0)
    if places is None or not most:
        return
    thick = _THICK * body.radius
    for place, (name, force) in zip(places.tolist(), forces.items(), strict=True):
        path = f"{entities.AXLE}/{name}"
        recording.static(path, rr.Transform3D(translation=place / body.unit * axis))
        arrow = _FORCE * body.radius / most * force
        write_arrow(recording, f"{path}/force", frames.time, arrow, name, FORCE, 1.5 * thick)
    yield f"the forces on the bearings A and B (yellow) are {most:.4g} N where they are largest"


def _write_angle(recording: Recording, run: Run) -> None:
    """Write the angle of the axle and its rate, at every sample."""
    table = np.stack([run.quantities["angle"], run.angular_velocity @ run.plan.problem.axle], axis=1)
    write_series(recording, entities.PLOT_ANGLE, run, table.__getitem__, ["θ, rad", "θ rate, rad/s"], COLORS[1:3])


def _write_momentum(recording: Recording, run: Run) -> None:
    """Write L along space axes, and its magnitude, at every sample."""

    def momenta(rows: slice) -> Float:
        some = run.angular_momentum[rows]
        return np.column_stack([some, np.linalg.norm(some, axis=1)])

    names = [f"{name}, kg m²/s" for name in ("Lx", "Ly", "Lz", "|L|")]
    write_series(recording, entities.PLOT_MOMENTUM, run, momenta, names, COLORS[:4])
