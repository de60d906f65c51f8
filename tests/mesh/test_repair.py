"""Repairs with known answers: volumes by rational arithmetic, and every change that was to be made."""

import itertools
import math
from dataclasses import replace

import hypothesis
import numpy as np
import pytest
from hypothesis import strategies as st
from tests.mesh.solids import cylinder

from inertia.errors import GeometryError, UsageError
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.part import CellBlock, Cells, Part, Regions
from inertia.mesh.repair import Change, repair
from inertia.mesh.repairs.orientation import nest
from inertia.mesh.surface import FACET, Facets, Surface
from inertia_meshes.rational import moments
from inertia_meshes.shapes import Corners, band, box, circle, flipped, moved, revolved, sphere, torus


def cube(x: float = 0, y: float = 0, z: float = 0, size: float = 1) -> Corners:
    return moved(size * (box(1, 1, 1) + 0.5), x, y, z)


def part(*pieces: Corners) -> Part:
    """Return a part whose equal corners are one vertex, in order of use."""
    corners = np.concatenate(pieces)
    vertices, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Part(Surface(vertices, faces.reshape(-1, 3)))


def soup(*pieces: Corners) -> Part:
    corners = np.concatenate(pieces)
    return Part(Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))


def facets(corners: Corners) -> Part:
    records = np.zeros(len(corners), FACET)
    for k, name in enumerate(("x0", "y0", "z0", "x1", "y1", "z1", "x2", "y2", "z2")):
        records[name] = corners.reshape(-1, 9)[:, k]
    return Part(Facets(records))


def volume(part: Part) -> float:
    return float(moments(part.triangles.corners()).volume)


def uses(part: Part) -> dict[tuple[tuple[float, ...], ...], int]:
    """Count how much oftener each edge, by its coordinates, is used one way than the other."""
    surplus: dict[tuple[tuple[float, ...], ...], int] = {}
    for corners in part.triangles.corners().tolist():
        for k in range(3):
            u, v = tuple(corners[k]), tuple(corners[(k + 1) % 3])
            surplus[min(u, v), max(u, v)] = surplus.get((min(u, v), max(u, v)), 0) + (1 if u < v else -1)
    return {edge: count for edge, count in surplus.items() if count}


def changes(part: Part, **options) -> dict[str, int]:
    """Repair, see that the result is closed and a second repair finds nothing, and count the changes."""
    repaired = repair(part, **options)
    assert uses(repaired.part) == {}
    assert repair(repaired.part, **options).changes == ()
    return {change.what: change.count for change in repaired.changes}


SOUND = {
    "cube": part(cube()),
    "cube as binary STL": facets(cube()),
    "cube with a vertex for every corner": soup(cube()),
    "cubes apart": part(cube(), cube(3)),
    "cubes with a common face": part(cube(), cube(1)),
    "cubes with a common edge": part(cube(), cube(1, 1)),
    "cubes with a common corner": part(cube(), cube(1, 1, 1)),
    "hollow sphere": part(sphere(2, 16), flipped(sphere(1, 16))),
    "ball in a hollow sphere": part(sphere(2, 16), flipped(sphere(1, 16)), sphere(0.5, 16)),
    "insert in a cavity": part(sphere(2, 16), flipped(sphere(1, 16)), sphere(1, 16)),
    "torus": part(torus(3, 1, 16)),
    "far away": part(moved(sphere(1, 16), 1e6, 2e6, -3e6)),
}


class TestSound:
    @pytest.mark.parametrize("sound", SOUND.values(), ids=SOUND)
    def test_a_sound_part_comes_back_itself(self, sound):
        repaired = repair(sound)
        assert repaired.part is sound
        assert repaired.changes == ()

    def test_a_tolerance_below_every_distance_changes_nothing(self):
        original = part(cube())
        assert repair(original, tolerance=0.1).part is original


