"""Far off, tiny, huge, slender, thin-walled, nearly symmetric: every bound holds, and accuracy is reached or refused.

The oracle is rational arithmetic on the coordinates as stored.
"""

import re
from fractions import Fraction
from pathlib import Path
from statistics import median

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.benchmarks.extremes.cases import Case, ball, cases, nearly_equal, refused
from tests.benchmarks.extremes.commands import Question, measured_command, questions
from tests.benchmarks.extremes.rungs import RUNGS, answer, properties, ratios, ratios_before_rounding
from tests.benchmarks.extremes.sweep import MILLIMETRE, STEEL, sweep
from tests.benchmarks.extremes.truth import Truth, errors

import inertia
from inertia.errors import GeometryError
from inertia.mass.triangles.arithmetic import METHODS, Arithmetic, solid_moments
from inertia.mesh.part import Part
from inertia.mesh.surface import Facets, Surface
from inertia.units import length_unit

CASES = list(cases())


def named(case: Case) -> str:
    return f"{case.family}, {case.name}"


def part(case: Case) -> Part:
    return Part(case.triangles, length_unit("m"), "option")


def having(*words: str) -> list[Case]:
    cases = [case for case in CASES if all(word in named(case) for word in words)]
    assert cases
    return cases


@pytest.mark.parametrize("case", CASES, ids=named)
def test_no_error_is_above_its_bound_at_any_rung(case: Case) -> None:
    truth = Truth.of(case.triangles.corners())
    body = truth.weighed(MILLIMETRE, STEEL)
    for rung in RUNGS:
        moments = solid_moments(case.triangles, rung)
        quotients = list(ratios_before_rounding(moments, truth).values())
        if moments.zeroth > moments.zeroth_bound and "1e-63" not in case.name:
            quotients += ratios(properties(moments, rung, MILLIMETRE, STEEL), body, STEEL).values()
        assert min(ratio for values in quotients for ratio in values) >= 1, rung


@pytest.mark.parametrize("case", CASES, ids=named)
def test_the_exact_rung_is_off_by_no_more_than_rounding_its_results(case: Case) -> None:
    truth = Truth.of(case.triangles.corners())
    off = errors(answer(properties(solid_moments(case.triangles, "exact"), "exact")), truth)
    assert off["volume"] <= 2.0**-53
    if "1e-63" not in case.name:  # whose tensor is below the normal numbers
        assert off["tensor"] <= 2.0**-53
        assert off["smallest moment"] <= 2.0**-53


REACHED: list[tuple[Arithmetic, Case]] = [
    *(("float64", case) for case in having("at the origin")),
    *(("float64", case) for case in having("1e3 diameters")),
    *(("float64", case) for case in having("e30 m") + having("e60 m") + having("1e-30 m") + having("1e-60 m")),
    *(("float64", case) for case in having("along the axes")),
    *(("float64", case) for case in having("Slivers")),
    *(("double-double", case) for case in having("Plates", "slanted")),
    *(("double-double", case) for case in having("wall of 1e-6") + having("wall of 1e-9")),
    *(("exact", case) for case in having("Needles", "slanted")),
]


@pytest.mark.parametrize(("rung", "case"), REACHED, ids=lambda k: k if isinstance(k, str) else named(k))
def test_an_accuracy_that_the_coordinates_allow_is_reached_by_the_cheapest_method(rung: Arithmetic, case: Case) -> None:
    properties = inertia.mass_properties(part(case), 1.0, accuracy=1e-12)
    assert properties.error.method == METHODS[rung]
    truth = Truth.of(case.triangles.corners())
    assert max(properties.error.volume, properties.error.mass, properties.error.inertia) <= 1e-12
    assert properties.error.center_of_mass <= 1e-12 * truth.size
    off = errors(answer(properties), truth)
    assert max(off["volume"], off["centre"], off["tensor"]) <= 1e-12


FAR = having("1e6 diameters") + having("1e8 diameters") + having("1e12 diameters")


@pytest.mark.parametrize("case", FAR, ids=named)
def test_far_away_only_the_place_loses_digits(case: Case) -> None:
    """The centre of mass is a large number; volume and tensor keep every digit that the coordinates carry."""
    properties = inertia.mass_properties(part(case), 1.0)
    assert max(properties.error.volume, properties.error.inertia) < 1e-13
    off = errors(answer(properties), Truth.of(case.triangles.corners()))
    assert max(off["volume"], off["tensor"]) < 1e-15
    truth = Truth.of(case.triangles.corners())
    finer = inertia.mass_properties(part(case), 1.0, accuracy=1e-15)
    pair, bound = finer.center_of_mass_pair()
    assert max(finer.error.volume, finer.error.mass, finer.error.inertia, bound / truth.size) <= 1e-15
    place = zip(*pair.tolist(), truth.moments.center_of_mass, strict=True)
    assert sum((Fraction(high) + Fraction(low) - k) ** 2 for high, low, k in place) <= Fraction(bound) ** 2


