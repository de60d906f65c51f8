"""`Operation`: one thing that the shop does to the rotor, in SI units.

Angles, signs and the shaft's frame are those of `inertia.balancing.unbalance`.
"""

from __future__ import annotations

from typing import Literal

from inertia.records import dataclass

Method = Literal["add", "remove"]
Kind = Literal["point_mass", "drill_radial", "drill_axial", "mill_flat", "mill_arc", "weight"]


@dataclass(frozen=True)
class Operation:
    """One hole, flat, arc or weight.

    Attributes
    ----------
    id : "I-1", "I-2", ...: the plane's id and the operation's number in it
    plane : id of the correction plane
    z : m along the shaft, where the tool's axis, the middle of a flat or the weight is; for an axial hole the face
        that it enters
    method : whether mass is added or removed
    kind : what is done
    angle : rad, 0 to 2π, where it is done
    radius : m from the shaft; the surface that a radial drill or a flat's cutter starts from, or where the axis of an
        axial hole, or the mass, is
    mass : kg added or removed, positive
    unbalance : kg·m, what the operation adds to the unbalance: m·r·exp(i·angle) for mass added, its opposite for mass
        removed
    unbalance_z : m along the shaft, where that unbalance acts
    tool_diameter : m, of a drill, or of the cutter of an arc
    point_angle : rad, between the lips of a drill; π is flat
    depth : m, of a hole to the shoulder, where the full diameter ends (the point goes deeper), or of a flat or an arc
    width : m along the shaft, of a flat or an arc
    arc : rad, between the ends of an arc, half of it on either side of `angle`
    half_angle : rad, that it takes of the rim on either side of `angle`, a cutter's reach included; of an arc
    passes : in which an arc is taken
    remaining_wall : m of material left under the tool, where the mesh is at hand
    pieces : weights at this place
    item : what the kit calls the weight
    """

    id: str
    plane: str
    z: float
    method: Method
    kind: Kind
    angle: float
    radius: float
    mass: float
    unbalance: complex
    unbalance_z: float
    tool_diameter: float | None = None
    point_angle: float | None = None
    depth: float | None = None
    width: float | None = None
    arc: float | None = None
    half_angle: float | None = None
    passes: int = 1
    remaining_wall: float | None = None
    pieces: int = 1
    item: str | None = None
