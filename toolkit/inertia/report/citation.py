"""Which publications the methods behind an answer are from, as BibTeX."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inertia import __version__
from inertia.errors import UsageError

_SOFTWARE = f"""@software{{inertia,
  author = {{{{The inertia authors}}}},
  title = {{inertia: exact inertia tensors from meshes, rotor balancing and rigid-body playback}},
  version = {{{__version__}}},
}}"""
_NAMES = {"method", "reference_method", "model", "standard"}


def cite(*documents: Mapping[str, Any]) -> str:
    """Return BibTeX of this program, and of the publications that the methods named in its JSON documents are from.

    Parameters
    ----------
    documents : of any kind, as a command prints them in JSON

    Raises `UsageError` for what is no document of this program.

    >>> run = {"schema": "inertia/run/1", "model": "Euler equations", "accuracy": {"method": "splitting 4"}}
    >>> [line for line in cite(run).splitlines() if line.startswith("@")]
    ['@software{inertia,', '@article{Dullweber1997,', '@article{Fasso2003,']
    """
    for document in documents:
        if not isinstance(document, Mapping) or not str(document.get("schema", "")).startswith("inertia/"):
            raise UsageError("this is no document of inertia: give the JSON that a command prints")
    named = {name for document in documents for name in _names(document)}
    entries = Path(__file__).with_name("sources.bib").read_text(encoding="utf-8").strip().split("\n\n")
    return "\n\n".join([_SOFTWARE, *filter(None, (_cited(entry, named) for entry in entries))]) + "\n"


def _names(document: Mapping[str, Any]) -> Iterator[str]:
    """Yield the methods, models and standards that a document names."""
    waiting: list[Any] = [document]
    while waiting:
        value = waiting.pop()
        if isinstance(value, list):
            waiting += value
        if not isinstance(value, Mapping):
            continue
        for name, inside in value.items():
            if name in _NAMES and isinstance(inside, str):
                yield inside
            elif name == "uncertainty" and inside:
                yield name
            waiting.append(inside)


def _cited(entry: str, named: set[str]) -> str | None:
    """Return an entry without its line `where`, if that names one of the methods."""
    text, where = re.split(r"\n  where = \{(?=.*\},\n\}$)", entry)
    pattern = where.removesuffix("},\n}")
    return f"{text}\n}}" if any(re.search(pattern, name) for name in named) else None
