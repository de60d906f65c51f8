"""The console examples of the README and of docs/ print what the pages say (`...` stands for anything)."""

import contextlib
import doctest
import io
import math
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from inertia_cli.main import main
from inertia_meshes import path

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
TUTORIALS = [page for page in PAGES if page.stem.startswith("tutorial-")]
EXAMPLES = [
    pytest.param(command, expected, id=f"{page.stem}: {command}")
    for page in PAGES
    if page not in TUTORIALS
    for block in re.findall(r"^```console\n(.*?)^```$", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    for command, expected in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE)
]


@pytest.mark.parametrize(("command", "expected"), EXAMPLES)
def test_prints_what_the_page_says(command: str, expected: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path("cube.stl").parent)
    prints(command, expected, monkeypatch)


def prints(command: str, expected: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a command; what it prints must be what is expected."""
    program, *arguments = shlex.split(command)
    assert program == "inertia"
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr("inertia_cli.batch.EVERY", math.inf)  # s: no line of progress, however slow the machine is
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        main(arguments)
    checker, flags = doctest.OutputChecker(), doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    example = doctest.Example(command, expected)
    assert checker.check_output(expected, output.getvalue(), flags), checker.output_difference(
        example, output.getvalue(), flags
    )


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_tutorial_leads_from_its_first_step_to_its_last(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for sample in path("cube.stl").parent.iterdir():
        (tmp_path / sample.name).symlink_to(sample)
    monkeypatch.chdir(tmp_path)
    blocks = r"^(?:[^\n]*Save this as `([^`\n]*)`:\n\n)?```(\w+)\n(.*?)^```$"
    for name, language, block in re.findall(blocks, page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE):
        if name:
            Path(name).write_text(block, encoding="utf-8")
        elif language == "console":
            for command, expected in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE):
                prints(command, expected, monkeypatch)


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 8


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    targets = re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text(encoding="utf-8"))
    missing = [target for target in targets if not (page.parent / target).exists()]
    assert missing == []


def test_every_scene_and_rotor_is_in_the_gallery() -> None:
    folder = path("cube.stl").parent
    shipped = {f"{kind}/{file.name}" for kind in ("scenes", "rotors") for file in folder.glob(f"{kind}/*.toml")}
    page = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
    for file in shipped:
        assert f"](gallery/{Path(file).stem}.webp)" in page
        assert f"(`{file}`)" in page
        assert f'"{file}": ' in (ROOT / "docs/draw_gallery.py").read_text(encoding="utf-8")
    pictures = {picture.stem: picture.stat().st_size for picture in (ROOT / "docs/gallery").iterdir()}
    assert pictures.keys() == {Path(file).stem for file in shipped} | {"flip"}
    assert max(pictures.values()) < 300_000


def test_the_versions_of_the_site_are_listed_newest_first(tmp_path: Path) -> None:
    for name in ("0.9.0", "0.10.0", "1.0.0", "drafts"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "index.html").touch()
    (tmp_path / "1.1.0").mkdir()  # not built yet
    command = [sys.executable, ROOT / "docs/build_site.py", "--versions", tmp_path]
    assert subprocess.run(command, check=True, capture_output=True, text=True).stdout.split() == [
        "1.0.0",
        "0.10.0",
        "0.9.0",
    ]
    expected = 'const siteVersions = ["1.0.0", "0.10.0", "0.9.0"];\n'
    assert (tmp_path / "versions.js").read_text(encoding="utf-8") == expected
