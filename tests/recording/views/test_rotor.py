"""A recording of a rotor holds it as modelled and as corrected, turning slowly, with its forces and limits."""

import math
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import rerun.blueprint as rrb
from tests.recording.kinds import drawable, errors_seen, series, turn, written
from tests.recording.reading import Recorded

import inertia
from inertia.balancing.balance import Balance, balance
from inertia.balancing.rotor import Rotor
from inertia.recording import entities
from inertia.recording.provenance import properties_of, rotor_of
from inertia.recording.views.rotor import TURNS, screen
from inertia.recording.views.rotor_target import DIAL_BOUNDS, FARTHEST, verdict_bounds, write_verdict, write_work
from inertia.recording.views.rotor_text import size_text
from inertia.recording.writer import to_file
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


def directions(recording: Recorded, room: str, name: str) -> np.ndarray:
    """Return the arrows across the shaft, as complex numbers."""
    x, y, z = recording.values(f"/{room}/rotor/{name}", "Arrows3D:vectors")[0].astype(float).T
    np.testing.assert_array_equal(z, 0.0)
    return x + 1j * y


def every_text(recording: Recorded) -> list[str]:
    """Return all that is written: documents and labels."""
    return [
        text
        for path, columns in recording.columns.items()
        for name in columns
        if name in ("TextDocument:text", "Points2D:labels", "Points3D:labels", "Arrows3D:labels")
        for text in recording.texts(path, name)
    ]


def test_the_screen_has_its_views(recording: Recorded) -> None:
    flat, documents = ["2D"] * 4, ["TextDocument"] * 3
    assert sorted(recording.views) == [*flat, "3D", "3D", *documents, "TimeSeries", "TimeSeries"]


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


def test_vectors_have_the_angles_of_the_unbalance_and_one_scale(tmp_path: Path) -> None:
    fine = changed(("grade = 6.3", "grade = 250"))  # nothing is broken, and nothing done
    recording = written(screen(fine), tmp_path / "rotor.rrd")
    rings = recording.values(f"/{entities.AS_MODELLED}/permissible", "LineStrips3D:strips")[0].reshape(2, -1, 3)
    radii = np.hypot(rings[..., 0], rings[..., 1]).mean(axis=1)
    permissible = np.array(fine.tolerance.permissible)
    scale = radii[0] / permissible[0]
    np.testing.assert_allclose(radii, scale * permissible, rtol=1e-5)
    assert radii.max() == pytest.approx(0.6)  # of the outer radius, one unit, whatever the unbalance
    for name, truth in (
        ("unbalance", [plane.initial for plane in fine.planes]),
        ("bearing_force", fine.initial.in_planes(0.02, 0.28)),
    ):
        np.testing.assert_allclose(
            directions(recording, entities.AS_MODELLED, name), scale * np.array(truth), rtol=1e-5
        )
    z = recording.values(f"/{entities.AS_MODELLED}/rotor/unbalance", "Arrows3D:origins")[0][:, 2]
    np.testing.assert_allclose(z, [-0.6, 0.65], atol=1e-6)  # 90 and 215 mm, from 150 mm, one unit being 100 mm


def test_vectors_that_are_too_long_are_broken_and_point_where_they_should(
    balanced: Balance, recording: Recorded
) -> None:
    drawn = directions(recording, entities.AS_MODELLED, "unbalance")
    truth = np.array([plane.initial for plane in balanced.planes])
    np.testing.assert_allclose(np.angle(drawn / truth), 0.0, atol=1e-6)
    x, y, _ = recording.values(f"/{entities.AS_MODELLED}/rotor/unbalance", "Arrows3D:origins")[0].astype(float).T
    np.testing.assert_allclose(abs(x + 1j * y + drawn), 1.2, rtol=1e-5)  # outer radii, where all of them end
    assert f"/{entities.AS_MODELLED}/rotor/unbalance/cut" in recording.columns
    labels = recording.texts(f"/{entities.AS_MODELLED}/plane_labels", "Points3D:labels")
    assert labels == ["I: 863 g·mm at 210.0°", "II: 1598 g·mm at 20.0°"]


