"""Loaded bodies with their true motion, for the tests of every stepper."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from tests.dynamics import oracle

from inertia.dynamics.integrators.loads import Damping, Gravity, GravityGradient, Load, Torque
from inertia.dynamics.integrators.rotation import RotationProblem

MOMENTS = 1.0, 2.0, 2.75
SPIN = 1.0, 0.5, 2.0
ATTITUDE = 0.1, -0.3, 0.5, 0.8
TIMES = np.array([0.0, 2.5, 5.0])

LOADS: dict[str, tuple[tuple[Load, ...], dict[str, object]]] = {
    "free": ((), {}),
    "heavy": (
        (Gravity(0.5, [0.1, 0.2, 0.3], [0.0, 0.0, -9.8]),),
        {"mass": 0.5, "offset": (0.1, 0.2, 0.3), "gravity": (0.0, 0.0, -9.8)},
    ),
    "driven": (
        (Torque([1.0, 0.25, 0.3], "space"), Torque([0.1, -0.2, 0.0]), Damping([0.1, 0.2, 0.0])),
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
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE, loads)
    start = problem.attitude.tolist()
    return Case(problem, oracle.rotate(MOMENTS, SPIN, TIMES, attitude=start, **keywords))
