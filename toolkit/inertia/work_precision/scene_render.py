"""`SceneTrade` → a table of text, and the document ``inertia/trade-scene/1``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from inertia.report.layout import row
from inertia.work_precision.recommend import duration
from inertia.work_precision.render import milliseconds, paragraph
from inertia.work_precision.scene_rows import front
from inertia.work_precision.scenes import SceneTrade


def scene_trade_document(trade: SceneTrade) -> dict[str, Any]:
    """Return the trade as ``inertia/trade-scene/1``; seconds and radians."""
    best = front(trade.rows)
    return {
        "schema": "inertia/trade-scene/1",
        "scene": trade.scene.name,
        "duration": trade.scene.run.duration,
        "samples": trade.scene.run.samples,
        "accuracy": trade.accuracy,
        "machine": asdict(trade.machine),
        "repeats": trade.repeats,
        "budget": trade.budget,
        "reference": trade.rows.index(trade.reference),
        "rows": [
            {
                "model": line.model,
                "method": line.method,
                "asked": list(line.asked),
                "planned": line.planned,
                "on_front": line in best,
                "time": asdict(line.time),
                "steps": line.steps,
                "error": line.error,
                "estimate": line.estimate,
                "reached": line.reached,
            }
            for line in trade.rows
        ],
        "skipped": [asdict(item) for item in trade.skipped],
        "recommendations": [
            {
                "coarsest": advice.coarsest,
                "finest": advice.finest,
                "row": None if advice.row is None else trade.rows.index(advice.row),
                "sentence": advice.sentence,
            }
            for advice in trade.recommendations
        ],
    }


def scene_trade_text(trade: SceneTrade) -> str:
    """Return the trade as lines of text, at most 100 columns wide but for long paths."""
    return "\n\n".join("\n".join(block) for block in (_head(trade), _table(trade), _closing(trade)))


def _head(trade: SceneTrade) -> Iterator[str]:
    run = trade.scene.run
    turned = float(np.linalg.norm(trade.scene.angular_velocity)) * run.duration
    yield row("Scene", f"{trade.scene.name}, {run.duration:g} s, {run.samples} samples")
    yield from paragraph("Start", f"the spin at the start would turn the body by {turned:.4g} rad in this time")
    yield from paragraph("Machine", f"{trade.machine}; the times are of this machine")
    yield from paragraph("Time", "CPU time of the whole simulation with the estimate of its error, median of the runs")
    best = trade.reference
    whose = f" for {best.asked[0]:g} rad, which its own estimate" if best.steps else ", which its bound"
    yield from paragraph("Reference", f"{best.model}, {best.method}{whose} puts within {best.estimate:.2g} rad")


def _table(trade: SceneTrade) -> Iterator[str]:
    best = front(trade.rows)
    yield f"{'':<39}{'asked,':>7}{'CPU,':>9}{'':>5}{'':>9}{'error,':>9}{'own':>9}"
    yield f"{'Method':<39}{'rad':>7}{'ms':>9}{'runs':>5}{'steps':>9}{'rad':>9}{'estimate':>9}"
    name = ""
    for line in trade.rows:
        shown = "" if line.method == name else line.method if len(line.method) < 39 else f"{line.method[:37]}…"
        name = line.method
        error = "–" if line.error is None else f"{line.error:.1e}"
        marks = f"{'front' if line in best else '':>7}{'plan' if line.planned else '':>6}".rstrip()
        asked = "" if len(line.asked) > 1 and not line.steps else f"{line.asked[-1]:g}"
        figures = f"{milliseconds(line.time.median):>9}{line.time.runs:>5}{line.steps:>9}"
        yield f"{shown:<39}{asked:>7}{figures}{error:>9}{line.estimate:>9.1e}{marks}"


def _closing(trade: SceneTrade) -> Iterator[str]:
    yield from paragraph(
        "Marks", "front: no other row is as fast and as accurate; plan: what the planner selects for this accuracy"
    )
    for k, advice in enumerate(trade.recommendations):
        yield from paragraph("" if k else "Recommended", advice.sentence)
    late = [f"{item.what} ({duration(item.seconds)})" for item in trade.skipped if item.seconds is not None]
    if late:
        yield from paragraph("Skipped", f"give a larger --budget for {', '.join(late)}")
    reasons = dict.fromkeys(item.why for item in trade.skipped if item.seconds is None)
    for why in reasons:
        what = "; ".join(item.what for item in trade.skipped if item.why == why)
        yield from paragraph("Left out", f"{what}: {why}")
