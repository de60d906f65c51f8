"""Boxes around triangles along axes of their own: those of long, thin triangles side by side hardly overlap.

The boxes of `inertia.mesh.geometry.boxes` lie along the axes of coordinates. Around triangles that reach slantwise
along a cylinder, or around a cone, each of them overlaps a good part of all others. A box along the principal axes of
its triangles' corners is as thin as they are (S. Gottschalk, M. C. Lin and D. Manocha, "OBBTree", SIGGRAPH 1996, §4).
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.records import dataclass

_ROUNDING = 2.0**-44  # more than the rounding of projections, over the largest coordinate
_HIGHEST = 10  # 2^10 triangles and more are as well enclosed in any box


@dataclass(frozen=True, eq=False)
class OrientedBoxes:
    """Boxes around 1, 2, 4, ... triangles in order; each is around its middle along three axes.

    Attributes
    ----------
    middle, axes, half : of each height, (k, 3), (k, 3, 3), an axis a row, and (k, 3), half its sides
    """

    middle: list[Float]
    axes: list[Float]
    half: list[Float]

    @classmethod
    def around(cls, corners: Float, highest: int = _HIGHEST) -> OrientedBoxes:
        """Enclose triangles (n, 3, 3) in order, the coordinates of which are no larger than 1, up to a height."""
        levels: tuple[list[Float], list[Float], list[Float]] = ([], [], [])
        for height in range(highest + 1):
            size = 1 << height
            missing = -len(corners) % size
            padded = np.concatenate([corners, np.broadcast_to(corners[-1:], (missing, 3, 3))])
            points = padded.reshape(len(padded) // size, -1, 3)
            centre = points.mean(axis=1)
            own = points - centre[:, None]
            _, axes = np.linalg.eigh(own.transpose(0, 2, 1) @ own)
            along = own @ axes
            low, high = along.min(axis=1), along.max(axis=1)
            turned = axes.transpose(0, 2, 1)
            middle = centre + ((low + high)[:, None] / 2 @ turned)[:, 0]
            for level, values in zip(levels, (middle, turned, (high - low) / 2 + _ROUNDING), strict=True):
                level.append(values)
            if len(points) == 1:
                break
        return cls(*levels)

    def meeting(self, other: OrientedBoxes, height: int, i: Int, j: Int) -> Bool:
        """Say which boxes (k,) of a height no plane along a side of either parts from those of others.

        All of them above the highest that there are.
        """
        if height >= min(len(self.middle), len(other.middle)):
            return np.ones(len(i), bool)
        way = other.middle[height][j] - self.middle[height][i]
        axes, half = self.axes[height][i], self.half[height][i]
        turn = np.abs(axes @ other.axes[height][j].transpose(0, 2, 1))
        reach = half + np.einsum("kij,kj->ki", turn, other.half[height][j])
        meets: Bool = (np.abs(np.einsum("kij,kj->ki", axes, way)) <= reach).all(axis=1)
        left = np.flatnonzero(meets)
        reach = other.half[height][j[left]] + np.einsum("ki,kij->kj", half[left], turn[left])
        meets[left] = (np.abs(np.einsum("kij,kj->ki", other.axes[height][j[left]], way[left])) <= reach).all(axis=1)
        return meets
