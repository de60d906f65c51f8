"""What the catalogue says of a sample."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from inertia_meshes.rational import NOTHING, Moments, moments
from inertia_meshes.solids import Solid

Entry = dict[str, Any]
_METRES = Fraction(1, 1000)


def entry(description: str, solid: Solid, bodies: int, formula: str, source: str) -> Entry:
    """Return the entry of a part in millimetres; its corners are those in the file."""
    return {
        "description": description,
        "unit": "mm",
        "bodies": bodies,
        "triangles": len(solid.corners),
        "closed_form": _true(solid) | {"formula": formula, "source": source},
        "mesh": _answers(moments(solid.corners)),
    }


def assembly(
    description: str, parts: Mapping[str, Solid], densities: Mapping[str, int], formula: str, source: str
) -> Entry:
    """Return the entry of named parts in millimetres with a density (kg/m³) each."""
    together = Solid(
        np.concatenate([part.corners for part in parts.values()]),
        sum((p.true for p in parts.values()), NOTHING),
    )
    weighted = sum((part.true.weighted(densities[name]) for name, part in parts.items()), NOTHING)
    return entry(description, together, len(parts), formula, source) | {
        "parts": {
            name: {
                "density": densities[name],
                "closed_form": _true(part),
                "mesh": _answers(moments(part.corners)),
            }
            for name, part in parts.items()
        },
        "assembly": _answers(weighted.scaled(_METRES, _METRES, _METRES), "mass"),
    }


def _true(solid: Solid) -> Entry:
    return _answers(solid.true.scaled(_METRES, _METRES, _METRES))


def _answers(solid: Moments, zeroth: str = "volume") -> Entry:
    return {
        zeroth: float(solid.volume),
        "center_of_mass": [float(value) for value in solid.center_of_mass],
        "inertia": [[float(value) for value in row] for row in solid.inertia],
    }
