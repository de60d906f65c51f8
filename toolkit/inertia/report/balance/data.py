"""`ReportData`: all that is reported of a balance; text, JSON, CSV and HTML are made from it.

Lengths are in mm, masses in kg (of operations in g), forces in N, angles in degrees, unbalances complex in kg m. The
angles are those of `inertia.balancing.unbalance`: of the heavy spot, counter-clockwise seen from bearing B looking
toward A.
"""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path

from inertia.arrays import Float
from inertia.balancing.axis.location import Axis
from inertia.balancing.axis.tilt import Tilt
from inertia.balancing.bounds import Source
from inertia.balancing.correction_fields import KeyFields
from inertia.balancing.corrections.correction_plane import Process, point_length
from inertia.balancing.corrections.operation import Kind, Method
from inertia.balancing.forces import RigidLimit
from inertia.balancing.indexing import Indexing
from inertia.balancing.machine_angles import MachineAngles
from inertia.balancing.monte_carlo import Scatter
from inertia.balancing.rotor_bodies import ChordFrom
from inertia.balancing.rotor_fields import ReportFields, ServiceFields
from inertia.balancing.shop_digits import ShopDigits
from inertia.balancing.shop_units import angular_speed, in_gmm
from inertia.balancing.tolerance import Share, Tolerance
from inertia.balancing.unbalance import Kind as UnbalanceKind
from inertia.balancing.verdict import Outcome, Verdict
from inertia.mesh.part import Part
from inertia.records import dataclass
from inertia.report.numerals import decimals_of, grams

MM = 1e3
"""mm in a metre."""
TURNS = {"ccw": "counter-clockwise", "cw": "clockwise"}
"""The senses of rotation in words."""
KINDS: dict[Kind, str] = {
    "point_mass": "point mass",
    "drill_radial": "radial hole",
    "drill_axial": "axial hole",
    "mill_flat": "flat",
    "mill_arc": "arc",
    "weight": "weight",
}
"""The kinds of operation in words."""


@dataclass(frozen=True)
class BodyRow:
    """A body of the rotor, and the file that it comes from: kg/m³, kg, and mm that its chords may be off.

    Of density and mass as given also the standard uncertainty; 0 where none is given.
    """

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
    density_uncertainty: float = 0.0
    mass_uncertainty: float = 0.0


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

    `face` is the one that axial holes enter, at `entry` (mm) along the shaft; `forbidden` are sectors (start, stop)
    that no tool may come into.
    """

    id: str
    z: float
    method: Process | None = None
    radius: float | None = None
    face: str | None = None
    forbidden: tuple[tuple[float, float], ...] = ()
    entry: float | None = None


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
    machine_angle : degrees, as the balancing machine counts them
    diameter, point : mm and degrees, of a drill, or mm of a cutter
    depth, depth_tolerance, width : mm
    arc : degrees between the ends of an arc
    ends : (start, end) of what an arc takes of the rim, degrees counter-clockwise, a cutter's reach included
    machine_ends : the same as the balancing machine counts them, in its sense
    passes : in which an arc is taken
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
    arc: float | None = None
    ends: tuple[float, float] | None = None
    machine_ends: tuple[float, float] | None = None
    passes: int = 1
    wall: float | None = None
    pieces: int = 1
    item: str | None = None
    per_tenth: float | None = None
    per_degree: float | None = None
    machine_angle: float = math.nan

    @property
    def span(self) -> float:
        """How much of the rim an arc takes, degrees."""
        return 0.0 if self.ends is None else (self.ends[1] - self.ends[0]) % 360.0

    @property
    def point_alone(self) -> float | None:
        """How deep a drill's point goes, mm, where its full diameter only just enters; None for any other depth."""
        if self.point is None or self.diameter is None or self.depth != 0.0:
            return None
        return point_length(self.diameter, math.radians(self.point))

    @property
    def along_rim(self) -> float:
        """The same in mm."""
        return math.radians(self.span) * self.radius


