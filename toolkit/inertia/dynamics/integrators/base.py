"""What every stepping method offers: a run, a first guess of its control from the accuracy asked, an error estimate.

A method has one number that sets its accuracy, the *control*: the step in s, or a tolerance. A run can be repeated at
another level with the same control, which is how its error is estimated.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float, Int
from inertia.dynamics.integrators.rotation import RotationProblem, power_of_two
from inertia.dynamics.integrators.terms import HEAD, VECTOR, Terms
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError, UsageError

MAX_STEPS = 200_000_000
"""Steps that are still taken (about a minute); a run that needs more is refused."""

EPS = float(np.finfo(np.float64).eps)


class States(NamedTuple):
    """The states at n times: attitudes (n, 4), angular velocities (n, 3) in rad/s, and the number of steps."""

    attitude: Float
    angular_velocity: Float
    steps: int

    def apart(self, other: States) -> float:
        """Return the largest angle in rad between the attitudes of two runs."""
        angles = quaternion.angle_between(self.attitude, other.attitude)
        return float(angles.max()) if np.isfinite(angles).all() else np.inf


class Piece(NamedTuple):
    """A span of time without kinks of the loads: samples `first` … `last` − 1 lie after `start` and up to `end`."""

    start: float
    end: float
    first: int
    last: int


def pieces(problem: RotationProblem, time: Float) -> list[Piece]:
    """Cut the run from the start to the last of `time` (n,), ascending, at the kinks of the loads."""
    start, breaks, finish = problem.start, problem.breaks, float(time[-1])
    inside = breaks[(breaks > start) & (breaks < finish)].tolist() if breaks.size else []
    first, found = int(time.searchsorted(start, side="right")), []
    for end in inside:
        last = int(time.searchsorted(end, side="right"))
        found.append(Piece(start, end, first, last))
        start, first = end, last
    if finish > start:
        found.append(Piece(start, finish, first, len(time)))
    return found


@dataclass(frozen=True, eq=False)
class Units:
    """A body and its loads in units of the problem's own time and moments, powers of two both."""

    moments: Float
    packed: Float

    @classmethod
    @functools.lru_cache(maxsize=16)
    def of(cls, problem: RotationProblem, start: float, axes: tuple[int, ...] = (0, 1, 2)) -> Units:
        """Take the terms from an instant on, along `axes` in this order; runs that follow take them again."""
        inertia = power_of_two(float(problem.moments.max()))
        terms = standard(problem, start).along(axes)
        return cls(problem.moments[list(axes)] / inertia, terms.packed(inertia, problem.rate))

    @functools.cached_property
    def addresses(self) -> tuple[int, int]:
        """Where the numbers lie, for a kernel."""
        return self.moments.ctypes.data, self.packed.ctypes.data

    @functools.cached_property
    def decay(self) -> float:
        """The fastest rate at which damping takes spin away."""
        return float((self.packed[6:9] / self.moments).max())

    @functools.cached_property
    def vectors(self) -> int:
        """How many vectors fixed in space the terms hold."""
        return (len(self.packed) - HEAD) // VECTOR


class Scaled(NamedTuple):
    """A piece of a run in those units.

    `targets` are the samples of the piece and its end, counted from its start.
    """

    units: Units
    targets: Float

    @classmethod
    def of(cls, problem: RotationProblem, piece: Piece, time: Float, axes: tuple[int, ...] = (0, 1, 2)) -> Scaled:
        """Scale a piece of the run through `time`, with the body axes in the order `axes`."""
        targets = np.empty(piece.last - piece.first + 1)
        targets[:-1], targets[-1] = time[piece.first : piece.last], piece.end
        targets -= piece.start
        targets *= problem.rate
        return cls(Units.of(problem, piece.start, axes), targets)

    @property
    def moments(self) -> Float:
        """The principal moments (3,)."""
        return self.units.moments

    @property
    def packed(self) -> Float:
        """The terms, `terms.Terms.packed`."""
        return self.units.packed

    @property
    def vectors(self) -> int:
        """How many vectors fixed in space the terms hold."""
        return self.units.vectors


def standard(problem: RotationProblem, start: float) -> Terms:
    """Return the loads as `Terms`, or raise `UsageError` where one of them is not of that form."""
    terms = problem.terms(start)
    if terms is None:
        names = [type(load).__name__ for load in problem.loads if load.terms(problem, start) is None]
        raise UsageError(f"{names[0]} is no polynomial in the state: use DOP853, LSODA, Radau or RK4 for it")
    return terms


