"""`read`: a file becomes a `Part`.

Surfaces and Gmsh have readers here, one module a format; scenes in XML go through trimesh, the other meshes of cells
through meshio, each behind guards. trimesh would read the surfaces too, but (5.2) it passes in silence over what is
missing from a text STL, OFF or PLY file that was cut short, over the line that a negative OBJ index counts from, over
instances in nested 3MF assemblies and over sparse glTF positions; each of these gives another body.
`tests/mesh/readers/test_other_libraries.py` shows that it still does.
"""

from __future__ import annotations

import errno
import math
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from importlib import import_module
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from inertia.arrays import Float, Progress
from inertia.errors import ReadError, UsageError, placed, visible
from inertia.mesh.external.memory import require_memory
from inertia.mesh.part import Part, Rounding, Source
from inertia.mesh.readers.comments import commented_unit
from inertia.mesh.readers.compressed import UNPACK_LIMIT, packed_as, unpacked
from inertia.mesh.readers.contents import Contents, Layout, alone
from inertia.mesh.readers.formats import EXTENSIONS, FORMATS, HEAD, format_of_name, sniff
from inertia.mesh.readers.strangers import stranger
from inertia.mesh.tree import MeshTree
from inertia.mesh.version import CHANGED, Version, unchanged
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import called, file_of, reason_of
from inertia.units import DEFAULT_UNIT, Unit, UnitFrom, length_unit

_SMALL = 10_000_000  # bytes

_ZIPPED = ("3mf", "3dxml", "zae")  # formats that are zip archives themselves


def read(
    path: str | os.PathLike[str] | Any,
    unit: str | None = None,
    *,
    format: str | None = None,
    coarser: float = 1.0,
    unpack_limit: float = UNPACK_LIMIT,
    memory: float | None = None,
    progress: Progress | None = None,
) -> Part:
    """Read a mesh from a file, or take one of another library.

    Parameters
    ----------
    path : the file, `-` for standard input; its contents decide what kind it is, and its name only where they do not.
        Or a mesh in memory, for which `unit` alone counts, of trimesh, meshio, manifold3d or PyVista; or a solid of
        cadquery, build123d or OCP
    unit : the unit of length of the coordinates, in place of the file's own; without either, millimetres are
        assumed
    format : the kind of file (`"stl"`, `"obj"`, ...), where it is not to be found out
    coarser : by how much coarser than usual the triangles are that replace curved faces, where reading makes them
        (STEP): for an estimate of what they leave out, see `inertia.richardson`
    unpack_limit : GiB that a compressed file (gzip, bzip2, xz, zip, tar) may unpack to; it holds one mesh
    memory : bytes that this process may take: the faces of a binary PLY file of triangles that would take more stay in
        the file, as a large binary STL file does anyway; for `inertia.analyse` with the same limit
    progress : called with the fraction of the work that is done; a file is read in one step

    Raises
    ------
    ReadError
        If the file cannot be read; the message names it, what is wrong with it, and the remedy.
    UsageError
        If the unit or the format is not known.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "corner.off"
    ...     _ = path.write_text("OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n"
    ...                         "3 0 2 1\\n3 0 1 3\\n3 1 2 3\\n3 0 3 2\\n")
    ...     part = read(path, unit="mm")
    >>> part.triangles.count, part.unit.name, part.source.format
    (4, 'mm', 'off')
    """
    override = None if unit is None else length_unit(unit)
    if not (isinstance(coarser, Real) and 0 < coarser < math.inf):
        raise UsageError(f"coarser is {coarser!r}: it must be positive and finite")
    if format is not None and format not in FORMATS:
        raise UsageError(f"unknown format {format!r}: use one of {', '.join(FORMATS)}")
    if not (isinstance(unpack_limit, Real) and 0 < unpack_limit < math.inf):
        raise UsageError(f"unpack_limit is {unpack_limit!r}: it must be positive and finite, in GiB")
    if memory:  # 0 lets as much stay in the file as can
        require_memory(memory)
    if not isinstance(path, str | os.PathLike):
        from inertia.mesh.objects import part_of

        return part_of(path, unit)
    name = os.fspath(path)
    try:
        kind, contents, version = _contents(name, format, coarser, unpack_limit, memory)
    except ReadError as error:
        raise placed(error, f"cannot read {called(name)}") from error
    name = called(name)
    notes = list(contents.notes)
    named = format_of_name(Path(name))
    if named not in (None, kind) and format is None and Path(name).suffix.lower() not in EXTENSIONS[kind]:
        notes.append(f"the name says {named}, but the contents are {kind} and were read as such")
    if override and contents.unit and override != contents.unit:
        notes.append(
            f"the file says that its unit is {contents.unit.name}, but it was read in {override.name} as asked"
        )
    unit_and_source = _unit(override, contents.unit)
    if unit_and_source[1] == "assumed" and contents.commented is not None and contents.commented[0] != DEFAULT_UNIT:
        notes.append(
            f"its comment {contents.commented[1]} names another unit than {DEFAULT_UNIT.name}, which is assumed, as "
            "comments do not count: state the unit"
        )
    if progress is not None:
        progress(1.0)
    return Part(
        contents.geometry,
        *unit_and_source,
        Source(name, kind, version),
        contents.regions and replace(contents.regions, names=tuple(map(visible, contents.regions.names))),
        tuple(notes),
        contents.chord,
        contents.rounding and _named(contents.rounding, version, name),
        shape=contents.shape,
    )


