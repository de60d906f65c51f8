"""The balancing report: what stands on its three sheets, that it needs nothing else, and that hostile names stay text.

Figures are those of worked case 14, whose closed forms give 247.2 and 970.4 g·mm at the bearings.
"""

import csv
import hashlib
import math
import re
import tomllib
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from xml.etree import ElementTree

import lxml.html
import numpy as np
import pytest
from tests.recording import browser

from inertia.balancing.balance import balance
from inertia.balancing.machine_angles import MachineAngles
from inertia.balancing.measured.job import Job
from inertia.balancing.measured.measure import measure
from inertia.balancing.rotor import Rotor
from inertia.balancing.shop_digits import ShopDigits
from inertia.balancing.verdict import Verdict
from inertia.errors import InertiaError, UsageError
from inertia.report.balance.data import PlaneRow
from inertia.report.balance.document import balance_csv, balance_document
from inertia.report.balance.figures import report_data
from inertia.report.balance.html import balance_html, save_balance_html
from inertia.report.balance.text import balance_text
from inertia.report.measurement.html import certificate_html
from inertia_meshes import path

ROTOR = files("inertia_meshes") / "rotors" / "two_disc_rotor.toml"
HOSTILE = """<script>alert(1)</script> & "><img src=x onerror='y'> ]]> {{ data }}"""


@cache
def case_14():
    return report_data(balance(Rotor.load(str(ROTOR))), date="2024-02-29")


@cache
def edited(**changes):
    """Return the report of case 14 with sections of its rotor file replaced, each by the text of a section."""
    table = tomllib.loads(ROTOR.read_text())
    for name, text in changes.items():
        table[name] = tomllib.loads(text).get(name, [])
    table["body"][0].setdefault("chord_tolerance", 0.0)
    return report_data(balance(Rotor.from_dict(table, Path(str(ROTOR)).parent)))


def page(data):
    return lxml.html.document_fromstring(balance_html(data))


def text(element):
    return " ".join(" ".join(element.itertext()).split())


def table(document, caption):
    return next(k for k in document.iter("table") if caption in text(k.find("caption")))


def rows(grid):
    """Return the cells of the body of a table."""
    return [[text(cell) for cell in row] for row in grid.find("tbody")]


def columns(grid):
    """Return how many columns each row of a table covers, cells that reach down from rows above included."""
    counts, hanging = [], []
    for row in grid.iter("tr"):
        hanging = [(wide, deep - 1) for wide, deep in hanging if deep > 1]
        cells = [(int(cell.get("colspan", 1)), int(cell.get("rowspan", 1))) for cell in row]
        counts.append(sum(wide for wide, _ in hanging + cells))
        hanging += cells
    return counts


def test_there_are_three_sheets_with_their_headings():
    document = page(case_14())
    sheets = document.findall(".//section")
    assert [sheet.get("id") for sheet in sheets] == ["identity", "figures", "shop"]
    assert [text(k) for k in document.iter("h1")] == ["1 Balancing report", "2 Unbalance", "3 Shop sheet"]
    captions = [text(k) for k in document.iter("caption")]
    assert [re.split("[:.,]", k)[0] for k in captions] == [
        "Rotor",
        "Axis and service",
        "Files",
        "Criterion",
        "Magnitude in g·mm",
        "Operations",
        "What to hold tightest",
        "Measured on the balancing machine",
    ]


def test_every_sheet_says_how_angles_are_seen_and_that_nothing_was_measured():
    for sheet in page(case_14()).findall(".//section"):
        head = text(sheet.find(".//header"))
        for piece in (
            "predicted from geometry – not a measurement",
            "View from bearing B looking toward bearing A",
            "0° toward (1, 0, 0) of the part's axes",
            "Angles counter-clockwise in this view",
            "Rotation counter-clockwise in this view",
            "two-disc rotor · serial 0001 · revision A 2024-02-29 · inertia",
        ):
            assert piece in head
        assert sheet.find(".//header//svg") is not None


def test_every_row_of_every_table_covers_the_same_columns():
    for data in (case_14(), edited(tolerance="[tolerance]\ne_um = 200.0"), edited(plane="")):
        for grid in page(data).iter("table"):
            assert len(set(columns(grid))) == 1, text(grid)


