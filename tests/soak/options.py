"""Command lines with every option of every command, and values for them out of all proportion, on sample parts."""

from __future__ import annotations

import argparse
from functools import cache
from pathlib import Path

import numpy as np

from inertia_cli.main import build_parser

from .command import outcome_of
from .documents import ROOT
from .workers import Outcome

_COMMANDS = ("analyse", "check", "trade", "simulate", "tumble", "balance", "play", "audit")
_PARTS = (
    "cube.stl",
    "t_handle.stl",
    "tetrahedron.stl",
    "two_region_bar.vtk",
    "broken/nan.stl",
    "broken/missing_face.stl",
)
_INPUTS = {
    "simulate": ("scenes/t_handle.toml", "scenes/spinning_top.toml", "scenes/cube.toml", "cube.stl"),
    "balance": ("rotors/disc.toml", "two_disc_rotor.stl", "disc.stl", "cube.stl"),
    "audit": ("robots/arm.urdf", "cube.stl"),
    "play": ("cube.stl",),
}
_NOT = {"--help", "--live", "--web", "--repeats", "--fix"}  # a viewer; and what only takes time
_NUMBERS = (
    *("0", "-0", "1", "-1", "2", "0.5", "1e-3", "1e-9", "1e-15", "1e-16", "1e-60", "1e-100", "1e-160", "1e-300"),
    *("1e-308", "1e-320", "5e-324", "1e-400", "1e3", "1e6", "1e9", "9e18", "1e30", "1e60", "1e75", "1e100", "1e154"),
    *("1e160", "1e200", "1e300", "1.7e308", "1e308", "1e400", "-1e308", "nan", "inf", "-inf", "", " ", "x", "1,2"),
    *("1_000", "0x10", "١", "1e", "1e99999", "9" * 400, "exact", "\x1b[31m", "a=1", "=1", "a=", "a=nan"),
)
_WORDS = (
    *(
        "mm",
        "m",
        "in",
        "ly",
        "",
        "stl",
        "obj",
        "step",
        "vtk",
        "off",
        "gmsh",
        "exe",
        "x",
        "y",
        "z",
        "steel",
        "unobtainium",
    ),
    *(
        "stored",
        "absolute",
        "ccw",
        "cw",
        "Taylor",
        "DOP853",
        "RK4",
        "LSODA",
        "Euler equations",
        "symmetric top",
        "\udcff",
    ),
    *("\x1b]0;title\x07", "a\nb", "../../etc/passwd", "=cmd|x", "-", "--", "é" * 300),
)
_PART = str(ROOT / "t_handle.stl")
KNOWN = (
    ["analyse", _PART, "--chord", "1e100"],
    ["analyse", _PART, "--shell", "1e308"],
    ["analyse", _PART, "--density", "1e308"],
    ["analyse", _PART, "--density=--"],
    ["tumble", _PART, "--spin", "1,2,3", "--for", "1e160"],
    ["simulate", "nothing.vtu"],
    ["audit", str(ROOT / "robots" / "arm.urdf"), "--density=-1"],
)
"""Command lines that have been faults once."""

_FILES = {"--output": ".rrd", "--csv": ".csv", "--report": ".html", "--cut-part": ".stl", "--plot": ".svg"}


@cache
def _options(command: str) -> list[argparse.Action]:
    parser = build_parser()
    commands = next(each for each in parser._actions if isinstance(each, argparse._SubParsersAction))
    actions = commands.choices[command]._actions
    return [each for each in actions if each.option_strings and not _NOT & {*each.option_strings}]


def arguments_of(seed: int, number: int, folder: Path) -> list[str]:
    """Return the command line of a case; the first are those of `KNOWN`."""
    if number < len(KNOWN):
        return KNOWN[number]
    rng = np.random.default_rng([seed, number])

    def pick(several: tuple[str, ...]) -> str:
        return several[int(rng.integers(len(several)))]

    def value(action: argparse.Action) -> str:
        option = action.option_strings[-1]
        if action.choices is not None and rng.random() < 0.8:
            return pick(tuple(action.choices))
        if action.type in (float, int) and rng.random() < 0.8:
            return pick(_NUMBERS[:44])
        if option in _FILES:
            return str(folder / ("x" + (_FILES[option] if rng.random() < 0.8 else pick(("", ".txt", "/x")))))
        kind = rng.random()
        if kind < 0.45:
            return pick(_NUMBERS)
        if kind < 0.75:
            return ",".join(pick(_NUMBERS[:40]) for _ in range(int(rng.integers(1, 5))))
        return pick(_WORDS)

    command = pick(_COMMANDS)
    line = [command]
    if rng.random() < 0.97:
        line.append(str(ROOT / pick(_INPUTS.get(command, _PARTS))))
    options = _options(command)
    required = [each for each in options if each.required]
    for action in [*required, *(options[rng.integers(len(options))] for _ in range(rng.integers(1, 4)) if options)]:
        option = pick(tuple(action.option_strings))
        if action.nargs == 0 or isinstance(action, argparse.BooleanOptionalAction):
            line.append(option)
        elif rng.random() < 0.2 and option.startswith("--"):
            line.append(f"{option}={value(action)}")
        else:
            line += [option, value(action)]
    if command in ("simulate", "tumble"):
        line += ["--time-limit", "5"]
    if command == "trade":
        line += ["--budget", "0.2", "--repeats", "1"]
    return line


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Run a command line of its own."""
    return outcome_of(arguments_of(seed, number, folder))
