"""Runs: the motion in part axes, what it keeps, and the accuracy that is promised and held."""

import math
import re
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.dynamics.oracle import rotate
from tests.dynamics.scenes import DISC, PLAIN, TOP, scene

import inertia
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.free.model import AsymmetricTop, FreeBody
from inertia.dynamics.run import Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings, Start
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError
from inertia_meshes import path

TURN = [0.5, 0.1, -0.7, 0.5]
TURN = (np.array(TURN) / np.linalg.norm(TURN)).tolist()


def run_of(base: dict[str, Any] = PLAIN, **changes: Any) -> Run:
    return simulate(scene(base, **changes))


@pytest.mark.parametrize(
    "body",
    [
        inertia.lamina([[0, 0], [0.8, 0], [0.8, 0.3], [0.3, 0.7]], 2.0),
        inertia.wire([[0, 0, 0], [0.8, 0, 0]], 0.2) + inertia.wire([[0.8, 0, -0.1], [0.8, 0, 0.1]], 3.0),
        inertia.lamina([[0, 0], [1, 0], [1, 1], [0, 1]], 1.0),
    ],
)
def test_what_is_flat_is_followed_with_the_bounds_of_its_tensor(body: inertia.MassProperties) -> None:
    """I1 + I2 = I3 to the last digit: a tensor within its bounds whose largest moment is larger is none of a body."""
    run = simulate(Scene(SceneBody.of(body), Start(np.array([0.3, 1.0, 2.0])), Settings(1.0, 11)))
    truth = rotate(tuple(body.principal_moments.tolist()), (0.3, 1.0, 2.0), run.time.tolist())
    turned = quaternion.from_matrix(body.principal_axes)
    carried = quaternion.multiply(quaternion.multiply(quaternion.conjugate(turned), run.attitude), turned)
    assert 0 < run.error.inputs < 1e-13
    assert truth.attitude_error(carried).max() <= run.error.reached + run.error.inputs + 1e-15


def test_a_free_body_is_followed_to_the_accuracy_asked() -> None:
    run = run_of(start__attitude=TURN, run__accuracy=1e-13)
    truth = rotate((1, 2, 3), (0.3, 1.0, 2.0), run.time.tolist(), attitude=TURN)
    assert run.model == "asymmetric top"
    assert truth.attitude_error(run.attitude).max() <= run.error.reached <= 1e-13
    assert truth.angular_velocity_error(run.angular_velocity).max() < 1e-14
    assert (run.error.requested, run.steps) == (1e-13, 0)


def test_the_answer_is_in_part_axes_whatever_axes_the_model_takes() -> None:
    # The same body, described in axes that are turned by R: components there are Rᵀ of the old ones.
    axes = quaternion.matrix(TURN)
    tensor = axes.T @ np.diag([1.0, 2.0, 3.0]) @ axes
    run = run_of(
        body={"inertia": (0.5 * (tensor + tensor.T)).tolist()},
        start={"angular_velocity": (axes.T @ [0.3, 1.0, 2.0]).tolist(), "frame": "part", "attitude": TURN},
    )
    truth = rotate((1, 2, 3), (0.3, 1.0, 2.0), run.time.tolist())
    expected = quaternion.multiply(truth.attitude.astype(float), TURN)
    assert quaternion.angle_between(run.attitude, expected).max() < 1e-13
    np.testing.assert_allclose(run.angular_velocity, truth.angular_velocity.astype(float) @ axes, atol=2e-14)


@pytest.mark.parametrize(
    "loads", [{"damping": 0.05}, {"body_torque": (0.1, -0.2, 0.05)}, {"space_torque": (0, 0.3, 0.1)}]
)
def test_torques_are_integrated_to_the_accuracy_asked(loads: dict) -> None:
    tables = {
        "damping": lambda value: {"kind": "damping", "coefficient": value},
        "body_torque": lambda value: {"kind": "torque", "torque": list(value), "frame": "part"},
        "space_torque": lambda value: {"kind": "torque", "torque": list(value), "frame": "space"},
    }
    # Part axes that are the principal ones in another order, so that a mix-up of axes shows.
    run = run_of(
        body={"inertia": [[3, 0, 0], [0, 1, 0], [0, 0, 2]]},
        start={"angular_velocity": [2.0, 0.3, 1.0], "frame": "part", "attitude": TURN},
        load=[tables[name](value) for name, value in loads.items()],
    )
    truth = rotate((3, 1, 2), (2.0, 0.3, 1.0), run.time.tolist(), attitude=TURN, **loads)
    assert run.model == "Euler equations"
    assert truth.attitude_error(run.attitude).max() <= run.error.reached <= 1e-10
    assert run.steps > 0


