"""Shells that are soundly nested are shown to be, and nothing else is: against how they were put together."""

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mesh.solids import Mesh, box, cube, facets, inside_out, joined, ring, sphere

import inertia
from inertia import native
from inertia.mesh.geometry import sound_shells, touching
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.shells import bodies, shells, soundly_nested
from inertia.mesh.geometry.sound_shells import nesting_of, sound_bodies
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface, Triangles


@pytest.fixture(autouse=True)
def _any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)


def counted(triangles: Triangles) -> int | None:
    return sound_bodies(triangles, closure(triangles))


def turned(mesh: Mesh, seed: int) -> Mesh:
    vertices, faces = mesh
    return Rotation.random(random_state=seed).apply(vertices), faces


def pores(radius: float) -> list[Mesh]:
    return [inside_out(sphere((x, y, z), radius, splits=1)) for x, y, z in product(range(3), repeat=3)]


def matryoshka(count: int, ratio: float) -> list[Mesh]:
    """Return bodies and cavities in turn, one within another."""
    solids = [turned(sphere(radius=ratio**k, splits=1), k) for k in range(count)]
    return [solid if k % 2 == 0 else inside_out(solid) for k, solid in enumerate(solids)]


def links(step: float) -> list[Mesh]:
    """Return rings of a chain, each upright in the next where they are not too far apart."""
    vertices, faces = ring(16, 8, 1.0, 0.25)
    upright = vertices[:, [0, 2, 1]], faces[:, ::-1]
    chain = [((vertices, faces), upright)[k % 2] for k in range(6)]
    return [(np.add(own, [step * k, 0, 0]), around) for k, (own, around) in enumerate(chain)]


BLOCK = box((-0.6, -0.6, -0.6), (2.6, 2.6, 2.6))
BOWTIE = (
    np.array([[x, y, z] for z in (-3.0, 3.0) for x, y in ((-3, -3), (3, 3), (3, -3), (-3, 3))]),
    np.array([[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]] + [
        face for i in range(4) for face in ([i, (i + 1) % 4, (i + 1) % 4 + 4], [i, (i + 1) % 4 + 4, i + 4])
    ]),
)  # fmt: skip

SOUND: dict[str, tuple[list[Mesh], int]] = {
    "pores in a block": ([BLOCK, *pores(0.45)], 1),
    "a body in each pore": ([BLOCK, *pores(0.45), *(inside_out(pore) for pore in pores(0.3))], 28),
    "the block last": ([*pores(0.45), BLOCK], 1),
    "one within another": (matryoshka(9, 0.7), 5),
    "hollow bodies": (
        [mesh for x in range(5) for mesh in (cube((2 * x, 0, 0), 1.5), inside_out(cube((2 * x, 0, 0))))],
        5,
    ),
    "boxes that agree along one axis": (
        [cube(size=4), inside_out(cube(size=2)), inside_out(cube((1.5, 0, 0), 0.9))],
        1,
    ),
    "a body in the hole of a ring": ([ring(), sphere(radius=1.5)], 2),
    "a cavity in a ring": ([ring(), inside_out(ring(tube=0.5))], 1),
    "links of a chain": (links(1.3), 6),
    "balls whose boxes meet at a corner, where neither is": ([sphere(), sphere((1.8, 1.8, 1.8))], 2),
    "pores whose boxes meet at a corner": (
        [box((-2, -2, -2), (4, 4, 4)), inside_out(sphere()), inside_out(sphere((1.8, 1.8, 1.8)))],
        1,
    ),
    "links of a chain as cavities": ([box((-2, -2, -2), (9, 2, 2)), *map(inside_out, links(1.3))], 1),
    "far from the origin": ([(v + 1e5, f) for v, f in matryoshka(5, 0.7)], 3),
}

