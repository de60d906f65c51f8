"""The parts of a body that changes its shape, ``[[part]]``, and the joints that they hang on, ``[[part.joint]]``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np

from inertia.documents import FieldError, require_known, section_of, table_of, text
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart
from inertia.dynamics.scene.body import SceneBody, integrated
from inertia.dynamics.scene.sections import BodySource
from inertia.mesh.part import Part
from inertia.records import dataclass


@dataclass(frozen=True, eq=False, kw_only=True)
class PartSource(BodySource):
    """One of the tables ``[[part]]``: what ``[body]`` may hold, in assembly axes, and where the part hangs.

    Attributes
    ----------
    name : by which other parts call it their parent
    parent : the part that it hangs on; none for the root, whose axes are those of the whole body
    """

    section: ClassVar[str] = "part"

    name: Annotated[str, text]
    parent: Annotated[str | None, text] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the body is not given once, or has no mass."""
        super().require_sense(path)
        if self.part is None and self.mass is None:
            raise FieldError(f"{path}.mass", "is missing: every part needs one, or a file to integrate")


def build_parts(tables: object, folder: Path) -> SceneBody:
    """Make a body of its parts; their files are looked for in `folder`.

    Raises `FieldError` naming the field, as ``part[1].joint[0].times[2]``; `ReadError` and `GeometryError` as `build`.
    """
    parts: list[JointedPart] = []
    meshes: list[Part | None] = []
    notes: list[str] = []
    for k, table in enumerate(_tables(tables, "part", "[[part]]")):
        part, mesh, part_notes = _part(table, folder, f"part[{k}]")
        parts.append(part)
        meshes.append(mesh)
        notes.extend(f"{part.name}: {note}" for note in part_notes)
    return SceneBody.of_assembly(JointedBody(tuple(parts)), tuple(meshes), tuple(notes))


def _part(table: object, folder: Path, path: str) -> tuple[JointedPart, Part | None, tuple[str, ...]]:
    entries = table_of(table, path)
    source = section_of(PartSource, entries, extra=("joint",), path=path)
    tables = _tables(entries.get("joint", []), f"{path}.joint", "[[part.joint]]")
    joints = tuple(_joint(each, f"{path}.joint[{k}]") for k, each in enumerate(tables))
    if joints and source.parent is None:
        raise FieldError(f"{path}.parent", "is missing: joints hang a part on another one, which must be named")
    if source.part is not None:
        body = integrated(source, folder, path)
        assert body.mass is not None  # it was integrated
        bounds = (0.0, 0.0, 0.0) if body.properties is None else body.properties.bounds
        part = JointedPart(
            source.name,
            body.mass,
            body.inertia,
            body.center_of_mass,
            source.parent,
            joints,
            bounds,
            body.covariance,
        )
        return part, body.part, body.notes
    tensor = np.diag(source.principal_moments) if source.inertia is None else source.inertia  # type: ignore[arg-type]
    center = np.zeros(3) if source.center_of_mass is None else source.center_of_mass
    assert source.mass is not None  # the source saw to it
    return JointedPart(source.name, source.mass, tensor, center, source.parent, joints), None, ()


def _joint(table: object, path: str) -> Joint:
    entries = table_of(table, path)
    names = [each.name for each in fields(Joint)]
    require_known(entries, names, path)
    for each in fields(Joint):
        if each.default is MISSING and each.name not in entries:
            raise FieldError(f"{path}.{each.name}", "is missing: the joint needs it")
    return Joint(**entries, path=path)


def _tables(value: Any, path: str, form: str) -> Sequence[Any]:
    if not isinstance(value, Sequence) or isinstance(value, str | Mapping):
        raise FieldError(path, f"must be a list of tables: write {form} in double brackets")
    return value
