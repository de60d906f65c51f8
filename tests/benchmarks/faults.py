"""Faulty meshes by the thousand: how many the intact solid's exact properties escape, and how wide the bounds are.

Run as ``python -m tests.benchmarks.faults --cases 3000``.
"""

import argparse
from collections import defaultdict

import numpy as np
from tests.mass.faulty import SOLIDS, Case, case


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=3000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first case")
    options = parser.parse_args()
    names = list(SOLIDS)
    by_kind: dict[str, list[Case]] = defaultdict(list)
    for seed in range(options.first, options.first + options.cases):
        name = names[seed % len(names)]
        result = case(name, seed)
        by_kind["two of them" if "+" in result.kind else result.kind].append(result)
        if result.held is False:
            print(f"escaped: {name}, seed {seed}: {result}")
    print("fault | cases | refused | escaped | median bound of the volume | over the true error, median")
    for kind, cases in sorted(by_kind.items()):
        answers = [each for each in cases if each.held is not None]
        ratios = [each.width / each.off for each in answers if each.off > 1e-13]
        widths = f"{np.median([each.width for each in answers]):.1e}" if answers else "-"
        ratio = f"{np.median(ratios):.0f}" if ratios else "-"
        escaped = sum(each.held is False for each in cases)
        print(f"{kind} | {len(cases)} | {len(cases) - len(answers)} | {escaped} | {widths} | {ratio}")
    return int(any(each.held is False for cases in by_kind.values() for each in cases))


if __name__ == "__main__":
    raise SystemExit(main())
