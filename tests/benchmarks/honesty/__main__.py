"""Run random scenes, compare the accuracy that each states with the truth, and write docs/honesty.md and .json."""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from importlib.metadata import version
from multiprocessing import Pool
from pathlib import Path
from typing import Any

import numpy as np

from inertia.work_precision.machine import this_machine

from ..measure import ROOT
from .judge import Verdict, judge, reproduction
from .page import COMMAND, FAULTY, OUTCOMES, page, summary
from .scenes import KINDS, case

CASES = 11_000
SHARES = {
    "upright": 0.8,
    "nearly_heavy": 0.6,
    "hinged": 0.6,
    "inverted": 0.5,
    "rolling": 0.5,
    "deforming": 0.4,
    "methods": 0.6,
    "stiff": 0.25,
    "functions": 0.1,
    "orbiting": 0.15,
    "sliding": 0.15,
    "idle": 0.4,
}
"""Of the cases that a kind has on average; 1 without, but more where others have less."""
TOGETHER = 25
PACKAGES = ["inertia", "numpy", "scipy", "heyoka", "mpmath"]


def main(arguments: list[str]) -> int:
    """Run what the command line asks for; the exit code is 1 where an error exceeds its claim."""
    parser = argparse.ArgumentParser(prog=COMMAND, description=__doc__)
    parser.add_argument("--cases", type=int, default=CASES, help=f"in all, spread over the kinds ({CASES})")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", choices=list(KINDS), default=list(KINDS), metavar="KIND")
    parser.add_argument("--case", type=int, help="run this case of each kind alone, and print its scene")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--write", action="store_true", help="write docs/honesty.md and .json")
    parser.add_argument("--out", type=Path, help="write all verdicts there, as JSON")
    options = parser.parse_args(arguments)
    if options.case is not None:
        return _one(options.only, options.seed, options.case)
    begin = time.time()
    verdicts = []
    with Pool(options.processes) if options.processes > 1 else _Alone() as pool:
        for some in pool.imap(_judged, _chunks(options.only, options.seed, options.cases)):
            verdicts += some
            for each in some:
                if each.outcome in FAULTY:
                    print(_line(each), flush=True)
    figures = {kind: summary([each for each in verdicts if each.kind == kind]) for kind in options.only}
    for kind, row in figures.items():
        middle = f"{np.median(row['ratios']):.1f}" if row["ratios"] else "–"
        counts = ", ".join(f"{row[name]} {name}" for name in OUTCOMES if row[name])
        print(f"{kind}: {counts}; claim ÷ error {middle}; {row['seconds']} + {row['seconds of the truth']} s")
    print(f"{len(verdicts):,} cases in {time.time() - begin:.0f} s")
    if options.out:
        options.out.write_text(json.dumps([vars(each) for each in verdicts], indent=1), encoding="utf-8")
    if options.write:
        _write(ROOT / "docs", options.seed, figures)
    return int(any(each.outcome in FAULTY for each in verdicts))


class _Alone:
    """What a pool of one process, this one, does."""

    imap = map

    def __enter__(self) -> _Alone:
        return self

    def __exit__(self, *_: object) -> None:
        pass


def _chunks(kinds: list[str], seed: int, cases: int) -> Iterator[tuple[str, int, range]]:
    """Return the cases in groups of a kind."""
    shares = {kind: SHARES.get(kind, 1.0) for kind in kinds}
    for kind in kinds:
        count = max(1, round(cases * shares[kind] / sum(shares.values())))
        for first in range(0, count, TOGETHER):
            yield kind, seed, range(first, min(first + TOGETHER, count))


def _judged(chunk: tuple[str, int, range]) -> list[Verdict]:
    kind, seed, numbers = chunk
    return [judge(case(kind, seed, number)) for number in numbers]


def _one(kinds: list[str], seed: int, number: int) -> int:
    verdicts = []
    for kind in kinds:
        one = case(kind, seed, number)
        print(json.dumps(reproduction(one)))
        verdicts.append(judge(one))
        print(_line(verdicts[-1]))
    return int(any(each.outcome in FAULTY for each in verdicts))


def _line(each: Verdict) -> str:
    told = f"claim {each.claim:.2e}, error {each.error:.2e} ± {each.truth:.0e}" if each.claim == each.claim else ""
    words = [
        f"{each.outcome}: --only {each.kind} --seed {each.seed} --case {each.number}:",
        told,
        each.model,
        each.method,
    ]
    until = f"holds until {each.until:.6g} s" if each.until is not None else ""
    return " ".join(filter(None, [*words, until, each.sentence, *each.warnings]))


def _write(docs: Path, seed: int, figures: dict[str, Any]) -> None:
    """Write page and figures; those of kinds that did not run now stay."""
    file, machine = docs / "honesty.json", this_machine()
    before = json.loads(file.read_text(encoding="utf-8"))["kinds"] if file.exists() else {}
    document = {
        "seed": seed,
        "date": datetime.now(UTC).date().isoformat(),
        "machine": {"cpu": machine.cpu, "cores": os.cpu_count(), "system": f"{platform.system()} {platform.machine()}"},
        "versions": {"Python": platform.python_version()} | {name: version(name) for name in PACKAGES},
        "kinds": {kind: (before | figures)[kind] for kind in KINDS if kind in before | figures},
    }
    file.write_text(_as_json(document) + "\n", encoding="utf-8")
    (docs / "honesty.md").write_text(page(document), encoding="utf-8")


def _as_json(value: Any, depth: int = 3, indent: str = "") -> str:
    """Write a line for each entry of the first `depth` levels of dictionaries."""
    if not isinstance(value, dict) or not value or not depth:
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    entries = (f"{inner}{json.dumps(key)}: {_as_json(item, depth - 1, inner)}" for key, item in value.items())
    return "{\n" + ",\n".join(entries) + f"\n{indent}}}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
