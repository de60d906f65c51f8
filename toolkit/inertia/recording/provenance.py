"""The properties of a recording: what made it, of what, how accurately, and all that is needed to make it again."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from inertia import __version__
from inertia.balancing.balance import Balance
from inertia.dynamics.run import Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.errors import UsageError
from inertia.mesh.part import Part

SETTINGS = ("duration", "samples", "accuracy", "model", "method")


def properties_of(found: Run | Balance, file: Path | None) -> dict[str, dict[str, Any]]:
    """Return the properties by section; paths are relative to the folder of `file`."""
    tool = {"tool": {"name": "inertia", "version": __version__}}
    return tool | (_of_balance(found, file) if isinstance(found, Balance) else _of_run(found, file))


def source_sections(body: SceneBody) -> dict[str, Part]:
    """Return the parts of a body that have a mesh, by the section that says where it came from."""
    return _numbered([part for part in (body.part, *body.meshes) if part is not None])


def _of_run(run: Run, file: Path | None) -> dict[str, dict[str, Any]]:
    scene = run.scene
    return {
        "scene": {"name": scene.name, "text": _text(scene), "folder": _folder(scene.name, file)},
        "settings": {name: getattr(scene.run, name) for name in SETTINGS},
        **{name: _source(part) for name, part in source_sections(scene.body).items()},
        "accuracy": {
            "model": run.model,
            "method": run.error.method,
            "requested_rad": run.error.requested,
            "reached_rad": run.error.reached,
        },
    }


def _of_balance(found: Balance, file: Path | None) -> dict[str, dict[str, Any]]:
    rotor, error = found.rotor, found.properties.error
    return {
        "rotor": {"name": rotor.name, "text": rotor.to_toml(), "folder": _folder(rotor.name, file)},
        **{name: _source(part) for name, part in _numbered([body.whole for body in found.bodies]).items()},
        "accuracy": {"method": error.method, "mass": error.mass, "inertia": error.inertia},
        "verdict": {"outcome": found.verdict.outcome},
    }


def _text(scene: Scene) -> str | None:
    """Return the text of a scene file that gives the same motion; None where no file can."""
    try:
        return scene.to_toml() if scene.text is None else scene.text
    except UsageError:
        return None


def _numbered(parts: list[Part]) -> dict[str, Part]:
    return {"source" if k == 1 else f"source_{k}": part for k, part in enumerate(parts, 1)}


def _source(part: Part) -> dict[str, Any]:
    source = part.source
    return {"path": source.path, "format": source.format, "unit": part.unit.name, "sha256": source.sha256}


def _folder(name: str, file: Path | None) -> str:
    """Return where the files are that a scene or a rotor of this name refers to."""
    folder = Path(name).resolve().parent
    if file is None:
        return str(folder)
    try:
        return os.path.relpath(folder, file.resolve().parent)
    except ValueError:  # on another drive
        return str(folder)
