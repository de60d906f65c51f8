"""Triangles of many pairs of bodies that come near each other, touch or cross."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from inertia.arrays import Float, Int, runs_of
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.triangle_pairs import UNSURE, cross_signs, crossing, parted
from inertia.mesh.surface import Surface

COMPARED = 1 << 12
"""Pairs of triangles of two bodies, at most, that are compared without a tree."""

_AT_ONCE = 1 << 18  # pairs of triangles compared together


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
    found, faces = [(np.empty(0, np.int64),) * 3], _faces(corners)
    for owner, i, j in _near(corners, sides):
        left = np.flatnonzero(~parted(corners.reshape(-1, 3), faces[i], faces[j]))
        found.append((owner[left], i[left], j[left]))
    of_pair, i, j = (np.concatenate(column) for column in zip(*found, strict=True))
    return of_pair, i, j


def crossing_triangles(corners: Float, i: Int, j: Int) -> Int:
    """Return which pairs of triangles (k,), (k,) cross."""
    faces = _faces(corners)
    sign = cross_signs(corners.reshape(-1, 3), faces[i], faces[j])
    unsure = np.flatnonzero(sign == UNSURE)
    both = corners[np.column_stack([i[unsure], j[unsure]]).ravel()]
    vertices, welded = merge_equal_vertices(Surface(both.reshape(-1, 3), _faces(both)))
    crossed, _ = crossing(vertices, welded[0::2], welded[1::2])
    return np.union1d(np.flatnonzero(sign == 1), unsure[crossed])


def _faces(corners: Float) -> Int:
    """Return the faces (t, 3) of triangles (t, 3, 3) each of which has corners of its own."""
    return np.arange(3 * len(corners)).reshape(-1, 3)


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
