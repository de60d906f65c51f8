"""Ensembles of scenes: draws, sweeps, percentiles and what drives them, against closed forms."""

import math
import multiprocessing
import os
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.dynamics.oracle import rotate

from inertia import (
    Ensemble,
    Estimate,
    GeometryError,
    Scene,
    SceneBody,
    Torque,
    UsageError,
    analyse,
    ensemble,
    read,
    simulate,
)
from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.sensitivity import attitude_uncertainty
from inertia.dynamics.spread.fields import changed, deviations
from inertia.dynamics.spread.results import Histogram
from inertia.report.spread.table import write_table
from inertia_meshes import path

BALL: dict[str, Any] = {
    "body": {"principal_moments": [2.0, 2.0, 2.0], "mass": 3.0},
    "start": {"angular_velocity": [0.0, 0.0, 3.0]},
    "run": {"duration": 0.5},
}
TOP: dict[str, Any] = {
    "body": {"principal_moments": [0.02, 0.0175, 0.0075], "mass": 1.0, "center_of_mass": [0.05, 0.0, 0.01]},
    "start": {"angular_velocity": [1.0, 2.0, 15.0], "frame": "part"},
    "constraint": {"kind": "fixed_point"},
    "load": [{"kind": "gravity"}, {"kind": "damping", "coefficient": 0.001}],
    "run": {"duration": 1.0, "accuracy": 1e-9},
}


def test_a_sphere_deviates_by_the_deviation_of_its_spin_times_time() -> None:
    spread = ensemble(Scene.from_dict(BALL), {"start.angular_velocity[2]": "±0.1"}, 500, samples=5)
    off = np.abs(spread.values[:, 0] - 3.0)
    assert np.abs(spread.quantities["deviation"] - off[:, None] * spread.time).max() < 1e-14
    expected = np.percentile(off, [5, 50, 95]) * 0.5
    assert spread.percentiles("deviation")[:, -1] == pytest.approx(expected, rel=1e-12)
    assert spread.nominal.angular_velocity[-1].tolist() == [0, 0, 3]


def test_draws_have_the_law_that_was_asked_for() -> None:
    laws = {"start.angular_velocity[0]": "2±0.5", "start.angular_velocity[1]": "1..3", "body.mass": Estimate(3.0, 0.3)}
    values = ensemble(Scene.from_dict(BALL), laws, 2000, samples=2, quantities=["spin"]).values
    assert values[:, [0, 2]].mean(axis=0) == pytest.approx([2.0, 3.0], abs=0.05)
    assert values[:, [0, 2]].std(axis=0) == pytest.approx([0.5, 0.3], rel=0.06)
    assert 1.0 <= values[:, 1].min() < 1.01
    assert 2.99 < values[:, 1].max() <= 3.0
    assert values[:, 1].std() == pytest.approx(2.0 / math.sqrt(12.0), rel=0.05)
    assert np.abs(np.corrcoef(values.T) - np.eye(3)).max() < 0.1


def test_a_draw_depends_on_seed_number_and_path_alone() -> None:
    scene = Scene.from_dict(BALL)
    few = ensemble(scene, {"start.angular_velocity[2]": "±0.1"}, 5, samples=2)
    more = ensemble(scene, {"body.mass": "±1%", "start.angular_velocity[2]": "±0.1"}, 40, samples=2)
    other = ensemble(scene, {"start.angular_velocity[2]": "±0.1"}, 5, seed=1, samples=2)
    assert more.values[:5, 1].tolist() == few.values[:, 0].tolist()
    assert (other.values != few.values).all()


def test_the_number_of_processes_changes_nothing() -> None:
    scene = Scene.from_dict(TOP)
    vary = {"body.mass": "±1%", "load[1].coefficient": "0..0.002"}
    alone, shared = (ensemble(scene, vary, 40, samples=7, jobs=jobs) for jobs in (1, 2))
    assert alone.values.tolist() == shared.values.tolist()
    for name, rows in alone.quantities.items():
        assert rows.tolist() == shared.quantities[name].tolist()


def test_sweeps_make_a_grid_with_the_same_draws_at_every_point() -> None:
    laws = {"start.angular_velocity[0]": "0:1:2", "start.angular_velocity[2]": "3±0.1", "body.mass": [1.0, 2.0, 4.0]}
    values = ensemble(Scene.from_dict(BALL), laws, 4, samples=2).values
    assert values.shape == (24, 3)
    assert {tuple(row) for row in values[:, [0, 2]].tolist()} == {(a, m) for a in (0.0, 1.0) for m in (1.0, 2.0, 4.0)}
    assert values[:4, 1].tolist() == values[20:, 1].tolist()


