"""Many bodies at once by Taylor series, against Taylor series in integers and against each other."""

from dataclasses import replace

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import TIMES, case
from tests.dynamics.oracle import rotate

from inertia.dynamics.integrators.lanes import Bodies, fits, solve_bodies
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity


def bodies_of(problems: list[RotationProblem]) -> Bodies:
    terms = [problem.terms(0.0) or Terms() for problem in problems]
    return Bodies(
        np.array([problem.moments for problem in problems]),
        np.array([problem.attitude for problem in problems]),
        np.array([problem.angular_velocity for problem in problems]),
        np.array([each.packed(1.0, 1.0) for each in terms]),
    )


@pytest.mark.parametrize("accuracy", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("name", ["free", "heavy", "driven", "orbiting"])
def test_the_error_is_below_what_is_stated_and_asked_for(name: str, accuracy: float, path: str) -> None:
    known = case(name)
    attitude, spin, reached = solve_bodies(bodies_of([known.problem]), TIMES, accuracy)
    error = known.truth.attitude_error(attitude[0]).max()
    assert error <= reached[0] <= accuracy
    assert known.truth.angular_velocity_error(spin[0]).max() < 10.0 * reached[0]


def test_every_body_of_many_has_its_own_motion_and_error(path: str) -> None:
    rng = np.random.default_rng(11)
    times = np.array([0.0, 0.1, 0.1, 3.0])
    problems = []
    for k in range(21):  # two whole blocks of eight, and a part of one
        moments = np.sort(1.0 + rng.uniform(size=3))
        spin = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 1.0)
        loads = (Gravity([0.0, 1.0, -(1.0 + k / 4)]),)
        start = rng.normal(size=4)
        problems.append(RotationProblem(moments, spin, start, loads, mass=1.5, arm=rng.uniform(size=3) / 3))
    bodies = bodies_of(problems)
    assert bodies.rates.tolist() == [problem.rate for problem in problems]
    attitude, spin, reached = solve_bodies(bodies, times, 1e-10)
    for k in (0, 7, 8, 20):
        problem = problems[k]
        truth = rotate(
            problem.moments,
            problem.angular_velocity,
            times,
            attitude=problem.attitude.tolist(),
            mass=1.5,
            offset=problem.arm,
            gravity=problem.loads[0].acceleration,
        )
        assert truth.attitude_error(attitude[k]).max() <= reached[k] <= 1e-10
        alone, alone_spin, _ = solve_bodies(bodies_of([problem]), times, 1e-10)
        assert quaternion.angle_between(alone[0], attitude[k]).max() < 1e-13
        assert alone_spin[0] == pytest.approx(spin[k], rel=1e-12)


def test_a_body_that_leaves_float64_is_lost_and_the_others_are_not(path: str) -> None:
    problem = case("heavy").problem
    hopeless = replace(problem, angular_velocity=np.array([1e200, 1e200, 0.0]))
    with np.errstate(all="ignore"):
        attitude, _, reached = solve_bodies(bodies_of([problem, hopeless, problem]), TIMES, 1e-9)
    assert reached[1] > 1e-9
    assert (reached[[0, 2]] <= 1e-9).all()
    assert attitude[0].tolist() == attitude[2].tolist()


def test_bodies_at_rest_stay_there(path: str) -> None:
    still = RotationProblem([1.0, 2.0, 2.5], [0.0, 0.0, 0.0])
    attitude, spin, reached = solve_bodies(bodies_of([still] * 3), TIMES, 1e-9)
    assert attitude.tolist() == [[[0.0, 0.0, 0.0, 1.0]] * 3] * 3
    assert not spin.any()
    assert (reached < 1e-13).all()


def test_a_torque_linear_between_instants_is_followed_to_what_is_stated(path: str) -> None:
    # about one axis, ω = ∫ N/I dt and θ = ∫ ω dt: polynomials of each piece
    moment, spin, times = 2.0, 0.7, np.linspace(0.0, 4.0, 9)
    rows = [(0.0, 0.3, 0.5), (1.3, -2.0, 0.0), (2.5, 0.0, 4.0)]  # from which instant on: N, and how fast it grows
    terms = [Terms(np.array([0.0, 0.0, n]), np.array([0.0, 0.0, s])).packed(1.0, 1.0)[None] for _, n, s in rows]
    start, axis = np.array([[0.1, -0.2, 0.3, 0.9]]) / np.sqrt(0.95), np.array([[0.0, 0.0, spin]])
    bodies = Bodies(
        np.array([[1.0, 1.5, moment]]), start, axis, terms[0], tuple((rows[k][0], terms[k]) for k in (1, 2))
    )
    attitude, rate, reached = solve_bodies(bodies, times, 1e-11)
    angle, fast, ends = 0.0, spin, [*(begin for begin, _, _ in rows[1:]), 4.0]
    for (begin, torque, slope), end in zip(rows, ends, strict=True):
        for k in np.flatnonzero((times >= begin) & (times <= end)):
            t = times[k] - begin
            turned = angle + fast * t + (torque * t**2 / 2 + slope * t**3 / 6) / moment
            expected = quaternion.multiply(start[0], [0.0, 0.0, np.sin(turned / 2), np.cos(turned / 2)])
            assert quaternion.angle_between(attitude[0, k], expected) <= reached[0] <= 1e-11
            assert rate[0, k, 2] == pytest.approx(fast + (torque * t + slope * t**2 / 2) / moment, abs=1e-10)
        t = end - begin
        angle += fast * t + (torque * t**2 / 2 + slope * t**3 / 6) / moment
        fast += (torque * t + slope * t**2 / 2) / moment


def test_dissipation_and_what_grows_with_time_in_space_do_not_fit() -> None:
    steady = Terms(torque=np.ones(3), damping=np.ones(3)) + Terms.of_vector(np.ones(3), matrix=np.eye(3))
    assert fits(steady.packed(1.0, 1.0)[None])
    ramp = Terms.of_vector(np.ones(3), matrix=np.eye(3), slope=True)
    assert fits(Terms(torque_rate=np.ones(3)).packed(1.0, 1.0)[None])
    for other in (Terms(dissipation=0.1), steady + ramp):
        assert not fits(other.packed(1.0, 1.0)[None])
