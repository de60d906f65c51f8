"""How deep bodies may reach into each other and only touch: as deep as rounding makes them."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float

CONTACT = 1e-6
"""Depth below which bodies only touch, over the largest extent of the smaller one."""

_LAST_DIGITS = 4  # the same, over the spacing of the stored numbers at the largest coordinate


def contact_depth(vertices: Float, size: float) -> float:
    """Return the depth below which bodies only touch, the smaller of them being of this size."""
    return max(CONTACT * size, _LAST_DIGITS * _last_digit(vertices))


def contact_depths(vertices: Float, boxes: Float) -> Float:
    """Return what `contact_depth` does for pairs of bodies with boxes (k, 2, 2, 3), or less."""
    size = np.ptp(boxes, axis=2).max(axis=2).min(axis=1)
    largest = np.abs(boxes).max(axis=(1, 2, 3))
    with np.errstate(over="ignore", under="ignore"):
        single = largest.astype(np.float32) if (vertices.astype(np.float32) == vertices).all() else largest
    depths: Float = np.maximum(CONTACT * size, _LAST_DIGITS * np.spacing(single))
    return depths


def _last_digit(vertices: Float) -> float:
    """Return the spacing at the largest coordinate: of float32 if all are such numbers, else of float64."""
    largest = np.abs(vertices).max()
    with np.errstate(over="ignore", under="ignore"):
        single = vertices.astype(np.float32)
    return float(np.spacing(np.float32(largest) if (single == vertices).all() else largest))
