"""The section of a rotor across its shaft: closed loops where a plane z = const. cuts the surfaces of its bodies."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.mesh.part import Part


def section(parts: Iterable[Part], shaft: Shaft, z: float, *, triangles_at_once: int = 100_000) -> list[Float]:
    """Return the loops (k, 2) m, in x′ and y′ of the shaft, in which a plane cuts bodies; material is on their left.

    A corner in the plane counts as above it. Loops that do not close, of an open surface, end where they end.

    Parameters
    ----------
    parts : in part axes
    shaft : in part axes
    z : m along the shaft
    triangles_at_once : how many are in memory together
    """
    return [loop for part in parts for loop in _loops(_segments(part, shaft, z, triangles_at_once))]


def _segments(part: Part, shaft: Shaft, z: float, at_once: int) -> Float:
    """Return the pieces (m, 2, 2) of the section: start and end, with the material on the left."""
    metres, triangles = float(part.unit.metres), part.triangles
    pieces = [np.empty((0, 2, 2))]
    for start in range(0, triangles.count, at_once):
        corners = shaft.to_shaft(metres * triangles.corners(start, start + at_once))
        above = corners[..., 2] >= z
        crossing = above.any(axis=1) & ~above.all(axis=1)
        corners, above = corners[crossing], above[crossing]
        following, after = np.roll(corners, -1, axis=1), np.roll(above, -1, axis=1)
        # From the lower end to the upper one, so that both triangles at an edge give the same point to the last bit.
        low, high = np.where(above[..., None], following, corners), np.where(above[..., None], corners, following)
        with np.errstate(divide="ignore", invalid="ignore"):  # edges that do not cross
            at = low + ((z - low[..., 2]) / (high[..., 2] - low[..., 2]))[..., None] * (high - low)
        down, up = at[above & ~after], at[~above & after]
        pieces.append(np.stack([down, up], axis=1)[..., :2])
    return np.concatenate(pieces)


def _loops(segments: Float) -> list[Float]:
    """Return segments (m, 2, 2) joined end to start."""
    segments = segments[(segments[:, 0] != segments[:, 1]).any(axis=1)]
    starting = defaultdict(list)
    for number, start in enumerate(map(tuple, segments[:, 0].tolist())):
        starting[start].append(number)
    loops, free = [], np.ones(len(segments), bool)
    for first in range(len(segments)):
        chain, here = [], first
        while free[here]:
            free[here] = False
            chain.append(segments[here, 0])
            following = [k for k in starting[tuple(segments[here, 1].tolist())] if free[k]]
            if not following:
                chain.append(segments[here, 1])
                break
            here = following[0]
        if len(chain) > 2:
            loops.append(np.array(chain))
    return loops
