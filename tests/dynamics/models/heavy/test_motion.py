"""The closed form of the heavy symmetric top against Taylor series to 38 digits and the textbook's quadratures."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.models.heavy.heavy_oracle import attitude_error, let_go
from tests.dynamics.oracle import rotate

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.heavy.top import HeavyTop, solve_heavy_top
from inertia.errors import GeometryError, UsageError

MOMENTS = 1.0, 0.5
TILTED = [0.1, -0.3, 0.4, 0.9]
UPRIGHT, HANGING = [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]
NEAR = [1e-9, -3e-10, 0.3, 0.9]

STARTS = {
    "generic": (2.0, TILTED, [0.3, 0.4, 5.0], 4.0),
    "no reversal": (2.0, TILTED, [0.9, -1.5, 6.0], 4.0),
    "cusp": (2.0, TILTED, [0.0, 0.0, 8.0], 4.0),
    "loops": (2.0, TILTED, [-0.4, 0.7, 8.0], 4.0),
    "spinning backwards": (2.0, TILTED, [0.3, 0.4, -5.0], 4.0),
    "slow": (2.0, TILTED, [0.0, 0.1, 0.1], 6.0),
    "fast": (2.0, TILTED, [0.1, 0.2, 400.0], 0.1),
    "hanging": (-2.0, TILTED, [0.3, 0.4, 5.0], 4.0),
    "through upright": (2.0, UPRIGHT, [1.0, 0.5, 3.0], 4.0),
    "through hanging": (2.0, HANGING, [1.0, 0.5, 3.0], 4.0),
    "weight below, through upright": (-2.0, UPRIGHT, [1.0, 0.0, 3.0], 4.0),
    "pendulum": (2.0, [0.5, 0.0, 0.0, 0.9], [0.7, 0.0, 0.0], 6.0),
    "pendulum that goes round": (2.0, [0.5, 0.0, 0.0, 0.9], [7.0, 0.0, 0.0], 4.0),
    "spherical pendulum": (-2.0, TILTED, [0.3, 1.4, 0.0], 6.0),
    "separatrix of the pendulum": (1.0, HANGING, [2.0, 0.0, 0.0], 8.0),
    "1e-12 from the separatrix": (1.0, HANGING, [2.0 * (1 + 1e-12), 0.0, 0.0], 40.0),
    "separatrix of a spinning top": (2.0, [0.5, 0.0, 0.0, 0.5], [0.0, 2.0, 4.0], 8.0),
    "sleeping, disturbed": (2.0, NEAR, [0.0, 0.0, 8.0], 4.0),
    "sleeping, moving": (2.0, UPRIGHT, [1e-9, 2e-9, 8.0], 4.0),
    "sleeping, falling": (2.0, NEAR, [0.0, 0.0, 3.0], 25.0),
    "sleeping, a hair below the threshold": (2.0, [1e-5, 0, 0, 1.0], [0.0, 0.0, 5.65685], 20.0),
    "sleeping, at the threshold": (2.0, [1e-6, 0, 0, 1.0], [0.0, 0.0, 32.0**0.5], 20.0),
    "sleeping, exactly": (2.0, [0.0, 0.0, 0.3, 0.9], [0.0, 0.0, 5.0], 4.0),
    "hanging, a hair off": (2.0, [1.0, 0.0, 1e-9, 1e-10], [1e-9, 0.0, 3.0], 10.0),
    "no weight": (0.0, TILTED, [1.0, 0.1, 3.0], 10.0),
    "hardly any weight": (1e-13, TILTED, [1.0, 0.1, 3.0], 10.0),
    "no weight, at rest": (0.0, TILTED, [0.0, 0.0, 0.0], 10.0),
}


def followed(moments, mgh, attitude, omega, times):
    i1, i3 = moments
    return rotate(
        (i1, i1, i3), omega, times, attitude=attitude, mass=1.0, offset=(0.0, 0.0, mgh), gravity=(0.0, 0.0, -1.0)
    )


@pytest.mark.parametrize("name", STARTS)
def test_attitude_and_spin_agree_with_taylor_series(name):
    mgh, attitude, omega, end = STARTS[name]
    times = [0.0, 0.31 * end, 0.7 * end, end]
    motion = solve_heavy_top(MOMENTS, mgh, attitude, omega, times)
    truth = followed(MOMENTS, mgh, attitude, omega, times)
    fastest = float(np.linalg.norm(truth.angular_velocity.astype(float), axis=1).max())
    assert truth.error < 1e-20
    assert truth.attitude_error(motion.attitude).max() <= motion.reached < 3e-14
    assert truth.angular_velocity_error(motion.angular_velocity).max() <= 1e-14 * fastest


def test_times_before_the_start_are_as_good():
    times = [-1.0, -4.0]
    motion = solve_heavy_top(MOMENTS, 2.0, TILTED, [0.3, 0.4, 5.0], times)
    assert followed(MOMENTS, 2.0, TILTED, [0.3, 0.4, 5.0], times).attitude_error(motion.attitude).max() < 4e-15


@settings(max_examples=12, deadline=None)
@given(
    st.floats(-3, 0.3),
    st.floats(-20, 20),
    st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: max(map(abs, q)) > 0.1),
    st.tuples(*[st.floats(-3, 3)] * 3),
)
def test_any_top_agrees_with_taylor_series(log_i3, mgh, attitude, omega):
    moments, times = (1.0, 10.0**log_i3), [0.0, 0.4, 1.1]
    motion = solve_heavy_top(moments, mgh, attitude, omega, times)
    truth = followed(moments, mgh, attitude, omega, times)
    assert truth.attitude_error(motion.attitude).max() <= motion.reached


@pytest.mark.parametrize(
    ("mgh", "half_angle", "spin"),
    [(2.0, (0.35, 0.9), 8.0), (2.0, (0.35, 0.9), 0.3), (2.0, (1e-5, 1.0), 5.6), (1.0, (0.7, 0.7), 1e4)],
)
def test_the_error_does_not_grow_with_the_time(mgh, half_angle, spin):
    times = [0.0, 2e3, 1e6, 1e9]
    s, c = half_angle
    motion = solve_heavy_top(MOMENTS, mgh, [s, 0, 0, c], [0, 0, spin], times)
    assert attitude_error(motion.attitude, let_go(MOMENTS, mgh, half_angle, spin, times)) <= motion.reached < 2e-14


@pytest.mark.parametrize(
    ("mgh", "half_angle", "spin"), [(2.0, (0.35, 0.9), 8.0), (2.0, (0.35, 0.9), 0.3), (2.0, (1e-5, 1.0), 5.6)]
)
def test_periods_are_told_apart_beyond_the_whole_numbers_of_float64(mgh, half_angle, spin):
    times = np.linspace(2e16, 6e17, 12)
    s, c = half_angle
    motion = solve_heavy_top(MOMENTS, mgh, [s, 0, 0, c], [0, 0, spin], times)
    assert attitude_error(motion.attitude, let_go(MOMENTS, mgh, half_angle, spin, times)) <= motion.reached < 1e-11


def test_the_quadratures_agree_with_taylor_series():
    times = [0.0, 1.3, 4.0]
    truth = followed(MOMENTS, 2.0, [0.35, 0, 0, 0.9], [0, 0, 8.0], times)
    by_quadrature = let_go(MOMENTS, 2.0, (0.35, 0.9), 8.0, times)
    assert truth.attitude_error(by_quadrature.astype(float)).max() < 1e-15


@pytest.mark.parametrize("name", STARTS)
def test_energy_and_both_momenta_are_kept(name):
    mgh, attitude, omega, _ = STARTS[name]
    motion = solve_heavy_top(MOMENTS, mgh, attitude, omega, np.linspace(0.0, 1e4, 500))
    for name, values in motion.invariants.items():
        assert np.abs(values - values[0]).max() <= 4e-15 * motion.scales[name], name


@pytest.mark.parametrize("name", ["generic", "hanging", "through upright", "pendulum", "1e-12 from the separatrix"])
def test_theta_turns_at_the_turning_points_and_nowhere_passes_them(name):
    mgh, attitude, omega, end = STARTS[name]
    times = np.linspace(0.0, end, 4001)
    motion = solve_heavy_top(MOMENTS, mgh, attitude, omega, times)
    least, greatest = motion.quantities["turning theta"]
    theta = motion.quantities["theta"]
    assert least - 1e-14 <= theta.min()
    assert theta.max() <= greatest + 1e-14
    assert motion.events
    for event in motion.events:
        there = solve_heavy_top(MOMENTS, mgh, attitude, omega, [event.time]).quantities["theta"].item()
        assert there == pytest.approx(least if "least" in event.what else greatest, abs=2e-14)
    signs = np.sign(np.diff(theta))
    assert abs(np.count_nonzero(np.diff(signs)) - len(motion.events)) <= 1


@pytest.mark.parametrize("spin", [20.0, 200.0, -31.7, 0.3])
@pytest.mark.parametrize("push", [1e-3, 0.1, 1.0, 5.0, 7.3])
@pytest.mark.parametrize("attitude", [UPRIGHT, HANGING])
def test_a_top_that_starts_through_the_vertical_turns_at_once(attitude, push, spin):
    """There θ is least, or greatest; the next turn is half a period on."""
    motion = solve_heavy_top(MOMENTS, 2.0, attitude, [push, 0.0, spin], np.linspace(0.0, 40.0, 3))
    first, second, *_ = motion.events
    assert first.time == 0.0
    assert second.time == pytest.approx(motion.quantities["nutation period"] / 2, rel=1e-12)


def test_turning_points_alternate_at_half_the_period():
    motion = solve_heavy_top(MOMENTS, 2.0, TILTED, [0.3, 0.4, 5.0], np.linspace(-50.0, 50.0, 3))
    gaps = np.diff([event.time for event in motion.events])
    period = HeavyTop.of_state(MOMENTS, 2.0, TILTED, [0.3, 0.4, 5.0]).nutation_period
    np.testing.assert_allclose(gaps, period / 2, rtol=1e-12)
    kinds = ["least" in event.what for event in motion.events]
    assert all(a != b for a, b in pairwise(kinds))


@pytest.mark.parametrize("mgh", [2.0, -2.0])
@pytest.mark.parametrize("tilt", [0.4, math.pi / 2, 2.2])
@pytest.mark.parametrize("which", [0, 1])
def test_a_steady_precession_keeps_its_tilt_and_its_rate(mgh, tilt, which):
    spin = 8.0
    rate = HeavyTop.of_state(MOMENTS, mgh, [0.3, 0, 0, 0.9], [0, 0, spin]).steady_precession(tilt)[which]
    if math.isinf(rate):
        assert (tilt, which) == (math.pi / 2, 1)
        return
    attitude = [math.sin(tilt / 2), 0.0, 0.0, math.cos(tilt / 2)]
    omega = [0.0, rate * math.sin(tilt), spin]
    times = np.linspace(0.0, 2.0, 50)
    motion = solve_heavy_top(MOMENTS, mgh, attitude, omega, times)
    np.testing.assert_allclose(motion.quantities["theta"], tilt, rtol=0, atol=2e-15 * (1 + abs(rate)))
    phi = np.unwrap(motion.quantities["phi"])
    np.testing.assert_allclose(phi - phi[0], rate * times, rtol=1e-13, atol=1e-13)
    assert motion.quantities["precession rate"] == pytest.approx(rate, rel=1e-12)
    assert HeavyTop.of_state(MOMENTS, mgh, attitude, omega).kind == "steady precession"
    assert motion.events == ()


def test_the_mean_precession_is_what_phi_gains_over_a_period():
    for name in ("generic", "loops", "cusp", "no reversal", "spinning backwards", "hanging", "spherical pendulum"):
        mgh, attitude, omega, _ = STARTS[name]
        top = HeavyTop.of_state(MOMENTS, mgh, attitude, omega)
        motion = solve_heavy_top(MOMENTS, mgh, attitude, omega, np.linspace(0.0, top.nutation_period, 2001))
        phi, theta = np.unwrap(motion.quantities["phi"]), motion.quantities["theta"]
        assert phi[-1] - phi[0] == pytest.approx(top.precession_rate * top.nutation_period, abs=1e-13), name
        assert theta[-1] == pytest.approx(theta[0], abs=1e-13)


def test_an_unstable_sleeping_top_stays_upright_exactly_and_says_so():
    motion = solve_heavy_top(MOMENTS, 2.0, UPRIGHT, [0.0, 0.0, 3.0], [0.0, 100.0])
    assert motion.quantities["theta"].tolist() == [0.0, 0.0]
    assert "unstable" in motion.warnings[0]
    assert f"{2 / (8 - 1.5**2) ** 0.5:.3g} s" in motion.warnings[0]
    assert not solve_heavy_top(MOMENTS, 2.0, UPRIGHT, [0.0, 0.0, 6.0], [0.0, 100.0]).warnings


def test_the_attitude_need_not_be_normalised_and_another_start_joins_on():
    omega = [0.3, 0.4, 5.0]
    whole = solve_heavy_top(MOMENTS, 2.0, TILTED, omega, [3.0])
    scaled = solve_heavy_top(MOMENTS, 2.0, 7.0 * np.array(TILTED), omega, [3.0])
    half = solve_heavy_top(MOMENTS, 2.0, TILTED, omega, [1.5])
    joined = solve_heavy_top(MOMENTS, 2.0, half.attitude[0], half.angular_velocity[0], [1.5])
    assert quaternion.angle_between(whole.attitude, scaled.attitude).max() < 4e-15
    assert quaternion.angle_between(whole.attitude, joined.attitude).max() < 2e-14
    np.testing.assert_allclose(np.linalg.norm(whole.attitude, axis=1), 1.0, rtol=4e-16)


def test_input_that_is_no_top_is_refused():
    with pytest.raises(GeometryError, match="positive, and I3 not negative and at most 2 I1"):
        solve_heavy_top((1.0, 2.1), 2.0, UPRIGHT, [0, 0, 1], [0.0])
    with pytest.raises(GeometryError, match="positive"):
        solve_heavy_top((0.0, 0.0), 2.0, UPRIGHT, [0, 0, 1], [0.0])
    with pytest.raises(UsageError, match="attitude is zero"):
        solve_heavy_top(MOMENTS, 2.0, [0, 0, 0, 0], [0, 0, 1], [0.0])
    with pytest.raises(UsageError, match="angular_velocity holds a value that is not finite"):
        solve_heavy_top(MOMENTS, 2.0, UPRIGHT, [0, 0, math.nan], [0.0])
    with pytest.raises(UsageError, match="time holds a value that is not finite"):
        solve_heavy_top(MOMENTS, 2.0, UPRIGHT, [0, 0, 1], [0.0, math.inf])
