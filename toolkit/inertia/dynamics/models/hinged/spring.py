"""The swing of a body on an axle by a spring, and by its weight: its turning angles, and the period between them.

With the time in √(I/k), F = θ̇² is by the energy a function of the angle,

    F(θ) = r + 2 n θ − θ² + 2 a sin θ + 2 b (1 − cos θ),    r = I ω²/k,  n = N/k,  a = A/k,  b = B/k,

and it swings between the zeros of F next to the start, T = 2 ∫ dθ/√F. Near an unstable rest F and F′ nearly vanish
together, and T depends on what is left of them: there they are differences of near numbers, in double-double.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from itertools import pairwise

import numpy as np

from inertia.dynamics.special.double_double import (
    PI,
    ZERO,
    Pair,
    add,
    divide,
    minus,
    multiply,
    of,
    of_fraction,
    sine_and_cosine,
    times,
)
from inertia.records import dataclass

_STEPS = 10_000  # towards a turning angle
_LARGEST = 1e100  # of r, n, a and b: what is beyond leaves float64 when multiplied
_ROUNDING = 2.0**-100  # of the terms of F, that F may be off by
_PLAIN = 2.0**-44  # the same in float64
_SHARE = 2.0**-10  # of its terms, above which F is taken in float64
_SHORTER = 1.0 - 2.0**-48  # of a step, so that its rounding leads over no zero
_CLEAR = 8.0  # times what it takes for F to become negative, that F′ is there
_KNOWN = 1e-12  # relative, of what decides the period at an end or at a rest: the period is off by a hundredth of that
_FEWEST, _FEW, _MOST = 16, 1 << 11, 1 << 16  # nodes of the integral: the most where rests are few, and where many
_PARTS, _WIDE = 128, 4.0  # nodes from one rest half way to the next, and the t that they go to
_RESTS = 32  # that it may pass, to be taken one by one
_HALVINGS = 60  # of the distance between nodes: neighbours in float64 are left
_CHUNK = 1 << 11
_SETTLED = 1e-12  # relative, between twice as many nodes and as many: the error is of the order of its square
_SETTLING = 1e-4  # the same one step before, so that no chance makes it small


@dataclass(frozen=True)
class SprungAxle:
    """The figures r, n, a and b of F, as pairs.

    >>> wheel = SprungAxle.of({"inertia": 2, "spin": 3, "torque": 0, "stiffness": 8, "cosine": 0, "sine": 0})
    >>> low, high = (wheel.turning_angle(side) for side in (-1.0, 1.0))
    >>> low[0], high[0], wheel.period(low, high) / math.pi
    (-1.5, 1.5, 2.0)
    """

    energy: Pair
    torque: Pair
    cosine: Pair
    sine: Pair

    @classmethod
    def of(cls, figures: Mapping[str, Fraction]) -> SprungAxle | None:
        """Take the figures of an axle; None where they are beyond all reason."""
        inertia, spin, stiffness = (Fraction(figures[name]) for name in ("inertia", "spin", "stiffness"))
        scaled = (
            inertia * spin * spin / stiffness,
            *(figures[name] / stiffness for name in ("torque", "cosine", "sine")),
        )
        if max(map(abs, scaled)) > _LARGEST:
            return None
        return cls(*map(of_fraction, scaled))

    def turning_angle(self, side: float) -> Pair | None:
        """Return the first angle, rad, at which F vanishes on one side (±1) of the start.

        None where that takes too many steps, or where it is so near an unstable rest that nothing tells whether F
        vanishes. |F″| ≤ M = 2 (1 + √(a² + b²)): a step to where the parabola of curvature −M through F and F′ meets
        zero passes no zero of F, and converges as Newton's do.
        """
        bend, angle = self._bend, ZERO
        for _ in range(_STEPS):
            value, slope, doubt = self._near(angle, side)
            least = max(value - doubt, 0.0)
            if least <= doubt and (angle[0] or slope <= 0):
                return self._refined(angle) if slope < 0 and slope * slope > _CLEAR * bend * doubt else None
            reach = math.sqrt(slope * slope + 2.0 * bend * least)
            step = (slope + reach) / bend if slope > 0 else 2.0 * least / (reach - slope)
            angle = add(angle, of(side * step * _SHORTER))
        return None

    def period(self, low: Pair, high: Pair) -> float | None:
        """Return the period in √(I/k) between turning angles; None where neither rule for the integral settles."""
        if not (self._is_known(low) and self._is_known(high)):
            return None
        few = partial(self._by_midpoints, low, high)
        period = _settled(few, _FEWEST, _FEW)
        if period is not None:
            return period
        rests = self._passed(low, high)
        if rests is None:
            return _settled(few, _FEW, _MOST)
        return _settled(partial(self._by_parts, low, rests, high), _PARTS, _FEW)

    @property
    def _bend(self) -> float:
        """M, the most that F″ is."""
        return 2.0 * (1.0 + math.hypot(self.cosine[0], self.sine[0]))

    def _refined(self, angle: Pair) -> Pair:
        """Return a zero of F by Newton's method from next to it; the start is left as it is."""
        for _ in range(2 if angle[0] else 0):
            angle = add(angle, of(-self._value(angle) / self._chord(angle, None)[0]))
        return angle

    def _is_known(self, end: Pair) -> bool:
        """Whether a zero of F is known in proportion to how far it is from the next one, F′/M at least."""
        return self._bend * _ROUNDING * self._size(end[0]) < _KNOWN * float(self._chord(end, None)[0]) ** 2

    def _near(self, angle: Pair, side: float) -> tuple[float, float, float]:
        """Return F, F′ towards a side, and how far F may be off: in float64 where that does."""
        at, size = angle[0], self._size(angle[0])
        middle, sinc = 0.5 * at, float(np.sinc(0.5 * at / np.pi))
        whole = self.torque[0] - middle + (self.cosine[0] * math.cos(middle) + self.sine[0] * math.sin(middle)) * sinc
        value = self.energy[0] + 2.0 * at * whole
        if value > _SHARE * size:
            slope = self.torque[0] - at + self.cosine[0] * math.cos(at) + self.sine[0] * math.sin(at)
            return value, 2.0 * side * slope, _PLAIN * size
        return self._value(angle), side * self._chord(angle, None)[0], _ROUNDING * size

    def _size(self, angle: float) -> float:
        """Return what the terms of F are, at most."""
        pull = math.hypot(self.cosine[0], self.sine[0])
        size: float = self.energy[0] + 2.0 * abs(angle) * (abs(self.torque[0]) + 0.5 * abs(angle) + pull)
        return size

    def _value(self, angle: Pair) -> float:
        """Return F, from double-double."""
        half = times(angle, 0.5)
        value: float = add(self.energy, multiply(angle, self._chord(half, half)))[0] if angle[0] else self.energy[0]
        return value

    def _chord(self, middle: Pair, half: Pair | None) -> Pair:
        """Return (F(m + h) − F(m − h))/2h, or F′(m) without h: no difference of near numbers but what F has itself."""
        sine, cosine = sine_and_cosine(middle)
        pull = add(multiply(self.cosine, cosine), multiply(self.sine, sine))
        if half is not None:
            pull = multiply(pull, divide(sine_and_cosine(half)[0], half))
        return times(add(add(self.torque, minus(middle)), pull), 2.0)

    def _by_midpoints(self, low: Pair, high: Pair, nodes: int) -> float:
        """Return 2 ∫ dχ/√G, G = F/((θ − low)(high − θ)); F over the distance from the nearer end is a chord.

        θ = ½ (low + high) + ½ (high − low) sin χ makes the integrand periodic in χ.
        """
        across = add(high, minus(low))
        total = 0.0
        for first in range(0, nodes // 2, _CHUNK):
            count = np.arange(first, min(first + _CHUNK, nodes // 2)) + 0.5
            sine, _ = sine_and_cosine(times(times(PI, count), 0.5 / nodes))  # of half what χ lacks of ½π
            half = times(multiply(multiply(sine, sine), across), 0.5)
            far = add(across, times(half, -2.0))[0]
            for end, side in ((low, 1.0), (high, -1.0)):
                shape = side * self._chord(add(end, times(half, side)), half)[0] / far
                if not (shape > 0).all():
                    return math.nan
                total += float(np.sum(1.0 / np.sqrt(shape)))
        return 2.0 * math.pi / nodes * total

    def _passed(self, low: Pair, high: Pair) -> list[tuple[Pair, float]] | None:
        """Return the unstable rests between two angles, and F there; None where these are many, or F is lost there."""
        angles = np.linspace(low[0], high[0], _FEW + 1)
        slopes = self._chord(of(angles), None)[0]
        starts = angles[1:][(slopes[:-1] < 0) & (slopes[1:] >= 0)]
        if len(starts) > _RESTS:
            return None
        rests = []
        for start, before in zip(starts.tolist(), (starts - (angles[1] - angles[0])).tolist(), strict=True):
            angle = self._rest(before, start)
            value = self._value(angle)
            if not _ROUNDING * self._size(angle[0]) < _KNOWN * value:
                return None
            rests.append((angle, value))
        return rests

    def _rest(self, below: float, above: float) -> Pair:
        """Return the zero of F′ between two angles, F′ being negative at the first one."""
        for _ in range(_HALVINGS):
            middle = 0.5 * (below + above)
            below, above = (middle, above) if self._chord(of(middle), None)[0] < 0 else (below, middle)
        low, high = self._chord(of(below), None)[0], self._chord(of(above), None)[0]
        return add(of(below), of((above - below) * low / (low - high))) if low < high else of(below)

    def _by_parts(self, low: Pair, rests: list[tuple[Pair, float]], high: Pair, nodes: int) -> float:
        """Return 2 ∫ dθ/√F, from each turning angle and each rest half way to the next of them.

        x away from it, F is F(0) + x × chord, and x = l/(1 + exp(−π sinh t)): what is near in x is as far away in t as
        all else. Midpoints in t.
        """
        t = _WIDE * ((np.arange(nodes) + 0.5) / nodes * 2.0 - 1.0)
        share = 1.0 / (1.0 + np.exp(-math.pi * np.sinh(t)))
        weight = 2.0 * _WIDE / nodes * math.pi * np.cosh(t) * share / (1.0 + np.exp(math.pi * np.sinh(t)))
        ends = [(low, 0.0), *rests, (high, 0.0)]
        total = 0.0
        for (left, value), (right, other) in pairwise(ends):
            length = 0.5 * add(right, minus(left))[0]
            half = of(0.5 * length * share)
            for end, least, side in ((left, value, 1.0), (right, other, -1.0)):
                chord = self._chord(add(end, times(half, side)), half)[0]
                square = least + side * length * share * chord
                if not (square > 0).all():
                    return math.nan
                total += length * float(np.sum(weight / np.sqrt(square)))
        return 2.0 * total


def _settled(rule: Callable[[int], float], fewest: int, most: int) -> float | None:
    """Return what a rule that squares its error with twice the nodes settles on; None where it does not."""
    before, change, nodes = math.inf, math.inf, fewest
    while nodes <= most:
        value = rule(nodes)
        last, change = change, abs(value - before)
        if change <= _SETTLED * value and last <= _SETTLING * value:
            return value
        before, nodes = value, 2 * nodes
    return None
