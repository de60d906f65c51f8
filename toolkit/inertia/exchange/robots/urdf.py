"""URDF (ROS): links with their `<inertial>`, visual and collision shapes, and the fixed joints between them.

The pose of `<inertial>` is that of a frame at the centre of mass, along whose axes the six elements are tensor
elements (−∫xy dm). Source: the URDF XML specification, wiki.ros.org/urdf/XML, link and joint; version 1.1 has
``quat_xyzw`` where ``rpy`` may stand (urdfdom, URDF Versioning). Macros (xacro) have to be expanded. Slips are read
where a program reads them, with a note: too many or too few numbers, and what follows a number, as Bullet does; what no
program reads is the fault of the shape or of the link, as with urdfdom.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError, visible
from inertia.exchange.robots.links import Geometry, Inertial, Joint, Link, Motion, Placement, Primitive, Robot, Role
from inertia.exchange.robots.text import figures, file_name, floats, mesh_file, robot_xml
from inertia.exchange.rotations import rotation_of_quaternion, rotation_of_rpy
from inertia.mesh.readers.contents import plural, shown, was
from inertia.standard_input import file_of

_PAIRS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_NUMERAL = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_VERSION = re.compile(r"(\d{1,9})\.(\d{1,9})", re.ASCII)
_MACROS = "it holds macros of xacro: expand it first (xacro FILE > robot.urdf)"


class _Attributes:
    """Reads the numbers in attributes, and keeps what had to be decided in `notes`.

    `quaternions` says whether the version of the robot's URDF has ``quat_xyzw``.
    """

    def __init__(self, notes: tuple[str, ...], version: str) -> None:
        self.notes = dict.fromkeys(notes)
        numerals = _VERSION.fullmatch(version.strip())
        self.quaternions = numerals is not None and (int(numerals[1]), int(numerals[2])) >= (1, 1)

    def numbers(self, element: Element | None, key: str, count: int, what: str) -> Float:
        """Return the numbers in an attribute, (count,), or zeros where it is not there."""
        text = None if element is None else element.get(key)
        if text is None:
            return np.zeros(count)
        try:
            return np.array(floats(text, count, f"{what}, {key}"))
        except ReadError:
            if "${" in text or "$(" in text:
                raise ReadError(_MACROS, code="xacro") from None
            numerals = [_NUMERAL.match(word) for word in text.split()]
            values = [float(numeral[0]) for numeral in numerals if numeral is not None]
            if len(values) < len(numerals) or not np.isfinite(values).all():
                raise
            if len(values) < count:
                if key not in ("xyz", "rpy", "scale") or (key == "scale" and not values):
                    raise
                values = values[:1] * 3 if key == "scale" else [0.0] * count
            words = " ".join(f"{value:g}" for value in values[:count])
            self.notes[f"{what}, {key} is {shown(text)}: read as {words}, as Bullet does; most programs refuse it"] = (
                None
            )
            return np.array(values[:count])

    def number(self, element: Element | None, key: str, what: str) -> float:
        """Return the number in an attribute, or 0 where it is not there."""
        return float(self.numbers(element, key, 1, what)[0])

    def placement(self, element: Element, what: str) -> Placement:
        """Return what the ``<origin>`` of an element says."""
        origin, what = element.find("origin"), f"{what}, origin"
        rpy, xyz = (self.numbers(origin, key, 3, what) for key in ("rpy", "xyz"))
        if unread := sorted(() if origin is None else origin.attrib.keys() - {"rpy", "xyz", "quat_xyzw"}):
            self.notes[f"{what} has {', '.join(map(shown, unread))}, which URDF does not know: passed over"] = None
        quaternion = self._quaternion(origin, what)
        return Placement(rotation_of_rpy(*rpy.tolist()) if quaternion is None else quaternion, xyz)

    def _quaternion(self, origin: Element | None, what: str) -> Float | None:
        """Return the rotation (3, 3) that ``quat_xyzw`` states; None where it is not there or does not count."""
        if origin is None or origin.get("quat_xyzw") is None:
            return None
        if not self.quaternions:
            words = "passed over, as in urdfdom, for its robot states no version from 1.1 on"
            self.notes[f"{what} has 'quat_xyzw': {words}"] = None
            return None
        if origin.get("rpy") is not None:
            raise ReadError(f"{what} has both rpy and quat_xyzw, which no program reads: keep one")
        x, y, z, w = self.numbers(origin, "quat_xyzw", 4, what).tolist()
        if not any((x, y, z, w)):
            raise ReadError(f"{what}, quat_xyzw is zero: no rotation has that quaternion")
        return rotation_of_quaternion([w, x, y, z])


def read_urdf(path: Path) -> Robot:
    """Read a robot from a URDF file; raise `ReadError` where it is none."""
    data = file_of(str(path)).read_bytes()
    root, notes = robot_xml(data)
    if root.tag != "robot":
        raise ReadError(f"it begins with {shown(root.tag)}, not with robot: it is no URDF file", code="wrong_format")
    if re.search(rb"<xacro:(?!property|arg)", re.sub(rb"(?s)<!--.*?-->", b"", data)):
        raise ReadError(_MACROS, code="xacro")
    attributes = _Attributes(notes, root.get("version", "1.0"))
    joints: dict[str, Joint] = {}
    for child, joint in _joints(root, attributes):
        if child in joints:
            which = f"{shown(joints[child].name)} and {shown(joint.name)}"
            attributes.notes[f"link {shown(child)} hangs from two joints, {which}: the last counts"] = None
        joints[child] = joint
    elements = [element for element in root.findall("link") if element.get("name") is not None]
    if nameless := len(root.findall("link")) - len(elements):
        attributes.notes[f"{plural(nameless, 'link')} without a name {was(nameless)} left out"] = None
    links = [
        _link(element, element.get("name", ""), path, joints.get(element.get("name", "")), attributes)
        for element in elements
    ]
    if not links:
        lacks = " that has a name: name them" if nameless else ": export the robot again"
        raise ReadError(f"it holds no link{lacks}", code="empty")
    names = {link.name for link in links}
    for child, joint in joints.items():
        for name in {child, joint.parent or ""} - names:
            what = f"joint {shown(joint.name)} names the link {shown(name)}"
            attributes.notes[f"{what}, which is not in the file: check its name"] = None
    return Robot(path, "urdf", root.get("name", ""), tuple(links), tuple(attributes.notes))


_MOTIONS: dict[str, Motion] = {
    "revolute": "turns",
    "continuous": "turns",
    "prismatic": "slides",
    "fixed": "fixed",
}


def _joints(root: Element, attributes: _Attributes) -> Iterator[tuple[str, Joint]]:
    for joint in root.findall("joint"):
        parent, child, name = joint.find("parent"), joint.find("child"), joint.get("name", "")
        if parent is not None and child is not None:
            where = attributes.placement(joint, f"joint {shown(name)}")
            axis = attributes.numbers(joint.find("axis"), "xyz", 3, f"joint {shown(name)}, axis")
            if not axis.any():
                axis = np.array([1.0, 0.0, 0.0])  # what URDF says of a joint without one
            kind: Motion = _MOTIONS.get(joint.get("type", ""), "other")
            mimic = _mimic(joint, f"joint {shown(name)}, mimic", attributes)
            yield child.get("link", ""), Joint(name, parent.get("link", ""), where, kind, axis, mimic=mimic)
        else:
            lacks = "child" if child is None else "parent"
            attributes.notes[f"joint {shown(name)} has no {lacks}: it is left out"] = None


def _mimic(joint: Element, what: str, attributes: _Attributes) -> tuple[str, float, float] | None:
    mimic = joint.find("mimic")
    if mimic is None:
        return None
    multiplier = 1.0 if mimic.get("multiplier") is None else attributes.number(mimic, "multiplier", what)
    return visible(mimic.get("joint", "")), multiplier, attributes.number(mimic, "offset", what)


def _link(element: Element, name: str, path: Path, joint: Joint | None, attributes: _Attributes) -> Link:
    fixed = joint if joint is not None and joint.kind == "fixed" else None
    parent, placement = (None, Placement()) if fixed is None else (fixed.parent, fixed.placement)
    try:
        inertial, fault = _inertial(element, f"link {shown(name)}, inertial", attributes), ""
    except ReadError as error:
        if str(error) == _MACROS:
            raise
        inertial, fault = None, str(error)
    return Link(name, inertial, tuple(_geometries(element, name, path, attributes)), parent, placement, fault, joint)


def _inertial(link: Element, what: str, attributes: _Attributes) -> Inertial | None:
    element = link.find("inertial")
    if element is None:
        return None
    for whole, tag in ((link, "inertial"), *((element, tag) for tag in ("origin", "mass", "inertia"))):
        if len(whole.findall(tag)) > 1:
            attributes.notes[f"{what} has more than one <{tag}>: the first counts, as in other programs"] = None
    mass, tensor, origin = element.find("mass"), element.find("inertia"), element.find("origin")
    if mass is None or mass.get("value") is None:
        raise ReadError(f"{what} has no mass: state one")
    if absent := [key for key in _PAIRS if tensor is None or tensor.get(key) is None]:
        attributes.notes[f"{what} has no {', '.join(absent)}: 0, as in Drake; most programs refuse it"] = None
    xx, yy, zz, xy, xz, yz = (attributes.number(tensor, key, what) for key in _PAIRS)
    words = [] if tensor is None else [tensor.get(key, "") for key in _PAIRS]
    return Inertial(
        attributes.number(mass, "value", what),
        attributes.placement(element, what),
        np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
        (figures([] if origin is None else [origin.get("xyz", "")]), figures(words)),
    )


def _geometries(link: Element, name: str, path: Path, attributes: _Attributes) -> Iterator[Geometry]:
    roles: tuple[Role, ...] = ("visual", "collision")
    for role in roles:
        for number, element in enumerate(link.findall(role), 1):
            shape = element.find("geometry")
            if shape is None or len(shape) == 0:
                continue
            what = f"link {shown(name)}, {role} {number}"
            if len(shape) > 1:
                attributes.notes[f"{what} has {len(shape)} shapes in one <geometry>: the first counts"] = None
            kind = shape[0]
            label = element.get("name") or f"{kind.tag} {number}"
            try:
                placement = attributes.placement(element, what)
                if kind.tag != "mesh":
                    yield Geometry(label, role, _primitive(kind, what, attributes), placement)
                    continue
                reference = kind.get("filename", "")
                label = file_name(reference) or label
                file = mesh_file(reference, path.parent, attributes.notes)
                yield Geometry(label, role, file, placement, _scale(kind, what, attributes))
            except ReadError as error:
                if str(error) == _MACROS:
                    raise
                yield Geometry(label, role, str(error))


def _scale(mesh: Element, what: str, attributes: _Attributes) -> tuple[Fraction, Fraction, Fraction] | None:
    if mesh.get("scale") is None:
        return None
    x, y, z = (Fraction(repr(value)) for value in attributes.numbers(mesh, "scale", 3, what).tolist())
    return x, y, z


def _primitive(kind: Element, what: str, attributes: _Attributes) -> Primitive | str:
    if kind.tag == "box":
        return Primitive("box", tuple(attributes.numbers(kind, "size", 3, what).tolist()))
    if kind.tag == "sphere":
        return Primitive("sphere", (attributes.number(kind, "radius", what),))
    if kind.tag == "cylinder":
        return Primitive("cylinder", (attributes.number(kind, "radius", what), attributes.number(kind, "length", what)))
    if kind.tag == "capsule":
        return Primitive("capsule", (attributes.number(kind, "radius", what), attributes.number(kind, "length", what)))
    return f"{shown(kind.tag)} is no shape that can be weighed"
