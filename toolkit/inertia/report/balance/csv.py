"""`Balance` → CSV: the planes before and after, and the operations, one row each, for a spreadsheet."""

from __future__ import annotations

import csv
import io

from inertia.balancing.balance import Balance
from inertia.report.balance.document import Document, balance_document

_PLANES = ("state", "plane", "z_mm", "unbalance_gmm", "unbalance_deg", "permissible_gmm", "bearing_force_N")
_WORK = (
    "id", "plane", "method", "kind", "z_mm", "angle_deg", "radius_mm", "tool_diameter_mm", "point_angle_deg",
    "depth_mm", "width_mm", "mass_g", "unbalance_gmm", "unbalance_deg", "remaining_wall_mm", "pieces", "item",
)  # fmt: skip


def balance_csv(balance: Balance) -> str:
    """Return two tables with a line of names each, an empty line between them."""
    document = balance_document(balance)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(_PLANES)
    for state, planes in (("initial", document), ("residual", document["residual"])):
        for plane in (*planes["tolerance_planes"], *planes["correction_planes"]):
            rows.writerow(_row(_PLANES, {"state": state, "plane": plane["id"]} | plane))
    rows.writerow([])
    rows.writerow(_WORK)
    for work in document["corrections"]:
        rows.writerow(_row(_WORK, work))
    return text.getvalue()


def _row(names: tuple[str, ...], entry: Document) -> list[object]:
    flat = entry | {f"unbalance_{key}": value for key, value in entry["unbalance"].items()}
    return [flat[name] for name in names]
