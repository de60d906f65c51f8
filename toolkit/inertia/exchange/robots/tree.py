"""The links of a robot at a stated position of its joints, laid out as an assembly file is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from inertia.errors import GeometryError, UsageError, reworded
from inertia.exchange.robots.links import Geometry, Joint, Link, Placement, Primitive, Robot
from inertia.exchange.rotations import rotation_of_quaternion
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.tensor import faults
from inertia.mesh.geometry.hull import convex_hull
from inertia.mesh.part import Part
from inertia.mesh.read import read

_FORMATS = ("urdf", "mjcf", "sdf", "usd")


def robot_tree(robot: Robot, joints: Mapping[str, float] | None = None) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return an assembly laid out as its file is, a part for each link, in metres; and what had to be decided.

    Where nothing is stated of a link and the format has its geometries weigh something (MJCF, SDFormat, USD), each is a
    part too. Of meshes in the robot's file, and of those whose surface or convex hull weighs, that has the mass
    properties.

    Parameters
    ----------
    robot : as read; of a format whose joints are read (URDF, MJCF, SDFormat, USD)
    joints : rad, or m of one that slides, of joints by name; 0 of all others

    Raises `UsageError` for a format without, an unknown joint, and one that does not move; `GeometryError` for a link
    whose stated mass or tensor no body can have, or cannot be read.
    """
    if robot.format not in _FORMATS:
        raise UsageError(f"{robot.path}: the joints of {robot.format} are not read: give URDF, MJCF, SDFormat or USD")
    positions = dict(joints or {})
    known = {link.joint.name: link.joint for link in robot.links if link.joint is not None}
    for name, value in positions.items():
        if name not in known or known[name].kind not in ("turns", "slides"):
            what = "does not turn or slide" if name in known else "is none of the robot's"
            moving = ", ".join(name for name, joint in known.items() if joint.kind in ("turns", "slides"))
            remedy = f"name one of {moving}" if moving else "leave it out, as none of them does"
            raise UsageError(f"joint {name!r} {what}: {remedy}")
        if not np.isfinite(value):
            raise UsageError(f"joint {name!r} is at {value!r}: it must be a finite number of rad or m")
    parts, notes = [], list(robot.notes)
    positions |= {name: _followed(name, known, positions) for name, joint in known.items() if joint.mimic}
    for link in robot.links:
        parts.append(_part(link, positions))
        if link.inertial is None and any(geometry.weighs for geometry in link.geometries):
            parts += _of_geometries(link, notes)
        elif link.inertial is None:
            as_a_rule = ", where programs take 1 kg and 1 kg m² for it" if robot.format == "sdf" else ""
            states = "no mass" if link.mass is None else f"a mass of {link.mass:g} kg, but no shape that has it"
            notes.append(f"link {link.name} states {states}: it is a group{as_a_rule}; give it a file or a mass")
        if link.joint is not None and link.joint.kind == "other":
            notes.append(f"joint {link.joint.name} neither turns nor slides about one axis: it is at its rest")
    if robot.mass is not None:
        _scale([part for part in parts if "mass" in part or "density" in part], robot.mass)
    return {"schema": 1, "name": robot.name or robot.path.stem, "unit": "m", "part": parts}, tuple(notes)


def _followed(name: str, joints: Mapping[str, Joint], positions: Mapping[str, float]) -> float:
    """Return the position of a joint by what it mimics; one whose position is stated follows none."""
    factor, shift = 1.0, 0.0
    path: set[str] = set()
    while name not in positions and name not in path and name in joints and (mimic := joints[name].mimic) is not None:
        path.add(name)
        name, multiplier, offset = mimic
        factor, shift = factor * multiplier, shift + factor * offset
    return factor * positions.get(name, 0.0) + shift


def _part(link: Link, positions: Mapping[str, float]) -> dict[str, Any]:
    if link.fault:
        raise GeometryError(f"{link.fault}: mend it with `audit`, or leave it out")
    if link.inertial is not None and link.inertial.mass < 0:
        raise GeometryError(f"link {link.name}: its mass is {link.inertial.mass:g} kg: it must not be negative")
    part: dict[str, Any] = {"name": link.name}
    if (joint := link.joint) is not None:
        if joint.parent is not None:
            part["parent"] = joint.parent
        place = joint.placement.then(_moved(joint, positions.get(joint.name, joint.rest)))
        part |= _placed(place)
    if (stated := link.inertial) is not None and stated.mass > 0:
        rotation = stated.placement.rotation
        tensor = rotation @ stated.inertia @ rotation.T
        tensor = (tensor + tensor.T) / 2
        if broken := faults(tensor):
            raise GeometryError(f"link {link.name}: {broken[0]}: mend it with `audit`, or leave the tensor out")
        part |= {"mass": stated.mass, "center_of_mass": stated.placement.origin.tolist(), "inertia": tensor.tolist()}
    return part


