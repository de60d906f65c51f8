"""A tolerance plane as a target: what is permissible as a circle, the unbalance before and after as vectors."""

from __future__ import annotations

import cmath
import math

import numpy as np

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.shop_units import in_gmm
from inertia.recording.writer import Recording

FARTHEST = 1.6
"""Over what is permissible, where a vector is cut off."""

BEFORE, AFTER, PERMISSIBLE, INK = (240, 90, 80), (90, 200, 255), (90, 200, 90), (150, 155, 165)


def title(balance: Balance, number: int) -> str:
    """Return what the view of tolerance plane A (0) or B (1) is called."""
    permissible = in_gmm(balance.tolerance.permissible[number])
    return f"Plane {'AB'[number]}, seen from B: permissible {permissible:.4g} g·mm"


def write_target(recording: Recording, path: str, balance: Balance, number: int) -> None:
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
            [_down(place) for place in marks.values()],
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


def _down(place: complex) -> Float:
    """Return a place (2,) in a view whose y points down."""
    return np.array([place.real, -place.imag])
