"""`Estimate`: a number with its standard uncertainty, as ``7850±50`` is read (JCGM 100:2008, GUM)."""

from __future__ import annotations

import math
import re
from numbers import Real
from typing import Any, Self

from inertia.errors import UsageError

UNDECODED = "±".encode().decode("ascii", "surrogateescape")
"""± as arguments of the command line hold it where the locale is C."""

_SIGN = re.compile(rf"\s*(?:±|{UNDECODED}|\+/-|\+-)\s*")


class Estimate(float):
    """A number with its standard uncertainty u: everywhere a number is taken, it counts as that number.

    A tolerance of half-width a, of which nothing more is known, has u = a/√3 (GUM 4.3.7).

    Parameters
    ----------
    value : the number
    uncertainty : u, in the same unit

    >>> steel = Estimate.parse("7850±0.5%")
    >>> steel, steel.uncertainty
    (Estimate(7850.0, 39.25), 39.25)
    >>> steel + 0.0
    7850.0
    """

    uncertainty: float

    def __new__(cls, value: float, uncertainty: float = 0.0) -> Self:
        """Make one; raise `UsageError` where either is no number, or the uncertainty none of any."""
        if not is_number(value):
            raise UsageError(f"an estimate is {value!r}: it must be a number; Estimate.parse reads text")
        estimate = super().__new__(cls, float_of(value))
        if not (is_number(uncertainty) and 0 <= float_of(uncertainty) < math.inf):
            raise UsageError(f"a standard uncertainty is {uncertainty!r}: it must be finite and not negative")
        estimate.uncertainty = float(uncertainty)
        return estimate

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read ``7850``, ``7850±50``, ``7850+-50``, ``7850 +/- 50`` or ``7850±0.6%``; raise `UsageError` for others.

        Whoever takes the number judges its size, and whether it is finite: ``inf`` is one as for Python.
        """
        number, sign, after = (_SIGN.sub("±", str(text).strip(), count=1)).partition("±")
        try:
            value = float(number)
            share = after.endswith("%")
            size = float(after.removesuffix("%")) if sign else 0.0
        except ValueError:
            raise UsageError(f"{text!r} is no number, nor one with its standard uncertainty as 7850±50") from None
        return cls(value, abs(value) * size / 100 if share else size)

    def __repr__(self) -> str:
        """Return the call that makes it."""
        return f"Estimate({float(self)!r}, {self.uncertainty!r})"

    __str__ = float.__repr__

    def __getnewargs__(self) -> tuple[float, float]:  # type: ignore[override]  # so that copies keep the uncertainty
        """Return what a copy is made of."""
        return float(self), self.uncertainty


def is_number(value: Any) -> bool:
    """Whether a value is a number, of Python or numpy: neither text, nor true or false, nor complex.

    >>> is_number(2), is_number("2"), is_number(True), is_number(2j)
    (True, False, False, False)
    """
    return isinstance(value, Real) and not isinstance(value, bool)


def float_of(value: Any) -> float:
    """Return a number as float64, infinite where it is beyond that.

    >>> float_of(10**400), float_of(-(10**400))
    (inf, -inf)
    """
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def relative_figure(text: str) -> float:
    """Return a relative figure, which may be written in percent; raises `ValueError` where it is none.

    >>> relative_figure("0.01"), relative_figure("1%")
    (0.01, 0.01)
    """
    return float(text[:-1]) / 100 if text.endswith("%") else float(text)


def scale_of(text: str) -> Estimate:
    """Return the scale 1 with its uncertainty, from ``1±0.001`` or ``±0.1%``; raises `ValueError` where it is none."""
    return Estimate.parse(text if text[:1].isdigit() else f"1{text}")


def written(value: object) -> str:
    """Return a value as a sentence quotes it: an estimate as it is written, all else as Python writes it.

    >>> print(written(Estimate(-0.1)), written(Estimate(-0.1, 0.02)), written("-0.1"))
    -0.1 -0.1±0.02 '-0.1'
    """
    if not isinstance(value, Estimate):
        return repr(value)
    return f"{value}±{value.uncertainty!r}" if value.uncertainty else str(value)


def uncertainty_of(number: float | None) -> float:
    """Return the standard uncertainty of a number: 0 of one that states none."""
    return number.uncertainty if isinstance(number, Estimate) else 0.0
