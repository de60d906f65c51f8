"""The bounds of principal moments and axes, as text and as JSON."""

import json
import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mass.parts import box, cells, cube, exact, surface
from tests.mass.spectra import angle, eigenvalues, eigenvectors

import inertia
from inertia.mesh.part import Part, Source
from inertia.report.analysis.document import analysis_document
from inertia.report.analysis.text import analysis_text
from inertia_meshes import path

SLACK = 1 + Fraction(1, 10**9)  # the bounds themselves are rounded


def line_of(text: str, label: str) -> str:
    return next(line for line in text.splitlines() if label in line).strip()


def unsaved(part: Part) -> Part:
    """Return the part as of no file, so that none is read for its SHA-256."""
    return replace(part, source=Source(None, "arrays"))


def test_bounds_in_the_document_hold_against_exact_moments() -> None:
    """The tensor in rational arithmetic, its eigenvalues and eigenvectors to 50 digits."""
    part = inertia.read(path("t_handle.stl"))
    document = json.loads(json.dumps(analysis_document(inertia.analyse(part, 1000.0))))
    truth = exact(part, 1000).inertia
    moments, bounds = document["principal_moments"], document["error"]["principal_moments"]
    for moment, bound, true in zip(moments, bounds, eigenvalues(truth), strict=True):
        assert abs(Fraction(moment) - true) <= Fraction(bound) * true * SLACK
        assert bound < 1e-12
    tilts = document["error"]["principal_axes"]
    for axis, tilt, true_axis in zip(np.transpose(document["principal_axes"]), tilts, eigenvectors(truth), strict=True):
        assert angle(axis, true_axis) <= tilt < 1e-12


def test_axes_of_equal_moments_are_any() -> None:
    cube_ = inertia.analyse(unsaved(surface(cube())))
    assert analysis_document(cube_)["error"]["principal_axes"] == [math.pi / 2] * 3
    assert line_of(analysis_text(cube_), "principal moments").endswith("(relative), axes any, any, any")


def test_the_long_axis_of_a_square_post_is_certain_to_what_the_text_says() -> None:
    post = inertia.analyse(unsaved(surface(cube() * [1, 1, 2])))
    axes = line_of(analysis_text(post), "principal moments").partition("axes ")[2].split(", ")
    long_axis = np.array(analysis_document(post)["principal_axes"])[:, 0]
    assert math.degrees(angle(long_axis, [Fraction(k) for k in (0, 0, 1)])) <= float(axes[0].removesuffix("°")) < 1e-10
    assert axes[1:] == ["any", "any"]


@pytest.mark.parametrize("mass", [1e160, 1e-170])
def test_a_tensor_of_any_size_is_printed(mass: float) -> None:
    """A cube of 1 m: m a²/6 about each axis."""
    text = analysis_text(inertia.analyse(unsaved(surface(cube())), mass=mass))
    assert f"{mass / 6.0:.9e}                 0                 0\n" in text


def test_a_moment_of_nothing_has_no_relative_bound() -> None:
    """A straight wire askew: its moment about itself is zero but for what rounding leaves uncertain."""
    line = inertia.analyse(unsaved(cells("line", [[0, 0, 0], [0.1, 0.7, 0.3]])), wire=1e-6)
    document = json.loads(json.dumps(analysis_document(line), allow_nan=False))
    first, *others = document["error"]["principal_moments"]
    assert first is None or first > 0.1
    assert max(others) < 1e-12
    row = next(k for k in analysis_text(line).splitlines() if k.startswith("  1 "))
    assert row.split()[1:3] == ["0", "0"]


@pytest.mark.parametrize(
    ("text", "options", "zeros"),
    [
        ("v 0 0 0\nv 1 2 2\nl 1 2\n", {"wire": 1.0}, [False, True, True]),
        ("v 0 0 0\nv 3 1 2\nv 1 4 -1\nf 1 2 3\n", {"shell": 1.0}, [False, False, True]),
    ],
)
def test_semi_axes_that_are_rounding_are_printed_as_0(
    text: str, options: dict[str, float], zeros: list[bool], tmp_path: Path
) -> None:
    (tmp_path / "a.obj").write_text(text)
    part = inertia.read(tmp_path / "a.obj", unit="m")
    assert [semi == "0" for semi in semi_axes_of(inertia.analyse(part, 1000.0, **options))] == zeros


@pytest.mark.parametrize("sides", [[3, 3, 3e-3], [3, 3, 3e-6], [3, 3e-6, 3e-6], [3, 3e-9, 3e-9], [2, 1, 0.5]])
def test_semi_axes_of_what_is_thin_are_printed(sides: list[float]) -> None:
    """A box of sides a has the semi-axes a √(5/12)."""
    printed = [float(each) for each in semi_axes_of(inertia.analyse(unsaved(surface(box(*sides))), 1000.0))]
    assert printed == pytest.approx(sorted(np.sqrt(5 / 12) * np.array(sides))[::-1], rel=1e-6)


def semi_axes_of(analysis: inertia.Analysis) -> list[str]:
    line = line_of(analysis_text(analysis), "Equivalent")
    return line.partition("semi-axes ")[2].partition(" m ")[0].split(", ")
