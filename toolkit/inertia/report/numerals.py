"""Numbers, and the lines of labels and columns that they stand in, as reports print them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Iterator

from inertia.errors import visible

LABEL = 18
"""Width of the column of labels."""
WIDTH = 120
"""Width of a line."""


def significant(value: float, digits: int = 4, decimals: int = 3) -> str:
    """Return a value with so many significant digits, but no more decimals than given; never in powers of ten.

    >>> significant(28647.89), significant(0.65432), significant(0.0), significant(0.0001)
    ('28648', '0.654', '0', '<0.001')
    """
    size = abs(value)
    if size == 0:
        return "0"
    if size < 0.5 * 10.0**-decimals:
        return f"<{10.0**-decimals:.{decimals}f}"
    places = digits - 1 - math.floor(math.log10(size))
    return f"{value:.{min(max(places, 0), decimals)}f}"


def fixed(value: float, decimals: int) -> str:
    """Return a value with so many decimals, and no minus sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def plain(value: float, decimals: int) -> str:
    """Return a value with so many decimals at most, and none that are zero.

    >>> plain(280.0, 3), plain(150.60714, 3), plain(-0.0, 1)
    ('280', '150.607', '0')
    """
    text = fixed(value, decimals)
    return text.rstrip("0").rstrip(".") if "." in text else text


def converted(value: float) -> float:
    """Return a figure that was brought into another unit, without what that leaves behind its twelfth digit.

    >>> converted(1e3 * 0.0392), converted(math.degrees(math.radians(205.0)))
    (39.2, 205.0)
    """
    return float(f"{value:.12g}")


def row(label: str, text: str) -> str:
    """Return one line: a label and what it says."""
    return f"{label:<{LABEL}}{visible(text)}"


def wrapped(label: str, sentence: str) -> Iterator[str]:
    """Yield the lines of a sentence beside a label."""
    for k, line in enumerate(textwrap.wrap(sentence, WIDTH - LABEL, break_long_words=False)):
        yield row("" if k else label, line)


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
