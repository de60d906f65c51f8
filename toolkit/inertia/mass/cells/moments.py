"""Exact moments of the cells of a volume mesh and of wires, and the area of the outside of the mesh.

Each cell is what its own map makes of its reference shape (`inertia.mesh.geometry.cell_shapes`), curved edges and
warped faces included. The integrals ∫ det J, ∫ det J x, ∫ det J x xᵀ have polynomial integrands, so Gauss rules with
enough points are exact but for rounding, and rounding has a bound (`quadrature`).
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, Progress
from inertia.errors import GeometryError, UsageError
from inertia.mass.cells.double_double import double_determinants, double_moment_rows, double_wire_rows
from inertia.mass.cells.quadrature import (
    UNIT_ROUNDOFF,
    Chunk,
    combined,
    determinant_errors,
    integrate,
    moment_rows,
    speed_errors,
)
from inertia.mass.cells.shape_functions import Table, table
from inertia.mass.double_words import Pair
from inertia.mass.moments import PAIRS, ZERO, Moments, six, vector
from inertia.mesh.geometry.cell_shapes import KINDS, numbered_blocks, volume_blocks
from inertia.mesh.geometry.edges import first_equal
from inertia.mesh.part import CellBlock, Cells, Rounding
from inertia.records import dataclass

_COARSE = (12,)
"""Gauss points of the rule that a curved wire's rule is compared with."""

_LEFT = 2.0**-50  # of what was rounded, when it is undone by the float64 nearest to it
_LEBESGUE = 3.0  # of cells of second order, the largest Σ|Nᵢ| on a face: of 8 nodes, in its middle
_GROWTH = 300.0  # twice the product of the largest Σ|∂Nᵢ/∂ξ| along both directions of a face, over its area
_REACH = 3.0  # of the same, how far a face may be from the origin, over how far its nodes are

_FACES = 4096  # of the outside, integrated at a time


@dataclass(frozen=True)
class CellIntegral:
    """The moments of each group of cells, weighted by volume, and how many cells are reversed."""

    moments: tuple[Moments, ...]
    reversed: int


def cell_moments(
    cells: Cells,
    groups: NDArray[np.int32] | None = None,
    count: int = 1,
    progress: Progress | None = None,
    arithmetic: Literal["float64", "double-double"] = "float64",
    rounding: Rounding | None = None,
) -> CellIntegral:
    """Integrate 1, x and x xᵀ over the volume cells of a mesh, group by group.

    A cell with a negative Jacobian everywhere has its nodes numbered the other way round, which is a matter
    of convention (programs differ for wedges): its volume counts positive, and `reversed` counts it. Lines
    and points in the mesh are passed over.

    Parameters
    ----------
    cells : the mesh, in any one unit, which is the result's too
    groups : (number of cells,) the group, 0 to count − 1, of each cell, numbered through all blocks in order
    count : number of groups
    progress : called with the fraction that is done
    arithmetic : double-double costs some three (tetrahedra) to twelve times (20 nodes) as much as float64
    rounding : of the coordinates, when they were read: undone in double-double, where it can be, else in the bounds

    Raises
    ------
    GeometryError
        for a kind of cell that has no map here; for a node that does not exist or is not finite; for the
        first cell that is tangled (its Jacobian has both signs at quadrature points and corners) or has no
        volume, each time by more than rounding can do.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    >>> result = cell_moments(Cells(points, (CellBlock("tetra", np.array([[0, 1, 2, 3]])),)))
    >>> float(6 * result.moments[0].zeroth), result.reversed
    (1.0, 0)
    """
    _require_groups(cells, groups, count)
    turned = 0

    def rows(chunk: Chunk) -> Float:
        nonlocal turned
        shape = table(chunk.kind)
        if arithmetic == "double-double":
            fine, error = double_determinants(shape, chunk)
            determinant = fine.high
        else:
            determinant, error = _determinants(shape, chunk)
        low, high = determinant.min(axis=0), determinant.max(axis=0)
        tangled = (low < -error) & (high > error)
        flat = np.maximum(-low, high) <= error
        if (tangled | flat).any():
            cell = int(np.argmax(tangled | flat))
            share = min(-low[cell], high[cell]) / max(-low[cell], high[cell]) if tangled[cell] else 0.0
            raise _refusal(chunk, cell, share)
        negative = -low > high
        turned += int(np.count_nonzero(negative))
        sign = np.where(negative, -1.0, 1.0)
        if arithmetic == "double-double":
            return double_moment_rows(shape, chunk, Pair(sign * fine.high, sign * fine.low), error)
        positive = sign * determinant[: len(shape.weights)]
        return moment_rows(shape, chunk, positive, error)

    blocks = volume_blocks(cells)
    rests = None
    if rounding is not None and rounding.remainder is not None and arithmetic == "double-double":
        rests = rounding.remainder()
    moments = integrate(cells, blocks, rows, groups=groups, count=count, power=3, progress=progress, rests=rests)
    if rounding is not None:
        distance = rounding.distance * (_LEFT if rests is not None else 1.0)
        parts = (_group(cells, blocks, None if groups is None else groups == number) for number in range(count))
        moments = tuple(cells_as_written(one, part, distance) for one, part in zip(moments, parts, strict=True))
    return CellIntegral(moments, turned)


