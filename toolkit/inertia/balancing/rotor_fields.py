"""The sections of a rotor file: what each field may hold, as the file has it.

Lengths are in the file's `unit`, angles in degrees, masses as their names say. `inertia.balancing.rotor` turns them
into SI units and radians; angles and signs are those of `inertia.balancing.unbalance`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from inertia.arrays import Float
from inertia.balancing.correction_fields import EvenAngles, KeyFields, PlaneFields, listed_angles
from inertia.balancing.corrections.search import SECONDS
from inertia.balancing.standards import CATEGORIES, FORMER, GRADE, STANDARDS
from inertia.documents import (
    FieldError,
    Reader,
    Section,
    choice,
    estimate,
    flag,
    integer,
    layout_version,
    number,
    numbers,
    schema_of,
    section_of,
    several,
    table,
    tables,
    text,
)
from inertia.errors import UsageError
from inertia.mass.density import density_of
from inertia.records import dataclass
from inertia.units import length_unit

_LENGTH = "the file's unit"
_MOST_DRAWS = 1_000_000


def _unit(value: Any, path: str) -> str:
    name: str = text(value, path)
    try:
        return length_unit(name).name
    except UsageError as error:
        raise FieldError(path, "is an ", error.sentence) from None


def _material(value: Any, path: str) -> str:
    name: str = text(value, path)
    try:
        density_of(name)
    except UsageError as error:
        raise FieldError(path, "is an ", error.sentence) from None
    return name


unit = Reader(_unit, text.schema)
"""Read a unit of length."""

material = Reader(_material, text.schema)
"""Read the name of a material that is in the table."""


@dataclass(frozen=True, eq=False)
class HalfWidths(Section):
    """A half-width in two parts.

    Attributes
    ----------
    common : drawn once for all that has it in common
    separate : drawn for each operation by itself
    """

    section: ClassVar[str] = "half-width"

    common: Annotated[float, number("the same unit", negative=False)] = 0.0
    separate: Annotated[float, number("the same unit", negative=False)] = 0.0


@dataclass(frozen=True, eq=False)
class Radii(HalfWidths):
    """A radius about where something should be, in two parts.

    Attributes
    ----------
    common : drawn once for all that has it in common
    separate : drawn for each by itself
    distribution : "uniform" over the disc of that radius; or "rayleigh", normal in each of two directions with that
        standard deviation, so that the distance is Rayleigh distributed
    """

    section: ClassVar[str] = "radius"

    distribution: Annotated[Literal["uniform", "rayleigh"], choice("uniform", "rayleigh")] = "uniform"


def _standard(value: Any, path: str) -> str:
    name: str = _STANDARD(FORMER.get(value, value) if isinstance(value, str) else value, path)
    return name


_STANDARD = choice(*STANDARDS)
standard = Reader(_standard, {"enum": [*STANDARDS, *FORMER]})
"""Read the name of a standard, or one that it had before."""


def _grade(value: Any, path: str) -> float:
    if isinstance(value, str) and (written := GRADE.fullmatch(value)):
        value = float(written[1])
    figure: float = _FIGURE(value, path)
    return figure


_FIGURE = number("mm/s", positive=True)
grade = Reader(_grade, {"oneOf": [_FIGURE.schema, {"type": "string", "pattern": f"^{GRADE.pattern}$"}]})
"""Read a balance quality grade, 6.3 or "G6.3"."""


def _half_width(unit: str, kind: type[HalfWidths] = HalfWidths, **limits: Any) -> Reader:
    """Read a half-width: a number, or a table of its common and separate parts."""
    single = number(unit, negative=False, **limits)

    def read(value: Any, path: str) -> float | HalfWidths:
        if isinstance(value, Mapping | HalfWidths):
            return section_of(kind, value, path=path) if isinstance(value, Mapping) else value
        width: float = single(value, path)
        return width

    return Reader(read, {"oneOf": [single.schema, schema_of(kind)]})


_ECCENTRICITY = _half_width(_LENGTH, Radii)
_TILT = _half_width("degrees", Radii, below=10.0)


@dataclass(frozen=True, eq=False)
class BodyFields(Section):
    """One of ``[[body]]``: a closed mesh and how heavy it is.

    Attributes
    ----------
    file : path of a mesh or STEP file, relative to the rotor file
    region : the region of the file that is the body, where it is not all of it
    name : what the report calls it; the file's name without it
    unit : of the mesh's coordinates; without it the one that the file states, else that of the rotor file
    density : kg/m³; a single body may leave it out, as 1000 is then assumed; with its standard uncertainty as "7850±50"
    material : a name in the table of materials, in place of a density
    mass : kg as weighed, in place of a density; with its standard uncertainty as "1.2±0.001"
    sigma : standard deviation of the noise of every coordinate of the mesh
    chord_tolerance : how far the true surface may be from the mesh, where that is more than its facets show; what they
        show counts without it
    eccentricity : how far off the shaft the body may sit once it is mounted, a radius; a number, or {common, separate,
        distribution}; a number is separate
    tilt : the same in degrees, how far it may lean about its centre of mass
    indexing : angles by which the body may be turned about the shaft from where the file has it, as holes of a flange
        or keyways allow: {count, offset}, or a list of degrees; the best are taken
    """

    section: ClassVar[str] = "body"

    file: Annotated[str, text]
    region: Annotated[str | None, text] = None
    name: Annotated[str | None, text] = None
    unit: Annotated[str | None, unit] = None
    density: Annotated[float | None, estimate("kg/m³")] = None
    material: Annotated[str | None, material] = None
    mass: Annotated[float | None, estimate("kg")] = None
    sigma: Annotated[float | None, number(_LENGTH, positive=True)] = None
    chord_tolerance: Annotated[float | None, number(_LENGTH, negative=False)] = None
    eccentricity: Annotated[float | Radii | None, _ECCENTRICITY] = None
    indexing: Annotated[tuple[float, ...] | EvenAngles | None, listed_angles] = None
    tilt: Annotated[float | Radii | None, _TILT] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where it is said twice how heavy the body is."""
        if len(weights := self.weights) > 1:
            raise FieldError(path, f"has both {' and '.join(weights)}: give one of density, material and mass")

    @property
    def weights(self) -> list[str]:
        """Which of its fields say how heavy it is."""
        return [name for name in ("density", "material", "mass") if getattr(self, name) is not None]


