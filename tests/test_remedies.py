"""What errors advise: data below the command line, and nothing that nobody takes."""

import argparse
import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import inertia
from inertia.balancing.rotor import json_schema
from inertia.documents import schema_of
from inertia.dynamics.scene.sections import Settings, Start
from inertia.errors import Remedy
from inertia_cli import balance, simulate
from inertia_cli.main import build_parser, main
from inertia_cli.wording import as_option
from inertia_meshes import path

ROOT = Path(inertia.__file__).parent
BROKEN = sorted(path("cube.stl").parent.glob("broken/*.stl"))
PARSERS: dict[str, argparse.ArgumentParser] = next(
    action.choices for action in build_parser()._actions if isinstance(action, argparse._SubParsersAction)
)


def actions(command: str) -> dict[str, argparse.Action]:
    """Return the options of a command."""
    return {option: action for action in PARSERS[command]._actions for option in action.option_strings}


def syntax_trees() -> Iterator[tuple[Path, ast.AST]]:
    for file in ROOT.rglob("*.py"):
        yield file, ast.parse(file.read_text())


def remedies() -> set[Remedy]:
    """Return every remedy that is written down in the library."""
    calls = [
        node
        for _, tree in syntax_trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Remedy"
    ]
    return {Remedy(*map(ast.literal_eval, call.args)) for call in calls}


COMMANDS = {parser.prog.partition(" ")[2] for parser in PARSERS.values()}
OPTIONS = {option for command in COMMANDS for option in actions(command) if option.startswith("--")}
NAMED = re.compile(rf"(?<![\w-])({'|'.join(sorted(OPTIONS, key=len, reverse=True))})(?![\w-])")


def test_the_library_names_no_option_of_the_command_line() -> None:
    named = [
        f"{file.relative_to(ROOT)}:{node.lineno}: {match[0]}"
        for file, tree in syntax_trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        for match in NAMED.finditer(node.value)
    ]
    named += [f"{file.name}: {match[0]}" for file in ROOT.rglob("*.j2") for match in NAMED.finditer(file.read_text())]
    assert named == []


@pytest.mark.parametrize("remedy", sorted(remedies(), key=str), ids=str)
def test_a_remedy_is_there_to_be_followed(remedy: Remedy) -> None:
    if remedy.verb:
        verb = getattr(inertia, remedy.verb)
        assert not remedy.argument or remedy.argument in inspect.signature(verb).parameters
    else:
        assert remedy.argument in inspect.signature(inertia.record).parameters
    option, _, value = as_option(remedy).partition(" ")
    if option.startswith("`"):
        assert remedy.verb in COMMANDS
        return
    takes = [remedy.verb] if remedy.verb in COMMANDS else COMMANDS
    found = [actions(command)[option] for command in takes if option in actions(command)]
    assert found
    for action in found:
        assert (action.nargs == 0) == (remedy.value is True or not remedy.argument)
        assert not value or value in (action.choices or [action.metavar])


@pytest.mark.parametrize("file", BROKEN, ids=lambda file: file.stem)
@pytest.mark.parametrize(
    "command",
    [
        ("analyse",),
        ("analyse", "--repair"),
        ("analyse", "--shell", "1"),
        ("analyse", "--orientation", "absolute"),
        ("check",),
        ("check", "--json"),
        ("tumble", "--spin", "0,0,1", "--for", "1"),
        ("balance", "--grade", "6.3", "--rpm", "3000", "--axis", "z", "--bearings=-1,1"),
        ("assembly",),
        ("budget",),
    ],
    ids=" ".join,
)
def test_what_is_advised_can_be_done_and_was_not_done(
    capsys: pytest.CaptureFixture[str], file: Path, command: tuple[str, ...]
) -> None:
    main([command[0], str(file), *command[1:]])
    text = "".join(capsys.readouterr())
    text = text.replace(str(file), "")
    assert "inertia.repair" not in text
    assert "shell=" not in text
    assert "orientation=" not in text
    advised = {match[0] for match in NAMED.finditer(text)}
    assert advised.isdisjoint(command[1:])
    takes = "analyse" if "with `inertia analyse`" in text or command[0] == "check" else command[0]
    assert advised <= actions(takes).keys()


@pytest.mark.parametrize("file", BROKEN, ids=lambda file: file.stem)
@pytest.mark.parametrize(
    ("head", "more", "table"),
    [
        ("[body]", "", "[body]"),
        (
            '[[part]]\nname = "r"',
            '[[part]]\nname = "c"\nparent = "r"\nmass = 1\nprincipal_moments = [1, 1, 1]\n',
            "[[part]]",
        ),
    ],
)
def test_what_a_scene_advises_is_a_field_of_it_or_done_with_analyse(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, file: Path, head: str, more: str, table: str
) -> None:
    scene = tmp_path / "scene.toml"
    moves = "[start]\nangular_velocity = [1, 2, 3]\n[run]\nduration = 1\n"
    scene.write_text(f'{head}\npart = "{file}"\nunit = "mm"\n{more}{moves}')
    for command in ("simulate", "trade"):
        main([command, str(scene)])
        text = "".join(capsys.readouterr()).replace(str(file), "")
        advised = {match[0] for match in NAMED.finditer(text)}
        assert "--allow-faults" not in advised
        assert not advised or "with `inertia analyse`: a scene takes sound solids only, and surfaces" in text
    for allowed in re.findall(rf"; (allow_faults = \S+) in (?:its )?{re.escape(table)} gives an answer", text):
        scene.write_text(f'{head}\npart = "{file}"\nunit = "mm"\n{allowed}\n{more}{moves}')
        assert main(["simulate", str(scene)]) == 0


def test_options_stand_for_fields_that_there_are() -> None:
    assert set(simulate.FIELDS.values()) <= actions("tumble").keys()
    assert set(balance.FIELDS.values()) - {""} <= actions("balance").keys()
    sections = json_schema()["properties"]
    for field in balance.FIELDS:
        section, _, name = field.replace("[0]", "").partition(".")
        holder = sections[section].get("items", sections[section])["properties"]
        assert not name or set(name.split(" and ")) <= holder.keys()
    for field in simulate.FIELDS:
        section, _, name = field.partition(".")
        kind = {"run": Settings, "start": Start}[section]
        assert name in schema_of(kind)["properties"]
