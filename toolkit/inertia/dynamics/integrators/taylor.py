"""Taylor series of the whole motion, to an order that follows from the tolerance.

Euler's equations, the attitude and the body components of a vector fixed in space have polynomial right-hand sides,
so that every coefficient follows from sums of products of the ones before (Cauchy products). The step is that of
Jorba & Zou, Experim. Math. 14 (2005) 99, § 3: from the last two coefficients. Their order, ⌈−½ ln tolerance⌉ + 1, is
the cheapest where the cost of a step grows as the square of the order; in our kernel it grows more slowly, and
⌈−0.7 ln tolerance⌉ + 2 was measured to be the cheapest. A step spans about a radian; samples inside it are values of
its polynomial.
"""

from __future__ import annotations

import functools
import math

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.base import Adaptive, Piece, Scaled, States, Units, begin, pieces
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError
from inertia.native import Kernel, address

_KERNEL, _SIMPLE = (
    Kernel("inertia.dynamics.integrators.taylor_kernel", name, "ppippidddidip", fused=True)
    for name in ("advance", "advance_simple")
)

_ROWS, _ROW = 33, 16
"""Rows in a block of the kernel, and numbers in a row. The last row is no coefficient; 30 are, at most."""

STEP_COST = 500
"""A step of the numpy path in units of `native.Kernel.worthwhile`."""

LIMIT = 200_000_000
"""Steps that are still taken (minutes)."""


