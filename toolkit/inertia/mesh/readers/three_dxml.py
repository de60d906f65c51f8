"""3DXML: an archive of a product structure and of its parts as tessellated XML, through trimesh.

Coarser levels of detail, which trimesh would add to the finest, are left out. The format is not published: it is
read as far as the loader of trimesh 5.2 knows it. Files state no unit.
"""

from __future__ import annotations

import io
import zipfile
from functools import cache
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents, check_indices, numbers, shown
from inertia.mesh.readers.trimesh import (
    Checked,
    Expansion,
    Extent,
    by_id,
    extent_of,
    farthest,
    finite_numbers,
    load,
    parse_xml,
    remove,
    xml_text,
)
from inertia.mesh.readers.zip import inflate

_IMAGES_AND_VIEWS = ("DefaultView", "CATMaterialRef", "CATMaterial", "SurfaceAttributes", "LineAttributes")


def read_3dxml(path: Path) -> Contents:
    """Read a 3DXML archive."""
    members = inflate(path, lambda name: name.endswith(("manifest.xml", ".3dxml", ".3drep")))
    file = _checked(members)
    return load(file)


def _checked(members: dict[str, bytes]) -> Checked:
    """Check the members of an archive; trimesh sees its structure and its tessellated parts alone.

    trimesh calls a mesh by the name of the part that it is in, so that parts of one name would be one: it is given
    their ids in place of the names.
    """
    if "manifest.xml" not in members:
        raise ReadError("it holds no Manifest.xml: it is no 3DXML file, or was cut short", code="wrong_format")
    root_name = (parse_xml(members["manifest.xml"]).findtext("Root") or "").strip().lower()
    if root_name not in members:
        raise ReadError(f"its manifest names {shown(root_name)}, which it does not hold: export it again")
    root = parse_xml(members[root_name])
    structure = root.find("ProductStructure")
    if structure is None:
        raise ReadError("it has no ProductStructure: export it again")
    remove(root, _IMAGES_AND_VIEWS)
    entries = by_id(structure)
    parts = {"Manifest.xml": b"<Manifest><Root>root.3dxml</Root></Manifest>"}
    own: dict[str, int] = {}
    extents: dict[str, Extent] = {}
    matrices: dict[str, list[tuple[str, Float]]] = {name: [] for name in entries}
    inside: dict[str, list[str]] = {name: [] for name in entries}
    names: dict[str | None, str] = {}
    meshes_of: dict[str, int] = {}
    for name, entry in entries.items():
        match entry.tag:
            case "ReferenceRep":
                own[name], extents[name] = _representation(entry, members, parts)
            case "Reference3D":
                names[name] = entry.get("name") or f"part {name}"
                entry.set("name", name)
            case "Instance3D" | "InstanceRep":
                owner, target = ((entry.findtext(tag) or "") for tag in ("IsAggregatedBy", "IsInstanceOf"))
                kinds = [entries[each].tag if each in entries else None for each in (owner, target)]
                if kinds != ["Reference3D", "Reference3D" if entry.tag == "Instance3D" else "ReferenceRep"]:
                    raise ReadError(
                        f"its {entry.tag} {shown(name)} joins {shown(owner)} and {shown(target)}, which it does "
                        "not hold: export it as one file"
                    )
                inside[owner].append(target)
                meshes_of[owner] = meshes_of.get(owner, 0) + (entry.tag == "InstanceRep")
                if meshes_of[owner] > 1:  # trimesh would read the last of them in the place of each
                    raise ReadError(f"its part {shown(names.get(owner, owner))} has several representations: split it")
                entry.set("name", name)
                matrices[owner].append((target, _relative_matrix(entry)))
    start = structure.get("root", "")
    if start not in entries:
        raise ReadError(f"its root is {shown(start)}, which it does not hold: export it again")
    triangles = Expansion(lambda key: (own.get(str(key), 0), inside[str(key)]))(start)

    @cache
    def extent(name: str) -> Extent:
        inner = (extent(target).placed(matrix[:9], matrix[9:]) for target, matrix in matrices[name])
        return extents.get(name) or farthest(inner)

    parts["root.3dxml"] = xml_text(root)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return Checked("3dxml", packed.getvalue(), triangles, extent(start).rounding, names=names)


def _relative_matrix(instance: Element) -> Float:
    """Return the nine numbers of the matrix of an instance and the three of its shift."""
    matrix = instance.find("RelativeMatrix")
    values = np.eye(4)[:, :3].ravel() if matrix is None else finite_numbers(matrix, "the numbers of a RelativeMatrix")
    if len(values) != 12:
        raise ReadError("a RelativeMatrix has not twelve numbers: export it again")
    return values


def _representation(entry: Element, members: dict[str, bytes], parts: dict[str, bytes]) -> tuple[int, Extent]:
    """Return the triangles and the extent of a tessellated part, which is added to `parts`, the finest level alone."""
    name = entry.get("associatedFile", "").rpartition(":")[2].lower()
    if entry.get("format") != "TESSELLATED" or name not in members or not members[name].lstrip()[:1] == b"<":
        raise ReadError(
            f"its part {shown(name)} is not stored as triangles in XML: export it tessellated, as XML", code="not_read"
        )
    entry.set("associatedFile", f"urn:3DXML:{name}")
    root = parse_xml(members[name])
    remove(root, ["PolygonalLOD", "SurfaceAttributes", "TextureCoordinates"])
    parts[name] = xml_text(root)
    triangles = 0
    extents = []
    for representation in root.iter("Rep"):
        positions = representation.findall("VertexBuffer/Positions")
        faces = list(representation.iter("Face"))
        if not positions:
            continue
        if len(positions) > 1 or representation.find(".//Rep") is not None:
            raise ReadError(f"its part {shown(name)} has faces over several lists of vertices: export it again")
        positions[0].text = (positions[0].text or "").replace(",", " ")
        coordinates = finite_numbers(positions[0], f"the positions of {shown(name)}")
        extents.append(extent_of(coordinates))
        count = len(coordinates)
        if count % 3:
            raise ReadError(
                f"its part {shown(name)} has {count} coordinates, not a multiple of 3: it was cut short",
                code="cut_short",
            )
        triangles += sum(_triangles(face, count // 3, shown(name)) for face in faces)
    return triangles, farthest(extents)


def _triangles(face: Element, points: int, what: str) -> int:
    triangles = 0
    for kind in ("triangles", "strips", "fans"):
        lists = face.attrib[kind].split(",") if kind in face.attrib else []
        for each in lists:
            corners: Int = numbers(each.encode(), np.int64, f"the {kind} of {what}")
            if len(corners) < 3 or (kind == "triangles" and (len(corners) % 3 or len(lists) > 1)):
                raise ReadError(
                    f"{what} has {kind} with {len(corners)} corners: it was cut short, export it again",
                    code="cut_short",
                )
            check_indices(corners[:, None], points, f"{what}, corner")
            triangles += len(corners) // 3 if kind == "triangles" else len(corners) - 2
    return triangles
