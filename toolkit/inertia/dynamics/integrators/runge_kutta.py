"""The classical Runge–Kutta method of order four, on the attitude quaternion and ω.

Kutta, Z. Math. Phys. 46 (1901) 435. The quaternion is brought back to unit length after every step.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.dynamics.integrators.base import FixedStep, Scaled, States, begin, pieces
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.native import Kernel

_KERNEL = Kernel("inertia.dynamics.integrators.stepping_kernel", "runge_kutta_4", "ppipppip")

STEP_COST = 100
"""A step of the Python path in units of `native.Kernel.worthwhile`."""


class RungeKutta4(FixedStep):
    """RK4; any load."""

    name = "RK4"
    order = 4

    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time`."""
        state = begin(problem, level)
        out = np.empty((len(time), 7))
        out[time <= problem.start] = state
        total = 0
        for piece in pieces(problem, time):
            targets = np.append(time[piece.first : piece.last], piece.end)
            counts = self.counts(np.diff(targets, prepend=piece.start), control, level)
            found = np.empty((len(targets), 7))
            steps = int(counts.sum())
            if problem.terms(piece.start) is not None and _KERNEL.worthwhile(steps * STEP_COST):
                _advance(Scaled.of(problem, piece, time), problem.rate, state, counts, found)
            else:
                _advance_python(problem, piece.start, state, targets, counts, found)
            total += steps
            out[piece.first : piece.last] = found[:-1]
            state = found[-1]
        return States(quaternion.normalise(out[:, :4]), out[:, 4:], total)


def _advance(scaled: Scaled, rate: float, state: Float, counts: Int, out: Float) -> None:
    begun = state / np.array([1.0] * 4 + [rate] * 3)
    arrays = scaled.moments, scaled.packed, begun, scaled.targets, counts, out
    moments, packed, at, targets, steps, to = (array.ctypes.data for array in arrays)
    _KERNEL.function(moments, packed, scaled.vectors, at, targets, steps, len(counts), to)
    out[:, 4:] *= rate


def _advance_python(
    problem: RotationProblem, start: float, state: Float, targets: Float, counts: Int, out: Float
) -> None:
    begin, last = start, np.nextafter(targets[-1], start)  # loads may jump at the end of the piece
    for sample, (end, count) in enumerate(zip(targets.tolist(), counts.tolist(), strict=True)):
        step = (end - begin) / count if count else 0.0
        for number in range(count):
            time = begin + number * step
            a = problem.rhs(time, state)
            b = problem.rhs(time + 0.5 * step, state + 0.5 * step * a)
            c = problem.rhs(time + 0.5 * step, state + 0.5 * step * b)
            d = problem.rhs(min(time + step, last), state + step * c)
            state = state + step / 6.0 * (a + 2.0 * (b + c) + d)
            state[:4] /= np.linalg.norm(state[:4])
        begin = end
        out[sample] = state
