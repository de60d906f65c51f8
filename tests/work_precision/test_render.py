"""The table and the document of a trade with a part and with a scene, from made-up rows."""

import json
from dataclasses import replace

import pytest
from tests.work_precision.samples import NEEDLE, ROWS, made_up
from tests.work_precision.scene_samples import CLOSED, LADDER
from tests.work_precision.scene_samples import made_up as scene_made_up

from inertia.work_precision.render import trade_document, trade_text
from inertia.work_precision.rows import Skipped

SKIPPED = (
    Skipped("exact over the whole mesh", "it does not fit into the budget", 123.4),
    Skipped("meshes of about 1/32 of the triangles and fewer", "manifold3d cannot simplify the surface"),
)


def test_a_row_states_its_time_its_errors_and_its_bound() -> None:
    lines = trade_text(made_up()).splitlines()
    first = next(line for line in lines if line.startswith("float64"))
    assert first.split() == ["float64", "8", "7.2–9.6", "5", *["3.0e-16"] * 3, "3.0e-14"]


def test_a_simpler_mesh_states_what_was_reached_and_what_it_cost() -> None:
    lines = trade_text(made_up()).splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("Mesh"))
    assert "Tol., mm" in lines[start]
    eighth = lines[start + 3].split()
    assert eighth == ["1/8", "1000", "0.8", "1", "s", "1", "0.9–1.2", "5", *["8.0e-03"] * 3, "1.0e-14"]


def test_the_columns_end_where_their_heads_do() -> None:
    lines = trade_text(made_up()).splitlines()
    whole, simplified = (
        next(k for k, line in enumerate(lines) if line.startswith(head)) for head in ("Method", "Mesh")
    )
    rows = [*lines[whole - 1 : whole + 4], *lines[simplified - 1 : simplified + 5]]
    assert {len(line) for line in rows} == {100}
    assert [line.index("tensor") for line in (lines[whole], lines[simplified])] == [84, 84]


@pytest.mark.parametrize("accuracy", [None, 1e-2, 1e-16])
def test_no_line_is_wider_than_100_columns(accuracy: float | None) -> None:
    text = trade_text(made_up(accuracy, skipped=SKIPPED))
    assert max(len(line) for line in text.splitlines() if not line.startswith("Part")) <= 100


def test_the_machine_and_what_was_assumed_are_said() -> None:
    text = trade_text(made_up())
    assert "Difference Engine, 1 core, Brass, Python 3.11.0, numpy 2.0.0; the times are of this machine" in flat(text)
    assert "mm (assumed)" in text
    assert "7850 kg/m³ (as given), for a mass of 0.00785 kg" in text
    assert "pairing its edges 12.3 ms, results with bounds 2 ms" in flat(text)


def test_what_was_skipped_is_said_with_its_estimate() -> None:
    text = flat(trade_text(made_up(skipped=SKIPPED)))
    assert (
        "exact over the whole mesh: it does not fit into the budget (about 123 s): give a larger budget Skipped"
    ) in text
    assert "manifold3d cannot simplify the surface Errors" in text


def flat(text: str) -> str:
    return " ".join(text.split())


def test_an_error_that_is_not_known_is_a_dash_and_none_is_0() -> None:
    unknown = replace(ROWS[0], error=None)
    nothing = replace(ROWS[1], error=replace(ROWS[1].error, volume=0.0))
    lines = trade_text(made_up(rows=(unknown, nothing))).splitlines()
    assert [line.split()[4] for line in lines if line[:6] in ("float6", "double")] == ["–", "0"]
    document = trade_document(made_up(rows=(unknown, nothing)))
    assert document["rows"][0]["error"] is None


def test_methods_that_lose_the_smallest_moment_are_named() -> None:
    properties = replace(NEEDLE, error=replace(NEEDLE.error, inertia=1e-12))
    text = flat(trade_text(made_up(rows=(replace(ROWS[0], properties=properties), ROWS[1]))))
    assert "Slender float64 leaves the smallest principal moment uncertain" in text
    assert "Slender" not in trade_text(made_up())


def test_a_time_stays_with_its_unit() -> None:
    lines = trade_text(made_up(skipped=SKIPPED)).splitlines()
    assert [line for line in lines if line.strip().split(" ")[0].startswith(("ms", "s,"))] == []


def test_seconds_do_without_powers_of_ten() -> None:
    slow = replace(ROWS[0], time=replace(ROWS[0].time, median=12.3456))
    assert " 12346 " in trade_text(made_up(rows=(slow,)))


def test_the_document_holds_every_row_in_si() -> None:
    document = json.loads(json.dumps(trade_document(made_up(1e-2, skipped=SKIPPED)), allow_nan=False))
    assert document["schema"] == "inertia/trade/1"
    assert document["machine"]["cpu"] == "Difference Engine"
    assert [row["mesh"] for row in document["rows"]] == ["whole", "whole", "whole", "1/2", "1/4", "1/8", "1/16"]
    eighth = document["rows"][5]
    assert eighth["time"] == pytest.approx({"median": 1e-3, "fastest": 0.9e-3, "slowest": 1.2e-3, "runs": 5})
    assert eighth["loses_smallest_moment"] is False
    assert eighth["error"] == {"volume": 8e-3, "center_of_mass_over_size": 8e-3, "inertia": 8e-3}
    assert eighth["simplification"] == {"share": 8, "tolerance": 8e-4, "seconds": 1.0}
    assert (eighth["mass"], eighth["volume"]) == (2.0, 1.0)
    assert document["skipped"][0]["seconds"] == 123.4
    assert document["recommendations"] == [
        {"coarsest": 1e-2, "finest": 1e-2, "row": 5, "sentence": made_up(1e-2).recommendations[0].sentence}
    ]


def test_a_recommendation_of_nothing_names_no_row() -> None:
    assert trade_document(made_up(1e-16))["recommendations"][0]["row"] is None


def test_the_table_of_a_scene_has_a_line_for_each_row_and_fits_the_page() -> None:
    lines = trade_text(scene_made_up()).splitlines()
    assert max(map(len, lines)) <= 100
    (line,) = [line for line in lines if line.startswith(CLOSED)]
    assert line.split()[-2:] == ["front", "plan"]
    assert "–" in line
    assert sum(line.startswith("Taylor") for line in lines) == 1  # named once, for three lines
    text = " ".join(" ".join(lines).split())
    assert "give a larger budget for Radau at 1e-05 rad and finer (12 s)" in text
    assert "splitting 2 at 1e-09 rad; splitting 4 at 1e-09 rad: splitting 2 reached 2e-9 rad" in text
    assert "asymmetric top, closed form: Jacobi elliptic functions, which its bound puts within 4e-15 rad" in text
    assert "the times are of this machine" in text


def test_the_document_of_a_scene_can_be_read_back() -> None:
    document = json.loads(json.dumps(trade_document(scene_made_up(1e-9)), allow_nan=False))
    assert (document["schema"], document["reference"], document["accuracy"]) == ("inertia/trade-scene/1", 0, 1e-9)
    assert document["rows"][0]["asked"] == list(LADDER)
    assert (document["rows"][0]["error"], document["rows"][0]["planned"]) == (None, True)
    assert [row["on_front"] for row in document["rows"]] == [True, True, True, True, False]
    (advice,) = document["recommendations"]
    assert (advice["row"], advice["coarsest"]) == (0, 1e-9)
