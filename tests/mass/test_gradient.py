"""Derivatives with respect to vertices: exact interpolation of rational moments, and mpmath where roots are in them."""

from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from tests.mass.cells.textbook_cells import SOLIDS, exact_moments, reference
from tests.mass.parts import cells as cells_of
from tests.mass.parts import facets
from tests.mesh.solids import cube, joined, sphere

import inertia
from inertia.arrays import Float
from inertia.mesh.part import CellBlock, Cells, Part, Regions
from inertia.mesh.surface import Surface
from inertia.units import length_unit
from inertia_meshes import path
from inertia_meshes.rational import Moments, moments

STEP = 0.0625


def dyadic(points: Float, bits: int = 12) -> Float:
    """Return the points rounded so that their coordinates, and these after a step, are short binary fractions."""
    return np.ldexp(np.round(np.ldexp(points, bits)), -bits)


def bumpy(seed: int = 1, splits: int = 1, middle: tuple[float, float, float] = (3, -2, 1)) -> tuple[Float, np.ndarray]:
    vertices, faces = sphere(middle, 2.0, splits)
    rng = np.random.default_rng(seed)
    return dyadic(np.asarray(vertices) + rng.normal(0, 0.1, np.shape(vertices))), np.asarray(faces)


def slope(values: dict[int, Fraction]) -> Fraction:
    """Return the derivative at 0 of the polynomial of degree 4 or less with these values at −2, −1, 1, 2 steps."""
    return (8 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12 * Fraction(STEP))


def flat(m: Moments) -> list[Fraction]:
    return [m.volume, *m.first, *m.second]


def exact_rates(
    moments_of: Callable[[Float], Moments], points: Float, place: tuple[int, int]
) -> dict[str, list[float]]:
    """Return the derivatives by one coordinate, from the rational moments by exact interpolation and quotient rule."""
    samples = {}
    for k in (-2, -1, 1, 2):
        moved = points.copy()
        moved[place] += k * STEP
        samples[k] = flat(moments_of(moved))
    rate = [slope({k: row[i] for k, row in samples.items()}) for i in range(10)]
    v, *rest = flat(moments_of(points))
    first = rest[:3]
    dv, df, ds = rate[0], rate[1:4], rate[4:]
    com = [f / v for f in first]
    dcom = [(f - c * dv) / v for f, c in zip(df, com, strict=True)]
    pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
    dc = {(i, j): s - dcom[i] * first[j] - com[i] * df[j] for s, (i, j) in zip(ds, pairs, strict=True)}
    trace = dc[0, 0] + dc[1, 1] + dc[2, 2]
    tensor = [[(trace if i == j else 0) - (dc.get((i, j)) or dc.get((j, i)) or 0) for j in range(3)] for i in range(3)]
    return {
        "volume": [float(dv)],
        "center_of_mass": [float(k) for k in dcom],
        "inertia": [float(k) for row in tensor for k in row],
    }


def assert_rates(
    gradient: inertia.Gradient, row: int, axis: int, truth: dict[str, list[float]], tolerance: float
) -> None:
    for name, values in truth.items():
        computed = np.ravel(getattr(gradient, name)[row][..., axis])
        scale = np.abs(getattr(gradient, name)).max()
        np.testing.assert_allclose(computed, values, rtol=0, atol=tolerance * scale, err_msg=name)


def test_derivatives_of_a_solid_are_those_of_its_rational_moments() -> None:
    vertices, faces = bumpy()
    gradient = inertia.gradient(Part.from_arrays(vertices, faces), 1.0)
    np.testing.assert_array_equal(gradient.vertices, vertices)
    for row, axis in [(0, 0), (5, 1), (17, 2), (len(vertices) - 1, 0)]:
        truth = exact_rates(lambda points: moments(points[faces]), vertices, (row, axis))
        assert_rates(gradient, row, axis, truth, 1e-14)


