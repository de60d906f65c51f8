"""§ 13.19: canonical momenta of the Euler angles, and the Andoyer–Deprit variables of a free body."""

import math

import numpy as np
import pytest
from tests.textbook.worked import free

from inertia.dynamics.kinematics import andoyer, canonical
from inertia.dynamics.kinematics.euler_angles import from_angles

ATTITUDE = from_angles([0.4, 0.9, -0.3]).tolist()


def test_the_hamiltonian_of_the_angles_is_the_energy():
    """H(φ, θ, ψ, p) = ½ Σ L²/I is the energy along a run: 18 J for moments 1, 2, 3 and ω = (1, 2, 3)."""
    run = free([1, 2, 3], [1, 2, 3], 3.0, attitude=ATTITUDE)
    result = canonical.hamiltonian([1, 2, 3], run.euler_angles(), run.canonical_momenta())
    np.testing.assert_allclose(result, 18, rtol=1e-12)


def test_cyclic_angles_keep_their_momenta():
    """φ is cyclic in any free body, ψ in a symmetric one: p_φ = L_z, p_ψ = I3 ω3 = 6 kg m²/s."""
    run = free([1, 1, 2], [1, 2, 3], 3.0, attitude=ATTITUDE)
    momenta = run.canonical_momenta()
    np.testing.assert_allclose(momenta[:, 0], run.angular_momentum[0, 2], rtol=1e-13)
    np.testing.assert_allclose(momenta[:, 2], 6, rtol=1e-13)


def test_andoyer_variables_of_a_run():
    """Moments 1, 2, 3, ω = (1, 2, 3): G = |L| = √98; G, H and h stay, and H(l, L) = 18 J has one degree of freedom."""
    run = free([1, 2, 3], [1, 2, 3], 3.0, attitude=ATTITUDE)
    variables = run.andoyer()
    np.testing.assert_allclose(variables.G, math.sqrt(98), rtol=1e-14)
    for kept in (variables.H, variables.h):
        np.testing.assert_allclose(kept, kept[0], rtol=1e-13)
    np.testing.assert_allclose(variables.L, 3 * run.angular_velocity[:, 2], rtol=1e-14)
    np.testing.assert_allclose(andoyer.hamiltonian([1, 2, 3], variables), 18, rtol=1e-13)


def test_andoyer_angles_of_a_symmetric_body_grow_evenly():
    """I1 = I2 = 1, I3 = 2, ω = (3, 0, 2): L = 4, G = 5: l̇ = L (1/I3 − 1/I1) = −2 and ġ = G/I1 = 5 rad/s."""
    run = free([1, 1, 2], [3, 0, 2], 1.0)
    variables = run.andoyer()
    assert (variables.G[0], variables.L[0]) == (pytest.approx(5), pytest.approx(4))
    for angle, rate in ((variables.l, -2), (variables.g, 5)):
        np.testing.assert_allclose(np.unwrap(angle) - angle[0], rate * run.time, atol=1e-12)


def test_back_from_andoyer_variables():
    run = free([1, 2, 3], [1, 2, 3], 3.0, attitude=ATTITUDE)
    attitude, momentum = andoyer.from_andoyer(run.andoyer())
    np.testing.assert_allclose(np.abs(np.sum(attitude * run.attitude, axis=1)), 1, rtol=1e-14)
    np.testing.assert_allclose(momentum, run.angular_velocity * [1, 2, 3], atol=1e-13)
