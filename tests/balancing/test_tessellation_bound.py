"""The bound from a chord tolerance holds against true solids and adverse layers, and spares plane faces."""

import math

import numpy as np
import pytest
from tests.balancing.rotors import STEEL, on_z, two_disc_part, two_disc_true
from tests.mass.parts import surface

import inertia
from inertia import UsageError
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.tessellation_bound import chord_uncertainty, curved_faces
from inertia.balancing.unbalance import Unbalance
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.surface import Surface
from inertia_meshes.shapes import box, mapped, moved, revolved, sphere

PLANES = (0.02, 0.28)


def curved(*pieces):
    return curved_faces(Surface(*merge_equal_vertices(surface(*pieces).triangles)))


class TestCurvedFaces:
    def test_a_box_has_none(self):
        assert not curved(box(3, 4, 5)).any()

    def test_a_sphere_has_nothing_else(self):
        assert curved(sphere(2.0, 24)).all()

    @pytest.mark.parametrize("segments", [7, 12, 96])
    def test_of_a_cylinder_they_are_its_mantle(self, segments):
        corners = revolved([(0, 0), (5, 0), (5, 8), (0, 8)], segments)
        level = np.ptp(corners[:, :, 2], axis=1) == 0
        np.testing.assert_array_equal(curved(corners), ~level)

    def test_a_facet_cut_up_into_coplanar_triangles_counts_as_a_whole(self):
        """The mantle in bands: only the diagonals and rings are flat, the rulings turn."""
        corners = revolved([(0, 0), (5, 0), (5, 1), (5, 2), (5, 8), (0, 8)], 16)
        level = np.ptp(corners[:, :, 2], axis=1) == 0
        np.testing.assert_array_equal(curved(corners), ~level)

    def test_the_answer_survives_float32_and_a_skew_frame(self):
        corners = revolved([(0, 0), (5, 0), (5, 8), (0, 8)], 48)
        level = np.ptp(corners[:, :, 2], axis=1) == 0
        turn = np.array([[2, -2, 1], [1, 2, 2], [-2, -1, 2]]) / 3
        stored = (mapped(corners, turn) + 20.0).astype(np.float32).astype(float)
        np.testing.assert_array_equal(curved(stored), ~level)

    def test_a_sliver_in_a_plane_face_does_not_make_it_curved(self):
        """Its own normal is off by 45°, though its corner is off by ten nanometres a metre."""
        corners = box(1, 1, 1)
        a, b, c = corners[0]
        normal = np.cross(b - a, c - a)
        across = np.cross(normal, b - a)
        middle = 0.5 * (a + b) + 1e-8 * across / np.linalg.norm(across) + 1e-8 * normal / np.linalg.norm(normal)
        halves = np.array([[a, middle, c], [middle, b, c], [a, b, middle]])
        assert not curved(np.concatenate([halves, corners[1:]])).any()


class TestBound:
    def test_holds_for_the_true_rotor_of_case_14(self):
        part, shaft = two_disc_part(), on_z(*PLANES)
        chord = 0.1 * (1 - math.cos(math.pi / 256))  # sagitta of the larger disc
        mesh = Unbalance.of(inertia.mass_properties(part, STEEL), shaft)
        mesh = mesh.with_uncertainties(chord_uncertainty(part, chord, STEEL, shaft, mesh.z))
        true = Unbalance.of(two_disc_true(), shaft)
        for one, other, limit in zip(
            mesh.in_planes(*PLANES), true.in_planes(*PLANES), mesh.bounds_in_planes(PLANES), strict=True
        ):
            assert abs(one - other) <= limit["tessellation"]
        assert abs(mesh.couple - true.couple_about(mesh.z)) <= mesh.couple_bound

    @pytest.mark.parametrize("sides", ["one", "both"])
    @pytest.mark.parametrize("lever", [0.0, 1.0])
    def test_holds_for_the_worst_layers_and_is_less_than_three_times_them(self, sides, lever):
        """Layers of thickness h on the facets with x > 0, and off the others where both sides may err."""
        radius, z_a, z_b, n, h = 0.05, 0.1, 0.3, 90, 1e-6
        part = surface(revolved([(0, z_a), (radius, z_a), (radius, z_b), (0, z_b)], n))
        shaft = on_z(0.0, 0.4)
        result = chord_uncertainty(part, h, STEEL, shaft, 0.2)
        middle, width = radius * math.cos(math.pi / n), 2 * radius * math.sin(math.pi / n)
        arms = middle * np.cos(2 * math.pi * (np.arange(n) + 0.5) / n)
        strips = 400
        along = z_a + (z_b - z_a) * (np.arange(strips) + 0.5) / strips - 0.2
        weights = np.abs(lever * along) if lever else np.ones(strips)
        layer = STEEL * h * width * (z_b - z_a) / strips * weights.sum()
        moved_ = layer * (np.abs(arms).sum() if sides == "both" else arms[arms > 0].sum())
        bound = result.bound(0.0, 1.0) if lever else result.bound(1.0, 0.0)
        assert moved_ <= bound < (2.4 if sides == "one" else 1.2) * moved_

    def test_a_tenth_of_the_chord_leaves_at_most_a_tenth_of_the_bound(self):
        part, shaft = two_disc_part(), on_z(*PLANES)
        fine, coarse = (chord_uncertainty(part, h, STEEL, shaft, 0.15).bound(1.0, 0.0) for h in (1e-6, 1e-5))
        assert 0.09 * coarse < fine <= 0.1 * coarse

    def test_does_not_depend_on_the_frame(self):
        corners = moved(revolved([(0, 0), (5, 0), (5, 8), (0, 8)], 48), 1.0, 0.5, 0.0)
        turn = np.array([[2, -2, 1], [1, 2, 2], [-2, -1, 2]]) / 3
        straight = chord_uncertainty(surface(corners), 1e-3, STEEL, on_z(0, 8), 4.0)
        shaft = Shaft([0, 0, 0], turn @ [0, 0, 8], turn @ [1, 0, 0])
        skew = chord_uncertainty(surface(mapped(corners, turn)), 1e-3, STEEL, shaft, 4.0)
        for p, q in ((1.0, 0.0), (0.0, 1.0), (0.5, 0.125)):
            assert skew.bound(p, q) == pytest.approx(straight.bound(p, q), rel=0.02)

    def test_of_a_body_of_planes_is_nothing(self):
        bound = chord_uncertainty(surface(box(3, 4, 5)), 1e-3, STEEL, on_z(), 0.0)
        assert bound.bound(1.0, 1.0) == 0

    @pytest.mark.parametrize(("chord", "density"), [(0.0, 1.0), (math.nan, 1.0), (1e-5, -1.0)])
    def test_figures_that_are_none_are_refused(self, chord, density):
        with pytest.raises(UsageError, match="must be positive and finite"):
            chord_uncertainty(surface(box(3, 4, 5)), chord, density, on_z(), 0.0)
