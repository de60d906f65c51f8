"""Initial conditions of free bodies: checked, brought to one scale, and sorted by the closed form that serves them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.dynamics.arguments import at_index, first_index, vectors
from inertia.dynamics.special.elementary import Number, anywhere, columns, frexp, ldexp, maximum, packed, where
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import VALIDITY_TOLERANCE
from inertia.records import dataclass

NEGLIGIBLE = 1e-70
"""A component of ω counts as zero below this part of the largest: no body is steadier."""

Rest = tuple[Float, Float]
"""What float64 leaves out of moments and ω."""

FARTHEST = 1e20
"""Radians of rotation, to within a factor of four, that are reduced to one turn without loss."""


@dataclass(frozen=True, eq=False)
class InitialConditions:
    """N bodies and how they start to turn.

    Attributes
    ----------
    moments : (N, 3) over a power of two, so that the largest is ½ … 1
    angular_velocity : (N, 3) over 2**exponent, so that its largest component is ½ … 1
    exponent : (N,)
    shape : of the bodies as they were given
    rest : (N, 3) each, what float64 leaves out of moments and ω, over the same powers of two; None where nothing
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
    rest: Rest | None = None

    def rest_of(self, rows: NDArray[np.intp] | NDArray[np.bool_] | slice) -> Rest | None:
        """Return `rest` of some of the bodies."""
        return None if self.rest is None else (self.rest[0][rows], self.rest[1][rows])

    def scaled_time(self, time: ArrayLike) -> Float:
        """Return time (n,) or (…, n) in s as (N, n), in units of 2**−exponent s, or raise `UsageError`."""
        array = np.asarray(time, dtype=np.float64)
        if array.ndim == 0:
            raise UsageError("time is a single number: give the instants as an array (n,)")
        if not np.isfinite(array).all():
            raise UsageError(f"time{at_index(first_index(~np.isfinite(array)))} is not finite")
        if array.shape[:-1] != self.shape:
            try:
                array = np.broadcast_to(array, (*self.shape, array.shape[-1]))
            except ValueError:
                raise UsageError(f"time has shape {array.shape}: it must be (n,) or {self.shape} and (n,)") from None
        scaled: Float = np.ldexp(array.reshape(len(self.moments), array.shape[-1]), self.exponent[:, None])
        if (beyond := np.abs(scaled) > FARTHEST).any():
            farthest = array.reshape(scaled.shape)[first_index(beyond)]
            raise UsageError(
                f"time reaches {farthest:.3g} s, more than {FARTHEST:.0e} rad of rotation, and the phase loses its "
                "digits: ask for a shorter time"
            )
        return scaled


def initial_conditions(moments: ArrayLike, angular_velocity: ArrayLike, rest: Rest | None = None) -> InitialConditions:
    """Return bodies with principal moments (…, 3) kg m², in any order, that start at angular_velocity (…, 3) rad/s.

    Scales are powers of two, so that no digit changes. A zero moment is that of a rod (textbook § 13.10: rotor), whose
    other two then count as equal: they are replaced by their mean. Raises `UsageError` where a number is not finite or
    the shapes differ, `GeometryError` where no body has these moments.
    """
    i, omega = vectors(moments, "moments"), vectors(angular_velocity, "angular_velocity")
    try:
        shape = np.broadcast(i, omega).shape[:-1]
    except ValueError:
        raise UsageError(f"moments {i.shape} and angular_velocity {omega.shape} do not broadcast") from None
    a, b, c = columns(i)
    largest = maximum(maximum(a, b), c)
    _refuse_unphysical(i, (a, b, c), largest)
    size = frexp(largest)[1]
    a, b, c = (ldexp(moment, -size) for moment in (a, b, c))
    rod, across = (a == 0) | (b == 0) | (c == 0), 0.5 * (a + b + c)
    a, b, c = (where(rod, where(moment > 0, across, 0.0), moment) for moment in (a, b, c))
    x, y, z = columns(omega)
    largest = maximum(maximum(abs(x), abs(y)), abs(z))
    exponent = frexp(largest)[1]
    x, y, z = (ldexp(where(abs(w) < NEGLIGIBLE * largest, 0.0, w), -exponent) for w in (x, y, z))
    ab, bc, ca = a == b, b == c, c == a
    if rest is not None:
        p, q, r = (ldexp(low, -size) for low in columns(np.broadcast_to(rest[0], i.shape)))
        p, q, r = (where(rod, 0.0, low) for low in (p, q, r))
        ab, bc, ca = ab & (p == q), bc & (q == r), ca & (r == p)
        slow = [
            where(w == 0, 0.0, ldexp(low, -exponent))
            for w, low in zip((x, y, z), columns(np.broadcast_to(rest[1], omega.shape)), strict=True)
        ]
        rest = packed((p, q, r), shape).reshape(-1, 3), packed(tuple(slow), shape).reshape(-1, 3)
    alike = ab | bc | ca
    steady = ab & bc | (x == 0) & (y == 0) | (y == 0) & (z == 0) | (z == 0) & (x == 0)
    kinds = packed((steady, where(steady, False, alike), where(steady | alike, False, True)), shape, bool)
    steady, symmetric, asymmetric = kinds.reshape(-1, 3).T
    return InitialConditions(
        packed((a, b, c), shape).reshape(-1, 3),
        packed((x, y, z), shape).reshape(-1, 3),
        packed((exponent,), shape, np.intc).reshape(-1),
        shape,
        steady,
        symmetric,
        asymmetric,
        rest,
    )


def _refuse_unphysical(moments: Float, each: tuple[Number, ...], largest: Number) -> None:
    a, b, c = each
    others = a + b + c - largest
    slack = VALIDITY_TOLERANCE * (abs(a) + abs(b) + abs(c))
    for faulty, rule in (
        ((a < 0) | (b < 0) | (c < 0) | (largest == 0), "none may be negative, nor all zero"),
        (largest > others + slack, "no body has one moment above the sum of the other two"),
    ):
        if anywhere(faulty):
            place = first_index(np.reshape(faulty, moments.shape[:-1]))
            raise GeometryError(f"moments{at_index(place)} are {moments[place].tolist()} kg m²: {rule}")
