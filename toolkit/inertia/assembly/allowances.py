"""Mass growth allowances by category and maturity, after the scheme of ANSI/AIAA S-120A.

The standard's own table is not reproduced. This one is an example of the same layout; an assembly file replaces its
rows, or adds others, in ``[allowances.CATEGORY]``.
"""

from __future__ import annotations

from collections.abc import Mapping

from inertia.documents import FieldError, nearest

MATURITIES = ("estimated", "layout", "preliminary", "released", "existing", "actual", "specified")
"""From a guess by what was built before, over layouts, drawings before and after their release, hardware of another
project, hardware that was weighed, to a mass that a contract fixes."""

_ROWS: dict[str, tuple[float, ...]] = {
    "structure": (0.20, 0.15, 0.10, 0.05, 0.03, 0.0, 0.0),
    "mechanism": (0.25, 0.18, 0.12, 0.06, 0.04, 0.0, 0.0),
    "electronics": (0.30, 0.20, 0.15, 0.08, 0.04, 0.0, 0.0),
    "harness": (0.50, 0.35, 0.25, 0.12, 0.06, 0.0, 0.0),
    "battery": (0.20, 0.15, 0.10, 0.05, 0.03, 0.0, 0.0),
    "solar array": (0.25, 0.20, 0.12, 0.06, 0.04, 0.0, 0.0),
    "thermal": (0.30, 0.22, 0.15, 0.08, 0.05, 0.0, 0.0),
    "propulsion": (0.20, 0.15, 0.10, 0.06, 0.04, 0.0, 0.0),
    "payload": (0.35, 0.25, 0.15, 0.08, 0.05, 0.0, 0.0),
    "fasteners": (0.30, 0.20, 0.12, 0.06, 0.03, 0.0, 0.0),
    "other": (0.30, 0.20, 0.15, 0.08, 0.05, 0.0, 0.0),
}

EXAMPLE: Mapping[str, Mapping[str, float]] = {
    category: dict(zip(MATURITIES, row, strict=True)) for category, row in _ROWS.items()
}
"""The built-in table, as parts of the basic mass."""


def allowance_of(
    table: Mapping[str, Mapping[str, float]], category: str | None, maturity: str | None, path: str
) -> float | None:
    """Return the allowance as a part of the basic mass; None where nothing says how mature the part is.

    Raises `FieldError` for a category or maturity that the table has not.
    """
    if category is not None and category not in table:
        raise FieldError(f"{path}.category", f"is {category!r}: {_choices(category, table)}")
    if maturity is None:
        return None
    row = table[category or "other"]
    if maturity not in row:
        raise FieldError(f"{path}.maturity", f"is {maturity!r}: {_choices(maturity, row)}")
    return row[maturity]


def _choices(word: str, known: Mapping[str, object]) -> str:
    meant = nearest(word, known)
    if meant is not None:
        return f"did you mean {meant!r}?"
    return f"use one of {', '.join(map(repr, known)) or 'none, as that row is empty'}"
