"""A body on an axle: its angle against quadruple precision, what holds it against closed forms and momentum."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from tests.dynamics.models.hinged.hinged_oracle import angle_of
from tests.dynamics.scenes import scene

import inertia
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_equations import inverse_dynamics
from inertia.dynamics.run import Run
from inertia.errors import GeometryError, UsageError
from inertia_meshes import path

GRAVITY = {"kind": "gravity"}
BAR = {"principal_moments": [0.0834, 0.0834, 0.0002], "mass": 1.0, "center_of_mass": [0.0, 0.0, -0.5]}


def hinged(body: dict, spin: list, duration: float, load: list | None = None, **held: object) -> Run:
    """Run a body on an axle through the origin of its part axes."""
    tilt, accuracy, samples = held.pop("tilt", 0.0), held.pop("accuracy", 1e-10), held.pop("samples", 2001)
    table = {
        "body": body,
        "start": {"angular_velocity": spin, "frame": "part", "attitude": [np.sin(tilt / 2), 0, 0, np.cos(tilt / 2)]},
        "constraint": {"kind": "hinge", "axis": [1, 0, 0], **held},
        "load": load or [],
        "run": {"duration": duration, "samples": samples, "accuracy": accuracy},
    }
    return inertia.simulate(inertia.Scene.from_dict(table))


@pytest.mark.parametrize(
    ("spin", "load", "held", "method"),
    [
        (3.0, [{"kind": "torque", "torque": [0.05, 0.1, 0]}], {}, "closed form"),
        (3.0, [{"kind": "damping", "coefficient": 0.3}, {"kind": "torque", "torque": [0.5, 0, 0]}], {}, "exponentials"),
        (3.0, [], {"stiffness": 2.0, "rest_angle": 0.4}, "exponentials"),
        (3.0, [{"kind": "damping", "coefficient": 5.0}], {"stiffness": 2.0}, "exponentials"),
        (1.0, [GRAVITY], {"tilt": 0.7}, "elliptic"),
        (9.0, [GRAVITY], {"tilt": 0.7}, "elliptic"),
        (1.0, [GRAVITY], {"tilt": 3.0, "samples": 2}, "elliptic"),
        (-9.0, [GRAVITY], {"tilt": 0.7, "samples": 2}, "elliptic"),
        (20.0, [GRAVITY], {"tilt": -3.1, "samples": 3}, "elliptic"),
        (4.0, [GRAVITY, {"kind": "damping", "coefficient": 0.1}], {"stiffness": 1.0, "rest_angle": 1.0}, "Taylor"),
        (4.0, [GRAVITY, {"kind": "damping", "coefficient": 150.0}], {"tilt": 0.7, "samples": 5}, "Radau"),
        (
            -900.0,
            [GRAVITY, {"kind": "damping", "coefficient": 200.0}, {"kind": "torque", "torque": [300.0, 0, 0]}],
            {"tilt": 3.1, "stiffness": 0.5},
            "Radau",
        ),
    ],
)
def test_the_angle_is_right_to_the_accuracy_that_is_stated(spin: float, load: list, held: dict, method: str) -> None:
    run = hinged(BAR, [spin, 0, 0], 3.0, load, **held)
    moment = mpmath.mpf(0.0834) + mpmath.mpf(0.25)
    torque = sum(k["torque"][0] for k in load if k["kind"] == "torque")
    damping = sum(k["coefficient"] for k in load if k["kind"] == "damping")
    stiffness, rest, tilt = (mpmath.mpf(held.get(k, 0.0)) for k in ("stiffness", "rest_angle", "tilt"))
    weight = -mpmath.mpf(0.5) * mpmath.mpf(9.80665) if GRAVITY in load else 0
    with mpmath.workdps(30):
        figures = {"I": moment, "N": torque + stiffness * rest, "c": damping, "k": stiffness, "W": weight, "φ": tilt}
    error = float(abs(run.quantities["angle"][-1] - angle_of(figures, spin, 3.0)))
    assert method in run.error.method
    assert run.error.reached < 1e-11
    assert error <= run.error.reached


@pytest.mark.parametrize("stiffness", [0.0, 1e-3])
@pytest.mark.parametrize("place", [[0.0, 0.0, 1.0], [0.0, 0.0, 0.1], [-0.45, 0.0, 1.0]])
def test_a_slow_turn_about_an_upright_axle_is_followed_however_far_the_weight_hangs_from_it(
    stiffness: float, place: list
) -> None:
    """What energy the weight has does not change, and that it rounds says nothing of the turn."""
    body = {"principal_moments": [0.0126, 0.0126, 0.025], "mass": 5.0}
    run = hinged(body, [0, 0, 2e-4], 60.0, [GRAVITY], axis=[0, 0, 1], point=place, stiffness=stiffness)
    pace = np.sqrt(stiffness / (0.025 + 5.0 * place[0] ** 2))
    assert run.quantities["angle"] == pytest.approx(2e-4 * run.time * np.sinc(pace * run.time / np.pi), abs=1e-15)
    assert run.energy == pytest.approx(-5.0 * 9.80665 * place[2], abs=1e-6)
    assert run.invariants["energy"].largest_relative_drift < 1e-15


@pytest.mark.parametrize(
    ("spin", "tilt", "load", "held", "turn"),
    [
        (2.0, 0.0, [], {"stiffness": 3.0}, 0.0),
        (-0.5, 0.0, [], {"stiffness": 3.0, "rest_angle": 0.8}, 0.0),
        (0.0, 0.0, [], {"stiffness": 3.0, "rest_angle": -9.0}, 0.0),
        (1.0, 0.7, [GRAVITY], {}, 0.0),
        (0.0, -3.1, [GRAVITY], {}, 0.0),
        (0.0, 3.0, [GRAVITY], {}, 0.0),
        (8.0, 0.7, [GRAVITY], {}, 2.0 * np.pi),
        (-8.0, 0.7, [GRAVITY], {}, -2.0 * np.pi),
        (4.0, 0.7, [GRAVITY], {"stiffness": 1.0, "rest_angle": 1.0}, 0.0),
        (0.0, 0.2, [GRAVITY], {"stiffness": 20.0, "rest_angle": -0.3}, 0.0),
        (-30.0, 0.0, [GRAVITY], {"stiffness": 0.1}, 0.0),
    ],
)
def test_a_body_on_an_axle_without_loss_comes_back_after_the_period_that_is_stated(
    spin: float, tilt: float, load: list, held: dict, turn: float
) -> None:
    run = hinged(BAR, [spin, 0, 0], 60.0, load, tilt=tilt, **held)
    period = float(run.quantities["period"])
    for part in (1.0, 2.0):
        later = run.at(part * period)
        assert later.quantities["angle"] == pytest.approx(part * turn, abs=2e-11)
        assert later.angular_velocity[0, 0] == pytest.approx(spin, abs=2e-11)
    if turn:
        assert run.remarks == ("It goes over the top: a turn takes a period.",)
        assert "turning angle" not in run.quantities
        return
    assert run.remarks == ("It swings to and fro between its turning angles.",)
    low, high = run.quantities["turning angle"].tolist()
    closely = run.at(np.linspace(0.0, period, 4001)).quantities["angle"]
    assert (closely.min(), closely.max()) == pytest.approx((low, high), abs=1e-6 * (high - low))
    half = run.at(0.5 * period).quantities["angle"][0]  # from a turning angle to the other one
    assert spin or half == pytest.approx(low if abs(high) < abs(low) else high, abs=1e-11)


@pytest.mark.parametrize("tilt", [1.0, 1e-3, 1e-15, 1e-70])
def test_the_period_of_a_pendulum_keeps_its_digits_however_near_it_comes_to_its_upper_rest(tilt: float) -> None:
    run = hinged(BAR | {"center_of_mass": [0.0, 0.0, 0.5]}, [0.0, 0.0, 0.0], 0.1, [GRAVITY], tilt=tilt)
    with mpmath.workdps(200):  # 4 K/ω₀, from where it is let go at rest
        x, _, _, w = [mpmath.mpf(k) for k in run.scene.start.attitude.tolist()]
        natural = mpmath.sqrt(mpmath.mpf(0.5) * mpmath.mpf(9.80665) / (mpmath.mpf(0.0834) + mpmath.mpf(0.25)))
        period = float(4 * mpmath.ellipk(1 - x**2 / (x**2 + w**2)) / natural)
    assert run.quantities["period"] == pytest.approx(period, rel=1e-15)
    assert run.quantities["turning angle"] == pytest.approx([0.0, 2.0 * np.pi - 2.0 * tilt], abs=2e-15)


def test_exercise_3_cubes_on_wires_have_one_period() -> None:
    """2π √(M l²/6κ), whatever they hang by."""
    cube = {"principal_moments": [0.0045] * 3, "mass": 2.7}
    for axis in ([1, 0, 0], [1, 1, 0], [1, 1, 1]):
        spin = (0.5 * np.array(axis) / np.linalg.norm(axis)).tolist()
        run = hinged(cube, spin, 5.0, axis=axis, stiffness=0.02, samples=2)
        assert run.quantities["period"] == pytest.approx(2 * np.pi * np.sqrt(0.0045 / 0.02), rel=1e-15)
        reach = 0.5 * np.sqrt(0.0045 / 0.02)
        assert run.quantities["turning angle"] == pytest.approx([-reach, reach], rel=1e-15)
        assert list(run.series) == ["angle", "reaction force", "reaction torque", "energy of the spring"]


def test_a_pendulum_on_its_separatrix_never_comes_back_and_one_at_rest_has_no_period() -> None:
    body = {"principal_moments": [0.75, 0.75, 0.0], "mass": 1.0, "center_of_mass": [0.0, 0.0, -0.5]}
    load = [{"kind": "gravity", "acceleration": [0.0, 0.0, -8.0]}]  # I = 1, and ½ ω² = 2 · 4 to the upper rest
    run = hinged(body, [4.0, 0, 0], 1.0, load)
    assert run.quantities["period"] == np.inf
    assert run.remarks == ("It is on the separatrix: it goes to its upper rest and does not come back.",)
    for others in ({"load": load}, {"load": load, "stiffness": 2.0}):
        still = hinged(body, [0.0, 0, 0], 1.0, **others)
        assert "period" not in still.quantities
        assert not still.remarks


@pytest.mark.parametrize(
    ("load", "held"),
    [
        ([GRAVITY, {"kind": "damping", "coefficient": 0.1}], {"stiffness": 1.0}),
        ([GRAVITY, {"kind": "torque", "torque": [0.1, 0, 0]}], {}),
        ([GRAVITY], {"drive": "constant_speed"}),
        ([], {}),
    ],
)
def test_what_loses_energy_is_driven_or_turns_freely_has_no_period(load: list, held: dict) -> None:
    assert "period" not in hinged(BAR, [1.0, 0, 0], 1.0, load, **held).quantities


def test_the_axle_holds_what_changes_the_momentum() -> None:
    """F = m (r̈ − g) and N = dL/dt − r × m g, by differences of the run's own places and momenta."""
    body = {"inertia": [[0.3, 0.02, 0.05], [0.02, 0.4, 0.03], [0.05, 0.03, 0.2]], "mass": 2.0}
    run = hinged(body | {"center_of_mass": [0.1, 0.2, -0.1]}, [2.0, 0, 0], 1.0, [GRAVITY], bearings=[-0.3, 0.5])
    step, place = run.time[1], run.position
    weight = np.array([0, 0, -2.0 * 9.80665])
    force = 2.0 * (place[2:] - 2 * place[1:-1] + place[:-2]) / step**2 - weight
    torque = (run.angular_momentum[2:] - run.angular_momentum[:-2]) / (2 * step) - np.cross(place, weight)[1:-1]
    assert np.abs(force - run.quantities["reaction force"][1:-1]).max() < 1e-4 * np.abs(force).max()
    assert np.abs(torque - run.quantities["reaction torque"][1:-1]).max() < 1e-4 * np.abs(torque).max()
    on_a, on_b = (run.quantities[f"force on bearing {k}"] for k in "AB")
    assert np.allclose(on_a + on_b, -run.quantities["reaction force"])
    moment = np.cross([-0.3, 0, 0], -on_a) + np.cross([0.5, 0, 0], -on_b)
    assert np.allclose(moment, run.quantities["reaction torque"], atol=1e-9)


