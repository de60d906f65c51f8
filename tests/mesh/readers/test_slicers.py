"""What slicers write beside the model of a 3MF file: modifiers and supports are left out, cuts are refused."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import CORNERS, TRIANGLES, mesh_3mf, model_3mf

from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.mesh.read import read, read_tree

BOX = CORNERS[TRIANGLES]
FAR = CORNERS + np.array([9, 0, 0])
BOTH = mesh_3mf(np.concatenate([CORNERS, FAR]), np.concatenate([TRIANGLES, TRIANGLES + 8]))
ONE_MESH = model_3mf(f'<object id="1">{BOTH}</object>', '<item objectid="1"/>')
COMPONENTS = model_3mf(
    f'<object id="1">{mesh_3mf()}</object><object id="2">{mesh_3mf(FAR)}</object><object id="3"><components>'
    '<component objectid="1"/><component objectid="2"/></components></object>',
    '<item objectid="3"/>',
)


def archived(folder: Path, model: str, settings: str, name: str) -> Path:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as target:
        target.writestr("3D/3dmodel.model", model)
        target.writestr(f"Metadata/{name}", settings)
    (folder / "a.3mf").write_bytes(file.getvalue())
    return folder / "a.3mf"


def prusa(folder: Path, says: str, last: object = 23) -> Path:
    """Write both boxes as one mesh, of which PrusaSlicer says something of the second."""
    settings = (
        '<?xml version="1.0"?><config><object id="1"><volume firstid="0" lastid="11"/>'
        f'<volume firstid="12" lastid="{last}"><metadata type="volume" {says}/></volume></object></config>'
    )
    return archived(folder, ONE_MESH, settings, "Slic3r_PE_model.config")


def bambu(folder: Path, kind: str, model: str = COMPONENTS) -> Path:
    """Write both boxes as components, the second of a kind that Bambu Studio knows."""
    parts = f'<part id="1" subtype="normal_part"/><part id="2" subtype="{kind}"/>'
    settings = f'<config><object id="3">{parts}</object></config>'
    return archived(folder, model, settings, "model_settings.config")


def cura(folder: Path, setting: str, says: str = "True", model: str = "") -> Path:
    """Write both boxes as Cura does, the second as a child of the first, with a setting of its own."""
    settings = f'<metadatagroup><metadata name="{setting}" preserve="true" type="xs:string">{says}</metadata>'
    objects = f'<object id="1">{mesh_3mf()}<components><component objectid="2"/></components></object>'
    objects += f'<object id="2">{settings}<metadata name="cura:extruder_nr">1</metadata></metadatagroup>{mesh_3mf(FAR)}'
    return archived(folder, model or model_3mf(objects + "</object>", '<item objectid="1"/>'), "", "none.config")


def slic3r(folder: Path, modifier: object, space: str = "http://schemas.slic3r.org/3mf/2017/06") -> Path:
    """Write both boxes as one mesh, which says as Slic3r 1.3 does what the second is."""
    volume = '<v:volume ts="{}" te="{}" modifier="{}"/>'
    volumes = volume.format(0, 11, 0) + volume.format(12, 23, modifier)
    mesh = BOTH.replace("</mesh>", f'<v:volumes xmlns:v="{space}">{volumes}</v:volumes></mesh>')
    return archived(folder, ONE_MESH.replace(BOTH, mesh), "", "none.config")


def is_the_box(part: Part) -> bool:
    return np.array_equal(part.triangles.corners(), BOX)


MARKED = ("1 volume, which a slicer calls modifier or support, was left out",)
OTHER = ("1 object of the type other, which is not built, was left out",)


@pytest.mark.parametrize(
    "says",
    [
        *(f'key="volume_type" value="{kind}"' for kind in ("SupportEnforcer", "SupportBlocker", "ParameterModifier")),
        'key="modifier" value="1"',
    ],
)
def test_triangles_of_modifiers_and_supports_are_left_out(says: str, tmp_path: Path) -> None:
    part = read(prusa(tmp_path, says))
    assert is_the_box(part)
    assert part.notes == read_tree(tmp_path / "a.3mf").notes == MARKED


@pytest.mark.parametrize("kind", ["modifier_part", "support_enforcer", "support_blocker"])
def test_components_that_are_modifiers_and_supports_are_left_out(kind: str, tmp_path: Path) -> None:
    part = read(bambu(tmp_path, kind))
    assert (is_the_box(part), part.notes) == (True, MARKED)
    part = read(bambu(tmp_path, kind, COMPONENTS.replace('<object id="2"', '<object id="2" type="other"')))
    assert (is_the_box(part), part.notes) == (True, OTHER)


@pytest.mark.parametrize("kind", ["support_mesh", "anti_overhang_mesh", "infill_mesh", "cutting_mesh"])
@pytest.mark.parametrize(("prefix", "says"), [("cura:", "True"), ("cura:cura:", " true\n")])
def test_objects_that_cura_prints_as_no_body_are_left_out(kind: str, prefix: str, says: str, tmp_path: Path) -> None:
    part = read(cura(tmp_path, prefix + kind, says))
    assert is_the_box(part)
    assert part.notes == read_tree(tmp_path / "a.3mf").notes == MARKED


def test_an_object_of_cura_s_and_its_children_are_told_apart(tmp_path: Path) -> None:
    """The mesh of an object is what its own settings say, and that of each child what the child's do."""
    group = '<metadatagroup><metadata name="cura:support_mesh">True</metadata></metadatagroup>'
    components = '<components><component objectid="1"/></components>'
    for own in (mesh_3mf(FAR), ""):
        objects = f'<object id="1">{mesh_3mf()}</object><object id="2">{own}{components}{group}</object>'
        part = read(cura(tmp_path, "", model=model_3mf(objects, '<item objectid="2"/>')))
        assert (is_the_box(part), part.notes) == (True, MARKED if own else ())
    alone = model_3mf(f'<object id="1">{mesh_3mf()}</object><object id="2">{mesh_3mf(FAR)}{group}</object>',
                      '<item objectid="1"/><item objectid="2"/>')  # fmt: skip
    assert (is_the_box(read(cura(tmp_path, "", model=alone))), read(tmp_path / "a.3mf").notes) == (True, MARKED)


