"""The unit that a comment at the beginning of a file names, in formats whose coordinates have none.

Exporters write ``# File units = inches`` into OBJ, ``comment units mm`` into PLY, or ``UNITS=MM`` into the header of a
binary STL. No format says that such words count: the unit stays the one that is stated or assumed.
"""

from __future__ import annotations

import re

from inertia.errors import UsageError
from inertia.mesh.readers.contents import shown
from inertia.units import Unit, length_unit

_COMMENTS = {  # how the line of a comment begins; `title` is a line of words that begins as it likes
    "stl": rb"solid\b",
    "obj": rb"#",
    "ply": rb"comment\b|obj_info\b",
    "off": rb"#",
    "xaml": rb"<!--",
    "vtk": rb"(?!# vtk)",
    "vtu": rb"<!--",
    "gmsh": rb"(?![$\d])",
    "nastran": rb"\$",
    "abaqus": rb"\*\*",
    "xdmf": rb"<!--",
    "medit": rb"#",
    "netgen": rb"#",
    "su2": rb"%",
    "avsucd": rb"#",
}
_HEADER = 80
"""Bytes of the words at the beginning of a binary STL file."""

_SAYS = re.compile(
    r"(?i)(?<![a-z])units?(?:\s+of\s+length|\s+used)?[\s_]*(?:[=:]|\b(?:is|are)\b|\bin\b(?=\s+\w))?"
    r"\s*(?:in\s+(?=\w)|1\s*)?[\"'(\[]?([a-zµ]+)"
)
_SAYS_PLAINLY = re.compile(r"(?i)(?<![a-z])units?\s*[=:]\s*[\"']?([a-zµ]+)")
"""In names, which may have the word for other reasons."""


def commented_unit(kind: str, head: bytes) -> tuple[Unit, str] | None:
    """Return the first unit of length that comments name in a file that begins so, and the comment, quoted.

    >>> commented_unit("obj", b"# File units = inches\\nv 0 0 0\\n")
    (Unit(name='in', metres=Fraction(127, 5000)), "'# File units = inches'")
    """
    if kind not in _COMMENTS or b"unit" not in head.lower():
        return None
    named = kind == "stl"
    is_binary = named and b"\0" in head
    for line in [head[:_HEADER]] if is_binary else head.splitlines():
        words = line.strip(b" \t\0")
        if is_binary or re.match(_COMMENTS[kind], words):
            text = words.decode("utf-8", "replace")
            for match in (_SAYS_PLAINLY if named else _SAYS).finditer(text):
                try:
                    return length_unit(match[1]), shown(text, 60)
                except UsageError:
                    continue
    return None