class Integrator(ABC):
    """A stepping method."""

    name: str
    order: int

    @abstractmethod
    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time` (n,), ascending from the start on; another `level` is another run to compare."""

    @abstractmethod
    def first(self, problem: RotationProblem, time: Float, accuracy: float) -> float:
        """Return a control that may reach `accuracy` in rad at the last of `time`."""

    @abstractmethod
    def finer(self, control: float, estimate: float, accuracy: float) -> float:
        """Return the next control to try, after one that reached `estimate`; the same one if there is none."""

    @abstractmethod
    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return a run and the estimate, in rad, of its largest attitude error."""


class FixedStep(Integrator):
    """A method of known order with steps of equal length between samples; the control is the step in s.

    The estimate is Richardson's, on runs with three steps in the place of four: their distance d makes it
    2 d/((4/3)ᵖ − 1), and never less than 2 d, because rounding does not fall with the order. Where d is small enough to
    be rounding, a run with five steps in the place of four is made too, and the larger distance taken.
    Hairer, Nørsett & Wanner, *Solving ODEs I*, § II.4.
    """

    def counts(self, lengths: Float, step: float, level: int) -> Int:
        """Return how many steps span each of `lengths` (n,): multiples of four; of three, of five at level 1, 2."""
        quarters = np.ceil(lengths / (4.0 * step) * (1.0 - 1e-12))
        if not 4.0 * quarters.sum() < MAX_STEPS:
            raise GeometryError(
                f"{self.name} needs {4.0 * quarters.sum():.2g} steps of {step:.2g} s, the limit is {MAX_STEPS:.0g}: "
                "ask for less accuracy, a shorter run or another method"
            )
        return quarters.astype(np.int64) * (4, 3, 5)[level]

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
        apart = fine.apart(coarse)
        least = rounding(fine.angular_velocity, time[-1] - problem.start)
        if apart < 10.0 * least * np.sqrt(fine.steps):
            apart = max(apart, fine.apart(self.run(problem, time, control, 2)))
        return fine, 2.0 * apart / min((4.0 / 3.0) ** self.order - 1.0, 1.0) + least


class Adaptive(Integrator):
    """A method that chooses its own steps; the control is its tolerance, relative to the problem's own scales.

    The tolerance grows tenfold from level to level, but not below what rounding would hide (`coarsest`). The estimate
    comes from the distance d₁ of the first two runs and, where three are made, d₂ of the second and the third: it is
    `safety` max(d₁, min(d₂, 3 d₁), 0.3 d₂). No share of d₁ is taken, because near a separatrix rounding is amplified
    until it rules at every tolerance; a third run makes it unlikely that two happen to agree there. Where the
    tolerance rules, d₂ is some 10 d₁; where it is less, rounding does, and d₂ says as much about it as d₁.
    """

    tightest: float
    coarsest: float
    runs = 2
    safety = 2.0

    def first(self, problem: RotationProblem, time: Float, accuracy: float) -> float:
        """Return the tolerance accuracy/(30 phase)."""
        phase = 1.0 + problem.rate * float(time[-1] - problem.start)
        return float(min(max(accuracy / (30.0 * phase), self.tightest), 1e-3))

    def finer(self, control: float, estimate: float, accuracy: float) -> float:
        """Return the tolerance in proportion, and not above a tenth."""
        shrink = 0.3 * accuracy / estimate if np.isfinite(estimate) else 1e-3
        return max(control * min(max(shrink, 1e-4), 0.1), self.tightest)

    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return the run at `control` and its estimate."""
        fine, middle, *rest = (self.run(problem, time, control, level) for level in range(self.runs))
        near = fine.apart(middle)
        apart = max([near, *(max(min(far, 3.0 * near), 0.3 * far) for far in map(middle.apart, rest))])
        return fine, self.safety * apart + rounding(fine.angular_velocity, time[-1] - problem.start)

    def tolerance(self, control: float, level: int) -> float:
        """Return the tolerance of a level."""
        return max(control * 10.0**level, level * self.coarsest)


def begin(problem: RotationProblem, level: int) -> Float:
    """Return the state (q, ω), (7,), that a run begins with, ω in rad/s.

    Other levels than the finest begin a few roundings aside, so that their distance also holds what the motion makes
    of rounding: near a separatrix that is much.
    """
    state = np.empty(7)
    state[:4], state[4:] = problem.attitude, problem.angular_velocity
    if level:
        aside = EPS * np.array([(1.0, -1.0, 1.0), (1.0, 1.0, -1.0)][level - 1])
        state[:4] = quaternion.multiply(state[:4], (*(4.0 * aside), 1.0))
        state[4:] *= 1.0 + aside
    return state


def rounding(spin: Float, length: float) -> float:
    """Return the angle in rad that rounding alone costs over `length` s at `spin` (…, 3): 2 ε a radian, and 2 ε."""
    return float(2.0 * EPS * (1.0 + np.linalg.norm(spin, axis=-1).max() * length))
