"""`Comparison` of two budgets → the document ``inertia/budget-diff/1``, and text."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.assembly.compare import SPREAD, Change, Comparison, Own
from inertia.report.budget.document import COLUMNS, limit_document, spread_document
from inertia.report.budget.text import figure, limit_words
from inertia.report.numerals import columns, row, table

_UNSURE = (
    "No part changed by itself, but the uncertainty of the whole did: parts have other inputs in common than before, "
    "or groups turn about other places."
)


def comparison_document(comparison: Comparison) -> dict[str, Any]:
    """Return the comparison as ``inertia/budget-diff/1``; numbers are SI."""
    old, new = comparison.old.properties, comparison.new.properties
    return {
        "schema": "inertia/budget-diff/1",
        "old": comparison.old.assembly.path,
        "new": comparison.new.assembly.path,
        "verdicts": [comparison.old.verdict, comparison.new.verdict],
        "mass": [old.mass, new.mass],
        "predicted_mass": [comparison.old.total.predicted_mass, comparison.new.total.predicted_mass],
        "center_of_mass": [old.center_of_mass.tolist(), new.center_of_mass.tolist()],
        "inertia": [old.inertia.tolist(), new.inertia.tolist()],
        "sigma": [spread_document(each.total.sigma) for each in (comparison.old, comparison.new)],
        "limits": [[None if limit is None else limit_document(limit) for limit in pair] for pair in comparison.limits],
        "changes": [
            {
                "part": each.name,
                "kind": each.kind,
                "quantity": _pair(each, "quantity"),
                "basic_mass": _pair(each, "mass"),
                "predicted_mass": _pair(each, "predicted_mass"),
                "sigma": [
                    None if own is None else dict(zip(COLUMNS, own.spread.tolist(), strict=True))
                    for own in (each.old, each.new)
                ],
                "position_uncertainty": [own and own.misplacement[0] for own in (each.old, each.new)],
                "angle_uncertainty": [own and own.misplacement[1] for own in (each.old, each.new)],
                "maturity": _pair(each, "maturity"),
                "category": _pair(each, "category"),
                "effect": {
                    "mass": each.mass,
                    "predicted_mass": each.predicted_mass,
                    "center_of_mass": each.center_of_mass.tolist(),
                    "inertia": each.inertia.tolist(),
                },
            }
            for each in comparison.changes
        ],
    }


def comparison_text(comparison: Comparison) -> str:
    """Return the comparison as text: the whole before and after, then each part that is not as it was."""
    return "\n".join(_lines(comparison))


def _lines(comparison: Comparison) -> Iterator[str]:
    old, new = comparison.old, comparison.new
    metres, unit = float(new.assembly.unit.metres), new.assembly.unit.name
    yield row("Old", f"{old.assembly.path}: {(old.verdict or 'no limits').upper()}")
    yield row("New", f"{new.assembly.path}: {(new.verdict or 'no limits').upper()}")
    for label, what, of in (
        ("Basic mass", "basic_mass", "mass"),
        ("Predicted mass", "predicted_mass", "predicted_mass"),
    ):
        a, b = (getattr(each.total, what) for each in (old, new))
        both = [figure(getattr(each.total, what), getattr(each.total.sigma, of)) for each in (old, new)]
        yield row(label, f"{' → '.join(both)} kg ({b - a:+.4g})")
    shift = (new.properties.center_of_mass - old.properties.center_of_mass) / metres
    moves = (f"{k:+.4g}" if abs(k) > 1e-9 else "0" for k in shift.tolist())
    yield row("Centre of mass", f"moves by {', '.join(moves)} {unit}")
    yield row("Tensor about it", f"{columns((new.properties.inertia - old.properties.inertia).diagonal())}  kg m² more")
    yield ""
    for pair in comparison.limits:
        words = [
            "none" if limit is None else limit_words(limit, each.assembly.unit)
            for limit, each in zip(pair, (old, new), strict=True)
        ]
        yield from [row("Limit", words[0])] if words[0] == words[1] else map(row, ("Old limit", "New limit"), words)
    if comparison.limits:
        yield ""
    if not comparison.changes:
        yield "No part changed." if comparison.is_as_sure else _UNSURE
        return
    heads = ("part", "", "qty", "kg", "+kg", f"x +{unit}", "y", "z", "+Ixx kg m²", "+Iyy", "+Izz", "")
    nothing = 1e-12 * float(np.abs(old.properties.inertia).max())
    beside = (", ".join(_beside(each, comparison.rounding, metres, unit)) for each in comparison.changes)
    rows = [
        heads,
        *((*_row(each, metres, nothing), more) for each, more in zip(comparison.changes, beside, strict=True)),
    ]
    yield from table(rows, left=(0, 1, len(heads) - 1))


def _row(change: Change, metres: float, nothing: float) -> tuple[str, ...]:
    shift, more = change.center_of_mass / metres, change.inertia.diagonal()
    return (
        change.name,
        change.kind,
        _arrow(*(str(own.quantity) if own else "" for own in (change.old, change.new))),
        _arrow(*(f"{own.mass:.5g}" if own else "" for own in (change.old, change.new))),
        f"{change.mass:+.4g}",
        *(f"{k:+.3g}" if abs(k) > 1e-9 else "0" for k in shift.tolist()),
        *(f"{k:+.3g}" if abs(k) > nothing else "0" for k in more.tolist()),
    )


def _beside(change: Change, rounding: Float, metres: float, unit: str) -> Iterator[str]:
    """Yield what else changed of a part that is in both."""
    old, new = change.old, change.new
    if old is None or new is None:
        return
    a, b = old.spread, new.spread
    kinds = ("position", metres, f" {unit}"), ("angle", math.radians(1.0), "°")
    misplaced = [
        f"u of {what} {was / one:.3g} → {now / one:.3g}{sign}"
        for (what, one, sign), was, now in zip(kinds, old.misplacement, new.misplacement, strict=True)
        if not math.isclose(was, now, rel_tol=SPREAD)
    ]
    differs = np.abs(a - b) > rounding + SPREAD * np.maximum(a, b)
    if differs[0]:
        yield f"u {a[0]:.2g} → {b[0]:.2g} kg"
    elif not misplaced and differs.any():
        yield "its uncertainty"
    yield from misplaced
    for name in ("maturity", "category"):
        words = [getattr(own, name) or "none" for own in (old, new)]
        if words[0] != words[1]:
            yield f"{name} {' → '.join(words)}"


def _arrow(old: str, new: str) -> str:
    return old if old == new else f"{old} → {new}".strip()


def _pair(change: Change, field: str) -> list[Any]:
    def value(own: Own | None) -> Any:
        return None if own is None else getattr(own, field)

    return [value(change.old), value(change.new)]
