"""The Appell–Korteweg constants against Legendre functions and against motions that the package did not compute."""

import mpmath
import numpy as np
import pytest
from tests.dynamics.models.rolling.rolling_oracle import Wheel, roll

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.rolling.constants import appell_korteweg
from inertia.dynamics.models.rolling.equations import RollingBody

DISC, HOOP, DRUM, SAUCER = (0.25, 0.5), (0.5, 1.0), (2.0, 0.3), (0.05, 0.1)
THETA = np.array([1e-4, 0.1, 0.9, 1.5707, 1.5709, 2.3, 3.0, 3.1415])


def legendre(body: RollingBody, theta: float, side: int = 1) -> tuple[float, float]:
    """P_ν(±cosθ), ν (ν + 1) = −αγ, and its slope in ±θ, by the hypergeometric series of mpmath."""
    with mpmath.workdps(30):
        theta = mpmath.mpf(theta) if side > 0 else mpmath.pi - mpmath.mpf(theta)
        alpha, _, gamma = body.coupling
        nu = -mpmath.mpf(1) / 2 + mpmath.sqrt(mpmath.mpc(0.25) - mpmath.mpf(alpha) * mpmath.mpf(gamma))
        half = theta / 2
        z = mpmath.sin(half) ** 2
        slope = -nu * (nu + 1) * mpmath.hyp2f1(1 - nu, nu + 2, 2, z) * mpmath.sin(half) * mpmath.cos(half)
        return float(mpmath.hyp2f1(-nu, nu + 1, 1, z).real), float(slope.real)


@pytest.mark.parametrize("moments", [DISC, HOOP, DRUM, SAUCER])
@pytest.mark.parametrize("constants", [(1.0, 0.0), (0.0, 1.0), (0.7, -1.3)])
def test_a_spin_made_of_legendre_functions_has_their_coefficients(moments, constants):
    body = RollingBody(1.0, *moments, radius=1.0)
    gamma = body.coupling[2]
    near = np.array([legendre(body, t) for t in THETA]).T
    far = np.array([legendre(body, t, -1) for t in THETA]).T
    w3 = constants[0] * near[0] + constants[1] * far[0]
    w2 = (constants[0] * near[1] - constants[1] * far[1]) / gamma
    first, second = appell_korteweg(body, THETA, w2, w3)
    assert first == pytest.approx(constants[0], abs=1e-12)
    assert second == pytest.approx(constants[1], abs=1e-12)


@pytest.mark.parametrize("offset", [0.0, 0.15, -0.4])
def test_they_stay_along_a_motion_computed_in_space(offset):
    times, attitude, spin = np.linspace(0, 1, 9), quaternion.from_rotation_vector([1.0, 0.3, -0.2]), [1.0, 3.0, -4.0]
    answer = roll(Wheel(1.0, 0.3, 0.4, 1.0, offset, 9.81), attitude, spin, times)
    axis = answer.rotation[:, :, 2]
    sine = np.hypot(axis[:, 0], axis[:, 1])
    nodes = np.stack([-axis[:, 1], axis[:, 0], np.zeros(9)], axis=-1) / sine[:, None]
    across = np.einsum("nji,nj->ni", answer.rotation, np.cross(axis, nodes))
    w2, w3 = (across * answer.angular_velocity).sum(-1), answer.angular_velocity[:, 2]
    theta = np.arctan2(sine, axis[:, 2])
    assert np.ptp(theta) > 0.1
    assert np.ptp(w3) > 0.1
    for constant in appell_korteweg(RollingBody(1.0, 0.3, 0.4, 1.0, offset, 9.81), theta, w2, w3):
        assert np.ptp(constant) < 1e-14 * np.abs([w2, w3]).max()
