"""A recording of a body that tumbles holds what was computed, named and arranged."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from tests.dynamics import oracle
from tests.recording.reading import Recorded, verified
from tests.recording.scenes import FREE, scene_table, t_handle
from tests.recording.screenshot import has_driver, screenshot

from inertia import Run, Scene, read, record, simulate
from inertia.recording import entities
from inertia.recording.playback import NEAR
from inertia_meshes import path, rational

FLOAT32 = 2.0**-23
STEEL, SPIN = 7850.0, np.array([0.001, 10.0, 0.0])
AXES = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Columns: the principal axes of the T-handle, along its arms, against its stem, and across."""


@dataclass(frozen=True)
class Truth:
    """The T-handle, from rational moments (kg m²) by an integrator in integers: at the instants drawn its attitude,
    part axes to space, and ω (m, 3) along the principal axes; L in space."""

    moments: np.ndarray
    attitude: Rotation
    angular_velocity: np.ndarray
    angular_momentum: np.ndarray


@pytest.fixture(scope="module")
def truth(recording: Recorded) -> Truth:
    solid = rational.moments(read(path("t_handle.stl"), "mm").triangles.corners())
    moments = STEEL * 1e-15 * np.sort(np.diag(np.array(solid.inertia, dtype=float)))
    answer = oracle.rotate(
        moments, SPIN, recording.time(f"/{entities.BODY}"), attitude=Rotation.from_matrix(AXES).as_quat()
    )
    return Truth(
        moments,
        Rotation.from_quat(answer.attitude.astype(float)) * Rotation.from_matrix(AXES.T),
        answer.angular_velocity.astype(float),
        AXES @ (moments * SPIN),
    )


@pytest.fixture(scope="module")
def handle() -> Run:
    return simulate(t_handle())