def test_every_draw_is_the_run_of_its_own_scene() -> None:
    vary = {
        "body.mass": "±1%",
        "body.principal_moments[1]": "±1%",
        "body.center_of_mass[0]": "±0.001",
        "start.angular_velocity": "±0.1",
        "load[0].acceleration[2]": "-9.9..-9.7",
        "load[1].coefficient": "0..0.002",
    }
    spread = ensemble(Scene.from_dict(TOP), vary, 10, samples=5, quantities=["angular_velocity[1]", "energy"])
    for k, values in enumerate(spread.values.tolist()):
        mass, moment, x, *spin, pull, coefficient = values
        body = {"principal_moments": [0.02, moment, 0.0075], "mass": mass, "center_of_mass": [x, 0.0, 0.01]}
        loads = [{"kind": "gravity", "acceleration": [0, 0, pull]}, {"kind": "damping", "coefficient": coefficient}]
        own = TOP | {"body": body, "load": loads, "run": TOP["run"] | {"samples": 5}}
        run = simulate(Scene.from_dict(own | {"start": {"angular_velocity": spin, "frame": "part"}}))
        assert spread.quantities["angular_velocity[1]"][k] == pytest.approx(run.angular_velocity[:, 1], abs=1e-9)
        assert spread.quantities["energy"][k] == pytest.approx(run.energy, rel=1e-9)


def test_shares_of_variance_are_those_of_the_law_of_propagation() -> None:
    # E = I ω²/2: dE/E = dI/I + 2 dω/ω
    laws = {"start.angular_velocity[2]": "3±0.001", "body.principal_moments[2]": "2±0.002"}
    scene = Scene.from_dict(BALL | {"body": {"principal_moments": [1.5, 1.8, 2.0]}})
    drivers = ensemble(scene, laws, 3000, samples=2, quantities=["energy"]).drivers("energy")
    assert drivers is not None
    variances = np.array([(2 * 0.001 / 3) ** 2, (0.002 / 2) ** 2])
    assert drivers.share == pytest.approx(variances / variances.sum(), abs=0.03)
    assert drivers.explained == pytest.approx(1.0, abs=1e-4)
    assert (drivers.rank > 0.3).all()


def test_a_draw_that_is_no_body_is_counted_and_says_why() -> None:
    scene = Scene.from_dict(BALL | {"body": {"principal_moments": [1.0, 2.0, 2.9]}})
    spread = ensemble(scene, {"body.principal_moments[2]": "2.9±0.2"}, 200, samples=3)
    impossible = spread.values[:, 0] > 3.0
    assert 20 < impossible.sum() < 180
    assert [state == "refused" for state in spread.states] == impossible.tolist()
    assert set(spread.sentences) == set(np.flatnonzero(impossible).tolist())
    assert "not physical" in next(iter(spread.sentences.values()))
    assert np.isnan(spread.quantities["deviation"][impossible]).all()
    assert np.isfinite(spread.percentiles("deviation")).all()


@pytest.mark.parametrize("table", [BALL, TOP], ids=["free", "held"])
def test_an_ensemble_in_which_nothing_can_be_followed_is_refused(table: dict[str, Any]) -> None:
    with pytest.raises(GeometryError, match=r"none of the 3 draws can be followed; draw 0: .*must be positive"):
        ensemble(Scene.from_dict(table), {"body.mass": [-1.0, -2.0, -3.0]})


@pytest.mark.parametrize(
    ("path_of", "values", "bad", "state"),
    [
        ("body.mass", [1.0, 0.0, -1.0, 1e70], [1, 2, 3], "refused"),
        ("body.principal_moments[0]", [0.02, 0.0, 0.026], [1, 2], "refused"),
        ("body.center_of_mass[0]", [0.05, 1e3], [1], "not followed"),
        ("load[1].coefficient", [0.001, 0.0, -0.1], [2], "refused"),
        ("load[0].acceleration[2]", [-9.8, 0.0, 1e70], [2], "refused"),
        ("start.angular_velocity[0]", [1.0, 1e70], [1], "refused"),
        ("constraint.point[2]", [0.0, 50.0], [1], "not followed"),
    ],
)
def test_draws_that_make_no_sense_leave_the_others_alone(
    path_of: str, values: list[float], bad: list[int], state: str
) -> None:
    table = TOP | {"constraint": {"kind": "fixed_point", "point": [0.0, 0.0, 0.0]}}
    spread = ensemble(Scene.from_dict(table), {path_of: values}, samples=3)
    assert sorted(spread.sentences) == bad
    assert [spread.states[k] for k in bad] == [state] * len(bad)
    alone = ensemble(Scene.from_dict(table), {path_of: values[:1]}, samples=3)
    assert alone.quantities["tilt"][0] == pytest.approx(spread.quantities["tilt"][0], rel=1e-12)


