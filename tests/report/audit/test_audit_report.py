"""The sample arm as text, as JSON and as a page."""

import json
from xml.etree import ElementTree

import pytest

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


def test_names_are_escaped() -> None:
    robot = inertia.audit(path("robots/arm.urdf"))
    object.__setattr__(robot.links[1], "name", "<script>alert(1)</script>")
    assert "<script>alert" not in audit_html(robot)
