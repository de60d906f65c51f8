"""SDFormat (Gazebo, Drake): links with their `<inertial>`, visual and collision shapes, poses relative to frames.

The pose of `<inertial>` is that of a frame at the centre of mass, along whose axes the six elements are tensor
elements (−∫xy dm). Poses follow the specification of SDFormat 1.7 and later, Pose Frame Semantics: a pose counts from
`relative_to`, or from the model for a link, the child for a joint, the link for a shape, and what it is attached to for
a frame; a name in a nested model is written model::name.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from inertia.errors import ReadError, visible
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.robots.forest import forest
from inertia.exchange.robots.links import Geometry, Inertial, Joint, Link, Motion, Placement, Primitive, Robot, Role
from inertia.exchange.robots.text import figures, file_name, floats, is_file, mesh_file, robot_xml, scales
from inertia.exchange.rotations import rotation_of_quaternion, rotation_of_rpy
from inertia.mesh.readers.contents import shown
from inertia.records import dataclass
from inertia.standard_input import file_of

_CONVENTION = CONVENTIONS["sdf"]
_MODEL = "__model__"
_PLACED = "_placement_frame"  # of the frame that stands for a merged model
_DEEPEST = 32  # models that include one another
_MOST = 1000  # models that are included in all: two in each would be 2³²
_WATER = 1000.0  # kg/m³, what collisions weigh where an inertia is automatic and none is stated
_MOTIONS: dict[str, Motion] = {
    "revolute": "turns",
    "continuous": "turns",
    "prismatic": "slides",
    "fixed": "fixed",
}
_SHAPELESS = ("plane", "heightmap", "image", "empty")


@dataclass
class _Frames:
    """Where the frames of a file lie: each by its full name, the full name of the one it counts from, and its pose.

    `links` are those of them that are links, those of nested models first as in Drake; `joints` are those between
    them, moving or not, each with its child; `attached` is what a frame goes with.
    """

    poses: dict[str, tuple[str, Placement]] = field(default_factory=dict)
    links: dict[str, None] = field(default_factory=dict)
    joints: list[tuple[str, Joint]] = field(default_factory=list)
    attached: dict[str, str] = field(default_factory=dict)

    def find(self, name: str, scope: str) -> str:
        """Return the full name of a frame that is called `name` within a model."""
        if name == "world":
            return ""
        for full in (scope + name, f"{scope}{name}::{_MODEL}"):
            if full in self.poses:
                return full
        raise ReadError(f"there is no frame {shown(name)} in the model {shown(scope.removesuffix('::'))}")

    def link(self, name: str, scope: str) -> str | None:
        """Return the full name of the link that a frame goes with, "" for the world; None where that is not said."""
        try:
            full = self.find(name, scope)
        except ReadError:
            return None
        path: set[str] = set()
        while full and full not in self.links:
            if full in path or full not in self.attached:
                return None
            path.add(full)
            full = self.attached[full]
        return full

    def between(self, outer: str, inner: str) -> Placement:
        """Return where one frame lies in another, by way of the nearest frame that both count from."""
        up, down = self._path(outer), self._path(inner)
        while up and down and up[-1] == down[-1]:
            del up[-1], down[-1]
        there, here = self._along(up), self._along(down)
        return there.inverse.then(here)

    def _path(self, name: str) -> list[str]:
        """Return a frame, the one it counts from, and so on to the world."""
        path: list[str] = []
        while name:
            if name in path:
                raise ReadError(f"the pose of {shown(name)} counts from itself")
            path.append(name)
            name = self.poses[name][0]
        return path

    def _along(self, path: list[str]) -> Placement:
        where = Placement()
        for name in reversed(path):
            where = where.then(self.poses[name][1])
        return where


def read_sdf(path: Path) -> Robot:
    """Read the links of all models in a file; raise `ReadError` where it is none."""
    root, faults = robot_xml(file_of(str(path)).read_bytes())
    if root.tag != "sdf":
        raise ReadError(f"it begins with {shown(root.tag)}, not with sdf: it is no SDFormat file", code="wrong_format")
    folders: dict[Element, Path] = {}
    notes: dict[str, None] = dict.fromkeys(faults)
    places = [root, *root.findall("world")]
    for place in places:
        _include(place, path.parent, folders, notes, 0)
        for crowd in place.findall("population"):
            notes[f"population {shown(crowd.get('name', ''))} is not read: where its models lie is drawn by chance"] = (
                None
            )
    models = [model for place in places for model in place.findall("model")]
    frames = _Frames()
    scopes = [f"{model.get('name', '')}::" for model in models]
    for place in places:
        _declare(place, "", frames)
    notes |= dict.fromkeys(note for place in places for note in _join(place, "", root, frames))
    hung, loops = forest(sorted(frames.joints, key=lambda each: each[1].kind != "fixed"), frames.links)
    drop = scopes[0] if len(models) == 1 else ""  # with one model its name says nothing
    notes |= {
        f"joint {shown(joint.name.removeprefix(drop))} closes a loop: it is left out of the tree": None
        for joint in loops
    }
    links = [
        link
        for model, scope in zip(models, scopes, strict=True)
        for link in _links(model, scope, frames, hung, drop, path.parent, folders, notes)
    ]
    if not links:
        why = "".join(f": {note}" for note in notes if note not in faults) or ": export the robot again"
        raise ReadError(f"it holds no link{why}", code="empty")
    name = models[0].get("name", "") if len(models) == 1 else ""
    return Robot(path, "sdf", name, tuple(links), tuple(notes))


def _include(place: Element, folder: Path, folders: dict[Element, Path], notes: dict[str, None], depth: int) -> None:
    """Replace every ``<include>`` in a world or model by the model that it names, and keep where that one's file is."""
    if depth > _DEEPEST:
        raise ReadError(f"models include one another more than {_DEEPEST} deep")
    merged: dict[Element, list[Element]] = {}
    for position, child in enumerate(list(place)):
        if child.tag == "model":
            _include(child, folder, folders, notes, depth + 1)
        if child.tag != "include":
            continue
        uri = child.findtext("uri", "").strip()
        model, file = _included(uri, folder)
        merge = _is_true(child.get("merge"), f"the included model {shown(uri)}, merge")
        if model is None or (merge and place.tag != "model"):
            lacks = "it is merged into what is no model" if model is not None else "it is not there"
            if model is None and is_file(file):
                lacks = f"{shown(file.name)} holds no model of SDFormat"
            notes[f"the included model {shown(uri)} is not read: {lacks}"] = None
            continue
        model.set("name", child.findtext("name", model.get("name", "")).strip())
        if placed := child.findtext("placement_frame", "").strip():
            model.set("placement_frame", placed)
        if (pose := child.find("pose")) is not None:
            for own in model.findall("pose"):
                model.remove(own)
            model.append(pose)
        folders[model] = file.parent
        if len(folders) > _MOST:
            raise ReadError(f"more than {_MOST} models are included")
        place[position] = model
        _include(model, file.parent, folders, notes, depth + 1)
        if merge:
            merged[model] = _merged(model, file.parent, folders)
    if merged:
        place[:] = [each for child in place for each in merged.get(child, [child])]