class TestVertices:
    def test_equal_vertices_become_one(self):
        original = soup(cube()[1:])
        assert changes(original) == {"vertices with equal coordinates joined": 25, "holes filled": 1}
        assert len(repair(original).part.triangles.vertices) == 8

    @pytest.mark.parametrize("shift", [1e-9, -1e-9, 1e-6])
    def test_a_crack_closes_without_being_asked(self, shift):
        corners = cube()
        corners[5, 1, 2] += shift
        original = facets(corners) if shift == 1e-6 else soup(corners)
        repaired = repair(original)
        crack = repaired.changes[-1]
        assert (crack.what, crack.count) == ("vertices at cracks merged", 1)
        stored = original.triangles.corners()[5, 1, 2]  # next to 1, in float64 or in the float32 of STL records
        assert crack.largest_move == abs(stored - 1)
        assert volume(repaired.part) == 1
        assert len(repaired.part.triangles.vertices) == 8

    def test_the_vertex_stored_first_stays(self):
        corners = cube()
        corners[11] += 1e-9
        assert volume(repair(soup(corners)).part) == 1

    def test_a_wider_crack_closes_within_the_tolerance(self):
        corners = cube()
        corners[5, 1] += 1e-3
        counts = changes(soup(corners), tolerance=0.01)
        assert counts["vertices within the tolerance merged"] == 1
        assert "holes filled" not in counts

    def test_a_wider_crack_is_filled_without_a_tolerance(self):
        corners = cube()
        corners[5, 1] += 1e-3
        assert changes(soup(corners))["holes filled"] == 1

    @pytest.mark.parametrize("size", [1.0, 1e6])
    @pytest.mark.parametrize("shift", [1e-5, 3e-4])
    def test_cracks_that_part_every_triangle_are_merged(self, size, shift):
        rng = np.random.default_rng(3)
        repaired = repair(soup(size * (cube() + shift * rng.uniform(-1, 1, (12, 3, 3)) / 2)))
        crack = repaired.changes[-1]
        assert crack.what == "cracks merged"
        assert 0 < crack.largest_move <= 3**0.5 * size * shift
        assert volume(repaired.part) == pytest.approx(size**3, rel=6 * shift)
        assert uses(repaired.part) == {}

    def test_what_is_sound_beside_cracks_is_left_alone_however_fine_it_is(self):
        """A rod of facets that are narrower than the cracks are wide."""
        rng = np.random.default_rng(3)
        cracked = cube() + 3e-4 * rng.uniform(-1, 1, (12, 3, 3)) / 2
        vertices, faces = cylinder(0.5, 0.02, 1024)
        rod = vertices[faces] + 3.0
        repaired = repair(soup(np.concatenate([cracked, rod])))
        assert repaired.changes[-1].what == "cracks merged"
        kept = repaired.part.triangles.corners()
        assert sorted(map(bytes, kept[kept.min(axis=(1, 2)) > 2])) == sorted(map(bytes, rod))
        assert volume(repaired.part) == pytest.approx(1 + np.pi * 0.02**2 * 0.5, rel=2e-3)

    def test_a_piece_among_cracks_and_holes_may_be_no_sheet(self):
        corners = cube() + np.array([1e-4, 0, 0]) * (np.arange(12) % 2)[:, None, None]
        with pytest.raises(GeometryError, match=r"remove this sheet, merge its corners with others by .*, or use "):
            repair(soup(corners[1:]))

    def test_triangles_that_collapse_are_recorded(self):
        n = 12
        sliver = band(circle(1, 0, n), circle(1, 1e-8, n))
        body = [
            band(np.zeros((n, 3)), circle(1, 0, n)),
            sliver,
            band(circle(1, 1e-8, n), np.tile([0, 0, 1.0], (n, 1))),
        ]
        body[0] = flipped(body[0][:, [0, 2, 1]])
        repaired = repair(part(*body), tolerance=1e-6)
        assert [(c.what, c.count) for c in repaired.changes] == [
            ("vertices within the tolerance merged", n),
            ("triangles that collapsed removed", 2 * n),
        ]
        assert uses(repaired.part) == {}

    @pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, 1.0])
    def test_unusable_tolerances_are_refused(self, tolerance):
        with pytest.raises(UsageError, match="weld tolerance"):
            repair(part(cube()), tolerance=tolerance)


