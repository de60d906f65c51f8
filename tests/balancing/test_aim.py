"""What is planned for: rotors out of tolerance, with too few parts within it, or to be left with less."""

from pathlib import Path

import pytest
from tests.mesh.solids import as_ply, box

from inertia.balancing.balance import Balance, balance
from inertia.balancing.rotor import Rotor
from inertia.report.balance.document import balance_document
from inertia.report.balance.figures import report_data

LIMIT = 14.324  # µm, of G6.3 at 4200 r/min
FREE = {"method": "add"}
COARSE = {"method": "kit", "kit": [{"mass_g": 5.0}], "angles": {"count": 5, "offset": 40}}
METHODS = {
    "masses": {"method": "add", "mass_step_g": 0.05, "angle_step": 15},
    "stepped": {"method": "add", "mass_step_g": 0.1, "max_mass_g": 0.3, "angles": {"count": 5, "offset": 20}},
    "kit": {"method": "kit", "kit": [{"mass_g": 0.13}, {"mass_g": 0.21, "stock": 3}], "angles": {"count": 6}},
    "drilled": {"method": "drill_axial", "diameters": [3], "depth_step": 1, "radius": 15, "max_depth": 20},
}


def of_box(folder: Path, off: float, plane: dict, plan: dict | None = None, **body: float) -> Balance:
    """Balance a box of 1 kg whose middle is off the shaft, µm, in planes at its ends."""
    as_ply(folder / "box.ply", *box((-20 + 1e-3 * off, -20, 10), (20 + 1e-3 * off, 20, 90)))
    ends = [{"id": "I", "z": 10, "radius": 20, **plane}, {"id": "II", "z": 90, "radius": 20, **plane}]
    if plane["method"] == "drill_axial":
        ends = [{**end, "face": face} for end, face in zip(ends, "ab", strict=True)]
    described = {
        "body": [{"file": "box.ply", "density": 7850, "unit": "mm", **body}],
        "axis": {"bearing_a": [0, 0, 0], "bearing_b": [0, 0, 100]},
        "service": {"rpm": 4200},
        "tolerance": {"grade": 6.3},
        "plane": ends,
        "plan": plan or {},
    }
    return balance(Rotor.from_dict(described, folder))


def test_a_rotor_within_its_tolerance_is_left_as_it_is(tmp_path: Path) -> None:
    result = of_box(tmp_path, 12.0, FREE)
    assert result.correction is not None
    assert (result.correction.operations, result.verdict.outcome) == ((), "pass")
    assert result.correction.why == "already within the tolerance"
    shown = balance_document(report_data(result))["correction"]
    assert [shown[key] for key in ("left", "left_at_least")] == pytest.approx([12.0 / LIMIT] * 2, rel=1e-3)


@pytest.mark.parametrize("off", [12.0, 13.5, 14.5])
def test_where_too_few_parts_are_within_tolerance_it_is_planned(tmp_path: Path, off: float) -> None:
    result = of_box(tmp_path, off, FREE, eccentricity=0.004)
    assert result.correction is not None
    assert result.correction.operations
    assert result.verdict.outcome == "pass"


@pytest.mark.parametrize(("aim", "left"), [(0.6, 0.6), (0.3, 0.3), ("least", 1e-6)])
def test_an_aim_that_is_stated_is_planned_for(tmp_path: Path, aim: float | str, left: float) -> None:
    result = of_box(tmp_path, 12.0, FREE, {"aim": aim})
    assert result.correction is not None
    assert result.correction.operations
    assert result.correction.worst <= left


def test_an_aim_that_is_met_already_asks_for_nothing(tmp_path: Path) -> None:
    correction = of_box(tmp_path, 12.0, FREE, {"aim": 0.9}).correction
    assert correction is not None
    assert (correction.operations, correction.why) == ((), "already within the tolerance")


@pytest.mark.parametrize(("aim", "missed"), [(0.3, "30 % of it or less"), ("least", "less")])
def test_an_aim_that_no_plan_meets_is_named(tmp_path: Path, aim: float | str, missed: str) -> None:
    correction = of_box(tmp_path, 12.0, COARSE, {"aim": aim}).correction
    assert correction is not None
    assert not correction.operations
    assert correction.why == f"already within the tolerance, 83.8 % of it; no plan was found that leaves {missed}"
    assert correction.worst == correction.bound == pytest.approx(12.0 / LIMIT, rel=1e-3)


@pytest.mark.parametrize("off", [12.0, 40.0])
@pytest.mark.parametrize("method", METHODS)
def test_the_least_is_never_more_than_the_plan_without_an_aim(tmp_path: Path, method: str, off: float) -> None:
    default, least = (of_box(tmp_path, off, METHODS[method], plan).correction for plan in ({}, {"aim": "least"}))
    assert default is not None
    assert least is not None
    assert least.worst <= default.worst * (1 + 1e-9)


def test_what_binds_is_what_cannot_be_set_otherwise(tmp_path: Path) -> None:
    plane = {"method": "kit", "kit": [{"mass_g": 2.5}], "angles": {"count": 5, "offset": 20}}
    result = of_box(tmp_path, 40.0, plane)
    assert result.correction is not None
    assert result.verdict.outcome == "fail"
    assert result.correction.limits_hit == ("the weights of the kit and the positions",)
    assert result.correction.why.endswith(": the best that can be done within the weights of the kit and the positions")
    assert result.correction.bound == pytest.approx(result.correction.worst, rel=1e-9)
