"""A true shape as one file of arrays and one text of JSON, by which it passes from one process to another."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.errors import visible
from inertia.mesh.shape import Curve, Face, Patch, Shape, Solid, Spline, Trim

_CLASSES = {kind.__name__: kind for kind in (Curve, Face, Patch, Spline, Trim)}


class Pool:
    """Numbers of many arrays, one after the other."""

    def __init__(self) -> None:
        self._arrays: list[Float] = []
        self._size = 0

    def add(self, array: Float) -> list[Any]:
        """Return where an array is, and its shape."""
        self._arrays.append(np.asarray(array, float).reshape(-1))
        self._size += self._arrays[-1].size
        return [self._size - self._arrays[-1].size, list(np.shape(array))]

    def numbers(self) -> Float:
        """Return all of them, (n,)."""
        return np.concatenate([np.empty(0), *self._arrays])


def shape_to_json(shape: Shape, pool: Pool) -> dict[str, Any]:
    """Return a shape without its arrays, which go into the pool; faces that solids share are in it once."""
    bodies: dict[int, int] = {}
    faces, solids = [], []
    for solid in shape.solids:
        if id(solid.faces) not in bodies:
            bodies[id(solid.faces)] = len(bodies)
            faces.append([_plain(face, pool) for face in solid.faces])
        rest = [solid.name, bodies[id(solid.faces)], solid.placement.tolist(), solid.closed, solid.colour, solid.path]
        solids.append(rest)
    return {"bodies": faces, "solids": solids, "tolerances": pool.add(shape.tolerances)}


def shape_from_json(document: dict[str, Any], numbers: Float) -> Shape:
    """Return the shape that `shape_to_json` described."""
    bodies = [tuple(_rich(face, numbers) for face in faces) for faces in document["bodies"]]
    solids = tuple(
        Solid(visible(name), bodies[body], np.array(placement), closed, colour and tuple(colour), tuple(path))
        for name, body, placement, closed, colour, path in document["solids"]
    )
    return Shape(solids, _array(document["tolerances"], numbers))


def _array(place: list[Any], numbers: Float) -> Float:
    start, shape = place
    return numbers[start : start + int(np.prod(shape, dtype=int))].reshape(shape)


def _plain(value: Any, pool: Pool) -> Any:
    if isinstance(value, np.ndarray):
        return {"array": pool.add(value)}
    if isinstance(value, tuple):
        return [_plain(one, pool) for one in value]
    if type(value) in _CLASSES.values():
        return {type(value).__name__: [_plain(getattr(value, field.name), pool) for field in fields(value)]}
    return value


def _rich(value: Any, numbers: Float) -> Any:
    if isinstance(value, list):
        return tuple(_rich(one, numbers) for one in value)
    if isinstance(value, dict):
        ((name, content),) = value.items()
        if name == "array":
            return _array(content, numbers)
        return _CLASSES[name](*(_rich(one, numbers) for one in content))
    return value
