"""Solids cut into bodies that lie face on face, turned so that rounding moves their faces: as many bodies, no refusal.

The faces of two such bodies lie in one plane but for the last digits, and are triangulated differently; where they have
an edge in common, material lies on material there, or a gap between, as rounding has it.
"""

from itertools import product
from typing import Literal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import inertia
from inertia.arrays import Float, Int
from inertia.mesh.checks import near_bodies
from inertia.mesh.cut import block
from inertia.mesh.geometry.closure import closure, vectorised_closure
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface

Mesh = tuple[Float, Int]
SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def cut(low: Float, high: Float, count: int, rng: np.random.Generator) -> list[tuple[Float, Float]]:
    """Return boxes that fill a box."""
    if count == 1:
        return [(low, high)]
    axis = int(rng.integers(3))
    at = low[axis] + rng.choice([0.25, 0.5, 0.75, 1 / 3]) * (high[axis] - low[axis])
    upper, lower = (np.where(np.arange(3) == axis, at, corner) for corner in (high, low))
    first = int(rng.integers(1, count))
    return cut(low, upper, first, rng) + cut(lower, high, count - first, rng)


def box(low: Float, high: Float, rng: np.random.Generator) -> Mesh:
    """Return a box whose sides are cut along either diagonal."""
    vertices = np.array(list(product(*np.stack([low, high]).T)))
    turned = [np.roll(side, rng.integers(2)) for side in SIDES]
    return vertices, np.concatenate([[side[[0, 1, 2]], side[[0, 2, 3]]] for side in turned])


def sector(radii: Float, angles: Float, heights: Float, rng: np.random.Generator) -> Mesh:
    """Return a sector of a ring, of as many flats as there are angles less one."""
    count = len(angles)
    around = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    vertices = np.concatenate([radius * around + [0, 0, z] for z, radius in product(heights, radii)])
    k = np.arange(count - 1)
    sides = [(k + count, k + 1 + count, k + 1 + 3 * count, k + 3 * count), (k + 1, k, k + 2 * count, k + 1 + 2 * count)]
    sides += [(k, k + 1, k + 1 + count, k + count)]
    sides += [(k + 1 + 2 * count, k + 2 * count, k + 3 * count, k + 1 + 3 * count)]
    ends = [(0, count, 3 * count, 2 * count), (2 * count - 1, count - 1, 3 * count - 1, 4 * count - 1)]
    quads = np.concatenate([*(np.column_stack(side) for side in sides), ends])
    turned = [np.roll(side, rng.integers(2)) for side in quads]
    return vertices, np.concatenate([[side[[0, 1, 2]], side[[0, 2, 3]]] for side in turned])


