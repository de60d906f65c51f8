"""Run random scenes, compare the accuracy that is stated with the truth, and write docs/honesty.md."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from .judge import Verdict, judge, reproduction
from .scenes import KINDS, case

FAULTY = "exceeded", "fault"


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.honesty", description=__doc__)
    parser.add_argument("--cases", type=int, default=11000, help="in all, spread over the kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", choices=list(KINDS), default=list(KINDS), metavar="KIND")
    parser.add_argument("--case", type=int, help="run this case of the kind alone, and print it")
    parser.add_argument("--out", type=Path, help="write every case's verdict there, as JSON")
    options = parser.parse_args(arguments)
    if options.case is not None:
        one = case(options.only[0], options.seed, options.case)
        print(json.dumps(reproduction(one)))
        print(judge(one))
        return 0
    each = max(1, options.cases // len(options.only))
    verdicts: list[Verdict] = []
    begin = time.process_time()
    for kind in options.only:
        some = []
        for number in range(each):
            some.append(verdict := judge(case(kind, options.seed, number)))
            if verdict.outcome in FAULTY:
                print(
                    f"  {verdict.outcome} {kind} {number}: {verdict.model}/{verdict.method} claim {verdict.claim:.2e} "
                    f"error {verdict.error:.2e} ±{verdict.oracle:.1e} {verdict.sentence} {'; '.join(verdict.warnings)}",
                    flush=True,
                )
        verdicts += some
        counts = Counter(v.outcome for v in some)
        ratios = [v.ratio for v in some if v.outcome == "held"]
        print(
            f"{kind}: {dict(counts)}, median ratio {np.median(ratios) if ratios else np.nan:.1f}, "
            f"{sum(v.seconds for v in some):.1f} + {sum(v.oracle_seconds for v in some):.1f} s",
            flush=True,
        )
    print(f"{time.process_time() - begin:.0f} s of CPU")
    if options.out:
        rows = [
            vars(v) | ({"scene": reproduction(case(v.kind, v.seed, v.number))} if v.outcome in FAULTY else {})
            for v in verdicts
        ]
        options.out.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
