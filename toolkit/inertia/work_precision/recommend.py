"""Which row of a work-precision measurement to take for which accuracy, with the reason in a sentence."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from itertools import groupby
from typing import Generic, Literal

from inertia.mesh.checks.findings import counted
from inertia.records import dataclass
from inertia.work_precision.rows import PartRow, R, SceneRow, Skipped

Wanted = float | Literal["exact"]

_WORTH = 0.8
"""What costs more thought than the usual row must cut its time to this fraction, or below: a simpler mesh is one more
part to keep, a method of one's own choice one more line of the scene."""

_DECADES = [float(f"1e-{k}") for k in range(1, 16)]


@dataclass(frozen=True, eq=False)
class Recommendation(Generic[R]):
    """What to take for accuracies from `coarsest` to `finest`: a row and a sentence; None where no row reaches them."""

    coarsest: Wanted
    finest: Wanted
    row: R | None
    sentence: str


def part_recommendations(
    rows: Sequence[PartRow], skipped: Sequence[Skipped], accuracy: Wanted | None
) -> tuple[Recommendation[PartRow], ...]:
    """Return one recommendation for the accuracy; without one, one for every range of decades from 0.1 to 1e-15."""

    def subject(decade: Wanted) -> tuple[int, int]:
        """Identify what the sentence is about: the row, and what it is compared with."""
        return id(cheapest(rows, decade)), id(cheapest(_whole(rows), decade))

    def recommended(decades: Sequence[Wanted]) -> Recommendation[PartRow]:
        coarsest, finest = decades[0], decades[-1]
        row = cheapest(rows, finest)
        accuracies = f"For {_figure(coarsest)}" + (f" to {_figure(finest)}" if finest != coarsest else "")
        advice = _without_a_row(rows, skipped) if row is None else _with_a_row(rows, row, finest)
        return Recommendation(coarsest, finest, row, f"{accuracies}: {advice}.")

    return _by_range(_DECADES if accuracy is None else [accuracy], subject, recommended)


def scene_recommendations(
    rows: Sequence[SceneRow], ladder: Sequence[float], accuracy: float | None
) -> tuple[Recommendation[SceneRow], ...]:
    """Return one recommendation for the accuracy; without one, one for every range of the ladder with one answer."""

    def subject(rung: float) -> tuple[str | None, str | None]:
        """Identify what the sentence is about: the methods advised and planned."""
        row, own = advised(rows, rung), planned(rows, rung)
        return None if row is None else row.method, None if own is None else own.method

    def recommended(rungs: Sequence[float]) -> Recommendation[SceneRow]:
        coarsest, finest = rungs[0], rungs[-1]
        row = advised(rows, finest)
        accuracies = f"For {coarsest:g}" + (f" to {finest:g}" if finest != coarsest else "") + " rad"
        return Recommendation(coarsest, finest, row, f"{accuracies}: {_scene_advice(rows, row, rungs)}.")

    return _by_range(ladder if accuracy is None else [accuracy], subject, recommended)


def _by_range(
    accuracies: Sequence[Wanted] | Sequence[float],
    subject: Callable[..., Hashable],
    recommended: Callable[..., Recommendation[R]],
) -> tuple[Recommendation[R], ...]:
    """Return a recommendation for each range of neighbouring accuracies that have one subject."""
    return tuple(recommended(list(group)) for _, group in groupby(accuracies, subject))


def _preferred(usual: R | None, rival: R | None) -> R | None:
    """Return the rival where there is no usual row, or where the rival is worth its while."""
    if usual is None or (rival is not None and _time(rival) <= _WORTH * _time(usual)):
        return rival
    return usual


def _time(row: PartRow | SceneRow | R) -> float:
    return row.time.median


