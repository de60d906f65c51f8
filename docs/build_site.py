"""Build the site: the pages of docs/, with a reference made from the docstrings, the command's parser and the schemas.

    python docs/build_site.py [FOLDER]     into FOLDER, build/site without one: open FOLDER/index.html
    python docs/build_site.py --versions FOLDER     list the sites FOLDER/1.2.3, so that each leads to the others

Whatever is amiss is an error: a page in none of the parts, a link that leads nowhere, a public name without an entry,
an example that fails or warns. The pages stay as they are: what is written here stands in none of them, and what stands
in them is not written again.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from types import ModuleType
from typing import Any

import matplotlib as mpl
from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx

import inertia
from inertia.palette import COLORS
from inertia_cli.main import build_parser

ROOT = Path(__file__).resolve().parent.parent
PARTS = {
    "Tutorials": "tutorial-part tutorial-robot tutorial-rotor tutorial-top",
    "Examples": "examples/index gallery",
    "Textbook": "textbook/index",
    "How to": "analysing reading checking exchange assembly batch algebra uncertainty audit balancing measuring "
    "simulating spread playback trade notebooks outputs",
    "Reference": "python command json errors stability",
    "Explanation": "accuracy shapes dynamics security extremes honesty reliability robots benchmarks motion-benchmarks "
    "balancing-benchmarks recording",
    "Project": "CONTRIBUTING CHANGELOG SECURITY CODE_OF_CONDUCT",
}
"""Every page, in the part where one looks for it."""
GALLERIES = ("examples", "textbook")
"""The folders of scripts, each of which becomes a page with what it prints and draws."""
PICTURES = {
    "figure.dpi": 144,
    "savefig.bbox": "tight",
    "axes.prop_cycle": mpl.cycler(color=COLORS),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.alpha": 0.3,
    "legend.frameon": False,
}
"""How matplotlib draws on the site."""
ALIASES = ("ArrayLike", "Float", "Int", "Bool", "Progress", "Orientation", "Parts")
SETTINGS = {
    "project": "inertia",
    "author": "the inertia authors",
    "copyright": "the inertia authors, MIT licence",
    "release": inertia.__version__,
    "extensions": ["myst_parser", "sphinx.ext.autodoc", "sphinx_gallery.gen_gallery", __name__],
    "sphinx_gallery_conf": {
        "examples_dirs": [str(ROOT / "docs" / name) for name in GALLERIES],
        "gallery_dirs": list(GALLERIES),
        "filename_pattern": r"\.py$",
        "within_subsection_order": f"{__name__}.in_order",
        "capture_repr": ("_repr_html_",),
        "reset_modules": ("matplotlib", f"{__name__}.prepare"),
        "reset_modules_order": "both",
        "download_all_examples": False,
        "show_signature": False,
        "write_computation_times": False,
        "min_reported_time": 1e9,  # s: the pages are the same, however fast the machine is
    },
    "html_math_renderer": "mathml",
    "myst_heading_anchors": 4,
    "smartquotes": False,
    "default_role": "code",
    "autodoc_member_order": "bysource",
    "autodoc_preserve_defaults": True,
    "autodoc_type_aliases": {
        name: name for name in ("ArrayLike", "Float", "Int", "Bool", "Progress", "Orientation", "Parts")
    },
    "add_module_names": False,
    "python_maximum_signature_line_length": 100,
    "html_theme": "furo",
    "html_static_path": ["_static"],
    "html_css_files": ["inertia.css"],
    "html_js_files": ["switch.js"],
    "html_title": f"inertia {inertia.__version__}",
    "html_copy_source": False,
    "html_show_sphinx": False,
    "html_last_updated_fmt": "",
    "show_warning_types": True,
}
STYLE = """
.content { width: min(52em, 100%); }
td code { white-space: normal; overflow-wrap: break-word; }
.whole .pre { white-space: nowrap; }
dl.py dt.sig { overflow-wrap: anywhere; }
.boldsymbol { font-weight: bold; }
.formula { margin: 0.5em 0; padding: 0.3em 0; overflow-x: auto; }
.versions { display: block; margin: 0 var(--sidebar-item-spacing-horizontal) 0.5em; padding: 0.2em; font: inherit; }
.versions { color: inherit; background: transparent; border: 1px solid var(--color-sidebar-search-border); }
.versions option { color: black; }
.sphx-glr-script-out .highlight pre { white-space: pre-wrap; }
div.sphx-glr-footer div.sphx-glr-download a { color: var(--color-link); background: none; }
div.sphx-glr-footer div.sphx-glr-download a { border: 1px solid var(--color-background-border); }
@media (max-width: 46em) {
  table.docutils { font-size: 0.8em; }
  td code, th code, td a { overflow-wrap: anywhere; }
  table.docutils td, table.docutils th { min-width: 5.5em; padding: 0.25em 0.4em; }
  .sphx-glr-script-out { margin-left: 0; }
  .sphx-glr-script-out::before { display: none; }
}
mtable.ams-align > mtr > mtd { padding-left: 0; padding-right: 0; }
mtable.ams-align > mtr > mtd:nth-child(odd) { text-align: right; padding-right: 0.25em; }
mtable.ams-align > mtr > mtd:nth-child(even) { text-align: left; }
"""


SWITCH = """
addEventListener("DOMContentLoaded", () => {
  const above = document.documentElement.dataset.content_root + "../", list = document.createElement("script");
  list.src = above + "versions.js";  // not JSON: that cannot be read where the site is opened from the disk
  list.onload = () => {
    const here = new URL(above + ".", location).pathname, name = location.pathname.slice(here.length).split("/")[0];
    if (siteVersions.length < 2 || !siteVersions.includes(name)) return;
    const choice = document.createElement("select");
    choice.className = "versions";
    choice.ariaLabel = "Version";
    for (const each of siteVersions) choice.add(new Option(each, each, false, each === name));
    choice.onchange = () => { location.href = above + choice.value + "/index.html"; };
    document.querySelector(".sidebar-brand").after(choice);
  };
  document.head.append(list);
});
"""


def build(out: Path) -> None:
    """Write the site into a folder; raise `SystemExit` with what is amiss."""
    with tempfile.TemporaryDirectory() as folder:
        source, trees = Path(folder) / "docs", Path(folder) / "trees"
        shutil.copytree(ROOT / "docs", source, ignore=shutil.ignore_patterns("*.py", "__pycache__", *GALLERIES))
        (Path(folder) / "toolkit").symlink_to(ROOT / "toolkit")  # pages may link to a module
        _write_pages(source)
        app = Sphinx(
            source, None, out, trees, "html", SETTINGS, warningiserror=True, status=None, exception_on_warning=False
        )
        app.build()
        missing = set(inertia.__all__) - {
            name.removeprefix("inertia.") for name in app.env.domains.python_domain.objects
        }
        if missing:
            sys.exit(f"no entry in the reference: {', '.join(sorted(missing))}")
        if app.statuscode:
            sys.exit("the site has faults: see above")


def setup(app: Sphinx) -> None:
    """Let Sphinx read docstrings as they are written here, and write formulas that need no script and no network."""
    app.connect("autodoc-process-docstring", _as_lists)
    app.connect("autodoc-process-signature", _as_python)
    app.connect("source-read", _without_bundles)
    app.connect("doctree-read", _keep_options_whole)
    app.add_html_math_renderer("mathml", (_write_formula, None), (_write_formula, None))


def _keep_options_whole(_: Sphinx, tree: nodes.document) -> None:
    """Mark code that begins with an option, which browsers would break behind its hyphens."""
    for code in tree.findall(nodes.literal):
        if code.astext().startswith("-"):
            code["classes"].append("whole")


_TEX = (
    (r"(\\[td]?frac)\s*(\d)\s*(\d)", r"\1{\2}{\3}"),
    (r"\\boldsymbol\s*(\\[a-z]+|{[^{}]*})", r"{\\boldsymbol\1}"),  # or all that follows is bold
    (r"(\\d?dot\s*(?:\\[a-z]+|{(?:[^{}]|{[^{}]*})*}))([_^])", r"\1{}\2"),  # or the index is below
    (r"(?<=[\w})])\s*(?=\\(?:sin|cos|tan)\b)", r"\\,"),
    ("°", r"^{\\circ}"),
)
"""What docutils reads otherwise than TeX does, and how it reads it rightly."""


def _write_formula(writer: Any, node: nodes.Element) -> None:
    """Write a formula as MathML; one that stands by itself can be scrolled on a narrow screen."""
    text, block = node.astext(), isinstance(node, nodes.math_block)
    for written, readable in _TEX:
        text = re.sub(written, readable, text)
    # Over an accent browsers set so little room that a dot drowns in its letter.
    formula = tex2mathml(text, as_block=block).replace('<mover accent="true">', "<mover>")
    writer.body.append(f'<div class="formula">{formula}</div>' if block else formula)
    raise nodes.SkipNode


def in_order(file: str) -> tuple[bool, str]:
    """Sort the sections of the textbook before its exercises, and all else by its name."""
    return file.startswith("e"), file


def prepare(_settings: object, _file: str, when: str) -> None:
    """Draw an example in the colours of this project, and let what it warns of be an error while it runs."""
    if when == "before":
        mpl.rcParams.update(PICTURES)
        _STRICT.enter_context(warnings.catch_warnings(action="error"))
    else:
        _STRICT.close()


_STRICT = ExitStack()


def _without_bundles(_app: Sphinx, page: str, text: list[str]) -> None:
    """Take from the page of an example the offer of an archive, and the note that it can be loaded at its end."""
    if page.partition("/")[0] in GALLERIES:
        for what in (r"\.\. only:: html\n\n    \.\. note::", r"    \.\. container:: [\w -]*download-zip"):
            text[0] = re.sub(rf"^{what}\n(?:.*\S.*\n|\n(?=\s))*", "", text[0], flags=re.MULTILINE)


def _write_pages(source: Path) -> None:
    """Write what is not a page of docs/: the home page, the reference and the pages of the project."""
    (source / "_static").mkdir()
    (source / "_static/inertia.css").write_text(STYLE, encoding="utf-8")
    (source / "_static/switch.js").write_text(SWITCH, encoding="utf-8")
    for name in (*PARTS["Project"].split(), "README"):
        text = (ROOT / f"{name}.md").read_text(encoding="utf-8").replace("](docs/", "](")
        (source / f"{name}.md").write_text(text, encoding="utf-8")
    for page in source.glob("*.md"):
        text = page.read_text(encoding="utf-8")
        page.write_text(text.replace("/GALLERY_HEADER.rst)", "/index.rst)"), encoding="utf-8")
    home = (source / "README.md").rename(source / "index.md")
    trees = (
        f"```{{toctree}}\n:hidden:\n:caption: {part}\n\n" + "\n".join(pages.split()) + "\n```\n"
        for part, pages in PARTS.items()
    )
    home.write_text(home.read_text(encoding="utf-8") + "\n" + "\n".join(trees), encoding="utf-8")
    _write_names(source)
    _write_commands(source)


def _write_names(source: Path) -> None:
    """Write a page for each group of public names, and let the list of names lead to them."""
    listing = source / "python.md"
    head, *groups = listing.read_text(encoding="utf-8").split("\n## ")
    (source / "names").mkdir()
    pages = []
    for group in groups:
        title, _, table = group.partition("\n")
        names = re.findall(r"^\| `(\w+)`", table, re.MULTILINE)
        page = f"names/{names[0].lower()}"
        pages.append(page)
        entries = map(_entry, names)
        text = "\n".join([_heading(title), *entries])
        (source / f"{page}.rst").write_text(text, encoding="utf-8")
    text = re.sub(r"^\| `(\w+)`", r"| {py:obj}`\1 <inertia.\1>`", "\n## ".join([head, *groups]), flags=re.MULTILINE)
    text += "\n```{toctree}\n:hidden:\n\n" + "\n".join(pages) + "\n```\n"
    listing.write_text(text, encoding="utf-8")


def _entry(name: str) -> str:
    """Return the directive that documents a public name, with what is public of it."""
    thing = getattr(inertia, name)
    if isinstance(thing, ModuleType):
        sys.modules[f"inertia.{name}"] = thing
        here = (k for k, each in vars(thing).items() if getattr(each, "__module__", "") == thing.__name__)
        members = [k for k in here if not k.startswith("_")]
        return f".. automodule:: inertia.{name}\n   :members: {', '.join(members)}\n"
    if not isinstance(thing, type):
        return f".. autofunction:: inertia.{name}\n"
    return f".. auto{'exception' if issubclass(thing, BaseException) else 'class'}:: inertia.{name}\n   :members:\n"


def _as_lists(_app: Sphinx, _what: str, _name: str, _thing: object, _options: object, lines: list[str]) -> None:
    """Turn the sections of a docstring, `name : text` below an underlined title, into lists of definitions."""
    written, within = [], False
    for line in lines:
        if set(line) == {"-"}:
            written[-1:] = [f".. rubric:: {written[-1]}", ""]
            within = True
        elif within and line and not line.startswith(" "):
            names, colon, text = line.partition(" : ")
            written += [f"``{names}``", f"    {_linked(text)}"] if colon else [_linked(line)]
        else:
            within = within and bool(line)
            written.append(line if line.lstrip()[:3] in (">>>", "...") else _linked(line))
    lines[:] = written


def _as_python(*about: Any) -> tuple[str | None, ...]:
    """Return signature and result as they are written: a default that is made, and an alias, are shown otherwise."""
    readable = (text and re.sub("<[^>]*>", "...", text) for text in about[-2:])
    return tuple(text and re.sub(r"TypeAliasForwardRef\('(\w+)'\)", r"\1", text) for text in readable)


def _linked(text: str) -> str:
    """Return text with a link wherever code names what is public; what would be a mark of the notation is none."""
    parts = re.split("(``?[^`]+``?)", text)
    parts[::2] = [part.replace("|", "\\|").replace("**", "\\*\\*") for part in parts[::2]]
    return "".join(_CODE.sub(_link, part) for part in parts)


_CODE = re.compile(r"^`((\w+)[^`]*)`$")


def _link(code: re.Match[str]) -> str:
    return f":py:obj:`~inertia.{code[1]}`" if code[2] in inertia.__all__ else code[0]


def _write_commands(source: Path) -> None:
    """Write a page for each command from its parser."""
    (source / "commands").mkdir()
    parser = build_parser()
    commands = next(each for each in parser._actions if isinstance(each, argparse._SubParsersAction))
    pages, table = [], ""
    for each in commands._choices_actions:  # the parsers without their aliases
        name, command = each.dest, commands.choices[each.dest]
        pages.append(f"commands/{name.replace(' ', '-')}")
        (source / f"{pages[-1]}.rst").write_text("\n".join(_command(command)), encoding="utf-8")
        table += f"| [`{command.prog}`]({pages[-1]}.rst) | {each.help} |\n"
    codes = f"```text\n{parser.epilog}```\n"
    toctree = "```{toctree}\n:hidden:\n\n" + "\n".join(pages) + "\n```\n"
    text = f"# The command\n\n| | |\n|---|---|\n{table}\n{codes}\n{toctree}"
    (source / "command.md").write_text(text, encoding="utf-8")


def _command(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Yield the lines of the page of a command."""
    yield _heading(parser.prog)
    yield f".. program:: {parser.prog}\n\n{_escaped(parser.description or '')}\n\n::\n"
    yield from (f"   {line}" for line in parser.format_usage().splitlines())
    for group in parser._action_groups:
        if group._group_actions:
            yield f"\n.. rubric:: {(group.title or '').capitalize()}\n"
        for action in group._group_actions:
            if action.help == argparse.SUPPRESS:
                continue
            formatter = parser._get_formatter()
            formatter.add_argument(action)
            invocation = formatter._format_action_invocation(action)
            text = formatter._expand_help(action) if action.help else ""
            yield f".. option:: {invocation}\n\n   {_escaped(text)}\n"
    if parser.epilog:
        yield "\n::\n\n" + "\n".join(f"   {line}" for line in parser.epilog.splitlines())


def _heading(title: str) -> str:
    return f"{title}\n{'=' * len(title)}\n"


def _escaped(text: str) -> str:
    """Return plain text with code in single marks as reStructuredText."""
    parts = " ".join(text.split()).split("`")
    return "".join(f"``{each}``" if k % 2 else re.sub(r"([*|\\_])", r"\\\1", each) for k, each in enumerate(parts))


def list_versions(folder: Path) -> list[str]:
    """Write which versions' sites are in a folder, the newest first, and return them."""
    sites = (page.parent.name for page in folder.glob("*/index.html"))
    versions = [name for name in sites if re.fullmatch(r"\d+(\.\d+)+", name)]
    versions.sort(key=lambda name: [int(number) for number in name.split(".")], reverse=True)
    (folder / "versions.js").write_text(f"const siteVersions = {json.dumps(versions)};\n", encoding="utf-8")
    return versions


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python docs/build_site.py", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "build/site", metavar="FOLDER", help="the site")
    parser.add_argument("--versions", action="store_true", help="list the sites FOLDER/1.2.3, and build none")
    asked = parser.parse_args()
    if asked.versions:
        print(*list_versions(asked.folder))
    else:
        build(asked.folder)


if __name__ == "__main__":
    main()
