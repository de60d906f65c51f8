"""What a repair says that it did to the volume, the centre of mass and the tensor, against hand values."""

import math
from fractions import Fraction

import numpy as np
import pytest
from tests.benchmarks.meshes import wavy_torus
from tests.mass.parts import assert_within_bound, cells, cube, exact, facets, surface, weighed

import inertia
from inertia.errors import GeometryError, UsageError
from inertia.mass.triangles import sums
from inertia_meshes import catalogue, path
from inertia_meshes.rational import Moments, moments
from inertia_meshes.shapes import flipped, moved, sphere

EDGE = Fraction(1, 100)  # of the cubes among the samples, in metres
CUBE = moments(cube(-0.5, -0.5, -0.5)).scaled(EDGE, EDGE, EDGE)


def sample(name: str) -> inertia.Part:
    return inertia.read(path(f"broken/{name}.stl"))


def changes(repaired: inertia.Repaired) -> list[tuple[str, int]]:
    return [(change.what, change.count) for change in repaired.changes]


def tensor(solid: Moments) -> np.ndarray:
    return np.array([[float(value) for value in row] for row in solid.inertia])


def tensor_change(before: Moments, after: Moments) -> float:
    return float(np.linalg.norm(tensor(after) - tensor(before)) / np.linalg.norm(tensor(after)))


class TestBrokenSamples:
    @pytest.mark.parametrize("name", ["missing_face", "flipped_face", "inside_out"])
    def test_the_repaired_cube_is_the_cube(self, name):
        repaired = inertia.repair(sample(name))
        assert inertia.check(repaired.part).fit
        assert repaired.volume_after == pytest.approx(1e-6, rel=1e-15)
        assert_within_bound(inertia.mass_properties(repaired.part, 1.0), CUBE)
        assert repaired.part.unit == sample(name).unit
        assert repaired.part.source == sample(name).source

    def test_a_missing_face_is_filled(self):
        """Without triangle 4 the cone from the middle to it is missing: a twelfth of the cube."""
        repaired = inertia.repair(sample("missing_face"))
        assert changes(repaired) == [("holes filled", 1)]
        assert "3 edges" in repaired.changes[0].where
        corners = cube(-0.5, -0.5, -0.5)
        before = moments(np.delete(corners, 4, axis=0)).scaled(EDGE, EDGE, EDGE)
        assert before.volume == Fraction(11, 12) * EDGE**3
        assert repaired.volume_before == pytest.approx(float(before.volume), rel=1e-15)
        # The centroid of the missing cone lies at 3/4 of the way from the middle to the triangle's own.
        cone = Fraction(3, 4) * EDGE / 2 * np.array([1, Fraction(1, 3), Fraction(1, 3)])
        assert repaired.center_of_mass_shift == pytest.approx(math.hypot(*map(float, cone)) / 11, rel=1e-13)
        assert repaired.inertia_change == pytest.approx(tensor_change(before, CUBE), rel=1e-13)

    def test_a_flipped_face_is_turned_back(self):
        """The flipped triangle's cone counts negative: a twelfth is missing twice."""
        repaired = inertia.repair(sample("flipped_face"))
        assert changes(repaired) == [("triangles turned to agree with their neighbours", 1)]
        assert repaired.changes[0].where == "triangle 4"
        assert repaired.volume_before == pytest.approx(1e-6 * 10 / 12, rel=1e-14)
        corners = cube(-0.5, -0.5, -0.5)
        corners[4] = corners[4, ::-1]
        before = moments(corners).scaled(EDGE, EDGE, EDGE)
        shift = math.hypot(*map(float, before.center_of_mass))
        assert repaired.center_of_mass_shift == pytest.approx(shift, rel=1e-13)
        assert repaired.inertia_change == pytest.approx(tensor_change(before, CUBE), rel=1e-13)

    def test_an_inside_out_cube_is_turned(self):
        repaired = inertia.repair(sample("inside_out"))
        assert changes(repaired) == [("inside-out shells turned", 1)]
        assert repaired.volume_before == pytest.approx(-1e-6, rel=1e-15)
        assert repaired.center_of_mass_shift == 0.0
        assert repaired.inertia_change == pytest.approx(2.0, rel=1e-14)  # from −I to I

    def test_overlapping_cubes_are_united(self):
        repaired = inertia.repair(sample("overlapping_cubes"))
        assert changes(repaired) == [("overlapping bodies united", 2)]
        assert repaired.volume_before == pytest.approx(2e-9, rel=1e-14)
        assert repaired.volume_after == pytest.approx(1.875e-9, rel=1e-12)
        assert repaired.center_of_mass_shift == pytest.approx(0, abs=1e-15)
        true = catalogue()["broken/overlapping_cubes.stl"]["closed_form"]
        properties = inertia.mass_properties(repaired.part, 1.0)
        np.testing.assert_allclose(properties.inertia, true["inertia"], atol=1e-12 * true["inertia"][0][0])
        # Each cube has 1/6 + 1/8 about the common middle, along an axis; the union is known.
        corners = moments(np.concatenate([cube(), cube(0.5, 0.5, 0.5)])).scaled(*[Fraction(1, 1000)] * 3)
        change = np.linalg.norm(tensor(corners) - true["inertia"]) / np.linalg.norm(true["inertia"])
        assert repaired.inertia_change == pytest.approx(change, rel=1e-9)

    @pytest.mark.parametrize(("name", "what"), [("nan", "finite"), ("zero_volume", "bounds anything")])
    def test_what_is_no_solid_is_refused(self, name, what):
        with pytest.raises(GeometryError, match=rf"{name}\.stl cannot be repaired: .*{what}"):
            inertia.repair(sample(name))