def _require_groups(cells: Cells, groups: NDArray[np.int32] | None, count: int) -> None:
    if groups is None:
        return
    if len(groups) != cells.count:
        raise UsageError(f"groups must have one entry for each of the {cells.count} cells, not {len(groups)}")
    if len(groups) and not 0 <= groups.min() <= groups.max() < count:
        raise UsageError(f"groups must be 0 to {count - 1}, not {groups.min()} to {groups.max()}")


def _group(cells: Cells, blocks: list[tuple[int, CellBlock]], member: Bool | None) -> Cells:
    """Return the cells of a group, or all, among those of blocks, each with the number of its first cell."""
    members = [
        CellBlock(block.kind, block.nodes if member is None else block.nodes[member[first : first + len(block.nodes)]])
        for first, block in blocks
    ]
    return Cells(cells.points, tuple(block for block in members if len(block.nodes)))


def cells_as_written(moments: Moments, cells: Cells, distance: float) -> Moments:
    """Return the moments of cells with bounds that hold if every node is moved by at most `distance`.

    Only the outside moves the moments: by the distance times its area at most, and times what the shape functions of a
    face add up to in magnitude; and the area grows with the distance.
    """
    if not moments.zeroth:
        return moments
    faces = sum(len(block.nodes) * len(KINDS[block.kind].faces) for block in cells.blocks)
    points = cells.points[np.unique(np.concatenate([block.nodes.ravel() for block in cells.blocks]))]
    middle = np.array([float(k) for k in moments.origin])
    size = float(np.ptp(points, axis=0).max())
    area = 1.01 * boundary_area(cells) + _GROWTH * distance * (size + distance) * faces
    curved = any(block.nodes.shape[1] > KINDS[block.kind].corners for block in cells.blocks)
    volume = (_LEBESGUE if curved else 1.0) * distance * area * 1.01
    reach = (_REACH if curved else 1.01) * (np.abs(points - middle).max(axis=0) + distance)
    return moments + Moments(
        moments.origin,
        ZERO,
        (ZERO, ZERO, ZERO),
        (ZERO,) * 6,
        Fraction(volume),
        vector(Fraction(float(x * volume)) for x in reach),
        six(Fraction(float(reach[i] * reach[j] * volume)) for i, j in PAIRS),
    )


def wire_moments(
    cells: Cells,
    groups: NDArray[np.int32] | None = None,
    count: int = 1,
    arithmetic: Literal["float64", "double-double"] = "float64",
    rounding: Rounding | None = None,
) -> tuple[Moments, ...]:
    """Integrate 1, x and x xᵀ over the length of the `line` and `line3` cells of a mesh, group by group.

    Straight lines are exact but for rounding. The length of a curved one is no polynomial: it is taken by
    Gauss's rule with 20 points, and the difference from the rule with 12 is added to the bounds, as an
    estimate; these are in float64 always. Parameters as for `cell_moments`.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[0, 0, 0], [3, 4, 0]], float)
    >>> (moments,) = wire_moments(Cells(points, (CellBlock("line", np.array([[0, 1]])),)))
    >>> float(moments.zeroth)
    5.0
    """
    _require_groups(cells, groups, count)

    def rows(chunk: Chunk) -> Float:
        if arithmetic == "double-double":
            return double_wire_rows(table(chunk.kind), chunk)
        fine = _wire_rows(table(chunk.kind), chunk)
        if chunk.kind == "line3":
            coarse = _wire_rows(table(chunk.kind, _COARSE), chunk)
            fine[:, 10:] += np.abs(fine[:, :10] - coarse[:, :10])
        return fine

    blocks = [(number, block) for number, block in numbered_blocks(cells) if block.kind.startswith("line")]
    for number, block in blocks:
        if block.kind not in ("line", "line3"):
            raise GeometryError(f"cell {number} is of the kind {block.kind!r}: wires are of the kinds line and line3")
    if any(block.kind == "line3" for _, block in blocks):
        arithmetic = "float64"
    rests = None
    if rounding is not None and rounding.remainder is not None and arithmetic == "double-double":
        rests = rounding.remainder()
    moments = integrate(cells, blocks, rows, groups=groups, count=count, power=1, rests=rests)
    if rounding is None:
        return moments
    distance = rounding.distance * (_LEFT if rests is not None else 1.0)
    parts = (_group(cells, blocks, None if groups is None else groups == number) for number in range(count))
    return tuple(_wires_as_written(one, part, distance) for one, part in zip(moments, parts, strict=True))


