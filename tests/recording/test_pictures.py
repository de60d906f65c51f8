"""Pictures of recordings, still and moving: drawn without a screen, or a sentence that says what is missing."""

import shutil
import struct
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from tests.recording.screenshot import has_driver

import inertia
from inertia.errors import InertiaError, ReadError, UsageError
from inertia.recording.provenance import playback_speed
from inertia_meshes import path

DRIVER = pytest.mark.skipif(not has_driver(), reason="no Vulkan driver is installed")
SMALL = 480, 320


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("recording") / "run.rrd"
    inertia.record(inertia.simulate(inertia.Scene.load(path("scenes/t_handle.toml"))), file)
    return file


@DRIVER
def test_a_moving_picture_turns_as_fast_as_the_run_is_played(recording: Path, tmp_path: Path) -> None:
    from PIL import Image

    file = tmp_path / "run.gif"
    done: list[float] = []
    left = 2.5 * 0.08 * playback_speed(recording)  # two frames of 80 ms and a half, so that three are drawn
    inertia.export_picture(recording, file, at=60.0 - left, size=SMALL, frames=4, fps=12.5, progress=done.append)
    assert done == [1 / 3, 2 / 3, 1.0]
    with Image.open(file) as picture:
        assert (picture.size, picture.info["loop"]) == (SMALL, 0)
        frames, durations = [], []
        for k in range(picture.n_frames):
            picture.seek(k)
            durations.append(picture.info["duration"])
            frames.append(np.asarray(picture.convert("RGB")).astype(int))
    assert durations == [80, 80, 80]
    bodies = np.s_[: SMALL[1] // 2, : SMALL[0] // 3]
    for one, other in pairwise(frames):
        assert (np.abs(one[bodies] - other[bodies]).max(axis=2) > 40).sum() > 50


@DRIVER
def test_a_picture_has_the_size_asked_for_and_nothing_of_the_window(recording: Path, tmp_path: Path) -> None:
    from PIL import Image

    inertia.export_picture(recording, tmp_path / "run.png", at=1.0, size=SMALL)
    with Image.open(tmp_path / "run.png") as picture:
        assert picture.size == SMALL
        shown = np.asarray(picture.convert("RGB")).astype(int)
    titles = shown[:30]  # of the views: no bar is above them
    assert (titles.max(axis=2) > 120).any(axis=1).nonzero()[0].min() < 14


@DRIVER
def test_one_view_is_drawn_alone_in_the_size_asked_for(recording: Path, tmp_path: Path) -> None:
    for view in ("inertial", "euler angles"):  # of which the other lies behind a tab
        inertia.export_picture(recording, tmp_path / "view.png", at=1.0, size=SMALL, view=view, force=True)
        data = (tmp_path / "view.png").read_bytes()
        assert data.startswith(b"\x89PNG")
        assert struct.unpack(">II", data[16:24]) == SMALL
    with pytest.raises(UsageError, match="no view 'none': its views are '"):
        inertia.export_picture(recording, tmp_path / "none.png", size=SMALL, view="none")


@pytest.mark.skipif("sys.platform != 'linux'", reason="how drivers are found")
def test_without_a_driver_it_says_what_to_install(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        monkeypatch.setenv(name, str(tmp_path / "none.json"))
    with pytest.raises(InertiaError, match="pictures need a Vulkan driver, and there is none on this machine: install"):
        inertia.export_picture(recording, tmp_path / "run.png", size=SMALL)
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_drawn_is_said_before(recording: Path, tmp_path: Path) -> None:
    for arguments, message in (
        ({"size": (0, 10)}, "a picture of 0 by 10 pixels: give 1 to 4096 each way"),
        ({"frames": 0}, "0 frames at 15 a second: give 1 or more"),
        ({"fps": 60.0}, "60 frames at 60 a second: give 1 or more, and up to 50 a second"),
    ):
        with pytest.raises(UsageError, match=message):
            inertia.export_picture(recording, tmp_path / "run.gif", **arguments)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"must end in \.png or \.gif"):
        inertia.export_picture(recording, tmp_path / "run.jpg")
    with pytest.raises(ReadError, match="no Rerun recording"):
        inertia.export_picture(path("t_handle.stl"), tmp_path / "run.png")
    other = recording.with_suffix(".bin")
    shutil.copy(recording, other)
    with pytest.raises(ReadError, match=r"run\.bin: Rerun's viewer opens .*: call it run\.rrd"):
        inertia.export_picture(other, tmp_path / "run.png")
    assert list(tmp_path.iterdir()) == []
