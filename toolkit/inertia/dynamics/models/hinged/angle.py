"""The angle of a body on a fixed axle: I θ̈ = N − c θ̇ − k θ + A cos θ + B sin θ, from θ = 0 on.

What is linear, and the pendulum (N = c = k = 0), have closed forms; the rest is stepped by Taylor series, whose steps
damping keeps as short as its decay time, or where that would be many of them by collocation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.computing_time import Watch
from inertia.dynamics.models.hinged.axle import Axle
from inertia.dynamics.models.hinged.collocation import NODES, collocated
from inertia.dynamics.models.rational import root
from inertia.dynamics.special import double_double
from inertia.errors import GeometryError
from inertia.records import dataclass

if TYPE_CHECKING:
    from inertia.dynamics.models.heavy.nutation import Nutation
    from inertia.dynamics.models.heavy.top import State

_EPS = 2.0**-52
_ORDER = 24
_LEVELS = (1.0, 0.7)  # of the step, in runs that are compared
_ORDINARY = 30  # as an exponent of 2: rates up to that, in rad/s, are taken in seconds
_STEP = 1e-19  # that the last terms of the series may amount to
_STIFF = 1e3  # decay times of the damping in a run, above which it is not stepped by series
_SMALL = 0.3  # below which a difference is summed as a series
_NUDGE = 2.0**-26  # relative, the most that a figure is changed by to see what that does to the angle
_NOISE = 2.0**-36  # the same of every step: collocation would resolve how more dies away
_LESS = 2.0**-9  # of a nudge that does too much
_INSTANTS = 257  # beside the samples, at which that is looked for: what parts may have met again by the end
_NEAR = 1e-3  # rad, within which what it does is in proportion to it
_TURN = 2.0 * math.pi
_LOST = 1e-2  # rad, from which on it is not, and nothing is known


Figures = Mapping[str, Fraction]
"""Those of an `Axle`, by name, before they are rounded."""


@dataclass(frozen=True, eq=False)
class Swing:
    """The angle of a body on an axle.

    Attributes
    ----------
    angle, rate : (n,) rad and rad/s; turn : (n,) rad, the angle up to whole turns, with the digits that those take
    off : rad, how far `turn` may be off
    method : that gave it
    """

    angle: Float
    rate: Float
    turn: Float
    off: float
    method: str


def solve_angle(figures: Figures, time: Float, known: Mapping[str, float]) -> Swing:
    """Return θ at the instants (n,) s, ascending from 0, of an axle with these figures.

    `known` is how far each of them may be off. What that does to the angle grows as neighbouring motions part,
    exponentially near the upper rest.
    """
    solve, method = _method(figures, float(time[-1]))
    angle, rate, turn, off = solve(figures, time)
    rounded = axle_of(figures)
    instants = np.union1d(time, np.linspace(0.0, float(time[-1]), _INSTANTS))
    path = None
    for name, value in figures.items():
        doubt = known.get(name, 0.0)
        if solve is not _pendulum:
            doubt += float(abs(value - Fraction(float(value))))
        if not doubt:
            continue
        path = solve(figures, instants)[0] if path is None else path
        size = max(abs(float(value)), rounded.pull if name in ("cosine", "sine") else 0.0, doubt)

        def moved(nudge: float, name: str = name, size: float = size) -> Float:
            return solve({**figures, name: figures[name] + Fraction(nudge * size)}, instants)[0]

        off += doubt / size * _slope(moved, path, doubt / size)
    return Swing(angle, rate, turn, off if off < _LOST else math.pi, method)


def axle_of(figures: Figures) -> Axle:
    """Return figures as float64."""
    return Axle(**{name: float(value) for name, value in figures.items()})


def _slope(moved: Callable[[float], Float], path: Float, least: float, most: float = _NUDGE) -> float:
    """Return how much the angle (n,) moves for a nudge: the largest of some, for far neighbours part no more.

    Nudges shrink from `most` until what they do is in proportion to them, at every instant, to `least`, which is what
    counts.
    """
    nudge, slope = max(most, least), 0.0
    while True:
        apart = float(np.abs(moved(nudge) - path).max())
        slope = max(slope, apart / nudge)
        if apart < _NEAR or nudge <= least:
            return slope
        nudge = max(nudge * _LESS, least)


_Solution = tuple[Float, Float, Float, float]
_March = Callable[..., tuple[Float, Float]]
"""Takes an axle, instants, a part of the step and a relative noise to θ and θ̇: `_series` or `collocated`."""


def _method(figures: Figures, duration: float) -> tuple[Callable[[Figures, Float], _Solution], str]:
    if not (figures["cosine"] or figures["sine"]):
        return _linear, "closed form: exponentials" if figures["damping"] or figures["stiffness"] else "closed form"
    if not (figures["torque"] or figures["damping"] or figures["stiffness"]):
        return _pendulum, "closed form: Jacobi elliptic functions"
    if figures["damping"] * Fraction(duration) > figures["inertia"] * Fraction(_STIFF):
        return partial(_stepped, march=collocated), f"Radau collocation of {NODES} nodes"
    return partial(_stepped, march=_series), f"Taylor series of order {_ORDER}"


def _linear(figures: Figures, time: Float) -> _Solution:
    angle, rate, off = linear(axle_of(figures), time)
    return angle, rate, angle, off


def linear(axle: Axle, time: Float) -> tuple[Float, Float, float]:
    """Return angle, rate and how far the angle may be off, of a free or driven axle with damping or a spring.

    With x = c t/I and no spring, θ = ω₀ t φ₁(x) + (N/I) t² φ₂(x), φ₁ = (1 − e⁻ˣ)/x and φ₂ = (e⁻ˣ − 1 + x)/x².
    """
    drive = axle.torque / axle.inertia
    half, square = 0.5 * axle.damping / axle.inertia, axle.stiffness / axle.inertia
    if not square:
        x = 2.0 * half * time
        begun, driven = axle.spin * time * _phi(1, x), drive * time**2 * _phi(2, x)
        rate = axle.spin * np.exp(-x) + drive * time * _phi(1, x)
        size = float(np.abs(begun).max() + np.abs(driven).max())
        return begun + driven, rate, (16.0 if half else 8.0) * _EPS * size
    middle = drive / square
    away = half * half - square
    fast = math.sqrt(abs(away))
    if away > 0:  # both exponents, of which the slow one must not cancel
        slow = square / (half + fast)
        decay = np.exp(-slow * time)
        cosine, sine = decay * 0.5 * (1.0 + np.exp(-2.0 * fast * time)), decay * time * _phi(1, 2.0 * fast * time)
    else:
        decay = np.exp(-half * time)
        cosine, sine = decay * np.cos(fast * time), decay * time * np.sinc(fast * time / math.pi)
    angle = middle - middle * cosine + (axle.spin - half * middle) * sine
    rate = axle.spin * cosine + (square * middle - half * axle.spin) * sine
    size = abs(middle) + abs(axle.spin) * float(np.abs(sine).max())
    return angle, rate, 8.0 * _EPS * size * (1.0 + (fast + half) * float(time[-1]))


def _phi(order: int, x: Float) -> Float:
    """Return (1 − e⁻ˣ)/x, or (e⁻ˣ − 1 + x)/x², of x ≥ 0, to the last digits also where x is small."""
    small = x < _SMALL
    divisor = np.where(small, 1.0, x)
    if order == 1:
        return np.where(
            small,
            sum((-np.where(small, x, 0.0)) ** k / math.factorial(k + 1) for k in range(18)),
            -np.expm1(-x) / divisor,
        )
    series = sum((-np.where(small, x, 0.0)) ** k / math.factorial(k + 2) for k in range(18))
    return np.where(small, series, (np.expm1(-x) + x) / divisor**2)


def _pendulum(figures: Figures, time: Float) -> _Solution:
    """Solve I θ̈ = M sin φ as a top that has no momentum along its axis or the vertical; φ, from the upper rest, is
    θ + φ₀, with M sin φ₀ = A and M cos φ₀ = B.

    All figures count as they are: the error is a few roundings, however near the upper rest it starts or passes.
    """
    from inertia.dynamics.kinematics import quaternion
    from inertia.dynamics.models.heavy.top import HeavyTop, solve_heavy_top

    inertia, spin, cosine, sine = (figures[name] for name in ("inertia", "spin", "cosine", "sine"))
    moments, pull, start, omega, exact = top_of(figures)
    top = HeavyTop.of_state(moments, pull, start, omega, exact)
    motion = solve_heavy_top(moments, pull, start, omega, time, exact)
    turned = quaternion.multiply(motion.attitude, quaternion.conjugate(start))
    turn = 2.0 * np.arctan2(turned[:, 0], turned[:, 3])
    angle = turn - _TURN * np.round(turn / _TURN)
    nutation = top.nutation
    if nutation.rate:
        # Which whole turn that is follows from where in its swing it is, counted from the lowest point.
        from_lowest = math.remainder(2.0 * math.atan2(start[0], start[3]) - math.pi, _TURN)
        forwards = float(spin) or -float(cosine) * nutation.start
        since = nutation.start / nutation.rate + np.concatenate([[0.0], time])
        if inertia * spin * spin > 2 * (exact[1] - sine):  # it goes over the top, once in every period
            middle = _TURN * nutation.cycles[0] * since
        else:
            middle = 0.25 * _TURN * np.sign(_side(nutation, time) if nutation.cycles[0] else since)
        whole = np.round((math.copysign(1.0, forwards) * middle - np.concatenate([[0.0], angle]) - from_lowest) / _TURN)
        angle = angle + _TURN * (whole[1:] - whole[0])
    return angle, motion.angular_velocity[:, 0], turn, motion.reached + 4.0 * _EPS


def top_of(figures: Figures) -> tuple[tuple[float, float], float, Float, Float, State]:
    """Return moments, mgh, attitude and ω of the top that a pendulum is, as `HeavyTop.of_state` takes them."""
    inertia, spin, cosine, sine = (figures[name] for name in ("inertia", "spin", "cosine", "sine"))
    pull, zero = root(cosine * cosine + sine * sine), Fraction(0)
    half = (cosine, pull + sine) if sine > 0 else (pull - sine, cosine)  # in proportion to sin ½φ₀ and cos ½φ₀
    length = root(half[0] * half[0] + half[1] * half[1])
    exact = (inertia, inertia), pull, (half[0] / length, zero, zero, half[1] / length), (spin, zero, zero)
    moments = float(inertia), float(inertia)
    return moments, float(pull), np.array(exact[2], dtype=float), np.array(exact[3], dtype=float), exact


def _side(nutation: Nutation, time: Float) -> Float:
    """Return numbers (1 + n,) of the sign of the angle from the lowest point, at the start and at times (n,)."""
    begun = double_double.of(nutation.start / (2.0 * nutation.quarter))
    cycles = double_double.add(double_double.times(nutation.cycles, np.concatenate([[0.0], time])), begun)
    _, (side, _) = double_double.reduce(cycles, (2.0, 0.0))
    return np.asarray(side)


def _stepped(figures: Figures, time: Float, march: _March) -> _Solution:
    """Step twice, with steps of another length; the estimate is twice how far the runs are apart.

    What every step is rounded by comes on top, as far as neighbouring motions part.
    """
    unit = _unit_of(figures)
    axle, time = _scaled(figures, unit), time / unit
    with np.errstate(over="ignore", invalid="ignore"):
        (angle, rate), (other, _) = (march(axle, time, level) for level in _LEVELS)
    off = 2.0 * float(np.abs(angle - other).max())
    instants = np.union1d(time, np.linspace(0.0, float(time[-1]), _INSTANTS))
    path = march(axle, instants, _LEVELS[0])[0]
    rounding = 4.0 * _EPS
    off += rounding * _slope(lambda noise: march(axle, instants, _LEVELS[0], noise)[0], path, rounding, _NOISE)
    return angle, rate / unit, angle, off


def _unit_of(figures: Figures) -> float:
    """Return s, a power of two, in which the time is counted: 1 where nothing is much faster or slower than that.

    Powers of a rate up to the order of the series are no float64 where it is beyond all scales in seconds.
    """
    inertia = figures["inertia"]
    rates = [abs(float(figures["spin"])), float(figures["damping"] / inertia)]
    rates += [math.sqrt(abs(figures[name] / inertia)) for name in ("torque", "stiffness", "cosine", "sine")]
    _, exponent = math.frexp(max(rates))
    return 1.0 if abs(exponent) <= _ORDINARY else 2.0**-exponent


def _scaled(figures: Figures, unit: float) -> Axle:
    """Return figures as float64, with the time in a unit, s."""
    powers = {"inertia": 0, "spin": 1, "damping": 1}
    return axle_of({name: value * Fraction(unit) ** powers.get(name, 2) for name, value in figures.items()})


def _series(axle: Axle, time: Float, level: float, noise: float = 0.0) -> tuple[Float, Float]:
    """Return θ and θ̇ at the instants, from steps as long as the last terms of the series allow.

    Every step may be off by `noise`, relative.
    """
    angle, rate = np.empty_like(time), np.empty_like(time)
    at, state = 0.0, (0.0, axle.spin)
    first, watch = 0, Watch()
    while first < len(time):
        watch.require(at / float(time[-1]))
        terms = _terms(axle, *state)
        if not np.isfinite(terms).all():
            raise GeometryError(
                f"the angle leaves float64 after {at / time[-1]:.2g} of the run: check the units of the scene"
            )
        last = max(abs(terms[-1]) ** (1.0 / _ORDER), abs(terms[-2]) ** (1.0 / (_ORDER - 1)), 1e-300)
        step = level * _STEP ** (1.0 / _ORDER) * max(1.0, abs(state[0])) ** (1.0 / _ORDER) / last
        following = at + step
        step = following - at  # without a rounding
        stop = int(np.searchsorted(time, following, side="right"))
        here = time[first:stop] - at
        slopes = terms[1:] * np.arange(1, len(terms))
        angle[first:stop], rate[first:stop] = np.polyval(terms[::-1], here), np.polyval(slopes[::-1], here)
        ends = float(np.polyval(terms[::-1], step)), float(np.polyval(slopes[::-1], step))
        state = ends[0] + noise * abs(ends[0]), ends[1] + noise * abs(ends[1])
        at, first = following, stop
    return angle, rate


def _terms(axle: Axle, angle: float, rate: float) -> Float:
    """Return the coefficients of θ in powers of the time; those of its sine and cosine follow from each other."""
    theta, sine, cosine = np.zeros((3, _ORDER + 1))
    theta[:2], sine[0], cosine[0] = (angle, rate), math.sin(angle), math.cos(angle)
    for n in range(_ORDER - 1):
        slopes = theta[1 : n + 1] * np.arange(1, n + 1)
        if n:
            sine[n], cosine[n] = slopes @ cosine[n - 1 :: -1][:n] / n, -(slopes @ sine[n - 1 :: -1][:n]) / n
        pull = axle.cosine * cosine[n] + axle.sine * sine[n] + (axle.torque if n == 0 else 0.0)
        loss = axle.damping * (n + 1) * theta[n + 1] + axle.stiffness * theta[n]
        theta[n + 2] = (pull - loss) / (axle.inertia * (n + 1) * (n + 2))
    return theta
