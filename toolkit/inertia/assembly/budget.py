"""`Budget`: what each part of an assembly contributes, with allowances and standard uncertainties, against its limits.

Basic mass is what the parts have now, predicted mass what they are expected to grow to: basic mass and mass growth
allowance (terms of ANSI/AIAA S-120A; ISO 22010). Uncertainties are propagated to first order (JCGM 100:2008, 5.1.2):
the ten moments of the whole are sums over parts, so that a change of one input moves them by what `inertia.assembly.
bodies` says, turned and shifted to the place of each copy; inputs of one source move together, others by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.assembly.allowances import EXAMPLE, allowance_of
from inertia.assembly.frames import LENGTH_BITS, Frame
from inertia.assembly.inputs import Input, Source
from inertia.assembly.limits import Limit, Verdict, judged
from inertia.assembly.lines import Line, Sigma, central_of, six_of, square
from inertia.assembly.rollup import Placed
from inertia.assembly.tree import Node, PartTree
from inertia.errors import UsageError, placed, visible
from inertia.mass.integrand import ELEMENTS
from inertia.mass.properties import MassProperties
from inertia.mesh.turns import TURN_BITS
from inertia.records import dataclass

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CHUNK = 4096


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

    @property
    def columns(self) -> dict[str, list[Any]]:
        """A table with a row a line, as data frames take it: SI, in the axes of the whole; u: standard uncertainties.

        A part's name has those above it before it.
        """
        lines = list(_named(self.total, ""))
        columns: dict[str, list[Any]] = {"part": [name for name, _ in lines]}
        for name in ("level", "quantity", "category", "maturity", "basic_mass", "allowance", "predicted_mass"):
            columns[name] = [getattr(line, name) for _, line in lines]
        _spread(columns, "", [line for _, line in lines])
        for name in ("mass", "predicted_mass"):
            columns[f"u_{name}"] = [getattr(line.sigma, name) for _, line in lines]
        _spread(columns, "u_", [line.sigma for _, line in lines])
        return columns

    def plot(self, ax: Axes | None = None) -> Figure:
        """Draw the mass of each part of the first level, with its allowance, and return the figure.

        Raises `UsageError` where matplotlib is not installed.
        """
        from inertia.palette import BLUE, ORANGE
        from inertia.plotting import figure_of

        lines = (self.total.children or (self.total,))[::-1]

        def draw(axes: Axes) -> None:
            names, basic = [visible(line.name) for line in lines], [line.basic_mass for line in lines]
            places = range(len(lines))
            axes.barh(places, basic, color=BLUE, label="basic mass")
            axes.barh(places, [line.allowance for line in lines], left=basic, color=ORANGE, label="allowance")
            axes.set_yticks(places, names)
            axes.set_xlabel("kg")
            axes.legend(fontsize=8)

        return figure_of(draw, ax, f"{self.assembly.name}: {self.total.predicted_mass:.6g} kg predicted")

    def _repr_html_(self) -> str:
        """Return a small table and a sketch of the equivalent ellipsoid, as a notebook shows them."""
        from inertia.notebook import ellipsoid_svg, html_of

        total = self.total
        rows = [
            ("Budget", f"{self.assembly.name}: {self.verdict or 'no limits are stated'}"),
            ("Predicted mass", f"{total.predicted_mass:.10g} kg ± {total.sigma.predicted_mass:.2g} kg, "
                               f"of which {total.allowance:.6g} kg allowance"),
            *self.properties.rows()[2:],
            *((f"Limit {limit.what}", f"{limit.value:.6g}: {limit.verdict}") for limit in self.limits),
            *(("Note", note) for note in self.notes),
        ]  # fmt: skip
        return html_of(rows, ellipsoid_svg(self.properties.equivalent_ellipsoid, self.properties.principal.axes))


def _named(line: Line, above: str) -> Iterator[tuple[str, Line]]:
    name = f"{above}{line.name}"
    yield name, line
    for child in line.children:
        yield from _named(child, f"{name}/" if line.level else "")


def _spread(columns: dict[str, list[Any]], prefix: str, lines: Sequence[Line | Sigma]) -> None:
    """Add the centres of mass and the tensors of lines, a column a component."""
    for k, axis in enumerate("xyz"):
        columns[f"{prefix}com_{axis}"] = [float(line.center_of_mass[k]) for line in lines]
    for j, k in ELEMENTS:
        columns[f"{prefix}i{'xyz'[j]}{'xyz'[k]}"] = [float(line.inertia[j, k]) for line in lines]


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
    limits = tuple(judged(each, total, places.properties, assembly) for each in assembly.fields.limit)
    notes = [*assembly.notes, *lines.large]
    if lines.immature and any(line.maturity for line in total.lines()):
        few = ", ".join(lines.immature[:3]) + (" …" if len(lines.immature) > 3 else "")
        notes.append(f"{len(lines.immature)} parts state no maturity and have no allowance: {few}")
    return Budget(assembly, places.properties, total, limits, tuple(notes))


class _Lines:
    """Builds the lines, from the bottom to the top."""

    def __init__(self, assembly: PartTree, places: Placed) -> None:
        self.immature: list[str] = []
        self.large: list[str] = []
        self._assembly, self._places = assembly, places
        self._table = {**EXAMPLE, **(assembly.fields.allowances or {})}
        self._frames = dict(assembly.in_places())
        self._start = 0

    def total(self) -> Line:
        """Return the line of the whole."""
        return self._line(self._assembly.root, 0, (None, None, None))[0]

    def _line(
        self, node: Node, level: int, above: tuple[float | None, str | None, str | None]
    ) -> tuple[Line, Float, dict[Source, Float]]:
        """Return a line, the moments (n, 10) of each copy, and the changes (k, 11) for each source."""
        frames, fields = self._frames[node], node.fields
        own, maturity, category = above
        if fields is not None:
            own = own if fields.allowance is None and fields.maturity is None else fields.allowance
            maturity, category = fields.maturity or maturity, fields.category or category
        moments = np.zeros((len(frames), 10))
        changes: dict[Source, Float] = {}
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
            elif share > 1:
                self.large.append(
                    f"{node.name}: its mass growth allowance is {100 * share:g} % of its basic mass: allowances are "
                    "parts of it, 0.15 for 15 %"
                )
            allowance = (share or 0.0) * float(moments[:, 0].sum())
            for each in node.body.inputs:
                _add(changes, each.source, _grown(self._placed(each, frames, moments), share or 0.0))
        alone = moments.copy(), dict(changes)
        for child in node.children:
            line, inner, moved = self._line(child, level + 1, (own, maturity, category))
            children.append(line)
            moments += inner.reshape(len(frames), -1, 10).sum(axis=1)
            allowance += line.allowance
            for source, change in moved.items():
                _add(changes, source, change)
        whole = moments.sum(axis=0)
        center, tensor, sigma = central_of(whole, self._with_misplaced(node, frames, moments, changes))
        own_sigma = central_of(alone[0].sum(axis=0), self._with_misplaced(node, frames, *alone))[2]
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
            own_sigma,
            _misplacement(node),
            tuple(children),
        )
        return line, moments, changes

    def _placed(self, one: Input, frames: Sequence[Frame], moments: Float) -> Float:
        """Return the change of all copies together."""
        offsets = moments[:, 1:4] / moments[:, :1]
        result = np.zeros((len(one.change), 10))
        mass, first = one.change[:, 0], one.change[:, 1:4]
        second = square(one.change[:, 4:])
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
            result[:, 4:] += six_of(s)
        return result

    def _with_misplaced(
        self, node: Node, frames: Sequence[Frame], moments: Float, changes: dict[Source, Float]
    ) -> dict[Source, Float]:
        """Add the changes for each copy being misplaced to those of its inputs, and return them."""
        for what, change in self._misplaced(node, frames, moments):
            changes[Source(what, node.owner, node)] = _grown(change, 0.0)
        return changes

    def _misplaced(self, node: Node, frames: Sequence[Frame], moments: Float) -> Iterator[tuple[str, Float]]:
        """Yield the changes for each copy by itself being moved, and turned about its origin."""
        place, angle = _misplacement(node)
        mass, first, second = moments[:, 0], moments[:, 1:4], square(moments[:, 4:])
        if place:
            change = np.zeros((len(frames), 3, 10))
            for k, e in enumerate(np.eye(3)):
                change[:, k, 1:4] = mass[:, np.newaxis] * e
                along = np.einsum("i,nj->nij", e, first)
                change[:, k, 4:] = six_of(along + along.swapaxes(1, 2))
            yield "position", place * change.reshape(-1, 10)
        if angle:
            origins = np.array([[k / (1 << LENGTH_BITS) for k in frame.origin] for frame in frames])
            away = first - mass[:, np.newaxis] * (origins - self._places.center)  # ∫x seen from the origin
            outer = second - np.einsum("ni,nj->nij", origins - self._places.center, first)  # ∫(x − o) xᵀ
            change = np.zeros((len(frames), 3, 10))
            for k, e in enumerate(np.eye(3)):
                cross = np.cross(np.eye(3), e)  # its rows are such that cross @ x = e × x
                change[:, k, 1:4] = away @ cross.T
                turned = np.einsum("ij,njk->nik", cross, outer)
                change[:, k, 4:] = six_of(turned + turned.swapaxes(1, 2))
            yield "angle", angle * change.reshape(-1, 10)


def _misplacement(node: Node) -> tuple[float, float]:
    """Return the standard uncertainties of the place, m, and of the turns, rad, that a part states."""
    if node.fields is None:
        return 0.0, 0.0
    place, angle = node.fields.position_uncertainty or 0.0, node.fields.angle_uncertainty or 0.0
    return float(node.unit.metres) * place, math.radians(angle)


def _add(changes: dict[Source, Float], source: Source, change: Float) -> None:
    changes[source] = changes[source] + change if source in changes else change


def _grown(change: Float, allowance: float) -> Float:
    """Return changes with that of the predicted mass beside them."""
    return np.concatenate([change, (1.0 + allowance) * change[:, :1]], axis=1)
