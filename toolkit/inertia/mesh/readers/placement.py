"""Where a scene puts a mesh: a product of matrices, in float64 with a bound on what it rounds, and exactly if asked.

A product of k matrices, the entries of each off by at most r u of its size, is off by at most (Σ r + 4 (k − 1)) u of
the product of their sizes (Higham, *Accuracy and Stability of Numerical Algorithms*, § 3.5), and where it puts a point
by four more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from functools import cache

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.part import Rounding
from inertia.mesh.readers.decimals import remainders
from inertia.mesh.tree import Motion
from inertia.records import dataclass

Exact = list[list[Fraction]]
"""The rows of a (4, 4) matrix."""

_UNIT = 2.0**-53 * (1 + 1e-9)


@dataclass(frozen=True, eq=False)
class Placement:
    """A (4, 4) matrix that acts on columns, with what it may be off by; no factors are the identity.

    `size` is the product of the absolute values of its factors, of which it may be `roundings` units in the last place
    off; each of `factors` returns a factor exactly.
    """

    matrix: Float
    size: Float
    roundings: int
    factors: tuple[Callable[[], Exact], ...]

    @staticmethod
    def identity() -> Placement:
        """Return the placement that moves nothing."""
        return Placement(np.eye(4), np.eye(4), 0, ())

    @staticmethod
    def of(matrix: Float, exact: Callable[[], Exact], roundings: int = 1, size: Float | None = None) -> Placement:
        """Return the placement by one matrix, whose entries are off by so many roundings of their `size`."""
        if np.array_equal(matrix, np.eye(4)) and exact() == _IDENTITY:
            return Placement.identity()
        return Placement(matrix, np.abs(matrix) if size is None else size, roundings, (exact,))

    def __matmul__(self, inner: Placement) -> Placement:
        if not self.factors or not inner.factors:
            return self if self.factors else inner
        with np.errstate(all="ignore"):
            return Placement(
                self.matrix @ inner.matrix,
                self.size @ inner.size,
                self.roundings + inner.roundings + 4,
                (*self.factors, *inner.factors),
            )

    def move(
        self, vertices: Float, faces: Int, exact: Callable[[], Iterable[Fraction]], own: Rounding | None = None
    ) -> tuple[Float, Int, Rounding | None]:
        """Return a mesh where this puts it, with what that and reading (`own`) rounded.

        The identity keeps the bits; a mirror image has its faces turned round, so that they still face outwards.
        `exact` returns the coordinates as the file writes them, vertex by vertex.
        """
        if not self.factors:
            return vertices, faces, own
        with np.errstate(all="ignore"):  # an overflow is reported as a coordinate that is not finite
            along = [vertices[:, i : i + 1] * self.matrix[:3, i] for i in range(3)]
            moved = along[0] + along[1] + along[2] + self.matrix[:3, 3]
            mirrored = np.linalg.det(self.matrix[:3, :3]) < 0
            farthest = np.append(np.abs(vertices).max(axis=0, initial=0.0), 1.0)
            off = float(np.linalg.norm((self.roundings + 4) * _UNIT * (self.size @ farthest)[:3]))
            stretch = float(np.linalg.norm(self.size[:3, :3])) * (1 + 1e-9)
        distance = off + (0.0 if own is None else stretch * own.distance)
        rounding = Rounding(distance, cache(lambda: remainders(moved, self._exactly(exact()), distance)))
        return moved, faces[:, ::-1] if mirrored else faces, rounding

    def motion(self) -> Motion:
        """Return it exactly."""
        return Motion.of(self._product())

    def _product(self) -> Exact:
        product = _IDENTITY
        for factor in self.factors:
            columns = [*zip(*factor(), strict=True)]
            product = [[sum(map(_times, row, column), _ZERO) for column in columns] for row in product]
        return product

    def _exactly(self, coordinates: Iterable[Fraction]) -> Iterator[Fraction]:
        product = self._product()
        numbers = iter(coordinates)
        for x, y, z in zip(numbers, numbers, numbers, strict=True):
            yield from (a * x + b * y + c * z + d for a, b, c, d in product[:3])


_ZERO = Fraction(0)
_IDENTITY: Exact = [[Fraction(int(i == j)) for j in range(4)] for i in range(4)]


def _times(a: Fraction, b: Fraction) -> Fraction:
    return a * b
