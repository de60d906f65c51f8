"""The sections of a Gmsh MSH file as numbers, whether it is text or binary, and the types of its elements.

Source: C. Geuzaine and J.-F. Remacle, "Gmsh Reference Manual" 4.13, sections 10.1 and 10.2; the order of the nodes
in meshio is that of VTK's cells.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.contents import numbers

_PRISM = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11]
_PYRAMID = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]
_BRICK = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
TYPES: dict[int, tuple[str, list[int]]] = {
    1: ("line", [*range(2)]),
    2: ("triangle", [*range(3)]),
    3: ("quad", [*range(4)]),
    4: ("tetra", [*range(4)]),
    5: ("hexahedron", [*range(8)]),
    6: ("wedge", [*range(6)]),
    7: ("pyramid", [*range(5)]),
    8: ("line3", [*range(3)]),
    9: ("triangle6", [*range(6)]),
    10: ("quad9", [*range(9)]),
    11: ("tetra10", [*range(8), 9, 8]),
    12: ("hexahedron27", [*_BRICK, 22, 23, 21, 24, 20, 25, 26]),
    13: ("wedge18", [*_PRISM, 15, 17, 16]),
    14: ("pyramid14", [*_PYRAMID, 13]),
    15: ("vertex", [0]),
    16: ("quad8", [*range(8)]),
    17: ("hexahedron20", _BRICK),
    18: ("wedge15", _PRISM),
    19: ("pyramid13", _PYRAMID),
}
"""Gmsh's number of a type → meshio's name, and which of Gmsh's nodes stands at each of meshio's places."""

FORMAT = re.compile(rb"\$MeshFormat\s+(\S+)\s+([01])\s+([48])[ \t]*\r?\n")
"""The version, whether the file is binary, and the size of its size type."""

Group = tuple[int, Int, Int]
"""Elements of one type: Gmsh's number of it, the physical tag of each (0: none), and its node tags (m, k)."""


def nodes_of(number: int) -> int:
    """Return how many nodes an element of a type has."""
    if number not in TYPES:
        raise ReadError(
            f"it has elements of Gmsh's type {number}, which are not read: use first or second order", code="not_read"
        )
    return len(TYPES[number][1])


class MshFile:
    """An MSH file and how it stores numbers; `header` is a match of `FORMAT`."""

    def __init__(self, data: bytes, header: re.Match[bytes]) -> None:
        self.data = data
        self.binary = header[2] == b"1"
        big = self.binary and data[header.end() : header.end() + 4] == b"\0\0\0\1"
        self.endian = ">" if big else "<"
        self.size_type = f"u{int(header[3])}"

    def section(self, name: str) -> bytes | None:
        """Return what stands between `$name` and `$Endname`; None where there is no such section.

        The format lets sections be repeated, but no program is known to write them so.
        """
        begins = re.compile(rb"^\$" + name.encode() + rb"[ \t]*\r?\n", re.MULTILINE)
        start = begins.search(self.data)
        if start is None:
            return None
        end = self.data.find(b"$End" + name.encode(), start.end())
        if end < 0:
            raise ReadError(
                f"its section ${name} has no $End{name}: it was cut short, export it again", code="cut_short"
            )
        if begins.search(self.data, end):
            raise ReadError(f"it has the section ${name} twice, but one is read: save it as one mesh", code="not_read")
        return self.data[start.end() : end]

    def numbers(self, name: str) -> Section:
        """Return the numbers of a section that the file must have."""
        body = self.section(name)
        if body is None:
            if name == "Nodes" and self.section("ParametricNodes") is not None:
                raise ReadError(
                    "its nodes have parameters ($ParametricNodes), which are read in MSH 4.1 alone: save it without "
                    "(Mesh.SaveParametric=0), or as 4.1",
                    code="not_read",
                )
            raise ReadError(f"it has no section ${name}: it was cut short, export it again", code="cut_short")
        return Section(body, name, self)


class Section:
    """The numbers of a section, taken from the front; those of a text file are all float64 at first."""

    def __init__(self, body: bytes, name: str, file: MshFile) -> None:
        self.name = name
        self.file = file
        self.at = 0
        self.data = np.frombuffer(body, np.uint8) if file.binary else numbers(body, np.float64, f"its ${name}")

    def take(self, dtype: Any, count: int) -> NDArray[Any]:
        """Take `count` items, which a binary file stores as `dtype`."""
        stored = np.dtype(dtype).newbyteorder(self.file.endian)
        step = stored.itemsize if self.file.binary else 1
        if not 0 <= count <= (len(self.data) - self.at) // step:
            raise ReadError(
                f"its section ${self.name} ends too early: it was cut short or damaged, export it again",
                code="cut_short",
            )
        values = self.data[self.at : self.at + count * step]
        self.at += count * step
        return values.view(stored) if self.file.binary else values

    def floats(self, count: int) -> Float:
        """Take `count` doubles."""
        return self.take("f8", count).astype(np.float64)

    def ints(self, count: int, dtype: str = "i4") -> Int:
        """Take `count` whole numbers."""
        return self.whole(self.take(dtype, count))

    def sizes(self, count: int) -> Int:
        """Take `count` numbers of the file's size type."""
        return self.ints(count, self.file.size_type)

    def size(self) -> int:
        """Take one number of the file's size type."""
        return int(self.sizes(1)[0])

    def line(self) -> int:
        """Take the count that begins a section of MSH 2, which is text in binary files too."""
        if not self.file.binary:
            return int(self.ints(1)[0])
        text = self.data[:20].tobytes().partition(b"\n")[0]
        if not text.strip().isdigit():
            raise ReadError(f"its section ${self.name} does not begin with a count: export it again")
        self.at = len(text) + 1
        return int(text)

    def rest(self) -> Int:
        """Take all the numbers of a text section that are left."""
        return self.ints(len(self.data) - self.at)

    def whole(self, values: NDArray[Any]) -> Int:
        """Return values that should be tags or counts as integers."""
        if values.dtype.kind == "f" and not ((np.abs(values) < 2**53) & (values == np.floor(values))).all():
            raise ReadError(f"its section ${self.name} has a number that is no tag or count: export it again")
        return values.astype(np.int64)

    def finish(self, what: str, stated: int, listed: int) -> None:
        """Raise `ReadError` where the section holds more, or other counts, than it says."""
        left = self.data[self.at :]
        over = len(left.tobytes().strip(b"\r\n")) if self.file.binary else len(left)
        if stated != listed or over:
            raise ReadError(
                f"its section ${self.name} says {stated} {what} but holds {listed}, with {over} "
                f"{'bytes' if self.file.binary else 'numbers'} left over: it is damaged, export it again"
            )
