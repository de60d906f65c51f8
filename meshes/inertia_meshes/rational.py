"""Exact mass properties of closed triangle meshes and of simple solids, in rational numbers.

Every float64 coordinate is a rational number and the divergence theorem uses only sums and products, so the
moments of a mesh are rational numbers too: nothing is rounded here. Tensor signs: `inertia[0][1]` is −∫xy dV.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

Vector = tuple[Fraction, Fraction, Fraction]
Matrix = tuple[Vector, Vector, Vector]
Products = tuple[Fraction, Fraction, Fraction, Fraction, Fraction, Fraction]

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
"""The axes of the six second moments: xx, yy, zz, yz, zx, xy."""


@dataclass(frozen=True)
class Moments:
    """Volume, first and second moments of a solid about the origin of its coordinates.

    Attributes
    ----------
    volume : ∫dV
    first : ∫x dV, ∫y dV, ∫z dV
    second : ∫x² dV, ∫y² dV, ∫z² dV, ∫yz dV, ∫zx dV, ∫xy dV
    """

    volume: Fraction
    first: Vector
    second: Products

    @cached_property
    def center_of_mass(self) -> Vector:
        """First moments over the volume; raises `ZeroDivisionError` where the volume is zero."""
        x, y, z = self.first
        return x / self.volume, y / self.volume, z / self.volume

    @cached_property
    def central(self) -> Products:
        """Second moments about the centre of mass, in the order of `second`."""
        xx, yy, zz, yz, zx, xy = (
            value - self.first[i] * self.center_of_mass[j] for value, (i, j) in zip(self.second, PAIRS, strict=True)
        )
        return xx, yy, zz, yz, zx, xy

    @cached_property
    def inertia(self) -> Matrix:
        """Inertia tensor about the centre of mass for unit density, with tensor signs."""
        xx, yy, zz, yz, zx, xy = self.central
        return (yy + zz, -xy, -zx), (-xy, zz + xx, -yz), (-zx, -yz, xx + yy)

    def __add__(self, other: Moments) -> Moments:
        """Return the moments of both solids together."""
        return self._combined(other, 1)

    def __sub__(self, other: Moments) -> Moments:
        """Return the moments of this solid with `other` cut out of it."""
        return self._combined(other, -1)

    def _combined(self, other: Moments, sign: int) -> Moments:
        x, y, z = (a + sign * b for a, b in zip(self.first, other.first, strict=True))
        xx, yy, zz, yz, zx, xy = (a + sign * b for a, b in zip(self.second, other.second, strict=True))
        return Moments(self.volume + sign * other.volume, (x, y, z), (xx, yy, zz, yz, zx, xy))

    def weighted(self, density: Fraction | int) -> Moments:
        """Return the moments times a density: the volume becomes the mass."""
        x, y, z = (density * value for value in self.first)
        xx, yy, zz, yz, zx, xy = (density * value for value in self.second)
        return Moments(density * self.volume, (x, y, z), (xx, yy, zz, yz, zx, xy))

    def scaled(self, a: Fraction | int, b: Fraction | int, c: Fraction | int) -> Moments:
        """Return the moments of the solid stretched by positive factors a, b, c along x, y, z."""
        return self.mapped(((a, 0, 0), (0, b, 0), (0, 0, c))).weighted(a * b * c)

    def mapped(self, matrix: Sequence[Sequence[Fraction | int]]) -> Moments:
        """Return the moments of the solid turned by x → `matrix` x, a rotation or a reflection."""
        xx, yy, zz, yz, zx, xy = self.second
        full = ((xx, xy, zx), (xy, yy, yz), (zx, yz, zz))
        x, y, z = (_total(row[k] * self.first[k] for k in range(3)) for row in matrix)
        xx, yy, zz, yz, zx, xy = (
            _total(matrix[i][k] * full[k][l] * matrix[j][l] for k in range(3) for l in range(3)) for i, j in PAIRS
        )
        return Moments(self.volume, (x, y, z), (xx, yy, zz, yz, zx, xy))

    def moved(self, x: Fraction | int, y: Fraction | int, z: Fraction | int) -> Moments:
        """Return the moments of the solid translated by (x, y, z)."""
        by, first, volume = (x, y, z), self.first, self.volume
        xx, yy, zz, yz, zx, xy = (
            value + first[i] * by[j] + first[j] * by[i] + volume * by[i] * by[j]
            for value, (i, j) in zip(self.second, PAIRS, strict=True)
        )
        moved = (first[0] + volume * x, first[1] + volume * y, first[2] + volume * z)
        return Moments(volume, moved, (xx, yy, zz, yz, zx, xy))


NOTHING = Moments(Fraction(0), (Fraction(0),) * 3, (Fraction(0),) * 6)
"""The moments of no solid at all."""


def _total(terms: Iterable[Fraction]) -> Fraction:
    return sum(terms, Fraction(0))


def moments(corners: ArrayLike) -> Moments:
    """Return the exact moments of the solid bounded by triangles.

    Each triangle spans with the origin a tetrahedron (0, a, b, c). With d = a·(b×c) and s = a + b + c:
    V = d/6, ∫x dV = d/24 s, ∫x xᵀ dV = d/120 (s sᵀ + a aᵀ + b bᵀ + c cᵀ). The coordinates are brought to one
    power of two, so that all sums are sums of integers.

    Parameters
    ----------
    corners : (n, 3, 3) finite floats, counter-clockwise seen from outside
        Of an open surface the result is that of its cone from the origin.

    Source: F. Tonon, J. Math. Stat. 1 (2005) 8–11, for the tetrahedron.

    >>> moments([[[0, 0, 0], [0, 1, 0], [1, 0, 0]], [[0, 0, 0], [1, 0, 0], [0, 0, 1]],
    ...          [[0, 0, 0], [0, 0, 1], [0, 1, 0]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]]]).volume
    Fraction(1, 6)
    """
    rows = np.asarray(corners, np.float64).reshape(-1, 9).tolist()
    ratios = [number.as_integer_ratio() for number in chain.from_iterable(rows)]
    scale = max((denominator for _, denominator in ratios), default=1)
    numbers = [numerator * (scale // denominator) for numerator, denominator in ratios]
    v = x = y = z = xx = yy = zz = yz = zx = xy = 0
    for k in range(0, len(numbers), 9):
        ax, ay, az, bx, by, bz, cx, cy, cz = numbers[k : k + 9]
        d = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        sx, sy, sz = ax + bx + cx, ay + by + cy, az + bz + cz
        v += d
        x += d * sx
        y += d * sy
        z += d * sz
        xx += d * (sx * sx + ax * ax + bx * bx + cx * cx)
        yy += d * (sy * sy + ay * ay + by * by + cy * cy)
        zz += d * (sz * sz + az * az + bz * bz + cz * cz)
        yz += d * (sy * sz + ay * az + by * bz + cy * cz)
        zx += d * (sz * sx + az * ax + bz * bx + cz * cx)
        xy += d * (sx * sy + ax * ay + bx * by + cx * cy)
    one, two = 24 * scale**4, 120 * scale**5
    return Moments(
        Fraction(v, 6 * scale**3),
        (Fraction(x, one), Fraction(y, one), Fraction(z, one)),
        (
            Fraction(xx, two), Fraction(yy, two), Fraction(zz, two),
            Fraction(yz, two), Fraction(zx, two), Fraction(xy, two),
        ),
    )  # fmt: skip
