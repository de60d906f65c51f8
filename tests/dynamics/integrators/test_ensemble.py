import numpy as np
import pytest
from tests.dynamics.integrators.loaded import MOMENTS, SPIN, case

from inertia.dynamics.integrators.ensemble import step_ensemble
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError, UsageError
from inertia.native import Kernel


@pytest.fixture(params=[True, False], ids=["compiled", "numpy"], autouse=True)
def path(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Kernel, "worthwhile", lambda self, count: request.param)


def test_error_falls_with_the_fourth_power_of_the_step() -> None:
    known = case("free")
    errors = []
    for steps in (100, 200, 400):
        attitude, _ = step_ensemble(MOMENTS, [SPIN], 5.0, steps)
        turned = quaternion.multiply(known.problem.attitude, attitude[0])
        errors.append(known.truth.attitude_error(np.array([turned] * 3))[2])
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(4.0, abs=0.2)


def test_every_body_of_an_ensemble_moves_as_if_alone() -> None:
    rng = np.random.default_rng(7)
    spins = rng.normal(size=(37, 3))
    moments = 1.0 + rng.uniform(size=(37, 3))
    attitude, spin = step_ensemble(moments, spins, 3.0, 50)
    for k in (0, 15, 16, 36):
        alone, spun = step_ensemble(moments[k], spins[k : k + 1], 3.0, 50)
        assert attitude[k] == pytest.approx(alone[0], abs=1e-15)
        assert spin[k] == pytest.approx(spun[0], abs=1e-15)


def test_ensemble_runs_back() -> None:
    spins = np.random.default_rng(8).normal(size=(20, 3))
    attitude, spin = step_ensemble(MOMENTS, spins, 2.0, 400)
    back, slowed = step_ensemble(MOMENTS, -spin, 2.0, 400)
    assert slowed == pytest.approx(-spins, abs=1e-8)
    assert quaternion.angle_between(quaternion.multiply(attitude, back), quaternion.IDENTITY).max() < 1e-7


@pytest.mark.parametrize(
    ("moments", "spins", "duration", "steps", "error", "says"),
    [
        ([1, 2, 3], [1, 2, 3], 1.0, 10, UsageError, r"shape \(m, 3\), not \(3,\)"),
        ([1, 2, 3], [[1, 2, np.inf]], 1.0, 10, UsageError, "finite"),
        ([[1, 2, 3]] * 2, [[1, 2, 3]] * 3, 1.0, 10, UsageError, r"moments have shape \(2, 3\)"),
        ([1, 0, 3], [[1, 2, 3]], 1.0, 10, GeometryError, r"moments\[0\]"),
        ([1, 2, 3], [[1, 2, 3]], np.nan, 10, UsageError, "duration is nan"),
        ([1, 2, 3], [[1, 2, 3]], 1.0, 0, UsageError, "at least one step"),
    ],
)
def test_arguments_that_cannot_be_used(
    moments: object, spins: object, duration: float, steps: int, error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says):
        step_ensemble(moments, spins, duration, steps)  # type: ignore[arg-type]
