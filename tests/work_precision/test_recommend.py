"""Which row is recommended, of a part and of a scene, on made-up rows."""

from dataclasses import replace

import pytest
from tests.work_precision.samples import NEEDLE, ROWS, simpler, whole
from tests.work_precision.scene_samples import CLOSED, LADDER, stepped
from tests.work_precision.scene_samples import ROWS as SCENE_ROWS
from tests.work_precision.scene_samples import made_up as scene_made_up

from inertia.mass.properties import ErrorBound
from inertia.work_precision.recommend import advised, cheapest, part_recommendations, planned, scene_recommendations
from inertia.work_precision.rows import Skipped


@pytest.mark.parametrize(
    ("accuracy", "row"),
    [
        (0.5, 6),
        (0.2, 6),
        (0.1, 5),
        (8e-3, 5),
        (7.9e-3, 4),
        (1e-3, 3),
        (4e-4, 0),
        (3e-14, 0),
        (2.9e-14, 1),
        (1.2e-16, 1),
        (1.15e-16, 2),
        ("exact", 2),
    ],
)
def test_the_fastest_row_that_reaches_the_accuracy(accuracy: float, row: int) -> None:
    assert cheapest(ROWS, accuracy) is ROWS[row]


def test_nothing_reaches_what_is_finer_than_every_row() -> None:
    assert cheapest(ROWS, 1e-16) is None
    assert cheapest(ROWS[:2], "exact") is None


@pytest.mark.parametrize(("seconds", "taken"), [(0.0079, "whole"), (0.0065, "whole"), (0.0064, "1/2"), (0.004, "1/2")])
def test_a_simpler_mesh_must_be_worth_its_while(seconds: float, taken: str) -> None:
    rows = (whole("float64", 0.008, 1e-14), simpler(2, seconds, 1e-4))
    row = cheapest(rows, 1e-3)
    assert row is not None
    assert row.mesh == taken


def test_one_recommendation_for_the_accuracy_asked_for() -> None:
    (advice,) = part_recommendations(ROWS, (), 1e-2)
    assert (advice.coarsest, advice.finest, advice.row) == (1e-2, 1e-2, ROWS[5])
    assert advice.sentence == (
        "For 0.01: float64 over the mesh at 1/8 (1000 triangles), 1 ms instead of 8 ms for float64 over the whole one, "
        "off by 0.008; making it took 1 s, which pays after 143 integrations."
    )


def test_the_sentence_of_a_method_states_its_bound() -> None:
    (advice,) = part_recommendations(ROWS, (), 1e-12)
    assert advice.sentence == "For 1e-12: float64 over the whole mesh, 8 ms, within 3e-14 by its bound."


def test_without_an_accuracy_the_decades_are_gone_through() -> None:
    advices = part_recommendations(ROWS, (), None)
    assert [(advice.coarsest, advice.finest, advice.row) for advice in advices] == [
        (0.1, 0.01, ROWS[5]),
        (1e-3, 1e-3, ROWS[3]),
        (1e-4, 1e-13, ROWS[0]),
        (1e-14, 1e-15, ROWS[1]),
    ]
    assert advices[2].sentence.startswith("For 1e-4 to 1e-13: float64")


def test_a_simpler_mesh_without_loss_is_compared_with_what_each_accuracy_needs() -> None:
    rows = (*ROWS[:3], simpler(2, 0.004, 1e-16))
    coarse, fine = part_recommendations(rows, (), None)
    assert (coarse.finest, fine.coarsest) == (1e-13, 1e-14)
    assert "instead of 8 ms for float64 over the whole one" in coarse.sentence
    assert "instead of 40 ms for double-double over the whole one" in fine.sentence


def test_a_row_that_loses_the_smallest_moment_is_taken_only_where_no_other_reaches() -> None:
    uncertain = replace(NEEDLE, error=ErrorBound("float64", 1e-12, 1e-12, 0.0, 1e-12))
    assert (uncertain.loses_smallest_moment, NEEDLE.loses_smallest_moment) == (True, False)
    losing = replace(ROWS[0], properties=uncertain)
    assert cheapest((losing, ROWS[1]), 1e-3) is ROWS[1]
    assert cheapest((losing,), 1e-3) is losing


def test_what_no_row_reaches_is_said_with_the_nearest() -> None:
    (advice,) = part_recommendations(ROWS[:1], (), 1e-15)
    assert advice.row is None
    assert advice.sentence == "For 1e-15: no row reaches it, the nearest being float64 over the whole mesh with 3e-14."


def test_what_was_skipped_for_time_might_have_reached_it() -> None:
    (advice,) = part_recommendations(ROWS[:1], (Skipped("exact over the whole mesh", "no time", 99.0),), "exact")
    assert advice.row is None
    assert advice.sentence.endswith("but some were skipped: give a larger budget.")


def test_a_simpler_mesh_alone_is_compared_with_nothing() -> None:
    (advice,) = part_recommendations((simpler(2, 0.004, 1e-16),), (), 1e-15)
    assert advice.sentence.endswith("4 ms, off by 1e-16; making it took 1 s.")


def test_the_fastest_row_that_reaches_it_is_advised_where_it_pays() -> None:
    assert [advised(SCENE_ROWS, rung) for rung in LADDER] == [
        SCENE_ROWS[1],
        SCENE_ROWS[2],
        SCENE_ROWS[2],
        SCENE_ROWS[0],
    ]
    assert planned(SCENE_ROWS, 1e-5) is SCENE_ROWS[0]
    assert planned(SCENE_ROWS, 1e-6) is None


def test_what_the_planner_selects_is_advised_only_where_it_holds_what_it_says() -> None:
    off = stepped("Taylor", 1e-9, 0.001, 5e-9, planned=True)
    sound = stepped("RK4", 1e-9, 0.1, 1e-11)
    assert advised([off, sound], 1e-9) is sound


def test_one_sentence_for_each_range_with_one_answer() -> None:
    first, last = scene_made_up().recommendations
    assert (first.coarsest, first.finest, last.coarsest, last.finest) == (1e-3, 1e-7, 1e-9, 1e-9)
    assert first.sentence == (
        "For 0.001 to 1e-07 rad: Taylor asked for 1e-05 rad, 3 ms to 4 ms, off by 3e-08 rad, instead of 15 ms for "
        f"{CLOSED}, which the planner selects."
    )
    assert last.sentence == f"For 1e-09 rad: {CLOSED}, which the planner selects, 15 ms, off by 4e-15 rad at most."


def test_an_accuracy_beyond_all_rows_names_the_nearest() -> None:
    (advice,) = scene_recommendations(SCENE_ROWS[1:], LADDER, 1e-14)
    assert advice.row is None
    assert advice.sentence == "For 1e-14 rad: no row reaches it, the nearest being Taylor with 1e-12 rad."