UNSOUND: dict[str, list[Mesh]] = {
    "pores that break through": [BLOCK, *pores(0.45), inside_out(sphere((2.5, 2.5, 2.5), 0.3))],
    "links of a chain that cross": links(1.7),
    "a last link of a chain that crosses its neighbour": [*links(1.3)[:5], *links(1.38)[5:]],
    "pores that meet": [BLOCK, *pores(0.51)],
    "a pore in a corner": [BLOCK, *pores(0.3), inside_out(box((2.5, 2.5, 2.5), (2.6, 2.6, 2.6)))],
    "a pore that is no cavity": [BLOCK, *pores(0.45)[1:], inside_out(pores(0.45)[0])],
    "a pore in a pore": [BLOCK, *pores(0.45), *pores(0.2)[3:4]],
    "all inside out": [inside_out(mesh) for mesh in matryoshka(4, 0.7)],
    "the same twice": [cube(), cube()],
    "a body and its own cavity": [cube(), inside_out(cube())],
    "a cavity beside its body": [cube(), inside_out(cube((3, 0, 0)))],
    "shells that cross, one within another": [*matryoshka(4, 0.7), inside_out(sphere(radius=0.8))],
    "in the half of a bow tie that is inside out": [BOWTIE, inside_out(cube((0, -2.0, 0), 0.5))],
}


@pytest.mark.parametrize("store", [facets, lambda surface: surface], ids=["facets", "surface"])
@pytest.mark.parametrize("name", SOUND)
def test_sound_shells_are_counted_as_bodies(name: str, store: Callable[[Surface], Triangles]) -> None:
    meshes, count = SOUND[name]
    assert counted(store(joined(*meshes))) == count


@pytest.mark.parametrize("name", UNSOUND)
def test_what_is_unsound_is_not_counted(name: str) -> None:
    assert counted(joined(*UNSOUND[name])) is None


@pytest.mark.parametrize("name", SOUND)
def test_the_order_of_triangles_does_not_matter(name: str) -> None:
    meshes, count = SOUND[name]
    surface = joined(*meshes)
    faces = np.random.default_rng(1).permutation(surface.faces)
    assert counted(Surface(surface.vertices, faces)) == count


@pytest.mark.parametrize("seed", range(40))
def test_random_shells_are_sound_where_they_are_nested_one_by_one(seed: int) -> None:
    random = np.random.default_rng(seed)
    meshes = []
    for _ in range(random.integers(2, 9)):
        vertices, faces = turned([cube(), sphere(splits=1), ring(12, 6, 1, 0.2)][random.integers(3)], seed)
        own = vertices * random.choice([0.2, 0.5, 1.0, 2.5]) + random.integers(-1, 2, 3) * 1.3
        meshes.append((own, faces if random.random() < 0.6 else faces[:, ::-1]))
    surface = joined(*meshes)
    pieces = closure(surface)
    nested = shells(surface, pieces)
    if pieces.components > 1:
        sound = not pieces.crowded and soundly_nested(surface, pieces, nested)
        assert pieces.crowded or counted(surface) == (len(bodies(nested)) if sound else None)


def in_a_ball(*inner: Mesh, mixed: int | None) -> Surface:
    """Return a ball of 20,480 triangles, and what is in it, these in the order in which they are or any other."""
    surface = joined(sphere(radius=2.0, splits=5), *inner)
    if mixed is None:
        return surface
    return Surface(surface.vertices, np.random.default_rng(mixed).permutation(surface.faces))


LARGE = {
    "a ball in the hole of a ring, beside": [
        (np.add(vertices, [10, 0, 0]), faces)
        for vertices, faces in (ring(96, 48, 3.0, 1.0), sphere(radius=0.9, splits=5))
    ],
    "a thick wall": [inside_out(sphere(radius=1.2, splits=5))],
    "a thin wall": [inside_out(sphere(radius=1.95, splits=5))],
    "a cavity beside the middle, and pores": [
        inside_out(sphere((0.5, 0.4, 0.3), radius=1.0, splits=5)),
        *(inside_out(sphere((-1.2, 0.25 * k, 0.1 * k), radius=0.1, splits=1)) for k in range(-3, 4)),
    ],
    "a ball in a cavity": [inside_out(sphere(radius=1.5, splits=5)), sphere((0.3, 0, 0), radius=1.0, splits=5)],
}


BODIES = {"a ball in the hole of a ring, beside": 3, "a ball in a cavity": 2}


