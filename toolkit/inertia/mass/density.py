"""Densities of the regions or bodies of a part: from numbers, materials or a weighed mass, and who said so."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeVar

from inertia.errors import UsageError
from inertia.mass.materials import density_of

T = TypeVar("T")
DensityFrom = Literal["option", "material", "mass", "file", "assumed"]

ASSUMED = 1000.0
"""kg/m³, water: what is taken, and said, where nobody states a density."""


@dataclass(frozen=True)
class Densities:
    """Densities, kg/m³: `default` for what `named` does not list, and the total `mass`, kg, if it was weighed.

    With a mass the densities count as proportions only. `default` is None where densities are given by name and
    none for the rest.
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
    for key, name in _mapping(material).items():
        named[key] = density_of(name)
    for key, value in _mapping(density).items():
        if key in named:
            raise UsageError(f"both a density and a material are given{f' for {key!r}' if key else ''}: give one")
        named[key] = _positive(value, f"density{f' of {key!r}' if key else ''}", "kg/m3")
    source: DensityFrom = "option" if _mapping(density) else "material" if named else "assumed"
    if mass is not None:
        if "" in named:
            raise UsageError("both a mass and a density are given: give the one that was measured")
        mass = _positive(mass, "mass", "kg")
        source = "mass"
    default = named.pop("", None if named else ASSUMED)
    return Densities(default, named, source, mass)


def _mapping(value: T | Mapping[str, T] | None) -> Mapping[str, T]:
    if value is None:
        return {}
    return value if isinstance(value, Mapping) else {"": value}


def _positive(value: float, name: str, unit: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{name} is {value!r}: it must be a number of {unit}") from None
    if not (number > 0 and math.isfinite(number)):
        raise UsageError(f"{name} is {number:g} {unit}: it must be positive and finite")
    return number
