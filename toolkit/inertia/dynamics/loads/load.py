"""`Load`: what every load on a body offers, and what it needs to know of the body.

A load of a scene is given along part axes, principal axes or space axes; `Load.along` re-expresses it. Its torque is
that along the axes of a `TurningBody`, which are principal ones about its reference point, at attitudes (…, 4) of these
axes and angular velocities (…, 3) along them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

from inertia.arrays import Float
from inertia.documents import Section
from inertia.dynamics.integrators.terms import Terms
from inertia.records import dataclass


class TurningBody(Protocol):
    """A body that turns about its reference point, along its principal axes there."""

    @property
    def moments(self) -> Float:
        """The principal moments (3,) kg m²."""

    @property
    def mass(self) -> float:
        """The mass, kg."""

    @property
    def arm(self) -> Float:
        """From the reference point to the centre of mass, (3,) m."""

    @property
    def numbers(self) -> tuple[int, ...]:
        """What the axes are called."""


@dataclass(frozen=True, eq=False)
class Load(Section, ABC):
    """A load: what pulls at the body."""

    section: ClassVar[str] = "load"

    kind: ClassVar[str]
    """Its name in a scene file."""

    noun: ClassVar[str]
    """Its name in a sentence."""

    acts_on_mass: ClassVar[bool] = False
    """Whether it needs the mass of the body."""

    starts_motion: ClassVar[bool] = False
    """Whether it can set a body in motion that is at rest."""

    free_bodies_only: ClassVar[bool] = False
    """Whether it acts on a body that is not held."""

    conservative: ClassVar[bool] = False
    """Whether the torque follows from `potential`, so that the energy is kept."""

    @property
    def dissipation(self) -> float:
        """κ in kg m² s of the energy that is lost inside the body at κ |dω/dt|² W."""
        return 0.0

    @property
    def breaks(self) -> Float:
        """Instants (k,) in s at which the torque has a kink or a jump."""
        return np.empty(0)

    @property
    def longest_step(self) -> float | None:
        """The longest step in s that steps over no pulse between breaks; None where any step will do."""
        return None

    @property
    def probed(self) -> bool:
        """Whether steps are to be probed for pulses that they missed."""
        return False

    @property
    def idle(self) -> bool:
        """Whether it is zero whatever the body does."""
        return False

    @abstractmethod
    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return the torque (…, 3) in N m along the axes of the body."""

    def potential(self, attitude: Float, body: TurningBody) -> Float:
        """Return the potential energy (…) in J; zero for a load that has none."""
        return np.zeros(np.shape(attitude)[:-1])

    def integrals(
        self, time: Float, attitude: Float, angular_velocity: Float, body: TurningBody
    ) -> dict[str, tuple[Float, float]]:
        """Return what else is kept where no other load acts, (n,) by its name, with a size to measure its drift by."""
        return {}

    def directions(self) -> Float:
        """Return directions (k, 3) in space whose span holds the torque at all times: L is kept across that span."""
        return np.eye(3)

    def terms(self, body: TurningBody, start: float) -> Terms | None:
        """Return the torque from `start` to the next break as `Terms`; None for a torque that is not of that form."""
        return None

    def along(self, axes: Float, principal_axes: Float) -> Load:
        """Return the same load for `axes` (3, 3), columns in part axes, in place of the part axes.

        `principal_axes` (3, 3), columns in part axes, are those that ``frame = "principal"`` means.
        """
        return self

    def require_span(self, duration: float, path: str) -> None:
        """Raise `FieldError` where the load is not known from 0 to `duration` s; `path` is that of its section."""

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return what a report says of it; `listed` writes numbers."""
        values = (f"{each.name} {listed(getattr(self, each.name))}" for each in fields(self))
        return f"{self.noun}, {', '.join(values)}"

    def entries(self, principal_axes: Float) -> dict[str, Any]:
        """Return its section as a scene file has it; raise `UsageError` where no file can."""
        return {"kind": self.kind, **{each.name: getattr(self, each.name) for each in fields(self)}}

    @classmethod
    def with_files(cls, entries: dict[str, Any], folder: Path) -> dict[str, Any]:
        """Return its section with what the files that it names, in `folder`, hold."""
        return entries


def across(vector: Float) -> Float:
    """Return two unit vectors (2, 3) across `vector`; none where it is zero."""
    if not np.any(vector):
        return np.empty((0, 3))
    rows: Float = np.linalg.svd(vector[None])[2][1:]
    return rows
