"""`Budget` → CSV, a row a line of the budget."""

from __future__ import annotations

from collections.abc import Iterator

from inertia.assembly.budget import Budget
from inertia.assembly.lines import Line
from inertia.tables import csv_text

_ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_HEAD = (
    *("part", "level", "quantity", "category", "maturity", "basic_mass", "allowance", "predicted_mass"),
    *("com_x", "com_y", "com_z", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
    *("u_mass", "u_predicted_mass", "u_com_x", "u_com_y", "u_com_z"),
    *("u_ixx", "u_iyy", "u_izz", "u_ixy", "u_ixz", "u_iyz"),
)


def budget_csv(whole: Budget) -> str:
    """Return the budget as CSV: SI, in the axes of the whole; a part's name has those above it before it."""
    return csv_text([_HEAD, *_rows(whole.total, "")])


def _rows(line: Line, above: str) -> Iterator[tuple[object, ...]]:
    name = f"{above}{line.name}"
    yield (
        *(name, line.level, line.quantity, line.category or "", line.maturity or ""),
        *(line.basic_mass, line.allowance, line.predicted_mass, *line.center_of_mass.tolist()),
        *(float(line.inertia[k]) for k in _ELEMENTS),
        *(line.sigma.mass, line.sigma.predicted_mass, *line.sigma.center_of_mass.tolist()),
        *(float(line.sigma.inertia[k]) for k in _ELEMENTS),
    )
    for child in line.children:
        yield from _rows(child, f"{name}/" if line.level else "")
