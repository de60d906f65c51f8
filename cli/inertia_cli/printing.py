"""Print a JSON document, a file, or text: in colours where it goes to a terminal, in ASCII where that has no more."""

from __future__ import annotations

import codecs
import io
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from inertia.errors import InertiaError, visible

if TYPE_CHECKING:
    from inertia.arrays import Float

_STYLES = {  # of text that stands in a report, by a pattern
    r"(?m)^\S.{0,15}?(?=  )": "bold",
    r"(?m)^error\b|\bFAIL(ED)?\b": "bold red",
    r"(?m)^warning\b|\bUNDECIDED\b|\bassumed\b": "yellow",
    r"\bPASS(ED)?\b": "bold green",
}
_PLAIN = {
    "°": " deg", "±": "+/-", "·": "*", "×": "x", "−": "-", "–": "-", "…": "...", "≤": "<=", "≥": ">=", "→": "->",
    "∠": "at ", "′": "'", "½": "1/2", "√": "sqrt", "∞": "inf", "∫": "int ", "Ø": "dia ", "µ": "u", "μ": "mu",
    "π": "pi", "θ": "theta", "φ": "phi", "ψ": "psi", "ω": "omega", "ρ": "rho", "§": "sec. ", "₁": "1", "₂": "2",
    "₃": "3", "\xa0": " ", "\u2003": "  ",
}  # fmt: skip
_EXPONENT = dict(zip("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789", strict=True))
_BLOCK = 4096  # numbers, or rows of an array, that are turned into text at once


class AnsweredError(Exception):
    """A file that goes with an answer cannot be written, and the answer is printed already."""

    def __init__(self, error: InertiaError) -> None:
        self.error = error
        super().__init__(str(error))


def in_ascii(error: UnicodeError) -> tuple[str, int]:
    """Return what stands for characters that a stream has not, and where to go on: signs in ASCII, all else escaped.

    It is the error handler of codecs that is called "inertia.ascii".

    >>> print("(7.8 ± 0.1)·10⁻¹² kg m² at 90°, größe.stl".encode("ascii", "inertia.ascii").decode())
    (7.8 +/- 0.1)*10^-12 kg m^2 at 90 deg, gr\\xf6\\xdfe.stl
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text, end = error.object, error.end
    while end < len(text) and text[end] in _EXPONENT:  # of 10⁻¹² Latin-1 lacks the sign only
        end += 1
    signs = []
    for k in range(error.start, end):
        sign = text[k]
        if sign in _EXPONENT:
            signs.append(("" if text[k - 1 : k] in _EXPONENT else "^") + _EXPONENT[sign])
        else:
            signs.append(_PLAIN.get(sign) or sign.encode("ascii", "backslashreplace").decode())
    return "".join(signs), end


codecs.register_error("inertia.ascii", in_ascii)


@contextmanager
def _as_long_as_it_is_read() -> Iterator[None]:
    """Pass over that nobody reads any more: a command has its exit code to say yet."""
    try:
        yield
    except BrokenPipeError:
        abandon_output()


def show(as_json: bool, document: Callable[[], dict[str, Any]], text: Callable[[], str]) -> None:
    """Print a result as one JSON document, or as text."""
    if as_json:
        print_document(document())
    else:
        print_text(text())


@_as_long_as_it_is_read()
def print_text(text: str) -> None:
    """Print lines of text, in which a name from outside steers no terminal."""
    lines = "\n".join(map(visible, text.split("\n")))
    if sys.stdout.isatty() and not os.environ.get("NO_COLOR"):
        _print_coloured(lines)
    else:
        print(lines)


@_as_long_as_it_is_read()
def print_file(text: str) -> None:
    """Print a file that another program reads: in UTF-8, whatever a terminal has, unless it goes to one."""
    if isinstance(sys.stdout, io.TextIOWrapper) and not sys.stdout.isatty():
        sys.stdout.flush()
        sys.stdout.buffer.write(text.encode())
    else:
        print(text, end="")


def write_and_show(
    write: Callable[[], None], as_json: bool, document: Callable[[], dict[str, Any]], text: Callable[[], str]
) -> None:
    """Write files and print the result; where they cannot be written, print it and raise `AnsweredError`."""
    try:
        write()
    except InertiaError as error:
        try:
            show(as_json, document, text)
            sys.stdout.flush()
        except OSError:  # what could not be written first is what is reported
            abandon_output()
        raise AnsweredError(error) from None
    show(as_json, document, text)


def abandon_output() -> None:
    """Let standard output lead nowhere, where nobody reads it any more: closing it at exit would fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@_as_long_as_it_is_read()
def print_document(document: dict[str, Any]) -> None:
    """Print one JSON document, a line for each of its fields; what steers a terminal, or a stream lacks, is escaped.

    Arrays in it are written block by block: lists of their numbers would take ten times their memory.
    """

    import json

    unicode = (sys.stdout.encoding or "utf-8").lower().startswith("utf-8")

    def escaped(one: re.Match[str]) -> str:
        return one[0] if unicode and one[0].isprintable() else json.dumps(one[0])[1:-1]

    write = sys.stdout.write
    # All but the arrays first: what is wrong with it leaves nothing half printed.
    fields = [(json.dumps(key), list(_pieces(value))) for key, value in document.items()]
    for k, (key, pieces) in enumerate(fields):
        write(f"{',' if k else '{'}\n {key}: ")
        for piece in pieces:
            if isinstance(piece, str):
                write(re.sub("[^ -~]", escaped, piece))
            else:
                for text in _listed(piece):
                    write(text)
    write("\n}\n")


def _pieces(value: Any) -> Iterator[str | Float]:
    """Yield a value as JSON, with the arrays that are in it, or in its entries, as they are."""
    import json

    if isinstance(value, dict) and any(hasattr(entry, "tolist") for entry in value.values()):
        for k, (key, entry) in enumerate(value.items()):
            yield f"{', ' if k else '{'}{json.dumps(key, ensure_ascii=False)}: "
            yield from _pieces(entry)
        yield "}"
    elif hasattr(value, "tolist"):
        yield value
    else:
        yield json.dumps(value, ensure_ascii=False, allow_nan=False)


def _listed(array: Float) -> Iterator[str]:
    """Yield the text of an array, of which what is not finite is null: JSON knows no infinity."""
    import json

    import numpy as np

    def text(part: Float) -> str:
        finite = np.isfinite(part)
        entries = part if finite.all() else np.where(finite, part.astype(object), None)  # type: ignore[call-overload]
        return json.dumps(entries.tolist(), allow_nan=False)

    if not array.ndim:
        yield text(array)
        return
    yield "["
    for first in range(0, len(array), _BLOCK):
        yield f"{', ' if first else ''}{text(array[first : first + _BLOCK])[1:-1]}"
    yield "]"


def _print_coloured(text: str) -> None:
    from rich.console import Console
    from rich.text import Text

    coloured = Text(text)
    for pattern, style in _STYLES.items():
        coloured.highlight_regex(pattern, style)
    Console().print(coloured, soft_wrap=True)
