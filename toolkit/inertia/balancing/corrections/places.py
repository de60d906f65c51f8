"""What places of a plan do together: the vectors that they add, what is left, and whether one is in another's way."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import field
from functools import reduce
from time import thread_time

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import Steps, room_beside
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

Spot = tuple[int, int, int]
"""Steps, angle and setting of a place, by their numbers."""

FINE = 0.002
"""Share of the limit: plans that leave less than this are as good as each other."""

GAIN = 1e-9
"""Share by which a plan has to be better than another, and settings may be over their room: rounding."""


@dataclass(eq=False)
class Places:
    """What is open to a plan, and how long it may be looked for.

    Attributes
    ----------
    steps : of all planes
    gains : for each of the steps (s, t), what a unit vector at each setting does in the tolerance planes, over their
        limits: the deeper a hole along the shaft, the farther along the shaft it acts
    start : (t,) what is there, over the limits
    seconds : how long a search may take
    cut_short : whether the time was up
    """

    steps: Sequence[Steps]
    gains: Sequence[Complex]
    start: Complex
    seconds: float = math.inf
    cut_short: bool = field(default=False, init=False)
    _begun: float = field(default_factory=thread_time, init=False)
    _rooms: dict[tuple[int, Spot], Float] = field(default_factory=dict, init=False)
    _sizes: dict[int, Complex] = field(default_factory=dict, init=False)
    _directions: dict[int, Complex] = field(default_factory=dict, init=False)

    @property
    def elapsed(self) -> float:
        """Processor time (s) since the search began."""
        return thread_time() - self._begun

    def late(self) -> bool:
        """Say whether the time is up."""
        if self.elapsed > self.seconds:
            self.cut_short = True
        return self.cut_short

    def effect(self, spot: Spot) -> Complex:
        """Return what a place adds in the tolerance planes, over the limits."""
        k, a, s = spot
        effect: Complex = self._at_zero(k)[:, s] * self._turns(k)[a]
        return effect

    def effects(self, k: int, a: Int, s: Int) -> Complex:
        """Return what places (...,) of steps k add in the tolerance planes, (t, ...), over the limits."""
        effects: Complex = self._at_zero(k)[:, s] * self._turns(k)[a]
        return effects

    def _at_zero(self, k: int) -> Complex:
        """Return what the settings of steps k add at angle 0, (t, s)."""
        if k not in self._sizes:
            self._sizes[k] = np.ascontiguousarray((self.steps[k].sizes[:, None] * self.gains[k]).T)
        return self._sizes[k]

    def _turns(self, k: int) -> Complex:
        if k not in self._directions:
            self._directions[k] = np.exp(1j * self.steps[k].angles)
        return self._directions[k]

    def varies(self, k: int) -> bool:
        """Say whether settings of steps k act at different places along the shaft."""
        return bool(np.ptp(self.gains[k], axis=0).any())

    def vector(self, spot: Spot) -> complex:
        """Return what a place makes up in its plane, kg m."""
        k, a, s = spot
        return complex(self.steps[k].sizes[s] * np.exp(1j * self.steps[k].angles[a]))

    def middle(self, kinds: Iterable[int]) -> Complex:
        """Return what a unit vector of a plane does, (t,) over the limits: the mean of its steps' deepest settings."""
        gain: Complex = np.mean([self.gains[k][-1] for k in kinds], axis=0)
        return gain

    def sums(self, plans: Int) -> Complex:
        """Return what plans (p, n, 3) add in the tolerance planes, (p, t) over the limits."""
        total = np.zeros((len(self.start), len(plans)), complex)
        for k in np.unique(plans[..., 0]).tolist():
            steps = self.steps[k]
            effects = self.effects(k, plans[..., 1] % len(steps.angles), plans[..., 2] % len(steps.settings))
            total += np.where(plans[..., 0] == k, effects, 0).sum(axis=2)
        return total.T

    def rest(self, spots: Sequence[Spot]) -> Complex:
        """Return what is left with these places."""
        return sum((self.effect(k) for k in spots), self.start)

    def fits(self, spots: Sequence[Spot]) -> bool:
        """Say whether no place is in another's way."""
        return all(
            self.steps[k].settings[s] <= self.room(k, [*spots[:i], *spots[i + 1 :]])[a] + GAIN
            for i, (k, a, s) in enumerate(spots)
        )

    def room(self, k: int, others: Sequence[Spot]) -> Float:
        """Return the greatest setting at each angle beside other places."""
        steps = self.steps[k]
        room = steps.most
        for other in others:
            room = np.minimum(room, self.beside_one(k, other))
        if isinstance(steps.tool, WeightTool):
            room = np.where(self._taken(k, others), -math.inf, room)
        return room

    def beside_one(self, k: int, other: Spot) -> Float:
        """Return the greatest setting at each angle beside one other place."""
        if (k, other) not in self._rooms:
            there, a, s = other
            beside = self.steps[there]
            tool, angle, setting = beside.on_metal(a), float(beside.angles[a]), float(beside.settings[s])
            self._rooms[k, other] = room_beside(self.steps[k], tool, angle, setting)
        return self._rooms[k, other]

    def _taken(self, k: int, others: Sequence[Spot]) -> Bool:
        """Return where no more weights of a kind can be put."""
        steps = self.steps[k]
        tool = steps.tool
        assert isinstance(tool, WeightTool)
        used = Counter(float(self.steps[j].angles[a]) for j, a, _ in others if self.steps[j].plane == steps.plane)
        full = np.isin(steps.angles, [angle for angle, n in used.items() if n >= tool.plane.most_per_position])
        spent = tool.weight.stock is not None and sum(j == k for j, _, _ in others) >= tool.weight.stock
        return full | spent


def worst_of(rest: Complex) -> float:
    """Return the largest magnitude."""
    return float(np.abs(rest).max(initial=0.0))


def largest(vectors: Iterable[Complex]) -> Float:
    """Return the largest magnitude of arrays, place by place."""
    return reduce(np.maximum, (np.abs(each) for each in vectors))
