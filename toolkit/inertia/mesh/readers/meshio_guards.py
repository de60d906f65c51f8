"""What meshio would misread in silence, or would never finish reading, refused before it sees the file.

Each check reads the keywords of a format and returns how many cells the file lists, where the format says so.
"""

from __future__ import annotations

import re
from pathlib import Path

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown, text_of
from inertia.mesh.readers.med import check_med
from inertia.mesh.readers.nastran import END, begin_of
from inertia.mesh.readers.xdmf import xdmf_cells

_LINES = re.IGNORECASE | re.MULTILINE

_COUNTS = {
    "vtk": re.compile(rb"^(?:POINTS|CELLS|CELL_TYPES|POINT_DATA|CELL_DATA)[ \t]+(\d+)(?:[ \t]+(\d+))?", _LINES),
    "medit": re.compile(rb"(?<!\S)[A-Z][A-Za-z]+\s+(\d+)()"),
    "su2": re.compile(rb"^N\w+\s*=\s*(\d+)()", re.MULTILINE),
}
_VTK_KIND = re.compile(rb"^[ \t]*DATASET[ \t]+(\w+)", _LINES)
_VTK_CELLS = re.compile(rb"^[ \t]*CELL_TYPES[ \t]+(\d{1,18})\b", _LINES)
_VTK_LISTS = re.compile(rb"^[ \t]*CELLS[ \t]+(\d{1,18})\b", _LINES)
_VTU_KIND = re.compile(rb"<VTKFile[^>]*\btype\s*=\s*[\"'](\w+)")
_VTU_PACKED = re.compile(rb"<VTKFile[^>]*\bcompressor\s*=\s*[\"'](?!vtkZLibDataCompressor)([^\"']+)")
_VTU_CELLS = re.compile(rb"\bNumberOfCells\s*=\s*[\"']\s*(\d{1,18})\s*[\"']")

_NASTRAN_CARD = re.compile(
    rb"^C(?:TET|PYR|PEN|HEX|IHEX|IF[HPQ]|WEDGE|TRI|TRA|TRB|TRM|TRPLT|TRSH|TORD|QUA|QDM|QDPLT|SHE|PLST|PSTS|RAC|CONE|"
    rb"BEAM|ROD|BAR|ONROD|TUBE|BEND)\w*\*?",
    _LINES,
)
"""Elements that have a volume, those of old versions (CWEDGE, CIHEX1, CQDMEM) and of NX (CPLSTS4) too."""
NASTRAN_READ = frozenset(
    b"CBEAM CROD CBAR CTRIAR CTRIA3 CTRIA6 CQUADR CSHEAR CQUAD4 CQUAD8 CQUAD9 CTETRA CPYRAM CPYRA CPENTA CHEXA".split()
)
_NASTRAN_REFUSED = re.compile(rb"^(?:=[^\r\n]*|(?:INCLUDE|GRDSET|BEGIN|GRID[BFGSU]|EGRID|CGEN|SELOC|CSUPER)\b)", _LINES)
"""What makes, moves or repeats grid points and elements, and what begins a superelement with points of its own."""

_NASTRAN_COMMENT = re.compile(rb"^[^$\n][^\n]{0,71}\$", re.MULTILINE)
_NASTRAN_TRAILING = re.compile(rb"^([^$\r\n][^$\r\n]*[ \t,])\$[^\r\n]*", re.MULTILINE)
_NASTRAN_EMPTY = re.compile(rb"^(?:[*+][^\n,]{0,7}|(?![$#,])(?=[ \t]?\S)[^\r\n]{1,2})[ \t]*\r?$", re.MULTILINE)

_TEXT = ("nastran", "abaqus", "medit", "netgen", "su2", "avsucd")

_SEPARATORS = re.compile(rb"[\x0b\x0c\x1c-\x1f]")
"""Characters that Python takes for white space, and no format does."""

_LOW_LINES = re.compile(rb"(?<!\S)[-+]?[\d.]+(?:_[\d.]+)+(?!\S)")
"""What Python takes for a number, and no format does."""


