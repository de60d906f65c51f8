"""PASS, FAIL and UNDECIDED, and whether what is said to settle a verdict does settle it."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.mesh.solids import box

from inertia.balancing.balance import balance
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.forces import rigid_limit
from inertia.balancing.rotor import Rotor
from inertia.balancing.tolerance import Tolerance
from inertia.balancing.unbalance import Unbalance
from inertia.balancing.verdict import judge
from inertia.mesh.part import Part
from inertia.mesh.write import write_stl

PLANES = (0.0, 1.0)


def tolerance(limit=100e-6):
    return Tolerance("given", "U = given", (limit, limit))


def residual(a, b, **sources):
    """Return vectors a and b (g·mm) in the planes, uncertain by (g·mm, cause) in each of them."""
    vectors = [(0.0, a * 1e-6), (1.0, b * 1e-6)]
    verdict = Unbalance(10.0, 0.5, 0.0, 0.0).with_vectors(vectors)
    # A source that moves plane A by r and plane B by r, apart from each other: (U, D) = (1, ∓½) r.
    return verdict.with_uncertainties(
        *(
            Uncertainty(name, ((r * 1e-6, -0.5e-6 * r), (r * 1e-6, 0.5e-6 * r)), cause)
            for name, (r, cause) in sources.items()
        )
    )


def scaled(unbalance, needs):
    """Return the unbalance with the sources made as small as was asked for."""
    return replace(
        unbalance,
        uncertainties=tuple(
            Uncertainty(k.source, tuple((g * r, h * r) for g, h in k.modes), k.cause * r)
            for k in unbalance.uncertainties
            for r in [needs[k.source] / k.cause if k.source in needs else 1.0]
        ),
    )


class TestOutcome:
    @pytest.mark.parametrize(
        ("a", "b", "outcome"),
        [
            (50, 50j, "pass"),
            (89, 0, "pass"),
            (0, 95, "undecided"),
            (105, 0, "undecided"),
            (111, 0, "fail"),
            (0, -200j, "fail"),
            (95, 200, "fail"),
        ],
    )
    def test_is_that_of_the_worst_plane_with_its_bounds(self, a, b, outcome):
        assert judge(residual(a, b, axis=(10, 2e-5)), tolerance(), PLANES).outcome == outcome

    def test_without_uncertainty_a_value_on_the_limit_passes(self):
        assert judge(Unbalance(10.0, 0.0, 100e-6, 0.0), tolerance(), PLANES).outcome == "pass"

    def test_each_plane_has_a_verdict_of_its_own(self):
        verdict = judge(residual(50, 200, axis=(10, 2e-5)), tolerance(), PLANES)
        assert [(k.name, k.outcome) for k in verdict.planes] == [("A", "pass"), ("B", "fail")]
        assert verdict.planes[1].residual == pytest.approx(200e-6)
        assert verdict.planes[1].bounds == {"axis": pytest.approx(10e-6)}
        assert verdict.why[1] == "plane B: 200 ± 10 g·mm against 100 g·mm: FAIL"

    def test_what_cannot_be_seen_beside_the_limit_is_left_out(self):
        verdict = judge(residual(50, 1e-13, arithmetic=(1e-9, None)), tolerance(), PLANES)
        assert verdict.why[0] == "plane A: 50 g·mm against 100 g·mm: PASS"
        assert verdict.why[1] == "plane B: 0 g·mm against 100 g·mm: PASS"

    @given(st.floats(0, 300), st.floats(0, 300), st.floats(0, 6.2))
    def test_a_pass_or_a_fail_holds_for_whatever_is_within_the_bounds(self, size, off, angle):
        verdict = judge(residual(size, 0, axis=(off, 1e-5)), tolerance(), PLANES).planes[0].outcome
        true = abs(size + off * complex(math.cos(angle), math.sin(angle)))
        if verdict == "pass":
            assert true <= 100 * (1 + 1e-12)
        if verdict == "fail":
            assert true > 100 * (1 - 1e-12)
        if verdict == "undecided":
            assert abs(size - 100) <= off * (1 + 1e-9) + 1e-9

    def test_near_the_critical_speed_a_rigid_verdict_is_withheld(self):
        rotor = residual(1, 1)
        assert judge(rotor, tolerance(), PLANES, rigid_limit(69, 100)).outcome == "pass"
        verdict = judge(rotor, tolerance(), PLANES, rigid_limit(70, 100))
        assert verdict.outcome == "undecided"
        assert "bends too much" in verdict.why[-1]
        assert "not known without the modes" in verdict.why[-1]

    def test_near_the_critical_speed_too_much_of_a_rigid_unbalance_fails(self):
        verdict = judge(residual(5600, 1), tolerance(), PLANES, rigid_limit(75, 100))
        assert verdict.outcome == "fail"
        assert "bends too much" in verdict.why[-1]


class TestTheAxisTakenAsExact:
    """What radial error turns a verdict over, against verdicts with that much of it in their bounds."""

    @pytest.mark.parametrize(
        ("a", "b", "outcome"), [(20, 60, "pass"), (10, 1, "pass"), (300, 150, "fail"), (1, 101, "fail")]
    )
    def test_turns_over_at_the_radius_that_it_says(self, a, b, outcome):
        rotor = residual(a, b, tessellation=(0.5, 1e-5))
        modes = ((-1.0, 0.2), (0.7, -0.1), (0.0, 0.05))  # of 1 m
        exact = judge(rotor, tolerance(), PLANES, axis=Uncertainty("axis", modes, 1.0))
        assert exact.outcome == outcome
        assert exact.axis_exact
        assert "with the axis taken as exact: a radial error of" in exact.headline
        for factor, after in ((0.999, outcome), (1.001, "undecided")):
            radius = factor * exact.turned_over_by
            scaled_modes = tuple((radius * g, radius * h) for g, h in modes)
            bounded = rotor.with_uncertainties(Uncertainty("axis", scaled_modes, radius))
            assert judge(bounded, tolerance(), PLANES).outcome == after

    def test_counts_in_the_share_of_parts_too(self, tmp_path):
        # A square shaft whose centre is anywhere within 0.02 mm of the axis: |ε| m/2 is within F/ω² in (2 F/m ω² ε)².
        force, mass = 2.75, 7850 * 0.06 * 0.06 * 0.1
        corners, faces = box((-30, -30, 0), (30, 30, 100))
        part = Part.from_arrays(corners, faces, "mm")
        write_stl([part], tmp_path / "shaft.stl", part.unit)
        table = {
            "body": [{"file": "shaft.stl", "density": 7850, "eccentricity": 0.02}],
            "axis": {"bearing_a": [0, 0, 0], "bearing_b": [0, 0, 100]},
            "service": {"rpm": 3000},
            "tolerance": {"bearing_force": [force, force]},
        }
        exact = balance(Rotor.from_dict(table, folder=tmp_path)).verdict
        assert exact.within == pytest.approx((2 * force / (mass * (100 * math.pi) ** 2 * 2e-5)) ** 2, abs=3e-3)
        assert exact.outcome == "pass"
        for factor, after in ((0.9, "pass"), (1.2, "conditional")):
            table["axis"]["radial_uncertainty"] = 1e3 * factor * exact.turned_over_by
            assert balance(Rotor.from_dict(table, folder=tmp_path)).verdict.outcome == after

    def test_is_not_said_where_it_is_in_the_bounds(self):
        verdict = judge(residual(1, 1, axis=(5, 1e-5)), tolerance(), PLANES)
        assert verdict.headline == "PASS"
        assert not verdict.axis_exact


class TestFigures:
    """What a sentence says must not contradict its verdict."""

    @pytest.mark.parametrize(
        ("size", "says"),
        [
            (6.28000003, "6.28000003 g·mm against 6.28 g·mm: FAIL"),
            (6.27999997, "6.27999997 g·mm against 6.28 g·mm: PASS"),
            (6.2803, "6.2803 g·mm against 6.28 g·mm: FAIL"),
            (6.289, "6.289 g·mm against 6.28 g·mm: FAIL"),
            (6.28, "6.28 g·mm against 6.28 g·mm, equal to 15 digits: PASS"),
        ],
    )
    def test_have_the_digits_that_tell_them_apart(self, size, says):
        verdict = judge(Unbalance(1.0, 0.0, size * 1e-6, 0.0), tolerance(6.28e-6), PLANES)
        assert verdict.why[0] == f"plane A: {says}"

    def test_have_digits_of_their_own_beside_a_large_limit(self):
        verdict = judge(residual(444, 0.1234, arithmetic=(1e-9, None)), tolerance(9.096e4), PLANES)
        assert verdict.why == (
            "plane A: 444 g·mm against 9.096e+10 g·mm: PASS",
            "plane B: 0.1234 g·mm against 9.096e+10 g·mm: PASS",
        )

    def test_say_what_can_be_done_about_a_value_on_the_limit(self):
        verdict = judge(residual(100, 0, arithmetic=(4e-11, None)), tolerance(), PLANES).planes[0]
        assert verdict.outcome == "undecided"
        assert "± 4e-11 g·mm against 100 g·mm" in verdict.why
        assert "a little less unbalance, or another limit" in verdict.why
        assert "exact arithmetic" not in verdict.why


class TestUndecided:
    def test_names_the_sources_that_cover_the_limit(self):
        verdict = judge(residual(80, 0, axis=(25, 2e-5), density=(5, 0.01)), tolerance(), PLANES).planes[0]
        assert verdict.covers == ("axis",)
        assert "axis 25, density 5" in verdict.why

    def test_leaves_out_sources_below_a_hundredth_of_the_limit(self):
        rotor = residual(80, 0, axis=(25, 2e-5), density=(0.99, 0.01), arithmetic=(5.6e-8, None))
        verdict = judge(rotor, tolerance(), PLANES).planes[0]
        assert "(g·mm: axis 25)" in verdict.why
        alone = judge(residual(100, 0, arithmetic=(5.6e-8, None)), tolerance(), PLANES).planes[0]
        assert alone.outcome == "undecided"
        assert "(g·mm: arithmetic 5.6e-08)" in alone.why

    def test_names_all_where_only_their_sum_covers_it(self):
        verdict = judge(residual(80, 0, axis=(12, 2e-5), tessellation=(12, 1e-5)), tolerance(), PLANES).planes[0]
        assert set(verdict.covers) == {"axis", "tessellation"}

    def test_says_in_numbers_what_would_settle_it(self):
        verdict = judge(residual(80, 0, axis=(12, 2e-5), tessellation=(12, 1e-5)), tolerance(), PLANES).planes[0]
        needs = {source: size for k in verdict.settlements for source, size in k.needs.items()}
        assert needs["axis"] == pytest.approx(2e-5 * 8 / 12)
        assert needs["tessellation"] == pytest.approx(1e-5 * 8 / 12)
        assert "bearing centres known to 0.013 mm or better" in verdict.why
        assert "facets within 0.0066 mm of the true surface" in verdict.why

    def test_asks_for_all_at_once_where_none_is_enough_alone(self):
        verdict = judge(residual(95, 0, axis=(10, 2e-5), density=(10, 0.02)), tolerance(), PLANES).planes[0]
        (only,) = verdict.settlements
        assert only.needs == {"axis": pytest.approx(0.5e-5), "density": pytest.approx(0.005)}
        assert only.text == "bearing centres known to 0.005 mm or better with densities known to 0.5 % or better"

    def test_leaves_out_what_hardly_counts_and_what_is_out_of_reach(self):
        together = judge(
            residual(95, 0, axis=(10, 2e-5), density=(10, 0.02), arithmetic=(1e-3, None)), tolerance(), PLANES
        )
        (only,) = together.planes[0].settlements
        assert set(only.needs) == {"axis", "density"}
        apart = judge(residual(80, 0, axis=(20.5, 2e-5), tessellation=(19.99, 1e-5)), tolerance(), PLANES).planes[0]
        assert [set(k.needs) for k in apart.settlements] == [{"axis", "tessellation"}]
        mild = judge(residual(80, 0, axis=(19.5, 2e-5), tessellation=(17, 1e-5)), tolerance(), PLANES).planes[0]
        assert [set(k.needs) for k in mild.settlements] == [{"axis"}]

    def test_asks_for_other_coordinates_where_rounding_covers_the_limit(self):
        verdict = judge(residual(99, 0, arithmetic=(3, None)), tolerance(), PLANES).planes[0]
        assert [k.needs for k in verdict.settlements] == [{"arithmetic": None}]
        assert "coordinates counted from a point on the part" in verdict.why

    def test_a_value_on_the_limit_cannot_be_settled(self):
        verdict = judge(residual(0, 0, axis=(3, 1e-5)), tolerance(0.0), PLANES).planes[0]
        assert verdict.settlements == ()
        assert "on the limit" in verdict.why

    @given(
        st.floats(1, 300),
        st.tuples(st.floats(0.1, 80), st.floats(1e-6, 1e-3)),
        st.tuples(st.floats(0.1, 80), st.floats(1e-3, 0.1)),
    )
    def test_what_is_asked_for_settles_it(self, size, axis, density):
        rotor = residual(size, 0, axis=axis, density=density)
        verdict = judge(rotor, tolerance(), PLANES).planes[0]
        if verdict.outcome != "undecided" or abs(size - 100) < 1e-6:
            return
        assert verdict.settlements
        for settlement in verdict.settlements:
            needs = {source: value * (1 - 1e-9) for source, value in settlement.needs.items()}
            settled = judge(scaled(rotor, needs), tolerance(), PLANES).planes[0].outcome
            assert settled == ("pass" if size < 100 else "fail")