def placed(solids: list[Mesh], rng: np.random.Generator, *, single: bool) -> Surface:
    """Return solids as one surface, turned and moved, rounded to float32 where it is asked for."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in solids)])
    faces = np.concatenate([faces + start for (_, faces), start in zip(solids, starts[:-1], strict=True)])
    vertices = np.concatenate([vertices for vertices, _ in solids]) @ Rotation.random(random_state=rng).as_matrix().T
    vertices += rng.choice([0.0, 10.0]) * rng.normal(size=3)
    return Surface(vertices.astype(np.float32).astype(float) if single else vertices, faces)


def volume_of(mesh: Mesh) -> float:
    corners = mesh[0][mesh[1]]
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6


def answered(solids: list[Mesh], surface: Surface, *, single: bool) -> None:
    """Compare what is answered with what was cut."""
    analysis = inertia.analyse(Part(surface))
    assert analysis.bodies == len(solids)
    volume = sum(map(volume_of, solids))
    tolerance = 1e-5 if single else 1e-12
    assert inertia.mass_properties(Part(surface)).volume == pytest.approx(volume * 1e-9, rel=tolerance)
    mirrored = Surface(surface.vertices * [-1, 1, 1], surface.faces)
    with pytest.raises(inertia.GeometryError) as refusal:
        inertia.analyse(Part(mirrored))
    assert refusal.value.code == "inward"
    assert inertia.analyse(Part(mirrored), orientation="absolute").bodies == len(solids)


@pytest.mark.parametrize(
    ("thickness", "single"), [(1.0, True), (1e-3, True), (1.0, False), (1e-3, False), (1e-6, False)]
)
@pytest.mark.parametrize("seed", range(6))
def test_a_block_cut_into_blocks(seed: int, thickness: float, single: bool) -> None:
    rng = np.random.default_rng(seed)
    boxes = cut(np.zeros(3), rng.uniform(0.5, 3, 3) * [1, 1, thickness], int(rng.integers(2, 20)), rng)
    solids = [box(low, high, rng) for low, high in boxes if rng.random() < 0.9]
    answered(solids, placed(solids, rng, single=single), single=single)


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_rings_cut_into_sectors(seed: int, single: bool) -> None:
    rng = np.random.default_rng(seed)
    radii, heights = np.cumsum(rng.uniform(0.3, 1, 4)), np.cumsum(rng.uniform(0.2, 1, 3))
    around, flats = int(rng.integers(3, 9)), int(rng.integers(1, 4))
    solids = [
        sector(radii[[i, i + 1]], 2 * np.pi * (j + np.linspace(0, 1, flats + 1)) / around, heights[[k, k + 1]], rng)
        for i, j, k in product(range(3), range(around), range(2))
    ]
    answered(solids, placed(solids, rng, single=single), single=single)


@pytest.mark.parametrize("single", [False, True])
def test_laminations_of_a_rotor_lie_on_one_another(single: bool) -> None:
    rng = np.random.default_rng(1)
    flats = 2 * np.pi * np.linspace(0, 1, 25)
    half = [
        sector(np.array([1.0, 3.0]), angles, 0.05 * np.array([level, level + 1]), rng)
        for level, angles in product(range(8), (flats[:13], flats[12:]))
    ]
    answered(half, placed(half, rng, single=single), single=single)


def voxels(cells: set[tuple[int, int, int]], rng: np.random.Generator) -> Mesh:
    """Return the boundary of cells of a grid, inside out where they are a hole."""
    vertices, faces = [], []
    for cell in sorted(cells):
        corners, _ = box(np.array(cell, float), np.array(cell) + 1.0, rng)
        for side, (axis, step) in zip(SIDES, product(range(3), (-1, 1)), strict=True):
            if tuple(np.add(cell, step * (np.arange(3) == axis))) not in cells:
                faces += [np.add([[0, 1, 2], [0, 2, 3]], 4 * len(vertices))]
                vertices.append(corners[np.roll(side, rng.integers(2))])
    points, number = np.unique(np.concatenate(vertices), axis=0, return_inverse=True)
    return points, number.ravel()[np.concatenate(faces)]


FRAME = set(product(range(3), range(3), range(1))) - {(1, 1, 0)}
SLOT = set(product(range(3), range(2), range(2))) - {(1, 0, 1), (1, 1, 1)}
HOLLOW = set(product(range(3), repeat=3)) - {(1, 1, 1)}
TROUGH = set(product(range(3), range(5), range(2))) - {(1, 1, 1), (1, 2, 1), (1, 3, 1)}
FILLED = {
    "a core in a frame": [FRAME, {(1, 1, 0)}],
    "a magnet in a slot": [SLOT, {(1, 0, 1), (1, 1, 1)}],
    "two magnets in a slot": [SLOT, {(1, 0, 1)}, {(1, 1, 1)}],
    "an insert in a void": [HOLLOW, {(1, 1, 1)}],
    "a magnet in a pocket": [TROUGH, {(1, 1, 1), (1, 2, 1), (1, 3, 1)}],
    "half a pocket": [TROUGH, {(1, 1, 1), (1, 2, 1)}],
}


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", FILLED)
def test_what_fills_a_pocket_lies_beside_what_it_fills(name: str, single: bool) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        solids = [voxels(cells, rng) for cells in FILLED[name]]
        answered(solids, placed(solids, rng, single=single), single=single)


@pytest.mark.parametrize("moved", [1e-12, 1e-8, 3e-7])
def test_an_insert_that_is_a_little_off_its_void_is_in_it(moved: float) -> None:
    for seed in range(12):
        rng = np.random.default_rng(seed)
        wall, (vertices, faces) = (voxels(cells, rng) for cells in FILLED["an insert in a void"])
        solids = [wall, (vertices + np.array([moved, 0, 0]), faces)]
        answered(solids, placed(solids, rng, single=False), single=False)


def block_in_blocks(count: int, seed: int) -> Surface:
    """Return a block cut into blocks, turned, as float32."""
    rng = np.random.default_rng(seed)
    solids = [box(low, high, rng) for low, high in cut(np.zeros(3), np.array([3.0, 2, 1]), count, rng)]
    return placed(solids, rng, single=True)


def test_the_bodies_are_the_same_in_any_order() -> None:
    surface, own = block_in_blocks(40, 7), np.repeat(np.arange(40), 12)
    for order in (np.arange(480), np.random.default_rng(1).permutation(480)):
        shuffled = Surface(surface.vertices, surface.faces[order])
        for labels in (closure(shuffled).labels, vectorised_closure(shuffled).labels):
            assert len(np.unique(np.column_stack([labels, own[order]]), axis=0)) == 40


def test_what_overlaps_by_more_than_rounding_is_refused() -> None:
    rng = np.random.default_rng(3)
    for deep in (1e-4, 1e-2):
        low, high = np.zeros(3), np.ones(3)
        solids = [box(low, high, rng), box(low + np.array([0, 0, 1 - deep]), high + np.array([0, 0, 1]), rng)]
        with pytest.raises(inertia.GeometryError, match="overlapping bodies"):
            inertia.analyse(Part(placed(solids, rng, single=False)))


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_one_body_inside_out_among_those_that_it_touches_is_called_so(seed: int, single: bool) -> None:
    rng = np.random.default_rng(seed)
    low, high = np.zeros(3), np.ones(3)
    vertices, faces = box(low, high, rng)
    steps = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 0, 2]])
    solids = [(vertices + step, faces) for step in steps]
    surface = placed(solids, rng, single=single)
    wrong = np.repeat(np.arange(4), 12) == rng.integers(4)
    part = Part(Surface(surface.vertices, np.where(wrong[:, None], surface.faces[:, ::-1], surface.faces)))
    errors = [finding.code for finding in inertia.check(part).findings if finding.severity == "error"]
    assert errors == ["inverted_body"]
    assert inertia.analyse(part, orientation="absolute").bodies == 4


@pytest.mark.parametrize("deep", [1e-13, 1e-11, 1e-9, 3e-7])
@pytest.mark.parametrize("seed", range(4))
def test_what_bodies_share_by_contact_is_in_the_bounds(seed: int, deep: float) -> None:
    rng = np.random.default_rng(seed)
    low, high = np.zeros(3), np.ones(3)
    above = box(np.array([0.1, 0.2, 1 - deep]), np.array([0.9, 0.9, 1.5]), rng)
    turned = Rotation.random(random_state=rng).as_matrix().T
    solids = [(vertices @ turned, faces) for vertices, faces in (box(low, high, rng), above)]
    starts = [0, len(solids[0][0])]
    faces = np.concatenate([faces + start for (_, faces), start in zip(solids, starts, strict=True)])
    part = Part(Surface(np.concatenate([vertices for vertices, _ in solids]), faces))
    (doubt,) = inertia.check(part).doubts
    assert doubt.doubt is not None
    shared = 0.8 * 0.7 * deep
    assert 0.99 * shared <= doubt.doubt.volume <= 20 * shared


def wound(solids: list[Mesh], inside_out: list[bool]) -> list[Mesh]:
    return [
        (vertices, faces[:, :: -1 if wrong else 1]) for (vertices, faces), wrong in zip(solids, inside_out, strict=True)
    ]


@pytest.mark.parametrize("assembly_is_wrong", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_an_assembly_beside_a_large_body_of_the_other_winding(seed: int, assembly_is_wrong: bool) -> None:
    rng = np.random.default_rng(seed)
    radii, angles = np.array([1.0, 2, 3]), 2 * np.pi * np.linspace(0, 1, 7)
    solids = [sector(radii[[i, i + 1]], angles[[j, j + 1]], np.array([0.0, 1]), rng) for i in (0, 1) for j in range(6)]
    solids += [voxels(cells, rng) for cells in FILLED["an insert in a void"]]
    solids[-2:] = [(vertices + np.array([5, 0, 0]), faces) for vertices, faces in solids[-2:]]
    solids.append(box(np.array([-40.0, 0, 0]), np.array([-10.0, 30, 30]), rng))
    wrong = [assembly_is_wrong] * 14 + [not assembly_is_wrong]
    part = Part(placed(wound(solids, wrong), rng, single=seed % 2 == 1))
    assert {finding.code for finding in inertia.check(part).findings if finding.severity == "error"} == {
        "inverted_body"
    }
    analysis = inertia.analyse(part, orientation="absolute")
    assert analysis.bodies == 15
    assert analysis.properties.volume == pytest.approx(1e-9 * sum(map(volume_of, solids)), rel=1e-5)


def test_bodies_that_enclose_as_much_as_one_inside_out_are_the_same_in_any_order() -> None:
    rng = np.random.default_rng(1)
    solids = [voxels(cells, rng) for cells in FILLED["an insert in a void"]]
    solids.append(box(np.array([10.0, 0, 0]), np.array([13.0, 3, 3]), rng))
    surface = placed(wound(solids, [False, False, True]), rng, single=False)
    for seed in range(6):
        faces = np.random.default_rng(seed).permutation(surface.faces)
        assert inertia.analyse(Part(Surface(surface.vertices, faces)), orientation="absolute").bodies == 3


@pytest.mark.parametrize("inside_out", [False, True])
def test_copies_of_a_body_are_called_so_however_it_is_wound(inside_out: bool) -> None:
    rng = np.random.default_rng(1)
    solids = [box(np.zeros(3), np.ones(3), rng)] * 2 + [box(np.array([1.0, 0, 0]), np.array([2.0, 1, 1]), rng)]
    for both in (solids, solids[:2]):
        part = Part(placed(wound(both, [inside_out, inside_out, False][: len(both)]), rng, single=False))
        assert ("duplicate_face", "error") in {(k.code, k.severity) for k in inertia.check(part).findings}
        with pytest.raises(inertia.GeometryError) as refusal:
            inertia.analyse(part, orientation="absolute")
        assert refusal.value.code == "duplicate_face"


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e76, 1e200])
@pytest.mark.parametrize("seed", range(3))
def test_bodies_with_edges_in_common_and_a_corner_that_is_no_usable_number_are_refused(seed: int, value: float) -> None:
    rng = np.random.default_rng(seed)
    once = block([0, 0, 0], np.eye(3)).corners()
    places = rng.integers(0, 4, (40, 3)).astype(float)
    corners = (once + np.unique(places, axis=0)[:, None, None]).reshape(-1, 3)
    corners[(corners == corners[rng.integers(len(corners))]).all(axis=1), rng.integers(3)] = value
    part = Part.from_arrays(corners, np.arange(len(corners)).reshape(-1, 3), "mm")
    for options in ({}, {"orientation": "absolute"}, {"parts": "separate"}, {"accuracy": "exact"}, {"union": True}):
        with pytest.raises(inertia.GeometryError) as refusal:
            inertia.analyse(part, **options)
        assert refusal.value.code == "non_finite"


STAIRS = {(i, j, k) for i, j, k in product(range(4), repeat=3) if k <= i}


@pytest.mark.parametrize("parts", ["together", "separate"])
@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_bodies_on_another_in_whose_box_they_lie(
    seed: int, single: bool, parts: Literal["together", "separate"]
) -> None:
    rng = np.random.default_rng(seed)
    solids = [voxels(STAIRS, rng)]
    low, high = np.array([1.2, 0.3, 2.0]), np.array([1.8, 0.8, 3.5])
    solids += [box(low + step, high + step, rng) for step in np.eye(3)[1] * [[0.0], [1.0], [2.0]]]
    analysis = inertia.analyse(Part(placed(solids, rng, single=single)), parts=parts)
    assert analysis.bodies == 4
    assert analysis.properties.volume == pytest.approx(1e-9 * sum(map(volume_of, solids)), rel=1e-5)


@pytest.mark.parametrize("large", [near_bodies.LARGE, 0])
@pytest.mark.parametrize("off", [0.0, 1e-13, -1e-13, 1e-8, -1e-8, 4e-7])
def test_a_body_on_a_wall_from_inside_shares_space(off: float, large: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(near_bodies, "LARGE", large)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        inner = box(np.array([1.2, 1.1, off]), np.array([1.9, *rng.uniform([1.5, 0.2], [3.9, 1.9])]), rng)
        surface = placed([voxels(STAIRS, rng), inner], rng, single=False)
        [doubt] = inertia.check(Part(surface), parts="separate").doubts
        assert doubt.doubt is not None
        assert doubt.doubt.volume == pytest.approx(volume_of(inner), rel=1e-5)
        with pytest.raises(inertia.GeometryError, match="inside another"):
            inertia.analyse(Part(surface))
