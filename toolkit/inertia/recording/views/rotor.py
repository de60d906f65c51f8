"""Recording of a rotor that turns in its bearings, as modelled and as corrected, with all that a technician works from.

Both states in space, the tolerance planes as targets, the verdict, what every plane has, the list of work, where it is
done, and what a sensor at rest feels of each bearing. Limits set every scale.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.errors import visible
from inertia.palette import BLUE, GREEN, VERMILLION, rgb
from inertia.recording import entities
from inertia.recording.drawing import write_text
from inertia.recording.playback import playback
from inertia.recording.screen import DARK_GROUND, Screen, camera, finished, plot, space_view, text_view
from inertia.recording.views.rotor_state import State, scale_text, states_of, write_state
from inertia.recording.views.rotor_target import (
    DIAL_BOUNDS,
    TARGET_BOUNDS,
    VERDICTS,
    verdict_bounds,
    write_target,
    write_verdict,
    write_work,
)
from inertia.recording.views.rotor_text import notes_text, verdict_text, work_text
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

TURNS = 12

_SAMPLES = 128  # of a turn
_REVOLUTION = 2.0 * math.pi
_TARGETS = (entities.POLAR_A, entities.POLAR_B)
_PLOTS = (entities.PLOT_BEARING_A, entities.PLOT_BEARING_B)
_SERIES = [rgb(VERMILLION), rgb(BLUE), rgb(GREEN)]  # as modelled, corrected, limits: on light ground, too
_FROM = np.array([0.35, 0.9, 0.5])  # shaft axes: z′ goes to the right, the zero mark starts on top
_HALF_VIEW = math.tan(math.radians(27.5))  # of the viewer's angle of view, 55° from top to bottom
_ASPECT = 1.4  # of the views in space, two of them; one alone is twice as high


def screen(balance: Balance) -> Screen:
    """Return the recording of a rotor: a dozen turns at its highest speed in service, slowed."""
    states = states_of(balance)
    time = np.linspace(0.0, TURNS * _REVOLUTION / balance.rotor.speed, TURNS * _SAMPLES + 1)
    play = playback(time, balance.rotor.speed)

    def write(recording: Recording) -> None:
        import rerun as rr

        notes = [scale_text(states[0])]
        for state in states:
            notes += write_state(recording, state, play.frames, balance.shaft.turn * balance.rotor.speed)
        for number, path in enumerate(_TARGETS):
            write_target(recording, path, balance, number)
        write_work(recording, entities.WORK, balance)
        write_verdict(recording, entities.VERDICT, balance.verdict.outcome)
        _write_forces(recording, balance, states, time)
        for path, text in ((entities.VERDICT_TEXT, verdict_text(balance)), (entities.WORK_TEXT, work_text(balance))):
            recording.static(path, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))
        write_text(recording, notes_text(balance, play.speed, notes))

    blueprint = _blueprint(balance, states, float(time[-1]), play.speed)
    return Screen("inertia-balance", visible(Path(balance.rotor.name).name), blueprint, write)


def _blueprint(balance: Balance, states: list[State], duration: float, speed: float) -> rrb.Blueprint:
    """Arrange the states of the rotor, its targets, forces and text."""
    import rerun.blueprint as rrb

    offset = max(_distance(state, _ASPECT / (3 - len(states))) for state in states) * _FROM / np.linalg.norm(_FROM)
    eye = camera(offset, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    views = [space_view(state.room, state.title, eye) for state in states]
    targets = [
        _flat(path, f"Bearing {plane.name}, seen from B: {plane.outcome.upper()}", TARGET_BOUNDS)
        for path, plane in zip(_TARGETS, balance.verdict.planes, strict=True)
    ]
    outcome = balance.verdict.outcome
    badge = rrb.Spatial2DView(
        origin=f"/{entities.VERDICT}",
        name=f"Verdict: {outcome.upper()}",
        titlebar=False,
        background=VERDICTS[outcome],
        visual_bounds=_bounds(verdict_bounds(outcome)),
    )
    forces = rrb.Tabs(*[_force_plot(balance, states, k, duration) for k in (0, 1)])
    text = rrb.TextDocumentView(origin=f"/{entities.VERDICT_TEXT}", name="Verdict", titlebar=False)
    work = rrb.TextDocumentView(origin=f"/{entities.WORK_TEXT}", name=f"Work: {_places(states[-1])}")
    notes: Any = text_view()
    if states[-1].operations:
        dial = _flat(entities.WORK, "Places", DIAL_BOUNDS)
        below: list[Any] = [rrb.Tabs(work, notes), rrb.Horizontal(dial, forces, column_shares=[1.0, 1.1])]
        work_height = min(100.0 + 23.0 * len(states[-1].operations), 200.0)
    else:
        below, work_height = [forces, notes], 170.0
    # Pixels that the rows take: lines of text are 15 high, rows of tables 23.
    table_height = 95.0 + 23.0 * (5 + len(states[-1].planes))
    right = rrb.Vertical(badge, text, *below, row_shares=[44.0, table_height, work_height, 190.0])
    middle = rrb.Vertical(*targets)
    return finished(rrb.Vertical(*views), rrb.Horizontal(middle, right, column_shares=[0.64, 1.0]), speed, (1.0, 2.05))


def _places(state: State) -> str:
    """Return at how many places something is done."""
    number = len(state.operations)
    return f"{number} {'place' if number == 1 else 'places'}" if number else "none"


def _flat(path: str, name: str, bounds: tuple[tuple[float, float], tuple[float, float]]) -> rrb.Spatial2DView:
    import rerun.blueprint as rrb

    return rrb.Spatial2DView(origin=f"/{path}", name=name, background=DARK_GROUND, visual_bounds=_bounds(bounds))


def _bounds(bounds: tuple[tuple[float, float], tuple[float, float]]) -> rrb.VisualBounds2D:
    import rerun.blueprint as rrb

    return rrb.VisualBounds2D(x_range=bounds[0], y_range=bounds[1])


def _distance(state: State, aspect: float) -> float:
    """Return from how far away all of a state is seen in a view of this aspect."""
    across, along = state.extent
    turn = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    rim = np.stack([across * np.cos(turn), state.radius * np.sin(turn), np.full(24, along)], axis=1)
    points = np.concatenate([rim, rim * [1.0, 1.0, -1.0]])
    back = _FROM / np.linalg.norm(_FROM)
    right = np.cross(-back, [1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, -back)
    needed = np.maximum(np.abs(points @ up), np.abs(points @ right) / aspect) / _HALF_VIEW
    return float((points @ back + needed).max())


def _force_limit(balance: Balance, number: int) -> float:
    """Return the force (N) on a bearing of what is permissible there."""
    return balance.rotor.speed**2 * balance.tolerance.permissible[number]


def _force_plot(balance: Balance, states: Sequence[State], number: int, duration: float) -> rrb.TimeSeriesView:
    """Return the plot of the force on bearing A (0) or B (1), whose scale holds what is permissible."""
    most = 1.15 * max(_force_limit(balance, number), *(abs(state.forces[number]) for state in states))
    name = f"Force on {'AB'[number]}, N"
    return plot(_PLOTS[number], name, duration, legend=False, values=(-most, most))


def _write_forces(recording: Recording, balance: Balance, states: list[State], time: Float) -> None:
    """Write what a sensor at 0° feels of each bearing: the component of the force along the zero mark at rest."""
    turned = np.exp(1j * balance.shaft.turn * balance.rotor.speed * time)
    names = [*(f"{state.name}, N" for state in states), "limit, N", "−limit, N"]
    colors = [*_SERIES[: len(states)], *[_SERIES[2]] * 2]
    for number, path in enumerate(_PLOTS):
        limit = np.full(len(time), _force_limit(balance, number))
        felt = np.stack([*((state.forces[number] * turned).real for state in states), limit, -limit], axis=1)
        recording.scalars(path, time, felt.__getitem__, names, colors)