class TestRepair:
    @pytest.mark.parametrize("name", [name for name, about in catalogue().items() if "wrong" not in about])
    def test_a_sound_sample_is_returned_as_it_is(self, name):
        part = inertia.read(path(name))
        if not catalogue()[name]["triangles"]:
            with pytest.raises(GeometryError, match="is a mesh of cells"):
                inertia.repair(part)
            return
        repaired = inertia.repair(part)
        assert repaired.part is part
        assert repaired.changes == ()
        assert repaired.volume_before == repaired.volume_after == inertia.mass_properties(part).volume
        assert repaired.center_of_mass_shift == 0.0
        assert repaired.inertia_change == 0.0

    def test_a_crack_is_closed_and_hardly_moves_the_answer(self):
        corners = cube()
        corners[5, 1] += 1e-9
        repaired = inertia.repair(surface(corners))
        assert ("vertices at cracks merged", 1) in changes(repaired)
        crack = next(change for change in repaired.changes if "cracks" in change.what)
        assert crack.largest_move == pytest.approx(math.sqrt(3) * 1e-9, rel=1e-6)
        # The corner is stored first where it belongs. Before, triangle 5 had it off by δ = 1e-9 (1, 1, 1), and its
        # cone a·(b × c)/6 from the middle was larger by δ·(c × a)/6, with a and c = (−1, 1, ∓1)/2.
        assert repaired.volume_after == 1.0
        assert repaired.volume_before - 1.0 == pytest.approx(-1e-9 / 6, rel=1e-6)
        # Of an open surface the moments depend on the point that the cones come from.
        before, after = (moments(moved(k, -0.5, -0.5, -0.5)) for k in (corners, cube()))
        shift = [float(b - a) for a, b in zip(before.center_of_mass, after.center_of_mass, strict=True)]
        assert repaired.center_of_mass_shift == pytest.approx(math.hypot(*shift), rel=1e-6)
        assert repaired.inertia_change == pytest.approx(tensor_change(before, after), rel=1e-6)

    def test_copies_of_triangles_are_removed(self):
        corners = np.concatenate([cube(), cube()[[3, 3, 7]]])
        repaired = inertia.repair(facets(corners))
        assert changes(repaired) == [("copies of triangles removed", 3)]
        assert repaired.changes[0].where == "triangles 12, 13, 14"
        assert (repaired.volume_before, repaired.volume_after) == (pytest.approx(1.25), pytest.approx(1.0))
        assert_within_bound(inertia.mass_properties(repaired.part, 1.0), moments(cube()))

    def test_a_body_stored_twice_is_one(self):
        repaired = inertia.repair(facets(sphere(1, 16), sphere(1, 16)))
        assert repaired.volume_before == pytest.approx(2 * repaired.volume_after, rel=1e-14)
        assert repaired.center_of_mass_shift == pytest.approx(0, abs=1e-15)
        assert repaired.inertia_change == pytest.approx(1, rel=1e-14)

    def test_an_inverted_body_among_others(self):
        """Volumes 1 and −1 leave nothing to take a centre of mass of."""
        repaired = inertia.repair(facets(cube(), flipped(cube(2))))
        assert changes(repaired) == [("inside-out shells turned", 1)]
        assert (repaired.volume_before, repaired.volume_after) == (0.0, 2.0)
        assert repaired.center_of_mass_shift is None
        assert repaired.inertia_change is None

    def test_an_unequal_one_has_a_shift(self):
        """Volumes 8 at 1 and −1 at 4.5: before (8 − 4.5)/7 = 1/2, after (8 + 4.5)/9 = 25/18 along x."""
        low = moved(cube(size=2), 0, -1, -1)
        small = moved(cube(), 4, -0.5, -0.5)
        repaired = inertia.repair(facets(low, flipped(small)))
        assert (repaired.volume_before, repaired.volume_after) == (7.0, 9.0)
        assert repaired.center_of_mass_shift == pytest.approx(25 / 18 - 1 / 2, rel=1e-14)
        before, after = weighed((low, 1), (small, -1)), weighed((low, 1), (small, 1))
        assert repaired.inertia_change == pytest.approx(tensor_change(before, after), rel=1e-14)

    def test_results_are_in_metres_and_far_away_too(self):
        corners = np.delete(moved(cube(), 1e6, 2e6, -1e6), 4, axis=0)
        near, far = (inertia.repair(surface(k, unit="in")) for k in (np.delete(cube(), 4, axis=0), corners))
        assert far.volume_after == pytest.approx(0.0254**3, rel=1e-15)
        assert far.volume_before == pytest.approx(near.volume_before, rel=1e-14)
        assert far.center_of_mass_shift == pytest.approx(near.center_of_mass_shift, rel=1e-13)
        assert far.inertia_change == pytest.approx(near.inertia_change, rel=1e-13)

    def test_the_size_of_the_part_does_not_matter(self):
        for scale in (2.0**-200, 2.0**200):
            repaired = inertia.repair(surface(np.delete(cube(), 4, axis=0) * scale))
            near = inertia.repair(surface(np.delete(cube(), 4, axis=0)))
            assert repaired.volume_after == pytest.approx(scale**3, rel=1e-14)
            assert repaired.center_of_mass_shift == pytest.approx(scale * near.center_of_mass_shift, rel=1e-14)
            assert repaired.inertia_change == pytest.approx(near.inertia_change, rel=1e-14)

    def test_the_notes_tell_what_was_done(self):
        part = inertia.repair(sample("missing_face")).part
        assert part.notes[-1].startswith("repaired: holes filled: 1")

    def test_regions_stay(self):
        part = surface(cube()[:6], cube()[6:-1], regions=["a", "b"])
        repaired = inertia.repair(part).part
        assert repaired.regions.names == ("a", "b")
        assert len(repaired.regions.index) == repaired.triangles.count == 12

    def test_a_tolerance_closes_a_wider_crack(self):
        corners = cube()
        corners[5, 1] += 1e-3
        repaired = inertia.repair(facets(corners), 0.01)
        assert changes(repaired) == [("vertices within the tolerance merged", 1)]
        assert_within_bound(inertia.mass_properties(repaired.part, 1.0), moments(cube()))

    @pytest.mark.parametrize("verb", [inertia.repair, inertia.weld])
    @pytest.mark.parametrize("tolerance", [0.0, -1e-3, math.nan, math.inf, 5.0])
    def test_an_unusable_tolerance_is_refused(self, verb, tolerance):
        with pytest.raises(UsageError, match="weld tolerance"):
            verb(surface(cube()), tolerance)

    @pytest.mark.parametrize("call", [inertia.repair, lambda part: inertia.weld(part, 0.1)])
    def test_cells_are_not_repaired(self, call):
        with pytest.raises(GeometryError, match=r"bar\.vtk is a mesh of cells"):
            call(cells("tetra", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))

    def test_an_open_sheet_stays_open(self):
        with pytest.raises(GeometryError, match=r"bracket\.obj cannot be repaired"):
            inertia.repair(surface(cube()[:2]))


