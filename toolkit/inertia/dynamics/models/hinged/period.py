"""How long a body on an axle takes to come back to where it was, moving as it did: a swing, or a whole turn.

It keeps its energy, so that F = θ̇² is a function of the angle,

    F(θ) = ω² + (2/I) (N θ − ½ k θ² + A sin θ + B (1 − cos θ)),

and between two zeros of F it swings. Of a pendulum all is in closed form; with a spring the zeros are found from the
start on, and T = 2 ∫ dθ/√F over the angle in which the integrand is periodic.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.models.hinged.angle import Figures, axle_of, top_of
from inertia.dynamics.models.hinged.axle import Axle
from inertia.dynamics.models.rational import root
from inertia.records import dataclass

_STEPS = 10_000  # towards a turning angle
_FEWEST, _MOST = 16, 1 << 16  # nodes of the integral
_SETTLED = 1e-14  # relative, between twice as many nodes and as many


@dataclass(frozen=True)
class Recurrence:
    """The motion of a body on an axle without loss.

    Attributes
    ----------
    period : s; infinite where it goes to its upper rest and stays there
    turning : rad from the start, the angles between which it swings; None where it goes round
    """

    period: float
    turning: tuple[float, float] | None = None

    @property
    def quantities(self) -> dict[str, Float]:
        """The figures by the names that a run states them by."""
        turning = {} if self.turning is None else {"turning angle": np.array(self.turning)}
        return {"period": np.array(self.period), **turning}

    @property
    def remark(self) -> str:
        """What kind of motion it is, a sentence."""
        if self.turning is not None:
            return "It swings to and fro between its turning angles."
        if math.isinf(self.period):
            return "It is on the separatrix: it goes to its upper rest and does not come back."
        return "It goes over the top: a turn takes a period."


def recurrence(figures: Figures) -> Recurrence | None:
    """Return how a body on an axle without damping comes back.

    None where it stays at rest, where neither weight nor spring turns it, or, with both, where it passes so near an
    unstable rest that the integral does not settle.

    >>> from fractions import Fraction
    >>> wheel = {"inertia": 2, "spin": 3, "torque": 0, "damping": 0, "stiffness": 8, "cosine": 0, "sine": 0}
    >>> recurrence({name: Fraction(value) for name, value in wheel.items()})   # ω √(I/k) to either side, in 2π √(I/k)
    Recurrence(period=3.141592653589793, turning=(-1.5, 1.5))
    """
    if not (figures["spin"] or figures["torque"] + figures["cosine"]):
        return None
    if figures["stiffness"]:
        return _with_spring(axle_of(figures))
    return _pendulum(figures) if figures["cosine"] or figures["sine"] else None


def _pendulum(figures: Figures) -> Recurrence:
    from inertia.dynamics.models.heavy.top import HeavyTop

    cosine, sine = figures["cosine"], figures["sine"]
    top = HeavyTop.of_state(*top_of(figures))
    pull = root(cosine * cosine + sine * sine)
    height = cosine * cosine / (pull + sine) if sine > 0 else pull - sine  # J, up to the upper rest
    if figures["inertia"] * figures["spin"] ** 2 >= 2 * height:
        return Recurrence(top.nutation_period)
    lowest = math.remainder(math.pi - math.atan2(float(cosine), float(sine)), 2.0 * math.pi)
    reach = math.pi - top.turning_angles[0]
    return Recurrence(2.0 * top.nutation_period, (lowest - reach, lowest + reach))


def _with_spring(axle: Axle) -> Recurrence | None:
    low, high = _turning_angle(axle, -1.0), _turning_angle(axle, 1.0)
    if low is None or high is None or low == high:
        return None
    before, nodes = math.inf, _FEWEST
    while nodes <= _MOST:
        period = _period(axle, low, high, nodes)
        if abs(period - before) <= _SETTLED * period:
            return Recurrence(period, (low, high))
        before, nodes = period, 2 * nodes
    return None


def _turning_angle(axle: Axle, side: float) -> float | None:
    """Return the first angle at which F vanishes on one side of the start; None where that takes too many steps.

    |F″| ≤ M = (2/I) (k + the largest pull): a step to where the parabola of curvature −M through F and F′ meets zero
    passes no zero of F, and converges as Newton's do.
    """
    bend = 2.0 / axle.inertia * (axle.stiffness + axle.pull)
    angle = 0.0
    for _ in range(_STEPS):
        value = axle.spin**2 + angle * float(_slope(axle, angle, 0.0))
        slope = side * float(_slope(axle, angle, angle))
        if value <= 0 and (slope <= 0 or angle):
            return angle
        reach = math.sqrt(slope * slope + 2.0 * bend * value)
        following = angle + side * ((slope + reach) / bend if slope > 0 else 2.0 * value / (reach - slope))
        if following == angle:
            return angle
        angle = following
    return None


def _slope(axle: Axle, to: Float | float, start: float) -> Float:
    """Return (F(to) − F(start))/(to − start), which is F′ where they are one: no difference of near numbers."""
    middle, half = 0.5 * (to + start), 0.5 * (to - start)
    pull = (axle.cosine * np.cos(middle) + axle.sine * np.sin(middle)) * np.sinc(half / np.pi)
    return np.asarray(2.0 / axle.inertia * (axle.torque - axle.stiffness * middle + pull))


def _period(axle: Axle, low: float, high: float, nodes: int) -> float:
    """Return 2 ∫ dχ/√G with θ = middle + reach sin χ and G = F/((θ − low)(high − θ)), at midpoints: G is periodic."""
    chi = np.pi * ((np.arange(nodes) + 0.5) / nodes - 0.5)
    middle, reach, late = 0.5 * (low + high), 0.5 * (high - low), chi > 0
    angle = middle + reach * np.sin(chi)
    far = reach * (1.0 + np.abs(np.sin(chi)))  # from the turning angle that is not the nearer one
    shape = np.where(late, -_slope(axle, angle, high), _slope(axle, angle, low)) / far
    return float(2.0 * np.pi / nodes * np.sum(1.0 / np.sqrt(shape))) if (shape > 0).all() else math.nan
