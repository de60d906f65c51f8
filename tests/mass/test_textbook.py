"""The mass properties of the textbook's chapter on rigid-body rotation, got as a user gets them.

Sections (§) and numbered exercises are those of its chapter 13.
"""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.mass.parts import cube, surface

import inertia
from inertia import MassProperties, lamina, mass_properties, point_masses, principal, reexpress, steiner, wire
from inertia_meshes import path
from inertia_meshes.shapes import revolved, sphere

TINY = 1e-14


def refined(shape, density=1.0):
    """Take the errors of orders 2 and 4 out of the answers for 48, 96 and 192 segments (Richardson)."""
    found = [mass_properties(surface(shape(n)), density) for n in (48, 96, 192)]
    rows = np.array([[body.mass, *body.center_of_mass, *body.inertia.ravel()] for body in found])
    for order in (2, 4):
        rows = (2**order * rows[1:] - rows[:-1]) / (2**order - 1)
    (answer,) = rows
    return float(answer[0]), answer[1:4], answer[4:].reshape(3, 3)


class TestSolids:
    """§ 13.4: moments of the standard solids."""

    def test_ball(self):
        mass, com, tensor = refined(lambda n: sphere(2, n))
        assert mass == pytest.approx(4 / 3 * math.pi * 8, rel=1e-8)
        np.testing.assert_allclose(com, 0, atol=1e-12)
        np.testing.assert_allclose(tensor, 0.4 * mass * 4 * np.eye(3), atol=1e-6)

    def test_cylinder(self):
        radius, height = 2.0, 3.0
        mass, com, tensor = refined(lambda n: revolved([(0, 0), (radius, 0), (radius, height), (0, height)], n))
        across = mass * (3 * radius**2 + height**2) / 12
        np.testing.assert_allclose(tensor, np.diag([across, across, mass * radius**2 / 2]), atol=1e-7)
        np.testing.assert_allclose(com, [0, 0, 1.5], atol=1e-12)

    def test_cuboid(self):
        found = mass_properties(surface(cube() * [1, 2, 3]), mass=12.0)
        np.testing.assert_allclose(found.inertia, np.diag([13, 10, 5]), atol=TINY * 13)

    def test_rod(self):
        rod = wire([[0, 0, -1], [0, 0, 1]], 1.5)
        np.testing.assert_allclose(rod.inertia, np.diag([1, 1, 0]), atol=TINY)
        assert rod.principal.kind == "rotor"

    def test_ring_of_wire(self):
        angle = np.linspace(0, 2 * math.pi, 2001)
        ring = wire(np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]), 1.0)
        np.testing.assert_allclose(ring.inertia / ring.mass, np.diag([0.5, 0.5, 1]), atol=1e-5)


class TestSteiner:
    """§ 13.8: J = I + M (a² δ − a aᵀ)."""

    def test_from_the_centre_of_mass(self):
        body = MassProperties(2.0, 1.0, [1, 0, 0], np.diag([1.0, 2.0, 2.5]))
        a = np.array([1, 0, 0]) - [0, 2, 3]
        expected = body.inertia + 2 * (a @ a * np.eye(3) - np.outer(a, a))
        np.testing.assert_allclose(body.about([0, 2, 3]), expected, rtol=TINY)
        np.testing.assert_allclose(
            steiner(body.inertia, 2.0, [1, 0, 0], about=[1, 0, 0], to=[0, 2, 3]), expected, rtol=TINY
        )

    def test_back_to_it_and_between_any_two_points(self):
        body = MassProperties(3.0, 1.0, [0.1, 0.2, 0.3], np.diag([4.0, 5.0, 6.0]))
        p, q = [1, 2, 3], [-1, 0.5, 2]
        np.testing.assert_allclose(
            steiner(body.about(p), 3.0, body.center_of_mass, about=p, to=q), body.about(q), rtol=1e-13
        )
        np.testing.assert_allclose(
            steiner(body.about(p), 3.0, body.center_of_mass, about=p, to=body.center_of_mass),
            body.inertia,
            atol=1e-13,
        )

    def test_a_cube_about_its_edge(self):
        """2/3 M l² about an edge: what ex. 13 starts from."""
        box = mass_properties(surface(cube(size=2)), mass=3.0)
        assert box.about([0, 0, 0])[2, 2] == pytest.approx(2 / 3 * 3 * 4, rel=TINY)


