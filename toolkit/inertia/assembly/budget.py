"""`Budget`: what each part of an assembly contributes, with allowances and standard uncertainties, against its limits.

Basic mass is what the parts have now, predicted mass what they are expected to grow to: basic mass and mass growth
allowance (terms of ANSI/AIAA S-120A; ISO 22010). Uncertainties are propagated to first order (JCGM 100:2008, 5.1.2):
the ten moments of the whole are sums over parts, so that a change of one input moves them by what `inertia.assembly.
bodies` says, turned and shifted to the place of each copy; inputs of one label move together, others by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.assembly.allowances import EXAMPLE, allowance_of
from inertia.assembly.bodies import Input
from inertia.assembly.fields import LimitFields
from inertia.assembly.frames import LENGTH_BITS, TURN_BITS, Frame
from inertia.assembly.rollup import Placed
from inertia.assembly.tree import Node, PartTree
from inertia.errors import FieldPath, UsageError, placed
from inertia.mass.principal import principal
from inertia.mass.properties import MassProperties

Verdict = Literal["pass", "fail", "undecided"]

COVERAGE = 1.959963984540054
"""Standard uncertainties on either side that 95 % of a normal distribution lie within."""

_PLACES = (0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)  # of the six second moments
_ELEMENTS = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)  # of the six of a tensor
_CHUNK = 4096


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


@dataclass(frozen=True)
class Limit:
    """A limit and what became of it; SI.

    Attributes
    ----------
    what : as the file names it
    value : what it is on
    low, high : least and largest value; None without
    uncertainty : standard uncertainty of the value
    bound : on the arithmetic error of the value
    verdict : "undecided" where 95 % of what the value may be are neither within nor beyond
    """

    what: str
    value: float
    low: float | None
    high: float | None
    uncertainty: float
    bound: float

    @property
    def margin(self) -> float:
        """How far within the limit the value is; negative beyond it."""
        return min(
            math.inf if self.high is None else self.high - self.value,
            math.inf if self.low is None else self.value - self.low,
        )

    @property
    def verdict(self) -> Verdict:
        """Whether the interval of 95 % is within the limits, beyond one of them, or neither."""
        reach = COVERAGE * self.uncertainty + self.bound
        if self.margin >= reach:
            return "pass"
        return "fail" if self.margin < -reach else "undecided"


@dataclass(frozen=True, eq=False)
class Budget:
    """The budget of an assembly.

    Attributes
    ----------
    assembly : whose it is
    properties : of the whole, with the certified bound
    total : the line of the whole, with those of all parts below it
    limits : in the order of the file
    notes : what was decided on the way, in sentences
    """

    assembly: PartTree
    properties: MassProperties
    total: Line
    limits: tuple[Limit, ...]
    notes: tuple[str, ...]

    @property
    def verdict(self) -> Verdict | None:
        """ "fail" if any limit is exceeded, then "undecided" if any is; None without limits."""
        verdicts = {limit.verdict for limit in self.limits}
        for one in ("fail", "undecided", "pass"):
            if one in verdicts:
                return one
        return None


def budget(assembly: PartTree) -> Budget:
    """Return the budget of an assembly; raises as `Assembly.mass_properties` does.

    >>> whole = PartTree.from_dict({"unit": "m", "part": [
    ...     {"name": "a", "shape": "point", "mass": "3±0.03", "at": [1, 0, 0]},
    ...     {"name": "b", "shape": "point", "mass": "1±0.04", "at": [-3, 0, 0]}]})
    >>> result = budget(whole)
    >>> round(result.total.sigma.mass, 6), round(result.total.sigma.center_of_mass[0].item(), 6)
    (0.05, 0.030923)
    """
    places = assembly.placed
    lines = _Lines(assembly, places)
    total = lines.total()
    limits = tuple(_limit(each, total, places.properties, assembly) for each in assembly.fields.limit)
    notes = list(assembly.notes)
    if lines.immature and any(line.maturity for line in total.lines()):
        few = ", ".join(lines.immature[:3]) + (" …" if len(lines.immature) > 3 else "")
        notes.append(f"{len(lines.immature)} parts state no maturity and have no allowance: {few}")
    return Budget(assembly, places.properties, total, limits, tuple(notes))


class _Lines:
    """Builds the lines, from the bottom to the top."""

    def __init__(self, assembly: PartTree, places: Placed) -> None:
        self.immature: list[str] = []
        self._assembly, self._places = assembly, places
        self._table = {**EXAMPLE, **(assembly.fields.allowances or {})}
        self._frames = dict(assembly.in_places())
        self._start = 0

    def total(self) -> Line:
        """Return the line of the whole."""
        return self._line(self._assembly.root, 0, (None, None, None))[0]

    def _line(
        self, node: Node, level: int, above: tuple[float | None, str | None, str | None]
    ) -> tuple[Line, Float, dict[str, Float]]:
        """Return a line, the moments (n, 10) of each copy, and the changes (k, 11) for each label."""
        frames, fields = self._frames[node], node.fields
        own, maturity, category = above
        if fields is not None:
            own = own if fields.allowance is None and fields.maturity is None else fields.allowance
            maturity, category = fields.maturity or maturity, fields.category or category
        moments = np.zeros((len(frames), 10))
        changes: dict[str, Float] = {}
        allowance, children = 0.0, []
        if node.body is not None:
            moments += self._places.moments[self._start : self._start + len(frames)]
            self._start += len(frames)
            share = own
            if share is None:
                try:
                    share = allowance_of(self._table, category, maturity, node.path)
                except UsageError as error:
                    raise placed(error, node.file) from None
            if share is None:
                self.immature.append(node.name)
            allowance = (share or 0.0) * float(moments[:, 0].sum())
            for each in node.body.inputs:
                _add(changes, each.label, _grown(self._placed(each, frames, moments), share or 0.0))
        for child in node.children:
            line, inner, moved = self._line(child, level + 1, (own, maturity, category))
            children.append(line)
            moments += inner.reshape(len(frames), -1, 10).sum(axis=1)
            allowance += line.allowance
            for label, change in moved.items():
                _add(changes, label, change)
        if fields is not None:
            for label, change in self._misplaced(node, frames, moments):
                _add(changes, label, _grown(change, 0.0))
        whole = moments.sum(axis=0)
        center, tensor, sigma = _central(whole, changes)
        line = Line(
            node.name,
            level,
            len(frames),
            float(whole[0]),
            allowance,
            maturity,
            category,
            self._places.center + center,
            tensor,
            sigma,
            tuple(children),
        )
        return line, moments, changes

    def _placed(self, one: Input, frames: Sequence[Frame], moments: Float) -> Float:
        """Return the change of all copies together."""
        offsets = moments[:, 1:4] / moments[:, :1]
        result = np.zeros((len(one.change), 10))
        mass, first = one.change[:, 0], one.change[:, 1:4]
        second = _square(one.change[:, 4:])
        for start in range(0, len(frames), _CHUNK):
            chunk = frames[start : start + _CHUNK]
            turns = np.array([[k / (1 << TURN_BITS) for k in frame.rotation] for frame in chunk]).reshape(-1, 3, 3)
            d = offsets[start : start + _CHUNK]
            turned = np.einsum("nij,kj->nki", turns, first)
            lever = np.einsum("nki,nj->kij", turned, d)
            steiner = np.einsum("k,ni,nj->kij", mass, d, d)
            s = np.einsum("nip,kpq,njq->kij", turns, second, turns) + lever + lever.swapaxes(1, 2) + steiner
            result[:, 0] += len(chunk) * mass
            result[:, 1:4] += turned.sum(axis=0) + np.outer(mass, d.sum(axis=0))
            result[:, 4:] += _six(s)
        return result

    def _misplaced(self, node: Node, frames: Sequence[Frame], moments: Float) -> Iterator[tuple[str, Float]]:
        """Yield the changes for each copy by itself being moved, and turned about its origin."""
        fields = node.fields
        assert fields is not None
        mass, first, second = moments[:, 0], moments[:, 1:4], _square(moments[:, 4:])
        if u := float(node.unit.metres) * (fields.position_uncertainty or 0.0):
            change = np.zeros((len(frames), 3, 10))
            for k, e in enumerate(np.eye(3)):
                change[:, k, 1:4] = mass[:, np.newaxis] * e
                along = np.einsum("i,nj->nij", e, first)
                change[:, k, 4:] = _six(along + along.swapaxes(1, 2))
            yield f"position of {node.label}", u * change.reshape(-1, 10)
        if u := math.radians(fields.angle_uncertainty or 0.0):
            origins = np.array([[k / (1 << LENGTH_BITS) for k in frame.origin] for frame in frames])
            away = first - mass[:, np.newaxis] * (origins - self._places.center)  # ∫x seen from the origin
            outer = second - np.einsum("ni,nj->nij", origins - self._places.center, first)  # ∫(x − o) xᵀ
            change = np.zeros((len(frames), 3, 10))
            for k, e in enumerate(np.eye(3)):
                cross = np.cross(np.eye(3), e)  # its rows are such that cross @ x = e × x
                change[:, k, 1:4] = away @ cross.T
                turned = np.einsum("ij,njk->nik", cross, outer)
                change[:, k, 4:] = _six(turned + turned.swapaxes(1, 2))
            yield f"angle of {node.label}", u * change.reshape(-1, 10)


def _add(changes: dict[str, Float], label: str, change: Float) -> None:
    changes[label] = changes[label] + change if label in changes else change


def _grown(change: Float, allowance: float) -> Float:
    """Return changes with that of the predicted mass beside them."""
    return np.concatenate([change, (1.0 + allowance) * change[:, :1]], axis=1)


def _central(moments: Float, changes: Mapping[str, Float]) -> tuple[Float, Float, Sigma]:
    """Return the centre of mass, the tensor about it, and the uncertainties of both.

    With c = ∫x/m: δc = (δ∫x − c δm)/m and, about the centre, δS_c = δS − c δ(∫x)ᵀ − δ(∫x) cᵀ + c cᵀ δm.
    """
    mass, first, second = moments[0], moments[1:4], _square(moments[4:])
    if not mass:
        return first, np.zeros((3, 3)), Sigma((), np.zeros((0, 11)), ())
    c = first / mass
    tensor = _tensor(second - mass * np.outer(c, c))
    if not changes:
        return c, tensor, Sigma((), np.zeros((0, 11)), ())
    stacked = np.concatenate(list(changes.values()))
    dm, df = stacked[:, :1], stacked[:, 1:4]
    lever = np.einsum("i,nj->nij", c, df)
    ds = _square(stacked[:, 4:10]) - lever - lever.swapaxes(1, 2) + dm[:, :, np.newaxis] * np.outer(c, c)
    di = _tensor(ds)
    elements = np.stack([di[:, i, j] for i, j in _ELEMENTS], axis=1)
    owner = [k for k, change in enumerate(changes.values()) for _ in change]
    return (
        c,
        tensor,
        Sigma(tuple(changes), np.concatenate([dm, (df - dm * c) / mass, elements, stacked[:, 10:]], axis=1), owner),
    )


def _limit(fields: LimitFields, total: Line, properties: MassProperties, assembly: PartTree) -> Limit:
    above, _, below = fields.what.partition("/")
    value, rates, bound = _figure(above, total, properties)
    if below:
        divisor, others, off = _figure(below, total, properties)
        if not divisor:
            raise placed(UsageError(f"{below} is 0: nothing is in proportion to it"), assembly.path, FieldPath("limit"))
        value, rates = value / divisor, (rates - value / divisor * others) / divisor
        bound = (bound + abs(value) * off) / max(abs(divisor) - off, 1e-300)
    scale = float(assembly.unit.metres) if above.startswith("center_of_mass") else 1.0
    low, high = (None if k is None else scale * k for k in (fields.min, fields.max))
    return Limit(fields.what, value, low, high, total.sigma.along(rates), bound)


def _figure(what: str, total: Line, properties: MassProperties) -> tuple[float, Float, float]:
    """Return a quantity of the whole, how it changes with the eleven of `Sigma.changes`, and its bound."""
    rates, error = np.zeros(11), properties.error
    kind, _, which = what.partition(".")
    size = float(np.linalg.norm(properties.inertia))
    tensor_bound = error.inertia * size if size else 0.0  # the tensor of one point is zero to the last bit
    if kind in ("mass", "basic_mass"):
        rates[10 if kind == "mass" else 0] = 1.0
        value = properties.mass + (total.allowance if kind == "mass" else 0.0)
        return value, rates, error.mass * value
    if kind == "center_of_mass":
        axis = "xyz".index(which)
        rates[1 + axis] = 1.0
        return float(properties.center_of_mass[axis]), rates, error.center_of_mass
    if kind == "inertia":
        i, j = ("xyz".index(k) for k in which)
        rates[4 + _ELEMENTS.index((i, j))] = 1.0
        return float(properties.inertia[i, j]), rates, tensor_bound
    axes = principal(properties.inertia)
    a = axes.axes[:, int(which) - 1]
    rates[4:10] = [(1.0 if i == j else 2.0) * a[i] * a[j] for i, j in _ELEMENTS]
    return float(properties.principal_moments[int(which) - 1]), rates, tensor_bound


def _square(six: Float) -> Float:
    """Return (..., 3, 3) of the six second moments (..., 6)."""
    result = np.zeros((*six.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(_PLACES):
        result[..., i, j] = result[..., j, i] = six[..., k]
    return result


def _six(square: Float) -> Float:
    return np.stack([square[..., i, j] for i, j in _PLACES], axis=-1)


def _tensor(second: Float) -> Float:
    """Return the tensors tr(S) δ − S."""
    trace = np.trace(second, axis1=-2, axis2=-1)
    tensor: Float = trace[..., np.newaxis, np.newaxis] * np.eye(3) - second
    return tensor


def _matrix(elements: Float) -> Float:
    result = np.zeros((3, 3))
    for value, (i, j) in zip(elements.tolist(), _ELEMENTS, strict=True):
        result[i, j] = result[j, i] = value
    return result


def _root(variance: Float) -> Float:
    root: Float = np.sqrt(variance)
    return root
