"""The figures of a body on a fixed axle that decide its angle, and how fast that changes."""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float
from inertia.records import dataclass


@dataclass(frozen=True)
class Axle:
    """What decides the angle, SI units: inertia, spin, torque at θ = 0, damping, stiffness, and gravity's A and B."""

    inertia: float
    spin: float
    torque: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    cosine: float = 0.0
    sine: float = 0.0

    @property
    def pull(self) -> float:
        """The largest torque of the weight, N m."""
        return math.hypot(self.cosine, self.sine)

    def acceleration(self, angle: Float, rate: Float) -> Float:
        """Return θ̈ (n,) rad/s²."""
        pull = self.cosine * np.cos(angle) + self.sine * np.sin(angle)
        return np.asarray((self.torque - self.damping * rate - self.stiffness * angle + pull) / self.inertia)
