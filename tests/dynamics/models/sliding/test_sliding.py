"""A ball that slides with friction: against mpmath, what is kept, and where the tippe top ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from tests.dynamics.extrapolation import follow
from tests.dynamics.oracle import off_by

from inertia import GeometryError, Run, Scene, UsageError, simulate
from inertia.dynamics.kinematics import quaternion
from inertia.native import Kernel
from inertia_meshes import path

G = 9.80665
TOP: dict[str, Any] = {
    "body": {"principal_moments": [2e-6, 2e-6, 2.1e-6], "mass": 0.015, "center_of_mass": [0.0, 0.0, -0.004]},
    "start": {"angular_velocity": [0.0, 0.0, 160.0], "attitude": quaternion.from_rotation_vector([0.1, 0, 0]).tolist()},
    "constraint": {"kind": "sliding", "radius": 0.018, "friction": 0.3, "slip_speed": 0.02},
    "load": [{"kind": "gravity"}],
    "run": {"duration": 0.2, "samples": 5, "accuracy": 1e-8},
}


def changed(**sections: Any) -> dict[str, Any]:
    return TOP | {name: TOP[name] | to if isinstance(to, dict) else to for name, to in sections.items()}


def run_of(**sections: Any) -> Run:
    return simulate(Scene.from_dict(changed(**sections)))


def newton_and_euler(scene: Scene) -> tuple[Any, list[Any]]:
    """Return the rate of (s, v, q, L) in space and the start: N is what keeps the ball's centre at its height."""
    body, held, m = scene.body, scene.constraint, mpmath.mpf(scene.body.mass or 0)
    moments = [mpmath.mpf(x) for x in np.diag(body.inertia)]
    arm = [mpmath.mpf(x) for x in held.fixed_point - body.center_of_mass]
    up, gravity = [mpmath.mpf(x) for x in held.plane], [mpmath.mpf(x) for x in scene.gravity]
    length = mpmath.norm(up)
    up = [x / length for x in up]
    radius, mu, slow = (mpmath.mpf(x) for x in (held.radius, held.friction, held.slip_speed))

    def cross(a: list[Any], b: list[Any]) -> list[Any]:
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    def dot(a: list[Any], b: list[Any]) -> Any:
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

    def rows(q: list[Any]) -> list[list[Any]]:
        x, y, z, w = q
        size = x * x + y * y + z * z + w * w
        return [
            [(w * w + x * x - y * y - z * z) / size, 2 * (x * y - z * w) / size, 2 * (x * z + y * w) / size],
            [2 * (x * y + z * w) / size, (w * w - x * x + y * y - z * z) / size, 2 * (y * z - x * w) / size],
            [2 * (x * z - y * w) / size, 2 * (y * z + x * w) / size, (w * w - x * x - y * y + z * z) / size],
        ]

    def turned(r: list[list[Any]], a: list[Any]) -> list[Any]:
        return [dot(row, a) for row in r]

    def spin_of(r: list[list[Any]], momentum: list[Any]) -> list[Any]:
        along = [dot([row[k] for row in r], momentum) / moments[k] for k in range(3)]
        return turned(r, along)

    def rate(_: Any, y: list[Any]) -> list[Any]:
        v, q, momentum = y[3:6], y[6:10], y[10:13]
        r = rows(q)
        w = spin_of(r, momentum)
        b = turned(r, arm)
        a = [x - radius * n for x, n in zip(b, up, strict=True)]
        slip = [x + t for x, t in zip(v, cross(w, a), strict=True)]
        drag = mu / mpmath.sqrt(dot(slip, slip) + slow * slow)
        pushed = [n - drag * u for n, u in zip(up, slip, strict=True)]

        lever, swept, inward = cross(a, pushed), cross(w, momentum), cross(w, cross(w, b))

        def pace(force: int) -> Any:
            gain = spin_of(r, [force * t - c for t, c in zip(lever, swept, strict=True)])
            center = [force * x / m + g for x, g in zip(pushed, gravity, strict=True)]
            return dot([x + p + o for x, p, o in zip(center, cross(gain, b), inward, strict=True)], up)

        without = pace(0)
        force = -without / (pace(1) - without)
        center, torque = [force * x / m + g for x, g in zip(pushed, gravity, strict=True)], [force * x for x in lever]
        p, o, t = w
        i, j, k, s = q
        turn = [
            (s * p + o * k - t * j) / 2,
            (s * o + t * i - p * k) / 2,
            (s * t + p * j - o * i) / 2,
            -(p * i + o * j + t * k) / 2,
        ]
        return [*v, *center, *turn, *torque]

    start = [mpmath.mpf(x) for x in scene.start.attitude]
    length = mpmath.norm(start)
    start = [x / length for x in start]
    r = rows(start)
    w = turned(r, [mpmath.mpf(x) for x in scene.angular_velocity])
    momentum = turned(r, [j * mpmath.mpf(x) for j, x in zip(moments, scene.angular_velocity, strict=True)])
    b = turned(r, arm)
    a = [x - radius * n for x, n in zip(b, up, strict=True)]
    given = [mpmath.mpf(0)] * 3 if scene.start.velocity is None else [mpmath.mpf(x) for x in scene.start.velocity]
    rise = -dot(cross(w, a), up)
    velocity = [x + rise * n for x, n in zip(given, up, strict=True)]
    return rate, [*(-x for x in a), *velocity, *start, *momentum]


