"""Binet's construction: L along the principal axes, on the momentum sphere and the energy ellipsoid.

Everything is in units of the largest |L|, so that the sphere has radius 1 whatever the body.
"""

from __future__ import annotations

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.polhode import covered, polhode, polhode_family, separatrix
from inertia.dynamics.kinematics.stability import separatrix_distance
from inertia.dynamics.plots.subject import numbered
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.drawing import (
    COLORS,
    MOMENTUM,
    TRAIL,
    Color,
    thinned,
    write_arrow,
    write_axes,
    write_ellipsoid,
    write_lines,
    write_trail,
)
from inertia.recording.playback import Frames, largest, longest_as
from inertia.recording.writer import Recording

SPHERE, ELLIPSOID = MOMENTUM, COLORS[0]
POLHODE, SEPARATRIX, CURRENT = TRAIL, palette.rgb(palette.PINK), (255, 255, 255)
FAMILY = (120, 135, 155)
PATH = (170, 150, 70)

_EQUAL = 1e-9  # relative difference up to which moments are the same
_LINE, _SAMPLES = 0.006, 721
_WOUND, _TURNS = 80.0, 12.0  # of a path on the sphere: a longer one would hide it; that of a trail
_LONGEST = 2.0  # semi-axis beyond which an ellipsoid would hide what is inside it


def write_momentum_space(recording: Recording, run: Run, frames: Frames) -> str:
    """Write the body view of a body that no torque turns, and return what is to be seen."""
    moments, axes = numbered(run.plan)
    along = quaternion.to_body(frames.attitude, frames.angular_momentum) @ axes
    unit = largest(along)
    along = along / unit
    energy = float((along[0] ** 2 / moments).sum())  # 2 T / |L|², 1/(kg m²)
    write_axes(recording, entities.PRINCIPAL_AXES, 1.25 * np.eye(3), _LINE)
    _write_surface(recording, entities.MOMENTUM_SPHERE, np.ones(3), SPHERE)
    _write_surface(recording, entities.ENERGY_ELLIPSOID, np.sqrt(energy * moments), ELLIPSOID)
    write_arrow(recording, entities.CURRENT, frames.time, along, "L", CURRENT, 2 * _LINE)
    if np.ptp(moments) == 0:
        return "every axis is a principal one: sphere and ellipsoid are one, and L stands still in the body"
    omega = run.angular_velocity[0] @ axes
    curves = polhode(moments, omega, _SAMPLES).branches
    if not separatrix_distance(moments, omega):  # on which the body does not come to the other arcs
        curves = covered(moments, omega, _SAMPLES)[None]
    write_lines(recording, entities.POLHODE, list(moments * curves / unit), POLHODE, 1.5 * _LINE)
    note = "L moves along the polhode (yellow), where the momentum sphere (blue) meets the energy ellipsoid (red)"
    if not _all_differ(moments):
        return note
    _write_family(recording, moments)
    low, high = np.argmin(moments) + 1, np.argmax(moments) + 1
    return (
        f"{note}; the separatrix (pink) parts polhodes about axis {low} (smallest moment) from those about axis {high} "
        "(largest), some of which are grey"
    )


def _all_differ(moments: Float) -> bool:
    return bool(np.diff(np.sort(moments)).min() > _EQUAL * moments.max())


def _write_family(recording: Recording, moments: Float) -> None:
    """Write polhodes that the body could have with the same L, and the separatrix between them."""
    write_lines(recording, entities.POLHODE_FAMILY, polhode_family(moments, _SAMPLES), FAMILY, 0.4 * _LINE)
    curves = moments * separatrix(moments, 1.0, _SAMPLES)
    write_lines(recording, entities.SEPARATRIX, list(curves), SEPARATRIX, 0.7 * _LINE)


def write_moving_momentum_space(recording: Recording, run: Run, frames: Frames) -> str:
    """Write L along the principal axes of a body that is driven, with the sphere and the ellipsoid as they change."""
    moments, axes = numbered(run.plan)
    along = longest_as(1.0, quaternion.to_body(frames.attitude, frames.angular_momentum) @ axes)
    if not along.any():
        write_axes(recording, entities.PRINCIPAL_AXES, 1.25 * np.eye(3), _LINE)
        return "L is zero at all times, so that the body view has neither momentum sphere nor energy ellipsoid"
    radius = np.linalg.norm(along, axis=1)
    twice = np.divide(along**2, moments, out=np.zeros_like(along), where=moments > 0).sum(axis=1)
    semi_axes = np.sqrt(twice[:, None] * moments)
    write_axes(recording, entities.PRINCIPAL_AXES, 1.25 * np.eye(3), _LINE)
    spheres = np.repeat(radius[:, None], 3, axis=1)
    write_ellipsoid(recording, entities.MOMENTUM_SPHERE, frames.time, spheres, SPHERE, 0.3 * _LINE)
    hiding = semi_axes.max(axis=1) > _LONGEST * radius
    semi_axes[hiding] = 0.0
    write_ellipsoid(recording, entities.ENERGY_ELLIPSOID, frames.time, semi_axes, ELLIPSOID, 0.3 * _LINE)
    write_arrow(recording, entities.CURRENT, frames.time, along, "L", CURRENT, 2.0 * _LINE)
    near = along[frames.near]
    if frames.play.near:
        write_trail(recording, entities.TRAIL_OF_MOMENTUM, frames.time[frames.near], near, TRAIL, 1.5 * _LINE)
        if _length(near) <= _WOUND:
            write_lines(recording, entities.PATH_OF_MOMENTUM, [thinned(near)], PATH, 0.5 * _LINE)
    beside = ""
    if np.ptp(radius) <= _EQUAL and _all_differ(moments):
        _write_family(recording, moments)
        beside = "; L goes from one polhode (grey) to the next, across the separatrix (pink)"
    left_out = f"; it is left out while it is over {_LONGEST:g} times as long as the sphere" if hiding.any() else ""
    return (
        "in the body view L (its path is yellow) is where the momentum sphere (blue) meets the energy ellipsoid "
        f"(red), both as they are at the instant{left_out}{beside}"
    )


def trail_of_momentum(frames: Frames, longest: float) -> float:
    """Return for how long in s L along body axes is drawn behind itself: for one turn or two, at most `longest`."""
    along = longest_as(1.0, quaternion.to_body(frames.attitude, frames.angular_momentum)[frames.near])
    steps = np.linalg.norm(np.diff(along, axis=0), axis=1)
    fastest = float((steps / np.diff(frames.time[frames.near])).max(initial=0.0))
    return min(longest, _TURNS / fastest) if fastest else longest


def _length(points: Float) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _write_surface(recording: Recording, path: str, semi_axes: Float, color: Color) -> None:
    """Write an ellipsoid of semi-axes (3,)."""
    import rerun as rr

    fill = rr.components.FillMode
    hiding = semi_axes.max() > _LONGEST
    recording.static(
        path,
        rr.Ellipsoids3D(
            half_sizes=semi_axes[None, :].astype(np.float32),
            colors=[color],
            line_radii=[0.3 * _LINE],
            fill_mode=fill.MajorWireframe if hiding else fill.TransparentFillMajorWireframe,
        ),
    )
