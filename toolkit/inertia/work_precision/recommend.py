"""Which row of a trade to take for which accuracy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Literal

from inertia.mesh.checks.findings import counted
from inertia.work_precision.rows import Row, Skipped

Wanted = float | Literal["exact"]

_WORTH = 0.8
"""A simpler mesh is one more part to keep: it must cut the time to this fraction of the whole mesh's, or below."""

_DECADES = [float(f"1e-{k}") for k in range(1, 16)]


@dataclass(frozen=True, eq=False)
class Recommendation:
    """What to take for accuracies from `coarsest` to `finest`: a row and a sentence; None where no row reaches them."""

    coarsest: Wanted
    finest: Wanted
    row: Row | None
    sentence: str


def recommendations(
    rows: Sequence[Row], skipped: Sequence[Skipped], accuracy: Wanted | None
) -> tuple[Recommendation, ...]:
    """Return one recommendation for the accuracy; without one, one for every range of decades from 0.1 to 1e-15."""
    if accuracy is not None:
        return (_recommended(rows, skipped, accuracy, accuracy),)

    def told(decade: float) -> tuple[int, int]:
        """Identify what the sentence is about: the row, and what it is compared with."""
        return id(cheapest(rows, decade)), id(cheapest(_whole(rows), decade))

    ranges = [list(decades) for _, decades in groupby(_DECADES, told)]
    return tuple(_recommended(rows, skipped, decades[0], decades[-1]) for decades in ranges)


def cheapest(rows: Sequence[Row], accuracy: Wanted) -> Row | None:
    """Return the fastest row that reaches an accuracy, or None; a simpler mesh only where it is worth its while.

    As in an analysis, a row that loses the smallest moment of a slender part will do only where every other one does.
    """
    if accuracy == "exact":
        return next((row for row in rows if row.method == "exact"), None)
    reaching = [row for row in rows if row.reached <= accuracy]
    reaching = [row for row in reaching if not row.properties.loses_smallest_moment] or reaching
    whole = min(_whole(reaching), key=_time, default=None)
    simpler = min((row for row in reaching if row.simplification is not None), key=_time, default=None)
    if whole is None or (simpler is not None and simpler.time.median <= _WORTH * whole.time.median):
        return simpler
    return whole


def _whole(rows: Sequence[Row]) -> list[Row]:
    return [row for row in rows if row.simplification is None]


def _time(row: Row) -> float:
    return row.time.median


def _recommended(
    rows: Sequence[Row],
    skipped: Sequence[Skipped],
    coarsest: Wanted,
    finest: Wanted,
) -> Recommendation:
    row = cheapest(rows, finest)
    asked = f"For {_figure(coarsest)}" + (f" to {_figure(finest)}" if finest != coarsest else "")
    said = _without_a_row(rows, skipped) if row is None else _with_a_row(rows, row, finest)
    return Recommendation(coarsest, finest, row, f"{asked}: {said}.")


def _with_a_row(rows: Sequence[Row], row: Row, accuracy: Wanted) -> str:
    time = duration(row.time.median)
    if row.simplification is None:
        return f"{row.method} over the whole mesh, {time}, within {row.reached:.2g} by its bound"
    mesh = f"{row.method} over the mesh at {row.mesh} ({row.triangles} triangles), {time}"
    made = duration(row.simplification.seconds)
    whole = cheapest(_whole(rows), accuracy)
    if whole is None:
        return f"{mesh}, off by {row.reached:.2g}; making it took {made}"
    pays = math.ceil(row.simplification.seconds / (whole.time.median - row.time.median))
    return (
        f"{mesh} instead of {duration(whole.time.median)} for {whole.method} over the whole one, off by "
        f"{row.reached:.2g}; making it took {made}, which pays after {counted(pays, 'integration')}"
    )


def _without_a_row(rows: Sequence[Row], skipped: Sequence[Skipped]) -> str:
    nearest = min(rows, key=lambda row: row.reached)
    over = "the whole mesh" if nearest.simplification is None else f"the mesh at {nearest.mesh}"
    more = "" if all(item.seconds is None for item in skipped) else ", but some were skipped: give a larger budget"
    return f"no row reaches it, the nearest being {nearest.method} over {over} with {nearest.reached:.2g}{more}"


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
