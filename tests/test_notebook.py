"""Results in a notebook: valid, escaped tables; ellipsoids as they are seen; plots on any axes, no global state."""

import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

import inertia
from inertia.mesh.part import CellBlock, Cells, Part
from inertia.notebook import EYE, ellipsoid_svg, outline, seen
from inertia.units import length_unit
from inertia_meshes import path

SHOWN: dict[str, Callable[[], Any]] = {
    "Part": lambda: inertia.read(path("t_handle.stl")),
    "MassProperties": lambda: inertia.mass_properties(inertia.read(path("t_handle.stl"), unit="mm"), 7850),
    "Analysis": lambda: inertia.analyse(inertia.read(path("t_handle.stl"), unit="mm"), 7850),
    "Balance": lambda: inertia.balance(inertia.Rotor.load(path("rotors/disc.toml"))),
    "corrected": lambda: inertia.balance(inertia.Rotor.load(path("rotors/bent_wheel.toml"))),
    "Budget": lambda: inertia.Assembly.load(path("assemblies/cubesat.toml")).budget(),
    "Audit": lambda: inertia.audit(path("robots/arm.urdf")),
    "Run": lambda: inertia.simulate(inertia.Scene.load(path("scenes/t_handle.toml"))),
}


CORNERS = np.vstack([np.zeros(3), np.eye(3)])
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
TABLES: dict[str, tuple[Callable[[], Any], str]] = {
    "Report": (
        lambda: inertia.check(inertia.read(path("broken/missing_face.stl"))),
        "Verdict not fit for integration: 1 fault",
    ),
    "Repaired": (lambda: inertia.repair(inertia.read(path("broken/missing_face.stl"))), "Changed holes filled: 1"),
    "Union": (lambda: inertia.unite(inertia.read(path("cube.stl"))), "Counted more than once 0 mm³"),
    "Many": (lambda: inertia.many([CORNERS, -CORNERS], FACES, 6.0), "Bodies 2, 1 of them answered"),
    "Principal": (lambda: inertia.principal(np.diag([1.0, 2.0, 3.0])), "Axis 2 2 kg m² about (0, 1, 0)"),
    "Sensitivity": (
        lambda: inertia.sensitivity(inertia.Scene.load(path("scenes/t_handle.toml"))),
        "Start turned 1 rad per rad",
    ),
    "Ensemble": (
        lambda: inertia.ensemble(
            inertia.Scene.load(path("scenes/t_handle.toml")), {"start.angular_velocity": "±0.005"}, 10, jobs=1
        ),
        "Draws 10, seed 0: 10 followed",
    ),
    "Measurement": (lambda: inertia.measure(inertia.Job.load(path("jobs/fan.toml"))), "Runs 4"),
    "Trade": (
        lambda: inertia.trade(inertia.read(path("cube.stl"), unit="mm"), 1e-6, repeats=1),
        "Take For 1e-6: ",
    ),
}
"""Results without a plot of their own, and a row that they have."""


@pytest.fixture(scope="module", params=SHOWN)
def shown(request: pytest.FixtureRequest) -> Any:
    return SHOWN[request.param]()


def rows_of(html: str) -> list[tuple[str, str]]:
    assert "object at 0x" not in html
    page = ElementTree.fromstring(html)
    rows = [("".join(row[0].itertext()), "".join(row[1].itertext())) for row in page.iter("tr")]
    assert all(label and value for label, value in rows)
    return rows


def test_a_result_is_a_table_of_valid_html(shown: Any) -> None:
    assert len(rows_of(shown._repr_html_())) >= 3


@pytest.mark.parametrize("name", TABLES)
def test_what_has_no_plot_is_a_table_too(name: str) -> None:
    make, expected = TABLES[name]
    assert any(f"{label} {value}".startswith(expected) for label, value in rows_of(make()._repr_html_()))


