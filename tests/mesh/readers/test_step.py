"""STEP: the chord tolerance that the reader chose is stated, and what follows from it covers the true solid."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import CORNERS, QUADS
from tests.mesh.readers.step_sample import step_cone, step_solid, step_sphere, step_torus

import inertia
from inertia_cli.main import main

pytest.importorskip("OCP")

MM = 1e-3


def ball(r: float) -> tuple[float, list[float], list[float]]:
    """Return volume, centre and principal inertia for a density of one, as the functions below do."""
    volume = 4 / 3 * math.pi * r**3
    return volume, [0, 0, 0], [0.4 * volume * r**2] * 3


def cylinder(r: float, h: float) -> tuple[float, list[float], list[float]]:
    volume = math.pi * r**2 * h
    across = volume * (3 * r**2 + h**2) / 12
    return volume, [0, 0, h / 2], [across, across, volume * r**2 / 2]


def cone(a: float, b: float, h: float) -> tuple[float, list[float], list[float]]:
    """With r = a + k z: ∫π r², ∫π r² z, ∫π r² z² and ∫π r⁴/4."""
    k = (b - a) / h
    r2 = np.polynomial.Polynomial([a, k]) ** 2
    z = np.polynomial.Polynomial([0, 1])

    def integral(of: np.polynomial.Polynomial) -> float:
        return float(math.pi * of.integ()(h))

    volume, first, second, quarter = (integral(of) for of in (r2, r2 * z, r2 * z**2, r2**2 / 4))
    across = quarter + second - first**2 / volume
    return volume, [0, 0, first / volume], [across, across, 2 * quarter]


def torus(major: float, minor: float) -> tuple[float, list[float], list[float]]:
    volume = 2 * math.pi**2 * major * minor**2
    across = volume * (4 * major**2 + 5 * minor**2) / 8
    return volume, [0, 0, 0], [across, across, volume * (4 * major**2 + 3 * minor**2) / 4]


SOLIDS = {
    "ball": (step_sphere(10.0), ball(10 * MM)),
    "cylinder": (step_cone(10.0, 10.0, 100.0), cylinder(10 * MM, 100 * MM)),
    "disc": (step_cone(50.0, 50.0, 0.1), cylinder(50 * MM, 0.1 * MM)),
    "cone": (step_cone(2.0, 9.0, 5.0), cone(2 * MM, 9 * MM, 5 * MM)),
    "flat cone": (step_cone(1.0, 90.0, 5.0), cone(1 * MM, 90 * MM, 5 * MM)),
    "ring": (step_torus(10.0, 3.0), torus(10 * MM, 3 * MM)),
    "thin ring": (step_torus(100.0, 1.0), torus(100 * MM, 1 * MM)),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_the_stated_bound_covers_the_true_solid(name: str, tmp_path: Path) -> None:
    text, (volume, center, inertia_moments) = SOLIDS[name]
    (tmp_path / "part.step").write_text(text)
    part = inertia.read(tmp_path / "part.step")
    analysis = inertia.analyse(part, 1.0, tessellated=True)
    bound, properties = analysis.tessellation, analysis.properties
    assert bound is not None
    assert abs(properties.volume - volume) <= bound.volume * properties.volume
    assert np.linalg.norm(properties.center_of_mass - center) <= bound.center_of_mass
    off = np.linalg.norm(properties.inertia - np.diag(inertia_moments))
    assert off <= bound.inertia * np.linalg.norm(properties.inertia)
    if name != "thin ring":  # whose mesh is too large inside and too small outside, which the bound adds up
        assert bound.volume * properties.volume < 5 * abs(properties.volume - volume)
    equal = sorted(len(group) for group in analysis.principal.equal)
    assert equal[-1] == (3 if name == "ball" else 2)
    true = inertia.analyse(part, 1.0, accuracy=1e-9)
    assert true.tessellation is None
    assert true.properties.volume == pytest.approx(volume, rel=1e-13)
    assert true.properties.inertia == pytest.approx(np.diag(inertia_moments), rel=1e-12, abs=1e-12 * inertia_moments[2])


def test_every_output_states_the_tolerance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "ball.step"
    file.write_text(step_sphere(10.0))
    chord = inertia.read(file).chord
    assert chord is not None
    assert main(["analyse", str(file), "--json", "--tessellated"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert 4e-4 < document["error"]["tessellation"]["volume"] < 1e-3
    assert f"{chord.max():.3g} mm that reading chose" in document["error"]["tessellation"]["method"]
    assert document["class"] == "spherical"
    assert main(["analyse", str(file), "--tessellated"]) == 0
    assert "that reading chose" in capsys.readouterr().out
    assert main(["check", str(file)]) == 0
    assert f"{chord.max():.2g} mm off" in capsys.readouterr().out
    assert main(["analyse", str(file), "--chord", "1e-5"]) == 2
    assert "use --tessellated" in capsys.readouterr().err
    assert main(["analyse", str(file), "--chord", "1e-5", "--tessellated"]) == 0
    assert "bounds from the chord tolerance 1e-05 mm\n" in capsys.readouterr().out


def test_plane_faces_are_off_by_rounding_alone(tmp_path: Path) -> None:
    (tmp_path / "box.stp").write_text(step_solid(CORNERS, QUADS.tolist(), "Block"))
    bound = inertia.analyse(inertia.read(tmp_path / "box.stp"), tessellated=True).tessellation
    assert bound is not None
    assert bound.volume < 1e-13


def test_a_shell_and_a_repaired_part_keep_what_they_can(tmp_path: Path) -> None:
    (tmp_path / "ball.step").write_text(step_sphere(10.0))
    part = inertia.read(tmp_path / "ball.step")
    assert inertia.analyse(part, shell=1e-3).tessellation is None
    mended = inertia.repair(part, 1e-7).part
    assert mended.chord is not None
    assert len(mended.chord) == mended.triangles.count
    assert mended.chord.max() >= part.chord.max()  # type: ignore[union-attr]