def _merged(model: Element, folder: Path, folders: dict[Element, Path]) -> list[Element]:
    """Return the elements of a model as elements of the one it is merged into, and a frame that stands for its own."""
    proxy = f"_merged__{model.get('name', '')}__model__"
    elements = [child for child in model if child.tag in ("link", "frame", "joint", "model")]
    links = [child.get("name", "") for child in elements if child.tag == "link"]
    for child in elements:
        own = [child] if child.tag == "model" else list(child.iter())
        for each in own:
            for key in ("attached_to", "relative_to", "frame", "expressed_in"):
                if each.get(key) == _MODEL:
                    each.set(key, proxy)
            if each.tag in ("parent", "child") and (each.text or "").strip() == _MODEL:
                each.text = proxy
        if child.tag == "frame" and not child.get("attached_to"):
            child.set("attached_to", proxy)
        if child.tag in ("link", "model") and not _relative_to(child):
            pose = child.find("pose")
            (SubElement(child, "pose") if pose is None else pose).set("relative_to", proxy)
        if child.tag == "link":
            folders[child] = folder
    frame = Element("frame", {"name": proxy, "attached_to": model.get("canonical_link") or (*links, "")[0]})
    pose = model.find("pose")
    frame.append(Element("pose") if pose is None else pose)
    frame[0].set("relative_to", _relative_to(model) or _MODEL)
    frame.set(_PLACED, model.get("placement_frame", ""))
    return [frame, *elements]


