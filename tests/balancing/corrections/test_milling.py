"""Flats against numerical quadrature of their definition, and against the mesh that they are cut out of."""

import math

import mpmath
import pytest
from tests.balancing.corrections.workpieces import STEEL, plate, unbalance_of

from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.milling import FlatCutter, flat_depth, flat_unbalance, flat_volume
from inertia.mesh.cut import cut
from inertia.mesh.part import Surface


@pytest.mark.parametrize(("radius", "width", "depth"), [(0.1, 0.02, 0.003), (0.05, 0.01, 0.03), (1.0, 0.5, 0.99)])
def test_a_flat_takes_what_quadrature_says(radius, width, depth):
    def chord(s):
        return 2 * mpmath.sqrt(radius**2 - s**2)

    ends = [radius - depth, radius]
    volume, moment = (float(width * mpmath.quad(lambda s: s**power * chord(s), ends)) for power in (0, 1))  # noqa: B023
    assert flat_volume(radius, width, depth) == pytest.approx(volume, rel=1e-10)
    assert flat_unbalance(3.0, radius, width, depth) == pytest.approx(3 * moment, rel=1e-10)
    assert flat_depth(3.0, radius, width, 3 * moment) == pytest.approx(depth, rel=1e-10)


def test_no_depth_takes_more_than_half_of_the_round():
    assert math.isnan(flat_depth(STEEL, 0.1, 0.02, 1.001 * STEEL * 0.02 * 0.2**3 / 12))


@pytest.mark.parametrize("angle", [0.0, 200.0])
def test_a_cutter_takes_out_of_a_mesh_what_the_closed_form_says(angle):
    part = plate(sides=1440)
    tool = FlatCutter(CorrectionPlane("I", 0.088, "mill", 0.1, width=0.012, max_depth=0.02), STEEL)
    solid = tool.solid(math.radians(angle), 0.006)
    after = unbalance_of(cut(part, [Surface(1e3 * solid.vertices, solid.faces)]))
    operation = tool.operation("I-1", math.radians(angle), 0.006)
    assert after.static == pytest.approx(operation.unbalance, rel=2e-4)  # the chords' height over the flat's depth
    assert after.couple_about(operation.unbalance_z) == pytest.approx(0, abs=1e-9 * abs(after.static))
    assert unbalance_of(part).mass - after.mass == pytest.approx(operation.mass, rel=2e-4)


def test_two_of_the_deepest_flats_side_by_side_just_meet():
    tool = FlatCutter(CorrectionPlane("I", 0.088, "mill", 0.1, width=0.012, max_depth=0.02), STEEL)
    assert math.cos(tool.apart_at(tool.greatest) / 2) == pytest.approx(0.8)
