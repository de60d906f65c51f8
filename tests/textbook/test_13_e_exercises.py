"""The exercises of chapter 13, 1 to 15, with the numbers out of the toolkit."""

import math

import numpy as np
import pytest
from tests.mass.parts import cube, surface
from tests.textbook.worked import G, follow, free, on_axle, refined, tilted

import inertia
from inertia import (
    MassProperties,
    inverse_dynamics,
    lamina,
    mass_properties,
    point_masses,
    principal,
    reexpress,
    steiner,
)
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import direction_cosines, from_angles, to_angles
from inertia.dynamics.kinematics.geometry import cones
from inertia.dynamics.models.heavy.top import HeavyTop
from inertia_meshes import path
from inertia_meshes.shapes import revolved, sphere

TINY = 1e-14


def test_1_a_shell_rolls_up_a_step():
    """⅔ m R² about its middle, and m R² more, 5/3 m R², about the tip of a step of height h.

    It rolls up at v: L about the tip is m v (R − h) + ⅔ m R² v/R = m v (5R/3 − h), which the impact keeps. It gets up
    if ½ L²/(5/3 m R²) ≥ m g h, that is v² ≥ 30 g h R²/(5R − 3h)²: for R = 3 m, h = 1 m 18.39 m²/s².
    """
    radius, height = 3.0, 1.0
    shell = mass_properties(surface(sphere(radius, 256)), mass=2.0, shell=1e-3)
    np.testing.assert_allclose(shell.inertia, 2 / 3 * 2 * 9 * np.eye(3), atol=2e-3 * 12)
    tip = [math.sqrt(radius**2 - (radius - height) ** 2), 0, height - radius]
    about_tip = shell.about(tip)[1, 1]
    assert about_tip == pytest.approx(5 / 3 * 2 * 9, rel=1e-3)
    momentum_per_speed = shell.mass * (radius - height) + shell.inertia[1, 1] / radius
    least = 2 * shell.mass * G * height * about_tip / momentum_per_speed**2
    assert least == pytest.approx(30 * G * height * radius**2 / (5 * radius - 3 * height) ** 2, rel=2e-3)
    top = math.acos((radius - height) / radius)  # the angle at which the middle is above the tip
    body = {"inertia": shell.inertia.tolist(), "mass": shell.mass, "center_of_mass": shell.center_of_mass.tolist()}
    held = {"kind": "hinge", "point": tip, "axis": [0, 1, 0]}
    for share, gets_up in ((0.99, False), (1.01, True)):
        spin = momentum_per_speed * math.sqrt(share * least) / about_tip
        run = follow(body, [0, spin, 0], 4.0, frame="part", constraint=held, load=[{"kind": "gravity"}])
        assert (run.quantities["angle"].max() > top) == gets_up


def test_2_direction_cosines():
    """x′ = (1, 1, −2)/√6, y′ = (−1, 1, 0)/√2, z′ = (1, 1, 1)/√3, x′ × y′ = z′.

    λ33 = cosθ = 1/√3; λ31 = sinφ sinθ, λ32 = −cosφ sinθ are equal: φ = 135°; λ13 = sinθ sinψ = −2/√6, λ23 =
    sinθ cosψ = 0: ψ = −90°.
    """
    x, z = np.array([1, 1, -2]) / math.sqrt(6), np.array([1, 1, 1]) / math.sqrt(3)
    y = np.array([-1, 1, 0]) / math.sqrt(2)
    angles = [math.radians(135), math.acos(1 / math.sqrt(3)), -math.pi / 2]
    np.testing.assert_allclose(direction_cosines(angles), [x, y, z], atol=TINY)
    attitude = quaternion.from_matrix(np.column_stack([x, y, z]))
    np.testing.assert_allclose(to_angles(attitude), angles, atol=TINY)
    with pytest.raises(inertia.UsageError, match="left-handed"):
        reexpress(np.eye(3), np.column_stack([y, x, z]))


def test_3_a_cube_on_a_wire():
    """A spherical top: the same about every axis through the middle, so that the periods are 1 : 1 : 1."""
    body = mass_properties(surface(cube(-0.5, -0.5, -0.5)))
    assert body.principal.kind == "spherical"
    for axis in ([1, 1, 1], [1, 1, 0], [1, 0, 0]):
        n = np.array(axis) / np.linalg.norm(axis)
        assert n @ body.inertia @ n == pytest.approx(1000 / 6, rel=TINY)