def test_events_of_the_model_are_counted() -> None:
    handle = {"body": {"principal_moments": [1, 2, 3]}, "start": {"angular_velocity": [0.01, 10, 0]}}
    scene = Scene.from_dict(handle | {"run": {"duration": 3.0}})
    spread = ensemble(scene, {"start.angular_velocity[0]": [1e-9, 1e-3, 0.1]}, samples=2)
    first = spread.events["flip"]
    assert np.isnan(first[0])  # it takes some ln(1e10)/5.8 s
    assert first[2] < first[1] < 3.0


@pytest.mark.parametrize(
    ("field", "law", "words"),
    [
        ("start.spin", "1±0.1", "start.spin is unknown"),
        ("start.angular_velocity", "1±0.1", r"name one of them, as start\.angular_velocity\[0\]"),
        ("start.angular_velocity[3]", "1±0.1", "is not there"),
        ("start.frame", "1±0.1", "is no number"),
        ("start.position[0]", "1±0.1", "is not stated in the scene"),
        ("body.density", "1±0.1", "body.density is unknown"),
        ("load[0].coefficient", "1±0.1", "fewer of them"),
        ("run.duration", "1..2", "the same for all draws"),
        ("spin", "1..2", "is no field of a scene"),
        ("wheel.mass", "1..2", "is not in the scene"),
        ("body.mass", "1±", "is no law"),
        ("body.mass", "3..2", "give the smaller one first"),
        ("body.mass", "1..2..3", "give two"),
        ("body.mass", "1±0", "not at all"),
        ("body.mass", "nan", "not a row of finite numbers"),
        ("start.angular_velocity[0]", "±1%", "is 0 in the scene"),
    ],
)
def test_what_cannot_vary_is_named(field: str, law: str, words: str) -> None:
    with pytest.raises(FieldError, match=words):
        ensemble(Scene.from_dict(BALL), {field: law}, 3)


def test_arguments_that_make_no_sense_are_refused() -> None:
    scene, spin = Scene.from_dict(BALL), {"start.angular_velocity[2]": "±1%"}
    with pytest.raises(UsageError, match="nothing varies"):
        ensemble(scene, {})
    with pytest.raises(UsageError, match="nothing is left to draw"):
        ensemble(scene, {"body.mass": [1.0, 2.0]}, 5)
    with pytest.raises(UsageError, match="draws is 0"):
        ensemble(scene, spin, 0)
    with pytest.raises(UsageError, match="no quantity 'nutation'"):
        ensemble(scene, spin, 5, quantities=["nutation"])
    with pytest.raises(UsageError, match="processes is 0"):
        ensemble(scene, spin, 5, jobs=0)
    with pytest.raises(FieldError, match="varies twice"):
        ensemble(scene, {"start.angular_velocity[2]": "±1", "start.angular_velocity": "±1"}, 5)


def test_the_tilt_of_a_held_body_is_that_of_its_arm_from_the_vertical() -> None:
    spread = ensemble(Scene.from_dict(TOP), {"start.angular_velocity[0]": "±0.1"}, 3, samples=4)
    nominal = spread.nominal
    arm = np.array([0.05, 0.0, 0.01])
    x, y, z, w = nominal.attitude.T
    height = 0.05 * 2.0 * (x * z - y * w) + 0.01 * (1.0 - 2.0 * (x * x + y * y))
    assert spread.nominal_quantity("tilt") == pytest.approx(np.arccos(height / np.linalg.norm(arm)), abs=1e-12)


