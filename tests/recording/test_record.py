"""The verb: what it refuses, and that it streams to an open viewer."""

import time
import typing
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from tests.recording.reading import Recorded, verified
from tests.recording.scenes import t_handle
from tests.recording.screenshot import has_driver, open_viewer

from inertia import Run, Scene, record, simulate
from inertia.errors import GeometryError, UsageError
from inertia.recording import live
from inertia.recording.provenance import properties
from inertia.recording.record import VIEWS
from inertia.recording.screen import Screen


@pytest.fixture(scope="module")
def handle() -> Run:
    return simulate(t_handle())


@pytest.mark.parametrize("name", [*VIEWS, "rotor"])
def test_every_view_is_a_module_that_returns_a_screen(name: str) -> None:
    view = import_module(f"inertia.recording.views.{name}")
    assert typing.get_type_hints(view.screen)["return"] is Screen


def test_a_run_with_a_hole_is_refused(handle: Run, tmp_path: Path) -> None:
    attitude = handle.attitude.copy()
    attitude[17, 2] = np.nan
    with pytest.raises(GeometryError, match=r"attitude is not finite at sample 17 of the run, t = 0.17 s"):
        record(replace(handle, attitude=attitude), tmp_path / "run.rrd")
    with pytest.raises(GeometryError, match="the run has 0 samples: a recording needs 2"):
        record(replace(handle, time=handle.time[:0]), tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("subject", [None, "run.rrd", 5], ids=str)
def test_what_nothing_returned_is_not_recorded(subject: object, handle: Run, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"^subject is a \w+: give what inertia.simulate, inertia.balance or"):
        record(subject, tmp_path / "run.rrd")
    if subject is not None:
        with pytest.raises(UsageError, match=r"^other is a \w+, not a Run: give what inertia.simulate"):
            record(handle, tmp_path / "run.rrd", other=subject)


def test_there_must_be_somewhere_to_record_to(handle: Run) -> None:
    with pytest.raises(UsageError, match="there is nowhere to record to"):
        record(handle)


@pytest.mark.skipif(not has_driver(), reason="no Vulkan driver is installed")
def test_it_streams_to_an_open_viewer(handle: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with open_viewer(tmp_path) as (client, port):
        monkeypatch.setattr(live, "VIEWER", ("127.0.0.1", port))
        record(handle, live=True)
        end = time.monotonic() + 120
        while len(client.get_state().views) < 7 and time.monotonic() < end:
            time.sleep(0.1)
        state = client.get_state()
        assert {"Inertial view", "What is shown"} <= {view.name for view in state.views}
        assert [each.name for each in state.recordings[0].timelines] == ["time"]


def test_samples_out_of_order_are_not_recorded(handle: Run, tmp_path: Path) -> None:
    run = handle.at([0.2, 0.1])
    with pytest.raises(GeometryError, match="the samples do not ascend"):
        record(run, tmp_path / "run.rrd")
    record(run.at([0.1, 0.2]), tmp_path / "run.rrd")


@pytest.mark.parametrize(("duration", "second"), [(1e-9, 1e-9), (1e-5, 1e-6), (2.0, 1.0), (1e10, 1e9)])
def test_every_sample_has_an_instant_of_its_own(duration: float, second: float, tmp_path: Path) -> None:
    scene = {
        "body": {"principal_moments": [1.0, 2.0, 3.0]},
        "start": {"angular_velocity": [0.1 / duration, 2.0 / duration, 0.0]},
        "run": {"duration": duration, "samples": 1001},
    }
    record(simulate(Scene.from_dict(scene)), tmp_path / "run.rrd")
    assert verified(tmp_path / "run.rrd", tmp_path)
    recorded = Recorded(tmp_path / "run.rrd")
    assert properties(tmp_path / "run.rrd")["timeline"] == {"second_s": pytest.approx(second)}
    assert len(set(recorded.time("/plots/drift"))) == 1001
    poses = recorded.time("/world/center_of_mass/body")
    assert len(set(poses)) == len(poses) >= 240
    np.testing.assert_allclose([poses.min(), poses.max()], [0.0, duration / second], rtol=1e-9)
    (text,) = recorded.texts("/text/summary", "TextDocument:text")
    assert ("On the timeline 1 s is" in text) == (second != 1.0)
