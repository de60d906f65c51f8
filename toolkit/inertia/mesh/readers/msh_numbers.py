"""The sections of a Gmsh MSH file as numbers, whether it is text or binary."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.contents import numbers

FORMAT = re.compile(rb"\$MeshFormat\s+(\S+)\s+([01])\s+([48])[ \t]*\r?\n")
"""The version, whether the file is binary, and the size of its size type."""

Group = tuple[int, Int, Int]
"""Elements of one type: Gmsh's number of it, the physical tag of each (0: none), and its node tags (m, k)."""


class MshFile:
    """An MSH file and how it stores numbers; `header` is a match of `FORMAT`."""

    def __init__(self, data: bytes, header: re.Match[bytes]) -> None:
        self.data = data
        self.binary = header[2] == b"1"
        big = self.binary and data[header.end() : header.end() + 4] == b"\0\0\0\1"
        self.endian = ">" if big else "<"
        self.size_type = f"u{int(header[3])}"

    def section(self, name: str) -> bytes | None:
        """Return what stands between `$name` and `$Endname`; None where there is no such section."""
        start = re.search(rb"^\$" + name.encode() + rb"[ \t]*\r?\n", self.data, re.MULTILINE)
        if start is None:
            return None
        end = self.data.find(b"$End" + name.encode(), start.end())
        if end < 0:
            raise ReadError(f"its section ${name} has no $End{name}: it was cut short, export it again")
        return self.data[start.end() : end]

    def numbers(self, name: str) -> MshNumbers:
        """Return the numbers of a section that the file must have."""
        body = self.section(name)
        if body is None:
            raise ReadError(f"it has no section ${name}: it was cut short, export it again")
        return MshNumbers(body, name, self)


class MshNumbers:
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
            raise ReadError(f"its section ${self.name} ends too early: it was cut short or damaged, export it again")
        taken = self.data[self.at : self.at + count * step]
        self.at += count * step
        return taken.view(stored) if self.file.binary else taken

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

    def finish(self, what: str, stated: int, found: int) -> None:
        """Raise `ReadError` where the section holds more, or other counts, than it says."""
        left = self.data[self.at :]
        over = len(left.tobytes().strip(b"\r\n")) if self.file.binary else len(left)
        if stated != found or over:
            raise ReadError(
                f"its section ${self.name} says {stated} {what} but holds {found}, with {over} "
                f"{'bytes' if self.file.binary else 'numbers'} left over: it is damaged, export it again"
            )
