"""The maps of meshio's cells: their nodes, and the polynomials that each map is made of.

A cell maps a reference shape to space by x(ξ) = Σ Nᵢ(ξ) xᵢ. Its shape function Nᵢ is the one polynomial of
the kind's space that is 1 at node i and 0 at the others, so the nodes and the space are all that needs
stating. Nodes stand in VTK's order, which is meshio's: corners, then the middles of edges, of faces, and of
the cell.

==========  ====================================================================================
box         line, quad, hexahedron: every coordinate in [−1, 1]
simplex     triangle, tetra: coordinates r, s(, t) ≥ 0 with a sum of at most 1
wedge       (r, s) in the triangle, t in [−1, 1]
pyramid     base (±1, ±1, 0), apex (0, 0, 1); as coordinates (x/(1 − z), y/(1 − z), 1 − z) = (ξ, η, w)
            are used, in which its rational functions are polynomials
==========  ====================================================================================

The spaces are the linear, quadratic and serendipity ones of the textbooks (Zienkiewicz, Taylor and Zhu, *The
Finite Element Method: Its Basis and Fundamentals*, chapter 6). The 14-node pyramid is the second-order one of
Bergot, Cohen and Duruflé (J. Sci. Comput. 42, 2010, 345–381), spanned by ξⁱ ηʲ wᵐ with max(i, j) ≤ m ≤ 2;
without ξ² η² w² it is the 13-node one of Bedrosian (Int. J. Numer. Meth. Engng 35, 1992, 95–108). VTK's
13-node pyramid differs from it inside only; the faces are the same quadratic ones, and so are the moments.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.errors import GeometryError
from inertia.mesh.part import CellBlock, Cells
from inertia.records import dataclass

Point = tuple[Fraction, ...]
Powers = tuple[int, ...]
Groups = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Kind:
    """A kind of cell, as meshio names it.

    `reference` is "box", "simplex", "wedge" or "pyramid"; `nodes` are its nodes in the coordinates of the
    table above, the first `corners` of them corners; `space` holds the powers of the monomials that span the
    shape functions. `points` are the Gauss points for each direction of integration (see `KINDS`). `faces`
    are the faces' kinds and nodes.
    """

    name: str
    reference: str
    corners: int
    nodes: tuple[Point, ...]
    space: tuple[Powers, ...]
    points: tuple[int, ...]
    faces: tuple[tuple[str, tuple[int, ...]], ...] = ()

    def derivatives(self, axis: int) -> tuple[list[int], list[Powers]]:
        """Return the factors and the powers of the monomials' derivatives along an axis.

        On a pyramid ∂/∂ξ and ∂/∂η are divided by w, and ∂/∂w is negated: so they make up the determinant of the
        map over that of the collapse, −w², and stay finite at the apex.
        """
        pyramid = self.reference == "pyramid"
        factors, lower = [], []
        for powers in self.space:
            factor, less = powers[axis], list(powers)
            if factor:
                less[axis] -= 1
                if pyramid and axis < 2:
                    less[2] -= 1
            factors.append(-factor if pyramid and axis == 2 else factor)
            lower.append(tuple(less))
        return factors, lower


@dataclass(frozen=True)
class _Family:
    reference: str
    corners: tuple[tuple[int, ...], ...]
    edges: Groups = ()
    faces: Groups = ()
    """In the order of their middle nodes, as far as a kind has them."""


_LINE = _Family("box", ((-1,), (1,)), ((0, 1),))
_TRIANGLE = _Family("simplex", ((0, 0), (1, 0), (0, 1)), ((0, 1), (1, 2), (2, 0)))
_QUAD = _Family("box", ((-1, -1), (1, -1), (1, 1), (-1, 1)), ((0, 1), (1, 2), (2, 3), (3, 0)), ((0, 1, 2, 3),))
_TETRA = _Family(
    "simplex",
    ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    ((0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 2, 1)),
)
_HEXAHEDRON = _Family(
    "box",
    tuple((x, y, z) for z in (-1, 1) for x, y in _QUAD.corners),
    (*_QUAD.edges, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)),
)
_WEDGE = _Family(
    "wedge",
    tuple((r, s, t) for t in (-1, 1) for r, s in _TRIANGLE.corners),
    (*_TRIANGLE.edges, (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5), (0, 2, 1), (3, 4, 5)),
)
_PYRAMID = _Family(
    "pyramid",
    (*((x, y, 0) for x, y in _QUAD.corners), (0, 0, 1)),
    (*_QUAD.edges, (0, 4), (1, 4), (2, 4), (3, 4)),
    ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
)
_FACE_KINDS = {3: "triangle", 6: "triangle6", 4: "quad", 8: "quad8", 9: "quad9"}


def _kind(
    name: str,
    family: _Family,
    space: Iterable[Powers],
    points: tuple[int, ...],
    *,
    edges: bool = False,
    faces: int = 0,
    centre: bool = False,
) -> Kind:
    """Make a kind with a node in the middle of each edge, of the first `faces` faces, and of the cell."""
    corners = [tuple(Fraction(x) for x in corner) for corner in family.corners]
    groups: list[tuple[int, ...]] = [(i,) for i in range(len(corners))]
    groups += family.edges if edges else ()
    groups += family.faces[:faces]
    if centre:
        groups.append(tuple(range(len(corners))))
    nodes = [_mean([corners[i] for i in group]) for group in groups]
    if family.reference == "pyramid":
        nodes = [_collapsed(node) for node in nodes]
    place = {frozenset(group): node for node, group in enumerate(groups)}
    boundary = []
    if len(corners[0]) == 3:
        for face in family.faces:
            ends = zip(face, (*face[1:], face[0]), strict=True)
            order = [*((i,) for i in face), *ends, face]
            on_face = tuple(place[frozenset(group)] for group in order if frozenset(group) in place)
            boundary.append((_FACE_KINDS[len(on_face)], on_face))
    return Kind(name, family.reference, len(corners), tuple(nodes), tuple(space), points, tuple(boundary))


def _mean(points: Sequence[Point]) -> Point:
    return tuple(sum(column, Fraction(0)) / len(points) for column in zip(*points, strict=True))


def _collapsed(point: Point) -> Point:
    x, y, z = point
    w = 1 - z
    return (x / w, y / w, w) if w else (Fraction(0), Fraction(0), w)


def _total(dimension: int, degree: int) -> list[Powers]:
    """List the monomials of at most this degree altogether."""
    return [p for p in product(range(degree + 1), repeat=dimension) if sum(p) <= degree]


def _each(dimension: int, degree: int) -> list[Powers]:
    """List the monomials of at most this degree in each coordinate."""
    return list(product(range(degree + 1), repeat=dimension))


def _serendipity(dimension: int) -> list[Powers]:
    """List the monomials of a superlinear degree (which leaves out coordinates of power 1) of at most 2."""
    return [p for p in _each(dimension, 2) if sum(power for power in p if power > 1) <= 2]


def _prism(across: list[Powers], along: Iterable[int]) -> list[Powers]:
    return [(*p, t) for t in along for p in across]


def _pyramid(order: int) -> list[Powers]:
    return [(i, j, m) for i, j, m in _each(3, order) if max(i, j) <= m]


_LATERAL: list[Powers] = [(0, 2, 2), (1, 2, 2), (2, 0, 2), (2, 1, 2)]

KINDS = {
    kind.name: kind
    for kind in (
        _kind("line", _LINE, _each(1, 1), (2,)),
        _kind("line3", _LINE, _each(1, 2), (20,), edges=True),
        _kind("triangle", _TRIANGLE, _total(2, 1), (1, 1)),
        _kind("triangle6", _TRIANGLE, _total(2, 2), (6, 6), edges=True),
        _kind("quad", _QUAD, _each(2, 1), (6, 6)),
        _kind("quad8", _QUAD, _serendipity(2), (6, 6), edges=True),
        _kind("quad9", _QUAD, _each(2, 2), (6, 6), edges=True, faces=1),
        _kind("tetra", _TETRA, _total(3, 1), ()),
        _kind("tetra10", _TETRA, _total(3, 2), (4, 4, 4), edges=True),
        _kind("hexahedron", _HEXAHEDRON, _each(3, 1), (3, 3, 3)),
        _kind("hexahedron20", _HEXAHEDRON, _serendipity(3), (5, 5, 5), edges=True),
        _kind("hexahedron24", _HEXAHEDRON, _serendipity(3) + _LATERAL, (5, 5, 5), edges=True, faces=4),
        _kind("hexahedron27", _HEXAHEDRON, _each(3, 2), (5, 5, 5), edges=True, faces=6, centre=True),
        _kind("wedge", _WEDGE, _prism(_total(2, 1), (0, 1)), (2, 2, 3)),
        _kind(
            "wedge15",
            _WEDGE,
            _prism(_total(2, 2), (0, 1)) + _prism(_total(2, 1), (2,)),
            (5, 5, 5),
            edges=True,
        ),
        _kind("wedge18", _WEDGE, _prism(_total(2, 2), (0, 1, 2)), (5, 5, 5), edges=True, faces=3),
        _kind("pyramid", _PYRAMID, _pyramid(1), (2, 2, 2)),
        _kind("pyramid13", _PYRAMID, [p for p in _pyramid(2) if p != (2, 2, 2)], (5, 5, 4), edges=True),
        _kind("pyramid14", _PYRAMID, _pyramid(2), (5, 5, 4), edges=True, faces=1),
    )
}
"""Every kind by meshio's name. The solids' points make ∫ det J x xᵀ exact, n points being exact to
degree 2n − 1:

===================  ============================================  =================  =========
kind                 degree of det J in each direction             … with x xᵀ        points
===================  ============================================  =================  =========
tetra                0                                             2                  (see below)
tetra10              3 in all (three columns of degree 1)          7                  4, 4, 4
hexahedron           2 (two columns of degree 1, one of 0)         4                  3, 3, 3
hexahedron20–27      5 (two columns of degree 2, one of 1)         9                  5, 5, 5
wedge                1 in (r, s), 2 in t                           3, 3, 4            2, 2, 3
wedge15, wedge18     4 in (r, s), 5 in t                           8, 8, 9            5, 5, 5
pyramid              1 in ξ and η, 0 in w (ξ² has equal columns)   3, 3, 2            2, 2, 2
pyramid13, -14       5 in ξ and η, 3 in w                          9, 9, 7            5, 5, 4
===================  ============================================  =================  =========

The tetrahedron has the four corners with a weight of 1/20 each and the centroid with 4/5 for points, which is
exact to degree 2: the closed form of a simplex. A total degree in (r, s, t) is the degree in each direction
of the collapsed coordinates that the points are laid out in; the collapse's own Jacobian, and the pyramid's
w², are the weight of Gauss–Jacobi rules (see `shape_functions`). Lengths and areas of curved wires and faces have
no polynomial integrand: `points` are plenty for smooth ones.
"""


FLAT_TRIANGLES = {
    "triangle": [[0, 1, 2]],
    "quad": [[0, 1, 2], [0, 2, 3]],
    "triangle6": [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
    "triangle7": [[6, 0, 3], [6, 3, 1], [6, 1, 4], [6, 4, 2], [6, 2, 5], [6, 5, 0]],
    "quad8": [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
    "quad9": [
        [8, 0, 4], [8, 4, 1], [8, 1, 5], [8, 5, 2], [8, 2, 6], [8, 6, 3], [8, 3, 7], [8, 7, 0],
    ],
}  # fmt: skip
"""The flat triangles between the nodes of a surface cell."""


@cache
def coefficients(name: str) -> NDArray[Any]:
    """Return the coefficients (monomial, node), fractions, of the functions that are 1 at one node and 0 elsewhere."""
    kind = KINDS[name]
    n = len(kind.nodes)
    rows = [
        [math.prod((x**p for x, p in zip(node, powers, strict=True)), start=Fraction(1)) for powers in kind.space]
        + [Fraction(i == j) for j in range(n)]
        for i, node in enumerate(kind.nodes)
    ]
    matrix = np.array(rows, dtype=object)
    for i in range(n):
        pivot = next(k for k in range(i, n) if matrix[k, i])
        matrix[[i, pivot]] = matrix[[pivot, i]]
        matrix[i] /= matrix[i, i]
        for k in range(n):
            if k != i and matrix[k, i]:
                matrix[k] -= matrix[k, i] * matrix[i]
    return matrix[:, n:]


def volume_blocks(cells: Cells) -> list[tuple[int, CellBlock]]:
    """Return the blocks of volume cells, each with the number of its first cell through all blocks.

    Lines and points are passed over; raises `GeometryError` for cells of any other kind.
    """
    numbered = []
    for first, block in numbered_blocks(cells):
        kind = KINDS.get(block.kind)
        if kind is not None and kind.faces:
            numbered.append((first, block))
        elif not block.kind.startswith(("line", "vertex")):
            known = ", ".join(name for name, kind in KINDS.items() if kind.faces)
            raise GeometryError(
                f"cell {first} is of the kind {block.kind!r}, which has no volume or no map here: use {known}"
            )
    return numbered


def known_volume_blocks(cells: Cells) -> list[tuple[int, CellBlock]]:
    """Return the blocks of volume cells whose kind has a map here, each with the number of its first cell."""
    return [
        (first, block) for first, block in numbered_blocks(cells) if block.kind in KINDS and KINDS[block.kind].faces
    ]


def numbered_blocks(cells: Cells) -> list[tuple[int, CellBlock]]:
    """Return all blocks, each with the number of its first cell."""
    sizes = [len(block.nodes) for block in cells.blocks]
    return [(sum(sizes[:i]), block) for i, block in enumerate(cells.blocks)]