def _wires_as_written(moments: Moments, cells: Cells, distance: float) -> Moments:
    """Return the moments of wires with bounds that hold if every node is moved by at most `distance`.

    Its tangent grows by at most 4 for each unit of distance, over its parameter from −1 to 1; and what it is weighted
    with moves.
    """
    used = [block.nodes for block in cells.blocks]
    if not used:
        return moments
    points = cells.points[np.unique(np.concatenate([nodes.ravel() for nodes in used]))]
    middle = np.array([float(k) for k in moments.origin])
    growth = 8.01 * distance * sum(map(len, used))
    turn = 1.3 * distance * (float(moments.zeroth) + growth)
    reach = 1.3 * (np.abs(points - middle).max(axis=0) + distance)
    return moments + Moments(
        moments.origin,
        ZERO,
        (ZERO, ZERO, ZERO),
        (ZERO,) * 6,
        Fraction(growth),
        vector(Fraction(float(x * growth + turn)) for x in reach),
        six(Fraction(float(reach[i] * reach[j] * growth + (reach[i] + reach[j]) * turn)) for i, j in PAIRS),
    )


def boundary_area(cells: Cells) -> float:
    """Return the area of the faces that only one volume cell uses, in the file's unit².

    Faces are the same where their corners are, nodes with equal coordinates counting as one. Flat triangles
    have their closed form; other faces are integrated by Gauss's rule with 6 × 6 points over their own map,
    which is exact but for rounding for flat quadrilaterals, and for curved faces limited by how smooth they
    are.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    >>> cube = CellBlock("hexahedron", np.array([[0, 1, 3, 2, 4, 5, 7, 6]]))
    >>> round(boundary_area(Cells(points, (cube,))), 12)
    6.0
    """
    blocks = volume_blocks(cells)
    if not blocks:
        return 0.0
    welded = first_equal((cells.points + 0.0).view(np.int64))
    faces = [(kind, block.nodes[:, nodes]) for _, block in blocks for kind, nodes in KINDS[block.kind].faces]
    first = first_equal(np.concatenate([_ascending(welded[nodes[:, : KINDS[kind].corners]]) for kind, nodes in faces]))
    single = np.bincount(first, minlength=len(first))[first] == 1
    parts, start = [], 0
    for kind, nodes in faces:
        outside = nodes[single[start : start + len(nodes)]]
        start += len(nodes)
        parts += [_area(cells.points, kind, outside[i : i + _FACES]) for i in range(0, len(outside), _FACES)]
    return math.fsum(parts)


def _determinants(shape: Table, chunk: Chunk) -> tuple[Float, Float]:
    """Return det ∂x/∂ξ at the points and corners, (r, k), and a bound on the error of each cell's, (k,)."""
    n, _, k = chunk.edges.shape
    jacobian = combined(shape.slopes.reshape(-1, n), chunk.edges).reshape(3, -1, 3, k)
    a, b, c = (jacobian[:, :, axis] for axis in range(3))
    determinant = (
        a[0] * (b[1] * c[2] - b[2] * c[1]) + b[0] * (c[1] * a[2] - c[2] * a[1]) + c[0] * (a[1] * b[2] - a[2] * b[1])
    )
    return determinant, determinant_errors(shape, chunk, jacobian, UNIT_ROUNDOFF)


def _wire_rows(shape: Table, chunk: Chunk) -> Float:
    """Return the moments of each wire and their bounds; |dx/dξ| takes the place of the determinant."""
    speed = np.sqrt((combined(shape.slopes[0], chunk.edges) ** 2).sum(axis=1))
    error = speed_errors(shape, chunk, speed, UNIT_ROUNDOFF)
    return moment_rows(shape, chunk, speed[: len(shape.weights)], error)


def _refusal(chunk: Chunk, cell: int, share: float) -> GeometryError:
    """Say what is wrong with a cell; `share` is its Jacobian's lesser extreme over the other, 0 if flat."""
    nodes = " ".join(str(node) for node in chunk.nodes[cell])
    name = f"cell {chunk.first + cell} ({chunk.kind}, nodes {nodes})"
    if share:
        return GeometryError(
            f"{name} is tangled: its Jacobian determinant has both signs, one reaching {share:.2g} of "
            "the other; give its nodes in the order of the file's format (of arrays, VTK's), or mesh it again"
        )
    return GeometryError(
        f"{name} has no volume: its Jacobian determinant is 0 within rounding; remove it, or mesh it again"
    )


def _ascending(corners: Int) -> Int:
    """Return the corners of each face in ascending order, (m, 4), the last repeated until there are four.

    So a quadrilateral with two corners in one place is the same as the triangle on its other side.
    """
    key = np.sort(np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), mode="edge"), axis=1)
    key[:, 1:] = np.where(key[:, 1:] == key[:, :-1], key[:, -1:], key[:, 1:])
    return np.sort(key, axis=1)


def _area(points: Float, kind: str, nodes: Int) -> float:
    shape = table(kind)
    edges = points[nodes] - points[nodes[:, :1]]
    u, v = np.einsum("aqn,fnx->afqx", shape.slopes[:, : len(shape.weights)], edges)
    return float((np.linalg.norm(np.cross(u, v), axis=2) * shape.weights).sum())
