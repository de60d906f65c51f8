"""Influence coefficients as a file: written after trial runs, read by a later job on the same kind of machine.

Angles are kept as with rotation, phases as leads: a job that counts them otherwise reads the conjugates. The mark of
the angles and that of the phases have to be where they were.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from inertia.arrays import Float
from inertia.balancing.measured.job import Job
from inertia.balancing.measured.unbalance_units import unbalance_unit
from inertia.balancing.measured.vibration_units import vibration_unit
from inertia.balancing.shop_units import GRAM_MILLIMETRE, OUNCE_INCH
from inertia.balancing.unbalance import Complex
from inertia.documents import (
    Document,
    FieldError,
    Section,
    layout_version,
    number,
    plain,
    section_of,
    tables,
    text,
)
from inertia.errors import UsageError
from inertia.records import dataclass

_GRAM = 1e-3
_WEIGHTS = {"g": _GRAM, "g·mm": GRAM_MILLIMETRE, "oz·in": OUNCE_INCH}


@dataclass(frozen=True, eq=False)
class CoefficientFields(Section):
    """One of ``[[coefficient]]``: what a unit of unbalance in a plane does to a sensor at a speed.

    Attributes
    ----------
    sensor, rpm, plane : which
    unit : of the vibration
    amplitude, phase : vibration per unit of weight; degrees, leading, of a weight at 0°
    uncertainty : standard uncertainty of the coefficient, as the amplitude
    """

    section: ClassVar[str] = "coefficient"

    sensor: Annotated[str, text]
    rpm: Annotated[float, number("r/min", positive=True)]
    plane: Annotated[str, text]
    unit: Annotated[str, text]
    amplitude: Annotated[float, number("", negative=False)]
    phase: Annotated[float, number("degrees")]
    uncertainty: Annotated[float, number("", negative=False)] = 0.0


@dataclass(frozen=True, eq=False)
class CoefficientsFields(Section):
    """A file of influence coefficients.

    Attributes
    ----------
    coefficient : each of them
    weights : the unit of what was mounted
    schema : the version of the layout
    machine, date : where they come from
    """

    section: ClassVar[str] = ""

    coefficient: Annotated[tuple[CoefficientFields, ...], tables(CoefficientFields, least=1)]
    weights: Annotated[Literal["g·mm", "oz·in", "g"], unbalance_unit("g")]
    schema: Annotated[int, layout_version(1)] = 1
    machine: Annotated[str | None, text] = None
    date: Annotated[str | None, text] = None


@dataclass(frozen=True, eq=False)
class StoredCoefficients(Document):
    """Influence coefficients of an earlier job.

    Attributes
    ----------
    fields : as the file has them
    name : the file's path
    """

    noun: ClassVar[str] = "file of coefficients"

    fields: CoefficientsFields
    name: str = "the file of coefficients"

    @classmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> StoredCoefficients:
        return cls(section_of(CoefficientsFields, table), name)

    @classmethod
    def of(cls, job: Job, coefficients: Complex, uncertainties: Float) -> StoredCoefficients:
        """Return those of a job, (channels, planes) per kg m or kg, with their standard uncertainties."""
        per = _GRAM if job.weighed_alone else GRAM_MILLIMETRE
        same_sense = job.fields.conventions.angles == "with rotation"
        entries = [
            {
                "sensor": channel.sensor,
                "rpm": channel.rpm,
                "plane": plane.id,
                "unit": job.unit_of(channel),
                "amplitude": float(abs(coefficients[k, j])) * per,
                "phase": float(np.degrees(np.angle(coefficients[k, j]) * (1 if same_sense else -1)) % 360.0),
                "uncertainty": float(uncertainties[k, j]) * per,
            }
            for k, channel in enumerate(job.channels)
            for j, plane in enumerate(job.planes)
        ]
        machine = job.fields.machine
        head = {"weights": "g" if job.weighed_alone else "g·mm", "machine": machine.name, "date": machine.date}
        return cls.from_dict({key: value for key, value in head.items() if value} | {"coefficient": entries})

    def to_dict(self) -> dict[str, Any]:
        """Return them as a dictionary laid out as the file is."""
        return {"schema": self.fields.schema, **plain(self.fields)}

    def matrix(self, job: Job) -> tuple[Complex, Float]:
        """Return the coefficients (channels, planes) that a job needs, and their standard uncertainties.

        Raises `UsageError` where one is not there, or in units that are no others of the same quantity.
        """
        if (self.fields.weights == "g") != job.weighed_alone:
            raise UsageError(
                f"{self.name}: weights are in {self.fields.weights}, those of the job in "
                f"{'g' if job.weighed_alone else 'g·mm'}: {'give' if job.weighed_alone else 'leave out'} the radius of "
                "every plane"
            )
        per = _WEIGHTS[self.fields.weights]
        entries = {(one.sensor, one.rpm, one.plane): (k, one) for k, one in enumerate(self.fields.coefficient)}
        values = np.zeros((len(job.channels), len(job.planes)), complex)
        errors = np.zeros(values.shape)
        for k, channel in enumerate(job.channels):
            for j, plane in enumerate(job.planes):
                if (channel.sensor, channel.rpm, plane.id) not in entries:
                    raise UsageError(f"{self.name}: there is no coefficient of sensor {channel} for plane {plane.id}")
                number, one = entries[channel.sensor, channel.rpm or 0.0, plane.id]
                scale = _conversion(one.unit, job.unit_of(channel), f"coefficient[{number}].unit") / per
                values[k, j] = one.amplitude * scale * np.exp(1j * np.radians(one.phase))
                errors[k, j] = one.uncertainty * scale
        return (values if job.fields.conventions.angles == "with rotation" else values.conj()), errors


def _conversion(stored: str, wanted: str, path: str) -> float:
    try:
        old, new = vibration_unit(stored), vibration_unit(wanted)
    except UsageError as error:
        raise FieldError(path, error.sentence) from None
    if old.quantity != new.quantity:
        raise FieldError(
            path, f"is {stored}, a {old.quantity}, and the job reads {wanted}: measure the same quantity as then"
        )
    return old.peak / new.peak