def test_exercise_4_a_dumbbell_askew_on_its_axle() -> None:
    """Two masses M at ±A on a rod at θ to the axle take 2 M A² ω² sinθ cosθ across it."""
    mass, arm, tilt, spin = 2.0, 0.3, np.radians(30.0), 10.0
    place = arm * np.array([np.cos(tilt), 0, np.sin(tilt)])
    tensor = 2.0 * mass * (arm**2 * np.eye(3) - np.outer(place, place))
    run = hinged({"inertia": tensor.tolist(), "mass": 2 * mass}, [spin, 0, 0], 1.0, drive="constant_speed")
    held = np.linalg.norm(run.quantities["reaction torque"], axis=1)
    assert held == pytest.approx(2 * mass * arm**2 * spin**2 * np.sin(tilt) * np.cos(tilt))
    assert np.abs(run.quantities["drive torque"]).max() < 1e-12


def test_a_rod_askew_on_its_axle_needs_no_thickness() -> None:
    run = hinged({"principal_moments": [0, 1, 1]}, [6, 0, 8], 1.0, drive="constant_speed", axis=[0.6, 0, 0.8])
    assert np.linalg.norm(run.quantities["reaction torque"], axis=1) == pytest.approx(10.0**2 * 0.6 * 0.8)
    assert run.energy == pytest.approx(0.5 * 0.8**2 * 10.0**2)


