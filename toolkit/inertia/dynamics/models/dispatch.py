"""Hand a plan to the model that it names, in the axes and units that the model wants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators import loads
from inertia.dynamics.integrators.tabulated import TableTorque
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.motion import Motion
from inertia.dynamics.plan import DEFORMING, ROLLING, STEPPED, Plan
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.loads import Damping, Dissipation, Gravity, GravityGradient, Load, Torque
from inertia.errors import FieldPath, GeometryError, UsageError, placed

_UP = (0.0, 0.0, 1.0)
_HALF_TURN = (1.0, 0.0, 0.0, 0.0)


Solved = tuple[Motion, tuple[str, ...]]
"""A motion of the plan's axes, and what there is to say of it."""


def solve(scene: Scene, plan: Plan, time: Float) -> Solved:
    """Return the motion of the plan's axes, in space, at the instants (n,), and sentences on what it is."""
    attitude = quaternion.multiply(scene.start.attitude, quaternion.from_matrix(plan.axes))
    omega = plan.axes.T @ scene.angular_velocity
    solvers = {STEPPED: _stepped, ROLLING: _rolling, DEFORMING: _deforming, "heavy symmetric top": _heavy}
    solver = solvers.get(plan.model, _free)
    return solver(scene, plan, attitude, omega, time)


def _free(scene: Scene, plan: Plan, attitude: Float, omega: Float, time: Float) -> Solved:
    from inertia.dynamics.models.characteristics import of_free_body
    from inertia.dynamics.models.free.motion import FreeModel, solve_free

    model = cast(FreeModel, plan.model)
    figures, remarks = of_free_body(model, plan.moments, omega)
    motion = solve_free(plan.moments, omega, time, model)
    return _turned(replace(motion, quantities={**motion.quantities, **figures}), attitude), remarks


def _turned(motion: Motion, turn: Float) -> Motion:
    """Return a motion as seen from space axes that the attitude (4,) takes its own space axes to."""
    kept = {name: _seen(values, turn) for name, values in motion.invariants.items()}
    return replace(motion, attitude=quaternion.multiply(turn, motion.attitude), invariants=kept)


def _seen(values: Float, turn: Float) -> Float:
    return quaternion.to_space(turn, values) if values.ndim == 2 else values


def _heavy(scene: Scene, plan: Plan, attitude: Float, omega: Float, time: Float) -> Solved:
    from inertia.dynamics.models.characteristics import of_heavy_top
    from inertia.dynamics.models.heavy.top import HeavyTop, solve_heavy_top

    level = _to_vertical(scene.gravity)
    moments = float(plan.moments[0]), float(plan.moments[2])
    mgh = plan.setting.weight * float(np.linalg.norm(plan.setting.arm))
    upright = quaternion.multiply(level, attitude)
    figures, remarks = of_heavy_top(HeavyTop.of_state(moments, mgh, upright, omega))
    motion = solve_heavy_top(moments, mgh, upright, omega, time)
    motion = replace(motion, quantities={**motion.quantities, **figures})
    return _turned(motion, quaternion.conjugate(level)), remarks


def _to_vertical(gravity: Float) -> Float:
    """Return the quaternion (4,) of a turn that brings `gravity` (3,) to −z."""
    up = -gravity / np.linalg.norm(gravity)
    if up[2] < 0:  # half a turn first, for the shortest turn from straight down is any
        return quaternion.multiply(_to_vertical(quaternion.to_space(_HALF_TURN, gravity)), _HALF_TURN)
    return quaternion.normalise(np.append(np.cross(up, _UP), 1.0 + up[2]))


def _rolling(scene: Scene, plan: Plan, attitude: Float, omega: Float, time: Float) -> Solved:
    from inertia.dynamics.models.rolling.motion import solve_rolling

    assert scene.body.body.mass is not None and scene.constraint.radius is not None  # noqa: PT018  # the scene saw to it
    motion = solve_rolling(
        scene.body.body.mass,
        (float(plan.moments[0]), float(plan.moments[2])),
        scene.constraint.radius,
        scene.constraint.offset or 0.0,
        float(np.linalg.norm(scene.gravity)),
        attitude,
        omega,
        time,
        scene.run.accuracy,
        plan.method,
    )
    return motion, ()


