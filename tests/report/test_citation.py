"""What is cited is what the methods of an answer are from."""

import json
import re
from pathlib import Path

import pytest

import inertia
from inertia.dynamics.integrators.methods import METHODS
from inertia.dynamics.models.catalogue import MODELS
from inertia_cli.main import main
from inertia_meshes import path

SOURCES = (Path(inertia.__file__).parent / "report/sources.bib").read_text(encoding="utf-8")


def keys(bibtex: str) -> list[str]:
    return re.findall(r"^@\w+\{([\w-]+),$", bibtex, re.MULTILINE)


@pytest.mark.parametrize("name", [*METHODS, *(model.name for model in MODELS)])
def test_every_method_and_model_of_motion_has_a_source_or_a_method(name: str) -> None:
    own = {"scaled free motion", "Euler equations"}  # derived here; stepped by a method that has a source
    assert len(keys(inertia.cite({"schema": "inertia/run/1", "model": name}))) > 1 or name in own


@pytest.mark.parametrize(
    ("arguments", "cited"),
    [
        (["analyse", "cube.stl"], {"Higham2002", "Ozaki2012"}),
        (["analyse", "cube.stl", "--accuracy", "exact", "--density", "1000±1"], {"GUM"}),
        (["simulate", "scenes/t_handle.toml", "--samples", "3"], {"Zon2007", "Bulirsch1965", "Carlson1995"}),
        (["simulate", "scenes/cat.toml", "--samples", "3"], {"Cline2018", "Hairer2006"}),
        (["balance", "rotors/disc.toml"], {"ISO21940-11"}),
        (["balance", "measure", "jobs/fan.toml"], {"Goodman1964"}),
    ],
)
def test_the_methods_that_ran_are_cited(
    arguments: list[str],
    cited: set[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(path("cube.stl").parent)
    main([*arguments, "--json"])
    document = tmp_path / "document.json"
    document.write_text(capsys.readouterr().out, encoding="utf-8")
    assert main(["cite", str(document)]) == 0
    bibtex = capsys.readouterr().out
    assert set(keys(bibtex)) == {"inertia"} | cited
    assert bibtex == inertia.cite(json.loads(document.read_text(encoding="utf-8")))


def test_a_method_of_its_own_is_not_cited_as_one_of_scipy_s() -> None:
    named = [
        set(keys(inertia.cite({"schema": "inertia/run/1", "method": method})))
        for method in ("Radau collocation of 24 nodes", "Radau")
    ]
    assert named == [{"inertia", "Hairer1996"}, {"inertia", "Hairer1996", "Virtanen2020"}]


def test_entries_are_well_formed() -> None:
    assert len(keys(SOURCES)) == SOURCES.count("\n@") + 1
    for entry in SOURCES.strip().split("\n\n"):
        assert entry.count("{") == entry.count("}")
        assert {"author", "title", "year", "where"} <= set(re.findall(r"(\w+) = \{", entry))
    whole = inertia.cite({"schema": "inertia/run/1", "model": "asymmetric top", "method": "DOP853"})
    assert "where = " not in whole


def test_what_is_no_document_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(inertia.UsageError, match="no document of inertia"):
        inertia.cite({"schema": "other/1"})
    file = tmp_path / "part.stl"
    file.write_text("solid")
    assert main(["cite", str(file)]) == 3
    assert "is no JSON document: name what --json printed" in capsys.readouterr().err
    assert main(["cite", str(tmp_path / "nothing.json")]) == 3
    assert capsys.readouterr().err.endswith(": check the path\n")
