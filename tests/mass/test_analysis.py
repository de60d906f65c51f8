"""`analyse` and `mass_properties` against the catalogue, closed forms and rational arithmetic."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mass.parts import assert_within_bound, cells, cube, exact, facets, relative, surface

import inertia
from inertia.errors import GeometryError, ReadError, UsageError
from inertia.mass.triangles.moments_from_sums import moments_of
from inertia.mass.triangles.sums import sum_triangles
from inertia.mesh.part import Part
from inertia.mesh.surface import Facets
from inertia.report.analysis.document import analysis_document
from inertia.units import length_unit
from inertia_meshes import catalogue, path
from inertia_meshes.rational import moments
from inertia_meshes.shapes import flipped, mapped, moved, revolved, sphere, torus

SAMPLES = {name: about for name, about in catalogue().items() if "wrong" not in about}
SURFACES = [name for name, about in SAMPLES.items() if about["triangles"]]
ULP = 2.0**-52


class TestSamples:
    @pytest.mark.parametrize("name", SAMPLES)
    def test_the_answer_is_the_catalogue_s_within_its_bound(self, name):
        about = SAMPLES[name]
        unit = float(length_unit(about["unit"]).metres)
        result = inertia.analyse(inertia.read(path(name)))
        properties, mesh = result.properties, about["mesh"]
        assert properties.volume == pytest.approx(unit**3 * mesh["volume"], rel=properties.error.volume + ULP)
        assert properties.mass == pytest.approx(1000 * unit**3 * mesh["volume"], rel=properties.error.mass + ULP)
        com = unit * np.array(mesh["center_of_mass"])
        assert np.linalg.norm(
            properties.center_of_mass - com
        ) <= properties.error.center_of_mass + ULP * np.linalg.norm(com)
        tensor = 1000 * unit**5 * np.array(mesh["inertia"])
        off = np.linalg.norm(properties.inertia - tensor)
        assert off <= (properties.error.inertia + 2 * ULP) * np.linalg.norm(tensor)
        assert max(properties.error.volume, properties.error.mass, properties.error.inertia) < 2e-10
        assert (result.triangles, result.cells) == (about["triangles"], about.get("cells", 0))

    @pytest.mark.parametrize("name", SURFACES)
    def test_the_error_is_a_few_ulp(self, name):
        part = inertia.read(path(name))
        mass, tensor = relative(inertia.mass_properties(part), exact(part))
        assert mass <= 4 * ULP
        assert tensor <= 8 * ULP

    @pytest.mark.parametrize("name", SURFACES)
    def test_the_area_is_the_sum_of_the_triangles(self, name):
        part = inertia.read(path(name))
        a, b, c = part.triangles.corners().transpose(1, 0, 2)
        area = math.fsum(np.linalg.norm(np.cross(b - a, c - a), axis=1)) / 2
        assert inertia.analyse(part).area == pytest.approx(1e-6 * area, rel=1e-13)

    @pytest.mark.parametrize(
        ("name", "area"), [("cube.stl", 6e-4), ("box.stl", 2.8e-3), ("two_region_bar.vtk", 1.8e-3)]
    )
    def test_the_area_is_the_closed_form(self, name, area):
        assert inertia.analyse(inertia.read(path(name))).area == pytest.approx(area, rel=4 * ULP)

    @pytest.mark.parametrize("name", SURFACES)
    def test_bodies_and_closedness_are_the_catalogue_s(self, name):
        result = inertia.analyse(inertia.read(path(name)))
        assert result.bodies == SAMPLES[name]["bodies"]
        assert result.closed
        assert result.model == "solid"

    def test_the_extents_are_in_metres(self):
        extents = inertia.analyse(inertia.read(path("box.stl"))).extents
        np.testing.assert_array_equal(extents, [[0, 0, 0], [0.04, 0.02, 0.01]])

    def test_the_true_torus_is_as_far_as_its_tessellation(self):
        true = SAMPLES["torus.stl"]["closed_form"]
        part = inertia.read(path("torus.stl"))
        properties = inertia.mass_properties(part, 1.0)
        n = math.isqrt(part.triangles.count)  # segments of the ring, and half as many of the tube
        # A revolved polygon has n-gons for sections in place of circles, for which Pappus's theorem gives the volume.
        sections = n / 2 * math.sin(2 * math.pi / n) / math.pi
        tube = n / 4 * 25e-6 * math.sin(4 * math.pi / n)
        assert properties.volume == pytest.approx(sections * 2 * math.pi * 20e-3 * tube, rel=1e-6)  # stored in float32
        assert abs(properties.volume / true["volume"] - 1) > 1e3 * properties.error.volume

    def test_mass_properties_is_the_central_result(self):
        part = inertia.read(path("t_handle.stl"))
        properties, result = inertia.mass_properties(part, 7850.0), inertia.analyse(part, 7850.0)
        assert properties.mass == result.properties.mass
        np.testing.assert_array_equal(properties.inertia, result.properties.inertia)
        np.testing.assert_array_equal(properties.principal_moments, result.principal.moments)


BROKEN = {
    "missing_face.stl": (
        GeometryError,
        ["open: 1 boundary loop, 34.14 mm", "around (-5.0,", "triangle 0", "inertia.repair"],
    ),
    "flipped_face.stl": (
        GeometryError,
        ["inconsistent winding", "3 edges", "triangles 0 and 4", "around (", "turn the"],
    ),
    "inside_out.stl": (GeometryError, ["inside out", "-1000 mm³", "around (0.0, 0.0, 0.0)", "orientation='absolute'"]),
    "nan.stl": (GeometryError, ["triangle 4, corner 1", "nan", "export"]),
    "zero_volume.stl": (GeometryError, ["no volume", "around (0.0, 0.0, 5.0)", "shell=THICKNESS"]),
    "truncated.stl": (ReadError, ["12 triangles (684 bytes)", "454 bytes", "export it again"]),
    "overlapping_cubes.stl": (GeometryError, ["overlapping bodies: 1 pair", "triangles 0 and 12", "union=True"]),
}


class TestBrokenSamples:
    def test_every_broken_sample_is_tried(self):
        assert {f"broken/{name}" for name in BROKEN} == set(catalogue()) - set(SAMPLES)

    @pytest.mark.parametrize("name", BROKEN)
    def test_it_is_refused_with_file_place_and_remedy(self, name):
        kind, expected = BROKEN[name]
        with pytest.raises(kind) as refusal:
            inertia.analyse(inertia.read(path(f"broken/{name}")))
        message = str(refusal.value)
        assert type(refusal.value) is kind
        for phrase in (str(path(f"broken/{name}")), *expected):
            assert phrase in message
        assert "\n" not in message

    def test_the_hole_is_described(self):
        (loop,) = inertia.check(inertia.read(path("broken/missing_face.stl"))).loops
        assert loop.edges == 3
        assert loop.length == pytest.approx(20 + 10 * math.sqrt(2))

    def test_all_holes_are_counted_and_the_longest_located(self):
        corners = np.delete(np.concatenate([cube(), cube(5)]), [0, 1, 14], axis=0)
        with pytest.raises(GeometryError, match=r"open: 2 boundary loops, the longest 4 m around \(0\.5, 0\.5, 0\.0\)"):
            inertia.analyse(surface(corners))

    def test_an_empty_part_is_refused_by_name(self):
        for part in (surface(np.zeros((0, 3, 3))), facets(np.zeros((0, 3, 3)))):
            for options in ({}, {"shell": 1.0}, {"accuracy": "exact"}):
                with pytest.raises(GeometryError, match=r"^bracket\..*: there are no triangles: export"):
                    inertia.analyse(part, **options)

    def test_a_single_triangle_is_open(self):
        with pytest.raises(GeometryError, match=r"open: 1 boundary loop, 3\.414 m .* at triangle 0"):
            inertia.analyse(surface(cube()[:1]))

    def test_triangles_without_area_have_no_volume(self):
        part = inertia.Part.from_arrays([[0, 0, 0], [1, 1, 1]], [[0, 1, 1]])
        for options in ({}, {"shell": 1.0}):
            with pytest.raises(GeometryError, match=r"^the part"):
                inertia.analyse(part, **options)

    def test_a_flat_tetrahedron_is_refused(self):
        flat = np.array([[0, 0, 0.1], [1, 0, 0.1], [0, 1, 0.1], [1, 1, 0.1]])[
            [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
        ]
        with pytest.raises(GeometryError, match=r"no volume"):
            inertia.analyse(surface(flat))

    def test_what_float64_cannot_tell_from_zero_is_summed_with_more_digits(self):
        turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
        needle = surface(moved(mapped(cube() * [1e-8, 1e-8, 1.0], turn), 0.1, 0.2, 0.3))
        volume = moments(needle.triangles.corners()).volume
        assert moments_of(sum_triangles(needle.triangles)).zeroth_bound > volume
        for accuracy in (None, "exact"):
            assert inertia.mass_properties(needle, 1.0, accuracy=accuracy).mass == float(volume)


class TestDensity:
    def test_water_is_assumed_and_said(self):
        result = inertia.analyse(surface(cube()))
        assert (result.density, result.density_from, result.properties.mass) == (1000.0, "assumed", 1000.0)

    def test_a_density(self):
        result = inertia.analyse(surface(cube(), unit="mm"), 7850)
        assert (result.density, result.density_from) == (7850.0, "option")
        assert result.properties.mass == 7.85e-6

    def test_a_material(self):
        result = inertia.analyse(surface(cube()), material="Steel")
        assert (result.density, result.density_from, result.properties.mass) == (7850.0, "material", 7850.0)

    def test_a_weighed_mass_is_the_answer_to_the_last_bit(self):
        part = inertia.read(path("t_handle.stl"))
        result = inertia.analyse(part, mass=1.2)
        assert result.properties.mass == 1.2
        assert result.density_from == "mass"
        truth = exact(part, 1)
        assert result.density == pytest.approx(float(Fraction(1.2) / truth.volume), rel=4 * ULP)
        assert_within_bound(result.properties, truth.weighted(Fraction(1.2) / truth.volume), truth.volume)

    @pytest.mark.parametrize("density", [0, -1, math.nan, math.inf, "heavy"])
    def test_an_unusable_density_is_refused(self, density):
        with pytest.raises(UsageError, match="density is"):
            inertia.analyse(surface(cube()), density)

    @pytest.mark.parametrize(
        "options", [{"mass": 0}, {"mass": math.nan}, {"mass": 1, "density": 2}, {"material": "stel"}]
    )
    def test_contradictions_and_typing_errors_are_refused(self, options):
        with pytest.raises(UsageError):
            inertia.analyse(surface(cube()), **options)


class TestAccuracy:
    def test_exact_is_correctly_rounded(self):
        part = inertia.read(path("t_handle.stl"))
        properties = inertia.mass_properties(part, 2700.0, accuracy="exact")
        truth = exact(part, 2700)
        assert properties.volume == float(truth.volume / 2700)
        assert properties.mass == float(truth.volume)
        assert properties.center_of_mass.tolist() == [float(x) for x in truth.center_of_mass]
        assert properties.inertia.tolist() == [[float(x) for x in row] for row in truth.inertia]
        assert properties.error.method == "exact (integer arithmetic)"
        assert max(properties.error.volume, properties.error.mass, properties.error.inertia) == 2.0**-53

    @settings(deadline=None, max_examples=60)
    @given(st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 3), min_size=4, max_size=4))
    def test_exact_holds_for_any_tetrahedron(self, points):
        corners = np.array(points)[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
        volume = moments(corners).volume
        if volume < 0:
            corners = flipped(corners)
        if abs(volume) < Fraction(1, 10**40) or len(set(points)) < 4:
            return
        part = surface(corners)
        properties = inertia.mass_properties(part, accuracy="exact")
        truth = exact(part)
        assert properties.mass == float(truth.volume)
        assert properties.inertia.tolist() == [[float(x) for x in row] for row in truth.inertia]

    def test_an_accuracy_within_reach_is_met(self):
        part = inertia.read(path("sphere.stl"))
        error = inertia.mass_properties(part, accuracy=1e-12).error
        assert max(error.volume, error.mass, error.inertia) <= 1e-12

    def test_nothing_dearer_runs_than_the_accuracy_needs(self):
        part = inertia.read(path("t_handle.stl"))
        error = inertia.mass_properties(part).error
        reached = max(error.volume, error.mass, error.inertia)
        assert inertia.mass_properties(part, accuracy=reached).error == error
        finer = inertia.mass_properties(part, accuracy=0.999 * reached).error
        assert finer.method.startswith("double-double")
        assert max(finer.volume, finer.mass, finer.inertia) < 1.2e-16

    def test_exact_runs_where_double_double_cannot_certify(self):
        needle = mapped(cube(), [[1, 0, 0], [0, 1e-40, 0], [0, 0, 1e-40]])
        slanted = mapped(needle, [[1, 2.0**-60, 0], [1, 1, 0], [0, 0, 1]])
        properties = inertia.mass_properties(surface(slanted), accuracy=1e-15)
        assert properties.error.method.startswith("exact")
        assert properties.volume == pytest.approx(float(exact(surface(slanted)).volume), rel=1e-15)

    def test_an_accuracy_out_of_reach_is_refused_with_what_was_reached(self):
        tiny = surface(mapped(cube(), np.eye(3) * 1e-63))
        with pytest.raises(
            GeometryError, match=r"the bound of the tensor reached by exact .* is .*, above .* 1e-15: ask for a larger"
        ):
            inertia.mass_properties(tiny, accuracy=1e-15)

    @pytest.mark.parametrize("distance", [10, 1e3, 1e6, 1e12])
    def test_a_part_far_away_is_judged_by_what_is_known_of_it(self, distance):
        part = surface(moved(mapped(cube(), np.diag([1.0, 1.5, 0.75])), distance, distance / 3, -distance / 7))
        part = inertia.Part.from_arrays(part.triangles.corners().reshape(-1, 3), np.arange(36).reshape(-1, 3))
        true = exact(part)
        for accuracy in (1.2e-16, "exact"):
            analysis = inertia.analyse(part, accuracy=accuracy)
            pair, bound = analysis.properties.center_of_mass_pair()
            assert bound <= 1.2e-16
            off = [
                Fraction(high) + Fraction(low) - k
                for high, low, k in zip(*pair.tolist(), true.center_of_mass, strict=True)
            ]
            assert sum(k * k for k in off) <= Fraction(bound) ** 2
            document = analysis_document(analysis)
            assert document["center_of_mass"] == pair[0].tolist()
            assert document["center_of_mass_low"] == pair[1].tolist()
            assert document["error"]["center_of_mass_pair"] == bound

    @pytest.mark.parametrize("name", ["sphere.stl", "torus.stl", "two_disc_rotor.stl"])
    def test_a_shell_is_answered_to_the_last_digit(self, name):
        part = inertia.read(path(name))
        properties = inertia.mass_properties(part, 1.0, shell=1.0, accuracy=1.2e-16)
        assert properties.error.method.startswith("double-double")
        metres = float(part.unit.metres)
        with mpmath.workdps(50):
            area, first = mpmath.mpf(0), mpmath.matrix(3, 1)
            for corners in part.triangles.corners().tolist():
                a, b, c = (mpmath.matrix(corner) for corner in corners)
                u, v = b - a, c - a
                n = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
                size = mpmath.sqrt(sum(k * k for k in n)) / 2
                area += size
                first += size * (a + b + c) / 3
            unit = mpmath.mpf(part.unit.metres.numerator) / part.unit.metres.denominator
            mass = area * unit**3
            assert abs(properties.mass - mass) <= properties.error.mass * mass
            pair, bound = properties.center_of_mass_pair()
            for k in range(3):
                assert abs(mpmath.mpf(pair[0, k]) + pair[1, k] - first[k] / area * unit) <= bound <= 1e-16 * metres

    @pytest.mark.parametrize("name", [name for name, about in SAMPLES.items() if not about["triangles"]])
    def test_volume_meshes_are_answered_to_the_last_digit(self, name):
        properties = inertia.mass_properties(inertia.read(path(name)), 1.0, accuracy=1.2e-16)
        assert properties.error.method.startswith("double-double")
        assert max(properties.error.volume, properties.error.inertia) <= 1.2e-16

    def test_an_accuracy_that_no_float64_has_is_refused(self):
        with pytest.raises(UsageError, match=r"accuracy is 1e-17, finer than .* 1\.2e-16: ask for 'exact'"):
            inertia.mass_properties(surface(cube()), accuracy=1e-17)

    @pytest.mark.parametrize("accuracy", [0, -1e-12, math.nan, math.inf, "Exact", [1e-9]])
    def test_unusable_accuracies_are_refused(self, accuracy):
        with pytest.raises(UsageError, match=r"accuracy is .*: give a positive relative figure"):
            inertia.mass_properties(surface(cube()), accuracy=accuracy)

    def test_exact_is_refused_where_it_cannot_be(self):
        for options in ({"wire": 1.0}, {}):
            with pytest.raises(UsageError, match="exact arithmetic is for triangle surfaces"):
                inertia.analyse(cells("line", [[0, 0, 0], [1, 0, 0]]), accuracy="exact", **options)
        with pytest.raises(UsageError, match="square roots"):
            inertia.analyse(surface(cube()), shell=1.0, accuracy="exact")


class TestFarAway:
    """A part of 1 m, 10⁶ m from the origin: what is stored is answered to the last digits."""

    def test_float64(self):
        part = surface(moved(sphere(0.5, 24), 1e6, -2e6, 3e6))
        properties, truth = inertia.mass_properties(part), exact(part)
        assert max(relative(properties, truth)) <= 8 * ULP
        assert_within_bound(properties, truth)
        assert max(properties.error.volume, properties.error.inertia) < 1e-12

    def test_binary_stl(self):
        skew = mapped(cube(), [[1, 0.25, 0.125], [0, 1, 0.5], [0.0625, 0, 1]])
        part = facets(moved(skew, 1e6, -1e6, 5e5))
        np.testing.assert_array_equal(part.triangles.corners(), moved(skew, 1e6, -1e6, 5e5))
        properties, truth = inertia.mass_properties(part), exact(part)
        assert max(relative(properties, truth)) <= 8 * ULP
        assert_within_bound(properties, truth)

    @settings(deadline=None, max_examples=40)
    @given(*[st.floats(-1e9, 1e9)] * 3)
    def test_the_tensor_is_that_of_the_stored_coordinates_wherever_they_are(self, x, y, z):
        part = surface(moved(mapped(cube(), [[3, 1, 0], [0, 2, 1], [1, 0, 4]]), x, y, z))
        properties, truth = inertia.mass_properties(part), exact(part)
        assert_within_bound(properties, truth)
        assert max(relative(properties, truth)) <= 16 * ULP


class TestUnitsAndScale:
    @pytest.mark.parametrize("unit", ["m", "mm", "in", "um", "km", "ft"])
    def test_a_unit_is_an_exact_rational(self, unit):
        part = surface(mapped(cube(3, 1, 2), [[1, 0.1, 0.3], [0, 1, 0.7], [0.2, 0, 1]]), unit=unit)
        properties, truth = inertia.mass_properties(part, 7850, accuracy="exact"), exact(part, 7850)
        assert properties.mass == float(truth.volume)
        assert properties.center_of_mass.tolist() == [float(x) for x in truth.center_of_mass]
        assert properties.inertia.tolist() == [[float(x) for x in row] for row in truth.inertia]
        assert_within_bound(inertia.mass_properties(part, 7850), truth)

    @pytest.mark.parametrize("scale", [1e-12, 1e12, 2.0**-130, 2.0**130])
    def test_no_scale_costs_a_digit(self, scale):
        part = surface(moved(sphere(1, 16), 0.3, 0.5, 0.7) * [1, 2, 3] * scale)
        properties, truth = inertia.mass_properties(part), exact(part)
        assert max(relative(properties, truth)) <= 8 * ULP
        assert_within_bound(properties, truth)

    def test_a_power_of_two_changes_no_digit(self):
        corners = moved(sphere(1, 16), 0.3, 0.5, 0.7)
        one, other = (inertia.mass_properties(surface(corners * scale)) for scale in (1, 2.0**-40))
        np.testing.assert_array_equal(other.inertia, one.inertia * 2.0**-200)
        np.testing.assert_array_equal(other.center_of_mass, one.center_of_mass * 2.0**-40)

    @pytest.mark.parametrize("scale", [2.0**-130, 2.0**130])
    def test_the_area_has_its_scale(self, scale):
        assert inertia.analyse(surface(cube() * scale)).area == pytest.approx(6 * scale**2, rel=4 * ULP)

    @pytest.mark.parametrize(("scale", "unit"), [(1e73, "smaller"), (1e-73, "larger")])
    def test_a_result_beyond_float64_is_refused_by_name(self, scale, unit):
        with pytest.raises(GeometryError, match=rf"^bracket\.obj: .* leaves float64: give the coordinates in a {unit}"):
            inertia.analyse(surface(cube() * scale))

    @pytest.mark.parametrize("options", [{}, {"shell": 1.0}, {"accuracy": "exact"}])
    def test_coordinates_beyond_use_are_refused_by_number(self, options):
        corners = cube()
        corners[7, 1, 0] = 1e120
        with pytest.raises(GeometryError, match=r"^bracket\.obj: 1 triangle with a coordinate .* triangle 7"):
            inertia.analyse(surface(corners), **options)

    def test_a_mass_that_no_density_explains_is_refused(self):
        with pytest.raises(UsageError, match=r"density above 1\.8e308"):
            inertia.analyse(surface(cube() * 1e-60), mass=1e300)


def ball(n):
    return sphere(1, n), (4 / 3 * math.pi, 8 / 15 * math.pi, 8 / 15 * math.pi)


def ring(n):
    mass = 2 * math.pi**2 * 3
    return torus(3, 1, n), (mass, mass * (9 / 2 + 5 / 8), mass * (9 + 3 / 4))


def cone(n):
    mass = math.pi * 4 * 3 / 3
    return revolved([(0, 0), (2, 0), (0, 3)], n), (mass, mass * (3 / 20 * 4 + 3 / 80 * 9), mass * 3 / 10 * 4)


@pytest.mark.parametrize("shape", [ball, ring, cone])
def test_tessellations_converge_with_the_square_of_their_size(shape):
    errors = []
    for n in (32, 64, 128):
        corners, (mass, across, along) = shape(n)
        properties = inertia.mass_properties(surface(corners), 1.0)
        tensor = np.diag([across, across, along])
        errors.append([abs(properties.mass - mass), np.linalg.norm(properties.inertia - tensor)])
    slopes = np.log2(np.array(errors)[:-1] / np.array(errors)[1:])
    np.testing.assert_allclose(slopes, 2, atol=0.03)


class TestOptions:
    def test_the_point_is_in_the_part_s_unit(self):
        result = inertia.analyse(inertia.read(path("box.stl")), about=[0, 0, 0])
        point, tensor = result.about
        assert point == (0, 0, 0)
        a, b, c, mass = 0.04, 0.02, 0.01, 8e-3
        expected = mass * np.array(
            [
                [(b * b + c * c) / 3, -a * b / 4, -a * c / 4],
                [-a * b / 4, (a * a + c * c) / 3, -b * c / 4],
                [-a * c / 4, -b * c / 4, (a * a + b * b) / 3],
            ]
        )
        np.testing.assert_allclose(tensor, expected, rtol=1e-14)
        far = inertia.analyse(surface(cube(-0.5, -0.5, -0.5), unit="in"), mass=1.0, about=[100, 0, 0]).about[1]
        np.testing.assert_allclose(far, np.diag([1 / 6, 1 / 6 + 1e4, 1 / 6 + 1e4]) * 0.0254**2, rtol=1e-15)

    @pytest.mark.parametrize("about", [[1, 2], [1, 2, math.nan], 5])
    def test_an_unusable_point_is_refused(self, about):
        with pytest.raises(UsageError, match="about"):
            inertia.analyse(surface(cube()), about=about)

    def test_the_class_depends_on_the_tolerance_asked_for(self):
        brick = surface(cube() * [1, 1, 1.001])
        assert inertia.analyse(brick).principal.kind == "prolate"
        assert inertia.analyse(brick, class_tolerance=0.01).principal.kind == "spherical"
        assert inertia.analyse(inertia.read(path("sphere.stl"))).principal.kind == "prolate"
        assert inertia.analyse(inertia.read(path("sphere.stl")), class_tolerance=0.01).principal.kind == "spherical"

    @pytest.mark.parametrize("tolerance", [-1e-9, 1.0, math.nan])
    def test_an_unusable_tolerance_is_refused(self, tolerance):
        with pytest.raises(UsageError, match="class tolerance"):
            inertia.analyse(surface(cube()), class_tolerance=tolerance)

    @pytest.mark.parametrize("options", [{}, {"accuracy": "exact"}, {"shell": 1.0}])
    def test_progress_grows_to_one(self, options):
        fractions = []
        inertia.analyse(surface(sphere(1, 150)), progress=fractions.append, **options)
        assert len(fractions) > 1
        assert fractions == sorted(set(fractions))
        assert fractions[0] > 0
        assert fractions[-1] == 1.0

    def test_progress_of_cells_and_wires_ends_at_one(self):
        for kind, options in (("tetra", {}), ("line", {"wire": 1.0})):
            fractions = []
            nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]][: 4 if kind == "tetra" else 2]
            inertia.analyse(cells(kind, nodes), progress=fractions.append, **options)
            assert fractions[-1] == 1.0

    def test_notes_of_the_file_are_kept(self):
        part = inertia.repair(surface(cube()[1:])).part
        assert inertia.analyse(part).notes == part.notes != ()


@pytest.mark.parametrize(("away", "said"), [(0.0, False), (100.0, False), (3e5, True)])
def test_single_precision_far_from_the_origin_is_said(away, said):
    records = inertia.read(path("sphere.stl")).triangles.records.copy()
    corners = Facets(records).corners_f4()
    corners *= np.float32(20 / np.ptp(corners))
    corners += np.float32(away)
    size = np.ptp(corners, axis=(0, 1)).max()
    notes = inertia.analyse(Part(Facets(records), length_unit("mm"))).notes
    assert len(notes) == said
    if said:
        assert f"where coordinates are 0.031 mm apart, {0.03125 / size:.1g} of its size: export it nearer" in notes[0]