def _deforming(scene: Scene, plan: Plan, attitude: Float, omega: Float, time: Float) -> Solved:
    """Follow the root part; its axes are the part axes of the scene."""
    from inertia.dynamics.models.characteristics import of_deforming_body
    from inertia.dynamics.models.deforming.motion import solve_deforming

    assert scene.body.assembly is not None  # the plan saw to it
    try:
        motion = solve_deforming(
            scene.body.assembly,
            time,
            scene.run.accuracy,
            angular_velocity=scene.angular_velocity,
            attitude=scene.start.attitude,
        )
    except GeometryError as error:
        raise placed(error, scene.name) from None
    figures, remarks = of_deforming_body(motion)
    turn = quaternion.from_matrix(plan.axes)
    turned = replace(
        motion,
        attitude=quaternion.multiply(motion.attitude, turn),
        angular_velocity=motion.angular_velocity @ plan.axes,
        position=None,  # of the root; the centre of mass goes its own way
        quantities={**motion.quantities, **figures},
    )
    return turned, remarks


def _stepped(scene: Scene, plan: Plan, attitude: Float, omega: Float, time: Float) -> Solved:
    from inertia.dynamics.integrators.rotation import RotationProblem
    from inertia.dynamics.models.stepped.solve import solve_stepped

    acting = [law for law in (_law(scene, plan, load) for load in scene.applied_loads) if law is not None]
    problem = RotationProblem(plan.moments, omega, attitude, tuple(acting))
    try:
        return solve_stepped(problem, time, scene.run.accuracy, plan.method), ()
    except UsageError as error:
        raise placed(error, scene.name, FieldPath("run")) from None


def _law(scene: Scene, plan: Plan, load: Load) -> loads.Load | None:
    """Return a load along the plan's axes; None for gravity that has no arm."""
    if isinstance(load, Gravity):
        if not plan.setting.weight or not load.acceleration.any():
            return None
        assert scene.body.body.mass is not None  # the scene saw to it
        return loads.Gravity(scene.body.body.mass, plan.axes.T @ _arm(scene, plan), load.acceleration)
    if isinstance(load, Torque):
        return _torque_law(scene, plan, load)
    if isinstance(load, Damping):
        return loads.Damping(load.coefficient)
    if isinstance(load, GravityGradient):
        return loads.GravityGradient(load.mu, load.position)
    assert isinstance(load, Dissipation)
    return loads.Dissipation(load.rate)


def _arm(scene: Scene, plan: Plan) -> Float:
    return np.asarray(scene.body.body.center_of_mass - plan.setting.reference)


def _torque_law(scene: Scene, plan: Plan, load: Torque) -> loads.Load:
    frame: loads.Frame = "space" if load.frame == "space" else "body"
    resolve = _resolver(scene, plan, load)
    if load.table is not None:
        return TableTorque(load.table.times, resolve(load.table.torques), frame)
    if callable(load.torque):
        function = load.torque
        turn = quaternion.conjugate(quaternion.from_matrix(plan.axes))

        def along_axes(time: float, attitude: Float, omega: Float) -> Float:
            given = function(time, quaternion.multiply(attitude, turn), plan.axes @ omega)
            return resolve(np.asarray(given, dtype=np.float64))

        return loads.CallableTorque(along_axes, frame)
    return loads.Torque(resolve(np.asarray(load.torque)), frame)


def _resolver(scene: Scene, plan: Plan, load: Torque) -> Callable[[Float], Float]:
    """Return what takes torques (…, 3) in the load's frame to the plan's axes, or leaves them in space."""
    if load.frame == "space":
        return lambda torque: torque
    from_frame = scene.body.axes if load.frame == "principal" else np.eye(3)
    turn = plan.axes.T @ from_frame
    return lambda torque: np.asarray(torque @ turn.T)
