"""The links of a robot at a stated position of its joints, laid out as an assembly file is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.errors import GeometryError, ReadError, UsageError, reworded
from inertia.exchange.robots.links import (
    COARSE,
    Geometry,
    Inertial,
    Joint,
    Link,
    Partial,
    Placement,
    Primitive,
    Robot,
    rounding_of,
)
from inertia.exchange.robots.mjcf_masses import legacy, shell
from inertia.exchange.robots.solids import inertial_of, of_mesh, weighed
from inertia.exchange.rotations import rotation_of_quaternion
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.mass.tensor import faults
from inertia.mesh.part import Part
from inertia.mesh.read import read
from inertia.units import unit_of

_FORMATS = ("urdf", "mjcf", "sdf", "usd")
_HALF_BIT = 2.0**-53  # of what is rounded to float64 once, relative
_CLOSED_FORM = 2.0**-50  # of `Primitive.volume`
_LEAST = 1e-60  # m, of sizes that an assembly takes: it says so of others
_WIDER = 1 + 1e-9  # more than sums and products of bounds are rounded by


def robot_tree(robot: Robot, joints: Mapping[str, float] | None = None) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return an assembly laid out as its file is, a part for each link, in metres; and what had to be decided.

    Where nothing is stated of a link and the format has its geometries weigh something (MJCF, SDFormat, USD), each is a
    part too. Of meshes in the robot's file, and of those whose surface or convex hull weighs, that has the mass
    properties; of those that MuJoCo counts in part twice, what it counts.

    Parameters
    ----------
    robot : as read; of a format whose joints are read (URDF, MJCF, SDFormat, USD)
    joints : rad, or m of one that slides, of joints by name; of all others 0, or ``ref`` of MJCF

    Raises `UsageError` for a format without, an unknown joint, and one that does not move; `GeometryError` for a link
    whose stated mass or tensor no body can have, or cannot be read; `ReadError` for one that hangs from itself or none.
    """
    if robot.format not in _FORMATS:
        raise UsageError(f"{robot.path}: the joints of {robot.format} are not read: give URDF, MJCF, SDFormat or USD")
    positions = dict(joints or {})
    known = {joint.name: joint for link in robot.links for joint in link.joints}
    for name, value in positions.items():
        if name not in known or known[name].kind not in ("turns", "slides"):
            what = "does not turn or slide" if name in known else "is none of the robot's"
            moving = ", ".join(name for name, joint in known.items() if joint.kind in ("turns", "slides"))
            remedy = f"name one of {moving}" if moving else "leave it out, as none of them does"
            raise UsageError(f"joint {name!r} {what}: {remedy}")
        if not np.isfinite(value):
            raise UsageError(f"joint {name!r} is at {value!r}: it must be a finite number of rad or m")
    _require_roots(robot)
    parts, notes = [], list(robot.notes)
    names = {link.name for link in robot.links}
    names |= {f"{link.name}/{geometry.name}" for link in robot.links for geometry in link.geometries}
    taken = {link.name for link in robot.links}
    positions |= {name: _followed(name, known, positions) for name, joint in known.items() if joint.mimic}
    for link in robot.links:
        weighing = () if link.inertial is not None else [each for each in link.geometries if each.weighs]
        notes += [_lacks(link, each) for each in weighing if _fault(each)]
        sound = [each for each in weighing if not _fault(each)]
        whole = _whole(link, sound, robot.least)
        parts.append(_part(replace(link, inertial=whole), positions, notes))
        if whole is None:
            parts += _of_geometries(link, sound, notes, names, taken)
        notes += _unbounded(robot, link)
        if whole is None and not weighing:
            as_a_rule = ", where programs take 1 kg and 1 kg m² for it" if robot.format == "sdf" else ""
            states = "no mass" if link.mass is None else f"a mass of {link.mass:g} kg, but no shape that has it"
            notes.append(f"link {link.name} states {states}: it is a group{as_a_rule}; give it a file or a mass")
        notes += [
            f"joint {joint.name} neither turns nor slides about one axis: it is at its rest"
            for joint in link.joints
            if joint.kind == "other"
        ]
    weights = [part for part in parts if "mass" in part or "density" in part]
    if robot.mass is not None and weights:
        _scale(weights, robot.mass)
    return {"schema": 1, "name": robot.name or robot.path.stem, "unit": "m", "part": parts}, tuple(notes)


