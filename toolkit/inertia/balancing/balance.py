"""`balance`: unbalance, tolerance, corrections and verdict of a rotor, from the meshes of its bodies.

Angles, signs and frames are those of `inertia.balancing.unbalance`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import reduce
from operator import add
from pathlib import Path
from time import thread_time
from typing import TYPE_CHECKING, Literal

import numpy as np

from inertia.arrays import Progress
from inertia.balancing import bounds
from inertia.balancing.assembled import AssembledRotor
from inertia.balancing.axis.location import Axis, rotor_axis
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.axis.tilt import Tilt, principal_tilt
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.correction_fields import PlaneFields
from inertia.balancing.correction_loop import Correction, correct
from inertia.balancing.correction_planes import against, correction_planes, moved
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.search import AIM
from inertia.balancing.forces import RigidLimit, axle_torque, bearing_forces, rigid_limit
from inertia.balancing.indexing import Indexing, best_indexing
from inertia.balancing.monte_carlo import Scatter, Term, monte_carlo
from inertia.balancing.monte_carlo_terms import operation_terms, rotor_terms
from inertia.balancing.mounting import joint_terms, mounting_terms
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import (
    Outline,
    RotorBody,
    density_uncertainties,
    in_unit,
    outline,
    read_bodies,
    turned,
    unbalance_of,
)
from inertia.balancing.tessellation_bound import surface_cut_away
from inertia.balancing.tolerance import Planes, Tolerance, achieved_grade, allocate
from inertia.balancing.unbalance import Complex, Unbalance
from inertia.balancing.verdict import Verdict, count_the_shop, judge
from inertia.errors import FieldPath, GeometryError, UsageError, placed, require_kind
from inertia.mass.properties import MassProperties
from inertia.mesh.part import Part
from inertia.records import dataclass

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LOWER = (1.0, 0.4, 0.1)  # of what is asked for, aimed at while the shop's work leaves too few parts within tolerance
_DEEPER = (0.5, 0.95)  # of the greatest depth, of arcs, for the same
_LEAST_TIME = 0.1  # of the time, for each of them
_WEIGHTS = ("add", "remove", "kit")  # methods whose masses are weighed
_LIGHT, _DENSE = 25.0, 25_000.0  # kg/m³: a light foam, and more than any metal has; metals in g/cm³ are below both
_NEAR = 0.01  # of the rotor's length
_ROUNDED = 1e-6  # of a place along the shaft: what float32 leaves of it, as in STL

_Complete = Callable[[Unbalance, Sequence[Part] | None], Unbalance]


@dataclass(frozen=True)
class PlaneUnbalance:
    """What a correction plane has of the unbalance.

    Attributes
    ----------
    id : its name
    z : m
    initial, residual : kg m, before and after correction
    """

    id: str
    z: float
    initial: complex
    residual: complex


@dataclass(frozen=True, eq=False)
class Balance:
    """All that a report on a rotor's balance states; SI units.

    Attributes
    ----------
    rotor : as described
    bodies : as read
    axis : the shaft, and how it was obtained
    properties : of all bodies together, in part axes, without keys
    initial : the unbalance as modelled, keys included, with its uncertainties
    residual : the same after the corrections; `initial` where there are none
    tolerance : what is permissible in the tolerance planes, the bearings
    correction_planes : as planned, those with a method
    planes : what each correction plane has of the unbalance
    correction : what was done, and the parts after it; None where no plane has a method
    verdict, initial_verdict : on the residual, and on the rotor as modelled
    rigid : how near the critical speed is; None where it is not given
    tilt : of the principal axis from the shaft
    scatter : how the residual may turn out, inputs and shop taken at their tolerances
    notes : what was decided or has to be known, in sentences
    indexing : how the bodies are put together; None where none may be turned
    """

    rotor: Rotor
    bodies: tuple[RotorBody, ...]
    axis: Axis
    properties: MassProperties
    initial: Unbalance
    residual: Unbalance
    tolerance: Tolerance
    correction_planes: tuple[CorrectionPlane, ...]
    planes: tuple[PlaneUnbalance, ...]
    correction: Correction | None
    verdict: Verdict
    initial_verdict: Verdict
    rigid: RigidLimit | None
    tilt: Tilt
    scatter: Scatter
    notes: tuple[str, ...]
    indexing: Indexing | None = None

    @property
    def origin(self) -> Literal["modelled", "measured"]:
        """How the rotor's own unbalance is known: from its meshes, or as a machine showed it."""
        return "measured" if any(k.source == "measurement" for k in self.initial.uncertainties) else "modelled"

    @property
    def shaft(self) -> Shaft:
        """The shaft."""
        return self.axis.shaft

    @property
    def tolerance_planes(self) -> Planes:
        """Where the bearings are along the shaft, m."""
        return self.shaft.z_a, self.shaft.z_b

    def plot(self, ax: Axes | None = None) -> Figure:
        """Draw the unbalance in the tolerance planes, as shares of the limit, before and after corrections.

        The circle is the limit; angles are those of the heavy spots. Returns the figure. Raises `UsageError` where
        matplotlib is not installed.
        """
        from inertia.palette import BLUE, VERMILLION
        from inertia.plotting import figure_of

        def draw(axes: Axes) -> None:
            turn = np.linspace(0.0, 2.0 * np.pi, 181)
            axes.plot(np.cos(turn), np.sin(turn), color="#555555", linewidth=1.0)
            for color, before, after in zip(
                (BLUE, VERMILLION), self.initial_verdict.planes, self.verdict.planes, strict=True
            ):
                first, last = (each.residual / each.permissible for each in (before, after))
                axes.plot(
                    [0.0, first.real], [0.0, first.imag], color=color, linewidth=1.0, label=f"{before.name} modelled"
                )
                if self.correction is not None:
                    axes.plot([last.real], [last.imag], "o", color=color, label=f"{after.name} corrected")
            axes.set_aspect("equal")
            axes.set_xlabel("of the limit, towards the zero mark")
            axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)  # no data lies there

        return figure_of(draw, ax, f"{Path(self.rotor.name).name}: {self.verdict.outcome}")

    def _repr_html_(self) -> str:
        """Return a small table, as a notebook shows it."""
        from inertia.notebook import html_of

        rows = [
            ("Rotor", Path(self.rotor.name).name),
            ("Verdict", self.verdict.headline),
            *(("After" if self.correction is not None else "Judged", each.why) for each in self.verdict.planes),
            *([("Before", f"{self.initial_verdict.outcome}")] if self.correction is not None else []),
            *([("Correction", self.correction.why)] if self.correction is not None else []),
            *(("Note", note) for note in self.notes),
        ]
        return html_of(rows)

    def forces(self, unbalance: Unbalance) -> tuple[complex, complex]:
        """Return the forces on bearings A and B, N, at the highest speed in service; they turn with the rotor."""
        a, b = bearing_forces(unbalance, *self.tolerance_planes, self.rotor.speed).tolist()
        return a, b

    def forces_running_up(self, unbalance: Unbalance) -> tuple[complex, complex]:
        """Return the same while the rotor still runs up as it reaches that speed."""
        turning = self.shaft.turn * self.rotor.acceleration
        a, b = bearing_forces(unbalance, *self.tolerance_planes, self.rotor.speed, turning).tolist()
        return a, b

    def torque(self, unbalance: Unbalance) -> complex:
        """Return the torque across the shaft that the axle must give the rotor at that speed, N m."""
        return complex(axle_torque(unbalance.couple, self.rotor.speed))

    def achieved_grade(self, unbalance: Unbalance) -> float:
        """Return the balance quality grade G, mm/s, that an unbalance of this rotor just keeps.

        See `inertia.balancing.tolerance.achieved_grade`; mass and shares are those of the rotor as modelled, as they
        are for the tolerance.
        """
        at, overhung = self.tolerance_planes, self.rotor.fields.tolerance.overhung
        shares = self.tolerance.shares or allocate(self.initial, at, overhung)
        return achieved_grade(unbalance.in_planes(*at), shares, self.initial.mass, self.rotor.speed)


