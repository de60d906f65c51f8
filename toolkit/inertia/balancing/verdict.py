"""Verdict on a residual unbalance against its tolerance: PASS, CONDITIONAL, FAIL or UNDECIDED.

PASS and FAIL hold whatever is uncertain of the rotor. PASS becomes CONDITIONAL where too few parts would be within the
tolerance, once the shop's work scatters as stated.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

from inertia.balancing.bounds import Source, Uncertainty
from inertia.balancing.forces import RigidLimit
from inertia.balancing.monte_carlo import Scatter
from inertia.balancing.shop_units import GRAM_MILLIMETRE
from inertia.balancing.tolerance import Planes, Tolerance
from inertia.balancing.unbalance import Unbalance
from inertia.records import dataclass

Outcome = Literal["pass", "fail", "undecided", "conditional"]

_ASKS: dict[Source, str] = {
    "tessellation": "facets within {:.2g} mm of the true surface",
    "axis": "bearing centres known to {:.2g} mm or better",
    "density": "densities known to {:.2g} % or better",
    "arithmetic": "coordinates counted from a point on the part, as rounding is in proportion to how far off they are",
    "measurement": "a smaller uncertainty of the measurement",
}
_SCALES: dict[Source, float] = {"tessellation": 1e3, "axis": 1e3, "density": 1e2, "arithmetic": 1.0}
_MILD, _SMALL = 0.05, 0.01
_SEEN = 1e-6  # of the limit
_ON = 1e-9  # of the limit: as near to it nothing that is known better settles it
_DIGITS = 15  # that tell two figures apart


@dataclass(frozen=True)
class Settlement:
    """What would settle a plane that is undecided.

    Attributes
    ----------
    needs : for each source, the size of its input (m, or relative) that is small enough; None where it has no input
    text : the same in words
    """

    needs: dict[Source, float | None]
    text: str


@dataclass(frozen=True)
class PlaneVerdict:
    """The verdict on one tolerance plane.

    Attributes
    ----------
    name : "A" or "B"
    outcome : "pass" where |U| and its bounds stay within the limit, "fail" where |U| less its bounds exceeds it
    residual : the vector found, kg m
    permissible : kg m
    bounds : how far the vector may be off, kg m, by source; beside its limit, where that follows the mass
        (`inertia.balancing.tolerance.Tolerance.apart`)
    covers : the sources that cover the limit by themselves or, where none does, all that do so together
    settlements : what would settle it, one source at a time; all of them at once where no single one can
    why : the verdict in a sentence
    """

    name: str
    outcome: Outcome
    residual: complex
    permissible: float
    bounds: dict[Source, float]
    covers: tuple[Source, ...]
    settlements: tuple[Settlement, ...]
    why: str


@dataclass(frozen=True)
class Verdict:
    """The verdict on a rotor: the worst of its planes, and undecided where it is no rigid rotor any more.

    Attributes
    ----------
    outcome : of the whole rotor
    planes : (A, B)
    why : in sentences
    turned_over_by : m, the radial error of the bearing centres that would turn it over, where the axis is taken as
        exact; None where its uncertainty is in the bounds, or where nothing is decided
    axis_exact : whether the axis is taken as exact
    within : the share of parts within tolerance, where the shop's work has been counted
    share : the same in words, with the share that was asked for
    """

    outcome: Outcome
    planes: tuple[PlaneVerdict, PlaneVerdict]
    why: tuple[str, ...]
    turned_over_by: float | None = None
    axis_exact: bool = False
    within: float | None = None
    share: str = ""

    @property
    def headline(self) -> str:
        """The verdict, the share of parts within tolerance, and what it takes for granted."""
        return "; ".join([self.outcome.upper(), *self.qualified])

    @property
    def qualified(self) -> tuple[str, ...]:
        """The share of parts within tolerance, and that the axis is taken as exact, where it is."""
        parts = [self.share] if self.share else []
        if self.axis_exact:
            over = self.turned_over_by
            radius = "" if over is None else f"{_floored(1e3 * over) if over > 0 else 0.0:.2g}"
            parts.append(
                "with the axis taken as exact"
                + (f": a radial error of {radius} mm at the bearings could turn it over" if radius else "")
            )
        return tuple(parts)


def judge(
    residual: Unbalance,
    tolerance: Tolerance,
    planes: Planes,
    rigid: RigidLimit | None = None,
    axis: Uncertainty | None = None,
) -> Verdict:
    """Judge a residual unbalance in its tolerance planes.

    A rotor that runs near its critical speed fails where its unbalance as a rigid body is too large already; it does
    not pass for having little of that.

    Parameters
    ----------
    residual : with its uncertainties
    tolerance : what is permissible in each plane
    planes : (A, B) m, the tolerance planes
    rigid : how near the critical speed is, if that is known
    axis : what an axis leaves uncertain whose bearing centres are known to within 1 m, where it is taken as exact

    >>> from inertia.balancing.tolerance import specific_unbalance
    >>> rotor = Unbalance(10.0, 0.2, static=1e-5, couple=0.0)
    >>> judge(rotor, specific_unbalance(2e-6, rotor, (0.0, 0.4)), (0.0, 0.4)).outcome
    'pass'
    """
    causes = _causes(residual)
    bounds = tolerance.bounds(residual, planes)
    first, second = (
        _plane(name, vector, tolerance.permissible[k], bounds[k], causes)
        for k, (name, vector) in enumerate(zip("AB", residual.in_planes(*planes), strict=True))
    )
    outcomes = {first.outcome, second.outcome}
    outcome: Outcome = "fail" if "fail" in outcomes else "undecided" if "undecided" in outcomes else "pass"
    why: tuple[str, ...] = (first.why, second.why)
    if rigid is not None and rigid.level == "flexible":
        outcome, why = "fail" if outcome == "fail" else "undecided", (*why, rigid.text)
    if tolerance.undecided is not None:
        outcome, why = "undecided", (*why, tolerance.undecided)
    over = None
    if axis is not None:
        a, b = tolerance.apart(residual.with_uncertainties(axis), planes)[-1]
        over = _turned_over(outcome, (first, second), (a, b))
    return Verdict(outcome, (first, second), why, over, axis is not None)


def count_the_shop(verdict: Verdict, scatter: Scatter) -> Verdict:
    """Return the verdict with the share of parts within tolerance: PASS takes the share that is asked for.

    It has to be reached with 99.9 % confidence, so that other draws do not turn it over.

    Parameters
    ----------
    verdict : on the residual as planned
    scatter : of the residual as made, with what is permissible; the further terms are bearing centres that are known to
        within what would turn the verdict over
    """
    if scatter.within is None or scatter.within_range is None:
        return verdict
    low, high = scatter.within_range
    over = verdict.turned_over_by
    wanted = f"{100.0 * scatter.confidence:g} %"
    share = f"{scatter.within_text} of parts within tolerance, {wanted} asked for"
    outcome, why = verdict.outcome, verdict.why
    if outcome == "pass" and low < scatter.confidence:
        outcome = "conditional"
        why = (
            *why,
            f"as made, {scatter.within_text} of parts are within tolerance where axis, densities and the shop's work "
            f"scatter as stated, and {wanted} is asked for{_tightest(scatter)}",
        )
    elif outcome == "pass" and over is not None and scatter.spare is not None:
        over *= scatter.spare
    if low < scatter.confidence < high or low < 0.5 < high:
        edge = wanted if low < scatter.confidence < high else "one half"
        share += f" (too near {edge} to be told by {scatter.draws} draws: {100 * low:.2f} to {100 * high:.2f} %)"
    return replace(verdict, outcome=outcome, why=why, turned_over_by=over, within=scatter.within, share=share)


def _tightest(scatter: Scatter) -> str:
    """Return what has to be held tighter first."""
    return next((f": what matters most is {k.name}" for k in scatter.sensitivities if k.at_spread.any()), "")


def _turned_over(outcome: Outcome, verdicts: tuple[PlaneVerdict, ...], rates: tuple[float, float]) -> float | None:
    """Return the radius of uncertainty of the bearing centres (m) from which on a verdict holds no more.

    The rates are what a metre of it does in each plane, kg m.
    """
    room = [
        abs(k.permissible - abs(k.residual)) - math.fsum(k.bounds.values()) if k.outcome == outcome else None
        for k in verdicts
    ]
    radii = [left / rate for left, rate in zip(room, rates, strict=True) if left is not None and rate > 0]
    if outcome == "pass":
        return min(radii, default=None)
    return max(radii, default=None) if outcome == "fail" else None


def _causes(residual: Unbalance) -> dict[Source, float | None]:
    """Return the largest cause of each source: what several bodies have in common is the worst of them."""
    causes: dict[Source, float | None] = {}
    for uncertainty in residual.uncertainties:
        both = [k for k in (causes.get(uncertainty.source), uncertainty.cause) if k is not None]
        causes[uncertainty.source] = max(both, default=None)
    return causes


def _plane(
    name: str, vector: complex, permissible: float, bounds: dict[Source, float], causes: dict[Source, float | None]
) -> PlaneVerdict:
    size, uncertain = abs(vector), math.fsum(bounds.values())
    room = abs(permissible - size)
    outcome: Outcome = "undecided"
    if size + uncertain <= permissible:
        outcome = "pass"
    elif size - uncertain > permissible:
        outcome = "fail"
    figure, limit = _figures(0.0 if size <= min(uncertain, _SEEN * permissible) else size, permissible)
    if uncertain > _SEEN * permissible or (outcome == "undecided" and uncertain):
        figure += f" ± {uncertain / GRAM_MILLIMETRE:.4g}"
    why = f"plane {name}: {figure} g·mm against {limit}: {outcome.upper()}"
    covers: tuple[Source, ...] = ()
    settlements: tuple[Settlement, ...] = ()
    if outcome == "undecided":
        present = {source: bound for source, bound in bounds.items() if bound > 0}
        covers = tuple(k for k, bound in present.items() if bound >= room) or tuple(present)
        settlements = _settlements(room, present, causes) if room > _ON * permissible else ()
        sizes = {k: bound for k, bound in present.items() if bound >= _SMALL * permissible} or present
        parts = ", ".join(f"{k} {sizes[k] / GRAM_MILLIMETRE:.4g}" for k in sorted(sizes, key=lambda k: -sizes[k]))
        settled = " or ".join(k.text for k in settlements) or (
            "nothing that is known better, as the value lies on the limit: a little less unbalance, or another limit"
        )
        why += f", as uncertainty covers the limit (g·mm: {parts}); what would settle it: {settled}"
    return PlaneVerdict(name, outcome, vector, permissible, bounds, covers, settlements, why)


def _settlements(
    room: float, bounds: dict[Source, float], causes: dict[Source, float | None]
) -> tuple[Settlement, ...]:
    """Return what would settle a plane: each source alone while the others stay, or else the large ones together.

    A bound is at most in proportion to its cause, so it fits into the room left where the cause is smaller by that
    ratio. The mildest comes first; a source that would have to shrink more than twentyfold is no way out by itself.
    """
    whole = math.fsum(bounds.values())
    alone = {source: (room - (whole - bound)) / bound for source, bound in bounds.items()}
    ways = sorted((source for source, ratio in alone.items() if ratio >= _MILD), key=lambda k: -alone[k])
    if ways:
        return tuple(_settlement({source: alone[source]}, causes) for source in ways)
    large = {source: bound for source, bound in bounds.items() if bound > _SMALL * whole}
    spare = room - (whole - math.fsum(large.values()))
    if spare <= 0:
        large, spare = bounds, room
    return (_settlement(dict.fromkeys(large, spare / math.fsum(large.values())), causes),)


def _settlement(ratios: dict[Source, float], causes: dict[Source, float | None]) -> Settlement:
    needs: dict[Source, float | None] = {}
    texts = []
    for source, ratio in ratios.items():
        cause = causes[source]
        needs[source] = None if cause is None else cause * ratio
        texts.append(_ASKS[source].format(_floored(_SCALES[source] * cause * ratio)) if cause else _without(source))
    return Settlement(needs, " with ".join(texts))


def _without(source: Source) -> str:
    return _ASKS[source] if source == "arithmetic" else f"a smaller uncertainty of the {source}"


def _floored(value: float) -> float:
    """Return the value rounded down to two figures, so that what is asked for is enough."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / unit) * unit


def _figures(size: float, permissible: float) -> tuple[str, str]:
    """Return a magnitude and its limit with g·mm, both to four figures or to as many as tell them apart."""
    values = size / GRAM_MILLIMETRE, permissible / GRAM_MILLIMETRE
    for digits in range(4, _DIGITS + 1):
        figure, limit = (f"{value:.{digits}g}" for value in values)
        if figure != limit:
            return figure, f"{limit} g·mm"
    figure = f"{values[0]:.4g}"
    return figure, f"{figure} g·mm, equal to {_DIGITS} digits"
