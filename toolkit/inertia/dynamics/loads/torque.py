"""An applied torque: constant, linear between the rows of a table, or by a function; and the CSV file of a table."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from inertia.arrays import Float
from inertia.documents import SMALLEST, FieldError, choice, finite_number, number, numbers
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.headings import cells_of, require_four, require_names, require_names_in_remarks
from inertia.dynamics.loads.load import Load, TurningBody
from inertia.encoding import text_of
from inertia.errors import ReadError, UsageError, placed
from inertia.output import note_input
from inertia.records import dataclass
from inertia.standard_input import reason_of
from inertia.tables import cell_number

_STANDS_OUT = 30.0  # times the median of the changes between two probes, that a jump changes a function by
_NO_JUMP = 1e-12  # of its largest value, and what is less is none
_SHARE = 1e-3  # of the change between two probes, that a jump is at least

TorqueFrame = Literal["part", "principal", "space"]
TorqueFunction = Callable[[float, Float, Float], Float]


@dataclass(frozen=True, eq=False)
class TorqueTable:
    """A torque that is linear between the rows of a table.

    Two rows at one instant are a jump there. A run must not leave the table.

    Attributes
    ----------
    times : (k,) s, not descending, k ≥ 2; torques : (k, 3) N m

    >>> ramp = TorqueTable([0.0, 2.0], [[0, 0, 0], [0, 0, 4]])
    >>> value, slope = ramp.line(0.5)
    >>> value.tolist(), slope.tolist()
    ([0.0, 0.0, 1.0], [0.0, 0.0, 2.0])
    """

    times: Float
    torques: Float

    def __post_init__(self) -> None:
        times, torques = np.asarray(self.times, dtype=np.float64), np.asarray(self.torques, dtype=np.float64)
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
        object.__setattr__(self, "times", np.where(np.abs(times) < SMALLEST, 0.0, times))  # or slopes overflow
        object.__setattr__(self, "torques", np.array(torques))

    @property
    def breaks(self) -> Float:
        """The instants of the rows."""
        return np.unique(self.times)

    def line(self, time: float, *, onward: bool = False) -> tuple[Float, Float]:
        """Return the torque (3,) at `time` in s, at a jump the one after it, and its slope (3,) N m/s from there on.

        Raises `UsageError` outside the table, and `onward` at its end.
        """
        times, torques = self.times, self.torques
        if not times[0] <= time <= times[-1] or (onward and time == times[-1]):
            raise UsageError(
                f"the torque table covers {times[0]:.6g} … {times[-1]:.6g} s, and the run leaves it at {time:.6g} s: "
                "extend the table or shorten the run"
            )
        row = int(np.searchsorted(times, min(time, np.nextafter(times[-1], times[0])), side="right")) - 1
        slope: Float = (torques[row + 1] - torques[row]) / (times[row + 1] - times[row])
        return torques[row] + slope * (time - times[row]), slope


def _torque(value: Any, path: str) -> Float | TorqueFunction:
    """Read a constant torque, or take a function of (t, attitude, angular velocity)."""
    if callable(value):
        function: TorqueFunction = value
        return function
    constant: Float = numbers((3,), "N m")(value, path)
    return constant


def _table(value: Any, path: str) -> TorqueTable:
    """Take a table, or make one of rows of time and torque."""
    if isinstance(value, TorqueTable):
        return value
    try:
        rows = np.asarray(value, dtype=np.float64)
        times, torques = rows[:, 0], rows[:, 1:]
    except (TypeError, ValueError, IndexError):
        raise FieldError(path, "must be rows of four numbers: time in s, and three components in N m") from None
    try:
        return TorqueTable(times, torques)
    except UsageError as error:
        raise FieldError(path, "is not usable: ", error.sentence) from None


def _instants(value: Any, path: str) -> Float:
    """Read instants in s, and put them in order."""
    entries = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(entries, Sequence) or isinstance(entries, str):
        raise FieldError(path, "must be a list of numbers, s")
    return np.unique(np.array([finite_number("s")(one, f"{path}[{k}]") for k, one in enumerate(entries)], dtype=float))


@dataclass(frozen=True, eq=False)
class Torque(Load):
    """An applied torque: constant, by a table, or by a function.

    Attributes
    ----------
    torque : (3,) N m; or, in Python, a function of the time in s, the attitude (4,) of the part axes and the angular
        velocity (3,) along them, that returns (3,) N m
    table : rows (k, 4) of time in s and torque in N m, linear in between; in a file, the path of such a CSV
    frame : of the torque: "part" axes, "principal" axes (as ``start.frame``) or "space"
    breaks : (k,) s, instants at which a function jumps or has a kink; a table has them at its rows
    longest_step : s, as short as the shortest pulse of a function between breaks; without it, steps are probed for
        pulses that they missed, at `PROBES` instants of the run and at four or more in each step, and jumps that the
        time makes are looked for and stepped to

    >>> Torque(lambda time, attitude, omega: [0, 0, float(2 <= time < 2.5)], breaks=[2, 2.5], longest_step=10).probed
    False
    """

    kind = "torque"
    noun = "an applied torque"
    starts_motion = True

    torque: Annotated[Float | TorqueFunction | None, _torque] = None
    table: Annotated[TorqueTable | None, _table] = None
    frame: Annotated[TorqueFrame, choice("part", "principal", "space")] = "part"
    breaks: Annotated[Float, _instants] = ()  # type: ignore[assignment]
    longest_step: Annotated[float | None, number("s", positive=True)] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where it is said twice, or not at all, what the torque is."""
        if (self.torque is None) == (self.table is None):
            raise FieldError(path, "is a torque: give either torque or table")
        if not callable(self.torque):
            for name, given in (("breaks", self.breaks.size > 0), ("longest_step", self.longest_step is not None)):
                if given:
                    raise FieldError(f"{path}.{name}", "goes with a function only: leave it out")
        if self.table is not None:
            object.__setattr__(self, "breaks", self.table.breaks)

    @property
    def probed(self) -> bool:
        """Whether it is a function that does not say how short its pulses are."""
        return callable(self.torque) and self.longest_step is None

    @property
    def constant(self) -> bool:
        """Whether it is one vector."""
        return self.table is None and not callable(self.torque)

    @property
    def idle(self) -> bool:
        """Whether the vector, or each row of the table, is zero."""
        if self.table is not None:
            return not self.table.torques.any()
        return self.constant and not np.asarray(self.torque).any()

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return N, or RᵀN."""
        if self.table is not None:
            value = self.table.line(time)[0]
        elif callable(self.torque):
            value = self.of_function(time, attitude, angular_velocity)
        else:
            value = np.asarray(self.torque)
        if self.frame == "space":
            return quaternion.to_body(attitude, value)
        shape = np.shape(angular_velocity)
        return value if shape == value.shape else np.broadcast_to(value, shape)

    def of_function(self, time: float, attitude: Float, angular_velocity: Float) -> Float:
        """Return what the function gives; raise `UsageError` where that is not three finite numbers."""
        assert callable(self.torque)
        returned = self.torque(time, attitude, angular_velocity)
        try:
            value = np.asarray(returned, dtype=np.float64)
        except (TypeError, ValueError):
            value = np.empty(0)
        if value.shape != (3,) or not np.isfinite(value).all():
            raise UsageError(f"the function returned {returned!r} at t = {time:.6g} s: return three finite numbers")
        return value

    def jumps(self, begin: float, end: float, attitude: Float, angular_velocity: Float, probes: int) -> Float:
        """Return instants (k,) s within a span at which a function of the time jumps, each the first after its jump.

        Between two of so many instants where it changes by far more than elsewhere, in one state of the body, it is
        halved down to neighbouring numbers; what changes there still is a jump.
        """
        instants = np.sort(np.random.default_rng(0).uniform(begin, end, probes))
        times = [begin, *instants[(instants > begin) & (instants < end)].tolist(), end]
        values = [self.of_function(time, attitude, angular_velocity) for time in times]
        changes = np.abs(np.diff(values, axis=0)).max(axis=1)
        least = max(_STANDS_OUT * float(np.median(changes)), _NO_JUMP * float(np.abs(values).max()))
        jumps: list[float] = []
        spans = [(times[k], times[k + 1], values[k], values[k + 1]) for k in np.flatnonzero(changes > least)]
        while spans and len(jumps) < probes:
            low, high, before, after = span = spans.pop()
            while low < (middle := 0.5 * (low + high)) < high:
                value = self.of_function(middle, attitude, angular_velocity)
                if np.abs(value - before).max() > np.abs(after - value).max():
                    high, after = middle, value
                else:
                    low, before = middle, value
            if np.abs(after - before).max() > max(least, _SHARE * np.abs(span[3] - span[2]).max()):
                jumps.append(high)
                halves = (span[0], low, span[2], before), (high, span[1], after, span[3])
                spans += [each for each in halves if np.abs(each[3] - each[2]).max() > least]
        return np.unique(jumps)

    def directions(self) -> Float:
        """Return N where it stands in space."""
        return self.torque[None] if self.frame == "space" and isinstance(self.torque, np.ndarray) else np.eye(3)

    def terms(self, body: TurningBody, start: float) -> Terms | None:
        """Return the torque itself, or A = 1, v = N; of a table the line through the rows around `start`."""
        if callable(self.torque):
            return None
        eye = np.eye(3)
        if self.table is None:
            value = np.asarray(self.torque)
            return Terms.of_vector(value, matrix=eye) if self.frame == "space" else Terms(value)
        value, slope = self.table.line(start, onward=True)
        if self.frame != "space":
            return Terms(value, slope)
        return Terms.of_vector(value, matrix=eye) + Terms.of_vector(slope, matrix=eye, slope=True)

    def along(self, axes: Float, principal_axes: Float) -> Torque:
        """Return the torque along `axes`; a function is told their attitude and the angular velocity along them."""
        turn = axes.T @ (principal_axes if self.frame == "principal" else np.eye(3))

        def turned(torque: Float) -> Float:
            return torque if self.frame == "space" else np.asarray(torque @ turn.T)

        frame: TorqueFrame = "space" if self.frame == "space" else "part"
        if self.table is not None:
            return Torque(table=TorqueTable(self.table.times, turned(self.table.torques)), frame=frame)
        if not callable(self.torque):
            return Torque(turned(np.asarray(self.torque)), frame=frame)
        back = quaternion.conjugate(quaternion.from_matrix(axes))

        def function(time: float, attitude: Float, angular_velocity: Float) -> Float:
            return turned(self.of_function(time, quaternion.multiply(attitude, back), axes @ angular_velocity))

        return Torque(function, frame=frame, breaks=self.breaks, longest_step=self.longest_step)

    def require_span(self, duration: float, path: str) -> None:
        """Raise `FieldError` where a table ends too early, or begins late."""
        if self.table is None:
            return
        first, last = self.table.times[[0, -1]].tolist()
        if first > 0 or last < duration:
            raise FieldError(
                f"{path}.table", f"covers {first:g} … {last:g} s, but the run goes from 0 to {duration:g} s: add rows"
            )

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return the torque, or where it comes from, and its axes."""
        axes = "in space" if self.frame == "space" else f"along the {self.frame} axes"
        if self.table is not None:
            return f"torque from a table of {len(self.table.times)} rows, {axes}"
        if isinstance(self.torque, np.ndarray):
            return f"torque {listed(self.torque)} N m {axes}"
        return f"torque by a function, {axes}"

    def entries(self, principal_axes: Float) -> dict[str, Any]:
        """Return a constant torque along part axes or in space."""
        if not isinstance(self.torque, np.ndarray):
            raise UsageError("a torque that is a function or a table has no place in a scene file: give a vector")
        principal = self.frame == "principal"
        return {
            "kind": self.kind,
            "torque": principal_axes @ self.torque if principal else self.torque,
            "frame": "part" if principal else self.frame,
        }

    @classmethod
    def with_files(cls, entries: dict[str, Any], folder: Path) -> dict[str, Any]:
        """Read the table that is named by its path."""
        if isinstance(table := entries.get("table"), str):
            return {**entries, "table": read_table(folder / table)}
        return entries


