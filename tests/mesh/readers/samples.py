"""Small files of every format that is read, as bytes, made by hand or by the libraries that write them.

The solid is a box of 1 x 2 x 3 at (0.1, 0, 0): its eight corners and twelve triangles are the oracle.
"""

import base64
import contextlib
import io
import json
import struct
import zipfile
from pathlib import Path

import numpy as np

CORNERS = np.array([[x, y, z] for x in (0.1, 1.1) for y in (0.0, 2.0) for z in (0.0, 3.0)])
TRIANGLES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
TETRA_POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]) + 0.1
TETRA = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])


def words(row) -> str:
    """Numbers as the shortest text that reads back as the same."""
    return " ".join(map(repr, np.asarray(row).tolist()))


def binary_stl(corners=CORNERS, faces=TRIANGLES, header=b"", count=None) -> bytes:
    records = b"".join(
        struct.pack("<12fH", 0, 0, 0, *np.asarray(corners, np.float32)[face].ravel(), 0) for face in faces
    )
    return header.ljust(80, b" ") + struct.pack("<I", len(faces) if count is None else count) + records


def text_stl(name="box", corners=CORNERS, faces=TRIANGLES) -> str:
    facets = "".join(
        "facet normal 0 0 0\n outer loop\n"
        + "".join(f"  vertex {words(corners[i])}\n" for i in face)
        + " endloop\nendfacet\n"
        for face in faces
    )
    return f"solid {name}\n{facets}endsolid {name}\n"


def obj(faces=TRIANGLES, corners=CORNERS) -> str:
    return "".join(f"v {words(p)}\n" for p in corners) + "".join(f"f {words(face + 1)}\n" for face in faces)


def off(faces=TRIANGLES, corners=CORNERS) -> str:
    return (
        f"OFF\n{len(corners)} {len(faces)} 0\n"
        + "".join(f"{words(p)}\n" for p in corners)
        + "".join(f"{len(face)} {words(face)}\n" for face in faces)
    )


def ply_header(encoding, vertices, faces, kind="float") -> str:
    return (
        f"ply\nformat {encoding} 1.0\ncomment made by hand\nelement vertex {vertices}\n"
        + "".join(f"property {kind} {axis}\n" for axis in "xyz")
        + f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )


def text_ply(faces=TRIANGLES, corners=CORNERS) -> str:
    return (
        ply_header("ascii", len(corners), len(faces))
        + "".join(f"{words(p)}\n" for p in corners)
        + "".join(f"{len(face)} {words(face)}\n" for face in faces)
    )


def binary_ply(faces=TRIANGLES, corners=CORNERS, order="<") -> bytes:
    name = "binary_little_endian" if order == "<" else "binary_big_endian"
    body = np.asarray(corners).astype(f"{order}f8").tobytes()
    body += b"".join(struct.pack(f"{order}B{len(face)}i", len(face), *face) for face in faces)
    return ply_header(name, len(corners), len(faces), "double").encode() + body


def gltf_tree(corners=CORNERS, faces=TRIANGLES, nodes=None) -> tuple[dict, bytes]:
    positions = np.asarray(corners, "<f4").tobytes()
    indices = np.asarray(faces, "<u2").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes or [{"mesh": 0, "name": "box"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3 * len(faces), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)},
        ],
        "buffers": [{"byteLength": len(positions) + len(indices)}],
    }
    return tree, positions + indices


def glb(tree: dict, binary: bytes) -> bytes:
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(binary)) + b"BIN\0" + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def gltf(tree: dict, binary: bytes) -> bytes:
    tree["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    return json.dumps(tree).encode()


def mesh_3mf(corners=CORNERS, faces=TRIANGLES) -> str:
    vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in np.asarray(corners).tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    return f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"


def model_3mf(resources: str, build: str, unit: str | None = "inch") -> str:
    attribute = f' unit="{unit}"' if unit else ""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model{attribute} xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
        'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">'
        f"<resources>{resources}</resources><build>{build}</build></model>"
    )


def archive_3mf(model: str | bytes, compression=zipfile.ZIP_DEFLATED, **others: str) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", compression) as archive:
        archive.writestr("3D/3dmodel.model", model)
        for name, text in others.items():
            archive.writestr(f"3D/{name}.model", text)
    return file.getvalue()


def plain_3mf(unit: str | None = "inch") -> bytes:
    resources = f'<object id="1" type="model" name="box">{mesh_3mf()}</object>'
    return archive_3mf(model_3mf(resources, '<item objectid="1"/>', unit))


GMSH_22 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "steel"
$EndPhysicalNames
$Nodes
5
1 0.1 0.1 0.1
2 1.1 0.1 0.1
3 0.1 1.1 0.1
4 0.1 0.1 1.1
15 1.1 1.1 1.1
$EndNodes
$Elements
3
1 2 2 0 1 1 2 3
2 4 2 7 1 1 2 3 4
3 4 2 0 2 2 3 4 15
$EndElements
"""

GMSH_41 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "steel"
$EndPhysicalNames
$Entities
0 0 0 2
1 0 0 0 1 1 1 1 7 0
2 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
1 5 1 15
3 1 0 5
1
2
3
4
15
0.1 0.1 0.1
1.1 0.1 0.1
0.1 1.1 0.1
0.1 0.1 1.1
1.1 1.1 1.1
$EndNodes
$Elements
2 2 1 2
3 1 4 1
1 1 2 3 4
3 2 4 1
2 2 3 4 15
$EndElements
"""

