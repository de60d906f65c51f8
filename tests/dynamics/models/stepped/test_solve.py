"""Stepping to an accuracy: what is reached, what is said about it, and integrals of tops that are no energy."""

import itertools
from typing import Any

import numpy as np
import pytest
from tests.dynamics import oracle
from tests.dynamics.integrators.loaded import ATTITUDE, LOADS, MOMENTS, SPIN, TIMES, case, rotations

from inertia.dynamics.integrators import methods
from inertia.dynamics.integrators.events import find_events
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.losses import Damping, Dissipation
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.stepped.solve import solve_stepped, state_between
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError, UsageError
from inertia.native import Kernel

OWN = "Taylor", "splitting 2", "splitting 4", "splitting 6", "splitting 8", "RK4"


def test_estimates_are_honest_for_the_methods_of_our_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """At least 95 % of the estimates bound the true error, and none is ten times too small."""
    monkeypatch.setattr(Kernel, "worthwhile", lambda self, count: True)
    ratios = []
    for method, name, accuracy in itertools.product(OWN, LOADS, (1e-3, 1e-5, 1e-8, 1e-11)):
        if method == "splitting 2" and accuracy < 1e-5:
            continue
        known = case(name)
        motion = solve_stepped(known.problem, TIMES, accuracy, method)
        error = known.truth.attitude_error(motion.attitude).max()
        assert motion.reached <= accuracy
        assert error < 1.5 * accuracy
        ratios.append(motion.reached / error)
    assert np.mean(np.array(ratios) >= 1.0) >= 0.95
    assert min(ratios) > 0.1


@pytest.mark.parametrize(("end", "accuracy"), [(500.0, 1e-4), (2000.0, 3.4e-4), (4000.0, 1e-7)])
def test_an_accuracy_is_not_refused_where_a_finer_one_is_reached(end: float, accuracy: float) -> None:
    """With less tolerance the order of the series changes, and the estimate of its error may rise at first."""
    problem = RotationProblem([1.0, 2.0, 3.0], [1.0, 0.5, 2.0], loads=(Damping(1e-6),))
    time = np.linspace(0.0, end, 11)
    coarse, fine = (solve_stepped(problem, time, goal) for goal in (accuracy, 1e-8 if accuracy > 1e-7 else 1e-9))
    apart = quaternion.angle_between(coarse.attitude, fine.attitude).max()
    assert apart <= coarse.reached + fine.reached <= accuracy + 1e-8


def test_runs_of_the_taylor_method_that_are_off_alike_do_not_hide_it() -> None:
    moments = [1.7903258151887087, 1.0768151145990816, 2.026331524821499]
    spin = [-2.9189646978982806, 0.49751628396317693, -1.1421803692903238]
    push = Torque([-9.624055360678368e-05, 0.00012389930311937656, 4.433907821421668e-05])
    problem, time = RotationProblem(moments, spin, loads=(push,)), np.linspace(0.0, 1000.0, 11)
    taylor = methods.METHODS["Taylor"]
    truth = taylor.run(problem, time, taylor.tightest)
    for control in np.geomspace(3e-14, 3e-13, 41).tolist():
        states, estimate = taylor.solve(problem, time, control)
        assert states.apart(truth) < estimate


@pytest.mark.parametrize(
    ("moments", "spin", "end", "method", "accuracy"),
    [
        ([1.0, 2.0, 3.0], [0.01, 2.0, 0.01], 20.0, "splitting 4", 1e-7),
        ([1.0, 2.0, 3.0], [0.01, 2.0, 0.01], 20.0, "splitting 6", 1e-9),
        ([1.1789974066735178, 1.6137939122560816, 1.7921459755036757],
         [0.007711029803575362, 3.273858059964795, 0.015602446092660711], 60.0, "splitting 6", 1e-6),
    ],
)  # fmt: skip
def test_rounding_that_flips_amplify_is_in_the_estimate(
    moments: list[float], spin: list[float], end: float, method: str, accuracy: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Kernel, "worthwhile", lambda self, count: True)
    time = np.linspace(0.0, end, 201)
    motion = solve_stepped(RotationProblem(moments, spin), time, accuracy, method)
    error = oracle.rotate(moments, spin, time.tolist()).attitude_error(motion.attitude).max()
    assert error < motion.reached < 30.0 * error