def _named(rounding: Rounding, version: Version, name: str) -> Rounding:
    """Name the file in the errors of reading it a second time, which has to find the same version of it."""

    def remainder() -> Float:
        assert rounding.remainder is not None
        try:
            exact = rounding.remainder()
            version.require_contents()
            return exact
        except ReadError as error:
            raise placed(error, f"cannot read {name} a second time") from None
        except OSError as error:
            raise ReadError(f"cannot read {name} a second time: {error.strerror}") from None

    return rounding if rounding.remainder is None else Rounding(rounding.distance, remainder)


def _unit(override: Unit | None, of_file: Unit | None) -> tuple[Unit, UnitFrom]:
    if override is not None:
        return override, "option"
    return (DEFAULT_UNIT, "assumed") if of_file is None else (of_file, "file")


def read_tree(path: str | os.PathLike[str], unit: str | None = None) -> MeshTree | None:
    """Read the nodes of a scene or product file, and its meshes, each once; None where the format has no tree.

    Parameters
    ----------
    path, unit : as of `read`; of a compressed file no tree is read

    Raises `ReadError` as `read` does.
    """
    override = None if unit is None else length_unit(unit)
    name = os.fspath(path)
    try:
        with _opened(name) as (file, head, version):
            if packed_as(file, head) is not None:
                return None
            kind = sniff(file, head, version.size)
            module, function = FORMATS[kind].module, FORMATS[kind].tree
            if not function:
                return None
            with np.errstate(all="ignore"):  # what is not finite is refused by name
                layout: Layout = getattr(import_module(f"inertia.mesh.readers.{module}"), function)(file)
    except ReadError as error:
        raise placed(error, f"cannot read {name}") from error
    meshes = {
        title: Part(
            contents.geometry,
            *_unit(override, contents.unit),
            Source(name, kind, version),
            None,
            contents.notes,
            contents.chord,
            contents.rounding and _named(contents.rounding, version, name),
            shape=contents.shape,
        )
        for title, contents in layout.meshes.items()
    }
    return MeshTree(tuple(layout.nodes), meshes, layout.notes)


def _contents(
    name: str, format: str | None, coarser: float, unpack_limit: float, memory: float | None
) -> tuple[str, Contents, Version]:
    """Return the kind of a file, what is in it, and the version of it that was read."""
    with _opened(name) as (path, head, version):
        packed = None if format in _ZIPPED else packed_as(path, head)
        if packed is None:
            return *_sniffed(path, head, version.size, format, coarser, name, memory), version
        return *_unpacked(path, packed, format, coarser, unpack_limit), version


@contextmanager
def _opened(name: str) -> Iterator[tuple[Path, bytes, Version]]:
    """Yield where a file is, how it begins, and its version, which is the same when it has been read."""
    try:
        path = file_of(name)
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not stat.S_ISREG(status.st_mode):
            raise ReadError("it is not a regular file but a pipe, socket or device: copy its contents into a file")
        with unchanged(path) as version, alone() if name == STANDARD_INPUT else nullcontext():
            with path.open("rb") as file:
                head = file.read(HEAD)
            yield path, head, version
    except OSError as error:
        raise ReadError(reason_of(error), code="no_file") from error
    except MemoryError as error:
        if status.st_size < _SMALL:
            says = f"its counts ask for more memory than there is, though it has {status.st_size} bytes only: "
            raise ReadError(f"{says}it is damaged, export it again") from error
        raise ReadError(
            "it needs more memory than there is: split the part or use a larger machine", code="too_large"
        ) from error


def _sniffed(
    path: Path, head: bytes, size: int, format: str | None, coarser: float, called: str, memory: float | None = None
) -> tuple[str, Contents]:
    if not head:
        raise ReadError("it is empty: export the part again", code="empty_file")
    kind = sniff(path, head, size, format)
    if coarser != 1.0 and kind != "step":
        raise UsageError(f"{called} is {kind}, whose triangles are in the file: only STEP can be meshed coarser")
    try:
        contents = _read_as(kind, path, coarser, memory)
    except ReadError:
        if format is not None and (other := stranger(head)) is not None:  # which `sniff` would have said
            raise ReadError(other, code="unknown_format") from None
        raise
    commented = commented_unit(kind, head)
    return kind, contents if commented is None else replace(contents, commented=commented)


def _unpacked(path: Path, packed: str, format: str | None, coarser: float, limit: float) -> tuple[str, Contents]:
    """Return the kind of the mesh in a compressed file, and what is in it."""
    with unpacked(path, packed, limit) as member:
        try:
            with member.path.open("rb") as file:
                head = file.read(HEAD)
            kind, contents = _sniffed(
                member.path, head, member.path.stat().st_size, format, coarser, f"{member.name} in {path}"
            )
        except ReadError as error:
            raise placed(error, f"{member.name} in it") from None
    rounding = contents.rounding

    def remainder() -> Float:
        with unpacked(path, packed, limit) as member:
            again = _read_as(kind, member.path, coarser).rounding
            if again is None or again.remainder is None:
                raise ReadError(CHANGED, code="changed")
            return again.remainder()

    if rounding is not None and rounding.remainder is not None:
        rounding = Rounding(rounding.distance, remainder)
    return kind, replace(contents, notes=(member.note, *contents.notes), rounding=rounding)


def _read_as(kind: str, path: Path, coarser: float, memory: float | None = None) -> Contents:
    """Read a file with the reader of its kind; the readers are imported when they are used."""
    module, function = FORMATS[kind].module, FORMATS[kind].function
    of_kind: dict[str, tuple[object, ...]] = {"step": (coarser,), "ply": (memory,)}
    options = (kind,) if module == "meshio" else of_kind.get(kind, ())
    with np.errstate(all="ignore"):  # what is not finite is refused by name
        contents: Contents = getattr(import_module(f"inertia.mesh.readers.{module}"), function)(path, *options)
    return contents
