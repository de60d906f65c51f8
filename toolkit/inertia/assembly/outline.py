"""The regions of a mesh or STEP file as the parts of an assembly, for its user to fill in."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from inertia.mesh.part import Part


def outline(part: Part, path: Path, folder: Path) -> dict[str, Any]:
    """Return an assembly laid out as its file is: a part for each region, where the file has it.

    Parameters
    ----------
    part : as read from `path`
    folder : that the file of the assembly will be in
    """
    file = relative(path, folder)
    unit = None if part.unit_from == "file" else part.unit.name
    names: Sequence[str] = part.regions.names if part.regions is not None else ()
    parts = [
        {"name": name, "file": file, "region": name} | ({"unit": unit} if unit else {}) for name in dict.fromkeys(names)
    ]
    alone = {"name": path.stem, "file": file} | ({"unit": unit} if unit else {})
    return {"schema": 1, "name": path.stem, "unit": part.unit.name, "part": parts or [alone]}


def relative(path: Path, folder: Path) -> str:
    """Return how a file in or beneath a folder names another; the whole path of one elsewhere."""
    whole, base = path.resolve(), folder.resolve()
    return whole.relative_to(base).as_posix() if whole.is_relative_to(base) else whole.as_posix()
