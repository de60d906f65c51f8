"""STL: a binary file stays where it is, as a view of the mapped records; a text file is parsed.

A file is binary when its size is that of a header of 84 bytes and as many records of 50 bytes as the header
counts, whatever the header begins with. Source: M. Burns, "Automated Fabrication", 1993, section 6.5.
"""

from __future__ import annotations

import mmap
import os
from pathlib import Path

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.part import FACET, Facets
from inertia.mesh.readers.contents import Contents
from inertia.mesh.readers.stl_text import read_stl_text

HEADER = 84


def read_stl(path: Path) -> Contents:
    """Read a binary STL file as `Facets`, without touching the records, or a text one as `Surface`."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        head = file.read(4096)
        if is_binary_stl(head, size):
            count = triangle_count(head)
            if count == 0:
                raise ReadError("it holds no triangles: export the part as a solid")
            mapping = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
            return Contents(Facets(np.frombuffer(mapping, FACET, count, HEADER), mapping, HEADER))
    if is_text_stl(head):
        return read_stl_text(path)
    if size < HEADER:
        raise ReadError(
            f"it holds {size} bytes, but a binary STL begins with {HEADER}: it was cut short, export it again"
        )
    if b"\0" not in head:
        raise ReadError("it is text, but no STL, which begins with 'solid': export it again")
    count, room = triangle_count(head), (size - HEADER) / FACET.itemsize
    raise ReadError(
        f"its header says {count} triangles ({HEADER + FACET.itemsize * count} bytes), but it holds {size} "
        f"bytes, room for {room:.6g}: it was cut short or its count is wrong, export it again"
    )


def triangle_count(head: bytes) -> int:
    """Return the number of triangles that the header of a binary STL file states."""
    return int.from_bytes(head[HEADER - 4 : HEADER], "little")


def is_binary_stl(head: bytes, size: int) -> bool:
    """Say whether the size of a file is exactly what a binary STL header asks for."""
    return len(head) >= HEADER and size == HEADER + FACET.itemsize * triangle_count(head)


def is_text_stl(head: bytes) -> bool:
    """Say whether a file begins as a text STL does; a binary one that does has zero bytes too."""
    return head.removeprefix(b"\xef\xbb\xbf").lstrip()[:5].lower() == b"solid" and b"\0" not in head
