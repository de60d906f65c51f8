"""Run a compiled kernel over the triangles of a mesh, block by block."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float
from inertia.mesh.surface import Facets, Triangles
from inertia.native import Kernel, place
from inertia.records import dataclass

LANES, DEPTH = 32, 32
BLOCK = LANES * DEPTH
"""Triangles whose sums become one row."""

_FACETS_CHUNK, _FACES_CHUNK = 32 * BLOCK, 256 * BLOCK  # records may be read from the file


@dataclass(frozen=True)
class BlockKernel:
    """The two forms of a kernel, for binary STL records and for faces over vertices, and the columns of its rows.

    `cost` is what its work on a triangle counts for where the question is whether compiling or loading it pays, `least`
    what any number of them counts for, `room` how many rows of lanes it needs beside the corners and the columns.
    """

    facets: Kernel
    faces: Kernel
    columns: int
    cost: int = 1
    least: int = 0
    room: int = 0

    def worthwhile(self, triangles: Triangles) -> bool:
        """Say whether the work repays compiling or loading the form that these triangles need."""
        kernel = self.facets if isinstance(triangles, Facets) else self.faces
        return kernel.worthwhile(max(self.least, self.cost * triangles.count))

    def is_shipped(self, triangles: Triangles) -> bool:
        """Say whether the form that these triangles need is shipped as machine code for this processor."""
        return (self.facets if isinstance(triangles, Facets) else self.faces).is_shipped

    def rows(self, triangles: Triangles, frame: tuple[float, ...]) -> Iterator[tuple[int, Float]]:
        """Yield the number of triangles done so far and the rows of the blocks that it took, (blocks, columns)."""
        table = self.table(triangles.count)
        chunk = _FACETS_CHUNK if isinstance(triangles, Facets) else _FACES_CHUNK
        for start in range(0, triangles.count, chunk):
            stop = min(start + chunk, triangles.count)
            yield stop, self.sum(triangles, start, triangles.block(start, stop), frame, table)

    def table(self, count: int) -> Float:
        """Return room for the rows of so many triangles."""
        return np.empty((-(-count // BLOCK), self.columns))

    def sum(
        self, triangles: Triangles, start: int, records: NDArray[Any], frame: tuple[float, ...], table: Float
    ) -> Float:
        """Return the rows of the blocks of those from `start` on, which are `records`, as they stand in the table."""
        room = np.empty((9 + self.columns + self.room) * LANES + 8)
        scratch = room[-place(room) % 64 // 8 :]  # on a cache line, for the widest vectors
        rows = table[start // BLOCK : -(-(start + len(records)) // BLOCK)]
        own = *frame, place(scratch), place(rows)
        if isinstance(triangles, Facets):
            self.facets.function(records.ctypes.data, len(records), *own)
        else:
            self.faces.function(place(triangles.vertices), place(records), len(records), *own)
        return rows
