"""Cones, angles and constructions of free rotation, against the chapter's formulas and mpmath."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.dynamics.kinematics.geometry import binet, cones, momentum_angle, poinsot
from inertia.errors import GeometryError

moment = st.floats(0.5, 1)
component = st.floats(0.01, 1)
spin = st.tuples(component, component, component)


@settings(deadline=None)
@given(moment, moment, spin)
def test_cones_by_the_formulas_of_the_chapter(i1: float, i3: float, omega: tuple[float, ...]) -> None:
    """Textbook § 13.20, eq. 13.116, 13.129 and the one after 13.138, which is exercise 14 too."""
    pair = cones([i1, i1, i3], omega)
    speed = np.linalg.norm(omega)
    alpha = np.arccos(omega[2] / speed)
    precession = speed * np.sqrt(np.sin(alpha) ** 2 + (i3 / i1) ** 2 * np.cos(alpha) ** 2)
    assert pair.alpha == pytest.approx(alpha, abs=1e-12)
    assert np.tan(pair.theta) == pytest.approx(i1 / i3 * np.tan(pair.alpha), rel=1e-12)
    assert pair.precession == pytest.approx(precession, rel=1e-13)
    assert pair.precession == pytest.approx(speed * np.sqrt(1 + ((i3 / i1) ** 2 - 1) * np.cos(alpha) ** 2), rel=1e-12)
    assert pair.body_precession == pytest.approx((i3 - i1) * omega[2] / i1, rel=1e-14)


@settings(deadline=None)
@given(moment, moment, spin, st.sampled_from([1, -1]))
def test_the_body_cone_rolls_without_slipping(i1: float, i3: float, omega: tuple[float, ...], side: int) -> None:
    """The line of contact moves by as much on either cone: φ̇ sin(space) = |Ω| sin(body). ω, L and axis 3 are in one
    plane, ω between the others outside (prolate), L between them inside (oblate)."""
    pair = cones([i1, i1, i3], [omega[0], omega[1], side * omega[2]])
    on_space = pair.precession * np.sin(pair.space_half_angle)
    on_body = abs(pair.body_precession) * np.sin(pair.body_half_angle)
    assert on_space == pytest.approx(on_body, rel=1e-13)
    theta = min(pair.theta, np.pi - pair.theta)
    wider = {"outside": pair.space_half_angle, "inside": -pair.space_half_angle, "none": 0.0}[pair.rolling]
    assert theta == pytest.approx(pair.body_half_angle + wider, abs=1e-15)
    assert pair.rolling == ("outside" if i3 < i1 else "inside" if i3 > i1 else "none")


def test_feynmans_plate_wobbles_twice_while_it_spins_once() -> None:
    """A plate has I3 = I1 + I2 = 2 I1: as α → 0 the axis goes round L at 2 ω."""
    pair = cones([1, 1, 2], [1e-9, 0, 3.0])
    assert pair.precession / 3.0 == pytest.approx(2.0, rel=1e-15)
    assert pair.rolling == "inside"
    assert pair.theta == pytest.approx(0.5e-9 / 3, rel=1e-15)


def test_needle_and_plate_precess_slower_and_faster_than_they_spin() -> None:
    omega = [0.3, 0.4, 1.0]
    speed = np.linalg.norm(omega)
    assert cones([2, 2, 0.1], omega).precession < speed < cones([1, 1, 2], omega).precession
    assert cones([2, 2, 0.1], omega).body_precession < 0 < cones([1, 1, 2], omega).body_precession


def test_cones_of_many_spins_and_of_nearly_equal_moments() -> None:
    omega = np.random.default_rng(0).normal(size=(7, 3))
    assert cones([1, 1, 2], omega).theta.shape == (7,)
    assert cones([1 - 1e-7, 1 + 1e-7, 2], omega).theta == pytest.approx(cones([1, 1, 2], omega).theta, abs=1e-15)
    with pytest.raises(GeometryError, match="cones belong to a symmetric top with its symmetry axis last"):
        cones([1, 1.1, 2], omega)


@settings(deadline=None)
@given(moment, moment, moment, spin, st.floats(-12, 0))
def test_small_angles_between_spin_and_momentum_keep_their_digits(
    i1: float, i2: float, i3: float, omega: tuple[float, ...], exponent: float
) -> None:
    """Against acos(L·ω/(|L||ω|)) in 60 digits."""
    small = [10**exponent * omega[0], 10**exponent * omega[1], omega[2]]
    with mp.workdps(60):
        w = mp.matrix(small)
        l = mp.matrix([m * x for m, x in zip((i1, i2, i3), w, strict=True)])
        dot = sum(a * b for a, b in zip(l, w, strict=True))
        expected = mp.acos(min(mp.mpf(1), dot / (mp.norm(l) * mp.norm(w))))
    assert momentum_angle([i1, i2, i3], small) == pytest.approx(float(expected), rel=3e-15, abs=1e-29)


def test_exercise_6_a_rotor_and_its_momentum() -> None:
    """L is across the rod: at 90° − β off a spin at β to it, and 30° for that of the exercise."""
    beta = np.linspace(0.1, 3.0, 7)
    spins = np.stack([np.cos(beta), np.sin(beta), 0 * beta], axis=-1)
    assert momentum_angle([0, 3, 3], spins) == pytest.approx(np.abs(np.pi / 2 - beta), abs=1e-15)
    assert momentum_angle([0, 3, 3], [0.5, -0.5, np.sqrt(0.5)]) == pytest.approx(np.pi / 6, abs=1e-15)
    assert momentum_angle([0, 3, 3], [1, 0, 0]) == 0.0


def test_the_cones_and_the_sphere_of_a_rotor() -> None:
    pair = cones([3, 3, 0], [0.6, 0.0, 0.8])
    assert (pair.theta, pair.body_half_angle) == pytest.approx((np.pi / 2, np.arctan2(0.6, 0.8)), rel=1e-15)
    assert (pair.space_half_angle, pair.rolling) == (pytest.approx(np.arctan2(0.8, 0.6), rel=1e-15), "outside")
    assert (pair.precession, pair.body_precession) == pytest.approx((0.6, -0.8), rel=1e-15)
    figure = binet([3, 3, 0], [0.6, 0.0, 0.8])
    assert figure.semi_axes.tolist() == pytest.approx([1.8, 1.8, 0.0], rel=1e-15)
    assert figure.radius == pytest.approx(1.8, rel=1e-15)
    for figure_of in (cones, momentum_angle, binet):
        with pytest.raises(GeometryError, match="none may be negative, and one of them 0 at most"):
            figure_of([0, 0, 3], [1, 0, 0])
    with pytest.raises(GeometryError, match="all three must be positive"):
        poinsot([3, 3, 0], [1, 0, 0])


@pytest.mark.parametrize(("size", "speed"), [(1e-60, 1e-52), (1e200, 1e100), (1e-300, 1e-300), (1.0, 1e-160)])
def test_neither_size_nor_speed_of_a_body_changes_an_angle(size: float, speed: float) -> None:
    moments, omega = np.array([1.0, 1.0, 2.0]), np.array([0.3, -0.4, 1.0])
    plain, pair = cones(moments, omega), cones(size * moments, speed * omega)
    assert momentum_angle(size * moments, speed * omega) == pytest.approx(momentum_angle(moments, omega), rel=1e-14)
    assert pair.space_half_angle == pytest.approx(plain.space_half_angle, rel=1e-14)
    assert pair.precession == pytest.approx(speed * plain.precession, rel=1e-14)
    ellipsoid, there = poinsot(moments, omega), poinsot(size * moments, speed * omega)
    assert there.semi_axes == pytest.approx(speed * ellipsoid.semi_axes, rel=1e-14)
    assert there.distance == pytest.approx(speed * ellipsoid.distance, rel=1e-14)
    if size * speed > 1e-300:
        sphere, other = binet(moments, omega), binet(size * moments, speed * omega)
        assert other.semi_axes == pytest.approx(size * speed * sphere.semi_axes, rel=1e-14)
        assert other.radius == pytest.approx(size * speed * sphere.radius, rel=1e-14)


@settings(deadline=None)
@given(moment, moment, moment, spin)
def test_poinsots_ellipsoid_touches_the_invariable_plane_at_the_tip_of_the_spin(
    i1: float, i2: float, i3: float, omega: tuple[float, ...]
) -> None:
    figure = poinsot([i1, i2, i3], omega)
    assert np.sum((figure.contact / figure.semi_axes) ** 2) == pytest.approx(1.0, rel=1e-14)
    support = np.linalg.norm(figure.semi_axes * figure.normal)  # distance of the tangent plane with this normal
    assert figure.distance == pytest.approx(support, rel=1e-14)
    assert figure.contact @ figure.normal == pytest.approx(figure.distance, rel=1e-14)
    assert np.linalg.norm(figure.normal) == pytest.approx(1.0, rel=1e-15)


@settings(deadline=None)
@given(moment, moment, moment, spin)
def test_binets_ellipsoid_meets_the_sphere_at_the_momentum(
    i1: float, i2: float, i3: float, omega: tuple[float, ...]
) -> None:
    figure = binet([i1, i2, i3], omega)
    assert figure.momentum == pytest.approx(np.array([i1, i2, i3]) * omega, rel=1e-15)
    assert np.sum((figure.momentum / figure.semi_axes) ** 2) == pytest.approx(1.0, rel=1e-14)
    assert np.linalg.norm(figure.momentum) == pytest.approx(figure.radius, rel=1e-15)
    assert figure.semi_axes.min() * (1 - 1e-14) <= figure.radius <= figure.semi_axes.max() * (1 + 1e-14)


@pytest.mark.parametrize("figure", [poinsot, binet])
def test_a_body_at_rest_has_no_construction(figure) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(GeometryError, match="the body has no angular momentum"):
        figure([1, 2, 3], [0, 0, 0])
