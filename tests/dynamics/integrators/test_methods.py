"""Every stepping method: order, symmetry, kinks of the loads, and the compiled path beside the one without."""

import functools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.dynamics import oracle
from tests.dynamics.integrators.loaded import (
    ARM,
    ATTITUDE,
    LOADS,
    MASS,
    MOMENTS,
    SPIN,
    TIMES,
    TorqueLaw,
    angles,
    case,
    direction_cosines,
)

from inertia.dynamics.integrators.loop import Integrator
from inertia.dynamics.integrators.methods import METHODS
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.runge_kutta import RungeKutta4
from inertia.dynamics.integrators.scipy_methods import SciPy
from inertia.dynamics.integrators.splitting import COMPOSITIONS, Splitting
from inertia.dynamics.integrators.taylor import Taylor
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.losses import Dissipation
from inertia.dynamics.loads.torque import Torque, TorqueTable
from inertia.errors import UsageError
from inertia.native import Kernel

COARSEST = {"splitting 2": 48, "splitting 4": 24, "splitting 6": 12, "splitting 8": 12, "RK4": 48}
FIXED = [*(Splitting(order) for order in COMPOSITIONS), RungeKutta4()]


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("method", FIXED, ids=lambda method: method.name)
def test_error_falls_with_the_order_of_the_method(method: Integrator, name: str, compiled: None) -> None:
    counts = COARSEST[method.name] * np.array([3, 4, 5]) // 3
    known = case(name)
    runs = [method.run(known.problem, TIMES, step) for step in (TIMES[1] / counts).tolist()]
    errors = np.array([known.truth.attitude_error(run.attitude).max() for run in runs])
    slopes = np.log(errors[:-1] / errors[1:]) / np.log(counts[1:] / counts[:-1])
    assert (errors > 1e-13).all(), "rounding hides the slope"
    assert slopes == pytest.approx(method.order, abs=0.35)


Row = tuple[list[float], list[list[float]]]
BODY: Row = [0.0, 1.0, 1.0, 2.5, 9.0], [[0, 1, 0], [2, 0, 0], [0, 0, 1], [1, 1, 1], [0, 0, 0]]
SPACE: Row = [-1.0, 0.7, 6.0], [[0, 1, 0], [1, 0, 0.5], [0, 0, 1]]
TABLES = Torque(table=TorqueTable(*BODY)), Torque(table=TorqueTable(*SPACE), frame="space")
DISSIPATING = Dissipation(0.1), Torque([0.0, 0.0, 1.0])
PUSHES = [[0.02 * np.sin(k), 0.02 * np.cos(k), 0.001 * k] for k in range(40)]
MANY = tuple(Torque(push, frame="space") for push in PUSHES)
CASES: dict[str, tuple[Load, ...]] = {
    **{name: loads for name, (loads, _) in LOADS.items()},
    "tables": TABLES,
    "dissipating": DISSIPATING,
    "many": MANY,
}
SAMPLES = np.linspace(0.0, 4.0, 7)


def straight(rows: Row, low: float, high: float, time: float) -> np.ndarray:
    """Return the value at `time` of the one line that a table is between two instants."""
    row = next(k for k in range(len(rows[0]) - 1) if rows[0][k] <= low and high <= rows[0][k + 1])
    (a, b), (n, m) = rows[0][row : row + 2], np.array(rows[1][row : row + 2], dtype=float)
    return n + (m - n) * (time - a) / (b - a)


def law(name: str) -> Callable[[float, float], TorqueLaw]:
    """Return the torque law of a case between two instants, written out."""

    def between(low: float, high: float) -> TorqueLaw:
        laws: dict[str, TorqueLaw] = {
            "free": lambda t, turn, spin: np.zeros(3),
            "heavy": lambda t, turn, spin: np.cross(ARM, MASS * turn.T @ [0.0, 0.0, -9.8]),
            "driven": lambda t, turn, spin: turn.T @ [1.0, 0.25, 0.3] + [0.1, -0.2, 0.0] - [0.1, 0.2, 0.0] * spin,
            "orbiting": lambda t, turn, spin: (
                24.0 / 5.25**2.5 * np.cross(turn.T @ [1.0, 2.0, 0.5], MOMENTS * (turn.T @ [1.0, 2.0, 0.5]))
            ),
            "tables": lambda t, turn, spin: straight(BODY, low, high, t) + turn.T @ straight(SPACE, low, high, t),
            "dissipating": lambda t, turn, spin: np.array([0.0, 0.0, 1.0]),
            "many": lambda t, turn, spin: turn.T @ np.sum(PUSHES, axis=0),
        }
        return laws[name]

    return between


@functools.cache
def truth(name: str) -> list[np.ndarray]:
    kinks = (0.7, 1.0, 2.5) if name == "tables" else ()
    return direction_cosines(law(name), SAMPLES, kinks, 0.1 if name == "dissipating" else 0.0)


TWICE = [
    (method, control, bound, name)
    for method, control, bound in (
        (Taylor(), 1e-12, 1e-11),
        (Taylor(), 1e-40, 2e-12),
        (Splitting(4), 0.1, 1e-3),
        (RungeKutta4(), 0.1, 1e-2),
    )
    for name in CASES
    if not (isinstance(method, Splitting) and name == "dissipating")
]