@dataclass(frozen=True, eq=False)
class MountFields(Section):
    """One of ``[[mount]]``: how a part of the assembly is mounted.

    Attributes
    ----------
    part : name of a part or group in the assembly, or a glob of several
    indexing : angles by which it may be turned about the shaft, with all that hangs on it, from where the assembly has
        it: {count, offset}, or a list of degrees; the best are taken
    interchangeable : the parts that the glob fits may change places with each other, as blades in their slots; the
        best order is taken
    eccentricity : how far off the shaft it may sit, a radius; a number, or {common, separate, distribution}; a number
        is separate
    tilt : the same in degrees, how far it may lean
    z : place along the shaft about which it leans, as of the face that it is bolted to; its centre of mass without it
    """

    section: ClassVar[str] = "mount"

    part: Annotated[str, text]
    indexing: Annotated[tuple[float, ...] | EvenAngles | None, listed_angles] = None
    interchangeable: Annotated[bool, flag] = False
    eccentricity: Annotated[float | Radii | None, _ECCENTRICITY] = None
    tilt: Annotated[float | Radii | None, _TILT] = None
    z: Annotated[float | None, number(_LENGTH)] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where it says nothing, or both that parts are turned and that they change places."""
        if self.indexing is not None and self.interchangeable:
            raise FieldError(f"{path}.indexing", "is given for interchangeable parts: turn what they are mounted on")
        if self.indexing is None and not self.interchangeable and self.eccentricity is None and self.tilt is None:
            raise FieldError(path, "says nothing: give indexing, interchangeable, eccentricity or tilt")
        if self.z is not None and self.tilt is None:
            raise FieldError(f"{path}.z", "is given without tilt: it is the place about which the part leans")


def _journals(value: Any, path: str) -> str | tuple[str, ...]:
    if value == "detect":
        return "detect"
    if isinstance(value, str):
        raise FieldError(path, f"is {value!r}: use 'detect', or name two regions of the mesh in a list")
    names: tuple[str, ...] = several(text)(value, path)
    if len(names) != 2:
        raise FieldError(path, f"names {len(names)} regions: name two, that of bearing A first")
    return names


@dataclass(frozen=True, eq=False)
class AxisFields(Section):
    """The section ``[axis]``: where the shaft runs, where 0° is, and which way it turns.

    Attributes
    ----------
    bearing_a, bearing_b : centres of the bearings; z′ runs from A to B
    journals : in place of bearings: "detect", or two regions of the mesh, whose cylinders are then offered as
        candidates that need confirming
    zero_mark : vector from the shaft to the 0° mark, in part axes
    rotation : sense of rotation, seen from B looking to A
    radial_uncertainty : how far each bearing centre may be from where it is given
    """

    section: ClassVar[str] = "axis"

    bearing_a: Annotated[Float | None, numbers((3,), _LENGTH)] = None
    bearing_b: Annotated[Float | None, numbers((3,), _LENGTH)] = None
    journals: Annotated[
        Literal["detect"] | tuple[str, ...] | None,
        Reader(
            _journals,
            {"oneOf": [{"const": "detect"}, {"type": "array", "items": text.schema, "minItems": 2, "maxItems": 2}]},
        ),
    ] = None
    zero_mark: Annotated[Float, numbers((3,), "a direction")] = (1.0, 0.0, 0.0)  # type: ignore[assignment]
    rotation: Annotated[Literal["ccw", "cw"], choice("ccw", "cw")] = "ccw"
    radial_uncertainty: Annotated[float, number(_LENGTH, negative=False)] = 0.0

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the axis is given twice, or not at all."""
        ends = [name for name in ("bearing_a", "bearing_b") if getattr(self, name) is not None]
        if self.journals is not None and ends:
            raise FieldError(
                f"{path}.journals", f"goes with no {ends[0]}: leave it out, the bearings say where the axis is"
            )
        if self.journals is None and len(ends) < 2:
            missing = "bearing_b" if ends == ["bearing_a"] else "bearing_a"
            raise FieldError(
                f"{path}.{missing}",
                'is missing: give the centres of both bearings, or journals = "detect" to see candidates',
            )


