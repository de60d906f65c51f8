"""`solve_rolling` against Newton and Euler in space at 34 digits, closed forms, and what rolling means."""

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.models.rolling.rolling_oracle import Answer, Wheel, roll
from tests.dynamics.oracle import off_by

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.rolling.motion import solve_rolling
from inertia.dynamics.models.rolling.steady import RollingBody, steady_rolling
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError, UsageError

G = 9.81
TILTED = quaternion.from_rotation_vector([0.9, 0.4, -0.3])
UPRIGHT = quaternion.from_rotation_vector([math.pi / 2, 0.0, 0.0])
LEANING = quaternion.from_rotation_vector([1.0, 0.0, 0.0])
LIFTING = [3.0, 2.0, -4.5]
DISC, HOOP = (0.25, 0.5), (0.5, 1.0)

CASES = {
    "disc": (Wheel(1.0, *DISC, 1.0, 0.0, G), (0.1, 0.5, 1.2)),
    "hoop": (Wheel(1.0, *HOOP, 1.0, 0.0, G), (2.0, 3.0, -4.0)),
    "coin": (Wheel(7.5e-3, 2.745e-7, 5.49e-7, 0.0121, 0.0, G), (1.0, 20.0, -40.0)),
    "flying saucer": (Wheel(3.0, 0.3, 0.5, 0.8, 0.15, G), (1.0, 4.0, -3.0)),
    "cup": (Wheel(0.3, 1.1e-3, 0.9e-3, 0.05, -0.04, G), (2.0, -6.0, 30.0)),
    "fast": (Wheel(1.0, *DISC, 1.0, 0.0, G), (0.0, 3.0, -30.0)),
    "nearly flat": (Wheel(1.0, *DISC, 1.0, 0.0, G), (-1.0, 0.05, 0.02)),
}


def solved(name: str, time, accuracy: float, method: str | None = None) -> Motion:
    wheel, spin = CASES[name]
    moments = wheel.transverse, wheel.axial
    return solve_rolling(
        wheel.mass, moments, wheel.radius, wheel.offset, wheel.gravity, TILTED, spin, time, accuracy, method
    )


def disc(attitude, spin, time, accuracy: float = 1e-10, method: str | None = None) -> Motion:
    return solve_rolling(1.0, DISC, 1.0, 0.0, G, attitude, spin, time, accuracy, method)


def instants(name: str) -> np.ndarray:
    return math.sqrt(CASES[name][0].radius) * np.array([0.0, 0.25, 0.7])


@cache
def truth(name: str) -> Answer:
    answer = roll(CASES[name][0], TILTED, CASES[name][1], instants(name))
    assert answer.error < 1e-15
    assert answer.slip < 1e-15
    return answer


class TestAgainstNewtonAndEuler:
    @pytest.mark.parametrize("name", CASES)
    @pytest.mark.parametrize("accuracy", [1e-3, 1e-10, 1e-13])
    def test_the_attitude_is_within_what_was_reached_and_that_within_the_request(self, name, accuracy):
        answer, motion = truth(name), solved(name, instants(name), accuracy)
        off = quaternion.angle_between(motion.attitude, quaternion.from_matrix(answer.rotation)).max()
        assert off <= motion.reached + 4e-15
        assert motion.reached <= accuracy

    @pytest.mark.parametrize("name", CASES)
    def test_position_angular_velocity_and_force_follow(self, name):
        answer, motion = truth(name), solved(name, instants(name), 1e-13)
        pace = np.abs(answer.angular_velocity).max() + math.sqrt(G / CASES[name][0].radius)
        weight = CASES[name][0].mass * CASES[name][0].radius * pace**2
        assert np.abs(motion.angular_velocity - answer.angular_velocity).max() < 1e-12 * pace
        assert np.abs(motion.position[:, :2] - answer.position[:, :2]).max() < 1e-13
        assert np.abs(np.diff(motion.position[:, 2] - answer.position[:, 2])).max() < 1e-13
        assert np.abs(motion.quantities["contact force"] - answer.force).max() < 1e-11 * weight


