"""Euler angles and rates, against products of elementary turns and their derivatives in mpmath."""

import itertools
import math
from typing import get_args

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import (
    Convention,
    angular_velocity,
    direction_cosines,
    from_angles,
    is_singular,
    rates,
    to_angles,
    unwrap,
)
from inertia.errors import GeometryError, UsageError

CONVENTIONS = get_args(Convention)
PROPER = ["z-x-z", "z-y-z"]
angle = st.floats(-3.14, 3.14)
component = st.floats(-1, 1)


def middle(convention: str) -> float:
    """Return the θ in the middle of its range, as far from both singular attitudes as can be."""
    return 0.0 if convention == "x-y-z" else 0.5 * math.pi


def pole(convention: str, opposite: bool) -> float:
    return middle(convention) + (0.5 * math.pi if (convention == "x-y-z") != opposite else -0.5 * math.pi)


def elementary(axis: str, turn: mp.mpf) -> mp.matrix:
    """Return the matrix that takes components to those along axes turned by `turn`: the chapter's λφ, λθ, λψ."""
    p, q = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = mp.eye(3)
    matrix[p, p] = matrix[q, q] = mp.cos(turn)
    matrix[p, q], matrix[q, p] = mp.sin(turn), -mp.sin(turn)
    return matrix


def cosines(angles: list[mp.mpf], convention: str) -> mp.matrix:
    turns = [elementary(axis, turn) for axis, turn in zip(convention.split("-"), angles, strict=True)]
    return turns[2] * turns[1] * turns[0]


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_direction_cosines_are_the_product_of_three_elementary_turns(convention: Convention) -> None:
    rng = np.random.default_rng(1)
    for angles in rng.uniform(-3, 3, (20, 3)):
        expected = cosines([mp.mpf(a) for a in angles.tolist()], convention)
        assert direction_cosines(angles, convention) == pytest.approx(
            np.array(expected.tolist(), dtype=float), abs=1e-15
        )


@settings(deadline=None)
@given(st.sampled_from(CONVENTIONS), angle, st.floats(-1.5, 1.5), angle)
def test_angles_come_back_from_their_attitude(convention: Convention, phi: float, theta: float, psi: float) -> None:
    angles = np.array([phi, middle(convention) + theta, psi])
    sharpness = 1 / math.cos(theta)  # one rounding of the attitude moves φ and ψ by that much
    angles_again = to_angles(from_angles(angles, convention), convention)
    assert angles_again == pytest.approx(angles, abs=2e-15 * sharpness)


@settings(deadline=None)
@given(st.sampled_from(PROPER), angle, st.floats(-14, 0), angle)
def test_angles_close_to_parallel_axes_keep_all_their_digits(
    convention: Convention, phi: float, exponent: float, psi: float
) -> None:
    angles = np.array([phi, 10.0**exponent, psi])
    assert to_angles(from_angles(angles, convention), convention) == pytest.approx(angles, rel=4e-15, abs=2e-15)