def test_4_a_dumbbell_askew_on_its_axle():
    """Rod in the x–z plane of the body: Ixx = 2MA² cos²θ, Iyy = 2MA², Izz = 2MA² sin²θ, Ixz = −2MA² sinθ cosθ.

    In space L = I(t)·ω z is the sum of M r × v of both ends at every instant, and dL/dt = ω × L the torque,
    2MA² ω² sinθ cosθ across the axle. T = MA² ω² sin²θ.
    """
    mass, half, theta, omega = 2.0, 0.5, 0.6, 7.0
    s, c, unit = math.sin(theta), math.cos(theta), 2 * mass * half**2
    end = half * np.array([s, 0, c])
    body = point_masses([end, -end], [mass, mass])
    np.testing.assert_allclose(
        body.inertia, unit * np.array([[c * c, 0, -s * c], [0, 1, 0], [-s * c, 0, s * s]]), atol=TINY
    )
    spin = np.array([0, 0, omega])
    for instant in (0.0, 0.1, 0.35):
        turn = quaternion.from_rotation_vector(spin * instant)
        momentum = quaternion.to_space(turn, body.inertia @ spin)
        place = quaternion.to_space(turn, end)
        np.testing.assert_allclose(momentum, 2 * mass * np.cross(place, np.cross(spin, place)), atol=TINY)
    run = on_axle(body, spin, omega)
    torque = run.quantities["reaction torque"]
    np.testing.assert_allclose(np.linalg.norm(torque, axis=1), unit * omega**2 * s * c, rtol=1e-13)
    np.testing.assert_allclose(torque @ spin, 0, atol=1e-12)
    np.testing.assert_allclose(run.energy, mass * half**2 * omega**2 * s * s, rtol=1e-13)
    assert spin @ body.inertia @ spin / 2 == pytest.approx(mass * half**2 * omega**2 * s * s, rel=TINY)


def test_5_the_least_spin_of_a_steady_precession():
    """I1 cosθ φ̇² − p_ψ φ̇ + m g h = 0 has real roots for p_ψ = I3 ω′ ≥ √(4 m g h I1 cosθ).

    I1 = 2, I3 = 1, m g h = 4, θ = 60°: ω′ ≥ 4 rad/s, and then φ̇ = p_ψ/(2 I1 cosθ) = 2 rad/s.
    """
    theta = math.pi / 3
    top = HeavyTop.of_state((2.0, 1.0), 4.0, tilted(theta), [0, 0, 4.0])
    assert top.least_p_psi(theta) / top.I3 == pytest.approx(4, rel=TINY)
    assert top.steady_precession(theta) == pytest.approx((2, 2), rel=1e-6)
    slower = HeavyTop.of_state((2.0, 1.0), 4.0, tilted(theta), [0, 0, 3.99])
    with pytest.raises(inertia.GeometryError, match="too small for a steady precession"):
        slower.steady_precession(theta)


def test_6_a_tensor_of_a_thin_rod():
    """I [[½, −½, 0], [−½, ½, 0], [0, 0, 1]]: moments 0, I, I; a thin rod along (1, 1, 0).

    For ω ∝ (1, 0, 1), L ∝ (½, −½, 1) is not along ω, and it takes a torque to keep it up; for ω ∝ (1, −1, 0) L = I ω,
    none does, and T = ½ I ω².
    """
    tensor = 3 * np.array([[0.5, -0.5, 0], [-0.5, 0.5, 0], [0, 0, 1]])
    result = principal(tensor)
    np.testing.assert_allclose(result.moments, [0, 3, 3], atol=TINY * 3)
    np.testing.assert_allclose(result.axes[:, 0], np.array([1, 1, 0]) / math.sqrt(2), atol=TINY)
    np.testing.assert_allclose(reexpress(tensor, result.axes), np.diag([0, 3, 3]), atol=TINY * 3)
    assert result.kind == "rotor"
    assert result.equal == ((1, 2),)
    skew, along = np.array([1, 0, 1]), np.array([1, -1, 0])
    np.testing.assert_allclose(inverse_dynamics(tensor, skew, [0, 0, 0]), [1.5, -1.5, -1.5], atol=TINY)
    np.testing.assert_allclose(inverse_dynamics(tensor, along, [0, 0, 0]), 0, atol=TINY)
    assert along @ tensor @ along / 2 == pytest.approx(0.5 * 3 * 2, rel=TINY)