CASES: dict[str, dict[str, Any]] = {
    "tippe top": {"run": {"duration": 0.06}},
    "any tensor, coulomb": {
        "body": {"principal_moments": [1.7e-6, 2e-6, 2.3e-6], "center_of_mass": [0.001, -0.002, -0.003]},
        "start": {"angular_velocity": [10.0, -20.0, 60.0], "velocity": [0.2, -0.1, 0.0]},
        "constraint": {"slip_speed": 0.004, "friction": 0.2},
        "run": {"duration": 0.1},
    },
    "slope": {
        "start": {"angular_velocity": [3.0, 5.0, 30.0]},
        "constraint": {"normal": [0.1, -0.2, 0.9], "slip_speed": 0.1},
        "run": {"duration": 0.1},
    },
    "a few steps": {
        "body": {"principal_moments": [1.25e-6, 1.25e-6, 1.54e-6], "mass": 0.02, "center_of_mass": [0, 0, -0.0048]},
        "start": {
            "angular_velocity": [-5.413213794999394, 6.145819387356929, -48.70418854522684],
            "attitude": [0.345102529729075, -0.7600179617511906, -0.49615345294501295, 0.23897425158560334],
        },
        "constraint": {"radius": 0.02, "friction": 0.3904, "slip_speed": 0.066},
        "run": {"duration": 0.03974643772110975, "samples": 4, "accuracy": 3.765501052078873e-06},
    },
    "smooth": {"start": {"angular_velocity": [1.0, 0.0, 50.0]}, "constraint": {"friction": 0.0}},
}


@pytest.mark.parametrize("name", CASES)
def test_the_claim_holds_against_newton_and_euler(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = []
    for native in (True, False):
        monkeypatch.setattr(Kernel, "worthwhile", lambda self, count, native=native: native)
        runs.append(run_of(**CASES[name]))
    with mpmath.workdps(30):
        rate, start = newton_and_euler(runs[0].scene)
        truth = follow(rate, start, runs[0].time[1:].tolist(), 0.002)
    for run in runs:
        assert run.position is not None
        for k, row in enumerate(truth, 1):
            apart = quaternion.angle_between(np.array(row[6:10], dtype=np.float64), run.attitude[k])
            place = np.array(row[:3], dtype=np.float64)
            assert apart <= run.error.reached
            np.testing.assert_allclose(run.position[k], place, atol=0.1 * run.error.reached)


def test_a_run_by_the_kernel_ends_at_its_time_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Kernel, "worthwhile", lambda self, count: True)
    with pytest.raises(GeometryError, match=r"takes longer than 0\.2 s of computing, which is its limit"):
        run_of(run={"duration": 2000.0, "time_limit": 0.2})


def test_jellett_and_the_energy_with_its_heat_are_kept_while_the_energy_falls() -> None:
    run = run_of(run={"duration": 1.0, "samples": 501, "accuracy": 1e-7})
    assert run.invariants.keys() == {"energy and heat", "Jellett's integral"}
    assert max(kept.largest_relative_drift for kept in run.invariants.values()) < 1e-9
    assert (np.diff(run.energy) < 0).all()
    # −L·a in space, from what the run hands out
    assert run.position is not None
    reach = run.quantities["contact"] - run.position
    np.testing.assert_allclose(
        run.invariants["Jellett's integral"].values, -(run.angular_momentum * reach).sum(axis=1), rtol=1e-9
    )
    kinetic = 0.5 * (run.angular_velocity**2 * [2e-6, 2e-6, 2.1e-6]).sum(axis=1)
    assert (run.energy > kinetic).all()


def test_a_body_that_is_not_of_revolution_keeps_no_jellett_integral() -> None:
    assert run_of(body={"principal_moments": [1.9e-6, 2e-6, 2.1e-6]}).invariants.keys() == {"energy and heat"}


