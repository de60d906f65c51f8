"""What the uncertain figures of an assembly are of: by that they are told apart, and named."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Literal, NamedTuple

from inertia.arrays import Float

Kind = Literal["part", "material", "scale_of"]


class Owner(NamedTuple):
    """What a figure is stated of.

    Attributes
    ----------
    name : of it
    file : that it is from, as the assembly at the top names it; "" of that one itself
    kind : what has that name: a part, a material, or a scale that parts share
    """

    name: str
    file: str = ""
    kind: Kind = "part"

    @property
    def label(self) -> str:
        """The name, with the file where that is not the one at the top."""
        return f"{self.name} ({self.file})" if self.file else self.name


class Source(NamedTuple):
    """A figure that is uncertain: equal ones are one figure, wherever they stand.

    Attributes
    ----------
    what : the figure, as "mass"
    owner : what it is stated of
    place : in the tree, of a figure that is each place's own; None of one that is common to all of its owner
    """

    what: str
    owner: Owner
    place: object = None


class Input(NamedTuple):
    """An uncertain input of a part.

    Attributes
    ----------
    source : inputs of one source are one, wherever they stand
    change : (k, 10) of the ten moments for one standard uncertainty of each of k independent figures
    """

    source: Source
    change: Float


def labels_of(figures: Iterable[tuple[str, Owner]]) -> tuple[str, ...]:
    """Return what figures are called, each by what it is and its owner; kinds are said where two would be alike.

    >>> steel = Owner("steel"), Owner("steel", kind="material")
    >>> labels_of([*(("density", each) for each in steel), ("mass", Owner("p", "a.toml"))])
    ('density of steel (part)', 'density of steel (material)', 'mass of p (a.toml)')
    """
    called = [(f"{what} of {owner.label}", owner.kind) for what, owner in figures]
    counts = Counter(label for label, _ in called)
    return tuple(f"{label} ({kind})" if counts[label] > 1 else label for label, kind in called)
