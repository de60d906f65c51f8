"""`Ensemble` → a table with a row for each draw, CSV or Parquet."""

from __future__ import annotations

import math
from pathlib import Path

from inertia.dynamics.spread.ensemble import Ensemble
from inertia.output import whole, write_whole
from inertia.tables import csv_text, load_pyarrow

SUFFIXES = (".csv", ".parquet")


def write_table(ensemble: Ensemble, path: Path) -> None:
    """Write the table of an ensemble; what a draw does not have stays empty."""
    columns = ensemble.columns()
    if path.suffix.lower() == ".parquet":
        pa = load_pyarrow()
        table = pa.table({name: pa.array(values, from_pandas=True) for name, values in columns.items()})
        with whole(path) as beside:
            pa.parquet.write_table(table, beside)
        return
    lists = [values if isinstance(values, list) else values.tolist() for values in columns.values()]
    rows = ([_cell(value) for value in row] for row in zip(*lists, strict=True))
    write_whole(path, csv_text([list(columns), *rows]).encode())


def _cell(value: object) -> object:
    return "" if isinstance(value, float) and math.isnan(value) else value
