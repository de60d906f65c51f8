"""A tensor about another point than the centre of mass: the link's or a mesh's origin, or shifted the wrong way."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake
from inertia.mass.tensor import point_inertia

_REMEDY = "state it about the centre of mass"


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the tensor about each of the points that it may have been written about."""
    points = [("about the link's origin", np.zeros(3))]
    for shape in context.shapes[:3]:
        if shape.origin.any():
            points.append((f"about the origin of {shape.name}", shape.origin))
    for words, point in points:
        yield _mistake(f"the tensor is {words}, not about the centre of mass", point, 1.0)
    yield _mistake(
        "the Steiner term from the link's origin to the centre of mass is taken away twice", np.zeros(3), -1.0
    )
    if context.stated.body.center.any():
        return
    yield Mistake(
        "about_origin",
        3,
        "the centre of mass is left at the link's origin, and the tensor is about it",
        "state the centre of mass, and the tensor about it",
        lambda claim: claim.then(_at_origin),
    )
    yield Mistake(
        "center_at_origin",
        3,
        "the centre of mass is left at the link's origin; the tensor is that about the centre of mass",
        "state the centre of mass",
        lambda claim: claim.then(lambda _context, body: body._replace(center=np.zeros(3))),
    )


def _mistake(words: str, point: Float, sign: float) -> Mistake:
    return Mistake("about_origin", 3, words, _REMEDY, partial(_about, point, sign))


def _about(point: Float, sign: float, claim: Claim) -> Claim:
    return claim.then(partial(_shifted, point, sign))


def _shifted(point: Float, sign: float, _context: Context, body: Body) -> Body:
    return body._replace(inertia=body.inertia + sign * point_inertia(body.mass, body.center - point))


def _at_origin(_context: Context, body: Body) -> Body:
    return Body(body.mass, np.zeros(3), body.inertia + point_inertia(body.mass, body.center))
