"""MJCF (MuJoCo): bodies with their `<inertial>` and geoms, defaults, included files and scaled meshes resolved.

Read by the XML reference of MuJoCo's documentation: compiler, default, asset/mesh, body, body/inertial, body/geom and
frame orientations. What has no pair in the other formats is left out and named in a note: plugins, composites,
attached models. A body without a joint hangs from its parent as by a fixed one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import field, replace
from fractions import Fraction
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from inertia.errors import ReadError, visible
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.robots.links import (
    Filling,
    Geometry,
    Inertial,
    Joint,
    Link,
    Motion,
    Placement,
    Primitive,
    Robot,
    Role,
)
from inertia.exchange.robots.mjcf_frames import ORIENTATIONS, Angles, along, numbers, turned
from inertia.exchange.robots.text import figures, floats, robot_xml, scales
from inertia.mesh.geometry.hull import convex_hull
from inertia.mesh.part import Part
from inertia.mesh.readers.contents import shown
from inertia.output import note_input
from inertia.records import dataclass
from inertia.standard_input import file_of

Attributes = Mapping[str, str]

_UNREAD = ("composite", "flexcomp", "attach", "replicate")  # what they make has a mass
_LEAST = {"boundmass": "lighter bodies to {:g} kg", "boundinertia": "smaller moments to {:g} kg m²"}
_MOTIONS: dict[str, Motion] = {"hinge": "turns", "slide": "slides"}
_WEIGHS = ("density", 1000.0), ("mass", -1.0)  # of a geom, and what they are by default: no mass of its own
_FILLINGS: dict[str, Filling] = {"legacy": "legacy", "exact": "solid", "shell": "surface", "convex": "hull"}
_DEEPEST = 32  # files that include one another
_NESTED = 200  # elements in one another
_MOST = 1000  # files that are included in all: two in each would be 2³²
_COPIES = 100_000  # elements that replicas make in all


@dataclass(frozen=True)
class _Mesh:
    """A mesh of the assets: its file, or itself; where its coordinates lie in its own axes, and what of it weighs."""

    shape: Path | Part
    scale: tuple[Fraction, Fraction, Fraction]
    placement: Placement
    filling: Filling


@dataclass
class _Model:
    """What bodies need from the rest of a model."""

    path: Path
    compiler: dict[str, str] = field(default_factory=dict)
    angles: Angles = field(default_factory=Angles)
    classes: dict[str, dict[str, dict[str, str]]] = field(default_factory=dict)
    meshes: dict[str, _Mesh | str] = field(default_factory=dict)
    notes: dict[str, None] = field(default_factory=dict)
    left_out: dict[str, None] = field(default_factory=dict)
    names: set[str] = field(default_factory=set)
    joints: set[str] = field(default_factory=set)

    def note(self, sentence: str) -> None:
        """Say once what had to be decided."""
        self.notes[sentence] = None

    def attributes(self, element: Element, childclass: str) -> dict[str, str]:
        """Return the attributes of an element, those of its class where it has none of its own."""
        name = element.get("class", childclass)
        if name not in self.classes:
            raise ReadError(f"the default class {shown(name)} is not there: define it, or name another")
        return _overlaid(self.classes[name].get(element.tag, {}), element.attrib)


def _overlaid(usual: Attributes, own: Attributes) -> dict[str, str]:
    """Return attributes over those of a class: any orientation takes the place of any, and of ``size`` as many numbers

    as are written, as MuJoCo does (tried with it: it wants all the numbers of other attributes).
    """
    if any(key in own for key in ORIENTATIONS):
        usual = {key: value for key, value in usual.items() if key not in ORIENTATIONS}
    result = {**usual, **own}
    if "size" in usual and "size" in own:
        written = own["size"].split()
        result["size"] = " ".join([*written, *usual["size"].split()[len(written) :]])
    return result


def _unused(name: str, names: set[str]) -> str:
    """Return a name that nothing has, a number behind it where something has that one; it is taken then."""
    number, own = 1, name
    while own in names:
        number += 1
        own = f"{name} {number}"
    names.add(own)
    return own


def read_mjcf(path: Path) -> Robot:
    """Read the bodies of a model; raise `ReadError` where it is none."""
    root, notes = robot_xml(file_of(str(path)).read_bytes())
    if root.tag != "mujoco":
        raise ReadError(f"it begins with {shown(root.tag)}, not with mujoco: it is no MJCF file", code="wrong_format")
    _include(root, path.parent, path.parent, [], 0, 0)
    model = _Model(path, notes=dict.fromkeys(notes))
    for compiler in root.findall("compiler"):
        model.compiler.update(compiler.attrib)
    if model.compiler.get("coordinate") == "global":
        raise ReadError(
            "its coordinates are global, which MuJoCo reads no longer: load it with MuJoCo 2.3.3 or older and save it"
        )
    model.angles = Angles.of(model.compiler)
    model.classes["main"] = {}
    for default in root.findall("default"):
        _defaults(default, "main", {}, model.classes)
        if (name := default.get("class", "main")) != "main":
            model.classes[name] = model.classes["main"]
            model.note(f"the default class of all elements is called {shown(name)}: MuJoCo 3 wants it called main")
    for mesh in (each for asset in root.findall("asset") for each in asset.findall("mesh")):
        name, what = _mesh(mesh, model)
        model.meshes[name] = what
    worlds = root.findall("worldbody")
    for world in worlds:
        _replicate(world, model, [0])
        model.names.update(visible(body.get("name", "")) for body in world.iter("body"))
        model.joints.update(visible(joint.get("name", "")) for joint in world.iter("joint"))
    count = [0]
    links = [link for world in worlds for link in _bodies(world, None, "main", model, count)]
    if not links:
        left = "; ".join(model.left_out)
        but = f" but in what is left out: {left}" if left else ": export the robot again"
        raise ReadError(f"it holds no body{but}", code="empty")
    if model.compiler.get("fusestatic") == "true":
        model.note("fusestatic is true: MuJoCo merges bodies without a joint with their parents")
    if model.compiler.get("balanceinertia", "false") != "false":
        model.note("balanceinertia is set: MuJoCo changes tensors that break the triangle rule")
    least = [float(numbers(model.compiler, key, 1, [0.0], "compiler")[0]) for key in _LEAST]
    for key, value in zip(_LEAST, least, strict=True):
        if value > 0:
            model.note(f"{key} is set: MuJoCo raises {_LEAST[key].format(value)}")
    mass = float(numbers(model.compiler, "settotalmass", 1, [-1.0], "compiler")[0])
    if mass > 0:
        model.note(f"settotalmass is set: all weigh {mass:g} kg together, for which masses and tensors are scaled")
    total = mass if mass > 0 else None
    left_out = tuple(model.left_out)
    notes = (*model.notes, *left_out)
    return Robot(path, "mjcf", root.get("model", ""), tuple(links), notes, total, left_out, (least[0], least[1]))


def _include(element: Element, folder: Path, here: Path, files: list[Path], depth: int, level: int) -> None:
    """Replace every ``<include file>`` below an element by what the file holds."""
    if depth > _DEEPEST:
        raise ReadError(f"files include one another more than {_DEEPEST} deep")
    if level > _NESTED:
        raise ReadError(f"its elements are nested deeper than {_NESTED}")
    for position, child in reversed(list(enumerate(element))):
        if child.tag != "include":
            _include(child, folder, here, files, depth, level + 1)
            continue
        name = child.get("file", "")
        file = next((place for place in (folder / name, here / name) if place.is_file()), None)
        if file is None:
            note_input(folder / name)
            raise ReadError(f"the included file {shown(name)} is not there: looked for {folder / name}", code="no_file")
        files.append(file)
        note_input(file)
        if len(files) > _MOST:
            raise ReadError(f"more than {_MOST} files are included")
        other, _ = robot_xml(file.read_bytes())
        _include(other, folder, file.parent, files, depth + 1, level)
        element[position : position + 1] = list(other)


def _defaults(
    element: Element, name: str, above: dict[str, dict[str, str]], classes: dict[str, dict[str, dict[str, str]]]
) -> None:
    """Gather the attributes of a class, those of the class around it where it has none."""
    own = {tag: dict(attributes) for tag, attributes in {**above, **classes.get(name, {})}.items()}
    for child in element:
        if child.tag != "default":
            own[child.tag] = _overlaid(own.get(child.tag, {}), child.attrib)
    classes[name] = own
    for child in element.findall("default"):
        if child.get("class") is None:
            raise ReadError("a default in another default has no class: give it one")
        _defaults(child, child.get("class", ""), own, classes)


def _replicate(element: Element, model: _Model, made: list[int]) -> None:
    """Replace every ``<replicate>`` below an element by frames with the copies, whose names end in their numbers.

    Each lies `offset` beyond the one before, in the axes of that; the angles of ``euler`` are multiplied, not repeated.
    """
    for position, child in reversed(list(enumerate(element))):
        _replicate(child, model, made)
        if child.tag != "replicate" or any(key in child.attrib for key in (*ORIENTATIONS, "pos") if key != "euler"):
            continue
        what = "replicate"
        count = int(numbers(child.attrib, "count", 1, None, what)[0])
        offset, euler = (numbers(child.attrib, key, 3, [0.0] * 3, what) for key in ("offset", "euler"))
        made[0] += count * sum(1 for _ in child.iter())
        if made[0] > _COPIES:
            raise ReadError(f"more than {_COPIES} elements are made by replicate")
        place, frames = np.zeros(3), []
        for number in range(count):
            turn = " ".join(repr(number * angle) for angle in euler.tolist())
            frame = Element("frame", {"pos": " ".join(map(repr, place.tolist())), "euler": turn})
            if "childclass" in child.attrib:
                frame.set("childclass", child.attrib["childclass"])
            frame.extend(deepcopy(each) for each in child)
            for each in frame.iter():
                if "name" in each.attrib:
                    each.set("name", f"{each.get('name')}{child.get('sep', '')}{number:0{len(str(count))}d}")
            frames.append(frame)
            with np.errstate(over="ignore", invalid="ignore"):  # the frame of the next says so
                place = place + model.angles.placement({"euler": turn}, what).rotation @ offset
        element[position : position + 1] = frames


def _mesh(element: Element, model: _Model) -> tuple[str, _Mesh | str]:
    """Return the name of a mesh and what it is, or why it cannot be read."""
    attributes = model.attributes(element, "main")
    reference = attributes.get("file")
    name = attributes.get("name") or Path(reference or "").stem
    what = f"mesh {shown(name)}"
    if reference is None and "vertex" not in attributes:
        return name, f"{what} has no file and no vertices: what MuJoCo makes by builtin is not read"
    folder = model.compiler.get("meshdir", model.compiler.get("assetdir", ""))
    if reference is None:
        shape: Path | Part | None = _inline(attributes, what)
    else:
        stripped = model.compiler.get("strippath") == "true"
        shape = model.path.parent / folder / (Path(reference).name if stripped else reference)
    if shape is None:
        return name, f"{what} is flat: its convex hull encloses nothing"
    x, y, z = scales(attributes.get("scale", "1 1 1"), what)
    turn = turned(attributes, "refquat", what).T
    if not x == y == z and not np.array_equal(turn, np.eye(3)):
        return name, f"{what} is turned by refquat and scaled differently along its axes"
    # The reference position is taken off first, then the mesh is turned, then scaled.
    origin = -np.array([float(x), float(y), float(z)]) * (turn @ numbers(attributes, "refpos", 3, [0] * 3, what))
    # Up to MuJoCo 3.2 the compiler said it of all meshes.
    filling = attributes.get("inertia", "exact" if model.compiler.get("exactmeshinertia") == "true" else "legacy")
    if filling not in _FILLINGS:
        raise ReadError(f"{what}, inertia is {shown(filling)}: it must be {', '.join(_FILLINGS)}")
    return name, _Mesh(shape, (x, y, z), Placement(turn, origin), _FILLINGS[filling])


def _inline(attributes: Attributes, what: str) -> Part | None:
    """Return a mesh whose vertices stand in the model, without faces the convex hull of these; None if that is flat."""
    words = {key: attributes.get(key, "").split() for key in ("vertex", "face")}
    vertices, faces = (floats(" ".join(word), len(word), f"{what}, {key}") for key, word in words.items())
    for key, values in (("vertex", vertices), ("face", faces)):
        if len(values) % 3:
            raise ReadError(f"{what}, {key} holds {len(values)} numbers: it must hold three of each")
    corners = np.array(vertices).reshape(-1, 3)
    if not faces:
        hull = convex_hull(corners)
        return None if hull is None else Part.from_arrays(hull.reshape(-1, 3), np.arange(hull.size // 3).reshape(-1, 3))
    if not all(0 <= number < len(corners) and number == int(number) for number in faces):
        raise ReadError(f"{what}, face names a vertex that is not there: there are {len(corners)}")
    return Part.from_arrays(corners, np.array(faces, int).reshape(-1, 3))


def _within(
    element: Element, childclass: str, model: _Model, where: Placement | None = None
) -> Iterator[tuple[Element, Placement, str]]:
    """Yield what stands in a body or in the frames in it: where its axes lie in the body, and its default class."""
    where = where or Placement()
    for child in element:
        if child.tag == "frame":
            inside = where.then(model.angles.placement(child.attrib, "frame"))
            yield from _within(child, child.get("childclass", childclass), model, inside)
        else:
            yield child, where, childclass


def _bodies(element: Element, parent: str | None, childclass: str, model: _Model, count: list[int]) -> Iterator[Link]:
    """Yield the bodies below a body or the world."""
    for child, where, inner in _within(element, childclass, model):
        if child.tag == "body":
            yield from _body(child, parent, where, inner, model, count)
        elif child.tag in _UNREAD:
            model.left_out[f"{child.tag} is not read: what it makes is left out"] = None
        elif child.tag == "plugin":
            model.note("plugin is not read: what it makes is left out")


def _body(
    element: Element, parent: str | None, where: Placement, childclass: str, model: _Model, count: list[int]
) -> Iterator[Link]:
    count[0] += 1
    name = element.get("name") or _unused(f"body {count[0]}", model.names)
    childclass = element.get("childclass", childclass)
    what = f"body {shown(name)}"
    placement = where.then(model.angles.placement(element.attrib, what))
    inside = list(_within(element, childclass, model))
    joints = [each for each in inside if each[0].tag in ("joint", "freejoint")]
    geoms = enumerate((each for each in inside if each[0].tag == "geom"), 1)
    geometries = [
        _geometry(model.attributes(geom, inner), f"{what}, geom {number}", number, place, model)
        for number, (geom, place, inner) in geoms
    ]
    hangs = parent if not joints else None
    shapes = tuple(geometry for geometry in geometries if geometry is not None)
    stated = [each for each in inside if each[0].tag == "inertial"]
    if stated and model.compiler.get("inertiafromgeom") == "true" and any(shape.weighs for shape in shapes):
        stated = []
        model.note("inertiafromgeom is true: bodies weigh what their geoms do, whatever is stated of them")
    try:
        inertial, fault = _inertial(stated, what, model), ""
    except ReadError as error:
        inertial, fault = None, str(error)
    first, *further = [_joint(each, name, parent, placement, model) for each in joints] or [
        Joint(_unused(name, model.joints), parent, placement)
    ]
    yield Link(
        name,
        inertial,
        shapes,
        hangs,
        placement if hangs else Placement(),
        fault,
        first,
        further=tuple(further),
    )
    yield from _bodies(element, name, childclass, model, count)


def _joint(
    one: tuple[Element, Placement, str], link: str, parent: str | None, placement: Placement, model: _Model
) -> Joint:
    element, where, childclass = one
    if element.tag == "freejoint":
        return Joint(_unused(link, model.joints), parent, placement)
    name = element.get("name") or _unused(link, model.joints)
    attributes, what = model.attributes(element, childclass), f"joint {shown(name)}"
    kind: Motion = _MOTIONS.get(attributes.get("type", "hinge"), "other")
    axis = where.rotation @ numbers(attributes, "axis", 3, [0.0, 0.0, 1.0], what)
    if not axis.any():
        raise ReadError(f"{what}, axis has no length")
    point = where.then(Placement(origin=numbers(attributes, "pos", 3, [0.0, 0.0, 0.0], what))).origin
    rest = float(numbers(attributes, "ref", 1, [0.0], what)[0]) * (model.angles.unit if kind == "turns" else 1.0)
    return Joint(name, parent, placement, kind, axis, point, rest)


def _inertial(elements: list[tuple[Element, Placement, str]], what: str, model: _Model) -> Inertial | None:
    """Return what is stated of a body; raise `ReadError` where MuJoCo would not load it."""
    if not elements:
        return None
    what = f"{what}, inertial"
    if len(elements) > 1:
        raise ReadError(f"{what} is there {len(elements)} times: MuJoCo loads no such body, keep one")
    element, where, _ = elements[0]
    attributes = element.attrib
    if "mass" not in attributes:
        raise ReadError(f"{what} has no mass: state one")
    mass = float(numbers(attributes, "mass", 1, None, what)[0])
    placement = where.then(model.angles.placement(attributes, what, also=("fullinertia",)))
    numbers(attributes, "pos", 3, None, what)
    if "fullinertia" in attributes:
        if "diaginertia" in attributes:
            raise ReadError(f"{what} has both fullinertia and diaginertia: MuJoCo loads no such body, keep one")
        inertia = CONVENTIONS["mjcf"].tensor(numbers(attributes, "fullinertia", 6, None, what).tolist())
    else:
        inertia = np.diag(numbers(attributes, "diaginertia", 3, None, what))
    written = attributes["fullinertia" if "fullinertia" in attributes else "diaginertia"]
    return Inertial(mass, placement, inertia, (figures([attributes["pos"]]), figures([written])))


def _geometry(attributes: Attributes, what: str, number: int, where: Placement, model: _Model) -> Geometry | None:
    """Return what a geom is, and what it weighs where its body has no inertial; None of what has no volume."""
    geometry = _shape(attributes, what, number, where, model)
    if geometry is None or model.compiler.get("inertiafromgeom") == "false":
        return geometry
    group = float(numbers(attributes, "group", 1, [0.0], what)[0])
    first, last = numbers(model.compiler, "inertiagrouprange", 2, [0.0, 5.0], "compiler").tolist()
    density, mass = (numbers(attributes, key, 1, [least], what).item() for key, least in _WEIGHS)
    if not first <= group <= last:
        density, mass = 0.0, 0.0
    if attributes.get("shellinertia") == "true":
        if isinstance(geometry.shape, Path | Part):
            why = 'MuJoCo loads no mesh with shellinertia: write inertia="shell" in its <mesh>'
            geometry = replace(geometry, shape=why)
        geometry = replace(geometry, filling="surface")
    return replace(geometry, density=density, mass=mass if mass >= 0 else None)


def _shape(attributes: Attributes, what: str, number: int, where: Placement, model: _Model) -> Geometry | None:
    kind = attributes.get("type", "sphere")
    role: Role = "collision"
    if attributes.get("contype") == attributes.get("conaffinity") == "0":
        role = "visual"
    if kind == "plane":
        return None
    if kind == "hfield":
        return Geometry(attributes.get("name") or f"{kind} {number}", role, "a height field is not read")
    if "mesh" not in attributes:
        name = attributes.get("name") or f"{kind} {number}"
        try:
            placement, shape = _primitive(kind, attributes, what, model)
        except ReadError as error:
            return Geometry(name, role, str(error))
        return Geometry(name, role, shape, where.then(placement))
    name = attributes.get("name") or attributes["mesh"]
    if kind not in ("mesh", "sdf"):
        article = "an" if kind[:1] == "e" else "a"
        return Geometry(name, role, f"{article} {kind} fitted to a mesh is not read")
    mesh = model.meshes.get(attributes["mesh"], f"the mesh {shown(attributes['mesh'])} is not among the assets")
    if isinstance(mesh, str):
        return Geometry(name, role, mesh)
    placement = where.then(model.angles.placement(attributes, what)).then(mesh.placement)
    if isinstance(mesh.shape, Path):
        name = attributes.get("name") or mesh.shape.name
    return Geometry(name, role, mesh.shape, placement, mesh.scale, filling=mesh.filling)


def _primitive(kind: str, attributes: Attributes, what: str, model: _Model) -> tuple[Placement, Primitive]:
    """Return where a primitive lies, and what it is; sizes in MJCF are radii and half lengths."""
    size = [*floats(attributes.get("size", "0"), len(attributes.get("size", "0").split()), f"{what}, size"), 0.0, 0.0]
    placement = model.angles.placement(attributes, what)
    if "fromto" in attributes:
        if kind == "sphere":
            raise ReadError(f"{what} is a sphere with fromto, which MuJoCo does not load: give it a pos")
        if placement.origin.any():
            raise ReadError(f"{what} has both pos and fromto, which MuJoCo does not load: keep one")
        ends = np.array(floats(attributes["fromto"], 6, f"{what}, fromto")).reshape(2, 3)
        placement = Placement(along(ends[0] - ends[1], what), ends.mean(axis=0))
        half = 0.5 * math.hypot(*(ends[1] - ends[0]).tolist())
        size = [size[0], half] if kind in ("capsule", "cylinder") else [size[0], size[0], half]
    if kind == "sphere":
        return placement, Primitive("sphere", (size[0],))
    if kind == "capsule":
        return placement, Primitive("capsule", (size[0], 2 * size[1]))
    if kind == "cylinder":
        return placement, Primitive("cylinder", (size[0], 2 * size[1]))
    if kind == "box":
        return placement, Primitive("box", (2 * size[0], 2 * size[1], 2 * size[2]))
    if kind == "ellipsoid":
        return placement, Primitive("ellipsoid", (size[0], size[1], size[2]))
    raise ReadError(f"{what}: {shown(kind)} is no type of a geom: use one of MuJoCo's")
