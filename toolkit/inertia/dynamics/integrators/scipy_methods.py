"""SciPy's adaptive methods, on (q, ω) in units of the problem's own time; DOP853 by a kernel where the problem has one.

DOP853 for torques that are no polynomial, LSODA and Radau for stiff ones. Hairer, Nørsett & Wanner, *Solving ODEs I*,
§ II.5; Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136; Hairer & Wanner, *Solving ODEs II*, § IV.8.

A method looks at a torque at the few instants of its stages, and steps over a pulse that lies between them. Where a
torque is a function that does not say how short its pulses are, each step is therefore probed: its defect, what the
slope of its polynomial lacks of the equations (Enright, *A new error-control for initial value solvers*, Appl. Math.
Comput. 31 (1989) 288), stands out there, and the step is taken again with half its length.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from inertia.arrays import Float
from inertia.dynamics.integrators.error_control import Adaptive, apart_of_three, rounding
from inertia.dynamics.integrators.loop import Call, Piece, States, Stepper
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.errors import GeometryError
from inertia.native import address

STEP_COST = 300
"""A step of DOP853 by SciPy in units of `native.Kernel.worthwhile`."""

_IMPORT = 1000  # in these units, that importing SciPy costs at the very least

_ROWS = 27
"""Rows of a table of the kernel: the first two say when and at what state it looked at the equations last."""

ORDERS = {"DOP853": 8, "LSODA": 12, "Radau": 5}
"""The highest order that each uses."""

PROBES = 4096
"""Instants of a run at which a torque is looked at for pulses, one at random in each of as many equal spans."""

_ALIKE, _FOLLOWED = 10.0, 0.3
"""Times the distance of the coarser two of three runs, by which all of them may be off alike; and where steps are no
longer than what the equations do."""

_PROBES_IN_STEP = 4  # at least
_NODES = 13  # the steps' polynomials have a degree of 12 at most
_MATTERS = 100.0  # times the tolerance, if it is some
_STANDS_OUT = 30.0  # times the median of the step
_ODD = 1e4  # times the tolerance, which no step has whose polynomial fits
_HALVINGS = 60


class SciPy(Adaptive):
    """One of SciPy's methods; any load. It begins again at every kink of the loads.

    The steps that it states are evaluations of the right-hand side, a kernel's too: SciPy does not count its steps.
    """

    tightest = coarsest = 2.3e-14

    def __init__(self, name: str) -> None:
        self.name = name
        self.order = ORDERS[name]

    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return the run at `control` and its estimate, of DOP853 from three runs as of the Taylor method.

        Where pulses may lie between the stages, two runs may miss the same share of one: a third, at a tenth of the
        tolerance, is compared too.
        """
        if self.name == "DOP853" and not problem.probed:
            fine, middle, coarse = (self.run(problem, time, control, level) for level in range(3))
            least = rounding(fine.angular_velocity, time[-1] - problem.start)
            # Where steps are short for another reason than the tolerance, all runs are much better than that.
            alike = _FOLLOWED if problem.longest_step_follows else _ALIKE
            least += min(8.0 * self.tolerance(control, 0), alike * middle.apart(coarse))
            return fine, 2.0 * problem.caution * apart_of_three(fine, middle, coarse, least) + least
        fine, estimate = super().solve(problem, time, control)
        if problem.probed and control > self.tightest:
            finer = self.run(problem, time, max(0.1 * control, self.tightest))
            estimate = max(0.5 * estimate, self.safety * problem.caution * fine.apart(finer))
        return fine, estimate

    def compiled(self, piece: Piece, control: float, level: int) -> Call | None:
        """Return the kernel of DOP853 where the problem has one and that repays."""
        known = piece.problem.dop853 if self.name == "DOP853" else None
        if known is None:
            return None
        (kernel, figures), unit, longest = known, piece.problem.unit, self._longest(piece, level)
        steps = min(float(piece.targets[-1]) / min(longest, 1.0), 1e12)
        if not kernel.worthwhile(_IMPORT + int(steps) * STEP_COST):
            return None
        table = np.zeros((_ROWS, len(unit)))
        own = self.tolerance(control, level), longest, address(table), address(unit)
        return Call(kernel, figures, own, (table, unit))

    def refusal(self, piece: Piece, call: Call) -> GeometryError:
        """Return what the equations have against the state that the kernel stopped at, or that its steps vanish."""
        (time, *_), state, *_ = call.arrays[0]
        if np.isfinite(state).all():
            piece.rhs()(float(time), state)  # which raises what is its own to say
        return self._stopped(_between(piece, "the steps that the tolerance asks for are below the spacing of numbers"))

    def _longest(self, piece: Piece, level: int) -> float:
        """Return the longest step in the problem's units."""
        longest = min(piece.problem.longest_step, piece.problem.stable_step if self.name == "DOP853" else np.inf)
        # Where this limit rules and not the tolerance, runs of two levels must differ all the same to be compared.
        return float(longest * piece.problem.rate * 10.0 ** ((level - 1) / ORDERS["DOP853"]))

    def stepper(self, piece: Piece, state: Float, control: float, level: int) -> Stepper:
        """Return SciPy's solver."""
        import scipy.integrate

        tolerance, most = self.tolerance(control, level), self._longest(piece, level)
        method, rhs, end = getattr(scipy.integrate, self.name), piece.rhs(), float(piece.targets[-1])

        def begin(time: float, state: Float, longest: float) -> Any:
            return method(rhs, time, state, end, rtol=tolerance, atol=tolerance, max_step=min(longest, most))

        return _Solver(begin, state, piece, _Probes(piece, rhs, tolerance, level) if piece.problem.probed else None)


