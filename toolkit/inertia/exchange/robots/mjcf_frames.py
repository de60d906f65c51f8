"""Where a frame of MJCF lies: ``pos``, and one of ``quat``, ``axisangle``, ``euler``, ``xyaxes`` and ``zaxis``.

By the section Frame orientations of MuJoCo's documentation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError
from inertia.exchange.robots.links import Placement
from inertia.exchange.robots.text import floats
from inertia.exchange.rotations import rotation_of_quaternion
from inertia.mesh.readers.contents import shown
from inertia.records import dataclass

_SHORTEST, _LONGEST = 1e-15**0.5, 1e154  # quaternions that MuJoCo normalises, as their squares are numbers
_NO_LENGTH = 1e-7  # of a direction: MuJoCo does not load shorter ones
_UNITS = {"degree": math.pi / 180, "radian": 1.0}
ORIENTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")


@dataclass(frozen=True)
class Angles:
    """How a model writes angles: `unit` in radians, and the axes that ``euler`` turns about, capitals if fixed ones."""

    unit: float = _UNITS["degree"]
    sequence: str = "xyz"

    @staticmethod
    def of(compiler: Mapping[str, str]) -> Angles:
        """Return what the attributes of ``<compiler>`` say; raise `ReadError` where MuJoCo would not load them."""
        angle, sequence = compiler.get("angle", "degree"), compiler.get("eulerseq", "xyz")
        if angle not in _UNITS:
            raise ReadError(f"compiler, angle is {shown(angle)}: it must be degree or radian")
        if len(sequence) != 3 or not set(sequence) <= set("xyzXYZ"):
            raise ReadError(f"compiler, eulerseq is {shown(sequence)}: it must be three of x, y, z, X, Y, Z")
        return Angles(_UNITS[angle], sequence)

    def placement(self, attributes: Mapping[str, str], what: str, also: tuple[str, ...] = ()) -> Placement:
        """Return where a frame lies; `also` are the attributes that exclude an orientation."""
        given = [key for key in (*ORIENTATIONS, *also) if key in attributes]
        if len(given) > 1:
            raise ReadError(f"{what} has both {given[0]} and {given[1]}, which MuJoCo does not load: keep one")
        return Placement(self._rotation(attributes, what), numbers(attributes, "pos", 3, [0.0] * 3, what))

    def _rotation(self, attributes: Mapping[str, str], what: str) -> Float:
        if "quat" in attributes:
            return turned(attributes, "quat", what)
        if "axisangle" in attributes:
            *axis, angle = numbers(attributes, "axisangle", 4, None, what).tolist()
            return _turn(_unit(np.array(axis), what), angle * self.unit)
        if "euler" in attributes:
            rotation = np.eye(3)
            for letter, angle in zip(self.sequence, numbers(attributes, "euler", 3, None, what).tolist(), strict=True):
                step = _turn(np.eye(3)["xyz".index(letter.lower())], angle * self.unit)
                rotation = rotation @ step if letter.islower() else step @ rotation  # about moving, or fixed axes
            return rotation
        if "xyaxes" in attributes:
            axes = numbers(attributes, "xyaxes", 6, None, what).reshape(2, 3)
            x = _unit(axes[0], what)
            y = _unit(axes[1] - x * (x @ axes[1]), what)
            y = _unit(y - x * (x @ y), what)  # of axes close together, the first step leaves what was rounded
            return np.column_stack([x, y, np.cross(x, y)])
        if "zaxis" in attributes:
            return along(numbers(attributes, "zaxis", 3, None, what), what)
        return np.eye(3)


def turned(attributes: Mapping[str, str], key: str, what: str) -> Float:
    """Return the rotation (3, 3) of the quaternion in an attribute; raise `ReadError` of one that MuJoCo spoils."""
    quaternion = numbers(attributes, key, 4, [1.0, 0.0, 0.0, 0.0], what).tolist()
    if not any(quaternion):
        raise ReadError(f"{what}, {key} is zero")
    if not _SHORTEST <= (length := math.hypot(*quaternion)) <= _LONGEST:
        lies = f"{what}, {key} is {length:.3g} long, which MuJoCo does not take for a rotation"
        raise ReadError(f"{lies}: scale it to the length 1")
    return rotation_of_quaternion(quaternion)


def along(direction: Float, what: str) -> Float:
    """Return the smallest turn (3, 3) that takes z to a direction (3,)."""
    z = _unit(direction, what)
    sine = math.hypot(z[0], z[1])
    axis = np.array([-z[1], z[0], 0.0]) / sine if sine else np.array([1.0, 0.0, 0.0])
    return _turn(axis, math.atan2(sine, z[2]))


def _turn(axis: Float, angle: float) -> Float:
    half = 0.5 * angle
    return rotation_of_quaternion([math.cos(half), *(math.sin(half) * axis).tolist()])


def _unit(vector: Float, what: str) -> Float:
    length = math.hypot(*vector.tolist())
    if length < _NO_LENGTH:
        raise ReadError(f"{what}: an axis of no length, or along another one: MuJoCo loads none below {_NO_LENGTH:g}")
    return vector / length


def numbers(attributes: Mapping[str, str], key: str, count: int, default: list[float] | None, what: str) -> Float:
    """Return the finite numbers in an attribute, (count,), or `default`; raise `ReadError` where there are none."""
    if key in attributes:
        return np.array(floats(attributes[key], count, f"{what}, {key}"))
    if default is None:
        raise ReadError(f"{what} has no {key}")
    return np.array(default, float)
