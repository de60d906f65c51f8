"""Volume cells that share space, and cells whose maps fold: refused by number; those that only touch are answered."""

import itertools
import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mass.cells.test_moments import SOLIDS
from tests.mass.cells.textbook_cells import reference
from tests.mesh.checks.test_cells import cells, checked, grid

import inertia
from inertia.mesh.part import Cells, Part
from inertia.units import length_unit

FIVE = np.array([[0, 1, 3, 4], [1, 2, 3, 6], [1, 4, 5, 6], [3, 4, 6, 7], [1, 3, 4, 6]])
SIX = np.array([[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]])
"""A cube's tetrahedra, by its corners in VTK's order."""


def moved(points: np.ndarray, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    turned = Rotation.random(rng=rng).apply(points)
    return (turned + rng.normal(size=3) * 10.0 ** rng.uniform(-1, 2)) * 10.0 ** rng.uniform(-20, 20)


def part(mesh: Cells) -> Part:
    return Part(mesh, length_unit("mm"), "option")


def refusal(mesh: Cells) -> str:
    """Return the one error of a mesh, which `analyse` refuses with too."""
    (fault,) = checked(mesh).faults()
    with pytest.raises(inertia.GeometryError) as error:
        inertia.mass_properties(part(mesh))
    assert str(error.value) == f"the part: {fault.message}"
    return f"{fault.code}: {fault.message}"


def assert_fit(mesh: Cells, volume: float) -> None:
    report = checked(mesh)
    assert (report.faults(), report.crossings_examined) == ((), True)
    answer = inertia.analyse(part(mesh))
    assert answer.crossings_examined
    assert answer.properties.volume * 1e9 == pytest.approx(volume, rel=1e-12)


def joined(*meshes: tuple[np.ndarray, str, np.ndarray]) -> Cells:
    """Return meshes (points, kind, nodes) as one."""
    first = np.cumsum([0, *(len(points) for points, _, _ in meshes)])
    blocks: dict[str, list] = {}
    for start, (_, kind, nodes) in zip(first, meshes, strict=False):
        blocks.setdefault(kind, []).extend((np.asarray(nodes) + start).tolist())
    return cells(np.concatenate([points for points, _, _ in meshes]), **blocks)


TETRA = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


@pytest.mark.parametrize("seed", range(8))
def test_two_tetrahedra_that_cross_are_refused(seed: int) -> None:
    points = np.concatenate([TETRA, TETRA + 0.1])
    points = moved(points, seed) if seed else points
    message = refusal(cells(points, tetra=[[0, 1, 2, 3], [4, 5, 6, 7]]))
    assert "overlapping_cells: overlapping cells: cells 0 and 1 cover the same place around (" in message
    if not seed:
        assert re.search(r"counts twice: about 0\.05[678] mm³: ", message)  # 0.7³/6


@pytest.mark.parametrize("seed", range(4))
def test_a_cell_within_a_block_is_refused(seed: int) -> None:
    points, nodes = grid(4, 4, 4)
    inner = grid(1, 1, 1)[0] * 0.4 + 1.3
    everything = np.concatenate([points, inner])
    everything = moved(everything, seed) if seed else everything
    block = [*nodes.tolist(), (len(points) + grid(1, 1, 1)[1][0]).tolist()]
    message = refusal(cells(everything, hexahedron=block))
    assert "overlapping cells: cells 21 and 64 cover" in message


@pytest.mark.parametrize("shift", [0.0, 1e-9, 0.25, 0.999])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("one", "other"), [*itertools.product([FIVE, SIX, None], repeat=2)])
def test_two_meshes_of_one_cube_are_refused_and_side_by_side_answered(
    one: np.ndarray | None, other: np.ndarray | None, seed: int, shift: float
) -> None:
    points, nodes = grid(1, 1, 1)
    other_points = points[:, [1, 2, 0]] if seed % 2 else points  # the same cube, with other diagonals
    pieces = []
    for where, split in ((points, one), (other_points + np.array([shift, 0, 0]), other)):
        pieces.append((where, "hexahedron" if split is None else "tetra", nodes if split is None else nodes[0][split]))
    mesh = joined(*pieces)
    mesh = Cells(moved(mesh.points, seed), mesh.blocks)
    assert "overlapping_cells" in [finding.code for finding in checked(mesh).faults()] or "duplicate_cell" in [
        finding.code for finding in checked(mesh).faults()
    ]
    apart = joined(pieces[0], (pieces[1][0] + np.array([1.0 - shift, 0, 0]), *pieces[1][1:]))
    assert checked(Cells(moved(apart.points, seed), apart.blocks)).fit


@pytest.mark.parametrize("seed", range(6))
def test_blocks_of_other_sizes_that_touch_are_answered(seed: int) -> None:
    coarse, fine = grid(2, 2, 2), grid(3, 5, 4)
    turn = Rotation.from_euler("xyz", np.random.default_rng(seed).normal(size=3) if seed else np.zeros(3))
    points = coarse[0], fine[0] * [2 / 3, 2 / 5, 1 / 2] + [2, 0, 0]
    split = np.concatenate([nodes[FIVE] for nodes in fine[1]])
    offset = [1000.0 / 3, -7.0 / 9, 1e3] if seed > 2 else np.zeros(3)
    mesh = joined(
        (turn.apply(points[0]) + offset, "hexahedron", coarse[1]), (turn.apply(points[1]) + offset, "tetra", split)
    )
    assert_fit(mesh, 16.0)
    with pytest.raises(inertia.GeometryError, match="cover the same place"):
        inertia.mass_properties(
            part(
                Cells(mesh.points - turn.apply([0.01, 0, 0]) * (np.arange(len(mesh.points)) > 26)[:, None], mesh.blocks)
            )
        )


