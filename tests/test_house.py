"""The house holds its own rules: no cycles, tests beside what they test, no private names from outside."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import grimp
import networkx
import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = {"inertia": ROOT / "toolkit/inertia", "inertia_cli": ROOT / "cli/inertia_cli"}
MODULES = sorted(path for folder in PACKAGES.values() for path in folder.rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))


def test_no_modules_import_each_other_in_a_circle() -> None:
    imports = grimp.build_graph(*PACKAGES, cache_dir=None)
    arrows = (
        (module, other) for module in imports.modules for other in imports.find_modules_directly_imported_by(module)
    )
    assert [ring for ring in networkx.strongly_connected_components(networkx.DiGraph(arrows)) if len(ring) > 1] == []


@pytest.mark.parametrize("folder", sorted({path.parent for path in MODULES}), ids=lambda path: path.name)
def test_a_folder_s_name_is_not_repeated_in_its_files(folder: Path) -> None:
    words = set(folder.name.split("_"))
    assert [path.name for path in folder.glob("*.py") if words <= set(path.stem.split("_"))] == []


def test_every_folder_of_tests_is_one_of_the_packages() -> None:
    folders = {path.parent.relative_to(ROOT / "tests") for path in TESTS if path.name.startswith("test_")}
    rooms = {
        path.parent.relative_to(PACKAGES["inertia"]) for path in MODULES if path.is_relative_to(PACKAGES["inertia"])
    }
    assert {str(each) for each in folders - rooms} <= {"cli", "meshes", "textbook"}


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.name)
def test_sentences_write_squares_and_cubes_of_units_as_such(path: Path) -> None:
    if path.parts[-2:] == ("batching", "columns.py"):  # units in the head of a table, for programs
        return
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    texts = (node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str))
    wrong = re.compile(r"(?<![\w.])(?:[cmk]?m|[\w.]*/[cmk]?m|k?g [cmk]?m)[23]\b(?!\s*[-+=(])|^[23] ")
    assert [text for text in texts if wrong.search(text)] == []


def _private_names(path: Path) -> Iterator[str]:
    """Yield the private names of the packages that a test imports or reaches for."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    aliases = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in PACKAGES:
            for name in node.names:
                aliases.add(name.asname or name.name)
                if name.name.startswith("_"):
                    yield name.name
        elif isinstance(node, ast.Import):
            aliases |= {name.asname or name.name for name in node.names if name.name.partition(".")[0] in PACKAGES}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.startswith("__"):
            base = node.value
            while isinstance(base, ast.Attribute):
                base = base.value
            if isinstance(base, ast.Name) and base.id in aliases:
                yield ast.unparse(node)
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") in {"setattr", "delattr"}:
            place = node.args[0] if node.args else None
            if isinstance(place, ast.Constant) and str(place.value).rpartition(".")[2].startswith("_"):
                yield str(place.value)
            elif isinstance(place, ast.Name) and place.id in aliases:
                name = node.args[1]
                if isinstance(name, ast.Constant) and str(name.value).startswith("_"):
                    yield f"{place.id}.{name.value}"


@pytest.mark.parametrize("path", TESTS, ids=lambda path: str(path.relative_to(ROOT / "tests")))
def test_tests_reach_public_names_only(path: Path) -> None:
    assert list(_private_names(path)) == []
