"""Axes taken for one another: permuted, the mesh's for the link's, a rotation left out or inverted."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import permutations

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake

_CODE = "axes_permuted"
_TURNED = 1e-6  # radians; less is no rotation


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the tensor along axes that are permuted, the mesh's own, or turned back and forth."""
    for order in list(permutations(range(3)))[1:]:
        names = "".join("xyz"[k] for k in order)
        words = f"the axes of the tensor are permuted: {names} stand in the fields of xyz"
        turn = np.eye(3)[list(order)]
        yield Mistake(_CODE, 4, words, "write the elements in the order of the fields", partial(_permuted, turn))
    rotations = [("the inertial frame", context.stated.rotation)]
    rotations += [(shape.name, shape.rotation) for shape in context.shapes[:3]]
    done: list[Float] = []
    for name, rotation in rotations:
        if abs(rotation - np.eye(3)).max() < _TURNED or any(abs(rotation - other).max() < _TURNED for other in done):
            continue
        done.append(rotation)
        words = f"the rotation of {name} is left out: the tensor stands along axes that are not the link's"
        if name == "the inertial frame":  # what is written is along the link's axes already
            words = "the tensor is written along the link's axes, and a rotation is stated beside it"
            yield Mistake(_CODE, 4, words, "take the rotation away", partial(_by, rotation))
        else:
            yield Mistake(_CODE, 4, words, f"turn it by the rotation of {name}", partial(_by, rotation.T))
        words = f"the rotation of {name} is taken the wrong way round"
        twice = rotation @ rotation if name == "the inertial frame" else (rotation @ rotation).T
        yield Mistake(_CODE, 4, words, "invert the rotation", partial(_by, twice))
    for shape in context.shapes[:3]:
        if abs(shape.rotation - np.eye(3)).max() > _TURNED or np.linalg.norm(shape.origin) > _TURNED * context.size:
            words = f"centre and tensor stand in the frame of {shape.name}, not in the link's"
            make = partial(_within, shape.rotation, shape.origin)
            yield Mistake("mesh_frame", 4, words, f"place them as {shape.name} is placed", make)


def _permuted(turn: Float, claim: Claim) -> Claim:
    def written(context: Context, body: Body) -> Body:
        axes = context.stated.rotation
        return body._replace(inertia=axes @ turn @ axes.T @ body.inertia @ axes @ turn.T @ axes.T)

    return claim.then(written)


def _within(rotation: Float, origin: Float, claim: Claim) -> Claim:
    def placed(_context: Context, body: Body) -> Body:
        return Body(body.mass, rotation.T @ (body.center - origin), rotation.T @ body.inertia @ rotation)

    return claim.then(placed)


def _by(turn: Float, claim: Claim) -> Claim:
    return claim.then(lambda _context, body: body._replace(inertia=turn @ body.inertia @ turn.T))