def test_case_14_stands_in_the_table_of_states():
    initial, correction, residual = rows(table(page(case_14()), "Magnitude"))
    assert initial[1:9] == [
        "863.1 ∠ 210.0° 1.199",
        "1598 ∠ 20.0° 2.219",
        "247.2 ∠ 226.3° 0.3433",
        "970.4 ∠ 17.6° 1.348",
        "762.8 ∠ 8.7° 1.059",
        "154674 ∠ 23.4° 8.457",
        "69.26",
        "55.10",
    ]
    assert initial[9:] == ["24.40", "95.78"]
    assert (initial[0], correction[0], residual[0]) == ("initial", "correction", "residual")
    assert correction[7:9] == ["–", "–"]
    assert all(float(cell.split("∠")[0]) < 2.0 for cell in residual[1:5])


def test_initial_and_correction_make_up_the_residual():
    initial, correction, residual = case_14().states
    for name in ("static", "couple"):
        total = getattr(initial, name) + getattr(correction, name)
        assert abs(total - getattr(residual, name)) <= 1e-9 * abs(getattr(initial, name))
    for name in ("planes", "bearings"):
        for parts in zip(*(getattr(state, name) for state in case_14().states), strict=True):
            assert abs(parts[0] + parts[1] - parts[2]) <= 1e-9 * abs(parts[0])


def test_identity_and_criterion_are_stated():
    document = page(case_14())
    first = text(document.find(".//section"))
    for piece in (
        "Mass 11.014 kg",
        "Centre of mass z = 150.607 mm",
        "Principal axis 0.299° from the shaft",
        "ISO 21940-11:2016, G6.3; U_per = G m/ω; U_per = 220.9 g·mm (0.3067 oz·in)",
        "3000 r/min",
        "the speed is 0.25 of the critical one",
        "no keys",
    ):
        assert piece in first
    hashes = [row[1] for row in rows(table(document, "Files"))]
    assert len(hashes) == 2
    assert all(re.fullmatch("[0-9a-f]{64}", k) for k in hashes)
    a, b = rows(table(document, "Criterion"))
    assert a[:5] == ["A", "20", "0.498, 0.3–0.7 allowed", "109.9", "0.1526"]
    assert (a[-1], b[-1]) == ("PASS", "PASS")


def test_clamped_shares_are_shown():
    heavy_end = edited(axis="[axis]\nbearing_a = [0, 0, 20]\nbearing_b = [0, 0, 160]")
    shares = [row[2] for row in rows(table(page(heavy_end), "Criterion"))]
    assert shares == ["0.067 → 0.300, clamped to 0.3–0.7", "0.933 → 0.700, clamped to 0.3–0.7"]


def test_the_shop_sheet_says_where_what_and_how_deep():
    document = page(case_14())
    first, second = rows(table(document, "Operations"))
    assert first[:11] == [
        "1", "I-1", "90.00", "outside", "REMOVE", "radial hole", "210.0°", "100.00", "10.00", "118°", "14.20 ± 0.10",
    ]  # fmt: skip
    assert second[1] == "II-1"
    assert second[6] == "20.0°"
    assert first[-2:] == second[-2:] == ["", ""]
    degree = math.radians(1.0) * float(first[12]) * (280.0 - 90.0) / 260.0  # a degree moves U sideways; the lever to A
    assert float(first[16]) == pytest.approx(degree, rel=1e-3)


FINE = """
[[plane]]
id = "I"
z = 90
method = "drill_radial"
radius = 100
diameters = [8, 10, 10.3125]
angle_step = 0.03
depth_step = 0.02
max_depth = 20
[[plane]]
id = "II"
z = 215
method = "drill_radial"
radius = 80
diameters = [12, 15.875]
angle_step = 0.03
depth_step = 0.003
max_depth = 25
"""
EXACT = "[uncertainty]\n" + "".join(f"{name} = 0\n" for name in ("radius", "z", "angle", "mass"))
GRADE_1 = "[tolerance]\ngrade = 1"


