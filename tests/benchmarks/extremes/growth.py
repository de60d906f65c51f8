"""How much larger than the error the float64 bound is, as meshes grow: wavy tori, turned, against exact integers."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh.surface import Surface, Triangles
from inertia_meshes import rational

from ..meshes import wavy_torus
from .rungs import properties, ratios
from .truth import Truth

COUNTS = (100, 500, 1_000, 10_000, 100_000, 1_000_000)
BODIES = 15
QUANTITIES = ("volume", "centre of mass", "tensor", "principal moments")


def growth() -> list[dict[str, Any]]:
    """Return for each size {"triangles": n, "ratios": {quantity: [bound over error, each]}}."""
    rng = np.random.default_rng(0)
    rows = []
    for count in COUNTS:
        vertices, faces = wavy_torus(count)
        result: dict[str, list[float]] = {quantity: [] for quantity in QUANTITIES}
        for _ in range(BODIES):
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            triangles = Surface(vertices @ turn * rng.uniform(0.5, 1), faces)
            values = ratios(properties(solid_moments(triangles, "float64"), "float64"), _truth(triangles), Fraction(1))
            for quantity in QUANTITIES:
                result[quantity] += values[quantity]
        rows.append({"triangles": len(faces), "ratios": result})
    return rows


def _truth(triangles: Triangles) -> Truth:
    """Return what the exact rung answers, far sooner than rational arithmetic would."""
    result = solid_moments(triangles, "exact").about((Fraction(0),) * 3)
    moments = rational.Moments(result.zeroth, result.first, result.second)
    return Truth(moments, float(np.ptp(triangles.corners().reshape(-1, 3), axis=0).max()))
