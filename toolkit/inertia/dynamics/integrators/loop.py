"""One loop over the samples of a run, for every integrator: each of them is a step.

The loop cuts a run where the loads have kinks, scales times and angular velocities to the problem's own unit of time,
lets the method step until a sample lies within its last step, writes the state there, and brings quaternions back to
unit length. A method gives its step as a `Stepper`; where it is compiled, as a kernel that `loop_kernel` builds around
the step, which takes a whole piece in one call.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float, Int
from inertia.dynamics.computing_time import Watch
from inertia.dynamics.integrators.rotation import Figures, RotationProblem, power_of_two
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.observer import meanwhile
from inertia.errors import GeometryError, UsageError
from inertia.native import Kernel, address
from inertia.records import dataclass

MAX_STEPS = 200_000_000
"""The most steps of a run (a minute or more): one that needs more is refused, or stops."""

_FIRST_LOOK = 150_000
"""Steps of a kernel after which it is asked how far it has come; it then begins again."""

_STEP = 2e-5
"""s, what a step of a kernel takes at most."""

EPS = float(np.finfo(np.float64).eps)


class States(NamedTuple):
    """The states at n times: attitudes (n, 4), angular velocities (n, 3) in rad/s, the number of steps, and what else
    the problem carries along, (n, k)."""

    attitude: Float
    angular_velocity: Float
    steps: int
    carried: Float = np.empty((0, 0))

    def apart(self, other: States) -> float:
        """Return the largest angle in rad between the attitudes of two runs."""
        angles = quaternion.angle_between(self.attitude, other.attitude)
        return float(angles.max()) if np.isfinite(angles).all() else np.inf


class Units:
    """A body and its loads in units of the problem's own time and moments, powers of two both.

    Attributes
    ----------
    moments : (3,) principal moments; packed : the loads, `terms.Terms.packed`; vectors : how many are fixed in space
    figures : all of them, for a kernel
    decay : the fastest rate at which damping takes spin away
    """

    def __init__(self, moments: Float, packed: Float) -> None:
        self.moments, self.packed = moments, packed
        self.vectors = (len(packed) - HEAD) // VECTOR
        self.figures = moments, packed, self.vectors
        self.decay = float((packed[6:9] / moments).max())

    @staticmethod
    @functools.lru_cache(maxsize=16)
    def of(problem: RotationProblem, start: float, axes: tuple[int, ...] = (0, 1, 2)) -> Units:
        """Take the loads from an instant on, along `axes` in this order; runs that follow take them again.

        Raises `UsageError` where a load is not of the form of `terms.Terms`.
        """
        terms = problem.terms(start)
        if terms is None:
            names = [type(load).__name__ for load in problem.loads if load.terms(problem, start) is None]
            raise UsageError(f"{names[0]} is no polynomial in the state: use DOP853, LSODA, Radau or RK4 for it")
        inertia = power_of_two(float(problem.moments.max()))
        return Units(problem.moments[list(axes)] / inertia, terms.along(axes).packed(inertia, problem.rate))


@dataclass
class Piece:
    """A span of time without kinks of the loads: samples `first` … `last` − 1 lie after `start` and up to `end`.

    Attributes
    ----------
    problem, time : the run: what moves, and all samples (n,) in s
    start, end : s; first, last : samples
    axes : the order in which the method takes the body axes
    """

    problem: RotationProblem
    time: Float
    start: float
    end: float
    first: int
    last: int
    axes: tuple[int, ...] = (0, 1, 2)

    @functools.cached_property
    def targets(self) -> Float:
        """The samples of the piece and its end, (n + 1,), counted from its start in units of 1/rate."""
        targets = np.empty(self.last - self.first + 1)
        targets[:-1], targets[-1] = self.time[self.first : self.last], self.end
        targets -= self.start
        targets *= self.problem.rate
        return targets

    @property
    def units(self) -> Units:
        """The body and its loads, `Units.of`."""
        return Units.of(self.problem, self.start, self.axes)

    def rhs(self) -> Callable[[float, Float], Float]:
        """Return the rate of a state as a function of time and state, all in the problem's units; any load."""
        problem, rate, start = self.problem, self.problem.rate, self.start
        last = np.nextafter(self.end, start)  # loads may jump at the end of the piece
        unit = problem.unit
        per_time = unit * rate
        return lambda time, state: problem.rhs(min(start + time / rate, last), state * unit) / per_time


def pieces(problem: RotationProblem, time: Float, axes: tuple[int, ...] = (0, 1, 2)) -> list[Piece]:
    """Cut the run from the start to the last of `time` (n,), ascending, at the kinks of the loads."""
    start, breaks, finish = problem.start, problem.breaks, float(time[-1])
    inside = breaks[(breaks > start) & (breaks < finish)].tolist() if breaks.size else []
    first, cut = int(time.searchsorted(start, side="right")), []
    for end in inside:
        last = int(time.searchsorted(end, side="right"))
        cut.append(Piece(problem, time, start, end, first, last, axes))
        start, first = end, last
    if finish > start:
        cut.append(Piece(problem, time, start, finish, first, len(time), axes))
    return cut


