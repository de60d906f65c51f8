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

from inertia.mesh.part import Part
from inertia.mesh.read import read

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


POSITIONS = """<source id="{name}-positions">
<float_array id="{name}-array" count="{numbers}">{values}</float_array><technique_common>
<accessor source="#{name}-array" count="{points}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="{name}-vertices"><input semantic="POSITION" source="#{name}-positions"/></vertices>"""


def geometry_dae(name="box", corners=CORNERS, faces=TRIANGLES, tag="triangles") -> str:
    """A geometry: triangles, or polygons, strips or fans, with a second index (that of a normal) at each corner."""
    source = POSITIONS.format(name=name, numbers=3 * len(corners), points=len(corners), values=words(np.ravel(corners)))
    lists = [" ".join(f"{corner} 0" for corner in face) for face in faces]
    if tag in ("triangles", "polylist"):
        lists = [" ".join(lists)]
    sizes = f"<vcount>{words([len(face) for face in faces])}</vcount>" if tag == "polylist" else ""
    inputs = f'<input semantic="VERTEX" source="#{name}-vertices" offset="0"/>'
    inputs += f'<input semantic="NORMAL" source="#{name}-positions" offset="1"/>'
    body = sizes + "".join(f"<p>{each}</p>" for each in lists)
    return f'<geometry id="{name}"><mesh>{source}<{tag} count="{len(faces)}">{inputs}{body}</{tag}></mesh></geometry>'


def dae(geometries: str | None = None, nodes: str | None = None, unit: str = "", library: str = "") -> str:
    """A Collada document of geometries and the nodes of its scene."""
    if nodes is None:
        nodes = '<node><instance_geometry url="#box"/></node>'
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
        f"<asset>{unit}<up_axis>Z_UP</up_axis></asset>"
        f"<library_geometries>{geometry_dae() if geometries is None else geometries}</library_geometries>{library}"
        f'<library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>'
        '<scene><instance_visual_scene url="#scene"/></scene></COLLADA>'
    )


def archive(**members: str | bytes) -> bytes:
    """A zip archive; `__` in the names stands for a dot."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as target:
        for name, data in members.items():
            target.writestr(name.replace("__", "."), data)
    return file.getvalue()


def representation_3dxml(corners=CORNERS, face="", level="") -> str:
    """A tessellated part: the box, unless the attributes of its face say otherwise; `level` are coarser faces."""
    face = face or f'triangles="{words(TRIANGLES.ravel())}"'
    points = ",".join(words(corner) for corner in corners)
    return (
        '<XMLRepresentation xmlns="http://www.3ds.com/xsd/3DXML" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">'
        f'<Root xsi:type="BagRepType"><Rep xsi:type="PolygonalRepType">{level}<Faces><Face {face}/></Faces>'
        f"<VertexBuffer><Positions>{points}</Positions><Normals>{points}</Normals></VertexBuffer></Rep></Root>"
        "</XMLRepresentation>"
    )


INSTANCE_3DXML = """<Instance3D id="{id}" name="same"><IsAggregatedBy>{owner}</IsAggregatedBy>
<IsInstanceOf>{target}</IsInstanceOf><RelativeMatrix>{matrix}</RelativeMatrix></Instance3D>"""
IN_PLACE = "1 0 0 0 1 0 0 0 1 0 0 0"
PART_3DXML = """<Reference3D id="2" name="box"/>
<InstanceRep id="3" name="same"><IsAggregatedBy>2</IsAggregatedBy><IsInstanceOf>4</IsInstanceOf></InstanceRep>
<ReferenceRep id="4" name="same" format="TESSELLATED" associatedFile="urn:3DXML:Box.3DRep"/>"""


def three_dxml(parts: str | None = None, representation: str | None = None, **others: str) -> bytes:
    """A 3DXML archive: what its product is made of, and its representations."""
    if parts is None:
        parts = PART_3DXML + INSTANCE_3DXML.format(id=5, owner=1, target=2, matrix=IN_PLACE)
    product = (
        '<Model_3dxml xmlns="http://www.3ds.com/xsd/3DXML"><ProductStructure root="1">'
        f'<Reference3D id="1" name="product"/>{parts}</ProductStructure></Model_3dxml>'
    )
    return archive(
        Manifest__xml="<Manifest><Root>Product.3dxml</Root></Manifest>",
        Product__3dxml=product,
        Box__3DRep=representation_3dxml() if representation is None else representation,
        **others,
    )


def visual_xaml(corners=CORNERS, faces=TRIANGLES, matrix: str | None = None) -> str:
    points, indices = (
        " ".join(",".join(map(repr, each)) for each in np.asarray(corners).tolist()),
        words(np.ravel(faces)),
    )
    placed = matrix and f'<ModelVisual3D.Transform><MatrixTransform3D Matrix="{matrix}"/></ModelVisual3D.Transform>'
    return (
        f"<ModelVisual3D>{placed or ''}<ModelVisual3D.Content><GeometryModel3D><GeometryModel3D.Geometry>"
        f'<MeshGeometry3D Positions="{points}" Normals="" TriangleIndices="{indices}"/></GeometryModel3D.Geometry>'
        "</GeometryModel3D></ModelVisual3D.Content></ModelVisual3D>"
    )


def xaml(visuals: str | None = None) -> str:
    return (
        '<Viewport3D xmlns="http://schemas.microsoft.com/winfx/2006/xaml/presentation">'
        f"{visual_xaml() if visuals is None else visuals}</Viewport3D>"
    )


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
        "dae": ("box.dae", dae(unit='<unit name="inch" meter="0.0254"/>').encode()),
        "dae quads": ("box.dae", dae(geometry_dae(faces=QUADS, tag="polylist")).encode()),
        "zae": ("box.zae", archive(box__dae=dae())),
        "3dxml": ("box.3dxml", three_dxml()),
        "xaml": ("box.xaml", xaml().encode()),
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


MIDDLES = {
    "tetra10": [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
    "hexahedron20": [
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ],
    "wedge15": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    "pyramid13": [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
}
MIDDLES["hexahedron27"] = [
    *MIDDLES["hexahedron20"],
    *((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7), tuple(range(8))),
]
MIDDLES["wedge18"] = [*MIDDLES["wedge15"], (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
MIDDLES["pyramid14"] = [*MIDDLES["pyramid13"], (0, 1, 2, 3)]
"""VTK's order: the corners that each further node is in the middle of."""


def read_text(folder: Path, name: str, text: str | bytes, **options: str) -> Part:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read(path, **options)


def names_of(part: Part) -> list[str] | None:
    return part.regions and [part.regions.names[i] for i in part.regions.index]
