"""The same bits whatever BLAS library numpy has, its threads and the processor that it takes itself to run on."""

import os
import platform
import subprocess
import sys

import numpy as np
import pytest

from inertia.mass.cells.quadrature import combined
from inertia.mass.cells.shape_functions import table
from inertia.mesh.geometry.cell_shapes import KINDS
from inertia_meshes import path

FILES = ("two_region_bar.vtk", "thin_plate.stl", "t_handle.stl", "ellipsoid.stl", "shaft_impeller.obj")
PRINTED = """
import sys
import numpy as np
from inertia.mass.cells.moments import boundary_area, cell_moments
from inertia.mesh.geometry.cell_shapes import KINDS
from inertia.mesh.part import CellBlock, Cells
from inertia_cli.main import main

rng = np.random.default_rng(0)
for kind in (name for name, kind in KINDS.items() if kind.faces):
    nodes = np.array(KINDS[kind].nodes, float)
    if kind.startswith("pyramid"):  # which are collapsed bricks
        nodes = np.column_stack([nodes[:, :2] * nodes[:, 2:], 1 - nodes[:, 2]])
    points = nodes + rng.normal(size=(700, 1, 3)) + 0.004 * rng.normal(size=(700, len(nodes), 3))
    cells = Cells(points.reshape(-1, 3), (CellBlock(kind, np.arange(700 * len(nodes)).reshape(700, -1)),))
    print(kind, cell_moments(cells).moments, boundary_area(cells).hex())
for file in sys.argv[1:]:
    main(["analyse", file, "--json", "--unit", "mm", "--density", "7850"])
    if file.endswith(".stl"):
        main(["analyse", file, "--json", "--unit", "mm", "--density", "7850", "--chord", "0.01"])
"""


def printed(**variables: str) -> str:
    command = [sys.executable, "-c", PRINTED, *(str(path(name)) for name in FILES)]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("OPENBLAS")}
    return subprocess.run(command, env=environment | variables, capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def on_one_thread() -> str:
    return printed(OPENBLAS_NUM_THREADS="1")


X86 = platform.machine() in ("x86_64", "AMD64")
ELSEWHERE = [
    {"OPENBLAS_NUM_THREADS": "2"},
    {"OPENBLAS_NUM_THREADS": "4"},
    *([{"OPENBLAS_CORETYPE": "Haswell"}, {"OPENBLAS_CORETYPE": "Prescott"}] if X86 else []),
]


@pytest.mark.parametrize("variables", ELSEWHERE, ids=lambda variables: "=".join(next(iter(variables.items()))))
def test_what_blas_does_is_in_no_figure(variables: dict[str, str], on_one_thread: str) -> None:
    assert printed(**variables) == on_one_thread


@pytest.mark.skipif(not X86, reason="numpy may fuse products and sums elsewhere")
@pytest.mark.parametrize("kind", [name for name, kind in KINDS.items() if kind.faces])
@pytest.mark.parametrize("cells", [1, 3, 256])
def test_the_nodes_of_a_cell_are_added_in_their_order(kind: str, cells: int) -> None:
    coefficients = table(kind).values
    edges = np.random.default_rng(1).normal(size=(coefficients.shape[1], 3, cells))
    total = np.zeros((len(coefficients), 3, cells))
    for coefficient, edge in zip(coefficients.T, edges, strict=True):
        total += coefficient[:, None, None] * edge
    assert combined(coefficients, edges).tolist() == total.tolist()
