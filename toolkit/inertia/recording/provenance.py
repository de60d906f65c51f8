"""Properties of a recording: what made it, of what, how accurately; the scene or rotor read back, to be run again."""

from __future__ import annotations

import base64
import os
import tempfile
import tomllib
import warnings
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import replace
from hashlib import sha256
from pathlib import Path, PurePosixPath
from typing import Any

from inertia import __version__
from inertia.assembly.budget import Budget
from inertia.balancing.balance import Balance
from inertia.balancing.rotor import Rotor
from inertia.documents import toml_text
from inertia.dynamics.run import Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings
from inertia.errors import ReadError, visible
from inertia.mesh.part import Part
from inertia.standard_input import NAME, call_folder, file_of

ENCLOSED = 32 << 20
"""Bytes of parts and tables that a recording holds at most."""

_OPENED: dict[Path, tuple[tempfile.TemporaryDirectory[str], Path]] = {}  # by recording, and where its scene is
_SETTINGS = ("duration", "samples", "accuracy", "model", "method")
_PROPERTIES = "/__properties"
_DOCUMENT = ".toml"
_MAGIC = b"RRF2"
"""How recordings begin since Rerun 0.23; four bytes of the version follow."""


def properties_of(subject: Run | Balance | Budget) -> dict[str, dict[str, Any]]:
    """Return the properties by section; no folder of this machine is in them."""
    tool = {"tool": {"name": "inertia", "version": __version__}}
    if isinstance(subject, Run):
        return tool | _of_run(subject)
    return tool | (_of_balance(subject) if isinstance(subject, Balance) else _of_budget(subject))


def _of_run(run: Run) -> dict[str, dict[str, Any]]:
    return {
        **of_scene(run.scene),
        "accuracy": {
            "model": run.model,
            "method": run.error.method,
            "requested_rad": run.error.requested,
            "reached_rad": run.error.reached,
        },
    }


def of_scene(scene: Scene) -> dict[str, dict[str, Any]]:
    """Return what is needed to run a scene again, by section."""
    text, parts = scene.source_text, [part for part in (scene.body.part, *scene.body.meshes) if part is not None]
    return {
        "scene": {"name": _last(scene.name), "text": None if text is None else _without_folders(text)},
        "files": {} if text is None else _enclosed(text, _folder_of(scene.name), parts),
        "settings": {name: getattr(scene.run, name) for name in _SETTINGS},
        **{name: _source(part) for name, part in _source_sections(scene.body).items()},
    }


def _of_balance(balance: Balance) -> dict[str, dict[str, Any]]:
    rotor, error, text = balance.rotor, balance.properties.error, balance.rotor.to_toml()
    parts = [body.whole for body in balance.bodies]
    if rotor.assembly is not None:  # of its files once each
        parts = list({part.source.path: part for part in parts if part.source.path is not None}.values())
    return {
        "rotor": {"name": _last(rotor.name), "text": _without_folders(text)},
        "files": _enclosed(text, rotor.folder, parts),
        **{name: _source(part) for name, part in _numbered(parts).items()},
        "accuracy": {"method": error.method, "mass": error.mass, "inertia": error.inertia},
        "verdict": {"outcome": balance.verdict.outcome},
    }


def _of_budget(budget: Budget) -> dict[str, dict[str, Any]]:
    error = budget.properties.error
    text = toml_text(budget.assembly.to_dict())  # a bill of materials too
    return {
        "assembly": {"name": _last(budget.assembly.path), "text": _without_folders(text)},
        "accuracy": {"method": error.method, "mass": error.mass, "inertia": error.inertia},
        "verdict": {"outcome": budget.verdict},
    }


def _source_sections(body: SceneBody) -> dict[str, Part]:
    """Return the parts of a body that have a mesh, by the section that says where it came from."""
    return _numbered([part for part in (body.part, *body.meshes) if part is not None])


def _numbered(parts: list[Part]) -> dict[str, Part]:
    return {"source" if k == 1 else f"source_{k}": part for k, part in enumerate(parts, 1)}


def _source(part: Part) -> dict[str, Any]:
    source = part.source
    return {
        "path": source.path and _last(source.path),
        "format": source.format,
        "unit": part.unit.name,
        "sha256": source.sha256,
        "files": _files(part),
    }


def _files(part: Part) -> str | None:
    """Return the files that the part's file refers to, as `sha256sum` lists them."""
    return "\n".join(f"{digest}  {visible(name)}" for name, digest in part.source.files.items()) or None