def test_a_torque_along_the_principal_axes_is_turned_into_the_part() -> None:
    base = {"body": {"inertia": [[3, 0, 0], [0, 1, 0], [0, 0, 2]]}, "start__frame": "part"}
    one = run_of(**base, load=[{"kind": "torque", "torque": [0.1, 0.2, 0.3], "frame": "principal"}])
    other = run_of(**base, load=[{"kind": "torque", "torque": [0.3, 0.1, 0.2], "frame": "part"}])
    np.testing.assert_allclose(one.attitude, other.attitude, atol=1e-10)


def test_a_table_of_torques_is_linear_between_its_rows() -> None:
    # About a principal axis I φ̈ = N(t): up to 2 N m at 1 s and back to 0 at 3 s on I = 3 kg m².
    rows = np.array([[0.0, 0, 0, 0], [1, 0, 0, 2], [3, 0, 0, 0]])
    made = Scene(
        scene(start__angular_velocity=[0, 0, 1]).body,
        Start([0, 0, 1]),
        Settings(3.0, 4),
        applied_loads=(Torque(table=rows),),
    )
    run = simulate(made)
    np.testing.assert_allclose(run.angular_velocity[:, 2], [1, 1 + 1 / 3, 1 + 2.5 / 3, 2], atol=1e-12)
    # φ = t + ∫∫N/I: 1/9 after 1 s; then ω = 4/3 + (2 s − s²/2)/3 for 2 s: 8/3 + 8/9 more.
    angle = 2 * np.arctan2(run.attitude[:, 2], run.attitude[:, 3])
    assert angle[1] == pytest.approx(1 + 1 / 9, abs=1e-11)
    assert math.cos(angle[-1] - (1 + 1 / 9 + 8 / 3 + 8 / 9)) == pytest.approx(1, abs=1e-14)


