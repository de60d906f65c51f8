"""Loaded bodies with their true motion, for the tests of every stepper."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from tests.dynamics import oracle

from inertia.arrays import Float
from inertia.documents import numbers
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.loads.gravity import Gravity, GravityGradient
from inertia.dynamics.loads.load import Load, TurningBody
from inertia.dynamics.loads.torque import Torque

MOMENTS = 1.0, 2.0, 2.75
SPIN = 1.0, 0.5, 2.0
ATTITUDE = 0.1, -0.3, 0.5, 0.8
TIMES = np.array([0.0, 2.5, 5.0])
MASS, ARM = 0.5, (0.1, 0.2, 0.3)


@dataclass(frozen=True, eq=False)
class AxialDamping(Load):
    """Damping that differs from axis to axis: −d ∘ ω."""

    kind = "axial_damping"
    noun = "axial damping"

    coefficients: Annotated[Float, numbers((3,), "N m s")]

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return −d ∘ ω."""
        return -self.coefficients * angular_velocity

    def terms(self, body: TurningBody, start: float) -> Terms:
        """Return d."""
        return Terms(damping=self.coefficients)


LOADS: dict[str, tuple[tuple[Load, ...], dict[str, object]]] = {
    "free": ((), {}),
    "heavy": (
        (Gravity([0.0, 0.0, -9.8]),),
        {"mass": MASS, "offset": ARM, "gravity": (0.0, 0.0, -9.8)},
    ),
    "driven": (
        (Torque([1.0, 0.25, 0.3], frame="space"), Torque([0.1, -0.2, 0.0]), AxialDamping([0.1, 0.2, 0.0])),
        {"space_torque": (1.0, 0.25, 0.3), "body_torque": (0.1, -0.2, 0.0), "damping": (0.1, 0.2, 0.0)},
    ),
    "orbiting": ((GravityGradient(8.0, [1.0, 2.0, 0.5]),), {"gravity_gradient": (8.0, (1.0, 2.0, 0.5))}),
}


@dataclass(frozen=True, eq=False)
class Case:
    problem: RotationProblem
    truth: oracle.Answer


@functools.cache
def case(name: str) -> Case:
    """Return a body under a set of loads, and its motion at `TIMES`."""
    loads, keywords = LOADS[name]
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE, loads, mass=MASS, arm=ARM)
    start = problem.attitude.tolist()
    return Case(problem, oracle.rotate(MOMENTS, SPIN, TIMES, attitude=start, **keywords))
