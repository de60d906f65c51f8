"""Static and couple unbalance of bodies, in planes and by class."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.balancing.rotors import STEEL, at, lumped, on_z, two_disc_part, weight
from tests.mass.parts import exact, surface

import inertia
from inertia import UsageError
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.shop_units import GRAM_MILLIMETRE, OUNCE_INCH, angular_speed, in_degrees, in_gmm
from inertia.balancing.unbalance import PointMass, Unbalance
from inertia_meshes import path
from inertia_meshes.shapes import box, mapped, moved, revolved

NUMBER = st.floats(-1, 1).map(lambda x: round(x, 6))
VECTOR = st.builds(complex, NUMBER, NUMBER)


class TestOfABody:
    def test_is_that_of_exact_integrals(self):
        """U = ∫(x + iy) dm and D = ∫(x + iy)(z − z_G) dm, by rational arithmetic over the same triangles."""
        part = surface(moved(box(1, 2, 3), 0.25, -0.5, 4.0), moved(box(0.5, 0.5, 0.5), 1.25, 0.75, 7.0))
        unbalance = Unbalance.of(inertia.mass_properties(part, 10.0), on_z())
        true = exact(part, 10)
        _, _, height = true.first
        _, _, _, yz, zx, _ = true.second
        z = height / true.volume
        couple = complex(zx - true.first[0] * z, yz - true.first[1] * z)
        assert unbalance.mass == pytest.approx(float(true.volume), rel=1e-15)
        assert unbalance.z == pytest.approx(float(z), rel=1e-15)
        assert abs(unbalance.static - complex(*true.first[:2])) <= unbalance.static_bound < 1e-11
        assert abs(unbalance.couple - couple) <= unbalance.couple_bound < 1e-10
        assert unbalance.kind == "dynamic"

    def test_on_a_skew_shaft_far_away_is_that_of_exact_integrals(self):
        """Axes (2, −1, 2)/3, (2, 2, −1)/3, (−1, 2, 2)/3 are rational: the integrals along them are exact."""
        part = surface(moved(box(1, 2, 4), 1000, 2000, -500), moved(box(1, 1, 1), 1003, 2000, -499))
        a = [Fraction(1000), Fraction(2000), Fraction(-500)]
        axes = [[Fraction(k, 3) for k in row] for row in ((2, -1, 2), (2, 2, -1), (-1, 2, 2))]
        true = exact(part, 8)
        first = [f - k * true.volume for f, k in zip(true.first, a, strict=True)]
        xx, yy, zz, yz, zx, xy = true.second
        about_o = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
        f = true.first
        second = [
            [about_o[i][j] - a[i] * f[j] - a[j] * f[i] + a[i] * a[j] * true.volume for j in range(3)] for i in range(3)
        ]
        x, y, z = (sum(k * u for k, u in zip(axis, first, strict=True)) for axis in axes)

        def product(p, q):
            return sum(p[i] * second[i][j] * q[j] for i in range(3) for j in range(3))

        couple = complex(
            product(axes[0], axes[2]) - x * z / true.volume, product(axes[1], axes[2]) - y * z / true.volume
        )
        shaft = Shaft([1000, 2000, -500], [994, 2012, -488], [2, -1, 2])
        unbalance = Unbalance.of(inertia.mass_properties(part, 8.0), shaft)
        assert abs(unbalance.static - complex(x, y)) <= unbalance.static_bound < 1e-9
        assert abs(unbalance.couple - couple) <= unbalance.couple_bound < 1e-9

    @pytest.mark.parametrize("name", ["disc.stl", "spinning_top.stl", "sphere.stl", "torus.stl", "cone.stl"])
    def test_of_a_symmetric_rotor_is_zero_to_the_bound(self, name):
        part = inertia.read(path(name), unit="mm")
        unbalance = Unbalance.of(inertia.mass_properties(part, STEEL), on_z(), radial_uncertainty=1e-9)
        assert abs(unbalance.static) <= unbalance.static_bound < 1e-8 * unbalance.mass
        assert abs(unbalance.couple) <= unbalance.couple_bound
        assert unbalance.kind == "balanced"

    @pytest.mark.parametrize("axis", [(1, 2, 2), (2, -1, 2), (-2, 3, 6)])
    def test_of_a_symmetric_rotor_is_zero_to_the_bound_on_a_skew_shaft(self, axis):
        n = math.isqrt(sum(k * k for k in axis))
        v = np.array(axis) - [0, 0, n]
        mirror = (v @ v) * np.eye(3) - 2 * np.outer(v, v)  # Householder: integers, takes z to the axis
        prism = mapped(box(4, 4, 6), -mirror)[:, ::1]
        part = surface(moved(prism, 100, 200, -300))
        start = np.array([100, 200, -300.0])
        shaft = Shaft(start, start + np.array(axis), [1, 0, 0])
        unbalance = Unbalance.of(inertia.mass_properties(part, 1.0), shaft)
        assert unbalance.kind == "balanced"
        assert unbalance.static_bound < 1e-12 * unbalance.mass * 400

    @settings(deadline=None, max_examples=15)
    @given(st.floats(-math.pi, math.pi))
    def test_turning_the_whole_rotor_turns_the_angles_and_nothing_else(self, angle):
        corners = two_disc_part().triangles.corners()
        c, s = math.cos(angle), math.sin(angle)
        turned = surface(mapped(corners, ((c, -s, 0), (s, c, 0), (0, 0, 1))), unit="mm")
        shaft = on_z(0.02, 0.28)
        still = Unbalance.of(inertia.mass_properties(two_disc_part(), STEEL), shaft)
        unbalance = Unbalance.of(inertia.mass_properties(turned, STEEL), shaft)
        expected = still.rotated(angle)
        assert expected.static == still.static * complex(c, s)
        assert unbalance.static == pytest.approx(expected.static, rel=1e-9)
        assert unbalance.couple == pytest.approx(expected.couple, rel=1e-9)
        assert (unbalance.mass, unbalance.z) == pytest.approx((still.mass, still.z), rel=1e-12)
        assert unbalance.kind == expected.kind == still.kind
        for one, other in zip(expected.in_planes(0.02, 0.28), still.in_planes(0.02, 0.28), strict=True):
            assert abs(one) == pytest.approx(abs(other), rel=1e-12)

    def test_turning_the_zero_mark_with_the_rotor_changes_nothing(self):
        props = inertia.mass_properties(two_disc_part(), STEEL)
        turned = Unbalance.of(props, Shaft([0, 0, 0.02], [0, 0, 0.28], [0, 1, 0]))
        still = Unbalance.of(props, on_z(0.02, 0.28))
        assert turned.static == pytest.approx(still.rotated(-math.pi / 2).static, rel=1e-12)

    def test_seen_from_the_other_end_angles_run_the_other_way(self):
        props = inertia.mass_properties(two_disc_part(), STEEL)
        still = Unbalance.of(props, on_z(0.02, 0.28))
        back = Unbalance.of(props, Shaft([0, 0, 0.28], [0, 0, 0.02], [1, 0, 0]))
        assert back.static == pytest.approx(still.static.conjugate(), rel=1e-12)
        assert back.couple == pytest.approx(-still.couple.conjugate(), rel=1e-12)
        a, b = back.in_planes(-0.28, -0.02)
        assert (b.conjugate(), a.conjugate()) == pytest.approx(still.in_planes(0.02, 0.28), rel=1e-12)


class TestPlanes:
    @settings(deadline=None, max_examples=80)
    @given(VECTOR, VECTOR, NUMBER, st.lists(NUMBER, min_size=2, max_size=6))
    def test_vectors_in_planes_are_the_same_unbalance_of_least_norm(self, static, couple, z, zs):
        if np.ptp(zs) < 0.05:
            return
        unbalance = Unbalance(1.0, z, static, couple).in_many_planes(zs)
        # Moore–Penrose, of the two conditions ΣU = U and ΣU z = D + U z_G.
        rows = np.array([np.ones(len(zs)), zs])
        expected = np.linalg.pinv(rows) @ [static, couple + static * z]
        np.testing.assert_allclose(unbalance, expected, atol=1e-9)
        np.testing.assert_allclose(rows @ unbalance, [static, couple + static * z], atol=1e-11)

    def test_two_planes_are_the_lever_rule(self):
        rotor = Unbalance(5.0, 0.3, 2 + 1j, 0.4 - 0.1j)
        b = (rotor.static * (0.3 - 0.1) + rotor.couple) / 0.4
        assert rotor.in_planes(0.1, 0.5) == pytest.approx((rotor.static - b, b), rel=1e-14)

    @given(VECTOR, VECTOR, NUMBER, NUMBER)
    def test_the_couple_moves_with_the_plane_by_the_static_unbalance(self, static, couple, z, other):
        unbalance = Unbalance(1.0, z, static, couple).couple_about(other)
        assert unbalance == pytest.approx(couple + static * (z - other), abs=1e-12)

    @pytest.mark.parametrize(
        ("zs", "says"),
        [
            ([0.2, 0.2], "coincide at z = 0.2 m"),
            ([0.1], "two planes or more"),
            ([0.1, math.inf], "finite"),
            ([7.0, 7.0, 7.0], "coincide"),
        ],
    )
    def test_planes_that_bear_no_couple_are_refused(self, zs, says):
        with pytest.raises(UsageError, match=says):
            Unbalance(1.0, 0.0, 1.0, 1.0).in_many_planes(zs)


class TestMasses:
    MASSES = (weight(1.5, 40, 30, 50), weight(-0.7, 90, 200, 310), weight(0.2, 10, 300, -20))

    def test_added_masses_are_those_of_the_assembly(self):
        """Against the algebra of mass properties: a body and points, in exact arithmetic."""
        shaft = Shaft([0.1, 0, 0], [0.5, 0.3, 0], [0, 0, 1])
        body = inertia.MassProperties(8.0, 1e-3, [0.31, 0.14, 0.003], np.diag([0.2, 0.3, 0.4]))
        whole = body
        for k in self.MASSES:
            point = inertia.point_masses([shaft.place(k.z, k.radius, k.angle)], [abs(k.mass)])
            whole = whole + point if k.mass > 0 else whole - point
        unbalance = Unbalance.of(body, shaft).with_masses(self.MASSES)
        expected = Unbalance.of(whole, shaft)
        assert (unbalance.mass, unbalance.z) == pytest.approx((expected.mass, expected.z), rel=1e-13)
        assert unbalance.static == pytest.approx(expected.static, rel=1e-12)
        assert unbalance.couple == pytest.approx(expected.couple, rel=1e-11)

    def test_vectors_change_no_mass_but_the_same_planes(self):
        rotor = lumped([weight(3, 10, 20, 100), weight(2, 30, 220, 300)])
        by_mass = rotor.with_masses(self.MASSES)
        by_vector = rotor.with_vectors([(k.z, k.unbalance) for k in self.MASSES])
        assert (by_vector.mass, by_vector.z) == (rotor.mass, rotor.z)
        assert by_mass.in_planes(0, 0.4) == pytest.approx(by_vector.in_planes(0, 0.4), rel=1e-12)

    def test_the_opposite_vectors_leave_nothing(self):
        rotor = lumped([weight(3, 10, 20, 100), weight(2, 30, 220, 300)])
        a, b = rotor.in_planes(0.05, 0.35)
        left = rotor.with_vectors([(0.05, -a), (0.35, -b)])
        assert abs(left.static) < 1e-15
        assert abs(left.couple) < 1e-15

    def test_more_mass_than_there_is_cannot_be_taken_away(self):
        with pytest.raises(UsageError, match=r"leave -1 kg of 2 kg.*take away less"):
            Unbalance(2.0, 0.0, 0.0, 0.0).with_masses([PointMass(-3.0, 1.0, 0.0, 0.0)])


class TestKind:
    @pytest.mark.parametrize(
        ("static", "couple", "kind"),
        [
            (0, 0, "balanced"),
            (1, 0, "static"),
            (0, 1j, "couple"),
            (1 + 1j, -3 - 3j, "quasi-static"),
            (1 + 1j, 3 - 3j, "dynamic"),
        ],
    )
    def test_names_what_vanishes(self, static, couple, kind):
        assert Unbalance(1.0, 0.0, static, couple).kind == kind

    def test_a_quasi_static_unbalance_is_one_vector(self):
        rotor = lumped([weight(5, 0, 0, 100), weight(0.1, 50, 70, 260)])
        assert rotor.kind == "quasi-static"
        place = rotor.z + (rotor.couple / rotor.static).real
        assert place == pytest.approx(0.26, rel=1e-12)
        assert abs(rotor.couple_about(place)) < 1e-15

    def test_what_is_within_its_bound_counts_as_nothing(self):
        body = inertia.MassProperties(10.0, 0.0, [1e-5, 0, 0.5], np.diag([1.0, 1.0, 0.5]))
        sharp, blurred = (Unbalance.of(body, on_z(), radial_uncertainty=r) for r in (0.9e-5, 1.1e-5))
        assert (sharp.kind, blurred.kind) == ("static", "balanced")

    def test_one_eccentric_disc_is_static_and_two_opposite_ones_a_couple(self):
        disc = revolved([(0, 0), (40, 0), (40, 10), (0, 10)], 48)
        shaft = on_z(0.0, 0.1)
        one = surface(moved(disc, 3, 0, 0), unit="mm")
        two = surface(moved(disc, 3, 0, 0), moved(disc, -3, 0, 50), unit="mm")
        kinds = [Unbalance.of(inertia.mass_properties(part, STEEL), shaft).kind for part in (one, two)]
        assert kinds == ["static", "couple"]


class TestQuantities:
    def test_units_of_the_shop(self):
        assert pytest.approx(720.0778873750, rel=1e-14) == OUNCE_INCH / GRAM_MILLIMETRE
        assert in_gmm(at(2e-3, 77)) == pytest.approx(2000)
        assert angular_speed(60.0) == pytest.approx(2 * math.pi)

    @pytest.mark.parametrize(("degrees", "shown"), [(0, 0), (90, 90), (-90, 270), (359.5, 359.5), (-1e-20, 0)])
    def test_angles_run_from_0_to_below_360(self, degrees, shown):
        assert in_degrees(at(1.0, degrees)) == pytest.approx(shown, abs=1e-12)
        assert in_degrees(at(1.0, degrees)) < 360

    def test_specific_unbalance_in_micrometres_is_gram_millimetres_by_kilogram(self):
        rotor = Unbalance(4.0, 0.0, at(800e-6, 10), 0.0)
        assert rotor.eccentricity * 1e6 == pytest.approx(800 / 4)