REFUSED = {
    "1e-310": "below 5e-324 .* larger unit",
    "1e-65": "below 5e-324 .* larger unit",
    "1e62": "above 1.8e308 .* smaller unit",
    "1e103": "above 1.8e308 .* smaller unit",
}


@pytest.mark.parametrize("case", list(refused()), ids=named)
def test_no_rung_answers_what_float64_cannot_hold(case: Case) -> None:
    for rung in RUNGS:
        moments = solid_moments(case.triangles, rung)
        with pytest.raises(GeometryError, match=REFUSED.get(case.name.split()[1], "no volume that these coordinates")):
            properties(moments, rung)


@pytest.mark.parametrize("accuracy", [None, 1e-12, "exact"])
@pytest.mark.parametrize("case", list(refused()), ids=named)
def test_what_float64_cannot_hold_is_a_sentence(case: Case, accuracy: float | str | None) -> None:
    says = REFUSED | {"1e103": "beyond 1e75", "of": "no volume|inside out|overlap|coincide"}
    with pytest.raises(GeometryError, match=says[case.name.split()[1]]):
        inertia.mass_properties(part(case), 1.0, accuracy=accuracy)


@pytest.mark.parametrize("power", [-1060, -1040, -1000, 900, 1020])
def test_sums_lose_nothing_where_coordinates_are_subnormal_or_near_the_largest(power: int) -> None:
    vertices, faces = ball(1)
    triangles = Surface(np.ldexp(vertices, power), faces)
    truth = Truth.of(triangles.corners())
    for rung in RUNGS:
        moments = solid_moments(triangles, rung)
        assert moments.zeroth_bound < moments.zeroth / 10**12
        ratios = ratios_before_rounding(moments, truth)
        assert len(ratios) == 2
        assert min(ratio for values in ratios.values() for ratio in values) >= 1


@pytest.mark.parametrize("case", having("float32"), ids=named)
@pytest.mark.parametrize("rung", RUNGS)
def test_float32_records_give_what_the_same_numbers_in_float64_do(case: Case, rung: Arithmetic) -> None:
    assert isinstance(case.triangles, Facets)
    stored = properties(solid_moments(case.triangles, rung), rung)
    widened = properties(solid_moments(Surface(case.vertices, case.faces), rung), rung)
    assert (stored.volume, stored.error) == (widened.volume, widened.error)
    assert stored.center_of_mass.tolist() == widened.center_of_mass.tolist()
    assert stored.inertia.tolist() == widened.inertia.tolist()


@pytest.mark.parametrize(("power", "case"), list(nearly_equal()), ids=lambda k: k.name if isinstance(k, Case) else "")
def test_axes_of_nearly_equal_moments_are_bounded(power: int, case: Case) -> None:
    truth = Truth.of(case.triangles.corners())
    for rung in RUNGS:
        far = 0.2 if (rung, power) == ("float64", 15) else 0.1
        decomposition = properties(solid_moments(case.triangles, rung), rung).principal_within(0.0)
        assert (decomposition.kind, decomposition.equal) == ("asymmetric", ())
        for k in range(3):
            assert truth.angle(decomposition.axes[:, k].tolist(), k) <= decomposition.axis_bounds[k] < far


def test_bounds_hold_over_a_sweep_and_are_typically_near() -> None:
    tally = sweep(1, 120)
    assert tally.exceeded() == 0
    for rung in RUNGS:
        assert tally.refused[rung] < 20
        for quantity in ("volume", "mass", "centre of mass", "tensor", "principal moments"):
            assert median(tally.ratios[rung][quantity]) <= 100


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**63 - 1))
def test_bounds_hold_for_any_mesh_of_the_sweep(seed: int) -> None:
    assert sweep(seed, 4).exceeded() == 0


_WIDEST = {"wall15.ply": 4e-15, "sunk.ply": 3e-7, "speck.ply": 2e-14, "pin.ply": 1e-3, "hole.ply": 0.02}


@pytest.mark.parametrize("question", list(questions()), ids=lambda question: question.part)
def test_the_command_line_answers_within_its_bounds_or_says_why_not(question: Question, tmp_path: Path) -> None:
    row = measured_command(question, tmp_path)
    refused = {"pentagram.ply", "crack.ply", "edge.ply", "two.msh", "inside.msh", "folded.msh"}
    united = "--union" in question.options
    if question.name in refused and not united:
        assert row["code"] == 4
        assert re.search("self-intersection|--weld|overlap|is tangled", row["sentence"])
        return
    volume, inertia = _WIDEST.get(question.name, 1e-15), 10 * _WIDEST.get(question.name, 1e-16)
    if united:
        volume = inertia = 1e-13
    assert row["code"] == 0, row
    assert row.get("error", 0.0) <= row["volume"] <= volume
    assert row["inertia"] <= inertia
