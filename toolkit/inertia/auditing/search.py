"""Mistakes that explain a difference between stated and computed mass properties: each alone, then two together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake, difference
from inertia.auditing.hypotheses import KINDS

EXPLAINED = 0.02
"""Residual up to which a mistake explains what is stated."""

_CLEARLY = 2.0
"""How many times closer than the next one an explanation must be where both are within `EXPLAINED`."""

_WORTHWHILE = 3.0
"""How many times smaller a difference must become by what explains it."""

_SAME = 1e-6
"""Difference up to which two explanations say the same."""


@dataclass(frozen=True)
class Explanation:
    """Mistakes, one or two, the residual that is left when they are undone, and what they lead to."""

    mistakes: tuple[Mistake, ...]
    residual: float
    body: Body

    @property
    def codes(self) -> frozenset[str]:
        """The kinds of mistake."""
        return frozenset(mistake.code for mistake in self.mistakes)


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
    return _ranked((((mistake,), claim) for mistake, claim in _effective(context, tolerance)), context, tolerance)


def pairs(context: Context, tolerance: float = EXPLAINED) -> Search:
    """Search among two mistakes of different kinds, made in the order of their stages, or in both within one.

    Rounding is not among them: with few decimals it explains anything.
    """
    mistakes = [mistake for kind in KINDS for mistake in kind(context)]
    claims = (
        ((first, second), second.make(claim))
        for first, claim in _effective(context, tolerance)
        for second in mistakes
        if second.stage >= first.stage and second.code != first.code and "rounded" not in (first.code, second.code)
    )
    return _ranked(claims, context, tolerance)


def _effective(context: Context, tolerance: float) -> Iterator[tuple[Mistake, Claim]]:
    """Yield the mistakes that change something here: what changes nothing explains nothing."""
    truth = context.truth
    for kind in KINDS:
        for mistake in kind(context):
            claim = mistake.make(truth)
            if difference(context, claim.body, truth.body) > tolerance / 2:
                yield mistake, claim


def _ranked(claims: Iterable[tuple[tuple[Mistake, ...], Claim]], context: Context, tolerance: float) -> Search:
    candidates = _best_of_each_kind(claims, context, tolerance)
    if not candidates:
        return Search(None, ())
    first = candidates[0]
    clear = len(candidates) == 1 or candidates[1].residual > _CLEARLY * first.residual
    return Search(first if clear else None, candidates)


def _best_of_each_kind(
    claims: Iterable[tuple[tuple[Mistake, ...], Claim]], context: Context, tolerance: float
) -> tuple[Explanation, ...]:
    """Return the best explanation of each set of kinds, best first; of those that say the same, the first."""
    limit = min(tolerance, context.truth.residual / _WORTHWHILE)
    best: dict[frozenset[str], Explanation] = {}
    for mistakes, claim in claims:
        if claim.residual <= limit:
            explanation = Explanation(mistakes, claim.residual, claim.body)
            other = best.get(explanation.codes)
            if other is None or explanation.residual < other.residual - _SAME:
                best[explanation.codes] = explanation
    ranked: list[Explanation] = []
    for explanation in best.values():
        if all(difference(context, explanation.body, other.body) > _SAME for other in ranked):
            ranked.append(explanation)
    return tuple(sorted(ranked, key=lambda explanation: explanation.residual))
