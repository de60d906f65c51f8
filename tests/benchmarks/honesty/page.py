"""The figures of a campaign, and the page docs/honesty.md."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .judge import FLOOR, Verdict
from .scenes import KINDS

COMMAND = "python -m tests.benchmarks.honesty"
SHOWN = 12

TEXT = """# Honesty of the stated accuracy

A run of `inertia simulate` states the error of its attitude, in rad, at the worst sample (`accuracy.reached`). Is that
true? Random scenes of every kind, those first of all in which errors grow, against the truth in quadruple precision:

    {command}
    python -m tests.benchmarks.honesty --cases 500 --seed 7        # a shorter campaign, of other scenes
    python -m tests.benchmarks.honesty --only upright --case 15    # one case again: its scene as JSON, claim and error

{headline}

{machine} Every verdict that is not *held*, and the figures below, are in [honesty.json](honesty.json).

| Kind | | Cases | Refused | Judged | Error above claim | Claim ÷ error, median | 95 % | least |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
{kinds}

* **Error above claim**: the attitude at some sample, of those up to which the run says that it holds, is off by more
  than the claim, and by more than what the truth itself may be off. There is no tolerance.
* **Claim ÷ error** is the claim over the largest error at a sample, which counts as {floor:.1e} rad where it is less:
  an attitude of four float64 is rounded by about that. Of all cases judged the median is {median:.1f}.
* **Judged** are the runs with an answer and a truth: {undecided} runs are left out in which the truth itself is not
  known to within the claim, and {dear} whose truth takes more than {steps:,} steps.
{exceeded}
## How the truth is known

Every figure of a scene is taken at its word, as the float64 that it is. Attitudes are brought to unit length, tensors
diagonalised and moved to the fixed point with 50 digits; meshes are integrated in integers. What follows shares no code
with the package:

* **Rigid bodies** under any loads, on an axle or rolling: Newton's and Euler's equations along the body, integrated by
  Taylor series in quadruple precision (113 bits, heyoka) to 1e-33 and again to 1e-28, with steps of other lengths. What
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


def summary(verdicts: Sequence[Verdict]) -> dict[str, dict[str, Any]]:
    """Return the figures by kind."""
    figures = {}
    for kind in KINDS:
        if some := [each for each in verdicts if each.kind == kind]:
            counts = Counter(each.outcome for each in some)
            ratios = [each.ratio for each in some if each.outcome in ("held", "exceeded")]
            median, high = np.quantile(ratios, [0.5, 0.95]).tolist() if ratios else (None, None)
            figures[kind] = {
                "cases": len(some),
                **{
                    name: counts[name]
                    for name in ("held", "exceeded", "refused", "misadvised", "undecided", "dear", "fault")
                },
                "median": median,
                "high": high,
                "least": min(ratios, default=None),
                "seconds": round(sum(each.seconds for each in some), 1),
                "seconds of the truth": round(sum(each.truth_seconds for each in some), 1),
            }
    return figures


def page(document: Mapping[str, Any], verdicts: Sequence[Verdict]) -> str:
    """Return the text of docs/honesty.md."""
    judged = [each for each in verdicts if each.outcome in ("held", "exceeded")]
    counts = Counter(each.outcome for each in verdicts)
    machine, middle = document["machine"], _short(document["median"])
    versions = ", ".join(f"{name} {version}" for name, version in document["versions"].items())
    return TEXT.format(
        command=document["command"],
        headline=(
            f"**{len(verdicts):,} cases, seed {document['seed']}: the error exceeds the claim in "
            f"{counts['exceeded']:,} of {len(judged):,}, and the claim is {middle} times the error in the middle.** "
            f"{counts['refused']:,} runs were refused, {counts['fault']:,} ended in a fault."
        ),
        machine=(
            f"Taken in {document['seconds']:,.0f} s of CPU time on {machine['cpu']}, {machine['system']}, "
            f"{document['date']}, with {versions}."
        ),
        kinds="\n".join(_kind(kind, row) for kind, row in document["kinds"].items()),
        floor=FLOOR,
        median=document["median"],
        undecided=counts["undecided"],
        dear=counts["dear"],
        steps=document["most steps"],
        exceeded=_exceeded([each for each in verdicts if each.outcome in ("exceeded", "misadvised", "fault")]),
        refusals=_refusals([each for each in verdicts if each.sentence and each.outcome != "fault"]),
        closest="\n".join(_row(each) for each in sorted(judged, key=lambda each: each.ratio)[:SHOWN]),
    )


def _kind(kind: str, row: Mapping[str, Any]) -> str:
    judged = row["held"] + row["exceeded"]
    ratios = " | ".join("–" if row[name] is None else _short(row[name]) for name in ("median", "high", "least"))
    what = (KINDS[kind].__doc__ or "").removeprefix("Return ").rstrip(".")
    return (
        f"| `{kind}` | {what} | {row['cases']:,} | {row['refused']:,} | {judged:,} | {row['exceeded']:,} | {ratios} |"
    )


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 99.5 else f"{value:.3g}"


def _row(each: Verdict) -> str:
    method = each.model if each.method.startswith("closed form") else f"{each.model}, {each.method}"
    return f"| `{each.kind}` | {each.number} | {method} | {each.claim:.2e} | {each.error:.2e} | {each.truth:.0e} |"


def _exceeded(faulty: Sequence[Verdict]) -> str:
    if not faulty:
        return ""
    worst = sorted(faulty, key=lambda each: each.ratio if each.outcome == "exceeded" else 0.0)
    head = ["", "## Errors above the claim", "", "| Kind | Case | Model | Claim | Error | Truth known to |"]
    return "\n".join([*head, "| --- | ---: | --- | ---: | ---: | ---: |", *map(_row, worst), ""])


def reason(sentence: str) -> str:
    """Return a refusal without its figures.

    >>> reason("run.accuracy asks for 1e-14 rad, but the model reaches 2.5e-13 rad over 3 s: ask for that")
    'run.accuracy asks for … rad, but the model reaches … rad over … s: ask for that'
    """
    return re.sub(r"(?<![\w.])-?\d[\d.]*(e[-+]?\d+)?", "…", sentence.removeprefix("the scene: "))


def _refusals(refused: Sequence[Verdict]) -> str:
    reasons: dict[str, list[Verdict]] = {}
    for each in refused:
        reasons.setdefault(reason(each.sentence), []).append(each)
    rows = []
    for words, some in sorted(reasons.items(), key=lambda row: -len(row[1])):
        kinds, outcomes = Counter(each.kind for each in some), Counter(each.outcome for each in some)
        again = len(some) - outcomes["refused"] - outcomes["misadvised"]
        named = ", ".join(f"{kind} {n}" for kind, n in kinds.most_common())
        rows.append(f"| {len(some):,} | {again:,} | {outcomes['misadvised']:,} | {named} | {words} |")
    return "\n".join(rows)
