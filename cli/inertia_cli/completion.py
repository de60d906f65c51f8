"""The command `completion`."""

from __future__ import annotations

import argparse
import re
from typing import Any

SHELLS = ("bash", "zsh", "fish")
_FILES = ("PART", "SCENE", "ROTOR", "JOB", "RUN", "DOCUMENT", "OUT", "FILE", "OLD", "NEW")


def add(parsers: Any) -> None:
    """Add ``inertia completion``."""
    parser = parsers.add_parser(
        "completion",
        help="what a shell needs to complete commands, options and files",
        description="Print what a shell needs to complete commands, options and files.",
        epilog="examples:\n"
        "  inertia completion bash > ~/.local/share/bash-completion/completions/inertia\n"
        '  inertia completion zsh > "${fpath[1]}/_inertia"\n'
        "  inertia completion fish > ~/.config/fish/completions/inertia.fish\n",
    )
    parser.set_defaults(run=run, part="completion", parsers=parsers)
    parser.add_argument("shell", choices=SHELLS)


def run(options: argparse.Namespace) -> int:
    """Run ``inertia completion``."""
    import shtab

    commands = {name: each for name, each in options.parsers.choices.items() if " " not in name}
    for name, other in options.parsers.choices.items():  # of two words: a shell sees its options behind the first
        if " " in name:
            _join(commands[name.partition(" ")[0]], other)
    for command in commands.values():
        for action in command._actions:
            names = action.metavar if isinstance(action.metavar, tuple) else (action.metavar or "",)
            if any(word in _FILES for name in names for word in re.split(r"[. |]+", name)):
                action.complete = shtab.FILE
    options.parsers.choices.clear()
    options.parsers.choices.update(commands)
    options.parsers._choices_actions[:] = [each for each in options.parsers._choices_actions if each.dest in commands]
    parser = argparse.ArgumentParser(prog="inertia")
    parser.add_argument("--version", action="store_true", help="show program's version number and exit")
    parser._add_action(options.parsers)
    print(shtab.complete(parser, options.shell))
    return 0


def _join(command: argparse.ArgumentParser, other: argparse.ArgumentParser) -> None:
    """Add the options of one command that another does not have, and its files behind the word that names it."""
    known = {word for action in command._actions for word in action.option_strings}
    for action in other._actions:
        if known.isdisjoint(action.option_strings):
            command._add_action(action)
