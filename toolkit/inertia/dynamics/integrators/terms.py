"""`Terms`: torques polynomial in ω and in directions fixed in space, which Taylor series and compiled steppers take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np

from inertia.arrays import Float, cross
from inertia.dynamics.kinematics import quaternion
from inertia.records import dataclass

HEAD, VECTOR = 10, 17
"""Numbers that `Terms.packed` gives to the whole body, and to each vector fixed in space."""


def _zeros(*shape: int) -> Float:
    return np.zeros(shape)


@dataclass(frozen=True, eq=False)
class Terms:
    """A torque along the principal axes that is polynomial in ω and in k vectors v fixed in space.

        N = torque + t torque_rate + Σ (w₀ + w₁ t)(A v + v × (b ∘ v)) − damping ∘ ω,    v resolved in the body,

    and the extra turn κ I⁻²(I ω × ω) of the axes that internal dissipation makes
    (`inertia.dynamics.loads.losses.Dissipation`). Time t counts from the instant that the terms were made for.

    Attributes
    ----------
    torque, torque_rate : (3,) N m, N m/s; damping : (3,) N m s; dissipation : κ in kg m² s
    vectors : (k, 3) in space; matrices : A (k, 3, 3); squares : b (k, 3); weights : w (k, 2)
    """

    torque: Float = field(default_factory=lambda: _zeros(3))
    torque_rate: Float = field(default_factory=lambda: _zeros(3))
    damping: Float = field(default_factory=lambda: _zeros(3))
    dissipation: float = 0.0
    vectors: Float = field(default_factory=lambda: _zeros(0, 3))
    matrices: Float = field(default_factory=lambda: _zeros(0, 3, 3))
    squares: Float = field(default_factory=lambda: _zeros(0, 3))
    weights: Float = field(default_factory=lambda: _zeros(0, 2))

    @classmethod
    def of_vector(
        cls, vector: Float, *, matrix: Float | None = None, square: Float | None = None, slope: bool = False
    ) -> Terms:
        """Make the terms of one vector; with `slope` its torque grows as t."""
        return cls(
            vectors=np.array([vector], dtype=np.float64),
            matrices=_zeros(1, 3, 3) if matrix is None else np.array([matrix], dtype=np.float64),
            squares=_zeros(1, 3) if square is None else np.array([square], dtype=np.float64),
            weights=np.array([[0.0, 1.0] if slope else [1.0, 0.0]]),
        )

    def __add__(self, other: Terms) -> Terms:
        return Terms(
            self.torque + other.torque,
            self.torque_rate + other.torque_rate,
            self.damping + other.damping,
            self.dissipation + other.dissipation,
            np.concatenate([self.vectors, other.vectors]),
            np.concatenate([self.matrices, other.matrices]),
            np.concatenate([self.squares, other.squares]),
            np.concatenate([self.weights, other.weights]),
        )

    def along(self, axes: Sequence[int]) -> Terms:
        """Return the same terms along the body axes in another order."""
        order = list(axes)
        return replace(
            self,
            torque=self.torque[order],
            torque_rate=self.torque_rate[order],
            damping=self.damping[order],
            matrices=self.matrices[:, order][:, :, order],
            squares=self.squares[:, order],
        )

    def packed(self, inertia: float, rate: float) -> Float:
        """Return all numbers in one array, in units of `inertia` (kg m²) and of time 1/`rate` (s)."""
        torque = inertia * rate * rate
        weights = self.weights / (torque, torque * rate)
        rows = np.concatenate([self.vectors, self.matrices.reshape(-1, 9), self.squares, weights], axis=1)
        head = [
            *(self.torque / torque),
            *(self.torque_rate / (torque * rate)),
            *(self.damping / (inertia * rate)),
            self.dissipation * rate / inertia,
        ]
        return np.concatenate([head, rows.ravel()])


def torque(packed: Float, time: float, attitude: Float) -> Float:
    """Return the torque (3,) of packed terms at an attitude (4,), without damping."""
    rows = packed[HEAD:].reshape(-1, VECTOR)
    v = quaternion.to_body(attitude, rows[:, :3])
    pulls = (rows[:, 3:12].reshape(-1, 3, 3) @ v[:, :, None])[:, :, 0] + cross(v, rows[:, 12:15] * v)
    total: Float = packed[0:3] + time * packed[3:6] + (rows[:, 15] + time * rows[:, 16]) @ pulls
    return total
