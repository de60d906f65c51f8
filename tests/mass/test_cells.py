"""Moments of volume cells, wires and points, against exact rational integration and closed forms."""

import itertools
import math
from decimal import localcontext
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.errors import GeometryError, UsageError
from inertia.mass.cell_tables import gauss, table
from inertia.mass.cells import boundary_area, cell_moments, point_moments, wire_moments
from inertia.mass.moments import PAIRS, Moments
from inertia.mass.shapes import KINDS
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


def distorted(kind, seed, amount=0.08):
    nodes = reference(kind)
    return nodes + np.random.default_rng(seed).uniform(-amount, amount, nodes.shape)


def assert_within_bounds(found, exact, tight=1e-10):
    """Every moment is within its bound of the exact one, and the bound is small against the moments' size."""
    wanted = exact.about(found.origin)
    assert abs(found.zeroth - wanted.zeroth) <= found.zeroth_bound <= tight * wanted.zeroth
    for i in range(3):
        assert abs(found.first[i] - wanted.first[i]) <= found.first_bound[i]
    for k in range(6):
        assert abs(found.second[k] - wanted.second[k]) <= found.second_bound[k]
    size = sum(wanted.second[:3])
    assert max(found.second_bound) <= tight * size
    # What is stated as a bound is no guess: the actual error is rounding alone.
    assert max(abs(a - b) for a, b in zip(found.second, wanted.second, strict=True)) <= 1e-14 * size


@pytest.mark.parametrize("kind", SOLIDS)
def test_moments_equal_rational_integration_of_the_textbook_map(kind):
    cells = [distorted(kind, seed) * [1.5, 0.7, 1.1] + [0.3, -0.2, 5.0] for seed in range(2)]
    exact = exact_moments(kind, cells[0]) + exact_moments(kind, cells[1])
    result = cell_moments(one_kind(kind, *cells))
    assert result.reversed == 0
    assert_within_bounds(result.moments[0], exact)


@pytest.mark.parametrize("kind", SOLIDS)
def test_bounds_hold_for_thin_cells_at_an_angle(kind):
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    for thinness in (1e-3, 1e-6):
        cell = distorted(kind, 2) * [1.0, 1.0, thinness] @ turn
        found = cell_moments(one_kind(kind, cell)).moments[0]
        wanted = exact_moments(kind, cell).about(found.origin)
        assert abs(found.zeroth - wanted.zeroth) <= found.zeroth_bound <= 1e-5 * wanted.zeroth
        for k in range(6):
            assert abs(found.second[k] - wanted.second[k]) <= found.second_bound[k]


# Volume, centroid and central ∫x xᵀ of the undistorted cells, from textbooks.
CLOSED = {
    "hexahedron": (8, (0, 0, 0), (Fraction(8, 3),) * 3 + (0, 0, 0)),
    "tetra": (
        Fraction(1, 6),
        (Fraction(1, 4),) * 3,
        (Fraction(1, 160),) * 3 + (Fraction(-1, 480),) * 3,
    ),
    "wedge": (
        1,
        (Fraction(1, 3), Fraction(1, 3), 0),
        (Fraction(1, 18), Fraction(1, 18), Fraction(1, 3), 0, 0, Fraction(-1, 36)),
    ),
    "pyramid": (
        Fraction(4, 3),
        (0, 0, Fraction(1, 4)),
        (Fraction(4, 15), Fraction(4, 15), Fraction(1, 20), 0, 0, 0),
    ),
}


@pytest.mark.parametrize("kind", SOLIDS)
def test_an_affine_cell_has_the_closed_form_of_its_shape(kind):
    volume, centroid, central = CLOSED[family(kind)]
    matrix = np.array([[3, 1, -1], [0, 2, 1], [1, -1, 4]])
    shift = np.array([5, -7, 2])
    found = cell_moments(one_kind(kind, reference(kind) @ matrix.T + shift)).moments[0]
    determinant = round(np.linalg.det(matrix))
    second = np.empty((3, 3), object)
    for (i, j), value in zip(PAIRS, central, strict=True):
        second[i, j] = second[j, i] = Fraction(value)
    second = determinant * (matrix.astype(object) @ second @ matrix.T.astype(object))
    middle = matrix.astype(object) @ np.array([Fraction(x) for x in centroid], object) + shift
    exact = Moments(tuple(middle), volume * Fraction(determinant), ORIGIN, tuple(second[i, j] for i, j in PAIRS))
    assert_within_bounds(found, exact)


# Meshes of a block