def _included(uri: str, folder: Path) -> tuple[Element | None, Path]:
    """Return the model that a file, or a folder with a model.config, holds, and the file."""
    try:
        file = mesh_file(uri, folder)
        if not is_file(file):
            config = mesh_file(f"{uri}/model.config", folder)
            named = robot_xml(config.read_bytes())[0].findtext("sdf", "").strip() if is_file(config) else "model.sdf"
            file = mesh_file(f"{uri}/{named}", folder)
    except ReadError:  # it lies on a server
        return None, folder
    if not is_file(file):
        return None, folder
    try:
        return robot_xml(file.read_bytes())[0].find("model"), file
    except ReadError as error:
        raise ReadError(f"the included model {shown(uri)}: {error}", code=error.code) from None


def _declare(place: Element, scope: str, frames: _Frames) -> None:
    """Gather where the frames of a model or world lie, and what each goes with; `scope` ends their full names."""
    model = scope + _MODEL if scope else ""  # the world is what all counts from
    inner = [(child, f"{scope}{child.get('name', '')}::") for child in place.findall("model")]
    elements = [(tag, element) for tag in ("link", "frame", "joint") for element in place.findall(tag)]
    names: set[str] = set()
    for tag, element in elements:
        name = element.get("name", "")
        if name in names and tag != "link":  # links, frames and joints could share one up to SDFormat 1.6
            name = f"{name}_{tag}"
            element.set("name", name)
        names.add(name)
        frames.poses[scope + name] = model, _pose(element, f"{tag} {shown(name)}")
    for child, within in inner:
        frames.poses[within + _MODEL] = model, _pose(child, f"model {shown(child.get('name', ''))}")
        _declare(child, within, frames)
    frames.links |= {scope + element.get("name", ""): None for tag, element in elements if tag == "link"}
    # Now that every name is known, what each counts from.
    for tag, element in elements:
        full = scope + element.get("name", "")
        usual = {"frame": element.get("attached_to"), "joint": element.findtext("child", "").strip()}.get(tag)
        if tag != "link":
            frames.attached[full] = frames.find(usual, scope) if usual else model
        relative = _relative_to(element) or usual
        frames.poses[full] = frames.find(relative, scope) if relative else model, frames.poses[full][1]
    for child, within in inner:
        if relative := _relative_to(child):
            frames.poses[within + _MODEL] = frames.find(relative, scope), frames.poses[within + _MODEL][1]
    for tag, element in elements:
        if tag == "frame" and (placed := element.get(_PLACED)):  # of a merged model, whose pose that is
            full = scope + element.get("name", "")
            outer, where = frames.poses[full]
            frames.poses[full] = outer, where.then(frames.between(frames.find(placed, scope), full))
    if not scope:
        return
    if canonical := place.get("canonical_link"):
        frames.attached[model] = frames.find(canonical, scope)
    elif first := [scope + element.get("name", "") for tag, element in elements if tag == "link"]:
        frames.attached[model] = first[0]
    elif inner:
        frames.attached[model] = inner[0][1] + _MODEL
    if placed := place.get("placement_frame"):  # the pose is where that frame lies
        outer, where = frames.poses[model]
        frames.poses[model] = outer, where.then(frames.between(frames.find(placed, scope), model))


def _links(
    model: Element,
    scope: str,
    frames: _Frames,
    hung: Mapping[str, Joint],
    drop: str,
    folder: Path,
    folders: Mapping[Element, Path],
    notes: dict[str, None],
) -> Iterator[Link]:
    folder = folders.get(model, folder)
    for element in model.findall("link"):
        if not element.get("name"):
            notes["a link without a name is left out"] = None
            continue
        full = scope + element.get("name", "")
        name = full.removeprefix(drop)
        geometries = tuple(_geometries(element, full, name, scope, frames, folders.get(element, folder), notes))
        joint = hung.get(visible(full))
        if joint is None:
            joint = Joint(name, None, frames.between("", full))
        else:
            above = joint.parent and joint.parent.removeprefix(drop)
            joint = replace(joint, name=joint.name.removeprefix(drop), parent=above)
        what = f"link {shown(name)}"
        inertial = _inertial(element, what, notes)
        fixed = joint.kind == "fixed" and joint.parent is not None
        parent, placement = (joint.parent, joint.placement) if fixed else (None, Placement())
        _, mass = _automatic(element, what)
        yield Link(name, inertial, geometries, parent, placement, joint=joint, mass=mass)
    for child in model.findall("model"):
        yield from _links(child, f"{scope}{child.get('name', '')}::", frames, hung, drop, folder, folders, notes)


