"""§ 13.9: the perpendicular-axis theorem, I1 + I2 = I3 for what is flat and I1 + I2 ≥ I3 for every body."""

import math

import numpy as np
import pytest

import inertia
from inertia import MassProperties, lamina, mass_properties
from inertia_meshes import path


@pytest.mark.parametrize("outline", [[[0, 0], [3, 0], [0, 4]], [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]])
def test_perpendicular_axes(outline):
    i1, i2, i3 = lamina(outline, 2.0).principal_moments
    assert i1 + i2 == pytest.approx(i3, rel=1e-14)


def test_a_thin_plate_comes_near():
    i1, i2, i3 = mass_properties(inertia.read(path("thin_plate.stl"))).principal_moments
    assert i3 < i1 + i2 < i3 * (1 + 1e-5)


def test_a_needle():
    """½ m r² along and m (l²/12 + r²/4) across: the ratio goes as 6 (r/l)² to nothing."""
    radius, length = 1e-3, 1.0
    across = radius**2 / 4 + length**2 / 12
    needle = MassProperties(1.0, 1.0, [0, 0, 0], np.diag([across, across, radius**2 / 2]))
    assert needle.principal_moments[0] / needle.principal_moments[2] == pytest.approx(6 * radius**2, rel=1e-5)
    assert needle.principal.kind == "prolate"


def test_a_tensor_that_breaks_the_rule_is_refused():
    with pytest.raises(inertia.GeometryError, match="triangle rule"):
        MassProperties(1.0, 1.0, [0, 0, 0], np.diag([1.0, 1.0, 2.1]))
    assert MassProperties(1.0, 1.0, [0, 0, 0], np.diag([1.0, 1.0, 2.0])).radii_of_gyration[2] == math.sqrt(2)
