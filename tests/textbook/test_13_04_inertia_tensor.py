"""§ 13.4: the inertia tensor of points, lines, surfaces and solids.

I = Σ m (r² δ − r rᵀ), or the same integrated over ρ dV: products of inertia stand in it with a minus sign.
"""

import math

import numpy as np
import pytest
from tests.mass.parts import cube, surface
from tests.textbook.worked import refined

from inertia import lamina, mass_properties, point_masses, wire
from inertia_meshes.shapes import revolved, sphere

TINY = 1e-14


def test_off_the_diagonal_are_negative_products_of_inertia():
    """1 kg at (1, 2, 3) m and at its mirror image: twice y² + z² = 13, z² + x² = 10, x² + y² = 5, −xy, −yz, −zx."""
    pair = point_masses([[1, 2, 3], [-1, -2, -3]], [1, 1])
    np.testing.assert_allclose(pair.inertia, 2 * np.array([[13, -2, -3], [-2, 10, -6], [-3, -6, 5]]), rtol=TINY)


def test_ball():
    """⅖ m R² about every axis."""
    mass, com, tensor = refined(lambda n: sphere(2, n))
    assert mass == pytest.approx(4 / 3 * math.pi * 8, rel=1e-8)
    np.testing.assert_allclose(com, 0, atol=1e-12)
    np.testing.assert_allclose(tensor, 0.4 * mass * 4 * np.eye(3), atol=1e-6)


def test_cylinder():
    """½ m R² about its axis, m (3R² + h²)/12 across it."""
    radius, height = 2.0, 3.0
    mass, com, tensor = refined(lambda n: revolved([(0, 0), (radius, 0), (radius, height), (0, height)], n))
    across = mass * (3 * radius**2 + height**2) / 12
    np.testing.assert_allclose(tensor, np.diag([across, across, mass * radius**2 / 2]), atol=1e-7)
    np.testing.assert_allclose(com, [0, 0, 1.5], atol=1e-12)


def test_cuboid():
    """m (b² + c²)/12 and so on: 12 kg of 1 × 2 × 3 m give 13, 10 and 5."""
    result = mass_properties(surface(cube() * [1, 2, 3]), mass=12.0)
    np.testing.assert_allclose(result.inertia, np.diag([13, 10, 5]), atol=TINY * 13)


def test_rod():
    """m l²/12 across and nothing along: 3 kg and 2 m give 1."""
    rod = wire([[0, 0, -1], [0, 0, 1]], 1.5)
    np.testing.assert_allclose(rod.inertia, np.diag([1, 1, 0]), atol=TINY)
    assert rod.principal.kind == "rotor"


def test_ring_of_wire():
    """m R² about its axis, half of that about a diameter."""
    angle = np.linspace(0, 2 * math.pi, 2001)
    ring = wire(np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]), 1.0)
    np.testing.assert_allclose(ring.inertia / ring.mass, np.diag([0.5, 0.5, 1]), atol=1e-5)


def test_rectangle():
    """m b²/12, m a²/12 and their sum: 6 kg/m² over 2 × 1 m weigh 12 kg."""
    result = lamina([[0, 0], [2, 0], [2, 1], [0, 1]], 6.0)
    np.testing.assert_allclose(result.inertia, np.diag([1, 4, 5]), atol=TINY * 5)
