"""§ 13.15 and 13.16: the energy in rates of the Euler angles, and what is the same in every frame.

φ = 30°, θ = 60°, ψ = 90°, rates 4, 2, 6 rad/s as in § 13.14: ω = (2√3, −2, 8) along the body.
"""

import math

import numpy as np
import pytest

from inertia.dynamics.kinematics.canonical import (
    momenta_of_rates,
    rotational_energy,
    squared_angular_momentum,
    squared_speed,
)

ANGLES, RATES = np.radians([30, 60, 90]), [4, 2, 6]


def test_energy():
    """½ (1 · 12 + 2 · 4 + 3 · 64) = 106 J for moments 1, 2, 3."""
    assert rotational_energy([1, 2, 3], ANGLES, RATES) == pytest.approx(106, rel=1e-14)


@pytest.mark.parametrize(("theta", "expected"), [(0, 104), (60, 80), (90, 56), (180, 8)])
def test_the_square_of_the_spin(theta, expected):
    """φ̇² + θ̇² + ψ̇² + 2 φ̇ ψ̇ cosθ = 56 + 48 cosθ; (φ̇ ± ψ̇)² + θ̇² at the poles."""
    assert squared_speed([0.5, math.radians(theta), 1.0], RATES) == pytest.approx(expected, rel=1e-14)


def test_the_square_of_the_angular_momentum():
    """L = (2√3, −4, 24) for moments 1, 2, 3: 12 + 16 + 576 = 604, got from the canonical momenta."""
    momenta = momenta_of_rates([1, 2, 3], ANGLES, RATES)
    assert squared_angular_momentum(ANGLES, momenta) == pytest.approx(604, rel=1e-14)
