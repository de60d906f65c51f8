"""`simulate`: plan a scene, run the model that it needs, and hand back the motion in part axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.dispatch import solve
from inertia.dynamics.motion import Motion
from inertia.dynamics.plan import DEFORMING, Plan, plan
from inertia.dynamics.run import Run, RunError, invariants_of
from inertia.dynamics.scene.document import Scene
from inertia.errors import FieldPath, GeometryError, require_kind

ROUNDING = 1e-14
"""Relative drift that evaluating an invariant alone may show."""


def simulate(scene: Scene) -> Run:
    """Follow a scene, by the smallest model that reaches the accuracy it asks for.

    Raises
    ------
    UsageError : a field of the scene is not usable; the message names it
    GeometryError : the accuracy asked for is not reached, or an invariant drifts by more than it

    >>> run = simulate(Scene.from_dict({"body": {"principal_moments": [2, 2, 2]},
    ...                                 "start": {"angular_velocity": [0, 0, 3]},
    ...                                 "run": {"duration": 1, "samples": 2}}))
    >>> run.model, run.angular_velocity[-1].tolist()
    ('spherical top', [0.0, 0.0, 3.0])
    """
    require_kind(scene, Scene, "scene", "inertia.Scene.load(path)")
    chosen = plan(scene)
    time = np.linspace(0.0, scene.run.duration, scene.run.samples)
    motion, remarks = solve(scene, chosen, time)
    run = replace(_in_part_axes(scene, chosen, time, motion), remarks=remarks)
    _require_accuracy(run)
    return run


def _in_part_axes(scene: Scene, chosen: Plan, time: Float, motion: Motion) -> Run:
    turned = quaternion.conjugate(quaternion.from_matrix(chosen.axes))
    attitude = _continuous(quaternion.multiply(motion.attitude, turned))
    if chosen.model == DEFORMING:
        momentum, energy = motion.invariants["angular momentum"], motion.quantities["kinetic energy"]
    else:
        momentum = quaternion.to_space(motion.attitude, chosen.moments * motion.angular_velocity)
        energy = 0.5 * (chosen.moments * motion.angular_velocity**2).sum(axis=1)
    warnings = [*_uncertainty(scene, chosen), *scene.body.notes, *motion.warnings]
    return Run(
        scene=scene,
        model=chosen.model,
        why=chosen.why,
        time=time,
        attitude=attitude,
        angular_velocity=motion.angular_velocity @ chosen.axes.T,
        angular_momentum=momentum,
        energy=np.asarray(motion.invariants.get("energy", energy)),
        position=_position(scene, chosen, time, attitude, motion),
        error=RunError(scene.run.accuracy, motion.reached + chosen.candidate.unseen, motion.method),
        invariants=invariants_of(motion, momentum),
        events=motion.events,
        warnings=tuple(warnings),
        quantities=dict(motion.quantities),
        steps=motion.steps,
    )


def _continuous(attitude: Float) -> Float:
    """Choose the sign of each quaternion so that neighbours are near each other, for plots and interpolation."""
    turns = np.einsum("ij,ij->i", attitude[1:], attitude[:-1]) < 0
    sign = np.concatenate([[1.0], np.where(np.cumsum(turns) % 2, -1.0, 1.0)])
    continuous: Float = attitude * sign[:, None]
    return continuous


def _position(scene: Scene, chosen: Plan, time: Float, attitude: Float, motion: Motion) -> Float | None:
    """Return where the centre of mass is, (n, 3) m; None where it stays at the origin."""
    start = scene.start.position
    origin = np.zeros(3) if start is None else start
    if motion.position is not None:
        return motion.position + origin
    if scene.constraint.kind == "fixed_point":
        arm = scene.body.body.center_of_mass - chosen.setting.reference
        return origin + quaternion.to_space(attitude, arm) if arm.any() or start is not None else None
    velocity = scene.start.velocity
    if start is None and velocity is None and not scene.gravity.any():
        return None
    t = time[:, None]
    return origin + t * (0.0 if velocity is None else velocity) + 0.5 * t * t * scene.gravity


def _uncertainty(scene: Scene, chosen: Plan) -> list[str]:
    """Say so where the mass properties are not known well enough for the accuracy that is asked for."""
    setting = chosen.setting
    unsure = setting.uncertainty * float(np.linalg.norm(setting.angular_velocity)) * setting.duration
    if unsure <= scene.run.accuracy:
        return []
    return [
        f"the moments are known to {setting.uncertainty:.1g} of themselves, which leaves the attitude uncertain by "
        f"about {min(unsure, np.pi):.1g} rad at the end: the accuracy below is for the moments as they are printed"
    ]


def _require_accuracy(run: Run) -> None:
    scene, error = run.scene, run.error
    if not error.reached <= error.requested:
        raise GeometryError(
            FieldPath("run.accuracy"),
            f" asks for {error.requested:g} rad, but the model ({error.method}) reaches {error.reached:.2g} rad over "
            f"{scene.run.duration:g} s: ask for that, or for a shorter ",
            FieldPath("run.duration"),
            places=(scene.name,),
        )
    limit = max(error.requested, ROUNDING)
    for name, kept in run.invariants.items():
        if not kept.largest_relative_drift <= limit:
            raise GeometryError(
                f"{name} must be kept, but drifts by {kept.largest_relative_drift:.2g} of itself where ",
                FieldPath("run.accuracy"),
                f" allows {limit:g}: the run is not to be trusted, ask for a finer ",
                FieldPath("run.accuracy"),
                places=(scene.name,),
            )
