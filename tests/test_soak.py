"""A short form of the campaigns of `tests.soak`: no case ends in a fault, and a fault would be told."""

import os
import time
from pathlib import Path

import pytest
from tests.soak.campaigns import CAMPAIGNS
from tests.soak.command import fault_in
from tests.soak.workers import Outcome, run_cases

SHORT = {"meshes": 150, "documents": 16, "options": 40, "kills": 1, "cache_flips": 2, "full_disk": 1, "changing": 2}


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_no_case_ends_in_a_fault(name: str) -> None:
    tally = run_cases(CAMPAIGNS[name].with_seed(0), range(SHORT[name]))
    assert tally.faults == {}
    assert tally.counts.total() == SHORT[name]


def _odd(number: int) -> Outcome:
    match number:
        case 1:
            raise RuntimeError("what")
        case 2:
            os._exit(7)
        case 3:
            print("x", flush=True)
            Path("/proc/self/fd/1").write_text("x")
        case 4:
            time.sleep(100)
        case 5:
            while True:
                pass
    return Outcome("answered")


def test_crashes_and_hangs_are_told_of_their_own_case(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.soak.workers.TIME_LIMIT", 0.5)
    monkeypatch.setattr("tests.soak.workers.PATIENCE", 8.0)
    tally = run_cases(_odd, range(130))
    assert sorted(tally.faults) == [1, 2, 3, 4, 5]
    assert tally.counts.total() == 130
    assert "RuntimeError" in tally.faults[1]
    assert "ended with 7" in tally.faults[2]
    assert "printed past Python" in tally.faults[3]
    assert "no answer in 8 s" in tally.faults[4]
    assert "of computing" in tally.faults[5]


@pytest.mark.parametrize(
    ("code", "out", "err"),
    [
        (1, "", "inertia: a fault\n"),
        (0, "", ""),
        (0, '{"volume": NaN}', ""),
        (0, "{", ""),
        (3, "", "inertia: a\x1b[31m\n"),
        (3, "", "inertia: a\ninertia: b\n"),
        (4, "", "a.py:3: RuntimeWarning: overflow\ninertia: refused\n"),
        (3, "", "inertia: it needs more memory than there is\n"),
    ],
)
def test_faults_are_known_as_such(code: int, out: str, err: str) -> None:
    assert fault_in(code, out, err, True)
    assert not fault_in(0, '{"volume": 1.0}', "", True)
    assert not fault_in(3, "", "inertia: cannot read it\n", True)
