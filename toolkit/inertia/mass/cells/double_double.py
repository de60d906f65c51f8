"""The moments of volume cells in double-double: the quadrature of `quadrature` with u = 2⁻¹⁰³ in its bounds.

The differences of stored coordinates are exact, the entries of the tables are off by a part in 2¹⁰⁶, and every
operation is off by at most u of the magnitudes that enter it: so there are fewer roundings than those bounds count.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.mass.cells.quadrature import Chunk, determinant_errors, moment_bounds, speed_errors
from inertia.mass.cells.shape_functions import Table, double_table
from inertia.mass.double_words import UNIT, Pair, folded
from inertia.mass.moments import PAIRS


def double_determinants(shape: Table, chunk: Chunk) -> tuple[Pair, Float]:
    """Return det ∂x/∂ξ at the points and corners, (r, k), and a bound on the error of each cell's, (k,)."""
    edges, _ = chunk.differences()
    _, _, slopes = double_table(chunk.kind)
    a, b, c = (_combined(slopes, edges[:, axis]) for axis in range(3))
    determinant = (
        a[0] * (b[1] * c[2] - b[2] * c[1]) + b[0] * (c[1] * a[2] - c[2] * a[1]) + c[0] * (a[1] * b[2] - a[2] * b[1])
    )
    jacobian = np.stack([a.high, b.high, c.high], axis=2)
    return determinant, determinant_errors(shape, chunk, jacobian, UNIT)


def double_wire_rows(shape: Table, chunk: Chunk) -> Float:
    """Return the moments of each straight wire, their bounds and low parts, (k, 30)."""
    edges, _ = chunk.differences()
    _, _, slopes = double_table(chunk.kind)
    x, y, z = (_combined(slopes[0], edges[:, axis]) for axis in range(3))
    speed = (x * x + y * y + z * z).root()
    return double_moment_rows(shape, chunk, speed, speed_errors(shape, chunk, speed.high, UNIT))


def double_moment_rows(shape: Table, chunk: Chunk, determinant: Pair, error: Float) -> Float:
    """Return the moments of each cell, their bounds and the moments' low parts, (k, 30).

    Parameters
    ----------
    determinant : (r, k) at the points and then the corners, or (1, k) where it is constant; positive; of a wire |dx/dξ|
    error : (k,) bound on the error of each
    """
    edges, c = chunk.differences()
    weights, values, _ = double_table(chunk.kind)
    mass = weights[:, None] * determinant[: len(shape.weights)]
    zeroth = folded(mass)
    x = [_combined(values, edges[:, axis]) for axis in range(3)]
    terms = [mass * along for along in x]
    first = [folded(term) for term in terms]
    moments = [zeroth, *(first[i] + zeroth * c[i] for i in range(3))]
    for i, j in PAIRS:
        moments.append(folded(terms[i] * x[j]) + (c[i] * first[j] + c[j] * (first[i] + zeroth * c[i])))
    bounds = moment_bounds(shape, chunk, zeroth.high, error, UNIT)
    columns = [moment.high for moment in moments], [moment.low for moment in moments]
    return np.concatenate([np.stack(columns[0], axis=1), bounds, np.stack(columns[1], axis=1)], axis=1)


def _combined(coefficients: Pair, nodes: Pair) -> Pair:
    """Return Σ cᵢ xᵢ over the nodes, (..., k), of coefficients (..., n) and nodes (n, k)."""
    terms = (coefficients[..., i, None] * nodes[i] for i in range(len(nodes.high)))
    total = next(terms)
    for term in terms:
        total = total + term
    return total
