"""Principal moments, axes and what follows from them: class, radii of gyration, equivalent ellipsoid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.mass.tensor import array_of
from inertia.mesh.part import Float

InertiaClass = Literal["spherical", "prolate", "oblate", "asymmetric", "rotor"]

CLASS_TOLERANCE = 1e-6
"""Moments count as equal, and the smallest as zero, within this part of the largest: float32 storage reaches it."""


@dataclass(frozen=True, eq=False)
class Principal:
    """The eigen-decomposition of an inertia tensor.

    Attributes
    ----------
    moments : (3,) kg m², ascending
    axes : (3, 3) a right-handed rotation; its columns are the axes of `moments` in part axes
    equal : the groups of moments (numbered from 0) that are equal within the tolerance: their axes are any
        orthonormal set in the subspace that the group spans
    kind : the class of the body
    tolerance : the relative tolerance that decided `equal` and `kind`
    """

    moments: Float
    axes: Float
    equal: tuple[tuple[int, ...], ...]
    kind: InertiaClass
    tolerance: float


def principal(inertia: ArrayLike, tolerance: float = CLASS_TOLERANCE) -> Principal:
    """Diagonalise an inertia tensor (3, 3) about the centre of mass.

    The axes are right-handed and their signs deterministic: the largest component of axis 1 and of axis 3 is
    positive, and axis 2 = axis 3 × axis 1. Where moments are equal within `tolerance` (of the largest), the axes of
    their subspace are chosen nearest to the part's own x, y, z. The class is ``rotor`` (I1 = 0), ``spherical``
    (I1 = I2 = I3), ``prolate`` (I2 = I3), ``oblate`` (I1 = I2) or ``asymmetric`` (textbook § 13.10).

    >>> principal(np.diag([2.0, 2.0, 1.0])).kind
    'prolate'
    """
    tensor = array_of(inertia, (3, 3), "inertia")
    size = float(np.abs(tensor).max())
    exponent = int(np.frexp(size)[1])
    moments, axes = np.linalg.eigh(np.ldexp(tensor, -exponent))
    limit = tolerance * float(moments[2])
    low, high = bool(moments[1] - moments[0] <= limit), bool(moments[2] - moments[1] <= limit)
    equal: tuple[tuple[int, ...], ...] = ()
    kind: InertiaClass = "asymmetric"
    if low and high:
        equal, kind = ((0, 1, 2),), "spherical"
    elif low:
        equal, kind = ((0, 1),), "oblate"
    elif high:
        equal, kind = ((1, 2),), "prolate"
    if kind == "prolate" and moments[0] <= limit:
        kind = "rotor"
    for group in equal:
        axes[:, list(group)] = _nearest_axes(axes[:, list(group)])
    return Principal(np.ldexp(moments, exponent), _signed(axes), equal, kind, tolerance)


def _nearest_axes(basis: Float) -> Float:
    """Return an orthonormal basis of the subspace of `basis` (3, k), built from x, y, z in that order of nearness."""
    projector = basis @ basis.T
    chosen: list[Float] = []
    for _ in range(basis.shape[1]):
        rest = projector - sum((np.outer(c, c) for c in chosen), np.zeros((3, 3)))
        # The tolerance keeps rounding from deciding between axes that are equally near.
        lengths = np.linalg.norm(rest, axis=0)
        pick = int(np.argmax(lengths >= lengths.max() * (1 - 1e-9)))
        chosen.append(rest[:, pick] / lengths[pick])
    return np.column_stack(chosen)


def _signed(axes: Float) -> Float:
    def positive(axis: Float) -> Float:
        size = np.abs(axis)
        leading = int(np.argmax(size >= size.max() * (1 - 1e-9)))
        return axis if axis[leading] > 0 else -axis

    first, third = positive(axes[:, 0]), positive(axes[:, 2])
    return np.column_stack([first, np.cross(third, first), third]) + 0.0


def radii_of_gyration(moments: ArrayLike, mass: float) -> Float:
    """Return √(I/M) for each principal moment, (3,) m."""
    return np.sqrt(np.maximum(array_of(moments, (3,), "moments"), 0.0) / mass)


def equivalent_ellipsoid(moments: ArrayLike, mass: float) -> Float:
    """Return the semi-axes (3,) m of the uniform solid ellipsoid of the same mass and moments.

    a₁² = 5 (I2 + I3 − I1) / (2 M), cyclic (textbook exercise 8), along the principal axes in their order: the
    first is the longest. A semi-axis is zero where the body is flat.
    """
    i1, i2, i3 = array_of(moments, (3,), "moments").tolist()
    squares = np.array([(i3 - i1) + i2, (i3 - i2) + i1, (i1 - i3) + i2])
    semi_axes: Float = np.sqrt(2.5 * np.maximum(squares, 0.0) / mass)
    return semi_axes
