"""`ReportData`: every figure of a balance that is reported, computed once; text, JSON, CSV and HTML are made from it.

Lengths are in mm, masses in kg (of operations in g), forces in N, angles in degrees, unbalances complex in kg m. The
angles are those of `inertia.balancing.unbalance`: of the heavy spot, counter-clockwise seen from bearing B looking
toward A.
"""

from __future__ import annotations

import datetime
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from inertia import __version__
from inertia.arrays import Float
from inertia.balancing.axis.rotor_axis import Axis
from inertia.balancing.axis.tilt import Tilt
from inertia.balancing.balance import Balance
from inertia.balancing.bounds import Source
from inertia.balancing.correction_fields import KeyFields
from inertia.balancing.corrections.correction_plane import Process
from inertia.balancing.corrections.operation import Kind, Method, Operation
from inertia.balancing.forces import RigidLimit
from inertia.balancing.monte_carlo import Scatter
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import ChordFrom, RotorBody
from inertia.balancing.rotor_fields import ReportFields, ServiceFields
from inertia.balancing.tolerance import Share, Tolerance
from inertia.balancing.unbalance import Kind as UnbalanceKind
from inertia.balancing.unbalance import Unbalance
from inertia.balancing.verdict import Outcome
from inertia.mesh.part import Part
from inertia.mesh.part import Source as FileSource

MM = 1e3
"""mm in a metre."""
TURNS = {"ccw": "counter-clockwise", "cw": "clockwise"}
"""The senses of rotation in words."""
KINDS: dict[Kind, str] = {
    "point_mass": "point mass",
    "drill_radial": "radial hole",
    "drill_axial": "axial hole",
    "mill_flat": "flat",
    "weight": "weight",
}
"""The kinds of operation in words."""


@dataclass(frozen=True)
class BodyRow:
    """A body of the rotor, and the file that it comes from: kg/m³, kg, and mm that its chords may be off."""

    name: str
    path: str | None
    sha256: str | None
    unit: str
    density: float
    density_from: str
    mass: float
    triangles: int
    chord: float
    chord_from: ChordFrom


@dataclass(frozen=True)
class BearingRow:
    """A tolerance plane.

    Attributes
    ----------
    name : "A" or "B"
    z : mm
    permissible : kg m
    share : of the total; None where the standard has no total
    residual_95 : kg m, which 95 % of the draws stay below
    outcome : of this plane
    """

    name: str
    z: float
    permissible: float
    share: Share | None
    residual_95: float
    outcome: Outcome


@dataclass(frozen=True)
class PlaneRow:
    """A correction plane: its id and z (mm); how it is corrected, at which radius (mm), None where nothing is done.

    `face` is the one that axial holes enter, `forbidden` are sectors (start, stop) that no tool may come into.
    """

    id: str
    z: float
    method: Process | None = None
    radius: float | None = None
    face: str | None = None
    forbidden: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Vectors:
    """An unbalance, or a change of one, wherever it is looked at.

    Attributes
    ----------
    name : "initial", "correction", "residual"
    planes : kg m in each correction plane
    bearings : kg m in tolerance planes A and B
    static : kg m
    couple : kg m² about the plane of the rotor's first centre of mass
    forces : N on bearings A and B
    """

    name: str
    planes: tuple[complex, ...]
    bearings: tuple[complex, complex]
    static: complex
    couple: complex
    forces: tuple[float, float]


@dataclass(frozen=True)
class State(Vectors):
    """The unbalance of the rotor before or after correction.

    Attributes
    ----------
    mass, z : kg and mm, of its centre of mass
    kind : of its unbalance
    couple_about_center : kg m² about its own centre of mass
    static_bounds, couple_bounds : how far static unbalance and couple may be off, by source
    bearing_bounds : kg m, how far the vectors in tolerance planes A and B may be off, by source
    eccentricity : µm
    grade : mm/s, the balance quality achieved
    torque : N m, which the couple takes of the axle
    forces_running_up : N on bearings A and B while the rotor runs up
    outcome : of the verdict on it
    """

    mass: float
    z: float
    kind: UnbalanceKind
    couple_about_center: complex
    static_bounds: dict[Source, float]
    couple_bounds: dict[Source, float]
    bearing_bounds: tuple[dict[Source, float], dict[Source, float]]
    eccentricity: float
    grade: float
    torque: float
    forces_running_up: tuple[float, float]
    outcome: Outcome


