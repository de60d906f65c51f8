"""Loaded bodies with their true motion, for the tests of every stepper."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from scipy.integrate import solve_ivp
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


def rotations(attitude: np.ndarray) -> np.ndarray:
    """Return the rotation matrices (n, 3, 3) of quaternions (n, 4) of unit length, body to space."""
    x, y, z, w = attitude.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


TorqueLaw = Callable[[float, np.ndarray, np.ndarray], np.ndarray]
"""(t, rotation matrix, ω) → torque (3,) along the body axes."""


def direction_cosines(
    torque: Callable[[float, float], TorqueLaw],
    times: np.ndarray,
    kinks: tuple[float, ...] = (),
    dissipation: float = 0.0,
) -> list[np.ndarray]:
    """Return the rotation matrices of the body above at `times`, by SciPy's DOP853 at its tightest.

    The nine direction cosines and ω are integrated, with no code of the package; it begins anew at each of `kinks`,
    with the law of torque that `torque` returns for the span between two of them.
    """
    inertia = np.array(MOMENTS)
    start = np.array(ATTITUDE)
    state = np.concatenate([rotations(start[None] / np.linalg.norm(start))[0].ravel(), SPIN])
    matrices = []
    marks = np.unique([0.0, *times, *(t for t in kinks if t < times[-1])])
    for low, high in pairwise(marks.tolist()):
        law = torque(low, high)

        def rate(t: float, y: np.ndarray, law: TorqueLaw = law) -> np.ndarray:
            turn, spin = y[:9].reshape(3, 3), y[9:]
            gyroscopic = np.cross(inertia * spin, spin)
            p, q, r = axes = spin + dissipation * gyroscopic / inertia**2
            cosines = turn @ np.array([[0.0, -r, q], [r, 0.0, -p], [-q, p, 0.0]])
            return np.concatenate([cosines.ravel(), (np.cross(inertia * spin, axes) + law(t, turn, spin)) / inertia])

        state = solve_ivp(rate, (low, high), state, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
        if high in times:
            matrices.append(state[:9].reshape(3, 3))
    return matrices if times[0] > 0.0 else [rotations(start[None] / np.linalg.norm(start))[0], *matrices]


def angles(attitude: np.ndarray, truth: list[np.ndarray]) -> np.ndarray:
    """Return the angles (n,) in rad between attitudes (n, 4) and rotation matrices."""
    off = np.linalg.norm(rotations(attitude) - np.array(truth), axis=(1, 2))
    return 2.0 * np.arcsin(off / np.sqrt(8.0))