def _of_geometries(link: Link, notes: list[str]) -> list[dict[str, Any]]:
    """Return parts for the geometries that a link weighs by; what cannot be weighed is noted."""
    parts = []
    for number, geometry in enumerate(link.geometries):
        if not geometry.weighs:
            continue
        name = f"{link.name}/{geometry.name}"
        twice = sum(other.name == geometry.name for other in link.geometries[:number])
        part: dict[str, Any] = {"name": f"{name} {twice + 1}" if twice else name, "parent": link.name}
        weight = {"density": geometry.density} if geometry.mass is None else {"mass": geometry.mass}
        if isinstance(geometry.shape, Part) or (isinstance(geometry.shape, Path) and geometry.filling != "solid"):
            part |= _figures(geometry, geometry.shape, part["name"])
        elif isinstance(geometry.shape, Path):
            part |= {"file": str(geometry.shape.absolute()), "unit": "m"} | weight
            if geometry.scale is not None and set(geometry.scale) != {1}:
                part["stretch"] = [float(k) for k in geometry.scale]
        elif isinstance(geometry.shape, Primitive) and min(geometry.shape.sizes) > 0:
            part |= {"shape": geometry.shape.kind, "size": list(geometry.shape.sizes)} | weight
        else:
            why = geometry.shape if isinstance(geometry.shape, str) else "it encloses nothing"
            notes.append(f"link {link.name}, {geometry.name} is left out: {why}")
            continue
        parts.append(part | _placed(geometry.placement))
    if link.mass is not None:
        _scale(parts, link.mass)
    return parts


def _scale(parts: Sequence[dict[str, Any]], mass: float) -> None:
    """Have parts weigh so much together (kg), in proportion to what they do."""
    weights = [part["mass"] if "mass" in part else part.pop("density") * _volume(part) for part in parts]
    for part, weight in zip(parts, weights, strict=True):
        part["mass"] = mass * (weight / sum(weights))
        if "inertia" in part:
            part["inertia"] = (np.array(part["inertia"]) * (part["mass"] / weight)).tolist()


def _volume(part: Mapping[str, Any]) -> float:
    """Return what the shape or the mesh of a part encloses, m³."""
    if "shape" in part:
        return Primitive(part["shape"], tuple(part["size"])).volume
    with sound_solids_only("masses are shared out among sound solids only"):
        volume = analyse(read(part["file"], part["unit"]), 1.0).properties.volume
    return float(volume * abs(math.prod(part.get("stretch", (1.0,)))))


def _figures(geometry: Geometry, mesh: Path | Part, name: str) -> dict[str, Any]:
    """Return mass, centre of mass and tensor of a mesh, of its surface, or of its convex hull."""
    surface = (mesh if isinstance(mesh, Part) else read(mesh, "m")).triangles
    scale = [float(k) for k in geometry.scale or (1, 1, 1)]
    corners = surface.corners() * scale
    if math.prod(scale) < 0:
        corners = corners[:, ::-1]
    if geometry.filling == "hull":
        hull = convex_hull(corners.reshape(-1, 3))
        if hull is None:
            raise GeometryError(f"{name} is flat: its convex hull encloses nothing")
        corners = hull
    part = Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), unit="m")
    thickness = 1.0 if geometry.filling == "surface" else None
    try:
        with sound_solids_only("a link weighs by sound solids only"):
            properties = analyse(part, geometry.density or 1.0, shell=thickness).properties
    except GeometryError as error:
        raise reworded(error, error.words, (name,)) from None
    if geometry.mass is not None:
        properties = properties.with_mass(geometry.mass)
    return {
        "mass": properties.mass,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
    }


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
    along = joint.axis / np.linalg.norm(joint.axis)
    if joint.kind == "slides":
        return Placement(np.eye(3), way * along)
    rotation = rotation_of_quaternion([np.cos(way / 2), *(np.sin(way / 2) * along)])
    return Placement(rotation, joint.point - rotation @ joint.point)