def test_a_function_gives_torques_in_part_axes() -> None:
    seen = []

    def spring(time: float, attitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        seen.append((time, attitude.shape, omega.shape))
        return np.array([0.0, 0.0, -12.0 * 2 * math.atan2(attitude[2], attitude[3])])

    body = scene(body={"inertia": [[1, 0, 0], [0, 2, 0], [0, 0, 3]]}).body
    load = Torque(spring, longest_step=1.0)
    run = simulate(Scene(body, Start([0, 0, 1.0], frame="part"), Settings(3.0, 31), applied_loads=(load,)))
    angle = 2 * np.arctan2(run.attitude[:, 2], run.attitude[:, 3])
    np.testing.assert_allclose(angle, np.sin(2 * run.time) / 2, atol=1e-9)  # φ̈ = −4 φ
    assert seen[0][1:] == ((4,), (3,))


def test_dissipation_keeps_the_angular_momentum_and_ends_on_the_largest_axis() -> None:
    run = run_of(load=[{"kind": "dissipation", "rate": 0.3}], run__duration=200, start__angular_velocity=[5, 0.1, 0.2])
    np.testing.assert_allclose(run.angular_momentum - run.angular_momentum[0], 0, atol=1e-9)
    momentum = math.sqrt(5**2 + 0.2**2 + 0.6**2)
    np.testing.assert_allclose(np.abs(run.angular_velocity[-1]), [0, 0, momentum / 3], atol=1e-6)
    assert run.energy[-1] == pytest.approx(momentum**2 / 6, rel=1e-9)
    assert np.all(np.diff(run.energy) <= 1e-12)
    assert set(run.invariants) == {"angular momentum"}


def test_a_thrown_body_follows_a_parabola_and_turns_freely() -> None:
    thrown = {"start__position": [1, 2, 3], "start__velocity": [4, 0, 5], "load": [{"kind": "gravity"}]}
    run, free = run_of(**thrown), run_of()
    t = run.time
    assert run.position is not None
    expected = np.column_stack([1 + 4 * t, 2 + 0 * t, 3 + 5 * t - 0.5 * 9.80665 * t * t])
    np.testing.assert_allclose(run.position, expected, rtol=1e-14)
    np.testing.assert_array_equal(run.attitude, free.attitude)
    assert free.position is None


def test_angular_momentum_and_energy_are_those_of_the_start() -> None:
    run = run_of(start__attitude=TURN)
    momentum = quaternion.matrix(TURN) @ [0.3, 2.0, 6.0]
    np.testing.assert_allclose(run.angular_momentum, np.broadcast_to(momentum, (11, 3)), atol=2e-14)
    np.testing.assert_allclose(run.energy, 0.5 * (0.3**2 + 2 + 3 * 4), rtol=1e-14)
    assert run.invariants["energy"].initial == pytest.approx(7.045)
    np.testing.assert_allclose(run.invariants["angular momentum"].initial, momentum, atol=1e-14)


def test_a_heavy_symmetric_top_is_followed_to_the_accuracy_asked() -> None:
    run = run_of(TOP, run__accuracy=1e-11)
    truth = rotate(
        (2e-4 + 0.1 * 0.04**2, 2e-4 + 0.1 * 0.04**2, 1.25e-4),
        (0, 0, 150),
        run.time.tolist(),
        attitude=(0.6, 0, 0, 0.8),
        mass=0.1,
        offset=(0, 0, 0.04),
        gravity=(0, 0, -9.80665),
    )
    assert run.model == "heavy symmetric top"
    assert truth.attitude_error(run.attitude).max() <= run.error.reached <= 1e-11
    assert run.position is not None
    np.testing.assert_allclose(run.position, quaternion.to_space(run.attitude, [0, 0, 0.04]), atol=1e-16)


@pytest.mark.parametrize("pull", [[0, 0, 9.8], [9.8, 0, 0], [3.0, -5.0, 8.0]])
def test_gravity_may_pull_any_way(pull: list) -> None:
    run = run_of(TOP, load=[{"kind": "gravity", "acceleration": pull}], start__angular_velocity=[3, 2, 50])
    truth = rotate(
        (3.6e-4, 3.6e-4, 1.25e-4),
        (3, 2, 50),
        run.time.tolist(),
        attitude=(0.6, 0, 0, 0.8),
        mass=0.1,
        offset=(0, 0, 0.04),
        gravity=pull,
    )
    assert run.model == "heavy symmetric top"
    assert truth.attitude_error(run.attitude).max() < 1e-11


def test_a_heavy_asymmetric_top_is_integrated() -> None:
    run = run_of(TOP, body={"principal_moments": [2e-4, 3e-4, 4e-4], "mass": 0.1, "center_of_mass": [0.01, 0, 0.04]})
    assert run.model == "Euler equations"
    kept = [name for name in run.invariants if name != "energy"]
    assert kept == ["angular momentum along (0, 0, 1) in space"]
    # Energy about the fixed point, from the mass on its circle: ½ ω·I ω + ½ m v² + m g z.
    omega, arm = run.angular_velocity, np.array([0.01, 0, 0.04])
    speed = np.linalg.norm(np.cross(omega, arm), axis=1)
    assert run.position is not None
    total = 0.5 * (omega**2 @ [2e-4, 3e-4, 4e-4]) + 0.05 * speed**2 + 0.1 * 9.80665 * run.position[:, 2]
    np.testing.assert_allclose(run.energy, total, rtol=1e-12)


def test_a_held_body_without_gravity_turns_freely_about_the_point() -> None:
    held = {"constraint": {"kind": "fixed_point", "point": [0, 0, -2]}, "start__position": [5, 0, 0]}
    run = run_of(**held)
    truth = rotate((1 + 8, 2 + 8, 3), (0.3, 1.0, 2.0), run.time.tolist())
    assert run.model == "asymmetric top"
    assert truth.attitude_error(run.attitude).max() < 1e-13
    assert run.position is not None
    np.testing.assert_allclose(run.position[0], [5, 0, 2])
    np.testing.assert_allclose(np.linalg.norm(run.position - [5, 0, 0], axis=1), 2)


def test_a_rolling_body_is_followed_with_its_contact_forces() -> None:
    run = run_of(DISC)
    assert run.model == "rolling body"
    assert {"energy", "Appell–Korteweg 1", "Appell–Korteweg 2"} <= set(run.invariants)
    assert run.position is not None
    # No slip: the velocity of the centre of mass plus ω × (contact − centre) is zero.
    fine = run_of(DISC, run__samples=2001)
    assert fine.position is not None
    slip = np.gradient(fine.position, fine.time, axis=0, edge_order=2)
    spin = quaternion.to_space(fine.attitude, fine.angular_velocity)
    arm = fine.quantities["contact"] - fine.position
    np.testing.assert_allclose(slip + np.cross(spin, arm), 0, atol=2e-5)


def test_the_offset_of_the_rim_counts_along_the_axis_that_is_named() -> None:
    up = run_of(DISC, constraint__offset=0.2, constraint__axis=[0, 0, 1])
    down = run_of(DISC, constraint__offset=-0.2, constraint__axis=[0, 0, -1])
    np.testing.assert_allclose(up.attitude, down.attitude, atol=1e-8)
    np.testing.assert_allclose(up.position, down.position, atol=1e-8)


@pytest.mark.parametrize(
    ("spin", "kind"),
    [
        ([0, 0, 150], "cusps"),
        ([0, -3, 150], "loops"),  # φ̇ < 0 at the least tilt
        ([0, 0.1, 150], "without cusps or loops"),
    ],
)
def test_the_kind_of_nutation_is_said(spin: list, kind: str) -> None:
    assert kind in run_of(TOP, start__angular_velocity=spin).remarks[0]


def test_a_top_is_told_how_fast_it_must_spin_to_sleep() -> None:
    run = run_of(TOP)
    limit = math.sqrt(4 * 0.1 * 9.80665 * 0.04 * 3.6e-4) / 1.25e-4
    assert run.remarks[-1] == f"Upright it would sleep stably: that takes a spin of {limit:.6g} rad/s about its axis."
    # I1 cosθ φ̇² − p φ̇ + mgh = 0
    slow, fast = run.quantities["steady precession, slow and fast"]
    tilt = 2 * math.asin(0.6)
    for rate in (slow, fast):
        assert 3.6e-4 * math.cos(tilt) * rate**2 + 0.1 * 9.80665 * 0.04 == pytest.approx(1.25e-4 * 150 * rate)


def test_quaternions_do_not_jump() -> None:
    run = run_of(run__duration=100, run__samples=2001)
    assert np.einsum("ij,ij->i", run.attitude[1:], run.attitude[:-1]).min() > 0
    np.testing.assert_allclose(np.linalg.norm(run.attitude, axis=1), 1, rtol=1e-14)


def test_euler_angles_and_their_momenta_are_outputs_of_a_run() -> None:
    run = run_of(TOP)
    momenta = run.canonical_momenta()
    # p_φ is L along the vertical, p_ψ along the axis of symmetry: both are kept.
    np.testing.assert_allclose(momenta[:, 0], run.angular_momentum[:, 2], rtol=1e-12)
    np.testing.assert_allclose(momenta[:, 2], 1.25e-4 * 150, rtol=1e-12)
    assert run.euler_angles()[0, 1] == pytest.approx(2 * math.asin(0.6))
    np.testing.assert_allclose(run.andoyer().L, 1.25e-4 * 150, rtol=1e-12)


def test_the_part_may_be_a_mesh() -> None:
    part = inertia.read(path("t_handle.stl"), unit="mm")
    body = SceneBody.of(inertia.mass_properties(part, material="steel"))
    run = inertia.simulate(inertia.Scene(body, Start([0.001, 10, 0]), Settings(60.0, 601)))
    flips = [event.time for event in run.events if event.name == "flip"]
    assert len(flips) == 20
    np.testing.assert_allclose(np.diff(flips), run.quantities["flip period"], rtol=1e-12)


def test_moments_that_are_not_known_well_enough_are_warned_of() -> None:
    part = inertia.read(path("t_handle.stl"), unit="mm")
    body = SceneBody.of(inertia.mass_properties(part, material="steel"))
    run = simulate(inertia.Scene(body, Start([1, 2, 3]), Settings(1e8, 2)))
    (warning,) = run.warnings
    known = re.search(r"known within bounds \(the tensor to (\S+) of its smallest moment\)", warning)
    assert known is not None
    assert f"holds up to {run.error.until:.3g} s" in warning
    # Where neighbours part linearly, a relative bound β of the moments counts as some β |ω| t.
    assert 0.1 < float(known[1]) * math.sqrt(14) * run.error.until / run.error.requested < 10
    assert simulate(inertia.Scene(body, Start([1, 2, 3]), Settings(1.0, 2))).warnings == ()


def spoiled(monkeypatch: pytest.MonkeyPatch, **changes: Any) -> None:
    """Have the model hand back a motion with these changes."""
    solve = FreeBody.solve
    monkeypatch.setattr(AsymmetricTop, "solve", lambda *arguments: replace(solve(*arguments), **changes))


def test_an_accuracy_that_is_not_reached_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    spoiled(monkeypatch, reached=3e-9)
    with pytest.raises(GeometryError, match=r"^the scene: run\.accuracy asks for 1e-10 rad, but .* reaches 3e-09 rad"):
        run_of()
    assert run_of(run__accuracy=1e-8).error.reached == 3e-9


@pytest.mark.parametrize("reached", [math.nan, math.inf])
def test_an_accuracy_that_is_not_known_is_an_error(monkeypatch: pytest.MonkeyPatch, reached: float) -> None:
    spoiled(monkeypatch, reached=reached)
    with pytest.raises(GeometryError, match=r"run\.accuracy"):
        run_of()


def test_a_drift_above_the_request_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    energy = np.full(11, 7.0)
    energy[5] += 7e-9
    spoiled(monkeypatch, invariants={"energy": energy})
    with pytest.raises(
        GeometryError,
        match=r"energy must be kept, but its relative drift is 1e-09 where .* ask for 1e-09 or",
    ):
        run_of()
    drifted = run_of(run__accuracy=2e-9)
    assert drifted.invariants["energy"].largest_relative_drift == pytest.approx(1e-9)


def test_a_drift_is_relative_to_the_models_scale_where_it_gives_one(monkeypatch: pytest.MonkeyPatch) -> None:
    values = np.zeros(11)
    values[3] = 1e-12
    spoiled(monkeypatch, invariants={"Kovalevskaya": values}, scales={"Kovalevskaya": 10.0})
    assert run_of().invariants["Kovalevskaya"].largest_relative_drift == pytest.approx(1e-13)
    spoiled(monkeypatch, invariants={"Kovalevskaya": values}, scales={})
    with pytest.raises(GeometryError, match=r"drift is inf where .* ask for a shorter"):
        run_of()


def test_one_component_of_the_angular_momentum_is_measured_by_all_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    along = np.zeros(11)
    along[3] = 1e-11
    spoiled(monkeypatch, invariants={"angular momentum along (1, 0, 0) in space": along})
    (kept,) = run_of().invariants.values()
    assert kept.largest_relative_drift == pytest.approx(1e-11 / math.sqrt(0.3**2 + 2**2 + 6**2))


def test_a_run_that_would_take_hours_is_refused_at_once() -> None:
    near = {"kind": "gravity_gradient", "mu": 4e14, "position": [3.0, 0.0, 0.0]}
    settings = {"duration": 11000.0, "samples": 1101, "accuracy": 1e-9, "time_limit": 3}
    body = {"principal_moments": [20.0, 180.0, 190.0]}
    begin = time.process_time()
    with pytest.raises(GeometryError, match=r"the run (would take some|takes longer than 3 s).*limit.*run\.time_limit"):
        run_of(body=body, start__angular_velocity=[0.1, 0.2, 0.3], load=[near], run=settings)
    assert time.process_time() - begin < 10


def test_a_limit_of_time_changes_no_answer() -> None:
    load = [{"kind": "damping", "coefficient": 0.05}]
    settings = {"duration": 2e4, "samples": 3, "accuracy": 1e-6}
    runs = [run_of(load=load, run={**settings, "time_limit": limit}) for limit in (20, 60)]
    assert np.array_equal(runs[0].attitude, runs[1].attitude)


def test_a_body_without_thickness_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"the smallest principal moment is 1e-31 kg m²"):
        run_of(body={"principal_moments": [1e-31, 1.0, 1.0]})


