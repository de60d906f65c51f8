"""Mass properties of closed meshes in integers: triangles of binary fractions, each a tetrahedron with the origin."""

from __future__ import annotations

import struct
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from mpmath import mpf

from inertia_meshes import path

from .rigid import Body, principal

UNIT = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "in": Fraction(254, 10000)}


def write_stl(file: Path, triangles: np.ndarray) -> None:
    """Write triangles (n, 3, 3), float32, as binary STL."""
    rows = b"".join(bytes(12) + np.asarray(each, dtype="<f4").tobytes() + bytes(2) for each in triangles)
    file.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + rows)


@cache
def sample(name: str) -> np.ndarray:
    """Return the triangles (n, 3, 3) of a sample part."""
    data = Path(path(name)).read_bytes()
    count = struct.unpack("<I", data[80:84])[0]
    rows = np.frombuffer(data[84:], dtype=np.uint8).reshape(count, 50)[:, 12:48]
    return np.frombuffer(rows.tobytes(), dtype="<f4").reshape(count, 3, 3)


@cache
def _sample_moments(name: str) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    return moments(sample(name))


def moments(triangles: np.ndarray) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    """Return volume, ∫ x dV and ∫ x xᵀ dV of float32 triangles (n, 3, 3), exactly."""
    flat = np.asarray(triangles, dtype=np.float64)
    least = np.abs(flat[flat != 0]).min()
    bits = 24 - int(np.floor(np.log2(least)))
    numbers = [[[int(Fraction(x) * 2**bits) for x in point] for point in each] for each in flat.tolist()]
    volume, first, second = 0, [0] * 3, [[0] * 3 for _ in range(3)]
    for a, b, c in numbers:
        det = (
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
        total = [x + y + z for x, y, z in zip(a, b, c, strict=True)]
        volume += det
        for i in range(3):
            first[i] += det * total[i]
            for j in range(i, 3):
                second[i][j] += det * (total[i] * total[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j])
    unit = Fraction(1, 2**bits)
    for i in range(3):
        for j in range(i):
            second[i][j] = second[j][i]
    return (
        Fraction(volume, 6) * unit**3,
        [Fraction(x, 24) * unit**4 for x in first],
        [[Fraction(x, 120) * unit**5 for x in row] for row in second],
    )


def body_of(table: dict[str, Any], triangles: np.ndarray | None, axes: np.ndarray) -> Body:
    """Return the body that a scene takes from a part: a sample by its name, or these triangles."""
    volume, first, second = _sample_moments(Path(table["part"]).name) if triangles is None else moments(triangles)
    f = UNIT[table["unit"]]
    density = Fraction(table["mass"]) / (volume * f**3) if "mass" in table else Fraction(table["density"])
    center = [x / volume for x in first]
    spread = [[density * f**5 * (second[i][j] - first[i] * center[j]) for j in range(3)] for i in range(3)]
    trace = spread[0][0] + spread[1][1] + spread[2][2]
    inertia = mpmath.matrix([[_real((trace if i == j else 0) - spread[i][j]) for j in range(3)] for i in range(3)])
    return Body(_real(density * volume * f**3), [_real(x * f) for x in center], inertia, principal(inertia, axes)[1])


def _real(x: Fraction) -> Any:
    return mpf(x.numerator) / mpf(x.denominator)