@pytest.mark.parametrize("mixed", [None, 0])
@pytest.mark.parametrize("store", [facets, lambda surface: surface], ids=["facets", "surface"])
@pytest.mark.parametrize("name", LARGE)
def test_large_shells_are_nested_as_small_ones_are(
    name: str, store: Callable[[Surface], Triangles], mixed: int | None
) -> None:
    assert counted(store(in_a_ball(*LARGE[name], mixed=mixed))) == BODIES.get(name, 1)


@pytest.mark.parametrize("mixed", [None, 0])
@pytest.mark.parametrize(
    "spike",
    [
        inside_out(sphere((0.5, 0, 0), radius=1.52, splits=5)),  # through the wall at one place
        inside_out(sphere((-1.9, 0, 0), radius=0.12, splits=1)),
        inside_out(sphere((0.8, 0.8, 1.6), radius=0.05, splits=0)),
    ],
)
def test_one_place_at_which_a_large_shell_is_broken_through_is_not_missed(spike: Mesh, mixed: int | None) -> None:
    sound = [inside_out(sphere((0.2, 0, -0.2), radius=0.9, splits=5))] if len(spike[1]) < 1000 else []
    assert counted(in_a_ball(*sound, spike, mixed=mixed)) is None


def onion(count: int, place: float) -> list[Mesh]:
    """Return shells nearer to each other than their triangles bulge, every second one the wall of a void."""
    vertices, faces = sphere(splits=2)
    meshes = [turned((0.97**k * vertices, faces), 1) for k in range(count)]
    return [(corners + place, faces if k % 2 == 0 else faces[:, ::-1]) for k, (corners, faces) in enumerate(meshes)]


@pytest.mark.parametrize("place", [0.0, 1e4])
@pytest.mark.parametrize("mixed", [None, 0])
def test_the_planes_of_triangles_hold_shells_apart_that_lie_within_them(
    mixed: int | None, place: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sound_shells, "touching_groups", lambda *_, **__: None)
    surface = joined(*onion(9, place))
    if mixed is not None:
        surface = Surface(surface.vertices, np.random.default_rng(mixed).permutation(surface.faces))
    assert counted(surface) == 5


@pytest.mark.parametrize("depth", [0.1, 1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("k", [0, 3, 7])
def test_a_shell_that_one_point_of_the_next_breaks_through_is_not_apart(k: int, depth: float) -> None:
    meshes = onion(9, 0.0)
    (outer, faces), (inner, _) = meshes[k], meshes[k + 1]
    face = faces[7]
    inner[face[0]] = (1.0 + depth) * (outer[face] * [[0.5], [0.25], [0.25]]).sum(axis=0)
    surface = joined(*meshes)
    nesting = nesting_of(surface, closure(surface))
    assert nesting is not None
    assert {k, k + 1} <= set(nesting.suspects.tolist()) <= {k, k + 1, k + 2}


def test_shells_that_cross_themselves_are_still_looked_for_one_by_one() -> None:
    vertices, faces = sphere(splits=2)
    vertices = vertices.copy()
    vertices[np.argmax(vertices[:, 2])] *= -1.2  # through the other side
    dented = joined(cube(size=8), inside_out((vertices, faces)))
    assert counted(dented) == 1
    with pytest.raises(inertia.GeometryError, match="cross"):
        inertia.analyse(Part.from_arrays(dented.vertices, dented.faces, "mm"), density=1000.0)


def packing(mesh: Mesh, step: float, seed: int, side: int = 4) -> list[Mesh]:
    """Return copies in a lattice of closest packing, turned as one, so that the boxes of neighbours meet."""
    cells = np.array(list(product(range(side), repeat=3)))
    places = (cells[:, None] + np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])).reshape(-1, 3)
    return [turned((mesh[0] + step * np.sqrt(2) * place, mesh[1]), seed) for place in places]


def bars(gap: float, seed: int) -> list[Mesh]:
    """Return long bars side by side, some way along each other, turned as one."""
    shifts = np.random.default_rng(seed).uniform(-2, 2, 64)
    cells = product(range(8), repeat=2)
    return [
        turned(box((x * (1 + gap), y * (1 + gap), shift), (x * (1 + gap) + 1, y * (1 + gap) + 1, shift + 40)), seed)
        for (x, y), shift in zip(cells, shifts, strict=True)
    ]


