"""The sample arm as text, as JSON and as a page."""

import json
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.recording import browser

import inertia
from inertia.report.audit.document import audit_document
from inertia.report.audit.html import audit_html
from inertia.report.audit.text import audit_text
from inertia_meshes import path


@pytest.fixture(scope="module")
def arm() -> inertia.Audit:
    return inertia.audit(path("robots/arm.urdf"))


def test_the_text_has_a_row_and_sentences_for_each_link(arm: inertia.Audit) -> None:
    text = audit_text(arm)
    assert "arm.urdf (urdf): inconsistent: 2 consistent, 4 inconsistent" in text
    rows = {line.split()[0]: line.split()[-1] for line in text.splitlines() if line.split()[-1:] and "kg" in line}
    assert rows["base"] == rows["drive"] == "consistent"
    assert "forearm: inconsistent\n  the tensors of its 2 meshes are added without their Steiner terms" in text
    assert "drive: densities of t_handle.stl 1040, cone.stl 7850 kg/m³ reproduce it; no others do" in text


def test_the_document_is_the_contract_s(arm: inertia.Audit) -> None:
    document = json.loads(json.dumps(audit_document(arm), allow_nan=False))
    assert document["schema"] == "inertia/audit/1"
    assert document["verdict"] == "inconsistent"
    names = [link["name"] for link in document["links"]]
    assert names == ["base", "upper_arm", "forearm", "drive", "hand", "tool"]
    codes = {link["name"]: [finding["code"] for finding in link["findings"]] for link in document["links"]}
    assert codes == {
        "base": [],
        "upper_arm": ["principal_moments_as_diagonal"],
        "forearm": ["missing_steiner"],
        "drive": ["densities"],
        "hand": ["product_signs"],
        "tool": ["outside_hull", "placeholder"],
    }
    hand = document["links"][4]
    assert hand["state"] == "inconsistent"
    assert set(hand["stated"]) == {"mass", "center_of_mass", "inertia"}
    assert set(hand["computed"]) == {"mass", "center_of_mass", "inertia", "densities", "error"}
    assert set(hand["difference"]) == {"mass", "center_of_mass", "inertia"}
    assert set(hand["findings"][0]) == {"code", "sentence", "residual", "remedy"}
    assert hand["computed"]["densities"] == pytest.approx([1040.0], rel=1e-5)


def test_the_page_stands_alone_and_draws_each_difference(arm: inertia.Audit) -> None:
    page = audit_html(arm)
    assert "INCONSISTENT" in page
    pictures = page.split("<svg ")[1:]
    assert len(pictures) == 5  # every link but the one that is right without a remark
    for picture in pictures:
        drawing = ElementTree.fromstring("<svg " + picture.partition("</svg>")[0] + "</svg>")
        assert len([each for each in drawing.iter() if each.get("class") == "stated"]) == 3
    assert "http" not in page.replace("http://www.w3.org", "")
    assert "<script" not in page


LONG = "left_front_wheel_steering_actuator_housing_link_1_" * 3


def test_a_long_name_leaves_the_figures_where_they_are(arm: inertia.Audit) -> None:
    links = [replace(arm.links[0], name=LONG), *arm.links[1:]]
    text = audit_text(replace(arm, links=tuple(links)))
    before, after = (each.splitlines() for each in (audit_text(arm), text))
    assert after[4] == LONG
    assert [line.split() for line in after[5:]] == [
        line.split() for line in [before[4].removeprefix("base"), *before[5:]]
    ]
    assert max(map(len, after[5:10])) <= max(map(len, before[4:10]))


@pytest.mark.skipif(browser.PROGRAM is None, reason="chromium is not installed")
@pytest.mark.parametrize("medium", ["screen", "print"])
def test_a_long_name_takes_no_figure_off_the_sheet(arm: inertia.Audit, medium: str, tmp_path: Path) -> None:
    links = [replace(link, name=name) for link, name in zip(arm.links, [LONG[:49], LONG], strict=False)]
    page = tmp_path / "audit.html"
    page.write_text(audit_html(replace(arm, links=(*links, *arm.links[2:]))), encoding="utf-8")
    with browser.opened(page.as_uri(), tmp_path) as shown:
        browser.until(lambda: shown.evaluate("document.querySelectorAll('.scroll table').length"))
        shown.ask("Emulation.setEmulatedMedia", media=medium)
        assert shown.evaluate("document.querySelector('.scroll').scrollWidth <= document.body.clientWidth")


def test_no_ellipsoid_is_drawn_of_what_no_body_can_be(tmp_path: Path) -> None:
    """Seen along each axis by itself, the second moments of the last tensor are positive, but not all together."""
    for name, tensor in (("possible", "3 2.5 2 0.2 0.1 0.1"), ("unphysical", "1.2 1.3 2.2 0.5 0.3 0.3")):
        xx, yy, zz, xy, xz, yz = (f"{1e-3 * float(value)}" for value in tensor.split())
        (tmp_path / f"{name}.urdf").write_text(
            f"""<robot name="r"><link name="l"><inertial><mass value="1"/>
            <inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" ixz="{xz}" iyz="{yz}"/></inertial>
            <visual><geometry><box size="0.3 0.3 0.3"/></geometry></visual></link></robot>"""
        )
        robot = inertia.audit(tmp_path / f"{name}.urdf")
        assert (robot.links[0].state == "unphysical") == (name == "unphysical")
        page = audit_html(robot)
        assert page.count('class="stated"') == 1 + 3 * (name == "possible")  # the legend, and each view
        assert page.count('class="computed"') == 1 + 3


def test_names_are_escaped() -> None:
    robot = inertia.audit(path("robots/arm.urdf"))
    object.__setattr__(robot.links[1], "name", "<script>alert(1)</script>")
    assert "<script>alert" not in audit_html(robot)
