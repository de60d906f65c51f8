"""The lines of Nastran's bulk data, put together into cards.

A line that continues another has a name, behind + or * in its first field, and the line that it continues has that
name in its last field: the lines of a deck may stand in any order (sorted, merged, written by several programs). Names
are not always kept, so that a line whose name no other has continues the one before it, as one without a name does; and
what stands in columns 73 to 80 may be no name at all, but the number of the line.
Source: MSC Nastran, "Quick Reference Guide", bulk data entries, continuations; NASTRAN-95, "User's Manual", 2.4.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown


class _Line(NamedTuple):
    """A line: its text and first field, its fields with data, and the last one."""

    text: str
    first: str
    fields: list[str]
    last: str

    @property
    def continues(self) -> bool:
        return not self.first or self.first[0] in "+*"

    @property
    def own(self) -> str:
        """Its name as one that continues another; empty where it has none."""
        return self.first[1:].strip().upper()

    @property
    def names(self) -> tuple[str, ...]:
        """The names that its last field stands for: its first character is a sign, or any other, or part of it."""
        names = (self.last[1:],) if self.is_signed else (self.last, self.last[1:])
        return tuple(name for name in dict.fromkeys(map(str.strip, names)) if name)

    @property
    def is_signed(self) -> bool:
        """Whether its last field begins as that of the line that continues it does."""
        return self.last.startswith(("+", "*"))

    @property
    def names_another(self) -> bool:
        """Whether that may be a line anywhere: no point goes on, and the numbers of lines stand at the right."""
        return self.first.upper() != "GRID" and not self.last.startswith(" ")

    @property
    def may_go_on(self) -> bool:
        """Whether it may be continued without saying so: nothing is in its last field, and something in all others."""
        return not self.last and bool(self.fields[-1])


def cards_of(text: str) -> Iterator[tuple[str, list[str]]]:
    """Yield the name of each card, without its asterisk, and its fields, at least 4."""
    lines = [_line(line) for line in text.splitlines() if line.strip() and not line.startswith(("$", "//", "#"))]
    follows = _follows(lines)
    for k, line in enumerate(lines):
        if line.continues:
            continue
        fields, at = line.fields.copy(), k
        while at in follows:
            at = follows.pop(at)
            fields += lines[at].fields
        yield line.first.removesuffix("*").upper(), fields
    for k in follows.values():  # round in a circle
        raise _no_card(lines[k])


def _follows(lines: list[_Line]) -> dict[int, int]:
    """Return the place of each line that is continued → that of the line that continues it."""
    follows = {
        k: k + 1 for k, (line, below) in enumerate(pairwise(lines)) if below.continues and below.own in line.names
    }
    settled = set(follows.values())
    named: dict[str, list[int]] = {}
    for k, line in enumerate(lines):
        if k not in follows and line.names_another:
            for name in line.names:
                named.setdefault(name, []).append(k)
    for k, line in enumerate(lines):
        if not line.continues:
            if line.text[0].isspace():
                raise ReadError(f"its line {_shown(line)} begins with blanks: write its name in the first column")
            continue
        if k in settled:
            continue
        below_one = k > 0 and k - 1 not in follows and lines[k - 1].may_go_on
        by_name = [at for at in named.get(line.own, ()) if at != k and (lines[at].is_signed or not below_one)]
        if len(by_name) > 1:
            raise ReadError(
                f"its line {_shown(line)} continues another by its name, which {len(by_name)} lines have as their "
                "last field: write it directly below the one that it continues"
            )
        above = by_name[0] if by_name else k - 1
        if above < 0:
            raise _no_card(line)
        if by_name and below_one and above != k - 1:
            raise ReadError(
                f"its line {_shown(line)} may continue {_shown(lines[k - 1])}, below which it stands, or "
                f"{_shown(lines[above])}, which has its name: write names, or none, at the end of both"
            )
        if above in follows:
            raise ReadError(
                f"its lines {_shown(lines[follows[above]])} and {_shown(line)} both continue {_shown(lines[above])}: "
                "give each line that is continued a name of its own, or write what continues it directly below"
            )
        follows[above] = k
    return follows


def _line(text: str) -> _Line:
    """Return a line; its fields are blank where it is too short for them."""
    if "," in text:
        first, *rest = (field.strip() for field in text.split(","))
        count = 4 if _is_large(first) else 8
        following = ""
        if len(rest) == count + 1 and (not rest[-1] or rest[-1][0] in "+*"):
            following = rest.pop()
    else:
        text = text.expandtabs(8)
        first = text[:8].strip()
        count, width = (4, 16) if _is_large(first) else (8, 8)
        rest = [text[8 + width * k : 8 + width * (k + 1)].strip() for k in range(count)]
        following = text[72:80].rstrip()
    return _Line(text, first, rest + [""] * (count - len(rest)), following.upper())


def _is_large(first: str) -> bool:
    return first.startswith("*") or first.endswith("*")


def _no_card(line: _Line) -> ReadError:
    return ReadError(f"its line {_shown(line)} continues no card: export the mesh again")


def _shown(line: _Line) -> str:
    return shown(line.text.strip())
