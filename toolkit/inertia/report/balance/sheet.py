"""`ReportData`: what the balancing report prints, in the shop's units.

Lengths are in mm, masses in kg (of operations in g), unbalances complex in g·mm, angles in degrees. The angles are
those of `inertia.balancing.unbalance`: of the heavy spot, counter-clockwise seen from bearing B looking toward A.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from inertia.arrays import Float
from inertia.balancing.verdict import Outcome

Facts = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class BodyRow:
    """A body of the rotor: its name, the SHA-256 of its file, kg/m³, kg, and the number of triangles."""

    name: str
    sha256: str | None
    density: float
    mass: float
    triangles: int


@dataclass(frozen=True)
class BearingRow:
    """A tolerance plane.

    Attributes
    ----------
    name : "A" or "B"
    z : mm
    permissible : g·mm
    share : of the total, in words; empty where the standard has no total
    uncertainty : g·mm, how far the residual may be off
    residual_95 : g·mm, which 95 % of the draws stay below; None where none were made
    outcome : of this plane
    """

    name: str
    z: float
    permissible: float
    share: str
    uncertainty: float
    residual_95: float | None
    outcome: Outcome


@dataclass(frozen=True)
class PlaneRow:
    """A correction plane: its id, z and radius in mm, what is done there, and sectors (start, stop) forbidden.

    The radius is None where nothing is done.
    """

    id: str
    z: float
    radius: float | None
    what: str
    forbidden: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class State:
    """A row of the table.

    Attributes
    ----------
    name : "initial", "correction", "residual"
    planes : g·mm in each correction plane
    bearings : g·mm in tolerance planes A and B
    static : g·mm
    couple : g·mm² about the plane of the rotor's first centre of mass
    eccentricity : µm; None for the correction
    grade : mm/s, the balance quality achieved; None for the correction
    forces : N on bearings A and B
    """

    name: str
    planes: tuple[complex, ...]
    bearings: tuple[complex, complex]
    static: complex
    couple: complex
    eccentricity: float | None
    grade: float | None
    forces: tuple[float, float]


@dataclass(frozen=True)
class OperationRow:
    """A line of the shop sheet.

    Attributes
    ----------
    id, plane : of the operation and its correction plane
    z : mm
    face : "outside", "to A", "to B"
    method : "ADD" or "REMOVE"
    tool : in words
    angle : degrees
    radius : mm
    diameter, point : mm and degrees, of a drill
    depth, depth_tolerance : mm
    mass : g
    unbalance : g·mm, magnitude
    wall : mm of material that stays under the tool
    per_tenth : g·mm that the residual changes by in its worse plane, for 0.1 mm of depth, or of a mass's radius; None
        where it is taken as exact
    per_degree : the same for 1° of angle
    """

    id: str
    plane: str
    z: float
    face: str
    method: Literal["ADD", "REMOVE"]
    tool: str
    angle: float
    radius: float
    diameter: float | None
    point: float | None
    depth: float | None
    depth_tolerance: float | None
    mass: float
    unbalance: float
    wall: float | None
    per_tenth: float | None
    per_degree: float | None


@dataclass(frozen=True)
class SensitivityRow:
    """What one input does: its name, the step, g·mm at A and B for that step, and its shares of the variance."""

    name: str
    step: str
    per_step: tuple[float, float]
    share: tuple[float, float]


@dataclass(frozen=True, eq=False)
class ReportData:
    """Everything that the report prints.

    Attributes
    ----------
    part : what the report is about
    serial, revision : as the rotor file names them; None is left blank, to be filled in by hand
    date : of this report
    version : of this program
    rotor_facts, service_facts : (label, text) about the rotor, and about its axis, speed and limits
    zero_mark : what lies at 0°, in words
    rotation : "ccw" or "cw" seen from B looking toward A
    rpm : service speed
    bodies : a row for each
    file : (name, SHA-256) of the rotor file; None without one
    standard, rule : the criterion with its edition, and its formula
    total : g·mm, permissible for the whole rotor, where the standard has one
    bearings : tolerance planes A and B
    planes : correction planes
    center : mm, where the centre of mass is along the shaft
    outline : (n, 2) mm: z and the largest radius there
    outcome, why : the verdict, and in sentences
    notes : what else has to be known, in sentences
    states : the rotor before, what the correction does to it, and what is left
    operations : the shop sheet
    no_operation : why there are none; empty where there are some
    sensitivities : what matters most first
    """

    part: str
    serial: str | None
    revision: str | None
    date: str
    version: str
    rotor_facts: Facts
    service_facts: Facts
    zero_mark: str
    rotation: Literal["ccw", "cw"]
    rpm: float
    bodies: tuple[BodyRow, ...]
    file: tuple[str, str] | None
    standard: str
    rule: str
    total: float | None
    bearings: tuple[BearingRow, BearingRow]
    planes: tuple[PlaneRow, ...]
    center: float
    outline: Float
    outcome: Outcome
    why: tuple[str, ...]
    notes: tuple[str, ...]
    states: tuple[State, State, State]
    operations: tuple[OperationRow, ...]
    no_operation: str
    sensitivities: tuple[SensitivityRow, ...]