def test_what_the_bounds_do_not_tell_from_zero_is_not_drawn(balanced: Balance, recording: Recorded) -> None:
    """The holes leave 0.1 g·mm, known to 0.7 g·mm."""
    left = balanced.residual.in_planes(0.02, 0.28)[0]
    assert abs(left) < sum(balanced.residual.bounds_in_planes((0.02, 0.28))[0].values())
    assert f"/{entities.CORRECTED}/rotor/bearing_force" not in recording.columns
    assert recording.texts(f"/{entities.CORRECTED}/bearing_labels", "Points3D:labels")[0] == "A: below 0.075 N"
    assert f"/{entities.POLAR_A}/after/line" not in recording.columns
    circle = recording.values(f"/{entities.POLAR_A}/after/uncertainty", "LineStrips2D:strips")[0]
    bound = sum(balanced.residual.bounds_in_planes((0.02, 0.28))[0].values()) / balanced.tolerance.permissible[0]
    assert 0.5 * np.ptp(circle.reshape(-1, 2), axis=0) == pytest.approx([bound, bound], rel=1e-3)


def test_both_states_have_one_scale(recording: Recorded) -> None:
    first, second = (
        recording.values(f"/{room}/permissible", "LineStrips3D:strips")[0]
        for room in (entities.AS_MODELLED, entities.CORRECTED)
    )
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("file", ["disc", "two_disc_rotor"])
def test_no_figure_is_below_its_bound(file: str, tmp_path: Path) -> None:
    """What rounding leaves of a balanced rotor is no unbalance, and no force."""
    subject = balance(Rotor.load(path(f"rotors/{file}.toml")))
    recording = written(screen(subject), tmp_path / "rotor.rrd")
    at = subject.tolerance_planes
    for text in every_text(recording):
        assert "e-" not in text, text
        for unbalance in (subject.initial, subject.residual):
            for k in range(2):
                size, bound = abs(unbalance.in_planes(*at)[k]), sum(unbalance.bounds_in_planes(at)[k].values())
                if size < bound:
                    for figure in (1e6 * size, subject.rotor.speed**2 * size):
                        assert f"{figure:.4g}" not in text, text
    for k, path_ in enumerate((entities.PLOT_BEARING_A, entities.PLOT_BEARING_B)):
        limit = subject.rotor.speed**2 * subject.tolerance.permissible[k]
        values = series(recording, f"/{path_}")
        assert values.max() == pytest.approx(max(limit, abs(subject.forces(subject.initial)[k])), rel=1e-3)
        if file == "disc":
            assert (values[:, 0] == 0.0).all()


def test_figures_have_no_digits_that_their_bounds_leave_open() -> None:
    random = np.random.default_rng(7)
    for size, bound in 10.0 ** random.uniform([-7, -9], [5, 5], (2000, 2)):
        text = size_text(size, bound, 1.0, "")
        figure, _, uncertain = text.removeprefix("below ").partition(" ± ")
        if text == "none":
            assert size + bound <= 1e-6
        elif text.startswith("below "):
            assert 2.0 * bound >= size
            assert float(figure) >= size + bound > float(figure) / 1.11
        else:
            last = 10.0 ** -len(figure.partition(".")[2])
            assert abs(float(figure) - size) <= max(0.5 * last, 0.006 * size)
            assert (
                float(uncertain) >= bound
                if uncertain
                else bound < max(last, 10.0 ** (math.floor(math.log10(size)) - 2))
            )


def test_the_scale_of_forces_is_that_of_the_limits(tmp_path: Path) -> None:
    subject = balance(Rotor.load(path("rotors/disc.toml")))
    recording = written(screen(subject), tmp_path / "rotor.rrd")
    limit = subject.rotor.speed**2 * subject.tolerance.permissible[0]
    np.testing.assert_allclose(recording.property("ScalarAxis:range"), [[-1.15 * limit, 1.15 * limit]] * 2)


def test_forces_at_rest_swing_once_a_turn(balanced: Balance, recording: Recorded) -> None:
    for path_, number in ((entities.PLOT_BEARING_A, 0), (entities.PLOT_BEARING_B, 1)):
        t = recording.time(f"/{path_}")
        *felt, limit, opposite = series(recording, f"/{path_}").T
        np.testing.assert_allclose(limit, SPEED**2 * balanced.tolerance.permissible[number])
        np.testing.assert_array_equal(opposite, -limit)
        for column, state in zip(felt, (balanced.initial, balanced.residual), strict=True):
            force = SPEED**2 * state.in_planes(0.02, 0.28)[number]
            np.testing.assert_allclose(column, abs(force) * np.cos(SPEED * t + np.angle(force)), atol=1e-6)


