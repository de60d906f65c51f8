"""Unbalance of bodies with noisy vertices, uncertain densities and masses, against Monte Carlo and closed forms."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.solids import cube, sphere

import inertia
from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.bounds import propagated
from inertia.balancing.unbalance import Unbalance
from inertia.errors import UsageError
from inertia.mesh.part import Part
from inertia_cli.main import main
from inertia_meshes import path


def seen_from(shaft: Shaft, vertices: Float, faces: np.ndarray, z: float) -> tuple[np.ndarray, np.ndarray]:
    """Return U and D about the plane z of solids (..., v, 3) of unit density, from their tetrahedra in shaft axes."""
    a, b, c = (shaft.to_shaft(vertices)[..., corner, :] for corner in faces.T)
    d = np.vecdot(a, np.cross(b, c))[..., None]
    s = a + b + c
    first = (d * s).sum(axis=-2) / 24
    with_z = sum((d * x * x[..., 2:]).sum(axis=-2) for x in (s, a, b, c)) / 120
    u, w = (k[..., 0] + 1j * k[..., 1] for k in (first, with_z))
    return u, w - z * u


def test_noise_of_vertices_moves_the_unbalance_as_stated() -> None:
    vertices, faces = sphere((0.2, -0.1, 0.7), 1.0, 1)
    vertices, faces = np.asarray(vertices) * [1.0, 1.4, 0.8], np.asarray(faces)
    shaft = Shaft([0.1, 0.0, -1.0], [-0.2, 0.3, 2.0], [1.0, 0.5, 0.0])
    sigma, z = 0.01, 0.4
    u = inertia.analyse(Part.from_arrays(vertices, faces), 1.0, sigma=sigma).uncertainty
    source = propagated("vertices", u.components["vertices"], u.properties, shaft, z)
    modes = np.array(source.modes)
    rng = np.random.default_rng(1)
    draws = np.transpose(seen_from(shaft, vertices + rng.normal(0, sigma, (10_000, *vertices.shape)), faces, z))
    parts = np.column_stack([draws[:, 0].real, draws[:, 0].imag, draws[:, 1].real, draws[:, 1].imag])
    stated = np.column_stack([modes[:, 0].real, modes[:, 0].imag, modes[:, 1].real, modes[:, 1].imag])
    covariance, drawn = stated.T @ stated, np.cov(parts.T)
    scale = np.sqrt(np.outer(covariance.diagonal(), covariance.diagonal()))
    np.testing.assert_allclose(covariance / scale, drawn / scale, atol=0.05)
    seen = np.abs(0.6 * (draws[:, 0] - draws[:, 0].mean()) + 1.5 * (draws[:, 1] - draws[:, 1].mean()))
    assert (seen <= source.bound(0.6, 1.5)).mean() > 0.95
    moved = source.about(0.3)
    np.testing.assert_allclose(
        np.array(propagated("vertices", u.components["vertices"], u.properties, shaft, z + 0.3).bound(1.0, 2.0)),
        moved.bound(1.0, 2.0),
    )


def test_a_density_moves_the_unbalance_of_its_body_in_proportion() -> None:
    vertices, faces = cube((0.3, 0.0, 0.5))
    shaft = Shaft([0, 0, 0], [0, 0, 2.0], [1.0, 0, 0])
    analysis = inertia.analyse(Part.from_arrays(vertices, faces), inertia.Estimate(2.0, 0.1))
    u = analysis.uncertainty
    source = propagated("density", u.components["density"], u.properties, shaft, 1.0)
    alone = Unbalance.of(analysis.properties, shaft)
    ((static, couple),) = source.modes
    sign = 1 if static.real > 0 else -1
    assert sign * static == pytest.approx(0.05 * alone.static)
    assert sign * couple == pytest.approx(0.05 * alone.couple_about(1.0))


def write_rotor(folder: Path, body: str, more: str = "") -> Path:
    file = folder / "rotor.toml"
    file.write_text(
        f"""
