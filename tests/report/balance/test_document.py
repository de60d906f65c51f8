"""Text, JSON, CSV and HTML say the same figures, as all are made from one `ReportData`."""

import csv
import io
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from inertia.balancing.balance import balance
from inertia.balancing.rotor import Rotor
from inertia.mesh.part import Part
from inertia.mesh.read import read
from inertia.mesh.write import write_stl
from inertia.report.balance.data import ReportData
from inertia.report.balance.document import balance_csv, balance_document
from inertia.report.balance.figures import report_data
from inertia.report.balance.html import balance_html
from inertia.report.balance.text import balance_text
from inertia_meshes import path


def marked() -> ReportData:
    """Return the report of case 14 whose first bearing has a vector, a force and a limit of its own."""
    data = report_data(balance(Rotor.load(path("rotors/two_disc_rotor.toml"))))
    a, b = data.bearings
    initial = replace(data.initial, bearings=(0.4321e-3 + 0j, data.initial.bearings[1]), forces=(76.54, 1.0))
    return replace(data, initial=initial, bearings=(replace(a, permissible=98.76e-6), b))


def test_a_figure_is_the_same_in_text_json_csv_and_html() -> None:
    data = marked()
    plane = json.loads(json.dumps(balance_document(data)))["tolerance_planes"][0]
    assert (round(plane["unbalance"]["gmm"], 9), plane["unbalance"]["deg"]) == (432.1, 0.0)
    assert (plane["bearing_force_N"], round(plane["permissible_gmm"], 9)) == (76.54, 98.76)
    row = next(csv.DictReader(io.StringIO(balance_csv(data))))
    assert [float(row[f"unbalance_{key}"]) for key in ("gmm", "deg")] == [*plane["unbalance"].values()]
    assert float(row["permissible_gmm"]) == plane["permissible_gmm"]
    line = next(line for line in balance_text(data).splitlines() if line.startswith("A  "))
    assert line.split()[2:6] == ["98.76", "432.1", "0.0°", "76.54"]
    page = balance_html(data)
    assert all(figure in page for figure in ("432.1 <br>∠ 0.0°", "<td>76.54</td>", "<td>98.76</td>"))


def test_a_rotor_that_nothing_is_done_to_has_the_same_state_before_and_after() -> None:
    rotor = Rotor.load(path("rotors/two_disc_rotor.toml"))
    document = balance_document(report_data(balance(Rotor.from_dict(rotor.to_dict() | {"plane": []}, rotor.folder))))
    assert document["correction"] is None
    assert document["corrections"] == []
    assert document["residual"]["tolerance_planes"] == document["tolerance_planes"]


INCHES = """
unit = "in"
[[body]]
file = "two_disc_rotor.stl"
unit = "mm"
density = "7850±50"
[axis]
bearing_a = [0, 0, 0.78740157480315]
bearing_b = [0, 0, 11.0236220472441]
[service]
rpm = 3000
[tolerance]
grade = 6.3
[[plane]]
id = "I"
z = 3.54330708661417
method = "drill_radial"
diameters = [0.375, 0.5]
[[plane]]
id = "II"
z = 8.46456692913386
method = "drill_radial"
diameters = [0.5, 0.625]
"""


