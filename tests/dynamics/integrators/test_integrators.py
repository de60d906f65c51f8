"""Every stepping method on its own: order, invariants, symmetry, and the compiled path against the one without."""

import sys
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from tests.dynamics import oracle
from tests.dynamics.integrators.loaded import ARM, ATTITUDE, LOADS, MASS, MOMENTS, SPIN, TIMES, case

from inertia.dynamics.integrators import loop
from inertia.dynamics.integrators.adaptive import SciPy
from inertia.dynamics.integrators.heyoka_taylor import Heyoka
from inertia.dynamics.integrators.loop import Integrator, States
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.runge_kutta import RungeKutta4
from inertia.dynamics.integrators.splitting import COMPOSITIONS, Splitting
from inertia.dynamics.integrators.taylor import Taylor
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.losses import Dissipation
from inertia.dynamics.loads.torque import Torque, TorqueTable
from inertia.errors import GeometryError, UsageError
from inertia.native import Kernel

COARSEST = {"splitting 2": 48, "splitting 4": 24, "splitting 6": 12, "splitting 8": 12, "RK4": 48}
FIXED = [*(Splitting(order) for order in COMPOSITIONS), RungeKutta4()]


@pytest.fixture(params=["compiled", "numpy"])
def path(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(Kernel, "worthwhile", lambda self, count: request.param == "compiled")
    return str(request.param)


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Kernel, "worthwhile", lambda self, count: True)


def errors(method: Integrator, name: str, controls: list[float]) -> np.ndarray:
    known = case(name)
    runs = [method.run(known.problem, TIMES, control) for control in controls]
    return np.array([known.truth.attitude_error(run.attitude).max() for run in runs])


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("method", FIXED, ids=lambda method: method.name)
def test_error_falls_with_the_order_of_the_method(method: Integrator, name: str, compiled: None) -> None:
    counts = COARSEST[method.name] * np.array([3, 4, 5]) // 3
    found = errors(method, name, (TIMES[1] / counts).tolist())
    slopes = np.log(found[:-1] / found[1:]) / np.log(counts[1:] / counts[:-1])
    assert (found > 1e-13).all(), "rounding hides the slope"
    assert slopes == pytest.approx(method.order, abs=0.35)


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-10, 1e-17])
def test_taylor_error_follows_the_tolerance(tolerance: float, name: str, path: str) -> None:
    (found,) = errors(Taylor(), name, [tolerance])
    assert found < max(50 * tolerance, 2e-14)


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("scipy", ["DOP853", "LSODA", "Radau"])
def test_scipy_error_follows_the_tolerance(scipy: str, name: str) -> None:
    loose, tight = errors(SciPy(scipy), name, [1e-5, 1e-8])
    assert tight < 1e-6
    assert tight < loose < 3e-3


@pytest.mark.parametrize("name", LOADS)
def test_heyoka_error_follows_the_tolerance(name: str) -> None:
    pytest.importorskip("heyoka")
    loose, tight = errors(Heyoka(), name, [1e-8, 1e-16])
    assert tight < 5e-15
    assert tight < loose < 1e-6


def test_without_heyoka_its_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "heyoka", None)
    with pytest.raises(UsageError, match=r"pip install 'inertia\[heyoka\]'"):
        Heyoka().run(case("free").problem, TIMES, 3.3e-7)


TABLES = (
    Torque(table=TorqueTable([0.0, 1.0, 1.0, 2.5, 9.0], [[0, 1, 0], [2, 0, 0], [0, 0, 1], [1, 1, 1], [0, 0, 0]])),
    Torque(table=TorqueTable([-1.0, 0.7, 6.0], [[0, 1, 0], [1, 0, 0.5], [0, 0, 1]]), frame="space"),
)


