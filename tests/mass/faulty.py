"""Closed solids made faulty in known ways, and whether an answer's bounds hold the intact solid's exact properties."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import NamedTuple

import numpy as np
from tests.mass.test_filled_holes import cone, drum, fan, fine_box, lumpy, patch, rough
from tests.mesh.solids import Mesh, cube, ring, sphere

import inertia
from inertia import Part
from inertia.errors import GeometryError

Random = np.random.Generator
Faulty = tuple[np.ndarray, np.ndarray]


class Exact(NamedTuple):
    """Volume, centroid (3,) and tensor (3, 3) about it, rational."""

    volume: Fraction
    center: list[Fraction]
    inertia: list[list[Fraction]]


def exact(vertices: np.ndarray, faces: np.ndarray) -> Exact:
    """Return the properties of a closed mesh at density 1: a sum over tetrahedra about the origin, in fractions."""
    points = [[Fraction(x) for x in point] for point in vertices.tolist()]
    volume, first = Fraction(0), [Fraction(0)] * 3
    second = [[Fraction(0)] * 3 for _ in range(3)]
    for face in faces.tolist():
        a, b, c = (points[k] for k in face)
        det = (
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
        total = [x + y + z for x, y, z in zip(a, b, c, strict=True)]
        volume += det / 6
        for i in range(3):
            first[i] += det / 24 * total[i]
            for j in range(i, 3):
                squares = a[i] * a[j] + b[i] * b[j] + c[i] * c[j]
                second[i][j] += det / 120 * (total[i] * total[j] + squares)
    return _of_moments(volume, first, second)


def _of_moments(volume: Fraction, first: list[Fraction], second: list[list[Fraction]]) -> Exact:
    center = [k / volume for k in first]
    central = [[second[min(i, j)][max(i, j)] - volume * center[i] * center[j] for j in range(3)] for i in range(3)]
    trace = sum(central[k][k] for k in range(3))
    return Exact(volume, center, [[(i == j) * trace - central[i][j] for j in range(3)] for i in range(3)])


def holds(analysis: inertia.Analysis, truth: Exact, density: float = 1.0) -> bool:
    """Say whether the exact properties lie within all bounds of an answer; its unit is the metre."""
    answer, error = analysis.properties, analysis.properties.error
    rounding = Fraction(1, 2**45)
    mass = truth.volume * Fraction(density)
    fine = abs(Fraction(answer.volume) - truth.volume) <= (Fraction(error.volume) + rounding) * Fraction(answer.volume)
    fine &= abs(Fraction(answer.mass) - mass) <= (Fraction(error.mass) + rounding) * Fraction(answer.mass)
    away = np.array([float(Fraction(x) - y) for x, y in zip(answer.center_of_mass.tolist(), truth.center, strict=True)])
    size = float(np.ptp(analysis.extents, axis=0).max())
    fine &= bool(np.linalg.norm(away) <= error.center_of_mass + 1e-14 * size)
    tensor = np.array([[float(k * Fraction(density)) for k in row] for row in truth.inertia])
    norm = np.linalg.norm(answer.inertia)
    fine &= bool(np.linalg.norm(answer.inertia - tensor) <= (error.inertia + 1e-13) * norm)
    off = np.abs(analysis.principal.moments - np.linalg.eigvalsh(tensor))
    return fine and bool((off <= analysis.principal.moment_bounds + 1e-13 * norm).all())


SOLIDS: dict[str, Callable[[], Mesh]] = {
    "cube": cube,
    "box": fine_box,
    "sphere": lambda: sphere(splits=3),
    "fine sphere": lambda: sphere(splits=4),
    "ring": ring,
    "drum": lambda: drum(24, 1.5),
    "flat drum": lambda: drum(48, 0.2),
    "cone": lambda: cone(16, 2, 8),
    "lumpy 0": lambda: lumpy(0),
    "lumpy 1": lambda: lumpy(1),
    "rough 0.02": lambda: rough(0.02),
    "rough 0.1": lambda: rough(0.1),
}


@cache
def solid(name: str) -> tuple[Mesh, Exact]:
    """Return a closed solid by its name, turned and off the origin, and its exact properties."""
    vertices, faces = SOLIDS[name]()
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    mesh = np.asarray(vertices, float) @ turn.T * [1.0, 1.1, 0.9] + [0.3, -0.2, 0.5], np.asarray(faces)
    return mesh, exact(*mesh)


def _size(vertices: np.ndarray) -> float:
    return float(np.linalg.norm(np.ptp(vertices, axis=0)))


def _gap(rng: Random) -> float:
    """Return a displacement over the size of a part, from 1e-18 to 1e-3."""
    return float(10 ** rng.uniform(-18, -3))


def triangles_missing(mesh: Mesh, rng: Random) -> Faulty:
    return mesh[0], np.delete(mesh[1], rng.integers(0, len(mesh[1]), rng.integers(1, 4)), axis=0)


def patch_missing(mesh: Mesh, rng: Random) -> Faulty:
    count = int(rng.integers(2, max(3, len(mesh[1]) // 12)))
    return mesh[0], np.delete(mesh[1], patch(mesh, int(rng.integers(len(mesh[1]))), count), axis=0)


def fan_missing(mesh: Mesh, rng: Random) -> Faulty:
    return mesh[0], np.delete(mesh[1], fan(mesh, int(rng.choice(mesh[1].ravel()))), axis=0)


def strip_missing(mesh: Mesh, rng: Random) -> Faulty:
    """Leave out triangles, each a neighbour of the last."""
    vertices, faces = mesh
    strip = [int(rng.integers(len(faces)))]
    for _ in range(int(rng.integers(1, 12))):
        shared = (np.isin(faces, faces[strip[-1]])).sum(axis=1) == 2
        shared[strip] = False
        if not shared.any():
            break
        strip.append(int(rng.choice(np.flatnonzero(shared))))
    return vertices, np.delete(faces, strip, axis=0)


def patch_apart(mesh: Mesh, rng: Random) -> Faulty:
    """Give some triangles vertices of their own, displaced by a gap."""
    vertices, faces = mesh
    apart = patch(mesh, int(rng.integers(len(faces))), int(rng.integers(1, max(2, len(faces) // 3))))
    used, own = np.unique(faces[apart], return_inverse=True)
    rest = np.delete(np.arange(len(faces)), apart)
    moves = rng.normal(size=(len(used), 3))
    moves *= _gap(rng) * _size(vertices) / np.linalg.norm(moves, axis=1).max()
    moves[~np.isin(used, faces[rest])] = 0
    faces = faces.copy()
    faces[apart] = own.reshape(-1, 3) + len(vertices)
    return np.vstack([vertices, vertices[used] + moves]), faces


def soup(mesh: Mesh, rng: Random) -> Faulty:
    """Store the corners of each triangle, a little off: by up to the edges' length over ten."""
    corners = mesh[0][mesh[1]]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    gap = min(_gap(rng) * _size(mesh[0]), 0.1 * edges.min())
    corners = corners + rng.uniform(-gap, gap, corners.shape)
    return corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3)


