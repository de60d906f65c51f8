"""Length units as exact rationals, so that a unit never costs a digit.

Coordinates are kept as stored; results are multiplied by a power of `Unit.metres` once.
"""

from __future__ import annotations

from difflib import get_close_matches
from fractions import Fraction
from typing import Literal

from inertia.errors import UsageError
from inertia.records import dataclass

UnitFrom = Literal["option", "file", "assumed"]


@dataclass(frozen=True)
class Unit:
    """A unit of length: its short name and its exact size in metres."""

    name: str
    metres: Fraction


_INCH = Fraction(254, 10_000)
_UNITS = {
    unit.name: unit
    for unit in (
        Unit("m", Fraction(1)),
        Unit("dm", Fraction(1, 10)),
        Unit("cm", Fraction(1, 100)),
        Unit("mm", Fraction(1, 1000)),
        Unit("um", Fraction(1, 10**6)),
        Unit("nm", Fraction(1, 10**9)),
        Unit("km", Fraction(1000)),
        Unit("in", _INCH),
        Unit("mil", _INCH / 1000),
        Unit("ft", 12 * _INCH),
        Unit("yd", 36 * _INCH),
    )
}
_ALIASES = {
    "meter": "m",
    "metre": "m",
    "decimeter": "dm",
    "decimetre": "dm",
    "centimeter": "cm",
    "centimetre": "cm",
    "millimeter": "mm",
    "millimetre": "mm",
    "micron": "um",
    "micrometer": "um",
    "micrometre": "um",
    "µm": "um",
    "nanometer": "nm",
    "nanometre": "nm",
    "kilometer": "km",
    "kilometre": "km",
    "inch": "in",
    "inches": "in",
    '"': "in",
    "thou": "mil",
    "foot": "ft",
    "feet": "ft",
    "yard": "yd",
}

DEFAULT_UNIT = _UNITS["mm"]
METRE = _UNITS["m"]
_NUMBER_LENGTH = 40
"""Characters in the number of a unit; a longer one states more digits than any unit has, or an endless exponent."""


def length_unit(name: str) -> Unit:
    """Return the unit called `name` (`"mm"`, `"inch"`, ...); raise `UsageError` for an unknown one.

    >>> length_unit("inch").metres
    Fraction(127, 5000)
    """
    key = str(name).strip()
    for candidate in (key, key.lower(), key.lower().removesuffix("s")):
        candidate = _ALIASES.get(candidate, candidate)
        if candidate in _UNITS:
            return _UNITS[candidate]
    close = get_close_matches(key.lower(), [*_UNITS, *_ALIASES], n=1)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    raise UsageError(f"unknown unit {name!r}: use one of {', '.join(_UNITS)}{hint}", code="unknown_unit")


def multiple_of(number: str, unit: Unit) -> Unit:
    """Return the unit that is exactly `number` times another, under its own name where it has one.

    Raises `UsageError` where the number is none, or none that a unit may have.

    >>> multiple_of("2.54e-2", METRE).name, multiple_of("0.3", METRE).name
    ('in', '0.3 m')
    """
    text = number.strip()
    try:
        if len(text) > _NUMBER_LENGTH or not 1e-15 < float(text) < 1e15:
            raise ValueError
        metres = Fraction(text) * unit.metres
    except ValueError:
        raise UsageError(f"a unit of {text[:_NUMBER_LENGTH]!r} {unit.name} is no length", code="unknown_unit") from None
    return unit_of(metres) or Unit(f"{text} {unit.name}", metres)


def scaled(unit: Unit, factor: Fraction) -> Unit:
    """Return the unit that is a factor times another, under its own name where it has one.

    Otherwise its name stands in brackets, so that it may have an exponent.

    >>> scaled(METRE, Fraction(1, 1000)).name, scaled(METRE, Fraction(3, 10)).name
    ('mm', '(0.3 m)')
    """
    metres = factor * unit.metres
    return unit_of(metres) or Unit(f"({float(factor):g} {unit.name})", metres)


def unit_of(metres: Fraction) -> Unit | None:
    """Return the unit of so many metres that has a name of its own; None where there is none."""
    return next((each for each in _UNITS.values() if each.metres == metres), None)
