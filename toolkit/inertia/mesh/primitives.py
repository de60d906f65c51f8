"""Triangles of boxes and of bodies of revolution, for drawings, hulls and collisions."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from inertia.arrays import Float

FACETS = 48
"""Sides of a body of revolution, whose corners lie on it."""


def box(half: Float) -> Float:
    """Return the triangles (12, 3, 3) of a box about the origin, by half its edges (3,)."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return np.asarray(corners[np.array(faces)], float)


def ball(steps: int = 13) -> Float:
    """Return the triangles (m, 3, 3) of the unit ball, its rings at `steps` heights."""
    angles = np.arcsin(np.linspace(-1, 1, steps))
    return revolved(np.sin(angles), np.cos(angles))


def revolved(heights: Float, radii: Float, *, hollow: bool = False) -> Float:
    """Return the triangles (m, 3, 3) of a body of revolution about z.

    Parameters
    ----------
    heights, radii : (k,) of its outline, from the bottom up along the outside
    hollow : whether the outline is closed by going back to its beginning; else both ends are closed at the axis
    """
    turns = np.linspace(0, 2 * np.pi, FACETS, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns), np.zeros_like(turns)], axis=1)
    rings = [ring * radius + [0, 0, height] for height, radius in zip(heights, radii, strict=True)]
    if hollow:
        return np.concatenate(list(_bands([*rings, rings[0]])))
    bottom, top = (np.tile([0, 0, heights[k]], (FACETS, 1)) for k in (0, -1))
    return np.concatenate(list(_bands([bottom, *rings])) + list(_bands([rings[-1], top])))


def _bands(rings: list[Float]) -> Iterator[Float]:
    for below, above in pairwise(rings):
        next_below, next_above = np.roll(below, -1, axis=0), np.roll(above, -1, axis=0)
        yield np.stack([below, next_below, next_above], axis=1)
        yield np.stack([below, next_above, above], axis=1)
