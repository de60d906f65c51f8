"""Runs of records of directed edges, sorted by bucket, in memory or in a temporary file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int
from inertia.mesh.external.temporary_file import TemporaryFile
from inertia.mesh.geometry.edge_buckets import BYTES, CHUNK, bits_for

_RUN = 3 * (8 + BYTES)  # bytes of memory that a triangle of a run takes


class Runs:
    """Records of directed edges, in runs sorted by bucket: in memory where they fit in `room` bytes, else in a file."""

    def __init__(self, count: int, room: int, slack: int, stack: ExitStack) -> None:
        self.bits = bits_for(count)
        self.in_memory = 3 * BYTES * count + _RUN * min(count, CHUNK) <= room // 2
        self._arrays: list[NDArray[np.uint32]] = []
        self._starts: list[Int] = []
        self._begin: list[int] = []
        if self.in_memory:
            self.length = min(count, max(CHUNK, room // 4 // _RUN))
            return
        self.length = min(count, max(CHUNK, (room - slack) // _RUN))
        self._file = TemporaryFile(3 * BYTES * count, stack)

    @property
    def buckets(self) -> int:
        """How many there are."""
        return int(1 << self.bits)

    def add(self, records: NDArray[np.uint32], starts: Int) -> None:
        """Keep a run (n, 3), whose bucket b is `starts[b]:starts[b + 1]`."""
        self._starts.append(starts)
        if self.in_memory:
            self._arrays.append(records.copy())
            return
        self._begin.append(self._file.reserve(records.nbytes))
        self._file.write(records, self._begin[-1])

    def bucket(self, number: int, buffer: NDArray[np.uint32]) -> Iterator[NDArray[np.uint32]]:
        """Yield what all runs have of a bucket, in pieces no longer than the buffer, which they may lie in."""
        filled = 0
        for run, starts in enumerate(self._starts):
            at, stop = int(starts[number]), int(starts[number + 1])
            if self.in_memory:
                for first in range(at, stop, len(buffer)):
                    yield self._arrays[run][first : min(first + len(buffer), stop)]
                continue
            while at < stop:
                size = min(stop - at, len(buffer) - filled)
                self._file.read(buffer[filled : filled + size], self._begin[run] + BYTES * at)
                at, filled = at + size, filled + size
                if filled == len(buffer):
                    yield buffer
                    filled = 0
        if filled:
            yield buffer[:filled]
