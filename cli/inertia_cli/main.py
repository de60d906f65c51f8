"""Run a command, and turn whatever goes wrong into a sentence."""

from __future__ import annotations

import argparse
import io
import os
import re
import signal
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn, TextIO

import inertia
from inertia.errors import CacheWarning, GeometryError, InertiaError, UsageError, WaitingWarning, WriteError, visible
from inertia.output import sparing_inputs
from inertia.standard_input import DESCRIPTOR, require_name
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia_cli import (
    analyse,
    assembly,
    audit,
    balance,
    batch,
    budget,
    check,
    cite,
    completion,
    measure,
    play,
    simulate,
    trade,
    tumble,
)
from inertia_cli.interruption import interruption
from inertia_cli.printing import AnsweredError, abandon_output, print_document
from inertia_cli.wording import as_option

FAULT = 1
_COMMANDS = (
    analyse, check, trade, simulate, tumble, play, balance, measure, audit, assembly, budget, batch, cite, completion,
)  # fmt: skip
_INPUTS = ("part", "compare", "paths", "manifest", "merge")
"""The arguments, of whatever command, that name files to be read."""
_UNREAD = "cannot read "
_CODES = """exit codes:
  0  done
  1  a fault of this program, or the result could not be written
  2  the command line is not usable
  3  the file cannot be read
  4  the mesh or the data cannot give an honest answer;
     of `audit`, `balance` and `budget`: undecided, or conditional
  5  judged, and out of tolerance; of `balance` too: fewer than half of the
     parts within it
"""


class _Unusable(SystemExit):
    """A command line that cannot be parsed; its sentence is on standard error."""

    def __init__(self, message: str) -> None:
        self.message = message
        super().__init__(UsageError.exit_code)


class _HelpFormatter(argparse.HelpFormatter):
    """Wraps a text that is one line, and leaves one of several lines, as examples are, as it is."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if "\n" in text else super()._fill_text(text, width, indent)


class _Once(argparse._StoreAction):
    """Takes an option's value; a second one is refused, not taken in place of the first."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        given = vars(namespace).setdefault("given", set())
        if option is not None and self.dest in given:
            raise argparse.ArgumentError(self, "it is given twice: give it once")
        given.add(self.dest)
        super().__call__(parser, namespace, values, option)


class _Parser(argparse.ArgumentParser):
    def __init__(self, **arguments: Any) -> None:
        defaults: dict[str, Any] = {"formatter_class": _HelpFormatter, "allow_abbrev": False}
        super().__init__(**defaults | arguments)
        for action in (None, "store"):
            self.register("action", action, _Once)

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help or version; argparse itself passes over what cannot be written."""
        if file is not None:
            file.write(message)

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """Leave once the help or version that was printed is written; with exit code 1 where it cannot be."""
        super().exit(_written() if status == 0 else status, message)

    def error(self, message: str) -> NoReturn:
        """Leave with one sentence and exit code 2."""
        sentence = f"{visible(message)}; see `{self.prog} --help`"
        print(f"{self.prog}: {sentence}", file=sys.stderr)
        raise _Unusable(sentence)


def build_parser() -> argparse.ArgumentParser:
    """Return the parser; the chosen command's function is its default `run`."""
    parser = _Parser(
        prog="inertia",
        description="Mesh in, exact inertia out.",
        epilog=_CODES,
    )
    parser.add_argument("--version", action="version", version=f"inertia {inertia.__version__}")
    parsers = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for command in _COMMANDS:
        command.add(parsers)
    return parser


def run() -> None:
    """Run the command line of this process and leave with its exit code."""
    interruption.install()
    _open_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="inertia.ascii")  # a terminal without "³" gets "^3"
    warnings.showwarning = _note
    try:
        code = main(sys.argv[1:])
    except KeyboardInterrupt:  # just before or after what there is to clean up
        code = interruption.code
    interruption.finish()
    sys.exit(code)


