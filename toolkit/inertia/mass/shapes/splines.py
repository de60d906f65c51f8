"""B-splines of one or two parameters, with derivatives: the recurrence of Cox and de Boor over arrays.

Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., Springer 1997, eqs 2.5, 2.7 (basis functions and their
derivatives), 4.8, 4.20 (derivatives of rational curves and surfaces).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import GeometryError
from inertia.mesh.shape import Spline

_CLOSED = 1e-9  # of its size, that the ends of a closed spline may be apart
_OUTSIDE = 1e-6  # of its range, that a parameter may be outside

# The derivatives that a jet of each order holds, by u and by v.
SURFACE_JETS = (((0, 0),), ((0, 0), (1, 0), (0, 1)), ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))


def require_spline(spline: Spline) -> None:
    """Refuse a spline whose arrays do not fit together, or hold what is no number."""
    weights = spline.weights
    arrays = (*spline.knots, spline.poles, *(() if weights is None else (weights,)))
    if not all(np.isfinite(array).all() for array in arrays):
        raise GeometryError("its spline holds a number that is not finite", code="non_finite")
    for axis, (degree, knots) in enumerate(zip(spline.degrees, spline.knots, strict=True)):
        count = spline.poles.shape[axis]
        if degree < 1 or count <= degree or len(knots) != count + degree + 1 or (np.diff(knots) < 0).any():
            raise GeometryError(
                f"its spline of degree {degree} has {count} poles and {len(knots)} knots, which is none"
            )
        inner = knots[degree : count + 1]
        if not (inner[-1] > inner[0] and (knots[degree + 1 : -1] > knots[1 : -degree - 1]).all()):
            raise GeometryError("its spline has a knot of a multiplicity above its degree")
    if weights is not None and (weights.shape != spline.poles.shape[:-1] or not (weights > 0).all()):
        raise GeometryError("its spline has weights that are not positive")


def domain(spline: Spline, axis: int) -> tuple[float, float]:
    """Return the range of a parameter."""
    degree, knots = spline.degrees[axis], spline.knots[axis]
    return float(knots[degree]), float(knots[-degree - 1])


def is_closed(spline: Spline, axis: int) -> bool:
    """Whether the spline ends where it starts, in the direction of a parameter (its knots being clamped)."""
    poles = np.moveaxis(spline.poles, axis, 0)
    size = float(np.ptp(spline.poles.reshape(-1, spline.poles.shape[-1]), axis=0).max())
    return bool(np.abs(poles[0] - poles[-1]).max() <= _CLOSED * size)


def breaks(spline: Spline, axis: int, low: float, high: float) -> Float:
    """Return the knots strictly between two parameters, again in each period where the spline is closed."""
    start, stop = domain(spline, axis)
    knots = np.unique(spline.knots[axis])
    knots = knots[(knots >= start) & (knots <= stop)]
    if (low < start or high > stop) and is_closed(spline, axis):
        period = stop - start
        turns = np.arange(np.floor((low - start) / period), np.ceil((high - start) / period))
        knots = np.unique((knots[None] + period * turns[:, None]).ravel())
    inside: Float = knots[(knots > low) & (knots < high)]
    return inside


def _inside(spline: Spline, axis: int, t: Float) -> Float:
    """Return parameters within the range: in a closed spline those of the same points."""
    start, stop = domain(spline, axis)
    span = stop - start
    if t.size and (t.min() < start - _OUTSIDE * span or t.max() > stop + _OUTSIDE * span):
        if not is_closed(spline, axis):
            raise GeometryError("a trimming curve leaves its surface")
        return np.where((t < start) | (t > stop), start + np.mod(t - start, span), t)
    return t


def _basis(degree: int, knots: Float, t: Float, order: int) -> tuple[Int, Float]:
    """Return the number of the first basis function at each t (n,), and the values there (order + 1, n, degree + 1)."""
    span = np.clip(np.searchsorted(knots, t, side="right") - 1, degree, len(knots) - degree - 2)
    tables = [np.ones((len(t), 1))]
    for d in range(1, degree + 1):
        tables.append(_raised(tables[-1], d, knots, span, t))
    values = np.zeros((order + 1, len(t), degree + 1))
    for k in range(min(order, degree) + 1):
        table = tables[degree - k]
        for d in range(degree - k + 1, degree + 1):
            table = _raised(table, d, knots, span, None)
        values[k] = table
    return span - degree, values


def _raised(table: Float, d: int, knots: Float, span: Int, t: Float | None) -> Float:
    """Return functions of degree d from those of degree d − 1; their derivatives, where t is None."""
    values = np.zeros((len(span), d + 1))
    for j in range(d):
        left, right = knots[span - d + 1 + j], knots[span + 1 + j]
        term = table[:, j] / (right - left)
        values[:, j] += -d * term if t is None else (right - t) * term
        values[:, j + 1] += d * term if t is None else (t - left) * term
    return values


def _homogeneous(spline: Spline) -> Float:
    if spline.weights is None:
        return spline.poles
    w = spline.weights[..., None]
    return np.concatenate([spline.poles * w, w], axis=-1)


def curve_jets(spline: Spline, t: Float, order: int) -> Float:
    """Return points and derivatives (order + 1, n, d) of a curve at the parameters t (n,), up to the second."""
    first, values = _basis(spline.degrees[0], spline.knots[0], _inside(spline, 0, t), order)
    poles = _homogeneous(spline)[first[:, None] + np.arange(spline.degrees[0] + 1)]
    jets: Float = np.einsum("knj,njd->knd", values, poles)
    if spline.weights is None:
        return jets
    a, w = jets[..., :-1], jets[..., -1:]
    result = a / w[:1]
    if order > 0:
        result[1] = (a[1] - w[1] * result[0]) / w[0]
    if order > 1:
        result[2] = (a[2] - 2 * w[1] * result[1] - w[2] * result[0]) / w[0]
    return result


def surface_jets(spline: Spline, u: Float, v: Float, order: int) -> Float:
    """Return points and derivatives of a surface at (u, v) (n,), in the order of `SURFACE_JETS` (k, n, 3)."""
    (p, q), jets = spline.degrees, SURFACE_JETS[order]
    iu, along_u = _basis(p, spline.knots[0], _inside(spline, 0, u), order)
    iv, along_v = _basis(q, spline.knots[1], _inside(spline, 1, v), order)
    net = _homogeneous(spline)
    wide = net.shape[-1]
    poles = net[(iu[:, None] + np.arange(p + 1))[:, :, None], (iv[:, None] + np.arange(q + 1))[:, None]]
    rows = np.matmul(along_u.transpose(1, 0, 2), poles.reshape(len(u), p + 1, (q + 1) * wide))
    rows = rows.reshape(len(u), order + 1, q + 1, wide)
    values = np.matmul(along_v.transpose(1, 0, 2)[:, None], rows)  # (n, order by u, order by v, wide)
    result = np.stack([values[:, i, j] for i, j in jets])
    if spline.weights is None:
        return result
    return _divided(result[..., :3], result[..., 3:], jets)


def _divided(a: Float, w: Float, jets: Sequence[tuple[int, int]]) -> Float:
    x = a / w[:1]
    if len(jets) > 1:
        for k in (1, 2):
            x[k] = (a[k] - w[k] * x[0]) / w[0]
    if len(jets) > 3:
        for k, (i, j) in ((3, (1, 1)), (4, (1, 2)), (5, (2, 2))):
            x[k] = (a[k] - w[i] * x[j] - w[j] * x[i] - w[k] * x[0]) / w[0]
    return x
