"""The rational moments against solids whose moments are known by hand: equal as fractions, not nearly."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia_meshes import shapes
from inertia_meshes.circle import PI, cosine, sine
from inertia_meshes.rational import PAIRS, Moments, moments

F = Fraction
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
CUBE = [
    [[x, y, z] for x, y, z in face]
    for face in (
        [(0, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (1, 0, 0)],
        [(0, 0, 1), (1, 0, 1), (1, 1, 1)], [(0, 0, 1), (1, 1, 1), (0, 1, 1)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 1)], [(0, 0, 0), (1, 0, 1), (0, 0, 1)],
        [(0, 1, 0), (0, 1, 1), (1, 1, 1)], [(0, 1, 0), (1, 1, 1), (1, 1, 0)],
        [(0, 0, 0), (0, 0, 1), (0, 1, 1)], [(0, 0, 0), (0, 1, 1), (0, 1, 0)],
        [(1, 0, 0), (1, 1, 0), (1, 1, 1)], [(1, 0, 0), (1, 1, 1), (1, 0, 1)],
    )
]  # fmt: skip
POINT = st.tuples(*[st.integers(-1000, 1000)] * 3)


def cube() -> np.ndarray:
    return np.array(CUBE, np.float64)


def diagonal(*values: Fraction) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(values[i] if i == j else F(0) for j in range(3)) for i in range(3))


def test_the_unit_cube_in_a_corner_of_the_axes() -> None:
    solid = moments(cube())
    assert solid == Moments(F(1), (F(1, 2),) * 3, (F(1, 3),) * 3 + (F(1, 4),) * 3)
    assert solid.center_of_mass == (F(1, 2),) * 3
    assert solid.inertia == diagonal(F(1, 6), F(1, 6), F(1, 6))


def test_a_box_far_away_has_the_inertia_of_a_box() -> None:
    a, b, c = 3, 0.5, 7
    solid = moments(cube() * (a, b, c) + (2**30, -(2**31), 5))
    volume = F(a) * F(b) * F(c)
    a2, b2, c2 = F(a) ** 2, F(b) ** 2, F(c) ** 2
    assert solid.volume == volume
    assert solid.center_of_mass == (2**30 + F(3, 2), -(2**31) + F(1, 4), 5 + F(7, 2))
    assert solid.inertia == diagonal(*(volume * s / 12 for s in (b2 + c2, c2 + a2, a2 + b2)))


def test_a_regular_tetrahedron_has_a_twentieth_of_mass_times_edge_squared() -> None:
    corners = np.array([(1, 1, 1), (-1, 1, -1), (1, -1, -1), (-1, -1, 1)], np.float64)
    solid = moments(corners[FACES])
    assert solid.volume == F(8, 3)
    assert solid.inertia == diagonal(*[F(8, 3) * 8 / 20] * 3)


def test_products_of_inertia_carry_tensor_signs() -> None:
    bar = np.concatenate([cube(), cube() + np.array((3, 3, 0))])  # along x = y: ∫xy about the centre is positive
    assert moments(bar).inertia[0][1] == -2 * F(3, 2) ** 2


def test_a_tenth_is_taken_as_the_float_that_it_is() -> None:
    assert moments(cube() * 0.1).volume == F(0.1) ** 3 != F(1, 1000)


@settings(deadline=None)
@given(st.tuples(POINT, POINT, POINT, POINT), st.integers(0, 60))
def test_any_tetrahedron_agrees_with_the_sum_over_its_corners(corners: tuple, exponent: int) -> None:
    """∫(x−g)(x−g)ᵀ = V/20 Σ (v−g)(v−g)ᵀ over the four corners v, g their mean."""
    scale = F(1, 2**exponent)
    solid = moments(np.array(corners, np.float64)[FACES] / 2**exponent)
    exact = [[scale * x for x in corner] for corner in corners]
    a, b, c = ([x - o for x, o in zip(corner, exact[0], strict=True)] for corner in exact[1:])
    six = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    assert solid.volume == six / 6
    if six:
        g = [sum(column) / 4 for column in zip(*exact, strict=True)]
        assert solid.center_of_mass == tuple(g)
        assert solid.central == tuple(
            solid.volume / 20 * sum((v[i] - g[i]) * (v[j] - g[j]) for v in exact) for i, j in PAIRS
        )


@settings(deadline=None)
@given(st.tuples(POINT, POINT, POINT, POINT), POINT, st.integers(1, 9))
def test_moved_and_scaled_moments_are_those_of_the_moved_and_scaled_mesh(
    corners: tuple, by: tuple, factor: int
) -> None:
    mesh = np.array(corners, np.float64)[FACES]
    solid = moments(mesh)
    assert solid.moved(*by) == moments(mesh + by)
    assert solid.scaled(factor, 2, 3) == moments(mesh * (factor, 2, 3))
    assert solid.mapped(((0, 0, 1), (1, 0, 0), (0, 1, 0))) == moments(mesh[:, :, [2, 0, 1]])


def test_split_parts_add_up_and_a_reversed_surface_is_taken_away() -> None:
    whole, half = cube() * (2, 1, 1), cube()
    assert moments(half) + moments(half + np.array((1, 0, 0))) == moments(whole)
    assert moments(whole) - moments(half) == moments(np.concatenate([whole, half[:, ::-1]]))
    assert moments(half).weighted(F(7850)).volume == 7850


def test_the_centre_of_no_volume_is_refused() -> None:
    with pytest.raises(ZeroDivisionError):
        _ = moments(np.concatenate([cube(), cube()[:, ::-1]])).center_of_mass


def test_pi_and_cosines_agree_with_mpmath_to_forty_digits() -> None:
    import mpmath

    with mpmath.workdps(60):
        assert abs(mpmath.mpf(PI.numerator) / PI.denominator - mpmath.pi) < mpmath.mpf("1e-58")
        for turn in (F(1, 7), F(-3, 11), F(5, 9), F(20, 36), F(17, 3)):
            angle = 2 * mpmath.pi * turn.numerator / turn.denominator
            for ours, theirs in ((cosine(turn), mpmath.cos(angle)), (sine(turn), mpmath.sin(angle))):
                assert abs(mpmath.mpf(ours.numerator) / ours.denominator - theirs) < mpmath.mpf("1e-43")


def test_quarter_turns_are_exact() -> None:
    assert [cosine(F(k, 4)) for k in range(5)] == [1, 0, -1, 0, 1]
    assert [sine(F(k, 4)) for k in range(5)] == [0, 1, 0, -1, 0]


@pytest.mark.parametrize("shape", [lambda n: shapes.sphere(1, n), lambda n: shapes.torus(2, 0.5, n)])
def test_symmetric_meshes_have_exactly_symmetric_moments(shape) -> None:
    solid = moments(shape(24))
    assert solid.first == (0, 0, 0)
    assert solid.second[3:] == (0, 0, 0)
    assert solid.second[0] == solid.second[1]


@pytest.mark.parametrize(
    ("shape", "volume", "polar"),
    [
        (lambda n: shapes.sphere(1, n), 4 / 3 * PI, 8 / 15 * PI),
        (lambda n: shapes.torus(2, 0.5, n), PI**2, PI**2 * (4 + F(3, 16))),
        (lambda n: shapes.revolved([(0, 0), (1, 0), (0, 3)], n), PI, F(3, 10) * PI),
    ],
    ids=["sphere", "torus", "cone"],
)
def test_the_error_of_round_meshes_falls_with_the_square_of_the_resolution(shape, volume, polar) -> None:
    errors = []
    for n in (24, 48, 96):
        solid = moments(shape(n))
        errors.append((float(1 - solid.volume / F(volume)), float(1 - solid.inertia[2][2] / F(polar))))
    for coarse, fine in pairwise(errors):
        for index in range(2):
            assert np.log2(coarse[index] / fine[index]) == pytest.approx(2, abs=0.05)
