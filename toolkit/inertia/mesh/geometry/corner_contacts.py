"""Shells that have corners and edges in common, as those of voxels do, and meet nowhere else.

Two triangles meet in nothing but the corners that they have in common where their boxes meet only there, where all
other corners of one are on one side of the other's plane, or, in one plane, beyond one of its sides. If that is so of
all triangles of two shells, neither leads from the outside of the other to its inside but at common edges, around which
material is ordered by angle, exactly (`inertia.mesh.geometry.edge_fans`). Where no place there has it twice, each shell
is outside the other as a whole, or inside it as a whole.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.edge_fans import layered
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.triangle_pairs import LARGEST, orient3d
from inertia.native import Kernel, address, place

_AT_ONCE = 1 << 12  # pairs of triangles looked at together
_SETTLE = Kernel("inertia.mesh.geometry.corner_kernel", "settle_pairs", "pppi" + "pipippp")
_WORK = 20  # times what integrating a triangle costs, without the kernel
_ROOM = 256  # numbers that the kernel needs


def beyond_corners(vertices: Float, faces: Int, shell: Int, body: Int, turned: Bool, boxes: Float, pairs: Int) -> Int:
    """Return those of pairs of shells that may meet beyond common corners, or share space around common edges.

    Parameters
    ----------
    vertices, faces : (n, 3) different points and (m, 3), of closed shells; no face repeats a corner
    shell : (m,), the shell of each face
    body : (m,), the body of each face
    turned : (m,), faces to be read with the opposite winding
    boxes : (s, 2, 3), least and greatest coordinates of shells
    pairs : (k, 2), ascending, the lower number first
    """
    keys, beyond = pairs[:, 0] * len(boxes) + pairs[:, 1], ~_share_corners(faces, shell, pairs)
    if beyond.all():
        return pairs
    corners, edges = vertices[faces], half_edges(faces)
    clear = ~layered(vertices, faces, edges, body, turned)[edges.edge].reshape(-1, 3)
    rank = np.empty(len(boxes), np.int64)
    rank[BoxTree(boxes[:, 0], boxes[:, 1]).order] = np.arange(len(boxes))
    for i, j, _ in overlapping(BoxTree(corners.min(axis=1), corners.max(axis=1), rank[shell]), touching=True):
        low, high = np.minimum(shell[i], shell[j]), np.maximum(shell[i], shell[j])
        key = low * len(boxes) + high
        pair = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
        asked = np.flatnonzero((keys[pair] == key) & ~beyond[pair])
        asked = asked[_settle(corners, faces, clear, np.column_stack([i[asked], j[asked], pair[asked]]), beyond)]
        asked = asked[~beyond[pair[asked]]]
        asked = asked[np.argsort(_times_before(pair[asked]), kind="stable")]  # one of many may tell of two shells
        while len(asked):
            some, asked = asked[:_AT_ONCE], asked[_AT_ONCE:]
            common, there = _common_corners(corners, faces, i[some], j[some])
            there &= (~(common & np.roll(common, -1, axis=1)) | clear[i[some]]).all(axis=1)
            beyond[pair[some[~there]]] = True
            asked = asked[~beyond[pair[asked]]]
    return pairs[beyond]


def _settle(corners: Float, faces: Int, clear: Bool, listed: Int, beyond: Bool) -> Int:
    """Mark pairs of shells by a kernel, of listed triangles (k, 3) of them; return which of these it leaves open."""
    if not np.abs(corners).max() <= LARGEST or not _SETTLE.worthwhile(_WORK * len(listed)):
        return np.arange(len(listed))
    unsure, own, work = np.zeros(len(listed), bool), np.empty((4, 9)), np.empty(_ROOM)
    tables = [np.ascontiguousarray(table) for table in (corners, faces, clear, listed)]
    *triangles, pairs = map(place, tables)
    _SETTLE.function(
        *triangles, len(faces), pairs, len(listed), place(beyond), len(beyond), address(own), address(work),
        place(unsure),
    )  # fmt: skip
    return np.flatnonzero(unsure)


def _times_before(values: Int) -> Int:
    """Return how often each of the numbers (k,) stands before its place."""
    order = np.argsort(values, kind="stable")
    first = np.searchsorted(values[order], values[order])
    times = np.empty(len(values), np.int64)
    times[order] = np.arange(len(values)) - first
    return times


def _share_corners(faces: Int, shell: Int, pairs: Int) -> Bool:
    """Say which pairs (k, 2) of shells have a corner in common."""
    count = int(faces.max()) + 1
    keys = np.unique(shell[:, None] * count + faces)
    shared = np.bincount(keys % count)[keys % count] > 1
    keys, starts = keys[shared], np.searchsorted(keys[shared], np.arange(shell.max() + 2) * count)
    sizes = np.diff(starts)[pairs[:, 0]]
    pair = np.repeat(np.arange(len(pairs)), sizes)
    own = np.arange(len(pair)) + np.repeat(starts[pairs[:, 0]] - np.cumsum(sizes) + sizes, sizes)
    found = np.isin(pairs[pair, 1] * count + keys[own] % count, keys)
    shares: Bool = np.bincount(pair[found], minlength=len(pairs)) > 0
    return shares


def _common_corners(corners: Float, faces: Int, one: Int, other: Int) -> tuple[Bool, Bool]:
    """Say which corners of triangles `one` (k, 3) those of `other` have too, and of which pairs that all meet there."""
    same = faces[one][:, :, None] == faces[other][:, None, :]
    common, there = same.any(axis=2), _in_boxes(corners[one], corners[other], same)
    for these, those, axis in ((one, other, 1), (other, one, 2)):
        left = np.flatnonzero(~there)
        a, b, c = corners[these[left]].transpose(1, 0, 2)[:, :, None]
        side = orient3d(a, b, c, corners[those[left]])
        shared = same[left].any(axis=axis)
        side[shared] = 0
        there[left] = ((side > 0) | shared).all(axis=1) | ((side < 0) | shared).all(axis=1)
        level = left[(side == 0).all(axis=1) & ~there[left]]
        there[level] = _in_plane(corners[these[level]], corners[those[level]], same[level].transpose(0, axis, 3 - axis))
    return common, there


def _in_plane(a: Float, b: Float, same: Bool) -> Bool:
    """Say which triangles b (k, 3, 3), in the planes of others, a, are parted from these by a side but at its ends.

    `same` is (k, 3, 3), whether corners of a are corners of b.
    """
    normal = np.abs(np.cross(a[:, 1] - a[:, 0], a[:, 2] - a[:, 0]))
    lift = np.eye(3)[normal.argmax(axis=1)]
    a, b = (k * (1 - lift[:, None]) for k in (a, b))  # seen along an axis, along which neither is upright
    parted = np.zeros(len(a), bool)
    for k in range(3):
        start, end, third = (a[:, (k + turn) % 3] for turn in range(3))
        own = orient3d(start, end, start + lift, third)
        side = orient3d(start[:, None], end[:, None], (start + lift)[:, None], b)
        at_ends = same[:, k] | same[:, (k + 1) % 3]
        parted |= (own != 0) & ((side == -own[:, None]) | at_ends).all(axis=1)
    return parted


def _in_boxes(a: Float, b: Float, same: Bool) -> Bool:
    """Say of which pairs of triangles (k, 3, 3) comparing coordinates shows that they meet at common corners alone.

    Where one ends along an axis and the other begins, they meet at corners that lie there, and so on of these.
    """
    shown = np.zeros(len(a), bool)
    which, left_a, left_b = np.arange(len(a)), np.ones(a.shape[:2], bool), np.ones(b.shape[:2], bool)
    for _ in range(3):
        (low_a, high_a), (low_b, high_b) = (_extents(k[which], left) for k, left in ((a, left_a), (b, left_b)))
        ends, begins = high_a == low_b, low_a == high_b
        for meet, at in ((ends, high_a), (begins, low_a)):
            left_a &= _all(~meet[:, None] | (a[which] == at[:, None]))
            left_b &= _all(~meet[:, None] | (b[which] == at[:, None]))
        apart = _any((low_a > high_b) | (low_b > high_a))
        there = _all(_any(same[which]) | ~left_a) | _all(_any(same[which].transpose(0, 2, 1)) | ~left_b)
        shown[which[apart | there]] = True
        more = ~apart & ~there & (_any(ends) | _any(begins))
        which, left_a, left_b = which[more], left_a[more], left_b[more]
    return shown


def _extents(corners: Float, left: Bool) -> tuple[Float, Float]:
    """Return the least and the largest coordinates (k, 3) of those corners (k, 3, 3) that are left (k, 3)."""
    least, most = (np.where(left[..., None], corners, limit) for limit in (np.inf, -np.inf))
    return (
        np.minimum(np.minimum(least[:, 0], least[:, 1]), least[:, 2]),
        np.maximum(np.maximum(most[:, 0], most[:, 1]), most[:, 2]),
    )


def _all(three: Bool) -> Bool:
    """Say where all of three (..., 3) are true, which takes a tenth of numpy's time along an axis so short."""
    every: Bool = three[..., 0] & three[..., 1] & three[..., 2]
    return every


def _any(three: Bool) -> Bool:
    some: Bool = three[..., 0] | three[..., 1] | three[..., 2]
    return some
