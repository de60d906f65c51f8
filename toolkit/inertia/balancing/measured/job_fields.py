"""The sections of a balancing job: what each field may hold, as the file has it.

Lengths are in the file's `unit`, angles in degrees, masses in grams, vibration in the unit of its sensor.
`inertia.balancing.measured.job` turns them into complex numbers whose angles run as the rotor's do.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date, time
from typing import Annotated, Any, ClassVar, Literal, get_args

from inertia.balancing.correction_fields import EvenAngles, WeightFields
from inertia.balancing.measured.influence import Criterion
from inertia.balancing.measured.unbalance_units import UnbalanceUnit, unbalance_unit
from inertia.balancing.measured.vibration_units import vibration_unit
from inertia.balancing.rotor_fields import unit
from inertia.documents import (
    FieldError,
    Reader,
    Section,
    choice,
    flag,
    integer,
    layout_version,
    number,
    section_of,
    several,
    table,
    tables,
    text,
)
from inertia.errors import UsageError
from inertia.records import dataclass

Method = Literal["influence coefficients", "without phase", "balancing machine"]

_LENGTH = "the file's unit"


def _vibration_unit(value: Any, path: str) -> str:
    name: str = text(value, path)
    try:
        return vibration_unit(name).name
    except UsageError as error:
        raise FieldError(path, error.sentence) from None


def _positions(value: Any, path: str) -> tuple[float, ...]:
    if isinstance(value, EvenAngles):
        return tuple(value.offset + 360.0 * k / value.count for k in range(value.count))
    if isinstance(value, Mapping):
        return _positions(section_of(EvenAngles, value, path=path), path)
    listed: tuple[float, ...] = _DEGREES(value, path)
    return listed


def _moment(value: Any, path: str) -> str:
    """Read a date or a time, as TOML has them or as text."""
    said: str = text(value.isoformat() if isinstance(value, date | time) else value, path)
    return said


_MOMENT = Reader(_moment, text.schema)
_DEGREES = several(number("degrees"))
_POSITIONS = Reader(_positions, {"oneOf": [table(EvenAngles).schema, _DEGREES.schema]})


@dataclass(frozen=True, eq=False)
class ConventionFields(Section):
    """The section ``[conventions]``: in which sense angles and phases are counted.

    Attributes
    ----------
    angles : the sense in which the places of weights are counted on the rotor: "with rotation" or "against rotation"
    phase : "lag" where the reading says by how much the vibration's peak comes after the mark, "lead" where before it
    shows : of a balancing machine: the angle of the "unbalance", the heavy spot, or of the "correction" to be added
    zero : degrees, where the mark of these angles is by those of the rotor file
    """

    section: ClassVar[str] = "conventions"

    angles: Annotated[Literal["with rotation", "against rotation"], choice("with rotation", "against rotation")]
    phase: Annotated[Literal["lag", "lead"] | None, choice("lag", "lead")] = None
    shows: Annotated[Literal["unbalance", "correction"] | None, choice("unbalance", "correction")] = None
    zero: Annotated[float, number("degrees")] = 0.0


@dataclass(frozen=True, eq=False)
class MachineFields(Section):
    """The section ``[machine]``: what was measured with, and by whom, as the certificate states it.

    Attributes
    ----------
    name, serial, calibration, operator, date, place, remark : as the shop writes them
    unit : of a balancing machine's readings: "g·mm" or "oz·in", with ".", "*" or "-" for the dot too
    floor : half-width of the noise of a balancing machine in that unit, its minimum achievable residual unbalance
    """

    section: ClassVar[str] = "machine"

    name: Annotated[str | None, text] = None
    serial: Annotated[str | None, text] = None
    calibration: Annotated[str | None, text] = None
    operator: Annotated[str | None, text] = None
    date: Annotated[str | None, _MOMENT] = None
    place: Annotated[str | None, text] = None
    remark: Annotated[str | None, text] = None
    unit: Annotated[UnbalanceUnit, unbalance_unit()] = "g·mm"
    floor: Annotated[float, number("the machine's unit", negative=False)] = 0.0


@dataclass(frozen=True, eq=False)
class RunoutFields(Section):
    """The runout of the surface that a pickup looks at, as it reads it at low speed.

    Attributes
    ----------
    amplitude : in the sensor's unit
    phase : degrees
    """

    section: ClassVar[str] = "runout"

    amplitude: Annotated[float, number("the sensor's unit", negative=False)]
    phase: Annotated[float, number("degrees")]


@dataclass(frozen=True, eq=False)
class SensorFields(Section):
    """One of ``[[sensor]]``: a vibration pickup.

    Attributes
    ----------
    id : its name
    unit : of its readings, as "mm/s rms", "µm pp", "mil pp"
    importance : of its readings beside the others': p in Σ p |V|², or in the largest √p |V|
    amplitude : half-width of what its amplitudes may be off by, as a part of them; of the job without it
    floor : half-width of its noise, in its unit
    phase : half-width of what its phases may be off by, degrees; of the job without it
    runout : {amplitude, phase} at low speed, which is taken off its readings
    """

    section: ClassVar[str] = "sensor"

    id: Annotated[str, text]
    unit: Annotated[str, Reader(_vibration_unit, text.schema)]
    importance: Annotated[float, number("", positive=True)] = 1.0
    amplitude: Annotated[float | None, number("", negative=False, below=1.0)] = None
    floor: Annotated[float, number("the sensor's unit", negative=False)] = 0.0
    phase: Annotated[float | None, number("degrees", negative=False, below=180.0)] = None
    runout: Annotated[RunoutFields | None, table(RunoutFields)] = None


@dataclass(frozen=True, eq=False)
class MeasuredPlaneFields(Section):
    """One of ``[[plane]]``: where weights are mounted, or where a balancing machine shows the unbalance.

    Attributes
    ----------
    id : its name; that of a correction plane of the rotor file has its place and radius
    z : place along the shaft, as in the rotor file
    radius : of the weights; without one they are stated in grams alone
    max_mass_g : of the whole correction, grams
    positions : degrees where weights can be mounted: {count, offset}, or a list; anywhere without it
    position_max_g : grams at one position
    mass_step_g : grams, what the shop can weigh
    kit : the weights at hand, in place of a step
    most_per_position : weights of the kit at one position
    permissible_gmm : residual unbalance that is permissible here, where no rotor file says so
    """

    section: ClassVar[str] = "plane"

    id: Annotated[str, text]
    z: Annotated[float | None, number(_LENGTH)] = None
    radius: Annotated[float | None, number(_LENGTH, positive=True)] = None
    max_mass_g: Annotated[float | None, number("g", positive=True)] = None
    positions: Annotated[tuple[float, ...] | None, _POSITIONS] = None
    position_max_g: Annotated[float | None, number("g", positive=True)] = None
    mass_step_g: Annotated[float, number("g", negative=False)] = 0.0
    kit: Annotated[tuple[WeightFields, ...] | None, tables(WeightFields, least=1)] = None
    most_per_position: Annotated[int, integer(1, 1000)] = 1
    permissible_gmm: Annotated[float | None, number("g·mm", positive=True)] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where a limit has nothing to limit."""
        for name in ("position_max_g", "kit"):
            if getattr(self, name) and self.positions is None:
                raise FieldError(f"{path}.{name}", f"goes with positions: give {path}.positions, or leave it out")
        if self.kit and (self.mass_step_g or self.position_max_g):
            raise FieldError(f"{path}.kit", "says what there is to mount: leave mass_step_g and position_max_g out")
        for k, weight in enumerate(self.kit or ()):
            if weight.radius is not None and weight.radius != self.radius:
                raise FieldError(
                    f"{path}.kit[{k}].radius",
                    f"is another than the plane's, {path}.radius, at which a job counts all masses: leave it out, and "
                    f"give as mass_g what makes the same unbalance there",
                )


