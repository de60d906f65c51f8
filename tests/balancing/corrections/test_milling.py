"""Flats and arcs against numerical quadrature of their definition, and against the mesh that they are cut out of."""

import math

import mpmath
import pytest
from tests.balancing.corrections.workpieces import STEEL, plate, unbalance_of

from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.milling import (
    ArcCutter,
    FlatCutter,
    arc_unbalance,
    arc_volume,
    flat_depth,
    flat_unbalance,
    flat_volume,
)
from inertia.errors import UsageError
from inertia.mesh.cut import cut
from inertia.mesh.surface import Surface


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


def swept(s, radius, depth, arc, cutter):
    """Return the angle that an arc takes at a distance from the shaft, from the cutter's circle at either end."""
    if cutter is None:
        return arc
    a = radius - depth + cutter / 2
    return arc + 2 * mpmath.acos(min(1, (s**2 + a**2 - (cutter / 2) ** 2) / (2 * s * a)))


@pytest.mark.parametrize("cutter", [None, 0.012, 0.05])
@pytest.mark.parametrize(("radius", "depth", "arc"), [(0.1, 0.002, 0.5), (0.05, 0.003, 2.4), (0.1, 0.001, 0.0)])
def test_an_arc_takes_what_quadrature_says(radius, depth, arc, cutter):
    low = radius - depth
    moment = mpmath.quad(lambda s: 2 * s**2 * mpmath.sin(swept(s, radius, depth, arc, cutter) / 2), [low, radius])
    volume = mpmath.quad(lambda s: s * swept(s, radius, depth, arc, cutter), [low, radius])
    assert arc_unbalance(3.0, radius, 0.01, depth, arc, cutter) == pytest.approx(0.03 * float(moment), rel=1e-7)
    assert arc_volume(radius, 0.01, depth, arc, cutter) == pytest.approx(0.01 * float(volume), rel=1e-7)


def arcs(cutter=None, **options):
    plane = CorrectionPlane("I", 0.088, "mill_arc", 0.1, width=0.012, max_depth=0.006, cutter=cutter, **options)
    return ArcCutter(plane, STEEL, depth=0.006)


@pytest.mark.parametrize("cutter", [None, 0.03])
@pytest.mark.parametrize(("angle", "arc"), [(0.0, 60.0), (200.0, 110.0), (350.0, 1.0)])
def test_an_arc_takes_out_of_a_mesh_what_the_closed_form_says(angle, arc, cutter):
    part = plate(sides=1440)
    tool = arcs(cutter)
    solid = tool.solid(math.radians(angle), math.radians(arc))
    after = unbalance_of(cut(part, [Surface(1e3 * solid.vertices, solid.faces)]))
    operation = tool.operation("I-1", math.radians(angle), math.radians(arc))
    assert after.static == pytest.approx(operation.unbalance, rel=2e-3)
    assert after.couple_about(operation.unbalance_z) == pytest.approx(0, abs=1e-9 * abs(after.static))
    assert unbalance_of(part).mass - after.mass == pytest.approx(operation.mass, rel=2e-3)


@pytest.mark.parametrize("cutter", [None, 0.03])
def test_the_arc_for_an_unbalance_is_the_inverse(cutter):
    tool = arcs(cutter)
    for degrees in (1.0, 50.0, 119.0):
        assert tool.setting(tool.unbalance(math.radians(degrees))) == pytest.approx(math.radians(degrees), rel=1e-9)
    assert math.isnan(tool.setting(2 * tool.unbalance(math.pi)))


def test_an_arc_is_no_longer_than_what_takes_most():
    tool = arcs(0.03, max_arc=math.pi)
    sizes = [tool.unbalance(tool.greatest * share) for share in (0.98, 1.0, 1.02)]
    assert sizes[1] == max(sizes)


def test_passes_and_ends_of_an_arc():
    operation = arcs(0.03, pass_depth=0.0025).operation("I-1", 1.0, 0.5)
    assert operation.passes == 3
    # The cutter's circle meets the rim where the triangle shaft, cutter, rim closes.
    a = 0.094 + 0.015
    reach = math.acos((0.1**2 + a**2 - 0.015**2) / (2 * 0.1 * a))
    assert operation.half_angle == pytest.approx(0.25 + reach, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"max_depth": None}, "a milled arc has no depth"),
        ({"width": None}, "a milled arc has no width"),
        ({"max_arc": 4.0}, "a longer arc than 180 degrees takes less again"),
        ({"min_depth": 0.01}, "min_depth 10 mm is more than max_depth 6 mm"),
        ({"cutter": 0.01}, "a cutter of 10 mm goes in deeper than half of it"),
    ],
)
def test_arcs_that_cannot_be_are_refused(change, sentence):
    fields = {"width": 0.012, "max_depth": 0.006} | change
    with pytest.raises(UsageError, match=sentence):
        CorrectionPlane("I", 0.088, "mill_arc", 0.1, **fields)
