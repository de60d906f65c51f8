import math
from dataclasses import replace

import numpy as np
import pytest
from tests.mesh.solids import box, cube, joined, ring

from inertia.errors import GeometryError
from inertia.mass.analyse import mass_properties
from inertia.mesh.check import check
from inertia.mesh.cut import SEGMENTS, block, cut, drill, stock
from inertia.mesh.part import Part, Regions
from inertia.mesh.surface import FACET, Facets, Surface


def volume(part: Part) -> float:
    return mass_properties(part, 1.0).volume / float(part.unit.metres) ** 3


def boxed(low, high, unit="mm") -> Part:
    return Part.from_arrays(*box(low, high), unit=unit)


def test_a_flat_drill_takes_exactly_the_volume_of_its_circle():
    part = boxed((-5, -5, 0), (5, 5, 8))
    rest = cut(part, [drill([0, 0, 3], [0, 0, 9], 4.0, 0.0)])
    assert volume(part) - volume(rest) == pytest.approx(math.pi * 4 * 5, rel=1e-13)


def test_a_pointed_drill_takes_its_cone_as_well():
    part = boxed((-5, -5, 0), (5, 5, 8))
    rest = cut(part, [drill([0, 0, 3], [0, 0, 9], 4.0, 1.2)])
    assert volume(part) - volume(rest) == pytest.approx(math.pi * 4 * (5 + 1.2 / 3), rel=1e-13)


def test_the_wall_of_a_hole_stays_as_near_to_the_circle_as_stated():
    ends = drill([0, 0, 0], [0, 0, 1], 2.0, 0.5).vertices[:SEGMENTS]
    radii = np.linalg.norm(ends[:, :2], axis=1)
    middles = np.linalg.norm((ends + np.roll(ends, 1, axis=0))[:, :2] / 2, axis=1)
    assert 0 < radii.max() - 1 < 8.1e-4
    assert 0 < 1 - middles.min() < 4.1e-4


def test_a_hole_in_any_direction_faces_outward_and_closes():
    along = np.array([1.0, 2.0, -2.0]) / 3
    rest = cut(boxed((-5, -5, -5), (5, 5, 5)), [drill(2 * along, 12 * along, 3.0, 0.7)])
    report = check(rest)
    assert report.fit
    assert report.bodies == 1


def test_what_the_tools_do_not_reach_keeps_its_coordinates_bit_for_bit():
    vertices, faces = ring(96, 32)
    part = Part.from_arrays(vertices + math.pi, faces)
    rest = cut(part, [block(np.array([3.5, -1, -1]) + math.pi, 3 * np.eye(3))])
    untouched = {tuple(k) for k in part.triangles.vertices.tolist() if k[0] < 3.4 + math.pi}
    assert untouched <= {tuple(k) for k in rest.triangles.vertices.tolist()}


def test_bodies_out_of_reach_stay_triangle_by_triangle():
    part = Part(joined(cube((0, 0, 0), 2.0), cube((9, 0, 0), 2.0)))
    rest = cut(part, [drill([0, 0, 0.5], [0, 0, 3], 0.5, 0.1)])
    far = np.array([k for k in rest.triangles.corners() if k[:, 0].min() > 5])
    assert np.array_equal(far, part.triangles.corners()[12:])


def test_only_the_body_that_the_tool_meets_is_cut_though_another_touches_it():
    part = Part(joined(box((0, 0, 0), (1, 1, 1)), box((1, 0, 0), (2, 1, 1))))
    rest = cut(part, [block([-1, 0.25, 0.25], np.diag([1.5, 0.5, 2.0]))])
    assert volume(rest) == pytest.approx(2 - 0.5 * 0.5 * 0.75, rel=1e-14)
    assert check(rest).bodies == 2


def test_a_cavity_that_is_opened_stays_open():
    inner = box((1, 1, 1), (3, 3, 3))
    part = Part(joined(box((0, 0, 0), (4, 4, 4)), (inner[0], inner[1][:, ::-1])))
    rest = cut(part, [block([1.5, 1.5, 2.5], np.diag([1.0, 1.0, 3.0]))])
    assert volume(rest) == pytest.approx(64 - 8 - 1, rel=1e-14)
    assert check(rest).bodies == 1