class TestLaminae:
    """§ 13.9: I1 + I2 = I3."""

    @pytest.mark.parametrize("outline", [[[0, 0], [3, 0], [0, 4]], [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]])
    def test_perpendicular_axes(self, outline):
        i1, i2, i3 = lamina(outline, 2.0).principal_moments
        assert i1 + i2 == pytest.approx(i3, rel=TINY)

    def test_a_thin_plate_comes_near(self):
        i1, i2, i3 = mass_properties(inertia.read(path("thin_plate.stl"))).principal_moments
        assert i3 < i1 + i2 < i3 * (1 + 1e-5)

    def test_a_tensor_that_breaks_the_rule_is_refused(self):
        with pytest.raises(inertia.GeometryError, match="triangle rule"):
            MassProperties(1.0, 1.0, [0, 0, 0], np.diag([1.0, 1.0, 2.1]))


class TestEquivalence:
    """§ 13.10: the ellipsoid and the class."""

    @pytest.mark.parametrize(
        ("sample", "kind", "tolerance"),
        [
            ("cube.stl", "spherical", 1e-6),
            ("needle.stl", "prolate", 1e-6),
            ("needle.stl", "rotor", 1e-4),
            ("disc.stl", "oblate", 1e-6),
            ("t_handle.stl", "asymmetric", 1e-6),
        ],
    )
    def test_classes(self, sample, kind, tolerance):
        found = inertia.analyse(inertia.read(path(sample)), class_tolerance=tolerance)
        assert found.principal.kind == kind

    def test_the_equivalent_ellipsoid_has_the_same_moments(self):
        body = mass_properties(inertia.read(path("t_handle.stl")))
        a, b, c = body.equivalent_ellipsoid
        again = body.mass / 5 * np.array([b * b + c * c, c * c + a * a, a * a + b * b])
        np.testing.assert_allclose(again, body.principal_moments, rtol=1e-13)
        assert a > b > c

    def test_radii_of_gyration(self):
        body = mass_properties(surface(cube(size=2)))
        np.testing.assert_allclose(body.radii_of_gyration, 2 / math.sqrt(6), rtol=TINY)


