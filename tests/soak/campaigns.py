"""The campaigns: what each tries, how many cases a full run has, and what a case is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from . import documents, meshes, options
from .workers import Case, Outcome


@dataclass(frozen=True)
class Campaign:
    """A campaign: `case` takes the seed, the number of the case and a folder to itself."""

    title: str
    cases: int
    case: Callable[[int, int, Path], Outcome]

    def with_seed(self, seed: int) -> Case:
        """Return what runs a case by its number."""
        return partial(_in_folder, self.case, seed)


def _in_folder(case: Callable[[int, int, Path], Outcome], seed: int, number: int) -> Outcome:
    return case(seed, number, Path.cwd())


CAMPAIGNS = {
    "meshes": Campaign("damaged mesh files of every format", 1_000_000, meshes.case),
    "documents": Campaign("damaged scenes and rotors (TOML)", 100_000, documents.case),
    "options": Campaign("command lines with odd values", 10_000, options.case),
}