def test_7_a_disc_turned_out_of_its_axle():
    """ω = A n̂ + B ẑ: L = I1 ω + (I3 − I1)(ω·n̂) n̂ goes round with B ẑ.

    That takes the torque B ẑ × L = B sinβ (I3 A + (I3 − I1) B cosβ) along ẑ × n̂, β being between the two.
    """
    disc = mass_properties(inertia.read(path("disc.stl")), mass=1.0)
    tilt, own, carried = 0.4, 30.0, 5.0
    n = np.array([math.sin(tilt), 0, math.cos(tilt)])
    axes = quaternion.matrix(quaternion.from_rotation_vector([0, tilt, 0]))
    omega = own * n + carried * np.array([0, 0, 1])
    i1, i3 = disc.principal_moments[0], disc.principal_moments[2]
    momentum = i1 * omega + (i3 - i1) * (omega @ n) * n
    np.testing.assert_allclose(reexpress(disc.inertia, axes.T) @ omega, momentum, atol=1e-6 * i3 * own)
    change = [0, own * carried * math.sin(tilt), 0]  # of ω, as B ẑ carries A n̂ round
    torque = inverse_dynamics([i1, i1, i3], axes.T @ omega, axes.T @ change)
    magnitude = carried * math.sin(tilt) * (i3 * own + (i3 - i1) * carried * math.cos(tilt))
    np.testing.assert_allclose(axes @ torque, [0, magnitude, 0], atol=1e-12 * magnitude)


def test_8_ellipsoid():
    """M (b² + c²)/5 and so on."""
    semi = np.array([3.0, 2.0, 1.0])
    mass, _, tensor = refined(lambda n: sphere(1, n) * semi)
    squares = semi**2
    np.testing.assert_allclose(tensor, np.diag(mass * (squares.sum() - squares) / 5), atol=1e-5)
    again = MassProperties(mass, 0.0, [0, 0, 0], np.diag(np.diag(tensor))).equivalent_ellipsoid
    np.testing.assert_allclose(again, semi, rtol=1e-7)


def test_9_a_sphere_with_a_spherical_cavity():
    """Take the small ball off the large one; the middle moves by −ε r³/(R³ − r³).

    8πρ (R⁵ − r⁵)/15 along the line of both middles, and 4πρ/3 · ε² r³ R³/(R³ − r³) less across it.
    """
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


def test_9_the_same_as_one_mesh():
    result = mass_properties(inertia.read(path("sphere_cavity.stl")))
    outer, inner, rest = 0.020, 0.008, 0.020**3 - 0.008**3
    np.testing.assert_allclose(result.center_of_mass, np.array([-0.006, -0.004, -0.002]) * inner**3 / rest, rtol=2e-3)
    along = 8 * math.pi * 1000 * (outer**5 - inner**5) / 15
    off = np.array([6, 4, 2]) / math.sqrt(56)
    assert off @ result.inertia @ off == pytest.approx(along, rel=2e-2)


def test_10_three_masses_on_a_triangle():
    """In the y–z plane: m L² about x and half of that about every axis in the plane, y and z among them.

    Turned by 45° about z the axis of the largest moment is (1, 1, 0)/√2, and the moments are what they were.
    """
    side, mass = 2.0, 3.0
    low = -side / (2 * math.sqrt(3))
    body = point_masses([[0, 0, side / math.sqrt(3)], [0, side / 2, low], [0, -side / 2, low]], [mass] * 3)
    np.testing.assert_allclose(body.center_of_mass, 0, atol=TINY)
    np.testing.assert_allclose(body.inertia, mass * side**2 * np.diag([1, 0.5, 0.5]), atol=TINY * 12)
    part = side / (2 * math.sqrt(2))
    turned = point_masses([[0, 0, side / math.sqrt(3)], [-part, part, low], [part, -part, low]], [mass] * 3)
    np.testing.assert_allclose(turned.principal_moments, mass * side**2 * np.array([0.5, 0.5, 1]), rtol=TINY)
    np.testing.assert_allclose(np.abs(turned.principal_axes[:, 2] @ [1, 1, 0]), math.sqrt(2), rtol=TINY)
    assert turned.principal.kind == "oblate"


