"""What the packages promise about themselves: what importing them costs, what is shipped, what is pinned."""

import re
import subprocess
import sys
import tomllib
from importlib.resources import files
from itertools import chain
from pathlib import Path

import pytest

import inertia

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

SLOW = {
    "numpy",
    "scipy",
    "trimesh",
    "meshio",
    "numba",
    "llvmlite",
    "manifold3d",
    "lxml",
    "networkx",
    "h5py",
    "rerun",
    "pyarrow",
    "jinja2",
}


def imported_by(code: str) -> set[str]:
    """Return the top-level packages that a process has loaded after it ran `code`."""
    script = f"{code}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, check=True)
    return {name.partition(".")[0] for name in done.stdout.split()}


@pytest.mark.parametrize(
    "code",
    [
        "import inertia",
        "import inertia_meshes",
        "from inertia_cli.main import build_parser; build_parser().format_help()",
    ],
)
def test_imports_nothing_slow(code: str) -> None:
    assert imported_by(code) & SLOW == set()


def test_the_readers_import_no_library_before_they_read() -> None:
    assert imported_by("import inertia.mesh.read") & (SLOW - {"numpy"}) == set()


@pytest.mark.parametrize("package", ["inertia", "inertia_cli", "inertia_meshes"])
def test_ships_its_types(package: str) -> None:
    assert (files(package) / "py.typed").is_file()


def test_every_declared_dependency_is_pinned() -> None:
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pins = [re.fullmatch(r"([a-z0-9-]+)==\S+( ; .+)?", line) for line in lines if not line.startswith("#")]
    assert all(pins)
    declared = [PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()]
    names = {re.match(r"[\w-]+", requirement)[0].lower() for requirement in chain(*declared)}
    assert names - {pin[1] for pin in pins} == {"inertia"}


def test_the_citation_names_this_version() -> None:
    assert f"\nversion: {inertia.__version__}\n" in (ROOT / "CITATION.cff").read_text()


def test_the_conda_recipe_is_of_this_version_and_asks_for_the_same() -> None:
    recipe = (ROOT / "conda/recipe.yaml").read_text()
    assert f'  version: "{inertia.__version__}"\n' in recipe
    run = re.search(r"^  run:\n((?:    - .*\n)+)", recipe, re.MULTILINE)[1]
    asked = {line.removeprefix("    - ").replace(" ", "") for line in run.splitlines()}
    assert asked == {f"python{PROJECT['requires-python']}", *PROJECT["dependencies"]}


@pytest.mark.parametrize("verb", ["analyse", "balance", "check", "mass_properties", "simulate", "trade"])
def test_verbs_asked_about_a_path_say_how_to_read_it(verb: str) -> None:
    with pytest.raises(inertia.UsageError, match=r"is a str, not a (Part|Rotor|Scene): give what inertia\.\S+\(path\)"):
        getattr(inertia, verb)("bracket.stl")
