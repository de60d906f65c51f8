"""Plots of runs: which suit a model, that they show what the run has, with units, and nothing on top of another."""

import functools
import math
import re
import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from tests.dynamics.scenes import DISC, PLAIN, TOP, scene

from inertia.dynamics.plots.kinds import KINDS, kinds_of
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import UsageError
from inertia_meshes import path

SUITABLE = {
    "t_handle": ["polhode", "momentum sphere", "angular velocity"],
    "feynman_plate": ["polhode", "momentum sphere", "angular velocity"],
    "cube": ["angular velocity"],
    "heavy_top": ["effective potential", "nutation", "angular velocity"],
    "kovalevskaya_top": ["nutation", "angular velocity"],
    "pendulum": ["phase portrait", "angular velocity"],
    "tilted_disc": ["angular velocity"],
    "rolling_disc": ["phase portrait", "nutation", "angular velocity"],
    "tippe_top": ["nutation", "angular velocity"],
    "manoeuvre": ["momentum sphere", "angular velocity"],
    "cat": ["angular velocity"],
}
UNITS = ("rad/s", "rad", ", s", ", J", "kg m²/s")


@functools.cache
def run_of(name: str) -> Run:
    scene = Scene.load(path(f"scenes/{name}.toml"))
    if name == "tippe_top":  # which has turned over by then
        scene = replace(scene, run=replace(scene.run, duration=2.5, samples=8001, accuracy=1e-3))
    return simulate(scene)


def line(axes: Axes, label: str) -> np.ndarray:
    """Return the points (n, 2) of what the legend calls so."""
    (one,) = [each for each in axes.lines if each.get_label() == label]
    return np.asarray(one.get_xydata())


@pytest.mark.parametrize("name", SUITABLE)
def test_every_model_has_the_plots_that_suit_it_and_no_text_lies_on_another(name: str) -> None:
    run = run_of(name)
    assert kinds_of(run) == SUITABLE[name]
    figure = run.plot()
    assert len(figure.axes) == len(SUITABLE[name])
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    boxes = [] if figure.get_suptitle() == "" else [figure.texts[0].get_window_extent()]
    for axes in figure.axes:
        texts = [axes.title, *axes.texts]
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            low, high = sorted(axis.get_view_interval())
            texts += [axis.label, *(tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high)]
        shown = [text for text in texts if text.get_text() and text.get_visible()]
        boxes += [text.get_window_extent() for text in shown]
        legend = axes.get_legend()
        assert legend is not None
        boxes += [text.get_window_extent() for text in legend.get_texts()]
        words = " ".join(text.get_text() for text in shown)
        assert any(unit in words for unit in UNITS)
    for one, other in combinations([box for box in boxes if box.width and box.height], 2):
        overlap = min(one.x1, other.x1) - max(one.x0, other.x0), min(one.y1, other.y1) - max(one.y0, other.y0)
        assert min(overlap) < 2.0  # pixels
    assert max(box.x1 for box in boxes) <= figure.bbox.x1 + 1
    assert min(box.y0 for box in boxes) >= -1


def test_the_spin_is_what_the_run_has() -> None:
    run = simulate(scene(PLAIN, run__samples=401))
    axes = run.plot("angular velocity").axes[0]
    for k, label in enumerate(("ω₁", "ω₂", "ω₃")):
        assert np.array_equal(line(axes, label), np.column_stack([run.time, run.angular_velocity[:, k]]))


@pytest.mark.parametrize(
    ("base", "changes"),
    [
        (PLAIN, {"body__principal_moments": [3.0, 1.0, 2.5]}),
        (PLAIN, {"body__principal_moments": [1.0, 2.0, 1.5], "load": [{"kind": "damping", "coefficient": 0.1}]}),
        (DISC, {"start__angular_velocity": [2.0, 3.0, 5.0]}),
        (DISC, {"body__principal_moments": [0.5, 0.25, 0.25], "constraint__axis": [1, 0, 0]}),
        (TOP, {"start__angular_velocity": [1.0, 2.0, 150.0]}),
    ],
)
def test_axes_are_numbered_as_the_scene_numbers_them(base: dict[str, Any], changes: dict[str, Any]) -> None:
    run = simulate(scene(base, run__duration=0.1, run__accuracy=1e-6, **changes))
    axes = run.plot("angular velocity").axes[0]
    began = [line(axes, label)[0, 1] for label in ("ω₁", "ω₂", "ω₃")]
    np.testing.assert_allclose(began, run.scene.start.angular_velocity, rtol=1e-12)


