"""The effective potential of a heavy symmetric top, with the point that runs between its turning angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics.euler_angles import from_angles
from inertia.dynamics.models.heavy.top import HeavyTop
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Run
from inertia.recording.chart import Chart
from inertia.recording.places import EFFECTIVE_POTENTIAL
from inertia.recording.series import COLORS
from inertia.recording.writer import Recording

_BESIDE = 0.7  # of the swing, that is shown on either side of it
_STILL = 0.2  # rad, shown on either side of a tilt that stays
_HEADROOM = 0.6  # of the well's depth, above the energy
_POINTS = 401


@dataclass(frozen=True, eq=False)
class EffectivePotential:
    """A top, and the chart of its effective potential."""

    top: HeavyTop
    chart: Chart

    def write(self, recording: Recording, time: Float, tilt: Float) -> str:
        """Write the chart with a point that moves, at tilts (m,) rad; return what it shows."""
        chart, level = self.chart, self.top.effective_energy
        chart.write_axes(recording, "θ, rad", "V, J")
        theta = np.linspace(chart.left, chart.right, _POINTS)
        chart.write_curve(recording, "potential", theta, self.top.effective_potential(theta), COLORS[2])
        chart.write_curve(recording, "energy", [chart.left, chart.right], [level, level], COLORS[3])
        chart.write_moving(recording, "point", time, tilt, self.top.effective_potential(tilt), (255, 255, 255))
        return "the point runs along the effective potential (blue), below the energy less that of the spin (yellow)"


def effective_potential(run: Run, plan: Plan, tilt: float) -> EffectivePotential:
    """Return the chart of a heavy symmetric top that starts at `tilt` (rad)."""
    i1, _, i3 = plan.moments.tolist()
    mgh = plan.problem.weight * float(np.linalg.norm(plan.problem.arm))
    start = from_angles([float(run.quantities[name][0]) for name in ("phi", "theta", "psi")])
    top = HeavyTop.of_state((i1, i3), mgh, start, run.angular_velocity[0] @ plan.axes)
    first, last = top.turning_angles
    beside = _BESIDE * (last - first) or _STILL
    left, right = max(first - beside, 1e-3), min(last + beside, np.pi - 1e-3)
    values = top.effective_potential(np.linspace(left, right, _POINTS))
    low, level = float(values.min()), top.effective_energy
    depth = max(level - low, 0.05 * float(np.median(values) - low), 1e-9 * abs(level))
    return EffectivePotential(
        top, Chart(EFFECTIVE_POTENTIAL, left, right, low - 0.15 * depth, level + _HEADROOM * depth)
    )
