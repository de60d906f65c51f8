"""Volume in doubt: the bounds hold for the union of what shares a little of it, as for the sum.

Bodies in contact, shells of next to no volume that are wound wrongly, and shells that cross themselves a little.
"""

from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mesh.solids import Mesh, box, cube, inside_out, joined, sphere

import inertia
from inertia import Part
from inertia.errors import GeometryError
from inertia.mesh.surface import Surface
from inertia.report.analysis.document import analysis_document
from inertia.report.analysis.text import analysis_text

Box = tuple[list[Fraction], list[Fraction]]
_AXES = [(i, j) for i in range(3) for j in range(3)]


def box_moments(low: list[Fraction], high: list[Fraction]) -> list[Fraction]:
    """Return the volume, ∫x and ∫x xᵀ of a box about the origin."""
    size = [b - a for a, b in zip(low, high, strict=True)]
    mean = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    volume = size[0] * size[1] * size[2]
    second = [volume * (mean[i] * mean[j] + (size[i] ** 2 / 12 if i == j else 0)) for i, j in _AXES]
    return [volume, *(volume * k for k in mean), *second]


def of_union(one: Box, other: Box) -> tuple[float, np.ndarray, np.ndarray]:
    """Return volume, centroid and tensor of the union of two boxes that share space, exactly and then rounded."""
    common = (
        [max(a, b) for a, b in zip(one[0], other[0], strict=True)],
        [min(a, b) for a, b in zip(one[1], other[1], strict=True)],
    )
    parts = [box_moments(*body) for body in (one, other, common)]
    volume, *rest = [a + b - c for a, b, c in zip(*parts, strict=True)]
    center = [k / volume for k in rest[:3]]
    second = [rest[3 + k] - volume * center[i] * center[j] for k, (i, j) in enumerate(_AXES)]
    trace = second[0] + second[4] + second[8]
    tensor = [(trace if i == j else 0) - second[k] for k, (i, j) in enumerate(_AXES)]
    return float(volume), np.array(center, float), np.array(tensor, float).reshape(3, 3)


def sunk(seed: int, depth: float) -> tuple[Box, Box, Surface]:
    """Return a body and another that stands on it and is sunk in by a depth, exactly and as a shuffled mesh."""
    rng = np.random.default_rng(seed)
    low, high = rng.uniform(-1, 0, 3), rng.uniform(0.5, 1, 3)
    foot, top = rng.uniform(-0.5, 0.2, 3), rng.uniform(0.3, 1.5, 3)
    foot[2], top[2] = high[2] - depth, high[2] + rng.uniform(0.5, 2)
    if seed % 4 == 0:  # with sides in common planes
        foot[0], top[0] = low[0], high[0]
    mesh = joined(box(tuple(low), tuple(high)), box(tuple(foot), tuple(top)))
    faces = np.array([np.roll(face, rng.integers(3)) for face in rng.permutation(mesh.faces)])
    exact = [[Fraction(x) for x in corner.tolist()] for corner in (low, high, foot, top)]
    return (exact[0], exact[1]), (exact[2], exact[3]), Surface(mesh.vertices, faces)


@pytest.mark.parametrize("seed", range(60))
def test_union_of_bodies_in_contact_is_within_the_bounds(seed: int) -> None:
    depth = 10.0 ** np.random.default_rng(seed).uniform(-14, -6.5)
    one, other, mesh = sunk(seed, depth)
    turned = Rotation.random(rng=seed).as_matrix() if seed % 3 else np.eye(3)
    answer = inertia.mass_properties(Part.from_arrays(mesh.vertices @ turned.T, mesh.faces), 1.0)
    volume, center, tensor = of_union(one, other)
    rounding = 1e-14 if seed % 3 else 0.0  # of the vertices, when they are turned
    assert abs(answer.volume - volume) <= (answer.error.volume + rounding) * volume
    assert np.linalg.norm(answer.center_of_mass - turned @ center) <= answer.error.center_of_mass + rounding
    off = np.linalg.norm(answer.inertia - turned @ tensor @ turned.T)
    assert off <= (answer.error.inertia + rounding) * np.linalg.norm(tensor)
    assert answer.error.volume < 2 * depth + 1e-12


