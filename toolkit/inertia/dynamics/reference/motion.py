"""The true motion of a run, to some thirty digits, and how far from it attitudes are."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Candidate
from inertia.dynamics.reference.collocation import Equations, solved
from inertia.dynamics.reference.contact import hinged_equations, rolling_equations, sliding_equations
from inertia.dynamics.reference.jointed import jointed_equations
from inertia.dynamics.reference.long import Long, root
from inertia.dynamics.reference.rigid import rigid_equations
from inertia.errors import GeometryError, UsageError

_RUNS = (20, 1e-9), (16, 1e-10)
"""Nodes in a step, and the tolerance that decides its length, of two runs."""

_ROUNDED = 1e-30
_MARGIN = 4.0


NAME = "Gauss collocation, in double-double"
"""What such a motion is followed by, in words."""


class Reference(NamedTuple):
    """Attitudes (n, 4) as sums of two float64 each, in rad how far they may be off, and how many steps led to them."""

    high: Float
    low: Float
    error: float
    steps: int = 0

    def apart(self, attitude: Float) -> Float:
        """Return the angles (n,) in rad to attitudes (n, 4), to many digits however small they are.

        >>> identity = np.array([[0.0, 0.0, 0.0, 1.0]])
        >>> Reference(identity, np.array([[1e-20, 0.0, 0.0, 0.0]]), 0.0).apart(identity).tolist()
        [2e-20]
        """
        sign = np.where((attitude * self.high).sum(axis=1) < 0, -1.0, 1.0)[:, None]
        off = (sign * attitude - self.high) - self.low
        off = off - (off * self.high).sum(axis=1)[:, None] * self.high  # what is along it is no turn
        near = 2.0 * np.linalg.norm(off, axis=1)
        return np.where(near < 1e-4, near, quaternion.angle_between(attitude, self.high))


def reference(candidate: Candidate, time: Float, affords: Callable[[float], bool]) -> Reference | None:
    """Follow a scene's body in double-double at the instants (n,) s, ascending from 0.

    All figures count as the exact numbers that the scene has. The error is four times how far two runs with other
    orders and other steps are apart.

    Parameters
    ----------
    candidate : a model of the scene, which says about which axis a body of revolution rolls
    affords : says of the share that is done whether to go on

    Returns
    -------
    None where a load is not known here, where the motion takes too long, or does not settle in so many digits.
    """
    equations = _equations(candidate)
    if equations is None:
        return None
    runs: list[tuple[Float, Float, int]] = []
    for count, tolerance in _RUNS:
        ahead = len(runs) / len(_RUNS)

        def going(done: float, ahead: float = ahead) -> bool:
            return affords(ahead + done / len(_RUNS))

        try:
            with np.errstate(all="ignore"):
                answer = solved(equations, time, count, tolerance, going)
                if answer is None:
                    return None
                runs.append((*_unit(equations, answer[0], time), answer[1]))
        except (GeometryError, UsageError, ArithmeticError):
            return None
    (high, low, steps), (other, rest, _) = runs
    apart = float(2.0 * np.linalg.norm((high - other) + (low - rest), axis=1).max())
    return Reference(high, low, _MARGIN * apart + _ROUNDED, steps) if np.isfinite(apart) else None


def _equations(candidate: Candidate) -> Equations | None:
    problem = candidate.problem
    if problem.rigid:
        return rigid_equations(problem)
    if problem.hinged:
        return hinged_equations(problem)
    if problem.rolls:
        return rolling_equations(candidate)
    if problem.slides:
        return sliding_equations(problem)
    return jointed_equations(problem) if problem.scene.body.deforms else None


def _unit(equations: Equations, states: list[Long], time: Float) -> tuple[Float, Float]:
    """Return attitudes (n, 4) of unit length, high and low parts."""
    attitude = equations.attitude(states)
    square = sum((each * each for each in attitude), Long(np.zeros(len(time))))
    scaled = [(each / root(square)).over(time.shape) for each in attitude]
    high, low = (np.stack([getattr(each, part) for each in scaled], axis=1) for part in ("high", "low"))
    return high, low
