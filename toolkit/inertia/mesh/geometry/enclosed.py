"""Pieces of a surface: their boxes, the volumes that they enclose, and some triangles of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int, cut_by
from inertia.mesh.surface import Facets, Surface, Triangles
from inertia.native import Kernel, address

_CHUNK = 1 << 16
_SAMPLES = 8  # triangles of a piece that are drawn
_MANY = 1 << 12  # triangles of a piece, of which few are picked before they are sorted
_CACHED = 1 << 15  # triangles that the compiled pass reads at a time
_COLUMNS = 12  # as the kernel has them, and the next
_TINY = 2.0**-900  # above what squares that underflow are off by
_MODULE, _ABI = "inertia.mesh.geometry.shell_kernel", "pippi" + "pi" + "pp"
MEASURE = Kernel(_MODULE, "measure_shells", _ABI, fused=True)
FINELY = Kernel(_MODULE, "measure_finely", _ABI + "p", fused=True)

RUN, FEW = 64, 4
"""Triangles of a run, and of a few, that boxes are kept of."""

NOISE = 1e-13
"""Rounding of a volume, over the sum of its terms' largest magnitudes."""

STORED = 2.0**-50
"""The same, for each time that a sum is rounded."""

Local = Callable[[Float], Float]


def scaling(boxes: Float) -> tuple[Local, int]:
    """Return what shifts to the middle of all boxes and divides by a power of two, and its exponent.

    No digit and no exponent is lost so.
    """
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    centre = low / 2 + high / 2
    exponent = int(np.frexp((high / 2 - low / 2).max())[1])

    def local(corners: Float) -> Float:
        scaled: Float = np.ldexp(corners - centre, -exponent)
        return scaled

    return local, exponent


def members_of(labels: NDArray[np.int32], count: int) -> list[Int]:
    """Return the numbers of the triangles of each piece, ascending; labels (n,) of −1 are in none."""
    order = np.argsort(labels, kind="stable")
    sizes = np.bincount(labels[labels >= 0], minlength=count)
    return cut_by(order[len(order) - sizes.sum() :], sizes)


def boxes_of(triangles: Triangles, labels: NDArray[np.int32], count: int, *, finite: bool = False) -> Float:
    """Return the boxes (count, 2, 3) of pieces; labels (n,) of −1 are in none. `finite` is what is known of all."""
    if finite and MEASURE.worthwhile(triangles.count):
        return measured(triangles, labels, count).table[:, :6].reshape(-1, 2, 3)
    boxes = np.empty((count, 2, 3))
    boxes[:, 0], boxes[:, 1] = np.inf, -np.inf
    for start in range(0, triangles.count, _CHUNK):
        label = labels[start : start + _CHUNK]
        order = np.argsort(label, kind="stable")
        order = order[label[order] >= 0]
        if len(order) == 0:
            continue
        corners = triangles.corners(start, start + _CHUNK)[order]
        present, begin = np.unique(label[order], return_index=True)
        least, greatest = corners.min(axis=1), corners.max(axis=1)
        boxes[present, 0] = np.minimum(boxes[present, 0], np.minimum.reduceat(least, begin))
        boxes[present, 1] = np.maximum(boxes[present, 1], np.maximum.reduceat(greatest, begin))
    return boxes


def enclosed(triangles: Triangles, labels: NDArray[np.int32], local: Local, origins: Float) -> tuple[Float, Float]:
    """Return each piece's signed volume, ∑ a·(b−a)×(c−a) / 6 about its own origin, and what rounding can do to it."""
    volume, magnitude = np.zeros(len(origins)), np.zeros(len(origins))
    for start in range(0, triangles.count, _CHUNK):
        label = labels[start : start + _CHUNK]
        labelled = label >= 0
        label = label[labelled]
        corners = local(triangles.corners(start, start + _CHUNK)[labelled]) - origins[label, None]
        a, b, c = corners.transpose(1, 0, 2)
        terms = (a * np.cross(b - a, c - a)).sum(axis=1)
        largest = np.sqrt((a * a).sum(axis=1) * ((b - a) ** 2).sum(axis=1) * ((c - a) ** 2).sum(axis=1))
        volume += np.bincount(label, terms, len(origins))
        magnitude += np.bincount(label, largest, len(origins))
    return volume / 6, NOISE * magnitude / 6


class Measured(NamedTuple):
    """Pieces as they are measured, and runs of triangles one after another.

    Attributes
    ----------
    table : the box, six times the volume and other numbers of each piece (m, 12): see `shell_kernel`
    boxes : (k, 6), the least and the largest coordinates of each run
    shell : (k,), the piece of each run; negative where it is in none, or in several
    few : (j, 6), boxes around each `FEW` triangles one after another; none where they were not asked for
    """

    table: Float
    boxes: Float
    shell: NDArray[np.int32]
    few: NDArray[np.float32]