def _open_streams() -> None:
    """Let standard streams that are closed lead nowhere, so that no file that is opened takes their place."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115  # until the end


def _note(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Print a warning as a sentence, one a run for the cache; there are no others but for faults of this program."""
    if sys.stderr is None:
        return
    if issubclass(category, CacheWarning | WaitingWarning):
        if issubclass(category, CacheWarning):
            warnings.simplefilter("ignore", CacheWarning)
        print(f"inertia: {visible(str(message))}", file=sys.stderr)
    else:
        print(warnings.formatwarning(message, category, filename, lineno, line), file=sys.stderr, end="")


def main(arguments: Sequence[str]) -> int:
    """Run one command line and return the exit code; see the table in ``inertia --help``."""
    # One thread is plenty for 3×3 matrices, and starting the others costs more than a small part.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    parser = build_parser()
    try:
        for argument in arguments:
            if argument.startswith("--") and argument.endswith("=--"):  # argparse would go on without the value
                parser.error(f"argument {argument[:-3]}: expected one argument")
        for argument in arguments[: arguments.index("--")] if "--" in arguments else arguments:
            if re.match(r"-[^-].*\.", argument) and Path(argument).is_file():
                parser.error(f"argument {argument}: it begins as an option does: write ./{argument} for that file")
        words = _join_names(_join_negative(arguments, parser))
        options, more = parser.parse_known_args(words)
        if more:
            _require_options(words, more, parser)
            parser.error(_too_many(more, options))
    except _Unusable as unusable:
        if "--json" in arguments and sys.stdout is not None:
            _print_refusal(UsageError(), unusable.message, [])
        raise
    except OSError as error:  # of help or version
        return _unwritten(error)
    if getattr(options, "live", False):  # what Rerun would print of a viewer that ends is told in a sentence
        os.environ.setdefault("RUST_LOG", "off")
    if sys.stdout is None:
        return _written()
    try:
        interruption.running = True
        with warnings.catch_warnings():
            # What numpy would warn of and go on with, an overflow most of all, is no ground for an answer.
            warnings.simplefilter("error", RuntimeWarning)
            warnings.simplefilter("always", WaitingWarning)
            with sparing_inputs(_inputs(options)):
                code: int = options.run(options)
        return _written() or code
    except InertiaError as error:
        return _refuse(error, options)
    except AnsweredError as answered:
        return _refuse(answered.error, options, answered=True)
    except (RuntimeWarning, OverflowError) as beyond:
        message = f"its figures lead beyond what float64 holds ({beyond}): check their sizes and units"
        return _refuse(GeometryError(message, places=(options.part,)), options)
    except KeyboardInterrupt:
        return _interrupted()
    except MemoryError:
        message = f"{options.part} needs more memory than there is: split the part or use a larger machine"
        return _refuse(GeometryError(message), options)
    except OSError as error:
        return _unwritten(error)
    except Exception as error:
        if interruption.signal:  # a library has made its own of it
            return _interrupted()
        if os.environ.get("INERTIA_TRACEBACK") == "1":
            raise
        message = (
            f"a fault of this program, {type(error).__name__}: {error}; run it again with INERTIA_TRACEBACK=1 and "
            "report what it prints"
        )
        return _refuse(InertiaError(message, places=(options.part,)), options)
    finally:
        interruption.running = False


def _require_options(words: list[str], more: list[str], parser: argparse.ArgumentParser) -> None:
    """Refuse an option that there is none of; which word is its value, and which a file, is not known then."""
    from inertia.documents import nearest

    files = words[words.index("--") + 1 :] if "--" in words else []
    option = next((word.partition("=")[0] for word in more if word.startswith("-") and word not in files), None)
    if option is None:
        return
    command = _commands(parser).get(words[0], parser)
    known = [name.removeprefix("--") for name in command._option_string_actions if name.startswith("--")]
    meant = nearest(option.lstrip("-"), known)
    command.error(f"{option} is unknown" + ("" if meant is None else f": did you mean --{meant}?"))