class TestNeedlessTriangles:
    def test_repeated_corners(self):
        surface = part(cube()).triangles
        original = Part(Surface(surface.vertices, np.vstack([surface.faces, [[0, 0, 1], [2, 3, 2]]])))
        assert changes(original) == {"triangles with a repeated corner removed": 2}
        assert volume(repair(original).part) == 1

    @pytest.mark.parametrize("count", [1, 5, 12])
    def test_copies(self, count):
        original = part(cube(), cube()[:count])
        assert changes(original) == {"copies of triangles removed": count}
        assert volume(repair(original).part) == 1
        assert repair(original).changes[0].where.startswith("triangle")

    @pytest.mark.parametrize("count", [1, 2, 6])
    def test_copies_wound_the_other_way(self, count):
        original = part(cube(), flipped(cube()[:count]))
        assert changes(original) == {"copies of triangles, wound the other way, removed": count}
        assert volume(repair(original).part) == 1

    def test_fins(self):
        fin = np.array([[[1.0, 1, 0], [1, 1, 1], [2, 2, 0]], [[1, 1, 1], [2, 2, 1], [2, 2, 0]]])
        original = part(cube(), fin, flipped(fin))
        assert changes(original) == {"triangles of fins without thickness removed": 4}
        assert volume(repair(original).part) == 1

    def test_a_sheet_folded_on_itself_beside_a_body(self):
        sheet = np.array([[[3.0, 0, 0], [4, 0, 0], [3, 1, 0]]])
        assert changes(part(cube(), sheet, flipped(sheet))) == {"triangles of fins without thickness removed": 2}


