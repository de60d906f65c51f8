"""Point masses, wires and laminae, against textbook values and exact arithmetic."""

import math
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from inertia.errors import GeometryError, InertiaError, UsageError
from inertia.mass.elements import lamina, point_masses, wire
from inertia.mass.properties import MassProperties

F = Fraction
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def hidden(values: list) -> np.ma.MaskedArray:
    """Return numbers whose last one, or row, is masked."""
    return np.ma.array(values, dtype=float, mask=np.arange(len(values)).repeat(np.size(values[0])) == len(values) - 1)


def rotation(seed: int) -> np.ndarray:
    q: np.ndarray = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def assert_tensor(properties: MassProperties, expected: np.ndarray, rel: float = 1e-15) -> None:
    assert properties.inertia == pytest.approx(expected, abs=rel * float(np.linalg.norm(expected)))


# Points


def test_three_points_as_the_textbook_sums_them() -> None:
    properties = point_masses([[1, 0, 0], [0, 2, 0], [0, 0, 4]], [1.0, 1.0, 2.0])
    assert properties.mass == 4.0
    assert properties.volume == 0.0
    assert properties.center_of_mass.tolist() == [0.25, 0.5, 2.0]
    about_origin = properties.about([0, 0, 0])
    assert about_origin.tolist() == [[36, 0, 0], [0, 33, 0], [0, 0, 5]]
    assert properties.inertia[0, 1] == 4 * 0.25 * 0.5  # −Σ m x y about the centre


def test_a_single_point_has_no_inertia_about_itself() -> None:
    properties = point_masses([[3, 4, 0]], [2.0])
    assert properties.inertia.tolist() == np.zeros((3, 3)).tolist()
    assert properties.about([0, 0, 0]).diagonal().tolist() == [32, 18, 50]
    both = properties + point_masses([[3, 4, 0]], [2.0])
    assert (both.mass, both.inertia.any()) == (4.0, False)


def test_a_molecule_far_away_keeps_its_digits() -> None:
    """Two points 2 d apart: m d² each, at whatever distance from the origin their coordinates can hold."""
    properties = point_masses([[1e15 + 1, 0, 0], [1e15 - 1, 0, 0]], [0.5, 0.5])
    assert properties.inertia.diagonal().tolist() == [0, 1, 1]
    assert properties.principal.kind == "rotor"


@settings(deadline=None, max_examples=40)
@given(st.lists(st.tuples(*[st.floats(-1e3, 1e3)] * 3, st.floats(1e-3, 1e3)), min_size=2, max_size=6))
def test_points_are_rounded_once_from_the_exact_sums(rows: list[tuple[float, float, float, float]]) -> None:
    places, masses = [[F(x) for x in row[:3]] for row in rows], [F(row[3]) for row in rows]
    try:
        properties = point_masses([row[:3] for row in rows], [row[3] for row in rows])
    except GeometryError as e:
        assume("leaves float64" not in str(e))
        raise
    mass = sum(masses)
    com = [sum(m * p[i] for m, p in zip(masses, places, strict=True)) / mass for i in range(3)]
    assert properties.mass == float(mass)
    assert properties.center_of_mass.tolist() == [float(x) for x in com]
    for i in range(3):
        for j in range(3):
            r = [[a - b for a, b in zip(p, com, strict=True)] for p in places]
            exact = sum(m * ((i == j) * sum(x * x for x in q) - q[i] * q[j]) for m, q in zip(masses, r, strict=True))
            assert properties.inertia[i, j] == float(exact)


# Wires


def test_a_rod_across_and_along() -> None:
    """M l²/12 about its middle, M l²/3 about its end, nothing about itself."""
    rod = wire([[0, 0, 0], [0, 3, 0]], 2.0)
    assert (rod.mass, rod.volume) == (6.0, 0.0)
    assert rod.center_of_mass.tolist() == [0, 1.5, 0]
    assert rod.inertia.diagonal().tolist() == [4.5, 0, 4.5]
    assert rod.about([0, 0, 0]).diagonal().tolist() == [18, 0, 18]
    assert rod.principal.kind == "rotor"