def cheapest(rows: Sequence[PartRow], accuracy: Wanted) -> PartRow | None:
    """Return the fastest row that reaches an accuracy, or None; a simpler mesh only where it is worth its while.

    As in an analysis, a row that loses the smallest moment of a slender part will do only where every other one does.
    """
    if accuracy == "exact":
        return next((row for row in rows if row.method == "exact"), None)
    reaching = [row for row in rows if row.reached <= accuracy]
    reaching = [row for row in reaching if not row.properties.loses_smallest_moment] or reaching
    whole = min(_whole(reaching), key=_time, default=None)
    return _preferred(whole, min((row for row in reaching if row.simplification), key=_time, default=None))


def _whole(rows: Sequence[PartRow]) -> list[PartRow]:
    return [row for row in rows if row.simplification is None]


def _with_a_row(rows: Sequence[PartRow], row: PartRow, accuracy: Wanted) -> str:
    time = duration(_time(row))
    if row.simplification is None:
        return f"{row.method} over the whole mesh, {time}, within {row.reached:.2g} by its bound"
    mesh = f"{row.method} over the mesh at {row.mesh} ({row.triangles} triangles), {time}"
    cost = duration(row.simplification.seconds)
    whole = cheapest(_whole(rows), accuracy)
    if whole is None:
        return f"{mesh}, off by {row.reached:.2g}; making it took {cost}"
    pays = math.ceil(row.simplification.seconds / (_time(whole) - _time(row)))
    return (
        f"{mesh} instead of {duration(_time(whole))} for {whole.method} over the whole one, off by "
        f"{row.reached:.2g}; making it took {cost}, which pays after {counted(pays, 'integration')}"
    )


def _without_a_row(rows: Sequence[PartRow], skipped: Sequence[Skipped]) -> str:
    nearest = min(rows, key=lambda row: row.reached)
    over = "the whole mesh" if nearest.simplification is None else f"the mesh at {nearest.mesh}"
    more = "" if all(item.seconds is None for item in skipped) else ", but some were skipped: give a larger budget"
    return f"no row reaches it, the nearest being {nearest.method} over {over} with {nearest.reached:.2g}{more}"


def planned(rows: Sequence[SceneRow], accuracy: float) -> SceneRow | None:
    """Return what the planner selects for an accuracy of the ladder; None where that was not measured."""
    return next((row for row in rows if row.planned and accuracy in row.asked), None)


def advised(rows: Sequence[SceneRow], accuracy: float) -> SceneRow | None:
    """Return what the planner selects, or the fastest row that reaches the accuracy where that pays; None if none."""
    own = planned(rows, accuracy)
    fastest = min((row for row in rows if row.reached <= accuracy), key=_time, default=None)
    return _preferred(own if own is not None and own.reached <= accuracy else None, fastest)


def _scene_advice(rows: Sequence[SceneRow], row: SceneRow | None, rungs: Sequence[float]) -> str:
    own = planned(rows, rungs[-1])
    if row is None:
        nearest = min(rows, key=lambda each: each.reached)
        return f"no row reaches it, the nearest being {nearest.method} with {nearest.reached:.2g} rad"
    ends = [duration(_time(each)) for each in (advised(rows, rungs[0]), row) if each is not None]
    times = " to ".join(dict.fromkeys(ends))
    if row is own:
        return f"{row.method}, which the planner selects, {times}, off by {row.reached:.2g} rad at most"
    advice = f"{row.method} asked for {row.asked[0]:g} rad, {times}, off by {row.reached:.2g} rad"
    if own is None:
        return advice
    return f"{advice}, instead of {duration(_time(own))} for {own.method}, which the planner selects"


def _figure(accuracy: Wanted) -> str:
    if isinstance(accuracy, str):
        return accuracy
    if accuracy >= 1e-3:
        return f"{accuracy:g}"
    mantissa, exponent = f"{accuracy:.5e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def duration(seconds: float) -> str:
    """Return a time with its unit.

    >>> duration(3.2e-5), duration(0.0123), duration(7.5), duration(1234.5)
    ('0.032 ms', '12.3 ms', '7.5 s', '1234 s')
    """
    if seconds >= 100:
        return f"{seconds:.0f} s"
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"
