"""Limits of a budget: a quantity of the whole against its least and largest value, judged by its interval of 95 %."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.assembly.fields import LimitFields
from inertia.assembly.lines import ELEMENTS, Line
from inertia.assembly.tree import PartTree
from inertia.errors import FieldPath, UsageError, placed
from inertia.mass.principal import principal
from inertia.mass.properties import MassProperties
from inertia.records import dataclass

Verdict = Literal["pass", "fail", "undecided"]

COVERAGE = 1.959963984540054
"""Standard uncertainties on either side that 95 % of a normal distribution lie within."""

_ROUNDED = 4 * 2.0**-53
"""Of a limit: what it, and decimals that add up to it, may be rounded by; a limit is met by what is equal to it."""


@dataclass(frozen=True)
class Limit:
    """A limit and what became of it; SI.

    Attributes
    ----------
    what : as the file names it
    value : what it is on
    low, high : least and largest value; None without
    uncertainty : standard uncertainty of the value
    bound : on the arithmetic error of the value
    verdict : "undecided" where 95 % of what the value may be are neither within nor beyond
    """

    what: str
    value: float
    low: float | None
    high: float | None
    uncertainty: float
    bound: float

    @property
    def margin(self) -> float:
        """How far within the limit the value is; negative beyond it, 0 within what decimals are rounded by at it."""
        above = [] if self.high is None else [(self.high - self.value, self.high)]
        below = [] if self.low is None else [(self.value - self.low, self.low)]
        return min((0.0 if abs(off) <= _ROUNDED * abs(at) else off for off, at in above + below), default=math.inf)

    @property
    def verdict(self) -> Verdict:
        """Whether the interval of 95 % is within the limits, beyond one of them, or neither."""
        reach = COVERAGE * self.uncertainty + self.bound
        if self.margin >= reach or (self.margin == 0 and reach <= _ROUNDED * abs(self.value)):
            return "pass"
        return "fail" if self.margin < -reach else "undecided"


def judged(fields: LimitFields, total: Line, properties: MassProperties, assembly: PartTree) -> Limit:
    """Return a limit with what became of it; raise `UsageError` where a ratio is to nothing."""
    above, _, below = fields.what.partition("/")
    value, rates, bound = _figure(above, total, properties)
    if below:
        divisor, others, off = _figure(below, total, properties)
        if not divisor:
            raise placed(UsageError(f"{below} is 0: nothing is in proportion to it"), assembly.path, FieldPath("limit"))
        value, rates = value / divisor, (rates - value / divisor * others) / divisor
        bound = (bound + abs(value) * off) / max(abs(divisor) - off, 1e-300)
    scale = float(assembly.unit.metres) if above.startswith("center_of_mass") else 1.0
    low, high = (None if k is None else scale * k for k in (fields.min, fields.max))
    return Limit(fields.what, value, low, high, total.sigma.along(rates), bound)


def _figure(what: str, total: Line, properties: MassProperties) -> tuple[float, Float, float]:
    """Return a quantity of the whole, how it changes with the eleven of `Sigma.changes`, and its bound."""
    rates, error = np.zeros(11), properties.error
    kind, _, which = what.partition(".")
    size = float(np.linalg.norm(properties.inertia))
    tensor_bound = error.inertia * size if size else 0.0  # the tensor of one point is zero to the last bit
    if kind in ("mass", "basic_mass"):
        rates[10 if kind == "mass" else 0] = 1.0
        value = properties.mass + (total.allowance if kind == "mass" else 0.0)
        return value, rates, error.mass * value
    if kind == "center_of_mass":
        axis = "xyz".index(which)
        rates[1 + axis] = 1.0
        return float(properties.center_of_mass[axis]), rates, error.center_of_mass
    if kind == "inertia":
        i, j = ("xyz".index(k) for k in which)
        rates[4 + ELEMENTS.index((i, j))] = 1.0
        return float(properties.inertia[i, j]), rates, tensor_bound
    axes = principal(properties.inertia)
    a = axes.axes[:, int(which) - 1]
    rates[4:10] = [(1.0 if i == j else 2.0) * a[i] * a[j] for i, j in ELEMENTS]
    return float(properties.principal_moments[int(which) - 1]), rates, tensor_bound