@pytest.mark.parametrize("radius", [0.0, 0.01])
def test_a_bob_on_a_string_is_the_simple_pendulum(radius: float) -> None:
    """From its lowest point sin ½θ = k sn(√(m g l/I) t, k), I = m l² + ⅖ m r², over a hundred swings."""
    mass, length, rate = 2.0, 1.0, 3.0
    own = 0.4 * mass * radius**2
    body = {"principal_moments": [own] * 3, "mass": mass, "center_of_mass": [0, 0, -length]}
    run = hinged(body, [rate, 0, 0], 200.0, [GRAVITY], samples=11)
    with mpmath.workdps(40):
        pace = mpmath.sqrt(mass * mpmath.mpf(9.80665) * length / (mass * length**2 + mpmath.mpf(own)))
        k = rate / (2 * pace)
        angle = [float(2 * mpmath.asin(k * mpmath.ellipfun("sn", pace * float(t), k=k))) for t in run.time]
    assert np.abs(run.quantities["angle"] - angle).max() <= run.error.reached
    far = "constraint.point is 1 m from the centre of mass of a body that is about 0.02 m long: it counts in m"
    assert [far in each for each in run.warnings] == [True] * bool(radius)


def test_an_axle_that_no_mass_is_away_from_is_refused() -> None:
    rod = {"principal_moments": [0.1, 0.1, 0], "mass": 1.0, "center_of_mass": [0, 0, 0.5]}
    with pytest.raises(GeometryError, match="no mass is away from the axle"):
        hinged(rod, [0, 0, 1], 1.0, axis=[0, 0, 1])
    assert hinged(rod, [0, 0, 1], 1.0, axis=[0, 0, 1], point=[0.1, 0, 0]).error.reached < 1e-12
    point = {"principal_moments": [0, 0, 0], "mass": 1.0, "center_of_mass": [0.3, -0.7, 0.2]}
    with pytest.raises(GeometryError, match="no mass is away from the axle"):
        hinged(point, [0.3, -0.7, 0.2], 1.0, axis=[0.3, -0.7, 0.2])


