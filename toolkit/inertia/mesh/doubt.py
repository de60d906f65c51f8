"""`Doubt`: volume that a solid may have or not have, place by place."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from inertia.arrays import Float
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Doubt:
    """Volume that a solid may have or not have, around k places; file units.

    It is what lies between a surface that was made up and the one that was lost, or what counts more than once.

    Attributes
    ----------
    places : (k, 3)
    outward, inward : (k,), volumes that the solid may have more, and less
    reach : (k,), root mean square of how far from its place that is, if it is all there
    either : (k,), volumes that may be one or the other, in all; the sum of both unless that is more than there is
    """

    places: Float
    outward: Float
    inward: Float
    reach: Float
    either: Float = None  # type: ignore[assignment]  # made of the others

    def __post_init__(self) -> None:
        """Add up both sides where their sum is not given."""
        if self.either is None:
            object.__setattr__(self, "either", self.outward + self.inward)

    @classmethod
    def joined(cls, doubts: Iterable[Doubt | None]) -> Doubt | None:
        """Return all of them together, if there are any."""
        columns = [(one.places, one.outward, one.inward, one.reach, one.either) for one in doubts if one is not None]
        return cls(*map(np.concatenate, zip(*columns, strict=True))) if columns else None

    @classmethod
    def anywhere_in(cls, simplices: Float, thickness: Float | float = 0.0) -> Doubt:
        """Return the doubt about all that lies in tetrahedra (k, 4, 3), or within a thickness of triangles (k, 3, 3).

        Within h of a triangle of area A and perimeter P, a surface whose corners move there sweeps at most
        h (A + h P + 2 h²); h is (k,) or one for all.
        """
        count = simplices.shape[1]
        places = simplices.mean(axis=1)
        sides = simplices[:, 1:] - simplices[:, :1]
        across = np.cross(sides[:, 0], sides[:, 1])
        spread = np.sqrt(((simplices - places[:, None]) ** 2).sum(axis=(1, 2)) / (count * (count + 1)))
        if count == 4:
            volume = np.abs(np.einsum("ij,ij->i", across, sides[:, 2])) / 6
        else:
            perimeter = np.linalg.norm(simplices - np.roll(simplices, 1, axis=1), axis=2).sum(axis=1)
            volume = thickness * (np.linalg.norm(across, axis=1) / 2 + thickness * perimeter + 2 * thickness**2)
            spread = np.sqrt(((simplices - places[:, None]) ** 2).sum(axis=2).max(axis=1)) + thickness
        return cls(places, volume, volume, spread, volume)

    @classmethod
    def within(cls, box: Float, outward: float, inward: float) -> Doubt:
        """Return the doubt about volumes somewhere in a box (2, 3)."""
        half = (box[1] - box[0]) / 2
        return cls((box[0] + half)[None], np.array([outward]), np.array([inward]), np.array([np.linalg.norm(half)]))

    @property
    def volume(self) -> float:
        """The volume that there may be more or less, in all."""
        return float(max(self.outward.sum(), self.inward.sum()))

    def either_way(self) -> Doubt:
        """Return the doubt about a surface whose winding is not known."""
        most = np.maximum(self.outward, self.inward)
        return Doubt(self.places, most, most, self.reach, self.either)


@dataclass(frozen=True, eq=False)
class Guess:
    """What was changed of a surface without being known, the code of its fault, how many there were, and the doubt."""

    what: str
    code: str
    count: int
    doubt: Doubt