@dataclass(frozen=True, eq=False)
class ReportData:
    """Everything that is reported of a balance.

    Attributes
    ----------
    rotor : its file's name, or what it is called
    head : part, serial, revision, customer and remark as the rotor file names them
    date, version : of this report, and of this program
    file : (name, SHA-256) of the rotor file; None without one
    assembly_file : the same of the assembly that it names
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
    plan : how near the best there can be it is, in a sentence
    worst, bound, fewest, cut_short : the same in figures, see `Correction`
    scatter : how the residual may turn out, and what matters most first
    verdict : on the residual
    notes : what else has to be known, in sentences
    indexing : how the bodies are put together; None where none may be turned
    assembled : whether the rotor is an assembly
    machine : how the balancing machine counts angles
    digits : decimals that the figures of the work take
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
    plan: str
    worst: float
    bound: float
    fewest: int
    cut_short: bool
    scatter: Scatter
    verdict: Verdict
    notes: tuple[str, ...]
    indexing: Indexing | None = None
    assembled: bool = False
    assembly_file: tuple[str, str] | None = None
    machine: MachineAngles = MachineAngles()
    digits: ShopDigits = ShopDigits()

    @property
    def part(self) -> str:
        """What the report is about."""
        return self.head.part or Path(self.rotor).stem

    @property
    def origin(self) -> str:
        """How the rotor's own unbalance is known: "modelled" from its meshes, or "measured" by a machine."""
        return "measured" if "measurement" in self.initial.bearing_bounds[0] else "modelled"

    @property
    def decimals(self) -> int:
        """Of lengths, mm, as they are printed: two, and more on a rotor of a few millimetres."""
        return decimals_of(abs(self.bearings[1].z - self.bearings[0].z), 2)

    @property
    def gmm_decimals(self) -> int:
        """Of unbalances, g·mm, as they are printed (`inertia.report.numerals.scaled`): four digits of the limits."""
        return decimals_of(min(in_gmm(k.permissible) for k in self.bearings))

    def grams(self, mass: float) -> str:
        """Return a mass of the work, g, written as the others of it are."""
        return grams(mass, self.digits.mass, min(work.mass for work in self.operations))

    @property
    def force_decimals(self) -> int:
        """The same of forces, N."""
        limit = min(k.permissible for k in self.bearings)
        return decimals_of(limit * angular_speed(self.service.rpm) ** 2)

    @property
    def basis(self) -> str:
        """What the unbalance comes from: meshes, or a machine."""
        if self.origin == "measured":
            return "unbalance as measured – what the corrections do is predicted"
        return "predicted from geometry – not a measurement"

    @property
    def outcome(self) -> Outcome:
        """The verdict."""
        return self.residual.outcome

    @property
    def states(self) -> tuple[Vectors, Vectors, Vectors]:
        """The rotor before, what the correction does to it, and what is left: the first two make up the third."""
        return self.initial, self.correction, self.residual

    def steps(self, plane: PlaneRow) -> list[tuple[int, OperationRow]]:
        """Return the operations of a plane, each with the number of its step."""
        return [(k, work) for k, work in enumerate(self.operations, 1) if work.plane == plane.id]

    def section(self, plane: PlaneRow) -> list[Float]:
        """Return the loops (k, 2) mm of the rotor's section at a correction plane; under its face, for axial work."""
        from inertia.report.svg.section import section

        deep = max((work.depth or 0.0 for _, work in self.steps(plane)), default=0.0)
        begins = plane.z if plane.entry is None else plane.entry
        inward = {"a": 0.5, "b": -0.5}.get(plane.face or "", 0.0)
        return [MM * loop for loop in section(self.parts, self.axis.shaft, (begins + inward * deep) / MM)]

    @cached_property
    def outline(self) -> Float:
        """How the rotor looks from the side, (n, 3) mm: z, and how far it reaches up and down there."""
        from inertia.report.svg.silhouette import silhouette

        return MM * silhouette(self.parts, self.axis.shaft)
