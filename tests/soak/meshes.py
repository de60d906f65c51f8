"""Mesh files of every format with bytes changed at random, and files of one kind under the name of another."""

from __future__ import annotations

import io
import re
import struct
import zipfile
from functools import cache
from pathlib import Path

import numpy as np
from tests.mesh.readers.samples import CORNERS, QUADS, archive_3mf, binary_stl, model_3mf, obj, surfaces, volumes
from tests.mesh.readers.step_sample import step_solid
from tests.mesh.readers.test_fuzz import mutate

from .command import outcome_of
from .workers import Outcome

_COMMANDS = (
    *(["analyse", "--json"],) * 5,
    ["analyse"],
    ["analyse", "--repair", "--json"],
    ["analyse", "--weld", "1e-6", "--json"],
    ["analyse", "--shell", "1", "--json"],
    ["check", "--json"],
    ["check"],
)
_NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
_NUMBERS = (
    *(b"1e999", b"-1e308", b"1e160", b"1e150", b"1e76", b"1e-320", b"nan", b"inf", b"-0", b"1e-9", b"2147483648"),
    *(b"9223372036854775807", b"99999999999999999999", b"100000000", b"-1", b"0", b"1e9", b"0.5", b"1" * 5000),
)
_PATTERNS = (
    *(struct.pack("<f", value) for value in (float("inf"), 3e38, 1e-45, -0.0, 1e9)),
    *(struct.pack("<d", value) for value in (float("inf"), float("nan"), 1e308, 1e150, 5e-324)),
    *(b"\x01\x00\x80\x7f", b"\x7f\x80\x00\x01", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\x00\x40"),
    *(b"\x01\x00\x00\x00\x00\x00\xf0\x7f", b"\xff" * 8, b"\x00" * 8),
)
"""The first two after the doubles are signalling NaNs, as is the one of eight bytes."""

_ENCODINGS = (
    b"gb2312",
    b"shift_jis",
    b"utf9",
    b"utf-16",
    b"idna",
    b"rot13",
    b"zlib",
    b"koi8-r",
    b"big5",
    b"",
    b"utf-7",
)

_STEP_SHARE = 2e-4
"""Of all cases: OpenCASCADE reads STEP in a process of its own, which takes half a second."""


@cache
def _samples(folder: Path) -> tuple[tuple[str, bytes], ...]:
    inside = folder / "samples"
    inside.mkdir(exist_ok=True)
    return (*surfaces().values(), *volumes(inside).values())


@cache
def known() -> tuple[tuple[str, bytes, list[str]], ...]:
    """Return files that have been faults once."""
    model = model_3mf("", "")
    encodings = ("gb2312", "shift_jis", "utf9", "idna")
    return (
        ("a.ply", b"end_header\n", ["analyse"]),
        *(("a.3mf", archive_3mf(re.sub("(?i)utf-8", each, model)), ["analyse"]) for each in encodings),
        *(
            ("a.obj", obj(corners=CORNERS * size).encode(), command)
            for size in (1e150, 1e160, 1e307)
            for command in (["analyse", "--repair"], ["analyse", "--weld", "1e-9"], ["check"])
        ),
        ("a.stl", binary_stl()[:96] + _PATTERNS[10] + binary_stl()[100:], ["analyse"]),
    )


def file_of(seed: int, number: int, folder: Path) -> tuple[str, bytes, list[str]]:
    """Return name and contents of the file of a case, and what is asked of it; the first are those of `known`."""
    if number < len(known()):
        return known()[number]
    rng = np.random.default_rng([seed, number])
    samples = _samples(folder)
    other = samples[rng.integers(len(samples))][1]
    if rng.random() < _STEP_SHARE:
        name, data, other = "box.step", step_solid(CORNERS, QUADS.tolist(), "Block").encode(), b"#1 = #1;\n#99999"
    else:
        name, data = samples[rng.integers(len(samples))]
    if rng.random() < 0.02:
        name = f"part{Path(samples[rng.integers(len(samples))][0]).suffix}"
    command = _COMMANDS[rng.integers(len(_COMMANDS))]
    return name, damaged(data, rng, other), command


def damaged(data: bytes, rng: np.random.Generator, other: bytes) -> bytes:
    """Return `data` changed at random; of an archive mostly what is within."""
    if data.startswith(b"PK\x03\x04") and rng.random() < 0.8:
        members = _members(data)
        chosen = list(members)[rng.integers(len(members))]
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as archive:
            for name, inside in members.items():
                archive.writestr(name, damaged(inside, rng, other) if name == chosen else inside)
        return packed.getvalue()
    if data.startswith(b"<") and rng.random() < 0.1:
        declaration = b'<?xml version="1.0" encoding="%s"?>' % _ENCODINGS[rng.integers(len(_ENCODINGS))]
        return declaration + re.sub(rb"^<\?xml.*?\?>", b"", data)
    return mutate(data, rng, other) if rng.random() < 0.6 else with_extremes(data, rng)


@cache
def _members(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def with_extremes(data: bytes, rng: np.random.Generator) -> bytes:
    """Return `data` with one to three of its numbers out of all proportion, written or in binary."""
    changed = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        written = list(_NUMBER.finditer(changed)) if data.isascii() else []
        if written:
            at = written[rng.integers(len(written))]
            changed[at.start() : at.end()] = _NUMBERS[rng.integers(len(_NUMBERS))]
        else:
            pattern = _PATTERNS[rng.integers(len(_PATTERNS))]
            begin = 4 * int(rng.integers(len(changed) // 4)) + int(rng.integers(4)) * int(rng.random() < 0.2)
            changed[begin : begin + len(pattern)] = pattern
    return bytes(changed)


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Run a damaged file through a command."""
    name, data, (verb, *options) = file_of(seed, number, folder)
    file = folder / name
    file.write_bytes(data)
    return outcome_of([verb, str(file), *options])