def test_unit_source_and_regions_are_kept_and_cut_walls_belong_to_their_body():
    surface = joined(cube((0, 0, 0), 2.0), cube((9, 0, 0), 2.0))
    regions = Regions(("disc", "hub"), np.repeat(np.array([1, 0], np.int32), 12))
    part = replace(Part(surface, notes=("read",)), regions=regions)
    rest = cut(part, [drill([0, 0, 0.5], [0, 0, 3], 0.5, 0.1)])
    assert (rest.unit, rest.source, rest.notes) == (part.unit, part.source, part.notes)
    assert rest.regions.names == regions.names
    near = rest.triangles.corners()[:, :, 0].max(axis=1) < 5
    assert (rest.regions.index[near] == 1).all()
    assert (rest.regions.index[~near] == 0).all()
    assert mass_properties(rest, {"disc": 1.0, "hub": 2.0}).mass == pytest.approx(
        1e-9 * (8 + 2 * (8 - math.pi * 0.0625 * (0.5 + 0.1 / 3))), rel=1e-12
    )


def test_cut_walls_of_a_body_with_several_regions_belong_to_none():
    index = np.zeros(12, np.int32)
    index[:2] = 1
    part = replace(Part(Surface(*cube((0, 0, 0), 2.0))), regions=Regions(("side", "base"), index))
    rest = cut(part, [drill([0, 0, 0.5], [0, 0, 3], 0.5, 0.1)])
    z = rest.triangles.corners()[:, :, 2]
    assert (rest.regions.index[(z == -1).all(axis=1)] == 1).all()
    walls = (np.abs(rest.triangles.corners()) < 0.99).all(axis=2).any(axis=1)
    assert (rest.regions.index[walls] == -1).all()
    assert (rest.regions.index[(z == 1).all(axis=1)] == 0).all()


def test_stl_records_are_cut_too():
    vertices, faces = cube((0, 0, 0), 2.0)
    records = np.zeros(12, FACET)
    facets = Facets(records)
    facets.corners_f4()[:] = vertices[faces]
    rest = cut(Part(facets), [block([0, -2, -2], 4 * np.eye(3))])
    assert volume(rest) == pytest.approx(4.0, rel=1e-14)


@pytest.mark.parametrize("scale", [1e-200, 1e150])
def test_coordinates_of_any_size_are_cut(scale):
    vertices, faces = cube((0, 0, 0), 2.0)
    rest = cut(Part.from_arrays(scale * vertices, faces), [block(scale * np.array([0, -2, -2]), 4 * scale * np.eye(3))])
    assert np.ptp(rest.triangles.corners(), axis=(0, 1)).tolist() == pytest.approx([scale, 2 * scale, 2 * scale])


def test_a_stock_is_cut_again_from_the_start():
    ready = stock(boxed((0, 0, 0), (2, 2, 2)))
    ready.cut([block([1, -1, -1], 4 * np.eye(3))])
    assert volume(ready.cut([block([-1, -1, 1.5], 4 * np.eye(3))])) == pytest.approx(6.0, rel=1e-14)


def test_refuses_to_leave_nothing():
    with pytest.raises(GeometryError, match=r"nothing is left of the body around .*: cut less deep"):
        cut(boxed((0, 0, 0), (1, 1, 1)), [block([-1, -1, -1], 4 * np.eye(3))])


def test_refuses_an_open_part():
    vertices, faces = cube()
    with pytest.raises(GeometryError, match="open"):
        cut(Part.from_arrays(vertices, faces[1:]), [])


def test_bodies_that_share_an_edge_are_cut_one_by_one():
    part = Part(joined(box((0, 0, 0), (1, 1, 1)), box((1, 1, 0), (2, 2, 1))))
    welded = np.unique(part.triangles.vertices, axis=0, return_inverse=True)
    touching = Part.from_arrays(welded[0], welded[1].reshape(-1)[part.triangles.faces])
    rest = cut(touching, [block([-1, -1, 0.5], np.diag([4.0, 4.0, 1.0]))])
    assert volume(rest) == pytest.approx(1.0, rel=1e-14)
