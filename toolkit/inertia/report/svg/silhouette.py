"""The outline of a rotor from the side, 0° on top: how far it reaches up and down at each place along the shaft."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.mesh.part import Part

_PLACES = 1000
_STRAIGHT = 1e-4  # of the largest reach


def silhouette(
    parts: Iterable[Part], shaft: Shaft, *, triangles_at_once: int = 20_000, samples_at_once: int = 2_000_000
) -> Float:
    """Return the outline (n, 3) m of bodies on a shaft: z, and the largest and smallest x′ there.

    x′ points to the zero mark, so that a crank shows its throw. Points on a straight line between their neighbours are
    left out.

    Parameters
    ----------
    parts : in part axes
    shaft : in part axes
    triangles_at_once, samples_at_once : how many are in memory together
    """
    surfaces = list(parts)
    spans = [(z.min(), z.max()) for part in surfaces for z, _ in _edges(part, shaft, triangles_at_once)]
    low, high = min(k for k, _ in spans), max(k for _, k in spans)
    reach = np.full((2, _PLACES), -np.inf)
    width = (high - low) / _PLACES
    for part in surfaces:
        for z, x in _edges(part, shaft, triangles_at_once):
            _raise(reach, (z - low) / width, x, samples_at_once)
    reach[~np.isfinite(reach)] = 0.0  # between bodies that do not touch
    outline: Float = np.column_stack([low + width * (np.arange(_PLACES) + 0.5), reach[0], -reach[1]])
    outline[[0, -1], 0] = low, high
    bends = (np.abs(np.diff(reach, 2)) > _STRAIGHT * np.abs(reach).max()).any(axis=0)
    corners: Float = outline[np.concatenate([[True], bends, [True]])]
    return corners


def _edges(part: Part, shaft: Shaft, at_once: int) -> Iterable[tuple[Float, Float]]:
    """Yield z and x′ (m, 2) m of the ends of the edges of a part."""
    metres, triangles = float(part.unit.metres), part.triangles
    for start in range(0, triangles.count, at_once):
        corners = shaft.to_shaft(metres * triangles.corners(start, start + at_once))
        ends = [[0, 1], [1, 2], [2, 0]]
        yield corners[..., 2][:, ends].reshape(-1, 2), corners[..., 0][:, ends].reshape(-1, 2)


def _raise(reach: Float, place: Float, x: Float, at_once: int) -> None:
    """Raise the reach (2, places), up and down, to that of edges; `place` (m, 2) is counted in samples."""
    count = np.ceil(2.0 * np.abs(place[:, 1] - place[:, 0])).astype(np.int64) + 1  # none is passed over
    for few in np.array_split(np.arange(len(count)), 1 + int(count.sum()) // at_once):
        number = count[few]
        edge = np.repeat(few, number)
        step = np.arange(len(edge)) - np.repeat(np.cumsum(number) - number, number)
        t = step / np.repeat(np.maximum(number - 1, 1), number)
        at = (1.0 - t) * place[edge, 0] + t * place[edge, 1]
        here = (1.0 - t) * x[edge, 0] + t * x[edge, 1]
        places = np.clip(at.astype(np.int64), 0, _PLACES - 1)
        np.maximum.at(reach[0], places, here)
        np.maximum.at(reach[1], places, -here)
