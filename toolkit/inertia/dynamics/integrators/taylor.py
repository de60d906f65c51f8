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
from inertia.dynamics.integrators.error_control import Adaptive, apart_of_three, walk
from inertia.dynamics.integrators.loop import Call, Piece, States, Stepper, Units
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.dynamics.kinematics import quaternion
from inertia.native import Kernel, address

_KERNEL, _SIMPLE = (
    Kernel("inertia.dynamics.integrators.taylor_kernel", name, "ppipidddipidp", fused=True)
    for name in ("advance", "advance_simple")
)

_ROWS, _ROW = 33, 16
"""Rows in a block of the kernel, and numbers in a row. The last row is no coefficient; 30 are, at most."""

_OF_COARSE = 0.5
"""Of the distance d₂ in `apart_of_three`. Errors do not fall evenly with the tolerance, as the order changes with it:
two runs may be off alike, and near each other by chance. Then the error was up to 0.6 d₂, in 20,000 runs."""

_COMPARED = 65
"""Instants at least at which runs are compared."""

STEP_COST = 500
"""A step of the numpy path in units of `native.Kernel.worthwhile`."""


class Taylor(Adaptive):
    """The Taylor method; loads must be polynomial (`terms.Terms`), tables are taken row by row."""

    name = "Taylor"
    order = 20
    keeps_length = True
    tightest = 1e-17
    coarsest = 3e-16
    aside = 0.5
    patience = 2  # where the order changes with the tolerance, estimates jump
    room = 100.0

    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return the run at `control`, and twice `apart_of_three` and what rounding costs (`walk`) as the estimate."""
        instants = time
        if len(time) < _COMPARED:  # runs that have parted may be near each other at a few samples
            instants = np.union1d(time, np.linspace(problem.start, time[-1], _COMPARED))
        fine, middle, coarse = (self.run(problem, instants, control, level) for level in range(3))
        cost = walk(problem, fine, float(time[-1] - problem.start))
        estimate = 2.0 * problem.caution * apart_of_three(fine, middle, coarse, cost, _OF_COARSE) + cost
        at = np.searchsorted(instants, time)
        return States(fine.attitude[at], fine.angular_velocity[at], fine.steps), estimate

    def compiled(self, piece: Piece, control: float, level: int) -> Call | None:
        """Return the kernel where the radians are many."""
        units = piece.units
        radians = 1.0 + (piece.end - piece.start) * piece.problem.rate * (1.0 + units.decay)
        kernel = _SIMPLE if _simple(units) else _KERNEL
        if not kernel.worthwhile(int(min(radians, 1e12)) * STEP_COST):
            return None
        tolerance = self.tolerance(control, level)
        scratch = np.empty((4 + 2 * units.vectors) * _ROWS * _ROW)
        return Call(kernel, units.figures, (order_of(tolerance), tolerance, address(scratch)), (scratch,))

    def stepper(self, piece: Piece, state: Float, control: float, level: int) -> Stepper:
        """Do what the kernel does, one matrix product a coefficient."""
        tolerance = self.tolerance(control, level)
        return _Series(piece.units, state, order_of(tolerance), tolerance)


def order_of(tolerance: float) -> int:
    """Return the order of the series for a tolerance."""
    return min(math.ceil(-0.7 * math.log(tolerance)) + 2, _ROWS - 3)


@functools.lru_cache(maxsize=16)
def _simple(units: Units) -> bool:
    """Say whether the terms are what the simple kernel takes."""
    if units.vectors != 1:
        return False
    return not (units.packed[9] or units.packed[HEAD + 12 : HEAD + 15].any() or units.packed[HEAD + 16])


class _Series(Stepper):
    """Steps of the length that the tolerance allows; the last one as its polynomial."""

    def __init__(self, units: Units, state: Float, order: int, tolerance: float) -> None:
        self._units, self._state, self._order, self._tolerance = units, state, order, tolerance
        self._powers = np.arange(order + 1)
        self._now = self._slack = self._length = 0.0
        self._series = np.empty((0, 7))

    def step(self, target: float) -> str | None:
        """Expand the motion at the end of the last step."""
        if self.steps:
            self._state = self._length**self._powers @ self._series[:, :7]
            self._state[:4] /= np.linalg.norm(self._state[:4])
            ahead = self._length + self._slack
            self._now, self._slack = self._now + ahead, ahead - ((self._now + ahead) - self._now)
        self._series = _series(self._units, self._state, self._now, self._order)
        self._length = _length(self._series, self._order, self._tolerance)
        self.steps += 1
        self.time = self._now + (self._length + self._slack)
        return None if self._length > 0.0 else "where the motion leaves float64"

    def values(self, times: Float) -> Float:
        """Return values of the polynomial, with quaternions of unit length."""
        values = ((times - self._now) - self._slack)[:, None] ** self._powers @ self._series[:, :7]
        values[:, :4] /= np.linalg.norm(values[:, :4], axis=1, keepdims=True)
        return values


def _length(series: Float, order: int, tolerance: float) -> float:
    sizes = np.abs(series[order - 1 :]) / np.maximum(1.0, np.abs(series[0]))
    largest = sizes[:, :7].max(axis=1)
    with np.errstate(divide="ignore"):
        return float(((tolerance / largest) ** (1.0 / np.arange(order - 1, order + 1))).min())


def _series(units: Units, state: Float, now: float, order: int) -> Float:
    """Return the coefficients (order + 1, 13 + 3 k) of q, ω, Ω, Ω − ω and the k vectors in the body."""
    moments, packed = units.moments, units.packed
    rows = packed[HEAD:].reshape(-1, VECTOR)
    series = np.zeros((order + 1, 13 + 3 * len(rows)))
    q, w, turn, slip = series[:, :4], series[:, 4:7], series[:, 7:10], series[:, 10:13]
    q[0], w[0] = state[:4], state[4:]
    vectors = series[:, 13:].reshape(order + 1, -1, 3)
    vectors[0] = quaternion.to_body(q[0], rows[:, :3])
    matrices, squares, weights = rows[:, 3:12].reshape(-1, 3, 3), rows[:, 12:15], rows[:, 15] + now * rows[:, 16]
    pulls = np.zeros((len(rows), 3))
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
        before, pulls = pulls, (matrices @ vectors[n, :, :, None])[:, :, 0]
        pulls += _cross(np.einsum("nki,nkj->kij", vectors[: n + 1], vectors[n::-1] * squares))
        torque = torque + weights @ pulls + rows[:, 16] @ before
        vectors[n + 1] = _cross((series[: n + 1, 13:].T @ back).reshape(-1, 3, 3)) / (n + 1)
        w[n + 1] = (euler + torque) / moments / (n + 1)
    return series


def _cross(product: Float) -> Float:
    """Return Σ a × b, (…, 3), from the sums a_i b_j, (…, 3, 3)."""
    first, second = [1, 2, 0], [2, 0, 1]
    sums: Float = product[..., first, second] - product[..., second, first]
    return sums
