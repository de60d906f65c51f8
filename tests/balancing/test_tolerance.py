"""Permissible unbalance by standard, its allocation to the planes, and what is refused."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inertia import UsageError
from inertia.balancing.shop_units import GRAM_MILLIMETRE, OUNCE_INCH, POUND, angular_speed
from inertia.balancing.tolerance import (
    GRADES,
    achieved_grade,
    allocate,
    api,
    bearing_force_limits,
    iso_21940_11,
    mil_std_167_1,
    specific_unbalance,
)
from inertia.balancing.unbalance import Unbalance

PLANES = (0.0, 1.0)


def rotor(z=0.5, mass=100.0):
    return Unbalance(mass, z, 0.0, 0.0)


class TestIso:
    @pytest.mark.parametrize("grade", GRADES)
    def test_the_grade_is_the_speed_of_the_centre_of_mass(self, grade):
        speed = angular_speed(1800.0)
        tolerance = iso_21940_11(grade, rotor(), PLANES, speed)
        assert tolerance.total / 100.0 * speed == pytest.approx(grade * 1e-3)
        assert tolerance.standard == f"ISO 21940-11:2016, G{grade:g}"

    def test_the_shop_formula_gives_the_same(self):
        """9549.3 G m/n g·mm."""
        tolerance = iso_21940_11(6.3, rotor(), PLANES, angular_speed(3000.0))
        assert tolerance.total / GRAM_MILLIMETRE == pytest.approx(9549.3 * 6.3 * 100 / 3000, rel=1e-5)

    def test_the_table_has_eleven_grades_from_coarse_to_fine(self):
        assert list(GRADES) == sorted(GRADES, reverse=True)
        assert len(GRADES) == 11
        assert "pumps" in GRADES[6.3]
        assert any("turbines" in machine for machine in GRADES[2.5])

    def test_a_grade_of_a_contract_is_said_to_be_one(self):
        tolerance = iso_21940_11(1.6, rotor(), PLANES, 100.0)
        assert tolerance.standard == "ISO 21940-11:2016, G1.6 by contract, not in its table"
        assert tolerance.total == pytest.approx(1.6e-3 * 100.0 / 100.0)
        assert tolerance.meant_for == ()

    def test_a_grade_and_a_speed_of_zero_are_refused(self):
        with pytest.raises(UsageError, match=r"the grade is 0 mm/s"):
            iso_21940_11(0, rotor(), PLANES, 100.0)
        with pytest.raises(UsageError, match=r"the speed is 0\.0 rad/s"):
            iso_21940_11(6.3, rotor(), PLANES, 0.0)


class TestAllocation:
    @given(st.floats(0.31, 0.69))
    def test_inboard_each_plane_gets_what_its_bearing_carries(self, z):
        a, b = allocate(rotor(z), PLANES)
        assert (a.used, b.used) == pytest.approx((1 - z, z))
        assert not a.clamped
        assert not b.clamped

    def test_near_a_bearing_the_shares_are_kept_within_30_and_70_percent(self):
        a, b = allocate(rotor(0.9), PLANES)
        assert (a.allocated, b.allocated) == pytest.approx((0.1, 0.9))
        assert (a.used, b.used) == (0.3, 0.7)
        assert a.clamped
        assert b.clamped

    @pytest.mark.parametrize(("z", "used"), [(1.2, (0.3, 1.2)), (1.5, (0.5, 1.3)), (-0.2, (1.2, 0.3))])
    def test_overhung_they_are_kept_within_30_and_130_percent(self, z, used):
        shares = allocate(rotor(z), PLANES)
        assert tuple(k.used for k in shares) == pytest.approx(used)
        assert shares[0].limits == (0.3, 1.3)

    def test_a_rotor_may_be_called_overhung(self):
        assert allocate(rotor(0.9), PLANES, overhung=True)[1].used == pytest.approx(0.9)
        tolerance = iso_21940_11(2.5, rotor(0.9), PLANES, 100.0, overhung=True)
        assert tolerance.permissible[1] == pytest.approx(0.9 * tolerance.total)

    def test_planes_in_either_order_get_the_same(self):
        assert [k.used for k in allocate(rotor(0.4), (1.0, 0.0))] == pytest.approx([0.4, 0.6])


class TestOthers:
    def test_specific_unbalance_is_the_eccentricity(self):
        tolerance = specific_unbalance(4e-6, rotor(), PLANES)
        assert tolerance.total == pytest.approx(400 * GRAM_MILLIMETRE)
        assert tolerance.standard == "specific unbalance 4 µm"

    @pytest.mark.parametrize("standard", ["API 610", "API 617"])
    def test_api_counts_the_journal_load(self, standard):
        tolerance = api(standard, rotor(0.2), PLANES, 3000.0)
        assert [u / GRAM_MILLIMETRE for u in tolerance.permissible] == pytest.approx(
            [6350 * 80 / 3000, 6350 * 20 / 3000]
        )
        assert tolerance.shares is None

    @pytest.mark.parametrize(
        ("standard", "rpm", "micrometres"),
        [
            ("API 617", 24_999.0, 6350 / 24_999),
            ("API 617", 25_000.0, 0.254),  # 10 microinches, whatever the speed
            ("API 617", 40_000.0, 0.254),
            ("API 610", 40_000.0, 6350 / 40_000),
        ],
    )
    def test_api_617_allows_a_fast_rotor_no_less(self, standard, rpm, micrometres):
        tolerance = api(standard, rotor(0.5), PLANES, rpm)
        assert tolerance.permissible[0] / 50.0 == pytest.approx(1e-6 * micrometres, rel=2e-6)
        assert ("W/3.937" in tolerance.rule) == (micrometres == 0.254)

    @pytest.mark.parametrize(
        ("rpm", "ounce_inches"),
        [
            (100, 0.177 * 1000),
            (149.9, 177.0),
            (150, 4000e3 / 150**2),
            (1000, 4.0),
            (1001, 4e3 / 1001),
            (3600, 4e3 / 3600),
        ],
    )
    def test_mil_counts_the_whole_weight_in_three_ranges(self, rpm, ounce_inches):
        tolerance = mil_std_167_1("MIL-STD-167-1", rotor(mass=1000 * POUND), PLANES, rpm)
        assert tolerance.permissible[0] / OUNCE_INCH == pytest.approx(ounce_inches, rel=1e-12)
        assert tolerance.permissible[0] == tolerance.permissible[1]

    def test_mil_revision_a_takes_a_grade(self):
        tolerance = mil_std_167_1("MIL-STD-167-1A", rotor(0.4), PLANES, 3000.0, grade=6.3)
        assert tolerance.permissible == iso_21940_11(6.3, rotor(0.4), PLANES, angular_speed(3000.0)).permissible

    def test_force_limits_are_divided_by_the_speed_squared(self):
        tolerance = bearing_force_limits((10.0, 40.0), 100.0)
        assert tolerance.permissible == pytest.approx((1e-3, 4e-3))

    @pytest.mark.parametrize(
        ("ask", "says"),
        [
            (lambda: api("API 612", rotor(), PLANES, 3000.0), "'API 610' or 'API 617'"),
            (lambda: api("API 610", rotor(), PLANES, 0.0), r"the speed is 0\.0 r/min"),
            (lambda: mil_std_167_1("MIL-STD-167", rotor(), PLANES, 3000.0), "revision 'MIL-STD-167' .* not known"),
            (lambda: mil_std_167_1("MIL-STD-167-1A", rotor(), PLANES, 3000.0), "grade from the contract"),
            (lambda: mil_std_167_1("MIL-STD-167-1", rotor(), PLANES, 3000.0, 2.5), "leave the grade out"),
            (lambda: bearing_force_limits((0.0, 1.0), 100.0), "bearing force limit is 0"),
            (lambda: bearing_force_limits((1.0, 1.0), math.nan), "the speed is nan"),
            (lambda: specific_unbalance(-1e-6, rotor(), PLANES), "specific unbalance is"),
        ],
    )
    def test_what_is_no_criterion_is_refused(self, ask, says):
        with pytest.raises(UsageError, match=says):
            ask()


class TestAchievedGrade:
    @given(st.sampled_from(sorted(GRADES)), st.floats(0.1, 0.9), st.floats(0.0, 2.0), st.floats(0.0, 2.0))
    def test_is_the_grade_whose_tolerance_is_just_kept(self, grade, z, a, b):
        speed = angular_speed(1800.0)
        limits = iso_21940_11(grade, rotor(z), PLANES, speed)
        vectors = (a * limits.permissible[0] * 1j, -b * limits.permissible[1] + 0j)
        tolerance = achieved_grade(vectors, limits.shares, 100.0, speed)
        assert tolerance == pytest.approx(grade * max(a, b))

    def test_of_a_static_unbalance_at_the_centre_of_mass_it_is_e_omega(self):
        eccentric = Unbalance(100.0, 0.4, 1e-3, 0.0)
        tolerance = achieved_grade(eccentric.in_planes(*PLANES), allocate(eccentric, PLANES), 100.0, 50.0)
        assert tolerance == pytest.approx(1e3 * eccentric.eccentricity * 50.0)

    def test_of_a_couple_it_is_not_zero(self):
        bent = Unbalance(100.0, 0.5, 0.0, 1e-3)
        tolerance = achieved_grade(bent.in_planes(*PLANES), allocate(bent, PLANES), 100.0, 50.0)
        assert tolerance == pytest.approx(1e3 * 50.0 * 1e-3 / 0.5 / 100.0)  # D/L in each plane, of which half counts
