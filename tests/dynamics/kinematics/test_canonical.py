"""Energies and momenta, against sums over point masses and derivatives of the chapter's Lagrangian in mpmath."""

from typing import get_args

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.dynamics.kinematics import canonical
from inertia.dynamics.kinematics.euler_angles import Convention, angular_velocity
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import point_inertia

MOMENTS = [1.0, 2.0, 2.5]
CONVENTIONS = get_args(Convention)
number = st.floats(-3, 3)
three = st.tuples(number, number, number)
regular = st.tuples(number, st.floats(0.2, 1.2), number)  # θ far from 0, π/2 and π


def energy_of_the_chapter(angles, rates, moments=MOMENTS):  # type: ignore[no-untyped-def]
    """Textbook § 13.15, in mpmath."""
    _, t, s = angles
    df, dt, ds = rates
    w1 = df * mp.sin(t) * mp.sin(s) + dt * mp.cos(s)
    w2 = df * mp.sin(t) * mp.cos(s) - dt * mp.sin(s)
    w3 = df * mp.cos(t) + ds
    return (moments[0] * w1**2 + moments[1] * w2**2 + moments[2] * w3**2) / 2


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_kinetic_energy_about_any_point_is_the_sum_over_point_masses(seed: int) -> None:
    rng = np.random.default_rng(seed)
    masses, places = rng.uniform(0.1, 1, 6), rng.normal(size=(6, 3))
    point, velocity, omega = rng.normal(size=(3, 3))
    speeds = velocity + np.cross(omega, places - point)
    expected = 0.5 * masses @ np.sum(speeds**2, axis=1)
    tensor = sum(point_inertia(m, place - point) for m, place in zip(masses, places, strict=True))
    lever = masses @ places / masses.sum() - point
    energy = canonical.kinetic_energy(tensor, masses.sum(), lever, velocity, omega)
    assert energy.total == pytest.approx(expected, abs=1e-13 * (energy.translation + energy.rotation))
    assert energy.translation == pytest.approx(0.5 * masses.sum() * velocity @ velocity, rel=1e-14)


def test_the_cross_term_vanishes_at_the_centre_of_mass_and_at_rest_only() -> None:
    terms = [([0, 0, 0], [1, 2, 3]), ([1, 0, 0], [0, 0, 0]), ([1, 0, 0], [0, 2, 0])]
    crosses = [canonical.kinetic_energy(np.eye(3), 2.0, lever, v, [0, 0, 5]).cross for lever, v in terms]
    assert [float(cross) for cross in crosses] == [0.0, 0.0, 20.0]


@settings(deadline=None)
@given(three, three)
def test_rotational_energy_is_that_of_the_chapter(angles: tuple[float, ...], rates: tuple[float, ...]) -> None:
    expected = float(energy_of_the_chapter(angles, rates))
    assert canonical.rotational_energy(MOMENTS, angles, rates) == pytest.approx(expected, rel=1e-13, abs=1e-15)


@settings(deadline=None)
@given(three, three)
def test_squared_speed_is_the_sum_of_squares_and_twice_a_product(
    angles: tuple[float, ...], rates: tuple[float, ...]
) -> None:
    (_, t, _), (df, dt, ds) = angles, rates
    size = 4e-15 * (df**2 + dt**2 + ds**2) + 1e-300
    for convention, cosine in (("z-x-z", np.cos(t)), ("z-y-z", np.cos(t)), ("x-y-z", np.sin(t))):
        expected = df**2 + dt**2 + ds**2 + 2 * df * ds * cosine
        assert canonical.squared_speed(angles, rates, convention) == pytest.approx(expected, abs=size)  # type: ignore[arg-type]


@settings(deadline=None, max_examples=30)
@given(three, three)
def test_momenta_are_derivatives_of_the_lagrangian(angles: tuple[float, ...], rates: tuple[float, ...]) -> None:
    expected = []
    for k in range(3):

        def along(x: mp.mpf, k: int = k) -> mp.mpf:
            return energy_of_the_chapter(angles, [x if j == k else rates[j] for j in range(3)])

        expected.append(float(mp.diff(along, rates[k])))
    momenta_there = canonical.momenta_of_rates(MOMENTS, angles, rates)
    assert momenta_there == pytest.approx(expected, abs=1e-13)


@settings(deadline=None)
@given(st.sampled_from(CONVENTIONS), st.sampled_from(["body", "space"]), regular, three)
def test_momenta_and_angular_momentum_are_one_another_s_inverse(
    convention: Convention, frame: str, angles: tuple[float, ...], momentum: tuple[float, ...]
) -> None:
    p = canonical.momenta(angles, momentum, convention, frame)
    again = canonical.angular_momentum(angles, p, convention, frame)
    assert again == pytest.approx(momentum, abs=1e-13)
    assert canonical.squared_angular_momentum(angles, p, convention) == pytest.approx(
        np.dot(momentum, momentum), abs=1e-12
    )


@settings(deadline=None)
@given(regular, three)
def test_squared_angular_momentum_in_the_chapters_momenta(angles: tuple[float, ...], p: tuple[float, ...]) -> None:
    """L² = p_θ² + p_ψ² + (p_φ − p_ψ cosθ)²/sin²θ for z-x-z."""
    t = angles[1]
    expected = p[1] ** 2 + p[2] ** 2 + ((p[0] - p[2] * np.cos(t)) / np.sin(t)) ** 2
    assert canonical.squared_angular_momentum(angles, p) == pytest.approx(expected, rel=1e-12)