def thresholds(i1: float, i3: float, m: float, radius: float, offset: float) -> tuple[float, float]:
    """Return the spins of the start, upright, above which that is unstable, and turning over completely stable:
    λ_thres = √(m g R³ α I₃) (1 + α)²/√(1 + α − γ) of Rauch-Wojciechowski, Sköldstam & Glad (2005), λ = R (1 − α) I₃ ω.
    """
    alpha, gamma = offset / radius, i1 / i3
    unit = np.sqrt(m * G * radius**3 * alpha * i3)
    jellett = unit * (1 - alpha) ** 2 / np.sqrt(gamma - 1 + alpha), unit * (1 + alpha) ** 2 / np.sqrt(1 + alpha - gamma)
    low, high = (value / (radius * (1 - alpha) * i3) for value in jellett)
    return float(low), float(high)


@pytest.mark.parametrize(("share", "ends"), [(0.9, "low"), (1.4, "tilted"), (2.3, "high")])
def test_it_ends_where_its_energy_is_least(share: float, ends: str) -> None:
    """The shares are of the spin at which upright is unstable; what is left of rolling on dies out slowly."""
    low, high = thresholds(2e-6, 2.1e-6, 0.015, 0.018, 0.004)
    assert low * 1.4 < high < low * 2.3
    run = run_of(
        start={"angular_velocity": [0.0, 0.0, share * low]},
        constraint={"slip_speed": 0.2},
        run={"duration": 10.0, "samples": 11, "accuracy": 1e-3, "method": "LSODA"},
    )
    least = float(run.quantities["theta of least energy"])
    assert {"low": least == 0.0, "tilted": 0.1 < least < 3.0, "high": least == pytest.approx(np.pi)}[ends]
    assert run.quantities["theta"][-1] == pytest.approx(least, abs=0.15)
    words = {"low": "centre of mass low, at", "tilted": "its axis tilted by", "high": "centre of mass high, at"}
    assert words[ends] in run.remarks[1]
    over = high * (0.018 - 0.004) / (0.018 + 0.004)
    assert f"stable below {low:.6g} rad/s with the centre of mass low, and above {over:.6g} rad/s" in run.remarks[0]


@pytest.mark.parametrize(("side", "share", "stays"), [(-1, 4.0, True), (1, 1.05, True), (1, 0.95, False)])
def test_without_friction_it_is_a_top_about_its_centre_of_mass(side: int, share: float, stays: bool) -> None:
    """Lagrange: I₃ ω > √(4 m g b I₁) keeps it upside down, and any spin upright; nothing takes it to another tilt."""
    limit = float(np.sqrt(4 * 0.015 * G * 0.004 * 2e-6) / 2.1e-6)
    run = run_of(
        body={"center_of_mass": [0.0, 0.0, side * 0.004]},
        start={
            "angular_velocity": [0.0, 0.0, share * limit],
            "attitude": quaternion.from_rotation_vector([1e-3, 0, 0]).tolist(),
        },
        constraint={"friction": 0.0},
        run={"duration": 3.0, "samples": 301, "accuracy": 1e-6},
    )
    theta = run.quantities["theta"]
    assert (np.abs(theta - theta[0]).max() < 5e-3) == stays
    words = f"stable at any speed with the centre of mass low, and above {limit:.6g} rad/s with it high."
    assert run.remarks == (f"Spinning about the vertical is {words}",)
    assert "theta of least energy" not in run.quantities


def test_the_shipped_top_turns_over() -> None:
    scene = Scene.load(path("scenes/tippe_top.toml"))
    run = simulate(replace(scene, run=replace(scene.run, duration=3.0, samples=301, accuracy=1e-3)))
    assert run.quantities["theta"][0] == pytest.approx(0.1)
    assert run.quantities["theta"][-1] > 3.1
    assert run.angular_velocity[-1, 2] < -100


def test_a_ball_that_is_pushed_rolls_on_at_five_sevenths_of_its_speed() -> None:
    """Its angular momentum about any point of the plane is kept, whatever the friction: v = 5/7 v₀."""
    m, radius = 0.2, 0.03
    run = simulate(
        Scene.from_dict({
            "body": {"principal_moments": [0.4 * m * radius**2] * 3, "mass": m},
            "start": {"angular_velocity": [0, 0, 0.001], "velocity": [0.7, 0, 0]},
            "constraint": {"kind": "sliding", "radius": radius, "friction": 0.2, "slip_speed": 0.01},
            "load": [{"kind": "gravity"}],
            "run": {"duration": 1.0, "samples": 11, "accuracy": 1e-8},
        })
    )  # fmt: skip
    assert run.position is not None
    assert run.angular_velocity[-1, 1] * radius == pytest.approx(0.5, rel=1e-8)
    np.testing.assert_allclose(np.diff(run.position[-3:], axis=0) / 0.1, [[0.5, 0, 0]] * 2, atol=1e-7)
    np.testing.assert_allclose(run.quantities["contact velocity"][-1], 0, atol=1e-8)


