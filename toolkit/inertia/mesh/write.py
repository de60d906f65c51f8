"""Parts → one binary STL file."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.part import Part
from inertia.mesh.readers.stl import HEADER
from inertia.mesh.surface import FACET, Facets, Surface
from inertia.output import require_writable, write_whole
from inertia.units import Unit


def write_stl(parts: Sequence[Part], file: str | os.PathLike[str], unit: Unit, *, force: bool = False) -> None:
    """Write the triangles of parts to a binary STL file, whose header says the unit.

    An STL file holds float32: coordinates are rounded to 6e-8 of their size. What that makes of a part thinner than it,
    triangles whose corners become one and sheets whose sides become one, is left out.

    Raises `UsageError` where the file exists and `force` is not set, or its name does not end in .stl, `InertiaError`
    where it cannot be written.
    """
    path = require_writable(file, ".stl", force=force)
    corners = [part.triangles.corners() * float(part.unit.metres / unit.metres) for part in parts]
    together = np.concatenate([each[_left_by_rounding(each)] for each in corners])
    facets = Facets(np.zeros(len(together), FACET))
    facets.corners_f4()[:] = together
    across = np.cross(together[:, 1] - together[:, 0], together[:, 2] - together[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    facets.records["normal"] = np.divide(across, length, out=np.zeros_like(across), where=length > 0)
    head = f"written by inertia, unit {unit.name}".encode("ascii").ljust(HEADER - 4)
    write_whole(path, head + len(together).to_bytes(4, "little") + facets.records.tobytes())


def _left_by_rounding(corners: Float) -> Bool:
    """Return the triangles (n,) that float32 leaves something of; what is left is closed as it was before."""
    rounded = _numbers(corners.astype(np.float32).astype(float))
    left = ~repeated_corners(rounded)
    pair = _opposite(rounded, np.flatnonzero(left))
    # Where bodies touch, both faces are there before.
    exact = np.sort(_numbers(corners[pair].reshape(-1, 3, 3)).reshape(-1, 2, 3), axis=2)
    left[pair[(exact[:, 0] != exact[:, 1]).any(axis=1)].ravel()] = False
    return left


def _numbers(corners: Float) -> Int:
    places = np.arange(3 * len(corners)).reshape(-1, 3)
    return merge_equal_vertices(Surface(corners.reshape(-1, 3), places))[1]


def _opposite(faces: Int, numbers: Int) -> Int:
    """Return the pairs (k, 2) of faces number `numbers` (m,) with the same corners, turned the other way round."""
    own = faces[numbers]
    first = np.take_along_axis(own, (own.argmin(axis=1)[:, None] + (0, 1, 2)) % 3, axis=1)
    turned = first[:, 1] > first[:, 2]
    low, high = first[:, 1:].min(axis=1), first[:, 1:].max(axis=1)
    order = np.lexsort((turned, high, low, first[:, 0]))
    key = np.column_stack([first[:, 0], low, high])[order]
    pairs = np.flatnonzero((key[1:] == key[:-1]).all(axis=1) & (turned[order][1:] != turned[order][:-1]))
    return numbers[order[np.column_stack([pairs, pairs + 1])]]
