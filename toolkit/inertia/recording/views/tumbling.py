"""Recording of a body that turns about its centre of mass or a fixed point, free of torque.

Along space axes: the body, ω, L, the herpolhode, and the cones of a symmetric top; along its own, Binet's construction.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.models.free.flips import polhode_period
from inertia.dynamics.models.free.motion import MOST_EVENTS
from inertia.dynamics.plots.subject import numbered
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.display import Display, display_of, facets
from inertia.recording.drawing import (
    COLORS,
    MOMENTUM,
    OMEGA,
    STATE_COLORS,
    TRAIL,
    write_arrow,
    write_axes,
    write_lines,
    write_place,
    write_text,
    write_trail,
)
from inertia.recording.playback import Frames, frames_of, largest, round_down, strobe
from inertia.recording.screen import (
    Screen,
    drift_plot,
    eye,
    finished,
    plot,
    space_view,
    state_timeline,
    text_view,
    trail,
    whole_path,
)
from inertia.recording.series import (
    drift_unit,
    write_angles_from_momentum,
    write_angular_velocity,
    write_drift,
    write_energy,
    write_euler_angles,
    write_events,
)
from inertia.recording.spin_marks import spin_axes, write_marks
from inertia.recording.summary import figure, summary, title
from inertia.recording.views.loads import write_weight
from inertia.recording.views.momentum_space import write_momentum_space
from inertia.recording.views.poinsot import poinsot_view, rolls, write_poinsot
from inertia.recording.views.wobble import dial_view, wobbles, write_dial
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

BODY_CONE, SPACE_CONE = (*COLORS[1], 90), (*OMEGA, 70)

_OMEGA, _MOMENTUM, _AXES = 1.3, 1.55, 1.15  # lengths of arrows, over the radius of the body
_THICK = 0.012
_OF_PATH = 0.09  # of the length of a path, a body that is to be seen along it
_FARTHEST = 1e4  # radii that a body may travel and still be where it is to a thousandth of its size
_TRAIL = 10.0  # seconds of playback that a trail lasts, where no polhode closes sooner
_FACETS = 72  # of a cone
_NARROWEST = 1e-3  # rad: a cone that could not be told from a line is not drawn
_WIDE, _PALE = 1.0, 35  # rad: a cone that is wider would hide what is behind it, and is paler
_RIBS = 12  # of a cone: facets from one line along it to the next is their number over this


def screen(run: Run) -> Screen:
    """Return the recording of a body that tumbles."""
    body, frames = display_of(run.scene.body), frames_of(run)
    origin = _origin(body, frames)

    def write(recording: Recording) -> None:
        notes = [*frames.play.notes, *body.notes, f"in the inertial view 1 unit is {body.unit:g} m"]
        notes += _write_world(recording, run, body, frames, origin)
        notes.append(write_momentum_space(recording, run, frames))
        if rolls(run):
            scale, thick = _scale(run, body), _THICK * body.radius
            notes.append(write_poinsot(recording, run, frames, scale, thick))
        if wobbles(run) and frames.play.near:
            notes.append(write_dial(recording, run, frames))
        write_angular_velocity(recording, run, numbered(run.plan)[1])
        _, middle = _intermediate(run)
        write_events(
            recording, entities.PLOT_ANGULAR_VELOCITY, run, "flip", lambda there: there.angular_velocity @ middle
        )
        if run.angular_momentum[0].any():
            write_angles_from_momentum(recording, run, numbered(run.plan)[1])
        write_euler_angles(recording, run)
        if run.invariants:
            write_drift(recording, run)
        if "energy" not in run.invariants:
            write_energy(recording, run)
        _write_flips(recording, run)
        notes += _unlisted_flips(run)
        write_text(recording, summary(run, [*notes, frames.note]))

    return Screen("inertia-tumble", title(run), _blueprint(run, body, frames), write, frames.play.second)


def _blueprint(run: Run, body: Display, frames: Frames) -> rrb.Blueprint:
    """Arrange inertial view, body view, plots, flips and text."""
    import rerun.blueprint as rrb

    duration = frames.play.end
    behind = {f"/{entities.HERPOLHODE}": trail(_trail(run, frames))}
    apart = (entities.INERTIA_ELLIPSOID, entities.INVARIABLE_PLANE, entities.GHOSTS, entities.PATH)
    inertial = space_view(
        entities.CENTER,
        contents=[f"/{entities.WORLD}/**", *(f"- /{path}/**" for path in apart)],
        name="Inertial view",
        eye_controls=eye(_MOMENTUM * body.radius),
        overrides=behind,
    )
    along_axes = space_view(entities.MOMENTUM_SPACE, name="Body view: L / |L|", eye_controls=eye(1.25))
    plots: list[Any] = [
        plot(entities.PLOT_ANGULAR_VELOCITY, "Angular velocity along the principal axes, rad/s", duration),
        plot(entities.PLOT_FROM_MOMENTUM, "Angles between L and the principal axes, rad", duration),
    ]
    if "energy" not in run.invariants:
        plots.append(plot(entities.PLOT_ENERGY, "Energy, J", duration))
    last = [plot(entities.PLOT_EULER_ANGLES, "Euler angles z-x-z, rad", duration)]
    if run.invariants:
        last.insert(0, drift_plot(drift_unit(run), duration))
    plots.append(rrb.Tabs(*last) if len(last) > 1 else last[0])
    left: list[Any] = [rrb.Horizontal(inertial, along_axes, column_shares=[1, 1])]
    shares = [3.0]
    if _flips(run):
        left.append(state_timeline(entities.FLIPS, f"Flips: the spin about axis {_intermediate(run)[0]}", duration))
        shares.append(0.8)
    below: list[Any] = [text_view()]
    others: list[Any] = [dial_view()] if wobbles(run) and frames.play.near else []
    if (origin := _origin(body, frames)) is not None and frames.position is not None:
        contents = [f"/{path}/**" for path in (entities.GHOSTS, entities.PATH)]
        path = (frames.position - origin) / body.unit
        sight = whole_path(path, _enlargement(body, path) * body.radius)
        others.append(space_view(entities.WORLD, contents=contents, name="Stroboscope", eye_controls=sight))
    if rolls(run):
        others.append(poinsot_view(run, _scale(run, body), behind))
    if others:
        below.insert(0, rrb.Tabs(*others) if len(others) > 1 else others[0])
    left.append(rrb.Horizontal(*below))
    shares.append(2.6)
    return finished(
        rrb.Vertical(*left, row_shares=shares), rrb.Vertical(*plots), frames.play.pace, loop=frames.play.loop
    )


def _scale(run: Run, body: Display) -> float:
    """Return how long in a view 1 rad/s is."""
    return _OMEGA * body.radius / largest(run.angular_velocity)


def _origin(body: Display, frames: Frames) -> Float | None:
    """Return the point of space (3,) m that positions are shown from.

    None where the body stays, or travels so far that float32 would make it tremble: then it is shown standing.
    """
    if frames.position is None:
        return None
    low, high = frames.position.min(axis=0), frames.position.max(axis=0)
    reach = float(np.linalg.norm(high - low))
    return low if 0 < reach <= _FARTHEST * body.radius * body.unit else None


def _trail(run: Run, frames: Frames) -> float:
    """Return for how long in s of the timeline the herpolhode is drawn behind ω."""
    omega = run.angular_velocity[0] @ run.plan.axes
    period = float(polhode_period(run.plan.moments, omega)) if omega.any() else np.inf
    return min(period / frames.play.second, _TRAIL * frames.play.pace, frames.play.end)


def _write_world(recording: Recording, run: Run, body: Display, frames: Frames, origin: Float | None) -> Iterator[str]:
    import rerun as rr

    size = body.radius
    recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    recording.static(entities.MESH, body.archetype())
    axes = numbered(run.plan)[1]
    yield from write_marks(recording, body, spin_axes(axes, run.angular_velocity[0]))
    write_axes(recording, entities.BODY_AXES, _AXES * size * axes, _THICK * size)
    frames.write_attitude(recording)
    if origin is not None:
        frames.write_position(recording, body.unit, origin)
        yield from _write_ghosts(recording, body, frames, origin)
    elif frames.position is not None:
        yield "the body travels far: it is shown without its path, from its centre of mass"
    omega = _scale(run, body) * frames.angular_velocity
    momentum = _MOMENTUM * size * frames.angular_momentum / largest(frames.angular_momentum)
    thick = _THICK * size
    write_arrow(recording, entities.ANGULAR_VELOCITY, frames.time, omega, "ω", OMEGA, 1.5 * thick)
    write_arrow(recording, entities.ANGULAR_MOMENTUM, frames.time, momentum, "L", MOMENTUM, 1.5 * thick)
    yield from write_weight(recording, run, size, thick)
    if frames.play.near:
        write_trail(recording, entities.HERPOLHODE, frames.time[frames.near], omega[frames.near], TRAIL, 0.6 * thick)
        yield "the yellow trail of ω is the herpolhode"
    yield (
        f"the arrow of ω (orange) is {largest(frames.angular_velocity):.4g} rad/s where it is longest, that of L "
        f"(blue) {largest(frames.angular_momentum):.4g} kg m²/s"
    )
    yield from _write_cones(recording, run, _OMEGA * size)


def _write_ghosts(recording: Recording, body: Display, frames: Frames, origin: Float) -> Iterator[str]:
    """Write the body along its path, dim at instants that are equally far apart, large enough to be seen."""
    assert frames.position is not None  # it has an origin
    path = (frames.position - origin) / body.unit
    factor = _enlargement(body, path)
    larger = body.enlarged(factor)
    recording.static(f"{entities.GHOSTS}/now", larger.archetype())
    write_place(recording, f"{entities.GHOSTS}/now", frames.time, path, frames.attitude)
    size = f", {factor:g} times as large" if factor > 1.0 else ""
    yield f"the inertial view goes with the centre of mass, the stroboscope shows where that goes and the body{size}"
    if frames.play.near:
        rows, apart = strobe(frames.time[frames.near])
        recording.static(entities.GHOSTS, *larger.copies(path[rows], frames.attitude[rows]))
        yield f"the dim ones are {apart:.4g} s apart"


def _enlargement(body: Display, path: Float) -> float:
    """Return how many times as large a body is drawn along a path (m, 3) that is long for it."""
    return round_down(max(1.0, _OF_PATH * float(np.linalg.norm(np.ptp(path, axis=0))) / body.radius))


def _write_cones(recording: Recording, run: Run, slant: float) -> Iterator[str]:
    """Write the cones of a symmetric top, as long as the arrow of ω: that of the body rolls on that of space."""
    if "body cone" not in run.quantities:
        return
    body_angle, space_angle = (float(run.quantities[name]) for name in ("body cone", "space cone"))
    if body_angle < _NARROWEST:
        return
    moments, symmetry = run.plan.moments, run.plan.axes[:, 2]
    momentum = run.angular_momentum[0] / np.linalg.norm(run.angular_momentum[0])
    for path, axis, half_angle, color in (
        (entities.BODY_CONE, symmetry * np.copysign(1.0, run.angular_velocity[0] @ symmetry), body_angle, BODY_CONE),
        (entities.SPACE_CONE, momentum, space_angle, SPACE_CONE),
    ):
        corners = slant * _cone(axis, half_angle)
        recording.static(path, facets(corners, color if half_angle < _WIDE else (*color[:3], _PALE)))
        ribs = [*corners[:: _FACETS // _RIBS, :2], np.concatenate([corners[:, 1], corners[:1, 1]])]
        write_lines(recording, f"{path}/ribs", ribs, color[:3], 0.3 * _THICK * slant)
    how = "on the outside of" if 2.0 * moments[2] < moments[0] + moments[1] else "with its inside around"
    yield (
        f"the body cone (green, half-angle {np.degrees(body_angle):.4g}°) rolls {how} the space cone (orange, "
        f"{np.degrees(space_angle):.4g}°): they touch along ω"
    )


def _cone(axis: Float, half_angle: float) -> Float:
    """Return the triangles (k, 3, 3) of a cone of unit slant about `axis` (3,), its apex at the origin."""
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    turn = np.linspace(0.0, 2.0 * np.pi, _FACETS + 1)[:, None]
    circle = np.cos(turn) * across + np.sin(turn) * np.cross(axis, across)
    rim = np.cos(half_angle) * axis + np.sin(half_angle) * circle
    triangles: Float = np.stack([np.zeros_like(rim[1:]), rim[:-1], rim[1:]], axis=1)
    return triangles


def _flips(run: Run) -> list[float]:
    return [event.time for event in run.events if event.name == "flip"]


def _unlisted_flips(run: Run) -> Iterator[str]:
    """Say why a body that flips has no timeline of it: the model lists so many flips at most."""
    duration, period = float(run.time[-1]), float(run.quantities.get("flip period", np.inf))
    if not _flips(run) and duration > MOST_EVENTS * period:
        yield (
            f"the body flips every {period:.4g} s, about {figure(duration / period)} times: they are too many to be "
            f"marked on ω and on a timeline, where up to {MOST_EVENTS} are"
        )


def _intermediate(run: Run) -> tuple[int, Float]:
    """Return the number, from 1, and the axis (3,), part axes, of the intermediate moment."""
    moments, axes = numbered(run.plan)
    k = int(np.argsort(moments, kind="stable")[1])
    return k + 1, axes[:, k]


def _write_flips(recording: Recording, run: Run) -> None:
    """Write the sense of the spin about the intermediate axis, at the start and from each flip on."""
    import rerun as rr

    if not (flips := _flips(run)):
        return
    number, middle = _intermediate(run)
    senses = f"+{number}", f"−{number}"
    first = 0 if run.angular_velocity[0] @ middle > 0 else 1
    states = [senses[(first + k) % 2] for k in range(len(flips) + 1)]
    recording.static(entities.FLIPS, rr.StateConfiguration(values=senses, colors=STATE_COLORS))
    time = np.array([run.time[0], *flips])
    recording.columns(entities.FLIPS, time, lambda rows: rr.StateChange.columns(state=states[rows]))
