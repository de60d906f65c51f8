"""Signs of the Jacobian determinants of cells over all of each cell, and the cells that a place lies in.

The determinant of a cell's map is a polynomial in coordinates that run from 0 to 1 (collapsed ones for simplices,
wedges and pyramids), and lies between the least and the largest of its Bernstein coefficients there, of which those at
the corners are values of it. Boxes in which they do not tell are halved along every axis (G. Farin, *Curves and
Surfaces for CAGD*, 5th ed., 5.1 and 6.8; A. Johnen, J.-F. Remacle and C. Geuzaine, J. Comput. Phys. 233 (2013) 359).

Most cells need no more than one matrix: with J₀ in the middle, J₀⁻¹ J(ξ) has an inverse wherever it is nearer to the
identity than 1, so that the determinant has one sign where that holds everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.cell_shapes import KINDS, Kind, Powers, coefficients, known_volume_blocks
from inertia.mesh.geometry.triangle_pairs import orient3d
from inertia.mesh.part import Cells

TANGLED = 2
"""The sign of a cell whose determinant has both signs."""

_CELLS = 4096  # at a time
_HALVINGS = 8
_BOXES = 1 << 15  # undecided at a time, beyond which cells pass
_NEAR = 0.999  # of 1, to spare for what rounding does
_STEPS = 30
_FAR = 4.0  # from the middle of the reference shape, where Newton's method ends
_WITHIN = 1e-9  # how far inside the reference shape a place must lie
_SETTLED = 1e-12

_DEGREES = {
    "tetra10": (3, 3, 3),
    "hexahedron": (2, 2, 2),
    "wedge": (1, 1, 2),
    "wedge15": (4, 4, 5),
    "wedge18": (4, 4, 5),
    "pyramid": (1, 1, 0),
    "pyramid13": (5, 5, 3),
    "pyramid14": (5, 5, 3),
}
"""The degrees of the determinant in coordinates of the unit cube; 5, 5, 5 for hexahedra of second order."""


class Jacobians(NamedTuple):
    """The sign of each cell's determinant, and of tangled ones the lesser extreme over the other.

    `sign` (m,) is 1 or −1, 0 for a cell without volume (and one that is no volume cell), `TANGLED` for both; `share`
    (m,).
    """

    sign: NDArray[np.int8]
    share: Float


class _Bernstein(NamedTuple):
    """What a kind's determinants are computed from, over the grid of (d₁ + 1)(d₂ + 1)(d₃ + 1) places."""

    slopes: Float  # (3, places, nodes)
    inverses: tuple[Float, Float, Float]  # from values on the grid to coefficients, axis by axis
    middle: Float  # (3, nodes), slopes in the middle
    steep: Float  # (3, nodes), bounds on all slopes
    growth: float  # of errors, from values to coefficients


def jacobians(cells: Cells) -> Jacobians:
    """Return the signs of the Jacobian determinants of all cells, numbered through all blocks.

    Those of linear tetrahedra are exact; others count as one sign where they are so within rounding, or where eight
    halvings leave it open (as where a determinant falls to zero at a corner).

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    >>> bricks = np.array([[0, 1, 3, 2, 4, 5, 7, 6], [0, 1, 2, 3, 4, 5, 6, 7]])
    >>> jacobians(Cells(points, (CellBlock("hexahedron", bricks),))).sign
    array([1, 2], dtype=int8)
    """
    sign, share = [np.empty(0, np.int8)], [np.empty(0)]
    for block in cells.blocks:
        kind = KINDS.get(block.kind)
        for start in range(0, len(block.nodes), _CELLS):
            nodes = block.nodes[start : start + _CELLS]
            signs, shares = np.zeros(len(nodes), np.int8), np.zeros(len(nodes))
            if block.kind == "tetra":
                signs = orient3d(*cells.points[nodes].transpose(1, 0, 2))
            elif kind is not None and kind.faces:
                signs, shares = _signs(kind, cells.points[nodes])
            sign.append(signs)
            share.append(shares)
    return Jacobians(np.concatenate(sign), np.concatenate(share))


