"""Half keys and full keys as point masses."""

import math

import pytest
from tests.mass.parts import surface

import inertia
from inertia import UsageError
from inertia.balancing.keys import Key
from inertia_meshes.shapes import box, moved

KEY = Key(width=8e-3, height=7e-3, length=40e-3, floor=11e-3, angle=math.radians(90), z=0.1, density=7850.0)


@pytest.mark.parametrize(("convention", "height"), [("H", 3.5), ("F", 7.0)])
def test_a_key_has_the_unbalance_of_the_box_that_it_is(convention, height):
    bar = moved(box(8, height, 40), 0, 11 + height / 2, 100)
    solid = inertia.mass_properties(surface(bar, unit="mm"), 7850.0)
    (mass,) = KEY.point_masses(convention)
    x, y, z = solid.center_of_mass
    assert (mass.mass, mass.z) == pytest.approx((solid.mass, z), rel=1e-12)
    assert mass.unbalance == pytest.approx(solid.mass * complex(x, y), rel=1e-12)


def test_without_a_key_there_is_no_mass():
    assert KEY.point_masses("N") == ()


def test_the_two_halves_are_the_key():
    (half,), (full,) = KEY.point_masses("H"), KEY.point_masses("F")
    upper = half.mass * (11e-3 + 0.75 * 7e-3) * 1j
    assert half.unbalance + upper == pytest.approx(full.unbalance, rel=1e-12)


def test_what_is_no_key_or_convention_is_refused():
    with pytest.raises(UsageError, match=r"'H' \(half key\), 'F' \(full key\) or 'N'"):
        KEY.point_masses("half")
    with pytest.raises(UsageError, match=r"the length of the key is 0\.0"):
        Key(8e-3, 7e-3, 0.0, 11e-3, 0.0, 0.1, 7850.0)