def balance(
    rotor: Rotor,
    *,
    measured: Sequence[tuple[float, complex, float]] | None = None,
    measured_spreads: Sequence[Complex] = (),
    progress: Progress | None = None,
) -> Balance:
    """Balance a rotor.

    Its bodies are read and integrated about the shaft; the unbalance is judged in the tolerance planes, which are the
    bearings. Where it is too large, or may be, corrections are cut into the mesh in the correction planes, and what is
    left is integrated again and judged.

    Parameters
    ----------
    rotor : what `Rotor.load` returned
    measured : the unbalance as a machine showed it, in place of that of the meshes: (z in m, vector in kg m from the
        zero mark, bound of its error in kg m) of each plane; what is cut still comes from the meshes
    measured_spreads : sets (m, n) kg m of what one standard deviation of each of m independent inputs does to the
        vectors of those n planes at once: twice what a set comes to in squares counts beside the bounds
    progress : called with the fraction done

    Raises
    ------
    ReadError : a file cannot be read
    UsageError : a field is not usable
    GeometryError : a body is open, bodies overlap, the axis does not go through them, a plane lies off them, or a
        tool is too deep for the wall

    >>> from importlib.resources import files
    >>> result = balance(Rotor.load(files("inertia_meshes") / "rotors" / "two_disc_rotor.toml"))
    >>> result.verdict.outcome, [operation.id for operation in result.correction.operations]
    ('pass', ['I-1', 'II-1'])
    """
    require_kind(rotor, Rotor, "rotor", "inertia.Rotor.load(path)")
    tell = progress or (lambda done: None)
    tell(0.0)
    assembled = None if rotor.assembly is None else AssembledRotor(rotor, rotor.assembly)
    bodies = read_bodies(rotor) if assembled is None else assembled.bodies()
    tell(0.3)
    axis = rotor_axis(rotor, bodies)
    shaft = axis.shaft
    at = (shaft.z_a, shaft.z_b)
    indexing = None
    if measured:
        pass  # it has been put together
    elif assembled is None:
        indexing = _indexing(rotor, bodies, shaft)
        if indexing is not None:
            bodies = turned(rotor, bodies, shaft, indexing.turns)
    elif (best := _put_together(assembled, shaft)) is not None:
        assembled, indexing = best
        bodies = assembled.bodies()
    _require_places(rotor, bodies, shaft)
    if assembled is None:
        properties: MassProperties = reduce(add, (body.analysis.properties for body in bodies))
    else:
        properties = assembled.properties
    together = Unbalance.of(properties, shaft, radial_uncertainty=rotor.radial_uncertainty)
    modelled = unbalance_of(bodies, shaft, together.with_masses(() if measured else rotor.key_masses))
    if assembled is not None:
        known = assembled.uncertainty(shaft, modelled.z)
        modelled = modelled.with_uncertainties(known) if known.modes else modelled
    given = modelled if measured is None else as_measured(modelled, measured, measured_spreads)

    def complete(unbalance: Unbalance, cut: Sequence[Part] | None) -> Unbalance:
        """Add what densities leave uncertain."""
        more = density_uncertainties(rotor, bodies, shaft, unbalance.z, cut=cut, measured=measured is not None)
        return unbalance.with_uncertainties(*more)

    initial = complete(given, None)
    tell(0.5)
    tolerance = rotor.tolerance(initial, at)
    critical = rotor.fields.service.critical_rpm
    rigid = None if critical is None else rigid_limit(rotor.fields.service.rpm, critical)
    planes = correction_planes(rotor, bodies, shaft)
    # A rotor that was measured has been assembled.
    if measured:
        mounted: tuple[Term, ...] = ()
    elif assembled is None:
        mounted = mounting_terms(rotor, bodies, shaft, at)
    else:
        mounted = joint_terms(assembled.joints(), shaft, at)
    uncut = together if assembled is None else None  # an assembly's moments are not those of its triangles
    correction = _corrected(rotor, bodies, shaft, given, complete, uncut, planes, tolerance, mounted)
    tell(0.9)
    residual = initial if correction is None else _residual(correction, bodies, complete)
    exact = None if rotor.radial_uncertainty or measured else bounds.axis(shaft.resolve(properties), shaft.span, 1.0)
    initial_verdict = _judged(initial, tolerance, axis, rigid, exact)
    verdict = initial_verdict if correction is None else _judged(residual, tolerance, axis, rigid, exact)
    if verdict.outcome == "fail":
        verdict = replace(verdict, why=(*verdict.why, _binding(correction)))
    operations = () if correction is None else correction.operations
    further: tuple[Term, ...] = ()
    if verdict.outcome == "pass" and verdict.turned_over_by:
        loose = bounds.axis(shaft.resolve(properties), shaft.span, verdict.turned_over_by)
        further = rotor_terms(replace(residual, uncertainties=(loose,)), at)
    scatter = _scatter(rotor, residual, operations, tolerance, at, mounted, further)
    return Balance(
        rotor=rotor,
        bodies=bodies,
        axis=axis,
        properties=properties,
        initial=initial,
        residual=residual,
        tolerance=tolerance,
        correction_planes=planes,
        planes=_in_planes(rotor, initial, residual),
        correction=correction,
        verdict=count_the_shop(verdict, scatter) if axis.confirmed else verdict,
        initial_verdict=initial_verdict,
        rigid=rigid,
        tilt=principal_tilt(properties, shaft),
        scatter=scatter,
        notes=(
            *_indexed(indexing),
            *(assembled.notes if assembled else ()),
            *_slips(rotor, bodies, shaft),
            *_notes(rotor, bodies, measured is not None),
            *against(rotor, shaft),
            *moved(rotor, planes),
        ),
        indexing=indexing,
    )


