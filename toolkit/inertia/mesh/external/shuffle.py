"""Edges of a binary STL or PLY file paired by the workers of a Dask scheduler: ranges of triangles, shares of buckets.

Each range becomes records sorted by bucket, of which every share of the buckets takes its own (a shuffle); what is
paired comes back here. All workers read the file, by the same path, and it has to be the same.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int, Progress
from inertia.errors import ReadError, UsageError, visible
from inertia.mesh.external.closure import Paired
from inertia.mesh.geometry.edge_buckets import BYTES, MOST, Sorter, bits_for, irregular_halves, steps_for
from inertia.mesh.part import Part
from inertia.mesh.readers.ply import read_ply
from inertia.mesh.readers.stl import HEADER, is_binary_stl
from inertia.mesh.surface import FacesInFile, Facets, FacetsInFile, Surface, Triangles
from inertia.records import dataclass
from inertia.scheduler import fault, finished, sent
from inertia.standard_input import NAME

T = TypeVar("T")

RANGE = 1 << 20
"""Triangles that a worker reads at a time, at least: a multiple of the blocks in which they are summed."""

SHARE = 1 << 26
"""Bytes of records that a worker pairs at a time, about."""

_RANGES = 128  # at most, so that there are not too many pieces to move


@dataclass(frozen=True)
class StoredTriangles:
    """A binary STL or PLY file: its path, format, number of triangles, size and time of the last change (ns)."""

    path: str
    format: str
    count: int
    size: int
    modified: int

    @classmethod
    def of(cls, part: Part) -> StoredTriangles:
        """Describe the file of a part; raises `UsageError` where it is none that other processes can read in ranges."""
        path, kind = part.source.path, part.source.format
        if path not in (None, NAME) and isinstance(part.geometry, Facets | FacesInFile):
            try:
                status = Path(path).stat()
                with Path(path).open("rb") as file:
                    head = file.read(HEADER)
                if kind == "ply" or is_binary_stl(head, status.st_size):
                    where, count = str(Path(path).resolve()), part.triangles.count
                    return cls(where, kind, count, status.st_size, status.st_mtime_ns)
            except OSError as error:
                raise ReadError(f"cannot read {visible(path)}: {error.strerror}: check the disk") from None
        raise UsageError(
            f"{part.name} is no binary STL or PLY file as it is, which workers read in ranges: write it as one"
        )

    def read(self, start: int, stop: int) -> Triangles:
        """Return triangles `start:stop`; raises `ReadError` where the file is another one here."""
        try:
            status = Path(self.path).stat()
            if (status.st_size, status.st_mtime_ns) == (self.size, self.modified):
                triangles = _opened(self, status.st_dev, status.st_ino, status.st_ctime_ns)
                block = triangles.block(start, stop)
                return Facets(block) if isinstance(triangles, Facets) else Surface(triangles.vertices, block)
            what = "it is not the file that the command has read"
        except OSError as error:
            what = error.strerror or str(error)
        raise ReadError(f"a Dask worker cannot read {visible(self.path)}: {what}: give it the same file by that path")


@lru_cache(maxsize=1)  # the vertices of a PLY file are read once by each worker
def _opened(file: StoredTriangles, *_: int) -> Triangles:
    """Open a file, which also is another one where its device, inode and time of change here are."""
    if file.format != "ply":
        return FacetsInFile(Path(file.path), file.count, HEADER)
    geometry = read_ply(Path(file.path), memory=0.0).geometry
    assert isinstance(geometry, Surface)
    return geometry


class DaskWorkers:
    """The workers of a Dask scheduler, and the file that they read.

    Parameters
    ----------
    client : of the scheduler (`distributed.Client`)
    """

    def __init__(self, client: Any, file: StoredTriangles) -> None:
        self._client, self._file = client, file

    def over_ranges(self, function: Callable[..., T], *arguments: object, progress: Progress | None = None) -> list[T]:
        """Return ``function(triangles, *arguments)`` for each range of triangles, in their order."""
        futures = [self._client.submit(sent(_of_range, function, *at, *arguments), pure=False) for at in self._ranges()]
        results: dict[int, T] = {}
        for number, result in self._results(futures):
            results[number] = result
            if progress is not None:
                progress(len(results) / len(futures))
        return [results[number] for number in range(len(futures))]

    def pair(self, salt: NDArray[np.uint64], room: int, progress: Progress) -> Iterator[Paired]:
        """Yield paired edges, share by share, each with no more than `room` irregular directed edges."""
        bits = bits_for(self._file.count)
        shares = 1 << min(bits, max(3 * BYTES * self._file.count // SHARE, 1).bit_length())
        submit = self._client.submit
        runs = [submit(sent(_run, *at, salt, bits, shares), pure=False) for at in self._ranges()]
        pair = sent(_pair, salt, room)
        futures = [
            submit(pair, *(submit(operator.getitem, run, share, pure=False) for run in runs), pure=False)
            for share in range(shares)
        ]
        points = [submit(operator.getitem, run, shares, pure=False) for run in runs]
        del runs
        for done, (_, paired) in enumerate(self._results(futures)):
            yield paired
            progress((done + 1) / shares)
        for _, repeated in self._results(points):
            nothing = np.empty((0, 2), np.uint32)
            yield Paired(nothing, nothing[:, 0], 0, 3 * MOST, np.zeros(4, np.int64), repeated)

    def _ranges(self) -> list[tuple[StoredTriangles, int, int]]:
        count = self._file.count
        length = RANGE * max(1, -(-count // (RANGE * _RANGES)))
        return [(self._file, start, min(start + length, count)) for start in range(0, count, length)]

    def _results(self, futures: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield results as they come, each with the number of its future, which is let go of."""
        import distributed

        number = {future.key: k for k, future in enumerate(futures)}
        done = distributed.as_completed(futures, loop=self._client.loop, with_results=True, raise_errors=False)
        while number:
            for future, result in finished(done, self._client):
                if future.status == "error":  # whatever becomes of the scheduler, other results are at hand
                    raise fault(future.exception())
                yield number.pop(future.key), result
                future.release()


