"""A second reader of every format, made of little but Python: slow, plain, and without a line of the first.

Each returns the cells of a file as (kind, corners (k, 3)), in the words of the format's specification. They are as
lax as they like about what is no geometry, and raise whatever comes where a file is damaged: it is for the first
reader to refuse it, and where that reads on, both have to see the same.
"""

import base64
import io
import itertools
import json
import math
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

Cell = tuple[str, np.ndarray]

KINDS = {
    1: "vertex",
    3: "line",
    5: "triangle",
    7: "polygon",
    9: "quad",
    10: "tetra",
    12: "hexahedron",
    13: "wedge",
    14: "pyramid",
}
"""VTK's numbers of the cells of first order."""
NODES = {"vertex": 1, "line": 2, "triangle": 3, "quad": 4, "tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5}
DIMENSION = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2, "polygon": 2}
GMSH = {1: "line", 2: "triangle", 3: "quad", 4: "tetra", 5: "hexahedron", 6: "wedge", 7: "pyramid", 15: "vertex"}


def cells_of(points: Sequence[Sequence[float]], cells: Sequence[tuple[str, Sequence[int]]]) -> list[Cell]:
    places = np.array(points, float)
    for kind, nodes in cells:
        assert min(nodes) >= 0
        assert len(nodes) == NODES.get(kind, len(nodes))
    return [(kind, places[list(nodes)]) for kind, nodes in cells]


def fans(polygons: Sequence[Sequence[int]]) -> list[tuple[str, list[int]]]:
    return [("triangle", [face[0], a, b]) for face in polygons for a, b in itertools.pairwise(face[1:])]


def floats(words: Sequence[bytes | str]) -> list[float]:
    return [float(word) for word in words]


