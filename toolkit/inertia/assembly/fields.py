"""The sections of an assembly file: what each field may hold, as the file has it.

Lengths are in the file's `unit`, angles in degrees; masses, densities and tensors are SI. A figure with its standard
uncertainty is written as "7850±50" or "1.2±1%".
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from inertia.arrays import Float
from inertia.assembly.frames import (
    UNTURNED,
    by_rows,
    euler,
    require_rotation,
    require_unit,
    skew_of,
    turned,
)
from inertia.documents import (
    FieldError,
    Read,
    Reader,
    Section,
    are_in_proportion,
    choice,
    estimate,
    integer,
    layout_version,
    nearest,
    number,
    numbers,
    several,
    short_repr,
    table,
    table_of,
    tables,
    text,
)
from inertia.errors import UsageError
from inertia.estimate import written
from inertia.mesh.tree import Matrix, determinant
from inertia.mesh.turns import Quaternion, about
from inertia.records import dataclass
from inertia.units import length_unit

_LENGTH = "the file's unit"
_MOST_COPIES = 1_000_000
_LONGEST = 1000  # characters of a number in quotes
_RATIONAL = re.compile(r"\s*[+-]?\d+(?:\.\d*)?(?:\s*/\s*\d+)?\s*")

SIZES = {"box": 3, "sphere": 1, "ellipsoid": 3, "cylinder": 2, "capsule": 2, "tube": 3, "cone": 2, "point": 0}
"""Shapes without a mesh, and how many lengths each has."""


def _unit(value: Any, path: str) -> str:
    name: str = text(value, path)
    try:
        return length_unit(name).name
    except UsageError as error:
        raise FieldError(path, "is an ", error.sentence) from None


unit = Reader(_unit, text.schema)
"""Read a unit of length."""


def rationals(count: int, unit: str) -> Reader:
    """Read `count` numbers of some unit; one in quotes, as "1/3" or "0.1", counts as that fraction."""
    plain = numbers((count,), unit)

    def read(value: Any, path: str) -> tuple[Fraction, ...]:
        if are_in_proportion(value, count):
            return tuple(map(Fraction, map(float, value)))
        entries = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else value
        exact: dict[int, Fraction] = {}
        if isinstance(entries, list):
            for k, entry in enumerate(entries):
                if isinstance(entry, Fraction):
                    exact[k] = entry
                elif isinstance(entry, str) and _RATIONAL.fullmatch(entry):
                    if len(entry) > _LONGEST:
                        raise FieldError(f"{path}[{k}]", f"has {len(entry)} characters: {_LONGEST} are the most")
                    above, _, below = entry.partition("/")
                    try:
                        exact[k] = Fraction(above.strip()) / Fraction(below.strip() or 1)
                    except ZeroDivisionError:
                        raise FieldError(f"{path}[{k}]", f"is {entry!r}: nothing is divided by zero") from None
                try:
                    entries[k] = float(exact[k]) if k in exact else entry
                except OverflowError:
                    raise FieldError(
                        f"{path}[{k}]", f"is {short_repr(str(entry))}: no length is of that size"
                    ) from None
        values = plain(entries, path).tolist()
        return tuple(exact.get(k, Fraction(one)) for k, one in enumerate(values))

    single: dict[str, Any] = {"oneOf": [{"type": "number"}, {"type": "string"}]}
    return Reader(read, {"type": "array", "items": single, "minItems": count, "maxItems": count})


def mapping(of: Read, schema: Mapping[str, Any]) -> Reader:
    """Read a table whose keys are names of the user's own."""

    def read(value: Any, path: str) -> dict[str, Any]:
        return {str(key): of(entry, f"{path}.{key}") for key, entry in table_of(value, path).items()}

    return Reader(read, {"type": "object", "additionalProperties": dict(schema)})


def _relative(value: Any, path: str) -> float:
    figure: float = number("", negative=False)(value, path)
    return figure


def _matrix(value: Any, path: str) -> Float:
    rows = np.asarray(value, dtype=object).shape if isinstance(value, Sequence | np.ndarray) else ()
    size = 4 if rows == (4, 4) else 3
    matrix: Float = numbers((3, 3) if size == 3 else (4, 4), "")(value, path)
    if size == 4 and matrix[3].tolist() != [0, 0, 0, 1]:
        raise FieldError(f"{path}[3]", f"is {matrix[3].tolist()}: the last row of a placement is 0, 0, 0, 1")
    return matrix


