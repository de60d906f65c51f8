"""Tensor algebra on plain arrays: Steiner, other frames, physical validity.

Signs, once and for all: the elements off the diagonal are *negative* products of inertia,
``inertia[0, 1] = −∫ x y dm``, and ``inertia[0, 0] = ∫ (y² + z²) dm``. Shifting changes the point the moments are
taken about; re-expressing changes the axes they are resolved along. These are two verbs, `steiner` and `reexpress`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, of_rotation, reals
from inertia.errors import UsageError
from inertia.mass.density import positive

VALIDITY_TOLERANCE = 1e-9
"""Relative slack, of the trace, within which a tensor still counts as physical."""

_MARGIN = 1e-12  # of minors of a matrix of trace ½, which rounding takes 1e-15 from
_LEAST = 1e-300


def array_of(value: ArrayLike | Sequence[Fraction], shape: tuple[int, ...], name: str) -> Float:
    """Return `value` as a finite float64 array of `shape`, or raise `UsageError` naming it."""
    try:
        array = np.array(reals(of_rotation(value, shape[-1] if shape else 0)))
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be numbers of shape {shape}") from None
    if array.shape != shape:
        raise UsageError(f"{name} must have shape {shape}, not {array.shape}")
    if not np.isfinite(array).all():
        raise UsageError(f"{name} holds a value that is not finite: {array.tolist()}")
    return array


def tensor_of(value: ArrayLike) -> Float:
    """Return `value` as a tensor (3, 3); raise `UsageError` where it is not symmetric."""
    tensor = array_of(value, (3, 3), "inertia")
    skew = np.abs(tensor / 2 - tensor.T / 2)
    if 2 * skew.max() > VALIDITY_TOLERANCE * np.abs(tensor).max():
        i, j = divmod(int(skew.argmax()), 3)
        here, there = float(tensor[i, j]), float(tensor[j, i])
        raise UsageError(
            f"inertia is not symmetric: {here!r} at [{i}][{j}] and {there!r} at [{j}][{i}] differ by "
            f"{2 * float(skew[i, j]):.2g}, the limit is {VALIDITY_TOLERANCE:g} of the largest element: give their "
            "mean, (J + J.T)/2, where rounding alone set them apart"
        )
    return tensor


def exact_point(value: ArrayLike | Sequence[Fraction], name: str) -> list[Fraction]:
    """Return a point (3,) in rationals, those that it has taken as they are; raise `UsageError` as `array_of` does."""
    array_of(value, (3,), name)
    return [k if isinstance(k, Fraction) else Fraction(float(k)) for k in np.asarray(value, dtype=object).tolist()]


def point_inertia(mass: float, offset: ArrayLike) -> Float:
    """Return the tensor of a point mass at `offset` (3,): m (r² δ − r rᵀ).

    Diagonal elements are formed as sums of squares, so that nothing cancels.
    """
    x, y, z = array_of(offset, (3,), "offset").tolist()
    return mass * np.array(
        [[y * y + z * z, -x * y, -x * z], [-x * y, x * x + z * z, -y * z], [-x * z, -y * z, x * x + y * y]]
    )


def steiner(inertia: ArrayLike, mass: float, center_of_mass: ArrayLike, *, about: ArrayLike, to: ArrayLike) -> Float:
    """Shift a tensor from one point to another (parallel-axis theorem, textbook eq. 13.8).

    J_to = J_about + M [ (b² δ − b bᵀ) − (a² δ − a aᵀ) ], with a = `about` − COM and b = `to` − COM.

    Parameters
    ----------
    inertia : (3, 3) about the point `about`, kg m²
    mass : kg, positive
    center_of_mass, about, to : (3,) m, in the tensor's axes

    Raises `UsageError` where an argument is not usable, or the tensor there leaves float64.

    >>> steiner(np.eye(3), 2.0, [0, 0, 0], about=[0, 0, 0], to=[0, 0, 3]).diagonal().tolist()
    [19.0, 19.0, 1.0]
    """
    tensor, weight = tensor_of(inertia), positive(mass, "mass", "kg")
    com = array_of(center_of_mass, (3,), "center_of_mass")
    start, end = array_of(about, (3,), "about"), array_of(to, (3,), "to")
    with np.errstate(over="ignore", invalid="ignore"):
        moved = tensor + (point_inertia(weight, end - com) - point_inertia(weight, start - com))
    if not np.isfinite(moved).all():
        raise UsageError(f"the tensor about {start.tolist()} or {end.tolist()} is above 1.8e308: name nearer points")
    return moved


def rotation_of(value: ArrayLike) -> Float:
    """Return `value` as a (3, 3) rotation; raise `UsageError` where it is not orthonormal and right-handed."""
    rotation = array_of(value, (3, 3), "rotation")
    skew = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if skew > 1e-9:
        raise UsageError(
            f"rotation is off orthonormal by {skew:.2g}, the limit is 1e-9: give more digits, or, where rounding alone "
            "took them, the nearest rotation, as Rotation.from_matrix of scipy finds it"
        )
    if np.linalg.det(rotation) < 0:
        raise UsageError("rotation is left-handed: change the sign of one of its columns")
    return rotation


def reexpress(inertia: ArrayLike, rotation: ArrayLike) -> Float:
    """Resolve a tensor along other axes: Rᵀ J R, the columns of R (3, 3) being the new axes in the old ones."""
    rotation = rotation_of(rotation)
    tensor = rotation.T @ tensor_of(inertia) @ rotation
    return 0.5 * (tensor + tensor.T)


def faults(inertia: ArrayLike, tolerance: float = VALIDITY_TOLERANCE) -> list[str]:
    """Say, in sentences, why no body of positive mass can have this tensor; an empty list when one can.

    Checked relative to the trace: symmetry, I1 ≥ 0, and the triangle rule I1 + I2 ≥ I3 (equality for a lamina;
    textbook § 13.9).

    >>> faults([[1, 0, 0], [0, 1, 0], [0, 0, 3]])
    ['the principal moments 1, 1, 3 break the triangle rule: no body has I1 + I2 < I3']
    """
    tensor = array_of(inertia, (3, 3), "inertia")
    if _plainly_physical(tensor.tolist()):
        return []
    largest = float(np.abs(tensor).max())
    if largest == 0:
        return []
    tensor = tensor / largest  # the trace of the largest tensors is no float64
    trace = abs(float(np.trace(tensor)))
    if trace == 0:
        return ["the trace is zero but the tensor is not"]
    skew = float(np.abs(tensor - tensor.T).max())
    if skew > tolerance * trace:
        return [f"the tensor is not symmetric: mirrored elements differ by {largest * skew:.3g}"]
    i1, i2, i3 = np.linalg.eigvalsh(tensor / trace).tolist()
    moments = "the principal moments " + ", ".join(f"{largest * (trace * i):.6g}" for i in (i1, i2, i3))
    if i1 < -tolerance:
        return [f"{moments} are not all positive"]
    if i1 + i2 < i3 - tolerance:
        return [f"{moments} break the triangle rule: no body has I1 + I2 < I3"]
    return []


def _plainly_physical(rows: list[list[float]]) -> bool:
    """Say whether a tensor is symmetric, and its second moments, ½ tr I δ − I, are positive far above rounding.

    They are so by Sylvester's criterion. Then each moment is positive and less than the sum of the other two.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rows
    trace = xx + yy + zz
    if not (_LEAST < trace < 1 / _LEAST and xy == yx and xz == zx and yz == zy):
        return False
    a, b, c = 0.5 - xx / trace, 0.5 - yy / trace, 0.5 - zz / trace
    d, e, f = -yz / trace, -xz / trace, -xy / trace
    minor = a * b - f * f
    return min(a, minor, minor * c - a * d * d - b * e * e + 2 * d * e * f) > _MARGIN