def test_the_accuracy_holds_for_every_draw() -> None:
    held = {"body": {"principal_moments": [1.0, 1.5, 2.0], "mass": 1.0, "center_of_mass": [0.0, 0.0, 0.0]}}
    start = {"angular_velocity": [0.3, 2.0, 0.1], "attitude": [0.6, 0.0, 0.0, 0.8]}
    loads = [{"kind": "torque", "torque": [0.2, 0.0, -0.1], "frame": "space"}, {"kind": "damping", "coefficient": 0.1}]
    run = {"duration": 6.0, "accuracy": 1e-11}
    scene = Scene.from_dict(held | {"start": start, "load": loads, "run": run})
    vary = {"start.angular_velocity": "±0.2", "body.principal_moments[1]": "1.2..1.8", "load[0].torque[0]": "±0.1"}
    names = [f"attitude[{k}]" for k in range(4)]
    spread = ensemble(scene, vary, 40, samples=4, quantities=names)
    assert set(spread.models) == {"Euler equations"}
    assert (spread.reached <= 1e-11).all()
    for k in (0, 1, 2, 3):
        p, q, r, moment, torque = spread.values[k].tolist()
        truth = rotate(
            [1.0, moment, 2.0],
            [p, q, r],
            spread.time.tolist(),
            attitude=[0.6, 0.0, 0.0, 0.8],
            space_torque=[torque, 0.0, -0.1],
            damping=0.1,
        )
        attitude = np.array([spread.quantities[name][k] for name in names]).T
        assert truth.attitude_error(attitude).max() <= spread.reached[k]


def test_draws_of_a_part_are_those_of_the_part_with_another_mass() -> None:
    scene = Scene.load(path("scenes/t_handle.toml"))
    scene = replace(scene, run=replace(scene.run, duration=4.0, samples=5))
    vary = {"body.mass": "±1%", "start.angular_velocity": "±0.01"}
    spread = ensemble(scene, vary, 6, samples=5, quantities=["energy", "angular_velocity[1]", "attitude[2]"])
    assert scene.body.properties is not None
    for k, (mass, *spin) in enumerate(spread.values.tolist()):
        body = SceneBody.of(scene.body.properties.with_mass(mass))
        run = simulate(replace(scene, body=body, start=replace(scene.start, angular_velocity=spin)))
        assert spread.quantities["energy"][k] == pytest.approx(run.energy, rel=1e-13)
        assert spread.quantities["angular_velocity[1]"][k] == pytest.approx(run.angular_velocity[:, 1], abs=1e-9)
        assert spread.quantities["attitude[2]"][k] == pytest.approx(run.attitude[:, 2], abs=spread.reached[k])
        assert spread.events["flip"][k] == pytest.approx(run.events[0].time, rel=1e-12)


@pytest.mark.parametrize("name", ["heavy_top", "pendulum", "rolling_disc", "manoeuvre", "cat"])
def test_scenes_of_every_kind_have_a_spread(name: str) -> None:
    path_of, law = {
        "heavy_top": ("start.angular_velocity[2]", "±1%"),
        "pendulum": ("load[0].acceleration[2]", "±1%"),
        "rolling_disc": ("constraint.radius", "±1%"),
        "manoeuvre": ("body.mass", "±1%"),
        "cat": ("part[1].joint[0].angles[1]", "±0.01"),
    }[name]
    scene = Scene.load(path(f"scenes/{name}.toml"))
    spread = ensemble(replace(scene, run=replace(scene.run, duration=0.3)), {path_of: law}, 4, samples=3, jobs=1)
    assert spread.followed.all()
    assert np.isfinite(spread.percentiles("deviation")).all()
    assert set(spread.models) == {{"heavy_top": "Euler equations"}.get(name, spread.nominal.model)}


ATTITUDE = tuple(f"attitude[{k}]" for k in range(4))


def attitudes_of(spread: Ensemble) -> Float:
    return np.stack([spread.quantities[name] for name in ATTITUDE], axis=-1)


def test_draws_of_a_heavy_top_are_followed_together_and_each_is_its_own_motion() -> None:
    scene = Scene.load(path("scenes/heavy_top.toml"))
    scene = replace(scene, run=replace(scene.run, duration=0.6, accuracy=1e-9))
    vary = {"start.angular_velocity[2]": "±5%", "body.mass": "±5%", "body.center_of_mass[2]": "±5%"}
    spread = ensemble(scene, vary, 12, samples=4, quantities=ATTITUDE)
    assert spread.model_counts == {"Euler equations": 12}
    attitudes, start = attitudes_of(spread), scene.start.attitude.tolist()
    for k, (spin, mass, height) in enumerate(spread.values[:4].tolist()):
        moments = [2e-4 + mass * height**2, 2e-4 + mass * height**2, 1.25e-4]
        weight = {"mass": mass, "offset": [0, 0, height], "gravity": [0, 0, -9.80665]}
        truth = rotate(moments, [0.0, 0.0, spin], spread.time.tolist(), attitude=start, **weight)
        assert truth.attitude_error(attitudes[k]).max() <= spread.reached[k] <= 1e-9