def _whole(link: Link, sound: Sequence[Geometry], least: tuple[float, float]) -> Inertial | None:
    """Return what a link has as one, stated, completed or raised; None where it has what its parts have."""
    if link.inertial is not None:
        return _raised(link.inertial, least)
    if link.stated is None and (not any(least) or any(map(_is_counted, sound))):
        return None
    # MuJoCo has the centre of a body without geoms as far from its origin as that is from its parent's.
    whole = Inertial(0.0, Placement() if link.joint is None else link.joint.placement, np.zeros((3, 3)))
    try:
        whole = inertial_of(sound, link.mass, link.stated or Partial()) if sound else whole
    except GeometryError as error:
        raise reworded(error, error.words, (f"link {link.name}", *error.places)) from None
    raised = _raised(whole, least)
    return raised if raised.mass > 0 and (raised is not whole or link.stated is not None) else None


def _raised(stated: Inertial, least: tuple[float, float]) -> Inertial:
    """Return mass and principal moments, those that are smaller raised to a mass, kg, and to a moment, kg m²."""
    mass, moment = least
    moments, axes = np.linalg.eigh(stated.inertia)
    if mass > 0 and stated.mass < mass:
        stated = replace(stated, mass=mass)
    if moment > 0 and moments.min() < moment:
        stated = replace(stated, inertia=(axes * np.maximum(moments, moment)) @ axes.T)
    return stated


def _is_counted(geometry: Geometry) -> bool:
    """Whether a geometry weighs by a rule of MuJoCo's own: a mesh, or the surface of a primitive."""
    return not isinstance(geometry.shape, Primitive) or geometry.filling == "surface"


def _unbounded(robot: Robot, link: Link) -> list[str]:
    """Return, in sentences, what of a link might have to be raised, and is not."""
    weighing = [] if link.inertial is not None else [each for each in link.geometries if each.weighs]
    mass, moment = robot.least
    if any(robot.least) and any(map(_is_counted, weighing)):
        return [
            f"link {link.name} weighs by a mesh or a surface: it is not raised to the least that MuJoCo has: state it"
        ]
    if moment > 0 and not mass > 0 and not weighing and not (link.inertial is not None and link.inertial.mass > 0):
        return [
            f"link {link.name} has no mass, and what MuJoCo raises its moments to, {moment:g} kg m², is not counted: "
            "give it a mass, or leave boundinertia out"
        ]
    return []


def _require_roots(robot: Robot) -> None:
    """Refuse links that hang from none in the file, or from themselves, naming the joints."""
    hung = {link.name: link.joint for link in robot.links}
    rooted: set[str] = set()
    for link in robot.links:
        path: list[str] = []
        name = link.name
        while name not in rooted and (joint := hung[name]) is not None and (parent := joint.parent) is not None:
            if name in path:
                joints = [str(each and each.name) for each in map(hung.get, path[path.index(name) :])]
                raise ReadError(
                    f"link {name!r} hangs from itself, by the joints {', '.join(joints)}: turn one of them round",
                    code="cycle",
                )
            if parent not in hung:
                raise ReadError(
                    f"joint {joint.name!r} hangs link {name!r} on {parent!r}, which is not in the file: check its name"
                )
            path.append(name)
            name = parent
        rooted.update((*path, name))


def unweighed(robot: Robot) -> tuple[str, ...]:
    """Return what has a mass in the robot's format that `robot_tree` leaves out, in sentences."""
    links = [link for link in robot.links if link.inertial is None]
    shapes = [(link, geometry) for link in links for geometry in link.geometries if geometry.weighs]
    without = [link for link in links if link.mass is not None and not any(each.weighs for each in link.geometries)]
    return (
        *robot.left_out,
        *(sentence for link in robot.links for sentence in _unbounded(robot, link)),
        *(_lacks(link, geometry) for link, geometry in shapes if _fault(geometry)),
        *(f"link {link.name} states a mass of {link.mass:g} kg, but no shape that has it" for link in without),
    )


