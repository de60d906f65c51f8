"""Write docs/python.md: every public name of `inertia` with the first sentence of its docstring."""

import inspect
import re
from pathlib import Path

import inertia

PAGE = Path(__file__).with_name("python.md")
HEAD = """# The names in Python

`import inertia` gives what is listed here, and nothing else is public: another module's names may change from one
version to the next. Signatures, shapes and units are in the docstrings (`help(inertia.analyse)`).
"""


def page() -> str:
    """Return the page, a table for each group of `__init__.pyi`."""
    listing = Path(inertia.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    groups = re.findall(r"^# (.+)\n((?:from .+\n)+)", listing, re.MULTILINE)
    return "\n".join([HEAD, *("\n".join(_table(title, imports)) for title, imports in groups)])


def _table(title: str, imports: str) -> list[str]:
    rows = [f"| `{name}` | {_sentence(getattr(inertia, name))} |" for name in re.findall(r" as (\w+)$", imports, re.M)]
    return [f"## {title.removesuffix('.')}", "", "| Name | |", "|---|---|", *rows, ""]


def _sentence(thing: object) -> str:
    """Return the first sentence of a docstring, on one line."""
    paragraph = " ".join((inspect.getdoc(thing) or "").partition("\n\n")[0].split())
    return re.split(r"(?<=[.!?]) (?=[A-Z`])", paragraph)[0].replace("|", "\\|")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
