"""The corners of triangles, however they are stored, against numpy's widening of single numbers."""

import numpy as np
import pytest

from inertia import native
from inertia.mesh.surface import FACET, Facets


def records(count: int) -> np.ndarray:
    """Return records of random bits: any number of single precision, subnormal, infinite and none."""
    words = np.random.default_rng(count).integers(0, 256, count * FACET.itemsize, np.uint8)
    return np.frombuffer(bytearray(words.tobytes()), FACET)


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("count", [0, 1, 2, 5_000])
def test_corners_are_widened_exactly(count: int, compiled: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    monkeypatch.setenv("INERTIA_NATIVE", "1" if compiled else "0")
    stored = records(count)
    names = [f"{axis}{corner}" for corner in range(3) for axis in "xyz"]
    with np.errstate(invalid="ignore"):
        expected = np.stack([stored[name].astype(np.float64) for name in names], axis=-1).reshape(-1, 3, 3)
    facets = Facets(stored)
    np.testing.assert_array_equal(facets.corners(), expected)
    np.testing.assert_array_equal(facets.corners(1, 4), expected[1:4])
    np.testing.assert_array_equal(facets.select(np.arange(count)[::-1]).corners(), expected[::-1])
