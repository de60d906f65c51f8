"""Run the campaigns, print a line of result for each, and write docs/reliability.md where that is asked for."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

from .campaigns import CAMPAIGNS
from .page import Result, write
from .workers import Outcome, Tally, run_cases

ROOT = Path(__file__).resolve().parents[2]


def main(arguments: list[str]) -> int:
    """Run what the command line asks for; the exit code is 1 where a fault was met."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__)
    parser.add_argument("campaigns", nargs="*", metavar="CAMPAIGN", help=f"of {', '.join(CAMPAIGNS)} (all)")
    parser.add_argument("--share", type=float, default=1.0, metavar="PART", help="of the cases of a full run (1)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--from", dest="first", type=int, default=0, metavar="N", help="number of the first case")
    parser.add_argument("--case", type=int, metavar="N", help="run this case alone, in this process")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--time", type=float, default=float("inf"), metavar="SECONDS", help="for each campaign")
    parser.add_argument("--write", action="store_true", help="put the figures into docs/reliability.md and .json")
    options = parser.parse_args(arguments)
    unknown = {*options.campaigns} - {*CAMPAIGNS}
    if unknown:
        parser.error(f"no campaign is called {', '.join(unknown)}: use {', '.join(CAMPAIGNS)}")
    names = options.campaigns or list(CAMPAIGNS)
    if options.case is not None:
        return _one(names, options.seed, options.case)
    results = [_run(name, options) for name in names]
    if options.write:
        write(ROOT / "docs", results, options.seed)
    return 1 if any(result.tally.faults for result in results) else 0


def _run(name: str, options: argparse.Namespace) -> Result:
    campaign = CAMPAIGNS[name]
    count = max(1, round(options.share * campaign.cases))
    began = time.monotonic()

    def numbers():
        for number in range(options.first, options.first + count):
            if time.monotonic() - began > options.time:
                return
            yield number

    def report(tally: Tally) -> None:
        if sys.stderr.isatty():
            print(f"\r{name}: {tally.counts.total():,} of {count:,}", end="\r", file=sys.stderr)

    case, together = campaign.with_seed(options.seed), campaign.together
    tally = run_cases(case, numbers(), processes=options.processes, together=together, report=report)
    result = Result(name, campaign, tally, time.monotonic() - began)
    print(result, flush=True)
    for number, fault in sorted(tally.faults.items()):
        print(f"    {number}: {fault}", flush=True)
    return result


def _one(names: list[str], seed: int, number: int) -> int:
    outcomes: list[Outcome] = []
    for name in names:
        tally = run_cases(CAMPAIGNS[name].with_seed(seed), [number])
        outcomes += [Outcome(kind, tally.faults.get(number, "")) for kind in tally.counts]
        print(f"{name} {number}:", *outcomes[-1])
    return 1 if any(outcome.fault for outcome in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
