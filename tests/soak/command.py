"""One command line, run in this process, and what is wrong with what it did."""

from __future__ import annotations

import contextlib
import io
import json
import re
import warnings
from collections.abc import Sequence
from typing import NoReturn

from inertia_cli.main import main

from .workers import Outcome

CODES = {0: "answered", 5: "answered", 2: "refused", 3: "refused", 4: "refused"}


def run_command(arguments: Sequence[str]) -> tuple[int, str, str]:
    """Return exit code, standard output and standard error of a command line."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("always")
        try:
            code = main(arguments)
        except SystemExit as leaving:
            code = leaving.code if isinstance(leaving.code, int) else 1
    return code, out.getvalue(), err.getvalue()


def outcome_of(arguments: Sequence[str]) -> Outcome:
    """Run a command line, and judge it: an exit code of the list, one sentence or a document of finite numbers."""
    code, out, err = run_command(arguments)
    fault = fault_in(code, out, err, "--json" in arguments and "--to-toml" not in arguments)
    return Outcome("fault", f"{fault} [{' '.join(arguments)}]") if fault else Outcome(CODES[code])


def fault_in(code: int, out: str, err: str, json_asked: bool) -> str:
    """Return what is wrong with what a command did; empty where nothing is."""
    said = ascii(err[:400])
    if code not in CODES:
        return f"exit code {code}: {said}"
    if re.search(r"\wWarning\b|Traceback", err):  # of Python; what a library calls one may be quoted
        return f"more than a sentence: {said}"
    if any(not (character.isprintable() or character == "\n") for character in err):
        return f"a character that no terminal should see: {said}"
    if code in (2, 3, 4) and not out and (err.count("\n") != 1 or not err.startswith("inertia")):
        return f"not one sentence: {said}"
    if code in (0, 5) and not out:
        return "nothing was said"
    if "needs more memory" in err:
        return f"small files: {said}"
    if json_asked and out:
        try:
            json.loads(out, parse_constant=_refuse)
        except ValueError as error:
            return f"the document is no JSON ({error})"
    elif out and not all(line.isprintable() for line in out.splitlines()):
        return "a character that no terminal should see, in the result"
    return ""


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"it holds {constant}")
