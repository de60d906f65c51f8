"""Check of small surfaces by one compiled pass: closed, in one piece, and free of triangles that cross.

Corners with equal coordinates are one (−0 equals +0), each edge must have exactly one other that runs against it, and
all triangles must hang together by them. Triangles cross as `inertia.mesh.geometry.triangle_pairs` says. Most pairs
need no look: those around a corner share nothing but the corner and their edges if they can be flattened, that is, if
they all face one way and go around it once, seen from there. Of the others, a plane shows most to be apart, and exact
signs decide the rest. What is not shown to be simple here may still be sound: who wants to know asks
`inertia.mesh.check`.
"""

from __future__ import annotations

import mmap
import threading

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, runs_of
from inertia.mesh.surface import Triangles
from inertia.native import Kernel, address, place

MOST = 200_000
"""Triangles of a surface that is looked at, at most."""

SIMPLE, PIECES = 0, 1
"""What `states` says of a surface that is closed and free of crossings, in one piece or in several."""

_KERNEL = Kernel("inertia.mesh.geometry.simple_kernel", "check_small", "pipipipipp")
_REPAYS = 6_000  # triangles; looking for crossings otherwise takes several times as long
_BYTES = 71_000_000  # that the kernel has its tables in, of which 38 MB are touched for the largest surface, and stay
_own = threading.local()


def at_hand() -> bool:
    """Say whether the compiled pass is, or can be had for the price of what it saves."""
    return _KERNEL.is_shipped and _KERNEL.worthwhile(_REPAYS)  # to compile it takes many seconds


def simple(vertices: Float, faces: Int, table: Int, *, pieces: bool = False) -> Bool:
    """Say of each surface of a batch whether it is shown to be closed, in one piece and free of crossings.

    Parameters
    ----------
    vertices, faces : (v, 3) and (f, 3), of all surfaces one after another
    table : (n, 4), of each the first vertex and how many it has, the first face and how many; faces number the vertices
        of their surface from 0 on
    pieces : whether a surface may be in several pieces, which then do not cross each other either

    >>> cube = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    >>> faces = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    ...                   [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
    >>> simple(cube, faces, np.array([[0, 8, 0, 12], [0, 8, 0, 11]])).tolist()
    [True, False]
    """
    sound: Bool = states(vertices, faces, table) <= (PIECES if pieces else SIMPLE)
    return sound


def not_simple(triangles: Triangles, labels: NDArray[np.int32], which: Int) -> Int:
    """Return those of the triangles numbered (k,) whose shell is not shown to be free of crossings, ascending.

    Parameters
    ----------
    labels : (n,), the shell of each triangle, which has all of its triangles among those numbered
    """
    order, sizes = which[np.argsort(labels[which], kind="stable")], np.bincount(labels[which])
    sizes = sizes[sizes > 0]
    first, left = np.cumsum(sizes) - sizes, [np.empty(0, np.int64)]
    for run in runs_of(sizes, MOST):
        size, start = sizes[run], first[run] - first[run.start]
        own = order[first[run.start] : first[run.start] + size.sum()]
        if len(own) <= MOST:
            corners = triangles.select(own).corners().reshape(-1, 3)
            faces = (np.arange(len(corners)) - 3 * np.repeat(start, 3 * size)).reshape(-1, 3)
            sound = simple(corners, faces, np.column_stack([3 * start, 3 * size, start, size]), pieces=True)
            own = own[~np.repeat(sound, size)]
        left.append(own)
    return np.sort(np.concatenate(left))


def states(vertices: Float, faces: Int, table: Int) -> Int:
    """Return of each surface of a batch `SIMPLE`, or `PIECES` where it is so in several, or more; see `simple`."""
    if not hasattr(_own, "tables"):
        _own.tables = _tables()
    ids, result = np.empty(len(vertices), np.int32), np.empty(len(table), np.int64)
    _KERNEL.function(
        place(vertices), len(vertices), place(faces), len(faces), place(table), len(table), place(ids), len(ids),
        address(_own.tables), place(result),
    )  # fmt: skip
    return result


def _tables() -> mmap.mmap:
    """Return zeroed memory, which takes room page by page as it is touched."""
    memory = mmap.mmap(-1, _BYTES)
    if hasattr(mmap, "MADV_NOHUGEPAGE"):
        memory.madvise(mmap.MADV_NOHUGEPAGE)
    return memory