def _indexing(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft) -> Indexing | None:
    """Return how the bodies are best put together; None where none may be turned."""
    if all(fields.indexing is None for fields in rotor.fields.body):
        return None
    angles = [[math.radians(angle) for angle in rotor.indexing(fields)] for fields in rotor.fields.body]
    at = (shaft.z_a, shaft.z_b)
    each = [Unbalance.of(body.analysis.properties, shaft) for body in bodies]
    together = Unbalance.of(reduce(add, (body.analysis.properties for body in bodies)), shaft)
    keyed = together.with_masses(rotor.key_masses)
    vectors = np.array([unbalance.in_many_planes(at) for unbalance in each])
    fixed = keyed.in_many_planes(at) - together.in_many_planes(at)
    best = best_indexing(vectors, fixed, rotor.tolerance(keyed, at).permissible, angles)
    return replace(best, names=tuple(body.name for body in bodies))


def _put_together(assembled: AssembledRotor, shaft: Shaft) -> tuple[AssembledRotor, Indexing] | None:
    """Return an assembly put together the best way; None where nothing is left open."""
    at = (shaft.z_a, shaft.z_b)
    together = Unbalance.of(assembled.properties, shaft)
    keyed = together.with_masses(assembled.rotor.key_masses)
    keys = keyed.in_many_planes(at) - together.in_many_planes(at)
    return assembled.put_together(shaft, assembled.rotor.tolerance(keyed, at).permissible, keys)