@settings(deadline=None)
@given(st.sampled_from(CONVENTIONS), st.lists(component, min_size=4, max_size=4))
def test_any_attitude_comes_back_from_its_angles(convention: Convention, numbers: list[float]) -> None:
    assume(np.linalg.norm(numbers) > 1e-3)
    attitude = quaternion.normalise(np.array(numbers))
    again = from_angles(to_angles(attitude, convention), convention)
    assert quaternion.angle_between(attitude, again) < 3e-15


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_theta_and_the_other_angles_keep_to_their_ranges(convention: Convention) -> None:
    attitudes = quaternion.normalise(np.random.default_rng(2).normal(size=(5000, 4)))
    phi, theta, psi = to_angles(attitudes, convention).T
    assert np.abs(theta - middle(convention)).max() <= 0.5 * math.pi
    assert max(np.abs(phi).max(), np.abs(psi).max()) <= math.pi


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("opposite", [False, True])
def test_phi_carries_all_at_a_singular_attitude(convention: Convention, opposite: bool) -> None:
    theta = pole(convention, opposite)
    attitude = from_angles([0.4, theta, 0.7], convention)
    angles_again = to_angles(attitude, convention)
    assert angles_again == pytest.approx([0.4 - 0.7 if opposite else 0.4 + 0.7, theta, 0.0], abs=1e-15)
    assert is_singular(angles_again, convention)
    assert quaternion.angle_between(attitude, from_angles(angles_again, convention)) < 1e-15
    assert not is_singular([0.4, theta + 1e-12, 0.7], convention)


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_angular_velocity_is_the_derivative_of_the_attitude(convention: Convention) -> None:
    """(dλ/dt) λᵀ is −ω× along body axes, λᵀ dλ/dt along space axes."""
    rng = np.random.default_rng(3)
    for angles, speeds in rng.uniform(-3, 3, (10, 2, 3)):

        def at(t: mp.mpf, angles: np.ndarray = angles, speeds: np.ndarray = speeds) -> mp.matrix:
            return cosines([a + r * t for a, r in zip(angles.tolist(), speeds.tolist(), strict=True)], convention)

        rate = mp.matrix(3, 3)
        for i, j in itertools.product(range(3), repeat=2):
            rate[i, j] = mp.diff(lambda t, i=i, j=j: at(t)[i, j], 0)
        for frame, skew in (("body", rate * at(0).T), ("space", at(0).T * rate)):
            expected = [float(skew[1, 2]), float(skew[2, 0]), float(skew[0, 1])]
            assert angular_velocity(angles, speeds, convention, frame) == pytest.approx(expected, abs=1e-14)


def test_angular_velocity_by_the_formulas_of_the_chapter() -> None:
    """Textbook eq. 13.86–91."""
    (f, t, s), (df, dt, ds) = angles, speeds = np.array([[0.3, 1.1, -2.0], [0.7, -0.2, 5.0]])
    body = [
        df * np.sin(t) * np.sin(s) + dt * np.cos(s),
        df * np.sin(t) * np.cos(s) - dt * np.sin(s),
        df * np.cos(t) + ds,
    ]
    space = [
        dt * np.cos(f) + ds * np.sin(t) * np.sin(f),
        dt * np.sin(f) - ds * np.sin(t) * np.cos(f),
        df + ds * np.cos(t),
    ]
    assert angular_velocity(angles, speeds) == pytest.approx(body, abs=1e-15)
    assert angular_velocity(angles, speeds, frame="space") == pytest.approx(space, abs=1e-15)


