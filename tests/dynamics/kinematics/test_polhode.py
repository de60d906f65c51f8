"""Polhode, separatrix and herpolhode, against the two conserved quantities in mpmath and quadrature."""

import itertools

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from inertia.dynamics.kinematics.polhode import covered, herpolhode, polhode, polhode_family, separatrix
from inertia.dynamics.kinematics.stability import separatrix_distance
from inertia.dynamics.models.free.flips import polhode_period
from inertia.dynamics.models.free.motion import free_motion
from inertia.errors import GeometryError

moment = st.floats(0.5, 1)
component = st.floats(-1, 1)
three_moments = st.tuples(moment, moment, moment)
spin = st.tuples(component, component, component)
away = st.one_of(st.floats(-1, -1e-3), st.floats(1e-3, 1))


def near_separatrix(distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a body and a spin whose ω3 is `distance` (relative) above that on the separatrix."""
    i1, i2, i3 = moments = np.array([1.0, 2.0, 2.5])
    w3 = 0.3 * np.sqrt(i1 * (i2 - i1) / (i3 * (i3 - i2)))
    return moments, np.array([0.3, -0.4, w3 * (1 + distance)])


def apart(moments: np.ndarray, curve: np.ndarray, omega: np.ndarray) -> float:
    """Return how far, relatively, energy and |L| along a curve are from those of a spin."""
    energy, momentum = (np.sum(moments**n * curve**2, axis=-1) / np.sum(moments**n * omega**2) for n in (1, 2))
    return float(max(np.abs(energy - 1).max(), np.abs(momentum - 1).max()))


@settings(deadline=None)
@given(three_moments, spin)
def test_both_branches_lie_on_the_momentum_sphere_and_the_energy_ellipsoid(
    moments: tuple[float, ...], omega: tuple[float, ...]
) -> None:
    assume(len(set(moments)) > 1 and np.linalg.norm(omega) > 1e-3)
    curve = polhode(moments, omega, samples=33)
    assert apart(np.array(moments), curve.branches, np.array(omega)) < 1e-13
    assert curve.branches[0, 0] == pytest.approx(omega, abs=1e-15)
    assert curve.branches[:, -1] == pytest.approx(curve.branches[:, 0], abs=2e-15)
    along = curve.branches[..., curve.axis]
    assert (along[0] * along[1] <= 0).all()


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("omega", [[0.1, 0.2, 1.0], [1.0, 0.2, -0.1], [0.1, 0.2, -1.0], [-1.0, 0.2, 0.1]])
def test_samples_follow_the_motion_round_the_axis_that_keeps_its_sign(order: list[int], omega: list[float]) -> None:
    moments, omega_there = np.array([1.0, 1.5, 2.2])[list(order)], np.array(omega)[list(order)]
    curve = polhode(moments, omega_there, samples=721)
    assert moments[curve.axis] == (2.2 if abs(omega[2]) == 1 else 1.0)
    for branch in curve.branches:
        along = branch[1:-1]
        rate = np.cross(moments * along, along) / moments
        steps = branch[2:] - branch[:-2]
        cosines = np.sum(rate * steps, axis=1) / np.linalg.norm(rate, axis=1) / np.linalg.norm(steps, axis=1)
        assert cosines.min() > 0.999


@pytest.mark.parametrize("distance", [1e-6, 1e-12, -1e-12])
def test_the_narrows_of_a_polhode_next_to_the_separatrix_keep_their_digits(distance: float) -> None:
    """Where ω1 (or ω3) is zero the other follows from energy and |L|, here in 60 digits."""
    moments, omega = near_separatrix(distance)
    p, r = (0, 2) if distance > 0 else (2, 0)
    with mp.workdps(60):
        i, w = [mp.mpf(m) for m in moments.tolist()], [mp.mpf(x) for x in omega.tolist()]
        kept = sum(m * (m - i[1]) * x**2 for m, x in zip(i, w, strict=True))  # L² − 2 T I2
        expected = float(mp.sqrt(kept / (i[r] * (i[r] - i[1]))))
    branches = polhode(moments, omega, samples=100_001).branches
    narrow = np.abs(branches[0, :, r])
    assert narrow.min() == pytest.approx(expected, rel=max(1e-13, (1e-4 / expected) ** 2))
    assert np.argmin(narrow) == np.argmin(np.abs(branches[0, :, p]))


def test_the_polhode_of_a_symmetric_top_is_a_circle() -> None:
    curve = polhode([2, 2, 3], [0.3, 0.4, -1.0], samples=91)
    assert curve.axis == 2
    assert np.hypot(*curve.branches[0, :, :2].T) == pytest.approx(0.5, rel=1e-15)
    assert curve.branches[..., 2] == pytest.approx(np.repeat([[-1.0], [1.0]], 91, axis=1))


def test_a_steady_spin_is_its_own_polhode() -> None:
    assert polhode([1, 2, 3], [0, 0, 5], samples=3).branches.tolist() == [[[0, 0, 5]] * 3, [[0, 0, -5]] * 3]


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("signs", list(itertools.product((1.0, -1.0), repeat=3)))
def test_on_the_separatrix_a_body_covers_the_arc_that_its_motion_does(order: list[int], signs: list[float]) -> None:
    """2T I2 = L² = 216 exactly; the arc goes from one end of the intermediate axis to the other, √13.5 rad/s long."""
    moments, omega = np.array([3.0, 4.0, 6.0])[list(order)], (np.array([2.0, 3.0, 1.0]) * signs)[list(order)]
    arc = covered(moments, omega, samples=20_001)
    _, spin = free_motion(moments, omega, np.linspace(-20.0, 20.0, 101))
    nearest = np.abs(spin[:, None] - arc).max(axis=2)
    assert nearest.min(axis=1).max() < 4e-4  # between two samples
    assert (np.diff(nearest.argmin(axis=1)) >= 0).all()
    middle = order.index(1)
    assert arc[[0, -1], middle] == pytest.approx(np.sign(spin[-1, middle]) * np.sqrt(13.5) * np.array([-1.0, 1.0]))
    assert np.delete(arc[[0, -1]], middle, axis=1) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("moments", "omega"),
    [([1, 2, 3], [0, -2, 0]), ([1, 2, 3], [0, 0, 5]), ([2, 2, 3], [1, 2, 0]), ([2, 1, 2], [3, 0, 1])],
)
def test_a_steady_spin_covers_one_point(moments: list[float], omega: list[float]) -> None:
    assert np.abs(covered(moments, omega, samples=5) - omega).max() < 1e-15


@settings(deadline=None)
@given(three_moments, spin)
def test_elsewhere_a_body_covers_all_of_its_polhode(moments: tuple[float, ...], omega: tuple[float, ...]) -> None:
    assume(len(set(moments)) == 3 and np.linalg.norm(omega) > 1e-3 and separatrix_distance(moments, omega))
    assert np.array_equal(covered(moments, omega, samples=33), polhode(moments, omega, samples=33).branches[0])


@settings(deadline=None)
@given(three_moments, st.floats(0.1, 10))
def test_separatrix_is_where_twice_energy_times_i2_is_squared_momentum(moments: tuple[float, ...], size: float) -> None:
    assume(len(set(moments)) == 3)
    curves = np.array(moments) * separatrix(moments, size, samples=41)
    assert np.linalg.norm(curves, axis=-1) == pytest.approx(np.full((2, 41), size), rel=1e-14)
    twice_energy = np.sum(curves**2 / np.array(moments), axis=-1)
    assert twice_energy * sorted(moments)[1] == pytest.approx(np.full((2, 41), size**2), rel=1e-14)
    middle = np.argsort(moments)[1]
    assert np.abs(curves[:, [0, 20], middle]) == pytest.approx(np.full((2, 2), size), rel=1e-15)


def quadrature(moments: np.ndarray, omega: np.ndarray, axis: int, quarters: float) -> float:
    """Return the angle that ω goes round L while its amplitude on a polhode, about axis 2 or 0, grows from 0.

    ∫ ϑ̇ dt, ϑ̇ = ω̇·Iω̇ L/|L × ω|²: ω along two axes from that along axis 2, by energy and |L|; ω̇ from Euler's equations.
    """
    with mp.workdps(50):
        i, w = [mp.mpf(m) for m in moments.tolist()], [mp.mpf(x) for x in omega.tolist()]
        twice_energy = mp.fsum(m * x * x for m, x in zip(i, w, strict=True))
        square = mp.fsum((m * x) ** 2 for m, x in zip(i, w, strict=True))
        reach = mp.sqrt((twice_energy * i[axis] - square) / (i[1] * (i[axis] - i[1])))

        def rate(x: mp.mpf) -> mp.mpf:
            w2 = reach * mp.sin(x)
            w1 = mp.sqrt(abs(twice_energy * i[2] - square - i[1] * (i[2] - i[1]) * w2**2) / (i[0] * (i[2] - i[0])))
            w3 = mp.sqrt(abs(square - twice_energy * i[0] - i[1] * (i[1] - i[0]) * w2**2) / (i[2] * (i[2] - i[0])))
            torque = [(i[1] - i[2]) * w2 * w3, (i[2] - i[0]) * w3 * w1, (i[0] - i[1]) * w1 * w2]
            turning = mp.fsum(t * t / m for t, m in zip(torque, i, strict=True)) * mp.sqrt(square)
            return turning / mp.fsum(t * t for t in torque) * reach * mp.cos(x) * i[1] / torque[1]

        end = quarters * mp.pi / 2
        return float(mp.quad(rate, [0, end / 2, end]))


@pytest.mark.parametrize(
    ("omega", "axis"), [([0.2, 0, 1.0], 2), ([0.5, 0, 0.6], 2), ([0.3, 0, 0.31], 2), ([1.0, 0, 0.4], 0)]
)
def test_the_angle_of_the_herpolhode_by_quadrature(omega: list[float], axis: int) -> None:
    moments = np.array([1.0, 2.0, 2.5])
    curve = herpolhode(moments, omega, samples=9)
    quarter = quadrature(moments, np.array(omega), axis, 1.0)
    assert curve.advance == pytest.approx(4 * quarter, rel=1e-13)
    eighth = quadrature(moments, np.array(omega), axis, 0.5)
    assert np.arctan2(curve.points[1, 1], curve.points[1, 0]) == pytest.approx(
        np.remainder(eighth + np.pi, 2 * np.pi) - np.pi, abs=1e-13
    )
    for order in ([2, 0, 1], [1, 0, 2]):
        other = herpolhode(moments[order], np.array(omega)[order])
        assert other.advance == pytest.approx(curve.advance, rel=1e-14)


@pytest.mark.parametrize("omega", [[0.2, 0, 1.0], [0.3, 0, -0.31], [-1.0, 0, 0.4]])
def test_the_herpolhode_is_where_the_integrated_motion_takes_the_spin(omega: list[float]) -> None:
    """From ω2 = 0 to ω2 = 0 again, half a turn of the polhode; attitude and ω by Runge–Kutta."""
    from scipy.integrate import solve_ivp

    moments, spin = np.array([1.0, 2.0, 2.5]), np.array(omega)
    z = moments * spin / np.linalg.norm(moments * spin)
    x = (spin - z * (z @ spin)) / np.linalg.norm(spin - z * (z @ spin))

    def deriv(_: float, y: np.ndarray) -> np.ndarray:
        rows, w = y[:9].reshape(3, 3), y[9:]
        return np.concatenate([np.cross(rows, w).ravel(), np.cross(moments * w, w) / moments])

    start = np.concatenate([x, np.cross(z, x), z, spin])
    run = solve_ivp(deriv, (0, 60), start, method="DOP853", rtol=1e-12, atol=1e-13, events=lambda _, y: y[10])
    state = next(y for t, y in zip(run.t_events[0], run.y_events[0], strict=True) if t > 0.1)
    assert state[:9].reshape(3, 3) @ state[9:] == pytest.approx(herpolhode(moments, spin, 3).points[1], abs=1e-10)


@settings(deadline=None)
@given(three_moments, st.tuples(away, away, away))
def test_herpolhode_stays_between_its_circles_and_goes_forward(
    moments: tuple[float, ...], omega: tuple[float, ...]
) -> None:
    """The radius at every sample is |L × ω|/L of the polhode there; the rate is between L/I3 and L/I1."""
    assume(len(set(moments)) == 3)
    curve = herpolhode(moments, omega, samples=65)
    along = polhode(moments, omega, samples=65).branches[0]
    momentum = np.array(moments) * along
    radius = np.linalg.norm(np.cross(momentum, along), axis=-1) / np.linalg.norm(momentum[0])
    size = np.linalg.norm(omega)
    assert np.hypot(curve.points[:, 0], curve.points[:, 1]) == pytest.approx(radius, abs=1e-14 * size)
    assert curve.least - 1e-14 * size <= radius.min() <= radius.max() <= curve.greatest + 1e-14 * size
    assert curve.points[:, 2] == pytest.approx(np.full(65, curve.distance))
    assert curve.advance > 0


def test_the_herpolhode_of_a_symmetric_top_goes_round_at_l_over_i1() -> None:
    """Once round the polhode takes 2π/|Ω|, Ω = (I3 − I1) ω3/I1; ω goes round L at L/I1 in that time."""
    curve = herpolhode([2, 2, 3], [0.3, 0.4, 1.0])
    momentum = np.hypot(2 * 0.5, 3 * 1.0)
    assert curve.advance == pytest.approx(momentum / 2 * 2 * np.pi / 0.5, rel=1e-14)
    assert curve.least == pytest.approx(curve.greatest, rel=1e-14)


def advance_of(moments: np.ndarray, omega: np.ndarray) -> mp.mpf:
    """Return the advance of a herpolhode from energy and L as they are, by Carlson's integrals in 50 digits."""
    with mp.workdps(50):
        i, w = zip(*sorted(zip(map(mp.mpf, moments.tolist()), map(mp.mpf, omega.tolist()), strict=True)), strict=True)
        twice_energy = mp.fsum(m * x * x for m, x in zip(i, w, strict=True))
        square = mp.fsum((m * x) ** 2 for m, x in zip(i, w, strict=True))
        ip, iq, ir = i[::-1] if twice_energy * i[1] > square else i
        far, near = (square - twice_energy * k for k in (ip, iq))
        mc = near / far * (ir - ip) / (ir - iq)
        nu = near / far * ip / iq
        rate = mp.sqrt((ir - iq) / (ip * iq) * far / ir)
        turning = mp.elliprf(0, mc, 1) / iq + (1 / ip - 1 / iq) * nu * mp.elliprj(0, mc, 1, nu) / 3
        return 4 * mp.sqrt(square) / rate * turning


@pytest.mark.parametrize("seed", range(4))
def test_the_advance_keeps_its_digits_at_any_distance_from_the_separatrix(seed: int) -> None:
    rng, tried = np.random.default_rng(seed), 0
    while tried < 100:
        moments, omega = rng.uniform(1, 3, 3), rng.normal(size=3)
        low, _, high = order = np.argsort(moments)
        i1, i2, i3 = moments[order]
        if tried % 2:  # as near as float64 comes
            on_it = omega[low] * np.sqrt(i1 * (i2 - i1) / (i3 * (i3 - i2)))
            omega[high] = on_it * (1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-17, -1))
        if tried % 5 == 0:  # as near to axis 2
            omega[[low, high]] *= 10 ** rng.uniform(-15, 0, 2)
        if not separatrix_distance(moments, omega):
            continue
        advance = herpolhode(moments, omega, samples=3).advance
        assert abs(advance / advance_of(moments, omega) - 1) < 1e-14, (moments, omega)
        tried += 1