def test_a_plane_that_stands_the_other_way_changes_nothing_but_the_axes() -> None:
    level = run_of()
    for normal in ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8]):
        turn = quaternion.from_matrix(np.column_stack([*np.linalg.svd(np.array([normal]))[2][1:], normal]))
        if np.linalg.det(quaternion.matrix(turn)) < 0 or not np.allclose(quaternion.to_space(turn, [0, 0, 1]), normal):
            sides = np.linalg.svd(np.array([normal]))[2][1:]
            turn = quaternion.from_matrix(np.column_stack([sides[1], sides[0], normal]))
        tilted = run_of(
            start={"attitude": quaternion.multiply(turn, TOP["start"]["attitude"]).tolist()},
            constraint={"normal": normal},
            load=[{"kind": "gravity", "acceleration": [-G * x for x in normal]}],
        )
        assert level.position is not None
        assert tilted.position is not None
        np.testing.assert_allclose(tilted.position, quaternion.to_space(turn, level.position), atol=1e-9)
        apart = quaternion.angle_between(tilted.attitude, quaternion.multiply(turn, level.attitude))
        assert apart.max() < 2e-8


def test_a_body_that_leaves_the_plane_says_when() -> None:
    run = run_of(start={"angular_velocity": [80.0, 0.0, 0.0]}, constraint={"friction": 0.0}, run={"samples": 2})
    (event,) = run.events
    assert event.name == "lift-off"
    around = run.at(np.array([0.0, event.time - 1e-6, event.time + 1e-6]))
    start, before, after = around.quantities["contact force"][:, 2]
    assert start > before > 0 > after
    assert f"the normal force falls to zero at t = {event.time:.6g} s" in run.warnings[-1]
    assert not run_of().events
    with pytest.raises(GeometryError, match=r"float64.*; the normal force falls to zero at t = "):
        run_of(start={"angular_velocity": [80.0, 0.0, 0.0]}, run={"accuracy": 1e-14})


def test_a_top_that_is_balanced_upright_is_not_foretold() -> None:
    upright = {"attitude": [0.0, 0.0, 0.0, 1.0]}
    with pytest.raises(GeometryError, match=r"centre of mass low, which is unstable above 31\.16 rad/s, and small"):
        run_of(start=upright, run={"duration": 4.0})
    slow = run_of(start=upright | {"angular_velocity": [0.0, 0.0, 25.0]})
    np.testing.assert_allclose(slow.quantities["theta"], 0.0, atol=1e-12)


@pytest.mark.parametrize(("lean", "duration"), [(1e-6, 1.4), (1e-11, 2.6), (1e-12, 2.8), (1e-13, 2.0)])
def test_a_ball_balanced_on_ice_is_known_as_badly_as_its_start(lean: float, duration: float) -> None:
    """Without friction its centre of mass falls straight down: J = I₁ + m b² sin²φ."""
    moment, mass, arm = 1e-6, 0.006, 0.0016
    body = {"principal_moments": [moment] * 3, "mass": mass, "center_of_mass": [0.0, 0.0, arm]}
    start = {
        "angular_velocity": [0.0, 0.0, 0.0],
        "frame": "part",
        "attitude": [np.sin(lean / 2), 0, 0, np.cos(lean / 2)],
    }
    run = simulate(
        Scene.from_dict(
            {
                "body": body,
                "start": start,
                "constraint": {"kind": "sliding", "radius": 0.02, "friction": 0.0},
                "load": [{"kind": "gravity"}],
                "run": {"duration": duration, "samples": 2, "accuracy": 0.1},
            }
        )
    )
    x, _, _, w = run.attitude[-1]
    with mpmath.workdps(30):
        begun = 2 * mpmath.atan(mpmath.mpf(start["attitude"][0]) / mpmath.mpf(start["attitude"][3]))
        pull = mpmath.mpf(mass) * mpmath.mpf(9.80665) * mpmath.mpf(arm)

        def inertia(angle: mpmath.mpf) -> mpmath.mpf:
            return mpmath.mpf(moment) + mpmath.mpf(mass) * mpmath.mpf(arm) ** 2 * mpmath.sin(angle) ** 2

        fallen = float(2 * abs(mpmath.atan(mpmath.mpf(x) / mpmath.mpf(w))))
        assert fallen > 10.0 * lean
        assert off_by(inertia, pull, begun, fallen, duration) <= run.error.reached < 0.1


