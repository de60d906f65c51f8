"""Principal moments written as a diagonal, their rotation lost or turned the other way round."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import permutations, product

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake

CODE = "principal_moments_as_diagonal"
_TURNED = 1e-6  # radians; less is no rotation
_ORDERS: dict[tuple[int, ...], str] = {(0, 1, 2): "ascending", (2, 1, 0): "descending"}
_ARRANGEMENTS = [
    np.eye(3)[:, list(order)] * signs for order in ((0, 1, 2), (2, 1, 0)) for signs in product((1.0, -1.0), repeat=3)
]
_ARRANGEMENTS = [axes for axes in _ARRANGEMENTS if np.linalg.det(axes) > 0]
"""The right-handed ways to call the principal axes x, y and z, by ascending or descending moments."""


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the diagonal of principal moments in each order, and the tensor turned by the inverse rotation."""
    for order in permutations(range(3)):
        name = _ORDERS.get(order, "in the order " + ", ".join(f"I{k + 1}" for k in order))
        words = f"the principal moments, {name}, are written as ixx, iyy, izz without the rotation of their axes"
        remedy = "write the six elements along the link's axes, or the rotation beside the diagonal"
        if np.abs(context.stated.rotation - np.eye(3)).max() > _TURNED:
            words = f"the principal moments, {name}, stand beside a rotation to axes that are not theirs"
            remedy = "write each moment beside its own axis"
        yield Mistake(CODE, 3, words, remedy, partial(_diagonal, order))
    for arrangement in _ARRANGEMENTS:
        words = "the principal moments are turned into the link's axes by the inverse (conjugated) rotation"
        yield Mistake(CODE, 3, words, "invert the rotation (conjugate the quaternion)", partial(_inverted, arrangement))


def _diagonal(order: tuple[int, ...], claim: Claim) -> Claim:
    def written(context: Context, body: Body) -> Body:
        axes = context.stated.rotation
        moments = np.linalg.eigvalsh(body.inertia)[list(order)]
        return body._replace(inertia=axes @ np.diag(moments) @ axes.T)

    return claim.then(written)


def _inverted(arrangement: Float, claim: Claim) -> Claim:
    def turned(_context: Context, body: Body) -> Body:
        axes = _principal_axes(body.inertia) @ arrangement
        return body._replace(inertia=axes.T @ (axes.T @ body.inertia @ axes) @ axes)

    return claim.then(turned)


def _principal_axes(inertia: Float) -> Float:
    """Return right-handed principal axes (3, 3), its columns, by ascending moments."""
    axes = np.linalg.eigh(inertia)[1]
    return np.asarray(axes * np.array([1.0, 1.0, np.linalg.det(axes)]))
