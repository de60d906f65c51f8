"""Triangles that meet in great numbers at one vertex: which of them may cross is told by where they lie around it.

Their boxes all meet there. But two triangles with a corner in common that share another point share the segment to it,
so that the arcs of a circle which they are seen as from there meet too: few do, of triangles that do not cross.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.surface import Triangles

_EVERY = 16  # one of so many triangles is looked at first,
_MANY = 64  # and of their corners, so many in one place make a hub
_ROUNDING = 1e-12  # of a direction, amply


def hubs(triangles: Triangles) -> tuple[Float, Int, Int] | None:
    """Return vertices, faces and at which hub each face is, or −1; None where no vertex has a thousand triangles or so.

    >>> from inertia.mesh.part import Surface
    >>> rim = np.exp(2j * np.pi * np.arange(4096) / 4096)
    >>> vertices = np.vstack([[0, 0, 0], np.column_stack([rim.real, rim.imag, 1 + 0 * rim.real])])
    >>> own = 1 + np.arange(4096)
    >>> fan = hubs(Surface(vertices, np.column_stack([0 * own, own, np.roll(own, -1)])))
    >>> fan is not None and set(fan[2].tolist())
    {0}
    """
    if triangles.count < _EVERY * _MANY:
        return None
    some = triangles.select(np.arange(0, triangles.count, _EVERY)).corners().reshape(-1, 3)
    x, y, z = (some + 0.0).view(np.uint64).T
    mixed = np.sort((x * np.uint64(0x9E3779B97F4A7C15) ^ y) * np.uint64(0xBF58476D1CE4E5B9) + z)
    if not (mixed[_MANY - 1 :] == mixed[: len(mixed) - _MANY + 1]).any():
        return None
    vertices, faces = merge_equal_vertices(triangles)
    many = np.bincount(faces.ravel()) >= _EVERY * _MANY // 2
    at_hub = many[faces]
    hub = np.where(at_hub.any(axis=1), np.take_along_axis(faces, at_hub.argmax(axis=1)[:, None], axis=1)[:, 0], -1)
    return vertices, faces, hub


def near_around(vertices: Float, faces: Int, hub: int) -> Iterator[tuple[Int, Int, float]]:
    """Yield the pairs of faces (n, 3), all at a hub, that may share more than the hub, and the fraction done."""
    turn = (faces == hub).argmax(axis=1)[:, None]
    ends = vertices[np.take_along_axis(faces, (turn + np.array([1, 2])) % 3, axis=1)] - vertices[hub]
    size = np.abs(ends).max(axis=2, keepdims=True)
    ends = ends / np.where(size > 0, size, 1)
    length = np.linalg.norm(ends, axis=2, keepdims=True)
    ends = ends / np.where(length > 0, length, 1)
    # The arc between two directions leaves their box by no more than it leaves its chord.
    bulge = 1 - np.sqrt(np.maximum(1 + (ends[:, 0] * ends[:, 1]).sum(axis=1), 0) / 2)[:, None] + _ROUNDING
    yield from overlapping(BoxTree(ends.min(axis=1) - bulge, ends.max(axis=1) + bulge), touching=True)
