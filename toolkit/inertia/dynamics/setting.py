"""What a scene comes to: the point that the body turns about, its moments there, its spin, and what pulls at it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.loads import Gravity
from inertia.mass.principal import Principal, principal


@dataclass(frozen=True, eq=False)
class Setting:
    """A scene as the models see it.

    Attributes
    ----------
    reference : (3,) m, part axes: the centre of mass, or the fixed point
    axes : (3, 3), columns in part axes: the principal axes about the reference point
    moments : (3,) kg m², about them, ascending
    uncertainty : relative, the largest bound on a moment: what the mass properties are known to
    angular_velocity : (3,) rad/s at t = 0, along those axes
    arm : (3,) m, along them, from the reference point to the centre of mass
    weight : N, mass times gravity; 0 where it has no arm to turn the body with
    gravity : (3,) m/s², space axes
    symmetry : (3,) along them, the axis that the scene names as that of a body of revolution; None where it names none
    duration : s
    why : what of this needs saying, in sentences
    """

    reference: Float
    axes: Float
    moments: Float
    uncertainty: float
    angular_velocity: Float
    arm: Float
    weight: float
    gravity: Float
    symmetry: Float | None
    duration: float
    why: tuple[str, ...]


def setting_of(scene: Scene) -> Setting:
    """Take the moments about the point that the scene turns about, and the spin along the principal axes there."""
    body, held = scene.body.body, scene.constraint.kind == "fixed_point"
    reference = scene.constraint.fixed_point if held else body.center_of_mass
    arm = body.center_of_mass - reference
    about = _principal_about(scene, reference if arm.any() else None)
    weight = float(np.linalg.norm(scene.gravity)) * (body.mass or 0.0) if arm.any() else 0.0
    return Setting(
        reference=reference,
        axes=about.axes,
        moments=about.moments,
        uncertainty=float((about.moment_bounds / about.moments).max()),
        angular_velocity=about.axes.T @ scene.angular_velocity,
        arm=about.axes.T @ arm,
        weight=weight,
        gravity=scene.gravity,
        symmetry=None if (axis := scene.constraint.axis) is None else about.axes.T @ axis,
        duration=scene.run.duration,
        why=tuple(_reasons(scene, reference, arm)),
    )


def _principal_about(scene: Scene, point: Float | None) -> Principal:
    """Diagonalise the tensor with no tolerance: nearly equal moments keep the axes that they have."""
    if point is None:
        return scene.body.principal_within(0.0)
    return principal(scene.body.about(point), 0.0)


def _reasons(scene: Scene, reference: Float, arm: Float) -> list[str]:
    rigid = scene.body.assembly is not None and not scene.body.deforms
    return [*(["No joint moves: the parts make one rigid body."] if rigid else []), *_motion(scene, reference, arm)]


def _motion(scene: Scene, reference: Float, arm: Float) -> list[str]:
    kind = scene.constraint.kind
    pulled = any(isinstance(load, Gravity) for load in scene.applied_loads)
    if kind == "rolling":
        return ["The body rolls without slipping: its velocity follows from its rotation, and the plane pushes back."]
    if kind == "fixed_point":
        where = ", ".join(f"{x + 0.0:.6g}" for x in reference)
        if not arm.any():
            return ["The body is held at its centre of mass, where gravity has no arm: it turns as a free body does."]
        return [f"The body is held at ({where}) m of the part axes, and its moments are taken there (Steiner)."]
    if pulled:
        return ["Gravity pulls at the centre of mass: it makes the path a parabola and leaves the rotation free."]
    if not scene.applied_loads:
        return ["The body is free and no torque acts: it turns about its centre of mass, whose path is straight."]
    return []
