"""Repair does the same whatever the order of the triangles and whichever corner comes first."""

from fractions import Fraction

import numpy as np
import pytest
from tests.mesh.solids import cube, inside_out, joined, part, sphere

import inertia
from inertia.mesh.surface import Surface
from inertia_meshes.rational import moments


def without(mesh: Surface, *missing: int) -> Surface:
    return Surface(mesh.vertices, np.delete(mesh.faces, missing, axis=0))


def with_turned(mesh: Surface, *turned: int) -> Surface:
    faces = mesh.faces.copy()
    faces[list(turned)] = faces[list(turned), ::-1]
    return Surface(mesh.vertices, faces)


def cracked() -> Surface:
    """Return a cube in whose corner one triangle ends 2⁻⁴⁰ beside."""
    mesh = joined(cube())
    faces = mesh.faces.copy()
    faces[0, 0] = len(mesh.vertices)
    beside = mesh.vertices[mesh.faces[0, 0]] + [2.0**-40, 0, 0]
    return Surface(np.vstack([mesh.vertices, beside]), faces)


BROKEN = {
    "sound": (joined(cube()), {}),
    "a missing triangle": (without(joined(cube(), sphere(splits=1)), 4), {}),
    "two missing triangles": (without(joined(cube(size=2)), 0, 7), {}),
    "a turned triangle": (with_turned(joined(cube()), 5), {}),
    "three turned triangles and a missing one": (without(with_turned(joined(sphere(splits=2)), 3, 60, 61), 100), {}),
    "inside out": (joined(inside_out(cube())), {}),
    "inside out beside a sound one": (joined(cube(), inside_out(cube((3, 0, 0)))), {}),
    "a triangle three times": (Surface(cube()[0], np.vstack([cube()[1], cube()[1][[3, 3]]])), {}),
    "a fin": (Surface(np.vstack([cube()[0], [[9, 9, 9]]]), np.vstack([cube()[1], [[0, 1, 8]]])), {}),
    "a repeated corner": (Surface(cube()[0], np.vstack([cube()[1], [[2, 2, 5]]])), {}),
    "a crack": (cracked(), {"tolerance": 2.0**-35}),
    "overlapping cubes": (joined(cube(), cube((0.5, 0.25, 0.125))), {}),
    "hollow, its cavity inside out": (joined(cube(size=4), cube((1, 1, 1))), {}),
}

NEARLY = {"overlapping cubes": 1e-14, "a crack": 2.0**-40}
"""A union's coordinates are rounded; of vertices that become one, the one stored first stays."""


def outcome(surface: Surface, options: dict[str, float]) -> tuple[dict[str, int], Fraction, np.ndarray]:
    repaired = inertia.repair(part(surface), **options)
    corners = repaired.part.triangles.corners()
    result = inertia.mass_properties(repaired.part, accuracy="exact")
    changes = {change.what: change.count for change in repaired.changes}
    assert result.volume * 1e9 == pytest.approx(float(moments(corners).volume), rel=1e-15)
    return changes, moments(corners).volume, np.append(result.center_of_mass, result.inertia.ravel())


@pytest.mark.parametrize("name", BROKEN)
def test_changes_and_volume_do_not_depend_on_the_order(name: str) -> None:
    surface, options = BROKEN[name]
    changes, volume, rest = outcome(surface, options)
    assert changes or name == "sound"
    for seed in range(8):
        rng = np.random.default_rng(seed)
        faces = rng.permutation(surface.faces)
        faces = np.take_along_axis(faces, (rng.integers(0, 3, (len(faces), 1)) + np.arange(3)) % 3, axis=1)
        same, again, others = outcome(Surface(surface.vertices, faces), options)
        assert same == changes
        if name in NEARLY:
            assert float(again) == pytest.approx(float(volume), rel=NEARLY[name])
            np.testing.assert_allclose(others[:3], rest[:3], atol=1e-3 * NEARLY[name])
        else:
            assert again == volume
            assert others.tobytes() == rest.tobytes()