def test_corners_of_an_stl_file_in_one_place_move_together() -> None:
    vertices, faces = bumpy()
    corners = vertices[faces].astype(np.float32)
    gradient = inertia.gradient(facets(corners), 7850.0)
    again = gradient.vertices[gradient.rows]
    np.testing.assert_array_equal(again, corners)
    assert len(gradient.vertices) == len(vertices)
    of_surface = inertia.gradient(Part.from_arrays(vertices, faces), 7850.0)
    number = {tuple(v): k for k, v in enumerate(vertices.tolist())}
    order = [number[tuple(v)] for v in gradient.vertices.tolist()]
    np.testing.assert_allclose(gradient.inertia, of_surface.inertia[order], rtol=0, atol=1e-10)


def test_negative_zero_is_the_same_place_as_zero() -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])[[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]]
    corners[0][corners[0] == 0] = -0.0
    assert len(inertia.gradient(facets(corners)).vertices) == 4


def test_derivatives_are_si_whatever_the_unit() -> None:
    vertices, faces = bumpy()
    in_metres = inertia.gradient(Part.from_arrays(vertices, faces, "m"), 2.0)
    in_inches = inertia.gradient(Part.from_arrays(vertices, faces, "in"), 2.0)
    for name, power in (("volume", 2), ("center_of_mass", 0), ("inertia", 4), ("principal_moments", 4)):
        np.testing.assert_allclose(
            getattr(in_inches, name),
            getattr(in_metres, name) * 0.0254**power,
            rtol=1e-11,
            atol=1e-12 * np.abs(getattr(in_inches, name)).max(),
        )


def test_far_from_the_origin_no_digits_are_lost() -> None:
    vertices, faces = bumpy()
    near = inertia.gradient(Part.from_arrays(vertices, faces))
    far = inertia.gradient(Part.from_arrays(vertices + np.array([2.0**38, -(2.0**37), 2.0**36]), faces))
    np.testing.assert_allclose(far.inertia, near.inertia, rtol=0, atol=1e-13 * np.abs(near.inertia).max())


def test_regions_count_with_their_densities_and_share_the_vertices_where_they_touch() -> None:
    mesh = joined(cube((0, 0, 0)), cube((1, 0, 0)))
    names = Regions(("a", "b"), np.repeat(np.arange(2, dtype=np.int32), 12))
    part = Part(mesh, length_unit("m"), "option", regions=names)
    gradient = inertia.gradient(part, {"a": 2.0, "b": 6.0})
    assert len(gradient.vertices) == 12
    row = int(np.flatnonzero((gradient.vertices == [0.5, 0.5, 0.5]).all(axis=1))[0])

    def both(points: Float) -> Moments:
        one, two = (moments(points[mesh.faces[index]]) for index in (slice(12), slice(12, None)))
        return one.weighted(2) + two.weighted(6)

    points = mesh.vertices.copy()
    same = (points == [0.5, 0.5, 0.5]).all(axis=1)
    assert same.sum() == 2

    def moved_together(offset: Float) -> Moments:
        return both(np.where(same[:, None], points + offset[0], points))

    for axis in range(3):
        truth = exact_rates(moved_together, np.zeros((1, 3)), (0, axis))
        truth["mass"] = truth.pop("volume")
        assert_rates(gradient, row, axis, truth, 1e-14)


def test_a_mass_that_was_weighed_stays() -> None:
    vertices, faces = bumpy()
    part = Part.from_arrays(vertices, faces)
    weighed = inertia.gradient(part, mass=3.0)
    assert not weighed.mass.any()
    h = 1e-5
    for axis in range(3):
        ends = []
        for k in (-1, 1):
            moved = vertices.copy()
            moved[4, axis] += k * h
            ends.append(inertia.mass_properties(Part.from_arrays(moved, faces), mass=3.0).inertia)
        np.testing.assert_allclose(weighed.inertia[4, :, :, axis], (ends[1] - ends[0]) / (2 * h), atol=1e-8)