class TestRolling:
    @pytest.mark.parametrize("name", CASES)
    def test_the_material_point_at_the_contact_is_at_rest(self, name):
        wheel, h = CASES[name][0], 1e-3 * math.sqrt(CASES[name][0].radius) / 5
        middle = np.linspace(0.1, 4.0, 30) * math.sqrt(wheel.radius)
        stencil = (middle[:, None] + h * np.arange(-4, 5)).ravel()
        motion = solved(name, stencil, 1e-12)
        place = motion.position.reshape(30, 9, 3)
        weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
        velocity = np.einsum("k,nkj->nj", weights, place) / h
        spin = quaternion.to_space(motion.attitude, motion.angular_velocity)[4::9]
        arm = motion.quantities["contact"][4::9] - motion.position[4::9]
        slip = velocity + np.cross(spin, arm)
        assert np.abs(slip).max() < 1e-8 * np.abs(velocity).max()
        assert np.linalg.norm(arm, axis=-1) == pytest.approx(math.hypot(wheel.radius, wheel.offset), rel=1e-13)
        axis = quaternion.to_space(motion.attitude[4::9], [0.0, 0.0, 1.0])
        assert (arm * axis).sum(-1) == pytest.approx(wheel.offset, abs=1e-13)

    @pytest.mark.parametrize("name", CASES)
    def test_energy_and_the_constants_stay_over_many_nutations(self, name):
        motion = solved(name, np.linspace(0.0, 50.0, 501) * math.sqrt(CASES[name][0].radius), 1e-11)
        assert "one nutation" in motion.method
        assert list(motion.invariants) == ["energy", "Appell–Korteweg 1", "Appell–Korteweg 2"]
        for key, values in motion.invariants.items():
            assert np.abs(values - values[0]).max() < 2e-12 * motion.scales.get(key, abs(values[0])), key

    @pytest.mark.parametrize("name", ["disc", "flying saucer", "cup"])
    def test_the_angles_make_the_attitude_and_their_rates_the_angular_velocity(self, name):
        motion = solved(name, np.linspace(0.0, 3.0, 40) * math.sqrt(CASES[name][0].radius), 1e-12)
        angles = [motion.quantities[key] for key in ("phi", "theta", "psi")]
        turns = [
            quaternion.from_rotation_vector(a[:, None] * e) for a, e in zip(angles, np.eye(3)[[2, 0, 2]], strict=True)
        ]
        made = quaternion.multiply(turns[0], quaternion.multiply(turns[1], turns[2]))
        assert quaternion.angle_between(made, motion.attitude).max() < 1e-14
        theta_rate, phi_rate, psi_rate = (motion.quantities[f"{key} rate"] for key in ("theta", "phi", "psi"))
        theta, psi = angles[1], angles[2]
        expected = np.stack(
            [
                theta_rate * np.cos(psi) + phi_rate * np.sin(theta) * np.sin(psi),
                phi_rate * np.sin(theta) * np.cos(psi) - theta_rate * np.sin(psi),
                psi_rate + phi_rate * np.cos(theta),
            ],
            axis=-1,
        )
        assert motion.angular_velocity == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max())

    @settings(deadline=None, max_examples=6)
    @given(st.floats(0, 6.28), st.floats(0, 6.28))
    def test_turning_space_and_the_marks_on_the_body_changes_nothing_else(self, heading, mark):
        time = np.linspace(0.0, 5.0, 11)
        plain = disc(LEANING, [0.3, 1.0, 2.0], time, 1e-12)
        about_z, about_axis = (quaternion.from_rotation_vector([0.0, 0.0, a]) for a in (heading, mark))
        start = quaternion.multiply(about_z, quaternion.multiply(LEANING, about_axis))
        turned = disc(start, quaternion.to_body(about_axis, [0.3, 1.0, 2.0]), time, 1e-12)
        expected = quaternion.multiply(about_z, quaternion.multiply(plain.attitude, about_axis))
        assert quaternion.angle_between(turned.attitude, expected).max() < 2e-12
        assert turned.position == pytest.approx(quaternion.to_space(about_z, plain.position), abs=5e-12)

    @pytest.mark.parametrize("name", ["disc", "flying saucer", "cup"])
    def test_either_way_along_the_symmetry_axis_may_be_axis_3(self, name):
        wheel, spin = CASES[name]
        time = np.linspace(0.0, 5.0, 21) * math.sqrt(wheel.radius)
        plain = solved(name, time, 1e-11)
        over = np.array([1.0, 0.0, 0.0, 0.0])
        flipped = solve_rolling(
            wheel.mass,
            (wheel.transverse, wheel.axial),
            wheel.radius,
            -wheel.offset,
            G,
            quaternion.multiply(TILTED, over),
            [spin[0], -spin[1], -spin[2]],
            time,
            1e-11,
        )
        assert flipped.quantities["theta"] == pytest.approx(np.pi - plain.quantities["theta"], abs=1e-10)
        apart = quaternion.angle_between(flipped.attitude, quaternion.multiply(plain.attitude, over))
        assert apart.max() <= plain.reached + flipped.reached
        assert flipped.position == pytest.approx(plain.position, abs=1e-10 * np.abs(plain.position).max())

    def test_motion_runs_backwards_when_the_spin_is_reversed(self):
        there = disc(LEANING, [0.3, 1.0, 2.0], [0.0, 7.0], 1e-12)
        back = disc(there.attitude[1], -there.angular_velocity[1], [0.0, 7.0], 1e-12)
        assert quaternion.angle_between(back.attitude[1], LEANING) < 5e-12
        assert back.angular_velocity[1] == pytest.approx([-0.3, -1.0, -2.0], abs=1e-11)