@pytest.fixture(scope="module")
def file(handle: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("record") / "handle.rrd"
    record(handle, made)
    return made


@pytest.fixture(scope="module")
def recording(file: Path) -> Recorded:
    return Recorded(file)


def turned(q: np.ndarray) -> Rotation:
    return Rotation.from_quat(q.astype(float))


def test_the_file_is_whole(file: Path, tmp_path: Path) -> None:
    assert verified(file, tmp_path)


NAMES = ("/name", "/names")
"""Texts beyond the tips of arrows."""
PARTS_OF = f"/{entities.INERTIA_ELLIPSOID}/", f"/{entities.INVARIABLE_PLANE}/"


def test_everything_has_its_place(recording: Recorded) -> None:
    drawn = {f"/{name}" for name in vars(entities).values() if isinstance(name, str)}
    expected = {
        "/world", "/world/center_of_mass/body", "/world/center_of_mass/body/mesh",
        "/world/center_of_mass/body/mark", "/world/center_of_mass/body/edges",
        "/world/center_of_mass/body/principal_axes", "/world/center_of_mass/angular_velocity",
        "/world/center_of_mass/angular_momentum", "/world/center_of_mass/herpolhode",
        "/body/principal_axes", "/body/momentum_sphere", "/body/energy_ellipsoid", "/body/polhode",
        "/world/center_of_mass/body/inertia_ellipsoid", "/world/center_of_mass/body/inertia_ellipsoid/polhode",
        "/world/center_of_mass/invariable_plane", "/world/center_of_mass/invariable_plane/grid",
        "/world/center_of_mass/invariable_plane/limits", "/world/center_of_mass/invariable_plane/contact",
        "/body/separatrix", "/body/polhodes_beside", "/body/angular_momentum", "/plots/angles_from_momentum",
        "/plots/angular_velocity", "/plots/angular_velocity/events",
        "/plots/euler_angles",
        "/plots/drift", "/spin_about_axis_2", "/text/summary",
    }  # fmt: skip
    paths = {name for name in recording.columns if not name.startswith("/__") and not name.endswith(NAMES)}
    assert paths == expected
    assert {name for name in paths if not name.startswith(PARTS_OF)} <= drawn


def test_the_screen_has_its_views(recording: Recorded) -> None:
    assert recording.recording.application_id == recording.blueprint.application_id == "inertia-tumble"
    assert sorted(recording.views) == [*3 * ["3D"], "StateTimeline", "TextDocument", *4 * ["TimeSeries"]]


def test_poses_are_those_of_the_true_motion(handle: Run, truth: Truth, recording: Recorded) -> None:
    instants = recording.time(f"/{entities.BODY}")
    assert np.diff(instants).max() <= 1 / 120 + 1e-9
    assert (instants[0], instants[-1]) == (0, 6)
    poses = recording.values(f"/{entities.BODY}", "Transform3D:quaternion")[:, 0]
    assert poses.dtype == np.float32
    assert (turned(poses) * truth.attitude.inv()).magnitude().max() < 4 * FLOAT32
    assert (turned(poses[1:]) * turned(poses[:-1]).inv()).magnitude().max() < NEAR + FLOAT32


def test_flips_are_marked_where_the_spin_about_axis_2_is_zero(handle: Run, recording: Recorded) -> None:
    flips = [event.time for event in handle.events if event.name == "flip"]
    np.testing.assert_allclose(recording.time(f"/{entities.PLOT_FLIPS}"), flips, atol=1e-9)
    assert abs(recording.values(f"/{entities.PLOT_FLIPS}", "Scalars:scalars")).max() < 1e-2  # of 10 rad/s, on a line


def test_flips_of_a_run_with_few_samples_are_marked_where_that_spin_is_zero(tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [3.0, 4.0, 6.0]},
        "start": {"angular_velocity": [0.1, 3.0, 0.0]},
        "run": {"duration": 60.0, "samples": 8},
    }
    run = simulate(Scene.from_dict(table))
    record(run, tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    marks = recording.values(f"/{entities.PLOT_FLIPS}", "Scalars:scalars")
    assert len(marks) == len(run.events) > 4
    assert np.abs(marks).max() < 1e-12


@pytest.mark.parametrize("samples", [1001, 9001])
def test_samples_farther_apart_than_the_motion_are_points_and_the_text_says_so(samples: int, tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [1.0, 2.0, 3.0]},
        "start": {"angular_velocity": [10.0, 1e4, 0.0]},
        "run": {"duration": 100.0, "samples": samples},
    }
    run = simulate(Scene.from_dict(table))
    record(run, tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert f"Samples are {100.0 / (samples - 1):.4g} s apart, in which the body may turn by" in text
    assert ("plots have each of them as a point" if samples == 1001 else "plots have one in 3 of them") in text
    for plot in (entities.PLOT_ANGULAR_VELOCITY, entities.PLOT_FROM_MOMENTUM, entities.PLOT_EULER_ANGLES):
        assert "SeriesPoints:markers" in recording.columns[f"/{plot}"]
        assert "SeriesLines:names" not in recording.columns[f"/{plot}"]
    plotted = recording.values(f"/{entities.PLOT_ANGULAR_VELOCITY}", "Scalars:scalars")
    assert np.array_equal(plotted, run.angular_velocity[:: 1 if samples == 1001 else 3])
    assert f"/{entities.FLIPS}" not in recording.columns
    period = run.quantities["flip period"]
    assert f"The body flips every {period:.4g} s" in text
    assert "too many to be marked on ω and on a timeline, where up to 1000 are" in text


def test_names_are_shown_as_they_are(tmp_path: Path) -> None:
    name = "my_part *bold* _x_ __y `x` [a](b) # $x$ &lt; ~~y~~.toml"
    record(simulate(replace(Scene.from_dict(scene_table("steady")), name=name)), tmp_path / "run.rrd")
    (text,) = Recorded(tmp_path / "run.rrd").texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert text.startswith(r"**my_part \*bold\* \_x\_ \_\_y \`x\` \[a\](b) \# \$x\$ \&lt; \~\~y\~\~.toml**: 8 s")


def test_on_the_separatrix_the_polhode_is_the_arc_that_the_body_covers(tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [3.0, 4.0, 6.0]},
        "start": {"angular_velocity": [2.0, 3.0, 1.0]},
        "run": {"duration": 20.0, "samples": 101},
    }
    record(simulate(Scene.from_dict(table)), tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    (arc,) = recording.values(f"/{entities.POLHODE}", "LineStrips3D:strips")[0].astype(float)
    seen = recording.values(f"/{entities.CURRENT}", "Arrows3D:vectors")[:, 0].astype(float)
    assert np.abs(arc[[0, -1]]) == pytest.approx(np.array([[0.0, 1.0, 0.0]] * 2), abs=1e-6)
    assert (arc[1:-1, [0, 2]] > 0).all()
    assert np.abs(seen[:, None] - arc).max(axis=2).min(axis=1).max() < 5e-3


def test_the_legend_has_room_beside_the_curves(recording: Recorded) -> None:
    """Six seconds of curves, and room to 8.1 s."""
    ranges = recording.property("TimeAxis:view_range")
    ends = sorted(each["end"] for each in ranges)
    assert ends == [6_000_000_000, *4 * [8_100_000_000]]


def test_the_mesh_is_the_part(handle: Run, recording: Recorded) -> None:
    part = handle.scene.body.part
    stored = part.triangles.corners().reshape(-1, 3) * 1e-3 - handle.scene.body.center_of_mass
    drawn = recording.values(f"/{entities.MESH}", "Mesh3D:vertex_positions")[0]
    np.testing.assert_allclose(drawn * 0.01, stored, atol=0.05 * FLOAT32)


def test_arrows_point_along_omega_and_momentum(truth: Truth, recording: Recorded) -> None:
    momentum = recording.values(f"/{entities.ANGULAR_MOMENTUM}", "Arrows3D:vectors")[:, 0].astype(float)
    direction = truth.angular_momentum / np.linalg.norm(truth.angular_momentum)
    np.testing.assert_allclose(
        momentum / np.linalg.norm(momentum, axis=1)[:, None], direction[None].repeat(len(momentum), 0), atol=1e-6
    )
    omega = recording.values(f"/{entities.ANGULAR_VELOCITY}", "Arrows3D:vectors")[:, 0].astype(float)
    expected = truth.attitude.apply(truth.angular_velocity @ AXES.T)
    scale = np.linalg.norm(omega, axis=1).max() / np.linalg.norm(truth.angular_velocity, axis=1).max()
    np.testing.assert_allclose(omega, scale * expected, atol=2e-5 * scale * 12)
    along = omega @ direction  # on the invariable plane
    assert np.ptp(along) < 1e-5 * along[0]


def test_the_trail_is_the_path_of_the_tip(recording: Recorded) -> None:
    trail = recording.values(f"/{entities.HERPOLHODE}", "LineStrips3D:strips")[:, 0]
    tips = recording.values(f"/{entities.ANGULAR_VELOCITY}", "Arrows3D:vectors")[:, 0]
    assert np.array_equal(trail[:, 1], tips)
    assert np.array_equal(trail[1:, 0], tips[:-1])


def test_momentum_is_on_the_sphere_and_the_ellipsoid(truth: Truth, recording: Recorded) -> None:
    moments, size = truth.moments, np.linalg.norm(truth.angular_momentum)
    semi_axes = recording.values(f"/{entities.ENERGY_ELLIPSOID}", "Ellipsoids3D:half_sizes")[0, 0].astype(float)
    twice_energy = moments @ SPIN**2
    np.testing.assert_allclose(semi_axes, np.sqrt(twice_energy * moments) / size, rtol=1e-6)
    assert recording.values(f"/{entities.MOMENTUM_SPHERE}", "Ellipsoids3D:half_sizes")[0, 0] == pytest.approx([1, 1, 1])
    polhode, separatrix = (
        recording.values(f"/{name}", "LineStrips3D:strips")[0].reshape(-1, 3).astype(float)
        for name in (entities.POLHODE, entities.SEPARATRIX)
    )
    for curves in (polhode, separatrix):
        np.testing.assert_allclose(np.linalg.norm(curves, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(((polhode / semi_axes) ** 2).sum(axis=1), 1, atol=1e-6)
    np.testing.assert_allclose((separatrix**2 / moments).sum(axis=1), 1 / moments[1], rtol=1e-5)
    current = recording.values(f"/{entities.CURRENT}", "Arrows3D:vectors")[:, 0].astype(float)
    np.testing.assert_allclose(current, truth.angular_velocity * moments / size, atol=1e-6)
    np.testing.assert_allclose(((current / semi_axes) ** 2).sum(axis=1), 1, atol=1e-5)
    distance = np.linalg.norm(current[:, None] - polhode[None], axis=2).min(axis=1)
    assert distance.max() < 0.01


def test_polhodes_beside_have_the_same_momentum_and_another_energy(truth: Truth, recording: Recorded) -> None:
    curves = recording.values(f"/{entities.POLHODE_FAMILY}", "LineStrips3D:strips")[0].reshape(16, -1, 3).astype(float)
    np.testing.assert_allclose(np.linalg.norm(curves, axis=2), 1.0, atol=1e-6)
    energies = (curves**2 / truth.moments).sum(axis=2)
    np.testing.assert_allclose(energies, energies[:, :1].repeat(curves.shape[1], 1), rtol=1e-5)
    about_1 = energies[:, 0] > 1.0 / truth.moments[1]
    assert about_1.sum() == 8
    assert np.unique(energies[:, 0].round(-2)).size == 8


def test_the_inertia_ellipsoid_rolls_on_the_invariable_plane(truth: Truth, recording: Recorded) -> None:
    """It touches the plane, which is 2T/|L| from the centre, at the tip of ω (textbook § 13.21)."""
    path_, plane = f"/{entities.INERTIA_ELLIPSOID}", f"/{entities.INVARIABLE_PLANE}"
    contact = recording.values(f"{plane}/contact", "Points3D:positions")[:, 0].astype(float)
    scale = np.linalg.norm(contact, axis=1).max() / np.linalg.norm(truth.angular_velocity, axis=1).max()
    normal = truth.angular_momentum / np.linalg.norm(truth.angular_momentum)
    height = scale * float(truth.moments @ SPIN**2) / np.linalg.norm(truth.angular_momentum)
    np.testing.assert_allclose(contact @ normal, height, rtol=1e-5)
    np.testing.assert_allclose(recording.values(plane, "Mesh3D:vertex_positions")[0] @ normal, height, rtol=1e-5)
    semi_axes = recording.values(path_, "Ellipsoids3D:half_sizes")[0, 0].astype(float)
    own = turned(recording.values(path_, "Ellipsoids3D:quaternions")[0])
    poses = turned(recording.values(f"/{entities.BODY}", "Transform3D:quaternion")[:, 0])
    inside = (poses * own).inv().apply(contact) / semi_axes
    np.testing.assert_allclose(np.linalg.norm(inside, axis=1), 1.0, rtol=1e-4)
    gradient = (poses * own).apply(inside / semi_axes)
    gradient /= np.linalg.norm(gradient, axis=1)[:, None]
    np.testing.assert_allclose(gradient, normal[None].repeat(len(gradient), 0), atol=1e-4)
    polhode = recording.values(f"{path_}/polhode", "LineStrips3D:strips")[0].reshape(-1, 3).astype(float)
    np.testing.assert_allclose(np.linalg.norm(own.inv().apply(polhode) / semi_axes, axis=1), 1.0, rtol=1e-5)
    limits = recording.values(f"{plane}/limits", "LineStrips3D:strips")[0].reshape(2, -1, 3).astype(float)
    radii = np.linalg.norm(limits - (limits @ normal)[..., None] * normal, axis=2)
    across = np.linalg.norm(contact - np.outer(contact @ normal, normal), axis=1)
    np.testing.assert_allclose(radii.mean(axis=1), [across.min(), across.max()], atol=1e-5)


def test_angles_from_momentum_are_plotted(handle: Run, recording: Recorded) -> None:
    angles = recording.values(f"/{entities.PLOT_FROM_MOMENTUM}", "Scalars:scalars")
    np.testing.assert_allclose((np.cos(angles) ** 2).sum(axis=1), 1.0, atol=1e-12)
    axis = Rotation.from_quat(handle.attitude).apply(AXES[:, 1])
    momentum = handle.angular_momentum / np.linalg.norm(handle.angular_momentum, axis=1)[:, None]
    np.testing.assert_allclose(np.cos(angles[:, 1]), (axis * momentum).sum(axis=1), atol=1e-12)


def test_plots_hold_every_sample_and_name_their_units(handle: Run, truth: Truth, recording: Recorded) -> None:
    for name in (entities.PLOT_ANGULAR_VELOCITY, entities.PLOT_EULER_ANGLES, entities.PLOT_DRIFT):
        np.testing.assert_allclose(recording.time(f"/{name}"), handle.time, atol=1e-9)
    omega = recording.values(f"/{entities.PLOT_ANGULAR_VELOCITY}", "Scalars:scalars")
    assert omega.shape == (601, 3)
    exact = oracle.rotate(truth.moments, SPIN, handle.time[::5], attitude=Rotation.from_matrix(AXES).as_quat())
    np.testing.assert_allclose(omega[::5], exact.angular_velocity.astype(float), atol=1e-8)
    assert recording.texts(f"/{entities.PLOT_ANGULAR_VELOCITY}", "SeriesLines:names") == [
        "ω1, rad/s",
        "ω2, rad/s",
        "ω3, rad/s",
    ]
    angles = recording.values(f"/{entities.PLOT_EULER_ANGLES}", "Scalars:scalars")
    q = Rotation.from_euler("ZXZ", angles)
    expected = Rotation.from_quat(exact.attitude.astype(float)) * Rotation.from_matrix(AXES.T)
    assert (q[::5] * expected.inv()).magnitude().max() < 1e-9
    assert recording.texts(f"/{entities.PLOT_EULER_ANGLES}", "SeriesLines:names") == ["φ, rad", "θ, rad", "ψ, rad"]
    drift = recording.values(f"/{entities.PLOT_DRIFT}", "Scalars:scalars")
    names = recording.texts(f"/{entities.PLOT_DRIFT}", "SeriesLines:names")
    assert [name.split(",")[0] for name in names] == ["energy", "L"]
    unit = 10.0 ** int(names[0].split(", 10")[1].translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))
    energy = handle.invariants["energy"]
    np.testing.assert_allclose(drift[:, 0] * unit, energy.values / energy.values[0] - 1, atol=3e-16)
    largest = max(each.largest_relative_drift for each in handle.invariants.values())
    assert np.abs(drift).max() * unit == pytest.approx(largest)
    assert 1 <= np.abs(drift).max() < 10


def test_flips_are_when_the_spin_about_axis_2_changes_sign(truth: Truth, recording: Recorded) -> None:
    a, b, c = truth.moments

    def euler(_: float, w: np.ndarray) -> list[float]:
        return [(b - c) / a * w[1] * w[2], (c - a) / b * w[2] * w[0], (a - b) / c * w[0] * w[1]]

    crossings = solve_ivp(euler, (0, 6), SPIN, "DOP853", rtol=1e-13, atol=1e-15, events=lambda _, w: w[1]).t_events[0]
    assert len(crossings) == 2
    np.testing.assert_allclose(recording.time(f"/{entities.FLIPS}"), [0, *crossings], atol=2e-9)
    assert recording.texts(f"/{entities.FLIPS}", "StateChange:state") == ["+2", "−2", "+2"]


def test_principal_axes_are_numbered_as_the_scene_numbers_them(tmp_path: Path) -> None:
    body = {"principal_moments": [3.0, 1.0, 2.5]}
    start, settings = {"angular_velocity": [0.01, 0.02, 3.0]}, {"duration": 8.0, "samples": 201}
    run = simulate(Scene.from_dict({"body": body, "start": start, "run": settings}))
    record(run, tmp_path / "run.rrd")
    recorded = Recorded(tmp_path / "run.rrd")
    (text,) = recorded.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "moments 3, 1, 2.5 kg m²; spin 0.01, 0.02, 3 rad/s along principal axes" in text
    assert "parts polhodes about axis 2 (smallest moment) from those about axis 1 (largest)" in text
    plotted = recorded.values(f"/{entities.PLOT_ANGULAR_VELOCITY}", "Scalars:scalars")
    np.testing.assert_allclose(plotted[0], start["angular_velocity"], rtol=1e-12)
    states = recorded.texts(f"/{entities.FLIPS}", "StateChange:state")
    assert len(states) > 1
    assert states[:2] == ["+3", "−3"]


def test_the_text_tells_model_accuracy_and_what_is_shown(handle: Run, recording: Recorded) -> None:
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "t_handle.stl, in mm" in text
    assert f"Model: asymmetric top.** {handle.why[0]}" in text
    assert "10⁻¹⁰ rad asked for" in text
    assert "Played 2 times slower than it is." in text
    assert "each as the model has it, to 1.2·10⁻⁷ rad in single precision" in text
    assert "In the inertial view 1 unit is 0.01 m." in text


@pytest.mark.parametrize("look", FREE)
def test_every_look_is_written_whole(look: str, tmp_path: Path) -> None:
    run = simulate(Scene.from_dict(scene_table(look)))
    record(run, tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    paths = set(recording.columns)
    assert verified(tmp_path / "run.rrd", tmp_path)
    assert (f"/{entities.BODY_CONE}" in paths) == (look in ("prolate", "oblate"))
    assert (f"/{entities.SEPARATRIX}" in paths) == (look in ("asymmetric", "steady", "thrown", "slow", "coarse"))
    assert (f"/{entities.PATH}" in paths) == (look == "thrown")
    assert f"/{entities.HERPOLHODE}" in paths
    assert f"/{entities.ENERGY_ELLIPSOID}" in paths - set(recording.rows)
    assert (f"/{entities.INERTIA_ELLIPSOID}" in paths) == (look != "spherical")
    assert (f"/{entities.DIAL}/count" in paths) == (look in ("prolate", "oblate"))
    assert (f"/{entities.GHOSTS}" in paths) == (look == "thrown")
    assert (f"/{entities.POLHODE_FAMILY}" in paths) == (f"/{entities.SEPARATRIX}" in paths)


@pytest.mark.parametrize(
    ("look", "across", "along", "transverse", "axial"),
    [("prolate", 1.0, 2.0, 3.0, 1.0), ("oblate", 0.5, 2.0, 2.0, 3.0)],
)
def test_cones_are_those_of_the_textbook(
    look: str, across: float, along: float, transverse: float, axial: float, tmp_path: Path
) -> None:
    """The body cone opens by arctan(ω⊥/ω3), L leans by arctan(I⊥ ω⊥ / (I3 ω3)), and ω goes round L at |L|/I⊥."""
    record(simulate(Scene.from_dict(scene_table(look))), tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    body = math.atan2(across, along)
    lean = math.atan2(transverse * across, axial * along)
    for path_, half_angle in ((entities.BODY_CONE, body), (entities.SPACE_CONE, abs(lean - body))):
        rim = recording.values(f"/{path_}", "Mesh3D:vertex_positions")[0].astype(float).reshape(-1, 3, 3)[:, 1]
        axis = rim.mean(axis=0) / np.linalg.norm(rim.mean(axis=0))
        np.testing.assert_allclose(np.arccos(rim @ axis / np.linalg.norm(rim, axis=1)), half_angle, atol=1e-5)
    omega = recording.values(f"/{entities.ANGULAR_VELOCITY}", "Arrows3D:vectors")[:, 0].astype(float)
    momentum = recording.values(f"/{entities.ANGULAR_MOMENTUM}", "Arrows3D:vectors")[0, 0].astype(float)
    rate = math.hypot(transverse * across, axial * along) / transverse
    t = recording.time(f"/{entities.ANGULAR_VELOCITY}")[:, None]
    around = Rotation.from_rotvec(rate * t * momentum / np.linalg.norm(momentum)).apply(omega[0])
    np.testing.assert_allclose(omega, around, atol=2e-3 * np.linalg.norm(omega[0]))  # between samples


@pytest.mark.parametrize("look", ["prolate", "oblate"])
def test_cones_touch_along_omega(look: str, tmp_path: Path) -> None:
    run = simulate(Scene.from_dict(scene_table(look)))
    record(run, tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    omega = recording.values(f"/{entities.ANGULAR_VELOCITY}", "Arrows3D:vectors")[:, 0].astype(float)
    poses = turned(recording.values(f"/{entities.BODY}", "Transform3D:quaternion")[:, 0])
    in_space = recording.values(f"/{entities.SPACE_CONE}", "Mesh3D:vertex_positions")[0].astype(float)
    in_body = recording.values(f"/{entities.BODY_CONE}", "Mesh3D:vertex_positions")[0].astype(float)
    for k in range(0, len(omega), 60):
        for rim in (in_space, poses[k].apply(in_body)):
            distance = np.linalg.norm(rim - omega[k], axis=1).min()
            assert distance < 0.05 * np.linalg.norm(omega[k])


def test_feynmans_plate_wobbles_twice_while_it_spins_once_as_counted(tmp_path: Path) -> None:
    """I₃ = 2 I₁, ω = (0.5, 0, 20): the wobble is at |L|/I₁ = √(0.5² + 40²) rad/s, the spin at 20."""
    record(simulate(Scene.load(path("scenes/feynman_plate.toml"))), tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    for hand, rate in (("wobble", math.hypot(0.5, 40.0)), ("spin", 20.0)):
        tip = recording.values(f"/{entities.DIAL}/{hand}/tip", "Points2D:positions")[:, 0].astype(float)
        angle = np.unwrap(np.arctan2(-tip[:, 1], tip[:, 0]))
        np.testing.assert_allclose(angle, rate * recording.time(f"/{entities.DIAL}/{hand}/tip"), atol=1e-5)
    counts = recording.texts(f"/{entities.DIAL}/count", "Points2D:labels")
    assert counts[-1] == "wobble 5.09 turns, spin 2.55: 2.000 to 1"
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert f"{math.hypot(0.5, 40.0) / 20.0:.6g} times while the body turns once" in text


def test_a_thrown_body_is_where_it_is(tmp_path: Path) -> None:
    run = simulate(Scene.from_dict(scene_table("thrown")))
    record(run, tmp_path / "run.rrd")
    recording = Recorded(tmp_path / "run.rrd")
    t = recording.time(f"/{entities.CENTER}")
    place = recording.values(f"/{entities.CENTER}", "Transform3D:translation")[:, 0].astype(float)
    truth = np.stack([3 * t, 0 * t, 4 * t - 0.5 * 9.80665 * t**2], axis=1)
    unit = np.ptp(truth[:, 0]) / np.ptp(place[:, 0])
    assert np.log10(unit) == pytest.approx(np.round(np.log10(unit)), abs=1e-6)
    np.testing.assert_allclose(place * unit, truth - truth.min(axis=0), atol=5e-4)
    now = f"/{entities.GHOSTS}/now"
    np.testing.assert_array_equal(recording.values(now, "Transform3D:translation")[:, 0], place.astype(np.float32))
    ghosts = recording.values(f"/{entities.GHOSTS}", "Ellipsoids3D:centers")[0].astype(float) * unit
    flash = np.arange(len(ghosts))[:, None] * [1.0, 0.0, 0.0]  # s: 8 s have nine of them
    expected = np.hstack([3 * flash[:, :1], 0 * flash[:, :1], 4 * flash[:, :1] - 0.5 * 9.80665 * flash[:, :1] ** 2])
    assert len(ghosts) == 9
    np.testing.assert_allclose(ghosts, expected - truth.min(axis=0), atol=0.4)  # at the nearest pose


@pytest.mark.skipif(not has_driver(), reason="no Vulkan driver is installed")
@pytest.mark.parametrize("look", ["handle", "oblate", "thrown"])
def test_the_viewer_shows_it_without_an_error(look: str, file: Path, tmp_path: Path) -> None:
    if look != "handle":
        file = tmp_path / "run.rrd"
        record(simulate(Scene.from_dict(scene_table(look))), file)
    views, errors = screenshot(file, tmp_path / "seen.png", 1.0)
    assert errors == []
    assert {"Inertial view", "Body view: L / |L|", "What is shown"} <= set(views)
    assert (tmp_path / "seen.png").stat().st_size > 50_000