def test_11_cone():
    """About the apex 3/5 M (h² + R²/4) and 3/10 M R²; about the centre of mass, ¾ h below it, 3/20 M (R² + h²/4)."""
    radius, height = 1.0, 2.0
    mass, com, tensor = refined(lambda n: revolved([(0, 0), (radius, 0), (0, height)], n))
    np.testing.assert_allclose(com, [0, 0, height / 4], atol=1e-9)
    i1, i3 = 3 / 20 * mass * (radius**2 + height**2 / 4), 3 / 10 * mass * radius**2
    np.testing.assert_allclose(tensor, np.diag([i1, i1, i3]), atol=1e-8)
    apex = steiner(tensor, mass, com, about=com, to=[0, 0, height])
    i1 = 3 / 5 * mass * (height**2 + radius**2 / 4)
    np.testing.assert_allclose(apex, np.diag([i1, i1, i3]), atol=1e-7)


def test_12_four_masses():
    """diag(8, 2, 10) m a²; about n = (1, 1, 1)/√3 20/3 m a²; cos∠(L, n) = 20/√(3 · 168)."""
    mass, a = 2.0, 0.5
    body = point_masses([[a, 0, 0], [-a, 0, 0], [0, 2 * a, 0], [0, -2 * a, 0]], [mass] * 4)
    np.testing.assert_allclose(body.inertia, mass * a * a * np.diag([8, 2, 10]), atol=TINY)
    n = np.ones(3) / math.sqrt(3)
    momentum = body.inertia @ n
    assert n @ momentum == pytest.approx(20 / 3 * mass * a * a, rel=TINY)
    assert n @ momentum / np.linalg.norm(momentum) == pytest.approx(20 / math.sqrt(3 * 168), rel=TINY)


def test_13_a_cube_falls_off_its_edge():
    """ω² = A (g/l)(√2 − 1): the middle sinks by ½ l (√2 − 1).

    Held, all of it goes into ½ · ⅔ M l² ω²: A = 3/2. Without friction the middle falls straight, at the end with
    ½ l ω, and ½ (⅙ + ¼) M l² ω² takes it: A = 12/5.
    """
    edge, mass = 0.3, 1.7
    box = mass_properties(surface(cube(size=edge)), mass=mass)
    released = mass * G * edge * (math.sqrt(2) - 1) / 2
    held = 2 * released / box.about([0, 0, 0])[0, 0]
    sliding = 2 * released / (box.inertia[0, 0] + mass * edge**2 / 4)
    for result, factor in ((held, 3 / 2), (sliding, 12 / 5)):
        assert result == pytest.approx(factor * G / edge * (math.sqrt(2) - 1), rel=1e-13)


def test_14_the_axis_of_a_free_symmetric_body():
    """φ̇ = L/I1 = ω √(sin²α + (I3/I1)² cos²α): I3/I1 = ¾, tanα = 1, ω = 8 rad/s give 5√2."""
    alpha, theta = math.pi / 4, math.atan(4 / 3)
    spin = [0, 8 * math.sin(alpha), 8 * math.cos(alpha)]
    assert cones([4, 4, 3], spin).precession == pytest.approx(5 * math.sqrt(2), rel=TINY)
    run = free([4, 4, 3], spin, 2.0, attitude=from_angles([0, theta, 0]).tolist())
    phi, tilt, _ = run.euler_angles().T
    np.testing.assert_allclose(phi, 5 * math.sqrt(2) * run.time, atol=1e-12)
    np.testing.assert_allclose(tilt, theta, atol=1e-13)


@pytest.mark.parametrize(("a", "b"), [(2.0, 1.0), (3.0, 5.0), (1.0, 1.0)])
def test_15_a_plate_about_its_diagonal(a, b):
    """|ω × I·ω| = M ω² ab |a² − b²|/(12 (a² + b²)): zero for a square, whose diagonal is a principal axis."""
    omega = 11.0
    plate = lamina([[0, 0], [a, 0], [a, b], [0, b]], 4.0)
    torque = np.linalg.norm(on_axle(plate, [a, b, 0], omega).quantities["reaction torque"], axis=1)
    expected = plate.mass * omega**2 * a * b * abs(a * a - b * b) / (12 * (a * a + b * b))
    np.testing.assert_allclose(torque, expected, rtol=1e-12, atol=1e-12)
