"""heyoka's Taylor method against the oracle, and without heyoka."""

import sys

import pytest
from tests.dynamics.integrators.loaded import LOADS, TIMES, case

from inertia.dynamics.integrators.heyoka_taylor import Heyoka
from inertia.errors import UsageError


@pytest.mark.parametrize("name", LOADS)
def test_error_follows_the_tolerance(name: str) -> None:
    pytest.importorskip("heyoka")
    known = case(name)
    runs = [Heyoka().run(known.problem, TIMES, tolerance) for tolerance in (1e-8, 1e-16)]
    loose, tight = (known.truth.attitude_error(run.attitude).max() for run in runs)
    assert tight < 5e-15
    assert tight < loose < 1e-6


def test_without_heyoka_its_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "heyoka", None)
    with pytest.raises(UsageError, match=r"pip install 'inertia\[heyoka\]'"):
        Heyoka().run(case("free").problem, TIMES, 3.3e-7)