DISSIPATING = Dissipation(0.1), Torque([0.0, 0.0, 1.0])
MANY = tuple(Torque([0.02 * np.sin(k), 0.02 * np.cos(k), 0.001 * k], frame="space") for k in range(40))
TWICE = [
    (method, control, loads)
    for method, control in ((Taylor(), 1e-12), (Taylor(), 1e-40), (Splitting(4), 0.1), (RungeKutta4(), 0.1))
    for loads in (*(loads for loads, _ in LOADS.values()), TABLES, DISSIPATING, MANY)
    if not (isinstance(method, Splitting) and loads is DISSIPATING)
]


@pytest.mark.parametrize(("method", "control", "loads"), TWICE)
def test_compiled_and_uncompiled_paths_agree(
    method: Integrator, control: float, loads: tuple, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE, loads, mass=MASS, arm=ARM)
    runs = []
    for native in (True, False):
        monkeypatch.setattr(Kernel, "worthwhile", lambda self, count, native=native: native)
        runs.append(method.run(problem, np.linspace(0.0, 4.0, 7), control))
    assert runs[0].apart(runs[1]) < 1e-13
    assert runs[0].angular_velocity == pytest.approx(runs[1].angular_velocity, abs=1e-13)
    assert runs[0].steps == runs[1].steps


@pytest.mark.parametrize("method", [Taylor(), Splitting(6), SciPy("LSODA")], ids=lambda method: method.name)
def test_tables_are_followed_through_their_kinks_and_jumps(method: Integrator) -> None:
    """DOP853 on the same table as a function, begun anew at the jump, is the other opinion."""
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE, TABLES)
    found = method.run(problem, np.array([0.5, 1.0, 2.5, 4.0]), 1e-12 if method.name != "splitting 6" else 0.02)
    attitude, spin, start = problem.attitude, problem.angular_velocity, 0.0
    for k, end in enumerate([0.5, 1.0, 2.5, 4.0]):
        pieces = [start, *(t for t in (0.7,) if start < t < end), end]
        for low, high in pairwise(pieces):
            loads = tuple(Torque(straight(load.table, low, high), frame=load.frame) for load in TABLES)
            piece = RotationProblem(MOMENTS, spin, attitude, loads, start=low)
            state = SciPy("DOP853").run(piece, np.array([high]), 2.3e-14)
            attitude, spin = state.attitude[0], state.angular_velocity[0]
        start = end
        assert quaternion.angle_between(found.attitude[k], attitude) < 1e-10


def straight(table: TorqueTable | None, low: float, high: float) -> Callable[..., np.ndarray]:
    """Return the one line that the table is between two instants."""
    assert table is not None
    middle = 0.5 * (low + high)
    row = int(np.searchsorted(table.times, middle)) - 1
    t, n = table.times[row : row + 2], table.torques[row : row + 2]
    return lambda time, q, w: n[0] + (n[1] - n[0]) * (time - t[0]) / (t[1] - t[0])


MILLION = 1_000_000


def million_steps(method: Integrator, problem: RotationProblem, step: float) -> States:
    run = method.run(problem, np.linspace(0.0, MILLION * step, 1001), step)
    assert run.steps >= MILLION
    return run


@pytest.mark.parametrize("order", [2, 4])
def test_splitting_keeps_the_momentum_of_a_free_body_over_a_million_steps(order: int, compiled: None) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE)
    run = million_steps(Splitting(order), problem, 0.05)
    momentum = problem.angular_momentum(run.attitude, run.angular_velocity)
    size = np.linalg.norm(momentum[0])
    assert np.abs(np.linalg.norm(momentum, axis=1) / size - 1).max() < 1e-12
    assert np.linalg.norm(momentum - momentum[0], axis=1).max() < 1e-10 * size
    assert_error_does_not_grow(problem.energy(run.attitude, run.angular_velocity))


def test_splitting_keeps_the_energy_of_a_heavy_body_over_a_million_steps(compiled: None) -> None:
    problem = case("heavy").problem
    run = million_steps(Splitting(2), problem, 0.02)
    assert_error_does_not_grow(problem.energy(run.attitude, run.angular_velocity))
    upright = problem.invariants(run.attitude, run.angular_velocity)["angular momentum along (0, 0, 1) in space"]
    assert np.abs(upright - upright[0]).max() < 1e-11


