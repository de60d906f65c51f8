"""`inertia assembly` and `inertia budget`: what they print, write and refuse."""

import csv
import json
from pathlib import Path

import pytest

from inertia_cli.main import main
from inertia_meshes import path

FAN = str(path("assemblies/fan.toml"))
BALL = '[[part]]\nname = "ball"\nshape = "point"\nmass = "1±0.1"\n[[limit]]\nwhat = "mass"\nmax = {}\n'


def test_the_budget_as_a_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["budget", FAN, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "inertia/budget/1"
    assert document["verdict"] == "pass"
    total = document["total"]
    assert sum(part["basic_mass"] for part in document["parts"]) == pytest.approx(total["mass"], rel=1e-14)
    assert total["predicted_mass"] == pytest.approx(total["mass"] + total["allowance"])
    impeller = document["parts"][0]
    assert [part["quantity"] for part in impeller["parts"]] == [1, 9]
    shares = [each["share"]["mass"] for each in total["contributors"]]
    assert sum(shares) == pytest.approx(1)
    assert [limit["verdict"] for limit in document["limits"]] == ["pass"] * 3


def test_the_assembly_as_a_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assembly", FAN, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "inertia/assembly/1"
    assert document["error"]["inertia"] < 1e-14
    assert main(["assembly", "--schema"]) == 0
    assert "part" in json.loads(capsys.readouterr().out)["properties"]


@pytest.mark.parametrize(("limit", "code", "verdict"), [(2.0, 0, "PASS"), (1.1, 4, "UNDECIDED"), (0.5, 5, "FAIL")])
def test_the_exit_code_is_the_verdict(
    limit: float, code: int, verdict: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.toml").write_text(BALL.format(limit), encoding="utf-8")
    assert main(["budget", str(tmp_path / "a.toml")]) == code
    assert capsys.readouterr().out.startswith(f"Budget            a: {verdict}\n")


def test_the_table_has_a_row_for_each_line(tmp_path: Path) -> None:
    assert main(["budget", FAN, "--csv", str(tmp_path / "fan.csv")]) == 0
    with (tmp_path / "fan.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["part"] for row in rows] == [
        "Fan",
        "impeller",
        "impeller/hub",
        "impeller/blade",
        "shaft",
        "motor",
        "screw",
    ]
    assert float(rows[0]["basic_mass"]) == pytest.approx(sum(float(row["basic_mass"]) for row in rows[2:]))
    assert main(["budget", FAN, "--csv", str(tmp_path / "fan.csv")]) == 2


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("[[part]]\nshape = 'point'\n", 2, "part[0].name is missing: it has to be given"),
        ("[[part]]\nname = 'g'\n", 2, "it has no part with a mass: give one a file, a shape or a mass"),
        ("[[part]]\nname = 'g'\nfile = 'no.stl'\n", 3, "no.stl: there is no such file: check the path"),
        ("[[limit]]\nwhat = 'mass'\nmax = 1\n", 2, "part is missing"),
        ("[[part]]\nname = 'g'\nmass = 1\n[[limit]]\nwhat = 'inertia.zx'\nmax = 1\n", 2, "did you mean inertia."),
        ("not toml", 3, "it is not TOML"),
    ],
)
def test_what_cannot_be_is_one_sentence(
    text: str, code: int, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    assert main(["budget", str(tmp_path / "a.toml")]) == code
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert "Traceback" not in error