def _fault(geometry: Geometry) -> str:
    """Return why a geometry cannot be weighed; "" where it can."""
    if isinstance(geometry.shape, str):
        return geometry.shape
    if isinstance(geometry.shape, Primitive) and min(geometry.shape.sizes) <= 0:
        return "it encloses nothing"
    return ""


def _lacks(link: Link, geometry: Geometry) -> str:
    return f"link {link.name}, {geometry.name} is left out: {_fault(geometry)}"


def _followed(name: str, joints: Mapping[str, Joint], positions: Mapping[str, float]) -> float:
    """Return the position of a joint by what it mimics; one whose position is stated follows none."""
    factor, shift = 1.0, 0.0
    path: set[str] = set()
    while name not in positions and name not in path and name in joints and (mimic := joints[name].mimic) is not None:
        path.add(name)
        name, multiplier, offset = mimic
        factor, shift = factor * multiplier, shift + factor * offset
    return factor * positions.get(name, 0.0) + shift


def _part(link: Link, positions: Mapping[str, float], notes: list[str]) -> dict[str, Any]:
    if link.fault:
        raise GeometryError(f"{link.fault}: mend it with `audit`, or leave it out")
    if link.inertial is not None and link.inertial.mass < 0:
        raise GeometryError(f"link {link.name}: its mass is {link.inertial.mass:g} kg: it must not be negative")
    part: dict[str, Any] = {"name": link.name}
    if (joint := link.joint) is not None:
        if joint.parent is not None:
            part["parent"] = joint.parent
        place = joint.placement
        for each in link.joints:
            place = place.then(_moved(each, positions.get(each.name, each.rest)))
        part |= _placed(place)
    if (stated := link.inertial) is not None and stated.mass > 0:
        rotation = stated.placement.rotation
        tensor = rotation @ stated.inertia @ rotation.T
        tensor = (tensor + tensor.T) / 2
        part |= {"mass": stated.mass, "center_of_mass": stated.placement.origin.tolist(), "inertia": tensor.tolist()}
        part |= {} if stated.error is None else {"bound": _bound_of(stated.error)}
        if broken := faults(tensor):
            if not _is_rounded(stated):
                raise GeometryError(f"link {link.name}: {broken[0]}: mend it with `audit`, or leave the tensor out")
            notes.append(
                f"link {link.name}: {broken[0]}: rounding to its last decimal explains that, and it counts as it is"
            )
            part["bound"] = {"inertia": _rounded_by(stated) / float(np.linalg.norm(tensor))}
    return part


def _is_rounded(stated: Inertial) -> bool:
    """Whether rounding to the last decimal explains that a tensor breaks the triangle rule, as `audit` has it."""
    moments = np.linalg.eigvalsh(stated.inertia)
    slack = min(rounding_of(stated.inertia, stated.figures[1]), COARSE * float(moments.sum()))
    return bool(moments[0] > 0 and moments[0] + moments[1] - moments[2] >= -2 * slack)


def _rounded_by(stated: Inertial) -> float:
    """Return by how much rounding may have moved a tensor (Frobenius norm), kg m²."""
    figures = stated.figures[1]
    return 0.0 if figures is None else float(np.linalg.norm(figures.half_units(stated.inertia)))


