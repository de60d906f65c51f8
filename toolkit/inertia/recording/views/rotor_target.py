"""Flat diagrams of a rotor, seen from bearing B: tolerance planes as targets, where the work is done, and the verdict.

0° is to the right and angles run counter-clockwise. A target is drawn in units of what is permissible, which is the
circle of radius 1, whatever the unbalance; a vector that is much longer is broken, and says how long it is.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from scipy.optimize import isotonic_regression

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.shop_digits import shop_digits
from inertia.balancing.shop_units import in_gmm
from inertia.palette import GREEN, ORANGE, PINK, SKY, VERMILLION, YELLOW, rgb
from inertia.recording.drawing import Color
from inertia.recording.views.rotor_text import bearing_bounds, place_text, resolved, states, vector_text
from inertia.recording.writer import Recording

FARTHEST = 1.6
"""Over what is permissible, where a vector on a target ends at most."""
TARGET_BOUNDS = (-2.2, 2.2), (-2.15, 3.72)
"""What is seen of a target, x and y (down)."""
DIAL_BOUNDS = (-2.15, 2.15), (-1.5, 1.5)
"""The same of the dial of places."""
_LINE, _LETTER, _KEY = (
    0.385,
    0.065,
    0.4,
)  # of a legend: its pitch, half a letter, and the line in its colour either side

BEFORE, AFTER, PERMISSIBLE, SCATTER, PLACE = map(rgb, (VERMILLION, SKY, GREEN, PINK, YELLOW))
INK, FAINT, WHITE = (165, 170, 180), (75, 78, 86), (235, 235, 240)
VERDICTS = {"pass": rgb(GREEN), "conditional": rgb(ORANGE), "fail": rgb(VERMILLION), "undecided": rgb(PINK)}
"""The ground of the badge."""

_ASIDE, _PITCH, _ROOM = 1.65, 0.4, 7  # of names beside the dial: how far, from one to the next, how many on a side
_WITH_ANGLES, _COUNTED = 4, 3  # places whose names have angles; numbers in a name
_BREAK = 0.62, 0.76  # of a vector that is broken, where its gap begins and ends
_STROKES = {  # of letters, on a grid 2 wide and 4 high
    "A": ("00 02 14 22 20", "02 22"),
    "C": ("24 04 00 20",),
    "D": ("00 04 14 23 21 10 00",),
    "E": ("24 04 00 20", "02 12"),
    "F": ("24 04 00", "02 12"),
    "I": ("00 04",),
    "L": ("04 00 20",),
    "N": ("00 04 20 24",),
    "O": ("00 04 24 20 00",),
    "P": ("00 04 24 22 02",),
    "S": ("24 04 02 22 20 00",),
    "T": ("10 14", "04 24"),
    "U": ("04 00 20 24",),
}
_ADVANCE = {"I": 1.2}


def broken(length: float, most: float) -> tuple[float, list[tuple[float, float]]]:
    """Return how long an arrow is drawn, and the parts of it from 0 to 1 that are: two where it is broken.

    >>> broken(1.0, 1.6), broken(8.0, 1.6)
    ((1.0, [(0.0, 1.0)]), (1.6, [(0.0, 0.62), (0.76, 1.0)]))
    """
    return (length, [(0.0, 1.0)]) if length <= most else (most, [(0.0, _BREAK[0]), (_BREAK[1], 1.0)])


def write_target(recording: Recording, path: str, balance: Balance, number: int) -> None:
    """Write tolerance plane A (0) or B (1)."""
    permissible = balance.tolerance.permissible[number]
    _write_dial(recording, path, balance, FARTHEST)
    _lines(recording, f"{path}/half", [_circle(0.5)], FAINT, 0.006)
    _lines(recording, f"{path}/permissible", [_circle(1.0)], PERMISSIBLE, 0.02)
    legend = [(f"circle: permissible, {in_gmm(permissible):.4g} g·mm", PERMISSIBLE)]
    every = states(balance)
    for (name, _, unbalance), color, entity in zip(every, (BEFORE, AFTER), ("before", "after"), strict=False):
        vector = unbalance.in_planes(*balance.tolerance_planes)[number]
        bound = bearing_bounds(balance, unbalance)[number]
        _write_vector(recording, f"{path}/{entity}", vector / permissible, bound / permissible, color)
        text = f"{name}: {vector_text(vector, bound, permissible, short=True)}"
        times = abs(vector) / permissible
        legend.append((f"{text}, {times:.3g} × limit" if times > FARTHEST else text, color))
    if balance.scatter.sensitivities:
        below = float(balance.scatter.residual_95[number])
        if below <= FARTHEST * permissible:
            _lines(recording, f"{path}/scatter", _dashed(below / permissible), SCATTER, 0.01)
        legend.append((f"dashed: 95 % of parts below {in_gmm(below):.4g} g·mm", SCATTER))
    places = [complex(0.0, -2.1 - _LINE * k) for k in range(len(legend))]
    _labels(recording, f"{path}/legend", places, [text for text, _ in legend])
    for number, (place, (text, color)) in enumerate(zip(places, legend, strict=True)):
        middle, aside = place - 0.6j * _LINE, min(_LETTER * len(text) + 0.3, 2.9)
        keys = [_points([middle + side * aside, middle + side * (aside + _KEY)]) for side in (-1.0, 1.0)]
        _lines(recording, f"{path}/legend/key_{number}", keys, color, 0.04)


def write_work(recording: Recording, path: str, balance: Balance) -> None:
    """Write where the operations are, by their numbers in the list of work, in units of the outermost of them."""
    operations = () if balance.correction is None else balance.correction.operations
    if not operations:
        return
    _write_dial(recording, path, balance, 1.0)
    outermost = max(work.radius for work in operations) or 1.0
    spots = [cmath.rect(max(0.15, work.radius / outermost), work.angle) for work in operations]
    import rerun as rr

    recording.static(f"{path}/spots", rr.Points2D([_down(spot) for spot in spots], colors=[PLACE], radii=[0.07]))
    digits = shop_digits(balance)
    few = len(operations) <= _WITH_ANGLES
    leaders, names = [], {}
    for side in (-1, 1):
        here = [number for number, spot in enumerate(spots) if (spot.real >= 0) == (side > 0)]
        for height, group in _beside(here, [spot.imag for spot in spots]):
            place = complex(side * _ASIDE, height)
            leaders += [_points([spots[number], complex(0.75 * place.real, height)]) for number in group]
            angle = f": {place_text(operations[group[0]], digits)}" if few else ""
            names[place + 0.17j] = f"{numbers_text(group)}{angle}"  # a label hangs below its place
    _lines(recording, f"{path}/leaders", leaders, FAINT, 0.008)
    _labels(recording, f"{path}/numbers", list(names), list(names.values()))


def numbers_text(numbers: Sequence[int]) -> str:
    """Return what operations, counted from 0, are called together.

    >>> numbers_text([1]), numbers_text([0, 1, 2]), numbers_text([3, 4, 5, 6])
    ('2', '1, 2, 3', '4, 5, …')
    """
    counted = [str(number + 1) for number in numbers]
    return ", ".join(counted if len(counted) <= _COUNTED else [*counted[: _COUNTED - 1], "…"])


def _beside(numbers: Sequence[int], heights: Sequence[float]) -> Iterator[tuple[float, list[int]]]:
    """Yield the heights of names of spots on one side, with the spots: apart, near their own, in their order.

    Neighbours have one name where there are more than have room.
    """
    order = sorted(numbers, key=heights.__getitem__)
    size = math.ceil(len(order) / _ROOM)
    groups = [sorted(order[k : k + size]) for k in range(0, len(order), size)] if order else []
    steps = _PITCH * np.arange(len(groups))
    wanted = [float(np.mean([heights[number] for number in group])) for group in groups]
    lowest = -0.5 * _PITCH * (_ROOM - 1)
    if groups:
        free = isotonic_regression(wanted - steps).x
        yield from zip((np.clip(free, lowest, -lowest - steps[-1]) + steps).tolist(), groups, strict=True)


def write_verdict(recording: Recording, path: str, outcome: str) -> None:
    """Write the word of the verdict in strokes, dark on the colour of its ground."""
    strokes, x = [], 0.0
    for letter in outcome.upper():
        for stroke in _STROKES[letter]:
            strokes.append(np.array([(x + float(point[0]), 4.0 - float(point[1])) for point in stroke.split()]))
        x += _ADVANCE.get(letter, 3.2)
    _lines(recording, f"{path}/word", strokes, (13, 13, 13), 0.32)


def verdict_bounds(outcome: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return what is seen of the badge, x and y: the word, in the middle."""
    width = sum(_ADVANCE.get(letter, 3.2) for letter in outcome.upper())
    return (-1.0, width - 0.2), (-1.5, 5.5)


