"""Moments of volume cells, wires and points, against exact rational integration and closed forms."""

import itertools
import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mass.cells.textbook_cells import (
    CORNERS,
    ORIGIN,
    SOLIDS,
    elevated,
    exact_moments,
    family,
    one_kind,
    reference,
)

from inertia.errors import GeometryError, UsageError
from inertia.mass.cells.moments import boundary_area, cell_moments, wire_moments
from inertia.mass.moments import PAIRS, Moments
from inertia.mesh.part import CellBlock, Cells


def distorted(kind, seed, amount=0.08):
    nodes = reference(kind)
    return nodes + np.random.default_rng(seed).uniform(-amount, amount, nodes.shape)


def assert_within_bounds(moments, exact, tight=1e-10):
    """Every moment is within its bound of the exact one, and the bound is small against the moments' size."""
    expected = exact.about(moments.origin)
    assert abs(moments.zeroth - expected.zeroth) <= moments.zeroth_bound <= tight * expected.zeroth
    for i in range(3):
        assert abs(moments.first[i] - expected.first[i]) <= moments.first_bound[i]
    for k in range(6):
        assert abs(moments.second[k] - expected.second[k]) <= moments.second_bound[k]
    size = sum(expected.second[:3])
    assert max(moments.second_bound) <= tight * size
    # What is stated as a bound is no guess: the actual error is rounding alone.
    assert max(abs(a - b) for a, b in zip(moments.second, expected.second, strict=True)) <= 1e-14 * size


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
        integral = cell_moments(one_kind(kind, cell)).moments[0]
        expected = exact_moments(kind, cell).about(integral.origin)
        assert abs(integral.zeroth - expected.zeroth) <= integral.zeroth_bound <= 1e-5 * expected.zeroth
        for k in range(6):
            assert abs(integral.second[k] - expected.second[k]) <= integral.second_bound[k]


@pytest.mark.parametrize("kind", SOLIDS)
def test_double_double_has_twice_the_digits_and_its_bounds_hold(kind):
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    for thinness, far in ((1.0, 0.0), (1e-3, 10.0), (1e-6, 1e6)):
        cells = [distorted(kind, seed) * [1.0, 1.0, thinness] @ turn + far for seed in range(3)]
        cells[1] = cells[1] + 3.0
        exact = exact_moments(kind, cells[0]) + exact_moments(kind, cells[1]) + exact_moments(kind, cells[2])
        integral = cell_moments(one_kind(kind, *cells), arithmetic="double-double").moments[0]
        wanted = exact.about(integral.origin)
        assert abs(integral.zeroth - wanted.zeroth) <= integral.zeroth_bound <= 1e-19 * wanted.zeroth
        for k in range(3):
            assert abs(integral.first[k] - wanted.first[k]) <= integral.first_bound[k]
        for k in range(6):
            assert abs(integral.second[k] - wanted.second[k]) <= integral.second_bound[k]
        assert max(integral.second_bound) <= 1e-18 * sum(wanted.second[:3])


def test_double_double_keeps_groups_and_turned_cells_apart():
    cell = distorted("wedge", 1)
    mirrored = cell[[3, 4, 5, 0, 1, 2]]
    cells = one_kind("wedge", cell, mirrored, cell + 2)
    result = cell_moments(cells, np.array([0, 1, 1], np.int32), 2, arithmetic="double-double")
    assert result.reversed == 1
    one = exact_moments("wedge", cell)
    for moments, wanted in zip(result.moments, (one, one + exact_moments("wedge", cell + 2)), strict=True):
        assert abs(moments.zeroth - wanted.zeroth) <= moments.zeroth_bound <= 1e-25


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
    integral = cell_moments(one_kind(kind, reference(kind) @ matrix.T + shift)).moments[0]
    determinant = round(np.linalg.det(matrix))
    second = np.empty((3, 3), object)
    for (i, j), value in zip(PAIRS, central, strict=True):
        second[i, j] = second[j, i] = Fraction(value)
    second = determinant * (matrix.astype(object) @ second @ matrix.T.astype(object))
    middle = matrix.astype(object) @ np.array([Fraction(x) for x in centroid], object) + shift
    exact = Moments(tuple(middle), volume * Fraction(determinant), ORIGIN, tuple(second[i, j] for i, j in PAIRS))
    assert_within_bounds(integral, exact)


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
    moments = result.moments[0].about(ORIGIN)
    assert result.reversed == (d < 0)
    assert abs(moments.zeroth - abs(d) / 6) <= moments.zeroth_bound
    for i in range(3):
        assert abs(moments.first[i] - abs(d) * sums[i] / 24) <= moments.first_bound[i]
    for k, (i, j) in enumerate(PAIRS):
        second = abs(d) / 120 * (sums[i] * sums[j] + sum(p[i] * p[j] for p in exact))
        assert abs(moments.second[k] - second) <= moments.second_bound[k]


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
        moments = cell_moments(cells).moments[0].about(ORIGIN)
        exact = OCTANT[0] * (1 - cut**3), OCTANT[1] * (1 - cut**5)
        errors.append([abs(float(moments.zeroth) - exact[0]), abs(float(moments.second[0]) - exact[1])])
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
    fractions = []
    cell_moments(block("hexahedron", 12), progress=fractions.append)
    assert fractions == sorted(fractions)
    assert len(fractions) > 1
    assert fractions[-1] == 1.0


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