class TestWinding:
    @hypothesis.given(st.sets(st.integers(0, 11), min_size=1, max_size=5))
    @hypothesis.settings(deadline=None, max_examples=30)
    def test_turned_triangles_are_turned_back(self, wrong):
        corners = cube()
        for triangle in wrong:
            corners[triangle] = corners[triangle, ::-1]
        repaired = repair(part(corners))
        assert [(c.what, c.count) for c in repaired.changes] == [
            ("triangles turned to agree with their neighbours", len(wrong))
        ]
        assert repaired.changes[0].where.endswith(f" {max(wrong)}")
        assert volume(repaired.part) == 1

    def test_in_a_tie_the_first_triangle_stays(self):
        corners = cube()
        corners[6:] = corners[6:, ::-1]
        repaired = repair(part(corners))
        assert repaired.part.triangles.corners()[0].tolist() == corners[0].tolist()
        assert [c.count for c in repaired.changes] == [6]

    def test_inside_out(self):
        original = part(flipped(cube()))
        assert changes(original) == {"inside-out shells turned": 1}
        assert volume(repair(original).part) == 1

    def test_inside_out_beside_a_sound_body(self):
        original = part(cube(), flipped(cube(3)))
        assert changes(original) == {"inside-out shells turned": 1}
        assert volume(repair(original).part) == 2

    @pytest.mark.parametrize(
        ("outer", "inner", "turned"), [(-1, 1, 2), (-1, -1, 1), (1, -1, 0)], ids=["both", "outer", "none"]
    )
    def test_a_hollow_body_stays_hollow(self, outer, inner, turned):
        pieces = [
            shell if sign > 0 else flipped(shell)
            for shell, sign in ((cube(), outer), (cube(0.25, 0.25, 0.25, 0.5), inner))
        ]
        repaired = repair(part(*pieces))
        assert sum(change.count for change in repaired.changes) == turned
        assert volume(repaired.part) == 0.875

    def test_coincident_bodies_that_are_inside_out_are_both_turned(self):
        # The mirror image of the cube is the cube, cut along other diagonals and inside out.
        original = part(flipped(cube()), cube()[:, :, [1, 0, 2]])
        assert changes(original) == {"inside-out shells turned": 2, "overlapping bodies united": 2}
        assert volume(repair(original).part) == 1

    def test_a_shell_without_volume_is_not_turned(self):
        a, b, c, d = np.array([[0, 0, 0], [1, 0.1, 0.3], [1.7, 1.3, 0.1], [0.7, 1.2, -0.2]]) / 7
        leaf = np.array([[a, b, c], [a, c, d], [b, a, d], [b, d, c]])
        for sides in (leaf, flipped(leaf)):
            assert repair(part(cube(), moved(sides, 0.3, 0.3, 3))).changes == ()

    def test_an_insert_is_inside_the_cavity_that_it_fills(self):
        depth = {"body": 0, "cavity": 1, "insert": 2}
        shells = {"body": sphere(2, 16), "cavity": flipped(sphere(1, 16)), "insert": sphere(1, 16)}
        for names in itertools.permutations(shells):
            surface = part(*(shells[name] for name in names)).triangles
            shell_nest = nest(surface.vertices, surface.faces, half_edges(surface.faces))
            assert [len(around) for around in shell_nest.containers] == [depth[name] for name in names]

    def test_a_moebius_strip_is_refused(self):
        turn = np.linspace(0, 2 * np.pi, 21)[:, None]
        along = np.hstack([np.cos(turn), np.sin(turn), 0 * turn])
        across = 0.3 * np.hstack([np.cos(turn / 2) * np.cos(turn), np.cos(turn / 2) * np.sin(turn), np.sin(turn / 2)])
        low, high = along - across, along + across
        low[-1], high[-1] = high[0], low[0]
        strip = np.concatenate(
            [
                np.stack([low[:-1], low[1:], high[1:]], axis=1),
                np.stack([low[:-1], high[1:], high[:-1]], axis=1),
            ]
        )
        with pytest.raises(GeometryError, match="one-sided"):
            repair(part(strip))