def test_a_result_draws_itself_on_a_figure_of_its_own_or_on_axes_that_are_given(shown: Any) -> None:
    figure = shown.plot()
    assert isinstance(figure, Figure)
    assert pickle.loads(pickle.dumps(figure))._repr_png_().startswith(b"\x89PNG")  # as a notebook asks for it
    assert figure.axes
    mine = Figure()
    left, _ = mine.subplots(1, 2)
    assert shown.plot(ax=left) is mine
    mine.canvas.draw()
    assert left.has_data()


def test_names_from_outside_are_escaped() -> None:
    part = SHOWN["Part"]()
    evil = "<script>alert(1)</script>\x1b[31m"
    text = replace(part, notes=(evil,), source=replace(part.source, path=evil))._repr_html_()
    assert "<script" not in text
    assert "\x1b" not in text


def test_cells_are_drawn_by_their_outside() -> None:
    """A bar of two regions: what is drawn fills it, and a part by itself says how."""
    part = inertia.read(path("two_region_bar.vtk"))
    assert isinstance(part.geometry, Cells)
    assert "cells" in part._repr_html_()
    with pytest.raises(
        inertia.GeometryError, match=r"mesh of cells.*: draw its outside by inertia\.analyse\(part\)\.plot"
    ):
        part.plot()
    axes = inertia.analyse(part, {"1": 2700.0, "2": 7850.0}).plot().axes[0]
    (faces,) = axes.collections
    drawn = np.concatenate([each.vertices for each in faces.get_paths()])
    nodes = part.geometry.points[np.unique(np.concatenate([block.nodes for block in part.geometry.blocks]))]
    corners = float(part.unit.metres) * seen(nodes)
    np.testing.assert_allclose(
        [drawn.min(axis=0), drawn.max(axis=0)], [corners.min(axis=0), corners.max(axis=0)], atol=1e-12
    )
    assert len(axes.lines) == 4  # the ellipsoid and its axes


@pytest.mark.parametrize(("kind", "nodes", "order"), [("line", [[0, 1]], [0, 1]), ("line3", [[0, 1, 2]], [0, 2, 1])])
def test_wires_are_drawn_along_their_nodes(kind: str, nodes: list[list[int]], order: list[int]) -> None:
    points = np.array([[0.0, 0, 0], [2, 0, 1], [1, 1, 0]])
    part = Part(Cells(points, (CellBlock(kind, np.array(nodes)),)), length_unit("m"), "option")
    (lines,) = inertia.analyse(part, 1000.0, wire=1.0).plot().axes[0].collections
    (line,) = lines.get_paths()
    np.testing.assert_allclose(line.vertices, seen(points[order]))


def test_the_outline_is_that_of_the_ellipsoid() -> None:
    random = np.random.default_rng(5)
    axes, semi = np.linalg.qr(random.normal(size=(3, 3)))[0], np.array([3.0, 1.0, 0.4])
    edge = outline(semi, axes)
    way = random.normal(size=(20_000, 3))
    surface = (axes * semi) @ (way / np.linalg.norm(way, axis=1)[:, None]).T
    toward = EYE / np.linalg.norm(EYE)
    right = np.cross([0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    for angle in np.linspace(0.0, np.pi, 7):  # support functions: how far each reaches in a direction
        reach = (np.cos(angle) * right + np.sin(angle) * up) @ surface
        assert (edge @ [np.cos(angle), np.sin(angle)]).max() == pytest.approx(reach.max(), rel=5e-3)


def test_a_flat_body_has_a_sketch() -> None:
    assert "nan" not in ellipsoid_svg(np.array([1.0, 0.5, 0.0]), np.eye(3))
    assert "nan" not in ellipsoid_svg(np.zeros(3), np.eye(3))


def test_pyplot_is_not_loaded() -> None:
    code = (
        "import sys, inertia\nfrom inertia_meshes import path\n"
        "inertia.read(path('cube.stl')).plot()\nprint('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout.strip() == "False"
