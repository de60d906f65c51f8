"""A body on an axle: its angle against quadruple precision, what holds it against closed forms and momentum."""

import mpmath
import numpy as np
import pytest
from tests.dynamics.scenes import scene

import inertia
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_equations import inverse_dynamics
from inertia.dynamics.run import Run
from inertia.errors import UsageError
from inertia_meshes import path

GRAVITY = {"kind": "gravity"}
BAR = {"principal_moments": [0.0834, 0.0834, 0.0002], "mass": 1.0, "center_of_mass": [0.0, 0.0, -0.5]}


def hinged(body: dict, spin: list, duration: float, load: list | None = None, **held: object) -> Run:
    """Run a body on an axle through the origin of its part axes."""
    tilt, accuracy = held.pop("tilt", 0.0), held.pop("accuracy", 1e-10)
    table = {
        "body": body,
        "start": {"angular_velocity": spin, "frame": "part", "attitude": [np.sin(tilt / 2), 0, 0, np.cos(tilt / 2)]},
        "constraint": {"kind": "hinge", "axis": [1, 0, 0], **held},
        "load": load or [],
        "run": {"duration": duration, "samples": 2001, "accuracy": accuracy},
    }
    return inertia.simulate(inertia.Scene.from_dict(table))


def angle_of(acceleration, rate: float, time: float) -> float:
    """Return θ(t) by Taylor series with 30 digits."""
    with mpmath.workdps(30):
        way = mpmath.odefun(lambda _, y: [y[1], acceleration(*y)], 0, [mpmath.mpf(0), mpmath.mpf(rate)])
        return float(way(time)[0])


@pytest.mark.parametrize(
    ("spin", "load", "held", "method"),
    [
        (3.0, [{"kind": "torque", "torque": [0.05, 0.1, 0]}], {}, "closed form"),
        (3.0, [{"kind": "damping", "coefficient": 0.3}, {"kind": "torque", "torque": [0.5, 0, 0]}], {}, "exponentials"),
        (3.0, [], {"stiffness": 2.0, "rest_angle": 0.4}, "exponentials"),
        (3.0, [{"kind": "damping", "coefficient": 5.0}], {"stiffness": 2.0}, "exponentials"),
        (1.0, [GRAVITY], {"tilt": 0.7}, "elliptic"),
        (9.0, [GRAVITY], {"tilt": 0.7}, "elliptic"),
        (4.0, [GRAVITY, {"kind": "damping", "coefficient": 0.1}], {"stiffness": 1.0, "rest_angle": 1.0}, "Taylor"),
    ],
)
def test_the_angle_is_right_to_the_accuracy_that_is_stated(spin: float, load: list, held: dict, method: str) -> None:
    run = hinged(BAR, [spin, 0, 0], 3.0, load, **held)
    moment = mpmath.mpf(0.0834) + mpmath.mpf(0.25)
    torque = sum(k["torque"][0] for k in load if k["kind"] == "torque")
    damping = sum(k["coefficient"] for k in load if k["kind"] == "damping")
    weight = 0.5 * 9.80665 if GRAVITY in load else 0.0
    stiffness, rest, tilt = (mpmath.mpf(held.get(k, 0.0)) for k in ("stiffness", "rest_angle", "tilt"))

    def acceleration(angle, rate):
        spring = stiffness * (angle - rest)
        return (torque - damping * rate - spring - weight * mpmath.sin(angle + tilt)) / moment

    error = abs(run.quantities["angle"][-1] - angle_of(acceleration, spin, 3.0))
    assert method in run.error.method
    assert run.error.reached < 1e-11
    assert error <= run.error.reached


def test_an_upright_pendulum_is_known_as_badly_as_its_start() -> None:
    """Its angle from the top grows as cosh(λ t): what rounding the start leaves open is charged so."""
    up = BAR | {"center_of_mass": [0.0, 0.0, 0.5]}
    grown = np.cosh(np.sqrt(0.5 * 9.80665 / 0.3334) * 4.0)
    run = hinged(up, [0.0, 0, 0], 4.0, [GRAVITY], tilt=1e-9, accuracy=1e-6)
    assert run.quantities["angle"][-1] == pytest.approx(1e-9 * (grown - 1.0), rel=1e-3)
    assert run.error.reached > 2.0**-54 * grown * 1e-1


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
    tensor = 2.0 * mass * (arm**2 * np.eye(3) - np.outer(place, place)) + 1e-9 * np.eye(3)
    run = hinged({"inertia": tensor.tolist(), "mass": 2 * mass}, [spin, 0, 0], 1.0, drive="constant_speed")
    held = np.linalg.norm(run.quantities["reaction torque"], axis=1)
    assert held == pytest.approx(2 * mass * arm**2 * spin**2 * np.sin(tilt) * np.cos(tilt))
    assert np.abs(run.quantities["drive torque"]).max() < 1e-12


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


@pytest.mark.parametrize(("tilt", "duration"), [(1e-9, 4.0), (1e-6, 6.0), (6e-3, 7.0)])
def test_near_the_upper_rest_the_claim_grows_as_neighbours_part(tilt: float, duration: float) -> None:
    run = hinged(
        BAR | {"center_of_mass": [0.0, 0.0, 0.5]}, [0.0, 0.0, 0.0], duration, [GRAVITY], tilt=tilt, accuracy=1.0
    )
    with mpmath.workdps(60):  # let go at rest: sin ½φ = k cd(ω₀ t), φ from below
        start = [mpmath.mpf(x) for x in run.scene.start.attitude.tolist()]
        modulus = start[3] / mpmath.hypot(start[0], start[3])
        rate = mpmath.sqrt(mpmath.mpf(0.5) * mpmath.mpf(9.80665) / (mpmath.mpf(0.0834) + mpmath.mpf(0.25)))
        cn, dn = (mpmath.ellipfun(kind, rate * duration, m=modulus**2) for kind in ("cn", "dn"))
        moved = 2 * mpmath.asin(modulus) - 2 * mpmath.asin(modulus * cn / dn)
        off = float(abs(moved - run.quantities["angle"][-1]))
    assert off <= run.error.reached < 1e-2
    assert run.error.reached > 1e-13
