"""The campaigns: what each tries, how many cases a full run has, and what a case is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from . import cache_flips, changing, documents, full_disk, kills, meshes, options
from .workers import Case, Outcome


@dataclass(frozen=True)
class Campaign:
    """A campaign: `case` takes the seed, the number of the case and a folder to itself."""

    title: str
    cases: int
    case: Callable[[int, int, Path], Outcome]
    together: int = 50
    """Cases that a worker is given at a time."""

    def with_seed(self, seed: int) -> Case:
        """Return what runs a case by its number."""
        return partial(_in_folder, self.case, seed)


def _in_folder(case: Callable[[int, int, Path], Outcome], seed: int, number: int) -> Outcome:
    return case(seed, number, Path.cwd())


CAMPAIGNS = {
    "meshes": Campaign("damaged mesh files of every format", 1_000_000, meshes.case),
    "documents": Campaign("damaged scenes and rotors (TOML)", 100_000, documents.case),
    "options": Campaign("command lines with odd values", 10_000, options.case),
    "kills": Campaign("runs that are killed while they write", 2_000, kills.case, 1),
    "cache_flips": Campaign("damaged kernels in the cache", 2_000, cache_flips.case, 1),
    "full_disk": Campaign("a disk that is full from the n-th write on", 2_000, full_disk.case, 1),
    "changing": Campaign("parts that change while they are read", 5_000, changing.case, 1),
}
