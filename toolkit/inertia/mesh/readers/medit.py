"""Medit: keywords and counts on lines of their own, as meshio needs them, though any white space may part them.

Tables that meshio reads otherwise, or not, are refused; those that say nothing of a body are left out.
Source: libMeshb, "The Gamma Mesh Format"; MMG and BAMG write the tables that are left out.
"""

from __future__ import annotations

import re

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown

_END = re.compile(rb"^[ \t]*End\b", re.MULTILINE)
_KEYWORD = re.compile(rb"(?<!\S)([A-Z][A-Za-z]+)\s+(\d+)(?!\S)")
_IN_ONE_LINE = (b"MeshVersionFormatted", b"Dimension")
_AS_2 = (b"3", b"4")  # which differ from version 2 in how binary files store whole numbers alone
_LAST_END = re.compile(rb"[ \t]+(End\s*)\Z")
_TABLE = re.compile(rb"^[ \t]*([A-Z][A-Za-z]+)\s+\d", re.MULTILINE)
_CURVED = re.compile(
    rb"^[ \t]*((?:Edges|Triangles|Quadrilaterals|Tetrahedra|Hexahedra|Prisms|Pyramids)[PQ]\d)\b", re.MULTILINE
)

_WIDTHS = {
    (1,): b"Corners Ridges RequiredVertices RequiredEdges RequiredTriangles RequiredQuadrilaterals RequiredTetrahedra "
    b"RequiredPrisms RequiredHexahedra",
    (2,): b"NormalAtVertices TangentAtVertices EdgesOnGeometricEdge EdgeOnGeometricEdge",
    (3,): b"NormalAtTriangleVertices TangentAtEdges TangentAtEdgeVertices",
    (2, 3): b"Normals Tangents",
    (3, 4): b"SubDomainFromGeom",
    (4,): b"NormalAtQuadrilateralVertices SubDomainFromMesh",
    (): b"AngleOfCornerBound BoundingBox",
}
_ASIDE = {table: widths for widths, tables in _WIDTHS.items() for table in tables.split()}
"""Tables that say nothing of a body: how many numbers a row may have behind the count of rows; (): without a count."""

_ASIDE_TABLE = re.compile(rb"^[ \t]*(%s)\b([^A-Za-z]*(?:[eE][-+\d][^A-Za-z]*)*)" % b"|".join(_ASIDE), re.MULTILINE)
_COMMENT = re.compile(rb"#[^\r\n]*")
_MOST = 6  # numbers without a count, of a bounding box


def plain_medit(data: bytes) -> bytes:
    """Return a file without comments and without the tables that say nothing of its bodies."""
    lines = _COMMENT.sub(b"", data).replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    plain = _LAST_END.sub(rb"\n\1", _KEYWORD.sub(_apart, lines))
    _check(plain)
    return _ASIDE_TABLE.sub(_left_out, plain)


def _apart(keyword: re.Match[bytes]) -> bytes:
    """Return a keyword, with what stands behind it, on lines of its own."""
    name, number = keyword.groups()
    if name == b"MeshVersionFormatted" and number in _AS_2:
        number = b"2"
    return b"\n%s%s%s\n" % (name, b" " if name in _IN_ONE_LINE else b"\n", number)


def _check(data: bytes) -> None:
    """Refuse what was cut short, cells of higher order and tables that are there twice."""
    end = _END.search(data)
    if end is not None and data[end.end() :].strip():
        raise ReadError("text follows its End: it was cut short or damaged, export it again", code="cut_short")
    if end is None and not data.endswith(b"\n"):
        raise ReadError("it has no End, and its last line no end: it was cut short, export it again", code="cut_short")
    curved = _CURVED.search(data)
    if curved is not None:
        raise ReadError(f"its table {shown(curved[1])} is not read: use cells of first order", code="not_read")
    tables = _TABLE.findall(data)
    if len(set(tables)) < len(tables):
        raise ReadError("it has a table twice: export it again")


def _left_out(table: re.Match[bytes]) -> bytes:
    """Return nothing in place of a table that is as long as it says: else it may hold the rows of one of cells."""
    words, widths = table[2].split(), _ASIDE[table[1]]
    if widths:
        count = int(words[0]) if words and words[0].isdigit() else -1
        known = any(len(words) - 1 == count * width for width in widths)
    else:
        known = len(words) <= _MOST
    if not known:
        raise ReadError(f"its table {shown(table[1])} is not as long as it says: it was cut short or damaged")
    return b""
