"""The line of a campaign's result, and the page docs/reliability.md."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from .campaigns import Campaign
from .workers import Tally

_BEGIN, _END = "<!-- figures: python -m tests.soak --write -->", "<!-- end of figures -->"


@dataclass(frozen=True)
class Result:
    """What a campaign came to."""

    name: str
    campaign: Campaign
    tally: Tally
    seconds: float

    def __str__(self) -> str:
        counts = self.tally.counts
        slowest, number = self.tally.slowest
        return (
            f"{self.name}: {counts.total():,} cases of {self.campaign.cases:,}, {counts['answered']:,} answered, "
            f"{counts['refused']:,} refused, {counts['fault']:,} faults; {self.seconds:.0f} s, "
            f"the slowest {slowest:.1f} s (case {number})"
        )


def machine() -> str:
    """Return what the figures were taken on."""
    return f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"


def table(results: list[Result], seed: int, where: str) -> str:
    """Return the table of the page."""
    day = datetime.now(UTC).date().isoformat()
    rows = [
        f"| `{result.name}`: {result.campaign.title} | {result.tally.counts.total():,} | {result.campaign.cases:,} | "
        f"{result.tally.counts['answered']:,} | {result.tally.counts['refused']:,} | "
        f"{result.tally.counts['fault']:,} | {result.tally.slowest[0]:.1f} s |"
        for result in results
    ]
    return "\n".join(
        [
            f"Last run: {day}, seed {seed}, {where}.",
            "",
            "| Campaign | Cases run | Of a full run | Answered | Refused | Faults | Slowest case |",
            "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
            *rows,
        ]
    )


def write(page: Path, results: list[Result], seed: int, where: str) -> None:
    """Put the table between its marks on the page."""
    text = page.read_text(encoding="utf-8")
    before, _, rest = text.partition(_BEGIN)
    after = rest.partition(_END)[2]
    page.write_text(f"{before}{_BEGIN}\n\n{table(results, seed, where)}\n\n{_END}{after}", encoding="utf-8")
