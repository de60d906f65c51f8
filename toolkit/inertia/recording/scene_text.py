"""The text of a scene that no file has: made in Python, or on the command line."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.loads import Load, Torque


def scene_text(scene: Scene) -> str | None:
    """Return the text of a scene file that gives the same motion; None where a torque is a function or a table.

    A part comes back as its tensor, unless the scene was read from a text.

    >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 2, 3]},
    ...                          "start": {"angular_velocity": [0, 10, 0.001]}, "run": {"duration": 60}})
    >>> Scene.loads(scene_text(scene)).angular_velocity.tolist()
    [0.0, 10.0, 0.001]
    """
    if scene.text is not None:
        return scene.text
    if any(isinstance(load, Torque) and not isinstance(load.torque, np.ndarray) for load in scene.applied_loads):
        return None
    start = {**_fields(scene.start), "angular_velocity": scene.angular_velocity, "frame": "part"}
    return toml(
        {
            "schema": 1,
            "body": _fields(scene.body.body),
            "start": start,
            "constraint": _fields(scene.constraint),
            "run": _fields(scene.run),
            "load": [_load(scene, load) for load in scene.applied_loads],
        }
    )


def toml(table: Mapping[str, Any]) -> str:
    """Return a dictionary as TOML; what is None or empty is left out.

    >>> print(toml({"schema": 1, "body": {"part": "a.stl", "mass": None}, "load": [{"kind": "gravity"}]}))
    schema = 1
    <BLANKLINE>
    [body]
    part = "a.stl"
    <BLANKLINE>
    [[load]]
    kind = "gravity"
    <BLANKLINE>
    """
    lines = []
    for key, value in table.items():
        if isinstance(value, Mapping):
            lines += ["", f"[{key}]", *_entries(value)]
        elif isinstance(value, list):
            lines += [line for each in value for line in ("", f"[[{key}]]", *_entries(each))]
        else:
            lines += _entries({key: value})
    return "\n".join([*lines, ""])


def _entries(table: Mapping[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in table.items() if value is not None]


def _value(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, np.ndarray | Sequence):
        return f"[{', '.join(_value(each) for each in value)}]"
    return repr(value if isinstance(value, int) else float(value))


def _fields(section: Any) -> dict[str, Any]:
    return {each.name: getattr(section, each.name) for each in dataclasses.fields(section)}


def _load(scene: Scene, load: Load) -> dict[str, Any]:
    entries = {"kind": load.kind, **_fields(load)}
    if isinstance(load, Torque) and load.frame == "principal":
        entries |= {"frame": "part", "torque": scene.body.axes @ np.asarray(load.torque)}
    return entries
