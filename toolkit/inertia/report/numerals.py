"""Numbers, and the lines of labels and columns that they stand in, as reports print them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Container, Iterable, Iterator, Sequence

from inertia.errors import visible

LABEL = 18
"""Width of the column of labels."""
WIDTH = 120
"""Width of a line."""
_LONGEST = 48  # characters of a name that stands beside its figures
_MOST = 9  # decimals that are read with ease


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


def scaled(value: float, decimals: int) -> str:
    """Return a value with four significant digits as `significant` does; in powers of ten beside tiny scales.

    >>> scaled(0.00007273, 8), scaled(2.909e-11, 14), scaled(1e-13, 8)
    ('0.00007273', '2.909e-11', '<0.00000001')
    """
    return significant(value, 4, decimals) if decimals <= _MOST else f"{value + 0.0:.4g}"


def decimals_of(scale: float, least: int = 3, digits: int = 4) -> int:
    """Return with how many decimals, `least` or more, a value as large as `scale` has so many significant digits.

    >>> decimals_of(109.9), decimals_of(7.3e-5), decimals_of(0.0)
    (3, 8, 3)
    """
    return max(least, digits - 1 - math.floor(math.log10(scale))) if scale > 0 else least


def grams(mass: float, least: int = 3, smallest: float = math.inf) -> str:
    """Return a mass that has to be weighed or taken off, g: three decimals or more, or four digits below 0.1 g.

    It is in powers of ten where it would have too many decimals, or the smallest mass of its list.

    >>> grams(21.9361), grams(0.000012345), grams(0.0)
    ('21.936', '0.00001235', '0.000')
    >>> grams(9.98e-7), grams(1.075e-6), grams(1.075e-6, smallest=9.98e-7)
    ('9.980e-07', '0.000001075', '1.075e-06')
    """
    if decimals_of(min(mass, smallest)) > _MOST:
        return f"{mass:.3e}"
    return scaled(mass, decimals_of(mass, max(3, least))) if 0 < mass < 0.1 else fixed(mass, max(3, least))


def direction(degrees: float, decimals: int = 1) -> str:
    """Return an angle as it is printed, from 0 up to but not including 360.

    >>> direction(359.97), direction(-0.01), direction(90.0, 2)
    ('0.0', '0.0', '90.00')
    """
    return fixed(round(degrees, decimals) % 360.0, decimals)


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


def table(rows: Sequence[Sequence[str]], left: Container[int] = (0,)) -> Iterator[str]:
    """Yield rows of as many cells as lines, the columns `left` to the left and the others to the right.

    What is long in the first column, as a name, stands on a line of its own, above the rest of its row.

    >>> print(*table([("part", "kg"), ("bolt", "0.1"), (50 * "x", "12")]), sep="\\n")
    part   kg
    bolt  0.1
    xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx
           12
    """
    short = [each if len(each[0]) <= _LONGEST else ("", *each[1:]) for each in rows]
    widths = [max(map(len, column)) for column in zip(*short, strict=True)]
    for each, shown in zip(rows, short, strict=True):
        if len(each[0]) > _LONGEST:
            yield each[0]
        cells = (
            cell.ljust(width) if k in left else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(shown, widths, strict=True))
        )
        yield "  ".join(cells).rstrip()


def number(value: float, more: int = 0) -> str:
    """Return a value with ten significant digits, or so many more.

    >>> number(1 / 3), number(4), number(1e-9 / 3)
    ('0.3333333333', '4', '3.333333333e-10')
    """
    return f"{value + 0.0:.{10 + more}g}"


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
