"""Verdict on a residual unbalance against its tolerance, PASS, FAIL or UNDECIDED, with all that is uncertain of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from inertia.balancing.bounds import Source
from inertia.balancing.forces import RigidLimit
from inertia.balancing.shop_units import GRAM_MILLIMETRE
from inertia.balancing.tolerance import Planes, Tolerance
from inertia.balancing.unbalance import Unbalance

Outcome = Literal["pass", "fail", "undecided"]

_ASKS: dict[Source, str] = {
    "tessellation": "a chord tolerance of {:.2g} mm or less",
    "axis": "bearing centres known to {:.2g} mm or better",
    "density": "densities known to {:.2g} % or better",
    "arithmetic": "exact arithmetic",
}
_SCALES: dict[Source, float] = {"tessellation": 1e3, "axis": 1e3, "density": 1e2, "arithmetic": 1.0}
_MILD, _SMALL = 0.05, 0.01
_SEEN = 1e-6  # of the limit


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
    bounds : how far the vector may be off, kg m, by source
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
    """

    outcome: Outcome
    planes: tuple[PlaneVerdict, PlaneVerdict]
    why: tuple[str, ...]


def judge(residual: Unbalance, tolerance: Tolerance, planes: Planes, rigid: RigidLimit | None = None) -> Verdict:
    """Judge a residual unbalance in its tolerance planes.

    Parameters
    ----------
    residual : with its uncertainties
    tolerance : what is permissible in each plane
    planes : (A, B) m, the tolerance planes
    rigid : how near the critical speed is, if that is known

    >>> from inertia.balancing.tolerance import specific_unbalance
    >>> rotor = Unbalance(10.0, 0.2, static=1e-5, couple=0.0)
    >>> judge(rotor, specific_unbalance(2e-6, rotor, (0.0, 0.4)), (0.0, 0.4)).outcome
    'pass'
    """
    causes = _causes(residual)
    bounds = residual.bounds_in_planes(planes)
    first, second = (
        _plane(name, vector, tolerance.permissible[k], bounds[k], causes)
        for k, (name, vector) in enumerate(zip("AB", residual.in_planes(*planes), strict=True))
    )
    outcomes = {first.outcome, second.outcome}
    outcome: Outcome = "fail" if "fail" in outcomes else "undecided" if "undecided" in outcomes else "pass"
    why: tuple[str, ...] = (first.why, second.why)
    if rigid is not None and rigid.level == "flexible":
        outcome, why = "undecided", (*why, rigid.text)
    return Verdict(outcome, (first, second), why)


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
    figure = _gmm(size, permissible)
    if uncertain > _SEEN * permissible:
        figure += f" ± {_gmm(uncertain, permissible)}"
    why = f"plane {name}: {figure} g·mm against {_gmm(permissible, permissible)} g·mm: {outcome.upper()}"
    covers: tuple[Source, ...] = ()
    settlements: tuple[Settlement, ...] = ()
    if outcome == "undecided":
        present = {source: bound for source, bound in bounds.items() if bound > 0}
        covers = tuple(k for k, bound in present.items() if bound >= room) or tuple(present)
        settlements = _settlements(room, present, causes)
        sizes = {k: bound for k, bound in present.items() if bound >= _SMALL * permissible} or present
        parts = ", ".join(f"{k} {sizes[k] / GRAM_MILLIMETRE:.4g}" for k in sorted(sizes, key=lambda k: -sizes[k]))
        settled = " or ".join(k.text for k in settlements) or "nothing: the value lies on the limit"
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
    if not room:
        return ()
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


def _gmm(unbalance: float, permissible: float) -> str:
    """Return a magnitude in g·mm to four figures; what is lost beside the limit is 0."""
    return f"{unbalance / GRAM_MILLIMETRE if unbalance > _SEEN * permissible else 0.0:.4g}"
