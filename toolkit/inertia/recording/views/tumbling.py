"""A body that turns about its centre of mass or a fixed point: what is drawn, along space axes and along its own."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.models.free.flips import polhode_period
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Run
from inertia.recording import paths
from inertia.recording.display import Display, display_of
from inertia.recording.frames import Frames, frames_of, write_arrow, write_trail
from inertia.recording.panels import write_text
from inertia.recording.playback import largest
from inertia.recording.principal import ascending
from inertia.recording.screen import Screen
from inertia.recording.series import (
    COLORS,
    drift_unit,
    write_angular_velocity,
    write_drift,
    write_energy,
    write_euler_angles,
)
from inertia.recording.summary import summary, title
from inertia.recording.views.blueprint_tumbling import Layout, blueprint
from inertia.recording.views.cones import write_cones
from inertia.recording.views.momentum_space import write_momentum_space
from inertia.recording.writer import Recording

APPLICATION = "inertia-tumble"

OMEGA, MOMENTUM, TRAIL = (255, 200, 60), (90, 200, 255), (255, 140, 60)
FLIP_STATES = ("+2", "−2")

_OMEGA, _MOMENTUM, _AXES = 1.3, 1.55, 1.15  # lengths of arrows, over the radius of the body
_THICK = 0.012
_FARTHEST = 1e4  # radii that a body may travel and still be where it is to a thousandth of its size
_TRAIL = 10.0  # seconds of playback that a trail lasts, where no polhode closes sooner


def tumbling(run: Run) -> Screen:
    """Return the recording of a body that tumbles."""
    chosen = run.plan
    body = display_of(run.scene.body)
    frames = frames_of(run)
    origin = _origin(body, frames)
    layout = Layout(
        radius=body.radius * _MOMENTUM,
        duration=float(run.time[-1]),
        trail=_trail(run, chosen, frames),
        speed=frames.play.speed,
        drift_unit=drift_unit(run) if run.invariants else None,
        energy="energy" not in run.invariants,
        flips=bool(_flips(run)),
    )

    def write(recording: Recording) -> None:
        said = [*frames.play.said, *body.said, f"in the inertial view 1 unit is {body.unit:g} m"]
        said += _write_world(recording, run, chosen, body, frames, origin)
        said.append(write_momentum_space(recording, run, chosen, frames))
        write_angular_velocity(recording, run, ascending(chosen)[1])
        write_euler_angles(recording, run)
        if layout.drift_unit is not None:
            write_drift(recording, run)
        if layout.energy:
            write_energy(recording, run)
        _write_flips(recording, run, chosen)
        write_text(recording, summary(run, said))

    return Screen(APPLICATION, title(run), blueprint(layout), write)


def _origin(body: Display, frames: Frames) -> Float | None:
    """Return the point of space (3,) m that positions are shown from.

    None where the body stays, or travels so far that float32 would make it tremble: then it is shown standing.
    """
    if frames.position is None:
        return None
    low, high = frames.position.min(axis=0), frames.position.max(axis=0)
    reach = float(np.linalg.norm(high - low))
    return low if 0 < reach <= _FARTHEST * body.radius * body.unit else None


def _trail(run: Run, chosen: Plan, frames: Frames) -> float:
    """Return for how long in s the herpolhode is drawn behind ω."""
    omega = run.angular_velocity[0] @ chosen.axes
    period = float(polhode_period(chosen.moments, omega)) if omega.any() else np.inf
    return min(period, _TRAIL * frames.play.speed, float(run.time[-1]))


def _write_world(
    recording: Recording, run: Run, chosen: Plan, body: Display, frames: Frames, origin: Float | None
) -> Iterator[str]:
    import rerun as rr

    size = body.radius
    recording.static(paths.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    recording.static(paths.MESH, *body.archetypes())
    axes = _AXES * size * ascending(chosen)[1].T
    recording.static(
        paths.BODY_AXES,
        rr.Arrows3D(vectors=axes, colors=COLORS[:3], labels=["1", "2", "3"], radii=[_THICK * size] * 3),
    )
    frames.write_attitude(recording)
    if origin is not None:
        frames.write_position(recording, body.unit, origin)
        yield "the view goes with the centre of mass, along the grey path"
    elif frames.position is not None:
        yield "the body travels far: it is shown without its path, from its centre of mass"
    omega = _OMEGA * size * frames.angular_velocity / largest(frames.angular_velocity)
    momentum = _MOMENTUM * size * frames.angular_momentum / largest(frames.angular_momentum)
    thick = _THICK * size
    write_arrow(recording, paths.ANGULAR_VELOCITY, frames.time, omega, "ω", OMEGA, 1.5 * thick)
    write_arrow(recording, paths.ANGULAR_MOMENTUM, frames.time, momentum, "L", MOMENTUM, 1.5 * thick)
    if frames.play.smooth:
        write_trail(recording, paths.HERPOLHODE, frames.time, omega, TRAIL, 0.6 * thick)
        yield "the orange trail of ω is the herpolhode"
    yield (
        f"the arrow of ω (yellow) is {largest(frames.angular_velocity):.4g} rad/s where it is longest, that of L "
        f"(blue) {largest(frames.angular_momentum):.4g} kg m²/s"
    )
    if said := write_cones(recording, run, chosen, _OMEGA * size):
        yield said


def _flips(run: Run) -> list[float]:
    return [event.time for event in run.events if event.name == "flip"]


def _write_flips(recording: Recording, run: Run, chosen: Plan) -> None:
    """Write the sense of the spin about the intermediate axis, at the start and from each flip on."""
    import rerun as rr

    if not (flips := _flips(run)):
        return
    first = 0 if run.angular_velocity[0] @ ascending(chosen)[1][:, 1] > 0 else 1
    states = [FLIP_STATES[(first + k) % 2] for k in range(len(flips) + 1)]
    recording.static(paths.FLIPS, rr.StateConfiguration(values=FLIP_STATES, colors=[0x5ABE5AFF, 0xE65046FF]))
    time = np.array([run.time[0], *flips])
    recording.columns(paths.FLIPS, time, lambda rows: rr.StateChange.columns(state=states[rows]))