def test_the_work_is_printed_to_the_digits_of_the_steps():
    data = edited(plane=FINE, tolerance=GRADE_1)
    document, lines = page(data), balance_text(data).splitlines()
    steps = [text(k) for k in document.findall(".//ol[@class='steps']/li")]
    for row, step, work in zip(rows(table(document, "Operations")), steps, data.operations, strict=True):
        angle, radius, tool, depth = row[6], row[7], row[8], row[10].partition(" ")[0]
        assert [float(k) for k in (angle.rstrip("°"), tool, depth)] == [work.angle, work.diameter, work.depth]
        assert f"at {angle} :" in step
        assert f"Ø{work.diameter:g}, {depth} mm deep" in step
        (line,) = (k for k in lines if k.startswith(f"{work.id} "))
        assert line.split()[5:9] == [angle, radius, f"Ø{work.diameter:g}", depth]
    assert any(round(work.angle, 1) != work.angle for work in data.operations)
    assert any(round(work.depth, 2) != work.depth for work in data.operations)
    labels = {k.text for k in document.iter("text")}
    assert {f"{k}: {work.angle:.2f}°" for k, work in enumerate(data.operations, 1)} <= labels


@pytest.mark.parametrize("grade", [1, 0.3])
def test_masses_without_steps_are_printed_so_that_they_keep_the_verdict(grade):
    planes = "".join(
        f'[[plane]]\nid = "{name}"\nz = {z}\nmethod = "add"\nradius = 70\nangle_step = 0\n'
        for name, z in (("I", 90), ("II", 215))
    )
    mark = "[axis]\nbearing_a = [0, 0, 20]\nbearing_b = [0, 0, 280]\nzero_mark = [1, 0.123, 0]"  # at no round angle
    data = edited(plane=planes, tolerance=f"[tolerance]\ngrade = {grade}", uncertainty=EXACT, axis=mark)
    left = np.array(data.initial.bearings)
    for row in rows(table(page(data), "Operations")):
        z, angle, radius, mass = (float(row[k].rstrip("°")) for k in (2, 6, 7, 11))
        vector = 1e-6 * mass * radius * np.exp(1j * math.radians(angle))
        left += vector * np.array([280 - z, z - 20]) / 260
    bounds = np.array([sum(k.values()) for k in data.residual.bearing_bounds])
    limits = np.array([k.permissible for k in data.bearings])
    assert data.outcome == "pass"
    assert (np.abs(left) + bounds <= limits).all()
    assert np.abs(left - data.residual.bearings).max() <= 0.01 * limits.min()


def test_the_work_is_a_list_of_numbered_steps_with_a_view_of_each_plane():
    document = page(case_14())
    first, second = map(text, document.findall(".//ol[@class='steps']/li"))
    assert first == (
        "plane I (z 90.00 mm, outside) at 210.0° : REMOVE radial hole Ø10, 14.20 mm deep, radius 100.00 mm, 9.350 g"
    )
    assert second.startswith("plane II (z 215.00 mm, outside) at 20.0°")
    titles = [k.text for k in document.iter("title")]
    assert [k for k in titles if k.endswith("with the work at scale")] == [
        f"plane {k} seen from B, with the work at scale" for k in ("I", "II")
    ]
    assert sum("strip to tape round" in k for k in titles) == 6


def test_the_work_is_in_the_angles_of_the_machine():
    data = edited(report="[report]\nmachine_angles = 'cw'")
    document = page(data)
    assert "at 150.0° of the machine (210.0° in this report)" in text(document.find(".//ol[@class='steps']/li"))
    assert rows(table(document, "Operations"))[0][6:8] == ["210.0°", "150.0°"]
    assert "The machine counts angles clockwise in this view" in text(document)
    lines = list(csv.DictReader(balance_csv(data).split("\n\n")[1].splitlines()))
    assert [(k["step"], float(k["machine_angle_deg"])) for k in lines] == [
        ("1", pytest.approx(150.0)),
        ("2", pytest.approx(340.0)),
    ]
    assert [k["machine_angle_deg"] for k in balance_document(data)["corrections"]] == pytest.approx([150.0, 340.0])


def test_every_heading_of_a_table_says_what_it_heads():
    assert {k.get("scope") for k in page(case_14()).iter("th")} == {"col", "colgroup", "row"}


