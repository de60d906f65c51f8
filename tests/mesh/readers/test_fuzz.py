"""Damaged files of every format are refused, or read as a second reader reads them: never misread in silence.

No other exception, no output, no hang either. The second readers are `tests.mesh.readers.second_readers`.
`INERTIA_FUZZ` sets the number of mutations (2000 unless told). OpenCASCADE reads STEP in a process of its
own, which takes half a second, so that a few mutations of a STEP file stand for many.
"""

import os
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import CORNERS, QUADS, surfaces, volumes
from tests.mesh.readers.second_readers import agree, shape_of
from tests.mesh.readers.step_sample import step_solid

from inertia.errors import ReadError
from inertia.mesh.part import Cells, Part
from inertia.mesh.read import read

MUTATIONS = int(os.environ.get("INERTIA_FUZZ", "2000"))
SURFACES = tuple(surfaces())
VOLUMES = (
    *(
        "gmsh 2.2",
        "gmsh 4.1",
        "gmsh 2.2 binary",
        "gmsh 4.1 binary",
        "nastran",
        "abaqus",
        "vtk text",
        "vtk binary",
    ),
    *("vtk 5.1", "vtu", "vtu text", "med", "xdmf", "medit", "netgen", "su2", "avsucd"),
)
SAMPLES = (*SURFACES, *VOLUMES)
WORDS = (b"99999999", b"-1", b"1e999", b"nan", b" ", b"\n", b"0", b"1", b"\0", b"-", b"\xff\xff\xff\x7f")


def mutate(data: bytes, rng: np.random.Generator, other: bytes) -> bytes:
    """Return `data` after one or two random changes."""
    changed = bytearray(data)
    for _ in range(rng.integers(1, 3)):
        at = int(rng.integers(0, len(changed) + 1))
        stop = at + int(rng.integers(1, 41))
        match rng.integers(0, 8):
            case 0:
                changed[at : at + 1] = bytes(byte ^ 1 << int(rng.integers(0, 8)) for byte in changed[at : at + 1])
            case 1:
                changed[at : at + 1] = rng.bytes(1)
            case 2:
                del changed[at:]
            case 3:
                changed[at:at] = rng.bytes(int(rng.integers(1, 9)))
            case 4:
                del changed[at:stop]
            case 5:
                changed[at:at] = changed[at:stop]
            case 6:
                changed[at:at] = WORDS[rng.integers(0, len(WORDS))]
            case 7:
                begin = int(rng.integers(0, len(other)))
                changed[at : at + 16] = other[begin : begin + 16]
    return bytes(changed)


def read_or_refuse(path: Path, data: bytes) -> Part | None:
    path.write_bytes(data)
    try:
        part = read(path)
    except ReadError as error:
        message = str(error)
        assert message.startswith(f"cannot read {path}: ")
        assert message.isprintable()
        return None
    assert isinstance(part, Part)
    return part


def cells_of(part: Part) -> list[np.ndarray]:
    if isinstance(part.geometry, Cells):
        return [part.geometry.points[nodes] for block in part.geometry.blocks for nodes in block.nodes]
    return list(part.triangles.corners())


def outlines(cells: list[np.ndarray]) -> Counter[tuple[tuple[float, ...], tuple[float, ...]]]:
    """Return the directed edges that have no opposite: those of faces, however these are split."""
    points = [[tuple(point) for point in cell.tolist()] for cell in cells]
    edges = Counter((a, b) for cell in points for a, b in zip(cell, cell[1:] + cell[:1], strict=True))
    return edges - Counter({(b, a): count for (a, b), count in edges.items()})


@pytest.mark.parametrize("sample", SAMPLES)
def test_mutated_files_are_refused_or_read_as_a_second_reader_does(
    sample: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    samples = {**surfaces(), **volumes(tmp_path)}
    assert tuple(samples) == SAMPLES
    name, data = samples[sample]
    rng = np.random.default_rng(SAMPLES.index(sample))
    capfd.readouterr()
    for mutant in range(-(-MUTATIONS // len(SAMPLES)) + 1):
        other = samples[SAMPLES[rng.integers(0, len(SAMPLES))]][1]
        mutated = data if mutant == 0 else mutate(data, rng, other)
        part = read_or_refuse(tmp_path / name, mutated)
        if part is not None:
            second = shape_of(part.source.format, mutated)
            cells = cells_of(part)
            same = agree(cells, second)
            if not same and any("not convex" in note or "into triangles" in note for note in part.notes):
                same = len(cells) == len(second) and outlines(cells) == outlines(second)  # it splits into fans
            assert same, f"mutant {mutant} of {sample} is read otherwise by a second reader"
    assert capfd.readouterr() == ("", "")


def test_mutated_step_files_are_read_or_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("OCP")
    data = step_solid(CORNERS, QUADS.tolist(), "Block").encode()
    rng = np.random.default_rng(0)
    for _ in range(max(4, MUTATIONS // 500)):
        read_or_refuse(tmp_path / "box.step", mutate(data, rng, b"#1 = #1;\n#99999"))
    assert capfd.readouterr() == ("", "")
