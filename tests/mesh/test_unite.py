"""Unions against rational arithmetic: prisms by a sweep, tetrahedra by clipping; any order of the triangles."""

from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mass.test_order import BAD, shuffled
from tests.mass.test_order import SOUND as FITTING
from tests.mesh import prisms, solids
from tests.mesh.self_crossing import CROSSING, SOUND, hairpin, ring

import inertia
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface

Corners = list[tuple[Fraction, Fraction, Fraction]]


def require_within_bounds(part: Part, exact: dict[str, Fraction], accuracy: str | None) -> None:
    """Compare the union's volume, centre of mass and tensor with moments in the unit of the part."""
    result = inertia.mass_properties(part, 1.0, union=True, accuracy=accuracy)
    f = part.unit.metres
    volume = exact["1"] * f**3
    assert abs(Fraction(result.volume) - volume) <= Fraction(result.error.volume) * volume
    centre = [exact[k] / exact["1"] for k in "xyz"]
    off = [Fraction(a) - b * f for a, b in zip(result.center_of_mass.tolist(), centre, strict=True)]
    assert sum(k * k for k in off) <= Fraction(result.error.center_of_mass) ** 2
    x, y, z = centre
    v = exact["1"]
    xx, yy, zz = exact["xx"] - v * x * x, exact["yy"] - v * y * y, exact["zz"] - v * z * z
    yz, zx, xy = exact["yz"] - v * y * z, exact["zx"] - v * z * x, exact["xy"] - v * x * y
    tensor = [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]
    apart = size = Fraction(0)
    for row, other in zip(result.inertia.tolist(), tensor, strict=True):
        for a, b in zip(row, other, strict=True):
            apart, size = apart + (Fraction(a) - b * f**5) ** 2, size + (b * f**5) ** 2
    assert apart <= Fraction(result.error.inertia) ** 2 * size
    assert result.error.volume < (1.2e-16 if accuracy else 1e-9)


def star(points: int, step: int) -> list[tuple[float, float]]:
    angle = 2 * np.pi * step * np.arange(points) / points
    return [(float(x), float(y)) for x, y in zip(np.cos(angle), np.sin(angle), strict=True)]


def rectangle(x: float, y: float, u: float, v: float) -> list[tuple[float, float]]:
    return [(x, y), (u, y), (u, v), (x, v)]


SHAPES: dict[str, list[prisms.Prism]] = {
    "bars with faces in common planes": [(rectangle(0, 0, 4, 1), 0, 1), (rectangle(1, -1, 2, 3), 0, 1)],
    "a bar on a plate, partly beside it": [(rectangle(0, 0, 4, 4), 0, 1), (rectangle(3, 1, 6, 2), 1, 2)],
    "an insert": [(rectangle(0, 0, 4, 4), 0, 4), (rectangle(1, 1, 2, 2), 1, 2)],
    "a cube in a cube, three faces in common": [(rectangle(0, 0, 4, 4), 0, 4), (rectangle(0, 0, 2, 2), 0, 2)],
    "pentagram": [(star(5, 2), 0, 1)],
    "star {11/4}, and another half inside": [(star(11, 4), 0, 1), (star(7, 3), 0.5, 2)],
    "bow tie, of which one half counts negative": [([(0, 0), (2, 2), (2, 0), (0, 2.5)], 0, 1)],
    "a cutter that sticks out": [(rectangle(0, 0, 2, 2), 0, 2), (rectangle(1, 0.5, 3, 1.5)[::-1], 0.5, 1.5)],
    "a cutter that sticks out, and a body that fills it": [
        (rectangle(0, 0, 2, 2), 0, 2),
        (rectangle(1, 0.5, 3, 1.5)[::-1], 0.5, 1.5),
        (rectangle(1, 0.5, 3, 1.5), 0.5, 1.5),
    ],
    "squares turned about a common corner": [
        (rectangle(0, 0, 1, 1), 0, 1),
        ([(0, 0), (0.75**0.5, 0.5), (0.75**0.5 - 0.5, 0.5 + 0.75**0.5), (-0.5, 0.75**0.5)], 0, 1),
    ],
    "the same twice": [(star(5, 1), 0, 1), (star(5, 1), 0, 1)],
    "three with an edge in common": [(star(k, 1), 0, k) for k in (3, 4, 6)],
}


@pytest.mark.parametrize("accuracy", [None, "exact"])
@pytest.mark.parametrize("name", SHAPES)
def test_unions_of_prisms_are_within_their_bounds(name: str, accuracy: str | None) -> None:
    require_within_bounds(prisms.mesh(SHAPES[name]), prisms.moments(SHAPES[name]), accuracy)