[[body]]
file = "{path("two_disc_rotor.stl").as_posix()}"
chord_tolerance = 0.0
{body}
[axis]
bearing_a = [0, 0, 20]
bearing_b = [0, 0, 280]
[service]
rpm = 3000
[tolerance]
grade = 6.3
[[plane]]
id = "I"
z = 90
method = "drill_radial"
diameters = [8, 10, 12]
[[plane]]
id = "II"
z = 215
method = "drill_radial"
diameters = [12, 16]
{more}
""",
        encoding="utf-8",
    )
    return file


def test_noise_and_density_stand_in_the_bounds_and_in_the_table(tmp_path: Path) -> None:
    plain = inertia.balance(inertia.Rotor.load(write_rotor(tmp_path, "density = 7850")))
    rotor = inertia.Rotor.load(write_rotor(tmp_path, 'density = "7850±50"\nsigma = 0.01'))
    noisy = inertia.balance(rotor)
    assert "input" not in plain.verdict.planes[0].bounds
    names = [line.name for line in noisy.scatter.sensitivities]
    assert names.count("vertices of two_disc_rotor.stl") == names.count("density of two_disc_rotor.stl") == 1
    (line,) = (k for k in noisy.scatter.sensitivities if k.name == "vertices of two_disc_rotor.stl")
    parts = [k for k in noisy.residual.uncertainties if k.source == "input"]
    assert [k.bodies[0].split(" ")[0] for k in parts] == ["vertices", "density"]
    (vertices, density) = parts
    bounds = noisy.verdict.planes[0].bounds["input"]
    assert 2 * line.at_spread[0] < bounds
    assert noisy.scatter.residual_95[0] > plain.scatter.residual_95[0]
    # δU/U of the whole rotor is that of its density, before correction.
    at_start = [k for k in noisy.initial.uncertainties if k.source == "input"][1]
    assert at_start.bound(1.0, 0.0) == pytest.approx(2 * 50 / 7850 * abs(noisy.initial.static))
    # What is drilled out is in proportion to the density as well, and so is what is left.
    assert density.bound(1.0, 0.0) == pytest.approx(2 * 50 / 7850 * abs(noisy.residual.static))
    assert density.bound(1.0, 0.0) < 0.01 * at_start.bound(1.0, 0.0)
    assert vertices.cause is None


def test_noise_that_covers_the_limit_leaves_it_undecided(tmp_path: Path) -> None:
    result = inertia.balance(inertia.Rotor.load(write_rotor(tmp_path, 'material = "steel"\nsigma = 2.0')))
    assert result.verdict.outcome == "undecided"
    assert any("a smaller uncertainty of the input" in why for why in result.verdict.why)


def test_a_rotor_file_keeps_its_uncertainties(tmp_path: Path) -> None:
    rotor = inertia.Rotor.load(write_rotor(tmp_path, 'mass = "11.01+-0.005"\nsigma = 0.01'))
    assert rotor.to_dict()["body"][0]["mass"] == "11.01±0.005"
    assert inertia.Rotor.from_dict(rotor.to_dict()).fields.body[0].mass.uncertainty == 0.005


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('density = "heavy"', r"body\[0\].density"),
        ('density = "-7850±50"', "must be positive"),
        ('mass = "1±-1"', "not negative"),
        ("density = 7850\nsigma = 0", r"body\[0\].sigma"),
    ],
)
def test_what_is_no_uncertainty_is_refused_by_its_path(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        inertia.Rotor.load(write_rotor(tmp_path, body))


def test_a_tolerance_of_all_densities_leaves_out_a_body_with_its_own(tmp_path: Path) -> None:
    more = "[uncertainty]\ndensity = 0.02"
    own = inertia.balance(inertia.Rotor.load(write_rotor(tmp_path, 'density = "7850±50"', more)))
    common = inertia.balance(inertia.Rotor.load(write_rotor(tmp_path, "density = 7850", more)))
    assert math.isclose(common.initial.bounds_of(1.0, 0.0)["density"], 0.02 * abs(common.initial.static))
    assert "density" not in own.initial.bounds_of(1.0, 0.0)


def test_the_options_of_the_command_say_the_same_as_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    part = str(path("two_disc_rotor.stl"))
    shaft = ["--axis", "z", "--bearings", "20,280", "--rpm", "3000", "--grade", "6.3"]
    assert main(["balance", part, *shaft, "--density", "7850±50", "--sigma", "0.01", "--to-toml"]) == 0
    body = tomllib.loads(capsys.readouterr().out)["body"][0]
    assert (body["density"], body["sigma"]) == ("7850.0±50.0", 0.01)
    assert main(["balance", part, *shaft, "--sigma", "-1"]) == 2
    assert "--sigma is -1.0" in capsys.readouterr().err
