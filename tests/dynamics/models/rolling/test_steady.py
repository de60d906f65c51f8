"""Steady circles and the speeds at which they last, against known results and against motions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.models.rolling.rolling_oracle import Wheel, roll

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.rolling.equations import RollingBody
from inertia.dynamics.models.rolling.motion import solve_rolling
from inertia.dynamics.models.rolling.steady import (
    SteadyRolling,
    edge_spin_threshold,
    steady_circle,
    steady_rolling,
    straight_rolling,
    straight_rolling_threshold,
)
from inertia.errors import GeometryError, UsageError

DISC = RollingBody(0.5, 0.5 * 0.09 / 4, 0.5 * 0.09 / 2, 0.3, gravity=9.81)
HOOP = RollingBody(0.5, 0.5 * 0.09 / 2, 0.5 * 0.09, 0.3, gravity=9.81)
WHEEL = RollingBody(2.0, 0.05, 0.08, 0.3, 0.07, 9.81)
CUP = RollingBody(2.0, 0.05, 0.08, 0.3, -0.2, 9.81)
BODIES = [DISC, HOOP, WHEEL, CUP]


def lean(steady: SteadyRolling) -> np.ndarray:
    return quaternion.from_rotation_vector([steady.theta, 0.0, 0.0])


class TestCircles:
    @pytest.mark.parametrize("body", BODIES)
    def test_newton_and_euler_in_space_keep_the_tilt_and_the_circle(self, body):
        steady = steady_rolling(body, 1.1, 4.0)
        wheel = Wheel(body.mass, body.transverse, body.axial, body.radius, body.offset, body.gravity)
        answer = roll(wheel, lean(steady), steady.angular_velocity, [0.0, 0.3, 0.6])
        assert answer.rotation[:, 2, 2] == pytest.approx(math.cos(1.1), abs=3e-15)
        center = np.array([0.0, steady.contact_radius])  # along k × e₁ of the contact at the origin
        apart = np.linalg.norm(answer.position[:, :2] - center, axis=-1)
        assert apart == pytest.approx(abs(steady.center_radius), abs=1e-14)
        horizontal = np.linalg.norm(answer.force[:, :2], axis=-1)
        assert horizontal / answer.force[:, 2] == pytest.approx(steady.friction, rel=1e-12)
        assert answer.force[:, 2] == pytest.approx(body.mass * body.gravity, rel=1e-12)

    @settings(deadline=None, max_examples=50)
    @given(st.sampled_from(BODIES), st.floats(0.3, 1.3), st.floats(0.5, 20.0))
    def test_tilt_and_radius_give_the_precession_back(self, body, theta, precession):
        steady = steady_rolling(body, theta, precession)
        again = steady_circle(body, theta, steady.contact_radius)
        assert again.precession == pytest.approx(precession, rel=1e-9)
        assert again.spin == pytest.approx(steady.spin, rel=1e-9, abs=1e-9)

    def test_a_disc_whose_centre_rests_precesses_at_four_g_over_r_sine(self):
        for theta in (0.01, 0.1, 1.0):
            steady = steady_circle(DISC, theta, DISC.radius * math.cos(theta))
            assert steady.precession**2 == pytest.approx(4 * 9.81 / (0.3 * math.sin(theta)), rel=1e-13)
            assert steady.center_radius == pytest.approx(0, abs=1e-16)

    def test_a_radius_that_no_speed_allows_is_an_error(self):
        with pytest.raises(GeometryError, match="no one speed keeps a body tilted by 1 rad on a circle"):
            steady_circle(DISC, 1.0, -2.0)
        with pytest.raises(UsageError, match="a circle needs one that is finite and not zero"):
            steady_rolling(DISC, 1.0, 0.0)
        with pytest.raises(UsageError, match="between 0 and π"):
            steady_rolling(DISC, 4.0, 1.0)


class TestStability:
    def test_a_disc_rolls_upright_above_v_squared_g_r_over_3_and_a_hoop_above_g_r_over_4(self):
        assert straight_rolling_threshold(DISC) ** 2 == pytest.approx(9.81 / (3 * 0.3), rel=1e-14)
        assert straight_rolling_threshold(HOOP) ** 2 == pytest.approx(9.81 / (4 * 0.3), rel=1e-14)

    def test_a_disc_spins_on_its_edge_above_4_g_over_5_r(self):
        assert edge_spin_threshold(DISC) ** 2 == pytest.approx(4 * 9.81 / (5 * 0.3), rel=1e-14)
        steady = SteadyRolling(DISC, math.pi / 2, edge_spin_threshold(DISC), 0.0)
        assert steady.nutation_squared == pytest.approx(0, abs=1e-12)
        with pytest.raises(GeometryError, match="only a body with offset 0 spins on its edge"):
            edge_spin_threshold(CUP)

    @pytest.mark.parametrize("body", BODIES)
    def test_straight_rolling_changes_stability_at_its_threshold(self, body):
        limit = straight_rolling_threshold(body)
        below, at, above = (straight_rolling(body, limit * x).nutation_squared for x in (0.99, 1.0, 1.01))
        assert below < -0.1 < 0.1 < above
        assert at == pytest.approx(0, abs=1e-12)

    @pytest.mark.parametrize("body", BODIES)
    def test_small_nutations_have_the_frequency(self, body):
        steady = steady_rolling(body, 1.1, 6.0)
        frequency = math.sqrt(steady.nutation_squared)
        time = np.linspace(0.0, 2 * np.pi / frequency, 65)
        push = 1e-5 * frequency
        spin = np.add(steady.angular_velocity, [push, 0.0, 0.0])
        motion = solve_rolling(
            body.mass, (body.transverse, body.axial), body.radius, body.offset, 9.81, lean(steady), spin, time, 1e-11
        )
        wave = motion.quantities["theta"] - steady.theta
        assert wave == pytest.approx(1e-5 * np.sin(frequency * time), abs=1e-9)

    @pytest.mark.parametrize("body", BODIES)
    def test_a_slow_straight_roll_grows_at_the_rate(self, body):
        steady = straight_rolling(body, 0.5 * straight_rolling_threshold(body))
        rate = math.sqrt(-steady.nutation_squared)
        spin = np.add(steady.angular_velocity, [1e-5 * rate, 0.0, 0.0])
        time = np.linspace(0.0, 3 / rate, 20)
        motion = solve_rolling(
            body.mass, (body.transverse, body.axial), body.radius, body.offset, 9.81, lean(steady), spin, time, 1e-11
        )
        wave = motion.quantities["theta"] - steady.theta
        assert wave == pytest.approx(1e-5 * np.sinh(rate * time), abs=1e-7)