@pytest.mark.parametrize(("method", "control", "bound", "name"), TWICE)
def test_compiled_and_uncompiled_paths_agree_and_are_right(
    method: Integrator, control: float, bound: float, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE, CASES[name], mass=MASS, arm=ARM)
    runs = []
    for native in (True, False):
        monkeypatch.setattr(Kernel, "worthwhile", lambda self, count, native=native: native)
        runs.append(method.run(problem, SAMPLES, control))
        assert angles(runs[-1].attitude, truth(name)).max() < bound
    assert runs[0].apart(runs[1]) < 1e-13
    assert runs[0].angular_velocity == pytest.approx(runs[1].angular_velocity, abs=1e-13)
    assert runs[0].steps == runs[1].steps


@pytest.mark.parametrize("method", [Taylor(), Splitting(6), SciPy("LSODA")], ids=lambda method: method.name)
def test_tables_are_followed_through_their_kinks_and_jumps(method: Integrator) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE, TABLES)
    times = np.array([0.5, 1.0, 2.5, 4.0])
    run = method.run(problem, times, 1e-12 if method.name != "splitting 6" else 0.02)
    assert angles(run.attitude, direction_cosines(law("tables"), times, (0.7, 1.0, 2.5))).max() < 1e-10


@pytest.mark.parametrize(
    ("method", "control"), [(Taylor(), 1e-16), *((Splitting(order), 0.02) for order in COMPOSITIONS)]
)
@pytest.mark.parametrize("name", ["free", "heavy", "orbiting"])
def test_motion_runs_back_when_the_spin_is_turned_round(
    method: Integrator, control: float, name: str, compiled: None
) -> None:
    """The splittings are symmetric, so that even their errors run back."""
    problem = case(name).problem
    there = method.run(problem, np.array([4.0]), control)
    turned = replace(problem, angular_velocity=-there.angular_velocity[0], attitude=there.attitude[0])
    back = method.run(turned, np.array([4.0]), control)
    assert quaternion.angle_between(back.attitude[0], problem.attitude) < 1e-12
    assert back.angular_velocity[0] == pytest.approx(-problem.angular_velocity, abs=1e-12)


@pytest.mark.parametrize(("method", "control"), [(Taylor(), 1e-16), (Splitting(4), 0.02), (RungeKutta4(), 0.02)])
def test_space_may_be_turned_before_or_after(method: Integrator, control: float, compiled: None) -> None:
    turn = quaternion.normalise([0.3, 0.1, -0.7, 0.4])
    down = quaternion.to_space(turn, [0.0, 0.0, -9.8])
    here = case("heavy").problem
    attitude = quaternion.multiply(turn, here.attitude)
    there = RotationProblem(MOMENTS, SPIN, attitude, (Gravity(down),), mass=here.mass, arm=here.arm)
    one, other = method.run(here, TIMES, control), method.run(there, TIMES, control)
    assert quaternion.angle_between(quaternion.multiply(turn, one.attitude), other.attitude).max() < 2e-13


@pytest.mark.parametrize(("method", "control"), [(Taylor(), 1e-16), (Splitting(8), 0.02), (RungeKutta4(), 0.02)])
def test_principal_axes_may_come_in_any_order(method: Integrator, control: float, compiled: None) -> None:
    order = [2, 0, 1]
    turn = quaternion.from_matrix(np.eye(3)[:, order])
    here = case("heavy").problem
    there = RotationProblem(
        np.array(MOMENTS)[order],
        np.array(SPIN)[order],
        quaternion.multiply(here.attitude, turn),
        (Gravity([0.0, 0.0, -9.8]),),
        mass=here.mass,
        arm=here.arm[order],
    )
    one, other = method.run(here, TIMES, control), method.run(there, TIMES, control)
    assert quaternion.angle_between(quaternion.multiply(one.attitude, turn), other.attitude).max() < 1e-14


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("method", [Taylor(), SciPy("DOP853"), SciPy("LSODA")], ids=lambda method: method.name)
def test_slow_and_fast_spins_are_equally_accurate(method: Integrator, scale: float) -> None:
    """A free body scaled by 2ⁿ in time moves through the same attitudes."""
    factor = 2.0 ** round(np.log2(scale))
    slow = RotationProblem(MOMENTS, np.array(SPIN) * factor, ATTITUDE)
    run = method.run(slow, TIMES / factor, 1e-10)
    assert case("free").truth.attitude_error(run.attitude).max() < 1e-8


def test_needle_keeps_its_digits(compiled: None) -> None:
    """I₃ = 1e-8: ω₃ is 1e8 times what its share of |L| says, and I₂ − I₁ ≤ I₃."""
    moments, spin = (1.0, 1.0 + 5e-9, 1e-8), (0.5, -0.25, 1.0)
    truth = oracle.rotate(moments, spin, [6.0])
    problem = RotationProblem(moments, spin)
    for method, control in ((Taylor(), 1e-17), (Splitting(8), 0.02)):
        run = method.run(problem, np.array([6.0]), control)
        assert truth.attitude_error(run.attitude)[0] < 3e-14
        assert truth.angular_velocity_error(run.angular_velocity)[0] < 3e-14


def test_polynomial_methods_refuse_a_callable() -> None:
    problem = RotationProblem(MOMENTS, SPIN, loads=(Torque(lambda t, q, w: np.zeros(3)),))
    for method in (Taylor(), Splitting(4)):
        with pytest.raises(UsageError, match="Torque is no polynomial in the state: use DOP853"):
            method.run(problem, TIMES, 0.1)


def test_methods_are_known_by_their_names() -> None:
    own = "Taylor", "splitting 2", "splitting 4", "splitting 6", "splitting 8", "RK4"
    assert set(METHODS) == {*own, "DOP853", "LSODA", "Radau", "heyoka"}
    assert all(method.name == name for name, method in METHODS.items())