def test_sensitivities_are_those_that_matter_most():
    data = case_14()
    listed = [row[0] for row in rows(table(page(data), "What to hold tightest"))]
    assert listed == [k.name for k in data.scatter.sensitivities if max(k.share) > 5e-4]
    many = replace(data, scatter=replace(data.scatter, sensitivities=data.scatter.sensitivities[:2] * 10))
    grid = table(page(many), "What to hold tightest")
    assert len(rows(grid)) == 8
    assert text(grid.find("tfoot")) == "and 12 that matter less"


@pytest.mark.parametrize("outcome", ["pass", "fail", "undecided", "conditional"])
def test_the_verdict_is_a_word_and_a_frame_of_its_own(outcome):
    data = case_14()
    verdict = Verdict(outcome, data.verdict.planes, ("because & so",))
    data = replace(data, residual=replace(data.residual, outcome=outcome), verdict=verdict)
    box = page(data).find(".//section//div[@class='verdict " + outcome + "']")
    assert text(box) == f"{outcome.upper()} because & so"
    assert f".verdict.{outcome}" in balance_html(data) or outcome == "pass"


def test_a_rotor_that_nothing_is_done_to_fails_and_says_why():
    data = edited(plane="")
    document = page(data)
    assert data.outcome == "fail"
    assert "No operation: no plane has a method of correction." in text(document)
    assert "correction planes" not in text(table(document, "Magnitude"))
    assert columns(table(document, "Magnitude")) == [9] * 5


def test_a_rotor_within_its_tolerance_is_left_alone():
    data = edited(tolerance="[tolerance]\ne_um = 200.0")
    document = page(data)
    assert (data.outcome, data.operations) == ("pass", ())
    assert "No operation: already within the tolerance." in text(document)
    assert rows(table(document, "Magnitude"))[1][1:] == ["0 0"] * 6 + ["–", "–", "0", "0"]


def test_an_uncertain_axis_is_undecided_with_what_would_settle_it():
    data = edited(
        axis="[axis]\nbearing_a = [0, 0, 20]\nbearing_b = [0, 0, 280]\nradial_uncertainty = 0.02\nrotation = 'cw'"
    )
    document = page(data)
    assert text(document.find(".//p[@class='outcome']")) == "UNDECIDED"
    assert "bearing centres known to" in text(document.find(".//div[@class='verdict undecided']"))
    assert "Rotation clockwise in this view" in text(document)
    assert "0.02 mm about each bearing centre" in text(document)


def test_candidates_for_the_axis_are_shown_and_leave_it_undecided():
    data = edited(axis="[axis]\njournals = 'detect'")
    assert data.outcome == "undecided"
    assert "candidate for the axis, to be confirmed: A (0, 0," in text(page(data).find(".//ul[@class='notes']"))


def test_the_file_needs_nothing_else():
    document = page(case_14())
    content = balance_html(case_14())
    assert not re.search(r"https?:|url\(|@import|//[a-z]", content)
    for element in document.iter():
        assert element.tag not in {"script", "link", "img", "iframe", "object", "embed", "base", "use", "image"}
        assert not {"src", "href", "action", "background"} & set(element.attrib)
        assert not [name for name in element.attrib if name.startswith("on")]
    policy = document.find(".//meta[@http-equiv='Content-Security-Policy']").get("content")
    assert policy.startswith("default-src 'none'")


def hostile():
    data = case_14()
    planes = tuple(replace(plane, id=HOSTILE + plane.id) for plane in data.planes)
    works = tuple(replace(work, id=HOSTILE, plane=HOSTILE + work.plane, item=HOSTILE) for work in data.operations)
    names = dict.fromkeys(("part", "serial", "revision", "customer", "remark"), HOSTILE)
    return replace(
        data,
        head=replace(data.head, **names),
        axis=replace(data.axis, obtained=HOSTILE),
        bodies=(replace(data.bodies[0], name=HOSTILE, path=HOSTILE),),
        file=(HOSTILE, "0" * 64),
        tolerance=replace(data.tolerance, standard=HOSTILE, rule=HOSTILE),
        verdict=replace(case_14().verdict, why=(HOSTILE,)),
        notes=(HOSTILE,),
        planes=planes,
        operations=works,
    )


def test_hostile_names_stay_text():
    document = page(hostile())
    assert not list(document.iter("script", "img"))
    assert text(document.find(".//title")) == f"Balancing report: {HOSTILE}"
    assert rows(table(document, "Operations"))[0][1] == HOSTILE
    assert rows(table(document, "Files"))[0][0] == HOSTILE


