"""Complex least squares with a limit on the magnitude of every unknown, by an interior-point method.

min |b + A x|² with |xⱼ| ≤ cⱼ is convex. The method follows the minimum of t |b + A x|² − Σ log(cⱼ² − |xⱼ|²) as t grows:
there, |b + A x|² is above the least by no more than (number of limits)/t. That function is self-concordant, so damped
Newton steps reach it from any start without a line search.

Boyd, S. and Vandenberghe, L. (2004), Convex Optimization, Cambridge, sections 9.6 and 11.3.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex

_GAP = 1e-13  # of |b|²
_GROWTH = 20.0
_NEWTON_STEPS = 200  # a bound: about ten are taken for each t
_CENTRED = 1e-6  # Newton decrement


def least_squares_in_discs(matrix: Complex, target: Complex, limits: Float) -> Complex:
    """Return x (n,) that makes |target + matrix x|² least with |xⱼ| ≤ limits[j].

    Parameters
    ----------
    matrix : (m, n) of full column rank, m ≥ n
    target : (m,)
    limits : (n,), zero or more; infinite for none
    """
    best = complex_of(-np.linalg.lstsq(matrix, target, rcond=None)[0], "weights")
    if (np.abs(best) <= limits).all():
        return best
    solution = np.zeros_like(best)
    free = limits > 0
    size = float(np.linalg.norm(target))
    scale = np.linalg.norm(matrix[:, free], axis=0) / size
    solution[free] = _interior_point(matrix[:, free] / (size * scale), target / size, limits[free] * scale) / scale
    return solution


def _interior_point(matrix: Complex, target: Complex, limits: Float) -> Complex:
    """Solve with columns, and a target, of unit length."""
    count = len(limits)
    real = np.block([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]])
    curve = 2.0 * real.T @ real
    slope = 2.0 * real.T @ np.concatenate([target.real, target.imag])
    square = limits**2
    x = np.zeros(2 * count)
    t = 1.0
    while True:
        for _ in range(_NEWTON_STEPS):
            room = square - x[:count] ** 2 - x[count:] ** 2
            inverse = np.tile(1.0 / room, 2)
            gradient = t * (curve @ x + slope) + 2.0 * inverse * x
            hessian = t * curve + np.diag(2.0 * inverse)
            toward = np.zeros((2 * count, count))
            toward[np.arange(2 * count), np.tile(np.arange(count), 2)] = 2.0 * inverse * x
            step = -np.linalg.solve(hessian + toward @ toward.T, gradient)
            decrement = float(np.sqrt(max(0.0, -gradient @ step)))
            x = x + step / (1.0 + decrement if decrement > 0.25 else 1.0)
            if decrement < _CENTRED:
                break
        if count <= _GAP * t:
            return x[:count] + 1j * x[count:]
        t *= _GROWTH
