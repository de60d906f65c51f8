"""Volume in doubt: the bounds hold for the union of bodies that share a little of it, as for their sum."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mesh.solids import box, cube, joined, sphere

import inertia
from inertia import Part
from inertia.errors import GeometryError
from inertia.mesh.part import Surface
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
    assert "no deeper than the contact tolerance (1e-06 of the smaller body)" in contact.message
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