def _between(piece: Piece, why: str) -> str:
    return f"between {piece.start:.6g} and {piece.end:.6g} s ({why})"


class _Solver(Stepper):
    """A `scipy.integrate.OdeSolver` under way."""

    def __init__(
        self, begin: Callable[[float, Float, float], Any], state: Float, piece: Piece, probes: _Probes | None
    ) -> None:
        self._begin, self._piece, self._probes = begin, piece, probes
        self._solver = begin(0.0, state, np.inf)
        self._before = 0  # evaluations of solvers that were left
        self._narrow = np.inf  # until when steps are kept short

    def step(self, target: float) -> str | None:
        """Take a step of the length that the solver chooses, or a shorter one that steps over no pulse."""
        if self._solver.t >= self._narrow:
            self._again(self._solver.t, self._solver.y, np.inf)
            self._narrow = np.inf
        time, state = self._solver.t, self._solver.y
        message = self._solver.step()
        for _ in range(_HALVINGS):
            if self._probes is None or self._solver.status == "failed" or not self._probes.miss(self._solver, time):
                break
            self._narrow = self._solver.t
            self._again(time, state, 0.5 * (self._solver.t - time))
            message = self._solver.step()
        self.time, self.steps = self._solver.t, self._before + self._solver.nfev
        if self._solver.status == "failed":
            return _between(self._piece, message)
        return None

    def _again(self, time: float, state: Float, longest: float) -> None:
        self._before += self._solver.nfev
        self._solver = self._begin(time, state, longest)

    def values(self, times: Float) -> Float:
        """Return values of the solver's interpolant."""
        values: Float = self._solver.dense_output()(times).T
        self.steps = self._before + self._solver.nfev  # some of them evaluate once more for it
        return values


class _Probes:
    """Instants at which steps are compared with the equations; the same ones in every run of a level."""

    def __init__(self, piece: Piece, rhs: Callable[[float, Float], Float], tolerance: float, level: int) -> None:
        problem = piece.problem
        self._rhs, self._tolerance = rhs, tolerance
        self._random = np.random.default_rng(level)
        spans = np.linspace(problem.start, piece.time[-1], PROBES, endpoint=False)
        everywhere = spans + self._random.random(PROBES) * (piece.time[-1] - problem.start) / PROBES
        self._times = (everywhere - piece.start) * problem.rate
        nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
        self._nodes, self._coefficients = nodes, np.linalg.inv(chebyshev.chebvander(nodes, _NODES - 1))

    def miss(self, solver: Any, begin: float) -> bool:
        """Return whether the step from `begin` on misses something of the torque, by its defect at the probes."""
        end = solver.t
        length, middle = end - begin, 0.5 * (begin + end)
        first, last = self._times.searchsorted([begin, end])
        more = max(_PROBES_IN_STEP - int(last - first), 1)
        own = begin + length * (np.arange(more) + self._random.random(more)) / more
        times = np.concatenate([self._times[first:last], own])
        dense = solver.dense_output()
        spin = dense(middle + 0.5 * length * self._nodes)[4:].T
        slopes = chebyshev.chebval(
            (times - middle) / (0.5 * length), chebyshev.chebder(self._coefficients @ spin) / (0.5 * length)
        )
        rates = np.array([self._rhs(t, y)[4:] for t, y in zip(times.tolist(), dense(times).T, strict=True)])
        defect = length * np.abs(slopes.T - rates).max(axis=1)
        size = self._tolerance * (1.0 + float(np.abs(spin).max()))
        return bool(defect.max() > min(max(_MATTERS * size, _STANDS_OUT * float(np.median(defect))), _ODD * size))
