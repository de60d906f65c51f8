"""`Robot`, `Link`, `Inertial` and `Geometry`: what a file says of a robot, in SI units and the axes of each link.

Names are as they may be printed (`inertia.errors.visible`).
"""

from __future__ import annotations

import math
from dataclasses import field, replace
from fractions import Fraction
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.errors import visible
from inertia.mass.properties import ErrorBound
from inertia.mesh.part import Part
from inertia.mesh.tree import Matrix, diagonal
from inertia.mesh.tree import Motion as Transform
from inertia.records import dataclass

Role = Literal["visual", "collision"]
Motion = Literal["turns", "slides", "fixed", "other"]
Filling = Literal["solid", "surface", "hull", "legacy"]


COARSE = 0.01
"""Of the trace of a tensor: decimals that leave more open are no figures at all."""


@dataclass(frozen=True, eq=False)
class Placement:
    """Where a frame lies in another: x = `rotation` x' + `origin`, (3, 3) and (3,) m."""

    rotation: Float = field(default_factory=lambda: np.eye(3))
    origin: Float = field(default_factory=lambda: np.zeros(3))

    def then(self, inner: Placement) -> Placement:
        """Return where a frame lies that is placed in this one."""
        return Placement(self.rotation @ inner.rotation, self.rotation @ inner.origin + self.origin)

    @property
    def inverse(self) -> Placement:
        """Where the other frame lies in this one."""
        return Placement(self.rotation.T, -self.rotation.T @ self.origin)


