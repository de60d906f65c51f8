"""Bodies integrated each by itself: pins in bores and balls that touch as exact solids, and bodies that share space."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mesh.readers.step_sample import step_of_several, step_sphere, step_torus
from tests.mesh.solids import Mesh, cube, inside_out, joined, sphere

import inertia
from inertia import Part
from inertia.errors import SEPARATE, GeometryError, UsageError

RADIUS, BORE, HEIGHT = 20.0, 10.0, 5.0


def circle(sides: int, radius: float, turn: float = 0.0) -> np.ndarray:
    angle = turn + 2 * np.pi * np.arange(sides) / sides
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def washer(sides: int) -> Mesh:
    """Return a disc with a bore."""
    rims = circle(sides, BORE), circle(sides, RADIUS)
    points = [np.column_stack([rim, np.full(sides, z)]) for rim in rims for z in (0, HEIGHT)]
    corners = np.arange(4)[:, None] * sides + np.arange(sides)
    (a, b, c, d), (e, f, g, h) = corners, np.roll(corners, -1, axis=1)
    faces = [(a, f, e), (a, b, f), (c, g, h), (c, h, d), (b, h, f), (b, d, h), (a, e, g), (a, g, c)]
    return np.vstack(points), np.vstack([np.column_stack(face) for face in faces])


def pin(sides: int, turn: float) -> Mesh:
    """Return the cylinder that fills the bore."""
    rim = circle(sides, BORE, turn)
    points = [np.column_stack([rim, np.full(sides, z)]) for z in (0, HEIGHT)]
    here = np.arange(sides)
    after, middle = (here + 1) % sides, np.full(sides, 2 * sides)
    faces = [
        (after, here, middle), (here + sides, after + sides, middle + 1),
        (here, after, after + sides), (here, after + sides, here + sides),
    ]  # fmt: skip
    return np.vstack([*points, [[0, 0, 0], [0, 0, HEIGHT]]]), np.vstack([np.column_stack(face) for face in faces])


def fitted(sides: int, turn: float, chord: float | None, seed: int | None = None) -> Part:
    mesh = joined(washer(sides), pin(sides, turn))
    vertices, faces = mesh.vertices, mesh.faces
    if seed is not None:
        rng = np.random.default_rng(seed)
        faces = np.array([np.roll(face, rng.integers(3)) for face in rng.permutation(faces)])
        vertices = vertices @ Rotation.random(rng=rng).as_matrix().T
    part = Part.from_arrays(vertices, faces, unit="mm")
    return part if chord is None else replace(part, chord=np.full(len(faces), chord))


def sag(sides: int) -> float:
    return RADIUS * (1 - np.cos(np.pi / sides))


@pytest.mark.parametrize("sides", [16, 32, 90])
@pytest.mark.parametrize("turn", [0.03, 0.5])  # of the pin, in steps of its facets
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_a_pin_in_its_bore_has_the_sum_of_both(sides: int, turn: float, seed: int | None) -> None:
    part = fitted(sides, turn * 2 * np.pi / sides, sag(sides), seed)
    with pytest.raises(GeometryError, match="overlapping bodies: 1 pair") as refusal:
        inertia.analyse(part)
    assert SEPARATE in refusal.value.remedies
    analysis = inertia.analyse(part, 1e9, parts="separate")
    answer, chord = analysis.properties, analysis.tessellation
    volume = np.pi * RADIUS**2 * HEIGHT * 1e-9
    assert abs(answer.volume - volume) <= (answer.error.volume + chord.volume) * answer.volume
    moments = np.sort(answer.principal.moments)
    exact = np.sort([*[volume * 1e9 * (3 * RADIUS**2 + HEIGHT**2) / 12e6] * 2, volume * 1e9 * RADIUS**2 / 2e6])
    assert np.linalg.norm(moments - exact) <= (answer.error.inertia + chord.inertia) * np.linalg.norm(moments)
    # The sum of the meshes is what it is, and what they share is in its bound.
    area = sides * np.sin(2 * np.pi / sides) / 2
    assert answer.volume == pytest.approx(area * RADIUS**2 * HEIGHT * 1e-9, rel=1e-13)
    (shared,) = analysis.doubts
    assert shared.code == "shared_space"
    assert answer.error.volume == pytest.approx(shared.doubt.volume * 1e-9 / answer.volume, rel=1e-6)
    assert 0 < answer.error.volume < chord.volume


def test_the_option_is_named_where_the_chord_tolerance_explains_it() -> None:
    part = fitted(32, 0.1, None)
    for chord, named in ((None, False), (1e-4, False), (sag(32), True)):
        with pytest.raises(GeometryError, match="overlapping bodies") as refusal:
            inertia.analyse(part, chord=chord)
        assert (SEPARATE in refusal.value.remedies) == named


def test_a_ball_in_a_ring_of_step_has_the_sum_of_both(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    (tmp_path / "bearing.step").write_text(step_of_several(step_sphere(9.0), step_torus(20.0, 11.0)))
    part = inertia.read(tmp_path / "bearing.step", coarser=3.0)
    with pytest.raises(GeometryError, match="overlapping bodies: 1 pair") as refusal:
        inertia.analyse(part, tessellated=True)
    assert SEPARATE in refusal.value.remedies
    analysis = inertia.analyse(part, parts="separate", tessellated=True)
    answer = analysis.properties
    volume = (4 / 3 * np.pi * 9**3 + 2 * np.pi**2 * 20 * 11**2) * 1e-9
    true = inertia.analyse(part, accuracy=1e-12)
    assert true.properties.volume == pytest.approx(volume, rel=1e-13)
    assert true.bodies == 2
    assert any("no deeper than the chord" in note for note in true.notes)
    assert abs(answer.volume - volume) <= (answer.error.volume + analysis.tessellation.volume) * answer.volume
    assert 0 < answer.error.volume < 1e-6


def test_facets_that_meet_are_not_in_doubt() -> None:
    assert inertia.analyse(fitted(32, 0.0, None), parts="separate").doubts == ()
    assert inertia.analyse(fitted(32, 0.0, None)).doubts == ()


def test_balls_that_touch_have_the_sum_of_all() -> None:
    ring = [sphere((2 * np.cos(t), 2 * np.sin(t), 0), 1.0, 3) for t in np.arange(6) * np.pi / 3]
    mesh = joined(sphere(), *ring)
    analysis = inertia.analyse(Part.from_arrays(mesh.vertices, mesh.faces), parts="separate")
    single = inertia.mass_properties(Part.from_arrays(*sphere()))
    assert analysis.bodies == 7
    assert abs(analysis.properties.volume - 7 * single.volume) <= analysis.properties.error.volume * 7 * single.volume
    assert analysis.properties.error.volume < 1e-12


@pytest.mark.parametrize(
    ("solids", "volume", "shared"),
    [
        ([cube(), cube((0.5, 0.5, 0.5))], 2.0, 0.125),
        ([cube(size=6), cube(size=4)], 280.0, 64.0),
        ([cube(size=6), cube(size=4), inside_out(cube(size=2))], 272.0, 56.0),
        ([cube(size=6), inside_out(cube(size=4)), cube(size=5)], 277.0, 61.0),
        ([cube(size=6), inside_out(cube(size=4)), cube(size=3)], 179.0, None),
    ],
)
def test_what_bodies_share_is_in_the_bounds(solids: list[Mesh], volume: float, shared: float | None) -> None:
    mesh = joined(*solids)
    rng = np.random.default_rng(0)
    for _ in range(3):
        part = Part.from_arrays(mesh.vertices, rng.permutation(mesh.faces))
        analysis = inertia.analyse(part, parts="separate")
        assert analysis.properties.volume == pytest.approx(volume, rel=1e-12)
        assert bool(analysis.doubts) == (shared is not None)
        assert analysis.properties.error.volume == pytest.approx((shared or 0) / volume, abs=1e-9)
        assert inertia.check(part, parts="separate").fit
        assert inertia.check(part).fit == (shared is None)


def test_what_is_wrong_with_a_body_itself_stays_wrong() -> None:
    mesh = joined(cube(), inside_out(cube((3, 0, 0))))
    with pytest.raises(GeometryError, match="inside out"):
        inertia.analyse(Part.from_arrays(mesh.vertices, mesh.faces), parts="separate")
    with pytest.raises(UsageError, match="both separate bodies and their union"):
        inertia.analyse(Part.from_arrays(*cube()), parts="separate", union=True)
    with pytest.raises(UsageError, match="parts is 'apart'"):
        inertia.analyse(Part.from_arrays(*cube()), parts="apart")