NASTRAN = """SOL 101
CEND
BEGIN BULK
$ a comment
GRID,1,,0.1,0.1,0.1
GRID,2,,1.1,0.1,0.1
GRID*   3                               0.1             1.1
*       0.1
GRID,4,,0.1,0.1,1.1
GRID,5,,1.1,1.1,1.1
CTETRA  1       7       1       2       3       4
CTETRA,2,8,2,3,4,5
PSOLID,7,1
PSOLID,8,1
ENDDATA
"""

ABAQUS = """*HEADING
** a comment
*NODE
1, 0.1, 0.1, 0.1
2, 1.1, 0.1, 0.1
3, 0.1, 1.1, 0.1
4, 0.1, 0.1, 1.1
5, 1.1, 1.1, 1.1
*ELEMENT, TYPE=C3D4, ELSET=all
1, 1,2,3,4
2, 2,3,4,5
*ELSET, ELSET=steel
2
"""

VTK_TEXT = """# vtk DataFile Version 3.0
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0.1 0.1 0.1 1.1 0.1 0.1 0.1 1.1 0.1 0.1 0.1 1.1 1.1 1.1 1.1
CELLS 2 10
4 0 1 2 3
4 1 2 3 4
CELL_TYPES 2
10 10
CELL_DATA 2
SCALARS material int 1
LOOKUP_TABLE default
7 8
"""


def by_meshio(folder: Path, name: str, kind: str, **options) -> bytes:
    """Two tetrahedra with materials 7 and 8, written by meshio."""
    import meshio

    mesh = meshio.Mesh(TETRA_POINTS, [("tetra", TETRA)])
    if kind in ("vtk", "vtk42", "vtu", "xdmf"):
        mesh.cell_data = {"material": [np.array([7, 8])]}
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        meshio.write(folder / name, mesh, file_format=kind, **options)
    return (folder / name).read_bytes()


def surfaces() -> dict[str, tuple[str, bytes]]:
    """Name → (file name, contents) of the box in every surface format."""
    groups = (
        obj(TRIANGLES[:6])
        + "o lid\nusemtl m\n"
        + "".join(f"f {' '.join(f'{i - 8}/1/1' for i in face)}\n" for face in TRIANGLES[6:])
    )
    return {
        "stl binary": ("box.stl", binary_stl()),
        "stl text": ("box.stl", text_stl().encode()),
        "obj": ("box.obj", groups.encode()),
        "obj quads": ("box.obj", obj(QUADS).encode()),
        "off": ("box.off", off().encode()),
        "off quads": ("box.off", off(QUADS).encode()),
        "ply text": ("box.ply", text_ply().encode()),
        "ply little": ("box.ply", binary_ply()),
        "ply big, mixed": ("box.ply", binary_ply([*TRIANGLES[:10].tolist(), QUADS[5].tolist()], order=">")),
        "glb": ("box.glb", glb(*gltf_tree())),
        "gltf": ("box.gltf", gltf(*gltf_tree())),
        "3mf": ("box.3mf", plain_3mf()),
        "3mf stored": (
            "box.3mf",
            archive_3mf(
                model_3mf(
                    f'<object id="1">{mesh_3mf()}</object><object id="2"><components>'
                    '<component objectid="1" transform="1 0 0 0 1 0 0 0 1 9 9 9"/></components></object>',
                    '<item objectid="2"/>',
                ),
                zipfile.ZIP_STORED,
            ),
        ),
    }


def volumes(folder: Path) -> dict[str, tuple[str, bytes]]:
    """Name → (file name, contents) of the two tetrahedra in every volume format."""
    return {
        "gmsh 2.2": ("two.msh", GMSH_22.encode()),
        "gmsh 4.1": ("two.msh", GMSH_41.encode()),
        "gmsh 2.2 binary": ("two.msh", by_meshio(folder, "22.msh", "gmsh22")),
        "gmsh 4.1 binary": ("two.msh", by_meshio(folder, "41.msh", "gmsh")),
        "nastran": ("two.bdf", NASTRAN.encode()),
        "abaqus": ("two.inp", ABAQUS.encode()),
        "vtk text": ("two.vtk", VTK_TEXT.encode()),
        "vtk binary": ("two.vtk", by_meshio(folder, "42.vtk", "vtk42")),
        "vtk 5.1": ("two.vtk", by_meshio(folder, "51.vtk", "vtk")),
        "vtu": ("two.vtu", by_meshio(folder, "zlib.vtu", "vtu")),
        "vtu text": ("two.vtu", by_meshio(folder, "text.vtu", "vtu", binary=False)),
        "med": ("two.med", by_meshio(folder, "two.med", "med")),
        "xdmf": ("two.xdmf", by_meshio(folder, "two.xdmf", "xdmf", data_format="XML")),
        "medit": ("two.mesh", by_meshio(folder, "two.mesh", "medit")),
        "netgen": ("two.vol", by_meshio(folder, "two.vol", "netgen")),
        "su2": ("two.su2", by_meshio(folder, "two.su2", "su2")),
        "avsucd": ("two.avs", by_meshio(folder, "two.avs", "avsucd")),
    }