_ESTIMATE = estimate("")


def _scale(value: Any, path: str) -> float:
    scale: float = _ESTIMATE(value, path)
    if scale != 1:
        raise FieldError(
            path,
            f"is {written(scale)}: coordinates are taken as stored, so that it is 1 with an uncertainty, as '1±0.002'; "
            "where they have another size, give unit or stretch",
        )
    return scale


def _stretch(value: Any, path: str) -> Matrix:
    """Read three factors along x, y and z, or a matrix that is not singular."""
    entries = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else []
    if len(entries) == 3 and all(
        isinstance(row, Sequence | np.ndarray) and not isinstance(row, str) for row in entries
    ):
        rows: Matrix = tuple(rationals(3, "")(row, f"{path}[{k}]") for k, row in enumerate(entries))
    else:
        factors = rationals(3, "")(value, path)
        rows = tuple(tuple(factors[i] if i == j else Fraction(0) for j in range(3)) for i in range(3))
    if not determinant(rows):
        raise FieldError(path, "leaves nothing of the part: its determinant is zero")
    return rows


_TENSOR = numbers((3, 3), "kg m²")


def _spread(value: Any, path: str) -> Float:
    """Read one figure for all elements of a tensor, or a symmetric matrix of them."""
    if not isinstance(value, Sequence | np.ndarray):
        return np.full((3, 3), number("kg m²", negative=False)(value, path))
    spread: Float = _TENSOR(value, path)
    if (spread < 0).any() or (spread != spread.T).any():
        raise FieldError(path, "must be a symmetric matrix of standard uncertainties, none of them negative")
    return spread


_SPREAD = Reader(_spread, {"oneOf": [{"type": "number"}, _TENSOR.schema]})


def _sequence(value: Any, path: str) -> str:
    word: str = text(value, path)
    if re.fullmatch(r"[xyz]{1,3}|[XYZ]{1,3}", word) and not re.search(r"(.)\1", word):
        return word
    raise FieldError(
        path,
        f"is {short_repr(value)}: name one to three axes, as 'ZXZ' (each about the axes as turned so far) or 'xyz' "
        "(about the axes at rest), no axis twice in a row",
    )


def _normal(value: Any, path: str) -> tuple[Fraction, ...]:
    if isinstance(value, str):
        axis = choice("x", "y", "z")(value, path)
        return tuple(Fraction(axis == k) for k in "xyz")
    normal: tuple[Fraction, ...] = rationals(3, "any length")(value, path)
    if not any(normal):
        raise FieldError(path, "is zero: give a direction, or 'x', 'y' or 'z'")
    return normal


_THREE = rationals(3, "").schema
_STRETCH = {"oneOf": [_THREE, {"type": "array", "items": _THREE, "minItems": 3, "maxItems": 3}]}

direction = Reader(_normal, {"oneOf": [{"enum": ["x", "y", "z"]}, _THREE]})
"""Read a direction of any length, or the name of an axis."""

_ROWS = {"type": "array", "items": {"type": "array", "items": {"type": "number"}}, "minItems": 3, "maxItems": 4}


@dataclass(frozen=True, eq=False)
class Around(Section):
    """Copies around an axis, the first as it is placed.

    Attributes
    ----------
    count : how many in all
    axis : its direction, of any length, in the axes of the parent
    through : a point on it
    angle : degrees over which they are spread; of less than 360 the last copy is at the end of it
    """

    section: ClassVar[str] = "around"

    count: Annotated[int, integer(1, _MOST_COPIES)]
    axis: Annotated[tuple[Fraction, ...], direction]
    through: Annotated[tuple[Fraction, ...] | None, rationals(3, _LENGTH)] = None
    angle: Annotated[float, number("degrees")] = 360.0

    def turns(self) -> list[Quaternion]:
        """Return the turn of each copy, exact for multiples of 90°."""
        whole = self.angle % 360 == 0
        step = Fraction(self.angle) / max(1, self.count if whole else self.count - 1)
        return [about(self.axis, k * step) for k in range(self.count)]


