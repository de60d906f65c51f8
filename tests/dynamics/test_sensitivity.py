"""Derivatives of the final attitude, against closed forms and against differences of a motion with thirty digits."""

from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from tests.dynamics.extrapolation import follow
from tests.dynamics.models.deforming.particles import DIGITS, Swarm
from tests.dynamics.models.sliding.test_sliding import TOP as SLIDING
from tests.dynamics.models.sliding.test_sliding import newton_and_euler
from tests.dynamics.oracle import rotate
from tests.dynamics.scenes import PLAIN, TOP, scene, table

import inertia
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart
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


CHANGE: dict[str, Any] = {
    "tensor": np.array([[0.3, 0.1, -0.2], [0.1, -0.2, 0.15], [-0.2, 0.15, 0.25]]),
    "center": np.array([0.5, -0.3, 0.2]),
    "mass": 0.7,
}
"""Of all mass properties at once, in units of their size: one derivative along it looks at every column."""


def along(derivative: Any, tensor: float, length: float, mass: float) -> np.ndarray:
    """Return ∂θ along `CHANGE`, for a body of this size."""
    elements = np.array([CHANGE["tensor"][i, j] for i, j in ELEMENTS])
    return np.asarray(
        derivative.inertia @ elements * tensor
        + derivative.center_of_mass @ CHANGE["center"] * length
        + derivative.mass * CHANGE["mass"] * mass
    )


def difference(plus: Any, minus: Any, step: Any) -> np.ndarray:
    """Return θ (3,) over 2 h between two attitudes."""
    plus, minus = ([k / mp.norm(list(q)) for k in q] for q in (plus, minus))
    (px, py, pz, pw), (x, y, z, w) = plus, minus
    turn = [w * px - x * pw + y * pz - z * py, w * py - y * pw + z * px - x * pz, w * pz - z * pw + x * py - y * px]
    return np.array([float(t / step) for t in turn])


def rolled(figures: Any, time: float, start: list[float], spin: list[float]) -> Any:
    """Return the attitude at the end of a body that rolls: Newton and Euler along the axes of space, by mpmath.

    Numbers stand behind arrays: mpmath takes an array behind a number for text first.
    """
    tensor, middle, mass, radius = figures
    up, weight = np.array([0, 0, 1]), mp.mpf(9.80665)

    def turn(q: Any) -> Any:
        x, y, z, w = np.array(q) / mp.norm(q)
        v = np.array([x, y, z])
        return np.eye(3, dtype=int) * (w * w - v @ v) + 2 * np.outer(v, v) + cross(v) * (2 * w)

    def rate(_: Any, state: list[Any]) -> list[Any]:
        q, omega = state[:4], np.array(state[4:])
        rotation = turn(q)
        about, axis = rotation @ tensor @ rotation.T, rotation[:, 2]
        leaning = cross(omega) @ axis
        across, changing = up - axis * axis[2], -axis * leaning[2] - leaning * axis[2]
        size = mp.sqrt(across @ across)
        direction = across / size
        arm = rotation @ middle - radius * direction
        swing = (changing - direction * (direction @ changing)) / size
        arm_rate = cross(omega) @ (rotation @ middle) - radius * swing
        inertia_there = about + (np.eye(3, dtype=int) * (arm @ arm) - np.outer(arm, arm)) * mass
        torque = cross(arm) @ (up * weight - cross(omega) @ arm_rate) * mass - cross(omega) @ (about @ omega)
        x, y, z, w = q
        a, b, c = omega
        slope = [w * a - y * c + z * b, w * b - z * a + x * c, w * c - x * b + y * a, -(x * a + y * b + z * c)]
        one, two, three = inertia_there
        columns = np.array([cross(two) @ three, cross(three) @ one, cross(one) @ two])
        return [*(k / 2 for k in slope), *(torque @ columns / (one @ columns[0]))]

    spinning = turn([mp.mpf(k) for k in start]) @ [mp.mpf(k) for k in spin]
    return follow(rate, [*start, *spinning], [time], 0.05)[0][:4]


@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_a_disc_that_rolls_against_differences_with_any_tensor(offset: float) -> None:
    moments, start, spin, time = [0.3, 0.3, 0.5], [0.5, 0.1, 0.2, 0.8], [0.4, 1.0, -2.0], 0.25
    start = (np.array(start) / np.linalg.norm(start)).tolist()
    held = {"kind": "rolling", "radius": 1.0, "axis": [0, 0, 1], "offset": offset}
    derivative = sensitivity(
        scene(
            body={"principal_moments": moments, "mass": 1.5},
            start={"angular_velocity": spin, "attitude": start, "frame": "part"},
            constraint=held,
            load=[{"kind": "gravity"}],
            run__duration=time,
        )
    )
    with mp.workdps(24):
        step, ends = mp.mpf(10) ** -7, []
        for sign in (1, -1):
            tensor = np.diag(moments) + CHANGE["tensor"] * (sign * step)
            middle = np.array([0, 0, offset]) - CHANGE["center"] * (sign * step)
            ends.append(rolled((tensor, middle, mp.mpf(1.5) + sign * step * CHANGE["mass"], 1), time, start, spin))
        expected = difference(*ends, step)
    np.testing.assert_allclose(along(derivative, 1.0, 1.0, 1.0), expected, atol=1e-6)
    np.testing.assert_allclose(derivative.attitude[:, 2], [0, 0, 1], atol=1e-7)


