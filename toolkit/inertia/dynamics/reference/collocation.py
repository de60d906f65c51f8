"""Differential equations solved to some thirty digits: Gauss collocation in double-double.

DOP853 in float64 proposes some steps and the solution at their Gauss nodes. There the collocation equations

    y_j = y_0 + h Σ_i a_ji f(y_i),    y_1 = y_0 + h Σ_i b_i f(y_i)

are solved by Newton's method, with the defect in double-double and the Jacobian in float64 (iterative refinement): each
iteration gives some eight digits more. Hairer & Wanner, *Solving Ordinary Differential Equations II* (1996), § IV.5;
Higham, *Accuracy and Stability of Numerical Algorithms* (2002), ch. 12.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.reference.long import Long, Number, plain
from inertia.records import dataclass

Rates = Callable[[Number, Sequence[Number]], Sequence[Number]]
"""Takes the time in s and a state, floats, arrays or `Long`s, to the rates of the state."""

Maker = Callable[[Fraction], Number]
"""Makes a number, a float or a `Long`, of a rational."""

_TOGETHER = 32  # steps, at most
_ITERATIONS = 12
_SETTLED = 1e-29  # of the sizes of the state, that a correction may amount to in the end
_HOPELESS = 1e-3  # of them, beyond which the first one leaves no proportion
_NUDGE = 2.0**-26  # of them, for differences
_MOST_STEPS = 20_000
_SERIES, _CUT = 100, 1e-10


@dataclass(frozen=True, eq=False)
class Equations:
    """What a state of m numbers does.

    Attributes
    ----------
    start : (m,)
    sizes : (m,), what errors of the state are measured by
    rates : takes a way to turn constants, which are exact, into numbers, and the instant in s from which on, up to the
        next break, they are wanted, to the rates
    attitude : takes a state to the attitude of the part axes, a quaternion of any length
    breaks : (k,) s; longest_step : s
    """

    start: Sequence[Long]
    sizes: Float
    rates: Callable[[Maker, float], Rates]
    attitude: Callable[[Sequence[Long]], Sequence[Long]]
    breaks: Float
    longest_step: float = np.inf


@functools.lru_cache(maxsize=4)
def _rule(count: int) -> tuple[Long, Long]:
    """Return the Gauss nodes (s,) on −1 … 1 and the weights (s,)."""
    x = Long(np.polynomial.legendre.leggauss(count)[0])
    for _ in range(2):
        *_, before, last = legendre(x, count)
        slope = (last * x - before) * float(count) / (x * x - 1.0)
        x = x - last / slope
    return x, 2.0 / ((1.0 - x * x) * slope * slope)


def legendre(x: Long, order: int) -> list[Long]:
    """Return Legendre's polynomials of orders 0 to `order`."""
    values = [0.0 * x + 1.0, x]
    for m in range(1, order):
        values.append((x * values[m] * float(2 * m + 1) - values[m - 1] * float(m)) / float(m + 1))
    return values


def integrals(theta: Long, count: int) -> list[Long]:
    """Return, for each node on 0 … 1, the integral of its Lagrange polynomial from 0 to θ.

    ℓ_j = ½ w_j Σ_m (2m + 1) P_m(x_j) P_m by discrete orthogonality, and ∫ P_m = (P_{m+1} − P_{m−1}) / (2 (2m + 1)).
    """
    nodes, weights = _rule(count)
    here, there = legendre(2.0 * theta - 1.0, count), legendre(nodes, count - 1)
    sums = [here[1] + 1.0, *(here[m + 1] - here[m - 1] for m in range(1, count))]
    answer = []
    for j in range(count):
        total = Long(0.0)
        for m in range(count):
            total = total + sums[m] * there[m][j]
        answer.append(0.25 * weights[j] * total)
    return answer


