"""How the command line words a remedy or a field of a file: as an option."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TypeVar

from inertia.errors import REPAIR, WELD, FieldPath, InertiaError, Remedy, Sentence, Word, reworded

_NUMBERED = re.compile(r"\[\d+\]")
_BEFORE_REMEDY = re.compile(r"(?:,? or)?(?: use| with)? $")

W = TypeVar("W", bound=Word)


def as_option(word: Remedy | FieldPath) -> str:
    """Return the option, or the command, that a remedy is; a field keeps its path.

    >>> [as_option(remedy) for remedy in (Remedy("read", "unit"), REPAIR, WELD, Remedy("check"))]
    ['--unit', '--repair', '--weld DISTANCE', '`inertia check`']
    """
    if isinstance(word, FieldPath):
        return word.path
    if not word.argument:
        return "--repair" if word == REPAIR else f"`inertia {word.verb}`"
    if word.verb == WELD.verb:
        return f"--weld {word.value}"
    option = f"--{word.argument.replace('_', '-')}"
    return f"{option} {word.value}" if isinstance(word.value, str | float) else option


def tried(error: InertiaError, remedy: Remedy) -> InertiaError:
    """Return the error without the remedy that has been followed already.

    >>> from inertia.errors import GeometryError
    >>> tried(GeometryError("open: close the mesh, or use ", WELD, " or ", REPAIR), REPAIR).sentence
    'open: close the mesh, or use inertia.weld(part, DISTANCE); the repair that was asked for leaves this'
    >>> tried(GeometryError("two bodies overlap: unite the bodies, or use ", REPAIR), REPAIR).sentence
    'two bodies overlap: unite the bodies; the repair that was asked for leaves this'
    """
    words: list[Word] = []
    for word in Sentence(*error.words).words:
        if word != remedy:
            words.append(word)
        elif words and isinstance(words[-1], str):
            words[-1] = _BEFORE_REMEDY.sub("", words[-1])
    return reworded(error, [*words, "; the repair that was asked for leaves this"], error.places)


def with_options(error: InertiaError, fields: Mapping[str, str], *, part: str = "") -> InertiaError:
    """Return the error with options in place of fields.

    Parameters
    ----------
    error : as the library raised it
    fields : the options by the paths of the fields that they stand for, of one of several alike that of the first, as
        of plane[0]; "" where nothing needs to be said
    part : what stands for a file that has such fields, and need not be named as one
    """
    places = (_option(place, fields) for place in error.places if place != part)
    return reworded(error, (_option(word, fields) or word for word in error.words), (k for k in places if k))


def _option(word: W, fields: Mapping[str, str]) -> W | str:
    """Return what stands for a field, or an entry of one; all else as it is."""
    if not isinstance(word, FieldPath):
        return word
    path, bracket, index = (word.path, "", "") if word.path in fields else word.path.rpartition("[")
    if path in fields:
        return f"{fields[path]}{bracket}{index}"
    return fields.get(_NUMBERED.sub("[0]", word.path), word)