SIZE = np.array([2.0, 3.0, 5.0])
SPLITS = {  # of a box into cells; corner 8 is its middle
    "hexahedron": [tuple(range(8))],
    "tetra": [(0, a, b, 6) for a, b in ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1))],
    "wedge": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "pyramid": [
        *((0, 1, 2, 3, 8), (7, 6, 5, 4, 8), (4, 5, 1, 0, 8)),
        *((1, 5, 6, 2, 8), (2, 6, 7, 3, 8), (0, 3, 7, 4, 8)),
    ],
}


def block(kind, per_side=2):
    """The block [0, 2] × [0, 3] × [0, 5] in cells of one kind, with nodes in common and straight edges."""
    parts = []
    for place in itertools.product(range(per_side), repeat=3):
        box = (np.array(place) + (np.array([*CORNERS["hexahedron"], (0, 0, 0)]) + 1) / 2) / per_side * SIZE
        for split in SPLITS[family(kind)]:
            parts.append(elevated(kind, box[list(split)]))
    points, index = np.unique(np.concatenate(parts), axis=0, return_inverse=True)
    return Cells(points, (CellBlock(kind, index.reshape(len(parts), -1)),))


def block_moments():
    volume = math.prod(map(int, SIZE))
    a, b, c = (Fraction(int(x)) for x in SIZE)
    second = (volume * a * a / 12, volume * b * b / 12, volume * c * c / 12, *ORIGIN)
    return Moments((a / 2, b / 2, c / 2), Fraction(volume), ORIGIN, second)


@pytest.mark.parametrize("kind", SOLIDS)
def test_a_block_has_its_own_moments_and_area_in_any_kind_of_cell(kind):
    cells = block(kind)
    assert_within_bounds(cell_moments(cells).moments[0], block_moments())
    assert boundary_area(cells) == pytest.approx(2 * (6 + 10 + 15), rel=1e-13)


def test_a_mesh_of_several_kinds_adds_up():
    half = block("hexahedron20")
    other = block("tetra10")
    points = np.concatenate([half.points, other.points + np.array([2.0, 0.0, 0.0])])
    blocks = (half.blocks[0], CellBlock("tetra10", other.blocks[0].nodes + len(half.points)))
    exact = block_moments()
    moved = Moments((exact.origin[0] + 2, *exact.origin[1:]), exact.zeroth, exact.first, exact.second)
    assert_within_bounds(cell_moments(Cells(points, blocks)).moments[0], exact + moved)


def test_groups_are_integrated_one_by_one():
    cells = block("hexahedron", 8)
    group = np.arange(cells.count, dtype=np.int32) * 7 % 3
    result = cell_moments(cells, group, 4)
    for number in range(3):
        part = Cells(cells.points, (CellBlock("hexahedron", cells.blocks[0].nodes[group == number]),))
        alone = cell_moments(part).moments[0].about(ORIGIN)
        among = result.moments[number].about(ORIGIN)
        assert abs(alone.second[0] - among.second[0]) <= alone.second_bound[0] + among.second_bound[0]
        assert among.zeroth == pytest.approx(30 * np.count_nonzero(group == number) / 512, rel=1e-14)
    assert result.moments[3].zeroth == 0
    first, *others = result.moments
    assert_within_bounds(sum(others, first), block_moments())


@pytest.mark.parametrize("kind", ["tetra", "hexahedron", "pyramid13"])
def test_digits_do_not_depend_on_the_distance_from_the_origin(kind):
    nodes = np.round(distorted(kind, 4) * 2**20) / 2**20
    near = cell_moments(one_kind(kind, nodes)).moments[0].central()
    far = cell_moments(one_kind(kind, nodes + np.array([2.0**22, -(2.0**23), 2.0**22]))).moments[0].central()
    for k in range(6):
        assert abs(near.second[k] - far.second[k]) <= near.second_bound[k] + far.second_bound[k]
    assert max(far.second_bound) <= 1e-11 * sum(far.second[:3])


@pytest.mark.parametrize("exponent", [-400, -100, 100, 300])
def test_a_power_of_two_in_size_changes_no_digit(exponent):
    nodes = distorted("wedge15", 5)
    unit = Fraction(2) ** exponent
    plain = cell_moments(one_kind("wedge15", nodes)).moments[0]
    scaled = cell_moments(one_kind("wedge15", nodes * 2.0**exponent)).moments[0]
    assert scaled.zeroth == plain.zeroth * unit**3
    assert scaled.second == tuple(s * unit**5 for s in plain.second)


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_sizes_far_from_one_are_as_exact(scale):
    nodes = distorted("hexahedron", 6) * scale
    exact = exact_moments_of_scaled("hexahedron", nodes, scale)
    assert_within_bounds(cell_moments(one_kind("hexahedron", nodes)).moments[0], exact)


