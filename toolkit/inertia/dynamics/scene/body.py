"""`SceneBody`: what moves in a scene, a part file integrated to its mass properties, a tensor as given, or parts."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from itertools import permutations
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.scene.sections import FOR_PART, BodySource
from inertia.errors import ALLOW_FAULTS, FieldPath, GeometryError, Remedy, Sentence, UsageError, Word, placed, reworded
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.analysis import Analysis
from inertia.mass.eigen import Spectrum
from inertia.mass.principal import CLASS_TOLERANCE, Principal, principal_of, spectrum_of_tensor
from inertia.mass.properties import MassProperties
from inertia.mass.tensor import array_of, faults, steiner
from inertia.mesh.part import Cells, Part, Source
from inertia.mesh.read import read
from inertia.mesh.version import Version
from inertia.records import dataclass
from inertia.standard_input import called

if TYPE_CHECKING:
    from inertia.assembly.tree import Node

_CARRIERS = ("shell", "wire")
_FEW = 10_000
"""Triangles up to which a part is integrated exactly."""


@dataclass(frozen=True, eq=False)
class SceneBody:
    """What moves in a scene, in part axes and SI units, and where its mass properties are from.

    Attributes
    ----------
    inertia : (3, 3) kg m² about the centre of mass; signs as in `inertia.mass.tensor`; zero of a point mass
    mass : kg; None where the scene gives none, which is enough for a free body
    center_of_mass : (3,) m
    axes : (3, 3), columns in part axes: the axes that ``frame = "principal"`` means; without it those of ascending
        moments
    properties : of the part, before rounding; None where the scene gave a tensor
    part : the mesh, for drawings; None where there is none
    notes : what reading and integrating the part decided, in sentences
    assembly : the parts on joints that the body is made of; the tensor and the axes are then those at t = 0, in the
        axes of the root part. None where the body is one part
    meshes : of each part of the assembly, for drawings; None where there is none
    covariance : (11, 11) of volume, mass, centre of mass and tensor, `StandardUncertainty.covariance`; None where
        nothing is stated to be uncertain

    Raises `GeometryError` where the tensor is not physical, `UsageError` where a value is not finite.

    >>> SceneBody(np.diag([1.0, 3.0, 2.0]), mass=2.0).principal.moments.tolist()
    [1.0, 2.0, 3.0]
    """

    inertia: Float
    mass: float | None = None
    center_of_mass: Float = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    axes: Float = None  # type: ignore[assignment]
    properties: MassProperties | None = None
    part: Part | None = None
    notes: tuple[str, ...] = ()
    assembly: JointedBody | None = None
    meshes: tuple[Part | None, ...] = ()
    covariance: Float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "inertia", array_of(self.inertia, (3, 3), "inertia"))
        object.__setattr__(self, "center_of_mass", array_of(self.center_of_mass, (3,), "center_of_mass"))
        if reasons := faults(self.inertia):
            raise GeometryError(f"the inertia tensor is not physical: {reasons[0]}", code="unphysical")
        if self.mass is not None and not 0 < self.mass < np.inf:
            raise GeometryError(f"the mass is {self.mass:.6g} kg: it must be positive and finite")
        if self.axes is None:
            object.__setattr__(self, "axes", self.principal.axes)

    @classmethod
    def of(cls, properties: MassProperties, part: Part | None = None, notes: tuple[str, ...] = ()) -> SceneBody:
        """Take the mass properties of a part."""
        return cls(
            properties.inertia,
            properties.mass,
            properties.center_of_mass,
            properties=properties,
            part=part,
            notes=notes,
        )

    @classmethod
    def of_analysis(cls, analysis: Analysis) -> SceneBody:
        """Take a part that was analysed."""
        notes = list(analysis.notes)
        if analysis.part.unit_from == "assumed":
            notes.append("the unit of the part is assumed to be mm")
        if analysis.density_from == "assumed":
            notes.append("the density of the part is assumed to be 1000 kg/m³")
        if analysis.refusal is not None:
            bound = analysis.properties.error.inertia
            notes.append(
                f"small faults of the mesh are allowed for: the tensor has a bound of {bound:.2g} (relative), "
                "the motion is that of the tensor as it is"
            )
        if (uncertainty := analysis.uncertainty) is not None:
            each = ", ".join(f"{u:.2g}" for u in uncertainty.principal_moments.tolist())
            notes.append(
                f"the principal moments have standard uncertainties of {each} kg m², for those of "
                f"{' and '.join(uncertainty.inputs)}; a single motion is that of the moments as "
                "they are"
            )
        body = cls.of(analysis.properties, analysis.part, tuple(notes))
        return body if uncertainty is None else replace(body, covariance=uncertainty.covariance)

    @classmethod
    def of_assembly(
        cls, assembly: JointedBody, meshes: tuple[Part | None, ...] = (), notes: tuple[str, ...] = ()
    ) -> SceneBody:
        """Take parts on joints, as they stand at t = 0."""
        shape = assembly.shape([0.0])
        return cls(shape.inertia[0], shape.mass, shape.center_of_mass[0], assembly=assembly, meshes=meshes, notes=notes)

    @property
    def deforms(self) -> bool:
        """Whether any joint ever moves."""
        return self.assembly is not None and bool(self.assembly.keyframes.size)

    @cached_property
    def principal(self) -> Principal:
        """Principal moments, axes and class of the tensor about the centre of mass."""
        return self.principal_within(CLASS_TOLERANCE)

    def principal_within(self, tolerance: float) -> Principal:
        """Return `principal` with moments that are within `tolerance` of each other, relative, counted as equal."""
        if self.properties is not None:
            return self.properties.principal_within(tolerance)
        return principal_of(self._spectrum, tolerance)

    @cached_property
    def _spectrum(self) -> Spectrum:
        return spectrum_of_tensor(self.inertia, 0)

    @property
    def moments(self) -> Float:
        """The moments (3,) kg m² about `axes`, in their order."""
        if np.array_equal(self.axes, self.principal.axes):
            return self.principal.moments
        return np.diagonal(self.axes.T @ self.inertia @ self.axes)

    def about(self, point: Float) -> Float:
        """Return the tensor (3, 3) kg m² about `point` (3,) m, part axes, by Steiner's theorem. Needs a mass."""
        if self.properties is not None:
            return self.properties.about(point)
        if self.mass is None:
            raise GeometryError("the body has no mass: moments about another point than the centre of mass need one")
        return steiner(self.inertia, self.mass, self.center_of_mass, about=self.center_of_mass, to=point)


