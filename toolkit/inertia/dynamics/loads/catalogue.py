"""The loads that a scene may have, ``[[load]]``: where a new one is added."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from inertia.documents import FieldError, choice, section_of, table_of
from inertia.dynamics.loads.gravity import Gravity, GravityGradient
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.losses import Damping, Dissipation
from inertia.dynamics.loads.orbit import Orbit
from inertia.dynamics.loads.torque import Torque

LOADS: tuple[type[Load], ...] = (Gravity, Torque, Damping, GravityGradient, Orbit, Dissipation)


def acting(loads: Iterable[Load]) -> tuple[Load, ...]:
    """Return loads without those that are zero, and without constant torques that add up to zero.

    >>> [len(acting([Torque([1, 0, 0]), Torque([-k, 0, 0])])) for k in (1, 2)]
    [0, 2]
    """
    remaining = [load for load in loads if not load.idle]
    for frame in ("part", "principal", "space"):
        constant = [load for load in remaining if isinstance(load, Torque) and load.constant and load.frame == frame]
        if not any(math.fsum(along) for along in zip(*(np.asarray(load.torque) for load in constant), strict=True)):
            remaining = [load for load in remaining if load not in constant]
    return tuple(remaining)


def load_of(table: object, path: str, folder: Path) -> Load:
    """Make one load from its table in the file, which `path` names; the files that it names are in `folder`."""
    kinds = {load.kind: load for load in LOADS}
    entries = dict(table_of(table, path))
    if "kind" not in entries:
        raise FieldError(f"{path}.kind", f"is missing: use one of {', '.join(map(repr, kinds))}")
    load = kinds[choice(*kinds)(entries["kind"], f"{path}.kind")]
    return section_of(load, load.with_files(entries, folder), extra=("kind",), path=path)