class TestWeld:
    def test_nothing_near_is_nothing_done(self):
        part = inertia.read(path("cube.stl"))
        welded = inertia.weld(part, 1e-3)
        assert welded.part is part
        assert welded.changes == ()
        assert welded.volume_before == welded.volume_after == pytest.approx(1e-6, rel=1e-15)

    def test_a_crack_is_closed(self):
        corners = cube()
        corners[5, 1] += 1e-3
        part = facets(corners)
        welded = inertia.weld(part, 0.01)
        assert changes(welded) == [("vertices within the tolerance merged", 1)]
        move = math.dist(part.triangles.corners()[5, 1], cube()[5, 1])  # in float32
        assert welded.changes[0].largest_move == pytest.approx(move, rel=1e-15)
        assert welded.volume_after == 1.0
        assert inertia.check(welded.part).fit

    def test_it_does_nothing_else(self):
        corners = np.delete(cube(), 4, axis=0)
        corners[5, 1] += 1e-3
        welded = inertia.weld(facets(corners), 0.01)
        assert not inertia.check(welded.part).fit
        assert welded.volume_after == pytest.approx(11 / 12, rel=1e-15)  # the cone over a triangle is a twelfth

    def test_closeness_chains_and_the_answer_s_change_is_told(self):
        """Rings near the poles, whose vertices are close, shrink to a point each."""
        part = surface(sphere(1, 64))
        welded = inertia.weld(part, 0.03)
        (change,) = welded.changes
        assert change.largest_move > 0.03
        collapsed = part.triangles.count - welded.part.triangles.count
        assert f"{collapsed} triangles collapsed and left out" in change.where
        before, after = exact(part, 1), exact(welded.part, 1)
        assert welded.volume_after == pytest.approx(float(after.volume), rel=1e-14)
        assert welded.volume_before == pytest.approx(float(before.volume), rel=1e-14)
        assert welded.inertia_change == pytest.approx(tensor_change(before, after), rel=1e-12)
        shift = [float(b - a) for a, b in zip(before.center_of_mass, after.center_of_mass, strict=True)]
        assert welded.center_of_mass_shift == pytest.approx(math.hypot(*shift), abs=1e-15)


@pytest.mark.parametrize("limit", [100, 10**6], ids=["fine sums", "float64 sums"])
def test_parts_whose_sums_have_more_digits_are_repaired_too(limit: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sums, "MANY", limit)
    vertices, faces = wavy_torus(1500)
    whole = inertia.Part.from_arrays(vertices, faces, unit="m")
    volume = float(moments(whole.triangles.corners()).volume)
    turned = np.concatenate([faces[:7], faces[7:8, ::-1], faces[8:]])
    repaired = inertia.repair(inertia.Part.from_arrays(vertices, turned, unit="m"))
    assert [change.count for change in repaired.changes] == [1]
    assert repaired.volume_after == pytest.approx(volume, rel=1e-15)
    allowed = inertia.analyse(inertia.Part.from_arrays(vertices, faces[1:], unit="m"), 1.0, allow_faults=0.1)
    assert allowed.properties.volume == pytest.approx(volume, rel=allowed.properties.error.volume)