def test_mass_and_bodies_of_their_own_density_are_within_the_bounds() -> None:
    one, other, mesh = sunk(5, 3e-7)
    part = Part.from_arrays(mesh.vertices, mesh.faces)
    first, second = (float(box_moments(*body)[0]) for body in (one, other))
    shared = first + second - of_union(one, other)[0]
    answer = inertia.analyse(part, {"1": 2.0, "2": 5.0})
    mass = answer.properties.mass
    # What is shared is of the one or of the other.
    for truth in (2 * first + 5 * second - 2 * shared, 2 * first + 5 * second - 5 * shared):
        assert abs(mass - truth) <= answer.properties.error.mass * mass
    weighed = inertia.mass_properties(part, mass=3.0)
    volume, center, tensor = of_union(one, other)
    assert weighed.error.mass < 1e-15
    assert np.linalg.norm(weighed.center_of_mass - center) <= weighed.error.center_of_mass
    off = np.linalg.norm(weighed.inertia - tensor * 3 / volume)
    assert off <= weighed.error.inertia * np.linalg.norm(tensor * 3 / volume)
    assert weighed.error.volume == pytest.approx(shared / (first + second), rel=1e-3)


def test_contact_is_stated_with_its_tolerance_and_place() -> None:
    part = Part.from_arrays(*vars(joined(cube(), cube((0, 0, 1 - 4e-7)))).values(), unit="mm")
    analysis = inertia.analyse(part)
    (contact,) = analysis.doubts
    assert contact.code == "contact"
    assert contact.place == pytest.approx((0, 0, 0.5), abs=1e-6)
    assert "no deeper than the contact tolerance (1e-06 of the smaller body) or of less than 1e-09" in contact.message
    assert "up to 4e-07 mm³ count twice" in contact.message
    assert "In doubt          contact: 1 pair of bodies" in analysis_text(analysis)
    (entry,) = analysis_document(analysis)["doubts"]
    assert entry["code"] == "contact"
    assert entry["volume"] == pytest.approx(4e-16)
    with pytest.raises(GeometryError, match="is in doubt, see"):
        inertia.analyse(part, accuracy=1e-9)
    assert inertia.analyse(part, accuracy=1e-5).properties.error.volume < 1e-5


def test_bodies_in_contact_have_their_bound_through_the_algebra() -> None:
    one, other, mesh = sunk(3, 5e-7)
    answer = inertia.mass_properties(Part.from_arrays(mesh.vertices, mesh.faces), 1.0)
    double = answer + answer
    volume = of_union(one, other)[0]
    assert abs(double.mass - 2 * volume) <= double.error.mass * double.mass


@pytest.mark.parametrize("turn", [None, [0.2, -0.4, 0.7]])
def test_bodies_that_only_touch_are_not_in_doubt(turn: list[float] | None) -> None:
    stack = joined(cube(), cube((0, 0, 1)))
    ball = sphere()
    nested = Surface(
        np.vstack([2 * ball[0], ball[0], ball[0]]),
        np.vstack([ball[1], ball[1][:, ::-1] + len(ball[0]), ball[1] + 2 * len(ball[0])]),
    )
    for mesh in (stack, nested):
        vertices = mesh.vertices if turn is None else mesh.vertices @ Rotation.from_rotvec(turn).as_matrix().T
        part = Part.from_arrays(vertices, mesh.faces)
        analysis = inertia.analyse(part)
        assert analysis.doubts == ()
        assert "doubts" not in analysis_document(analysis)
        assert analysis.properties.error.volume < 1e-14


