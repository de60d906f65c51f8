"""Abaqus input: its nodes, elements and sets of elements, laid out as meshio reads them without loss.

meshio takes a comment within a table for its end, knows few of the names that elements of one layout have, gives the
set that a table of elements names to another table, takes the second of three nodes of a rod, which is its middle, for
its end, and reads no set of elements and other sets. What places, moves or makes nodes by a rule, or takes them from
elsewhere, is refused. Source: Dassault Systèmes, "Abaqus Keywords Guide", *NODE, *ELEMENT, *ELSET, *PART, *INSTANCE,
"Input Syntax Rules", labels, and "Abaqus Elements Guide", index and beams; G. Dhondt, "CalculiX USER'S MANUAL", B32.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Int
from inertia.errors import ReadError
from inertia.mesh.readers.contents import plural, shown
from inertia.mesh.readers.nastran import once, real, whole

_REFUSED = (
    *("INCLUDE", "IMPORT", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM"),
    *("IMPERFECTION", "SYMMETRIC MODEL GENERATION"),
)
_SCOPES = ("PART", "ASSEMBLY", "INSTANCE")
_ENDS = {"END PART": "", "END ASSEMBLY": "", "END INSTANCE": "ASSEMBLY"}
"""What ends a part, an assembly or an instance → what goes on behind it."""

_KEPT = ("NODE", "ELEMENT", "ELSET", *_SCOPES, *_ENDS)
_TYPES = {
    "T3D2": (2, r"T[23]D2H?|B[23][13]H?"),
    "T3D3": (3, r"T[23]D3H?|B[23]2H?"),
    "S3": (3, r"(S3|CPS3|CPE3)[A-Z]*|STRI3|R3D3|M3D3"),
    "S4": (4, r"(S4|CPS4|CPE4)[A-Z]*|S4R5|R3D4|M3D4R?"),
    "STRI65": (6, r"(CPS6|CPE6)[A-Z]*|STRI65|S6|M3D6"),
    "S8R": (8, r"(S8|CPS8|CPE8)[A-Z]*|S8R5|M3D8R?"),
    "S9R5": (9, r"S9R5|M3D9R?"),
    "C3D4": (4, r"D?C3D4[A-Z]*"),
    "C3D6": (6, r"(D?C3D6|SC6)[A-Z]*"),
    "C3D8": (8, r"(D?C3D8|SC8)[A-Z]*"),
    "C3D10": (10, r"D?C3D10[A-Z]*"),
    "C3D15": (15, r"D?C3D15[A-UW-Z]*"),  # those with V have nodes in their faces
    "C3D20": (20, r"D?C3D20[A-Z]*"),
}
"""Type that meshio knows → how many nodes it has, and all types that have them in the same order."""

_MIDDLE_SECOND = "T3D3"
"""The type whose nodes are end, middle, end; meshio takes them for end, end, middle."""

_MOST_FIELDS = 7  # of a node: its number, where it is, and a normal

_BETWEEN = 0.249, 0.751
"""Where the middle of a rod may be, as a share of the way from end to end: beyond a quarter the curve through the three
nodes, whose parameter is 1/2 at the middle, turns back at an end."""

Table = tuple[str, dict[str, str], list[list[str]]]
"""A keyword, its options, and the fields of each line below it."""

Places = dict[str, tuple[float, ...]]
"""Number of a node → where it is, (3,)."""


def plain_input(data: bytes) -> bytes:
    """Return the nodes, elements and sets of elements of an input file, without comments, a line each."""
    tables = list(_of_the_part(data))
    places: Places = {}
    lines = ["*NODE"]
    for keyword, _, rows in tables:
        if keyword == "NODE":
            lines += _nodes(rows, places)
    numbers: list[str] = []
    sets: dict[str, list[str]] = {}
    names: dict[str, str] = {}
    for keyword, options, rows in tables:
        name = options.get("ELSET", "")
        names.setdefault(_label(name), name)
        if keyword == "ELEMENT":
            table = _elements(options.get("TYPE", ""), rows, places)
            lines += table
            own = [row.partition(",")[0] for row in table[1:]]
            numbers += own
            sets.setdefault(_label(name), []).extend(own)
    known = np.array(numbers, np.int64)
    for keyword, options, rows in tables:
        if keyword == "ELSET":
            own = [each for row in rows for each in (_range(row, known) if "GENERATE" in options else row) if each]
            sets.setdefault(_label(options.get("ELSET", "")), []).extend(own)
    sets.pop("", None)
    for label in sets:
        if members := _members(label, sets):
            lines += [f"*ELSET, ELSET={names[label]}", *members]
    return "\n".join([*lines, ""]).encode()


def _of_the_part(data: bytes) -> Iterator[Table]:
    """Yield the tables of the one part; nodes of the assembly's own, which are reference points, are left out."""
    scope, parts, instances = "", dict[str, None](), 0
    for keyword, options, rows in _tables(data):
        if keyword in _ENDS:
            scope = _ENDS[keyword]
        elif keyword in _SCOPES:
            scope = f"{keyword} {options.get('NAME', '')}" if keyword != "ASSEMBLY" else keyword
            instances += keyword == "INSTANCE"
            moves = (float(real("*INSTANCE", field or "0")) for row in rows[:1] for field in row)
            if keyword == "INSTANCE" and (any(moves) or len(rows) > 1):  # the second line turns it
                raise ReadError(
                    "its *INSTANCE moves the part, which is not read: export the part by itself", code="not_read"
                )
        elif scope == "ASSEMBLY" and keyword == "ELEMENT":
            raise ReadError(
                "its *ASSEMBLY has elements of its own, which are not read: export one part by itself", code="not_read"
            )
        elif scope != "ASSEMBLY" or keyword != "NODE":
            if keyword == "NODE" and rows:
                parts[f"*{scope}" if scope else "no part"] = None
            yield keyword, options, rows
    if len(parts) > 1 or instances > 1:
        raise ReadError(
            f"it has {plural(instances, 'instance')}, and nodes in {' and '.join(parts)}, but one part is read, and "
            "one instance of it: export one part by itself",
            code="not_read",
        )


