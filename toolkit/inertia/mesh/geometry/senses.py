"""Pieces of a surface that are inside out, whole bodies with what is in them.

The wall of a void encloses less than nothing too. What tells is what is outermost around a piece, if anything is: that
bounds material, so that it is inside out where it encloses less than nothing, and then so is all that lies in it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.boxes import nested
from inertia.mesh.geometry.enclosed import Local, all_outward, boxes_of, drawn, enclosed, members_of, scaling
from inertia.mesh.geometry.triangle_pairs import unit
from inertia.mesh.geometry.winding import windings
from inertia.mesh.surface import Triangles

_CHUNK = 1 << 16
_UNDER = (1e-3, 1e-6)  # how far under the surface of a piece it is asked what is around it, over its size


def senses_of(triangles: Triangles, labels: NDArray[np.int32], count: int, asked: Int) -> Int:
    """Return what `senses` does, (count,), for pieces that labels (n,) tell; −1 is in none."""
    if all_outward(triangles, labels, count):
        return np.ones(count, np.int64)
    boxes = boxes_of(triangles, labels, count)
    if not np.isfinite(boxes).all():  # which is refused elsewhere
        return np.ones(count, np.int64)
    local, _ = scaling(boxes)
    volumes, noise = enclosed(triangles, labels, local, local(boxes).mean(axis=1))
    signs = np.where(np.abs(volumes) > noise, np.sign(volumes), 0).astype(np.int64)
    if (signs >= 0).all():
        return np.ones(count, np.int64)
    return senses(triangles, members_of(labels, count), local, boxes, volumes, signs, asked)


def senses(
    triangles: Triangles,
    pieces: Sequence[Int],
    local: Local,
    boxes: Float,
    volumes: Float,
    signs: Int,
    asked: Int | None = None,
) -> Int:
    """Return 1 for pieces that are as they should be, and −1 for those that are inside out with what they lie in.

    Parameters
    ----------
    pieces : the numbers of the triangles of each
    local : what brings coordinates to order one
    boxes, volumes, signs : (k, 2, 3), (k,), (k,), of each; 0 where rounding may have made a volume
    asked : the pieces (m,) that matter; all unless given
    """
    sense = np.where(signs < 0, -1, 1)
    if (signs >= 0).all():
        return sense
    pairs, size, own = nested(boxes), np.abs(volumes), sense.copy()
    pairs = pairs[size[pairs[:, 0]] > size[pairs[:, 1]]]
    # Where all that may be around a piece are as it is, so is the outermost.
    open_ = np.zeros(len(sense), bool)
    open_[pairs[own[pairs[:, 0]] != own[pairs[:, 1]], 1]] = True
    if asked is not None:
        open_[np.setdiff1d(np.arange(len(open_)), asked)] = False
    pairs = pairs[open_[pairs[:, 1]]]
    outers, starts, counts = np.unique(pairs[:, 0], return_index=True, return_counts=True)
    for k in np.argsort(-size[outers], kind="stable").tolist():  # whatever is around a piece is larger
        outer, inner = int(outers[k]), pairs[starts[k] : starts[k] + counts[k], 1]
        inner = inner[open_[inner]]
        if len(inner):
            held = inner[_lies_in(triangles, pieces, local, boxes, inner, outer)]
            sense[held], open_[held] = own[outer], False
    return sense


def _lies_in(triangles: Triangles, pieces: Sequence[Int], local: Local, boxes: Float, inner: Int, outer: int) -> Bool:
    """Say which pieces (k,) lie in another, in whose box they are: most places in them are, if any are found."""
    samples = drawn(triangles, list(pieces), inner)
    corners = local(triangles.select(samples.ravel()).corners()).reshape(*samples.shape, 3, 3)
    size = np.ptp(local(boxes[inner]), axis=1).max(axis=1)[:, None, None]
    a, b, c = np.moveaxis(corners, 2, 0)
    middles, normals = corners.mean(axis=2), unit(np.cross(b - a, c - a))
    places = np.concatenate([middles + side * depth * size * normals for depth in _UNDER for side in (-1, 1)], axis=1)
    around = _windings(triangles, pieces[outer], local, places.reshape(-1, 3))
    inside = np.ones(len(inner), bool)
    for k, (piece, held) in enumerate(zip(inner.tolist(), around.reshape(len(inner), -1) != 0, strict=True)):
        own = _windings(triangles, pieces[piece], local, places[k])
        if (within := own != 0).any():
            inside[k] = 2 * held[within].sum() > within.sum()
    return inside


def _windings(triangles: Triangles, numbers: Int, local: Local, points: Float) -> Int:
    """Return the winding numbers of some triangles around points (k, 3)."""
    winding = np.zeros(len(points), np.int64)
    for start in range(0, len(numbers), _CHUNK):
        winding += windings(points, local(triangles.select(numbers[start : start + _CHUNK]).corners()), 0.0)[0]
    return winding
