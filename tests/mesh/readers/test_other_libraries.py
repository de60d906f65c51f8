"""What trimesh, pycollada and meshio misread, shown as long as it is so: our readers and guards stand on it.

A test that fails says that a library has been mended: then see whether what stands on the claim is still needed.
"""

import contextlib
import importlib
import io
import struct
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh
from tests.mesh.readers.samples import (
    ABAQUS,
    CORNERS,
    GMSH_41,
    IN_PLACE,
    INSTANCE_3DXML,
    NASTRAN,
    PART_3DXML,
    QUADS,
    TRIANGLES,
    archive_3mf,
    dae,
    geometry_dae,
    glb,
    gltf_tree,
    mesh_3mf,
    model_3mf,
    obj,
    off,
    representation_3dxml,
    text_ply,
    text_stl,
    three_dxml,
    visual_xaml,
    volumes,
    xaml,
)

BOX = CORNERS[TRIANGLES]


def by_trimesh(kind: str, data: str | bytes) -> np.ndarray:
    """The corners that trimesh reads, (n, 3, 3)."""
    file = io.BytesIO(data.encode() if isinstance(data, str) else data)
    scene = trimesh.load_scene(file, file_type=kind, process=False)
    return np.concatenate([mesh.triangles for mesh in scene.dump()]) if scene.geometry else np.empty((0, 3, 3))


def by_meshio(folder: Path, name: str, data: str | bytes) -> meshio.Mesh:
    (folder / name).write_bytes(data.encode() if isinstance(data, str) else data)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return meshio.read(folder / name)


def without_last_lines(text: str, count: int) -> str:
    return "".join(line + "\n" for line in text.splitlines()[:-count])


def bed_3mf() -> bytes:
    """Ten rows of ten boxes: 1200 triangles."""

    def components(of: int, step: str) -> str:
        moves = (f'<component objectid="{of}" transform="1 0 0 0 1 0 0 0 1 {step.format(9 * i)}"/>' for i in range(10))
        return f"<components>{''.join(moves)}</components>"

    resources = f'<object id="1">{mesh_3mf()}</object><object id="2">{components(1, "{} 0 0")}</object>'
    return archive_3mf(
        model_3mf(f'{resources}<object id="3">{components(2, "0 {} 0")}</object>', '<item objectid="3"/>')
    )


