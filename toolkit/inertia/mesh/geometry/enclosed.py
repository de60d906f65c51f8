"""Boxes of pieces of a surface, and the volumes that these enclose."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float
from inertia.mesh.surface import Triangles

_CHUNK = 1 << 16
_NOISE = 1e-13  # rounding of a volume, over the sum of its terms' largest magnitudes

Local = Callable[[Float], Float]


def inside_out(triangles: Triangles) -> bool:
    """Say whether a surface encloses less than nothing, beyond rounding: all or most of it is inside out."""
    whole = np.broadcast_to(np.int32(0), triangles.count)
    boxes = boxes_of(triangles, whole, 1)
    local, _ = scaling(boxes)
    volume, noise = enclosed(triangles, whole, local, local(boxes).mean(axis=1))
    return bool(volume[0] < -noise[0])


def scaling(boxes: Float) -> tuple[Local, int]:
    """Return what shifts to the middle of all boxes and divides by a power of two, and its exponent.

    No digit and no exponent is lost so.
    """
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    centre = low / 2 + high / 2
    exponent = int(np.frexp((high / 2 - low / 2).max())[1])

    def local(corners: Float) -> Float:
        scaled: Float = np.ldexp(corners - centre, -exponent)
        return scaled

    return local, exponent


def boxes_of(triangles: Triangles, labels: NDArray[np.int32], count: int) -> Float:
    """Return the boxes (count, 2, 3) of pieces; labels (n,) of −1 are in none."""
    boxes = np.empty((count, 2, 3))
    boxes[:, 0], boxes[:, 1] = np.inf, -np.inf
    for start in range(0, triangles.count, _CHUNK):
        label = labels[start : start + _CHUNK]
        order = np.argsort(label, kind="stable")
        order = order[label[order] >= 0]
        if len(order) == 0:
            continue
        corners = triangles.corners(start, start + _CHUNK)[order]
        present, begin = np.unique(label[order], return_index=True)
        least, greatest = corners.min(axis=1), corners.max(axis=1)
        boxes[present, 0] = np.minimum(boxes[present, 0], np.minimum.reduceat(least, begin))
        boxes[present, 1] = np.maximum(boxes[present, 1], np.maximum.reduceat(greatest, begin))
    return boxes


def enclosed(triangles: Triangles, labels: NDArray[np.int32], local: Local, origins: Float) -> tuple[Float, Float]:
    """Return each piece's signed volume, ∑ a·(b−a)×(c−a) / 6 about its own origin, and what rounding can do to it."""
    volume, magnitude = np.zeros(len(origins)), np.zeros(len(origins))
    for start in range(0, triangles.count, _CHUNK):
        label = labels[start : start + _CHUNK]
        labelled = label >= 0
        label = label[labelled]
        corners = local(triangles.corners(start, start + _CHUNK)[labelled]) - origins[label, None]
        a, b, c = corners.transpose(1, 0, 2)
        terms = (a * np.cross(b - a, c - a)).sum(axis=1)
        largest = np.sqrt((a * a).sum(axis=1) * ((b - a) ** 2).sum(axis=1) * ((c - a) ** 2).sum(axis=1))
        volume += np.bincount(label, terms, len(origins))
        magnitude += np.bincount(label, largest, len(origins))
    return volume / 6, _NOISE * magnitude / 6
