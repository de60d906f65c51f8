"""3DXML: an archive of a product structure and of its parts as tessellated XML, through trimesh.

Coarser levels of detail, which trimesh would add to the finest, are left out. The format is not published: it is
read as far as the loader of trimesh 5.2 knows it. Files state no unit.
"""

from __future__ import annotations

import io
import re
import zipfile
from functools import cache
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents, check_indices, numbers, plural, shown, was
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

    trimesh calls a mesh by the name of one part that it is in, so that parts of one name would be one: it is given
    their ids in place of the names, and a mesh for each part.
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
    entries = by_id(structure)
    notes = _seen(root, entries)
    remove(root, _IMAGES_AND_VIEWS)
    parts = {"Manifest.xml": b"<Manifest><Root>root.3dxml</Root></Manifest>"}
    own: dict[str, int] = {}
    extents: dict[str, Extent] = {}
    matrices: dict[str, list[tuple[str, Float]]] = {name: [] for name in entries}
    inside: dict[str, list[str]] = {name: [] for name in entries}
    names: dict[str | None, str] = {}
    meshes_of: dict[str, int] = {}
    instances: dict[str, list[Element]] = {}
    for name, entry in entries.items():
        match entry.tag:
            case "ReferenceRep":
                own[name], extents[name] = _representation(entry, members, parts)
            case "Reference3D":
                names[name] = entry.get("name") or f"part {name}"
                entry.set("name", name)
            case "Instance3D" | "InstanceRep":
                owner, target = (_referred(entry, tag) for tag in ("IsAggregatedBy", "IsInstanceOf"))
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
                if entry.tag == "InstanceRep":
                    instances.setdefault(target, []).append(entry)
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

    for target, several in instances.items():
        for k, entry in enumerate(several[1:]):
            copy = SubElement(structure, "ReferenceRep", entries[target].attrib)
            copy.set("id", f"{target}, copy {k}")
            next(entry.iterfind("IsInstanceOf")).text = copy.get("id")
    parts["root.3dxml"] = xml_text(root)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return Checked("3dxml", packed.getvalue(), triangles, extent(start).rounding, notes=notes, names=names)


def _seen(root: Element, entries: dict[str, Element]) -> tuple[str, ...]:
    """Return a note of what the view hides; refuse one that moves an occurrence, as in a flexible assembly."""
    hidden = 0
    for each in root.iter("DefaultViewProperty"):
        hidden += any(one.get("visible") in ("false", "0") for one in each.iter("GeneralAttributes"))
        if each.find("RelativePosition") is None:
            continue
        name = ([_bare(one.text) for one in each.iterfind("OccurenceId/id")] or [""])[-1].rpartition("#")[2]
        place = _relative_matrix(each, "RelativePosition")
        if name not in entries or not np.array_equal(place, _relative_matrix(entries[name])):
            raise ReadError(
                f"its view moves the occurrence {shown(name)} (RelativePosition), which is not read: export the "
                "assembly as it stands, without flexible parts",
                code="not_read",
            )
    return (f"{plural(hidden, 'occurrence')} that the view hides {was(hidden)} counted",) if hidden else ()


def _referred(instance: Element, tag: str) -> str:
    """Return the id that an instance refers to, bare, as trimesh is to find it there too."""
    element = instance.find(tag)
    if element is None:
        return ""
    element.text = _bare(element.text)
    return element.text


def _bare(reference: str | None) -> str:
    return re.sub(r"^urn:3DXML:(\w+:)?loc:", "", (reference or "").strip())


def _relative_matrix(instance: Element, tag: str = "RelativeMatrix") -> Float:
    """Return the nine numbers of the matrix of an instance and the three of its shift."""
    matrix = instance.find(tag)
    values = np.eye(4)[:, :3].ravel() if matrix is None else finite_numbers(matrix, f"the numbers of a {tag}")
    if len(values) != 12:
        raise ReadError(f"a {tag} has not twelve numbers: export it again")
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
    remove(root, ["PolygonalLOD", "SurfaceAttributes", "TextureCoordinates", "Normals"])
    triangles = 0
    extents = []
    for representation in list(root.iter("Rep")):
        positions = representation.findall("VertexBuffer/Positions")
        faces = list(representation.iter("Face"))
        if not positions and representation.find("Faces") is not None:
            raise ReadError(f"its part {shown(name)} has faces without vertices of their own: export it again")
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
        remove(representation, ["Faces", "Face"])
        for face in faces:  # trimesh reads the first again with each further one of the same list
            SubElement(representation, "Faces").append(face)
        for buffer in representation.iterfind("VertexBuffer"):  # which trimesh does not read without
            SubElement(buffer, "Normals").text = "0 0 0"
    parts[name] = xml_text(root)
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
