"""How free bodies start: checked, brought to one scale, and sorted by the closed form that serves them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.dynamics.arguments import first, vectors, written
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import VALIDITY_TOLERANCE
from inertia.mesh.part import Float

NEGLIGIBLE = 1e-70
"""A component of ω counts as zero below this part of the largest: no body is steadier."""

FARTHEST = 1e20
"""Radians of rotation, to within a factor of four, that are reduced to one turn without loss."""


@dataclass(frozen=True, eq=False)
class Starts:
    """N bodies and how they start to turn.

    Attributes
    ----------
    moments : (N, 3) over a power of two, so that the largest is ½ … 1
    angular_velocity : (N, 3) over 2**exponent, so that its largest component is ½ … 1
    exponent : (N,)
    shape : of the bodies as they were given
    steady, symmetric, asymmetric : (N,) which closed form serves: ω is kept (a principal axis, a spherical top, rest),
        two moments are equal, or neither
    """

    moments: Float
    angular_velocity: Float
    exponent: NDArray[np.intc]
    shape: tuple[int, ...]
    steady: NDArray[np.bool_]
    symmetric: NDArray[np.bool_]
    asymmetric: NDArray[np.bool_]

    def scaled_time(self, time: ArrayLike) -> Float:
        """Return time (n,) or (…, n) in s as (N, n), in units of 2**−exponent s, or raise `UsageError`."""
        array = np.asarray(time, dtype=np.float64)
        if array.ndim == 0:
            raise UsageError("time is a single number: give the instants as an array (n,)")
        if not np.isfinite(array).all():
            raise UsageError(f"time{written(first(~np.isfinite(array)))} is not finite")
        try:
            array = np.broadcast_to(array, (*self.shape, array.shape[-1]))
        except ValueError:
            raise UsageError(f"time has shape {array.shape}: it must be (n,) or {self.shape} and (n,)") from None
        scaled: Float = np.ldexp(array.reshape(len(self.moments), array.shape[-1]), self.exponent[:, None])
        if (beyond := np.abs(scaled) > FARTHEST).any():
            raise UsageError(
                f"time reaches {array.reshape(scaled.shape)[first(beyond)]:.3g} s, more than {FARTHEST:.0e} rad of "
                "rotation, and the phase loses its digits: ask for a shorter time"
            )
        return scaled


def starts(moments: ArrayLike, angular_velocity: ArrayLike) -> Starts:
    """Return bodies with principal moments (…, 3) kg m², in any order, that start at angular_velocity (…, 3) rad/s.

    Scales are powers of two, so that no digit changes. A zero moment is that of a rod (textbook § 13.10: rotor), whose
    other two then count as equal: they are replaced by their mean. Raises `UsageError` where a number is not finite or
    the shapes differ, `GeometryError` where no body has these moments.
    """
    i, omega = vectors(moments, "moments"), vectors(angular_velocity, "angular_velocity")
    try:
        shape = np.broadcast_shapes(i.shape, omega.shape)
    except ValueError:
        raise UsageError(f"moments {i.shape} and angular_velocity {omega.shape} do not broadcast") from None
    _refuse_unphysical(i)
    i, omega = np.broadcast_to(i, shape).reshape(-1, 3), np.broadcast_to(omega, shape).reshape(-1, 3)
    largest = np.abs(omega).max(axis=-1, keepdims=True)
    omega = np.where(np.abs(omega) < NEGLIGIBLE * largest, 0.0, omega)
    exponent = np.frexp(largest)[1]
    omega = np.ldexp(omega, -exponent)
    i = np.ldexp(i, -np.frexp(i.max(axis=-1, keepdims=True))[1])
    i = np.where((i > 0).all(axis=-1, keepdims=True), i, _rod(i))
    a, b, c = i.T
    spherical = (a == b) & (b == c)
    steady = spherical | (np.count_nonzero(omega, axis=-1) <= 1)
    symmetric = ~steady & ((a == b) | (b == c) | (c == a))
    return Starts(i, omega, exponent[:, 0], shape[:-1], steady, symmetric, ~steady & ~symmetric)


def _rod(moments: Float) -> Float:
    across = 0.5 * moments.sum(axis=-1, keepdims=True)
    return np.where(moments > 0, across, 0.0)


def _refuse_unphysical(moments: Float) -> None:
    slack = VALIDITY_TOLERANCE * np.abs(moments).sum(axis=-1)
    largest = moments.max(axis=-1)
    for faulty, rule in (
        ((moments < 0).any(axis=-1) | (largest == 0), "none may be negative, nor all zero"),
        (largest > moments.sum(axis=-1) - largest + slack, "no body has one moment above the sum of the other two"),
    ):
        if faulty.any():
            place = first(faulty)
            raise GeometryError(f"moments{written(place)} are {moments[place].tolist()} kg m2: {rule}")