class Call(NamedTuple):
    """A kernel, the figures of the problem, its own arguments after those that all share, and the arrays that they
    point into."""

    kernel: Kernel
    figures: Figures
    arguments: tuple[float, ...]
    arrays: tuple[Float | Int, ...]


class Stepper(ABC):
    """A method on its way through a piece of a run, in units of time 1/rate, from time zero on.

    Attributes
    ----------
    time : where the last step ended; steps : their number
    """

    time = 0.0
    steps = 0

    @property
    def reached(self) -> float:
        """How far it has come, which may be on the way to a sample."""
        return self.time

    @abstractmethod
    def step(self, target: float) -> str | None:
        """Take a step towards the next sample at `target`, or beyond it; return why it cannot be taken, if so."""

    @abstractmethod
    def values(self, times: Float) -> Float:
        """Return the states (n, 7 + k) at `times` (n,), ascending, which lie within the last step."""


class EqualSteps(Stepper):
    """Steps of equal length between samples, `counts` (n,) of them to each.

    `advance` takes the time, the length of the step and the state (7 + k,) to the state at the end of the step.
    """

    def __init__(self, advance: Callable[[float, float, Float], Float], counts: Int, state: Float) -> None:
        self._advance, self._state = advance, state
        self._counts = iter(counts[counts > 0].tolist())
        self._number = self._count = 0
        self._length = 0.0

    @property
    def reached(self) -> float:
        """Where the last of the equal steps ended."""
        return self.time + self._number % self._count * self._length if self._count else 0.0

    def step(self, target: float) -> str | None:
        """Take one of the equal steps to `target`."""
        if self._number == self._count:
            self._number, self._count = 0, next(self._counts)
            self._length = (target - self.time) / self._count
        self._state = self._advance(self.time + self._number * self._length, self._length, self._state)
        self._number += 1
        self.steps += 1
        if self._number == self._count:
            self.time = target
        return None

    def values(self, times: Float) -> Float:
        """Return the state at the sample that the steps led to."""
        return self._state[None]