def assert_error_does_not_grow(energy: np.ndarray) -> None:
    off = np.abs(energy / energy[0] - 1)
    assert off[-200:].max() < 1.5 * off[:200].max() + 1e-12


@pytest.mark.parametrize(("method", "step", "drift"), [(RungeKutta4(), 0.002, 1e-9), (Taylor(), 1e-17, 1e-12)])
def test_other_methods_keep_the_energy_of_a_free_body_over_many_steps(
    method: Integrator, step: float, drift: float, compiled: None
) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE)
    end = 0.002 * MILLION
    run = method.run(problem, np.linspace(0.0, end, 101), step)
    energy = problem.energy(run.attitude, run.angular_velocity)
    assert np.abs(energy / energy[0] - 1).max() < drift


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
    taken = quaternion.from_matrix(np.eye(3)[:, order])
    here = case("heavy").problem
    there = RotationProblem(
        np.array(MOMENTS)[order],
        np.array(SPIN)[order],
        quaternion.multiply(here.attitude, taken),
        (Gravity([0.0, 0.0, -9.8]),),
        mass=here.mass,
        arm=here.arm[order],
    )
    one, other = method.run(here, TIMES, control), method.run(there, TIMES, control)
    assert quaternion.angle_between(quaternion.multiply(one.attitude, taken), other.attitude).max() < 1e-14


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("method", [Taylor(), SciPy("DOP853"), SciPy("LSODA")], ids=lambda method: method.name)
def test_slow_and_fast_spins_are_equally_accurate(method: Integrator, scale: float) -> None:
    """A free body scaled by 2ⁿ in time moves through the same attitudes."""
    factor = 2.0 ** round(np.log2(scale))
    slow = RotationProblem(MOMENTS, np.array(SPIN) * factor, ATTITUDE)
    found = method.run(slow, TIMES / factor, 1e-10)
    assert case("free").truth.attitude_error(found.attitude).max() < 1e-8


def test_needle_keeps_its_digits(compiled: None) -> None:
    """I₃ = 1e-8: ω₃ is 1e8 times what its share of |L| says, and I₂ − I₁ ≤ I₃."""
    moments, spin = (1.0, 1.0 + 5e-9, 1e-8), (0.5, -0.25, 1.0)
    truth = oracle.rotate(moments, spin, [6.0])
    problem = RotationProblem(moments, spin)
    for method, control in ((Taylor(), 1e-17), (Splitting(8), 0.02)):
        found = method.run(problem, np.array([6.0]), control)
        assert truth.attitude_error(found.attitude)[0] < 3e-14
        assert truth.angular_velocity_error(found.angular_velocity)[0] < 3e-14


@pytest.mark.parametrize("order", COMPOSITIONS)
def test_compositions_are_symmetric_and_make_one_step(order: int) -> None:
    pairs = COMPOSITIONS[order]
    assert pairs.sum() == pytest.approx(1.0, abs=1e-15)
    assert (pairs == pairs[::-1, ::-1]).all()


def test_polynomial_methods_refuse_a_callable() -> None:
    problem = RotationProblem(MOMENTS, SPIN, loads=(Torque(lambda t, q, w: np.zeros(3)),))
    for method in (Taylor(), Splitting(4)):
        with pytest.raises(UsageError, match="Torque is no polynomial in the state: use DOP853"):
            method.run(problem, TIMES, 0.1)


def test_splitting_refuses_dissipation() -> None:
    with pytest.raises(UsageError, match="no exact flow for internal dissipation: use Taylor"):
        Splitting(2).run(RotationProblem(MOMENTS, SPIN, loads=(Dissipation(0.1),)), TIMES, 0.1)


def test_a_run_of_too_many_steps_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"RK4 needs 5e\+09 steps"):
        RungeKutta4().run(case("free").problem, TIMES, 1e-9)


def test_taylor_stops_at_its_limit(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loop, "MAX_STEPS", 10)
    with pytest.raises(GeometryError, match="Taylor stopped after 10 steps"):
        Taylor().run(case("free").problem, np.array([100.0]), 1e-10)
