"""`Line` and `Sigma`: what a part of an assembly has and how sure that is, all its copies together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from inertia.arrays import Float
from inertia.assembly.inputs import Owner, Source, labels_of
from inertia.records import dataclass

_PLACES = (0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)  # of the six second moments
ELEMENTS = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)  # of the six of a tensor


@dataclass(frozen=True, eq=False)
class Sigma:
    """Standard uncertainties of mass properties, SI, and what each input contributes.

    Attributes
    ----------
    labels : of the inputs
    changes : (n, 11), each for one standard uncertainty of an independent figure: mass, centre of mass, tensor (xx,
        yy, zz, xy, xz, yz) about it, predicted mass
    owner : (n,) to which label each belongs
    """

    labels: tuple[str, ...]
    changes: Float
    owner: Sequence[int]

    @property
    def all(self) -> Float:
        """u of the eleven figures."""
        return _root((self.changes**2).sum(axis=0))

    @property
    def mass(self) -> float:
        """u of the mass, kg."""
        return float(self.all[0])

    @property
    def predicted_mass(self) -> float:
        """u of the predicted mass, kg."""
        return float(self.all[10])

    @property
    def center_of_mass(self) -> Float:
        """u of its coordinates, (3,) m."""
        return self.all[1:4]

    @property
    def inertia(self) -> Float:
        """u of the tensor's elements, (3, 3) kg m²."""
        return _matrix(self.all[4:10])

    def along(self, rates: Float) -> float:
        """Return u of a figure that changes by `rates` (11,) with the eleven."""
        return float(_root(((self.changes @ rates) ** 2).sum()))

    def shares(self) -> Float:
        """Return what part of each variance each label contributes, (labels, 11); 0 where there is none."""
        squares = np.zeros((len(self.labels), 11))
        np.add.at(squares, np.asarray(self.owner, dtype=np.intp), self.changes**2)
        total = squares.sum(axis=0)
        shares: Float = np.divide(squares, total, out=np.zeros_like(squares), where=total > 0)
        return shares


@dataclass(frozen=True, eq=False)
class Line:
    """A line of the budget: a part, a group or an assembly, with all its copies; SI, in the axes of the whole.

    Attributes
    ----------
    name, level : its place in the tree; the whole has level 0
    quantity : copies in the whole
    basic_mass : kg, of all copies
    allowance : kg
    maturity, category : as stated, here or above; None without
    center_of_mass : (3,) m, of all copies together
    inertia : (3, 3) kg m² about it
    sigma : standard uncertainties
    own_sigma : those of what it has beside the lines below it, by itself
    misplacement : standard uncertainties of the place of each copy, m, and of its turns, rad, with all below it
    children : the lines below it
    """

    name: str
    level: int
    quantity: int
    basic_mass: float
    allowance: float
    maturity: str | None
    category: str | None
    center_of_mass: Float
    inertia: Float
    sigma: Sigma
    own_sigma: Sigma
    misplacement: tuple[float, float]
    children: tuple[Line, ...]

    @property
    def predicted_mass(self) -> float:
        """kg."""
        return self.basic_mass + self.allowance

    def lines(self) -> Iterator[Line]:
        """Yield itself and all below, from the top to the bottom."""
        yield self
        for child in self.children:
            yield from child.lines()


def central_of(moments: Float, changes: Mapping[Source, Float]) -> tuple[Float, Float, Sigma]:
    """Return the centre of mass, the tensor about it, and the uncertainties of both.

    With c = ∫x/m: δc = (δ∫x − c δm)/m and, about the centre, δS_c = δS − c δ(∫x)ᵀ − δ(∫x) cᵀ + c cᵀ δm.
    """
    mass, first, second = moments[0], moments[1:4], square(moments[4:])
    if not mass:
        return first, np.zeros((3, 3)), Sigma((), np.zeros((0, 11)), ())
    c = first / mass
    tensor = tensor_of(second - mass * np.outer(c, c))
    if not changes:
        return c, tensor, Sigma((), np.zeros((0, 11)), ())
    stacked = np.concatenate(list(changes.values()))
    dm, df = stacked[:, :1], stacked[:, 1:4]
    lever = np.einsum("i,nj->nij", c, df)
    ds = square(stacked[:, 4:10]) - lever - lever.swapaxes(1, 2) + dm[:, :, np.newaxis] * np.outer(c, c)
    di = tensor_of(ds)
    elements = np.stack([di[:, i, j] for i, j in ELEMENTS], axis=1)
    figures: dict[tuple[str, Owner], int] = {}  # those of one, in all its places, have one label
    numbers = [figures.setdefault((source.what, source.owner), len(figures)) for source in changes]
    owner = [number for number, change in zip(numbers, changes.values(), strict=True) for _ in change]
    return (
        c,
        tensor,
        Sigma(labels_of(figures), np.concatenate([dm, (df - dm * c) / mass, elements, stacked[:, 10:]], axis=1), owner),
    )


def square(six: Float) -> Float:
    """Return (..., 3, 3) of the six second moments (..., 6)."""
    result = np.zeros((*six.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(_PLACES):
        result[..., i, j] = result[..., j, i] = six[..., k]
    return result


def six_of(square: Float) -> Float:
    """Return the six second moments (..., 6) of (..., 3, 3)."""
    return np.stack([square[..., i, j] for i, j in _PLACES], axis=-1)


def tensor_of(second: Float) -> Float:
    """Return the tensors tr(S) δ − S."""
    trace = np.trace(second, axis1=-2, axis2=-1)
    tensor: Float = trace[..., np.newaxis, np.newaxis] * np.eye(3) - second
    return tensor


def _matrix(elements: Float) -> Float:
    result = np.zeros((3, 3))
    for value, (i, j) in zip(elements.tolist(), ELEMENTS, strict=True):
        result[i, j] = result[j, i] = value
    return result


def _root(variance: Float) -> Float:
    root: Float = np.sqrt(variance)
    return root
