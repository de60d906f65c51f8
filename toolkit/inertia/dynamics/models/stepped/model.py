"""The model that serves any rigid body under any loads: Euler's equations and the attitude, integrated by steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.models.neighbours import InputBound, growth, instants_of, nudge_of
from inertia.dynamics.motion import Motion
from inertia.dynamics.observer import Observer, observing
from inertia.errors import FieldPath, GeometryError, UsageError, placed

if TYPE_CHECKING:
    from inertia.dynamics.integrators.rotation import RotationProblem

_MARGIN = 3.0  # of what the growth of a change of the start says about other mass properties
_NEIGHBOURS = 1e-13  # the tolerance with which neighbouring motions are stepped
_ROUNDED = 4 * 2.0**-52  # of attitude and ω, relative, on their way to the axes that are stepped
_NUDGE = 1e-9  # of the start, which shows how far that counts


class EulerEquations(Model):
    """A rigid body about its centre of mass or a fixed point."""

    name = "Euler equations"

    @property
    def methods(self) -> Mapping[str, int]:
        """The stepping methods."""
        from inertia.dynamics.integrators import methods

        return {name: method.order for name, method in methods.METHODS.items()}

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return the model of every rigid body that does not roll; it leaves nothing out."""
        if not problem.rigid:
            return None
        nouns = dict.fromkeys(load.noun for load in problem.torques)
        integrated = "attitude and angular velocity are integrated."
        if nouns:
            why = f"There is no closed form for {' and '.join(nouns)}: {integrated}"
        elif problem.weight:
            body = "a heavy body that is not symmetric about its centre of mass"
            why = f"There is no closed form for {body}: {integrated}"
        else:
            why = f"Euler's equations serve any body: {integrated}"
        return Candidate(self, problem, problem.axes, problem.moments, 0.0, why)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return what stepping gives, by the method asked for, or the one that the loads need."""
        from inertia.dynamics.models.stepped.solve import solve_stepped

        scene, rotation = candidate.problem.scene, self.rotation(candidate)
        noise = self._noise(candidate, rotation)
        rotation = replace(rotation, observer=_along_parts(candidate))
        try:
            motion = solve_stepped(rotation, time, scene.run.accuracy, method, noise=noise)
        except (UsageError, GeometryError) as error:
            raise placed(error, scene.name, *(() if error.places else (FieldPath("run"),))) from None
        return self._with_orbit(candidate, rotation, time, motion)

    def _noise(self, candidate: Candidate, rotation: RotationProblem) -> float:
        """Return the angle in rad that what float64 leaves out of start and moments may come to, where it may grow."""
        problem = candidate.problem
        falls = bool(problem.weight) and rotation.terms(rotation.start) is not None
        # Held far off, a body has moments about the point of which the rounding is much to the smallest.
        lost = float(np.abs(candidate.rest[0]).max()) / problem.least
        if not falls and lost <= _ROUNDED:
            return 0.0
        grown = float(_growth(problem, rotation, _NUDGE)[-1])
        noise = _ROUNDED * grown if falls else 0.0
        if lost > _ROUNDED:
            noise += _MARGIN * lost * max(grown, problem.pace * problem.duration)
        return min(noise, np.pi)

    def resolved(self, candidate: Candidate, time: Float, known: tuple[Float, Motion]) -> Motion | None:
        """Return the motion at other instants, stepped from the samples before them."""
        from inertia.dynamics.integrators.loop import States
        from inertia.dynamics.models.stepped.solve import motion_of, restarted

        samples, motion = known
        rotation, accuracy = self.rotation(candidate), candidate.problem.scene.run.accuracy
        states = States(motion.attitude, motion.angular_velocity, motion.steps)
        answer = restarted(rotation, time, accuracy, motion.method, (samples, states), motion.reached)
        if answer is None:
            return None
        return self._with_orbit(candidate, rotation, time, motion_of(rotation, time, motion.method, *answer))

    def _with_orbit(self, candidate: Candidate, rotation: RotationProblem, time: Float, motion: Motion) -> Motion:
        scene = candidate.problem.scene
        if scene.orbit is None:
            return motion
        attitude = quaternion.multiply(motion.attitude, quaternion.conjugate(quaternion.from_matrix(candidate.axes)))
        periods, remarks = scene.orbit.librations(rotation.attitude, rotation.angular_velocity, rotation)
        quantities = scene.orbit.ellipse.seen_from(time, attitude) | periods
        return replace(motion, quantities=quantities, remarks=(*motion.remarks, *remarks))

    def rotation(self, candidate: Candidate) -> RotationProblem:
        """Return the body with its start and its loads, along the candidate's axes, as methods step it."""
        from inertia.dynamics.integrators.rotation import RotationProblem

        problem, body = candidate.problem, candidate.problem.scene.body
        return RotationProblem(
            candidate.moments,
            problem.angular_velocity,
            candidate.attitude,
            tuple(_named(load, problem).along(candidate.axes, body.axes) for load in problem.acting),
            mass=body.mass or 0.0,
            arm=problem.arm,
            numbers=candidate.numbers,
        )

    def input_bound(self, candidate: Candidate) -> InputBound:
        """Return how far the bounds of the mass properties may move the attitude: as a change of the start does."""
        problem = candidate.problem
        unknown = _MARGIN * problem.relative_bound
        if not unknown:
            return InputBound.none(problem.duration)
        grown = _growth(problem, self.rotation(candidate), nudge_of(unknown, problem.scene.run.accuracy))
        instants = instants_of(problem.duration)
        return InputBound(instants, unknown * np.maximum(grown, problem.pace * instants))

    def view(self, problem: Problem) -> str:
        """Show what becomes of L and the energy where a torque acts."""
        return "driven" if problem.torques else super().view(problem)


def _along_parts(candidate: Candidate) -> Observer | None:
    """Return what hands on samples that are along the candidate's axes, where somebody observes the run."""
    observer = observing()
    if observer is None:
        return None
    turn = quaternion.conjugate(quaternion.from_matrix(candidate.axes))

    def take(time: Float, attitude: Float, angular_velocity: Float) -> None:
        observer(time, quaternion.multiply(attitude, turn), angular_velocity @ candidate.axes.T)

    return Observer(take)


def _growth(problem: Problem, rotation: RotationProblem, nudge: float) -> Float:
    """Return (n,) how far the attitude moves for a change of the start of one, at `instants_of` the duration."""
    from inertia.dynamics.integrators import methods

    integrator = methods.METHODS["DOP853" if rotation.terms(rotation.start) is None else "Taylor"]
    instants = instants_of(problem.duration)

    def follow(attitude: Float, angular_velocity: Float) -> tuple[Float, Float]:
        there = replace(rotation, attitude=attitude, angular_velocity=angular_velocity)
        states = integrator.run(there, instants, _NEIGHBOURS)
        return states.attitude, states.angular_velocity

    pace = max(problem.pace, 1.0 / problem.duration)
    return growth(follow, rotation.attitude, rotation.angular_velocity, pace, nudge)


def _named(load: Load, problem: Problem) -> Load:
    """Return a load whose function, if it has one, is named by its field where it gives what is no torque."""
    if not isinstance(load, Torque) or not callable(load.torque):
        return load
    path = FieldPath(f"load[{problem.scene.applied_loads.index(load)}].torque")

    def function(time: float, attitude: Float, angular_velocity: Float) -> Float:
        try:
            return load.of_function(time, attitude, angular_velocity)
        except UsageError as error:
            raise placed(error, path) from None

    return replace(load, torque=function)