def _join(place: Element, scope: str, root: Element, frames: _Frames) -> Iterator[str]:
    """Gather joints, and yield what had to be decided."""
    for joint in place.findall("joint"):
        if note := _read_joint(joint, scope, root, frames):
            yield note
    for model in place.findall("model"):
        yield from _join(model, f"{scope}{model.get('name', '')}::", root, frames)


def _read_joint(joint: Element, scope: str, root: Element, frames: _Frames) -> str | None:
    """Gather a joint, where all are at 0; return why it is left out, if it is."""
    name = joint.get("name", "")
    ends = [joint.findtext(tag, "").strip() for tag in ("parent", "child")]
    if not all(ends):
        return f"joint {shown(name)} has no {'child' if ends[0] else 'parent'}: it is left out of the tree"
    if joint.get("type") == "fixed":
        for end in ends:
            frames.find(end, scope)
    parent, child = (frames.link(end, scope) for end in ends)
    if parent is None or not child:
        return f"joint {shown(name)} joins frames of no link: it is left out of the tree" if child else None
    full = scope + name
    kind, axis = _MOTIONS.get(joint.get("type", ""), "other"), np.array([0.0, 0.0, 1.0])
    element = joint.find("axis")
    try:
        if element is not None and (xyz := element.find("xyz")) is not None:
            axis = np.array(floats(xyz.text or "", 3, f"joint {shown(name)}, axis"))
            version = tuple(int(k) for k in root.get("version", "1.9").split(".")[:2] if k.isdecimal())
            old = "true" if version < (1, 5) else "false"
            in_model = element.findtext("use_parent_model_frame", old).strip() in ("true", "1")
            expressed = scope + _MODEL if in_model else full
            if xyz.get("expressed_in"):
                expressed = frames.find(xyz.get("expressed_in", ""), scope)
            axis = frames.between(child, expressed).rotation @ axis
        if not axis.any():
            raise ReadError("it has no direction")
    except ReadError:
        kind = "other" if kind in ("turns", "slides") else kind
    point = frames.between(child, full).origin
    frames.joints.append((child, Joint(full, parent or None, frames.between(parent, child), kind, axis, point)))
    return None


def _inertial(link: Element, what: str, notes: dict[str, None]) -> Inertial | None:
    """Return what is stated of a link; what is left out is 1 kg and 1 kg m² about each axis, by the specification."""
    element = link.find("inertial")
    what = f"{what}, inertial"
    if element is None or _is_true(element.get("auto"), f"{what}, auto"):
        return None
    if len(link.findall("inertial")) > 1:
        notes[f"{what} is there more than once: the first counts"] = None
    if _relative_to(element):
        notes[f"{what}: its pose counts from the link, and relative_to is passed over, as in SDFormat"] = None
    mass = element.findtext("mass", "").strip()
    if not mass:
        notes[f"{what} has no mass: 1 kg, as SDFormat has it"] = None
    tensor = element.find("inertia")
    words = [] if tensor is None else [tensor.findtext(f"i{pair}", "").strip() for pair in _CONVENTION.order]
    moments = [f"i{pair}" for pair in _CONVENTION.order if pair[0] == pair[1]]
    absent = [key for key in moments if tensor is None or not tensor.findtext(key, "").strip()]
    if absent:
        notes[f"{what} has no {', '.join(absent)}: 1 kg m², as SDFormat has it"] = None
    elements = [
        floats(word, 1, f"{what}, i{pair}")[0] if word else float(f"i{pair}" in moments)
        for word, pair in zip(words or [""] * 6, _CONVENTION.order, strict=True)
    ]
    pose = element.findtext("pose", "")
    return Inertial(
        floats(mass, 1, f"{what}, mass")[0] if mass else 1.0,
        _pose(element, what),
        _CONVENTION.tensor(elements),
        (figures(pose.split()[:3]), figures(words)),
    )