def t_junctions(mesh: Mesh, rng: Random) -> Faulty:
    """Split triangles at the middle of an edge, and not their neighbours."""
    vertices, faces = mesh
    vertices, faces = vertices.copy(), faces.copy()
    for _ in range(int(rng.integers(1, 8))):
        face = int(rng.integers(len(faces)))
        a, b, c = np.roll(faces[face], -int(rng.integers(3))).tolist()
        off = rng.normal(size=3) * _gap(rng) * np.linalg.norm(vertices[b] - vertices[a])
        middle = len(vertices)
        vertices = np.vstack([vertices, (vertices[a] + vertices[b]) / 2 + off])
        faces[face] = a, middle, c
        faces = np.vstack([faces, [middle, b, c]])
    return vertices, faces


def stored_again(mesh: Mesh, rng: Random) -> Faulty:
    which = rng.integers(0, len(mesh[1]), rng.integers(1, 6))
    return mesh[0], np.vstack([mesh[1], np.roll(mesh[1][which], 1, axis=1)])


def flipped(mesh: Mesh, rng: Random) -> Faulty:
    faces = mesh[1].copy()
    which = rng.choice(len(faces), max(1, int(rng.integers(1 + len(faces) // 4))), replace=False)
    faces[which] = faces[which, ::-1]
    return mesh[0], faces


def fin(mesh: Mesh, rng: Random) -> Faulty:
    """Hang a triangle on an edge."""
    a, b, _ = mesh[1][int(rng.integers(len(mesh[1])))].tolist()
    outward = mesh[0][a] + (mesh[0][a] - mesh[0].mean(axis=0)) * 0.1
    return np.vstack([mesh[0], outward]), np.vstack([mesh[1], [a, b, len(mesh[0])]])


FAULTS: tuple[Callable[[Mesh, Random], Faulty], ...] = (
    triangles_missing,
    patch_missing,
    fan_missing,
    strip_missing,
    patch_apart,
    soup,
    t_junctions,
    stored_again,
    flipped,
    fin,
)


class Case(NamedTuple):
    """What came of a case: its kind, whether the bounds held (None: refused), width and true error of the volume."""

    kind: str
    held: bool | None
    width: float = 0.0
    off: float = 0.0


def case(name: str, seed: int, allowed: float = 0.999) -> Case:
    """Make a solid faulty, once or twice, and ask for its properties."""
    rng = np.random.default_rng(seed)
    mesh, truth = solid(name)
    faults = [FAULTS[k] for k in rng.integers(0, len(FAULTS), 1 + (seed % 3 == 0))]
    kind = " + ".join(each.__name__ for each in faults)
    faulty: Faulty = mesh
    for each in faults:
        faulty = each(faulty, rng)
    try:
        analysis = inertia.analyse(Part.from_arrays(*faulty), 1.0, allow_faults=allowed)
    except GeometryError:
        return Case(kind, None)
    off = abs(float(Fraction(analysis.properties.volume) - truth.volume)) / analysis.properties.volume
    return Case(kind, holds(analysis, truth), analysis.properties.error.volume, off)
