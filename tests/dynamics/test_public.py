"""The functions that docs/dynamics.md calls public are where it says, and say what they are."""

import re
from importlib import import_module
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "dynamics.md"
ROWS = re.findall(r"^\| (`[a-z_.`, ]+`) \| (`.*?`) \|", PAGE.read_text(encoding="utf-8").split("## Functions")[1], re.M)


@pytest.mark.parametrize(("modules", "names"), ROWS)
def test_every_name_of_the_page_is_there_and_described(modules: str, names: str) -> None:
    found = [import_module(f"inertia.dynamics.{module}") for module in re.findall(r"[\w.]+", modules)]
    for module in found:
        assert module.__doc__
    for name in re.findall(r"\w+", names):
        (home,) = [
            module for module in found if getattr(getattr(module, name, None), "__module__", "") == module.__name__
        ]
        assert getattr(home, name).__doc__


def test_the_page_has_rows() -> None:
    assert len(ROWS) > 15
