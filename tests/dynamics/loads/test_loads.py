import numpy as np
import pytest

from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import torque
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity, GravityGradient
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.losses import Damping, Dissipation
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.stepped.solve import solve_stepped
from inertia.errors import GeometryError, UsageError

MOMENTS = np.array([1.0, 2.0, 2.5])
GRAVITY = Gravity([1.0, 2.0, -9.0])
GRADIENT = GravityGradient(5.0, [1.0, -2.0, 0.5])
ATTITUDE = quaternion.normalise([0.1, -0.4, 0.3, 0.7])
SPIN = np.array([0.3, -1.0, 2.0])
BODY = RotationProblem(MOMENTS, SPIN, mass=2.0, arm=[0.1, -0.2, 0.3])


@pytest.mark.parametrize("load", [GRAVITY, GRADIENT])
def test_torque_is_minus_the_gradient_of_the_potential(load: Load) -> None:
    """V along turns about the body axes, by central differences."""
    h = 1e-5
    slopes = [
        (
            load.potential(quaternion.multiply(ATTITUDE, quaternion.from_rotation_vector(h * axis)), BODY)
            - load.potential(quaternion.multiply(ATTITUDE, quaternion.from_rotation_vector(-h * axis)), BODY)
        )
        / (2 * h)
        for axis in np.eye(3)
    ]
    assert load.torque_at(0.0, ATTITUDE, SPIN, BODY) == pytest.approx(-np.array(slopes), abs=1e-8)


def test_weight_of_a_level_arm_turns_about_the_horizontal_axis() -> None:
    body = RotationProblem(MOMENTS, SPIN, mass=3.0, arm=[0.5, 0.0, 0.0])
    weight = Gravity([0.0, 0.0, -10.0])
    assert weight.torque_at(0.0, np.array(quaternion.IDENTITY), SPIN, body).tolist() == [0.0, 15.0, 0.0]


def test_gravity_gradient_of_a_tilted_body() -> None:
    """Primary at 45° between axes 1 and 2, at distance 2: N₃ = 3 μ/r³ (I₂ − I₁)/2."""
    load = GravityGradient(8.0, [2**0.5, 2**0.5, 0.0])
    torque_there = load.torque_at(0.0, np.array(quaternion.IDENTITY), SPIN, BODY)
    assert torque_there == pytest.approx([0.0, 0.0, 1.5], abs=1e-15)


@pytest.mark.parametrize(
    "load", [GRAVITY, GRADIENT, Torque([1.0, 2.0, 3.0]), Torque([1.0, 2.0, 3.0], frame="space"), Damping(0.0)]
)
@pytest.mark.parametrize(("inertia", "rate"), [(1.0, 1.0), (4.0, 0.25)])
def test_terms_make_the_same_torque(load: Load, inertia: float, rate: float) -> None:
    terms = load.terms(BODY, 0.0)
    assert terms is not None
    torque_there = torque(terms.packed(inertia, rate), 7.0, ATTITUDE) * inertia * rate**2
    assert torque_there == pytest.approx(load.torque_at(7.0, ATTITUDE, SPIN, BODY), rel=1e-14, abs=1e-14)


def test_torque_in_space_is_turned_into_the_body() -> None:
    torque_there = Torque([0.0, 0.0, 2.0], frame="space").torque_at(0.0, ATTITUDE, SPIN, BODY)
    assert quaternion.to_space(ATTITUDE, torque_there) == pytest.approx([0.0, 0.0, 2.0], abs=1e-15)


def test_spherical_body_slows_down_about_its_axis() -> None:
    """ω = ω₀ exp(−d t/I), turned by ω₀ (I/d)(1 − exp(−d t/I))."""
    problem = RotationProblem([2.0, 2.0, 2.0], [0.6, 0.0, 0.8], loads=(Damping(0.5),))
    motion = solve_stepped(problem, [0.0, 4.0, 40.0], 1e-11)
    left = np.exp(-np.array([0.0, 1.0, 10.0]))
    axis = np.array([0.6, 0.0, 0.8])
    assert motion.angular_velocity == pytest.approx(left[:, None] * axis, abs=1e-12)
    expected = quaternion.from_rotation_vector(4.0 * (1 - left)[:, None] * axis)
    assert quaternion.angle_between(motion.attitude, expected).max() < 1e-11


