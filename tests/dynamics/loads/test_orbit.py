"""The gravity gradient along a Kepler orbit, against librations in closed form and against mpmath."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from tests.dynamics.extrapolation import follow

from inertia import Orbit, Run, Scene, UsageError, simulate
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.orbit import eccentric_anomaly

EARTH = 3.986004418e14
BOOM = [20.0, 180.0, 190.0]


def orbiting(
    load: dict[str, Any], spin: list[float], attitude: list[float] | None = None, moments: list[float] | None = None,
    **run: float,
) -> Run:  # fmt: skip
    start: dict[str, Any] = {"angular_velocity": spin} | ({} if attitude is None else {"attitude": attitude})
    body = {"principal_moments": moments or BOOM}
    return simulate(Scene.from_dict({"body": body, "start": start, "load": [{"kind": "orbit", **load}], "run": run}))


def about(axis: int, angle: float) -> list[float]:
    turn = [0.0, 0.0, 0.0, np.cos(0.5 * angle)]
    turn[axis] = np.sin(0.5 * angle)
    return turn


@pytest.mark.parametrize("eccentricity", [0.0, 1e-9, 0.3, 0.9, 0.999999])
def test_keplers_equation_is_solved_to_rounding(eccentricity: float) -> None:
    gap = 1.0 - eccentricity
    with mpmath.workdps(40):
        for mean in (1e-12, 1e-6, 0.01, 0.5, 1.0, 2.0, 3.0, np.pi, -0.7):
            at = mpmath.mpf(eccentric_anomaly(mean, eccentricity, gap))
            slope = gap + 2 * eccentricity * mpmath.sin(at / 2) ** 2
            off = mpmath.mpf(gap) * at + eccentricity * (at - mpmath.sin(at)) - mean
            assert abs(off / slope) < 3e-16 * abs(at), mean


def state_of(orbit: Orbit) -> tuple[list[Any], list[Any], Any]:
    """Return position and velocity at t = 0 from the elements (Bate, Mueller & White, § 2.5), and μ."""
    e, f = mpmath.mpf(orbit.eccentricity), mpmath.mpf(orbit.anomaly)
    if orbit.semi_major_axis is None:
        size = (6378137 + mpmath.mpf(orbit.altitude)) / (1 - e)
    else:
        size = mpmath.mpf(orbit.semi_major_axis)
    mu = mpmath.mpf(EARTH if orbit.mu == "earth" else orbit.mu)
    p = size * (1 - e * e)
    r, pace = p / (1 + e * mpmath.cos(f)), mpmath.sqrt(mu / p)
    plane = [(r * mpmath.cos(f), r * mpmath.sin(f)), (-pace * mpmath.sin(f), pace * (e + mpmath.cos(f)))]
    n, i, w = mpmath.mpf(orbit.node), mpmath.mpf(orbit.inclination), mpmath.mpf(orbit.argument)
    cn, sn, ci, si, cw, sw = (g(x) for x in (n, i, w) for g in (mpmath.cos, mpmath.sin))
    one = [cn * cw - sn * sw * ci, sn * cw + cn * sw * ci, sw * si]
    two = [-cn * sw - sn * cw * ci, -sn * sw + cn * cw * ci, cw * si]
    position, velocity = ([x * a + y * b for a, b in zip(one, two, strict=True)] for x, y in plane)
    return position, velocity, mu


ORBITS = {
    "circle": {"mu": "earth", "altitude": 400e3},
    "inclined": {"mu": EARTH, "semi_major_axis": 9e6, "eccentricity": 0.2, "inclination": 0.9, "node": 1.1,
                 "argument": -2.0, "anomaly": 2.5},
    "slender": {"mu": "earth", "altitude": 300e3, "eccentricity": 0.72, "inclination": 1.1, "argument": 4.7,
                "anomaly": 3.0},
}  # fmt: skip


@pytest.mark.parametrize("name", ORBITS)
def test_the_claim_holds_against_thirty_digits(name: str) -> None:
    orbit = Orbit(**ORBITS[name])
    spin = [3e-4, -5e-4, 1.1e-3]
    duration = 0.6 * sum(orbit.ellipse.period)
    run = orbiting(ORBITS[name], spin, about(0, 0.4), duration=duration, samples=4, accuracy=1e-9)
    with mpmath.workdps(30):
        unit, size = mpmath.mpf(1000), mpmath.mpf(10) ** 7
        place, velocity, mu = state_of(orbit)
        field = mu * unit**2 / size**3
        a, b, c = (mpmath.mpf(x) for x in BOOM)
        shares = (b - c) / a, (c - a) / b, (a - b) / c

        def rate(_: Any, y: list[Any]) -> list[Any]:
            x, v, q, w = y[:3], y[3:6], y[6:10], y[10:]
            square = sum(k * k for k in x)
            pull = field / (square * mpmath.sqrt(square))
            i, j, k, s = q
            rows = [
                [s * s + i * i - j * j - k * k, 2 * (i * j + k * s), 2 * (i * k - j * s)],
                [2 * (i * j - k * s), s * s - i * i + j * j - k * k, 2 * (j * k + i * s)],
                [2 * (i * k + j * s), 2 * (j * k - i * s), s * s - i * i - j * j + k * k],
            ]
            u = [sum(m * n for m, n in zip(row, x, strict=True)) for row in rows]
            g = 3 * pull / square
            p, o, r = w
            return [
                *v,
                *(-pull * k for k in x),
                (s * p + j * r - k * o) / 2,
                (s * o + k * p - i * r) / 2,
                (s * r + i * o - j * p) / 2,
                -(i * p + j * o + k * r) / 2,
                shares[0] * (o * r - g * u[1] * u[2]),
                shares[1] * (r * p - g * u[2] * u[0]),
                shares[2] * (p * o - g * u[0] * u[1]),
            ]

        start = [*(x / size for x in place), *(v * unit / size for v in velocity)]
        start += [mpmath.mpf(x) for x in about(0, 0.4)]
        length = mpmath.sqrt(sum(x * x for x in start[6:10]))
        start[6:10] = [x / length for x in start[6:10]]
        start += [mpmath.mpf(w) * unit for w in spin]
        truth = follow(rate, start, [mpmath.mpf(t) / unit for t in run.time.tolist()], 0.5)
        assert run.position is not None
        for row, position, attitude in zip(truth, run.position, run.attitude, strict=True):
            away = mpmath.norm([x * size - p for x, p in zip(row[:3], position.tolist(), strict=True)])
            assert away < 4e-15 * mpmath.norm(row[:3]) * size
            apart = float(quaternion.angle_between(np.array(row[6:10], dtype=np.float64), attitude))
            assert apart <= run.error.reached + 4e-16
    assert run.error.reached <= 1e-9


def circling(radius: float = 7e6) -> tuple[dict[str, Any], float]:
    return {"mu": EARTH, "semi_major_axis": radius}, float(np.sqrt(EARTH / radius**3))


def pitch(run: Run) -> np.ndarray:
    """Return the angle in the plane z = 0 from the radius to the first body axis."""
    assert run.position is not None
    axis = quaternion.to_space(run.attitude, np.array([1.0, 0.0, 0.0]))
    across = run.position[:, 0] * axis[:, 1] - run.position[:, 1] * axis[:, 0]
    return np.arctan2(across, (run.position * axis).sum(axis=1))


def test_small_pitch_swings_at_its_rate() -> None:
    load, n = circling()
    i, j, k = BOOM
    rate = n * np.sqrt(3 * (j - i) / k)  # Hughes, § 9.2: the long axis to the Earth, the largest moment across
    run = orbiting(load, [0, 0, n], about(2, 1e-5), duration=20000.0, samples=401, accuracy=1e-12)
    np.testing.assert_allclose(pitch(run), 1e-5 * np.cos(rate * run.time), atol=2e-13)
    assert float(run.quantities["libration period in the plane"]) == pytest.approx(2 * np.pi / rate, rel=1e-12)


def test_roll_and_yaw_swing_at_both_their_rates() -> None:
    load, n = circling()
    radial, along, normal = moments = [20.0, 170.0, 185.0]
    first, third = (normal - radial) / along, (normal - along) / radial  # Hughes, § 9.2: k₁ and k₃
    squares = np.roots([1.0, -(1 + 3 * first + first * third), 4 * first * third])
    step = 400.0
    run = orbiting(load, [0, 0, n], about(1, 1e-5), moments, duration=40 * step, samples=41, accuracy=1e-12)
    roll = quaternion.to_space(run.attitude, np.array([1.0, 0.0, 0.0]))[:, 2]
    # A sum of two cosines obeys x₋₂ + x₊₂ + p (x₋₁ + x₊₁) + q x₀ = 0 with the roots z of z⁴ + p z³ + q z² + p z + 1.
    sides, outer = roll[1:-3] + roll[3:-1], roll[:-4] + roll[4:]
    (p, q), *_ = np.linalg.lstsq(np.column_stack([sides, roll[2:-2]]), -outer, rcond=None)
    rates = np.sort(np.abs(np.angle(np.roots([1.0, p, q, p, 1.0]))))[::2] / step
    np.testing.assert_allclose(rates, np.sort(n * np.sqrt(squares)), rtol=1e-6)
    stated = [float(run.quantities[f"libration period out of the plane, {which}"]) for which in ("slow", "fast")]
    np.testing.assert_allclose(2 * np.pi / rates, stated, rtol=1e-6)


@pytest.mark.parametrize(
    ("moments", "rate"),
    [
        ([180.0, 20.0, 190.0], np.sqrt(3 * 160 / 190)),  # the long axis across the radius: the pitch grows
        ([100.0, 190.0, 180.0], 0.0),  # roll and yaw grow: a b < 0
    ],
)
def test_swings_that_grow_are_said_to(moments: list[float], rate: float) -> None:
    load, n = circling()
    run = orbiting(load, [0, 0, n], about(0, 1e-3), moments, duration=10.0, samples=3)
    one, two, three = moments
    a, b = (three - one) / two, (three - two) / one
    squares = np.roots([1.0, 0.0, 1 + 3 * a + a * b, 0.0, 4 * a * b])  # of λ⁴ + (1 + 3 a + a b) λ² + 4 a b
    growth = n * max(rate, squares.real.max())
    assert f"small swings grow e-fold every {1 / growth:.4g} s" in run.remarks[-1]
    assert "libration period in the plane" not in run.quantities


def test_a_body_that_does_not_swing_is_not_said_to() -> None:
    load, n = circling()
    for spin, attitude in (
        ([0, 0, 3 * n], about(0, 0.0)),
        ([0, 0, n], quaternion.normalise([1.0, 1, 1, 1.5]).tolist()),
    ):
        assert not orbiting(load, spin, attitude, duration=10.0, samples=3).remarks


@pytest.mark.parametrize("stated", ["elements", "state"])
def test_a_circular_orbit_keeps_the_jacobi_integral(stated: str) -> None:
    load, n = circling()
    if stated == "state":
        load = {"mu": EARTH, "position": [0.0, 7e6, 0.0], "velocity": [0.0, 0.0, 7e6 * n]}
    run = orbiting(load, [1e-3, 2e-3, -5e-4], duration=12000.0, samples=101, accuracy=1e-9)
    assert run.invariants.keys() == {"Jacobi integral"}
    assert run.invariants["Jacobi integral"].largest_relative_drift < 1e-10
    assert np.ptp(run.energy) > 0.1 * run.energy[0]


def test_an_eccentric_orbit_forces_the_pitch() -> None:
    """φ̈ + 3 n² K φ = 2 e n² sin nt, K = (I_along − I_radial)/I_normal, to the first order in e."""
    load, n = circling()
    e, k = 1e-5, (180.0 - 20.0) / 190.0
    load |= {"eccentricity": e}
    swing = 2 * e / (3 * k - 1)
    run = orbiting(load, [0, 0, n * (1 + 2 * e + swing)], duration=30000.0, samples=301, accuracy=1e-12)
    np.testing.assert_allclose(pitch(run), swing * np.sin(n * run.time), atol=60 * e * e)
    assert not run.invariants


def test_a_body_of_revolution_keeps_its_spin_on_any_orbit() -> None:
    spin = [5e-4, -2e-4, 3e-3]
    run = orbiting(ORBITS["inclined"], spin, moments=[30.0, 30.0, 20.0], duration=9000.0, samples=31, accuracy=1e-8)
    assert run.invariants.keys() == {"angular momentum about body axis 3"}  # as the scene numbers them
    np.testing.assert_allclose(run.angular_velocity[:, 2], 3e-3, rtol=1e-12)


def test_elements_and_state_are_one_orbit() -> None:
    stated = Orbit(**ORBITS["inclined"])
    with mpmath.workdps(30):
        place, velocity, _ = state_of(stated)
        again = Orbit(EARTH, position=[float(x) for x in place], velocity=[float(x) for x in velocity])
    time = np.array([0.0, 1e3, 1e6])
    np.testing.assert_allclose(again.ellipse.position(time), stated.ellipse.position(time), atol=1e-4)
    assert again.ellipse.eccentricity == pytest.approx(0.2, rel=1e-14)


def test_a_sphere_is_not_turned() -> None:
    load, n = circling()
    run = orbiting(load, [0, 0, 2 * n], moments=[2.0, 2.0, 2.0], duration=5000.0, samples=11)
    np.testing.assert_array_equal(run.angular_velocity, np.broadcast_to([0, 0, 2 * n], (11, 3)))


def test_a_spin_that_is_too_slow_to_see_it_does_not_step_over_the_periapsis() -> None:
    load = {"mu": "earth", "altitude": 300e3, "eccentricity": 0.95, "anomaly": np.pi}
    period = sum(Orbit(**load).ellipse.period)
    coarse, fine = (
        orbiting(load, [0, 0, 1e-9], about(2, 0.5), duration=0.7 * period, samples=3, accuracy=a) for a in (1e-4, 1e-7)
    )
    apart = quaternion.angle_between(coarse.attitude, fine.attitude)
    assert apart.max() <= coarse.error.reached
    assert np.abs(fine.angular_velocity[-1]).max() > 1e-5


@pytest.mark.parametrize(
    ("load", "says"),
    [
        ({"mu": "earth"}, "load[0] is an orbit: give one of position and velocity, semi_major_axis, altitude"),
        ({"mu": "earth", "altitude": 4e5, "semi_major_axis": 7e6}, "load[0] is an orbit: give one of"),
        ({"mu": "eart", "altitude": 4e5}, "load[0].mu is 'eart': use one of 'earth', 'moon', 'mars', 'sun'; did you"),
        ({"mu": -1.0, "altitude": 4e5}, "load[0].mu is -1.0: it must be positive, a number of m³/s²"),
        ({"mu": 4e14, "altitude": 4e5}, "load[0].altitude needs a primary of known radius: give semi_major_axis"),
        ({"mu": "earth", "position": [7e6, 0, 0]}, "load[0].velocity is missing: load[0].position goes with it"),
        ({"mu": "earth", "altitude": 4e5, "eccentricity": 1.0}, "load[0].eccentricity is 1: the orbit must close"),
        ({"mu": "earth", "altitude": -1e5}, "load[0] is an orbit through the earth: it comes to 6.27814e+06 m"),
        (
            {"mu": "earth", "position": [7e6, 0, 0], "velocity": [0, 11e3, 0]},
            "load[0].velocity is 11000 m/s, and 10671.7 m/s is enough to escape: the orbit must close",
        ),
        ({"mu": 4e14, "position": [7e6, 0, 0], "velocity": [1, 0, 0]}, "load[0].velocity is along the position"),
        (
            {"mu": 4e14, "position": [7e6, 0, 0], "velocity": [0, 7e3, 0], "node": 0.1},
            "load[0].node is given beside position and velocity, which decide it",
        ),
    ],
)
def test_an_orbit_that_cannot_be_is_refused_by_its_field(load: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError) as refusal:
        orbiting(load, [0, 0, 1e-3], duration=1.0)
    assert says in str(refusal.value)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"start": {"angular_velocity": [0, 0, 1], "position": [7e6, 0, 0]}},
            "start.position is given beside an orbit",
        ),
        (
            {"start": {"angular_velocity": [0, 0, 1], "velocity": [7e3, 0, 0]}},
            "start.velocity is given beside an orbit",
        ),
        ({"load": [{"kind": "gravity"}]}, "load[1] is gravity beside an orbit"),
        ({"load": [{"kind": "orbit", "mu": "moon", "altitude": 1e5}]}, "load[1] is orbit beside an orbit"),
        ({"constraint": {"kind": "fixed_point"}}, "load[0] is orbit, which acts on a free body"),
    ],
)
def test_nothing_else_says_where_the_body_goes(change: dict[str, Any], says: str) -> None:
    scene: dict[str, Any] = {
        "body": {"principal_moments": BOOM, "mass": 1.0},
        "start": {"angular_velocity": [0, 0, 1]},
        "load": [{"kind": "orbit", "mu": "earth", "altitude": 4e5}],
        "run": {"duration": 1.0},
    }
    scene |= {name: scene["load"] + value if name == "load" else value for name, value in change.items()}
    with pytest.raises(UsageError) as refusal:
        Scene.from_dict(scene)
    assert says in str(refusal.value)


@pytest.mark.parametrize("name", [*ORBITS, "state"])
def test_it_survives_being_written(name: str) -> None:
    load = ORBITS.get(name) or {"mu": "moon", "position": [2e6, 0, 1.0], "velocity": [0, 1600.0, 0]}
    scene = Scene.from_dict({
        "body": {"principal_moments": BOOM}, "start": {"angular_velocity": [0, 0, 1e-3]},
        "load": [{"kind": "orbit", **load}], "run": {"duration": 1.0},
    })  # fmt: skip
    again = Scene.loads(scene.to_toml())
    assert scene.orbit is not None
    assert again.orbit is not None
    time = np.array([0.0, 5e3])
    np.testing.assert_array_equal(again.orbit.ellipse.position(time), scene.orbit.ellipse.position(time))
