"""URDF (ROS): links with their `<inertial>`, visual and collision shapes, and the fixed joints between them.

The pose of `<inertial>` is that of a frame at the centre of mass, along whose axes the six elements are tensor
elements (−∫xy dm). Source: the URDF XML specification, wiki.ros.org/urdf/XML, link and joint. Macros (xacro) have to
be expanded.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from inertia.errors import ReadError
from inertia.exchange.robots.links import Geometry, Inertial, Link, Placement, Primitive, Robot, Role
from inertia.exchange.robots.text import attribute, decimals, mesh_file
from inertia.exchange.rotations import rotation_of_rpy
from inertia.mesh.readers.contents import shown
from inertia.mesh.readers.trimesh import parse_xml

_PAIRS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def read_urdf(path: Path) -> Robot:
    """Read a robot from a URDF file; raise `ReadError` where it is none."""
    data = path.read_bytes()
    root = parse_xml(data.lstrip())  # many begin with an empty line
    if root.tag != "robot":
        raise ReadError(f"it begins with {shown(root.tag)}, not with robot: it is no URDF file")
    if b"<xacro:" in data or b"${" in data or b"$(" in data:
        raise ReadError("it holds macros of xacro: expand it first (xacro FILE > robot.urdf)")
    fixed = dict(_fixed_joints(root))
    links = []
    for element in root.iter("link"):
        name = element.get("name")
        if name is None:
            continue  # of a joint or a gazebo extension
        parent, placement = fixed.get(name, (None, Placement()))
        links.append(Link(name, _inertial(element, name), tuple(_geometries(element, name, path)), parent, placement))
    twice = [name for name, count in Counter(each.get("name") for each in root.findall("link")).items() if count > 1]
    if twice:
        raise ReadError(f"more than one link is called {shown(str(twice[0]))}: their names must differ")
    if not links:
        raise ReadError("it holds no link")
    return Robot(path, "urdf", root.get("name", ""), tuple(links))


def _fixed_joints(root: Element) -> list[tuple[str, tuple[str, Placement]]]:
    joints = []
    for joint in root.findall("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if joint.get("type") == "fixed" and parent is not None and child is not None:
            where = _placement(joint, f"joint {shown(joint.get('name', ''))}")
            joints.append((child.get("link", ""), (parent.get("link", ""), where)))
    return joints


def _inertial(link: Element, name: str) -> Inertial | None:
    element = link.find("inertial")
    if element is None:
        return None
    what = f"link {shown(name)}, inertial"
    mass, tensor, origin = element.find("mass"), element.find("inertia"), element.find("origin")
    if mass is None or mass.get("value") is None:
        raise ReadError(f"{what} has no mass")
    xx, yy, zz, xy, xz, yz = (float(attribute(tensor, key, 1, [0.0], what)[0]) for key in _PAIRS)
    words = [] if tensor is None else [tensor.get(key, "") for key in _PAIRS]
    return Inertial(
        float(attribute(mass, "value", 1, [0.0], what)[0]),
        _placement(element, what),
        np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
        (
            decimals([mass.get("value", "")]),
            decimals([] if origin is None else [origin.get("xyz", "")]),
            decimals(words),
        ),
    )


def _placement(element: Element, what: str) -> Placement:
    origin = element.find("origin")
    rpy, xyz = (attribute(origin, key, 3, [0.0] * 3, f"{what}, origin") for key in ("rpy", "xyz"))
    return Placement(rotation_of_rpy(*rpy.tolist()), xyz)


def _geometries(link: Element, name: str, path: Path) -> list[Geometry]:
    roles: tuple[Role, ...] = ("visual", "collision")
    result = []
    for role in roles:
        for number, element in enumerate(link.findall(role), 1):
            what = f"link {shown(name)}, {role} {number}"
            shape = element.find("geometry")
            if shape is None or len(shape) == 0:
                continue
            kind = shape[0]
            label = element.get("name") or f"{kind.tag} {number}"
            placement = _placement(element, what)
            if kind.tag == "mesh":
                reference = kind.get("filename", "")
                scale = kind.get("scale")
                file = mesh_file(reference, path.parent)
                result.append(
                    Geometry(file.name, role, file, placement, None if scale is None else _scale(scale, what))
                )
            else:
                result.append(Geometry(label, role, _primitive(kind, what), placement))
    return result


def _scale(text: str, what: str) -> tuple[Fraction, Fraction, Fraction]:
    try:
        x, y, z = (Fraction(word) for word in text.split())
    except ValueError:
        raise ReadError(f"{what}, scale is {shown(text)}: it must be 3 numbers") from None
    return x, y, z


def _primitive(kind: Element, what: str) -> Primitive | str:
    def number(key: str) -> float:
        return float(attribute(kind, key, 1, [0.0], what)[0])

    if kind.tag == "box":
        return Primitive("box", tuple(attribute(kind, "size", 3, [0.0] * 3, what).tolist()))
    if kind.tag == "sphere":
        return Primitive("sphere", (number("radius"),))
    if kind.tag == "cylinder":
        return Primitive("cylinder", (number("radius"), number("length")))
    if kind.tag == "capsule":
        return Primitive("capsule", (number("radius"), number("length")))
    return f"{shown(kind.tag)} is no shape that can be weighed"
