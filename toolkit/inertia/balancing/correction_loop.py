"""`correct`: holes, flats and weights for a rotor, cut into its mesh and integrated again until it is in tolerance.

Where to cut, and how deep, comes from closed forms first. Then the tools are really cut out of the mesh, the parts are
integrated again, and what is left in the tolerance planes corrects what is asked of each plane: Broyden's secant
method on r(w), w being the vectors that the planes make up by the closed forms. At last settings and angles are
rounded to the shop's steps, and the rotor is cut and integrated once more.

Angles, signs and the shaft's frame are those of `inertia.balancing.unbalance`.
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.disc_constrained_milp import Complex
from inertia.balancing.corrections.layout import Arrangement
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.planning import Plan, plan, share, tools_of
from inertia.balancing.corrections.rounding import Place, rounded
from inertia.balancing.corrections.standard_weights import choose_weights, weight_operation
from inertia.balancing.corrections.tool import Tool
from inertia.balancing.corrections.workpiece import Body, Workpiece, wall
from inertia.balancing.shop_units import GRAM_MILLIMETRE
from inertia.balancing.tolerance import Tolerance
from inertia.balancing.unbalance import Unbalance, plane_weights
from inertia.errors import UsageError
from inertia.mesh.part import Part

_CUTS = 10
_ENOUGH = 1e-6  # of the tolerance: no further cut is made
_IDLE = 0.01  # of the tolerance: planes that have no more to do are left alone
_SLOW = 0.5  # a cut that leaves more than this of what was left is the last


@dataclass(frozen=True, eq=False)
class Correction:
    """What was done to a rotor, and what is left.

    Attributes
    ----------
    operations : plane by plane
    residual : the unbalance as after cutting, with settings and angles at the shop's steps
    unrounded : the unbalance before these were rounded
    parts : the parts after cutting
    iterations : cuts made before rounding
    history : after each of them the largest |residual|/permissible of the tolerance planes
    within : whether the residual is within the tolerance
    limits_hit : what kept the correction from going on
    why : how it ended, in a sentence
    """

    operations: tuple[Operation, ...]
    residual: Unbalance
    unrounded: Unbalance
    parts: tuple[Part, ...]
    iterations: int
    history: tuple[float, ...]
    within: bool
    limits_hit: tuple[str, ...]
    why: str


def correct(
    parts: Sequence[Part],
    densities: Sequence[float],
    shaft: Shaft,
    unbalance: Unbalance,
    planes: Sequence[CorrectionPlane],
    tolerance: Tolerance,
    tolerance_planes: tuple[float, float] | None = None,
    uncut: Unbalance | None = None,
) -> Correction:
    """Correct a rotor until its residual unbalance is within the tolerance, or the limits forbid it.

    Parameters
    ----------
    parts : closed surfaces; every tool cuts what it meets of them
    densities : kg/m³, one for each part
    shaft : in part axes
    unbalance : what is to be corrected: that of the parts, or a measured one; only what is cut comes from the mesh
    planes : where and how it may be corrected
    tolerance : what may be left in the tolerance planes
    tolerance_planes : (A, B) m; the bearings where not given
    uncut : the unbalance of the parts themselves, where it is known: it is integrated otherwise

    Raises
    ------
    UsageError : no planes, ids twice, densities missing, or nothing permissible
    GeometryError : a plane lies off the part, a tool is too deep for the wall, or the mesh cannot be cut
    """
    _require(parts, densities, planes, tolerance)
    piece = Workpiece(tuple(parts), tuple(densities), shaft, unbalance, uncut)
    at = list(tolerance_planes or (shaft.z_a, shaft.z_b))
    limits = np.array(tolerance.permissible)
    start = unbalance.in_many_planes(at)
    if _worst(start, limits) <= 1:
        return Correction((), unbalance, unbalance, piece.parts, 0, (), True, (), "already within the tolerance")
    levers = np.column_stack([plane_weights(plane.z, at)[0] for plane in planes])
    weights = _kit_weights(planes, levers, start, limits)
    loop = _Loop(piece, tuple(planes), at, levers, limits, weights)
    steps, hit, history = loop.run()
    return loop.finished(steps, hit, history)


@dataclass(frozen=True, eq=False)
class _Step:
    """A cut: the places, the parts after it, and what is left."""

    places: tuple[Place, ...]
    parts: tuple[Part, ...]
    unbalance: Unbalance


@dataclass(frozen=True, eq=False)
class _Loop:
    piece: Workpiece
    planes: tuple[CorrectionPlane, ...]
    at: list[float]
    levers: Float
    limits: Float
    weights: tuple[Operation, ...]

    def run(self) -> tuple[_Step, tuple[str, ...], tuple[float, ...]]:
        """Cut until nothing more is gained; return the best cut, what bound it, and how it went."""
        best = self._cut(())
        residual = self._residual(best)
        tools = self._tools(residual)
        effects: Complex = self.levers.astype(complex)
        done = np.zeros(len(self.planes), complex)
        arrangements: Mapping[int, Arrangement] = {}
        history: list[float] = []
        hit: tuple[str, ...] = ()
        least, before = _worst(residual, self.limits), math.inf
        while tools and len(history) < _CUTS:
            work = plan(tools, effects, residual - effects @ done, self.limits, self._bodies, arrangements)
            step = self._cut(_places(work))
            after, moved = self._residual(step), work.vectors - done
            history.append(_worst(after, self.limits))
            if history[-1] < least:
                best, hit, least = step, work.limits_hit, history[-1]
            if history[-1] <= _ENOUGH or history[-1] > _SLOW * before or not moved.any():
                break
            missed = after - residual - effects @ moved
            effects = effects + np.outer(missed, moved.conj()) / np.vdot(moved, moved).real
            residual, done, arrangements, before = after, work.vectors, work.arrangements, history[-1]
        return best, hit, tuple(history)

    def finished(self, best: _Step, hit: tuple[str, ...], history: tuple[float, ...]) -> Correction:
        """Round the best cut to the shop's steps, cut once more, and say how it ended."""
        walled = [replace(k, limit=self._wall(k) - self.planes[k.plane].min_wall) for k in best.places]
        unrounded = self._residual(best)
        places = rounded(walled, self.levers, unrounded, self.limits)
        last = self._cut(places)
        residual = self._residual(last)
        worst, exact = _worst(residual, self.limits), _worst(unrounded, self.limits)
        if worst > 1 >= exact:
            hit = (*hit, "the steps of depth and angle")
        largest = " and ".join(f"{abs(k) / GRAM_MILLIMETRE:.4g}" for k in residual.tolist())
        why = f"{largest} g·mm left in the tolerance planes, with depths and angles at the shop's steps"
        if worst > 1:
            why += f": the best that can be done within {', '.join(hit) or 'these planes'}"
        return Correction(
            operations=(*self.weights, *map(self._with_wall, self._operations(places), places)),
            residual=last.unbalance,
            unrounded=best.unbalance,
            parts=last.parts,
            iterations=len(history),
            history=history,
            within=worst <= 1,
            limits_hit=hit,
            why=why,
        )

    def _residual(self, step: _Step) -> Complex:
        return step.unbalance.in_many_planes(self.at)

    def _cut(self, places: tuple[Place, ...]) -> _Step:
        solids = [solid for k in places if (solid := k.tool.solid(k.angle, k.setting)) is not None]
        masses = [k for k in self._operations(places) if k.kind == "point_mass"]
        return _Step(places, *self.piece.cut(solids, [*self.weights, *masses]))

    @property
    def _bodies(self) -> tuple[Body, ...]:
        return self.piece.bodies if any(plane.cuts for plane in self.planes) else ()

    def _tools(self, residual: Complex) -> dict[int, tuple[Tool, ...]]:
        """Return the tools of the planes that have something to do; those of kits have done it."""
        free = [k for k, plane in enumerate(self.planes) if plane.method != "kit"]
        vectors = share(self.levers[:, free].astype(complex), residual, self.limits)
        return {
            k: tools_of(self.planes[k], cmath.phase(self.planes[k].sign * vector), self._bodies)
            for k, vector in zip(free, vectors.tolist(), strict=True)
            if _worst(self.levers[:, k] * vector, self.limits) > _IDLE
        }

    def _operations(self, places: Sequence[Place]) -> list[Operation]:
        count: Counter[int] = Counter()
        operations = []
        for place in places:
            count[place.plane] += 1
            name = f"{self.planes[place.plane].id}-{count[place.plane]}"
            operations.append(place.tool.operation(name, place.angle, place.setting))
        return operations

    def _wall(self, place: Place) -> float:
        return wall(self._bodies, place.tool, place.angle)

    def _with_wall(self, operation: Operation, place: Place) -> Operation:
        thickness = self._wall(place) - place.setting
        return replace(operation, remaining_wall=thickness) if math.isfinite(thickness) else operation