class TestHoles:
    @pytest.mark.parametrize("missing", [[0], [0, 1], [0, 1, 2, 3], [0, 5, 8]])
    def test_a_cube_gets_its_volume_back(self, missing):
        original = part(np.delete(cube(), missing, axis=0))
        assert set(changes(original)) == {"holes filled"}
        assert volume(repair(original).part) == 1

    def test_a_concave_hole_in_a_plane_is_filled_in_that_plane(self):
        outline = np.array([[0.0, 0], [4, 0], [4, 3], [3, 3], [3, 1], [2, 1], [2, 2], [1, 2], [1, 1], [0, 1]])
        rings = [np.column_stack([outline, np.full(10, z)]) for z in (0.0, 1.0)]
        original = part(band(*rings))
        assert changes(original) == {"holes filled": 2}
        x, y = outline.T
        assert volume(repair(original).part) == abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2

    def test_a_long_round_hole_is_filled_from_its_middle(self):
        n = 500
        original = part(revolved([(0, 0), (1, 0), (1, 1)], n))
        assert changes(original) == {"holes filled": 1}
        assert volume(repair(original).part) == pytest.approx(n / 2 * math.sin(2 * math.pi / n), rel=1e-12)

    def test_a_long_hole_that_is_not_flat_is_refused(self):
        n = 500
        rim = circle(1, 1, n)
        rim[:, 2] += 0.1 * np.sin(np.linspace(0, 6 * np.pi, n, endpoint=False))
        bowl = [flipped(band(circle(1, 0, n), np.zeros((n, 3)))), band(circle(1, 0, n), rim)]
        bowl[0] = flipped(bowl[0])
        with pytest.raises(GeometryError, match="500 edges and is not flat"):
            repair(part(*bowl))

    def test_two_holes_that_meet_at_a_vertex_are_filled_apart(self):
        corners = sphere(1, 12)
        pole = corners[np.argmax(corners[:, :, 2].max(axis=1))][np.newaxis]
        top = pole[0, pole[0, :, 2].argmax()]
        around = np.flatnonzero((corners == top).all(axis=2).any(axis=1))
        original = part(np.delete(corners, [around[0], around[4]], axis=0))
        assert changes(original) == {"holes filled": 2}
        assert volume(repair(original).part) == pytest.approx(volume(part(corners)), rel=1e-14)

    def test_a_vertex_on_the_edge_of_a_neighbour_leaves_the_volume_alone(self):
        corners = cube()
        a, b, c = corners[0]
        middle = (a + b) / 2
        original = part(corners[1:], np.array([[a, middle, c], [middle, b, c]]))
        assert changes(original) == {"holes filled": 1}
        assert volume(repair(original).part) == 1

    def test_an_inner_wall_is_faced_with_another(self):
        wall = np.array([[[0.0, 0, 0], [0, 0, 1], [1, 1, 1]], [[0, 0, 0], [1, 1, 1], [1, 1, 0]]])
        original = part(cube(), wall)
        assert changes(original) == {"holes filled": 1}
        assert volume(repair(original).part) == 1

    @pytest.mark.parametrize(
        "sheet",
        [
            np.array([[[0.0, 0, 0], [9, 0, 0], [9, 9, 0]], [[0, 0, 0], [9, 9, 0], [0, 9, 0]]]),
            band(circle(1, 0, 16), circle(1, 0.1, 16)),
        ],
        ids=["flat", "ring"],
    )
    def test_an_open_sheet_is_refused(self, sheet):
        for pieces in ((sheet,), (cube(20), sheet)):
            with pytest.raises(GeometryError, match=r"limit of 80% for a solid: .* shell=THICKNESS"):
                repair(part(*pieces))


class TestUnion:
    @pytest.mark.parametrize(
        ("second", "expected"),
        [
            (cube(0.5, 0.5, 0.5), 1.875),
            (cube(0.5, 0.5), 1.75),
            (cube(0.5), 1.5),
            (cube(0.25, 0.25, 0.25, 0.5), 1),
            (cube(size=0.5), 1),
        ],
        ids=["shifted along x, y, z", "along x, y", "along x", "inside", "flush in a corner"],
    )
    def test_overlapping_cubes_count_once(self, second, expected):
        original = part(cube(), second)
        assert changes(original) == {"overlapping bodies united": 2}
        assert volume(repair(original).part) == expected

    @pytest.mark.parametrize("scale", [1e-80, 1e70])
    def test_size_does_not_matter(self, scale):
        repaired = repair(part(cube(), cube(0.5, 0.5, 0.5)))
        scaled = repair(part(scale * cube(), scale * cube(0.5, 0.5, 0.5)))
        assert volume(scaled.part) == pytest.approx(scale**3 * volume(repaired.part), rel=1e-12)

    def test_the_other_bodies_keep_their_bits(self):
        third = sphere(1, 16) / 3 + 7
        repaired = repair(part(cube(), third, cube(0.5, 0.5, 0.5)))
        others = repaired.part.triangles.corners()[: len(third)]
        assert others.tobytes() == third.tobytes()

    def test_a_cavity_is_kept(self):
        original = part(cube(), flipped(cube(0.25, 0.25, 0.25, 0.5)), cube(0.875, 0.875, 0.875))
        assert changes(original) == {"overlapping bodies united": 2}
        assert volume(repair(original).part) == 1 - 0.5**3 + 1 - 0.125**3

    def test_bodies_of_different_regions_are_refused(self):
        original = part(cube(), cube(0.5, 0.5, 0.5))
        with pytest.raises(GeometryError, match="regions 'iron' and 'brass' overlap around"):
            repair(replace(original, regions=Regions(("iron", "brass"), np.repeat(np.int32([0, 1]), 12))))

    @pytest.mark.parametrize("order", [[0, 1], [1, 0], [-1, 1]])
    def test_copies_of_different_regions_are_refused_unless_these_are_alike(self, order):
        regions = Regions(("iron", "brass"), np.repeat(np.int32(order), 12))
        original = replace(part(cube(), cube()), regions=regions)
        with pytest.raises(
            GeometryError, match=r"triangles 12, .* another region.*'(iron|brass)'.* not known: leave one"
        ):
            repair(original)
        assert volume(repair(original, alike=True).part) == 1

    def test_bodies_of_regions_that_are_alike_are_united(self):
        regions = Regions(("iron", "brass"), np.repeat(np.int32([0, 1]), 12))
        assert volume(repair(replace(part(cube(), cube(0.5)), regions=regions), alike=True).part) == 1.5

    def test_a_union_is_of_the_region_of_its_bodies(self):
        original = part(cube(5), cube(), cube(0.5, 0.5, 0.5))
        repaired = repair(replace(original, regions=Regions(("iron", "brass"), np.repeat(np.int32([0, 1]), [12, 24]))))
        assert repaired.part.regions.index.tolist() == [0] * 12 + [1] * (repaired.part.triangles.count - 12)