def moved(points: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Columns; the corners of a mirrored triangle are turned round by `turned`."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def turned(cells: list[Cell], matrix: np.ndarray) -> list[Cell]:
    """The cells moved by a matrix that acts on columns; mirrored ones face outwards still."""
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    return [(kind, moved(corners, matrix)[::-1] if mirrored else moved(corners, matrix)) for kind, corners in cells]


# Surfaces


def stl(data: bytes) -> list[Cell]:
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        records = (struct.unpack_from("<12f", data, 84 + 50 * i) for i in range(count))
        return [("triangle", np.reshape(record[3:], (3, 3))) for record in records]
    lines = [line.split() for line in re.split(rb"[\r\n]", data.removeprefix(b"\xef\xbb\xbf").lower())]
    words = iter([word for line in lines if line[:1] not in ([b"solid"], [b"endsolid"]) for word in line])
    corners = [floats([next(words) for _ in range(3)]) for word in words if word == b"vertex"]
    return [("triangle", np.array(corners[i : i + 3])) for i in range(0, len(corners), 3)]


def obj(data: bytes) -> list[Cell]:
    points: list[list[float]] = []
    polygons = []
    for line in re.sub(rb"\\\r?\n", b" ", data).splitlines():
        keyword, *words = line.split() or [b""]
        if keyword == b"v":
            points.append(floats(words[:3]))
        elif keyword in (b"f", b"fo"):
            places = [int(word.partition(b"/")[0]) for word in words]
            polygons.append([i - 1 if i > 0 else len(points) + i for i in places])
    return cells_of(points, fans(polygons))


def off(data: bytes) -> list[Cell]:
    lines = [line.split() for line in re.sub(rb"#[^\r\n]*", b"", data).splitlines() if line.strip()]
    start = next(i for i, line in enumerate(lines) if b"OFF" in line[0])
    prefix = lines[start][0].partition(b"OFF")[0]
    lines = [line for line in [lines[start][1:], *lines[start + 1 :]] if line]
    vertices = int(lines[0][0])
    assert b"C" in prefix or b"N" in prefix or len({len(line) for line in lines[1 : vertices + 1]}) == 1
    points = [floats(line[:3]) for line in lines[1 : vertices + 1]]
    polygons = [[int(word) for word in line[1 : 1 + int(line[0])]] for line in lines[vertices + 1 :]]
    return cells_of(points, fans(polygons))


PLY_TYPES = {
    "char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
    "int": "i", "int32": "i", "uint": "I", "uint32": "I", "int64": "q", "uint64": "Q",
    "float": "f", "float32": "f", "double": "d", "float64": "d",
}  # fmt: skip


def ply(data: bytes) -> list[Cell]:
    header, body = re.split(rb"end_header[^\r\n]*(?:\r\n|\r|\n)", data, maxsplit=1)
    lines = [line.decode("utf-8", "replace").split() for line in re.split(rb"[\r\n]", header) if line.strip()]
    encoding = next(line[1] for line in lines if line[0] == "format")
    words = iter(body.split())
    at = 0

    def value(name: str) -> float:
        nonlocal at
        if encoding == "ascii":
            return float(next(words))
        code = (">" if "big" in encoding else "<") + PLY_TYPES[name]
        (number,) = struct.unpack_from(code, body, at)
        at += struct.calcsize(code)
        return number

    tables: dict[str, list[dict[str, object]]] = {}
    elements = [(line[1], int(line[2]), i) for i, line in enumerate(lines) if line[0] == "element"]
    for (name, count, start), stop in zip(elements, [*(i for _, _, i in elements[1:]), len(lines)], strict=True):
        properties = [line[1:] for line in lines[start:stop] if line[0] == "property"]
        rows = tables[name] = []
        for _ in range(count):
            rows.append({})
            for each in properties:
                if each[0] == "list":
                    rows[-1][each[3]] = [value(each[2]) for _ in range(int(value(each[1])))]
                else:
                    rows[-1][each[1]] = value(each[0])
    points = [[row[axis] for axis in "xyz"] for row in tables["vertex"]]
    polygons = [next(row[key] for key in ("vertex_indices", "vertex_index") if key in row) for row in tables["face"]]
    return cells_of(points, fans([[int(i) for i in face] for face in polygons]))


def gltf(data: bytes) -> list[Cell]:
    binary = b""
    if data[:4] == b"glTF":
        length = int.from_bytes(data[12:16], "little")
        binary = data[28 + length :]
        data = data[20 : 20 + length]
    tree = json.loads(data)

    def accessor(index: int) -> list[tuple[float, ...]]:
        entry = tree["accessors"][index]
        view = tree["bufferViews"][entry["bufferView"]]
        uri = tree["buffers"][view["buffer"]].get("uri")
        source = binary if uri is None else base64.b64decode(uri.partition(",")[2])
        width = {"SCALAR": 1, "VEC3": 3}[entry["type"]]
        code = f"<{width}" + {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}[entry["componentType"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        step = view.get("byteStride", struct.calcsize(code))
        return [struct.unpack_from(code, source, start + i * step) for i in range(entry["count"])]

    def node(index: int) -> Iterator[Cell]:
        entry = tree["nodes"][index]
        assert not {"matrix", "translation", "rotation", "scale"} & set(entry)
        for child in entry.get("children", []):
            yield from node(child)
        for primitive in tree["meshes"][entry["mesh"]]["primitives"] if "mesh" in entry else ():
            mode = primitive.get("mode", 4)
            if mode < 4:
                continue
            points = accessor(primitive["attributes"]["POSITION"])
            corners = [i for (i,) in accessor(primitive["indices"])] if "indices" in primitive else range(len(points))
            if mode == 4:
                faces = [corners[i : i + 3] for i in range(0, len(corners), 3)]
            elif mode == 5:
                faces = [
                    [*corners[i : i + 3]] if i % 2 == 0 else [corners[i], corners[i + 2], corners[i + 1]]
                    for i in range(len(corners) - 2)
                ]
            else:
                faces = [[corners[0], *pair] for pair in itertools.pairwise(corners[1:])]
            yield from cells_of(points, [("triangle", face) for face in faces])

    if "scenes" in tree:
        roots = tree["scenes"][tree.get("scene", 0)].get("nodes", [])
    else:
        children = {child for each in tree.get("nodes", []) for child in each.get("children", [])}
        roots = [i for i in range(len(tree.get("nodes", []))) if i not in children]
    return [cell for root in roots for cell in node(root)]


def parsed(data: bytes) -> ElementTree.Element:
    root = ElementTree.fromstring(data)
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    return root


def unzipped(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {name.lstrip("/").lower(): archive.read(name) for name in archive.namelist()}


def three_mf(data: bytes) -> list[Cell]:
    root = parsed(next(text for name, text in unzipped(data).items() if name.endswith(".model")))
    objects = {each.get("id"): each for each in root.iter("object")}

    def matrix(text: str | None) -> np.ndarray:
        whole = np.eye(4)
        if text is not None:
            whole[:3] = np.array(floats(text.split())).reshape(4, 3).T
        return whole

    def placed(name: str | None, above: np.ndarray) -> Iterator[Cell]:
        if objects[name].get("type") in helpers and objects[name].find("components") is None:
            return
        points = [floats([each.get(axis, "") for axis in "xyz"]) for each in objects[name].iter("vertex")]
        faces = [[int(each.get(f"v{i}", "")) for i in (1, 2, 3)] for each in objects[name].iter("triangle")]
        yield from turned(cells_of(points, [("triangle", face) for face in faces]), above)
        for each in objects[name].iter("component"):
            yield from placed(each.get("objectid"), above @ matrix(each.get("transform")))

    helpers = ("support", "solidsupport", "other")
    return [cell for each in root.iter("item") for cell in placed(each.get("objectid"), matrix(each.get("transform")))]


# Scenes


def collada(data: bytes) -> list[Cell]:
    root = parsed(data)
    by_id = {each.get("id"): each for each in root.iter() if each.get("id") is not None}

    def transform(element: ElementTree.Element) -> np.ndarray:
        values = np.array(floats((element.text or "").split()))
        matrix = np.eye(4)
        match element.tag:
            case "matrix":
                return values.reshape(4, 4)
            case "translate":
                matrix[:3, 3] = values
            case "scale":
                matrix[:3, :3] = np.diag(values)
            case "rotate":
                axis = values[:3] / np.linalg.norm(values[:3])
                matrix[:3, :3] = Rotation.from_rotvec(math.radians(values[3]) * axis).as_matrix()
        return matrix

    def geometry(element: ElementTree.Element) -> list[Cell]:
        points = np.array(floats(element.findtext(".//float_array", "").split())).reshape(-1, 3)
        stride = 1 + max(int(each.get("offset", "")) for each in element.findall(".//input[@offset]"))
        offset = int(element.find(".//input[@semantic='VERTEX']").get("offset"))
        cells = []
        for each in element.iter():
            if each.tag not in ("triangles", "polylist"):
                continue
            corners = [int(word) for word in each.findtext("p", "").split()][offset::stride]
            counts = [int(word) for word in each.findtext("vcount", "").split()] or [3] * (len(corners) // 3)
            rest = iter(corners)
            cells += fans([[next(rest) for _ in range(count)] for count in counts])
        return cells_of(points.tolist(), cells)

    def walk(node: ElementTree.Element, above: np.ndarray) -> Iterator[Cell]:
        for element in node:
            match element.tag:
                case "matrix" | "translate" | "scale" | "rotate":
                    above = above @ transform(element)
                case "node":
                    yield from walk(element, above)
                case "instance_node":
                    yield from walk(by_id[element.get("url", "")[1:]], above)
                case "instance_geometry":
                    yield from turned(geometry(by_id[element.get("url", "")[1:]]), above)

    return list(walk(by_id[root.find("scene/instance_visual_scene").get("url")[1:]], np.eye(4)))


def zae(data: bytes) -> list[Cell]:
    return collada(next(text for name, text in unzipped(data).items() if name.endswith(".dae")))


def three_dxml(data: bytes) -> list[Cell]:
    files = unzipped(data)
    root = parsed(files[parsed(files["manifest.xml"]).findtext("Root", "").strip().lower()])
    entries = {each.get("id"): each for each in root.find("ProductStructure")}

    def mesh(entry: ElementTree.Element) -> list[Cell]:
        file = parsed(files[entry.get("associatedFile", "").rpartition(":")[2].lower()])
        points = floats(file.findtext(".//Positions", "").replace(",", " ").split())
        faces = [int(word) for word in file.find(".//Face").get("triangles").split()]
        return cells_of(
            np.reshape(points, (-1, 3)).tolist(), [("triangle", faces[i : i + 3]) for i in range(0, len(faces), 3)]
        )

    def walk(name: str | None, above: np.ndarray) -> Iterator[Cell]:
        if entries[name].tag == "ReferenceRep":
            yield from turned(mesh(entries[name]), above)
        for each in entries.values():
            if each.findtext("IsAggregatedBy") == name:
                matrix = np.eye(4)
                if each.find("RelativeMatrix") is not None:
                    matrix[:3] = np.array(floats(each.findtext("RelativeMatrix").split())).reshape(4, 3).T
                yield from walk(each.findtext("IsInstanceOf"), above @ matrix)

    return list(walk(root.find("ProductStructure").get("root"), np.eye(4)))


def xaml(data: bytes) -> list[Cell]:
    """Pages without transforms."""
    cells = []
    root = parsed(data)
    assert not any("Transform" in each.tag for each in root.iter())
    for mesh in root.iter("MeshGeometry3D"):
        points = floats(mesh.get("Positions", "").replace(",", " ").split())
        corners = [int(word) for word in mesh.get("TriangleIndices", "").replace(",", " ").split()]
        faces = [("triangle", corners[i : i + 3]) for i in range(0, len(corners), 3)]
        cells += cells_of(np.reshape(points, (-1, 3)).tolist(), faces)
    return cells


# Meshes of cells


class Numbers:
    """The numbers of a section of a Gmsh file, one after the other."""

    def __init__(self, body: bytes, binary: bool, order: str) -> None:
        self.words, self.body, self.binary, self.order, self.at = iter(body.split()), body, binary, order, 0

    def take(self, code: str) -> float:
        if not self.binary:
            return float(next(self.words))
        (value,) = struct.unpack_from(self.order + code, self.body, self.at)
        self.at += struct.calcsize(self.order + code)
        return value

    def whole(self, code: str = "i") -> int:
        value = self.take(code)
        assert value == int(value)
        return int(value)

    def wholes(self, count: int, code: str = "i") -> list[int]:
        return [self.whole(code) for _ in range(count)]


def gmsh(data: bytes) -> list[Cell]:
    header = re.search(rb"\$MeshFormat\s+(\S+)\s+(\d)\s+(\d)[ \t]*\r?\n(....)?", data, re.DOTALL)
    binary, size = header[2] == b"1", {b"4": "I", b"8": "Q"}[header[3]]
    order = ">" if header[4] == b"\0\0\0\1" else "<"

    def section(name: bytes) -> Numbers:
        start = re.search(rb"(?m)^\$" + name + rb"[ \t]*\r?\n", data).end()
        return Numbers(data[start : data.index(b"$End" + name, start)], binary, order)

    nodes, elements = section(b"Nodes"), section(b"Elements")
    places: dict[int, list[float]] = {}
    cells = []
    if header[1].startswith(b"2"):
        for each in (nodes, elements) if binary else ():
            each.at = each.body.index(b"\n") + 1
        for _ in range(int(nodes.body.split(b"\n")[0]) if binary else nodes.whole()):
            tag = nodes.whole()
            places[tag] = [nodes.take("d") for _ in range(3)]
        count = int(elements.body.split(b"\n")[0]) if binary else elements.whole()
        while len(cells) < count:
            if binary:
                kind, several, tags = (elements.whole() for _ in range(3))
            else:
                elements.whole()
                kind, several, tags = elements.whole(), 1, elements.whole()
            for _ in range(several):
                for _ in range(tags + (1 if binary else 0)):
                    elements.whole()
                cells.append((GMSH[kind], [elements.whole() for _ in range(NODES[GMSH[kind]])]))
    else:
        for _ in range(nodes.wholes(4, size)[0]):
            dimension, _, parametric = (nodes.whole() for _ in range(3))
            tags = [nodes.whole(size) for _ in range(nodes.whole(size))]
            for tag in tags:
                places[tag] = [nodes.take("d") for _ in range(3 + (dimension if parametric else 0))][:3]
        for _ in range(elements.wholes(4, size)[0]):
            kind = GMSH[elements.wholes(3)[2]]
            for _ in range(elements.whole(size)):
                elements.whole(size)
                cells.append((kind, [elements.whole(size) for _ in range(NODES[kind])]))
    tags = list(places)
    return cells_of(list(places.values()), [(kind, [tags.index(tag) for tag in nodes]) for kind, nodes in cells])


NASTRAN = {
    "CTETRA": {4: "tetra"},
    "CPYRAM": {5: "pyramid"},
    "CPYRA": {5: "pyramid"},
    "CPENTA": {6: "wedge"},
    "CHEXA": {8: "hexahedron"},
}


def nastran_number(text: str) -> float:
    """A real number, whose exponent may have no letter, or a D: 1.5-3; blank it is 0."""
    plain = text.strip().lower().replace("d", "e") or "0"
    return float(re.sub(r"(?<=[\d.])e?([-+])", r"e\1", plain))


def nastran(data: bytes) -> list[Cell]:
    lines = [line.partition("$")[0].rstrip() for line in data.decode("utf-8", "replace").upper().splitlines()]
    begin = next(i for i, line in enumerate(lines) if " ".join(line.split()).startswith("BEGIN BULK"))
    cards: list[list[str]] = []
    for line in lines[begin + 1 : next(i for i, line in enumerate(lines) if i > begin and line.startswith("ENDDATA"))]:
        if not line.strip():
            continue
        if "," in line:
            fields = line.split(",")[:9]
        else:
            width = 16 if "*" in line[:8] else 8
            fields = [line[:8], *(line[i : i + width] for i in range(8, 72, width))]
        fields += [""] * ((5 if "*" in fields[0] else 9) - len(fields))
        if fields[0].strip()[:1] in ("", "*", "+"):
            cards[-1] += fields[1:]
        else:
            cards.append([fields[0].strip().rstrip("*"), *fields[1:]])
    points = {int(card[1]): [nastran_number(each) for each in card[3:6]] for card in cards if card[0] == "GRID"}
    tags = list(points)
    cells = []
    for card in cards:
        if card[0] in NASTRAN:
            nodes = [tags.index(int(each)) for each in card[3:] if each.strip()]
            cells.append((NASTRAN[card[0]][len(nodes)], nodes))
    return cells_of(list(points.values()), cells)


def abaqus(data: bytes) -> list[Cell]:
    points: dict[int, list[float]] = {}
    cells: list[tuple[str, list[int]]] = []
    continued = False
    keyword = ""
    for line in map(str.strip, data.decode("utf-8", "replace").splitlines()):
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            keyword = line.upper().replace(" ", "")
        elif keyword.split(",")[0] == "*NODE":
            number, *place = line.strip().rstrip(",").split(",")
            points[int(number)] = floats(place[:3])
        elif keyword.split(",")[0] == "*ELEMENT":
            assert "TYPE=C3D4" in keyword.split(",")
            more = [int(word) for word in line.strip().rstrip(",").split(",")]
            cells[-1:] = [("tetra", cells[-1][1] + more)] if continued else [*cells[-1:], ("tetra", more[1:])]
            continued = line.strip().endswith(",") and len(cells[-1][1]) < 4
    tags = list(points)
    return cells_of(list(points.values()), [(kind, [tags.index(tag) for tag in nodes]) for kind, nodes in cells])


VTK_TYPES = {"double": "d", "float": "f", "int": "i", "long": "q", "vtktypeint64": "q", "unsigned_char": "B"}


def vtk(data: bytes) -> list[Cell]:
    version, _, encoding, *_ = data.split(b"\n")
    binary = encoding.strip().upper() == b"BINARY"
    at = sum(len(line) + 1 for line in data.split(b"\n")[:3])

    def table(name: bytes, code: str | None, count: Callable[[list[int]], int]) -> list[float]:
        """The numbers after a line that begins with `name`, whose own numbers `count` turns into how many they are."""
        nonlocal at
        match = re.compile(rb"(?i)(?:^|(?<=\n))[ \t]*" + name + rb"\S*((?:[ \t]+\d+)*)[ \t]*(\w*)[^\n]*\n").search(
            data, at
        )
        number = count([int(word) for word in match[1].split()])
        at = match.end()
        if not binary:
            return floats(data[at:].split()[:number])
        code = code or VTK_TYPES[match[2].decode().lower()]
        values = struct.unpack_from(f">{number}{code}", data, at)
        at += struct.calcsize(f">{number}{code}")
        return [*values]

    places = table(b"POINTS", None, lambda numbers: 3 * numbers[0])
    points = [places[i : i + 3] for i in range(0, len(places), 3)]
    if version.strip().endswith(b"Version 5.1"):
        sizes = re.compile(rb"(?i)\nCELLS[ \t]+(\d+)[ \t]+(\d+)").search(data, at - 1)
        ends = table(b"OFFSETS", None, lambda _: int(sizes[1]))
        corners = table(b"CONNECTIVITY", None, lambda _: int(sizes[2]))
        nodes = [corners[int(a) : int(b)] for a, b in itertools.pairwise(ends)]
    else:
        rows = iter(table(b"CELLS", "i", lambda numbers: numbers[1]))
        nodes = [[next(rows) for _ in range(int(count))] for count in rows]
    kinds = [KINDS[int(kind)] for kind in table(b"CELL_TYPES", "i", lambda numbers: numbers[0])]
    return cells_of(points, [(kind, [int(i) for i in each]) for kind, each in zip(kinds, nodes, strict=True)])


def vtu(data: bytes) -> list[Cell]:
    root = parsed(data)
    order = ">" if root.get("byte_order") == "BigEndian" else "<"
    code = {"UInt32": "I", "UInt64": "Q"}[root.get("header_type", "UInt32")]
    width = struct.calcsize(code)

    def array(name: str) -> list[float]:
        element = root.find(".//Points/DataArray" if name == "Points" else f".//Cells/DataArray[@Name='{name}']")
        text = (element.text or "").strip()
        if element.get("format", "ascii") == "ascii":
            return floats(text.split())
        kind = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}[element.get("type")]
        if root.get("compressor") is None:
            raw = base64.b64decode(text)[width:]
        else:
            head = 4 * -(-3 * width // 3)
            blocks = struct.unpack_from(order + code, base64.b64decode(text[: head + 8]))[0]
            head = 4 * -(-(3 + blocks) * width // 3)
            sizes = struct.unpack(f"{order}{3 + blocks}{code}", base64.b64decode(text[:head])[: (3 + blocks) * width])
            packed = base64.b64decode(text[head:])
            ends = [0, *itertools.accumulate(sizes[3:])]
            raw = b"".join(zlib.decompress(packed[a:b]) for a, b in itertools.pairwise(ends))
        return [*struct.unpack(f"{order}{len(raw) // struct.calcsize(kind)}{kind}", raw)]

    places, corners = array("Points"), array("connectivity")
    ends = [0, *array("offsets")]
    nodes = [[int(i) for i in corners[int(a) : int(b)]] for a, b in itertools.pairwise(ends)]
    points = [places[i : i + 3] for i in range(0, len(places), 3)]
    return cells_of(points, [(KINDS[int(kind)], each) for kind, each in zip(array("types"), nodes, strict=True)])


def med(data: bytes) -> list[Cell]:
    import h5py

    with h5py.File(io.BytesIO(data), "r") as file:
        mesh = file["ENS_MAA"][next(iter(file["ENS_MAA"]))]
        step = mesh[next(iter(mesh))]
        points = step["NOE"]["COO"][()].reshape(3, -1).T
        nodes = step["MAI"]["TE4"]["NOD"][()].reshape(4, -1).T - 1
    return cells_of(points.tolist(), [("tetra", each) for each in nodes.tolist()])


def xdmf(data: bytes) -> list[Cell]:
    root = parsed(data)
    assert root.find(".//Topology").get("TopologyType").lower() == "tetrahedron"
    geometry, topology = (root.find(f".//{name}/DataItem") for name in ("Geometry", "Topology"))
    places = np.array(floats((geometry.text or "").split()))
    if geometry.get("Precision", "4") == "4":
        places = places.astype(np.float32)
    nodes = [int(word) for word in (topology.text or "").split()]
    return cells_of(places.reshape(-1, 3).tolist(), [("tetra", nodes[i : i + 4]) for i in range(0, len(nodes), 4)])


def medit(data: bytes) -> list[Cell]:
    words = re.sub(rb"#[^\n]*", b"", data).split()

    def table(name: bytes, width: int) -> list[list[float]]:
        at = words.index(name) + 1
        rows = (words[at + 1 + width * i : at + 1 + width * (i + 1)] for i in range(int(words[at])))
        return [floats(row)[:-1] for row in rows]

    tetrahedra = table(b"Tetrahedra", 5) if b"Tetrahedra" in words else []
    points = np.array(table(b"Vertices", 4))
    if int(words[1]) < 2:
        points = points.astype(np.float32)
    return cells_of(points.tolist(), [("tetra", [int(i) - 1 for i in each]) for each in tetrahedra])


def netgen(data: bytes) -> list[Cell]:
    lines = [line.split() for line in re.sub(rb"#[^\n]*", b"", data).splitlines() if line.strip()]

    def table(name: bytes) -> list[list[bytes]]:
        at = next(i for i, line in enumerate(lines) if line == [name]) + 1
        return lines[at + 1 : at + 1 + int(lines[at][0])]

    nodes = [[int(word) - 1 for word in line[2 : 2 + int(line[1])]] for line in table(b"volumeelements")]
    assert all(len(each) == 4 for each in nodes)
    return cells_of(
        [floats(line[:3]) for line in table(b"points")], [("tetra", [each[i] for i in (0, 2, 1, 3)]) for each in nodes]
    )


def su2(data: bytes) -> list[Cell]:
    lines = [line.partition(b"%")[0].strip() for line in data.splitlines() if line.partition(b"%")[0].strip()]
    dimension = int(next(line for line in lines if line.startswith(b"NDIME")).partition(b"=")[2])

    def table(name: bytes) -> list[list[bytes]]:
        at = next(i for i, line in enumerate(lines) if line.startswith(name))
        count = int(lines[at].partition(b"=")[2].split()[0])
        return [line.split() for line in lines[at + 1 : at + 1 + count]]

    points = [[*floats(line[:dimension]), 0.0][:3] for line in table(b"NPOIN")]
    cells = [(KINDS[int(line[0])], [int(word) for word in line[1:]]) for line in table(b"NELEM")]
    return cells_of(points, [(kind, nodes[: NODES[kind]]) for kind, nodes in cells])


def avs(data: bytes) -> list[Cell]:
    lines = [line.split() for line in data.splitlines() if line.strip() and not line.startswith(b"#")]
    points, cells = int(lines[0][0]), int(lines[0][1])
    places = {int(line[0]): floats(line[1:4]) for line in lines[1 : points + 1]}
    tags = list(places)
    rows = lines[points + 1 : points + cells + 1]
    assert all(line[2] == b"tet" for line in rows)
    nodes = [[tags.index(int(word)) for word in line[3:]] for line in rows]
    return cells_of(list(places.values()), [("tetra", [each[i] for i in (0, 1, 3, 2)]) for each in nodes])


READERS: dict[str, Callable[[bytes], list[Cell]]] = {
    "stl": stl, "obj": obj, "ply": ply, "off": off, "glb": gltf, "gltf": gltf, "3mf": three_mf, "dae": collada,
    "zae": zae, "3dxml": three_dxml, "xaml": xaml, "gmsh": gmsh, "nastran": nastran, "abaqus": abaqus, "vtk": vtk,
    "vtu": vtu, "med": med, "xdmf": xdmf, "medit": medit, "netgen": netgen, "su2": su2, "avsucd": avs,
}  # fmt: skip


def agree(one: list[np.ndarray], other: list[np.ndarray]) -> bool:
    """Say whether two readers see the same cells, in any order; nodes that are placed may differ by rounding."""
    if len(one) != len(other):
        return False
    if all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True)):
        return True
    rounding = 16 * np.finfo(float).eps * max(np.abs(cell).max() for cell in one)
    pairs = zip(*(sorted(np.asarray(cell, float).tolist() for cell in cells) for cells in (one, other)), strict=True)
    return all(np.shape(a) == np.shape(b) and np.allclose(a, b, rtol=0, atol=rounding) for a, b in pairs)


def shape_of(kind: str, data: bytes) -> list[np.ndarray]:
    """The cells of the highest dimension in a file of a format of ours, surfaces as triangles."""
    cells = READERS[kind](data)
    highest = max(DIMENSION.get(name, 3) for name, _ in cells)
    shape = [corners for name, corners in cells if DIMENSION.get(name, 3) >= (highest if highest > 1 else 0)]
    if highest != 2:
        return shape
    return [corners[[0, i, i + 1]] for corners in shape for i in range(1, len(corners) - 1)]