def _indexed(indexing: Indexing | None) -> Iterator[str]:
    """Say how the bodies are put together."""
    if indexing is None:
        return
    turns = ", ".join(
        f"{name} turned by {degrees}°"
        for name, turn, degrees in zip(indexing.names, indexing.turns, indexing.degrees, strict=True)
        if turn
    )
    count = sum(part != other for part, other in indexing.moves)
    moves = f"{count} of {len(indexing.moves)} parts in other places" if count else ""
    changes = f"{turns}, counter-clockwise from where their files have them" if turns else ""
    how = " and with ".join(each for each in (changes, moves) if each) or "nothing turned or exchanged"
    yield (
        f"bodies are put together with {how}: before corrections {indexing.left:.3g} of the limit is in the worse "
        f"plane, {indexing.as_filed:.3g} as filed; {indexing.sentence}"
    )


def _residual(correction: Correction, bodies: Sequence[RotorBody], complete: _Complete) -> Unbalance:
    """Return what a correction leaves, with what its tools may have taken of the surface over the facets."""
    residual = complete(correction.residual, correction.parts)
    layer = max(body.density * body.chord for body in bodies)
    more = surface_cut_away(correction.operations, layer, residual.z)
    return residual if more is None else residual.with_uncertainties(more)


def _binding(correction: Correction | None) -> str:
    """Return what a rotor fails by, beside its unbalance."""
    if correction is None:
        return "nothing is done about it: no plane has a method of correction"
    return f"what binds: {', '.join(correction.limits_hit) or 'the planes themselves, whatever is done in them'}"


