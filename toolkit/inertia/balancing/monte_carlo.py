"""Monte Carlo of the residual unbalance when every input is only known to a tolerance, and a table of sensitivities.

The unbalance in a plane is affine in the densities and, to first order, in the axis, the depths, the angles and the
diameters: Uₖ = U⁰ₖ + Σ sₖⱼ ξⱼ. A draw is then a sum of products, and the sensitivities say what to hold tightest.
Limits that follow the mass are drawn with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex
from inertia.errors import UsageError
from inertia.mass.tensor import array_of
from inertia.records import dataclass

Distribution = Literal["normal", "uniform", "disc", "rayleigh"]

DRAWS = 10_000
LEVEL = 0.95
"""The share of draws that stay below the residual stated."""

_VARIANCE: dict[Distribution, float] = {"normal": 1.0, "uniform": 1.0 / 3.0, "disc": 0.5, "rayleigh": 2.0}
_NORMAL_95 = 1.959963984540054
_NORMAL_999 = 3.2905267314919255
_MOST_DRAWS = 1_000_000
_HALVINGS = 24  # of what further terms are multiplied by
_TOLD = 0.9  # of it: how near what certainly leaves enough draws within is to what perhaps does
_ROUNDED = 1e-9  # of a limit and of what grows with it: where both are in proportion, each draw is as the next


@dataclass(frozen=True, eq=False)
class Term:
    """One uncertain input ξ, of mean zero, and what it does to the unbalance in each plane.

    Attributes
    ----------
    name : what is uncertain
    distribution : "normal"; "uniform", between −spread and spread; "disc", a complex ξ, uniform over |ξ| ≤ spread;
        "rayleigh", a complex ξ, both of whose parts are normal
    spread : standard deviation, half-width or radius, in SI
    sensitivities : (k,) kg·m in each plane per unit of ξ
    step : the change of ξ that the table states the effect of, in SI
    step_text : the same as the shop says it: "0.1 mm"
    mass : (kg, kg m) that the rotor's mass and its first moment along the shaft change by per unit of ξ, a real one
    """

    name: str
    distribution: Distribution
    spread: float
    sensitivities: Complex
    step: float
    step_text: str
    mass: tuple[float, float] = (0.0, 0.0)

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
        if self.distribution == "rayleigh":
            pairs: Complex = random.normal(0.0, self.spread, (count, 2)).view(np.complex128)[:, 0]
            return pairs
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
    per_step : (k,) kg·m in each plane; beside the limit, where that follows the mass
    at_spread : (k,) kg·m in each plane for the input's whole half-width, radius or standard deviation, beside the limit
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
    within_range : where that share lies with 99.9 % confidence, as the draws are finite in number
    confidence : the share that was asked for
    sensitivities : the table, what matters most first
    spare : by what further terms, below 1, may be multiplied so that the share asked for is still reached with 99.9 %
        confidence; 1 where they may be as large as given, None where there are none or it is not reached
    """

    draws: int
    nominal: Complex
    residual_95: Float
    residual_95_range: Float
    within: float | None
    within_range: tuple[float, float] | None
    confidence: float
    sensitivities: tuple[Sensitivity, ...]
    spare: float | None = None

    @property
    def enough(self) -> bool:
        """Whether the share that was asked for is reached, with 99.9 % confidence."""
        return self.within_range is not None and self.within_range[0] >= self.confidence

    @property
    def within_text(self) -> str:
        """The share in per cent: to the digits that its distance from all takes, and no more than the draws tell."""
        if self.within is None or self.within_range is None:
            return ""
        if self.within == 1.0:
            return f"over {math.floor(1e3 * self.within_range[0]) / 10:g} %" if self._draws_matter else "100 %"
        return f"{100.0 * self.within:.{max(1, math.ceil(-math.log10(1.0 - self.within)) - 1)}f} %"

    @property
    def _draws_matter(self) -> bool:
        return any(line.at_spread.any() for line in self.sensitivities)


