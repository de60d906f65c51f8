"""Bodies of a rotor: read, integrated, and together their unbalance, their outline and their radius about the shaft."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Literal

import numpy as np

from inertia.arrays import Bool, Float
from inertia.balancing import bounds
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.facet_error import FacetLayers
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_fields import BodyFields
from inertia.balancing.tessellation_bound import chord_uncertainty, facet_uncertainty
from inertia.balancing.unbalance import Unbalance
from inertia.errors import FieldPath, GeometryError, InertiaError, placed
from inertia.mass.analyse import analyse, mass_properties, sound_solids_only
from inertia.mass.analysis import Analysis
from inertia.mesh.geometry.intersect import overlap
from inertia.mesh.part import Cells, Part, Rounding
from inertia.mesh.read import read
from inertia.mesh.regions import region_of
from inertia.mesh.surface import Surface
from inertia.records import dataclass

ChordFrom = Literal["given", "read", "shape", "estimated", "mesh", "exact"]

_FARTHER = 2.0  # times the sag of the facets: then the vertices themselves may lie off the surface
_LESS = 0.95  # of the sag of the facets: less than the mesh shows
_WEIGHED: tuple[Literal["density", "mass"], ...] = ("density", "mass")
_SECTORS = 720
_CHUNK = 1 << 16


@dataclass(frozen=True, eq=False)
class RotorBody:
    """One body: its mesh, its mass properties, and how well the mesh is known.

    Attributes
    ----------
    name : what the report calls it
    whole : the part as read, with all its regions
    part : what of it is the body
    analysis : of the body
    chord : m, how far the true surface may be from the mesh
    chord_from : who said so: the rotor file; the reader, which made the triangles (STEP), also where the true "shape"
        is integrated in their place; the mesh itself, by the sag of its facets ("estimated", or "mesh" where the rotor
        file says less than that); or "exact" where there is none
    layers : what lies between its facets and the surfaces that they stand for
    """

    name: str
    whole: Part
    part: Part
    analysis: Analysis
    chord: float
    chord_from: ChordFrom
    layers: FacetLayers

    @property
    def density(self) -> float:
        """kg/m³; of a body that was weighed, what follows from its volume."""
        return self.analysis.density

    def relative(self, name: Literal["density", "mass"]) -> float:
        """Return the standard uncertainty of its density or its weighed mass over that; 0 where none is given."""
        known, properties = self.analysis.uncertainty, self.analysis.properties
        u = 0.0 if known is None else known.inputs.get(name, 0.0)
        return u / (properties.mass if name == "mass" else self.density)

    def tessellation(self, shaft: Shaft, z: float) -> Uncertainty | None:
        """Return what triangles leave uncertain of the unbalance, the couple about the plane z (m)."""
        if not self.chord or self.chord_from == "shape":
            return None
        if self.chord_from == "given" and self.chord > _FARTHER * self.layers.sag:
            layer = chord_uncertainty(self.part, self.chord, self.density, shaft, z)
        else:
            layer = facet_uncertainty(self.layers, self.density, shaft, z)
        if self.analysis.density_from != "mass":
            return layer
        # What the layer weighs, the rest of a body that was weighed does not.
        own = Unbalance.of(self.analysis.properties, shaft)
        less = [m / own.mass for m, _ in layer.masses]
        return replace(
            layer,
            modes=tuple(
                (g - k * own.static, h - k * own.couple_about(z)) for (g, h), k in zip(layer.modes, less, strict=True)
            ),
            masses=tuple((0.0, s - m * (own.z - z)) for m, s in layer.masses),
        )


def read_bodies(rotor: Rotor) -> tuple[RotorBody, ...]:
    """Read and integrate the bodies of a rotor.

    Raises
    ------
    ReadError : a file cannot be read
    GeometryError : a body is open, inside out, ..., or two of them overlap
    UsageError : a region or material is not known

    All name the body by its place in the file.
    """
    bodies = []
    for number, fields in enumerate(rotor.fields.body):
        try:
            with sound_solids_only("a rotor takes sound solids only"):
                bodies.append(_read(rotor, fields))
        except InertiaError as error:
            raise placed(error, rotor.name, FieldPath(f"body[{number}]")) from None
    require_apart(rotor, bodies)
    return tuple(bodies)


def _read(rotor: Rotor, fields: BodyFields) -> RotorBody:
    whole = read(rotor.folder / fields.file, fields.unit)
    if whole.unit_from == "assumed":
        whole = replace(whole, unit=rotor.unit, unit_from="option")
    if isinstance(whole.geometry, Cells):
        raise GeometryError(f"{whole.name} is a mesh of cells: give the surface of the body, as STL or STEP")
    return _of_part(rotor, fields, whole, whole if fields.region is None else region_of(whole, fields.region))


def turned(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft, turns: Sequence[float]) -> tuple[RotorBody, ...]:
    """Turn bodies about the shaft by angles (b,) rad, as triangles; `GeometryError` where they overlap then."""
    result = [
        _of_part(rotor, fields, _turned(body.whole, shaft, turn), _turned(body.part, shaft, turn)) if turn else body
        for fields, body, turn in zip(rotor.fields.body, bodies, turns, strict=True)
    ]
    require_apart(rotor, result)
    return tuple(result)


def _turned(part: Part, shaft: Shaft, turn: float) -> Part:
    cosine, sine = math.cos(turn), math.sin(turn)
    rotation = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    metres, triangles = float(part.unit.metres), part.triangles
    corners = shaft.to_shaft(triangles.corners().reshape(-1, 3) * metres) @ rotation.T
    vertices = shaft.to_part(corners) / metres
    rounding = None if part.rounding is None else Rounding(part.rounding.distance)
    surface = Surface(vertices, np.arange(len(vertices)).reshape(-1, 3))
    return replace(part, geometry=surface, rounding=rounding, shape=None)


def _of_part(rotor: Rotor, fields: BodyFields, whole: Part, part: Part) -> RotorBody:
    sigma = None if fields.sigma is None else fields.sigma * float(rotor.unit.metres / part.unit.metres)
    analysis = analyse(
        part,
        fields.density,
        material=fields.material,
        mass=fields.mass,
        sigma=sigma,
        tessellated=fields.chord_tolerance is not None,
    )
    name = fields.name or fields.region or Path(fields.file).name
    layers = FacetLayers(part)
    if fields.chord_tolerance is None and part.chord is not None:
        read_chord = float(part.chord.max()) * float(part.unit.metres)
        return RotorBody(name, whole, part, analysis, read_chord, "shape" if analysis.shape else "read", layers)
    chord, chord_from = _chord(fields, layers, float(rotor.unit.metres))
    return RotorBody(name, whole, part, analysis, chord, chord_from, layers)


def _chord(fields: BodyFields, layers: FacetLayers, metres: float) -> tuple[float, ChordFrom]:
    """Return how far the true surface may be from the mesh, m, and who says so.

    A figure that is less than the facets show is none of that mesh: what is typed takes no doubt away.
    """
    if fields.chord_tolerance is None:
        return layers.sag, "estimated" if layers.sag else "exact"
    chord = fields.chord_tolerance * metres
    if chord < _LESS * layers.sag:
        return layers.sag, "mesh"
    return chord, "given" if chord else "exact"


def require_apart(rotor: Rotor, bodies: Sequence[RotorBody]) -> None:
    """Raise `GeometryError` where two bodies share space."""
    surfaces = [_in_metres(body.part) for body in bodies] if len(bodies) > 1 else []
    low, high = (np.array([f(each.vertices, axis=0) for each in surfaces]).reshape(-1, 3) for f in (np.min, np.max))
    for one, other in combinations(range(len(surfaces)), 2):
        if (low[one] > high[other]).any() or (low[other] > high[one]).any():
            continue
        place = overlap(surfaces[one], surfaces[other], contact=bodies[one].chord + bodies[other].chord)
        if place is not None:
            where = ", ".join(f"{x / float(rotor.unit.metres):.6g}" for x in place)
            raise GeometryError(
                f"{rotor.name}: body[{one}] ({bodies[one].name}) and body[{other}] ({bodies[other].name}) overlap at "
                f"({where}) {rotor.unit.name}, where their mass would be counted twice: cut one out of the other, or "
                "leave it out"
            )


def _in_metres(part: Part) -> Surface:
    corners = part.triangles.corners().reshape(-1, 3)
    return Surface(corners * float(part.unit.metres), np.arange(len(corners)).reshape(-1, 3))


def unbalance_of(bodies: Sequence[RotorBody], shaft: Shaft, keyed: Unbalance) -> Unbalance:
    """Return the unbalance of all bodies and keys with what tessellation and noise of vertices leave uncertain.

    Parameters
    ----------
    bodies, shaft : as read
    keyed : the unbalance of bodies and keys, with what arithmetic and axis leave uncertain
    """
    several = len(bodies) > 1
    more = [
        replace(layer, bodies=(body.name,) if several else ())
        for body in bodies
        if (layer := body.tessellation(shaft, keyed.z)) is not None
    ]
    for body in bodies:
        known = body.analysis.uncertainty
        if known is not None and "vertices" in known.components:
            name, covariance = f"vertices of {body.name}", known.components["vertices"]
            more.append(bounds.propagated(name, covariance, known.properties, shaft, keyed.z))
    return keyed.with_uncertainties(*more)


def density_uncertainties(
    rotor: Rotor,
    bodies: Sequence[RotorBody],
    shaft: Shaft,
    z: float,
    *,
    cut: Sequence[Part] | None = None,
    measured: bool = False,
) -> tuple[Uncertainty, ...]:
    """Return what densities and weighed masses leave uncertain: each moves all that its body has in proportion.

    Parameters
    ----------
    rotor, bodies, shaft : as read
    z : m, the plane that couples are about
    cut : what is left of the bodies' triangles after corrections; limits follow the mass that they had before
    measured : whether a machine showed the unbalance, so that only what was cut is in proportion
    """
    more, common = [], []
    for number, body in enumerate(bodies):
        own = [(name, u) for name in _WEIGHED if (u := body.relative(name))]
        every = bool(rotor.fields.uncertainty.density) and body.analysis.density_from != "mass" and not own
        if not own and not every:
            continue
        alone = Unbalance.of(body.analysis.properties, shaft)
        mass = alone.mass, alone.mass * (alone.z - z)
        static, couple = (0j, 0j) if measured else (alone.static, alone.couple_about(z))
        if cut is not None:
            before, after = (
                Unbalance.of(mass_properties(part, body.density, intersections=False, tessellated=True), shaft)
                for part in (body.part, cut[number])
            )
            static += after.static - before.static
            couple += after.couple_about(z) - before.couple_about(z)
        if every:
            common.append((body.name, (static, couple), mass))
        more += [
            Uncertainty(
                "input", ((u * static, u * couple),), None, (f"{name} of {body.name}",), ((u * mass[0], u * mass[1]),)
            )
            for name, u in own
        ]
    if common:
        names, modes, masses = zip(*common, strict=True)
        spread = bounds.density(modes, rotor.fields.uncertainty.density, masses)
        more.append(replace(spread, bodies=names if len(bodies) > 1 else ()))
    return tuple(more)


def _corners(bodies: Sequence[RotorBody], shaft: Shaft) -> Iterator[Float]:
    """Yield the corners (k, 3, 3) of the bodies' triangles in shaft axes, m."""
    for body in bodies:
        triangles, metres = body.part.triangles, float(body.part.unit.metres)
        for start in range(0, triangles.count, _CHUNK):
            yield shaft.to_shaft(triangles.corners(start, start + _CHUNK) * metres)


