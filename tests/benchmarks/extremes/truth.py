"""Exact answers by rational arithmetic, and how far an answer is from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from inertia_meshes import rational

from .answers import Answer

DIGITS = 80
CHUNK = 50_000
"""Triangles at a time: their coordinates become Python integers."""


@dataclass(frozen=True, eq=False)
class Truth:
    """Exact moments of a body of unit density, and its size: its largest extent."""

    moments: rational.Moments
    size: float

    @staticmethod
    def of(corners: NDArray[np.float64]) -> Truth:
        """Return the exact answer for triangles (n, 3, 3) as they are stored."""
        parts = (rational.moments(corners[start : start + CHUNK]) for start in range(0, len(corners), CHUNK))
        return Truth(sum(parts, rational.NOTHING), float(np.ptp(corners.reshape(-1, 3), axis=0).max()))

    def weighed(self, metres: Fraction, density: Fraction) -> Truth:
        """Return the moments of mass, in kg and metres, for coordinates in a unit of `metres`."""
        moments = self.moments.scaled(metres, metres, metres).weighted(density)
        return Truth(moments, float(Fraction(self.size) * metres))

    @cached_property
    def spectrum(self) -> tuple[Any, Any]:
        """Principal moments, ascending, as parts of the largest element of the tensor, and axes (columns)."""
        with mpmath.workdps(DIGITS):
            tensor = mpmath.matrix([[_mpf(x / self.largest) for x in row] for row in self.moments.inertia])
            values, vectors = mpmath.eigsy(tensor)
            return list(values), vectors

    @property
    def largest(self) -> Fraction:
        """The largest element of the tensor."""
        return max(abs(x) for row in self.moments.inertia for x in row)

    def moment_error(self, value: float, k: int) -> Any:
        """Return how far a principal moment is from the true one, as a part of the tensor's largest element."""
        with mpmath.workdps(DIGITS):
            return abs(_mpf(Fraction(value) / self.largest) - self.spectrum[0][k])

    def angle(self, axis: Sequence[float], k: int) -> float:
        """Return the angle between an axis and the true one, either way round."""
        with mpmath.workdps(DIGITS):
            a, b = [mpmath.mpf(x) for x in axis], self.spectrum[1][:, k]
            normal = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
            return float(mpmath.asin(min(mpmath.mpf(1), mpmath.norm(normal) / mpmath.norm(a))))


def errors(answer: Answer, truth: Truth) -> dict[str, float]:
    """Return the errors: of volume, tensor (Frobenius) and smallest moment relative, of the centre over the size."""
    exact = truth.moments
    result = {"volume": float(abs(Fraction(answer.volume) / exact.volume - 1))}
    if answer.center is not None:
        size = Fraction(truth.size)
        off = [(Fraction(a) - b) / size for a, b in zip(answer.center.tolist(), exact.center_of_mass, strict=True)]
        result["centre"] = _root(sum((k * k for k in off), Fraction(0)))
    if answer.inertia is not None:
        true = [x for row in exact.inertia for x in row]
        off = [Fraction(a) - b for a, b in zip(answer.inertia.ravel().tolist(), true, strict=True)]
        result["tensor"] = _root(Fraction(sum(k * k for k in off), sum(k * k for k in true)))
    if answer.moments is not None:
        result["smallest moment"] = float(truth.moment_error(float(answer.moments[0]), 0) / truth.spectrum[0][0])
    return result


def lost(meant: rational.Moments, truth: Truth) -> dict[str, float]:
    """Return how far the stored body is from the one that was meant, in the terms of `errors`."""
    stored, size = truth.moments, Fraction(truth.size)
    centre = [(a - b) / size for a, b in zip(stored.center_of_mass, meant.center_of_mass, strict=True)]
    true = [x for row in meant.inertia for x in row]
    off = [a - b for a, b in zip((x for row in stored.inertia for x in row), true, strict=True)]
    ideal = Truth(meant, truth.size)
    with mpmath.workdps(DIGITS):
        moment = truth.spectrum[0][0] * _mpf(truth.largest / ideal.largest) / ideal.spectrum[0][0] - 1
    return {
        "volume": float(abs(stored.volume / meant.volume - 1)),
        "centre": _root(sum((k * k for k in centre), Fraction(0))),
        "tensor": _root(sum((k * k for k in off), Fraction(0)) / sum(k * k for k in true)),
        "smallest moment": float(abs(moment)),
    }


def _mpf(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def _root(square: Fraction) -> float:
    """Return the square root of a rational whose float64 may be out of range."""
    if not square:
        return 0.0
    shift = (square.numerator.bit_length() - square.denominator.bit_length()) // 2
    return math.ldexp(math.sqrt(square / Fraction(4) ** shift), shift)
