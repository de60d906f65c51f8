"""A robot's file read by what its first element is: URDF, MJCF, SDFormat; USD; or a list of parts, CSV or TOML."""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from inertia.encoding import UTF_16
from inertia.errors import ReadError, UsageError, placed
from inertia.exchange.robots.links import Robot
from inertia.exchange.robots.mjcf import read_mjcf
from inertia.exchange.robots.sdf import read_sdf
from inertia.exchange.robots.table import read_csv, read_toml
from inertia.exchange.robots.text import is_file
from inertia.exchange.robots.urdf import read_urdf
from inertia.exchange.robots.usd import read_usd
from inertia.mesh.readers.contents import plural, shown, was
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import file_of, path_of, reason_of
from inertia.tables import has_column

READERS: dict[str, tuple[set[str], Callable[[Path], Robot]]] = {
    "urdf": ({"<robot"}, read_urdf),
    "mjcf": ({"<mujoco"}, read_mjcf),
    "sdf": ({"<sdf"}, read_sdf),
    "usd": ({".usd", ".usda", ".usdc", ".usdz"}, read_usd),
    "csv": ({".csv"}, read_csv),
    "toml": ({".toml"}, read_toml),
}
"""Format → the first element of its files, or the extensions of their names; and its reader."""

_BEGINNING = 65_536  # bytes that are searched for what a file is; licences stand at the top of many
_NO_ELEMENT = re.compile(rb"(?s)\xef\xbb\xbf|<!--.*?-->|<\?.*?\?>|<!DOCTYPE[^\[>]*(?:\[.*?\]\s*)?>")


def read_robot(path: str | Path) -> Robot:
    """Read the links of a robot, and what is stated of each; of ``-``, from standard input, with meshes in this folder.

    Raises `ReadError` where the file is missing, damaged or of another format.
    """
    path = path_of(path)
    try:
        with file_of(str(path)).open("rb") as file:
            beginning = file.read(_BEGINNING)
    except OSError as error:
        raise ReadError(f"cannot read {path}: {reason_of(error)}", code="no_file") from error
    if not beginning.removeprefix(BOM_UTF8).strip():
        raise ReadError(f"cannot read {path}: it is empty: export the robot again", code="empty_file")
    if UTF_16.match(beginning):
        raise ReadError(
            f"cannot read {path}: it is text in UTF-16, which no program for robots reads: save it as UTF-8",
            code="encoding",
        )
    kind = format_of(beginning, None if str(path) == STANDARD_INPUT else path.suffix.lower())
    if kind is not None:
        try:
            robot = READERS[kind][1](path)
            twice = [name for name, count in Counter(link.name for link in robot.links).items() if count > 1]
            if twice:
                raise ReadError(f"more than one link is called {shown(twice[0])}: give each a name of its own")
            return robot
        except (ReadError, UsageError) as error:
            raise placed(error, f"cannot read {path}") from None
    raise ReadError(
        f"cannot read {path}: it is no robot of a known format: name a file of {', '.join(READERS)}",
        code="unknown_format",
    )


def lost_by(robot: Robot, copy: Path) -> str:
    """Return what a copy of a robot's file lacks where it lies, in a sentence; "" where it lacks nothing.

    Files that are named from the folder of the robot's own are not found from another one.
    """
    if copy.absolute().parent == robot.path.absolute().parent:
        return ""
    try:
        lost = len(_meshes_of(robot) - _meshes_of(read_robot(copy)))
    except ReadError as error:
        return str(error)
    piped = str(robot.path) == STANDARD_INPUT
    place = "into the folder one stands in" if piped else f"beside {robot.path}"
    beside = f"write it {place}, from where they are named"
    return f"{plural(lost, 'mesh file')} {was(lost)} not found from there: {beside}" if lost else ""


def _meshes_of(robot: Robot) -> set[Path]:
    shapes = {geometry.shape for link in robot.links for geometry in link.geometries}
    return {shape.resolve() for shape in shapes if isinstance(shape, Path) and is_file(shape)}


def format_of(beginning: bytes, suffix: str | None = None) -> str | None:
    """Return the format of a file by its first element or by how its name ends; None where both tell nothing.

    Without the `suffix` of a name, as of standard input, the contents stand for it.
    """
    element = re.match(rb"\s*(<[\w.-]+)", _NO_ELEMENT.sub(b"", beginning))
    marks = {_suffix(beginning) if suffix is None else suffix, element[1].decode() if element else ""}
    return next((kind for kind, (known, _) in READERS.items() if known & marks), None)


def _suffix(beginning: bytes) -> str:
    """Return how the name of what came by standard input would end."""
    if beginning.startswith((b"#usda", b"PXR-USDC")):
        return ".usd"
    if beginning.startswith(b"PK\x03\x04"):  # of a package of USD, the first file is its stage
        named = beginning[30 : 30 + int.from_bytes(beginning[26:28], "little")]
        return ".usdz" if named.lower().endswith((b".usd", b".usda", b".usdc")) else ""
    text = beginning.removeprefix(BOM_UTF8).decode(errors="replace")
    if re.search(r"(?m)^\s*(\[\[\s*part\s*\]\]|part\s*=)", text):
        return ".toml"
    return ".csv" if has_column(text, "name") else ""
