"""Standard weights at positions such as blades, bolts or threaded holes: which, where, and how many.

Whole numbers nⱼ of weights, each with a known effect eⱼ on the vectors in the tolerance planes, are added to the
vectors r that are there. Either the *fewest* weights with |r + Σ eⱼ nⱼ| within the tolerance in every plane, and of
those choices the one with the smallest residual; or the *smallest residual*, and of those choices the fewest weights.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float, Int
from inertia.balancing.corrections.correction_plane import CorrectionPlane, KitWeight, angle_of
from inertia.balancing.corrections.disc_constrained_milp import Complex, Effort, Program, UnsettledError
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.tool import Tool
from inertia.records import dataclass

_SAFE = 1e-5  # of a tolerance, kept from its limit for what rounding may do
_LEEWAY = 4e-6  # of the unit that residuals are measured in
_NODES = 500  # of one search for a smallest residual: some tenths of a second


def weight_operation(plane: CorrectionPlane, name: str, angle: float, weight: KitWeight, pieces: int) -> Operation:
    """Return the putting of some weights of one kind at a position (rad)."""
    mass = pieces * weight.mass
    radius = weight.radius or plane.radius
    return Operation(
        id=name,
        plane=plane.id,
        z=plane.z,
        method="add",
        kind="weight",
        angle=angle_of(cmath.rect(1.0, angle)),
        radius=radius,
        mass=mass,
        unbalance=cmath.rect(mass * radius, angle),
        unbalance_z=plane.z,
        pieces=pieces,
        item=weight.name,
    )


@dataclass(frozen=True, kw_only=True)
class WeightTool(Tool):
    """One kind of weight of a kit, set in pieces: one at a time."""

    weight: KitWeight

    @property
    def step(self) -> float:
        """One."""
        return 1.0

    @property
    def least(self) -> float:
        """One."""
        return 1.0

    @property
    def greatest(self) -> float:
        """One."""
        return 1.0

    def half_angle_at(self, setting: float) -> float:
        """Half of its width; 0 at positions that are there for it."""
        return 0.5 * (self.weight.width or 0.0) / self.plane.radius

    def apart_at(self, setting: float) -> float:
        """Its width on a track; 0 at positions that are there for it."""
        return min(2 * self.half_angle_at(setting), math.pi) if self.plane.angles == "free" else 0.0

    def unbalance(self, setting: float) -> float:
        """Return m r of so many, kg m."""
        return setting * self.weight.mass * (self.weight.radius or self.plane.radius)

    def setting(self, unbalance: float) -> float:
        """Return how many."""
        return unbalance / (self.weight.mass * (self.weight.radius or self.plane.radius))

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the putting of so many at an angle (rad)."""
        return weight_operation(self.plane, name, angle, self.weight, round(setting))


@dataclass(frozen=True, eq=False)
class WeightChoice:
    """Numbers of weights (n,), what the free planes do besides (f,), and the vectors (t,) that are left."""

    counts: Int
    free: Complex
    residual: Complex
    within: bool


def choose_weights(
    effects: ArrayLike,
    start: ArrayLike,
    limits: ArrayLike,
    most: ArrayLike,
    groups: Sequence[tuple[Sequence[int], int]] = (),
    *,
    free: ArrayLike | None = None,
    aim: Literal["fewest", "smallest"] = "fewest",
    largest: ArrayLike = math.inf,
    effort: Effort | None = None,
) -> WeightChoice:
    """Choose weights.

    Parameters
    ----------
    effects : (t, n) complex, what one weight of each kind and place adds in each tolerance plane
    start : (t,) complex, what is there
    limits : (t,) tolerances, in the same unit; the residual counts in proportion to them
    most : (n,) how many there may be of each
    groups : (places in n, how many of them together at most): the weights of one position, or of one stock
    free : (t, f) complex, what a unit correction in planes without steps adds: those make up for what weights leave
    aim : "fewest" weights within the limits, or "smallest" residual; the latter also where no choice is within
    largest : (t,) sizes of what the weights may add, in the same unit
    effort : what the searches for the smallest residual have together; without it, each its own

    >>> turns = np.exp(1j * np.radians([0, 90, 180, 270]))
    >>> choice = choose_weights([10 * turns], [-20 - 9j], [2.0], [3] * 4)
    >>> choice.counts.tolist(), choice.within
    ([2, 1, 0, 0], True)
    """
    weights = np.atleast_2d(np.asarray(effects, complex))
    vectors, tolerances = np.asarray(start, complex), np.asarray(limits, float)
    count = weights.shape[1]
    others = np.zeros((len(vectors), 0), complex) if free is None else np.asarray(free, complex)
    columns = np.hstack([weights, others, 1j * others])
    unit = _unit(weights / tolerances[:, None])
    # In units of a typical weight's effect, so that the solver's own tolerances mean something.
    scale = unit * tolerances
    program = _WeightProgram(
        np.divide(columns, scale[:, None]),
        np.divide(vectors, scale),
        np.asarray(most, float),
        tuple(groups),
        np.divide(np.broadcast_to(largest, tolerances.shape), scale),
        effort,
    )
    solution = program.fewest((1 - _SAFE) / unit) if aim == "fewest" else None
    if solution is None:
        solution = program.smallest()
    counts = np.round(solution[:count]).astype(np.int64)
    real, imaginary = np.split(solution[count : columns.shape[1]], 2)
    makes_up = real + 1j * imaginary
    residual = vectors + weights @ counts + others @ makes_up
    return WeightChoice(counts, makes_up, residual, bool((np.abs(residual) <= tolerances).all()))


