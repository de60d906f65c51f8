"""How deep bodies may reach into each other and only touch: as deep as rounding makes them."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float

CONTACT = 1e-6
"""Depth below which bodies only touch, over the largest extent of the smaller one."""

_LAST_DIGITS = 4  # the same, over the spacing of the stored numbers at the largest coordinate


def last_digits(largest: float, *, single: bool) -> float:
    """Return the same where rounding alone counts, by the largest coordinate, and whether all are of float32."""
    fits = single and largest <= float(np.finfo(np.float32).max)
    return _LAST_DIGITS * float(np.spacing(np.float32(largest) if fits else np.float64(largest)))


def contact_depth(vertices: Float, size: float) -> float:
    """Return the depth below which bodies only touch, the smaller of them being of this size."""
    return max(CONTACT * size, last_digits(float(np.abs(vertices).max()), single=are_single(vertices)))


def contact_depths(vertices: Float, boxes: Float) -> Float:
    """Return what `contact_depth` does for pairs of bodies with boxes (k, 2, 2, 3), or less."""
    size = np.ptp(boxes, axis=2).max(axis=2).min(axis=1)
    largest = np.abs(boxes).max(axis=(1, 2, 3))
    with np.errstate(over="ignore", under="ignore"):
        spacing = np.spacing(largest.astype(np.float32) if are_single(vertices) else largest)
    depths: Float = np.maximum(CONTACT * size, _LAST_DIGITS * spacing)
    return depths


def are_single(vertices: Float) -> bool:
    """Say whether all coordinates are numbers of float32."""
    with np.errstate(over="ignore", under="ignore"):
        return bool((vertices.astype(np.float32) == vertices).all())
