"""The planes of a rotor in which something is done, with the surfaces of its metal, and what that changes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.correction_loop import tools_of_density
from inertia.balancing.corrections.correction_plane import CorrectionPlane, evenly
from inertia.balancing.corrections.room import PROUD, faces, no_room
from inertia.balancing.corrections.workpiece import bodies as in_shaft_axes
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody, in_unit, outer_radius
from inertia.errors import GeometryError, UsageError, placed

_LOOKED_AT = 360  # angles at which a face is looked for
_SAME = 1e-5  # of a radius: what that and facets in the middle of a face leave of a surface


def correction_planes(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft) -> tuple[CorrectionPlane, ...]:
    """Return the planes in which something is done; a radius that the file leaves out is the bodies' own."""
    metres = float(rotor.unit.metres)
    planes = []
    for number, fields in enumerate(rotor.fields.plane):
        if fields.method is not None:
            radius = outer_radius(bodies, shaft, metres * fields.z) if fields.radius is None else 0.0
            try:
                plane = rotor.correction_plane(number, radius)
                planes.append(_on_its_surface(plane, bodies, shaft, fields.face_z == "find") if plane.cuts else plane)
            except (UsageError, GeometryError) as error:
                raise placed(error, rotor.name) from None
    return tuple(planes)


def _on_its_surface(
    plane: CorrectionPlane, bodies: Sequence[RotorBody], shaft: Shaft, find: bool = False
) -> CorrectionPlane:
    """Return a plane with the radius or the face of the metal, where it is near what the file says.

    `find` takes the nearest face however far it is, and raises `GeometryError` where there is none.
    """
    if plane.method != "drill_axial":
        own = outer_radius(bodies, shaft, plane.z)
        return replace(plane, radius=own) if _SAME * own < abs(own - plane.radius) <= PROUD * plane.radius else plane
    placed_bodies = in_shaft_axes([k.part for k in bodies], [k.density for k in bodies], shaft)
    tool = tools_of_density(plane, 0.0)[0]
    places = faces(placed_bodies, tool, np.array(evenly(_LOOKED_AT)))
    if len(places) == 0:
        if find:
            raise no_room(placed_bodies, tool, 0.0)
        return plane
    nearest = float(places[np.abs(places - plane.entry).argmin()])
    near = _SAME * plane.radius < abs(nearest - plane.entry) <= PROUD * plane.radius
    return replace(plane, face_z=nearest) if find or near else plane


def against(rotor: Rotor, shaft: Shaft) -> Iterator[str]:
    """Say where z of the planes is that of the part with the other sign, as B lies before A on an axis of the part."""
    along = shaft.axes[:, 2].tolist()
    number = min(range(3), key=lambda k: along[k])
    if rotor.fields.plane and along[number] < _SAME - 1.0:
        plane, name = rotor.fields.plane[0], "xyz"[number]
        yield (
            f"places along the shaft count from A to B, which is against the part's {name}: plane {plane.id} at "
            f"z = {plane.z:g} {rotor.unit.name} is at {name} = {0.0 - plane.z:g} {rotor.unit.name} of the part"
        )


def moved(rotor: Rotor, planes: Sequence[CorrectionPlane]) -> Iterator[str]:
    """Say of which planes the metal begins elsewhere than the file has it."""
    metres, given = float(rotor.unit.metres), {fields.id: fields for fields in rotor.fields.plane}
    for plane in planes:
        fields, axial = given[plane.id], plane.method == "drill_axial"
        said = (fields.z if fields.face_z is None else fields.face_z) if axial else fields.radius
        own, what = (plane.entry, "face") if axial else (plane.radius, "radius")
        if isinstance(said, float | int) and abs(own - metres * said) > _SAME * plane.radius:
            yield (
                f"plane {plane.id}: depths are counted from the metal, whose {what} is at {in_unit(rotor, own)}, not "
                f"at {said:g} as the file has it"
            )
