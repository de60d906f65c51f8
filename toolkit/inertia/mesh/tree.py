"""`MeshTree`: the nodes of a scene or product file, how each is placed on the one above it, and meshes in own axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from operator import mul

from inertia.errors import UsageError
from inertia.mesh.part import Part
from inertia.records import dataclass

Matrix = tuple[tuple[Fraction, ...], ...]
"""A (3, 3) matrix by rows."""

ONE: Matrix = tuple(tuple(Fraction(i == j) for j in range(3)) for i in range(3))


def determinant(rows: Matrix) -> Fraction:
    """Return the determinant of a (3, 3) matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def diagonal(factors: Iterable[Fraction]) -> Matrix:
    """Return the (3, 3) matrix that multiplies x, y and z."""
    x, y, z = factors
    none = Fraction(0)
    return (x, none, none), (none, y, none), (none, none, z)


def rotation(quaternion: Sequence[Fraction]) -> Matrix:
    """Return the rotation of a quaternion x, y, z, w of any length but zero."""
    x, y, z, w = quaternion
    twice = 2 / (x * x + y * y + z * z + w * w)
    return (
        (1 - twice * (y * y + z * z), twice * (x * y - z * w), twice * (x * z + y * w)),
        (twice * (x * y + z * w), 1 - twice * (x * x + z * z), twice * (y * z - x * w)),
        (twice * (x * z - y * w), twice * (y * z + x * w), 1 - twice * (x * x + y * y)),
    )


def times(a: Matrix, b: Matrix) -> Matrix:
    """Return the product of two (3, 3) matrices."""
    if a == ONE or b == ONE:
        return b if a == ONE else a
    columns = list(zip(*b, strict=True))
    return tuple(tuple(sum(map(mul, row, column), Fraction(0)) for column in columns) for row in a)


def inverse(rows: Matrix) -> Matrix:
    """Return the inverse of a (3, 3) matrix whose determinant is not zero."""
    x, y, z = rows
    columns = [_cross(y, z), _cross(z, x), _cross(x, y)]
    size = sum(map(mul, x, columns[0]), Fraction(0))
    return tuple(tuple(column[k] / size for column in columns) for k in range(3))


def _cross(a: Sequence[Fraction], b: Sequence[Fraction]) -> tuple[Fraction, ...]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True)
class Motion:
    """x ↦ R(q) A x + t, exactly as a file writes it.

    Attributes
    ----------
    at : t, in the unit of the file
    linear : A, any matrix
    quaternion : q = x, y, z, w of any length but zero; None where the file states no rotation by itself
    """

    at: tuple[Fraction, ...] = (Fraction(0),) * 3
    linear: Matrix = ONE
    quaternion: tuple[Fraction, ...] | None = None

    @classmethod
    def of(cls, matrix: Sequence[Sequence[Fraction]]) -> Motion:
        """Return the motion of a matrix (3 or 4, 4) that acts on columns."""
        return cls(tuple(row[3] for row in matrix[:3]), tuple(tuple(row[:3]) for row in matrix[:3]))


@dataclass(frozen=True)
class MeshNode:
    """A node of a scene: a mesh, a group of other nodes, or both.

    Attributes
    ----------
    name : as the file has it; None where it has none
    parent : the place of the node above it in the list of nodes, which comes before it; None at the top
    motion : from its axes to those of the node above
    mesh : the key of what it shows; None of a group
    """

    name: str | None
    parent: int | None
    motion: Motion = field(default_factory=Motion)
    mesh: str | None = None


@dataclass(frozen=True, eq=False)
class MeshTree:
    """The nodes of a file, each after the one above it, and the meshes that they show, once and in own axes."""

    nodes: tuple[MeshNode, ...]
    meshes: Mapping[str, Part]
    notes: tuple[str, ...] = ()

    def part(self, name: str, file: str) -> Part:
        """Return a mesh; raise `UsageError` where there is none of that name."""
        if name not in self.meshes:
            raise UsageError(f"{file} has no mesh {name!r}: it has {', '.join(map(repr, self.meshes))}")
        return self.meshes[name]


def unique(names: Iterable[str]) -> list[str]:
    """Return names that differ: of those that stand twice the second is "NAME 2", or the next that is free.

    >>> unique(["bolt", "bolt", "bolt 2", "nut"])
    ['bolt', 'bolt 3', 'bolt 2', 'nut']
    """
    several = list(names)
    used, result = set(several), []
    first: set[str] = set()
    last: dict[str, int] = {}
    for name in several:
        called = name
        if name in first:
            k = last.get(name, 1) + 1
            while f"{name} {k}" in used:
                k += 1
            last[name], called = k, f"{name} {k}"
            used.add(called)
        first.add(name)
        result.append(called)
    return result