class Figures(NamedTuple):
    """How numbers are written: places after the point, and significant digits, of those of them that have most.

    >>> Figures(4, 4).half_units(np.array([0.3333, 0.08333, 0.0]))
    array([5.e-05, 5.e-05, 5.e-05])
    >>> Figures(5, 4).half_units(np.array([0.3333, 0.08333, 0.0]))
    array([5.e-05, 5.e-06, 5.e-06])
    """

    decimals: int
    digits: int

    def half_units(self, values: Float) -> Float:
        """Return by how much each of some numbers may be off, rounded to so many decimals or to so many digits.

        Which of the two a program does, the numbers do not say: those that end in zeros may be written without these.
        """
        with np.errstate(divide="ignore"):
            leading = np.floor(np.log10(np.abs(values)))  # where the first digit stands; nowhere of zero
        return 0.5 * np.maximum(10.0**-self.decimals, 10.0 ** (leading - self.digits + 1))


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass properties as a file states them.

    Attributes
    ----------
    mass : kg
    placement : of the frame at the centre of mass in which the tensor is written
    inertia : (3, 3) kg m² about the centre of mass along the axes of that frame, tensor signs
    figures : how the centre and the tensor are written; None where that says nothing
    integrals : whether the file's fields of the products are for positive integrals, and not for tensor elements
    error : how far what was completed by shapes may be off; None where all is stated
    """

    mass: float
    placement: Placement
    inertia: Float
    figures: tuple[Figures | None, Figures | None] = (None, None)
    integrals: bool = False
    error: ErrorBound | None = None


def rounding_of(tensor: Float, figures: Figures | None) -> float:
    """Return by how much rounding may have lowered the least eigenvalue of ½ tr(J) δ − J at most, kg m².

    `tensor` is J, (3, 3) along the axes of the file.
    """
    if figures is None:
        return 0.0
    axis = np.linalg.eigh(tensor)[1][:, -1]  # of the greatest moment
    return spread_along(axis, figures.half_units(tensor))


def spread_along(axis: Float, loose: Float) -> float:
    """Return by how much vᵀ(½ tr(J) δ − J)v may be off, kg m², along a unit vector (3,).

    `loose` is by how much the elements of J (3, 3) may be.
    """
    return float(np.sum(np.abs(np.eye(3) / 2 - np.outer(axis, axis)) * loose))


@dataclass(frozen=True, eq=False)
class Partial:
    """Mass properties that a file states in part, beside a mass; None where shapes have them.

    Attributes
    ----------
    center : (3,) m, the centre of mass in the axes of the link
    moments : (3,) kg m², principal ones about it
    axes : (3, 3), a rotation whose columns are their axes in those of the link
    frame : (3, 3), likewise the axes along which a tensor of shapes is diagonalised
    """

    center: Float | None = None
    moments: Float | None = None
    axes: Float | None = None
    frame: Float = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True)
class Primitive:
    """A shape without a mesh: ``box`` (x, y, z), ``sphere`` (r), ``cylinder`` or ``capsule`` (r, length along z),

    ``cone`` (r, height along z, the apex up, half of it below the origin), ``ellipsoid`` (half axes); m.
    """

    kind: Literal["box", "sphere", "cylinder", "capsule", "cone", "ellipsoid"]
    sizes: tuple[float, ...]

    @property
    def volume(self) -> float:
        """What it encloses, m³."""
        if self.kind == "box":
            return math.prod(self.sizes)
        if self.kind in ("sphere", "ellipsoid"):
            return 4 / 3 * math.pi * math.prod(self.sizes if len(self.sizes) == 3 else self.sizes * 3)
        radius, length = self.sizes
        barrel = math.pi * radius**2 * length
        if self.kind == "capsule":
            return barrel + 4 / 3 * math.pi * radius**3
        return barrel / 3 if self.kind == "cone" else barrel


@dataclass(frozen=True, eq=False)
class Geometry:
    """A shape of a link.

    Attributes
    ----------
    name : for messages, different for each geometry of the link
    role : what the file has it for
    shape : a mesh's file, or the mesh as a part, a primitive, or why it is none of them, in a sentence
    placement : of its own axes in those of the link
    scale : what the coordinates in the mesh's file are multiplied by to be metres, along its x, y and z; None where
        the file's own unit, or else the metre, counts
    transform : of a mesh that stands in the robot's file, from its own axes to those of `placement`, m; None where
        `scale` says all
    density, mass : kg/m³, or kg, that the format has it weigh where nothing is stated of the link; None where it has
        no such rule
    filling : what of it weighs that: the solid, its surface (kg/m² then), a mesh's convex hull, or what MuJoCo counts
        of a mesh (`inertia.exchange.robots.mjcf_masses.legacy`)
    stated : of the mass properties of what it weighs; None where it has all of them
    """

    name: str
    role: Role
    shape: Path | Part | Primitive | str
    placement: Placement = field(default_factory=Placement)
    scale: tuple[Fraction, Fraction, Fraction] | None = None
    transform: Transform | None = None
    density: float | None = None
    mass: float | None = None
    filling: Filling = "solid"
    stated: Partial | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", visible(self.name))

    @property
    def linear(self) -> Matrix:
        """What the coordinates of the mesh are multiplied by to be metres."""
        if self.transform is not None:
            return self.transform.linear
        return diagonal(self.scale or (Fraction(1),) * 3)

    @property
    def weighs(self) -> bool:
        """Whether the format has it weigh anything where nothing is stated of the link."""
        return bool(self.density if self.mass is None else self.mass)


@dataclass(frozen=True, eq=False)
class Joint:
    """What a link hangs on.

    Attributes
    ----------
    name : of the joint; of the link where it has none
    parent : the link that it hangs from; None of the world
    placement : of the axes of the link in those of `parent`, where the joint is at `rest`
    kind : whether it "turns" about its axis, "slides" along it, is "fixed", or moves as none of these
    axis : (3,) of any length, in the axes of the link
    point : (3,) m on it, likewise
    rest : rad, or m of one that slides, at which `placement` holds
    mimic : the joint that it follows, and how: a position of p there is one of `multiplier` p + `offset` here
    """

    name: str
    parent: str | None
    placement: Placement
    kind: Motion = "fixed"
    axis: Float = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    point: Float = field(default_factory=lambda: np.zeros(3))
    rest: float = 0.0
    mimic: tuple[str, float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", visible(self.name))
        object.__setattr__(self, "parent", self.parent and visible(self.parent))

    def turned_round(self, child: str | None) -> Joint:
        """Return the joint that hangs its parent on its child, None for the world, with the same positions."""
        turn, at = self.placement.rotation, self.placement.origin
        axis, point = -turn @ self.axis, turn @ self.point + at
        return replace(self, parent=child, placement=self.placement.inverse, axis=axis, point=point)


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body of a robot.

    Attributes
    ----------
    inertial : what is stated of it; None where nothing is
    parent : the link it hangs from by a joint that does not move; None otherwise
    placement : of its axes in those of `parent`
    fault : why what is stated of it cannot be read, a sentence; "" where it can
    joint : what it hangs on, whether that moves or not; None of a root, and where the format's joints are not read
    further : joints that move it beside that one, in their order, each in the axes that the ones before leave it with
    mass : kg that geometries with densities weigh together, in proportion to these; None where nothing scales them
    stated : of what these have together, where `inertial` is None; None where they have all of it
    """

    name: str
    inertial: Inertial | None
    geometries: tuple[Geometry, ...]
    parent: str | None = None
    placement: Placement = field(default_factory=Placement)
    fault: str = ""
    joint: Joint | None = None
    mass: float | None = None
    stated: Partial | None = None
    further: tuple[Joint, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", visible(self.name))
        object.__setattr__(self, "parent", self.parent and visible(self.parent))

    @property
    def joints(self) -> tuple[Joint, ...]:
        """All the joints that it hangs on."""
        return self.further if self.joint is None else (self.joint, *self.further)


@dataclass(frozen=True, eq=False)
class Robot:
    """What a file holds: its links, in its order, and what reading had to decide, in sentences.

    `mass` is what the format has the links scaled to, all together, kg; None where it does not. `left_out` says what
    has a mass and is not read, in sentences. `least` are the mass, kg, and the principal moment, kg m², to which the
    format raises those of every link that are smaller.
    """

    path: Path
    format: str
    name: str
    links: tuple[Link, ...]
    notes: tuple[str, ...] = ()
    mass: float | None = None
    left_out: tuple[str, ...] = ()
    least: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", visible(self.name))
        object.__setattr__(self, "notes", tuple(map(visible, self.notes)))
        object.__setattr__(self, "left_out", tuple(map(visible, self.left_out)))
