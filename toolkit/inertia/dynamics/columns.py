"""What goes with the time as a table of columns with units, in files of CSV, NumPy (npz) and Parquet.

All are SI, and read back as the same float64. What a table is of, as JSON, comes with it: as the first line of a CSV
file, behind ``# ``; as the entry `metadata` of an npz file; under the key `inertia` of a Parquet file's own metadata.
"""

from __future__ import annotations

import csv
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from itertools import product
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.output import require_writable, whole
from inertia.records import dataclass
from inertia.tables import load_pyarrow

FORMATS = (".csv", ".npz", ".parquet")

_OF_EVERY_RUN = {
    "time": "s",
    "attitude": "1",
    "angular_velocity": "rad/s",
    "angular_momentum": "kg m²/s",
    "position": "m",
    "inertia": "kg m²",
}
_UNITS = {
    "energy": "J",
    "work": "J",
    "moments": "kg m²",
    "joint values": "rad or m",
    "p_phi": "kg m²/s",
    "p_psi": "kg m²/s",
    "angular momentum": "kg m²/s",
    "Appell–Korteweg": "rad/s",
    "precession": "rad/s",
    "cone": "rad",
    "period": "s",
    "rate": "rad/s",
    "theta": "rad",
    "phi": "rad",
    "psi": "rad",
    "contact force": "N",
    "contact velocity": "m/s",
    "heat": "J",
    "Jellett": "kg m³/s",
    "reaction force": "N",
    "force on bearing": "N",
    "torque": "N m",
    "angle": "rad",
    "distance to": "m",
    "Jacobi": "J",
    "contact": "m",
    "center of mass": "m",
}
"""What quantities and invariants are in: the first of these words that is in the name decides, of what stands before an
"of" if one is there."""

_BLOCK = 16384  # rows that are written at once
_SPACE = "xyz"
_QUATERNION = [*_SPACE, "w"]
_COMPONENTS = {
    "attitude": _QUATERNION,
    "attitude in the orbit": _QUATERNION,
    "part poses": [*_SPACE, "qx", "qy", "qz", "qw"],
}


def unit_of(name: str) -> str:
    """Return the unit of a quantity or an invariant; nothing where it has none.

    >>> unit_of("force on bearing A"), unit_of("theta of least energy"), unit_of("separatrix distance")
    ('N', 'rad', '')
    """
    said = (unit for words in (name.partition(" of ")[0], name) for word, unit in _UNITS.items() if word in words)
    return _OF_EVERY_RUN.get(name) or next(said, "")


@dataclass(frozen=True, eq=False)
class Table:
    """What goes with the time, to be written to files.

    Attributes
    ----------
    series : {name: (n, …)} SI
    about : what it is of, as JSON takes it
    units : {name: the unit of each component} where they are not the same

    >>> table = Table({"time": np.zeros(2), "contact force": np.zeros((2, 3))}, {})
    >>> {name: unit for name, (_, unit) in table.columns.items()}
    {'time': 's', 'contact_force_x': 'N', 'contact_force_y': 'N', 'contact_force_z': 'N'}
    """

    series: Mapping[str, Float]
    about: Mapping[str, Any]
    units: Mapping[str, Sequence[str]] = field(default_factory=dict)

    @property
    def columns(self) -> dict[str, tuple[Float, str]]:
        """The columns by their names: values (n,) and unit.

        Vectors have `_x`, `_y`, `_z`, matrices `_xx`, `_xy`, … `_zz`, attitudes also `_w`; all else is counted from 1.
        """
        columns = {}
        for name, values in self.series.items():
            labels = _labels(name, values.shape[1:])
            units = self.units.get(name, [unit_of(name) or "1"] * len(labels))
            flat = values.reshape(len(values), -1)
            for k, (label, unit) in enumerate(zip(labels, units, strict=True)):
                columns[_slug(name) + label] = flat[:, k], unit
        return columns

    def _of(self, columns: Mapping[str, tuple[Float, str]]) -> dict[str, Any]:
        """Return what the table is of, with the unit of each column."""
        return {**self.about, "units": {name: unit for name, (_, unit) in columns.items()}}

    def to_csv(self, path: str | os.PathLike[str], *, force: bool) -> None:
        """Write a line of metadata, one of names, and a row for each sample."""
        file, columns = require_writable(path, ".csv", force=force), self.columns
        with whole(file) as beside, beside.open("w", encoding="utf-8", newline="") as text:
            text.write(f"# {_json(self._of(columns))}\n")
            writer = csv.writer(text, lineterminator="\n")
            writer.writerow(columns)
            for some in _blocks(columns):
                writer.writerows(np.column_stack(some).tolist())

    def to_npz(self, path: str | os.PathLike[str], *, force: bool) -> None:
        """Write the arrays by their own names, with underscores, and `metadata`."""
        file = require_writable(path, ".npz", force=force)
        units = {_slug(name): list(self.units[name]) if name in self.units else unit_of(name) for name in self.series}
        metadata = np.array(_json({**self.about, "units": units}))
        arrays = {_slug(name): values for name, values in self.series.items()}
        with whole(file) as beside, beside.open("wb") as archive:
            np.savez(archive, metadata=metadata, **arrays)  # type: ignore[arg-type]

    def to_parquet(self, path: str | os.PathLike[str], *, force: bool) -> None:
        """Write columns that have their units, without nulls; raises `UsageError` where pyarrow is not installed."""
        file = require_writable(path, ".parquet", force=force)
        pa = load_pyarrow()
        columns = self.columns
        fields = [
            pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit}) for name, (_, unit) in columns.items()
        ]
        schema = pa.schema(fields, metadata={"inertia": _json(self._of(columns))})
        with whole(file) as beside, pa.parquet.ParquetWriter(beside, schema, use_dictionary=False) as writer:
            for some in _blocks(columns):
                writer.write_table(pa.table([pa.array(np.ascontiguousarray(each)) for each in some], schema=schema))


def _labels(name: str, shape: tuple[int, ...]) -> list[str]:
    """Return what is put behind a name for each of its components."""
    if not shape:
        return [""]
    if shape in ((3,), (3, 3)) and "moments" not in name and "joint" not in name:
        return ["_" + "".join(axes) for axes in product(_SPACE, repeat=len(shape))]
    last = _COMPONENTS.get(name, [str(k + 1) for k in range(shape[-1])])
    before = ["".join(f"_{k + 1}" for k in place) for place in np.ndindex(shape[:-1])]
    return [f"{each}_{label}" for each in before for label in last]


def _slug(name: str) -> str:
    return re.sub(r"\W+", "_", name)


def _blocks(columns: Mapping[str, tuple[Float, str]]) -> Iterator[list[Float]]:
    """Yield the values of all columns, some rows at a time."""
    count = len(next(iter(columns.values()))[0])
    for first in range(0, count, _BLOCK):
        yield [values[first : first + _BLOCK] for values, _ in columns.values()]


def _json(about: Mapping[str, Any]) -> str:
    return json.dumps(about, ensure_ascii=False, allow_nan=False)
