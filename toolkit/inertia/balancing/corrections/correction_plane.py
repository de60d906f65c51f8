"""`CorrectionPlane`: where on the shaft a rotor may be corrected, how, and what forbids it.

Angles, signs and the shaft's frame are those of `inertia.balancing.unbalance`; lengths are in m, angles in rad.
"""

from __future__ import annotations

import cmath
import math
from typing import Literal

from inertia.errors import UsageError
from inertia.records import dataclass

Process = Literal["add", "remove", "drill_radial", "drill_axial", "mill", "mill_arc", "kit"]
PROCESSES: tuple[Process, ...] = ("add", "remove", "drill_radial", "drill_axial", "mill", "mill_arc", "kit")
CUTTING: tuple[Process, ...] = ("drill_radial", "drill_axial", "mill", "mill_arc")
"""Those that take the mesh's own metal."""

FULL_TURN = 2 * math.pi
_DRILL = math.radians(118)
_ANGLE_STEP = math.radians(0.5)
_DEPTH_STEP = 1e-4
_ARC_STEP = math.radians(1.0)
_LONGEST = math.radians(120.0)
_NEARLY = 1e-9  # rad


@dataclass(frozen=True)
class Sector:
    """Angles from `start` counter-clockwise to `stop`, rad; it may run through 0."""

    start: float
    stop: float

    @property
    def width(self) -> float:
        """Its angle, rad."""
        return (self.stop - self.start) % FULL_TURN

    def distance(self, angle: float) -> float:
        """Return how far an angle (rad) is from the sector; −1 inside it.

        >>> Sector(6.0, 0.5).distance(0.1), Sector(6.0, 0.5).distance(1.0)
        (-1.0, 0.5)
        """
        from_start = (angle - self.start) % FULL_TURN
        if _NEARLY < from_start < self.width - _NEARLY:
            return -1.0
        return max(min(FULL_TURN - from_start, from_start - self.width), 0.0)

    def meets(self, angle: float, margin: float = 0.0) -> bool:
        """Say whether a tool that reaches `margin` to both sides of `angle` (rad) comes into the sector.

        >>> Sector(6.0, 0.5).meets(0.1), Sector(6.0, 0.5).meets(1.0), Sector(6.0, 0.5).meets(1.0, 0.6)
        (True, False, True)
        """
        from_start = (angle - self.start + margin) % FULL_TURN
        return _NEARLY < from_start < self.width + 2 * margin - _NEARLY


@dataclass(frozen=True)
class KitWeight:
    """A weight of a kit: a screw, a washer, a clip on a track, a segment.

    Attributes
    ----------
    name : what the shop calls it
    mass : kg
    stock : how many there are; None for plenty
    radius : m, of its centre of mass, where that is not the plane's, as of set-screws of other lengths
    width : m, what it takes of the track around the shaft; needed at free angles
    """

    name: str
    mass: float
    stock: int | None = None
    radius: float | None = None
    width: float | None = None

    @property
    def most(self) -> float:
        """How many there are."""
        return math.inf if self.stock is None else self.stock


