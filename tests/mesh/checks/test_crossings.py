"""Shells that cross themselves: found, measured and refused, however they are stored; their neighbours are answered."""

import numpy as np
import pytest
from tests.mesh.self_crossing import CROSSING, SOUND, Mesh, hairpin, pentagram, ring
from tests.mesh.solids import cube, joined, part
from tests.mesh.solids import ring as torus

import inertia
from inertia.mesh.check import check
from inertia.mesh.checks import crossings as module
from inertia.mesh.geometry import intersect
from inertia.mesh.geometry.intersect import EXAMINED, to_be_examined
from inertia.mesh.geometry.winding import misplaced_volume
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface

PENTAGON = 2.5 * np.sin(2 * np.pi / 5) / ((1 + 5**0.5) / 2) ** 4
"""Area of the pentagon in the middle of a pentagram of radius 1, which its outline goes around twice."""


def shuffled(mesh: Mesh, seed: int) -> Part:
    """Return a part turned, moved and scaled somehow, its triangles and their corners in another order."""
    rng = np.random.default_rng(seed)
    vertices, faces = mesh
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    faces = rng.permutation(faces)
    faces = np.take_along_axis(faces, (rng.integers(0, 3, (len(faces), 1)) + np.arange(3)) % 3, axis=1)
    order = rng.permutation(len(vertices))
    offset = rng.normal(size=3) * 10.0 ** rng.uniform(-3, 3)
    scale = 10.0 ** rng.uniform(-30, 20)
    return Part.from_arrays(scale * (vertices @ turn + offset)[order], np.argsort(order)[faces])


def as_stored(mesh: Mesh) -> Part:
    return Part.from_arrays(*mesh, unit="mm")


@pytest.mark.parametrize("name", CROSSING)
def test_a_shell_that_crosses_itself_is_refused_with_place_and_volume(name: str) -> None:
    with pytest.raises(inertia.GeometryError, match=r"self-intersection: \d+ pairs .* around .* about .* mm³") as error:
        inertia.mass_properties(as_stored(CROSSING[name]))
    assert error.value.exit_code == 4


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", CROSSING)
def test_it_is_refused_in_any_order_position_and_size(name: str, seed: int) -> None:
    with pytest.raises(inertia.GeometryError, match="self-intersection"):
        inertia.analyse(shuffled(CROSSING[name], seed))
    assert not inertia.analyse(shuffled(CROSSING[name], seed), intersections=False).crossings_examined


@pytest.mark.parametrize("name", SOUND)
def test_its_sound_neighbour_is_answered_with_the_same_bits(name: str) -> None:
    part = as_stored(SOUND[name])
    looked, unlooked = inertia.analyse(part), inertia.analyse(part, intersections=False)
    assert (looked.crossings_examined, unlooked.crossings_examined) == (True, False)
    assert looked.properties.volume == unlooked.properties.volume
    assert looked.properties.inertia.tobytes() == unlooked.properties.inertia.tobytes()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", [name for name in SOUND if "touch" not in name and "1e-12" not in name])
def test_its_sound_neighbour_is_answered_in_any_order_position_and_size(name: str, seed: int) -> None:
    assert inertia.analyse(shuffled(SOUND[name], seed)).crossings_examined


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (hairpin(6.0), 2 * (10 + 8 + 5 + 13)),
        (hairpin(0.5), 2 * (10 + 8 + 5 + 7.5)),
        (ring(6.6), 17 * 20 * np.sin(6.6 / 17)),
        (pentagram(), 2.5 * np.sin(4 * np.pi / 5)),
    ],
)
def test_the_shapes_have_the_volumes_that_they_are_meant_to_have(mesh: Mesh, volume: float) -> None:
    stored = inertia.mass_properties(Part.from_arrays(*mesh), intersections=False).volume
    assert stored == pytest.approx(volume, rel=1e-13)


@pytest.mark.parametrize(
    ("mesh", "twice"),
    [(hairpin(6.0), 2.0), (hairpin(1.0), 1.0), (ring(6.6), 17 * 20 * np.sin(6.6 / 17) * (1 - 2 * np.pi / 6.6)),
     (pentagram(), PENTAGON)],
)  # fmt: skip
def test_the_volume_in_doubt_is_what_counts_twice(mesh: Mesh, twice: float) -> None:
    corners = mesh[0][mesh[1]]
    box = np.stack([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))])
    assert misplaced_volume(corners, box) == pytest.approx(twice, rel=0.05)


