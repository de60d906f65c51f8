"""Runs at other instants than their samples: what is there is what a run sampled there has."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.dynamics.oracle import rotate
from tests.dynamics.scenes import DISC, PLAIN, TOP, scene

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings
from inertia.dynamics.simulate import simulate
from inertia.errors import UsageError
from inertia_meshes import path

PENDULUM = Scene.load(path("scenes/pendulum.toml"))
CAT = Scene.load(path("scenes/cat.toml"))
ROD = {"body": {"principal_moments": [1.0, 1.0, 1.0], "mass": 1.0, "center_of_mass": [0.0, 0.0, 0.1]}}
HINGE: dict[str, Any] = (
    PLAIN | ROD | {"constraint": {"kind": "hinge", "axis": [1, 0, 0]}, "load": [{"kind": "gravity"}]}
)
HINGE |= {"start": {"angular_velocity": [2.0, 0.0, 0.0]}, "run": {"duration": 3.0, "samples": 7}}
DAMPED = [{"kind": "gravity"}, {"kind": "damping", "coefficient": 0.2}]

SCENES = {
    "free": scene(PLAIN, start__velocity=[1, 0, 2], load=[{"kind": "gravity"}]),
    "symmetric": scene(PLAIN, body__principal_moments=[1, 1, 2]),
    "steady": scene(PLAIN, start__angular_velocity=[0, 0, 2]),
    "heavy": scene(TOP),
    "rolling": scene(DISC),
    "rolling, stepped": scene(DISC, run__method="DOP853"),
    "stepped by Taylor": scene(PLAIN, load=[{"kind": "damping", "coefficient": 0.1}]),
    "stepped by DOP853": scene(PLAIN, run__method="DOP853"),
    "stepped by splitting": scene(PLAIN, run__method="splitting 8"),
    "hinged": scene(HINGE),
    "hinged and damped": scene(HINGE, load=DAMPED),
    "pendulum": PENDULUM,
    "deforming": CAT,
}


def resampled(subject: Scene, samples: int) -> Run:
    settings = {name: getattr(subject.run, name) for name in ("duration", "accuracy", "model", "method")}
    return simulate(
        Scene(
            subject.body,
            subject.start,
            Settings(samples=samples, **settings),
            subject.constraint,
            subject.applied_loads,
        )
    )


@pytest.mark.parametrize("name", SCENES)
def test_between_samples_a_run_is_as_one_sampled_there(name: str) -> None:
    run, finer = resampled(SCENES[name], 5), resampled(SCENES[name], 41)
    there = [33, 5, 20]
    at = run.at(finer.time[there])
    assert at.time.tolist() == finer.time[there].tolist()
    claim = at.error.reached + finer.error.reached
    assert quaternion.angle_between(at.attitude, finer.attitude[there]).max() <= claim
    rate = np.abs(finer.angular_velocity).max()
    np.testing.assert_allclose(at.angular_velocity, finer.angular_velocity[there], atol=2 * claim * rate)
    np.testing.assert_allclose(at.energy, finer.energy[there], rtol=1e-9, atol=1e-12)
    for series in ("angular_momentum", "position"):
        here, true = getattr(at, series), getattr(finer, series)
        if true is None:
            assert here is None
        else:
            np.testing.assert_allclose(here, true[there], rtol=1e-9, atol=1e-9 * (1e-9 + np.abs(true).max()))
    assert run.error.reached <= at.error.reached <= at.error.requested == run.error.requested
    assert set(at.series) == set(run.series)
    assert {len(values) for values in at.series.values()} <= {3}
    for key, invariant in at.invariants.items():
        assert np.array_equal(invariant.initial, run.invariants[key].initial)
        assert len(invariant.values) == 3
    if not run.steps:
        assert np.array_equal(np.abs(at.attitude), np.abs(finer.attitude[there]))


def test_between_samples_a_run_keeps_its_claim_against_thirty_digits() -> None:
    run = simulate(SCENES["free"])
    instants = np.array([7.3, 0.1, 2.0 / 3.0, 9.99])
    at = run.at(instants)
    truth = rotate((1, 2, 3), (0.3, 1.0, 2.0), sorted(instants.tolist()))
    assert truth.attitude_error(at.attitude[np.argsort(instants)]).max() <= at.error.reached <= 1e-13


def test_one_instant_and_those_at_both_ends_are_as_good_as_others() -> None:
    for run in (simulate(scene(TOP, run__samples=2)), simulate(SCENES["stepped by Taylor"])):
        last = run.at(run.scene.run.duration)
        assert np.array_equal(np.abs(last.attitude[0]), np.abs(run.attitude[-1]))
        assert np.array_equal(run.at([0.0]).attitude, run.attitude[:1])
        assert np.array_equal(run.at(0.5).at([0.25, 0.5]).attitude, run.at([0.25, 0.5]).attitude)
    top = simulate(scene(TOP, run__samples=2))
    assert "turning theta" not in top.series
    assert top.at([0.0, 1.0]).quantities["turning theta"].tolist() == top.quantities["turning theta"].tolist()


@pytest.mark.parametrize(
    ("instants", "says"),
    [
        ([0.0, 10.5], r"t = 10\.5 s is outside of the run, which goes from 0 to 10 s: ask for .*longer"),
        (-1e-300, "t = -1e-300 s is outside"),
        (np.nan, "t = nan s is outside"),
        ([[1.0]], r"the instants have shape \(1, 1\)"),
        ([], r"the instants have shape \(0,\)"),
    ],
)
def test_an_instant_outside_of_the_run_is_refused(instants: Any, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        simulate(scene(PLAIN)).at(instants)


@pytest.mark.parametrize("method", ["Taylor", "DOP853", "splitting 8", "RK4"])
def test_between_samples_a_stepped_run_takes_the_steps_of_one_span_and_keeps_its_claim(method: str) -> None:
    accuracy = 1e-7 if method == "RK4" else 1e-9
    torque = {"kind": "torque", "torque": [0.3, 0.0, -0.2], "frame": "part"}
    subject = scene(PLAIN, load=[torque], run__method=method, run__samples=201, run__accuracy=accuracy)
    run = simulate(subject)
    instants = np.array([7.3, 0.123, 9.99])
    at = run.at(instants)
    assert 0 < at.steps <= 0.15 * run.steps
    truth = rotate((1, 2, 3), (0.3, 1.0, 2.0), sorted(instants.tolist()), body_torque=(0.3, 0.0, -0.2))
    assert truth.attitude_error(at.attitude[np.argsort(instants)]).max() <= at.error.reached <= accuracy
    assert np.array_equal(run.at(0.123).attitude[0], at.attitude[1])


def test_a_pulse_between_samples_is_found_there() -> None:
    # about one axis: ω = 0.2 + 0.4 (t − 2.001) within 0.002 s, a pulse that ends before the next sample
    pulse = Torque(lambda time, attitude, omega: [0.0, 0.0, 40.0 * (2.001 <= time < 2.003)], breaks=[2.001, 2.003])
    subject = scene(PLAIN, body__principal_moments=[1, 1, 1], start__angular_velocity=[0, 0, 0.2], run__samples=101)
    run = simulate(replace(subject, applied_loads=(pulse,), run=replace(subject.run, accuracy=1e-9)))
    at = run.at([2.002, 2.05])
    angle = np.array([0.2 * 2.002 + 20.0 * 0.001**2, 0.2 * 2.05 + 20.0 * 0.002**2 + 0.08 * (2.05 - 2.003)])
    assert np.abs(2.0 * np.arcsin(at.attitude[:, 2]) - angle).max() <= at.error.reached
    assert at.steps < 0.5 * run.steps