@pytest.mark.parametrize("method", ["Taylor", "splitting 6", "RK4", "DOP853"])
def test_a_spin_about_the_intermediate_axis_of_a_full_tensor_stays_there(method: str) -> None:
    """The axes are (2, 3, 6)/7, (3, −6, 2)/7 and (6, 2, −3)/7; a rounding of the spin would have it flip in 15 s."""
    axes = np.array([[2.0, 3.0, 6.0], [3.0, -6.0, 2.0], [6.0, 2.0, -3.0]])
    tensor = (np.array([[2.0], [3.0], [4.0]]) * axes).T @ axes
    table = {"body": {"inertia": tensor.tolist()}, "start": {"angular_velocity": axes[1].tolist(), "frame": "part"}}
    run = simulate(Scene.from_dict(table | {"run": {"duration": 12.0, "method": method, "accuracy": 1e-6}}))
    turned = quaternion.from_rotation_vector(run.time[:, None] * axes[1])
    assert quaternion.angle_between(run.attitude, turned).max() < run.error.reached


@pytest.mark.parametrize(("method", "accuracy"), [("DOP853", 1e-9), ("LSODA", 1e-6), ("Radau", 1e-5)])
@pytest.mark.parametrize("name", LOADS)
def test_estimates_of_scipy_methods_are_honest(method: str, accuracy: float, name: str) -> None:
    known = case(name)
    motion = solve_stepped(known.problem, TIMES, accuracy, method)
    assert motion.reached <= accuracy
    assert known.truth.attitude_error(motion.attitude).max() < 2 * motion.reached


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9, 1e-12])
def test_heavy_asymmetric_top_reaches_every_accuracy(accuracy: float) -> None:
    known = case("heavy")
    motion = solve_stepped(known.problem, TIMES, accuracy)
    assert motion.method == "Taylor"
    assert known.truth.attitude_error(motion.attitude).max() < motion.reached <= accuracy


def test_heavy_top_shows_its_invariants() -> None:
    motion = solve_stepped(case("heavy").problem, np.linspace(0.0, 20.0, 50), 1e-10)
    assert set(motion.invariants) == {"energy", "angular momentum along (0, 0, 1) in space"}
    for name, values in motion.invariants.items():
        assert np.abs(values - values[0]).max() < 1e-12 * motion.scales[name]


def test_free_symmetric_body_keeps_all_of_its_momentum() -> None:
    motion = solve_stepped(RotationProblem([2.0, 2.0, 3.0], SPIN), np.linspace(0.0, 9.0, 5), 1e-10)
    assert set(motion.invariants) == {"energy", "angular momentum", "angular momentum about body axis 3"}
    for name, values in motion.invariants.items():
        assert np.abs(values - values[0]).max() < 1e-13 * motion.scales[name]


def test_torque_in_space_keeps_the_momentum_across_it() -> None:
    motion = solve_stepped(
        RotationProblem(MOMENTS, SPIN, loads=(Torque([0.0, 2.0, 0.0], frame="space"),)), [0.0, 3.0], 1e-12
    )
    assert set(motion.invariants) == {
        "angular momentum along (1, 0, 0) in space",
        "angular momentum along (0, 0, 1) in space",
    }
    for values in motion.invariants.values():
        assert values[1] == pytest.approx(values[0], abs=1e-13)


def upright(motion_attitude: np.ndarray) -> np.ndarray:
    return quaternion.to_body(motion_attitude, [0.0, 0.0, 1.0])


@pytest.mark.parametrize("method", ["Taylor", "splitting 8", "RK4", "DOP853"])
def test_kovalevskaya_integral_is_kept(method: str) -> None:
    """A = B = 2 C, V = μ γ₁: (p² − q² − (μ/C) γ₁)² + (2 p q − (μ/C) γ₂)², S. Kowalevski, Acta Math. 12 (1889) 177."""
    c, mu = 1.0, 1.5
    weight, arm = Gravity([0.0, 0.0, -10.0]), [mu / 10.0, 0.0, 0.0]
    problem = RotationProblem([2 * c, 2 * c, c], [1.0, -0.4, 0.7], ATTITUDE, (weight,), mass=1.0, arm=arm)
    motion = solve_stepped(problem, np.linspace(0.0, 15.0, 31), 1e-8, method)
    p, q, _ = motion.angular_velocity.T
    gamma = upright(motion.attitude).T
    integral = (p * p - q * q - mu / c * gamma[0]) ** 2 + (2 * p * q - mu / c * gamma[1]) ** 2
    assert np.abs(integral / integral[0] - 1).max() < 1e-7
    assert np.ptp(p) > 1.0