@dataclass(frozen=True, eq=False)
class MountedFields(Section):
    """One of the weights of a run.

    Attributes
    ----------
    plane : where
    angle : degrees
    mass_g : grams; negative where mass was taken away
    gmm : what it adds to the unbalance, g·mm, in place of a mass; negative where it was drilled away
    radius : at which the mass counts, of what a hole takes that of its centre; the plane's own without it
    stays : whether it stays on for the runs that follow; a trial weight does not
    """

    section: ClassVar[str] = "weights"

    plane: Annotated[str, text]
    angle: Annotated[float, number("degrees")]
    mass_g: Annotated[float | None, number("g")] = None
    gmm: Annotated[float | None, number("g·mm")] = None
    radius: Annotated[float | None, number(_LENGTH, positive=True)] = None
    stays: Annotated[bool, flag] = False

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where there is no weight, or two."""
        if (self.mass_g is None) == (self.gmm is None):
            raise FieldError(path, "says what was mounted twice or not at all: give one of mass_g and gmm")
        for name in ("mass_g", "gmm"):
            if getattr(self, name) == 0:
                raise FieldError(f"{path}.{name}", "is 0: leave the weight out")
        if self.radius is not None and self.mass_g is None:
            raise FieldError(f"{path}.radius", "goes with mass_g: leave it out of a weight in g·mm")


@dataclass(frozen=True, eq=False)
class ReadingFields(Section):
    """One reading of a run.

    Attributes
    ----------
    sensor : which pickup; of a balancing machine the plane
    rpm : r/min; the job's own speed without it
    amplitude : in the sensor's unit, or the machine's
    phase : degrees
    """

    section: ClassVar[str] = "readings"

    sensor: Annotated[str, text]
    amplitude: Annotated[float, number("the sensor's unit", negative=False)]
    phase: Annotated[float | None, number("degrees")] = None
    rpm: Annotated[float | None, number("r/min", positive=True)] = None


@dataclass(frozen=True, eq=False)
class RunFields(Section):
    """One of ``[[run]]``: the machine as it was, and what was read; in the order in which it was run.

    Attributes
    ----------
    id : its name
    time, remark : as the shop writes them
    weights : what was mounted for it
    readings : what was read; those of the table of readings that name the run are added
    indexed : degrees by which the rotor was turned on its tooling, in the sense of the angles
    """

    section: ClassVar[str] = "run"

    id: Annotated[str, text]
    time: Annotated[str | None, _MOMENT] = None
    remark: Annotated[str | None, text] = None
    weights: Annotated[tuple[MountedFields, ...], tables(MountedFields)] = ()
    readings: Annotated[tuple[ReadingFields, ...], tables(ReadingFields)] = ()
    indexed: Annotated[float, number("degrees")] = 0.0


@dataclass(frozen=True, eq=False)
class ReadingUncertaintyFields(Section):
    """The section ``[uncertainty]``: how well readings and weights are known, as half-widths.

    Attributes
    ----------
    amplitude : of a reading, as a part of it
    phase : of a reading, degrees
    mass : of a mounted weight, as a part of it
    angle : of a mounted weight, degrees
    """

    section: ClassVar[str] = "uncertainty"

    amplitude: Annotated[float | None, number("", negative=False, below=1.0)] = None
    phase: Annotated[float | None, number("degrees", negative=False, below=180.0)] = None
    mass: Annotated[float, number("", negative=False, below=1.0)] = 0.005
    angle: Annotated[float, number("degrees", negative=False, below=180.0)] = 0.5


@dataclass(frozen=True, eq=False)
class AcceptanceFields(Section):
    """The section ``[tolerance]``: what is permissible, beside what a rotor file says.

    Attributes
    ----------
    vibration : amplitude that no reading may exceed, in the unit of each sensor
    grade : balance quality grade G, mm/s; the permissible unbalance is shared equally among the planes
    mass : kg, of the rotor, for the grade
    rpm : r/min, highest in service, for the grade
    """

    section: ClassVar[str] = "tolerance"

    vibration: Annotated[float | None, number("the sensors' unit", positive=True)] = None
    grade: Annotated[float | None, number("mm/s", positive=True)] = None
    mass: Annotated[float | None, number("kg", positive=True)] = None
    rpm: Annotated[float | None, number("r/min", positive=True)] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where a grade lacks what it takes."""
        for name in ("mass", "rpm"):
            if self.grade is not None and getattr(self, name) is None:
                raise FieldError(f"{path}.{name}", "is missing: a grade permits G m/ω")
            if self.grade is None and getattr(self, name) is not None:
                raise FieldError(f"{path}.{name}", "goes with a grade: give one, or leave it out")