def test_stored_in_float32_contact_is_in_the_bounds() -> None:
    turned = Rotation.from_rotvec([0.3, 0.1, 0.5]).as_matrix()
    mesh = joined(cube(), box((-0.3, -0.2, 0.5), (0.3, 0.4, 1.5)))
    vertices = (mesh.vertices @ turned.T + 20).astype(np.float32).astype(float)
    answer = inertia.mass_properties(Part.from_arrays(vertices, mesh.faces), 1.0)
    alone = sum(
        inertia.mass_properties(Part.from_arrays(vertices[8 * k : 8 * k + 8], mesh.faces[:12]), 1.0).volume
        for k in range(2)
    )
    assert answer.volume == pytest.approx(alone, rel=1e-14)
    assert 1e-9 < answer.error.volume < 1e-6


def hook(depth: float) -> Mesh:
    """Return a hook whose point is sunk into its shank by a depth: at x from 1 − depth to 1, over 0.8 × 0.8."""
    outline = [[0, 0], [4, 0], [4, 3], [1 - depth, 3], [1 - depth, 2.2], [3, 2], [3, 1], [1, 1], [1, 3.2], [0, 3]]
    count = len(outline)
    points = np.array([[x, y, z] for z in (0, 1) for x, y in outline], float)
    points[[3, 4], 2], points[[13, 14], 2] = 0.1, 0.9
    cap = np.array([[4, 3, 2], [5, 4, 2], [5, 2, 1], [6, 5, 1], [6, 1, 0], [7, 6, 0], [7, 0, 9], [9, 8, 7]])
    here = np.arange(count)
    after = (here + 1) % count
    sides = np.column_stack([here, after, after + count]), np.column_stack([here, after + count, here + count])
    return points, np.vstack([cap, cap[:, ::-1] + count, *sides])


def of_mesh(vertices: np.ndarray, faces: np.ndarray) -> list[float]:
    """Return the volume, ∫x and ∫x xᵀ of tetrahedra from the origin, added up."""
    corners = vertices[faces]
    volumes, sums = np.linalg.det(corners) / 6, corners.sum(axis=1)
    squares = np.einsum("ti,tj->tij", sums, sums) + np.einsum("tki,tkj->tij", corners, corners)
    return [volumes.sum(), *(volumes @ sums / 4), *(np.einsum("t,tij->ij", volumes, squares) / 20).ravel()]


def central(volume: float, *rest: float) -> tuple[float, np.ndarray, np.ndarray]:
    center = np.array(rest[:3], float) / float(volume)
    second = np.array(rest[3:], float).reshape(3, 3) - float(volume) * np.outer(center, center)
    return float(volume), center, np.trace(second) * np.eye(3) - second


@pytest.mark.parametrize("seed", range(24))
def test_union_of_a_shell_that_crosses_itself_a_little_is_within_the_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    depth = 10.0 ** rng.uniform(-13, -6)
    vertices, faces = hook(depth)
    turned = Rotation.random(rng=rng).as_matrix() if seed % 3 else np.eye(3)
    shuffled = np.array([np.roll(face, rng.integers(3)) for face in rng.permutation(faces)])
    analysis = inertia.analyse(Part.from_arrays(vertices @ turned.T, shuffled))
    shared = box_moments([Fraction(1 - depth), Fraction(2.2), Fraction(0.1)], [Fraction(1), Fraction(3), Fraction(0.9)])
    volume, center, tensor = central(*(a - float(b) for a, b in zip(of_mesh(vertices, faces), shared, strict=True)))
    answer, rounding = analysis.properties, 1e-13
    assert [finding.code for finding in analysis.doubts] == ["self_intersection"]
    assert abs(answer.volume - volume) <= (answer.error.volume + rounding) * volume
    assert np.linalg.norm(answer.center_of_mass - turned @ center) <= answer.error.center_of_mass + rounding
    off = np.linalg.norm(answer.inertia - 1000 * turned @ tensor @ turned.T)
    assert off <= (answer.error.inertia + rounding) * 1000 * np.linalg.norm(tensor)
    assert answer.error.volume < 0.1 * depth + 1e-10


