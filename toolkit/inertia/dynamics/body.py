"""The body that a model moves: what is left of mass properties once no mesh is needed any more."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError
from inertia.mass.principal import Principal, principal
from inertia.mass.properties import MassProperties
from inertia.mass.tensor import array_of, faults, steiner


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body in part axes, SI units.

    Attributes
    ----------
    inertia : (3, 3) kg m² about the centre of mass; signs as in `inertia.mass.tensor`
    mass : kg; None where the scene gives none, which is enough for a free body
    center_of_mass : (3,) m

    Raises `GeometryError` where the tensor is not physical, `UsageError` where a value is not finite.
    """

    inertia: Float
    mass: float | None = None
    center_of_mass: Float = (0.0, 0.0, 0.0)  # type: ignore[assignment]

    def __post_init__(self) -> None:
        object.__setattr__(self, "inertia", array_of(self.inertia, (3, 3), "inertia"))
        object.__setattr__(self, "center_of_mass", array_of(self.center_of_mass, (3,), "center_of_mass"))
        if found := faults(self.inertia):
            raise GeometryError(f"the inertia tensor is not physical: {found[0]}")
        if not np.any(self.inertia):
            raise GeometryError("the inertia tensor is zero: a point has no attitude to follow")
        if self.mass is not None and not 0 < self.mass < np.inf:
            raise GeometryError(f"the mass is {self.mass:.6g} kg: it must be positive and finite")

    @classmethod
    def of(cls, properties: MassProperties) -> Body:
        """Take the mass properties of a part."""
        return cls(properties.inertia, properties.mass, properties.center_of_mass)

    @cached_property
    def principal(self) -> Principal:
        """Principal moments, axes and class of the tensor about the centre of mass."""
        return principal(self.inertia)

    def about(self, point: Float) -> Float:
        """Return the tensor (3, 3) about `point` (3,), by Steiner's theorem. Needs a mass."""
        if self.mass is None:
            raise GeometryError("the body has no mass: moments about another point than the centre of mass need one")
        return steiner(self.inertia, self.mass, self.center_of_mass, about=self.center_of_mass, to=point)

    @cached_property
    def axes_attitude(self) -> Float:
        """The quaternion (4,) that takes principal components to part components."""
        return quaternion.from_matrix(self.principal.axes)
