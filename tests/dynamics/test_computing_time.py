"""The forecast of the time that a run takes counts what is behind it."""

import re
import time
import tomllib
from typing import Any

import numpy as np
import pytest

from inertia.dynamics import computing_time
from inertia.dynamics.computing_time import Watch, limited
from inertia.dynamics.integrators import methods
from inertia.dynamics.integrators.loop import Stepper
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.scipy_methods import SciPy
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError
from inertia_meshes import path


def test_the_forecast_is_above_the_limit_where_the_loops_before_have_taken_most_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    monkeypatch.setattr(computing_time.time, "process_time", lambda: now)
    with limited(20.0):
        now = 17.0  # another loop ran so long
        watch = Watch()
        now = 18.5
        with pytest.raises(GeometryError, match="the limit is 20 s") as caught:
            watch.require(0.1)
    said = re.search(r"would take some (\S+) s", str(caught.value))
    assert said
    assert float(said[1]) == pytest.approx(17.0 + 1.5 / 0.1, rel=0.05)


def test_steps_on_the_way_to_the_first_sample_count_in_the_forecast(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = 0

    def torque(time: float, attitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        nonlocal steps
        steps += 1
        return np.array([0.0, 0.0, 1.0])

    monkeypatch.setattr(computing_time.time, "process_time", lambda: 0.02 * steps)
    monkeypatch.setattr(computing_time.time, "perf_counter", lambda: 0.02 * steps)
    problem = RotationProblem([1.0, 2.0, 3.0], [0.1, 0.2, 1.0], loads=(Torque(torque, breaks=[], longest_step=9.0),))
    with limited(60.0):  # of which some 8 pass on the way to the only sample
        states = methods.METHODS["RK4"].run(problem, np.array([10.0]), 0.1)
    assert 4 * states.steps * 0.02 > 5.0


def test_what_is_loaded_before_the_first_step_is_in_no_forecast(monkeypatch: pytest.MonkeyPatch) -> None:
    begin, lost = SciPy.stepper, 0.0

    def slowly(*arguments: Any) -> Stepper:
        nonlocal lost
        lost += 5.0
        return begin(*arguments)

    clock = time.process_time
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    monkeypatch.setattr(SciPy, "stepper", slowly)
    monkeypatch.setattr(computing_time.time, "process_time", lambda: clock() + lost)
    table = tomllib.loads(path("scenes/tippe_top.toml").read_text(encoding="utf-8"))
    table["run"] |= {"duration": 0.2, "samples": 3, "time_limit": 600.0}
    assert simulate(Scene.from_dict(table)).steps > 0
    assert lost > 0.0