@pytest.mark.parametrize(("depth", "volume"), [(1e-4, "up to 6.4e-05"), (0.3, "about 0.2")])
def test_a_shell_that_crosses_itself_deeply_is_refused_with_the_volume(depth: float, volume: str) -> None:
    with pytest.raises(GeometryError, match=f"self-intersection: .* {volume} m³"):
        inertia.analyse(Part.from_arrays(*hook(depth)))


def test_a_shell_that_crosses_itself_by_the_rounding_of_float32_has_an_answer() -> None:
    answers = 0
    for seed in range(20):
        turned = Rotation.random(rng=seed).as_matrix()
        vertices = (hook(0.0)[0] @ turned.T * 30 + 50).astype(np.float32).astype(float)
        analysis = inertia.analyse(Part.from_arrays(vertices, hook(0.0)[1], unit="mm"))
        answers += bool(analysis.doubts)
        assert analysis.properties.volume == pytest.approx(27e-6 * of_mesh(*hook(0.0))[0], rel=1e-6)
        assert analysis.properties.error.volume < 1e-6
    assert answers > 5


def sliver(middle: tuple[float, float, float], size: float) -> Mesh:
    return box(tuple(x - size / 2 for x in middle), tuple(x + size / 2 for x in middle))


@pytest.mark.parametrize("middle", [(3, 0, 0), (0.5, 0.1, 0.2), (0, 0, 0), (0.5, 0.5, 0.5)])
@pytest.mark.parametrize("wound", ["outward", "inward"])
@pytest.mark.parametrize("size", [1e-6, 1e-5, 1e-4, 9e-4])
def test_a_sliver_is_counted_either_way(middle: tuple[float, float, float], wound: str, size: float) -> None:
    solid = sliver(middle, size)
    mesh = joined(cube(), solid if wound == "outward" else inside_out(solid))
    rng = np.random.default_rng(0)
    exact = [[Fraction(x) for x in corner.tolist()] for corner in (solid[0].min(axis=0), solid[0].max(axis=0))]
    whole, small = box_moments([Fraction(-1, 2)] * 3, [Fraction(1, 2)] * 3), box_moments(*exact)
    for _ in range(3):
        analysis = inertia.analyse(Part.from_arrays(mesh.vertices, rng.permutation(mesh.faces)), 1.0)
        answer = analysis.properties
        # Where it lies as it is wound, it is what it looks like; where it sticks out, what is shared may count once.
        sound = middle == (3, 0, 0) if wound == "outward" else middle == (0, 0, 0)
        truths = [(1 if wound == "outward" else -1, small)] if sound else [(k, small) for k in (-1, 0, 1)]
        if wound == "outward" and 0.5 in middle:
            shared = box_moments(exact[0], [min(x, Fraction(1, 2)) for x in exact[1]])
            truths = [(1, small), (1, [a - b for a, b in zip(small, shared, strict=True)])]
        for times, moments in truths:
            both = [a + times * b for a, b in zip(whole, moments, strict=True)]
            _, _, tensor = central(*both)
            off = [float(Fraction(k) - f / both[0]) for k, f in zip(answer.center_of_mass, both[1:4], strict=True)]
            assert abs(Fraction(answer.volume) - both[0]) <= Fraction(answer.error.volume) * both[0]
            unnamed = 2.0**-53 if size == 1e-6 else 0.0  # of less volume than rounding that of the whole takes
            assert np.linalg.norm(off) <= answer.error.center_of_mass + unnamed
            assert np.linalg.norm(answer.inertia - tensor) <= (answer.error.inertia + 1e-15) * np.linalg.norm(tensor)