def test_the_tilted_disc_loads_its_bearings_by_its_couple() -> None:
    """ω² (I3 − I1) sinφ cosφ over the distance of the bearings, textbook § 13.25."""
    run = inertia.simulate(inertia.Scene.load(path("scenes/tilted_disc.toml")))
    tilt, spin = np.radians(1.0), np.linalg.norm(run.angular_velocity[0])
    couple = spin**2 * 0.05 * np.sin(tilt) * np.cos(tilt)
    for bearing in "AB":
        loads = np.linalg.norm(run.quantities[f"force on bearing {bearing}"], axis=1)
        assert loads == pytest.approx(couple / 0.2)


def test_a_constant_speed_takes_the_torque_of_the_weight() -> None:
    run = hinged(BAR, [2.0, 0, 0], 3.0, [GRAVITY], drive="constant_speed")
    assert run.quantities["drive torque"] == pytest.approx(0.5 * 9.80665 * np.sin(2.0 * run.time), abs=1e-12)


def test_a_hinge_through_a_moving_point_agrees_with_the_heavy_top_that_swings_in_a_plane() -> None:
    table = {"body": BAR, "start": {"angular_velocity": [0, 0, 0], "attitude": [np.sin(0.5), 0, 0, np.cos(0.5)]}}
    common = {"load": [GRAVITY], "run": {"duration": 20}}
    top = inertia.simulate(inertia.Scene.from_dict(table | common | {"constraint": {"kind": "fixed_point"}}))
    swing = inertia.simulate(
        inertia.Scene.from_dict(table | common | {"constraint": {"kind": "hinge", "axis": [1, 0, 0]}})
    )
    assert quaternion.angle_between(top.attitude, swing.attitude).max() <= top.error.reached + swing.error.reached


