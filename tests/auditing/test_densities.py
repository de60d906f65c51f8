"""Densities are found again from the whole that they make."""

import numpy as np
import pytest
from tests.auditing.shapes import context, pair, skewed

from inertia.auditing.bodies import together
from inertia.auditing.densities import invert


def test_two_densities_come_back() -> None:
    shapes = pair()
    whole = together([shapes[0].solid.weighed(1040.0), shapes[1].solid.weighed(7850.0)])
    densities = invert(context(shapes, whole))
    assert densities is not None
    assert densities.values == pytest.approx([1040.0, 7850.0], rel=1e-9)
    assert densities.residual < 1e-9
    assert densities.unique


def test_twice_the_same_shape_is_not_unique() -> None:
    shapes = [skewed(), skewed("copy.stl")]
    densities = invert(context(shapes))
    assert densities is not None
    assert densities.residual < 1e-9
    assert not densities.unique


def test_one_shape_has_no_choice() -> None:
    assert invert(context([skewed()])) is None


def test_densities_are_not_negative() -> None:
    shapes = pair()
    whole = together([shapes[0].solid.weighed(7850.0)])
    densities = invert(context(shapes, whole._replace(inertia=whole.inertia * 0.9)))
    assert densities is not None
    assert np.all(densities.values >= 0)