@pytest.mark.parametrize("make", [case_14, hostile, lambda: edited(plane="")], ids=["case 14", "hostile", "no planes"])
def test_every_picture_is_well_formed_and_has_a_title(make):
    pictures = re.findall(r"<svg.*?</svg>", balance_html(make()), re.DOTALL)
    assert len(pictures) >= 3 + 1 + 4  # a pictogram a sheet, the sketch, two plots for each tolerance plane
    for picture in pictures:
        root = ElementTree.fromstring(picture)
        assert root.find("title").text
        assert "nan" not in picture.replace(HOSTILE, "").lower().split("</title>")[1]


def test_a_long_list_of_operations_is_one_table_whose_head_comes_again_on_every_sheet():
    data = case_14()
    works = tuple(replace(data.operations[0], id=f"I-{k}", angle=6.0 * k) for k in range(60))
    content = balance_html(replace(data, operations=works))
    grid = table(lxml.html.document_fromstring(content), "Operations")
    assert [row[1] for row in rows(grid)] == [f"I-{k}" for k in range(60)]
    assert len(grid.findall("thead")) == 1
    assert re.search(r"\bthead \{ display: table-header-group;", content)
    assert re.search(r"\btr \{ break-inside: avoid;", content)
    assert re.search(r"header \{ display: table-header-group; break-inside: avoid;", content)


def test_many_correction_planes_have_a_table_of_their_own():
    data = case_14()
    planes = tuple(PlaneRow(f"P{k}", 30.0 * k + 30.0, "drill_radial", 50.0) for k in range(5))
    names = ("initial", "correction", "residual")
    states = {name: replace(getattr(data, name), planes=(100e-6 + 0j,) * 5) for name in names}
    document = page(replace(data, planes=planes, operations=(), **states))
    grid = rows(table(document, "In the correction planes"))
    assert [row[0] for row in grid] == [f"plane P{k}" for k in range(5)]
    assert grid[0][1] == "100.0 ∠ 0.0° 0.1389"
    assert set(columns(table(document, "Magnitude"))) == {9}


@pytest.mark.parametrize("number", [2, 3, 4])
def test_a_correction_that_is_resolved_anew_is_called_so(number):
    """With more than two planes it is not what is done in each."""
    data = case_14()
    planes = (*data.planes, *(PlaneRow(f"P{k}", 30.0 * k, "drill_radial", 50.0) for k in range(number - 2)))
    names = ("initial", "correction", "residual")
    states = {name: replace(getattr(data, name), planes=(1e-4 + 0j,) * number) for name in names}
    sheet = page(replace(data, planes=planes, **states)).get_element_by_id("figures")
    heads = {text(k) for k in sheet.iter("th") if k.get("scope", "").startswith("col")}
    assert ("correction planes" in heads) == (number == 2)
    assert ("correction planes, resolved" in heads) == (number == 3)
    assert ("correction, resolved" in heads) == (number == 4)
    assert ("what is done in each plane is in the dials below and in the list of steps" in text(sheet)) == (number > 2)


def tiny():
    """Return the report of case 14 with figures as a rotor of milligrams has them."""
    data, machine = case_14(), MachineAngles("cw")
    figures = {"depth_tolerance": 0.002, "diameter": 0.05, "per_tenth": 4.019e-13, "per_degree": 4.887e-15}
    works = [
        replace(work, mass=mass, unbalance=0.4667e-6 * mass, machine_angle=machine.of(work.angle), **figures)
        for work, mass in zip(data.operations, (9.98e-7, 1.075e-6), strict=True)
    ]
    bearings = tuple(replace(bearing, permissible=1.059e-13) for bearing in data.bearings)
    digits = ShopDigits(depth=3, place=3)
    return replace(data, operations=tuple(works), bearings=bearings, machine=machine, digits=digits)


def test_masses_of_one_list_are_written_alike():
    data = tiny()
    assert [row[12] for row in rows(table(page(data), "Operations."))] == ["9.980e-07", "1.075e-06"]
    lines = [line for line in balance_text(data).splitlines() if line.startswith(("I-1 ", "II-1 "))]
    assert [next(k for k in line.split() if "e-" in k) for line in lines] == ["9.980e-07", "1.075e-06"]


