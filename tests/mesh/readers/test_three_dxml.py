"""3DXML: product structures and tessellated parts, whose corners are known from the numbers that were written."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import (
    CORNERS,
    IN_PLACE,
    INSTANCE_3DXML,
    PART_3DXML,
    TRIANGLES,
    archive,
    representation_3dxml,
    three_dxml,
    words,
)

from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.mesh.read import read

BOX = CORNERS[TRIANGLES]
TURNED = "0 1 0 -1 0 0 0 0 1 7 8 9"
"""Columns: x becomes y, y becomes −x; then 7, 8, 9."""
MIRRORED = "-1 0 0 0 1 0 0 0 1 0 0 0"


def read_3dxml(folder: Path, data: bytes) -> Part:
    path = folder / "box.3dxml"
    path.write_bytes(data)
    return read(path)


def instance(number: int, matrix: str = IN_PLACE, owner: int = 1, target: int = 2) -> str:
    return INSTANCE_3DXML.format(id=number, owner=owner, target=target, matrix=matrix)


def test_instances_are_placed_one_within_the_other(tmp_path: Path) -> None:
    parts = (
        PART_3DXML + '<Reference3D id="10" name="pair"/>'
        + instance(11, TURNED, 10, 2) + instance(12, IN_PLACE, 10, 2)
        + instance(13, TURNED, 1, 10) + instance(14, MIRRORED, 1, 2)
    )  # fmt: skip
    part = read_3dxml(tmp_path, three_dxml(parts))
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    twice = BOX @ (turn @ turn).T + [-1, 15, 18]
    expected = [twice, BOX @ turn.T + [7, 8, 9], (BOX * [-1, 1, 1])[:, ::-1]]
    assert {each.tobytes() for each in part.triangles.corners().reshape(3, 12, 3, 3)} == {
        (each + 0.0).tobytes() for each in expected
    }
    assert (part.unit.name, part.unit_from) == ("mm", "assumed")


def test_parts_of_one_name_stay_two(tmp_path: Path) -> None:
    second = PART_3DXML.replace('"2"', '"22"').replace('"3"', '"23"').replace('"4"', '"24"')
    second = second.replace(">2<", ">22<").replace(">4<", ">24<").replace("Box.3DRep", "Other.3DRep")
    parts = PART_3DXML + second + instance(5) + instance(6, target=22)
    other = representation_3dxml(CORNERS + 9)
    part = read_3dxml(tmp_path, three_dxml(parts, Other__3DRep=other))
    assert np.array_equal(part.triangles.corners(), np.concatenate([BOX, (CORNERS + 9)[TRIANGLES]]))
    assert part.regions is not None
    assert part.regions.names == ("box",)


def test_strips_and_fans_become_triangles(tmp_path: Path) -> None:
    face = 'strips="0 4 1 5,2 3 6 7" fans="0 1 3 2" triangles="0 2 4"'
    part = read_3dxml(tmp_path, three_dxml(representation=representation_3dxml(face=face)))
    expected = [[0, 4, 1], [5, 1, 4], [2, 3, 6], [7, 6, 3], [0, 2, 4], [0, 1, 3], [0, 3, 2]]
    assert np.array_equal(part.triangles.corners(), CORNERS[expected])


def test_coarser_levels_of_detail_are_left_out(tmp_path: Path) -> None:
    level = '<PolygonalLOD accuracy="0.2"><Faces><Face triangles="0 1 3"/></Faces></PolygonalLOD>'
    part = read_3dxml(tmp_path, three_dxml(representation=representation_3dxml(level=level)))
    assert np.array_equal(part.triangles.corners(), BOX)


def test_a_texture_does_not_matter(tmp_path: Path) -> None:
    material = '<CATMaterialRef><MaterialDomain id="1" associatedFile="urn:3DXML:no.3dxml"/></CATMaterialRef>'
    part = read_3dxml(tmp_path, three_dxml(CATMaterialRef__3dxml=material))
    assert np.array_equal(part.triangles.corners(), BOX)


def test_each_face_of_a_list_counts_once_and_normals_do_not_matter(tmp_path: Path) -> None:
    text = representation_3dxml().replace(f'"{words(TRIANGLES.ravel())}"', '"0 1 3"')
    rest = "".join(f'<Face triangles="{words(corners)}"/>' for corners in TRIANGLES[1:])
    text = re.sub("<Normals>.*</Normals>", "", text.replace("</Faces>", f"{rest}</Faces>"))
    assert np.array_equal(read_3dxml(tmp_path, three_dxml(representation=text)).triangles.corners(), BOX)


def test_references_may_be_urns(tmp_path: Path) -> None:
    parts = re.sub("Of>([0-9])<", r"Of>urn:3DXML:Reference:loc:\1<", PART_3DXML + instance(5))
    assert np.array_equal(read_3dxml(tmp_path, three_dxml(parts)).triangles.corners(), BOX)


def test_parts_of_one_mesh_keep_their_names(tmp_path: Path) -> None:
    lid = PART_3DXML.partition("<ReferenceRep")[0].replace("box", "lid").replace('"2"', '"22"').replace(">2<", ">22<")
    parts = PART_3DXML + lid.replace('"3"', '"23"') + instance(5) + instance(6, TURNED, target=22)
    part = read_3dxml(tmp_path, three_dxml(parts))
    assert part.regions is not None
    names = np.repeat(np.array(part.regions.names)[part.regions.index[::12]], 12)
    assert np.array_equal(part.triangles.corners()[names == "box"], BOX)
    turned = BOX @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]) + [7, 8, 9]
    assert np.array_equal(part.triangles.corners()[names == "lid"], turned)


def test_what_the_view_hides_counts_with_a_note(tmp_path: Path) -> None:
    hides = '<GraphicProperties><GeneralAttributes visible="false"/></GraphicProperties>'
    part = read_3dxml(tmp_path, three_dxml(PLACED + instance(6, TURNED) + view(hides)))
    assert part.notes == ("1 occurrence that the view hides was counted",)
    assert part.triangles.count == 24


def test_a_view_may_say_again_where_an_instance_is(tmp_path: Path) -> None:
    data = three_dxml(PLACED + view(f"<RelativePosition>{IN_PLACE}</RelativePosition>"))
    assert np.array_equal(read_3dxml(tmp_path, data).triangles.corners(), BOX)


def view(says: str) -> str:
    """A view of the instance 5, behind the structure."""
    occurrence = "<OccurenceId><id>urn:3DXML:Product.3dxml#5</id></OccurenceId>"
    return f"<DefaultView><DefaultViewProperty>{occurrence}{says}</DefaultViewProperty></DefaultView>"


PLACED = PART_3DXML + instance(5)
DOUBLING = "".join(
    f'<Reference3D id="r{i}" name="r"/>' + instance(f"a{i}", IN_PLACE, f"r{i}", f"r{i + 1}")
    + instance(f"b{i}", IN_PLACE, f"r{i}", f"r{i + 1}") for i in range(60)
)  # fmt: skip
BAD = {
    "no manifest": (archive(Product__3dxml="<a/>"), "no Manifest.xml"),
    "no product": (archive(Manifest__xml="<M><Root>a.3dxml</Root></M>", b__3dxml="<a/>"), "'a.3dxml', which it does"),
    "no structure": (archive(Manifest__xml="<M><Root>a.3dxml</Root></M>", a__3dxml="<a/>"), "no ProductStructure"),
    "no root": (archive(Manifest__xml="<M><Root>a.3dxml</Root></M>", a__3dxml='<M><ProductStructure root="9"/></M>'),
        "its root is '9'"),
    "binary part": (three_dxml(PLACED.replace("TESSELLATED", "CGR")), "not stored as triangles"),
    "binary contents": (three_dxml(representation="V5_CFV2\\0\\1"), "not stored as triangles"),
    "missing part": (three_dxml(PLACED.replace("Box.3DRep", "Other.3DRep")), "'other.3drep' is not stored"),
    "another file": (three_dxml(PLACED.replace(">4<", ">urn:3DXML:Other.3dxml#4<")), "export it as one file"),
    "loose end": (three_dxml(PLACED.replace(">4<", ">44<")), "'44', which it does not hold"),
    "two in one": (three_dxml(PLACED + """<InstanceRep id="6"><IsAggregatedBy>2</IsAggregatedBy>
        <IsInstanceOf>4</IsInstanceOf></InstanceRep>"""), "several representations"),
    "circle": (three_dxml(PLACED + instance(6, IN_PLACE, 2, 1)), "part of itself"),
    "doubling": (three_dxml(PLACED + DOUBLING + '<Reference3D id="r60" name="r"/>' + instance(7, IN_PLACE, "r60", 2)
        + instance(8, IN_PLACE, 1, "r0")), "more than 100000000"),
    "moved by the view": (three_dxml(PLACED + view(f"<RelativePosition>{TURNED}</RelativePosition>")),
        "its view moves the occurrence '5'"),
    "one id": (three_dxml(PLACED + PLACED), "have the id"),
    "ten numbers": (three_dxml(PLACED.replace("1 0 0 0", "1 0", 1)), "not twelve numbers"),
    "nan": (three_dxml(PLACED.replace("1 0 0 0", "1 0 0 nan", 1)), "not finite"),
    "beyond": (three_dxml(representation=representation_3dxml(face='triangles="0 1 8"')), "names vertex 8"),
    "half a triangle": (three_dxml(representation=representation_3dxml(face='triangles="0 1 2 3"')), "with 4 corners"),
    "no vertices": (three_dxml(representation=representation_3dxml().replace("</Root>",
        '<Rep><Faces><Face triangles="0 1 2"/></Faces></Rep></Root>')), "faces without vertices of their own"),
    "short strip": (three_dxml(representation=representation_3dxml(face='strips="0 1 2 3,4 5"')), "with 2 corners"),
    "half a point": (three_dxml(representation=representation_3dxml().replace("0.1 0.0 0.0", "0.1 0.0")), "23 coord"),
    "entities": (three_dxml(representation="<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>"), "declares a document type"),
    "nothing": (three_dxml(PART_3DXML), "no triangle mesh"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_would_be_misread_is_refused(case: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    data, reason = BAD[case]
    with pytest.raises(ReadError, match=reason):
        read_3dxml(tmp_path, data)
    assert capfd.readouterr() == ("", "")
