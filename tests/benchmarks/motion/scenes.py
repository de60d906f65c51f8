"""The motions that are measured, and where they truly end, to 28 digits and more."""

from __future__ import annotations

import functools
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
from tests.dynamics import oracle
from tests.dynamics.models.free import free_oracle

DIGITS = 60

EXACT = 10
"""Revolutions of a loaded motion that the oracle in integers follows, to 50 digits; more take it minutes."""

TRUTHS = Path(__file__).with_name("truths.json")
"""Ends of longer ones, to 28 digits and more: `tests.benchmarks.motion.truths` makes them."""


@dataclass(frozen=True)
class Weight:
    """Gravity about a fixed point: kg, m (along the principal axes), m/s² in space."""

    mass: float
    offset: tuple[float, float, float]
    gravity: tuple[float, float, float]


@dataclass(frozen=True)
class Drive:
    """Constant torques in N m, of the body and of space, and damping in N m s about each axis."""

    body: tuple[float, float, float]
    space: tuple[float, float, float]
    damping: tuple[float, float, float]


@dataclass(frozen=True)
class Motion:
    """A body that starts from the identity attitude; `revolutions` of |ω| at the start are the durations."""

    name: str
    moments: tuple[float, float, float]
    spin: tuple[float, float, float]
    revolutions: tuple[int, ...]
    weight: Weight | None = None
    drive: Drive | None = None

    @property
    def free(self) -> bool:
        """Whether nothing turns the body."""
        return self.weight is None and self.drive is None

    def duration(self, revolutions: int) -> float:
        """Return how long so many revolutions take, s."""
        return 2 * math.pi * revolutions / math.dist((0, 0, 0), self.spin)

    def error(self, revolutions: int, attitude: Any) -> float:
        """Return by what angle in rad an attitude (4,) at the end is off: π where a method has lost it altogether."""
        if not 0.0 < np.linalg.norm(attitude) < np.inf:
            return math.pi
        with mp.workdps(DIGITS):
            truth = _truth(self, revolutions)
            return free_oracle.angle(free_oracle.matrix(np.asarray(attitude).tolist()), truth)


def end(motion: Motion, revolutions: int) -> Any:
    """Return the quaternion at the end of a loaded motion: by the oracle in integers, or what it has told before."""
    if revolutions > EXACT:
        table = json.loads(TRUTHS.read_text(encoding="utf-8"))
        return [mp.mpf(x) for x in table[motion.name][str(revolutions)]]
    loads: dict[str, Any] = {}
    if motion.weight:
        loads |= {"mass": motion.weight.mass, "offset": motion.weight.offset, "gravity": motion.weight.gravity}
    if motion.drive:
        drive = motion.drive
        loads |= {"body_torque": drive.body, "space_torque": drive.space, "damping": drive.damping}
    instant = [motion.duration(revolutions)]
    return oracle.rotate(motion.moments, motion.spin, instant, digits=50, **loads).attitude[0]


@functools.cache
def _truth(motion: Motion, revolutions: int) -> Any:
    if motion.free:
        instant = [motion.duration(revolutions)]
        return free_oracle.free_top(motion.moments, motion.spin, instant, DIGITS)[0][0]
    return free_oracle.matrix(end(motion, revolutions))


def _next_to_separatrix(distance: float) -> tuple[float, float, float]:
    """Return a spin of the body (1, 2, 3) with L² = 2 T I₂ (1 + distance), but for rounding."""
    w1, w2 = 1.0, 0.7
    square = w1**2 + 4 * w2**2
    return w1, w2, math.sqrt((w1**2 + distance * square) / (3 - 9 * distance))


MOTIONS = (
    Motion("free asymmetric top", (1.0, 2.0, 3.0), (1.0, 0.5, 0.3), (10, 1000, 100_000)),
    Motion("T-handle that flips", (1.96e-6, 7.32e-6, 8.93e-6), (0.001, 10.0, 0.0), (10, 1000)),
    Motion("1e-8 from the separatrix", (1.0, 2.0, 3.0), _next_to_separatrix(1e-8), (10, 1000)),
    Motion("1e-12 from the separatrix", (1.0, 2.0, 3.0), _next_to_separatrix(1e-12), (10, 1000)),
    Motion("needle", (1e-8, 1.0, 1.000000005), (1.0, 0.02, 0.01), (10, 1000)),
    Motion(
        "heavy asymmetric top",
        (1.0, 2.0, 2.75),
        (1.0, 0.5, 6.0),
        (10, 1000, 100_000),
        weight=Weight(0.5, (0.1, 0.2, 0.3), (0.0, 0.0, -9.8)),
    ),
    Motion(
        "torque and damping",
        (1.0, 2.0, 2.75),
        (1.0, 0.5, 2.0),
        (10, 1000, 100_000),
        drive=Drive((0.1, -0.2, 0.05), (0.2, 0.1, 0.3), (0.1, 0.2, 0.15)),
    ),
)
