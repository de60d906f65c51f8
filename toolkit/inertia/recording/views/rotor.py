"""A rotor that turns in its bearings, as modelled and as corrected: unbalance, bearing forces, what is permissible."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.recording import places, target
from inertia.recording.panels import write_text
from inertia.recording.playback import Playback, playback
from inertia.recording.screen import Screen
from inertia.recording.series import COLORS
from inertia.recording.views.blueprint_rotor import Layout, blueprint
from inertia.recording.views.rotor_state import State, states_of, write_state
from inertia.recording.views.rotor_summary import summary
from inertia.recording.writer import Recording

APPLICATION = "inertia-balance"

TURNS = 12
_SAMPLES = 128  # of a turn
_REVOLUTION = 2.0 * math.pi


def rotor(balance: Balance) -> Screen:
    """Return the recording of a rotor: a dozen turns at its highest speed in service, slowed."""
    states = states_of(balance)
    time = np.linspace(0.0, TURNS * _REVOLUTION / balance.rotor.speed, TURNS * _SAMPLES + 1)
    play = playback(time, balance.rotor.speed)
    layout = Layout(
        reach=states[0].reach,
        rooms=tuple((state.room, state.title) for state in states),
        targets=(target.title(balance, 0), target.title(balance, 1)),
        duration=float(time[-1]),
        speed=play.speed,
    )

    def write(recording: Recording) -> None:
        said: list[str] = []
        for state in states:
            said += write_state(recording, state, play.frames, balance.shaft.turn * balance.rotor.speed)
        for path, number in ((places.POLAR_A, 0), (places.POLAR_B, 1)):
            target.write_target(recording, path, balance, number)
        _write_forces(recording, balance, states, time)
        write_text(recording, summary(balance, _pace(balance, play), said))

    return Screen(APPLICATION, Path(balance.rotor.name).name, blueprint(layout), write)


def _pace(balance: Balance, play: Playback) -> str:
    speed = balance.rotor.speed * 30.0 / math.pi
    slowed = f", {1.0 / play.speed:.6g} times slower" if play.speed != 1 else ""
    return f"The shaft turns at {speed:.6g} r/min, on the screen at {speed * play.speed:.4g} r/min{slowed}."


def _write_forces(recording: Recording, balance: Balance, states: list[State], time: Float) -> None:
    """Write what a sensor at 0° feels of each bearing: the component of the force along the zero mark at rest."""
    turned = np.exp(1j * balance.shaft.turn * balance.rotor.speed * time)
    names = [f"{state.title.lower()}, N" for state in states]
    for path, number in ((places.PLOT_BEARING_A, 0), (places.PLOT_BEARING_B, 1)):
        felt = np.stack([(state.forces[number] * turned).real for state in states], axis=1)
        recording.scalars(path, time, felt.__getitem__, names, COLORS[: len(states)])