def build(source: BodySource, folder: Path) -> SceneBody:
    """Read and integrate the part file, or take the tensor as given.

    Raises `ReadError` and `GeometryError` for the part as `inertia.read` and `inertia.analyse` do, `GeometryError`
    where the tensor is not physical.
    """
    if source.part is not None:
        return integrated(source, folder, "body")
    center = np.zeros(3) if source.center_of_mass is None else source.center_of_mass
    try:
        if source.principal_moments is not None:
            return SceneBody(np.diag(source.principal_moments), source.mass, center, axes=np.eye(3))
        assert source.inertia is not None  # the source saw to it
        return SceneBody(source.inertia, source.mass, center)
    except GeometryError as error:
        field = "inertia" if source.principal_moments is None else "principal_moments"
        raise placed(error, FieldPath(f"body.{field}")) from None


def nearest(columns: Float, axes: Float) -> tuple[Float, tuple[int, ...]]:
    """Return orthogonal columns (3, 3) in the order, and with the signs, that bring them nearest to `axes`; the order.

    >>> nearest(np.eye(3)[:, [1, 2, 0]], np.eye(3))
    (array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]]), (2, 0, 1))
    """
    overlap = axes.T @ columns
    order = max(permutations(range(3)), key=lambda order: float(np.abs(overlap[range(3), order]).sum()))
    signs = np.sign(overlap[range(3), order])
    moved: Float = columns[:, order] * np.where(signs == 0, 1.0, signs)
    return moved if np.linalg.det(moved) > 0 else moved * (1.0, 1.0, -1.0), order


def is_assembly(file: str) -> bool:
    """Whether a file's name says that it holds an assembly."""
    return file.lower().endswith((".toml", ".csv"))


