"""§ 13.23: the heavy symmetric top about a fixed point.

The case: M = 0.1 kg, h = 4 cm, at the centre of mass 2e-4, 2e-4, 1.25e-4 kg m². Steiner: I1 = 2e-4 + 0.1 · 0.04² =
3.6e-4; M g h = 0.039 227 N m. Spun at 150 rad/s, p_ψ = I3 ω3 = 0.018 75 kg m²/s.
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import G, follow, tilted

from inertia.dynamics.models.heavy.top import HeavyTop

BODY = {"principal_moments": [2e-4, 2e-4, 1.25e-4], "mass": 0.1, "center_of_mass": [0, 0, 0.04]}
I1, I3, MGH = 3.6e-4, 1.25e-4, 0.1 * G * 0.04


def spun(omega, theta, duration, **rest):
    held = {"constraint": {"kind": "fixed_point"}, "load": [{"kind": "gravity"}]}
    return follow(BODY, omega, duration, attitude=tilted(theta), **held, **rest)


def test_let_go_at_rest_it_nods_between_two_angles():
    """E′ = M g h cosθ1 and p_φ = p_ψ cosθ1 leave sin²θ = a (cosθ1 − cosθ) at the other turn, a = p_ψ²/(2 I1 M g h).

    cosθ2 = (a − √(a² − 4 a cosθ1 + 4))/2. There φ̇ is greatest; at θ1 it is zero: a cusp.
    """
    theta1 = math.radians(30)
    run = spun([0, 0, 150], theta1, 2.0, samples=4001)
    a = (I3 * 150) ** 2 / (2 * I1 * MGH)
    theta2 = math.acos((a - math.sqrt(a * a - 4 * a * math.cos(theta1) + 4)) / 2)
    theta = run.euler_angles()[:, 1]
    assert run.model == "heavy symmetric top"
    assert theta.min() == pytest.approx(theta1, abs=1e-12)
    assert theta.max() == pytest.approx(theta2, abs=1e-6)
    assert theta.max() <= theta2 + 1e-12
    top = HeavyTop.of_state((I1, I3), MGH, tilted(theta1), [0, 0, 150])
    np.testing.assert_allclose(top.turning_angles, [theta1, theta2], rtol=1e-12)
    np.testing.assert_allclose(top.effective_potential([theta1, theta2]), top.effective_energy, rtol=1e-12)
    assert top.kind == "cusp"


def test_the_momenta_and_the_energy_are_kept():
    """p_ψ = I3 ω3, p_φ = I1 φ̇ sin²θ + p_ψ cosθ, E = T + M g h cosθ."""
    theta, (across, spin) = 0.5, (3.0, 150.0)
    run = spun([0, across, spin], theta, 2.0)
    momenta = run.canonical_momenta()
    np.testing.assert_allclose(momenta[:, 2], I3 * spin, rtol=1e-12)
    np.testing.assert_allclose(momenta[:, 0], I1 * across * math.sin(theta) + I3 * spin * math.cos(theta), rtol=1e-12)
    expected = 0.5 * I1 * across**2 + 0.5 * I3 * spin**2 + MGH * math.cos(theta)
    np.testing.assert_allclose(run.energy, expected, rtol=1e-12)


@pytest.mark.parametrize(("rate", "kind"), [(0.0, "cusp"), (-1.0, "loops"), (1.0, "no reversal")])
def test_three_kinds_of_nutation(rate, kind):
    """By the sign of φ̇ where the axis stands highest; the slow steady precession would be at 2.1 rad/s."""
    theta = 0.5
    top = HeavyTop.of_state((I1, I3), MGH, tilted(theta), [0, rate * math.sin(theta), 150])
    assert top.kind == kind


@pytest.mark.parametrize("sign", [-1, 1])
def test_slow_and_fast_steady_precession(sign):
    """p_φ − p_ψ cosθ = (p_ψ sin²θ/2 cosθ) [1 ± √(1 − 4 M g h I1 cosθ/p_ψ²)] = I1 φ̇ sin²θ: the tilt stays."""
    theta, p_psi = 0.5, I3 * 150
    root = math.sqrt(1 - 4 * MGH * I1 * math.cos(theta) / p_psi**2)
    rate = p_psi / (2 * I1 * math.cos(theta)) * (1 + sign * root)
    run = spun([0, rate * math.sin(theta), 150], theta, 1.0)
    phi, tilt, _ = run.euler_angles().T
    np.testing.assert_allclose(tilt, theta, atol=1e-10)
    np.testing.assert_allclose(phi - phi[0], rate * run.time, atol=1e-9)
    top = HeavyTop.of_state((I1, I3), MGH, tilted(theta), [0, rate * math.sin(theta), 150])
    assert top.steady_precession(theta)[(sign + 1) // 2] == pytest.approx(rate, rel=1e-12)


def test_the_sleeping_top():
    """Upright it is stable for p_ψ² ≥ 4 M g h I1, that is ω3 ≥ 60.1 rad/s; below, a tilt grows as cosh λt.

    λ = √(4 M g h I1 − p_ψ²)/(2 I1), the root of small tilts: at 40 rad/s 7.8 1/s.
    """
    limit = math.sqrt(4 * MGH * I1) / I3
    tilt, growth = 1e-6, math.sqrt(4 * MGH * I1 - (I3 * 40) ** 2) / (2 * I1)
    assert HeavyTop.of_state((I1, I3), MGH, tilted(0), [0, 0, 1.001 * limit]).sleeps_stably
    assert not HeavyTop.of_state((I1, I3), MGH, tilted(0), [0, 0, 0.999 * limit]).sleeps_stably
    asleep = spun([0, 0, 1.1 * limit], tilt, 1.0, accuracy=1e-7).euler_angles()[:, 1]
    assert asleep.max() < 4 * tilt
    # Let go with the axis at rest in space it turns in the frame of the fall at half p_ψ/I1: the amplitude of e^λt is
    # ½ |1 − i p_ψ/(2 I1 λ)| of the tilt.
    awake = spun([0, 0, 40.0], tilt, 1.0, accuracy=1e-7).euler_angles()[:, 1]
    share = 0.5 * math.hypot(1, I3 * 40 / (2 * I1 * growth))
    assert awake[-1] == pytest.approx(share * tilt * math.exp(growth), rel=1e-2)


def test_it_hangs_without_a_least_spin():
    """θ0 > π/2: every p_ψ has its steady precessions, of opposite senses."""
    top = HeavyTop.of_state((I1, I3), MGH, tilted(2.5), [0, 0, 1.0])
    slow, fast = top.steady_precession(2.5)
    assert slow * fast < 0
    assert top.least_p_psi(2.5) == 0