CORNER = st.tuples(st.integers(0, 4), st.integers(0, 4))
PRISM = st.tuples(st.lists(CORNER, min_size=3, max_size=5, unique=True), st.integers(0, 2), st.integers(3, 4))


@settings(deadline=None, max_examples=40)
@given(several=st.lists(PRISM, min_size=1, max_size=4), scale=st.sampled_from([1.0, 0.1]))
def test_unions_of_any_prisms_are_within_their_bounds(several: list, scale: float) -> None:
    shapes = [([(scale * x, scale * y) for x, y in outline], low, high) for outline, low, high in several]
    exact = prisms.moments(shapes)
    part = prisms.mesh(shapes)
    if exact["1"] == 0:
        with pytest.raises(inertia.GeometryError):
            inertia.mass_properties(part, union=True)
    else:
        require_within_bounds(part, exact, "exact")


def volume_of_intersection(bodies: list[Corners]) -> Fraction:
    """Return the volume of the intersection of tetrahedra: the first one, cut by the planes of the others."""
    pieces = [bodies[0]]
    for body in bodies[1:]:
        for k in range(4):
            face, inner = [body[j] for j in range(4) if j != k], body[k]
            inside = volume(*face, inner) > 0
            pieces = [part for piece in pieces for part in clipped(piece, face, 1 if inside else -1)]
    return sum((abs(volume(*piece)) for piece in pieces), Fraction(0))


def volume(a: tuple, b: tuple, c: tuple, d: tuple) -> Fraction:
    (p, q, r), (s, t, u), (v, w, x) = ([i - j for i, j in zip(k, a, strict=True)] for k in (b, c, d))
    return (p * (t * x - u * w) + q * (u * v - s * x) + r * (s * w - t * v)) / 6


def clipped(piece: Corners, face: list, way: int) -> list[Corners]:
    """Return tetrahedra that fill what of one is on a side of a plane."""
    heights = [way * volume(*face, p) for p in piece]
    above = [k for k in range(4) if heights[k] > 0]
    below = [k for k in range(4) if heights[k] <= 0]

    def cut(i: int, j: int) -> tuple:
        t = heights[i] / (heights[i] - heights[j])
        return tuple(a + t * (b - a) for a, b in zip(piece[i], piece[j], strict=True))

    if len(above) == 4:
        return [piece]
    if not above:
        return []
    if len(above) == 1:
        return [[piece[above[0]], *(cut(above[0], j) for j in below)]]
    if len(above) == 3:
        near = [piece[k] for k in above]
        far = [cut(k, below[0]) for k in above]
        return [[*near, far[0]], [near[1], near[2], far[0], far[1]], [near[2], *far]]
    i, j = above
    near, far = [piece[i], cut(i, below[0]), cut(i, below[1])], [piece[j], cut(j, below[0]), cut(j, below[1])]
    return [[*near, far[0]], [near[1], near[2], far[0], far[1]], [near[2], *far]]


@pytest.mark.parametrize("seed", range(12))
def test_unions_of_tetrahedra_are_as_inclusion_and_exclusion_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(3, 4, 3)) if seed < 8 else rng.integers(0, 4, (3, 4, 3)).astype(float)
    bodies = [[tuple(map(Fraction, p)) for p in tetrahedron.tolist()] for tetrahedron in points]
    bodies = [body if volume(*body) > 0 else [body[1], body[0], *body[2:]] for body in bodies]
    bodies = [body for body in bodies if volume(*body)]
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    corners = np.array([[float(k) for k in p] for body in bodies for p in body])
    part = Part.from_arrays(corners, np.concatenate([faces + 4 * k for k in range(len(bodies))]))
    exact = sum(
        ((-1) ** (count + 1) * volume_of_intersection(list(group)))
        for count in range(1, len(bodies) + 1)
        for group in combinations(bodies, count)
    )
    for accuracy in (None, "exact"):
        result = inertia.mass_properties(part, union=True, accuracy=accuracy)
        assert abs(Fraction(result.volume) - exact) <= Fraction(result.error.volume) * exact
    assert result.error.volume < 1.2e-16
    stored = sum(volume(*body) for body in bodies)
    assert inertia.unite(part).more_than_once == pytest.approx(float(stored - exact), rel=1e-12, abs=1e-12)


def outcome(part: Part) -> tuple:
    try:
        analysis = inertia.analyse(part, union=True, accuracy="exact")
    except inertia.GeometryError as fault:
        return type(fault), tuple(remedy.verb for remedy in fault.remedies)
    result, union = analysis.properties, analysis.union
    bits = result.volume, result.center_of_mass.tobytes(), result.inertia.tobytes(), result.error
    return *bits, analysis.bodies, union.crossings, union.more_than_once, union.negative


