"""Symmetric-top splitting on the rotation group: every part of a step is a rotation or a kick, and is exact.

The kinetic energy is that of a symmetric top (moments I₂, I₂, I₃) and what is left of axis 1,

    ½ ω·I ω = [½ M₁²/I₂ + ½ M₂²/I₂ + ½ M₃²/I₃] + ½ (1/I₁ − 1/I₂) M₁²,    M = I ω,

with the axes taken so that |1/I₁ − 1/I₂| is least. The top turns by M t/I₂ about M and then by (1/I₃ − 1/I₂) M₃ t about
axis 3; the rest turns the body about axis 1; loads change ω while the attitude stands (with damping, exactly). |L| is
kept to rounding where no load acts, and the energy error of a conservative load does not grow.
Dullweber, Leimkuhler & McLachlan, J. Chem. Phys. 107 (1997) 5840; Fassò, J. Comput. Phys. 189 (2003) 527;
orders from symmetric compositions, below. The state is ω, not M, so that slender bodies keep their digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.error_control import FixedStep
from inertia.dynamics.integrators.loop import Call, Piece, Units
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import torque
from inertia.dynamics.kinematics import quaternion
from inertia.errors import UsageError
from inertia.native import Kernel, address

_KERNEL = Kernel("inertia.dynamics.integrators.stepping_kernel", "split", "ppipidddipppi")

STAGE_COST = 500
"""A stage of the numpy path in units of `native.Kernel.worthwhile`."""


def _of_symmetric(lengths: list[float]) -> Float:
    """Pairs of equal halves, from the first half of the lengths of Strang steps and the middle one."""
    whole = np.array([*lengths, *lengths[-2::-1]])
    whole[len(lengths) - 1] = 1.0 - 2.0 * whole[: len(lengths) - 1].sum()
    return np.repeat(0.5 * whole[:, None], 2, axis=1)


def _of_splitting(a: list[float], b: list[float]) -> Float:
    """Pairs from the lengths of e^{a₁A} e^{b₁B} e^{a₂A} …: a₁ = α₁, b₁ = α₁ + α₂, a₂ = α₂ + α₃, …

    McLachlan, SIAM J. Sci. Comput. 16 (1995) 151: two flows and a flow with its adjoint obey the same conditions.
    """
    whole_b = [*b, 0.5 - sum(b)]
    alphas = [a[0]]
    for i, length in enumerate(whole_b):
        alphas.append(length - alphas[-1])
        if i + 1 < len(a):
            alphas.append(a[i + 1] - alphas[-1])
    half = alphas[: len(whole_b) * 2]
    return np.array([*half, *half[::-1]]).reshape(-1, 2)


STRANG = np.array([[0.5, 0.5]])
"""Order 2. Strang, SIAM J. Numer. Anal. 5 (1968) 506."""

BLANES_MOAN_4 = _of_splitting(
    [0.0792036964311957, 0.353172906049774, -0.0420650803577195],
    [0.209515106613362, -0.143851773179818],
)
"""Order 4, six stages: S6 of Blanes & Moan, J. Comput. Appl. Math. 142 (2002) 313, table 2."""

BLANES_MOAN_6 = _of_splitting(
    [0.0502627644003922, 0.413514300428344, 0.0450798897943977, -0.188054853819569, 0.541960678450780],
    [0.148816447901042, -0.132385865767784, 0.067307604692185, 0.432666402578175],
)
"""Order 6, ten stages: S10 of Blanes & Moan, table 2."""

KAHAN_LI_8 = _of_symmetric(
    [
        0.13020248308889008087881763,
        0.56116298177510838456196441,
        -0.38947496264484728640807860,
        0.15884190655515560089621075,
        -0.39590389413323757733623154,
        0.18453964097831570709183254,
        0.25837438768632204729397911,
        0.29501172360931029887096624,
        -0.60550853383003451169892108,
    ]
)
"""Order 8, seventeen Strang steps: s17odr8a of Kahan & Li, Math. Comput. 66 (1997) 1089."""

COMPOSITIONS = {2: STRANG, 4: BLANES_MOAN_4, 6: BLANES_MOAN_6, 8: KAHAN_LI_8}
"""Coefficients of symmetric compositions of a first-order splitting and its adjoint, by their order.

A table (s, 2) holds the lengths (a, b), in steps, of the pairs Φ*(a h) Φ(b h) that a step is made of, Φ being the flows
of the parts one after the other and Φ* the same in the opposite order. The lengths sum to one and read the same
backwards.
"""


class Splitting(FixedStep):
    """The splitting of order 2, 4, 6 or 8; every load but dissipation and callables."""

    def __init__(self, order: int) -> None:
        self.name = f"splitting {order}"
        self.order = order
        self.pairs = COMPOSITIONS[order]

    def axes(self, problem: RotationProblem) -> tuple[int, ...]:
        """Return the axes in cyclic order, the first two having the nearest 1/I."""
        if Units.of(problem, problem.start).packed[9]:
            raise UsageError(f"{self.name} has no exact flow for internal dissipation: use Taylor or DOP853")
        inverse = 1.0 / problem.moments
        apart = [abs(inverse[(k + 1) % 3] - inverse[(k + 2) % 3]) for k in range(3)]
        k = int(np.argmin(apart))
        return (k + 1) % 3, (k + 2) % 3, k

    def compiled(self, piece: Piece, control: float, level: int) -> Call | None:
        """Return the kernel where the stages are many."""
        counts = self.counts(piece, control, level)
        if not _KERNEL.worthwhile(int(counts.sum()) * len(self.pairs) * STAGE_COST):
            return None
        return Call(_KERNEL, piece.units.figures, (address(counts), address(self.pairs), len(self.pairs)), (counts,))

    def step(self, piece: Piece) -> Callable[[float, float, Float], Float]:
        """Do what the kernel does, a flow at a time."""
        units = piece.units
        a, b, c = units.moments.tolist()
        loaded = bool(units.packed[:9].any()) or units.vectors > 0

        def advance(time: float, step: float, state: Float) -> Float:
            q, w = state[:4], state[4:]
            for first, second in (self.pairs * step).tolist():
                if loaded:
                    w = _kick(units, time, q, w, first)
                q, w = _about(0, q, w, units.moments, first * w[0] * (b - a) / b)
                along = np.array([w[0] * a / b, w[1], w[2] * c / b])
                q = quaternion.multiply(q, quaternion.from_rotation_vector((first + second) * along))
                q, w = _about(2, q, w, units.moments, (first + second) * w[2] * (b - c) / b)
                q, w = _about(0, q, w, units.moments, second * w[0] * (b - a) / b)
                time += first + second
                if loaded:
                    w = _kick(units, time, q, w, second)
            return np.concatenate([quaternion.normalise(q), w])

        return advance


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


def _kick(units: Units, time: float, q: Float, w: Float, step: float) -> Float:
    """Let the torque at a standing attitude act, and the damping with it."""
    pull = torque(units.packed, time, q)
    z = units.packed[6:9] * step / units.moments
    share = np.array([-math.expm1(-x) / x if x else 1.0 for x in z.tolist()])
    kicked: Float = w * np.exp(-z) + pull / units.moments * step * share
    return kicked