def sparse_glb() -> bytes:
    """The box, whose first corner a sparse accessor moves to (-5, -5, -5)."""
    tree, binary = gltf_tree()
    start = len(binary)
    views = {"indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}
    tree["accessors"][0]["sparse"] = {"count": 1, **views}
    tree["bufferViews"] += [
        {"buffer": 0, "byteOffset": start, "byteLength": 2},
        {"buffer": 0, "byteOffset": start + 4, "byteLength": 12},
    ]
    tree["buffers"][0]["byteLength"] = start + 16
    return glb(tree, binary + struct.pack("<Hxx3f", 0, -5, -5, -5))


def supported_3mf() -> bytes:
    resources = f'<object id="1">{mesh_3mf()}</object><object id="2" type="support">{mesh_3mf(CORNERS + 9)}</object>'
    return archive_3mf(model_3mf(resources, '<item objectid="1"/><item objectid="2"/>'))


BACKWARDS = "".join(f"f {' '.join(str(i - 8) for i in face)}\n" for face in TRIANGLES[6:])
BACKWARDS = obj(TRIANGLES[:6]) + BACKWARDS + "v 9 9 9\n"
TRIMESH: dict[str, Callable[[], bool]] = {
    "passes over a solid of a text STL that was cut short": lambda: (
        len(by_trimesh("stl", text_stl() + text_stl()[:-40])) == 12
    ),
    "passes over the faces that an OFF lacks": lambda: len(by_trimesh("off", without_last_lines(off(), 3))) == 9,
    "passes over the faces that a text PLY lacks": lambda: (
        len(by_trimesh("ply", without_last_lines(text_ply(), 3))) == 9
    ),
    "counts a negative OBJ index from the end of the file": lambda: (
        not np.array_equal(by_trimesh("obj", BACKWARDS), BOX)
    ),
    "loses instances of nested 3MF assemblies": lambda: len(by_trimesh("3mf", bed_3mf())) < 1200,
    "takes the supports in a 3MF for the part": lambda: len(by_trimesh("3mf", supported_3mf())) == 24,
    "passes over sparse glTF positions": lambda: by_trimesh("glb", sparse_glb()).min() > -5,
}  # fmt: skip

INSTANCE = '<instance_geometry url="#box"/>'
GAP = geometry_dae().replace('stride="3"', 'stride="3" offset="3"')
TWO_LISTS = geometry_dae(faces=TRIANGLES[:6]).replace("</p>", "</p><p>0 0 1 0 2 0</p>")
HOLE = "<ph><p>0 0 1 0 3 0 2 0</p><h>0 0 1 0 3 0</h></ph></polygons>"
PYCOLLADA: dict[str, Callable[[], bool]] = {
    "rounds coordinates to float32": lambda: not np.array_equal(by_trimesh("dae", dae()), BOX),
    "takes NaN for zero": lambda: bool(
        np.isfinite(by_trimesh("dae", dae(geometry_dae(corners=np.where(CORNERS == 2, np.nan, CORNERS))))).all()
    ),
    "reads positions from the first number, wherever they begin": lambda: (
        len(by_trimesh("dae", dae(GAP))) == 12
    ),
    "reads the first list of triangles alone": lambda: len(by_trimesh("dae", dae(TWO_LISTS))) == 6,
    "passes over polygons with holes": lambda: (
        len(by_trimesh("dae", dae(geometry_dae(faces=QUADS, tag="polygons").replace("</polygons>", HOLE)))) == 12
    ),
    "takes any axis for a unit vector": lambda: (
        np.abs(by_trimesh("dae", dae(nodes=f"<node><rotate>0 0 10 90</rotate>{INSTANCE}</node>"))).max() > 5
    ),
}  # fmt: skip

TWINS = PART_3DXML + PART_3DXML.replace('"2"', '"22"').replace('"3"', '"23"').replace('"4"', '"24"').replace(
    ">2<", ">22<").replace(">4<", ">24<").replace("Box.3DRep", "Other.3DRep")  # fmt: skip
TWO_PARTS = TWINS + "".join(
    INSTANCE_3DXML.format(id=f"i{part}", owner=1, target=part, matrix=IN_PLACE) for part in (2, 22)
)
LEVEL = '<PolygonalLOD accuracy="0.2"><Faces><Face triangles="0 1 3"/></Faces></PolygonalLOD>'
MIRROR = "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
SCALED = visual_xaml(matrix=MIRROR).replace(f'<MatrixTransform3D Matrix="{MIRROR}"/>', '<ScaleTransform3D ScaleX="2"/>')


def two_parts(parts: str) -> bytes:
    """A 3DXML archive with the box, and the box moved by 9, as two parts that are called alike."""
    return three_dxml(parts, Other__3DRep=representation_3dxml(CORNERS + 9))


def volume(corners: np.ndarray) -> float:
    return float(np.linalg.det(corners).sum() / 6)


SCENES: dict[str, Callable[[], bool]] = {
    "takes parts of one name in a 3DXML for one": lambda: by_trimesh("3dxml", two_parts(TWO_PARTS)).min() == 9,
    "adds the coarser levels of detail in a 3DXML": lambda: (
        len(by_trimesh("3dxml", three_dxml(representation=representation_3dxml(level=LEVEL)))) == 13
    ),
    "leaves out what a 3DXML keeps in another file": lambda: (
        len(by_trimesh("3dxml", two_parts(TWO_PARTS.replace(">22</IsInst", ">urn:3DXML:a.3dxml#22</IsInst")))) == 12
    ),
    "passes over the scale of a XAML": lambda: np.array_equal(by_trimesh("xaml", xaml(SCALED)), BOX),
    "leaves a mirrored XAML inside out": lambda: volume(by_trimesh("xaml", xaml(visual_xaml(matrix=MIRROR)))) < 0,
}  # fmt: skip


def vtu_of_two_pieces(folder: Path) -> bytes:
    _, data = volumes(folder)["vtu text"]
    start, stop = data.index(b"<Piece"), data.index(b"</Piece>") + 8
    return data[:stop] + data[start:stop] + data[stop:]


def cells(mesh: meshio.Mesh) -> int:
    return sum(map(len, mesh.cells))


def refuses_a_gmsh_with_a_group_for_some(folder: Path) -> bool:
    with contextlib.suppress(Exception):
        by_meshio(folder, "a.msh", GMSH_41)
        return False
    return True


def passes_over_cells_of_vtk() -> bool:
    read = importlib.import_module("meshio._vtk_common").vtk_cells_from_data  # which the reader does not replace
    blocks, _ = read(np.arange(8), np.array([4, 8]), np.array([10, 37]), {})
    return [len(block) for block in blocks] == [1]


WEDGE_18 = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n18\n"
    + "".join(f"{i + 1} {i} 0 0\n" for i in range(18))
    + f"$EndNodes\n$Elements\n1\n1 13 0 {' '.join(map(str, range(1, 19)))}\n$EndElements\n"
)
INSTANCE_OF_ABAQUS = "*Instance, name=a, part=b\n1., 0., 0.\n*End Instance\n"
MESHIO: dict[str, Callable[[Path], bool]] = {
    "refuses a Gmsh file where only some entities are in a group": refuses_a_gmsh_with_a_group_for_some,
    "leaves the nodes of wedge18 in Gmsh's order": lambda folder: (
        by_meshio(folder, "a.msh", WEDGE_18).cells[0].data[0].tolist() == [*range(18)]
    ),
    "passes over the place of an Abaqus instance": lambda folder: (
        by_meshio(folder, "a.inp", ABAQUS + INSTANCE_OF_ABAQUS).points.min() == 0.1
    ),
    "passes over a Nastran card in lower case": lambda folder: (
        cells(by_meshio(folder, "a.bdf", NASTRAN.replace("CTETRA,2", "ctetra,2"))) == 1
    ),
    "passes over the pieces of a VTU but one": lambda folder: (
        cells(by_meshio(folder, "a.vtu", vtu_of_two_pieces(folder))) == 2
    ),
    "passes over the cells of VTK that it does not know": lambda _: passes_over_cells_of_vtk(),
}  # fmt: skip


def still(library: str, claim: str, misreads: Callable[[], bool]) -> None:
    """Fail where a library reads rightly, or refuses, what it is said to misread."""
    try:
        wrong = misreads()
    except Exception as refusal:
        pytest.fail(f"{library} {version(library)} no longer {claim}, but says: {refusal!r}")
    assert wrong, f"{library} {version(library)} no longer {claim}: see whether our reader or guard is still needed"


@pytest.mark.parametrize("claim", TRIMESH)
def test_trimesh_misreads_what_our_readers_read(claim: str) -> None:
    still("trimesh", claim, TRIMESH[claim])


@pytest.mark.parametrize("claim", PYCOLLADA)
def test_pycollada_misreads_what_the_reader_of_collada_guards(claim: str) -> None:
    still("pycollada", claim, PYCOLLADA[claim])


@pytest.mark.parametrize("claim", SCENES)
def test_trimesh_misreads_what_the_readers_of_scenes_guard(claim: str) -> None:
    still("trimesh", claim, SCENES[claim])


@pytest.mark.parametrize("claim", MESHIO)
def test_meshio_misreads_what_the_guards_refuse(claim: str, tmp_path: Path) -> None:
    still("meshio", claim, lambda: MESHIO[claim](tmp_path))
