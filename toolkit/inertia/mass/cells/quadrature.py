"""Add up the moments of cells by quadrature, in one fixed order, with bounds on the error.

The map of a cell, x(ξ) = Σ Nᵢ(ξ) xᵢ, is taken relative to the middle p of its nodes, so that only differences
of *stored* coordinates enter, each rounded once: nothing is lost to the distance from the file's origin. They
are multiplied by one power of two for the whole mesh, which is exact and keeps products in range at any
scale. With the weights m_q = w_q J(ξ_q), J being the Jacobian determinant (or the arc length of a wire for
each unit of ξ),

    V = Σ m_q,    f = Σ m_q x_q,    S = Σ m_q x_q x_qᵀ

are shifted from p to an origin o in the middle of the mesh: with c = p − o to f + V c and
S + c fᵀ + f cᵀ + V c cᵀ.

Bounds. Let a J be within B of the true one, and k = 2n + 40 for a kind of n nodes. A term of S passes through
at most 2(n + 2) roundings in both x (the table's entry, the node, their product, n − 1 sums), 4 in weights
and products, 7 over at most 128 points, 5 in the shift, 12 over a chunk of at most 4096 cells and one in the
final sum: fewer than k. So with γ = k u/(1 − k u), u = 2⁻⁵³, W = Σ w_q and r = Λ h + |c| (Λ the largest
Σ|Nᵢ|, h the largest distance from p along each axis) the cell's V is within E = W B + γ Σ|m_q|, its first
moments within E r and its second ones within E r rᵀ. In place of Σ|m_q| stands V, which is less by at most 2
W B, where J vanishes within its error; and the bounds are rounded themselves: both are far within the 1 % by
which they are widened at the end. What underflow can add is far below 2⁻⁹⁰⁰ a cell in the scaled frame, and
is added.

Order: the points of a cell and the cells of a chunk are added as binary trees, the chunks exactly
(`math.fsum`). Chunks have a fixed number of cells, and one sum for each group in it. The nodes of a cell are added
in their order (`combined`). So the bits are the same on any number of threads.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int, Progress
from inertia.errors import GeometryError
from inertia.mass.cells.shape_functions import Table, table
from inertia.mass.double_words import Pair, folded, near_sum
from inertia.mass.moments import PAIRS, Moments
from inertia.mesh.part import CellBlock, Cells
from inertia.records import dataclass

UNIT_ROUNDOFF = 2.0**-53

_CHUNK_POINTS = 32_768
_WIDEN = Fraction(101, 100)
_UNDERFLOW = Fraction(1, 2**900)


@dataclass(frozen=True, eq=False)
class Chunk:
    """Some cells of one kind, in the scaled frame: k cells of n nodes.

    `nodes` (k, n) are the node numbers, `edges` (n, 3, k) the nodes relative to the cells' middles, `half`
    (3, k) their largest magnitudes, `centre` (3, k) the middles relative to the origin. `first` is the number
    of the first cell through all blocks. `places` (n, 3, k), `middles` (3, k) and `origin` (3,) are those that the
    differences are taken of, as stored, and `scale` is what these are multiplied by. `rests` (n, 3, k) is what the file
    writes beside `places`, where that is counted.
    """

    kind: str
    first: int
    nodes: Int
    edges: Float
    half: Float
    centre: Float
    places: Float
    middles: Float
    origin: Float
    scale: float
    rests: Float | None = None

    def differences(self) -> tuple[Pair, Pair]:
        """Return `edges` and `centre` without rounding."""
        pairs = [Pair.sum_of(self.places, -self.middles), Pair.sum_of(self.middles, -self.origin[:, None])]
        if self.rests is not None:
            pairs[0] = pairs[0] + Pair(self.rests, np.zeros_like(self.rests))
        edges, centre = (Pair(pair.high * self.scale, pair.low * self.scale) for pair in pairs)
        return edges, centre


def integrate(
    cells: Cells,
    blocks: list[tuple[int, CellBlock]],
    rows: Callable[[Chunk], Float],
    *,
    groups: NDArray[np.int32] | None,
    count: int,
    power: int,
    progress: Progress | None = None,
    rests: Float | None = None,
) -> tuple[Moments, ...]:
    """Add up what `rows` finds for each chunk, and return the moments of each group.

    Parameters
    ----------
    blocks : what to integrate, each with the number of its first cell
    rows : from a chunk of k cells to (k, 20): moments 1, x, y, z, xx, yy, zz, yz, zx, xy and their bounds; or (k, 30):
        these and the low parts of double-doubles whose high parts the moments are
    groups : (number of cells,) the group of each cell; None: all are in group 0
    count : number of groups
    power : the zeroth moment's power of length
    rests : (number of points, 3) what the file writes beside the points, which `rows` takes from the chunk, if it does
    """
    origin, exponent = _frame(cells, blocks)
    scale = math.ldexp(1.0, exponent)
    sums: list[list[Float]] = [[] for _ in range(count)]
    sizes = [0] * count
    total, done = sum(len(block.nodes) for _, block in blocks), 0
    for first, block in blocks:
        size = _chunk_size(block.kind)
        for start in range(0, len(block.nodes), size):
            nodes = block.nodes[start : start + size]
            number = first + start
            block_rows = rows(_chunk(cells.points, rests, block.kind, number, nodes, origin, scale))
            member = np.zeros(len(nodes), np.int32) if groups is None else groups[number : number + len(nodes)]
            order = np.argsort(member, kind="stable")
            for part in np.split(order, np.flatnonzero(np.diff(member[order])) + 1):
                sums[member[part[0]]].append(_added(block_rows[part]))
                sizes[member[part[0]]] += len(part)
            done += len(nodes)
            if progress is not None:
                progress(done / total)
    return tuple(_moments(parts, size, origin, exponent, power) for parts, size in zip(sums, sizes, strict=True))


def moment_rows(shape: Table, chunk: Chunk, density: Float, error: Float) -> Float:
    """Return the moments of each cell and their bounds, (k, 20).

    Parameters
    ----------
    density : (q, k), or (1, k) where it is constant: what the weights are multiplied with, J or |dx/dξ|
    error : (k,) bound on the error of each `density`
    """
    k = chunk.edges.shape[2]
    x = combined(shape.values, chunk.edges)
    mass = shape.weights[:, None] * density
    zeroth = fold(mass)
    first_terms = mass[:, None] * x
    first = fold(first_terms)
    c = chunk.centre
    out = np.empty((k, 20))
    out[:, 0] = zeroth
    out[:, 1:4] = (first + zeroth * c).T
    for column, (i, j) in enumerate(PAIRS):
        second = fold(first_terms[:, i] * x[:, j])
        out[:, 4 + column] = second + (c[i] * first[j] + c[j] * (first[i] + zeroth * c[i]))
    out[:, 10:] = moment_bounds(shape, chunk, zeroth, error, UNIT_ROUNDOFF)
    return out


def combined(coefficients: Float, edges: Float) -> Float:
    """Return Σ cᵢ xᵢ over the nodes, (r, 3, k), of coefficients (r, n) and nodes (n, 3, k), node by node.

    A matrix product would leave the order, and so the last bits, to the BLAS library, its threads and the processor.
    """
    total: Float = np.einsum("rn,nik->rik", coefficients, edges)
    return total


def determinant_errors(shape: Table, chunk: Chunk, jacobian: Float, unit: float) -> Float:
    """Return a bound on the error of each cell's determinants, (k,), where each operation is off by up to `unit`, u.

    The slopes J = Σ (∂N/∂ξ) x, (3, r, 3, k), pass through n + 2 roundings, so that they are within
    G = (n + 6) u L hᵀ of the true ones, L being the largest Σ|∂N/∂ξ| and h the largest distances from the cell's
    middle (four to spare for what has been rounded in L and h, and for the terms of higher order). With
    A = max |J| + G over the points, the determinant moves by at most Σ G m(A), m(A) being the minors of A with all
    their signs positive, and six products of at most five roundings add at most (5/3) u Σ A m(A).
    """
    slack = (len(chunk.edges) + 6) * unit * shape.steep[:, None, None] * chunk.half
    largest = np.abs(jacobian).max(axis=1) + slack
    error = np.zeros(chunk.edges.shape[2])
    for i in range(3):
        for j in range(3):
            (p, q), (r, s) = (largest[[i - 2, i - 1]][:, column] for column in (j - 2, j - 1))
            error += (slack[i, j] + 2 * unit * largest[i, j]) * (p * s + q * r)
    return error


def speed_errors(shape: Table, chunk: Chunk, speed: Float, unit: float) -> Float:
    """Return a bound on the error of |dx/dξ| of each wire, (k,), where each operation is off by up to `unit`."""
    span = np.sqrt((chunk.half**2).sum(axis=0))
    errors: Float = unit * ((len(chunk.edges) + 6) * shape.steep[0] * span + 4 * speed.max(axis=0))
    return errors


def moment_bounds(shape: Table, chunk: Chunk, zeroth: Float, error: Float, unit: float) -> Float:
    """Return bounds on the moments of each cell, (k, 10), where each operation is off by up to `unit`."""
    bound = shape.weights.sum() * error + (2 * len(chunk.edges) + 40) * unit * zeroth
    reach = shape.reach * chunk.half + np.abs(chunk.centre)
    pairs = [bound * reach[i] * reach[j] for i, j in PAIRS]
    return np.stack([bound, *(bound * reach), *pairs], axis=1)


def fold(values: Float) -> Float:
    """Add up along the first axis, as a binary tree: ⌈log₂ n⌉ roundings."""
    while len(values) > 1:
        half = len(values) // 2
        sums = values[:half] + values[half : 2 * half]
        values = sums if len(values) % 2 == 0 else np.concatenate([sums, values[-1:]])
    total: Float = values[0]
    return total


def _added(rows: Float) -> Float:
    """Add up the rows of cells."""
    if rows.shape[1] == 20:
        return fold(rows)
    total = folded(Pair(rows[:, :10], rows[:, 20:]))
    return np.concatenate([total.high, fold(rows[:, 10:20]), total.low])


def _frame(cells: Cells, blocks: list[tuple[int, CellBlock]]) -> tuple[Float, int]:
    """Choose the origin, amid the nodes in use, and the power of two that makes the mesh's size 1."""
    used = np.zeros(len(cells.points), bool)
    for first, block in blocks:
        if block.nodes.size and not 0 <= block.nodes.min() <= block.nodes.max() < len(used):
            cell, node = np.argwhere((block.nodes < 0) | (block.nodes >= len(used)))[0]
            raise GeometryError(
                f"cell {first + cell} ({block.kind}) names node {block.nodes[cell, node]}, "
                f"but the nodes are 0 to {len(used) - 1}: export the mesh again"
            )
        used[block.nodes] = True
    finite = np.isfinite(cells.points).all(axis=1)
    if (used & ~finite).any():
        node = int(np.argmax(used & ~finite))
        raise GeometryError(
            f"node {node} has the coordinates {tuple(cells.points[node].tolist())}, "
            "which are not all finite: export the mesh again",
            code="non_finite",
        )
    if not used.any():
        return np.zeros(3), 0
    low = cells.points.min(axis=0, where=used[:, None], initial=np.inf)
    high = cells.points.max(axis=0, where=used[:, None], initial=-np.inf)
    with np.errstate(over="ignore"):
        origin = low + 0.5 * (high - low)
        size = float((high - low).max())
    if not math.isfinite(size):
        raise GeometryError("the mesh is larger than float64 can hold: give its coordinates in a larger unit")
    return origin, -max(-1000, min(1000, math.frexp(size)[1]))