@pytest.mark.parametrize("omega", [[0.9, 1.0, float(np.sqrt(0.27))], [1e-7, 1.0, 1e-7], [0.3, 1.0, 0.2]])
def test_the_advance_is_that_of_a_run(omega: list[float]) -> None:
    """Once round its polhode a body has turned about L by it, but for whole turns."""
    moments, curve = np.array([1.0, 2.0, 3.0]), herpolhode([1, 2, 3], omega)
    attitude, _ = free_motion(moments, omega, [float(polhode_period(moments, omega))])
    along = moments * omega / np.linalg.norm(moments * omega)
    turned = 2 * np.arctan2(attitude[0, :3] @ along, attitude[0, 3])
    assert np.remainder(curve.advance - turned + np.pi, 2 * np.pi) - np.pi == pytest.approx(0.0, abs=1e-12)
    turn = curve.advance
    assert curve.points[-1] == pytest.approx(
        curve.points[0, 0] * np.array([np.cos(turn), np.sin(turn), 0]) + [0, 0, curve.distance], abs=1e-15
    )


def test_advance_next_to_the_separatrix() -> None:
    """ω lingers near axis 2 twice, each time (1/λ) ln(1/δ) long, and goes round L at ϑ̇ = L/I2 there; λ is the growth
    rate (L/I2) √((I2 − I1)(I3 − I2)/(I1 I3))."""
    advances = []
    for distance in (1e-8, 1e-10):
        moments, omega = near_separatrix(distance)
        advances.append(herpolhode(moments, omega).advance)
    speed = np.linalg.norm(moments * omega) / moments[1]
    growth = speed * np.sqrt(1.0 * 0.5 / 2.5)
    assert advances[1] - advances[0] == pytest.approx(2 * speed / growth * np.log(100), rel=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: polhode([2, 2, 2], [1, 2, 3]), "all moments are equal"),
        (lambda: polhode([1, 2, 3], [0, 0, 0]), "has no angular momentum has no polhode"),
        (lambda: herpolhode([1, 2, 3], [0, 1, 0]), "on its separatrix"),
        (lambda: herpolhode([1, 2, 2], [0, 1, 1]), "one of two equal moments"),
        (lambda: separatrix([1, 2, 2], 1.0), "a body with equal moments has no separatrix"),
        (lambda: polhode([1, 2, -2], [0, 1, 1]), "all three must be positive"),
    ],
)
def test_what_has_no_curve_is_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(GeometryError, match=message):
        call()


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_polhodes_of_one_momentum_do_not_depend_on_the_order_of_the_moments(order: tuple[int, ...]) -> None:
    moments = np.array([1.0, 2.0, 3.0])
    some, others = polhode_family(moments, 37), polhode_family(moments[list(order)], 37)
    for one, other in zip(some, others, strict=True):
        np.testing.assert_allclose(np.linalg.norm(other, axis=1), 1.0, rtol=1e-14)
        energy = [(curve**2 / axes).sum(axis=1) for curve, axes in ((one, moments), (other, moments[list(order)]))]
        np.testing.assert_allclose(energy[1], energy[0], rtol=1e-14)