def _write_dial(recording: Recording, path: str, balance: Balance, radius: float) -> None:
    """Write the angles, the zero mark and the sense of rotation."""
    ticks = [np.stack([_down(cmath.rect(k * radius, math.radians(a))) for k in (0.94, 1.0)]) for a in range(0, 360, 30)]
    cross = [np.array([[-radius, 0.0], [radius, 0.0]]), np.array([[0.0, -radius], [0.0, radius]])]
    _lines(recording, f"{path}/cross", [*cross, *ticks, _circle(radius)], FAINT, 0.006)
    mark = [_down(radius * k) for k in (1.0, 1.12 + 0.06j, 1.12 - 0.06j, 1.0)]
    _lines(recording, f"{path}/zero_mark", [np.stack(mark)], WHITE, 0.02)
    turn = balance.shaft.turn
    arc = np.radians(np.linspace(50.0, 70.0, 12))[::turn]
    head = cmath.rect(1.09 * radius, arc[-1])
    back = cmath.rect(0.09 * radius, arc[-1] - turn * 0.5 * math.pi)
    barbs = [head + back * cmath.rect(1.0, off) for off in (0.5, -0.5)]
    strips = [_points(cmath.rect(1.09 * radius, a) for a in arc), _points([barbs[0], head, barbs[1]])]
    _lines(recording, f"{path}/rotation", strips, WHITE, 0.014)
    if radius > 1.0:  # of a target; a dial is small, and its numbers take this room
        marks = {"0°": 2.05 + 0.2j, "90°": 2.05j, "180°": -1.95 + 0.2j, "270°": -1.66j}
        _labels(recording, f"{path}/marks", list(marks.values()), list(marks))
    else:
        _labels(recording, f"{path}/marks", [0.78 + 0.13j], ["0°"])


