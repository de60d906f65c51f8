"""Triangles wherever they lie: as records of a binary STL file or over shared vertices, in memory or still in the file.

All offer the same few things (`count`, `corners`, `sample`, `select`), so that what integrates or checks triangles
needs not know where they lie.
"""

from __future__ import annotations

import os
import threading
import weakref
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Bool, Float, Int, is_masked
from inertia.errors import GeometryError, ReadError, UsageError, placed
from inertia.mesh.version import CHANGED, Version
from inertia.native import Kernel

FACET = np.dtype(
    [
        ("normal", "<f4", 3),
        *((name, "<f4") for name in ("x0", "y0", "z0", "x1", "y1", "z1", "x2", "y2", "z2")),
        ("attribute", "<u2"),
    ]
)
"""One record of a binary STL file: a normal (ignored), nine coordinates, an attribute; 50 bytes, packed."""

_CORNERS_OFFSET = 12
_WIDEN = Kernel("inertia.mesh.facet_kernel", "widen_facets", "pip")

_SCANNED = 65_536  # triangles looked at together
_GAP = 512  # triangles that are read along with their neighbours rather than passed over


class Facets:
    """Triangles as binary STL records in memory.

    Parameters
    ----------
    records : (n,) array of `FACET`
    """

    counts_once = False
    """As of `Surface`."""

    def __init__(self, records: NDArray[Any]) -> None:
        self._records = records

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self._records)

    @property
    def records(self) -> NDArray[Any]:
        """All records, (n,)."""
        return self.block(0, self.count)

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return the records of triangles `start:stop`."""
        return self._records[start:stop]

    def corners_f4(self, start: int = 0, stop: int | None = None) -> NDArray[np.float32]:
        """Return the stored corners of triangles `start:stop`, (k, 3, 3) float32, as a view of a block."""
        block = self.block(start, self.count if stop is None else min(stop, self.count))
        if len(block) == 0:
            return np.empty((0, 3, 3), "<f4")
        return np.ndarray(
            (len(block), 3, 3), "<f4", buffer=block, offset=_CORNERS_OFFSET, strides=(FACET.itemsize, 12, 4)
        )

    def corners(self, start: int = 0, stop: int | None = None) -> Float:
        """Return the corners of triangles `start:stop`, (k, 3, 3), widened exactly to float64."""
        stored = self.corners_f4(start, stop)
        if _WIDEN.worthwhile(len(stored)):
            corners = np.empty(stored.shape)
            _WIDEN.function(stored.ctypes.data, len(stored), corners.ctypes.data)
            return corners
        with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
            return stored.astype(np.float64)

    def sample(self, count: int) -> Float:
        """Return the corners of at least `count` triangles (or all), evenly spread, (k, 3, 3)."""
        return self.select(np.arange(0, self.count, max(1, self.count // count))).corners()

    def select(self, index: NDArray[Any]) -> Facets:
        """Return the triangles picked by an index or mask array, as a copy in memory."""
        places = np.flatnonzero(index) if index.dtype == bool else index
        return Facets(self._records.take(places))  # indexing takes several times as long for records


class RowsInFile:
    """Rows of one length in a file, read block by block.

    They are not mapped: to touch a page of a file that was cut short meanwhile ends the process. Each block is known
    to be that of the version of the file that was opened; `ReadError` says so where it has changed.

    Parameters
    ----------
    path : the file
    row : the type of a row
    count : of rows
    offset : byte at which they begin
    """

    def __init__(self, path: Path, row: np.dtype[Any], count: int, offset: int) -> None:
        self.name, self._version, self._row, self._offset = str(path), Version(path), row, offset
        self.count = count
        self._file = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        self._seeking = threading.Lock()
        weakref.finalize(self, os.close, self._file)

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return rows `start:stop`; raises `ReadError` where the file has changed."""
        (data,) = self._bytes([(start, stop)])
        return np.frombuffer(data, self._row)

    def _bytes(self, spans: Iterable[tuple[int, int]]) -> Iterator[bytes]:
        """Yield rows `start:stop` of each span; only where all are taken, the file is known to be the same for all."""
        width = self._row.itemsize
        try:
            for start, stop in spans:
                data = self._read(width * (stop - start), self._offset + width * start)
                if len(data) < width * (stop - start):
                    raise ReadError(CHANGED, code="changed")
                yield data
            self._version.require(os.fstat(self._file), links=False)
        except OSError as error:
            raise ReadError(f"cannot read {self.name}: {error.strerror}: check the disk") from error
        except ReadError as error:
            raise placed(error, f"cannot read {self.name}") from None

    def select(self, index: NDArray[Any]) -> NDArray[Any]:
        """Return the rows picked by an index or mask array."""
        places = np.flatnonzero(index) if index.dtype == bool else index
        if len(places) > 1 and (places[1:] < places[:-1]).any():
            order = np.argsort(places, kind="stable")
            back = np.empty_like(order)
            back[order] = np.arange(len(order))
            return self.select(places[order]).take(back)
        ends = np.flatnonzero(np.diff(places, append=self.count + _GAP) >= _GAP) + 1
        if 0 < len(ends) == len(places):  # far from each other
            return np.frombuffer(bytearray(b"".join(self._bytes((k, k + 1) for k in places.tolist()))), self._row)
        rows = np.empty(len(places), self._row)
        parts = [
            slice(some, min(some + _SCANNED, last))
            for first, last in pairwise([0, *ends.tolist()])
            for some in range(first, last, _SCANNED)
        ]
        spans = [(int(places[part.start]), int(places[part.stop - 1]) + 1) for part in parts]
        for part, (start, _), data in zip(parts, spans, self._bytes(spans), strict=True):
            rows[part] = np.frombuffer(data, self._row).take(places[part] - start)
        return rows

    def _read(self, size: int, at: int) -> bytes:
        data = self._some(size, at)
        if not 0 < len(data) < size:
            return data
        pieces = [data]  # a system reads 2 GB at a time at most, and some file systems less
        while data:
            size, at = size - len(data), at + len(data)
            data = self._some(size, at)
            pieces.append(data)
        return b"".join(pieces)

    def _some(self, size: int, at: int) -> bytes:
        if hasattr(os, "pread"):
            return os.pread(self._file, size, at)
        with self._seeking:
            os.lseek(self._file, at, os.SEEK_SET)
            return os.read(self._file, size)


