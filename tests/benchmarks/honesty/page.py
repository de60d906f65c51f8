"""The figures of a campaign, and the page docs/honesty.md."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .judge import FLOOR, Verdict
from .quad import MOST_STEPS
from .scenes import KINDS

COMMAND = "python -m tests.benchmarks.honesty"
SHOWN = 12
OUTCOMES = "held", "exceeded", "refused", "misadvised", "undecided", "dear", "fault"
FAULTY = "exceeded", "misadvised", "fault"

TEXT = """# Honesty of the stated accuracy

A run of `inertia simulate` states the error of its attitude, in rad, at the worst sample (`accuracy.reached`). Is that
true? Random scenes of every kind, those first of all in which errors grow, against the truth in quadruple precision:

    python -m tests.benchmarks.honesty --write                     # all of this, into this page
    python -m tests.benchmarks.honesty --cases 500 --seed 7        # a shorter campaign, of other scenes
    python -m tests.benchmarks.honesty --only upright --case 15    # one case again: its scene as JSON, claim and error

{headline}

{machine} The figures are in [honesty.json](honesty.json); with `--only KIND … --write` those of the
others stay as they were taken, from the code of then.

| Kind | | Cases | Refused | Judged | Error above claim | Claim ÷ error, median | 95 % | least |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
{kinds}

* **Error above claim**: the attitude at some sample, of those up to which the run says that it holds, is off by more
  than the claim, and by more than what the truth itself may be off. There is no tolerance.
* **Claim ÷ error** is the claim over the largest error at a sample, which counts as {floor:.1e} rad where it is less:
  an attitude of four float64 is rounded by about that.
* **Judged** are the runs with an answer and a truth: {undecided} runs are left out in which the truth itself is not
  known to within the claim, and {dear} whose truth takes more than {steps:,} steps. {until} say that they hold up to an
  instant within the run only, because the bounds of the mass properties decide from there on.
* For a part the truth is that of its mesh, and the claim counts with what the bounds of its mass properties may do
  (`RunError.inputs`).
{exceeded}
## How the truth is known

Every figure of a scene is taken at its word, as the float64 that it is. Attitudes are brought to unit length, tensors
diagonalised and moved to the fixed point with 50 digits; meshes are integrated in integers. What follows shares no code
with the package:

* **Rigid bodies** under any loads, on an axle or rolling: Newton's and Euler's equations along the body, integrated by
  Taylor series in quadruple precision (113 bits, heyoka) to 1e-31 and again to 1e-27, with steps of other lengths. What
  the two are apart is what the truth may be off. A torque that jumps is integrated from jump to jump.
* **Long times** (up to 1e15 rad): the textbook's closed form in Legendre's integrals, with 60 digits (mpmath).
* **Deforming bodies**: products of exponentials and Gauss collocation in 80-bit floats, by steps of two lengths.

## Refusals

A run that does not reach the accuracy that its scene asks for is refused; so is a scene that cannot be. Half of the
scenes ask for the 1e-10 rad that is the default, most others for something between 1e-14 and 1e-3. Where a refusal
names an accuracy that is reached, the run is made again at that one, and judged like the others.

| Cases | Made again, and judged | Refused again | Kinds | Sentence |
| ---: | ---: | ---: | --- | --- |
{refusals}

## Closest calls