@settings(deadline=None)
@given(st.sampled_from(CONVENTIONS), regular, three, number)
def test_hamiltonian_is_the_legendre_transform_of_the_lagrangian(
    convention: Convention, angles: tuple[float, ...], rates: tuple[float, ...], potential: float
) -> None:
    p = canonical.momenta_of_rates(MOMENTS, angles, rates, convention)
    lagrangian = canonical.lagrangian(MOMENTS, angles, rates, potential, convention)
    hamiltonian = canonical.hamiltonian(MOMENTS, angles, p, potential, convention)
    assert hamiltonian == pytest.approx(p @ np.array(rates) - lagrangian, abs=1e-12)


def test_momenta_and_hamiltonian_of_a_symmetric_top_by_the_formulas_of_the_chapter() -> None:
    """Textbook § 13.20 and 13.23: p_φ = (I1 sin²θ + I3 cos²θ) φ̇ + I3 ψ̇ cosθ, …"""
    i1, i3 = 2.0, 0.7
    angles, rates = [0.4, 1.1, -0.8], [1.5, -0.3, 20.0]
    c, s = np.cos(angles[1]), np.sin(angles[1])
    p_phi = (i1 * s**2 + i3 * c**2) * rates[0] + i3 * rates[2] * c
    p_psi = i3 * (rates[0] * c + rates[2])
    p = canonical.momenta_of_rates([i1, i1, i3], angles, rates)
    assert p == pytest.approx([p_phi, i1 * rates[1], p_psi], rel=1e-14)
    expected = p[1] ** 2 / (2 * i1) + (p_phi - p_psi * c) ** 2 / (2 * i1 * s**2) + p_psi**2 / (2 * i3) + 5.0
    assert canonical.hamiltonian([i1, i1, i3], angles, p, 5.0) == pytest.approx(expected, rel=1e-14)


def test_hamiltons_equations_are_eulers() -> None:
    """∂H/∂p gives the rates; −∂H/∂φ = 0 and −∂H/∂ψ = (I1 − I2) ω1 ω2, as Euler's equation for axis 3 has it."""
    angles, rates = np.array([0.3, 0.9, 0.5]), np.array([0.6, -0.5, 0.8])
    p = canonical.momenta_of_rates(MOMENTS, angles, rates)
    steps = 1e-4 * np.eye(3)
    by_momentum = [
        canonical.hamiltonian(MOMENTS, angles, p + h) - canonical.hamiltonian(MOMENTS, angles, p - h) for h in steps
    ]
    assert np.array(by_momentum) / 2e-4 == pytest.approx(rates, abs=1e-11)
    by_angle = [
        canonical.hamiltonian(MOMENTS, angles + h, p) - canonical.hamiltonian(MOMENTS, angles - h, p) for h in steps
    ]
    w1, w2, _ = angular_velocity(angles, rates)
    assert by_angle[0] == pytest.approx(0.0, abs=1e-14)
    assert -by_angle[2] / 2e-4 == pytest.approx((MOMENTS[0] - MOMENTS[1]) * w1 * w2, abs=1e-7)


def test_momenta_at_a_singular_attitude_are_given_but_not_inverted() -> None:
    p = canonical.momenta([0.3, 0.0, 0.2], [1.0, 2.0, 3.0])
    assert p[0] == p[2] == 3.0
    with pytest.raises(GeometryError, match=r"^angles are singular .* do not determine L"):
        canonical.hamiltonian(MOMENTS, [0.3, 0.0, 0.2], p)


def test_runs_of_many_samples_are_the_samples_one_by_one() -> None:
    angles, rates = np.random.default_rng(5).uniform(0.3, 1.2, (2, 50, 3))
    together = canonical.momenta_of_rates(MOMENTS, angles, rates)
    one_by_one = [canonical.momenta_of_rates(MOMENTS, a, r) for a, r in zip(angles, rates, strict=True)]
    assert together == pytest.approx(np.array(one_by_one), rel=1e-15)
    assert canonical.lagrangian(MOMENTS, angles, rates, np.arange(50.0)).shape == (50,)


def test_a_rotor_has_energies_and_momenta_but_no_hamiltonian() -> None:
    """About its own axis it has no moment: p_ψ = 0, p_φ = I sin²θ φ̇, 2T = I (sin²θ φ̇² + θ̇²)."""
    angles, rates, moment = [0.3, 0.7, -1.1], [1.5, -0.4, 9.0], 2.5
    across = np.sin(0.7) * 1.5
    energy = 0.5 * moment * (across**2 + 0.4**2)
    assert canonical.rotational_energy([moment, moment, 0], angles, rates) == pytest.approx(energy, rel=1e-14)
    assert canonical.lagrangian([moment, moment, 0], angles, rates, 1.0) == pytest.approx(energy - 1.0, rel=1e-14)
    momenta = canonical.momenta_of_rates([moment, moment, 0], angles, rates)
    assert momenta == pytest.approx([moment * np.sin(0.7) * across, -0.4 * moment, 0.0], abs=1e-14)
    with pytest.raises(GeometryError, match="all three must be positive"):
        canonical.hamiltonian([moment, moment, 0], angles, momenta)


def test_unusable_arguments_are_named() -> None:
    with pytest.raises(UsageError, match=r"inertia has shape \(3,\)"):
        canonical.kinetic_energy([1, 2, 3], 1.0, [0, 0, 0], [0, 0, 0], [0, 0, 1])
    with pytest.raises(GeometryError, match=r"moments\[1\] are \[1.0, -2.0, 3.0\] kg m²: none may be negative"):
        canonical.rotational_energy([[1, 2, 3], [1, -2, 3]], [0, 0, 0], [1, 1, 1])
