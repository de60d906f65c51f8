"""The reduced equations against eq. 13.199 of the textbook and against Newton and Euler along the axes of space."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.models.rolling.rolling_oracle import Wheel, roll

from inertia.dynamics.models.rolling.equations import RollingBody, angular_acceleration, energy, reaction
from inertia.errors import GeometryError

rates = st.floats(-5, 5)
tilts = st.floats(0.1, 3.0)


def body(**changes: float) -> RollingBody:
    return RollingBody(**{"mass": 2.0, "transverse": 0.05, "axial": 0.08, "radius": 0.3, "gravity": 9.81, **changes})


@settings(deadline=None, max_examples=100)
@given(theta=tilts, theta_rate=rates, phi_rate=rates, psi_rate=rates)
def test_the_euler_angles_obey_the_three_equations_of_the_textbook(theta, theta_rate, phi_rate, psi_rate):
    disc = body()
    i1, i3, mr2, mgr = 0.05, 0.08, 2.0 * 0.3**2, 2.0 * 9.81 * 0.3
    s, c = math.sin(theta), math.cos(theta)
    w3 = phi_rate * c + psi_rate
    d1, d2, d3 = angular_acceleration(disc, s, c, theta_rate, phi_rate * s, w3)
    phi_second = (d2 - phi_rate * theta_rate * c) / s
    psi_second = d3 - phi_second * c + phi_rate * theta_rate * s
    first = (i1 + mr2) * d1 + (i3 + mr2) * phi_rate * s * w3 - i1 * phi_rate**2 * s * c + mgr * c
    second = i1 * phi_second * s + 2 * i1 * phi_rate * theta_rate * c - i3 * theta_rate * w3
    third = (i3 + mr2) * (phi_second * c - phi_rate * theta_rate * s + psi_second) - mr2 * theta_rate * phi_rate * s
    scale = mgr + theta_rate**2 + phi_rate**2 + psi_rate**2
    assert max(abs(first), abs(second), abs(third)) < 1e-14 * scale / s


@settings(deadline=None, max_examples=30)
@given(theta=tilts, w1=rates, w2=rates, w3=rates, offset=st.floats(-0.3, 0.3))
def test_the_reaction_is_that_of_newton_and_euler_in_space(theta, w1, w2, w3, offset):
    wheel = body(offset=offset)
    half = 0.5 * theta
    oracle = roll(
        Wheel(2.0, 0.05, 0.08, 0.3, offset, 9.81), [math.sin(half), 0, 0, math.cos(half)], [w1, w2, w3], [0.0]
    )
    answer = reaction(wheel, math.sin(theta), math.cos(theta), w1, w2, w3)
    scale = 2.0 * (9.81 + w1**2 + w2**2 + w3**2)
    assert np.abs(np.array(answer) - oracle.force[0]).max() < 2e-14 * scale / math.sin(theta)


@settings(deadline=None, max_examples=50)
@given(theta=tilts, w1=rates, w2=rates, w3=rates, offset=st.floats(-0.3, 0.3))
def test_the_reaction_does_no_work(theta, w1, w2, w3, offset):
    wheel = body(offset=offset)
    s, c = math.sin(theta), math.cos(theta)
    accelerations = angular_acceleration(wheel, s, c, w1, w2, w3)
    h = 1e-5

    def along(t: float) -> float:
        here = theta + w1 * t + 0.5 * accelerations[0] * t * t
        moved = [w + a * t for w, a in zip((w1, w2, w3), accelerations, strict=True)]
        return energy(wheel, math.sin(here), math.cos(here), *moved)

    assert (along(h) - along(-h)) / (2 * h) == pytest.approx(0, abs=1e-6 * (1 + w1**2 + w2**2 + w3**2) / s**3)


def test_the_coupling_solves_the_moment_equations_about_the_contact():
    wheel = body(offset=0.07)
    i1, i3, h, _ = (Fraction(x) for x in wheel.reduced)
    alpha, beta, gamma = (Fraction(x) for x in wheel.coupling)
    for w2, w3 in ((1, 0), (0, 1)):
        x, y = alpha * w3 + beta * w2, gamma * w2 - beta * w3
        assert float((i1 + h * h) * x + h * y - (i3 * w3 + h * w2)) == pytest.approx(0, abs=1e-15)
        assert float(h * x + (i3 + 1) * y - w2) == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("name", ["mass", "transverse", "axial", "radius", "gravity"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_value_that_no_body_has_is_named(name, value):
    with pytest.raises(GeometryError, match=f"the {name} of the rolling body is"):
        body(**{name: value})


def test_moments_that_break_the_triangle_rule_are_refused():
    with pytest.raises(GeometryError, match="more than twice the transverse"):
        body(axial=0.11)
    with pytest.raises(GeometryError, match="offset of the rolling body is nan"):
        body(offset=math.nan)
