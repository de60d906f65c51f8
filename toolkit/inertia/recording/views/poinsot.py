"""Poinsot's construction: the inertia ellipsoid rolls on the invariable plane, and the tip of ω is where they touch.

The ellipsoid ω·Iω = 2T turns with the body; the plane stands still across L, at 2T/|L| from the centre.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.polhode import covered
from inertia.dynamics.plots.subject import numbered
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.drawing import COLORS, TRAIL, basis, circle, write_lines, write_point
from inertia.recording.playback import Frames
from inertia.recording.screen import camera, space_view
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

ELLIPSOID, PLANE, GRID, CONTACT = COLORS[0], (86, 180, 233, 40), (70, 90, 110), (255, 255, 255)

_SAMPLES = 721
_LINES = 8  # of the plane's grid, either way
_FROM = np.array([0.62, -0.66, 0.32])


def rolls(run: Run) -> bool:
    """Say whether there is an ellipsoid that rolls: of a body whose moments are not all equal."""
    return bool(np.ptp(run.plan.moments) > 0 and run.angular_velocity[0].any())


def poinsot_view(run: Run, scale: float, overrides: Mapping[str, Any]) -> rrb.Spatial3DView:
    """Look at the ellipsoid from beside, turned so that the plane lies below; `scale` as in `write_poinsot`."""
    semi_axes, height, reach, down = _sizes(run, scale)
    up = -down
    offset = basis(up) @ _FROM / np.linalg.norm(_FROM)
    size = max(float(semi_axes.max()), reach)
    contents = [
        f"/{path}/**" for path in (entities.INERTIA_ELLIPSOID, entities.INVARIABLE_PLANE, entities.ANGULAR_VELOCITY)
    ]
    return space_view(
        entities.CENTER,
        contents=[*contents, f"/{entities.HERPOLHODE}"],
        name="Poinsot: the ellipsoid rolls",
        eye_controls=camera(2.2 * size * offset, 0.5 * height * down, up),
        overrides=overrides,
    )


def write_poinsot(recording: Recording, run: Run, frames: Frames, scale: float, thick: float) -> str:
    """Write ellipsoid, polhode, plane, herpolhode and point of contact, ω (rad/s) being `scale` times as long.

    Return what is to be seen.
    """
    import rerun as rr

    moments, axes = numbered(run.plan)
    semi_axes, height, reach, down = _sizes(run, scale)
    recording.static(
        entities.INERTIA_ELLIPSOID,
        rr.Ellipsoids3D(
            half_sizes=[semi_axes],
            quaternions=[rr.Quaternion(xyzw=quaternion.from_matrix(axes))],
            colors=[ELLIPSOID],
            line_radii=[0.15 * thick],
            fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
        ),
    )
    curve = scale * covered(moments, run.angular_velocity[0] @ axes, _SAMPLES) @ axes.T
    write_lines(recording, f"{entities.INERTIA_ELLIPSOID}/polhode", [curve], TRAIL, 0.5 * thick)
    plane = basis(down)
    corners = height * down + reach * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) @ plane.T
    quad = rr.Mesh3D(vertex_positions=np.float32(corners), triangle_indices=[[0, 1, 2], [0, 2, 3]], albedo_factor=PLANE)
    recording.static(entities.INVARIABLE_PLANE, quad)
    lines = []
    for place in reach * np.linspace(-1.0, 1.0, _LINES + 1):
        for ends in (
            [[place, -reach, height], [place, reach, height]],
            [[-reach, place, height], [reach, place, height]],
        ):
            lines.append(np.array(ends) @ plane.T)
    write_lines(recording, f"{entities.INVARIABLE_PLANE}/grid", lines, GRID, 0.12 * thick)
    omega = scale * frames.angular_velocity
    across = np.linalg.norm(omega - np.outer(omega @ down, down), axis=1)
    limits = [circle(float(radius), height, plane) for radius in (across.min(), across.max())]
    write_lines(recording, f"{entities.INVARIABLE_PLANE}/limits", limits, GRID, 0.4 * thick)
    write_point(recording, f"{entities.INVARIABLE_PLANE}/contact", frames.time, omega, CONTACT, 2.0 * thick)
    return (
        f"the inertia ellipsoid (red) rolls on the invariable plane, {height / scale:.4g} rad/s from the centre: it "
        "touches it at the tip of ω, which draws the polhode on it and the herpolhode on the plane (yellow)"
    )


def _sizes(run: Run, scale: float) -> tuple[Float, float, float, Float]:
    """Return the semi-axes (3,) of the ellipsoid, how far away the plane is and how far it reaches, and its direction
    (3,): that of L."""
    moments, axes = numbered(run.plan)
    omega = run.angular_velocity[0] @ axes
    double, momentum = float((moments * omega**2).sum()), float(np.linalg.norm(moments * omega))
    semi_axes = scale * np.sqrt(double / moments)
    height = scale * double / momentum
    rotating = scale * np.linalg.norm(run.angular_velocity, axis=1).max()
    across = float(np.sqrt(max(rotating**2 - height**2, 0.0)))
    down = run.angular_momentum[0] / np.linalg.norm(run.angular_momentum[0])
    return semi_axes, height, max(1.25 * across, 0.6 * float(semi_axes.max())), down
