"""Shapes around the shaft, and the angles at which each is in a tool's way."""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.corrections.correction_plane import FULL_TURN

_TINY = 1e-12
_NEARLY = 1e-9  # rad


def pairs(low: Float, high: Float, angles: Float) -> tuple[Int, Int]:
    """Return the pairs (item, angle) of items between angles low and high (n,), which may run through 0.

    Parameters
    ----------
    low, high : rad; low in 0 … 2π or a turn below
    angles : (m,) ascending, rad
    """
    around = np.concatenate([angles - FULL_TURN, angles, angles + FULL_TURN, angles + 2 * FULL_TURN])
    high = np.minimum(high, low + FULL_TURN - _TINY)
    start, stop = np.searchsorted(around, low - _NEARLY), np.searchsorted(around, high + _NEARLY, side="right")
    lengths = stop - start
    item = np.repeat(np.arange(len(low)), lengths)
    place = np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths) + np.repeat(start, lengths)
    return item, place % len(angles)


def facing_angles(shapes: Float) -> tuple[Float, Float]:
    """Return the middle of the angles that convex shapes (k, v, 2) take around the shaft, and half of these, rad.

    Half a turn for those that may lie around it.
    """
    flat = shapes[..., 0] + 1j * shapes[..., 1]
    first = np.angle(flat[:, 0])
    turns = (np.angle(flat) - first[:, None] + math.pi) % FULL_TURN - math.pi
    low, high = turns.min(axis=1), turns.max(axis=1)
    whole = high - low >= math.pi * (1 - _NEARLY)
    return (first + 0.5 * (low + high)) % FULL_TURN, np.where(whole, math.pi, 0.5 * (high - low))


def from_shaft(triangles: Float) -> Float:
    """Return how near triangles (k, 3, 2) come to the shaft's axis, 0 for those around it, m."""
    edge = np.roll(triangles, -1, axis=1) - triangles
    length = np.maximum(np.einsum("kvi,kvi->kv", edge, edge), 1e-300)
    share = np.clip(-np.einsum("kvi,kvi->kv", triangles, edge) / length, 0.0, 1.0)
    nearest = np.linalg.norm(triangles + share[..., None] * edge, axis=2).min(axis=1)
    side = triangles[..., 0] * edge[..., 1] - triangles[..., 1] * edge[..., 0]
    around = (side >= 0).all(axis=1) | (side <= 0).all(axis=1)
    return np.where(around, 0.0, nearest)


def gap(values: Float) -> Float:
    """Return how far the least and the greatest along the last axis leave 0 outside."""
    return np.asarray(np.maximum(np.maximum(values.min(axis=-1), -values.max(axis=-1)), 0.0))