def as_measured(
    modelled: Unbalance, measured: Sequence[tuple[float, complex, float]], spreads: Sequence[Complex] = ()
) -> Unbalance:
    """Return the unbalance that a machine showed, as `balance` takes it, on the mass and centre of mass of the meshes.

    Arithmetic and axis are nothing beside it; what else leaves the mass uncertain, which limits may follow, stays.
    """
    of_mass = ("tessellation", "input", "density")
    masses = (k.of_mass_alone for k in modelled.uncertainties if k.source in of_mass and k.masses)
    bare = replace(modelled, static=0j, couple=0j, uncertainties=tuple(masses))
    shown = bare.with_vectors([(z, vector) for z, vector, _ in measured])
    modes = tuple((complex(off), off * (z - modelled.z)) for z, _, off in measured if off)
    zs = [z for z, _, _ in measured]
    scatter = (bounds.measured(moves, zs, modelled.z) for moves in spreads)
    return shown.with_uncertainties(Uncertainty("measurement", modes), *scatter)


def _corrected(
    rotor: Rotor,
    bodies: Sequence[RotorBody],
    shaft: Shaft,
    given: Unbalance,
    complete: _Complete,
    uncut: Unbalance | None,
    planes: Sequence[CorrectionPlane],
    tolerance: Tolerance,
    mounted: Sequence[Term],
) -> Correction | None:
    """Return the correction with the fewest operations for which enough parts are within tolerance as made.

    The unbalance is given without what densities leave uncertain, which depends on what is cut of which body.
    """
    if not planes:
        return None
    parts, densities, at = [body.part for body in bodies], [body.density for body in bodies], (shaft.z_a, shaft.z_b)
    initial, asked, best, most = complete(given, None), rotor.fields.plan, None, -1.0
    limit = _aim(initial, planes, tolerance, at)
    within_limit = bool((np.abs(initial.in_planes(*at)) <= limit.permissible).all())
    until = thread_time() + asked.time
    for aim, deeper in _attempts(asked.aim, within_limit, any(plane.method == "mill_arc" for plane in planes)):
        seconds = max(until - thread_time(), _LEAST_TIME * asked.time)
        try:
            tried = correct(
                parts,
                densities,
                shaft,
                given,
                [_no_shallower(plane, deeper) for plane in planes],
                limit,
                uncut=uncut,
                aim=aim,
                seconds=seconds,
                sag=max(body.chord for body in bodies),
            )
        except (UsageError, GeometryError) as error:
            if best is not None and deeper:
                continue
            raise placed(error, rotor.name) from None
        left = _residual(tried, bodies, complete)
        scatter = _scatter(rotor, left, tried.operations, tolerance, at, mounted)
        if (scatter.within or 0.0) > most:
            best, most = tried, scatter.within or 0.0
        if thread_time() > until or scatter.enough:
            break
        if not deeper and (not tried.within or tried.worst > aim > 0):
            break
    return best


def _attempts(asked: float | Literal["least"] | None, within: bool, arcs: bool) -> list[tuple[float, float]]:
    """Return what is aimed at, one after the other until enough parts are within tolerance, and how deep arcs go then.

    Parameters
    ----------
    asked : what is to be left at most; without it a rotor that is `within` its tolerance is left as it is at first
    arcs : whether a plane takes them
    """
    aim = 0.0 if asked == "least" else asked or AIM
    attempts = [(lower * aim, 0.0) for lower in (_LOWER if aim else _LOWER[:1])]
    if arcs:
        attempts[1:1] = [(aim, share) for share in _DEEPER]
    return [(1.0, 0.0), *attempts] if asked is None and within else attempts


