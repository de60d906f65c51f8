"""The loads of a scene, ``[[load]]``: what pulls at the body, and in which frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError, Section, choice, number, numbers, section_of, table_of
from inertia.dynamics.integrators.tabulated import TableTorque, read_table
from inertia.errors import UsageError

TorqueFrame = Literal["part", "principal", "space"]
TorqueFunction = Callable[[float, Float, Float], Float]

STANDARD_GRAVITY = (0.0, 0.0, -9.80665)


@dataclass(frozen=True, eq=False)
class Load(Section):
    """A load; `kind` is its name in a scene file, `noun` that in a sentence."""

    section: ClassVar[str] = "load"
    kind: ClassVar[str]
    noun: ClassVar[str]
    acts_on_mass: ClassVar[bool] = False


@dataclass(frozen=True, eq=False)
class Gravity(Load):
    """Uniform gravity: `acceleration` (3,) m/s², in space."""

    kind: ClassVar[str] = "gravity"
    noun: ClassVar[str] = "gravity"
    acts_on_mass: ClassVar[bool] = True

    acceleration: Annotated[Float, numbers((3,), "m/s²")] = STANDARD_GRAVITY  # type: ignore[assignment]


def _torque(value: Any, path: str) -> Float | TorqueFunction:
    """Read a constant torque, or take a function of (t, attitude, angular velocity)."""
    if callable(value):
        function: TorqueFunction = value
        return function
    constant: Float = numbers((3,), "N m")(value, path)
    return constant


def _table(value: Any, path: str) -> TableTorque:
    """Take a table, or make one of rows of time and torque; its own frame is of no account."""
    if isinstance(value, TableTorque):
        return value
    try:
        rows = np.asarray(value, dtype=np.float64)
        times, torques = rows[:, 0], rows[:, 1:]
    except (TypeError, ValueError, IndexError):
        raise FieldError(path, "must be rows of four numbers: time in s, and three components in N m") from None
    try:
        return TableTorque(times, torques)
    except UsageError as error:
        raise FieldError(path, f"is not usable: {error}") from None


@dataclass(frozen=True, eq=False)
class Torque(Load):
    """An applied torque: constant, by a table, or by a function.

    Attributes
    ----------
    torque : (3,) N m; or, in Python, a function of the time in s, the attitude (4,) of the part axes and the angular
        velocity (3,) along them, that returns (3,) N m
    table : rows (k, 4) of time in s and torque in N m, linear in between; in a file, the path of such a CSV
    frame : of the torque: "part" axes, "principal" axes (as ``start.frame``) or "space"
    """

    kind: ClassVar[str] = "torque"
    noun: ClassVar[str] = "an applied torque"

    torque: Annotated[Float | TorqueFunction | None, _torque] = None
    table: Annotated[TableTorque | None, _table] = None
    frame: Annotated[TorqueFrame, choice("part", "principal", "space")] = "part"

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where it is said twice, or not at all, what the torque is."""
        if (self.torque is None) == (self.table is None):
            raise FieldError(path, "is a torque: give either torque or table")


@dataclass(frozen=True, eq=False)
class Damping(Load):
    """Linear damping by the surroundings: −`coefficient` ω, in N m s."""

    kind: ClassVar[str] = "damping"
    noun: ClassVar[str] = "damping"

    coefficient: Annotated[float, number("N m s", negative=False)]


@dataclass(frozen=True, eq=False)
class GravityGradient(Load):
    """The torque of a distant primary on a free body: 3 (μ/r³) r̂ × I r̂.

    Attributes
    ----------
    mu : m³/s², gravitational parameter of the primary
    position : (3,) m in space, from the body to the primary
    """

    kind: ClassVar[str] = "gravity_gradient"
    noun: ClassVar[str] = "the gravity gradient"

    mu: Annotated[float, number("m³/s²", positive=True)]
    position: Annotated[Float, numbers((3,), "m")]


@dataclass(frozen=True, eq=False)
class Dissipation(Load):
    """Energy lost inside a free body, whose angular momentum stays: at `rate` |dω/dt|² W, the rate in kg m² s."""

    kind: ClassVar[str] = "dissipation"
    noun: ClassVar[str] = "energy lost inside the body"

    rate: Annotated[float, number("kg m² s", negative=False)]


_KINDS: dict[str, type[Load]] = {kind.kind: kind for kind in (Gravity, Torque, Damping, GravityGradient, Dissipation)}


def load_of(table: object, path: str, folder: Path) -> Load:
    """Make one load from its table in the file, which `path` names; CSV files are looked for in `folder`."""
    entries = dict(table_of(table, path))
    if "kind" not in entries:
        raise FieldError(f"{path}.kind", f"is missing: use one of {', '.join(map(repr, _KINDS))}")
    kind = _KINDS[choice(*_KINDS)(entries["kind"], f"{path}.kind")]
    if kind is Torque and isinstance(entries.get("table"), str):
        entries["table"] = read_table(folder / entries["table"])
    return section_of(kind, entries, extra=("kind",), path=path)