def _of_geometries(
    link: Link, geometries: Sequence[Geometry], notes: list[str], names: set[str], taken: set[str]
) -> list[dict[str, Any]]:
    """Return parts for the geometries that a link weighs by.

    `names` are those given; `taken` of them and of others are those that parts have.
    """
    parts = []
    for geometry in geometries:
        name = own = f"{link.name}/{geometry.name}"
        number = 1
        while own in taken or (number > 1 and own in names):
            number += 1
            own = f"{name} {number}"
        taken.add(own)
        part: dict[str, Any] = {"name": own, "parent": link.name}
        if geometry.stated is not None:
            parts.append(part | _figures(weighed(geometry, own)))
            continue
        weight = {"density": geometry.density} if geometry.mass is None else {"mass": geometry.mass}
        if isinstance(geometry.shape, Primitive):
            part |= {"shape": geometry.shape.kind, "size": list(geometry.shape.sizes)} | weight
            if geometry.filling == "surface" and _LEAST <= min(part["size"]) <= max(part["size"]) <= 1 / _LEAST:
                part |= _of_shell(geometry, geometry.shape)
                part.pop("density", None)
        elif isinstance(geometry.shape, Path) and geometry.filling in ("solid", "legacy"):
            part |= {"file": str(geometry.shape.absolute())} | _in_metres(geometry) | weight
            if geometry.filling == "legacy" and (counted := _counted(geometry, geometry.shape, own, notes)):
                part |= counted
                part.pop("density", None)
        elif not isinstance(geometry.shape, str):
            part |= _figures(of_mesh(geometry, geometry.shape, own))
            if geometry.transform is not None:
                part["at"] = list(geometry.transform.at)
            if geometry.filling == "legacy":
                part |= _counted(geometry, geometry.shape, own, notes)
        parts.append(part | _placed(_centred(geometry)))
    if link.mass is not None and parts:
        _scale(parts, link.mass)
    return parts


def _in_metres(geometry: Geometry) -> dict[str, Any]:
    """Return the unit of a mesh's file, and what stretches the mesh where no unit says how it is scaled."""
    factors = geometry.scale or (Fraction(1),) * 3
    unit = unit_of(factors[0]) if len(set(factors)) == 1 else None
    return {"unit": "m", "stretch": list(factors)} if unit is None else {"unit": unit.name}


def _scale(parts: Sequence[dict[str, Any]], mass: float) -> None:
    """Have parts weigh so much together (kg), in proportion to what they do."""
    weights, bounds = zip(*map(_weight, parts), strict=True)
    # Of one part the share is all; of several each is off by what its own weight and the sum of them are.
    loose = _WIDER * (2 * max(bounds) / (1 - max(bounds)) + _HALF_BIT) if len(parts) > 1 else 0.0
    for part, weight, bound in zip(parts, weights, bounds, strict=True):
        part.pop("density", None)
        part["mass"] = float(Fraction(mass) * weight / sum(weights))
        if "inertia" in part:
            factor = Fraction(part["mass"]) / weight
            part["inertia"] = [[float(Fraction(k) * factor) for k in row] for row in part["inertia"]]
        own = part.pop("bound", {})
        if own or loose:
            own |= {"mass": loose}
        if "inertia" in part:
            own["inertia"] = _WIDER * (own.get("inertia", 0.0) + bound + loose + _HALF_BIT)
        if own:
            part["bound"] = own


def _weight(part: Mapping[str, Any]) -> tuple[Fraction, float]:
    """Return what a part weighs, kg, and how far that may be off, relative."""
    if "mass" in part:
        return Fraction(part["mass"]), part.get("bound", {}).get("mass", 0.0)
    volume, bound = _volume(part)
    return Fraction(part["density"]) * volume, bound


def _volume(part: Mapping[str, Any]) -> tuple[Fraction, float]:
    """Return what the shape or the mesh of a part encloses, m³, and how far that may be off, relative."""
    if "shape" in part:
        return Fraction(Primitive(part["shape"], tuple(part["size"])).volume), _CLOSED_FORM
    with sound_solids_only("masses are shared out among sound solids only"):
        properties = analyse(read(part["file"], part["unit"]), 1.0).properties
    stretch = abs(math.prod(part.get("stretch", (Fraction(1),))))
    return stretch * Fraction(properties.volume), properties.error.volume


