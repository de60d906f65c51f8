"""One state of a rotor, in space: the bodies that turn, the unbalance in every plane, and the force on each bearing.

All that turns with the rotor hangs below one frame and is written once; only that frame moves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.shop_units import in_gmm
from inertia.balancing.unbalance import Unbalance
from inertia.mesh.part import Part
from inertia.recording import entities
from inertia.recording.display import MOST, facets, shown_triangles
from inertia.recording.drawing import circle, write_lines
from inertia.recording.writer import Recording

BODY, SHAFT, PLACE = (150, 165, 185, 110), (200, 200, 205), (235, 235, 240)
UNBALANCE, FORCE, PERMISSIBLE = (255, 220, 90), (240, 90, 80), (90, 200, 90)

_LONGEST = 1.2  # over the outer radius of the rotor, of the longest vector or the largest circle
_THICK = 0.018  # over that radius


@dataclass(frozen=True, eq=False)
class State:
    """What a rotor is like.

    Attributes
    ----------
    room : the entity below which it is written
    title : what the view is called
    unit : m, one unit of the view
    radius, reach : of the rotor from its shaft and from the middle, in `unit`
    bodies : (k, 3, 3) each, corners in `unit`, shaft axes from the middle of the rotor
    bearings : where A and B are along the shaft, in `unit` from the middle
    planes : (where in `unit`, name, vector in kg m) of the correction planes
    unbalance : the vectors in the tolerance planes A and B, kg m
    permissible : in them, kg m
    forces : on bearings A and B, N
    operations : (place (3,) in `unit`, what is done there)
    notes : what was done for display only
    """

    room: str
    title: str
    unit: float
    radius: float
    reach: float
    bodies: tuple[Float, ...]
    bearings: tuple[float, float]
    planes: tuple[tuple[float, str, complex], ...]
    unbalance: tuple[complex, complex]
    permissible: tuple[float, float]
    forces: tuple[complex, complex]
    operations: tuple[tuple[Float, str], ...]
    notes: tuple[str, ...]

    @property
    def longest(self) -> float:
        """The longest of its vectors, kg m, that of the permissible unbalance included."""
        return max(*map(abs, (vector for _, _, vector in self.planes)), *map(abs, self.unbalance), *self.permissible)


def states_of(balance: Balance) -> list[State]:
    """Return the rotor as modelled and, where something was done about it, as corrected."""
    correction = balance.correction
    parts = [body.part for body in balance.bodies]
    states = [_state(balance, entities.AS_MODELLED, "As modelled", parts, balance.initial, ())]
    if correction is not None and correction.operations:
        operations = correction.operations
        states.append(_state(balance, entities.CORRECTED, "Corrected", correction.parts, balance.residual, operations))
    return states


def _state(
    balance: Balance,
    room: str,
    title: str,
    parts: Sequence[Part],
    unbalance: Unbalance,
    operations: Sequence[Operation],
) -> State:
    shaft = balance.shaft
    bodies, notes = _corners(balance, parts)
    points = np.concatenate([body.reshape(-1, 3) for body in bodies])
    low, high = points[:, 2].min(), points[:, 2].max()
    middle = 0.5 * (min(low, shaft.z_a) + max(high, shaft.z_b))
    radius = float(np.hypot(points[:, 0], points[:, 1]).max())
    reach = math.hypot(radius, max(high, shaft.z_b) - middle)
    unit = 10.0 ** math.floor(math.log10(reach))
    shift = np.array([0.0, 0.0, middle])
    corrected = room == entities.CORRECTED
    return State(
        room=room,
        title=title,
        unit=unit,
        radius=radius / unit,
        reach=reach / unit,
        bodies=tuple((body - shift) / unit for body in bodies),
        bearings=((shaft.z_a - middle) / unit, (shaft.z_b - middle) / unit),
        planes=tuple(
            ((plane.z - middle) / unit, plane.id, plane.residual if corrected else plane.initial)
            for plane in balance.planes
        ),
        unbalance=unbalance.in_planes(*balance.tolerance_planes),
        permissible=balance.tolerance.permissible,
        forces=balance.forces(unbalance),
        operations=tuple((_place(each, middle) / unit, f"{each.id}: {_description(each)}") for each in operations),
        notes=tuple(notes),
    )


def _corners(balance: Balance, parts: Sequence[Part]) -> tuple[list[Float], list[str]]:
    """Return the triangles (k, 3, 3) of the bodies, m, shaft axes; and what was left out of them."""
    shaft, bodies, notes = balance.shaft, [], []
    start = shaft.to_part([0.0, 0.0, 0.0])
    for body, part in zip(balance.bodies, parts, strict=True):
        corners, count = shown_triangles(part, start, MOST // len(parts))
        bodies.append(corners @ shaft.axes)
        if len(corners) < count:
            notes.append(f"{body.name} is shown with {len(corners)} of its {count} triangles")
    return bodies, notes


def _place(operation: Operation, middle: float) -> Float:
    angle, radius = operation.angle, operation.radius
    return np.array([radius * math.cos(angle), radius * math.sin(angle), operation.z - middle])


def _description(operation: Operation) -> str:
    """Return what is done in a few words."""
    if operation.arc is not None and operation.depth is not None and operation.half_angle is not None:
        return f"arc of {math.degrees(2.0 * operation.half_angle):.4g}°, {1e3 * operation.depth:.4g} mm deep"
    if operation.tool_diameter is not None and operation.depth is not None:
        return f"Ø {1e3 * operation.tool_diameter:.4g}, {1e3 * operation.depth:.4g} mm deep"
    if operation.depth is not None:
        return f"flat, {1e3 * operation.depth:.4g} mm deep"
    return f"{'add' if operation.method == 'add' else 'take'} {1e3 * operation.mass:.4g} g"


def write_state(recording: Recording, state: State, time: Float, speed: float) -> Iterator[str]:
    """Write a state that turns at `speed` (rad/s, about z′), at instants (m,) s."""
    import rerun as rr

    turning = f"{state.room}/rotor"
    half = 0.5 * speed * time
    zero = np.zeros_like(half)
    attitude = np.stack([zero, zero, np.sin(half), np.cos(half)], axis=1).astype(np.float32)
    recording.columns(turning, time, lambda rows: rr.Transform3D.columns(quaternion=attitude[rows]))
    for number, corners in enumerate(state.bodies):
        recording.static(f"{turning}/body_{number}", facets(corners, BODY))
    length = _LONGEST * state.radius / state.longest
    thick = _THICK * state.radius
    ends = np.array([[0.0, 0.0, -1.15 * state.reach], [0.0, 0.0, 1.15 * state.reach]])
    write_lines(recording, f"{state.room}/shaft", [ends], SHAFT, 0.4 * thick)
    _write_vectors(
        recording,
        f"{turning}/unbalance",
        [(z, f"{name} {in_gmm(vector):.4g} g·mm", length * vector) for z, name, vector in state.planes],
        UNBALANCE,
        thick,
    )
    _write_vectors(
        recording,
        f"{turning}/bearing_force",
        [
            (z, f"{name} {abs(force):.4g} N", length * vector)
            for z, name, force, vector in zip(state.bearings, "AB", state.forces, state.unbalance, strict=True)
        ],
        FORCE,
        thick,
    )
    circles = [circle(length * most, z, np.eye(3)) for z, most in zip(state.bearings, state.permissible, strict=True)]
    write_lines(recording, f"{state.room}/permissible", circles, PERMISSIBLE, 0.6 * thick)
    if state.operations:
        spots = [place for place, _ in state.operations]
        labels = [what for _, what in state.operations]
        recording.static(
            f"{turning}/operations",
            rr.Points3D(spots, labels=labels, colors=[PLACE], radii=[2.0 * thick], show_labels=True),
        )
    yield from (f"{state.title.lower()}: {each}" for each in state.notes)
    yield (
        f"{state.title.lower()}: one outer radius is {in_gmm(state.longest) / _LONGEST:.4g} g·mm of unbalance; the "
        "vectors of the correction planes are yellow"
    )


def _write_vectors(
    recording: Recording,
    path: str,
    vectors: Sequence[tuple[float, str, complex]],
    color: tuple[int, int, int],
    thick: float,
) -> None:
    """Write arrows across the shaft: (where along it, label, vector)."""
    import rerun as rr

    recording.static(
        path,
        rr.Arrows3D(
            origins=[(0.0, 0.0, z) for z, _, _ in vectors],
            vectors=[(vector.real, vector.imag, 0.0) for _, _, vector in vectors],
            labels=[label for _, label, _ in vectors],
            colors=[color],
            radii=[thick],
            show_labels=True,
        ),
    )
