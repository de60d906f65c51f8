"""§ 13.8: Steiner's theorem, J = I + M (a² δ − a aᵀ)."""

import numpy as np
import pytest
from tests.mass.parts import cube, surface

from inertia import MassProperties, mass_properties, steiner

TINY = 1e-14


def test_from_the_centre_of_mass():
    body = MassProperties(2.0, 1.0, [1, 0, 0], np.diag([1.0, 2.0, 2.5]))
    a = np.array([1, 0, 0]) - [0, 2, 3]
    expected = body.inertia + 2 * (a @ a * np.eye(3) - np.outer(a, a))
    np.testing.assert_allclose(body.about([0, 2, 3]), expected, rtol=TINY)
    shifted = steiner(body.inertia, 2.0, [1, 0, 0], about=[1, 0, 0], to=[0, 2, 3])
    np.testing.assert_allclose(shifted, expected, rtol=TINY)


def test_back_to_it_and_between_any_two_points():
    body = MassProperties(3.0, 1.0, [0.1, 0.2, 0.3], np.diag([4.0, 5.0, 6.0]))
    com, p, q = body.center_of_mass, [1, 2, 3], [-1, 0.5, 2]
    np.testing.assert_allclose(steiner(body.about(p), 3.0, com, about=p, to=q), body.about(q), rtol=1e-13)
    np.testing.assert_allclose(steiner(body.about(p), 3.0, com, about=p, to=com), body.inertia, atol=1e-13)


def test_a_cube_about_its_edge():
    """⅙ M l² + ½ M l² = ⅔ M l², what exercise 13 starts from."""
    box = mass_properties(surface(cube(size=2)), mass=3.0)
    assert box.about([0, 0, 0])[2, 2] == pytest.approx(2 / 3 * 3 * 4, rel=TINY)


def test_a_cube_about_its_corner():
    """M l² (⅔ on the diagonal, −¼ off it): moments ⅙ M l² along the diagonal of the cube and 11/12 M l² across."""
    box = mass_properties(surface(cube(size=2)), mass=3.0)
    np.testing.assert_allclose(box.about([0, 0, 0]), 12 * (11 / 12 * np.eye(3) - 1 / 4), rtol=TINY)
    np.testing.assert_allclose(np.linalg.eigvalsh(box.about([0, 0, 0])), [2, 11, 11], rtol=TINY)
