"""The worked cases of the reference note, by number: the core of balancing."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from tests.balancing.rotors import MM, STEEL, at, on_z, two_disc_part, two_disc_true, weight

import inertia
from inertia.balancing.axis.tilt import principal_tilt, swash_couple
from inertia.balancing.forces import axle_torque, bearing_forces
from inertia.balancing.shop_units import (
    GRAM_MILLIMETRE,
    GRAM_SQUARE_MILLIMETRE,
    OUNCE_INCH,
    POUND,
    angular_speed,
    in_degrees,
    in_gmm,
)
from inertia.balancing.tolerance import api, bearing_force_limits, iso_21940_11, mil_std_167_1
from inertia.balancing.unbalance import Unbalance

SPEED = angular_speed(3000.0)
THOUSAND_POUNDS = Unbalance(1000 * POUND, 0.5, 0.0, 0.0)


ROOT = Path(__file__).resolve().parents[2]
TABLE = re.findall(
    r"^\| (\d+) \|.*`([\w/]+\.py)::(test_case_\d+_)` \|$", (ROOT / "docs" / "balancing.md").read_text(), re.MULTILINE
)


def polar(vector):
    return in_gmm(vector), in_degrees(vector)


def test_the_page_lists_all_fourteen_cases():
    assert [int(number) for number, _, _ in TABLE] == list(range(1, 15))


@pytest.mark.parametrize(("number", "file", "name"), TABLE)
def test_every_case_of_the_page_is_a_test(number, file, name):
    assert name == f"test_case_{number}_"
    assert re.search(rf"^def {name}", (ROOT / file).read_text(), re.MULTILINE)


def test_case_1_permissible_unbalance_is_allocated_by_the_lever_rule():
    figures = iso_21940_11(2.5, Unbalance(3600.0, 1.5, 0.0, 0.0), (0.0, 2.4), SPEED)
    assert figures.total / GRAM_MILLIMETRE == pytest.approx(28_648, abs=0.5)
    assert [u / GRAM_MILLIMETRE for u in figures.permissible] == pytest.approx([10_743, 17_905], abs=0.5)


def test_case_2_bearing_force_limits():
    figures = bearing_force_limits((1200.0, 2000.0), SPEED)
    assert [u / GRAM_MILLIMETRE for u in figures.permissible] == pytest.approx([12_159, 20_264], abs=0.5)


@pytest.mark.parametrize(
    ("rpm", "ounce_inches"),
    [(150, 126.3), (500, 37.9), (1000, 18.95), (2000, 9.47), (3000, 6.32), (4000, 4.74), (5000, 3.79)],
)
def test_case_3_g_6_3_for_1000_lb_per_plane(rpm, ounce_inches):
    figures = iso_21940_11(6.3, THOUSAND_POUNDS, (0.0, 1.0), angular_speed(rpm))
    assert figures.permissible[0] / OUNCE_INCH == pytest.approx(ounce_inches, abs=0.006 if rpm > 500 else 0.06)


def test_case_4_api_and_mil_and_iso_at_15_000_rpm():
    planes = (0.0, 1.0)
    assert api("API 617", THOUSAND_POUNDS, planes, 15e3).permissible[0] / OUNCE_INCH == pytest.approx(0.133, abs=5e-4)
    mil = mil_std_167_1("MIL-STD-167-1", THOUSAND_POUNDS, planes, 15e3)
    assert mil.permissible[0] / OUNCE_INCH == pytest.approx(0.267, abs=5e-4)
    iso = iso_21940_11(2.5, THOUSAND_POUNDS, planes, angular_speed(15e3))
    assert iso.total / OUNCE_INCH == pytest.approx(1.00, abs=5e-3)


def test_case_5_a_couple_is_two_opposite_vectors():
    gram_square_centimetre = 1e-7
    a, b = Unbalance(1.0, 0.3, 0.0, 6000 * gram_square_centimetre).in_planes(0.0, 0.15)
    assert a == pytest.approx(-b)
    assert abs(b) == pytest.approx(400e-5)  # 400 g·cm
    assert abs(b) / 0.20 == pytest.approx(20e-3)  # 20 g


def test_case_6_planes_on_one_side_of_the_unbalance():
    a, b = Unbalance(1.0, 0.1, 1.0, 0.0).in_planes(0.4, 0.6)
    assert (-a, -b) == pytest.approx((-2.5, 1.5))


def test_case_11_point_masses_corrected_in_two_planes():
    masses = [weight(18, 50, 0, 0), weight(14, 60, 60, 80), weight(16, 70, 135, 160), weight(12, 60, 270, 280)]
    rotor = Unbalance(1e3, 0.1, 0.0, 0.0).with_masses(masses)
    corrections = [-u / (50 * MM) for u in rotor.in_planes(40 * MM, 220 * MM)]
    assert [abs(k) for k in corrections] == pytest.approx([31.60, 13.80], abs=5e-3)
    assert [in_degrees(k) for k in corrections] == pytest.approx([222.6, 23.1], abs=0.05)


def test_case_12_swash_disc():
    mass, radius, height = 10.0, 0.150, 0.020
    polar_moment, transverse = mass * radius**2 / 2, mass * (3 * radius**2 + height**2) / 12
    couple = swash_couple(polar_moment, transverse, math.radians(0.1))
    assert abs(couple) / GRAM_SQUARE_MILLIMETRE == pytest.approx(97_593, abs=0.5)
    assert abs(complex(axle_torque(couple, SPEED))) == pytest.approx(9.63, abs=5e-3)


class TestCase14:
    SHAFT = on_z(20 * MM, 280 * MM)
    HOLES = (
        (90, STEEL * math.pi * 5e-3**2 * 20 * MM * 70 * MM, 30),
        (215, STEEL * math.pi * 6e-3**2 * 30 * MM * 60 * MM, 200),
    )

    @pytest.fixture(params=["closed form", "mesh"])
    def properties(self, request):
        if request.param == "closed form":
            return two_disc_true()
        return inertia.mass_properties(two_disc_part(), STEEL)

    @pytest.fixture
    def rotor(self, properties):
        return Unbalance.of(properties, self.SHAFT)

    def test_the_closed_form_is_that_of_the_two_holes(self):
        """All else is of revolution: holes at z = 90 and 215 mm take mass away there."""
        rotor = Unbalance.of(two_disc_true(), self.SHAFT)
        figures = rotor.in_planes(90 * MM, 215 * MM)
        expected = [-at(size, degrees) for _, size, degrees in self.HOLES]
        np.testing.assert_allclose(figures, expected, rtol=1e-10)

    def test_mass_and_static_unbalance(self, rotor):
        assert rotor.mass == pytest.approx(11.014, abs=2e-3)
        assert polar(rotor.static) == pytest.approx((762.82, 8.67), abs=0.2)

    def test_bearings(self, rotor):
        a, b = rotor.in_planes(20 * MM, 280 * MM)
        assert (in_gmm(a), in_gmm(b)) == pytest.approx((247.2, 970.4), abs=0.2)
        forces = bearing_forces(rotor, 20 * MM, 280 * MM, SPEED)
        assert np.abs(forces) == pytest.approx([24.4, 95.8], abs=0.05)

    def test_corrections(self, rotor):
        """Opposite the planes' vectors, which are opposite the holes."""
        figures = [polar(-u) for u in rotor.in_planes(90 * MM, 215 * MM)]
        assert figures[0] == pytest.approx((863.07, 30), abs=0.2)
        assert figures[1] == pytest.approx((1597.90, 200), abs=0.3)

    def test_tolerance_and_tilt(self, rotor, properties):
        figures = iso_21940_11(6.3, rotor, (20 * MM, 280 * MM), SPEED)
        assert figures.total / GRAM_MILLIMETRE == pytest.approx(220.9, abs=0.1)
        assert math.degrees(principal_tilt(properties, self.SHAFT).angle) == pytest.approx(0.299, abs=6e-4)

    def test_the_stored_mesh_gives_the_published_digits(self):
        rotor = Unbalance.of(inertia.mass_properties(two_disc_part(), STEEL), self.SHAFT)
        assert rotor.mass == pytest.approx(11.014, abs=5e-4)
        assert polar(rotor.static) == pytest.approx((762.82, 8.67), abs=6e-3)
        a, b = (polar(u) for u in rotor.in_planes(90 * MM, 215 * MM))
        assert a == pytest.approx((863.07, 210), abs=6e-3)
        assert b == pytest.approx((1597.90, 20), abs=6e-3)