def test_draws_of_a_pendulum_are_followed_together_and_each_is_its_own_motion() -> None:
    scene = Scene.load(path("scenes/pendulum.toml"))
    scene = replace(scene, run=replace(scene.run, duration=2.0, accuracy=1e-9))
    vary = {"body.mass": "±5%", "load[1].coefficient": "±5%", "start.angular_velocity[0]": "±0.1"}
    spread = ensemble(scene, vary, 12, samples=4, quantities=ATTITUDE)
    assert spread.model_counts == {"hinged body": 12}
    begun = 2.0 * math.asin(float(scene.start.attitude[0]))  # from upright, about the axle x
    for k, (mass, damping, spin) in enumerate(spread.values.tolist()):
        inertia, pull = 0.0834 + mass * 0.25, mass * 9.80665 * 0.5

        def rate(
            _: float, y: Float, inertia: float = inertia, pull: float = pull, loss: float = damping
        ) -> list[float]:
            return [y[1], (pull * math.sin(y[0]) - loss * y[1]) / inertia]

        angle = solve_ivp(rate, (0.0, 2.0), [begun, spin], "DOP853", spread.time, rtol=1e-13, atol=1e-15).y[0]
        expected = np.stack([np.sin(angle / 2), 0 * angle, 0 * angle, np.cos(angle / 2)], axis=-1)
        off = quaternion.angle_between(attitudes_of(spread)[k], expected).max()
        assert off <= spread.reached[k] <= 1e-9


def test_draws_under_a_table_of_torques_are_followed_together_and_each_is_its_own_motion() -> None:
    table = np.array([[0, 0.1, 0, 0.2], [1, 0.3, 0.1, 0.2], [1, -0.1, 0, 0], [2.2, 0, 0.2, 0], [5, 0, 0, 0.3]])
    body = {"principal_moments": [1.0, 1.5, 2.0], "mass": 1.0}
    scene = Scene.from_dict(
        {
            "body": body,
            "start": {"angular_velocity": [0.0, 0.0, 0.0]},
            "load": [{"kind": "torque", "table": table}, {"kind": "damping", "coefficient": 0.1}],
            "run": {"duration": 3.0, "accuracy": 1e-9},
        }
    )
    vary = {"body.principal_moments[1]": "1.2..1.8", "load[1].coefficient": "±10%"}
    spread = ensemble(scene, vary, 12, samples=4, quantities=ATTITUDE)
    assert spread.model_counts == {"Euler equations": 12}
    for k, (middle, damping) in enumerate(spread.values.tolist()):
        moments = np.array([1.0, middle, 2.0])

        def rate(t: float, y: Float, moments: Float = moments, loss: float = damping, row: int = 0) -> Float:
            (t0, *n0), (t1, *n1) = table[row], table[row + 1]
            torque = np.array(n0) + (np.array(n1) - np.array(n0)) * (t - t0) / (t1 - t0)
            q, w = y[:4], y[4:]
            turn = 0.5 * quaternion.multiply(q, [*w, 0.0])
            return np.concatenate([turn, (torque - loss * w - np.cross(w, moments * w)) / moments])

        state, expected = np.array([0.0, 0, 0, 1, 0, 0, 0]), []
        for row, begin, end in ((0, 0.0, 1.0), (2, 1.0, 2.2), (3, 2.2, 3.0)):
            piece = partial(rate, row=row)
            at = [*(t for t in spread.time if begin < t < end), end]
            states = solve_ivp(piece, (begin, end), state, "DOP853", at, rtol=1e-13, atol=1e-15).y.T
            expected += [one[:4] for t, one in zip(at, states, strict=True) if t in spread.time]
            state = states[-1]
        off = quaternion.angle_between(attitudes_of(spread)[k, 1:], np.array(expected)).max()
        assert off <= spread.reached[k] <= 1e-9


def test_a_dask_cluster_gives_the_same_draws() -> None:
    distributed = pytest.importorskip("distributed")
    scene, vary = Scene.from_dict(TOP), {"body.mass": "±1%"}
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, silence_logs=50
    ) as cluster:
        shares: list[float] = []
        there = ensemble(scene, vary, 20, samples=3, dask=cluster.scheduler_address, progress=shares.append)
    here = ensemble(scene, vary, 20, samples=3, jobs=1)
    assert shares == [1.0]
    for name, rows in here.quantities.items():
        assert rows.tolist() == there.quantities[name].tolist()