def test_the_momentum_of_a_driven_body_is_said_from_its_least_to_its_most() -> None:
    braked = [{"kind": "torque", "torque": [0.0, 0.0, -1.0]}]
    run = simulate(scene(PLAIN, start__angular_velocity=[0, 0, 1], load=braked, run__duration=5.0, run__samples=6))
    title = run.plot("momentum sphere").axes[0].get_title()  # from 3 kg m²/s through 0 to 2 kg m²/s the other way
    said = re.search(r"\|L\| = (\S+) … 3 kg m²/s", title)
    assert said
    assert float(said[1]) < 0.1


def test_samples_that_are_far_apart_are_joined_by_what_the_model_gives_between() -> None:
    few, many = (simulate(scene(PLAIN, run__samples=count)) for count in (3, 2001))
    drawn = line(few.plot("angular velocity").axes[0], "ω₂")
    assert len(drawn) > 100
    assert np.abs(np.interp(drawn[:, 0], many.time, many.angular_velocity[:, 1]) - drawn[:, 1]).max() < 1e-4
    (dots,) = [each for each in few.at([1.0, 9.0]).plot("angular velocity").axes[0].lines if each.get_label() == "ω₂"]
    assert (len(dots.get_xdata()), dots.get_linestyle(), dots.get_marker()) == (2, "None", ".")


def test_many_samples_are_thinned_to_their_extent() -> None:
    run = simulate(scene(PLAIN, run__samples=50_001))
    drawn = line(run.plot("angular velocity").axes[0], "ω₂")
    assert len(drawn) < 5000
    assert drawn[:, 1].max() == run.angular_velocity[:, 1].max()
    assert drawn[:, 1].min() == run.angular_velocity[:, 1].min()


def test_the_state_lies_on_the_effective_potential_at_its_energy() -> None:
    run = simulate(scene(TOP))
    axes = run.plot("effective potential").axes[0]
    (state,) = line(axes, "at the start")
    curve, level = line(axes, "V(θ)"), line(axes, "energy E′")
    assert state[0] == run.quantities["theta"][0]
    assert state[1] == pytest.approx(np.interp(state[0], *curve.T), rel=1e-4)
    # It starts at rest on its turning circle: all of E′ is potential.
    assert level[:, 1] == pytest.approx(state[1], rel=1e-9)
    assert level[:, 0] == pytest.approx(run.quantities["turning theta"])
    i1, i3 = 2e-4 + 0.1 * 0.04**2, 1.25e-4  # V = (p_φ − p_ψ cos θ)²/(2 I₁ sin²θ) + M g h cos θ
    spin, tilt = i3 * 150.0, 2 * np.arctan2(0.6, 0.8)
    around = spin * np.cos(tilt)
    theta = curve[:, 0]
    expected = (around - spin * np.cos(theta)) ** 2 / (2 * i1 * np.sin(theta) ** 2) + 0.1 * 9.80665 * 0.04 * np.cos(
        theta
    )
    np.testing.assert_allclose(curve[:, 1], expected, rtol=1e-9)


def test_a_pendulum_has_the_separatrix_of_its_energy() -> None:
    run = run_of("pendulum")
    axes = run.plot("phase portrait").axes[0]
    drawn = line(axes, "the run")
    assert np.array_equal(drawn[:, 0], run.quantities["angle"])
    assert "separatrix" in {each.get_label() for each in axes.lines}
    level = line(axes, "equal energy")
    energy = level[:, 1] ** 2 / 2.0 * 0.3334 - 1.0 * 9.80665 * 0.5 * (1.0 - np.cos(level[:, 0] + np.radians(1.0)))
    shown = level[:, 1] > 0
    assert np.ptp(energy[shown]) < 1e-9 * np.abs(energy[shown]).max()


@pytest.mark.parametrize(("spin", "seen"), [(2.0, False), (4.5, True), (12.0, False)])
def test_a_separatrix_is_in_the_legend_where_it_is_in_the_window(spin: float, seen: bool) -> None:
    """It is at |θ̇| = 2 √(m g l/J) |cos ½θ|, 4.43 rad/s at most."""
    table = {
        "body": {"principal_moments": [1.0, 2.0, 2.5], "mass": 1.0, "center_of_mass": [0.0, 0.0, -1.0]},
        "start": {"angular_velocity": [spin, 0.0, 0.0]},
        "constraint": {"kind": "hinge", "axis": [1.0, 0.0, 0.0]},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 20.0, "samples": 2001},
    }
    axes = simulate(Scene.from_dict(table)).plot("phase portrait").axes[0]
    legend = axes.get_legend()
    assert legend is not None
    assert ("separatrix" in {text.get_text() for text in legend.get_texts()}) == seen
    low, high = axes.get_ylim()
    drawn = [np.asarray(each.get_ydata()) for each in axes.lines]
    assert all(((each >= low) & (each <= high)).any() for each in drawn)


