"""SciPy's methods against the oracle."""

import pytest
from tests.dynamics.integrators.loaded import LOADS, TIMES, case

from inertia.dynamics.integrators.scipy_methods import SciPy


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("scipy", ["DOP853", "LSODA", "Radau"])
def test_error_follows_the_tolerance(scipy: str, name: str) -> None:
    known = case(name)
    runs = [SciPy(scipy).run(known.problem, TIMES, tolerance) for tolerance in (1e-5, 1e-8)]
    loose, tight = (known.truth.attitude_error(run.attitude).max() for run in runs)
    assert tight < 1e-6
    assert tight < loose < 3e-3
