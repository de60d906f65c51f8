"""Reading recordings back, with rerun's own readers."""

import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from subprocess import run
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Recorded:
    """The rows of a recording by entity path: columns by name, in the order of time."""

    def __init__(self, path: Path) -> None:
        from rerun.chunk import RrdReader

        reader = RrdReader(str(path))
        (self.recording,) = reader.recordings()
        (self.blueprint,) = reader.blueprints()
        self.columns: dict[str, dict[str, list[Any]]] = {}
        self.times: dict[str, list[Any]] = {}
        self.rows: dict[str, list[int]] = {}
        for chunk in reader.store().stream():
            batch = chunk.to_record_batch()
            columns = self.columns.setdefault(chunk.entity_path, {})
            for name, column in zip(batch.schema.names, batch.columns, strict=True):
                if name in chunk.timeline_names:
                    self.times.setdefault(chunk.entity_path, []).append((name, column))
                elif name != "rerun.controls.RowId":
                    columns.setdefault(name, []).append(column)
            if not chunk.is_static:
                self.rows.setdefault(chunk.entity_path, []).append(chunk.num_rows)
        self._blueprint = [column for chunk in reader.stream(store=self.blueprint) for column in _columns(chunk)]
        self.views = [str(column[0][0]) for name, column in self._blueprint if name == "ViewBlueprint:class_identifier"]

    def property(self, name: str) -> list[Any]:
        """Return what the blueprint says by this name, over all its views."""
        return [value for column_name, column in self._blueprint if column_name == name for value in column[0].as_py()]

    def time(self, path: str) -> NDArray[np.float64]:
        """Return the times of an entity in s; all are on the timeline of the run."""
        assert {name for name, _ in self.times[path]} == {"time"}
        return np.concatenate([column.cast("int64").to_numpy() for _, column in self.times[path]]) * 1e-9

    def values(self, path: str, name: str) -> NDArray[Any]:
        """Return the numbers of a column, (rows, …), as they are stored."""
        rows = []
        for column in self.columns[path][name]:
            flat, shape = column, [len(column)]
            while hasattr(flat, "flatten") and "list" in str(flat.type):
                flat = flat.flatten()
                shape.append(len(flat) // max(1, int(np.prod(shape))))
            rows.append(flat.to_numpy(zero_copy_only=False).reshape(shape))
        return np.concatenate(rows)

    def texts(self, path: str, name: str) -> list[str]:
        """Return the texts of a column, over all its rows."""
        return [text for column in self.columns[path][name] for row in column.to_pylist() for text in row]


def _columns(chunk: Any) -> list[tuple[str, Any]]:
    batch = chunk.to_record_batch()
    return list(zip(batch.schema.names, batch.columns, strict=True))


@cache
def viewer() -> str:
    """Return the path of Rerun's program."""
    name = "rerun.exe" if sys.platform == "win32" else "rerun"
    return str(Path(find_spec("rerun_cli").origin).with_name(name))


def verified(path: Path, home: Path) -> bool:
    """Say whether `rerun rrd verify` takes a file."""
    import os

    environment = {**os.environ, "HOME": str(home)}
    return (
        run([viewer(), "rrd", "verify", str(path)], capture_output=True, env=environment, check=False).returncode == 0
    )