class Integrator(ABC):
    """A stepping method.

    A method has one number that sets its accuracy, the *control*: the step in s, or a tolerance. A run can be repeated
    at another level with the same control, which is how its error is estimated.

    Attributes
    ----------
    name, order : of the method
    keeps_length : whether the quaternions that it gives have unit length to rounding
    aside : the roundings by which the quaternion of other levels than the finest begins elsewhere
    patience : finer controls in a row that do not lower the estimate, after which no other is tried
    """

    name: str
    order: int
    keeps_length = False
    aside = 4.0
    patience = 1

    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time` (n,), ascending from the start on; another `level` is another run to compare."""
        time = np.array(time)  # in one piece
        axes = self.axes(problem)
        turn = quaternion.from_matrix(np.eye(3)[:, axes]) if axes != (0, 1, 2) else None
        state = begin(problem, level, self.aside)
        if turn is not None:
            state = np.concatenate([quaternion.multiply(state[:4], turn), state[4:][list(axes)]])
        cut = pieces(problem, time, axes)
        rows = np.empty(
            (len(time) + 1, len(state))
        )  # a piece begins with the state in its first row, and ends one row on
        rows[: cut[0].first + 1 if cut else len(time)] = state
        steps = 0
        for piece in cut:
            call = self.compiled(piece, control, level)
            steps += self._in_kernel(piece, call, rows) if call else self._in_python(piece, control, level, rows)
        attitude, spin, carried = rows[:-1, :4], rows[:-1, 4:7], rows[:-1, 7:]
        if turn is not None:
            attitude = quaternion.multiply(attitude, quaternion.conjugate(turn))
            spin = spin[:, np.argsort(axes)]
        return States(attitude if self.keeps_length else quaternion.normalise(attitude), spin, steps, carried)

    def _in_kernel(self, piece: Piece, call: Call, rows: Float) -> int:
        """Write the rows of a piece by a kernel; return the steps."""
        (moments, packed, count), kernel = call.figures, call.kernel.function
        watch = Watch()  # from here on: a kernel may be compiled first, which says nothing of its pace
        state = rows[piece.first].copy()
        radians = 3.0 * (piece.end - piece.start) * piece.problem.rate
        expected = int(radians) if radians < watch.left / _STEP else 0
        most = max(_FIRST_LOOK, expected) if watch.limits else MAX_STEPS
        while True:
            rows[piece.first + 1 : piece.last + 1, 0] = np.nan  # until a sample is reached
            with meanwhile(self._looking_on(piece, rows)):
                steps = kernel(
                    address(moments),
                    address(packed),
                    count,
                    address(piece.time) + 8 * piece.first,
                    piece.last - piece.first,
                    piece.start,
                    piece.end,
                    piece.problem.rate,
                    most,
                    address(rows) + rows.strides[0] * piece.first,
                    *call.arguments,
                )
            if steps >= 0:
                return steps
            if steps == -1 or most == MAX_STEPS:
                raise self.refusal(piece, call) if steps == -1 else self._stopped()
            ahead = piece.first + int(np.isfinite(rows[piece.first + 1 : piece.last + 1, 0]).sum()) + 1
            reached = (piece.time[ahead] if ahead < piece.last else piece.end) - piece.start
            watch.require(min(float(reached / (piece.end - piece.start)), 0.99))
            rows[piece.first] = state
            most = min(16 * most, int(0.5 * watch.left * most / watch.elapsed), MAX_STEPS)

    def _in_python(self, piece: Piece, control: float, level: int, rows: Float) -> int:
        """Do the same a step at a time."""
        unit = piece.problem.unit
        stepper = self.stepper(piece, rows[piece.first] / unit, control, level)
        watch = Watch()  # from here on: a stepper may load libraries first, which says nothing of its pace
        targets, samples = np.unique(piece.targets, return_inverse=True)
        values = np.empty((len(targets), len(unit)))
        done, end = 0, float(targets[-1])
        observer, before = piece.problem.observer, 0
        while done < len(targets):
            reason = stepper.step(float(targets[done]))
            if reason or stepper.steps > MAX_STEPS:
                raise self._stopped(reason)
            watch.require(stepper.reached / end)
            last = done + int(targets[done:].searchsorted(stepper.time, side="right"))
            if last > done:
                values[done:last] = stepper.values(targets[done:last])
                done = last
                ready = int(samples[:-1].searchsorted(done))
                if observer and ready > before and (observer.due or done == len(targets)):
                    self._hand_on(piece, before, values[samples[before:ready]] * unit)
                    before = ready
        rows[piece.first : piece.last + 1] = (values * unit)[samples]
        rows[piece.last, :4] /= np.linalg.norm(rows[piece.last, :4])
        return stepper.steps

    def _looking_on(self, piece: Piece, rows: Float) -> Callable[[], None] | None:
        """Return what hands on the rows that a kernel has written: a row is whole when the next one is begun."""
        if piece.problem.observer is None:
            return None
        before = piece.first

        def look() -> None:
            nonlocal before
            ready = piece.first + int(np.isfinite(rows[piece.first + 1 : piece.last + 1, 0]).sum())
            if ready > before:
                self._hand_on(piece, before - piece.first, rows[before:ready].copy())
                before = ready

        return look

    def _hand_on(self, piece: Piece, first: int, rows: Float) -> None:
        """Hand on the rows (n, 7 + k) at the samples from `first` of a piece on, along the axes of the problem."""
        assert piece.problem.observer is not None
        begin = piece.first + first
        turn = quaternion.conjugate(quaternion.from_matrix(np.eye(3)[:, piece.axes]))
        attitude = quaternion.normalise(quaternion.multiply(rows[:, :4], turn))
        spin = rows[:, 4:7][:, np.argsort(piece.axes)]
        piece.problem.observer(piece.time[begin : begin + len(rows)], attitude, spin)

    def _stopped(self, reason: str | None = None) -> GeometryError:
        reason = reason or f"after {MAX_STEPS:.2g} steps"
        return GeometryError(
            f"{self.name} stopped {reason}: check the loads, ask for a shorter run or use another method"
        )

    def refusal(self, piece: Piece, call: Call) -> GeometryError:
        """Return why a kernel could not take a step."""
        return self._stopped("where the motion leaves float64")

    def axes(self, problem: RotationProblem) -> tuple[int, ...]:
        """Return the body axes in the order that the method takes them, a cyclic one."""
        return 0, 1, 2

    def compiled(self, piece: Piece, control: float, level: int) -> Call | None:
        """Return the call of a kernel that takes the whole piece; None where that does not repay."""
        return None

    @abstractmethod
    def stepper(self, piece: Piece, state: Float, control: float, level: int) -> Stepper:
        """Return the method at the beginning of a piece, with the state (7 + k,) in the problem's units."""

    @abstractmethod
    def first(self, problem: RotationProblem, time: Float, accuracy: float) -> float:
        """Return a control that may reach `accuracy` in rad at the last of `time`."""

    @abstractmethod
    def finer(self, control: float, estimate: float, accuracy: float) -> float:
        """Return the next control to try, after one that reached `estimate`; the same one if there is none."""

    @abstractmethod
    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return a run and the estimate, in rad, of its largest attitude error."""


def begin(problem: RotationProblem, level: int, turned: float) -> Float:
    """Return the state (7 + k,) that a run begins with: q, ω in rad/s, and what the problem carries along.

    Other levels than the finest begin a rounding aside in ω, `turned` of them in the quaternion, so that their distance
    also holds what the motion makes of rounding: near a separatrix that is much.
    """
    state = np.empty(7)
    state[:4], state[4:] = problem.attitude, problem.angular_velocity
    if level:
        aside = EPS * np.array([(1.0, -1.0, 1.0), (1.0, 1.0, -1.0)][level - 1])
        state[:4] = quaternion.multiply(state[:4], (*(turned * aside), 1.0))
        state[4:] *= 1.0 + aside
    return np.concatenate([state, problem.carried])
