"""Recording of a rotor that turns in its bearings, as modelled and as corrected, with its tolerance planes as targets.

A target shows what is permissible as a circle, and the unbalance before and after as vectors.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.shop_units import in_degrees, in_gmm
from inertia.balancing.unbalance import Unbalance
from inertia.errors import visible
from inertia.recording import entities
from inertia.recording.drawing import COLORS, write_text
from inertia.recording.playback import playback
from inertia.recording.screen import DARK_GROUND, Screen, camera, finished, plot, text_view
from inertia.recording.summary import markdown, sentence
from inertia.recording.views.rotor_state import State, states_of, write_state
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

TURNS = 12
FARTHEST = 1.6
"""Over what is permissible, where a vector on a target is cut off."""

BEFORE, AFTER, PERMISSIBLE, INK = (240, 90, 80), (90, 200, 255), (90, 200, 90), (150, 155, 165)

_SAMPLES = 128  # of a turn
_REVOLUTION = 2.0 * math.pi
_TARGETS = (entities.POLAR_A, entities.POLAR_B)
_FROM = np.array([0.4, 1.0, 0.25])  # shaft axes: z′ goes to the right, the zero mark starts on top
_DISTANCE = 1.9


def screen(balance: Balance) -> Screen:
    """Return the recording of a rotor: a dozen turns at its highest speed in service, slowed."""
    states = states_of(balance)
    time = np.linspace(0.0, TURNS * _REVOLUTION / balance.rotor.speed, TURNS * _SAMPLES + 1)
    play = playback(time, balance.rotor.speed)

    def write(recording: Recording) -> None:
        notes: list[str] = []
        for state in states:
            notes += write_state(recording, state, play.frames, balance.shaft.turn * balance.rotor.speed)
        for number, path in enumerate(_TARGETS):
            _write_target(recording, path, balance, number)
        _write_forces(recording, balance, states, time)
        write_text(recording, _summary(balance, play.speed, notes))

    blueprint = _blueprint(balance, states, float(time[-1]), play.speed)
    return Screen("inertia-balance", visible(Path(balance.rotor.name).name), blueprint, write)


def _blueprint(balance: Balance, states: list[State], duration: float, speed: float) -> rrb.Blueprint:
    """Arrange the states of the rotor, its targets, forces and text."""
    import rerun.blueprint as rrb

    offset = _DISTANCE * states[0].reach * _FROM / np.linalg.norm(_FROM)
    views = [
        rrb.Spatial3DView(
            origin=f"/{state.room}",
            name=state.title,
            eye_controls=camera(offset, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
            background=DARK_GROUND,
            line_grid=False,
        )
        for state in states
    ]
    span = (-1.5 * FARTHEST, 1.5 * FARTHEST)
    targets = [
        rrb.Spatial2DView(
            origin=f"/{path}",
            name=f"Plane {'AB'[number]}, seen from B: permissible {in_gmm(permissible):.4g} g·mm",
            background=DARK_GROUND,
            visual_bounds=rrb.VisualBounds2D(x_range=span, y_range=span),
        )
        for number, (path, permissible) in enumerate(zip(_TARGETS, balance.tolerance.permissible, strict=True))
    ]
    right = rrb.Vertical(
        rrb.Horizontal(*targets),
        plot(entities.PLOT_BEARING_A, "Force on bearing A, as a sensor at rest feels it, N", duration),
        plot(entities.PLOT_BEARING_B, "Force on bearing B, as a sensor at rest feels it, N", duration),
        text_view(),
        row_shares=[3, 2.2, 2.2, 3.4],
    )
    return finished(rrb.Vertical(*views), right, speed, (1.0, 1.0))


def _write_target(recording: Recording, path: str, balance: Balance, number: int) -> None:
    """Write tolerance plane A (0) or B (1), its 0° to the right and angles counter-clockwise."""
    import rerun as rr

    permissible = balance.tolerance.permissible[number]
    turn = np.linspace(0.0, 2.0 * math.pi, 181)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    cross = [np.array([[-FARTHEST, 0.0], [FARTHEST, 0.0]]), np.array([[0.0, -FARTHEST], [0.0, FARTHEST]])]
    recording.static(f"{path}/cross", rr.LineStrips2D(cross, colors=[(70, 73, 80)], radii=[0.006]))
    recording.static(f"{path}/permissible", rr.LineStrips2D([ring], colors=[PERMISSIBLE], radii=[0.015]))
    marks = {f"{90 * k}°": cmath.rect(1.15 * FARTHEST, 0.5 * math.pi * k) for k in range(4)}
    recording.static(
        f"{path}/marks",
        rr.Points2D(
            [_down(mark) for mark in marks.values()],
            labels=list(marks),
            colors=[INK],
            radii=[0.001],
            show_labels=True,
        ),
    )
    states = [("before", balance.initial, BEFORE)]
    if balance.correction is not None and balance.correction.operations:
        states.append(("after", balance.residual, AFTER))
    for name, unbalance, color in states:
        vector = unbalance.in_planes(*balance.tolerance_planes)[number]
        _write_vector(recording, f"{path}/{name}", f"{name} {in_gmm(vector):.4g} g·mm", vector / permissible, color)


def _write_vector(recording: Recording, path: str, label: str, vector: complex, color: tuple[int, int, int]) -> None:
    """Write a vector in units of what is permissible, cut off where it leaves the target."""
    import rerun as rr

    size = abs(vector)
    if size > FARTHEST:
        vector, label = vector * FARTHEST / size, f"{label}, {size:.3g} ×"
    tip = _down(vector)
    recording.static(f"{path}/line", rr.LineStrips2D([[(0.0, 0.0), tip]], colors=[color], radii=[0.02]))
    recording.static(f"{path}/tip", rr.Points2D([tip], labels=[label], colors=[color], radii=[0.06], show_labels=True))


def _down(point: complex) -> Float:
    """Return a point (2,) in a view whose y points down."""
    return np.array([point.real, -point.imag])


def _write_forces(recording: Recording, balance: Balance, states: list[State], time: Float) -> None:
    """Write what a sensor at 0° feels of each bearing: the component of the force along the zero mark at rest."""
    turned = np.exp(1j * balance.shaft.turn * balance.rotor.speed * time)
    names = [f"{state.title.lower()}, N" for state in states]
    for path, number in ((entities.PLOT_BEARING_A, 0), (entities.PLOT_BEARING_B, 1)):
        felt = np.stack([(state.forces[number] * turned).real for state in states], axis=1)
        recording.scalars(path, time, felt.__getitem__, names, COLORS[: len(states)])


def _summary(balance: Balance, speed: float, notes: Iterable[str]) -> str:
    """Return the text in Markdown; `notes` say what was chosen for display only.

    `speed` is that of the playback, seconds of the rotor in a second.
    """
    lines = [*_verdict(balance), "", _pace(balance, speed), "", *_planes(balance), "", *_bearings(balance), ""]
    return "\n".join([*lines, *_notes(balance, notes)])


def _verdict(balance: Balance) -> Iterator[str]:
    yield f"**{markdown(Path(balance.rotor.name).name)}: {balance.verdict.outcome.upper()}**"
    if balance.verdict.outcome != balance.initial_verdict.outcome:
        yield f"after correction, {balance.initial_verdict.outcome.upper()} as {balance.origin}."
    yield f"{balance.tolerance.standard}. {' '.join(sentence(each) for each in balance.verdict.why)}"


def _pace(balance: Balance, speed: float) -> str:
    rpm = balance.rotor.speed * 30.0 / math.pi
    slowed = f", {1.0 / speed:.6g} times slower" if speed != 1 else ""
    return f"The shaft turns at {rpm:.6g} r/min, on the screen at {rpm * speed:.4g} r/min{slowed}."


def _planes(balance: Balance) -> Iterator[str]:
    if not balance.planes:
        return
    corrected = balance.correction is not None
    yield f"| Correction plane | As {balance.origin} |{' Corrected |' if corrected else ''}"
    yield f"|-|-|{'-|' if corrected else ''}"
    for plane in balance.planes:
        after = f" {_polar(plane.residual)} |" if corrected else ""
        yield f"| {plane.id}, z = {1e3 * plane.z:.6g} mm | {_polar(plane.initial)} |{after}"


def _bearings(balance: Balance) -> Iterator[str]:
    states: list[tuple[str, Unbalance]] = [(f"as {balance.origin}", balance.initial)]
    if balance.correction is not None:
        states.append(("corrected", balance.residual))
    yield f"| Bearing | Permissible | {' | '.join(f'Force {name}' for name, _ in states)} |"
    yield f"|-|-|{'-|' * len(states)}"
    forces = [balance.forces(unbalance) for _, unbalance in states]
    for number, name in enumerate("AB"):
        felt = " | ".join(f"{abs(each[number]):.4g} N" for each in forces)
        yield f"| {name} | {in_gmm(balance.tolerance.permissible[number]):.4g} g·mm | {felt} |"


def _notes(balance: Balance, notes: Iterable[str]) -> Iterator[str]:
    yield f"**On the screen.** {' '.join(sentence(each) for each in notes)}"
    if balance.rigid is not None:
        yield ""
        yield sentence(balance.rigid.text)
    for note in balance.notes:
        yield f"- {note}"


def _polar(vector: complex) -> str:
    return f"{in_gmm(vector):.4g} g·mm at {in_degrees(vector):.1f}°"