def exact_moments_of_scaled(kind, nodes, scale):
    power = 2.0 ** -round(math.log2(scale))
    unit = 1 / Fraction(power)
    exact = exact_moments(kind, nodes * power)
    return exact.in_unit(unit).scaled(unit**3)


coordinate = st.floats(-1e3, 1e3, allow_subnormal=False).map(lambda x: x if abs(x) > 1e-30 else 0.0)


@settings(deadline=None, max_examples=300)
@given(st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=4, max_size=4))
def test_any_tetrahedron_is_within_its_bound_or_refused(corners):
    places = np.array(corners)
    exact = [[Fraction(x) for x in corner] for corner in corners]
    a, b, c = ([x - o for x, o in zip(p, exact[0], strict=True)] for p in exact[1:])
    d = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    sums = [sum(p[i] for p in exact) for i in range(3)]
    try:
        result = cell_moments(one_kind("tetra", places))
    except GeometryError:
        box = np.ptp(places, axis=0)
        assert abs(d) <= Fraction(1e-13) * math.prod(Fraction(float(k)) for k in box)
        return
    found = result.moments[0].about(ORIGIN)
    assert result.reversed == (d < 0)
    assert abs(found.zeroth - abs(d) / 6) <= found.zeroth_bound
    for i in range(3):
        assert abs(found.first[i] - abs(d) * sums[i] / 24) <= found.first_bound[i]
    for k, (i, j) in enumerate(PAIRS):
        second = abs(d) / 120 * (sums[i] * sums[j] + sum(p[i] * p[j] for p in exact))
        assert abs(found.second[k] - second) <= found.second_bound[k]


# Curved cells

OCTANT = math.pi / 6, math.pi / 30
"""Volume and ∫x² of an eighth of the unit ball."""


def octant_of_tetra10(n):
    """An eighth of the unit ball in tetra10: the simplex in n³ parts, |x|₁ = r taken to |x|₂ = r."""
    cells = []
    # Kuhn's tetrahedra of the boxes within 1 ≥ u ≥ v ≥ w ≥ 0, the simplex of (u − v, v − w, w).
    for place, way in itertools.product(itertools.product(range(n), repeat=3), itertools.permutations(range(3))):
        u, v, w = np.array([np.add(place, [way[axis] < step for axis in range(3)]) for step in range(4)]).T / n
        if (u >= v).all() and (v >= w).all():
            cells.append(elevated("tetra10", np.stack([u - v, v - w, w], axis=1)))
    nodes = np.array(cells)
    one, two = nodes.sum(axis=2, keepdims=True), np.linalg.norm(nodes, axis=2, keepdims=True)
    return nodes * np.divide(one, two, out=np.ones_like(one), where=two > 0)


def octant_of_hexahedron20(n):
    """An eighth of the ball of radius 1 without that of radius ½, in hexahedron20."""
    cells = []
    for place in itertools.product(range(n), repeat=3):
        a, b, r = ((np.array(place) + (reference("hexahedron20") + 1) / 2) / n).T
        direction = np.stack([np.ones_like(a), a, b], axis=1)
        nodes = direction / np.linalg.norm(direction, axis=1, keepdims=True) * (1 + r[:, None]) / 2
        cells += [np.roll(nodes, k, axis=1) for k in range(3)]
    return np.array(cells)


@pytest.mark.parametrize(
    ("kind", "mesh", "cut"),
    [("tetra10", octant_of_tetra10, 0.0), ("hexahedron20", octant_of_hexahedron20, 0.5)],
)
def test_curved_cells_converge_with_the_fourth_power_of_their_size(kind, mesh, cut):
    errors, areas = [], []
    for n in (2, 4, 8):
        cells = one_kind(kind, *mesh(n))
        found = cell_moments(cells).moments[0].about(ORIGIN)
        exact = OCTANT[0] * (1 - cut**3), OCTANT[1] * (1 - cut**5)
        errors.append([abs(float(found.zeroth) - exact[0]), abs(float(found.second[0]) - exact[1])])
        areas.append(abs(boundary_area(cells) - math.pi / 2 * (1 + cut**2) - 3 * math.pi / 4 * (1 - cut**2)))
    slopes = np.log2(np.array(errors)[:-1] / np.array(errors)[1:])
    assert slopes[-1].min() > 3.5
    assert np.log2(areas[1] / areas[2]) > 3.5
    assert errors[-1][0] < 1e-4


