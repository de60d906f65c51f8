"""Several bodies, regions, shells, wires and cells in one part, each with its density."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from tests.benchmarks.meshes import wavy_torus
from tests.mass.parts import assert_within_bound, cells, cube, exact, facets, surface, weighed

import inertia
from inertia.errors import GeometryError, ReadError, UsageError
from inertia.mass import integration
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.simple import at_hand
from inertia.mesh.part import CellBlock, Cells, Part, Regions, Source
from inertia.report.analysis.text import source_lines
from inertia.units import METRE, length_unit
from inertia_meshes import catalogue, path
from inertia_meshes.rational import moments
from inertia_meshes.shapes import Corners, box, flipped, mapped, moved, sphere

STEEL, ALUMINIUM = 7850, 2700
HOLLOW = (sphere(2, 16), flipped(sphere(1, 16)))


def shares(result: inertia.Analysis) -> dict[str, tuple[float, float]]:
    """Return the density and volume of each body or region."""
    return {share.name: (share.density, share.volume) for share in result.shares}


class TestRegions:
    def test_shaft_and_impeller_each_with_its_density(self):
        part = inertia.read(path("shaft_impeller.obj"))
        result = inertia.analyse(part, {"shaft": STEEL, "impeller": ALUMINIUM})
        corners, index = part.triangles.corners(), part.regions.index
        pieces = {name: corners[index == k] for k, name in enumerate(part.regions.names)}
        truth = weighed((pieces["shaft"], STEEL), (pieces["impeller"], ALUMINIUM), unit=part.unit.metres)
        assert_within_bound(result.properties, truth, moments(corners).volume / 10**9)
        assert result.density_from == "option"
        assert result.density == pytest.approx(float(truth.volume / moments(corners).volume * 10**9), rel=1e-14)

        known = catalogue()["shaft_impeller.obj"]
        for share in result.shares:
            mesh = known["parts"][share.name]["mesh"]
            assert share.volume == pytest.approx(1e-9 * mesh["volume"], rel=1e-14)
            assert share.mass == pytest.approx(share.density * share.volume, rel=1e-14)
            np.testing.assert_allclose(share.center_of_mass, np.multiply(1e-3, mesh["center_of_mass"]), atol=1e-16)
        assert sum(share.mass for share in result.shares) == pytest.approx(result.properties.mass, rel=1e-14)
        assert result.properties.mass == pytest.approx(known["assembly"]["mass"], rel=1e-3)
        np.testing.assert_allclose(result.properties.inertia, known["assembly"]["inertia"], atol=1e-3 * 3e-4)

    def test_bodies_are_numbered_in_file_order(self):
        part = inertia.read(path("shaft_impeller.obj"))
        by_name = inertia.mass_properties(part, {"shaft": STEEL, "impeller": ALUMINIUM})
        numbers = {
            str(k + 1): {"shaft": STEEL, "impeller": ALUMINIUM}[name] for k, name in enumerate(part.regions.names)
        }
        np.testing.assert_allclose(inertia.mass_properties(part, numbers).inertia, by_name.inertia, rtol=1e-14)

    def test_a_bar_of_two_regions_is_two_boxes(self):
        result = inertia.analyse(inertia.read(path("two_region_bar.vtk")), {"1": STEEL, "2": ALUMINIUM})
        known = catalogue()["two_region_bar.vtk"]["assembly"]
        properties = result.properties
        assert properties.mass == pytest.approx(known["mass"], rel=properties.error.mass)
        np.testing.assert_allclose(properties.center_of_mass, known["center_of_mass"], rtol=1e-15)
        off = np.linalg.norm(properties.inertia - known["inertia"])
        assert off <= properties.error.inertia * np.linalg.norm(known["inertia"])
        assert shares(result) == {"1": (STEEL, 2e-6), "2": (ALUMINIUM, 2e-6)}

    def test_materials_by_name_and_one_for_the_rest(self):
        part = inertia.read(path("two_region_bar.vtk"))
        result = inertia.analyse(part, material={"1": "steel", "": "aluminium"})
        assert shares(result) == {"1": (STEEL, 2e-6), "2": (ALUMINIUM, 2e-6)}
        assert result.density_from == "material"

    def test_a_total_mass_leaves_the_densities_their_proportion(self):
        part = inertia.read(path("two_region_bar.vtk"))
        result = inertia.analyse(part, {"1": 2, "2": 1}, mass=0.3)
        assert result.properties.mass == 0.3
        assert [share.mass for share in result.shares] == pytest.approx([0.2, 0.1], rel=1e-15)
        assert result.density_from == "mass"

    @pytest.mark.parametrize("options", [{}, {"accuracy": "exact"}, {"orientation": "absolute"}, {"shell": 0.5}])
    def test_a_region_may_be_the_whole_of_a_part(self, options):
        part = surface(cube(), regions=["bracket"])
        whole = inertia.mass_properties(part, 7.0, **options)
        for density in ({"bracket": 7.0}, {"": 1.0, "bracket": 7.0}):
            assert inertia.mass_properties(part, density, **options).mass == whole.mass

    def test_a_region_of_several_bodies(self):
        part = surface(cube(), cube(3), cube(6), regions=["a", "b", "c"])
        part = replace(part, regions=Regions(("a", "b"), np.where(part.regions.index == 1, 1, 0).astype(np.int32)))
        result = inertia.analyse(part, {"a": 1, "b": 5})
        assert result.properties.mass == 7.0
        assert shares(result) == {"a": (1.0, 2.0), "b": (5.0, 1.0)}

    def test_elements_of_no_region_are_the_rest(self):
        part = surface(cube(), cube(3), regions=["a", "b"])
        part = replace(part, regions=Regions(("a",), np.where(part.regions.index == 0, 0, -1).astype(np.int32)))
        assert inertia.mass_properties(part, {"a": 2, "": 5}).mass == 7.0
        with pytest.raises(UsageError, match="no density is given for ''"):
            inertia.mass_properties(part, {"a": 2})

    def test_a_region_without_elements_does_not_matter(self):
        part = surface(cube(), regions=["a"])
        part = replace(part, regions=Regions(("a", "empty"), part.regions.index))
        assert inertia.mass_properties(part, {"a": 2, "empty": 9}).mass == 2.0

    def test_an_unknown_name_is_refused_with_a_suggestion(self):
        part = inertia.read(path("shaft_impeller.obj"))
        with pytest.raises(UsageError, match=r"called 'impeler' \(did you mean 'impeller'\?\): it has .*'shaft'"):
            inertia.analyse(part, {"shaft": STEEL, "impeler": ALUMINIUM})
        with pytest.raises(UsageError, match=r"called '3'.*: it has '1', '2'"):
            inertia.analyse(inertia.read(path("two_region_bar.vtk")), {"3": 1})

    @pytest.mark.parametrize("options", [{}, {"shell": 1.0}])
    def test_an_unknown_name_is_refused_where_nothing_is_named(self, options):
        with pytest.raises(UsageError, match="no region or body called 'steel part'"):
            inertia.analyse(surface(cube()), {"": 1, "steel part": 2}, **options)

    def test_a_forgotten_region_is_named(self):
        with pytest.raises(UsageError, match="no density is given for 'impeller': give it one, or one without a name"):
            inertia.analyse(inertia.read(path("shaft_impeller.obj")), {"shaft": STEEL})

    def test_regions_and_body_numbers_do_not_mix(self):
        part = surface(cube(), cube(3), regions=["a", "b"])
        for rest in ({}, {"": 1}):
            with pytest.raises(UsageError, match=r"for regions \('a'\) and for bodies by number"):
                inertia.analyse(part, {"a": 5, "2": 3, **rest})

    def test_a_region_whose_name_is_a_number_is_no_body(self):
        part = surface(cube(), cube(3) * 2, regions=["3", "1"])
        assert shares(inertia.analyse(part, {"1": 5, "3": 2})) == {"3": (2.0, 1.0), "1": (5.0, 8.0)}
        with pytest.raises(UsageError, match=r"regions \('1'\) .* by number \('2'\), .*only \(it has '3', '1'\)"):
            inertia.analyse(part, {"1": 5, "2": 2})
        assert shares(inertia.analyse(part, {"2": 5, "": 2})) == {"1": (2.0, 1.0), "2": (5.0, 8.0)}

    def test_a_region_that_is_only_a_face_has_no_density(self):
        part = surface(cube()[:2], cube()[2:], regions=["floor", "rest"])
        with pytest.raises(
            GeometryError, match=r"region 'floor' of bracket.obj is not closed by itself: 4 of its edges"
        ):
            inertia.analyse(part, {"floor": 1, "rest": 2})
        assert inertia.mass_properties(part, 2.0).mass == 2.0

    def test_the_wall_of_a_cavity_has_no_density(self):
        with pytest.raises(GeometryError, match=r"region 'wall' of bracket.obj faces inward .* wall of a cavity"):
            inertia.analyse(surface(*HOLLOW, regions=["ball", "wall"]), {"ball": 1, "wall": 2})


class TestBodies:
    def test_a_cavity_is_no_mass(self):
        for name in ("hollow_sphere.stl", "sphere_cavity.stl"):
            result = inertia.analyse(inertia.read(path(name)), {"1": STEEL})
            assert result.bodies == 1
            assert result.shares == ()
            assert_within_bound(result.properties, exact(inertia.read(path(name)), STEEL))

    def test_a_body_in_the_cavity_of_another_has_its_own_density(self):
        part = surface(*HOLLOW, sphere(0.5, 16))
        result = inertia.analyse(part, {"1": ALUMINIUM, "2": STEEL})
        assert result.bodies == 2
        assert_within_bound(result.properties, weighed((np.concatenate(HOLLOW), ALUMINIUM), (sphere(0.5, 16), STEEL)))

    @pytest.mark.parametrize("accuracy", [None, "exact"])
    def test_an_insert_that_fills_a_cavity_has_its_own_density(self, accuracy):
        part = surface(*HOLLOW, sphere(1, 16), regions=["case", "case wall", "insert"])
        result = inertia.analyse(part, {"1": ALUMINIUM, "2": STEEL}, accuracy=accuracy)
        truth = weighed((np.concatenate(HOLLOW), ALUMINIUM), (sphere(1, 16), STEEL))
        assert_within_bound(result.properties, truth, moments(sphere(2, 16)).volume)

    @pytest.mark.parametrize("x", [1, 1.5])
    def test_bodies_that_touch_or_stand_apart_add_up(self, x):
        result = inertia.analyse(surface(cube(), cube(x)), {"1": 1, "2": 3})
        assert result.bodies == 2
        assert_within_bound(result.properties, weighed((cube(), 1), (cube(x), 3)), Fraction(2))
        assert [share.mass for share in result.shares] == [1.0, 3.0]

    def test_one_density_needs_no_shares(self):
        result = inertia.analyse(surface(cube(), cube(2)), 5.0)
        assert result.shares == ()
        assert result.properties.mass == 10.0

    @settings(deadline=None, max_examples=25)
    @given(
        st.lists(st.tuples(st.integers(0, 4), st.floats(0.1, 1e4)), min_size=1, max_size=4, unique_by=lambda k: k[0])
    )
    def test_any_assembly_is_the_sum_of_its_bodies(self, bodies):
        pieces = [(cube(3 * place, 0.3 * place, size=1 + place / 4), Fraction(rho)) for place, rho in bodies]
        density = {str(k + 1): rho for k, (_, rho) in enumerate(bodies)}
        properties = inertia.mass_properties(surface(*(corners for corners, _ in pieces)), density)
        assert_within_bound(properties, weighed(*pieces))

    def test_overlapping_bodies_are_refused(self):
        with pytest.raises(GeometryError, match=r"^bracket.obj: overlapping bodies: 1 pair .* triangles 0 and 12"):
            inertia.analyse(surface(cube(), cube(0.5, 0.5, 0.5)))

    def test_a_body_inside_another_counts_twice_and_is_refused(self):
        with pytest.raises(
            GeometryError, match=r"overlapping bodies: 1 shell inside another .* orientation='absolute'"
        ):
            inertia.analyse(surface(cube(size=3), cube(1, 1, 1)))

    @pytest.mark.parametrize("corners", [np.concatenate([cube(), cube()]), np.repeat(cube(), 2, axis=0)])
    def test_a_body_stored_twice_is_refused(self, corners):
        with pytest.raises(GeometryError, match="12 triangles stored again with the same winding"):
            inertia.analyse(surface(corners))

    def test_a_sheet_beside_a_body_adds_nothing(self):
        sheet = cube(5)[:2]
        part = surface(cube(), sheet, flipped(sheet))
        assert inertia.mass_properties(part).mass == 1000.0
        assert inertia.mass_properties(part, {"1": 7.0}).mass == 7.0


class TestOrientation:
    @pytest.mark.parametrize("make", [surface, facets])
    def test_an_inward_surface_is_refused_and_turned_on_request(self, make):
        inward, outward = make(flipped(cube())), make(cube())
        with pytest.raises(GeometryError, match=r"inside out: .* volume is -1 m³"):
            inertia.analyse(inward)
        result = inertia.analyse(inward, orientation="absolute")
        np.testing.assert_array_equal(result.properties.inertia, inertia.mass_properties(outward).inertia)
        assert result.notes == ("1 of 1 shells turned, as absolute orientation was asked for",)

    def test_one_shell_that_faces_inward_is_refused_as_it_is_found_without_a_whole_check(self, monkeypatch):
        part = surface(flipped(cube()))
        finding = inertia.check(part).findings[0]
        monkeypatch.setattr("inertia.mesh.check.check", lambda *_, **__: pytest.fail("checked"))
        with pytest.raises(GeometryError) as refused:
            inertia.analyse(part)
        assert str(refused.value).endswith(str(finding.message))
        assert refused.value.code == finding.code == "inward"

    @pytest.mark.parametrize("count", [900, 1100, 5000])
    def test_an_inward_surface_of_any_size_is_turned(self, count):
        vertices, faces = wavy_torus(count)
        turned = inertia.analyse(inertia.Part.from_arrays(vertices, faces[:, ::-1]), orientation="absolute").properties
        outward = inertia.analyse(inertia.Part.from_arrays(vertices, faces)).properties
        assert turned.volume == pytest.approx(outward.volume, rel=1e-15)
        np.testing.assert_allclose(turned.inertia, outward.inertia, rtol=1e-13, atol=1e-13 * outward.inertia.max())

    def test_a_right_surface_stays_as_it_is(self):
        result = inertia.analyse(surface(*HOLLOW), orientation="absolute")
        assert result.notes == ()
        assert_within_bound(result.properties, weighed((np.concatenate(HOLLOW), 1000)))

    @pytest.mark.parametrize("make", [surface, facets])
    @pytest.mark.parametrize("accuracy", [None, "exact"])
    def test_one_inverted_body_among_several(self, make, accuracy):
        part = make(cube(), flipped(cube(2)), cube(4))
        with pytest.raises(GeometryError, match=r"1 shell inside out .* from triangle 12 on"):
            inertia.analyse(part, accuracy=accuracy)
        result = inertia.analyse(part, {"": 1, "2": 5}, orientation="absolute", accuracy=accuracy)
        assert_within_bound(result.properties, weighed((cube(), 1), (cube(2), 5), (cube(4), 1)))
        assert result.notes[0].startswith("1 of 3 shells turned")

    def test_an_inverted_region(self):
        part = surface(cube(), flipped(cube(2)), regions=["a", "b"])
        result = inertia.analyse(part, {"a": 1, "b": 5}, orientation="absolute")
        assert shares(result) == {"a": (1.0, 1.0), "b": (5.0, 1.0)}

    def test_an_outward_shell_in_a_body_becomes_its_cavity(self):
        result = inertia.analyse(surface(cube(size=3), cube(1, 1, 1)), {"1": 1}, orientation="absolute")
        assert (result.bodies, result.properties.mass) == (1, 26.0)

    def test_a_hollow_body_inside_out_as_a_whole(self):
        result = inertia.analyse(surface(*map(flipped, HOLLOW)), orientation="absolute")
        assert_within_bound(result.properties, weighed((np.concatenate(HOLLOW), 1000)))

    def test_what_turning_does_not_mend_is_refused(self):
        with pytest.raises(GeometryError, match="open"):
            inertia.analyse(surface(cube()[1:]), orientation="absolute")
        with pytest.raises(GeometryError, match="overlapping bodies: 1 pair"):
            inertia.analyse(surface(cube(), flipped(cube(0.5, 0.5, 0.5))), orientation="absolute")

    def test_another_word_is_refused(self):
        with pytest.raises(UsageError, match="use 'stored' or 'absolute'"):
            inertia.analyse(surface(cube()), orientation="outward")


class TestShells:
    def test_an_open_sheet_has_its_area(self):
        result = inertia.analyse(surface(cube()[:2]), 10.0, shell=0.5)
        properties = result.properties
        assert (result.model, result.closed, result.area) == ("shell", False, 1.0)
        assert (properties.volume, properties.mass) == (0.5, 5.0)
        np.testing.assert_allclose(properties.center_of_mass, [0.5, 0.5, 0], atol=properties.error.center_of_mass)
        np.testing.assert_allclose(properties.inertia, np.diag([5, 5, 10]) / 12, atol=5 * properties.error.inertia)

    def test_a_box_of_sheet_metal(self):
        """Six plates a × b of mass ρtab: about its middle ab/12 (b² or a²) and the shift of half an edge."""
        a, b, c, weight = 1.0, 2.0, 3.0, 7850 * 0.001
        properties = inertia.mass_properties(surface(cube() * [a, b, c]), 7850, shell=0.001)

        def about(a: float, b: float, c: float) -> float:  # the axis along a
            ends, sides, floors = 2 * b * c, 2 * a * c, 2 * a * b
            return ends * (b * b + c * c) / 12 + sides * (c * c / 12 + b * b / 4) + floors * (b * b / 12 + c * c / 4)

        assert properties.mass == pytest.approx(22 * weight, rel=1e-14)
        np.testing.assert_allclose(
            properties.inertia, weight * np.diag([about(a, b, c), about(b, c, a), about(c, a, b)]), atol=1e-12
        )
        np.testing.assert_allclose(properties.center_of_mass, [0.5, 1, 1.5], rtol=1e-14)

    def test_the_thickness_is_in_the_part_s_unit(self):
        part = surface(cube(), unit="mm")
        for thickness in (2, 2.0, np.float32(2), np.int64(2)):
            assert inertia.mass_properties(part, 1e6, shell=thickness).mass == pytest.approx(1.2e-2, rel=1e-14)

    def test_the_bound_of_a_right_triangle_holds(self):
        """A Pythagorean triangle has a rational area: 3 · 4 · 5, shifted far away."""
        corners = moved(np.array([[[0, 0, 0], [3.0, 0, 0], [0, 4.0, 0]]]), 1e5, 2e5, -3e5)
        properties = inertia.mass_properties(surface(corners), 1.0, shell=1.0)
        assert abs(properties.mass - 6) <= 6 * properties.error.mass
        com = np.array([1e5 + 1, 2e5 + 4 / 3, -3e5])
        assert np.linalg.norm(properties.center_of_mass - com) <= properties.error.center_of_mass
        true = np.array([[6 * 16 / 18, 6 * 12 / 36, 0], [6 * 12 / 36, 6 * 9 / 18, 0], [0, 0, 6 * 25 / 18]])
        assert np.linalg.norm(properties.inertia - true) <= properties.error.inertia * np.linalg.norm(true)
        assert properties.error.inertia < 1e-12

    def test_a_spherical_shell_converges_to_two_thirds(self):
        errors = []
        for n in (32, 64, 128):
            properties = inertia.mass_properties(surface(sphere(1, n)), 1.0, shell=0.01)
            errors.append(np.linalg.norm(properties.inertia - 2 / 3 * 0.04 * math.pi * np.eye(3)))
        assert np.log2(np.array(errors)[:-1] / np.array(errors)[1:])[-1] == pytest.approx(2, abs=0.05)

    def test_winding_does_not_matter(self):
        flip = cube()
        flip[3] = flip[3, ::-1]
        np.testing.assert_allclose(
            inertia.mass_properties(surface(flip), shell=1.0).inertia,
            inertia.mass_properties(surface(cube()), shell=1.0).inertia,
            rtol=1e-14,
        )

    def test_sheets_apart_are_bodies(self):
        assert inertia.analyse(surface(cube()[:2], cube(5)[:2]), shell=1.0).bodies == 2

    @pytest.mark.parametrize(
        ("again", "edges", "pair"),
        [
            (cube()[:2], 5, "0 and 12"),
            (cube()[:2, ::-1], 5, "0 and 12"),
            (cube()[:1, [1, 2, 0]], 3, "0 and 12"),
            ([[[0, 0, 0], [0, 1, 0], [1, 0, 0]], [[1, 1, 0], [1, 0, 0], [0, 1, 0]]], 4, "0 and 12"),  # split anew
            ([[[0, 0, 0], [1, 0, 0], [1, 0.001, 1]]], 0, ""),
            ([[[0, 0, 0], [1, 0, 0], [0, -1, 0]]], 0, ""),
            ([[[0, 0, 0], [1, 0, 0], [0.5, 0, 0]]], 0, ""),
            ([[[0, 0, 0], [1, 0, 0], [0.5, 1e-6, 0]]], 0, ""),  # along the side of the first, as at a T-vertex
        ],
    )
    def test_area_that_is_there_twice_is_told(self, again, edges, pair):
        """The first two triangles are the floor of a cube, split from (0, 0, 0)."""
        notes = inertia.analyse(surface(cube(), np.array(again, float)), 1.0, shell=1.0).notes
        says = f"triangles lie on one another at {edges} edges, the first being triangles {pair} around"
        assert [note for note in notes if note.startswith(says)] == list(notes)
        assert len(notes) == (edges > 0)

    def test_regions_of_a_shell_have_densities(self):
        part = surface(cube()[:2], cube()[2:], regions=["floor", "rest"])
        result = inertia.analyse(part, {"floor": 100, "": 1}, shell=1.0)
        assert result.properties.mass == pytest.approx(105, rel=1e-14)
        assert shares(result) == {"floor": (100.0, 1.0), "rest": (1.0, 5.0)}

    def test_a_lamina_obeys_the_triangle_rule_with_equality(self):
        outline = [[0, 0, 0], [4, 0, 0], [1, 3, 0]]
        properties = inertia.mass_properties(surface(np.array([outline], float)), 1.0, shell=1.0)
        flat = inertia.lamina(outline, 1.0)
        i1, i2, i3 = properties.principal_moments
        assert i1 + i2 == pytest.approx(i3, rel=1e-14)
        np.testing.assert_allclose(properties.inertia, flat.inertia, atol=1e-14)

    @pytest.mark.parametrize("thickness", [0, -1, math.nan, math.inf, "thin"])
    def test_an_unusable_thickness_is_refused(self, thickness):
        with pytest.raises(UsageError, match=r"shell thickness is .* mm: it must be positive and finite"):
            inertia.analyse(surface(cube(), unit="mm"), shell=thickness)

    def test_a_shell_is_a_surface_and_not_a_wire(self):
        with pytest.raises(UsageError, match="both a shell and a wire"):
            inertia.analyse(surface(cube()), shell=1.0, wire=1.0)
        with pytest.raises(GeometryError, match=r"bar.vtk is a mesh of cells"):
            inertia.analyse(cells("line", [[0, 0, 0], [1, 0, 0]]), shell=1.0)


class TestWiresAndPoints:
    def test_a_rod(self):
        part = cells("line", [[1e3, 0, 0], [1e3 + 3, 4, 0]])
        result = inertia.analyse(part, 10.0, wire=0.5)
        properties = result.properties
        assert (result.model, result.cells, result.triangles) == ("wire", 1, 0)
        assert (properties.mass, properties.volume) == (25.0, 2.5)
        np.testing.assert_allclose(properties.center_of_mass, [1001.5, 2, 0], rtol=1e-15)
        truth = 25 / 12 * np.array([[16, -12, 0], [-12, 9, 0], [0, 0, 25]])
        assert np.linalg.norm(properties.inertia - truth) <= properties.error.inertia * np.linalg.norm(truth)
        assert result.principal.kind == "rotor"

    def test_the_section_is_in_the_part_s_unit_squared(self):
        part = replace(
            cells("line", [[0, 0, 0], [100, 0, 0]]),
            unit=length_unit("mm"),
        )
        assert inertia.mass_properties(part, 1e6, wire=2).mass == pytest.approx(0.2, rel=1e-14)

    def test_a_frame_of_edges_is_a_polyline(self):
        corners = np.array([[0, 0, 0], [2, 0, 0], [2, 3, 0], [2, 3, 4]], float)
        part = cells("line", *np.stack([corners[:-1], corners[1:]], axis=1))
        frame = inertia.wire(corners, 1.0)
        np.testing.assert_allclose(inertia.mass_properties(part, 1.0, wire=1.0).inertia, frame.inertia, atol=1e-13)

    def test_a_line_that_is_there_twice_is_told(self):
        there, back = [[0, 0, 0], [3, 0, 0]], [[3, 0, 0], [0, 0, 0]]
        part = cells("line", there, [[0, 0, 0], [0, 4, 0]], back)
        says = "1 line stored again, the first being cell 2 around (1.5, 0.0, 0.0), so that the length counts twice"
        assert inertia.analyse(part, 1.0, wire=1.0).notes == (f"{says}: remove the copies",)
        assert [each.code for each in inertia.check(part).findings] == ["zero_volume", "duplicate_cell"]
        assert inertia.check(part).findings[1].severity == "warning"

    @pytest.mark.parametrize("names", [("copper", "steel"), ("1", "2")])
    def test_regions_of_a_wire_have_densities(self, names):
        """A bar of 3 along x and one of 4 along y: about an end along it 0, across it m L²/3, parallel axes beside."""
        part = cells("line", [[0, 0, 0], [3, 0, 0]], [[3, 0, 0], [3, 4, 0]], regions=names)
        result = inertia.analyse(part, dict(zip(names, (10, 20), strict=True)), wire=2, about=(0, 0, 0))
        along, across = 10 * 2 * 3, 20 * 2 * 4
        tensor = [[across * 16 / 3, -across * 3 * 2, 0], [-across * 3 * 2, along * 3 + across * 9, 0]]
        tensor.append([0, 0, along * 3 + across * (9 + 16 / 3)])
        assert result.properties.mass == along + across
        assert shares(result) == {names[0]: (10.0, 6.0), names[1]: (20.0, 8.0)}
        np.testing.assert_allclose(result.properties.center_of_mass, [(90 + 480) / 220, 320 / 220, 0], rtol=1e-14)
        np.testing.assert_allclose(result.about[1], tensor, rtol=1e-14)

    @pytest.mark.parametrize("names", [("copper", "steel"), ("1", "2")])
    def test_each_region_of_a_wire_needs_its_density(self, names):
        part = cells("line", [[0, 0, 0], [3, 0, 0]], [[3, 0, 0], [3, 4, 0]], regions=names)
        with pytest.raises(UsageError, match=f"no density is given for {names[1]!r}"):
            inertia.analyse(part, {names[0]: 10}, wire=2)
        assert inertia.mass_properties(part, {names[0]: 10, "": 20}, wire=2).mass == 220
        with pytest.raises(UsageError, match=f"no region or body called 'brass': it has {names[0]!r}, {names[1]!r}"):
            inertia.analyse(part, {"brass": 10, "": 20}, wire=2)

    def test_densities_of_a_wire_s_regions_count_as_proportions_beside_a_mass(self):
        part = cells("line", [[0, 0, 0], [3, 0, 0]], [[3, 0, 0], [3, 4, 0]], regions=["a", "b"])
        result = inertia.analyse(part, {"a": 1, "b": 2}, mass=11, wire=2)
        assert result.properties.center_of_mass[1] == pytest.approx(320 / 220, rel=1e-14)

    def test_curved_wires_and_lines_in_no_region(self):
        """A straight `line3` beside a line that no region holds, and a region of a point, which needs no density."""
        points = np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0], [0, 0, 5]], float)
        blocks = (
            CellBlock("vertex", np.array([[3]])),
            CellBlock("line3", np.array([[0, 1, 2]])),
            CellBlock("line", np.array([[0, 3]])),
        )
        part = Part(Cells(points, blocks), METRE, regions=Regions(("pin", "rail"), np.array([0, 1, -1], np.int32)))
        result = inertia.analyse(part, {"rail": 3, "": 7}, wire=1.0)
        assert result.properties.mass == pytest.approx(3 * 2 + 7 * 5, rel=1e-14)
        with pytest.raises(UsageError, match="no density is given"):
            inertia.analyse(part, {"rail": 3}, wire=1.0)

    @pytest.mark.parametrize("density", [1.0, {"1": 1.0}, {"a": 1.0}])
    def test_lines_without_length_have_no_mass(self, density):
        part = cells("line", [[1, 0, 0], [1, 0, 0]], regions=["a"] if "a" in str(density) else ())
        with pytest.raises(GeometryError, match="the mass, 0 kg, is not above"):
            inertia.analyse(part, density, wire=1.0)

    def test_a_wire_without_regions_is_body_1(self):
        part = cells("line", [[0, 0, 0], [3, 0, 0]])
        assert inertia.mass_properties(part, {"1": 10}, wire=2).mass == 60
        with pytest.raises(UsageError, match="no region or body called '2': it has '1'"):
            inertia.analyse(part, {"1": 10, "2": 20}, wire=2)

    def test_what_is_no_wire_is_told_nothing_that_leads_back(self):
        with pytest.raises(GeometryError, match=r"bar.vtk holds no lines for a wire: leave wire out$"):
            inertia.analyse(cells("tetra", TETRA), wire=1.0)
        for part, options in ((cells("tetra", TETRA), {}), (surface(cube()), {"shell": 1.0})):
            with pytest.raises(UsageError, match=r"finer than results in float64 can be, .*: give a larger figure"):
                inertia.analyse(part, accuracy=1e-17, **options)

    def test_lines_and_points_are_no_solids(self):
        for kind, nodes, remedy in (
            ("line", [[0, 0, 0], [1, 0, 0]], "use wire=AREA for lines, or export a solid"),
            ("vertex", [[0, 0, 0]], "export a solid"),
        ):
            report = inertia.check(cells(kind, nodes))
            assert (report.fit, report.closed, [each.code for each in report.faults()]) == (
                False,
                False,
                ["zero_volume"],
            )
            with pytest.raises(GeometryError, match=f"^bar.vtk: it holds lines or points only, .*: {remedy}$"):
                inertia.analyse(cells(kind, nodes))
        with pytest.raises(GeometryError, match=r"bracket.obj holds no lines for a wire \(lines beside faces are not"):
            inertia.analyse(surface(cube()), wire=1.0)

    def test_lines_of_surface_formats_are_wires_where_there_are_no_faces(self, tmp_path):
        """A bar of 3 along x, one of 4 along y and, in a region of its own, one of 5 along z."""
        points = "v 0 0 0\nv 3 0 0\nv 3 4 0\n"
        two = f"{points}o a\nl 1 2/7 3\no b\nv 0 0 0\nv 0 0 5\nl -2 -1\np 1\n"
        (tmp_path / "a.obj").write_text(two)
        part = inertia.read(tmp_path / "a.obj", unit="m")
        assert part.notes == ("1 point element beside the lines was left out",)
        assert shares(inertia.analyse(part, {"a": 1, "b": 2}, wire=1.0)) == {"a": (1.0, 7.0), "b": (2.0, 5.0)}
        header = "ply\nformat {} 1.0\nelement vertex 3\n" + "".join(f"property double {k}\n" for k in "xyz")
        header += "element face 0\nproperty list uchar int vertex_indices\nelement edge 2\n"
        header += "property int vertex1\nproperty int vertex2\nend_header\n"
        (tmp_path / "a.ply").write_text(header.format("ascii") + "0 0 0 3 0 0 3 4 0\n0 1 1 2\n")
        rows = np.array([0, 0, 0, 3, 0, 0, 3, 4, 0], "<f8").tobytes() + np.array([0, 1, 1, 2], "<i4").tobytes()
        (tmp_path / "b.ply").write_bytes(header.format("binary_little_endian").encode() + rows)
        for name in ("a.ply", "b.ply"):
            properties = inertia.mass_properties(inertia.read(tmp_path / name, unit="m"), 1.0, wire=1.0)
            assert properties.mass == 7
            np.testing.assert_allclose(properties.center_of_mass, [(4.5 + 12) / 7, 8 / 7, 0], rtol=1e-15)

    @pytest.mark.parametrize(
        ("name", "text", "says"),
        [
            ("a.obj", "v 0 0 0\nl 1\n", "line element 0 has fewer than two vertices"),
            ("a.obj", "v 0 0 0\nl 1 2\n", "line element 0 names vertex 2, but the vertices are 1 to 1"),
            ("a.obj", "v 0 0 0\nl 1 x\n", "line element 0 holds 'x', which is not a whole number"),
            ("a.ply", "element edge 1\nproperty int a\nend_header\n0 0 0\n1\n", "edges have no vertex1 and vertex2"),
        ],
    )
    def test_lines_that_are_damaged_are_refused(self, name, text, says, tmp_path):
        head = "ply\nformat ascii 1.0\nelement vertex 1\n" + "".join(f"property float {k}\n" for k in "xyz")
        (tmp_path / name).write_text(head + text if name == "a.ply" else text)
        with pytest.raises(ReadError, match=says):
            inertia.read(tmp_path / name)

    @pytest.mark.parametrize("section", [0, -1, math.nan])
    def test_an_unusable_section_is_refused(self, section):
        with pytest.raises(UsageError, match=r"wire cross-section is .* m²: it must be positive"):
            inertia.analyse(cells("line", [[0, 0, 0], [1, 0, 0]]), wire=section)


HEXAHEDRON = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [0, 0, 1], [2, 0, 1], [2, 1, 1], [0, 1, 1]]
WEDGE = [[2, 0, 0], [4, 0, 0], [2, 0, 1], [2, 1, 0], [4, 1, 0], [2, 1, 1]]
PYRAMID = [[0, 0, 1], [2, 0, 1], [2, 1, 1], [0, 1, 1], [0.5, 0.5, 4]]
TETRA = [[0, 0, 0], [0, 0, 1], [0, 1, 0], [-3, 0.25, 0.5]]


def hull(nodes: list[list[float]]) -> Corners:
    """Return the outward surface of a convex cell."""
    points = np.array(nodes, float)
    corners = points[ConvexHull(points).simplices]
    a, b, c = corners.transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - points.mean(axis=0)) < 0
    corners[inward] = corners[inward, ::-1]
    return corners


class TestCells:
    @pytest.mark.parametrize(
        ("kind", "nodes"), [("hexahedron", HEXAHEDRON), ("wedge", WEDGE), ("pyramid", PYRAMID), ("tetra", TETRA)]
    )
    def test_a_cell_is_the_solid_inside_its_faces(self, kind, nodes):
        properties = inertia.mass_properties(cells(kind, nodes), 3.0)
        assert_within_bound(properties, weighed((hull(nodes), 3)), moments(hull(nodes)).volume)
        assert properties.error.inertia < 1e-12

    def test_a_straight_second_order_cell_is_its_linear_one(self):
        corners = np.array(HEXAHEDRON, float)
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
        nodes = np.concatenate([corners, [corners[list(edge)].mean(axis=0) for edge in edges]])
        assert_within_bound(inertia.mass_properties(cells("hexahedron20", nodes)), weighed((hull(HEXAHEDRON), 1000)))

    def test_a_mesh_of_four_kinds(self):
        nodes = {"hexahedron": HEXAHEDRON, "wedge": WEDGE, "pyramid": PYRAMID, "tetra": TETRA}
        points = np.concatenate(list(nodes.values())).astype(float)
        starts = np.cumsum([0, *map(len, nodes.values())])
        blocks = tuple(
            CellBlock(kind, np.arange(a, b)[None]) for kind, a, b in zip(nodes, starts[:-1], starts[1:], strict=True)
        )
        regions = Regions(("steel", "foam"), np.array([0, 0, 1, 1], np.int32))
        result = inertia.analyse(Part(Cells(points, blocks), METRE, regions=regions), {"steel": 8, "foam": 1})
        truth = weighed((hull(HEXAHEDRON), 8), (hull(WEDGE), 8), (hull(PYRAMID), 1), (hull(TETRA), 1))
        assert_within_bound(result.properties, truth)
        assert shares(result) == {"steel": (8.0, pytest.approx(3)), "foam": (1.0, pytest.approx(2.5))}
        assert (result.cells, result.model) == (4, "solid")

    def test_a_cell_that_is_stored_again_is_refused_by_name(self):
        with pytest.raises(GeometryError, match=r"^bar.vtk: 1 cell stored again, the first being cell 1"):
            inertia.analyse(cells("tetra", TETRA, TETRA))

    def test_a_tangled_cell_is_refused_by_name(self):
        tangled = [HEXAHEDRON[k] for k in (0, 1, 3, 2, 4, 5, 6, 7)]
        says = (
            r"^bar.vtk: cell 0 \(hexahedron, nodes 0 1 2 .*\) is tangled: .* around .*count from 0.* the file's format"
        )
        with pytest.raises(GeometryError, match=says):
            inertia.analyse(cells("hexahedron", tangled))

    def test_a_region_can_be_left_to_the_rest(self):
        other = moved(np.array(TETRA, float), 10, 0, 0)
        part = cells("tetra", TETRA, other, regions=["a", "b"])
        assert inertia.mass_properties(part, {"b": 4, "": 2}).mass == pytest.approx(3, rel=1e-14)
        with pytest.raises(UsageError, match="no region or body called 'c'"):
            inertia.analyse(part, {"c": 4, "": 2})

    def test_lines_among_the_cells_need_no_density(self):
        points = np.array(TETRA, float)
        blocks = (CellBlock("line", np.array([[0, 1]])), CellBlock("tetra", np.arange(4)[None]))
        regions = Regions(("frame", "block"), np.array([0, 1], np.int32))
        result = inertia.analyse(Part(Cells(points, blocks), METRE, regions=regions), {"block": 4})
        assert result.properties.mass == pytest.approx(2, rel=1e-14)

    def test_cells_numbered_the_other_way_round_count_and_are_said(self):
        part = replace(cells("tetra", [TETRA[k] for k in (1, 0, 2, 3)]), source=Source(None, "arrays"))
        result = inertia.analyse(part)
        assert_within_bound(result.properties, weighed((hull(TETRA), 1000)))
        (note,) = result.notes + inertia.analyse(cells("tetra", TETRA)).notes
        assert note == "1 cell numbers its nodes the other way round: its volume counts positive"
        assert any(" 1 cell, 1 body" in line for line in source_lines(result))
        assert ">1 cell<" in result.part._repr_html_()
        other = moved(np.array(TETRA, float), 10, 0, 0)
        two = cells("tetra", *([tetra[k] for k in (1, 0, 2, 3)] for tetra in (TETRA, other.tolist())))
        assert inertia.analyse(two).notes == (
            "2 cells number their nodes the other way round: their volume counts positive",
        )


def bar(width, generator):
    """Return a slanted bar of 1 × width × width, its triangles and their corners in any order."""
    turn = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    corners = generator.permutation(mapped(box(1.0, width, width), turn)) + generator.uniform(-1, 1, 3)
    return np.array([np.roll(corner, generator.integers(3), axis=0) for corner in corners])


@pytest.mark.parametrize("width", [1e-6, 1e-7, 1e-8, 1e-10])
@pytest.mark.parametrize("accuracy", [None, 1e-15, "exact"])
def test_whether_thin_bars_have_a_volume_is_decided_by_integers(width, accuracy):
    generator = np.random.default_rng(0)
    for _ in range(5):
        part = surface(bar(width, generator), bar(width, generator) + 4)
        true = exact(part, 1).volume
        assert 0.9 * 2 * width**2 < true < 1.1 * 2 * width**2 or width < 1e-8
        if true > 0:
            properties = inertia.mass_properties(part, accuracy=accuracy)
            assert_within_bound(properties, exact(part))
            assert properties.error.volume <= 1e-9


@pytest.mark.parametrize("width", [1e-8, 1e-9])
def test_an_inward_bar_thinner_than_float64_can_tell_is_turned(width):
    generator = np.random.default_rng(1)
    for count in (1, 2):
        bars = [bar(width, generator) + 4 * k for k in range(count)]
        inward = surface(*(flipped(corners) for corners in bars))
        properties = inertia.mass_properties(inward, orientation="absolute")
        assert properties.volume == inertia.mass_properties(surface(*bars)).volume


class TestOnePass:
    """A small surface that one compiled pass shows to be closed, in one piece and free of crossings is sound."""

    @pytest.fixture
    def pairings(self, monkeypatch: pytest.MonkeyPatch) -> list[int]:
        if not at_hand():
            pytest.skip("the pass is compiled, and there is no compiler here")
        counts: list[int] = []

        def counted(triangles, progress=None):
            counts.append(triangles.count)
            return closure(triangles, progress)

        monkeypatch.setattr(integration, "closure", counted)
        return counts

    @pytest.mark.parametrize("of", [facets, surface])
    def test_its_edges_are_not_paired_again(self, pairings, of):
        part = of(sphere(2, 16))
        result = inertia.analyse(part, {"1": STEEL})
        assert pairings == []
        again = inertia.analyse(part, {"1": STEEL}, intersections=False)
        assert pairings == [part.triangles.count]
        assert (result.closed, result.bodies, result.crossings_examined) == (True, 1, True)
        assert (again.closed, again.bodies, again.crossings_examined) == (True, 1, False)
        assert result.properties.inertia.tolist() == again.properties.inertia.tolist()
        assert result.properties.error.inertia == pytest.approx(again.properties.error.inertia, rel=1e-9)

    def test_others_are(self, pairings):
        hollow = inertia.analyse(facets(*HOLLOW), STEEL)
        assert (hollow.bodies, len(pairings)) == (1, 1)
        with pytest.raises(GeometryError, match="open: 1 boundary loop"):
            inertia.analyse(facets(sphere(2, 16)[3:]), STEEL)
