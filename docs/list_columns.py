"""Write the columns of batches into docs/json.md, from `inertia.batching.columns`."""

from pathlib import Path

from inertia.batching.columns import ANALYSE, AUDIT, BALANCE, CHECK, FILE, LAST

PAGE = Path(__file__).with_name("json.md")
START, END = "<!-- columns -->\n", "<!-- end -->\n"
GROUPS = {
    "of every verb, first": FILE,
    "of `analyse`": ANALYSE,
    "of `check`": CHECK,
    "of `balance`": BALANCE,
    "of `audit`": AUDIT,
    "of every verb, last": LAST,
}


def page() -> str:
    """Return the page with its tables as the columns are."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(START)
    _, _, after = rest.partition(END)
    lines = []
    for name, columns in GROUPS.items():
        lines += ["", f"| Column, {name} | Kind | Unit | Meaning |", "|---|---|---|---|"]
        lines += [f"| `{each.name}` | {each.kind} | {each.unit} | {each.meaning} |" for each in columns]
    return "".join([before, START, "\n".join([*lines, "", ""]), END, after])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
