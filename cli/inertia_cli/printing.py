"""Print a JSON document, or text, in colours where it goes to a terminal."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable
from typing import Any

from inertia.errors import InertiaError, visible

_STYLES = {  # of text that stands in a report, by a pattern
    r"(?m)^\S.{0,15}?(?=  )": "bold",
    r"(?m)^error\b|\bFAIL(ED)?\b": "bold red",
    r"(?m)^warning\b|\bUNDECIDED\b|\bassumed\b": "yellow",
    r"\bPASS(ED)?\b": "bold green",
}


def show(as_json: bool, document: Callable[[], dict[str, Any]], text: Callable[[], str]) -> None:
    """Print a result as one JSON document, or as text."""
    if as_json:
        print_document(document())
    else:
        print_text(text())


def print_text(text: str) -> None:
    """Print lines of text, in which a name from outside steers no terminal."""
    lines = "\n".join(map(visible, text.split("\n")))
    if sys.stdout.isatty() and not os.environ.get("NO_COLOR"):
        _print_coloured(lines)
    else:
        print(lines)


def write_and_show(
    write: Callable[[], None], as_json: bool, document: Callable[[], dict[str, Any]], text: Callable[[], str]
) -> None:
    """Write files and print the result; it is told even where they cannot be written."""
    try:
        write()
    except InertiaError:
        try:
            show(as_json, document, text)
            sys.stdout.flush()
        except OSError:  # what could not be written first is what is reported
            abandon_output()
        raise
    show(as_json, document, text)


def abandon_output() -> None:
    """Let standard output lead nowhere, where nobody reads it any more: closing it at exit would fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def print_document(document: dict[str, Any]) -> None:
    """Print one JSON document, a line for each of its fields; what a terminal obeys or cannot show is escaped."""
    import json

    def line(key: str, value: Any) -> str:
        text = json.dumps(value, ensure_ascii=False, allow_nan=False)
        return f" {json.dumps(key)}: {re.sub('[^ -~]', escaped, text)}"

    def escaped(one: re.Match[str]) -> str:
        return one[0] if one[0].isprintable() and _can_be_written(one[0]) else json.dumps(one[0])[1:-1]

    print("{\n" + ",\n".join(line(key, value) for key, value in document.items()) + "\n}")


def _can_be_written(text: str) -> bool:
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _print_coloured(text: str) -> None:
    from rich.console import Console
    from rich.text import Text

    coloured = Text(text)
    for pattern, style in _STYLES.items():
        coloured.highlight_regex(pattern, style)
    Console().print(coloured, soft_wrap=True)
