"""`Comparison` of two budgets → the document ``inertia/budget-diff/1``, and text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from inertia.assembly.compare import Change, Comparison, Own
from inertia.report.numerals import columns, number, row


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
        "changes": [
            {
                "part": each.name,
                "kind": each.kind,
                "quantity": _pair(each, "quantity"),
                "basic_mass": _pair(each, "mass"),
                "predicted_mass": _pair(each, "predicted_mass"),
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
    for label, a, b in (
        ("Basic mass", old.properties.mass, new.properties.mass),
        ("Predicted mass", old.total.predicted_mass, new.total.predicted_mass),
    ):
        yield row(label, f"{number(a)} → {number(b)} kg ({b - a:+.4g})")
    shift = (new.properties.center_of_mass - old.properties.center_of_mass) / metres
    moves = (f"{k:+.4g}" if abs(k) > 1e-9 else "0" for k in shift.tolist())
    yield row("Centre of mass", f"moves by {', '.join(moves)} {unit}")
    yield row("Tensor about it", f"{columns((new.properties.inertia - old.properties.inertia).diagonal())}  kg m² more")
    yield ""
    if not comparison.changes:
        yield "No part changed."
        return
    heads = ("part", "", "qty", "kg", "+kg", f"x +{unit}", "y", "z", "+Ixx kg m²", "+Iyy", "+Izz")
    rows = [heads, *(_row(each, metres) for each in comparison.changes)]
    widths = [max(len(each[k]) for each in rows) for k in range(len(heads))]
    for each in rows:
        yield "  ".join(f"{cell:{'>' if k > 1 else '<'}{widths[k]}}" for k, cell in enumerate(each)).rstrip()


def _row(change: Change, metres: float) -> tuple[str, ...]:
    shift, more = change.center_of_mass / metres, change.inertia.diagonal()
    return (
        change.name,
        change.kind,
        _arrow(*(str(own.quantity) if own else "" for own in (change.old, change.new))),
        _arrow(*(f"{own.mass:.5g}" if own else "" for own in (change.old, change.new))),
        f"{change.mass:+.4g}",
        *(f"{k:+.3g}" if abs(k) > 1e-9 else "0" for k in shift.tolist()),
        *(f"{k:+.3g}" if abs(k) > 1e-30 else "0" for k in more.tolist()),
    )


def _arrow(old: str, new: str) -> str:
    return old if old == new else f"{old} → {new}".strip()


def _pair(change: Change, field: str) -> list[Any]:
    def value(own: Own | None) -> Any:
        return None if own is None else getattr(own, field)

    return [value(change.old), value(change.new)]
