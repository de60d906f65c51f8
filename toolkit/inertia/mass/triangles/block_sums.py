"""Sums over surfaces of at most a block of triangles, in float64 and in double-double, in one compiled pass."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mass.triangles.kernels import BLOCK
from inertia.mass.triangles.sums import SUMS, PlainSums
from inertia.mesh.surface import Surface, Triangles
from inertia.native import Kernel, place

_KERNEL = Kernel("inertia.mass.triangles.small_kernel", "sum_small", "pipipippp", wide=True)
_COLUMNS = 3 + SUMS + 6 + 20
_ROOM = 48 * 32 + 8


def sum_each(vertices: Float, faces: Int, table: Int, usable: Bool) -> Float:
    """Return a row for each surface of a batch (see `inertia.mesh.geometry.simple`) that is usable.

    A row holds the origin, the thirteen sums and the extents of `inertia.mass.triangles.sums`, and the first ten sums
    in double-double, high and low. One that is larger than a block, or of extreme size, is marked as not usable.
    """
    rows, room = np.empty((len(table), _COLUMNS)), np.empty(_ROOM)
    scratch = place(room)
    _KERNEL.function(
        place(vertices), len(vertices), place(faces), len(faces), place(table), len(table), place(usable),
        scratch + -scratch % 64, place(rows),
    )  # fmt: skip
    return rows


def of_row(row: Float, count: int) -> PlainSums:
    """Return the sums over so many triangles that a row holds."""
    end = 3 + SUMS
    sums, low, high, finer = row[3:end], row[end : end + 3], row[end + 3 : end + 6], row[end + 6 :].tolist()
    return PlainSums(row[:3], 0, low, high, count, float(sums[11]), sums, (finer[::2], finer[1::2]))


def sum_block(triangles: Triangles) -> PlainSums | None:
    """Return the sums over a surface with finite coordinates; None where it is larger than a block, or of extreme size.

    They have the bits of `inertia.mass.triangles.sums.sum_triangles`.
    """
    count = triangles.count
    if count > BLOCK:
        return None
    if isinstance(triangles, Surface):
        vertices, faces = triangles.vertices, triangles.faces
    else:
        vertices, faces = triangles.corners().reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)
    usable = np.ones(1, bool)
    rows = sum_each(vertices, faces, np.array([[0, len(vertices), 0, count]]), usable)
    return of_row(rows[0], count) if usable[0] else None
