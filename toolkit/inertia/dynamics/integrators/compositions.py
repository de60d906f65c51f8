"""Coefficients of symmetric compositions of a first-order splitting and its adjoint.

A table (s, 2) holds the lengths (a, b), in steps, of the pairs Φ*(a h) Φ(b h) that a step is made of, Φ being the flows
of the parts one after the other and Φ* the same in the opposite order. The lengths sum to one and read the same
backwards.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float


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

BY_ORDER = {2: STRANG, 4: BLANES_MOAN_4, 6: BLANES_MOAN_6, 8: KAHAN_LI_8}
