"""Quantities of the heavy symmetric top against the textbook's formulas, in mpmath where digits matter."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.dynamics.models.heavy.model import characteristics
from inertia.dynamics.models.heavy.top import HeavyTop
from inertia.errors import GeometryError, UsageError

I1, I3, MGH = 1.0, 0.5, 2.0
RELEASED = [0.3, 0.0, 0.0, 0.9]


def tilted(theta, omega, mgh=MGH):
    return HeavyTop.of_state((I1, I3), mgh, [math.sin(theta / 2), 0, 0, math.cos(theta / 2)], omega)


def exact_drive(moments, mgh, attitude, omega):
    """Return (1 − u²)(2 I1 E′ − 2 I1 mgh u) − (p_φ − p_ψ u)² as a function of θ, in mpf, the start being exact."""
    i1, i3, mgh = map(mpmath.mpf, (*moments, mgh))
    x, y, z, w = (mpmath.mpf(c) for c in attitude)
    size = x * x + y * y + z * z + w * w
    g1, g2, g3 = 2 * (x * z - w * y) / size, 2 * (y * z + w * x) / size, (w * w + z * z - x * x - y * y) / size
    p, q, r = map(mpmath.mpf, omega)
    p_psi, p_phi = i3 * r, i1 * (p * g1 + q * g2) + i3 * r * g3
    rest = i1 * (p * p + q * q) / 2 + mgh * g3

    def drive(theta):
        u = mpmath.cos(theta)
        return (1 - u * u) * 2 * i1 * (rest - mgh * u) - (p_phi - p_psi * u) ** 2

    return drive


def assert_bounds_of_motion(top, attitude, omega, slack):
    """θ̇² is positive just inside the turning angles, and negative just outside."""
    with mpmath.workdps(90):
        drive = exact_drive((top.I1, top.I3), top.mgh, attitude, omega)
        first, second = map(mpmath.mpf, top.turning_angles)
        assert first <= slack(first) or drive(first - slack(first)) < 0
        assert second > mpmath.pi - slack(second) or drive(second + slack(second)) < 0
        if second - first > 2 * (slack(first) + slack(second)):
            assert drive(first + slack(first)) > 0
            assert drive(second - slack(second)) > 0


def test_the_integrals_are_those_of_the_textbook():
    top = tilted(0.7, [0.3, 0.4, 5.0])
    theta_rate, phi_rate = 0.3, 0.4 / math.sin(0.7)  # at ψ = 0, ω = (θ̇, φ̇ sinθ, φ̇ cosθ + ψ̇)
    assert top.p_psi == pytest.approx(I3 * 5.0, rel=1e-15)
    assert top.p_phi == pytest.approx(I1 * phi_rate * math.sin(0.7) ** 2 + top.p_psi * math.cos(0.7), rel=1e-15)
    assert top.effective_energy == pytest.approx(
        0.5 * I1 * (theta_rate**2 + (phi_rate * math.sin(0.7)) ** 2) + MGH * math.cos(0.7), rel=1e-14
    )
    assert top.effective_potential(0.7) == pytest.approx(top.effective_energy - 0.5 * I1 * theta_rate**2, rel=1e-14)


def test_the_effective_potential_is_the_textbooks_and_finite_only_at_a_vertical_in_reach():
    top = HeavyTop(I1, I3, MGH, 1.2, 2.5, 12.0)
    for theta in (0.1, 1.0, math.pi / 2, 3.0):
        expected = (1.2 - 2.5 * math.cos(theta)) ** 2 / (2 * I1 * math.sin(theta) ** 2) + MGH * math.cos(theta)
        assert top.effective_potential(theta) == pytest.approx(expected, rel=1e-13)
    assert top.effective_potential(0.0) == math.inf
    assert top.effective_potential(math.pi) > 1e30  # the float64 π falls short of the vertical
    through = HeavyTop(I1, I3, MGH, 2.5, 2.5, 12.0)
    assert through.effective_potential(0.0) == MGH
    assert through.effective_potential(1e-9) == pytest.approx(MGH, rel=1e-15)


@settings(max_examples=60, deadline=None)
@given(
    st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: max(map(abs, q)) > 0.1),
    st.tuples(*[st.floats(-9, 9)] * 3).filter(lambda omega: max(map(abs, omega[:2])) > 1e-6),
    st.floats(-9, 9).filter(lambda mgh: abs(mgh) > 1e-3),
)
def test_turning_angles_are_the_roots_of_the_cubic(attitude, omega, mgh):
    top = HeavyTop.of_state((I1, I3), mgh, attitude, omega)
    assert_bounds_of_motion(top, attitude, omega, lambda theta: mpmath.mpf(4e-15))


@pytest.mark.parametrize("tilt", [1e-3, 1e-8, 1e-14])
@pytest.mark.parametrize("spin", [3.0, 5.6568542, 5.657, 8.0])
def test_turning_angles_of_a_sleeping_top_keep_their_digits(tilt, spin):
    attitude, omega = [tilt, 0.0, 0.0, 1.0], [0.3 * tilt, 0.0, spin]
    top = HeavyTop.of_state((I1, I3), MGH, attitude, omega)
    assert_bounds_of_motion(top, attitude, omega, lambda theta: 2e-15 * theta)
    assert 0 < top.turning_angles[0] < 2 * tilt


@pytest.mark.parametrize("mgh", [MGH, -MGH])
def test_the_top_moves_where_the_effective_potential_lets_it(mgh):
    top = tilted(0.7, [0.3, 0.4, 5.0], mgh)
    first, second = top.turning_angles
    assert 0 < first < 0.7 < second < math.pi
    for angle in (first, second):
        assert top.effective_potential(angle) == pytest.approx(top.effective_energy, rel=1e-13)
    within = np.linspace(first, second, 101)[1:-1]
    assert (top.effective_potential(within) < top.effective_energy).all()


def test_the_three_kinds_of_nutation_follow_from_the_push_at_release():
    assert tilted(0.7, [0.0, 0.0, 8.0]).kind == "cusp"
    assert tilted(0.7, [0.0, 1e-6, 8.0]).kind == "no reversal"  # pushed along the precession
    assert tilted(0.7, [0.0, -1e-6, 8.0]).kind == "loops"  # against it
    assert tilted(0.7, [0.0, 0.1, -8.0]).kind == "loops"  # the other spin precesses the other way
    assert tilted(0.7, [0.0, 0.0, 1e3]).kind == "cusp"
    assert tilted(0.7, [0.0, 0.0, 8.0], mgh=-MGH).kind == "cusp"


def test_degenerate_motions_have_names_of_their_own():
    upright, hanging = [0, 0, 0, 1], [1, 0, 0, 0]
    assert HeavyTop.of_state((I1, I3), MGH, upright, [0, 0, 8]).kind == "sleeping"
    assert HeavyTop.of_state((I1, I3), MGH, upright, [0, 0, 1]).kind == "sleeping"
    assert HeavyTop.of_state((I1, I3), MGH, hanging, [0, 0, 0]).kind == "sleeping"
    assert HeavyTop.of_state((I1, I3), 0.0, RELEASED, [0, 0, 0]).kind == "steady precession"
    assert HeavyTop.of_state((I1, I3), MGH, RELEASED, [1, 0, 0]).kind == "pendulum"
    assert HeavyTop.of_state((I1, I3), MGH, RELEASED, [9, 0, 0]).kind == "pendulum"
    assert HeavyTop.of_state((I1, I3), MGH, RELEASED, [0, 1, 0]).kind == "no reversal"  # spherical pendulum
    assert HeavyTop.of_state((I1, I3), MGH, upright, [1, 0, 8]).kind == "no reversal"  # through the vertical
    assert HeavyTop.of_state((I1, I3), MGH, upright, [1, 0, 8]).turning_angles[0] == 0.0


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_names_do_not_depend_on_the_units(scale):
    """Moments × s and times ÷ s leave the shape of the path as it is: mgh grows by s³."""
    for omega, kind in (([0, 0, 8], "cusp"), ([0, -0.1, 8], "loops"), ([0, 0.1, 8], "no reversal")):
        faster = scale * np.array(omega)
        assert HeavyTop.of_state((scale * I1, scale * I3), scale**3 * MGH, RELEASED, faster).kind == kind


def test_integrals_alone_give_the_same_top():
    for theta, omega in ((0.7, [0.3, 0.4, 5.0]), (2.0, [0.3, -0.4, 5.0]), (0.7, [0.0, -0.7, 8.0])):
        made = tilted(theta, omega)
        given_ = HeavyTop(I1, I3, MGH, made.p_phi, made.p_psi, made.energy)
        assert given_.kind == made.kind
        np.testing.assert_allclose(given_.turning_angles, made.turning_angles, rtol=1e-13)
        assert given_.nutation_period == pytest.approx(made.nutation_period, rel=1e-13)
        assert given_.precession_rate == pytest.approx(made.precession_rate, rel=1e-12)


@pytest.mark.parametrize("tilt", [0.3, 1.2, math.pi / 2, 2.5])
@pytest.mark.parametrize("mgh", [MGH, -MGH])
def test_steady_precession_is_the_least_effective_potential(tilt, mgh):
    p_psi = 4.0
    for rate in HeavyTop(I1, I3, mgh, 0.0, p_psi, 30.0).steady_precession(tilt):
        if math.isinf(rate):
            assert tilt == math.pi / 2
            continue
        p_phi = p_psi * math.cos(tilt) + I1 * rate * math.sin(tilt) ** 2
        least = 0.5 * I1 * (rate * math.sin(tilt)) ** 2 + mgh * math.cos(tilt)
        top = HeavyTop(I1, I3, mgh, p_phi, p_psi, least + p_psi**2 / (2 * I3))
        assert top.kind == "steady precession"
        np.testing.assert_allclose(top.turning_angles, tilt, atol=1e-7)
        nearby = tilt + np.array([-1e-3, 0.0, 1e-3])
        assert np.argmin(top.effective_potential(nearby)) == 1
        with pytest.raises(GeometryError, match="below the least"):
            HeavyTop(I1, I3, mgh, p_phi, p_psi, least + p_psi**2 / (2 * I3) - 1e-9)


def test_slow_and_fast_precession_are_the_textbooks_roots():
    """p_φ − p_ψ cosθ = p_ψ sin²θ/(2 cosθ) [1 ± √(1 − 4 mgh I1 cosθ/p_ψ²)], and mgh/p_ψ for a fast top."""
    p_psi, tilt = 4.0, 0.8
    slow, fast = HeavyTop(I1, I3, MGH, 0.0, p_psi, 30.0).steady_precession(tilt)
    for rate, sign in ((slow, -1), (fast, 1)):
        bracket = 1 + sign * math.sqrt(1 - 4 * MGH * I1 * math.cos(tilt) / p_psi**2)
        flow = p_psi * math.sin(tilt) ** 2 / (2 * math.cos(tilt)) * bracket
        assert I1 * rate * math.sin(tilt) ** 2 == pytest.approx(flow, rel=1e-14)
    slow, fast = HeavyTop(I1, I3, MGH, 0.0, 1e9, 1e19).steady_precession(tilt)
    assert slow == pytest.approx(MGH / 1e9, rel=1e-15)
    assert fast == pytest.approx(1e9 / (I1 * math.cos(tilt)), rel=1e-15)
    assert HeavyTop(I1, I3, MGH, 0.0, 4.0, 30.0).steady_precession(math.pi / 2) == (MGH / 4.0, math.inf)
    conical = HeavyTop(I1, I3, MGH, 0.0, 0.0, 30.0).steady_precession(2.5)
    assert conical[0] == pytest.approx(math.sqrt(-MGH / (I1 * math.cos(2.5))), rel=1e-15)
    assert conical[1] == pytest.approx(-conical[0], rel=1e-15)


def test_steady_precession_needs_the_spin_of_the_exercise():
    """Exercise 5: (I3 ω3)² ≥ 4 m g h I1 cosθ; at the threshold both rates are p_ψ/(2 I1 cosθ)."""
    tilt = 0.6
    least = 2.0 * math.sqrt(MGH * I1 * math.cos(tilt))
    top = HeavyTop(I1, I3, MGH, 0.0, least, 30.0)
    assert top.least_p_psi(tilt) == pytest.approx(least, rel=1e-15)
    slow, fast = top.steady_precession(tilt)
    assert slow == pytest.approx(fast, rel=1e-7)
    assert slow == pytest.approx(least / (2 * I1 * math.cos(tilt)), rel=1e-7)
    with pytest.raises(GeometryError, match=f"at least {least:.6g}"):
        HeavyTop(I1, I3, MGH, 0.0, least * (1 - 1e-12), 30.0).steady_precession(tilt)
    assert top.least_p_psi(2.0) == 0.0
    with pytest.raises(GeometryError, match="not vanish"):
        HeavyTop(I1, I3, MGH, 0.0, 0.0, 30.0).steady_precession(math.pi / 2)


def test_a_sleeping_top_is_stable_from_the_threshold_on():
    """p_ψ² ≥ 4 mgh I1 = 8, an exact number in neither case: ω3 = 4√2 = 5.6568…"""
    below, above = (HeavyTop.of_state((I1, I3), MGH, [0, 0, 0, 1], [0, 0, spin]) for spin in (5.6568, 5.6569))
    assert not below.sleeps_stably
    assert above.sleeps_stably
    assert HeavyTop.of_state((4.0, 2.0), 1.0, [0, 0, 0, 1], [0, 0, 2.0]).sleeps_stably  # 16 ≥ 16
    assert HeavyTop.of_state((I1, I3), -MGH, [0, 0, 0, 1], [0, 0, 0]).sleeps_stably
    assert above.growth_rate == 0.0
    assert tilted(0.0, [0, 0, 0]).growth_rate == pytest.approx(math.sqrt(MGH / I1), rel=1e-15)
    # released 1e-6 rad off, one falls over and the other does not
    assert tilted(1e-6, [0, 0, 5.6]).turning_angles[1] > 0.1
    assert tilted(1e-6, [0, 0, 5.7]).turning_angles[1] < 1e-5


def test_the_growth_rate_is_how_fast_a_small_tilt_grows():
    top = tilted(1e-9, [0, 0, 3.0])
    first, second = (tilted(1e-9 * k, [0, 0, 3.0]).nutation_period for k in (1.0, 10.0))
    assert first - second == pytest.approx(2 * math.log(10) / top.growth_rate, rel=1e-9)


def test_periods_of_small_nutations_and_of_the_plane_pendulum():
    """Sleeping: p_ψ²/(4 I1²) − mgh/I1 is the squared frequency about the precessing frame, θ ≥ 0 nods at twice that.

    Pendulum: 2 √(I1/mgh) K(sin ½θ₀) from one side to the other, mpmath's ellipk.
    """
    small = 2 * math.sqrt((I3 * 8.0) ** 2 / (4 * I1**2) - MGH / I1)
    assert tilted(0.0, [0, 0, 8.0]).nutation_period == pytest.approx(2 * math.pi / small, rel=1e-15)
    assert tilted(1e-7, [0, 0, 8.0]).nutation_period == pytest.approx(2 * math.pi / small, rel=1e-12)
    assert tilted(0.0, [0, 0, 3.0]).nutation_period == math.inf
    hanging_angle = math.pi - 2.0
    half_swing = 2 * math.sqrt(I1 / MGH) * float(mpmath.ellipk(math.sin(hanging_angle / 2) ** 2))
    assert tilted(2.0, [0, 0, 0]).nutation_period == pytest.approx(half_swing, rel=1e-14)


def test_a_conical_pendulum_goes_round_at_the_root_of_g_over_its_depth():
    tilt, mgh = 2.5, 3.0
    pace = math.sqrt(-mgh / math.cos(tilt))
    assert sorted(HeavyTop(1.0, 0.0, mgh, 0.0, 0.0, mgh).steady_precession(tilt)) == pytest.approx([-pace, pace])
    momentum = pace * math.sin(tilt) ** 2
    energy = 0.5 * (pace * math.sin(tilt)) ** 2 + mgh * math.cos(tilt)
    top = HeavyTop(1.0, 0.0, mgh, momentum, 0.0, energy)
    assert (top.kind, top.effective_energy) == ("steady precession", energy)
    assert top.turning_angles == pytest.approx((tilt, tilt), abs=1e-7)


def test_on_the_separatrix_the_period_is_infinite():
    top = HeavyTop.of_state((1.0, 0.5), 1.0, [1, 0, 0, 0], [2, 0, 0])  # ½ 2² − 1 = 1: just reaches the top
    assert top.nutation_period == math.inf
    assert math.isnan(top.precession_rate)
    assert top.turning_angles == (0.0, math.pi)
    assert HeavyTop.of_state((1.0, 0.5), MGH, [1, 0, 0, 1], [0, 2, 4]).kind == "no reversal"


def test_a_fast_top_precesses_at_mgh_over_p_psi_on_average():
    top = tilted(0.7, [0, 0, 1e4])
    assert top.precession_rate == pytest.approx(MGH / top.p_psi, rel=1e-6)
    assert top.turning_angles[1] - 0.7 == pytest.approx(2 * MGH * I1 * math.sin(0.7) / top.p_psi**2, rel=1e-6)


def test_what_is_no_top_is_refused():
    with pytest.raises(GeometryError, match="at most 2 I1"):
        HeavyTop(1.0, 2.001, MGH, 0.0, 0.0, 3.0)
    with pytest.raises(GeometryError, match="must be positive"):
        HeavyTop(-1.0, 0.5, MGH, 0.0, 0.0, 3.0)
    with pytest.raises(GeometryError, match=r"p_psi = 0\.1 kg m²/s takes a moment I3, which is 0"):
        HeavyTop(1.0, 0.0, MGH, 0.0, 0.1, 3.0)
    with pytest.raises(GeometryError, match="rests at any tilt"):
        HeavyTop(1.0, 0.5, 0.0, 0.0, 0.0, 0.0)
    with pytest.raises(GeometryError, match="below the least"):
        HeavyTop(1.0, 0.5, MGH, 3.0, 0.0, 0.0)
    with pytest.raises(UsageError, match="not finite"):
        HeavyTop(1.0, 0.5, math.nan, 0.0, 0.0, 3.0)
    with pytest.raises(UsageError, match="attitude is zero"):
        HeavyTop.of_state((1.0, 0.5), MGH, [0, 0, 0, 0], [0, 0, 1])


WORDS = [(1.9, "it swings as a pendulum"), (2.1, "a pendulum that goes over the top")]


@pytest.mark.parametrize(("rate", "words"), WORDS)
def test_a_pendulum_that_goes_over_the_top_is_not_said_to_swing(rate: float, words: str) -> None:
    """From below it takes I ω²/2 = 2 mgh to reach the top: 2 rad/s here."""
    top = HeavyTop.of_state((1.0, 0.5), 1.0, [1.0, 0.0, 0.0, 0.0], [rate, 0.0, 0.0])
    assert characteristics(top)[1][0].endswith(f"{words}.")
