"""Nastran's bulk data: cards in small, large or free fields over several lines, as one line of free fields each.

A line continues another where its first field is blank, or begins with + or *: that whose last field has its name,
wherever it stands, else the one before it (see `inertia.mesh.readers.nastran_cards`). A blank coordinate is 0.
Where an element has some of its midside nodes, the others are in the middles of their edges, whose decimals are exact;
without any it is of first order. What stands behind the nodes of shells and rods (angles, thicknesses, orientations,
offsets) is left aside; springs, dampers, gaps and point masses have no material, and are left out with a note.
"""

from __future__ import annotations

import re
from decimal import Decimal, localcontext

from inertia.errors import ReadError
from inertia.mesh.readers.contents import plural, shown, was
from inertia.mesh.readers.nastran_cards import cards_of

_LINES = re.IGNORECASE | re.MULTILINE
_BEGIN = re.compile(rb"^[ \t]*BEGIN[ \t]+BULK[^\n]*\n?", _LINES)
_CARDS_ALONE = re.compile(
    rb"(?:[ \t]*(?:\$[^\n]*)?\r?\n)*"
    rb"(?=(?:GRID|CORD[123][CRS]|PARAM|MAT\d+|P(?:SOLID|SHELL|COMP|BAR|BEAM|ROD)\w*|"
    rb"C(?:TET|PYR|PEN|HEX|TRI|QUA|ROD|BAR|BEAM)\w*)\*?[ \t,])",
    re.IGNORECASE,
)
END = re.compile(rb"^ENDDATA", _LINES)
_NUMBER = re.compile(
    r"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eEdD]?([-+][0-9]{1,9})|[eEdD]([0-9]{1,9}))?"
)  # 7.+1, 7.D+1, 7.D1, 7.E1, 7.
_WHOLE = re.compile(r"[0-9]{1,18}")
_DIGITS = 60  # of a middle: more than two numbers of 16 characters need, unless they are 1e40 apart

_EDGES = {
    "CTRIA6": ((0, 1), (1, 2), (2, 0)),
    "CQUAD8": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "CTETRA": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "CPYRAM": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
    "CPENTA": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3)),
    "CHEXA": (
        *((0, 1), (1, 2), (2, 3), (3, 0)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
        *((4, 5), (5, 6), (6, 7), (7, 4)),
    ),
}
_EDGES["CPYRA"] = _EDGES["CPYRAM"]
"""The corners whose edge each midside node is on, in Nastran's order."""

_CORNERS = {card: max(max(edge) for edge in edges) + 1 for card, edges in _EDGES.items()}
_CORNERS |= dict.fromkeys(("CQUAD4", "CQUADR", "CSHEAR"), 4) | dict.fromkeys(("CTRIA3", "CTRIAR"), 3)
_CORNERS |= dict.fromkeys(("CROD", "CBAR", "CBEAM"), 2)
_OFFSETS = {"CTRIA3": 6, "CQUAD4": 7, "CTRIA6": 9, "CQUAD8": 15}
"""The field, from that of the number on, that says how far a shell is off its nodes."""

_LEFT_OUT = {
    ("element", " without material (spring, damper or gap)"): re.compile(
        r"C(ELAS[1-4]|DAMP[1-5]|BUSH|BUSH1D|BUSH2D|GAP|VISC)"
    ),
    ("element", " of concentrated mass"): re.compile(r"CONM[12]|CMASS[1-4]"),
}
_FIRST_ORDER = {"CTRIA6": "CTRIA3", "CQUAD8": "CQUAD4"}  # a solid of first order has the name of one of second order


def begin_of(data: bytes) -> re.Match[bytes] | None:
    """Return the line BEGIN BULK, or what stands before the first card of a file of cards alone, as Gmsh writes it."""
    return _BEGIN.search(data) or _CARDS_ALONE.match(data)