def of_tree(path: Path) -> SceneBody:
    """Return the body that an assembly is, all its parts held together; raises as `Assembly.mass_properties`.

    The bounds of the parts' meshes are those of the body. The standard uncertainties that the assembly states, of
    densities, masses and places, are its `covariance`; no bound contains them.
    """
    from inertia.assembly.document import Assembly

    assembly = Assembly.load(path)
    mesh = assembly.mesh()
    if mesh is not None:
        mesh = replace(mesh, source=Source(called(str(path)), path.suffix[1:].lower(), Version(path)))
    body = SceneBody.of(assembly.mass_properties(), mesh, assembly.notes)
    if not _uncertain(assembly.root):
        return body
    sigma = assembly.budget().total.sigma
    covariance = np.zeros((11, 11))  # the volume has none
    covariance[1:, 1:] = sigma.changes[:, :10].T @ sigma.changes[:, :10]
    mass, center, tensor = (_largest(sigma.all[some]) for some in (slice(1), slice(1, 4), slice(4, 10)))
    note = (
        f"the assembly states standard uncertainties, which make {mass} kg of its mass, {center} m of its centre of "
        f"mass and {tensor} kg m² of its tensor at most; a single motion is that of the figures as they "
        "are"
    )
    return replace(body, covariance=covariance, notes=(*body.notes, note))


def _uncertain(node: Node) -> bool:
    """Whether a node of an assembly, or one below it, states a standard uncertainty."""
    fields = node.fields
    misplaced = fields is not None and bool(fields.position_uncertainty or fields.angle_uncertainty)
    return misplaced or bool(node.body and node.body.inputs) or any(map(_uncertain, node.children))


def _largest(values: Float) -> str:
    return f"{values.max():.2g}"


def accuracy_for(part: Part, *, solid: bool = True) -> Literal["exact"] | None:
    """Return how accurately to integrate a part whose motion is followed: exactly, where that takes next to no time.

    The bounds of sums in float64 are a hundred times their error, and near an unstable motion they grow. What is
    no solid holds square roots, and has no exact figures.
    """
    plain = solid and part.shape is None and not isinstance(part.geometry, Cells)
    return "exact" if plain and part.geometry.count <= _FEW else None


def integrated(source: BodySource, folder: Path, path: str) -> SceneBody:
    """Read and integrate a part or an assembly file in `folder`; `path` is the table that names it."""
    if is_assembly(str(source.part)):
        for name in ("mass", *FOR_PART):
            if getattr(source, name) is not None:
                raise FieldError(f"{path}.{name}", "goes with a mesh: the parts of an assembly have their own")
        return of_tree(folder / str(source.part))
    table = "[body]" if path == "body" else "its [[part]]"
    try:
        part = read(folder / str(source.part), source.unit)
        with _remedies_in_place(table):
            analysis = analyse(
                part,
                source.density,
                material=source.material,
                mass=source.mass,
                shell=source.shell,
                wire=source.wire,
                sigma=source.sigma,
                allow_faults=source.allow_faults,
                accuracy=accuracy_for(part, solid=source.shell is None and source.wire is None),
            )
    except UsageError as error:
        worded = (_of_table(word, table) for word in Sentence(*error.words).words)
        raise reworded(error, worded, (FieldPath(path), *error.places)) from None
    return SceneBody.of_analysis(analysis)


@contextmanager
def _remedies_in_place(table: str) -> Iterator[None]:
    """Say of what `analyse` advises what a table of a scene has a field for, and what belongs to `analyse` alone."""
    try:
        yield
    except GeometryError as error:
        words = Sentence(*error.words).words
        field: tuple[Word, ...] = ()
        allow = next((each for each in error.remedies if each.argument == ALLOW_FAULTS.argument), None)
        if allow is not None:
            k = words.index(allow)
            field = (words[k - 1], f"{allow.argument} = {allow.value} in {table}", *words[k + 1 :])
            words = words[: k - 1]
        try:
            with sound_solids_only("a scene takes sound solids only, and surfaces by their thickness", but=_CARRIERS):
                raise reworded(error, words, error.places)
        except GeometryError as noted:
            worded = (_of_table(word, table) for word in (*noted.words, *field))
            raise reworded(noted, worded, noted.places) from None


def _of_table(word: Word, table: str) -> Word:
    """Return a remedy that a table of a scene has a field of the same name for as that field; all else as it is."""
    if isinstance(word, Remedy) and word.argument in (*_CARRIERS, ALLOW_FAULTS.argument):
        value = "" if word.value is None else f" = {word.value}"
        return f"{word.argument}{value} in {table}"
    return word