class Taylor(Adaptive):
    """The Taylor method; loads must be polynomial (`terms.Terms`), tables are taken row by row."""

    name = "Taylor"
    order = 20
    tightest = 1e-17
    coarsest = 3e-16
    runs = 3
    safety = 5.0

    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time`."""
        tolerance = self.tolerance(control, level)
        order = min(math.ceil(-0.7 * math.log(tolerance)) + 2, _ROWS - 3)
        time = np.array(time)  # in one piece
        state = begin(problem, level)
        out = np.empty((len(time), 7))
        parts = pieces(problem, time)
        out[: parts[0].first if parts else len(time)] = state
        steps = 0
        for piece in parts:
            taken, state = _advance(problem, piece, time, state, order, tolerance, out)
            steps += taken
        return States(out[:, :4], out[:, 4:], steps)


def _advance(
    problem: RotationProblem, piece: Piece, time: Float, state: Float, order: int, tolerance: float, out: Float
) -> tuple[int, Float]:
    """Write the samples of a piece; return the steps and the state at its end."""
    units, (start, end, first, last) = Units.of(problem, piece.start), piece
    radians = 1.0 + (end - start) * problem.rate * (1.0 + units.decay)
    kernel = _SIMPLE if _simple(units) else _KERNEL
    if not kernel.worthwhile(int(min(radians, 1e12)) * STEP_COST):
        scaled = Scaled.of(problem, piece, time)
        found = np.empty((len(scaled.targets), 7))
        steps = _advance_numpy(scaled, state / ([1.0] * 4 + [problem.rate] * 3), order, tolerance, found)
        found[:, 4:] *= problem.rate
        out[first:last] = found[:-1]
        return steps, found[-1]
    scratch = np.empty((4 + 2 * units.vectors) * _ROWS * _ROW)
    at_end = scratch[(_ROWS - 1) * _ROW :][:7]
    at_end[:] = state
    steps = kernel.function(
        *units.addresses,
        units.vectors,
        address(scratch),
        address(time) + time.itemsize * first,
        last - first,
        start,
        end,
        problem.rate,
        order,
        tolerance,
        LIMIT,
        address(out) + 7 * out.itemsize * first,
    )
    if steps < 0:
        raise _stopped()
    return steps, at_end


@functools.lru_cache(maxsize=16)
def _simple(units: Units) -> bool:
    """Say whether the terms are what the simple kernel takes."""
    if units.vectors != 1:
        return False
    return not (units.packed[9] or units.packed[HEAD + 12 : HEAD + 15].any() or units.packed[HEAD + 16])


def _stopped() -> GeometryError:
    return GeometryError(
        f"Taylor stopped after {LIMIT:.2g} steps, or where the motion leaves float64: "
        "check the loads or ask for a shorter run"
    )


def _advance_numpy(scaled: Scaled, state: Float, order: int, tolerance: float, out: Float) -> int:
    """Do what the kernel does, one matrix product a coefficient."""
    now, slack, done, steps = 0.0, 0.0, 0, 0
    powers = np.arange(order + 1)
    while done < len(out):
        series = _series(scaled, state, now, order)
        steps += 1
        step = _length(series, order, tolerance)
        if not step > 0 or steps > LIMIT:
            raise _stopped()
        ahead = (scaled.targets[done:] - now) - slack
        last = done + int(np.searchsorted(ahead, step, side="right"))
        out[done:last] = ahead[: last - done, None] ** powers @ series[:, :7]
        out[done:last, :4] /= np.linalg.norm(out[done:last, :4], axis=1, keepdims=True)
        done = last
        if done < len(out):
            state = step**powers @ series[:, :7]
            state[:4] /= np.linalg.norm(state[:4])
            now, slack = now + (step + slack), (step + slack) - ((now + (step + slack)) - now)
    return steps


def _length(series: Float, order: int, tolerance: float) -> float:
    sizes = np.abs(series[order - 1 :]) / np.maximum(1.0, np.abs(series[0]))
    largest = sizes[:, :7].max(axis=1)
    with np.errstate(divide="ignore"):
        return float(((tolerance / largest) ** (1.0 / np.arange(order - 1, order + 1))).min())


def _series(scaled: Scaled, state: Float, now: float, order: int) -> Float:
    """Return the coefficients (order + 1, 13 + 3 k) of q, ω, Ω, Ω − ω and the k vectors in the body."""
    moments, packed = scaled.moments, scaled.packed
    rows = packed[HEAD:].reshape(-1, VECTOR)
    series = np.zeros((order + 1, 13 + 3 * len(rows)))
    q, w, turn, slip = series[:, :4], series[:, 4:7], series[:, 7:10], series[:, 10:13]
    q[0], w[0] = state[:4], state[4:]
    vectors = [series[:, at : at + 3] for at in range(13, series.shape[1], 3)]
    for v, row in zip(vectors, rows, strict=True):
        v[0] = quaternion.to_body(q[0], row[:3])
    pulls = [np.zeros(3) for _ in rows]
    apart = np.roll(moments, -1) - np.roll(moments, -2)
    for n in range(order):
        euler = apart * (w[: n + 1].T @ w[n::-1])[[1, 2, 0], [2, 0, 1]]
        slip[n] = packed[9] * euler / moments**2
        turn[n] = w[n] + slip[n]
        if packed[9]:
            euler = euler + _cross((w[: n + 1].T * moments[:, None]) @ slip[n::-1])
        back = turn[n::-1]
        product = q[: n + 1].T @ back
        q[n + 1, :3] = 0.5 * (product[3] + _cross(product[:3])) / (n + 1)
        q[n + 1, 3] = -0.5 * np.trace(product[:3]) / (n + 1)
        torque = -packed[6:9] * w[n]
        if n == 0:
            torque = torque + packed[0:3] + now * packed[3:6]
        elif n == 1:
            torque = torque + packed[3:6]
        for j, (v, row) in enumerate(zip(vectors, rows, strict=True)):
            pull = row[3:12].reshape(3, 3) @ v[n] + _cross(v[: n + 1].T @ (v[n::-1] * row[12:15]))
            torque = torque + (row[15] + now * row[16]) * pull + row[16] * pulls[j]
            pulls[j] = pull
            v[n + 1] = _cross(v[: n + 1].T @ back) / (n + 1)
        w[n + 1] = (euler + torque) / moments / (n + 1)
    return series


def _cross(product: Float) -> Float:
    """Return Σ a × b from the sums a_i b_j, (3, 3)."""
    return np.array([product[1, 2] - product[2, 1], product[2, 0] - product[0, 2], product[0, 1] - product[1, 0]])
