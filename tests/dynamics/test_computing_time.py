"""The forecast of the time that a run takes counts what is behind it."""

import re
import time
import tomllib
from typing import Any

import pytest

from inertia.dynamics import computing_time
from inertia.dynamics.computing_time import Watch, limited
from inertia.dynamics.integrators.loop import Stepper
from inertia.dynamics.integrators.scipy_methods import SciPy
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


def test_what_is_loaded_before_the_first_step_is_in_no_forecast(monkeypatch: pytest.MonkeyPatch) -> None:
    begin, lost = SciPy.stepper, 0.0

    def slowly(*arguments: Any) -> Stepper:
        nonlocal lost
        lost += 5.0
        return begin(*arguments)

    clock = time.process_time
    monkeypatch.setattr(SciPy, "stepper", slowly)
    monkeypatch.setattr(computing_time.time, "process_time", lambda: clock() + lost)
    table = tomllib.loads(path("scenes/tippe_top.toml").read_text(encoding="utf-8"))
    table["run"] |= {"duration": 0.2, "samples": 3, "time_limit": 600.0}
    assert simulate(Scene.from_dict(table)).steps > 0