def _geometries(
    link: Element, full: str, name: str, scope: str, frames: _Frames, folder: Path, notes: dict[str, None]
) -> Iterator[Geometry]:
    usual, _ = _automatic(link, f"link {shown(name)}")
    roles: tuple[Role, ...] = ("visual", "collision")
    for role in roles:
        for number, element in enumerate(link.findall(role), 1):
            what = f"link {shown(name)}, {role} {number}"
            shape = element.find("geometry")
            if shape is None or len(shape) == 0 or shape[0].tag in _SHAPELESS:
                continue
            placement = _pose(element, what)
            if relative := _relative_to(element):
                placement = frames.between(full, frames.find(relative, scope)).then(placement)
            density = None
            if role == "collision" and usual is not None:
                own = element.findtext("density", "").strip()
                density = floats(own, 1, f"{what}, density")[0] if own else usual
            kind = shape[0]
            label = element.get("name") or f"{kind.tag} {number}"
            scale = None
            solid: Path | Primitive | str
            try:
                if kind.tag == "mesh":
                    reference = kind.findtext("uri", "").strip()
                    label = file_name(reference) or label
                    solid = mesh_file(reference, folder, notes)
                    scale = None if kind.find("scale") is None else scales(kind.findtext("scale", ""), what)
                    if kind.find("submesh") is not None:
                        solid = "a part of a mesh's file cannot be weighed"
                else:
                    solid = _primitive(kind, what)
            except ReadError as error:
                solid = str(error)
            yield Geometry(label, role, solid, placement, scale, density=density)


def _automatic(link: Element, what: str) -> tuple[float | None, float | None]:
    """Return the density that collisions have by default where an inertia is automatic, and the mass of all of them."""
    element, what = link.find("inertial"), f"{what}, inertial"
    if element is None or not _is_true(element.get("auto"), f"{what}, auto"):
        return None, None
    density, mass = (element.findtext(tag, "").strip() for tag in ("density", "mass"))
    return (
        floats(density, 1, f"{what}, density")[0] if density else _WATER,
        floats(mass, 1, f"{what}, mass")[0] if mass else None,
    )


def _primitive(kind: Element, what: str) -> Primitive | str:
    def sizes(key: str, count: int = 1) -> list[float]:
        return floats(kind.findtext(key, ""), count, f"{what}, {key}")

    if kind.tag == "box":
        return Primitive("box", tuple(sizes("size", 3)))
    if kind.tag == "sphere":
        return Primitive("sphere", tuple(sizes("radius")))
    if kind.tag == "cylinder":
        return Primitive("cylinder", (*sizes("radius"), *sizes("length")))
    if kind.tag == "capsule":
        return Primitive("capsule", (*sizes("radius"), *sizes("length")))
    if kind.tag == "cone":
        return Primitive("cone", (*sizes("radius"), *sizes("length")))
    if kind.tag == "ellipsoid":
        return Primitive("ellipsoid", tuple(sizes("radii", 3)))
    return f"{shown(kind.tag)} is no shape that can be weighed"


def _relative_to(element: Element) -> str:
    pose = element.find("pose")
    if pose is None:
        return ""
    return pose.get("relative_to") or pose.get("frame") or ""  # the latter is its name up to SDFormat 1.6


def _is_true(word: str | None, what: str) -> bool:
    """Return a truth value as SDFormat writes one; that of an attribute that is not there is false."""
    value = (word or "false").strip().lower()
    if value not in ("true", "false", "1", "0"):
        raise ReadError(f"{what} is {shown(value)}: it must be true or false")
    return value in ("true", "1")


def _pose(element: Element, what: str) -> Placement:
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return Placement()
    what = f"{what}, pose"
    in_degrees = _is_true(pose.get("degrees"), f"{what}, degrees")
    turn = pose.get("rotation_format", "euler_rpy")
    if turn not in ("euler_rpy", "quat_xyzw"):
        raise ReadError(f"{what}, rotation_format is {shown(turn)}: it must be euler_rpy or quat_xyzw")
    if turn == "quat_xyzw":
        *place, x, y, z, w = floats(pose.text or "", 7, what)
        if not any((x, y, z, w)):
            raise ReadError(f"{what} has a quaternion of zero")
        return Placement(rotation_of_quaternion([w, x, y, z]), np.array(place))
    *place, roll, pitch, yaw = floats(pose.text or "", 6, what)
    if in_degrees:
        roll, pitch, yaw = (math.radians(angle) for angle in (roll, pitch, yaw))
    return Placement(rotation_of_rpy(roll, pitch, yaw), np.array(place))
