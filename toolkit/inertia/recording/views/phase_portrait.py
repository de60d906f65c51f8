"""The phase portrait of one angle, below the potential that it moves in, with the point that runs through both.

Of a body on an axle, and of the tilt of a heavy symmetric top, whose potential is the effective one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.plots.swing import Swing, Window, swing_of
from inertia.dynamics.run import Run
from inertia.recording.chart import HEIGHT, Chart, chart_view
from inertia.recording.drawing import MOMENTUM, OMEGA, TRAIL, Color, thinned
from inertia.recording.entities import EFFECTIVE_POTENTIAL, PHASE_PORTRAIT
from inertia.recording.playback import Frames
from inertia.recording.writer import Recording
from inertia.records import dataclass

if TYPE_CHECKING:
    import rerun.blueprint as rrb

POINT, LEVEL, SEPARATRIX = (255, 255, 255), (105, 112, 125), palette.rgb(palette.PINK)

_SHARE, _APART = 0.72, 18.0  # of the height of a chart, for each, and between them
_BESIDE = 0.7  # of the swing of a top, that is shown on either side of it
_STILL = 0.2  # rad, shown on either side of a tilt that stays
_HEADROOM = 0.6  # of the well's depth, above the energy
_POINTS = 801
_NO_COURSE = 1e-3  # of what an energy falls by, up to which it does not grow, and the reverse
_SWINGS = 1e-9  # of the spin: a rate that changes by less is that of no swing


@dataclass(frozen=True, eq=False)
class PhasePortrait:
    """A swing, and the charts of its potential and of its rate.

    Attributes
    ----------
    angle, rate : (m,) rad and rad/s, θ and θ̇ at the poses that are drawn
    conserved : whether the energy is
    """

    swing: Swing
    is_top: bool
    conserved: bool
    angle: Float
    rate: Float
    potential: Chart
    plane: Chart

    @property
    def view(self) -> rrb.Spatial2DView:
        """The view of both charts."""
        return chart_view("Potential and phase portrait", [self.potential, self.plane])

    def write(self, recording: Recording, frames: Frames) -> str:
        """Write the charts with a point that moves as the run does at `frames`; return what they show."""
        swing, potential, plane, angle, rate = self.swing, self.potential, self.plane, self.angle, self.rate
        potential.write_axes(recording, "", "V, J")
        plane.write_axes(recording, "θ, rad", "θ rate, rad/s")
        theta = np.linspace(potential.left, potential.right, _POINTS)
        energy = swing.energy(angle, rate)
        ends = [potential.left, potential.right]
        potential.write_curves(recording, "potential", [(theta, swing.potential(theta))], MOMENTUM)
        if self.conserved:
            potential.write_curves(recording, "energy", [(ends, [energy[0], energy[0]])], OMEGA)
        window = Window(plane.left, plane.right, plane.low, plane.high)
        beside = ""
        if swing.draws_levels(window):
            if self._write_levels(recording, "levels", swing.levels(window).tolist(), theta, LEVEL):
                beside = "; grey are others of equal energy"
            if swing.barrier is not None and self._write_levels(
                recording, "separatrix", [swing.barrier], theta, SEPARATRIX
            ):
                beside += ", a separatrix (pink)" if beside else "; pink is a separatrix"
        path = thinned(np.stack([angle, rate], axis=1)[frames.near])
        where = "on the phase portrait"
        if plane.write_curves(recording, "run", [(path[:, 0], path[:, 1])], TRAIL):
            where = "along the yellow curve of the phase portrait"
            where += "" if frames.play.loop is None else ", which is drawn as far as the loop goes"
        potential.write_moving(recording, "point", frames.time, angle, swing.potential(angle), POINT)
        plane.write_moving(recording, "point", frames.time, angle, rate, POINT)
        below = "the energy less that of the spin (orange)" if self.is_top else "its energy (orange)"
        if not self.conserved:
            potential.write_level(recording, "energy", frames.time, energy, OMEGA)
            below += f", which {_course(energy)}"
        what = "effective potential" if self.is_top else "potential energy"
        return f"the point runs along the {what} V (blue), below {below}, and {where}{beside}"

    def _write_levels(self, recording: Recording, name: str, energies: list[float], theta: Float, color: Color) -> bool:
        curves = [(theta, sign * self.swing.rates(energy, theta)) for energy in energies for sign in (1.0, -1.0)]
        return self.plane.write_curves(recording, name, curves, color, 0.3)


def _course(energy: Float) -> str:
    """Say how an energy that is not kept goes, J at the poses (m,)."""
    steps = np.diff(energy)
    gain, loss = float(steps.clip(min=0.0).sum()), float(-steps.clip(max=0.0).sum())
    if gain <= _NO_COURSE * loss:
        return "falls"
    return "grows" if loss <= _NO_COURSE * gain else "goes up and down"


def phase_portrait(run: Run, frames: Frames) -> PhasePortrait | None:
    """Return the phase portrait of a run that has one, a body that swings on an axle or a heavy top, at its poses."""
    swing, is_top = swing_of(run), "angle" not in run.quantities
    if swing is None:
        return None
    angle = frames.series["theta" if is_top else "angle"]
    rate = swing.rate_of(frames.angular_velocity, frames.attitude, angle)
    if not is_top and np.ptp(rate) <= _SWINGS * np.abs(rate).max():
        return None
    window = Window.around(angle, rate)
    left, right, level = window.left, window.right, float(swing.energy(angle, rate).max())
    if is_top:
        first, last = float(angle.min()), float(angle.max())
        turning = run.quantities.get("turning theta", [first, last])
        first, last = float(turning[0]), float(turning[1])
        beside = _BESIDE * (last - first) or _STILL
        left, right = max(first - beside, 1e-3), min(last + beside, np.pi - 1e-3)
    values = np.asarray(swing.potential(np.linspace(left, right, _POINTS)))
    low = float(values.min())
    depth = max(level - low, 0.05 * float(np.median(values) - low), 1e-9 * abs(level)) or 1.0
    height = _SHARE * HEIGHT
    return PhasePortrait(
        swing,
        is_top,
        "energy" in run.invariants,
        angle,
        rate,
        Chart(EFFECTIVE_POTENTIAL, left, right, low - 0.15 * depth, level + _HEADROOM * depth, 0.0, height),
        Chart(PHASE_PORTRAIT, left, right, window.low, window.high, height + _APART, height),
    )
