"""`Ensemble` → lines of text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from inertia.dynamics.spread.ensemble import Ensemble
from inertia.dynamics.spread.follow import FOLLOWED
from inertia.dynamics.spread.results import PERCENTILES
from inertia.report.numerals import LABEL, row, wrapped

_LISTED = 3  # draws that were not followed
_ROWS = 24  # points of sweeps that are listed one by one
_WIDTH = 14
_LEAST_SHARE = 0.005  # of the variance, that an input must have to be named
_LINEAR = 0.8  # of the variance, which inputs should explain where shares are to mean much
_UNITS = {
    "deviation": "rad",
    "tilt": "rad",
    "spin": "rad/s",
    "energy": "J",
    "angular_velocity": "rad/s",
    "angular_momentum": "kg m²/s",
    "position": "m",
}


def ensemble_text(ensemble: Ensemble) -> str:
    """Return an ensemble as lines of text."""
    listed = all(each.swept for each in ensemble.inputs) and len(ensemble.values) <= _ROWS
    blocks = [
        list(_input_lines(ensemble)),
        list(_accuracy_lines(ensemble)),
        list(_point_lines(ensemble) if listed else _percentile_lines(ensemble)),
        [] if listed else list(_driver_lines(ensemble)),
        list(_event_lines(ensemble)),
        [line for warning in ensemble.nominal.warnings for line in wrapped("Note", warning)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _input_lines(ensemble: Ensemble) -> Iterator[str]:
    yield row("Scene", ensemble.scene.name)
    width = max(len(each.path) for each in ensemble.inputs)
    for k, each in enumerate(ensemble.inputs):
        yield row("" if k else "Varied", f"{each.path:<{width}}  {each.described}")
    drawn = "" if all(each.swept for each in ensemble.inputs) else f", seed {ensemble.seed}"
    counts = ensemble.state_counts
    yield row("Draws", f"{len(ensemble.values)}{drawn}: {', '.join(f'{n} {state}' for state, n in counts.items())}")
    for draw, sentence in list(ensemble.sentences.items())[:_LISTED]:
        yield from wrapped("", f"draw {draw}: {sentence}")
    out = len(ensemble.values) - counts.get(FOLLOWED, 0)
    if out > _LISTED:
        yield row("", f"… and {out - _LISTED} more")


def _accuracy_lines(ensemble: Ensemble) -> Iterator[str]:
    models = Counter(ensemble.model_counts)
    yield row("Model", ", ".join(f"{name} ({count})" for name, count in models.most_common()))
    worst, requested = float(np.nanmax(ensemble.reached)), ensemble.nominal.error.requested
    yield row("Accuracy", f"attitude of every draw to {worst:.2g} rad, {requested:g} rad asked for")


def _percentile_lines(ensemble: Ensemble) -> Iterator[str]:
    """Yield where each quantity lies at the end, and the largest that it was."""
    heads = [f"{at:g} %" for at in PERCENTILES]
    yield _table_row("At the end", ["nominal", "least", *heads, "most"])
    for name, column in ensemble.ends.items():
        end = column[np.isfinite(column)]
        if end.size:
            figures = [end.min(), *np.percentile(end, PERCENTILES), end.max()]
            yield _table_row(f"  {name}{_unit(name)}", [_nominal(ensemble, name), *map(_figure, figures)])
    yield _table_row("Largest by then", ["", "least", *heads, "most"])
    for name, column in ensemble.most.items():
        largest = column[np.isfinite(column)]
        if largest.size:
            figures = [largest.min(), *np.percentile(largest, PERCENTILES), largest.max()]
            yield _table_row(f"  {name}{_unit(name)}", ["", *map(_figure, figures)])


def _nominal(ensemble: Ensemble, name: str) -> str:
    return _figure(float(ensemble.nominal_quantity(name)[-1]))


def _point_lines(ensemble: Ensemble) -> Iterator[str]:
    """Yield each point of a sweep, with the quantities at the end."""
    names = list(ensemble.ends)
    paths = [each.path for each in ensemble.inputs]
    widths = [max(_WIDTH, len(head) + 2) for head in (*paths, *names)]
    yield f"{'At the end':<{LABEL}}" + "".join(f"{head:>{w}}" for head, w in zip((*paths, *names), widths, strict=True))
    for k, values in enumerate(ensemble.values.tolist()):
        cells = [*map(_figure, values), *(_figure(column[k]) for column in ensemble.ends.values())]
        yield " " * LABEL + "".join(f"{cell:>{w}}" for cell, w in zip(cells, widths, strict=True))


def _driver_lines(ensemble: Ensemble) -> Iterator[str]:
    """Yield which inputs the spread at the end comes from, the largest share first."""
    label = "Driven by"
    for name in ensemble.ends:
        drivers = ensemble.drivers(name)
        if drivers is None:
            continue
        linear = drivers.explained >= _LINEAR
        parts = []
        for k in np.argsort(-drivers.share):
            if drivers.share[k] >= _LEAST_SHARE:
                rank = "" if linear else f" (rank correlation {drivers.rank[k]:+.2f})"
                parts.append(f"{ensemble.inputs[k].path} {100 * drivers.share[k]:.0f} %{rank}")
        if not linear:
            parts.append(f"a straight line explains {100 * drivers.explained:.0f} % only")
        yield from wrapped(label, f"{name}: {', '.join(parts)}")
        label = ""


def _event_lines(ensemble: Ensemble) -> Iterator[str]:
    count = int(ensemble.followed.sum())
    for k, (name, first) in enumerate(ensemble.events.items()):
        met = first[np.isfinite(first)]
        share = f"{name} in {len(met)} of {count} draws"
        if met.size:
            low, middle, high = (f"{t:.6g}" for t in np.percentile(met, PERCENTILES))
            share = f"{share}, first at {middle} s ({low} … {high} s, 5 … 95 %)"
        yield from wrapped("" if k else "Events", share)


def _table_row(label: str, cells: Iterable[str]) -> str:
    return f"{label:<{LABEL + 6}}" + "".join(f"{cell:>{_WIDTH}}" for cell in cells)


def _figure(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.6g}"


def _unit(name: str) -> str:
    unit = _UNITS.get(name.partition("[")[0])
    return f", {unit}" if unit else ""