def test_a_ball_that_slides_against_differences() -> None:
    size = 2e-6
    made = table(SLIDING, run__duration=0.03)
    derivative = sensitivity(inertia.Scene.from_dict(made))
    mass, arm = made["body"]["mass"], np.array(made["body"]["center_of_mass"])
    diagonal = np.diag(np.diag(CHANGE["tensor"]))
    with mp.workdps(26):
        step, ends = 1e-6, []
        for sign in (1, -1):
            body = {
                "principal_moments": (
                    np.array(made["body"]["principal_moments"]) + sign * step * size * np.diag(diagonal)
                ),
                "center_of_mass": arm + sign * step * 0.01 * CHANGE["center"],
                "mass": mass * (1 + sign * step * CHANGE["mass"]),
            }
            there = inertia.Scene.from_dict(made | {"body": {k: np.asarray(v).tolist() for k, v in body.items()}})
            rate, start = newton_and_euler(there)
            ends.append(follow(rate, start, [made["run"]["duration"]], 0.002)[0][6:10])
        expected = difference(*ends, step)
    elements = np.array([diagonal[i, j] for i, j in ELEMENTS]) * size
    moved = derivative.inertia @ elements + derivative.center_of_mass @ CHANGE["center"] * 0.01
    moved += derivative.mass * CHANGE["mass"] * mass
    np.testing.assert_allclose(moved, expected, rtol=1e-4, atol=1e-6)


def test_a_body_on_joints_against_differences_of_its_particles() -> None:
    joint = Joint(axis=[0, 1, 0], point=[0.1, 0, 0.2], times=[0.0, 0.3], angles=[0.0, 1.2])
    parts = [
        JointedPart("trunk", 2.0, np.diag([0.5, 0.6, 0.4])),
        JointedPart("arm", 1.0, np.diag([0.2, 0.25, 0.15]), [0.3, 0.1, 0.2], "trunk", (joint,)),
    ]
    omega, time, step = np.array([1.0, 2.0, -3.0]), 0.3, 1e-5

    def posed(k: int, change: float) -> JointedBody:
        part = parts[k]
        other = JointedPart(
            part.name,
            part.mass + change * CHANGE["mass"],
            part.inertia + change * 0.1 * CHANGE["tensor"],
            part.center_of_mass + change * 0.1 * CHANGE["center"],
            part.parent,
            part.joints,
        )
        return JointedBody((*parts[:k], other, *parts[k + 1 :]))

    derivative = sensitivity(
        inertia.Scene(
            inertia.SceneBody.of_assembly(posed(0, 0.0)), inertia.Start(omega, "part"), inertia.Settings(time, 2)
        )
    )
    assert list(derivative.parts) == ["trunk", "arm"]
    for k, part in enumerate(parts):
        ends = []
        for sign in (1, -1):
            swarm = Swarm(posed(k, sign * step))
            with mp.workdps(DIGITS):
                tensor, internal, _ = swarm.moments(mp.mpf(0))
                momentum = list(tensor * mp.matrix(omega.tolist()) + mp.matrix(internal))
            ends.append(swarm.follow(momentum, [time], 0.15)[0])
        expected = difference(*ends, step)
        np.testing.assert_allclose(along(derivative.parts[part.name], 0.1, 0.1, 1.0), expected, atol=1e-6)
    np.testing.assert_array_equal(derivative.mass, derivative.parts["trunk"].mass)
    np.testing.assert_allclose(derivative.attitude, np.eye(3), atol=1e-7)


def test_a_part_that_is_a_point_has_a_derivative_too() -> None:
    joint = Joint(axis=[0, 0, 1], times=[0.0, 0.2], angles=[0.0, 0.5])
    bob = JointedPart("bob", 1.0, np.zeros((3, 3)), [0.5, 0, 0], "hub", (joint,))
    body = inertia.SceneBody.of_assembly(JointedBody((JointedPart("hub", 2.0, np.eye(3)), bob)))
    derivative = sensitivity(inertia.Scene(body, inertia.Start([0, 0, 1.0], "part"), inertia.Settings(0.2, 2)))
    # The bob swings from rest to rest by α = 0.5 rad: with J = μ r² the hub turns by ((I + J) ω T − J α)/(I + J).
    reduced, moment = 2.0 / 3.0 * 0.25, 1.0
    momentum = moment + reduced
    turned = (momentum * 0.2 - reduced * 0.5) / (moment + reduced)
    by_hub = 0.2 / (moment + reduced) - turned / (moment + reduced)
    by_bob = by_hub - 0.5 / (moment + reduced)
    zz = ELEMENTS.index((2, 2))
    assert derivative.parts["hub"].inertia[2, zz] == pytest.approx(by_hub, abs=1e-6)
    assert derivative.parts["bob"].inertia[2, zz] == pytest.approx(by_bob, abs=1e-6)


def test_what_has_no_derivative_is_refused() -> None:
    with pytest.raises(UsageError, match="simulate"):
        sensitivity(table(PLAIN))  # type: ignore[arg-type]
    upright = scene(TOP, start={"angular_velocity": [0, 0, 1.0]}, run__duration=20.0)
    with pytest.raises(GeometryError, match=r"part too far|does not reach"):
        sensitivity(upright)