PARTED: dict[str, list[Mesh]] = {
    "balls": packing(sphere(splits=2), 2.00003, 0),
    "cubes": packing(cube((-0.5, -0.5, -0.5)), 1.5, 1),
    "bars": bars(1e-4, 2),
    "links of a chain": links(1.3),
    "small balls beside a large one": [
        sphere(splits=4),
        *(
            sphere(tuple(Rotation.from_rotvec([0, 2.4 * k, 0]).apply([0, k / 25 - 1.2, 1.08])), 0.05, 1)
            for k in range(60)
        ),
    ],
}


@pytest.mark.parametrize("name", PARTED)
def test_between_most_shells_whose_boxes_meet_a_plane_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[int] = []
    monkeypatch.setattr(sound_shells, "touching_groups", lambda own, *_, **__: compared.append(own.count))
    meshes = PARTED[name]
    bodies = counted(joined(*meshes))
    assert compared or bodies == len(meshes)
    assert sum(compared) <= 0.02 * sum(len(faces) for _, faces in meshes)


@pytest.mark.parametrize("depth", [0.1, 1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("seed", range(4))
def test_bodies_that_share_space_are_never_parted(depth: float, seed: int) -> None:
    meshes = bars(1e-3, seed) + packing(sphere((60, 0, 0), splits=2), 2.01, seed, 2)
    for k, (x, y, z) in (
        (9, (0, 1, 0)),
        (70, (-1, 1, 0)),
    ):  # the next lies that way, as they are before they are turned
        vertices, faces = meshes[k]
        way = Rotation.random(random_state=seed).apply([x, y, z]) / np.sqrt(x * x + y * y)
        gap = (meshes[k + 1][0] @ way).min() - (vertices @ way).max()
        meshes[k] = vertices + (gap + depth) * way, faces
    surface = joined(*meshes)
    nesting = nesting_of(surface, closure(surface))
    assert nesting is not None
    assert {9, 10, 70, 71} <= set(nesting.suspects.tolist())
    assert len(nesting.suspects) < 12


def test_a_shell_that_is_looked_at_too_often_is_compared_as_a_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sound_shells, "LOOKS", 2)
    monkeypatch.setattr(sound_shells, "ANYWAY", 0)
    assert counted(joined(*PARTED["balls"])) == len(PARTED["balls"])
    crossing = [*PARTED["balls"][:-1], sphere((0.1, 0, 0), splits=2)]
    surface = joined(*crossing)
    nesting = nesting_of(surface, closure(surface))
    assert nesting is None or len(nesting.suspects)


def test_what_meets_at_a_face_of_boxes_shares_no_space() -> None:
    assert counted(joined(cube(), cube((1, 0.25, 0.25)), cube((-0.4, 0.25, 1)))) == 3
    assert counted(joined(cube(), cube((1 - 1e-12, 0.25, 0.25)))) is None


def test_which_shells_may_meet_is_known_beside_those_that_do_not() -> None:
    meshes = [BLOCK, *pores(0.45), *(inside_out(pore) for pore in pores(0.3)), *PARTED["links of a chain"]]
    meshes[-6:] = [(np.add(vertices, [10, 0, 0]), faces) for vertices, faces in meshes[-6:]]
    touching = [*meshes, sphere((0, 0, 10), 0.5), cube((0, 0, 10.9), 1.0)]
    surface = joined(*touching)
    nesting = nesting_of(surface, closure(surface))
    assert nesting is not None
    assert nesting.suspects.tolist() == [len(touching) - 2, len(touching) - 1]
    assert nesting.bodies == 1 + 27 + 6 + 2


def test_where_more_shells_may_meet_than_are_listed_it_is_not_said_which(monkeypatch: pytest.MonkeyPatch) -> None:
    meshes = [turned(mesh, 3) for x in range(12) for mesh in (cube((3.0 * x, 0, 0)), cube((3.0 * x, 0.2, 0.999)))]
    surface = joined(*meshes)
    pieces = closure(surface)
    nesting = nesting_of(surface, pieces)
    assert nesting is not None
    assert len(nesting.suspects) == 24
    monkeypatch.setattr(touching, "PAIRS", 8)
    assert nesting_of(surface, pieces) is None
