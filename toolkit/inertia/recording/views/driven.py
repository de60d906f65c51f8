"""A body that torques, damping or losses drive: what becomes of L, of the energy and of the attitude."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Run
from inertia.recording import paths, places
from inertia.recording.display import Display, display_of
from inertia.recording.frames import Frames, frames_of, thinned, write_arrow, write_trail
from inertia.recording.panels import Color, longest_as, write_lines, write_text
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
from inertia.recording.views.blueprint_driven import Layout, blueprint
from inertia.recording.views.tumbling import MOMENTUM, OMEGA
from inertia.recording.writer import Recording

APPLICATION = "inertia-driven"

SPHERE, ELLIPSOID = (120, 150, 200, 40), (230, 120, 80, 50)
PATH, TRAIL, CURRENT = (170, 150, 70), (255, 235, 120), (255, 255, 255)

_OMEGA, _MOMENTUM, _AXES = 1.3, 1.55, 1.15  # lengths of arrows, over the radius of the body
_THICK, _LINE = 0.012, 0.006
_TRAIL = 8.0  # seconds of playback


def driven(run: Run) -> Screen:
    """Return the recording of a body that is driven."""
    chosen = run.plan
    body, frames = display_of(run.scene.body), frames_of(run)
    layout = Layout(
        radius=body.radius * _MOMENTUM,
        duration=float(run.time[-1]),
        trail=min(_TRAIL * frames.play.speed, float(run.time[-1])),
        speed=frames.play.speed,
        drift_unit=drift_unit(run) if run.invariants else None,
        energy="energy" not in run.invariants,
    )

    def write(recording: Recording) -> None:
        said = [*frames.play.said, *body.said, f"in the inertial view 1 unit is {body.unit:g} m"]
        said += _write_world(recording, chosen, body, frames)
        said += _write_momentum_space(recording, chosen, frames)
        _write_momentum(recording, run)
        if layout.energy:
            write_energy(recording, run)
        write_angular_velocity(recording, run, ascending(chosen)[1])
        write_euler_angles(recording, run)
        if layout.drift_unit is not None:
            write_drift(recording, run)
        write_text(recording, summary(run, said))

    return Screen(APPLICATION, title(run), blueprint(layout), write)


def _write_world(recording: Recording, chosen: Plan, body: Display, frames: Frames) -> Iterator[str]:
    """Write the body about its centre of mass, ω, and L with the way that its tip has come."""
    import rerun as rr

    size, thick = body.radius, _THICK * body.radius
    recording.static(paths.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    recording.static(paths.MESH, *body.archetypes())
    axes = _AXES * size * ascending(chosen)[1].T
    recording.static(
        paths.BODY_AXES, rr.Arrows3D(vectors=axes, colors=COLORS[:3], labels=["1", "2", "3"], radii=[thick] * 3)
    )
    frames.write_attitude(recording)
    fastest, most = largest(frames.angular_velocity), largest(frames.angular_momentum)
    omega = longest_as(_OMEGA * size, frames.angular_velocity)
    momentum = longest_as(_MOMENTUM * size, frames.angular_momentum)
    write_arrow(recording, paths.ANGULAR_VELOCITY, frames.time, omega, "ω", OMEGA, 1.5 * thick)
    write_arrow(recording, paths.ANGULAR_MOMENTUM, frames.time, momentum, "L", MOMENTUM, 1.5 * thick)
    if frames.play.smooth:
        write_trail(recording, places.MOMENTUM_TRAIL, frames.time, momentum, MOMENTUM, 0.6 * thick)
    yield (f"the arrow of ω (yellow) is {fastest:.4g} rad/s where it is longest, that of L (blue) {most:.4g} kg m²/s")


def _write_momentum_space(recording: Recording, chosen: Plan, frames: Frames) -> Iterator[str]:
    """Write L along the principal axes, over its largest magnitude, with the sphere and the ellipsoid as they are."""
    import rerun as rr

    moments, axes = ascending(chosen)
    along = longest_as(1.0, quaternion.to_body(frames.attitude, frames.angular_momentum) @ axes)
    radius = np.linalg.norm(along, axis=1)
    semi_axes = np.sqrt((along**2 / moments).sum(axis=1)[:, None] * moments)
    recording.static(
        paths.PRINCIPAL_AXES,
        rr.Arrows3D(vectors=1.25 * np.eye(3), colors=COLORS[:3], labels=["1", "2", "3"], radii=[_LINE] * 3),
    )
    _write_surface(recording, paths.MOMENTUM_SPHERE, frames.time, np.repeat(radius[:, None], 3, axis=1), SPHERE)
    _write_surface(recording, paths.ENERGY_ELLIPSOID, frames.time, semi_axes, ELLIPSOID)
    write_arrow(recording, paths.CURRENT, frames.time, along, "L", CURRENT, 2.0 * _LINE)
    if frames.play.smooth:
        write_lines(recording, places.PATH_OF_MOMENTUM, [thinned(along)], PATH, 0.5 * _LINE)
        write_trail(recording, places.TRAIL_OF_MOMENTUM, frames.time, along, TRAIL, 1.5 * _LINE)
    else:
        dots = rr.Points3D(thinned(along).astype(np.float32), colors=[PATH], radii=[_LINE])
        recording.static(places.PATH_OF_MOMENTUM, dots)
    yield (
        "in the body view L moves along the yellow path, where the momentum sphere (blue) meets the energy ellipsoid "
        "(red), both as they are at the instant"
    )


def _write_surface(recording: Recording, path: str, time: Float, semi_axes: Float, color: Color) -> None:
    import rerun as rr

    look: dict[str, Any] = {
        "colors": [color],
        "line_radii": [0.3 * _LINE],
        "fill_mode": rr.components.FillMode.TransparentFillMajorWireframe,
    }
    sizes = semi_axes.astype(np.float32)
    recording.static(path, rr.Ellipsoids3D.from_fields(**look))
    recording.columns(path, time, lambda rows: rr.Ellipsoids3D.columns(half_sizes=sizes[rows]))


def _write_momentum(recording: Recording, run: Run) -> None:
    """Write L along space axes, and its magnitude, at every sample."""

    def momenta(rows: slice) -> Float:
        some = run.angular_momentum[rows]
        return np.column_stack([some, np.linalg.norm(some, axis=1)])

    names = [f"{name}, kg m²/s" for name in ("Lx", "Ly", "Lz", "|L|")]
    recording.scalars(places.PLOT_MOMENTUM, run.time, momenta, names, COLORS[:4])
