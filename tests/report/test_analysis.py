"""The bounds of principal moments and axes, as text and as JSON."""

import json
import math
from dataclasses import replace

import pytest
from tests.mass.parts import cells, cube, surface

import inertia
from inertia.mesh.part import Part, Source
from inertia.report.analysis import analysis_document, analysis_text
from inertia_meshes import path


def line_of(text: str, label: str) -> str:
    return next(line for line in text.splitlines() if label in line).strip()


def unsaved(part: Part) -> Part:
    """Return the part as of no file, so that none is read for its SHA-256."""
    return replace(part, source=Source(None, "arrays"))


def test_bounds_of_moments_and_axes_are_in_the_document() -> None:
    analysis = inertia.analyse(inertia.read(path("t_handle.stl")))
    error = analysis_document(analysis)["error"]
    principal = analysis.principal
    assert error["principal_moments"] == pytest.approx((principal.moment_bounds / principal.moments).tolist())
    assert error["principal_axes"] == principal.axis_bounds.tolist()
    assert 0 < min(error["principal_axes"]) <= max(error["principal_axes"]) < 1e-12


def test_axes_of_equal_moments_are_any() -> None:
    cube_ = inertia.analyse(unsaved(surface(cube())))
    assert analysis_document(cube_)["error"]["principal_axes"] == [math.pi / 2] * 3
    assert line_of(analysis_text(cube_), "principal moments").endswith("(relative), axes any, any, any")
    post = inertia.analyse(unsaved(surface(cube() * [1, 1, 2])))
    axes = line_of(analysis_text(post), "principal moments").partition("axes ")[2].split(", ")
    assert axes[0] == f"{math.degrees(post.principal.axis_bounds[0]):.2g}°"
    assert axes[1:] == ["any", "any"]


def test_a_moment_of_nothing_has_no_relative_bound() -> None:
    """A straight wire askew: its moment about itself is zero but for what rounding leaves uncertain."""
    line = inertia.analyse(unsaved(cells("line", [[0, 0, 0], [0.1, 0.7, 0.3]])), wire=1e-6)
    document = json.loads(json.dumps(analysis_document(line), allow_nan=False))
    first, *others = document["error"]["principal_moments"]
    assert first is None or first > 0.1
    assert max(others) < 1e-12
    row = next(k for k in analysis_text(line).splitlines() if k.startswith("  1 "))
    assert row.split()[1:3] == ["0", "0"]