@dataclass(frozen=True, eq=False)
class Outline:
    """How a rotor lies about its shaft.

    Attributes
    ----------
    low, high : m, where it begins and ends along the shaft
    sectors : (n,) whether it has corners there, equal sectors of the full turn
    """

    low: float
    high: float
    sectors: Bool

    @property
    def goes_around(self) -> bool:
        """Whether the shaft goes through: the rotor does not lie within half a turn about it."""
        return self._gap <= 0.5 * len(self.sectors)

    @property
    def _gap(self) -> int:
        """The longest run of empty sectors."""
        filled = np.flatnonzero(self.sectors)
        return int(np.diff(np.append(filled, filled[0] + len(self.sectors))).max()) - 1


def outline(bodies: Sequence[RotorBody], shaft: Shaft) -> Outline:
    """Return how the bodies lie about the shaft."""
    low, high, sectors = math.inf, -math.inf, np.zeros(_SECTORS, bool)
    for corners in _corners(bodies, shaft):
        low, high = min(low, float(corners[..., 2].min())), max(high, float(corners[..., 2].max()))
        angles = np.arctan2(corners[..., 1], corners[..., 0]).ravel()
        sectors[np.unique(np.floor(angles / (2.0 * math.pi) * _SECTORS).astype(np.int64) % _SECTORS)] = True
    return Outline(low, high, sectors)


def outer_radius(bodies: Sequence[RotorBody], shaft: Shaft, z: float) -> float:
    """Return how far from the shaft the bodies reach at a place z (m) along it; 0 where they are not."""
    reach = 0.0
    for corners in _corners(bodies, shaft):
        height = corners[..., 2] - z
        crossing = corners[(height.min(axis=1) <= 0) & (height.max(axis=1) >= 0)]
        for start, end in ((0, 1), (1, 2), (2, 0)):
            a, b = crossing[:, start], crossing[:, end]
            low, high = a[:, 2] - z, b[:, 2] - z
            crosses = (low * high <= 0) & (low != high)
            share = low[crosses] / (low[crosses] - high[crosses])
            points = a[crosses] + share[:, np.newaxis] * (b[crosses] - a[crosses])
            reach = max(reach, float(np.hypot(points[:, 0], points[:, 1]).max(initial=0.0)))
    return reach


def in_unit(rotor: Rotor, length: float) -> str:
    """Return a length (m) as the rotor's file would have it."""
    return f"{length / float(rotor.unit.metres):.6g} {rotor.unit.name}"