@pytest.mark.parametrize("seed", range(6))
def test_hanging_nodes_are_answered(seed: int) -> None:
    """A cube beside eight cubes of half the size, under a row that shares faces with both."""
    turn = Rotation.from_euler("xyz", np.random.default_rng(seed).normal(size=3) if seed else np.zeros(3))
    fine, row = grid(2, 2, 2), grid(2, 1, 1)
    mesh = joined(
        (turn.apply(grid(1, 1, 1)[0]), "hexahedron", grid(1, 1, 1)[1]),
        (turn.apply(fine[0] / 2 + [1, 0, 0]), "hexahedron", fine[1]),
        (turn.apply(row[0] + [0, 0, 1]), "hexahedron", row[1]),
    )
    assert_fit(mesh, 4.0)


def test_a_ring_that_closes_on_itself_is_answered_and_one_that_runs_on_is_refused() -> None:
    def ring(turn: float, steps: int = 24) -> Cells:
        points, nodes = grid(steps, 1, 1)
        angle, radius = np.deg2rad(turn) * points[:, 0] / steps, 3 + points[:, 1]
        return cells(np.column_stack([radius * np.cos(angle), -radius * np.sin(angle), points[:, 2]]), hexahedron=nodes)

    for turn in (90, 350, 360):
        assert checked(ring(turn)).fit
    assert "overlapping cells: cells 0 and 23 cover the same place" in refusal(ring(370))
    assert "overlapping cells" in refusal(ring(700))


def test_a_cell_turned_inside_out_by_its_neighbours_is_refused() -> None:
    """Five tetrahedra around a node that has left through a face: all volumes count, none is tangled."""
    points = np.concatenate([TETRA, [[0.2, 0.2, 0.2]]])
    around = [[4, 1, 2, 3], [0, 4, 2, 3], [0, 1, 4, 3], [0, 1, 2, 4]]
    assert_fit(cells(points, tetra=around), 1 / 6)
    points[4] = [0.2, 0.2, -0.1]
    message = refusal(cells(points, tetra=around))
    assert "3 faces with both cells on one side" in message
    assert "between cells" in message


@pytest.mark.parametrize("kind", SOLIDS)
@pytest.mark.parametrize("seed", range(3))
def test_cells_of_every_kind_are_refused_where_they_cross(kind: str, seed: int) -> None:
    nodes = reference(kind)
    count = len(nodes)
    bent = nodes + 0.02 * np.random.default_rng(seed).normal(size=nodes.shape)
    both = [list(range(count)), list(range(count, 2 * count))]
    apart = np.concatenate([bent, bent + np.array([2.6, 0, 0])])
    assert checked(cells(moved(apart, seed), **{kind: both})).fit
    near = np.concatenate([bent, bent + np.array([0.05, 0.07, 0.03])])
    assert "cells 0 and 1 cover the same place" in refusal(cells(moved(near, seed), **{kind: both}))
    mirrored = near * [1, 1, -1]
    assert "cells 0 and 1 cover the same place" in refusal(cells(moved(mirrored, seed), **{kind: both}))


def test_what_is_not_examined_says_so() -> None:
    mesh = cells(np.concatenate([TETRA, TETRA + 0.1]), tetra=[[0, 1, 2, 3], [4, 5, 6, 7]])
    report = inertia.check(part(mesh), intersections=False)
    assert (report.fit, report.crossings_examined) == (True, False)
    answer = inertia.analyse(part(mesh), intersections=False)
    assert not answer.crossings_examined
    assert answer.properties.volume == pytest.approx(1e-9 / 3)


def interiors_meet(one: list[list[int]], other: list[list[int]]) -> bool:
    """Say whether two tetrahedra with whole coordinates share space: no axis of theirs separates them."""

    def cross(a: list[int], b: list[int]) -> tuple[int, int, int]:
        return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]

    def edges(corners: list[list[int]]) -> list[list[int]]:
        return [[q - p for p, q in zip(a, b, strict=True)] for a, b in itertools.combinations(corners, 2)]

    axes = [
        cross(a, b)
        for pair in ((one, one), (other, other), (one, other))
        for a in edges(pair[0])
        for b in edges(pair[1])
    ]
    for axis in axes:
        low, high = ([sum(x * y for x, y in zip(axis, p, strict=True)) for p in corners] for corners in (one, other))
        if any(axis) and (max(low) <= min(high) or max(high) <= min(low)):
            return False
    return True


@pytest.mark.parametrize("size", [3, 4, 20])
def test_any_two_tetrahedra_are_judged_as_separating_axes_judge_them(size: int) -> None:
    rng = np.random.default_rng(size)
    verdicts = []
    while len(verdicts) < 40:
        corners = rng.integers(0, size, (8, 3))
        shared = rng.integers(0, 4)
        corners[4 : 4 + shared] = corners[:shared]
        if any(round(float(np.linalg.det(c[1:] - c[0]))) == 0 for c in (corners[:4], corners[4:])):
            continue
        points = Rotation.random(rng=rng).apply(corners) if len(verdicts) % 2 else corners.astype(float)
        verdicts.append(interiors_meet(corners[:4].tolist(), corners[4:].tolist()))
        at = np.r_[:4, :shared, 4 + shared : 8]  # what is shared keeps its bits
        assert checked(cells(points[at], tetra=[[0, 1, 2, 3], [4, 5, 6, 7]])).fit != verdicts[-1]
    assert 5 < sum(verdicts) < 38