def _no_shallower(plane: CorrectionPlane, share: float) -> CorrectionPlane:
    """Return a plane whose arcs go to a share of their greatest depth at least.

    An error of the depth counts the less, the deeper and shorter an arc is.
    """
    if plane.method != "mill_arc" or plane.max_depth is None or not share:
        return plane
    return replace(plane, min_depth=max(plane.min_depth, share * plane.max_depth))


def _scatter(
    rotor: Rotor,
    residual: Unbalance,
    operations: Sequence[Operation],
    tolerance: Tolerance,
    at: Planes,
    mounted: Sequence[Term],
    further: Sequence[Term] = (),
) -> Scatter:
    settings, law = rotor.fields.uncertainty, tolerance.law
    return monte_carlo(
        residual.in_many_planes(at),
        (*rotor_terms(residual, at, tolerance), *mounted, *operation_terms(operations, residual, at, rotor.shop)),
        further=further,
        permissible=tolerance.permissible,
        follows=None if law is None else lambda mass, moment: law.permissible(mass, moment, residual.z),
        confidence=settings.confidence,
        draws=settings.draws,
        seed=settings.seed,
    )


def _aim(initial: Unbalance, planes: Sequence[CorrectionPlane], tolerance: Tolerance, at: Planes) -> Tolerance:
    """Return what a correction aims at so that it passes: the tolerance less what is uncertain, if that leaves any.

    What is cut is in proportion to densities as the unbalance is, what is added is not.
    """
    sizes, limits = np.abs(initial.in_planes(*at)), np.array(tolerance.permissible)
    bounds = np.array([math.fsum(k.values()) for k in tolerance.bounds(initial, at)])
    if (sizes + bounds > limits).any() and any(plane.method in _WEIGHTS for plane in planes):
        bounds = np.maximum(bounds, [math.fsum(k.values()) for k in initial.bounds_in_planes(at)])
    a, b = (limits - bounds).tolist()
    return replace(tolerance, permissible=(a, b)) if min(a, b) > 0 else tolerance


def _in_planes(rotor: Rotor, initial: Unbalance, residual: Unbalance) -> tuple[PlaneUnbalance, ...]:
    """Resolve the unbalance in the correction planes; a single one takes the static unbalance alone."""
    planes, metres = rotor.fields.plane, float(rotor.unit.metres)
    zs = [metres * plane.z for plane in planes]
    if len(zs) < 2:
        before, after = ([unbalance.static] * len(zs) for unbalance in (initial, residual))
    else:
        before, after = (unbalance.in_many_planes(zs).tolist() for unbalance in (initial, residual))
    return tuple(
        PlaneUnbalance(plane.id, z, first, last)
        for plane, z, first, last in zip(planes, zs, before, after, strict=True)
    )


def _judged(
    unbalance: Unbalance, tolerance: Tolerance, axis: Axis, rigid: RigidLimit | None, exact: Uncertainty | None
) -> Verdict:
    """Judge an unbalance; about an axis that nobody confirmed there is no verdict."""
    verdict = judge(unbalance, tolerance, (axis.shaft.z_a, axis.shaft.z_b), rigid, exact if axis.confirmed else None)
    if axis.confirmed:
        return verdict
    why = f"the axis was {axis.obtained}; write bearing_a and bearing_b into the rotor file to have a verdict"
    return replace(verdict, outcome="undecided", why=(*verdict.why, why))


def _require_places(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft) -> None:
    """Raise `GeometryError` where the axis does not go through the bodies, or a plane with a method lies off them."""
    extent = outline(bodies, shaft)
    if not extent.goes_around:
        raise GeometryError(
            f"{rotor.name}: axis: the line through bearing_a and bearing_b does not go through the rotor, all of which "
            "lies on one side of it: give the bearing centres in the part's own axes and in the file's unit"
        )
    for number, plane in enumerate(rotor.fields.plane):
        if plane.method is not None and _off(rotor, plane, extent):
            raise GeometryError(
                FieldPath(f"plane[{number}].z"),
                f" is {plane.z:g} {rotor.unit.name}, off the rotor, which goes from {in_unit(rotor, extent.low)} to "
                f"{in_unit(rotor, extent.high)} along the shaft, and nothing can be done there: move it",
                places=(rotor.name,),
            )


