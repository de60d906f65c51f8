"""How the command line words a remedy or a field of a file: as an option."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from inertia.errors import REPAIR, WELD, FieldPath, InertiaError, Remedy, Word, reworded

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
    return f"{option} {word.value}" if isinstance(word.value, str) else option


def with_options(error: InertiaError, fields: Mapping[str, str], *, part: str = "") -> InertiaError:
    """Return the error with options in place of fields.

    Parameters
    ----------
    error : as the library raised it
    fields : the options by the paths of the fields that they stand for; "" where nothing needs to be said
    part : what stands for a file that has such fields, and need not be named as one
    """
    places = (_option(place, fields) for place in error.places if place != part)
    return reworded(error, (_option(word, fields) or word for word in error.words), (k for k in places if k))


def _option(word: W, fields: Mapping[str, str]) -> W | str:
    """Return what stands for a field, or an entry of one; all else as it is."""
    if not isinstance(word, FieldPath):
        return word
    path, bracket, index = (word.path, "", "") if word.path in fields else word.path.rpartition("[")
    return f"{fields[path]}{bracket}{index}" if path in fields else word
