"""The body of a scene: a part file integrated to its mass properties, or a tensor as given."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError, Section, number, numbers, text
from inertia.dynamics.body import Body
from inertia.dynamics.models.deforming.assembly import JointedBody
from inertia.errors import FieldPath, GeometryError, UsageError, placed
from inertia.mass.analysis import Analysis, analyse
from inertia.mass.principal import Principal, principal
from inertia.mass.properties import MassProperties
from inertia.mesh.part import Part
from inertia.mesh.read import read

_SOURCES = ("part", "inertia", "principal_moments")
_FOR_PART = ("unit", "density", "material")


@dataclass(frozen=True, eq=False)
class BodySource(Section):
    """The section ``[body]``: one of `part`, `inertia` and `principal_moments`, and what goes with it.

    Attributes
    ----------
    part : path of a mesh or STEP file, relative to the scene file
    unit : length unit of its coordinates; millimetres are assumed where neither this nor the file says one
    density, material : kg/m³, or a name in the table of materials; 1000 kg/m³ is assumed without them
    mass : kg; with a part, as weighed
    inertia : (3, 3) kg m² about the centre of mass, part axes
    principal_moments : (3,) kg m²; the part axes are then the principal axes, in this order
    center_of_mass : (3,) m, part axes; with inertia or principal_moments
    """

    section: ClassVar[str] = "body"

    part: Annotated[str | None, text] = None
    unit: Annotated[str | None, text] = None
    density: Annotated[float | None, number("kg/m³", positive=True)] = None
    material: Annotated[str | None, text] = None
    mass: Annotated[float | None, number("kg", positive=True)] = None
    inertia: Annotated[Float | None, numbers((3, 3), "kg m²")] = None
    principal_moments: Annotated[Float | None, numbers((3,), "kg m²")] = None
    center_of_mass: Annotated[Float | None, numbers((3,), "m")] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the body is given twice, or not at all."""
        told = [name for name in _SOURCES if getattr(self, name) is not None]
        if len(told) != 1:
            found = f"has both {' and '.join(told)}" if told else "has no tensor"
            raise FieldError(path, f"{found}: give one of {', '.join(_SOURCES)}")
        stray = ("center_of_mass",) if self.part else _FOR_PART
        for name in stray:
            if getattr(self, name) is not None:
                why = "the part has its own" if self.part else "only a part file has one"
                raise FieldError(f"{path}.{name}", f"goes with no {told[0]}: leave it out, {why}")


@dataclass(frozen=True, eq=False)
class SceneBody:
    """A body that was built: what moves, and where its mass properties are from.

    Attributes
    ----------
    body : `Body`
    axes : (3, 3), columns in part axes: the axes that ``frame = "principal"`` means
    properties : of the part, before rounding; None where the scene gave a tensor
    part : the mesh, for drawings; None where there is none
    notes : what reading and integrating the part decided, in sentences
    assembly : the parts on joints that the body is made of; `body` and `axes` are then those at t = 0, in the axes of
        the root part. None where the body is one part
    meshes : of each part of the assembly, for drawings; None where there is none
    """

    body: Body
    axes: Float
    properties: MassProperties | None = None
    part: Part | None = None
    notes: tuple[str, ...] = ()
    assembly: JointedBody | None = None
    meshes: tuple[Part | None, ...] = ()

    @classmethod
    def of(cls, body: Body | MassProperties) -> SceneBody:
        """Take a body, or the mass properties of a part; its principal axes are those of ascending moments."""
        if isinstance(body, MassProperties):
            return cls(Body.of(body), body.principal.axes, body)
        return cls(body, body.principal.axes)

    @classmethod
    def of_analysis(cls, found: Analysis) -> SceneBody:
        """Take a part that was analysed."""
        notes = list(found.notes)
        if found.part.unit_from == "assumed":
            notes.append("the unit of the part is assumed to be mm")
        if found.density_from == "assumed":
            notes.append("the density of the part is assumed to be 1000 kg/m³")
        return replace(cls.of(found.properties), part=found.part, notes=tuple(notes))

    @classmethod
    def of_assembly(
        cls, assembly: JointedBody, meshes: tuple[Part | None, ...] = (), notes: tuple[str, ...] = ()
    ) -> SceneBody:
        """Take parts on joints, as they stand at t = 0."""
        shape = assembly.shape([0.0])
        whole = cls.of(Body(shape.inertia[0], shape.mass, shape.center_of_mass[0]))
        return replace(whole, assembly=assembly, meshes=meshes, notes=notes)

    @property
    def deforms(self) -> bool:
        """Whether any joint ever moves."""
        return self.assembly is not None and bool(self.assembly.keyframes.size)

    def principal_within(self, tolerance: float) -> Principal:
        """Return the principal moments and axes about the centre of mass; moments within `tolerance` count as equal."""
        if self.properties is None:
            return principal(self.body.inertia, tolerance)
        return self.properties.principal_within(tolerance)

    @property
    def moments(self) -> Float:
        """The moments (3,) kg m² about `axes`."""
        return np.diagonal(self.axes.T @ self.body.inertia @ self.axes)

    def about(self, point: Float) -> Float:
        """Return the tensor (3, 3) kg m² about `point` (3,) m, part axes."""
        return self.body.about(point) if self.properties is None else self.properties.about(point)


def build(source: BodySource, folder: Path) -> SceneBody:
    """Read and integrate the part file, or take the tensor as given.

    Raises `ReadError` and `GeometryError` for the part as `inertia.read` and `inertia.analyse` do, `GeometryError`
    where the tensor is not physical.
    """
    if source.part is not None:
        return integrated(source, folder, "body")
    try:
        if source.principal_moments is not None:
            body = Body(np.diag(source.principal_moments), source.mass, _or_origin(source.center_of_mass))
            return SceneBody(body, np.eye(3))
        body = Body(source.inertia, source.mass, _or_origin(source.center_of_mass))  # type: ignore[arg-type]
    except GeometryError as error:
        field = "inertia" if source.principal_moments is None else "principal_moments"
        raise placed(error, FieldPath(f"body.{field}")) from None
    return SceneBody.of(body)


def _or_origin(point: Float | None) -> Float:
    return np.zeros(3) if point is None else point


def integrated(source: BodySource, folder: Path, path: str) -> SceneBody:
    """Read and integrate a part file in `folder`; `path` is the table that names it."""
    try:
        part = read(folder / str(source.part), source.unit)
        found = analyse(part, source.density, material=source.material, mass=source.mass)
    except UsageError as error:
        raise placed(error, FieldPath(path)) from None
    return SceneBody.of_analysis(found)