@pytest.mark.parametrize("method", ["Taylor", "splitting 6"])
def test_goryachev_chaplygin_integral_is_kept(method: str) -> None:
    """A = B = 4 C, V = μ γ₁, L·γ = 0: L₃ (L₁² + L₂²) − A μ L₁ γ₃; with L·γ ≠ 0 it is not kept."""
    moments, mu = np.array([4.0, 4.0, 1.0]), 2.0
    weight, arm = Gravity([0.0, 0.0, -10.0]), [mu / 10.0, 0.0, 0.0]
    gamma = upright(quaternion.normalise(ATTITUDE))
    momentum = np.cross(gamma, [2.0, -1.0, 3.0])
    changes = []
    for extra in (0.0, 0.5):
        spin = (momentum + extra * gamma) / moments
        problem = RotationProblem(moments, spin, ATTITUDE, (weight,), mass=1.0, arm=arm)
        motion = solve_stepped(problem, np.linspace(0.0, 15.0, 31), 1e-9, method)
        body = moments * motion.angular_velocity
        vertical = upright(motion.attitude)
        integral = body[:, 2] * (body[:, 0] ** 2 + body[:, 1] ** 2) - 4.0 * mu * body[:, 0] * vertical[:, 2]
        changes.append(np.abs(integral - integral[0]).max() / np.abs(integral).max())
    assert changes[0] < 1e-8
    assert changes[1] > 1e-2


def test_motion_is_the_same_by_every_method() -> None:
    """A callable of the weight, a polynomial weight, and every method: one motion."""
    known = case("heavy")

    def weight(time: float, attitude: np.ndarray, spin: np.ndarray) -> np.ndarray:
        return np.cross([0.1, 0.2, 0.3], 0.5 * quaternion.to_body(attitude, [0.0, 0.0, -9.8]))

    by_hand = RotationProblem(MOMENTS, SPIN, ATTITUDE, (Torque(weight, longest_step=1.0),))
    motion = solve_stepped(by_hand, TIMES, 1e-8)
    assert motion.method == "DOP853"
    assert known.truth.attitude_error(motion.attitude).max() < motion.reached
    assert not motion.invariants
    for method in ("RK4", "LSODA", "Radau"):
        again = solve_stepped(by_hand, TIMES, 1e-4, method)
        assert known.truth.attitude_error(again.attitude).max() < 1e-4


def test_stiff_damping_is_left_to_an_implicit_method() -> None:
    """ω decays in 1e-3 s, and the body stands after a turn of ω₀ I/d."""
    problem = RotationProblem([1.0, 1.0, 1.0], [0.0, 0.0, 1.0], loads=(Damping(1000.0),))
    motion = solve_stepped(problem, [0.0, 100.0], 1e-6)
    assert motion.method == "LSODA"
    assert quaternion.angle_between(motion.attitude[1], quaternion.IDENTITY) == pytest.approx(1e-3, abs=1e-6)


def test_accuracy_beyond_float64_is_refused_before_stepping() -> None:
    with pytest.raises(
        GeometryError, match=r"Taylor does not reach 1e-13 rad over 1e\+06 s in float64: ask for .* rad"
    ):
        solve_stepped(case("free").problem, [0.0, 1e6], 1e-13)


def test_accuracy_that_the_method_does_not_reach_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"DOP853 does not reach 8e-15 rad over 5 s in float64: ask for .* rad"):
        solve_stepped(case("heavy").problem, TIMES, 8e-15, "DOP853")


@pytest.mark.parametrize(
    ("name", "accuracy", "method"), [("heavy", 1e-15, None), ("heavy", 8e-15, "DOP853"), ("free", 3e-15, "RK4")]
)
def test_the_accuracy_that_a_refusal_asks_for_is_reached(name: str, accuracy: float, method: str | None) -> None:
    problem = case(name).problem
    with pytest.raises(GeometryError) as refusal:
        solve_stepped(problem, TIMES, accuracy, method)
    advice = float(str(refusal.value).split("ask for ")[1].split(" rad")[0])
    assert solve_stepped(problem, TIMES, advice, method).reached <= advice


