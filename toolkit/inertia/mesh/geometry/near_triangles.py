"""Triangles of many pairs of bodies that come near each other, touch or cross."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from inertia.arrays import Float, Int, runs_of
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.closure import merge_equal_vertices
from inertia.mesh.geometry.triangle_pairs import crossing, held_apart, orient3d_filter, unit_normals
from inertia.mesh.surface import Surface

COMPARED = 1 << 12
"""Pairs of triangles of two bodies, at most, that are compared without a tree."""

_AT_ONCE = 1 << 18  # pairs of triangles compared together
_SURE = 1e-12  # of how far triangles are from each other: heights that rounding does not make


def ranges(starts: Int, counts: Int) -> tuple[Int, Int]:
    """Return all numbers of ranges that begin at `starts` (k,), and of which of these each is."""
    owner = np.repeat(np.arange(len(starts)), counts)
    return np.arange(len(owner)) + np.repeat(starts - np.cumsum(counts) + counts, counts), owner


def near_triangles(corners: Float, sides: Sequence[tuple[Int, Int]]) -> tuple[Int, Int, Int]:
    """Return pairs of triangles whose boxes meet: of which pair of bodies each is, and their numbers.

    Parameters
    ----------
    corners : (t, 3, 3)
    sides : of each pair of bodies, numbers of the triangles of the one and of the other
    """
    counts = np.array([[len(one), len(other)] for one, other in sides], np.int64).reshape(-1, 2)
    rank, owner = ranges(np.zeros(len(sides), np.int64), counts.prod(axis=1))
    one, other = (np.concatenate([np.empty(0, np.int64), *(side[k] for side in sides)]) for k in range(2))
    begins = np.cumsum(counts, axis=0) - counts
    i, j = begins[owner, 0] + rank // counts[owner, 1], begins[owner, 1] + rank % counts[owner, 1]
    (lowest, highest), (low, high) = ((corners[own].min(axis=1), corners[own].max(axis=1)) for own in (one, other))
    near = ((lowest[i] <= high[j]) & (low[j] <= highest[i])).all(axis=1)
    return owner[near], one[i[near]], other[j[near]]


def touching_triangles(corners: Float, sides: Sequence[tuple[Int, Int]]) -> tuple[Int, Int, Int]:
    """Return pairs of triangles that neither's plane holds apart, as far as float64 can tell, as `near_triangles`."""
    found = [(np.empty(0, np.int64),) * 3]
    for near in _near(corners, sides):
        for k in (1, 2):
            plane = corners[near[k]]
            others = corners[near[3 - k]]
            far = np.abs(others - plane[:, :1]).max(axis=(1, 2))
            left = np.flatnonzero(~held_apart(plane, unit_normals(plane), others, _SURE * far))
            plane = plane[left, None]
            side = orient3d_filter(plane[:, :, 0], plane[:, :, 1], plane[:, :, 2], others[left])
            left = left[~((side == 1).all(axis=1) | (side == -1).all(axis=1))]
            near = near[0][left], near[1][left], near[2][left]
        found.append(near)
    of_pair, i, j = (np.concatenate(column) for column in zip(*found, strict=True))
    return of_pair, i, j


def crossing_triangles(corners: Float, i: Int, j: Int) -> Int:
    """Return which pairs of triangles (k,), (k,) cross."""
    both = corners[np.column_stack([i, j]).ravel()].reshape(-1, 3)
    vertices, faces = merge_equal_vertices(Surface(both, np.arange(len(both)).reshape(-1, 3)))
    return crossing(vertices, faces[0::2], faces[1::2])[0]


def _near(corners: Float, sides: Sequence[tuple[Int, Int]]) -> Iterator[tuple[Int, Int, Int]]:
    """Yield what `near_triangles` returns, in pieces, whatever the number of triangles."""
    work = np.array([len(one) * len(other) for one, other in sides], np.int64)
    few = np.flatnonzero(work <= COMPARED)
    for run in runs_of(work[few], _AT_ONCE):
        owner, i, j = near_triangles(corners, [sides[k] for k in few[run].tolist()])
        yield few[run][owner], i, j
    for k in np.flatnonzero(work > COMPARED).tolist():
        trees = [BoxTree(corners[own].min(axis=1), corners[own].max(axis=1)) for own in sides[k]]
        for i, j, _ in overlapping(*trees, touching=True):
            yield np.full(len(i), k), sides[k][0][i], sides[k][1][j]