# Orientation and defects


@pytest.mark.parametrize("kind", SOLIDS)
def test_cells_of_reversed_orientation_count_positive(kind):
    nodes = distorted(kind, 7)
    plain = cell_moments(one_kind(kind, nodes)).moments[0]
    mirrored = cell_moments(one_kind(kind, nodes * [1.0, 1.0, -1.0], nodes * [1.0, 1.0, -1.0], nodes))
    assert mirrored.reversed == 2
    assert mirrored.moments[0].zeroth == pytest.approx(float(3 * plain.zeroth), rel=1e-14)


def test_a_wedge_in_the_order_of_vtk_s_documents_is_the_same_body():
    nodes = distorted("wedge", 8)
    result = cell_moments(one_kind("wedge", nodes[[0, 2, 1, 3, 5, 4]]))
    assert result.reversed == 1
    assert_within_bounds(result.moments[0], exact_moments("wedge", nodes))


@pytest.mark.parametrize(
    ("kind", "nodes"),
    [
        ("hexahedron", reference("hexahedron")[[0, 1, 3, 2, 4, 5, 6, 7]]),
        ("wedge", reference("wedge")[[0, 1, 2, 4, 3, 5]]),
        ("pyramid", reference("pyramid")[[0, 2, 1, 3, 4]]),
        ("hexahedron20", reference("hexahedron20")[[*range(12), *range(16, 20), *range(12, 16)]]),
    ],
)
def test_a_tangled_cell_is_refused_by_number_and_nodes(kind, nodes):
    last = len(nodes) - 1
    with pytest.raises(GeometryError, match=rf"^cell 1 \({kind}, nodes {last + 1} .* {2 * last + 1}\) is tangled"):
        cell_moments(one_kind(kind, reference(kind), nodes, nodes))


def test_a_fold_at_a_corner_alone_is_found():
    nodes = reference("tetra10")
    nodes[4] = [0.2, 0.0, 0.0]  # beyond a quarter of its edge the quadratic map folds back at corner 0
    with pytest.raises(GeometryError, match=r"^cell 0 .* is tangled"):
        cell_moments(one_kind("tetra10", nodes))
    nodes[4] = [0.3, 0.0, 0.0]
    assert cell_moments(one_kind("tetra10", nodes)).reversed == 0


def test_a_flat_cell_is_refused():
    flat = np.array([[0, 0, 0.1], [1, 0, 0.1], [0, 1, 0.1], [1, 1, 0.1]])
    with pytest.raises(GeometryError, match=r"^cell 1 \(tetra, nodes 4 5 6 7\) has no volume"):
        cell_moments(one_kind("tetra", reference("tetra"), flat))
    turned = flat @ np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
    with pytest.raises(GeometryError, match="has no volume"):
        cell_moments(one_kind("tetra", turned))


def test_a_hexahedron_collapsed_to_a_wedge_is_that_wedge():
    nodes = distorted("wedge", 10)
    collapsed = Cells(nodes, (CellBlock("hexahedron", np.array([[0, 1, 2, 2, 3, 4, 5, 5]])),))
    assert_within_bounds(cell_moments(collapsed).moments[0], exact_moments("wedge", nodes))
    wedge = Cells(nodes, (CellBlock("wedge", np.arange(6)[None]),))
    assert boundary_area(collapsed) == pytest.approx(boundary_area(wedge), rel=1e-13)


def test_lines_and_points_among_solids_have_no_volume():
    cells = block("tetra")
    mixed = Cells(
        cells.points,
        (CellBlock("line", np.array([[0, 1]])), *cells.blocks, CellBlock("vertex", np.array([[0]]))),
    )
    groups = np.array([1, *[0] * cells.count, 1], np.int32)
    result = cell_moments(mixed, groups, 2)
    assert result.moments[0] == cell_moments(cells).moments[0]
    assert result.moments[1].zeroth == 0
    assert boundary_area(mixed) == boundary_area(cells)


