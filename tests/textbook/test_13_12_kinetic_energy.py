"""§ 13.12: T = ½ M V² + M V·(ω × R) + ½ ω·J ω about any point of the body; the cross term goes with the centre of mass.

The case: three masses 1, 2, 3 kg at (1, 0, 0), (0, 1, 0), (0, 0, 1) m, ω = (1, 2, 3) rad/s, the origin at (4, 5, 6)
m/s. Their velocities V + ω × r are V + (0, 3, −2), (−3, 0, 1) and (2, −1, 0), so that
T = ½ [(16 + 64 + 16) + 2 (1 + 25 + 49) + 3 (36 + 16 + 36)] = 255 J.
"""

import numpy as np
import pytest
from tests.textbook.worked import follow

from inertia import point_masses
from inertia.dynamics.kinematics.canonical import kinetic_energy

BODY = point_masses(np.eye(3), [1, 2, 3])
SPIN, SPEED = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
TOTAL = 255.0


def test_about_a_point_that_is_no_centre_of_mass():
    """½·6·77 = 231; R = (1, 2, 3)/6 is along ω: V·(ω × R) = 0 here, and the rotation has 24."""
    energy = kinetic_energy(BODY.about([0, 0, 0]), 6.0, BODY.center_of_mass, SPEED, SPIN)
    assert (energy.translation, energy.rotation) == (231, pytest.approx(24))
    assert energy.total == pytest.approx(TOTAL)


@pytest.mark.parametrize("point", [[1, 0, 0], [0, 1, 0], [0.3, -2, 5]])
def test_about_any_point(point):
    """The point moves with V + ω × r, and the cross term makes up for the rest."""
    lever, speed = BODY.center_of_mass - point, SPEED + np.cross(SPIN, point)
    energy = kinetic_energy(BODY.about(point), 6.0, lever, speed, SPIN)
    assert energy.total == pytest.approx(TOTAL)
    assert abs(energy.cross) > 1


def test_about_the_centre_of_mass_it_separates():
    speed = SPEED + np.cross(SPIN, BODY.center_of_mass)
    energy = kinetic_energy(BODY.inertia, 6.0, [0, 0, 0], speed, SPIN)
    assert energy.cross == 0
    assert energy.total == pytest.approx(TOTAL)


def test_half_of_the_product_of_both_vectors():
    """T = ½ ω·L along a run: ½ (1·1 + 2·4 + 3·9) = 18 J for moments 1, 2, 3."""
    run = follow({"principal_moments": [1, 2, 3]}, SPIN, 10.0, attitude=[0.5, 0.5, 0.5, 0.5])
    np.testing.assert_allclose(run.energy, 18, rtol=1e-14)
    np.testing.assert_allclose(0.5 * np.sum(run.angular_velocity**2 * [1, 2, 3], axis=1), 18, rtol=1e-14)