def _write_vector(recording: Recording, path: str, vector: complex, bound: float, color: Color) -> None:
    """Write a vector, broken where it leaves the target, and the circle in which its tip is."""
    import rerun as rr

    size = abs(vector)
    tip = vector
    if resolved(size, bound):
        length, parts = broken(size, FARTHEST)
        tip = vector * length / size
        strips = [_points([start * tip, stop * tip]) for start, stop in parts]
        if len(parts) > 1:
            slant = 0.09 * cmath.rect(1.0, cmath.phase(tip) + 1.1)
            strips += [_points([end * tip - slant, end * tip + slant]) for end in _BREAK]
        _lines(recording, f"{path}/line", strips, color, 0.022)
        back = -0.16 * tip / abs(tip) if abs(tip) > 0.2 else 0.0
        barbs = [tip + back * cmath.rect(1.0, off) for off in (0.45, -0.45)]
        if back:
            _lines(recording, f"{path}/head", [_points([barbs[0], tip, barbs[1]])], color, 0.022)
    recording.static(f"{path}/tip", rr.Points2D([_down(tip)], colors=[color], radii=[0.025]))
    if size <= FARTHEST:
        _lines(recording, f"{path}/uncertainty", [_circle(bound) + _down(tip)], color, 0.008)


def _labels(recording: Recording, path: str, places: Sequence[complex], texts: Sequence[str]) -> None:
    """Write texts that hang below places."""
    import rerun as rr

    points = rr.Points2D(_points(places), labels=list(texts), colors=[WHITE], radii=[0.001], show_labels=True)
    recording.static(path, points)


def _lines(recording: Recording, path: str, strips: Sequence[Float], color: Color, radius: float) -> None:
    import rerun as rr

    recording.static(path, rr.LineStrips2D([np.float32(k) for k in strips], colors=[color], radii=[radius]))


def _circle(radius: float) -> Float:
    turn = np.linspace(0.0, 2.0 * math.pi, 181)
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def _dashed(radius: float) -> list[Float]:
    return [_circle(radius)[k : k + 4] for k in range(0, 180, 6)]


def _points(values: Iterable[complex]) -> Float:
    return np.stack([_down(value) for value in values])


def _down(point: complex) -> Float:
    """Return a point (2,) in a view whose y points down."""
    return np.array([point.real, -point.imag])
