"""One state of a rotor, in space: bodies that turn on their bearings, unbalance in every plane, zero mark, and work.

All that turns with the rotor hangs below one frame and is written once; only that frame moves. What is permissible sets
the scale of the vectors, the same in every state; a vector that is much longer is broken.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

import numpy as np

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.shop_units import in_gmm
from inertia.balancing.unbalance import Unbalance
from inertia.mesh.part import Part
from inertia.palette import YELLOW, rgb
from inertia.recording import entities
from inertia.recording.display import MOST, facets, shown_triangles
from inertia.recording.drawing import Color, circle, write_labels, write_lines
from inertia.recording.spin_marks import meridian
from inertia.recording.views.rotor_target import (
    AFTER,
    BEFORE,
    FAINT,
    INK,
    PERMISSIBLE,
    PLACE,
    WHITE,
    broken,
    numbers_text,
)
from inertia.recording.views.rotor_text import bearing_bounds, force_text, plane_bounds, resolved, states, vector_text
from inertia.recording.writer import Recording
from inertia.records import dataclass

BODY, UNBALANCE = (150, 165, 185, 110), rgb(YELLOW)

_PERMISSIBLE = 0.6  # over the outer radius of the rotor: the larger circle of what is permissible
_LONGEST = 1.2  # the same, of the longest vector
_THICK = 0.018  # over that radius
_LINE = 0.15  # over half the height of the view, from a line of labels to the next
_MARGIN, _WIDE = 1.2, 1.4  # over the reach, what is seen along the shaft; over its height, the width of the view
_CLOSE = 1.0  # over the reach: labels nearer than that are on different lines
_MERIDIANS = (0, WHITE, 0.7), (90, FAINT, 0.35), (180, FAINT, 0.35), (270, FAINT, 0.35)  # degrees, color, thickness
_NUMBERED = 6  # names of operations that are shown in space: more would cover the rotor
_SAMPLES = 24  # of the arc that shows the sense of rotation


@dataclass(frozen=True, eq=False)
class Vector:
    """An unbalance across the shaft: where along it, in units of the view; kg m; its bound; what is written of it."""

    z: float
    value: complex
    bound: float
    text: str


@dataclass(frozen=True, eq=False)
class State:
    """What a rotor is like.

    Attributes
    ----------
    room : the entity below which it is written
    name, verdict : "as modelled", "FAIL"
    unit : m, one unit of the view
    radius, reach : of the rotor from its shaft, and along it from the middle, bearings included, in `unit`
    bodies : (k, 3, 3) each, corners in `unit`, shaft axes from the middle of the rotor
    names : of their entities
    bearings, planes : what the tolerance planes and the correction planes have of the unbalance
    permissible : in the tolerance planes, kg m
    scale : `unit` in a kg m of unbalance, as drawn
    forces : on bearings A and B, N, none where the arithmetic does not tell them from zero
    operations : places (3,) in `unit`, in their order
    turn : +1 or −1, about z′
    notes : what was done for display only
    """

    room: str
    name: str
    verdict: str
    unit: float
    radius: float
    reach: float
    bodies: tuple[Float, ...]
    names: tuple[str, ...]
    bearings: tuple[Vector, ...]
    planes: tuple[Vector, ...]
    permissible: tuple[float, float]
    scale: float
    forces: tuple[complex, ...]
    operations: tuple[Float, ...]
    turn: int
    notes: tuple[str, ...]

    @property
    def title(self) -> str:
        """What the view is called."""
        return f"{self.name.capitalize()}: {self.verdict}"

    @property
    def extent(self) -> tuple[float, float]:
        """How far the view has to reach across the shaft, labels included, and along it."""
        lines = 1 + max(*_lines_of(self.planes, self.reach), *_lines_of(self.bearings, self.reach), 0)
        along = _MARGIN * self.reach
        return max(self.label_start / max(1.0 - _LINE * lines, 0.3), along / _WIDE), along

    @property
    def label_start(self) -> float:
        """Where labels begin, across the shaft."""
        return (_LONGEST + 0.1) * self.radius


def states_of(balance: Balance) -> list[State]:
    """Return the rotor as modelled and, where something was done about it, as corrected."""
    parts = [body.part for body in balance.bodies]
    every = states(balance)
    shown = [_state(balance, entities.AS_MODELLED, every[0], parts)]
    if len(every) > 1 and balance.correction is not None:
        shown.append(_state(balance, entities.CORRECTED, every[1], balance.correction.parts))
    return shown


def _state(balance: Balance, room: str, named: tuple[str, str, Unbalance], parts: Sequence[Part]) -> State:
    shaft, (name, verdict, unbalance) = balance.shaft, named
    bodies, notes = _corners(balance, parts)
    points = np.concatenate([body.reshape(-1, 3) for body in bodies])
    low, high = min(points[:, 2].min(), shaft.z_a), max(points[:, 2].max(), shaft.z_b)
    middle = 0.5 * (low + high)
    radius = float(np.hypot(points[:, 0], points[:, 1]).max())
    unit = 10.0 ** math.floor(math.log10(math.hypot(radius, high - middle)))
    shift = np.array([0.0, 0.0, middle])
    corrected = room == entities.CORRECTED
    operations = balance.correction.operations if corrected and balance.correction is not None else ()
    limits = balance.tolerance.permissible
    planes = [plane.residual if corrected else plane.initial for plane in balance.planes]
    at_planes, at_bearings = plane_bounds(balance, unbalance), bearing_bounds(balance, unbalance)
    exact = [each.get("arithmetic", 0.0) for each in unbalance.bounds_in_planes(balance.tolerance_planes)]
    vectors = unbalance.in_planes(*balance.tolerance_planes)
    return State(
        room=room,
        name=name,
        verdict=verdict,
        unit=unit,
        radius=radius / unit,
        reach=(high - middle) / unit,
        bodies=tuple((body - shift) / unit for body in bodies),
        names=_names(balance),
        bearings=tuple(
            Vector((z - middle) / unit, vector, at_bearings[k], f"{'AB'[k]}: {force_text(balance, unbalance, k)}")
            for k, (z, vector) in enumerate(zip(balance.tolerance_planes, vectors, strict=True))
        ),
        planes=tuple(
            Vector((plane.z - middle) / unit, vector, bound, f"{plane.id}: {vector_text(vector, bound, max(limits))}")
            for plane, vector, bound in zip(balance.planes, planes, at_planes, strict=True)
        ),
        permissible=limits,
        scale=_PERMISSIBLE * radius / unit / max(limits),
        forces=tuple(
            force if abs(vector) > bound else 0j
            for force, vector, bound in zip(balance.forces(unbalance), vectors, exact, strict=True)
        ),
        operations=tuple(
            np.array([k.radius * math.cos(k.angle), k.radius * math.sin(k.angle), k.z - middle]) / unit
            for k in operations
        ),
        turn=shaft.turn,
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


def _names(balance: Balance) -> tuple[str, ...]:
    """Return the entities of the bodies: their numbers, or the names of the parts of an assembly."""
    numbers = tuple(f"body_{number}" for number, _ in enumerate(balance.bodies))
    names = tuple("parts/" + re.sub(r"[^\w-]+", "_", body.name) for body in balance.bodies)
    return names if balance.rotor.assembly is not None and len(set(names)) == len(names) else numbers


def write_state(recording: Recording, state: State, time: Float, speed: float) -> Iterator[str]:
    """Write a state that turns at `speed` (rad/s, about z′), at instants (m,) s."""
    import rerun as rr

    turning, thick = f"{state.room}/rotor", _THICK * state.radius
    half = 0.5 * speed * time
    zero = np.zeros_like(half)
    attitude = np.stack([zero, zero, np.sin(half), np.cos(half)], axis=1).astype(np.float32)
    recording.columns(turning, time, lambda rows: rr.Transform3D.columns(quaternion=attitude[rows]))
    for name, corners in zip(state.names, state.bodies, strict=True):
        recording.static(f"{turning}/{name}", facets(corners, BODY))
        for angle, color, width in _MERIDIANS:
            line = meridian(corners, math.radians(angle))
            write_lines(recording, f"{turning}/{name}/meridian_{angle}", list(line), color, width * thick)
    _write_frame(recording, state, thick)
    _write_vectors(recording, f"{turning}/unbalance", state, state.planes, UNBALANCE, thick)
    color = AFTER if state.room == entities.CORRECTED else BEFORE
    _write_vectors(recording, f"{turning}/bearing_force", state, state.bearings, color, thick)
    _write_labels(recording, f"{state.room}/plane_labels", state, state.planes, 1.0, UNBALANCE)
    _write_labels(recording, f"{state.room}/bearing_labels", state, state.bearings, -1.0, color)
    if state.operations:
        spots = rr.Points3D(state.operations, colors=[PLACE], radii=[1.6 * thick])
        recording.static(f"{turning}/operations", spots)
        groups = _groups(state.operations, _LINE * state.extent[0])
        numbers = rr.Points3D(
            [state.operations[group[0]] for group in groups],
            labels=[numbers_text(group) for group in groups],
            colors=[PLACE],
            radii=[1.6 * thick],
            show_labels=len(groups) <= _NUMBERED,
        )
        recording.static(f"{turning}/operations/numbers", numbers)
    yield from (f"{state.name}: {each}" for each in state.notes)


def _groups(places: Sequence[Float], near: float) -> list[list[int]]:
    """Return the places (3,) that have one name, by their numbers: those that are near the first of them."""
    groups: list[list[int]] = []
    for number, place in enumerate(places):
        home = next((k for k in groups if np.linalg.norm(places[k[0]] - place) < near), None)
        if home is None:
            groups.append([number])
        else:
            home.append(number)
    return groups


def scale_text(state: State) -> str:
    """Return what the lengths and colours in the views mean."""
    size = in_gmm(complex(state.radius / state.scale))
    farthest = _LONGEST / _PERMISSIBLE
    return (
        "vermillion is as the rotor was, blue as corrected, green what is permissible in bearings, in all views and "
        f"plots; yellow vectors are what the correction planes have. In space one outer radius is {size:.4g} g·mm; a "
        f"vector over {farthest:.3g} times the larger circle is broken, and one that its bounds do not tell from zero "
        "is not drawn. The white line on the rotor is at its zero mark"
    )


def _write_frame(recording: Recording, state: State, thick: float) -> None:
    """Write shaft, bearings, planes and zero mark, what is permissible, and the sense of rotation."""
    import rerun as rr

    turning, radius = f"{state.room}/rotor", state.radius
    ends = np.array([[0.0, 0.0, -1.15 * state.reach], [0.0, 0.0, 1.15 * state.reach]])
    write_lines(recording, f"{state.room}/shaft", [ends], INK, 0.4 * thick)
    foot, wide = _LONGEST * radius, 0.12 * state.reach
    supports = [
        np.array([[0.0, 0.0, k.z], [-foot, 0.0, k.z - wide], [-foot, 0.0, k.z + wide], [0.0, 0.0, k.z]])
        for k in state.bearings
    ]
    write_lines(recording, f"{state.room}/bearings", supports, INK, 0.5 * thick)
    circles = [
        circle(state.scale * most, bearing.z, np.eye(3))
        for bearing, most in zip(state.bearings, state.permissible, strict=True)
    ]
    write_lines(recording, f"{state.room}/permissible", circles, PERMISSIBLE, 0.8 * thick)
    if state.planes:
        rings = [circle(1.06 * radius, plane.z, np.eye(3)) for plane in state.planes]
        write_lines(recording, f"{state.room}/correction_planes", rings, FAINT, 0.6 * thick)
    end = 1.08 * state.reach
    mark = np.array([[0.0, 0.0, end], [0.8 * radius, 0.0, end]])
    zero = rr.Arrows3D(
        origins=[mark[0]],
        vectors=[mark[1] - mark[0]],
        colors=[WHITE],
        radii=[0.7 * thick],
        labels=["0°"],
        show_labels=True,
    )
    recording.static(f"{turning}/zero_mark", zero)
    turn = state.turn * np.linspace(-0.25 * math.pi, 0.5 * math.pi, _SAMPLES)
    arc = np.stack([0.5 * radius * np.cos(turn), 0.5 * radius * np.sin(turn), np.full(_SAMPLES, end)], axis=1)
    write_lines(recording, f"{state.room}/rotation", [arc], WHITE, 0.5 * thick)
    along = np.array([[-math.sin(turn[-1]), math.cos(turn[-1]), 0.0]]) * state.turn * 0.16 * radius
    head = rr.Arrows3D(origins=[arc[-1]], vectors=along, colors=[WHITE], radii=[0.7 * thick])
    recording.static(f"{state.room}/rotation_head", head)


def _write_vectors(
    recording: Recording, path: str, state: State, vectors: Sequence[Vector], color: Color, thick: float
) -> None:
    """Write arrows across the shaft; of one that is broken, its tip, and its foot as a line that ends in a slant."""
    import rerun as rr

    origins, arrows, feet = [], [], []
    for vector in vectors:
        size = abs(vector.value)
        if not resolved(size, vector.bound):
            continue
        length, parts = broken(state.scale * size, _LONGEST * state.radius)
        along = np.array([vector.value.real, vector.value.imag, 0.0]) * length / size
        place = np.array([0.0, 0.0, vector.z])
        origins.append(place + parts[-1][0] * along)
        arrows.append((1.0 - parts[-1][0]) * along)
        if len(parts) > 1:
            slant = 0.08 * state.radius * np.array([-along[1], along[0], 0.6 * length]) / length
            feet.append(np.stack([place, place + parts[0][1] * along]))
            feet += [np.stack([place + end * along - slant, place + end * along + slant]) for end in _ends(parts)]
    if arrows:
        recording.static(path, rr.Arrows3D(origins=origins, vectors=arrows, colors=[color], radii=[thick]))
    if feet:
        write_lines(recording, f"{path}/cut", feet, color, thick)


def _ends(parts: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return where the gap between two parts begins and ends."""
    return parts[0][1], parts[1][0]


def _write_labels(
    recording: Recording, path: str, state: State, vectors: Sequence[Vector], side: float, color: Color
) -> None:
    """Write what the vectors are, above (1) or below (−1) the rotor, where labels do not lie over each other."""
    import rerun as rr

    if not vectors:
        return
    line = _LINE * state.extent[0]
    heights = [state.label_start + (0.5 + number) * line for number in _lines_of(vectors, state.reach)]
    points = [(side * height, 0.0, vector.z) for height, vector in zip(heights, vectors, strict=True)]
    labels = [vector.text for vector in vectors]
    write_labels(recording, path, points, labels)
    recording.static(f"{path}/keys", rr.Points3D(points, colors=[color], radii=[-3.0]))


def _lines_of(vectors: Sequence[Vector], reach: float) -> list[int]:
    """Return the line of each label, 0 next to the rotor: labels that are close along the shaft have different ones."""
    lines: list[int] = []
    for k, vector in enumerate(vectors):
        near = {lines[j] for j in range(k) if abs(vectors[j].z - vector.z) < _CLOSE * reach}
        lines.append(next(line for line in range(len(vectors)) if line not in near))
    return lines