@dataclass(frozen=True, eq=False)
class HeadFields(Section):
    """The section ``[report]``: what the certificate says of the rotor.

    Attributes
    ----------
    part, serial, revision, customer, remark : as the shop writes them
    """

    section: ClassVar[str] = "report"

    part: Annotated[str | None, text] = None
    serial: Annotated[str | None, text] = None
    revision: Annotated[str | None, text] = None
    customer: Annotated[str | None, text] = None
    remark: Annotated[str | None, text] = None


@dataclass(frozen=True, eq=False)
class JobFields(Section):
    """A balancing job.

    Attributes
    ----------
    conventions : in which sense angles are counted
    plane : where weights are mounted
    run : what was done, in order
    schema : the version of the layout
    method : "influence coefficients" by trial weights, "without phase" by amplitudes alone, or a "balancing machine",
        whose readings are unbalances
    criterion : what the weights make least, "least squares" or "min-max"
    unit : of all lengths in the file
    rpm : r/min, of the readings that say none
    rotor : a rotor file, whose bodies are then corrected by what was measured
    readings : a table of readings as CSV, with the columns run, sensor, rpm, amplitude, phase
    coefficients : a file of influence coefficients of an earlier job, in place of trial runs
    """

    section: ClassVar[str] = ""

    conventions: Annotated[ConventionFields, table(ConventionFields)]
    plane: Annotated[tuple[MeasuredPlaneFields, ...], tables(MeasuredPlaneFields, least=1)]
    run: Annotated[tuple[RunFields, ...], tables(RunFields, least=1)]
    schema: Annotated[int, layout_version(1)] = 1
    method: Annotated[Method, choice(*get_args(Method))] = "influence coefficients"
    criterion: Annotated[Criterion, choice(*get_args(Criterion))] = "least squares"
    unit: Annotated[str, unit] = "mm"
    rpm: Annotated[float | None, number("r/min", positive=True)] = None
    rotor: Annotated[str | None, text] = None
    readings: Annotated[str | None, text] = None
    coefficients: Annotated[str | None, text] = None
    machine: Annotated[MachineFields, table(MachineFields)] = MachineFields()
    sensor: Annotated[tuple[SensorFields, ...], tables(SensorFields)] = ()
    uncertainty: Annotated[ReadingUncertaintyFields, table(ReadingUncertaintyFields)] = ReadingUncertaintyFields()
    tolerance: Annotated[AcceptanceFields, table(AcceptanceFields)] = AcceptanceFields()
    report: Annotated[HeadFields, table(HeadFields)] = HeadFields()