class TestNutations:
    @pytest.mark.parametrize("name", ["coin", "cup", "nearly flat"])
    def test_repeating_one_agrees_with_integrating_all(self, name):
        time = np.linspace(0.0, 10.0, 51) * math.sqrt(CASES[name][0].radius)
        one, whole = solved(name, time, 1e-11), solved(name, time, 1e-11, "DOP853")
        assert "nutation" not in whole.method
        assert one.steps < whole.steps
        apart = quaternion.angle_between(one.attitude, whole.attitude).max()
        assert apart <= one.reached + whole.reached
        assert np.abs(one.position - whole.position).max() < 1e-9 * np.abs(whole.position).max()

    def test_the_number_of_steps_does_not_grow_with_the_duration(self):
        short, long = (disc(LEANING, [0.3, 1.0, 2.0], [0.0, end], 1e-6) for end in (10.0, 1e5))
        assert long.steps <= 3 * short.steps
        assert long.reached <= 1e-6

    def test_an_accuracy_beyond_float64_is_answered_with_what_was_reached(self):
        motion = disc(LEANING, [0.3, 1.0, 2.0], [0.0, 1e4], 1e-15)
        assert 1e-15 < motion.reached < 1e-8


class TestClosedForms:
    def test_a_disc_above_its_threshold_rolls_straight_on(self):
        time = np.linspace(0.0, 30.0, 61)
        motion = disc(UPRIGHT, [0.0, 0.0, -3.0], time)
        assert motion.quantities["contact"][:, 0] == pytest.approx(3.0 * time, rel=1e-9)
        assert motion.position[:, 1:] == pytest.approx(np.tile([0.0, 1.0], (61, 1)), abs=1e-9)
        assert motion.quantities["contact force"] == pytest.approx(np.tile([0.0, 0.0, G], (61, 1)), abs=1e-9)
        assert not motion.warnings

    def test_an_upright_disc_below_its_threshold_is_warned_about_and_its_error_grows(self):
        motion = disc(UPRIGHT, [0.0, 0.0, -1.0], [0.0, 0.1, 20.0])
        assert motion.reached > 0.1
        assert "unstable steady motion" in motion.warnings[0]
        rate = math.sqrt((G - 3.0) / 1.25)  # (MgR − (I₃ + MR²) I₃ n²/I₁)/(I₁ + MR²)
        assert f"every {1 / rate:.3g} s" in motion.warnings[0]

    @pytest.mark.parametrize(("lean", "end"), [(1e-3, 2.5), (1e-9, 7.5), (3e-12, 9.3), (1e-13, 10.5)])
    def test_a_disc_that_is_let_go_near_the_upright_is_known_as_badly_as_its_start(self, lean, end):
        half = 0.25 * math.pi - 0.5 * lean
        start = [math.sin(half), 0.0, 0.0, math.cos(half)]
        motion = disc(start, [0.0, 0.0, 0.0], [0.0, end])
        with mpmath.workdps(30):
            begun = mpmath.pi / 2 - 2 * mpmath.atan(mpmath.mpf(start[0]) / mpmath.mpf(start[3]))
            fallen = float(mpmath.pi / 2 - mpmath.mpf(motion.quantities["theta"][-1]))
        assert fallen > 0.1
        assert off_by(lambda _: mpmath.mpf(1.25), G, begun, fallen, end) <= motion.reached < 0.1

    def test_a_run_of_one_step_does_not_claim_that_it_is_exact(self):
        """Whatever the tolerance, a step or two to the end give the same: that they agree proves nothing."""
        for accuracy in (1e-3, 1e-6, 1e-9):
            coarse, fine = (disc(LEANING, [0.3, 1.0, 2.0], [0.0, 0.02], tried) for tried in (accuracy, 1e-14))
            off = quaternion.angle_between(coarse.attitude[-1], fine.attitude[-1])
            assert off <= coarse.reached + fine.reached

    def test_a_steady_circle_is_a_circle_about_the_same_point(self):
        steady = steady_rolling(RollingBody(1.0, *DISC, 1.0, 0.0, G), 1.0, 3.0)
        motion = disc(LEANING, steady.angular_velocity, np.linspace(0.0, 40.0, 101))
        radius = np.linalg.norm(motion.quantities["contact"][:, :2] - [0.0, steady.contact_radius], axis=-1)
        assert radius == pytest.approx(abs(steady.contact_radius), rel=1e-9)
        assert motion.quantities["phi"] == pytest.approx(np.linspace(0.0, 120.0, 101), abs=1e-9)

    def test_a_disc_let_go_falls_flat_when_its_energy_says(self):
        def slowness(theta):
            return mpmath.sqrt(1.25 / (2 * mpmath.mpf(G) * (mpmath.sin(1) - mpmath.sin(theta))))

        due = float(mpmath.quad(slowness, [1e-6, 0.5, 1]))
        with pytest.raises(GeometryError, match=f"falls flat at t = {due:.8f}"):
            disc(LEANING, [0.0, 0.0, 0.0], [0.0, 2.0])
        before = disc(LEANING, [0.0, 0.0, 0.0], [0.0, 0.9 * due], 1e-12)
        theta, rate = before.quantities["theta"][1], before.quantities["theta rate"][1]
        assert rate == pytest.approx(-math.sqrt(2 * G * (math.sin(1.0) - math.sin(theta)) / 1.25), rel=1e-11)

    def test_a_slight_spin_keeps_the_disc_from_falling_flat(self):
        for accuracy in (1e-2, 1e-9):
            motion = disc(LEANING, [0.0, 1e-4, 0.0], np.linspace(0.0, 10.0, 2001), accuracy)
            assert motion.quantities["theta"].min() > 0
            assert abs(motion.quantities["phi"][-1]) > 3
            for name in ("Appell–Korteweg 1", "Appell–Korteweg 2"):
                assert np.ptp(motion.invariants[name]) < 1e-7 * motion.scales[name]


