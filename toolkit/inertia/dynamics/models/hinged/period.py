"""How long a body on an axle takes to come back to where it was, moving as it did: a swing, or a whole turn.

It keeps its energy, so that F = θ̇² is a function of the angle,

    F(θ) = ω² + (2/I) (N θ − ½ k θ² + A sin θ + B (1 − cos θ)),

and between two zeros of F it swings. Of a pendulum all is in closed form; for one with a spring, see `spring`.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.models.hinged.angle import Figures, top_of
from inertia.dynamics.models.hinged.spring import SprungAxle
from inertia.dynamics.models.rational import root
from inertia.records import dataclass


@dataclass(frozen=True)
class Recurrence:
    """The motion of a body on an axle without loss.

    Attributes
    ----------
    period : s; infinite where it goes to its upper rest and stays there; None where it is not known, with a spring
        beside the weight: so near an unstable rest does it pass, or over so many
    turning : rad from the start, the angles between which it swings; None where it goes round, or these are not known
    """

    period: float | None
    turning: tuple[float, float] | None = None

    @property
    def quantities(self) -> dict[str, Float]:
        """The figures by the names that a run states them by."""
        turning = {} if self.turning is None else {"turning angle": np.array(self.turning)}
        period = {} if self.period is None else {"period": np.array(self.period)}
        return period | turning

    @property
    def remark(self) -> str:
        """What kind of motion it is, a sentence."""
        if self.period is None and self.turning is None:
            return (
                "It passes so near an unstable rest, or over so many of them, that where it turns back is not known: "
                "no period is stated."
            )
        if self.period is None:
            return (
                "It swings to and fro between its turning angles, so near an unstable rest that its period is not "
                "stated."
            )
        if self.turning is not None:
            return "It swings to and fro between its turning angles."
        if math.isinf(self.period):
            return "It is on the separatrix: it goes to its upper rest and does not come back."
        return "It goes over the top: a turn takes a period."


def recurrence(figures: Figures) -> Recurrence | None:
    """Return how a body on an axle without damping comes back.

    None where it stays at rest, or where neither weight nor spring turns it.

    >>> from fractions import Fraction
    >>> wheel = {"inertia": 2, "spin": 3, "torque": 0, "damping": 0, "stiffness": 8, "cosine": 0, "sine": 0}
    >>> recurrence({name: Fraction(value) for name, value in wheel.items()})   # ω √(I/k) to either side, in 2π √(I/k)
    Recurrence(period=3.141592653589793, turning=(-1.5, 1.5))
    """
    if not (figures["spin"] or figures["torque"] + figures["cosine"]):
        return None
    if figures["stiffness"]:
        return _with_spring(figures)
    return _pendulum(figures) if figures["cosine"] or figures["sine"] else None


def _pendulum(figures: Figures) -> Recurrence:
    from inertia.dynamics.models.heavy.top import HeavyTop

    cosine, sine = figures["cosine"], figures["sine"]
    period = HeavyTop.of_state(*top_of(figures)).nutation_period
    pull = root(cosine * cosine + sine * sine)
    below = pull - sine if sine < 0 else cosine * cosine / (pull + sine)  # J, of the start under the upper rest
    above = pull + sine if sine > 0 else cosine * cosine / (pull - sine)  # and over the lowest point
    energy = figures["inertia"] * figures["spin"] ** 2 / 2
    if energy >= below:
        return Recurrence(period)
    # From half the angle: sin² and cos² of it are as what is above the lowest point to what lacks at the upper rest.
    reach = 2.0 * math.atan2(1.0, math.sqrt((below - energy) / (above + energy)))
    lowest = math.atan2(float(cosine), -float(sine))
    return Recurrence(2.0 * period, (lowest - reach, lowest + reach))


def _with_spring(figures: Figures) -> Recurrence:
    axle = SprungAxle.of(figures)
    low, high = (None, None) if axle is None else (axle.turning_angle(side) for side in (-1.0, 1.0))
    if axle is None or low is None or high is None:
        return Recurrence(None)
    period = axle.period(low, high)
    unit = float(root(figures["inertia"] / figures["stiffness"]))
    return Recurrence(None if period is None else unit * period, (low[0], high[0]))
