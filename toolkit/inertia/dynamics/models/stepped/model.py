"""The model that serves any rigid body under any loads: Euler's equations and the attitude, integrated by steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.motion import Motion
from inertia.dynamics.scene.loads import Damping, Dissipation, Gravity, GravityGradient, Load, Torque
from inertia.errors import FieldPath, UsageError, placed

if TYPE_CHECKING:
    from inertia.dynamics.integrators import loads


class EulerEquations(Model):
    """A rigid body about its centre of mass or a fixed point."""

    name = "Euler equations"

    @property
    def methods(self) -> Mapping[str, int]:
        """The stepping methods."""
        from inertia.dynamics.models.stepped.solve import METHODS

        return {name: method.order for name, method in METHODS.items()}

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
        from inertia.dynamics.integrators.rotation import RotationProblem
        from inertia.dynamics.models.stepped.solve import solve_stepped

        scene = candidate.problem.scene
        acting = [law for law in (_law(candidate, load) for load in scene.applied_loads) if law is not None]
        problem = RotationProblem(candidate.moments, candidate.angular_velocity, candidate.attitude, tuple(acting))
        try:
            return solve_stepped(problem, time, scene.run.accuracy, method)
        except UsageError as error:
            raise placed(error, scene.name, FieldPath("run")) from None

    def view(self, problem: Problem) -> str:
        """Show what becomes of L and the energy where a torque acts."""
        return "driven" if problem.torques else super().view(problem)


def _law(candidate: Candidate, load: Load) -> loads.Load | None:
    """Return a load along the candidate's axes; None for gravity that has no arm."""
    from inertia.dynamics.integrators import loads

    problem = candidate.problem
    if isinstance(load, Gravity):
        if not problem.weight or not load.acceleration.any():
            return None
        body = problem.scene.body.body
        assert body.mass is not None  # the scene saw to it
        arm = np.asarray(body.center_of_mass - problem.reference)
        return loads.Gravity(body.mass, candidate.axes.T @ arm, load.acceleration)
    if isinstance(load, Torque):
        return _torque_law(candidate, load)
    if isinstance(load, Damping):
        return loads.Damping(load.coefficient)
    if isinstance(load, GravityGradient):
        return loads.GravityGradient(load.mu, load.position)
    assert isinstance(load, Dissipation)
    return loads.Dissipation(load.rate)


def _torque_law(candidate: Candidate, load: Torque) -> loads.Load:
    from inertia.dynamics.integrators import loads
    from inertia.dynamics.integrators.tabulated import TableTorque

    frame: loads.Frame = "space" if load.frame == "space" else "body"
    resolve = _resolver(candidate, load)
    if load.table is not None:
        return TableTorque(load.table.times, resolve(load.table.torques), frame)
    if callable(load.torque):
        function = load.torque
        turn = quaternion.conjugate(quaternion.from_matrix(candidate.axes))

        def along_axes(time: float, attitude: Float, omega: Float) -> Float:
            torque = function(time, quaternion.multiply(attitude, turn), candidate.axes @ omega)
            return resolve(np.asarray(torque, dtype=np.float64))

        return loads.CallableTorque(along_axes, frame)
    return loads.Torque(resolve(np.asarray(load.torque)), frame)


def _resolver(candidate: Candidate, load: Torque) -> Callable[[Float], Float]:
    """Return what takes torques (…, 3) in the load's frame to the candidate's axes, or leaves them in space."""
    if load.frame == "space":
        return lambda torque: torque
    from_frame = candidate.problem.scene.body.axes if load.frame == "principal" else np.eye(3)
    turn = candidate.axes.T @ from_frame
    return lambda torque: np.asarray(torque @ turn.T)