def test_volumes_that_slic3r_calls_modifiers_are_left_out(tmp_path: Path) -> None:
    for space in ("http://schemas.slic3r.org/3mf/2017/06", "http://link_to_Slic3r_schema.com/2017/06"):
        part = read(slic3r(tmp_path, 1, space))
        assert (is_the_box(part), part.notes, read_tree(tmp_path / "a.3mf").notes) == (True, MARKED, MARKED)


def test_what_is_part_of_the_body_counts(tmp_path: Path) -> None:
    for write in (
        lambda: prusa(tmp_path, 'key="volume_type" value="ModelPart"'),
        lambda: bambu(tmp_path, "normal_part"),
        lambda: cura(tmp_path, "cura:support_mesh", "False"),
        lambda: cura(tmp_path, "cura:support_mesh", ""),
        lambda: cura(tmp_path, "cura:support_mesh_drop_down"),
        lambda: cura(tmp_path, "support_mesh"),
        lambda: slic3r(tmp_path, 0),
        lambda: slic3r(tmp_path, 1, "http://elsewhere"),
    ):
        part = read(write())
        assert (part.triangles.count, part.notes) == (24, ())
    assert read(archived(tmp_path, ONE_MESH, "[object_1]\n", "model_settings.config")).triangles.count == 24


def test_a_volume_that_is_cut_out_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"cuts a volume out of its object '1' \(NegativeVolume\)"):
        read(prusa(tmp_path, 'key="volume_type" value="NegativeVolume"'))
    with pytest.raises(ReadError, match=r"cuts a volume out of its object '3' \(negative_part\)"):
        read(bambu(tmp_path, "negative_part"))


@pytest.mark.parametrize("last", ["x", "", "-1", "9" * 5000])
def test_a_run_of_triangles_is_two_numbers(last: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="as lastid, where a number must stand"):
        read(prusa(tmp_path, 'key="volume_type" value="SupportBlocker"', last))


def test_an_object_of_modifiers_alone_is_left_out(tmp_path: Path) -> None:
    both = COMPONENTS.replace('<item objectid="3"/>', '<item objectid="1"/><item objectid="2"/>')
    volume = '<volume firstid="0" lastid="11"><metadata key="modifier" value="1"/></volume>'
    runs = f'<config><object id="2">{volume}</object></config>'
    part = read(archived(tmp_path, both, runs, "Slic3r_PE_model.config"))
    assert (is_the_box(part), part.notes) == (True, MARKED)
