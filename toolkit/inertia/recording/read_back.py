"""A recording → the scene that it was made from, to be run again."""

from __future__ import annotations

import os
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

from inertia.dynamics.scene.document import Scene, Settings
from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.recording.provenance import SETTINGS, source_sections
from inertia.recording.writer import require_rerun

_PROPERTIES = "/__properties"


def scene_of(file: str | os.PathLike[str]) -> Scene:
    """Return the scene of a recording, with the settings that it was run with.

    Parts and tables are looked for where they were, seen from the recording.

    Raises
    ------
    ReadError : the file is no recording of a run, its scene has a torque that only Python can give, or a file that it
        names is not there or not the same as then
    """
    name = os.fspath(file)
    held = properties(file)
    scene, settings = held.get("scene", {}), held.get("settings", {})
    if "folder" not in scene:
        raise ReadError(f"cannot read {name}: it is no recording of a run: `inertia simulate … -o {name}` makes one")
    if "text" not in scene:
        raise ReadError(
            f"cannot read {name}: its scene has a torque that was given in Python as a function or a table: simulate "
            "it from there"
        )
    folder = Path(name).resolve().parent / scene["folder"]
    found = Scene.loads(scene["text"], folder, name)
    for section, part in source_sections(found.body).items():
        _require_same_part(name, part, held.get(section, {}).get("sha256"))
    return replace(found, run=Settings(**{key: settings[key] for key in SETTINGS if key in settings}))


def properties(file: str | os.PathLike[str]) -> dict[str, dict[str, Any]]:
    """Return the properties of a recording by section, without reading the rest of it.

    Raises `ReadError` where the file is no recording or not whole.
    """
    name = os.fspath(file)
    if not Path(name).is_file():
        raise ReadError(f"cannot read {name}: there is no such file: check the path")
    require_rerun()
    from rerun.chunk import RrdReader
    from rerun.error_utils import RerunWarning

    held: dict[str, dict[str, Any]] = {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RerunWarning)  # it warns of a file that was cut short
            chunks = RrdReader(name).store().stream().filter(content=f"{_PROPERTIES}/**").to_chunks()
    except (RuntimeError, ValueError, OSError, RerunWarning) as error:
        raise ReadError(f"cannot read {name}: it is no whole Rerun recording: record it again") from error
    for chunk in chunks:
        section = held.setdefault(chunk.entity_path.removeprefix(f"{_PROPERTIES}/"), {})
        batch = chunk.to_record_batch()
        for key, column in zip(batch.schema.names, batch.columns, strict=True):
            if not key.startswith("rerun."):
                section[key] = column[0].as_py()[0]
    return held


def _require_same_part(name: str, part: Part, recorded: str | None) -> None:
    if recorded is None or part.source.sha256 == recorded:
        return
    raise ReadError(
        f"{name} was made from another {part.name}: its SHA-256 was {recorded[:12]}…, and is "
        f"{str(part.source.sha256)[:12]}…: bring the part back as it was, or simulate the scene anew"
    )