| Kind | Case | Model | Claim | Error | Truth known to |
| --- | ---: | --- | ---: | ---: | ---: |
{closest}
"""


Row = dict[str, Any]


def summary(verdicts: Sequence[Verdict]) -> Row:
    """Return the figures of one kind: counts, ratios, refusals by reason, and the rows that are shown."""
    counts = Counter(each.outcome for each in verdicts)
    judged = sorted((each for each in verdicts if each.outcome in ("held", "exceeded")), key=lambda each: each.ratio)
    reasons: dict[str, Counter[str]] = {}
    for each in verdicts:
        if each.sentence and each.outcome != "fault":
            reasons.setdefault(reason(each.sentence), Counter())[each.outcome] += 1
    return {
        "cases": len(verdicts),
        **{name: counts[name] for name in OUTCOMES},
        "seconds": round(sum(each.seconds for each in verdicts), 1),
        "seconds of the truth": round(sum(each.truth_seconds for each in verdicts), 1),
        "ended early": sum(each.until is not None for each in judged),
        "refusals": {words: dict(each) for words, each in reasons.items()},
        "closest": [_row(each) for each in judged[:SHOWN]],
        "faulty": [_row(each) | {"sentence": each.sentence} for each in verdicts if each.outcome in FAULTY],
        "ratios": [float(f"{each.ratio:.3g}") for each in judged],
    }


def _row(each: Verdict) -> Row:
    names = ("kind", "number", "outcome", "model", "method", "claim", "error", "truth")
    return {name: value for name in names if (value := getattr(each, name)) == value}


def page(document: Mapping[str, Any]) -> str:
    """Return the text of docs/honesty.md."""
    rows: list[Row] = list(document["kinds"].values())
    ratios = [ratio for row in rows for ratio in row["ratios"]]
    total = {name: sum(row[name] for row in rows) for name in ("cases", *OUTCOMES, "ended early")}
    seconds = sum(row["seconds"] + row["seconds of the truth"] for row in rows)
    machine = document["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in document["versions"].items())
    return TEXT.format(
        headline=(
            f"**{total['cases']:,} cases, seed {document['seed']}: the error exceeds the claim in "
            f"{total['exceeded']:,} of {len(ratios):,}, and the claim is {_short(float(np.median(ratios)))} times the "
            f"error in the middle.** {total['refused']:,} scenes were refused, {total['fault']:,} ended in a fault."
        ),
        machine=(
            f"Taken in {seconds:,.0f} s of CPU time on {machine['cpu']}, {machine['system']}, {document['date']}, "
            f"with {versions}."
        ),
        kinds="\n".join(_kind(kind, row) for kind, row in document["kinds"].items()),
        floor=FLOOR,
        until=total["ended early"],
        undecided=total["undecided"],
        dear=total["dear"],
        steps=MOST_STEPS,
        exceeded=_faulty([each for row in rows for each in row["faulty"]]),
        refusals=_refusals(document["kinds"]),
        closest="\n".join(
            _shown(each) for each in sorted((each for row in rows for each in row["closest"]), key=_ratio)[:SHOWN]
        ),
    )


def _kind(kind: str, row: Row) -> str:
    ratios = row["ratios"]
    shares = [_short(float(np.quantile(ratios, part))) for part in (0.5, 0.95, 0.0)] if ratios else ["–"] * 3
    what = (KINDS[kind].__doc__ or "").removeprefix("Return ").rstrip(".")
    counts = [f"{count:,}" for count in (row["cases"], row["refused"], len(ratios), row["exceeded"])]
    return f"| `{kind}` | {' | '.join([what, *counts, *shares])} |"


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 99.5 else f"{value:.3g}"


def _ratio(row: Row) -> float:
    return float(row["claim"] / max(row["error"], FLOOR)) if "error" in row else 0.0


def _shown(row: Row) -> str:
    method = row["model"] if row["method"].startswith("closed form") else f"{row['model']}, {row['method']}"
    figures = " | ".join(f"{row[name]:.2e}" if name in row else "–" for name in ("claim", "error", "truth"))
    return f"| `{row['kind']}` | {row['number']} | {method or row['outcome']} | {figures} |"


def _faulty(rows: Sequence[Row]) -> str:
    if not rows:
        return ""
    head = ["", "## Errors above the claim, and faults", "", "| Kind | Case | Model | Claim | Error | Truth known to |"]
    return "\n".join([*head, "| --- | ---: | --- | ---: | ---: | ---: |", *map(_shown, sorted(rows, key=_ratio)), ""])


def reason(sentence: str) -> str:
    """Return a refusal without its figures.

    >>> reason("run.accuracy asks for 1e-14 rad, but the model reaches 2.5e-13 rad over 3 s: ask for that")
    'run.accuracy asks for … rad, but the model reaches … rad over … s: ask for that'
    """
    return re.sub(r"(?<![\w.])-?\d[\d.]*(e[-+]?\d+)?", "…", sentence.removeprefix("the scene: "))


def _refusals(kinds: Mapping[str, Row]) -> str:
    reasons: dict[str, dict[str, Counter[str]]] = {}
    for kind, row in kinds.items():
        for words, outcomes in row["refusals"].items():
            reasons.setdefault(words, {})[kind] = Counter(outcomes)
    lines = []
    for words, by_kind in sorted(reasons.items(), key=lambda item: -sum(each.total() for each in item[1].values())):
        total = sum(by_kind.values(), Counter())
        again = total.total() - total["refused"] - total["misadvised"]
        named = ", ".join(f"{kind} {each.total()}" for kind, each in by_kind.items())
        lines.append(f"| {total.total():,} | {again:,} | {total['misadvised']:,} | {named} | {words} |")
    return "\n".join(lines)