def _label(name: str) -> str:
    """Return the label that a name is: upper and lower case and blanks are one, unless it is quoted."""
    return name if name.startswith('"') else "".join(name.split()).upper()


def _members(label: str, sets: dict[str, list[str]]) -> list[str]:
    """Return the elements of a set, which may be listed by the names of other sets."""
    members: dict[str, None] = {}
    waiting, known = [label], {label}
    while waiting:
        for field in sets[waiting.pop()]:
            if field.isdigit():
                members[whole("a set", field)] = None
            elif (other := _label(field)) not in sets:
                raise ReadError(f"its set {shown(label)} lists {shown(field)}, which is no set: export it again")
            elif other not in known:
                known.add(other)
                waiting.append(other)
    return [*members]


def _tables(data: bytes) -> Iterator[Table]:
    """Yield each keyword that counts, its options, and the fields of each line below it."""
    stripped = (line.strip() for line in data.splitlines())
    lines = [line.decode("utf-8", "replace") for line in stripped if line and not line.startswith(b"**")]
    at = 0
    while at < len(lines):
        head = lines[at]
        at += 1
        while head.startswith("*") and head.endswith(",") and at < len(lines) and not lines[at].startswith("*"):
            head, at = head + lines[at], at + 1
        first, *rest = head.split(",")
        keyword = " ".join(first.replace("*", "").upper().split()) if head.startswith("*") else ""
        options = {name.strip().upper(): value.strip() for name, _, value in (each.partition("=") for each in rest)}
        names = [name for name in ("INPUT", "SYSTEM") if name in options and keyword in ("NODE", "ELEMENT")]
        if keyword in _REFUSED or names:
            raise ReadError(
                f"its keyword {shown(', '.join([f'*{keyword}', *names]))} is not read: write nodes and elements out in "
                "full",
                code="not_read",
            )
        rows: list[list[str]] = []
        while at < len(lines) and not lines[at].startswith("*"):
            if keyword in _KEPT:
                rows.append([field.strip() for field in lines[at].split(",")])
            at += 1
        if keyword in _KEPT:
            yield keyword, options, rows


def _nodes(rows: list[list[str]], places: Places) -> Iterator[str]:
    """Yield nodes that are not in `places`, and take them in; a coordinate that is left out is 0.

    Behind the coordinates a normal may stand.
    """
    for row in rows:
        fields = row if row[-1] else row[:-1]
        if len(fields) > _MOST_FIELDS:
            raise ReadError(
                f"its node {shown(row[0])} has {len(fields) - 1} numbers, but a place and a normal have 6: it is "
                "damaged, export it again"
            )
        number = whole("a node", row[0])
        place = [real(f"node {number}", field or "0") for field in (*fields[1:4], "", "", "")[:3]]
        if once(f"node {number}", places, number, tuple(map(float, place))):
            yield ",".join([number, *place])


def _elements(kind: str, rows: list[list[str]], places: Places) -> list[str]:
    """Return a table of elements, one a line, under the name that meshio has for their type."""
    alike = (item for item in _TYPES.items() if re.fullmatch(item[1][1], kind.upper()))
    name, (count, _) = next(alike, ("", (0, "")))
    if not name:
        raise ReadError(
            f"its elements of the type {shown(kind)} are not read: use solids, C3D4 to C3D20, shells, S3 to S9R5, or "
            "rods, and leave out the others",
            code="not_read",
        )
    lines = [f"*ELEMENT, TYPE={name}"]
    fields: list[str] = []
    for k, row in enumerate(rows, 1):
        fields += row if row[-1] else row[:-1]
        if not row[-1] and len(fields) <= count and k < len(rows):  # the next line continues it
            continue
        if len(fields) != count + 1 or not all(fields):
            raise ReadError(
                f"its elements lack nodes, or have different numbers of them, as element {shown(row[0])}, which needs "
                f"{count}: it was cut short or damaged",
                code="cut_short",
            )
        element = [whole(f"element {shown(fields[0])}", field) for field in fields]
        lines.append(",".join(_ends_first(element, places) if name == _MIDDLE_SECOND else element))
        fields = []
    return lines


def _ends_first(element: list[str], places: Places) -> list[str]:
    """Return a rod of three nodes with the middle one as the last; raise `ReadError` where it is not between the ends.

    Some programs write the middle node as the last.
    """
    number, *nodes = element
    if all(node in places for node in nodes):
        start, middle, end = (np.array(places[node]) for node in nodes)
        with np.errstate(all="ignore"):
            share = (middle - start) @ (end - start) / ((end - start) @ (end - start))
        if share < _BETWEEN[0] or share > _BETWEEN[1]:
            raise ReadError(
                f"the second of the three nodes of its element {number} is not in the middle between the others: give "
                "the nodes as end, middle, end"
            )
    return [number, nodes[0], nodes[2], nodes[1]]


def _range(row: list[str], known: Int) -> list[str]:
    """Return the elements from the first to the last that a line names, by steps of its third number or of 1."""
    first, last, step = (int(whole("a set", field)) for field in ([each for each in row if each] + ["1"])[:3])
    if not step or last > known.max(initial=0):
        raise ReadError(f"a set in it runs from {first} to {last}, beyond its elements: export it again")
    chosen: list[int] = known[(known >= first) & (known <= last) & ((known - first) % step == 0)].tolist()
    return list(map(str, chosen))
