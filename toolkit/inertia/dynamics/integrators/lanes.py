"""The Taylor method on many bodies at once, each with steps of its own and an estimate of its own error.

The series are those of `inertia.dynamics.integrators.taylor`; here every number of a body stands beside the same number
of others, so that one vector instruction serves eight of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float
from inertia.dynamics.integrators.loop import EPS
from inertia.dynamics.integrators.taylor import STEP_COST, Taylor, order_of
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.dynamics.kinematics import quaternion
from inertia.native import Kernel, address
from inertia.records import dataclass

_KERNEL = Kernel("inertia.dynamics.integrators.lanes_kernel", "follow_bodies", "piiipiiddppp", fused=True)
_ROWS, _WORK, _FORCE = 33, 23, 12  # of the kernel

MOST_STEPS = 1e6
"""Steps of a body; one that needs more is not followed here."""

_ATTEMPTS = 3
_SAFETY = 5.0
_METHOD = Taylor()


@dataclass(frozen=True, eq=False)
class Bodies:
    """Rigid bodies that turn about their reference points under loads that are constant or linear in time, by pieces.

    Attributes
    ----------
    moments : (m, 3) kg m², principal; attitude : (m, 4), principal axes to space
    angular_velocity : (m, 3) rad/s along the principal axes
    terms : (m, HEAD + VECTOR k), `terms.Terms.packed` in SI units; no dissipation or slope
    later : from which instants on, s and ascending, other terms hold, and these
    """

    moments: Float
    attitude: Float
    angular_velocity: Float
    terms: Float
    later: tuple[tuple[float, Float], ...] = ()

    @property
    def vectors(self) -> int:
        """How many vectors fixed in space the loads have."""
        return int(self.terms.shape[1] - HEAD) // VECTOR

    def some(self, rows: NDArray[np.intp]) -> Bodies:
        """Return some of them."""
        later = tuple((start, terms[rows]) for start, terms in self.later)
        return Bodies(self.moments[rows], self.attitude[rows], self.angular_velocity[rows], self.terms[rows], later)

    def aside(self, level: int) -> Bodies:
        """Return bodies that begin a few roundings aside, with moments that are, as `loop.begin` does."""
        nudge = EPS * np.array([(1.0, -1.0, 1.0), (1.0, 1.0, -1.0)][level - 1])
        return replace(
            self,
            moments=self.moments * (1.0 + 2.0 * nudge),
            attitude=quaternion.multiply(self.attitude, (*(4.0 * nudge), 1.0)),
            angular_velocity=self.angular_velocity * (1.0 + nudge),
        )

    @property
    def rates(self) -> Float:
        """The units (m,) of 1/time in 1/s, as `RotationProblem.rate`: powers of two."""
        spin = np.linalg.norm(self.angular_velocity, axis=1)
        torque = self.terms[:, :3] - self.terms[:, 6:9] * self.angular_velocity
        for k in range(self.vectors):
            row = self.terms[:, HEAD + VECTOR * k : HEAD + VECTOR * (k + 1)]
            v = quaternion.to_body(self.attitude, row[:, :3])
            pull = np.einsum("mij,mj->mi", row[:, 3:12].reshape(-1, 3, 3), v) + np.cross(v, row[:, 12:15] * v)
            torque = torque + row[:, 15:16] * pull
        swing = np.sqrt(np.abs(torque / self.moments).max(axis=1))
        ramp = np.cbrt(np.abs(self.terms[:, 3:6] / self.moments).max(axis=1))
        rate = np.maximum(np.maximum(spin, swing), ramp)
        return np.ldexp(1.0, np.frexp(np.where(rate > 0, rate, 1.0))[1])

    def numbers(self, rates: Float) -> Float:
        """Return what the kernel takes of each: moments, attitude, spin, unit of 1/time, terms, in its own units."""
        inertia = np.ldexp(1.0, np.frexp(self.moments.max(axis=1))[1])[:, None]
        rate = rates[:, None]
        torque = inertia * rate**2
        terms = np.empty_like(self.terms)
        terms[:, 0:3] = self.terms[:, 0:3] / torque
        terms[:, 3:6] = self.terms[:, 3:6] / (torque * rate)
        terms[:, 6:9] = self.terms[:, 6:9] / (inertia * rate)
        terms[:, 9] = 0.0
        for at in range(HEAD, terms.shape[1], VECTOR):
            terms[:, at : at + 15] = self.terms[:, at : at + 15]
            terms[:, at + 15] = self.terms[:, at + 15] / torque[:, 0]
            terms[:, at + 16] = 0.0
        return np.concatenate(
            [self.moments / inertia, self.attitude, self.angular_velocity / rate, rate, terms], axis=1
        )


def fits(terms: Float) -> bool:
    """Say whether packed terms (m, …) are what this takes: no dissipation, and no vector whose torque grows."""
    vectors = terms[:, HEAD:].reshape(len(terms), (terms.shape[1] - HEAD) // VECTOR, VECTOR)
    return not (terms[:, 9].any() or (vectors[:, :, :3] * vectors[:, :, 16:]).any())


def solve_bodies(bodies: Bodies, time: Float, accuracy: float) -> tuple[Float, Float, Float]:
    """Return attitudes (m, n, 4), spins (m, n, 3) and the error (m,) rad that each reaches; infinite where it is lost.

    Each motion is followed three times, at tolerances that grow tenfold and from starts that are roundings aside, and
    the error is estimated from how far these are apart. Those that do not reach the accuracy are followed again at a
    tighter tolerance. What comes out of a body does not depend on the others.
    """
    count, duration = len(bodies.moments), float(time[-1])
    attitude, spin = np.full((count, len(time), 4), np.nan), np.full((count, len(time), 3), np.nan)
    reached = np.full(count, np.inf)
    for rows, first in tolerances(bodies, time, accuracy):
        control, left = first, rows
        for _ in range(_ATTEMPTS):
            some = bodies.some(left)
            begun = [some, some.aside(1), some.aside(2)]
            runs = [follow_bodies(each, time, _METHOD.tolerance(control, level)) for level, each in enumerate(begun)]
            error = _estimate(runs, duration)
            better = error < reached[left]
            at = left[better]
            attitude[at], spin[at], reached[at] = runs[0][0][better], runs[0][1][better], error[better]
            left = left[~(reached[left] <= accuracy)]
            if not left.size or control <= _METHOD.tightest:
                break
            control = max(1e-2 * control, _METHOD.tightest)
    return attitude, spin, reached


def tolerances(bodies: Bodies, time: Float, accuracy: float) -> Iterator[tuple[NDArray[np.intp], float]]:
    """Yield the bodies to which one tolerance goes that probably reaches an accuracy in rad, with it.

    It is that of `error_control.Adaptive.first`, with the angle turned through rounded up to a power of two.
    """
    phase = np.frexp(1.0 + bodies.rates * float(time[-1]))[1]
    for each in np.unique(phase).tolist():
        yield np.flatnonzero(phase == each), min(max(accuracy / (30.0 * 2.0**each), _METHOD.tightest), 1e-3)


def _estimate(runs: list[tuple[Float, Float]], duration: float) -> Float:
    """Return the error (m,) of the first of three runs: 5 max(d₁, min(d₂, 3 d₁), 0.3 d₂) + ε (2 + θ (2 + √θ/2)).

    d₁ and d₂ are the distances of each run from the next, θ is the angle turned through, with a step a radian, whose
    rounding errors walk at random.
    """
    near, far = (quaternion.angle_between(one[0], other[0]).max(axis=1) for one, other in pairwise(runs))
    apart = np.maximum(near, np.maximum(np.minimum(far, 3.0 * near), 0.3 * far))
    turned = np.linalg.norm(runs[0][1], axis=2).max(axis=1) * duration
    error: Float = _SAFETY * apart + EPS * (2.0 + turned * (2.0 + 0.5 * np.sqrt(turned)))
    return np.where(np.isfinite(error), error, np.inf)


def follow_bodies(bodies: Bodies, time: Float, tolerance: float) -> tuple[Float, Float]:
    """Return attitudes (m, n, 4) and spins (m, n, 3); not numbers where a body is lost."""
    attitude, spin = np.empty((len(bodies.moments), len(time), 4)), np.empty((len(bodies.moments), len(time), 3))
    here, start, first = replace(bodies, later=()), 0.0, 0
    for end, terms in bodies.later:
        last = int(np.searchsorted(time, end, side="right"))
        states, spins = _follow_piece(here, np.append(time[first:last], end) - start, tolerance)
        attitude[:, first:last], spin[:, first:last] = states[:, :-1], spins[:, :-1]
        here = Bodies(bodies.moments, states[:, -1], spins[:, -1], terms)
        start, first = end, last
    attitude[:, first:], spin[:, first:] = _follow_piece(here, time[first:] - start, tolerance)
    return attitude, spin


def _follow_piece(bodies: Bodies, time: Float, tolerance: float) -> tuple[Float, Float]:
    """Return the states at instants (n,) s from the start of a piece on."""
    order, rates = order_of(tolerance), bodies.rates
    numbers = np.ascontiguousarray(bodies.numbers(rates))
    rows = np.full((len(numbers), len(time), 7), np.nan)
    radians = float((rates * time[-1] + 1.0).sum())
    instants = np.array(time)
    if _KERNEL.worthwhile(int(min(radians, 1e12)) * STEP_COST):
        squares = bool(bodies.terms[:, HEAD:].reshape(len(numbers), -1, VECTOR)[:, :, 12:15].any())
        steps = np.zeros(len(numbers))
        scratch = np.empty((7 + 3 * bodies.vectors + _WORK + _FORCE * bodies.vectors + 8) * _ROWS * 8)
        _KERNEL.function(
            address(numbers),
            len(numbers),
            bodies.vectors,
            squares,
            address(instants),
            len(instants),
            order,
            tolerance,
            MOST_STEPS,
            address(rows),
            address(steps),
            address(scratch),
        )
    else:
        _follow(numbers, instants, order, tolerance, rows)
    return rows[:, :, :4], rows[:, :, 4:]


def _follow(numbers: Float, time: Float, order: int, tolerance: float, rows: Float) -> None:
    """Do what the kernel does, all bodies side by side."""
    moments, rates, terms = numbers[:, :3], numbers[:, 10], numbers[:, 11:]
    state = numbers[:, 3:10].copy()
    now, slack = np.zeros(len(numbers)), np.zeros(len(numbers))
    sample = np.zeros(len(numbers), dtype=np.int64)
    targets = np.append(time, np.inf)
    alive = np.arange(len(numbers))
    powers = np.arange(order + 1)
    for _ in range(int(MOST_STEPS)):
        if not alive.size:
            return
        with np.errstate(all="ignore"):
            series = _series(moments[alive], terms[alive], state[alive], now[alive], order)
            sizes = np.abs(series[:, order - 1 :, :7]) / np.maximum(1.0, np.abs(series[:, :1, :7]))
            sizes[:, :, :4] = np.abs(series[:, order - 1 :, :4])
            lengths = (tolerance / sizes.max(axis=2)) ** (1.0 / powers[order - 1 :])
            reach = lengths.min(axis=1)
            while True:
                ahead = (targets[sample[alive]] * rates[alive] - now[alive]) - slack[alive]
                (due,) = np.nonzero((ahead <= reach) & (sample[alive] < len(time)))
                if not due.size:
                    break
                values = np.einsum("mn,mnk->mk", ahead[due, None] ** powers, series[due, :, :7])
                values[:, :4] = quaternion.normalise(values[:, :4])
                values[:, 4:] *= rates[alive[due], None]
                rows[alive[due], sample[alive[due]]] = values
                sample[alive[due]] += 1
            going = (sample[alive] < len(time)) & (reach > 0) & np.isfinite(reach)
            alive, series, reach = alive[going], series[going], reach[going]
            state[alive] = np.einsum("mn,mnk->mk", reach[:, None] ** powers, series[:, :, :7])
            state[alive, :4] = quaternion.normalise(state[alive, :4])
        span = reach + slack[alive]
        later = now[alive] + span
        slack[alive] = span - (later - now[alive])
        now[alive] = later
        alive = alive[np.isfinite(state[alive]).all(axis=1)]


def _series(moments: Float, terms: Float, state: Float, now: Float, order: int) -> Float:
    """Return the coefficients (m, order + 1, 7 + 3 k) of q, ω and the k vectors in the body."""
    loads = terms[:, HEAD:].reshape(len(terms), -1, VECTOR)
    count = loads.shape[1]
    series = np.zeros((len(moments), order + 1, 7 + 3 * count))
    series[:, 0, :7] = state
    vectors = [slice(7 + 3 * k, 10 + 3 * k) for k in range(count)]
    for k, at in enumerate(vectors):
        series[:, 0, at] = quaternion.to_body(state[:, :4], loads[:, k, :3])
    euler = (np.roll(moments, -1, axis=1) - np.roll(moments, -2, axis=1)) / moments
    for n in range(order):
        past, back = series[:, : n + 1], series[:, n::-1]
        spin = back[:, :, 4:7]
        product = np.einsum("mni,mnj->mij", past[:, :, :4], spin)
        turn = np.empty((len(moments), 4))
        turn[:, :3] = product[:, 3] + _cross(product[:, :3])
        turn[:, 3] = -np.trace(product[:, :3], axis1=1, axis2=2)
        series[:, n + 1, :4] = 0.5 * turn / (n + 1)
        square = np.einsum("mni,mnj->mij", past[:, :, 4:7], spin)
        torque = -terms[:, 6:9] * series[:, n, 4:7]
        if n == 0:
            torque = torque + terms[:, :3] + now[:, None] * terms[:, 3:6]
        elif n == 1:
            torque = torque + terms[:, 3:6]
        for k, at in enumerate(vectors):
            load, v = loads[:, k], past[:, :, at]
            pull = np.einsum("mij,mj->mi", load[:, 3:12].reshape(-1, 3, 3), series[:, n, at])
            if load[:, 12:15].any():
                pull = pull + _cross(np.einsum("mni,mnj->mij", v, back[:, :, at] * load[:, None, 12:15]))
            torque = torque + load[:, 15:16] * pull
            series[:, n + 1, at] = _cross(np.einsum("mni,mnj->mij", v, spin)) / (n + 1)
        rate = euler * square[:, (1, 2, 0), (2, 0, 1)] + torque / moments
        series[:, n + 1, 4:7] = rate / (n + 1)
    return series


def _cross(product: Float) -> Float:
    """Return Σ a × b from the sums a_i b_j, (m, 3, 3)."""
    difference = product - np.swapaxes(product, 1, 2)
    return np.stack([difference[:, 1, 2], difference[:, 2, 0], difference[:, 0, 1]], axis=1)