def _places(work: Plan) -> tuple[Place, ...]:
    return tuple(
        Place(number, arrangement.tool, angle, setting)
        for number, arrangement in sorted(work.arrangements.items())
        for angle, setting in arrangement.places
    )


def _worst(vectors: Complex, limits: Float) -> float:
    return float((np.abs(vectors) / limits).max())


def _kit_weights(
    planes: Sequence[CorrectionPlane], levers: Float, start: Complex, limits: Float
) -> tuple[Operation, ...]:
    """Choose the weights of all planes with kits together, the other planes making up for what they leave."""
    kits = [k for k, plane in enumerate(planes) if plane.method == "kit"]
    slots = [(k, angle, weight) for k in kits for angle in planes[k].positions for weight in planes[k].kit]
    if not slots:
        return ()
    others = [k for k in range(len(planes)) if k not in kits]
    effects = [levers[:, k] * cmath.rect(weight.mass * planes[k].radius, angle) for k, angle, weight in slots]
    groups: dict[object, tuple[list[int], int]] = {}
    for number, (k, angle, weight) in enumerate(slots):
        groups.setdefault((k, angle), ([], planes[k].most_per_position))[0].append(number)
        if weight.stock is not None:
            groups.setdefault((k, weight), ([], weight.stock))[0].append(number)
    most = [min(planes[k].most_per_position, weight.most) for k, _, weight in slots]
    choice = choose_weights(
        np.column_stack(effects), start, limits, most, list(groups.values()), free=levers[:, others]
    )
    count: Counter[int] = Counter()
    operations = []
    for (k, angle, weight), pieces in zip(slots, choice.counts.tolist(), strict=True):
        if pieces:
            count[k] += 1
            operations.append(weight_operation(planes[k], f"{planes[k].id}-{count[k]}", angle, weight, pieces))
    return tuple(operations)


def _require(
    parts: Sequence[Part], densities: Sequence[float], planes: Sequence[CorrectionPlane], tolerance: Tolerance
) -> None:
    if min(tolerance.permissible) <= 0:
        raise UsageError(
            f"{tolerance.standard} permits {tolerance.permissible} kg m: a limit of nothing cannot be reached, give "
            "positive ones"
        )
    if len(parts) != len(densities):
        raise UsageError(f"{len(densities)} densities are given for {len(parts)} parts: give one for each part")
    if not planes:
        raise UsageError("no correction plane is given: say where the rotor may be corrected")
    repeated = [name for name, times in Counter(plane.id for plane in planes).items() if times > 1]
    if repeated:
        raise UsageError(f"two correction planes are called {repeated[0]!r}: give each an id of its own")
