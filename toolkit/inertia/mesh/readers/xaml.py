"""XAML of WPF, as SolidWorks exports it: the triangles of a page's visuals, through trimesh.

Pages state no unit. Source: Microsoft, "MeshGeometry3D" and "MatrixTransform3D" in the reference of WPF.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents, check_indices, numbers, plural, shown, was
from inertia.mesh.readers.trimesh import Checked, Extent, extent_of, farthest, load, parse_xml, remove, xml_text

_UNSHOWN = (".Resources", "ResourceDictionary", "Template")
"""Elements whose contents stand only where something refers to them, by how their names end."""
_HOLDERS = ("ModelVisual3D", "ModelUIElement3D", "ContainerUIElement3D", "Model3DGroup", "Viewport3D")
_HELD = ("Content", "Model", "Children")
_REFERENCES = ("StaticResource", "DynamicResource", "Binding")


def read_xaml(path: Path) -> Contents:
    """Read a page of XAML."""
    file = _checked(parse_xml(path.read_bytes()))
    return load(file)


def _checked(root: Element) -> Checked:
    """Check a page of XAML; trimesh applies the matrices of its visuals, and knows no other transform."""
    remove(root, ["GeometryModel3D.Material", "GeometryModel3D.BackMaterial"])
    parents = {child: parent for parent in root.iter() for child in parent}
    triangles = hidden = 0
    extents: list[Extent] = []
    for element in root.iter():
        _check_shown(element)
    for model in root.iter("GeometryModel3D"):
        if len(list(model.iter("MeshGeometry3D"))) != 1:
            raise ReadError("a GeometryModel3D in it has no mesh of its own, or several: write the mesh in its place")
    for mesh in root.iter("MeshGeometry3D"):
        above = [mesh]
        while above[-1] in parents:
            above.append(parents[above[-1]])
        alone = above[-1].tag == "ResourceDictionary" and len(root) == 1  # a file of nothing else, to be used elsewhere
        if any(each.tag.endswith(_UNSHOWN) for each in (above[:-1] if alone else above)):
            raise ReadError(
                "it keeps a mesh as a resource, whose uses are not read: write the model in each place", code="not_read"
            )
        if not any(each.tag == "GeometryModel3D" for each in above):
            raise ReadError("it has a mesh that no GeometryModel3D shows: write the mesh in its place")
        for each in above:
            _check_transforms(each)
        hidden += any(each.get("Visibility") in ("Collapsed", "Hidden") for each in above)
        mesh.attrib.setdefault("Normals", "")
        points = numbers(mesh.get("Positions", "").replace(",", " ").encode(), np.float64, "its Positions")
        if len(points) % 3:
            raise ReadError(
                f"its Positions are {len(points)} numbers, not a multiple of 3: it was cut short", code="cut_short"
            )
        corners = numbers(mesh.get("TriangleIndices", "").replace(",", " ").encode(), np.int64, "its TriangleIndices")
        says = f"its TriangleIndices are {len(corners)} numbers"
        if not len(corners):  # the points are corners one after another
            corners = np.arange(len(points) // 3)
            mesh.set("TriangleIndices", " ".join(map(str, corners.tolist())))
            says = f"its Positions are {plural(len(corners), 'point')} without TriangleIndices"
        if len(corners) % 3 or not len(corners):
            raise ReadError(f"{says}: it was cut short, export it again", code="cut_short")
        check_indices(corners.reshape(-1, 3), len(points) // 3, "triangle")
        triangles += len(corners) // 3
        extent = extent_of(points)
        for each in above:
            for matrix in each.findall(f"{each.tag}.Transform/MatrixTransform3D"):
                values = numbers(matrix.get("Matrix", "").encode(), np.float64, "a Matrix").reshape(4, 4)
                extent = extent.placed(values[:3, :3], values[3, :3])
        extents.append(extent)
    notes = [f"{plural(hidden, 'model')} that Visibility hides {was(hidden)} counted"] if hidden else []
    return Checked("xaml", xml_text(root), triangles, farthest(extents).rounding, notes=tuple(notes))


def _check_shown(element: Element) -> None:
    """Refuse what shows a shape and that trimesh passes over: visuals that make their own, and references."""
    owner, _, held = element.tag.partition(".")
    if not held and owner.endswith(("Visual3D", "Model3D")) and owner not in ("ModelVisual3D", "GeometryModel3D"):
        raise ReadError(f"its {owner} is not read: write its mesh as a GeometryModel3D", code="not_read")
    if owner == "MeshGeometry3D" and held in ("Positions", "TriangleIndices"):
        raise ReadError(f"its {element.tag} is not read: write it as an attribute of the mesh", code="not_read")
    if owner in _HOLDERS and held in ("", *_HELD):
        refers = any(element.get(name, "").lstrip().startswith("{") for name in _HELD)
        if refers or any(child.tag.removesuffix("Extension") in _REFERENCES for child in element):
            raise ReadError(
                f"its {element.tag} refers to a resource or a binding, which is not read: write the model in its place",
                code="not_read",
            )


def _check_transforms(element: Element) -> None:
    """Refuse a transform that trimesh would leave out, and one that would turn the mesh inside out there."""
    if "Transform" in element.attrib:
        raise ReadError(
            f"the Transform of its {element.tag} is not read: export it with a MatrixTransform3D", code="not_read"
        )
    for child in element:
        if not child.tag.endswith(".Transform"):
            continue
        matrices = child.findall("MatrixTransform3D")
        if child.tag != "ModelVisual3D.Transform" or len(matrices) != 1 or len(list(child.iter())) != 2:
            raise ReadError(
                f"its {child.tag} is not read: export it with one MatrixTransform3D in each ModelVisual3D",
                code="not_read",
            )
        text = matrices[0].get("Matrix", "").replace(",", " ")
        values = numbers(text.encode(), np.float64, "the numbers of a Matrix")
        if len(values) != 16 or not np.array_equal(values[3::4], [0, 0, 0, 1]):
            raise ReadError(f"the Matrix {shown(text)} is not sixteen numbers of a place in space: export it again")
        if np.linalg.det(values.reshape(4, 4)) < 0:
            raise ReadError("a Matrix in it mirrors, which trimesh leaves inside out: export it without a mirror")
        matrices[0].set("Matrix", text)
