"""Densities of the meshes of a link that reproduce its stated mass, centre and tensor: bounded least squares."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body, norm, together
from inertia.auditing.claim import Context, difference
from inertia.records import dataclass

DENSEST = 25_000.0
"""kg/m³ that no part of a machine exceeds (tungsten has 19,300)."""

PLAUSIBLE = (1.0, DENSEST)
"""kg/m³ of what robots are made of, thin covers that are modelled as solids included."""

_FREE = 5
"""Densities that may be chosen to fit ten numbers: with six, one in fifty wrong statements is fitted, too."""

_SPARE = 2
"""Numbers that have to come out right by themselves."""

_SAME, _DIGITS = 1e-3, 3  # of a link's size: moments that differ by less, as by symmetry, say one thing
_RANK = 1e-6  # singular value over the largest, from which on a combination of densities is seen in the numbers


@dataclass(frozen=True, eq=False)
class Densities:
    """Non-negative densities, one a shape.

    Attributes
    ----------
    values : (n,) kg/m³
    residual : what remains, as `inertia.auditing.claim.difference` has it
    unique : whether no others reproduce what is stated as well
    telling : whether so few densities are chosen that a wrong statement would not be reproduced by any
    body : the shapes with these densities, together
    """

    values: Float
    residual: float
    unique: bool
    telling: bool
    body: Body


def is_plausible(context: Context, factor: float) -> bool:
    """Whether the density that the stated mass asks of the shapes, times a factor, is one of materials."""
    density = context.stated.body.mass / sum(shape.solid.mass for shape in context.shapes)
    return PLAUSIBLE[0] <= factor * density <= PLAUSIBLE[1]


def invert(context: Context) -> Densities | None:
    """Return the densities of the shapes that reproduce what is stated best; None where there is one shape only.

    Ten equations (mass, three first and six second moments about the stated centre), each over its own scale, for
    the densities between 0 and `DENSEST`.
    """
    from scipy.optimize import lsq_linear

    shapes, stated = context.shapes, context.stated.body
    if len(shapes) < 2:
        return None
    square = max(norm(stated.inertia) / stated.mass, (_SAME * context.size) ** 2)
    scale = np.array([1.0, *[context.size] * 3, *[square] * 6])
    columns = np.array([_moments(shape.solid, stated.center) / scale for shape in shapes]).T
    target = _moments(stated, stated.center) / scale / stated.mass
    weights = columns[0].copy()  # unknowns are shares of the mass
    matrix = columns / weights
    upper = np.maximum(DENSEST * weights / stated.mass, 1e-12)
    result = lsq_linear(matrix, target, bounds=(0.0, upper), method="bvls")
    shares = result.x
    values = shares * stated.mass / weights
    body = together([shape.solid.weighed(value) for shape, value in zip(shapes, values, strict=True) if value > 0])
    singular = np.linalg.svd(matrix, compute_uv=False)
    unique = len(shapes) <= 10 and bool(singular[-1] > _RANK * singular[0])
    numbers = np.unique(matrix[np.abs(matrix).max(axis=1) > _SAME].round(_DIGITS), axis=0)
    telling = len(shapes) <= min(_FREE, len(numbers) - _SPARE)
    return Densities(values, difference(context, body, stated), unique, telling, body)


def _moments(body: Body, point: Float) -> Float:
    """Return mass, first and second moments about a point, (10,)."""
    way = body.center - point
    second = np.trace(body.inertia) / 2 * np.eye(3) - body.inertia + body.mass * np.outer(way, way)
    return np.array([body.mass, *(body.mass * way), *second[np.triu_indices(3)]])


def named(values: Sequence[float]) -> str:
    """Return densities in words: "1040, 7850 kg/m³"."""
    return ", ".join(f"{value:.4g}" for value in values) + " kg/m³"
