"""XML of robots: its elements, numbers, decimals as written, and where a mesh's file lies.

Text that is no XML is read where the parser of the programs that own these formats reads it (TinyXML2, as urdfdom,
Bullet, MuJoCo and Drake have it; tried with each).
"""

from __future__ import annotations

import codecs
import math
import os
import re
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree.ElementTree import Element

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown
from inertia.mesh.readers.decimals import written
from inertia.mesh.readers.trimesh import parse_xml
from inertia.output import note_input

_PREAMBLE = re.compile(r"(?:\s*<\?.*?\?>)*\s*", re.DOTALL)
_PASSED_OVER = re.compile(r"<!--.*?-->|<!DOCTYPE[^>]*>|[\x01-\x08\x0b\x0c\x0e-\x1f]", re.DOTALL)
_NO_ENTITY = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#\d+|#x[0-9a-fA-F]+);)")
_PREFIX = re.compile(r"""(</?|\s)([\w.-]+):(?=[\w.-]+(?:\s*=\s*["']|[\s/>]))""")
_VALUE = re.compile(r"""=\s*("[^"]*"|'[^']*')""")
_DECIMAL = re.compile(r"[+-]?\d*(?:\.(\d*))?(?:[eE]([+-]?\d+))?", re.ASCII)
_MOST_DECIMALS = 1e6  # more than any float64 has; an exponent may have more digits than an int is read from
_FIRST = re.compile(r"<([\w.-]+)")


def robot_xml(data: bytes) -> tuple[Element, tuple[str, ...]]:
    """Return the root of a robot's XML text, and a note where it is none but is read as TinyXML2 reads it.

    That passes over what XML forbids: ``--`` in a comment, control characters, a bare ``&``, ``<`` in an attribute,
    names with an undeclared prefix, bytes of another encoding, a document type, whatever follows the first element.
    Raises `ReadError` for what it refuses as well.
    """
    try:
        return parse_xml(data.lstrip()), ()
    except ReadError as error:
        text = _as_tinyxml(data)
        if "<?xml" in text:
            words = "something stands before its XML declaration, and programs for robots refuse that: take it away"
            raise ReadError(words) from None
        try:
            root = parse_xml(text.encode())
        except ReadError:
            raise error from None
        fault = str(error).rpartition(": ")[0] or str(error)
        return root, (f"{fault}: it is read as programs for robots read it, whose parser passes over that",)


def _as_tinyxml(data: bytes) -> str:
    """Return a text as XML where TinyXML2 takes it for such."""
    data = data.removeprefix(codecs.BOM_UTF8).partition(b"\0")[0]
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    text = _PASSED_OVER.sub("", text[_PREAMBLE.match(text).end() :])  # type: ignore[union-attr]
    text = _VALUE.sub(lambda value: value[0].replace("<", "&lt;"), _NO_ENTITY.sub("&amp;", text))
    text = _PREFIX.sub(r"\1\2.", text)
    if first := _FIRST.search(text):
        end = re.compile(rf"</{re.escape(first[1])}\s*>").search(text)
        if end is not None and text[end.end() :].lstrip().startswith("<"):
            return text[: end.end()]
    return text


def floats(text: str, count: int, what: str) -> list[float]:
    """Return `count` finite numbers separated by white space; `what` names them in the `ReadError`."""
    try:
        if "_" in text or not text.isascii():  # 1_000 and digits of other scripts are numbers to Python alone
            raise ValueError
        values = [float(word) for word in text.split()]
    except ValueError:
        raise ReadError(f"{what} is {shown(text)}: it must be numbers", code="not_a_number") from None
    if len(values) != count:
        raise ReadError(f"{what} is {shown(text)}: it must be {count} number{'s' if count > 1 else ''}")
    if not all(map(math.isfinite, values)):
        raise ReadError(f"{what} is {shown(text)}: it must be finite", code="non_finite")
    return values


def scales(text: str, what: str) -> tuple[Fraction, Fraction, Fraction]:
    """Return what a mesh is multiplied by along x, y and z, as it is written; `what` names the mesh."""
    floats(text, 3, f"{what}, scale")
    x, y, z = map(written, text.split())
    return x, y, z


def decimals(words: Iterable[str]) -> int | None:
    """Return how many places after the point the longest of some decimals has; None without any.

    >>> decimals(["0.025", "1e-05", "3"]), decimals([])
    (5, None)
    """
    return max((_decimals(word) for text in words for word in text.split()), default=None)


def _decimals(word: str) -> int:
    parts = _DECIMAL.match(word)  # what follows a number was passed over
    if parts is None:
        return 0
    exponent = min(max(float(parts[2] or 0), -_MOST_DECIMALS), _MOST_DECIMALS)
    return max(0, len(parts[1] or "") - int(exponent))


def mesh_file(reference: str, folder: Path) -> Path:
    """Return the file that a robot's description means by a mesh's name.

    ``package://name/path`` is looked for in the folders above the description that are called `name`, contain one of
    that name, or are a package of any name; then in those of the environment's ROS_PACKAGE_PATH. ``model://`` alike.

    Where there is none, it is the first place that was looked at. Raises `ReadError` for what is no file's name.
    """
    if not reference.strip():
        raise ReadError("the mesh has no file name: name it by package://, file:// or a path")
    scheme, _, rest = reference.partition("://")
    if not rest:
        places = [folder / reference]
    elif scheme == "file":
        try:
            places = [Path(unquote(urlsplit(reference).path))]
        except ValueError:  # of what looks like a host
            raise ReadError(f"the mesh {shown(reference)} is not a file: write file:///path") from None
    elif scheme in ("package", "model"):
        package, _, path = rest.partition("/")
        folder = folder.absolute()  # as it is named, it may have no parents
        above = [folder, *folder.parents]
        roots = [Path(root) for name in ("ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH") for root in _paths(name)]
        places = [parent / path for parent in above if parent.name == package]
        places += [root / package / path for root in (*above, *roots)]
        places += [parent / path for parent in above]
    else:
        raise ReadError(f"the mesh {shown(reference)} is not a file: name it by package://, file:// or a path")
    file = next((place for place in places if is_file(place)), places[0])
    note_input(file)
    return file


def is_file(place: Path) -> bool:
    """Whether there is a file; there is none whose name is too long."""
    try:
        return place.is_file()
    except OSError:
        return False


def _paths(name: str) -> list[str]:
    return [path for path in os.environ.get(name, "").split(os.pathsep) if path]