def monte_carlo(
    nominal: ArrayLike,
    terms: Sequence[Term],
    *,
    further: Sequence[Term] = (),
    permissible: ArrayLike | None = None,
    follows: Callable[[Float, Float], Float] | None = None,
    confidence: float = LEVEL,
    draws: int = DRAWS,
    seed: int = 0,
) -> Scatter:
    """Draw the residual unbalance in each tolerance plane.

    The range of the residual is that of order statistics: of n draws, those ranked 0.95 n ± 1.96 √(0.95 · 0.05 n); that
    of the share within the limits is Wilson's: E. B. Wilson (1927), J. Am. Stat. Assoc. 22, 209-212. Where the latter
    covers the confidence asked for, or one half, four times as many draws are made, up to a million.

    Parameters
    ----------
    nominal : (k,) kg·m, in each plane
    terms : the uncertain inputs, independent of each other
    further : others, not counted, of which is said how large they may be (`Scatter.spare`)
    permissible : (k,) kg·m
    follows : how they follow the mass: takes changes (n,) kg of the mass and (n,) kg m of its first moment along the
        shaft, returns limits (k, n) kg m; they stay without it
    confidence : the share that is asked to be within it
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
    for term in (*terms, *further):
        if term.sensitivities.shape != start.shape:
            raise UsageError(
                f"{term.name}: sensitivities have shape {term.sensitivities.shape}, the unbalance {start.shape}: give "
                "one for each plane"
            )
    if not 0 < confidence < 1:
        raise UsageError(f"the confidence is {confidence!r}: it must be above 0 and below 1")
    limits = None if permissible is None else array_of(permissible, start.shape, "permissible")
    while True:
        vectors, drawn = _drawn(start, limits, follows, terms, draws, seed)
        size = np.abs(vectors)
        within = None if drawn is None else float((size <= drawn).all(axis=0).mean())
        within_range = None if within is None else _wilson(within, draws)
        if within_range is None or 4 * draws > _MOST_DRAWS:
            break
        if not any(within_range[0] < edge < within_range[1] for edge in (confidence, 0.5)):
            break
        draws *= 4
    spare = None
    if limits is not None and within_range is not None and further and within_range[0] >= confidence:
        spare = _spare(
            further, confidence, draws, seed, lambda count: _drawn(start, limits, follows, terms, count, seed)
        )
    size.sort(axis=1)
    middle, reach = LEVEL * draws, _NORMAL_95 * math.sqrt(LEVEL * (1.0 - LEVEL) * draws)
    ranks = [max(0, math.floor(middle - reach)), math.ceil(middle) - 1, min(draws - 1, math.ceil(middle + reach))]
    beside = terms if limits is None or follows is None else [_beside(term, start, limits, follows) for term in terms]
    table = _table(beside, np.ones(len(start)) if limits is None else limits)
    low, high = size[:, ranks[0]], size[:, ranks[2]]
    return Scatter(
        draws, start, size[:, ranks[1]], np.column_stack([low, high]), within, within_range, confidence, table, spare
    )


def _spare(
    further: Sequence[Term],
    confidence: float,
    draws: int,
    seed: int,
    drawn: Callable[[int], tuple[Complex, Float | None]],
) -> float:
    """Return by what further terms may be multiplied, 1 at most, so that enough draws stay within their limits.

    Where the draws are too few to tell that well, four times as many are made.
    """
    while True:
        (vectors, limits), random = drawn(draws), np.random.default_rng([seed, 1])
        moved = sum(
            (term.sensitivities[:, None] * term.draw(random, draws) for term in further), np.zeros_like(vectors)
        )
        surely, perhaps = (_most_of(moved, vectors, limits, confidence, end) for end in (0, 1))
        if surely >= _TOLD * perhaps or 4 * draws > _MOST_DRAWS:
            return surely
        draws *= 4


def _most_of(moved: Complex, vectors: Complex, limits: Float | None, confidence: float, end: int) -> float:
    """Return by what all that is moved may be multiplied so that one end of the share within is as asked for."""

    def enough(factor: float) -> bool:
        share = float((np.abs(vectors + factor * moved) <= limits).all(axis=0).mean())
        return _wilson(share, vectors.shape[1])[end] >= confidence

    if enough(1.0):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if enough(middle) else (low, middle)
    return low


def _drawn(
    start: Complex,
    limits: Float | None,
    follows: Callable[[Float, Float], Float] | None,
    terms: Sequence[Term],
    draws: int,
    seed: int,
) -> tuple[Complex, Float | None]:
    """Return the vectors drawn, (planes, draws), and the limits that each is held against."""
    random = np.random.default_rng(seed)
    vectors = np.repeat(start[:, None], draws, axis=1)
    mass, moment = np.zeros(draws), np.zeros(draws)
    for term in terms:
        drawn = term.draw(random, draws)
        vectors += term.sensitivities[:, None] * drawn
        if any(term.mass):
            mass += term.mass[0] * drawn.real
            moment += term.mass[1] * drawn.real
    if limits is None or follows is None or not any(any(term.mass) for term in terms):
        return vectors, None if limits is None else limits[:, None]
    return vectors, (1.0 + _ROUNDED) * follows(mass, moment)


def _beside(term: Term, start: Complex, limits: Float, follows: Callable[[Float, Float], Float]) -> Term:
    """Return the term with what it does beside limits that move with it: s − U⁰/L · l, l being what it does to L."""
    if not any(term.mass) or not term.spread:
        return term
    mass, moment = (each * term.spread * np.array([1.0, -1.0]) for each in term.mass)
    up, down = follows(mass, moment).T
    moved = start / limits * (up - down) / (2.0 * term.spread)
    apart = term.sensitivities - moved
    lost = np.abs(apart) <= _ROUNDED * (np.abs(term.sensitivities) + np.abs(moved))
    return replace(term, sensitivities=np.where(lost, 0.0, apart))


def _wilson(share: float, draws: int) -> tuple[float, float]:
    """Return where the share lies with 99.9 % confidence."""
    square = _NORMAL_999**2 / draws
    middle = (share + 0.5 * square) / (1.0 + square)
    reach = math.sqrt(square * (share * (1.0 - share) + 0.25 * square)) / (1.0 + square)
    return max(0.0, middle - reach), 1.0 if share == 1.0 else min(1.0, middle + reach)


def _table(terms: Sequence[Term], limits: Float) -> tuple[Sensitivity, ...]:
    """Return the table, sorted by the worst plane's deviation over its limit; normal terms of one name are one line."""
    variance = sum((term.deviation**2 for term in terms), np.zeros(len(limits)))

    def line(some: Sequence[Term]) -> tuple[float, Sensitivity]:
        first, square = some[0], sum((term.deviation**2 for term in some), np.zeros(len(limits)))
        size = np.abs(first.sensitivities) if len(some) == 1 else np.sqrt(square) / first.spread
        share = np.divide(square, variance, out=np.zeros_like(variance), where=variance > 0)
        table_line = Sensitivity(first.name, first.step_text, size * first.step, size * first.spread, share)
        return -float((np.sqrt(square) / limits).max()), table_line

    inputs: dict[object, list[Term]] = {}
    for k, term in enumerate(terms):
        inputs.setdefault(term.name if term.distribution == "normal" else k, []).append(term)
    return tuple(entry for _, entry in sorted(map(line, inputs.values()), key=itemgetter(0)))
