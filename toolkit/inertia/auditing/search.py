"""Mistakes that explain a difference between stated and computed mass properties: each alone, then two together."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake, difference, mismatch
from inertia.auditing.densities import is_plausible
from inertia.auditing.hypotheses import KINDS
from inertia.records import dataclass

EXPLAINED = 0.02
"""Residual up to which a mistake explains what is stated."""

_CLEARLY = 2.0
"""How many times closer than the next one an explanation must be where both are within `EXPLAINED`."""

_WORTHWHILE = 3.0
"""How many times smaller a difference must become by what explains it."""

_SAME = 1e-6
"""Difference up to which two explanations of one kind say the same."""

_ALIKE = 1e-3
"""Difference up to which explanations of different kinds come to the same, however little they leave."""


@dataclass(frozen=True)
class Explanation:
    """Mistakes, one or two, the residual that is left when they are undone, and what they lead to.

    `context` is what that was measured by; `alike` are mistakes of other kinds that come to the same with this link.
    """

    mistakes: tuple[Mistake, ...]
    residual: float
    body: Body
    context: Context
    alike: tuple[Explanation, ...] = ()

    @property
    def codes(self) -> frozenset[str]:
        """The kinds of mistake."""
        return frozenset(mistake.code for mistake in self.mistakes)

    @property
    def blur(self) -> float:
        """How far facets leave it open."""
        return max(mistake.blur for mistake in self.mistakes)


@dataclass(frozen=True)
class Search:
    """What was found of a difference.

    Attributes
    ----------
    named : the explanation, if there is one and no other explains the difference as well
    candidates : the best explanation of each set of kinds that explains it, best first
    """

    named: Explanation | None
    candidates: tuple[Explanation, ...]


def explain(context: Context, tolerance: float = EXPLAINED) -> Search:
    """Search for the mistakes that lead from the shapes of a link to what is stated of it.

    One mistake is preferred to two. An explanation is named only if it leaves at most `tolerance` and no mistakes of
    other kinds do, or none nearly as little.
    """
    search = singles(context, tolerance)
    return search if search.candidates else pairs(context, tolerance)


def singles(context: Context, tolerance: float = EXPLAINED) -> Search:
    """Search among single mistakes."""
    limit = _limit(context.truth, tolerance)
    attempts = (
        _Attempt((mistake,), claim, limit)
        for mistake, claim in _alone(context)
        if difference(context, claim.body, context.truth.body) > tolerance / 2
    )
    return _ranked(attempts, context)


def pairs(context: Context, tolerance: float = EXPLAINED) -> Search:
    """Search among two mistakes of different kinds, made in the order of their stages, or in both within one.

    Each must make the difference much smaller than the other alone does. Rounding is not among them: with few
    decimals it explains anything.
    """
    truth = context.truth
    alone, whole = list(_alone(context)), _limit(truth, tolerance)
    attempts = (
        _Attempt((first, second), second.make(claim), min(whole, _limit(claim, tolerance), _limit(other, tolerance)))
        for first, claim in alone
        if first.code != "rounded" and difference(context, claim.body, truth.body) > tolerance / 2
        for second, other in (alone if claim.context is context else _alone(claim.context, truth))
        if second.code not in ("rounded", first.code) and second.stage >= first.stage
    )
    return _ranked(attempts, context)


class _Attempt(NamedTuple):
    """Mistakes, what they lead to, and the residual that they may leave."""

    mistakes: tuple[Mistake, ...]
    claim: Claim
    limit: float


def _limit(without: Claim, tolerance: float) -> float:
    """Return what a mistake may leave that is worth while beside a claim without it."""
    return min(tolerance, without.residual / _WORTHWHILE)


def _alone(context: Context, truth: Claim | None = None) -> Iterator[tuple[Mistake, Claim]]:
    """Yield each mistake that can be made, and what becomes of the truth by it, or of that about other shapes."""
    for kind in KINDS:
        for mistake in kind(context):
            yield mistake, mistake.make(context.truth if truth is None else truth)


def _ranked(attempts: Iterable[_Attempt], context: Context) -> Search:
    """Name the best explanation, unless others do nearly as well and come to something else."""
    candidates = _best_of_each_kind(attempts, context)
    if not candidates:
        return Search(None, ())
    scores = {id(each): mismatch(each.context, each.body) for each in candidates}
    best = min(candidates, key=lambda each: scores[id(each)])
    reach = max(_CLEARLY * scores[id(best)], _SAME)
    rivals = [each for each in candidates if scores[id(each)] <= reach]
    others = sorted((each for each in candidates if scores[id(each)] > reach), key=lambda each: each.residual)
    same = max(_ALIKE, best.residual / 2)  # what differs by less than what is left anyhow says the same
    by = min((each.context for each in rivals), key=lambda context: context.size)
    alike = all(difference(by, each.body, best.body) <= same for each in rivals)
    if alike:  # the first in the order of the kinds
        nearly = (each for each in others if difference(by, each.body, best.body) <= each.blur)
        first = replace(rivals[0], alike=(*rivals[1:], *nearly))
        return Search(first, (first, *others))
    rivals.sort(key=lambda explanation: explanation.residual)
    return Search(None, (*rivals, *others))


def _best_of_each_kind(attempts: Iterable[_Attempt], context: Context) -> list[Explanation]:
    """Return the best explanation of each set of kinds that explains it, in the order of the kinds."""
    best: dict[frozenset[str], Explanation] = {}
    for mistakes, claim, limit in attempts:
        if claim.residual <= limit and _weighs(mistakes, context):
            explanation = Explanation(mistakes, claim.residual, claim.body, claim.context)
            other = best.get(explanation.codes)
            if other is None or explanation.residual < other.residual - _SAME:
                best[explanation.codes] = explanation
    return list(best.values())


def _weighs(mistakes: tuple[Mistake, ...], context: Context) -> bool:
    """Whether the mass asks for a density of some material once mistakes that touch it are undone."""
    factors = [mistake.density for mistake in mistakes if mistake.density is not None]
    return not factors or context.densities is not None or is_plausible(context, math.prod(factors))
