"""Check a wheel and an sdist: what is in them, and what they say of themselves.

python -m build && python -m tests.packages dist
"""

import email
import re
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
SOURCES = {"toolkit/inertia", "cli/inertia_cli", "meshes/inertia_meshes"}
LEFT_OUT = re.compile(r"__pycache__|\.pyc$|^build/|^dist/|tests/benchmarks/data/")


def main(folder: Path) -> None:
    """Check the only wheel and the only sdist in a folder."""
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        (about,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        metadata = email.message_from_bytes(archive.read(about))
        scripts = archive.read(about.replace("METADATA", "entry_points.txt")).decode()
    packed = {name for name in names if ".dist-info/" not in name}
    wanted = {f"{Path(source).name}/{name}" for source in SOURCES for name in relative(source)}
    assert packed == wanted, sorted(packed ^ wanted)
    assert metadata["Name"] == PROJECT["name"]
    assert metadata["Version"] == version()
    assert metadata["Requires-Python"] == PROJECT["requires-python"]
    assert metadata["Description-Content-Type"] == "text/markdown"
    assert "inertia = inertia_cli.__main__:run" in scripts
    assert any(name.endswith("licenses/LICENSE") for name in names)
    with tarfile.open(sdist) as archive:
        stored = {name.partition("/")[2] for name in archive.getnames()}
    assert {"LICENSE", "README.md", "CITATION.cff", "constraints.txt", "conda/recipe.yaml", "docs/json.md"} <= stored
    assert not [name for name in stored if LEFT_OUT.search(name)]
    assert {f"{source}/{name}" for source in SOURCES for name in relative(source)} <= stored
    print(f"{wheel.name}: {len(packed)} files; {sdist.name}: {len(stored)} files")


def relative(source: str) -> list[str]:
    """Return the files of a package, as paths in it."""
    files = (file for file in (ROOT / source).rglob("*") if file.is_file() and not LEFT_OUT.search(file.as_posix()))
    return [file.relative_to(ROOT / source).as_posix() for file in files]


def version() -> str:
    """Return the version, from the one place where it stands."""
    text = (ROOT / "toolkit/inertia/__init__.py").read_text(encoding="utf-8")
    return re.search(r'^__version__ = "(.*)"$', text, re.MULTILINE)[1]


if __name__ == "__main__":
    main(Path(sys.argv[1]))