def _signs(kind: Kind, places: Float) -> tuple[NDArray[np.int8], Float]:
    """Return sign and share of cells with nodes at `places` (k, n, 3)."""
    table = _bernstein(kind.name)
    low, high = places.min(axis=1, keepdims=True), places.max(axis=1, keepdims=True)
    edges = places - (low / 2 + high / 2)
    half = np.abs(edges).max(axis=1)
    exponent = np.frexp(half.max(axis=1))[1]
    edges = np.ldexp(edges, -exponent[:, None, None]).transpose(1, 2, 0)
    half = np.ldexp(half, -exponent[:, None])
    steep = np.abs(table.slopes).sum(axis=2).max(axis=1)
    error = (len(edges) + 10) * 2.0**-50 * float(np.prod(steep)) * np.prod(half, axis=1)
    sign = np.zeros(len(places), np.int8)
    share = np.zeros(len(places))
    if kind.reference != "pyramid":
        sign = _by_middle(kind, table, edges, error)
    rest = np.flatnonzero(sign == 0)
    if len(rest):
        sign[rest], share[rest] = _by_coefficients(kind, table, edges[:, :, rest], error[rest])
    return sign, share


def _by_middle(kind: Kind, table: _Bernstein, edges: Float, error: Float) -> NDArray[np.int8]:
    """Return the signs of cells whose maps are near enough to the one in the middle, else 0."""
    slope = np.einsum("an,nik->aik", table.middle, edges)
    minors = np.stack([_cross(slope[j - 2], slope[j - 1]) for j in range(3)])  # (3, 3, k)
    determinant = (slope[0] * minors[0]).sum(axis=0)
    sure = np.abs(determinant) > error
    reference = np.array([[float(x) for x in node] for node in kind.nodes])
    aside = edges - np.einsum("na,aik->nik", reference, slope)
    aside -= aside.mean(axis=0)
    turned = np.einsum("jik,nik->njk", minors, aside) / np.where(sure, determinant, 1.0)
    off = np.einsum("an,njk->ajk", table.steep, np.abs(turned))
    near = off.sum(axis=0).max(axis=0) < _NEAR
    sign: NDArray[np.int8] = (np.sign(determinant) * (near & sure)).astype(np.int8)
    return sign


def _by_coefficients(kind: Kind, table: _Bernstein, edges: Float, error: Float) -> tuple[NDArray[np.int8], Float]:
    """Return sign and share of cells by the Bernstein coefficients of their determinants."""
    count = edges.shape[2]
    a, b, c = np.einsum("arn,nik->airk", table.slopes, edges)
    values = (a * _cross(b, c)).sum(axis=0)
    low, high = values.min(axis=0), values.max(axis=0)
    grid = tuple(degree + 1 for degree in _degrees(kind))
    boxes = values.T.reshape(count, *grid)
    for axis, inverse in enumerate(table.inverses):
        boxes = _along(axis, inverse, boxes)
    owner, slack = np.arange(count), error * table.growth
    sign = np.where(high > -low, 1, -1).astype(np.int8)
    sign[np.maximum(high, -low) <= error] = 0
    for _ in range(_HALVINGS):
        some, most = boxes.min(axis=(1, 2, 3)), boxes.max(axis=(1, 2, 3))
        tangled = (low < -error) & (high > error)
        # What is left of one sign, within rounding, in all of the box needs no halving.
        wanted = sign[owner]
        open_ = np.where(wanted > 0, some < -slack[owner], most > slack[owner]) & ~tangled[owner] & (wanted != 0)
        boxes, owner = boxes[open_], owner[open_]
        if len(owner) == 0 or len(owner) > _BOXES:
            break
        for axis in range(3):
            lower, upper = _halves(grid[axis] - 1)
            boxes = np.concatenate([_along(axis, lower, boxes), _along(axis, upper, boxes)])
            owner = np.concatenate([owner, owner])
        corners = boxes[:, :: max(grid[0] - 1, 1), :: max(grid[1] - 1, 1), :: max(grid[2] - 1, 1)]
        np.minimum.at(low, owner, corners.min(axis=(1, 2, 3)))
        np.maximum.at(high, owner, corners.max(axis=(1, 2, 3)))
    # A corner of a box is as uncertain as a coefficient.
    doubtful = np.where(np.minimum(high, -low) > slack, slack, error)
    tangled = (low < -doubtful) & (high > doubtful)
    sign[tangled] = TANGLED
    most = np.maximum(high, -low)
    share = np.divide(np.minimum(high, -low), most, out=np.zeros(count), where=tangled)
    return sign, share