def _chunk_size(kind: str) -> int:
    """Return a power of two that keeps the temporary arrays within some 10 MB."""
    points = len(table(kind).weights)
    return min(4096, 1 << ((_CHUNK_POINTS // points).bit_length() - 1))


def _chunk(points: Float, rests: Float | None, kind: str, first: int, nodes: Int, origin: Float, scale: float) -> Chunk:
    places = np.ascontiguousarray(points[nodes].transpose(1, 2, 0))
    low, high = places.min(axis=0), places.max(axis=0)
    middle = low + 0.5 * (high - low)
    edges = (places - middle) * scale
    centre = (middle - origin[:, None]) * scale
    beside = None if rests is None else rests[nodes].transpose(1, 2, 0)
    return Chunk(kind, first, nodes, edges, np.abs(edges).max(axis=0), centre, places, middle, origin, scale, beside)


def _moments(parts: list[Float], size: int, origin: Float, exponent: int, power: int) -> Moments:
    """Add up the chunks' sums and take them out of the scaled frame."""
    columns = np.array(parts).T.tolist() if parts else [[]] * 20
    totals = [Fraction(math.fsum(column)) for column in columns[:20]]
    if columns[20:]:
        totals[:10] = [near_sum(high + low) for high, low in zip(columns[:10], columns[20:], strict=True)]
    v, fx, fy, fz, xx, yy, zz, yz, zx, xy = totals[:10]
    bounds = [_WIDEN * k + size * _UNDERFLOW for k in totals[10:20]]
    bv, bfx, bfy, bfz, bxx, byy, bzz, byz, bzx, bxy = bounds
    unit = Fraction(2) ** -exponent
    ox, oy, oz = (Fraction(float(k)) / unit for k in origin)
    moments = Moments(
        (ox, oy, oz),
        v,
        (fx, fy, fz),
        (xx, yy, zz, yz, zx, xy),
        bv,
        (bfx, bfy, bfz),
        (bxx, byy, bzz, byz, bzx, bxy),
    )
    return moments.in_unit(unit).scaled(unit**power)
