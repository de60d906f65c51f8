"""Thousands of random meshes: is any error larger than its bound, and how much larger is the bound than the error?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from inertia.errors import GeometryError
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh.surface import FACET, Facets, Surface, Triangles

from ..meshes import Faces, Vertices
from .cases import ball, slivers
from .rungs import RUNGS, properties, ratios, ratios_before_rounding
from .truth import Truth

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
SHAPES = ("tetrahedra", "star", "shell", "slivers")
OFFSETS, SCALES, FLAT, WALL = (-2, 10), (-50, 50), (-9, 0), (-9, -0.5)
"""Powers of ten: of the distance over the size, the size in millimetres, the thickness, and the wall."""
MILLIMETRE, STEEL = Fraction(1, 1000), Fraction(7850)
"""Neither factor is a power of two, so that mass and volume are rounded apart."""


@dataclass
class Tally:
    """Of each rung: how often it refused, and bound over error of each quantity."""

    refused: dict[str, int] = field(default_factory=lambda: dict.fromkeys(RUNGS, 0))
    ratios: dict[str, dict[str, list[float]]] = field(default_factory=lambda: {rung: {} for rung in RUNGS})

    def add(self, rung: str, ratios: dict[str, list[float]]) -> None:
        """Count the ratios of one mesh."""
        for quantity, values in ratios.items():
            self.ratios[rung].setdefault(quantity, []).extend(values)

    def exceeded(self) -> int:
        """Return how many errors were above their bounds."""
        return sum(ratio < 1 for result in self.ratios.values() for values in result.values() for ratio in values)


def sweep(seed: int, count: int) -> Tally:
    """Compare `count` random meshes with rational arithmetic, at every rung."""
    tally = Tally()
    for triangles in meshes(seed, count):
        truth = Truth.of(triangles.corners())
        body = truth.weighed(MILLIMETRE, STEEL)
        for rung in RUNGS:
            moments = solid_moments(triangles, rung)
            tally.add(rung, ratios_before_rounding(moments, truth))
            try:
                result = properties(moments, rung, MILLIMETRE, STEEL)
            except GeometryError:
                tally.refused[rung] += 1
                continue
            tally.add(rung, ratios(result, body, STEEL))
    return tally


def meshes(seed: int, count: int) -> Iterator[Triangles]:
    """Yield random closed meshes of 4 to 384 triangles; a tenth in float32."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        vertices, faces = _shape(rng, SHAPES[number % len(SHAPES)])
        vertices = _placed(rng, vertices, single=number % 10 == 9)
        if number % 10 != 9:
            yield Surface(vertices, faces)
            continue
        records = Facets(np.zeros(len(faces), FACET))
        records.corners_f4()[...] = vertices[faces]
        yield records


def _shape(rng: np.random.Generator, kind: str) -> tuple[Vertices, Faces]:
    if kind == "tetrahedra":
        corners = rng.uniform(-1, 1, (rng.integers(1, 9), 4, 3))
        inward = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
        corners[inward] = corners[inward][:, [1, 0, 2, 3]]
        faces = TETRAHEDRON + 4 * np.arange(len(corners))[:, None, None]
        return corners.reshape(-1, 3), faces.reshape(-1, 3)
    vertices, faces = ball(int(rng.integers(0, 3)))
    vertices = vertices * rng.uniform(0.5, 1, (len(vertices), 1))
    if kind == "shell":
        inner = vertices * (1 - 10 ** rng.uniform(*WALL))
        return np.concatenate([vertices, inner]), np.concatenate([faces, faces[:, ::-1] + len(vertices)])
    if kind == "slivers":
        return slivers((vertices, faces), 10 ** rng.uniform(-15, -1))
    return vertices, faces


def _placed(rng: np.random.Generator, vertices: Vertices, *, single: bool) -> Vertices:
    """Flatten, turn, move off and scale the vertices, each with some probability."""
    if rng.random() < 0.4:
        vertices = vertices * [1, 10 ** rng.uniform(*FLAT), 1] if rng.random() < 0.5 else _needle(rng, vertices)
    if rng.random() < 0.7:
        vertices = vertices @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    if rng.random() < 0.5:
        vertices = vertices + rng.normal(size=3) * 10 ** rng.uniform(*(OFFSETS if not single else (-2, 3)))
    return vertices if single or rng.random() < 0.5 else vertices * 10 ** rng.uniform(*SCALES)


def _needle(rng: np.random.Generator, vertices: Vertices) -> Vertices:
    thin = 10 ** rng.uniform(*FLAT)
    return vertices * [thin, 1, thin]