@settings(deadline=None)
@given(
    st.sampled_from(CONVENTIONS),
    st.sampled_from(["body", "space"]),
    st.floats(-1.5, 1.5),
    st.lists(component, min_size=5, max_size=5),
)
def test_rates_come_back_from_the_angular_velocity(
    convention: Convention, frame: str, theta: float, numbers: list[float]
) -> None:
    angles = np.array([3 * numbers[0], middle(convention) + theta, 3 * numbers[1]])
    speeds = np.array(numbers[2:])
    omega = angular_velocity(angles, speeds, convention, frame)
    assert rates(angles, omega, convention, frame) == pytest.approx(speeds, abs=3e-15 / math.cos(theta))


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize(("opposite", "sign"), [(False, "+"), (True, "−")])
def test_rates_at_a_singular_attitude_are_refused_by_sample_or_merged(
    convention: Convention, opposite: bool, sign: str
) -> None:
    singular = [0.4, pole(convention, opposite), 0.7]
    angles = [[0.4, 0.5, 0.6], singular, singular]
    speeds = np.array([3.0, 0.25, 2.0])
    omega = angular_velocity(angles, speeds, convention)
    with pytest.raises(GeometryError, match=r"^angles\[1\] are singular .*only φ̇ ± ψ̇ is defined"):
        rates(angles, omega, convention)
    merged = rates(angles, omega, convention, merge=True)
    total = 5.0 if sign == "+" else 1.0
    assert merged == pytest.approx(np.array([speeds, [total, 0.25, 0.0], [total, 0.25, 0.0]]), abs=1e-14)
    in_space = angular_velocity(angles, speeds, convention, "space")
    assert rates(angles, in_space, convention, "space", merge=True) == pytest.approx(merged, abs=1e-14)


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_unwrapped_angles_follow_many_turns(convention: Convention) -> None:
    t = np.linspace(0, 20, 401)
    path = np.stack([0.3 + 7 * t, middle(convention) + np.sin(t), 1 - 9 * t + np.cos(3 * t)], axis=-1)
    path[:, ::2] -= 2 * np.pi * np.round(path[0, ::2] / (2 * np.pi))
    angles_again = unwrap(to_angles(from_angles(path, convention), convention), convention)
    assert angles_again == pytest.approx(path, abs=1e-13)


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("opposite", [False, True])
def test_what_a_singular_attitude_defines_stays_continuous_near_it(convention: Convention, opposite: bool) -> None:
    """The axis of ψ sweeps past that of φ at 1e-3 rad while the body spins: φ and ψ each change by ±π within a step."""
    t = np.linspace(-1, 1, 201)
    spin = from_angles(np.stack([0 * t, 0 * t, 2.9 + 4 * t], axis=-1), convention)
    close = from_angles(
        [0.5, 0.999 * (pole(convention, opposite) - middle(convention)) + middle(convention), 0.0], convention
    )
    sweep = quaternion.from_rotation_vector(np.outer(t, [0.3, 0.4, 0.0] if convention != "x-y-z" else [0.0, 0.3, 0.4]))
    attitudes = quaternion.multiply(quaternion.multiply(sweep, close), spin)
    angles = unwrap(to_angles(attitudes, convention), convention)
    defined = angles[:, 0] + (-1 if opposite else 1) * angles[:, 2]
    assert np.abs(np.diff(defined)).max() < 0.1
    assert np.abs(defined[-1] - defined[0]) == pytest.approx(8.0, abs=0.1)


def test_exercise_2_direction_cosines_and_angles() -> None:
    """Rows (1, 1, −2)/√6, (−1, 1, 0)/√2, (1, 1, 1)/√3.

    cosθ = λ33 = 1/√3; (sinφ, −cosφ) sinθ = (λ31, λ32) = (1, 1)/√3, so φ = 135°;
    (sinψ, cosψ) sinθ = (λ13, λ23) = (−2/√6, 0), so ψ = −90°.
    """
    rows = np.array([[1, 1, -2] / np.sqrt(6), [-1, 1, 0] / np.sqrt(2), [1, 1, 1] / np.sqrt(3)])
    angles = to_angles(quaternion.from_matrix(rows.T))
    assert angles == pytest.approx([3 * np.pi / 4, np.arccos(1 / np.sqrt(3)), -np.pi / 2], abs=1e-15)
    assert direction_cosines(angles) == pytest.approx(rows, abs=1e-15)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: from_angles([0, 0, 0], "x-z-x"), "the convention is 'x-z-x': it must be one of z-x-z, z-y-z, x-y-z"),
        (
            lambda: angular_velocity([0, 1, 0], [1, 2, 3], frame="rotor"),
            "frame is 'rotor': it must be 'body' or 'space'",
        ),
        (lambda: from_angles([[0, 0, 0], [0, np.nan, 0]]), r"angles\[1\] holds a value that is not finite"),
        (lambda: to_angles([0, 0, 1]), r"attitude has shape \(3,\): its last axis must hold 4 components"),
        (lambda: rates([0, 1, 0], ["a", 0, 0]), "omega must be numbers"),
        (lambda: unwrap([0, 1, 0]), "unwrap takes one run of samples"),
    ],
)
def test_unusable_arguments_are_named(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(UsageError, match=message):
        call()