def cells_expected(path: Path, kind: str) -> int | None:
    """Check a file of meshio's format `kind`; return the number of cells that it lists, if it says."""
    if kind in _COUNTS:
        data = path.read_bytes()
        for count in (count for counts in _COUNTS[kind].findall(data) for count in counts):
            if len(count) > 18 or int(count or 0) > len(data):
                raise ReadError(
                    f"it says that it has {count.decode()} items, but it has {len(data)} bytes: it is damaged"
                )
    if kind in _TEXT:
        separator = _SEPARATORS.search(path.read_bytes())
        if separator is not None:
            raise ReadError(f"it holds the control character {shown(separator[0])}: it is damaged, export it again")
    if kind in ("netgen", "avsucd") and (word := _LOW_LINES.search(path.read_bytes())):
        raise ReadError(f"it holds {shown(word[0])}, which is not a number: export the file again", code="not_a_number")
    match kind:
        case "vtk":
            return _vtk(data)
        case "vtu":
            return _vtu(path.read_bytes())
        case "nastran":
            return _nastran(without_comments(text_of(path)))
        case "med":
            check_med(path)
        case "xdmf":
            return xdmf_cells(path)
        case "netgen":
            if b"endmesh" not in path.read_bytes()[-64:]:
                raise ReadError("it does not end with endmesh: it was cut short, export it again", code="cut_short")
    return None


def _vtk(data: bytes) -> int | None:
    for kind in _VTK_KIND.findall(data):
        if kind.upper() != b"UNSTRUCTURED_GRID":
            raise ReadError(
                f"it is a VTK dataset of the kind {shown(kind)}: save it as an unstructured grid", code="not_read"
            )
    counts, lists = ([int(count) for count in pattern.findall(data)] for pattern in (_VTK_CELLS, _VTK_LISTS))
    ends = 1 if data.partition(b"\n")[0].rstrip().endswith(b"Version 5.1") else 0  # which lists where cells begin, too
    if counts and (len(counts) > 1 or lists != [counts[0] + ends]):
        raise ReadError(f"its CELLS {lists} do not agree with its CELL_TYPES {counts}: it is damaged, export it again")
    return counts[0] if counts else None


def _vtu(data: bytes) -> int:
    kind = _VTU_KIND.search(data[:65_536])
    if kind and kind[1] != b"UnstructuredGrid":
        raise ReadError(
            f"it is a VTK dataset of the kind {shown(kind[1])}: save it as an unstructured grid", code="not_read"
        )
    packed = _VTU_PACKED.search(data[:65_536])
    if packed:
        raise ReadError(
            f"its data are packed by {shown(packed[1])}, which is not read: save it by vtkZLibDataCompressor",
            code="not_read",
        )
    pieces = re.findall(rb"<Piece\b[^>]*", data)
    if len(pieces) != 1:
        raise ReadError(f"it has {len(pieces)} pieces, but one is read: merge them into one unstructured grid")
    count = _VTU_CELLS.search(pieces[0])
    if count is None:
        raise ReadError("its piece has no NumberOfCells: export it again")
    return int(count[1])


def without_comments(data: bytes) -> bytes:
    """Return Nastran's bulk data without the comments that stand behind the fields of a line."""
    begin = begin_of(data)
    at = begin.start() if begin else len(data)
    return data[:at] + _NASTRAN_TRAILING.sub(lambda line: line[1].rstrip(b" \t"), data[at:])


def _nastran(data: bytes) -> int:
    begin = begin_of(data)
    end = END.search(data, begin.end()) if begin else None
    if begin is None or end is None:
        missing = "ENDDATA" if begin else "BEGIN BULK"
        raise ReadError(
            f"it has no {missing} line: it was cut short, or is bulk data that needs the line added", code="cut_short"
        )
    bulk = data[begin.end() : end.start()]
    refused = _NASTRAN_REFUSED.search(bulk)
    if refused:
        repeats = ", which repeats the card before it," if refused[0].startswith(b"=") else ""
        raise ReadError(
            f"its card {shown(refused[0].rstrip())}{repeats} is not read: write the bulk data out in full",
            code="not_read",
        )
    comment = _NASTRAN_COMMENT.search(bulk)
    if comment:
        raise ReadError(
            f"a comment begins within a field of its line {shown(comment[0].strip())}: write a space before it"
        )
    empty = _NASTRAN_EMPTY.search(bulk)
    if empty:
        raise ReadError(
            f"its line {shown(empty[0].strip())} has no fields: it was cut short, or write it out in full",
            code="cut_short",
        )
    cards = _NASTRAN_CARD.findall(bulk)
    for card in cards:
        if card.upper() not in NASTRAN_READ:
            raise ReadError(f"its card {shown(card)} is not read: {_instead_of(card.upper())}", code="not_read")
    return len(cards)


def _instead_of(card: bytes) -> str:
    """Return the remedy for a card of an element that is not read."""
    if card.removesuffix(b"*") in NASTRAN_READ:
        return "write elements in small or free field format"
    if b"_" in card:
        return "Nastran has no such name, which a slip of meshio's writer makes: save the mesh as VTU"
    return "write solids as CTETRA, CPYRAM, CPENTA or CHEXA, shells as CTRIA3 to CQUAD8, rods as CROD, CBAR or CBEAM"