def test_straight_wires_in_double_double_have_twice_the_digits():
    corners = np.random.default_rng(5).uniform(-1, 1, (9, 3)) + 1e3
    wires = Cells(corners, (CellBlock("line", np.stack([np.arange(8), np.arange(1, 9)], axis=1)),))
    (moments,) = wire_moments(wires, arithmetic="double-double")
    moments = moments.about(ORIGIN)
    with mpmath.workdps(60):
        ends = [[mpmath.mpf(x) for x in corner] for corner in corners.tolist()]
        pairs = list(itertools.pairwise(ends))
        lengths = [mpmath.sqrt(sum((x - y) ** 2 for x, y in zip(a, b, strict=True))) for a, b in pairs]

        def off(value, true):
            return abs(mpmath.mpf(value.numerator) / value.denominator - true)

        assert off(moments.zeroth, sum(lengths)) <= moments.zeroth_bound <= 1e-25
        for k, (i, j) in enumerate(PAIRS):
            products = (
                size * ((a[i] + b[i]) * (a[j] + b[j]) + a[i] * a[j] + b[i] * b[j]) / 6
                for size, (a, b) in zip(lengths, pairs, strict=True)
            )
            assert off(moments.second[k], sum(products)) <= moments.second_bound[k] <= 1e-18


def test_straight_wires_have_exact_moments():
    corners = np.array([[0, 0, 0], [3, 4, 0], [3, 4, 12]]) + np.array([1e6, 0.0, 0.0])
    wires = Cells(corners, (CellBlock("line", np.array([[0, 1], [1, 2]])),))
    (moments,) = wire_moments(wires)
    assert float(moments.zeroth) == 17.0
    assert moments.zeroth_bound < 3e-13
    first = (Fraction(5) * Fraction(3, 2) + Fraction(12) * 3 + 17 * 10**6, Fraction(58), Fraction(72))
    about = moments.about(ORIGIN)
    for i in range(3):
        assert abs(about.first[i] - first[i]) <= about.first_bound[i]
    central = moments.about((Fraction(10**6), Fraction(0), Fraction(0)))
    expected = (5 * Fraction(9, 3) + 12 * 9, 5 * Fraction(16, 3) + 12 * 16, 12 * Fraction(144, 3))
    for k in range(3):
        assert abs(central.second[k] - expected[k]) <= central.second_bound[k] <= 1e-12 * expected[k]


def test_a_parabola_has_its_arc_length():
    points = np.array([[-1, 1, 0], [1, 1, 0], [0, 0, 0]], float)
    (moments,) = wire_moments(Cells(points, (CellBlock("line3", np.array([[0, 1, 2]])),)))
    exact = math.sqrt(5) + math.asinh(2) / 2
    assert abs(float(moments.zeroth) - exact) <= float(moments.zeroth_bound) + 1e-15
    assert float(moments.zeroth_bound) < 1e-4
    # ∫ y ds = ∫ x² √(1 + 4x²) dx over [-1, 1]
    height = (18 * math.sqrt(5) - math.asinh(2)) / 32
    about = moments.about(ORIGIN)
    assert abs(float(about.first[1]) - height) <= float(about.first_bound[1]) + 1e-15


def test_quadratic_arcs_converge_to_the_circle():
    errors = []
    for n in (8, 16, 32):
        angle = 2 * math.pi * np.arange(2 * n) / (2 * n)
        points = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        start = 2 * np.arange(n)
        nodes = np.stack([start, (start + 2) % (2 * n), start + 1], axis=1)
        (moments,) = wire_moments(Cells(points, (CellBlock("line3", nodes),)))
        errors.append([abs(float(moments.zeroth) - 2 * math.pi), abs(float(moments.second[0]) - math.pi)])
    assert np.log2(np.array(errors)[:-1] / np.array(errors)[1:]).min() > 3.5
