"""Writing the screen of one kind of run, and looking at it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from tests.recording.reading import Recorded, verified
from tests.recording.screenshot import has_driver, screenshot

from inertia.recording.screen import Screen
from inertia.recording.writer import to_file

FLOAT32 = 2.0**-23

drawable = pytest.mark.skipif(not has_driver(), reason="no Vulkan driver is installed")


def written(screen: Screen, file: Path) -> Recorded:
    """Write a screen, see that the file is whole and all of its numbers are finite, and read it back."""
    with to_file(file, screen.application, screen.blueprint, screen.second) as recording:
        screen.write(recording)
    assert verified(file, file.parent)
    back = Recorded(file)
    assert back.recording.application_id == back.blueprint.application_id == screen.application
    for path, columns in back.columns.items():
        for name in columns:
            if name.split(":")[-1] in ("scalars", "quaternion", "translation", "vectors", "half_sizes", "positions"):
                assert np.isfinite(back.values(path, name)).all(), (path, name)
    return back


def place(recording: Recorded, path: str) -> NDArray[Any]:
    """Return the translations (m, 3) of an entity."""
    return recording.values(path, "Transform3D:translation")[:, 0].astype(float)


def turn(recording: Recorded, path: str) -> Rotation:
    """Return the rotations (m,) of an entity."""
    return Rotation.from_quat(recording.values(path, "Transform3D:quaternion")[:, 0].astype(float))


def tips(recording: Recorded, path: str) -> NDArray[Any]:
    """Return the vectors (m, 3) of an arrow."""
    return recording.values(path, "Arrows3D:vectors")[:, 0].astype(float)


def series(recording: Recorded, path: str) -> NDArray[Any]:
    """Return the numbers (n, k) of a plot."""
    return recording.values(path, "Scalars:scalars")


def errors_seen(screen: Screen, folder: Path, seconds: float) -> list[str]:
    """Return what the viewer complains of."""
    with to_file(folder / "run.rrd", screen.application, screen.blueprint, screen.second) as recording:
        screen.write(recording)
    _, errors = screenshot(folder / "run.rrd", folder / "seen.png", seconds)
    return errors
