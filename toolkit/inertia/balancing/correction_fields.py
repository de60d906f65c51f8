"""Sections of a rotor file about correction planes and keys, as the file has them; see `rotor_fields`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import PROCESSES, Process
from inertia.documents import (
    FieldError,
    Reader,
    Section,
    choice,
    flag,
    integer,
    number,
    numbers,
    section_of,
    several,
    table,
    tables,
    text,
)
from inertia.records import dataclass

_LENGTH = "the file's unit"
_MANY = 1_000_000
_FLAT = 180.0


@dataclass(frozen=True, eq=False)
class KeyFields(Section):
    """One of ``[[key]]``: a straight key that is not in the mesh.

    Attributes
    ----------
    convention : "H" half a key counts, "F" the full key, "N" none (ISO 21940-32)
    width, height, length : the height along the radius, the length along the shaft
    floor : distance of the keyway's floor from the axis
    keyway : "shaft", from whose floor the key goes outwards, or "hub" of a fitment, inwards
    angle : degrees from 0°
    z : middle of the key along the shaft
    density : kg/m³
    """

    section: ClassVar[str] = "key"

    convention: Annotated[Literal["H", "F", "N"], choice("H", "F", "N")]
    width: Annotated[float, number(_LENGTH, positive=True)]
    height: Annotated[float, number(_LENGTH, positive=True)]
    length: Annotated[float, number(_LENGTH, positive=True)]
    floor: Annotated[float, number(_LENGTH, positive=True)]
    z: Annotated[float, number(_LENGTH)]
    keyway: Annotated[Literal["shaft", "hub"], choice("shaft", "hub")] = "shaft"
    angle: Annotated[float, number("degrees")] = 0.0
    density: Annotated[float, number("kg/m³", positive=True)] = 7850.0


@dataclass(frozen=True, eq=False)
class EvenAngles(Section):
    """Angles evenly around the shaft.

    Attributes
    ----------
    count : how many
    offset : degrees, the first
    """

    section: ClassVar[str] = "angles"

    count: Annotated[int, integer(1, 1000)]
    offset: Annotated[float, number("degrees")] = 0.0


def _angles(value: Any, path: str) -> str | tuple[float, ...] | EvenAngles:
    if isinstance(value, EvenAngles):
        return value
    if value == "free":
        return "free"
    if isinstance(value, Mapping):
        return section_of(EvenAngles, value, path=path)
    if isinstance(value, str):
        raise FieldError(path, f"is {value!r}: use 'free', {{count = 7, offset = 0}} or a list of degrees")
    listed: tuple[float, ...] = _DEGREES(value, path)
    return listed


_DEGREES = several(number("degrees"))


def _listed(value: Any, path: str) -> tuple[float, ...] | EvenAngles:
    if isinstance(value, EvenAngles):
        return value
    if isinstance(value, Mapping):
        return section_of(EvenAngles, value, path=path)
    angles: tuple[float, ...] = _DEGREES(value, path)
    return angles


listed_angles = Reader(_listed, {"oneOf": [table(EvenAngles).schema, _DEGREES.schema]})
"""Read angles evenly around the shaft, or a list of degrees."""

_ANGLES = Reader(_angles, {"oneOf": [{"const": "free"}, table(EvenAngles).schema, _DEGREES.schema]})


def _place(value: Any, path: str) -> float | str:
    if value == "find":
        return "find"
    if isinstance(value, str):
        raise FieldError(path, f"is {value!r}: use 'find', or a place along the shaft")
    z: float = _Z(value, path)
    return z


_Z = number(_LENGTH)
_PLACE = Reader(_place, {"oneOf": [{"const": "find"}, _Z.schema]})


@dataclass(frozen=True, eq=False)
class WeightFields(Section):
    """One weight of a kit.

    Attributes
    ----------
    mass_g : grams
    name : what the shop calls it
    stock : how many there are; plenty without it
    radius : of its centre of mass; the plane's without it
    width : what it takes of the track around the shaft, needed where angles are free
    """

    section: ClassVar[str] = "kit"

    mass_g: Annotated[float, number("g", positive=True)]
    name: Annotated[str | None, text] = None
    stock: Annotated[int | None, integer(1, _MANY)] = None
    radius: Annotated[float | None, number(_LENGTH, positive=True)] = None
    width: Annotated[float | None, number(_LENGTH, positive=True)] = None


@dataclass(frozen=True, eq=False)
class PlaneFields(Section):
    """One of ``[[plane]]``: a correction plane.

    Attributes
    ----------
    id : its name
    z : place along the shaft: the tools' axes, the middle of a flat or an arc, the weights; for axial holes the face
        they enter
    method : how it is corrected; without one the unbalance is resolved there, and nothing is done to the rotor
    radius : of the surface that radial drills, flats and arcs start from, of the axes of axial holes, of masses and
        weights; the outer radius of the bodies at z without it
    diameters : of the drills at hand
    point_angle : degrees between the lips of a drill; 180 is flat
    max_depth : of a hole to its shoulder, a flat, or an arc, for which it is needed; what the wall allows without it
    depth_step, angle_step : what the shop can set; the angle in degrees
    angles : "free", {count, offset}, or a list of degrees
    forbidden : sectors [from, to] in degrees that no tool may come into
    web : least material between two holes
    wall : least material left under a hole
    face : of axial holes: "a" where they enter the face to bearing A, "b" to bearing B
    face_z : where along the shaft that face is, where it is not at z, as of a web; "find" for the nearest to z
    through : axial holes go through, as far as the part is thick; max_depth is the most that it may be
    width : of a flat or an arc, along the shaft
    min_depth : of an arc
    max_arc, arc_step : degrees, the longest arc, 120 without it, and what the shop can set
    cutter : diameter of the cutter or wheel that makes arcs, which leaves their ends round; square without it
    pass_depth : that an arc is taken in at once
    max_mass_g, mass_step_g : grams at one place, and what the shop can weigh, of masses added or removed
    kit : the weights at hand
    most_per_position : weights at one position
    """

    section: ClassVar[str] = "plane"

    id: Annotated[str, text]
    z: Annotated[float, number(_LENGTH)]
    method: Annotated[Process | None, choice(*PROCESSES)] = None
    radius: Annotated[float | None, number(_LENGTH, positive=True)] = None
    diameters: Annotated[tuple[float, ...] | None, several(number(_LENGTH, positive=True))] = None
    point_angle: Annotated[float | None, number("degrees", positive=True)] = None
    max_depth: Annotated[float | None, number(_LENGTH, positive=True)] = None
    depth_step: Annotated[float | None, number(_LENGTH, negative=False)] = None
    angle_step: Annotated[float | None, number("degrees", negative=False)] = None
    angles: Annotated[Literal["free"] | tuple[float, ...] | EvenAngles, _ANGLES] = "free"
    forbidden: Annotated[tuple[Float, ...] | None, several(numbers((2,), "degrees"))] = None
    web: Annotated[float | None, number(_LENGTH, negative=False)] = None
    wall: Annotated[float | None, number(_LENGTH, negative=False)] = None
    face: Annotated[Literal["a", "b"] | None, choice("a", "b")] = None
    face_z: Annotated[float | Literal["find"] | None, _PLACE] = None
    through: Annotated[bool, flag] = False
    width: Annotated[float | None, number(_LENGTH, positive=True)] = None
    min_depth: Annotated[float | None, number(_LENGTH, negative=False)] = None
    max_arc: Annotated[float | None, number("degrees", positive=True)] = None
    arc_step: Annotated[float | None, number("degrees", negative=False)] = None
    cutter: Annotated[float | None, number(_LENGTH, positive=True)] = None
    pass_depth: Annotated[float | None, number(_LENGTH, positive=True)] = None
    max_mass_g: Annotated[float | None, number("g", positive=True)] = None
    mass_step_g: Annotated[float | None, number("g", negative=False)] = None
    kit: Annotated[tuple[WeightFields, ...], tables(WeightFields)] = ()
    most_per_position: Annotated[int, integer(1, _MANY)] = 1

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where an angle or a sector is none."""
        if self.point_angle is not None and self.point_angle > _FLAT:
            raise FieldError(f"{path}.point_angle", f"is {self.point_angle:g}: it must be {_FLAT:g}, flat, or less")
        for k, (start, stop) in enumerate(self.forbidden or ()):
            if (stop - start) % 360.0 == 0:
                whole = stop != start
                raise FieldError(
                    f"{path}.forbidden[{k}]",
                    f"is [{start:g}, {stop:g}], the whole turn: leave out the plane's method, or give a smaller sector"
                    if whole
                    else f"ends where it begins, at {start:g}: give another angle as its end",
                )
