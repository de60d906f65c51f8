import numpy as np
import pytest

from inertia.dynamics.integrators.events import find_events
from inertia.errors import UsageError

TIME = np.linspace(0.0, 10.0, 41)


def sine(state: float) -> float:
    return float(np.sin(state))


@pytest.mark.parametrize(("direction", "expected"), [(0, [1, 2, 3]), (1, [2]), (-1, [1, 3])])
def test_zeros_of_a_sine_are_found_to_rounding(direction: int, expected: list[int]) -> None:
    zeros = find_events(sine, TIME, np.sin(TIME), lambda t: t, direction=direction)
    assert zeros == pytest.approx(np.pi * np.array(expected), abs=1e-14)


def test_zero_at_a_sample_counts_once_and_only_where_the_sign_changes() -> None:
    time = np.arange(5.0)
    assert find_events(lambda x: x - 2.0, time, time - 2.0, lambda t: t).tolist() == [2.0]
    assert find_events(lambda x: (x - 2.0) ** 2, time, (time - 2.0) ** 2, lambda t: t).size == 0


def test_a_function_that_starts_at_zero_is_no_event() -> None:
    assert find_events(sine, TIME[:10], np.sin(TIME[:10]), lambda t: t).size == 0


def test_only_the_intervals_with_a_change_are_refined() -> None:
    instants = []

    def refine(t: float) -> float:
        instants.append(t)
        return t

    find_events(lambda x: x - 3.1, TIME, TIME - 3.1, refine)
    assert instants
    assert all(3.0 < t < 3.25 for t in instants)


@pytest.mark.parametrize("values", [np.zeros(3), np.full(41, np.nan)])
def test_values_that_cannot_be_used(values: np.ndarray) -> None:
    with pytest.raises(UsageError, match="events need finite values at every time"):
        find_events(sine, TIME, values, lambda t: t)
