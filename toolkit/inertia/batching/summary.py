"""What became of a batch: states, the commonest refusals, the slowest files, what was assumed."""

from __future__ import annotations

import heapq
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import field
from typing import Any

from inertia.batching.columns import STATES
from inertia.batching.lot import Lot
from inertia.errors import visible
from inertia.mesh.checks.findings import counted
from inertia.records import dataclass
from inertia.report.numerals import row as line
from inertia.report.numerals import significant

_LISTED = 10
_FIGURES = re.compile(r"(?<![\w.+-])[-+]?\d+(?:[.,]\d+)*(?:e[-+]?\d+)?(?!\w|[.,]\w)")
"""Numbers that stand alone: those in names, as 3mf, UTF-8 or part-2.stl, are none."""

_MORE = re.compile(r" \([^()]*\bmore faults?\)|; [^;]* gives an answer whose bound covers the faults$")


@dataclass
class Summary:
    """Counts over the rows so far.

    Attributes
    ----------
    verb : what was asked
    files : how many there are
    stored : rows that an earlier run had answered
    states, exit_codes : how many rows have each
    refusals : how many rows have each sentence without its figures, and the first of these files
    assumed_units : rows whose unit was assumed
    slowest : (s, file)
    lot : of `balance`, the rotors together
    """

    verb: str
    files: int
    stored: int = 0
    states: Counter[str] = field(default_factory=Counter)
    exit_codes: Counter[int] = field(default_factory=Counter)
    refusals: dict[str, tuple[int, str]] = field(default_factory=dict)
    assumed_units: int = 0
    slowest: list[tuple[float, str]] = field(default_factory=list)
    lot: Lot = field(default_factory=Lot)

    @property
    def rows(self) -> int:
        """How many there are so far."""
        return self.states.total()

    @property
    def refused(self) -> int:
        """How many of them have no answer."""
        return self.rows - self.states["answered"]

    def count(self, row: dict[str, Any], stored: bool) -> None:
        """Count a row in."""
        self.stored += stored
        self.states[row["state"]] += 1
        self.exit_codes[row["exit_code"]] += 1
        self.assumed_units += row.get("unit_from") == "assumed"
        if row["state"] != "answered":
            kind = _kind(row)
            number, first = self.refusals.get(kind, (0, row["path"]))
            self.refusals[kind] = number + 1, first
        if self.verb == "balance":
            self.lot.count(row)
        if row["seconds"] is not None and not stored:
            heapq.heappush(self.slowest, (row["seconds"], row["path"]))
            if len(self.slowest) > _LISTED:
                heapq.heappop(self.slowest)

    def document(self) -> dict[str, Any]:
        """Return the summary as ``inertia/batch/1``."""
        return {
            "schema": "inertia/batch/1",
            "verb": self.verb,
            "files": self.files,
            "stored": self.stored,
            "states": {state: self.states[state] for state in STATES},
            "exit_codes": {str(code): self.exit_codes[code] for code in sorted(self.exit_codes)},
            "refusals": [{"count": n, "message": kind, "first": path} for kind, n, path in self._commonest()],
            "assumed_units": self.assumed_units,
            "slowest": [{"seconds": seconds, "path": path} for seconds, path in self._slowest()],
            **({"lot": self.lot.document()} if self.verb == "balance" else {}),
        }

    def text(self) -> str:
        """Return the summary as lines of text."""
        lines = [line("Files", f"{self.files}{f', {self.stored} of them answered before' if self.stored else ''}")]
        lines += [line(state, str(self.states[state])) for state in STATES if self.states[state]]
        lines += [
            line("Refusals" if number == 0 else "", f"{count} × {kind} (first: {path})")
            for number, (kind, count, path) in enumerate(self._commonest())
        ]
        if self.assumed_units:
            lines.append(line("Unit", f"assumed for {counted(self.assumed_units, 'file')}"))
        lines += [
            line("Slowest" if number == 0 else "", f"{significant(seconds, 3, 6)} s  {path}")
            for number, (seconds, path) in enumerate(self._slowest())
        ]
        return "\n".join([*lines, *self.lot.text()])

    def _commonest(self) -> Iterator[tuple[str, int, str]]:
        entries = sorted(self.refusals.items(), key=lambda entry: (-entry[1][0], entry[0]))
        return ((kind, count, path) for kind, (count, path) in entries[:_LISTED])

    def _slowest(self) -> list[tuple[float, str]]:
        return sorted(self.slowest, reverse=True)


def _kind(row: dict[str, Any]) -> str:
    """Return what rows of the same refusal have in common: the sentence without the file's name and its figures."""
    text = str(row["message"])
    for words in (f"cannot read {visible(row['path'])}: ", f"{visible(row['path'])}: ", f"{visible(row['path'])} "):
        text = text.replace(words, "")
    return _FIGURES.sub("…", _MORE.sub("", text))
