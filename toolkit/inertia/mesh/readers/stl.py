"""STL: the records of a binary file as they are, in memory or, of a large one, in the file; a text file is parsed.

A file is binary when its size is that of a header of 84 bytes and as many records of 50 bytes as the header
counts, whatever the header begins with. Text is `solid`, facets of 21 words each, `endsolid`; several solids in one
file are regions. Source: M. Burns, "Automated Fabrication", 1993, section 6.5.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents, label, numbers, shown, surface, text_of
from inertia.mesh.readers.decimals import rounding_of
from inertia.mesh.surface import FACET, Facets, FacetsInFile
from inertia.mesh.version import CHANGED

HEADER = 84
TEXT_BLOCK = 2**22
"""Bytes of a text file that are split into words at a time."""
IN_MEMORY = 2**24
"""Bytes of a binary file beyond which its records stay there."""

_WORDS = 21
_KEYWORDS = {
    0: b"facet", 1: b"normal", 5: b"outer", 6: b"loop", 7: b"vertex", 11: b"vertex", 15: b"vertex",
    19: b"endloop", 20: b"endfacet",
}  # fmt: skip
_LAST = _KEYWORDS[20]
_COORDINATES = tuple(at for vertex in (7, 11, 15) for at in range(vertex + 1, vertex + 4))


def read_stl(path: Path) -> Contents:
    """Read a binary STL file as `Facets`, or a text one as `Surface`."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        head = file.read(4096)
        if is_binary_stl(head, size):
            count = triangle_count(head)
            if count == 0:
                raise ReadError("it holds no triangles: export the part as a solid", code="empty")
            if size > IN_MEMORY:
                return Contents(FacetsInFile(path, count, HEADER))
            file.seek(HEADER)
            records = np.frombuffer(file.read(count * FACET.itemsize), FACET)
            if len(records) < count:
                raise ReadError(CHANGED, code="changed")
            return Contents(Facets(records))
    if is_text_stl(head):
        return _read_text(path)
    if size < HEADER:
        raise ReadError(
            f"it holds {size} byte{'s' * (size != 1)}, but a binary STL begins with {HEADER}: it was cut short, export "
            "it again",
            code="cut_short",
        )
    text = head.partition(b"\0")[0]
    if is_text_stl(text) and b"vertex" in text.lower():
        raise ReadError(
            f"it is a text STL, but holds a zero byte at byte {len(text)}: it is a damaged copy, export it again"
        )
    if len(text) == len(head):
        raise ReadError("it is text, but no STL, which begins with 'solid': export it again", code="wrong_format")
    count, room = triangle_count(head), (size - HEADER) / FACET.itemsize
    raise ReadError(
        f"its header says {count} triangles ({HEADER + FACET.itemsize * count} bytes), but it holds {size} "
        f"bytes, room for {room:.6g}: it was cut short or its count is wrong, export it again",
        code="cut_short",
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


def _read_text(path: Path) -> Contents:
    """Read a text STL file; the normals are ignored."""
    data = text_of(path).replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    lower = data.lower()
    corners: list[Float] = []
    runs: list[tuple[str | None, int]] = []
    name: str | None = None
    inside = False
    facets = at = 0  # `at` is the end of the solid or endsolid line before
    for begin, middle, end in _solid_lines(lower):
        if (lower[begin:middle].strip() == b"endsolid") != inside:
            raise ReadError(f"its line {_line(data, begin)} pairs solid with solid: it is damaged, export it again")
        if inside:
            blocks = _facets(lower[at:begin], facets)
            corners += blocks
            runs.append((name, sum(map(len, blocks))))
            facets += runs[-1][1]
        else:
            _check_blank(data, at, begin)
            name = data[middle:end].strip().decode("utf-8", "replace") or None
        inside = not inside
        at = end
    if inside and ("endsolid" in (name or "").lower() or b"endsolid" in lower[at:]):
        raise ReadError(
            f"its solid {shown(name or '')} has endsolid within a line, and it needs one of its own: export it again",
            code="not_read",
        )
    if inside:
        raise ReadError(
            f"its solid {shown(name or '')} has no endsolid: it was cut short, export it again", code="cut_short"
        )
    _check_blank(data, at, len(data))
    if not facets:
        raise ReadError("it holds no triangles: export the part as a solid", code="empty")
    vertices = np.concatenate(corners).reshape(-1, 3)
    rounding = rounding_of(vertices, lambda: data, lambda: _coordinates(path))
    return Contents(surface(vertices, np.arange(3 * facets).reshape(-1, 3)), regions=label(runs), rounding=rounding)


def _coordinates(path: Path) -> list[bytes]:
    """Return the coordinates of all corners as the file writes them: three words behind each `vertex` of a facet."""
    lines = text_of(path).replace(b"\r", b"\n").split(b"\n")
    names = (b"solid", b"endsolid")
    words = [word for line in lines if not line.strip().lower().startswith(names) for word in line.split()]
    return [word for at, here in enumerate(words) if here.lower() == b"vertex" for word in words[at + 1 : at + 4]]


def _solid_lines(lower: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield the lines that begin with `solid` or `endsolid`: begin, end of the word, end of the line."""
    end = 0
    while (at := lower.find(b"solid", end)) >= 0:
        begin = max(lower.rfind(b"\n", end, at) + 1, end)
        middle = at + len(b"solid")
        end = lower.find(b"\n", middle)
        end = len(lower) if end < 0 else end
        if lower[begin:at].strip() in (b"", b"end") and not lower[middle : middle + 1].strip():
            yield begin, middle, end


def _check_blank(data: bytes, start: int, stop: int) -> None:
    if data[start:stop].strip():
        raise ReadError(f"it has text outside its solids, after line {_line(data, start)}: export it again")


def _line(data: bytes, at: int) -> int:
    return data.count(b"\n", 0, at) + 1


def _facets(text: bytes, first: int) -> list[Float]:
    """Return the corners of the facets in lower-case `text`, in blocks (n, 9); `first` came before."""
    blocks: list[Float] = []
    at = 0
    while at < len(text):
        block = text[at : at + TEXT_BLOCK]
        if at + TEXT_BLOCK < len(text):
            block = block[: block.rfind(_LAST) + len(_LAST)]
            if len(block) < len(_LAST):
                raise ReadError(
                    f"facet {first} is longer than {TEXT_BLOCK >> 20} MiB: it is damaged, export it again",
                    code="too_large",
                )
        words = block.split()
        count = len(words) // _WORDS
        wrong = any(words[place::_WORDS].count(keyword) != count for place, keyword in _KEYWORDS.items())
        if wrong or len(words) % _WORDS:
            raise ReadError(_wrong_facet(words, first))
        what = f"the vertices of facets {first} to {first + count - 1}"
        columns = [numbers(b" ".join(words[place::_WORDS]), np.float64, what) for place in _COORDINATES]
        blocks.append(np.stack(columns, axis=1))
        first += count
        at += len(block)
    return blocks


def _wrong_facet(words: list[bytes], first: int) -> str:
    for facet in range(0, len(words), _WORDS):
        for place, keyword in _KEYWORDS.items():
            word = words[facet + place] if facet + place < len(words) else b""
            if word != keyword:
                end = "the end of its solid" if not word else shown(word)
                return (
                    f"facet {first + facet // _WORDS} has {end} where {keyword.decode()!r} should stand: "
                    "it is damaged, export it again"
                )
    raise AssertionError("a wrong number of words leaves a facet incomplete")