@pytest.mark.parametrize(
    ("held", "message"),
    [
        ({"axis": None}, "constraint.axis is missing"),
        ({"axis": [0, 1, 0]}, r"start.angular_velocity points 90° off constraint.axis"),
        ({"bearings": [1, 1]}, "constraint.bearings are both at 1 m"),
        ({"radius": 1.0}, "constraint.radius goes with"),
        ({"kind": "free", "axis": None, "stiffness": 1.0}, r'constraint.stiffness goes with kind = "hinge" only'),
        ({"kind": "rolling", "radius": 1.0, "drive": "constant_speed"}, "constraint.drive goes with"),
    ],
)
def test_what_makes_no_sense_on_an_axle_is_named(held: dict, message: str) -> None:
    constraint = {k: v for k, v in ({"kind": "hinge", "axis": [1, 0, 0]} | held).items() if v is not None}
    table = {"body": BAR, "start": {"angular_velocity": [1, 0, 0]}, "constraint": constraint, "run": {"duration": 1}}
    with pytest.raises(UsageError, match=message):
        inertia.simulate(inertia.Scene.from_dict(table))


def test_loads_that_an_axle_does_not_take_are_named() -> None:
    with pytest.raises(UsageError, match=r"load\[0\] is torque: a body on an axle takes gravity, damping and constant"):
        hinged(BAR, [1, 0, 0], 1.0, [{"kind": "torque", "table": [[0, 0, 0, 0], [1, 1, 0, 0]]}])


def test_the_torque_of_a_motion_is_the_rate_of_its_momentum() -> None:
    rng = np.random.default_rng(5)
    root = rng.normal(size=(3, 3))
    tensor, omega, rate = root @ root.T, rng.normal(size=(4, 3)), rng.normal(size=(4, 3))
    expected = [tensor @ a + np.cross(w, tensor @ w) for w, a in zip(omega, rate, strict=True)]
    assert inverse_dynamics(tensor, omega, rate) == pytest.approx(np.array(expected))


def test_a_method_or_a_model_that_does_not_fit_an_axle_is_refused() -> None:
    with pytest.raises(UsageError, match="method of its own"):
        inertia.simulate(
            scene(
                body=BAR,
                start__angular_velocity=[1, 0, 0],
                constraint={"kind": "hinge", "axis": [1, 0, 0]},
                run__method="DOP853",
            )
        )


