"""Derivatives of the final attitude, against closed forms and against differences of a motion with thirty digits."""

from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from tests.dynamics.oracle import rotate
from tests.dynamics.scenes import PLAIN, TOP, scene, table

import inertia
from inertia.dynamics.sensitivity import ELEMENTS, sensitivity
from inertia.errors import GeometryError, UsageError
from inertia_meshes import path


def cross(v: Any) -> np.ndarray:
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def test_a_sphere_turns_by_its_spin_times_the_time() -> None:
    # R = exp(ω× T), whose derivative is the left Jacobian of the rotation vector ω T.
    omega, time = np.array([0.3, -0.5, 0.9]), 7.0
    derivative = sensitivity(
        scene(body={"principal_moments": [2, 2, 2]}, start__angular_velocity=omega.tolist(), run__duration=time)
    )
    angle = float(np.linalg.norm(omega)) * time
    n = omega * time / angle
    jacobian = np.sin(angle) / angle * np.eye(3) + (1 - np.sin(angle) / angle) * np.outer(n, n)
    jacobian += (1 - np.cos(angle)) / angle * cross(n)
    np.testing.assert_allclose(derivative.angular_velocity, time * jacobian, atol=1e-6)
    np.testing.assert_allclose(derivative.inertia[:, :3] @ np.ones(3), 0, atol=1e-6)  # all moments alike


def test_the_axis_of_a_symmetric_top_precesses_at_its_momentum_over_its_moment() -> None:
    # R = exp(L× T/I) exp(e× β T), β = (1 − I3/I) ω3: differences of this product with fifty digits.
    spin, time = [0.5, 0.2, 3.0], 4.0
    body = scene(body={"principal_moments": [1, 1, 1.5]}, start__angular_velocity=spin, run__duration=time)
    derivative = sensitivity(body)

    def attitude(across: Any, along: Any, omega: list[Any]) -> Any:
        momentum = mp.matrix([across * omega[0], across * omega[1], along * omega[2]])
        x, y, z = (k * time / across for k in momentum)
        turn = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        own = (1 - along / across) * omega[2] * time
        return mp.expm(turn) * mp.matrix([[mp.cos(own), -mp.sin(own), 0], [mp.sin(own), mp.cos(own), 0], [0, 0, 1]])

    with mp.workdps(50):
        h = mp.mpf(10) ** -20
        inputs = [mp.mpf(1), mp.mpf(1.5), *map(mp.mpf, spin)]
        start = attitude(*inputs[:2], inputs[2:])
        slopes = []
        for k in range(5):
            moved = [value + h * (k == n) for n, value in enumerate(inputs)]
            turn = (attitude(*moved[:2], moved[2:]) * start.T - mp.eye(3)) / h
            slopes.append([float(turn[2, 1]), float(turn[0, 2]), float(turn[1, 0])])
    across, along, *by_spin = np.array(slopes)
    np.testing.assert_allclose(derivative.inertia[:, 0] + derivative.inertia[:, 1], across, atol=1e-5)
    np.testing.assert_allclose(derivative.inertia[:, 2], along, atol=1e-5)
    np.testing.assert_allclose(derivative.angular_velocity, np.array(by_spin).T, atol=1e-5)
    np.testing.assert_allclose(derivative.attitude, np.eye(3), atol=1e-7)


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_a_heavy_body_that_is_stepped_against_differences_in_thirty_digits(damping: float) -> None:
    moments, spin, quaternion = [1.0, 1.25, 0.5], [0.1, 0.3, 10.0], [0.6, 0.0, 0.0, 0.8]
    mass, height, time = 3.0, 0.2, 0.5
    loads: list[dict[str, Any]] = [{"kind": "gravity"}]
    if damping:
        loads.append({"kind": "damping", "coefficient": damping})
    derivative = sensitivity(
        scene(
            body={"principal_moments": moments, "mass": mass, "center_of_mass": [0, 0, height]},
            start={"angular_velocity": spin, "attitude": quaternion},
            constraint={"kind": "fixed_point"},
            load=loads,
            run__duration=time,
        )
    )

    def end(changes: list[Fraction]) -> Any:
        exact = [Fraction(k) for k in (*moments, mass, height, *spin)]
        a, b, c, m, z, *w = (k + d for k, d in zip(exact, changes, strict=True))
        about = [a + m * z * z, b + m * z * z, c]
        answer = rotate(
            about,  # type: ignore[arg-type]
            w,  # type: ignore[arg-type]
            [time],
            attitude=quaternion,
            mass=m,  # type: ignore[arg-type]
            offset=(0, 0, z),  # type: ignore[arg-type]
            gravity=(0, 0, -9.80665),
            damping=damping,
            digits=24,
        )
        return answer.attitude[0]

    h = Fraction(1, 10**12)
    slopes = []
    for k in range(8):
        plus, minus = (end([sign * h * (k == n) for n in range(8)]) for sign in (1, -1))
        with mp.workdps(50):
            (px, py, pz, pw), (x, y, z, w) = plus, minus
            turn = [
                w * px - x * pw + y * pz - z * py,
                w * py - y * pw + z * px - x * pz,
                w * pz - z * pw + x * py - y * px,
            ]
            slopes.append([float(t * 10**12) for t in turn])  # θ = 2 (p q*), over 2 h
    columns = np.array(slopes).T
    np.testing.assert_allclose(derivative.inertia[:, :3], columns[:, :3], atol=2e-5)
    np.testing.assert_allclose(derivative.mass, columns[:, 3], atol=2e-5)
    np.testing.assert_allclose(derivative.center_of_mass[:, 2], columns[:, 4], atol=2e-5)
    np.testing.assert_allclose(derivative.angular_velocity, columns[:, 5:], atol=2e-5)


