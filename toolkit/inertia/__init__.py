"""Mesh in, exact inertia out.

The public names below are imported when they are first used, so that ``import inertia`` costs nothing.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inertia.balancing.balance import Balance, balance
    from inertia.balancing.rotor import Rotor
    from inertia.dynamics.run import Run
    from inertia.dynamics.scene.document import Scene
    from inertia.dynamics.simulate import simulate
    from inertia.errors import GeometryError, InertiaError, ReadError, UsageError
    from inertia.mass.analysis import Analysis, analyse, mass_properties
    from inertia.mass.elements import lamina, point_masses, wire
    from inertia.mass.principal import Principal, principal
    from inertia.mass.properties import ErrorBound, MassProperties
    from inertia.mass.repair import Repaired, repair, weld
    from inertia.mass.tensor import reexpress, steiner
    from inertia.mass.tessellation import richardson
    from inertia.mesh.check import Finding, Report, check
    from inertia.mesh.part import Part
    from inertia.mesh.read import read
    from inertia.recording.record import record
    from inertia.work_precision.trade import Trade, trade

_HOMES = {
    "balancing.balance": ("Balance", "balance"),
    "balancing.rotor": ("Rotor",),
    "dynamics.run": ("Run",),
    "dynamics.scene.document": ("Scene",),
    "dynamics.simulate": ("simulate",),
    "errors": ("GeometryError", "InertiaError", "ReadError", "UsageError"),
    "mass.analysis": ("Analysis", "analyse", "mass_properties"),
    "mass.elements": ("lamina", "point_masses", "wire"),
    "mass.principal": ("Principal", "principal"),
    "mass.properties": ("ErrorBound", "MassProperties"),
    "mass.repair": ("Repaired", "repair", "weld"),
    "mass.tensor": ("reexpress", "steiner"),
    "mass.tessellation": ("richardson",),
    "mesh.check": ("Finding", "Report", "check"),
    "mesh.part": ("Part",),
    "mesh.read": ("read",),
    "recording.record": ("record",),
    "work_precision.trade": ("Trade", "trade"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__version__ = "0.1.0"
__all__ = [
    "Analysis",
    "Balance",
    "ErrorBound",
    "Finding",
    "GeometryError",
    "InertiaError",
    "MassProperties",
    "Part",
    "Principal",
    "ReadError",
    "Repaired",
    "Report",
    "Rotor",
    "Run",
    "Scene",
    "Trade",
    "UsageError",
    "analyse",
    "balance",
    "check",
    "lamina",
    "mass_properties",
    "point_masses",
    "principal",
    "read",
    "record",
    "reexpress",
    "repair",
    "richardson",
    "simulate",
    "steiner",
    "trade",
    "weld",
    "wire",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module 'inertia' has no attribute {name!r}")
    value = getattr(import_module(f"inertia.{_HOME_OF[name]}"), name)
    globals()[name] = value
    return value


class _Package(ModuleType):
    """A package whose public names stay, where importing a folder of the same name (`inertia.trade`) would take one."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME_OF and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
