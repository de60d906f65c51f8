"""Meshes of any size, place and shape, and the moments of their triangles in rational arithmetic to compare with."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from inertia.mass.moments import Moments
from inertia.mesh.surface import Triangles
from inertia_meshes import rational

OUTWARD = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])

seeds = st.integers(0, 2**32 - 1)
flattenings = st.one_of(st.just(1.0), st.floats(-12, 0).map(lambda power: 10.0**power))


def powers(most: int) -> st.SearchStrategy[float]:
    """Return powers of ten to scale by."""
    return st.one_of(st.just(0.0), st.floats(-most, most))


def offsets(most: int) -> st.SearchStrategy[float]:
    """Return how many times their size parts lie off, up to 10 to the power of `most`."""
    return st.one_of(st.just(0.0), st.floats(-2, most).map(lambda power: 10.0**power))


def placed(
    vertices: np.ndarray, seed: int, power: float, offset: float, thickness: float, width: float = 1.0
) -> np.ndarray:
    """Return the vertices flattened, turned (of an even seed), moved off and scaled."""
    rng = np.random.default_rng(seed)
    turn = np.eye(3) if seed % 2 else np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moved: np.ndarray = 10.0**power * ((vertices * [1.0, width, thickness]) @ turn + offset * rng.normal(size=3))
    return moved


def tetrahedra(count: int) -> np.ndarray:
    """Return the faces (4 count, 3) of tetrahedra that share no vertex."""
    faces: np.ndarray = (OUTWARD + 4 * np.arange(count)[:, None, None]).reshape(-1, 3)
    return faces


def true_moments(triangles: Triangles, moments: Moments) -> list[Fraction]:
    """Return the ten moments about the origin of others, in rational arithmetic."""
    exact = rational.moments(triangles.corners()).moved(*(-k for k in moments.origin))
    return [exact.volume, *exact.first, *exact.second]


def values_of(moments: Moments) -> list[Fraction]:
    return [moments.zeroth, *moments.first, *moments.second]


def bounds_of(moments: Moments) -> list[Fraction]:
    return [moments.zeroth_bound, *moments.first_bound, *moments.second_bound]


def assert_within_bounds(triangles: Triangles, moments: Moments) -> list[Fraction]:
    """Return the errors of the ten moments, none of which is beyond its bound."""
    pairs = zip(values_of(moments), true_moments(triangles, moments), strict=True)
    errors = [abs(value - true) for value, true in pairs]
    assert all(error <= bound for error, bound in zip(errors, bounds_of(moments), strict=True))
    return errors
