"""`Assembly`: a tree of parts from a file or in Python, its mass properties and its budget."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Self

from inertia.assembly.bill import is_bill, parts_of
from inertia.assembly.budget import Budget, budget
from inertia.assembly.fields import AssemblyFields
from inertia.assembly.interference import Interference, interferences, unexamined
from inertia.assembly.outline import carried, outline, relative
from inertia.assembly.tree import PartTree
from inertia.documents import document_schema
from inertia.errors import ReadError, placed
from inertia.records import dataclass
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import path_of


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
        """Read a file, `-` for standard input; one of meshes (glTF, STEP, …) or a robot is the tree that it carries.

        Raises `ReadError`, `UsageError`; `GeometryError` for a robot of which a link has what no body can have.
        """
        return cls.carried_by(path) if carried(path_of(path)) else super().load(path)

    @classmethod
    def carried_by(
        cls, path: str | os.PathLike[str], unit: str | None = None, joints: Mapping[str, float] | None = None
    ) -> Self:
        """Read the tree that a file of meshes or of a robot carries.

        Parameters
        ----------
        unit : of the coordinates of meshes, in place of the file's own
        joints : of a robot by name, rad, or m of one that slides; of all others 0, or ``ref`` of MJCF
        """
        file = path_of(path)
        table, remarks, tree, left_out = outline(file, file.parent, unit, joints)
        own = None if tree is None else (file.parent / relative(file, file.parent), unit, tree)
        whole = cls.from_dict(table, file.parent, name=os.fspath(path))
        return replace(whole, remarks=remarks, tree=own, left_out=left_out, is_carried=True)

    @classmethod
    def loads(cls, text: str, folder: str | os.PathLike[str] = ".", name: str | None = None) -> Self:
        """Read the text of a file; that of one called .csv is a bill of materials, and `-` may be one."""
        if name is None or not (name.lower().endswith(".csv") or (name == STANDARD_INPUT and is_bill(text))):
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

    def unexamined(self) -> dict[str, str]:
        """Return the parts with an extent that `interferences` cannot look at, by name, and why."""
        return unexamined(self)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of an assembly file."""
    return document_schema(AssemblyFields, "Assembly file of inertia budget")
