"""Densities of the regions or bodies of a part: from numbers, materials or a weighed mass, and who said so.

The densities of materials are handbook mid-values, kg/m³ at room temperature. Alloys of one family differ by a few per
cent, so a density that matters is given as a number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from difflib import get_close_matches
from numbers import Integral
from typing import Literal, TypeVar

from inertia.errors import UsageError
from inertia.estimate import Estimate, float_of
from inertia.records import dataclass

T = TypeVar("T")
DensityFrom = Literal["option", "material", "mass", "file", "assumed"]

ASSUMED = 1000.0
"""kg/m³, water: what is taken, and said, where nobody states a density."""

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


@dataclass(frozen=True)
class Densities:
    """Densities, kg/m³: `default` for what `named` does not list, and the total `mass`, kg, if it was weighed.

    Those given as an `Estimate` keep its uncertainty. With a mass the densities count as proportions only. `default`
    is None where densities are given by name and none for the rest.
    """

    default: float | None
    named: Mapping[str, float]
    source: DensityFrom
    mass: float | None = None

    def of(self, name: str) -> float:
        """Return the density of a region or body; raise `UsageError` where none was given for it."""
        value = self.named.get(name, self.default)
        if value is None:
            raise UsageError(f"no density is given for {name!r}: give it one, or one without a name for the rest")
        return value


def densities(
    density: float | Mapping[str, float] | None = None,
    material: str | Mapping[str, str] | None = None,
    mass: float | None = None,
) -> Densities:
    """Resolve what the caller said; a mapping's keys name regions or bodies, and its key "" is the rest.

    Raises `UsageError` for a density or mass that is not positive and finite, an unknown material, or a
    contradiction.
    """
    named: dict[str, float] = {}
    materials, weights = _by_name(material, "material"), _by_name(density, "density")
    for key, name in materials.items():
        named[key] = density_of(name)
    for key, value in weights.items():
        if key in named:
            raise UsageError(f"both a density and a material are given{f' for {key!r}' if key else ''}: give one")
        named[key] = positive(value, f"density{f' of {key!r}' if key else ''}", "kg/m³")
    source: DensityFrom = "option" if weights else "material" if named else "assumed"
    if mass is not None:
        if [*named] == [""]:
            raise UsageError("both a mass and a density are given: give the one that was measured")
        mass = positive(mass, "mass", "kg")
        source = "mass"
    default = named.pop("", None if named else ASSUMED)
    return Densities(default, named, source, mass)


def _by_name(value: T | Mapping[str, T] | None, what: str) -> Mapping[str, T]:
    """Return what was said of each region or body by its name: the number of a body is its name too."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        return {"": value}
    named: dict[str, T] = {}
    for key, each in value.items():
        name = str(int(key)) if isinstance(key, Integral) and not isinstance(key, bool) else key
        if not isinstance(name, str):
            raise UsageError(f"the {what} of {key!r} is given: name a region by its text, a body by its number")
        if name in named:
            raise UsageError(f"the {what} of body {name} is given twice, by its number and as text: give one")
        named[name] = each
    return named


def number_of(value: float, name: str, unit: str) -> float:
    """Return a number, with its uncertainty, if it has one, infinite beyond float64; raises `UsageError` for all else.

    >>> number_of("heavy", "mass", "kg")
    Traceback (most recent call last):
    inertia.errors.UsageError: mass is 'heavy': it must be a number of kg
    """
    try:
        number = value if isinstance(value, Estimate) else float_of(value)
    except (TypeError, ValueError):
        number = None
    if number is None or isinstance(value, bool):
        raise UsageError(f"{name} is {value!r}: it must be a number of {unit}")
    return number


def positive(value: float, name: str, unit: str) -> float:
    """Return a positive, finite number, with its uncertainty, if it has one; raises `UsageError` for all else."""
    number = number_of(value, name, unit)
    if not (number > 0 and math.isfinite(number)):
        raise UsageError(f"{name} is {number:g} {unit}: it must be positive and finite")
    return number


def density_of(material: str) -> float:
    """Return the density of a material, kg/m³; raise `UsageError` for one that is not in the table.

    >>> density_of("steel")
    7850.0
    """
    key = str(material).strip().lower().replace(" ", "-").replace("_", "-")
    key = _ALIASES.get(key, key)
    if key not in DENSITIES:
        close = get_close_matches(key, [*DENSITIES, *_ALIASES], n=3)
        hint = f" (did you mean {' or '.join(close)}?)" if close else ""
        raise UsageError(
            f"unknown material {material!r}{hint}: use one of {', '.join(DENSITIES)}, or give a density in kg/m³",
            code="unknown_material",
        )
    return DENSITIES[key]