@dataclass(frozen=True)
class OperationRow:
    """An operation of the shop.

    Attributes
    ----------
    id, plane : of the operation and its correction plane
    method, kind : whether it adds or removes mass, and how
    z, radius : mm
    angle : degrees
    diameter, point : mm and degrees, of a drill
    depth, depth_tolerance, width : mm
    mass : g
    unbalance : kg m
    wall : mm of material that stays under the tool
    pieces, item : weights of a kit, and what it calls them
    per_tenth : kg m that the residual changes by in its worse plane, for 0.1 mm of depth, or of a mass's radius; None
        where it is taken as exact
    per_degree : the same for 1° of angle
    """

    id: str
    plane: str
    method: Method
    kind: Kind
    z: float
    angle: float
    radius: float
    mass: float
    unbalance: complex
    diameter: float | None = None
    point: float | None = None
    depth: float | None = None
    depth_tolerance: float | None = None
    width: float | None = None
    wall: float | None = None
    pieces: int = 1
    item: str | None = None
    per_tenth: float | None = None
    per_degree: float | None = None


@dataclass(frozen=True, eq=False)
class ReportData:
    """Everything that is reported of a balance.

    Attributes
    ----------
    rotor : its file's name, or what it is called
    head : part, serial, revision, customer and remark as the rotor file names them
    date, version : of this report, and of this program
    file : (name, SHA-256) of the rotor file; None without one
    bodies : a row for each
    parts : their meshes
    axis : the shaft, how it was obtained, and candidates for it
    zero_mark : (3,) part axes, as given
    radial_uncertainty : mm about each bearing centre
    keys, metres : as in the rotor file, and what its unit of length is
    service : speeds and acceleration
    rigid : how near the critical speed is; None where it is not given
    tilt : of the principal axis from the shaft
    tolerance : the criterion and its formula
    bearings : tolerance planes A and B
    planes : correction planes
    initial, correction, residual : the rotor before, what the correction does to it, and what is left
    operations : what the shop does
    corrected : whether a plane has a method of correction
    cuts, within, limits_hit, ending : how the search for the operations went
    scatter : how the residual may turn out, and what matters most first
    verdict : on the residual, in sentences
    notes : what else has to be known, in sentences
    """

    rotor: str
    head: ReportFields
    date: str
    version: str
    file: tuple[str, str] | None
    bodies: tuple[BodyRow, ...]
    parts: tuple[Part, ...]
    axis: Axis
    zero_mark: Float
    radial_uncertainty: float
    keys: tuple[KeyFields, ...]
    metres: float
    service: ServiceFields
    rigid: RigidLimit | None
    tilt: Tilt
    tolerance: Tolerance
    bearings: tuple[BearingRow, BearingRow]
    planes: tuple[PlaneRow, ...]
    initial: State
    correction: Vectors
    residual: State
    operations: tuple[OperationRow, ...]
    corrected: bool
    cuts: int
    within: bool
    limits_hit: tuple[str, ...]
    ending: str
    scatter: Scatter
    verdict: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def part(self) -> str:
        """What the report is about."""
        return self.head.part or Path(self.rotor).stem

    @property
    def outcome(self) -> Outcome:
        """The verdict."""
        return self.residual.outcome

    @property
    def states(self) -> tuple[Vectors, Vectors, Vectors]:
        """The rotor before, what the correction does to it, and what is left: the first two make up the third."""
        return self.initial, self.correction, self.residual

    @cached_property
    def outline(self) -> Float:
        """The largest radius at each place along the shaft, (n, 2) mm: z and radius."""
        from inertia.report.svg.silhouette import silhouette

        return MM * silhouette(self.parts, self.axis.shaft)


def report_data(balance: Balance, date: str | None = None) -> ReportData:
    """Return what is reported of a balance.

    Parameters
    ----------
    balance : what `inertia.balance` returned
    date : of the report; today without it
    """
    rotor, correction = balance.rotor, balance.correction
    initial = _state(balance, "initial", balance.initial)
    residual = _state(balance, "residual", balance.residual)
    return ReportData(
        rotor=rotor.name,
        head=rotor.fields.report,
        date=date or datetime.date.today().isoformat(),
        version=__version__,
        file=_file(rotor),
        bodies=tuple(map(_body, balance.bodies)),
        parts=tuple(body.part for body in balance.bodies),
        axis=balance.axis,
        zero_mark=rotor.fields.axis.zero_mark,
        radial_uncertainty=MM * rotor.radial_uncertainty,
        keys=rotor.fields.key,
        metres=float(rotor.unit.metres),
        service=rotor.fields.service,
        rigid=balance.rigid,
        tilt=balance.tilt,
        tolerance=balance.tolerance,
        bearings=(_bearing(balance, 0), _bearing(balance, 1)),
        planes=_planes(balance),
        initial=initial,
        correction=_change(initial, residual, balance.rotor.speed),
        residual=residual,
        operations=() if correction is None else tuple(_operation(balance, work) for work in correction.operations),
        corrected=correction is not None,
        cuts=0 if correction is None else correction.iterations,
        within=correction is not None and correction.within,
        limits_hit=() if correction is None else correction.limits_hit,
        ending="" if correction is None else correction.why,
        scatter=balance.scatter,
        verdict=balance.verdict.why,
        notes=balance.notes,
    )