def test_a_scheduler_is_given_as_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    scene, vary = Scene.from_dict(TOP), {"body.mass": "±1%"}
    local = ensemble(scene, vary, 20, samples=3, dask="local", jobs=2)
    here = ensemble(scene, vary, 20, samples=3, jobs=1)
    assert all(rows.tolist() == local.quantities[name].tolist() for name, rows in here.quantities.items())
    monkeypatch.setattr(distributed.Client, "start", lambda *_, **__: pytest.fail("a scheduler is looked for"))
    with pytest.raises(UsageError, match=r"^foo:bar is no address of a Dask scheduler .*: give one as tcp://"):
        ensemble(scene, vary, 20, samples=3, dask="foo:bar")
    with pytest.raises(UsageError, match=r"says nothing of the workers of the scheduler tcp://h:1: leave it out"):
        ensemble(scene, vary, 20, samples=3, dask="tcp://h:1", jobs=2)


def test_a_worker_that_is_ended_is_an_error_that_says_so() -> None:
    scene = Scene.from_dict(TOP | {"load": [], "constraint": {"kind": "free"}, "run": {"duration": 0.01}})
    ends = Torque(
        lambda time, attitude, omega: os._exit(9) if multiprocessing.parent_process() else np.zeros(3),
        longest_step=0.01,
    )
    with pytest.raises(GeometryError, match="a process that followed draws was ended"):
        ensemble(replace(scene, applied_loads=(ends,)), {"body.mass": "±1%"}, 60, samples=2, jobs=2)


def test_a_level_is_reached_when_the_closed_form_says() -> None:
    scene = Scene.from_dict(BALL | {"run": {"duration": 1.0}})
    spins = [1.0, 3.5, 4.0, 6.0]  # about z, from 3: they deviate by |spin − 3| t
    vary = {"start.angular_velocity[2]": spins}
    spread = ensemble(scene, vary, samples=11, quantities=["spin"], reaches={"deviation": 0.75, "spin": 4.0})
    first = spread.events["deviation reaches 0.75"]
    assert first[[0, 2, 3]] == pytest.approx([0.375, 0.75, 0.25], rel=1e-12)
    assert np.isnan(first[1])
    assert spread.events["spin reaches 4"][2] == 0.0
    assert np.isnan(spread.events["spin reaches 4"][[0, 1, 3]]).all()
    assert spread.columns()["first deviation reaches 0.75"].tolist()[0] == first[0]
    with pytest.raises(UsageError, match="level of spin is nan"):
        ensemble(scene, vary, reaches={"spin": math.nan})


def test_percentiles_without_the_series_are_those_with_them_to_half_a_bin(tmp_path: Path) -> None:
    scene = Scene.from_dict(
        {
            "body": {"principal_moments": [1, 2, 3]},
            "start": {"angular_velocity": [0.1, 5, 0.2]},
            "run": {"duration": 10},
        }
    )
    vary = {"start.angular_velocity[2]": "±1%", "body.principal_moments[1]": "2.1±0.05"}
    whole = ensemble(scene, vary, 800, samples=5, jobs=1)
    few, shared = (ensemble(scene, vary, 800, samples=5, jobs=jobs, memory=0, reaches={"tilt": 1.0}) for jobs in (1, 2))
    assert not few.quantities
    assert few.state_counts == whole.state_counts
    assert few.sentences == whole.sentences
    for name in ("deviation", "tilt", "spin"):
        off = np.abs(few.percentiles(name) - whole.percentiles(name))
        assert (off <= 0.5 * few.resolution(name)).all()
        assert (few.resolution(name) <= np.ptp(whole.quantities[name][whole.followed], axis=0) / 2047 + 1e-14).all()
        assert few.percentiles(name).tolist() == shared.percentiles(name).tolist()
        assert few.largest(name).tolist() == whole.largest(name).tolist()
        assert not whole.resolution(name).any()
        of_few, of_whole = few.drivers(name), whole.drivers(name)
        assert of_few is not None
        assert of_whole is not None
        assert of_few.share.tolist() == of_whole.share.tolist()
    for file in (tmp_path / "few.csv", tmp_path / "whole.csv"):
        write_table({"few": few, "whole": whole}[file.stem], file)
    heads, *rows = (tmp_path / "few.csv").read_text().splitlines()
    assert "first tilt reaches 1" in heads
    assert len(rows) == 800


