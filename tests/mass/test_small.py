"""Small solids in memory: the compiled path gives what the whole analysis does, bit for bit, and refuses alike."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from tests.benchmarks.extremes.cases import ball
from tests.benchmarks.meshes import wavy_torus

import inertia
from inertia.errors import GeometryError
from inertia.mass import analyse as module
from inertia.mass.properties import MassProperties
from inertia.mesh.geometry import simple as passes
from inertia_meshes import rational

F = Fraction
here = pytest.mark.skipif(not passes.at_hand(), reason="without compiled kernels there is one path only")
Mesh = tuple[np.ndarray, np.ndarray]


def seeded(seed: int) -> Mesh:
    """Return a ball or torus that is noisy, stretched, turned, moved off or rounded to float32."""
    rng = np.random.default_rng(seed)
    vertices, faces = ball(int(rng.integers(0, 3))) if rng.random() < 0.5 else wavy_torus(int(rng.integers(40, 400)))
    vertices = vertices * rng.choice([1.0, 1e-2, 30.0], size=3)
    vertices = vertices + rng.normal(size=vertices.shape) * 10.0 ** rng.uniform(-18, -2) * np.ptp(vertices, axis=0)
    vertices = vertices + rng.normal(size=3) * rng.choice([0.0, 1.0, 1e5])
    vertices = vertices @ np.linalg.qr(rng.normal(size=(3, 3)))[0] if rng.random() < 0.3 else vertices
    vertices = vertices.astype(np.float32).astype(float) if rng.random() < 0.3 else vertices
    if rng.random() < 0.3:
        return vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    return vertices, np.asarray(faces, np.int64)


def figures(properties: MassProperties) -> tuple[object, ...]:
    return (
        properties.mass,
        properties.volume,
        properties.center_of_mass.tolist(),
        properties.inertia.tolist(),
        properties.error,
        properties.principal_moments.tolist(),
        properties.about([1.0, 2.0, 3.0]).tolist(),
    )


def answer(question: Callable[[], MassProperties]) -> object:
    try:
        return figures(question())
    except GeometryError as error:
        return str(error)


def test_the_same_bits_bounds_and_sentences_as_the_whole_analysis() -> None:
    kinds = set()
    for seed in range(60):
        vertices, faces = seeded(seed)
        part = inertia.Part.from_arrays(vertices, faces, unit="mm" if seed % 2 else "m")
        quick = answer(lambda part=part: inertia.mass_properties(part, 7850.0))
        assert quick == answer(lambda part=part: inertia.analyse(part, 7850.0).properties)
        kinds.add(type(quick))
    assert kinds == {str, tuple}


@pytest.mark.parametrize("count", [900, 1100, 2000, 3000, 3300])
@pytest.mark.parametrize("fault", ["", "open", "inward", "crossing", "shuffled", "two"])
def test_the_same_bits_and_sentences_around_the_sizes_where_other_ways_begin(count: int, fault: str) -> None:
    vertices, faces = wavy_torus(count)
    if fault == "open":
        faces = faces[1:]
    elif fault == "inward":
        faces = faces[:, ::-1]
    elif fault == "crossing":
        vertices[faces[0, 0]] *= -2.0
    elif fault == "shuffled":
        faces = np.random.default_rng(count).permutation(faces)
    elif fault == "two":
        faces = np.concatenate([faces, faces + len(vertices)])
        vertices = np.concatenate([vertices, vertices + 100.0])
    part = inertia.Part.from_arrays(vertices, np.ascontiguousarray(faces), unit="mm")
    quick = answer(lambda: inertia.mass_properties(part, 7850.0))
    assert isinstance(quick, str) == (fault in ("open", "inward", "crossing"))
    assert quick == answer(lambda: inertia.analyse(part, 7850.0).properties)


@here
@pytest.mark.parametrize("mesh", [ball(2), wavy_torus(1100), wavy_torus(2900)], ids=["320", "1100", "2900"])
def test_a_small_solid_is_answered_without_the_whole_analysis(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    part = inertia.Part.from_arrays(*mesh)
    monkeypatch.setattr(module, "analyse", lambda *_, **__: pytest.fail("the whole analysis ran"))
    for statement in ({}, {"density": 2.5}, {"material": "steel"}, {"density": {"": 3}}):
        assert inertia.mass_properties(part, **statement).mass > 0  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [60, 200, 1000, 2000])
def test_bounds_cover_the_exact_moments(count: int) -> None:
    for seed in range(3):
        vertices, faces = wavy_torus(count)
        vertices = vertices + np.random.default_rng(seed).normal(size=3) * 10.0**seed
        properties = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces), 1.0)
        exact = rational.moments(vertices[faces])
        assert abs(F(properties.volume) / exact.volume - 1) <= F(properties.error.volume)
        off = [F(c) - f / exact.volume for c, f in zip(properties.center_of_mass.tolist(), exact.first, strict=True)]
        assert sum(k * k for k in off) <= F(properties.error.center_of_mass) ** 2


def test_what_is_read_later_does_not_follow_the_arrays() -> None:
    vertices, faces = ball(1)
    before = figures(inertia.mass_properties(inertia.Part.from_arrays(vertices.copy(), faces)))
    part = inertia.Part.from_arrays(vertices, faces)
    properties = inertia.mass_properties(part)
    part.geometry.vertices *= 7.0  # type: ignore[union-attr]
    assert figures(properties) == before


def test_it_can_be_copied_pickled_and_shown_before_its_bounds_are_read() -> None:
    def fresh() -> MassProperties:
        return inertia.mass_properties(inertia.Part.from_arrays(*ball(1)))

    for made in (copy.copy(fresh()), copy.deepcopy(fresh()), pickle.loads(pickle.dumps(fresh()))):
        assert figures(made) == figures(fresh())
    assert "certified bound" in repr(fresh())
    with pytest.raises(AttributeError, match="no attribute 'weight'"):
        fresh().weight  # type: ignore[attr-defined]  # noqa: B018
    with pytest.raises(ValueError, match="read-only"):
        fresh().inertia[0, 0] = 1.0


@pytest.mark.parametrize("copies", [2, 3])
def test_read_only_arrays_and_several_bodies(copies: int) -> None:
    vertices, faces = ball(1)
    many = np.concatenate([vertices + np.array([3.0 * k, 0, 0]) for k in range(copies)])
    numbers = np.concatenate([faces + k * len(vertices) for k in range(copies)])
    many.setflags(write=False)
    numbers.setflags(write=False)
    one = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces)).mass
    mass = inertia.mass_properties(inertia.Part.from_arrays(many, numbers)).mass
    assert mass == pytest.approx(copies * one, rel=1e-14)


@pytest.mark.parametrize("fault", ["open", "inward", "crossing", "not finite", "empty", "far"])
def test_what_is_no_solid_is_refused_as_before(fault: str) -> None:
    vertices, faces = ball(1)
    if fault == "open":
        faces = faces[1:]
    elif fault == "inward":
        faces = faces[:, ::-1]
    elif fault == "crossing":
        vertices[faces[0, 0]] *= -2.0
    elif fault == "not finite":
        vertices[3, 1] = np.nan
    elif fault == "empty":
        faces = faces[:0]
    else:
        vertices = vertices * 1e76
    part = inertia.Part.from_arrays(vertices, faces)
    with pytest.raises(GeometryError) as quick:
        inertia.mass_properties(part)
    with pytest.raises(GeometryError) as whole:
        inertia.analyse(part)
    assert str(quick.value) == str(whole.value)
