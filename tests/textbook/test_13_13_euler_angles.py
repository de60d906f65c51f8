"""§ 13.13: Euler angles, λ = λψ λθ λφ, which takes space components to body components."""

import math

import numpy as np
import pytest

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import direction_cosines, from_angles, to_angles


def test_the_matrix_of_the_chapter():
    """At φ = 30°, θ = 60°, ψ = 90° the nine elements of eq. 13.81 are quarters and halves of 1 and √3.

    Row 1: (−sinφ cosθ, cosφ cosθ, sinθ) = (−¼, √3/4, √3/2); row 2: (−cosφ, −sinφ, 0) = (−√3/2, −½, 0);
    row 3: (sinφ sinθ, −cosφ sinθ, cosθ) = (√3/4, −¾, ½).
    """
    root = math.sqrt(3)
    expected = [[-1 / 4, root / 4, root / 2], [-root / 2, -1 / 2, 0], [root / 4, -3 / 4, 1 / 2]]
    result = direction_cosines(np.radians([30, 60, 90]))
    np.testing.assert_allclose(result, expected, atol=1e-15)
    np.testing.assert_allclose(result @ result.T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("convention", ["z-x-z", "z-y-z", "x-y-z"])
def test_three_turns_one_after_the_other(convention):
    """Body to space is the product of the turns about the axes that the convention names, the first outermost."""
    angles = [0.4, 1.1, -2.0]

    def turn(axis, angle):
        c, s = math.cos(angle), math.sin(angle)
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = c
        matrix[i, j], matrix[j, i] = -s, s
        return matrix

    first, second, third = (turn(axis, angle) for axis, angle in zip(convention.split("-"), angles, strict=True))
    attitude = from_angles(angles, convention)
    np.testing.assert_allclose(quaternion.matrix(attitude), first @ second @ third, atol=1e-15)
    np.testing.assert_allclose(to_angles(attitude, convention), angles, atol=1e-15)


def test_the_line_of_nodes_is_across_both_axes():
    """n ∝ z × e₃, at the angle φ from x: e₃ is (sinφ sinθ, −cosφ sinθ, cosθ) in space."""
    axis = quaternion.to_space(from_angles([0.7, 0.9, 2.0]), [0, 0, 1])
    node = np.cross([0, 0, 1], axis)
    assert math.atan2(node[1], node[0]) == pytest.approx(0.7, abs=1e-15)
