"""Bodies whose triangles may meet, against linear programmes, and how many pairs of bodies are looked at one by one."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation
from tests.mesh.solids import box, inside_out, joined, part, ring, sphere

from inertia import mass_properties, native
from inertia.errors import GeometryError
from inertia.mesh.check import check
from inertia.mesh.geometry import intersect
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.shells import shells, soundly_nested
from inertia.mesh.geometry.sound_shells import sound_bodies
from inertia.mesh.geometry.touching import touching_bodies
from inertia.mesh.surface import Surface

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.fixture(autouse=True)
def always_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)


def depth_of_contact(one: np.ndarray, other: np.ndarray) -> float:
    """Return how far two convex hulls are apart along the best of all directions, in the largest norm; negative inside.

    The direction n and the gap t: n·p ≤ d − t for all p of one, n·q ≥ d + t for all q of the other, |n| ≤ 1.
    """
    rows = np.concatenate([np.column_stack([one, -np.ones(len(one)), np.ones(len(one))]),
                           np.column_stack([-other, np.ones(len(other)), np.ones(len(other))])])  # fmt: skip
    bounds = [(-1, 1)] * 3 + [(None, None), (None, 1)]
    return float(-linprog([0, 0, 0, 0, -1], A_ub=rows, b_ub=np.zeros(len(rows)), bounds=bounds).fun)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("flat", [False, True])
def test_pairs_that_meet_are_those_that_no_plane_separates(seed: int, flat: bool) -> None:
    generator = np.random.default_rng(seed)
    solids = generator.normal(size=(24, 4, 3)) * [1, 1, 0.5] + 1.5 * generator.normal(size=(24, 1, 3))
    solids[:, :, 2] += 2.0 ** -generator.integers(0, 60, 24)[:, None]
    if flat:
        solids[:, :3, 2] = 0.0  # they stand on one floor
    surface = joined(*((points, TETRAHEDRON) for points in solids))
    boxes = np.stack([solids.min(axis=1), solids.max(axis=1)], axis=1)
    pairs = touching_bodies(surface, np.repeat(np.arange(24), 4), boxes)
    assert pairs is not None
    listed = set(map(tuple, pairs.tolist()))
    for i in range(24):
        for j in range(i + 1, 24):
            gap = depth_of_contact(solids[i], solids[j])
            triangles = [solids[k][TETRAHEDRON] for k in (i, j)]
            meet = gap < 1e-9 and any(depth_of_contact(a, b) < 1e-9 for a in triangles[0] for b in triangles[1])
            assert ((i, j) in listed) == meet


def rotated_cubes(count: int, distance: float) -> Surface:
    turn = Rotation.from_euler("zyx", [40, 20, 0], degrees=True).as_matrix()
    places = distance * np.stack(np.unravel_index(np.arange(count**3), (count,) * 3), axis=-1)
    points, faces = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    return joined(*((points @ turn.T + place, faces) for place in places))


def mail(rows: int) -> Surface:
    """Return rows of rings, each of which hangs in the one before."""
    points, faces = ring(24, 12, 1.0, 0.15)
    upright = points[:, [0, 2, 1]], faces[:, ::-1]
    links = (((points, faces), upright)[k % 2] for k in range(rows**2))
    return joined(*((p + np.array([1.4 * (k % rows), 2.5 * (k // rows), 0]), f) for k, (p, f) in enumerate(links)))


def pages(count: int) -> Surface:
    turn = Rotation.from_euler("xy", [45, 35], degrees=True).as_matrix()
    points, faces = box((-5.0, -5.0, 0.0), (5.0, 5.0, 0.005))
    return joined(*(((points + np.array([0, 0, 0.01 * k])) @ turn.T, faces) for k in range(count)))


def needles(count: int) -> Surface:
    turn, _ = Rotation.align_vectors([[1, 1, 1]], [[0, 0, 1]])
    points, faces = box((0.0, 0.0, -5.0), (0.01, 0.01, 5.0))
    places = 0.02 * np.stack([*np.divmod(np.arange(count), 10), np.zeros(count)], axis=-1)
    return joined(*(((points + place) @ turn.as_matrix().T, faces) for place in places))


def shifted(surface: Surface, by: float) -> Surface:
    """Return it with its first body moved along x."""
    vertices = surface.vertices.copy()
    vertices[np.unique(surface.faces[closure(surface).labels == 0])] += [by, 0, 0]
    return Surface(vertices, surface.faces)


APART = {
    "rotated cubes": (rotated_cubes(4, 1.4), 0.8),
    "rings in rings": (mail(6), -0.5),
    "book pages": (pages(60), 0.3),
    "needles": (needles(60), 0.02),
}


@pytest.mark.parametrize("name", APART)
def test_bodies_whose_boxes_meet_are_apart_as_a_whole(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    surface, into = APART[name]
    assert sound_bodies(surface, closure(surface)) == closure(surface).components
    assert sound_bodies(shifted(surface, into), closure(surface)) is None
    compared: list[int] = []
    between = intersect.overlap
    monkeypatch.setattr(intersect, "overlap", lambda a, b, *rest: compared.append(a.count) or between(a, b, *rest))
    assert check(part(surface)).fit
    assert not compared
    report = check(part(shifted(surface, into)))
    assert [finding.code for finding in report.findings if finding.severity == "error"] == ["overlapping_bodies"]
    assert 1 <= len(compared) < 20


def spheres(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return spheres inside one another, by turns a body and a cavity, the outermost last."""
    solids = (sphere(radius=1.0 + 0.2 * k, splits=2) for k in range(count))
    return [inside_out(solid) if (count - k) % 2 == 0 else solid for k, solid in enumerate(solids)]


def test_shells_inside_one_another_are_sound_where_none_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    nest = spheres(11)
    surface = joined(*nest)
    pieces = shells(surface, closure(surface))
    assert soundly_nested(surface, closure(surface), pieces)
    turned = joined(inside_out(nest[0]), *nest[1:])
    assert not soundly_nested(turned, closure(turned), shells(turned, closure(turned)))
    near = joined((nest[0][0] + [0.2, 0, 0], nest[0][1]), *nest[1:])  # it touches the cavity around it
    assert not soundly_nested(near, closure(near), shells(near, closure(near)))
    monkeypatch.setattr(intersect, "overlap", lambda *_: pytest.fail("bodies were compared one by one"))
    assert check(part(surface)).fit


@pytest.mark.parametrize("parts", ["together", "separate"])
@pytest.mark.parametrize("into", [0.0, 0.8])
def test_findings_are_those_of_pair_by_pair(parts: str, into: float, monkeypatch: pytest.MonkeyPatch) -> None:
    inner, outer = spheres(2)
    grid = shifted(rotated_cubes(2, 1.4), into)
    surface = joined((grid.vertices, grid.faces), (inner[0] + 9, inner[1]), (outer[0] + 9, outer[1]), sphere((9, 9, 9)))

    def findings() -> list[tuple[object, ...]]:
        return [(f.code, f.message, f.count, f.faces) for f in check(part(surface), parts=parts).findings]

    compiled = findings()
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    assert findings() == compiled


def test_bodies_that_share_space_are_compared_once_for_a_refusal(monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[int] = []
    between = intersect.overlap
    monkeypatch.setattr(intersect, "overlap", lambda a, b, *rest: compared.append(a.count) or between(a, b, *rest))
    with pytest.raises(GeometryError, match="26 pairs of bodies share space"):
        mass_properties(part(rotated_cubes(2, 0.7)))
    assert len(compared) == 1  # for the place that is named; of the others one look shows that they share space