@pytest.mark.parametrize(
    ("tilt", "duration"), [(1e-9, 4.0), (1e-6, 6.0), (6e-3, 7.0), (2.4e-15, 13.0), (-2.4e-15, 14.5), (1e-70, 45.0)]
)
def test_a_pendulum_that_is_let_go_near_its_upper_rest_is_known_to_the_last_digits(
    tilt: float, duration: float
) -> None:
    """However little it is off: the figures of the scene count as they are, also where it has fallen and come back."""
    up = BAR | {"center_of_mass": [0.0, 0.0, 0.5]}
    run = hinged(up, [0.0, 0.0, 0.0], duration, [GRAVITY], tilt=tilt, samples=2)
    with mpmath.workdps(250):  # let go at rest: sin ½φ = k cd(ω₀ t), φ from below
        start = [mpmath.mpf(x) for x in run.scene.start.attitude.tolist()]
        modulus = start[3] / mpmath.hypot(start[0], start[3])
        rate = mpmath.sqrt(mpmath.mpf(0.5) * mpmath.mpf(9.80665) / (mpmath.mpf(0.0834) + mpmath.mpf(0.25)))
        cn, dn = (mpmath.ellipfun(kind, rate * duration, m=modulus**2) for kind in ("cn", "dn"))
        moved = mpmath.sign(start[0]) * (2 * mpmath.asin(modulus) - 2 * mpmath.asin(modulus * cn / dn))
        off = float(abs(moved - run.quantities["angle"][-1]))
    assert off <= run.error.reached < 1e-13


@pytest.mark.parametrize("duration", [1e9, 2e16, 3e16, 1.3e17, 5e17])
def test_a_pendulum_swings_to_its_own_side_after_any_number_of_periods(duration: float) -> None:
    run = hinged(BAR | {"center_of_mass": [0.0, 0.0, -0.5]}, [3.0, 0.0, 0.0], duration, [GRAVITY], samples=2)
    with mpmath.workdps(60):  # from its lowest point: sin ½θ = k sn(ω₀ t), θ̇ = 2 k ω₀ cn
        natural = mpmath.sqrt(mpmath.mpf(0.5) * mpmath.mpf(9.80665) / (mpmath.mpf(0.0834) + mpmath.mpf(0.25)))
        modulus = mpmath.mpf(3) / (2 * natural)
        within = mpmath.fmod(natural * mpmath.mpf(duration), 4 * mpmath.ellipk(modulus**2))
        sn, cn = (mpmath.ellipfun(kind, within, m=modulus**2) for kind in ("sn", "cn"))
        angle, rate = 2 * mpmath.asin(modulus * sn), 3 * cn
    assert run.quantities["angle"][-1] == pytest.approx(float(angle), abs=run.error.reached)
    assert run.angular_velocity[-1, 0] == pytest.approx(float(rate), abs=3e-12)
    assert run.error.reached < 1e-12


def test_a_pendulum_that_is_off_by_less_than_is_followed_claims_nothing_once_that_has_grown() -> None:
    up = BAR | {"center_of_mass": [0.0, 0.0, 0.5]}
    assert hinged(up, [0.0, 0.0, 0.0], 40.0, [GRAVITY], tilt=1e-100).error.reached < 1e-13
    with pytest.raises(GeometryError, match="the attitude is lost over 80 s"):
        hinged(up, [0.0, 0.0, 0.0], 80.0, [GRAVITY], tilt=1e-100)


def test_a_pendulum_at_rest_on_its_upper_rest_stays() -> None:
    run = hinged(BAR | {"center_of_mass": [0.0, 0.0, 0.5]}, [0.0, 0.0, 0.0], 1e3, [GRAVITY])
    assert not run.quantities["angle"].any()
    assert run.error.reached < 1e-14