def _of_range(function: Callable[..., T], file: StoredTriangles, start: int, stop: int, *arguments: object) -> T:
    return function(file.read(start, stop), *arguments)


_Piece = tuple[NDArray[np.uint32], Int]
"""Records of a run in one share of the buckets, and where each bucket begins."""


def _run(
    file: StoredTriangles, start: int, stop: int, salt: NDArray[np.uint64], bits: int, shares: int
) -> list[_Piece | Int]:
    """Return the pieces of a range for each share, and then which triangles have a repeated corner."""
    triangles = file.read(start, stop)
    sorter = Sorter(steps_for(file.count, salt), stop - start, bits)
    records, starts, repeated = sorter.run(triangles, 0, stop - start, start)
    each = (len(starts) - 1) // shares
    own = (starts[share * each : (share + 1) * each + 1] for share in range(shares))
    return [*((records[at[0] : at[-1]].copy(), at - at[0]) for at in own), repeated]


def _pair(salt: NDArray[np.uint64], room: int, *pieces: _Piece) -> Paired:
    """Pair the edges of a share of the buckets."""
    steps = steps_for(sum(len(records) for records, _ in pieces), salt)
    pairs = [np.empty((0, 2), np.uint32)]

    def own(bucket: int) -> Iterable[NDArray[np.uint32]]:
        return (records[starts[bucket] : starts[bucket + 1]] for records, starts in pieces)

    def join(regular: NDArray[np.uint32]) -> None:
        pairs.append(regular.astype(np.uint32))

    halves, odd, first = irregular_halves(len(pieces[0][1]) - 1, own, steps, join, room)
    left_out = odd - len(halves)
    return Paired(np.concatenate(pairs), halves.copy(), left_out, first, steps.state, np.empty(0, np.int64))
