"""Charts of what is no function of time, as views in the plane: a box with a grid, curves, and points that move."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from inertia import palette
from inertia.arrays import Float
from inertia.recording.drawing import STRIPS, Color
from inertia.recording.screen import DARK_GROUND
from inertia.recording.writer import Recording
from inertia.records import dataclass

WIDTH, HEIGHT = 160.0, 100.0
"""Of a chart's box, in units of the view, whose y points down."""

_INK, _GRID = palette.rgb(palette.WHITE), (60, 63, 70)
_TICKS = 5
_LEFT, _RIGHT, _ABOVE, _BELOW = 30.0, 6.0, 16.0, 40.0  # around the boxes, for numbers and names
_NAME = 22.0  # from the left of a box to the middle of the name of its y axis, above it


@dataclass(frozen=True)
class Chart:
    """A box at `path`, x from `left` to `right`, y from `low` to `high`, `top` below the top of the view."""

    path: str
    left: float
    right: float
    low: float
    high: float
    top: float = 0.0
    height: float = HEIGHT

    def at(self, x: ArrayLike, y: ArrayLike) -> Float:
        """Return places (…, 2) in the view."""
        across = (np.asarray(x, dtype=np.float64) - self.left) / (self.right - self.left)
        up = (np.asarray(y, dtype=np.float64) - self.low) / (self.high - self.low)
        across, up = np.broadcast_arrays(across, up)
        return np.stack([WIDTH * across, self.top + self.height * (1.0 - up)], axis=-1)

    def write_axes(self, recording: Recording, x_name: str, y_name: str) -> None:
        """Write the box, ticks with their numbers, and the names of the axes; without a name x has no numbers."""
        import rerun as rr

        grid, places, texts = [], [], []
        for value in ticks(self.left, self.right):
            ends = self.at([value, value], [self.low, self.high])
            grid.append(ends)
            if x_name:
                places.append(ends[0] + (0.0, 3.0))
                texts.append(f"{value:.6g}")
        for value in ticks(self.low, self.high, self.height / HEIGHT):
            ends = self.at([self.left, self.right], [value, value])
            grid.append(ends)
            places.append(ends[0] - (15.0, 4.0))
            texts.append(f"{value:.6g}")
        if x_name:
            places.append(self.at(0.5 * (self.left + self.right), self.low) + np.array([0.0, 20.0]))
            texts.append(x_name)
        places.append(self.at(self.left, self.high) + np.array([_NAME, -10.0]))
        texts.append(y_name)
        recording.static(f"{self.path}/grid", rr.LineStrips2D(grid, colors=[_GRID], radii=[0.15]))
        recording.static(
            f"{self.path}/numbers",
            rr.Points2D(places, labels=texts, colors=[_INK], radii=[0.01], show_labels=True),
        )

    def write_curves(
        self,
        recording: Recording,
        name: str,
        curves: Sequence[tuple[ArrayLike, ArrayLike]],
        color: Color,
        radius: float = 0.5,
    ) -> bool:
        """Write curves (x, y) that stay, without what is outside the box, or NaN; return whether something is left."""
        import rerun as rr

        pieces = []
        for x, y in curves:
            points = self.at(x, y)
            shown = (points >= (0.0, self.top)) & (points <= (WIDTH, self.top + self.height))
            inside = np.flatnonzero(shown.all(axis=1))
            runs = np.split(points[inside], np.flatnonzero(np.diff(inside) > 1) + 1)
            pieces += [run for run in runs if len(run) > 1]
        if pieces:
            recording.static(f"{self.path}/{name}", rr.LineStrips2D(pieces, colors=[color], radii=[radius]))
        return bool(pieces)

    def write_moving(self, recording: Recording, name: str, time: Float, x: Float, y: Float, color: Color) -> None:
        """Write a point that moves, x and y (m,)."""
        import rerun as rr

        path, points = f"{self.path}/{name}", self.at(x, y).astype(np.float32)
        recording.static(path, rr.Points2D.from_fields(colors=[color], radii=[2.0]))
        recording.columns(path, time, lambda rows: rr.Points2D.columns(positions=points[rows]))

    def write_level(self, recording: Recording, name: str, time: Float, y: Float, color: Color) -> None:
        """Write a horizontal line through the box, at y (m,) as it changes."""
        import rerun as rr

        path = f"{self.path}/{name}"
        strips = np.stack([self.at(self.left, y), self.at(self.right, y)], axis=1).astype(np.float32)
        recording.static(path, rr.LineStrips2D.from_fields(colors=[color], radii=[0.5]))
        recording.columns(path, time, lambda rows: rr.LineStrips2D.columns(strips=strips[rows]), block=STRIPS)


def chart_view(name: str, charts: Sequence[Chart]) -> Any:
    """Return the view of charts that stand below one another."""
    import rerun.blueprint as rrb

    end = max(chart.top + chart.height for chart in charts)
    bounds = rrb.VisualBounds2D(x_range=(-_LEFT, WIDTH + _RIGHT), y_range=(-_ABOVE, end + _BELOW))
    return rrb.Spatial2DView(
        origin=f"/{charts[0].path}",
        contents=[f"/{chart.path}/**" for chart in charts],
        name=name,
        visual_bounds=bounds,
        background=DARK_GROUND,
    )


def ticks(low: float, high: float, share: float = 1.0) -> list[float]:
    """Return round numbers from `low` to `high`, about five of them, or of that a share.

    >>> ticks(0.0, 1.0)
    [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    """
    rough = (high - low) / (_TICKS * share)
    power = 10.0 ** math.floor(math.log10(rough))
    step = power * min((k for k in (1.0, 2.0, 5.0, 10.0)), key=lambda k: abs(math.log(k * power / rough)))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    digits = max(0, 1 - math.floor(math.log10(step)))
    return [round(k * step, digits) for k in range(first, last + 1)]