class TestExercises:
    def test_1_spherical_shell(self):
        found = mass_properties(surface(sphere(3, 256)), mass=2.0, shell=1e-3)
        np.testing.assert_allclose(found.inertia, 2 / 3 * 2 * 9 * np.eye(3), atol=2e-3 * 12)
        about_the_tip = found.about([0, -3, 0])[0, 0]
        assert about_the_tip == pytest.approx(5 / 3 * 2 * 9, rel=1e-3)

    def test_2_direction_cosines(self):
        x, z = np.array([1, 1, -2]) / math.sqrt(6), np.array([1, 1, 1]) / math.sqrt(3)
        y = np.array([-1, 1, 0]) / math.sqrt(2)
        axes = np.column_stack([x, y, z])
        turned = reexpress(axes @ np.diag([1.0, 2.0, 2.5]) @ axes.T, axes)
        np.testing.assert_allclose(turned, np.diag([1, 2, 2.5]), atol=TINY)
        with pytest.raises(inertia.UsageError, match="left-handed"):
            reexpress(np.eye(3), np.column_stack([y, x, z]))

    def test_3_cube_on_a_wire(self):
        """A spherical top: about any axis through the middle the same, so that the periods are 1 : 1 : 1."""
        body = mass_properties(surface(cube(-0.5, -0.5, -0.5)))
        assert body.principal.kind == "spherical"
        for axis in ([1, 1, 1], [1, 1, 0], [1, 0, 0]):
            n = np.array(axis) / np.linalg.norm(axis)
            assert n @ body.inertia @ n == pytest.approx(1000 / 6, rel=TINY)

    def test_4_dumbbell(self):
        mass, half, theta, omega = 2.0, 0.5, 0.6, 7.0
        end = half * np.array([math.sin(theta), 0, math.cos(theta)])
        body = point_masses([end, -end], [mass, mass])
        s, c, unit = math.sin(theta), math.cos(theta), 2 * mass * half**2
        expected = unit * np.array([[c * c, 0, -s * c], [0, 1, 0], [-s * c, 0, s * s]])
        np.testing.assert_allclose(body.inertia, expected, atol=TINY)
        spin = np.array([0, 0, omega])
        torque = np.cross(spin, body.inertia @ spin)
        assert np.linalg.norm(torque) == pytest.approx(unit * omega**2 * s * c, rel=TINY)
        assert spin @ body.inertia @ spin / 2 == pytest.approx(mass * half**2 * omega**2 * s * s, rel=TINY)

    def test_6_a_tensor_of_a_thin_rod(self):
        tensor = 3 * np.array([[0.5, -0.5, 0], [-0.5, 0.5, 0], [0, 0, 1]])
        found = principal(tensor)
        np.testing.assert_allclose(found.moments, [0, 3, 3], atol=TINY * 3)
        np.testing.assert_allclose(found.axes[:, 0], np.array([1, 1, 0]) / math.sqrt(2), atol=TINY)
        assert found.kind == "rotor"
        assert found.equal == ((1, 2),)
        skew, along = np.array([1, 0, 1]), np.array([1, -1, 0])
        assert np.linalg.norm(np.cross(skew, tensor @ skew)) > 1
        np.testing.assert_allclose(np.cross(along, tensor @ along), 0, atol=TINY)

    def test_7_disc_turned_out_of_its_axle(self):
        """L and the torque of a disc that spins at A about its own axis n and is carried round z at B."""
        disc = mass_properties(inertia.read(path("disc.stl")), mass=1.0)
        tilt, own, carried = 0.4, 30.0, 5.0
        n = np.array([math.sin(tilt), 0, math.cos(tilt)])
        axes = Rotation.from_rotvec([0, tilt, 0]).as_matrix()
        tensor = reexpress(disc.inertia, axes.T)
        omega = own * n + carried * np.array([0, 0, 1])
        i1, i3 = disc.principal_moments[0], disc.principal_moments[2]
        expected = i1 * omega + (i3 - i1) * (omega @ n) * n
        np.testing.assert_allclose(tensor @ omega, expected, atol=1e-6 * i3 * own)
        torque = np.cross([0, 0, carried], expected)
        magnitude = carried * math.sin(tilt) * (i3 * own + (i3 - i1) * carried * math.cos(tilt))
        assert np.linalg.norm(torque) == pytest.approx(magnitude, rel=1e-12)

    def test_8_ellipsoid(self):
        semi = np.array([3.0, 2.0, 1.0])
        mass, _, tensor = refined(lambda n: sphere(1, n) * semi)
        squares = semi**2
        np.testing.assert_allclose(tensor, np.diag(mass * (squares.sum() - squares) / 5), atol=1e-5)
        np.testing.assert_allclose(
            MassProperties(mass, 0.0, [0, 0, 0], np.diag(np.diag(tensor))).equivalent_ellipsoid, semi, rtol=1e-7
        )

    def test_9_sphere_with_a_spherical_cavity(self):
        outer, inner, off, rho = 2.0, 0.5, 0.75, 3.0

        def ball(radius, x):
            mass = 4 / 3 * math.pi * rho * radius**3
            return MassProperties(mass, mass / rho, [x, 0, 0], 0.4 * mass * radius**2 * np.eye(3))

        body = ball(outer, 0.0) - ball(inner, off)
        rest = outer**3 - inner**3
        along = 8 * math.pi * rho * (outer**5 - inner**5) / 15
        across = along - 4 / 3 * math.pi * rho * off**2 * inner**3 * outer**3 / rest
        assert body.mass == pytest.approx(4 / 3 * math.pi * rho * rest, rel=TINY)
        np.testing.assert_allclose(body.center_of_mass, [-off * inner**3 / rest, 0, 0], rtol=TINY)
        np.testing.assert_allclose(body.inertia, np.diag([along, across, across]), rtol=TINY)

    def test_9_the_same_as_one_mesh(self):
        found = mass_properties(inertia.read(path("sphere_cavity.stl")))
        outer, inner, rest = 0.020, 0.008, 0.020**3 - 0.008**3
        np.testing.assert_allclose(
            found.center_of_mass, np.array([-0.006, -0.004, -0.002]) * inner**3 / rest, rtol=2e-3
        )
        along = 8 * math.pi * 1000 * (outer**5 - inner**5) / 15
        off = np.array([6, 4, 2]) / math.sqrt(56)
        assert off @ found.inertia @ off == pytest.approx(along, rel=2e-2)

    def test_10_three_masses_on_a_triangle(self):
        side, mass = 2.0, 3.0
        body = point_masses([[0, 0, 0], [side, 0, 0], [side / 2, side * math.sqrt(3) / 2, 0]], [mass] * 3)
        expected = mass * side**2 * np.diag([0.5, 0.5, 1])
        np.testing.assert_allclose(body.inertia, expected, atol=TINY * 12)
        turned = body.expressed_in(Rotation.from_euler("z", 45, degrees=True).as_matrix())
        np.testing.assert_allclose(turned.inertia, expected, atol=TINY * 12)
        assert body.principal.kind == "oblate"

    def test_11_cone(self):
        radius, height = 1.0, 2.0
        mass, com, tensor = refined(lambda n: revolved([(0, 0), (radius, 0), (0, height)], n))
        np.testing.assert_allclose(com, [0, 0, height / 4], atol=1e-9)
        i1, i3 = 3 / 20 * mass * (radius**2 + height**2 / 4), 3 / 10 * mass * radius**2
        np.testing.assert_allclose(tensor, np.diag([i1, i1, i3]), atol=1e-8)
        apex = steiner(tensor, mass, com, about=com, to=[0, 0, height])
        i1 = 3 / 5 * mass * (height**2 + radius**2 / 4)
        np.testing.assert_allclose(apex, np.diag([i1, i1, i3]), atol=1e-7)

    def test_12_four_masses(self):
        mass, a = 2.0, 0.5
        body = point_masses([[a, 0, 0], [-a, 0, 0], [0, 2 * a, 0], [0, -2 * a, 0]], [mass] * 4)
        np.testing.assert_allclose(body.inertia, mass * a * a * np.diag([8, 2, 10]), atol=TINY)
        n = np.ones(3) / math.sqrt(3)
        momentum = body.inertia @ n
        assert n @ momentum == pytest.approx(20 / 3 * mass * a * a, rel=TINY)
        assert n @ momentum / np.linalg.norm(momentum) == pytest.approx(20 / math.sqrt(3 * 168), rel=TINY)

    def test_13_cube_falling_off_its_edge(self):
        """ω² = A (g/l)(√2 − 1): energy about the fixed edge (A = 3/2), or of a free fall of the middle (12/5)."""
        g, edge, mass = 9.80665, 0.3, 1.7
        box = mass_properties(surface(cube(size=edge)), mass=mass)
        released = mass * g * edge * (math.sqrt(2) - 1) / 2
        held = 2 * released / box.about([0, 0, 0])[0, 0]
        # Without friction the middle falls straight: at the end its speed is ω l/2.
        free = 2 * released / (box.inertia[0, 0] + mass * edge**2 / 4)
        for found, factor in ((held, 3 / 2), (free, 12 / 5)):
            assert found == pytest.approx(factor * g / edge * (math.sqrt(2) - 1), rel=1e-13)

    @pytest.mark.parametrize(("a", "b"), [(2.0, 1.0), (3.0, 5.0), (1.0, 1.0)])
    def test_15_plate_about_its_diagonal(self, a, b):
        omega = 11.0
        plate = lamina([[0, 0], [a, 0], [a, b], [0, b]], 4.0)
        spin = omega * np.array([a, b, 0]) / math.hypot(a, b)
        torque = np.linalg.norm(np.cross(spin, plate.inertia @ spin))
        expected = plate.mass * omega**2 * a * b * abs(a * a - b * b) / (12 * (a * a + b * b))
        assert torque == pytest.approx(expected, rel=1e-13, abs=1e-12)
