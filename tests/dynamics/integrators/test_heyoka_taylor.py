"""heyoka's Taylor method against the oracle, and without heyoka."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import LOADS, TIMES, case

from inertia.dynamics.integrators.heyoka_taylor import Heyoka, compiled
from inertia.errors import UsageError


@pytest.mark.parametrize("name", LOADS)
def test_error_follows_the_tolerance(name: str) -> None:
    pytest.importorskip("heyoka")
    known = case(name)
    runs = [Heyoka().run(known.problem, TIMES, tolerance) for tolerance in (1e-8, 1e-16)]
    loose, tight = (known.truth.attitude_error(run.attitude).max() for run in runs)
    assert tight < 5e-15
    assert tight < loose < 1e-6


def test_threads_do_not_share_a_motion_under_way() -> None:
    pytest.importorskip("heyoka")
    known = case("free")

    def attitude(_: int) -> bytes:
        return np.asarray(Heyoka().run(known.problem, TIMES, 1e-10).attitude).tobytes()

    with ThreadPoolExecutor(4) as pool:
        assert {*pool.map(attitude, range(200))} == {attitude(0)}


def test_without_heyoka_its_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled.cache_clear()  # what an earlier test compiled needs no import
    monkeypatch.setitem(sys.modules, "heyoka", None)
    with pytest.raises(UsageError, match=r"pip install 'inertia\[heyoka\]'"):
        Heyoka().run(case("free").problem, TIMES, 3.3e-7)
