"""Stability of free rotation about the principal axes, and the distance from the separatrix (textbook § 13.21–22).

Principal moments (…, 3) kg m² may come in any order; results that belong to an axis come in the same order.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float, reals
from inertia.dynamics.arguments import at_index, first_index, moments_of, scaled, vectors
from inertia.dynamics.special import double_double
from inertia.errors import GeometryError, UsageError
from inertia.mass.principal import CLASS_TOLERANCE, require_tolerance


def wobble_frequencies(moments: ArrayLike, speed: ArrayLike = 1.0) -> Float:
    """Return (…, 3) rad/s: how fast a small wobble goes round each principal axis of a body that spins about it.

    Ω1 = ω √((I1 − I2)(I1 − I3)/(I2 I3)), cyclic (textbook eq. 13.171–173), as seen from the body; 0 where no wobble is
    bound to the axis: about the intermediate one, see `growth_rate`, and about one of two equal moments.

    Parameters
    ----------
    moments : (…, 3) kg m²
    speed : (…) rad/s, of the spin

    >>> wobble_frequencies([1, 2, 3], 10.0).round(6).tolist()
    [5.773503, 0.0, 10.0]
    """
    frequencies: Float = np.sqrt(np.maximum(_squared_rates(moments), 0.0)) * _speed(speed)[..., None]
    return frequencies


def growth_rate(moments: ArrayLike, speed: ArrayLike = 1.0) -> Float:
    """Return (…) 1/s: a small wobble about the intermediate axis grows as exp(rate t) at first.

    rate = ω √((I2 − I1)(I3 − I2)/(I1 I3)) for I1 ≤ I2 ≤ I3 (textbook § 13.22); 0 where two moments are equal.

    >>> growth_rate([1, 2, 3], 10.0).round(6).item()
    5.773503
    """
    rate: Float = np.sqrt(np.max(np.maximum(-_squared_rates(moments), 0.0), axis=-1)) * _speed(speed)
    return rate


def stable_axes(
    moments: ArrayLike, *, dissipation: bool = False, tolerance: float = CLASS_TOLERANCE
) -> NDArray[np.bool_]:
    """Flag (…, 3) the principal axes about which rotation is stable.

    Without dissipation those of the largest and of the smallest moment; with it, where energy falls and L is kept, that
    of the largest alone. Of moments equal to within `tolerance` of the largest none is stable, for the spin drifts
    among their axes; with all three equal every axis is, dissipation or not, for L and ω are parallel.

    >>> stable_axes([1, 2, 3]).tolist(), stable_axes([1, 2, 3], dissipation=True).tolist()
    ([True, False, True], [False, False, True])
    """
    require_tolerance(tolerance)
    moments = moments_of(moments, rotor=True)
    others = _others(moments)
    slack = tolerance * np.max(moments, axis=-1)[..., None, None]
    above = (moments[..., None] - others > slack).all(axis=-1)
    below = (others - moments[..., None] > slack).all(axis=-1)
    spherical = (np.ptp(moments, axis=-1) <= slack[..., 0, 0])[..., None]
    flags: NDArray[np.bool_] = (above | spherical) if dissipation else (above | below | spherical)
    return flags


def energy_bounds(moments: ArrayLike, momentum: ArrayLike) -> tuple[Float, Float]:
    """Return the least and the greatest kinetic energy (…) in J at |L| = `momentum` (…) kg m²/s.

    L²/2I3 ≤ T ≤ L²/2I1 (textbook eq. 13.162); dissipation ends at the least, about the axis of the largest moment.

    Raises `UsageError` where the momentum is negative or not finite.

    >>> [bound.item() for bound in energy_bounds([1, 2, 4], 4.0)]
    [2.0, 8.0]
    """
    moments, size = moments_of(moments), _finite(momentum, "momentum")
    if (size < 0).any():
        raise UsageError(f"momentum is {size[size < 0].flat[0]:g} kg m²/s: it is a size, |L|, and not negative")
    half = 0.5 * size * size
    return half / np.max(moments, axis=-1), half / np.min(moments, axis=-1)


def separatrix_distance(moments: ArrayLike, angular_velocity: ArrayLike) -> Float:
    """Return (2 T I2 − L²)/L² (…): zero on the separatrix, where 2 T I2 = L² (textbook § 13.21).

    Positive where the polhode goes round the axis of the smallest moment, negative where it goes round that of the
    largest; between I2/I3 − 1 and I2/I1 − 1. Evaluated as I1 (I2 − I1) ω1² − I3 (I3 − I2) ω3² in double-double, so that
    it is known to some 15 digits however close to the separatrix.

    Parameters
    ----------
    moments : (…, 3) kg m², in any order; of a rotor one is 0
    angular_velocity : (…, 3) rad/s, along the principal axes

    Raises `GeometryError` where a body does not rotate: where it has no angular momentum.

    >>> separatrix_distance([3, 2, 1], [1, 5, 0]).item()       # a spin near axis 2 with a wobble about axis 1
    -0.027522935779816515
    """
    moments, omega = np.broadcast_arrays(moments_of(moments, rotor=True), vectors(angular_velocity, "angular_velocity"))
    if (still := ~((moments > 0) & (omega != 0)).any(axis=-1)).any():
        where = f"angular_velocity{at_index(first_index(still))} is {omega[first_index(still)].tolist()} rad/s"
        raise GeometryError(f"{where}: a body that has no angular momentum has no polhode")
    (moments, _), (omega, _) = scaled(moments), scaled(omega)
    order = np.argsort(moments, axis=-1, kind="stable")
    i1, i2, i3 = np.moveaxis(np.take_along_axis(moments, order, axis=-1), -1, 0)
    w1, _, w3 = np.moveaxis(np.take_along_axis(omega, order, axis=-1), -1, 0)
    about_1 = double_double.multiply(
        double_double.times(double_double.two_sum(i2, -i1), i1), double_double.two_product(w1, w1)
    )
    about_3 = double_double.multiply(
        double_double.times(double_double.two_sum(i3, -i2), i3), double_double.two_product(w3, w3)
    )
    excess = double_double.add(about_1, double_double.minus(about_3))
    distance: Float = excess[0] / np.sum((moments * omega) ** 2, axis=-1)
    return distance


def _squared_rates(moments: ArrayLike) -> Float:
    """Return Ω²/ω² (…, 3); negative about the intermediate axis."""
    moments = moments_of(moments)
    others = _others(moments)
    squares: Float = np.prod((moments[..., None] - others) / others, axis=-1)
    return squares


def _others(moments: Float) -> Float:
    """Return (…, 3, 2): for each axis the moments about the other two."""
    return moments[..., [[1, 2], [2, 0], [0, 1]]]


def _speed(speed: ArrayLike) -> Float:
    return np.abs(_finite(speed, "speed"))


def _finite(value: ArrayLike, name: str) -> Float:
    try:
        numbers = reals(value)
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be a number, or an array of them") from None
    if not np.isfinite(numbers).all():
        raise UsageError(f"{name} holds a value that is not finite")
    return numbers
