"""What writers of every format share: bodies, numbers as text, names that a format takes, lines of comments."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from inertia import __version__
from inertia.exchange.conventions import Convention
from inertia.mass.properties import MassProperties
from inertia.records import dataclass

_WORDS = (  # of Python, Modelica and MATLAB, and of what is written: no identifier in one of them
    "algorithm and annotation as assembly assert assertion async await block boolean break case catch class classdef "
    "connect connector constant constrainedby continue def del der discrete each elif else elseif elsewhen "
    "encapsulated end enumeration equation except expandable extends external false final finally flow for from "
    "function global if import impure in initial inner input integer is lambda loop model modelica none nonlocal not "
    "operator or otherwise outer output package parameter parfor partial pass persistent protected public pure raise "
    "real record redeclare replaceable return rotationalinertia spatialinertia spmd stream string switch then time "
    "true try type when while with within yield"
)
_RESERVED = frozenset(_WORDS.split())
_LONGEST = 63  # characters of a name in MATLAB


@dataclass(frozen=True, eq=False)
class Body:
    """A body to write: its name, as given, and its mass properties in the axes of its part."""

    name: str
    properties: MassProperties


def number(value: float) -> str:
    """Return the shortest decimal that reads back as the same float64; no minus before a zero.

    >>> number(0.1), number(-0.0), number(1e-05)
    ('0.1', '0.0', '1e-05')
    """
    return repr(float(value) + 0.0)


def numbers(values: Iterable[float], between: str = " ") -> str:
    """Return several numbers on one line."""
    return between.join(map(number, values))


def fitted(value: float, width: int, exponent: str = "e") -> tuple[str, float]:
    """Return a decimal with a point in so many characters, as precise as they allow, and the float64 it stands for.

    `exponent` is what stands before the exponent's sign: "" in the fields of Nastran.

    >>> fitted(-1 / 3e5, 16, "")
    ('-3.33333333333-6', -3.33333333333e-06)
    >>> fitted(0.5, 16), fitted(7850.0, 16)
    (('0.5', 0.5), ('7850.', 7850.0))
    """
    value = float(value) + 0.0
    for digits in range(len(Decimal(repr(value)).as_tuple().digits), 0, -1):
        rounded = f"{value:.{digits - 1}e}"
        mantissa, _, power = rounded.partition("e")
        mantissa = mantissa.rstrip("0") if "." in mantissa else mantissa + "."
        candidates = [f"{mantissa}{exponent}{int(power):+d}"]
        if -5 < int(power) < 17:
            decimals = max(digits - 1 - int(power), 0)
            plain = f"{float(rounded):.{decimals}f}"
            candidates.append(plain.rstrip("0") if "." in plain else plain + ".")
        text = min(reversed(candidates), key=len)
        if len(text) <= width:
            return text, float(rounded)
    raise ValueError(f"{value!r} does not fit {width} characters")


def rounding(width: int, pairs: Iterable[tuple[float, float]]) -> str:
    """Say how far numbers are from what is written for them in so many characters, relative to themselves."""
    largest = max((abs(there - value) / abs(value) for value, there in pairs if value), default=0.0)
    said = (
        f"no number is rounded by more than {_above(largest)} of itself" if largest else "no number had to be rounded"
    )
    return f"Numbers of at most {width} characters: {said}."


def triangular(moments: NDArray[Any]) -> NDArray[Any]:
    """Return moments (3,), ascending, the last less by units in its last place until I1 + I2 ≥ I3.

    Rounding may break the triangle rule of a flat body, and programs refuse moments that do.

    >>> triangular(np.array([0.1, 0.2, np.nextafter(0.1 + 0.2, 1)])).tolist()
    [0.1, 0.2, 0.30000000000000004]
    """
    first, second, third = moments
    while float(first) + float(second) < float(third):
        third = np.nextafter(third, moments.dtype.type(0))
    return np.array([first, second, third], moments.dtype)


def identifiers(names: Sequence[str]) -> list[str]:
    """Return a name in letters, digits and underscores for each, all different, none a word of a language.

    >>> identifiers(["upper arm", "upper-arm", "2nd", "end", "Gehäuse"])
    ['upper_arm', 'upper_arm_2', 'part_2nd', 'part_end', 'Geh_use']
    """
    taken: set[str] = set()
    result = []
    for name in names:
        word = re.sub(r"\W", "_", name, flags=re.ASCII)[: _LONGEST - 10]
        if not word[:1].isalpha() or word.lower() in _RESERVED:
            word = f"part_{word}".rstrip("_")
        unique, count = word, 1
        while unique.lower() in taken:
            count += 1
            unique = f"{word}_{count}"
        taken.add(unique.lower())
        result.append(unique)
    return result


def attribute(name: str) -> str:
    """Return a name as the value of an attribute in XML, in quotes; characters that XML forbids become underscores.

    >>> attribute('a<b & "c"\\x07')
    '\\'a&lt;b &amp; "c"_\\''
    """
    return quoteattr(_in_xml(name))


def _in_xml(name: str) -> str:
    return re.sub(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "_", name)


def free(name: str) -> str:
    """Return a name that is not that of the link or body which programs have already."""
    return "world_" if name == "world" else name


def distinct(names: Sequence[str], change: Callable[[str], str] = free) -> list[str]:
    """Return names as they may stand in XML, changed, and with underscores behind those that others have then.

    >>> distinct(["world", "world_", "a\\x07", "a_"])
    ['world__', 'world_', 'a__', 'a_']
    """
    changed = [change(_in_xml(name)) for name in names]
    taken = {there for name, there in zip(names, changed, strict=True) if there == name}
    result = []
    for name, there in zip(names, changed, strict=True):
        while there != name and there in taken:
            there += "_"
        taken.add(there)
        result.append(there)
    return result


def heading(bodies: Sequence[Body], convention: Convention, comments: Sequence[str]) -> list[str]:
    """Return lines of plain ASCII for comments: signs, point and axes, and the certified bounds of each body."""
    lines = [
        f"Mass properties for {convention.program}, written by inertia {__version__}.",
        f"Units: {convention.units}.",
        f"About: {convention.about}.",
        f"Off the diagonal: {convention.off_diagonal}.",
    ]
    for body in bodies:
        error = body.properties.error
        lines.append(
            f"Bounds of {body.name}: mass {_above(error.mass)}, tensor {_above(error.inertia)} (relative, Frobenius "
            f"norm), centre of mass {_above(error.center_of_mass)} m; {error.method}."
        )
    return [printable(line) for line in (*lines, *comments)]


def printable(line: str) -> str:
    """Return a line in printable ASCII, whatever the names and paths in it hold: letters beyond it are escaped.

    >>> print(printable("kg m²\\n*END größe"))
    kg m^2 *END gr\\xf6\\xdfe
    """
    for character, plain in {
        "²": "^2",
        "³": "^3",
        "∫": "integral of ",
        "−": "-",
        "≥": ">=",
        "×": "x",
        "µ": "u",
    }.items():
        line = line.replace(character, plain)
    line = line.replace("`", "").encode("ascii", "backslashreplace").decode()
    return re.sub(r"[^\x20-\x7e]+", " ", line).rstrip()


def xml_comment(lines: Iterable[str], indent: str = "") -> str:
    """Return lines as a comment of XML.

    >>> print(xml_comment(["a --> b"]))
    <!--
      a - -> b
    -->
    """
    return "\n".join([f"{indent}<!--", *(f"{indent}  {hyphens_apart(line)}" for line in lines), f"{indent}-->"])


def hyphens_apart(line: str) -> str:
    """Return a line in which no two hyphens stand together, as a comment of XML wants it."""
    return re.sub(r"-(?=-)", "- ", line)


def _above(bound: float) -> str:
    """Return a bound with two digits, rounded up."""
    if not 0 < bound < math.inf:
        return f"{bound:g}"
    return next(text for k in range(2) if float(text := f"{bound * (1 + 0.05 * k):.1e}") >= bound)
