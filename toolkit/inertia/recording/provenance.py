"""Properties of a recording: what made it, of what, how accurately; and the scene read back, to be run again."""

from __future__ import annotations

import contextlib
import os
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

from inertia import __version__
from inertia.balancing.balance import Balance
from inertia.dynamics.run import Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings
from inertia.errors import ReadError, visible
from inertia.mesh.part import Part

_SETTINGS = ("duration", "samples", "accuracy", "model", "method")
_PROPERTIES = "/__properties"


def properties_of(subject: Run | Balance, file: Path | None) -> dict[str, dict[str, Any]]:
    """Return the properties by section; paths are relative to the folder of `file`."""
    tool = {"tool": {"name": "inertia", "version": __version__}}
    return tool | (_of_balance(subject, file) if isinstance(subject, Balance) else _of_run(subject, file))


def _of_run(run: Run, file: Path | None) -> dict[str, dict[str, Any]]:
    scene = run.scene
    return {
        "scene": {"name": visible(scene.name), "text": scene.source_text, "folder": _folder(scene.name, file)},
        "settings": {name: getattr(scene.run, name) for name in _SETTINGS},
        **{name: _source(part) for name, part in _source_sections(scene.body).items()},
        "accuracy": {
            "model": run.model,
            "method": run.error.method,
            "requested_rad": run.error.requested,
            "reached_rad": run.error.reached,
        },
    }


def _of_balance(balance: Balance, file: Path | None) -> dict[str, dict[str, Any]]:
    rotor, error = balance.rotor, balance.properties.error
    return {
        "rotor": {"name": visible(rotor.name), "text": rotor.to_toml(), "folder": _folder(rotor.name, file)},
        **{name: _source(part) for name, part in _numbered([body.whole for body in balance.bodies]).items()},
        "accuracy": {"method": error.method, "mass": error.mass, "inertia": error.inertia},
        "verdict": {"outcome": balance.verdict.outcome},
    }


def _source_sections(body: SceneBody) -> dict[str, Part]:
    """Return the parts of a body that have a mesh, by the section that says where it came from."""
    return _numbered([part for part in (body.part, *body.meshes) if part is not None])


def _numbered(parts: list[Part]) -> dict[str, Part]:
    return {"source" if k == 1 else f"source_{k}": part for k, part in enumerate(parts, 1)}


def _source(part: Part) -> dict[str, Any]:
    source = part.source
    return {
        "path": source.path and visible(source.path),
        "format": source.format,
        "unit": part.unit.name,
        "sha256": source.sha256,
        "files": _files(part),
    }


def _files(part: Part) -> str | None:
    """Return the files that the part's file refers to, as `sha256sum` lists them."""
    return "\n".join(f"{digest}  {visible(name)}" for name, digest in part.source.files.items()) or None


def _folder(name: str, file: Path | None) -> str:
    """Return where the files are that a scene or a rotor of this name refers to."""
    folder = str(Path(name).resolve().parent)
    if file is not None:
        with contextlib.suppress(ValueError):  # on another drive
            folder = os.path.relpath(folder, file.resolve().parent)
    return folder.encode("utf-8", "replace").decode()


def scene_of(file: str | os.PathLike[str]) -> Scene:
    """Return the scene of a recording, with the settings that it was run with.

    Parts and tables are looked for where they were, seen from the recording.

    Raises
    ------
    ReadError : the file is no recording of a run, its scene has a torque that only Python can give, or a file that it
        names is not there or not the same as then
    """
    name = os.fspath(file)
    sections = properties(file)
    table, settings = sections.get("scene", {}), sections.get("settings", {})
    if "folder" not in table:
        raise ReadError(f"cannot read {name}: it is no recording of a run: simulate its scene and record that")
    if "text" not in table:
        raise ReadError(
            f"cannot read {name}: its scene has a torque that was given in Python as a function or a table: simulate "
            "it from there"
        )
    folder = Path(name).resolve().parent / table["folder"]
    scene = Scene.loads(table["text"], folder, name)
    for section, part in _source_sections(scene.body).items():
        recorded = sections.get(section, {})
        _require_same_part(name, part, recorded.get("sha256"))
        if recorded.get("files") not in (None, _files(part)):
            raise ReadError(
                f"{name} was made when {part.name} referred to other files, or they held something else: bring them "
                "back as they were, or simulate the scene anew"
            )
    return replace(scene, run=Settings(**{key: settings[key] for key in _SETTINGS if key in settings}))


def properties(file: str | os.PathLike[str]) -> dict[str, dict[str, Any]]:
    """Return the properties of a recording by section, without reading the rest of it.

    Raises `ReadError` where the file is no recording or not whole.
    """
    name = os.fspath(file)
    if not Path(name).is_file():
        raise ReadError(f"cannot read {name}: there is no such file: check the path")
    from rerun.chunk import RrdReader
    from rerun.error_utils import RerunWarning

    sections: dict[str, dict[str, Any]] = {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RerunWarning)  # it warns of a file that was cut short
            chunks = RrdReader(name).store().stream().filter(content=f"{_PROPERTIES}/**").to_chunks()
    except (RuntimeError, ValueError, OSError, RerunWarning) as error:
        raise ReadError(f"cannot read {name}: it is no whole Rerun recording: record it again") from error
    for chunk in chunks:
        section = sections.setdefault(chunk.entity_path.removeprefix(f"{_PROPERTIES}/"), {})
        batch = chunk.to_record_batch()
        for key, column in zip(batch.schema.names, batch.columns, strict=True):
            if not key.startswith("rerun."):
                section[key] = column[0].as_py()[0]
    return sections


def playback_speed(file: str | os.PathLike[str]) -> float:
    """Return how many seconds of the run the viewer plays in a second, 1 where a recording does not say."""
    from rerun.chunk import RrdReader

    reader = RrdReader(os.fspath(file))
    for blueprint in reader.blueprints():
        for chunk in reader.stream(store=blueprint):
            batch = chunk.to_record_batch()
            for name, column in zip(batch.schema.names, batch.columns, strict=True):
                if name == "TimePanelBlueprint:playback_speed":
                    return float(column[0].as_py()[0])
    return 1.0


def _require_same_part(name: str, part: Part, recorded: str | None) -> None:
    if recorded is None or part.source.sha256 == recorded:
        return
    raise ReadError(
        f"{name} was made from another {part.name}: its SHA-256 was {recorded[:12]}…, and is "
        f"{str(part.source.sha256)[:12]}…: bring the part back as it was, or simulate the scene anew"
    )
