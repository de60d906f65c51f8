"""The compiled sums of many small surfaces, each of one block: in float64 and in double-double; see `small`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mass.triangles import double_double_kernel, moment_kernel
from inertia.mass.triangles.double_double_kernel import TERMS
from inertia.mass.triangles.fetch_kernel import DEPTH, LANES, address, fetch_faces
from inertia.mass.triangles.moment_kernel import ROWS

SAMPLED = 64  # as `sums.local_frame`
LEAST, MOST = 2.0**-100, 2.0**99
COLUMNS = 3 + ROWS + 2 * TERMS
"""Origin, the row of `moment_kernel`, that of `double_double_kernel`."""


@njit(inline="always")
def local_frame(points, corners, count, origin):
    """Write the local origin, and say whether the size asks for no scaling."""
    step = max(1, count // SAMPLED)
    largest = 0.0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for k in range(0, count, step):
            for corner in range(3):
                x = points[corners[k, corner], axis]
                low, high = min(low, x), max(high, x)
        origin[axis] = low + 0.5 * (high - low)
        largest = max(largest, max(high - origin[axis], origin[axis] - low))
    return LEAST <= largest < MOST


def sum_small(vertices_at, vertices, faces_at, faces, table_at, meshes, usable_at, scratch, out_at):
    """Sum over each of `meshes` surfaces that is usable, a row each; where one is too large or too small, it is not.

    A row of the table is (first vertex, vertices, first face, faces) of a surface of at most a block, whose faces
    number its vertices from 0 on.
    """
    points = carray(vertices_at, (vertices, 3), np.float64)
    corners = carray(faces_at, (faces, 3), np.int64)
    table = carray(table_at, (meshes, 4), np.int64)
    usable = carray(usable_at, (meshes,), np.bool_)
    out = carray(out_at, (meshes, COLUMNS), np.float64)
    room = carray(scratch, (9 + ROWS + 2 * TERMS, LANES), np.float64)
    corner, total, pairs = room[:9], room[9 : 9 + ROWS], room[9 + ROWS :]
    for mesh in range(meshes):
        if not usable[mesh]:
            continue
        start, size, begin, count = table[mesh, 0], table[mesh, 1], table[mesh, 2], table[mesh, 3]
        here, own, row = points[start : start + size], corners[begin : begin + count], out[mesh]
        if count > LANES * DEPTH or not local_frame(here, own, count, row):
            usable[mesh] = False
            continue
        moment_kernel.clear(total)
        double_double_kernel.clear(pairs)
        for first in range(0, count, LANES):
            fetch_faces(address(vertices_at, 24 * start), own, first, count, scratch, corner)
            moment_kernel.add(corner, total, row[0], row[1], row[2], 0)
            double_double_kernel.terms(corner, pairs, row[0], row[1], row[2], True)
        moment_kernel.finish(total, out[mesh : mesh + 1, 3 : 3 + ROWS], 0)
        double_double_kernel.finish(pairs, out[mesh : mesh + 1, 3 + ROWS :], 0)
    return 0
