"""Numbers and lines as the text reports set them."""

from __future__ import annotations

from collections.abc import Iterable

LABEL = 18
"""Width of the column of labels."""


def row(label: str, text: str) -> str:
    """Return one line: a label and what it says."""
    return f"{label:<{LABEL}}{text}"


def number(value: float) -> str:
    """Return a value with ten significant digits.

    >>> number(1 / 3), number(4), number(1e-9 / 3)
    ('0.3333333333', '4', '3.333333333e-10')
    """
    return f"{value + 0.0:.10g}"


def cleared(value: float, bound: float) -> float:
    """Return 0 for a value that its error bound cannot tell from zero."""
    return 0.0 if abs(value) <= bound else value


def columns(values: Iterable[float], width: int = 18) -> str:
    """Return values with ten significant digits in columns; an exact zero is short.

    >>> columns([1.5, 0.0])
    '   1.500000000e+00                 0'
    """
    return "".join(f"{'0' if value == 0 else f'{value:.9e}':>{width}}" for value in values)


def power(unit: str, exponent: int) -> str:
    """Return a power of a unit.

    >>> power("mm", 3)
    'mm³'
    """
    return unit + {1: "", 2: "²", 3: "³"}[exponent]
