"""§ 13.10: three moments are all that counts: the equivalent ellipsoid, and the class of the body.

The uniform ellipsoid of semi-axes a, b, c has I1 = M (b² + c²)/5 and so on, whence a² = 5 (I2 + I3 − I1)/(2 M).
"""

import math

import numpy as np
import pytest
from tests.mass.parts import cube, surface
from tests.textbook.worked import free

import inertia
from inertia import mass_properties
from inertia_meshes import path


@pytest.mark.parametrize(
    ("sample", "kind", "tolerance"),
    [
        ("cube.stl", "spherical", 1e-6),
        ("needle.stl", "prolate", 1e-6),
        ("needle.stl", "rotor", 1e-4),
        ("disc.stl", "oblate", 1e-6),
        ("t_handle.stl", "asymmetric", 1e-6),
    ],
)
def test_classes(sample, kind, tolerance):
    assert inertia.analyse(inertia.read(path(sample)), class_tolerance=tolerance).principal.kind == kind


def test_the_equivalent_ellipsoid_has_the_same_moments():
    body = mass_properties(inertia.read(path("t_handle.stl")))
    a, b, c = body.equivalent_ellipsoid
    again = body.mass / 5 * np.array([b * b + c * c, c * c + a * a, a * a + b * b])
    np.testing.assert_allclose(again, body.principal_moments, rtol=1e-13)
    assert a > b > c


def test_radii_of_gyration():
    body = mass_properties(surface(cube(size=2)))
    np.testing.assert_allclose(body.radii_of_gyration, 2 / math.sqrt(6), rtol=1e-14)


def test_a_cube_turns_as_a_ball_does():
    """Both have three equal moments: any axis keeps the spin."""
    for moments in ([1 / 6] * 3, [2 / 5] * 3):
        run = free(moments, [1, 2, 3], 10.0)
        assert run.model == "spherical top"
        np.testing.assert_allclose(run.angular_velocity, np.broadcast_to([1, 2, 3], (101, 3)), rtol=1e-15)


def test_a_cube_about_a_point_off_its_middle_is_a_symmetric_top():
    """Steiner leaves ⅙ M l² along the line to the point and adds M a² across: prolate."""
    held = mass_properties(surface(cube(-0.5, -0.5, -0.5))).about([1.0, 1.0, 1.0])
    assert inertia.principal(held).kind == "prolate"
