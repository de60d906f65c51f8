"""Symmetric-top splitting on the rotation group: every part of a step is a rotation or a kick, and is exact.

The kinetic energy is that of a symmetric top (moments I₂, I₂, I₃) and what is left of axis 1,

    ½ ω·I ω = [½ M₁²/I₂ + ½ M₂²/I₂ + ½ M₃²/I₃] + ½ (1/I₁ − 1/I₂) M₁²,    M = I ω,

with the axes taken so that |1/I₁ − 1/I₂| is least. The top turns by M t/I₂ about M and then by (1/I₃ − 1/I₂) M₃ t about
axis 3; the rest turns the body about axis 1; loads change ω while the attitude stands (with damping, exactly). |L| is
kept to rounding where no load acts, and the energy error of a conservative load does not grow.
Dullweber, Leimkuhler & McLachlan, J. Chem. Phys. 107 (1997) 5840; Fassò, J. Comput. Phys. 189 (2003) 527;
orders from `compositions`. The state is ω, not M, so that slender bodies keep their digits.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float, Int
from inertia.dynamics.integrators.base import FixedStep, Scaled, States, begin, pieces, standard
from inertia.dynamics.integrators.compositions import BY_ORDER
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import torque
from inertia.dynamics.kinematics import quaternion
from inertia.errors import UsageError
from inertia.native import Kernel

_KERNEL = Kernel("inertia.dynamics.integrators.stepping_kernel", "split", "ppipppipip")

STAGE_COST = 500
"""A stage of the numpy path in units of `native.Kernel.worthwhile`."""


class Splitting(FixedStep):
    """The splitting of order 2, 4, 6 or 8; every load but dissipation and callables."""

    def __init__(self, order: int) -> None:
        self.name = f"splitting {order}"
        self.order = order
        self.pairs = BY_ORDER[order]

    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time`."""
        if standard(problem, problem.start).dissipation:
            raise UsageError(f"{self.name} has no exact flow for internal dissipation: use Taylor or DOP853")
        order = _axes(problem.moments)
        columns = np.eye(3)[:, order]
        taken = quaternion.from_matrix(columns)
        state = begin(problem, level)
        state = np.concatenate([quaternion.multiply(state[:4], taken), state[4:][order] / problem.rate])
        out = np.empty((len(time), 7))
        out[time <= problem.start] = state
        total = 0
        for piece in pieces(problem, time):
            scaled = Scaled.of(problem, piece, time, tuple(order))
            lengths = np.diff(scaled.targets, prepend=0.0) / problem.rate
            counts = self.counts(lengths, control, level)
            found = np.empty((len(scaled.targets), 7))
            _advance(scaled, state, counts, self.pairs, found)
            total += int(counts.sum())
            out[piece.first : piece.last] = found[:-1]
            state = found[-1]
        attitude = quaternion.normalise(quaternion.multiply(out[:, :4], quaternion.conjugate(taken)))
        spin = np.empty((len(time), 3))
        spin[:, order] = out[:, 4:] * problem.rate
        return States(attitude, spin, total)


def _axes(moments: Float) -> list[int]:
    """Return the axes in cyclic order, the first two having the nearest 1/I."""
    inverse = 1.0 / moments
    apart = [abs(inverse[(k + 1) % 3] - inverse[(k + 2) % 3]) for k in range(3)]
    k = int(np.argmin(apart))
    return [(k + 1) % 3, (k + 2) % 3, k]


def _advance(scaled: Scaled, state: Float, counts: Int, pairs: Float, out: Float) -> None:
    if not _KERNEL.worthwhile(int(counts.sum()) * len(pairs) * STAGE_COST):
        _advance_numpy(scaled, state, counts, pairs, out)
        return
    arrays = scaled.moments, scaled.packed, state, scaled.targets, counts, pairs, out
    moments, packed, at, targets, steps, stages, to = (array.ctypes.data for array in arrays)
    _KERNEL.function(moments, packed, scaled.vectors, at, targets, steps, len(counts), stages, len(pairs), to)


def _advance_numpy(scaled: Scaled, state: Float, counts: Int, pairs: Float, out: Float) -> None:
    """Do what the kernel does, a flow at a time."""
    a, b, c = scaled.moments.tolist()
    q, w = np.array(state[:4]), np.array(state[4:])
    loaded = bool(scaled.packed[:9].any()) or scaled.vectors > 0
    begin = 0.0
    for sample, (end, count) in enumerate(zip(scaled.targets.tolist(), counts.tolist(), strict=True)):
        step = (end - begin) / count if count else 0.0
        for number in range(count):
            time = begin + number * step
            for first, second in (pairs * step).tolist():
                if loaded:
                    w = _kick(scaled, time, q, w, first)
                q, w = _about(0, q, w, scaled.moments, first * w[0] * (b - a) / b)
                along = np.array([w[0] * a / b, w[1], w[2] * c / b])
                q = quaternion.multiply(q, quaternion.from_rotation_vector((first + second) * along))
                q, w = _about(2, q, w, scaled.moments, (first + second) * w[2] * (b - c) / b)
                q, w = _about(0, q, w, scaled.moments, second * w[0] * (b - a) / b)
                time += first + second
                if loaded:
                    w = _kick(scaled, time, q, w, second)
            q = quaternion.normalise(q)
        begin = end
        out[sample, :4], out[sample, 4:] = q, w


def _about(axis: int, q: Float, w: Float, moments: Float, angle: float) -> tuple[Float, Float]:
    """Turn the body by `angle` about one of its axes; L stays in space."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    s, c = math.sin(angle), math.cos(angle)
    turned = w.copy()
    turned[i] = c * w[i] + s * moments[j] / moments[i] * w[j]
    turned[j] = c * w[j] - s * moments[i] / moments[j] * w[i]
    half = np.zeros(4)
    half[axis], half[3] = math.sin(0.5 * angle), math.cos(0.5 * angle)
    return quaternion.multiply(q, half), turned


def _kick(scaled: Scaled, time: float, q: Float, w: Float, step: float) -> Float:
    """Let the torque at a standing attitude act, and the damping with it."""
    pull = torque(scaled.packed, time, q)
    z = scaled.packed[6:9] * step / scaled.moments
    share = np.array([-math.expm1(-x) / x if x else 1.0 for x in z.tolist()])
    kicked: Float = w * np.exp(-z) + pull / scaled.moments * step * share
    return kicked
