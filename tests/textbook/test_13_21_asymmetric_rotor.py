"""§ 13.21: the free asymmetric rotor: L on the sphere |L| = const and on the ellipsoid Σ L²/2I = T.

L²/2I3 ≤ T ≤ L²/2I1, and at 2 T I2 = L² the curve is the separatrix. The case: moments 1, 2, 3 and ω = w (√3, 0, 1), for
which L² = 3 w² + 9 w² = 12 w² and 2T = 3 w² + 3 w² = 6 w² = L²/2: on the separatrix, where Euler's equations are solved
by ω = w (√3 sech wt, √3 tanh wt, sech wt).
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import free

from inertia.dynamics.kinematics.polhode import polhode
from inertia.dynamics.kinematics.stability import energy_bounds, separatrix_distance
from inertia.dynamics.models.free.flips import flip_period

ROOT = math.sqrt(3)


def test_sphere_and_ellipsoid():
    """ω = (1, 1, 1), moments 1, 2, 3: L² = 14, 2T = 6 throughout."""
    run = free([1, 2, 3], [1, 1, 1], 50.0)
    momentum = run.angular_velocity * [1, 2, 3]
    np.testing.assert_allclose(np.sum(momentum**2, axis=1), 14, rtol=1e-13)
    np.testing.assert_allclose(np.sum(momentum**2 / [1, 2, 3], axis=1), 6, rtol=1e-13)
    least, most = energy_bounds([1, 2, 3], math.sqrt(14))
    assert (least, most) == (pytest.approx(14 / 6), pytest.approx(7))


def test_the_polhode_is_that_curve():
    """2 T I2 = 12 < L² = 14: it goes round axis 3, and back to its start."""
    curve = polhode([1, 2, 3], [1, 1, 1])
    assert curve.axis == 2
    for branch in curve.branches:
        momentum = branch * [1, 2, 3]
        np.testing.assert_allclose(np.sum(momentum**2, axis=1), 14, rtol=1e-13)
        np.testing.assert_allclose(np.sum(momentum**2 / [1, 2, 3], axis=1), 6, rtol=1e-13)
        np.testing.assert_allclose(branch[-1], branch[0], atol=1e-14)


def test_the_separatrix():
    """w = 2 rad/s: after 2.5 s sech(5) = 0.0135 is left of the start; √3 is known to 1e-16, which grows by e⁵."""
    run = free([1, 2, 3], [2 * ROOT, 0, 2], 2.5)
    t = 2 * run.time
    expected = 2 * np.column_stack([ROOT / np.cosh(t), ROOT * np.tanh(t), 1 / np.cosh(t)])
    np.testing.assert_allclose(run.angular_velocity, expected, atol=1e-13)
    assert abs(separatrix_distance([1, 2, 3], [2 * ROOT, 0, 2])) < 1e-15


def test_two_equal_moments_give_circles():
    run = free([1, 1, 1.5], [0.5, 0.2, 1], 20.0)
    np.testing.assert_allclose(np.hypot(*run.angular_velocity[:, :2].T), math.hypot(0.5, 0.2), rtol=1e-14)


def test_the_tennis_racket_turns_over():
    """Moments 1, 2, 3, ω = (ε, w, 0): a flip every 2 K(m)/λ, near the separatrix.

    L² − 2T I1 = 2 w² and 2T I3 − L² = 2 (w² + ε²), so that 1 − m = ε²/(w² + ε²); λ = w/√3 but for ε², and
    K ≈ ½ ln(16/(1 − m)). For ε = 1e-3, w = 10 rad/s: (√3/10) ln(16e8) = 3.67 s.
    """
    expected = ROOT / 10 * math.log(16e8)
    assert flip_period([1, 2, 3], [1e-3, 10, 0]) == pytest.approx(expected, rel=1e-6)
    run = free([1, 2, 3], [1e-3, 10, 0], 20.0)
    flips = [event.time for event in run.events if event.name == "flip"]
    np.testing.assert_allclose(np.diff(flips), expected, rtol=1e-6)
