"""What changed from one budget to another, part by part, and what each change did to the whole."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal, TypeVar

import numpy as np

from inertia.arrays import Float
from inertia.assembly.budget import Budget
from inertia.assembly.limits import Limit
from inertia.assembly.lines import Line
from inertia.mass.tensor import point_inertia
from inertia.records import dataclass

_SAME = 1e-12  # of the whole: less is rounding
SPREAD = 1e-9
"""Of an uncertainty: less is rounding."""

Named = TypeVar("Named")


@dataclass(frozen=True, eq=False)
class Own:
    """What a line has beside the lines below it, all copies together; SI, about the origin of the whole.

    `spread` (11,) are its standard uncertainties, as of `Sigma.all`.
    """

    quantity: int
    mass: float
    predicted_mass: float
    first: Float
    tensor: Float
    spread: Float
    maturity: str | None = None
    category: str | None = None


@dataclass(frozen=True, eq=False)
class Change:
    """A part that is not as it was.

    Attributes
    ----------
    name : with those above it
    kind : what became of it
    old, new : what it has itself; None where it is not there
    center_of_mass : (3,) m, what this change alone does to that of the old whole
    inertia : (3, 3) kg m², what it does to the tensor about the centre of mass
    """

    name: str
    kind: Literal["added", "removed", "changed"]
    old: Own | None
    new: Own | None
    center_of_mass: Float
    inertia: Float

    @property
    def mass(self) -> float:
        """What it adds to the mass, kg."""
        return (self.new.mass if self.new else 0.0) - (self.old.mass if self.old else 0.0)

    @property
    def predicted_mass(self) -> float:
        """What it adds to the predicted mass, kg."""
        return (self.new.predicted_mass if self.new else 0.0) - (self.old.predicted_mass if self.old else 0.0)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two budgets, the parts that differ, those that change the mass most first, and the limits of both.

    Limits are the same that are on the same; None stands for one that is not there.
    """

    old: Budget
    new: Budget
    changes: tuple[Change, ...]
    limits: tuple[tuple[Limit | None, Limit | None], ...]


def compare(old: Budget, new: Budget) -> Comparison:
    """Return what changed; parts are the same that have the same names from the top down.

    >>> from inertia.assembly.document import Assembly
    >>> ball = {"name": "a", "shape": "point", "mass": 1.0}
    >>> one, two = (Assembly.from_dict({"unit": "m", "part": [ball, ball | {"name": "b", "at": [x, 0, 0]}]}).budget()
    ...             for x in (1, 3))
    >>> [(each.name, each.kind, each.center_of_mass[0].item()) for each in compare(one, two).changes]
    [('b', 'changed', 1.0)]
    """
    before, after = _named(_own(old.total)), _named(_own(new.total))
    whole = _summed(list(before.values()))
    size = float(np.abs(whole.tensor).max())
    changes = []
    for name in dict.fromkeys((*before, *after)):
        a, b = before.get(name), after.get(name)
        if a is not None and b is not None and _same(a, b, whole.mass, size):
            continue
        kind: Literal["added", "removed", "changed"] = "added" if a is None else "removed" if b is None else "changed"
        rest = [each for key, each in before.items() if key != name]
        center, tensor = _central(_summed([*rest, *([b] if b else [])]))
        was, stood = _central(whole)
        changes.append(Change(name, kind, a, b, center - was, tensor - stood))
    limits = [_named((limit.what, limit) for limit in budget.limits) for budget in (old, new)]
    return Comparison(
        old,
        new,
        tuple(sorted(changes, key=lambda each: (-abs(each.mass), each.name))),
        tuple((limits[0].get(what), limits[1].get(what)) for what in {**limits[0], **limits[1]}),
    )


def _named(lines: Iterable[tuple[str, Named]]) -> dict[str, Named]:
    """Return lines by name, those of a name that is there already numbered, as beside a nested file's own parts."""
    result: dict[str, Named] = {}
    for name, own in lines:
        key, number = name, 1
        while key in result:
            number += 1
            key = f"{name} ({number})"
        result[key] = own
    return result


def _own(line: Line, above: str = "") -> Iterator[tuple[str, Own]]:
    name = f"{above}{line.name}" if line.level else ""
    below = _summed([_all(child) for child in line.children])
    whole = _all(line)
    own = Own(
        line.quantity,
        whole.mass - below.mass,
        whole.predicted_mass - below.predicted_mass,
        whole.first - below.first,
        whole.tensor - below.tensor,
        line.own_sigma.all,
        line.maturity,
        line.category,
    )
    if abs(own.mass) > _SAME * whole.mass:
        yield name, own
    for child in line.children:
        yield from _own(child, f"{name}/" if name else "")


def _all(line: Line) -> Own:
    center = line.center_of_mass
    tensor = line.inertia + point_inertia(line.basic_mass, center)
    first = line.basic_mass * center
    return Own(line.quantity, line.basic_mass, line.predicted_mass, first, tensor, line.sigma.all)


def _summed(parts: list[Own]) -> Own:
    return Own(
        0,
        sum(part.mass for part in parts),
        sum(part.predicted_mass for part in parts),
        sum((part.first for part in parts), np.zeros(3)),
        sum((part.tensor for part in parts), np.zeros((3, 3))),
        np.zeros(11),
    )


def _central(whole: Own) -> tuple[Float, Float]:
    if not whole.mass:
        return np.zeros(3), np.zeros((3, 3))
    center = whole.first / whole.mass
    return center, whole.tensor - point_inertia(whole.mass, center)


def _same(a: Own, b: Own, mass: float, size: float) -> bool:
    length = (size / mass) ** 0.5 if mass else 0.0
    least = _SAME * np.array([mass, *3 * [length], *6 * [size], mass])
    return (
        (a.quantity, a.maturity, a.category) == (b.quantity, b.maturity, b.category)
        and abs(a.mass - b.mass) <= _SAME * mass
        and abs(a.predicted_mass - b.predicted_mass) <= _SAME * mass
        and float(np.abs(a.tensor - b.tensor).max()) <= _SAME * size
        and float(np.abs(a.first - b.first).max()) <= _SAME * (mass * size) ** 0.5
        and bool((np.abs(a.spread - b.spread) <= least + SPREAD * np.maximum(a.spread, b.spread)).all())
    )