def solved(
    equations: Equations, time: Float, count: int, tolerance: float, affords: Callable[[float], bool]
) -> tuple[list[Long], int] | None:
    """Return the states at instants (n,) s, ascending from 0, as m numbers (n,), and the steps.

    None where that takes too many steps, or more than is afforded, as `affords` says of the share that is done, or
    where Newton's method does not settle.

    Parameters
    ----------
    count : nodes in a step; tolerance : of the float64 solution, relative, which decides the steps
    """
    end = float(time[-1])
    inside = equations.breaks[(equations.breaks > 0) & (equations.breaks < end)].tolist()
    state = list(equations.start)
    answer = [Long(*np.tile([[each.high], [each.low]], (1, len(time)))) for each in state]
    steps, together = 0, _TOGETHER
    for begin, stop in pairwise([0.0, *inside, end]):
        coarse, fine = (equations.rates(number, begin) for number in (float, Long.of))
        at = begin
        while at < stop:
            proposal = _proposed(equations, coarse, state, at, stop, count, tolerance, together)
            if proposal is None:
                return None
            edges, guess = proposal
            steps += len(edges) - 1
            window = _Window(equations, coarse, fine, edges, count)
            refined = window.refined(state, guess)
            if steps > _MOST_STEPS or (refined is None and together == 1):
                return None
            if refined is None:  # neighbours part fast: what is proposed is near for few steps
                together = max(together // 4, 1)
                continue
            together = min(2 * together, _TOGETHER)
            first, last = np.searchsorted(time, [at, float(edges[-1])], side="right")
            for whole, part in zip(answer, window.values(refined, time[first:last]), strict=True):
                whole[first:last] = part
            state = [each[-1] for each in refined[0]]
            at = float(edges[-1])
            if not affords(at / end):
                return None
    return answer, steps


def _proposed(
    equations: Equations,
    rates: Rates,
    state: Sequence[Long],
    at: float,
    stop: float,
    count: int,
    tolerance: float,
    together: int,
) -> tuple[Float, Float] | None:
    """Return the edges (k + 1,) s of some steps of DOP853, and what it makes of the state at their nodes, (m, k, s)."""
    from scipy.integrate import DOP853

    shares = 0.5 + 0.5 * _rule(count)[0].high
    low, high = (np.array([getattr(each, part) for each in state], dtype=float) for part in ("low", "high"))

    def derivative(time: float, y: Float) -> list[float]:
        return [float(x) for x in rates(float(time), y.tolist())]

    with np.errstate(all="ignore"):
        solver = DOP853(
            derivative,
            at,
            high + low,
            stop,
            rtol=tolerance,
            atol=tolerance * equations.sizes,
            max_step=equations.longest_step,
        )
        edges: list[float] = [at]
        guess: list[Float] = []
        while solver.status == "running" and len(guess) < together:
            if solver.step():
                return None
            guess.append(solver.dense_output()(edges[-1] + (solver.t - edges[-1]) * shares))
            edges.append(float(solver.t))
    return np.array(edges), np.stack(guess, axis=1)


class _Window:
    """Some steps, whose states are corrected together: `edges` (k + 1,) s, `count` nodes s in each."""

    def __init__(self, equations: Equations, coarse: Rates, fine: Rates, edges: Float, count: int) -> None:
        self._coarse, self._fine, self._edges, self._count = coarse, fine, edges, count
        self._sizes = equations.sizes
        nodes = 0.5 * (_rule(count)[0] + 1.0)
        self._lengths = (Long(edges[1:]) - edges[:-1])[:, None]
        self._times = edges[:-1, None] + self._lengths * nodes
        self._inner, self._full = _weights(count)
        self._inside = np.array([weight.high for weight in self._inner])  # (i, j), of node i for the state at j

    def refined(self, start: Sequence[Long], guess: Float) -> tuple[list[Long], list[Long]] | None:
        """Return the state at the edges, m numbers (k + 1,), and its rates at the nodes, m numbers (k, s)."""
        m, k, s = guess.shape
        slopes = self._jacobian(guess)
        if not np.isfinite(slopes).all():
            return None
        carried = self._within(slopes, np.broadcast_to(np.eye(m), (k, s, m, m)))
        onward = self._onward(slopes, carried)
        nodes = [Long(each) for each in guess]
        edges = []
        for each, at_nodes in zip(start, guess, strict=True):
            first = np.concatenate([[each.high], at_nodes[:, -1]])
            edges.append(Long(first, np.concatenate([[each.low], np.zeros(k)])))
        for _ in range(_ITERATIONS):
            rates = [self._shaped(each, (k, s)) for each in self._fine(self._times, nodes)]
            sums = [self._integrated(each) for each in rates]
            stages, steps = zip(edges, nodes, sums, strict=True), zip(edges, sums, strict=True)
            defect = np.stack([(edge[:-1, None] + inside - node).high for edge, node, (inside, _) in stages], axis=-1)
            jump = np.stack([(edge[:-1] + whole - edge[1:]).high for edge, (_, whole) in steps], axis=-1)
            own = self._within(slopes, defect[..., None])
            ends = jump + self._onward(slopes, own)[..., 0]
            moved = np.zeros((k + 1, m))
            for j in range(k):
                moved[j + 1] = moved[j] + onward[j] @ moved[j] + ends[j]
            change = own[..., 0] + (carried @ moved[:-1, None, :, None])[..., 0]
            nodes = [node + change[..., a] for a, node in enumerate(nodes)]
            edges = [edge + moved[:, a] for a, edge in enumerate(edges)]
            largest = float((np.abs(change).max(axis=(0, 1)) / self._sizes).max())
            if not largest < _HOPELESS:
                return None
            if largest < _SETTLED:
                return edges, rates
        return None

    def _within(self, slopes: Float, begun: Float) -> Float:
        """Solve X = B + h A J X for X (k, s, m, …) in each step, whose terms fall as those of an exponential series."""
        answer = term = begun
        for _ in range(_SERIES):
            term = self._lengths.high[:, :, None, None] * np.einsum("ij,kiab->kjab", self._inside, slopes @ term)
            answer = answer + term
            if not np.abs(term).max() > _CUT * np.abs(answer).max():
                break
        return np.asarray(answer)

    def _onward(self, slopes: Float, inside: Float) -> Float:
        """Return the change (k, m, …) over each step that changes (k, s, m, …) inside make."""
        return np.asarray(self._lengths.high[:, :, None] * np.einsum("i,kiab->kab", self._full.high, slopes @ inside))

    def values(self, refined: tuple[list[Long], list[Long]], time: Float) -> list[Long]:
        """Return the state at instants (n,) s within the steps, m numbers (n,)."""
        edges, rates = refined
        step = np.clip(np.searchsorted(self._edges, time, side="left") - 1, 0, len(self._edges) - 2)
        length = self._lengths[:, 0][step]
        weights = integrals((Long(time) - self._edges[step]) / length, self._count)
        answer = []
        for edge, rate in zip(edges, rates, strict=True):
            total = Long(0.0)
            for j, weight in enumerate(weights):
                total = total + weight * rate[step, j]
            answer.append(edge[step] + length * total)
        return answer

    def _jacobian(self, state: Float) -> Float:
        """Return the derivatives (k, s, m, m) of the rates at states (m, k, s), by central differences."""
        m, *shape = state.shape
        times, slopes = np.asarray(self._times.high), np.empty((*shape, m, m))
        for b in range(m):
            nudge = _NUDGE * self._sizes[b]
            ends = []
            for way in (1.0, -1.0):
                there = list(state)
                there[b] = state[b] + way * nudge
                ends.append(np.stack([np.broadcast_to(x, shape) for x in self._coarse(times, there)], axis=-1))
            slopes[..., b] = (ends[0] - ends[1]) / (2.0 * nudge)
        return slopes

    def _integrated(self, rate: Long) -> tuple[Long, Long]:
        """Return the integrals of a rate (k, s) up to each node, (k, s), and over the steps, (k,)."""
        inside, whole = Long(0.0), Long(0.0)
        for i, weights in enumerate(self._inner):
            inside = inside + weights * rate[:, i, None]
            whole = whole + self._full[i] * rate[:, i]
        return self._lengths * inside, self._lengths[:, 0] * whole

    @staticmethod
    def _shaped(value: Any, shape: tuple[int, int]) -> Long:
        return (value if isinstance(value, Long) else Long(plain(value))).over(shape)


@functools.lru_cache(maxsize=4)
def _weights(count: int) -> tuple[list[Long], Long]:
    """Return, for each node, its weights (s,) in the integrals up to every node; and those over the whole, (s,)."""
    inner = integrals(0.5 * (_rule(count)[0] + 1.0), count)
    full = integrals(Long(np.ones(1)), count)
    return inner, Long(*(np.array([getattr(each, part)[0] for each in full]) for part in ("high", "low")))
