import numpy as np
import pytest

from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.losses import Dissipation
from inertia.dynamics.loads.torque import Torque
from inertia.errors import GeometryError, UsageError

WEIGHT = Gravity([0, 0, -10.0])


def test_rhs_is_eulers_equations_and_half_q_omega() -> None:
    """I = (1, 2, 4), ω = (1, 2, 3), N₃ = 8: ω̇ = ((2−4)·6, (4−1)·3/2, ((1−2)·2 + 8)/4)."""
    problem = RotationProblem([1.0, 2.0, 4.0], [1.0, 2.0, 3.0], loads=(Torque([0.0, 0.0, 8.0]),))
    rate = problem.rhs(0.0, np.array([0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0]))
    assert rate.tolist() == [0.5, 1.0, 1.5, 0.0, -12.0, 4.5, 1.5]


def test_rhs_keeps_the_momentum_in_space_with_dissipation() -> None:
    """d(R I ω)/dt = 0 by central differences along the flow."""
    problem = RotationProblem([1.0, 2.0, 2.5], [1.0, -2.0, 0.5], loads=(Dissipation(0.3),))
    state = np.array([*quaternion.normalise([0.1, 0.5, -0.3, 0.6]), 1.0, -2.0, 0.5])
    h = 1e-5
    ends = [state + s * h * problem.rhs(0.0, state) for s in (1, -1)]
    momenta = [problem.angular_momentum(quaternion.normalise(end[:4]), end[4:]) for end in ends]
    assert (momenta[0] - momenta[1]) / (2 * h) == pytest.approx(np.zeros(3), abs=1e-8)


def test_energy_is_kinetic_and_potential() -> None:
    top = RotationProblem([1.0, 2.0, 4.0], [1.0, 1.0, 1.0], loads=(WEIGHT,), mass=2.0, arm=[0, 0, 0.5])
    assert top.energy(np.array(quaternion.IDENTITY), np.ones(3)) == 3.5 + 10.0


@pytest.mark.parametrize(
    ("spin", "torque", "least"), [([3.0, 0.0, 0.0], 0.0, 3.0), ([0.0, 0.0, 0.0], 8.0, 2.0), ([1.0, 0, 0], 200.0, 10.0)]
)
def test_rate_is_that_of_the_spin_or_of_the_torque(spin: list[float], torque: float, least: float) -> None:
    """A power of two above |ω| and √(N/I)."""
    problem = RotationProblem([1.0, 1.5, 2.0], spin, loads=(Torque([0.0, 0.0, torque]),))
    assert least < problem.rate <= 2 * least
    assert np.log2(problem.rate) % 1 == 0


def test_heavy_symmetric_top_keeps_three_things() -> None:
    top = RotationProblem([2.0, 2.0, 4.0], [1.0, 1.0, 1.0], loads=(WEIGHT,), mass=2.0, arm=[0, 0, 0.5])
    invariants = top.invariants(top.attitude, top.angular_velocity)
    assert set(invariants) == {
        "energy",
        "angular momentum along (0, 0, 1) in space",
        "angular momentum about body axis 3",
    }
    leaning = RotationProblem([2.0, 2.0, 4.0], [1.0, 1.0, 1.0], loads=(WEIGHT,), mass=2.0, arm=[0, 0.1, 0.5])
    assert "angular momentum about body axis 3" not in leaning.invariants(top.attitude, top.angular_velocity)


@pytest.mark.parametrize(
    ("moments", "attitude", "error", "says"),
    [
        ([1.0, 2.0, 0.0], quaternion.IDENTITY, GeometryError, "all three > 0"),
        ([1.0, 2.0], quaternion.IDENTITY, UsageError, "moments must have shape"),
        ([1.0, 2.0, 3.0], (0.0, 0.0, 0.0, 0.0), UsageError, "zero quaternion"),
        ([1.0, 2.0, 3.0], (0.0, 0.0, np.nan, 0.0), UsageError, "attitude holds a value"),
    ],
)
def test_problems_that_cannot_be(
    moments: list[float], attitude: tuple[float, ...], error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says):
        RotationProblem(moments, [1.0, 0.0, 0.0], attitude)  # type: ignore[arg-type]
