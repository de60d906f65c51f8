"""Attitude under an angular momentum fixed in space, with a tensor and an internal momentum that depend on time.

    q̇ = ½ q (ω, 0),   ω = I(t)⁻¹ (qᵀ L q − h(t))

Gauss–Legendre collocation: on each step q is the polynomial that satisfies the equation at the Gauss nodes. It keeps
|q| as every Gauss method keeps quadratic invariants (Hairer, Lubich and Wanner, *Geometric Numerical Integration*,
2006, § IV.2.1), has order 2s at the ends of the steps and s + 1 in between, so that samples do not shorten the steps.
I and h depend on time alone and are worked out once for all nodes; the fixed-point iteration touches them no more.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from inertia.arrays import Float
from inertia.dynamics.computing_time import Watch
from inertia.dynamics.kinematics import quaternion
from inertia.records import dataclass

NODES = 12
_ITERATIONS = 60
_SETTLED = 8 * 2.0**-52
_TOGETHER = 512  # steps whose nodes are worked out in one call

# q ⊗ (v, 0) = G v with G = (q @ _RIGHT).reshape(4, 3); the vector part of q* ⊗ p is then Gᵀ p.
_RIGHT = quaternion.multiply(np.eye(4)[:, None], np.eye(4)[:3]).swapaxes(1, 2).reshape(4, 12)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Attitudes as piecewise polynomials: `edges` (m + 1,) s, `attitude` (m + 1, 4) there, `slopes` (m, s, 4) 1/s."""

    edges: Float
    attitude: Float
    slopes: Float

    def at(self, time: Float) -> Float:
        """Return attitudes (n, 4) at times (n,) s within the edges."""
        step = np.searchsorted(self.edges[1:-1], time, side="right")
        length = self.edges[step + 1] - self.edges[step]
        weights = integrals((time - self.edges[step]) / length)
        moved = np.einsum("n,nj,njk->nk", length, weights, self.slopes[step])
        return quaternion.normalise(self.attitude[step] + moved)


def integrals(theta: Float) -> Float:
    """Return (n, s): the integrals from 0 to θ (n,) of the Lagrange polynomials of the nodes on [0, 1].

    ℓ_j = ½ w_j Σ_m (2m + 1) P_m(x_j) P_m by discrete orthogonality, and ∫ P_m = (P_{m+1} − P_{m−1}) / (2 (2m + 1)),
    with the P_m shifted to [0, 1] and x, w the Gauss rule on [−1, 1].
    """
    x, w = leggauss(NODES)
    p = legvander(2.0 * np.asarray(theta) - 1.0, NODES)
    sums = np.concatenate([p[:, 1:2] + 1.0, p[:, 2:] - p[:, :-2]], axis=1)
    weights: Float = 0.25 * sums @ (legvander(x, NODES - 1) * w[:, None]).T
    return weights


def collocate(
    momentum: Float,
    coefficients: Callable[[Float, Float], tuple[Float, Float]],
    start: Float,
    edges: Float,
    reached: Callable[[Trajectory], None] | None = None,
) -> Trajectory:
    """Solve the equation from attitude `start` (4,) at edges[0] to edges[-1], stepping from edge to edge.

    Parameters
    ----------
    momentum : L (3,) kg m²/s, in space
    coefficients : takes the beginning of a step and the time since then, (k,) s each, to I⁻¹ (k, 3, 3) and I⁻¹ h (k, 3)
    edges : (m + 1,) s, ascending; steps much longer than 1/(|I⁻¹| |L|) may not settle
    reached : takes pieces of the trajectory as they are computed
    """
    nodes = 0.5 * (1.0 + leggauss(NODES)[0])
    inner, full = integrals(nodes), integrals(np.ones(1))[0]
    turn = quaternion.multiply([*momentum, 0.0], np.eye(4))  # row k is L ⊗ e_k, so that L ⊗ q = q @ turn
    lengths = np.diff(edges)
    slopes = np.empty((len(lengths), NODES, 4))
    attitude = np.empty((len(edges), 4))
    attitude[0] = q = start
    watch = Watch()
    for first in range(0, len(lengths), _TOGETHER):
        some = slice(first, first + _TOGETHER)
        begun, since = np.repeat(edges[:-1][some], NODES), np.multiply.outer(lengths[some], nodes).ravel()
        inverse, bias = coefficients(begun, since)
        inverse, bias = inverse.reshape(-1, NODES, 3, 3), bias.reshape(-1, NODES, 1, 3)
        for k, (length, b, c) in enumerate(zip(lengths[some], inverse, bias, strict=True), first):
            slopes[k] = _settle(q, length * inner, turn, b, c)
            q = q + length * (full @ slopes[k])
            attitude[k + 1] = q = q / np.sqrt(q @ q)
        if reached is not None:
            ends = slice(first, first + _TOGETHER + 1)
            reached(Trajectory(edges[ends], attitude[ends], slopes[some]))
        watch.require((first + _TOGETHER) / len(lengths))
    return Trajectory(edges, attitude, slopes)


def _settle(start: Float, weights: Float, turn: Float, inverse: Float, bias: Float) -> Float:
    """Return q̇ (s, 4) at the nodes of a step, by fixed-point iteration; `inverse` is symmetric."""
    q = np.tile(start, (NODES, 1))
    for _ in range(_ITERATIONS):
        g = (q @ _RIGHT).reshape(NODES, 4, 3)
        carried = (q @ turn) / np.sum(q * q, axis=1)[:, None]
        spin = (carried[:, None, :] @ g) @ inverse - bias
        slope: Float = 0.5 * (g @ np.swapaxes(spin, 1, 2))[..., 0]
        before, q = q, start + weights @ slope
        if np.abs(q - before).max() <= _SETTLED:
            break
    return slope
