"""The bounds on an unbalance hold, and are not much larger than what can happen."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.balancing.rotors import STEEL, on_z, two_disc_part
from tests.mass.parts import surface

import inertia
from inertia import ErrorBound, UsageError
from inertia.balancing import bounds
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.unbalance import PointMass, Unbalance
from inertia_meshes.shapes import box, moved

PLANES = (0.02, 0.28)


@pytest.fixture(scope="module")
def two_discs():
    return inertia.mass_properties(two_disc_part(), STEEL)


@pytest.fixture(scope="module")
def plate():
    """Return a body whose transverse moments differ."""
    return inertia.mass_properties(surface(moved(box(200, 40, 120), 3, 2, 150), unit="mm"), STEEL)


class TestAxis:
    RADIUS = 2e-5

    @settings(deadline=None, max_examples=60)
    @given(st.floats(0, 2 * math.pi), st.floats(0, 2 * math.pi), st.booleans())
    def test_bearings_moved_within_the_radius_stay_within_the_bound(self, two_discs, plate, first, second, flat):
        body = plate if flat else two_discs
        shaft = on_z(*PLANES)
        nominal = Unbalance.of(body, shaft, radial_uncertainty=self.RADIUS)
        a, b = ([self.RADIUS * math.cos(k), self.RADIUS * math.sin(k), 0] for k in (first, second))
        moved_ = Unbalance.of(body, Shaft(shaft.bearing_a + a, shaft.bearing_b + b, [1, 0, 0]))
        limits = nominal.bounds_in_planes(PLANES)
        changes = zip(nominal.in_planes(*PLANES), moved_.in_planes(*PLANES), limits, strict=True)
        for was, is_, limit in changes:
            assert abs(is_ - was) <= limit["axis"] * (1 + 1e-3)  # the bound is to first order

    def test_the_bound_is_reached_by_the_worst_pair_of_shifts(self, two_discs):
        shaft = on_z(*PLANES)
        nominal = Unbalance.of(two_discs, shaft, radial_uncertainty=self.RADIUS)
        together = np.array([self.RADIUS, 0, 0])
        moved_ = Unbalance.of(two_discs, Shaft(shaft.bearing_a + together, shaft.bearing_b + together, [1, 0, 0]))
        assert abs(moved_.static - nominal.static) == pytest.approx(nominal.bounds_of(1.0, 0.0)["axis"], rel=1e-9)
        apart = Unbalance.of(two_discs, Shaft(shaft.bearing_a - together, shaft.bearing_b + together, [1, 0, 0]))
        assert abs(apart.couple - nominal.couple) == pytest.approx(nominal.bounds_of(0.0, 1.0)["axis"], rel=0.01)

    def test_of_uneven_transverse_moments_the_couple_is_bounded_by_the_larger(self, plate):
        shaft = on_z(*PLANES)
        nominal = Unbalance.of(plate, shaft, radial_uncertainty=self.RADIUS)
        changes = []
        for angle in np.linspace(0, math.pi, 19):
            off = self.RADIUS * np.array([math.cos(angle), math.sin(angle), 0])
            tilted = Unbalance.of(plate, Shaft(shaft.bearing_a - off, shaft.bearing_b + off, [1, 0, 0]))
            changes.append(abs(tilted.couple_about(nominal.z) - nominal.couple))
        bound = nominal.bounds_of(0.0, 1.0)["axis"]
        assert min(changes) < 0.8 * max(changes)
        assert 0.99 * bound < max(changes) <= bound * (1 + 1e-3)

    def test_20_micrometres_of_axis_are_as_much_as_the_limit_of_case_14(self, two_discs):
        rotor = Unbalance.of(two_discs, on_z(*PLANES), radial_uncertainty=20e-6)
        assert rotor.bounds_of(1.0, 0.0)["axis"] == pytest.approx(11.014 * 20e-6, rel=1e-3)

    @pytest.mark.parametrize("radius", [-1e-6, math.nan, math.inf])
    def test_a_radius_that_is_none_is_refused(self, two_discs, radius):
        with pytest.raises(UsageError, match="radial uncertainty of the axis"):
            Unbalance.of(two_discs, on_z(*PLANES), radial_uncertainty=radius)


class TestErrors:
    def test_properties_off_within_their_error_stay_within_the_bound(self):
        body = inertia.MassProperties(4.0, 0.0, [1e-3, 2e-3, 0.5], np.diag([2.0, 2.1, 1.0]))
        error = ErrorBound("given", 0.0, 1e-3, 1e-5, 1e-3)
        rng = np.random.default_rng(5)
        nominal = Unbalance.of(body, on_z(), tessellation=error, chord=1e-5)
        norm = np.linalg.norm(body.inertia)
        worst = 0.0
        for _ in range(300):
            shift = rng.normal(size=3)
            shift *= 1e-5 / np.linalg.norm(shift)
            skew = rng.normal(size=(3, 3))
            skew += skew.T
            skew *= 1e-3 * norm / np.linalg.norm(skew)
            mass = 4.0 * (1 + 1e-3 * rng.choice([-1, 1]))
            true = Unbalance.of(
                inertia.MassProperties(mass, 0.0, body.center_of_mass + shift, body.inertia + skew), on_z()
            )
            du = abs(true.static - nominal.static)
            assert du <= nominal.static_bound
            assert abs(true.couple_about(nominal.z) - nominal.couple) <= nominal.couple_bound
            worst = max(worst, du / nominal.static_bound)
        assert worst > 0.5

    def test_an_eccentric_body_carries_the_error_of_its_place_along_the_shaft_into_the_couple(self):
        body = inertia.MassProperties(4.0, 0.0, [0.3, 0, 0.5], np.eye(3))
        error = ErrorBound("given", 0.0, 0.0, 1e-3, 0.0)
        nominal = Unbalance.of(body, on_z(), tessellation=error)
        true = Unbalance.of(inertia.MassProperties(4.0, 0.0, [0.3, 0, 0.501], np.eye(3)), on_z())
        change = abs(true.couple_about(nominal.z) - nominal.couple)
        assert 0.99 * nominal.couple_bound < change <= nominal.couple_bound

    def test_the_cause_and_the_source_are_kept(self):
        body = inertia.MassProperties(4.0, 0.0, [0, 0, 0.5], np.eye(3))
        rotor = Unbalance.of(body, on_z(), tessellation=ErrorBound("given", 0, 0, 1e-5, 0), chord=2e-5)
        assert [(k.source, k.cause) for k in rotor.uncertainties] == [("arithmetic", None), ("tessellation", 2e-5)]


class TestDensity:
    def test_two_bodies_of_uncertain_density_may_err_apart(self):
        bodies = [(1e-3 + 0j, 2e-5j), (-1e-3 + 0j, 3e-5j)]
        bound = bounds.density(bodies, 0.01)
        assert bound.bound(1.0, 0.0) == pytest.approx(2e-5)
        assert bound.bound(0.0, 1.0) == pytest.approx(5e-7)
        # (1e-3 ± 1 %) − (1e-3 ∓ 1 %) is 2e-5 off: the bound is reached.

    @pytest.mark.parametrize("relative", [-0.1, 1.0, math.nan])
    def test_a_relative_figure_that_is_none_is_refused(self, relative):
        with pytest.raises(UsageError, match="relative uncertainty of the density"):
            bounds.density([], relative)


class TestFrames:
    @given(st.floats(-1, 1), st.floats(-2, 2), st.floats(-3, 3), st.floats(0, 6))
    def test_a_source_seen_from_another_plane_or_angle_bounds_the_same(self, shift, p, q, angle):
        source = bounds.Uncertainty("axis", ((1 + 2j, 0.5j), (-1j, 2.0)), 1e-5)
        there = source.about(shift).turned(cmath.rect(1.0, angle))
        # p U + q D with D = D' + U shift.
        assert there.bound(p + q * shift, q) == pytest.approx(source.bound(p, q), abs=1e-12)

    def test_masses_added_leave_the_bounds_in_every_plane(self):
        rotor = Unbalance(2.0, 0.3, 1e-3, 0.0, (bounds.Uncertainty("axis", ((1e-5, 2e-6), (0, 1e-6)), 1e-5),))
        more = rotor.with_masses([PointMass(1.0, 0.0, 0.0, 0.9)])
        assert more.z == pytest.approx(0.5)
        for one, other in zip(rotor.bounds_in_planes((0.1, 0.7)), more.bounds_in_planes((0.1, 0.7)), strict=True):
            assert one["axis"] == pytest.approx(other["axis"], rel=1e-12)

    def test_several_of_one_source_add_up(self):
        source = bounds.Uncertainty("tessellation", ((1e-5, 0.0),), 1e-5)
        rotor = Unbalance(2.0, 0.3, 1e-3, 0.0).with_uncertainties(source, source)
        assert rotor.bounds_of(1.0, 0.0) == {"tessellation": pytest.approx(2e-5)}
