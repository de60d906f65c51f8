"""A run on the viewer while it is computed."""

from dataclasses import replace
from pathlib import Path
from subprocess import Popen

import numpy as np
import pytest
from tests.recording.reading import Recorded, verified
from tests.recording.test_live import killed_at, server  # noqa: F401  # a fixture

from inertia import Scene, simulate
from inertia.arrays import Float
from inertia.dynamics import observer
from inertia.recording import entities
from inertia.recording.preview import Preview
from inertia.recording.provenance import scene_of
from inertia.recording.writer import Recording
from inertia_meshes import path


def scene(name: str) -> Scene:
    whole = Scene.load(path(f"scenes/{name}.toml"))
    settings = {"t_handle": {"method": "DOP853", "accuracy": 1e-6, "duration": 5.0}}.get(name, {})
    return replace(whole, run=replace(whole.run, samples=300, **settings))  # type: ignore[arg-type]


@pytest.fixture(autouse=True)
def without_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(observer, "INTERVAL", 0.0)


@pytest.mark.usefixtures("server")
@pytest.mark.parametrize("name", ["t_handle", "diver", "boom_satellite", "rolling_disc"])
def test_every_sample_is_sent(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[Float] = []
    columns = Recording.columns

    def count(recording: Recording, entity: str, time: Float, *rest: object, **more: object) -> None:
        if entity == "world/center_of_mass/body":
            sent.append(time)
        columns(recording, entity, time, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(Recording, "columns", count)
    with Preview(scene(name)) as preview:
        run = simulate(scene(name), observer=preview.take)
    assert preview.lost is None
    assert preview.reached == run.time[-1]
    assert set(run.time[1:]) <= set(np.concatenate(sent))


@pytest.mark.parametrize("samples", [12, 300])
def test_samples_farther_apart_than_the_motion_are_points(samples: int, tmp_path: Path) -> None:
    whole = scene("t_handle")
    few = replace(whole, run=replace(whole.run, samples=samples))
    preview = Preview(few)
    simulate(few, observer=preview.take)
    assert preview.save(tmp_path / "part.rrd")
    columns = Recorded(tmp_path / "part.rrd").columns[f"/{entities.PLOT_ANGULAR_VELOCITY}"]
    assert ("SeriesPoints:markers" in columns) == ("SeriesLines:names" not in columns) == (samples == 12)


@pytest.mark.parametrize("block", [1, 20])
def test_the_run_goes_on_without_its_viewer(
    server: "Popen[str]",  # noqa: F811
    block: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    killed_at(block, server, monkeypatch)
    with Preview(scene("t_handle")) as preview:
        run = simulate(scene("t_handle"), observer=preview.take)
    assert preview.lost is not None
    assert np.array_equal(run.attitude, simulate(scene("t_handle")).attitude)


@pytest.mark.parametrize("name", ["t_handle", "diver"])
def test_what_was_computed_before_an_interruption_is_recorded(name: str, tmp_path: Path) -> None:
    preview, file = Preview(scene(name)), tmp_path / "run.rrd"
    assert not preview.save(file)
    assert list(tmp_path.iterdir()) == []
    run = simulate(scene(name))
    preview.take(run.time[:100], run.attitude[:100], run.angular_velocity[:100])
    assert preview.save(file)
    assert verified(file, tmp_path)
    recorded = Recorded(file)
    assert np.allclose(recorded.time("/plots/angular_velocity"), run.time[:100], atol=1e-9)
    (text,) = recorded.values("/text/summary", "TextDocument:text")[-1:]
    assert f"The run was interrupted. These are the poses of the first {run.time[99]:.4g} of" in str(text)
    assert scene_of(file).run.duration == run.scene.run.duration
