"""Parts that are written over, cut short, replaced or deleted while they are read: the volume and the SHA-256 that are
told belong together, or the run is refused."""

from __future__ import annotations

import hashlib
import json
import os
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np
from tests.mesh.readers.samples import obj

from .processes import run_process
from .workers import Outcome

_SQUARES = {"small.stl": 1, "large.stl": 170, "part.obj": 30}  # along an edge of a cube


@cache
def _versions(name: str) -> tuple[tuple[bytes, str, float], ...]:
    """Return two contents of a file, each with its SHA-256 and volume in m³: a cube, and one twice as long."""
    return tuple(_blocks(name, length) for length in (1.0, 2.0))


def _blocks(name: str, length: float) -> tuple[bytes, str, float]:
    n = _SQUARES[name]
    u, v = (k.ravel() for k in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    corners = [np.stack([u + du, v + dv], axis=1) for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = []
    for axis in range(3):
        for side in (0, n):
            square = [np.insert(corner, axis, side, axis=1) for corner in corners]
            square = square if (side > 0) == (axis != 1) else square[::-1]
            faces += [np.stack([square[0], *pair], axis=1) for pair in (square[1:3], square[2:4])]
    triangles = np.concatenate(faces) * [length, 1.0, 1.0]
    if name.endswith(".stl"):
        records = np.zeros(len(triangles), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
        records["v"] = triangles
        data = bytes(80) + np.uint32(len(triangles)).tobytes() + records.tobytes()
    else:
        points, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        data = obj(index.reshape(-1, 3), points).encode()
    return data, hashlib.sha256(data).hexdigest(), 1e-9 * length * n**3


@cache
def _length(name: str, folder: Path) -> float:
    file = folder / f"alone-{name}"
    file.write_bytes(_versions(name)[0][0])
    end = run_process(["analyse", str(file), "--json", "--no-intersections"], folder / "x")
    assert end.code == 0, end
    return end.seconds


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Change a file at a moment of its own while it is analysed."""
    rng = np.random.default_rng([seed, number])
    name = list(_SQUARES)[rng.integers(len(_SQUARES))]
    (first, *_), (second, *_) = versions = _versions(name)
    file, other = folder / name, folder / f"new-{name}"
    file.unlink(missing_ok=True)
    file.write_bytes(first)
    old = rng.random() < 0.5
    if old:
        os.utime(file, ns=(0, 0))
    other.write_bytes(second)
    how = ("in place", "bytes in place", "cut short", "replaced", "deleted", "appended")[rng.integers(6)]
    delay = rng.random() * 1.1 * _length(name, folder)
    at = int(rng.integers(len(first)))

    def change(_: int) -> None:
        time.sleep(delay)
        with suppress(FileNotFoundError):
            match how:
                case "in place":
                    with file.open("r+b") as stream:
                        stream.write(second)
                case "bytes in place":
                    with file.open("r+b") as stream:
                        stream.seek(at)
                        stream.write(second[at : at + 1000])
                case "cut short":
                    os.truncate(file, at)
                case "replaced":
                    other.replace(file)
                case "deleted":
                    file.unlink()
                case "appended":
                    with file.open("ab") as stream:
                        stream.write(b"\n")

    end = run_process(["analyse", str(file), "--json", "--no-intersections"], folder / "x", meanwhile=change)
    told = f"{name}, {how} after {delay:.4f} s: "
    if end.code == 3:
        fine = end.err.count("\n") == 1 and json.loads(end.out)["code"]
        return Outcome("refused") if fine else Outcome("fault", f"{told}{end.err[-300:]!r}")
    if end.code == 4 and how in ("bytes in place", "appended", "cut short"):
        return Outcome("refused")  # the change was complete before the file was opened
    if end.code != 0:
        return Outcome("fault", f"{told}exit code {end.code}: {end.err[-300:]!r}")
    document = json.loads(end.out)
    sha256, volume = document["source"]["sha256"], document["volume"]
    expected = {digest: size for _, digest, size in versions}
    if sha256 not in expected:
        changed = hashlib.sha256(file.read_bytes()).hexdigest() if file.exists() else ""
        return Outcome("answered") if sha256 == changed else Outcome("fault", f"{told}a SHA-256 of neither version")
    if abs(volume - expected[sha256]) > 1e-9 * volume:
        return Outcome("fault", f"{told}the volume {volume} under the SHA-256 of the one of {expected[sha256]}")
    return Outcome("answered")
