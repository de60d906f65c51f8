"""Principal moments, axes and what follows from them: class and radii of gyration."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.errors import UNIT, GeometryError, UsageError
from inertia.estimate import is_number
from inertia.mass.eigen import Spectrum, spectrum
from inertia.mass.moments import Moments
from inertia.mass.tensor import array_of, tensor_of
from inertia.records import dataclass

InertiaClass = Literal["spherical", "prolate", "oblate", "asymmetric", "rotor"]

CLASS_TOLERANCE = 1e-6
"""Moments count as equal, and the smallest as zero, within this part of the largest: float32 storage reaches it."""

_AXIS_ROUNDING = 2.0**-50  # of three components, and of the product that makes axis 2


@dataclass(frozen=True, eq=False)
class Principal:
    """The eigen-decomposition of an inertia tensor.

    Attributes
    ----------
    moments : (3,) kg m², ascending
    axes : (3, 3) a right-handed rotation; its columns are the axes of `moments` in part axes
    equal : the groups of moments (numbered from 0) that are equal within the tolerance and their bounds: their axes
        are any orthonormal set in the subspace that the group spans
    kind : the class of the body
    tolerance : the relative tolerance that decided `equal` and `kind`
    moment_bounds : (3,) kg m², how far each moment may be from the true one
    axis_bounds : (3,) rad, the angle by which each axis may be off, either way round; π/2 for an axis of `equal`
        moments, whose subspace is off by no more than the axis at right angles to it
    second_moments : (3,) kg m², ∫x² dm along each axis: half the sum of the moments less the axis' own
    """

    moments: Float
    axes: Float
    equal: tuple[tuple[int, ...], ...]
    kind: InertiaClass
    tolerance: float
    moment_bounds: Float
    axis_bounds: Float
    second_moments: Float

    def __post_init__(self) -> None:
        for each in (self.moments, self.axes, self.moment_bounds, self.axis_bounds, self.second_moments):
            each.setflags(write=False)

    def _repr_html_(self) -> str:
        """Return a small table and a sketch of the axes, as a notebook shows them."""
        from inertia.notebook import ellipsoid_svg, html_of

        rows: list[tuple[str, str]] = [("Body", self.kind)]
        for k, moment in enumerate(self.moments.tolist()):
            axis = ", ".join(f"{each:.6g}" for each in self.axes[:, k])
            rows.append((f"Axis {k + 1}", f"{moment:.10g} kg m² about ({axis})"))
        for group in self.equal:
            rows.append(("Equal", f"moments {', '.join(str(k + 1) for k in group)}: their axes may lie anywhere"))
        return html_of(rows, ellipsoid_svg(np.sqrt(np.maximum(self.second_moments, 0.0)), self.axes))


def principal(inertia: ArrayLike, tolerance: float = CLASS_TOLERANCE, bound: float | Fraction = 0) -> Principal:
    """Diagonalise an inertia tensor (3, 3) kg m² about the centre of mass, known to within `bound` kg m².

    `bound` is on the Frobenius norm of the tensor's error; what the moments and axes may be off by follows from it and
    from the residual of the decomposition (see `inertia.mass.eigen`). The axes are right-handed and their signs
    deterministic: the largest component of axis 1 and of axis 3 is positive, and axis 2 = axis 3 × axis 1. Where
    moments are equal, to within `tolerance` of the largest and their bounds, the axes of their subspace are chosen
    nearest to the part's own x, y, z. A moment that is negative by no more than its bound is 0. The class is ``rotor``
    (I1 = 0), ``spherical`` (I1 = I2 = I3), ``prolate`` (I2 = I3), ``oblate`` (I1 = I2) or ``asymmetric`` (textbook
    § 13.10).

    Raises `UsageError` where the tensor is not symmetric, it or the bound not finite, or the tolerance none,
    `GeometryError` where a moment leaves float64.

    >>> principal(np.diag([2.0, 2.0, 1.0])).kind
    'prolate'
    >>> principal(np.diag([1.0, 2.0, 3.0]), bound=0.01).axis_bounds.round(3).tolist()
    [0.01, 0.01, 0.01]
    """
    return principal_of(spectrum_of_tensor(inertia, bound), tolerance)


def spectrum_of_tensor(inertia: ArrayLike, bound: float | Fraction) -> Spectrum:
    """Return the eigenvalues and eigenvectors of a tensor (3, 3) kg m², known to within `bound`; see `principal`."""
    rows = [[Fraction(k) for k in row] for row in tensor_of(inertia).tolist()]
    if not (is_number(bound) and 0 <= bound < math.inf):
        raise UsageError(f"bound is {bound!r} kg m²: it must be finite and not negative")
    tensor = [[(rows[i][j] + rows[j][i]) / 2 for j in range(3)] for i in range(3)]
    return spectrum(tensor, [[Fraction(bound)] * 3] * 3, Fraction(bound))


def spectrum_of_moments(central: Moments) -> Spectrum:
    """Return the spectrum of the tensor of exact central second moments of mass: no element is rounded on the way.

    Each second moment has a bound of its own, so that the errors across a needle count as small as they are.
    """
    return spectrum(central.tensor, central.tensor_bounds, central.error_norms[1])


def principal_of(eigen: Spectrum, tolerance: float = CLASS_TOLERANCE) -> Principal:
    """Return what `principal` does, from the spectrum of a tensor."""
    require_tolerance(tolerance)
    bounds, n, d = eigen.bounds, eigen.unit.numerator, eigen.unit.denominator
    # No body has a negative moment: what may be 0 for all that is known is 0, and the bound holds for that too.
    values = [0 if -bound <= value < 0 else value for value, bound in zip(eigen.multiples, bounds, strict=True)]
    share, whole = tolerance.as_integer_ratio()
    limit = share * max(map(abs, values)) // whole
    low, high = (values[k + 1] - values[k] <= limit + bounds[k + 1] + bounds[k] for k in range(2))
    equal: tuple[tuple[int, ...], ...] = ()
    kind: InertiaClass = "asymmetric"
    if low and high:
        equal, kind = ((0, 1, 2),), "spherical"
    elif low:
        equal, kind = ((0, 1),), "oblate"
    elif high:
        equal, kind = ((1, 2),), "prolate"
    if kind == "prolate" and abs(values[0]) <= limit + bounds[0]:
        kind = "rotor"
    axes = eigen.vectors.copy()
    angles = np.array([min(math.asin(min(_above(*k), 1.0)) + _AXIS_ROUNDING, 0.5 * math.pi) for k in eigen.ratios])
    for group in equal:
        axes[:, group] = _nearest_axes(axes[:, group])
        angles[list(group)] = 0.5 * math.pi
    moments = [_rounded(n * value, d) for value in values]
    second = np.array([_rounded(n * max(sum(values) - 2 * value, 0), 2 * d) for value in values])
    errors = []
    for moment, value, bound in zip(moments, values, bounds, strict=True):
        p, q = moment.as_integer_ratio()
        errors.append(_above(abs(p * d - n * value * q) + n * bound * q, q * d))
    return Principal(np.array(moments), _signed(axes), equal, kind, tolerance, np.array(errors), angles, second)


def require_tolerance(tolerance: float) -> None:
    """Raise `UsageError` where moments cannot count as equal within this part of the largest."""
    if not (is_number(tolerance) and 0 <= tolerance < 1):
        raise UsageError(f"the class tolerance is {tolerance!r}: it must be at least 0 and below 1")


def _rounded(n: int, d: int) -> float:
    """Return n/d, kg m², rounded."""
    try:
        return n / d
    except OverflowError:
        raise GeometryError(
            "a principal moment is above 1.8e308 kg m² and leaves float64: give the coordinates in a smaller unit "
            "with ",
            UNIT,
        ) from None


def _above(n: int, d: int) -> float:
    """Return the bound n/d rounded up."""
    try:
        return math.nextafter(n / d, math.inf) if n else 0.0
    except OverflowError:
        return math.inf


def _nearest_axes(basis: Float) -> Float:
    """Return an orthonormal basis of the subspace of `basis` (3, k), built from x, y, z in that order of nearness."""
    projector = np.einsum("ik,jk->ij", basis, basis)
    axes: list[Float] = []
    for _ in range(basis.shape[1]):
        rest = projector - sum((np.outer(c, c) for c in axes), np.zeros((3, 3)))
        # The tolerance keeps rounding from deciding between axes that are equally near.
        lengths = np.linalg.norm(rest, axis=0)
        pick = int(np.argmax(lengths >= lengths.max() * (1 - 1e-9)))
        axes.append(rest[:, pick] / lengths[pick])
    return np.column_stack(axes)


def _signed(axes: Float) -> Float:
    def positive(axis: list[float]) -> list[float]:
        limit = max(map(abs, axis)) * (1 - 1e-9)
        return axis if next(k for k in axis if abs(k) >= limit) > 0 else [-k for k in axis]

    (a, b, c), (x, y, z) = (positive(axis) for axis in (axes[:, 0].tolist(), axes[:, 2].tolist()))
    return np.array([[a, y * c - z * b, x], [b, z * a - x * c, y], [c, x * b - y * a, z]]) + 0.0


def radii_of_gyration(moments: ArrayLike, mass: float) -> Float:
    """Return √(I/M) for each principal moment, (3,) m."""
    return np.sqrt(np.maximum(array_of(moments, (3,), "moments"), 0.0) / mass)
