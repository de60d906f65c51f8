"""Write the table of conventions into docs/exchange.md, from `inertia.exchange.conventions`."""

from pathlib import Path

from inertia.exchange.conventions import CONVENTIONS, Convention
from inertia.exchange.export import WRITERS

PAGE = Path(__file__).with_name("exchange.md")
START, END = "<!-- conventions -->\n", "<!-- end -->\n"


def page() -> str:
    """Return the page with its table as the rows have it."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(START)
    _, _, after = rest.partition(END)
    table = ["| Target | Program | Off the diagonal | About | Read back with |", "|---|---|---|---|---|"]
    for name, row in CONVENTIONS.items():
        back = row.read_back or ("by the manual, not read back" if name in WRITERS else "not written; by the manual")
        signs = row.off_diagonal if row.products == "none" else f"{row.off_diagonal} ({_KINDS[row.products]})"
        table.append(f"| `{name}` | {row.program} | {signs} | {row.about} | {back} |")
    details = [block for name, row in CONVENTIONS.items() for block in _details(name, row)]
    return "".join([before, START, "\n", "\n".join([*table, "", *details]), END, after])


_KINDS = {"elements": "elements of the tensor", "integrals": "positive integrals"}


def _details(name: str, row: Convention) -> list[str]:
    order = f"; order {' '.join(row.order)}" if row.order else ""
    return [
        f"**`{name}`**",
        "",
        f"- Fields: {row.fields}{order}.",
        f"- Units: {row.units}. Axes: {row.handedness}-handed. Rotation: {row.rotation}.",
        f"- Digits: {row.digits}.",
        *([f"- Cannot express: {row.cannot}."] if row.cannot else []),
        f"- Source: {row.source}.",
        "",
    ]


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