def test_a_shell_turned_outward_has_the_derivatives_of_the_one_that_faces_there() -> None:
    vertices, faces = bumpy()
    outward = inertia.gradient(Part.from_arrays(vertices, faces))
    inward = inertia.gradient(Part.from_arrays(vertices, faces[:, ::-1]), orientation="absolute")
    np.testing.assert_allclose(inward.inertia, outward.inertia, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("kind", SOLIDS)
def test_derivatives_of_cells_are_those_of_their_rational_maps(kind: str) -> None:
    rng = np.random.default_rng(3)
    nodes = dyadic(reference(kind) + rng.normal(0, 0.04, reference(kind).shape) + [2, 1, -1], 10)
    gradient = inertia.gradient(cells_of(kind, nodes), 1.0)

    def rational(points: Float) -> Moments:
        m = exact_moments(kind, points)
        return Moments(m.zeroth, m.first, m.second)

    for row, axis in [(0, 0), (len(nodes) - 1, 1), (2, 2)]:
        assert_rates(gradient, row, axis, exact_rates(rational, nodes, (row, axis)), 1e-13)


def test_cells_with_nodes_in_one_place_move_together() -> None:
    corners = reference("hexahedron")
    apart = cells_of("hexahedron", corners, corners + np.array([2, 0, 0]))
    points, rows = np.unique(apart.geometry.points, axis=0, return_inverse=True)
    block = CellBlock("hexahedron", rows.reshape(2, 8))
    whole = inertia.gradient(Part(Cells(points, (block,)), length_unit("m"), "option"), 1.0)
    welded = inertia.gradient(apart, 1.0)
    assert len(welded.vertices) == 12
    order = [int(np.flatnonzero((welded.vertices == v).all(axis=1))[0]) for v in points]
    np.testing.assert_allclose(welded.inertia[order], whole.inertia, atol=1e-13)


def differences(
    moments_of: Callable, points: list[list[Fraction]], row: int, axis: int, count: int = 10
) -> list[float]:
    """Return the derivatives of the first of the ten moments by a coordinate, by mpmath's differences at 40 digits."""
    with mpmath.workdps(40):

        def at(k: int) -> Callable:
            def value(t: mpmath.mpf) -> mpmath.mpf:
                moved = [[mpmath.mpf(x.numerator) / x.denominator for x in p] for p in points]
                moved[row][axis] += t
                return moments_of(moved)[k]

            return value

        return [float(mpmath.diff(at(k), 0)) for k in range(count)]


def quotient(m: list[float], dm: list[float]) -> tuple[list[float], list[float]]:
    """Return the derivatives of centre and tensor elements xx, yy, zz, xy, xz, yz; moments xx, yy, zz, xy, xz, yz."""
    com = [m[1 + i] / m[0] for i in range(3)]
    dcom = [(dm[1 + i] - com[i] * dm[0]) / m[0] for i in range(3)]
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    dc = [dm[4 + k] - dcom[i] * m[1 + j] - com[i] * dm[1 + j] for k, (i, j) in enumerate(pairs)]
    return dcom, [*(sum(dc[:3]) - k for k in dc[:3]), *(-k for k in dc[3:])]


def test_derivatives_of_a_shell_follow_its_area() -> None:
    vertices, faces = bumpy(splits=0)
    gradient = inertia.gradient(Part.from_arrays(vertices, faces[:-2]), 1.0, shell=0.5)
    rational = [[Fraction(x) for x in p] for p in vertices.tolist()]
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

    def area_moments(points: list) -> list:
        total = [mpmath.mpf(0)] * 10
        for face in faces[:-2].tolist():
            p, q, r = (points[k] for k in face)
            u, v = [b - a for a, b in zip(p, q, strict=True)], [b - a for a, b in zip(p, r, strict=True)]
            n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
            area = mpmath.sqrt(sum(k * k for k in n)) / 2
            # Gauss's rule at the middles of the sides is exact for degree two.
            for a, b in ((p, q), (q, r), (r, p)):
                x = [(s + t) / 2 for s, t in zip(a, b, strict=True)]
                terms = [1, *x, *(x[i] * x[j] for i, j in pairs)]
                total = [t + area / 3 * k / 2 for t, k in zip(total, terms, strict=True)]
        return total

    m = [float(k) for k in area_moments([[mpmath.mpf(float(x)) for x in p] for p in rational])]
    for row, axis in [(0, 0), (3, 1), (5, 2)]:
        dm = differences(area_moments, rational, row, axis)
        dcom, tensor = quotient(m, dm)
        assert gradient.volume[row, axis] == pytest.approx(dm[0], abs=1e-13)
        np.testing.assert_allclose(gradient.center_of_mass[row, :, axis], dcom, atol=1e-13)
        full = gradient.inertia[row, :, :, axis]
        np.testing.assert_allclose([full[i, j] for i, j in pairs], tensor, atol=1e-11)


def test_derivatives_of_a_wire_follow_its_length() -> None:
    points = dyadic(np.random.default_rng(5).normal(0, 2, (4, 3)))
    lines = np.array([[0, 1], [1, 2], [2, 3], [1, 3]])
    part = Part(Cells(points, (CellBlock("line", lines),)), length_unit("m"), "option")
    gradient = inertia.gradient(part, 2.0, wire=0.5)
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

    def length_moments(places: list) -> list:
        total = [mpmath.mpf(0)] * 10
        for a, b in lines.tolist():
            p, q = places[a], places[b]
            length = mpmath.sqrt(sum((s - t) ** 2 for s, t in zip(p, q, strict=True)))
            for x, weight in ((p, 1), ([(s + t) / 2 for s, t in zip(p, q, strict=True)], 4), (q, 1)):  # Simpson's rule
                terms = [1, *x, *(x[i] * x[j] for i, j in pairs)]
                total = [t + length * weight / 6 * k for t, k in zip(total, terms, strict=True)]
        return total

    rational = [[Fraction(x) for x in p] for p in points.tolist()]
    m = [float(k) for k in length_moments([[mpmath.mpf(x) for x in p] for p in points.tolist()])]
    for row, axis in [(0, 0), (1, 1), (3, 2)]:
        dm = differences(length_moments, rational, row, axis)
        dcom, tensor = quotient(m, dm)
        assert gradient.mass[row, axis] == pytest.approx(dm[0], abs=1e-13)
        np.testing.assert_allclose(gradient.center_of_mass[row, :, axis], dcom, atol=1e-13)
        full = gradient.inertia[row, :, :, axis]
        np.testing.assert_allclose([full[i, j] for i, j in pairs], tensor, atol=1e-11)


def test_moments_and_axes_turn_as_mpmath_diagonalises_the_moved_solid() -> None:
    vertices, faces = bumpy(2)
    vertices = dyadic(vertices * [1.0, 1.5, 2.5])
    part = Part.from_arrays(vertices, faces)
    gradient, axes = inertia.gradient(part, 1.0), inertia.mass_properties(part, 1.0).principal_axes

    def decomposition(t: float, row: int, axis: int) -> tuple[list, list]:
        moved = vertices.copy()
        moved[row, axis] += t
        rows = moments(moved[faces]).inertia
        tensor = mpmath.matrix([[mpmath.mpf(k.numerator) / k.denominator for k in line] for line in rows])
        values, columns = mpmath.eigsy(tensor)
        directions = []
        for k in range(3):
            direction = [columns[n, k] for n in range(3)]
            sign = -1 if sum(float(x) * y for x, y in zip(direction, axes[:, k].tolist(), strict=True)) < 0 else 1
            directions.append([sign * x for x in direction])
        return list(values), directions

    h = 2.0**-30
    with mpmath.workdps(60):
        for row, axis in [(0, 0), (9, 1), (17, 2)]:
            (low, before), (high, after) = (decomposition(t, row, axis) for t in (-h, h))
            rates = [float((b - a) / (2 * h)) for a, b in zip(low, high, strict=True)]
            np.testing.assert_allclose(gradient.principal_moments[row, :, axis], rates, rtol=1e-11, atol=1e-9)
            turns = [
                float(sum((after[i][n] - before[i][n]) * before[j][n] for n in range(3)) / (2 * h))
                for i, j in ((1, 2), (2, 0), (0, 1))  # about axis 1, 2, 3
            ]
            np.testing.assert_allclose(gradient.principal_axes[row, :, axis], turns, rtol=1e-6, atol=1e-9)


def test_axes_of_equal_moments_have_no_derivative() -> None:
    gradient = inertia.gradient(inertia.read(path("cube.stl"), unit="mm"))
    assert np.isnan(gradient.principal_axes).all()
    assert np.isfinite(gradient.principal_moments).all()


def test_moving_and_scaling_all_vertices_is_known() -> None:
    vertices, faces = bumpy()
    part = Part.from_arrays(vertices, faces)
    gradient, properties = inertia.gradient(part, 3.0), inertia.mass_properties(part, 3.0)
    np.testing.assert_allclose(gradient.volume.sum(axis=0), 0, atol=1e-12)
    np.testing.assert_allclose(gradient.center_of_mass.sum(axis=0), np.eye(3), atol=1e-13)
    np.testing.assert_allclose(gradient.inertia.sum(axis=0), 0, atol=1e-10)
    scaled = np.einsum("nijc,nc->ij", gradient.inertia, vertices)
    np.testing.assert_allclose(scaled, 5 * properties.inertia, rtol=1e-12, atol=1e-10)


def test_a_vertex_that_no_triangle_uses_has_a_row_of_zeros() -> None:
    vertices, faces = bumpy()
    gradient = inertia.gradient(Part(Surface(np.vstack([vertices, [[9.0, 9.0, 9.0]]]), faces)))
    assert not gradient.inertia[-1].any()
    assert gradient.volume[:-1].any()


def test_derivatives_of_a_wire_follow_the_densities_of_its_regions() -> None:
    """Two rods along one line, of 3 and 4 m: their ends draw mass in by density times section for each metre."""
    lines = (CellBlock("vertex", np.array([[1]])), CellBlock("line", np.array([[0, 1], [1, 2]])))
    cells = Cells(np.array([[0, 0, 0], [3, 0, 0], [7, 0, 0]], float), lines)
    part = Part(cells, length_unit("m"), "option", regions=Regions(("a", "b"), np.array([0, 0, 1], np.int32)))
    gradient = inertia.gradient(part, {"a": 10, "b": 20}, wire=2.0)
    np.testing.assert_allclose(gradient.mass[:, 0], [-20, 20 - 40, 40], atol=1e-12)
    np.testing.assert_allclose(gradient.mass[:, 1:], 0, atol=1e-12)


def test_derivatives_of_a_curved_wire_follow_its_arc() -> None:
    points = np.array([[0.0, 0.0, 0.0], [2.0, 0.5, 0.25], [1.25, 0.75, -0.5]])  # the ends, and a place between them
    part = Part(Cells(points, (CellBlock("line3", np.array([[0, 1, 2]])),)), length_unit("m"), "option")
    gradient = inertia.gradient(part, 1.0, wire=1.0)

    def length(places: list) -> list:
        def speed(t: mpmath.mpf) -> mpmath.mpf:
            slopes = (t - mpmath.mpf(1) / 2, t + mpmath.mpf(1) / 2, -2 * t)
            return mpmath.sqrt(sum(sum(s * p[i] for s, p in zip(slopes, places, strict=True)) ** 2 for i in range(3)))

        return [mpmath.quad(speed, [-1, 0, 1])]

    rational = [[Fraction(x) for x in p] for p in points.tolist()]
    for row, axis in [(0, 0), (1, 1), (2, 2)]:
        assert gradient.volume[row, axis] == pytest.approx(differences(length, rational, row, axis, 1)[0], rel=1e-9)
