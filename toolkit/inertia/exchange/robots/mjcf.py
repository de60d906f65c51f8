"""MJCF (MuJoCo): bodies with their `<inertial>` and geoms, defaults, included files and scaled meshes resolved.

Read by the XML reference of MuJoCo's documentation: compiler, default, asset/mesh, body, body/inertial, body/geom and
frame orientations. What has no pair in the other formats is left out and named in a note: plugins, composites,
attached and replicated models. A body without a joint hangs from its parent as by a fixed one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.robots.links import Geometry, Inertial, Joint, Link, Motion, Placement, Primitive, Robot, Role
from inertia.exchange.robots.text import decimals, floats, robot_xml
from inertia.exchange.rotations import rotation_of_quaternion
from inertia.mesh.readers.contents import shown
from inertia.standard_input import file_of

Attributes = Mapping[str, str]

_UNREAD = ("composite", "flexcomp", "attach", "replicate", "plugin")
_CHANGES = ("balanceinertia", "boundmass", "boundinertia", "settotalmass")  # what MuJoCo does to what is stated
_MOTIONS: dict[str, Motion] = {"hinge": "turns", "slide": "slides"}
_NO_SOLID = ("plane", "hfield", "sdf")
_DEEPEST = 32  # files that include one another
_NESTED = 200  # elements in one another
_MOST = 1000  # files that are included in all: two in each would be 2³²


@dataclass(frozen=True)
class _Mesh:
    """A mesh of the assets: its file, and where its coordinates lie in its own axes."""

    file: Path
    scale: tuple[Fraction, Fraction, Fraction]
    placement: Placement


@dataclass
class _Model:
    """What bodies need from the rest of a model."""

    path: Path
    compiler: dict[str, str] = field(default_factory=dict)
    classes: dict[str, dict[str, dict[str, str]]] = field(default_factory=dict)
    meshes: dict[str, _Mesh | str] = field(default_factory=dict)
    notes: dict[str, None] = field(default_factory=dict)

    def note(self, sentence: str) -> None:
        """Say once what had to be decided."""
        self.notes[sentence] = None

    def attributes(self, element: Element, childclass: str) -> dict[str, str]:
        """Return the attributes of an element, those of its class where it has none of its own."""
        name = element.get("class", childclass)
        if name not in self.classes:
            raise ReadError(f"the default class {shown(name)} is not there")
        return {**self.classes[name].get(element.tag, {}), **element.attrib}


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
    model.classes["main"] = {}
    for default in root.findall("default"):
        _defaults(default, default.get("class", "main"), {}, model.classes)
    for number, mesh in enumerate((each for asset in root.findall("asset") for each in asset.findall("mesh")), 1):
        name, what = _mesh(mesh, number, model)
        model.meshes[name] = what
    links = [
        link for world in root.findall("worldbody") for link in _bodies(world, None, Placement(), "main", model, [0])
    ]
    if not links:
        raise ReadError("it holds no body", code="empty")
    if model.compiler.get("inertiafromgeom") == "true" and any(link.inertial is not None for link in links):
        model.note("inertiafromgeom is true: MuJoCo computes masses and tensors from the geoms, whatever is stated")
    for key in _CHANGES:
        if model.compiler.get(key, "false") not in ("false", "0", "-1"):
            model.note(f"{key} is set: MuJoCo changes the masses or tensors that are stated")
    return Robot(path, "mjcf", root.get("model", ""), tuple(links), tuple(model.notes))


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
            raise ReadError(f"the included file {shown(name)} is not there: looked for {folder / name}", code="no_file")
        files.append(file)
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
            own[child.tag] = {**own.get(child.tag, {}), **child.attrib}
    classes[name] = own
    for child in element.findall("default"):
        if child.get("class") is None:
            raise ReadError("a default in another default has no class")
        _defaults(child, child.get("class", ""), own, classes)


def _mesh(element: Element, number: int, model: _Model) -> tuple[str, _Mesh | str]:
    """Return the name of a mesh and what it is, or why it cannot be read."""
    attributes = model.attributes(element, "main")
    reference = attributes.get("file")
    name = attributes.get("name") or (Path(reference).stem if reference else f"mesh {number}")
    what = f"mesh {shown(name)}"
    if reference is None:
        return name, f"{what} has no file: its vertices stand in the model"
    folder = model.compiler.get("meshdir", model.compiler.get("assetdir", ""))
    if model.compiler.get("strippath") == "true":
        reference = Path(reference).name
    file = model.path.parent / folder / reference
    try:
        x, y, z = (Fraction(word) for word in attributes.get("scale", "1 1 1").split())
    except ValueError:
        raise ReadError(f"{what}, scale is {shown(attributes['scale'])}: it must be 3 numbers") from None
    turn = rotation_of_quaternion(_numbers(attributes, "refquat", 4, [1, 0, 0, 0], what).tolist()).T
    if not x == y == z and not np.array_equal(turn, np.eye(3)):
        return name, f"{what} is turned by refquat and scaled differently along its axes"
    # The reference position is taken off first, then the mesh is turned, then scaled.
    origin = -np.array([float(x), float(y), float(z)]) * (turn @ _numbers(attributes, "refpos", 3, [0] * 3, what))
    return name, _Mesh(file, (x, y, z), Placement(turn, origin))


def _bodies(
    element: Element, parent: str | None, where: Placement, childclass: str, model: _Model, count: list[int]
) -> Iterator[Link]:
    """Yield the bodies below a body, or a frame in it, that lies at `where` in the body."""
    for child in element:
        if child.tag == "frame":
            inside = where.then(_placement(child.attrib, "frame", model))
            yield from _bodies(child, parent, inside, child.get("childclass", childclass), model, count)
        elif child.tag == "body":
            yield from _body(child, parent, where, childclass, model, count)
        elif child.tag in _UNREAD:
            model.note(f"{child.tag} is not read: what it makes is left out")


def _body(
    element: Element, parent: str | None, where: Placement, childclass: str, model: _Model, count: list[int]
) -> Iterator[Link]:
    count[0] += 1
    name = element.get("name") or f"body {count[0]}"
    childclass = element.get("childclass", childclass)
    what = f"body {shown(name)}"
    placement = where.then(_placement(element.attrib, what, model))
    joints = [child for child in element if child.tag in ("joint", "freejoint")]
    geometries = tuple(_geometries(element, what, Placement(), childclass, model, [0]))
    hangs = parent if not joints else None
    yield Link(
        name,
        _inertial(element, what, model),
        geometries,
        hangs,
        placement if hangs else Placement(),
        joint=_joint(joints, name, parent, placement, childclass, model),
    )
    yield from _bodies(element, name, Placement(), childclass, model, count)


def _joint(
    elements: list[Element], link: str, parent: str | None, placement: Placement, childclass: str, model: _Model
) -> Joint:
    if not elements or elements[0].tag == "freejoint":
        return Joint(link, parent, placement)
    name = elements[0].get("name") or link
    if len(elements) > 1:
        return Joint(name, parent, placement, "other")
    attributes, what = model.attributes(elements[0], childclass), f"joint {shown(name)}"
    kind: Motion = _MOTIONS.get(attributes.get("type", "hinge"), "other")
    axis = _numbers(attributes, "axis", 3, [0.0, 0.0, 1.0], what)
    return Joint(name, parent, placement, kind, axis, _numbers(attributes, "pos", 3, [0.0, 0.0, 0.0], what))


def _inertial(body: Element, what: str, model: _Model) -> Inertial | None:
    element = body.find("inertial")
    if element is None:
        return None
    what, attributes = f"{what}, inertial", element.attrib
    if "mass" not in attributes:
        raise ReadError(f"{what} has no mass", code="no_mass")
    mass = float(_numbers(attributes, "mass", 1, None, what)[0])
    if "fullinertia" in attributes:
        inertia = CONVENTIONS["mjcf"].tensor(_numbers(attributes, "fullinertia", 6, None, what).tolist())
    else:
        inertia = np.diag(_numbers(attributes, "diaginertia", 3, None, what))
    return Inertial(
        mass,
        _placement(attributes, what, model),
        inertia,
        (
            decimals([attributes["mass"]]),
            decimals([attributes.get("pos", "")]),
            decimals([attributes.get("fullinertia", attributes.get("diaginertia", ""))]),
        ),
    )


def _geometries(
    element: Element, what: str, where: Placement, childclass: str, model: _Model, count: list[int]
) -> Iterator[Geometry]:
    for child in element:
        if child.tag == "frame":
            inside = where.then(_placement(child.attrib, "frame", model))
            yield from _geometries(child, what, inside, child.get("childclass", childclass), model, count)
        elif child.tag == "geom":
            count[0] += 1
            attributes = model.attributes(child, childclass)
            geometry = _geometry(attributes, f"{what}, geom {count[0]}", count[0], where, model)
            if geometry is not None:
                yield geometry


def _geometry(attributes: Attributes, what: str, number: int, where: Placement, model: _Model) -> Geometry | None:
    kind = attributes.get("type", "sphere")
    role: Role = "collision"
    if attributes.get("contype") == attributes.get("conaffinity") == "0":
        role = "visual"
    if kind in _NO_SOLID:
        return None
    if "mesh" not in attributes:
        placement, shape = _primitive(kind, attributes, what, model)
        return Geometry(attributes.get("name") or f"{kind} {number}", role, shape, where.then(placement))
    name = attributes.get("name") or attributes["mesh"]
    if kind != "mesh":
        return Geometry(name, role, f"a {kind} fitted to a mesh is not read")
    mesh = model.meshes.get(attributes["mesh"], f"the mesh {shown(attributes['mesh'])} is not among the assets")
    if isinstance(mesh, str):
        return Geometry(name, role, mesh)
    placement = where.then(_placement(attributes, what, model)).then(mesh.placement)
    return Geometry(attributes.get("name") or mesh.file.name, role, mesh.file, placement, mesh.scale)


def _primitive(kind: str, attributes: Attributes, what: str, model: _Model) -> tuple[Placement, Primitive]:
    """Return where a primitive lies, and what it is; sizes in MJCF are radii and half lengths."""
    size = [*floats(attributes.get("size", "0"), len(attributes.get("size", "0").split()), f"{what}, size"), 0.0, 0.0]
    placement = _placement(attributes, what, model)
    if "fromto" in attributes and kind in ("capsule", "cylinder", "box", "ellipsoid"):
        ends = np.array(floats(attributes["fromto"], 6, f"{what}, fromto")).reshape(2, 3)
        placement = Placement(_along(ends[0] - ends[1], what), ends.mean(axis=0))
        half = 0.5 * float(np.linalg.norm(ends[1] - ends[0]))
        size = [size[0], half] if kind in ("capsule", "cylinder") else [size[0], size[1] or size[0], half]
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
    raise ReadError(f"{what}: {shown(kind)} is no type of a geom")


def _placement(attributes: Attributes, what: str, model: _Model) -> Placement:
    """Return position and orientation, however the latter is written."""
    return Placement(_rotation(attributes, what, model), _numbers(attributes, "pos", 3, [0.0] * 3, what))


def _rotation(attributes: Attributes, what: str, model: _Model) -> Float:
    unit = 1.0 if model.compiler.get("angle", "degree") == "radian" else math.pi / 180
    if "quat" in attributes:
        quaternion = _numbers(attributes, "quat", 4, None, what)
        if not quaternion.any():
            raise ReadError(f"{what}, quat is zero")
        return rotation_of_quaternion(quaternion.tolist())
    if "axisangle" in attributes:
        *axis, angle = _numbers(attributes, "axisangle", 4, None, what).tolist()
        return _turn(_unit(np.array(axis), what), angle * unit)
    if "euler" in attributes:
        rotation = np.eye(3)
        sequence = model.compiler.get("eulerseq", "xyz")
        for letter, angle in zip(sequence, _numbers(attributes, "euler", 3, None, what).tolist(), strict=True):
            step = _turn(np.eye(3)["xyz".index(letter.lower())], angle * unit)
            rotation = rotation @ step if letter.islower() else step @ rotation  # about moving, or fixed axes
        return rotation
    if "xyaxes" in attributes:
        axes = _numbers(attributes, "xyaxes", 6, None, what).reshape(2, 3)
        x = _unit(axes[0], what)
        y = _unit(axes[1] - x * (x @ axes[1]), what)
        return np.column_stack([x, y, np.cross(x, y)])
    if "zaxis" in attributes:
        return _along(_numbers(attributes, "zaxis", 3, None, what), what)
    return np.eye(3)


def _along(direction: Float, what: str) -> Float:
    """Return the smallest turn that takes z to a direction."""
    z = _unit(direction, what)
    sine = math.hypot(z[0], z[1])
    axis = np.array([-z[1], z[0], 0.0]) / sine if sine else np.array([1.0, 0.0, 0.0])
    return _turn(axis, math.atan2(sine, z[2]))


def _turn(axis: Float, angle: float) -> Float:
    half = 0.5 * angle
    return rotation_of_quaternion([math.cos(half), *(math.sin(half) * axis).tolist()])


def _unit(vector: Float, what: str) -> Float:
    length = float(np.linalg.norm(vector))
    if not length:
        raise ReadError(f"{what}: an axis of no length")
    return vector / length


def _numbers(attributes: Attributes, key: str, count: int, default: list[float] | None, what: str) -> Float:
    if key in attributes:
        return np.array(floats(attributes[key], count, f"{what}, {key}"))
    if default is None:
        raise ReadError(f"{what} has no {key}")
    return np.array(default, float)
