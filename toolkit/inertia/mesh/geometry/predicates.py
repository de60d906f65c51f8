"""On which side of a plane is a point: the orientation determinant, exact in sign.

Floating point decides wherever its error bound allows; the few cases that remain are decided in integers. The
bound is that of J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
predicates", Discrete & Computational Geometry 18 (1997) 305, the first stage of ORIENT3D (figure 23), with a
term for underflow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float

Sign = NDArray[np.int8]

UNSURE = 2
"""What `orient3d_filter` returns where floating point does not decide."""

_EPSILON = 2.0**-53
_RELATIVE = (7 + 56 * _EPSILON) * _EPSILON  # error, over the same sum with every product taken positive
_UNDERFLOW = 2.0**-1070  # more than the products together lose when they fall below the normal numbers
_ROWS = 1 << 15  # decided in integers at a time


def orient3d(a: Float, b: Float, c: Float, d: Float) -> Sign:
    """Return the sign of (b − a) × (c − a) · (d − a), exactly.

    Parameters
    ----------
    a, b, c, d : (..., 3), finite; they are broadcast against each other

    Returns
    -------
    sign : (...) int8, +1 where d lies on the side that the normal (b − a) × (c − a) points to, −1 on the
        other side, 0 in the plane or where abc has no area

    >>> orient3d(*np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.2, 1e-300]]))
    array(1, dtype=int8)
    """
    sign = orient3d_filter(a, b, c, d)
    unsure = sign == UNSURE
    if unsure.any():
        points = [np.broadcast_to(point, (*sign.shape, 3))[unsure] for point in (a, b, c, d)]
        sign[unsure] = _in_integers(np.stack(points, axis=1))
    return sign


def orient3d_filter(a: Float, b: Float, c: Float, d: Float) -> Sign:
    """Return what `orient3d` does where floating point decides, and `UNSURE` elsewhere."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        u, v, w = (np.moveaxis(point - a, -1, 0) for point in (b, c, d))
        determinant = permanent = np.zeros(())
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            left, right = u[j] * v[k], u[k] * v[j]
            determinant = determinant + w[i] * (left - right)
            permanent = permanent + np.abs(w[i]) * (np.abs(left) + np.abs(right))
        bound = _RELATIVE * permanent + _UNDERFLOW * (1 + np.abs(w).sum(axis=0))
        sign = np.sign(determinant)
        # Comparing this way round, what has overflowed is unsure.
        decided = np.abs(determinant) > bound
    return np.where(decided, sign, UNSURE).astype(np.int8)


def _in_integers(points: Float) -> Sign:
    """Return the sign for rows of four points (n, 4, 3), scaled to integers of any length."""
    sign = np.empty(len(points), np.int8)
    for start in range(0, len(points), _ROWS):
        mantissa, exponent = np.frexp(points[start : start + _ROWS])
        least = np.where(mantissa != 0, exponent, np.iinfo(np.int32).max).min(axis=(1, 2), keepdims=True)
        shift = np.where(mantissa != 0, exponent - least, 0)
        whole = np.ldexp(mantissa, 53).astype(np.int64).astype(object) << shift.astype(object)
        u, v, w = (whole[:, 1:] - whole[:, :1]).transpose(1, 2, 0)
        determinant = sum(w[i] * (u[j] * v[k] - u[k] * v[j]) for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)))
        sign[start : start + _ROWS] = (determinant > 0).astype(np.int8) - (determinant < 0)
    return sign
