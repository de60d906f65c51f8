"""What can go wrong, the exit code that says so, and what to ask for instead.

Every message is one sentence that names what was measured, the limit, the place and the remedy. A remedy is data: the
library words it as an argument (``shell=THICKNESS``), and whoever has options in place of arguments words it as one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from itertools import chain
from typing import NamedTuple, Self

_UNPRINTABLE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\U000e0000-\U000e007f]"
)
"""What steers a terminal or turns text round: control characters, line ends, marks of direction, halves of pairs."""


def visible(text: str) -> str:
    r"""Return text from outside (names of files, regions, fields, what they hold) as it may stand in a line of output.

    >>> print(visible("\x1b[31mred\r\n\u202etxt.\u9b5a"))
    \u001b[31mred\u000d\u000a\u202etxt.魚
    """
    return text if text.isprintable() else _UNPRINTABLE.sub(_escaped, text)


def _escaped(one: re.Match[str]) -> str:
    code = ord(one[0])
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


class Remedy(NamedTuple):
    """What to ask for instead: an argument of a verb of `inertia`, or a verb.

    Attributes
    ----------
    verb : as "analyse"; "" for the one that was called
    argument : its name; "" where the verb itself is the remedy
    value : what to give: True, a word, or what stands for a figure in capitals; ... where any value may do, and None
        where the argument is only named

    >>> print(SHELL, ABSOLUTE, UNION, UNIT, REPAIR, Remedy("trade", "budget"), sep=", ")
    shell=THICKNESS, orientation='absolute', union=True, unit=..., inertia.repair(part), budget
    >>> print(WELD)
    inertia.weld(part, DISTANCE)
    """

    verb: str
    argument: str = ""
    value: object = None

    def __str__(self) -> str:
        if not self.argument:
            return f"inertia.{self.verb}(part)"
        if self.verb == "weld":
            return f"inertia.weld(part, {self.value})"
        if self.value is None:
            return self.argument
        if self.value is ...:
            return f"{self.argument}=..."
        stands_for_a_figure = isinstance(self.value, str) and self.value.isupper()
        return f"{self.argument}={self.value if stands_for_a_figure else repr(self.value)}"


CHECK = Remedy("check")
REPAIR = Remedy("repair")
WELD = Remedy("weld", "tolerance", "DISTANCE")
SHELL = Remedy("analyse", "shell", "THICKNESS")
ABSOLUTE = Remedy("analyse", "orientation", "absolute")
UNION = Remedy("analyse", "union", True)
ALLOW_FAULTS = Remedy("analyse", "allow_faults", "REL")
SEPARATE = Remedy("analyse", "parts", "separate")
TESSELLATED = Remedy("analyse", "tessellated", True)
UNIT = Remedy("read", "unit", ...)
FORCE = Remedy("", "force", True)


class FieldPath(NamedTuple):
    """A field of a file, by its path, as ``start.angular_velocity[1]``."""

    path: str

    def __str__(self) -> str:
        return self.path


Place = str | FieldPath
Word = str | Remedy | FieldPath
Wording = Callable[[Remedy | FieldPath], str]
"""What a remedy or the name of a field is called; `str` is the library's."""


class Sentence(str):
    """Text in the library's wording that knows the remedies and fields in it, so that it can be worded otherwise.

    >>> sentence = Sentence("close the mesh, or use ", SHELL)
    >>> sentence
    'close the mesh, or use shell=THICKNESS'
    >>> sentence.worded(lambda remedy: f"a {remedy.argument}")
    'close the mesh, or use a shell'
    """

    words: tuple[Word, ...]

    def __new__(cls, *words: Word) -> Self:
        """Join the words; sentences among them come with their own."""
        flat = tuple(
            chain.from_iterable(word.words if isinstance(word, Sentence) else (_shown(word),) for word in words)
        )
        sentence = super().__new__(cls, "".join(map(str, flat)))
        sentence.words = flat
        return sentence

    @property
    def remedies(self) -> tuple[Remedy, ...]:
        """The remedies in it, each once, in their order."""
        return tuple(dict.fromkeys(word for word in self.words if isinstance(word, Remedy)))

    def worded(self, wording: Wording) -> str:
        """Return the text with every remedy and field worded by `wording`."""
        return "".join(word if isinstance(word, str) else wording(word) for word in self.words)


def _shown(word: Word) -> Word:
    """Return a word of a sentence with nothing in it but what can be printed: it may be a name from outside."""
    if isinstance(word, FieldPath):
        return FieldPath(visible(word.path))
    return visible(word) if isinstance(word, str) else word


class InertiaError(Exception):
    """Base of every error this package raises on purpose.

    Attributes
    ----------
    words : the sentence, in pieces: text, remedies, and the names of fields
    places : where it was met, the outermost first: a file, a field
    code : what kind of refusal it is, in a word that stays the same (`docs/errors.md`)

    >>> error = GeometryError("open: close the mesh, or use ", REPAIR)
    >>> placed(error, "cube.stl")
    GeometryError('cube.stl: open: close the mesh, or use inertia.repair(part)')
    >>> placed(error, "cube.stl").remedies
    (Remedy(verb='repair', argument='', value=None),)
    """

    exit_code = 1
    code = "fault"

    def __init__(self, *words: Word, places: tuple[Place, ...] = (), code: str = "") -> None:
        self.words, self.places = words, places
        self.code = code or type(self).code
        super().__init__(self.sentence)

    @property
    def sentence(self) -> Sentence:
        """Where, and what is the matter."""
        return Sentence(*chain.from_iterable((place, ": ") for place in self.places), *self.words)

    @property
    def remedies(self) -> tuple[Remedy, ...]:
        """What to ask for instead, where that is an argument or a verb."""
        return self.sentence.remedies


class UsageError(InertiaError, ValueError):
    """An argument or option is not usable (exit code 2)."""

    exit_code = 2
    code = "usage"


class WriteError(InertiaError):
    """A file cannot be written (exit code 1)."""

    code = "unwritable"


class ReadError(InertiaError, ValueError):
    """A file cannot be read (exit code 3)."""

    exit_code = 3
    code = "unreadable"


class GeometryError(InertiaError, ValueError):
    """The mesh or the data cannot give an honest answer (exit code 4)."""

    exit_code = 4
    code = "no_answer"


class CacheWarning(UserWarning):
    """Compiled kernels are not kept, not intact, or not made: it costs time, not the answer."""


class WaitingWarning(UserWarning):
    """Nobody works at present: workers are waited for."""


def placed(error: InertiaError, *places: Place) -> InertiaError:
    """Return an error of the same kind that was met at a place: in a file, at a field; the outermost first."""
    return reworded(error, error.words, (*places, *error.places))


def reworded(error: InertiaError, words: Iterable[Word], places: Iterable[Place]) -> InertiaError:
    """Return an error of the same kind with other words and places."""
    kind = next(k for k in (UsageError, WriteError, ReadError, GeometryError, InertiaError) if isinstance(error, k))
    return kind(*words, places=tuple(places), code=error.code)


def require_kind(value: object, kind: type, name: str, source: str) -> None:
    """Raise `UsageError` where an argument is of another kind than a verb takes: a path, most likely.

    >>> require_kind("bracket.stl", dict, "part", "inertia.read(path)")
    Traceback (most recent call last):
    inertia.errors.UsageError: part is a str, not a dict: give what inertia.read(path) returns
    """
    if not isinstance(value, kind):
        raise UsageError(f"{name} is a {type(value).__name__}, not a {kind.__name__}: give what {source} returns")
