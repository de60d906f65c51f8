"""Running error bounds of the float64 sums over few triangles, from a second evaluation that watches its roundings.

The bound of `inertia.mass.triangles.moments_from_sums` is formed from a few totals, so it takes every rounding at its
worst and every triangle to lie farthest out. Here each triangle counts with its own numbers. With every coordinate w of
a corner (or of s = a + b + c) in homogeneous form, w = (x, y, z, 0) for a, b, c and (x, y, z, 1) for s, all ten sums
are the elements of one product of matrices:

    M = Σ d w wᵀ = [[Σ d (s sᵀ + a aᵀ + b bᵀ + c cᵀ), Σ d s], [Σ d sᵀ, Σ d]].

Factors: d and w are evaluated once more, each with a bound on its error (running error analysis: N. J. Higham,
*Accuracy and Stability of Numerical Algorithms*, 2nd ed., § 3.3). A difference of coordinates is off by what Knuth's
two-sum says, which is often nothing; any other operation adds half a unit in the last place of its result, and
|x̂ ŷ − x y| ≤ (|x̂| + e_x) e_y + e_x |ŷ| is what two factors bring along. With D̂ the computed d, e its bound, and
A = |ŵ| + e_w,

    |Σ fl(D̂ ŵ) ŵᵀ − M| ≤ Σ (e + u |D̂|) A Aᵀ + Σ |D̂| (A e_wᵀ + e_w Aᵀ).

Product: the leading bits of the factors, so few that their products add up without rounding, are multiplied apart (K.
Ozaki, T. Ogita, S. Oishi, S. M. Rump, *Error-free transformations of matrix multiplication*, Numerical Algorithms 59,
2012). So the sum on the left is known far beyond float64. The error of a sum from any source, in whatever order it was
formed, is at most its distance from that one plus the bound above; all that stays a worst case is the roundings within
one triangle.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.mass.triangles.sums import Sums
from inertia.mesh.surface import Triangles

FEW = 512
"""Triangles up to which this costs no more than half of what the sums and their a-priori bound cost."""

_U = 2.0**-53
_POWER = np.uint64(0x7FF0000000000000)
_CYCLE = [0, 1, 2, 0, 1]
_NEXT, _AFTER = slice(1, 4), slice(2, 5)
_ROWS, _COLUMNS = [3, 0, 1, 2, 0, 1, 2, 1, 2, 0], [3, 3, 3, 3, 0, 1, 2, 2, 0, 1]
_TIMES = np.array([1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0])


def running_bounds(triangles: Triangles, sums: Sums) -> Float:
    """Return bounds (10,) on the errors of Σd, Σd s and Σd(…) of a solid, twice that on the diagonal.

    The frame is that of `sums`. What underflow may add is left out, as are the roundings of the bounds themselves. A
    bound is infinite or not a number where an intermediate result leaves float64.
    """
    scale = 2.0**sums.exponent
    with np.errstate(over="ignore", invalid="ignore"):
        d, d_error, w, w_error = factors(scale * triangles.corners(), scale * sums.origin)
        size, reach = abs(d), abs(w)
        reach += w_error
        high, low, bound = split_product(d * w, w, size.max() * reach.max(axis=(1, 2)), reach.max(axis=(1, 2)))
        w_error *= size
        within = _product(_flat(reach), _flat(w_error))
        bound += within + within.T
        bound += _product(_flat((d_error + _U * size) * reach), _flat(reach))
        off = abs((_TIMES * sums.sums[:10] - high[_ROWS, _COLUMNS]) - low[_ROWS, _COLUMNS])
        bounds: Float = off + bound[_ROWS, _COLUMNS]
    return bounds


def factors(corners: Float, origin: Float) -> tuple[Float, Float, Float, Float]:
    """Return d (n,) and its bound, and w (4, 4, n: coordinate, of a, b, c or s, triangle) and its bound."""
    points = np.ascontiguousarray(corners.transpose(1, 2, 0)[:, _CYCLE])
    (u, v), (u_error, v_error) = two_difference(points[1:], points[0])
    w, w_error = np.zeros((2, 4, 4, len(corners)))
    w[:3, :3], w_error[:3, :3] = two_difference(points[:, :3].transpose(1, 0, 2), origin[:, None, None])
    t = w[:3, 0] + w[:3, 1]
    w[:3, 3] = t + w[:3, 2]
    w[3, 3] = 1.0
    w_error[:3, 3] = w_error[:3, :3].sum(axis=1) + _U * (_power(t) + _power(w[:3, 3]))

    p, q = u[_NEXT] * v[_AFTER], u[_AFTER] * v[_NEXT]
    n = p - q
    u_most, v_size = abs(u) + u_error, abs(v)
    n_error = _U * (_power(p) + _power(q) + _power(n))
    n_error += u_most[_NEXT] * v_error[_AFTER] + u_error[_NEXT] * v_size[_AFTER]
    n_error += u_most[_AFTER] * v_error[_NEXT] + u_error[_AFTER] * v_size[_NEXT]

    a, a_error = w[:3, 0], w_error[:3, 0]
    x, y, z = products = a * n
    d = (x + y) + z
    d_error = ((abs(a) + a_error) * n_error + a_error * abs(n) + _U * _power(products)).sum(axis=0)
    return d, d_error + _U * (_power(x + y) + _power(d)), w, w_error


def split_product(y: Float, w: Float, y_most: Float, w_most: Float) -> tuple[Float, Float, Float]:
    """Return y wᵀ, (4, 4), as the sum of an exact high part and a low part, and a bound on the error of the latter.

    The high parts of y and w are multiples of P 2^−β, with P a power of two beyond the largest of the row (`y_most`,
    `w_most`), and what remains is at most one such unit. So the products of high parts are multiples of P P' 2^−2β,
    and as m of them are at most m 2^2β units, 2^53 or less, no partial sum is rounded. In the low part each product is
    at most P P' 2^−β, and a sum of m of them is off by m² u P P' 2^−β, to first order. There are two such sums; m + 4
    in the place of m allows for their addition, and for what is subtracted from the high part afterwards.
    """
    y, w = _flat(y), _flat(w)
    m = y.shape[1]
    bits = (53 - m.bit_length()) // 2
    y_top, w_top = (_power(most) * 2.0 ** (54 - bits) for most in (y_most, w_most))
    y_high, w_high = y + y_top[:, None], w + w_top[:, None]
    y_high -= y_top[:, None]
    w_high -= w_top[:, None]
    low = _product(y_high, w - w_high)
    low += _product(y - y_high, w)
    bound = 2.0 ** (bits + 1) * (m + 4) ** 2 * _U * np.outer(_U * y_top, _U * w_top)
    return _product(y_high, w_high), low, bound


def two_difference(x: Float, y: Float) -> tuple[Float, Float]:
    """Return x − y and what rounding took from it (D. E. Knuth, *The Art of Computer Programming 2*, § 4.2.2)."""
    difference = x - y
    t = difference - x
    error = x - (difference - t)
    t += y
    error -= t
    return difference, np.abs(error, out=error)


def _power(x: Float) -> Float:
    """Return the largest power of two that is not above |x|; a rounded result is off by at most u times that."""
    return (x.view(np.uint64) & _POWER).view(np.float64)


def _product(x: Float, y: Float) -> Float:
    """Return x yᵀ in one order of summation, which a matrix product would leave to the BLAS library."""
    product: Float = np.einsum("im,jm->ij", x, y)
    return product


def _flat(x: Float) -> Float:
    return x.reshape(4, -1)