def test_a_turn_about_the_vertical_is_carried_along() -> None:
    np.testing.assert_allclose(sensitivity(scene(TOP)).attitude[:, 2], [0, 0, 1], atol=1e-7)


def test_a_flat_body_is_compared_with_thicker_ones_only() -> None:
    flat = sensitivity(scene(body={"principal_moments": [1, 2, 3]}))
    thick = sensitivity(scene(body={"principal_moments": [1, 2, 2.9999]}))
    np.testing.assert_allclose(flat.inertia, thick.inertia, atol=0.02)


def test_what_a_part_is_uncertain_by_becomes_an_uncertainty_of_its_attitude() -> None:
    # A density that is 1 % off makes all moments 1 % off: a free body does not feel it; a heavy one neither.
    part = inertia.read(path("t_handle.stl"), unit="mm")
    analysis = inertia.analyse(part, density=inertia.Estimate(7850.0, 78.5))
    run = inertia.simulate(
        inertia.Scene(inertia.SceneBody.of_analysis(analysis), inertia.Start([1, 2, 3]), inertia.Settings(1.0, 2))
    )
    assert analysis.uncertainty is not None
    assert sensitivity(run).standard_uncertainty(analysis.uncertainty.covariance).max() < 1e-6
    alone = np.zeros((11, 11))
    alone[5, 5] = (0.01 * run.scene.body.inertia[0, 0]) ** 2
    moved = sensitivity(run).inertia[:, ELEMENTS.index((0, 0))] * 0.01 * run.scene.body.inertia[0, 0]
    np.testing.assert_allclose(sensitivity(run).standard_uncertainty(alone), np.abs(moved))


def test_what_has_no_derivative_is_refused() -> None:
    with pytest.raises(UsageError, match="of the kind 'rolling'"):
        sensitivity(inertia.Scene.load(path("scenes/rolling_disc.toml")))
    with pytest.raises(UsageError, match="changes its shape"):
        sensitivity(inertia.Scene.load(path("scenes/cat.toml")))
    with pytest.raises(UsageError, match="simulate"):
        sensitivity(table(PLAIN))  # type: ignore[arg-type]
    upright = scene(TOP, start={"angular_velocity": [0, 0, 1.0]}, run__duration=20.0)
    with pytest.raises(GeometryError, match=r"part too far|does not reach"):
        sensitivity(upright)
