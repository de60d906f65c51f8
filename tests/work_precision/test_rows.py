"""The Pareto front, on made-up rows."""

from tests.work_precision.scene_samples import ROWS, closed

from inertia.work_precision.rows import front


def test_the_front_is_what_nothing_betters_the_fastest_first() -> None:
    assert front(ROWS) == [ROWS[1], ROWS[2], ROWS[3], ROWS[0]]
    assert front([ROWS[0], closed(seconds=0.02)]) == [ROWS[0]]