@dataclass(frozen=True, eq=False)
class Rows(Section):
    """Copies in rows along the axes of the parent, the first as it is placed.

    Attributes
    ----------
    count : how many along x, y and z
    step : from one to the next along each
    """

    section: ClassVar[str] = "rows"

    count: Annotated[tuple[int, ...], several(integer(1, _MOST_COPIES), least=3)]
    step: Annotated[tuple[Fraction, ...], rationals(3, _LENGTH)]

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where there are too many."""
        if len(self.count) != 3:
            raise FieldError(f"{path}.count", f"has {len(self.count)} entries: give three, along x, y and z")
        if (many := self.count[0] * self.count[1] * self.count[2]) > _MOST_COPIES:
            raise FieldError(f"{path}.count", f"asks for {many} copies: {_MOST_COPIES} are the most")


@dataclass(frozen=True, eq=False)
class Bound(Section):
    """How far at most what was computed elsewhere is off, as it was certified there.

    Attributes
    ----------
    mass : relative
    center_of_mass : a distance
    inertia : relative, in the Frobenius norm, of a tensor that is stated
    method : that computed it
    """

    section: ClassVar[str] = "bound"

    mass: Annotated[float, number("", negative=False, below=1.0)] = 0.0
    center_of_mass: Annotated[float, number(_LENGTH, negative=False)] = 0.0
    inertia: Annotated[float, number("", negative=False)] = 0.0
    method: Annotated[str | None, text] = None


@dataclass(frozen=True, eq=False, kw_only=True)
class PartFields(Section):
    """One of ``[[part]]``: what it is, how heavy, where, how sure that is, and how mature it is.

    Without a file, an assembly, a shape or a mass it is a group that other parts name as their parent.

    Attributes
    ----------
    name : by which others call it their parent, globs give it a material, and reports list it
    parent : the part or group that its placement is relative to
    file : path of a mesh or STEP file, relative to the assembly file
    region : the region of the file that is the part, where it is not all of it
    mesh : the mesh of the file that is the part, in its own axes, where the file places several (glTF, 3MF, Collada,
        STEP)
    stretch : factors along x, y and z, or a matrix (3, 3), that the coordinates of the file are multiplied by before
        the part is placed; a mirror has a negative determinant
    assembly : path of another assembly file
    shape : of what has no mesh, centred on its origin: box, sphere, ellipsoid; cylinder, capsule, tube and cone stand
        along z
    size : its lengths: box x, y, z; sphere radius; ellipsoid half axes; cylinder radius, length; capsule radius, length
        without the half balls at its ends; tube outer radius, inner radius, length; cone radius, height, its base at
        −height/4, as that puts the centre of mass at the origin
    unit : of the coordinates of a file that states none; the unit of the assembly without it
    density : kg/m³
    material : a name in ``[densities]`` or in the table of materials
    mass : kg, as weighed or guessed, of one copy; with a density as well it overrides
    center_of_mass : as measured, in the axes of the part, in place of what follows from the shape
    inertia : kg m², as measured, about the centre of mass along the axes of the part
    bound : how far at most a mass, a centre of mass and a tensor that were computed elsewhere are off; none of what was
        measured, which is exact as stated but for its uncertainty
    shell : wall thickness in the file's unit, of a mesh that is a surface
    sigma : standard deviation of the noise of every coordinate of the mesh
    surface_uncertainty : in the file's unit, standard uncertainty of how far the surface of the solid is from where the
        mesh has it, outwards all over, as of a layer of paint or a casting's wall
    scale : 1 with the standard uncertainty of a factor common to all coordinates of the mesh, as "1±0.002"
    scale_of : a name that parts of one common scale share, as of one printer
    center_of_mass_uncertainty : standard uncertainty of each coordinate of the centre of mass as measured
    inertia_uncertainty : kg m², standard uncertainty of every element of the tensor as measured, or (3, 3) of each
    quantity : copies at one and the same place
    at : where its origin lies in the axes of the parent
    quaternion : x, y, z, w, of its axes in those of the parent
    matrix : rotation by rows (3, 3), or (4, 4) with the translation in its last column
    euler : degrees, about the axes that `sequence` names
    sequence : of the Euler angles, as "ZXZ" (turned axes) or "xyz" (axes at rest)
    mirror : "x", "y", "z" or a normal: the part is reflected in that plane through its origin, before it is placed;
        what was measured is stated of it as mirrored, and parts that hang on it are not
    around : copies around an axis of the parent
    rows : copies in rows along the axes of the parent
    position_uncertainty : standard uncertainty of each coordinate of the place, of every copy by itself
    angle_uncertainty : degrees, standard uncertainty of the turn about each axis of the parent, of every copy by itself
    maturity : a column of the table of allowances
    category : a row of it
    allowance : mass growth allowance as a part of the basic mass, in place of the table's
    """

    section: ClassVar[str] = "part"
    _synonyms: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("position", "location", "origin", "translation", "offset"), "at"),
        **dict.fromkeys(("rotation", "orientation", "attitude"), "quaternion, matrix or euler"),
        **dict.fromkeys(("com", "center", "centre", "centroid"), "center_of_mass"),
        **dict.fromkeys(("count", "copies", "number"), "quantity"),
        **dict.fromkeys(("dimensions", "radius", "diameter"), "size"),
        "weight": "mass",
        "tensor": "inertia",
        "thickness": "shell",
        "path": "file",
    }

    name: Annotated[str, text]
    parent: Annotated[str | None, text] = None
    file: Annotated[str | None, text] = None
    region: Annotated[str | None, text] = None
    mesh: Annotated[str | None, text] = None
    stretch: Annotated[Matrix | None, Reader(_stretch, _STRETCH)] = None
    assembly: Annotated[str | None, text] = None
    shape: Annotated[str | None, choice(*SIZES)] = None
    size: Annotated[tuple[Fraction, ...] | None, several(number(_LENGTH, positive=True))] = None
    unit: Annotated[str | None, unit] = None
    density: Annotated[float | None, estimate("kg/m³")] = None
    material: Annotated[str | None, text] = None
    mass: Annotated[float | None, estimate("kg")] = None
    center_of_mass: Annotated[tuple[Fraction, ...] | None, rationals(3, _LENGTH)] = None
    inertia: Annotated[Float | None, numbers((3, 3), "kg m²")] = None
    bound: Annotated[Bound | None, table(Bound)] = None
    shell: Annotated[float | None, estimate(_LENGTH)] = None
    sigma: Annotated[float | None, number(_LENGTH, positive=True)] = None
    surface_uncertainty: Annotated[float | None, number(_LENGTH, negative=False)] = None
    scale: Annotated[float | None, Reader(_scale, {"oneOf": [{"const": 1}, _ESTIMATE.schema["oneOf"][1]]})] = None
    scale_of: Annotated[str | None, text] = None
    center_of_mass_uncertainty: Annotated[float | None, number(_LENGTH, negative=False)] = None
    inertia_uncertainty: Annotated[Float | None, _SPREAD] = None
    quantity: Annotated[int, integer(1, _MOST_COPIES)] = 1
    at: Annotated[tuple[Fraction, ...] | None, rationals(3, _LENGTH)] = None
    quaternion: Annotated[Float | None, numbers((4,), "x, y, z, w")] = None
    matrix: Annotated[Float | None, Reader(_matrix, _ROWS)] = None
    euler: Annotated[tuple[float, ...] | None, several(number("degrees"))] = None
    sequence: Annotated[str | None, Reader(_sequence, text.schema)] = None
    mirror: Annotated[tuple[Fraction, ...] | None, direction] = None
    around: Annotated[Around | None, table(Around)] = None
    rows: Annotated[Rows | None, table(Rows)] = None
    position_uncertainty: Annotated[float | None, number(_LENGTH, negative=False)] = None
    angle_uncertainty: Annotated[float | None, number("degrees", negative=False, below=180.0)] = None
    maturity: Annotated[str | None, text] = None
    category: Annotated[str | None, text] = None
    allowance: Annotated[float | None, number("", negative=False)] = None

    @property
    def is_group(self) -> bool:
        """Whether it has no mass of its own."""
        return self.file is None and self.shape is None and self.assembly is None and self.mass is None

    @property
    def copies(self) -> int:
        """How many there are for one of what it hangs on."""
        a, b, c = self.rows.count if self.rows is not None else (1, 1, 1)
        return self.quantity * (1 if self.around is None else self.around.count) * a * b * c

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where fields contradict each other, or one lacks another."""
        sources = [name for name in ("file", "assembly", "shape") if getattr(self, name) is not None]
        if len(sources) > 1:
            raise FieldError(f"{path}.{sources[1]}", f"is given beside {sources[0]}: a part is one of them")
        self._require_shape(path)
        weights = ("density", "material", "mass", "center_of_mass", "inertia", "shell", "sigma", "scale")
        if self.is_group or self.assembly is not None:
            for name in weights:
                if getattr(self, name) is not None:
                    what = "a group, which has no file, shape or mass" if self.is_group else "another assembly"
                    raise FieldError(f"{path}.{name}", f"is given for {what}: give it for its parts")
        self._require_what_is_mirrored(path)
        if self.density is not None and self.material is not None:
            raise FieldError(f"{path}.material", "is given beside density: give one")
        if self.inertia is not None and self.mass is None:
            raise FieldError(f"{path}.mass", "is missing: a tensor as measured is that of a mass as measured")
        for name, needs in (
            ("bound", "mass"),
            ("center_of_mass_uncertainty", "center_of_mass"),
            ("inertia_uncertainty", "inertia"),
            ("scale_of", "scale"),
        ):
            if getattr(self, name) is not None and getattr(self, needs) is None:
                raise FieldError(f"{path}.{name}", f"is given without {needs}: give both, or none")
        for name in ("region", "mesh", "stretch", "shell", "sigma", "surface_uncertainty", "scale", "unit"):
            if getattr(self, name) is not None and self.file is None:
                raise FieldError(f"{path}.{name}", "is that of a file, and the part has none: leave it out")
        if self.mesh is not None and self.region is not None:
            raise FieldError(f"{path}.region", "is given beside mesh: give one")
        for name in ("shell", "sigma", "surface_uncertainty") if self.stretch is not None else ():
            if getattr(self, name) is not None:
                raise FieldError(f"{path}.{name}", "is given beside stretch, which would stretch it: give one")
        if self.surface_uncertainty is not None and self.shell is not None:
            raise FieldError(
                f"{path}.surface_uncertainty", "is given for a shell: give that of its thickness, as shell"
            )
        self._require_turn(path)

    def _require_what_is_mirrored(self, path: str) -> None:
        if self.mirror is None or self.file is not None:
            return
        if self.is_group or self.assembly is not None:
            what = "a group" if self.is_group else "another assembly"
            raise FieldError(f"{path}.mirror", f"is given for {what}: mirror its parts, and where they are placed")
        for name in ("center_of_mass", "inertia") if self.shape in (None, "point") else ():
            if getattr(self, name) is not None:
                raise FieldError(
                    f"{path}.mirror", f"is given beside {name} as measured: state that of the mirror image"
                )

    def _require_shape(self, path: str) -> None:
        if self.shape is not None:
            count = len(self.size or ())
            if count != SIZES[self.shape]:
                needs = SIZES[self.shape] or "no"
                raise FieldError(f"{path}.size", f"has {count} lengths: a {self.shape} has {needs}")
            if self.shape == "tube" and self.size is not None and self.size[1] >= self.size[0]:
                raise FieldError(f"{path}.size[1]", "is not below the outer radius: give outer, inner, length")
            if self.shape == "point" and (self.mass is None or self.density is not None):
                raise FieldError(f"{path}.mass", "is missing: a point has a mass and no density")
        elif self.size is not None:
            raise FieldError(f"{path}.size", "is given without shape: name one")

    def _require_turn(self, path: str) -> None:
        turns = [name for name in ("quaternion", "matrix", "euler") if getattr(self, name) is not None]
        if len(turns) > 1:
            raise FieldError(f"{path}.{turns[1]}", f"is given beside {turns[0]}: say once how the part is turned")
        if self.matrix is not None and self.matrix.shape == (4, 4) and self.at is not None:
            raise FieldError(f"{path}.at", "is given beside a matrix with a translation: give one")
        if (self.euler is None) != (self.sequence is None):
            absent = "sequence" if self.sequence is None else "euler"
            raise FieldError(f"{path}.{absent}", "is missing: Euler angles need the sequence of their axes, as 'ZXZ'")
        if self.euler is not None and self.sequence is not None and len(self.euler) != len(self.sequence):
            raise FieldError(
                f"{path}.euler", f"has {len(self.euler)} angles for the axes {self.sequence!r}: give one each"
            )
        if self.quaternion is not None:
            require_unit(self.quaternion.tolist(), f"{path}.quaternion")
        if self.matrix is not None:
            require_rotation(self.matrix[:3, :3].tolist(), f"{path}.matrix")
        if self.around is not None and self.rows is not None:
            raise FieldError(f"{path}.rows", "is given beside around: put one of them on a group")

    def rotation(self) -> tuple[tuple[int, ...], float]:
        """Return how its axes are turned in those of the parent, in 2⁻¹⁹², and how far that is off orthonormal."""
        if self.matrix is not None:
            rows = self.matrix[:3, :3].tolist()
            return by_rows(rows), skew_of(rows)
        if self.quaternion is not None:
            x, y, z, w = self.quaternion.tolist()
            return turned((w, x, y, z)), 0.0
        if self.euler is not None and self.sequence is not None:
            return turned(euler([Fraction(k) for k in self.euler], self.sequence)), 0.0
        return UNTURNED, 0.0


