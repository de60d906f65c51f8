"""XML of robots: its elements, numbers, decimals as written, and where a mesh's file lies.

Text that is no XML is read where the parser of the programs that own these formats reads it (TinyXML2, as urdfdom,
Bullet, MuJoCo and Drake have it; tried with each).
"""

from __future__ import annotations

import codecs
import math
import os
import re
from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree.ElementTree import Element

from inertia.errors import ReadError
from inertia.exchange.robots.links import Figures
from inertia.mesh.readers.contents import shown
from inertia.mesh.readers.decimals import written
from inertia.mesh.readers.trimesh import parse_xml
from inertia.output import note_input

_PREAMBLE = re.compile(r"(?:\s*<\?.*?\?>)*\s*", re.DOTALL)
_PASSED_OVER = re.compile(r"<!--.*?-->|<!DOCTYPE[^>]*>|[\x01-\x08\x0b\x0c\x0e-\x1f]", re.DOTALL)
_NO_ENTITY = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#\d+|#x[0-9a-fA-F]+);)")
_PREFIX = re.compile(r"""(</?|\s)([\w.-]+):(?=[\w.-]+(?:\s*=\s*["']|[\s/>]))""")
_VALUE = re.compile(r"""=\s*("[^"]*"|'[^']*')""")
_DECIMAL = re.compile(r"[+-]?(?=\.?\d)(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d+))?", re.ASCII)
_LOST = 1e-9  # of the largest number: what is smaller is what computing zero left
_MOST_DECIMALS = 1e6  # more than any float64 has; an exponent may have more digits than an int is read from
_CALLED = {"package": "package.xml", "model": "model.config"}  # the files that say what a folder is called
_FIRST = re.compile(r"<([\w.-]+)")
_SEARCHED = (
    ("ROS_PACKAGE_PATH", ""),
    ("AMENT_PREFIX_PATH", "share"),
    ("GZ_SIM_RESOURCE_PATH", ""),
    ("GAZEBO_MODEL_PATH", ""),
    ("SDF_PATH", ""),
)
"""Variables of the environment that list folders with packages, as ROS, ROS 2, Gazebo and SDFormat have them; and where
in these the packages lie."""


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


def figures(words: Iterable[str]) -> Figures | None:
    """Return how many decimals and digits those of some numbers have that have most; None without any number.

    Zeros, and what is lost beside the largest, count only where there is nothing else.

    >>> figures(["0.025", "1e-05 3"]), figures(["0.3333", "1e-20", "0.000000"]), figures(["0", "0.0"]), figures([])
    (Figures(decimals=5, digits=2), Figures(decimals=4, digits=4), Figures(decimals=1, digits=0), None)
    """
    numerals = [numeral for text in words for word in text.split() if (numeral := _DECIMAL.match(word)) is not None]
    sizes = [abs(float(numeral[0])) for numeral in numerals]
    telling = [numeral for numeral, size in zip(numerals, sizes, strict=True) if size > _LOST * max(sizes)] or numerals
    if not telling:
        return None
    return Figures(max(map(_decimals, telling)), max(map(_digits, telling)))


def _decimals(numeral: re.Match[str]) -> int:
    exponent = min(max(float(numeral[3] or 0), -_MOST_DECIMALS), _MOST_DECIMALS)
    return max(0, len(numeral[2] or "") - int(exponent))


def _digits(numeral: re.Match[str]) -> int:
    return len((numeral[1] + (numeral[2] or "")).lstrip("0"))


def mesh_file(reference: str, folder: Path, notes: dict[str, None] | None = None) -> Path:
    """Return the file that a robot's description means by a mesh's name.

    ``package://name/path`` and ``model://name/path`` are looked for in the folders above the description that are
    called `name`, or whose package.xml or model.config says that they are, then in those beside them, then where the
    environment says (`_SEARCHED`). Of what is in none of these places, a file in the folders above is taken, with a
    note in `notes`, up to one that has a name there: another package may have a file of the same name.

    What is not there is returned where it would be. Raises `ReadError` for what is no file's name, and for a package
    that is nowhere.
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
        path, folder = path.lstrip("/"), folder.absolute()  # as it is named, it may have no parents
        roots = list(_packages(package, folder)) if package else []
        if notes is not None and not any(root == folder or root in folder.parents for root in roots):
            found = any(is_file(root / path) for root in roots)
            nameless = [root for root in _nameless(folder) if not found and is_file(root / path)][:1]
            words = f"no folder or {_CALLED[scheme]} is called {shown(package)}: its files are taken from"
            notes |= dict.fromkeys(f"{words} {root}" for root in nameless)
            roots = nameless or roots
        if not roots:
            variable = "ROS_PACKAGE_PATH" if scheme == "package" else "GZ_SIM_RESOURCE_PATH"
            raise ReadError(
                f"there is no {scheme} {shown(package)} above the file, beside it or in the folders of {variable}: "
                "name the one that holds it there",
                code="no_file",
            )
        places = [root / path for root in roots]
    else:
        raise ReadError(f"the mesh {shown(reference)} is not a file: name it by package://, file:// or a path")
    file = next((place for place in places if is_file(place)), places[0])
    note_input(file)
    return file


def file_name(reference: str) -> str:
    """Return what the file of a mesh is called, wherever it lies; "" where nothing is named."""
    return reference.rpartition("/")[2].strip()


def _packages(name: str, folder: Path) -> Iterator[Path]:
    """Yield the folders that are the package of a name for a description in a folder."""
    above = [folder, *folder.parents]
    yield from (parent for parent in above if parent.name == name or _package_name(parent) == name)
    roots = [Path(root) / below for variable, below in _SEARCHED for root in _paths(variable)]
    yield from (root for root in roots if root.name == name)
    yield from (place for root in (*above, *roots) if _is_folder(place := root / name))


def _nameless(folder: Path) -> Iterator[Path]:
    """Yield a folder and those above it that may be a package of any name, as no package.xml says which."""
    for parent in (folder, *folder.parents):
        if _package_name(parent):
            return
        yield parent


def _package_name(folder: Path) -> str:
    """Return what a folder's package.xml, or Gazebo's model.config, calls it; "" where it has none that says so."""
    for file in (folder / name for name in _CALLED.values()):
        try:
            name = parse_xml(file.read_bytes()).findtext("name", "").strip() if is_file(file) else ""
        except (OSError, ReadError):
            continue
        if name:
            return name
    return ""


def _is_folder(place: Path) -> bool:
    try:
        return place.is_dir()
    except OSError:
        return False


def is_file(place: Path) -> bool:
    """Whether there is a file; there is none whose name is too long."""
    try:
        return place.is_file()
    except OSError:
        return False


def _paths(name: str) -> list[str]:
    return [path for path in os.environ.get(name, "").split(os.pathsep) if path]