@pytest.mark.parametrize("spread", [1.0, 1e-9, 0.0, 1e12])
def test_a_histogram_depends_on_its_values_alone(spread: float) -> None:
    values = 3.0 + spread * np.random.default_rng(5).standard_normal(5000)
    orders = [np.array_split(values, 1), np.array_split(values, 40)[::-1], np.array_split(np.sort(values), 7)]
    histograms = [Histogram() for _ in orders]
    for histogram, blocks in zip(histograms, orders, strict=True):
        for block in blocks:
            histogram.add(block)
    at = [0.0, 0.1, 5.0, 50.0, 99.99, 100.0]
    results = [histogram.percentiles(at).tolist() for histogram in histograms]
    assert results[0] == results[1] == results[2]
    assert np.abs(results[0] - np.percentile(values, at)).max() <= 0.5 * histograms[0].width
    assert histograms[0].width <= max(np.ptp(values) / 2047, 2.0**-48 * np.abs(values).max())


UNCERTAIN: dict[str, Any] = {
    "body": {"part": str(path("box.stl")), "unit": "mm", "density": "7850±50", "sigma": 0.05},
    "start": {"angular_velocity": [0.0, 0.0, 10.0], "frame": "part"},
    "run": {"duration": 2.0},
}


def test_draws_of_a_scale_are_those_of_the_part_in_another_unit() -> None:
    scene = Scene.from_dict(UNCERTAIN | {"body": {"part": str(path("box.stl")), "unit": "mm", "density": 7850}})
    larger = Scene.from_dict(UNCERTAIN | {"body": {"part": str(path("box.stl")), "unit": "cm", "density": 7850}})
    names = ["energy", "angular_velocity[1]", "angular_momentum[2]"]
    for vary in ({"body.scale": [1.0, 10.0]}, {"body.scale": [10.0], "body.density": [7850.0]}):
        spread = ensemble(scene, vary, samples=5, quantities=names)
        run = simulate(replace(larger, run=replace(larger.run, samples=5)))
        assert spread.followed.all()
        assert spread.quantities["energy"][-1] == pytest.approx(run.energy, rel=1e-13)
        assert spread.quantities["angular_momentum[2]"][-1] == pytest.approx(run.angular_momentum[:, 2], rel=1e-13)
        one = simulate(changed(scene, {"body.scale": 10.0}))
        assert one.energy[0] == pytest.approx(run.energy[0], rel=1e-13)
        assert one.scene.body.mass == pytest.approx(run.scene.body.mass, rel=1e-14)
        assert one.scene.body.center_of_mass == pytest.approx(run.scene.body.center_of_mass, rel=1e-14)
    twice = ensemble(
        scene, {"body.scale": "2±0.001", "start.angular_velocity[2]": "±1%"}, 5, samples=2, quantities=names
    )
    expected = 2.0**5 * simulate(scene).energy[0]
    assert twice.nominal.energy[0] == pytest.approx(expected, rel=1e-12)
    scaled = expected * (twice.values[:, 0] / 2.0) ** 5 * (twice.values[:, 1] / 10.0) ** 2
    assert twice.ends["energy"] == pytest.approx(scaled, rel=1e-12)
    with pytest.raises(FieldError, match=r"body\.scale is unknown"):
        ensemble(Scene.from_dict(BALL), {"body.scale": "1±0.1"}, 3)


def test_what_is_stated_as_uncertain_of_a_part_is_drawn_with_its_covariance() -> None:
    scene = Scene.from_dict(UNCERTAIN)
    spread = ensemble(scene, {"body.uncertainty": "±1"}, 250, samples=2, quantities=["angular_momentum[2]"])
    u = analyse(read(path("box.stl"), "mm"), Estimate(7850.0, 50.0), sigma=0.05).uncertainty
    assert u is not None
    assert spread.ends["angular_momentum[2]"].std() == pytest.approx(10.0 * u.inertia[2, 2], rel=0.15)
    # the same start along the part axes: the root mean square of the deviation is that of the law of propagation
    start = replace(scene.start, angular_velocity=np.array([1.0, 3.0, 8.0]))
    turned = ensemble(replace(scene, start=start), {"body.uncertainty": "±1"}, 250, samples=2).turned
    claim = attitude_uncertainty(simulate(replace(scene, start=start)))
    assert math.sqrt((turned**2).sum(axis=1).mean()) == pytest.approx(claim, rel=0.15)
    assert attitude_uncertainty(simulate(Scene.from_dict(BALL))) is None
    parts = deviations(scene.body)
    assert parts @ parts.T == pytest.approx(
        u.covariance[1:, 1:], rel=1e-9, abs=1e-9 * np.abs(u.covariance[5:, 5:]).max()
    )
    with pytest.raises(FieldError, match=r"body\.uncertainty is unknown"):
        ensemble(Scene.from_dict(BALL), {"body.uncertainty": "±1"}, 3)


