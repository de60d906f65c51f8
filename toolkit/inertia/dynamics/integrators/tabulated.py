"""A torque given as a table against time."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.loads import Frame, Load, check_frame
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.errors import ReadError, UsageError


@dataclass(frozen=True, eq=False)
class TableTorque(Load):
    """A torque linear between the rows of a table, along body axes or along space axes.

    Two rows at one instant are a jump there. A run must not leave the table.

    Attributes
    ----------
    times : (k,) s, not descending, k ≥ 2; torques : (k, 3) N m

    >>> ramp = TableTorque([0.0, 2.0], [[0, 0, 0], [0, 0, 4]])
    >>> ramp.torque(0.5, np.array(quaternion.IDENTITY), np.zeros(3), np.ones(3)).tolist()
    [0.0, 0.0, 1.0]
    """

    times: Float
    torques: Float
    frame: Frame = "body"

    def __post_init__(self) -> None:
        times, torques = np.asarray(self.times, dtype=np.float64), np.asarray(self.torques, dtype=np.float64)
        check_frame(self.frame)
        if times.ndim != 1 or len(times) < 2 or torques.shape != (len(times), 3):
            raise UsageError(
                f"the torque table has times {times.shape} and torques {torques.shape}: give (k,) and (k, 3), k ≥ 2"
            )
        if not (np.isfinite(times).all() and np.isfinite(torques).all()):
            raise UsageError("the torque table holds a value that is not finite: give finite numbers")
        falls = np.flatnonzero(np.diff(times) < 0)
        if falls.size:
            raise UsageError(f"the torque table goes back in time after row {falls[0] + 1}: sort it by time")
        if times[0] == times[-1]:
            raise UsageError(f"the torque table holds one instant, {times[0]:.6g} s: give two or more")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "torques", torques)

    @property
    def breaks(self) -> Float:
        """Return the instants of the rows."""
        return np.unique(self.times)

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return the torque between the two rows around `time`; at a jump, the value after it."""
        value, _ = self._line(time)
        if self.frame == "space":
            return quaternion.to_body(attitude, value)
        return np.broadcast_to(value, np.shape(angular_velocity))

    def terms(self, moments: Float, start: float) -> Terms:
        """Return the line through the rows around `start`."""
        if start == self.times[-1]:
            raise self._left(start)
        value, slope = self._line(start)
        if self.frame == "body":
            return Terms(value, slope)
        eye = np.eye(3)
        return Terms.of_vector(value, matrix=eye) + Terms.of_vector(slope, matrix=eye, slope=True)

    def _line(self, time: float) -> tuple[Float, Float]:
        """Return the value at `time` and the slope after it (before it, at the end)."""
        times, torques = self.times, self.torques
        if not times[0] <= time <= times[-1]:
            raise self._left(time)
        row = int(np.searchsorted(times, min(time, np.nextafter(times[-1], times[0])), side="right")) - 1
        slope: Float = (torques[row + 1] - torques[row]) / (times[row + 1] - times[row])
        return torques[row] + slope * (time - times[row]), slope

    def _left(self, time: float) -> UsageError:
        return UsageError(
            f"the torque table covers {self.times[0]:.6g} … {self.times[-1]:.6g} s, and the run leaves it at "
            f"{time:.6g} s: extend the table or shorten the run"
        )


def read_table(path: str | Path, frame: Frame = "body") -> TableTorque:
    """Read a table of `time,x,y,z` (s, N m) from a CSV file; one line of column names may come first.

    Raises `ReadError`, with the number of the line, for what is not four finite numbers or goes back in time.
    """
    rows: list[list[float]] = []
    try:
        with Path(path).open(newline="", encoding="utf-8-sig") as file:
            lines = csv.reader(file)
            for fields in lines:
                heading = lines.line_num == 1 and not any(_is_number(field) for field in fields)
                if not heading and any(field.strip() for field in fields):
                    rows.append(_row(fields, rows, f"{path}, line {lines.line_num}"))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ReadError(f"{path}: the torque table cannot be read ({error}): give a CSV file of time,x,y,z") from None
    if len(rows) < 2:
        raise ReadError(f"{path}: the torque table has {len(rows)} rows, at least 2 are needed: add rows")
    table = np.array(rows)
    return TableTorque(table[:, 0], table[:, 1:], frame)


def _row(fields: list[str], before: list[list[float]], where: str) -> list[float]:
    if len(fields) != 4:
        raise ReadError(f"{where}: {len(fields)} columns, 4 are needed: give time, x, y, z in s and N m")
    for field in fields:
        if not _is_number(field):
            raise ReadError(f"{where}: {field.strip()!r} is not a finite number: correct it")
    row = [float(field) for field in fields]
    if before and row[0] < before[-1][0]:
        raise ReadError(f"{where}: time {row[0]:.6g} s follows {before[-1][0]:.6g} s: sort the rows by time")
    return row


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