EVERY = {**BAD, **{name: Surface(*mesh) for name, mesh in CROSSING.items() if "spring" not in name}}


@pytest.mark.parametrize("name", EVERY)
def test_a_union_has_the_same_bits_in_any_order(name: str) -> None:
    original = outcome(solids.part(EVERY[name]))
    assert {outcome(shuffled(EVERY[name], seed)) for seed in range(4)} == {original}


VOLUMES = {
    "overlapping and cut at each other's faces": 15,
    "inside another, with faces in common": 2,
    "inside another, cut alike": 8,
    "plate with a rib in its corner": 120,
    "stored twice": 1,
    "twice, cut along other diagonals": 1,
    "a cutter that sticks out": 7.5,
    "inside out beside a sound one": 1,
    "too large for its cavity": 216,
    "turned by 30° about a common edge": 2000 - 1000 / 3**0.5,
}


@pytest.mark.parametrize("name", VOLUMES)
def test_what_is_refused_has_the_union_that_it_should_have(name: str) -> None:
    part = solids.part(BAD[name])
    with pytest.raises(inertia.GeometryError):
        inertia.mass_properties(part)
    assert inertia.mass_properties(part, union=True).volume == pytest.approx(VOLUMES[name] * 1e-9, rel=1e-14)


def test_the_hairpin_and_its_middle() -> None:
    for reach, volume, twice in ((6.0, 70, 2), (1.0, 61, 1)):
        union = inertia.unite(Part.from_arrays(*hairpin(reach)))
        assert inertia.mass_properties(union.part).volume == pytest.approx(volume, rel=1e-15)
        assert (union.more_than_once, union.negative) == (pytest.approx(twice, rel=1e-14), 0.0)


def test_a_ring_with_overlapping_ends_is_as_the_sweep_says() -> None:
    vertices, _ = ring(6.6)
    flat = vertices.reshape(-1, 4, 3)
    shapes = []
    for here, there in pairwise(flat):
        outline = [here[0][:2], here[1][:2], there[1][:2], there[0][:2]]
        corners = [(float(x), float(y)) for x, y in outline]
        area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1], strict=True))
        shapes.append((corners if area > 0 else corners[::-1], -1, 1))
    require_within_bounds(Part.from_arrays(*ring(6.6)), prisms.moments(shapes), "exact")


