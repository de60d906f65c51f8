"""The public surface: one list, whose names are all there, described, and all that the pages show."""

import importlib.util
import inspect
import re
from pathlib import Path
from typing import Any

import pytest

import inertia

DOCS = Path(inertia.__file__).resolve().parents[2] / "docs"
PAGES = [DOCS.parent / "README.md", *sorted(DOCS.glob("*.md"))]


@pytest.mark.parametrize("name", inertia.__all__)
def test_every_name_is_there_and_described(name: str) -> None:
    assert inspect.getdoc(getattr(inertia, name))


def test_the_list_holds_what_the_contract_names() -> None:
    contract = "read mass_properties simulate Scene balance Rotor record"
    assert set(contract.split()) <= set(inertia.__all__)


@pytest.fixture(scope="module")
def lists() -> Any:
    spec = importlib.util.spec_from_file_location("list_names", DOCS / "list_names.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_of_names_is_that_of_the_list(lists: Any) -> None:
    assert (DOCS / "python.md").read_text(encoding="utf-8") == lists.page(), "run python docs/list_names.py"


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(AttributeError, match="module 'inertia' has no attribute 'anaylse'"):
        inertia.__getattr__("anaylse")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_import_public_names_only(page: Path) -> None:
    code = re.findall(r"^>>> (.*)|^\.\.\. (.*)|^(import .*|from .* import .*)$", page.read_text(encoding="utf-8"), re.M)
    lines = ["".join(parts) for parts in code]
    homes = {match[1] for line in lines if (match := re.match(r"\s*(?:from|import) (inertia[\w.]*)", line))}
    assert homes <= {"inertia", "inertia_meshes"}
    imported = [
        name
        for line in lines
        if (match := re.match(r"\s*from inertia import (.*)", line))
        for name in re.findall(r"\w+", match[1])
    ]
    used = [name for line in lines for name in re.findall(r"\binertia\.(\w+)", line)]
    assert set(imported + used) <= set(inertia.__all__)
