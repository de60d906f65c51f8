"""Which row of a scene's trade to take for which accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from inertia.work_precision.recommend import duration
from inertia.work_precision.scene_rows import SceneRow

_WORTH = 0.8
"""A method of one's own choice must cut the time of the planner's to this fraction, or below."""


@dataclass(frozen=True, eq=False)
class SceneRecommendation:
    """What to take for accuracies from `coarsest` to `finest`, rad: a row and a sentence; None where no row will do."""

    coarsest: float
    finest: float
    row: SceneRow | None
    sentence: str


def scene_recommendations(
    rows: Sequence[SceneRow], ladder: Sequence[float], accuracy: float | None
) -> tuple[SceneRecommendation, ...]:
    """Return one recommendation for the accuracy; without one, one for every range of the ladder with one answer."""
    rungs = ladder if accuracy is None else [accuracy]
    ranges = [list(group) for _, group in groupby(rungs, lambda rung: _told(rows, rung))]
    return tuple(_recommended(rows, group) for group in ranges)


def planned(rows: Sequence[SceneRow], accuracy: float) -> SceneRow | None:
    """Return what the planner selects for an accuracy of the ladder; None where that was not measured."""
    return next((row for row in rows if row.planned and accuracy in row.asked), None)


def advised(rows: Sequence[SceneRow], accuracy: float) -> SceneRow | None:
    """Return what the planner selects, or the fastest row that reaches the accuracy where that pays; None if none."""
    own = planned(rows, accuracy)
    fastest = min((row for row in rows if row.reached <= accuracy), key=_time, default=None)
    if own is not None and own.reached <= accuracy and (fastest is None or _time(fastest) > _WORTH * _time(own)):
        return own
    return fastest


def _time(row: SceneRow) -> float:
    return row.time.median


def _told(rows: Sequence[SceneRow], accuracy: float) -> tuple[str | None, str | None]:
    """Identify what a sentence is about: the methods advised and planned."""
    row, own = advised(rows, accuracy), planned(rows, accuracy)
    return None if row is None else row.method, None if own is None else own.method


def _recommended(rows: Sequence[SceneRow], rungs: Sequence[float]) -> SceneRecommendation:
    coarsest, finest = rungs[0], rungs[-1]
    row = advised(rows, finest)
    asked = f"For {coarsest:g}" + (f" to {finest:g}" if finest != coarsest else "") + " rad"
    return SceneRecommendation(coarsest, finest, row, f"{asked}: {_said(rows, row, rungs)}.")


def _said(rows: Sequence[SceneRow], row: SceneRow | None, rungs: Sequence[float]) -> str:
    finest = rungs[-1]
    own = planned(rows, finest)
    if row is None:
        nearest = min(rows, key=lambda each: each.reached)
        return f"no row reaches it, the nearest being {nearest.method} with {nearest.reached:.2g} rad"
    taken = [duration(_time(each)) for each in (advised(rows, rungs[0]), row) if each is not None]
    times = " to ".join(dict.fromkeys(taken))
    if row is own:
        return f"{row.method}, which the planner selects, {times}, off by {row.reached:.2g} rad at most"
    said = f"{row.method} asked for {row.asked[0]:g} rad, {times}, off by {row.reached:.2g} rad"
    if own is None:
        return said
    return f"{said}, instead of {duration(_time(own))} for {own.method}, which the planner selects"