BROKEN = """Array.from(document.querySelectorAll('#shop td:not(.words)')).flatMap(cell => {
    const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT), broken = [];
    for (let node; node = texts.nextNode();) {
        const range = document.createRange();
        range.selectNodeContents(node);
        if (node.data.trim() && range.getClientRects().length > 1) broken.push(node.data);
    }
    return broken;
}).join()"""
WIDE = """Array.from(document.querySelectorAll('#shop .wide')).every(k => k.scrollWidth <= k.clientWidth)"""


@pytest.mark.skipif(browser.PROGRAM is None, reason="chromium is not installed")
@pytest.mark.parametrize(("medium", "width"), [("screen", 1200), ("print", 1032)])
@pytest.mark.parametrize("make", [case_14, tiny])
def test_the_shop_sheet_has_room_for_every_figure_and_breaks_none(make, medium, width, tmp_path):
    save_balance_html(make(), tmp_path / "report.html")
    with browser.opened((tmp_path / "report.html").as_uri(), tmp_path) as shown:
        browser.until(lambda: shown.evaluate("document.querySelectorAll('.operations').length"))
        shown.ask("Emulation.setEmulatedMedia", media=medium)
        shown.ask(
            "Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False
        )  # 1032 pixels are A4 between its margins, lengthwise
        assert shown.evaluate(BROKEN) == ""
        assert shown.evaluate(WIDE)


def test_long_names_of_operations_are_wrapped_so_that_no_column_is_lost():
    long = "compressor wheel nose nut, back face-1"
    data = case_14()
    works = [replace(data.operations[0], id=long), *data.operations[1:]]
    rows = table(page(replace(data, operations=works)), "Operations.").findall("tbody/tr/th")
    assert [(row.text, row.get("class")) for row in rows][:2] == [(long, "long"), (works[1].id, None)]


@pytest.mark.parametrize("certificate", [False, True])
def test_arrows_end_at_their_values_and_labels_stand_clear_of_circles(certificate):
    """An outline would end beyond them by some percent of the plot."""
    job = measure(Job.load(path("jobs/fan.toml")))
    document = certificate_html(job) if certificate else balance_html(case_14())
    style = lxml.html.document_fromstring(document).find("head/style").text
    assert re.search(r"svg \.head \{[^}]*stroke: none;", style)
    assert not re.search(r"svg \.(after|correction)\.head", style)
    assert "svg .halo { paint-order: stroke; stroke: var(--paper);" in style


def test_it_prints_to_a4():
    content = balance_html(case_14())
    assert re.search(r"@page \{ size: A4;", content)
    assert re.search(r"@page wide \{ size: A4 landscape; \}", content)
    assert "break-before: page" in content


def test_the_file_is_written_whole_and_never_over_another_unasked(tmp_path):
    file = tmp_path / "report.html"
    save_balance_html(case_14(), file)
    assert file.read_text(encoding="utf-8") == balance_html(case_14())
    with pytest.raises(UsageError, match="force=True"):
        save_balance_html(case_14(), file)
    save_balance_html(replace(case_14(), head=replace(case_14().head, part="another")), file, force=True)
    assert "another" in file.read_text(encoding="utf-8")
    with pytest.raises(InertiaError, match="cannot write"):
        save_balance_html(case_14(), tmp_path / "nowhere" / "report.html")
    assert [k.name for k in tmp_path.iterdir()] == ["report.html"]


def test_a_name_that_is_no_unicode_can_be_written(tmp_path):
    save_balance_html(replace(case_14(), head=replace(case_14().head, part="fan\udcff")), tmp_path / "report.html")
    assert "fan\\udcff" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_how_parts_are_put_together_is_on_the_shop_sheet() -> None:
    data = report_data(balance(Rotor.load(path("rotors/pump_rotor.toml"))))
    page = balance_html(data)
    assert "Put together, before any correction: the best of 16 ways, none leaves less" in page
    for name, turn in (("impeller", "90°"), ("coupling", "180°")):
        assert f'<th scope="row">{name}</th><td>{turn}</td>' in page
    assert "in the place of" not in page
    for file in ("rotors/pump_rotor.toml", "assemblies/pump_rotor.toml"):
        assert hashlib.sha256(path(file).read_bytes()).hexdigest() in page
