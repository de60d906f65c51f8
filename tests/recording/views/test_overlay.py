"""Two runs over each other."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.recording.reading import Recorded, verified

from inertia import Rotor, Run, Scene, balance, record, simulate
from inertia.dynamics.kinematics import quaternion
from inertia.errors import UsageError
from inertia.recording.playback import NEAR
from inertia.recording.provenance import properties, scene_of
from inertia_meshes import path


def spun(rate: float, duration: float, samples: int, moment: float = 2.0) -> Run:
    """Return a ball that spins evenly about z: its attitude is turned by rate times t."""
    scene = {
        "body": {"principal_moments": [moment] * 3, "mass": 1.0},
        "start": {"angular_velocity": [0.0, 0.0, rate]},
        "run": {"duration": duration, "samples": samples},
    }
    return simulate(Scene.from_dict(scene))


@pytest.mark.parametrize(
    ("duration", "samples"),
    [(2.0, 201), (3.0, 301), (3.0, 77), (1.0, 33), (0.7, 15), (1.4, 11)],  # the last two within roundings of the first
)
def test_the_angle_between_attitudes_is_that_of_the_spins(duration: float, samples: int, tmp_path: Path) -> None:
    file = tmp_path / "both.rrd"
    record(spun(1.0, 2.0, 201), file, other=spun(1.5, duration, samples, 2e-8))
    assert verified(file, tmp_path)
    recorded = Recorded(file)
    entity = "/plots/angle_between_runs"
    time, angle = recorded.time(entity), recorded.values(entity, "Scalars:scalars").ravel()
    assert time[-1] == pytest.approx(min(2.0, duration))
    assert angle == pytest.approx(0.5 * time, abs=1e-9)  # an instant is rounded to nanoseconds
    ends = {name: recorded.time(f"/world/{name}/body")[-1] for name in ("first", "other")}
    assert ends == {"first": pytest.approx(2.0), "other": pytest.approx(duration)}
    (text,) = recorded.texts("/text/summary", "TextDocument:text")
    assert f"Apart** by {0.5 * min(2.0, duration):.3g} rad at most" in text
    assert ("body stays as it is then" in text) == (duration != 2.0)


def test_both_bodies_turn_as_their_runs_do(tmp_path: Path) -> None:
    file = tmp_path / "both.rrd"
    record(spun(1.0, 2.0, 201), file, other=spun(-0.5, 2.0, 201))
    recorded = Recorded(file)
    for name, rate in (("first", 1.0), ("other", -0.5)):
        time = recorded.time(f"/world/{name}/body")
        rotation = recorded.values(f"/world/{name}/body", "Transform3D:quaternion").reshape(-1, 4)
        half = 0.5 * rate * time
        turned = np.stack([np.sin(half), np.cos(half)], axis=1)
        assert np.abs(np.abs((rotation[:, 2:] * turned).sum(axis=1)) - 1.0).max() < 1e-6


def test_poses_are_the_model_s_at_the_nanoseconds_that_they_are_filed_under(tmp_path: Path) -> None:
    """A third of a millisecond and 0.2 ms end between nanoseconds, or on one."""
    file = tmp_path / "both.rrd"
    record(spun(1e4, 1e-3 / 3.0, 4), file, other=spun(-3e4, 2e-4, 3))
    recorded = Recorded(file)
    (second,) = recorded.values("/__properties/timeline", "second_s").ravel()
    for name, rate in (("first", 1e4), ("other", -3e4)):
        half = 0.5 * rate * second * recorded.time(f"/world/{name}/body")
        drawn = recorded.values(f"/world/{name}/body", "Transform3D:quaternion").reshape(-1, 4).astype(float)
        zero = np.zeros_like(half)
        exact = np.stack([zero, zero, np.sin(half), np.cos(half)], axis=1)
        assert quaternion.angle_between(drawn, exact).max() < 1.2e-7


def test_samples_farther_apart_than_the_motion_are_points(tmp_path: Path) -> None:
    record(spun(1.0, 2.0, 201), tmp_path / "both.rrd", other=spun(80.0, 2.0, 201))
    recorded = Recorded(tmp_path / "both.rrd")
    points = {path for path, columns in recorded.columns.items() if "SeriesPoints:markers" in columns}
    assert points == {"/plots/angle_between_runs", *(f"/plots/angular_velocity/{axis}/other" for axis in "xyz")}
    (text,) = recorded.texts("/text/summary", "TextDocument:text")
    first, other, *_ = text.split("\n\n")
    assert "samples" not in first
    assert "Samples are 0.01 s apart, in which the body may turn by 0.8 rad" in other


def test_poses_are_near_where_the_bodies_turn_faster_than_at_their_samples(tmp_path: Path) -> None:
    """A top that falls is fast at its lowest, and slow at its samples: both run for whole numbers of nutations."""
    table: dict[str, Any] = {
        "body": {"principal_moments": [1.0, 1.0, 0.5], "mass": 1.0, "center_of_mass": [0.0, 0.0, 1.0]},
        "start": {"angular_velocity": [0.0, 0.0, 20.0], "attitude": [0.2, 0.0, 0.0, np.sqrt(1.0 - 0.04)]},
        "constraint": {"kind": "fixed_point"},
        "load": [{"kind": "gravity", "acceleration": [0.0, 0.0, -400.0]}],
    }
    period = float(simulate(Scene.from_dict(table | {"run": {"duration": 1.0}})).quantities["nutation period"])
    runs = [
        simulate(Scene.from_dict(table | {"run": {"duration": count * period, "samples": count + 1}}))
        for count in (3, 5)
    ]
    file = tmp_path / "both.rrd"
    record(runs[0], file, other=runs[1])
    recorded = Recorded(file)
    for name in ("first", "other"):
        rotation = recorded.values(f"/world/{name}/body", "Transform3D:quaternion").reshape(-1, 4).astype(float)
        assert quaternion.angle_between(rotation[:-1], rotation[1:]).max() <= 1.01 * NEAR + 1e-5


def test_the_first_is_run_again_and_both_are_named(tmp_path: Path) -> None:
    file = tmp_path / "both.rrd"
    first, other = (simulate(Scene.load(path(f"scenes/{name}.toml"))) for name in ("thrown_box", "heavy_top"))
    record(first, file, other=other)
    sections = properties(file)
    assert sections["other_scene"]["name"] == "heavy_top.toml"
    assert scene_of(file).run.duration == first.scene.run.duration


def test_what_cannot_be_shown_over_each_other_is_refused(tmp_path: Path) -> None:
    ball, cat = spun(1.0, 2.0, 11), simulate(Scene.load(path("scenes/cat.toml")))
    with pytest.raises(UsageError, match="its body changes its shape"):
        record(ball, tmp_path / "both.rrd", other=cat)
    with pytest.raises(UsageError, match="a rotor is not recorded with a run over it"):
        record(balance(Rotor.load(path("rotors/disc.toml"))), tmp_path / "both.rrd", other=ball)
    assert list(tmp_path.iterdir()) == []
