"""Run random scenes, compare the accuracy that each states with the truth, and write docs/honesty.md and .json."""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from collections import Counter
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
from .page import COMMAND, page, summary
from .quad import MOST_STEPS
from .scenes import KINDS, case

CASES = 11_000
SHARES = {"functions": 0.2, "deforming": 0.6, "stiff": 0.4}
"""Of the cases that a kind has on average; 1 without, but more where others have less."""
FAULTY = "exceeded", "misadvised", "fault"
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
    figures = summary(verdicts)
    for kind, row in figures.items():
        print(kind, row)
    judged = [each.ratio for each in verdicts if each.outcome in ("held", "exceeded")]
    document = _document(options.seed, verdicts, float(np.median(judged)) if judged else 0.0, figures)
    wall = time.time() - begin
    print(f"median claim ÷ error {document['median']:.1f}; {document['seconds']:.0f} s of CPU, {wall:.0f} s")
    if options.out:
        options.out.write_text(json.dumps([vars(each) for each in verdicts], indent=1), encoding="utf-8")
    if options.write:
        _write(document, verdicts)
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


def _document(seed: int, verdicts: list[Verdict], median: float, figures: dict[str, Any]) -> dict[str, Any]:
    machine = this_machine()
    return {
        "command": " ".join([COMMAND, *sys.argv[1:]]),
        "seed": seed,
        "date": datetime.now(UTC).date().isoformat(),
        "machine": {"cpu": machine.cpu, "cores": os.cpu_count(), "system": f"{platform.system()} {platform.machine()}"},
        "versions": {"Python": platform.python_version()} | {name: version(name) for name in PACKAGES},
        "seconds": round(sum(each.seconds + each.truth_seconds for each in verdicts)),
        "most steps": MOST_STEPS,
        "median": median,
        "outcomes": dict(Counter(each.outcome for each in verdicts)),
        "kinds": figures,
    }


def _write(document: dict[str, Any], verdicts: list[Verdict]) -> None:
    """Write page and figures; of refused cases their sentences, of those that are faulty their scenes."""
    rows = [
        {name: value for name, value in vars(each).items() if value == value and value not in ("", ())}
        | (
            {"scene": reproduction(case(each.kind, each.seed, each.number))}
            if each.outcome not in ("refused", "held")
            else {}
        )
        for each in verdicts
        if each.outcome != "held" or each.sentence
    ]
    lines = ",\n".join(f"  {json.dumps(row, ensure_ascii=False)}" for row in rows)
    head = json.dumps(document, indent=1, ensure_ascii=False)[:-2]
    docs = ROOT / "docs"
    (docs / "honesty.json").write_text(f'{head},\n "cases": [\n{lines}\n ]\n}}\n', encoding="utf-8")
    (docs / "honesty.md").write_text(page(document, verdicts), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