def _last(path: str) -> str:
    """Return a path without its folders, which are nobody else's business."""
    return visible(Path(path).name)


def _texts(value: Any) -> Iterator[str]:
    """Yield all texts of a document."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _texts(each)


def _without_folders(text: str) -> str:
    """Return a document whose absolute paths are names."""
    for each in set(_texts(tomllib.loads(text))):
        if Path(each).is_absolute():
            text = text.replace(each, Path(each).name)
    return text


def _enclosed(text: str, folder: Path, parts: Iterable[Part]) -> dict[str, str]:
    """Return all files that a document in a folder names, or that these refer to: path seen from it, and contents."""
    sources = [part.source for part in parts if part.source.path]
    beside = {Path(each.version.path if each.version else str(each.path)).resolve(): each.files for each in sources}
    named: dict[str, Path] = {}

    def add(text: str, folder: Path, near: Path) -> None:
        for value in _texts(tomllib.loads(text)):
            file, place = folder / value, near / (Path(value).name if Path(value).is_absolute() else value)
            if not (Path(value).suffix and file.is_file()) or place.as_posix() in named:
                continue
            named[place.as_posix()] = file
            for name in beside.get(file.resolve(), ()):
                named[(place.parent / name).as_posix()] = file.parent / name
            if file.suffix.lower() == _DOCUMENT:
                add(file.read_text(encoding="utf-8-sig"), file.parent, place.parent)

    add(text, folder, Path())
    whole = [path for path in named.values() if path.is_file()]
    if sum(path.stat().st_size for path in whole) > ENCLOSED or len(whole) < len(named):
        return {}
    files = {}
    for k, (name, path) in enumerate(named.items(), 1):
        contents = path.read_bytes()
        if path.suffix.lower() == _DOCUMENT:
            contents = _without_folders(contents.decode("utf-8-sig")).encode()
        files[f"path_{k}"] = name
        files[f"contents_{k}"] = base64.b64encode(zlib.compress(contents)).decode()
    return files


def _folder_of(name: str) -> Path:
    """Return where the files are that a scene of this name refers to."""
    opened = _OPENED.get(Path(name).resolve())
    return Path(name).resolve().parent if opened is None else opened[1]


def _opened(name: str, files: dict[str, str]) -> Path:
    """Write the files of a recording to a folder that lasts as long as the program, and return it."""
    root = tempfile.TemporaryDirectory(prefix="inertia-")
    names = [files[f"path_{k}"] for k in range(1, len(files) // 2 + 1)]
    folder = Path(root.name).resolve().joinpath(*"d" * max(PurePosixPath(each).parts.count("..") for each in names))
    for above in (folder, *folder.parents):  # the innermost first: its files are called without those around it
        if above.is_relative_to(Path(root.name).resolve()):
            call_folder(above, name)
    for k, each in enumerate(names, 1):
        path = Path(os.path.normpath(folder / each))
        if not path.is_relative_to(Path(root.name).resolve()):
            raise ReadError(f"cannot read {name}: a file in it wants to be outside of it: simulate its scene anew")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(zlib.decompress(base64.b64decode(files[f"contents_{k}"])))
    folder.mkdir(parents=True, exist_ok=True)
    _OPENED[Path(name).resolve()] = root, folder
    return folder


def scene_of(file: str | os.PathLike[str]) -> Scene:
    """Return the scene of a recording, with the settings that it was run with.

    Parts and tables come out of the recording; those of more than `ENCLOSED` bytes are looked for beside it.

    Raises
    ------
    ReadError : the file is no recording of a run, its scene has a torque that only Python can give, or a file that it
        names is not there or not the same as then
    """
    name = os.fspath(file)
    sections = properties(file)
    table, settings = sections.get("scene", {}), sections.get("settings", {})
    if not table:
        again = "run it again by `balance`" if "rotor" in sections else "simulate its scene and record that"
        raise ReadError(f"cannot read {name}: it is no recording of a run: {again}")
    if "text" not in table:
        raise ReadError(
            f"cannot read {name}: its scene has a torque that was given in Python as a function or a table: simulate "
            "it from there"
        )
    enclosed = sections.get("files")
    folder = _opened(name, enclosed) if enclosed else Path(name).resolve().parent / table.get("folder", ".")
    scene = Scene.loads(table["text"], folder, name)
    for section, part in _source_sections(scene.body).items():
        recorded = sections.get(section, {})
        _require_same(name, part.name, part.source.sha256, recorded.get("sha256"))
        if recorded.get("files") not in (None, _files(part)):
            raise ReadError(
                f"{name} was made when {part.name} referred to other files, or they held something else: bring them "
                "back as they were, or simulate the scene anew"
            )
    return replace(scene, run=Settings(**{key: settings[key] for key in _SETTINGS if key in settings}))


def rotor_of(file: str | os.PathLike[str]) -> Rotor:
    """Return the rotor of a recording, to be balanced again.

    Its files come out of the recording; those of more than `ENCLOSED` bytes are looked for beside it.

    Raises `ReadError` where the file is no recording of a rotor, or a file beside it is not the same as then.
    """
    name = os.fspath(file)
    sections = properties(file)
    if "text" not in sections.get("rotor", {}):
        raise ReadError(f"cannot read {name}: it is no recording of a rotor: balance its file and record that")
    text, enclosed = sections["rotor"]["text"], sections.get("files")
    folder = _opened(name, enclosed) if enclosed else Path(name).resolve().parent
    if not enclosed:
        recorded = {each["path"]: each["sha256"] for key, each in sections.items() if key.startswith("source")}
        for value in set(_texts(tomllib.loads(text))):
            path = folder / value
            if Path(value).name in recorded and path.is_file():
                _require_same(name, value, sha256(path.read_bytes()).hexdigest(), recorded[Path(value).name])
    return replace(Rotor.loads(text, folder, name), text=None)  # which is not that of the file of this name


def properties(file: str | os.PathLike[str]) -> dict[str, dict[str, Any]]:
    """Return the properties of a recording by section, without reading the rest of it.

    Raises `ReadError` where the file is no recording or not whole.
    """
    name = os.fspath(file)
    path = file_of(name) if name == NAME else Path(name)
    if not path.is_file() or _version(path) is None:
        raise ReadError(f"cannot read {name}: {_fault(path)}")
    from rerun.chunk import RrdReader
    from rerun.error_utils import RerunWarning

    sections: dict[str, dict[str, Any]] = {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RerunWarning)  # it warns of a file that was cut short
            chunks = RrdReader(str(path)).store().stream().filter(content=f"{_PROPERTIES}/**").to_chunks()
    except (RuntimeError, ValueError, OSError, RerunWarning) as error:
        raise ReadError(f"cannot read {name}: {_fault(path)}") from error
    for chunk in chunks:
        section = sections.setdefault(chunk.entity_path.removeprefix(f"{_PROPERTIES}/"), {})
        batch = chunk.to_record_batch()
        for key, column in zip(batch.schema.names, batch.columns, strict=True):
            if not key.startswith("rerun."):
                section[key] = column[0].as_py()[0]
    return sections


def _version(path: Path) -> tuple[int, int, int] | None:
    """Return the version of Rerun that wrote a file; None where the file is no recording of one that is read here."""
    with path.open("rb") as file:
        head = file.read(8)
    return (head[4], head[5], head[6]) if len(head) == 8 and head.startswith(_MAGIC) else None


def _fault(path: Path) -> str:
    """Say why a recording cannot be read, and what to do."""
    from importlib.metadata import version

    if path.is_dir():
        return "it is a folder: name a recording in it"
    if not path.is_file():
        return "there is no such file: check the path"
    with path.open("rb") as file:
        head = file.read(8)
    installed = version("rerun-sdk")
    if not head:
        return "it is empty: record it again"
    if not head.startswith(_MAGIC[:3]):
        return "it is no Rerun recording: name a file that was written by `-o run.rrd`"
    if len(head) >= 4 and not head.startswith(_MAGIC):
        return f"its format is not that of the installed Rerun {installed}: record it again"
    written = _version(path)
    if written is not None and written[:2] > tuple(map(int, installed.split(".")[:2])):
        text = ".".join(map(str, written))
        return f"it is by Rerun {text}, and the installed one is {installed}: install that version, or record it again"
    return "it was cut short, or is damaged: record it again"


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


def _require_same(name: str, part: str, now: str | None, recorded: str | None) -> None:
    if recorded is None or now == recorded:
        return
    raise ReadError(
        f"{name} was made from another {part}: its SHA-256 was {recorded[:12]}…, and is {str(now)[:12]}…: bring the "
        "part back as it was, or record anew"
    )
