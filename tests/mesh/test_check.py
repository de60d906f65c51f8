"""The check of a surface: each fault of a known solid is found, placed and put into words."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import Mesh, cube, cylinder, facets, inside_out, joined, moebius, part, sphere

import inertia
from inertia.errors import GeometryError
from inertia.mesh.check import check
from inertia.mesh.checks import surface_topology
from inertia.mesh.checks.findings import Finding, Report
from inertia.mesh.part import Part
from inertia.mesh.repair import repair
from inertia.mesh.surface import Surface
from inertia.once import checking_once

CUBE = cube((5, 5, 5), size=10)


def changed(mesh: Mesh, *, without: tuple = (), turned: tuple = (), added: list | None = None) -> Mesh:
    vertices, faces = mesh[0], mesh[1].copy()
    faces[list(turned)] = faces[list(turned), ::-1]
    return vertices, np.vstack([np.delete(faces, without, axis=0), np.reshape(added or [], (-1, 3)).astype(int)])


def codes(report: Report, severity: str | None = None) -> list[str]:
    return [finding.code for finding in report.findings if severity in (None, finding.severity)]


def only(report: Report, code: str, severity: str = "error") -> Finding:
    (matches,) = (f for f in report.findings if f.code == code and f.severity == severity)
    return matches


def state(report: Report) -> tuple[bool, bool, bool | None, int, int]:
    return report.closed, report.consistent, report.outward, report.bodies, len(report.shells)


def test_a_sound_cube_has_nothing_to_find() -> None:
    report = check(part(CUBE))
    assert (report.triangles, report.vertices, report.findings, report.loops) == (12, 8, (), ())
    assert state(report) == (True, True, True, 1, 1)
    assert report.fit
    report.require_fit()


def test_binary_records_are_welded_and_checked_alike() -> None:
    report = check(part(facets(joined(changed(CUBE, without=(3,))))))
    assert (report.triangles, report.vertices) == (11, 8)
    assert codes(report) == ["open"]


def test_a_missing_triangle_is_an_open_loop_with_its_place() -> None:
    report = check(part(changed(CUBE, without=(3,)), unit="in"))
    assert state(report) == (False, True, None, 1, 0)
    finding = only(report, "open")
    assert finding.place == pytest.approx((6.4645, 6.4645, 10), abs=1e-4)
    assert finding.message == (
        f"open: 1 boundary loop, 34.14 in around (6.464, 6.464, 10.0) at triangle {finding.faces[0]}: close "
        "the mesh, or use shell=THICKNESS or inertia.repair(part)"
    )
    with pytest.raises(GeometryError) as error:
        report.require_fit(orientation="absolute")
    assert str(error.value) == f"bracket.stl: {finding.message}"


def test_of_several_loops_the_longest_is_named() -> None:
    report = check(part(changed(CUBE, without=(3, 4, 5))))
    assert [loop.edges for loop in report.loops] == [4, 3]
    assert "open: 2 boundary loops, the longest 40 mm around (5.0, 0.0, 5.0) at" in report.findings[0].message
    assert (report.findings[0].count, report.findings[0].place) == (2, (5, 0, 5))


def test_a_crack_at_a_t_junction_is_open() -> None:
    vertices = np.vstack([CUBE[0], [10, 5, 10]])
    report = check(part((vertices, changed(CUBE, without=(3,), added=[[5, 8, 6], [8, 7, 6]])[1])))
    assert codes(report) == ["open"]
    assert (report.loops[0].edges, report.loops[0].place) == (3, (10, 5, 10))


def test_a_turned_triangle_is_inconsistent() -> None:
    report = check(part(changed(CUBE, turned=(3,))))
    assert state(report) == (True, False, None, 1, 0)
    finding = only(report, "inconsistent_winding")
    assert finding.count == 3
    assert set(finding.faces) == {2, 3, 7, 11}
    assert finding.place in {(10, 5, 10), (5, 10, 10), (5, 5, 10)}
    assert "triangles 2 and 3" in finding.message


def test_a_moebius_strip_is_open_and_inconsistent() -> None:
    report = check(part(moebius(12)))
    assert state(report) == (False, False, None, 1, 0)
    assert codes(report) == ["open", "inconsistent_winding"]
    assert [loop.edges for loop in report.loops] == [24]
    assert only(report, "inconsistent_winding").place == pytest.approx((4, 0, 0), abs=1e-12)


def test_inside_out_is_inward_and_can_be_turned() -> None:
    report = check(part(inside_out(CUBE)))
    assert state(report) == (True, True, False, 1, 1)
    finding = only(report, "inward")
    assert (finding.turnable, finding.place, finding.faces) == (True, (5, 5, 5), (0,))
    assert "the volume is -1000 mm³" in finding.message
    with pytest.raises(GeometryError, match="orientation='absolute'"):
        report.require_fit()
    report.require_fit(orientation="absolute")


def test_a_hollow_sphere_inside_out_is_one_inward_body() -> None:
    report = check(part(joined(inside_out(sphere()), sphere(radius=0.5))))
    assert state(report) == (True, True, False, 1, 2)
    assert codes(report, "error") == ["inward"]


def test_one_body_inside_out_beside_another() -> None:
    report = check(part(joined(CUBE, inside_out(cube((30, 5, 5), 10)))))
    assert state(report) == (True, True, None, 2, 2)
    finding = only(report, "inverted_body")
    assert (finding.count, finding.faces, finding.place, finding.turnable) == (1, (12,), (30, 5, 5), True)


def test_a_hollow_sphere_is_one_body_with_a_cavity() -> None:
    report = check(part(joined(sphere(radius=2), inside_out(sphere((0.5, 0, 0))))))
    assert state(report) == (True, True, True, 1, 2)
    assert codes(report) == ["cavity"]
    assert only(report, "cavity", "note").place == pytest.approx((0.5, 0, 0))
    assert report.fit


def test_an_insert_in_a_cavity_is_two_bodies() -> None:
    report = check(part(joined(cube(size=4), inside_out(sphere()), sphere())))
    assert state(report) == (True, True, True, 2, 3)
    assert report.fit
    assert codes(report, "note") == ["several_bodies", "cavity"]


def test_a_body_in_the_material_of_another_overlaps() -> None:
    report = check(part(joined(CUBE, cube((4, 5, 6), 2))))
    assert state(report) == (True, True, None, 2, 2)
    finding = only(report, "overlapping_bodies")
    assert (finding.faces, finding.place, finding.turnable) == ((12,), (4, 5, 6), True)
    report.require_fit(orientation="absolute")


def test_bodies_that_cross_overlap_whichever_way_they_are_wound() -> None:
    for turn in (lambda mesh: mesh, inside_out):
        report = check(part(joined(turn(CUBE), turn(cube((12, 9, 8), 10)))))
        finding = only(report, "overlapping_bodies")
        assert (finding.count, finding.faces, finding.turnable) == (1, (0, 12), False)
        low, high = (7, 4, 3), (10, 10, 10)
        assert all(a <= x <= b for a, x, b in zip(low, finding.place, high, strict=True))
        assert "overlapping_bodies" in [fault.code for fault in report.faults("absolute")]


def test_plates_that_overlap_within_common_faces_overlap() -> None:
    report = check(part(joined(CUBE, cube((11, 5, 5), 10))))
    assert codes(report, "error") == ["overlapping_bodies"]


def test_bodies_that_only_nest_in_boxes_do_not_overlap() -> None:
    frame = [cube((x, y, 0), 1) for x in (-3, 3) for y in (-3, 3)]
    report = check(part(joined(*frame, sphere(radius=2.5))))
    assert (report.fit, report.bodies) == (True, 5)


def test_a_cavity_through_the_wall_crosses_it() -> None:
    report = check(part(joined(sphere(radius=2, splits=0), inside_out(cube((0.3, 0.3, 0.3), 1)))))
    assert report.bodies == 1
    finding = only(report, "overlapping_bodies")
    assert "crossing cavities" in finding.message
    assert sum(finding.place) == pytest.approx(2)
    assert min(finding.faces) < 8 <= max(finding.faces)


def test_cavities_that_cross_each_other() -> None:
    pores = [inside_out(cube((x, x, 5), 2)) for x in (4, 5)]
    report = check(part(joined(CUBE, *pores)))
    assert codes(report, "error") == ["overlapping_bodies"]
    assert set(only(report, "overlapping_bodies").faces) <= set(range(12, 36))


@pytest.mark.parametrize(
    ("beside", "warnings"),
    [
        ((15, 15, 15), []),
        ((15, 15, 5), ["non_manifold_edge"]),
        ((15, 5, 5), ["duplicate_face", "non_manifold_edge"]),
    ],
    ids=["vertex", "edge", "face"],
)
def test_cubes_that_touch_are_two_bodies(beside: tuple, warnings: list[str]) -> None:
    report = check(part(joined(CUBE, cube(beside, 10))))
    assert state(report) == (True, True, True, 2, 2)
    assert sorted(codes(report, "warning")) == sorted(warnings)
    assert report.fit


def test_the_edge_at_which_cubes_touch_is_placed() -> None:
    finding = only(check(part(joined(CUBE, cube((15, 15, 5), 10)))), "non_manifold_edge", "warning")
    assert (finding.count, finding.place) == (1, (10, 10, 5))
    assert len(finding.faces) == 4


def test_a_triangle_stored_again_is_an_error() -> None:
    report = check(part(changed(CUBE, added=[CUBE[1][4]])))
    finding = only(report, "duplicate_face")
    assert report.findings[0] is finding
    assert (finding.faces, finding.place) == ((12,), pytest.approx((10 / 3, 0, 10 / 3)))
    assert not report.closed


def test_a_body_stored_again_is_an_error_that_turning_does_not_mend() -> None:
    report = check(part(joined(CUBE, CUBE)))
    assert (report.closed, report.consistent) == (True, True)
    assert [fault.code for fault in report.faults("absolute")] == ["duplicate_face"]


def test_an_inner_wall_is_an_error() -> None:
    report = check(part(changed(CUBE, added=[[2, 3, 5], [2, 5, 4]])))
    finding = only(report, "non_manifold_edge")
    assert state(report) == (False, True, None, 1, 0)
    assert finding.count == 4
    assert {12, 13} & set(finding.faces)


@pytest.mark.parametrize("order", ["body by body", "face by face"])
def test_both_sides_of_every_face_have_no_volume(order: str) -> None:
    faces = np.stack([CUBE[1], CUBE[1][:, ::-1]], axis=0 if order == "body by body" else 1).reshape(-1, 3)
    report = check(part((CUBE[0], faces)))
    assert codes(report, "error") == ["zero_volume"]
    assert report.findings[0].place == (5, 5, 5)
    with pytest.raises(GeometryError, match="no volume"):
        report.require_fit(orientation="absolute")


def test_a_rim_filled_twice_has_no_volume_however_it_is_rounded() -> None:
    turn = 2 * np.pi * np.arange(30) / 30
    rim = np.outer(np.cos(turn), [0.6, 0.0, 0.8]) + np.outer(np.sin(turn), [0.48, 0.8, -0.36]) + 1 / 3
    one, other = ([[k, (k + i) % 30, (k + i + 1) % 30] for i in range(1, 29)] for k in (0, 11))
    report = check(part((rim, np.vstack([one, np.array(other)[:, ::-1]]))))
    assert (codes(report, "error"), report.bodies) == (["zero_volume"], 0)


def test_a_sheet_beside_a_body_is_a_warning() -> None:
    sheet = (np.array([[20, 0, 0], [23, 0, 0], [20, 3, 0]], float), np.array([[0, 1, 2], [0, 2, 1]]))
    report = check(part(joined(CUBE, sheet)))
    assert (report.fit, report.bodies) == (True, 1)
    finding = only(report, "zero_volume", "warning")
    assert (finding.faces, finding.place) == ((12,), (21.5, 1.5, 0))


def test_a_repeated_corner_and_a_line_are_told_apart() -> None:
    vertices = np.vstack([CUBE[0], [5, 0, 0]])
    filled = [[0, 2, 8], [8, 2, 1], [0, 8, 1]]  # the last fills the crack along edge 0, 1
    report = check(part((vertices, changed(CUBE, without=(0,), added=[*filled, [7, 3, 7]])[1])))
    assert (report.fit, codes(report)) == (True, ["degenerate_face"] * 2)
    corner, line = report.findings
    assert ("repeated corner" in corner.message, "on a line" in line.message) == (True, True)
    assert (corner.faces, line.faces) == ((14,), (13,))
    assert (corner.place, line.place) == (pytest.approx((10, 10, 20 / 3)), (5, 0, 0))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e76])
def test_a_coordinate_that_is_no_usable_number(value: float) -> None:
    vertices = CUBE[0].copy()
    vertices[7, 1] = value
    report = check(part((vertices, CUBE[1])))
    finding = only(report, "non_finite")
    expected = np.flatnonzero((CUBE[1] == 7).any(axis=1))
    assert (finding.count, finding.faces) == (len(expected), tuple(expected))
    assert f"triangle {expected[0]}:" in finding.message
    assert not report.fit
    assert report.state == ("12 elements", "nothing else examined")


def test_no_triangles() -> None:
    assert codes(check(part(Surface(np.eye(3), np.empty((0, 3), int))))) == ["empty"]


def test_unused_vertices_are_a_note() -> None:
    report = check(part((np.vstack([[9, 9, 9], CUBE[0]]), CUBE[1] + 1)))
    assert (codes(report), report.findings[0].count, report.vertices) == (["unused_vertices"], 1, 8)


def test_a_shell_that_crosses_itself_is_found() -> None:
    vertices, faces = sphere(splits=2)
    tip = int(vertices[:, 2].argmax())
    pulled = vertices.copy()
    pulled[tip] = (0, 0, -2)  # through the opposite side
    report = check(part((pulled, faces)))
    finding = only(report, "self_intersection")
    assert report.crossings_examined
    unexamined = check(part((pulled, faces)), intersections=False)
    assert (codes(unexamined), unexamined.crossings_examined) == ([], False)
    assert set(np.flatnonzero((faces == tip).any(axis=1))) & set(finding.faces)
    pole, ring = np.unique(vertices[:, 2])[:2]  # the faces that the tip goes through lie between
    assert pole <= finding.place[2] <= ring
    assert codes(check(part((vertices, faces)))) == []


def test_self_intersections_are_not_those_of_different_bodies() -> None:
    report = check(part(joined(CUBE, cube((12, 9, 8), 10))), intersections=True)
    assert codes(report, "error") == ["overlapping_bodies"]


def test_open_pieces_that_cross_are_self_intersections() -> None:
    pieces = joined(changed(CUBE, without=(3,)), changed(cube((12, 9, 8), 10), without=(3,)))
    finding = only(check(part(pieces), intersections=True), "self_intersection")
    assert not check(part(pieces)).crossings_examined
    assert min(finding.faces) < 11 <= max(finding.faces)


NODE = st.integers(0, 7)


@settings(deadline=None, max_examples=200)
@given(st.lists(st.tuples(NODE, NODE, NODE), min_size=1, max_size=16), st.integers(0, 12))
def test_no_soup_raises_and_what_is_fit_has_every_edge_both_ways(soup: list, count: int) -> None:
    faces = np.vstack([CUBE[1][:count], soup])
    report = check(part((CUBE[0], faces)), intersections=True)
    uses = Counter((f[k], f[(k + 1) % 3]) for f in faces.tolist() if len(set(f)) == 3 for k in range(3))
    bounds = all(uses[edge] == uses[edge[::-1]] for edge in list(uses))
    assert (report.closed and report.consistent) == bounds
    assert bounds or not report.fit
    assert all(finding.count > 0 and len(finding.faces) <= 10 for finding in report.findings)


@pytest.mark.parametrize("scale", [1e-70, 1e-30, 1e30, 5e73])
def test_the_verdict_does_not_depend_on_the_unit(scale: float) -> None:
    surface = CASES["across"]
    report = check(part(Surface(surface.vertices * scale, surface.faces)), intersections=True)
    assert codes(report) == codes(check(part(surface)))


def test_several_faults_are_counted_in_the_error() -> None:
    report = check(part(changed(CUBE, without=(3,), turned=(8,))))
    assert codes(report, "error") == ["open", "inconsistent_winding"]
    with pytest.raises(GeometryError, match=r"^bracket\.stl: open: .* \(inertia\.check\(part\) lists 1 more fault\)$"):
        report.require_fit()


def test_arrays_in_memory_are_called_the_part() -> None:
    with pytest.raises(GeometryError, match=r"^the part: open: "):
        check(Part.from_arrays(CUBE[0], CUBE[1][1:])).require_fit()


@pytest.mark.parametrize(("offset", "words"), [(0, "(2.5, 5.0, 7.5)"), (1e6, "(1000002.5, 1000005.0, 1000007.5)")])
def test_places_are_written_to_the_scale_of_the_part(offset: float, words: str) -> None:
    inner = cube((2.5, 5, 7.5), 0.1)
    surface = joined(CUBE, inner)
    report = check(part(Surface(surface.vertices + offset, surface.faces)))
    assert f"around {words} " in report.findings[0].message


CASES = {
    "sound": joined(CUBE),
    "open": joined(changed(CUBE, without=(3,))),
    "turned": joined(changed(CUBE, turned=(3,))),
    "inward": joined(inside_out(CUBE)),
    "hollow": joined(CUBE, inside_out(sphere((5, 5, 5), 3, splits=1))),
    "nested": joined(CUBE, cube((4, 5, 6), 2)),
    "insert": joined(CUBE, inside_out(sphere((5, 5, 5), 3, splits=1)), sphere((5, 5, 5), 3, splits=1)),
    "apart": joined(CUBE, cube((16, 5, 5), 10)),
    "across": joined(CUBE, cube((12, 9, 8), 10)),
    "touching": joined(CUBE, cube((15, 5, 5), 10)),
}


@pytest.mark.parametrize("name", CASES)
@settings(deadline=None, max_examples=15)
@given(
    turn=st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(x * x for x in q) > 0.01),
    move=st.tuples(*[st.floats(-1e4, 1e4)] * 3),
    scale=st.floats(1e-6, 1e6),
)
def test_moving_a_part_does_not_change_the_verdict(name: str, turn: tuple, move: tuple, scale: float) -> None:
    x, y, z, w = np.array(turn) / np.linalg.norm(turn)
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    surface = CASES[name]
    # Points that are one before must be one after: each is moved alone, by the same arithmetic.
    moved = Surface(((surface.vertices[:, None] * rotation).sum(axis=2) + move) * scale, surface.faces)
    before, after = check(part(surface)), check(part(moved))
    assert codes(after) == codes(before)
    assert state(after) == state(before)
    assert after.vertices == before.vertices
    assert [f.count for f in after.findings] == [f.count for f in before.findings]


def test_a_cutter_that_sticks_out_is_no_body_to_be_turned() -> None:
    original = part(joined(cube(size=2), inside_out(cube((1, 0, 0)))))
    report = check(original)
    assert report.findings[0].message.startswith("overlapping bodies: 1 pair of bodies, one of each facing inward")
    assert [fault.code for fault in report.faults("absolute")] == ["overlapping_bodies"]
    with pytest.raises(GeometryError, match="share space, and one of them faces inward"):
        repair(original)


def test_an_insert_too_large_for_its_cavity_is_not_made_a_cavity() -> None:
    original = part(joined(cube(size=6), inside_out(cube(size=4)), cube(size=5)))
    report = check(original)
    (fault,) = report.faults("absolute")
    assert (fault.code, fault.count, fault.remedies[0].argument) == ("overlapping_bodies", 2, "union")
    with pytest.raises(GeometryError, match="cavities among them"):
        report.require_fit("absolute")
    mended = repair(original).part
    assert check(mended).fit
    assert np.linalg.det(mended.triangles.corners()).sum() / 6 == pytest.approx(216, rel=1e-14)


def klein_bottle(around: int = 24, along: int = 12) -> Mesh:
    """Return the figure-8 immersion: a figure 8 that makes half a turn on its way around, wound alike but at a seam."""
    u, v = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * (v + 0.25) / along
    from_axis = 3 + np.cos(a / 2) * np.sin(b) - np.sin(a / 2) * np.sin(2 * b)
    height = np.sin(a / 2) * np.sin(b) + np.cos(a / 2) * np.sin(2 * b)
    points = np.stack([from_axis * np.cos(a), from_axis * np.sin(a), height], axis=-1).reshape(-1, 3)
    faces = []
    for i in range(around):
        for j in range(along):
            seam = i + 1 == around
            # After a whole turn the curve is run through in the opposite sense, half a turn on.
            first, second = ((-j - k) % along if seam else (j + k) % along for k in (0, 1))
            here, above = i * along + j, i * along + (j + 1) % along
            beside, across = ((i + 1) % around * along + k for k in (first, second))
            faces += [[here, beside, across], [here, across, above]]
    return points, np.array(faces)


@pytest.mark.parametrize("seed", range(3))
def test_a_klein_bottle_is_closed_but_encloses_nothing(seed: int) -> None:
    vertices, faces = klein_bottle()
    bottle = part((vertices, np.random.default_rng(seed).permutation(faces) if seed else faces))
    report = check(bottle)
    assert (report.closed, report.consistent, report.fit) == (True, False, False)
    assert report.findings[0].code == "inconsistent_winding"
    with pytest.raises(GeometryError, match=r"inconsistent winding: the two triangles at 12 edges run the same way"):
        inertia.analyse(bottle)
    with pytest.raises(GeometryError, match="inconsistent winding"):
        inertia.analyse(bottle, orientation="absolute")
    with pytest.raises(GeometryError, match="one-sided"):
        inertia.repair(bottle)


def test_what_does_not_depend_on_the_way_a_part_is_checked_is_looked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    both = part(facets(joined(CUBE, cube((10, 10, 10), size=10))))
    ways: list[dict] = [{}, {"intersections": False}, {"parts": "separate"}, {"allowance": 1.0}]
    alone = [check(both, **way) for way in ways]
    looks = []
    merge = surface_topology.merge_equal_vertices
    monkeypatch.setattr(surface_topology, "merge_equal_vertices", lambda surface: looks.append(1) or merge(surface))
    with checking_once():
        again = [check(both, **way) for way in ways]
    for one, other in zip(alone, again, strict=True):
        assert [(f.message, f.faces, f.place) for f in one.findings] == [
            (f.message, f.faces, f.place) for f in other.findings
        ]
    assert len(looks) == 1


def test_within_a_context_for_it_a_part_is_checked_once_in_each_way() -> None:
    open_cube = part(changed(CUBE, without=(0,)))
    with checking_once():
        report = check(open_cube)
        with checking_once():
            assert check(open_cube) is report
        assert check(open_cube, parts="separate") is not report
        assert check(replace(open_cube)) is not report
    assert check(open_cube) is not report
    assert check(open_cube).findings == report.findings


def test_a_shell_that_crosses_itself_is_found_behind_thousands_of_bodies_that_cross() -> None:
    rng = np.random.default_rng(1)
    sticks = []
    for k in range(30):
        vertices, faces = cylinder(2.2, 0.2 + 0.003 * k)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        sticks.append(((vertices - [0, 0, 1.1]) @ (turn * np.linalg.det(turn)), faces))
    vertices, faces = cylinder(2.0, 0.5)
    vertices[-1, 2] = -1.0  # the middle of one end, pushed through the other
    report = check(part(joined(*sticks, (np.add(vertices, [10, 0, 0]), faces))), parts="separate")
    found = {finding.code: finding for finding in report.findings}
    assert found["self_intersection"].count == 24