def test_targets_show_what_is_left_in_units_of_what_is_permissible(balanced: Balance, recording: Recorded) -> None:
    for path_, number in ((entities.POLAR_A, 0), (entities.POLAR_B, 1)):
        x, y = recording.values(f"/{path_}/after/tip", "Points2D:positions")[0, 0]
        left = balanced.residual.in_planes(0.02, 0.28)[number] / balanced.tolerance.permissible[number]
        assert complex(x, -y) == pytest.approx(left, abs=1e-6)
        before = recording.values(f"/{path_}/before/tip", "Points2D:positions")[0, 0]
        assert np.hypot(*before) == pytest.approx(FARTHEST)  # cut off, and says so
        assert (
            len(recording.columns[f"/{path_}/before/line"]["LineStrips2D:strips"][0][0]) == 4
        )  # in two, and the break
        legend = recording.texts(f"/{path_}/legend", "Points2D:labels")
        assert legend[1].endswith("× limit")
        assert legend[2].startswith("corrected: below ")


def test_the_holes_are_in_the_mesh_that_is_corrected(recording: Recorded) -> None:
    before, after = (
        len(recording.values(f"/{room}/rotor/body_0", "Mesh3D:vertex_positions")[0])
        for room in (entities.AS_MODELLED, entities.CORRECTED)
    )
    assert after > before
    assert recording.texts(f"/{entities.CORRECTED}/rotor/operations/numbers", "Points3D:labels") == ["1", "2"]
    assert recording.texts(f"/{entities.WORK}/numbers", "Points2D:labels") == ["1: 210.0°", "2: 20.0°"]
    (work,) = recording.texts(f"/{entities.WORK_TEXT}", "TextDocument:text")
    assert work.splitlines()[2:] == [
        "| 1 | I, z 90 | 210.0° | radial Ø10, 14.2 deep, r 100 | −9.350 g |",
        "| 2 | II, z 215 | 20.0° | radial Ø16, 12.4 deep, r 80 | −21.94 g |",
    ]


