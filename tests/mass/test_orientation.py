"""What `orientation="absolute"` answers, and that no refusal under it asks for it, over nested and touching solids."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.step_sample import step_of_several, step_sphere
from tests.mesh.solids import Mesh, box, cube, inside_out, joined, sphere

import inertia
from inertia import Part
from inertia.errors import ABSOLUTE, GeometryError


def prism(radius: float, low: float, high: float, sides: int, turn: float) -> Mesh:
    """Return an upright prism."""
    angle = turn + 2 * np.pi * np.arange(sides) / sides
    rim = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    points = [np.column_stack([rim, np.full(sides, z)]) for z in (low, high)]
    here = np.arange(sides)
    after = (here + 1) % sides
    faces = [
        np.column_stack([after, here, np.full(sides, 2 * sides)]),
        np.column_stack([here + sides, after + sides, np.full(sides, 2 * sides + 1)]),
        np.column_stack([here, after, after + sides]),
        np.column_stack([here, after + sides, here + sides]),
    ]
    return np.vstack([*points, [[0, 0, low], [0, 0, high]]]), np.vstack(faces)


def pile(seed: int) -> Part:
    """Return prisms and boxes about one axis whose ends lie in a few common planes, some of them inside out."""
    rng = np.random.default_rng(seed)
    solids = []
    for _ in range(rng.integers(2, 5)):
        low, high = np.sort(rng.choice(4, 2, replace=False)).tolist()
        radius = float(rng.choice([1, 2, 3, 4]))
        half = radius / 2
        solid = box((-half, -half, low), (half, half, high))
        if rng.random() < 0.7:
            solid = prism(radius, low, high, int(rng.choice([4, 6, 8])), float(rng.choice([0, 0.1])))
        solids.append(inside_out(solid) if rng.random() < 0.5 else solid)
    mesh = joined(*solids)
    return Part.from_arrays(mesh.vertices, mesh.faces)


def refusal(part: Part) -> GeometryError | None:
    try:
        inertia.analyse(part, orientation="absolute")
    except GeometryError as error:
        return error
    return None


@pytest.mark.parametrize("first", range(0, 180, 30))
def test_no_refusal_under_absolute_orientation_asks_for_it(first: int) -> None:
    refusals = {seed: refusal(pile(seed)) for seed in range(first, first + 30)}
    assert [seed for seed, error in refusals.items() if error is not None and ABSOLUTE in error.remedies] == []
    assert None in refusals.values()


def test_what_no_orientation_mends_is_said() -> None:
    with pytest.raises(GeometryError, match="however its shells are turned: move the bodies apart, or use union"):
        inertia.analyse(pile(787), orientation="absolute")


@pytest.mark.parametrize(("seed", "volume"), [(14, 3.0), (533, 7.4852813742), (584, 36 * 2**0.5)])
def test_bodies_inside_out_on_others_are_turned(seed: int, volume: float) -> None:
    answer = inertia.mass_properties(pile(seed), orientation="absolute")
    assert answer.volume == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize("wall", [1e-11, 1e-13, 1e-15])
@pytest.mark.parametrize("solid", [cube, sphere])
@pytest.mark.parametrize("orientation", ["stored", "absolute"])
def test_thin_walls_have_an_answer(wall: float, solid: type, orientation: str) -> None:
    outer, inner = solid(), solid()
    part = Part.from_arrays(*vars(joined(outer, inside_out((inner[0] * (1 - wall), inner[1])))).values())
    answer = inertia.mass_properties(part, accuracy="exact", orientation=orientation)
    lost = 1e-15 / wall  # of the wall, when the coordinates are stored
    full = inertia.mass_properties(Part.from_arrays(*outer)).volume
    assert answer.volume == pytest.approx(3 * wall * full, rel=0.5 * lost + 1e-10)
    assert answer.error.volume < 1.2e-16


def test_an_inner_wall_of_nothing_has_no_volume() -> None:
    part = Part.from_arrays(*vars(joined(sphere(), inside_out(sphere()))).values())
    for orientation in ("stored", "absolute"):
        with pytest.raises(GeometryError, match="no volume"):
            inertia.analyse(part, orientation=orientation)


ROUND = 100 * np.sin(np.pi / 4)  # area of an octagon of radius 5


@pytest.mark.parametrize(
    ("solids", "volume"),
    [
        ([prism(10, 0, 5, 8, 0), inside_out(prism(5, 0, 3, 8, 0))], 5 * 4 * ROUND - 3 * ROUND),
        ([prism(10, 0, 5, 8, 0), inside_out(prism(5, 0, 5, 8, 0.1))], 5 * 4 * ROUND - 5 * ROUND),
        ([prism(10, 0, 5, 8, 0), prism(5, 5, 8, 8, 0)], 5 * 4 * ROUND + 3 * ROUND),
        ([box((0, 0, 0), (10, 4, 3)), box((0, 0, 3), (1, 1, 13))], 130),
        ([cube(size=6), inside_out(cube(size=4)), cube(size=4)], 216),
        ([prism(10, 0, 5, 8, 0), prism(5, 0, 3, 8, 0)], None),
        ([box((0, 0, 0), (10, 4, 3)), box((0, 0, 0), (1, 1, 13))], None),
        ([cube(size=2), inside_out(box((0, 0, 0), (1, 1, 2)))], None),
        ([cube(size=6), inside_out(cube(size=4)), cube(size=5)], None),
    ],
)
def test_verdict_on_solids_that_touch_does_not_depend_on_their_order(solids: list[Mesh], volume: float | None) -> None:
    mesh = joined(*solids)
    rng = np.random.default_rng(0)
    for _ in range(12):
        faces = np.array([np.roll(face, rng.integers(3)) for face in rng.permutation(mesh.faces)])
        part = Part.from_arrays(mesh.vertices, faces)
        if volume is None:
            with pytest.raises(GeometryError, match="overlapping bodies"):
                inertia.analyse(part)
        else:
            assert inertia.analyse(part).properties.volume == pytest.approx(volume, rel=1e-13)


def test_a_solid_in_another_becomes_its_cavity_by_the_triangles_of_its_true_shape(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    (tmp_path / "ball.step").write_text(step_of_several(step_sphere(9.0), step_sphere(3.0)))
    part = inertia.read(tmp_path / "ball.step")
    analysis = inertia.analyse(part, orientation="absolute")
    truth = 4 / 3 * math.pi * (0.009**3 - 0.003**3)
    assert analysis.tessellation is not None
    assert abs(analysis.properties.volume / truth - 1) <= analysis.tessellation.volume
    assert "an absolute orientation makes cavities of triangles alone" in analysis.notes[-1]
    with pytest.raises(GeometryError, match="of triangles alone: use tessellated=True for its triangles"):
        inertia.analyse(part, orientation="absolute", accuracy=1e-9)
