"""Text, JSON, CSV and HTML say the same figures, as all are made from one `ReportData`."""

import csv
import io
import json
from dataclasses import replace

from inertia.balancing.balance import balance
from inertia.balancing.rotor import Rotor
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
    assert all(figure in page for figure in ("432.1<br>∠ 0.0°", "<td>76.54</td>", "<td>98.76</td>"))


def test_a_rotor_that_nothing_is_done_to_has_the_same_state_before_and_after() -> None:
    rotor = Rotor.load(path("rotors/two_disc_rotor.toml"))
    document = balance_document(report_data(balance(Rotor.from_dict(rotor.to_dict() | {"plane": []}, rotor.folder))))
    assert document["correction"] is None
    assert document["corrections"] == []
    assert document["residual"]["tolerance_planes"] == document["tolerance_planes"]
