"""Axes taken for one another: quarter turns, the mesh's for the link's, a rotation left out or inverted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import permutations, product

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake

_CODE = "axes_permuted"
_TURNED = 1e-6  # radians; less is no rotation
_SIGNS = ((1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0))
"""Of axes, up to all of them at once, which no tensor shows."""
_QUARTERS = [
    (degrees, axis, np.linalg.matrix_power(quarter, degrees // 90))
    for axis, quarter in (
        ("x", np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])),
        ("y", np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])),
        ("z", np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])),
    )
    for degrees in (90, 180, 270)
]


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the tensor along axes that are permuted, the mesh's own, or turned back and forth."""
    written = context.stated.rotation
    along = [np.eye(3)] if np.abs(written - np.eye(3)).max() < _TURNED else [np.eye(3), written]
    for axes, order, signs in product(along, list(permutations(range(3)))[1:], _SIGNS):
        turn = np.eye(3)[list(order)] * np.array(signs)[:, None]
        names = " ".join(("-" if sign < 0 else "") + "xyz"[k] for k, sign in zip(order, signs, strict=True))
        words = f"the axes of the tensor are permuted: {names} stand in the fields of x y z"
        make = partial(_by, axes @ turn @ axes.T)
        yield Mistake(_CODE, 3, words, "write the elements along the link's axes", make)
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
            yield Mistake(_CODE, 3, words, "take the rotation away", partial(_by, rotation))
        else:
            yield Mistake(_CODE, 3, words, f"turn it by the rotation of {name}", partial(_by, rotation.T))
        words = f"the rotation of {name} is taken the wrong way round"
        twice = rotation @ rotation if name == "the inertial frame" else (rotation @ rotation).T
        yield Mistake(_CODE, 3, words, "invert the rotation", partial(_by, twice))
    for shape in context.shapes[:3]:
        if abs(shape.rotation - np.eye(3)).max() > _TURNED or np.linalg.norm(shape.origin) > _TURNED * context.size:
            words = f"centre and tensor stand in the frame of {shape.name}, not in the link's"
            make = partial(_within, shape.rotation, shape.origin)
            yield Mistake("mesh_frame", 3, words, f"place them as {shape.name} is placed", make)
    for degrees, axis, turn in _QUARTERS:
        words = f"it is that of the meshes turned by {degrees}° about their {axis} axis, as where another axis was up"
        yield Mistake("mesh_turned", 1, words, "weigh the meshes as they are placed", partial(_turned, turn))


def _turned(turn: Float, claim: Claim) -> Claim:
    shapes = claim.context.shapes
    if len(claim.bodies) != len(shapes):  # others were weighed in their place
        return claim
    bodies = []
    for body, shape in zip(claim.bodies, shapes, strict=True):
        way = shape.rotation @ turn @ shape.rotation.T
        bodies.append(Body(body.mass, way @ (body.center - shape.origin) + shape.origin, way @ body.inertia @ way.T))
    return replace(claim, bodies=tuple(bodies))


def _within(rotation: Float, origin: Float, claim: Claim) -> Claim:
    def placed(_context: Context, body: Body) -> Body:
        return Body(body.mass, rotation.T @ (body.center - origin), rotation.T @ body.inertia @ rotation)

    return claim.then(placed)


def _by(turn: Float, claim: Claim) -> Claim:
    return claim.then(lambda _context, body: body._replace(inertia=turn @ body.inertia @ turn.T))