@dataclass(frozen=True)
class CorrectionPlane:
    """A place along the shaft where the rotor is corrected.

    Attributes
    ----------
    id : its name
    z : m along the shaft: the tools' axes, the middle of a flat or an arc, the weights; for axial holes the face
        they enter
    method : "add" or "remove" (point masses), "drill_radial", "drill_axial", "mill" (flats), "mill_arc" (arcs of
        the rim) or "kit" (weights)
    radius : m, of the surface that radial drills, flats and arcs start from; of the axes of axial holes; of added
        masses
    diameters : m, of the drills at hand
    point_angle : rad, of the drills; π is flat
    max_depth : m, to the shoulder of a drill, or of a flat or an arc, for which it is needed; None for what the wall
        allows, but towards the shaft half of the radius at most
    depth_step, angle_step : m and rad, what the shop can hold; 0 for no rounding
    angles : "free", or the angles (rad) at which corrections may sit
    forbidden : sectors that no tool may come into
    web : m, least material between two holes side by side
    min_wall : m, least material left under a tool, and beside a hole
    face : of axial holes: "a" if the face looks to bearing A (the drill goes towards B), else "b"
    face_z : m along the shaft, of the face that axial holes enter, where it is another than z
    through : axial holes go through, as far as the part is thick; `max_depth` is the most that it may be
    width : m along the shaft, of a flat or an arc
    min_depth : m, of an arc
    max_arc, arc_step : rad, the longest arc, and what the shop can set; 180° takes most
    cutter : m, diameter of the cutter or wheel that makes arcs, its axis parallel to the shaft, which leaves their ends
        round; None for square ends
    pass_depth : m, that an arc is taken in at once; None for all of it
    max_mass : kg at one place, of added or removed masses
    mass_step : kg, what the shop can weigh
    kit : the weights at hand
    most_per_position : weights at one position

    Raises `UsageError` where something is missing or cannot be.
    """

    id: str
    z: float
    method: Process
    radius: float
    diameters: tuple[float, ...] = ()
    point_angle: float = _DRILL
    max_depth: float | None = None
    depth_step: float = _DEPTH_STEP
    angle_step: float = _ANGLE_STEP
    angles: Literal["free"] | tuple[float, ...] = "free"
    forbidden: tuple[Sector, ...] = ()
    web: float = 0.001
    min_wall: float = 0.001
    face: Literal["a", "b"] | None = None
    face_z: float | None = None
    through: bool = False
    width: float | None = None
    min_depth: float = 0.0
    max_arc: float = _LONGEST
    arc_step: float = _ARC_STEP
    cutter: float | None = None
    pass_depth: float | None = None
    max_mass: float | None = None
    mass_step: float = 0.0
    kit: tuple[KitWeight, ...] = ()
    most_per_position: int = 1

    def __post_init__(self) -> None:
        if self.method not in PROCESSES:
            raise self._fault(f"method is {self.method!r}", f"use one of {', '.join(PROCESSES)}")
        for name in ("z", "face_z"):
            if (place := getattr(self, name)) is not None and not math.isfinite(place):
                raise self._fault(f"{name} is {place!r} m", "give a finite place along the shaft")
        if self.face_z is not None and self.method != "drill_axial":
            raise self._fault("face_z is given", "only axial holes enter a face")
        for name in ("radius", "max_depth", "width", "max_arc", "cutter", "pass_depth", "max_mass"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise self._fault(f"{name} is {value!r}", "it must be positive and finite")
        for name in ("depth_step", "angle_step", "arc_step", "min_depth", "mass_step", "web", "min_wall"):
            if not 0 <= getattr(self, name) < math.inf:
                raise self._fault(f"{name} is {getattr(self, name)!r}", "it must be finite and not negative")
        if self.method.startswith("drill"):
            self._check_drills()
        if self.method in ("mill", "mill_arc"):
            self._check_cutter()
        if self.method == "kit":
            self._check_kit()
        if self.angles != "free" and not self.angles:
            raise self._fault("angles is empty", "give angles, or 'free'")
        if self.angles != "free" and all(self.forbids(angle) for angle in self.angles):
            raise self._fault("every one of its angles lies in a forbidden sector", "allow one of them")

    def _check_drills(self) -> None:
        if not self.diameters:
            raise self._fault("no drill is given", "give their diameters")
        if not 0 < self.point_angle <= math.pi:
            raise self._fault(f"point_angle is {self.point_angle!r} rad", "it must be above 0 and at most pi")
        for diameter in self.diameters:
            if not 0 < diameter < math.inf:
                raise self._fault(f"diameters names {diameter!r} m", "a diameter must be positive and finite")
            if diameter > 2 * self.radius:
                raise self._fault(
                    f"a drill of {1e3 * diameter:g} mm is wider than the part of radius {1e3 * self.radius:g} mm",
                    "take it out of diameters",
                )
            reach = (self.max_depth or 0.0) + point_length(diameter, self.point_angle)
            if self.method == "drill_radial" and reach >= self.radius:
                raise self._fault(
                    f"a drill of {1e3 * diameter:g} mm reaches {1e3 * reach:.4g} mm deep with its point, past the "
                    f"shaft's axis at {1e3 * self.radius:g} mm",
                    "give a smaller max_depth or drill",
                )
        if self.method == "drill_axial" and self.face not in ("a", "b"):
            raise self._fault(f"face is {self.face!r}", "say whether axial holes enter the face to bearing 'a' or 'b'")
        if self.through and self.method != "drill_axial":
            raise self._fault("through holes are asked for", "only axial holes can go through")

    def _check_cutter(self) -> None:
        what = "flat" if self.method == "mill" else "arc"
        if self.width is None:
            raise self._fault(f"a milled {what} has no width", "give its width along the shaft")
        if self.max_depth is not None and self.max_depth >= self.radius:
            raise self._fault(f"max_depth {self.max_depth:g} m reaches the shaft's axis", "give less than the radius")
        if what == "flat":
            return
        if self.max_depth is None:
            raise self._fault("a milled arc has no depth", "give the greatest as max_depth")
        if self.min_depth > self.max_depth:
            raise self._fault(
                f"min_depth {1e3 * self.min_depth:g} mm is more than max_depth {1e3 * self.max_depth:g} mm", "give less"
            )
        if self.max_arc > math.pi * (1 + _NEARLY):
            raise self._fault(
                f"max_arc is {math.degrees(self.max_arc):g} degrees", "a longer arc than 180 degrees takes less again"
            )
        sunk = self.max_depth * (2 * self.radius - self.max_depth) / (self.radius - self.max_depth)
        if self.cutter is not None and self.cutter < sunk:
            raise self._fault(
                f"a cutter of {1e3 * self.cutter:g} mm goes in deeper than half of it at a depth of "
                f"{1e3 * self.max_depth:g} mm",
                f"give a smaller max_depth, or a cutter of at least {1e3 * sunk:.4g} mm",
            )

    def _check_kit(self) -> None:
        if not self.kit:
            raise self._fault("its kit is empty", "give the masses of the weights at hand")
        if self.angles == "free" and any(weight.width is None for weight in self.kit):
            raise self._fault(
                "a kit is used at free angles", "give the positions as angles, or the width of each weight on its track"
            )
        for weight in self.kit:
            for length in (weight.radius, weight.width):
                if length is not None and not 0 < length < math.inf:
                    raise self._fault(
                        f"kit weight {weight.name!r} has a radius or width of {length!r} m", "it must be positive"
                    )
            if not 0 < weight.mass < math.inf:
                raise self._fault(f"kit weight {weight.name!r} is {weight.mass!r} kg", "it must be positive")
        if self.most_per_position < 1:
            raise self._fault(f"most_per_position is {self.most_per_position}", "it must be at least 1")

    def _fault(self, measured: str, remedy: str) -> UsageError:
        return UsageError(f"{measured}: {remedy}", places=(f"plane {self.id!r}",))

    @property
    def sign(self) -> int:
        """+1 where mass is added, −1 where it is removed."""
        return 1 if self.method in ("add", "kit") else -1

    @property
    def entry(self) -> float:
        """Where along the shaft its tools begin, m."""
        return self.z if self.face_z is None else self.face_z

    @property
    def cuts(self) -> bool:
        """Whether it is the mesh that is cut."""
        return self.method in CUTTING

    def forbids(self, angle: float, margin: float = 0.0) -> bool:
        """Say whether a tool at `angle` that reaches `margin` to both sides (rad) comes into a forbidden sector."""
        return any(sector.meets(angle, margin) for sector in self.forbidden)

    @property
    def positions(self) -> tuple[float, ...]:
        """The listed angles, rad, that no sector forbids; none where angles are free."""
        if self.angles == "free":
            return ()
        return tuple(angle for angle in self.angles if not self.forbids(angle))


def evenly(count: int, offset: float = 0.0) -> tuple[float, ...]:
    """Return `count` angles evenly around the shaft, the first at `offset`, rad.

    >>> [round(angle, 3) for angle in evenly(4, 0.5)]
    [0.5, 2.071, 3.642, 5.212]
    """
    if count < 1:
        raise UsageError(f"the number of angles around the shaft is {count}: it must be at least 1")
    return tuple((offset + FULL_TURN * k / count) % FULL_TURN for k in range(count))


def angle_of(vector: complex) -> float:
    """Return the angle of a vector across the shaft, 0 to 2π.

    >>> angle_of(-1j) / math.pi
    1.5
    """
    angle = cmath.phase(vector) % FULL_TURN
    return angle if angle < FULL_TURN else 0.0


def point_length(diameter: float, point_angle: float) -> float:
    """Return the height of a drill's point, (d/2)/tan(angle/2), in the diameter's unit.

    >>> round(point_length(16.0, math.radians(118)), 4)
    4.8069
    """
    return 0.5 * diameter / math.tan(0.5 * point_angle)
