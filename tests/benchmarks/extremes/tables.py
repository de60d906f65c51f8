"""Numbers and tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence


def as_number(value: float) -> str:
    """Return a number in two digits, with an exponent where it is small or large."""
    if value == 0 or 0.1 <= value < 1000:
        return f"{value:g}"
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def as_table(head: Sequence[str], rows: Sequence[Sequence[str]], *, words: bool = False) -> str:
    """Return a table, its first column aligned left, the others right unless they are `words`."""
    lines = [head, ["---", *["---" if words else "---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
