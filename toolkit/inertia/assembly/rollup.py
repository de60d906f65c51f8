"""Moments of parts in their places added up, in integers: the sum is exact but for its last bits, which are counted.

A part of mass m, centre c and ∫x xᵀ = S about it, placed by x ↦ R x + t, adds m, m c′ and R S Rᵀ + m c′c′ᵀ, with
c′ = R c + t seen from the centre of mass of all. Masses are counted in 2⁻²⁵⁶ kg, lengths in 2⁻²⁵⁶ m, second moments in
2⁻³²⁰ kg m².
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.assembly.bodies import Body
from inertia.assembly.frames import LENGTH_BITS, Frame, float_above
from inertia.mass.moments import Moments, norm_above, six, vector
from inertia.mass.properties import MassProperties
from inertia.mesh.turns import TURN_BITS
from inertia.records import dataclass

_MASS_BITS, _SECOND_BITS = 256, 320
_LOST = 2.0**-150  # relative: more than the integers drop
_WIDEN = 1 + 1e-9  # more than the bounds, in float64, are rounded by


class _Leaf(NamedTuple):
    """A body in integers: mass, centre, second moments about it; and the bounds of each, trace and distance, SI."""

    mass: int
    center: tuple[int, int, int]
    second: tuple[int, ...]
    bounds: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Placed:
    """All parts in their places.

    Attributes
    ----------
    properties : of the whole, with the certified bound
    center : (3,) m, about which the moments of the parts are taken: the centre of mass, rounded
    moments : (n, 10) of each part: kg, kg m, kg m² (xx, yy, zz, yz, zx, xy), in the axes of the whole
    """

    properties: MassProperties
    center: Float
    moments: Float


def place(bodies: Sequence[Body], frames: Sequence[Sequence[Frame]]) -> Placed:
    """Place each body by its frames, and add up."""
    known: dict[int, _Leaf] = {}  # parts of one kind have the same moments
    for body in bodies:
        if id(body.moments) not in known:
            known[id(body.moments)] = _leaf(body)
    leaves = [known[id(body.moments)] for body in bodies]
    total, first = 0, [0, 0, 0]
    centers, seconds = [], []
    for leaf, places in zip(leaves, frames, strict=True):
        for frame in places:
            center = frame.place(leaf.center)
            centers.append(center)
            seconds.append(_turned(frame.rotation, leaf.second))
            total += leaf.mass
            for k in range(3):
                first[k] += leaf.mass * center[k]
    middle = [f // total for f in first]
    second = [0] * 6
    counts = [len(places) for places in frames]
    masses = [leaf.mass for leaf, count in zip(leaves, counts, strict=True) for _ in range(count)]
    shift = _MASS_BITS + 2 * LENGTH_BITS - _SECOND_BITS
    offsets = []
    for mass, center, own in zip(masses, centers, seconds, strict=True):
        x, y, z = (a - b for a, b in zip(center, middle, strict=True))
        offsets.append((x, y, z))
        steiner = (mass * k >> shift for k in (x * x, y * y, z * z, y * z, z * x, x * y))
        for k, (a, b) in enumerate(zip(own, steiner, strict=True)):
            second[k] += a + b
    flat = [frame for places in frames for frame in places]
    offset = _floats(offsets, LENGTH_BITS)
    weight = _floats([(m,) for m in masses], _MASS_BITS)
    bounds = np.repeat(np.array([leaf.bounds for leaf in leaves]), counts, axis=0)
    zeroth_bound, first_bound, second_bound = _bounds(weight[:, 0], offset, bounds, flat)
    scale = Fraction(1, 1 << LENGTH_BITS)
    moments = Moments(
        vector(k * scale for k in middle),
        Fraction(total, 1 << _MASS_BITS),
        vector(Fraction(f - total * c, 1 << (_MASS_BITS + LENGTH_BITS)) for f, c in zip(first, middle, strict=True)),
        six(Fraction(k, 1 << _SECOND_BITS) for k in second),
        zeroth_bound,
        vector([first_bound] * 3),
        six([2 * second_bound] * 6),
        (first_bound, second_bound),
    )
    volume = sum((count * body.volume for body, count in zip(bodies, counts, strict=True)), Fraction(0))
    volume_bound = sum((count * body.volume_bound for body, count in zip(bodies, counts, strict=True)), Fraction(0))
    methods = " + ".join(dict.fromkeys(body.method for body in bodies))
    center_of_mass = np.array([k / (1 << LENGTH_BITS) for k in middle])
    columns = offset[:, [1, 2, 0]] * offset[:, [2, 0, 1]]
    own = _floats(seconds, _SECOND_BITS) + weight * np.concatenate([offset**2, columns], axis=1)
    return Placed(
        MassProperties.from_moments(moments, volume, volume_bound, methods),
        center_of_mass,
        np.concatenate([weight, weight * offset, own], axis=1),
    )


def _leaf(body: Body) -> _Leaf:
    central = body.moments.central()
    x, y, z = (round(k * (1 << LENGTH_BITS)) for k in central.origin)
    bounds = (
        central.zeroth_bound,
        body.moments.centroid_bound,
        central.error_norms[1],
        sum(central.second[:3], Fraction(0)) + sum(central.second_bound[:3], Fraction(0)),
        norm_above(central.origin),
    )
    return _Leaf(
        round(central.zeroth * (1 << _MASS_BITS)),
        (x, y, z),
        tuple(round(k * (1 << _SECOND_BITS)) for k in central.second),
        tuple(map(float_above, bounds)),
    )


def _turned(rotation: tuple[int, ...], second: tuple[int, ...]) -> tuple[int, ...]:
    """Return the elements of R S Rᵀ."""
    a, b, c, d, e, f, g, h, i = rotation
    xx, yy, zz, yz, zx, xy = second
    bits = 2 * TURN_BITS
    ax, ay, az = a * xx + b * xy + c * zx, a * xy + b * yy + c * yz, a * zx + b * yz + c * zz
    dx, dy, dz = d * xx + e * xy + f * zx, d * xy + e * yy + f * yz, d * zx + e * yz + f * zz
    gx, gy, gz = g * xx + h * xy + i * zx, g * xy + h * yy + i * yz, g * zx + h * yz + i * zz
    return (
        (ax * a + ay * b + az * c) >> bits,
        (dx * d + dy * e + dz * f) >> bits,
        (gx * g + gy * h + gz * i) >> bits,
        (dx * g + dy * h + dz * i) >> bits,
        (gx * a + gy * b + gz * c) >> bits,
        (ax * d + ay * e + az * f) >> bits,
    )


def _bounds(mass: Float, offset: Float, bounds: Float, frames: Sequence[Frame]) -> tuple[Fraction, ...]:
    """Return bounds of the sums of the zeroth, first (norm) and second (norm of the tensor) moments.

    A rotation that is off orthonormal by E = RᵀR − 1 is within ‖E‖ of the nearest one, and so puts the centre at most
    ‖E‖ times its lever off, and the tensor 3 ‖E‖ tr S (`inertia.mass.moments.Moments.turned`).
    """
    vb, cb, tb, trace, far = bounds.T
    skew = np.array([frame.skew for frame in frames]) + _LOST
    lever = np.array([frame.reach for frame in frames]) + far
    m, distance = mass + vb, np.sqrt((offset**2).sum(axis=1))
    off = (1 + skew) * cb + skew * lever
    zeroth = vb + _LOST * mass
    first = m * off + distance * zeroth
    second = (1 + 2 * skew) * tb + 3 * skew * trace + 3 * distance * m * off + 1.5 * m * off**2
    second += 1.5 * distance**2 * zeroth
    sums = (_WIDEN * float(k.sum()) for k in (zeroth, first, second))
    return tuple(Fraction(k) + Fraction(1, 2**310) for k in sums)


def _floats(rows: Sequence[Sequence[int]], bits: int) -> Float:
    one = 1 << bits
    return np.array([[k / one for k in row] for row in rows]).reshape(len(rows), -1)