QUANTITIES = (
    "mass",
    "basic_mass",
    *(f"center_of_mass.{k}" for k in "xyz"),
    *(f"inertia.{k}" for k in ("xx", "yy", "zz", "xy", "xz", "yz")),
    *(f"principal.{k}" for k in (1, 2, 3)),
)
"""What a limit may be on: the predicted mass, the basic one, elements about the centre of mass, principal moments."""


def _meant(name: str) -> str | None:
    """Return the quantity that goes by another name, as an element by its axes the other way round; None of none."""
    kind, dot, which = name.lower().partition(".")
    kinds = list(dict.fromkeys(each.partition(".")[0] for each in QUANTITIES))
    kind = {"predicted_mass": "mass", "com": "center_of_mass"}.get(kind) or nearest(kind, kinds) or ""
    meant = f"{kind}{dot}{''.join(sorted(which))}"
    return meant if meant in QUANTITIES else None


def _quantity(value: Any, path: str) -> str:
    name: str = text(value, path)
    above, slash, below = name.partition("/")
    pair = [above.strip(), below.strip()] if slash else [name]
    for one in pair:
        if one not in QUANTITIES:
            meant = _meant(one)
            hint = f"use {', '.join(QUANTITIES)}" if meant is None else f"did you mean {meant}?"
            raise FieldError(path, f"is {short_repr(one)}: {hint}")
    if slash and pair[1].startswith("center_of_mass"):
        raise FieldError(path, f"is {name!r}: nothing is in proportion to a coordinate")
    return "/".join(pair)


