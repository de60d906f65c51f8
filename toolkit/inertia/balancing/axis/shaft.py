"""The shaft of a rotor: where its axis runs, where 0° is, and which way it turns.

Frames and signs are those of `inertia.balancing.unbalance`.
"""

from __future__ import annotations

from dataclasses import InitVar, field
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.documents import FieldError, joined
from inertia.mass.properties import MassProperties
from inertia.mass.tensor import array_of
from inertia.records import dataclass

_COINCIDENT = 1e-9  # of the bearings' distance from the origin: no direction is left
_PARALLEL = 1e-6  # rad


@dataclass(frozen=True, eq=False)
class Shaft:
    """The axis through two bearings, with its zero mark and sense of rotation.

    z′ points from bearing A to bearing B; x′ is the zero mark (0°) made perpendicular to it, y′ = z′ × x′. Places
    along the shaft are given as z = z′ · point, so that along a part's own z axis they are the part's own z.

    Attributes
    ----------
    bearing_a, bearing_b : (3,) m, centres of the bearings in part axes
    zero_mark : (3,) a vector in part axes, of any length, that points from the shaft to the 0° mark
    rotation : "ccw" or "cw", seen from the B end looking toward A
    path : what errors call the section of a file that says so

    Raises `FieldError` where the bearings coincide or the zero mark runs along the shaft.

    >>> shaft = Shaft([0, 0, 0.02], [0, 0, 0.28], zero_mark=[1, 0, 0])
    >>> shaft.z_a, shaft.z_b, shaft.span
    (0.02, 0.28, 0.26)
    """

    bearing_a: Float
    bearing_b: Float
    zero_mark: Float
    rotation: Literal["ccw", "cw"] = "ccw"
    path: InitVar[str] = field(default="", kw_only=True)

    def __post_init__(self, path: str) -> None:
        for name in ("bearing_a", "bearing_b", "zero_mark"):
            value = array_of(getattr(self, name), (3,), joined(path, name))
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if self.rotation not in ("ccw", "cw"):
            raise FieldError(
                joined(path, "rotation"), f"is {self.rotation!r}: use 'ccw' or 'cw', seen from B looking toward A"
            )
        size = float(max(np.abs(self.bearing_a).max(), np.abs(self.bearing_b).max()))
        if self.span <= _COINCIDENT * size:
            place = ", ".join(f"{1e3 * x:.6g}" for x in self.bearing_a.tolist())
            raise FieldError(
                joined(path, "bearing_a and bearing_b"),
                f"are {1e3 * self.span:.3g} mm apart at ({place}) mm: a shaft needs two separate bearings, "
                "correct one of them",
            )
        length = float(np.linalg.norm(self.zero_mark))
        if length == 0:
            raise FieldError(joined(path, "zero_mark"), "has no length: give a vector from the shaft to the 0° mark")
        if np.linalg.norm(np.cross(self._along, self.zero_mark / length)) < _PARALLEL:
            raise FieldError(
                joined(path, "zero_mark"),
                f"{self.zero_mark.tolist()} runs along the shaft to within {_PARALLEL:g} rad: give a vector "
                "across the shaft",
            )

    @property
    def span(self) -> float:
        """Distance between the bearings, m."""
        return float(np.linalg.norm(self.bearing_b - self.bearing_a))

    @property
    def turn(self) -> int:
        """+1 where the shaft turns about +z′ ("ccw"), −1 where it turns about −z′."""
        return 1 if self.rotation == "ccw" else -1

    @property
    def z_a(self) -> float:
        """Place of bearing A along the shaft, m."""
        return self.z_of(self.bearing_a)

    @property
    def z_b(self) -> float:
        """Place of bearing B along the shaft, m."""
        return self.z_of(self.bearing_b)

    @cached_property
    def axes(self) -> Float:
        """The shaft axes (3, 3): columns x′, y′, z′ in part axes."""
        along = self._along
        x = self.zero_mark / np.linalg.norm(self.zero_mark)
        x = x - along * (along @ x)
        x /= np.linalg.norm(x)
        axes: Float = np.column_stack([x, np.cross(along, x), along])
        axes.setflags(write=False)
        return axes

    @property
    def _along(self) -> Float:
        along: Float = (self.bearing_b - self.bearing_a) / self.span
        return along

    def z_of(self, point: ArrayLike) -> float:
        """Return the place along the shaft, m, of a point (3,) m in part axes."""
        return float(self._along @ array_of(point, (3,), "point"))

    def to_shaft(self, points: ArrayLike) -> Float:
        """Return points (..., 3) m of part axes in shaft axes: x′, y′ from the axis, z along it."""
        local: Float = (np.asarray(points, dtype=np.float64) - self.bearing_a) @ self.axes
        local[..., 2] += self.z_a
        return local

    def to_part(self, points: ArrayLike) -> Float:
        """Return points (..., 3) m of shaft axes in part axes."""
        local = np.array(points, dtype=np.float64)
        local[..., 2] -= self.z_a
        placed: Float = local @ self.axes.T + self.bearing_a
        return placed

    def place(self, z: float, radius: float, angle: float) -> Float:
        """Return the point (3,) m, part axes, at z (m) and radius (m) and at an angle (rad) from the zero mark."""
        return self.to_part([radius * np.cos(angle), radius * np.sin(angle), z])

    def resolve(self, properties: MassProperties) -> MassProperties:
        """Return the mass properties in shaft axes, with the origin at bearing A.

        The bounds take the axes as they are, to the last bit.
        """
        return properties.expressed_in(self.axes, self.bearing_a)