def test_dissipation_closes_the_cone_of_a_symmetric_body() -> None:
    """With u = cos²θ, u̇ = 2 λ u (1 − u), λ = κ (I₃ − I₁) L²/(I₁³ I₃), from κ |ω̇|² = −Ė; L stays in space."""
    kappa = 0.05
    problem = RotationProblem([2.0, 2.0, 3.0], [2.0, 0.0, 0.5], ATTITUDE, loads=(Dissipation(kappa),))
    time = np.linspace(0.0, 20.0, 9)
    motion = solve_stepped(problem, time, 1e-11)
    momentum = 16.0 + 2.25
    rate = kappa * 1.0 * momentum / (8.0 * 3.0)
    grown = 2.25 / momentum * np.exp(2 * rate * time)
    share = (3.0 * motion.angular_velocity[:, 2]) ** 2 / momentum
    assert share == pytest.approx(grown / (16.0 / momentum + grown), rel=1e-12)
    kept = motion.invariants["angular momentum"]
    assert np.abs(kept - kept[0]).max() < 1e-13 * momentum**0.5


def test_dissipation_ends_on_the_axis_of_the_largest_moment() -> None:
    """Explorer 1: set going about its long axis, it ends in a flat spin; the energy never rises."""
    problem = RotationProblem([1.0, 2.5, 2.0], [3.0, 0.01, 0.02], loads=(Dissipation(0.5),))
    motion = solve_stepped(problem, np.linspace(0.0, 200.0, 401), 1e-9)
    energy = problem.energy(motion.attitude, motion.angular_velocity)
    assert (np.diff(energy) <= 1e-13).all()
    momentum = np.linalg.norm(problem.moments * problem.angular_velocity)
    assert np.abs(motion.angular_velocity[-1]) == pytest.approx([0.0, momentum / 2.5, 0.0], abs=1e-4)
    assert "energy" not in motion.invariants


def test_dissipated_power_is_the_rate_times_the_square_of_the_acceleration() -> None:
    problem = RotationProblem([1.0, 2.0, 2.5], [1.0, 2.0, -0.5], loads=(Dissipation(1e-3),))
    free = RotationProblem([1.0, 2.0, 2.5], [1.0, 2.0, -0.5])
    state = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 2.0, -0.5])
    power = (problem.moments * state[4:] * problem.rhs(0.0, state)[4:]).sum()
    assert power == pytest.approx(-1e-3 * (free.rhs(0.0, state)[4:] ** 2).sum(), rel=1e-12)


@pytest.mark.parametrize(
    ("make", "error", "says"),
    [
        (lambda: RotationProblem(MOMENTS, SPIN, loads=(GRAVITY,), arm=[0, 0, 1]), GeometryError, "mass is 0 kg"),
        (lambda: RotationProblem(MOMENTS, SPIN, mass=1.0, arm=[0, 0]), UsageError, "arm must have shape"),
        (lambda: Gravity([0, 0, np.nan]), UsageError, r"acceleration\[2\] is nan: it must be finite"),
        (lambda: Torque([1, 2, 3], frame="body"), UsageError, "frame is 'body'"),
        (lambda: Torque([1, 2]), UsageError, "must be three numbers"),
        (lambda: Torque(), UsageError, "give either torque or table"),
        (lambda: Damping(-1.0), UsageError, "coefficient is -1.0"),
        (lambda: Damping([1.0, 2.0]), UsageError, "it must be a number of N m s"),
        (lambda: GravityGradient(-1.0, [1, 0, 0]), UsageError, "mu is -1"),
        (lambda: GravityGradient(1.0, [0, 0, 0]), GeometryError, "position is zero"),
        (lambda: Dissipation(-1.0), UsageError, "rate is -1"),
    ],
)
def test_loads_that_cannot_be(make: object, error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says):
        make()  # type: ignore[operator]


def test_a_torque_function_must_return_three_numbers() -> None:
    problem = RotationProblem(MOMENTS, SPIN, loads=(Torque(lambda t, q, w: np.zeros(2)),))
    with pytest.raises(UsageError, match="at t = 0 s: return three finite numbers"):
        solve_stepped(problem, [0.0, 1.0], 1e-6)
