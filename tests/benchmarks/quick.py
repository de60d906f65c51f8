"""What README and docs state, figure by figure, beside what is measured here: ``python -m tests.benchmarks --quick``.

Speed is a ratio of one run, and holds where it is at least two thirds of what is stated.
"""

from __future__ import annotations

import json
import subprocess
import sys
import sysconfig
import tempfile
import time
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

from .claims import README, Claim, Outcome
from .extremes.sweep import Tally, sweep
from .measure import ROOT, python_module
from .table import apart, targets
from .whole import DATA, stl_file

VARY = 1.5
"""By how much ratios of speed differ from one processor to another."""


@cache
def benchmarks() -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the stored benchmarks, and those of 1,300,000 triangles measured here (two minutes)."""
    with tempfile.TemporaryDirectory(prefix="inertia-quick-") as folder:
        options = ("--sizes", 1_300_000, "--orders", "rows", "shuffled", "bodies", "--rounds", 2)
        python_module("tests.benchmarks", *options, "--into", folder, env={})
        here = json.loads((Path(folder) / "benchmarks.json").read_text(encoding="utf-8"))
    return json.loads((ROOT / "docs/benchmarks.json").read_text(encoding="utf-8")), here


def _ratio(words: str) -> Outcome:
    """Compare a ratio of the benchmarks with that of the stored ones."""
    stated, here = ({target.name: target for target in targets(each)} for each in benchmarks())
    name = words.strip("| ")
    if name not in here:
        return Outcome("the other program is not installed", None)
    value, first = here[name].value, stated[name].value
    holds = value * VARY >= first if here[name].above else value <= VARY * first
    return Outcome(f"{value:.3g}, where the page says {first:.3g}", holds)


def _agree(words: str) -> Outcome:
    most = max(map(apart, benchmarks()[1]["files"].values()))
    return Outcome(f"volumes of all programs within {most:.0e}", most <= 1e-12)


def _dear(rung: str, stated: float, words: str) -> Outcome:
    """Compare what a method costs, as a multiple of float64, with what the page says."""
    programs = benchmarks()[1]["accuracy"]["at the origin"]
    ratio = programs[f"inertia, {rung}"]["ns"] / programs["inertia, float64"]["ns"]
    return Outcome(f"{ratio:.1f} times", stated / VARY <= ratio <= stated * VARY)


def _places(words: str) -> Outcome:
    """Compare errors with bounds on 320,356 triangles, by fractions."""
    rows = [row for case in benchmarks()[1]["accuracy"].values() for row in case.values() if "bound" in row]
    errors = [row["error"] for row in rows]
    within = all(row["error"] <= row["bound"] for row in rows)
    return Outcome(f"errors up to {max(errors):.1e}, each within its bound" if within else "beyond a bound", within)


@cache
def _swept() -> Tally:
    return sweep(20_261_122, 100)


def _exceeded(words: str) -> Outcome:
    tally = _swept()
    compared = sum(len(values) for rung in tally.ratios.values() for values in rung.values())
    return Outcome(f"{tally.exceeded()} of {compared:,} over 100 other meshes, by fractions", tally.exceeded() == 0)


def _typical(_: str) -> Outcome:
    ratios = [ratio for values in _swept().ratios["float64"].values() for ratio in values if ratio < float("inf")]
    return Outcome(f"{median(ratios):.1f} times, the median", median(ratios) <= 5.0)


def _honest(words: str) -> Outcome:
    """Judge a few random motions of the quick kinds, against quadruple precision."""
    if find_spec("heyoka") is None:
        return Outcome("heyoka, which integrates the truth, is not installed", None)
    from .honesty.judge import judge
    from .honesty.scenes import case

    verdicts = [judge(case(kind, 20_261_122, number)) for kind in MOTIONS for number in range(3)]
    judged = [verdict for verdict in verdicts if verdict.outcome in ("held", "exceeded")]
    exceeded = sum(verdict.outcome == "exceeded" for verdict in judged)
    return Outcome(f"{exceeded} of {len(judged)} other motions, by quadruple precision", exceeded == 0)


def _same_bits(words: str) -> Outcome:
    """Analyse one file of 65 MB in memory and piece by piece, which says what it did not look for."""
    command = [str(Path(sysconfig.get_path("scripts")) / "inertia"), "analyse", "--json", "--unit", "mm"]
    file = str(stl_file(DATA, 1_300_000, "shuffled"))
    printed = [
        subprocess.run([*command, *options, file], capture_output=True, text=True, check=True).stdout
        for options in ((), ("--memory", "130MB"))
    ]
    whole, pieces = map(json.loads, printed)
    same = all(whole[name] == pieces[name] for name in ("volume", "center_of_mass", "inertia", "principal_moments"))
    return Outcome("the same digits in 130 MB" if same else "other digits", same and printed[0] != printed[1])


MOTIONS = "free", "separatrix", "heavy", "torques", "axial", "hinged", "mesh", "nearly"
DOCS = (
    *(
        Claim("docs/benchmarks.md", f"| {name} |", _ratio)
        for name in (
            "kernel, 1,300,000: libigl ÷ inertia",
            "kernel, 1,300,000: trimesh ÷ inertia",
            "kernel, 1,300,000: libigl ÷ sums alone",
            "kernel, 1,300,000: trimesh ÷ sums alone",
            "file, 1,300,000: CPU, trimesh ÷ inertia",
            "file, 1,300,000 shuffled: CPU, trimesh ÷ inertia",
            "file, 1,300,000 in bodies: CPU, trimesh ÷ inertia",
            "file, 1,300,000: CPU, many bodies ÷ one",
            "file, 1,300,000: peak memory ÷ file",
            "208 triangles in memory: trimesh's sums ÷ `mass_properties`",
            "208 triangles in memory: trimesh's sums ÷ `many`",
            "`inertia --help`, CPU s",
            "`inertia analyse t_handle.stl`, CPU s",
        )
    ),
    Claim("docs/benchmarks.md", "All programs agree on the volume", _agree),
    Claim("docs/benchmarks.md", "One mesh of 320,356 triangles in three places", _places),
    Claim(
        "docs/accuracy.md", "Double-double is some five times as dear as float64", partial(_dear, "double-double", 5.0)
    ),
    Claim("docs/accuracy.md", "some eighty times", partial(_dear, "exact", 80.0)),
    Claim("docs/accuracy.md", "of what follows from several of them, a few times the error", _typical),
    Claim("docs/accuracy.md", "of some seventy thousand errors none exceeds its bound", _exceeded),
    Claim("docs/extremes.md", "Errors beyond their bound: 0", _exceeded),
    Claim("docs/honesty.md", "the error exceeds the claim in 0 of", _honest),
    Claim("docs/analysing.md", "The figures have the same bits as in memory", _same_bits),
)
CLAIMS = README + DOCS


def judged() -> int:
    """Print a line for each claim; return 1 where one does not hold."""
    print("what takes longest, the ratios of speed, first: some two minutes", file=sys.stderr)
    benchmarks()
    print("| page | stated | measured here | holds |\n|---|---|---|---|")
    fails, begin = 0, time.perf_counter()
    for claim in CLAIMS:
        outcome = claim.measure(claim.words)
        fails += outcome.holds is False
        words = {True: "yes", False: "NO", None: "–"}[outcome.holds]
        stated = " ".join(claim.words.split())
        print(f"| {claim.page} | {stated} | {outcome.measured} | {words} |", flush=True)
    print(f"\n{len(CLAIMS)} claims, {fails} do not hold; {time.perf_counter() - begin:.0f} s")
    return int(fails > 0)