def test_a_square_frame() -> None:
    """Four rods of length a and mass m: 4 m a²/3 about the axis through the middle, 2 m a²/3 in its plane."""
    frame = wire([[1, 1, 5], [-1, 1, 5], [-1, -1, 5], [1, -1, 5], [1, 1, 5]], 1.5)
    assert frame.mass == 12.0
    assert frame.center_of_mass.tolist() == [0, 0, 5]
    assert frame.inertia.tolist() == np.diag([8.0, 8.0, 16.0]).tolist()


@pytest.mark.parametrize("sides", [3, 7, 500])
def test_a_ring_of_straight_wires(sides: int) -> None:
    """A regular polygon with corners at R: M R² (1 + 2 cos² (π/n))/3 about its axis, which goes to M R²."""
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    ring = wire(np.column_stack([2 * np.cos(angle), 2 * np.sin(angle)]), 1.0)
    assert ring.mass == pytest.approx(4 * sides * math.sin(math.pi / sides), rel=1e-14)
    moment = ring.mass * 4 * (1 + 2 * math.cos(math.pi / sides) ** 2) / 3
    assert_tensor(ring, np.diag([moment / 2, moment / 2, moment]), rel=1e-13)


def test_a_wire_does_not_depend_on_where_a_segment_is_split() -> None:
    whole = wire([[0, 0, 0], [8, 4, -16]], 0.7)
    split = wire([[0, 0, 0], [1, 0.5, -2], [8, 4, -16]], 0.7)
    assert_tensor(split, whole.inertia)
    assert split.mass == pytest.approx(whole.mass, rel=1e-15)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.floats(-60, 40))
def test_a_wire_is_within_its_bounds(seed: int, count: int, power: float) -> None:
    points = np.random.default_rng(seed).normal(size=(count, 3)) * 10.0**power
    density = 0.1 + seed % 7
    properties = wire(points, density)
    with mpmath.workdps(60):
        corners = [[mpmath.mpf(x) for x in p] for p in points.tolist()]
        pairs = list(pairwise(corners))
        masses = [density * mpmath.sqrt(sum((b - a) ** 2 for a, b in zip(*pair, strict=True))) for pair in pairs]
        mass = sum(masses)
        com = [sum(m * (a[i] + b[i]) / 2 for m, (a, b) in zip(masses, pairs, strict=True)) / mass for i in range(3)]
        second = mpmath.matrix(3)
        for m, ends in zip(masses, pairs, strict=True):
            a, b = ([x - c for x, c in zip(end, com, strict=True)] for end in ends)
            for i in range(3):
                for j in range(3):
                    second[i, j] += m * ((a[i] + b[i]) * (a[j] + b[j]) + a[i] * a[j] + b[i] * b[j]) / 6
        trace = second[0, 0] + second[1, 1] + second[2, 2]
        assert abs(properties.mass - mass) <= properties.error.mass * properties.mass
        distance = mpmath.sqrt(sum((x - c) ** 2 for x, c in zip(properties.center_of_mass.tolist(), com, strict=True)))
        assert distance <= properties.error.center_of_mass
        squares = [
            (properties.inertia[i, j].item() - ((i == j) * trace - second[i, j])) ** 2
            for i in range(3)
            for j in range(3)
        ]
        norm = mpmath.sqrt(sum(mpmath.mpf(k) ** 2 for k in properties.inertia.ravel().tolist()))
        assert mpmath.sqrt(sum(squares)) <= properties.error.inertia * norm
    assert properties.error.inertia < 1e-15


# Laminae


def test_a_rectangle() -> None:
    """M b²/12, M a²/12 and their sum."""
    plate = lamina([[0, 0], [6, 0], [6, 2], [0, 2]], 0.25)
    assert (plate.mass, plate.volume) == (3.0, 0.0)
    assert plate.center_of_mass.tolist() == [3, 1, 0]
    assert plate.inertia.tolist() == np.diag([1.0, 9.0, 10.0]).tolist()


def test_a_right_triangle() -> None:
    """Legs a and b: M b²/18, M a²/18, and ∫xy dm = −M ab/36 about the centroid."""
    plate = lamina([[0, 0], [6, 0], [0, 3]], 2.0)
    assert plate.mass == 18.0
    assert plate.center_of_mass.tolist() == [2, 1, 0]
    assert plate.inertia.tolist() == [[9, 9, 0], [9, 36, 0], [0, 0, 45]]


