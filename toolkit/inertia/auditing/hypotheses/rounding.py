"""Numbers written to so few decimals that the digits which matter are gone."""

from __future__ import annotations

from collections.abc import Iterator

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Context, Mistake

_WORTH_NAMING = 9
"""Decimals from which on rounding is no mistake."""


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the numbers rounded to as many decimals as the file writes, where these are known."""
    center, inertia = context.stated.figures
    if inertia is None or inertia.decimals > _WORTH_NAMING:
        return

    def rounded(context: Context, body: Body) -> Body:
        axes = context.stated.rotation
        tensor = (axes.T @ body.inertia @ axes).round(inertia.decimals)
        place = body.center if center is None else body.center.round(center.decimals)
        return Body(body.mass, place, axes @ tensor @ axes.T)

    words = f"the tensor is rounded to {inertia.decimals} decimals"
    yield Mistake("rounded", 6, words, "write more digits", lambda claim: claim.then(rounded))
