"""A run in a notebook: valid, escaped, and readable on light and dark pages."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.dynamics.scenes import PLAIN, TOP, scene

from inertia.dynamics.notebook import curves_svg
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.notebook import COLORS
from inertia_meshes import path

SVG = "{http://www.w3.org/2000/svg}"


def test_the_table_says_what_ran_and_the_sketch_shows_the_spin() -> None:
    run = simulate(scene(PLAIN))
    page = ElementTree.fromstring(run._repr_html_())
    cells = [row[0].text for row in page.iter("tr")]
    assert cells == ["Scene", "Model", "Run", "Accuracy", "Kept", "Kept", "Motion"]
    assert "asymmetric top, closed form" in run._repr_html_()
    curves = page.findall(f".//{SVG}polyline")
    assert [curve.get("stroke") for curve in curves] == list(COLORS)
    places = np.array([[float(x) for x in pair.split(",")] for pair in str(curves[2].get("points")).split()])
    assert len(places) == 11
    assert np.argmin(places[:, 1]) == np.argmax(run.angular_velocity[:, 2])  # up is less
    assert "rad/s along the principal axes" in "".join(page.itertext())


def test_text_from_outside_is_escaped() -> None:
    run = simulate(scene(TOP))
    evil = "<script>alert(1)</script>\"'&\x1b[31m"
    text = replace(run, warnings=(evil,), remarks=(evil,))._repr_html_()
    assert "<script" not in text
    assert "\x1b" not in text
    page = ElementTree.fromstring(text)
    assert sum("<script>alert(1)</script>\"'&" in str(cell.text) for cell in page.iter("td")) == 2
    named = Scene(
        run.scene.body, run.scene.start, run.scene.run, run.scene.constraint, run.scene.applied_loads, name=evil
    )
    ElementTree.fromstring(simulate(named)._repr_html_())


def _luminance(color: str) -> float:
    channels = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


@pytest.mark.parametrize("page", ["#ffffff", "#111111"])
def test_colours_are_told_from_a_light_page_and_a_dark_one(page: str) -> None:
    for color in COLORS:
        dark, light = sorted([_luminance(color), _luminance(page)])
        assert (light + 0.05) / (dark + 0.05) > 3  # WCAG 2.1, 1.4.11
    text = simulate(scene(PLAIN))._repr_html_()
    assert set(re.findall(r"#[0-9A-Fa-f]{6}", text)) == set(COLORS)  # all else is the page's own
    assert "<style" not in text


def test_a_million_samples_are_a_small_page_that_shows_every_peak() -> None:
    time = np.linspace(0.0, 1.0, 1_000_000)
    curve = np.zeros((len(time), 1))
    curve[123_456] = 5.0
    text = curves_svg(time, curve, ["ω"], "rad/s")
    assert len(text) < 20_000
    assert ">5</text>" in text
    points = re.search(r'points="([^"]*)"', text)
    assert points is not None
    heights = [float(pair.split(",")[1]) for pair in points[1].split()]
    assert min(heights) < max(heights) - 80


@pytest.mark.parametrize("instants", [[0.5], [0.0, 0.0]])
def test_a_run_at_one_instant_is_shown_too(instants: list[float]) -> None:
    ElementTree.fromstring(simulate(scene(PLAIN)).at(instants)._repr_html_())


def test_a_body_that_changes_its_shape_is_shown_along_its_part_axes() -> None:
    text = simulate(Scene.load(path("scenes/cat.toml")))._repr_html_()
    assert "along the part axes" in text
    ElementTree.fromstring(text)