def _along(axis: int, matrix: Float, boxes: Float) -> Float:
    moved: Float = np.moveaxis(np.einsum("ij,...j->...i", matrix, np.moveaxis(boxes, axis + 1, -1)), -1, axis + 1)
    return moved


@cache
def _halves(degree: int) -> tuple[Float, Float]:
    """Return the matrices that take Bernstein coefficients to those on the lower and the upper half."""
    lower = np.array([[math.comb(i, j) / 2**i for j in range(degree + 1)] for i in range(degree + 1)])
    return lower, lower[::-1, ::-1].copy()


def _degrees(kind: Kind) -> tuple[int, int, int]:
    return _DEGREES.get(kind.name, (5, 5, 5))


@cache
def _bernstein(name: str) -> _Bernstein:
    kind = KINDS[name]
    degrees = _degrees(kind)
    axes = [np.linspace(0.0, 1.0, degree + 1) if degree else np.full(1, 0.5) for degree in degrees]
    cube = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    slopes = _slopes(kind, _from_cube(kind.reference, cube))
    inverses = []
    for degree, nodes in zip(degrees, axes, strict=True):
        basis = [[math.comb(degree, j) * x**j * (1 - x) ** (degree - j) for j in range(degree + 1)] for x in nodes]
        inverses.append(np.linalg.inv(np.array(basis)))
    boxes = slopes.transpose(0, 2, 1).reshape(-1, *(degree + 1 for degree in degrees))
    for axis, inverse in enumerate(inverses):
        boxes = _along(axis, inverse, boxes)
    steep = np.abs(boxes).max(axis=(1, 2, 3)).reshape(3, -1)
    growth = math.prod(float(np.abs(inverse).sum(axis=1).max()) for inverse in inverses)
    middle = np.mean([[float(x) for x in node] for node in kind.nodes[: kind.corners]], axis=0)[None]
    return _Bernstein(slopes, (inverses[0], inverses[1], inverses[2]), _slopes(kind, middle)[:, 0], steep, 2 * growth)


def _from_cube(reference: str, t: Float) -> Float:
    """Take points of the unit cube to the reference shape, in the coordinates of its shape functions."""
    u, v, w = t.T
    if reference == "box":
        return 2 * t - 1
    if reference == "pyramid":
        return np.stack([2 * u - 1, 2 * v - 1, w], axis=1)
    if reference == "wedge":
        return np.stack([v * u, v * (1 - u), 2 * w - 1], axis=1)
    return np.stack([w * v * u, w * v * (1 - u), w * (1 - v)], axis=1)


def _slopes(kind: Kind, places: Float) -> Float:
    """Return the derivatives (3, r, n) of the shape functions at places (r, 3), as `Kind.derivatives` has them."""
    slopes = []
    for axis in range(3):
        factors, powers = kind.derivatives(axis)
        slopes.append((_monomials(places, powers) * factors) @ _coefficients(kind.name))
    return np.stack(slopes)


@cache
def _coefficients(name: str) -> Float:
    return coefficients(name).astype(np.float64)


def _monomials(places: Float, powers: Sequence[Powers]) -> Float:
    raised = np.stack([np.ones_like(places), places, places * places])
    # A derivative that vanishes may have a negative power here; its factor is zero.
    i, j, k = np.maximum(np.array(powers), 0).T
    terms: Float = raised[i, :, 0] * raised[j, :, 1] * raised[k, :, 2]
    return terms.T