def test_an_l_shape_seen_from_any_corner_and_either_side() -> None:
    """Two rectangles joined, whichever corner begins and whichever way round."""
    outline = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]
    expected = lamina([[0, 0], [4, 0], [4, 1], [0, 1]], 1.5) + lamina([[0, 1], [1, 1], [1, 3], [0, 3]], 1.5)
    for first in range(6):
        for way in (1, -1):
            properties = lamina((outline[first:] + outline[:first])[::way], 1.5)
            assert properties.mass == 9.0
            assert properties.center_of_mass == pytest.approx(expected.center_of_mass, rel=1e-15)
            assert_tensor(properties, expected.inertia)


def test_a_regular_polygon_goes_to_the_disc() -> None:
    """Corners at R: M R² (2 + cos (2π/n))/6 about its axis, half of it in its plane."""
    angle = 2 * np.pi * np.arange(7) / 7
    plate = lamina(np.column_stack([np.cos(angle), np.sin(angle)]), 3.0)
    assert plate.mass == pytest.approx(3 * 3.5 * math.sin(2 * math.pi / 7), rel=1e-14)
    moment = plate.mass * (2 + math.cos(2 * math.pi / 7)) / 6
    assert_tensor(plate, np.diag([moment / 2, moment / 2, moment]), rel=1e-14)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-20, 1.0, 1e20]))
def test_a_lamina_in_any_plane_keeps_its_principal_moments_and_their_sum(seed: int, scale: float) -> None:
    flat = np.array([[0, 0, 0], [4, 0, 0], [4, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]])
    placed = scale * (flat @ rotation(seed).T + [1.0, -2.0, 0.5])
    properties, own = lamina(placed, 1.5), lamina(flat, 1.5)
    assert properties.mass == pytest.approx(own.mass * scale**2, rel=1e-13)
    moments = properties.principal_moments / scale**4
    assert moments == pytest.approx(own.principal_moments, rel=1e-12)
    assert moments[0] + moments[1] == pytest.approx(moments[2], rel=1e-12)


@settings(deadline=None, max_examples=40)
@given(st.lists(st.tuples(*[st.floats(-1e3, 1e3)] * 2), min_size=3, max_size=3))
def test_a_triangle_is_within_its_bounds_or_refused(corners: list[tuple[float, float]]) -> None:
    (ax, ay), (bx, by), (cx, cy) = ((F(x), F(y)) for x, y in corners)
    mass = 3 * abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
    try:
        properties = lamina(corners, 3.0)
    except GeometryError:
        assert (
            float(mass)
            <= 1e-14 * max(1e-280, float(max(ax, bx, cx) - min(ax, bx, cx)) ** 2)
            + 1e-14 * float(max(ay, by, cy) - min(ay, by, cy)) ** 2
        )
        return
    assert abs(F(properties.mass) - mass) <= F(properties.error.mass) * F(properties.mass)
    about_z = (
        mass * sum(k * k for k in (ax - bx, bx - cx, cx - ax, ay - by, by - cy, cy - ay)) / 36
    )  # the sum of the squared sides
    norm = F(float(np.linalg.norm(properties.inertia))) * (1 + F(1, 10**12))
    assert abs(F(properties.inertia[2, 2]) - about_z) <= F(properties.error.inertia) * norm + F(1, 2**1000)


# Errors


