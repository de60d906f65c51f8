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
from collections.abc import Sequence
from dataclasses import field, replace
from importlib import import_module
from time import thread_time

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.correction_plane import FULL_TURN, CorrectionPlane
from inertia.balancing.corrections.drilling import AxialDrill, RadialDrill
from inertia.balancing.corrections.masses import MassTool
from inertia.balancing.corrections.milling import ArcCutter, FlatCutter
from inertia.balancing.corrections.moving import improve
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.places import FINE, Places
from inertia.balancing.corrections.room import metal, no_room, remaining_wall, rooms
from inertia.balancing.corrections.search import AIM, SECONDS, Plan, best_plan, rank
from inertia.balancing.corrections.sharing import Sharing
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import Steps, angles_of, steps_of
from inertia.balancing.corrections.tool import Tool
from inertia.balancing.corrections.workpiece import Taken, Workpiece
from inertia.balancing.shop_units import GRAM_MILLIMETRE
from inertia.balancing.tolerance import Tolerance
from inertia.balancing.unbalance import Complex, Unbalance, plane_weights
from inertia.errors import UsageError
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface
from inertia.records import dataclass

_SHARES = (0.7, 0.8)  # of the time left, for a plan and for another by what was cut
_AS_PLANNED = 1.05
_LEAST = 1.0  # s, for mending it once
_SOME = 0.01  # of the tolerance: a bound below says nothing
_MEET = 1e-5  # of what is cut
_BEST = 1e-3  # over the bound: nothing better is of use
_CUTS = 10
_FINER = 5  # cuts with ever finer steps, where the shop has none
_FINER_BY = 12.0
_NEAR = 24  # steps of setting, and of angle, to each side of a place that is mended
_ASIDE = 6
_DEPTHS, _DEPTHS_AT_PLACES = 5, 12  # that arcs are tried with, at free angles and at listed ones
_ALREADY = "already within the tolerance"


@dataclass(frozen=True, eq=False)
class Correction:
    """What was done to a rotor, and what is left.

    Attributes
    ----------
    operations : plane by plane
    residual : the unbalance as after cutting
    parts : the parts after cutting
    iterations : times that the plan was cut and mended
    history : each time the largest |residual|/permissible of the tolerance planes
    within : whether the residual is within the tolerance
    limits_hit : what kept the correction from going on
    why : how it ended, in a sentence
    bound : no plan with so many places leaves less in the worse plane, as a share of the tolerance aimed at
    fewest : no plan with fewer places comes within the tolerance; 0 where no plan does
    worst : what is left in the worse plane, as a share of the tolerance aimed at
    cut_short : the time was up before the search for a plan was through
    """

    operations: tuple[Operation, ...]
    residual: Unbalance
    parts: tuple[Part, ...]
    iterations: int
    history: tuple[float, ...]
    within: bool
    limits_hit: tuple[str, ...]
    why: str
    bound: float = 0.0
    fewest: int = 0
    worst: float = 0.0
    cut_short: bool = False