def _off(rotor: Rotor, plane: PlaneFields, extent: Outline) -> bool:
    """Say whether a plane lies beyond the ends of the rotor."""
    # A face whose place is written as that of the plane may differ from it by rounding.
    near = _ROUNDED * max(abs(extent.low), abs(extent.high))
    return not extent.low - near <= float(rotor.unit.metres) * plane.z <= extent.high + near


def _beyond(rotor: Rotor, extent: Outline) -> Iterator[str]:
    """Yield which planes lie beyond the ends of the rotor, as those of a machine on whose arbor it runs."""
    for plane in rotor.fields.plane:
        if _off(rotor, plane, extent):
            yield (
                f"plane {plane.id} at z = {plane.z:g} {rotor.unit.name} lies off the rotor, which goes from "
                f"{in_unit(rotor, extent.low)} to {in_unit(rotor, extent.high)} along the shaft: the unbalance is only "
                "resolved there"
            )


def _facet_notes(body: RotorBody) -> Iterator[str]:
    """Yield what the verdict takes for granted of the facets of a body, and what of the file it does not believe."""
    if body.chord_from == "shape" or not body.chord:
        return
    sag = f"{1e3 * body.layers.sag:.3g} mm"
    if body.chord_from == "mesh":
        yield (
            f"{body.name}: chord_tolerance is less than the {sag} by which its facets miss the surfaces that they "
            "stand for: the verdict counts with these"
        )
    if body.chord_from == "given" and body.chord > 2.0 * body.layers.sag:
        yield (
            f"{body.name}: chord_tolerance is more than the {sag} by which its facets miss the surfaces that they "
            "stand for: the verdict counts with it everywhere, as the vertices may lie off the surface, too"
        )
    else:
        known = body.layers.recognised
        share = "all" if known == 1.0 else f"{100.0 * known:.3g} %"
        yield (
            f"{body.name}: its vertices are taken to lie on the true surface, to which {share} of its curved facets "
            f"are known to belong as cylinders and cones; they miss it by up to {sag}, which counts as a sum of vectors"
        )


def _slips(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft) -> Iterator[str]:
    """Yield what no rotor has, or few, as it is most likely in another unit than is asked for."""
    for body in bodies:
        if not _LIGHT <= body.density <= _DENSE:
            yield (
                f"{body.name}: no rotor is of {body.density:g} kg/m³: give densities in kg/m³ (steel has 7850), masses "
                "in kg, and the unit that the file's coordinates are in"
            )
    extent = outline(bodies, shaft)
    length = extent.high - extent.low
    if shaft.span < _NEAR * length:
        yield (
            f"the bearings are {in_unit(rotor, shaft.span)} apart, on a rotor {in_unit(rotor, length)} long: give "
            "bearing_a and bearing_b, and the coordinates of bodies, in one unit"
        )
    yield from _beyond(rotor, extent)


def _notes(rotor: Rotor, bodies: Sequence[RotorBody], measured: bool) -> list[str]:
    """Return what was decided on the way."""
    notes = ["measured; what the corrections do is predicted" if measured else "predicted from geometry, not measured"]
    notes += [
        f"{body.name}: the density is assumed to be {body.density:g} kg/m³: masses and forces are in proportion to it, "
        "the verdict is not"
        for body in bodies
        if body.analysis.density_from == "assumed"
    ]
    notes += [f"{body.name}: {note}" for body in bodies for note in body.analysis.notes]
    if not measured:  # of a measured rotor the facets tell nothing
        notes += [note for body in bodies for note in _facet_notes(body)]
    if not rotor.radial_uncertainty and not measured:
        notes.append("the axis is taken as exact, as its radial_uncertainty is 0")
    if rotor.fields.service.critical_rpm is None:
        notes.append("the rotor counts as rigid, as no critical_rpm is given")
    return notes
