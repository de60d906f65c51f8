"""Rounding of settings and angles to the shop's steps, together, so that they leave the least."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import angle_of
from inertia.balancing.corrections.disc_constrained_milp import Complex
from inertia.balancing.corrections.tool import Tool

_KEPT = 4096  # combinations followed up
_DECIMALS = 15  # of metres, kilograms and radians: 0.0124 rather than 0.012400000000000001


@dataclass(frozen=True)
class Place:
    """A tool at work: in plane number `plane`, at an angle (rad), with a setting (m, or kg) up to the limit there."""

    plane: int
    tool: Tool
    angle: float
    setting: float
    limit: float = math.inf

    @property
    def vector(self) -> complex:
        """What it adds to the unbalance in its plane, kg m."""
        return self.tool.sign * cmath.rect(self.tool.unbalance(self.setting), self.angle)


def rounded(places: Sequence[Place], levers: Float, residual: Complex, limits: Float) -> tuple[Place, ...]:
    """Round every setting and free angle up or down to the shop's steps, so that the residual is least.

    Up or down is chosen for all of them together: Σ (|r|/limit)² over the tolerance planes is least among all
    combinations, or, where these are more than 4096, among those that the best for the places before lead to.

    Parameters
    ----------
    places : as they should be
    levers : (t, n) what a unit vector in each correction plane adds in each tolerance plane
    residual : (t,) kg m, what is left before rounding
    limits : (t,) kg m
    """
    sums = (residual / limits)[None]
    ways: list[tuple[Place, ...]] = [()]
    for place in places:
        choices = _choices(place)
        moves = np.array([choice.vector - place.vector for choice in choices])
        weights = levers[:, place.plane] / limits
        sums = (sums[:, None] + moves[:, None] * weights).reshape(-1, len(limits))
        ways = [(*way, choice) for way in ways for choice in choices]
        best = np.argsort((np.abs(sums) ** 2).sum(axis=1), kind="stable")[:_KEPT]
        sums, ways = sums[best], [ways[k] for k in best.tolist()]
    return ways[0]


def _choices(place: Place) -> list[Place]:
    tool, plane = place.tool, place.tool.plane
    greatest = min(tool.greatest, place.limit)
    settings = {min(max(k, tool.least), greatest) for k in _beside(place.setting, tool.step, greatest)}
    angles = {place.angle}
    if plane.angles == "free":
        beside = {angle_of(cmath.rect(1.0, k)) for k in _beside(place.angle, plane.angle_step)}
        angles = {k for k in beside if not plane.forbids(k, tool.half_angle)} or angles
    return [replace(place, angle=angle, setting=setting) for angle in sorted(angles) for setting in sorted(settings)]


def _beside(value: float, step: float, greatest: float = math.inf) -> tuple[float, ...]:
    """Return the multiples of a step below and above a value, none above the greatest; the value where step is 0."""
    if not step:
        return (value,)
    below = math.floor(value / step)
    values = tuple(round(k * step, _DECIMALS) for k in (below, below + 1) if k * step <= greatest)
    return values or (value,)