def read_table(path: str | Path) -> TorqueTable:
    """Read a table of `time,x,y,z` (s, N m) from a CSV file; one line of column names may come first. Lines
    that begin with # are passed over, but for names in them above the first row.

    Raises `ReadError`, with the number of the line, for what is not four finite numbers or goes back in time, and for
    names that say another order or another unit.
    """
    rows: list[list[float]] = []
    remarks: list[tuple[list[str], str]] = []
    named = False
    file = Path(path)
    note_input(file)
    try:
        text = text_of(file.read_bytes(), "save the table as CSV in UTF-8")
    except OSError as error:
        says = f"the torque table cannot be read: {reason_of(error)}"
        raise ReadError(says, places=(str(path),), code="no_file") from None
    except ReadError as error:
        raise placed(error, str(path)) from None
    lines = csv.reader(io.StringIO(text, newline=""))
    try:
        for fields in lines:
            where = f"{path}, line {lines.line_num}"
            if not any(field.strip() for field in fields):
                continue
            if fields[0].lstrip().startswith("#"):
                if not named:
                    remarks.append((cells_of(fields), where))
            elif named or rows or any(map(_is_number, fields)):
                if not rows:
                    require_names_in_remarks(remarks)
                rows.append(_row(fields, rows, where))
            else:
                require_names(fields, where)
                named = True
    except csv.Error as error:
        says = f"the torque table is not CSV: {error}: give a CSV file of time,x,y,z"
        raise ReadError(says, places=(str(path),), code="table") from None
    if len(rows) < 2:
        raise ReadError(f"{path}: the torque table has {len(rows)} rows, at least 2 are needed: add rows", code="table")
    table = np.array(rows)
    try:
        return TorqueTable(table[:, 0], table[:, 1:])
    except UsageError as error:
        raise ReadError(*error.words, places=(str(path),), code=error.code) from None


def _row(fields: list[str], before: list[list[float]], where: str) -> list[float]:
    require_four(fields, where)
    for field in fields:
        if not _is_number(field):
            raise ReadError(f"{where}: {field.strip()!r} is not a finite number: correct it", code="not_a_number")
    row = [float(field) for field in fields]
    if before and row[0] < before[-1][0]:
        raise ReadError(
            f"{where}: time {row[0]:.6g} s follows {before[-1][0]:.6g} s: sort the rows by time", code="table"
        )
    return row


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(cell_number(text))
    except ValueError:
        return False
