"""`simulate`: plan a scene, run the model that it needs, and hand back the motion in part axes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.arguments import rounded_up
from inertia.dynamics.computing_time import limited
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Problem
from inertia.dynamics.motion import Motion
from inertia.dynamics.observer import Observer, Take, observed
from inertia.dynamics.plan import Plan, plan
from inertia.dynamics.run import Run, RunError, invariants_of
from inertia.dynamics.scene.document import Scene
from inertia.errors import FieldPath, GeometryError, UsageError, placed, require_kind

ROUNDING = 1e-14
"""Relative drift that evaluating an invariant alone may show."""

LOST = 0.1
"""The error in rad from which on an attitude is lost: no accuracy is advised."""


def simulate(scene: Scene, *, observer: Take | None = None) -> Run:
    """Follow a scene, by the smallest model that reaches the accuracy it asks for.

    Parameters
    ----------
    scene : what moves, and how long it is followed
    observer : takes samples as they are computed: instants (k,) s, attitudes (k, 4) and angular velocities (k, 3)
        rad/s, of the part axes; each later than those before, and before anything is known of their accuracy

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
    with limited(scene.run.time_limit):
        run = _in_time(scene, None if observer is None else Observer(observer))
    _require_accuracy(run)
    return run


def _in_time(scene: Scene, observer: Observer | None) -> Run:
    try:
        return _run(plan(scene), observer)
    except MemoryError:
        raise GeometryError(
            f"{scene.run.samples} samples need more memory than there is: ask for fewer ",
            FieldPath("run.samples"),
            places=(scene.name,),
        ) from None


def _run(plan: Plan, observer: Observer | None) -> Run:
    """Solve what is planned."""
    time = np.linspace(0.0, plan.problem.duration, plan.problem.scene.run.samples)
    with observed(observer):
        motion = _solved(plan, time)
    run = replace(_in_part_axes(plan, time, motion), follow=partial(_again, plan, (time, motion)))
    if observer is not None:  # of a closed form, all of it
        observer(time, run.attitude, run.angular_velocity)
    return run


def _solved(plan: Plan, time: Float) -> Motion:
    try:
        return plan.candidate.model.solve(plan.candidate, time, plan.method)
    except (UsageError, GeometryError) as error:
        raise error if error.places else placed(error, plan.problem.scene.name) from None


def _again(plan: Plan, known: tuple[Float, Motion], time: Float) -> Run:
    """Solve it again at other instants (n,), under the same limits, from what is known at samples if that is enough."""
    with limited(plan.problem.scene.run.time_limit):
        motion = plan.candidate.model.resolved(plan.candidate, time, known) or _solved(plan, time)
        run = replace(_in_part_axes(plan, time, motion), follow=partial(_again, plan, known))
    _require_accuracy(run)
    return run


def _in_part_axes(plan: Plan, time: Float, motion: Motion) -> Run:
    candidate, scene = plan.candidate, plan.problem.scene
    turned = quaternion.conjugate(quaternion.from_matrix(candidate.axes))
    attitude = quaternion.continuous(quaternion.multiply(motion.attitude, turned))
    momentum = candidate.model.angular_momentum(candidate, motion)
    energy = motion.invariants.get("energy")
    inputs = candidate.input_bound
    error = RunError(
        scene.run.accuracy,
        motion.reached + candidate.unseen,
        motion.method,
        min(float(inputs.angle[-1]), np.pi),
        inputs.until(scene.run.accuracy),
    )
    return Run(
        plan=plan,
        time=time,
        attitude=attitude,
        angular_velocity=motion.angular_velocity @ candidate.axes.T,
        angular_momentum=momentum,
        energy=np.asarray(candidate.model.energy(candidate, motion) if energy is None else energy),
        position=_position(plan.problem, time, attitude, motion),
        error=error,
        invariants=invariants_of(motion, momentum),
        remarks=motion.remarks,
        events=motion.events,
        warnings=(*_uncertainty(plan.problem, error), *scene.notes, *motion.warnings),
        quantities=dict(motion.quantities),
        steps=motion.steps,
    )


def _position(problem: Problem, time: Float, attitude: Float, motion: Motion) -> Float | None:
    """Return where the centre of mass is, (n, 3) m; None where it stays at the origin."""
    scene = problem.scene
    start = scene.start.position
    origin = np.zeros(3) if start is None else start
    if motion.position is not None:
        return motion.position + origin
    if scene.constraint.holds:
        arm = scene.body.center_of_mass - problem.reference
        return origin + quaternion.to_space(attitude, arm) if arm.any() or start is not None else None
    if scene.orbit is not None:
        return scene.orbit.ellipse.position(time)
    velocity = scene.start.velocity
    if start is None and velocity is None and not scene.gravity.any():
        return None
    t = time[:, None]
    return origin + t * (0.0 if velocity is None else velocity) + 0.5 * t * t * scene.gravity


def _uncertainty(problem: Problem, error: RunError) -> list[str]:
    """Say so where the mass properties are not known well enough for the accuracy that is asked for."""
    if error.until >= problem.duration:
        return []
    by = "a whole turn" if error.inputs >= np.pi else f"{error.inputs:.2g} rad"
    bounds = {
        "the tensor to {:.1g} of its smallest moment": problem.relative_tensor_bound,
        "mass times arm to {:.1g}": problem.relative_weight_bound,
    }
    known = " and ".join(words.format(bound) for words, bound in bounds.items() if bound)
    return [
        f"the mass properties are known within bounds ({known}), which by the end may move the attitude by {by}: the "
        f"accuracy holds up to {error.until:.3g} s, and from there on nothing is claimed"
    ]


def _require_accuracy(run: Run) -> None:
    scene, error = run.scene, run.error
    if not error.reached <= max(error.requested, LOST):
        raise GeometryError(
            f"the attitude is lost over {scene.run.duration:g} s ({error.method}), and no ",
            FieldPath("run.accuracy"),
            " is advised: ask for a shorter ",
            FieldPath("run.duration"),
            places=(scene.name,),
        )
    if not error.reached <= error.requested:
        raise GeometryError(
            FieldPath("run.accuracy"),
            f" asks for {error.requested:g} rad, but the model ({error.method}) reaches "
            f"{rounded_up(error.reached)} rad over "
            f"{scene.run.duration:g} s: ask for that, or for a shorter ",
            FieldPath("run.duration"),
            places=(scene.name,),
            code="accuracy",
        )
    limit = max(error.requested, ROUNDING)
    for name, invariant in run.invariants.items():
        if np.isnan(invariant.largest_relative_drift):
            raise GeometryError(f"{name} leaves float64: check the units of the scene", places=(scene.name,))
        if not invariant.largest_relative_drift <= limit:
            raise _strayed(run, name, invariant.largest_relative_drift, limit)


def _strayed(run: Run, name: str, drift: float, limit: float) -> GeometryError:
    """Return what is wrong with a run whose invariant drifts by more than the limit, both relative."""
    advice = (f"{rounded_up(drift)} or more, or ",) if drift < LOST else ()
    return GeometryError(
        f"{name} must be kept, but its relative drift is {drift:.2g} where ",
        FieldPath("run.accuracy"),
        f" allows {limit:g}: the run is not to be trusted to that, ask for ",
        *advice,
        "a shorter ",
        FieldPath("run.duration"),
        places=(run.scene.name,),
    )
