"""The forecast of the time that a run takes counts what is behind it."""

import re

import pytest

from inertia.dynamics import computing_time
from inertia.dynamics.computing_time import Watch, limited
from inertia.errors import GeometryError


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