def test_a_rotor_in_inches_is_reported_in_millimetres_without_the_noise_of_the_conversion(tmp_path: Path) -> None:
    (tmp_path / "two_disc_rotor.stl").write_bytes(path("two_disc_rotor.stl").read_bytes())
    (tmp_path / "rotor.toml").write_text(INCHES, encoding="utf-8")
    data = report_data(balance(Rotor.load(tmp_path / "rotor.toml")))
    document = balance_document(data)
    work = document["corrections"]
    assert work
    lengths = ("z_mm", "radius_mm", "depth_mm", "tool_diameter_mm", "angle_deg", "machine_angle_deg", "point_angle_deg")
    figures = [each[name] for each in work for name in (*lengths, "remaining_wall_mm", "mass_g")]
    figures += [each["z_mm"] for name in ("tolerance_planes", "correction_planes") for each in document[name]]
    figures += [*document["axis"]["bearing_a_mm"], *document["axis"]["bearing_b_mm"]]
    assert [k for k in figures if len(repr(k).replace(".", "").lstrip("0")) > 13] == []  # twelve and a last zero
    assert {each["point_angle_deg"] for each in work} == {118.0}
    assert {each["tool_diameter_mm"] for each in work} <= {9.525, 12.7, 15.875}
    rows = list(csv.reader(io.StringIO(balance_csv(data).split("\n\n")[1])))
    assert [float(row[rows[0].index("angle_deg")]) for row in rows[1:]] == [each["angle_deg"] for each in work]
    notes = [note for note in data.notes if "miss it by up to" in note]
    assert notes
    assert all(f"up to {data.bodies[0].chord:.3g} mm" in note for note in notes)


def test_a_tiny_rotor_is_printed_in_figures_that_can_be_carried_out(tmp_path: Path) -> None:
    # The rotor of case 14 with 2.6 mm between its bearings, 11 mg.
    corners = 1e-2 * read(path("two_disc_rotor.stl"), unit="mm").triangles.corners()
    part = Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), "mm")
    write_stl([part], tmp_path / "small.stl", part.unit)
    fields = {
        "body": [{"file": "small.stl", "density": 7850}],
        "axis": {"bearing_a": [0, 0, 0.2], "bearing_b": [0, 0, 2.8]},
        "service": {"rpm": 300_000},
        "tolerance": {"grade": 6.3},
        "plane": [{"id": k, "z": z, "method": "add", "radius": 0.5} for k, z in (("I", 0.9), ("II", 2.15))],
    }
    data = report_data(balance(Rotor.from_dict(fields, tmp_path)))
    lines = {line.split()[0]: line.split() for line in balance_text(data).splitlines() if line[:2] in ("I-", "II")}
    html = balance_html(data)
    for work in data.operations:
        mass = lines[work.id][-1]
        assert float(mass) == pytest.approx(work.mass, rel=1e-3)
        assert f"{mass} g" in html
    assert "&lt;0.001 g" not in html
    (limit,) = [line.split()[2] for line in balance_text(data).splitlines() if line.startswith("A   ")]
    assert float(limit) == pytest.approx(1e6 * data.bearings[0].permissible, rel=1e-3)


def test_a_hole_of_a_drills_point_alone_says_how_deep_that_goes() -> None:
    data = marked()
    works = tuple(replace(work, depth=0.0, angle=359.97, machine_angle=359.97) for work in data.operations)
    shown = replace(data, operations=works)
    tip = works[0].diameter / 2 / math.tan(math.radians(59))
    html, lines = balance_html(shown), balance_text(shown)
    assert f"its point alone, {tip:.2f} mm deep at the tip" in html
    assert "0.00 mm deep" not in html
    assert "360.0°" not in html
    assert sum(line.split()[-3] == "point" for line in lines.splitlines() if line.startswith(("I-", "II-"))) == 2


def test_what_is_uncertain_of_a_weight_is_said_beside_it(tmp_path: Path) -> None:
    (tmp_path / "two_disc_rotor.stl").write_bytes(path("two_disc_rotor.stl").read_bytes())
    for says, text, cell in (
        ('density = "7850±785"', "7850 ± 785 kg/m³ as given", "<td>7850 ± 785</td>"),
        ('mass = "11.014±0.03"', "11.014 ± 0.03 kg,", "<td>11.014 ± 0.03</td>"),
        ("density = 7850", "kg, 7850 kg/m³ as given", "<td>7850</td>"),
    ):
        (tmp_path / "rotor.toml").write_text(INCHES.replace('density = "7850±50"', says), encoding="utf-8")
        rotor = Rotor.load(tmp_path / "rotor.toml")
        data = report_data(balance(Rotor.from_dict(rotor.to_dict() | {"plane": []}, rotor.folder)))
        assert text in " ".join(balance_text(data).split())
        assert cell in balance_html(data)
