"""Scenes and rotors with figures out of all proportion, fields left out or doubled, and bytes changed at random."""

from __future__ import annotations

import copy
import itertools
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from .command import outcome_of
from .workers import Outcome

ROOT = Path(__file__).resolve().parents[2] / "meshes" / "inertia_meshes"
SAMPLES = sorted([*(ROOT / "scenes").glob("*.toml"), *(ROOT / "rotors").glob("*.toml")])

EXTREMES: tuple[Any, ...] = (
    *(0, 0.0, -0.0, 1, -1, 2, 1.5, -1.5, 3, 7, 360, 1e3, 1e6, 10**6, 1e9, 10**9),
    *(5e-324, 1e-320, 1e-308, 1e-200, 1e-160, 1e-100, 1e-75, 1e-30, 1e-16, 1e-15, 1e-9, 1e-3),
    *(1e15, 1e16, 9e18, 2**63 - 1, 2**63, 2**31, 10**30, 1e30, 1e75, 1e100, 1e150, 1e154, 1e160, 1e200, 1e300),
    *(1.7976931348623157e308, -1e308, -1e160, -1e30, -9e18, -(2**63), 10**400, float("inf"), float("nan")),
    *(True, "", "x", [], [1.0, 2.0, 3.0], {}),
)
"""What a figure of a file is replaced by."""


def numbers_in(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of every number in a document."""
    if isinstance(value, dict | list):
        for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
            yield from numbers_in(entry, (*path, key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path


@cache
def _table(sample: Path) -> tuple[dict[str, Any], list[tuple[Any, ...]]]:
    table = tomllib.loads(sample.read_text(encoding="utf-8"))
    return table, list(numbers_in(table))


@cache
def systematic() -> list[tuple[Path, tuple[Any, ...], Any]]:
    """Return every number of every sample with everything that it is replaced by."""
    return [
        (sample, path, extreme)
        for sample, extreme in itertools.product(SAMPLES, EXTREMES)
        for path in _table(sample)[1]
    ]


def replaced(table: dict[str, Any], path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    """Return a document with another value at a path."""
    whole = copy.deepcopy(table)
    inner: Any = whole
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return whole


def text_of(seed: int, number: int) -> tuple[Path, bytes]:
    """Return the sample and the text of a case: one figure replaced, until that has been done everywhere."""
    cases = systematic()
    if number < len(cases):
        sample, path, extreme = cases[np.random.default_rng(seed).permutation(len(cases))[number]]
        return sample, tomli_w.dumps(replaced(_table(sample)[0], path, extreme)).encode()
    rng = np.random.default_rng([seed, number])
    sample = SAMPLES[rng.integers(len(SAMPLES))]
    if rng.random() < 0.5:
        return sample, mutated(sample.read_bytes(), rng)
    table, paths = _table(sample)
    for _ in range(rng.integers(2, 4)):
        table = replaced(table, paths[rng.integers(len(paths))], EXTREMES[rng.integers(len(EXTREMES))])
    return sample, tomli_w.dumps(table).encode()


_WORDS = (b"1e308", b"-", b"0", b"9", b"nan", b"[", b"]", b'"', b"=", b"\n", b"[[load]]\n", b"\x1b[2J", b"\xff", b"e")


def mutated(data: bytes, rng: np.random.Generator) -> bytes:
    """Return a text after one to three random changes."""
    changed = bytearray(data)
    lines = data.splitlines(keepends=True)
    for _ in range(rng.integers(1, 4)):
        at = int(rng.integers(0, len(changed) + 1))
        match rng.integers(0, 6):
            case 0:
                changed[at : at + 1] = rng.bytes(1)
            case 1:
                del changed[at : at + int(rng.integers(1, 30))]
            case 2:
                changed[at:at] = _WORDS[rng.integers(0, len(_WORDS))]
            case 3:
                changed += lines[rng.integers(0, len(lines))]
            case 4:
                del changed[at:]
            case 5:
                changed[at:at] = changed[at : at + int(rng.integers(1, 60))]
    return bytes(changed)


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Run a document of its own through its command."""
    sample, text = text_of(seed, number)
    for name in ROOT.iterdir():
        if name.is_file() and not (folder / name.name).exists():
            (folder / name.name).symlink_to(name)
    inside = folder / sample.parent.name
    inside.mkdir(exist_ok=True)
    for name in sample.parent.glob("*.csv"):
        if not (inside / name.name).exists():
            (inside / name.name).symlink_to(name)
    file = inside / "document.toml"
    file.write_bytes(text)
    verb = "simulate" if sample.parent.name == "scenes" else "balance"
    options = ["--time-limit", "10"] if verb == "simulate" else ["--time", "1"]
    printed = [] if any(b"samples" in line and len(line) > 14 for line in text.splitlines()) else ["--json"]
    outcome = outcome_of([verb, str(file), *options, *printed])
    if outcome.kind == "fault":
        return Outcome("fault", f"{sample.stem}: {outcome.fault}")
    return outcome