def test_what_cannot_be_integrated_is_named():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, np.nan, 1]])
    with pytest.raises(GeometryError, match=r"node 3 has the coordinates \(0.0, nan, 1.0\)"):
        cell_moments(Cells(points, (CellBlock("tetra", np.array([[0, 1, 2, 3]])),)))
    with pytest.raises(GeometryError, match=r"cell 0 \(tetra\) names node 4"):
        cell_moments(Cells(points, (CellBlock("tetra", np.array([[0, 1, 2, 4]])),)))
    with pytest.raises(GeometryError, match="cell 0 is of the kind 'tetra20'"):
        cell_moments(Cells(points, (CellBlock("tetra20", np.zeros((1, 20), np.int64)),)))
    with pytest.raises(GeometryError, match="'line4'"):
        wire_moments(Cells(points, (CellBlock("line4", np.zeros((1, 4), np.int64)),)))
    with pytest.raises(GeometryError, match="larger than float64"):
        cell_moments(one_kind("tetra", np.where(reference("tetra") > 0, 1.5e308, -1.5e308)))
    cells = block("tetra")
    with pytest.raises(UsageError, match="one entry for each of the 48 cells"):
        cell_moments(cells, np.zeros(3, np.int32))
    with pytest.raises(UsageError, match="groups must be 0 to 0, not 0 to 1"):
        cell_moments(cells, np.arange(48, dtype=np.int32) % 2)


def test_nodes_that_no_cell_uses_do_not_matter():
    cells = block("hexahedron")
    more = Cells(np.concatenate([cells.points, [[1e300, np.inf, 0.0]]]), cells.blocks)
    assert cell_moments(more).moments == cell_moments(cells).moments


def test_progress_ends_at_one():
    seen = []
    cell_moments(block("hexahedron", 12), progress=seen.append)
    assert seen == sorted(seen)
    assert len(seen) > 1
    assert seen[-1] == 1.0


# Faces


def test_nodes_with_equal_coordinates_are_one_at_a_face():
    box = reference("hexahedron")
    cells = one_kind("hexahedron", box, box + np.array([2.0, 0.0, 0.0]))
    assert boundary_area(cells) == pytest.approx(40.0, rel=1e-14)


def test_a_cylinder_of_wedge18_has_its_area():
    """Quadratic arcs of 1/64 turn differ from the circle by some 1e-9."""
    n = 64

    def place(angle, radius, z):
        return [radius * math.cos(angle), radius * math.sin(angle), z]

    cells = []
    for k in range(n):
        angles = 2 * math.pi * k / n, 2 * math.pi * ((k + 1) % n) / n
        between = 2 * math.pi * (k + 0.5) / n
        ring = [(0, 0), (angles[0], 1), (angles[1], 1), (angles[0], 0.5), (between, 1), (angles[1], 0.5)]
        at = {z: [place(*p, z) for p in ring] for z in (-1.0, 0.0, 1.0)}
        cells.append([*at[-1][:3], *at[1][:3], *at[-1][3:], *at[1][3:], *at[0]])
    cells = one_kind("wedge18", *np.array(cells))
    assert boundary_area(cells) == pytest.approx(6 * math.pi, rel=1e-6)
    assert float(cell_moments(cells).moments[0].zeroth) == pytest.approx(2 * math.pi, rel=1e-6)


# Wires and points


def test_straight_wires_have_exact_moments():
    corners = np.array([[0, 0, 0], [3, 4, 0], [3, 4, 12]]) + np.array([1e6, 0.0, 0.0])
    wires = Cells(corners, (CellBlock("line", np.array([[0, 1], [1, 2]])),))
    found = wire_moments(wires)
    assert float(found.zeroth) == 17.0
    assert found.zeroth_bound < 3e-13
    first = (Fraction(5) * Fraction(3, 2) + Fraction(12) * 3 + 17 * 10**6, Fraction(58), Fraction(72))
    about = found.about(ORIGIN)
    for i in range(3):
        assert abs(about.first[i] - first[i]) <= about.first_bound[i]
    central = found.about((Fraction(10**6), Fraction(0), Fraction(0)))
    wanted = (5 * Fraction(9, 3) + 12 * 9, 5 * Fraction(16, 3) + 12 * 16, 12 * Fraction(144, 3))
    for k in range(3):
        assert abs(central.second[k] - wanted[k]) <= central.second_bound[k] <= 1e-12 * wanted[k]


def test_a_parabola_has_its_arc_length():
    points = np.array([[-1, 1, 0], [1, 1, 0], [0, 0, 0]], float)
    found = wire_moments(Cells(points, (CellBlock("line3", np.array([[0, 1, 2]])),)))
    exact = math.sqrt(5) + math.asinh(2) / 2
    assert abs(float(found.zeroth) - exact) <= float(found.zeroth_bound) + 1e-15
    assert float(found.zeroth_bound) < 1e-4
    # ∫ y ds = ∫ x² √(1 + 4x²) dx over [-1, 1]
    height = (18 * math.sqrt(5) - math.asinh(2)) / 32
    about = found.about(ORIGIN)
    assert abs(float(about.first[1]) - height) <= float(about.first_bound[1]) + 1e-15


