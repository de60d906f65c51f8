"""The body view: L along the principal axes, on the momentum sphere and the energy ellipsoid (Binet's construction).

Everything is in units of the largest |L|, so that the sphere has radius 1 whatever the body.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.polhode import polhode, separatrix
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Run
from inertia.recording import paths
from inertia.recording.frames import Frames, write_arrow
from inertia.recording.playback import largest
from inertia.recording.principal import ascending
from inertia.recording.series import COLORS
from inertia.recording.writer import Recording

SPHERE, ELLIPSOID = (110, 150, 220), (230, 120, 80)
POLHODE, SEPARATRIX, CURRENT = (255, 235, 120), (235, 90, 200), (255, 255, 255)
_LINE, _SAMPLES = 0.006, 721
_LONGEST = 2.0  # semi-axis beyond which an ellipsoid would hide what is inside it


def write_momentum_space(recording: Recording, run: Run, plan: Plan, frames: Frames) -> str:
    """Write the body view of a body that no torque turns, and return what is to be seen."""
    moments, axes = ascending(plan)
    along = quaternion.to_body(frames.attitude, frames.angular_momentum) @ axes
    unit = largest(along)
    along = along / unit
    energy = float((along[0] ** 2 / moments).sum())  # 2 T / |L|², 1/(kg m²)
    _write_axes(recording)
    _write_surface(recording, paths.MOMENTUM_SPHERE, np.ones(3), SPHERE)
    _write_surface(recording, paths.ENERGY_ELLIPSOID, np.sqrt(energy * moments), ELLIPSOID)
    write_arrow(recording, paths.CURRENT, frames.time, along, "L", CURRENT, 2 * _LINE)
    if np.ptp(moments) == 0:
        return "every axis is a principal one: sphere and ellipsoid are one, and L stands still in the body"
    omega = run.angular_velocity[0] @ axes
    curves = moments * polhode(moments, omega, _SAMPLES).branches / unit
    _write_lines(recording, paths.POLHODE, curves, POLHODE)
    said = "L moves along the polhode (yellow), where the momentum sphere (blue) meets the energy ellipsoid (red)"
    if len(np.unique(moments)) < 3:
        return said
    _write_lines(recording, paths.SEPARATRIX, moments * separatrix(moments, 1.0, _SAMPLES), SEPARATRIX, 0.7)
    return f"{said}; the separatrix (violet) parts polhodes about axis 1 from those about axis 3"


def _write_axes(recording: Recording) -> None:
    import rerun as rr

    arrows = rr.Arrows3D(vectors=1.25 * np.eye(3), colors=COLORS[:3], labels=["1", "2", "3"], radii=[_LINE] * 3)
    recording.static(paths.PRINCIPAL_AXES, arrows)


def _write_surface(recording: Recording, path: str, semi_axes: Float, color: tuple[int, int, int]) -> None:
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


def _write_lines(
    recording: Recording, path: str, curves: Float | list[Float], color: tuple[int, int, int], width: float = 1.5
) -> None:
    import rerun as rr

    recording.static(path, rr.LineStrips3D(list(curves), colors=[color], radii=[width * _LINE]))
