"""The Taylor method: its error against its tolerance, what it keeps, and where it stops."""

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import ATTITUDE, LOADS, MOMENTS, SPIN, TIMES, case

from inertia.dynamics.integrators import loop
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.taylor import Taylor
from inertia.errors import GeometryError


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-10, 1e-17])
def test_error_follows_the_tolerance(tolerance: float, name: str, path: str) -> None:
    known = case(name)
    run = Taylor().run(known.problem, TIMES, tolerance)
    assert known.truth.attitude_error(run.attitude).max() < max(50 * tolerance, 2e-14)


def test_energy_of_a_free_body_is_kept_over_many_steps(compiled: None) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE)
    run = Taylor().run(problem, np.linspace(0.0, 2000.0, 101), 1e-17)
    energy = 0.5 * (MOMENTS * run.angular_velocity**2).sum(axis=1)
    assert np.abs(energy / energy[0] - 1).max() < 1e-12


def test_a_run_stops_at_the_limit_of_steps(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loop, "MAX_STEPS", 10)
    with pytest.raises(GeometryError, match="Taylor stopped after 10 steps"):
        Taylor().run(case("free").problem, np.array([100.0]), 1e-10)
