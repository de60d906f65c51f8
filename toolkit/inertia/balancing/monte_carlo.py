"""Monte Carlo of the residual unbalance when every input is only known to a tolerance, and a table of sensitivities.

The unbalance in a plane is affine in the densities and, to first order, in the axis, the depths, the angles and the
diameters: Uₖ = U⁰ₖ + Σ sₖⱼ ξⱼ. A draw is then a sum of products, and the sensitivities say what to hold tightest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex
from inertia.errors import UsageError
from inertia.mass.tensor import array_of

Distribution = Literal["normal", "uniform", "disc"]

DRAWS = 10_000
LEVEL = 0.95
"""The share of draws that stay below the residual stated."""

_VARIANCE: dict[Distribution, float] = {"normal": 1.0, "uniform": 1.0 / 3.0, "disc": 0.5}
_NORMAL_95 = 1.959963984540054


@dataclass(frozen=True, eq=False)
class Term:
    """One uncertain input ξ, of mean zero, and what it does to the unbalance in each plane.

    Attributes
    ----------
    name : what is uncertain
    distribution : "normal"; "uniform", between −spread and spread; "disc", a complex ξ, uniform over |ξ| ≤ spread
    spread : standard deviation, half-width or radius, in SI
    sensitivities : (k,) kg·m in each plane per unit of ξ
    step : the change of ξ that the table states the effect of, in SI
    step_text : the same as the shop says it: "0.1 mm"
    """

    name: str
    distribution: Distribution
    spread: float
    sensitivities: Complex
    step: float
    step_text: str

    def __post_init__(self) -> None:
        if self.distribution not in _VARIANCE:
            raise UsageError(f"{self.name}: distribution is {self.distribution!r}: use one of {', '.join(_VARIANCE)}")
        for name in ("spread", "step"):
            if not 0 <= getattr(self, name) < math.inf:
                raise UsageError(f"{self.name}: {name} is {getattr(self, name)!r}: it must be finite and not negative")
        object.__setattr__(self, "sensitivities", complex_of(self.sensitivities, f"{self.name}: sensitivities"))

    @property
    def deviation(self) -> Float:
        """Standard deviation of the unbalance in each plane for this term alone, (k,) kg·m."""
        deviation: Float = np.abs(self.sensitivities) * self.spread * math.sqrt(_VARIANCE[self.distribution])
        return deviation

    def draw(self, random: np.random.Generator, count: int) -> Float | Complex:
        """Return `count` draws of ξ."""
        if self.distribution == "normal":
            return random.normal(0.0, self.spread, count)
        if self.distribution == "uniform":
            return random.uniform(-self.spread, self.spread, count)
        angle = random.uniform(0.0, 2.0 * math.pi, count)
        points: Complex = self.spread * np.sqrt(random.uniform(0.0, 1.0, count)) * np.exp(1j * angle)
        return points


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """A line of the table: what one input does.

    Attributes
    ----------
    name : what is uncertain
    step_text : the step that `per_step` is for
    per_step : (k,) kg·m in each plane
    at_spread : (k,) kg·m in each plane for the input's whole half-width, radius or standard deviation
    share : (k,) of the variance in each plane
    """

    name: str
    step_text: str
    per_step: Float
    at_spread: Float
    share: Float


@dataclass(frozen=True, eq=False)
class Scatter:
    """The residual unbalance as it may turn out.

    Attributes
    ----------
    draws : how many
    nominal : (k,) kg·m, with every input at its nominal value
    residual_95 : (k,) kg·m, the magnitude that 95 % of the draws stay below
    residual_95_range : (k, 2) kg·m, where that lies with 95 % confidence, as the draws are finite in number
    within : share of the draws that are within the permissible residual in every plane; None where none is given
    sensitivities : the table, what matters most first
    """

    draws: int
    nominal: Complex
    residual_95: Float
    residual_95_range: Float
    within: float | None
    sensitivities: tuple[Sensitivity, ...]


def monte_carlo(
    nominal: ArrayLike,
    terms: Sequence[Term],
    *,
    permissible: ArrayLike | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> Scatter:
    """Draw the residual unbalance in each tolerance plane.

    The confidence range is that of order statistics: of n draws, those ranked 0.95 n ± 1.96 √(0.95 · 0.05 n).

    Parameters
    ----------
    nominal : (k,) kg·m, in each plane
    terms : the uncertain inputs, independent of each other
    permissible : (k,) kg·m
    draws : 100 or more
    seed : of the generator (PCG64); the same seed gives the same draws

    >>> depth = Term("depth", "uniform", 1e-4, [2.0, 0.5], 1e-4, "0.1 mm")
    >>> scatter = monte_carlo([0.0, 0.0], [depth])
    >>> scatter.residual_95.round(6).tolist(), scatter.sensitivities[0].share.tolist()
    ([0.00019, 4.7e-05], [1.0, 1.0])
    """
    start = complex_of(nominal, "nominal")
    if start.ndim != 1 or start.size == 0:
        raise UsageError(f"nominal must have shape (planes,), not {start.shape}")
    if draws < 100:
        raise UsageError(f"draws is {draws}: 95 % residuals take 100 or more")
    for term in terms:
        if term.sensitivities.shape != start.shape:
            raise UsageError(
                f"{term.name}: sensitivities have shape {term.sensitivities.shape}, the unbalance {start.shape}: give "
                "one for each plane"
            )
    random = np.random.default_rng(seed)
    vectors = np.repeat(start[:, None], draws, axis=1)
    for term in terms:
        vectors += term.sensitivities[:, None] * term.draw(random, draws)
    size = np.sort(np.abs(vectors), axis=1)
    middle, reach = LEVEL * draws, _NORMAL_95 * math.sqrt(LEVEL * (1.0 - LEVEL) * draws)
    ranks = [max(0, math.floor(middle - reach)), math.ceil(middle) - 1, min(draws - 1, math.ceil(middle + reach))]
    limits = None if permissible is None else array_of(permissible, start.shape, "permissible")
    within = None if limits is None else float((np.abs(vectors) <= limits[:, None]).all(axis=0).mean())
    table = _table(terms, np.ones(len(start)) if limits is None else limits)
    return Scatter(draws, start, size[:, ranks[1]], size[:, [ranks[0], ranks[2]]], within, table)


def _table(terms: Sequence[Term], limits: Float) -> tuple[Sensitivity, ...]:
    """Return the table, sorted by the worst plane's deviation over its limit."""
    variance = sum((term.deviation**2 for term in terms), np.zeros(len(limits)))

    def line(term: Term) -> Sensitivity:
        size = np.abs(term.sensitivities)
        share = np.divide(term.deviation**2, variance, out=np.zeros_like(variance), where=variance > 0)
        return Sensitivity(term.name, term.step_text, size * term.step, size * term.spread, share)

    return tuple(line(term) for term in sorted(terms, key=lambda term: -float((term.deviation / limits).max())))