def tangle(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return bodies whose vertices were shaken, some to places of a lattice, so that their shells cross anyhow."""
    rng = np.random.default_rng(seed)
    vertices, faces = [], []
    for points, triangles in (solids.sphere(splits=1), solids.cylinder(1, 2, sides=7), solids.cube()):
        shaken = 2 * points / np.abs(points).max() + rng.normal(size=points.shape) * 0.4 + rng.integers(-1, 2, 3)
        vertices.append(np.round(shaken) if rng.random() < 0.5 else shaken)
        faces.append(triangles + sum(map(len, vertices[:-1])))
    return np.concatenate(vertices), np.concatenate(faces)


@pytest.mark.parametrize("scale", [1.0, 1e-60, 1e60])
@pytest.mark.parametrize("seed", range(5))
def test_what_counted_more_than_once_makes_up_the_stored_volume(seed: int, scale: float) -> None:
    vertices, faces = tangle(seed)
    union = inertia.unite(Part.from_arrays(scale * vertices, faces))
    corners = vertices[faces]
    united = union.part.triangles.corners() / scale
    stored, left = (np.linalg.det(points - vertices.min(axis=0)).sum() / 6 for points in (corners, united))
    added = (union.more_than_once - union.negative) / scale**3
    assert left > 0
    assert stored == pytest.approx(left + added, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_part_is_its_own_union(name: str) -> None:
    part = Part.from_arrays(*SOUND[name])
    assert inertia.unite(part).part is part


@pytest.mark.parametrize("name", [name for name in FITTING if name != "cubes that share an edge and a face"])
def test_bodies_that_touch_are_their_own_union(name: str) -> None:
    part = solids.part(FITTING[name][0])
    union = inertia.unite(part)
    assert union.part is part
    assert not union.changed


@pytest.mark.parametrize("name", EVERY)
def test_a_union_s_union_is_itself(name: str) -> None:
    part = solids.part(EVERY[name])
    try:
        union = inertia.unite(part).part
    except inertia.GeometryError:
        return
    assert inertia.unite(union).part is union
    assert inertia.check(union).fit


def test_a_one_sided_surface_and_an_open_one_are_refused() -> None:
    angle = np.linspace(0, 2 * np.pi, 13)[:-1]
    edge = np.array([[np.cos(a) * (1 + w * np.cos(a / 2)), np.sin(a) * (1 + w * np.cos(a / 2)), w * np.sin(a / 2)]
                     for w in (-0.4, 0.4) for a in angle])  # fmt: skip
    a = np.arange(12)
    b = (a + 1) % 12
    quads = [[i, j, j + 12, i + 12] if j else [i, 12, 0, i + 12] for i, j in zip(a.tolist(), b.tolist(), strict=True)]
    faces = np.array([[q[0], q[1], q[2]] for q in quads] + [[q[0], q[2], q[3]] for q in quads])
    for vertices, triangles in ((edge, faces), (solids.cube()[0], solids.cube()[1][1:])):
        with pytest.raises(inertia.GeometryError):
            inertia.unite(Part.from_arrays(vertices, triangles))


@pytest.mark.parametrize("far", [1e76, 1e100, 1e308])
def test_a_coordinate_beyond_those_that_are_usable_is_refused(far: float) -> None:
    vertices, faces = solids.sphere(splits=2)
    vertices[3] *= far
    with pytest.raises(inertia.GeometryError, match="beyond 1e75"):
        inertia.unite(Part.from_arrays(vertices, faces))


def test_a_surface_that_faces_inward_has_no_union() -> None:
    with pytest.raises(inertia.GeometryError, match=r"no point has a winding number of 1 or more.*inertia\.repair"):
        inertia.unite(solids.part(BAD["inside out"]))


def block(low: list[int], high: list[int], inward: bool) -> np.ndarray:
    """Return the triangles (12, 3, 3) of a box."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    triangles = (np.array(low) + corners * (np.array(high) - low))[np.array(faces)]
    return triangles[:, ::-1] if inward else triangles


@pytest.mark.parametrize("seed", range(40))
def test_boxes_on_a_grid_are_counted_cell_by_cell(seed: int) -> None:
    """Boxes of either winding with corners on a grid share faces, edges and corners in every way there is; so do they
    after any integer map. Their winding numbers are those of the grid's cells."""
    rng = np.random.default_rng(seed)
    windings, triangles = np.zeros((6, 6, 6), int), []
    for number in range(int(rng.integers(2, 7))):
        low = rng.integers(0, 5, 3)
        high = np.minimum(low + rng.integers(1, 4, 3), 6)
        inward = number > 0 and rng.random() < 0.3
        windings[low[0] : high[0], low[1] : high[1], low[2] : high[2]] += -1 if inward else 1
        triangles.append(block(low.tolist(), high.tolist(), inward))
    cells = int((windings >= 1).sum())
    linear = np.eye(3)
    while seed % 2 and round(np.linalg.det(linear := rng.integers(-3, 4, (3, 3)).astype(float))) == 0:
        pass
    scale = round(np.linalg.det(linear))
    corners = np.concatenate(triangles) @ linear.T
    corners = (corners if scale > 0 else corners[:, ::-1])[rng.permutation(len(corners))]
    part = Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    if cells == 0:
        with pytest.raises(inertia.GeometryError, match="no place outwards"):
            inertia.mass_properties(part, union=True)
        return
    result = inertia.mass_properties(part, 1.0, union=True)
    assert abs(Fraction(result.volume) - cells * abs(scale)) <= Fraction(result.error.volume) * cells * abs(scale)
    centre = (np.argwhere(windings >= 1) + 0.5).mean(axis=0) @ linear.T
    assert np.allclose(result.center_of_mass, centre, rtol=0, atol=1e-12)


LINES = [[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 0, 0]] * 3, [[1e9, 0, 0], [1e9, 1, 1], [1e9, 2, 2]]


@pytest.mark.parametrize("faces", [[[0, 1, 2], [0, 2, 1]], [[0, 1, 2]] * 3, [[0, 1, 2], [0, 2, 1]] * 3])
@pytest.mark.parametrize("points", LINES)
def test_triangles_without_area_are_refused_in_a_sentence(points: list, faces: list) -> None:
    part = inertia.Part.from_arrays(points, faces, "mm")
    with pytest.raises(inertia.GeometryError, match=r"none of its triangles has an area|stored again"):
        inertia.unite(part)
    with pytest.raises(inertia.GeometryError):
        inertia.mass_properties(part, 1.0, union=True)


@pytest.mark.parametrize("points", [LINES[0], LINES[2]])
def test_the_repair_of_a_triangle_without_area_has_no_volume(points: list) -> None:
    repaired = inertia.repair(inertia.Part.from_arrays(points, [[0, 1, 2]] * 3, "mm"))
    assert (repaired.volume_before, repaired.volume_after) == (0.0, 0.0)
