"""Samples that are handed on while a run is computed."""

from dataclasses import replace

import numpy as np
import pytest

from inertia import Scene, simulate
from inertia.arrays import Float
from inertia.dynamics import observer
from inertia.dynamics.kinematics import quaternion
from inertia_meshes import path

Block = tuple[Float, Float, Float]


def scene(name: str, **settings: object) -> Scene:
    whole = Scene.load(path(f"scenes/{name}.toml"))
    return replace(whole, run=replace(whole.run, **settings))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("t_handle", {"samples": 500, "duration": 5.0}),
        ("t_handle", {"samples": 5000, "duration": 5.0, "accuracy": 1e-6, "method": "Taylor"}),
        ("t_handle", {"samples": 500, "duration": 2.0, "accuracy": 1e-6, "method": "RK4"}),
        ("t_handle", {"samples": 5000, "duration": 5.0, "accuracy": 1e-6, "method": "DOP853"}),
        ("boom_satellite", {"samples": 500, "duration": 2000.0}),
        ("rolling_disc", {"samples": 100}),
        ("heavy_top", {"samples": 100}),
        ("diver", {"samples": 5000}),
    ],
)
def test_all_samples_are_handed_on_in_order_and_change_nothing(
    name: str, settings: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(observer, "INTERVAL", 0.0)
    blocks: list[Block] = []
    asked = scene(name, **settings)
    run = simulate(asked, observer=lambda *block: blocks.append(block))
    alone = simulate(asked)
    assert np.array_equal(run.attitude, alone.attitude)
    assert np.array_equal(run.angular_velocity, alone.angular_velocity)
    assert run.steps == alone.steps
    time, attitude, spin = (np.concatenate(column) for column in zip(*blocks, strict=True))
    assert (np.diff(time) > 0).all()
    there = np.isin(time, run.time)
    assert set(run.time[1:]) <= set(time)
    rows = np.searchsorted(run.time, time[there])
    assert quaternion.angle_between(attitude[there], run.attitude[rows]).max() < 1e-4
    assert np.abs(spin[there] - run.angular_velocity[rows]).max() < 1e-3 * np.abs(run.angular_velocity).max()


def test_steps_are_handed_on_while_they_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(observer, "INTERVAL", 0.0)
    blocks: list[Block] = []
    simulate(
        scene("t_handle", samples=5000, duration=5.0, accuracy=1e-6, method="DOP853"),
        observer=lambda *block: blocks.append(block),
    )
    assert len(blocks) > 20


def test_a_fault_of_the_observer_ends_the_run() -> None:
    def refuse(time: Float, attitude: Float, angular_velocity: Float) -> None:
        raise KeyError("of the observer")

    with pytest.raises(KeyError, match="of the observer"):
        simulate(scene("boom_satellite", samples=50, duration=2000.0), observer=refuse)


def test_what_is_asked_of_a_run_later_is_not_handed_on() -> None:
    blocks: list[Block] = []
    run = simulate(scene("boom_satellite", samples=50, duration=2000.0), observer=lambda *block: blocks.append(block))
    count = len(blocks)
    run.at([17.0])
    assert len(blocks) == count
