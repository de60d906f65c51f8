"""Smallest largest residual of complex equations, with a limit on the magnitude of every unknown: min-max balancing.

min maxₖ |bₖ + (A x)ₖ| with |xⱼ| ≤ cⱼ is a second-order cone program. The method follows the minimum of
τ s − Σ log(s² − |bₖ + (A x)ₖ|²) − Σ log(cⱼ² − |xⱼ|²) as τ grows; that function is self-concordant, so damped Newton
steps reach it from any start without a line search. What is reached is certified by itself: for every y with Σ|yₖ| ≤ 1,

    maxₖ |bₖ + (A x)ₖ| ≥ Re(yᴴ b) − Σ cⱼ |(Aᴴ y)ⱼ|,

and the multipliers of the barrier give such a y.

Boyd, S. and Vandenberghe, L. (2004), Convex Optimization, Cambridge, sections 5.2, 9.6 and 11.6.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex

_GAP = 1e-7  # relative, of the largest residual; rounding allows no less in every case
_NOTHING = 1e-13  # of the largest target: equations that can be met
_GROWTH = 20.0
_ROUNDS = 30
_NEWTON_STEPS = 200  # a bound: about ten are taken for each τ
_NEAR = 0.25  # Newton decrement below which whole steps are taken
_CENTRED = 1e-3


def min_max_in_discs(matrix: Complex, target: Complex, limits: Float) -> tuple[Complex, float]:
    """Return x (n,) that makes max |target + matrix x| least with |xⱼ| ≤ limits[j], and a bound below that least.

    Parameters
    ----------
    matrix : (m, n) of full column rank, m ≥ n
    target : (m,)
    limits : (n,), zero or more; infinite for none

    >>> matrix, target = np.ones((2, 1), complex), np.array([0.0, 2.0], complex)
    >>> x, least = min_max_in_discs(matrix, target, np.array([np.inf]))
    >>> x.real.round(6).tolist(), round(least, 6)
    ([-1.0], 1.0)
    """
    solution = np.zeros(len(limits), complex)
    free = limits > 0
    size = float(np.abs(target).max())
    if size == 0.0 or not free.any():
        return solution, size
    scale = np.linalg.norm(matrix[:, free], axis=0) / size
    columns, caps = matrix[:, free] / (size * scale), limits[free] * scale
    x, least = _interior_point(columns, target / size, caps)
    solution[free] = x / scale
    return solution, least * size


def _interior_point(matrix: Complex, target: Complex, limits: Float) -> tuple[Complex, float]:
    """Solve with columns of unit length and a largest target of one."""
    best = complex_of(-np.linalg.lstsq(matrix, target, rcond=None)[0], "weights")
    if (np.abs(best) <= limits).all() and _largest(matrix, target, best) <= _NOTHING:
        return best, 0.0
    x, least = np.zeros(len(limits), complex), 0.0
    best, s, tau = x, 2.0, 1.0
    for _ in range(_ROUNDS):
        x, s = _centre(matrix, target, limits, x, s, tau)
        if _largest(matrix, target, x) < _largest(matrix, target, best):
            best = x
        least = max(least, _bound(matrix, target, limits, x, s))
        if _largest(matrix, target, best) - least <= _GAP * least:
            break
        tau *= _GROWTH
    return best, min(least, _largest(matrix, target, best))


def _centre(matrix: Complex, target: Complex, limits: Float, x: Complex, s: float, tau: float) -> tuple[Complex, float]:
    """Return the minimum of the barrier for one τ, from an inner point.

    In the unknowns (Re x, Im x, s), each logarithm of s² − |r|² has the gradient
    g = (−2 Re(r̄ ∂r), 2 s)/(s² − |r|²), and adds g gᵀ + 2 diag(∂rᵀ ∂r, −1)/(s² − |r|²) to the Hessian; of a limit, s is
    constant.
    """
    planes = matrix.shape[1]
    caps = np.flatnonzero(np.isfinite(limits))
    moves = np.concatenate([matrix, np.eye(planes)[caps]])
    moves = np.concatenate([moves, 1j * moves], axis=1)  # ∂r by the real unknowns
    rises = np.concatenate([np.ones(len(matrix)), np.zeros(len(caps))])
    before = np.inf
    for _ in range(_NEWTON_STEPS):
        values = np.concatenate([target + matrix @ x, x[caps]])
        edges = np.concatenate([np.full(len(matrix), s), limits[caps]])
        inverse = 1.0 / ((edges - np.abs(values)) * (edges + np.abs(values)))
        slopes = np.column_stack([-(values.conj()[:, None] * moves).real, edges * rises]) * (2.0 * inverse)[:, None]
        gradient = -slopes.sum(axis=0)
        gradient[-1] += tau
        hessian = slopes.T @ slopes
        hessian[:-1, :-1] += 2.0 * (moves.conj().T @ (inverse[:, None] * moves)).real
        hessian[-1, -1] -= 2.0 * float(inverse @ rises)
        lengths = np.sqrt(np.diag(hessian))
        step = -np.linalg.lstsq(hessian / np.outer(lengths, lengths), gradient / lengths, rcond=None)[0] / lengths
        decrement = float(np.sqrt(max(0.0, -gradient @ step)))
        if decrement < _CENTRED or not decrement < max(before, 1.0):  # there, or no nearer for rounding
            break
        before = decrement
        if decrement > _NEAR:
            step /= 1.0 + decrement
        forward, level = x + step[:planes] + 1j * step[planes:-1], s + float(step[-1])
        if _largest(matrix, target, forward) >= level or (np.abs(forward) >= limits).any():
            break
        x, s = forward, level
    return x, s


def _bound(matrix: Complex, target: Complex, limits: Float, x: Complex, s: float) -> float:
    """Return a bound below the least, by the multipliers of the barrier: y ∝ r/(s² − |r|²), Aᴴ y = 0 without limits."""
    residual = target + matrix @ x
    multipliers = residual / ((s - np.abs(residual)) * (s + np.abs(residual)))
    multipliers /= np.abs(multipliers).sum()
    unlimited = matrix[:, ~np.isfinite(limits)]
    if unlimited.size:
        multipliers = multipliers - unlimited @ np.linalg.lstsq(unlimited, multipliers, rcond=None)[0]
        multipliers /= max(1.0, float(np.abs(multipliers).sum()))
    limited = np.isfinite(limits)
    pull = limits[limited] @ np.abs(matrix[:, limited].conj().T @ multipliers)
    return float(np.vdot(multipliers, target).real - pull)


def _largest(matrix: Complex, target: Complex, x: Complex) -> float:
    return float(np.abs(target + matrix @ x).max())
