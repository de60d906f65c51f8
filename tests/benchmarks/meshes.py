"""The meshes that are measured: closed wavy tori without any symmetry, of any number of triangles.

Run as a program, it writes one as a binary STL file: ``python -m tests.benchmarks.meshes PATH COUNT ORDER``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from inertia.mesh.surface import FACET

Vertices = NDArray[np.float64]
Faces = NDArray[np.int64]


def wavy_torus(count: int) -> tuple[Vertices, Faces]:
    """Return vertices (n, 3) and faces (m, 3) of a torus of at least `count` triangles, outward.

    The coordinates are float32 numbers, so that an STL file holds the same body. The vertices are numbered in the
    order in which the faces first use them, as a reader that welds an STL file numbers them.
    """
    around = int(np.ceil(np.sqrt(count / 4)))  # of the tube
    along = -(-count // (2 * around))
    u = np.linspace(0.0, 2 * np.pi, along, endpoint=False)[:, None]
    v = np.linspace(0.0, 2 * np.pi, around, endpoint=False)[None, :]
    radius = 20.0 * (1.0 + 0.2 * np.sin(3 * u + v) + 0.1 * np.cos(u) * np.sin(2 * v + 1))
    distance = 60.0 + 5.0 * np.sin(2 * u + 0.5) + radius * np.cos(v)
    x = distance * np.cos(u) + 7.0
    y = 1.3 * distance * np.sin(u) - 3.0
    z = radius * np.sin(v) + 4.0 * np.sin(u) + 11.0
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32).astype(np.float64)
    i, j = np.arange(along)[:, None], np.arange(around)[None, :]
    i1, j1 = (i + 1) % along, (j + 1) % around
    a, b, c, d = i * around + j, i1 * around + j, i1 * around + j1, i * around + j1
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=2).reshape(-1, 3)
    first = np.empty(len(vertices), np.int64)
    first[faces.ravel()[::-1]] = np.arange(faces.size)[::-1]  # of several values for one place, the last stays
    order = np.argsort(first)
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    return vertices[order], number[faces]


def facets(vertices: Vertices, faces: Faces) -> NDArray[np.void]:
    """Return the binary STL records of a mesh."""
    records = np.zeros(len(faces), FACET)
    for corner in range(3):
        points = vertices[faces[:, corner]]
        for axis, name in enumerate("xyz"):
            records[f"{name}{corner}"] = points[:, axis]
    return records


def many_bodies(count: int) -> tuple[Vertices, Faces]:
    """Return vertices and faces of wavy tori of 224 triangles, one after the other, whose boxes do not meet."""
    vertices, faces = wavy_torus(224)
    bodies = -(-count // len(faces))
    side = int(np.ceil(bodies ** (1 / 3)))
    place = np.stack(np.unravel_index(np.arange(bodies), (side, side, side)), axis=-1)
    far = np.ptp(vertices, axis=0).max() * 1.25
    moved = (vertices + far * place[:, None]).astype(np.float32).astype(np.float64)
    return moved.reshape(-1, 3), (faces + len(vertices) * np.arange(bodies)[:, None, None]).reshape(-1, 3)


def write_stl(path: Path, count: int, order: str = "") -> None:
    """Write a wavy torus as a binary STL file, its triangles in the order that is named; or many of them.

    `order` is nothing for row by row, "in two sweeps" for the first triangle of every two before the second ones,
    "shuffled" for a random order, and "in bodies" for many tori, each row by row.
    """
    vertices, faces = many_bodies(count) if order == "in bodies" else wavy_torus(count)
    if order == "in two sweeps":
        faces = np.concatenate([faces[::2], faces[1::2]])
    if order == "shuffled":
        faces = np.random.default_rng(0).permutation(faces)
    beside = path.with_suffix(".part")
    with beside.open("wb") as file:
        file.write(bytes(80) + len(faces).to_bytes(4, "little"))
        facets(vertices, faces).tofile(file)
    beside.replace(path)


if __name__ == "__main__":
    write_stl(Path(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
