"""Integration of a rolling body through time, by DOP853 and by repeating one nutation.

The state is θ, ω₁, ω₂, ω₃ (axes of the nodes), σ = φ + ψ, δ = φ − ψ, and the horizontal position x, y of the centre of
mass in units of the rim's radius. Half of σ and δ are the arguments of the Cayley–Klein parameters cos(θ/2) e^{iσ/2}
and sin(θ/2) e^{iδ/2}: while the contact runs round the rim of a nearly flat disc, the only one that turns fast is that
which sin(θ/2) keeps from moving the body.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.computing_time import Watch
from inertia.dynamics.models.rolling.equations import RollingBody, angular_acceleration
from inertia.errors import GeometryError
from inertia.records import dataclass

FLAT = 1e-6
"""Where the plane and the rim, or the plane and the centre of mass in units of R, come closer, the body lies down."""

FINEST = 2.5e-14
"""SciPy's DOP853 takes no relative tolerance below 100 ε; to go beyond, its steps are shortened."""


@dataclass(frozen=True, eq=False)
class Nutation:
    """One period of θ between two of its turning points: its start and length in s, the states (8,) at its ends."""

    start: float
    period: float
    before: Float
    after: Float


@dataclass(frozen=True, eq=False)
class Path:
    """The state as a function of time.

    Attributes
    ----------
    state : takes times (n,) in s up to `times[-1]`, gives (8, n)
    times : s, the ends of the steps taken
    nutation : what repeats afterwards; None where the steps reach the end asked for
    flat : s, when the body lies down; None where it does not
    """

    state: Callable[[Float], Float]
    times: Float
    nutation: Nutation | None
    flat: float | None

    def __call__(self, time: Float) -> Float:
        """Return the states (8, n) at `time` (n,) s.

        k nutations turn the path by k Δφ about the vertical: with z = x + iy and D = z(t₀ + T) − z(t₀),
        z(t + kT) = z(t₀) + e^{ikΔφ} (z(t) − z(t₀)) + D (1 + e^{iΔφ} + … + e^{i(k−1)Δφ}).
        """
        if self.nutation is None:
            return np.asarray(self.state(time), dtype=np.float64)
        start, period = self.nutation.start, self.nutation.period
        before, after = self.nutation.before, self.nutation.after
        count = np.where(time > start + period, np.floor((time - start) / period), 0.0)
        y = np.array(self.state(time - count * period), dtype=np.float64)
        gain = after - before
        y[4:6] += count * gain[4:6, None]
        half = 0.5 * math.remainder(0.5 * (gain[4] + gain[5]), 2 * math.pi)
        ratio = np.sin(count * half) / math.sin(half) if half else count
        origin = complex(*before[6:])
        place = origin + np.exp(2j * half * count) * (y[6] + 1j * y[7] - origin)
        place += complex(*gain[6:]) * ratio * np.exp(1j * half * (count - 1))
        y[6], y[7] = place.real, place.imag
        return y


def follow(body: RollingBody, start: Float, end: float, repeat: bool, tolerance: float, share: float = 1.0) -> Path:
    """Integrate from the state `start` (8,) at t = 0 to `end` s or, if `repeat`, over one nutation at most.

    θ moves in a potential of its own, which the Appell–Korteweg constants fix, and so it is periodic unless it tends
    to an unstable steady motion. The nutation is taken between turning points away from the end of θ's range that a
    disc near to lying flat turns at: that turn is too fast to be timed well. Each step is `share` of what `tolerance`
    (relative; for ω near 0, of the pace) would allow.

    DOP853: Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993).
    """
    from scipy.integrate import DOP853, OdeSolution

    rate = pace(body, start)
    absolute = tolerance * np.array([1.0, rate, rate, rate, 1.0, 1.0, 1.0, 1.0])
    solver = DOP853(_equations(body), 0.0, start, end, rtol=tolerance, atol=absolute)
    times, pieces = [0.0], []
    side = 1.0 if start[0] > 0.5 * math.pi else -1.0
    first, nutation, flat, watch = None, None, None, Watch()
    while solver.status == "running" and nutation is None and flat is None:
        was = solver.y
        if message := solver.step():
            raise GeometryError(f"the rolling body cannot be followed beyond t = {solver.t:.6g} s: {message.lower()}")
        watch.require(solver.t / end)
        solver.h_abs *= share
        piece = solver.dense_output()
        times.append(float(solver.t))
        pieces.append(piece)
        if clearance(body, solver.y) <= FLAT:
            flat = _root(lambda t, of=piece: clearance(body, of(t)) - FLAT, times[-2], times[-1])
        elif repeat and (side * was[1] <= 0 < side * solver.y[1] or was[1] == solver.y[1] == 0):
            turn = _root(lambda t, of=piece: of(t)[1], times[-2], times[-1])
            here = np.asarray(piece(turn))
            if first is None:
                first = turn, here
            else:
                nutation = Nutation(first[0], turn - first[0], first[1], here)
    return Path(OdeSolution(times, pieces), np.array(times), nutation, flat)


def pace(body: RollingBody, state: Float) -> float:
    """Return the rate in rad/s that the motion is measured by: √(g/R + ω²) of a state (8,)."""
    return math.sqrt(body.reduced[3] + float(state[1:4] @ state[1:4]))


def clearance(body: RollingBody, state: Float) -> float:
    """Return how far a state (8,) is from lying down: the less of sinθ and the height of the centre of mass over R."""
    s, c = math.sin(state[0]), math.cos(state[0])
    return min(s, s - body.reduced[2] * c)


def _equations(body: RollingBody) -> Callable[[float, Float], list[float]]:
    h = body.reduced[2]

    def derivative(_: float, y: Float) -> list[float]:
        theta, w1, w2, w3, sigma, delta, _, _ = y.tolist()
        s, c, tangent = math.sin(theta), math.cos(theta), math.tan(0.5 * theta)
        phi = 0.5 * (sigma + delta)
        along, across = -h * w2 - w3, w1 * (h * c - s)
        cosine, sine = math.cos(phi), math.sin(phi)
        return [
            w1,
            *angular_acceleration(body, s, c, w1, w2, w3),
            w3 + w2 * tangent,
            w2 / tangent - w3,
            along * cosine - across * sine,
            along * sine + across * cosine,
        ]

    return derivative


def _root(function: Callable[..., Any], low: float, high: float) -> float:
    """Return where `function` changes sign; the upper end where rounding hides the change."""
    from scipy.optimize import brentq

    if function(low) * function(high) > 0:
        return high
    return float(brentq(function, low, high, xtol=1e-15 * high, rtol=1e-15))