def _file(rotor: Rotor) -> tuple[str, str] | None:
    """Return the rotor file's name and SHA-256; None where the rotor was not read from one."""
    if rotor.text is None or not Path(rotor.name).is_file():
        return None
    return Path(rotor.name).name, FileSource(rotor.name, "toml").sha256 or ""


def _body(body: RotorBody) -> BodyRow:
    source, analysis = body.part.source, body.analysis
    return BodyRow(
        name=body.name,
        path=source.path,
        sha256=source.sha256,
        unit=body.part.unit.name,
        density=body.density,
        density_from=analysis.density_from,
        mass=analysis.properties.mass,
        triangles=analysis.triangles,
        chord=MM * body.chord,
        chord_from=body.chord_from,
    )


def _bearing(balance: Balance, number: int) -> BearingRow:
    plane, shares = balance.verdict.planes[number], balance.tolerance.shares
    return BearingRow(
        name=plane.name,
        z=MM * balance.tolerance_planes[number],
        permissible=plane.permissible,
        share=None if shares is None else shares[number],
        residual_95=float(balance.scatter.residual_95[number]),
        outcome=plane.outcome,
    )


def _planes(balance: Balance) -> tuple[PlaneRow, ...]:
    rows = {plane.id: PlaneRow(plane.id, MM * plane.z) for plane in balance.planes}
    for plane in balance.correction_planes:
        sectors = tuple((math.degrees(k.start) % 360.0, math.degrees(k.stop) % 360.0) for k in plane.forbidden)
        rows[plane.id] = PlaneRow(plane.id, rows[plane.id].z, plane.method, MM * plane.radius, plane.face, sectors)
    return tuple(rows.values())


def _state(balance: Balance, name: str, unbalance: Unbalance) -> State:
    residual = name == "residual"
    verdict = balance.verdict if residual else balance.initial_verdict
    a, b = verdict.planes
    force_a, force_b = balance.forces(unbalance)
    starting_a, starting_b = balance.forces_running_up(unbalance)
    return State(
        name=name,
        planes=tuple(plane.residual if residual else plane.initial for plane in balance.planes),
        bearings=(a.residual, b.residual),
        static=unbalance.static,
        couple=unbalance.couple_about(balance.initial.z),
        forces=(abs(force_a), abs(force_b)),
        mass=unbalance.mass,
        z=MM * unbalance.z,
        kind=unbalance.kind,
        couple_about_center=unbalance.couple,
        static_bounds=unbalance.bounds_of(1.0, 0.0),
        couple_bounds=unbalance.bounds_of(0.0, 1.0),
        bearing_bounds=(a.bounds, b.bounds),
        eccentricity=1e6 * unbalance.eccentricity,
        grade=balance.achieved_grade(unbalance),
        torque=abs(balance.torque(unbalance)),
        forces_running_up=(abs(starting_a), abs(starting_b)),
        outcome=verdict.outcome,
    )


def _change(first: Vectors, last: Vectors, speed: float) -> Vectors:
    """Return what takes one to the other."""
    a, b = (after - before for before, after in zip(first.bearings, last.bearings, strict=True))
    return Vectors(
        "correction",
        planes=tuple(after - before for before, after in zip(first.planes, last.planes, strict=True)),
        bearings=(a, b),
        static=last.static - first.static,
        couple=last.couple - first.couple,
        forces=(speed**2 * abs(a), speed**2 * abs(b)),
    )


def _operation(balance: Balance, work: Operation) -> OperationRow:
    rates = {line.name: float(line.per_step.max()) for line in balance.scatter.sensitivities}
    depth = rates.get(f"{work.id}: depth")
    return OperationRow(
        id=work.id,
        plane=work.plane,
        method=work.method,
        kind=work.kind,
        z=MM * work.z,
        angle=math.degrees(work.angle),
        radius=MM * work.radius,
        mass=1e3 * work.mass,
        unbalance=work.unbalance,
        diameter=_mm(work.tool_diameter),
        point=None if work.point_angle is None else math.degrees(work.point_angle),
        depth=_mm(work.depth),
        depth_tolerance=None if work.depth is None else MM * balance.rotor.shop.depth,
        width=_mm(work.width),
        wall=_mm(work.remaining_wall),
        pieces=work.pieces,
        item=work.item,
        per_tenth=rates.get(f"{work.id}: radius") if depth is None else depth,
        per_degree=rates.get(f"{work.id}: angle"),
    )


def _mm(length: float | None) -> float | None:
    return None if length is None else MM * length
