"""The fields that only scenes have; what fields are, `inertia.documents` says."""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError, numbers
from inertia.dynamics.kinematics import quaternion

_UNIT_LENGTH = 1e-6


def attitude_of(value: Any, path: str) -> Float:
    """Read a unit quaternion, scalar last; what rounding left of its length is divided out."""
    q: Float = numbers((4,), "x, y, z, w")(value, path)
    length = float(np.linalg.norm(q))
    if length == 0:
        raise FieldError(path, "is zero: it must be a unit quaternion, x, y, z, w; [0, 0, 0, 1] turns nothing")
    if abs(length - 1.0) > _UNIT_LENGTH:
        unit = (q / length).tolist()
        raise FieldError(path, f"has length {length:.9g}: it must be a unit quaternion, such as {unit}")
    return quaternion.normalise(q)


def direction(value: Any, path: str) -> Float:
    """Read a direction (3,) and give it unit length."""
    vector: Float = numbers((3,), "no unit")(value, path)
    largest = float(np.abs(vector).max())
    if largest == 0:
        raise FieldError(path, "is zero: it must point somewhere")
    vector = vector / largest
    return vector / np.linalg.norm(vector)
