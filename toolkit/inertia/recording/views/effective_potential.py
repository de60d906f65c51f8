"""The effective potential of a heavy symmetric top as a chart, with the point that runs between its turning angles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.kinematics.euler_angles import from_angles
from inertia.dynamics.models.heavy.top import HeavyTop
from inertia.dynamics.run import Run
from inertia.recording.drawing import MOMENTUM, OMEGA
from inertia.recording.entities import EFFECTIVE_POTENTIAL
from inertia.recording.screen import DARK_GROUND
from inertia.recording.writer import Recording

WIDTH, HEIGHT = 160.0, 100.0
"""Of a chart's box, in units of the view, whose y points down."""

_INK, _GRID = palette.rgb(palette.WHITE), (60, 63, 70)
_TICKS = 5
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
        chart.write_curve(recording, "potential", theta, self.top.effective_potential(theta), MOMENTUM)
        chart.write_curve(recording, "energy", [chart.left, chart.right], [level, level], OMEGA)
        chart.write_moving(recording, "point", time, tilt, self.top.effective_potential(tilt), (255, 255, 255))
        return "the point runs along the effective potential (blue), below the energy less that of the spin (orange)"


def effective_potential(run: Run, tilt: float) -> EffectivePotential:
    """Return the chart of a heavy symmetric top that starts at `tilt` (rad)."""
    plan = run.plan
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


@dataclass(frozen=True)
class Chart:
    """A chart of what is no function of time: a box at `path`, x from `left` to `right`, y from `low` to `high`."""

    path: str
    left: float
    right: float
    low: float
    high: float

    def at(self, x: ArrayLike, y: ArrayLike) -> Float:
        """Return places (…, 2) in the view."""
        across = (np.asarray(x, dtype=np.float64) - self.left) / (self.right - self.left)
        up = (np.asarray(y, dtype=np.float64) - self.low) / (self.high - self.low)
        across, up = np.broadcast_arrays(across, up)
        return np.stack([WIDTH * across, HEIGHT * (1.0 - up)], axis=-1)

    def write_axes(self, recording: Recording, x_name: str, y_name: str) -> None:
        """Write the box, ticks with their numbers, and the names of the axes."""
        import rerun as rr

        grid, places, numbers = [], [], []
        for value in ticks(self.left, self.right):
            ends = self.at([value, value], [self.low, self.high])
            grid.append(ends)
            places.append(ends[0] + (0.0, 3.0))
            numbers.append(f"{value:.6g}")
        for value in ticks(self.low, self.high):
            ends = self.at([self.left, self.right], [value, value])
            grid.append(ends)
            places.append(ends[0] - (15.0, 4.0))
            numbers.append(f"{value:.6g}")
        middle = self.at(0.5 * (self.left + self.right), self.low)
        places += [middle - (0.0, -12.0), self.at(self.left, self.high) - (0.0, 13.0)]
        recording.static(f"{self.path}/grid", rr.LineStrips2D(grid, colors=[_GRID], radii=[0.15]))
        recording.static(
            f"{self.path}/numbers",
            rr.Points2D(places, labels=[*numbers, x_name, y_name], colors=[_INK], radii=[0.01], show_labels=True),
        )

    def write_curve(
        self, recording: Recording, name: str, x: ArrayLike, y: ArrayLike, color: tuple[int, int, int]
    ) -> None:
        """Write a curve that stays; what is above the box is left out."""
        import rerun as rr

        points = self.at(x, y)
        inside = np.flatnonzero(points[:, 1] >= 0)
        pieces = np.split(points[inside], np.flatnonzero(np.diff(inside) > 1) + 1)
        recording.static(f"{self.path}/{name}", rr.LineStrips2D(pieces, colors=[color], radii=[0.5]))

    def write_moving(
        self, recording: Recording, name: str, time: Float, x: Float, y: Float, color: tuple[int, int, int]
    ) -> None:
        """Write a point that moves, x and y (m,)."""
        import rerun as rr

        path, points = f"{self.path}/{name}", self.at(x, y).astype(np.float32)
        recording.static(path, rr.Points2D.from_fields(colors=[color], radii=[2.0]))
        recording.columns(path, time, lambda rows: rr.Points2D.columns(positions=points[rows]))

    def view(self, name: str) -> Any:
        """Return the view of the chart."""
        import rerun.blueprint as rrb

        bounds = rrb.VisualBounds2D(x_range=(-34.0, WIDTH + 6.0), y_range=(-18.0, HEIGHT + 26.0))
        return rrb.Spatial2DView(origin=f"/{self.path}", name=name, visual_bounds=bounds, background=DARK_GROUND)


def ticks(low: float, high: float) -> list[float]:
    """Return round numbers from `low` to `high`, about five of them.

    >>> ticks(0.0, 1.0)
    [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    """
    rough = (high - low) / _TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = power * min((k for k in (1.0, 2.0, 5.0, 10.0)), key=lambda k: abs(math.log(k * power / rough)))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    digits = max(0, 1 - math.floor(math.log10(step)))
    return [round(k * step, digits) for k in range(first, last + 1)]