class TestLiftOff:
    def test_the_event_says_when_the_normal_force_changes_sign(self):
        motion = disc(LEANING, LIFTING, [0.0, 1.0])
        (event,) = motion.events
        assert event.name == "lift-off"
        assert "leaves the plane" in motion.warnings[0]
        around = event.time + np.array([-1e-6, 0.0, 1e-6])
        up = disc(LEANING, LIFTING, around, 1e-12).quantities["contact force"][:, 2]
        assert up[0] > 0 > up[2]
        assert up[1] == pytest.approx(0, abs=1e-7)

    def test_newton_and_euler_agree_that_the_plane_pulls_from_then_on(self):
        (event,) = disc(LEANING, LIFTING, [0.0, 1.0], 1e-13).events
        wheel = Wheel(1.0, *DISC, 1.0, 0.0, G)
        force = roll(wheel, LEANING, LIFTING, [event.time - 1e-9, event.time + 1e-9]).force[:, 2]
        assert force[0] > 0 > force[1]

    def test_a_run_that_ends_before_has_no_event(self):
        assert not disc(LEANING, LIFTING, [0.0, 0.01]).events

    def test_a_body_that_is_thrown_up_leaves_at_once(self):
        motion = disc(LEANING, [30.0, 0.0, 0.0], [0.0, 0.01])
        assert motion.events[0].time == 0.0


class TestArguments:
    @pytest.mark.parametrize(
        ("changes", "error", "message"),
        [
            ({"method": "RK4"}, UsageError, "use nutation or DOP853"),
            ({"accuracy": 0.0}, UsageError, "the accuracy is 0.0 rad"),
            ({"accuracy": math.nan}, UsageError, "the accuracy is nan rad"),
            ({"time": [0.0, 2.0, 1.0]}, UsageError, "must ascend from 0"),
            ({"time": [-1.0, 1.0]}, UsageError, "must ascend from 0"),
            ({"time": []}, UsageError, "must ascend from 0"),
            ({"attitude": [0, 0, 0, 0]}, UsageError, "the attitude is zero"),
            ({"attitude": [0, 0, 1, 0]}, GeometryError, "the body lies flat"),
            ({"attitude": [1, 0, 0, 0]}, GeometryError, "the body lies flat"),
            ({"offset": 0.9}, GeometryError, "the centre of mass -0.0.* m above the plane"),
            ({"angular_velocity": [math.inf, 0, 0]}, UsageError, "angular_velocity holds a value that is not finite"),
            ({"moments": (0.1, 0.5)}, GeometryError, "more than twice the transverse"),
            ({"radius": 0.0}, GeometryError, "the radius of the rolling body is 0"),
        ],
    )
    def test_what_cannot_be_used_is_named(self, changes, error, message):
        arguments = {
            "mass": 1.0,
            "moments": DISC,
            "radius": 1.0,
            "offset": 0.0,
            "gravity": G,
            "attitude": [math.sin(0.35), 0.0, 0.0, math.cos(0.35)],
            "angular_velocity": [0.0, 1.0, 2.0],
            "time": [0.0, 1.0],
            "accuracy": 1e-9,
        }
        with pytest.raises(error, match=message):
            solve_rolling(**{**arguments, **changes})

    def test_the_start_alone_may_be_asked_for(self):
        motion = disc(LEANING, [0.3, 1.0, 2.0], [0.0])
        assert quaternion.angle_between(motion.attitude[0], LEANING) < 1e-15
        assert motion.quantities["contact"][0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)