@dataclass(frozen=True, eq=False)
class _WeightProgram:
    """The choice in the solver's terms: counts, then real and imaginary parts of free planes, then the residual."""

    effects: Complex
    start: Complex
    most: Float
    groups: tuple[tuple[Sequence[int], int], ...]
    largest: Float
    effort: Effort | None

    def fewest(self, tolerance: float, nodes: int | None = None) -> Float | None:
        """Return the fewest weights within the tolerance, and of those the smallest residual."""
        solution = self._program(tolerance, nodes=nodes).least(self._number)
        if solution is None:
            return None
        number = float(np.round(self._number @ solution))
        return self._program(0.0, (self._number, number, number), nodes=nodes).least(self._slack)

    def smallest(self) -> Float:
        """Return the smallest residual, and of those the fewest weights; of too many choices, that of few weights.

        Many weights against each other come ever nearer, and no bound ends the search among them: then the residual
        is halved with the fewest weights that do it, as long as that can be settled.
        """
        try:
            solution = self._program(0.0, nodes=_NODES).least(self._slack)
            if solution is None:  # it is too far beyond what weights can do for the solver; none at all are a choice
                return np.zeros(self._width)
            fewer = self._program(float(solution[-1]) + _LEEWAY, nodes=_NODES).least(self._number)
        except UnsettledError:
            return self._halved()
        return solution if fewer is None else fewer

    def _halved(self) -> Float:
        best = np.zeros(self._width)
        best[-1] = float(np.abs(self.start).max())
        try:
            while best[-1] > _LEEWAY:
                nearer = self.fewest(0.5 * float(best[-1]), _NODES)
                if nearer is None:
                    break
                best = nearer
        except UnsettledError:
            pass
        return best

    @property
    def _slack(self) -> Float:
        """The cost that is the size of the residual."""
        cost = np.zeros(self._width)
        cost[-1] = 1.0
        return cost

    @property
    def _width(self) -> int:
        return len(self.effects[0]) + 1

    @property
    def _number(self) -> Float:
        """The cost that is the number of weights."""
        return np.concatenate([np.ones(len(self.most)), np.zeros(self._width - len(self.most))])

    def _program(self, radius: float, *rows: tuple[Float, float, float], nodes: int | None = None) -> Program:
        """Return the program with the residual within `radius` (0: within the last variable, its size)."""
        planes, width, free = len(self.start), self._width, self._width - len(self.most) - 1
        capped = []
        for places, cap in self.groups:
            row = np.zeros(width)
            row[list(places)] = 1.0
            capped.append((row, 0.0, float(cap)))
        none = np.full(free, math.inf)
        effects = np.hstack([self.effects, np.zeros((planes, 1))])
        own = np.where(np.arange(width) < len(self.most), effects, 0.0)[np.isfinite(self.largest)]
        reach = np.zeros((planes + len(own), width))
        reach[:planes, -1] = radius == 0
        return Program(
            effects=np.vstack([effects, own]),
            start=np.concatenate([self.start, np.zeros(len(own))]),
            radii=np.concatenate([np.full(planes, radius), self.largest[np.isfinite(self.largest)]]),
            reach=reach,
            lower=np.concatenate([np.zeros(len(self.most)), -none, [0.0]]),
            upper=np.concatenate([self.most, none, [math.inf]]),
            integral=self._number,
            rows=(*capped, *rows),
            nodes=nodes,
            effort=None if nodes is None else self.effort,
        )


def _unit(effects: NDArray[np.complex128]) -> float:
    """Return the size of a typical weight's effect, over the tolerance."""
    largest = np.abs(effects).max(axis=0, initial=0.0)
    return float(np.median(largest)) if len(largest) and largest.any() else 1.0
