"""JSON documents as they are printed: the same bytes as those of lists, without the lists."""

import io
import json
import os
import subprocess
import sys
import tracemalloc
from typing import Any

import numpy as np
import pytest

from inertia_cli.printing import print_document
from inertia_meshes import path


def lists(value: Any) -> Any:
    """Return a value as json.dumps takes it: arrays as lists, null for what is not finite."""
    if isinstance(value, dict):
        return {key: lists(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return np.where(np.isfinite(value), value, None).tolist() if not np.isfinite(value).all() else value.tolist()
    return value


def test_arrays_are_written_as_lists_of_the_same_numbers_are(capsys: pytest.CaptureFixture[str]) -> None:
    rng = np.random.default_rng(3)
    document = {
        "schema": "inertia/run/1",
        "why": ["A “reason”.", "\u202e"],
        "time": np.linspace(0.0, 1.0, 10_001),
        "attitude": rng.normal(size=(4096, 4)),
        "tensor": rng.normal(size=(4097, 3, 3)),
        "none": np.zeros((0, 3)),
        "quantities": {"θ": np.array([1e-300, -0.0]), "number": np.array(2.5), "hole": np.array([1.0, np.inf, np.nan])},
        "nested": {"a": [1, 2], "b": None},
    }
    print_document(document)
    printed = capsys.readouterr().out
    assert json.loads(printed) == lists(document)
    assert printed.count("\n") == len(document) + 2
    plain = {key: value for key, value in lists(document).items() if key != "why"}
    lines = ",\n".join(f" {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in plain.items())
    assert printed.replace(printed.split("\n")[2] + "\n", "") == "{\n" + lines + "\n}\n"


def test_what_is_wrong_leaves_nothing_half_printed(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="JSON compliant"):
        print_document({"time": np.zeros(3), "mass": float("nan")})
    assert capsys.readouterr().out == ""


def test_printing_takes_no_memory_that_grows_with_the_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    class Counted(io.TextIOBase):
        size = 0

        def write(self, text: str) -> int:
            self.size += len(text)
            return len(text)

    stream = Counted()
    monkeypatch.setattr(sys, "stdout", stream)
    attitude = np.random.default_rng(0).normal(size=(60_000, 4))
    tracemalloc.start()
    print_document({"attitude": attitude})
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert stream.size > 4_000_000
    assert peak < 3_000_000


@pytest.mark.skipif(sys.platform == "win32", reason="pipes break otherwise")
@pytest.mark.parametrize("as_json", [[], ["--json"]], ids=["text", "document"])
@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["analyse", "cube.stl"], 0),
        (["check", "broken/missing_face.stl"], 4),
        (["audit", "robots/arm.urdf"], 5),
        (["balance", "two_disc_rotor.stl"], 4),
        (["balance", "rotors/disc.toml"], 0),
    ],
)
def test_the_verdict_stays_the_exit_code_where_nobody_reads_on(
    arguments: list[str], code: int, as_json: list[str]
) -> None:
    command = [sys.executable, "-c", "from inertia_cli.__main__ import run; run()", *arguments, *as_json]
    reading, writing = os.pipe()
    os.close(reading)
    result = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, cwd=path("cube.stl").parent)
    os.close(writing)
    assert result.returncode == code
    assert b"Traceback" not in result.stderr