def test_a_larger_shell_that_is_inside_out_is_no_sliver() -> None:
    mesh = joined(cube(), inside_out(sliver((3, 0, 0), 2e-3)))
    with pytest.raises(GeometryError, match="1 shell inside out beside others"):
        inertia.analyse(Part.from_arrays(mesh.vertices, mesh.faces))


def part_of(*meshes: Mesh, unit: str) -> Part:
    surface = joined(*meshes)
    return Part.from_arrays(surface.vertices, surface.faces, unit=unit)


def of_boxes(*boxes: tuple[int, Mesh]) -> tuple[np.ndarray, np.ndarray, Fraction]:
    """Return tensor, ∫x xᵀ about the centre and volume of boxes along the axes, each counted so many times; exactly."""
    sums = [Fraction(0)] * 13
    for times, (vertices, _) in boxes:
        exact = [[Fraction(x) for x in corner.tolist()] for corner in (vertices.min(axis=0), vertices.max(axis=0))]
        sums = [a + times * b for a, b in zip(sums, box_moments(*exact), strict=True)]
    volume, *rest = sums
    second = np.array(
        [rest[3 + k] - rest[i] * rest[j] / volume for k, (i, j) in enumerate(_AXES)], dtype=object
    ).reshape(3, 3)
    return np.trace(second) * np.eye(3, dtype=int) - second, second, volume


def far_speck(distance: float, edge: float = 2e-4) -> tuple[Mesh, Mesh]:
    """Return a rod of aspect 10⁴, and a cube beside it, of less than a billionth of its volume."""
    return box((0, 0, 0), (100, 0.01, 0.01)), box((50, distance, 0), (50 + edge, distance + edge, edge))


@pytest.mark.parametrize("distance", [200.0, 300.0])
@pytest.mark.parametrize("accuracy", [None, 1e-9, "exact"])
def test_a_speck_that_is_most_of_a_moment_is_no_sliver(distance: float, accuracy: float | str | None) -> None:
    rod, speck = far_speck(distance)
    assert of_boxes((1, rod), (-1, speck))[0][0, 0] < 0  # as stored: a moment that no body has
    part = part_of(rod, inside_out(speck), unit="mm")
    assert not inertia.check(part).fit
    with pytest.raises(GeometryError, match=rf"inside out .* around \(50.0, {distance}, 0.0\).*absolute") as refusal:
        inertia.mass_properties(part, accuracy=accuracy)
    assert refusal.value.exit_code == 4
    surface = part.triangles
    assert "inside out" in inertia.many(surface.vertices[None], surface.faces).refusals[0]
    for allowed in (1e-6, 0.5):  # of the tensor it is 1e-7, of a moment all
        with pytest.raises(GeometryError, match="inside out"):
            inertia.analyse(part, allow_faults=allowed)
    turned = inertia.mass_properties(part, 1e3, orientation="absolute", accuracy=accuracy)
    tensor, _, _ = of_boxes((1, rod), (1, speck))
    assert turned.principal_moments[0] == pytest.approx(float(tensor[0, 0]) * 1e-12, rel=1e-9)


def test_a_speck_that_takes_a_plate_its_thickness_is_no_sliver() -> None:
    plate, speck = box((0, 0, 0), (100, 100, 0.01)), box((50, 50, 300), (50.004, 50.004, 300.004))
    tensor, second, _ = of_boxes((1, plate), (-1, speck))
    assert min(tensor[k, k] for k in range(3)) > 0 > second[2, 2]  # the moments are positive, and of no body
    with pytest.raises(GeometryError, match="inside out"):
        inertia.analyse(part_of(plate, inside_out(speck), unit="mm"))


