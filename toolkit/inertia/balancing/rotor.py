"""`Rotor`: bodies on a shaft, how fast it runs, what is permissible, and where and how it may be corrected.

A rotor comes from a TOML file, from its text, or from a dictionary of the same layout, which `rotor_fields` describes.
Every field is checked, unknown ones are refused, and an error names the field by its path. Angles and signs are those
of `inertia.balancing.unbalance`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal

from inertia.assembly.document import Assembly
from inertia.balancing import tolerance as tolerances
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.correction_fields import EvenAngles, PlaneFields
from inertia.balancing.corrections.correction_plane import CorrectionPlane, KitWeight, Sector, evenly
from inertia.balancing.monte_carlo_terms import ShopTolerance, Spread
from inertia.balancing.rotor_fields import BodyFields, HalfWidths, MountFields, Radii, RotorFields
from inertia.balancing.shop_units import angular_speed
from inertia.balancing.standards import STANDARDS, Request
from inertia.balancing.tolerance import Planes, Tolerance
from inertia.balancing.unbalance import PointMass, Unbalance
from inertia.documents import Document, FieldError, document_schema, plain, section_of, table_of
from inertia.errors import FieldPath, UsageError
from inertia.records import dataclass
from inertia.units import Unit, length_unit

KeyConvention = Literal["H", "F", "N"]

_SAME = 1e-9  # of the bearings' distance: planes no farther apart than this coincide
_PLAIN_NUMBERS = {  # fields of a plane, what `CorrectionPlane` calls them, and whether they are lengths
    "max_depth": ("max_depth", True),
    "depth_step": ("depth_step", True),
    "web": ("web", True),
    "wall": ("min_wall", True),
    "width": ("width", True),
    "cutter": ("cutter", True),
    "pass_depth": ("pass_depth", True),
    "min_depth": ("min_depth", True),
    "face": ("face", False),
}


@dataclass(frozen=True, eq=False)
class Rotor(Document):
    """A rotor as its file describes it.

    Attributes
    ----------
    fields : what the file says, in its own unit
    folder : where the bodies' files are
    text : the file as it was read; None without one
    name : the file's path, or "the rotor"
    tree : the assembly, where the file is one itself

    Raises `UsageError` naming the field.

    >>> rotor = Rotor.from_dict({
    ...     "body": [{"file": "fan.stl", "material": "steel"}],
    ...     "axis": {"bearing_a": [0, 0, 20], "bearing_b": [0, 0, 280]},
    ...     "service": {"rpm": 3000},
    ...     "tolerance": {"grade": 6.3},
    ... })
    >>> rotor.shaft.span, round(rotor.speed, 6)
    (0.26, 314.159265)
    """

    noun: ClassVar[str] = "rotor"

    fields: RotorFields
    folder: Path = Path()
    text: str | None = None
    name: str = "the rotor"
    tree: Assembly | None = None

    def __post_init__(self) -> None:
        self._require_sense()

    @classmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> Rotor:
        if "run" in table and "body" not in table:
            raise FieldError("run", "is that of a job of readings, not of a rotor: it is for `measure`")
        if "part" in table:
            return cls._of_assembly(table, folder, text, name)
        return cls(section_of(RotorFields, table), folder, text, name)

    @classmethod
    def _of_assembly(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> Rotor:
        """Return the rotor that an assembly file with a table [rotor] describes."""
        if table.get("rotor") is None:
            raise FieldError(
                "rotor",
                "is missing: give its axis, service and tolerance there, or name this file as the assembly of a rotor",
            )
        fields = {"unit": table.get("unit", "mm"), **table_of(table["rotor"], "rotor"), "assembly": Path(name).name}
        tree = Assembly.from_dict(table, folder, text=text, name=name)
        try:
            return cls(section_of(RotorFields, fields), folder, text, name, tree)
        except FieldError as error:
            raise FieldError(f"rotor.{error.path}", *error.words[2:]) from None

    def to_dict(self) -> dict[str, Any]:
        """Return the rotor as a dictionary laid out as the file is; what is at its default is left out."""
        return {"schema": self.fields.schema, "unit": self.fields.unit, **plain(self.fields)}

    @property
    def unit(self) -> Unit:
        """The unit of all lengths in the file."""
        return length_unit(self.fields.unit)

    @cached_property
    def assembly(self) -> Assembly | None:
        """The assembly whose parts turn together; None where the file lists bodies.

        Raises `ReadError` and `UsageError` of its file.
        """
        if self.fields.assembly is None or self.tree is not None:
            return self.tree
        return Assembly.load(self.folder / self.fields.assembly)

    @cached_property
    def shaft(self) -> Shaft | None:
        """The shaft; None where the file asks for candidates."""
        axis = self.fields.axis
        if axis.bearing_a is None or axis.bearing_b is None:
            return None
        return self.shaft_between(self._metres * axis.bearing_a, self._metres * axis.bearing_b)

    def shaft_between(self, bearing_a: Any, bearing_b: Any) -> Shaft:
        """Return the shaft between two bearing centres (3,) m, with the zero mark and rotation of the file."""
        axis = self.fields.axis
        return Shaft(bearing_a, bearing_b, axis.zero_mark, axis.rotation, path="axis")

    def planned_in(self, seconds: float) -> Rotor:
        """Return the same rotor with another time for the plan of its corrections, s."""
        return replace(self, fields=replace(self.fields, plan=replace(self.fields.plan, time=seconds)))

    @property
    def speed(self) -> float:
        """Highest speed in service, rad/s."""
        return angular_speed(self.fields.service.rpm)

    @property
    def acceleration(self) -> float:
        """Angular acceleration while running up, rad/s², in the sense of rotation."""
        return angular_speed(self.fields.service.run_up or 0.0)

    @property
    def radial_uncertainty(self) -> float:
        """How far each bearing centre may be off, m."""
        return self._metres * self.fields.axis.radial_uncertainty

    @property
    def key_masses(self) -> tuple[PointMass, ...]:
        """What stands for the keys."""
        masses: list[PointMass] = []
        for key in self.fields.key:
            width, height, length, floor, z = (
                self._metres * x for x in (key.width, key.height, key.length, key.floor, key.z)
            )
            solid = Key(width, height, length, floor, math.radians(key.angle), z, key.density, key.keyway)
            masses += solid.point_masses(key.convention)
        return tuple(masses)

    @property
    def shop(self) -> ShopTolerance:
        """What the shop holds."""
        fields, scales = self.fields.uncertainty, {"angle": math.radians(1.0), "arc": math.radians(1.0), "mass": 1.0}
        spreads = {}
        for name in ("depth", "diameter", "radius", "z", "angle", "arc", "mass"):
            if (value := getattr(fields, name)) is None:
                continue
            if not isinstance(value, HalfWidths):
                value = HalfWidths(separate=value) if name == "mass" else HalfWidths(common=value)
            scale = scales.get(name, self._metres)
            spreads[name] = Spread(scale * value.common, scale * value.separate)
        return ShopTolerance(**spreads)

    def mounting(self, fields: BodyFields | MountFields) -> dict[str, Spread]:
        """Return how far a part may be off as mounted: its eccentricity, m, and its tilt, rad; both are radii."""
        spreads = {}
        for name, scale in (("eccentricity", self._metres), ("tilt", math.radians(1.0))):
            value = getattr(fields, name) or Radii()
            value = value if isinstance(value, Radii) else Radii(separate=value)
            spreads[name] = Spread(scale * value.common, scale * value.separate, value.distribution == "rayleigh")
        return spreads

    def indexing(self, fields: BodyFields | MountFields) -> tuple[Fraction, ...]:
        """Return the angles, degrees, by which a part may be turned about the shaft; 0 alone where nothing is said."""
        angles = fields.indexing
        if isinstance(angles, EvenAngles):
            return tuple(Fraction(angles.offset) + Fraction(360 * k, angles.count) for k in range(angles.count))
        return (Fraction(0),) if angles is None else tuple(map(Fraction, angles))

    def tolerance(self, rotor: Unbalance, planes: Planes) -> Tolerance:
        """Return what is permissible in the tolerance planes (A, B) m, for a rotor of this mass and centre of mass."""
        fields, rpm = self.fields.tolerance, self.fields.service.rpm
        if fields.bearing_force is not None:
            a, b = fields.bearing_force.tolist()
            return tolerances.bearing_force_limits((a, b), self.speed)
        if fields.e_um is not None:
            return tolerances.specific_unbalance(1e-6 * fields.e_um, rotor, planes, fields.overhung)
        standard = STANDARDS[fields.standard or "ISO 21940-11"]
        request = Request(rotor, planes, rpm, fields.grade, fields.category, fields.overhung)
        return standard.limits(request, fields.revision)

    def correction_plane(self, number: int, radius: float) -> CorrectionPlane:
        """Return correction plane `number`, which has a method.

        Parameters
        ----------
        number : its place in the file, from 0
        radius : m, where the file gives none
        """
        plane, metres = self.fields.plane[number], self._metres
        assert plane.method is not None, "only planes with a method are worked in"
        options: dict[str, Any] = {}
        for name, (argument, is_length) in _PLAIN_NUMBERS.items():
            if (value := getattr(plane, name)) is not None:
                options[argument] = metres * value if is_length else value
        if plane.point_angle is not None:
            options["point_angle"] = math.radians(plane.point_angle)
        for name in ("angle_step", "arc_step", "max_arc"):
            if (degrees := getattr(plane, name)) is not None:
                options[name] = math.radians(degrees)
        if isinstance(plane.face_z, float | int):
            options["face_z"] = metres * plane.face_z
        if plane.mass_step_g is not None:
            options["mass_step"] = 1e-3 * plane.mass_step_g
        if plane.max_mass_g is not None:
            options["max_mass"] = 1e-3 * plane.max_mass_g
        kit = (
            KitWeight(
                k.name or f"{k.mass_g:g} g",
                1e-3 * k.mass_g,
                k.stock,
                None if k.radius is None else metres * k.radius,
                None if k.width is None else metres * k.width,
            )
            for k in plane.kit
        )
        try:
            return CorrectionPlane(
                id=plane.id,
                z=metres * plane.z,
                method=plane.method,
                radius=radius if plane.radius is None else metres * plane.radius,
                diameters=tuple(metres * k for k in plane.diameters or ()),
                angles=_angles(plane),
                forbidden=tuple(Sector(*map(math.radians, k.tolist())) for k in plane.forbidden or ()),
                through=plane.through,
                kit=tuple(kit),
                most_per_position=plane.most_per_position,
                **options,
            )
        except UsageError as error:
            raise UsageError(*error.words, places=(FieldPath(f"plane[{number}]"),), code=error.code) from None

    @property
    def _metres(self) -> float:
        return float(self.unit.metres)

    def _require_sense(self) -> None:
        """Raise `UsageError` where fields contradict each other, as far as the bodies need not be read for it."""
        fields = self.fields
        for k, body in enumerate(fields.body):
            if not body.weights and (len(fields.body) > 1 or fields.tolerance.bearing_force is not None):
                raise FieldError(f"body[{k}]", "says nothing of how heavy it is: give its density, material or mass")
        if (shaft := self.shaft) is not None:
            self._require_planes_apart(shaft)
        for k, plane in enumerate(fields.plane):
            if plane.radius is not None and plane.method is not None:
                self.correction_plane(k, math.nan)
            if plane.radius is None and plane.method == "drill_axial":
                raise FieldError(f"plane[{k}].radius", "is missing: say how far from the shaft axial holes are drilled")

    def _require_planes_apart(self, shaft: Shaft) -> None:
        planes = self.fields.plane
        for k, plane in enumerate(planes):
            for j, other in enumerate(planes[:k]):
                if plane.id == other.id:
                    raise FieldError(f"plane[{k}].id", f"is {plane.id!r}, as that of plane[{j}]: give it its own")
                if self._metres * abs(plane.z - other.z) <= _SAME * shaft.span:
                    raise FieldError(
                        f"plane[{k}].z",
                        f"is {plane.z:g}, where plane {other.id!r} is too: a couple takes planes that lie apart, move "
                        "one",
                    )


@dataclass(frozen=True)
class Key:
    """A straight key of rectangular section in a keyway, after the key convention (ISO 21940-32).

    A shaft is balanced with half a key in its keyway (H) and the fitment with the other half, unless the parts are
    marked F: then the shaft takes the full key. N is no key at all.

    Attributes
    ----------
    width, height, length : m; the height along the radius, the length along the shaft
    floor : m, distance of the keyway's floor from the axis
    angle : rad from 0°
    z : m, middle of the key along the shaft
    density : kg/m³
    keyway : "shaft", from whose floor the key goes outwards, or "hub" of a fitment, inwards

    >>> key = Key(0.008, 0.007, 0.04, floor=0.011, angle=0.0, z=0.1, density=7850.0)
    >>> half, full = key.point_masses("H")[0], key.point_masses("F")[0]
    >>> round(full.mass / half.mass, 12), round(half.radius, 6), round(full.radius, 6)
    (2.0, 0.01275, 0.0145)
    """

    width: float
    height: float
    length: float
    floor: float
    angle: float
    z: float
    density: float
    keyway: Literal["shaft", "hub"] = "shaft"

    def __post_init__(self) -> None:
        for name in ("width", "height", "length", "floor", "density"):
            if not 0 < (value := getattr(self, name)) < math.inf:
                raise UsageError(f"the {name} of the key is {value!r}: it must be positive and finite")

    def point_masses(self, convention: KeyConvention) -> tuple[PointMass, ...]:
        """Return what stands for the key: half its height from the floor on, all of it, or nothing."""
        if convention not in ("H", "F", "N"):
            raise UsageError(f"the key convention is {convention!r}: use 'H' (half key), 'F' (full key) or 'N' (none)")
        if convention == "N":
            return ()
        height = self.height if convention == "F" else 0.5 * self.height
        mass = self.density * self.width * height * self.length
        outwards = -0.5 if self.keyway == "hub" else 0.5
        return (PointMass(mass, self.floor + outwards * height, self.angle, self.z),)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a rotor file."""
    return document_schema(RotorFields, "Rotor file of inertia balance")


def _angles(plane: PlaneFields) -> Any:
    if isinstance(plane.angles, EvenAngles):
        return evenly(plane.angles.count, math.radians(plane.angles.offset))
    if isinstance(plane.angles, tuple):
        return tuple(math.radians(angle) % (2.0 * math.pi) for angle in plane.angles)
    return plane.angles
