"""Mesh in, exact inertia out.

The public names stand in `__init__.pyi`, the only list of them. Each is imported when it is first used, so that
``import inertia`` costs nothing.
"""

from functools import cache
from importlib import import_module
from typing import Any

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    homes = _homes()
    if name == "__all__":
        return sorted(homes)
    if name not in homes:
        raise AttributeError(f"module 'inertia' has no attribute {name!r}")
    home, there = homes[name]
    module = import_module(home)
    value = getattr(module, there) if hasattr(module, there) else import_module(f"{home}.{there}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_homes()})


@cache
def _homes() -> dict[str, tuple[str, str]]:
    """Return the module of each public name, and what it is called there, as `__init__.pyi` says."""
    import re
    from pathlib import Path

    text = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    return {name: (home, there) for home, there, name in re.findall(r"^from (\S+) import (\w+) as (\w+)$", text, re.M)}
