"""Recording of a body that rolls or slides on a plane: its path, the point of contact, and the forces of contact."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.display import STEEL, Display, display_of
from inertia.recording.drawing import (
    COLORS,
    MOMENTUM,
    OMEGA,
    STATE_COLORS,
    TRAIL,
    basis,
    circle,
    thinned,
    write_arrow,
    write_lines,
    write_place,
    write_text,
    write_trail,
)
from inertia.recording.playback import Frames, frames_of, never_short
from inertia.recording.sampling import write_series
from inertia.recording.screen import (
    Screen,
    camera,
    drift_plot,
    finished,
    plot,
    space_view,
    state_timeline,
    text_view,
    trail,
)
from inertia.recording.series import drift_unit, write_drift, write_energy, write_events
from inertia.recording.summary import summary, title
from inertia.recording.writer import Recording
from inertia.records import dataclass

if TYPE_CHECKING:
    import rerun.blueprint as rrb

FORCE, WEIGHT, PATH, RIM = COLORS[0], COLORS[1], TRAIL, (235, 235, 240)
DISC, GRID = (*STEEL, 150), (75, 78, 86)
STATES = ("on the plane", "held down by a plane that pulls")

_THICK = 0.015
_WEIGHT = 1.2  # radii, of the arrow of the weight
_ASIDE = 0.15  # radii, of the weight from the centre of mass
_OMEGA, _MOMENTUM, _LEAST = 1.4, 1.7, 1.2  # radii, of ω and L, at most and at least
_TRAIL = 6.0  # seconds of playback
_SPOKES = 8
_LINES = 60  # of the plane's grid, either way
_FROM = np.array([0.55, -0.7, 0.45])
_DISTANCE = 2.3


@dataclass(frozen=True, eq=False)
class Rim:
    """The rim that rolls, or the equator of the ball that slides, in display units about the centre of mass, part axes.

    Attributes
    ----------
    radius, offset : of the circle, and how far along the axis it is
    axes : (3, 3), the last column along the axis
    """

    radius: float
    offset: float
    axes: Float

    @classmethod
    def of(cls, run: Run, unit: float) -> Rim:
        """Take the rim, or the ball, from the scene."""
        held = run.scene.constraint
        assert held.radius is not None  # the scene saw to it
        if held.kind == "rolling":
            return cls(held.radius / unit, (held.offset or 0.0) / unit, run.plan.axes)
        center = held.fixed_point - run.scene.body.center_of_mass
        offset = float(np.linalg.norm(center))
        return cls(held.radius / unit, offset / unit, basis(center / offset) if offset else run.plan.axes)

    @property
    def points(self) -> Float:
        """The circle, (k, 3)."""
        return circle(self.radius, self.offset, self.axes)

    @property
    def spokes(self) -> list[Float]:
        """Lines (2, 3) from the middle of the rim out, so that its turning shows."""
        points = self.points[:-1]
        middle = self.offset * self.axes[:, 2]
        return [np.stack([middle, point]) for point in points[:: len(points) // _SPOKES]]


def screen(run: Run) -> Screen:
    """Return the recording of a body that rolls or slides."""
    body, frames = display_of(run.scene.body), frames_of(run)
    rim = Rim.of(run, body.unit)
    contact = _origin(run) + run.quantities["contact"]
    middle = 0.5 * (contact.min(axis=0) + contact.max(axis=0))
    reach = 0.5 * float(np.ptp(contact, axis=0).max()) / body.unit

    def write(recording: Recording) -> None:
        notes = [*frames.play.notes]
        notes += _write_body(recording, run, body, rim)
        notes += _write_world(recording, run, body, rim, frames, middle)
        _write_plots(recording, run)
        write_drift(recording, run)
        _write_lift_off(recording, run)
        write_text(recording, summary(run, [*notes, frames.note]))

    return Screen("inertia-roll", title(run), _blueprint(run, frames, rim, reach), write, frames.play.second)


def _blueprint(run: Run, frames: Frames, rim: Rim, reach: float) -> rrb.Blueprint:
    """Arrange a view of the whole path, `reach` from its middle, one that goes along, plots and text."""
    import rerun.blueprint as rrb

    duration = frames.play.end
    overrides = {f"/{entities.CONTACT_TRAIL}": trail(min(_TRAIL * frames.play.pace, duration))}
    views = [
        space_view(
            origin,
            contents=f"/{entities.WORLD}/**",
            name=name,
            eye_controls=camera(distance * _FROM / np.linalg.norm(_FROM), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
            overrides=overrides,
        )
        for origin, name, distance in (
            (entities.WORLD, "The path on the plane", 1.25 * _DISTANCE * (reach + 1.5 * rim.radius)),
            (entities.CENTER, "Going along with the body", 1.9 * _DISTANCE * rim.radius),
        )
    ]
    left: list[Any] = [rrb.Horizontal(*views)]
    shares = [3.0]
    if _lift_off(run):
        left.append(state_timeline(entities.CONTACT_STATE, "Contact", duration))
        shares.append(0.6)
    left.append(text_view())
    shares.append(1.6)
    if _slides(run):
        others = [
            plot(entities.PLOT_SLIP, "Speed of the slip at the contact, m/s", duration),
            plot(entities.PLOT_ENERGY, "Energy, J", duration),
        ]
    else:
        others = [plot(entities.PLOT_RATES, "Rates of precession φ, tilt θ and spin ψ, rad/s", duration)]
    right = rrb.Vertical(
        plot(entities.PLOT_FORCE, "Force of the plane on the body, N", duration),
        plot(entities.PLOT_TILT, "Tilt θ of the axis from the normal of the plane, rad", duration),
        *others,
        drift_plot(drift_unit(run), duration),
    )
    return finished(rrb.Vertical(*left, row_shares=shares), right, frames.play.pace, loop=frames.play.loop)


def _slides(run: Run) -> bool:
    return run.scene.constraint.kind == "sliding"


def _origin(run: Run) -> Float:
    return np.zeros(3) if run.scene.start.position is None else run.scene.start.position


def _write_body(recording: Recording, run: Run, body: Display, rim: Rim) -> Iterator[str]:
    """Write the part, or a disc within the rim, or a ball, where there is none, and the rim."""
    import rerun as rr

    if body.triangles is not None:
        recording.static(entities.MESH, body.archetype())
        yield from body.notes
    elif _slides(run):
        center, sizes = rim.offset * rim.axes[:, 2], [rim.radius] * 3
        fill = rr.components.FillMode.TransparentFillMajorWireframe
        ball = rr.Ellipsoids3D(centers=[center], half_sizes=[sizes], colors=[DISC], fill_mode=fill, line_radii=[0.0])
        recording.static(entities.MESH, ball)
        center_of_mass = rr.Points3D([np.zeros(3)], colors=[PATH], radii=[4.0 * _THICK * rim.radius])
        recording.static(entities.MASS_POINT, center_of_mass)
        yield "shown as the ball that slides; its centre of mass is the yellow point"
    else:
        points = rim.points
        middle = np.broadcast_to(rim.offset * rim.axes[:, 2], points[1:].shape)
        corners = np.stack([middle, points[:-1], points[1:]], axis=1).reshape(-1, 3)
        recording.static(entities.MESH, rr.Mesh3D(vertex_positions=np.float32(corners), albedo_factor=DISC))
        yield "shown as a thin disc, as the scene has no part file"
    thick = _THICK * rim.radius
    write_lines(recording, entities.RIM, [rim.points], RIM, 1.5 * thick)
    write_lines(recording, entities.SPOKES, rim.spokes, RIM, 0.7 * thick)


def _write_world(
    recording: Recording, run: Run, body: Display, rim: Rim, frames: Frames, middle: Float
) -> Iterator[str]:
    import rerun as rr

    assert frames.position is not None  # a rolling body has one
    recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    contact = (_origin(run) + frames.series["contact"] - middle) / body.unit
    write_place(recording, entities.CENTER, frames.time, (frames.position - middle) / body.unit)
    frames.write_attitude(recording)
    write_place(recording, entities.CONTACT, frames.time, contact)
    thick = _THICK * rim.radius
    write_lines(recording, entities.CONTACT_PATH, [thinned(contact[frames.near])], PATH, -1.0)
    write_trail(recording, entities.CONTACT_TRAIL, frames.time[frames.near], contact[frames.near], TRAIL, -2.0)
    recording.static(entities.CONTACT_POINT, rr.Points3D([np.zeros(3)], colors=[FORCE], radii=[2.5 * thick]))
    write_lines(recording, entities.GRID, _grid(contact, rim.radius, basis(run.scene.constraint.plane)), GRID, -0.3)
    weight = _weight(run)
    scale = _WEIGHT * rim.radius / float(np.linalg.norm(weight))
    force = scale * frames.series["contact force"]
    write_arrow(recording, entities.CONTACT_FORCE, frames.time, force, "F", FORCE, 1.5 * thick)
    aside = _ASIDE * rim.radius * basis(run.scene.constraint.plane)[:, 0]  # or it would lie on the contact force
    recording.static(entities.WEIGHT, rr.Transform3D(translation=aside))
    weights = np.broadcast_to(scale * weight, force.shape)
    write_arrow(recording, entities.WEIGHT, frames.time, weights, "mg", WEIGHT, 1.5 * thick)
    for path, vectors, label, color, length in (
        (entities.ANGULAR_VELOCITY, frames.angular_velocity, "ω", OMEGA, _OMEGA),
        (entities.ANGULAR_MOMENTUM, frames.angular_momentum, "L", MOMENTUM, _MOMENTUM),
    ):
        arrow, note = never_short(length * rim.radius, _LEAST * rim.radius, vectors)
        write_arrow(recording, path, frames.time, arrow, label, color, thick)
        if note:
            yield f"{label} {note}"
    yield f"1 unit is {body.unit:g} m, from ({', '.join(f'{x:.4g}' for x in middle)}) m of space"
    yield (
        "the point of contact leaves the yellow path on the plane; the contact force F (red) and the weight mg "
        f"(green, {np.linalg.norm(weight):.4g} N) are drawn to one scale, the weight a little aside"
    )


def _grid(contact: Float, radius: float, plane: Float) -> list[Float]:
    """Return lines on the plane, whose normal is the last column of `plane`, a diameter apart or more, from under the
    path to three radii beyond it."""
    along = contact @ plane[:, :2]
    low, high = along.min(axis=0) - 3.0 * radius, along.max(axis=0) + 3.0 * radius
    step = 2.0 * radius * max(1.0, np.ceil((high - low).max() / (2.0 * _LINES * radius)))
    lines = []
    for across in (0, 1):
        for place in step * np.arange(np.ceil(low[across] / step), high[across] / step):
            ends = np.zeros((2, 3))
            ends[:, across], ends[:, 1 - across] = place, (low[1 - across], high[1 - across])
            lines.append(ends @ plane.T)
    return lines


def _weight(run: Run) -> Float:
    mass = run.scene.body.mass
    assert mass is not None  # a rolling body has one
    return mass * run.scene.gravity


def _contact_force(run: Run) -> Float:
    """Return the force of the plane (n, 3) N: two components along it, and the normal one."""
    force: Float = run.quantities["contact force"] @ basis(run.scene.constraint.plane)
    return force


def _write_plots(recording: Recording, run: Run) -> None:
    force, weight = _contact_force(run), np.linalg.norm(_weight(run))
    write_series(
        recording,
        entities.PLOT_FORCE,
        run,
        lambda rows: np.stack(
            [force[rows, 2], np.hypot(force[rows, 0], force[rows, 1]), np.full(len(force[rows]), weight)], axis=1
        ),
        ["normal, N", "friction, N", "weight, N"],
        [FORCE, COLORS[3], WEIGHT],
    )
    write_events(recording, entities.PLOT_FORCE, run, "lift-off", lambda there: _contact_force(there)[:, 2])
    tilt = run.quantities["theta"]
    write_series(recording, entities.PLOT_TILT, run, lambda rows: tilt[rows, None], ["θ, rad"], COLORS[1:2])
    if _slides(run):
        slip = np.linalg.norm(run.quantities["contact velocity"], axis=1)
        write_series(recording, entities.PLOT_SLIP, run, lambda rows: slip[rows, None], ["slip, m/s"], COLORS[2:3])
        write_energy(recording, run)
        return
    rates = [run.quantities[f"{name} rate"] for name in ("phi", "theta", "psi")]
    write_series(
        recording,
        entities.PLOT_RATES,
        run,
        lambda rows: np.stack([rate[rows] for rate in rates], axis=1),
        ["φ rate, rad/s", "θ rate, rad/s", "ψ rate, rad/s"],
        COLORS[:3],
    )


def _lift_off(run: Run) -> list[float]:
    return [event.time for event in run.events if event.name == "lift-off"]


def _write_lift_off(recording: Recording, run: Run) -> None:
    """Write up to when the plane only pushes."""
    import rerun as rr

    if not (instants := _lift_off(run)):
        return
    recording.static(entities.CONTACT_STATE, rr.StateConfiguration(values=STATES, colors=STATE_COLORS))
    states = list(STATES) if instants[0] > run.time[0] else [STATES[1]]
    time = np.array([run.time[0], instants[0]][-len(states) :])
    recording.columns(entities.CONTACT_STATE, time, lambda rows: rr.StateChange.columns(state=states[rows]))
