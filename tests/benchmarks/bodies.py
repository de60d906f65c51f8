"""Many bodies in one mesh, beside one body of as many triangles: ``python -m tests.benchmarks.bodies [NAME ...]``.

Prints CPU seconds from a binary STL file and from memory to the answer, the best of three, for each arrangement, and
what it answers.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import inertia
from inertia.arrays import Float, Int
from inertia.mesh.part import Part
from inertia_meshes import shapes

from ..mesh import solids
from .batch import stl
from .meshes import wavy_torus

Mesh = tuple[Float, Int]
_ROUNDS = 3


def _copies(mesh: Mesh, places: Float, sizes: Float | None = None) -> Mesh:
    """Return copies of a mesh at places (k, 3), of sizes (k,); those of negative size are turned inside out."""
    vertices, faces = mesh
    sizes = np.ones(len(places)) if sizes is None else sizes
    corners = vertices * np.abs(sizes)[:, None, None] + places[:, None]
    turned = np.where((sizes < 0)[:, None, None], faces[:, ::-1], faces)
    return corners.reshape(-1, 3), (turned + len(vertices) * np.arange(len(places))[:, None, None]).reshape(-1, 3)


def _lattice(count: int, step: float) -> Float:
    side = round(count ** (1 / 3))
    return step * np.stack(np.unravel_index(np.arange(count), (side,) * 3), axis=-1).astype(float)


def _shells(count: int) -> Mesh:
    """Return spheres within each other, every second one the wall of a void."""
    sizes = np.arange(1.0, count + 1) * np.where(np.arange(count) % 2 == (count - 1) % 2, 1, -1)
    return _copies(solids.sphere(splits=2), np.zeros((count, 3)), sizes)


def _balls(count: int) -> Mesh:
    """Return hollow balls side by side."""
    places = np.repeat(_lattice(count, 2.5), 2, axis=0)
    return _copies(solids.sphere(splits=2), places, np.tile([1.0, -0.8], count))


def _chain(count: int) -> Mesh:
    """Return rings, each through the next, that do not touch."""
    vertices, faces = solids.ring(16, 8, 1.0, 0.25)
    upright = vertices[:, [0, 2, 1]], faces[:, ::-1]
    places = np.array([[1.3, 0, 0]]) * np.arange(count)[:, None]
    flat, other = (_copies(mesh, places[k::2]) for k, mesh in enumerate([(vertices, faces), upright]))
    return _joined(flat, other)


def _pores(count: int) -> Mesh:
    """Return a ball with pores in it, of which no two boxes meet."""
    places = _lattice(count, 2.5)
    places -= places.mean(axis=0)
    ball = solids.sphere(radius=2.0 * np.abs(places).max(), splits=6)
    return _joined(ball, _copies(solids.sphere(splits=2), places, np.full(len(places), -1.0)))


def _packed(count: int) -> Mesh:
    """Return balls in the closest packing, a hundredth apart."""
    corners = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])
    places = (_lattice(count // 4, 1.0)[:, None] + corners).reshape(-1, 3)
    return _copies(solids.sphere(splits=2), 2.02 * np.sqrt(2.0) * places)


def _bars(count: int) -> Mesh:
    """Return long bars side by side, along no axis, each of whose boxes meets those of hundreds of others."""
    vertices, faces = solids.box((0, 0, 0), (0.1, 0.1, 8))
    turn = np.linalg.qr([[1.0, 1, 0.3], [-1, 1, 0.5], [0.4, -0.2, 1]])[0]
    places = 0.2 * np.stack(np.divmod(np.arange(count), round(np.sqrt(count))), axis=-1) @ turn[:2]
    return _copies((vertices @ turn, faces), places)


def _touching(count: int) -> Mesh:
    """Return rings apart, and two blocks beside them of which one stands on the other, askew."""
    rings = _copies(solids.ring(16, 7, 1.0, 0.25), _lattice(count, 3.0))
    turn = np.linalg.qr([[1.0, 1, 0.3], [-1, 1, 0.5], [0.4, -0.2, 1]])[0]
    blocks = _joined(solids.box((0, 0, 0), (1, 1, 1)), solids.box((0.2, 0.1, 1), (0.9, 0.7, 2)))
    return _joined(rings, (blocks[0] @ turn - 5, blocks[1]))


def _sharing(count: int) -> Mesh:
    """Return rings apart, and two cubes beside them that have a side in common."""
    rings = _copies(solids.ring(16, 7, 1.0, 0.25), _lattice(count, 3.0))
    return _joined(rings, _copies(solids.cube(), np.array([[-5.0, -5, -5], [-4, -5, -5]])))


def _pile(count: int) -> Mesh:
    """Return discs that lie on one another, along no axis."""
    turn = np.linalg.qr([[1.0, 1, 0.3], [-1, 1, 0.5], [0.4, -0.2, 1]])[0]
    vertices, faces = _copies(solids.cylinder(0.1, 1.0, 64), np.arange(count)[:, None] * [0, 0, 0.1])
    return vertices @ turn, faces


def _wall(count: int) -> Mesh:
    """Return bricks in a bond, face on face, along no axis."""
    turn = np.linalg.qr([[1.0, 1, 0.3], [-1, 1, 0.5], [0.4, -0.2, 1]])[0]
    places = _lattice(count, 1.0) * [2, 1, 1]
    places[:, 0] += places[:, 2] % 2
    vertices, faces = _copies(solids.box((0, 0, 0), (2, 1, 1)), places)
    return vertices @ turn, faces


def _bolted(side: int) -> Mesh:
    """Return a plate and bolts that fill its bores, their heads on it, along no axis."""
    profile = [(0, -0.5), (0.5, -0.5), (0.5, 1), (0.9, 1), (0.9, 1.4), (0, 1.4)]
    lower, upper = (shapes.circle(0.5, z, 48) for z in (0, 1))
    square = np.array([[1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]], float)
    raised = shapes.moved(square, 0, 0, 1)
    bored = [shapes.flipped(shapes.ring(square, lower)), shapes.ring(raised, upper)]
    bored.append(shapes.flipped(shapes.band(lower, upper)))
    walls, last = shapes.band(square, raised).reshape(4, 2, 3, 3), side - 1
    corners = []
    for i, j in product(range(side), repeat=2):
        outer = walls[[i == last, j == last, i == 0, j == 0]].reshape(-1, 3, 3)
        cell = np.concatenate([*bored, outer, shapes.revolved(profile, 48)])
        corners.append(shapes.moved(cell, 2 * i, 2 * j, 0))
    turn = np.linalg.qr([[1.0, 1, 0.3], [-1, 1, 0.5], [0.4, -0.2, 1]])[0]
    vertices = np.concatenate(corners).reshape(-1, 3) @ turn
    return vertices, np.arange(len(vertices)).reshape(-1, 3)


def _hollow(count: int, wall: float) -> Mesh:
    """Return a wavy torus, hollow, of so many triangles, with a wall as thick as so many edges are long."""
    vertices, faces = wavy_torus(count // 2)
    sides = vertices[faces[:, 1:]] - vertices[faces[:, :1]]
    normal, edge = np.zeros_like(vertices), float(np.median(np.linalg.norm(sides, axis=2)))
    for corner in faces.T:
        np.add.at(normal, corner, np.cross(sides[:, 0], sides[:, 1]))
    inner = vertices - wall * edge * normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return _joined((vertices, faces), (inner, faces[:, ::-1]))


def _joined(one: Mesh, other: Mesh) -> Mesh:
    return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1] + len(one[0])])


def _tetrahedra(count: int, step: float) -> Mesh:
    mesh = (
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]),
        np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]),
    )
    return _copies(mesh, _lattice(count, step))


KINDS: dict[str, Callable[[], Mesh]] = {
    "5,832 rings": lambda: _copies(solids.ring(16, 7, 1.0, 0.25), _lattice(5_832, 3.0)),
    "64,000 cubes": lambda: _copies(solids.cube(), _lattice(64_000, 2.0)),
    "1,000,000 tetrahedra": lambda: _tetrahedra(1_000_000, 2.0),
    "1,000 hollow balls": lambda: _balls(1_000),
    "a hollow torus of 1,300,000, wall of 5 edges": lambda: _hollow(1_300_000, 5.0),
    "a hollow torus of 1,300,000, wall of half an edge": lambda: _hollow(1_300_000, 0.5),
    "300 shells in each other": lambda: _shells(300),
    "3,000 shells in each other": lambda: _shells(3_000),
    "3,000 rings of a chain": lambda: _chain(3_000),
    "3,375 pores in a ball": lambda: _pores(3_375),
    "2,916 balls in the closest packing": lambda: _packed(2_916),
    "10,000 bars side by side, askew": lambda: _bars(10_000),
    "4,096 rings, and two blocks that touch": lambda: _touching(4_096),
    "4,096 rings, and two cubes with a common side": lambda: _sharing(4_096),
    "8,000 cubes face on face": lambda: _copies(solids.cube(), _lattice(8_000, 1.0)),
    "27,000 cubes face on face": lambda: _copies(solids.cube(), _lattice(27_000, 1.0)),
    "512 bricks of a wall, askew": lambda: _wall(512),
    "100 discs of a pile, askew": lambda: _pile(100),
    "25 bolts in a plate, askew": lambda: _bolted(5),
    "400 bolts in a plate, askew": lambda: _bolted(20),
    "512 cubes that overlap": lambda: _copies(solids.cube(), _lattice(512, 0.7)),
    "8,000 tetrahedra that overlap": lambda: _tetrahedra(8_000, 0.45),
}


def seconds(part: Callable[[], Part]) -> tuple[float, str]:
    """Return the CPU time of one analysis, and how many bodies there are or why there is no answer."""
    started = time.process_time()
    try:
        says = f"{inertia.analyse(part()).bodies} bodies"
    except inertia.GeometryError as refusal:
        says = str(refusal)[:60]
    return time.process_time() - started, says


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.bodies", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {'; '.join(KINDS)}")
    for name in parser.parse_args().names or KINDS:
        mesh = KINDS[name]()
        alike = wavy_torus(len(mesh[1]))
        with TemporaryDirectory() as folder:
            paths = [Path(folder, f"{k}.stl") for k in range(2)]
            for path, (vertices, faces) in zip(paths, (mesh, alike), strict=True):
                path.write_bytes(stl(vertices[faces]))
            sources = [partial(inertia.read, path, unit="mm") for path in paths]
            sources += [partial(Part.from_arrays, *each, unit="mm") for each in (mesh, alike)]
            runs = [[seconds(source) for source in sources] for _ in range(_ROUNDS)]
        many, one, held, lone = (min(run[k][0] for run in runs) for k in range(4))
        print(
            f"{name:38s} {len(mesh[1]):9,} triangles: from file {many:7.3f} s, {many / one:5.1f} × one body, "
            f"in memory {held:7.3f} s, {held / lone:5.1f} ×: {runs[0][0][1]}"
        )


if __name__ == "__main__":
    main()