def _of_shell(geometry: Geometry, shape: Primitive) -> dict[str, Any]:
    """Return mass and tensor of the surface of a primitive."""
    area, moments = shell(shape)
    mass = area * (geometry.density or 0.0) if geometry.mass is None else geometry.mass
    bound = {"mass": _CLOSED_FORM if geometry.mass is None else 0.0, "inertia": 8 * _CLOSED_FORM}
    return {
        "mass": mass,
        "center_of_mass": [0.0] * 3,
        "inertia": np.diag(mass * moments).tolist(),
        "bound": bound | {"method": "closed form"},
    }


def _counted(geometry: Geometry, mesh: Path | Part, name: str, notes: list[str]) -> dict[str, Any]:
    """Return what MuJoCo counts of a mesh, and note what that is beside what it encloses; nothing where they agree."""
    counted = legacy(_corners(geometry, mesh))
    if counted is None:
        return {}
    density, mass = geometry.density or 0.0, geometry.mass
    factor, unit = (density, "kg") if mass is None else (1.0, "m³")
    notes.append(
        f"{name}: its mesh is not convex, and MuJoCo's legacy inertia counts {factor * counted.volume:.4g} {unit} "
        f"where it encloses {factor * counted.encloses:.4g} {unit}, about a centre of mass that is "
        f'{1e3 * counted.away:.3g} mm off: write inertia="exact" in its <mesh> for what it encloses'
    )
    weight, error = density * counted.volume if mass is None else mass, counted.error
    if not error.mass < 1:
        raise GeometryError(f"{name}: it is so thin that nothing is certain of what MuJoCo's legacy inertia counts")
    return {
        "mass": weight,
        "center_of_mass": counted.center.tolist(),
        "inertia": (counted.inertia * (weight / counted.volume)).tolist(),
        "bound": {
            "mass": error.mass if mass is None else 0.0,
            "center_of_mass": error.center_of_mass,
            "inertia": error.inertia + error.mass,
            "method": error.method,
        },
    }


def _figures(properties: MassProperties) -> dict[str, Any]:
    """Return mass, centre of mass and tensor of a part, and their bound."""
    return {
        "mass": properties.mass,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
        "bound": _bound_of(properties.error),
    }


def _bound_of(error: ErrorBound) -> dict[str, Any]:
    return {
        "mass": error.mass,
        "center_of_mass": error.center_of_mass and max(error.center_of_mass, _LEAST),
        "inertia": error.inertia,
        "method": error.method,
    }


def _corners(geometry: Geometry, mesh: Path | Part) -> Float:
    """Return the triangles (m, 3, 3) m of a mesh in its own axes, scaled."""
    surface = (mesh if isinstance(mesh, Part) else read(mesh, "m")).triangles
    scale = [float(k) for k in geometry.scale or (1, 1, 1)]
    corners = surface.corners() * scale
    return corners[:, ::-1] if math.prod(scale) < 0 else corners


def _centred(geometry: Geometry) -> Placement:
    """Return where the axes of a part lie in those of the link: a cone's are at its centre of mass, h/4 below half."""
    place, shape = geometry.placement, geometry.shape
    if not isinstance(shape, Primitive) or shape.kind != "cone":
        return place
    return place.then(Placement(origin=np.array([0.0, 0.0, -shape.sizes[1] / 4])))


def _placed(place: Placement) -> dict[str, Any]:
    placed: dict[str, Any] = {}
    if place.origin.any():
        placed["at"] = place.origin.tolist()
    if not np.array_equal(place.rotation, np.eye(3)):
        placed["matrix"] = place.rotation.tolist()
    return placed


def _moved(joint: Joint, position: float) -> Placement:
    way = position - joint.rest
    if joint.kind not in ("turns", "slides") or way == 0:
        return Placement()
    along = joint.axis / math.hypot(*joint.axis.tolist())
    if joint.kind == "slides":
        return Placement(np.eye(3), way * along)
    rotation = rotation_of_quaternion([np.cos(way / 2), *(np.sin(way / 2) * along)])
    return Placement(rotation, joint.point - rotation @ joint.point)
