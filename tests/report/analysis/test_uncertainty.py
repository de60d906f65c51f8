"""Standard uncertainties as text and as JSON."""

import json

import pytest

import inertia
from inertia import Estimate
from inertia.report.analysis.document import analysis_document
from inertia.report.analysis.text import analysis_text
from inertia_cli.main import main
from inertia_meshes import path


def cone(**options):
    part = inertia.read(path("cone.stl"), unit="mm")
    return inertia.analyse(part, Estimate(7850, 50), sigma=0.02, **options)


def test_the_document_holds_what_the_library_says() -> None:
    analysis = cone(coverage=2)
    u, document = analysis.uncertainty, json.loads(json.dumps(analysis_document(analysis)["uncertainty"]))
    assert document["inputs"] == {"vertices": pytest.approx(2e-5), "density": 50}
    assert document["mass"] == u.mass
    assert document["inertia"] == u.inertia.tolist()
    assert document["covariance"] == u.covariance.tolist()
    assert document["undetermined"] == [[1, 2]]
    assert document["principal_axes"] == [u.principal_axes[0], None, None]
    assert document["coverage"] == 2
    assert document["expanded"]["principal_moments"] == (2 * u.principal_moments).tolist()
    contributions = [document["components"][name]["mass"] for name in ("vertices", "density")]
    assert sum(k * k for k in contributions) == pytest.approx(u.mass**2)


def test_the_tensor_about_a_point_has_its_own_uncertainty() -> None:
    analysis = cone(about=(10, 0, 0))
    stated = analysis_document(analysis)["inertia_about"]["uncertainty"]
    assert stated == analysis.uncertainty.about([0.01, 0, 0]).tolist()
    assert stated[1][1] > analysis.uncertainty.inertia[1, 1]
    text = analysis_text(cone(about=(10, 0, 0), coverage=2))
    for k in (1, 2):
        shown = ", ".join(f"{k * stated[i][j]:.2g}" for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        assert f"about the point {shown} kg m²," in text


def test_a_notebook_shows_them_too() -> None:
    analysis = cone(about=(10, 0, 0), coverage=2)
    page, u = analysis._repr_html_(), analysis.uncertainty
    for text in (
        "vertices 2e-05 m a coordinate, density 50 kg/m³",
        f"mass {u.mass:.2g} kg",
        f"mass {2 * u.mass:.2g} kg",
        "U, k = 2",
        "About 10, 0, 0 mm",
        f"{analysis.about[1][1, 1]:.10g}",
        f"{analysis.about_uncertainty[1, 1]:.2g}",
    ):
        assert text in page


def test_nothing_is_said_where_nothing_is_uncertain() -> None:
    analysis = inertia.analyse(inertia.read(path("cone.stl"), unit="mm"), 7850)
    assert "uncertainty" not in analysis_document(analysis)
    assert "Uncertainty" not in analysis_text(analysis)


def test_the_text_names_what_is_undetermined() -> None:
    text = analysis_text(cone(coverage=2))
    assert "u (standard uncertainty, GUM) for u of vertices 2e-05 m a coordinate, density 50 kg/m³:" in text
    assert "U = k u (expanded uncertainty), k = 2:" in text
    assert "axes 2 and 3 are undetermined, but for their plane, as I2 and I3 are within 2 u of each other" in text


@pytest.mark.parametrize("sign", ["±", "+-", "+/-"])
def test_the_command_reads_numbers_with_their_uncertainty(sign: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--mass", f"1.2{sign}0.001", "--scale", f"{sign}0.1%", "--sigma", "0.02", "--json"]
    assert main(["analyse", str(path("cube.stl")), *arguments]) == 0
    inputs = json.loads(capsys.readouterr().out)["uncertainty"]["inputs"]
    assert inputs == {"vertices": pytest.approx(2e-5), "mass": 0.001, "scale": 0.001}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--density", "7850±x"], "no number of kg/m³"),
        (["--mass", "1.2±-1"], "must be finite and not negative"),
        (["--scale", "1.02±0.001"], "coordinates are taken as stored"),
        (["--sigma", "nan"], "sigma is nan mm"),
        (["--coverage", "2"], "no input is uncertain"),
        (["--coverage", "95%"], "'95%' is no number, as 2, for about 95 %"),
        (["--sigma", "0.02±0.01"], "'0.02±0.01' is no number, as 0.02"),
        (["--sigma", "1e150", "--unit", "km"], "the standard uncertainties of the inputs lead to variances above"),
    ],
)
def test_what_is_no_uncertainty_is_refused(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main(["analyse", str(path("cube.stl")), *arguments])
    except SystemExit as exit_:
        code = exit_.code
    assert code == 2
    assert said in capsys.readouterr().err


def test_what_is_written_for_another_program_states_the_uncertainty(capsys: pytest.CaptureFixture[str]) -> None:
    main(["analyse", str(path("cube.stl")), "--mass", "1.2±0.001", "--as", "urdf"])
    assert "mass 0.001 kg (0.083 %)" in capsys.readouterr().out
