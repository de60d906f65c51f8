"""Numbers and places in the XML of robots: attributes in SI, decimals as written, where a mesh's file lies."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree.ElementTree import Element

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown


def floats(text: str, count: int, what: str) -> list[float]:
    """Return `count` finite numbers separated by white space; `what` names them in the `ReadError`."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        raise ReadError(f"{what} is {shown(text)}: it must be numbers") from None
    if len(values) != count:
        raise ReadError(f"{what} is {shown(text)}: it must be {count} number{'s' if count > 1 else ''}")
    if not all(map(math.isfinite, values)):
        raise ReadError(f"{what} is {shown(text)}: it must be finite")
    return values


def attribute(element: Element | None, name: str, count: int, default: Sequence[float], what: str) -> Float:
    """Return the numbers in an attribute, (count,), or the default where it is not there."""
    text = None if element is None else element.get(name)
    return np.array(default if text is None else floats(text, count, f"{what}, {name}"), float)


def decimals(words: Iterable[str]) -> int | None:
    """Return how many places after the point the longest of some decimals has; None without any.

    >>> decimals(["0.025", "1e-05", "3"]), decimals([])
    (5, None)
    """
    return max((_decimals(word) for text in words for word in text.split()), default=None)


def _decimals(word: str) -> int:
    mantissa, _, exponent = word.lower().partition("e")
    return max(0, len(mantissa.partition(".")[2]) - int(exponent or 0))


def mesh_file(reference: str, folder: Path) -> Path:
    """Return the file that a robot's description means by a mesh's name.

    ``package://name/path`` is looked for in the folders above the description that are called `name`, contain one of
    that name, or are a package of any name; then in those of the environment's ROS_PACKAGE_PATH. ``model://`` alike.

    Where there is none, it is the first place that was looked at. Raises `ReadError` for what is no file's name.
    """
    scheme, _, rest = reference.partition("://")
    if not rest:
        places = [folder / reference]
    elif scheme == "file":
        places = [Path(unquote(urlsplit(reference).path))]
    elif scheme in ("package", "model"):
        package, _, path = rest.partition("/")
        above = [folder, *folder.parents]
        roots = [Path(root) for name in ("ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH") for root in _paths(name)]
        places = [parent / path for parent in above if parent.name == package]
        places += [root / package / path for root in (*above, *roots)]
        places += [parent / path for parent in above]
    else:
        raise ReadError(f"the mesh {shown(reference)} is not a file: name it by package://, file:// or a path")
    return next((place for place in places if _is_file(place)), places[0])


def _is_file(place: Path) -> bool:
    try:
        return place.is_file()
    except OSError:  # the name is too long
        return False


def _paths(name: str) -> list[str]:
    return [path for path in os.environ.get(name, "").split(os.pathsep) if path]
