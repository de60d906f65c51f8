"""Serret–Andoyer variables: round trips, their geometry, and that they are canonical."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from inertia.dynamics.kinematics import canonical, quaternion
from inertia.dynamics.kinematics.andoyer import Andoyer, from_andoyer, hamiltonian, rates, to_andoyer
from inertia.dynamics.kinematics.euler_angles import from_angles
from inertia.errors import GeometryError, UsageError

component = st.floats(-1, 1)
four = st.lists(component, min_size=4, max_size=4)
three = st.lists(component, min_size=3, max_size=3)


def apart(p: np.ndarray, q: np.ndarray) -> float:
    return float(quaternion.angle_between(p, q))


@settings(deadline=None)
@given(four, three)
def test_attitude_and_momentum_come_back(q: list[float], momentum: list[float]) -> None:
    assume(np.linalg.norm(q) > 1e-3 and np.linalg.norm(momentum) > 1e-3)
    attitude = quaternion.normalise(q)
    again, body = from_andoyer(to_andoyer(attitude, momentum))
    assert apart(attitude, again) < 4e-15
    assert body == pytest.approx(momentum, abs=2e-15)


@pytest.mark.parametrize("tilt", [1e-3, 1e-8, 1e-12, math.pi - 1e-8])
def test_both_come_back_where_the_ratios_of_the_actions_have_lost_their_digits(tilt: float) -> None:
    momentum = np.array([math.sin(tilt) * 0.6, math.sin(tilt) * 0.8, math.cos(tilt)])
    attitude = from_angles([0.3, 1e-7, 0.4])
    variables = to_andoyer(attitude, momentum)
    assert variables.obliquity == pytest.approx(tilt, rel=1e-14)
    again, body = from_andoyer(variables)
    assert apart(attitude, again) < 4e-15
    assert body == pytest.approx(momentum, rel=1e-14)


def test_singular_momenta_leave_the_node_at_zero_and_the_angle_to_g() -> None:
    attitude = from_angles([0.7, 0.0, 0.0])
    upright = to_andoyer(attitude, [0, 0, 2.0])
    assert [float(v) for v in (upright.l, upright.h, upright.L, upright.G, upright.H)] == [0, 0, 2, 2, 2]
    assert upright.g == pytest.approx(0.7, abs=1e-15)
    down = to_andoyer(attitude, [0, 0, -2.0])
    assert [float(v) for v in (down.l, down.h, down.L, down.G, down.H)] == [0, 0, -2, 2, -2]
    along_z_only = to_andoyer(from_angles([0.7, 1.0, 0.2]), quaternion.to_body(from_angles([0.7, 1.0, 0.2]), [0, 0, 3]))
    assert along_z_only.h == 0
    assert along_z_only.l == pytest.approx(0.2, abs=1e-15)
    for variables, q in ((upright, attitude), (down, attitude), (along_z_only, from_angles([0.7, 1.0, 0.2]))):
        assert apart(q, from_andoyer(variables)[0]) < 2e-15


def test_the_angles_are_those_between_the_nodes() -> None:
    """h from space x to z × L, g from there to L × axis 3, l from there to body axis 1, each about its own normal."""
    rng = np.random.default_rng(8)
    attitude, body = quaternion.normalise(rng.normal(size=4)), rng.normal(size=3)
    axes = quaternion.matrix(attitude).T
    momentum = quaternion.to_space(attitude, body)
    z = np.array([0.0, 0, 1])
    nodes = np.cross(z, momentum), np.cross(momentum, axes[2])

    def turn(start: np.ndarray, end: np.ndarray, normal: np.ndarray) -> float:
        across = np.cross(start, end) @ normal / np.linalg.norm(normal)
        return math.atan2(across, start @ end)

    v = to_andoyer(attitude, body)
    assert v.h == pytest.approx(turn(np.array([1.0, 0, 0]), nodes[0], z), abs=1e-14)
    assert v.g == pytest.approx(turn(nodes[0], nodes[1], momentum), abs=1e-14)
    assert v.l == pytest.approx(turn(nodes[1], axes[0], axes[2]), abs=1e-14)
    actions = [float(v.L), float(v.G), float(v.H)]
    assert actions == pytest.approx([body[2], np.linalg.norm(body), momentum[2]], rel=1e-14)


def test_the_change_from_euler_angles_and_momenta_is_canonical() -> None:
    """The Jacobian M of (φ, θ, ψ, p) → (l, g, h, L, G, H) keeps the symplectic form: M J Mᵀ = J, so that
    {l, L} = {g, G} = {h, H} = 1 and all other brackets vanish. Derivatives by sixth-order differences."""
    stencil = {-3: -1 / 60, -2: 3 / 20, -1: -3 / 4, 1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    step = 4e-3

    def change(x: np.ndarray) -> np.ndarray:
        angles, p = x[:3], x[3:]
        v = to_andoyer(from_angles(angles), canonical.angular_momentum(angles, p))
        return np.array([v.l, v.g, v.h, v.L, v.G, v.H])

    start = np.array([0.3, 1.0, -0.4, 1.2, 0.7, -0.5])
    jacobian = np.stack(
        [sum(w * change(start + k * step * unit) for k, w in stencil.items()) / step for unit in np.eye(6)], axis=1
    )
    form = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.eye(3), np.zeros((3, 3))]])
    assert jacobian @ form @ jacobian.T == pytest.approx(form, abs=1e-10)


@settings(deadline=None)
@given(four, three)
def test_hamiltonian_is_the_energy(q: list[float], momentum: list[float]) -> None:
    assume(np.linalg.norm(q) > 1e-3 and np.linalg.norm(momentum) > 1e-3)
    moments = np.array([1.0, 2.0, 2.5])
    energy = hamiltonian(moments, to_andoyer(quaternion.normalise(q), momentum))
    assert energy == pytest.approx(0.5 * np.sum(np.square(momentum) / moments), rel=1e-14)


def test_rates_are_the_derivatives_of_the_hamiltonian() -> None:
    """H = ½ (sin²l/I1 + cos²l/I2)(G² − L²) + L²/2I3, differentiated in mpmath."""
    i1, i2, i3 = 1.0, 2.0, 2.5
    v = Andoyer.of(0.7, 0.1, 0.2, 0.5, 1.5, -0.3)

    def energy(l: mp.mpf, big_l: mp.mpf, big_g: mp.mpf) -> mp.mpf:
        return (mp.sin(l) ** 2 / i1 + mp.cos(l) ** 2 / i2) * (big_g**2 - big_l**2) / 2 + big_l**2 / (2 * i3)

    at = (v.l.item(), v.L.item(), v.G.item())
    expected = [mp.diff(energy, at, n) for n in ((0, 1, 0), (0, 0, 1), (1, 0, 0))]
    changes = [float(rate) for rate in rates([i1, i2, i3], v)]
    assert changes == pytest.approx([float(expected[0]), float(expected[1]), -float(expected[2])], rel=1e-13)


def test_six_variables_alone_determine_attitude_and_momentum() -> None:
    v = Andoyer.of([0.1, 0.2], 0.3, -0.4, [0.5, -0.6], 1.0, 0.7)
    attitude, momentum = from_andoyer(v)
    again = to_andoyer(attitude, momentum)
    for name in "lghLGH":
        assert getattr(again, name) == pytest.approx(getattr(v, name), abs=4e-15)


def test_runs_of_many_samples_are_the_samples_one_by_one() -> None:
    rng = np.random.default_rng(9)
    attitudes, momentum = quaternion.normalise(rng.normal(size=(20, 4))), np.array([0.1, -0.2, 0.3])
    together = to_andoyer(attitudes, momentum)
    for k, q in enumerate(attitudes):
        assert together.g[k] == pytest.approx(to_andoyer(q, momentum).g, abs=1e-15)
    again, body = from_andoyer(together)
    assert quaternion.angle_between(again, attitudes).max() < 4e-15
    assert body == pytest.approx(np.tile(momentum, (20, 1)), abs=1e-15)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda: to_andoyer([[0, 0, 0, 1]] * 2, [[1, 0, 0], [0, 0, 0]]),
            GeometryError,
            r"angular_momentum\[1\] is zero",
        ),
        (lambda: Andoyer.of(0, 0, 0, 0, 0, 0), GeometryError, "^G is not positive"),
        (lambda: Andoyer.of(0, 0, 0, 2, 1, 0), GeometryError, r"\|L\| is 2 kg m²/s and G is 1"),
        (lambda: Andoyer.of(0, 0, 0, [0, 0], 1, [0, -3]), GeometryError, r"\|H\|\[1\] is 3 kg m²/s and G is 1"),
        (lambda: Andoyer.of(math.inf, 0, 0, 0, 1, 0), UsageError, "not finite"),
    ],
)
def test_what_has_no_variables_is_refused(call, error: type[Exception], message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(error, match=message):
        call()
