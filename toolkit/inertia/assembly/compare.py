"""What changed from one budget to another, part by part, and what each change did to the whole."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal

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


@dataclass(frozen=True, eq=False)
class Own:
    """What a line has beside the lines below it, all copies together; SI, about the origin of the whole.

    `spread` (11,) are its standard uncertainties, as of `Sigma.all`, `misplacement` those of its place, m, and of its
    turns, rad. A group, which has lines below it alone, has no mass, maturity or category of its own.
    """

    quantity: int
    mass: float
    predicted_mass: float
    first: Float
    tensor: Float
    spread: Float
    misplacement: tuple[float, float] = (0.0, 0.0)
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

    Limits are the same that are on the same, equal ones first; None stands for one that is not there.
    """

    old: Budget
    new: Budget
    changes: tuple[Change, ...]
    limits: tuple[tuple[Limit | None, Limit | None], ...]

    @property
    def rounding(self) -> Float:
        """What is rounding in the figures of `Own.spread`, (11,)."""
        whole = _all(self.old.total)
        return _least(whole.mass, float(np.abs(whole.tensor).max()))

    @property
    def is_as_sure(self) -> bool:
        """Whether the figures of both wholes have the same standard uncertainties, and vary together as much."""
        a, b = (each.total.sigma for each in (self.old, self.new))
        u = np.maximum(a.all, b.all)
        off = self.rounding + SPREAD * u
        nothing = np.outer(u + off, u + off) - np.outer(u, u)
        return bool((np.abs(a.changes.T @ a.changes - b.changes.T @ b.changes) <= nothing).all())


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
        if (a is None and b is not None and not b.mass) or (b is None and a is not None and not a.mass):
            continue  # a group: the parts in it tell
        if a is not None and b is not None and _same(a, b, whole.mass, size):
            continue
        kind: Literal["added", "removed", "changed"] = "added" if a is None else "removed" if b is None else "changed"
        rest = [each for key, each in before.items() if key != name]
        center, tensor = _central(_summed([*rest, *([b] if b else [])]))
        was, stood = _central(whole)
        changes.append(Change(name, kind, a, b, center - was, tensor - stood))
    return Comparison(
        old,
        new,
        tuple(sorted(changes, key=lambda each: (-abs(each.mass), each.name))),
        tuple(_paired(old.limits, new.limits)),
    )


def _paired(old: Sequence[Limit], new: Sequence[Limit]) -> Iterator[tuple[Limit | None, Limit | None]]:
    rest, pairs = list(new), {}
    for equal in (True, False):
        for k, limit in enumerate(old):
            bounds = limit.low, limit.high
            same = (one for one in rest if one.what == limit.what and (not equal or (one.low, one.high) == bounds))
            if k not in pairs and (one := next(same, None)):
                pairs[k] = one
                rest.remove(one)
    yield from ((limit, pairs.get(k)) for k, limit in enumerate(old))
    yield from ((None, limit) for limit in rest)


def _named(lines: Iterable[tuple[str, Own]]) -> dict[str, Own]:
    """Return lines by name, those of a name that is there already numbered, as beside a nested file's own parts."""
    result: dict[str, Own] = {}
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
        line.misplacement,
        line.maturity,
        line.category,
    )
    if abs(own.mass) <= _SAME * whole.mass:
        own = replace(_summed([]), quantity=line.quantity, misplacement=line.misplacement)
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
    if not np.allclose(a.misplacement, b.misplacement, rtol=SPREAD, atol=0.0):
        return False
    if not a.mass and not b.mass:  # a group: of its quantity the parts in it tell
        return True
    least = _least(mass, size)
    return (
        (a.quantity, a.maturity, a.category) == (b.quantity, b.maturity, b.category)
        and abs(a.mass - b.mass) <= _SAME * mass
        and abs(a.predicted_mass - b.predicted_mass) <= _SAME * mass
        and float(np.abs(a.tensor - b.tensor).max()) <= _SAME * size
        and float(np.abs(a.first - b.first).max()) <= _SAME * (mass * size) ** 0.5
        and bool((np.abs(a.spread - b.spread) <= least + SPREAD * np.maximum(a.spread, b.spread)).all())
    )


def _least(mass: float, size: float) -> Float:
    """Return what is rounding in the eleven figures of `Sigma.all`, (11,)."""
    length = (size / mass) ** 0.5 if mass else 0.0
    least: Float = _SAME * np.array([mass, *3 * [length], *6 * [size], mass])
    return least
