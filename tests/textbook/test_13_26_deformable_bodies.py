"""§ 13.26: bodies that change their shape: L is kept, and yet they turn, twist and speed up at will."""

import math

import numpy as np
import pytest

import inertia
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import to_angles, unwrap
from inertia_meshes import path


def sample(name):
    return inertia.simulate(inertia.Scene.load(path(f"scenes/{name}.toml")))


def test_the_cat():
    """L = 0. Bent by β, both halves turn once about their own axes; the plane of the bend goes back by part of a turn.

    Two cylinders of axial and transverse moments A and B that meet at an end: the mean direction of the spine goes
    through both centres of mass, and about it the tensor is 2 (A c² + B s²), c and s of β/2, once the halves are still.
    Turning at σ̇ about their own axes they carry 2 A σ̇ c along it. Zero in sum: the plane turns by A c/(A c² + B s²) of
    a turn, which is one half for (A − B) c² − 2 A c + B = 0. With A = 0.00288, B = 0.0078933 kg m²: β = 1.2683 rad.
    """
    a, b = 0.00288, 0.007893333333333334
    c = math.cos(1.2683476041568686 / 2)
    assert (a - b) * c * c - 2 * a * c + b == pytest.approx(0, abs=1e-15)
    run = sample("cat")
    feet = quaternion.to_space(run.attitude, [1.0, 0.0, 0.0])
    np.testing.assert_allclose(feet[[0, -1]], [[0, 0, 1], [0, 0, -1]], atol=1e-12)
    np.testing.assert_allclose(run.angular_momentum, 0, atol=1e-15)
    np.testing.assert_allclose(run.position[:, 2], 1 - 0.5 * 9.80665 * run.time**2, atol=1e-15)


def test_the_skater():
    """8 kg at 0.7 m and then at 0.2 m, beside 0.585 kg m²: 4.505 and 0.905, so that 8 rad/s become 39.82.

    T = L²/2I: from 144.16 J to 717.6 J, by the work of the arms.
    """
    run = sample("skater")
    pulled = run.time.searchsorted(2.5)
    np.testing.assert_allclose(run.angular_velocity[pulled], [0, 0, 8 * 4.505 / 0.905], atol=1e-12)
    assert run.energy[pulled] == pytest.approx(36.04**2 / (2 * 0.905))
    assert run.quantities["work of the joints"][pulled] == pytest.approx(36.04**2 / 2 * (1 / 0.905 - 1 / 4.505))
    np.testing.assert_allclose(run.angular_velocity[-1], [0, 0, 8], atol=1e-12)


def test_the_diver():
    """One arm swung down in flight tilts the body off its L, and it twists: 3 times, until the arm goes up again.

    With L along the third axis of space, the z-x-z angles of the long axis are somersault, tilt and twist. At a tilt θ
    the body twists at (1/I1 − 1/I⊥) L cosθ, I⊥ the mean of the two other moments: some 22 rad/s at 0.145 rad off the
    right angle.
    """
    run = sample("diver")
    momentum = run.angular_momentum[0]
    np.testing.assert_allclose(run.angular_momentum, np.broadcast_to(momentum, (341, 3)), atol=1e-11)
    np.testing.assert_allclose(momentum, [0, 116.0317, 0], atol=1e-4)
    quarter = [math.sqrt(0.5), 0, 0, math.sqrt(0.5)]  # takes y to z
    angles = unwrap(to_angles(quaternion.multiply(quarter, run.attitude)))
    somersault, tilt, twist = angles.T
    assert (twist[-1] - twist[0]) / (2 * math.pi) == pytest.approx(-3, abs=1e-6)
    assert (somersault[-1] - somersault[0]) / (2 * math.pi) > 1.7
    assert tilt[[0, -1]] == pytest.approx(math.pi / 2, abs=1e-5)
    held = (run.time > 0.6) & (run.time < 1.2)
    long, *across = run.quantities["principal moments"][held].mean(axis=0)
    expected = (1 / long - 2 / sum(across)) * momentum[1] * np.cos(tilt[held]).mean()
    assert np.gradient(twist, run.time)[held].mean() == pytest.approx(expected, rel=0.01)


def test_a_man_on_a_stool():
    """3 kg m² hold a wheel of 1 kg m² above their head: one turn of it turns them back by ¼ of a turn."""
    man = {"name": "man", "mass": 80.0, "principal_moments": [9.0, 9.0, 3.0]}
    turn = {"axis": [0, 0, 1], "times": [0.0, 1.0], "angles": [0.0, 2 * math.pi]}
    wheel = {"name": "wheel", "mass": 1.0, "principal_moments": [0.5, 0.5, 1.0], "parent": "man", "joint": [turn]}
    run = inertia.simulate(
        inertia.Scene.from_dict(
            {"part": [man, wheel], "start": {"angular_velocity": [0, 0, 0]}, "run": {"duration": 1.0, "samples": 3}}
        )
    )
    np.testing.assert_allclose(run.attitude[-1], [0, 0, -math.sqrt(0.5), math.sqrt(0.5)], atol=1e-12)
