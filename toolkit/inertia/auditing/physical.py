"""Whether stated mass properties can belong to any body, and to one within the hull of given meshes.

Decided in rational arithmetic on the numbers as they are stated, along the axes in which the file writes them: a
tensor is that of a body exactly if ½ tr(J) δ − J, the second moments ∫ r rᵀ dm, has no negative eigenvalue (which is
the triangle rule of the principal moments).
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations

import numpy as np

from inertia.arrays import Float
from inertia.auditing.claim import Statement
from inertia.exchange.robots.links import COARSE, rounding_of, spread_along
from inertia.records import dataclass

_SLACK = 1e-9  # of the size of the hull: where the planes of a hull are rounded to
_AS_WRITTEN = " (as written; rounding to so few digits explains it)"
_SINGLE = 1e-6  # of a tensor: what figures of single precision leave open


@dataclass(frozen=True)
class Fault:
    """What no body, or none within the hull, can have: a sentence, and by how much the limit is passed (relative)."""

    sentence: str
    excess: float
    within_hull: bool = False


def margin(stated: Statement) -> float:
    """Return the margin of the triangle rule, (I1 + I2 − I3) / I3 of ascending principal moments; negative: broken.

    >>> round(margin(_statement(np.diag([1.0, 2.0, 2.5]))), 3)
    0.2
    """
    least, middle, greatest = np.linalg.eigvalsh(stated.body.inertia)
    return float((least + middle - greatest) / greatest) if greatest > 0 else -np.inf


def faults(stated: Statement) -> Iterator[Fault]:
    """Yield why no body can have the stated mass properties.

    A triangle rule that is broken by no more than rounding to the last decimal written explains is passed over, unless
    that leaves open more than 1 % of the tensor.

    >>> [fault.sentence for fault in faults(_statement(np.diag([1.0, 1.0, 3.0])))]
    ['the principal moments 1, 1, 3 break the triangle rule: the greatest is 50 % above the sum of the others']
    """
    body = stated.body
    if not body.mass > 0:
        yield Fault(f"the mass is {body.mass:.6g} kg: it must be positive", np.inf)
    written = stated.written
    if not np.isfinite(written).all():
        yield Fault("the tensor is not finite", np.inf)
        return
    moments = np.linalg.eigvalsh(written)
    names = ", ".join(f"{moment:.4g}" for moment in moments)
    if not _positive_definite(_exact(written)):
        sentence = f"the tensor is not positive definite: its principal moments are {names}"
        figures = stated.figures[1]
        if figures is not None and moments[2] > 0:
            axis = np.abs(np.linalg.eigh(written)[1][:, 0])  # of the least moment
            if moments[0] >= -float(axis @ figures.half_units(written) @ axis):
                sentence += _AS_WRITTEN
        yield Fault(sentence, 1.0)
        return
    trace = Fraction(float(np.trace(written)))
    rounding = Fraction(rounding_of(written, stated.figures[1]))
    roundoff = trace * Fraction(1, 2**50)
    if not _obeys(written, min(rounding, trace * Fraction(COARSE)) + roundoff):
        excess = float(-margin(stated) * moments[2] / (moments[0] + moments[1]))
        words = f"{100 * excess:.2g} % above" if excess < 1 else f"{1 + excess:.2g} times"
        sentence = (
            f"the principal moments {names} break the triangle rule: the greatest is {words} the sum of the others"
        )
        if _obeys(written, rounding + roundoff):
            sentence += _AS_WRITTEN
        yield Fault(sentence, excess)


def _obeys(tensor: Float, slack: Fraction) -> bool:
    """Say whether ½ tr(J) δ − J has no eigenvalue below −`slack`."""
    rows = _exact(tensor)
    half = (rows[0][0] + rows[1][1] + rows[2][2]) / 2 + slack
    return _no_negative_eigenvalue([[(half if i == j else 0) - rows[i][j] for j in range(3)] for i in range(3)])


def outside(stated: Statement, hull: Float) -> Iterator[Fault]:
    """Yield why no body within a convex hull (triangles (k, 3, 3), m, link axes) can have what is stated.

    What the last decimals that are written leave open is passed over, but for the centre no more than 1 % of the size
    of the hull, and for the tensor no more than 1 % of its trace.

    The centre of mass lies within, and along each principal axis the mean square distance from the centre is at most
    the product of the ways from the centre to the hull's two ends (Bhatia and Davis, Am. Math. Monthly 107, 2000).
    """
    body = stated.body
    size = float(np.ptp(hull, axis=(0, 1)).max())
    of_center = stated.figures[0]
    rounding = np.zeros(3) if of_center is None else of_center.half_units(body.center)
    loose = np.minimum(rounding, COARSE * size)
    normals = np.cross(hull[:, 1] - hull[:, 0], hull[:, 2] - hull[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    flat = lengths <= _SLACK * size**2
    normals = normals[~flat] / lengths[~flat, None]
    heights = np.einsum("ij,ij->i", normals, body.center - hull[~flat, 0])
    if np.any(heights - np.abs(normals) @ loose > _SLACK * size):
        away = float(heights.max())
        sentence = f"the centre of mass lies {1e3 * away:.3g} mm outside the convex hull of the meshes"
        if of_center is not None and of_center.digits and np.all(heights - np.abs(normals) @ rounding <= _SLACK * size):
            sentence += _AS_WRITTEN
        yield Fault(sentence, away / size, True)
        return
    second = (np.trace(body.inertia) / 2 * np.eye(3) - body.inertia) / body.mass
    squares, axes = np.linalg.eigh(second)
    ways = (hull.reshape(-1, 3) - body.center) @ axes
    blur = _SLACK * size + loose @ np.abs(axes)
    limits = (ways.max(axis=0) + blur) * (blur - ways.min(axis=0))
    beyond = squares - limits - _open_along(axes, stated) / body.mass
    k = int(np.argmax(beyond))
    if beyond[k] > 0:
        radius, limit = np.sqrt(squares[k]), np.sqrt(max(0.0, -ways[:, k].max() * ways[:, k].min()))
        yield Fault(
            f"the mass would lie {1e3 * radius:.3g} mm (root mean square) from its centre along one axis, where the "
            f"hull of the meshes allows {1e3 * limit:.3g} mm at most",
            float(radius / limit - 1) if limit else np.inf,
            True,
        )


def _open_along(axes: Float, stated: Statement) -> Float:
    """Return how far the second moments along principal axes, columns (3, 3), are open as they are written, kg m²."""
    figures, trace = stated.figures[1], float(np.trace(stated.body.inertia))
    if figures is None:
        return np.full(3, _SINGLE * trace)
    loose = figures.half_units(stated.written)
    rounding = [spread_along(stated.rotation.T @ axis, loose) for axis in axes.T]
    return _SINGLE * trace + np.minimum(rounding, COARSE * trace)


def _exact(matrix: Float) -> list[list[Fraction]]:
    return [[Fraction(float(value)) for value in row] for row in (matrix + matrix.T) / 2]


def _positive_definite(matrix: list[list[Fraction]]) -> bool:
    """Say whether the leading principal minors are above zero (Sylvester's criterion)."""
    return all(_determinant([row[:count] for row in matrix[:count]]) > 0 for count in (1, 2, 3))


def _no_negative_eigenvalue(matrix: list[list[Fraction]]) -> bool:
    """Say whether all principal minors are at least zero, which decides it for a symmetric matrix."""
    for count in (1, 2, 3):
        for rows in combinations(range(3), count):
            if _determinant([[matrix[i][j] for j in rows] for i in rows]) < 0:
                return False
    return True


def _determinant(matrix: list[list[Fraction]]) -> Fraction:
    if len(matrix) == 1:
        return matrix[0][0]
    return sum(
        (
            (-1) ** k * matrix[0][k] * _determinant([row[:k] + row[k + 1 :] for row in matrix[1:]])
            for k in range(len(matrix))
        ),
        Fraction(0),
    )


def _statement(inertia: Float) -> Statement:
    """Return a statement of 1 kg at the origin, for the examples."""
    from inertia.auditing.bodies import Body

    return Statement(Body(1.0, np.zeros(3), inertia), np.eye(3))