def test_up_to_200_000_triangles_are_looked_through_unasked() -> None:
    few, many = (Surface(np.eye(3), np.tile([0, 1, 2], (count, 1))) for count in (EXAMINED, EXAMINED + 1))
    assert [to_be_examined(few, asked) for asked in (None, True, False)] == [True, True, False]
    assert [to_be_examined(many, asked) for asked in (None, True, False)] == [False, True, False]


def test_a_shell_and_cells_are_not_looked_through() -> None:
    assert not inertia.analyse(as_stored(CROSSING["pentagram"]), shell=1.0).crossings_examined


def test_many_pairs_that_share_space_are_looked_at_together(monkeypatch: pytest.MonkeyPatch) -> None:
    lattice = joined(*(cube((x, y, z)) for x in (0, 0.75, 1.5) for y in (0, 0.75, 1.5) for z in (0, 0.75, 1.5)))
    compared: list[int] = []
    between = intersect.overlap
    monkeypatch.setattr(intersect, "overlap", lambda a, b, *rest: compared.append(a.count) or between(a, b, *rest))
    [finding] = [finding for finding in check(part(lattice)).findings if finding.code == "overlapping_bodies"]
    # Of three cubes in a row, each two next to one another share space, in all directions: 7² (2·7 − 1) less 27 / 2.
    assert finding.count == (7**3 - 27) // 2
    assert len(compared) == 1


def test_pairs_that_share_space_are_counted_up_to_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    lattice = joined(*(cube((x, y, z)) for x in (0, 0.75, 1.5) for y in (0, 0.75, 1.5) for z in (0, 0.75, 1.5)))
    monkeypatch.setattr(module, "SHARING", 100)
    monkeypatch.setattr(module, "TOGETHER", 500)
    [finding] = [finding for finding in check(part(lattice)).findings if finding.code == "overlapping_bodies"]
    assert 100 <= finding.count < (7**3 - 27) // 2
    assert f"at least {finding.count} pairs of bodies share space" in finding.message


@pytest.mark.parametrize(("gap", "shared"), [(-1e-3, 1), (-1e-7, 0), (0.0, 0), (1e-7, 0)])
def test_bodies_in_contact_are_compared_one_by_one(gap: float, shared: int) -> None:
    a, b = cube((0, 0, 0)), cube((1.0 + gap, 0.3, 0.2))
    far = [cube((9.0, 0, 0)), cube((9.5, 0.3, 0.2))]
    both = joined(*far, a, b)
    [finding] = [finding for finding in check(part(both)).findings if finding.code == "overlapping_bodies"]
    assert finding.count == 1 + shared


def boundary_of(filled: np.ndarray) -> Part:
    """Return the surface of voxels of a millimetre, two triangles a side; bodies touch at edges and corners."""
    padded, triangles = np.pad(filled, 1), []
    for axis in range(3):
        u, v = np.eye(3)[[(axis + 1) % 3, (axis + 2) % 3]]
        for way in (0, 1):
            beside = np.roll(padded, 1 - 2 * way, axis)
            low = np.argwhere(padded & ~beside) + way * np.eye(3)[axis]
            sides = np.stack([low, low + u, low + u + v, low, low + u + v, low + v], axis=1).reshape(-1, 3, 3)
            triangles.append(sides if way else sides[:, ::-1])
    corners = np.concatenate(triangles)
    return Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), unit="mm")


@pytest.mark.parametrize("seed", range(6))
def test_voxels_that_touch_at_edges_are_the_bodies_that_share_sides(seed: int) -> None:
    from scipy.ndimage import label

    filled = np.random.default_rng(seed).random((6, 5, 4)) < 0.4
    answer = inertia.analyse(boundary_of(filled))
    assert answer.bodies == label(filled)[1]
    assert answer.properties.volume == pytest.approx(1e-9 * filled.sum(), rel=1e-14)


def test_a_torus_that_meets_itself_on_its_axis_is_refused_by_that() -> None:
    """Rays along the axis meet triangles on edge, whose rounded corners have no height there."""
    spindle = Part.from_arrays(*torus(40, 30, radius=1.0, tube=2.0))
    with pytest.raises(inertia.GeometryError, match=r"self-intersection: .* twice: too little for rays to meet it"):
        inertia.analyse(spindle)
