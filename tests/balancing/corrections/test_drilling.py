"""Holes against numerical quadrature of their definition, and against the mesh that they are cut out of."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.balancing.corrections.workpieces import POINT, STEEL, drilled, on_z, plate, unbalance_of

from inertia.balancing.corrections.correction_plane import CorrectionPlane, point_length
from inertia.balancing.corrections.drilling import (
    AxialDrill,
    RadialDrill,
    axial_middle,
    axial_volume,
    radial_depth,
    radial_unbalance,
    radial_volume,
)
from inertia.mesh.cut import cut
from inertia.mesh.surface import Surface

HOLES = st.tuples(st.floats(0.02, 0.5), st.floats(0.02, 0.4), st.floats(0, 0.5), st.floats(0.5, math.pi))


def bottom(radius, depth, tip, half, rho):
    """Return the distance from the shaft of the hole's bottom, rho beside its axis."""
    return radius - depth - tip * (1 - rho / half)


def by_quadrature(radius, diameter, depth, angle, power):
    """Return ∬∫ s^power ds dA of a radial hole in a round part, by mpmath in polar coordinates about the hole."""
    half, tip = mpmath.mpf(diameter) / 2, mpmath.mpf(diameter) / 2 / mpmath.tan(mpmath.mpf(angle) / 2)

    def column(rho, phi):
        top = mpmath.sqrt(radius**2 - (rho * mpmath.sin(phi)) ** 2)
        low = bottom(radius, depth, tip, half, rho)
        return rho * (top ** (power + 1) - low ** (power + 1)) / (power + 1)

    return 4 * mpmath.quad(column, [0, half], [0, mpmath.pi / 2])


@pytest.mark.parametrize(
    ("radius", "diameter", "depth", "angle"),
    [
        (0.1, 0.012, 0.009, POINT),
        (0.08, 0.016, 0.0124, POINT),
        (0.05, 0.03, 0.02, math.radians(90)),
        (1, 0.8, 0.3, 3.1),
    ],
)
def test_a_radial_hole_takes_what_quadrature_says(radius, diameter, depth, angle):
    assert radial_unbalance(1.0, radius, diameter, depth, angle) == pytest.approx(
        float(by_quadrature(radius, diameter, depth, angle, 1)), rel=1e-12
    )
    assert radial_volume(radius, diameter, depth, angle) == pytest.approx(
        float(by_quadrature(radius, diameter, depth, angle, 0)), rel=1e-12
    )


def test_the_formula_of_the_reference_is_that_of_a_flat_face():
    tip = 8 / math.tan(math.radians(59))
    area, big, deep = math.pi * 64, 80.0, 12.4
    by_hand = 7.85e-3 * area * (big * deep - deep**2 / 2 + tip / 3 * (big - deep - tip / 4))  # g mm
    hole = radial_unbalance(STEEL, 0.08, 0.016, 0.0124, POINT, curved=False)
    assert 1e6 * hole == pytest.approx(by_hand, rel=1e-13)
    assert radial_volume(0.08, 0.016, 0.0124, POINT, curved=False) == pytest.approx(1e-9 * area * (deep + tip / 3))


@given(HOLES, st.booleans())
@settings(deadline=None)
def test_depth_is_the_inverse_of_unbalance(hole, curved):
    radius, width, share, angle = hole
    diameter = width * radius
    room = radius - point_length(diameter, angle)
    if room <= 0:
        return
    depth = share * room
    hole = radial_unbalance(STEEL, radius, diameter, depth, angle, curved=curved)
    assert radial_depth(STEEL, radius, diameter, hole, angle, curved=curved) == pytest.approx(depth, abs=1e-9 * radius)


def test_no_depth_takes_more_than_a_hole_to_the_axis():
    assert math.isnan(radial_depth(STEEL, 0.1, 0.01, 1.0, POINT))


def test_an_axial_hole_is_a_cylinder_and_a_cone():
    tip = point_length(0.012, POINT)
    cylinder, cone = math.pi * 0.006**2 * 0.01, math.pi * 0.006**2 * tip / 3
    assert axial_volume(0.012, 0.01, POINT) == pytest.approx(cylinder + cone, rel=1e-14)
    middle = (cylinder * 0.005 + cone * (0.01 + tip / 4)) / (cylinder + cone)
    assert axial_middle(0.012, 0.01, POINT) == pytest.approx(middle, rel=1e-14)


