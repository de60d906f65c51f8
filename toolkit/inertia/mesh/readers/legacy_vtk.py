"""The attributes of legacy VTK files that meshio does not know, or counts wrongly: they are passed over.

None of them says anything of the body; behind them stand others, such as its regions, which meshio reads.
Source: VTK 9, IO/Legacy/vtkDataWriter.cxx.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, BinaryIO

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown

_TYPES = {
    "bit": "bool", "char": "int8", "signed_char": "int8", "unsigned_char": "uint8", "short": "int16",
    "unsigned_short": "uint16", "int": "int32", "unsigned_int": "uint32", "vtkidtype": "int32", "long": "int64",
    "unsigned_long": "uint64", "float": "float32", "double": "float64",
    **{f"vtktype{sign}int{bits}": f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}  # fmt: skip
"""VTK's names of types, in lower case, as those of numpy; `vtkIdType` is written as an `int`."""

_WIDTHS = {"NORMALS": 3, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1, "EDGE_FLAGS": 1}
"""Attributes that are passed over, and how many numbers each point or cell has."""

_MOST_SCALARS = 4  # of a point or cell that meshio reads

_NO_NUMBERS = ("string", "variant")

_Attribute = Callable[[BinaryIO, Any], None]


def teach(reader: Any) -> None:
    """Let a module of meshio that reads legacy VTK know the types of all versions, and pass over attributes."""
    reader.vtk_to_numpy_dtype_name.update(_TYPES)
    reader._skip_meta = _metadata(reader._skip_meta)
    reader._read_section = _attribute(reader._read_section)
    reader._read_subsection = _attribute(reader._read_subsection)
    reader._read_fields = _fields(reader._read_fields, reader._skip_meta)


def _attribute(known: _Attribute) -> _Attribute:
    def read(file: BinaryIO, info: Any) -> None:
        words = info.split
        if info.section in ("COLOR_SCALARS", "LOOKUP_TABLE"):  # of fractions as text, else of bytes
            width, rows = (int(words[2]), info.num_items) if info.section == "COLOR_SCALARS" else (4, int(words[2]))
            _pass_over(file, width * rows, "unsigned_char", info.is_ascii)
        elif info.section == "TEXTURE_COORDINATES":
            _pass_over(file, int(words[2]) * info.num_items, words[3], info.is_ascii)
        elif info.section in _WIDTHS:
            _pass_over(file, _WIDTHS[info.section] * info.num_items, words[2], info.is_ascii)
        elif info.section == "SCALARS" and (words[2].lower() == "bit" or int((*words, 1)[3]) > _MOST_SCALARS):
            file.readline()
            _pass_over(file, int((*words, 1)[3]) * info.num_items, words[2], info.is_ascii)
        else:
            known(file, info)

    return read


def _metadata(known: Callable[[BinaryIO], None]) -> Callable[[BinaryIO], None]:
    """Return what reads all of METADATA, which meshio takes to end at the blank line of a component without a name.

    Such lines are of one word at most, and what follows is of more.
    """

    def read(file: BinaryIO) -> None:
        known(file)
        while line := file.readline():
            words = line.split()
            if words[:1] == [b"INFORMATION"] and len(words) == 2:
                known(file)
            elif len(words) > 1:
                file.seek(-len(line), 1)
                break

    return read


def _fields(known: Callable[..., dict[str, Any]], skip_meta: Callable[[BinaryIO], None]) -> Callable[..., Any]:
    def read(file: BinaryIO, count: int, is_ascii: bool) -> dict[str, Any]:
        data: dict[str, Any] = {}
        while count and (line := file.readline()):
            words = line.decode().split()
            if words[:1] == ["METADATA"]:
                skip_meta(file)
            elif words:
                count -= 1
                if words[3].lower() in (*_NO_NUMBERS, "bit"):
                    _pass_over(file, int(words[1]) * int(words[2]), words[3], is_ascii)
                else:
                    file.seek(-len(line), 1)
                    data |= known(file, 1, is_ascii)
        return data

    return read


def _pass_over(file: BinaryIO, count: int, kind: str, is_ascii: bool) -> None:
    """Read as many numbers, or strings, of a type of VTK."""
    name = kind.lower()
    if name not in (*_NO_NUMBERS, *_TYPES):
        raise ReadError(f"its data are of the type {shown(kind)}, which is not read: leave them out", code="not_read")
    if name in _NO_NUMBERS or is_ascii:
        size = count  # at least
    else:
        size = (count + 7) // 8 if name == "bit" else count * np.dtype(_TYPES[name]).itemsize
    _require(file, size)
    if name in _NO_NUMBERS:
        for _ in range(count):
            _pass_over_string(file, is_ascii or name == "variant")  # which are text in binary files, too
    elif not is_ascii:
        file.seek(size, 1)
    elif len(np.fromfile(file, count=count, sep=" ")) < count:
        raise ReadError("one of its attributes has fewer numbers than it counts: export it again")


def _pass_over_string(file: BinaryIO, is_ascii: bool) -> None:
    """Read a string: a line of text; else its bytes, behind their number in 1, 2, 4 or 8 bytes, as two bits say."""
    if is_ascii:
        file.readline()
    else:
        _require(file, 1)
        first = file.read(1)[0]
        size = int.from_bytes(bytes([first & 63]) + file.read((7, 3, 1, 0)[first >> 6]), "big")
        _require(file, size)
        file.seek(size, 1)


def _require(file: BinaryIO, size: int) -> None:
    if not 0 <= size <= os.fstat(file.fileno()).st_size - file.tell():
        raise ReadError("it ends within one of its attributes: it was cut short, export it again", code="cut_short")
