"""`Ensemble` → a table with a row for each draw, CSV, Parquet or NumPy arrays."""

from __future__ import annotations

import math
from itertools import chain
from pathlib import Path

import numpy as np

from inertia.dynamics.spread.ensemble import Ensemble
from inertia.output import whole
from inertia.tables import csv_text, load_pyarrow

SUFFIXES = (".csv", ".npz", ".parquet")

_ROWS = 65_536  # that are written at once


def write_table(ensemble: Ensemble, path: Path) -> None:
    """Write the table of an ensemble, some rows at a time; what a draw does not have stays empty, of arrays NaN."""
    if path.suffix.lower() == ".npz":
        table = {name: np.asarray(values) for name, values in ensemble.columns(slice(None)).items()}
        with whole(path) as beside, beside.open("wb") as archive:
            np.savez(archive, **table)  # type: ignore[arg-type]
        return
    pieces = (ensemble.columns(slice(first, first + _ROWS)) for first in range(0, len(ensemble.values), _ROWS))
    first = next(pieces)
    if path.suffix.lower() == ".parquet":
        pa = load_pyarrow()
        kinds = {"draw": pa.int64(), "state": pa.string(), "model": pa.string(), "message": pa.string()}
        schema = pa.schema([(name, kinds.get(name, pa.float64())) for name in first])
        with whole(path) as beside, pa.parquet.ParquetWriter(beside, schema) as writer:
            for columns in chain([first], pieces):
                arrays = [
                    pa.array(values, schema.field(k).type, from_pandas=True)
                    for k, values in enumerate(columns.values())
                ]
                writer.write_table(pa.table(arrays, schema=schema))
        return
    with whole(path) as beside, beside.open("w", encoding="utf-8", newline="") as text:
        text.write(csv_text([list(first)]))
        for columns in chain([first], pieces):
            lists = [values if isinstance(values, list) else values.tolist() for values in columns.values()]
            text.write(csv_text([_cell(value) for value in row] for row in zip(*lists, strict=True)))


def _cell(value: object) -> object:
    return "" if isinstance(value, float) and math.isnan(value) else value