@pytest.mark.parametrize(("spin", "duration"), [([0.3, 5.0, 0.2], 186.2), ([1.0, 2.0, 30.0], 28.6)])
def test_the_accuracy_that_a_closed_form_asks_for_is_reached(spin: list, duration: float) -> None:
    """The figure is rounded up."""
    changes = {"body": {"principal_moments": [1, 2, 2.7]}, "start__angular_velocity": spin, "run__duration": duration}
    with pytest.raises(GeometryError, match="ask for that") as refusal:
        simulate(scene(**changes, run__accuracy=1e-15))
    advice = float(str(refusal.value).split("reaches ")[1].split(" rad")[0])
    assert simulate(scene(**changes, run__accuracy=advice)).error.reached <= advice


@pytest.mark.parametrize(("moments", "spin"), [([3, 4, 6], [2, 3, 1]), ([6, 8, 12], [-4, 0, 2])])
def test_a_spin_on_the_separatrix_goes_round_neither_axis(moments: list[float], spin: list[float]) -> None:
    """2T I2 = L² exactly, 216 and 1152: what is left in the end is the spin about the intermediate axis."""
    run = simulate(
        Scene.from_dict(
            {
                "body": {"principal_moments": moments},
                "start": {"angular_velocity": spin},
                "run": {"duration": 10.0, "samples": 2},
            }
        )
    )
    assert [remark for remark in run.remarks if "goes round" in remark] == []
    assert any("on the separatrix: it goes to the axis of the intermediate moment" in remark for remark in run.remarks)
    assert np.abs(run.angular_velocity[-1, [0, 2]]).max() < 1e-3 * np.abs(run.angular_velocity[-1, 1])