@dataclass(frozen=True, eq=False, kw_only=True)
class LimitFields(Section):
    """One of ``[[limit]]``.

    Attributes
    ----------
    what : the quantity, as "mass" (predicted), "center_of_mass.x" or "inertia.xy"; or the ratio of two, as
        "inertia.zz/inertia.xx"
    min : least value: kg, kg m², and the file's unit for the centre of mass
    max : largest value
    """

    section: ClassVar[str] = "limit"

    what: Annotated[str, Reader(_quantity, text.schema)]
    min: Annotated[float | None, number("")] = None
    max: Annotated[float | None, number("")] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where there is none, or none can be met."""
        if self.min is None and self.max is None:
            raise FieldError(path, "limits nothing: give min, max or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise FieldError(f"{path}.max", f"is {self.max:g}, below min, {self.min:g}: swap them")


_ALLOWANCES = mapping(_relative, {"type": "number", "minimum": 0})


_ANYTHING = {"description": "as in a rotor file"}
_ROTOR = Reader(table_of, {"type": "object", "additionalProperties": _ANYTHING})


@dataclass(frozen=True, eq=False, kw_only=True)
class AssemblyFields(Section):
    """An assembly file.

    Attributes
    ----------
    part : the parts, each after the one that it names as its parent or before it
    name : what reports call the whole
    unit : of all lengths in the file
    materials : globs of parts' names, and the material of those that state nothing else; the first that fits counts
    densities : kg/m³ of materials, beside the table's or in place of them; what is uncertain in one is so in all its
        parts
    allowances : rows of the table of mass growth allowances, beside the built-in ones or in place of them
    limit : what is permissible
    rotor : the sections of a rotor file but for its bodies, where the whole is a rotor that `balance` takes
    schema : version of the layout
    """

    section: ClassVar[str] = ""

    part: Annotated[tuple[PartFields, ...], tables(PartFields, least=1)]
    name: Annotated[str | None, text] = None
    unit: Annotated[str, unit] = "mm"
    materials: Annotated[Mapping[str, str] | None, mapping(text, text.schema)] = None
    densities: Annotated[Mapping[str, float] | None, mapping(estimate("kg/m³"), estimate("kg/m³").schema)] = None
    allowances: Annotated[
        Mapping[str, Mapping[str, float]] | None,
        mapping(_ALLOWANCES, _ALLOWANCES.schema),
    ] = None
    limit: Annotated[tuple[LimitFields, ...], tables(LimitFields)] = ()
    rotor: Annotated[Mapping[str, Any] | None, _ROTOR] = None
    schema: Annotated[Literal[1], layout_version(1)] = 1
