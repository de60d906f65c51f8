"""Densities of common engineering materials, kg/m³ at room temperature: handbook mid-values.

Alloys of one family differ by a few per cent, so a density that matters is given as a number.
"""

from __future__ import annotations

from difflib import get_close_matches

from inertia.errors import UsageError

DENSITIES = {
    "abs": 1050.0,
    "acetal": 1410.0,
    "alumina": 3950.0,
    "aluminium": 2700.0,
    "brass": 8500.0,
    "bronze": 8800.0,
    "carbon-fibre": 1600.0,
    "cast-iron": 7200.0,
    "concrete": 2400.0,
    "copper": 8960.0,
    "glass": 2500.0,
    "gold": 19300.0,
    "ice": 917.0,
    "lead": 11340.0,
    "magnesium": 1740.0,
    "nickel": 8900.0,
    "nylon": 1140.0,
    "oak": 700.0,
    "peek": 1320.0,
    "petg": 1270.0,
    "pine": 500.0,
    "pla": 1240.0,
    "polycarbonate": 1200.0,
    "polyethylene": 950.0,
    "ptfe": 2200.0,
    "silicon": 2330.0,
    "silver": 10490.0,
    "stainless": 8000.0,
    "steel": 7850.0,
    "titanium": 4430.0,
    "tungsten": 19300.0,
    "water": 1000.0,
    "zinc": 7140.0,
}
_ALIASES = {
    "aluminum": "aluminium",
    "iron": "cast-iron",
    "pom": "acetal",
    "stainless-steel": "stainless",
    "carbon-fiber": "carbon-fibre",
}


def density_of(material: str) -> float:
    """Return the density of a material, kg/m³; raise `UsageError` for one that is not in the table.

    >>> density_of("steel")
    7850.0
    """
    key = material.strip().lower().replace(" ", "-").replace("_", "-")
    key = _ALIASES.get(key, key)
    if key not in DENSITIES:
        close = get_close_matches(key, [*DENSITIES, *_ALIASES], n=3)
        hint = f" (did you mean {' or '.join(close)}?)" if close else ""
        raise UsageError(
            f"unknown material {material!r}{hint}: use one of {', '.join(DENSITIES)}, or give a density in kg/m3"
        )
    return DENSITIES[key]