def test_a_pushed_ball_without_spin_and_a_disc_at_rest_are_scenes() -> None:
    ball = {"principal_moments": [0.4, 0.4, 0.4], "mass": 1.0}
    start = {"angular_velocity": [0, 0, 0], "velocity": [1.0, 0, 0]}
    table = {"body": ball, "start": start, "load": [{"kind": "gravity"}], "run": {"duration": 1.0, "samples": 2}}
    run = simulate(Scene.from_dict(table | {"constraint": {"kind": "sliding", "radius": 1.0, "friction": 0.3}}))
    assert run.angular_velocity[-1, 1] == pytest.approx(5.0 / 7.0, rel=0.1)
    disc = {"principal_moments": [0.25, 0.25, 0.5], "mass": 1.0}
    leaning = {"angular_velocity": [0, 0, 0], "attitude": [0.6, 0, 0, 0.8]}
    table = {"body": disc, "start": leaning, "load": [{"kind": "gravity"}], "run": {"duration": 0.1, "samples": 2}}
    run = simulate(Scene.from_dict(table | {"constraint": {"kind": "rolling", "radius": 1.0}}))
    assert run.quantities["theta"][-1] < run.quantities["theta"][0]


def test_friction_that_jams_the_ball_is_refused() -> None:
    with pytest.raises(
        Exception, match=r"the scene: run: the friction, 9, jams the ball: no normal force keeps it on the plane"
    ):
        run_of(
            body={"principal_moments": [1e-9, 1e-9, 1e-9], "center_of_mass": [0.0, 0.012, -0.012]},
            start={"angular_velocity": [0.0, 0.0, 1.0], "velocity": [0.0, -5.0, 0.0], "attitude": [0, 0, 0, 1]},
            constraint={"friction": 9.0},
        )


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"constraint": {"radius": None}}, "constraint.radius is missing: a ball that slides needs its radius"),
        ({"constraint": {"friction": None}}, "constraint.friction is missing: say how rough the plane is"),
        ({"constraint": {"friction": -0.1}}, "constraint.friction is -0.1: it must not be negative"),
        ({"constraint": {"slip_speed": 0.0}}, "constraint.slip_speed is 0.0: it must be positive"),
        ({"constraint": {"normal": [0, 0, 0]}}, "constraint.normal is zero: it must point somewhere"),
        ({"constraint": {"offset": 0.1}}, 'constraint.offset goes with kind = "rolling" only, not with "sliding"'),
        ({"constraint": {"radius": 0.003}}, "constraint.point is 0.004 m from the centre of mass, which lies within"),
        ({"constraint": {"normal": [0, 0, -1]}}, 'load needs one of kind = "gravity" that presses the body'),
        ({"load": [{"kind": "gravity"}, {"kind": "damping", "coefficient": 1}]}, "load[1] is damping: a sliding body"),
        ({"start": {"velocity": [0, 0, 1.0]}}, "start.velocity points out of the plane or into it"),
        ({"body": {"mass": None}}, "body.mass is missing"),
        ({"run": {"method": "Taylor"}}, "run.method is 'Taylor', which is unknown"),
    ],
)
def test_what_cannot_be_is_refused_by_its_field(change: dict[str, Any], says: str) -> None:
    table = changed(**change)
    table = {
        name: {key: value for key, value in section.items() if value is not None}
        if isinstance(section, dict)
        else section
        for name, section in table.items()
    }
    with pytest.raises(UsageError) as refusal:
        simulate(Scene.from_dict(table))
    assert says in str(refusal.value)


@pytest.mark.parametrize("field", ["friction", "slip_speed", "normal"])
def test_its_fields_go_with_it_alone(field: str) -> None:
    value = [0, 0, 1] if field == "normal" else 0.5
    with pytest.raises(UsageError, match=f"constraint.{field} goes with"):
        Scene.from_dict(
            changed(constraint={"kind": "free", "radius": None, "friction": None, "slip_speed": None, field: value})
        )


def test_it_survives_being_written() -> None:
    scene = Scene.from_dict(changed(constraint={"normal": [0.1, 0.0, 1.0], "point": [0.0, 0.0, 0.001]}))
    again = Scene.loads(scene.to_toml())
    assert (again.constraint.friction, again.constraint.slip_speed) == (0.3, 0.02)
    np.testing.assert_allclose(again.constraint.plane, scene.constraint.plane, atol=1e-16)
    np.testing.assert_array_equal(again.constraint.fixed_point, scene.constraint.fixed_point)