def test_steps_beyond_reason_are_refused() -> None:
    with pytest.raises(GeometryError, match=r"splitting 2 needs .* steps"):
        solve_stepped(case("free").problem, [0.0, 1000.0], 1e-11, "splitting 2")


def test_estimate_near_the_separatrix_knows_that_rounding_grows() -> None:
    """ω₁ = 1e-6 ω₂: an error of 1e-16 made while the body flips is 1e-4 rad at the next flip."""
    time = np.linspace(0.0, 65.0, 14)
    truth = oracle.rotate((1.0, 2.0, 3.0), (1e-6, 1.0, 0.0), time)
    problem = RotationProblem([1.0, 2.0, 3.0], [1e-6, 1.0, 0.0])
    for method in ("Taylor", "splitting 8"):
        motion = solve_stepped(problem, time, 1e-2, method)
        assert truth.attitude_error(motion.attitude).max() < 2.0 * motion.reached
    with pytest.raises(GeometryError, match=r"nor 0\.1 rad|ask for .* rad"):
        solve_stepped(problem, time, 1e-9, "Taylor")


def near_separatrix(pull: float) -> RotationProblem:
    return RotationProblem([1.0, 2.0, 3.0], [1e-5, 1.0, 0.0], loads=(Torque([0.0, 0.0, pull]),))


def test_nearly_free_body_near_its_separatrix_is_warned_of() -> None:
    """|2 T I₂ − L²|/L² = ω₁² I₁ (I₂ − I₁)/L² = 2.5e-11; λ = ω₂ √((I₂−I₁)(I₃−I₂)/(I₁I₃)) = 0.577/s."""
    motion = solve_stepped(near_separatrix(1e-9), [0.0, 5.0], 1e-6)
    (message,) = motion.warnings
    assert "2.5e-11 from its separatrix" in message
    assert "growth rate 0.577 1/s" in message
    assert "every 1.73 s" in message


HANGING = RotationProblem([1, 2, 3], [0, 1, 0], loads=(Gravity([0, 0, -9.81]),), mass=1.0, arm=[0, 0, -0.5])
"""A pendulum: what pulls it back vanishes where it starts, and it never turns over."""


@pytest.mark.parametrize(
    "problem", [near_separatrix(1.0), case("free").problem, RotationProblem([1, 1, 2], [0, 1, 1]), HANGING]
)
def test_other_bodies_are_not(problem: RotationProblem) -> None:
    assert solve_stepped(problem, [0.0, 1.0], 1e-6).warnings == ()


def test_run_may_start_late_and_repeat_samples() -> None:
    known = case("driven")
    _, middle, end = TIMES.tolist()
    whole = solve_stepped(known.problem, [middle, middle, end], 1e-10)
    late = RotationProblem(MOMENTS, whole.angular_velocity[0], whole.attitude[0], known.problem.loads, start=middle)
    rest = solve_stepped(late, [middle, middle, end], 1e-10)
    assert (whole.attitude[0] == whole.attitude[1]).all()
    for motion in (whole, rest):
        assert known.truth.attitude_error(motion.attitude[[0, 0, 2]])[1:].max() < 2e-10
    assert (rest.attitude[0] == late.attitude).all()


def test_state_between_samples_is_true() -> None:
    known = case("heavy")
    coarse = np.array([0.0, 2.0, 4.0, 6.0])
    motion = solve_stepped(known.problem, coarse, 1e-12)
    attitude, _ = state_between(known.problem, coarse, motion)(2.5)
    assert known.truth.attitude_error(np.array([known.problem.attitude, attitude, attitude]))[1] < 1e-12


def test_crossing_of_a_plane_is_found_between_samples() -> None:
    """Axis 1 of a body that spins at 2 rad/s about axis 3 rises through the plane y = 0.5 at π/12, falls at 5π/12."""
    problem = RotationProblem([1.0, 1.0, 1.0], [0.0, 0.0, 2.0])
    time = np.linspace(0.0, 3.0, 7)
    motion = solve_stepped(problem, time, 1e-12)

    def above(state: tuple[np.ndarray, np.ndarray]) -> float:
        return float(quaternion.to_space(state[0], [1.0, 0.0, 0.0])[1] - 0.5)

    values = [above(state) for state in zip(motion.attitude, motion.angular_velocity, strict=True)]
    crossings = find_events(above, time, values, state_between(problem, time, motion))
    assert crossings == pytest.approx([np.pi / 12, 5 * np.pi / 12], abs=1e-14)


