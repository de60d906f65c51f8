"""A body that betrays every mistake: askew, without symmetry, off the origin; its integrals in rational numbers."""

from fractions import Fraction
from pathlib import Path

import numpy as np

import inertia

DENSITY = 2700.0
CORNERS = [
    tuple(k / 0.7 for k in corner)  # so that results have all the digits there are
    for corner in ((0.31, -0.12, 0.55), (0.42, 0.05, 0.47), (0.18, 0.09, 0.66), (0.37, 0.16, 0.81))
]
FACES = [(1, 3, 2), (1, 2, 4), (2, 3, 4), (3, 1, 4)]

_V = [[Fraction(x) for x in corner] for corner in CORNERS]
_E = [[b - a for a, b in zip(_V[0], corner, strict=True)] for corner in _V[1:]]
_VOLUME = (
    sum(_E[0][i] * (_E[1][j] * _E[2][k] - _E[1][k] * _E[2][j]) for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))) / 6
)
MASS = Fraction(DENSITY) * _VOLUME
CENTRE = [sum(corner[i] for corner in _V) / 4 for i in range(3)]
# ∫x xᵀ dV of a tetrahedron about the origin: V/20 (Σ v vᵀ + s sᵀ), s = Σ v.
INTEGRALS = [
    [
        MASS * (sum(v[i] * v[j] for v in _V) + 16 * CENTRE[i] * CENTRE[j]) / 20 - MASS * CENTRE[i] * CENTRE[j]
        for j in range(3)
    ]
    for i in range(3)
]
"""∫x_i x_j dm about the centre of mass: what is positive where others carry a minus."""
MOMENTS = [sum(INTEGRALS[k][k] for k in range(3)) - INTEGRALS[i][i] for i in range(3)]
"""∫(y² + z²) dm and so on, about the centre of mass."""
TENSOR = np.array([[float(MOMENTS[i] if i == j else -INTEGRALS[i][j]) for j in range(3)] for i in range(3)])


def file(folder: Path) -> Path:
    """Write the body as OBJ, in metres."""
    path = folder / "upper arm.obj"
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in CORNERS] + [f"f {a} {b} {c}" for a, b, c in FACES]
    path.write_text("\n".join(lines) + "\n")
    return path


def properties(folder: Path) -> inertia.MassProperties:
    return inertia.mass_properties(inertia.read(file(folder), unit="m"), density=DENSITY)


def error(tensor: np.ndarray) -> float:
    """How far a tensor is from the exact one, relative to its Frobenius norm."""
    return float(np.linalg.norm(np.asarray(tensor) - TENSOR) / np.linalg.norm(TENSOR))
