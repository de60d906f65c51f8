"""Sum the moments of triangles in float64, in one fixed order, with what an error bound needs.

For the tetrahedra (o, a, b, c) that the triangles of a closed surface span with a local origin o, with
d = a·((b − a) × (c − a)) and s = a + b + c (all relative to o), thirteen sums are formed:

    Σ d,   Σ d s,   Σ d (a² + b (a + b) + c s)  for xx, yy, zz,
    Σ d (s s' + a a' + b b' + c c')  for yz, zx, xy,   Σ p,   Σ |n|,   Σ |d|

where n = (b − a) × (c − a) and p is d with every product and coordinate replaced by its magnitude, a bound on what
rounding can do to d. (The first bracket is half of what the second becomes on the diagonal.) For a shell, |n| takes
the place of d and the magnitudes of n's products that of p. Beside them stand the smallest and largest coordinates.

The edges are differences of *stored* coordinates and the corners are taken relative to a local origin inside the
part: each is rounded at most once, so nothing is lost to the distance of the part from the file's origin. A part
whose size is beyond 2^±100 is multiplied by a power of two first, which is exact and keeps the products in range.

Order: 32 lanes × 32 triangles are a block; lane sums run down the block, the lanes and then 16 blocks are added as
binary trees, and these sums are added exactly and rounded once (`math.fsum`). The compiled kernel and the numpy one
follow the same order with the same roundings, so their answers have the same bits. Of many triangles of a solid, the
ten sums have the digits that float64 loses where there is a compiled kernel (`inertia.mass.triangles.fine_sums`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Progress
from inertia.errors import GeometryError
from inertia.mass.triangles import fine_sums
from inertia.mass.triangles.fine_sums import FineSums, Grid, Sample
from inertia.mass.triangles.kernels import BLOCK, DEPTH, LANES, BlockKernel
from inertia.mesh.surface import Facets, Triangles, first_non_finite
from inertia.native import Kernel
from inertia.records import dataclass

SUMS = 13
KERNEL = BlockKernel(
    Kernel("inertia.mass.triangles.moment_kernel", "sum_facets", "pi" + "ddd" + "ipp"),
    Kernel("inertia.mass.triangles.moment_kernel", "sum_faces", "ppi" + "ddd" + "ipp"),
    columns=SUMS + 6,
)
CAME_ALONG = 1e-28
"""As `results_kernel.A_PRIORI`."""

MANY = 1_024
"""Triangles above which the sums of a solid have the digits that float64 loses, where their kernel is shipped."""

_MANY_ELSEWHERE = 400_000  # as `COMPILE_ABOVE`: what was compiled before has no say in the figures

_IN_RANGE = 100  # fifth powers of 2^±100 and their sums stay far from the ends of float64
_LARGEST_EXPONENT = 1000
_SAMPLED = 64
_SCATTERED = np.sort(np.arange(1, 2 * _SAMPLED + 1) * (math.sqrt(5.0) - 1.0) / 2.0 % 1.0)
"""Where triangles are picked that no regular order of equal bodies hides the size of the whole from."""
_NUMPY_CHUNK = 16 * BLOCK


@dataclass(frozen=True, eq=False)
class Sums:
    """Σ |n| of triangles in the scaled local frame, where a coordinate x enters as (x − origin)·2^exponent.

    `origin` and the extents `low` and `high` are (3,), as stored; `count` is the number of triangles.
    """

    origin: Float
    exponent: int
    low: Float
    high: Float
    count: int
    area: float


@dataclass(frozen=True, eq=False)
class PlainSums(Sums):
    """The thirteen sums (13,) in float64; the first ten in double-double, high and low, where they came along.

    These are off by at most `CAME_ALONG` of the magnitudes that enter.
    """

    sums: Float
    finer: tuple[list[float], list[float]] | None = None


@dataclass(frozen=True, eq=False)
class SumsOnGrid(Sums):
    """The first ten sums with the digits that float64 loses."""

    fine: FineSums


@dataclass(frozen=True)
class Frame:
    """The local origin (3,), a power of two for the size, whether the surface carries the mass, and the fine grid."""

    origin: Float
    exponent: int
    surface: bool
    grid: Grid | None

    @classmethod
    def on(cls, grid: Grid) -> Frame:
        """Return the frame of a fine grid, about its origin."""
        return cls(np.array(grid.origin), 0, False, grid)


def sum_triangles(triangles: Triangles, *, surface: bool = False, progress: Progress | None = None) -> Sums:
    """Sum over all triangles: as the boundary of a solid, or (`surface`) as a shell.

    Raises `GeometryError` where a coordinate is infinite or not a number.
    """
    return sum_in(frame_of(triangles, surface=surface), triangles, progress)


class SummedFacets(Facets):
    """Triangles that are summed as solids, or as a shell, while somebody else reads them block by block.

    So a file is read once, and by as many threads as read it. Blocks may come in any order, and again.
    """

    def __init__(self, facets: Facets, *, surface: bool) -> None:
        self._facets, self._frame = facets, frame_of(facets, surface=surface)
        self._kernel = _kernel_for(facets, self._frame)
        if self._kernel is not None:
            kernel, _ = self._kernel
            kernel.facets.function  # noqa: B018  # loaded before threads ask for it
            self._rows, self._done = kernel.table(facets.count), np.zeros(-(-facets.count // BLOCK), bool)

    @property
    def count(self) -> int:
        """Number of triangles."""
        return self._facets.count

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return the records of triangles `start:stop`."""
        records = self._facets.block(start, stop)
        own = slice(start // BLOCK, -(-stop // BLOCK))
        whole = start % BLOCK == 0 and (stop % BLOCK == 0 or stop == self.count)
        if self._kernel is not None and whole and not self._done[own].any():
            kernel, numbers = self._kernel
            kernel.sum(self._facets, start, records, numbers, self._rows)
            self._done[own] = True
        return records

    def select(self, index: NDArray[Any]) -> Facets:
        """Return the triangles picked by an index or mask array, as a copy in memory."""
        return self._facets.select(index)

    def sums(self, progress: Progress | None = None) -> Sums:
        """Return the sums, for which what nobody has read is read here."""
        if self._kernel is None:
            return sum_in(self._frame, self._facets, progress)
        for place in np.flatnonzero(~self._done).tolist():
            self.block(place * BLOCK, min((place + 1) * BLOCK, self.count))
        return sums_of(self._facets, self._frame, [self._rows])


def sum_in(frame: Frame, triangles: Triangles, progress: Progress | None = None) -> Sums:
    """Sum over all triangles, in a frame."""
    blocks = []
    with np.errstate(invalid="ignore", over="ignore"):
        for stop, rows in block_rows(triangles, frame):
            blocks.append(rows)
            if progress is not None:
                progress(stop / triangles.count)
    return sums_of(triangles, frame, blocks)


def block_rows(triangles: Triangles, frame: Frame) -> Iterator[tuple[int, Float]]:
    """Yield the number of triangles done so far and the rows of the blocks that it took, compiled where that pays."""
    if (compiled := _kernel_for(triangles, frame)) is not None:
        kernel, numbers = compiled
        return kernel.rows(triangles, numbers)
    return vectorised_rows(triangles, frame.origin, frame.exponent, frame.surface)


def _kernel_for(triangles: Triangles, frame: Frame) -> tuple[BlockKernel, tuple[float, ...]] | None:
    """Return the compiled kernel that pays, with the numbers of the frame that it takes."""
    if frame.grid is not None and fine_sums.KERNEL.worthwhile(triangles):
        return fine_sums.KERNEL, frame.grid.numbers()
    if frame.exponent == 0 and KERNEL.worthwhile(triangles):
        return KERNEL, (*frame.origin.tolist(), int(frame.surface))
    return None


def sums_of(triangles: Triangles, frame: Frame, blocks: Sequence[Float]) -> Sums:
    """Add the rows of all blocks, in their order."""
    columns = {rows.shape[1] for rows in blocks}
    if len(columns) > 1:  # some were summed where there is no compiled kernel
        return sum_in(replace(frame, grid=None), triangles)
    table = np.empty((*columns, sum(map(len, blocks))))
    np.concatenate([rows.T for rows in blocks], axis=1, out=table)
    added = SUMS if frame.grid is None or columns == {SUMS + 6} else fine_sums.ADDED
    extents = table[added : added + 3].min(axis=1), table[added + 3 : added + 6].max(axis=1)
    if frame.grid is None or added == SUMS:
        if not np.isfinite(table).all():
            _refuse_non_finite(triangles)
        sums = np.array(_add_blocks(table[:added]))
        return PlainSums(frame.origin, frame.exponent, *extents, triangles.count, float(sums[11]), sums)
    if not np.isfinite(table).all():  # nor is a coordinate, or products are beyond float64
        return sum_in(replace(frame, grid=None), triangles)
    *fine, area = _add_blocks(table[:added])
    more = FineSums.of(frame.grid, fine, table[added + 6 :].max(axis=1).tolist())
    return SumsOnGrid(frame.origin, frame.exponent, *extents, triangles.count, area, more)


def in_float64(sums: Sums, triangles: Triangles, progress: Progress | None = None) -> PlainSums:
    """Return the thirteen sums in float64, of the same triangles in the same frame."""
    if not isinstance(sums, PlainSums):
        sums = sum_in(Frame(sums.origin, sums.exponent, False, None), triangles, progress)
    assert isinstance(sums, PlainSums)
    return sums


def frame_of(triangles: Triangles, *, surface: bool = False) -> Frame:
    """Choose the frame, from a sample of the triangles."""
    least = MANY if fine_sums.KERNEL.is_shipped(triangles) else _MANY_ELSEWHERE
    if not surface and triangles.count > least and fine_sums.KERNEL.worthwhile(triangles):
        places = (_SCATTERED * triangles.count).astype(np.int64)
        sample = Sample.of(triangles.select(places).corners(), triangles.count)
        if sample.plain is not None:
            return Frame.on(sample.plain)
        if sample.is_finite:
            origin, exponent = local_frame(sample.low, sample.high)
            grid = None if exponent else sample.grid(origin)
            return Frame(np.array(origin), exponent, False, None) if grid is None else Frame.on(grid)
    points = np.ascontiguousarray(triangles.sample(_SAMPLED).reshape(-1, 3).T)  # along whose rows numpy is quick
    low, high = points.min(axis=1), points.max(axis=1)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        _refuse_non_finite(triangles)
    origin, exponent = local_frame(low.tolist(), high.tolist())
    return Frame(np.array(origin), exponent, surface, None)


def local_frame(low: Sequence[float], high: Sequence[float]) -> tuple[list[float], int]:
    """Choose the local origin from extents (3,), and a power of two where the size asks for one."""
    box = list(zip(low, high, strict=True))
    fits = all(math.isfinite(b - a) for a, b in box)
    origin = [a + 0.5 * (b - a) if fits else 0.5 * a + 0.5 * b for a, b in box]
    exponent = math.frexp(max(max(b - o, o - a) for o, (a, b) in zip(origin, box, strict=True)))[1]
    if abs(exponent) > _IN_RANGE:
        return origin, -max(-_LARGEST_EXPONENT, min(_LARGEST_EXPONENT, exponent))
    return origin, 0


def _add_blocks(table: Float) -> list[float]:
    """Add the blocks: 16 at a time as a binary tree, then exactly, rounded once."""
    if table.shape[1] == 1:
        only: list[float] = (table[:, 0] + 0.0).tolist()  # no sum is −0
        return only
    rows = np.zeros((len(table), -(-table.shape[1] // 16) * 16))
    rows[:, : table.shape[1]] = table
    for _ in range(4):
        rows = rows[:, 0::2] + rows[:, 1::2]
    return [math.fsum(row) for row in rows.tolist()]


def _refuse_non_finite(triangles: Triangles) -> None:
    where = first_non_finite(triangles)
    if where is None:
        raise GeometryError("the mesh is larger than float64 can hold: give its coordinates in a larger unit")
    face, corner = where
    value = triangles.corners(face, face + 1)[0, corner]
    raise GeometryError(
        f"triangle {face}, corner {corner} has the coordinates {tuple(value.tolist())}, "
        "which are not all finite: export the mesh again",
        code="non_finite",
    )


def vectorised_rows(triangles: Triangles, origin: Float, exponent: int, surface: bool) -> Iterator[tuple[int, Float]]:
    """Yield what the kernel's `rows` does, computed by numpy."""
    for start in range(0, triangles.count, _NUMPY_CHUNK):
        stop = min(start + _NUMPY_CHUNK, triangles.count)
        corners = triangles.corners(start, stop)
        rows = _blocks(np.ldexp(corners, exponent), np.ldexp(origin, exponent), surface)
        rows[:, SUMS:] = np.ldexp(rows[:, SUMS:], -exponent)
        yield stop, rows


def _blocks(corners: Float, origin: Float, surface: bool) -> Float:
    count = len(corners)
    rows = -(-count // LANES)
    padded = np.empty((-(-count // BLOCK) * BLOCK, 3, 3))
    padded[:count] = corners
    # A lane without a triangle gets a point: the first corner of its row, or of the last row.
    for row in range(rows - 1, len(padded) // LANES):
        first = max(count, row * LANES)
        padded[first : (row + 1) * LANES] = corners[min(row, rows - 1) * LANES, 0]
    x, y, z = np.ascontiguousarray(padded.transpose(2, 1, 0))
    ux, uy, uz = (k[1] - k[0] for k in (x, y, z))
    vx, vy, vz = (k[2] - k[0] for k in (x, y, z))
    (ax, bx, cx), (ay, by, cy), (az, bz, cz) = (k - o for k, o in zip((x, y, z), origin.tolist(), strict=True))
    px, qx = uy * vz, uz * vy
    py, qy = uz * vx, ux * vz
    pz, qz = ux * vy, uy * vx
    nx, ny, nz = px - qx, py - qy, pz - qz
    mx, my, mz = abs(px) + abs(qx), abs(py) + abs(qy), abs(pz) + abs(qz)
    area = np.sqrt((nx * nx + ny * ny) + nz * nz)
    if surface:
        weight, size = area, (mx + my) + mz
    else:
        weight = (ax * nx + ay * ny) + az * nz
        size = (abs(ax) * mx + abs(ay) * my) + abs(az) * mz
    tx, ty, tz = ax + bx, ay + by, az + bz
    sx, sy, sz = tx + cx, ty + cy, tz + cz
    terms = (
        weight,
        weight * sx,
        weight * sy,
        weight * sz,
        weight * ((ax * ax + bx * tx) + cx * sx),
        weight * ((ay * ay + by * ty) + cy * sy),
        weight * ((az * az + bz * tz) + cz * sz),
        weight * (((sy * sz + ay * az) + by * bz) + cy * cz),
        weight * (((sz * sx + az * ax) + bz * bx) + cz * cx),
        weight * (((sx * sy + ax * ay) + bx * by) + cx * cy),
        size,
        area,
        abs(weight),
    )
    out = np.empty((len(padded) // BLOCK, SUMS + 6))
    for row, term in enumerate(terms):
        lanes = term.reshape(-1, DEPTH, LANES)
        total = lanes[:, 0].copy()
        for step in range(1, DEPTH):
            total += lanes[:, step]
        while total.shape[1] > 1:
            half = total.shape[1] // 2
            total = total[:, :half] + total[:, half:]
        out[:, row] = total[:, 0]
    for axis, coordinate in enumerate((x, y, z)):
        out[:, SUMS + axis] = coordinate.min(axis=0).reshape(-1, BLOCK).min(axis=1)
        out[:, SUMS + 3 + axis] = coordinate.max(axis=0).reshape(-1, BLOCK).max(axis=1)
    return out