@pytest.mark.parametrize(("duration", "seen"), [(20.0, True), (400.0, False)])
def test_curves_of_equal_energy_are_left_out_where_turns_are_too_many_to_tell(duration: float, seen: bool) -> None:
    table = {
        "body": {"principal_moments": [1.0, 2.0, 2.5], "mass": 1.0, "center_of_mass": [0.0, 0.0, -1.0]},
        "start": {"angular_velocity": [4.6, 0.0, 0.0]},
        "constraint": {"kind": "hinge", "axis": [1.0, 0.0, 0.0]},
        "load": [{"kind": "gravity"}],
        "run": {"duration": duration, "samples": 101, "accuracy": 1e-6},
    }
    axes = simulate(Scene.from_dict(table)).plot("phase portrait").axes[0]
    labels = {each.get_label() for each in axes.lines}
    assert {"equal energy", "separatrix"} & labels == ({"equal energy", "separatrix"} if seen else set())


@pytest.mark.parametrize("samples", [9, 101])
def test_a_stiff_hinge_comes_to_its_pace_within_its_time_constant(samples: int) -> None:
    """I = 2 kg m², c = 200 N m s: −m g l sin(½π)/c is reached to a share of exp(−c t/I), while θ stays."""
    table = {
        "body": {"principal_moments": [1.0, 2.0, 2.5], "mass": 1.0, "center_of_mass": [0.0, 0.0, -1.0]},
        "start": {"angular_velocity": [0.0, 0.0, 0.0], "attitude": [math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]},
        "constraint": {"kind": "hinge", "axis": [1.0, 0.0, 0.0]},
        "load": [{"kind": "gravity"}, {"kind": "damping", "coefficient": 200.0}],
        "run": {"duration": 100.0, "samples": samples},
    }
    angle, rate = line(simulate(Scene.from_dict(table)).plot("phase portrait").axes[0], "the run").T
    pace = 9.80665 / 200.0
    assert rate.min() == pytest.approx(-pace, rel=0.02)
    assert angle[np.argmax(rate < -0.9 * pace)] > -0.01


def test_a_tippe_top_is_seen_to_turn_over() -> None:
    title = run_of("tippe_top").plot("nutation").axes[0].get_title()
    low, high = (float(word) for word in title.split("tilt ")[1].split(" rad")[0].split(" … "))
    assert low < 0.2
    assert high > 3.0


def test_axes_of_any_figure_are_drawn_on_and_nothing_else_is_touched() -> None:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    before = dict(mpl.rcParams)
    run = simulate(scene(PLAIN))
    assert run.plot("polhode", left) is figure
    assert run.plot(ax=left) is figure
    assert left.lines
    assert not right.lines
    assert dict(mpl.rcParams) == before
    script = (
        "import sys, inertia\nfrom inertia_meshes import path\n"
        "inertia.simulate(inertia.Scene.load(path('scenes/t_handle.toml'))).plot()\n"
        "print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_a_kind_that_does_not_suit_or_is_none_is_refused_with_those_that_do() -> None:
    run = simulate(scene(PLAIN))
    with pytest.raises(UsageError, match="'nutation' does not suit this run: use 'polhode' or 'momentum sphere' or"):
        run.plot("nutation")
    with pytest.raises(UsageError, match="'polhod' is no kind of plot: did you mean 'polhode'"):
        run.plot("polhod")
    assert set(KINDS) == {kind for kinds in SUITABLE.values() for kind in kinds}


def test_the_light_theme_does_not_depend_on_the_user_s() -> None:
    with mpl.rc_context({"axes.facecolor": "black", "figure.facecolor": "black"}):
        figure = simulate(scene(PLAIN)).plot("angular velocity")
    assert mpl.colors.to_hex(figure.get_facecolor()) == "#ffffff"
    assert mpl.colors.to_hex(figure.axes[0].get_facecolor()) == "#ffffff"


def test_a_top_that_hangs_or_is_drawn_out_has_plots_without_rounding_in_them() -> None:
    hanging = simulate(scene(TOP, start={"angular_velocity": [5.0, 0.0, 0.0], "attitude": [1.0, 0.0, 0.0, 0.0]}))
    (state,) = line(hanging.plot("effective potential").axes[0], "at the start")
    assert state == pytest.approx([np.pi, -0.1 * 9.80665 * 0.04])
    rod = simulate(scene(PLAIN, body__principal_moments=[1e-12, 1.0, 1.0]))
    assert kinds_of(rod) == ["momentum sphere", "angular velocity"]
