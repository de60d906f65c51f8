"""Scenes that tumble, one for each look of the screen."""

from dataclasses import replace
from typing import Any

from inertia import Scene
from inertia_meshes import path

FREE: dict[str, dict[str, Any]] = {
    "asymmetric": {"body": {"principal_moments": [1.0, 2.0, 3.0]}, "spin": [0.05, 2.0, 0.0]},
    "spherical": {"body": {"principal_moments": [2.0, 2.0, 2.0], "mass": 1.0}, "spin": [1.0, 2.0, 0.5]},
    "prolate": {"body": {"principal_moments": [1.0, 3.0, 3.0]}, "spin": [2.0, 1.0, 0.0]},
    "oblate": {"body": {"principal_moments": [2.0, 2.0, 3.0]}, "spin": [0.5, 0.0, -2.0]},
    "steady": {"body": {"principal_moments": [1.0, 2.0, 3.0]}, "spin": [0.0, 0.0, 3.0]},
    "thrown": {
        "body": {"principal_moments": [1.0, 2.0, 3.0], "mass": 4.0},
        "spin": [0.2, 2.0, 0.1],
        "load": [{"kind": "gravity"}],
        "velocity": [3.0, 0.0, 4.0],
    },
    "slow": {"body": {"principal_moments": [1.0, 2.0, 3.0]}, "spin": [1e-4, 1e-3, 0.0], "duration": 1e4},
    "coarse": {"body": {"principal_moments": [1.0, 2.0, 3.0]}, "spin": [0.0, 50.0, 1.0], "samples": 40},
}


def scene_table(look: str) -> dict[str, Any]:
    """Return a scene as `Scene.from_dict` takes it."""
    table = FREE[look]
    start = {"angular_velocity": table["spin"]}
    if "velocity" in table:
        start["velocity"] = table["velocity"]
    run = {"duration": table.get("duration", 8.0), "samples": table.get("samples", 401), "accuracy": 1e-8}
    return {"body": table["body"], "start": start, "run": run, "load": table.get("load", [])}


def t_handle() -> Scene:
    """Return the T-handle that turns over, for six seconds."""
    scene = Scene.load(path("scenes/t_handle.toml"))
    return replace(scene, run=replace(scene.run, duration=6.0, samples=601))
