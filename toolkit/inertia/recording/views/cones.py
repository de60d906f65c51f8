"""The cones of a free symmetric top: the one fixed in the body rolls on the one fixed in space, along ω."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics.geometry import Cones, cones
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Run
from inertia.recording import paths
from inertia.recording.writer import Recording

BODY_COLOR = (90, 190, 90, 70)
SPACE_COLOR = (240, 190, 60, 70)
_FACETS = 72
_NARROWEST = 1e-3  # rad: a cone that could not be told from a line is not drawn


def write_cones(recording: Recording, run: Run, plan: Plan, slant: float) -> str | None:
    """Write both cones, as long as the arrow of ω; return what they show, None where there are none to see."""
    import rerun as rr

    if "body cone" not in run.quantities:
        return None
    order = _symmetry_axis_last(plan.moments)
    omega = (run.angular_velocity[0] @ plan.axes)[order]
    found = cones(plan.moments[order], omega)
    if found.body_half_angle < _NARROWEST:
        return None
    symmetry = plan.axes[:, order[2]] * np.copysign(1.0, omega[2])
    momentum = run.angular_momentum[0] / np.linalg.norm(run.angular_momentum[0])
    for path, axis, half_angle, color in (
        (paths.BODY_CONE, symmetry, float(found.body_half_angle), BODY_COLOR),
        (paths.SPACE_CONE, momentum, float(found.space_half_angle), SPACE_COLOR),
    ):
        corners = slant * cone(axis, half_angle).reshape(-1, 3)
        recording.static(path, rr.Mesh3D(vertex_positions=corners.astype(np.float32), albedo_factor=color))
    return _said(found)


def cone(axis: Float, half_angle: float) -> Float:
    """Return the triangles (k, 3, 3) of a cone of unit slant about `axis` (3,), its apex at the origin."""
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    turn = np.linspace(0.0, 2.0 * np.pi, _FACETS + 1)[:, None]
    circle = np.cos(turn) * across + np.sin(turn) * np.cross(axis, across)
    rim = np.cos(half_angle) * axis + np.sin(half_angle) * circle
    triangles: Float = np.stack([np.zeros_like(rim[1:]), rim[:-1], rim[1:]], axis=1)
    return triangles


def _symmetry_axis_last(moments: Float) -> list[int]:
    pairs = ([1, 2, 0], [2, 0, 1], [0, 1, 2])
    return min(pairs, key=lambda order: abs(moments[order[0]] - moments[order[1]]))


def _said(found: Cones) -> str:
    how = "on the outside of" if found.rolling == "outside" else "with its inside around"
    body, space = np.degrees([found.body_half_angle, found.space_half_angle])
    return (
        f"the body cone (green, half-angle {body:.4g}°) rolls {how} the space cone (yellow, {space:.4g}°): they "
        "touch along ω"
    )
