"""Numbers with a standard uncertainty, as they are written."""

import copy
import pickle

import pytest

from inertia import Estimate
from inertia.errors import UsageError


@pytest.mark.parametrize(
    ("text", "value", "uncertainty"),
    [
        ("7850", 7850, 0),
        ("7850±50", 7850, 50),
        ("7850+-50", 7850, 50),
        (" 7.85e3 +/- 5e1 ", 7850, 50),
        ("7850 ± 1%", 7850, 78.5),
        ("-2±1 %", -2, 0.02),
        ("7850\udcc2\udcb150", 7850, 50),  # as Python takes an argument in the locale C
    ],
)
def test_a_number_is_read_with_its_uncertainty(text: str, value: float, uncertainty: float) -> None:
    estimate = Estimate.parse(text)
    assert (estimate, estimate.uncertainty) == (value, uncertainty)


@pytest.mark.parametrize("text", ["", "±", "7850±", "±50", "a±b", "1±2±3", "7850±-50", "7850±inf", "1±nan", "-inf±1%"])
def test_what_is_none_is_refused(text: str) -> None:
    with pytest.raises(UsageError):
        Estimate.parse(text)


def test_copies_keep_the_uncertainty() -> None:
    estimate = Estimate(1.5, 0.1)
    for other in (copy.copy(estimate), copy.deepcopy(estimate), pickle.loads(pickle.dumps(estimate))):
        assert (other, other.uncertainty) == (1.5, 0.1)
    assert str(estimate) == f"{estimate}" == "1.5"


@pytest.mark.parametrize(
    ("value", "uncertainty"),
    [("1", 0.1), (None, 0), (True, 0), (1j, 0), (1, "0.1"), (1, None), (1, -0.1), (1, 10**400), (1, True)],
)
def test_an_estimate_is_of_numbers(value: object, uncertainty: object) -> None:
    with pytest.raises(UsageError, match=r"^(an estimate|a standard uncertainty) is "):
        Estimate(value, uncertainty)


def test_what_is_no_text_is_read_as_it_is_written() -> None:
    assert Estimate.parse(7850) == 7850
    with pytest.raises(UsageError, match="None is no number"):
        Estimate.parse(None)