@pytest.mark.parametrize(
    ("time", "accuracy", "method", "says"),
    [
        ([[0.0, 1.0]], 1e-6, None, "one row of finite numbers"),
        ([], 1e-6, None, "one row of finite numbers"),
        ([0.0, np.nan], 1e-6, None, "one row of finite numbers"),
        ([-1.0, 1.0], 1e-6, None, "ascend from 0 s"),
        ([0.0, 2.0, 1.0], 1e-6, None, "ascend from 0 s"),
        ([0.0, 1.0], 0.0, None, "accuracy is 0.0"),
        ([0.0, 1.0], np.nan, None, "accuracy is nan"),
        ([0.0, 1.0], 1e-6, "DOP835", "unknown method 'DOP835': use one of Taylor, .*did you mean 'DOP853'"),
    ],
)
def test_arguments_that_cannot_be_used(time: list[float], accuracy: float, method: str | None, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        solve_stepped(case("free").problem, time, accuracy, method)


@pytest.mark.parametrize(("rate", "says"), [(5.0, True), (0.05, False)])
def test_a_large_rate_of_dissipation_is_told(rate: float, says: bool) -> None:
    """How fast the axes turn is seen in two attitudes that are near each other."""
    problem = RotationProblem([1.0, 1.2, 1.5], [2.0, 0.3, 0.1], loads=(Dissipation(rate),))
    motion = solve_stepped(problem, [0.0, 1e-6], 1e-12)
    turned = rotations(motion.attitude[1:])[0] / 1e-6
    seen = 0.5 * np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
    share = np.linalg.norm(seen - problem.angular_velocity) / np.linalg.norm(problem.angular_velocity)
    assert [f"up to {100.0 * share:.2g} % of it away" in remark for remark in motion.remarks] == [True] * says


def test_body_at_rest_without_loads_stays() -> None:
    motion = solve_stepped(RotationProblem(MOMENTS, [0.0, 0.0, 0.0], ATTITUDE), [0.0, 1e3], 1e-12)
    assert (motion.attitude[1] == motion.attitude[0]).all()


def test_body_starts_from_rest_under_a_torque() -> None:
    """The unit of time comes from √(N/I); 1e-9 N m on 1 kg m² for 1e5 s turns by 5 rad."""
    problem = RotationProblem(MOMENTS, [0.0, 0.0, 0.0], loads=(Torque([1e-9, 2e-10, 0.0]),))
    truth = oracle.rotate(MOMENTS, (0.0, 0.0, 0.0), [1e5], body_torque=(1e-9, 2e-10, 0.0))
    motion = solve_stepped(problem, [1e5], 1e-11)
    assert truth.attitude_error(motion.attitude)[0] < motion.reached


@pytest.mark.parametrize("breaks", [[], np.sort(np.concatenate([0.7 * np.arange(1, 8), 0.7 * np.arange(8) + 0.31]))])
def test_a_square_wave_is_followed_to_1e_10_with_and_without_breaks(breaks: Any) -> None:
    # about one axis: the angle of a body is a polynomial of second degree between the jumps of the torque
    wave = Torque(lambda time, attitude, omega: np.array([0.0, 0.0, 0.5 if time % 0.7 < 0.31 else -0.4]), breaks=breaks)
    times = np.linspace(0.0, 5.2, 14)
    motion = solve_stepped(RotationProblem([1.0, 1.0, 2.0], [0.0, 0.0, 0.3], loads=(wave,)), times, 1e-10)
    angle, spin, now, expected = 0.0, 0.3, 0.0, [0.0]
    jumps = [0.7 * k + part for k in range(8) for part in (0.0, 0.31)][1:]
    for end in sorted([*jumps, *times[1:]]):
        rate = (0.5 if 0.5 * (now + end) % 0.7 < 0.31 else -0.4) / 2.0
        length = end - now
        angle, spin, now = angle + spin * length + 0.5 * rate * length**2, spin + rate * length, end
        if end in times:
            expected.append(angle)
    off = np.abs(2.0 * np.arctan2(motion.attitude[:, 2], motion.attitude[:, 3]) - expected).max()
    assert off <= motion.reached <= 1e-10
    assert motion.steps < 5000
