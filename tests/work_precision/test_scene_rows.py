"""What is made of the rows of a scene: the front, the recommendation, the table, the document, the diagram."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.work_precision.scene_samples import CLOSED, LADDER, ROWS, closed, made_up, stepped

from inertia.errors import UsageError
from inertia.work_precision.scene_plot import plot_scene
from inertia.work_precision.scene_recommend import advised, planned, scene_recommendations
from inertia.work_precision.scene_render import scene_trade_document, scene_trade_text
from inertia.work_precision.scene_rows import front


def test_the_front_is_what_nothing_betters_the_fastest_first() -> None:
    assert front(ROWS) == [ROWS[1], ROWS[2], ROWS[3], ROWS[0]]
    assert front([ROWS[0], closed(seconds=0.02)]) == [ROWS[0]]


def test_the_fastest_row_that_reaches_it_is_advised_where_it_pays() -> None:
    assert [advised(ROWS, rung) for rung in LADDER] == [ROWS[1], ROWS[2], ROWS[2], ROWS[0]]
    assert planned(ROWS, 1e-5) is ROWS[0]
    assert planned(ROWS, 1e-6) is None


def test_what_the_planner_selects_is_advised_only_where_it_holds_what_it_says() -> None:
    off = stepped("Taylor", 1e-9, 0.001, 5e-9, planned=True)
    sound = stepped("RK4", 1e-9, 0.1, 1e-11)
    assert advised([off, sound], 1e-9) is sound


def test_one_sentence_for_each_range_with_one_answer() -> None:
    first, last = made_up().recommendations
    assert (first.coarsest, first.finest, last.coarsest, last.finest) == (1e-3, 1e-7, 1e-9, 1e-9)
    assert first.sentence == (
        "For 0.001 to 1e-07 rad: Taylor asked for 1e-05 rad, 3 ms to 4 ms, off by 3e-08 rad, instead of 15 ms for "
        f"{CLOSED}, which the planner selects."
    )
    assert last.sentence == f"For 1e-09 rad: {CLOSED}, which the planner selects, 15 ms, off by 4e-15 rad at most."


def test_an_accuracy_beyond_all_rows_names_the_nearest() -> None:
    (advice,) = scene_recommendations(ROWS[1:], LADDER, 1e-14)
    assert advice.row is None
    assert advice.sentence == "For 1e-14 rad: no row reaches it, the nearest being Taylor with 1e-12 rad."


def test_the_table_has_a_line_for_each_row_and_fits_the_page() -> None:
    lines = scene_trade_text(made_up()).splitlines()
    assert max(map(len, lines)) <= 100
    (line,) = [line for line in lines if line.startswith(CLOSED)]
    assert line.split()[-2:] == ["front", "plan"]
    assert "–" in line
    assert sum(line.startswith("Taylor") for line in lines) == 1  # named once, for three lines
    said = " ".join(" ".join(lines).split())
    assert "give a larger --budget for Radau at 1e-05 rad and finer (12 s)" in said
    assert "splitting 2 at 1e-09 rad; splitting 4 at 1e-09 rad: splitting 2 reached 2e-9 rad" in said
    assert "asymmetric top, closed form: Jacobi elliptic functions, which its bound puts within 4e-15 rad" in said
    assert "the times are of this machine" in said


def test_the_document_can_be_read_back() -> None:
    document = json.loads(json.dumps(scene_trade_document(made_up(1e-9)), allow_nan=False))
    assert (document["schema"], document["reference"], document["accuracy"]) == ("inertia/trade-scene/1", 0, 1e-9)
    assert document["rows"][0]["asked"] == list(LADDER)
    assert (document["rows"][0]["error"], document["rows"][0]["planned"]) == (None, True)
    assert [row["on_front"] for row in document["rows"]] == [True, True, True, True, False]
    (advice,) = document["recommendations"]
    assert (advice["row"], advice["coarsest"]) == (0, 1e-9)


def test_the_diagram_names_every_method(tmp_path: Path) -> None:
    for name in ("one.svg", "two.svg"):
        plot_scene(made_up(1e-7), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()
    texts = ElementTree.parse(tmp_path / "one.svg").iter("{http://www.w3.org/2000/svg}text")
    said = " ".join("".join(text.itertext()) for text in texts)
    for word in (CLOSED, "Taylor", "RK4", "front", "what the planner selects", "accuracy asked for", "attitude error"):
        assert word in said
    with pytest.raises(UsageError, match="--force"):
        plot_scene(made_up(), tmp_path / "one.svg")