@pytest.mark.parametrize(("tilt", "duration"), [(1e-7, 9.0), (1e-11, 10.0), (2.4e-15, 12.0)])
def test_a_damped_pendulum_near_its_upper_rest_claims_what_is_true(tilt: float, duration: float) -> None:
    """What rounding its figures does grows as cosh(λ t), also by the end of a fall that is over by then."""
    up, damping = BAR | {"center_of_mass": [0.0, 0.0, 0.5]}, {"kind": "damping", "coefficient": 1e-3}
    run = hinged(up, [0.0, 0.0, 0.0], duration, [GRAVITY, damping], tilt=tilt, samples=2, accuracy=1.0)
    with mpmath.workdps(45):
        above = 2 * mpmath.atan(mpmath.mpf(run.scene.start.attitude[0]) / mpmath.mpf(run.scene.start.attitude[3]))
        figures = {"I": mpmath.mpf(0.0834) + mpmath.mpf(0.25), "N": 0, "c": 1e-3, "k": 0, "φ": above}
        figures["W"] = mpmath.mpf(0.5) * mpmath.mpf(9.80665)
        off = float(abs(angle_of(figures, 0.0, duration, 40) - run.quantities["angle"][-1]))
    assert off <= run.error.reached < 1e-5


def test_a_torque_nearly_across_the_axle_counts_as_it_is() -> None:
    torque = [1.0, -1.0 + 1e-9, 0.0]
    run = hinged(BAR, [0, 0, 0], 1e3, [{"kind": "torque", "torque": torque}], axis=[3, 3, 0], samples=2)
    along = (Fraction(torque[0]) + Fraction(torque[1])) / 2  # times √2, as is the square of what it is divided by
    with mpmath.workdps(30):
        moment = mpmath.mpf(0.0834) + mpmath.mpf(0.25)  # about any axis across the bar
        angle = mpmath.sqrt(2) * mpmath.mpf(along.numerator) / along.denominator * 5 * 10**5 / moment
        off = float(abs(angle - run.quantities["angle"][-1]))
    assert off <= run.error.reached < 1e-13


def test_an_axle_in_oil_relaxes_in_no_time() -> None:
    """With I θ̈ negligible, c φ̇ = −m g r sin φ: tan ½φ falls as exp(−m g r t/c), but for parts of m g r I/c² = 2e-7."""
    body = {"principal_moments": [1e-6, 1e-6, 1e-7], "mass": 0.01, "center_of_mass": [0, 0, -0.01]}
    tilt, damping, weight = 2.0 * np.arctan2(0.6, 0.8), 0.1, 0.01 * 9.80665 * 0.01
    load = [GRAVITY, {"kind": "damping", "coefficient": damping}]
    run = hinged(body, [1.0, 0, 0], 20.0, load, tilt=tilt)
    begun = tilt + 2e-6 / damping  # what the spin comes to is I ω/c
    expected = 2.0 * np.arctan(np.tan(0.5 * begun) * np.exp(-weight / damping * run.time))
    np.testing.assert_allclose(run.quantities["angle"][1:] + tilt, expected[1:], atol=1e-6)
    np.testing.assert_allclose(run.angular_velocity[1:, 0], -weight / damping * np.sin(expected[1:]), rtol=1e-5)
    assert run.error.reached < 1e-13


@pytest.mark.parametrize("damping", [1e3, 1e9, 1e15])
def test_what_is_stiffer_takes_no_longer_and_keeps_its_digits(damping: float) -> None:
    """A motor that turns an axle with a weight, for as long as N/c takes to turn it round: the limit is c θ̇ = N + …"""
    load = [GRAVITY, {"kind": "damping", "coefficient": damping}, {"kind": "torque", "torque": [10.0, 0, 0]}]
    end = 2.0 * np.pi * damping / np.sqrt(10.0**2 - (0.5 * 9.80665) ** 2)
    run = hinged(BAR, [0.0, 0, 0], end, load, samples=11)
    assert run.quantities["angle"][-1] == pytest.approx(2.0 * np.pi, abs=1e2 / damping**2 + 1e-12)
    assert run.error.reached < 1e-11
