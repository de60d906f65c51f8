"""`Job`: a rotor on a machine, the runs that were made with it, and what was read; from TOML, and readings from CSV.

Weights and readings become complex numbers whose angles run in the job's own sense
(`inertia.balancing.measured.readings`); `to_rotor` turns them into the sense of a rotor file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.machine_angles import MachineAngles
from inertia.balancing.measured.job_fields import JobFields, MeasuredPlaneFields, ReadingFields, RunFields, SensorFields
from inertia.balancing.measured.readings import readings
from inertia.balancing.measured.tables import readings_of
from inertia.balancing.rotor import Rotor
from inertia.balancing.shop_units import GRAM_MILLIMETRE, OUNCE_INCH, in_degrees
from inertia.balancing.unbalance import Complex
from inertia.documents import Document, FieldError, Section, document_schema, plain, section_of
from inertia.errors import UsageError
from inertia.records import dataclass
from inertia.units import length_unit

AMPLITUDE, PHASE = 0.02, 2.0
"""Half-widths of a reading, as a part of it and in degrees, where the job states none."""

Named = TypeVar("Named", MeasuredPlaneFields, SensorFields, RunFields)


@dataclass(frozen=True)
class Channel:
    """What is read in every run: a sensor at a speed (r/min; None where none is stated)."""

    sensor: str
    rpm: float | None

    def __str__(self) -> str:
        return self.sensor if self.rpm is None else f"{self.sensor} at {self.rpm:g} r/min"


@dataclass(frozen=True)
class Plane:
    """Where weights are mounted: its name, and z and radius in m where they are known."""

    id: str
    z: float | None
    radius: float | None


@dataclass(frozen=True, eq=False)
class Job(Document):
    """A balancing job as its file describes it.

    Attributes
    ----------
    fields : what the file says, in its own units
    folder : where the files are that it names
    text : the file as it was read; None without one
    name : the file's path, or "the job"
    runs : those of the file, with the readings of the table added

    Raises `UsageError` naming the field.

    >>> job = Job.from_dict({
    ...     "conventions": {"angles": "with rotation", "phase": "lag"},
    ...     "rpm": 1500,
    ...     "sensor": [{"id": "A", "unit": "mm/s"}],
    ...     "plane": [{"id": "I", "radius": 100}],
    ...     "run": [{"id": "initial", "readings": [{"sensor": "A", "amplitude": 5.0, "phase": 30.0}]}],
    ... })
    >>> job.channels[0].sensor, job.channels[0].rpm
    ('A', 1500.0)
    """

    noun: ClassVar[str] = "job"

    fields: JobFields
    folder: Path = Path()
    text: str | None = None
    name: str = "the job"
    runs: tuple[RunFields, ...] = field(init=False)
    _lines: tuple[tuple[str, ...], ...] = field(init=False)  # of the table: where the last readings of each run are

    def __post_init__(self) -> None:
        object.__setattr__(self, "runs", self.fields.run)
        object.__setattr__(self, "_lines", ((),) * len(self.runs))
        for name in ("plane", "sensor", "run"):
            _require_different(getattr(self.fields, name), name)
        if self.fields.readings is not None:
            self._add_table(self.folder / self.fields.readings)
        self._require_sense()

    @classmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> Job:
        if "body" in table and "run" not in table:
            raise FieldError("body", "is that of a rotor file, not of a job: name that file as rotor in a job")
        return cls(section_of(JobFields, table), folder, text, name)

    def to_dict(self) -> dict[str, Any]:
        """Return the job as a dictionary laid out as the file is; what is at its default is left out."""
        return {"schema": self.fields.schema, "unit": self.fields.unit, **plain(self.fields)}

    @property
    def by_machine(self) -> bool:
        """Whether the readings are unbalances, of a balancing machine."""
        return self.fields.method == "balancing machine"

    @property
    def by_phase(self) -> bool:
        """Whether the readings have phases."""
        return self.fields.method != "without phase"

    @cached_property
    def rotor(self) -> Rotor | None:
        """The rotor that is to be corrected; None where the job names none."""
        return None if self.fields.rotor is None else Rotor.load(self.folder / self.fields.rotor)

    @cached_property
    def planes(self) -> tuple[Plane, ...]:
        """The planes, with what the rotor file says of those of the same name."""
        known = {} if self.rotor is None else {plane.id: plane for plane in self.rotor.fields.plane}
        metres = float(length_unit(self.fields.unit).metres)
        other = 1.0 if self.rotor is None else float(self.rotor.unit.metres)
        planes = []
        for plane in self.fields.plane:
            places: dict[str, float | None] = {}
            for name in ("z", "radius"):
                own, theirs = getattr(plane, name), getattr(known.get(plane.id), name, None)
                places[name] = metres * own if own is not None else None if theirs is None else other * theirs
            planes.append(Plane(plane.id, **places))
        return tuple(planes)

    @property
    def weighed_alone(self) -> bool:
        """Whether weights are in kg, as no radius of theirs is known, in place of kg m."""
        return any(plane.radius is None for plane in self.planes) and not self.by_machine

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """What every run reads, in the order of the first; of a balancing machine the planes."""
        if self.by_machine:
            return tuple(Channel(plane.id, self.fields.rpm) for plane in self.fields.plane)
        return tuple(dict.fromkeys(self._channel(reading) for reading in self.runs[0].readings))

    @cached_property
    def amplitudes(self) -> Float:
        """What was read, (runs, channels), in the units of the sensors, or kg m of a balancing machine."""
        return np.array([[self._reading(run, channel).amplitude for channel in self.channels] for run in self.runs]) * (
            self._machine_unit if self.by_machine else 1.0
        )

    @cached_property
    def vibrations(self) -> Complex:
        """The same with phases, as complex numbers that are linear in the unbalance, without runout."""
        phases = [[self._reading(run, channel).phase or 0.0 for channel in self.channels] for run in self.runs]
        return self._linear(self.amplitudes, phases) - self.runouts

    @cached_property
    def runouts(self) -> Complex:
        """What of the readings of each channel is runout, (channels,) complex."""
        each = {sensor.id: sensor.runout for sensor in self.fields.sensor if sensor.runout is not None}
        runouts = [each.get(channel.sensor) for channel in self.channels]
        sizes = [0.0 if one is None else one.amplitude for one in runouts]
        return self._linear(sizes, [0.0 if one is None else one.phase for one in runouts])

    def _linear(self, amplitudes: ArrayLike, phases: ArrayLike) -> Complex:
        conventions = self.fields.conventions
        if self.by_machine:
            heavy = readings(amplitudes, phases)
            return -heavy if conventions.shows == "correction" else heavy
        return readings(
            amplitudes,
            phases,
            phase=conventions.phase or "lead",
            rotation="ccw" if conventions.angles == "with rotation" else "cw",
        )

    def as_read(self, run: int) -> list[tuple[float, float | None]]:
        """Return amplitude and phase, degrees, of each channel of a run, as the job has them."""
        entries = (self._reading(self.runs[run], channel) for channel in self.channels)
        return [(entry.amplitude, entry.phase if self.by_phase else None) for entry in entries]

    def shown(self, reading: complex) -> tuple[float, float | None]:
        """Return the amplitude and the phase, degrees, that the instrument shows for one of `vibrations`, no runout."""
        size = abs(reading) / (self._machine_unit if self.by_machine else 1.0)
        if not self.by_phase:
            return size, None
        conventions = self.fields.conventions
        if self.by_machine:
            return size, in_degrees(-reading if conventions.shows == "correction" else reading)
        turns = (conventions.phase == "lead") == (conventions.angles == "with rotation")
        return size, in_degrees(reading if turns else reading.conjugate())

    @cached_property
    def half_widths(self) -> tuple[Float, Float]:
        """What each reading may be off by: (channels,) as a part of it and rad, beside its sensor's noise."""
        sensors, general = {sensor.id: sensor for sensor in self.fields.sensor}, self.fields.uncertainty
        both = []
        for channel in self.channels:
            sensor = sensors.get(channel.sensor)
            both.append(
                [
                    _first(getattr(sensor, name, None), getattr(general, name), usual)
                    for name, usual in (("amplitude", AMPLITUDE), ("phase", PHASE))
                ]
            )
        sizes, angles = np.array(both).T
        return sizes, np.radians(angles)

    @cached_property
    def noise(self) -> Float:
        """Half-width of the noise of each channel, in its unit, or kg m of a balancing machine."""
        if self.by_machine:
            return np.full(len(self.channels), self.fields.machine.floor * self._machine_unit)
        floors = {sensor.id: sensor.floor for sensor in self.fields.sensor}
        return np.array([floors.get(channel.sensor, 0.0) for channel in self.channels])

    @cached_property
    def importance(self) -> Float:
        """What the readings of each channel count."""
        weights = {sensor.id: sensor.importance for sensor in self.fields.sensor}
        return np.array([weights.get(channel.sensor, 1.0) for channel in self.channels])

    def unit_of(self, channel: Channel) -> str:
        """Return the unit of a channel's readings."""
        if self.by_machine:
            return self.fields.machine.unit
        return next(sensor.unit for sensor in self.fields.sensor if sensor.id == channel.sensor)

    @cached_property
    def weights(self) -> tuple[tuple[int, int, complex, bool], ...]:
        """What was mounted: (run, plane, weight in kg m or kg, whether it stays)."""
        numbers = {plane.id: k for k, plane in enumerate(self.fields.plane)}
        entries = []
        for k, run in enumerate(self.runs):
            for weight in run.weights:
                number = numbers[weight.plane]
                if weight.mass_g is None:
                    size = GRAM_MILLIMETRE * (weight.gmm or 0.0)
                elif weight.radius is None:
                    size = 1e-3 * weight.mass_g * self.per_mass(number)
                else:
                    size = 1e-3 * weight.mass_g * float(length_unit(self.fields.unit).metres) * weight.radius
                entries.append((k, number, size * np.exp(1j * np.radians(weight.angle)), weight.stays))
        return tuple(entries)

    def per_mass(self, plane: int) -> float:
        """Return what a mass of 1 kg counts in a plane: its radius in m, or 1 where weights are in kg."""
        radius = self.planes[plane].radius
        return 1.0 if self.weighed_alone or radius is None else radius

    def _radius(self, plane: str) -> float | None:
        return next(one.radius for one in self.planes if one.id == plane)

    def to_rotor(self, vector: complex) -> complex:
        """Return a vector of the job in the angles of its rotor file."""
        turned = vector if self._counts_as_the_rotor else vector.conjugate()
        return complex(turned * np.exp(1j * math.radians(self.fields.conventions.zero)))

    def from_rotor(self, degrees: float) -> float:
        """Return an angle of the rotor file, degrees, as the job counts it."""
        return self.machine_angles.of(degrees)

    @property
    def machine_angles(self) -> MachineAngles:
        """How the job counts angles beside its rotor file."""
        return MachineAngles("ccw" if self._counts_as_the_rotor else "cw", self.fields.conventions.zero)

    @property
    def _counts_as_the_rotor(self) -> bool:
        """Whether angles run the same way as those of the rotor file."""
        assert self.rotor is not None
        with_rotation = self.fields.conventions.angles == "with rotation"
        return with_rotation == (self.rotor.fields.axis.rotation == "ccw")

    @property
    def _machine_unit(self) -> float:
        return OUNCE_INCH if self.fields.machine.unit == "oz·in" else GRAM_MILLIMETRE

    def _channel(self, reading: ReadingFields) -> Channel:
        return Channel(reading.sensor, self.fields.rpm if reading.rpm is None else reading.rpm)

    def _reading(self, run: RunFields, channel: Channel) -> ReadingFields:
        if self.by_machine:
            return next(reading for reading in run.readings if reading.sensor == channel.sensor)
        return next(reading for reading in run.readings if self._channel(reading) == channel)

    def _add_table(self, file: Path) -> None:
        """Add the readings of the table to the runs."""
        more: dict[str, list[tuple[ReadingFields, str]]] = {run.id: [] for run in self.fields.run}
        for where, name, reading in readings_of(file):
            if name not in more:
                raise UsageError(f"{where}: run is {name!r}, which the job does not have: add a [[run]] of that id")
            more[name].append((reading, where))
        runs = (
            replace(run, readings=(*run.readings, *(one for one, _ in more[run.id])), path="run")
            for run in self.fields.run
        )
        object.__setattr__(self, "runs", tuple(runs))
        object.__setattr__(self, "_lines", tuple(tuple(where for _, where in more[run.id]) for run in self.fields.run))

    def _require_sense(self) -> None:
        fields, conventions = self.fields, self.fields.conventions
        if self.by_machine:
            self._require_machine()
        elif not fields.sensor:
            raise FieldError("sensor", "is missing: name the pickups, with their units, as [[sensor]]")
        if not self.by_machine and conventions.shows is not None:
            raise FieldError("conventions.shows", "is that of a balancing machine: leave it out")
        if self.by_phase and not self.by_machine and conventions.phase is None:
            raise FieldError("conventions.phase", 'is missing: say whether phases "lag" or "lead"')
        planes = {plane.id for plane in fields.plane}
        for k, run in enumerate(self.runs):
            for j, weight in enumerate(run.weights):
                if weight.plane not in planes:
                    raise FieldError(
                        f"run[{k}].weights[{j}].plane", f"is {weight.plane!r}: use one of {_listed(planes)}"
                    )
                for name in ("gmm", "radius"):
                    if getattr(weight, name) is not None and self.weighed_alone:
                        raise FieldError(
                            f"run[{k}].weights[{j}].{name}", "goes with a radius of every plane: give mass_g alone"
                        )
                unknown = weight.radius is None and self._radius(weight.plane) is None
                if weight.mass_g is not None and self.by_machine and unknown:
                    raise FieldError(
                        f"run[{k}].weights[{j}].mass_g", "goes with a radius, its own or its plane's: give one, or gmm"
                    )
        if not any(run.readings for run in self.runs):
            raise FieldError(*self._without_readings())
        for k, run in enumerate(self.runs):
            self._require_readings(k, run)
            if run.indexed and not self.by_phase:
                raise FieldError(f"run[{k}].indexed", 'goes with phases, not with "without phase": leave it out')
        if not self.by_phase and (len(fields.plane) > 1 or len(self.channels) > 1):
            raise FieldError(
                "method",
                f'is "without phase", which takes one plane and one sensor at one speed, not {len(fields.plane)} and '
                f"{len(self.channels)}: measure phases",
            )
        for k, sensor in enumerate(fields.sensor):
            if sensor.runout is not None and not self.by_phase:
                raise FieldError(f"sensor[{k}].runout", "can only be taken off readings with phase: leave it out")
        if fields.coefficients is not None and fields.method != "influence coefficients":
            raise FieldError("coefficients", f'goes with no method "{fields.method}": leave it out')
        if fields.rotor is not None:
            self._require_places()

    def _without_readings(self) -> tuple[str, str]:
        """Return the field that has no readings, and what to do."""
        table = self.fields.readings
        if table is None:
            return "run", "has no readings: give each run what was read, or name a table as readings"
        return "readings", f"names {table}, which has none: add a line for each reading of each run"

    def _require_machine(self) -> None:
        fields = self.fields
        if fields.sensor:
            raise FieldError("sensor", "goes with no balancing machine, which reads by plane: leave it out")
        if fields.conventions.shows is None:
            raise FieldError(
                "conventions.shows",
                'is missing: say whether the machine shows the angle of the "unbalance" or of the "correction"',
            )

    def _require_readings(self, number: int, run: RunFields) -> None:
        """Refuse a run whose readings are of nothing known, twice there, or not those of the first run."""
        path, lines = f"run[{number}].readings", self._lines[number]
        own = len(run.readings) - len(lines)
        names = {entry.id for entry in (self.fields.plane if self.by_machine else self.fields.sensor)}
        noun = "plane" if self.by_machine else "sensor"
        different: set[Channel] = set()
        for k, reading in enumerate(run.readings):
            line = lines[k - own] if k >= own else None
            if reading.sensor not in names:
                raise _unusable(path, k, line, "sensor", f"is {reading.sensor!r}: use one of {_listed(names)}")
            if self.by_phase and reading.phase is None:
                raise _unusable(path, k, line, "phase", 'is missing: give it, or use method = "without phase"')
            if reading.rpm is None and self.fields.rpm is None and not self.by_machine:
                raise _unusable(path, k, line, "rpm", "is missing: give it, or rpm at the top for all readings")
            channel = Channel(reading.sensor, None) if self.by_machine else self._channel(reading)
            if channel in different:
                says = f"reads {channel} a second time in run {run.id!r}: give their mean"
                raise _unusable(path, k, line, "", says)
            different.add(channel)
        table = self.fields.readings
        of_table = f"(of run {run.id!r}, in {table}) " if table is not None and (lines or not own) else ""
        wanted = {Channel(name, None) for name in names} if self.by_machine else set(self.channels)
        if missing := sorted(map(str, wanted - different)):
            raise FieldError(path, f"{of_table}lack {noun} {missing[0]}, which every run has to read")
        if further := sorted(map(str, different - wanted)):
            raise FieldError(path, f"{of_table}have {noun} {further[0]}, which the first run does not read")

    def _require_places(self) -> None:
        """Refuse planes whose place on the rotor is not known."""
        for k, plane in enumerate(self.planes):
            for name in ("z", "radius") if not self.by_machine else ("z",):
                if getattr(plane, name) is None:
                    raise FieldError(
                        f"plane[{k}].{name}", f"is missing: the rotor file has no {name} of a plane {plane.id!r} either"
                    )


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a job."""
    return document_schema(JobFields, "Job of inertia balance measure")


def _unusable(path: str, number: int, line: str | None, name: str, says: str) -> UsageError:
    """Return the refusal of a reading of a run, or where it is of a table, of a line there."""
    if line is None:
        return FieldError(f"{path}[{number}]{'.' * bool(name)}{name}", says)
    return UsageError(f"{name or 'it'} {says}", places=(line,), code=FieldError.code)


def _require_different(entries: tuple[Section, ...], name: str) -> None:
    ids = [getattr(entry, "id") for entry in entries]  # noqa: B009  # each of them has one
    for k, one in enumerate(ids):
        if one in ids[:k]:
            raise FieldError(f"{name}[{k}].id", f"is {one!r}, as that of {name}[{ids.index(one)}]: give it its own")


def _first(*values: float | None) -> float:
    return next(value for value in values if value is not None)


def _listed(names: set[str]) -> str:
    return ", ".join(sorted(names))
