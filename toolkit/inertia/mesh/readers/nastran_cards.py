"""The lines of Nastran's bulk data, put together into cards.

A line that continues another has a name, behind + or * in its first field, and the line that it continues has that
name in its last field: the lines of a deck may stand in any order (sorted, merged, written by several programs). Names
are not always kept, so that a line whose name no other has continues the one before it, as one without a name does.
Source: MSC Nastran, "Quick Reference Guide", bulk data entries, continuations; NASTRAN-95, "User's Manual", 2.4.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown


class _Line(NamedTuple):
    """A line: its text and first field, its fields with data, and what names the line that continues it may have."""

    text: str
    first: str
    fields: list[str]
    next: tuple[str, ...]

    @property
    def continues(self) -> bool:
        return not self.first or self.first[0] in "+*"

    @property
    def own(self) -> str:
        """Its name as one that continues another; empty where it has none."""
        return self.first[1:].strip().upper()


def cards_of(text: str) -> Iterator[tuple[str, list[str]]]:
    """Yield the name of each card, without its asterisk, and its fields, at least 4."""
    lines = [_line(line) for line in text.splitlines() if line.strip() and not line.startswith(("$", "//", "#"))]
    follows = _follows(lines)
    for k, line in enumerate(lines):
        if line.continues:
            continue
        fields, at = line.fields, k
        while at in follows:
            at = follows.pop(at)
            fields = fields + lines[at].fields
        yield line.first.removesuffix("*").upper(), fields
    for k in follows.values():  # round in a circle
        raise _no_card(lines[k])


def _follows(lines: list[_Line]) -> dict[int, int]:
    """Return the place of each line that is continued → that of the line that continues it."""
    named: dict[str, list[int]] = {}
    for k, line in enumerate(lines):
        for name in line.next:
            named.setdefault(name, []).append(k)
    follows: dict[int, int] = {}
    for k, line in enumerate(lines):
        if not line.continues:
            if line.text[0].isspace():
                raise ReadError(f"its line {_shown(line)} begins with blanks: write its name in the first column")
            continue
        by_name = [] if k and line.own in lines[k - 1].next else [at for at in named.get(line.own, ()) if at != k]
        if len(by_name) > 1:
            raise ReadError(
                f"its line {_shown(line)} continues another by its name, which {len(by_name)} lines have as their "
                "last field: write it directly below the one that it continues"
            )
        above = by_name[0] if by_name else k - 1
        if above < 0:
            raise _no_card(line)
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
        following = text[72:80].strip()
    return _Line(text, first, rest + [""] * (count - len(rest)), _names(following.upper()))


def _is_large(first: str) -> bool:
    return first.startswith("*") or first.endswith("*")


def _names(last: str) -> tuple[str, ...]:
    """Return the names that the last field of a line stands for: its first character is a sign, or any other."""
    names = (last[1:],) if last.startswith(("+", "*")) else (last, last[1:])
    return tuple(name for name in dict.fromkeys(map(str.strip, names)) if name)


def _no_card(line: _Line) -> ReadError:
    return ReadError(f"its line {_shown(line)} continues no card: export the mesh again")


def _shown(line: _Line) -> str:
    return shown(line.text.strip())