@pytest.mark.parametrize(
    ("call", "kind", "match"),
    [
        (lambda: point_masses([[0, 0, 0]], [0.0]), GeometryError, r"masses\[0\] is 0.0: a mass must be positive"),
        (lambda: point_masses([[0, 0, 0]] * 3, [1, 1, -2]), GeometryError, r"masses\[2\] is -2.0"),
        (lambda: point_masses([[0, 0, 0]] * 2, [1, np.nan]), GeometryError, r"masses\[1\] is nan"),
        (lambda: point_masses([[0, 0, 0]], [np.inf]), GeometryError, r"masses\[0\] is inf"),
        (lambda: point_masses([[0, 0, 0]], [1, 2]), UsageError, r"masses must have shape \(1,\), .* not \(2,\)"),
        (lambda: point_masses([[0, 0, 0]], 1.0), UsageError, r"masses must have shape \(1,\)"),
        (lambda: point_masses([[0, 0, 0]], ["x"]), UsageError, "masses must be an array of numbers"),
        (lambda: point_masses([], []), UsageError, r"points must have shape \(n, 3\) with n at least 1"),
        (lambda: point_masses([0, 0, 0], [1]), UsageError, r"not \(3,\)"),
        (lambda: point_masses([[0, 0, 0], [1, 1]], [1, 1]), UsageError, "points must be an array of numbers"),
        (lambda: point_masses([[0, 0, np.nan]], [1]), GeometryError, "point 0 has the coordinates .*nan"),
        (lambda: point_masses([[1e200, 0, 0], [0, 0, 0]], [1, 1]), GeometryError, "above 1.8e308 .*, which are in m"),
        (lambda: point_masses([[1e-200, 0, 0], [0, 0, 0]], [1, 1]), GeometryError, "below 5e-324 .*, which are in m"),
        (lambda: point_masses([[0, 0, 0]] * 2, [1e308, 1e308]), GeometryError, "above 1.8e308 .* masses"),
        (lambda: point_masses([[0, 0, 0]], [10**400]), GeometryError, r"masses\[0\] is inf"),
        (lambda: point_masses([[0, 0, 0]] * 2, hidden([1, 9])), GeometryError, r"masses\[1\] is nan"),
        (lambda: point_masses(hidden([[0, 0, 0], [1, 1, 1]]), [1, 9]), GeometryError, "point 1 has the coordinates"),
        (lambda: point_masses(np.array([[0, 0, 1j]]), [1]), UsageError, "points must be an array of numbers"),
        (lambda: wire([[0, 0, 0], [1, 0, 0]], "thick"), UsageError, "linear_density is 'thick': it must be a number"),
        (lambda: wire([[0, 0, 0], [1, 0, 0]], 10**400), UsageError, "linear_density is inf kg/m"),
        (lambda: lamina([[0, 0], [1, 0], [0, 1]], None), UsageError, "areal_density is None: it must be a number"),
        (lambda: lamina(1e200 * SQUARE, 1.0), GeometryError, "above 1.8e308 .*, which are in m"),
        (lambda: lamina(1e-170 * SQUARE, 1.0), GeometryError, "below 5e-324 .*, which are in m"),
        (lambda: lamina(1.7e308 * (2 * SQUARE - 1), 1.0), GeometryError, "above 1.8e308"),
        (lambda: wire([[0, 0, 0]], 1.0), UsageError, r"n at least 2, not \(1, 3\)"),
        (lambda: wire([[0, 0, 0], [0, np.inf, 0]], 1.0), GeometryError, "point 1 has the coordinates"),
        (lambda: wire([[0, 0, 0], [1, 0, 0]], 0.0), UsageError, "linear_density is 0 kg/m: it must be positive"),
        (lambda: wire([[0, 0, 0], [1, 0, 0]], math.nan), UsageError, "linear_density is nan"),
        (lambda: wire([[1, 1, 1], [1, 1, 1]], 1.0), GeometryError, "the wire has no length: .* in one place"),
        (lambda: lamina([[0, 0], [1, 0]], 1.0), UsageError, "n at least 3"),
        (lambda: lamina([[0, 0], [1, 0], [2, 0]], 1.0), GeometryError, "encloses no area"),
        (lambda: lamina([[1, 1], [1, 1], [1, 1]], 1.0), GeometryError, "encloses no area"),
        (lambda: lamina([[0, 0], [1, 1], [1, 0], [0, 1]], 1.0), GeometryError, "encloses no area"),
        (lambda: lamina([[0, 0], [1, 0], [0, 1]], -1.0), UsageError, "areal_density is -1 kg/m²"),
        (lambda: lamina([[0, 0], [1, 0], [0, np.nan]], 1.0), GeometryError, "point 2 has the coordinates"),
        (
            lambda: lamina([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], 1.0),
            GeometryError,
            r"outline\[\d\] is 0.\d+ m off the plane .* the limit is 1e-09 m",
        ),
    ],
)
def test_what_is_no_body_is_refused(call: object, kind: type[InertiaError], match: str) -> None:
    with pytest.raises(kind, match=match) as e:
        call()
    assert e.value.exit_code == {UsageError: 2, GeometryError: 4}[kind]


