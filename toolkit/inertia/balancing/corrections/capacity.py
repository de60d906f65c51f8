"""What so many places of a plane can do at best, whatever their angles and settings are.

What n places of a plane do in the tolerance planes lies in a convex set. Its extent in a direction is the largest
Σ Re(cᵢ exp(iθᵢ)) over n places that keep their distances, cᵢ being what the setting of place i does in that direction
at angle 0. That is found going once around, place after place, with the settings in a few classes: a place counts with
the best setting of its class, and keeps the distance of the smallest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import field
from functools import cached_property

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.corrections.milling import ArcCutter
from inertia.balancing.corrections.places import Places
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import Steps
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

_DIRECTIONS = 36
_CLASSES = 5
_MOST_CLASSES = 16
_KNOTS = 9  # settings of a class that are looked at one by one
_MOST_PLACES = 64
_GROWS = 1e-9
_PAST = 1e-4  # of the extent in a direction: nothing is gained by adding it
_NO_LEVER = 1e-9  # of what a unit vector does: rounding


@dataclass(eq=False)
class Capacity:
    """How far 0, 1, ... places of a plane reach, in coordinates (b,) of what they do in the tolerance planes.

    Where all settings act at one place along the shaft, what they do is a vector times one basis; where their levers
    differ, a second coordinate says how much. A direction d (b,) is for Re(d·x).

    Attributes
    ----------
    basis : (t, b), over the limits
    settings : of each of the steps (s, b), what each setting does at angle 0
    enough : kg m, farther it is not known
    directions : (r, b)
    reach : of each direction, with 0, 1, ... places as many as add something
    """

    steps: Sequence[Steps]
    basis: Complex
    settings: Sequence[Complex]
    enough: float
    directions: list[Complex] = field(default_factory=list, init=False)
    reach: list[Float] = field(default_factory=list, init=False)

    @classmethod
    def of(cls, places: Places, kinds: Sequence[int], enough: float) -> Capacity:
        """Return the capacity of a plane in all directions of its vectors.

        Parameters
        ----------
        kinds : numbers of the plane's steps
        enough : kg m, farther it need not be known where levers do not differ
        """
        gain = places.middle(kinds)
        size = float(np.linalg.norm(gain))
        turned = np.linalg.qr(gain[:, None], mode="complete")[0]
        parts = [(places.gains[k] @ turned.conj()) for k in kinds]
        across = max(float(np.abs(part[:, 1:]).max(initial=0.0)) for part in parts)
        basis = gain[:, None]
        if across > _NO_LEVER * size:
            basis = np.hstack([basis, across * turned[:, 1:]])
        inverse = np.linalg.pinv(basis).T
        steps = [places.steps[k] for k in kinds]
        settings = [
            np.maximum(each.sizes, 0.0)[:, None] * (places.gains[k] @ inverse)
            for k, each in zip(kinds, steps, strict=True)
        ]
        self = cls(steps, basis, settings, enough if basis.shape[1] == 1 else math.inf)
        self._add_around()
        return self

    @property
    def varies(self) -> bool:
        """Whether the levers of its settings differ."""
        return len(self.basis[0]) > 1

    @property
    def most(self) -> int:
        """Places that reach farther than fewer of them, or far enough."""
        return max(len(k) for k in self.reach) - 1

    def rows(self, number: int) -> tuple[Complex, Float]:
        """Return all directions (r, b), and how far so many places reach in each."""
        return np.array(self.directions), np.array([k[min(number, len(k) - 1)] for k in self.reach])

    def add_where_past(self, direction: Complex, at: Complex, number: int, times: float = 1.0) -> bool:
        """Add a direction (b,) in which so many places do not reach as far as a point (b,), and say whether it is one.

        Parameters
        ----------
        times : how many times as far they are taken to reach
        """
        reach = self._along(direction)
        most = times * float(reach[min(number, len(reach) - 1)])
        past = float((direction @ at).real) > most + _PAST * abs(most)
        if past:
            self.directions.append(direction)
            self.reach.append(reach)
        return past

    @cached_property
    def _classes(self) -> _Classes:
        return _classes(self.steps)

    def _along(self, direction: Complex) -> Float:
        """Return how far 0, 1, ... places reach in a direction: as many as add something, or reach far enough."""
        along = [each @ direction for each in self.settings]
        plane = self.steps[0].tool.plane
        if plane.method == "kit" and plane.angles != "free":
            return _of_weights(self.steps, along, self.enough)
        return _of_places(self.steps, along, self.enough, self._classes)

    def _add_around(self) -> None:
        plane = self.steps[0].tool.plane
        rooms = [k.most for k in self.steps if np.isfinite(k.most).any()]
        alike = plane.angles == "free" and all(np.ptp(k) == 0 for k in rooms)
        turns = np.exp(-1j * FULL_TURN * np.arange(_DIRECTIONS) / _DIRECTIONS)
        for unit in np.eye(self.basis.shape[1]):
            reach = [self._along(turn * unit) for turn in turns[: 1 if alike else None].tolist()]
            self.reach += _DIRECTIONS * reach if alike else reach
            self.directions += list(np.outer(turns, unit))


@dataclass(frozen=True, eq=False)
class _Classes:
    """Settings in classes: of which steps, first and last; what class each counts as, and how far two keep apart."""

    of: list[tuple[int, int, int]]
    group: Int
    gaps: Float


def _classes(steps: Sequence[Steps]) -> _Classes:
    of: list[tuple[int, int, int]] = []
    sines: list[list[float]] = []
    for number, each in enumerate(steps):
        ends = np.unique(np.linspace(0, len(each.settings), min(_CLASSES, len(each.settings)) + 1).astype(int))
        of += [(number, low, high) for low, high in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)]
    shallow = [float(steps[n].settings[low]) for n, low, _ in of]
    for n, _, _ in of:
        tool = steps[n].tool
        own = isinstance(tool, ArcCutter)  # holes that run towards the shaft may be nearer beside one less deep
        settings = [shallow[len(sines)]] * len(of) if own else np.minimum(shallow, shallow[len(sines)]).tolist()
        apart = {k: math.sin(min(0.5 * tool.apart_at(min(k, tool.greatest)), 0.5 * math.pi)) for k in set(settings)}
        sines.append([apart[k] for k in settings])
    halves = np.array(sines)
    gaps = 2.0 * np.arcsin(np.minimum(0.5 * (halves + halves.T), 1.0))
    group = np.arange(len(of))
    if len(of) > _MOST_CLASSES:
        # Classes that are nearly as wide count as one, with the unbalance of the largest and the distance of the least.
        order = np.argsort(halves.diagonal(), kind="stable")
        group[order] = np.arange(len(of)) * _MOST_CLASSES // len(of)
        merged = np.full((_MOST_CLASSES, _MOST_CLASSES), math.inf)
        np.minimum.at(merged, (group[:, None], group[None, :]), gaps)
        gaps = merged
    return _Classes(of, group, gaps)


def _of_weights(steps: Sequence[Steps], along: Sequence[Complex], enough: float) -> Float:
    most, values, best = steps[0].tool.plane.most_per_position, [], np.zeros(len(steps[0].angles))
    for each, (unit, *_) in zip(steps, along, strict=True):
        value = np.where(np.isfinite(each.most), (unit * np.exp(1j * each.angles)).real, 0.0)
        best = np.maximum(best, value)
        assert isinstance(each.tool, WeightTool)
        values.append(_largest(np.repeat(value, most))[: each.tool.weight.stock])
    # No more of a kind than there are, and no more at a position than go there.
    reach = np.minimum(_summed(np.concatenate(values)), _summed(np.repeat(best, most)))
    last = int(np.searchsorted(reach, min(enough, float(reach[-1]))))
    return reach[: last + 1]


def _summed(values: Float) -> Float:
    """Return the sums of the 0, 1, ... 64 largest values; what is below 0 counts as 0."""
    best = _largest(values)[:_MOST_PLACES]
    return np.concatenate([[0.0], np.cumsum(np.pad(best, (0, _MOST_PLACES - len(best))))])


def _largest(values: Float) -> Float:
    return np.sort(np.maximum(values, 0.0))[::-1]


def _of_places(steps: Sequence[Steps], along: Sequence[Complex], enough: float, classes: _Classes) -> Float:
    deepest = max((k[-1] for k in along), key=abs)
    relative = (steps[0].angles + np.angle(deepest) + math.pi) % FULL_TURN - math.pi
    order = np.argsort(relative, kind="stable")
    if all(_one_way(k, deepest) for k in along):
        order = order[np.abs(relative[order]) < 0.5 * math.pi]
    turns = np.exp(1j * steps[0].angles[order])
    count = len(classes.gaps)
    value = np.full((len(order), count), -math.inf)
    for (number, low, high), group in zip(classes.of, classes.group.tolist(), strict=True):
        each = steps[number]
        last = np.searchsorted(each.settings, each.most[order] + 1e-9, side="right") - 1
        best = _best_of(along[number], low, np.clip(last, low, high - 1), turns)
        value[:, group] = np.maximum(value[:, group], np.where(last >= low, best, -math.inf))
    useful = (value > 0).any(axis=1)
    value, angles = value[useful], relative[order][useful]
    if not len(angles):
        return np.zeros(1)
    # Of each class of the place before, for all angles and classes: where to look in `upto`.
    before = np.searchsorted(angles, angles[:, None] - classes.gaps.T[:, None] + 1e-9, side="right")
    before = before * count + np.arange(count)[:, None, None]
    best, reach = value, [0.0]
    for _ in range(_MOST_PLACES):
        most = float(best.max())
        if most <= reach[-1] * (1 + _GROWS):
            break
        reach.append(most)
        if most > enough:
            break
        upto = np.vstack([np.full(count, -math.inf), np.maximum.accumulate(best, axis=0)])
        best = value + np.take(upto, before).max(axis=0)
    return np.array(reach)


def _one_way(along: Complex, way: complex) -> bool:
    """Say whether settings reach the farther in a direction the larger they are, and none to its side."""
    turned = along * np.conj(way)
    rounding = 1e-12 * np.abs(turned).max()
    along_it = np.diff(turned.real, prepend=0.0)
    return bool((np.abs(turned.imag) <= rounding).all() and (along_it >= -rounding).all())


def _best_of(along: Complex, low: int, last: Int, turns: Complex) -> Float:
    """Return the most that settings from `low` to a last one reach at angles (m,).

    What some of them do is a polygon, over whose chords the others do no more than is added.
    """
    if _one_way(along, along[-1]):
        return (along[last] * turns).real
    knots = np.unique(np.linspace(low, max(int(last.max()), low), _KNOTS).astype(int))
    between = np.arange(knots[0], knots[-1] + 1)
    chords = np.interp(between, knots, along[knots].real) + 1j * np.interp(between, knots, along[knots].imag)
    over = float(np.abs(along[between] - chords).max())
    best = np.maximum.accumulate(np.outer(along[knots], turns).real, axis=0)
    reach: Float = best[np.searchsorted(knots, last, side="right") - 1, np.arange(len(turns))]
    return np.maximum(reach, (along[last] * turns).real) + over
