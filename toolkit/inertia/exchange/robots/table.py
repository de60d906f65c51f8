"""A list of parts with stated mass properties, as CSV or TOML.

CSV has a line of names and a row a part: name, mass, com_x, com_y, com_z, ixx, iyy, izz, ixy, ixz, iyz, and if wanted
mesh, unit and products; what else `inertia.export` writes is passed over, and so are columns whose names begin with #.
Semicolons and tabs may stand for commas. TOML has a table ``[[part]]`` each, with center_of_mass and inertia as lists.
SI units; the tensor is about the centre of mass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from inertia.arrays import Float
from inertia.documents import (
    FieldError,
    Section,
    choice,
    number,
    numbers,
    require_known,
    section_of,
    table_of,
    text,
    toml_table,
)
from inertia.encoding import text_of
from inertia.errors import ReadError, UsageError
from inertia.exchange.robots.links import Figures, Geometry, Inertial, Link, Placement, Robot
from inertia.exchange.robots.text import figures
from inertia.mass.tensor import tensor_of
from inertia.mesh.readers.contents import shown
from inertia.records import dataclass
from inertia.standard_input import file_of
from inertia.tables import cell_number, cell_text, headed
from inertia.units import length_unit

_CENTER = ("com_x", "com_y", "com_z")
_ELEMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_NEEDED = ("name", "mass", *_ELEMENTS)
_Written = tuple[Figures | None, Figures | None]  # of the centre and the tensor
_OPTIONAL = ("mesh", "unit", "products")
_EXPORTED = ("error_mass", "error_com", "error_inertia", "method", "convention")
"""Columns of `inertia.export` that nothing is compared with."""


@dataclass(frozen=True, eq=False)
class _Stated(Section):
    """A part, and what is stated of it.

    Attributes
    ----------
    name : of the part
    mass : kg
    inertia : kg m², about the centre of mass, along the axes of the mesh
    center_of_mass : m, in the axes of the mesh
    mesh : its file, beside the list
    unit : of length, of a mesh whose file has none; the metre without it
    products : what stands off the diagonal: elements of the tensor, or positive integrals
    """

    section: ClassVar[str] = "part"

    name: Annotated[str, text]
    mass: Annotated[float, number("kg")]
    inertia: Annotated[Float, numbers((3, 3), "kg m²")]
    center_of_mass: Annotated[Float, numbers((3,), "m")] = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    mesh: Annotated[str | None, text] = None
    unit: Annotated[str | None, text] = None
    products: Annotated[Literal["elements", "integrals"], choice("elements", "integrals")] = "elements"

    def require_sense(self, path: str) -> None:
        """Refuse a tensor that is not symmetric."""
        try:
            tensor_of(self.inertia)
        except UsageError as error:
            raise FieldError(f"{path}.inertia", f"is not usable: {error}") from None


def read_toml(path: Path) -> Robot:
    """Read a list of parts from a TOML file; raise `ReadError` or `UsageError` where it is none."""
    document = toml_table(_text(path))
    parts = document.get("part")
    if not isinstance(parts, list) or not parts:
        raise ReadError("it holds no list of parts: give each as [[part]]", code="empty")
    require_known(document, ("part",), "")
    tables = [table_of(table, f"part[{k}]") for k, table in enumerate(parts)]
    return _robot(path, "toml", ((table, _figures(table), f"part[{k}]") for k, table in enumerate(tables)))


def read_csv(path: Path) -> Robot:
    """Read a list of parts from a CSV file; raise `ReadError` or `UsageError` where it is none."""
    table = headed(_text(path), key="name")
    if missing := [name for name in _NEEDED if name not in table.columns]:
        raise FieldError(missing[0], f"is missing: its first line names no column {missing[0]}")
    known = (*_NEEDED, *_CENTER, *_OPTIONAL, *_EXPORTED)
    require_known(dict.fromkeys(name for name in table.columns if not name.startswith("#")), known, "")
    return _robot(path, "csv", (_row(row, f"line {line}") for line, row in table.rows))


def _robot(path: Path, format: str, tables: Iterator[tuple[Mapping[str, Any], _Written, str]]) -> Robot:
    links: dict[str, Link] = {}
    for table, written, where in tables:
        stated = section_of(_Stated, table, path=where)
        if stated.name in links:
            raise FieldError(f"{where}.name", f"is {shown(stated.name)}, as that of another part: names must differ")
        links[stated.name] = Link(stated.name, _inertial(stated, written), tuple(_meshes(stated, path, where)))
    if not links:
        raise ReadError("it holds no part: give each a row", code="empty")
    return Robot(path, format, path.stem, tuple(links.values()))


def _inertial(stated: _Stated, written: _Written) -> Inertial:
    integrals = stated.products == "integrals"
    sign = np.where(np.eye(3) > 0, 1.0, -1.0 if integrals else 1.0)
    place = Placement(np.eye(3), np.array(stated.center_of_mass))
    inertia = sign * (stated.inertia / 2 + stated.inertia.T / 2)  # what rounding left of a tensor that was turned
    return Inertial(stated.mass, place, inertia, written, integrals)


def _meshes(stated: _Stated, path: Path, where: str) -> Iterator[Geometry]:
    if stated.mesh is None:
        return
    scale: tuple[Fraction, Fraction, Fraction] | None = None
    if stated.unit is not None:
        try:
            metres = length_unit(stated.unit).metres
        except UsageError as error:
            raise FieldError(f"{where}.unit", f"is not usable: {error}") from None
        scale = metres, metres, metres
    file = path.parent / stated.mesh
    yield Geometry(file.name, "visual", file, scale=scale)


def _row(row: Mapping[str, str], where: str) -> tuple[Mapping[str, Any], _Written, str]:
    """Return a row of CSV laid out as a table of TOML, how it is written, and where it stands."""

    def value(name: str) -> float:
        word = row.get(name, "")
        try:
            return cell_number(word)
        except ValueError:
            raise FieldError(f"{where}.{name}", f"is {shown(word)}: it must be a number") from None

    xx, yy, zz, xy, xz, yz = map(value, _ELEMENTS)
    table: dict[str, Any] = {
        "name": cell_text(row.get("name", "")),
        "mass": value("mass"),
        "inertia": [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
    }
    given = [name for name in _CENTER if row.get(name)]
    if given:
        table["center_of_mass"] = [value(name) for name in _CENTER]
    table |= {name: row[name] for name in _OPTIONAL if row.get(name)}
    words = {name: row.get(name, "") for name in (*_CENTER, *_ELEMENTS)}
    center, inertia = (figures([words[name] for name in names]) for names in (given, _ELEMENTS))
    return table, (center, inertia), where


def _figures(table: Mapping[str, Any]) -> _Written:
    """Return the figures of the shortest text of each number: TOML keeps no other."""

    def words(value: object) -> Iterator[str]:
        if isinstance(value, list):
            for each in value:
                yield from words(each)
        elif isinstance(value, int | float):
            yield repr(value)

    center, inertia = (figures(words(table.get(key))) for key in ("center_of_mass", "inertia"))
    return center, inertia


def _text(path: Path) -> str:
    return text_of(file_of(str(path)).read_bytes())
