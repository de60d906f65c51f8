"""A recording of a rotor holds it as modelled and as corrected, turning slowly, with its forces and limits."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.recording.kinds import drawable, errors_seen, series, turn, written
from tests.recording.reading import Recorded

from inertia.balancing.balance import Balance, balance
from inertia.balancing.rotor import Rotor
from inertia.recording import entities
from inertia.recording.views.rotor import FARTHEST, TURNS, screen
from inertia_meshes import path

FILE = path("rotors/two_disc_rotor.toml")
SPEED = 3000.0 * math.pi / 30.0


def changed(*changes: tuple[str, str]) -> Balance:
    text = FILE.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return balance(Rotor.loads(text, FILE.parent))


@pytest.fixture(scope="module")
def balanced() -> Balance:
    return balance(Rotor.load(FILE))


@pytest.fixture(scope="module")
def recording(balanced: Balance, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return written(screen(balanced), tmp_path_factory.mktemp("rotor") / "rotor.rrd")


def vectors(recording: Recorded, room: str, name: str) -> np.ndarray:
    """Return the arrows across the shaft, as complex numbers."""
    x, y, z = recording.values(f"/{room}/rotor/{name}", "Arrows3D:vectors")[0].astype(float).T
    np.testing.assert_array_equal(z, 0.0)
    return x + 1j * y


def test_the_screen_has_its_views(recording: Recorded) -> None:
    assert sorted(recording.views) == ["2D", "2D", "3D", "3D", "TextDocument", "TimeSeries", "TimeSeries"]


@pytest.mark.parametrize("room", [entities.AS_MODELLED, entities.CORRECTED])
def test_the_shaft_makes_whole_turns(room: str, recording: Recorded) -> None:
    t = recording.time(f"/{room}/rotor")
    assert t[-1] == pytest.approx(TURNS / 50.0)
    angle = turn(recording, f"/{room}/rotor").as_rotvec()
    np.testing.assert_allclose(angle[:, :2], 0.0, atol=1e-6)
    np.testing.assert_allclose(np.exp(1j * angle[:, 2]), np.exp(1j * SPEED * t), atol=1e-5)


def test_a_shaft_that_turns_clockwise_does_so(tmp_path: Path) -> None:
    other = written(screen(changed(('"ccw"', '"cw"'))), tmp_path / "rotor.rrd")
    angle = turn(other, f"/{entities.AS_MODELLED}/rotor").as_rotvec()[:, 2]
    assert angle[1] < 0


def test_vectors_have_the_angles_and_ratios_of_the_unbalance(balanced: Balance, recording: Recorded) -> None:
    for room, name in ((entities.AS_MODELLED, "initial"), (entities.CORRECTED, "residual")):
        truth = np.array([getattr(plane, name) for plane in balanced.planes])
        drawn = vectors(recording, room, "unbalance")
        np.testing.assert_allclose(np.angle(drawn / truth), 0.0, atol=1e-6)
        np.testing.assert_allclose(np.abs(drawn[0] / drawn[1]), np.abs(truth[0] / truth[1]), rtol=1e-6)
    z = recording.values(f"/{entities.AS_MODELLED}/rotor/unbalance", "Arrows3D:origins")[0][:, 2]
    np.testing.assert_allclose(z, [-0.6, 0.65], atol=1e-6)  # 90 and 215 mm, from 150 mm, one unit being 100 mm
    labels = recording.texts(f"/{entities.AS_MODELLED}/rotor/unbalance", "Arrows3D:labels")
    assert labels == ["I 863.1 g·mm", "II 1598 g·mm"]


def test_circles_and_bearing_vectors_have_one_scale(balanced: Balance, recording: Recorded) -> None:
    for room, state in ((entities.AS_MODELLED, balanced.initial), (entities.CORRECTED, balanced.residual)):
        rings = recording.values(f"/{room}/permissible", "LineStrips3D:strips")[0].reshape(2, -1, 3)
        radii = np.hypot(rings[..., 0], rings[..., 1]).mean(axis=1)
        drawn = vectors(recording, room, "bearing_force")
        truth = np.array(state.in_planes(0.02, 0.28))
        scale = radii[0] / balanced.tolerance.permissible[0]
        np.testing.assert_allclose(radii, scale * np.array(balanced.tolerance.permissible), rtol=1e-5)
        np.testing.assert_allclose(drawn, scale * truth, atol=1e-6)


def test_forces_at_rest_swing_once_a_turn(balanced: Balance, recording: Recorded) -> None:
    for path_, number in ((entities.PLOT_BEARING_A, 0), (entities.PLOT_BEARING_B, 1)):
        t = recording.time(f"/{path_}")
        for column, state in zip(series(recording, f"/{path_}").T, (balanced.initial, balanced.residual), strict=True):
            force = SPEED**2 * state.in_planes(0.02, 0.28)[number]
            np.testing.assert_allclose(column, abs(force) * np.cos(SPEED * t + np.angle(force)), atol=1e-6)


def test_targets_show_what_is_left_in_units_of_what_is_permissible(balanced: Balance, recording: Recorded) -> None:
    for path_, number in ((entities.POLAR_A, 0), (entities.POLAR_B, 1)):
        x, y = recording.values(f"/{path_}/after/tip", "Points2D:positions")[0, 0]
        left = balanced.residual.in_planes(0.02, 0.28)[number] / balanced.tolerance.permissible[number]
        assert complex(x, -y) == pytest.approx(left, abs=1e-6)
        before = recording.values(f"/{path_}/before/tip", "Points2D:positions")[0, 0]
        assert np.hypot(*before) == pytest.approx(FARTHEST)  # cut off, and says so
        (label,) = recording.texts(f"/{path_}/before/tip", "Points2D:labels")
        assert label.endswith("×")


def test_the_holes_are_in_the_mesh_that_is_corrected(recording: Recorded) -> None:
    before, after = (
        len(recording.values(f"/{room}/rotor/body_0", "Mesh3D:vertex_positions")[0])
        for room in (entities.AS_MODELLED, entities.CORRECTED)
    )
    assert after > before
    labels = recording.texts(f"/{entities.CORRECTED}/rotor/operations", "Points3D:labels")
    assert labels == ["I-1: Ø 10, 14.2 mm deep", "II-1: Ø 16, 12.4 mm deep"]


def test_a_fast_rotor_is_slowed_and_says_so(tmp_path: Path) -> None:
    fast = changed(("rpm = 3000", "rpm = 12000"), ("critical_rpm = 12000", "critical_rpm = 60000"))
    recording = written(screen(fast), tmp_path / "rotor.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "The shaft turns at 12000 r/min, on the screen at 60 r/min, 200 times slower." in text
    assert text.startswith("**the rotor: PASS**")


def test_a_rotor_that_is_left_alone_has_one_state(tmp_path: Path) -> None:
    coarse = changed(("grade = 6.3", "grade = 250"))
    assert coarse.correction.operations == ()
    recording = written(screen(coarse), tmp_path / "rotor.rrd")
    assert recording.views.count("3D") == 1
    assert not any(name.startswith(f"/{entities.CORRECTED}") for name in recording.columns)
    assert series(recording, f"/{entities.PLOT_BEARING_A}").shape[1] == 1


@drawable
def test_the_viewer_shows_it_without_an_error(balanced: Balance, tmp_path: Path) -> None:
    assert errors_seen(screen(balanced), tmp_path, 0.1) == []