@pytest.mark.parametrize(("angle", "depth"), [(0.0, 0.003), (210.0, 0.0124), (77.7, 0.02)])
def test_a_radial_drill_takes_out_of_a_mesh_what_the_closed_form_says(angle, depth):
    part, shaft = plate(), on_z()
    tool = RadialDrill(drilled("I", 90, 100, 12), STEEL, diameter=0.012)
    solid = tool.solid(math.radians(angle), depth)
    left = cut(part, [Surface(1e3 * solid.vertices, solid.faces)])
    before, after = unbalance_of(part, shaft=shaft), unbalance_of(left, shaft=shaft)
    operation = tool.operation("I-1", math.radians(angle), depth)
    assert after.static - before.static == pytest.approx(operation.unbalance, rel=2e-6)
    assert after.couple_about(operation.unbalance_z) == pytest.approx(before.couple, abs=1e-6 * abs(after.static))
    assert before.mass - after.mass == pytest.approx(operation.mass, rel=2e-6)


def test_a_flat_face_formula_is_off_by_the_curved_entry_and_no_more():
    part = plate()
    tool = RadialDrill(drilled("I", 90, 100, 12), STEEL, diameter=0.012)
    solid = tool.solid(0.0, 0.01)
    hole = -unbalance_of(cut(part, [Surface(1e3 * solid.vertices, solid.faces)])).static.real
    missing = radial_unbalance(STEEL, 0.1, 0.012, 0.01, POINT, curved=False) - hole
    assert missing == pytest.approx(STEEL * math.pi * 0.012**4 / 128, rel=1e-3)


@pytest.mark.parametrize(("face", "z"), [("a", 0.08), ("b", 0.1)])
@pytest.mark.parametrize("through", [False, True])
def test_an_axial_drill_takes_out_of_a_mesh_what_the_closed_form_says(face, z, through):
    part = plate()
    plane = CorrectionPlane(
        "I", z, "drill_axial", 0.07, diameters=(0.01,), face=face, through=through, max_depth=0.02 if through else 0.015
    )
    tool = AxialDrill(plane, STEEL, diameter=0.01)
    depth = tool.greatest if through else 0.0123
    solid = tool.solid(1.0, depth)
    after = unbalance_of(cut(part, [Surface(1e3 * solid.vertices, solid.faces)]))
    operation = tool.operation("I-1", 1.0, depth)
    assert after.static == pytest.approx(operation.unbalance, rel=1e-9)
    assert after.couple_about(operation.unbalance_z) == pytest.approx(0, abs=1e-9 * abs(after.static))
    assert unbalance_of(part).mass - after.mass == pytest.approx(operation.mass, rel=1e-9)


def test_axial_depth_is_the_inverse_of_unbalance():
    plane = CorrectionPlane("I", 0.1, "drill_axial", 0.07, diameters=(0.01,), face="b")
    tool = AxialDrill(plane, STEEL, diameter=0.01)
    assert tool.setting(tool.unbalance(0.0123)) == pytest.approx(0.0123, rel=1e-12)


def test_neighbouring_radial_holes_keep_their_web_at_the_deepest_shoulder():
    plane = drilled("I", 90, 100, 12, max_depth=30)
    tool = RadialDrill(plane, STEEL, diameter=0.012)
    assert 2 * 0.07 * math.sin(tool.apart_at(tool.greatest) / 2) == pytest.approx(0.012 + plane.web)


@pytest.mark.parametrize("seed", range(30))
def test_radial_holes_of_other_depths_keep_their_web(seed):
    """By the distance of points of both axes: at the depth that is named it is what is asked for, and less beyond."""
    rng = np.random.default_rng(seed)
    radius, need, away = 0.1, rng.uniform(0.005, 0.08), rng.uniform(0.05, math.pi)
    setting = rng.uniform(0.0, 0.095)
    tool = RadialDrill(drilled("I", 90, 100, 12, max_depth=90), STEEL, diameter=0.012)
    (depth,) = tool.depth_beside(need, np.array([away]), setting).tolist()

    def apart(deep):
        one = np.linspace(radius - deep, radius, 4001)[:, None] * [1.0, 0.0]
        along = np.array([math.cos(away), math.sin(away)])
        foot = np.clip(one @ along, radius - setting, radius)
        return np.linalg.norm(one - foot[:, None] * along, axis=1).min()

    if depth < 0:
        assert apart(0.0) < need
    else:
        assert apart(min(depth, radius)) >= need * (1 - 1e-9)
        if depth < radius:
            assert apart(depth + 1e-5) < need
