"""§ 13.6 and 13.7: the principal axes, found by diagonalising the tensor.

det(I − I_k δ) = 0 gives the moments, (I − I_k δ)·ω = 0 the axes, which are at right angles where moments differ
(§ 13.10).
"""

import math

import numpy as np

from inertia import principal


def test_a_tensor_by_hand():
    """[[3, −1, 0], [−1, 3, 0], [0, 0, 5]]: (3 − I)² = 1 gives 2 along (1, 1, 0)/√2 and 4 along (1, −1, 0)/√2; and 5."""
    result = principal([[3, -1, 0], [-1, 3, 0], [0, 0, 5]])
    half = math.sqrt(0.5)
    np.testing.assert_allclose(result.moments, [2, 4, 5], rtol=1e-15)
    np.testing.assert_allclose(result.axes, [[half, -half, 0], [half, half, 0], [0, 0, 1]], atol=1e-15)


def test_a_secular_equation_of_degree_three():
    """[[2, 1, 0], [1, 3, 1], [0, 1, 4]]: (3 − I)[(2 − I)(4 − I) − 2] = 0 gives 3 − √3, 3 and 3 + √3.

    For I = 3: −ω1 + ω2 = 0, ω1 + ω3 = 0: the axis is along (1, 1, −1).
    """
    result = principal([[2, 1, 0], [1, 3, 1], [0, 1, 4]])
    np.testing.assert_allclose(result.moments, [3 - math.sqrt(3), 3, 3 + math.sqrt(3)], rtol=1e-15)
    np.testing.assert_allclose(np.abs(result.axes[:, 1] @ [1, 1, -1]), math.sqrt(3), rtol=1e-15)
    np.testing.assert_allclose(result.axes.T @ result.axes, np.eye(3), atol=1e-15)
    assert np.linalg.det(result.axes) > 0


def test_axes_of_equal_moments_are_named_as_free():
    """diag(1, 2, 2) in any frame: the plane of the equal moments is a property of the body, axes in it are not."""
    n = np.array([1.0, 2.0, 2.0]) / 3
    result = principal(2 * np.eye(3) - np.outer(n, n))
    np.testing.assert_allclose(result.axes[:, 0], n, atol=1e-15)
    assert result.equal == ((1, 2),)