class FacetsInFile(Facets):
    """Triangles as binary STL records in a file, read block by block where they are used; raises as `RowsInFile`.

    Parameters
    ----------
    path : the file
    count : of triangles
    offset : byte at which the records begin
    """

    def __init__(self, path: Path, count: int, offset: int) -> None:
        self._rows = RowsInFile(path, FACET, count, offset)

    @property
    def count(self) -> int:
        """Number of triangles."""
        return self._rows.count

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return the records of triangles `start:stop`; raises `ReadError` where the file has changed."""
        return self._rows.block(start, stop)

    def select(self, index: NDArray[Any]) -> Facets:
        """Return the triangles picked by an index or mask array, as a copy in memory."""
        return Facets(self._rows.select(index))


class Surface:
    """Triangles over shared vertices.

    Parameters
    ----------
    vertices : (n, 3) float64
    faces : (m, 3) int64, indices into `vertices`; counter-clockwise seen from outside

    Attributes
    ----------
    counts_once : whether it is known to go around each place once or not at all, but for the rounding of its vertices
    """

    counts_once = False

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        self.vertices: Float = np.asarray(_numbers("vertices", vertices, "fiu"), dtype=np.float64, order="C")
        self.faces: Int = indices(faces)
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3:
            raise UsageError(f"vertices must have shape (n, 3), not {self.vertices.shape}")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3:
            raise UsageError(f"faces must have shape (m, 3), not {self.faces.shape}")
        if self.faces.size:
            out_of_range = (self.faces < 0) | (self.faces >= len(self.vertices))
            if out_of_range.any():
                face, corner = (int(i) for i in np.argwhere(out_of_range)[0])
                there = f"the vertices are 0 to {len(self.vertices) - 1}" if len(self.vertices) else "there are none"
                raise GeometryError(
                    f"face {face} names vertex {self.faces[face, corner]}, but {there}: export the mesh again"
                )

    @classmethod
    def _of(cls, vertices: Float, faces: Int) -> Surface:
        """Return the surface over faces that are known to name vertices."""
        surface = cls.__new__(cls)
        surface.vertices, surface.faces = vertices, faces
        return surface

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self.faces)

    def block(self, start: int, stop: int) -> Int:
        """Return the faces of triangles `start:stop`, (k, 3)."""
        return self.faces[start:stop]

    def corners(self, start: int = 0, stop: int | None = None) -> Float:
        """Return the corners of triangles `start:stop`, (k, 3, 3)."""
        return self.vertices[self.faces[start:stop]]

    def sample(self, count: int) -> Float:
        """Return the corners of at least `count` triangles (or all), evenly spread, (k, 3, 3)."""
        return self.vertices[self.faces[:: max(1, self.count // count)]]

    def select(self, index: NDArray[Any]) -> Surface:
        """Return the triangles picked by an index or mask array; the vertices are shared."""
        places = np.flatnonzero(index) if index.dtype == bool else index
        return Surface._of(self.vertices, self.faces.take(places, axis=0))


def indices(faces: ArrayLike) -> Int:
    """Return faces as int64, contiguous; raise `UsageError` for what are no whole numbers."""
    array = _numbers("faces", faces, "iuf")
    if array.dtype.kind == "f" and array.size:
        whole = (np.floor(array) == array) & (np.abs(array) < 2**53)
        if not whole.all():
            raise UsageError(f"faces hold {array[~whole][0]:g}, which is no number of a vertex: give whole numbers")
    if array.dtype == np.uint64:
        array = np.minimum(array, np.uint64(2**63 - 1))
    return np.asarray(array, dtype=np.int64, order="C")


def _numbers(what: str, values: ArrayLike, kinds: str) -> NDArray[Any]:
    """Return an array of numbers of some kinds; raise `UsageError` for anything else."""
    try:
        array = np.asarray(values)
    except ValueError:  # rows of several lengths
        array = np.asarray(None)
    if array.dtype.kind not in kinds:
        raise UsageError(f"{what} must be an array of {'real' if kinds[0] == 'f' else 'whole'} numbers, (n, 3)")
    if is_masked(values) and np.ma.getmaskarray(values).any():
        row = int(np.argwhere(np.ma.getmaskarray(values))[0, 0])
        raise UsageError(f"{what}: row {row} has masked numbers: leave out what is masked, or fill it")
    return array


class FacesInFile(Surface):
    """Triangles over shared vertices, of which the vertices are in memory and the faces in a file.

    Parameters
    ----------
    vertices : (n, 3) float64
    rows : with the fields `count`, which is 3, and `corners`, (3,), indices into `vertices`
    """

    def __init__(self, vertices: Float, rows: RowsInFile) -> None:
        self.vertices, self._rows = vertices, rows

    @property
    def faces(self) -> Int:  # type: ignore[override]  # read anew each time
        """All faces, (m, 3)."""
        return self.block(0, self.count)

    @property
    def count(self) -> int:
        """Number of triangles."""
        return self._rows.count

    def block(self, start: int, stop: int) -> Int:
        """Return the faces of triangles `start:stop`, (k, 3)."""
        return self._faces(self._rows.block(start, min(stop, self.count)), start)

    def corners(self, start: int = 0, stop: int | None = None) -> Float:
        """Return the corners of triangles `start:stop`, (k, 3, 3)."""
        return self.vertices[self.block(start, self.count if stop is None else stop)]

    def sample(self, count: int) -> Float:
        """Return the corners of at least `count` triangles (or all), evenly spread, (k, 3, 3)."""
        return self.select(np.arange(0, self.count, max(1, self.count // count))).corners()

    def select(self, index: NDArray[Any]) -> Surface:
        """Return the triangles picked by an index or mask array; the vertices are shared."""
        return Surface._of(self.vertices, self._faces(self._rows.select(index), None))

    def _faces(self, rows: NDArray[Any], first: int | None) -> Int:
        """Return the faces of rows, which begin with face `first` where they follow on one another."""
        wrong = rows["count"] != 3
        if wrong.any():
            where = "" if first is None else f" {first + int(wrong.argmax())}"
            says = f"face{where} has {rows['count'][wrong][0]} corners, not 3: write triangles only"
            raise ReadError(f"cannot read {self._rows.name}: {says}")
        faces = rows["corners"].astype(np.int64)
        beyond = (faces < 0) | (faces >= len(self.vertices))
        if beyond.any():
            row, corner = np.argwhere(beyond)[0].tolist()
            where = "" if first is None else f" {first + row}"
            says = f"face{where} names vertex {rows['corners'][row, corner]}, but the vertices are 0 to "
            says += f"{len(self.vertices) - 1} (counted from 0): export the mesh again"
            raise ReadError(f"cannot read {self._rows.name}: {says}", code="node_out_of_range")
        return faces


Triangles = Facets | Surface


LARGEST = 1e75
"""The largest coordinate that is computed with: the inertia of anything larger leaves float64, whatever the unit."""


def usable(coordinates: Float) -> Bool:
    """Say which coordinates are numbers that a volume can be computed from."""
    with np.errstate(invalid="ignore"):  # a signalling NaN
        return np.abs(coordinates) <= LARGEST


def counts_once(triangles: Triangles) -> bool:
    """Say whether triangles are known to go around each place once or not at all, but for rounding."""
    return triangles.counts_once


def first_non_finite(triangles: Triangles) -> tuple[int, int] | None:
    """Return (triangle, corner 0 to 2) of the first NaN or infinite coordinate, or None.

    Reading does not scan a binary STL file; whoever integrates one sees a sum that is not finite and asks here.

    >>> first_non_finite(Surface([[0, 0, 0], [1, 0, 0], [0, float("nan"), 0]], [[0, 1, 2]]))
    (0, 2)
    """
    corners = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
    for start in range(0, triangles.count, _SCANNED):
        stop = min(start + _SCANNED, triangles.count)
        finite = np.isfinite(corners(start, stop)).all(axis=2)
        if not finite.all():
            face, corner = np.argwhere(~finite)[0]
            return start + int(face), int(corner)
    return None
