"""§ 13.22: stability of rotation about the principal axes.

A small wobble goes round at Ω1 = ω √((I1 − I3)(I1 − I2)/(I2 I3)), cyclic; Ω2 is imaginary. For moments 2, 3, 4 and
ω = 6 rad/s: Ω1 = 6 √(2/12) = √6, Ω3 = 6 √(2/6) = 2√3, and about axis 2 the wobble grows at 6 √(1/8) = 3/√2.
"""

import math

import numpy as np
import pytest
from tests.textbook.worked import follow, free

import inertia
from inertia.dynamics.kinematics.stability import growth_rate, stable_axes, wobble_frequencies
from inertia_meshes import path

MOMENTS, SPIN, SMALL = [2, 3, 4], 6.0, 1e-6


def test_the_three_frequencies():
    np.testing.assert_allclose(wobble_frequencies(MOMENTS, SPIN), [math.sqrt(6), 0, 2 * math.sqrt(3)], rtol=1e-15)
    assert growth_rate(MOMENTS, SPIN) == pytest.approx(3 / math.sqrt(2), rel=1e-15)
    assert stable_axes(MOMENTS).tolist() == [True, False, True]


@pytest.mark.parametrize(("axis", "frequency"), [(0, math.sqrt(6)), (2, 2 * math.sqrt(3))])
def test_a_wobble_about_a_stable_axis(axis, frequency):
    """ω2 starts at ε and follows ε cos Ωt, to ε³."""
    start = np.zeros(3)
    start[axis], start[1] = SPIN, SMALL
    run = free(MOMENTS, start, 10.0)
    np.testing.assert_allclose(run.angular_velocity[:, 1], SMALL * np.cos(frequency * run.time), atol=1e-12)


def test_a_wobble_about_the_intermediate_axis_grows():
    """ω1 starts at ε and follows ε cosh(3 t/√2): 1e4-fold within 4.7 s."""
    run = free(MOMENTS, [SMALL, SPIN, 0], 4.5)
    np.testing.assert_allclose(run.angular_velocity[:, 0], SMALL * np.cosh(3 / math.sqrt(2) * run.time), rtol=1e-4)


def test_explorer_1():
    """Spun about its long axis at 750 rpm, it loses energy but no angular momentum, and ends about the axis of I3.

    L = √((I1 ω1)² + (I2 ω2)²) stays; T falls from L²/2I1, nearly, to L²/2I3. The spin falls to L/I3 = 1.11 rad/s.
    """
    scene = inertia.Scene.load(path("scenes/explorer_1.toml"))
    run = inertia.simulate(scene)
    i1, i2, i3 = scene.body.moments
    momentum = math.hypot(i1 * 78.5, i2 * 0.8)
    np.testing.assert_allclose(np.linalg.norm(run.angular_momentum, axis=1), momentum, rtol=1e-7)
    assert (np.diff(run.energy) <= 1e-9 * run.energy[0]).all()
    assert run.energy[-1] == pytest.approx(momentum**2 / (2 * i3), rel=1e-3)
    np.testing.assert_allclose(np.abs(run.angular_velocity[-1]), [0, 0, momentum / i3], atol=0.02)
    assert stable_axes(scene.body.moments, dissipation=True).tolist() == [False, False, True]


def test_losses_calm_a_spin_about_the_largest_moment():
    """Off axis 3 by a little, with energy to lose: it comes back to it."""
    run = follow(
        {"principal_moments": MOMENTS}, [0.1, 0.2, 3], 60.0, load=[{"kind": "dissipation", "rate": 0.5}], accuracy=1e-8
    )
    momentum = math.sqrt(0.2**2 + 0.6**2 + 12**2)
    np.testing.assert_allclose(run.angular_velocity[-1], [0, 0, momentum / 4], atol=1e-6)