def measured(triangles: Triangles, labels: NDArray[np.int32], count: int, *, few: bool = False) -> Measured:
    """Measure pieces, and runs of triangles; with the boxes of a `few`, sizes must be in the range of float32."""
    runs, more = -(-triangles.count // RUN), -(-triangles.count // FEW) if few else 0
    boxes = np.empty((runs, 6)), np.empty(runs, np.int32), np.empty((more, 6), np.float32)
    pieces = Measured(np.zeros((count, _COLUMNS)), *boxes)
    for which, *chunk in chunks(triangles, labels):
        first = which.start // RUN
        own = *chunk, address(pieces.table), count, pieces.boxes[first:].ctypes.data, pieces.shell[first:].ctypes.data
        if few:
            FINELY.function(*own, pieces.few[which.start // FEW :].ctypes.data)
        else:
            MEASURE.function(*own)
    return pieces


def in_runs(flags: NDArray[np.uint8], run: int, count: int) -> Int:
    """Return which of `count` triangles are in runs that are flagged (k,), ascending."""
    which = (run * np.flatnonzero(flags)[:, None] + np.arange(run)).ravel()
    return which if len(which) == 0 or which[-1] < count else which[which < count]


def all_outward(triangles: Triangles, labels: NDArray[np.int32], count: int) -> bool:
    """Say whether all pieces are sure to enclose more than nothing; where it takes long to find out, they are not."""
    if not MEASURE.worthwhile(triangles.count):
        return False
    _, _, _, _, _, _, volume, squares, _, _, _, number = measured(triangles, labels, count).table.T
    with np.errstate(over="ignore", invalid="ignore"):
        sure = volume > (NOISE + number * STORED) * np.sqrt(number * squares)
    return bool((sure & (squares > _TINY)).all())


def chunks(triangles: Triangles, labels: NDArray[np.integer[Any]]) -> Iterator[tuple[slice, int, int, int, int, int]]:
    """Yield the triangles chunk by chunk: which they are, and where vertices, faces and labels lie, with numbers.

    Of records the number of vertices is −1; they lie where vertices would.
    """
    # Whatever has its arrays in memory is one chunk.
    size = max(triangles.count, 1) if type(triangles) is Surface else _CACHED
    for start in range(0, triangles.count, size):
        own = labels[start : start + size]
        if isinstance(triangles, Facets):
            stored = triangles.corners_f4(start, start + size)
            places = stored.ctypes.data, -1, 0
        else:
            faces = np.ascontiguousarray(triangles.block(start, start + size))
            places = triangles.vertices.ctypes.data, len(triangles.vertices), faces.ctypes.data
        yield slice(start, start + len(own)), *places, own.ctypes.data, len(own)


def drawn(triangles: Triangles, order: list[Int], pieces: Int) -> Int:
    """Draw `_SAMPLES` triangles of each piece by lot (k, s), which is cast by their corners and not by their order.

    `order` are the numbers of the triangles of every piece, `pieces` (k,) those that are asked for.
    """
    sizes = np.array([len(order[piece]) for piece in pieces.tolist()], np.int64)
    members = np.concatenate([np.empty(0, np.int64), *(order[piece] for piece in pieces.tolist())])
    lot = np.empty(len(members), np.uint64)
    for start in range(0, len(members), _CHUNK):
        corners = triangles.select(members[start : start + _CHUNK]).corners() + 0.0
        mixed = np.zeros(corners.shape[:2], np.uint64)
        for axis in range(3):
            mixed = (mixed ^ corners[..., axis].view(np.uint64)) * np.uint64(0x9E3779B97F4A7C15)
            mixed ^= mixed >> np.uint64(32)
        lot[start : start + _CHUNK] = mixed.sum(axis=1) * np.uint64(0xBF58476D1CE4E5B9)
    owner, ends, few = np.repeat(np.arange(len(pieces)), sizes), np.cumsum(sizes), np.ones(len(lot), bool)
    for k in np.flatnonzero(sizes > _MANY):  # so that only few need sorting
        own = slice(ends[k] - sizes[k], ends[k])
        few[own] = lot[own] <= np.partition(lot[own], _SAMPLES - 1)[_SAMPLES - 1]
    members, lot, owner = members[few], lot[few], owner[few]
    ranked, sizes = np.lexsort((lot, owner)), np.bincount(owner, minlength=len(pieces))
    turn = np.arange(_SAMPLES) % sizes[:, None]
    return members[ranked[(np.cumsum(sizes) - sizes)[:, None] + turn]]