def test_quadratic_arcs_converge_to_the_circle():
    errors = []
    for n in (8, 16, 32):
        angle = 2 * math.pi * np.arange(2 * n) / (2 * n)
        points = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        start = 2 * np.arange(n)
        nodes = np.stack([start, (start + 2) % (2 * n), start + 1], axis=1)
        found = wire_moments(Cells(points, (CellBlock("line3", nodes),)))
        errors.append([abs(float(found.zeroth) - 2 * math.pi), abs(float(found.second[0]) - math.pi)])
    assert np.log2(np.array(errors)[:-1] / np.array(errors)[1:]).min() > 3.5


def test_points_are_counted_where_they_are():
    points = np.array([[1, 0, 0], [9, 9, 9], [3, 0, 4]], float)
    cells = Cells(points, (CellBlock("vertex", np.array([[0], [2]])), CellBlock("line", np.array([[0, 1]]))))
    found = point_moments(cells)
    assert found.zeroth == 2
    assert found.centroid == (2, 0, 2)
    assert found.second == (10, 0, 16, 0, 12, 0)


# Tables


@pytest.mark.parametrize("power", [0, 1, 2])
@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_gauss_rules_integrate_powers(count, power):
    with localcontext(prec=60):
        points, weights = gauss(count, power)
        for degree in range(2 * count):
            total = sum(w * t**degree for t, w in zip(points, weights, strict=True))
            assert abs(Fraction(total) - Fraction(1, degree + power + 1)) < Fraction(1, 10**50)


VTK = {
    "tetra10": "vtkQuadraticTetra",
    "hexahedron": "vtkHexahedron",
    "hexahedron20": "vtkQuadraticHexahedron",
    "hexahedron24": "vtkBiQuadraticQuadraticHexahedron",
    "hexahedron27": "vtkTriQuadraticHexahedron",
    "wedge": "vtkWedge",
    "wedge15": "vtkQuadraticWedge",
    "wedge18": "vtkBiQuadraticQuadraticWedge",
    "pyramid": "vtkPyramid",
    "pyramid13": "vtkQuadraticPyramid",
    "quad8": "vtkQuadraticQuad",
    "quad9": "vtkBiQuadraticQuad",
    "triangle6": "vtkQuadraticTriangle",
    "line3": "vtkQuadraticEdge",
}


@pytest.mark.parametrize("kind", VTK)
def test_nodes_and_shape_functions_are_vtks(kind):
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell = getattr(vtk, VTK[kind])()
    nodes = np.array(cell.GetParametricCoords()).reshape(-1, 3)
    ours = np.array([[float(x) for x in node] for node in KINDS[kind].nodes])
    dimension = ours.shape[1]
    if kind.startswith("pyramid"):
        ours = np.column_stack([(ours[:, :2] + 1) / 2, 1 - ours[:, 2]])
        ours[4] = nodes[4]  # all of ξ and η are the apex
        np.testing.assert_array_equal(ours, nodes)
        return
    box = nodes.shape[0] == len(ours) and KINDS[kind].reference != "simplex"
    flat = [KINDS[kind].reference == "box" or axis == 2 for axis in range(dimension)]
    ours = np.where(np.array(flat) & box, (ours + 1) / 2, ours)
    np.testing.assert_array_equal(ours, nodes[:, :dimension])
    shape = table(kind)
    weights = [0.0] * len(nodes)
    for values in shape.values[:: max(1, len(shape.values) // 7)]:
        cell.InterpolateFunctions((values @ nodes).tolist(), weights)
        np.testing.assert_allclose(values, weights, atol=1e-13)


def test_vtks_own_13_node_pyramid_has_the_same_faces():
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell, weights = vtk.vtkQuadraticPyramid(), [0.0] * 13
    for a, b in itertools.product((Fraction(1, 8), Fraction(2, 3)), repeat=2):
        for place in ((a, b, 0), (a, 0, b), (a, 1, b), (0, a, b), (1, a, b)):
            cell.InterpolateFunctions([float(x) for x in place], weights)
            np.testing.assert_allclose([float(n) for n in shape_functions("pyramid13", *place)], weights, atol=1e-15)