@pytest.mark.parametrize("seed", range(60))
def test_what_is_answered_beside_a_sliver_has_the_moments_of_a_body(seed: int) -> None:
    """Boxes of any aspect and inverted specks from beside them to far away: refused, or with moments that are told."""
    rng = np.random.default_rng(seed)
    sides = 10.0 ** rng.uniform(-3, 3, 3)
    edge = float(np.prod(sides) * 10.0 ** rng.uniform(-14, -9.1)) ** (1 / 3)
    way = rng.normal(size=3)
    place = way / np.linalg.norm(way) * sides.max() * 10.0 ** rng.uniform(0, 4) + sides
    solid, speck = box((0, 0, 0), tuple(sides)), box(tuple(place), tuple(place + edge))
    part = part_of(solid, inside_out(speck), unit="m")
    try:
        answer = inertia.mass_properties(part, 1.0)
    except GeometryError:
        second, other = of_boxes((1, solid))[1], of_boxes((1, solid), (-1, speck))[1]
        assert max(abs(float(1 - other[k, k] / second[k, k])) for k in range(3)) > 0.01  # it was not for nothing
        return
    assert (answer.principal.moment_bounds < answer.principal_moments).all()
    for times in (-1, 0, 1):
        tensor, second, _ = of_boxes((1, solid), (times, speck))
        off = np.linalg.norm(np.array(answer.inertia - tensor, float))
        assert off <= (answer.error.inertia + 1e-15) * np.linalg.norm(np.array(tensor, float))
        assert all(second[k, k] > 0 for k in range(3))


def askew_needle(distance: int) -> Part:
    """Return a needle of aspect 10⁸ along (1, 1, 1), on integers, and an inverted speck beside its middle."""
    vertices, faces = cube(size=2.0)
    needle = vertices @ np.array([[1, 1, 1], [1, -1, 0], [1, 1, -2]]) * 1.0
    needle += vertices[:, :1] * (2.0**27 - 1)
    speck = cube((distance, -distance, 0), 0.5)
    return part_of((needle, faces), inside_out(speck), unit="m")


def test_a_needle_that_float64_cannot_tell_is_refused_by_its_moments() -> None:
    near = inertia.mass_properties(askew_needle(64), 1.0)
    assert (near.principal.moment_bounds < near.principal_moments).all()
    part = askew_needle(2**20)
    for accuracy in (None, "exact"):
        with pytest.raises(
            GeometryError, match=r"not physical: .*sliver: 1 shell .* around .*take that out"
        ) as refusal:
            inertia.mass_properties(part, 1.0, accuracy=accuracy)
        assert refusal.value.code == "unphysical"
    lost = askew_needle(3 * 2**16)
    with pytest.raises(GeometryError, match=r"may be off by .*sliver: 1 shell .* around .*take that out"):
        inertia.mass_properties(lost, 1.0)


def test_two_bodies_far_apart_have_their_moments_though_float64_has_not() -> None:
    """The sums in float64 leave two negative moments here, whose determinant is positive."""
    block, speck = box((0, 0, 0), (1, 1, 1)), box((1e6, 0, 0), (1e6 + 2.0**-13, 2.0**-13, 2.0**-13))
    answer = inertia.mass_properties(part_of(block, speck, unit="m"), 1.0)
    tensor, _, _ = of_boxes((1, block), (1, speck))
    assert answer.error.inertia < 1e-9
    off = np.linalg.norm(np.array(answer.inertia - tensor, float))
    assert off <= answer.error.inertia * np.linalg.norm(np.array(tensor, float))
    with pytest.raises(GeometryError, match="inside out"):
        inertia.mass_properties(part_of(block, inside_out(speck), unit="m"), 1.0)


@pytest.mark.parametrize("power", [62, 63])
def test_a_doubt_whose_inertia_leaves_float64_is_refused(power: int) -> None:
    both = joined(cube(), cube((0.5, 0.5, 0.5)))
    with pytest.raises(GeometryError, match=r"above 1.8e308 and leaves float64"):
        inertia.analyse(Part(Surface(both.vertices * 10.0**power, both.faces)), parts="separate")