@pytest.mark.parametrize("size", [2.0**-250, 2.0**250])
def test_laminae_whose_areas_squared_leave_float64_have_all_digits(size: float) -> None:
    small = lamina(size * SQUARE, 1.0)
    assert small.mass == size**2
    assert small.inertia[2, 2] == pytest.approx(size**4 / 6, rel=1e-15)
    with pytest.raises(GeometryError, match="the outline crosses itself"):
        lamina(size * np.array([[0, 0], [2, 0], [2, 2], [1, -1], [0, 2]]), 1.0)


@pytest.mark.parametrize(("lift", "fits"), [(3.9e-9, True), (4.1e-9, False)])
def test_flatness_is_held_to_its_tolerance_from_both_sides(lift: float, fits: bool) -> None:
    """One corner of a square lifted by h lies h/4 off the mean plane, as do the others, to first order."""
    outline = [[0, 0, 0], [1, 0, 0], [1, 1, lift], [0, 1, 0]]
    if fits:
        assert lamina(outline, 1.0).mass == pytest.approx(1.0)
    else:
        with pytest.raises(GeometryError, match="off the plane"):
            lamina(outline, 1.0)


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("turn", [np.eye(3), np.linalg.qr([[1.0, 1, 0.3], [-1, 1, 0.5], [0.4, -0.2, 1]])[0]])
def test_an_outline_that_crosses_itself_is_refused(first: int, turn: np.ndarray) -> None:
    bow = np.roll([[0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 1, 0]], first, axis=0)
    with pytest.raises(GeometryError, match=r"crosses itself: its edges from corners \d and \d on"):
        lamina(bow @ turn, 1.0)


def test_an_outline_may_run_along_itself_around_a_hole() -> None:
    square, hole = (
        np.array([[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]]),
        np.array([[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]),
    )
    plate, filling = lamina(np.concatenate([square, hole]), 2.0), lamina(hole[:4], 2.0)
    assert plate.mass == 16.0
    whole = lamina(square[:4], 2.0)
    assert (plate + filling).inertia == pytest.approx(whole.inertia, rel=1e-15)


TURNS = np.arange(24) * np.pi / 12
GEAR = np.column_stack([np.cos(TURNS), np.sin(TURNS)]) * np.where(np.arange(24) % 2, 1.0, 1.1)[:, None]
SPIRAL = [(0.0, 0.0), *((1 + a) * np.array([np.cos(a), np.sin(a)]) for a in np.linspace(0, 2.5 * np.pi, 40))]


@pytest.mark.parametrize("turn", [np.eye(3), rotation(1)])
@pytest.mark.parametrize(
    ("outline", "says"),
    [
        ([*SQUARE, *SQUARE], "goes round something twice"),
        ([*SQUARE[::-1], *SQUARE[::-1]], "goes round something twice"),
        ([*SQUARE, [0, 0], [0.5, 0], *SQUARE[1:]], "goes round something twice"),
        ([*GEAR, *GEAR], "goes round something twice"),
        ([[-1, -1], [0, 0], [1, 2], [1, -2], [0, 0], [-1, 1]], "one part this way and another that way"),
        (SPIRAL, "crosses itself"),
    ],
)
def test_an_outline_goes_once_around(outline: ArrayLike, says: str, turn: np.ndarray) -> None:
    flat = np.asarray(outline, float)
    with pytest.raises(GeometryError, match=f"{says}|crosses itself"):  # as rounding lets edges in line cross or touch
        lamina(np.pad(flat, ((0, 0), (0, 1))) @ turn.T, 1.0)


@pytest.mark.parametrize(
    ("outline", "area"),
    [
        ([*SQUARE, [0, 0]], 1.0),
        ([[0, 0], [1, 0], [2, 0], [1, 0], [0, 1]], 0.5),
        ([[-1, -1], [0, 0], [1, -2], [1, 2], [0, 0], [-1, 1]], 3.0),
        ([*GEAR, GEAR[0], *(0.5 * GEAR[[0, *range(len(GEAR) - 1, -1, -1)]])], 0.75 * 12 * 1.1 * np.sin(np.pi / 12)),
    ],
)
@pytest.mark.parametrize("way", [1, -1])
def test_an_outline_may_touch_itself(outline: ArrayLike, area: float, way: int) -> None:
    """Closed by its first corner, with a spike, two triangles at a point, and a gear with a hole led to by a cut."""
    assert lamina(np.asarray(outline, float)[::way], 1.0).mass == pytest.approx(area, rel=1e-14)
