"""The line of a campaign's result, and the page docs/reliability.md."""

from __future__ import annotations

import json
import os
import platform
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from .campaigns import CAMPAIGNS, Campaign
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


def record(result: Result, seed: int) -> dict[str, Any]:
    """Return the figures of a campaign as they are kept."""
    counts = result.tally.counts
    return {
        "title": result.campaign.title,
        "full": result.campaign.cases,
        **{kind: counts[kind] for kind in ("answered", "refused", "fault")},
        "slowest": round(result.tally.slowest[0], 2),
        "seed": seed,
        "date": datetime.now(UTC).date().isoformat(),
        "machine": machine(),
    }


def table(records: dict[str, dict[str, Any]]) -> str:
    """Return the table of the page."""
    lines = ["| Campaign | Cases run | Of a full run | Answered | Refused | Faults | Slowest | Seed | Date |"]
    lines.append("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |")
    for name in CAMPAIGNS:
        if name in records:
            row = records[name]
            run = row["answered"] + row["refused"] + row["fault"]
            lines.append(
                f"| `{name}`: {row['title']} | {run:,} | {row['full']:,} | {row['answered']:,} | {row['refused']:,} | "
                f"{row['fault']:,} | {row['slowest']:.1f} s | {row['seed']} | {row['date']} |"
            )
    machines = dict.fromkeys(row["machine"] for row in records.values())
    return "\n".join([*lines, "", f"On {'; '.join(machines)}."])


def write(docs: Path, results: list[Result], seed: int) -> None:
    """Keep the figures in docs/reliability.json, and put all that are kept between the marks on the page."""
    file, page = docs / "reliability.json", docs / "reliability.md"
    records = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    records |= {result.name: record(result, seed) for result in results}
    file.write_text(json.dumps(records, indent=1) + "\n", encoding="utf-8")
    before, _, rest = page.read_text(encoding="utf-8").partition(_BEGIN)
    after = rest.partition(_END)[2]
    page.write_text(f"{before}{_BEGIN}\n\n{table(records)}\n\n{_END}{after}", encoding="utf-8")