def _commands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return the parsers of the commands, by their names."""
    of_commands = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return {name: command for action in of_commands for name, command in action.choices.items()}


def _too_many(words: list[str], options: argparse.Namespace) -> str:
    """Say which words of a command line are too many, and that one file is taken."""
    sentence = f"unrecognized arguments: {' '.join(words)}"
    if isinstance(getattr(options, "part", None), str):
        sentence += f"; one file is taken here, {options.part}"
        if options.run.__module__.rpartition(".")[2] in batch.VERBS:
            sentence += ", and several by `inertia batch`"
    return sentence


def _written() -> int:
    """Pass on what standard output still holds, and return the exit code."""
    if sys.stdout is None:
        return _say("cannot write the result: standard output is closed", FAULT)
    try:
        sys.stdout.flush()
    except OSError as error:
        return _unwritten(error)
    return 0


def _unwritten(error: OSError) -> int:
    """Say why standard output takes no more, but where nobody reads it, and return the exit code."""
    with suppress(io.UnsupportedOperation):  # of a stream in memory
        abandon_output()
    if isinstance(error, BrokenPipeError):
        return 0
    return _say(f"cannot write the result: {error.strerror or error}", FAULT)


def _inputs(options: argparse.Namespace) -> Iterator[Path | int]:
    """Yield the files that a command line names to be read; files that these name are noted where they are read."""
    for argument in _INPUTS:
        value = getattr(options, argument, None)
        for name in [value] if isinstance(value, str) else value or ():
            require_name(name)
            yield DESCRIPTOR if name == STANDARD_INPUT else Path(name)


def _refuse(error: InertiaError, options: argparse.Namespace, *, answered: bool = False) -> int:
    """Say what was refused, with ``--json`` as a document too unless there is one, and return the exit code."""
    message = error.sentence.worded(as_option)
    places = _places(error)
    if not isinstance(error, UsageError | WriteError) and not _names(message, options.part):
        message, places = f"{options.part}: {message}", [options.part, *places]
    if not answered and getattr(options, "json", False):
        _print_refusal(error, message, places)
    return _say(message, error.exit_code)


def _names(message: str, file: str) -> bool:
    """Whether a message names a file; the - of standard input is in that of any option too."""
    return re.search(rf"(?<![\w-]){re.escape(visible(file))}(?![\w-])", message) is not None


def _places(error: InertiaError) -> list[str]:
    """Return the files and fields at which an error was met, the outermost first."""
    places = [str(place) for place in error.places]
    if not places and error.sentence.startswith(_UNREAD):
        places = [error.sentence.split(": ")[0]]
    return [place.removeprefix(_UNREAD).removesuffix(" a second time") for place in places]


def _print_refusal(error: InertiaError, message: str, places: list[str]) -> None:
    """Print what is said of a refusal as ``inertia/refusal/1``; where nobody reads it, standard error says it."""
    document = {
        "schema": "inertia/refusal/1",
        "code": error.code,
        "exit_code": error.exit_code,
        "message": message,
        "places": places,
        "remedies": [as_option(remedy) for remedy in error.remedies],
    }
    try:
        print_document(document)
        sys.stdout.flush()
    except OSError:
        abandon_output()


def _interrupted() -> int:
    code = interruption.code
    return _say("interrupted", code) if code == 128 + signal.SIGINT else code


def _say(message: str, code: int) -> int:
    print(f"inertia: {visible(message)}", file=sys.stderr)
    return code


def _join_names(words: list[str]) -> list[str]:
    """Join the two words of ``inertia balance measure``, which is a command of its own."""
    return [measure.NAME, *words[2:]] if words[:2] == measure.NAME.split() else words


def _join_negative(arguments: Sequence[str], parser: argparse.ArgumentParser) -> list[str]:
    """Join ``--about -1,2,3`` and the like with an equals sign; argparse would take the value for an option."""
    valued: set[str] = set()
    words: list[str] = []
    for argument in arguments:
        if words and words[-1].startswith("--") and re.match("-[^-]", argument):
            valued = valued or _valued(parser)
            if words[-1] in valued and argument[:2] not in valued | {"-h"}:
                words[-1] += f"={argument}"
                continue
        words.append(argument)
    return words


def _valued(parser: argparse.ArgumentParser) -> set[str]:
    """Return the options, of whatever command, that take one value."""
    parsers = parser, *_commands(parser).values()
    actions = (action for each in parsers for action in each._actions if action.nargs in (None, argparse.OPTIONAL))
    return {name for action in actions for name in action.option_strings}