def _cross(a: Float, b: Float) -> Float:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def covering(cells: Cells, places: Float, pairs: Int) -> Bool:
    """Say in which pairs (k, 2) of a place (p, 3) and a cell, numbered through all blocks, the cell covers the place.

    Newton's method starts at the middle of the cell, and near its corners where it comes to nothing from there. A place
    on the cell's faces is not covered.
    """
    covered = np.zeros(len(pairs), bool)
    for first, block in known_volume_blocks(cells):
        here = np.flatnonzero((pairs[:, 1] >= first) & (pairs[:, 1] < first + len(block.nodes)))
        for start in range(0, len(here), _CELLS):
            some = here[start : start + _CELLS]
            nodes = cells.points[block.nodes[pairs[some, 1] - first]]
            covered[some] = _covers(KINDS[block.kind], nodes - places[pairs[some, 0], None])
    return covered


def _covers(kind: Kind, nodes: Float) -> Bool:
    """Say which cells with nodes (k, n, 3) cover the origin."""
    corners = np.array([[float(x) for x in node] for node in kind.nodes[: kind.corners]])
    middle = corners.mean(axis=0)
    size = np.abs(nodes).max(axis=(1, 2), keepdims=True)
    nodes = nodes / np.where(size > 0, size, 1.0)
    covered, rest = np.zeros(len(nodes), bool), np.arange(len(nodes))
    for start in [middle, *(0.3 * middle + 0.7 * corners)]:
        at, settled = _origin(kind, nodes[rest], start)
        covered[rest[settled]] = _inside(kind.reference, at[settled])
        rest = rest[~settled]
        if len(rest) == 0:
            break
    return covered


def _origin(kind: Kind, nodes: Float, start: Float) -> tuple[Float, Bool]:
    """Return the points (k, 3) that Newton's method comes to from `start`, and whether they are taken to the origin."""
    at = np.tile(start, (len(nodes), 1))
    settled = np.zeros(len(nodes), bool)
    moving = np.arange(len(nodes))
    for _ in range(_STEPS):
        value, slope = _map(kind, at[moving], nodes[moving])
        minors = np.stack([_cross(slope[j - 2], slope[j - 1]) for j in range(3)])
        determinant = (slope[0] * minors[0]).sum(axis=0)
        step = np.einsum("jik,ik->kj", minors, value) / np.where(determinant != 0, determinant, np.inf)[:, None]
        length = np.abs(step).max(axis=1)
        at[moving] -= step * np.minimum(1.0, 1.0 / np.maximum(length, 1.0))[:, None]
        settled[moving] = (length < _SETTLED) & (np.abs(value).max(axis=0) < _WITHIN)
        moving = moving[(length >= _SETTLED) & (np.abs(at[moving]).max(axis=1) < _FAR)]
        if len(moving) == 0:
            break
    return at, settled | (np.abs(at).max(axis=1) >= _FAR)


def _map(kind: Kind, at: Float, nodes: Float) -> tuple[Float, Float]:
    """Return where the maps of cells take a point of each, (3, k), and their slopes there, (3, 3, k)."""
    shapes = _monomials(at, kind.space) @ _coefficients(kind.name)
    slopes = []
    for axis in range(3):
        factors = np.array([powers[axis] for powers in kind.space])
        lower = [tuple(p - (i == axis) for i, p in enumerate(powers)) for powers in kind.space]
        slopes.append((_monomials(at, lower) * factors) @ _coefficients(kind.name))
    value, x, y, z = np.matmul(np.stack([shapes, *slopes], axis=1), nodes).transpose(1, 2, 0)
    return value, np.stack([x, y, z])


def _inside(reference: str, at: Float) -> Bool:
    """Say which points lie inside a reference shape, by more than rounding."""
    x, y, z = at.T
    if reference == "box":
        ways = [1 - np.abs(at)]
    elif reference == "pyramid":
        ways = [1 - np.abs(at[:, :2]), z, 1 - z]
    elif reference == "wedge":
        ways = [x, y, 1 - x - y, 1 - np.abs(z)]
    else:
        ways = [at, 1 - x - y - z]
    inside: Bool = np.column_stack(ways).min(axis=1) > _WITHIN
    return inside
