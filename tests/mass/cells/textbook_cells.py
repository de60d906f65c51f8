"""The cells of the textbooks, and their moments by rational integration of the map that defines them."""

import itertools
import math
from fractions import Fraction

import numpy as np

from inertia.mass.moments import PAIRS, Moments
from inertia.mesh.part import CellBlock, Cells

ORIGIN = (Fraction(0),) * 3

# The cells as the textbooks and VTK's documentation have them: corners, edges, and faces with a middle node.
SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
TRIANGLE = [(0, 0), (1, 0), (0, 1)]
RING, TRIPLE = [(0, 1), (1, 2), (2, 3), (3, 0)], [(0, 1), (1, 2), (2, 0)]
CORNERS = {
    "tetra": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "hexahedron": [(x, y, z) for z in (-1, 1) for x, y in SQUARE],
    "wedge": [(x, y, z) for z in (-1, 1) for x, y in TRIANGLE],
    "pyramid": [*((x, y, 0) for x, y in SQUARE), (0, 0, 1)],
}
EDGES = {
    "tetra": [*TRIPLE, (0, 3), (1, 3), (2, 3)],
    "hexahedron": [*RING, *((a + 4, b + 4) for a, b in RING), (0, 4), (1, 5), (2, 6), (3, 7)],
    "wedge": [*TRIPLE, *((a + 3, b + 3) for a, b in TRIPLE), (0, 3), (1, 4), (2, 5)],
    "pyramid": [*RING, (0, 4), (1, 4), (2, 4), (3, 4)],
}
HEX_FACES = [(0, 3, 4, 7), (1, 2, 5, 6), (0, 1, 4, 5), (2, 3, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]
MIDDLES = {
    "hexahedron24": HEX_FACES[:4],
    "hexahedron27": [*HEX_FACES, tuple(range(8))],
    "wedge18": [(0, 1, 3, 4), (1, 2, 4, 5), (0, 2, 3, 5)],
    "pyramid14": [(0, 1, 2, 3)],
}
SOLIDS = [
    *("tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron24", "hexahedron27"),
    *("wedge", "wedge15", "wedge18", "pyramid", "pyramid13", "pyramid14"),
]


def family(kind):
    return kind.rstrip("0123456789")


def node_groups(kind):
    """The corners whose mean each node of the undistorted cell is."""
    base = family(kind)
    corners = [(i,) for i in range(len(CORNERS[base]))]
    return corners if kind == base else [*corners, *EDGES[base], *MIDDLES.get(kind, [])]


def elevated(kind, corners):
    """Nodes of a cell of this kind with these corners and with straight edges, (n, 3)."""
    return np.array([np.mean([corners[i] for i in group], axis=0) for group in node_groups(kind)])


def reference(kind):
    return elevated(kind, np.array(CORNERS[family(kind)], float))


def quadratic(r, r0):
    """The function of r in {-1, 0, 1} that is 1 at r0."""
    return r * (r + r0) / 2 if r0 else 1 - r * r


def serendipity(r, nodes):
    for r0 in nodes:
        zero = [i for i in range(3) if r0[i] == 0]
        factors = math.prod(1 + x * x0 for x, x0 in zip(r, r0, strict=True) if x0)
        if zero:
            yield factors * (1 - r[zero[0]] ** 2) / 4
        else:
            yield factors * (sum(x * x0 for x, x0 in zip(r, r0, strict=True)) - 2) / 8


def shape_functions(kind, a, b, c):
    """The textbook's shape functions at a point of the unit cube, and collapsed where the cell is no box."""
    base = family(kind)
    if base == "hexahedron":
        r = (2 * a - 1, 2 * b - 1, 2 * c - 1)
        nodes = [tuple(int(x) for x in node) for node in reference(kind)]
        if kind == "hexahedron":
            return [math.prod(1 + x * x0 for x, x0 in zip(r, r0, strict=True)) / 8 for r0 in nodes]
        if kind == "hexahedron27":
            return [math.prod(quadratic(x, x0) for x, x0 in zip(r, r0, strict=True)) for r0 in nodes]
        values = list(serendipity(r, nodes[:20]))
        if kind == "hexahedron24":
            x, y, z = r
            sides = [(1 + s * x) * (1 - y * y) * (1 - z * z) / 2 for s in (-1, 1)]
            sides += [(1 + s * y) * (1 - x * x) * (1 - z * z) / 2 for s in (-1, 1)]
            for node in nodes[20:]:
                at_middle = serendipity(tuple(Fraction(x) for x in node), nodes[:20])
                side = sides[nodes.index(node) - 20]
                values = [v - w * side for v, w in zip(values, at_middle, strict=True)]
            values += sides
        return values
    if base in ("tetra", "wedge"):
        r, s = a * (1 - b), b
        if base == "tetra":
            r, s, t = r * (1 - c), s * (1 - c), c
            l = (1 - r - s - t, r, s, t)
            if kind == "tetra":
                return list(l)
            return [x * (2 * x - 1) for x in l] + [4 * l[i] * l[j] for i, j in EDGES["tetra"]]
        l, t = (1 - r - s, r, s), 2 * c - 1
        if kind == "wedge":
            return [x * (1 + end * t) / 2 for end in (-1, 1) for x in l]
        if kind == "wedge15":
            corners = [(x * (2 * x - 1) * (1 + e * t) - x * (1 - t * t)) / 2 for e in (-1, 1) for x in l]
            across = [2 * l[i] * l[j] * (1 + e * t) for e in (-1, 1) for i, j in TRIPLE]
            return corners + across + [x * (1 - t * t) for x in l]
        six = [x * (2 * x - 1) for x in l] + [4 * l[i] * l[j] for i, j in TRIPLE]
        low, middle, high = (quadratic(t, t0) for t0 in (-1, 0, 1))
        corners = [x * end for end in (low, high) for x in six[:3]]
        across = [x * end for end in (low, high) for x in six[3:]]
        return corners + across + [x * middle for x in six]
    # Bedrosian 1992, with x = ξ w, y = η w, z = 1 − w.
    xi, eta, w = 2 * a - 1, 2 * b - 1, 1 - c
    if kind == "pyramid":
        return [w * (1 + i * xi) * (1 + j * eta) / 4 for i, j in SQUARE] + [1 - w]
    bubble = w * w * (1 - xi * xi) * (1 - eta * eta) if kind == "pyramid14" else 0
    corners = [w * (1 + i * xi) * (1 + j * eta) * (w * (i * xi + j * eta) - 1) / 4 + bubble / 4 for i, j in SQUARE]
    base_edges = [
        w * w * (1 - xi * xi) * (1 - eta) / 2,
        w * w * (1 - eta * eta) * (1 + xi) / 2,
        w * w * (1 - xi * xi) * (1 + eta) / 2,
        w * w * (1 - eta * eta) * (1 - xi) / 2,
    ]
    slanted = [w * (1 - w) * (1 + i * xi) * (1 + j * eta) for i, j in SQUARE]
    values = [*corners, (1 - w) * (1 - 2 * w), *(n - bubble / 2 for n in base_edges), *slanted]
    return [*values, bubble] if kind == "pyramid14" else values


def newton_cotes(count):
    """Exact weights of the equidistant rule on [0, 1], by integrating Lagrange's polynomials."""
    nodes = [Fraction(i, count - 1) for i in range(count)]
    weights = []
    for i in range(count):
        polynomial = [Fraction(1)]
        for j in range(count):
            if j != i:
                scale = nodes[i] - nodes[j]
                shifted = [Fraction(0), *polynomial]
                polynomial = [
                    (s - nodes[j] * p) / scale for s, p in zip(shifted, [*polynomial, Fraction(0)], strict=True)
                ]
        weights.append(sum(c / (k + 1) for k, c in enumerate(polynomial)))
    return nodes, weights


def whole(values, scale):
    """The values times `scale`, as Python's integers, which are fast and exact."""
    scaled = np.array([Fraction(v) * scale for v in np.ravel(values)], dtype=object).reshape(np.shape(values))
    assert all(v.denominator == 1 for v in scaled.flat)
    return np.array([int(v) for v in scaled.flat], dtype=object).reshape(scaled.shape)


NODES, WEIGHTS = newton_cotes(10)
VALUES = whole([[(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)] for t in NODES], 81)
SLOPES = whole([[4 * t - 3, 4 - 8 * t, 4 * t - 1] for t in NODES], 9)
COMMON = math.lcm(*(w.denominator for w in WEIGHTS))
CUBE_WEIGHTS = whole([a * b * c for a, b, c in itertools.product(WEIGHTS, repeat=3)], COMMON**3)
FINE, TINY = 2**10, 2**80


def exact_moments(kind, nodes):
    """∫1, ∫x, ∫x xᵀ about the file's origin, in rationals.

    Over the unit cube every map here is quadratic in each coordinate, so its values at 3 × 3 × 3 points give
    the map and its slopes everywhere; det J x xᵀ has a degree of at most 9, for which ten equidistant points
    are exact.
    """
    third = (Fraction(0), Fraction(1, 2), Fraction(1))
    shapes = whole([shape_functions(kind, *t) for t in itertools.product(third, repeat=3)], FINE)
    lattice = (shapes @ whole(nodes.tolist(), TINY)).reshape(3, 3, 3, 3)

    def spread(first, second, third):
        values = np.tensordot(first, lattice, axes=(1, 0))
        values = np.tensordot(second, values, axes=(1, 1))
        values = np.tensordot(third, values, axes=(1, 2))
        return values.transpose(2, 1, 0, 3).reshape(-1, 3).T

    x = spread(VALUES, VALUES, VALUES)
    u, v, w = (spread(*(SLOPES if axis == d else VALUES for axis in range(3))) for d in range(3))
    det = u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    mass = CUBE_WEIGHTS * det
    if mass.sum() < 0:
        mass = -mass
    unit, place = COMMON**3 * (FINE * TINY * 9**5) ** 3, FINE * TINY * 9**6
    return Moments(
        ORIGIN,
        Fraction(mass.sum(), unit),
        tuple(Fraction((mass * x[i]).sum(), unit * place) for i in range(3)),
        tuple(Fraction((mass * x[i] * x[j]).sum(), unit * place**2) for i, j in PAIRS),
    )


def one_kind(kind, *cells):
    """A mesh of unconnected cells, each given by its nodes."""
    nodes = np.arange(sum(map(len, cells))).reshape(len(cells), -1)
    return Cells(np.concatenate(cells), (CellBlock(kind, nodes),))