@dataclass(frozen=True, eq=False)
class ServiceFields(Section):
    """The section ``[service]``: how fast the rotor runs.

    Attributes
    ----------
    rpm : highest speed in service, r/min
    critical_rpm : first critical speed, r/min; a mesh cannot give it
    run_up : acceleration while running up, (r/min)/s
    """

    section: ClassVar[str] = "service"

    rpm: Annotated[float, number("r/min", positive=True)]
    critical_rpm: Annotated[float | None, number("r/min", positive=True)] = None
    run_up: Annotated[float | None, number("(r/min)/s", positive=True)] = None


@dataclass(frozen=True, eq=False)
class ToleranceFields(Section):
    """The section ``[tolerance]``: how much residual unbalance is permissible.

    Attributes
    ----------
    standard : ISO 21940-11 unless another criterion is given; ISO 1940 is its name of before 2016
    grade : balance quality grade G, mm/s, of ISO 21940-11, or of a contract; 6.3 or "G6.3"
    category : of fans, BV-1 to BV-5, for ISO 14694
    revision : of MIL-STD-167-1, whose limits differ: "1974", or "A" of 2005, which takes a grade
    e_um : permissible specific unbalance in µm, in place of a standard
    bearing_force : permissible forces on bearings A and B, N, in place of a standard
    overhung : whether the clamps for overhung rotors apply; found from the centre of mass without it
    """

    section: ClassVar[str] = "tolerance"

    standard: Annotated[str | None, standard] = None
    grade: Annotated[float | None, grade] = None
    category: Annotated[str | None, choice(*CATEGORIES)] = None
    revision: Annotated[Literal["1974", "A"] | None, choice("1974", "A")] = None
    e_um: Annotated[float | None, number("µm", positive=True)] = None
    bearing_force: Annotated[Float | None, numbers((2,), "N")] = None
    overhung: Annotated[bool | None, flag] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the criteria contradict each other, or are none."""
        others = [name for name in ("e_um", "bearing_force") if getattr(self, name) is not None]
        criteria = [*others, *(name for name in ("standard", "grade") if getattr(self, name) is not None)]
        if not criteria:
            raise FieldError(path, "says nothing: give a grade, a standard, e_um or bearing_force")
        if others and len(criteria) > 1:
            raise FieldError(f"{path}.{criteria[0]}", f"goes with no {criteria[1]}: give the one that counts")
        if self.bearing_force is not None and not (self.bearing_force > 0).all():
            listed = ", ".join(f"{k:g}" for k in self.bearing_force.tolist())
            raise FieldError(f"{path}.bearing_force", f"is [{listed}] N: both must be positive")
        name = self.standard or "ISO 21940-11"
        takes = {} if others else STANDARDS[name].takes
        revisions = [k for k in takes if k is not None]
        if self.revision is not None and not revisions:
            of = ", ".join(k for k, standard in STANDARDS.items() if None not in standard.takes)
            raise FieldError(f"{path}.revision", f"goes with {of} only: leave it out")
        if revisions and self.revision is None:
            raise FieldError(f"{path}.revision", f"is missing: {STANDARDS[name].says}")
        for each, example in (("grade", "a grade, as 6.3"), ("category", 'a category, as "BV-3"')):
            wanted = each in takes.get(self.revision, ())
            if wanted and getattr(self, each) is None:
                raise FieldError(f"{path}.{each}", f"is missing: {name} goes by {example}")
            if not wanted and not others and getattr(self, each) is not None:
                raise FieldError(f"{path}.{each}", f"goes with no {name}, which has limits of its own: leave it out")


@dataclass(frozen=True, eq=False)
class UncertaintyFields(Section):
    """The section ``[uncertainty]``: how well the inputs are known and what the shop holds, as half-widths.

    Attributes
    ----------
    density : of each body's density, as a part of it; not of bodies that were weighed
    depth, diameter : of the shop's holes and flats; a number, or {common, separate}; a number is common to all that
        one tool does
    radius, z : the same of where holes and weights are, common in a plane
    angle : the same in degrees, common to all, as an error of the zero mark is
    arc : the same in degrees, of the length of arcs, common in a plane
    mass : the same of a weight, as a part of it; a number is separate
    confidence : the share of parts that has to be within tolerance for PASS
    draws : of the Monte Carlo; four times as many where they do not tell
    seed : of its random numbers
    """

    section: ClassVar[str] = "uncertainty"

    density: Annotated[float, number("", negative=False, below=1.0)] = 0.0
    depth: Annotated[float | HalfWidths | None, _half_width(_LENGTH)] = None
    diameter: Annotated[float | HalfWidths | None, _half_width(_LENGTH)] = None
    radius: Annotated[float | HalfWidths | None, _half_width(_LENGTH)] = None
    z: Annotated[float | HalfWidths | None, _half_width(_LENGTH)] = None
    angle: Annotated[float | HalfWidths | None, _half_width("degrees")] = None
    arc: Annotated[float | HalfWidths | None, _half_width("degrees")] = None
    mass: Annotated[float | HalfWidths | None, _half_width("", below=1.0)] = None
    confidence: Annotated[float, number("", positive=True, below=1.0)] = 0.95
    draws: Annotated[int, integer(100, _MOST_DRAWS)] = 10_000
    seed: Annotated[int, integer(0, 2**31)] = 0


def _aim(value: Any, path: str) -> float | str:
    if value == "least":
        return "least"
    if isinstance(value, str):
        raise FieldError(path, f"is {value!r}: use 'least', or a share of the tolerance below 1")
    share: float = _SHARE(value, path)
    return share


_SHARE = number("", positive=True, below=1.0)
_AIM = Reader(_aim, {"oneOf": [{"const": "least"}, _SHARE.schema]})


@dataclass(frozen=True, eq=False)
class PlanFields(Section):
    """The section ``[plan]``: how corrections are planned.

    Attributes
    ----------
    aim : what is to be left at most, as a share of what is permissible less what is uncertain, if it can be; "least"
        for the least that the steps of the shop allow, whatever number of operations that takes; 0.75 without it, of
        rotors that are out of tolerance, or of which too few parts are within it
    time : how long a plan is looked for; then the best so far is taken
    """

    section: ClassVar[str] = "plan"

    aim: Annotated[float | Literal["least"] | None, _AIM] = None
    time: Annotated[float, number("s", positive=True)] = SECONDS


@dataclass(frozen=True, eq=False)
class ReportFields(Section):
    """The section ``[report]``: what the report's head says.

    Attributes
    ----------
    part, serial, revision, customer, remark : as the shop writes them
    machine_angles : which way the balancing machine counts angles, seen from B looking to A; of the work alone
    """

    section: ClassVar[str] = "report"

    part: Annotated[str | None, text] = None
    serial: Annotated[str | None, text] = None
    revision: Annotated[str | None, text] = None
    customer: Annotated[str | None, text] = None
    remark: Annotated[str | None, text] = None
    machine_angles: Annotated[Literal["ccw", "cw"], choice("ccw", "cw")] = "ccw"


@dataclass(frozen=True, eq=False, kw_only=True)
class RotorFields(Section):
    """A rotor file.

    Attributes
    ----------
    schema : the version of the layout
    body : the bodies that turn together
    assembly : path of an assembly file whose parts turn together, in place of bodies
    mount : how parts of the assembly are mounted
    unit : of all lengths in the file
    """

    section: ClassVar[str] = ""

    body: Annotated[tuple[BodyFields, ...], tables(BodyFields)] = ()
    assembly: Annotated[str | None, text] = None
    mount: Annotated[tuple[MountFields, ...], tables(MountFields)] = ()
    axis: Annotated[AxisFields, table(AxisFields)]
    service: Annotated[ServiceFields, table(ServiceFields)]
    tolerance: Annotated[ToleranceFields, table(ToleranceFields)]
    schema: Annotated[int, layout_version(1)] = 1
    unit: Annotated[str, unit] = "mm"
    key: Annotated[tuple[KeyFields, ...], tables(KeyFields)] = ()
    plane: Annotated[tuple[PlaneFields, ...], tables(PlaneFields)] = ()
    plan: Annotated[PlanFields, table(PlanFields)] = PlanFields()
    uncertainty: Annotated[UncertaintyFields, table(UncertaintyFields)] = UncertaintyFields()
    report: Annotated[ReportFields, table(ReportFields)] = ReportFields()

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where nothing turns, or bodies and an assembly do."""
        if self.assembly is None and not self.body:
            raise FieldError("body", "is missing: it has to be given, or an assembly in its place")
        if self.assembly is not None and self.body:
            raise FieldError("assembly", "is given beside body: make the bodies parts of the assembly")
        if self.assembly is None and self.mount:
            raise FieldError("mount[0]", "is that of an assembly: a body has its own eccentricity, tilt and indexing")