def test_a_fast_rotor_is_slowed_and_says_so(tmp_path: Path) -> None:
    fast = changed(("rpm = 3000", "rpm = 12000"), ("critical_rpm = 12000", "critical_rpm = 60000"))
    recording = written(screen(fast), tmp_path / "rotor.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "at 12000 r/min; on the screen at 60 r/min, 200 times slower." in text
    (text,) = recording.texts(f"/{entities.VERDICT_TEXT}", "TextDocument:text")
    assert text.startswith("**PASS**: the rotor, corrected, FAIL as modelled.")


def test_a_rotor_that_is_left_alone_has_one_state(tmp_path: Path) -> None:
    coarse = changed(("grade = 6.3", "grade = 250"))
    assert coarse.correction.operations == ()
    recording = written(screen(coarse), tmp_path / "rotor.rrd")
    assert recording.views.count("3D") == 1
    assert not any(name.startswith(f"/{entities.CORRECTED}") for name in recording.columns)
    assert series(recording, f"/{entities.PLOT_BEARING_A}").shape[1] == 3  # with both limits
    assert recording.texts(f"/{entities.WORK_TEXT}", "TextDocument:text") == ["Nothing has to be done."]


@pytest.mark.parametrize("outcome", ["pass", "conditional", "fail", "undecided"])
def test_the_verdict_is_a_word_in_strokes_within_its_badge(outcome: str, tmp_path: Path) -> None:
    with to_file(tmp_path / "badge.rrd", "inertia-balance", rrb.Blueprint()) as recording:
        write_verdict(recording, entities.VERDICT, outcome)
    strips = [
        np.array(strip)
        for strip in Recorded(tmp_path / "badge.rrd")
        .columns[f"/{entities.VERDICT}/word"]["LineStrips2D:strips"][0][0]
        .as_py()
    ]
    (left, right), (top, bottom) = verdict_bounds(outcome)
    x, y = np.concatenate(strips).T
    assert left < x.min()
    assert x.max() < right
    assert top < y.min() == 0.0
    assert y.max() == 4.0 < bottom
    assert len(strips) >= len(outcome)


def test_the_zero_mark_is_a_line_on_the_rotor(recording: Recorded) -> None:
    strips = recording.columns[f"/{entities.AS_MODELLED}/rotor/body_0/meridian_0"]["LineStrips3D:strips"][0][0]
    x, y, _ = np.concatenate([np.array(strip) for strip in strips.as_py()]).T
    np.testing.assert_allclose(y, 0.0, atol=1e-6)
    assert (x >= -1e-6).all()
    assert x.max() == pytest.approx(1.0)


def beside_each_other(subject: Balance, degrees: list[float]) -> Balance:
    """Return the rotor with its first hole at these angles in place of its work."""
    assert subject.correction is not None
    work = subject.correction.operations[0]
    works = tuple(replace(work, angle=math.radians(angle)) for angle in degrees)
    return replace(subject, correction=replace(subject.correction, operations=works))


@pytest.mark.parametrize(
    "degrees", [[303.5, 292.5, 303.5, 315.0], [6.0 * k for k in range(60)], [0.1 * k for k in range(9)]]
)
def test_names_of_places_do_not_lie_on_each_other(balanced: Balance, degrees: list[float], tmp_path: Path) -> None:
    """A name is 0.33 high and 0.1 wide a character at most, in the least of the views that the recording has."""
    with to_file(tmp_path / "dial.rrd", "inertia-balance", rrb.Blueprint()) as recording:
        write_work(recording, entities.WORK, beside_each_other(balanced, degrees))
    dial = Recorded(tmp_path / "dial.rrd")
    names = dial.texts(f"/{entities.WORK}/numbers", "Points2D:labels")
    places = dial.values(f"/{entities.WORK}/numbers", "Points2D:positions")[0]
    for (a, one), (b, other) in combinations(zip(places, names, strict=True), 2):
        assert abs(a[1] - b[1]) > 0.33 or abs(a[0] - b[0]) > 0.05 * (len(one) + len(other)), (one, other)
    for (x, y), name in zip(places, names, strict=True):
        assert abs(x) + 0.05 * len(name) <= DIAL_BOUNDS[0][1]
        assert -1.5 <= y <= 1.5 - 0.33 + 0.17
        assert abs(x) - 0.05 * len(name) >= 1.12  # beside the zero mark
    assert {name.partition(":")[2] for name in names} == (
        {" 303.5°", " 292.5°", " 315.0°"} if len(degrees) == 4 else {""}
    )


def test_places_that_are_near_each_other_have_one_number_in_space(balanced: Balance, tmp_path: Path) -> None:
    recording = written(screen(beside_each_other(balanced, [20.0, 30.0, 200.0, 25.0])), tmp_path / "rotor.rrd")
    path_ = f"/{entities.CORRECTED}/rotor/operations"
    assert recording.texts(f"{path_}/numbers", "Points3D:labels") == ["1, 2, 4", "3"]
    spots, named = (recording.values(k, "Points3D:positions")[0] for k in (path_, f"{path_}/numbers"))
    np.testing.assert_array_equal(named, spots[[0, 2]])


@drawable
def test_the_viewer_shows_it_without_an_error(balanced: Balance, tmp_path: Path) -> None:
    assert errors_seen(screen(balanced), tmp_path, 0.1) == []


def test_parts_of_an_assembly_are_entities_of_their_names(tmp_path: Path) -> None:
    result = balance(Rotor.load(path("rotors/pump_rotor.toml")))
    recording = written(screen(result), tmp_path / "pump.rrd")
    for room in (entities.AS_MODELLED, entities.CORRECTED):
        for name in ("shaft", "impeller", "coupling"):
            assert f"/{room}/rotor/parts/{name}" in recording.columns
    sections = properties_of(result)
    assert "../assemblies/pump_rotor.toml" in sections["files"].values()
    inertia.record(result, tmp_path / "again.rrd")
    again = balance(rotor_of(tmp_path / "again.rrd"))
    assert (again.indexing.turns, again.verdict) == (result.indexing.turns, result.verdict)
    assert [name for name in sections if name.startswith("source")] == ["source"]
    assert sections["source"]["path"] == "shaft_impeller.obj"


def test_the_work_is_written_to_the_digits_of_the_steps(tmp_path: Path) -> None:
    fine = changed(("angle_step = 0.5", "angle_step = 0.03"), ("depth_step = 0.1", "depth_step = 0.003"))
    recording = written(screen(fine), tmp_path / "rotor.rrd")
    (text,) = recording.texts(f"/{entities.WORK_TEXT}", "TextDocument:text")
    labels = recording.texts(f"/{entities.WORK}/numbers", "Points2D:labels")
    works = fine.correction.operations
    for line, label, work in zip(text.splitlines()[2:], labels, works, strict=True):
        angle = f"{math.degrees(work.angle):.2f}°"
        assert f"| {angle} |" in line
        assert label.endswith(f": {angle}")
        assert f", {round(1e3 * work.depth, 3):g} deep" in line
    assert any(round(1e3 * work.depth, 1) != round(1e3 * work.depth, 3) for work in works)