def correct(
    parts: Sequence[Part],
    densities: Sequence[float],
    shaft: Shaft,
    unbalance: Unbalance,
    planes: Sequence[CorrectionPlane],
    tolerance: Tolerance,
    tolerance_planes: tuple[float, float] | None = None,
    uncut: Unbalance | None = None,
    aim: float = AIM,
    seconds: float = SECONDS,
    sag: float = 0.0,
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
    aim : share of what is permissible that is to be left at most, if it can be; 0 for the least that can be left
    seconds : how long a plan is looked for; then the best so far is taken
    sag : m, how far facets may be from the true surface; depths are counted from what the tools meet, and facets no
        farther from a plane's radius or face stand for it

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
    worst = _worst(start, limits)
    if worst <= max(aim, FINE):
        return Correction((), unbalance, piece.parts, 0, (), True, (), _ALREADY, bound=worst, worst=worst)
    levers = np.column_stack([plane_weights(plane.z, at)[0] for plane in planes])
    import_module("scipy.optimize")  # what loading it takes is none of the time for the plan
    return _Loop(piece, tuple(planes), at, levers, limits, aim, thread_time() + seconds, sag).run(start)


@dataclass(frozen=True)
class _Place:
    """A tool at work: in plane number `plane`, at an angle (rad), with a setting."""

    plane: int
    tool: Tool
    angle: float
    setting: float


@dataclass(frozen=True, eq=False)
class _Work:
    """Places, what each takes away (None where nothing is cut), and what is left in the tolerance planes."""

    places: tuple[_Place, ...]
    taken: tuple[Taken | None, ...]
    left: Complex
    worst: float


@dataclass(eq=False)
class _Loop:
    piece: Workpiece
    planes: tuple[CorrectionPlane, ...]
    at: list[float]
    levers: Float
    limits: Float
    aim: float
    deadline: float
    sag: float
    _taken: dict[_Place, Taken] = field(default_factory=dict, init=False)
    _room: dict[Tool, Steps] = field(default_factory=dict, init=False)
    _met: dict[_Place, _Place] = field(default_factory=dict, init=False)

    def run(self, start: Complex) -> Correction:
        """Plan, cut every place by itself, mend the plan by what it took, and cut the best with all tools at once."""
        steps = self._steps(start)
        gains = [self._gains(self._starting(each), each.settings) for each in steps]
        best, history = None, []
        for share in _SHARES:
            seconds = share * (self.deadline - thread_time())
            places = Places(steps, gains, start / self.limits, seconds)
            plan = best_plan(places, self.aim)
            work, came, short = self._cut_and_mend(steps, plan, start)
            history += came
            if best is None or self._rank(work) < self._rank(best):
                best, found = work, replace(plan, cut_short=plan.cut_short or short)
            if work.worst <= _AS_PLANNED * max(plan.worst, self.aim) or not any(work.taken):
                break
            gains, _ = self._gains_as_cut(steps, gains, work)
        assert best is not None
        if any(best.taken) and (found.bound > _SOME or found.fewest > 1):
            found = self._bounded_as_cut(places, best, found)
        return self._finished(best, found, found.cut_short, tuple(history))

    def _cut_and_mend(self, steps: Sequence[Steps], plan: Plan, start: Complex) -> tuple[_Work, list[float], bool]:
        places = tuple(
            _Place(steps[k].plane, steps[k].tool, float(steps[k].angles[a]), float(steps[k].settings[s]))
            for k, a, s in plan.spots
        )
        best = work = self._done(places, start)
        history = [work.worst]
        cut_short = False
        for number in range(1, _CUTS):
            places, short = self._mended(work, start, number)
            if places == work.places or not places:
                break
            work = self._done(places, start)
            history.append(work.worst)
            cut_short |= short
            if work.worst < best.worst * (1 - 1e-9):
                best = work
            elif number > _FINER:
                break
        return best, history, cut_short

    def _starting(self, steps: Steps) -> Tool:
        """Return the tool of steps as it starts at most angles."""
        usable = np.isfinite(steps.most)
        return replace(steps.tool, start=float(np.median(steps.starts[usable]))) if usable.any() else steps.tool

    def _gains(self, tool: Tool, settings: Float) -> Complex:
        """Return what a unit vector of a tool does in the tolerance planes at each setting, (s, t) over the limits."""
        places = [tool.unbalance_z(k) for k in settings.tolist()]
        weights = {z: plane_weights(z, self.at)[0] for z in set(places)}
        return np.asarray(tool.sign * np.array([weights[z] for z in places]) / self.limits, complex)

    def _gains_as_cut(
        self, steps: Sequence[Steps], gains: Sequence[Complex], work: _Work
    ) -> tuple[list[Complex], float]:
        """Return what unit vectors of the planes do, off the closed forms by the mean of those that were cut.

        Last how far a place that was cut is from that in a tolerance plane at most, over the limits.
        """
        by_plane: dict[int, list[tuple[float, Complex]]] = {}
        for place, taken in zip(work.places, work.taken, strict=True):
            if (vector := self._vector(place)) and taken is not None:
                cut = place.tool.sign * taken.change / vector / self.limits
                number = next(k for k, each in enumerate(steps) if each.tool == place.tool)
                nearest = int(np.abs(steps[number].settings - place.setting).argmin())
                by_plane.setdefault(place.plane, []).append((abs(vector), cut - gains[number][nearest]))
        mean = {plane: np.mean([off for _, off in pairs], axis=0) for plane, pairs in by_plane.items()}
        apart = [size * np.abs(off - mean[plane]).max() for plane, pairs in by_plane.items() for size, off in pairs]
        return [gain + mean.get(each.plane, 0.0) for each, gain in zip(steps, gains, strict=True)], max(
            apart, default=0.0
        )

    def _rank(self, work: _Work) -> tuple[int, float, float]:
        return rank(self.aim, len(work.places), work.worst)

    def _bounded_as_cut(self, places: Places, work: _Work, plan: Plan) -> Plan:
        """Return a plan with what no plan beats if none is farther from its closed forms than what was cut."""
        gains, apart = self._gains_as_cut(places.steps, places.gains, work)
        seconds = max(self.deadline - thread_time(), _LEAST)
        sharing, number = Sharing(replace(places, gains=gains, seconds=seconds)), len(work.places)
        return replace(
            plan,
            bound=max(sharing.bound(number) - number * apart, 0.0),
            lowest=max(sharing.lowest - number * apart, 0.0),
            fewest=min(plan.fewest, sharing.first(1.0 + number * apart)),
            settled=False,
        )

    def _steps(self, start: Complex) -> list[Steps]:
        vectors = np.linalg.pinv(self.levers / self.limits[:, None]) @ (-start / self.limits)
        steps = []
        for number, (plane, vector) in enumerate(zip(self.planes, vectors.tolist(), strict=True)):
            wanted = cmath.phase(plane.sign * vector)
            tools, rooms_of_tools, starts = self._tools(plane, wanted)
            for tool, room in zip(tools, rooms_of_tools, strict=True):
                steps.append(steps_of(number, tool, 2 * float(np.abs(vectors).max()), room, starts))
                self._room[tool] = steps[-1]
        return steps

    def _tools(self, plane: CorrectionPlane, wanted: float) -> tuple[tuple[Tool, ...], list[Float], Float]:
        """Return the tools of a plane, in the material nearest to an angle (rad) where they can start, and their room.

        Last where it begins at each angle, m. Raises `GeometryError` where there is none at any angle.
        """
        tools, angles = tools_of_density(plane, 0.0), angles_of(plane)
        if not plane.cuts:
            return tools, [np.full(len(angles), math.inf) for _ in tools], np.zeros(len(angles))
        room, found = rooms(self.piece.bodies, tools, angles, self.sag)
        usable = np.flatnonzero(np.isfinite(found.density) & (np.max(room, axis=0) >= 0))
        if len(usable) == 0:
            raise no_room(self.piece.bodies, tools[0], wanted)
        deepest = [
            float(found.thickness[k >= 0].max(initial=0.0) if plane.through else max(k.max(), 0.0)) for k in room
        ]
        nearest = usable[np.abs((angles[usable] - wanted + math.pi) % FULL_TURN - math.pi).argmin()]
        tools = tools_of_density(plane, float(found.density[nearest]))
        return tuple(replace(k, limit=most) for k, most in zip(tools, deepest, strict=True)), room, found.starts

    def _done(self, places: tuple[_Place, ...], start: Complex) -> _Work:
        """Cut every place by itself and add up what is left."""
        taken = tuple(self._take(place) for place in places)
        left = start.copy()
        for pair in zip(places, taken, strict=True):
            left += self._change(*pair)
        return _Work(places, taken, left, _worst(left, self.limits))

    def _take(self, place: _Place) -> Taken | None:
        if not place.tool.plane.cuts:
            return None
        if place not in self._taken:
            self._taken[place] = self.piece.taken(self._solid(place), self.at)
        return self._taken[place]

    def _solid(self, place: _Place) -> Surface:
        met = self._on_metal(place)
        solid = met.tool.solid(met.angle, met.setting)
        assert solid is not None, "what cuts has a solid"
        return solid

    def _on_metal(self, place: _Place) -> _Place:
        """Return a place with its tool on the metal that it meets; a hole through is as deep as that is thick."""
        if not place.tool.plane.cuts:
            return place
        if place not in self._met:
            there = metal(self.piece.bodies, place.tool, np.array([place.angle]), self.sag)
            met = replace(place, tool=replace(place.tool, start=float(there.starts[0])))
            thickness = float(there.thickness[0])
            if place.tool.plane.through and math.isfinite(thickness):
                met = replace(met, setting=thickness)
            self._met[place] = met
        return self._met[place]

    def _change(self, place: _Place, taken: Taken | None) -> Complex:
        """Return what a place changes in the tolerance planes."""
        if taken is not None:
            return taken.change
        return np.asarray(self.levers[:, place.plane] * self._vector(place), complex)

    def _vector(self, place: _Place) -> complex:
        return place.tool.sign * cmath.rect(place.tool.unbalance(place.setting), place.angle)

    def _mended(self, work: _Work, start: Complex, number: int) -> tuple[tuple[_Place, ...], bool]:
        """Improve places by what they took, each near where it is; where there are no steps, ever more finely."""
        steps, gains, spots = [], [], []
        for k, (place, taken) in enumerate(zip(work.places, work.taken, strict=True)):
            near = self._near(place, number)
            unit = self._gains(self._on_metal(place).tool, near.settings)
            if (vector := self._vector(place)) and taken is not None:
                here = self._gains(self._on_metal(place).tool, np.array([place.setting]))
                unit = unit - here + place.tool.sign * taken.change / vector / self.limits
            steps.append(near)
            gains.append(unit)
            away = np.abs(near.angles - place.angle)
            spots.append((k, int(away.argmin()), int(np.abs(near.settings - place.setting).argmin())))
        if not spots:
            return (), False
        seconds = max(self.deadline - thread_time(), _LEAST)
        near_ones = Places(steps, gains, start / self.limits, seconds)
        own = [[k] for k in range(len(spots))]
        moved, _ = improve(near_ones, tuple(spots), own)
        places = tuple(
            _Place(each.plane, each.tool, float(each.angles[a] % FULL_TURN), float(each.settings[s]))
            for each, (_, a, s) in zip(steps, moved, strict=True)
        )
        return places, near_ones.cut_short

    def _near(self, place: _Place, number: int) -> Steps:
        """Return the steps of a place near where it is."""
        tool, plane = place.tool, place.tool.plane
        finer = _FINER_BY**-number
        settings = np.array([place.setting])
        greatest = tool.greatest
        if tool.least < greatest:
            span = greatest if math.isfinite(greatest) else place.setting
            step = tool.step or max(span, place.setting) / 512 * finer
            around = place.setting + step * np.arange(-_NEAR, _NEAR + 1)
            settings = np.unique(np.round(around[(around >= tool.least) & (around <= greatest * (1 + 1e-12))], 15))
        angles = np.array([place.angle])
        if plane.angles == "free":
            step = plane.angle_step or math.radians(0.5) * finer
            angles = place.angle + step * np.arange(-_ASIDE, _ASIDE + 1)
            if plane.angle_step:
                angles = step * np.round(angles / step)
            angles = np.array([k for k in angles.tolist() if not plane.forbids(k, tool.half_angle_at(place.setting))])
            angles = angles if len(angles) else np.array([place.angle])
        sizes = np.array([tool.unbalance(k) for k in settings.tolist()])
        known = self._room[tool]
        grid, room, starts = known.angles, known.most, known.starts
        above = np.searchsorted(grid, angles % FULL_TURN - 1e-9) % len(grid)
        # Between two angles there is as much room as at the worse of them.
        on = np.abs(grid[above] - angles % FULL_TURN) < 1e-9
        most = np.where(on, room[above], np.minimum(room[above], room[above - 1]))
        begins = np.where(on, starts[above], np.maximum(starts[above], starts[above - 1]))
        return Steps(place.plane, tool, angles, settings, sizes, most, begins)

    def _finished(self, best: _Work, plan: Plan, cut_short: bool, history: tuple[float, ...]) -> Correction:
        """Cut all places together, and say how it ended."""
        operations = self._operations(best)
        solids = [self._solid(k) for k in best.places if k.tool.plane.cuts]
        masses = [k for k in operations if k.kind in ("point_mass", "weight")]
        parts, residual = self.piece.cut(solids, masses)
        left = residual.in_many_planes(self.at)
        worst = _worst(left, self.limits)
        hit = () if worst <= 1 else self._limits_hit(plan, cut_short)
        largest = " and ".join(f"{abs(k) / GRAM_MILLIMETRE:.4g}" for k in left.tolist())
        set_at = "depths and angles at the shop's steps" if solids else "masses and angles that can be set"
        why = f"{largest} g·mm left in the tolerance planes, with {set_at}"
        if not operations and worst <= 1:
            aim = f"{100 * self.aim:g} % of it or less" if self.aim else "less"
            why = f"{_ALREADY}, {100 * worst:.3g} % of it; no plan was found that leaves {aim}"
        if cut_short or worst > 1:
            why += f": the best that {_proven(plan, worst, hit, cut_short)}"
        alone = math.fsum(k.mass for k in operations if k not in masses)
        added = math.fsum(k.mass if k.method == "add" else -k.mass for k in masses)
        together = self.piece.initial.mass + added - residual.mass
        if alone - together > _MEET * alone:
            why += (
                f"; tools meet: {1e3 * (alone - together):.3g} g that one takes is what another has taken, move a plane"
            )
        return Correction(
            operations=operations,
            residual=residual,
            parts=parts,
            iterations=len(history),
            history=history,
            within=worst <= 1,
            limits_hit=hit,
            why=why,
            bound=min(plan.bound, worst),
            worst=worst,
            fewest=min(plan.fewest, len(best.places)),
            cut_short=cut_short,
        )

    def _limits_hit(self, plan: Plan, cut_short: bool) -> tuple[str, ...]:
        if plan.lowest > 1:
            return tuple(_bound(self.planes[k]) for k in plan.binding)
        if cut_short:
            return ("the time that it was given",)
        return (_stepped(self.planes) + ("" if plan.settled else ", as far as plans were tried"),)

    def _operations(self, work: _Work) -> tuple[Operation, ...]:
        """Return the work plane by plane, with what was cut; weights of one kind at one place are one operation."""
        pieces = Counter(work.places)
        cutting = [k for k in pieces if (taken := self._take(k)) is None or taken.unbalance]
        order = sorted(cutting, key=lambda k: (k.plane, k.angle, k.setting))
        count: Counter[int] = Counter()
        operations = []
        for place in order:
            count[place.plane] += 1
            name = f"{self.planes[place.plane].id}-{count[place.plane]}"
            met = self._on_metal(place)
            operation = met.tool.operation(name, met.angle, met.setting * pieces[place])
            taken = self._take(place)
            if taken is not None:
                thickness = remaining_wall(self.piece.bodies, met.tool, met.angle, met.setting)
                operation = replace(
                    operation,
                    mass=taken.mass,
                    unbalance=-taken.unbalance,
                    unbalance_z=taken.z,
                    remaining_wall=thickness if math.isfinite(thickness) else None,
                )
            operations.append(operation)
        return tuple(operations)


def tools_of_density(plane: CorrectionPlane, density: float) -> tuple[Tool, ...]:
    """Return the tools of a plane, the smallest first, in material of a density (kg/m³)."""
    if plane.method == "kit":
        return tuple(WeightTool(plane, density, weight=weight) for weight in plane.kit)
    if plane.method == "mill":
        return (FlatCutter(plane, density),)
    if plane.method == "mill_arc":
        return tuple(ArcCutter(plane, density, depth=depth) for depth in _arc_depths(plane))
    if plane.method in ("add", "remove"):
        return (MassTool(plane, density),)
    kind = RadialDrill if plane.method == "drill_radial" else AxialDrill
    return tuple(kind(plane, density, diameter=diameter) for diameter in sorted(plane.diameters))


def _arc_depths(plane: CorrectionPlane) -> list[float]:
    """Return the depths that arcs are tried with: all steps, or some of them up to the greatest.

    Where angles are free, they and the arcs' lengths reach any vector with few depths.
    """
    assert plane.max_depth is not None, "a plane of arcs has a depth"
    most = _DEPTHS if plane.angles == "free" else _DEPTHS_AT_PLACES
    step = plane.depth_step or plane.max_depth / most
    first, last = (math.ceil(plane.min_depth / step - 1e-9) or 1), math.floor(plane.max_depth / step + 1e-9)
    if last < first:
        return [plane.max_depth]
    numbers = np.unique(np.round(np.linspace(first, last, min(last - first + 1, most))).astype(int))
    return [round(step * k, 15) for k in numbers.tolist()]


def _bound(plane: CorrectionPlane) -> str:
    which = f"plane {plane.id!r}: "
    if plane.method == "mill_arc":
        return (
            which + f"max_depth {1e3 * (plane.max_depth or 0):g} mm and max_arc {math.degrees(plane.max_arc):g} degrees"
        )
    if plane.method in ("add", "remove") and plane.max_mass is not None:
        return which + f"max_mass {plane.max_mass:g} kg"
    if plane.method == "kit":
        return which + "its kit and positions"
    if plane.angles != "free":
        return which + "the angles allowed"
    if plane.max_depth is not None:
        return which + f"max_depth {1e3 * plane.max_depth:g} mm"
    return which + "its forbidden sectors" if plane.forbidden else which + "its tools"


def _stepped(planes: Sequence[CorrectionPlane]) -> str:
    """Return what can be set in planes only so or so."""
    steps = {
        "depth": any(plane.cuts and plane.depth_step for plane in planes),
        "arc": any(plane.method == "mill_arc" and plane.arc_step for plane in planes),
        "mass": any(plane.method in ("add", "remove") and plane.mass_step for plane in planes),
        "angle": any(plane.angles == "free" and plane.angle_step for plane in planes),
    }
    set_in = " and ".join(name for name, there in steps.items() if there)
    words = ["the weights of the kit"] if any(plane.method == "kit" for plane in planes) else []
    words += [f"the steps of {set_in}"] if set_in else []
    words += ["the positions"] if any(plane.angles != "free" for plane in planes) else []
    return " and ".join(words) or "the masses and angles"


def _proven(plan: Plan, worst: float, hit: Sequence[str], cut_short: bool) -> str:
    """Return how good a plan is that is out of tolerance or was not looked for to the end, by what is proven."""
    limits = ", ".join(hit) or "these planes"
    lowest = plan.bound if plan.settled else plan.lowest
    out_of_reach = worst > 1 and lowest > 1
    if out_of_reach and worst <= lowest * (1 + _BEST):
        return f"can be done within {limits}"
    if out_of_reach:
        time = " in the time that it was given" if cut_short else ""
        return f"was found{time}; no plan comes within the tolerance with {limits}"
    return "was found in the time that it was given" if cut_short else f"was found with {limits}"


def _worst(vectors: Complex, limits: Float) -> float:
    return float((np.abs(vectors) / limits).max())


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