class TestReport:
    def test_changes_are_sentences_and_become_notes(self):
        original = replace(part(np.delete(cube(), 0, axis=0)), notes=("read",))
        repaired = repair(original)
        (change,) = repaired.changes
        assert str(change).startswith("holes filled: 1 (of 3 edges around (")
        assert repaired.part.notes == ("read", f"repaired: {change}")
        assert (repaired.part.unit, repaired.part.source) == (original.unit, original.source)

    def test_a_move_is_told(self):
        assert str(Change("vertices merged", 2, "triangle 4", 1e-7)).endswith("(triangle 4), moved by at most 1e-07")

    def test_triangles_are_named_by_their_numbers_in_the_given_part(self):
        corners = cube()
        original = part(corners[:2], corners[:1], corners[2:7], flipped(corners[7:8]), corners[8:])
        assert [change.where for change in repair(original).changes] == ["triangle 2", "triangle 8"]

    def test_regions_follow_their_triangles(self):
        corners = cube()
        index = np.array([0] * 6 + [1] * 6 + [0], np.int32)
        original = replace(part(corners, corners[:1]), regions=Regions(("a", "b"), index))
        assert repair(original).part.regions.index.tolist() == [0] * 6 + [1] * 6

    def test_a_filling_is_of_the_region_around_the_hole(self):
        index = np.array([0] * 12 + [1] * 10, np.int32)
        original = replace(part(cube(), cube(3)[2:]), regions=Regions(("a", "b"), index))
        assert repair(original).part.regions.index.tolist() == [0] * 12 + [1] * 12


class TestRefusals:
    def test_nothing_left(self):
        sheet = np.array([[[3.0, 0, 0], [4, 0, 0], [3, 1, 0]]])
        for nothing in (part(sheet, flipped(sheet)), Part(Surface(np.empty((0, 3)), np.empty((0, 3), int)))):
            with pytest.raises(GeometryError, match="no triangle bounds anything"):
                repair(nothing)

    def test_coordinates_that_are_not_finite(self):
        corners = cube()
        corners[3, 1, 2] = np.nan
        with pytest.raises(GeometryError, match="triangle 3 has at corner 1"):
            repair(soup(corners))

    def test_a_mesh_of_cells(self):
        cells = Cells(np.eye(4, 3), (CellBlock("tetra", np.arange(4)[None]),))
        with pytest.raises(GeometryError, match="mesh of cells"):
            repair(Part(cells))
