"""Recording of a heavy body on a fixed point: its axis in space and on the unit sphere, and its effective potential."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import to_angles
from inertia.dynamics.models.heavy.top import MOST_EVENTS
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.display import Display, display_of
from inertia.recording.drawing import (
    COLORS,
    GROUND,
    MOMENTUM,
    OMEGA,
    TRAIL,
    basis,
    circle,
    thinned,
    write_arrow,
    write_labels,
    write_lines,
    write_place,
    write_point,
    write_text,
    write_trail,
)
from inertia.recording.playback import Frames, frames_followed, largest, longest_as
from inertia.recording.sampling import write_series
from inertia.recording.screen import Screen, camera, drift_plot, finished, plot, space_view, text_view, trail
from inertia.recording.series import drift_unit, write_drift, write_events
from inertia.recording.spin_marks import write_marks
from inertia.recording.summary import summary, title
from inertia.recording.views.loads import write_weight
from inertia.recording.views.phase_portrait import PhasePortrait, phase_portrait
from inertia.recording.writer import Recording
from inertia.records import dataclass

if TYPE_CHECKING:
    import rerun.blueprint as rrb

LOCUS, TURNING, AXIS = TRAIL, COLORS[1], (235, 235, 240)

_SPHERE = 1.1  # over the reach of the body, of the sphere that its axis points at
_OMEGA, _MOMENTUM = 1.15, 1.3  # lengths of arrows, over that sphere
_THICK = 0.008
_TRAIL = 12.0  # seconds of playback
_LEAST_CAP = 0.15
_UPRIGHT = 1e-12  # sin² of a tilt, below which the axis has no direction to precess in
_FROM = np.array([0.62, -0.66, 0.42])
_ABOVE = np.array([0.45, -0.55, 0.75])


@dataclass(frozen=True, eq=False)
class Axis:
    """The line from the fixed point to the centre of mass, seen along the vertical.

    Attributes
    ----------
    vertical : (3, 3), columns in space, the last one up
    axes : (3, 3), columns in part axes, the last one from the fixed point to the centre of mass
    arm : m, between the two
    """

    vertical: Float
    axes: Float
    arm: float

    def direction(self, attitude: Float) -> Float:
        """Return where it points, (m, 3), in space."""
        return quaternion.to_space(attitude, self.axes[:, 2])

    def angles(self, attitude: Float) -> Float:
        """Return φ, θ and ψ (m, 3) in rad, θ being the tilt from the vertical."""
        about = quaternion.conjugate(quaternion.from_matrix(self.vertical))
        return to_angles(quaternion.multiply(about, quaternion.multiply(attitude, quaternion.from_matrix(self.axes))))


def screen(run: Run) -> Screen:
    """Return the recording of a heavy top."""
    body, axis = display_of(run.scene.body), _axis(run)
    frames = _frames(run, axis)
    tilts = axis.angles(frames.attitude)[:, 1]
    portrait = phase_portrait(run, frames)

    def write(recording: Recording) -> None:
        notes = [
            *frames.play.notes,
            *body.notes,
            f"in space 1 unit is {body.unit:g} m, and the fixed point is the origin",
        ]
        notes += _write_world(recording, run, body, frames, axis)
        notes += _write_sphere(recording, run, frames, axis, _cap(tilts))
        _write_angles(recording, run, axis)
        if sum(event.name == "turning point" for event in run.events) == MOST_EVENTS:
            notes.append(f"the first {MOST_EVENTS} turning points are marked on the plot of the tilt, no later ones")
        write_drift(recording, run)
        if portrait is not None:
            notes.append(_write_spin(recording, run))
            notes.append(portrait.write(recording, frames))
        write_text(recording, summary(run, [*notes, frames.note]))

    blueprint = _blueprint(run, frames, _sphere(body, axis), axis, tilts, portrait)
    return Screen("inertia-top", title(run), blueprint, write, frames.play.second)


def _blueprint(
    run: Run, frames: Frames, radius: float, axis: Axis, tilts: Float, portrait: PhasePortrait | None
) -> rrb.Blueprint:
    """Arrange space, with a sphere of this radius that the axis points at, unit sphere, potential, plots and text."""
    import rerun.blueprint as rrb

    duration = frames.play.end
    behind = trail(min(_TRAIL * frames.play.pace, duration))
    space = space_view(
        entities.WORLD,
        name="In space",
        eye_controls=_eye(axis, radius, tilts),
        overrides={f"/{entities.LOCUS}": behind},
    )
    sphere = space_view(
        entities.UNIT_SPHERE,
        name="Locus of the axis on the unit sphere",
        eye_controls=_eye_on_sphere(axis, tilts),
        overrides={f"/{entities.UNIT_SPHERE}/trail": behind},
    )
    below: list[Any] = [text_view()]
    if portrait is not None:
        below.insert(0, portrait.view)
    left = rrb.Vertical(rrb.Horizontal(space, sphere), rrb.Horizontal(*below), row_shares=[3, 2])
    lower = [
        drift_plot(drift_unit(run), duration),
        plot(entities.PLOT_EULER_ANGLES, "Precession φ and spin ψ, rad", duration),
    ]
    if portrait is not None:
        lower.insert(0, plot(entities.PLOT_SPIN, "Spin, and the least to sleep upright, rad/s", duration))
    right = rrb.Vertical(
        plot(entities.PLOT_TILT, "Tilt θ of the axis from the vertical, rad", duration),
        plot(entities.PLOT_PRECESSION, "Rate of the precession φ, rad/s", duration),
        rrb.Tabs(*lower),
    )
    return finished(left, right, frames.play.pace, loop=frames.play.loop)


def _eye(axis: Axis, radius: float, tilts: Float) -> rrb.EyeControls3D:
    """Look at the upper half of the sphere, or at all of it where the axis sinks below the horizontal."""
    up, sunk = axis.vertical[:, 2], tilts.max() > 0.5 * np.pi
    target = (0.0 if sunk else 0.45) * radius * up
    offset = basis(up) @ _FROM / np.linalg.norm(_FROM)
    return camera((2.7 if sunk else 2.1) * radius * offset, target, up)


def _eye_on_sphere(axis: Axis, tilts: Float) -> rrb.EyeControls3D:
    """Look at the cap that holds the path."""
    up = axis.vertical[:, 2]
    target = 0.5 * (np.cos(tilts.max()) + np.cos(tilts.min())) * up
    offset = basis(up) @ _ABOVE / np.linalg.norm(_ABOVE)
    return camera(2.6 * _cap(tilts) * offset, target, up)


def _is_symmetric(run: Run) -> bool:
    """Say whether the model took the body as a heavy symmetric top, the only one that has an effective potential."""
    return "effective potential energy" in run.quantities


def _axis(run: Run) -> Axis:
    problem = run.plan.problem
    arm = problem.axes @ problem.arm
    length = float(np.linalg.norm(arm))
    up = -run.scene.gravity / np.linalg.norm(run.scene.gravity)
    axes = run.plan.axes if _is_symmetric(run) else basis(arm / length)
    return Axis(basis(up), axes, length)


def _frames(run: Run, axis: Axis) -> Frames:
    """Resample a run at the speed at which its axis can be followed, which may be much slower than its spin."""
    along = axis.axes[:, 2]
    slowest = 2.0 * np.pi / float(run.quantities.get("nutation period", np.inf))

    def fastest(there: Run) -> float:
        omega = there.angular_velocity
        return max(largest(omega - np.outer(omega @ along, along)), slowest)

    return frames_followed(run, fastest)


def _sphere(body: Display, axis: Axis) -> float:
    return _SPHERE * (axis.arm / body.unit + body.radius)


def _write_world(recording: Recording, run: Run, body: Display, frames: Frames, axis: Axis) -> Iterator[str]:
    import rerun as rr

    size = _sphere(body, axis)
    thick = _THICK * size
    along, up = axis.axes[:, 2], axis.vertical[:, 2]
    foot = -axis.arm / body.unit * along
    recording.static(entities.MESH, body.archetype())
    yield from write_marks(recording, body, axis.axes)
    write_lines(recording, entities.BODY_AXES, [np.stack([foot, foot + size * along])], AXIS, thick)
    write_place(recording, entities.CENTER, frames.time, axis.arm / body.unit * axis.direction(frames.attitude))
    frames.write_attitude(recording)
    recording.static(
        entities.VERTICAL,
        rr.Arrows3D(vectors=[1.2 * size * up], colors=[GROUND], radii=[0.5 * thick]),
    )
    write_labels(recording, f"{entities.VERTICAL}/name", [1.27 * size * up], ["up"])
    recording.static(entities.FIXED_POINT, rr.Points3D([np.zeros(3)], colors=[AXIS], radii=[3.0 * thick]))
    omega = longest_as(_OMEGA * size, frames.angular_velocity)
    momentum = longest_as(_MOMENTUM * size, frames.angular_momentum)
    write_arrow(recording, entities.OMEGA_OF_TOP, frames.time, omega, "ω", OMEGA, thick)
    write_arrow(recording, entities.MOMENTUM_OF_TOP, frames.time, momentum, "L", MOMENTUM, thick)
    near = frames.near
    write_trail(
        recording, entities.LOCUS, frames.time[near], size * axis.direction(frames.attitude[near]), LOCUS, thick
    )
    yield from write_weight(recording, run, 0.5 * size, thick)
    _write_turning(recording, entities.WORLD, run, axis, size, 0.5 * thick)
    yield (
        f"the arrow of ω (orange) is {largest(frames.angular_velocity):.4g} rad/s where it is longest, that of L "
        f"(blue) {largest(frames.angular_momentum):.4g} kg m²/s"
    )


def _cap(tilts: Float) -> float:
    """Return the radius of the cap of the unit sphere that holds the path, or 1 for all of the sphere."""
    return 1.0 if tilts.max() > 0.5 * np.pi else max(float(np.sin(tilts.max())), _LEAST_CAP)


def _write_sphere(recording: Recording, run: Run, frames: Frames, axis: Axis, cap: float) -> Iterator[str]:
    """Write the unit sphere: the whole path of the axis on it, and where the axis is."""
    import rerun as rr

    room, up = entities.UNIT_SPHERE, axis.vertical[:, 2]
    recording.static(
        f"{room}/sphere",
        rr.Ellipsoids3D(
            half_sizes=[np.ones(3)],
            colors=[(*MOMENTUM, 40)],
            line_radii=[0.0015 * cap],
            fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
        ),
    )
    recording.static(f"{room}/vertical", rr.Arrows3D(vectors=[1.25 * up], colors=[GROUND], radii=[0.005 * cap]))
    write_labels(recording, f"{room}/vertical/name", [1.3 * up], ["up"])
    direction = axis.direction(frames.attitude)
    write_lines(recording, f"{room}/locus", [thinned(direction[frames.near])], TRAIL, 0.004 * cap)
    write_arrow(recording, f"{room}/axis", frames.time, direction, "axis", AXIS, 0.007 * cap)
    write_trail(recording, f"{room}/trail", frames.time[frames.near], direction[frames.near], LOCUS, 0.008 * cap)
    write_point(recording, f"{room}/tip", frames.time, direction, AXIS, 0.02 * cap)
    circles = _write_turning(recording, room, run, axis, 1.0, 0.0025 * cap)
    between = f", between the circles at which it turns (green), θ = {circles} rad" if circles else ""
    yield f"the axis runs along the yellow path on the unit sphere{between}"


def _write_turning(recording: Recording, room: str, run: Run, axis: Axis, size: float, radius: float) -> str:
    """Write the circles at the turning angles, if the model knows them; return these."""
    angles = run.quantities.get("turning theta")
    if angles is None:
        return ""
    circles = [circle(size * np.sin(angle), size * np.cos(angle), axis.vertical) for angle in angles]
    write_lines(recording, f"{room}/turning_circles", circles, TURNING, radius)
    return " and ".join(f"{angle:.6g}" for angle in angles)


def _write_spin(recording: Recording, run: Run) -> str:
    """Write the spin about the axis of symmetry, and the least, 2 √(I₁ M g h) / I₃, with which it stays upright."""
    problem, moments = run.plan.problem, run.plan.moments
    spin = run.angular_velocity @ run.plan.axes[:, 2]
    if not moments[2]:
        write_series(recording, entities.PLOT_SPIN, run, lambda rows: spin[rows, None], ["spin, rad/s"], COLORS[2:3])
        return "it has no moment about its axis: no spin would keep it upright"
    least = 2.0 * np.sqrt(moments[0] * problem.weight * np.linalg.norm(problem.arm)) / moments[2]
    table = np.stack([spin, np.full_like(spin, np.copysign(least, spin[0]))], axis=1)
    names = ["spin, rad/s", "least to sleep, rad/s"]
    write_series(recording, entities.PLOT_SPIN, run, table.__getitem__, names, [COLORS[2], COLORS[1]])
    sleeps = "enough" if abs(spin[0]) >= least else "too slow"
    return (
        f"upright it would sleep from {least:.4g} rad/s about its axis on: its spin of {abs(spin[0]):.4g} is {sleeps}"
    )


def _write_angles(recording: Recording, run: Run, axis: Axis) -> None:
    """Write θ, φ and ψ at every sample, and the rate of φ: (ω·u − ω·a cosθ)/sin²θ, with vertical u and axis a."""
    angles = axis.angles(run.attitude)
    omega = quaternion.to_space(run.attitude, run.angular_velocity)
    up, along, tilt = axis.vertical[:, 2], run.angular_velocity @ axis.axes[:, 2], angles[:, 1]
    square = np.sin(tilt) ** 2
    rate = np.divide(omega @ up - along * np.cos(tilt), square, out=np.zeros_like(square), where=square > _UPRIGHT)
    write_series(recording, entities.PLOT_PRECESSION, run, lambda rows: rate[rows, None], ["φ rate, rad/s"], COLORS[:1])
    write_series(recording, entities.PLOT_TILT, run, lambda rows: angles[rows, 1:2], ["θ, rad"], COLORS[1:2])
    write_events(recording, entities.PLOT_TILT, run, "turning point", lambda there: axis.angles(there.attitude)[:, 1])
    names, colors = ["φ, rad", "ψ, rad"], [COLORS[0], COLORS[2]]
    write_series(recording, entities.PLOT_EULER_ANGLES, run, lambda rows: angles[rows, ::2], names, colors)