def test_figures_of_the_whole_run_are_quantities_each_of_their_components() -> None:
    """Two of them, at two instants: not one at each."""
    body = {"principal_moments": [0.0834, 0.0834, 0.0002], "mass": 1.0, "center_of_mass": [0.0, 0.0, -0.5]}
    table = {
        "body": body,
        "start": {"angular_velocity": [1.0, 0, 0], "frame": "part"},
        "constraint": {"kind": "hinge", "axis": [1, 0, 0]},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 1.0},
    }
    names = ["period", "turning angle[0]", "turning angle[1]"]
    scene = Scene.from_dict(table)
    for samples in (2, 3):
        spread = ensemble(scene, {"start.angular_velocity[0]": [1.0, 2.0, 20.0]}, samples=samples, quantities=names)
        low, high = (spread.quantities[f"turning angle[{k}]"] for k in (0, 1))
        assert np.array_equal(low, -high, equal_nan=True)
        assert (high[0] == simulate(scene).quantities["turning angle"][1]).all()
        assert np.isnan(high[2]).all()  # it goes over the top
        assert (np.diff(spread.quantities["period"], axis=1) == 0).all()


@pytest.mark.parametrize(
    ("field", "instead"),
    [
        ("body.shell", "vary body.density, as mass and tensor are in proportion to either"),
        ("body.sigma", "vary body.uncertainty"),
        ("part[0].shell", "vary its mass, center_of_mass, inertia or principal_moments"),
        ("part[0].density", "vary its mass"),
    ],
)
def test_what_goes_with_a_mesh_and_does_not_vary_is_told_from_what_is_unknown(field: str, instead: str) -> None:
    part = {"part": str(path("box.stl")), "unit": "mm", "density": 7850.0, "shell": 1.5}
    still = {"axis": [0, 0, 1], "times": [0.0, 1.0], "angles": [0.0, 0.5]}
    parts = [part | {"name": "base"}, part | {"name": "lid", "parent": "base", "joint": [still]}]
    scene = Scene.from_dict(
        {**BALL, "body": part} if field.startswith("body") else {**BALL, "body": None, "part": parts}
    )
    with pytest.raises(FieldError) as caught:
        ensemble(scene, {field: "1.5±0.1"}, 3)
    assert f"{field} does not vary, as a part is integrated once: {instead}" in str(caught.value)


def test_the_gravity_gradient_pulls_at_the_moments_of_each_draw() -> None:
    primary, spin, drawn = [0.3, 0.7, 0.6], [0.1, 0.5, 0.2], [2.0, 2.2, 2.5]
    scene = Scene.from_dict(
        {
            "body": {"principal_moments": [1.0, 2.0, 2.8]},
            "start": {"angular_velocity": spin},
            "load": [{"kind": "gravity_gradient", "mu": 0.3, "position": primary}],
            "run": {"duration": 10.0, "accuracy": 1e-9},
        }
    )
    names = [f"angular_velocity[{k}]" for k in range(3)]
    spread = ensemble(scene, {"body.principal_moments[1]": drawn}, quantities=names)
    for k, moment in enumerate(drawn):
        true = rotate([1.0, moment, 2.8], spin, [0.0, 10.0], gravity_gradient=(0.3, primary))
        end = [float(spread.quantities[name][k, -1]) for name in names]
        assert end == pytest.approx([float(x) for x in true.angular_velocity[-1]], abs=1e-8)


def test_how_dense_a_part_is_changes_nothing_of_what_the_gravity_gradient_does() -> None:
    scene = Scene.from_dict(
        {
            "body": {"part": str(path("t_handle.stl")), "unit": "mm", "density": 1000.0},
            "start": {"angular_velocity": [0.1, 0.5, 0.2]},
            "load": [{"kind": "gravity_gradient", "mu": 0.3, "position": [0.3, 0.7, 0.6]}],
            "run": {"duration": 10.0, "accuracy": 1e-9},
        }
    )
    spread = ensemble(scene, {"body.density": [1000.0, 2000.0, 500.0]}, quantities=["deviation"])
    assert spread.quantities["deviation"][:, -1].max() < 1e-8
