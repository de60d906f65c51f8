"""`Assembly`: a tree of parts from a file or in Python, its mass properties and its budget."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

from inertia.assembly.bill import parts_of
from inertia.assembly.budget import Budget, budget
from inertia.assembly.fields import AssemblyFields
from inertia.assembly.interference import Interference, interferences
from inertia.assembly.outline import outline, relative
from inertia.assembly.tree import PartTree
from inertia.documents import document_schema
from inertia.errors import ReadError, placed
from inertia.mesh.readers.formats import format_of_name
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Assembly(PartTree):
    """A tree of parts as its file describes it; see `PartTree` for what it holds.

    >>> fan = Assembly.from_dict({"name": "fan", "part": [
    ...     {"name": "hub", "shape": "cylinder", "size": [20, 30], "material": "aluminium"},
    ...     {"name": "blade", "shape": "box", "size": [60, 25, 2], "mass": "0.012±0.0001", "at": [50, 0, 0],
    ...      "around": {"count": 9, "axis": "z"}}]})
    >>> fan.mass_properties().mass, round(fan.budget().total.sigma.mass, 6)
    (0.2097876019763093, 0.0009)
    """

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file, `-` for standard input; one of meshes (glTF, STEP, …) is the tree that it carries.

        Raises `ReadError`, `UsageError`.
        """
        if format_of_name(Path(path)) is None:
            return super().load(path)
        return cls.carried_by(path)

    @classmethod
    def carried_by(cls, path: str | os.PathLike[str], unit: str | None = None) -> Self:
        """Read the tree that a file of meshes carries, its coordinates in a unit other than its own if one is given."""
        file = Path(path)
        table, remarks, tree = outline(file, file.parent, unit)
        own = None if tree is None else (file.parent / relative(file, file.parent), unit, tree)
        return replace(cls.from_dict(table, file.parent, name=os.fspath(path)), remarks=remarks, tree=own)

    @classmethod
    def loads(cls, text: str, folder: str | os.PathLike[str] = ".", name: str | None = None) -> Self:
        """Read the text of a file; that of one called .csv is a bill of materials."""
        if name is None or not name.lower().endswith(".csv"):
            return super().loads(text, folder, name)
        try:
            parts = parts_of(text)
        except ReadError as error:
            raise placed(error, f"cannot read {name}") from None
        return cls.from_dict({"part": parts}, folder, text=text, name=name)

    def budget(self) -> Budget:
        """Return what each part contributes, how sure that is, and what became of the limits.

        Raises as `mass_properties` does, and `UsageError` for a maturity or category that the table has not.
        """
        return budget(self)

    def interferences(self, clearance: float = 0.0) -> tuple[Interference, ...]:
        """Return the pairs of parts that share space, or that are nearer than `clearance`, m.

        See `inertia.assembly.interference`.
        """
        return interferences(self, clearance)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of an assembly file."""
    return document_schema(AssemblyFields, "Assembly file of inertia budget")
