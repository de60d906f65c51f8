"""Scenes as dictionaries, for the tests to change one thing in."""

from copy import deepcopy
from typing import Any

from inertia.dynamics.scene.document import Scene

PLAIN: dict[str, Any] = {
    "schema": 1,
    "body": {"principal_moments": [1.0, 2.0, 3.0], "mass": 2.0},
    "start": {"angular_velocity": [0.3, 1.0, 2.0]},
    "run": {"duration": 10.0, "samples": 11},
}
TOP: dict[str, Any] = {
    "body": {"principal_moments": [2e-4, 2e-4, 1.25e-4], "mass": 0.1, "center_of_mass": [0.0, 0.0, 0.04]},
    "start": {"angular_velocity": [0.0, 0.0, 150.0], "attitude": [0.6, 0.0, 0.0, 0.8]},
    "constraint": {"kind": "fixed_point"},
    "load": [{"kind": "gravity"}],
    "run": {"duration": 1.0, "samples": 11},
}
DISC: dict[str, Any] = {
    "body": {"principal_moments": [0.25, 0.25, 0.5], "mass": 1.0},
    "start": {"angular_velocity": [0.0, 0.5, 6.0], "attitude": [0.6, 0.0, 0.0, 0.8], "frame": "part"},
    "constraint": {"kind": "rolling", "radius": 1.0},
    "load": [{"kind": "gravity"}],
    "run": {"duration": 1.0, "samples": 11, "accuracy": 1e-8},
}


def table(base: dict[str, Any] = PLAIN, **changes: Any) -> dict[str, Any]:
    """Return a copy of `base`; a change `body__mass=3` sets a field, None takes it or a whole section out."""
    made = deepcopy(base)
    for path, value in changes.items():
        section, _, name = path.partition("__")
        place, key = (made.setdefault(section, {}), name) if name else (made, section)
        if value is None:
            place.pop(key, None)
        else:
            place[key] = value
    return made


def scene(base: dict[str, Any] = PLAIN, **changes: Any) -> Scene:
    """Return the scene of `table`."""
    return Scene.from_dict(table(base, **changes))
