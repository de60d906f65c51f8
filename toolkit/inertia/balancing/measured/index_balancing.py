"""Index balancing: the rotor's unbalance told apart from that of the arbor or adapter it is measured on.

The rotor is measured in several positions, turned by θₖ on the tooling. In the tooling's frame the machine shows
Mₖ = T + R e^{iθₖ}; two positions give both, more give a check as well. With a half turn: R = (M₁ − M₂)/2,
T = (M₁ + M₂)/2. Runout of the rotor's seat on the tooling turns with the tooling and counts as tooling; an error of the
seat that turns with the rotor cannot be told from the rotor (ISO 21940-14).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex
from inertia.errors import UsageError
from inertia.mass.tensor import array_of
from inertia.records import dataclass

_APART = 0.1  # smallest singular value over the largest: positions about 12° apart


@dataclass(frozen=True, eq=False)
class IndexBalance:
    """What belongs to the rotor and what to the tooling.

    Attributes
    ----------
    rotor : (...) kg·m, in each plane, from the rotor's zero mark
    tooling : (...) kg·m, from the tooling's zero mark
    scatter : (...) kg·m, root mean square of what neither explains, over the positions beyond two; None for two
    """

    rotor: Complex
    tooling: Complex
    scatter: Float | None


def index_balancing(measured: ArrayLike, positions: ArrayLike) -> IndexBalance:
    """Separate rotor and tooling by least squares.

    Parameters
    ----------
    measured : (n, ...) kg·m, the unbalance shown in each position, in each plane, from the tooling's zero mark
    positions : (n,) rad, by which the rotor's zero mark is ahead of the tooling's, in the sense of the angles

    Raises `UsageError` where the positions are fewer than two or too close.

    >>> split = index_balancing([4.0, -2.0], [0.0, np.pi])
    >>> round(split.rotor.real.item(), 12), round(split.tooling.real.item(), 12)
    (3.0, 1.0)
    """
    readings = complex_of(measured, "measured")
    if readings.ndim == 0 or len(readings) < 2:
        raise UsageError(
            "one position is given: rotor and tooling are told apart by two or more, best a half turn apart"
        )
    angles = array_of(positions, (len(readings),), "positions")
    matrix = np.stack([np.exp(1j * angles), np.ones(len(angles))], axis=1)
    singular = np.linalg.svd(matrix, compute_uv=False)
    if singular[1] < _APART * singular[0]:
        raise UsageError(
            f"the positions {np.degrees(angles).round(3).tolist()}° are too close to tell rotor and tooling apart: "
            "turn the rotor by more, best by a half turn"
        )
    flat = readings.reshape(len(readings), -1)
    solution = np.linalg.lstsq(matrix, flat, rcond=None)[0]
    rotor, tooling = (k.reshape(readings.shape[1:]) for k in solution)
    if len(readings) == 2:
        return IndexBalance(rotor, tooling, None)
    squares = np.sum(np.abs(flat - matrix @ solution) ** 2, axis=0) / (len(readings) - 2)
    return IndexBalance(rotor, tooling, np.sqrt(squares).reshape(readings.shape[1:]))
