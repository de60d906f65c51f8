"""XDMF: a box of 2 × 3 × 4, of six tetrahedra around a diagonal, and what would change it unread."""

from pathlib import Path

import numpy as np
import pytest

from inertia import mass_properties
from inertia.errors import ReadError
from inertia.mesh.read import read

pytest.importorskip("h5py")

POINTS = " ".join(f"{2 * (k & 1)} {3 * (k >> 1 & 1)} {4 * (k >> 2)}" for k in range(8))
TETRA = [f"0 {nodes} 7" for nodes in ("1 3", "3 2", "2 6", "6 4", "4 5", "5 1")]
ITEM = '<DataItem Dimensions="{}" Format="XML" NumberType="{}" Precision="8">{}</DataItem>'


def xdmf(kind: str = "Tetrahedron", cells: str = " ".join(TETRA), size: str = "6 4", count: int = 6) -> str:
    return (
        f'<Xdmf Version="2.0"><Domain><Grid><Topology TopologyType="{kind}" NumberOfElements="{count}">'
        f'{ITEM.format(size, "Int", cells)}</Topology><Geometry GeometryType="XYZ">'
        f"{ITEM.format('8 3', 'Float', POINTS)}</Geometry></Grid></Domain></Xdmf>"
    )


MIXED = " ".join(f"6 {each}" for each in TETRA)
VERSIONS = ('Version="2.0"', 'Version="3.0"')


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(
    "text",
    [
        xdmf(),
        '<?xml version="1.0" ?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n' + xdmf(),
        '<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd">' + xdmf(),
        xdmf().replace("<Geometry ", '<Geometry Origin="" ').replace("<Topology ", '<Topology BaseOffset="0" '),
        xdmf("Mixed", MIXED, "30"),
        xdmf("Mixed", f"1 1 0 2 2 0 7 {MIXED} 1 1 6", "40", 9),
        xdmf("Mixed", "9 0 1 3 2 4 5 7 6", "9", 1),
        xdmf().replace(
            "<Topology ", '<Time TimeType="Single" Value="0.5"/><Information Name="a" Value="b"/><Topology '
        ),
        xdmf().replace("<Domain>", '<Information Name="a"/><Domain><Information Name="a" Value="b"/>'),
        xdmf().replace("TopologyType", "Type").replace("GeometryType", "Type"),
        xdmf().replace(' GeometryType="XYZ"', ""),
        xdmf().replace(' Format="XML"', ""),
        xdmf().replace('"XML"', '"xml"'),
        xdmf().replace(' NumberType="Int" Precision="8"', ""),
        xdmf().replace("</Grid>", f'<Attribute Name="a">{ITEM.format(8, "Float", "1 " * 8)}</Attribute></Grid>'),
        xdmf().replace("</Grid>", f'<Attribute Name="a" Center="Edge">{ITEM.format(1, "Int", 1)}</Attribute></Grid>'),
        xdmf()
        .replace("<Grid>", '<Grid GridType="Collection" CollectionType="Temporal"><Grid>')
        .replace("</Grid>", "</Grid></Grid>"),
    ],
)
def test_the_box_is_read(text: str, version: str, tmp_path: Path) -> None:
    (tmp_path / "a.xdmf").write_text(text.replace(VERSIONS[0], version))
    properties = mass_properties(read(tmp_path / "a.xdmf", unit="m"), 1.0)
    assert properties.mass == pytest.approx(24, rel=1e-15)
    assert properties.center_of_mass == pytest.approx([1, 1.5, 2], rel=1e-15)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (xdmf("Mixed", MIXED, "25"), "Dimensions '25', but 30 numbers"),
        (xdmf(size="5 4"), "Dimensions '5 4', but 24 numbers"),
        (xdmf(cells="a " + " ".join(TETRA)), "'a', which is not a whole number"),
        (xdmf(count=7), "it lists 7 cells, but meshio could read 6"),
        (xdmf("Mixed", MIXED, "30", 7), "it lists 7 cells, but meshio could read 6"),
        (xdmf("Mixed", "1 2 0 1 " + MIXED, "34", 7), "one of the kind 1 at place 0"),
        (xdmf("Mixed", MIXED + " 38 0 1 3 7", "35", 7), "one of the kind 38 at place 30"),
        (xdmf("Mixed", MIXED[:-2], "29"), "ends within one"),
        (xdmf().replace("<Topology ", '<Topology BaseOffset="1" '), "its Topology has the BaseOffset '1'"),
        (xdmf().replace("<Topology ", '<Topology Order="3 2 1 0" '), "its Topology has the Order '3 2 1 0'"),
        (xdmf().replace("<Geometry ", '<Geometry Origin="10 0 0" '), "its Geometry has the Origin '10 0 0'"),
        (xdmf().replace("<DataItem ", '<DataItem ItemType="HyperSlab" ', 1), "its data are a 'HyperSlab'"),
        (
            xdmf().replace("<Grid>", '<Grid GridType="Collection"><Grid/><Grid>').replace("</Grid>", "</Grid></Grid>"),
            r"it has 2 grids \(Uniform\), but one",
        ),
        (
            xdmf().replace("</Grid>", '</Grid><i:include xmlns:i="http://www.w3.org/2001/XInclude" href="b.xdmf"/>'),
            "it includes parts of other files",
        ),
        (xdmf().replace("</Grid>", "<Geometry/></Grid>"), "it has 2 elements Geometry"),
        ('<!DOCTYPE Xdmf [<!ENTITY a "6">]>' + xdmf(), "declares a document type with contents"),
        (f'<!--<!DOCTYPE Xdmf []>--><!DOCTYPE Xdmf [<!ENTITY a "6">]>{xdmf()}', "a document type with contents"),
    ],
)
def test_what_is_not_understood_is_refused(text: str, reason: str, version: str, tmp_path: Path) -> None:
    (tmp_path / "a.xdmf").write_text(text.replace(VERSIONS[0], version))
    with pytest.raises(ReadError, match=reason):
        read(tmp_path / "a.xdmf")


def test_a_grid_of_another_version_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.xdmf").write_text(xdmf().replace(VERSIONS[0], 'Version="1.1"'))
    with pytest.raises(ReadError, match=r"it is of the version '1.1', but 2 and 3 are read"):
        read(tmp_path / "a.xdmf")


def test_data_in_hdf5_are_as_many_as_stated(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["m/u"] = np.array([each.split() for each in TETRA], int)
    inline = ITEM.format("6 4", "Int", " ".join(TETRA))
    for size, count in (("6 4", 6), ("8 4", 8)):
        outside = ITEM.format(size, "Int", "a.h5:/m/u").replace('"XML"', '"HDF"')
        (tmp_path / f"{count}.xdmf").write_text(xdmf(count=count).replace(inline, outside))
    assert mass_properties(read(tmp_path / "6.xdmf", unit="m"), 1.0).mass == pytest.approx(24, rel=1e-15)
    with pytest.raises(ReadError, match="Dimensions '8 4', but 24 numbers"):
        read(tmp_path / "8.xdmf")
