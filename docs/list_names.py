"""Write docs/python.md, every public name of `inertia` with the first sentence of its docstring, and docs/public.txt.

The latter has what `docs/stability.md` promises: the names with their parameters, the members of classes, the commands
with their options.
"""

import argparse
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import inertia
from inertia_cli.main import build_parser

PAGE = Path(__file__).with_name("python.md")
SURFACE = Path(__file__).with_name("public.txt")
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


def surface() -> str:
    """Return all that is public, a line each: names with their parameters (= of those with a default), and options."""
    names = (line for name in inertia.__all__ for line in _lines(f"inertia.{name}", getattr(inertia, name)))
    return "".join(f"{line}\n" for line in (*names, *_options()))


def _lines(name: str, thing: object) -> Iterator[str]:
    yield f"{name}{_parameters(thing)}"
    if isinstance(thing, type):
        home = [each for each in thing.__mro__ if each.__module__.startswith("inertia.")]
        members = {key: each for cls in reversed(home) for key, each in vars(cls).items()}
        members |= dict.fromkeys(key for cls in home for key in inspect.get_annotations(cls))
    elif inspect.ismodule(thing):
        members = {key: each for key, each in vars(thing).items() if getattr(each, "__module__", "") == thing.__name__}
    else:
        return
    for key in sorted(members):
        if not key.startswith("_"):
            each = inspect.getattr_static(thing, key, None)
            yield f"{name}.{key}{_parameters(getattr(each, '__func__', each))}"


def _parameters(thing: object) -> str:
    """Return the names of the parameters, with = where there is a default; nothing of what is not called."""
    if not callable(thing):
        return ""
    try:
        parameters = inspect.signature(thing).parameters.values()
    except ValueError:
        return "(…)"
    plain = [
        each.replace(
            annotation=inspect.Parameter.empty, default=each.default if each.default is each.empty else _Default()
        )
        for each in parameters
    ]
    return str(inspect.Signature(plain))


class _Default:
    def __repr__(self) -> str:
        return ""


def _options() -> Iterator[str]:
    commands = next(each for each in build_parser()._actions if isinstance(each, argparse._SubParsersAction))
    for name, parser in commands.choices.items():
        for action in parser._actions[1:]:  # without --help
            yield f"inertia {name} {', '.join(action.option_strings) or action.metavar or action.dest}"


if __name__ == "__main__":
    SURFACE.write_text(surface(), encoding="utf-8")
    PAGE.write_text(page(), encoding="utf-8")
