"""Step and tolerance control: a first guess from the accuracy asked, an error estimate from runs that are compared."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable

import numpy as np

from inertia.arrays import Float, Int
from inertia.dynamics.integrators.loop import EPS, MAX_STEPS, EqualSteps, Integrator, Piece, States
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.errors import GeometryError

_MAY_ROUND = 1000.0  # roundings, times the root of the steps, up to which a drift may be rounding alone


class FixedStep(Integrator):
    """A method of known order with steps of equal length between samples; the control is the step in s.

    The estimate is Richardson's, on runs with three steps in the place of four: their distance d₁ makes it
    2 d₁/((4/3)ᵖ − 1), and never less than 2 d₁, because rounding does not fall with the order. Where what the loads
    keep drifts so little that rounding may rule, a run with five steps in the place of four is made too, d₂ apart: the
    larger distance then counts twice as much, what rounding costs is added (`walk`), and where d₂/d₁ is not what the
    order makes it, rounding is amplified and the distance counts twice as much again.
    Hairer, Nørsett & Wanner, *Solving ODEs I*, § II.4.
    """

    def counts(self, piece: Piece, step: float, level: int) -> Int:
        """Return how many steps lead to each target (n,): multiples of four; of three, of five at level 1, 2."""
        lengths = np.diff(piece.targets, prepend=0.0) / piece.problem.rate
        step = min(step, piece.problem.longest_step)
        quarters = np.ceil(lengths / (4.0 * step) * (1.0 - 1e-12))
        if not 4.0 * quarters.sum() < MAX_STEPS:
            raise GeometryError(
                f"{self.name} needs {4.0 * quarters.sum():.2g} steps of {step:.2g} s, the limit is {MAX_STEPS:.0g}: "
                "ask for less accuracy, a shorter run or another method"
            )
        return quarters.astype(np.int64) * (4, 3, 5)[level]

    def stepper(self, piece: Piece, state: Float, control: float, level: int) -> EqualSteps:
        """Return the equal steps."""
        return EqualSteps(self.step(piece), self.counts(piece, control, level), state)

    @abstractmethod
    def step(self, piece: Piece) -> Callable[[float, float, Float], Float]:
        """Return the step: from the time, its length and the state (7,), in the problem's units, to the state after."""

    def first(self, problem: RotationProblem, time: Float, accuracy: float) -> float:
        """Return h from |error| ≈ phase (h rate)ᵖ/100."""
        phase = 1.0 + problem.rate * float(time[-1] - problem.start)
        return float(min((100.0 * accuracy / phase) ** (1.0 / self.order), 0.5)) / problem.rate

    def finer(self, control: float, estimate: float, accuracy: float) -> float:
        """Return h (accuracy/estimate)^(1/p), and not more than half of h."""
        shrink = 0.9 * (0.5 * accuracy / estimate) ** (1.0 / self.order) if np.isfinite(estimate) else 0.25
        return control * min(max(shrink, 1e-3), 0.5)

    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return the run at `control` and its estimate."""
        fine, coarse = (self.run(problem, time, control, level) for level in range(2))
        apart, length = fine.apart(coarse), float(time[-1] - problem.start)
        least, falls = rounding(fine.angular_velocity, length), (4.0 / 3.0) ** self.order - 1.0
        if problem.drift(fine.attitude, fine.angular_velocity) <= _MAY_ROUND * EPS * np.sqrt(fine.steps):
            other, least = fine.apart(self.run(problem, time, control, 2)), walk(problem, fine, length)
            by_order = apart * (1.0 - 0.8**self.order) / falls
            amplified = max(apart, other) > 2.0 * least and not 0.5 * by_order < other < 1.5 * by_order
            apart = max(apart, other) * (2.0 if amplified else 1.0)
            least += 2.0 * apart
        return fine, 2.0 * problem.caution * apart / min(falls, 1.0) + least


class Adaptive(Integrator):
    """A method that chooses its own steps; the control is its tolerance, relative to the problem's own scales.

    The tolerance is ten times as large at the other level, but not below what rounding would hide (`coarsest`). The
    estimate is `safety` times the distance of the two runs, and eight tolerances where both may be off alike. No share
    of the distance is taken, because near a separatrix rounding is amplified until it rules at every tolerance.
    """

    tightest: float
    coarsest: float
    safety = 4.0
    room = 30.0  # of the tolerance per radian below the accuracy, so that the first estimate is mostly within it

    def first(self, problem: RotationProblem, time: Float, accuracy: float) -> float:
        """Return the tolerance accuracy/(room phase)."""
        phase = 1.0 + problem.rate * float(time[-1] - problem.start)
        return float(min(max(accuracy / (self.room * phase), self.tightest), 1e-3))

    def finer(self, control: float, estimate: float, accuracy: float) -> float:
        """Return the tolerance in proportion, and not above a tenth."""
        shrink = 0.3 * accuracy / estimate if np.isfinite(estimate) else 1e-3
        return max(control * min(max(shrink, 1e-4), 0.1), self.tightest)

    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return the run at `control` and its estimate."""
        fine, coarse = (self.run(problem, time, control, level) for level in range(2))
        least = rounding(fine.angular_velocity, time[-1] - problem.start) + 8.0 * self.tolerance(control, 0)
        return fine, self.safety * problem.caution * fine.apart(coarse) + least

    def tolerance(self, control: float, level: int) -> float:
        """Return the tolerance of a level."""
        return max(control * 10.0**level, level * self.coarsest)


_STEADY = 0.3
_AMPLIFIED = 7.0


def apart_of_three(fine: States, middle: States, coarse: States, cost: float, share: float = 0.1) -> float:
    """Return max(d₁, share d₂) in rad, from runs each of which has ten times the tolerance of the one before.

    d₁, d₂ are their distances. Where d₁ neither falls with the tolerance nor is what rounding costs, it is rounding
    that the motion has amplified, of which two runs may have got alike: then it counts `_AMPLIFIED` times as much.
    """
    finest, coarsest = fine.apart(middle), middle.apart(coarse)
    amplified = finest > max(_STEADY * coarsest, 10.0 * cost)
    return max((_AMPLIFIED if amplified else 1.0) * finest, share * coarsest)


def walk(problem: RotationProblem, states: States, length: float) -> float:
    """Return the angle in rad that rounding costs over `length` s, ε (2 + θ (2 + √n/2)) + θ δ.

    θ bounds the angle turned through, n is the number of steps, whose rounding errors walk at random, and δ the
    relative drift of what the loads keep, which tells whether they walk in one direction.
    """
    turned = float(np.linalg.norm(states.angular_velocity, axis=1).max()) * length
    at_random = float(EPS * (2.0 + turned * (2.0 + 0.5 * np.sqrt(states.steps))))
    return at_random + turned * problem.drift(states.attitude, states.angular_velocity)


def rounding(spin: Float, length: float) -> float:
    """Return the angle in rad that rounding alone costs over `length` s at `spin` (…, 3): 2 ε a radian, and 2 ε."""
    return float(2.0 * EPS * (1.0 + np.linalg.norm(spin, axis=-1).max() * length))