def plain_bulk_data(data: bytes, elements: frozenset[bytes]) -> tuple[bytes, list[str]]:
    """Return the grid points and `elements` of bulk data without trailing comments, a line of free fields each.

    With them come notes on what was left out.
    """
    begin = begin_of(data)
    end = END.search(data, begin.end()) if begin else None
    assert begin is not None  # as the guards have found
    assert end is not None
    names = {name.decode() for name in elements}
    points: dict[str, tuple[str, ...]] = {}
    places: dict[str, tuple[float, ...]] = {}
    lines, cards = [], []
    left_out = dict.fromkeys(_LEFT_OUT, 0)
    offsets = 0
    for name, fields in cards_of(data[begin.end() : end.start()].decode("latin-1")):
        if name == "GRID":
            number = whole(f"GRID {shown(fields[0])}", fields[0])
            if len(fields) < 5:
                raise ReadError(f"its GRID {number} has two coordinates: the line that continues it is missing")
            system = whole(f"GRID {number}", fields[1] or "0")
            at = tuple(real(f"GRID {number}", field or "0.0") for field in fields[2:5])
            if once(f"GRID {number}", places, number, (*map(float, at), float(system))):
                points[number] = at
                lines.append(",".join([name, number, system, *at]))
        elif name in names:
            cards.append((name, fields))
            offset = "".join(fields[_OFFSETS[name] :][:1]) if name in _OFFSETS else ""
            offsets += bool(offset) and float(real(f"{name} {shown(fields[0])}", offset)) != 0
        for what, names_of in _LEFT_OUT.items():
            left_out[what] += names_of.fullmatch(name) is not None
    middles: dict[tuple[str, str], str] = {}
    elements_of = [
        (name, _wholes(name, fields, fields[:2]), _nodes(name, fields, points, middles)) for name, fields in cards
    ]
    for ends, number in middles.items():
        lines.append(",".join(["GRID", number, "0", *_middle(*(points[end] for end in ends))]))
    for name, head, nodes in elements_of:
        plain = _FIRST_ORDER.get(name, name) if len(nodes) == _CORNERS.get(name) else name
        lines.append(",".join([plain, *head, *nodes]))
    notes = [f"{plural(n, what)}{more} {was(n)} left out" for (what, more), n in left_out.items() if n]
    if offsets:
        notes.append(
            f"the offset of {plural(offsets, 'shell')} from {'its' if offsets == 1 else 'their'} nodes was left out"
        )
    return "\n".join(["BEGIN BULK", *lines, "ENDDATA", ""]).encode("latin-1"), notes


def _nodes(
    name: str, fields: list[str], points: dict[str, tuple[str, ...]], middles: dict[tuple[str, str], str]
) -> list[str]:
    """Return the nodes of an element, those in the middles of edges too; `middles` gives these numbers of their own."""
    rest = fields[2:]
    if name not in _CORNERS:
        return [field for field in rest if field]
    edges, count = _EDGES.get(name, ()), _CORNERS[name]
    while rest and not rest[-1]:
        del rest[-1]
    flat = name in _FIRST_ORDER or not edges  # angles and thicknesses may follow
    corners, sides, beyond = rest[:count], rest[count : count + len(edges)], rest[count + len(edges) :]
    if len(corners) < count or not all(corners) or (beyond and not flat):
        has = plural(len([field for field in rest if field]), "node")
        raise ReadError(
            f"its {name} {shown(fields[0])} has {has}: it needs {count} corners"
            + (f", and at most {len(edges)} nodes in the middles of its edges" if edges else "")
            + "; export the mesh again"
        )
    corners, sides = (_wholes(name, fields, some) for some in (corners, sides))
    unknown = next((node for node in (*corners, *sides) if node and node not in points), None)
    if unknown is not None:
        raise ReadError(
            f"its {name} {shown(fields[0])} names grid point {unknown}, which it does not have: export the mesh again",
            code="node_out_of_range",
        )
    if not any(sides):
        return corners
    for k, (a, b) in enumerate(edges):
        if k == len(sides):
            sides.append("")
        if not sides[k]:
            ends = corners[a], corners[b]
            highest = max(map(int, points), default=0) if not middles else int(next(reversed(middles.values())))
            sides[k] = middles.setdefault((min(ends), max(ends)), str(highest + 1))
    return [*corners, *sides]


def _wholes(name: str, fields: list[str], some: list[str]) -> list[str]:
    """Return some fields of a card as whole numbers, those that are blank as they are."""
    return [field and whole(f"{name} {shown(fields[0])}", field) for field in some]


def _middle(a: tuple[str, ...], b: tuple[str, ...]) -> list[str]:
    with localcontext() as context:
        context.prec = _DIGITS
        context.clear_traps()  # what leaves Decimal is not finite, as it is for float64
        return [str((Decimal(x) + Decimal(y)) / 2) for x, y in zip(a, b, strict=True)]


def once(what: str, places: dict[str, tuple[float, ...]], number: str, place: tuple[float, ...]) -> bool:
    """Take in where a point is, and say whether it is new; raise `ReadError` where it is elsewhere already."""
    new = number not in places
    if places.setdefault(number, place) != place:
        raise ReadError(f"it defines {what} twice, in two places: export it again")
    return new


def real(what: str, field: str) -> str:
    """Return a real number as every program writes it: the E of its exponent may be left out, or be a D."""
    match = _NUMBER.fullmatch(field)
    if match is None:
        raise ReadError(
            f"its {what} holds {shown(field)}, which is not a number: export the file again", code="not_a_number"
        )
    exponent = match[2] or match[3]
    return match[1] + (f"E{exponent}" if exponent else "")


def whole(what: str, field: str) -> str:
    """Return a whole number without zeros before it."""
    if not _WHOLE.fullmatch(field):
        raise ReadError(
            f"its {what} holds {shown(field)}, which is not a whole number: export the file again", code="not_a_number"
        )
    return str(int(field))
